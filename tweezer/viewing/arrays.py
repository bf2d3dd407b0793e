"""Arrays of a page: numbers in few bytes, with the error that this makes."""

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
    """Values that a page cannot hold."""


@dataclass(frozen=True)
class Packed:
    """An array as text: base64 of little-endian numbers, and how they are read.

    A value is `offset + step * number`; NaN, and of whole numbers the largest, is a missing one.
    """

    data: str
    type: str
    """"float32" or "uint16" """
    shape: tuple[int, ...]
    unit: str
    rounding: float
    """largest difference between a value of the page and the one given, in `unit`"""
    largest: float
    """largest size of a value, in `unit`"""
    offset: float = 0.0
    step: float = 1.0

    def values(self) -> NDArray[np.float64]:
        """The values that the page shows."""
        raw = np.frombuffer(base64.b64decode(self.data), np.dtype(self.type).newbyteorder("<"))
        values = self.offset + self.step * raw.astype(np.float64)
        if self.type == "uint16":
            values[raw == _STEPS + 1] = np.nan
        return values.reshape(self.shape)

    def as_json(self) -> dict[str, Any]:
        """What the page reads."""
        return {**vars(self), "shape": list(self.shape)}


def float32(values: ArrayLike, unit: str) -> Packed:
    """`values` in 4 bytes each: rounded to 6e-8 of each value. One that is not finite is missing.

    Raises `TooLargeError` for values that 4 bytes do not hold: beyond 3.4e38 in `unit`.
    """
    given = np.asarray(values, dtype=np.float64)
    with np.errstate(over="ignore"):
        short = np.where(np.isfinite(given), given, np.nan).astype("<f4")
    if np.isinf(short).any():
        raise TooLargeError(f"values in {unit}: too large for 4 bytes")
    return _packed(short, given, short.astype(np.float64), unit)


def uint16(values: ArrayLike, unit: str) -> Packed:
    """`values` in 2 bytes each: rounded to 1/131068 of their range. What is not finite is missing.

    For many beads, of which a picture needs the places alone.
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
