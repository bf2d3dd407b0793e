"""Tables of results at a terminal."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from rich.console import Console

from tweezer.cli.console import OUT, detailed, say
from tweezer.values.signs import for_stream

if TYPE_CHECKING:
    from rich.table import Table as RichTable

    from tweezer.values.shown import Card, Row, Table


def print_card(card: Card) -> None:
    """Print a result: its rows, tables and notes."""
    print_shown(card.of, card.rows)
    for each in card.tables:
        print_table(each)
    for note in card.notes:
        say(note)


def print_shown(heading: str, rows: Iterable[Row], width: int = 0) -> None:
    """Print the rows of a result with their caveats, and the details with --details.

    `width` is the smallest width of the column of names.
    """
    table = table_of(heading, "")
    table.columns[0].min_width = width
    for row in rows:
        if detailed() or not row.detail:
            table.add_row(row.name, _with_signs(row.told))
    OUT.print(table)


def print_table(cells: Table) -> None:
    """Print one table of a result."""
    table = table_of(*map(_with_signs, cells.headings))
    for row in cells.rows:
        table.add_row(*map(_with_signs, row))
    OUT.print(table)


def _with_signs(text: str) -> str:
    """Return `text` with typographic characters such as "µm", if the terminal can display them."""
    return for_stream(text, OUT.file)


def print_parts(parts: Iterable[Table | str]) -> None:
    """Print the tables and lines of a result in order."""
    for each in parts:
        if isinstance(each, str):
            say(each)
        else:
            print_table(each)


def table_of(*headings: str) -> RichTable:
    """Return an empty table with these headings."""
    from rich import box
    from rich.table import Table as RichTable

    return RichTable(*headings, box=box.SIMPLE_HEAD)


def print_rows(rows: list[list[str]]) -> None:
    """Print a table without breaking words; its first row contains the headings.

    If the terminal is too narrow, each row is printed as a list. Pipes and files have no width.
    """
    console = OUT if OUT.is_terminal else Console(width=10_000, quiet=OUT.quiet)
    rows = [[_with_signs(cell) for cell in row] for row in rows]
    columns = list(zip(*rows, strict=True))
    by_cells = [max(map(len, cells)) for cells in columns]
    by_words = [
        max(len(word) for cell in cells for word in [*cell.split(), ""]) for cells in columns
    ]
    by_words[0] = max(by_words[0], min(by_cells[0], 30))  # prefer names of rows on one line
    headings, *rest = rows
    for widths in (by_cells, by_words):
        if sum(widths) + 3 * len(widths) + 1 <= console.width:
            table = table_of(*headings)
            for column, width in zip(table.columns, widths, strict=True):
                column.width = width
            for row in rest:
                table.add_row(*row)
            console.print(table)
            return
    for name, *values in rest:
        console.print(f"\n{headings[0]}: {name}", highlight=False)
        for heading, value in zip(headings[1:], values, strict=True):
            console.print(f"  {heading}: {value}", highlight=False)
