"""The user's own forces: functions that are tried first, and checked when compiled."""

from __future__ import annotations

import functools
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numba import njit, types
from numba.core.dispatcher import Dispatcher

from tweezer.compiled import (
    array_at,
    attempt,
    cached_njit,
    named_njit,
    native_address,
    protected,
    read_only,
)
from tweezer.compiled.stack import borrowed, on_stack
from tweezer.forces import trial
from tweezer.forces.composed import Differenced, read_argument
from tweezer.forces.data import DATA, Data, Part, number, packed, part
from tweezer.forces.force import POSE, WRENCH, Force, Kernel, Pose, Wrench
from tweezer.values.arrays import Array
from tweezer.values.errors import ForceError
from tweezer.values.units import QuantitiesLike, in_base_units, to_si

#: Beads for which a function is called at once
_AT_ONCE = 64
#: Numbers of the wrench of so many beads, with gradients
_OF_WRENCHES = 25 * _AT_ONCE
#: Bytes of a number
_BYTES = 8
#: What is wrong with a row of a wrench: the function raised, it is not finite, its error is
#: negative or not finite
_RAISED, _NOT_FINITE, _WRONG_ERROR = 1.0, 2.0, 3.0
#: Numbers of `UserForce._met`: what was wrong last, time, position (3) and orientation (4) there,
#: whether the pose had an orientation, and whether gradients were computed
_OF_MET = 11
#: Largest number of axes of an entry
_MOST_AXES = 3

SIGNATURE = types.void(protected(POSE), protected(DATA), WRENCH)
"""of a function of the user's: it cannot write to the pose nor to its entries"""


@dataclass(frozen=True, eq=False)
class UserForce(Force):
    """A force of your own: a function (`kernel`) and its numbers and arrays.

    The function has the signature `(pose, data, wrench)`, reads its entries with `number`,
    `vector`, `matrix` and `tensor`, and adds to `wrench`. Entries that are quantities of pint, or
    text such as "20 pN/um", are converted to SI units.

    The function is run once as plain Python when the force is created, and as compiled code before
    a run. All of its indices are checked. If it raises an exception, or returns a force that is not
    finite or a negative error, the run ends with the status "failed" and the message names the
    line.

    Raises
    ------
    ForceError
        If the function reads an entry that does not exist or is of another kind, writes to the
        pose, to an entry or beyond the wrench, sets the wrench instead of adding to it, or refers
        to a name that is not defined.
    ValueError
        If an argument is invalid.

    Examples
    --------
    >>> from tweezer.forces import UserForce, kernel, number
    >>> @kernel
    ... def push(pose, data, wrench):
    ...     wrench.force[:, 0] += number(data, 0)
    >>> UserForce(push, ["1 pN"]).steady
    True
    """

    function: Kernel
    """function made by the decorator `tweezer.forces.kernel`"""
    entries: tuple[QuantitiesLike, ...] = ()
    """numbers and arrays of up to three axes that the function reads"""
    gradient: bool = False
    """whether the function adds gradients if `wrench.force_gradient` is not empty; otherwise
    gradients are central differences"""
    turns: bool = False
    """whether the function exerts a torque or reads `pose.orientation`, so rotation is computed"""
    by_time: bool = False
    """whether the function reads `pose.time`"""
    step: float = 1e-10
    """step of the central differences, m or with a unit"""

    _doubt: str = field(default="", init=False, repr=False)
    """exception of the function as plain Python, which may not occur at other poses"""

    @property
    def oriented(self) -> bool:
        """Whether the force depends on the orientation or turns the bead; see `Force.oriented`."""
        return self.turns

    @property
    def steady(self) -> bool:
        """Whether the force is constant in time; see `Force.steady`."""
        return not self.by_time

    def __post_init__(self) -> None:
        """Read the arguments, and try the function once as plain Python."""
        if not isinstance(self.function, Dispatcher):
            raise ValueError("function: must be made by the decorator tweezer.forces.kernel")
        if not isinstance(self.entries, tuple | list):
            raise ValueError("entries: must be a tuple of numbers and arrays")
        read = [
            read_argument(f"entries[{i}]", in_base_units, e)[0] for i, e in enumerate(self.entries)
        ]
        for i, each in enumerate(read):
            if np.ndim(each) > _MOST_AXES:
                raise ValueError(f"entries[{i}]: has {np.ndim(each)} axes; allowed: up to 3")
        object.__setattr__(self, "entries", tuple(read))
        object.__setattr__(self, "step", read_argument("step", to_si, self.step, "m"))
        if not self.step > 0:
            raise ValueError("step: must be above 0")
        doubt = trial.first_look(
            self.function, self._data, gradient=self.gradient, turns=self.turns
        )
        object.__setattr__(self, "_doubt", doubt)

    @functools.cached_property
    def _data(self) -> Data:
        """Entries of the force in the form that the function reads."""
        return packed(*self.entries)

    @functools.cached_property
    def _met(self) -> Array:
        """Last error in compiled code, which writes it here; all 0 without an error.

        The comment at `_OF_MET` lists the numbers.
        """
        return np.zeros(_OF_MET)

    def compiled(self, *, gradient: bool) -> tuple[Kernel, Data]:
        """Return the kernel of this force and its data; see `Force.compiled`."""
        if gradient and not self.gradient:
            return Differenced(self, self.step).compiled(gradient=True)
        try:
            function = Part(_address(self.function), self._data)
        except ForceError as error:  # plain Python may have given a better message
            raise ForceError(self._doubt or str(error)) from None
        return _add_guarded, packed(function, float(self._met.ctypes.data))

    def __getstate__(self) -> dict[str, Any]:
        """Return the fields to pickle: without `_met`, an address of which this process keeps."""
        return {name: value for name, value in vars(self).items() if name != "_met"}

    def fault(self) -> str:
        """Return the last error in compiled code, with its line; "" without an error."""
        what, time, *pose, turned, gradient = self._met.tolist()
        if not what:
            return ""
        position, orientation = np.array([pose[:3]]), np.array([pose[3:]])
        return trial.explained(
            self.function, self._data,
            Pose(np.array([time]), position, orientation[: int(turned)], np.zeros((0, 3))),
            gradient=bool(gradient), wrong_error=what == _WRONG_ERROR,
        )  # fmt: skip


def own_forces(force: Force) -> Iterator[UserForce]:
    """Yield the user's own forces among a force and all its parts."""
    if isinstance(force, UserForce):
        yield force
    for each in force.parts:
        yield from own_forces(each)


def forget_faults(force: Force) -> None:
    """Reset the recorded errors of all of the user's own forces in a force."""
    for each in own_forces(force):
        each._met[:] = 0.0


def fault_of(force: Force, since: float = 0.0) -> str:
    """Return what went wrong last in forces of the user's own, at a time `since` (s) or later.

    "" if nothing did.
    """
    late = (each for each in own_forces(force) if each._met[1] >= since)
    return next(filter(None, (each.fault() for each in late)), "")


@functools.cache
def _address(function: Kernel) -> int:
    """Return the address of a function compiled with checks.

    Raises `ForceError` if it cannot be compiled.
    """
    compiled = trial.checked(function)
    try:
        return native_address(compiled, SIGNATURE)
    except trial.COMPILING as error:
        raise trial.refused(function, error) from None


@cached_njit(error_model="numpy", nogil=True)
def _add_guarded(pose, data, wrench):  # type: ignore[no-untyped-def]
    """Add the force of a user's function, as a kernel; NaN for the beads for which it fails.

    `data` contains the function with its data (`Part`) and the address of `UserForce._met`. The
    function receives a separate wrench of zeros, for up to `_AT_ONCE` beads at a time. After an
    exception it is called for one bead at a time, to find the one that caused it.
    """
    pose, data, wrench = borrowed(pose), borrowed(data), borrowed(wrench)
    function = part(data, 0)
    force, moment, error = wrench.force, wrench.moment, wrench.error
    n, turned, gradients = len(pose.time), len(pose.orientation), len(wrench.force_gradient)
    driven = len(pose.drive)
    memory = on_stack(_OF_WRENCHES, np.float64)
    first = memory.ctypes.data
    begin, most = 0, _AT_ONCE
    while begin < n:
        m = min(most, n - begin)
        g = m if gradients > 0 else 0
        # force, torque, error, gradients of force and torque, one after the other in `memory`
        of_error, of_gradient, used = 6 * m, 7 * m, 7 * m + 18 * g
        for i in range(used):
            memory[i] = 0.0
        found = Wrench(
            array_at(first, (m, 3)),
            array_at(first + _BYTES * 3 * m, (m, 3)),
            array_at(first + _BYTES * of_gradient, (g, 3, 3)),
            array_at(first + _BYTES * (of_gradient + 9 * g), (g, 3, 3)),
            array_at(first + _BYTES * of_error, (m,)),
        )
        here = Pose(
            pose.time[begin : begin + m],
            pose.position[begin : begin + m],
            pose.orientation[min(begin, turned) : min(begin + m, turned)],
            pose.drive[min(begin, driven) : min(begin + m, driven)],
        )
        raised = attempt(function.kernel, (read_only(here), read_only(function.data), found))
        if raised and m > 1:
            most = 1
            continue
        negative = False
        for i in range(of_error, of_gradient):
            negative |= memory[i] < 0.0
        if raised or negative or _sum_of_zeros(memory, used) != 0.0:
            _mark(data, pose, begin, found, raised)
        for i in range(m):
            for k in range(3):
                force[begin + i, k] += memory[3 * i + k]
                moment[begin + i, k] += memory[3 * m + 3 * i + k]
            error[begin + i] += memory[of_error + i]
        if g > 0:
            _add_gradients(found, begin, wrench)
        begin += m


@named_njit(inner=True, error_model="numpy", fastmath={"reassoc"})
def _sum_of_zeros(memory, n):  # type: ignore[no-untyped-def]
    """Return 0 if the first n numbers of `memory` are finite, else NaN.

    0 times infinity or NaN is NaN. The sum may be in any order, which is faster.
    """
    total = 0.0
    for i in range(n):
        total += 0.0 * memory[i]
    return total


@named_njit(inner=True, error_model="numpy")
def _add_gradients(found, begin, wrench):  # type: ignore[no-untyped-def]
    """Add the gradients of a wrench `found` of some beads to those of `wrench` from row `begin`."""
    for i in range(len(found.error)):
        for k in range(3):
            for l in range(3):
                wrench.force_gradient[begin + i, k, l] += found.force_gradient[i, k, l]
                wrench.moment_gradient[begin + i, k, l] += found.moment_gradient[i, k, l]


@named_njit(inner=True, error_model="numpy")
def _mark(data, pose, begin, found, raised):  # type: ignore[no-untyped-def]
    """Set the wrong rows of the wrench `found` to NaN, and note the last of them in `_met`.

    `data` belongs to `_add_guarded`. `pose` contains all beads, and `begin` is the first bead of
    `found`. All rows are wrong if the function has `raised` an exception.
    """
    met = array_at(int(number(data, 1)), (_OF_MET,))
    gradient, turned = len(found.force_gradient) > 0, len(pose.orientation) > 0
    for i in range(len(found.error)):
        total = 0.0  # NaN if a number of the row is not finite
        for k in range(3):
            total += 0.0 * found.force[i, k] + 0.0 * found.moment[i, k]
            for l in range(3 if gradient else 0):
                total += 0.0 * found.force_gradient[i, k, l] + 0.0 * found.moment_gradient[i, k, l]
        what = 0.0
        if raised:
            what = _RAISED
        elif total != 0.0:
            what = _NOT_FINITE
        elif not 0.0 <= found.error[i] < np.inf:
            what = _WRONG_ERROR
        if what == 0.0:
            continue
        found.force[i, :] = found.moment[i, :] = np.nan
        found.error[i] = np.nan
        if gradient:
            found.force_gradient[i, :, :] = found.moment_gradient[i, :, :] = np.nan
        at = begin + i
        met[1] = pose.time[at]
        for k in range(3):
            met[2 + k] = pose.position[at, k]
        for k in range(4):
            met[5 + k] = pose.orientation[at, k] if turned else 0.0
        met[9], met[10] = 1.0 if turned else 0.0, 1.0 if gradient else 0.0
        met[0] = what


def kernel(function: Kernel) -> Kernel:
    """Decorate a function, which is then compiled as the kernel of a `UserForce`.

    The function is compiled when the force is first used. The machine code is not cached, because a
    function from a terminal or a notebook has no file in which a change could be detected. A
    division by zero raises an exception, as in plain Python.

    Parameters
    ----------
    function : callable
        Function `(pose, data, wrench)` that reads its entries and adds to `wrench`.

    Returns
    -------
    callable
        The kernel.
    """
    compiled: Kernel = njit(nogil=True, boundscheck=True)(function)
    return compiled
