"""The force of light that interferes: coherent beams, and beams that a plane reflects.

The amplitudes of all paths of the light about the bead are added (`amplitudes`). The sums of
`kernel` then give force, torque and gradient, in the frame of the scene.
"""

from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numba import types

from tweezer.compiled import cached_njit, named_njit
from tweezer.compiled.lanes import LANES
from tweezer.forces.composed import Course
from tweezer.forces.data import DATA, Data, matrix, number, packed, vector
from tweezer.forces.equilibria import Search
from tweezer.forces.force import KERNEL, Kernel
from tweezer.forces.rings import Box
from tweezer.optics.beam import relative_radius
from tweezer.optics.light import Light, LightForce, jones_vector
from tweezer.optics.turning import put
from tweezer.optics.waves.amplitudes import (
    Path,
    add_paths,
    bound_paths,
    first_source,
    room_for_paths,
)
from tweezer.optics.waves.binding import ROUNDING, SMALL, UNIT, of_states, sphere_and_degree
from tweezer.optics.waves.by_quadrature import checked_size
from tweezer.optics.waves.focus import states
from tweezer.optics.waves.harmonics import elements
from tweezer.optics.waves.kernel import (
    ABSORBED,
    ELEMENTS,
    FLOOR,
    FOUND,
    OF_ALL,
    SHARE,
    SPHERE,
    STATES,
    STRENGTH,
    TOLERANCE,
    Weights,
    electric_and_magnetic,
    force_and_gradient_sum,
    force_sum,
    guarded_elements,
    moment_gradient_sum,
    moment_sum,
)
from tweezer.optics.waves.kernel import Waves as AboutBead
from tweezer.optics.waves.light import BEYOND_LOSS, Waves, waves_on_bead
from tweezer.optics.waves.mirror import reflected
from tweezer.optics.waves.partial_waves import OPTIONS
from tweezer.optics.waves.pupil import Pupil
from tweezer.scene import Scene
from tweezer.scene.interference import reflecting
from tweezer.scene.sections import Beam
from tweezer.values.arrays import Array

#: Entry of the data at which the paths begin: the place of the source of one beam
_PATHS = SPHERE + 1
#: Type of the compiled `coherent_absorption`
_ABSORPTION = types.float64[::1](types.float64[:, ::1], types.float64, DATA)


@dataclass(frozen=True, eq=False)
class Interference(Light):
    """Light whose paths interfere, and a layered sphere."""

    paths: tuple[Path, ...]
    """parts of the light, whose amplitudes add up"""

    @property
    def symmetric(self) -> bool:
        """Whether the light is treated as the same all around an axis: never."""
        return False

    @property
    def wavenumber(self) -> float:
        """k in the medium, 1/m."""
        return self.paths[0].light.wavenumber

    @property
    def power(self) -> float:
        """Power of all beams, W."""
        return sum(path.light.cone.power for path in self.paths if path.mirror is None)

    @property
    def strength(self) -> float:
        """Momentum per time of all beams, n_m P/c, N."""
        return self.momentum_per_energy * self.power

    @property
    def absorbs(self) -> bool:
        """Whether the sphere absorbs light."""
        return self.paths[0].light.absorbs

    @property
    def foci(self) -> Array:
        """Positions about which light is brightest at the time 0, (n, 3) m."""
        found = []
        for path in self.paths:
            sign = np.array([1, -1, -1] if path.down else [1, 1, 1])
            places = path.place.at(0.0) + sign * path.light.foci
            if path.mirror is not None:  # an image is in the light if the focus is beyond
                places[:, 2] = 2 * path.mirror - places[:, 2]
                before = places[:, 2] - path.mirror
                places = places[before > 0 if path.down else before < 0]
            found.append(places)
        return np.concatenate(found)

    @property
    def search(self) -> Search:
        """Lengths by which the force is searched; see `Light.search`."""
        every = [path.light.search for path in self.paths]
        away = max(float(np.linalg.norm(path.place.at(0.0))) for path in self.paths)
        return Search(
            near=max(each.near for each in every),
            spacing=min(each.spacing for each in every),
            beside=min(each.beside for each in every),
            reach=max(each.reach for each in every),
            # fringes of light from both sides have a period of half a wavelength
            coarsest=min(each.spacing for each in every) / 2,
            known=min(each.known for each in every) - away,
        )

    @property
    def box(self) -> Box:
        """Box in which positions off the axis are searched: the widest of the paths'."""
        return max((path.light.box for path in self.paths), key=lambda box: box.width)

    def of_radius(self, radius: float) -> Interference:
        """Return this light with the sphere scaled to another radius, m."""
        paths = tuple(
            dataclasses.replace(path, light=path.light.of_radius(radius)) for path in self.paths
        )
        return dataclasses.replace(self, radius=radius, paths=paths)


@dataclass(frozen=True, eq=False)
class ByInterference(LightForce):
    """Force of light whose paths interfere, by sums over partial waves."""

    light: Interference
    """the light, and the sphere"""
    tolerance: float
    """relative, of the force"""
    reach: float
    """distance from the origin of the scene up to which the force is computed, m"""
    end: float
    """last time of the scene, s"""

    @property
    def steady(self) -> bool:
        """Whether no path moves or changes."""
        return all(course.steady for course in self._courses)

    @property
    def _courses(self) -> list[Course]:
        """Courses of all paths in time."""
        return [each for path in self.light.paths
                for each in (path.place, path.strength, path.phase)]  # fmt: skip

    def kinks(self, end: float) -> Array:
        """Return the times in (0, end) at which the force jumps or bends, s; see `Force.kinks`."""
        return np.unique(np.concatenate([each.kinks(end) for each in self._courses]))

    def shortest_time(self, end: float) -> float:
        """Return the shortest time scale of changes, s: of courses, and a period of the phase."""
        times = [each.shortest_time(end) for each in self._courses]
        for path in self.light.paths:
            change = np.abs(np.diff(path.phase.values[:, 0]))
            between = np.diff(path.phase.times)
            moving = (change > 0) & (between > 0)
            times += (2 * math.pi * between[moving] / change[moving]).tolist()
        return min(filter(None, times), default=0.0)

    def compiled(self, *, gradient: bool) -> tuple[Kernel, Data]:  # noqa: ARG002
        """Return the kernel of this force and its data; see `Force.compiled`."""
        return coherent_kernel(moment=self.light.absorbs), self._data

    @functools.cached_property
    def _data(self) -> Data:
        """Data of the compiled sums."""
        light, small = self.light, max(SMALL * self.tolerance, ROUNDING)
        one = light.paths[0].light
        sphere, needed, highest = sphere_and_degree(one, small, components=2)
        bound = bound_paths(light.paths, highest, needed + 1, self.reach, self.end, small)
        together = sum(
            math.sqrt(path.light.strength / light.strength) for path in light.paths
        )  # largest amplitude, if all paths add up
        return packed(
            light.strength * UNIT, light.strength, self.tolerance,
            together * bound.error * light.strength,
            of_states(one.states), guarded_elements(np.stack(elements(highest))), sphere,
            *bound.entries,
        )  # fmt: skip

    def absorbed_power(self, positions: Array, *, time: float = 0.0) -> Array:
        """Return the power of the light that the bead absorbs at `positions` (n, 3) m, (n,) W."""
        if not self.light.absorbs:
            return super().absorbed_power(positions, time=time)
        share: Array = coherent_absorption()(
            np.require(positions, np.float64, ["C", "W"]), time, self._data
        )
        return share * self.light.power

    def allowed_error(self, force: Array) -> Array:
        """Return the largest error within the tolerance, (n,) N; force: (n, 3) N."""
        size = np.linalg.norm(force, axis=1)
        many = len(self.light.paths)
        return 2 * self.tolerance * (size + many * SMALL * self.light.strength)

    def of_radius(self, radius: float) -> ByInterference:
        """Return the force of the same light on a bead of another radius, m."""
        return dataclasses.replace(self, light=self.light.of_radius(radius))


def paths_of(
    scene: Scene, beam: Beam, place: Course, strength: Course, phase: Course
) -> list[Path]:
    """Return the path of a beam, and the paths that planes behind the bead reflect.

    Parameters
    ----------
    scene : Scene
        The scene.
    beam : Beam
        A lit beam of the scene.
    place, strength, phase : Course
        Position of its focus, factor of its power, and phase in time.
    """
    alone = scene.with_one_beam(beam)
    own = waves_on_bead(alone)
    pupil = own.pupil or Pupil((), scene.lens.map == "tan", relative_radius(alone))
    n_m = scene.medium.refractive_index
    down = beam.direction == "down"

    def light(*, mixing: bool) -> Waves:
        """Return the light with parts of both helicities if a face is `mixing` them."""
        of = states(
            beam.polarisation, jones_vector(beam), beam.vortex, face=mixing, uneven=True,
            order=(beam.order or 0, beam.order_phase),
        )  # fmt: skip
        return dataclasses.replace(own, pupil=pupil, states=of)

    faced = own.face is not None
    found = [Path(light(mixing=faced), place, strength, phase, down)]
    for plane in reflecting(scene, beam):
        index = None if plane.refractive_index is None else plane.refractive_index / n_m
        if index == 1:  # nothing is reflected
            continue
        image = reflected(light(mixing=faced or index is not None), index)
        found.append(Path(image, place, strength, phase, down, plane.position))
    return found


def by_interference(scene: Scene, paths: tuple[Path, ...]) -> ByInterference:
    """Return the force of paths of light that interfere."""
    first = paths[0].light
    checked_size(scene, first)
    light = Interference(first.cone, first.momentum_per_energy, first.radius, paths)
    simulation = scene.simulation
    return ByInterference(
        light, scene.optics.tolerance, BEYOND_LOSS * simulation.loss_distance, simulation.duration
    )


@functools.cache
def _summed(*, moment: bool) -> Callable[..., Any]:
    """Return the compiled function that fills `sums` for a bead at (x, y, z), m."""

    @named_njit(**OPTIONS)
    def add_up(data, gradient, time, x, y, z, room, sums):  # type: ignore[no-untyped-def]
        """Fill `sums` (25,) with the sums over all states, in the order of `kernel`.

        Returns whether the bead is near enough to the foci.
        """
        table, spheres = matrix(data, STATES), matrix(data, SPHERE)
        elements_of, top = vector(data, ELEMENTS), int(number(data, _PATHS + 2))
        source = first_source(data, _PATHS)
        wavenumber, stride = source.wavenumber, source.highest + 1
        size = (2 * source.highest + 1) * stride
        imaginary = (2 * top + 5) * stride
        sums[:] = 0.0
        if not add_paths(data, _PATHS, time, x, y, z, room):
            return False
        for state in range(table.shape[0]):
            P = room.waves[2 * state : 2 * state + 2]
            electric_and_magnetic(P, 2 * imaginary + LANES)
            room.found[:] = 0.0
            for k in range(2):
                light = AboutBead(P[k], P[1 - k], imaginary, -top, top, 2 * stride + LANES)
                weights = Weights(elements_of, spheres[k], stride, size)
                if gradient:
                    force_and_gradient_sum(light, weights, wavenumber, room.found)
                else:
                    force_sum(light, weights, room.found)
                if moment:
                    moment_sum(light, weights, wavenumber, room.found)
                    if gradient:
                        moment_gradient_sum(light, weights, room.found)
            for i in range(FOUND):
                sums[i] += table[state, SHARE] * room.found[i]
        return True

    return add_up


@functools.cache
def coherent_kernel(*, moment: bool) -> Kernel:
    """Return the kernel that adds the force of light that interferes.

    It adds the torque if `moment`, and gradients if the wrench has arrays for them. The error of a
    bead too far from a focus for every rule is infinite.
    """
    add_up = _summed(moment=moment)

    @cached_njit(KERNEL, error_model="numpy", nogil=True)
    def add_coherent_force(pose, data, wrench):  # type: ignore[no-untyped-def]
        """Add the force of light that interferes, as a kernel."""
        strength = number(data, STRENGTH)
        tolerance, floor = number(data, TOLERANCE), number(data, FLOOR)
        room = room_for_paths(data, _PATHS)
        sums, gradient = np.empty(FOUND), len(wrench.force_gradient) > 0
        for at in range(pose.position.shape[0]):
            x, y, z = pose.position[at, 0], pose.position[at, 1], pose.position[at, 2]
            if not add_up(data, gradient, pose.time[at], x, y, z, room, sums):
                wrench.error[at] = math.inf
                continue
            for i in range(FOUND):
                sums[i] *= strength
            size = math.sqrt(sums[0] ** 2 + sums[1] ** 2 + sums[2] ** 2)
            wrench.error[at] += tolerance * size + floor
            put(sums, 1.0, 0.0, gradient, moment, at, wrench)

    return add_coherent_force


@functools.cache
def coherent_absorption() -> Any:
    """Return the compiled function of the share of all power that a bead absorbs, (n,).

    Its arguments are positions (n, 3), m, a time, s, and the data of `coherent_kernel`.
    """
    add_up = _summed(moment=True)

    @cached_njit(_ABSORPTION, error_model="numpy", nogil=True)
    def absorbed(positions, time, data):  # type: ignore[no-untyped-def]
        """Return the share of the power that beads at positions (n, 3), m, absorb, (n,)."""
        room = room_for_paths(data, _PATHS)
        sums, out = np.empty(FOUND), np.empty(positions.shape[0])
        unit = number(data, STRENGTH) / number(data, OF_ALL)
        for at in range(positions.shape[0]):
            x, y, z = positions[at, 0], positions[at, 1], positions[at, 2]
            out[at] = math.nan
            if add_up(data, False, time, x, y, z, room, sums):
                out[at] = unit * sums[ABSORBED]
        return out

    return absorbed
