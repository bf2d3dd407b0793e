"""The force of a scene's light on its bead, bound once and evaluated many times."""

from __future__ import annotations

import dataclasses
import functools
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from tweezer.forces.composed import Course, Moved, Sum
from tweezer.forces.data import Data, Part, packed
from tweezer.forces.equilibria import Search
from tweezer.forces.force import Kernel, Wrench, bound, evaluated, no_force
from tweezer.optics.light import LightForce, error_by
from tweezer.optics.table import Progress, Table
from tweezer.optics.worth import ray_optics_warning
from tweezer.scene import Scene
from tweezer.scene.choices import THEORIES, at, evaluator
from tweezer.scene.interference import groups, separately
from tweezer.scene.sections import Beam
from tweezer.values.arrays import Array
from tweezer.values.errors import SceneError, warn

if TYPE_CHECKING:
    from tweezer.optics.waves.amplitudes import Path

#: Time longer than any run, s
_FOREVER = 1e9
#: Largest deviation of the light from its table without a warning, as a part of the peak
_UNEVEN = 1e-3
#: Why a bead that is not a sphere has no force map
_NO_MAP = (
    "a body that turns has no force map, because its force depends on five or six coordinates and "
    "direct sums are as fast"
)


@dataclass(frozen=True)
class Beams(Sum):
    """The light of several beams, or of one that moves or changes: the sum of their forces.

    These beams do not interfere: they come from different lasers, or differ in polarisation. Beams
    that do are one of the lights.
    """

    forces: tuple[Moved, ...]
    lights: tuple[LightForce, ...]
    """light of each beam, relative to its own focus"""

    symmetric: ClassVar[bool] = False
    """whether the force is the same all around one axis"""

    def field(
        self,
        positions: Array,
        *,
        gradient: bool = False,
        time: float | Array = 0.0,
        orientations: Array | None = None,
    ) -> Wrench:
        """Return force and torque at positions of the bead; see `Force.field`.

        The bound kernel is kept, because binding copies force maps.

        Parameters
        ----------
        positions : ndarray, shape (n, 3)
            Positions from the focus, m.
        gradient : bool, optional
            Whether to compute gradients too.
        time : float or ndarray, shape (n,), optional
            Time, s.
        orientations : ndarray, shape (n, 4), optional
            Euler parameters.
        """
        if self.oriented and orientations is None:
            return super().field(positions, gradient=gradient, time=time)
        if gradient not in self._parts:
            self._parts[gradient] = bound(self, gradient=gradient)
        return evaluated(self._parts[gradient], positions, gradient, time, orientations)

    @functools.cached_property
    def _parts(self) -> dict[bool, Part]:
        """The bound force with gradients (True) and without, filled when used."""
        return {}

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

    def foci(self, time: float = 0.0) -> Array:
        """Return the positions about which the beams are brightest at a time, s, (n, 3) m."""
        return np.concatenate([
            moved.place.at(time) + each.light.foci * ([1, -1, -1] if moved.down else [1, 1, 1])
            for moved, each in zip(self.forces, self.lights, strict=True)
        ])  # fmt: skip

    def absorbed_power(self, positions: Array, time: float = 0.0) -> Array:
        """Power of the light that the bead absorbs at `positions` (n, 3) m at a time, s, (n,) W."""
        lost = sum(
            float(moved.strength.at(time)[0])
            * each.absorbed_power(moved.within(positions, time), time=time)
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
def light_force(scene: Scene) -> LightForce | Beams:
    """The force of the light of `scene`, by the evaluator that its `optics` section names.

    The forces of several beams add up, unless they are coherent: then their fields do.
    """
    if scene.plain:
        return light_of_one_beam(scene)
    offset = max(place_of(beam).farthest(scene.simulation.duration) for beam in scene.beams)
    moved, lights = [], []
    for group in groups(scene):
        if separately(scene, group):
            (beam,) = group
            light = light_of_one_beam(scene.with_one_beam(beam, offset))
            down = beam.direction == "down"
            moved.append(Moved(light, place_of(beam), factor_of(beam), down=down))
        else:
            light = _interfering(scene, group)
            moved.append(Moved(light, Course.constant(0.0, 0.0, 0.0), Course.constant(1.0)))
        lights.append(light)
    return Beams(tuple(moved), tuple(lights))


def _interfering(scene: Scene, beams: tuple[Beam, ...]) -> LightForce:
    """Return the force of beams whose light interferes, also with its own reflection."""
    from tweezer.optics.waves.coherent import by_interference

    paths = paths_of_light(scene, beams)
    if not paths:
        return light_of_one_beam(scene)
    force = by_interference(scene, paths)
    if evaluator(scene.optics.evaluator).name != "map":
        return force
    from tweezer.optics.waves.coherent_map import by_coherent_map

    return by_coherent_map(scene, force)


def paths_of_light(scene: Scene, beams: tuple[Beam, ...]) -> tuple[Path, ...]:
    """Return the paths of the light of beams that interfere, or of one beam, as waves."""
    from tweezer.optics.waves.coherent import paths_of

    return tuple(
        path
        for beam in beams
        if scene.with_one_beam(beam).lit
        for path in paths_of(scene, beam, place_of(beam), factor_of(beam), _phase(beam))
    )


def place_of(beam: Beam) -> Course:
    """Position of the focus of a beam in time, m."""
    at, motion, none = np.array([beam.position]), beam.motion, np.zeros(3)
    if motion is None:
        return Course(np.zeros(1), at, none)
    match motion.kind:
        case "sine":
            amplitude = np.array(motion.amplitude)
            return Course(np.zeros(1), at, amplitude, motion.frequency or 0.0, motion.phase or 0.0)
        case "circle":
            amplitude = np.array([1.0, 1.0, 0.0]) * (motion.radius or 0.0)
            phases = (motion.phase or 0.0) + np.array([0.5 * np.pi, 0.0, 0.0])
            return Course(np.zeros(1), at, amplitude, motion.frequency or 0.0, phases)
        case "ramp":
            begin, end = motion.begin or 0.0, motion.end or _FOREVER
            way = np.outer([0.0, end - begin], motion.velocity)  # type: ignore[arg-type]
            return Course(np.array([begin, end]), at + way, none)
    times, places = np.array(motion.times), at + np.array(motion.positions)
    if motion.kind == "steps":
        times, places = _stairs(times, places, at[0])
    return Course(times, places, none, period=motion.period or np.inf)


def factor_of(beam: Beam) -> Course:
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
            return _on_off(frequency, duty, (modulation.phase or 0.0) / (2 * np.pi) % 1.0)
    times, factors = np.array(modulation.times), np.array([modulation.factors]).T
    if modulation.kind == "steps":
        times, factors = _stairs(times, factors, np.ones(1))
    return Course(times, factors, none, period=modulation.period or np.inf)


def _on_off(frequency: float, duty: float, ahead: float) -> Course:
    """Return the factor of light that is on while `frequency` t + `ahead`, modulo 1, is below
    `duty`. `ahead` is from 0 to 1.
    """
    on, off = 1.0 - ahead, duty - ahead + (ahead >= duty)
    first = float(ahead < duty)
    times = np.repeat(sorted((on, off)), 2) / frequency
    values = np.array([[first], [1 - first], [1 - first], [first]])
    return Course(times, values, np.zeros(1), period=1 / frequency)


def _phase(beam: Beam) -> Course:
    """Phase of a beam in time, rad."""
    phasing, none, at = beam.phasing, np.zeros(1), np.array([[beam.phase]])
    if phasing is None:
        return Course(np.zeros(1), at, none)
    match phasing.kind:
        case "sine":
            amplitude = np.array([phasing.amplitude])
            return Course(
                np.zeros(1), at, amplitude, phasing.frequency or 0.0, phasing.phase or 0.0
            )
        case "ramp":
            begin, end = phasing.begin or 0.0, phasing.end or _FOREVER
            turned = 2 * math.pi * (phasing.rate or 0.0) * (end - begin)
            return Course(np.array([begin, end]), at + np.array([[0.0], [turned]]), none)
    times, phases = np.array(phasing.times), at + np.array([phasing.phases]).T
    if phasing.kind == "steps":
        times, phases = _stairs(times, phases, at[0])
    return Course(times, phases, none, period=phasing.period or np.inf)


def _stairs(times: Array, values: Array, before: Array) -> tuple[Array, Array]:
    """Points of a course that jumps to each of `values` (n, m) at its time."""
    stairs = np.repeat(np.vstack([before, values]), 2, axis=0)[1:-1]
    return np.repeat(times, 2), stairs


@functools.lru_cache(maxsize=16)
def light_of_one_beam(scene: Scene) -> LightForce:
    """Return the force of the light of a scene's only beam.

    The map is computed unless the user's cache folder contains it (`force_map`). A `PhysicsWarning`
    reports once how accurate ray optics is (`ray_optics_warning`). Also warns if the series of a
    beam's table deviates from it by more than 0.1 % of the peak.
    """
    if scene.theory == "rays" and (warning := ray_optics_warning(scene)) is not None:
        _warn_once(f"{warning}; tweezer.optics.ray_optics_caveat(scene) says more")
    if not scene.lit:
        from tweezer.optics.rays.light import light_on_bead

        return Dark(light_on_bead(scene))
    by = evaluator(scene.optics.evaluator)
    theory = scene.theory if scene.bead.shape == "sphere" else "bodies"
    if theory not in by.places:
        raise SceneError(f"optics.evaluator = {by.name!r}: {_NO_MAP}; allowed: auto, quadrature")
    force: LightForce = by.load(theory)(scene)
    if (off := force.light.cone.deviation) > _UNEVEN:
        warn(
            f"beam.profile_intensity: points so uneven that the light used differs from them by "
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
    """Return the force table of a scene's light, from the user's cache folder or computed.

    A computed table is stored in this folder. It extends to `optics.table_range` from the focus. In
    wave optics, the table of light without an axis extends as far beyond all foci, in a box.
    Its tolerance is `optics.table_tolerance` times the largest force within this range. `progress`
    is called with the finished fraction, 0 to 1, during the computation. A second process that
    needs the same table waits for the first. One table serves every power of the light, and all
    scenes that differ only in scale; with wave optics the wavelength is scaled too.

    Raises `SceneError` for a scene without light, for a bead that is not a sphere, or for linear
    polarisation of rays. Warns (`PhysicsWarning`) if the tolerance is not reached;
    `Table.certified_error` is the actual bound. Also warns if the file is damaged, and is then
    computed again, or if it cannot be written.
    """
    first, *others = groups(scene)
    if others:
        raise SceneError(
            "beam: a map requires a single beam, or coherent beams; a run computes the map of each"
        )
    if not scene.lit:
        raise SceneError("optics.evaluator = 'map': requires light, but the scene is dark")
    if scene.bead.shape != "sphere":
        raise SceneError(f"bead.shape = {scene.bead.shape!r}: {_NO_MAP}")
    if not separately(scene, first):
        from tweezer.optics.waves.coherent import by_interference
        from tweezer.optics.waves.coherent_map import coherent_map

        return coherent_map(scene, by_interference(scene, paths_of_light(scene, first)), progress)
    made: Table = at(THEORIES[scene.theory].map)(scene, progress)
    return made


def check_maps(scene: Scene) -> None:
    """Raise `SceneError` if the light of a lit scene needs a box that is too large for a map."""
    from tweezer.optics.waves import by_map, coherent_map
    from tweezer.optics.waves.coherent import by_interference

    for group in groups(scene):
        if not separately(scene, group):
            if paths := paths_of_light(scene, group):
                coherent_map.check_map(scene, by_interference(scene, paths))
        elif (alone := scene.with_one_beam(group[0])).lit:
            by_map.check_map(alone)


def evaluators_of(scene: Scene) -> str:
    """Return the names of the evaluators of the scene's beams; "dark" for a beam without light."""
    name = evaluator(scene.optics.evaluator).name
    lit = {scene.with_one_beam(beam).lit for beam in scene.beams}
    return ", ".join(sorted(name if each else "dark" for each in lit))


@functools.cache
def _warn_once(text: str) -> None:
    """Warn once in a process, whatever its warning filters are."""
    warn(text)
