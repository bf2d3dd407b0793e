"""A table in a file, before its numbers are read."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tweezer.values.arrays import Array
from tweezer.values.errors import ResultError

#: Largest number of samples; more do not fit into the memory of most machines
MOST_SAMPLES = 50_000_000
#: Largest number of columns that an array of rows may have
_MOST_COLUMNS = 1000
#: Names of numbers that say how fast was recorded
_RATES = {
    "fs", "fps", "rate", "framerate", "samplerate", "samplingrate", "samplefrequency",
    "samplingfrequency", "sampfreq",
}  # fmt: skip


@dataclass(frozen=True)
class Column:
    """A column of a table, before its numbers are read."""

    name: str
    """its name with the groups of the file that contain it, unique in the file"""
    heading: str
    """last part of the name, which may say the quantity and its unit: "x [um]\""""
    unit: str | None = None
    """unit given beside the heading, as in an attribute or a line of units"""
    step: float | None = None
    """sampling interval that the file states, s; None if it states none"""
    note: str = ""
    """what was done to its numbers; "" for nothing"""
    samples: int = 0
    """number of its samples; 0 if it is known only after reading"""

    @property
    def group(self) -> str:
        """The group of the file that contains the column: its name without the heading."""
        return self.name.removesuffix(self.heading)


@dataclass(frozen=True)
class Table:
    """The columns of a file, and functions that read their content."""

    name: str
    """of the file"""
    columns: Sequence[Column]
    numbers: Callable[[Sequence[int]], list[Array]]
    """function that reads the columns with these numbers, from 0; each is an array (n,)"""
    headed: bool = True
    """whether its columns have headings"""
    rate_beside: str = ""
    """a number of the file that may be its rate: "fs = 10000\""""
    labels: Callable[[int], list[str]] | None = None
    """function that reads the cells of a column, by its number, as text; None if all columns
    contain numbers"""


def columns_of(
    name: str, heading: str, shape: Sequence[int], unit: str | None = None
) -> list[Column]:
    """Return the columns of an array of one dimension or of two; none if it is no table.

    The longer axis of two counts samples, the shorter one columns. name, heading, unit: of the
    array; columns of several are numbered, as "name:1". shape: of the array.
    """
    samples = max(shape, default=0)
    if len(shape) == 1 or (len(shape) == 2 and min(shape) == 1 < samples):
        return [Column(name, heading, unit, samples=samples)]
    if len(shape) != 2 or not 1 < min(shape) <= _MOST_COLUMNS:
        return []
    return [
        Column(f"{name}:{i + 1}", f"{heading}:{i + 1}", unit, samples=samples)
        for i in range(min(shape))
    ]


def refuse_too_long(file: str, name: str, samples: int) -> None:
    """Raise `ResultError` for more samples than are read."""
    if samples > MOST_SAMPLES:
        raise ResultError(
            f"{file}: {name}: has {samples:,} samples; must have at most {MOST_SAMPLES:,}"
        )


def column_of(array: NDArray[Any], column: int) -> Array:
    """Return the column with this number, (n,), of an array with samples along its longer axis."""
    if min(array.shape) == 1:
        array = array.ravel()
    if array.ndim == 2 and array.shape[0] < array.shape[1]:
        array = array.T
    return np.asarray(array if array.ndim == 1 else array[:, column], dtype=np.float64)


def rate_among(scalars: dict[str, float]) -> str:
    """Return the first number whose name means a sampling rate, as "fs = 10000"; "" for none."""
    for name, value in scalars.items():
        if "".join(each for each in last_part(name).lower() if each.isalpha()) in _RATES:
            return f"{name} = {value:g}"
    return ""


def last_part(name: str) -> str:
    """Return a name without the groups that precede it: "x" for "group/bead.x"."""
    return name.rpartition("/")[2].rpartition(".")[2]
