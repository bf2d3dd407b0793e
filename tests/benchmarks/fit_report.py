"""The results of the benchmark of fits as a table, as a figure, and on their page.

`python -m tests.benchmarks.fit_report` writes block and figure from the committed results.
"""

from __future__ import annotations

import textwrap

from matplotlib.figure import Figure

from tests.benchmarks import pages
from tests.benchmarks.fit import Results
from tweezer.plots import style


def tables(results: Results) -> list[list[list[str]]]:
    """Return the table with a row for each key of each study."""
    headings = [
        "recordings; key", "coverage, %", "covered, of the determined", "bias, %",
        "bias, standard uncertainties", "half interval, %",
    ]  # fmt: skip
    rows = [
        [
            f"{study['name']}; {key}",
            f"{100 * of['inside'] / study['records']:.0f} "
            f"({100 * of['inside_from']:.0f} to {100 * of['inside_to']:.0f})",
            f"{of['determined_inside']} of {of['determined']}",
            f"{100 * of['bias']:z.2f} ± {100 * of['bias_error']:.2f}",
            "-" if of["score"] is None else f"{of['score']:z.2f} ± {of['score_error']:.2f}",
            "open" if of["half_interval"] is None else f"{100 * of['half_interval']:.1f}",
        ]
        for study in results["studies"]
        for key, of in study["keys"].items()
    ]
    return [[headings, *rows]]


@style.styled
def figure(results: Results) -> Figure:
    """Draw the coverage of each key, with its own 95 % interval."""
    drawn = style.new(style.PAGE, 2.6)
    axes = drawn.subplots()
    names = []
    for study in results["studies"]:
        for key, of in study["keys"].items():
            at = 100 * of["inside"] / study["records"]
            ends = [[at - 100 * of["inside_from"]], [100 * of["inside_to"] - at]]
            axes.errorbar(
                at, len(names), xerr=ends, fmt="o", color=style.SERIES[0].colour, capsize=2
            )
            alone = " alone" if len(study["keys"]) == 1 else ""
            names.append(f"{study['name']}: {key}{alone}")
    axes.axvline(95, color=style.MUTED, lw=0.8, ls="--")
    axes.set_yticks(range(len(names)), names)
    axes.invert_yaxis()
    axes.set_xlabel("coverage (%)")
    return drawn


def block(results: Results) -> str:
    """Return the block: the coverage of each key, and what a fit with free viscosity reports."""
    *_, last = results["studies"]
    lines = [
        *pages.tables(tables(results)),
        "If the viscosity is free too, the fit reports:", "",
        *textwrap.wrap(last["statement"], 110, initial_indent="> ", subsequent_indent="> "),
    ]  # fmt: skip
    return pages.block("fit", lines, results["machine"])


if __name__ == "__main__":
    pages.renew("fit", block, figure)
