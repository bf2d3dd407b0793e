"""Blocks of measured figures in the documentation, between markers with the name of the block."""

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

FIGURES = ROOT / "docs/figures"
Results = dict[str, Any]


def committed(name: str) -> Results:
    """Return the committed results of a benchmark."""
    path = ROOT / "tests/benchmarks/results" / f"{name}.json"
    results: Results = json.loads(path.read_text(encoding="utf-8"))
    return results


def markdown(headings: Sequence[str], rows: Iterable[Sequence[str]]) -> list[str]:
    """Return the lines of a table with its numbers aligned to the right, and with µm and ±.

    Raise `ValueError` if a row and the headings differ in length.
    """
    rule = ["---", *["---:"] * (len(headings) - 1)]
    whole = [headings, rule, *rows]
    for cells in whole:
        if len(cells) != len(headings):
            raise ValueError(f"{len(headings)} headings, {len(cells)} cells: {cells}")
    lines = ["| " + " | ".join(cells) + " |" for cells in whole]
    return [re.sub(r"\bum\b", "µm", line).replace("+-", "±") for line in lines]


def tables(each: Iterable[Sequence[Sequence[str]]]) -> list[str]:
    """Return the lines of tables that have their headings in the first row."""
    return [line for headings, *rows in each for line in (*markdown(headings, rows), "")]


def left_out(what: Mapping[str, Mapping[str, Iterable[str]]], note: str = "") -> list[str]:
    """Return what a benchmark omits: a list for each reason, an item for each motion or well."""
    lines = [] if what else ["", "Nothing was omitted."]
    for why, of in what.items():
        lines += ["", f"Omitted ({why}{note}):", ""]
        for where, each in of.items():
            item = f"- {f'{where}: ' if where else ''}{'; '.join(each)}"
            lines += textwrap.wrap(item, 110, subsequent_indent="  ", break_on_hyphens=False)
    return lines


def as_table(lines: Iterable[str]) -> list[list[str]]:
    """Return the lines of a list as a table with one column; the first line is its heading."""
    return [[line] for line in lines if line]


def block(name: str, lines: Iterable[str], machine: Results) -> str:
    """Return the block of a benchmark: its lines, its commit and its machine."""
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


def page(name: str) -> Path:
    """Return the page that quotes a block: the README or a page of docs/."""
    (found,) = (
        path
        for path in (ROOT / "README.md", *(ROOT / "docs").glob("*.md"))
        if f"<!-- bench-{name} -->" in path.read_text(encoding="utf-8")
    )
    return found


def quoted(name: str) -> str:
    """Return a block as its page quotes it, including its markers."""
    (text,) = _between(name).findall(page(name).read_text(encoding="utf-8"))
    return str(text)


def quote(name: str, text: str) -> None:
    """Replace the block of this name on its page."""
    path = page(name)
    whole = path.read_text(encoding="utf-8")
    path.write_text(_between(name).sub(lambda _: text, whole), encoding="utf-8")


def renew(name: str, written: Callable[[Results], str], drawn: Callable[[Results], Figure]) -> None:
    """Write a benchmark's block and draw its figure again, from the committed results."""
    results = committed(name)
    quote(name, written(results))
    save(drawn(results), f"bench-{name}")


def save(figure: Figure, name: str) -> None:
    """Write a figure of the documentation as NAME.png, with a letter for each of several panels."""
    style.add_letters(figure)
    with (FIGURES / f"{name}.png").open("wb") as file:
        style.save(figure, file, "png")


def _between(name: str) -> re.Pattern[str]:
    return re.compile(rf"<!-- bench-{name} -->\n.*?<!-- end -->", re.DOTALL)
