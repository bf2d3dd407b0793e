"""The results of the force benchmark as tables, as a figure, and on its page.

`python -m tests.benchmarks.report` writes the block and the figure from the committed results.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from tests.benchmarks import pages, waves_report
from tests.benchmarks.force import BANDS, STARTS, Results
from tweezer.plots import style

KINDS = ("inside", "edge", "outside", "far", STARTS)
_ROWS = (
    ("quadrature at 1e-8, µs", "quadrature_us"),
    ("at its slowest position, µs", "quadrature_at_the_slowest_place_us"),
    ("its largest error", "quadrature_largest_error"),
    ("NumPy, 7644 rays, µs", "numpy_us"),
    ("NumPy time / quadrature time", "numpy_over_quadrature"),
    ("grid, 7644 rays, µs", "grid_us"),
    ("its median error", "grid_median_error"),
    ("its largest error", "grid_largest_error"),
    ("map at 1e-7, ns", "map_ns"),
    ("with the Jacobian, ns", "map_with_jacobian_ns"),
    ("error / largest force", "map_largest_error_over_largest_force"),
    ("waves at 1e-8, µs", "waves_us"),
    ("its largest error", "waves_largest_error"),
    ("waves' map at 1e-7, ns", "waves_map_ns"),
    ("with the Jacobian, ns", "waves_map_with_jacobian_ns"),
    ("error / largest force", "waves_map_largest_error_over_largest_force"),
)

_ONE_RAY = ("force", "with_gradient", "roots_and_divisions")
#: errors below this are drawn here
_FLOOR = 1e-16
_STYLES = {
    "numpy": (style.SERIES[1].colour, "X", "NumPy sum, 7644 rays"),
    "grid": (style.SERIES[2].colour, "o", "grid, 25 to 1600 squares across"),
    "quadrature": (style.SERIES[0].colour, "s", "quadrature, tolerance 1e-2 to 1e-12"),
    "map": (style.SERIES[3].colour, "D", "map, 1e-5 to 1e-8 of largest force"),
    "waves": (style.SERIES[4].colour, "v", "wave optics, quadrature, 1e-2 to 1e-12"),
    "waves' map": (style.SERIES[5].colour, "P", "wave optics, map, 1e-5 to 1e-8"),
}


def tables(results: Results) -> list[list[list[str]]]:
    """Return the tables by position and of single numbers, with the headings in the first row."""
    figures = [results["headline"]["by_place"][kind] for kind in KINDS]
    by_place = [
        ["time or error", *KINDS],
        *(
            [label, *(_cell(key, of[key]) if key in of else "" for of in figures)]
            for label, key in _ROWS
        ),
    ]
    return [by_place, [["other times", "time"], *_apart(results)]]


def _cell(key: str, value: float) -> str:
    return f"{value:.1e}" if "error" in key else rounded(value)


def _apart(results: Results) -> list[list[str]]:
    figures = results["headline"]
    ray = results["one_ray_ns"]
    starts, first = figures["grid_at_thesis_start_us"], figures["first_force_s"]
    return [
        [
            f"the thesis's grid at the starting points of {', '.join(starts)}",
            f"{', '.join(map(rounded, starts.values()))} µs",
        ],
        ["one ray that hits the bead", f"{rounded(figures['ray_that_hits_ns'])} ns"],
        [
            "one ray of a row: force; force and gradient; only two roots and two divisions",
            f"{', '.join(rounded(ray[key]) for key in _ONE_RAY)} ns",
        ],
        ["map at 1e-7, time to build", f"{rounded(figures['map_made_s'])} s"],
        ["map at 1e-7, time to load", f"{rounded(1e3 * figures['map_loaded_s'])} ms"],
        [
            f"first force in a fresh process, caches warm: {', '.join(first)}",
            f"{', '.join(map(rounded, first.values()))} s",
        ],
    ]


def rounded(value: float) -> str:
    """Return a number with two digits."""
    return f"{float(f'{value:.1e}'):g}"


@style.styled
def figure(results: Results) -> Figure:
    """Largest and median error against time per position, a panel for each kind of place; waves by
    the size of the bead.
    """
    drawn = style.new(style.PAGE, 7.8)
    above, below = drawn.subfigures(2, 1, height_ratios=(1.8, 1))
    panels = above.subplots(2, 3, sharex=True, sharey=True)
    for axes, kind in zip(panels.flat, results["places"], strict=False):
        _draw(axes, results["places"][kind])
        axes.set_title(_title(kind))
    for axes in panels[:, 0]:
        axes.set_ylabel("relative error of the force")
    for axes in (*panels[1, :2], panels[0, 2]):
        axes.set_xlabel("time per position (µs)")
        axes.tick_params(labelbottom=True)
    _explain(panels[1, 2])
    waves_report.draw(below.subplots(1, 3), results["waves"])
    return drawn


def _title(kind: str) -> str:
    if kind == STARTS:
        return "the thesis's three\nstarting points"
    low, high = BANDS[kind]
    return f"{kind}: {low:g} to {high:g} radii\nfrom the focus"


def _draw(axes: Axes, families: dict[str, list[dict[str, Any]]]) -> None:
    for family, entries in families.items():
        colour, marker, _ = _STYLES[family]
        times = [entry["us"] for entry in entries]
        largest, median = (
            np.maximum([entry[key] for entry in entries], _FLOOR)
            for key in ("largest_error", "median_error")
        )
        axes.plot(times, largest, color=colour, marker=marker, markersize=3.5, linewidth=1.0)
        axes.plot(times, median, color=colour, linewidth=1, linestyle=":")
    axes.set(xscale="log", yscale="log")
    axes.grid(visible=True)


def _explain(axes: Axes) -> None:
    axes.axis("off")
    handles = [
        Line2D([], [], color=colour, marker=marker, markersize=3.5, linewidth=1.0, label=label)
        for colour, marker, label in _STYLES.values()
    ]
    handles += [
        Line2D([], [], color="0.3", linewidth=1.0, label="largest error of the positions"),
        Line2D([], [], color="0.3", linewidth=1, linestyle=":", label="median error"),
    ]
    axes.legend(handles=handles, loc="center")


def block(results: Results) -> str:
    """Return the block of rays and of all forces by position."""
    return pages.block("force", pages.tables(tables(results))[:-1], results["machine"])


if __name__ == "__main__":
    pages.renew("force", block, figure)
    pages.quote("waves", waves_report.block(pages.committed("force")))
