"""A table in a file, before its numbers are read."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tweezer.values.errors import ResultError

Array = NDArray[np.float64]

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
    """A column, before its numbers are read."""

    name: str
    """unique in its file"""
    heading: str
    """what is said to be in it: the last part of its name"""
    unit: str | None = None
    """given beside the heading"""
    step: float | None = None
    """s, between its rows, as the file says"""
    note: str = ""
    """what was done to its numbers"""
    samples: int = 0
    """its length, where the file tells it"""

    @property
    def group(self) -> str:
        """The group of the file that contains the column: its name without the heading."""
        return self.name.removesuffix(self.heading)


@dataclass(frozen=True)
class Table:
    """The columns of a file."""

    name: str
    """of the file"""
    columns: Sequence[Column]
    numbers: Callable[[Sequence[int]], list[Array]]
    """of the columns with those places"""
    headed: bool = True
    """whether its columns have headings"""
    rate_beside: str = ""
    """a number of the file that may be its rate: "fs = 10000\""""
    labels: Callable[[int], list[str]] | None = None
    """of the cells of a column as text; None: columns have numbers alone"""


def columns_of(
    name: str, heading: str, shape: Sequence[int], unit: str | None = None
) -> list[Column]:
    """The columns of an array of that shape: one, or those of its rows; none if it is no table."""
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
    """A column of an array of rows. Its longer axis is that of the rows."""
    if min(array.shape) == 1:
        array = array.ravel()
    if array.ndim == 2 and array.shape[0] < array.shape[1]:
        array = array.T
    return np.asarray(array if array.ndim == 1 else array[:, column], dtype=np.float64)


def rate_among(scalars: dict[str, float]) -> str:
    """The number that is called a rate, as it is written; nothing if none is."""
    for name, value in scalars.items():
        if "".join(each for each in last_part(name).lower() if each.isalpha()) in _RATES:
            return f"{name} = {value:g}"
    return ""


def last_part(name: str) -> str:
    """The name without those of the groups that it is in."""
    return name.rpartition("/")[2].rpartition(".")[2]
