"""The costs of commands as tables, as a figure, and on their page.

`python -m tests.benchmarks.commands_report` writes block and figure from the committed results.
"""

from __future__ import annotations

import textwrap

from matplotlib.figure import Figure

from tests.benchmarks import pages
from tests.benchmarks.commands import FIRST_PAGE, FIRST_RUN, Results
from tweezer.plots import style


def tables(results: Results) -> list[list[list[str]]]:
    """Return the tables of commands alone and of commands in order."""
    alone = [
        [
            each["command"], *(f"{each[key]:.2g}" for key in _TIMES),
            f"{each['functions_kept']}",
        ]
        for each in results["commands"]
    ]  # fmt: skip
    order = [
        [each["command"], f"{each['cpu_s']:.2g}", f"{each['wall_s']:.2g}",
         f"{each['functions_added']}"]
        for each in results["in_order"]
    ]  # fmt: skip
    return [
        [["command, alone", "cold, CPU s", "cold, s", "warm, CPU s", "warm, s",
          "functions cached"], *alone],
        [["commands in this order, one empty cache", "CPU s", "s", "functions added"], *order],
    ]  # fmt: skip


_TIMES = ("cold_cpu_s", "cold_wall_s", "warm_cpu_s", "warm_wall_s")


@style.styled
def figure(results: Results) -> Figure:
    """Draw the processor time of each command, cold and warm."""
    commands = results["commands"][::-1]
    drawn = style.new(style.PAGE, 0.6 + 0.2 * len(commands))
    axes = drawn.subplots()
    rows = range(len(commands))
    for (key, label), mark in zip(
        (("cold_cpu_s", "empty cache"), ("warm_cpu_s", "filled cache")), style.SERIES, strict=False
    ):
        axes.plot([each[key] for each in commands], rows, label=label, **mark.points)
    axes.set_yticks(rows, [textwrap.shorten(each["command"], 48) for each in commands])
    axes.set(xscale="log", xlabel="processor time (s)")
    axes.grid(axis="x", visible=True)
    style.legend_above(axes, 2)
    return drawn


def block(results: Results) -> str:
    """Return the block: the way from nothing to the first results, and the tables."""
    by_command = {each["command"]: each for each in results["commands"]}
    page, run = by_command[FIRST_PAGE.told], by_command[FIRST_RUN.told]
    first = (
        "From nothing, the environment and `pip install` took "
        f"{results['install']['wall_s']:.0f} s, which depends on the network. After that, "
        f"`{page['command']}` writes the first page after {page['cold_wall_s']:.0f} s "
        f"({page['cold_cpu_s']:.0f} s of processor time), and `{run['command']}` prints its "
        f"results after {run['cold_wall_s']:.0f} s ({run['cold_cpu_s']:.0f} s)."
    )
    lines = [
        *textwrap.wrap(first, 110, break_long_words=False, break_on_hyphens=False), "",
        *pages.tables(tables(results))[:-1],
    ]  # fmt: skip
    return pages.block("commands", lines, results["machine"])


if __name__ == "__main__":
    pages.renew("commands", block, figure)
