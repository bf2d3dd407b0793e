"""The force of a scene's light on its bead, bound once and evaluated many times."""

from __future__ import annotations

import dataclasses
import functools
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tweezer.compiled import address
from tweezer.errors import SceneError, warn
from tweezer.forces.composed import Course, Moved, Sum
from tweezer.forces.data import Data, Part, packed
from tweezer.forces.force import KERNEL, Force, Kernel, Wrench, bound, evaluated, no_force
from tweezer.optics import charts
from tweezer.optics.beam import Cone, cone
from tweezer.optics.culling import Tiles, tiles
from tweezer.optics.kernels import (
    VANISHING,
    Rays,
    Sphere,
    grid_data,
    grid_kernel,
    quadrature_data,
    quadrature_kernel,
)
from tweezer.optics.quadrature import Rule, rule
from tweezer.optics.rays import grid
from tweezer.optics.table import Table, stored
from tweezer.optics.tabulate import Progress
from tweezer.optics.worth import ray_optics_caveat
from tweezer.scene import NO_MAP, Beam, Scene, checked_scene

Array = NDArray[np.float64]

SPEED_OF_LIGHT = 299792458.0
"""c, m/s (Table B.1)"""

#: an estimated error of so many tolerances is told, beyond what rounding leaves of all the light
MISSED, ROUNDING = 2.0, 1e-14
#: s, longer than any run
_FOREVER = 1e9
#: a deviation of the light from its table that is told, of the largest radiance
_UNEVEN = 1e-3


@dataclass(frozen=True, eq=False)
class Light(Force):
    """The light of a scene and what gives its force; no source is darkness."""

    source: Tiles | Rule | Table | None
    cone: Cone
    momentum_per_energy: float
    """n_m/c, s/m, of the rays"""
    radius: float
    index_ratio: float
    polarisation: str
    jones: Array
    torque: bool
    tolerance: float
    """relative, of the quadrature that stands in where a table does not reach, and that the error
    of the grid is told by"""

    @property
    def evaluator(self) -> str:
        """What gives the force: "grid", "quadrature", "map", or "dark"."""
        match self.source:
            case None:
                return "dark"
            case Tiles():
                return "grid"
            case Rule():
                return "quadrature"
        return "map"

    @property
    def strength(self) -> float:
        """n_m P/c of all rays, N."""
        return self.momentum_per_energy * self.cone.power

    def field(
        self,
        positions: Array,
        *,
        gradient: bool = False,
        time: float | Array = 0.0,
        orientations: Array | None = None,
    ) -> Wrench:
        """See `Force.field`. What is not asked for costs nothing."""
        if gradient not in self._parts:
            kernel = address(self._kernel(gradient=gradient), KERNEL)
            self._parts[gradient] = Part(kernel, self._alone)
        wrench = evaluated(self._parts[gradient], positions, gradient, time, orientations)
        outside = np.isinf(wrench.error)
        if outside.any():  # else the quadrature need not be compiled
            beyond = self._integral.field(positions[outside], gradient=gradient)
            for of_all, there in zip(wrench, beyond, strict=True):
                if len(of_all):
                    of_all[outside] = there
        return wrench

    def compiled(self, *, gradient: bool) -> tuple[Kernel, Data]:
        """As `tweezer.forces.Force`: where a table does not reach, the quadrature stands in."""
        if not isinstance(self.source, Table):
            data = self._alone
        else:
            data = self._with_gradient if gradient else self._without_gradient
        return self._kernel(gradient=gradient), data

    def _kernel(self, *, gradient: bool) -> Kernel:
        rays = Rays(self.polarisation, self.index_ratio > 1, gradient, self.torque)
        match self.source:
            case Tiles():
                return grid_kernel(rays)
            case Rule():
                return quadrature_kernel(rays)
            case Table(made):
                return charts.kernel(gradient=gradient, moment=made.moment)
        return no_force

    @functools.cached_property
    def _alone(self) -> Data:
        """Of a table: with an infinite error where it does not reach."""
        sphere = Sphere(self.radius, self.index_ratio)
        match self.source:
            case Tiles() as source:
                return grid_data(source, sphere, self.jones)
            case Rule() as source:
                return quadrature_data(source, sphere, self.jones)
            case Table():
                return self._of_table(charts.unreached())
        return packed()

    @functools.cached_property
    def _parts(self) -> dict[bool, Part]:
        """`_alone` with the kernel for gradients or without, once used."""
        return {}

    @functools.cached_property
    def _with_gradient(self) -> Data:
        return self._of_table(bound(self._integral, gradient=True))

    @functools.cached_property
    def _without_gradient(self) -> Data:
        return self._of_table(bound(self._integral, gradient=False))

    def _of_table(self, beyond: Part) -> Data:
        assert isinstance(self.source, Table)
        return self.source.made.data(self.radius, self.strength, beyond)

    @functools.cached_property
    def _integral(self) -> Light:
        return self.by_quadrature(self.tolerance)

    def error_of(self, positions: Array, field: Wrench, time: float | Array = 0.0) -> Array:
        """Error of the force of `field`, which is this light's at `positions`, (n,) N.

        The sum over the thesis's grid tells none: its error is the distance to the quadrature.
        """
        if self.evaluator != "grid":
            return field.error
        exact = self._integral.field(positions, time=time)
        return np.linalg.norm(field.force - exact.force, axis=1) + exact.error

    def by_quadrature(self, tolerance: float) -> Light:
        """The same light, its force by the quadrature to that relative tolerance."""
        source = rule(
            self.cone.half_angle,
            self.momentum_per_energy * self.cone.series,
            self.strength,
            tolerance,
        )
        return dataclasses.replace(self, source=source)

    def of_radius(self, radius: float) -> Light:
        """The same light on a bead of another radius, m: ray optics goes by places in radii."""
        if radius == self.radius:
            return self
        source = self.source
        if isinstance(source, Table):
            source = dataclasses.replace(source, radius=radius)
        return dataclasses.replace(self, radius=radius, source=source)


@dataclass(frozen=True)
class Beams(Sum):
    """The light of several beams, or of one that is moved: a force about each focus, added up.

    The beams do not interfere: their light is of different lasers, or of different polarisation.
    """

    forces: tuple[Moved, ...]
    lights: tuple[Light, ...]
    """of each beam, about its own focus"""

    @property
    def evaluator(self) -> str:
        """As `Light.evaluator`."""
        return ", ".join(sorted({each.evaluator for each in self.lights}))

    def error_of(self, positions: Array, field: Wrench, time: float | Array = 0.0) -> Array:
        """As `Light.error_of`."""
        if not np.isnan(field.error).any():
            return field.error
        exact = self._integral.field(positions, time=time)
        return np.linalg.norm(field.force - exact.force, axis=1) + exact.error

    @functools.cached_property
    def _integral(self) -> Sum:
        """The same light by the quadrature."""
        return Sum(tuple(
            dataclasses.replace(moved, force=each.by_quadrature(each.tolerance))
            for moved, each in zip(self.forces, self.lights, strict=True)
        ))  # fmt: skip


@functools.lru_cache(maxsize=16)
def light(scene: Scene) -> Light | Beams:
    """The light of `scene`, with the evaluator that its `optics` section names.

    That of several beams is added up as if they did not interfere.
    """
    if scene.plain:
        return light_of_one_beam(scene)
    lights = tuple(light_of_one_beam(scene.with_one_beam(beam)) for beam in scene.beams)
    moved = tuple(
        Moved(each, _place(beam), _factor(beam), down=beam.direction == "down")
        for each, beam in zip(lights, scene.beams, strict=True)
    )
    return Beams(moved, lights)


def _place(beam: Beam) -> Course:
    """Where the focus of a beam is, m."""
    at, motion, none = np.array([beam.position]), beam.motion, np.zeros(3)
    if motion is None:
        return Course(np.zeros(1), at, none)
    match motion.kind:
        case "sine":
            amplitude = np.array(motion.amplitude)
            return Course(np.zeros(1), at, amplitude, motion.frequency or 0.0, motion.phase or 0.0)
        case "ramp":
            begin, end = motion.begin or 0.0, motion.end or _FOREVER
            way = np.outer([0.0, end - begin], motion.velocity)  # type: ignore[arg-type]
            return Course(np.array([begin, end]), at + way, none)
    times, places = np.array(motion.times), at + np.array(motion.positions)
    if motion.kind == "steps":
        times, places = _stairs(times, places, at[0])
    return Course(times, places, none)


def _factor(beam: Beam) -> Course:
    """The factor of a beam's power."""
    modulation, none = beam.modulation, np.zeros(1)
    if modulation is None:
        return Course.constant(1.0)
    frequency = modulation.frequency or 0.0
    match modulation.kind:
        case "sine":
            depth = np.array([modulation.depth])
            return Course(np.zeros(1), np.ones((1, 1)), depth, frequency, modulation.phase or 0.0)
        case "ramp":
            times = np.array([modulation.begin or 0.0, modulation.end])
            return Course(times, np.array([[1.0], [modulation.factor]]), none)
        case "on-off":
            duty = 0.5 if modulation.duty is None else modulation.duty
            times = np.array([0.0, duty, duty, 1.0]) / frequency
            values = np.array([[1.0], [1.0], [0.0], [0.0]])
            return Course(times, values, none, period=1 / frequency)
    times, factors = np.array(modulation.times), np.array([modulation.factors]).T
    if modulation.kind == "steps":
        times, factors = _stairs(times, factors, np.ones(1))
    return Course(times, factors, none)


def _stairs(times: Array, values: Array, before: Array) -> tuple[Array, Array]:
    """Points of a course that goes at once to each of `values` (n, m) at its time."""
    stairs = np.repeat(np.vstack([before, values]), 2, axis=0)[1:-1]
    return np.repeat(times, 2), stairs


@functools.lru_cache(maxsize=16)
def light_of_one_beam(scene: Scene) -> Light:
    """The light of the one beam of a scene.

    The map is made if the user's cache folder does not hold it: see `force_map`. Warns once
    (`PhysicsWarning`) of what ray optics is worth: see `ray_optics_caveat`. Warns of a beam's
    table that its series does not follow to 0.1 % of the peak.
    """
    if (caveat := ray_optics_caveat(scene)) is not None:
        _warn_once(caveat)
    dark = _dark(scene)
    if not scene.lit:
        return dark
    if (off := dark.cone.deviation) > _UNEVEN:
        warn(
            f"beam.profile_intensity: points so uneven that the light summed differs from them by "
            f"up to {100 * off:.2g} % of the peak",
        )
    if scene.optics.evaluator == "grid":
        rays = grid(scene.lens, scene.beam, scene.medium)
        source = tiles(rays.directions, dark.momentum_per_energy * rays.powers)
        return dataclasses.replace(dark, source=source)
    if scene.optics.evaluator == "map":
        return dataclasses.replace(dark, source=force_map(scene))
    return dark.by_quadrature(scene.optics.tolerance)


@functools.cache
def _warn_once(text: str) -> None:
    """Once in a program, whatever becomes of its filters."""
    warn(text)


def _dark(scene: Scene) -> Light:
    """The light of `scene`, without what gives its force."""
    n_m = scene.medium.refractive_index
    jones = scene.beam.jones or ((0.0, 0.0), (0.0, 0.0))
    return Light(
        source=None,
        cone=cone(scene),
        momentum_per_energy=n_m / SPEED_OF_LIGHT,
        radius=scene.bead.radius,
        index_ratio=n_m / scene.bead.refractive_index,
        polarisation=scene.beam.polarisation,
        jones=np.array(jones).ravel(),
        torque=scene.beam.torque == "thesis",
        tolerance=scene.optics.tolerance,
    )


def force_map(scene: Scene, progress: Progress | None = None) -> Table:
    """The table of the force of a scene's light: from the user's cache folder, or made and kept.

    It reaches `optics.table_range` radii from the focus, and is made to `optics.table_tolerance`
    of the largest force there. progress: called with the part done, 0 to 1, while it is made; a
    second process that wants the same table waits for the first. One table serves every power of
    the light, and all scenes that differ in scale alone.

    Raises `SceneError` for a scene without light, or with linear polarisation. Warns if the
    tolerance is not reached (`PhysicsWarning`): `Table.certified_error` is what is. Warns if the
    file is damaged, and it is made again, or if it cannot be written.
    """
    if scene.more_beams:
        raise SceneError("beam: a map is of one beam; a run makes that of each that it needs")
    dark = _dark(scene)
    if not scene.lit:
        raise SceneError("optics.evaluator = 'map': there is no light to map the force of")
    if scene.beam.polarisation == "linear":
        raise SceneError(NO_MAP)
    in_radii = dataclasses.replace(dark, radius=1.0, momentum_per_energy=1 / dark.cone.power)
    made, path = stored(in_radii, scene.optics, progress)
    return Table(made, dark.radius, dark.strength, path)


def optical_force(scene: Scene, positions: ArrayLike, *, time: float = 0.0) -> Array:
    """Force of the light on the bead (3.26), N.

    positions: (..., 3) m from the focus, z along the light. time: s, of beams that move or change.
    Returns (..., 3).
    Raises `ValueError` for another shape or a position that is not finite. Warns (`PhysicsWarning`)
    where the quadrature misses its tolerance; `light(scene).field` tells by how much.
    """
    field, shape = _field(scene, positions, time)
    return field.force.reshape(shape)


def optical_jacobian(scene: Scene, positions: ArrayLike, *, time: float = 0.0) -> Array:
    """Derivative of the force over the position, N/m: [..., i, j] = dF_i/dx_j.

    positions: (..., 3) m from the focus. time: s. Returns (..., 3, 3). Raises `ValueError` as
    `optical_force`. Of the sum over the grid's rays: rays that begin or cease to hit the bead
    make that sum jump, and the jumps are not in its derivative.
    """
    field, shape = _field(scene, positions, time, gradient=True)
    return field.force_gradient.reshape((*shape, 3))


def optical_torque(scene: Scene, positions: ArrayLike, *, time: float = 0.0) -> Array:
    """Moment of the light about the bead's centre, inertial frame, N m.

    positions: (..., 3) m from the focus. time: s. Returns (..., 3). Zero for
    `beam.torque = "none"`: every ray leaves a lossless isotropic sphere with the impact parameter
    it came with, so it leaves its angular momentum as it was. With "thesis" the moment (3.25).
    Raises `ValueError` as `optical_force`.
    """
    field, shape = _field(scene, positions, time)
    return field.moment.reshape(shape)


def _field(
    scene: Scene, positions: ArrayLike, time: float, *, gradient: bool = False
) -> tuple[Wrench, tuple[int, ...]]:
    """What the light does at `positions` (..., 3), as at (n, 3), and their shape."""
    array = np.ascontiguousarray(positions, dtype=np.float64)
    if array.ndim == 0 or array.shape[-1] != 3:
        raise ValueError(f"positions must have the shape (..., 3), not {array.shape}")
    if not np.isfinite(array).all():
        raise ValueError("positions must be finite")
    bound = light(checked_scene(scene))
    field = bound.field(array.reshape(-1, 3), gradient=gradient, time=time)
    if isinstance(bound, Light) and isinstance(bound.source, Rule):
        size = np.maximum(np.linalg.norm(field.force, axis=1), VANISHING * bound.strength)
        allowed = MISSED * bound.tolerance * size + ROUNDING * bound.strength
        if (missed := field.error > allowed).any():
            worst = (field.error / size).max()
            warn(
                f"the quadrature misses optics.tolerance = {bound.tolerance:g} at {missed.sum()} "
                f"of {missed.size} places: estimated errors reach {worst:.1g} of the force there",
            )
    return field, array.shape
