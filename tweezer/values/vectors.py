"""Vectors and matrices in results: read-only NumPy arrays that can be saved."""

from __future__ import annotations

import dataclasses
from typing import Annotated, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import GetPydanticSchema
from pydantic_core import core_schema


def fixed(values: ArrayLike) -> NDArray[np.float64]:
    """Return a read-only copy of `values` as an array of floats; None becomes NaN."""
    array = np.array(values, dtype=float)
    array.flags.writeable = False
    return array


def _read(values: Any) -> NDArray[np.float64]:
    """Return an array from a file; raises `ValueError` if it does not consist of numbers."""
    try:
        return fixed(values)
    except (TypeError, OverflowError) as error:
        raise ValueError(f"not an array of numbers: {error}") from None


#: Array that is saved as a (nested) list of numbers, with null for NaN
Vector = Annotated[
    NDArray[np.float64],
    GetPydanticSchema(lambda *_: core_schema.no_info_plain_validator_function(_read)),
]


class Comparable:
    """Base of a dataclass (with `eq=False`) that contains arrays."""

    def __eq__(self, other: object) -> bool:
        """Return whether all compared fields are equal, where NaN equals NaN."""
        if type(other) is not type(self):
            return NotImplemented
        return all(
            _same(getattr(self, each.name), getattr(other, each.name))
            for each in dataclasses.fields(self)  # type: ignore[arg-type]
            if each.compare
        )

    __hash__ = None  # type: ignore[assignment]


def _same(one: Any, other: Any) -> bool:
    """Return whether two values or arrays are equal, where NaN in arrays equals NaN."""
    if isinstance(one, np.ndarray) or isinstance(other, np.ndarray):
        return np.array_equal(one, other, equal_nan=True)
    return bool(one == other)
