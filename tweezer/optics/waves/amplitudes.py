"""Amplitudes P_nm of the light about a bead, in the frame of the scene, for light of any kind.

The light is a sum of paths: cones of plane waves, each from its own focus, with its own direction,
power and phase. A path that a mirror reflects is one of them. The amplitudes of the paths add up,
so their light interferes.

A path that travels down is computed in its own frame, which is turned by half a turn about x. A
reflected path is computed at the bead's mirror image, z -> 2 h - z, for a mirror at the height h in
the frame of its beam. With the amplitudes P'_nm of helicity l there, those in the scene are

    P_nm = (-1)^(n+m) P'_n,-m, of helicity l, for a path that travels down,
    P_nm = (-1)^(n+m) P'_nm, of helicity -l, for a reflected path.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numba import types
from numpy.typing import NDArray

from tweezer.compiled import cached_njit, named_njit
from tweezer.compiled.lanes import LANES
from tweezer.forces.composed import ENTRIES, Course, course_at
from tweezer.forces.data import DATA, Data, matrix, number, packed, vector
from tweezer.optics.waves.binding import of_states, source, uneven_grid
from tweezer.optics.waves.focus import State
from tweezer.optics.waves.grid import add_uneven_part, azimuthal_orders, grid_of, size_of
from tweezer.optics.waves.kernel import BEGIN, END, Room, room_of
from tweezer.optics.waves.light import Waves
from tweezer.optics.waves.partial_waves import (
    HELICITY,
    OPTIONS,
    PADDED,
    plane_waves,
    rule_for,
    source_of,
)
from tweezer.optics.waves.terms import nodes_of
from tweezer.values.arrays import Array

# entries of a path: its place, its factor of the power and its phase (`Course`), the numbers below,
# its polarised states, then those of the `Source` and the `Grid`
_STRENGTH, _PHASE, _NUMBERS = ENTRIES, 2 * ENTRIES, 3 * ENTRIES
_STATES, _SOURCE = _NUMBERS + 1, _NUMBERS + 2
_OF_SOURCE, _OF_GRID = 13, 5
ENTRIES_OF_PATH = _SOURCE + _OF_SOURCE + _OF_GRID
# numbers of a path: amplitude (root of the power as a part of the whole), whether it travels down,
# whether it is reflected, mirror's height in the scene, m
_AMPLITUDE, _DOWN, _REFLECTED, _HEIGHT = range(4)
#: Type of the compiled function of `Amplitudes.at`
_AT = types.complex128[:, :, :, :, ::1](types.float64[:, ::1], types.float64, DATA)


@dataclass(frozen=True, eq=False)
class Path:
    """A cone of plane waves that is a part of coherent light."""

    light: Waves
    """plane waves about their own focus, without mirror images of states and with a pupil"""
    place: Course
    """position of the focus, (3,) m"""
    strength: Course
    """factor of the power, (1,)"""
    phase: Course
    """phase of the light, (1,) rad"""
    down: bool
    """whether the light travels along -z"""
    mirror: float | None = None
    """height z of the mirror that has reflected the light, m; None if none has"""

    def farthest(self, reach: float, end: float) -> float:
        """Return the largest distance of a bead, or of its image, from the focus of this path, m.

        `reach` is the largest distance of the bead from the scene's origin, m, and `end` the last
        time, s.
        """
        there = reach + self.place.farthest(end)
        if self.mirror is None:
            return there
        # the image in a mirror at the height h is at most 2 |h - z_focus| farther
        return there + 2 * (abs(self.mirror) + self.place.farthest(end))


class Bound(NamedTuple):
    """Entries of the data that `add_paths` reads, and the error of the amplitudes."""

    entries: tuple[Any, ...]
    """number of paths, number of states, highest order m, and `ENTRIES_OF_PATH` for each path"""
    error: float
    """error of the integrals, as a part of the light's amplitude if all paths add up"""


def bound_paths(
    paths: Sequence[Path], highest: int, top: int, reach: float, end: float, small: float
) -> Bound:
    """Return paths in the form for the compiled sums.

    Parameters
    ----------
    paths : sequence of Path
        Parts of the light, with equal numbers of polarised states.
    highest : int
        Highest degree of the tables, a multiple of `LANES` less one.
    top : int
        Highest order |m| that is computed, at most `highest`.
    reach : float
        Largest distance of the bead from the scene's origin, m.
    end : float
        Time after which a path's course is not used, s.
    small : float
        Wanted error of the integrals.
    """
    total = sum(path.light.cone.power for path in paths if path.mirror is None)
    entries: list[Any] = [float(len(paths)), float(len(paths[0].light.states)), float(top)]
    error = 0.0
    for path in paths:
        light = path.light
        share = math.sqrt(light.cone.power / total)
        far = path.farthest(reach, end)
        light, nodes = nodes_of(light, small, far)
        numbers = share, float(path.down), float(path.mirror is not None), path.mirror or 0.0
        entries += [
            *path.place.entries(), *path.strength.entries(), *path.phase.entries(),
            np.array(numbers), of_states(light.states),
            *source(light, light.states, nodes, far, highest, small),
            *uneven_grid(light, nodes, far, top),
        ]  # fmt: skip
        error += share * nodes.error
    return Bound(tuple(entries), error)


@named_njit(**OPTIONS)
def first_source(data, first):  # type: ignore[no-untyped-def]
    """Return the `Source` of the first of the paths that begin at the entry `first`."""
    return source_of(data, first + 3 + _SOURCE)


@named_njit(**OPTIONS)
def room_for_paths(data, first):  # type: ignore[no-untyped-def]
    """Return the `Room` of the path with the most nodes; its paths begin at the entry `first`.

    Its `waves` have a row for both helicities of each state, and two more for the current path.
    """
    nodes, size, states = 0, 0, int(number(data, first + 1))
    largest = first_source(data, first)
    for path in range(int(number(data, first))):
        at = first + 3 + path * ENTRIES_OF_PATH + _SOURCE
        of_path = source_of(data, at)
        padded = int(of_path.rules[-1, PADDED])
        size = max(size, size_of(grid_of(data, at), padded))
        if padded > nodes:
            nodes, largest = padded, of_path
    room = room_of(largest, size)
    return Room(
        room.bessel, room.norm, room.re, room.im, room.work,
        np.zeros((2 * states + 2, room.waves.shape[1])), room.found,
    )  # fmt: skip


@named_njit(**OPTIONS)
def add_paths(data, first, time, x, y, z, room):  # type: ignore[no-untyped-def]
    """Fill `room.waves` with the amplitudes P_nm of all paths about a bead at (x, y, z), m.

    Each state has a row for the helicities +1 and -1: the real, then the imaginary parts by (m, n),
    with two rows of zeros before the lowest order m = -top and after the highest. `first` is the
    entry of `data` at which the paths begin, and `time` is in s. Returns whether the bead is near
    enough to all foci for their rules of integration.
    """
    states, top = int(number(data, first + 1)), int(number(data, first + 2))
    stride = first_source(data, first).highest + 1
    imaginary = (2 * top + 5) * stride
    place, one = np.empty(3), np.empty(1)
    used = LANES + 2 * imaginary
    room.waves[: 2 * states, :used] = 0.0
    for path in range(int(number(data, first))):
        at = first + 3 + path * ENTRIES_OF_PATH
        numbers, table = vector(data, at + _NUMBERS), matrix(data, at + _STATES)
        down, reflected = numbers[_DOWN] > 0.0, numbers[_REFLECTED] > 0.0
        course_at(data, at, time, place)
        sign = -1.0 if down else 1.0
        a, b, c = x - place[0], sign * (y - place[1]), sign * (z - place[2])
        if reflected:
            c = 2.0 * sign * (numbers[_HEIGHT] - place[2]) - c
        course_at(data, at + _STRENGTH, time, one)
        size = numbers[_AMPLITUDE] * math.sqrt(one[0])
        course_at(data, at + _PHASE, time, one)
        of_path, grid = source_of(data, at + _SOURCE), grid_of(data, at + _SOURCE)
        rule = rule_for(of_path, math.hypot(a, b), c)
        if rule < 0:
            return False
        phase = one[0] + of_path.wavenumber * c  # of the wave along the axis, see `plane_waves`
        re, im = size * math.cos(phase), size * math.sin(phase)
        azimuthal_orders(of_path, grid, rule, a, b, room.bessel)
        room.norm[:] = 1.0
        for state in range(states):
            own = room.waves[2 * states :]
            own[:, :used] = 0.0
            for part in range(int(table[state, BEGIN]), int(table[state, END])):
                plane_waves(of_path, rule, part, c, room.norm, room.re, room.im)
                out = own[1 if of_path.parts[part, HELICITY] < 0 else 0]
                add_uneven_part(of_path, grid, rule, part, room, -top - 2, out[LANES:used])
            for k in range(2):
                to = room.waves[2 * state + (1 - k if reflected else k)]
                _add_turned(own[k], to, re, im, down, reflected, top, stride)
    return True


@named_njit(**OPTIONS)
def _add_turned(own, to, re, im, down, reflected, top, stride):  # type: ignore[no-untyped-def]
    """Add the amplitudes `own` of one helicity of a path, times re + i im, to those of the scene.

    `top` is the highest order m, `stride` the number of degrees; see the module for the turns.
    """
    imaginary = (2 * top + 5) * stride
    for m in range(-top, top + 1):
        begin = LANES + (m + top + 2) * stride
        of = LANES + ((-m if down else m) + top + 2) * stride
        for n in range(abs(m), stride):
            sign = 1.0
            if down != reflected:
                sign -= 2.0 * ((n + m) & 1)
            a, b = sign * own[of + n], sign * own[of + imaginary + n]
            to[begin + n] += a * re - b * im
            to[begin + imaginary + n] += a * im + b * re


@dataclass(frozen=True, eq=False)
class Amplitudes:
    """Amplitudes of the light about a bead, for light of any kind that interferes with itself.

    The light is a sum of polarised states, which do not interfere with each other.
    """

    paths: tuple[Path, ...]
    """parts of the light, whose amplitudes add up"""
    degree: int
    """highest degree n"""
    reach: float
    """largest distance of the bead from the origin of the scene, m"""
    end: float
    """last time, s"""
    small: float = 1e-13
    """wanted error of the integrals, as a part of the light's amplitude"""

    @property
    def states(self) -> tuple[State, ...]:
        """Polarised states, with the share of each in the power."""
        return self.paths[0].light.states

    @property
    def power(self) -> float:
        """Power of all paths that no mirror has reflected, W."""
        return sum(path.light.cone.power for path in self.paths if path.mirror is None)

    @functools.cached_property
    def _bound(self) -> tuple[Data, float]:
        """Data of the compiled sums, and the error of the amplitudes."""
        highest = -(-(self.degree + 2) // LANES) * LANES - 1
        bound = bound_paths(self.paths, highest, self.degree, self.reach, self.end, self.small)
        return packed(*bound.entries), bound.error

    @property
    def error(self) -> float:
        """Error of the amplitudes, as a part of the light's amplitude if all paths add up."""
        return self._bound[1]

    def at(self, positions: Array, time: float = 0.0) -> NDArray[np.complex128]:
        """Return the amplitudes p_nm about beads, in 1/sqrt(W) of the whole power.

        Parameters
        ----------
        positions : ndarray, shape (n, 3)
            Positions in the frame of the scene, m.
        time : float, optional
            Time, s.

        Returns
        -------
        ndarray, shape (n, states, 2, 2 N + 1, N + 1)
            p_nm = 2 pi i^m P_nm of the helicities +1 and -1, by the order m = -N..N and the degree
            n = 0..N, where N is `degree`. The sum of |p_nm|^2 over all degrees is the power of the
            state as a part of the whole, without its `weight`. NaN for a bead beyond `reach`.
        """
        places = np.require(positions, np.float64, ["C", "W"])
        found: NDArray[np.complex128] = _amplitudes_at()(places, time, self._bound[0])
        m = np.arange(-self.degree, self.degree + 1)
        return 2 * math.pi * found[..., : self.degree + 1] * (1j**m)[:, None]


@functools.cache
def _amplitudes_at() -> Any:
    """Return the compiled function of the amplitudes P_nm about beads at positions (n, 3), m."""

    @cached_njit(_AT, error_model="numpy", nogil=True)
    def amplitudes_at(positions, time, data):  # type: ignore[no-untyped-def]
        """Return P_nm (n, states, 2, orders, degrees) about beads at positions (n, 3), m."""
        states, top = int(number(data, 1)), int(number(data, 2))
        stride = first_source(data, 0).highest + 1
        imaginary, begin = (2 * top + 5) * stride, LANES + 2 * stride
        room = room_for_paths(data, 0)
        n = positions.shape[0]
        out = np.full((n, states, 2, 2 * top + 1, stride), complex(math.nan, 0.0))
        for i in range(n):
            x, y, z = positions[i, 0], positions[i, 1], positions[i, 2]
            if not add_paths(data, 0, time, x, y, z, room):
                continue
            for row in range(2 * states):
                for k in range(2 * top + 1):
                    for degree in range(stride):
                        at = begin + k * stride + degree
                        out[i, row // 2, row % 2, k, degree] = complex(
                            room.waves[row, at], room.waves[row, at + imaginary]
                        )
        return out

    return amplitudes_at
