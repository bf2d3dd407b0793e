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
    """A row for each key of each study; the first row is that of the headings."""
    headings = [
        "recordings; key", "coverage, %", "of the determined", "bias, %",
        "bias, standard uncertainties", "half an interval, %",
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
    *_, last = results["studies"]
    explained = (
        "The recordings are 1 um silica beads in 10 mW, 1.5 um polystyrene beads in 20 mW and 3 um "
        "silica beads in 20 mW, simulated with the force map. A run has 10,000 samples at "
        "intervals of 10, 50 or 200 us or 1 ms. A camera takes 5,000 frames at intervals of 50 or "
        "200 us or 1 ms. It is exposed all the time and has a noise of 3 nm (15 nm along the "
        "light). The motion includes the inertia of bead and fluid unless stated otherwise. "
        "`tweezer fit` starts with a diameter that is wrong by 6 % and a power that is wrong by "
        "30 %. The table lists how often the 95 % confidence interval contains the true value: "
        "for all recordings, and for those whose key is determined. If the viscosity is free too, "
        "the fit reports:"
    )
    lines = [
        *textwrap.wrap(explained, 110), "",
        *textwrap.wrap(last["statement"], 110, initial_indent="> ", subsequent_indent="> "), "",
        *pages.tables(tables(results)),
        "![Coverage of fits of a scene](figures/bench-fit.png)",
    ]  # fmt: skip
    return pages.block("fit", lines, results["machine"])


if __name__ == "__main__":
    pages.renew("fit", block, figure)
