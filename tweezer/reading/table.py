"""Tables in files, before their numbers are read."""

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
#: Names of numbers that state a sampling rate
_RATES = {
    "fs", "fps", "rate", "framerate", "samplerate", "samplingrate", "samplefrequency",
    "samplingfrequency", "sampfreq",
}  # fmt: skip


@dataclass(frozen=True)
class Column:
    """A column of a table, before its numbers are read."""

    name: str
    """heading with the groups of the file that contain it, unique in the file"""
    heading: str
    """last part of the name, which may contain quantity and unit, such as "x [um]\""""
    unit: str | None = None
    """unit given outside the heading, in an attribute or a line of units"""
    step: float | None = None
    """sampling interval stated in the file, s; None without one"""
    note: str = ""
    """changes to its numbers; "" for none"""
    samples: int = 0
    """number of samples; 0 if it is known only after reading"""

    @property
    def group(self) -> str:
        """Groups of the file that contain the column: its name without the heading."""
        return self.name.removesuffix(self.heading)


@dataclass(frozen=True)
class Table:
    """The columns of a file, and functions that read their content."""

    name: str
    """of the file"""
    columns: Sequence[Column]
    numbers: Callable[[Sequence[int]], list[Array]]
    """function that reads the columns with the given indices as arrays (n,)"""
    headed: bool = True
    """whether its columns have headings"""
    rate_beside: str = ""
    """number in the file that may be the sampling rate, such as "fs = 10000\""""
    labels: Callable[[int], list[str]] | None = None
    """function that reads the cells of the column with a given index as text; None if all columns
    contain numbers"""


def columns_of(
    name: str, heading: str, shape: Sequence[int], unit: str | None = None
) -> list[Column]:
    """Return the columns of an array with one or two dimensions; none if it is not a table.

    The longer axis counts samples, the shorter one columns. Several columns are numbered, as in
    "name:1".

    Parameters
    ----------
    name : str
        Name of the array.
    heading : str
        Its heading.
    shape : sequence of int
        Its shape.
    unit : str, optional
        Its unit.
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
    """Raise `ResultError` for more samples than can be read."""
    if samples > MOST_SAMPLES:
        raise ResultError(
            f"{file}: {name}: has {samples:,} samples; must have at most {MOST_SAMPLES:,}"
        )


def column_of(array: NDArray[Any], column: int) -> Array:
    """Return the column (n,) with the index `column` of an array with samples along its longer
    axis.
    """
    if min(array.shape) == 1:
        array = array.ravel()
    if array.ndim == 2 and array.shape[0] < array.shape[1]:
        array = array.T
    return np.asarray(array if array.ndim == 1 else array[:, column], dtype=np.float64)


def rate_among(scalars: dict[str, float]) -> str:
    """Return the first number whose name denotes a sampling rate, as "fs = 10000"; "" for none."""
    for name, value in scalars.items():
        if "".join(each for each in last_part(name).lower() if each.isalpha()) in _RATES:
            return f"{name} = {value:g}"
    return ""


def last_part(name: str) -> str:
    """Return a name without the preceding groups: "x" for "group/bead.x"."""
    return name.rpartition("/")[2].rpartition(".")[2]
