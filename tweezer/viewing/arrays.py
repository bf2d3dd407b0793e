"""Arrays of numbers in a page, in few bytes, with the rounding error that this causes."""

from __future__ import annotations

import base64
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tweezer.values.errors import ResultError

#: Number of steps of a range that 16 bits tell apart; one more number is that of what is missing
_STEPS = 65534


class TooLargeError(ResultError, ValueError):
    """Error for values that are too large for the arrays of a page."""


@dataclass(frozen=True)
class Packed:
    """An array of numbers as text: little-endian numbers in base64, and how to decode them.

    A value is `offset + step * number`. Missing values are NaN, or the largest number for uint16.
    """

    data: str
    """the numbers in base64"""
    type: str
    """"float32" or "uint16" """
    shape: tuple[int, ...]
    unit: str
    rounding: float
    """largest difference between a value of the page and the one given, in `unit`"""
    largest: float
    """largest size of a value, in `unit`"""
    offset: float = 0.0
    """value of the number 0, in `unit`"""
    step: float = 1.0
    """difference of values for neighbouring numbers, in `unit`"""

    def values(self) -> NDArray[np.float64]:
        """Return the values that the page shows, decoded, in `unit`."""
        raw = np.frombuffer(base64.b64decode(self.data), np.dtype(self.type).newbyteorder("<"))
        values = self.offset + self.step * raw.astype(np.float64)
        if self.type == "uint16":
            values[raw == _STEPS + 1] = np.nan
        return values.reshape(self.shape)

    def as_json(self) -> dict[str, Any]:
        """Return the array as a JSON object, as the JavaScript of a page reads it."""
        return {**vars(self), "shape": list(self.shape)}


def float32(values: ArrayLike, unit: str) -> Packed:
    """Return values as an array of a page, in 4 bytes each; values that are not finite are missing.

    Each is rounded to 6e-8 of its value. Raises `TooLargeError` for values beyond 3.4e38 in `unit`,
    which 4 bytes cannot represent.
    """
    given = np.asarray(values, dtype=np.float64)
    with np.errstate(over="ignore"):
        short = np.where(np.isfinite(given), given, np.nan).astype("<f4")
    if np.isinf(short).any():
        raise TooLargeError(f"values in {unit}: too large for 4 bytes")
    return _packed(short, given, short.astype(np.float64), unit)


def uint16(values: ArrayLike, unit: str) -> Packed:
    """Return values as an array of a page, in 2 bytes each; values that are not finite are missing.

    Each is rounded to 1/131068 of the range of all. This suits many beads, whose positions are only
    drawn.
    """
    given = np.asarray(values, dtype=np.float64)
    there = np.isfinite(given)
    low, high = (given[there].min(), given[there].max()) if there.any() else (0.0, 0.0)
    step = (high - low) / _STEPS or 1.0
    numbers = np.full(given.shape, _STEPS + 1, dtype="<u2")
    numbers[there] = np.rint((given[there] - low) / step)
    shown = np.where(there, low + step * numbers, np.nan)
    return _packed(numbers, given, shown, unit, offset=float(low), step=float(step))


def _packed(
    raw: NDArray[Any], given: NDArray[Any], shown: NDArray[Any], unit: str, **reading: float
) -> Packed:
    """Return the array of a page from its encoded numbers, with its rounding error.

    raw: numbers to be written. given: values before encoding. shown: values after decoding.
    reading: offset and step, if numbers are not values.
    """
    there = np.isfinite(given)
    rounding = float(np.abs(shown - given)[there].max(initial=0.0))
    return Packed(
        data=base64.b64encode(raw.tobytes()).decode(),
        type=str(raw.dtype.newbyteorder("=")),
        shape=given.shape,
        unit=unit,
        rounding=rounding,
        largest=float(np.abs(given)[there].max(initial=0.0)),
        **reading,
    )
