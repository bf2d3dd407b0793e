"""The weights of uniform splines proven: smoothness at the knots, polynomials, symmetry, area."""

import numpy as np
import sympy as sp
from scipy.interpolate import BSpline

from derivation.equations import is_zero
from derivation.spline import DEGREE, SPLINE_WEIGHTS, t
from tweezer.generated.spline import spline_weights

POWERS = sp.Matrix([t**k for k in range(DEGREE + 1)])
WEIGHTS = list(SPLINE_WEIGHTS.T * POWERS)


def test_six_derivatives_are_continuous_at_a_knot():
    """A coefficient's weight in an interval continues as the weight before it in the next one."""
    for order in range(DEGREE):
        ends = [sp.diff(each, t, order).subs(t, 1) for each in WEIGHTS]
        begins = [sp.diff(each, t, order).subs(t, 0) for each in WEIGHTS]
        assert ends[0] == begins[-1] == 0
        assert ends[1:] == begins[:-1]


def test_seventh_derivative_is_not_continuous():
    ends, begins = (sp.Matrix([sp.diff(w, t, DEGREE) for w in part]).subs(t, 0)
                    for part in (WEIGHTS[1:], WEIGHTS[:-1]))  # fmt: skip
    assert not is_zero(ends - begins)


def test_polynomials_up_to_degree_seven_are_splines():
    """Marsden: (x - t)^7 has the coefficients (x - k - 1)...(x - k - 7), first knot k."""
    x = sp.Symbol("x")
    total = 0
    for i, weight in enumerate(WEIGHTS):
        first = i - DEGREE
        total += weight * sp.prod([x - (first + j) for j in range(1, DEGREE + 1)])
    assert is_zero(total - (x - t) ** DEGREE)


def test_weights_are_mirrored_and_their_area_is_one():
    for weight, mirrored in zip(WEIGHTS, WEIGHTS[::-1], strict=True):
        assert is_zero(weight - mirrored.subs(t, 1 - t))
    assert sum(sp.integrate(each, (t, 0, 1)) for each in WEIGHTS) == 1


def test_emitted_weights_are_those_of_scipy():
    emitted = np.zeros((8, 8))
    spline_weights(emitted)
    places = np.linspace(0, 1, 11, endpoint=False)
    found = np.vander(places, 8, increasing=True) @ emitted
    basis = BSpline.basis_element(np.arange(9.0), extrapolate=False)
    expected = np.nan_to_num(basis(places[:, None] + np.arange(7, -1, -1)))
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-15)
