"""Numbers as text, with as many digits as their uncertainty justifies."""

from __future__ import annotations

import math
from collections.abc import Callable

#: Range of magnitudes that are written without a power of ten.
_PLAIN = (1e-6, 1e7)


def rounded(value: float, uncertainty: float) -> tuple[str, str]:
    """Return a value and its uncertainty as text, each with its significant digits.

    The uncertainty has two digits, and the value is rounded to the same decimal place. If the
    uncertainty is below the fourth significant digit of the value, four digits are printed.
    """
    if not 0 < uncertainty < math.inf or not math.isfinite(value):
        return f"{value:.4g}", f"{uncertainty:.2g}"
    if below_four_digits(value, uncertainty):
        return _to_place(value, _power(value, 3) - 3, abs(value)), f"{uncertainty:.2g}"
    place, size = _power(uncertainty, 1) - 1, max(abs(value), uncertainty)
    return _to_place(value, place, size), _to_place(uncertainty, place, size)


def below_four_digits(value: float, uncertainty: float) -> bool:
    """Return whether an uncertainty is less than a unit of the fourth significant digit."""
    return uncertainty < 10.0 ** (_power(value, 3) - 3) if value else uncertainty == 0


def _power(value: float, decimals: int) -> int:
    """Return the exponent of a number's first digit after rounding to 1 + `decimals` digits."""
    return int(f"{value:.{decimals}e}".partition("e")[2])  # 9.96 becomes 1.0e1 first


def _to_place(value: float, place: int, size: float) -> str:
    """Return a number as text, rounded to the decimal place 10^place.

    The magnitude `size` determines whether a power of ten is written.
    """
    if not _PLAIN[0] <= size < _PLAIN[1]:
        power = math.floor(math.log10(size))
        return f"{value / 10.0**power:z.{max(power - place, 0)}f}e{power}"
    return f"{round(value, -place):z.{max(-place, 0)}f}"


def least(value: float, digits: int = 3) -> str:
    """Return a lower bound as text, rounded up, so that the printed number is allowed.

    Bounds hold to 1 part in 1e9, which allows for rounding in the last bit.
    """
    return _towards(math.ceil, value, digits)


def most(value: float, digits: int = 3) -> str:
    """Return an upper bound as text, rounded down, so that the printed number is allowed."""
    return _towards(math.floor, value, digits)


def _towards(rounding: Callable[[float], int], value: float, digits: int) -> str:
    """Return a number as text with `digits` digits, rounded by `math.ceil` or `math.floor`."""
    text = f"{value:.{digits}g}"
    if not math.isfinite(value) or math.isclose(float(text), value, rel_tol=1e-12):
        return text
    power = math.floor(math.log10(abs(value))) - digits + 1
    return f"{rounding(value / 10.0**power) * 10.0**power:.{digits}g}"


def with_uncertainty(value: float, uncertainty: float, sign: str = "+-") -> str:
    """Return text such as "50.35 +- 0.49".

    It is the value alone, with four digits, if the uncertainty is NaN or below the fourth digit.
    """
    first, second = rounded(value, uncertainty)
    if math.isnan(uncertainty) or below_four_digits(value, uncertainty):
        return first
    return f"{first} {sign} {second}"


def micrometres(metres: float) -> str:
    """Return a length, m, as text in um with four digits; rounding errors become 0."""
    return f"{round(1e6 * metres, 9) + 0.0:.4g}"


def three(x: float, y: float, z: float) -> str:
    """Return three numbers as text with four digits each."""
    return f"{x:.4g}, {y:.4g}, {z:.4g}"


def time_taken(seconds: float) -> str:
    """Return a duration as text: in seconds, or in milliseconds below one second."""
    return f"{seconds:.3g} s" if seconds >= 1 else f"{1e3 * seconds:.3g} ms"
