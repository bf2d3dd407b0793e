"""Rotation by Euler parameters: R (A.2), L and L' (A.6-A.9), and their identities.

L is not typed in: it is read off the skew part of R^T R', which is the angular velocity in
the body frame.
"""

from __future__ import annotations

import sympy as sp

from .equations import Equation
from .symbols import ANGULAR_VELOCITY, EULER_PARAMETERS, EULER_RATES, vector

e = vector(EULER_PARAMETERS)
edot = vector(EULER_RATES)
omega = vector(ANGULAR_VELOCITY)

#: |e|^2, equal to 1 on the constraint (A.4)
norm_squared = (e.T * e)[0]


def cross_matrix(a: sp.Matrix) -> sp.Matrix:
    """The matrix [a]x with [a]x b = a x b."""
    return sp.Matrix([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])


def rotation_matrix(e: sp.Matrix) -> sp.Matrix:
    """R (A.2): body components to inertial components, for any e that is not 0.

    With e = (e0, eps): |e|^2 R = (e0^2 - eps.eps) 1 + 2 eps eps^T + 2 e0 [eps]x.
    """
    scalar, eps = e[0], e[1:, :]
    numerator = (
        (scalar**2 - (eps.T * eps)[0]) * sp.eye(3)
        + 2 * eps * eps.T
        + 2 * scalar * cross_matrix(eps)
    )
    return numerator.applyfunc(sp.expand) / (e.T * e)[0]


R = rotation_matrix(e)


def along(expression: sp.MatrixBase, variables: sp.Matrix, rates: sp.Matrix) -> sp.MatrixBase:
    """Return the rate of change of `expression` when `variables` change at `rates` (chain rule)."""
    total = sp.zeros(*expression.shape)
    for variable, rate in zip(variables, rates, strict=True):
        total += expression.diff(variable) * rate
    return total


def angular_velocity_from_rotation() -> sp.Matrix:
    """Return omega |e|^2 (A.6), body frame, from the skew part of R^T R', for e of any length.

    The factor |e|^2 clears the only denominator, so the result is bilinear in e and e'.
    """
    spin = R.T * along(R, e, edot)
    skew = (spin - spin.T) / 2
    axial = sp.Matrix([skew[2, 1], skew[0, 2], skew[1, 0]])
    return (axial * norm_squared).applyfunc(lambda entry: sp.expand(sp.cancel(entry)))


#: L (A.7): omega |e|^2 = L e', read off as the coefficients of e'
L = angular_velocity_from_rotation().jacobian(edot)
#: L' (A.9)
Ldot = along(L, e, edot)

#: e' from omega: the solution of omega |e|^2 = L e' with e.e' = 0 (A.22), by L L^T = 4 |e|^2 1
euler_rates_from_omega = L.T * omega / 4

#: e/|e| and the part of e' orthogonal to e, which satisfy (A.21) and (A.22). They replace (A.26),
#: which divides by e0.
unit_euler_parameters = e / sp.sqrt(norm_squared)
tangent_euler_rates = edot - e * (e.T * edot)[0] / norm_squared

ROTATION = Equation("A.2", "rotation matrix", r"{}^N_A R", R)
ANGULAR_VELOCITY_EQUATION = Equation("A.7", "angular velocity, body frame", r"L", L)
ANGULAR_ACCELERATION = Equation("A.9", "rate of L", r"\dot{L}", Ldot)
L_TIMES_E = Equation("-", "e is in the kernel of L", r"L e", (L * e).applyfunc(sp.expand))
L_L_TRANSPOSED = Equation(
    "-", "the rows of L are orthogonal", r"L L^T", (L * L.T).applyfunc(sp.expand)
)
LDOT_EDOT = Equation("-", "L' e' vanishes", r"\dot{L}\dot{e}", (Ldot * edot).applyfunc(sp.expand))
EULER_RATES_EQUATION = Equation(
    "-", "rates of the Euler parameters", r"\dot{e}", euler_rates_from_omega
)
