"""Zeros and maxima on an interval.

`scipy.optimize` has both, but importing it takes a third of the time of a short command.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from tweezer.values.arrays import Array

#: Smallest relative error of a position
_ROUNDING = 4 * np.finfo(float).eps
#: Number of positions at which a function is evaluated together
_TOGETHER = 17


def zero(function: Callable[[float], float], low: float, high: float, tolerance: float) -> float:
    """Return a position at which a function changes sign, by Brent's method.

    Parameters
    ----------
    function : callable
        Function of one number. It may jump.
    low, high : float
        Ends of an interval on which the sign of the function changes.
    tolerance : float
        Largest error of the position. Four units in its last place are added.

    Returns
    -------
    float
        The position: an end of the interval if the function is zero there.

    Raises
    ------
    ValueError
        If the sign is the same at both ends, or the function is NaN where it is evaluated.

    References
    ----------
    Brent, Algorithms for Minimization without Derivatives (1973), chapter 4.
    """

    def at(place: float) -> float:
        """Return the value of the function at `place`, or raise `ValueError` for NaN."""
        if math.isnan(value := function(place)):
            raise ValueError(f"the function is NaN at {place}")
        return value

    before, here = low, high
    f_before, f_here = at(before), at(here)
    if f_before == 0 or f_here == 0:
        return before if f_before == 0 else here
    if (f_before > 0) == (f_here > 0):
        raise ValueError(f"the function has the same sign at {low} and {high}")
    other, f_other, step, last_step = before, f_before, here - before, here - before
    while True:
        if (f_before > 0) != (f_here > 0):
            other, f_other, step, last_step = before, f_before, here - before, here - before
        if abs(f_other) < abs(f_here):
            before, here, other = here, other, here
            f_before, f_here, f_other = f_here, f_other, f_here
        shortest, bisecting = (tolerance + _ROUNDING * abs(here)) / 2, (other - here) / 2
        if f_here == 0 or abs(bisecting) < shortest:
            return here
        tried = math.inf
        if abs(last_step) > shortest and abs(f_here) < abs(f_before):
            # s, q and r are ratios of function values at the last three positions
            s = f_here / f_before
            if before == other:  # two positions: the secant
                tried = 2 * bisecting * s / (s - 1)
            else:  # inverse quadratic interpolation
                q, r = f_before / f_other, f_here / f_other
                tried = s * (2 * bisecting * q * (q - r) - (here - before) * (r - 1))
                tried /= (1 - q) * (r - 1) * (s - 1)
        if 2 * abs(tried) < min(abs(last_step), 3 * abs(bisecting) - shortest):
            last_step, step = step, tried
        else:
            last_step = step = bisecting
        before, f_before = here, f_here
        here += step if abs(step) > shortest else math.copysign(shortest, bisecting)
        f_here = at(here)


def maximum(
    function: Callable[[Array], Array], low: float, high: float, tolerance: float
) -> tuple[float, float]:
    """Return the largest value of a function on an interval, and its position.

    The function is sampled at 17 positions together. The interval shrinks to the neighbours of the
    largest sample, until they are less than `tolerance` apart.

    Parameters
    ----------
    function : callable
        Function of an array of positions, shape (n,), with one maximum on the interval.
    low, high : float
        Ends of the interval.
    tolerance : float
        Largest error of the position.

    Returns
    -------
    value : float
        Largest sample of the function.
    place : float
        Position of that sample.
    """
    while True:
        places = np.linspace(low, high, _TOGETHER)
        values = function(places)
        best = int(values.argmax())
        low, high = places[max(best - 1, 0)], places[min(best + 1, _TOGETHER - 1)]
        if high - low <= tolerance:
            return float(values[best]), float(places[best])
