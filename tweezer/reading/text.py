"""Tables in text files: CSV and similar formats."""

from __future__ import annotations

import codecs
import csv
import re
import warnings
from collections.abc import Callable, Sequence
from functools import partial
from io import BytesIO
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from tweezer.reading.columns import short
from tweezer.reading.headings import AROUND, is_unit, understood
from tweezer.reading.table import MOST_SAMPLES, Array, Column, Table
from tweezer.values.errors import ResultError

if TYPE_CHECKING:
    import pandas as pd

#: Number of lines in which headings and the first numbers are sought
_HEAD = 200
#: Largest number of lines between the headings and the numbers
_BETWEEN = 4
#: Cells without a number
_MISSING = ("", "-", "--", "nan", "NaN", "NAN", "NA", "N/A", "n/a", "null", "NULL", "None", "none")
_NUMBER = re.compile(
    r"[+-]?(?:[0-9]++\.?[0-9]*+|\.[0-9]++)(?:[eE][+-]?[0-9]++)?|[+-]?inf(?:inity)?", re.I
)
_WITH_COMMA = re.compile(r"[+-]?[0-9]*,[0-9]+(?:[eE][+-]?[0-9]+)?")
#: Pattern of a part of a date or a time of day
_CLOCK = re.compile(r"[0-9]{1,4}([:/-])[0-9]{1,2}\1[0-9]")
#: Pattern of a character that is not white space
_ANY = re.compile(rb"\S")
#: Characters that begin a comment
_COMMENTS = ("#", "%", "//")
_DELIMITERS = (";", "\t", ",", " ")


class _Layout(NamedTuple):
    """Layout of a text with a table: headings, units, delimiter and first row of numbers."""

    headings: list[str]
    """headings of the columns; empty without a line of headings"""
    units: list[str]
    """cells of the line of units below the headings; empty without one"""
    delimiter: str
    first: int
    """number of the line with the first numbers, from 0"""
    columns: int
    """number of columns"""


class _Text(NamedTuple):
    """A text file with a table, before its numbers are read."""

    name: str
    """of the file"""
    content: bytes
    """whole text in `encoding`, with uniform line ends"""
    encoding: str
    head: list[str]
    """first lines of the text"""
    layout: _Layout


def open_text(path: Path, names: Callable[[list[str]], bool]) -> Table:
    """Return the table in a text file, without the lines before its headings.

    `names` is a function that returns whether the cells of a line are the expected headings.
    Without such a line, the headings are in the line above the first numbers.
    """
    try:
        content = path.read_bytes()
    except OSError as error:
        raise ResultError(f"{path}: cannot be read: {error.strerror}") from None
    if content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        content = content.decode("utf-16", errors="replace").encode()
    content = content.removeprefix(codecs.BOM_UTF8)
    if b"\r" in content:  # line ends of Windows and of classic Mac OS
        content = content.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    lines = list(islice(BytesIO(content), _HEAD))
    try:
        codecs.getincrementaldecoder("utf-8")().decode(b"".join(lines))
        encoding = "utf-8"
    except UnicodeDecodeError:
        encoding = "cp1252"  # default of Windows in western Europe
    head = [line.decode(encoding, errors="replace").rstrip("\n") for line in lines]
    layout = _layout(head, names)
    headings = layout.headings or [""] * layout.columns
    units = layout.units or [""] * layout.columns
    columns = [
        Column(heading.strip(AROUND), heading.strip(AROUND), unit.strip(AROUND + "()[]") or None)
        for heading, unit in zip(headings, units, strict=True)
    ]
    text = _Text(str(path), content, encoding, head, layout)
    numbers, labels = partial(_numbers, text), partial(_labels, text)
    return Table(text.name, columns, numbers, headed=bool(layout.headings), labels=labels)


def _cells(line: str, delimiter: str) -> list[str]:
    """Return the cells of a line; between spaces, a unit in brackets stays with its name."""
    line = line.rstrip("\r\n")
    if delimiter == " ":
        return re.split(r"\s+(?![\[(])", line.strip())
    if '"' in line:
        try:
            return next(csv.reader([line], delimiter=delimiter))
        except (csv.Error, StopIteration):
            pass
    return line.split(delimiter)


def _bare(line: str) -> str:
    """Return a line without a comment character at its beginning."""
    return re.sub(r"^\s*(?:#+|%+|//)\s*", "", line)


def _layout(head: list[str], names: Callable[[list[str]], bool]) -> _Layout:
    """Return the layout of a text from its first lines, `head`.

    `names` is a function that returns whether the cells of a line are the expected headings.
    """
    for number, line in enumerate(head):
        delimiter = next((each for each in ";\t," if each in line), " ")
        cells = _cells(_bare(line), delimiter)
        if names(cells):
            return _below(head, number, cells, delimiter)
        if (found := _of_numbers(line)) is not None:
            above = _cells(_bare(head[number - 1]), found[0]) if number else []
            alike = len(above) >= found[1] > 1 or len(above) == found[1]
            alike &= any(cell.strip(AROUND) for cell in above)
            if alike or any(understood(cell).quantity for cell in above):
                return _Layout(above, [], found[0], number, len(above))
            return _Layout([], [], found[0], number, found[1])
    first = next((number for number, line in enumerate(head) if line.strip()), 0)
    text = _bare(head[first]) if head else ""
    delimiter = next((each for each in ";\t," if each in text), " ")
    cells = _cells(text, delimiter)
    return _Layout(cells, [], delimiter, first + 1, len(cells))


def _below(head: list[str], number: int, headings: list[str], delimiter: str) -> _Layout:
    """Return the layout of a text with a known line of headings.

    A line of units and other lines without numbers may follow it. `head` contains the first lines
    of the text, and `number` is the number of the line of headings, from 0.
    """
    units: list[str] = []
    first = number + 1
    for line in head[first : first + _BETWEEN]:
        if line.lstrip().startswith(_COMMENTS):
            first += 1
            continue
        cells = _cells(_bare(line), delimiter)
        filled = [cell.strip(AROUND) for cell in cells if cell.strip(AROUND) not in _MISSING]
        if len(cells) != len(headings) or any(map(_is_number, filled)):
            break
        if filled and _are_units(headings, cells):
            units = cells
        elif filled and not any(understood(cell).quantity for cell in filled):
            break
        first += 1
    if delimiter == " " and first < len(head):  # headings may contain spaces
        count = len(_cells(head[first], delimiter))
        headings = headings if count == len(headings) else []
        return _Layout(headings, units if headings else [], delimiter, first, count)
    return _Layout(headings, units, delimiter, first, len(headings))


def _are_units(headings: list[str], cells: list[str]) -> bool:
    """Return whether each cell below the heading of a quantity is a unit of it, or empty."""
    told = False
    for heading, cell in zip(headings, cells, strict=True):
        quantity, unit = understood(heading).quantity, cell.strip(AROUND + "()[]")
        if quantity in (None, "frame", "bead") or not unit:
            continue
        if not is_unit(unit, str(quantity)):
            return False
        told = True
    return told


def _is_number(cell: str) -> bool:
    """Return whether a cell is a number, with a decimal point or comma."""
    return bool(_NUMBER.fullmatch(cell) or _WITH_COMMA.fullmatch(cell))


def _of_numbers(line: str) -> tuple[str, int] | None:
    """Return delimiter and number of cells for a line that contains only numbers or missing cells.

    Returns None for another line.
    """
    if len(line) > 10_000:
        return None
    for delimiter in _DELIMITERS:
        if delimiter not in line.strip() and delimiter != " ":
            continue
        cells = [cell.strip(AROUND) for cell in _cells(line, delimiter)]
        numbers = [cell for cell in cells if cell not in _MISSING]
        wanted = _NUMBER.fullmatch if delimiter == "," and '"' not in line else _is_number
        if numbers and all(map(wanted, numbers)):
            return delimiter, len(cells)
    return None


def _numbers(text: _Text, places: Sequence[int]) -> list[Array]:
    """Return the numbers in these columns, as arrays (n,).

    Decimal commas are recognised from the first lines. Raises `ResultError` with the number of the
    first line that cannot be read.
    """
    content, layout = text.content, text.layout
    first = [_cells(line, layout.delimiter) for line in text.head[layout.first :]]
    commas = any(
        _WITH_COMMA.fullmatch(cells[i].strip(AROUND))
        for cells in first for i in places if i < len(cells)
    )  # fmt: skip
    lines = content.count(b"\n") + (not content.endswith(b"\n"))
    if lines - layout.first > MOST_SAMPLES:
        raise ResultError(
            f"{text.name}: has {lines - layout.first:,} rows; must have at most {MOST_SAMPLES:,}"
        )
    if layout.first >= lines or not _ANY.search(content, _start(content, layout.first)):
        return [np.empty(0)] * len(places)
    _refuse_surplus(text)
    try:
        with warnings.catch_warnings(action="ignore"):  # about cells beyond the last heading
            table = _columns(
                text,
                places,
                dtype=np.float64,
                decimal="," if commas else ".",
                na_values=[*_MISSING, *(f"{each} " for each in _MISSING)],
            )
    except (ValueError, OverflowError) as error:
        why = _complaint(text, places, commas=commas)
        raise ResultError(f"{text.name}: {why or str(error).splitlines()[0]}") from None
    return [table[place].to_numpy(np.float64) for place in places]


def _labels(text: _Text, place: int) -> list[str]:
    """Return the cells of a column as text, with "" for empty cells."""
    table = _columns(text, [place], dtype=str, na_values=_MISSING)
    return [label.strip() for label in table[place].fillna("")]


def _columns(text: _Text, places: Sequence[int], **cells: Any) -> pd.DataFrame:
    """Return columns of a text as a table of pandas.

    `places` are the numbers of the columns, and `cells` are arguments of `read_csv` on reading
    cells.
    """
    import pandas as pd

    return pd.read_csv(
        BytesIO(text.content),
        sep=r"\s+" if text.layout.delimiter == " " else text.layout.delimiter,
        header=None,
        names=range(max(places) + 1),
        index_col=False,
        usecols=sorted(set(places)),
        skiprows=text.layout.first,
        skipinitialspace=True,
        encoding=text.encoding,
        encoding_errors="replace",
        **cells,
    )


def _start(content: bytes, line: int) -> int:
    """Return the offset in bytes of the beginning of a line, counted from 0."""
    at = 0
    for _ in range(line):
        at = content.index(b"\n", at) + 1
    return at


def _refuse_surplus(text: _Text) -> None:
    """Raise `ResultError` for a row with more cells than columns, unless these are empty."""
    layout = text.layout
    if layout.delimiter == " " or b'"' in text.content:
        return
    signs = np.frombuffer(text.content, np.uint8)[_start(text.content, layout.first) :]
    ends = np.flatnonzero(signs == ord("\n"))
    marks = np.flatnonzero(signs == ord(layout.delimiter))
    counts = np.diff(np.searchsorted(marks, ends), prepend=0)
    if len(marks) and (not len(ends) or marks[-1] > ends[-1]):
        ends = np.append(ends, len(signs))
        counts = np.append(counts, len(marks) - counts.sum())
    for row in np.flatnonzero(counts >= layout.columns):
        begin = ends[row - 1] + 1 if row else 0
        cells = bytes(signs[begin : ends[row]]).decode("latin-1").split(layout.delimiter)
        if any(cell.strip() for cell in cells[layout.columns :]):
            commas = ""
            if layout.delimiter == ",":
                commas = "; decimals need a point, or ; between the cells"
            raise ResultError(
                f"{text.name}: line {layout.first + row + 1}: has {len(cells)} cells for "
                f"{layout.columns} {'headings' if layout.headings else 'columns'}{commas}"
            )


def _complaint(text: _Text, places: Sequence[int], *, commas: bool) -> str | None:
    """Return the first line that cannot be read, with the reason; None if all can be read.

    `commas` is whether decimals are written with commas.
    """
    first = text.layout.first
    for number, read in enumerate(islice(BytesIO(text.content), first, None), start=first + 1):
        line = read.decode(text.encoding, errors="replace")
        if line.count('"') % 2:
            return f"line {number}: a quote is not closed"
        cells = _cells(line, text.layout.delimiter)
        for place in places:
            cell = cells[place].strip(AROUND) if place < len(cells) else ""
            if cell in _MISSING or (_WITH_COMMA if commas else _NUMBER).fullmatch(cell):
                continue
            if commas and re.fullmatch(r"[+-]?[0-9]+(?:[eE][+-]?[0-9]+)?", cell):
                continue
            way = "; decimals need a point" if _WITH_COMMA.fullmatch(cell) else ""
            if _CLOCK.search(cell):
                way = '; rows at even times are read without it: --columns "x=..." --rate "... Hz"'
            return f"line {number}: {short(cell)!r} is not a number{way}"
    return None
