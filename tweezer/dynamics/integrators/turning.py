"""The orientation of a sphere whose angular velocity is known: Magnus' expansion.

|e| = 1 by construction. The first term, the angle turned, is exact; the commutators, to order 6 in
the part of a step, are by three Gauss nodes (S. Blanes, F. Casas, J. A. Oteo, J. Ros, Physics
Reports 470, 151 (2009), section 5). A step is divided until they are small enough.
"""

from __future__ import annotations

import math

import numpy as np
from numba import typeof, types

from tweezer.compiled import cached_njit, named_njit
from tweezer.dynamics.integrators.modes import NODES, displacement, relaxed, velocity
from tweezer.fluid import Modes

#: Gauss's nodes of a part of a step, and its end
_PLACES = np.array([0.5 - math.sqrt(15.0) / 10.0, 0.5, 0.5 + math.sqrt(15.0) / 10.0, 1.0])
#: Largest number of parts of a step, a power of two
_MOST_PARTS = 1024


_vector = types.float64[::1]
TURN = types.void(
    typeof(Modes(np.zeros((0, 0)), np.zeros((0, 0)))), types.float64, _vector,
    types.float64[:, ::1], _vector, types.float64, _vector,
)  # fmt: skip
"""signature of `turn_over`"""


@named_njit(inner=True, error_model="numpy")
def turn(w1, w2, w3, e, out):  # type: ignore[no-untyped-def]
    """Rotate the orientation e by a rotation vector w into `out`: out = exp(w/2) e (A.2).

    `w1`, `w2` and `w3` are the components of w in the inertial frame, rad. Its direction is the
    axis and its length the angle. `e` and `out` (4,) are Euler parameters, and may be the same
    array.
    """
    size = math.sqrt(w1 * w1 + w2 * w2 + w3 * w3)
    c = math.cos(0.5 * size)
    over = 0.5 - size * size / 48.0 if size < 1e-4 else math.sin(0.5 * size) / size
    r1, r2, r3 = over * w1, over * w2, over * w3
    e0, e1, e2, e3 = e[0], e[1], e[2], e[3]
    out[0] = c * e0 - r1 * e1 - r2 * e2 - r3 * e3
    out[1] = c * e1 + r1 * e0 + r2 * e3 - r3 * e2
    out[2] = c * e2 + r2 * e0 + r3 * e1 - r1 * e3
    out[3] = c * e3 + r3 * e0 + r1 * e2 - r2 * e1
    # the same rounding, step after step, would add up: one step of Newton to 1/|e|
    squared = out[0] ** 2 + out[1] ** 2 + out[2] ** 2 + out[3] ** 2
    for i in range(4):
        out[i] *= 1.5 - 0.5 * squared


@named_njit(inner=True, error_model="numpy")
def _cross(a, b, out):  # type: ignore[no-untyped-def]
    """Fill `out` (3,) with the vector product a x b."""
    out[0] = a[1] * b[2] - a[2] * b[1]
    out[1] = a[2] * b[0] - a[0] * b[2]
    out[2] = a[0] * b[1] - a[1] * b[0]


@named_njit(inner=True, error_model="numpy")
def _angular(modes, s, step, v, powers, chi, out):  # type: ignore[no-untyped-def]
    """Fill `out` (2, 3) with the angle turned since a step began, and the angular velocity.

    Both are in the inertial frame: out[0] is the integral of the angular velocity over the time
    `s` (rad), out[1] the angular velocity at `s` (rad/s). `modes` are relaxation times and weights,
    (6, modes), and `step` is the length of the step (s). `v` (6 modes,) are the initial velocities
    of the modes by axis, three of translation and three of rotation. `powers` (6, NODES) are the
    coefficients U_m (`modes`) of the slow velocity along these axes. `chi` (NODES + 1,) is
    workspace.
    """
    many = modes.times.shape[1]
    for i in range(3):
        out[0, i] = out[1, i] = 0.0
        for k in range(many):
            tau, weight = modes.times[3 + i, k], modes.weights[3 + i, k]
            if weight == 0.0:
                continue
            relaxed(s, tau, chi)
            before = v[(3 + i) * many + k]
            out[0, i] += displacement(s, s / step, tau, weight, before, powers[3 + i], chi)
            out[1, i] += weight * velocity(s / step, before, powers[3 + i], chi)


@named_njit(inner=True, error_model="numpy")
def turned(modes, upto, parts, step, v, powers, e, out):  # type: ignore[no-untyped-def]
    """Fill `out` (4,) with the orientation at a time `upto` (s) within a step; return the error.

    The step of length `step` (s) is divided into `parts` equal parts. `modes` are relaxation times
    and weights of the velocity modes, (6, modes), and `v` (6 modes,) their initial velocities. The
    slow velocities have the polynomial coefficients `powers` (6, NODES). `e` (4,) is the initial
    orientation. The error is estimated as the angle (rad) by which the terms of order 6 in the
    Magnus expansion change those of order 4.
    """
    chi = np.empty(NODES + 1)
    at = np.zeros((5, 2, 3))  # at the beginning, the nodes and the end of a part
    terms = np.empty((7, 3))
    first, second, third, C1, C2, left, right = (
        terms[0], terms[1], terms[2], terms[3], terms[4], terms[5], terms[6],
    )  # fmt: skip
    off, begin = 0.0, 0.0
    for i in range(4):
        out[i] = e[i]
    for number in range(parts):
        end = min(step * (number + 1) / parts, upto)
        length = end - begin
        if length <= 0.0:
            break
        for node in range(4):
            _angular(modes, begin + _PLACES[node] * length, step, v, powers, chi, at[1 + node])
        for i in range(3):
            one, two, three = at[1, 1, i], at[2, 1, i], at[3, 1, i]
            first[i] = length * two
            second[i] = math.sqrt(15.0) / 3.0 * length * (three - one)
            third[i] = 10.0 / 3.0 * length * (three - 2.0 * two + one)
        _cross(first, second, C1)
        for i in range(3):
            right[i] = 2.0 * third[i] + C1[i]
        _cross(first, right, C2)
        for i in range(3):
            left[i] = -20.0 * first[i] - third[i] + C1[i]
            right[i] = second[i] - C2[i] / 60.0
        _cross(left, right, C2)
        squared = 0.0
        for i in range(3):
            squared += (C2[i] / 240.0 + C1[i] / 12.0) ** 2
            left[i] = at[4, 0, i] - at[0, 0, i] + C2[i] / 240.0
            at[0, 0, i] = at[4, 0, i]
        off += math.sqrt(squared)
        turn(left[0], left[1], left[2], out, out)
        begin = end
    return off


@named_njit(inner=True, error_model="numpy")
def parts_of(modes, step, v, powers, e, allowed, out):  # type: ignore[no-untyped-def]
    """Return the smallest number of parts of a step, a power of two, that meets a tolerance.

    `allowed` is the tolerance of the angle (rad). `out` (4,) is filled with the final orientation.
    `turned` defines the other arguments.
    """
    parts = 1
    while turned(modes, step, parts, step, v, powers, e, out) > allowed and parts < _MOST_PARTS:
        parts *= 2
    return parts


@cached_njit(error_model="numpy", nogil=True)
def turn_over(modes, step, v, powers, e, allowed, out):  # type: ignore[no-untyped-def]
    """Fill `out` (4,) with the orientation after a step, within the tolerance `allowed` (rad).

    `turned` defines the other arguments. A loop calls this function by its address, so that the
    rotation is not compiled for a scene without one.
    """
    parts_of(modes, step, v, powers, e, allowed, out)
