"""The README's blocks of measured figures, each between markers of its benchmark's name."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Sequence
from typing import Any

from tests.benchmarks.timing import ROOT

README = ROOT / "README.md"
Results = dict[str, Any]


def committed(name: str) -> Results:
    """Results of a benchmark as they were committed."""
    path = ROOT / "tests/benchmarks/results" / f"{name}.json"
    results: Results = json.loads(path.read_text(encoding="utf-8"))
    return results


def markdown(headings: Sequence[str], rows: Iterable[Sequence[str]]) -> list[str]:
    """The lines of a table, numbers to the right."""
    rule = ["---", *["---:"] * (len(headings) - 1)]
    return ["| " + " | ".join(cells) + " |" for cells in (headings, rule, *rows)]


def block(name: str, lines: Iterable[str], machine: Results) -> str:
    """A benchmark's part of the README: its lines, and where they are from."""
    return "\n".join(
        [
            f"<!-- bench-{name} -->",
            *lines,
            "",
            f"`make bench` measures this anew. These are from {machine['processor']}, "
            f"{machine['cores']} cores, Python {machine['python']}, Numba {machine['numba']}.",
            "<!-- end -->",
        ]
    )


def quoted(name: str) -> str:
    """What stands in the README of a benchmark, markers and all."""
    (text,) = _between(name).findall(README.read_text(encoding="utf-8"))
    return str(text)


def quote(name: str, text: str) -> None:
    """Put a block in the place of the one that stands there."""
    whole = README.read_text(encoding="utf-8")
    README.write_text(_between(name).sub(lambda _: text, whole), encoding="utf-8")


def _between(name: str) -> re.Pattern[str]:
    return re.compile(rf"<!-- bench-{name} -->\n.*?<!-- end -->", re.DOTALL)
