"""Tables, and numbers in them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from rich.console import Console

from tweezer.cli.console import OUT

if TYPE_CHECKING:
    from rich.table import Table

    from tweezer.scene import Scene


def add_light(table: Table, scene: Scene) -> None:
    """Add the theory of the light, why it is that one, and what ray optics is worth."""
    from tweezer.optics import ray_optics_worth

    table.add_row("light", theory_of(scene))
    if worth := ray_optics_worth(scene):
        table.add_row("ray optics", worth.in_short)


def theory_of(scene: Scene) -> str:
    """Theory of the light of a scene, and why it is that one."""
    return f"{scene.theory} ({scene.theory_reason})" if scene.lit else "none"


def time_taken(seconds: float) -> str:
    """Seconds, or milliseconds if it is less than one."""
    return f"{seconds:.3g} s" if seconds >= 1 else f"{1e3 * seconds:.3g} ms"


def located(value: float, error: float | None, scale: float, unit: str) -> str:
    """A number of a run, rounded to its error if that is known."""
    text = f"{scale * value:.3g}"
    if error == 0:
        text = f"{scale * value:.4g}"
    elif error is not None:
        digits = math.floor(math.log10(max(abs(value), error))) - math.floor(math.log10(error)) + 1
        text = f"{scale * value:.{digits}g} +- {scale * error:.1g}"
    return f"{text} {unit}".rstrip()


def micrometres(metres: float) -> str:
    """Four digits, without -0 and without rounding errors of zero."""
    return f"{round(1e6 * metres, 9) + 0.0:.4g}"


def three(x: float, y: float, z: float) -> str:
    """Three numbers with four digits."""
    return f"{x:.4g}, {y:.4g}, {z:.4g}"


def table_of(*headings: str) -> Table:
    """An empty table with these headings."""
    from rich import box
    from rich.table import Table

    return Table(*headings, box=box.SIMPLE_HEAD)


def print_rows(rows: list[list[str]]) -> None:
    """Print a table without breaking words; its first row has the headings.

    Rows become lists if the terminal is too narrow; a pipe or a file has no width.
    """
    console = OUT if OUT.is_terminal else Console(width=10_000)
    columns = list(zip(*rows, strict=True))
    by_cells = [max(map(len, cells)) for cells in columns]
    by_words = [
        max(len(word) for cell in cells for word in [*cell.split(), ""]) for cells in columns
    ]
    by_words[0] = max(by_words[0], min(by_cells[0], 30))  # names of rows preferably in one line
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
