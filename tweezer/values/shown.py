"""Results as they are read: a few lines in a terminal, a small table in Jupyter.

A result says what it shows once, as a `Card`; its text, its HTML and the table of the command line
are made from that.
"""

from __future__ import annotations

import textwrap
from collections.abc import Iterator
from dataclasses import dataclass
from html import escape
from typing import NamedTuple

#: Width of a text, in characters
_WIDTH = 92
#: Longest line of what may be long, such as changes of a scene
_LONG = 240

#: Borders and colours are those of the page around, whether it is light or dark
_TABLE = "border-collapse: collapse; margin: 0.4em 0; color: inherit; background: transparent"
_CELL = (
    "text-align: left; vertical-align: top; padding: 0.15em 0.9em 0.15em 0; color: inherit; "
    "background: transparent; border: 0; border-top: 1px solid rgba(128, 128, 128, 0.4)"
)


class Row(NamedTuple):
    """A quantity of a result."""

    name: str
    value: str
    """with its uncertainty and unit"""
    caveat: str = ""
    """why it is not to be trusted; "" if nothing is known against it"""
    detail: bool = False
    """whether it is left out of the short text"""
    of: str = ""
    """name of the quantity that it tells; "" if it tells no quantity that the result lists"""

    @property
    def told(self) -> str:
        """The value, and what speaks against it."""
        return ", ".join(filter(None, (self.value, self.caveat)))


class Table(NamedTuple):
    """Cells under headings, the first of each row its name."""

    headings: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


@dataclass(frozen=True)
class Card:
    """What a result says of itself."""

    kind: str
    of: str
    """what it is of, such as a scene or a file"""
    rows: tuple[Row, ...]
    tables: tuple[Table, ...] = ()
    """left out of the short text"""
    notes: tuple[str, ...] = ()
    """sentences below"""

    @property
    def title(self) -> str:
        """What it is, and of what."""
        return f"{self.kind} of {self.of}" if self.of else self.kind


class Shown:
    """A result that is shown by its card."""

    def card(self) -> Card:
        """What it says of itself."""
        raise NotImplementedError

    def __repr__(self) -> str:
        """A few lines."""
        return as_text(self.card())

    def _repr_html_(self) -> str:
        """A table, for Jupyter."""
        return as_html(self.card())


def as_text(card: Card) -> str:
    """The title, a line for each row that is no detail, and the notes."""
    rows = [row for row in card.rows if not row.detail]
    width = max((len(row.name) for row in rows), default=0)
    lines = [clipped(card.title)]
    for row in rows:
        told = clipped(row.told)
        lines += _indented(told, f"  {row.name:{width}}  ", " " * (width + 4))
    for note in card.notes:
        lines += _indented(clipped(note), "  ", "  ")
    return "\n".join(lines)


def _indented(text: str, first: str, then: str) -> list[str]:
    return textwrap.wrap(
        text, _WIDTH, initial_indent=first, subsequent_indent=then, break_on_hyphens=False
    ) or [first.rstrip()]


def clipped(text: str) -> str:
    """A text that is not too long to show."""
    return text if len(text) <= _LONG else f"{text[: _LONG - 3]}..."


def as_html(card: Card) -> str:
    """A table with value and caveat of every row, the other tables, and the notes."""
    caveats = any(row.caveat for row in card.rows)
    cells = [
        (row.name, row.value, *([row.caveat] if caveats else [])) for row in card.rows
    ]  # fmt: skip
    parts = [*_table(card.title, (), cells)]
    for table in card.tables:
        parts += _table("", table.headings, table.rows)
    parts += [f"<p>{escape(note)}</p>" for note in card.notes]
    return f'<div class="tweezer">{"".join(parts)}</div>'


def _table(
    title: str, headings: tuple[str, ...], rows: list[tuple[str, ...]] | tuple[tuple[str, ...], ...]
) -> Iterator[str]:
    yield f'<table style="{_TABLE}">'
    if title:
        yield (
            '<caption style="text-align: left; font-weight: bold; caption-side: top; '
            f'color: inherit">{escape(title)}</caption>'
        )
    if headings:
        named = (f'<th scope="col" style="{_CELL}">{escape(each)}</th>' for each in headings)
        yield f"<thead><tr>{''.join(named)}</tr></thead>"
    yield "<tbody>"
    for name, *values in rows:
        told = "".join(f'<td style="{_CELL}">{escape(each)}</td>' for each in values)
        yield f'<tr><th scope="row" style="{_CELL}">{escape(name)}</th>{told}</tr>'
    yield "</tbody></table>"
