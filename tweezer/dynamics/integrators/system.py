"""What every compiled method shares: the force and the rates at a state, step control, records.

A loop is compiled once for a method and a kind of light. The light's kernel and the emitted rates
come as function pointers: other models, polarisations and beads use the loop as it is.
"""

from __future__ import annotations

import hashlib
import math
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numba import njit, typeof, types
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: Digest of this file, whose functions the loops call
DIGEST = hashlib.sha256(Path(__file__).read_bytes()).hexdigest()

# how a call of a loop ended; or that it has not
REACHED, FULL, COLLAPSED, NOT_FINITE, EXHAUSTED, GOING_ON = range(6)

#: a step may shrink and grow by these factors, and is aimed at this part of the tolerance
_SHRINK, _SAFETY = 0.2, 0.9

_f8 = types.float64
_vector, _matrix, _tensor = _f8[::1], _f8[:, ::1], _f8[:, :, ::1]
#: `rates` of the emitted modules
RATES = types.void(_vector, _vector, _vector, _matrix, _matrix, _vector, _vector)


def kernel_signature(source: types.Type) -> Any:
    """Of `tweezer.optics.kernels.kernel`, for one kind of source."""
    return types.void(
        _matrix, source, _f8, _f8, _vector, _matrix, _matrix, _tensor, _tensor, _vector
    )


class Pointer(types.WrapperAddressProtocol):
    """A compiled function as an argument of a compiled loop."""

    def __init__(self, function: Any, signature: Any) -> None:
        function.compile(signature)
        compiled = function.get_compile_result(signature)
        self._signature = signature
        self._library = compiled.library  # alive as long as its address
        self._address = compiled.library.get_pointer_to_function(
            compiled.fndesc.llvm_cfunc_wrapper_name
        )

    def __wrapper_address__(self) -> int:
        """Where its machine code is."""
        return int(self._address)

    def signature(self) -> Any:
        """Its numba signature."""
        return self._signature


class System(NamedTuple):
    """The light and the bead, for a loop."""

    source: Any
    beyond: Any
    """source of the light where a table does not reach"""
    radius: float
    """m"""
    n_mP: float
    jones: Array
    params: Array
    """of the emitted module"""


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
    """(n, degree, ...) of the dense output"""


class At(NamedTuple):
    """Scratch for the light at one place; of each array the only element too, made once."""

    position: Array
    force: Array
    moment: Array
    force_gradient: Array
    moment_gradient: Array
    error: Array
    the_force: Array
    the_moment: Array
    the_force_gradient: Array
    the_moment_gradient: Array


@njit
def scratch():  # type: ignore[no-untyped-def]
    """Room for the light at one place."""
    force, moment = np.zeros((1, 3)), np.zeros((1, 3))
    force_gradient, moment_gradient = np.zeros((1, 3, 3)), np.zeros((1, 3, 3))
    return At(
        np.zeros((1, 3)), force, moment, force_gradient, moment_gradient, np.full(1, np.nan),
        force[0], moment[0], force_gradient[0], moment_gradient[0],
    )  # fmt: skip


@njit(error_model="numpy")
def shine(kernel, beyond, system, at, position):  # type: ignore[no-untyped-def]
    """Fill `at` with the light at a place, the first three of `position`."""
    for i in range(3):
        at.position[0, i] = position[i]
    kernel(
        at.position, system.source, system.radius, system.n_mP, system.jones,
        at.force, at.moment, at.force_gradient, at.moment_gradient, at.error,
    )  # fmt: skip
    if at.error[0] == np.inf:
        beyond(
            at.position, system.beyond, system.radius, system.n_mP, system.jones,
            at.force, at.moment, at.force_gradient, at.moment_gradient, at.error,
        )  # fmt: skip


@njit(error_model="numpy")
def rate_of_change(kernel, beyond, rates, system, at, y, out):  # type: ignore[no-untyped-def]
    """Fill `out` with the rate of change of the state y."""
    shine(kernel, beyond, system, at, y)
    rates(
        y, at.the_force, at.the_moment, at.the_force_gradient, at.the_moment_gradient,
        system.params, out,
    )  # fmt: skip


@njit(error_model="numpy")
def all_finite(values):  # type: ignore[no-untyped-def]
    """Whether all of a contiguous array are finite: without a copy."""
    total = 0.0
    for value in values.flat:
        total += 0.0 * value
    return total == 0.0


@njit(error_model="numpy")
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


@njit(error_model="numpy")
def by_tolerance(control):  # type: ignore[no-untyped-def]
    """Whether steps are by the tolerances."""
    return control.fixed == 0.0 and control.prescribed.size == 0


@njit(error_model="numpy")
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
    last |= step >= left * (1.0 - 1e-12)
    if last:
        step = left
    if not time + step > time:  # lost in the rounding of the time
        return step, last, COLLAPSED
    if counts[2] > control.most_calls:
        return step, last, EXHAUSTED
    return step, last, GOING_ON


@njit(error_model="numpy")
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


def signature(
    source: types.Type, beyond: types.Type, system: types.Type, method: types.Type
) -> Any:
    """Of a loop, for one kind of light; method: the type of what the loop's method is given by."""
    return types.Tuple((types.int64, types.int64))(
        types.FunctionType(kernel_signature(source)),
        types.FunctionType(kernel_signature(beyond)),
        types.FunctionType(RATES),
        system,
        method,
        typeof(Control(0.0, np.zeros(0), 0.0, np.zeros(0), 0.0, 0, 0, 0)),
        _vector,
        _vector,
        types.int64[::1],
        typeof(Records(np.zeros(0), np.zeros(0), np.zeros((0, 0)), np.zeros((0, 0, 0)))),
    )
