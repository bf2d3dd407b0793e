"""The results of the benchmark of sweeps as tables, as a figure, and on their page.

`python -m tests.benchmarks.sweep_report` writes block and figure from the committed results.
"""

from __future__ import annotations

import textwrap

from matplotlib.figure import Figure

from tests.benchmarks import pages
from tests.benchmarks.sweep import Results
from tweezer.plots import style

#: load average from which on times are not those of an idle machine
BUSY = 1.0


def tables(results: Results) -> list[list[list[str]]]:
    """What was measured; the first row is that of the headings."""
    whole, killed, dask = (results[name] for name in ("whole", "killed", "dask"))
    sizes, powers = results["grid"]
    return [
        [
            [f"traps with wave optics, {sizes} sizes x {powers} powers", ""],
            [f"time, {results['processes']} processes, s", f"{whole['wall_s']:.4g}"],
            ["processor time, s", f"{whole['cpu_s']:.4g}"],
            ["processor time per trap, ms", f"{1e3 * whole['cpu_s'] / whole['cases']:.3g}"],
            [f"killed {killed['kills']} times and resumed",
             "the same bytes" if killed["same_bytes"] else "other bytes"],
        ],
        [
            [f"Dask, {dask['cases']} traps: workers", "1", "2", "ratio"],
            ["time, s", *(f"{dask['wall_s'][n]:.4g}" for n in "12"), f"{dask['speed_up']:.3g}"],
            ["processor time of the busiest, s",
             *(f"{dask['busiest_cpu_s'][n]:.4g}" for n in "12"),
             f"{dask['speed_up_of_processor_time']:.3g}"],
        ],
    ]  # fmt: skip


@style.styled
def figure(results: Results) -> Figure:
    """Draw the cases that were done at each kill."""
    drawn = style.new(style.COLUMN, 2.3)
    axes = drawn.subplots()
    done = results["killed"]["cases_done_at_each"]
    axes.step(range(len(done)), done, where="mid", **style.SERIES[0].both)
    whole = results["whole"]["cases"]
    axes.axhline(whole, color=style.MUTED, lw=0.8, ls="--", label="all cases")
    axes.set(
        xlabel="number of kills", ylabel="cases completed", xlim=(-0.5, len(done) - 0.5),
        ylim=(-0.04 * whole, 1.2 * whole),
    )  # fmt: skip
    axes.legend(loc="upper left")
    return drawn


def block(results: Results) -> str:
    """Its part of the page, between its markers."""
    whole, killed, dask = (results[name] for name in ("whole", "killed", "dask"))
    sizes, powers = results["grid"]
    same = "the same bytes as" if killed["same_bytes"] else "other bytes than"
    explained = (
        f"The traps of a silica bead with wave optics, {sizes} sizes times {powers} powers, take "
        f"{whole['wall_s']:.0f} s with {results['processes']} processes, including their start, "
        f"and {whole['cpu_s']:.0f} s of processor time. After {killed['kills']} kills by SIGKILL "
        f"and resumptions, the store has {same} without them. Two Dask workers are "
        f"{dask['speed_up']:.2f} times as fast as one. The busier one needs "
        f"1/{dask['speed_up_of_processor_time']:.2f} of the processor time of a single worker."
    )
    if dask["load_before"] > BUSY:
        explained += (
            " Other programs used the machine at the time (load average "
            f"{dask['load_before']:.0f}), so the processor time is more reliable than the time."
        )
    lines = [
        *textwrap.wrap(explained, 110), "", *pages.tables(tables(results)),
        "![Completed cases after each kill](figures/bench-sweep.png)",
    ]  # fmt: skip
    return pages.block("sweep", lines, results["machine"])


if __name__ == "__main__":
    pages.renew("sweep", block, figure)
