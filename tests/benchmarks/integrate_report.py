"""The results of the integration benchmark as tables, as a figure, and on its page.

`python -m tests.benchmarks.integrate_report` writes its block and its figure anew from the
committed results.
"""

from __future__ import annotations

import textwrap
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from tests.benchmarks import pages
from tests.benchmarks.integrate import Results
from tests.benchmarks.report import rounded

_STYLES = {
    ("full", "exponential"): ("#004488", "o", "unscaled, exponential"),
    ("first-order", "dop853"): ("#228833", "D", "first order, DOP853"),
    ("first-order", "dormand-prince"): ("#66ccaa", "d", "first order, Dormand-Prince"),
    ("overdamped", "dop853"): ("#bbbbbb", "s", "no inertia, DOP853"),
    ("full", "dormand-prince"): ("#aa3377", "^", "unscaled, Dormand-Prince"),
    ("full", "dop853"): ("#aa3377", "v", "unscaled, DOP853"),
    ("full", "scipy:LSODA"): ("#ee6677", "x", "unscaled, SciPy LSODA"),
    ("full", "scipy:Radau"): ("#ee8866", "+", "unscaled, SciPy Radau"),
    ("full", "scipy:BDF"): ("#eedd88", "1", "unscaled, SciPy BDF"),
    ("full", "scipy:RK45"): ("#6699cc", "<", "unscaled, SciPy RK45"),
    ("full", "scipy:DOP853"): ("#225522", ">", "unscaled, SciPy DOP853"),
    ("full", "heyoka"): ("#000000", "*", "unscaled, heyoka"),
    ("scaled", "dormand-prince"): ("#ddaa33", "P", "thesis's scaling, ε to 1, Dormand-Prince"),
    ("scaled", "numpy"): ("#bb5566", "X", "NumPy sum, SciPy RK45, thesis's scaling"),
}


def tables(results: Results) -> list[list[list[str]]]:
    """A table for each motion, and what was not taken; the first row is that of the headings."""
    entries = [
        [
            [label, "tolerance", "error before, µm", "in the trap, µm", "ms", "force calls"],
            *(
                [
                    f"{entry['model']}, {entry['method']}", _setting(entry),
                    f"{entry['before_um']:.1e}", f"{entry['during_um']:.1e}",
                    rounded(entry["ms"]), f"{entry['force_calls']}",
                ]
                for entry in of["entries"]
            ),
        ]
        for label, of in results["motions"].items()
    ]  # fmt: skip
    return [*entries, pages.as_table(left_out(results))]


def converged(entries: list[dict[str, Any]], model: str) -> dict[str, Any]:
    """The run of a model at DOP853's tightest tolerance, whose error is the model's own."""
    return min(
        (each for each in entries if (each["model"], each["method"]) == (model, "dop853")),
        key=lambda each: each["tolerance"],
    )


def _setting(entry: dict[str, Any]) -> str:
    if "scaling_factor" in entry:
        return f"a2 = {entry['scaling_factor']:.2g}"
    return f"{entry['tolerance']:.0e}"


def figure(results: Results) -> Figure:
    """Error in the trap against time, and against force calls, a column for each motion."""
    motions = {label: of for label, of in results["motions"].items() if "quadrature" not in label}
    drawn = Figure(figsize=(3.4 * len(motions), 7.4), layout="constrained")
    panels = drawn.subplots(2, len(motions), sharey=True, squeeze=False)
    for column, (label, of) in enumerate(motions.items()):
        _draw(panels[0, column], of["entries"], "ms")
        _draw(panels[1, column], of["entries"], "force_calls")
        panels[0, column].set_title(label, fontsize=10)
        panels[0, column].set_xlabel("time, ms")
        panels[1, column].set_xlabel("force calls")
    for axes in panels[:, 0]:
        axes.set_ylabel("largest error in the trap, µm")
    handles = [
        Line2D([], [], color=colour, marker=marker, linewidth=1, markersize=5, label=label)
        for colour, marker, label in _STYLES.values()
    ]
    drawn.legend(handles=handles, loc="outside lower center", ncols=3, frameon=False, fontsize=8)
    return drawn


def _draw(axes: Axes, entries: list[dict[str, Any]], key: str) -> None:
    for (model, method), (colour, marker, _) in _STYLES.items():
        named = [e for e in entries if (e["model"], e["method"]) == (model, method) and e[key] > 0]
        if named:
            axes.plot(
                [e[key] for e in named], np.maximum([e["during_um"] for e in named], 1e-10),
                color=colour, marker=marker, linewidth=1, markersize=5,
            )  # fmt: skip
    axes.set(xscale="log", yscale="log")
    axes.grid(color="0.9", linewidth=0.6)
    axes.set_axisbelow(True)


def block(results: Results) -> str:
    """Its part of the page, between its markers."""
    explained = (
        "Each bead is released from rest where the thesis releases it and followed until it rests "
        "in the trap. Errors: largest distance to the unscaled motion once the bead is within two "
        "radii of the focus; that motion is known from two solvers, the exponential method and "
        "SciPy's LSODA. `2e-6 µm` is the fastest run with at most that error in the trap, and "
        "2e-8 µm before it. The first order's own error is that at DOP853's tightest tolerance, "
        "to which its runs converge; a looser run may by luck be nearer. Times are of the steps, "
        "compiled, steady state, one core. How many times slower: the largest ratio, over the "
        "tolerances of both, to a run of ours that is no less exact."
    )
    lines = [*textwrap.wrap(explained, 110), ""]
    table = [
        ("motion, force", "two solvers agree to, µm", "exponential at 2e-6 µm, ms",
         "first order at 2e-6 µm, ms", "its own error, µm", "SciPy LSODA, up to times slower",
         "NumPy, SciPy, scaled: up to times slower", "its error, µm"),
    ]  # fmt: skip
    for label, of in results["headline"].items():
        lsoda, baseline = of.get("scipy:LSODA"), of.get("numpy")
        own = converged(results["motions"][label]["entries"], "first-order")
        table.append(
            (
                label, f"{of['solvers_agree_to_um']:.1e}", _or_none(of["full_ms_at_2e-6_um"]),
                _or_none(of["first-order_ms_at_2e-6_um"]),
                f"{own['during_um']:.1e}",
                rounded(lsoda["times_slower"]) if lsoda else "",
                rounded(baseline["times_slower"]) if baseline else "",
                f"{baseline['error_um']:.1e}" if baseline else "",
            )
        )  # fmt: skip
    lines += pages.markdown(table[0], table[1:])
    lines += [
        "",
        "![Error against time and work of the integration](figures/bench-integrate.png)",
        *left_out(results),
    ]
    return pages.block("integrate", lines, results["machine"])


def left_out(results: Results) -> list[str]:
    """What was not taken, by reason and motion, as a list."""
    grouped: dict[str, dict[str, list[str]]] = {}
    for each in results["left_out"]:
        scaled = f", a2 = {each['scaling_factor']:.2g}" if "scaling_factor" in each else ""
        named = f"{each['model']}{scaled} by {each['method']}"
        grouped.setdefault(each["left_out"], {}).setdefault(each["motion"], []).append(named)
    return pages.left_out(grouped)


def _or_none(value: float | None) -> str:
    return "not reached" if value is None else rounded(value)


if __name__ == "__main__":
    pages.renew("integrate", block, figure)
