"""The force of a scene's light on its bead, bound once and evaluated many times."""

from __future__ import annotations

import dataclasses
import functools
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from tweezer.forces.composed import Course, Moved, Sum
from tweezer.forces.data import Data, packed
from tweezer.forces.equilibria import Search
from tweezer.forces.force import Kernel, Wrench, no_force
from tweezer.optics.light import LightForce, error_by
from tweezer.optics.table import Progress, Table
from tweezer.optics.worth import ray_optics_caveat
from tweezer.scene import Scene, SceneLike, checked_scene
from tweezer.scene.choices import THEORIES, at, evaluator
from tweezer.scene.sections import Beam
from tweezer.values.errors import SceneError, warn
from tweezer.values.printed import in_unit, printed
from tweezer.values.units import QuantitiesLike, QuantityLike, array_in_si, to_si

Array = NDArray[np.float64]

#: Time longer than any run, s
_FOREVER = 1e9
#: How far into a wall a place may lie, in radii: as numbers are rounded
_ROUNDED = 1e-3
#: Largest deviation of the light from its table without a warning, as a part of the peak
_UNEVEN = 1e-3


@dataclass(frozen=True)
class Beams(Sum):
    """The light of several beams, or of one that moves or changes: the sum of their forces.

    The beams do not interfere: they come from different lasers, or differ in polarisation.
    """

    forces: tuple[Moved, ...]
    lights: tuple[LightForce, ...]
    """of each beam, about its own focus"""

    symmetric: ClassVar[bool] = False
    """whether the force is the same all around one axis"""

    @property
    def smooth(self) -> bool:
        """See `LightForce.smooth`."""
        return all(each.smooth for each in self.lights)

    def error_of(self, positions: Array, field: Wrench, time: float | Array = 0.0) -> Array:
        """See `LightForce.error_of`."""
        return error_by(self._certain, positions, field, time)

    @property
    def search(self) -> Search:
        """The farthest and finest of each light's."""
        every = [each.search for each in self.lights]
        return Search(
            near=max(each.near for each in every),
            spacing=min(each.spacing for each in every),
            beside=min(each.beside for each in every),
            reach=max(each.reach for each in every),
            coarsest=min(each.coarsest for each in every),
            known=min(
                each.known - float(np.linalg.norm(moved.place.at(0.0)))
                for each, moved in zip(every, self.forces, strict=True)
            ),
        )

    def absorbed_power(self, positions: Array, time: float = 0.0) -> Array:
        """Power of the light that the bead absorbs at `positions` (n, 3) m at a time, s, (n,) W."""
        lost = sum(
            float(moved.strength.at(time)[0]) * each.absorbed_power(moved.within(positions, time))
            for moved, each in zip(self.forces, self.lights, strict=True)
        )
        return np.asarray(lost)

    @functools.cached_property
    def _certain(self) -> Sum:
        return Sum(tuple(
            dataclasses.replace(moved, force=each.certain())
            for moved, each in zip(self.forces, self.lights, strict=True)
        ))  # fmt: skip


@functools.lru_cache(maxsize=16)
def light(scene: Scene) -> LightForce | Beams:
    """The force of the light of `scene`, by the evaluator that its `optics` section names.

    The forces of several beams add up, as if the beams did not interfere.
    """
    if scene.plain:
        return light_of_one_beam(scene)
    places = [_place(beam) for beam in scene.beams]
    offset = max(place.farthest(scene.simulation.duration) for place in places)
    lights = tuple(light_of_one_beam(scene.with_one_beam(beam, offset)) for beam in scene.beams)
    moved = tuple(
        Moved(each, place, _factor(beam), down=beam.direction == "down")
        for each, place, beam in zip(lights, places, scene.beams, strict=True)
    )
    return Beams(moved, lights)


def _place(beam: Beam) -> Course:
    """Position of the focus of a beam in time, m."""
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
    return Course(times, places, none, period=motion.period or np.inf)


def _factor(beam: Beam) -> Course:
    """Factor of a beam's power in time."""
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
    return Course(times, factors, none, period=modulation.period or np.inf)


def _stairs(times: Array, values: Array, before: Array) -> tuple[Array, Array]:
    """Points of a course that jumps to each of `values` (n, m) at its time."""
    stairs = np.repeat(np.vstack([before, values]), 2, axis=0)[1:-1]
    return np.repeat(times, 2), stairs


@functools.lru_cache(maxsize=16)
def light_of_one_beam(scene: Scene) -> LightForce:
    """The force of the light of a scene's only beam.

    The map is computed if the user's cache folder does not hold it: see `force_map`. Warns once
    (`PhysicsWarning`) how far ray optics holds: see `ray_optics_caveat`. Warns if the series of a
    beam's table deviates from it by more than 0.1 % of the peak.
    """
    if scene.theory == "rays" and (caveat := ray_optics_caveat(scene)) is not None:
        _warn_once(caveat)
    if not scene.lit:
        from tweezer.optics.rays.light import light_on_bead

        return Dark(light_on_bead(scene))
    force: LightForce = evaluator(scene.optics.evaluator).load(scene.theory)(scene)
    if (off := force.light.cone.deviation) > _UNEVEN:
        warn(
            f"beam.profile_intensity: points so uneven that the light summed differs from them by "
            f"up to {100 * off:.2g} % of the peak",
        )
    return force


@dataclass(frozen=True, eq=False)
class Dark(LightForce):
    """No light."""

    scales = True

    def compiled(self, *, gradient: bool) -> tuple[Kernel, Data]:  # noqa: ARG002
        """See `Force.compiled`."""
        return no_force, packed()


def force_map(scene: Scene, progress: Progress | None = None) -> Table:
    """The table of the force of a scene's light, from the user's cache folder or computed and
    stored.

    It reaches `optics.table_range` from the focus. Its tolerance is `optics.table_tolerance`
    times the largest force there. progress: called with the finished part, 0 to 1, while it is
    computed; a second process that needs the same table waits for the first. One table serves every
    power of the light, and all scenes that differ only in scale; of waves, the wavelength too.

    Raises `SceneError` for a scene without light, or for linear polarisation of rays. Warns
    (`PhysicsWarning`) if the tolerance is not reached; `Table.certified_error` is the bound that
    holds. Warns if the file is damaged, and is then computed again, or if it cannot be written.
    """
    if scene.more_beams:
        raise SceneError("beam: a map is of one beam; a run makes that of each that it needs")
    if not scene.lit:
        raise SceneError("optics.evaluator = 'map': there is no light to map the force of")
    made: Table = at(THEORIES[scene.theory].map)(scene, progress)
    return made


def evaluators_of(scene: Scene) -> str:
    """Names of the evaluators of the beams of `scene`; "dark" for a beam without light."""
    name = evaluator(scene.optics.evaluator).name
    lit = {scene.with_one_beam(beam).lit for beam in scene.beams}
    return ", ".join(sorted(name if each else "dark" for each in lit))


@functools.cache
def _warn_once(text: str) -> None:
    """Warn once in a process, whatever its warning filters are."""
    warn(text)


def optical_force(
    scene: SceneLike, positions: QuantitiesLike, *, time: QuantityLike = 0.0
) -> Array:
    """Force of the light on the bead (3.26), N.

    positions: (..., 3) m from the focus, z along the light. time: s, of beams that move or change.
    Returns (..., 3).
    Raises `ValueError` for another shape or a position that is not finite, and `SceneError` where
    the bead would be inside a wall or a cover glass. Warns (`PhysicsWarning`) if the quadrature
    misses its tolerance; `optical_force_error` has the errors.
    """
    field, shape = _field(scene, positions, time)
    return field.force.reshape(shape)


def optical_force_error(
    scene: SceneLike, positions: QuantitiesLike, *, time: QuantityLike = 0.0
) -> Array:
    """Error of the force of the light on the bead, N.

    positions: (..., 3) m from the focus. time: s. Returns (...): as estimated, or certified by the
    map, or for the thesis's grid the distance to the quadrature. What the theory of light leaves
    out is not in it. Raises as `optical_force`.
    """
    scene = checked_scene(scene)
    places, shape = _places(scene, positions)
    force, time = light(scene), to_si(time, "s")
    field = force.field(places, time=time)
    return force.error_of(places, field, time).reshape(shape[:-1])


def optical_jacobian(
    scene: SceneLike, positions: QuantitiesLike, *, time: QuantityLike = 0.0
) -> Array:
    """Derivative of the force over the position, N/m: [..., i, j] = dF_i/dx_j.

    positions: (..., 3) m from the focus. time: s. Returns (..., 3, 3). Raises as
    `optical_force`. The sum over the grid's rays jumps where a ray begins or ceases to hit the
    bead; the derivative leaves the jumps out.
    """
    field, shape = _field(scene, positions, time, gradient=True)
    return field.force_gradient.reshape((*shape, 3))


def optical_torque(
    scene: SceneLike, positions: QuantitiesLike, *, time: QuantityLike = 0.0
) -> Array:
    """Moment of the light about the bead's centre, inertial frame, N m.

    positions: (..., 3) m from the focus. time: s. Returns (..., 3). Zero for a sphere that absorbs
    nothing: every ray leaves it with the impact parameter it came with, and every wave with its
    angular momentum. An absorbing one takes that of the light it absorbs. With
    `beam.torque = "thesis"` the moment (3.25).
    Raises as `optical_force`.
    """
    field, shape = _field(scene, positions, time)
    return field.moment.reshape(shape)


def absorbed_power(
    scene: SceneLike, positions: QuantitiesLike, *, time: QuantityLike = 0.0
) -> Array:
    """Power of the light that the bead absorbs, W.

    positions: (..., 3) m from the focus. time: s. Returns (...). Zero unless an index is complex.
    Raises as `optical_force`.
    """
    scene = checked_scene(scene)
    places, shape = _places(scene, positions)
    force, time = light(scene), to_si(time, "s")
    if isinstance(force, LightForce):
        return force.absorbed_power(places).reshape(shape[:-1])
    return force.absorbed_power(places, time).reshape(shape[:-1])


def _places(scene: Scene, positions: QuantitiesLike) -> tuple[Array, tuple[int, ...]]:
    """`positions` (..., 3) as a list of n, and their shape; refused in a wall of `scene`."""
    try:
        array = np.ascontiguousarray(array_in_si(positions, "m"))
    except ValueError as error:
        raise ValueError(f"positions: {error}") from None
    if array.ndim == 0 or array.shape[-1] != 3:
        raise ValueError(f"positions must have the shape (..., 3), not {array.shape}")
    if not np.isfinite(array).all():
        raise ValueError("positions must be finite")
    places = array.reshape(-1, 3)
    _outside_walls(scene, places)
    return places, array.shape


def _outside_walls(scene: Scene, places: Array) -> None:
    """Refuse places (n, 3) m at which the bead would reach into a wall, or the glass of a cover."""
    body, cover = scene.body, scene.lens.cover
    walls = {z: (normal, "wall") for z, normal in (scene.wall.planes if scene.wall else ())}
    if cover is not None:
        for beam in scene.beams:
            normal = 1.0 if beam.direction == "up" else -1.0
            walls[-normal * cover.depth] = normal, "cover glass"
    for z, (normal, name) in walls.items():
        inside = np.flatnonzero(normal * (places[:, 2] - z) < (1 - _ROUNDED) * body.support(normal))
        if inside.size:
            place = ", ".join(in_unit(each, "um") for each in places[inside[0]])
            raise SceneError(
                f"positions: at ({place}) um a bead of radius {printed(body.size, 'um')} reaches "
                f"into the {name} at z = {printed(z, 'um')}, where no force is known"
            )


def _field(
    scene: SceneLike, positions: QuantitiesLike, time: QuantityLike, *, gradient: bool = False
) -> tuple[Wrench, tuple[int, ...]]:
    """Force and moment at `positions` (..., 3) as a list of n, and the shape of `positions`."""
    scene = checked_scene(scene)
    places, shape = _places(scene, positions)
    force, time = light(scene), to_si(time, "s")
    field = force.field(places, gradient=gradient, time=time)
    tolerance = scene.optics.tolerance
    doubtful = field.error > tolerance * np.linalg.norm(field.force, axis=1)
    if doubtful.any():
        allowed = _allowed_error(force, places[doubtful], time)
        ratio = field.error[doubtful] / allowed
        if (missed := ratio > 1).any():
            warn(
                f"the quadrature misses optics.tolerance = {tolerance:g} at {missed.sum()} of "
                f"{len(places)} places: estimated errors are up to {ratio.max():.2g} times what it "
                "allows",
            )
    return field, shape


def _allowed_error(force: LightForce | Beams, positions: Array, time: float) -> Array:
    """Error allowed at `positions` (n, 3) m by the tolerance, of all beams together, (n,) N."""
    if isinstance(force, LightForce):
        return force.allowed_error(force.field(positions).force)
    allowed = np.zeros(len(positions))
    for moved, each in zip(force.forces, force.lights, strict=True):
        if strength := abs(float(moved.strength.at(time)[0])):
            of_beam = moved.field(positions, time=time).force / strength
            allowed += strength * each.allowed_error(of_beam)
    return allowed
