"""Entries of a force's data as a `UserForce` reads them, with checks of index and kind.

An entry that does not exist or has another kind raises an `IndexError`. Built-in forces use the
readers in `tweezer.forces.data`, which have no checks.
"""

from __future__ import annotations

from tweezer.compiled import named_njit
from tweezer.forces import data as unchecked

_number, _vector = unchecked.number, unchecked.vector
_matrix, _tensor = unchecked.matrix, unchecked.tensor


@named_njit(error_model="numpy")
def _check(data, entry, axes):  # type: ignore[no-untyped-def]
    """Raise `IndexError` unless a force's data have this entry, as an array of `axes` axes."""
    if entry < 0 or entry >= len(data.shapes):
        raise IndexError("the force has no entry of this number; entries are counted from 0")
    if data.shapes[entry, 6] != axes:
        raise IndexError(
            "the entry has another kind; number, vector, matrix and tensor read entries of 0, 1, 2 "
            "and 3 axes"
        )


@named_njit(error_model="numpy")
def number(data, entry):  # type: ignore[no-untyped-def]
    """Return an entry of a force that is one number; raise `IndexError` for another kind."""
    _check(data, entry, 0)
    return _number(data, entry)


@named_njit(error_model="numpy")
def vector(data, entry):  # type: ignore[no-untyped-def]
    """Return an entry of a force that is an array of one axis; raise `IndexError` for others."""
    _check(data, entry, 1)
    return _vector(data, entry)


@named_njit(error_model="numpy")
def matrix(data, entry):  # type: ignore[no-untyped-def]
    """Return an entry of a force that is an array of two axes; raise `IndexError` for others."""
    _check(data, entry, 2)
    return _matrix(data, entry)


@named_njit(error_model="numpy")
def tensor(data, entry):  # type: ignore[no-untyped-def]
    """Return an entry of a force that is an array of three axes; raise `IndexError` for others."""
    _check(data, entry, 3)
    return _tensor(data, entry)


READERS = {
    "number": (number, _number), "vector": (vector, _vector),
    "matrix": (matrix, _matrix), "tensor": (tensor, _tensor),
}  # fmt: skip
"""name: the reader that checks, and the one that does not; in the order of axes"""
