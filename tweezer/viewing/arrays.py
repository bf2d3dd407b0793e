"""Compact encoding of arrays of numbers in a page, with the rounding error that it causes."""

from __future__ import annotations

import base64
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tweezer.values.errors import ResultError

#: Number of steps of a range that 16 bits can distinguish; the next number marks a missing value
_STEPS = 65534


class TooLargeError(ResultError, ValueError):
    """Error for values that the number formats of a page cannot represent."""


@dataclass(frozen=True)
class Packed:
    """An array encoded as text: little-endian numbers in base64, with the rule for decoding them.

    A value is `offset + step * number`. A missing value is NaN, or the largest number of uint16.
    """

    data: str
    """the numbers in base64"""
    type: str
    """"float32" or "uint16" """
    shape: tuple[int, ...]
    unit: str
    rounding: float
    """largest difference between a decoded value and the original, in `unit`"""
    largest: float
    """largest magnitude of a value, in `unit`"""
    offset: float = 0.0
    """value that the number 0 represents, in `unit`"""
    step: float = 1.0
    """difference between the values of successive numbers, in `unit`"""

    def values(self) -> NDArray[np.float64]:
        """Return the decoded values, as the page shows them, in `unit`."""
        raw = np.frombuffer(base64.b64decode(self.data), np.dtype(self.type).newbyteorder("<"))
        values = self.offset + self.step * raw.astype(np.float64)
        if self.type == "uint16":
            values[raw == _STEPS + 1] = np.nan
        return values.reshape(self.shape)

    def as_json(self) -> dict[str, Any]:
        """Return the array as a JSON object for the JavaScript of the page."""
        return {**vars(self), "shape": list(self.shape)}


def float32(values: ArrayLike, unit: str) -> Packed:
    """Encode values in 4 bytes each; values that are not finite become missing.

    The relative rounding error is at most 6e-8. Raises `TooLargeError` for values beyond 3.4e38 in
    `unit`, which 4 bytes cannot represent.
    """
    given = np.asarray(values, dtype=np.float64)
    with np.errstate(over="ignore"):
        short = np.where(np.isfinite(given), given, np.nan).astype("<f4")
    if np.isinf(short).any():
        raise TooLargeError(f"values in {unit}: too large for 4 bytes")
    return _packed(short, given, short.astype(np.float64), unit)


def uint16(values: ArrayLike, unit: str) -> Packed:
    """Encode values in 2 bytes each; values that are not finite become missing.

    The rounding error is at most 1/131068 of the range of all values, which suffices to draw the
    positions of many beads.
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
    """Return an encoded array with its rounding error.

    `raw` contains the encoded numbers, `given` the values before encoding and `shown` the values
    after decoding, in `unit`. `reading` contains offset and step, if numbers are not values.
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
