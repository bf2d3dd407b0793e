"""The results of the benchmark of calibration beside a wall as tables, a figure, and on their page.

`python -m tests.benchmarks.heights_report` writes block and figure from the committed results.
"""

from __future__ import annotations

import textwrap
from collections.abc import Callable

from matplotlib.figure import Figure
from scipy.stats import binomtest

from tests.benchmarks import pages
from tests.benchmarks.heights import Results
from tweezer.plots import style

#: ways of the figure, with their colours
WAYS = {"x": style.SERIES[0].colour, "z": style.SERIES[1].colour}
#: quantities that a calibration gives
QUANTITIES = ("stiffness", "drag", "m/V")


def tables(results: Results) -> list[list[list[str]]]:
    """Return a table for each kind of recordings."""
    headings = ["coverage, %", "bias, sd", "bias, %", "+-, %"]
    return [
        [
            ["given height: axis; gap in radii; quantity", *headings],
            *_rows(results, "steady", lambda by: "metres" in by or "volts" in by),
        ],
        [
            ["uncertain height", *headings],
            *_rows(results, "steady", lambda by: "uncertain" in by),
        ],
        [
            ["driven stage, in volts", *headings],
            *_rows(results, "driven", lambda by: True),
        ],
        [
            ["fluid inertia", *headings],
            *_rows(results, "fluid", lambda by: True),
        ],
        [
            ["five heights: given or fitted; quantity", *headings],
            *_rows(results, "series", lambda by: True),
        ],
    ]  # fmt: skip


def _rows(results: Results, kind: str, wanted: Callable[[str], bool]) -> list[list[str]]:
    """Return the rows of one kind of recordings; in volts only the sensitivity."""
    told = []
    for study in results["studies"]:
        for each in study["numbers"] if study["kind"] == kind else []:
            by = each["by"].split(", ")
            if not wanted(each["by"]) or (by[-1] == "volts" and each["quantity"] != "m/V"):
                continue
            named = [each["by"], each["quantity"]]
            if kind != "series":
                named = [by[0], f"{study['gaps'][0]:g}", each["quantity"]]
                if by[-1] == "pylake":
                    named.append("pylake")
            told.append(
                [
                    "; ".join(named), _inside(each), f"{each['mean_score']:.2f}",
                    f"{100 * each['bias']:.2f}", f"{100 * each['uncertainty']:.2f}",
                ]
            )  # fmt: skip
    return told


def _inside(each: Results) -> str:
    return f"{100 * each['inside'] / each['numbers']:.1f}"


def pooled(results: Results, kind: str, wanted: Callable[[str, str], bool]) -> tuple[int, int]:
    """Return the number of results, and of intervals that contain the true value.

    wanted: of the way and the quantity.
    """
    numbers = [
        each
        for study in results["studies"]
        if study["kind"] == kind
        for each in study["numbers"]
        if wanted(each["by"], each["quantity"])
    ]
    return sum(each["numbers"] for each in numbers), sum(each["inside"] for each in numbers)


@style.styled
def figure(results: Results) -> Figure:
    """Draw the coverage of stiffness, drag and sensitivity against the gap, for x and z."""
    drawn = style.new(style.PAGE, 2.8)
    panels = drawn.subplots(1, 3, sharex=True, sharey=True)
    for panel, quantity in zip(panels, QUANTITIES, strict=True):
        for axis, colour in WAYS.items():
            by = f"{axis}, {'volts' if quantity == 'm/V' else 'metres'}"
            for kind, marker, filled in (("steady", "o", True), ("fluid", "s", False)):
                points = [
                    (study["gaps"][0], each["inside"], each["numbers"])
                    for study in results["studies"]
                    if study["kind"] == kind
                    for each in study["numbers"]
                    if (each["by"], each["quantity"]) == (by, quantity)
                ]
                gaps = [gap * (0.96 if axis == "x" else 1.04) for gap, *_ in points]
                inside = [100 * count / number for _, count, number in points]
                ends = [binomtest(count, number).proportion_ci(0.95) for _, count, number in points]
                bars = [
                    [here - 100 * low for here, (low, _) in zip(inside, ends, strict=True)],
                    [100 * high - here for here, (_, high) in zip(inside, ends, strict=True)],
                ]
                way = "parallel to the wall" if axis == "x" else "perpendicular"
                panel.errorbar(
                    gaps, inside, bars, fmt=marker, ms=3.5, capsize=2, color=colour,
                    mfc=colour if filled else "white",
                    label=f"{way}{'' if filled else ', with fluid inertia'}",
                )  # fmt: skip
        panel.axhline(95, color=style.MUTED, linestyle="--", linewidth=0.8)
        panel.set(xscale="log", xlabel="gap (radii)", title=_NAMES.get(quantity, quantity))
        panel.set_xticks([0.2, 0.5, 1, 2, 5], ["0.2", "0.5", "1", "2", "5"])
        panel.minorticks_off()
    panels[0].set_ylabel("coverage (%)")
    handles, labels = panels[0].get_legend_handles_labels()
    drawn.legend(handles, labels, loc="outside lower center", ncols=4)
    return drawn


_NAMES = {"m/V": "displacement sensitivity"}
#: quantities in the table of pooled coverage
_LONG = {"stiffness": "stiffness", "drag": "drag", "m/V": "displacement sensitivity"}


def block(results: Results) -> str:
    """Return the block: the recordings, pooled coverage and the tables of each kind."""
    steady = next(study for study in results["studies"] if study["kind"] == "steady")
    fluid = next(study for study in results["studies"] if study["kind"] == "fluid")
    series = next(study for study in results["studies"] if study["kind"] == "series")

    def share(kind: str, wanted: Callable[[str, str], bool]) -> str:
        numbers, inside = pooled(results, kind, wanted)
        return f"{100 * inside / max(numbers, 1):.1f} %"

    known = {
        quantity: share(
            "steady",
            lambda by, of, quantity=quantity: (
                of == quantity and by.endswith("volts" if quantity == "m/V" else "metres")
            ),
        )
        for quantity in QUANTITIES
    }
    across = share("steady", lambda by, _: by.startswith("z, ") and "uncertain" not in by)
    pooled_shares = [
        *((f"given height, {name}", known[quantity]) for quantity, name in _LONG.items()),
        ("given height, across the wall, all quantities", across),
        ("uncertain height", share("steady", lambda by, _: "uncertain" in by)),
        ("driven stage", share("driven", lambda by, _: True)),
        ("fluid inertia, tweezer", share("fluid", lambda by, _: "pylake" not in by)),
        (
            f"fluid inertia, lumicks.pylake {results['pylake']}",
            share("fluid", lambda by, _: "pylake" in by),
        ),
        ("five heights", share("series", lambda by, _: True)),
    ]
    sampled = (
        f"The trap has {1e6 * steady['stiffness']:g} pN/µm. With a given or uncertain height there "
        f"are {steady['records']} recordings at each height, with {steady['samples']:,} samples at "
        f"{steady['rate'] / 1e3:g} kHz. Driven stage and fluid inertia have {fluid['records']} "
        f"recordings each, those with fluid inertia at {fluid['rate'] / 1e3:g} kHz. There are "
        f"{series['records']} series of five heights."
    )
    lines = [
        *textwrap.wrap(sampled, 110), "",
        *pages.markdown(("all recordings of a kind", "coverage"), pooled_shares), "",
        *pages.tables(tables(results))[:-1],
    ]  # fmt: skip
    return pages.block("heights", lines, results["machine"])


if __name__ == "__main__":
    pages.renew("heights", block, figure)
