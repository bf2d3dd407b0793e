"""The results of the benchmark of fast recordings as tables, as a figure, and on their page.

`python -m tests.benchmarks.hydro_report` writes block and figure from the committed results.
"""

from __future__ import annotations

import textwrap

from matplotlib.figure import Figure
from scipy.stats import binomtest

from tests.benchmarks import pages
from tests.benchmarks.hydro import Results
from tweezer.plots import style
from tweezer.values.signs import typeset

#: ways of the figure
WAYS = ("volts", "pylake", "pylake, as called", "volts, no inertia", "pylake, no inertia")
NAMES = {
    "volts": "tweezer", "volts, no inertia": "tweezer, no inertia", "diode_frequency": "diode, f3",
    "diode_fraction": "diode, a", "exposure": "blur",
}  # fmt: skip


def tables(results: Results) -> list[list[list[str]]]:
    """Return a table for each kind of recordings."""
    studies = results["studies"]
    headings = ["coverage, %", "bias, sd", "bias, %", "+-, %"]
    passive = [study for study in studies if study["kind"] == "passive"]
    return [
        [
            ["in volts: bead; rate; program", "k: coverage, %", "bias, sd", "+-, %",
             "m/V: coverage, %", "bias, sd", "+-, %"],
            *(row for study in passive for row in _in_volts(study)),
        ],
        [
            ["in metres, all studies: quantity; method", *headings[:2]],
            *_pooled_rows(passive),
        ],
        [
            ["detector; quantity", "determined", *headings],
            *(row for study in studies if study["kind"] == "detector" for row in _rows(study)),
        ],
        [
            ["stage; quantity; program", "determined", *headings],
            *(row for study in studies if study["kind"] == "driven" for row in _rows(study)),
        ],
    ]  # fmt: skip


def _in_volts(study: Results) -> list[list[str]]:
    by = {(each["by"], each["quantity"]): each for each in study["numbers"]}
    return [
        [f"{study['name'].replace(',', ';')}; {NAMES.get(way, way)}",
         *_cells(by[way, "stiffness"]), *_cells(by[way, "m/V"])]
        for way in WAYS
        if (way, "stiffness") in by
    ]  # fmt: skip


def _cells(each: Results) -> list[str]:
    return [_inside(each), f"{each['mean_score']:.2f}", f"{100 * each['uncertainty']:.2f}"]


def _inside(each: Results) -> str:
    return f"{100 * each['inside'] / each['numbers']:.1f}"


def _pooled_rows(studies: list[Results]) -> list[list[str]]:
    """Return the rows of the methods in metres, over all studies."""
    every: dict[tuple[str, str], list[Results]] = {}
    for study in studies:
        for each in study["numbers"]:
            if each["by"] not in WAYS:
                every.setdefault((each["quantity"], each["by"]), []).append(each)
    told = []
    for (quantity, by), found in every.items():
        numbers = sum(each["numbers"] for each in found)
        inside = sum(each["inside"] for each in found)
        bias = sum(each["numbers"] * each["mean_score"] for each in found) / numbers
        told.append([f"{quantity}; {by}", f"{100 * inside / numbers:.1f}", f"{bias:.2f}"])
    return told


def _rows(study: Results) -> list[list[str]]:
    """Return the rows of a study with a detector or a stage."""
    told = []
    for each in study["numbers"]:
        quantity, by = (NAMES.get(each[name], each[name]) for name in ("quantity", "by"))
        named = [study["name"], quantity, *([by] if study["kind"] == "driven" else [])]
        told.append(
            [
                "; ".join(named), f"{each['numbers']}", _inside(each), f"{each['mean_score']:.2f}",
                f"{100 * each['bias']:.2f}", f"{100 * each['uncertainty']:.2f}",
            ]
        )  # fmt: skip
    return told


def pooled(results: Results, kind: str, by: str, quantity: str | None = None) -> tuple[int, int]:
    """Return the number of results, and of intervals that contain the true value."""
    numbers = [
        each
        for study in results["studies"]
        if study["kind"] == kind
        for each in study["numbers"]
        if each["by"] == by and quantity in (None, each["quantity"])
    ]
    return sum(each["numbers"] for each in numbers), sum(each["inside"] for each in numbers)


@style.styled
def figure(results: Results) -> Figure:
    """Draw the bias and the coverage of stiffness and sensitivity in volts."""
    drawn = style.new(style.PAGE, 4.2)
    panels = drawn.subplots(2, 2, sharex=True)
    studies = [study for study in results["studies"] if study["kind"] == "passive"]
    for column, quantity in enumerate(("stiffness", "m/V")):
        for j, (way, mark) in enumerate(zip(WAYS, style.SERIES, strict=False)):
            for i, study in enumerate(studies):
                found = [
                    each
                    for each in study["numbers"]
                    if (each["by"], each["quantity"]) == (way, quantity)
                ]
                if not found:
                    continue
                (each,) = found
                at = i + 0.12 * (j - 2)
                label = NAMES.get(way, way) if i == column == 0 else None
                panels[0, column].errorbar(
                    [at], [100 * each["bias"]], [196 * each["uncertainty"]],
                    capsize=2, label=label, **mark.points,
                )  # fmt: skip
                low, high = binomtest(each["inside"], each["numbers"]).proportion_ci(0.95)
                inside = each["inside"] / each["numbers"]
                panels[1, column].errorbar(
                    [at], [100 * inside], [[100 * (inside - low)], [100 * (high - inside)]],
                    capsize=2, **mark.points,
                )  # fmt: skip
        panels[0, column].axhline(0, color=style.MUTED, linestyle="--", linewidth=0.8)
        panels[1, column].axhline(95, color=style.MUTED, linestyle="--", linewidth=0.8)
        panels[0, column].set_title(
            {"stiffness": "stiffness", "m/V": "displacement sensitivity (m/V)"}[quantity]
        )
        panels[1, column].set_xticks(
            range(len(studies)),
            [typeset(study["name"].replace(", ", "\n")) for study in studies],
        )
    panels[0, 0].set_ylabel("bias, 95 % interval (%)")
    panels[1, 0].set_ylabel("coverage (%)")
    drawn.legend(loc="outside lower center", ncols=5)
    return drawn


def block(results: Results) -> str:
    """Return the block: pooled coverage, and the tables of each kind of recordings."""
    first = results["studies"][0]
    pooled_shares = [
        ("in volts, tweezer", pooled(results, "passive", "volts")),
        (f"in volts, lumicks.pylake {results['pylake']}", pooled(results, "passive", "pylake")),
        ("in metres, fitted drag", pooled(results, "passive", "power spectrum, drag fitted")),
        ("fitted detector, stiffness", pooled(results, "detector", "drag fitted", "stiffness")),
        ("driven stage, all three quantities", pooled(results, "driven", "volts")),
    ]
    sampled = (
        f"There are {first['records']} recordings of each kind, with {first['samples']:,} samples "
        f"each, in a trap of {1e6 * first['stiffness']:.0f} pN/µm."
    )
    shares = pages.markdown(
        ("all studies of a kind", "coverage"), [(name, _share(of)) for name, of in pooled_shares]
    )
    lines = [*textwrap.wrap(sampled, 110), "", *shares, "", *pages.tables(tables(results))[:-1]]
    return pages.block("hydro", lines, results["machine"])


def _share(of: tuple[int, int]) -> str:
    numbers, inside = of
    return f"{100 * inside / max(numbers, 1):.1f} %"


if __name__ == "__main__":
    pages.renew("hydro", block, figure)
