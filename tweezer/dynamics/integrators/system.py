"""What every compiled method shares: the force and the rates at a state, step control, records.

A loop is compiled once for a method. The force and the emitted rates come as addresses: any force,
model and bead use the loop as it is.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple, Protocol

import numpy as np
from numba import typeof, types
from numpy.typing import NDArray

from tweezer.compiled import call, named_njit
from tweezer.dynamics.continuing import Begin
from tweezer.dynamics.layout import EULER, Layout
from tweezer.fluid import Mobility
from tweezer.forces.data import Part, packed
from tweezer.forces.force import Force, Pose, Wrench, add, clear

Array = NDArray[np.float64]

# how a call of a loop ended; or that it has not
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
    """What moves the bead, for a loop."""

    force: Part
    drag: Part
    uniform: bool
    """whether the drag is the same everywhere: it is then evaluated once"""
    rates: int
    """address of the emitted `rates`; 0 for a loop that does not call them"""
    derivatives: int
    """address of the emitted `derivatives`; 0 likewise"""
    params: Array
    """of the emitted module"""
    orientation: int
    """where e stands in the state that the force is asked at; -1 if it does not"""


class Control(NamedTuple):
    """How a loop steps."""

    relative: float
    absolute: Array
    """(state,)"""
    fixed: float
    """s, the step; 0 for steps by the tolerances"""
    prescribed: Array
    """(n,) s, all steps of the run, instead of both; or (0,)"""
    end: float
    """s"""
    most_calls: int
    """of the force, in the whole run"""
    orientation: int
    """where e stands in the state; -1 if it does not"""
    euler_rates: int
    """where e' stands; -1 if it does not"""


class Records(NamedTuple):
    """Steps taken, to be read by `sample`."""

    begin: Array
    """(n,) s"""
    length: Array
    """(n,) s"""
    state: Array
    """(n, state) at the begin"""
    shape: Array
    """(n, ...) of the dense output, see `Bound.shape`"""


class At(NamedTuple):
    """Workspace for the force on one bead: arrays of length 1, and the element of each."""

    pose: Pose
    wrench: Wrench
    resisted: Mobility
    force: Array
    moment: Array
    force_gradient: Array
    moment_gradient: Array
    mobility: Array
    mobility_gradient: Array


@named_njit(inner=True, error_model="numpy")
def scratch(system):  # type: ignore[no-untyped-def]
    """Workspace, with the mobility of a uniform drag."""
    turned = 1 if system.orientation >= 0 else 0
    pose = Pose(np.zeros(1), np.zeros((1, 3)), np.zeros((turned, 4)))
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
    """Fill `at` with force and mobility, at a time and at the pose in a state."""
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
    """Fill `out` with the rate of change of the state y."""
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
    """Whether all of a contiguous array are finite: without a copy."""
    total = 0.0
    for value in values.flat:
        total += 0.0 * value
    return total == 0.0


@named_njit(inner=True, error_model="numpy")
def put_on_constraints(y, orientation, euler_rates):  # type: ignore[no-untyped-def]
    """|e| = 1 (A.21) and e.e' = 0 (A.22), instead of (A.26): they turn nothing."""
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
    """Whether steps are by the tolerances."""
    return control.fixed == 0.0 and control.prescribed.size == 0


@named_njit(inner=True, error_model="numpy")
def step_to_try(control, clock, counts, room):  # type: ignore[no-untyped-def]
    """The next step, whether it is the last one, and why there is none or `GOING_ON`.

    clock, counts: as `explicit.loop` has them. room: for how many records there is.
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
        # what rounding of the clock leaves before a kink is not a step of its own
        last |= left - step <= _ROUNDING * control.end
    last |= step >= left * (1.0 - 1e-12)
    if last:
        step = left
    if not time + step > time:  # lost in the rounding of the time
        return step, last, COLLAPSED
    if counts[2] > control.most_calls:
        return step, last, EXHAUSTED
    return step, last, GOING_ON


@named_njit(inner=True, error_model="numpy")
def next_step(step, error, before, order, growth, rejected):  # type: ignore[no-untyped-def]
    """The step after one of that error, in tolerances: PI control.

    before: the error of the last accepted step. order: power of the step that the error goes by.
    Gustafsson, ACM Trans. Math. Softw. 17:533 (1991), with the exponents of Hairer and Wanner.
    """
    if error == np.inf:
        return 0.1 * step
    if error > 1.0:
        return step * max(_SHRINK, _SAFETY * error ** (-1.0 / order))
    error = max(error, 1e-10)
    factor = _SAFETY * error ** (-0.7 / order) * max(before, 1e-4) ** (0.4 / order)
    return step * min(max(factor, _SHRINK), 1.0 if rejected else growth)


class Equations(Protocol):
    """What methods read of equations of motion, `tweezer.dynamics.models.EquationsOfMotion`."""

    layout: Layout
    """of its states"""
    initial_state: Array
    begin: Begin | None
    """what the motion goes on from; None for one from the release"""
    absolute_tolerance: Array
    """(state,)"""

    @property
    def begin_time(self) -> float:
        """s since the release, from when on the motion is followed."""

    @property
    def moving(self) -> Force:
        """The force with which constant mobilities give the velocity."""

    @property
    def name(self) -> str:
        """Of the model."""

    @property
    def relaxation(self) -> Any:
        """The `exponential.Relaxation`."""


class Bound(NamedTuple):
    """A method bound to equations of motion."""

    loop: Any
    """compiled, see `explicit.loop`"""
    how: Any
    """what the method is given by"""
    start: Array
    """(state,) as the loop has it"""
    shape: tuple[int, ...]
    """of the dense output of a step"""
    states: Callable[[Records, Array], Array]
    """states of the emitted module, (n, state), at ascending times within records"""
    gradient: bool = False
    """whether the loop takes the gradients of the force, whatever the emitted module takes"""
    calls: int = 0
    """places at which the force was evaluated"""
    force: Part | None = None
    """what the loop takes as the force; None: that of the equations"""
    rates: bool = True
    """whether the loop calls the emitted rates"""
    inner: Callable[[Records, Array], Array] | None = None
    """as `states`, of states as the loop has them; None where these are the same"""


def signature(method: types.Type) -> Any:
    """Of a loop; method: the type of what the loop's method is given by."""
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
