"""Motion of a rigid body of any shape: Kirchhoff's equations and their expansion to first order.

The twist V = (u, w) contains the velocity u of the centre of mass and the angular velocity w, both
in body components. The wrench W = (F, M) contains the force and the moment about the centre of
mass. In the axes of the body, inertia M and drag R are constant symmetric 6x6 matrices, which may
couple translation and rotation:

    M V' + N(V) = W - R V,    q' = R(e) u,    e' = L^T w/4.

N follows from the rates of the momenta (p, l) = M V, because the axes turn and the centre of mass
moves: N = (w x p, w x l + u x p). The last term vanishes for a body without the added mass of
the fluid (Kirchhoff).

The small parameter epsilon multiplies M, as in `derivation.multiscale`.

Thermal motion without inertia has the generator D_ab X_a X_b with D = kT B and the six fields X_a
of steady twists. Two results about it are used at run time without being emitted: the constant
mobility in the body frame requires no drift (`divergence` is 0), and `free_step_correction`.
"""

from __future__ import annotations

import functools
import itertools
from collections import Counter
from collections.abc import Mapping

import sympy as sp

from .equations import Equation
from .euler_parameters import L, R, e, omega
from .multiscale import T0, T1, Fdot, Mdot, epsilon, time_derivative
from .rigid_body import F_others, M_others, v
from .symbols import (
    BODY_DRAG,
    BODY_INERTIA,
    BODY_INVERSE_INERTIA,
    BODY_MOBILITY,
    FORCE,
    MOMENT,
    POSITION,
    TWIST,
    Quantity,
    vector,
)


def symmetric(entries: tuple[Quantity, ...]) -> sp.Matrix:
    """Return the symmetric 6x6 matrix of the upper triangle of `entries`, given row by row."""
    return sp.Matrix(6, 6, lambda i, j: entries[6 * min(i, j) + max(i, j)].symbol)


M, R6 = symmetric(BODY_INERTIA), symmetric(BODY_DRAG)
#: inverse matrices, with symbols of their own
H, B = symmetric(BODY_INVERSE_INERTIA), symmetric(BODY_MOBILITY)
V = vector(TWIST)


def momentum_rate(twist: sp.MatrixBase, momentum: sp.MatrixBase) -> sp.Matrix:
    """Return the rate of constant body components of the momenta (p, l), body frame.

    Parameters
    ----------
    twist : sympy.Matrix
        (u, w), the motion of the axes.
    momentum : sympy.Matrix
        (p, l), with l about the centre of mass.

    Returns
    -------
    sympy.Matrix
        (w x p, w x l + u x p), the rates of momentum and of angular momentum.
    """
    u, w = twist[:3, :], twist[3:, :]
    p, l = momentum[:3, :], momentum[3:, :]
    return w.cross(p).col_join(w.cross(l) + u.cross(p))


def kirchhoff(twist: sp.MatrixBase, inertia: sp.MatrixBase) -> sp.Matrix:
    """Return N(V), the inertial forces and moments of a steady twist."""
    return momentum_rate(twist, inertia * twist)


#: force and moment other than drag, body frame
W = (R.T * F_others).col_join(M_others)

# --- with inertia --------------------------------------------------------------------------------
#: twist of the state (v, omega)
twist = (R.T * v).col_join(omega)
twist_rate = H * (W - R6 * twist - kirchhoff(twist, M))
#: v' of v = R u, with R' = R [w]x
acceleration = R * (twist_rate[:3, :] + omega.cross(twist[:3, :]))
angular_acceleration = twist_rate[3:, :]


# --- the orders of epsilon -----------------------------------------------------------------------
def _over_scales(name: str) -> sp.Matrix:
    return sp.Matrix([sp.Function(f"{name}{i}")(T0, T1) for i in range(1, 7)])


#: V = V_0 + epsilon V_1, and the wrench along the motion
V_0, V_1, W_along = map(_over_scales, ("V_0", "V_1", "W_"))


def orders() -> tuple[sp.Matrix, sp.Matrix]:
    """Return the coefficients of epsilon^0 and epsilon^1 in epsilon (M V' + N(V)) + R V - W."""
    expanded = V_0 + epsilon * V_1
    rate = expanded.applyfunc(time_derivative)
    balance = epsilon * (M * rate + kirchhoff(expanded, M)) + R6 * expanded - W_along
    leading, first = (
        balance.applyfunc(lambda entry, n=n: sp.expand(entry).coeff(epsilon, n)) for n in (0, 1)
    )
    return leading, first


#: order epsilon^0: R V_0 = W
slow_twist = B * W


def wrench_rate(
    turning: sp.MatrixBase, wrench: sp.MatrixBase, force: sp.MatrixBase, moment: sp.MatrixBase
) -> sp.Matrix:
    """Return W', body frame.

    Parameters
    ----------
    turning : sympy.Matrix
        Angular velocity w of the axes, in which the wrench changes by -w x W.
    wrench : sympy.Matrix
        W, body frame.
    force, moment : sympy.Matrix
        Rates of the force and the moment, inertial frame.
    """
    turned = turning.cross(wrench[:3, :]).col_join(turning.cross(wrench[3:, :]))
    return (R.T * force).col_join(R.T * moment) - turned


slow_wrench_rate = wrench_rate(slow_twist[3:, :], W, Fdot, Mdot)
#: order epsilon^1: R V_1 = -(M dV_0/dT0 + N(V_0)), the inertial forces and moments
inertial_wrench = -(M * (B * slow_wrench_rate) + kirchhoff(slow_twist, M))
first_order_twist = slow_twist + B * inertial_wrench
#: the light's force and moment with the inertial ones added, inertial frame. A body without
#: inertia under this wrench moves by `first_order_twist`
equivalent_wrench = (vector(FORCE) + R * inertial_wrench[:3, :]).col_join(
    vector(MOMENT) + R * inertial_wrench[3:, :]
)
#: body-frame displacement between the release and the start of the slow motion. In the initial
#: layer M V' = W - R V with a constant W: the integral of V - V_0 is B M (V(0) - V_0)
matched_displacement = B * (M * (twist - slow_twist))


# --- thermal motion ------------------------------------------------------------------------------
#: coordinates of a pose
pose = vector(POSITION).col_join(e)
#: rates of the coordinates by a unit of each component of the twist: the fields X_a, as columns
FIELDS = sp.diag(R, L.T / 4)


def ito_drift(mobility: sp.MatrixBase) -> sp.Matrix:
    """Return the drift of the coordinates over kT, in Ito's sense, without a wrench.

    B_ab X_a X_b differentiates the coordinates twice and, with this drift, once.
    """
    drift = sp.zeros(7, 1)
    for b in range(6):
        drift += FIELDS[:, b].jacobian(pose) * (FIELDS * mobility[:, b])
    return drift


def divergence(field: sp.MatrixBase) -> sp.Expr:
    """Return the divergence of a field of the coordinates that does not change |e|."""
    return field.jacobian(pose).trace()


def bracket(a: int, b: int) -> Mapping[int, int]:
    """Return [X_a, X_b] = f_abc X_c as {c: f_abc}; components 0-2 translate, 3-5 rotate."""
    translations = (a < 3) + (b < 3)
    if translations == 2:
        return {}
    factors = {c: int(sp.LeviCivita(a % 3, b % 3, c)) for c in range(3)}
    return {c + 3 * (translations == 0): factor for c, factor in factors.items() if factor}


@functools.cache
def ordered(word: tuple[int, ...]) -> Mapping[tuple[int, ...], int]:
    """Return the product X_a X_b ... of a word (a, b, ...) as a sum of ascending words."""
    for at, (a, b) in enumerate(itertools.pairwise(word)):
        if a > b:
            before, after = word[:at], word[at + 2 :]
            total = Counter(ordered((*before, b, a, *after)))
            for c, factor in bracket(a, b).items():
                for each, times in ordered((*before, c, *after)).items():
                    total[each] += factor * times
            return total
    return {word: 1}


def step_difference(mobility: sp.MatrixBase) -> Mapping[tuple[int, ...], sp.Expr]:
    """Return the terms of order (kT h)^2 by which a Gaussian step differs from free motion.

    The step g exp(xi) with the covariance 2 kT B h of xi has the terms of fourth order
    <(xi X)^4>/24, and free motion has (B_ab X_a X_b)^2/2. The result is their difference, by
    ascending words.
    """
    terms: dict[tuple[int, ...], list[sp.Expr]] = {}
    D = mobility
    for a, b, c, d in itertools.product(range(6), repeat=4):
        weight = (D[a, c] * D[b, d] + D[a, d] * D[b, c] - 2 * D[a, b] * D[c, d]) / 6
        if weight:
            for word, factor in ordered((a, b, c, d)).items():
                terms.setdefault(word, []).append(factor * weight)
    return {word: sp.expand(sp.Add(*each)) for word, each in terms.items()}


def free_step_correction(mobility: sp.MatrixBase) -> sp.Matrix:
    """Return C: the step xi of covariance 2 kT (B h + kT C h^2) is of weak order 2."""
    difference = step_difference(mobility)

    def entry(i: int, j: int) -> sp.Expr:
        pair = (min(i, j), max(i, j))
        return -difference.get(pair, sp.Integer(0)) / (1 if i == j else 2)

    return sp.Matrix(6, 6, entry)


MOMENTUM_RATE = Equation(
    "-", "inertial forces and moments of a steady twist", "N(V)", kirchhoff(V, M)
)
FIRST_ORDER_WRENCH = Equation(
    "-", "inertial forces and moments of the slow motion", "-(M B W' + N(V_0))", inertial_wrench
)
MATCHED_DISPLACEMENT = Equation(
    "-", "displacement to the matched start", "B M (V - V_0)", matched_displacement
)
