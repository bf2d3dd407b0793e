"""Uniform splines of degree 7: the weights of eight coefficients by Cox and de Boor's recurrence.

A spline with the knots 0, +-1, +-2, ... is a sum of coefficients c_i times B(x - i), where B is not
zero on 0 < x < 8. On the interval 0 <= t < 1 it is

    c_-7 w_0(t) + ... + c_0 w_7(t),   w_i(t) = sum_k W_ki t^k.

The recurrence from degree p - 1 to p, with knots at the whole numbers, is

    w_i^p(t) = (t - k)/p w_(i-1)^(p-1)(t) + (k + p + 1 - t)/p w_i^(p-1)(t),   k = i - p.
"""

from __future__ import annotations

import sympy as sp

DEGREE = 7
#: place in the interval between two knots, from 0 to 1
t = sp.Symbol("t", real=True)


def weights(degree: int) -> list[sp.Expr]:
    """Return the B-splines of a degree on the interval 0 <= t < 1, from the lowest knot up."""
    if degree == 0:
        return [sp.Integer(1)]
    lower = [sp.Integer(0), *weights(degree - 1), sp.Integer(0)]
    found = []
    for i in range(degree + 1):
        first = i - degree
        rising, falling = (t - first) / degree, (first + degree + 1 - t) / degree
        found.append(sp.expand(rising * lower[i] + falling * lower[i + 1]))
    return found


#: W, with exact fractions: row k contains the coefficients of t^k of the eight weights
SPLINE_WEIGHTS = sp.Matrix(
    DEGREE + 1, DEGREE + 1, lambda k, i: sp.Poly(weights(DEGREE)[i], t).coeff_monomial(t**k)
)
