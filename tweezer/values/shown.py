"""Results as text in a terminal and as a table in Jupyter.

A result lists its content once, as a `Card`, from which its text, its HTML and its table on the
command line are made.
"""

from __future__ import annotations

import sys
import textwrap
from collections.abc import Iterator
from dataclasses import dataclass
from html import escape
from typing import NamedTuple

from tweezer.values.signs import for_stream, typeset

#: Width of a text, characters
_WIDTH = 92
#: Length at which long lines, such as changes of a scene, are cut
_LONG = 240

#: Styles that inherit borders and colours from the page, whether it is light or dark
_TABLE = "border-collapse: collapse; margin: 0.4em 0; color: inherit; background: transparent"
_CELL = (
    "text-align: left; vertical-align: top; padding: 0.15em 0.9em 0.15em 0; color: inherit; "
    "background: transparent; border: 0; border-top: 1px solid rgba(128, 128, 128, 0.4)"
)


class Row(NamedTuple):
    """A line of a card: a quantity of a result with its value."""

    name: str
    value: str
    """text of the value with its uncertainty and unit"""
    caveat: str = ""
    """reason why the value is invalid or less certain; "" for none"""
    detail: bool = False
    """whether the short text omits the row"""
    of: str = ""
    """name of the quantity that the row shows; "" for other rows"""

    @property
    def told(self) -> str:
        """The value followed by its caveat, if any."""
        return ", ".join(filter(None, (self.value, self.caveat)))


class Table(NamedTuple):
    """A table of a card: rows of cells under headings; the first cell names its row."""

    headings: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


@dataclass(frozen=True)
class Card:
    """Content with which a result is shown: rows, tables and notes."""

    kind: str
    """kind of the result, such as "Trap" or "Calibration", in its title"""
    of: str
    """scene or file from which the result was computed"""
    rows: tuple[Row, ...]
    tables: tuple[Table, ...] = ()
    """tables, which the short text omits"""
    notes: tuple[str, ...] = ()
    """sentences below the rows"""

    @property
    def title(self) -> str:
        """Title of the card: the kind of result, and its scene or file."""
        return f"{self.kind} of {self.of}" if self.of else self.kind


class Shown:
    """Base of results that are shown by a card."""

    def card(self) -> Card:
        """Return the card of the result."""
        raise NotImplementedError

    def __repr__(self) -> str:
        """Return the card as a few lines of text."""
        return as_text(self.card())

    def _repr_html_(self) -> str:
        """Return the card as HTML, for Jupyter."""
        return as_html(self.card())


def as_text(card: Card) -> str:
    """Return a card as text: the title, a line for each row except details, and the notes.

    It contains the characters µ, ± and · if the encoding of the standard output contains them.
    """
    rows = [row for row in card.rows if not row.detail]
    width = max((len(row.name) for row in rows), default=0)
    lines = [clipped(card.title)]
    for row in rows:
        told = clipped(for_stream(row.told, sys.stdout))
        lines += _indented(told, f"  {row.name:{width}}  ", " " * (width + 4))
    for note in card.notes:
        lines += _indented(clipped(for_stream(note, sys.stdout)), "  ", "  ")
    return "\n".join(lines)


def _indented(text: str, first: str, then: str) -> list[str]:
    """Return a text wrapped to lines of 92 characters.

    The first line begins with `first`, all others with `then`.
    """
    return textwrap.wrap(
        text, _WIDTH, initial_indent=first, subsequent_indent=then, break_on_hyphens=False
    ) or [first.rstrip()]


def clipped(text: str) -> str:
    """Return a text, cut at 240 characters."""
    return text if len(text) <= _LONG else f"{text[: _LONG - 3]}..."


def as_html(card: Card) -> str:
    """Return a card as HTML: a table of all rows with their caveats, the other tables, and the
    notes.
    """
    caveats = any(row.caveat for row in card.rows)
    cells = [
        (row.name, row.value, *([row.caveat] if caveats else [])) for row in card.rows
    ]  # fmt: skip
    parts = [*_table(card.title, (), cells)]
    for table in card.tables:
        parts += _table("", table.headings, table.rows)
    parts += [f"<p>{escape(typeset(note))}</p>" for note in card.notes]
    return f'<div class="tweezer">{"".join(parts)}</div>'


def _table(
    title: str, headings: tuple[str, ...], rows: list[tuple[str, ...]] | tuple[tuple[str, ...], ...]
) -> Iterator[str]:
    """Yield the parts of an HTML table; `headings` may be empty, first cells name their rows."""
    yield f'<table style="{_TABLE}">'
    if title:
        yield (
            '<caption style="text-align: left; font-weight: bold; caption-side: top; '
            f'color: inherit">{escape(title)}</caption>'
        )
    if headings:
        named = (
            f'<th scope="col" style="{_CELL}">{escape(typeset(each))}</th>' for each in headings
        )
        yield f"<thead><tr>{''.join(named)}</tr></thead>"
    yield "<tbody>"
    for name, *values in rows:
        told = "".join(f'<td style="{_CELL}">{escape(typeset(each))}</td>' for each in values)
        yield f'<tr><th scope="row" style="{_CELL}">{escape(name)}</th>{told}</tr>'
    yield "</tbody></table>"
