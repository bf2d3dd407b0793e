"""Zeros and maxima of functions of one number, against SciPy and in closed form."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from tweezer.values.bracketing import maximum, zero

EPSILON = np.finfo(float).eps
#: functions with one change of sign, and the interval on which it lies
CHANGING = {
    "line": (lambda x: 3 * x - 1, -2.0, 5.0),
    "cosine": (lambda x: math.cos(x) - x, 0.0, 1.0),
    "triple zero": (lambda x: (x - 0.3) ** 3, -1.0, 1.0),
    "flat": (lambda x: x**9, -1.0, 0.7),
    "pole": (lambda x: 1 / (x - 1 / 3), 0.0, 1.0),
    "jump": (lambda x: math.copysign(1.0, x - 0.7123), 0.0, 1.0),
    "jumps and slopes": (lambda x: math.floor(8 * x) - 4.5 + 0.1 * x, 0.0, 1.0),
    "far": (lambda x: math.expm1(x - 1e3), 0.0, 1.01e3),
    "almost zero at the start": (lambda x: 1e-300 if x == 0 else -x, 0.0, 1.0),
    "tiny": (lambda x: 1e-200 * (math.exp(x) - 2), 0.0, 3.0),
    "tinier": (lambda x: 1e-290 * (math.exp(x) - 2), 0.0, 3.0),
}


def counted(function):
    """The function, and the list of places at which it was evaluated."""
    places = []

    def counting(x):
        places.append(x)
        return function(x)

    return counting, places


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("tolerance", [1e-3, 1e-14])
@pytest.mark.parametrize(("function", "low", "high"), CHANGING.values(), ids=CHANGING)
def test_zero_is_that_of_scipy(function, low, high, tolerance, sign):
    changing, places = counted(lambda x: sign * function(x))
    found = zero(changing, low, high, tolerance)
    asked = {"rtol": 4 * EPSILON, "maxiter": 1000}  # a ninefold zero takes 140
    known = brentq(function, low, high, xtol=1e-15, **asked)
    assert abs(found - known) <= tolerance + 1e-15 + 8 * EPSILON * abs(known)
    _, told = brentq(function, low, high, xtol=tolerance, full_output=True, **asked)
    assert len(places) <= 1.2 * told.function_calls + 2


@pytest.mark.parametrize(("low", "high"), [(0.0, 1.0), (-1.0, 0.0)])
def test_zero_at_an_end_is_found(low, high):
    assert zero(lambda x: x, low, high, 1e-9) == 0.0


def test_zero_needs_a_change_of_sign():
    with pytest.raises(ValueError, match="same sign at 1 and 2"):
        zero(lambda x: x, 1, 2, 1e-9)


@pytest.mark.parametrize("undefined", [0.0, 0.5, 1.0])
def test_zero_refuses_a_function_that_is_not_a_number(undefined):
    """At an end, or within; the first place within is the middle by symmetry."""
    with pytest.raises(ValueError, match="NaN"):
        zero(lambda x: math.nan if x == undefined else x - 0.5, 0.0, 1.0, 1e-9)


@pytest.mark.parametrize("place", [-1.0, -0.99, 0.123456, 0.7, 2.0])
@pytest.mark.parametrize("tolerance", [1e-2, 1e-7])
def test_maximum_is_located(place, tolerance):
    """The function is not symmetric, and its maximum may be at an end of the interval."""

    def function(x):
        return 3 - np.abs(x - place) ** 1.5 * (1 + 0.3 * np.sign(x - place))

    value, at = maximum(function, -1.0, 2.0, tolerance)
    assert abs(at - place) <= tolerance
    assert value == function(at)
