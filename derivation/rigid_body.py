"""Newton-Euler equations of the bead with the constraint rows, (A.10)-(A.25).

`A` is the body with any diagonal inertia; the sphere of the thesis is the case I1 = I2 = I3,
for which K vanishes.
"""

from __future__ import annotations

import sympy as sp

from .equations import Equation
from .euler_parameters import L, Ldot, R, e, edot, norm_squared, omega
from .symbols import (
    DRAG,
    FORCE,
    INERTIA,
    MASS,
    MOMENT,
    ROTATIONAL_DRAG,
    SPHERE_INERTIA,
    VELOCITY,
    WEIGHT,
    vector,
)

m, beta_v, beta_w = MASS.symbol, DRAG.symbol, ROTATIONAL_DRAG.symbol
v = vector(VELOCITY)

#: I_AA, principal moments along the body axes
I_AA = sp.diag(*vector(INERTIA))
#: the inertia of a sphere
I_sphere = SPHERE_INERTIA.symbol * sp.eye(3)

#: sum of all forces but drag: light (3.26), gravity (2.11) and buoyancy (2.12)
F_others = vector(FORCE) + vector(WEIGHT)
#: sum of all moments but drag, in the body frame (A.19): the light's, turned by R^T
M_others = R.T * vector(MOMENT)

#: e'' as unknowns
eddot = sp.Matrix(sp.symbols("eddot0:4", real=True))
#: any moment about the centre, body frame, (A.13)
M_any = sp.Matrix(sp.symbols("M_A1:4", real=True))


def angular_momentum_rate(
    inertia: sp.MatrixBase, w: sp.MatrixBase, wdot: sp.MatrixBase
) -> sp.MatrixBase:
    """H' = I w' + w x (I w), (A.14)."""
    return inertia * wdot + w.cross(inertia * w)


def K(inertia: sp.MatrixBase) -> sp.Matrix:
    """K (A.17): the part of H' (A.16) that has no e''.

    Its first term I L' e' is zero by the identity L' e' = 0, so K = w x (I w) with w = L e'.
    """
    rate = angular_momentum_rate(inertia, L * edot, Ldot * edot + L * eddot)
    return rate.subs(dict.fromkeys(eddot, 0)).applyfunc(sp.factor_terms)


def reduced_K(inertia: sp.MatrixBase) -> sp.MatrixBase:
    """K with L' e' = 0 used and omega = L e' by name: w x (I w); zero for a sphere."""
    return omega.cross(inertia * omega).applyfunc(sp.expand)


def I_tilde(inertia: sp.MatrixBase) -> sp.Matrix:
    """I-tilde (A.24): I L with the constraint row e^T below it."""
    return (inertia * L).col_join(e.T)


def M_tilde(inertia: sp.MatrixBase, moment: sp.MatrixBase) -> sp.Matrix:
    """M-tilde (A.24): M - K with the acceleration constraint (A.23) below it."""
    return (moment - K(inertia)).col_join(-edot.T * edot)


def euler_acceleration(
    inertia: sp.MatrixBase, moment: sp.MatrixBase, gyroscopic: sp.MatrixBase
) -> sp.Matrix:
    """e'' solved from (A.24) in closed form, for e of any length but 0.

    e'' = L^T I^-1 (M - K)/(4 |e|^2) - e (e'.e')/|e|^2, because L L^T = 4 |e|^2 1 and L e = 0:
    no linear solve, no pivoting.
    """
    turning = L.T * (inertia.inv() * (moment - gyroscopic)) / (4 * norm_squared)
    return turning - e * (edot.T * edot)[0] / norm_squared


def angular_acceleration(inertia: sp.MatrixBase, moment: sp.MatrixBase) -> sp.Matrix:
    """w' = I^-1 (M - w x I w) in the body frame: (A.14) for the state (e, omega).

    Follows from e'' above by w' = L e'' + L' e', as L' e' = 0.
    """
    return inertia.inv() * (moment - omega.cross(inertia * omega))


#: drag on the centre (2.13)
drag_force = -beta_v * v
#: drag on the rotation (2.14)
drag_moment = -beta_w * omega

#: translational acceleration (A.12)
acceleration = (F_others + drag_force) / m

GYROSCOPIC = Equation("A.17", "gyroscopic moment", r"\mathbf{K}", K(I_AA))
GYROSCOPIC_SPHERE = Equation(
    "A.17", "for a sphere K vanishes", r"\mathbf{K}_{\mathrm{sphere}}",
    K(I_sphere).applyfunc(sp.expand),
)  # fmt: skip
I_TILDE = Equation("A.24", "inertia with the constraint row", r"\tilde{I}", I_tilde(I_AA))
M_TILDE = Equation(
    "A.24", "moments with the constraint row", r"\tilde{\mathbf{M}}", M_tilde(I_AA, M_any)
)
EULER_ACCELERATION = Equation(
    "-", "(A.24) solved", r"\ddot{e}", euler_acceleration(I_AA, M_any, K(I_AA))
)
ANGULAR_ACCELERATION_EQUATION = Equation(
    "A.14", "Euler's equations", r"{}^N\dot{\omega}^A", angular_acceleration(I_AA, M_any)
)
ACCELERATION = Equation("A.12", "Newton's equation", r"\ddot{\mathbf{q}}", acceleration)


def constraint_rows() -> tuple[Equation, Equation, Equation]:
    """(A.21), and its first and second derivative (A.22), (A.23), by differentiating in time."""
    t = sp.Symbol("t", real=True)
    path = sp.Matrix([sp.Function(f"e{i}")(t) for i in range(4)])
    position = (path.T * path)[0] - 1
    rate = sp.expand(position.diff(t) / 2)
    acceleration_level = sp.expand(rate.diff(t))
    plain: dict[sp.Basic, sp.Symbol] = {}
    for i in range(4):
        plain[path[i].diff(t, 2)] = eddot[i]
        plain[path[i].diff(t)] = edot[i]
        plain[path[i]] = e[i]
    # highest derivatives first, or the lower ones would be replaced inside them
    levels = [expression.subs(plain) for expression in (position, rate, acceleration_level)]
    names = (
        ("A.21", "normality", r"0"),
        ("A.22", "normality, velocity level", r"0"),
        ("A.23", "normality, acceleration level", r"0"),
    )
    return tuple(
        Equation(number, title, lhs, level)
        for (number, title, lhs), level in zip(names, levels, strict=True)
    )  # type: ignore[return-value]


NORMALITY, NORMALITY_RATE, NORMALITY_ACCELERATION = constraint_rows()
