"""The data of a force as two arrays of fixed types, so that one loop serves every force."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import typeof
from numpy.typing import NDArray

from tweezer.compiled import named_njit
from tweezer.values.arrays import Array

Integers = NDArray[np.int64]

#: Columns of `Data.shapes`: first index of an entry, four lengths, address of a part, kind
COLUMNS = 7
#: Kinds of entries beside arrays of numbers, whose kind is the number of their axes
_INTEGERS, _PART = 5, 6
#: Numbers in a line of the processor's cache; every entry begins with one
_LINE = 8


class Data(NamedTuple):
    """Data of a force: a list of entries, stored as two arrays that compiled code reads.

    An entry is a number, an array of up to four axes, or another force with its data.
    """

    numbers: Array
    """all arrays, flattened and concatenated, each from a multiple of 8 on, (n,)"""
    shapes: Integers
    """one row for each entry, (entries, 7). For an array: its begin in `numbers` and its lengths.
    For a part: begin and count of its numbers, begin and count of its rows of `shapes`, 0, and the
    address of its kernel. The last column is the kind of the entry"""


class Part(NamedTuple):
    """A force in the form in which compiled loops and other forces call it."""

    kernel: int
    """address of the compiled kernel"""
    data: Data
    """of the kernel"""


def packed(*entries: Any) -> Data:
    """Return the data of a force from its entries: numbers, arrays (real or int32) and `Part`s.

    Compiled code reads an entry by its index, with `number`, `vector`, `part` and so on.
    """
    flat: list[Array] = []
    own = np.zeros((len(entries), COLUMNS), np.int64)
    rows, begin = [own], 0
    for row, entry in zip(own, entries, strict=True):
        if isinstance(entry, Part):
            numbers, shapes = entry.data
            first = sum(map(len, rows))
            row[:] = begin, numbers.size, first, len(shapes), 0, entry.kernel, _PART
            rows.append(shapes)
        else:
            array = np.ascontiguousarray(entry)
            row[0] = begin
            row[1 : 1 + array.ndim] = array.shape
            row[-1] = np.ndim(entry)
            if array.dtype == np.int32:  # two of them in the memory of one number
                row[-1] = _INTEGERS
                whole = array.ravel()
                numbers = np.append(whole, np.zeros(whole.size % 2, np.int32)).view(np.float64)
            else:
                numbers = array.astype(np.float64).ravel()
        flat += [numbers, np.zeros(-numbers.size % _LINE)]
        begin += numbers.size + flat[-1].size
    aligned = _by_lines(begin)
    np.concatenate([*flat, np.zeros(0)], out=aligned)
    return Data(aligned, np.concatenate(rows))


def renumbered(data: Data, numbers: dict[int, float]) -> Data:
    """Return a copy of data in which some entries that are single numbers have new values.

    `numbers` contains new values by the index of the entry. Each of these entries must be a single
    number.
    """
    changed = _by_lines(data.numbers.size)
    changed[:] = data.numbers
    for entry, value in numbers.items():
        changed[data.shapes[entry, 0]] = value
    return Data(changed, data.shapes)


def _by_lines(size: int) -> Array:
    """Return an array of `size` numbers that begins with a line of the processor's cache."""
    memory = np.empty(size + _LINE)
    first = -(memory.ctypes.data // memory.itemsize) % _LINE
    return memory[first : first + size]


@named_njit(error_model="numpy")
def begin_of(data, entry):  # type: ignore[no-untyped-def]
    """Return the index in `data.numbers` at which the array of an entry begins."""
    return data.shapes[entry, 0]


@named_njit(error_model="numpy")
def number(data, entry):  # type: ignore[no-untyped-def]
    """Return the entry of a force's data with the index `entry`, which is a single number."""
    return data.numbers[data.shapes[entry, 0]]


@named_njit(error_model="numpy")
def vector(data, entry):  # type: ignore[no-untyped-def]
    """Return an entry of a force's data that is an array of one axis."""
    begin = data.shapes[entry, 0]
    return data.numbers[begin : begin + data.shapes[entry, 1]]


@named_njit(error_model="numpy")
def matrix(data, entry):  # type: ignore[no-untyped-def]
    """Return an entry of a force's data that is an array of two axes."""
    begin, n, m = data.shapes[entry, 0], data.shapes[entry, 1], data.shapes[entry, 2]
    return data.numbers[begin : begin + n * m].reshape((n, m))


@named_njit(error_model="numpy")
def tensor(data, entry):  # type: ignore[no-untyped-def]
    """Return an entry of a force's data that is an array of three axes."""
    begin, n, m = data.shapes[entry, 0], data.shapes[entry, 1], data.shapes[entry, 2]
    many = data.shapes[entry, 3]
    return data.numbers[begin : begin + n * m * many].reshape((n, m, many))


@named_njit(error_model="numpy")
def tensor_of_four(data, entry):  # type: ignore[no-untyped-def]
    """Return an entry of a force's data that is an array of four axes."""
    begin, n, m = data.shapes[entry, 0], data.shapes[entry, 1], data.shapes[entry, 2]
    k, l = data.shapes[entry, 3], data.shapes[entry, 4]
    return data.numbers[begin : begin + n * m * k * l].reshape((n, m, k, l))


@named_njit(error_model="numpy")
def integers(data, entry):  # type: ignore[no-untyped-def]
    """Return an entry of a force's data that is an array of 32-bit integers with one axis.

    Two of them are stored in the memory of one number.
    """
    begin, n = data.shapes[entry, 0], data.shapes[entry, 1]
    return data.numbers[begin : begin + (n + 1) // 2].view(np.int32)[:n]


@named_njit(error_model="numpy")
def part(data, entry):  # type: ignore[no-untyped-def]
    """Return an entry of a force's data that is another force, as a `Part`."""
    begin, n = data.shapes[entry, 0], data.shapes[entry, 1]
    first, rows = data.shapes[entry, 2], data.shapes[entry, 3]
    within = Data(data.numbers[begin : begin + n], data.shapes[first : first + rows])
    return Part(data.shapes[entry, 5], within)


DATA = typeof(Data(np.zeros(0), np.zeros((0, COLUMNS), np.int64)))
"""Numba's type of `Data`"""
