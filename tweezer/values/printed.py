"""Numbers in SI as text, in the units in which results print them."""

from __future__ import annotations

import math

from tweezer.values.rounding import rounded, with_uncertainty

#: Factors from SI to the printed units
_FACTORS = {
    "um": 1e6, "nm": 1e9, "s": 1.0, "ms": 1e3, "us": 1e6, "Hz": 1.0, "kHz": 1e-3, "pN/um": 1e6,
    "nN s/m": 1e9, "mPa s": 1e3, "zJ": 1e21, "um^2/s": 1e12, "V^2/s": 1.0, "10^-12 V^2/s": 1e12,
    "mV": 1e3, "um/V": 1e6, "pN/V": 1e12, "10^-23 J/K": 1e23, "m": 1.0, "W": 1.0, "": 1.0,
}  # fmt: skip


def scaled(value: float, unit: str) -> float:
    """Return a number in SI in the printed unit."""
    return _FACTORS[unit] * value


def in_unit(value: float, unit: str, digits: int = 4) -> str:
    """Return the text of a number without its unit."""
    return f"{scaled(value, unit):.{digits}g}"


def printed(value: float, unit: str, digits: int = 4) -> str:
    """Return the text of a number with its unit."""
    return f"{in_unit(value, unit, digits)} {unit}".rstrip()


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
