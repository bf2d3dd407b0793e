"""Tables of cases: a column for each key, from a CSV file, pandas, xarray or a mapping."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterable, Mapping
from io import StringIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from tweezer.values.errors import ResultError, SceneError
from tweezer.values.files import read_text

if TYPE_CHECKING:
    import xarray as xr

_HEADING = re.compile(r"\s*(?P<key>\S+?)(?:\s+[\[(](?P<unit>[^\])]+)[\])])?\s*")


def columns_of(table: Any) -> list[tuple[str, list[Any]]]:
    """Return the keys of a table of cases, each with its values.

    A unit in a heading, such as "beam.power [mW]", or in the attribute `units` of xarray, applies
    to all values. Raises `SceneError` for a heading that is not a key, and `ResultError` for a file
    that is not a CSV table.
    """
    if isinstance(table, str | Path):
        return _of_file(Path(table))
    if hasattr(table, "data_vars"):
        return _of_xarray(table)
    if isinstance(table, Mapping) or hasattr(table, "columns"):
        headings = table if isinstance(table, Mapping) else table.columns
        return [_column(f"{each}", table[each]) for each in headings]
    raise SceneError("cases: must be the name of a CSV file, or a table with a column for each key")


def _column(heading: str, values: Any, unit: str = "") -> tuple[str, list[Any]]:
    """Return the key of a heading such as "beam.power [mW]", and the values with their unit.

    `unit` applies if the heading has none. Raises `SceneError` for an invalid column.
    """
    match = _HEADING.fullmatch(heading)
    if not match:
        raise SceneError(f"{heading!r}: must be a key, such as beam.power [mW]")
    if isinstance(values, str) or not isinstance(values, Iterable):
        raise SceneError(f"cases: {heading}: must be a list of values")
    plain = [each.item() if isinstance(each, np.generic) else each for each in values]
    unit = match["unit"] or unit
    return match["key"], [f"{each} {unit}" for each in plain] if unit else plain


def _of_xarray(table: xr.Dataset) -> list[tuple[str, list[Any]]]:
    """Return the variables of a dataset, and coordinates named like keys, as keys with values."""
    keys = [*table.data_vars, *(name for name in table.coords if "." in str(name))]
    along = {table[key].dims for key in keys}
    if len(along) > 1 or any(len(dims) != 1 for dims in along):
        raise SceneError("cases: must have one dimension, which all keys share")
    units = (table[key].attrs.get("units", "") for key in keys)
    return [
        _column(str(key), table[key].values, "" if unit == "1" else unit)
        for key, unit in zip(keys, units, strict=True)
    ]


def _of_file(path: Path) -> list[tuple[str, list[Any]]]:
    """Return the columns of a CSV file as keys with values; raises `ResultError` if invalid."""
    try:
        text = StringIO(read_text(path), newline="")
        reader = csv.reader(text, skipinitialspace=True, strict=True)
        rows = [(reader.line_num, [cell.strip() for cell in row]) for row in reader if row]
    except FileNotFoundError:
        raise ResultError(f"{path}: no such file") from None
    except IsADirectoryError:
        raise ResultError(f"{path}: is a folder") from None
    except (OSError, ValueError, csv.Error) as error:
        raise ResultError(f"{path}: not a table of cases: {' '.join(str(error).split())}") from None
    if not rows:
        raise ResultError(f"{path}: not a table of cases: it is empty")
    (_, headings), *rows = rows
    for line, row in rows:
        if len(row) != len(headings):
            raise ResultError(
                f"{path}: line {line}: {len(row)} cells under {len(headings)} headings"
            )
        if "" in row:
            raise ResultError(f"{path}: line {line}: {headings[row.index('')]} is empty")
    try:
        return [_column(each, [row[i] for _, row in rows]) for i, each in enumerate(headings)]
    except SceneError as error:
        raise ResultError(f"{path}: {error}") from None
