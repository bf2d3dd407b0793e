"""Numbers in SI as text, in the units in which results print them."""

from __future__ import annotations

import math
from collections.abc import Iterable

from tweezer.values.prefixes import per
from tweezer.values.rounding import rounded, with_uncertainty


def scaled(value: float, unit: str) -> float:
    """Return a number in SI in the printed unit."""
    return per(unit) * value


def in_unit(value: float, unit: str, digits: int = 4) -> str:
    """Return the text of a number without its unit."""
    return f"{scaled(value, unit):.{digits}g}"


def printed(values: float | Iterable[float], unit: str, digits: int = 4) -> str:
    """Return the text of a number, or of several, with its unit: "12.3, 12.3, 4.1 pN/um"."""
    numbers = values if isinstance(values, Iterable) else (values,)
    return f"{', '.join(in_unit(each, unit, digits) for each in numbers)} {unit}".rstrip()


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


def located(value: float, error: float | None, unit: str) -> str:
    """Return the text of a number of a run, rounded to its error if that is known, and its unit."""
    scale = per(unit)
    text = f"{scale * value:.3g}"
    if error == 0:
        text = f"{scale * value:.4g}"
    elif error is not None and math.isfinite(value) and math.isfinite(error):
        digits = math.floor(math.log10(max(abs(value), error))) - math.floor(math.log10(error)) + 1
        text = f"{scale * value:.{digits}g} +- {scale * error:.1g}"
    return f"{text} {unit}".rstrip()
