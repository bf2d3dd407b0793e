"""Interface of all forces: a compiled kernel and its data.

A kernel has the signature `kernel(pose, data, wrench)` with the types below, and adds to `wrench`.
The signature is the same for every force. The loops that integrate the motion are therefore
compiled only once, and a combination of forces requires no compilation.
"""

from __future__ import annotations

import functools
from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numba import typeof, types

from tweezer.compiled import address, cached_njit, call, named_njit
from tweezer.forces.data import DATA, Data, Part
from tweezer.values.arrays import Array

Kernel = Callable[[Any, Data, Any], None]


class Pose(NamedTuple):
    """Time, position and orientation of n beads."""

    time: Array
    """(n,) s"""
    position: Array
    """(n, 3) m from the focus"""
    orientation: Array
    """(n, 4) Euler parameters of length 1; (0, 4) if no rotation is computed"""
    drive: Array
    """(n, 3) output of a controller, by axis; (0, 3) without one: see `tweezer.forces.driven`"""


class Wrench(NamedTuple):
    """Force and torque on n beads, in the inertial frame, to which a kernel adds."""

    force: Array
    """(n, 3) N"""
    moment: Array
    """(n, 3) N m"""
    force_gradient: Array
    """(n, 3, 3) N/m, [i, j] = dF_i/dx_j; (0, 3, 3) where it is not computed"""
    moment_gradient: Array
    """(n, 3, 3) N, [i, j] = dM_i/dx_j; (0, 3, 3) where it is not computed"""
    error: Array
    """(n,) N, estimate or bound of the error of the force; NaN if unknown"""


class Force(ABC):
    """A force on a bead, possibly with a torque, which a compiled kernel computes."""

    @property
    def oriented(self) -> bool:
        """Whether the force exerts a torque or depends on the orientation."""
        return False

    @property
    def steady(self) -> bool:
        """Whether the force is constant in time."""
        return True

    @property
    def parts(self) -> tuple[Force, ...]:
        """Forces of which this force is a combination; empty for a simple force."""
        return ()

    def kinks(self, end: float) -> Array:  # noqa: ARG002
        """Return the times in (0, end) at which the force or its time derivative jumps, s."""
        return np.zeros(0)

    def shortest_time(self, end: float) -> float:
        """Return the shortest time scale of changes in (0, end), s; 0 if none is known."""
        kinks = self.kinks(end)
        return float(np.diff(kinks, prepend=0.0).min()) if len(kinks) else 0.0

    def regions(self) -> tuple[Kernel, Data] | None:
        """Return a kernel that numbers the regions of space in each of which the force is smooth.

        The kernel adds the index of the region of a pose to `wrench.error`. Its data are returned
        too. For a force that is smooth everywhere, the result is None. Integrators use the index to
        detect when a bead leaves its region.
        """
        return None

    @abstractmethod
    def compiled(self, *, gradient: bool) -> tuple[Kernel, Data]:
        """Return the kernel of the force, and its data; it adds gradients only with `gradient`."""

    def field(
        self,
        positions: Array,
        *,
        gradient: bool = False,
        time: float | Array = 0.0,
        orientations: Array | None = None,
    ) -> Wrench:
        """Return force and torque at positions of the bead.

        Parameters
        ----------
        positions : ndarray, shape (n, 3)
            Positions from the focus, m.
        gradient : bool, optional
            Whether to compute gradients too.
        time : float or ndarray, shape (n,), optional
            Time, s.
        orientations : ndarray, shape (n, 4), optional
            Euler parameters, for a force that depends on them. Default: (1, 0, 0, 0).

        Returns
        -------
        Wrench
            Force, torque, their gradients and the error of the force. A force without a torque
            returns zeros for it.
        """
        if self.oriented and orientations is None:
            orientations = np.tile([1.0, 0.0, 0.0, 0.0], (len(positions), 1))
        return evaluated(bound(self, gradient=gradient), positions, gradient, time, orientations)

    def error_of(
        self,
        positions: Array,  # noqa: ARG002
        field: Wrench,
        time: float | Array = 0.0,  # noqa: ARG002
    ) -> Array:
        """Return the error of a force that has been computed.

        Parameters
        ----------
        positions : ndarray, shape (n, 3)
            Positions from the focus, m.
        field : Wrench
            This force at these positions and times.
        time : float or ndarray, shape (n,), optional
            Time, s.

        Returns
        -------
        ndarray, shape (n,)
            Error of `field.force`, N.
        """
        return field.error


def no_wrench(n: int, *, gradient: bool) -> Wrench:
    """Return a wrench of zeros for n beads, to which a kernel adds; see `Force.field`."""
    gradients = n if gradient else 0
    shapes = (n, 3), (n, 3), (gradients, 3, 3), (gradients, 3, 3), (n,)
    wrench = Wrench(*(np.empty(shape) for shape in shapes))
    for each in wrench:  # faster than `np.zeros`: the memory is in cache when the kernel adds
        each.fill(0.0)
    return wrench


def evaluated(
    part: Part,
    positions: Array,
    gradient: bool,
    time: float | Array = 0.0,
    orientations: Array | None = None,
) -> Wrench:
    """Return force and torque of a bound force at positions of the bead.

    Parameters
    ----------
    part : Part
        Address of the kernel, and data.
    positions : ndarray, shape (n, 3)
        Positions from the focus, m.
    gradient : bool
        Whether to compute gradients too. The force must have been bound with them.
    time : float or ndarray, shape (n,), optional
        Time, s.
    orientations : ndarray, shape (n, 4), optional
        Euler parameters; None for a force that does not depend on them.
    """
    places = _in_memory(positions)
    turned = _NOT_TURNED if orientations is None else _in_memory(orientations)
    times = np.full(len(places), time, np.float64)
    wrench = no_wrench(len(places), gradient=gradient)
    _entry()(part.kernel, *part.data, times, places, turned, _NOT_DRIVEN, *wrench)
    return wrench


_NOT_TURNED, _NOT_DRIVEN = np.zeros((0, 4)), np.zeros((0, 3))


def _in_memory(values: Array) -> Array:
    """Return the values as compiled code requires them: float64, C-contiguous and writable."""
    if values.dtype == np.float64 and values.flags.carray:
        return values  # `np.require` takes as long as a force
    return np.require(values, np.float64, ["C", "W"])


@functools.cache
def _entry() -> Any:
    """Return the compiled function by which Python calls a kernel.

    Its arguments are the address of the kernel and the arrays of its data, pose and wrench one by
    one, as tuples of arrays take longer to pass from Python.
    """

    @cached_njit(types.void(types.int64, *DATA, *POSE, *WRENCH), nogil=True)
    def enter(  # type: ignore[no-untyped-def]
        kernel, numbers, shapes, time, position, orientation, drive,
        force, moment, force_gradient, moment_gradient, error,
    ):  # fmt: skip
        """Call the kernel at an address with the arrays of its data, pose and wrench."""
        pose = Pose(time, position, orientation, drive)
        wrench = Wrench(force, moment, force_gradient, moment_gradient, error)
        call(kernel, (pose, Data(numbers, shapes), wrench))

    return enter


def bound(force: Force, *, gradient: bool) -> Part:
    """Return a force in the form for compiled loops: the address of its kernel, and its data."""
    kernel, data = force.compiled(gradient=gradient)
    return Part(address(kernel, KERNEL), data)


def numbered(force: Force) -> Part | None:
    """Return the kernel of `Force.regions` in the form for compiled loops; None without regions."""
    found = force.regions()
    return None if found is None else Part(address(found[0], KERNEL), found[1])


@named_njit(inner=True, error_model="numpy")
def add(part, pose, wrench):  # type: ignore[no-untyped-def]
    """Add a bound force (`Part`) at a `Pose` to a `Wrench`."""
    call(part.kernel, (pose, part.data, wrench))


@named_njit(inner=True, error_model="numpy")
def clear(wrench):  # type: ignore[no-untyped-def]
    """Set all numbers of a `Wrench` to zero."""
    for i in range(len(wrench.error)):
        wrench.error[i] = 0.0
        for k in range(3):
            wrench.force[i, k] = wrench.moment[i, k] = 0.0
    for i in range(len(wrench.force_gradient)):
        for k in range(3):
            for l in range(3):
                wrench.force_gradient[i, k, l] = wrench.moment_gradient[i, k, l] = 0.0


POSE = typeof(Pose(np.zeros(0), np.zeros((0, 3)), np.zeros((0, 4)), np.zeros((0, 3))))
WRENCH = typeof(no_wrench(0, gradient=True))
KERNEL = types.void(POSE, DATA, WRENCH)
"""signature of a kernel"""


@cached_njit()
def no_force(pose, data, wrench):  # type: ignore[no-untyped-def]
    """Kernel of a force that is zero, which adds nothing."""
