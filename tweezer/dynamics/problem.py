"""A scene with its forces and drag, bound once for every model and method."""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Sequence
from dataclasses import dataclass
from types import ModuleType
from typing import TYPE_CHECKING, Any

import numpy as np

from tweezer.dynamics.body import BodyMotion, body_motion, properties_of_body
from tweezer.dynamics.emitted import module_of, takes_drag_exactly
from tweezer.dynamics.layout import TRANSLATION
from tweezer.dynamics.linear import LinearMotion
from tweezer.dynamics.needs import LINEAR, without_memory
from tweezer.fluid import (
    Drag,
    Modes,
    Network,
    Stokes,
    by_axis,
    drag,
    modes,
    network_of,
    single,
)
from tweezer.forces.acting import forces_of, try_forces
from tweezer.forces.buoyancy import BuoyancyTorque
from tweezer.forces.composed import Sum
from tweezer.forces.driven import DrivenForce, DrivenLight
from tweezer.forces.equilibria import (
    Equilibrium,
    NetForce,
    Search,
    equilibria,
    equilibria_about,
    equilibrium_at,
    nearest_stable,
)
from tweezer.forces.force import Force, Wrench
from tweezer.forces.rings import Motion, Ring, off_axis, rings
from tweezer.forces.sites import starts
from tweezer.forces.spring import Elastic
from tweezer.forces.wall import CLOSEST, Contact, Dlvo
from tweezer.optics import Beams, LightForce, light_force
from tweezer.optics.heat import heated
from tweezer.scene import Scene, SceneLike
from tweezer.scene.bead import BeadProperties, bead_properties
from tweezer.scene.choices import MODELS, POLES
from tweezer.scene.interference import bounds
from tweezer.values.arrays import Array
from tweezer.values.constants import speed_of_light
from tweezer.values.errors import SceneError

if TYPE_CHECKING:
    from tweezer.dynamics.poses import BodyEquilibrium, PoseSearch

#: Number of places about each focus at which speed and stiffness are evaluated
_PLACES = 64
#: Number of times, and of kinks, at which a force that changes in time is evaluated
_TIMES = 32
#: Number of places on the axis next to a wall, for forces that act there alone
_BESIDE_A_WALL = 60
#: Force of contact with a wall, over about the largest force towards it
_HARDNESS = 1e3
#: Force towards a wall that is taken where a scene has none, N
_UNPRESSED = 1e-12
#: Distance between centres of mass and volume that is rounding, over the size of the body
_ROUNDING = 1e-12
#: Largest distance of these places from the focus, in radii
_AROUND = 1.5


@dataclass(frozen=True, eq=False)
class Problem:
    """A scene with its bead, forces and drag; the same for every model and method."""

    scene: Scene
    bead: BeadProperties
    drag: Drag
    light: LightForce | Beams
    walls: tuple[Force, ...] = ()
    """forces of the walls"""
    others: tuple[Force, ...] = ()
    """forces in addition to those of the scene"""
    body: BodyMotion | None = None
    """drag and inertia of a body that is no sphere; None for a sphere"""
    elastic: tuple[Elastic, ...] = ()
    """spring of a gel, if the medium is one"""

    def __reduce__(self) -> tuple[Any, ...]:
        """Return a call that binds the scene in another process, where addresses differ."""
        return bound_once, (self.scene, self.others)

    @functools.cached_property
    def force(self) -> Force:
        """Sum of the light's force and the other forces: all but drag, weight and noise."""
        beside = self.beside_the_light
        light: Force = self.light
        if (controller := self.scene.feedback) is not None:
            if controller.acts_on == "force":
                beside = *beside, DrivenForce()
            else:
                light = DrivenLight(light, controller.acts_on == "beam.power")
        return Sum((light, *beside)) if beside else light

    @property
    def beside_the_light(self) -> tuple[Force, ...]:
        """Forces of walls, the torque of buoyancy, the spring of a gel, and the user's own
        forces.
        """
        return *self.walls, *self._buoyancy, *self.elastic, *self.others

    @property
    def walls_apart(self) -> tuple[Force, ...]:
        """Forces of the walls except the contact forces, for a bead that touches no wall."""
        return tuple(each for each in self.walls if not isinstance(each, Contact))

    @property
    def beside_the_light_apart(self) -> tuple[Force, ...]:
        """Forces of `beside_the_light` except the contact forces."""
        return *self.walls_apart, *self._buoyancy, *self.elastic, *self.others

    @property
    def _buoyancy(self) -> tuple[Force, ...]:
        """Torque of buoyancy on a body of several densities; empty for any other."""
        scene = self.scene
        off = scene.body.centre_of_volume
        # rounding of the centre of mass is not an offset
        if not scene.forces.buoyancy or np.linalg.norm(off) < _ROUNDING * scene.body.size:
            return ()
        lift = self.bead.displaced_mass * scene.forces.gravitational_acceleration
        return (BuoyancyTorque(lift, off),)

    @property
    def rotates(self) -> bool:
        """Whether anything rotates the bead; otherwise rotation is not computed."""
        turned = self.force.oriented or self.drag.oriented
        return self.scene.rotates or turned or self.body is not None

    @property
    def emitted(self) -> ModuleType:
        """Emitted module of the equations of motion."""
        return module_of(self.scene, rotates=self.rotates)

    @property
    def takes_drag_exactly(self) -> bool:
        """Whether the exponential method can integrate the equations of motion."""
        return takes_drag_exactly(self.emitted, self.force, self.drag, self.body)

    @property
    def symmetric(self) -> bool:
        """Whether all forces are rotationally symmetric about the axis of the only beam."""
        return self.light.symmetric and not self._pulled_aside

    @property
    def _pulled_aside(self) -> bool:
        """Whether forces of the user, or a gel's spring, may pull the bead off the axis."""
        return bool(self.others) or any(any(each.anchor[:2]) for each in self.elastic)

    @functools.cached_property
    def orientation(self) -> Array:
        """Euler parameters at the start, (4,), of length 1."""
        e = np.array(self.scene.start.orientation)
        return e / np.linalg.norm(e)

    def _oriented(self, acting: Force | Drag, n: int) -> Array | None:
        """Return the orientation at the start n times, (n, 4), if `acting` depends on it; else
        None.
        """
        return np.tile(self.orientation, (n, 1)) if acting.oriented else None

    def field(
        self, positions: Array, *, gradient: bool = False, time: float | Array = 0.0
    ) -> Wrench:
        """Return all forces but drag, weight and noise on a bead with its orientation at the start.

        `positions` are (n, 3) m, and `time` is one or (n,) s. If `gradient`, force gradients are
        computed too.
        """
        turned = self._oriented(self.force, len(positions))
        return self.force.field(positions, gradient=gradient, time=time, orientations=turned)

    def light_along(self, positions: Array, times: Array, orientations: Array | None) -> Wrench:
        """Return force and torque of the light at positions (n, 3), m, and times (n,), s.

        `orientations` (n, 4) are read where the force depends on them.
        """
        turned = orientations if self.light.oriented else None
        return self.light.field(positions, time=times, orientations=turned)

    def net_force(self, positions: Array) -> Array:
        """Return the sum of all forces but drag and noise at `positions` (n, 3), m, at time 0: (n,
        3) N.
        """
        return self.field(positions).force + np.array(self.bead.weight)

    def net_force_apart(self, positions: Array) -> Array:
        """Return the net force without contact with a wall at `positions` (n, 3), m, at time 0: (n,
        3) N.
        """
        turned = self._oriented(self.force, len(positions))
        every = (self.light, *self.beside_the_light_apart)
        fields = (each.field(positions, orientations=turned) for each in every)
        return sum((each.force for each in fields), np.array(self.bead.weight))

    @functools.cached_property
    def mobility(self) -> Array:
        """Mobilities along N1, N2, N3 (s/kg) and about them (1/(N m s)) at the start, (6,).

        N1, N2 and N3 are the axes of the laboratory, and N3 is normal to the walls.

        Raises `SceneError` if the drag does not dissipate energy in every motion.
        """
        value = self._resisted(np.array([self.scene.start_position]))
        parallel, _, turn, _, coupling = value[0].tolist()
        positive = value[0, :4].min() > 0 and coupling**2 < parallel * turn
        if not (np.isfinite(value).all() and positive):
            raise SceneError(
                f"drag: the mobilities at the start, {value[0].tolist()}, are not positive"
            )
        return by_axis(value)[0]

    def mobilities(self, positions: Array, time: float | Array = 0.0) -> Array:
        """Return the mobilities along and about N1, N2, N3 at `positions` (n, 3), m, (n, 6).

        time: s, one or (n,). Units are s/kg and 1/(N m s).
        """
        return by_axis(self._resisted(positions, time))

    def _resisted(self, positions: Array, time: float | Array = 0.0) -> Array:
        """Return the five mobilities of `Mobility` with the orientation at the start, (n, 5)."""
        turned = self._oriented(self.drag, len(positions))
        return self.drag.mobilities(positions, time=time, orientations=turned).value

    @property
    def effective_mass(self) -> float:
        """Mass that a sudden force accelerates, kg: the bead's, and the added mass if fluid inertia
        is included.

        In the scaled model the mass is this value over a2, which scales the bead's own mass only.
        """
        if self.scene.medium.inertia in (None, "none"):
            return self.bead.mass
        return self.bead.mass + 0.5 * self._scale * self.bead.displaced_mass

    @property
    def _scale(self) -> float:
        """Factor a2 by which the scaled model divides the bead's inertia; 1 in other models."""
        simulation = self.scene.simulation
        return (simulation.model == "scaled" and simulation.scaling_factor) or 1.0

    @functools.cached_property
    def modes(self) -> Modes:
        """Modes of the velocity of translation, in a model with inertia and a uniform drag.

        If the scene does not set fluid inertia, it is not included here. Raises `SceneError` for a
        number of poles without a table.
        """
        medium, drag = self.scene.medium, 1 / self.mobility[0]
        if self.network is not None:  # which relax to force over the solvent's drag
            times, weights = self.network.modes()
            return Modes(times, weights * drag / self.network.steady_drag)
        if medium.inertia == "memory":
            mass = self.bead.mass / self._scale
            return modes(mass, drag, self.bead.displaced_mass, medium.poles or POLES)
        return single(self.effective_mass / self._scale / drag)

    @functools.cached_property
    def network(self) -> Network | None:
        """Elements of a viscoelastic medium, without a gel's spring; None in a Newtonian fluid."""
        medium = self.scene.medium
        if not medium.relaxes:
            return None
        inertial = MODELS[self.scene.simulation.model or "full"].inertia
        return network_of(
            self.scene, mass=self.effective_mass if inertial else 0.0,
            drag=float(1 / self.mobility[0]), inertia=inertial and medium.inertia == "memory",
        )  # fmt: skip

    @functools.cached_property
    def rings_with_fluid(self) -> bool:
        """Whether the bead rings in its viscoelastic medium if the fluid has inertia."""
        if self.network is None:
            return False
        network = self.changed(model="full").remembering(POLES).network
        return network is not None and network.rings

    @functools.cached_property
    def linear(self) -> LinearMotion:
        """Linear motion about an equilibrium, with the inertia of the scene's model.

        If the scene names no model, the inertia of the bead and of the fluid is included. It has no
        effect if a run uses the overdamped model.
        """
        medium, simulation = self.scene.medium, self.scene.simulation
        model = MODELS[simulation.model or "full"]
        if not model.inertia:
            of_order_one = simulation.model == "first-order"
            return LinearMotion(0.0, expansion_time=self.relaxation_time if of_order_one else 0.0)
        if medium.inertia == "memory" or (
            medium.inertia is None and not without_memory(self, LINEAR)
        ):
            displaced = self.bead.displaced_mass
            poles = medium.poles or POLES
            return LinearMotion(self.bead.mass, displaced, poles, self._scale)
        return LinearMotion(self.effective_mass, scale=self._scale)

    def spiral_rate(self, place: Array, stiffness: Array) -> float:
        """Return `LinearMotion.spiral_rate` at a position (3,), m."""
        return self.linear.spiral_rate(stiffness, self.mobilities(place[None])[0, TRANSLATION])

    @property
    def relaxation_time(self) -> float:
        """Relaxation time m/beta_v at the release, s: epsilon of (4.6).

        It is the longest one if it depends on the direction.
        """
        return self.bead.mass * float(self.mobility[TRANSLATION].max())

    @property
    def vorticity_time(self) -> float:
        """Time in which vorticity diffuses over the bead, s; for a body that is no sphere, over the
        radius of the sphere with its largest drag coefficient.
        """
        if self.body is None:
            return self.bead.vorticity_time
        medium = self.scene.medium
        return self.body.radius(medium.viscosity) ** 2 * medium.density / medium.viscosity

    def foci(self, time: float = 0.0) -> Array:
        """Return the positions about which light is brightest at a time, s, (n, 3) m."""
        return (
            self.light.foci(time)
            if isinstance(self.light, LightForce | Beams)
            else np.zeros((1, 3))
        )

    def equilibria(self, net_force: NetForce) -> tuple[Equilibrium, ...]:
        """Return the positions where a net force vanishes.

        For one beam they are on its axis; for several, or with other forces, near the axis of each
        beam. Light of an uneven pupil is searched beside these axes too.
        """
        search = self.search
        about = self.scene.body.size, search, self.field, net_force, self.spiral_rate
        if self.about_axis:
            found = equilibria(*about)
        else:
            foci = self.foci()
            found = equilibria_about(foci, *about, self._beside_axes(foci, net_force))
        return tuple(each for each in found if self._in_the_fluid(each.position[2]))

    def _beside_axes(self, foci: Array, net_force: NetForce) -> Array:
        """Return starting positions of the search beside the axes of foci, (n, 3) m.

        The array is empty if every pupil is the same all around.
        """
        if all(beam.even for beam in self.scene.beams) or not self.scene.lit:
            return np.zeros((0, 3))
        assert isinstance(self.light, Beams)
        boxes = [each.box for each in self.light.lights]
        width, reach = (max(getattr(box, name) for box in boxes) for name in ("width", "reach"))
        return starts(foci, np.array([width, width, reach]), self.search, net_force)

    @property
    def ring_motion(self) -> Motion:
        """Properties of the bead for the motion on a ring."""
        mass = self.linear.mass + 0.5 * self.linear.displaced_mass
        return Motion(
            mass / self._scale, lambda places: self.mobilities(places)[:, [0, 2]],
            self.light.search.beside,
        )  # fmt: skip

    @property
    def about_axis(self) -> bool:
        """Whether all forces come from one beam at rest and from walls across its axis."""
        return self.scene.plain and not self._pulled_aside

    @property
    def round_axis(self) -> bool:
        """Whether there is light, and all forces are the same all around the axis of a beam."""
        return self.about_axis and self.symmetric and self.scene.lit

    def rings(self, net_force: NetForce, *, inertia: bool = True) -> tuple[Ring, ...]:
        """Return the rings around the axis of the only beam on which it traps a bead: see `rings`.

        The result is empty if the forces are not symmetric about this axis. `inertia` determines
        whether the bead has mass.
        """
        if not self.round_axis:
            return ()
        assert isinstance(self.light, LightForce)
        motion = self.ring_motion if inertia else self.ring_motion._replace(mass=0.0)
        about = self.scene.body.size, self.light.box, self.force, net_force, motion
        return tuple(each for each in rings(*about) if self._in_the_fluid(each.height))

    def off_axis(self, net_force: NetForce) -> tuple[Equilibrium, ...]:
        """Return the stable equilibria off the axis of the only beam: see `off_axis`."""
        assert isinstance(self.light, LightForce)
        places = off_axis(self.scene.body.size, self.light.box, self.force, net_force)
        every = (
            equilibrium_at(place, self.search, self.field, net_force, self.spiral_rate)
            for place in places if self._in_the_fluid(place[2])
        )  # fmt: skip
        return tuple(each for each in every if each.stable)

    @functools.cached_property
    def search(self) -> Search:
        """Lengths of the search for equilibria.

        They depend on the light, on walls, and on the distance at which light may still carry the
        bead.
        """
        farthest = 0.0
        # behind a wall there is no light
        if any(self.bead.weight) and self.scene.wall is None and self.light.smooth:
            farthest = self.scene.simulation.loss_distance
        return self.light.search._replace(besides=self._beside_walls(), farthest=farthest)

    def _beside_walls(self) -> tuple[float, ...]:
        """Return positions z on the axis at a series of gaps from the walls, m from the origin."""
        if self.scene.wall is None:
            return ()
        body, planes = self.scene.body, self.scene.wall.planes
        gaps = np.geomspace(0.1 * CLOSEST, body.size, _BESIDE_A_WALL)
        z = [position + normal * (body.support(normal) + gaps) for position, normal in planes]
        every = np.concatenate(z)
        return tuple(every[np.abs(every) <= self.light.search.reach].tolist())

    def _in_the_fluid(self, z: float) -> bool:
        """Return whether a bead with its centre at z, m, is outside every wall and mirror."""
        return all(
            normal * (z - plane) > self.scene.body.support(normal)
            for plane, normal in bounds(self.scene).items()
        )

    def places_about(self, time: float = 0.0) -> Array:
        """Return random positions about the foci at a time, s, followed by the start, (n, 3) m.

        They are the same in every call; positions inside a wall are left out.
        """
        rng = np.random.default_rng(7)
        directions = rng.normal(size=(_PLACES, 3))
        directions /= np.linalg.norm(directions, axis=1, keepdims=True)
        distances = _AROUND * self.scene.body.size * rng.random((_PLACES, 1))
        about = [focus + directions * distances for focus in self.foci(time)]
        places = np.vstack([*about, self.scene.start_position])
        return places[[self._in_the_fluid(z) for z in places[:, 2]]]

    def times_looked_at(self) -> list[float]:
        """Return times at which a force that changes in time is evaluated, s; only 0 for a steady
        force.
        """
        if self.force.steady:
            return [0.0]
        duration = self.scene.simulation.duration
        kinks = self.force.kinks(duration)
        evenly = np.linspace(0.0, duration, _TIMES)
        return np.concatenate([evenly, kinks[:_TIMES], kinks[-_TIMES:]]).tolist()

    @functools.cached_property
    def fastest(self) -> float:
        """Approximately the largest slow speed at positions about the foci and at the start, m/s.

        It is at least the initial speed, and 1 m/s for a bead that nothing moves.
        """
        found = [float(np.linalg.norm(self.scene.start.velocity))]
        for time in self.times_looked_at():
            force = self.field(self.places_about(time), time=time).force
            slow = (force + np.array(self.bead.weight)) * self.mobility[TRANSLATION]
            found.append(float(np.linalg.norm(slow, axis=1).max()))
        return max(found) or 1.0

    @functools.cached_property
    def equilibrium(self) -> Equilibrium | None:
        """Stable equilibrium nearest the focus at time 0, or None; always None for a body that is
        no sphere, whose equilibria are poses (`pose`).
        """
        if self.body is not None:
            return None
        return nearest_stable(self.equilibria(self.net_force))

    @functools.cached_property
    def poses(self) -> PoseSearch:
        """Search for the poses at which a body that is no sphere rests at time 0."""
        from tweezer.dynamics.poses import PoseSearch  # spheres do without

        return PoseSearch(self.scene)

    @functools.cached_property
    def pose(self) -> BodyEquilibrium | None:
        """Stable pose nearest the focus at time 0 of a body that is no sphere, or None."""
        return self.poses.nearest() if self.body is not None and self.scene.lit else None

    def changed(self, **simulation: Any) -> Problem:
        """Return a copy of this problem, with these values for keys of the scene's `simulation`."""
        return dataclasses.replace(self, scene=heated(self.scene.replace(simulation=simulation)))

    def remembering(self, poles: int) -> Problem:
        """Return a copy of this problem in a fluid with hydrodynamic memory of `poles` poles.

        The loss distance is reduced if necessary, so that the bead counts as lost before it comes
        so close to a wall that this memory does not apply.
        """
        sections: dict[str, Any] = {"medium": {"inertia": "memory", "poles": poles}}
        if self.scene.free_of_walls < self.scene.simulation.loss_distance:
            sections["simulation"] = {"loss_distance": self.scene.free_of_walls}
        return self.decided(**sections)

    def decided(self, **sections: Any) -> Problem:
        """Return a copy of this problem, with values by section for keys that the scene omits."""
        return dataclasses.replace(self, scene=self.scene.decided(**sections))


def bound_once(scene: SceneLike | Problem, others: Sequence[Force | str] = ()) -> Problem:
    """Return the problem of a scene and of the user's own forces; return a problem unchanged.

    Raises `SceneError` for objects that are not forces, and forces that fail a trial
    (`try_forces`).
    """
    if isinstance(scene, Problem):
        return scene
    forces = forces_of(others)
    scene = heated(scene)
    body = body_motion(scene)
    bead = bead_properties(scene) if body is None else properties_of_body(scene, body)
    walls = _forces_of_walls(scene, bead)
    far = drag(scene) if body is None else Stokes(bead.drag, bead.rotational_drag)
    problem = Problem(scene, bead, far, light_force(scene), walls, forces, body)
    if scene.medium.elasticity is not None:
        problem = dataclasses.replace(problem, elastic=(_spring_of_gel(problem),))
    if forces:
        try_forces(forces, problem.places_about(), scene.simulation.duration)
    return problem


def _spring_of_gel(problem: Problem) -> Elastic:
    """Return the spring of the scene's gel; `problem` does not contain it yet."""
    scene, anchor = problem.scene, problem.scene.start_position
    if scene.medium.anchor == "trap":
        if problem.equilibrium is None:
            raise SceneError(
                "medium.anchor = 'trap': requires a stable equilibrium in the light, and the scene "
                "has none; set medium.anchor to start"
            )
        x, y, z = problem.equilibrium.position.tolist()
        anchor = x, y, z
    stiffness = problem.bead.drag / scene.medium.viscosity * (scene.medium.elasticity or 0.0)
    return Elastic(stiffness, anchor)


def _forces_of_walls(scene: Scene, bead: BeadProperties) -> tuple[Force, ...]:
    """Return the forces of a scene's walls: those that the scene sets, and contact.

    Thermal motion needs no force to keep a bead outside walls (`tweezer.dynamics.brownian`).
    """
    found: list[Force] = []
    body, said = scene.body, scene.forces.dlvo
    for position, normal in scene.wall.planes if scene.wall else ():
        pressing = float(np.linalg.norm(bead.weight)) + _momentum_of_light(scene)
        if said is not None:
            if scene.bead.shape != "sphere":
                raise SceneError("forces.dlvo: is known for spheres; remove forces.dlvo")
            constants = said.strength, said.debye_length, said.hamaker_constant
            found.append(dlvo := Dlvo(scene.bead.radius, position, normal, *constants))
            pressing += dlvo.attraction
        if not scene.forces.brownian:
            largest = _HARDNESS * (pressing or _UNPRESSED)
            found.append(Contact(body.support(normal), position, normal, largest))
    return tuple(found)


def _momentum_of_light(scene: Scene) -> float:
    """Return the momentum flux n_m P/c of all beams, N: about twice the largest force on a bead."""
    powers = (beam.power_through_pupil or beam.power or 0.0 for beam in scene.beams)
    return scene.medium.refractive_index * sum(powers) / speed_of_light if scene.lit else 0.0
