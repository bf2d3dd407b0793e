"""Zernike polynomials and reflected amplitudes, from what defines them."""

import math

import mpmath as mp
import numpy as np
import pytest
import sympy as sp

from derivation import pupil, waves
from tweezer.optics.waves.pupil import zernike_radial

TERMS = [(n, m) for n in range(9) for m in range(n % 2, n + 1, 2)]


@pytest.mark.parametrize(("n", "m"), TERMS)
def test_runtime_polynomials_are_the_orthogonal_ones(n, m):
    rho = np.linspace(0, 1, 12)
    expected = np.array([float(pupil.radial(n, m).subs(pupil.rho, each)) for each in rho])
    np.testing.assert_allclose(zernike_radial(n, m, rho), expected, rtol=0, atol=1e-12)


def test_polynomials_at_the_rim_are_their_norm():
    """R_n^m(1) = 1, so that N R_n^m(1) = sqrt((n + 1) (2 - delta_m0))."""
    for n, m in TERMS:
        norm = sp.sqrt((n + 1) * (1 if m == 0 else 2))
        assert sp.simplify(pupil.radial(n, m).subs(pupil.rho, 1) - norm) == 0


R_P, R_S = waves.REFLECTED_AMPLITUDES
N1, N2, COS1, COS2 = waves.n1, waves.n2, waves.cos1, waves.cos2


def test_reflected_and_transmitted_power_add_up_to_the_power():
    """|r|^2 + |t|^2 n2 cos2/(n1 cos1) = 1 for real angles, in both polarisations."""
    for r, t in ((R_P, waves.t_p), (R_S, waves.t_s)):
        assert sp.simplify(r**2 + t**2 * N2 * COS2 / (N1 * COS1) - 1) == 0


def test_limits_of_reflection():
    """A perfect mirror; no face; Brewster's angle; minus the reflection from the other side."""
    assert sp.limit(R_P, N2, sp.oo) == 1
    assert sp.limit(R_S, N2, sp.oo) == -1
    same = {N2: N1, COS2: COS1}
    assert sp.simplify(R_P.subs(same)) == sp.simplify(R_S.subs(same)) == 0
    angle = sp.atan(sp.Rational(3, 2))
    brewster = {N1: 1, N2: sp.Rational(3, 2), COS1: sp.cos(angle), COS2: sp.sin(angle)}
    assert sp.simplify(R_P.subs(brewster)) == 0
    other = {N1: N2, N2: N1, COS1: COS2, COS2: COS1}
    for r in (R_P, R_S):
        assert sp.simplify(r + r.subs(other, simultaneous=True)) == 0


def test_all_light_is_reflected_beyond_the_critical_angle():
    """cos2 = i q: both amplitudes are of the form (a - ib)/(a + ib)."""
    q = sp.Symbol("q", positive=True)
    values = {N1: sp.Rational(3, 2), N2: sp.Rational(4, 3), COS1: sp.Rational(1, 5)}
    for r in (R_P, R_S):
        beyond = r.subs({**values, COS2: sp.I * q})
        assert sp.simplify(beyond * sp.conjugate(beyond) - 1) == 0


def test_reflected_amplitudes_by_snell_are_those_of_fresnel():
    """Their difference vanishes with cos2 from Snell's law."""
    snell = sp.sqrt(1 - (N1 / N2) ** 2 * (1 - COS1**2))
    for r, other in zip((R_P, R_S), waves.REFLECTED_BY_SNELL, strict=True):
        assert sp.simplify((r - other).subs(COS2, snell)) == 0


def test_emitted_reflection_keeps_its_digits_for_nearly_equal_indices():
    from tweezer.generated import waves as emitted

    n1, n2, cos1 = 1.0, 1.0 + 2.0**-30, 0.5
    with mp.workdps(50):
        cos2 = mp.sqrt(1 - (mp.mpf(n1) / n2) ** 2 * (1 - mp.mpf(cos1) ** 2))
        expected = [
            float((n2 * cos1 - n1 * cos2) / (n2 * cos1 + n1 * cos2)),
            float((n1 * cos1 - n2 * cos2) / (n1 * cos1 + n2 * cos2)),
        ]
    found = emitted.reflect.py_func(cos1, float(cos2), n1, n2)
    assert found == pytest.approx(expected, rel=1e-14, abs=0.0)


def test_emitted_reflection_is_the_derived_one():
    from tweezer.generated import waves as emitted

    given = (0.7, math.sqrt(1 - (1.33 / 1.52) ** 2 * (1 - 0.7**2)), 1.33, 1.52)
    symbols = dict(zip((COS1, COS2, N1, N2), given, strict=True))
    expected = [float(each.subs(symbols)) for each in (R_P, R_S)]
    assert emitted.reflect.py_func(*given) == pytest.approx(expected, rel=1e-14)
