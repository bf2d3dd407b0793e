"""Results of the benchmark of camera images as a table, as a figure, and on their page.

`python -m tests.benchmarks.camera_report` writes block and figure from the committed results.
"""

from __future__ import annotations

import textwrap

from matplotlib.figure import Figure
from scipy.stats import binomtest

from tests.benchmarks import pages
from tests.benchmarks.calibrate_report import METHODS
from tests.benchmarks.camera import Results
from tweezer.plots import style


def pooled(study: Results) -> dict[str, tuple[int, int]]:
    """Return, by method, the results without a finding and those that contain the true value."""
    found = {}
    for method in METHODS:
        own = [each for each in study["numbers"] if each["by"].endswith(f", {method}")]
        if own:
            found[method] = (
                sum(each["numbers"] for each in own), sum(each["inside"] for each in own)
            )  # fmt: skip
    return found


def _named(study: Results) -> str:
    drag = "given" if study["drag_given"] else "fitted"
    return f"{study['rate']:.0f} per second, drag {drag}"


def tables(results: Results) -> list[list[list[str]]]:
    """Return the table of coverage by method."""
    rows = []
    for study in results["studies"]:
        own = pooled(study)
        cells = [
            f"{100 * own[method][1] / own[method][0]:.1f} ({own[method][0]})"
            if method in own
            else ""
            for method in METHODS
        ]
        rows.append([_named(study), *cells])
    return [[["frames", *METHODS.values()], *rows]]


@style.styled
def figure(results: Results) -> Figure:
    """Draw the coverage of results without a finding, by method."""
    drawn = style.new(style.PAGE, 3.0)
    axes = drawn.subplots()
    for i, study in enumerate(results["studies"]):
        for method, (count, inside) in pooled(study).items():
            j = list(METHODS).index(method)
            low, high = binomtest(inside, count).proportion_ci(0.95)
            at = 100 * inside / count
            axes.errorbar(
                [i + 0.12 * (j - 2.5)], [at], [[at - 100 * low], [100 * high - at]], ms=4,
                capsize=2, label=METHODS[method] if i == 0 else None, **style.SERIES[j].points,
            )  # fmt: skip
    axes.axhline(95, color=style.MUTED, linestyle="--", linewidth=0.8)
    axes.set_xticks(
        range(len(results["studies"])),
        [_named(each).replace(", ", "\n") for each in results["studies"]],
    )
    axes.set(ylabel="coverage of the 95 % interval (%)", ylim=(85, 100.5))
    drawn.legend(loc="outside lower center", ncols=6)
    return drawn


def block(results: Results) -> str:
    """Return the block: the trap, the number of runs and the coverage."""
    k, first = results["stiffness"], results["studies"][0]
    simulated = (
        f"There are {first['records']} runs of each kind in a trap of {1e6 * k['x']:.1f}, "
        f"{1e6 * k['y']:.1f} and {1e6 * k['z']:.1f} pN/µm along x, y and z. The noise of the "
        f"camera is {1e9 * first['noise']:.0f} nm across the light and four times that along it."
    )
    lines = [*textwrap.wrap(simulated, 110), "", *pages.tables(tables(results))[:-1]]
    return pages.block("camera", lines, results["machine"])


if __name__ == "__main__":
    pages.renew("camera", block, figure)
