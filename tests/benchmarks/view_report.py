"""The results of the benchmark of pages as a table, as a figure, and on their page.

`python -m tests.benchmarks.view_report` writes block and figure from the committed results.
"""

from __future__ import annotations

import textwrap

from matplotlib.figure import Figure

from tests.benchmarks import pages
from tests.benchmarks.view import Results
from tweezer.plots import style

#: Load average above which the times do not represent an idle machine
BUSY = 1.0
#: Frames per second that look smooth
SMOOTH = 30


def tables(results: Results) -> list[list[list[str]]]:
    """Return the table of pages."""
    rows = [
        [each["page"], f"{each['megabytes']:.3g}", f"{each['written_s']:.2g}",
         f"{each['frames_per_s']:.3g}", f"{each['frame_cpu_ms']:.3g}",
         f"{each['console_messages']}"]
        for each in results["pages"]
    ]  # fmt: skip
    return [
        [["page", "size, MB", "time to write, s", "frames per second",
          "processor time per frame, ms", "console messages"], *rows],
    ]  # fmt: skip


@style.styled
def figure(results: Results) -> Figure:
    """Draw the frames per second of each page."""
    drawn = style.new(style.PAGE, 1.5)
    axes = drawn.subplots()
    shown = results["pages"][::-1]
    rows = range(len(shown))
    axes.barh(
        rows, [each["frames_per_s"] for each in shown], height=0.5, color=style.SERIES[4].colour
    )
    axes.axvline(SMOOTH, color=style.MUTED, lw=0.8, ls="--", label="smooth")
    axes.set_yticks(rows, [each["page"] for each in shown])
    axes.set(xlabel="frames per second without a graphics card")
    style.legend_above(axes, 1)
    return drawn


def block(results: Results) -> str:
    """Return the block: the window, the load of the machine, and the table of pages."""
    width, height = results["window"]
    shown = f"The scene is {results['scene']}, and the window has {width} by {height} pixels."
    if results["load_before"] > BUSY:
        shown += (
            " Other programs used the machine at the time (load average "
            f"{results['load_before']:.0f}), so the processor time is more reliable than the frame "
            "rate."
        )
    lines = [*textwrap.wrap(shown, 110), "", *pages.tables(tables(results))[:-1]]
    return pages.block("view", lines, results["machine"])


if __name__ == "__main__":
    pages.renew("view", block, figure)
