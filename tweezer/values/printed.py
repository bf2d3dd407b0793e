"""SI numbers as text, in the units in which results print them."""

from __future__ import annotations

import math
from collections.abc import Iterable

from tweezer.values.prefixes import per
from tweezer.values.rounding import rounded, with_uncertainty


def scaled(value: float, unit: str) -> float:
    """Return an SI number converted to the unit with this name."""
    return per(unit) * value


def in_unit(value: float, unit: str, digits: int = 4) -> str:
    """Return an SI number as text in the unit with this name, without the name."""
    return f"{scaled(value, unit):.{digits}g}"


def printed(values: float | Iterable[float], unit: str, digits: int = 4) -> str:
    """Return an SI number, or several, as text with the unit: "12.3, 12.3, 4.1 pN/um"."""
    numbers = values if isinstance(values, Iterable) else (values,)
    return f"{', '.join(in_unit(each, unit, digits) for each in numbers)} {unit}".rstrip()


def pair(value: float, error: float, unit: str) -> tuple[str, str]:
    """Return an SI number and its uncertainty, converted to a unit, as two texts without unit."""
    return rounded(scaled(value, unit), scaled(error, unit))


def with_error(value: float, error: float | None, unit: str, sign: str = "+-") -> str:
    """Return an SI number as text with its uncertainty, if known, and the unit.

    Parameters
    ----------
    value : float
        The number, in SI units.
    error : float, optional
        Its uncertainty, in SI units.
    unit : str
        Unit of the text, such as "um".
    sign : str, optional
        Text between the number and its uncertainty.
    """
    error = math.nan if error is None else scaled(error, unit)
    return f"{with_uncertainty(scaled(value, unit), error, sign)} {unit}".rstrip()


def signal_unit(unit: str) -> str:
    """Return the unit in which small signals in "m", "V" or "W" are printed: "nm", "mV" or "mW"."""
    return {"V": "mV", "W": "mW"}.get(unit, "nm")
