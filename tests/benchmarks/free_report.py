"""The results of the benchmark of free beads as a table, as a figure, and on their page.

`python -m tests.benchmarks.free_report` writes block and figure from the committed results.
"""

from __future__ import annotations

from matplotlib.figure import Figure
from scipy.stats import binomtest

from tests.benchmarks import pages
from tests.benchmarks.free import Results
from tweezer.plots import style

#: What is counted: its key, tracks or axes, and a heading
COUNTED = (
    ("inside", 1, "both axes"),
    ("alone_inside", 2, "one axis"),
    ("by_covariance_inside", 2, "covariances"),
)


def _named(study: Results) -> str:
    blur = "blurred" if study["exposure"] else "no blur"
    given = ", given" if study["given"] else ""
    return f"{study['frames']} frames, {blur}, noise {study['noise']:g}{given}"


def _share(study: Results, key: str, each: int) -> tuple[int, int]:
    return study[key], each * study["seen_free"]


def tables(results: Results) -> list[list[list[str]]]:
    """Return the table of coverage by study."""
    rows = [
        [
            _named(study),
            f"{100 * study['seen_free'] / study['tracks']:.0f}",
            *(f"{100 * inside / of:.1f}" for inside, of in _shares(study)),
            f"{100 * study['uncertainty']:.1f}",
            f"{study['mean_ratio']:.3f}",
            f"{100 * study['marked'] / study['seen_free']:.1f}",
        ]
        for study in results["studies"]
    ]
    headings = [
        "tracks",
        "free, %",
        *(heading for *_, heading in COUNTED),
        "+-, %",
        "mean",
        "finding, %",
    ]
    return [[headings, *rows]]


def _shares(study: Results) -> list[tuple[int, int]]:
    return [_share(study, key, each) for key, each, _ in COUNTED]


@style.styled
def figure(results: Results) -> Figure:
    """Draw the coverage by study."""
    drawn = style.new(style.PAGE, 3.0)
    axes = drawn.subplots()
    for i, study in enumerate(results["studies"]):
        for j, ((inside, of), (*_, heading)) in enumerate(
            zip(_shares(study), COUNTED, strict=True)
        ):
            low, high = binomtest(inside, of).proportion_ci(0.95)
            at = 100 * inside / of
            axes.errorbar(
                [i + 0.15 * (j - 1)], [at], [[at - 100 * low], [100 * high - at]], ms=4,
                capsize=2, label=heading if i == 0 else None, **style.SERIES[j].points,
            )  # fmt: skip
    axes.axhline(95, color=style.MUTED, linestyle="--", linewidth=0.8)
    names = [_named(study).replace(", ", "\n") for study in results["studies"]]
    axes.set_xticks(range(len(names)), names)
    axes.set(ylabel="coverage of the 95 % interval (%)", ylim=(85, 100.5))
    drawn.legend(loc="outside lower center", ncols=3)
    return drawn


def block(results: Results) -> str:
    """Return the block: the number of tracks and the coverage."""
    told = f"There are {results['studies'][0]['tracks']} tracks of each kind."
    lines = [told, "", *pages.tables(tables(results))[:-1]]
    return pages.block("free", lines, results["machine"])


if __name__ == "__main__":
    pages.renew("free", block, figure)
