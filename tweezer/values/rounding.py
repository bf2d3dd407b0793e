"""Numbers as text, with as many digits as their uncertainty leaves."""

from __future__ import annotations

import math
from collections.abc import Callable

#: Sizes between which a number is written without a power of ten.
_PLAIN = (1e-6, 1e7)


def rounded(value: float, uncertainty: float) -> tuple[str, str]:
    """Return a value and its uncertainty as text, with two digits of the uncertainty.

    The value is rounded to the same decimal place.
    """
    if not 0 < uncertainty < math.inf or not math.isfinite(value):
        return f"{value:.4g}", f"{uncertainty:.2g}"
    # power of ten of the last digit, by formatting, which rounds 9.96 to two digits first
    last = int(f"{uncertainty:.1e}".partition("e")[2]) - 1
    size = max(abs(value), uncertainty)
    if not _PLAIN[0] <= size < _PLAIN[1]:
        power = math.floor(math.log10(size))
        parts = (f"{x / 10.0**power:z.{max(power - last, 0)}f}" for x in (value, uncertainty))
        first, second = (f"{part}e{power}" for part in parts)
        return first, second
    if last > 0:
        first, second = (f"{round(x, -last):z.0f}" for x in (value, uncertainty))
        return first, second
    return f"{value:z.{-last}f}", f"{uncertainty:z.{-last}f}"


def least(value: float, digits: int = 3) -> str:
    """Return a lower bound as text, rounded up, so that the number as written is allowed.

    Bounds hold to 1 part in 1e9, as numbers that are rounded to the last bit do.
    """
    return _towards(math.ceil, value, digits)


def most(value: float, digits: int = 3) -> str:
    """Return an upper bound as text, rounded down, so that the number as written is allowed."""
    return _towards(math.floor, value, digits)


def _towards(rounding: Callable[[float], int], value: float, digits: int) -> str:
    """Return a number as text with so many digits, rounded by `rounding`: `math.ceil` or
    `math.floor`.
    """
    text = f"{value:.{digits}g}"
    if not math.isfinite(value) or math.isclose(float(text), value, rel_tol=1e-12):
        return text
    power = math.floor(math.log10(abs(value))) - digits + 1
    return f"{rounding(value / 10.0**power) * 10.0**power:.{digits}g}"


def with_uncertainty(value: float, uncertainty: float, sign: str = "+-") -> str:
    """Return text such as "50.35 +- 0.49"; the value alone if the uncertainty is NaN."""
    if math.isnan(uncertainty):
        return f"{value:.4g}"
    first, second = rounded(value, uncertainty)
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
