"""Exact motion of velocity modes, which relax to a slow velocity that is a polynomial of time.

The velocity of the bead is a sum of modes, v = sum a_i v_i with sum a_i = 1. Each mode relaxes by
v_i' = (u - v_i)/tau_i to u = F/beta, so the bead follows u with a memory. One mode with tau =
m/beta is the linear drag; a mode of tau = 0 has no inertia. In a step from s = 0 to h let u = sum_m
U_m (s/h)^m/m!. Then

    v_i(s) = (1 - chi_0) v_i + sum_m U_m (s/h)^m chi_m,
    x(s) - x = sum_i a_i [tau_i chi_0 v_i + s sum_m U_m (s/h)^m chi_(m+1)],    chi = chi(-s/tau_i),

with chi_m(z) = 1/m! - phi_m(z) and phi_m the functions of exponential integrators (M. Hochbruck,
A. Ostermann, Acta Numerica 19, 209 (2010)): phi_0 = exp, phi_(m+1) = (phi_m - 1/m!)/z.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.polynomial import legendre, polynomial

from tweezer.compiled import named_njit
from tweezer.compiled.lanes import LANES

#: Number of Gauss nodes in a step, and of coefficients of a polynomial
NODES = LANES
#: 1/m!
INVERSE = np.array([1.0 / math.factorial(m) for m in range(40)])
#: Time over the relaxation time above which the functions are computed upwards from the exponential
LONG = 4.0
#: Time over the relaxation time above which the exponential is below rounding
_GONE = 45.0
#: Number of terms of the series of the last function
_TERMS = 24

_points, _weights = legendre.leggauss(NODES)
#: Gauss nodes of a step, as fractions of it
PLACES = 0.5 + 0.5 * _points
#: Legendre coefficients of a polynomial on the step by its values at the nodes, (node, coefficient)
TO_LEGENDRE = np.array([
    [(k + 0.5) * w * legendre.legval(x, [0.0] * k + [1.0]) for k in range(NODES)]
    for x, w in zip(_points, _weights, strict=True)
])  # fmt: skip
#: The U_m of Legendre polynomials P_k on a step, P_k = sum_m U_m (s/h)^m/m!: (k, m)
TO_POWERS = np.zeros((NODES, NODES))
for _k in range(NODES):
    _powers = legendre.leg2poly([0.0] * _k + [1.0])
    _shifted = np.zeros(1)
    for _m in reversed(range(_k + 1)):  # of 2 c - 1
        _shifted = polynomial.polyadd(polynomial.polymul(_shifted, [-1.0, 2.0]), [_powers[_m]])
    TO_POWERS[_k, : _k + 1] = _shifted[: _k + 1] / INVERSE[: _k + 1]


@named_njit(inner=True, error_model="numpy")
def followed(s, tau):  # type: ignore[no-untyped-def]
    """Return chi_0 = 1 - exp(-s/tau), the fraction of a velocity change that is complete.

    A mode of relaxation time `tau`, s, approaches the slow velocity u (force over drag); after a
    time `s`, s, this fraction of the initial difference is gone. 1 for tau = 0.
    """
    return 1.0 if s > _GONE * tau else -math.expm1(-s / tau)


@named_njit(inner=True, error_model="numpy")
def relaxed(s, tau, chi):  # type: ignore[no-untyped-def]
    """Fill `chi` (NODES + 1,) with the weights that give the displacement of a relaxing mode.

    `displacement` multiplies them by the initial velocity and by the powers of time in the slow
    velocity. They are the functions chi_0 to chi_NODES at z = -s/tau,

        chi_m(z) = 1/m! - phi_m(z), with phi_0 = exp and phi_(m+1) = (phi_m - 1/m!)/z.

    `s` is the time since the beginning of the step (s) and `tau` the relaxation time of the mode
    (s). For s > LONG tau the recursion runs upwards from the exponential. For shorter times it
    would lose digits by cancellation, so the last function is summed as a series and the recursion
    runs downwards.
    """
    if s > LONG * tau:
        per = -tau / s
        chi[0] = followed(s, tau)
        for m in range(NODES):
            chi[m + 1] = INVERSE[m + 1] + chi[m] * per
        return
    # this branch also covers tau = 0 at s = 0, where the functions have their values at z = 0
    z = -s / tau if tau > 0.0 else 0.0
    value = 0.0
    for n in range(_TERMS - 1, -1, -1):
        value = value * z + INVERSE[n + NODES + 1]
    chi[NODES] = -z * value
    for m in range(NODES - 1, -1, -1):
        chi[m] = z * (chi[m + 1] - INVERSE[m + 1])
    if tau == 0.0:
        chi[0] = 1.0


@named_njit(inner=True, error_model="numpy")
def displacement(s, part, tau, weight, v, powers, chi):  # type: ignore[no-untyped-def]
    """Return the displacement of the bead by one velocity mode since a step began, m or rad.

    The mode v' = (u - v)/tau follows the slow velocity u (force over drag), which in a step of
    length h is u = sum_m U_m (s/h)^m/m!. Here `s` is the time since the beginning (s), and `part`
    is s/h. `tau` is the relaxation time of the mode (s), `weight` its share of the bead's velocity,
    and `v` its velocity at the beginning (m/s or rad/s). `powers` (NODES,) are the U_m, and `chi`
    (NODES + 1,) is filled by `relaxed(s, tau, chi)`.
    """
    total, power = 0.0, 1.0
    for m in range(NODES):
        total += powers[m] * power * chi[m + 1]
        power *= part
    return weight * (tau * chi[0] * v + s * total)


@named_njit(inner=True, error_model="numpy")
def velocity(part, v, powers, chi):  # type: ignore[no-untyped-def]
    """Return the velocity of one mode within a step, m/s or rad/s, without its weight.

    The mode v' = (u - v)/tau follows the slow velocity u = sum_m U_m (s/h)^m/m! in a step of length
    h. `part` is s/h at the time s since the beginning, when the velocity was `v`. `powers` (NODES,)
    are the U_m, and `chi` (NODES + 1,) is filled by `relaxed(s, tau, chi)`.
    """
    total, power = 0.0, 1.0
    for m in range(NODES):
        total += powers[m] * power * chi[m]
        power *= part
    return (1.0 - chi[0]) * v + total
