"""Exponential collocation on SE(3): a rigid body of any shape, with exact drag and inertia.

The twist V = P z of the body has six velocities z_j (`tweezer.dynamics.body`). They relax with the
times tau_j to the slow velocities zeta = P^-1 B (W - N(V)), where W are force and torque in the
body's frame and N the gyroscopic terms. In a step from the pose (q_0, R_0), zeta is a polynomial
through its values at Gauss nodes, so that z and its integral are known exactly (`modes`).

The pose follows from (rho, theta) with q = q_0 + R_0 rho and R = R_0 exp(theta),

    rho' = exp(theta) u,    theta' = J^-1(theta) w,    V = (u, w).

These rates are V and a remainder, which is of second order in the turn. The integral of V is exact;
the remainder is integrated by Gauss's matrix, in rounds that evaluate no force.

Newton's method solves for the 6 x 8 values of zeta. The derivative of the wrench by a twist is
found by differences at one node and used for all; it is kept from step to step while Newton's
method converges quickly. Without inertia these are Gauss's Runge-Kutta methods on SE(3).
"""

from __future__ import annotations

import functools
import math
from typing import Any, NamedTuple

import numpy as np
from numba import typeof
from scipy.spatial.transform import Rotation

from tweezer.compiled import cached_njit, named_njit
from tweezer.compiled.stack import borrowed
from tweezer.dynamics.integrators.modes import (
    INVERSE,
    NODES,
    PLACES,
    TO_LEGENDRE,
    TO_POWERS,
    displacement,
    relaxed,
    velocity,
)
from tweezer.dynamics.integrators.system import (
    COLLAPSED,
    GOING_ON,
    NOT_FINITE,
    Array,
    Bound,
    Equations,
    Records,
    all_finite,
    by_tolerance,
    signature,
    step_to_try,
)
from tweezer.dynamics.layout import EULER, POSITION, ROTATION, TRANSLATION, Layout
from tweezer.dynamics.se3 import from_middle, moved, rotated, rotated_back, turn_in_body
from tweezer.forces.force import Pose, Wrench, add, bound, clear
from tweezer.generated import body_motion

#: Number of components of a twist, and of unknowns in a step
_SIX, _ALL = 6, 6 * NODES
#: Number of components of a velocity, and first column of the Euler parameters in a state of the
#: loop. They follow the position and the velocities z
_HALF, _E = 3, 9
#: Smallest and largest factor from one step to the next, and of a step that Newton did not solve
_SHRINK, _GROWTH, _UNSOLVED = 0.2, 4.0, 0.4
#: Power of the step with which its error scales, and safety factor of the next step
_ORDER, _SAFETY = 9.0, 0.85
#: Error over the allowed error above which a step is given up before it is solved
_HOPELESS = 3.0
#: Correction times its contraction, over the allowed error, at which Newton's method has converged;
#: likewise for steps of fixed or prescribed length
_SOLVED, _SOLVED_WELL = 0.01, 1e-4
#: Contraction that is assumed for the first correction of a step
_FIRST_CONTRACTION = 0.3
#: Contraction above which the derivatives are computed again for the next step, and above which a
#: step is given up
_SLOW, _STUCK = 0.12, 0.6
#: Largest number of corrections, and of rounds for the remainder of the pose
_CORRECTIONS, _ROUNDS = 12, 12
#: Change of the remainder over the allowed error at which its rounds end
_SETTLED = 1e-4
#: Twist for differences, as a part of the body's size, and rad
_DIFFERENCE = 1e-6
#: First step over the time in which the force changes, and over the longest relaxation time
_FIRST, _LAYER = 0.1, 0.5
#: Effect of the initial relaxation over the allowed error, below which the first step ignores it
_UNSEEN = 0.3
#: Longer than any run, s
_FOREVER = 1e9

#: The powers U_m of a polynomial by its values at the nodes, (node, m)
_TO_U = TO_LEGENDRE @ TO_POWERS
#: Gauss's matrix: integral from 0 to node i of the polynomial that is 1 at node j, over the step
_GAUSS = np.array([
    [sum(_TO_U[j, m] * c ** (m + 1) * INVERSE[m + 1] for m in range(NODES)) for j in range(NODES)]
    for c in PLACES
])  # fmt: skip


class BodyRelaxation(NamedTuple):
    """Data of the method for one body, and the values that a run carries from step to step."""

    times: Array
    """(6,) s, relaxation times; 0 without inertia"""
    velocities: Array
    """P, (6, 6): twist of each velocity"""
    response: Array
    """P^-1 B, (6, 6): slow velocities over force and torque in the body's frame"""
    inertia: Array
    """M, (6, 6); (0, 0) without inertia"""
    weight: Array
    """(3,) N, constant force in the laboratory's frame"""
    length: float
    """size of the body, m"""
    first: float
    """length of the first step, s; used again after kinks of the force in time"""
    foretold: Array
    """(6, NODES) Legendre coefficients of the slow velocities in the last step"""
    gradient: Array
    """(6, 6) derivative of force and torque by a twist, in the body's frame"""
    carried: Array
    """(4,): length of the last step, s; length that its error would allow, s; position of the next
    step's beginning within the last one; contraction of Newton's method in the last step"""


class Work(NamedTuple):
    """Workspace of a step; arrays by node have the node first."""

    pose: Pose
    """times and poses at the nodes"""
    wrench: Wrench
    """force and torque at the nodes"""
    near: Pose
    """times and poses for differences"""
    pushed: Wrench
    """force and torque at these poses"""
    slow: Array
    """zeta, (NODES, 6)"""
    twist: Array
    """V, (NODES, 6), m/s and rad/s"""
    way: Array
    """(NODES, 6) integral of V from the beginning of the step, m and rad"""
    y: Array
    """(NODES, 6) rho and theta"""
    remainder: Array
    """(NODES, 6) rates of rho and theta less V"""
    moving: Array
    """(6, NODES, NODES) s: integral of a velocity at a node per value of zeta at another"""
    following: Array
    """(6, NODES, NODES): velocity at a node per value of zeta at another"""
    begun: Array
    """(2, NODES, 6) integral and velocity at each node that the initial velocities give"""
    residual: Array
    """(6 NODES,) zeta by the forces less zeta; then its correction"""
    matrix: Array
    """(6 NODES, 6 NODES) of Newton's method"""
    shape: Array
    """(12, NODES) the U_m of zeta and of the remainder"""
    coefficients: Array
    """(12, NODES) Legendre coefficients of the same"""
    six: Array
    """(6, 6) temporary"""
    gyroscopic: Array
    """(6, 6) dN/dV at the middle of the step"""
    chi: Array
    """(NODES + 1,) functions chi_m, see `modes`"""


@named_njit(inner=True, error_model="numpy")
def _room():  # type: ignore[no-untyped-def]
    """Allocate the workspace of a step."""
    n, six, none = NODES, _SIX, np.zeros((0, 3, 3))
    return Work(
        Pose(np.zeros(n), np.zeros((n, 3)), np.zeros((n, 4)), np.zeros((0, 3))),
        Wrench(np.zeros((n, 3)), np.zeros((n, 3)), none, none, np.zeros(n)),
        Pose(np.zeros(six), np.zeros((six, 3)), np.zeros((six, 4)), np.zeros((0, 3))),
        Wrench(np.zeros((six, 3)), np.zeros((six, 3)), none, none, np.zeros(six)),
        np.zeros((n, six)), np.zeros((n, six)), np.zeros((n, six)), np.zeros((n, six)),
        np.zeros((n, six)), np.zeros((six, n, n)), np.zeros((six, n, n)), np.zeros((2, n, six)),
        np.zeros(_ALL), np.zeros((_ALL, _ALL)), np.zeros((2 * six, n)), np.zeros((2 * six, n)),
        np.zeros((six, six)), np.zeros((six, six)), np.zeros(n + 1),
    )  # fmt: skip


@named_njit(inner=True, error_model="numpy")
def _weigh(how, step, z, work):  # type: ignore[no-untyped-def]
    """Fill the matrices from zeta at the nodes to velocities and their integrals there.

    `step` is the length of the step, s. `z` (6,) are the velocities when it begins.
    """
    for j in range(_SIX):
        tau = how.times[j]
        for i in range(NODES):
            s = PLACES[i] * step
            relaxed(s, tau, work.chi)
            work.begun[0, i, j] = tau * work.chi[0] * z[j]
            work.begun[1, i, j] = (1.0 - work.chi[0]) * z[j]
            for k in range(NODES):
                way, now, power = 0.0, 0.0, 1.0
                for m in range(NODES):
                    way += _TO_U[k, m] * power * work.chi[m + 1]
                    now += _TO_U[k, m] * power * work.chi[m]
                    power *= PLACES[i]
                work.moving[j, i, k] = s * way
                work.following[j, i, k] = now


@named_njit(inner=True, error_model="numpy")
def _foretell(how, step, work):  # type: ignore[no-untyped-def]
    """Predict zeta at the nodes by the polynomial of the last step."""
    before = how.carried[0]
    for i in range(NODES):
        x = 0.0 if before == 0.0 else 2.0 * (how.carried[2] + PLACES[i] * step / before) - 1.0
        for j in range(_SIX):
            last, now, total = 1.0, x, how.foretold[j, 0]
            for k in range(1, NODES):
                total += how.foretold[j, k] * now
                last, now = now, ((2 * k + 1) * x * now - k * last) / (k + 1)
            work.slow[i, j] = total


@named_njit(inner=True, error_model="numpy")
def _settle(how, step, allowed, work):  # type: ignore[no-untyped-def]
    """Fill `work.y` with (rho, theta) at the nodes for the slow velocities in `work.slow`.

    `allowed` (2,) are the tolerances of a displacement, m, and of an angle, rad.
    """
    turned = np.empty(3)
    for i in range(NODES):
        for a in range(_SIX):
            work.twist[i, a] = work.way[i, a] = 0.0
        for j in range(_SIX):
            way, now = work.begun[0, i, j], work.begun[1, i, j]
            for k in range(NODES):
                way += work.moving[j, i, k] * work.slow[k, j]
                now += work.following[j, i, k] * work.slow[k, j]
            for a in range(_SIX):
                work.way[i, a] += how.velocities[a, j] * way
                work.twist[i, a] += how.velocities[a, j] * now
    for _ in range(_ROUNDS):
        most = 0.0
        for i in range(NODES):
            for a in range(_SIX):
                at = work.way[i, a]
                for k in range(NODES):
                    at += step * _GAUSS[i, k] * work.remainder[k, a]
                work.y[i, a] = at
        for i in range(NODES):
            w = work.twist[i, _HALF:]
            from_middle(work.y[i, _HALF:], w, turned)
            for a in range(3):
                most = max(most, step * abs(turned[a] - work.remainder[i, 3 + a]) / allowed[1])
                work.remainder[i, 3 + a] = turned[a]
            _turned(work.y[i, _HALF:], work.twist[i, :_HALF], turned)
            for a in range(3):
                more = turned[a] - work.twist[i, a]
                most = max(most, step * abs(more - work.remainder[i, a]) / allowed[0])
                work.remainder[i, a] = more
        if not most > _SETTLED:
            break


@named_njit(inner=True, error_model="numpy")
def _turned(theta, v, out):  # type: ignore[no-untyped-def]
    """Fill `out` (3,) with exp(theta) v."""
    e = np.empty(4)
    e[0], e[1], e[2], e[3] = 1.0, 0.0, 0.0, 0.0
    turn_in_body(e, theta[0], theta[1], theta[2], e)
    rotated(e, v, out)


@named_njit(inner=True, error_model="numpy")
def _reach(y, place, out_position, out_e):  # type: ignore[no-untyped-def]
    """Fill the pose q_0 + R_0 rho, R_0 exp(theta), for `place` (6,) = (rho, theta).

    `y` is the state at the beginning of the step: position, six velocities, Euler parameters.
    """
    e = y[_E : _E + EULER]
    rotated(e, place[:_HALF], out_position)
    for a in range(3):
        out_position[a] += y[a]
    turn_in_body(e, place[3], place[4], place[5], out_e)


@named_njit(inner=True, error_model="numpy")
def _wrench(how, pose, wrench, i, out):  # type: ignore[no-untyped-def]
    """Fill `out` (6,) with force and torque `i` in the body's frame, with the weight."""
    for a in range(3):
        wrench.force[i, a] += how.weight[a]
    rotated_back(pose.orientation[i], wrench.force[i], out[:_HALF])
    rotated_back(pose.orientation[i], wrench.moment[i], out[_HALF:])


@named_njit(inner=True, error_model="numpy")
def _evaluate(system, how, time, step, y, work, counts):  # type: ignore[no-untyped-def]
    """Fill `work.residual` with zeta by the forces at the nodes less zeta."""
    wrench = np.empty(_SIX)
    for i in range(NODES):
        work.pose.time[i] = time + PLACES[i] * step
        _reach(y, work.y[i], work.pose.position[i], work.pose.orientation[i])
    clear(work.wrench)
    add(system.force, work.pose, work.wrench)
    counts[2] += NODES
    gyroscopic = np.zeros(_SIX)
    for i in range(NODES):
        _wrench(how, work.pose, work.wrench, i, wrench)
        if how.inertia.size > 0:
            body_motion.kirchhoff(work.twist[i], how.inertia, gyroscopic)
        for j in range(_SIX):
            total = -work.slow[i, j]
            for a in range(_SIX):
                total += how.response[j, a] * (wrench[a] - gyroscopic[a])
            work.residual[_SIX * i + j] = total


@named_njit(inner=True, error_model="numpy")
def _differentiate(system, how, work, counts):  # type: ignore[no-untyped-def]
    """Fill `how.gradient` by differences about the pose at the middle node."""
    middle = NODES // 2
    wrench, before, xi = np.empty(_SIX), np.empty(_SIX), np.zeros(_SIX)
    rotated_back(work.pose.orientation[middle], work.wrench.force[middle], before[:_HALF])
    rotated_back(work.pose.orientation[middle], work.wrench.moment[middle], before[_HALF:])
    for a in range(_SIX):
        for b in range(_SIX):
            xi[b] = 0.0
        xi[a] = _DIFFERENCE * (how.length if a < 3 else 1.0)
        work.near.time[a] = work.pose.time[middle]
        moved(
            work.pose.position[middle], work.pose.orientation[middle], xi,
            work.near.position[a], work.near.orientation[a],
        )  # fmt: skip
    clear(work.pushed)
    add(system.force, work.near, work.pushed)
    counts[2] += _SIX
    for a in range(_SIX):
        _wrench(how, work.near, work.pushed, a, wrench)
        per = _DIFFERENCE * (how.length if a < 3 else 1.0)
        for b in range(_SIX):
            how.gradient[b, a] = (wrench[b] - before[b]) / per


@named_njit(inner=True, error_model="numpy")
def _product(left, middle, right, out):  # type: ignore[no-untyped-def]
    """Fill `out` (6, 6) with the product of three matrices (6, 6)."""
    for i in range(_SIX):
        for j in range(_SIX):
            total = 0.0
            for k in range(_SIX):
                for l in range(_SIX):
                    total += left[i, k] * middle[k, l] * right[l, j]
            out[i, j] = total


@named_njit(inner=True, error_model="numpy")
def _factorise(how, work):  # type: ignore[no-untyped-def]
    """Fill `work.matrix` with the factors of the matrix of Newton's method, without pivots.

    It is 1 - P^-1 B (dW/dtwist) P times the integrals of zeta, and for a body with inertia
    + P^-1 B (dN/dV) P times the velocities.
    """
    _product(how.response, how.gradient, how.velocities, work.six)
    turning = how.inertia.size > 0
    if turning:
        middle = work.twist[NODES // 2]
        body_motion.kirchhoff_gradient(middle, how.inertia, work.gyroscopic)
        _product(how.response, work.gyroscopic.copy(), how.velocities, work.gyroscopic)
    matrix = work.matrix
    for i in range(NODES):
        for j in range(_SIX):
            row = _SIX * i + j
            for k in range(NODES):
                for l in range(_SIX):
                    value = -work.six[j, l] * work.moving[l, i, k]
                    if turning:
                        value += work.gyroscopic[j, l] * work.following[l, i, k]
                    matrix[row, _SIX * k + l] = value
            matrix[row, row] += 1.0
    for k in range(_ALL):
        for i in range(k + 1, _ALL):
            factor = matrix[i, k] / matrix[k, k]
            matrix[i, k] = factor
            for j in range(k + 1, _ALL):
                matrix[i, j] -= factor * matrix[k, j]


@named_njit(inner=True, error_model="numpy")
def _felt(step, tau):  # type: ignore[no-untyped-def]
    """Return about the part of a change of the slow velocity that a velocity follows in a step."""
    return step / (step + tau)


@named_njit(inner=True, error_model="numpy")
def _correct(how, step, allowed, work):  # type: ignore[no-untyped-def]
    """Correct `work.slow`; return the size of the correction over the allowed displacement."""
    matrix, x = work.matrix, work.residual
    for i in range(_ALL):
        for j in range(i):
            x[i] -= matrix[i, j] * x[j]
    for i in range(_ALL - 1, -1, -1):
        for j in range(i + 1, _ALL):
            x[i] -= matrix[i, j] * x[j]
        x[i] /= matrix[i, i]
    most = 0.0
    for i in range(NODES):
        for a in range(_SIX):
            change = 0.0
            for j in range(_SIX):
                change += how.velocities[a, j] * x[_SIX * i + j] * _felt(step, how.times[j])
            most = max(most, step * abs(change) / allowed[0 if a < 3 else 1])
        for j in range(_SIX):
            work.slow[i, j] += x[_SIX * i + j]
    return most


@named_njit(inner=True, error_model="numpy")
def _polynomials(work):  # type: ignore[no-untyped-def]
    """Fill the coefficients of zeta and of the remainder, in Legendre polynomials and in powers."""
    for j in range(2 * _SIX):
        values = work.slow[:, j] if j < _SIX else work.remainder[:, j - _SIX]
        for k in range(NODES):
            work.coefficients[j, k] = work.shape[j, k] = 0.0
            for i in range(NODES):
                work.coefficients[j, k] += TO_LEGENDRE[i, k] * values[i]
                work.shape[j, k] += _TO_U[i, k] * values[i]


@named_njit(inner=True, error_model="numpy")
def _error(how, step, allowed, work):  # type: ignore[no-untyped-def]
    """Return the error of a step over the allowed one, by the last two Legendre coefficients."""
    most = 0.0
    for a in range(_SIX):
        for k in range(NODES - 2, NODES):
            slow = 0.0
            for j in range(_SIX):
                part = _felt(step, how.times[j])
                slow += how.velocities[a, j] * work.coefficients[j, k] * part
            off = abs(slow) + abs(work.coefficients[_SIX + a, k])
            most = max(most, off / allowed[0 if a < 3 else 1])
    return 0.5 * step * most / (2 * NODES + 1)


@named_njit(inner=True, error_model="numpy")
def _collocate(  # type: ignore[no-untyped-def]
    system, how, adaptive, allowed, time, step, y, work, counts
):
    """Solve for zeta at the nodes; return the error over the allowed one, or -1 without success."""
    for i in range(NODES):
        for a in range(_SIX):
            work.remainder[i, a] = 0.0
    solved = _SOLVED if adaptive else _SOLVED_WELL
    before, contraction = 0.0, _FIRST_CONTRACTION
    fresh = not how.carried[3] < _SLOW
    for correction in range(_CORRECTIONS):
        _settle(how, step, allowed, work)
        _evaluate(system, how, time, step, y, work, counts)
        if correction == 0:
            if fresh:
                _differentiate(system, how, work, counts)
            _factorise(how, work)
        size = _correct(how, step, allowed, work)
        if not size < np.inf:
            return -1.0
        if before > 0.0:
            contraction = size / before
            if contraction > _STUCK:
                break
        elif adaptive:
            _polynomials(work)
            error = _error(how, step, allowed, work)
            if error > _HOPELESS:
                how.carried[3] = 1.0
                return error
        before = size
        if size * contraction <= solved:
            _settle(how, step, allowed, work)
            _polynomials(work)
            if correction > 0:
                how.carried[3] = contraction
            return _error(how, step, allowed, work)
    if not fresh:  # once more, with new derivatives
        how.carried[3] = 1.0
        return -2.0
    return -1.0


@named_njit(inner=True, error_model="numpy")
def _to(how, s, step, y, shape, chi, out):  # type: ignore[no-untyped-def]
    """Fill `out` (13,) with the state at a time `s`, s, after a step began.

    `y` is the state at the beginning: position, six velocities and Euler parameters. `shape` (12,
    NODES) are the coefficients of zeta and of the remainder.
    """
    place = np.zeros(_SIX)
    for j in range(_SIX):
        tau = how.times[j]
        relaxed(s, tau, chi)
        way = displacement(s, s / step, tau, 1.0, y[_HALF + j], shape[j], chi)
        for a in range(_SIX):
            place[a] += how.velocities[a, j] * way
        out[_HALF + j] = velocity(s / step, y[_HALF + j], shape[j], chi)
        power = s
        for m in range(NODES):
            place[j] += shape[_SIX + j, m] * power * INVERSE[m + 1]
            power *= s / step
    _reach(y, place, out[:_HALF], out[_E : _E + EULER])


@named_njit(inner=True, error_model="numpy")
def _remember(how, step, end, work):  # type: ignore[no-untyped-def]
    """Keep the polynomial of a step for the prediction of the next; `end` is where it begins."""
    how.carried[0], how.carried[2] = step, end
    for j in range(_SIX):
        for k in range(NODES):
            how.foretold[j, k] = work.coefficients[j, k]


@named_njit(inner=True, error_model="numpy")
def _advance(  # type: ignore[no-untyped-def]
    system, how, control, y, clock, counts, records, work, new
):
    """Take steps until the run ends or the records are full; see `explicit.loop`."""
    adaptive = by_tolerance(control)
    allowed = np.empty(2)
    allowed[0], allowed[1] = control.absolute[0], control.absolute[control.orientation]
    written = 0
    if clock[1] == 0.0:
        clock[1] = control.fixed if control.fixed > 0.0 else how.first
        how.carried[0] = how.carried[1] = 0.0
        how.carried[3] = 1.0
    while True:
        time = clock[0]
        step, last, why = step_to_try(control, clock, counts, records.begin.size - written)
        if why != GOING_ON:
            return written, why
        _weigh(how, step, y[_HALF:_E], work)
        error = -2.0
        while error == -2.0:
            _foretell(how, step, work)
            error = _collocate(system, how, adaptive, allowed, time, step, y, work, counts)
        sound = all_finite(work.slow)
        if error < 0.0 and (not adaptive or (not sound and not step > 1e-12 * control.end)):
            return written, COLLAPSED if sound else NOT_FINITE
        if error < 0.0 or (adaptive and not error <= 1.0):
            counts[1] += 1
            factor = _UNSOLVED if error < 0.0 else _SAFETY * error ** (-1.0 / _ORDER)
            how.carried[3] = 1.0
            clock[1] = step * max(factor, _SHRINK)
            continue
        records.begin[written] = time
        records.length[written] = step
        for i in range(y.size):
            records.state[written, i] = y[i]
        for j in range(2 * _SIX):
            for m in range(NODES):
                records.shape[written, j, m] = work.shape[j, m]
        _to(how, step, step, y, work.shape, work.chi, new)
        written += 1
        counts[0] += 1
        clock[0] = control.end if last else time + step
        _remember(how, step, 1.0, work)
        if adaptive:
            # the step with this error and, by Gustafsson's predictive control, its trend
            best = step * _SAFETY * max(error, 1e-12) ** (-1.0 / _ORDER)
            trend = min(best / how.carried[1], 1.0) if how.carried[1] > 0.0 else 1.0
            how.carried[1] = best
            clock[1] = min(max(best * trend, _SHRINK * step), _GROWTH * step)
        for i in range(y.size):
            y[i] = new[i]


@functools.cache
def loop() -> Any:
    """Return the compiled loop, with the arguments and result of `explicit.loop`.

    A `BodyRelaxation` replaces the tableau. The state contains the position, the six velocities z
    and the Euler parameters. The dense output of a step, `Records.shape`, contains the coefficients
    U_m of zeta and of the remainder.
    """

    def advance(  # type: ignore[no-untyped-def]
        system, how, control, y, clock, counts, records
    ):
        """Allocate the workspace, and take steps by `_advance`."""
        work, new = _room(), np.empty(y.size)
        found = _advance(*borrowed((system, how, control, y, clock, counts, records, work, new)))
        # `borrowed` drops the reference counts: this use keeps the workspace allocated until here
        work.chi[0] = new[0]
        return found

    return cached_njit(signature(_RELAXATION), error_model="numpy", nogil=True)(advance)


@cached_njit(error_model="numpy")
def sample(times, begin, length, state, shape, how, out):  # type: ignore[no-untyped-def]
    """Fill `out` (n, 13) with the states at ascending `times` (n,), s, from recorded steps.

    `begin`, `length`, `state` and `shape` are the fields of `Records`, and `how` is the
    `BodyRelaxation`.
    """
    chi, step = np.empty(NODES + 1), 0
    for at in range(times.size):
        while step + 1 < begin.size and times[at] >= begin[step + 1]:
            step += 1
        _to(how, times[at] - begin[step], length[step], state[step], shape[step], chi, out[at])


def bound_to(equations: Equations) -> Bound:
    """Return the method bound to the equations of motion of a body of any shape."""
    body, emitted = equations.body, equations.layout
    assert body is not None
    inertial = "velocity" in emitted
    six = np.eye(_SIX)
    velocities = body.velocities if inertial else six
    start = equations.begin.inner.copy() if equations.begin is not None else None
    how = BodyRelaxation(
        body.relaxation_times if inertial else np.zeros(_SIX),
        np.ascontiguousarray(velocities),
        np.ascontiguousarray(np.linalg.solve(velocities, body.mobility)),
        body.inertia if inertial else np.zeros((0, 0)),
        np.array(equations.bead.weight), equations.scene.body.size, 0.0,
        np.zeros((_SIX, NODES)), np.zeros((_SIX, _SIX)), np.array([0.0, 0.0, 1.0, 1.0]),
    )  # fmt: skip
    if start is None:
        start = _in_modes(equations.initial_state, velocities, emitted)
    how = _begun(equations, how, start)

    def inner(records: Records, times: Array) -> Array:
        out = np.empty((len(times), records.state.shape[1]))
        sample(times, *records, how, out)
        return out

    def states(records: Records, times: Array) -> Array:
        return _emitted(inner(records, times), velocities, emitted)

    force = bound(equations.moving, gradient=False)
    return Bound(
        loop(), how, start, (2 * _SIX, NODES), states, force=force, rates=False, inner=inner
    )


def _begun(equations: Equations, how: BodyRelaxation, y: Array) -> BodyRelaxation:
    """Return the data of a run with the first step, and the initial velocities as its prediction.

    In the first step the force changes little, and the initial relaxation of the velocity is
    resolved where it moves the body noticeably. `y` (13,) is the initial state.
    """
    size, turned = how.length, Rotation.from_quat(y[_E:], scalar_first=True)
    twists = np.vstack([np.zeros(_SIX), _DIFFERENCE * np.diag([size] * 3 + [1.0] * 3)])
    places = y[POSITION] + turned.apply(twists[:, TRANSLATION])
    turns = turned * Rotation.from_rotvec(twists[:, ROTATION])
    at = equations.moving.field(
        places, time=equations.begin_time, orientations=turns.as_quat(scalar_first=True)
    )
    back = turns.inv()
    wrench = np.hstack([back.apply(at.force + how.weight), back.apply(at.moment)])
    gradient = (wrench[1:] - wrench[0]).T / np.diag(twists[1:])
    slow = how.response @ wrench[0]
    foretold = np.zeros((_SIX, NODES))
    foretold[:, 0] = slow
    rate = float(np.abs(np.linalg.eigvals(how.velocities @ how.response @ gradient)).max())
    allowed = equations.absolute_tolerance[[0] * 3 + [equations.layout.first("orientation")] * 3]
    moved = rate * np.abs(how.velocities * (how.times**2 * (y[_HALF:_E] - slow)))
    seen = (moved / allowed[:, None] > _UNSEEN).any(axis=0)
    first = _LAYER * float(how.times[seen].min(initial=math.inf))
    return how._replace(
        first=min(first, _FIRST / rate if rate > 0.0 else _FOREVER, _FOREVER), foretold=foretold
    )


def _in_modes(state: Array, velocities: Array, emitted: Layout) -> Array:
    """Return the state of the loop, (13,), from one in the form of the emitted equations."""
    e, twist = state[emitted.at("orientation")], np.zeros(_SIX)
    if "velocity" in emitted:
        turned = Rotation.from_quat(e, scalar_first=True)
        twist[TRANSLATION] = turned.apply(state[emitted.at("velocity")], inverse=True)
        twist[ROTATION] = state[emitted.at("angular_velocity")]
    return np.concatenate([state[POSITION], np.linalg.solve(velocities, twist), e])


def _emitted(y: Array, velocities: Array, emitted: Layout) -> Array:
    """Return states (n, state) in the form of the emitted equations, from those of the loop."""
    states = np.empty((len(y), emitted.width))
    states[:, POSITION], states[:, emitted.at("orientation")] = y[:, POSITION], y[:, _E:]
    if "velocity" in emitted:
        twist = y[:, _HALF:_E] @ velocities.T
        turned = Rotation.from_quat(y[:, _E:], scalar_first=True)
        states[:, emitted.at("velocity")] = turned.apply(twist[:, TRANSLATION])
        states[:, emitted.at("angular_velocity")] = twist[:, ROTATION]
    return states


_six, _square = np.zeros(_SIX), np.zeros((_SIX, _SIX))
_RELAXATION = typeof(
    BodyRelaxation(
        _six, _square, _square, _square, _six, 0.0, 0.0, np.zeros((_SIX, NODES)), _square, _six
    )
)
