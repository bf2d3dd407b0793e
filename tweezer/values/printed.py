"""Numbers in SI as text, in the units in which results print them."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from tweezer.values.prefixes import per
from tweezer.values.rounding import rounded, with_uncertainty


def scaled(value: float, unit: str) -> float:
    """Return a number in SI in the printed unit."""
    return per(unit) * value


def in_unit(value: float, unit: str, digits: int = 4) -> str:
    """Return the text of a number without its unit."""
    return f"{scaled(value, unit):.{digits}g}"


def printed(values: ArrayLike, unit: str, digits: int = 4) -> str:
    """Return the text of a number, or of several, with its unit: "12.3, 12.3, 4.1 pN/um"."""
    numbers = (in_unit(each, unit, digits) for each in np.ravel(np.asarray(values, float)))
    return f"{', '.join(numbers)} {unit}".rstrip()


def pair(value: float, error: float, unit: str) -> tuple[str, str]:
    """Return the texts of a number and its uncertainty, without their unit."""
    return rounded(scaled(value, unit), scaled(error, unit))


def with_error(value: float, error: float | None, unit: str, sign: str = "+-") -> str:
    """Return the text of a number with its uncertainty, if that is known, and its unit."""
    error = math.nan if error is None else scaled(error, unit)
    return f"{with_uncertainty(scaled(value, unit), error, sign)} {unit}".rstrip()


def signal_unit(unit: str) -> str:
    """Return the printed unit of small signals in "m" or "V"."""
    return "mV" if unit == "V" else "nm"
