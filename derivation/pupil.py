"""Zernike polynomials over the pupil, from their orthogonality.

The radial polynomials of an azimuthal order m are rho^m times polynomials in rho^2. They are
orthogonal over the pupil, with the weight rho d(rho). The norm is chosen so that the term
N R_n^m cos(m phi), or N R_n^m for m = 0, has a root mean square of 1 over the pupil, and so that it
is positive at the rim.
"""

from __future__ import annotations

import functools

import sympy as sp

from .equations import Equation

rho = sp.Symbol("rho", nonnegative=True)


def mean(a: sp.Expr, b: sp.Expr, m: int) -> sp.Expr:
    """Return the mean of a b cos^2(m phi) over the pupil of radius 1."""
    around = sp.Integer(1) if m == 0 else sp.Rational(1, 2)
    return around * sp.integrate(sp.expand(2 * a * b * rho), (rho, 0, 1))


@functools.cache
def radial(n: int, m: int) -> sp.Expr:
    """Return N R_n^m(rho), n >= m >= 0 with n - m even, by Gram and Schmidt from rho^n."""
    found: sp.Expr = rho**n
    for lower in range(m, n, 2):
        term = radial(lower, m)
        found -= mean(rho**n, term, m) * term
    return sp.expand(found / sp.sqrt(mean(found, found, m)))


ZERNIKE = Equation("-", "spherical aberration", r"N R_4^0", radial(4, 0))
