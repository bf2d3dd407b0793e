"""Exponential collocation at Gauss nodes: the drag is exact, and one call evaluates all nodes.

The velocity of the bead relaxes to the slow velocity u = F/beta. Its motion is known exactly where
u is a polynomial of time (`modes`). In a step [0, h] the polynomial through the values U of u at
the Gauss nodes c_j gives the positions X there, which are linear in U: X = x + base + M U.

Newton's method solves U = u(X). The first call evaluates the force and its gradient J at all
nodes. The correction d, (1 - M J) d = x + base + M U - X, is found by iteration or, where that is
slow, by elimination. Later calls evaluate forces alone, with the same J, until d is small.
Without inertia these are Gauss's Runge-Kutta methods (E. Hairer, G. Wanner, Solving Ordinary
Differential Equations II, IV.5). With N nodes they have order 2 N at the ends of steps, and the
polynomial between the ends has order N + 1.

Where the mobility b depends on the position, u = b(x) F(x) is still a function of the position, and
its gradient includes the gradient of b. Motion without inertia therefore keeps its order. With
inertia, each step uses the relaxation times at its midpoint. This approximation is second order in
the step. Its error is at most the change of these times times the change of the velocity in a step;
the error of a step includes it. The relaxation times of a rotation keep their initial values:
the inertia changes the orientation only by an angle, their change times the angular velocity.

The error of the polynomial is estimated from the last Legendre coefficients of u. They are known
after the first correction, so a step that is too long is given up early. An early error grows as
the speed of the bead does. The allowed error is therefore the tolerance where the bead is fastest
and where neighbouring paths approach each other. Elsewhere it decreases in proportion to the speed,
down to a hundredth.
"""

from __future__ import annotations

import functools
import math
from typing import Any, NamedTuple

import numpy as np
from numba import typeof

from tweezer.compiled import address, cached_njit, call, named_njit
from tweezer.compiled.lanes import lanes, spread, store
from tweezer.compiled.stack import borrowed
from tweezer.dynamics.integrators.modes import (
    INVERSE,
    LONG,
    NODES,
    PLACES,
    TO_LEGENDRE,
    TO_POWERS,
    displacement,
    followed,
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
from tweezer.dynamics.integrators.turning import TURN, parts_of, turn_over, turned
from tweezer.dynamics.layout import EULER, POSITION, ROTATION, TRANSLATION, Layout
from tweezer.fluid import Mobility, Modes
from tweezer.forces.data import Part, packed
from tweezer.forces.force import Pose, Wrench, add, bound, clear
from tweezer.generated import kinematics

#: Smallest and largest factor from one step to the next, and of a step that Newton did not solve
_SHRINK, _GROWTH, _UNSOLVED = 0.2, 4.0, 0.4
#: Relative rounding error of a position
_ROUNDING = 1e-15
#: Power of the step with which its error scales
_ORDER = 10.0
#: Power of the step with which the error by constant relaxation times scales
_ORDER_OF_FREEZING = 3.0
#: Safety factor of the next step
_SAFETY = 0.85
#: Error over the allowed error above which a step is given up before it is solved
_HOPELESS = 1.5
#: Smallest fraction of the tolerance that is allowed, for a slow bead
_SLOWEST = 1e-2
#: Number of bisections by which a kink is located
_HALVINGS = 20
#: First step, over the time in which the force changes
_FIRST = 0.1
#: First step over the shortest relaxation time that is seen: of one mode, and of many, whose sum a
#: polynomial holds over some decades of times
_LAYER, _LAYERS = 0.5, 50.0
#: Longer than any run, s
_FOREVER = 1e9
#: Effect of the initial relaxation over the allowed error, below which the first step ignores it
_UNSEEN = 0.3
#: Largest correction over the allowed error with which Newton's method has converged
_SOLVED = 0.02
#: Factor by which the first correction of a step may leave more than that of the last step did
_CAUTION = 20.0
#: Product of a correction and its ratio to the one before, over the allowed error, below which the
#: next one is not needed: it estimates its size
_CONVERGING = 0.025
#: Likewise for steps of fixed or prescribed length
_SOLVED_WELL = 1e-4
#: Largest number of corrections
_CORRECTIONS = 12
#: Change of a correction over the allowed error at which the iteration for it ends, and the largest
#: number of its rounds
_ITERATED, _ROUNDS = 0.003, 16
#: Contraction of the iteration above which elimination is faster, and of Newton's method above
#: which the step is given up
_SLOW = 0.5

#: Column of the first mode velocity in a state of the loop. A state contains x, the velocities of
#: the modes, e of a rotation, and the relaxation times if the drag depends on the position
_MODES = POSITION.stop

#: Number of vector components at all nodes, and of elements of a matrix from node to node
_ALL = 3 * NODES
_MATRIX = NODES * NODES
_flat_legendre = TO_LEGENDRE.ravel()
#: Powers 1 to NODES of the nodes' places, by power
_POWERS = (PLACES ** np.arange(1, NODES + 1)[:, None]).ravel()
_PER_PLACE = 1.0 / PLACES
#: 1/m for m = 1 to NODES: evaluates sum_m U_m x^m/m! by nested products
_OVER = 1.0 / np.arange(1.0, NODES + 1.0)
#: Recursion of Legendre polynomials: P_(k+1) = _UP[k] x P_k - _DOWN[k] P_(k-1)
_UP = (2.0 * np.arange(NODES) + 1.0) / np.arange(1.0, NODES + 1.0)
_DOWN = np.arange(NODES) / np.arange(1.0, NODES + 1.0)


class Relaxation(NamedTuple):
    """Data of the method for one bead, and the values that a run carries from step to step.

    The slow velocity u is the velocity to which the bead relaxes, (force + weight) times mobility.
    """

    plain: Part
    """compiled force without its gradients"""
    modes: Modes
    """relaxation times and weights of the velocity modes along each axis, (3, modes), or along and
    about each axis if the bead rotates, (6, modes)
    """
    turn: int
    """address of `turn_over`; 0 without a rotation"""
    regions: Part
    """function that numbers the regions in which the force is smooth, see `Force.regions`; its
    kernel is 0 if the force is smooth everywhere
    """
    response: Array
    """(3,) or (6,) mobilities: slow velocity over force, s/kg, and angular velocity over torque,
    1/(N m s)
    """
    drift: Array
    """(3,) m/s, slow velocity due to the weight"""
    first: float
    """length of the first step, s, from the force at time 0; used again after kinks of the force in
    time
    """
    fastest: float
    """m/s, a speed that the bead rarely exceeds; tolerances are stated for this speed"""
    inertia: Array
    """(3,) kg, relaxation time over mobility along each axis, if the drag depends on the position
    and its relaxation is followed; else (0,)
    """
    foretold: Array
    """(3 NODES,) Legendre coefficients of u in the last step, by axis: the prediction for the next
    step
    """
    carried: Array
    """(4,): length of the last step, s; length that its error would allow, s; coefficient of
    quadratic convergence of Newton's method, 1/m, in the last step with two corrections;
    position of the next step's beginning within the last one, 1 for its end and 0 for its
    beginning after a rejected step
    """


class Work(NamedTuple):
    """Workspace of a step.

    A vector at all nodes is flattened to (3 NODES,) with the component i at the node j at NODES i +
    j; a matrix to (9 NODES,) with the element (i, k) at NODES (3 i + k) + j.
    """

    pose: Pose
    """times and positions of the bead at the nodes"""
    wrench: Wrench
    """force and gradients at the nodes"""
    plain: Wrench
    """force at the nodes without gradients; shares its arrays with `wrench`"""
    place: Array
    """(3 NODES,) m, positions at the nodes"""
    u: Array
    """(3 NODES,) m/s, slow velocity at the nodes"""
    residual: Array
    """(3 NODES,) m, positions that u implies less `place`"""
    correction: Array
    """(3 NODES,) m, change of `place` in a Newton step"""
    change: Array
    """(3 NODES,) change of u in a Newton step, m/s; also temporary values"""
    gradient: Array
    """(9 NODES,) J, derivative of u by the position at each node, 1/s"""
    coefficients: Array
    """(3 NODES,) Legendre coefficients of u, m/s, by axis"""
    M: Array
    """matrices (NODES, NODES), s, from u at the nodes to displacements there: for one axis, element
    (node of u, node of the displacement)
    """
    first: Array
    """(3,) index at which the matrix of each axis begins in `M`: equal axes share one"""
    base: Array
    """(3, NODES) m, positions at the nodes if u were zero"""
    decay: Array
    """(modes, NODES) s, displacement at each node per velocity of the mode at the beginning of the
    step
    """
    upper: Array
    """(3 NODES 3 NODES,) upper triangular factor of the transposed 1 - M J"""
    lower: Array
    """(3 NODES 3 NODES,) the lower triangular factor, with ones on its diagonal"""
    powers: Array
    """(6, NODES) coefficients U_m of u along the axes and of the slow angular velocity
    about them
    """
    moment: Array
    """(3 NODES,) N m, moments at the nodes"""
    chi: Array
    """(NODES + 1,) functions chi_m, see `modes`"""
    rows: Array
    """(NODES NODES,) displacements at the nodes by each polynomial of u; overwritten
    for each axis
    """
    there: Pose
    """time and position of one bead, for the drag"""
    mobility: Mobility
    """mobility at this position"""


@named_njit(inner=True, error_model="numpy", forceinline=True)
def _room(modes):  # type: ignore[no-untyped-def]
    """Allocate the workspace of a step for a bead with that many velocity modes per axis."""
    n = NODES
    pose = Pose(np.empty(n), np.empty((n, 3)), np.empty((0, 4)), np.empty((0, 3)))
    force, moment, error = np.empty((n, 3)), np.empty((n, 3)), np.empty(n)
    none = np.empty((0, 3, 3))
    return Work(
        pose, Wrench(force, moment, np.empty((n, 3, 3)), np.empty((n, 3, 3)), error),
        Wrench(force, moment, none, none, error),
        np.empty(_ALL), np.empty(_ALL), np.empty(_ALL), np.empty(_ALL), np.empty(_ALL),
        np.empty(3 * _ALL), np.empty(_ALL), np.empty(3 * _MATRIX), np.empty(3, np.int64),
        np.empty((3, n)), np.empty((modes, n)), np.empty(_ALL * _ALL), np.zeros(_ALL * _ALL),
        np.empty((6, n)), np.empty(_ALL), np.empty(n + 1), np.empty(_MATRIX),
        Pose(np.empty(1), np.empty((1, 3)), np.empty((0, 4)), np.empty((0, 3))),
        Mobility(np.empty((1, 5)), np.empty((0, 5, 3))),
    )  # fmt: skip


@named_njit(inner=True, error_model="numpy", forceinline=True)
def _relaxation_times(system, how, time, place, work, out):  # type: ignore[no-untyped-def]
    """Fill `out` (3,) with the relaxation times along the axes at a position, s.

    time: s. place: (3,) m. The time is `how.inertia`, kg, times the mobility there:
    `mobility.value` has the parallel mobility (axes 1 and 2) at 0 and the perpendicular one (axis
    3) at 1.
    """
    work.there.time[0] = time
    for i in range(3):
        work.there.position[0, i] = place[i]
    call(system.drag.kernel, (work.there, system.drag.data, work.mobility))
    for i in range(3):
        out[i] = how.inertia[i] * work.mobility.value[0, 1 if i == 2 else 0]


@named_njit(inner=True, error_model="numpy", forceinline=True)
def _freeze(system, how, time, step, y, work):  # type: ignore[no-untyped-def]
    """Set the relaxation times for a step to those at the estimated midpoint of the bead's path.

    `step` is its length (s) and `y` the initial (state,), whose velocity gives the midpoint. The
    last three entries of `y` keep the times too, where the dense output reads them.
    """
    for i in range(3):
        work.powers[0, i] = y[i] + 0.5 * step * y[_MODES + i]
    _relaxation_times(system, how, time, work.powers[0], work, work.powers[1])
    for i in range(3):
        y[y.size - how.inertia.size + i] = how.modes.times[i, 0] = work.powers[1, i]


@named_njit(inner=True, error_model="numpy", forceinline=True)
def _error_of_freezing(system, how, time, step, y, new, work):  # type: ignore[no-untyped-def]
    """Return the error of the position, m, due to constant relaxation times in a step.

    `y` and `new` are the states at the beginning and the end. The bead follows the slow velocity u
    with the delay tau. An error of tau causes a displacement: this error times the change of u in a
    step. The midpoint value of tau differs from the mean of both ends by half of its second
    difference. A sixth of its change is added because u and tau change together.
    """
    begin, end = work.chi[:3], work.chi[3:6]
    _relaxation_times(system, how, time, y, work, begin)
    _relaxation_times(system, how, time, new, work, end)
    most = 0.0
    for i in range(3):
        tau = y[y.size - how.inertia.size + i]
        off = 0.5 * abs(begin[i] + end[i] - 2.0 * tau) + abs(end[i] - begin[i]) / 6.0
        v = y[_MODES + i]
        change = abs(new[_MODES + i] - v) + abs(v - work.powers[i, 0])
        most = max(most, off * change * min(1.0, step / tau) if tau > 0.0 else 0.0)
    return most


@named_njit(inner=True, error_model="numpy", forceinline=True)
def _alike(modes, i):  # type: ignore[no-untyped-def]
    """Return whether the velocity modes along axis i equal those along axis i - 1.

    Equal axes share their matrix M; False for the first axis.
    """
    alike = i > 0
    for k in range(modes.times.shape[1]):
        alike &= modes.times[i, k] == modes.times[i - 1, k]
        alike &= modes.weights[i, k] == modes.weights[i - 1, k]
    return alike


@named_njit(inner=True, error_model="numpy", forceinline=True)
def _weigh_long(step, tau, weight, decay, rows):  # type: ignore[no-untyped-def]
    """Add the displacements by one mode to `rows` for a step much longer than its time tau.

    It uses the recursion of `modes.relaxed` for long times, for all nodes simultaneously. `step`
    and `tau` are in s, and `weight` is the share of the mode in the bead's velocity. `decay`
    (NODES,) is filled with the displacement at each node per initial velocity of the mode, s.
    Entry NODES m + j of `rows` is the displacement at node j per coefficient U_m of u, s.
    """
    for j in range(NODES):
        decay[j] = followed(PLACES[j] * step, tau)
    per, chi = lanes(_PER_PLACE, 0) * (-tau / step), lanes(decay, 0)
    store(decay, 0, chi * (weight * tau))
    for m in range(NODES):
        chi = chi * per + spread(INVERSE[m + 1])
        row = lanes(_POWERS, NODES * m) * (weight * step)
        store(rows, NODES * m, row * chi + lanes(rows, NODES * m))


@named_njit(inner=True, error_model="numpy", forceinline=True)
def _weigh(how, step, y, work):  # type: ignore[no-untyped-def]
    """Fill `work.M` and `work.base`: the positions at the nodes are X = base + M u.

    u is the slow velocity at the nodes, y the state at the beginning of the step of that length, s.
    The displacements by powers of time are found first, then by Legendre polynomials, then by
    values at nodes.
    """
    modes = how.modes.times.shape[1]
    chi, rows, M, decay = work.chi, work.rows, work.M, work.decay
    for i in range(3):
        alike = _alike(how.modes, i)
        if not alike:
            rows[:] = 0.0
            for k in range(modes):
                tau, weight = how.modes.times[i, k], how.modes.weights[i, k]
                if PLACES[0] * step > LONG * tau:
                    _weigh_long(step, tau, weight, decay[k], rows)
                    continue
                for j in range(NODES):
                    relaxed(PLACES[j] * step, tau, chi)
                    decay[k, j] = weight * tau * chi[0]
                    for m in range(NODES):
                        rows[NODES * m + j] += weight * step * _POWERS[NODES * m + j] * chi[m + 1]
        for j in range(NODES):
            work.base[i, j] = y[i]
            for k in range(modes):
                work.base[i, j] += decay[k, j] * y[_MODES + i * modes + k]
        work.first[i] = work.first[i - 1] if alike else _MATRIX * i
        if alike:
            continue
        for k in range(NODES - 1, -1, -1):  # of Legendre's polynomials instead of powers
            row = lanes(rows, 0) * TO_POWERS[k, 0]
            for m in range(1, k + 1):
                row = row + lanes(rows, NODES * m) * TO_POWERS[k, m]
            store(rows, NODES * k, row)
        for node in range(NODES):
            row = lanes(rows, 0) * TO_LEGENDRE[node, 0]
            for k in range(1, NODES):
                row = row + lanes(rows, NODES * k) * TO_LEGENDRE[node, k]
            store(M, _MATRIX * i + NODES * node, row)


@named_njit(inner=True, error_model="numpy", forceinline=True)
def _by_M(work, values, out):  # type: ignore[no-untyped-def]
    """Fill `out` with M values: the displacements at the nodes (m) by slow velocities there (m/s).

    values, out: (3 NODES,), and may be the same array.
    """
    for i in range(3):
        at, first = NODES * i, work.first[i]
        row = lanes(work.M, first) * values[at]
        for node in range(1, NODES):
            row = row + lanes(work.M, first + NODES * node) * values[at + node]
        store(out, at, row)


@named_njit(inner=True, error_model="numpy", forceinline=True)
def _by_gradient(gradient, values, out):  # type: ignore[no-untyped-def]
    """Fill `out` with J values: changes of u at the nodes (m/s) by displacements there (m).

    J is `gradient` (9 NODES,), 1/s; it couples the axes but not the nodes. `values` and `out` are
    (3 NODES,).
    """
    for i in range(3):
        row = lanes(gradient, _ALL * i) * lanes(values, 0)
        row = row + lanes(gradient, _ALL * i + NODES) * lanes(values, NODES)
        store(
            out, NODES * i, row + lanes(gradient, _ALL * i + 2 * NODES) * lanes(values, 2 * NODES)
        )


@named_njit(inner=True, error_model="numpy", forceinline=True)
def _foretell(how, step, work):  # type: ignore[no-untyped-def]
    """Predict u and the positions at the nodes by extrapolating the polynomial of the last step.

    The Legendre series is cut off where its terms at the end of this step begin to grow. The
    recursion of the polynomials runs at the nodes (x) and at the end of the step (end) together.
    """
    ratio = step / how.carried[0] if how.carried[0] > 0.0 else 0.0
    x = lanes(PLACES, 0) * (2.0 * ratio) + spread(2.0 * how.carried[3] - 1.0)
    end = 2.0 * (how.carried[3] + ratio) - 1.0
    one, two, before, last = spread(1.0), x, 1.0, end
    f = how.foretold
    u1, u2, u3 = spread(f[0]), spread(f[NODES]), spread(f[2 * NODES])
    size = size_before = np.inf
    for k in range(1, NODES):
        f1, f2, f3 = f[k], f[NODES + k], f[2 * NODES + k]
        term = max(abs(f1), abs(f2), abs(f3)) * abs(last)
        if term > max(size, size_before):
            break
        size_before, size = size, term
        u1, u2, u3 = u1 + two * f1, u2 + two * f2, u3 + two * f3
        up, down = _UP[k], _DOWN[k]
        one, two = two, x * two * up - one * down
        before, last = last, end * last * up - before * down
    u = work.u
    store(u, 0, u1)
    store(u, NODES, u2)
    store(u, 2 * NODES, u3)
    _by_M(work, u, work.place)
    for i in range(3):
        for j in range(NODES):
            work.place[NODES * i + j] += work.base[i, j]


@named_njit(inner=True, error_model="numpy", forceinline=True)
def _stay(how):  # type: ignore[no-untyped-def]
    """Replace the predicted u by a constant: the value that it has at the beginning of the step.

    This is the second attempt after extrapolation has led Newton's method astray. The step begins
    at the end (+1) or the beginning (-1) of the last polynomial, where the Legendre polynomials are
    1 or (-1)^k.
    """
    for i in range(3):
        value, sign = 0.0, 1.0
        for k in range(NODES):
            value += sign * how.foretold[NODES * i + k]
            how.foretold[NODES * i + k] = 0.0
            sign *= 2.0 * how.carried[3] - 1.0
        how.foretold[NODES * i] = value


@named_njit(inner=True, error_model="numpy", forceinline=True)
def _remember(how, step, origin, work):  # type: ignore[no-untyped-def]
    """Store the polynomial of u in a step of length `step` (s) to predict the next step.

    `origin` is where the next step begins: 1 for the end of this step, 0 for its start after a
    rejection.
    """
    for at in range(_ALL):
        how.foretold[at] = work.coefficients[at]
    how.carried[0], how.carried[3] = step, origin


@named_njit(inner=True, error_model="numpy", forceinline=True)
def _act(how, force, wrench, time, step, work):  # type: ignore[no-untyped-def]
    """Evaluate the force at the positions of all nodes; fill u and, if needed, the moments and J.

    `force` is compiled. `wrench` is its workspace, with gradients if J, the mobility times the
    force gradient (1/s), is needed. `time` and `step` are the beginning and length of the step (s).
    """
    place, position, u = work.place, work.pose.position, work.u
    store(work.pose.time, 0, lanes(PLACES, 0) * step + spread(time))
    for j in range(NODES):
        for i in range(3):
            position[j, i] = place[NODES * i + j]
    clear(wrench)
    add(force, work.pose, wrench)
    r1, r2, r3 = how.response[0], how.response[1], how.response[2]
    d1, d2, d3 = how.drift[0], how.drift[1], how.drift[2]
    for j in range(NODES):
        u[j] = d1 + r1 * wrench.force[j, 0]
        u[NODES + j] = d2 + r2 * wrench.force[j, 1]
        u[2 * NODES + j] = d3 + r3 * wrench.force[j, 2]
    if how.turn != 0:
        for j in range(NODES):
            for i in range(3):
                work.moment[NODES * i + j] = wrench.moment[j, i]
    if len(wrench.force_gradient) > 0:
        J, G = work.gradient, wrench.force_gradient
        for j in range(NODES):
            for k in range(3):
                J[NODES * k + j] = r1 * G[j, 0, k]
                J[_ALL + NODES * k + j] = r2 * G[j, 1, k]
                J[2 * _ALL + NODES * k + j] = r3 * G[j, 2, k]


@named_njit(inner=True, error_model="numpy", forceinline=True)
def _kink(how, time, step, work):  # type: ignore[no-untyped-def]
    """Return the fraction of the step at which the bead enters another region of the force, or 1.

    The force is smooth only within a region. Regions are compared at the predicted positions of the
    nodes, so a crossing before the first node or after the last one is not seen. The crossing
    between two nodes is found by bisection on the polynomial of the positions.
    """
    for j in range(NODES):
        work.pose.time[j] = time + PLACES[j] * step
        work.plain.error[j] = 0.0
        for i in range(3):
            work.pose.position[j, i] = work.place[NODES * i + j]
    add(how.regions, work.pose, work.plain)
    region, after = work.plain.error[0], 1
    while after < NODES and work.plain.error[after] == region:
        after += 1
    if after == NODES:
        return 1.0
    _by_legendre(work.place, work.change)
    for i in range(3):
        _powers(work.change, NODES * i, work.powers[i])
    pose = Pose(work.pose.time[:1], work.pose.position[:1], work.pose.orientation, work.pose.drive)
    none = work.plain.force_gradient
    found = Wrench(work.plain.force[:1], work.plain.moment[:1], none, none, work.plain.error[:1])
    low, high = PLACES[after - 1], PLACES[after]
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        pose.time[0] = time + middle * step
        for i in range(3):
            value = work.powers[i, NODES - 1]
            for m in range(NODES - 2, -1, -1):
                value = work.powers[i, m] + value * middle * _OVER[m]
            pose.position[0, i] = value
        found.error[0] = 0.0
        add(how.regions, pose, found)
        if found.error[0] == region:
            low = middle
        else:
            high = middle
    return high


@named_njit(inner=True, error_model="numpy", forceinline=True)
def _by_legendre(values, out):  # type: ignore[no-untyped-def]
    """Fill `out` with the Legendre coefficients of polynomials along the three axes.

    values: (3 NODES,) values at the nodes. out: (3 NODES,), coefficient k of axis i at NODES i + k.
    """
    for i in range(3):
        row = lanes(_flat_legendre, 0) * values[NODES * i]
        for node in range(1, NODES):
            row = row + lanes(_flat_legendre, NODES * node) * values[NODES * i + node]
        store(out, NODES * i, row)


@named_njit(inner=True, error_model="numpy", forceinline=True)
def _eliminate(work):  # type: ignore[no-untyped-def]
    """Factorise the transposed matrix 1 - M J into `work.lower` and `work.upper`, without pivoting.

    J, the gradient of u, is negative in a trap, and the eigenvalues of M, from u to displacements,
    have positive real parts. So no pivot is small.
    """
    upper, lower, M, J = work.upper, work.lower, work.M, work.gradient
    for k in range(3):
        for node in range(NODES):
            row = (NODES * k + node) * _ALL
            for i in range(3):
                of = -J[NODES * (3 * i + k) + node]
                store(upper, row + NODES * i, lanes(M, work.first[i] + NODES * node) * of)
            upper[row + NODES * k + node] += 1.0
    for p in range(_ALL):
        per_pivot = 1.0 / upper[p * _ALL + p]
        for r in range(p + 1, _ALL):
            row = r * _ALL
            factor = upper[row + p] * per_pivot
            lower[row + p] = factor
            for at in range(p - p % NODES, _ALL, NODES):
                store(
                    upper, row + at, lanes(upper, row + at) - lanes(upper, p * _ALL + at) * factor
                )


@named_njit(inner=True, error_model="numpy", forceinline=True)
def _by_factors(work):  # type: ignore[no-untyped-def]
    """Solve (1 - M J) correction = residual with the factors of `_eliminate`.

    These are factors of the transposed matrix, so substitution begins with the columns of `upper`.
    """
    d, left = work.correction, work.change
    for at in range(_ALL):
        left[at] = work.residual[at]
    for p in range(_ALL):
        d[p] = left[p] / work.upper[p * _ALL + p]
        for at in range(p - p % NODES, _ALL, NODES):
            store(left, at, lanes(left, at) - lanes(work.upper, p * _ALL + at) * d[p])
    for r in range(_ALL - 1, 0, -1):
        for at in range(0, r, NODES):
            store(d, at, lanes(d, at) - lanes(work.lower, r * _ALL + at) * d[r])


@named_njit(inner=True, error_model="numpy", forceinline=True)
def _correct(work, close):  # type: ignore[no-untyped-def]
    """Solve (1 - M J) d = residual for `work.correction`; return whether elimination was used.

    d is the change of the positions at the nodes (m), M maps u to displacements, and J is the
    gradient of u. The iteration d = residual + M J d is tried first, and ends when d changes by
    less than `close` (m). Elimination replaces it where it converges slowly.
    """
    d, change, residual = work.correction, work.change, work.residual
    before = np.inf
    for at in range(_ALL):
        d[at] = residual[at]
    for _ in range(_ROUNDS):
        _by_gradient(work.gradient, d, change)
        _by_M(work, change, change)
        most = 0.0
        for at in range(_ALL):
            new = residual[at] + change[at]
            most = max(most, abs(new - d[at]))
            d[at] = new
        if most <= close:
            return False
        if not most < _SLOW * before:
            break
        before = most
    _eliminate(work)
    _by_factors(work)
    return True


@named_njit(inner=True, error_model="numpy", forceinline=True)
def _expand(work):  # type: ignore[no-untyped-def]
    """Fill the Legendre coefficients of u; return the estimated error of the polynomial, m/s.

    The estimate is the largest of the last two coefficients of each axis, reduced by the ratio at
    which the coefficients decrease.
    """
    coefficients = work.coefficients
    _by_legendre(work.u, coefficients)
    last = before = 0.0
    for i in range(3):
        end = NODES * (i + 1)
        last = max(last, abs(coefficients[end - 1]), abs(coefficients[end - 2]))
        before = max(before, abs(coefficients[end - 3]), abs(coefficients[end - 4]))
    return last * min(last / before, 1.0) if before > 0.0 else last


@named_njit(inner=True, error_model="numpy", forceinline=True)
def _contracting(J):  # type: ignore[no-untyped-def]
    """Return whether neighbouring paths of the bead approach each other at every node.

    J: (9 NODES,) gradient of u, 1/s. They do if its symmetric part is negative definite, which
    Gershgorin's circles show: each diagonal element plus the moduli beside it must not be positive.
    """
    for i in range(3):
        k, l = (i + 1) % 3, (i + 2) % 3
        for j in range(NODES):
            beside = abs(J[NODES * (3 * i + k) + j] + J[NODES * (3 * k + i) + j])
            beside += abs(J[NODES * (3 * i + l) + j] + J[NODES * (3 * l + i) + j])
            if J[NODES * 4 * i + j] + 0.5 * beside > 0.0:
                return False
    return True


@named_njit(inner=True, error_model="numpy", forceinline=True)
def _allowed(how, control, work):  # type: ignore[no-untyped-def]
    """Return the error of the position that is allowed in a step, m.

    It is the tolerance, reduced in proportion to the speed where errors grow (paths do not approach
    each other), but at most by `_SLOWEST`, and never below rounding.
    """
    speed = far = 0.0
    for i in range(3):
        speed += work.coefficients[NODES * i] ** 2
        far = max(far, abs(work.place[NODES * i]))
    part = 1.0
    if not _contracting(work.gradient):
        part = min(max(math.sqrt(speed) / how.fastest, _SLOWEST), 1.0)
    return max(part * (control.absolute[0] + control.relative * far), _ROUNDING * far)


@named_njit(inner=True, error_model="numpy", forceinline=True)
def _collocate(system, how, control, time, step, adaptive, work, counts):  # type: ignore[no-untyped-def]
    """Solve u = u(X) at the nodes by Newton's method; return the error over the allowed error.

    A negative result reports that Newton's method failed; its modulus is the factor by which to
    shorten the step. `time` and `step` are the beginning and length of the step (s). If `adaptive`,
    the tolerances choose the steps, and a step is given up as soon as its error is too large.
    `counts[2]`, the number of force evaluations, is increased. On entry `work` contains M, base and
    the prediction; on return u and the positions.
    """
    solved = _SOLVED if adaptive else _SOLVED_WELL
    eliminated, size, error, allowed = False, 0.0, 0.0, 0.0
    for correction in range(_CORRECTIONS):
        first = correction == 0 or not adaptive
        force = system.force if first else how.plain
        _act(how, force, work.wrench if first else work.plain, time, step, work)
        counts[2] += NODES
        if correction == 0:
            _expand(work)
            allowed = _allowed(how, control, work)
        _by_M(work, work.u, work.residual)
        for i in range(3):
            for j in range(NODES):
                at = NODES * i + j
                work.residual[at] += work.base[i, j] - work.place[at]
        if eliminated and adaptive:
            _by_factors(work)
        else:
            eliminated = _correct(work, _ITERATED * allowed)
        _by_gradient(work.gradient, work.correction, work.change)
        before, size = size, 0.0
        for at in range(_ALL):
            work.u[at] += work.change[at]
            work.place[at] += work.correction[at]
            size = max(size, abs(work.correction[at]))
        if not all_finite(work.u):
            return -_SHRINK
        error = 0.5 * step * _expand(work) / (2 * NODES + 1) / allowed
        if adaptive and error > _HOPELESS:
            return error
        if correction == 0:
            if how.turn != 0:
                _correct_moments(work)
            # error by the curvature of the force, estimated from the last step with two corrections
            left = _CAUTION * how.carried[2] * size * size
            if adaptive and 0.0 < left < allowed:
                return error
            continue
        if correction == 1 and before > 0.0:
            how.carried[2] = size / (before * before)
        small = size <= solved * allowed
        if small or (adaptive and size * size < _CONVERGING * allowed * before):
            return error
        if size > _SLOW * before:
            if size <= (_SOLVED if adaptive else 1.0) * allowed:  # as well as the force is known
                return error
            break
    return -_UNSOLVED


@named_njit(inner=True, error_model="numpy", forceinline=True)
def _correct_moments(work):  # type: ignore[no-untyped-def]
    """Add the change of the moments by the last correction of the positions, to first order."""
    for j in range(NODES):
        for i in range(3):
            for k in range(3):
                change = work.wrench.moment_gradient[j, i, k] * work.correction[NODES * k + j]
                work.moment[NODES * i + j] += change


@named_njit(inner=True, error_model="numpy", forceinline=True)
def _powers(coefficients, first, out):  # type: ignore[no-untyped-def]
    """Fill `out` (NODES,) with the U_m of a polynomial sum_m U_m (s/h)^m/m! on a step of length h.

    The Legendre coefficients of this polynomial begin at the index `first` of `coefficients`.
    """
    for m in range(NODES):
        out[m] = 0.0
        for k in range(m, NODES):
            out[m] += coefficients[first + k] * TO_POWERS[k, m]


@named_njit(inner=True, error_model="numpy", forceinline=True)
def _to(modes, s, step, y, powers, chi, out):  # type: ignore[no-untyped-def]
    """Fill `out` with the position and mode velocities at a time s (s) after a step began.

    `step` is its length (s), `y` the state when it began, `powers` (6, NODES) the coefficients U_m
    of the slow velocity, and `chi` (NODES + 1,) workspace. The Euler parameters in `out` (state,)
    are not computed here.
    """
    axes, many = modes.times.shape
    for i in range(3):
        out[i] = y[i]
    for k in range(many):
        for i in range(axes):
            tau, weight, at = modes.times[i, k], modes.weights[i, k], _MODES + i * many + k
            if weight == 0.0:  # a rotation has fewer modes
                out[at] = 0.0
                continue
            if i == 0 or tau != modes.times[i - 1, k]:
                relaxed(s, tau, chi)
            if i < 3:
                out[i] += displacement(s, s / step, tau, weight, y[at], powers[i], chi)
            out[at] = velocity(s / step, y[at], powers[i], chi)


@named_njit(inner=True, error_model="numpy", forceinline=True)
def _advance(  # type: ignore[no-untyped-def]
    system, how, control, y, clock, counts, records, work, new
):
    """Take steps until the run ends or the records are full; see `loop` for arguments and result.

    work, new: workspace, and an array (state,) for the state at the end of a step. Each round
    predicts u, shortens the step to a kink of the force, solves for u at the nodes, estimates the
    error and either stores the step or repeats it with another length.
    """
    adaptive = by_tolerance(control)
    many = how.modes.times.shape[0]
    turns = many == 6
    written = 0
    if clock[1] == 0.0:
        clock[1] = control.fixed if control.fixed > 0.0 else how.first
        how.carried[1] = how.carried[2] = 0.0
    while True:
        time = clock[0]
        step, last, why = step_to_try(control, clock, counts, records.begin.size - written)
        if why != GOING_ON:
            return written, why
        if how.inertia.size > 0:
            _freeze(system, how, time, step, y, work)
        error, looked, again = -1.0, not adaptive or how.regions.kernel == 0, False
        while error < 0.0:
            _weigh(how, step, y, work)
            _foretell(how, step, work)
            if not looked:
                looked, kink = True, _kink(how, time, step, work)
                if kink < 1.0:
                    step, last = kink * step, False
                    continue
            error = _collocate(system, how, control, time, step, adaptive, work, counts)
            if again:
                break
            if error < 0.0:  # second attempt, from a constant u
                _stay(how)
                again = True
        if error >= 0.0:
            for i in range(3):
                _powers(work.coefficients, NODES * i, work.powers[i])
            if turns:
                _spin(how, work)
                error = max(error, _turning_error(control, step, work))
            if how.inertia.size > 0:
                _to(how.modes, step, step, y, work.powers, work.chi, new)
                frozen = _error_of_freezing(system, how, time, step, y, new, work)
                allowed = _allowed(how, control, work)
                error = max(error, (frozen / allowed) ** (_ORDER / _ORDER_OF_FREEZING))
        if error < 0.0 and not adaptive:
            return written, COLLAPSED if all_finite(work.u) else NOT_FINITE
        if error < 0.0 or (adaptive and not error <= 1.0):
            counts[1] += 1
            factor = -error if error < 0.0 else _SAFETY * error ** (-1.0 / _ORDER)
            if all_finite(work.u):  # its own polynomial predicts the shorter step
                _remember(how, step, 0.0, work)
            clock[1] = step * max(factor, _SHRINK)
            if error < 0.0 and not all_finite(work.u) and not step > 1e-12 * control.end:
                return written, NOT_FINITE
            continue
        records.begin[written] = time
        records.length[written] = step
        for i in range(y.size):
            records.state[written, i] = y[i]
        for i in range(many):
            for m in range(NODES):
                records.shape[written, i, m] = work.powers[i, m]
        _to(how.modes, step, step, y, work.powers, work.chi, new)
        if turns:
            e, allowed = _MODES + how.modes.times.size, control.absolute[control.orientation]
            before, after = y[e : e + EULER], new[e : e + EULER]
            call(how.turn, (how.modes, step, y[_MODES:], work.powers, before, allowed, after))
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

    A `Relaxation` replaces the tableau. The state y contains the position, the velocities of the
    modes by axis and, for a rotation, the Euler parameters; angular velocities are in the inertial
    frame. The dense output of a step, `Records.shape`, contains the coefficients U_m.
    """

    def advance(  # type: ignore[no-untyped-def]
        system, how, control, y, clock, counts, records
    ):
        """Allocate the workspace, and take steps by `_advance`."""
        work, new = _room(how.modes.times.shape[1]), np.empty(y.size)
        found = _advance(*borrowed((system, how, control, y, clock, counts, records, work, new)))
        # `borrowed` drops the reference counts: this use keeps the workspace allocated until here
        work.place[0] = new[0]
        return found

    typed = signature(_RELAXATION)
    return cached_njit(typed, error_model="numpy", nogil=True)(advance)


@named_njit(inner=True, error_model="numpy", forceinline=True)
def _spin(how, work):  # type: ignore[no-untyped-def]
    """Fill `work.powers[3:]` with the U_m of the slow angular velocity by the moments at the nodes.

    The moments in `work.moment` are overwritten by torque times mobility, rad/s.
    """
    for i in range(3):
        for j in range(NODES):
            work.moment[NODES * i + j] *= how.response[3 + i]
    _by_legendre(work.moment, work.change)
    for i in range(3):
        _powers(work.change, NODES * i, work.powers[3 + i])


@named_njit(inner=True, error_model="numpy", forceinline=True)
def _turning_error(control, step, work):  # type: ignore[no-untyped-def]
    """Return the error of the angle turned in a step over the tolerance of the orientation.

    The error is estimated by the last two Legendre coefficients of the slow angular velocity, which
    `_spin` left in `work.change`.
    """
    most = 0.0
    for i in range(3):
        end = NODES * (i + 1)
        most = max(most, abs(work.change[end - 1]), abs(work.change[end - 2]))
    return 0.5 * step * most / (2 * NODES + 1) / control.absolute[control.orientation]


@cached_njit(error_model="numpy")
def sample(times, begin, length, state, shape, modes, allowed, out):  # type: ignore[no-untyped-def]
    """Fill `out` (n, state) with the states at ascending `times` (n,), s, from recorded steps.

    `begin`, `length`, `state` and `shape` are the fields of `Records`. `modes` are the relaxation
    times and weights; the times are overwritten where the drag depends on the position. `allowed`
    is the tolerance of the orientation, rad.
    """
    chi, end = np.empty(NODES + 1), np.empty(4)
    step, parts = 0, 0
    turning = len(modes.times) == 6
    e = _MODES + modes.times.size
    frozen = e + EULER if turning else e  # where the relaxation times of a drag by place are
    for at in range(times.size):
        while step + 1 < begin.size and times[at] >= begin[step + 1]:
            step += 1
            parts = 0
        for i in range(state.shape[1] - frozen):
            modes.times[i, 0] = state[step, frozen + i]
        s = times[at] - begin[step]
        _to(modes, s, length[step], state[step], shape[step], chi, out[at])
        if turning:
            v, begin_of_step = state[step, _MODES:], state[step, e : e + EULER]
            now = out[at, e : e + EULER]
            if parts == 0:
                parts = parts_of(modes, length[step], v, shape[step], begin_of_step, allowed, end)
            turned(modes, s, parts, length[step], v, shape[step], begin_of_step, now)


class Exponential:
    """Exponential collocation at Gauss nodes, as a method of integration."""

    def bound(self, equations: Equations) -> Bound:
        """Return the method bound to equations of motion, whose drag it treats exactly."""
        if equations.body is not None:
            from tweezer.dynamics.integrators.exponential_body import bound_to

            return bound_to(equations)
        relaxation = equations.relaxation._replace(
            turn=address(turn_over, TURN) if "orientation" in equations.layout else 0,
        )
        emitted = equations.layout
        start = _in_inertial_frame(equations.initial_state, relaxation.modes, emitted)
        start = np.append(start, np.zeros(relaxation.inertia.size))
        if equations.begin is not None:
            start = equations.begin.inner.copy()
        relaxation = _begun(equations, relaxation, start)
        allowed = 0.0
        if "orientation" in emitted:
            allowed = equations.absolute_tolerance[emitted.first("orientation")]
        many = len(relaxation.modes.times)
        weights = relaxation.modes.weights
        carried = Layout({"position": _MODES, "modes": weights.size, "orientation": EULER})

        def inner(records: Records, times: Array) -> Array:
            out = np.zeros((len(times), records.state.shape[1]))
            sample(times, *records, relaxation.modes, allowed, out)
            return out

        def states(records: Records, times: Array) -> Array:
            return _emitted(inner(records, times), weights, carried, emitted)

        return Bound(
            loop(),
            relaxation,
            start,
            (many, NODES),
            states,
            True,
            1,
            bound(equations.moving, gradient=True),
            rates=False,
            inner=inner,
        )


EXPONENTIAL = Exponential()


def _begun(equations: Equations, how: Relaxation, y: Array) -> Relaxation:
    """Return the relaxation with the first step, and the initial force as its prediction.

    In the first step the force changes little and the initial relaxation of the velocity is
    resolved, where it moves the bead noticeably. y: (state,) initial state in the form that the
    loop uses.
    """
    at = equations.moving.field(y[None, POSITION], gradient=True, time=equations.begin_time)
    u = how.drift + how.response[TRANSLATION] * at.force[0]
    foretold = np.zeros(3 * NODES)
    foretold[::NODES] = u
    rate = float(np.abs(how.response[TRANSLATION, None] * at.force_gradient[0]).max())
    part = min(max(float(np.linalg.norm(u)) / how.fastest, _SLOWEST), 1.0)
    allowed = part * float(equations.absolute_tolerance[0])
    times, weights = how.modes.times[TRANSLATION], how.modes.weights[TRANSLATION]
    v = y[_MODES : _MODES + times.size].reshape(times.shape)
    seen = rate * np.abs(weights) * times**2 * np.abs(v - u[:, None]) > _UNSEEN * allowed
    v[times == 0] = np.broadcast_to(u[:, None], times.shape)[times == 0]
    layer = _LAYER if times.shape[1] == 1 else _LAYERS
    first = layer * float(times[seen].min(initial=math.inf))
    return how._replace(
        first=min(first, _FIRST / rate if rate > 0.0 else _FOREVER), foretold=foretold,
        carried=np.array([0.0, 0.0, 0.0, 1.0]),
    )  # fmt: skip


def _in_inertial_frame(state: Array, modes: Modes, emitted: Layout) -> Array:
    """Return the state in the form of the loop, from one in the form of the emitted equations.

    The result contains the position, the velocities of the modes (angular ones in the inertial
    frame) and the Euler parameters. The initial velocity is divided among the modes as after an
    impulse on a bead in fluid at rest.
    """
    rates, e = np.zeros(len(modes.times)), np.zeros(0)
    if "orientation" in emitted:
        e = state[emitted.at("orientation")]
    if "velocity" in emitted:
        rates[TRANSLATION] = state[emitted.at("velocity")]
    if "angular_velocity" in emitted:
        rates[ROTATION] = _rotation(e) @ state[emitted.at("angular_velocity")]
    v = np.repeat(rates[:, None], modes.times.shape[1], axis=1)
    if modes.times.shape[1] > 1 and modes.times[0, 0] == 0:  # without inertia
        v[TRANSLATION] = 0.0
    elif modes.times.shape[1] > 1:
        v[TRANSLATION] *= Modes(modes.times[0], modes.weights[0]).struck
    return np.concatenate([state[POSITION], v.ravel(), e])


def _emitted(y: Array, weights: Array, carried: Layout, emitted: Layout) -> Array:
    """Return states (n, state) in the form of the emitted equations, from those of the loop.

    This is the inverse of `_in_inertial_frame`. `weights` (axes, modes) sum the modes to the
    velocity. `carried` is the layout of the states of the loop.
    """
    rotates = "orientation" in emitted
    if weights.shape[1] == 1 and not rotates:
        return y[:, : emitted.width]  # unchanged, or without the velocities if the model has none
    rates = (y[:, carried.at("modes")].reshape(-1, *weights.shape) * weights).sum(axis=2)
    states = np.empty((len(y), emitted.width))
    parts = {"position": y[:, POSITION], "velocity": rates[:, TRANSLATION]}
    if rotates:
        e = parts["orientation"] = y[:, carried.at("orientation")]
        if "angular_velocity" in emitted:
            turning = zip(rates[:, ROTATION], e, strict=True)
            omega = [row @ _rotation(each) for row, each in turning]
            parts["angular_velocity"] = np.array(omega).reshape(-1, 3)
    for name in emitted.blocks:
        states[:, emitted.at(name)] = parts[name]
    return states


def _rotation(e: Array) -> Array:
    """Return the rotation matrix R (3, 3) of the Euler parameters e (4,) (A.2)."""
    matrix = np.empty((3, 3))
    kinematics.rotation_matrix(np.ascontiguousarray(e), matrix)
    return matrix


_none, _table = np.zeros(0), np.zeros((0, 0))
_nothing = Part(0, packed())
_RELAXATION = typeof(
    Relaxation(_nothing, Modes(_table, _table), 0, _nothing, _none, _none, 0.0, 0.0, *[_none] * 3)
)
