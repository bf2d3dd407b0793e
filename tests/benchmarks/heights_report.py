"""The results of the benchmark of calibration beside a wall as tables, a figure, and on their page.

`python -m tests.benchmarks.heights_report` writes block and figure from the committed results.
"""

from __future__ import annotations

import textwrap
from collections.abc import Callable

from matplotlib.figure import Figure
from scipy.stats import binomtest

from tests.benchmarks import pages
from tests.benchmarks.heights import RADIUS, Results
from tweezer.plots import style

#: ways of the figure, with their colours
WAYS = {"x": style.SERIES[0].colour, "z": style.SERIES[1].colour}
#: quantities that a calibration gives
QUANTITIES = ("stiffness", "drag", "m/V")


def tables(results: Results) -> list[list[list[str]]]:
    """Of each kind of records; the first row of each is that of the headings."""
    headings = ["inside, %", "bias, sd", "bias, %", "+-, %"]
    return [
        [
            ["height given, no inertia: axis; gap in radii; quantity", *headings],
            *_rows(results, "steady", lambda by: "metres" in by or "volts" in by),
        ],
        [
            ["height off by a tenth of the gap, as is said", *headings],
            *_rows(results, "steady", lambda by: "uncertain" in by),
        ],
        [
            ["driven stage, in volts", *headings],
            *_rows(results, "driven", lambda by: True),
        ],
        [
            ["with the inertia of the fluid", *headings],
            *_rows(results, "fluid", lambda by: True),
        ],
        [
            ["the wall found, by five heights; quantity", *headings],
            *_rows(results, "series", lambda by: True),
        ],
    ]  # fmt: skip


def _rows(results: Results, kind: str, wanted: Callable[[str], bool]) -> list[list[str]]:
    """Numbers of records of one kind; of volts only what metres do not tell."""
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
    """How many numbers there are, and how many intervals hold the truth.

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
    """Coverage of stiffness, drag and metres a volt against the gap, of x and z."""
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
                way = "along" if axis == "x" else "across"
                panel.errorbar(
                    gaps, inside, bars, fmt=marker, ms=3.5, capsize=2, color=colour,
                    mfc=colour if filled else "white",
                    label=f"{way}{'' if filled else ', fluid with inertia'}",
                )  # fmt: skip
        panel.axhline(95, color=style.MUTED, linestyle="--", linewidth=0.8)
        panel.set(xscale="log", xlabel="gap (radii)", title=_NAMES.get(quantity, quantity))
        panel.set_xticks([0.2, 0.5, 1, 2, 5], ["0.2", "0.5", "1", "2", "5"])
        panel.minorticks_off()
    panels[0].set_ylabel("coverage (%)")
    handles, labels = panels[0].get_legend_handles_labels()
    drawn.legend(handles, labels, loc="outside lower center", ncols=4)
    return drawn


_NAMES = {"m/V": "metres a volt"}


def block(results: Results) -> str:
    """Its part of the page, between its markers."""
    steady = next(study for study in results["studies"] if study["kind"] == "steady")
    fluid = next(study for study in results["studies"] if study["kind"] == "fluid")

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
    explained = (
        f"{steady['records']} records of a {2e6 * RADIUS:g} um bead at each height are drawn "
        "exactly, with the mobilities of the exact series along (x) and across (z) the wall; "
        f"{steady['samples']:,} samples, {steady['rate'] / 1e3:g} kHz, a trap of "
        f"{1e6 * steady['stiffness']:g} pN/um. Counted is how often the 95 % interval holds what "
        "is true, as above. With the height given, it holds the stiffness in "
        f"{known['stiffness']}, the drag in {known['drag']} and the metres a volt in "
        f"{known['m/V']}; across the wall all of them in {across}. With a height that is off by "
        "a tenth of the gap, one standard uncertainty of which is said: "
        f"{share('steady', lambda by, _: 'uncertain' in by)}. With a driven stage, which needs no "
        f"drag ({fluid['records']} records, as of those that follow): "
        f"{share('driven', lambda by, _: True)}. With the inertia of the fluid, at "
        f"{fluid['rate'] / 1e3:g} kHz, the records have the drag of the flow that the wall "
        f"reflects: {share('fluid', lambda by, _: 'pylake' not in by)}; by lumicks.pylake "
        f"{results['pylake']}, which has the usual formula for the drag along a wall, "
        f"{share('fluid', lambda by, _: 'pylake' in by)}. The wall found by records at five "
        "heights, where the drag far away and by how much the bead moves with the focus are given "
        f"or fitted: {share('series', lambda by, of: True)} (its bias is over the nearest height)."
    )
    lines = [
        *textwrap.wrap(explained, 110), "", *pages.tables(tables(results)),
        "![Coverage of calibrations beside a wall](figures/bench-heights.png)",
    ]  # fmt: skip
    return pages.block("heights", lines, results["machine"])


if __name__ == "__main__":
    pages.renew("heights", block, figure)
