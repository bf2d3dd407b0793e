"""Measured figures in the documentation: each block stands between markers of its own name."""

from __future__ import annotations

import json
import re
import textwrap
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from tests.benchmarks.timing import ROOT
from tweezer.plots import style

BENCHMARKS = ROOT / "docs/benchmarks.md"
FIGURES = ROOT / "docs/figures"
Results = dict[str, Any]


def committed(name: str) -> Results:
    """Results of a benchmark as they were committed."""
    path = ROOT / "tests/benchmarks/results" / f"{name}.json"
    results: Results = json.loads(path.read_text(encoding="utf-8"))
    return results


def markdown(headings: Sequence[str], rows: Iterable[Sequence[str]]) -> list[str]:
    """The lines of a table, numbers to the right; `ValueError` if a row is not as long as the
    headings.
    """
    rule = ["---", *["---:"] * (len(headings) - 1)]
    whole = [headings, rule, *rows]
    for cells in whole:
        if len(cells) != len(headings):
            raise ValueError(f"{len(headings)} headings, {len(cells)} cells: {cells}")
    return ["| " + " | ".join(cells) + " |" for cells in whole]


def tables(each: Iterable[Sequence[Sequence[str]]]) -> list[str]:
    """The lines of tables whose first rows are their headings, an empty line after each."""
    return [line for headings, *rows in each for line in (*markdown(headings, rows), "")]


def left_out(what: Mapping[str, Mapping[str, Iterable[str]]], note: str = "") -> list[str]:
    """What a benchmark does not tell: a list for each reason, an item for each motion or well."""
    lines = [] if what else ["", "Left out: nothing."]
    for why, of in what.items():
        lines += ["", f"Left out ({why}{note}):", ""]
        for where, each in of.items():
            item = f"- {f'{where}: ' if where else ''}{'; '.join(each)}"
            lines += textwrap.wrap(item, 110, subsequent_indent="  ", break_on_hyphens=False)
    return lines


def as_table(lines: Iterable[str]) -> list[list[str]]:
    """The lines of a list as a table of one column, of which the first is the heading."""
    return [[line] for line in lines if line]


def block(name: str, lines: Iterable[str], machine: Results) -> str:
    """A benchmark's part of its page: its lines, and where they are from."""
    return "\n".join(
        [
            f"<!-- bench-{name} -->",
            *lines,
            "",
            f"`make bench` measured these figures at commit {machine['commit']} with "
            f"{machine['processor']}, {machine['cores']} cores, Python {machine['python']}, "
            f"Numba {machine['numba']}.",
            "<!-- end -->",
        ]
    )


def quoted(name: str, page: Path = BENCHMARKS) -> str:
    """What stands on a page of a benchmark, markers and all."""
    (text,) = _between(name).findall(page.read_text(encoding="utf-8"))
    return str(text)


def quote(name: str, text: str, page: Path = BENCHMARKS) -> None:
    """Put a block in the place of the one that stands there."""
    whole = page.read_text(encoding="utf-8")
    page.write_text(_between(name).sub(lambda _: text, whole), encoding="utf-8")


def renew(
    name: str,
    written: Callable[[Results], str],
    drawn: Callable[[Results], Figure],
    page: Path = BENCHMARKS,
) -> None:
    """Write a benchmark's block and draw its figure again, from the committed results."""
    results = committed(name)
    quote(name, written(results), page)
    with (FIGURES / f"bench-{name}.png").open("wb") as file:
        style.save(drawn(results), file, "png")


def _between(name: str) -> re.Pattern[str]:
    return re.compile(rf"<!-- bench-{name} -->\n.*?<!-- end -->", re.DOTALL)
