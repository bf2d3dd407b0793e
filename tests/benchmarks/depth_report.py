"""The results of the benchmark of depths as a table, as a figure, and on their page.

`python -m tests.benchmarks.depth_report` writes block and figure from the committed results.
"""

from __future__ import annotations

from matplotlib.figure import Figure

from tests.benchmarks import pages
from tests.benchmarks.depth import Results
from tweezer.plots import style


def tables(results: Results) -> list[list[list[str]]]:
    """Return the tables by bead and by camera."""
    beads = [
        ["tracks", "frames per second", "noise, nm", "coverage, %", "where determined, %",
         "bias, nm", "interval, nm", "bias / interval", "median interval, nm", "not determined",
         "time of a fit, s"],
        *(
            [
                *_tracks(each), _coverage(each),
                _coverage(each["determined"]) if "determined" in each else "none",
                f"{1e9 * each['bias_m']:z.0f} ± {1e9 * each['bias_error_m']:.0f}",
                f"{1e9 * each['interval_m']:.0f}", f"{each['bias_of_interval']:z.2f}",
                *_found(each),
            ]
            for each in results["beads"]
        ),
    ]  # fmt: skip
    cameras = [
        ["tracks", "frames per second", "noise, nm", "median interval, nm", "not determined",
         "time of a fit, s"],
        *([*_tracks(each), *_found(each)] for each in results["cameras"]),
    ]  # fmt: skip
    return [beads, cameras]


def _tracks(of: Results) -> list[str]:
    return [
        f"{of['tracks']} of {_motion(of)}", f"{of['rate_Hz']:.0f}", f"{1e9 * of['noise_m']:.0f}"
    ]  # fmt: skip


def _motion(of: Results) -> str:
    beside = ", beside a wall" if of["wall"] else ""
    fitted = f", {of['fit']} fitted" if of["fit"] else ""
    return f"{of['scene']}{beside}{fitted}"


def _found(of: Results) -> list[str]:
    return [
        f"{1e9 * of['median_interval_m']:.0f}", f"{of['undetermined']}", f"{of['seconds']:.1f}"
    ]  # fmt: skip


def _coverage(of: Results) -> str:
    values = (100 * of[key] for key in ("coverage", "coverage_from", "coverage_to"))
    return "{:.1f} ({:.1f} to {:.1f})".format(*values)


@style.styled
def figure(results: Results) -> Figure:
    """Draw the coverage of each bead, and the interval against the noise."""
    drawn = style.new(style.PAGE, 3.3)
    coverage, length = drawn.subplots(1, 2)
    for i, each in enumerate(results["beads"]):
        at = 100 * each["coverage"]
        ends = [[at - 100 * each["coverage_from"]], [100 * each["coverage_to"] - at]]
        coverage.errorbar([i], [at], ends, fmt="o", capsize=2, color=style.SERIES[0].colour)
    coverage.axhline(95, color=style.MUTED, linestyle="--", linewidth=0.8)
    coverage.axhspan(90, 99, color="0.93", label="required")
    coverage.legend(loc="lower right")
    coverage.set_xticks(
        range(len(results["beads"])), [_motion(e).replace(", ", "\n") for e in results["beads"]],
        rotation=40, ha="right", rotation_mode="anchor",
    )  # fmt: skip
    coverage.set(xlim=(-0.5, len(results["beads"]) - 0.5))
    coverage.set(ylim=(60, 101), ylabel="coverage of the 95 % interval (%)")
    for rate, mark in zip(
        sorted({each["rate_Hz"] for each in results["cameras"]}),
        style.SERIES,
        strict=False,
    ):
        own = [each for each in results["cameras"] if each["rate_Hz"] == rate]
        intervals = [1e9 * each["median_interval_m"] for each in own]
        length.plot(
            [1e9 * each["noise_m"] for each in own], intervals, **mark.both,
            label=f"{rate:.0f} frames per second",
        )  # fmt: skip
    length.set(
        xscale="log", xlabel="noise of the camera (nm)", ylabel="median 95 % interval of z (nm)"
    )
    noises = sorted({1e9 * each["noise_m"] for each in results["cameras"]})
    length.set_xticks(noises, [f"{noise:g}" for noise in noises])
    length.minorticks_off()
    length.margins(y=0.2)
    length.set_ylim(bottom=0)
    length.set_title(results["cameras"][0]["scene"])
    length.legend()
    return drawn


def block(results: Results) -> str:
    """Return the block: coverage and intervals by bead, and intervals by camera."""
    return pages.block("depth", pages.tables(tables(results))[:-1], results["machine"])


if __name__ == "__main__":
    pages.renew("depth", block, figure)
