"""Parts shared by all compiled methods: the force and rates in a state, step control, records.

A loop is compiled once for a method. It receives the force and the emitted rates as addresses, so
it works for any force, model and bead.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple, Protocol

import numpy as np
from numba import typeof, types

from tweezer.compiled import call, named_njit
from tweezer.dynamics.body import BodyMotion
from tweezer.dynamics.continuing import Begin
from tweezer.dynamics.layout import EULER, Layout
from tweezer.fluid import Mobility
from tweezer.forces.data import Part, packed
from tweezer.forces.force import Force, Pose, Wrench, add, clear
from tweezer.scene import Scene
from tweezer.scene.bead import BeadProperties
from tweezer.values.arrays import Array

# status with which a call of a loop ended; or that it has not ended
REACHED, FULL, COLLAPSED, NOT_FINITE, EXHAUSTED, GOING_ON = range(6)

#: Smallest factor from one step to the next
_SHRINK = 0.2
#: Safety factor of the next step
_SAFETY = 0.9
#: Largest rounding error of the clock, as a part of the end time
_ROUNDING = 1e-14

_f8 = types.float64
_vector, _matrix = _f8[::1], _f8[:, ::1]
_inputs = (_f8, _vector, _vector, _vector, _matrix, _matrix, _vector)
#: `rates` and `derivatives` of the emitted modules
RATES = types.void(*_inputs, _vector, _vector)
DERIVATIVES = types.void(*_inputs, _matrix, _vector, _matrix)


class System(NamedTuple):
    """Force, drag and equations of motion of the bead, as a compiled loop receives them."""

    force: Part
    """compiled force with its data"""
    drag: Part
    """compiled mobility of the bead with its data"""
    uniform: bool
    """whether the drag is independent of the position: it is then evaluated once"""
    rates: int
    """address of the emitted function `rates` (signature `RATES`); 0 for a loop that does not call
    it
    """
    derivatives: int
    """address of the emitted function `derivatives` (signature `DERIVATIVES`); 0 for a loop that
    does not call it
    """
    params: Array
    """(parameters,) constants of the emitted module, e.g. mass and moment of inertia, in its order
    """
    orientation: int
    """index of the first Euler parameter e in the state, if the force depends on the orientation;
    else -1
    """


class Control(NamedTuple):
    """Tolerances, prescribed steps and limits by which a compiled loop chooses its steps."""

    relative: float
    """relative tolerance of the state in a step"""
    absolute: Array
    """(state,) absolute tolerance of each component of the state, in its unit"""
    fixed: float
    """length of all steps, s; 0 for steps chosen by the tolerances"""
    prescribed: Array
    """(n,) lengths of all steps of the run, s, which take precedence over the others; (0,) for none
    """
    end: float
    """time at which the run ends, s"""
    most_calls: int
    """largest number of evaluations of the force in the whole run"""
    orientation: int
    """index of the first Euler parameter e in the state; -1 without a rotation"""
    euler_rates: int
    """index of the first time derivative of e in the state; -1 if it is not part of the state"""


class Records(NamedTuple):
    """Completed steps of a loop with their dense output, from which `sample` computes states."""

    begin: Array
    """(n,) time at the beginning of each step, s"""
    length: Array
    """(n,) length of each step, s"""
    state: Array
    """(n, state) state at the beginning of each step"""
    shape: Array
    """(n, ...) coefficients of the dense output of each step, of the shape `Bound.shape`"""


class At(NamedTuple):
    """Workspace for the force on one bead.

    `pose`, `wrench` and `resisted` are arrays for many beads of which the length is 1, as the
    compiled forces and drags expect. The other fields are views of their only element.
    """

    pose: Pose
    """time, position and orientation of the bead"""
    wrench: Wrench
    """force (N), torque (N m) and their gradients"""
    resisted: Mobility
    """mobility and its gradient"""
    force: Array
    """(3,) N"""
    moment: Array
    """(3,) N m"""
    force_gradient: Array
    """(3, 3) derivative of force i by coordinate k, N/m"""
    moment_gradient: Array
    """(3, 3) derivative of torque i by coordinate k, N"""
    mobility: Array
    """(5,) the components of `Mobility.value`"""
    mobility_gradient: Array
    """(5, 3) their derivatives by the coordinates"""


@named_njit(inner=True, error_model="numpy")
def scratch(system):  # type: ignore[no-untyped-def]
    """Allocate the workspace `At` of a loop, with the mobility if it is the same everywhere."""
    turned = 1 if system.orientation >= 0 else 0
    pose = Pose(np.zeros(1), np.zeros((1, 3)), np.zeros((turned, 4)), np.zeros((0, 3)))
    wrench = Wrench(
        np.zeros((1, 3)), np.zeros((1, 3)), np.zeros((1, 3, 3)), np.zeros((1, 3, 3)), np.zeros(1)
    )
    mobility = Mobility(np.zeros((1, 5)), np.zeros((1, 5, 3)))
    if system.uniform:
        call(system.drag.kernel, (pose, system.drag.data, mobility))
    return At(
        pose, wrench, mobility, wrench.force[0], wrench.moment[0], wrench.force_gradient[0],
        wrench.moment_gradient[0], mobility.value[0], mobility.gradient[0],
    )  # fmt: skip


@named_njit(inner=True, error_model="numpy")
def act(system, at, time, y):  # type: ignore[no-untyped-def]
    """Evaluate force, torque and mobility in a state and store them in the workspace `at`.

    `system` is a `System`, `time` is in s, and `y` (state,) begins with the position (m). If the
    force depends on the orientation, the Euler parameters begin at `system.orientation`. They are
    normalised before use.
    """
    if system.orientation >= 0:
        e = y[system.orientation : system.orientation + EULER]
        size = math.sqrt(e[0] ** 2 + e[1] ** 2 + e[2] ** 2 + e[3] ** 2)
        for i in range(4):  # arithmetic of whole arrays takes two seconds to compile
            at.pose.orientation[0, i] = e[i] / size
    at.pose.time[0] = time
    for i in range(3):
        at.pose.position[0, i] = y[i]
    clear(at.wrench)
    add(system.force, at.pose, at.wrench)
    if not system.uniform:
        call(system.drag.kernel, (at.pose, system.drag.data, at.resisted))


@named_njit(inner=True, error_model="numpy")
def rate_of_change(system, at, time, y, out):  # type: ignore[no-untyped-def]
    """Fill `out` (state,) with the time derivative of the state `y`.

    The force and the mobility at this time (s) and state are evaluated first, into the workspace
    `at` from `scratch`. The emitted equations of motion, `system.rates`, turn them into the
    derivative.
    """
    act(system, at, time, y)
    call(
        system.rates,
        (
            time, y, at.force, at.moment, at.force_gradient, at.moment_gradient, at.mobility,
            system.params, out,
        ),
    )  # fmt: skip


@named_njit(inner=True, error_model="numpy")
def all_finite(values):  # type: ignore[no-untyped-def]
    """Return whether all elements of a contiguous array are finite, without allocating a temporary.

    0 times a number is 0 if it is finite and NaN otherwise, so that the sum of these is 0 only if
    all are.
    """
    total = 0.0
    for value in values.flat:
        total += 0.0 * value
    return total == 0.0


@named_njit(inner=True, error_model="numpy")
def put_on_constraints(y, orientation, euler_rates):  # type: ignore[no-untyped-def]
    """Restore |e| = 1 (A.21) and e.e' = 0 (A.22) of the Euler parameters in the state `y`, in
    place.

    orientation, euler_rates: index of the first component of e and of its time derivative e' in y;
    the latter is -1 if y does not contain e'. This replaces the stabilising terms of (A.26), and
    does not rotate the bead: it changes e and e' only along e.
    """
    squared = 0.0
    for i in range(4):
        squared += y[orientation + i] ** 2
    if euler_rates >= 0:
        along = 0.0
        for i in range(4):
            along += y[orientation + i] * y[euler_rates + i]
        for i in range(4):
            y[euler_rates + i] -= y[orientation + i] * along / squared
    for i in range(4):
        y[orientation + i] /= math.sqrt(squared)


@named_njit(inner=True, error_model="numpy")
def by_tolerance(control):  # type: ignore[no-untyped-def]
    """Return whether the loop chooses its steps by the tolerances: none are fixed or prescribed."""
    return control.fixed == 0.0 and control.prescribed.size == 0


@named_njit(inner=True, error_model="numpy")
def step_to_try(control, clock, counts, room):  # type: ignore[no-untyped-def]
    """Return the next step (s), whether it is the last of the run, and a status.

    The status is `GOING_ON` if the step can be taken. Otherwise it is the reason to stop:
    `REACHED`, `FULL`, `COLLAPSED` or `EXHAUSTED`. `clock` begins with the time and the step to try
    (s), and `counts` are steps, rejected steps and force calls. `room` is the number of records
    that still fit.
    """
    time, step = clock[0], clock[1]
    left = control.end - time
    if left <= 0.0:
        return step, False, REACHED
    if room == 0:
        return step, False, FULL
    last = False
    if control.prescribed.size > 0:
        step = control.prescribed[counts[0]]
        last = counts[0] == control.prescribed.size - 1
        # a remainder before a kink that is due to rounding of the clock is not a separate step
        last |= left - step <= _ROUNDING * control.end
    last |= step >= left * (1.0 - 1e-12)
    if last:
        step = left
    if not time + step > time:  # too short to change the time
        return step, last, COLLAPSED
    if counts[2] > control.most_calls:
        return step, last, EXHAUSTED
    return step, last, GOING_ON


@named_njit(inner=True, error_model="numpy")
def next_step(step, error, before, order, growth, rejected):  # type: ignore[no-untyped-def]
    """Return the length of the next step, s, by proportional-integral (PI) control of the error.

    The last attempt had the length `step` (s) and the `error`, over the tolerance; above 1 it is
    rejected. `before` is the error of the last accepted step. The error scales with the power
    `order` of the step, and `growth` is the largest factor between steps. If an attempt was just
    `rejected`, the step does not grow. See Gustafsson, ACM Trans. Math. Softw. 17:533 (1991), with
    the exponents of Hairer and Wanner.
    """
    if error == np.inf:
        return 0.1 * step
    if error > 1.0:
        return step * max(_SHRINK, _SAFETY * error ** (-1.0 / order))
    error = max(error, 1e-10)
    factor = _SAFETY * error ** (-0.7 / order) * max(before, 1e-4) ** (0.4 / order)
    return step * min(max(factor, _SHRINK), 1.0 if rejected else growth)


class Equations(Protocol):
    """Properties of the equations of motion, `tweezer.dynamics.models.EquationsOfMotion`, that
    methods read.
    """

    layout: Layout
    """names and indices of the components of a state"""
    initial_state: Array
    """(state,) state at the release of the bead"""
    begin: Begin | None
    """state from which an earlier run is continued; None for a run from the release"""
    absolute_tolerance: Array
    """(state,) absolute tolerance of each component of a state, in its unit"""
    scene: Scene
    """scene of the motion"""
    bead: BeadProperties
    """mass and weight of the bead"""

    @property
    def body(self) -> BodyMotion | None:
        """Drag and inertia of a body that is no sphere; None for a sphere."""

    @property
    def begin_time(self) -> float:
        """Time since the release at which the integration begins, s."""

    @property
    def moving(self) -> Force:
        """Force that drives the bead with the constant mobilities of `relaxation`.

        It is the force on the bead, unless the drag depends on the position. Then it is the force
        that gives the same velocity with the constant mobilities.
        """

    @property
    def name(self) -> str:
        """Name of the model of motion."""

    @property
    def relaxation(self) -> Any:
        """Modes of the velocity and mobilities for the exponential method, an
        `exponential.Relaxation`.
        """


class Bound(NamedTuple):
    """Method of integration bound to equations of motion."""

    loop: Any
    """compiled function that takes the steps, see `explicit.loop`"""
    how: Any
    """data of the method that the loop receives, a `Tableau` or a `Relaxation`"""
    start: Array
    """(state,) initial state in the form that the loop uses"""
    shape: tuple[int, ...]
    """shape of the dense output of one step"""
    states: Callable[[Records, Array], Array]
    """states of the emitted module, (n, state), at ascending times within records"""
    gradient: bool = False
    """whether the loop takes the gradients of the force, whatever the emitted module takes"""
    calls: int = 0
    """number of positions at which the force was evaluated while binding"""
    force: Part | None = None
    """force that the loop evaluates; None for the force of the equations"""
    rates: bool = True
    """whether the loop calls the emitted function `rates`"""
    inner: Callable[[Records, Array], Array] | None = None
    """as `states`, but returns the states in the form that the loop uses; None if both forms are
    the same
    """


def signature(method: types.Type) -> Any:
    """Return the Numba signature shared by all loops; `method` is the type of `Bound.how`.

    The loop returns the number of records written and the status with which it stopped.
    """
    return types.Tuple((types.int64, types.int64))(
        SYSTEM,
        method,
        typeof(Control(0.0, np.zeros(0), 0.0, np.zeros(0), 0.0, 0, 0, 0)),
        _vector,
        _vector,
        types.int64[::1],
        typeof(Records(np.zeros(0), np.zeros(0), np.zeros((0, 0)), np.zeros((0, 0, 0)))),
    )


_PART = Part(0, packed())
SYSTEM = typeof(System(_PART, _PART, True, 0, 0, np.zeros(0), 0))
"""Numba's type of `System`"""
