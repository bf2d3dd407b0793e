"""Combinations of forces: sums, forces that move or change in strength, numerical gradients.

A combination requires no compilation, because its kernel calls the kernels of the parts by address.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from tweezer.compiled import cached_njit
from tweezer.forces.data import Data, matrix, number, packed, part, vector
from tweezer.forces.force import (
    Force,
    Kernel,
    Pose,
    Wrench,
    add,
    bound,
    clear,
    no_wrench,
    numbered,
)
from tweezer.values.arrays import Array
from tweezer.values.errors import SceneError
from tweezer.values.units import QuantityLike, array_in_si, in_base_units, to_si


@dataclass(frozen=True)
class Sum(Force):
    """Sum of several forces."""

    forces: tuple[Force, ...]
    """the forces that are added"""

    @property
    def parts(self) -> tuple[Force, ...]:
        """Forces of which this force is a combination; see `Force.parts`."""
        return self.forces

    def field(
        self,
        positions: Array,
        *,
        gradient: bool = False,
        time: float | Array = 0.0,
        orientations: Array | None = None,
    ) -> Wrench:
        """Return force and torque at positions, the sum over the parts.

        Parameters
        ----------
        positions : ndarray, shape (n, 3)
            Positions from the focus, m.
        gradient : bool, optional
            Whether to compute gradients too.
        time : float or ndarray, shape (n,), optional
            Time, s.
        orientations : ndarray, shape (n, 4), optional
            Euler parameters. Default: (1, 0, 0, 0).

        Returns
        -------
        Wrench
            Force, torque, their gradients and the error of the force.
        """
        wrench = no_wrench(len(positions), gradient=gradient)
        for each in self.forces:
            there = each.field(positions, gradient=gradient, time=time, orientations=orientations)
            for total, added in zip(wrench, there, strict=True):
                np.add(total, added, out=total)
        return wrench

    @property
    def oriented(self) -> bool:
        """Whether the force depends on the orientation or turns the bead; see `Force.oriented`."""
        return any(each.oriented for each in self.forces)

    def kinks(self, end: float) -> Array:
        """Return the times in (0, end) at which the force jumps or bends, s; see `Force.kinks`."""
        return np.unique(np.concatenate([np.zeros(0), *(each.kinks(end) for each in self.forces)]))

    def shortest_time(self, end: float) -> float:
        """Return the shortest time scale of changes, s; see `Force.shortest_time`."""
        return _shortest(each.shortest_time(end) for each in self.forces)

    @property
    def steady(self) -> bool:
        """Whether the force is constant in time; see `Force.steady`."""
        return all(each.steady for each in self.forces)

    def compiled(self, *, gradient: bool) -> tuple[Kernel, Data]:
        """Return the kernel of this force and its data; see `Force.compiled`."""
        parts = [bound(each, gradient=gradient) for each in self.forces]
        return _add_all, packed(float(len(parts)), *parts)

    def regions(self) -> tuple[Kernel, Data] | None:
        """Return a kernel that numbers the regions in which the force is smooth, and its data."""
        flat: list[Force] = []
        for each in self.forces:  # a sum within this sum has its own digits
            flat += each.forces if isinstance(each, Sum) else (each,)
        parts = [part for each in flat if (part := numbered(each)) is not None]
        return (_number_all, packed(float(len(parts)), *parts)) if parts else None


def _shortest(times: Iterable[float]) -> float:
    """Return the shortest of some times, s; 0 means none, and is returned if all are 0."""
    return min(filter(None, times), default=0.0)


@cached_njit(error_model="numpy", nogil=True)
def _add_all(pose, data, wrench):  # type: ignore[no-untyped-def]
    """Add several forces, as a kernel. `data` contains their number, and each as a `Part`."""
    for each in range(int(number(data, 0))):
        add(part(data, 1 + each), pose, wrench)


@cached_njit(error_model="numpy", nogil=True)
def _number_all(pose, data, wrench):  # type: ignore[no-untyped-def]
    """Add to `wrench.error` one number of the region in which each bead is, for several forces.

    Its digits in base `_MOST_REGIONS` are the numbers of the regions of the forces. A float has
    room for eight of them. `data` contains the number of forces, and the kernel that numbers the
    regions of each.
    """
    n, none = len(pose.time), np.zeros((0, 3, 3))
    found = Wrench(np.zeros((n, 3)), np.zeros((n, 3)), none, none, np.zeros(n))
    digit = 1.0
    for each in range(int(number(data, 0))):
        found.error[:] = 0.0
        add(part(data, 1 + each), pose, found)
        for i in range(n):
            wrench.error[i] += digit * found.error[i]
        digit *= _MOST_REGIONS


def read_argument(name: str, read: Callable[..., Any], *arguments: Any) -> Any:
    """Return `read(*arguments)`; a `ValueError` that it raises gets the name of the argument."""
    try:
        return read(*arguments)
    except ValueError as refused:
        raise ValueError(f"{name}: {refused}") from None


@dataclass(frozen=True, eq=False)
class Course:
    """A number or a vector as a function of time: linear between points, plus a sine.

    It is constant before the first point and after the last. Two points at the same time define a
    jump; the second applies at that time. A periodic course repeats the points after `period`.
    Numbers are in SI units; quantities of pint and text such as "2 ms" are converted.

    Examples
    --------
    >>> from tweezer.forces import Course
    >>> course = Course(["0 ms", "2 ms"], [[0.0], [1.0]], [0.0])
    >>> course.at(1e-3)
    array([0.5])
    """

    times: Array
    """(n,) s, ascending"""
    values: Array
    """(n, m) values at these times, in SI units"""
    amplitude: Array
    """amplitude of the sine, (m,)"""
    frequency: float = 0.0
    """frequency of the sine, 1/s"""
    phase: float | Array = 0.0
    """phase of the sine at t = 0, rad: one, or one for each of the m values"""
    period: float = math.inf
    """period after which the points repeat, s"""

    unit: str = field(init=False)
    """SI unit of values and amplitude; "" if they were given as numbers"""

    def __post_init__(self) -> None:
        """Convert the arguments to SI; raise `ValueError` for invalid arrays, times or units."""
        values, of_values = read_argument("values", in_base_units, self.values)
        amplitude, of_amplitude = read_argument("amplitude", in_base_units, self.amplitude)
        if of_values != of_amplitude and of_amplitude and of_values:
            raise ValueError(f"values in {of_values} and amplitude in {of_amplitude}: do not fit")
        given: dict[str, Any] = {
            "times": np.array(read_argument("times", array_in_si, self.times, "s")),
            "values": np.array(values),
            "amplitude": np.array(amplitude),
            "frequency": read_argument("frequency", to_si, self.frequency, "1/s"),
            "phase": read_argument("phase", array_in_si, self.phase, "rad"),
            "period": read_argument("period", array_in_si, self.period, "s"),
            "unit": of_values or of_amplitude,
        }
        if given["period"].ndim:
            raise ValueError("period: must be one number")
        given["period"] = float(given["period"])
        if given["phase"].shape not in ((), given["amplitude"].shape):
            raise ValueError("phase: must be one number, or one for each value")
        if given["phase"].ndim == 0:
            given["phase"] = float(given["phase"])
        for name, value in given.items():
            object.__setattr__(self, name, value)
        for name in ("times", "values", "amplitude", "phase"):
            if not np.isfinite(getattr(self, name)).all():
                raise ValueError(f"{name}: must be finite")
        n, m = self.times.size, self.amplitude.size
        if self.times.ndim != 1 or not n or self.values.shape != (n, m):
            raise ValueError("times (n,), values (n, m) and amplitude (m,): do not fit together")
        if (np.diff(self.times) < 0).any():
            raise ValueError("times: must ascend")
        if self.frequency < 0 or not self.period > 0:
            raise ValueError("frequency and period: must not be negative")

    @classmethod
    def constant(cls, *values: QuantityLike) -> Course:
        """Return a course that never changes, with m `values`."""
        return cls(np.zeros(1), [list(values)], np.zeros(len(values)))  # type: ignore[arg-type]

    @property
    def steady(self) -> bool:
        """Whether the course never changes."""
        still = not self.amplitude.any() or self.frequency == 0.0
        return still and bool((self.values == self.values[0]).all())

    def kinks(self, end: float) -> Array:
        """Return the times in (0, end) at which the course jumps or bends, s."""
        if (self.values == self.values[0]).all():
            return np.zeros(0)
        times = self.times
        if math.isfinite(self.period):
            if end / self.period > _MOST_PERIODS:
                raise SceneError(f"{end / self.period:.2g} periods of a force: too many for a run")
            repeats = np.arange(math.ceil(end / self.period) + 1) * self.period
            points = self.times[self.times < self.period * (1 - 1e-12)]
            jumps = len(points) < len(self.times) or (self.values[0] != self.values[-1]).any()
            within = np.append(0.0, points) if jumps else points
            times = (repeats[:, None] + np.unique(within)).ravel()
        return np.unique(times[(times > 0) & (times < end)])

    def shortest_time(self, end: float) -> float:
        """Return the shortest time scale of changes in (0, end), s; 0 without changes."""
        kinks = self.kinks(end)
        between = float(np.diff(kinks, prepend=0.0).min()) if len(kinks) else 0.0
        swing = 1 / self.frequency if self.frequency and self.amplitude.any() else 0.0
        return _shortest((between, swing))

    def farthest(self, end: float) -> float:
        """Return a bound on the size of the vector up to the time `end`, s."""
        last = [np.interp(end, self.times, column) for column in self.values.T]
        reached = np.vstack([self.values[self.times < end], last])
        largest = np.linalg.norm(reached, axis=1).max()
        return float(largest + np.linalg.norm(self.amplitude))

    def at(self, time: float) -> Array:
        """Return the value at a time, s, as an array (m,)."""
        out = np.empty(self.values.shape[1])
        course_at(packed(*self.entries()), 0, time, out)
        return out

    def entries(self) -> tuple[float | Array, ...]:
        """Return the course as the `ENTRIES` entries of a force's data that `course_at` reads."""
        phases = np.broadcast_to(self.phase, self.amplitude.shape)
        return (
            self.times, self.values, self.amplitude,
            np.array([self.frequency, self.period, *phases]),
        )  # fmt: skip


#: Relative shift of time that keeps rounding from delaying a kink of a periodic course
_LATER = 2e-15
#: Largest number of periods in a run
_MOST_PERIODS = 1e6
#: Bound on the number of regions of a force
_MOST_REGIONS = 64.0
#: Number of entries of a `Course` in the data of a force
ENTRIES = 4


@cached_njit(error_model="numpy", nogil=True)
def course_at(data, first, time, out):  # type: ignore[no-untyped-def]
    """Fill `out` (m,) with the value of a `Course` at a time, s.

    The course begins at the entry `first` of the `data` of a force.
    """
    times, values = vector(data, first), matrix(data, first + 1)
    amplitude, wave = vector(data, first + 2), vector(data, first + 3)
    frequency, period, angle = wave[0], wave[1], 2.0 * math.pi * wave[0] * time
    if period < math.inf:  # rounding must not put this time before a kink
        time += _LATER * abs(time)
        time -= period * math.floor(time / period)
    after = np.searchsorted(times, time, side="right")
    last = times.size - 1
    for k in range(out.size):
        if after == 0:
            value = values[0, k]
        elif after > last:
            value = values[last, k]
        else:
            part_of = (time - times[after - 1]) / (times[after] - times[after - 1])
            value = values[after - 1, k] + part_of * (values[after, k] - values[after - 1, k])
        swings = frequency > 0.0 and amplitude[k] != 0.0
        out[k] = value + (amplitude[k] * math.sin(angle + wave[2 + k]) if swings else 0.0)


@dataclass(frozen=True)
class Moved(Force):
    """A force whose origin and strength are functions of time; it may also be inverted."""

    force: Force
    """the force at rest"""
    place: Course
    """origin of the force, (3,) m"""
    strength: Course
    """factor that multiplies force, torque and gradients, (1,)"""
    down: bool = False
    """whether the force is rotated by 180 degrees about x, so that its z axis points down"""

    def __post_init__(self) -> None:
        """Raise `ValueError` unless the courses have 3 lengths, and 1 number without a unit."""
        if self.place.amplitude.size != 3 or self.strength.amplitude.size != 1:
            raise ValueError("place and strength: must be courses of 3 numbers, and of 1")
        if self.place.unit not in ("", "m"):
            raise ValueError(f"place: has the wrong unit, {self.place.unit}; must be in m")
        if self.strength.unit:
            raise ValueError(f"strength: has a unit, {self.strength.unit}; must be a number")

    @property
    def parts(self) -> tuple[Force, ...]:
        """Forces of which this force is a combination; see `Force.parts`."""
        return (self.force,)

    def within(self, positions: Array, time: float) -> Array:
        """Return positions in the frame of the force that is moved.

        Parameters
        ----------
        positions : ndarray, shape (n, 3)
            Positions, m.
        time : float
            Time, s.

        Returns
        -------
        ndarray, shape (n, 3)
            Positions relative to the moved origin, m.
        """
        turn = np.array([1.0, -1.0, -1.0]) if self.down else np.ones(3)
        return turn * (positions - self.place.at(time))

    def shortest_time(self, end: float) -> float:
        """Return the shortest time scale of changes, s; see `Force.shortest_time`."""
        parts = self.place, self.strength, self.force
        return _shortest(each.shortest_time(end) for each in parts)

    @property
    def oriented(self) -> bool:
        """Whether the force depends on the orientation or turns the bead; see `Force.oriented`."""
        return self.force.oriented

    @property
    def steady(self) -> bool:
        """Whether the force is constant in time; see `Force.steady`."""
        return self.place.steady and self.strength.steady and self.force.steady

    def kinks(self, end: float) -> Array:
        """Return the times in (0, end) at which the force jumps or bends, s; see `Force.kinks`."""
        parts = self.place, self.strength, self.force
        return np.unique(np.concatenate([each.kinks(end) for each in parts]))

    def compiled(self, *, gradient: bool) -> tuple[Kernel, Data]:
        """Return the kernel of this force and its data; see `Force.compiled`."""
        return _add_moved, packed(
            bound(self.force, gradient=gradient), float(self.down), *self.place.entries(),
            *self.strength.entries(),
        )  # fmt: skip

    def regions(self) -> tuple[Kernel, Data] | None:
        """Return a kernel that numbers the regions in which the force is smooth, and its data."""
        within = numbered(self.force)
        if within is None:
            return None
        return _number_moved, packed(within, float(self.down), *self.place.entries())


@cached_njit(error_model="numpy", nogil=True)
def _number_moved(pose, data, wrench):  # type: ignore[no-untyped-def]
    """Add to `wrench.error` the numbers of the regions of a moved force, as a kernel.

    `data` contains the kernel that numbers the regions of the force at rest (`Part`), 1 if it is
    upside down, and the course of its origin.
    """
    sign = -1.0 if number(data, 1) > 0.0 else 1.0
    here = Pose(pose.time, np.empty_like(pose.position), pose.orientation, pose.drive)
    place = np.empty(3)
    for i in range(len(pose.time)):
        course_at(data, 2, pose.time[i], place)
        here.position[i, 0] = pose.position[i, 0] - place[0]
        for k in range(1, 3):
            here.position[i, k] = sign * (pose.position[i, k] - place[k])
    add(part(data, 0), here, wrench)


@cached_njit(error_model="numpy", nogil=True)
def _add_moved(pose, data, wrench):  # type: ignore[no-untyped-def]
    """Add a moved force, as a kernel.

    `data` contains the force at rest (`Part`), 1 if it is upside down, the course of its origin
    and the course of its strength.
    """
    force, down = part(data, 0), number(data, 1) > 0.0
    n, gradients = len(pose.time), len(wrench.force_gradient)
    here = Pose(pose.time, np.empty((n, 3)), pose.orientation.copy(), pose.drive)
    found = Wrench(
        np.zeros((n, 3)), np.zeros((n, 3)), np.zeros((gradients, 3, 3)),
        np.zeros((gradients, 3, 3)), np.zeros(n),
    )  # fmt: skip
    sign = np.ones(3)
    if down:
        sign[1] = sign[2] = -1.0
        # the product (0, 1, 0, 0) e of Euler parameters: half a turn about x
        for i in range(len(here.orientation)):
            e = pose.orientation[i]
            here.orientation[i, 0], here.orientation[i, 1] = -e[1], e[0]
            here.orientation[i, 2], here.orientation[i, 3] = -e[3], e[2]
    place, strength = np.empty(3), np.empty(1)
    for i in range(n):
        course_at(data, 2, pose.time[i], place)
        for k in range(3):
            here.position[i, k] = sign[k] * (pose.position[i, k] - place[k])
    add(force, here, found)
    for i in range(n):
        course_at(data, 2 + ENTRIES, pose.time[i], strength)
        factor = strength[0]
        wrench.error[i] += abs(factor) * found.error[i]
        for k in range(3):
            wrench.force[i, k] += factor * sign[k] * found.force[i, k]
            wrench.moment[i, k] += factor * sign[k] * found.moment[i, k]
            if gradients > 0:
                for l in range(3):
                    both = factor * sign[k] * sign[l]
                    wrench.force_gradient[i, k, l] += both * found.force_gradient[i, k, l]
                    wrench.moment_gradient[i, k, l] += both * found.moment_gradient[i, k, l]


@dataclass(frozen=True)
class Differenced(Force):
    """A force whose gradients are central differences."""

    force: Force
    """the force, whose own gradients are not used"""
    step: float
    """step of the differences, m"""

    @property
    def parts(self) -> tuple[Force, ...]:
        """Forces of which this force is a combination; see `Force.parts`."""
        return (self.force,)

    @property
    def oriented(self) -> bool:
        """Whether the force depends on the orientation or turns the bead; see `Force.oriented`."""
        return self.force.oriented

    @property
    def steady(self) -> bool:
        """Whether the force is constant in time; see `Force.steady`."""
        return self.force.steady

    def kinks(self, end: float) -> Array:
        """Return the times in (0, end) at which the force jumps or bends, s; see `Force.kinks`."""
        return self.force.kinks(end)

    def compiled(self, *, gradient: bool) -> tuple[Kernel, Data]:
        """Return the kernel of this force and its data; see `Force.compiled`."""
        if not gradient:
            return self.force.compiled(gradient=False)
        return _add_differences, packed(bound(self.force, gradient=False), self.step)


@cached_njit(error_model="numpy", nogil=True)
def _add_differences(pose, data, wrench):  # type: ignore[no-untyped-def]
    """Add a force, and gradients by central differences of it, as a kernel.

    `data` contains the force (`Part`) and the step of the differences (m).
    """
    force, step = part(data, 0), number(data, 1)
    n, none = len(pose.time), np.zeros((0, 3, 3))
    add(force, pose, Wrench(wrench.force, wrench.moment, none, none, wrench.error))
    beside = Pose(pose.time, pose.position.copy(), pose.orientation, pose.drive)
    found = Wrench(np.zeros((n, 3)), np.zeros((n, 3)), none, none, np.zeros(n))
    for l in range(3):
        for side in (-1.0, 1.0):
            clear(found)
            for i in range(n):
                beside.position[i, l] = pose.position[i, l] + side * step
            add(force, beside, found)
            factor = side / (2.0 * step)
            for i in range(n):
                for k in range(3):
                    wrench.force_gradient[i, k, l] += factor * found.force[i, k]
                    wrench.moment_gradient[i, k, l] += factor * found.moment[i, k]
        for i in range(n):
            beside.position[i, l] = pose.position[i, l]
