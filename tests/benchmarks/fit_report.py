"""The results of the benchmark of fits as a table, as a figure, and on their page.

`python -m tests.benchmarks.fit_report` writes block and figure from the committed results.
"""

from __future__ import annotations

import textwrap

from matplotlib.figure import Figure

from tests.benchmarks import pages
from tests.benchmarks.fit import Results
from tweezer import style


def tables(results: Results) -> list[list[list[str]]]:
    """A row for each key of each study; the first row is that of the headings."""
    headings = ["records; key", "coverage, %", "bias, %", "half an interval, %", "determined"]
    rows = [
        [
            f"{study['name']}; {key}",
            f"{100 * of['inside'] / study['records']:.0f} "
            f"({100 * of['inside_from']:.0f} to {100 * of['inside_to']:.0f})",
            f"{100 * of['bias']:z.2f} ± {100 * of['bias_error']:.2f}",
            "open" if of["half_interval"] is None else f"{100 * of['half_interval']:.1f}",
            f"{of['determined']} of {study['records']}",
        ]
        for study in results["studies"]
        for key, of in study["keys"].items()
    ]
    return [[headings, *rows]]


@style.styled
def figure(results: Results) -> Figure:
    """Coverage of each key, with its own 95 % interval."""
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
            names.append(f"{study['name']}: {key}")
    axes.axvline(95, color=style.MUTED, lw=0.8, ls="--")
    axes.set_yticks(range(len(names)), names)
    axes.invert_yaxis()
    axes.set_xlabel("coverage (%)")
    return drawn


def block(results: Results) -> str:
    """Its part of the page, between its markers."""
    first, *_, last = results["studies"]
    explained = (
        f"Recordings of a 1 um silica bead in 10 mW, {first['frames']:,} frames at "
        f"{first['rate_Hz']:.0f} a second, exposed all the time, with 3 nm of noise (15 nm along "
        "the light), are of an ensemble by the map of the force. `tweezer fit` begins 6 % off in "
        "the diameter and 30 % off in the power, with the force of the quadrature. Counted is how "
        "often the 95 % interval holds what is true. Where the viscosity is free too, in the "
        f"plane, it says: “{last['statement']}”."
    )
    lines = [
        *textwrap.wrap(explained, 110), "", *pages.tables(tables(results)),
        "![Coverage of fits of a scene](figures/bench-fit.png)",
    ]  # fmt: skip
    return pages.block("fit", lines, results["machine"])


if __name__ == "__main__":
    pages.renew("fit", block, figure)
