"""Files with recorded extensions and forces of a stretched molecule."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from tweezer.reading.text import open_text
from tweezer.values.arrays import Array
from tweezer.values.errors import ResultError
from tweezer.values.saved import TEXTS
from tweezer.values.units import to_si

#: Columns of the table, with their SI units
_UNITS = {"extension": "m", "force": "N"}
#: Heading with its unit in brackets or after a slash, such as "force [pN]"
_HEADING = re.compile(r"\s*([a-z]+)\s*(?:[\[(/]\s*([^\])]+?)\s*[\])]?)?\s*", re.I)


def read_curve(path: str | Path) -> tuple[Array, Array]:
    """Return the columns extension (n,), m, and force (n,), N, of a table in a text file.

    Raises `ResultError` if the file is not such a table, if a unit is missing, and for numbers that
    are not finite.
    """
    path = Path(path)
    if path.suffix.lower() not in TEXTS:
        raise ResultError(f"{path}: must end in {', '.join(TEXTS)}")
    table = open_text(path, lambda cells: set(_UNITS) <= {_heading(cell)[0] for cell in cells})
    names = [_heading(column.heading)[0] for column in table.columns]
    for name in _UNITS:
        if names.count(name) != 1:
            raise ResultError(
                f"{path}: has {names.count(name)} columns with the heading {name}; must have the "
                'columns "extension" and "force" with units, such as "force [pN]"'
            )
    chosen = [names.index(name) for name in _UNITS]
    factors = []
    for index, (name, unit) in zip(chosen, _UNITS.items(), strict=True):
        column = table.columns[index]
        stated = _heading(column.heading)[1] or column.unit
        try:
            factors.append(to_si(f"1 {stated}", unit))
        except ValueError:
            raise ResultError(
                f'{path}: {name}: requires a unit of {unit}, such as "{name} [{unit}]"'
            ) from None
    extension, force = (
        factor * values for factor, values in zip(factors, table.numbers(chosen), strict=True)
    )
    if not (np.isfinite(extension) & np.isfinite(force)).all():
        raise ResultError(f"{path}: contains values that are not finite; remove their rows")
    return extension, force


def _heading(text: str) -> tuple[str, str | None]:
    """Return the name in a heading, in lower case, and its unit; None without one."""
    found = _HEADING.fullmatch(text)
    return (found[1].lower(), found[2]) if found else ("", None)
