"""Requirements of models and methods: a table of properties of a scene that they do not support.

A row of `CHOICES` gives the value of a key that a scene with thermal motion does not set. A `Need`
names a property that a model or method does not support, with the error message. A row of `MEMORY`
gives a reason why hydrodynamic memory cannot be included. If the scene sets `memory`, it is then
refused; otherwise fluid inertia is omitted. The validators of a scene refuse everything that does
not require a bound problem (`tweezer.scene.rules`).
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass
from types import ModuleType
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol, Self, TypeVar

import numpy as np
from pydantic import BaseModel

from tweezer.dynamics.body import BodyMotion
from tweezer.dynamics.brownian.batch import Scheme
from tweezer.dynamics.layout import ROTATION, TRANSLATION
from tweezer.fluid import Drag
from tweezer.forces.equilibria import Equilibrium
from tweezer.forces.force import Force
from tweezer.scene import Scene
from tweezer.scene.choices import METHODS, MODELS, Method, Model, at, methods
from tweezer.values.arrays import Array
from tweezer.values.constants import Boltzmann
from tweezer.values.errors import SceneError

if TYPE_CHECKING:
    from tweezer.dynamics.poses import BodyEquilibrium

#: Rotational diffusion in the relaxation time, rad^2, above which gyroscopic forces are noticeable
_GYROSCOPIC = 1e-3
#: Part of the largest stiffness below which an entry of it is rounding
_ROUNDING = 1e-9


#: Distance from a wall over the largest radius of a body that is no sphere, from which its drag is
#: the one far away, with the first reflection as an error
_FAR_FROM_WALLS = 5.0


class Bound(Protocol):
    """A scene with its forces and drag: a `tweezer.dynamics.problem.Problem`."""

    @property
    def scene(self) -> Scene:
        """Scene of the problem."""

    @property
    def drag(self) -> Drag:
        """Drag of its bead."""

    @property
    def body(self) -> BodyMotion | None:
        """Drag and inertia of a body that is no sphere; None for a sphere."""

    @property
    def force(self) -> Force:
        """Sum of all forces but drag, weight and noise."""

    @property
    def mobility(self) -> Array:
        """Mobilities along the axes, s/kg, and about them, 1/(N m s), at the start, (6,)."""

    @property
    def others(self) -> tuple[Force, ...]:
        """Forces in addition to those of the scene."""

    @property
    def rotates(self) -> bool:
        """Whether anything rotates the bead."""

    @property
    def equilibrium(self) -> Equilibrium | None:
        """Stable equilibrium nearest the focus, or None."""

    @property
    def pose(self) -> BodyEquilibrium | None:
        """Stable pose nearest the focus of a body that is no sphere, or None."""

    @property
    def effective_mass(self) -> float:
        """Mass of the bead with the added mass of the fluid, kg."""

    @property
    def rings_with_fluid(self) -> bool:
        """Whether the bead rings in its viscoelastic medium if the fluid has inertia."""

    @property
    def beside_the_light(self) -> tuple[Force, ...]:
        """Forces in addition to light, drag, weight and noise."""

    @property
    def emitted(self) -> ModuleType:
        """Emitted module of the equations of motion."""

    @property
    def takes_drag_exactly(self) -> bool:
        """Whether the exponential method can integrate the equations of motion."""

    def decided(self, **sections: Any) -> Self:
        """Return this problem with values, by section, for keys that the scene left open."""

    def remembering(self, poles: int) -> Self:
        """Return this problem in a fluid with memory, by a number of poles."""


AnyProblem = TypeVar("AnyProblem", bound=Bound)


@dataclass(frozen=True)
class Facts:
    """Properties of a problem, with its model and method, on which choices and needs depend."""

    problem: Bound

    @functools.cached_property
    def model(self) -> Model:
        """Model of motion that the scene names, or `full` if it names none."""
        return MODELS[self.problem.scene.simulation.model or "full"]

    @functools.cached_property
    def method(self) -> Method | None:
        """Method that the scene names or was given; None if it is open."""
        return METHODS.get(self.problem.scene.simulation.method)

    def has(self, trait: str) -> bool:
        """Return whether a method is decided and has a trait, a field of `Method` such as
        "spring_only".
        """
        return bool(getattr(self.method, trait, False))

    @property
    def body(self) -> bool:
        """Whether the bead is not a sphere."""
        return self.problem.body is not None

    @property
    def gyroscopic(self) -> bool:
        """Whether a body's gyroscopic force, which its steps leave out, changes thermal motion."""
        body, temperature = self.problem.body, self.problem.scene.noise_temperature
        if body is None or not self.model.inertia:
            return False
        turns = Boltzmann * temperature * np.linalg.eigvalsh(body.mobility[ROTATION, ROTATION])
        return bool(turns[-1] * body.relaxation_times[0] > _GYROSCOPIC)

    @property
    def walls(self) -> bool:
        """Whether the bead is beside walls."""
        return self.problem.drag.walls is not None

    @property
    def by_place(self) -> bool:
        """Whether the drag depends on the position, but not by walls."""
        return not (self.problem.drag.uniform or self.walls)

    @property
    def followed(self) -> list[str]:
        """Models of thermal motion for the drag, the preferred one first."""
        if self.body:
            return list(METHODS["heun"].bodies)
        if self.walls:
            return list(METHODS["heun"].beside_wall)
        slow = (name for name, each in MODELS.items() if not (each.inertia or each.scheme))
        return list(MODELS) if self.problem.drag.uniform else list(slow)

    @property
    def scheme(self) -> Scheme:
        """Scheme by which the method takes steps of thermal motion in this model, beside a wall or
        not.
        """
        assert self.method is not None
        place = self.model.scheme or self.method.place
        if self.body:
            place = self.method.bodies.get(self.model.name, place)
        elif self.walls:
            place = self.method.beside_wall.get(self.model.name, place)
        scheme: Scheme = at(place)
        return scheme

    @property
    def even(self) -> bool:
        """Whether the drag is the same everywhere and in every direction."""
        return self.problem.drag.uniform and np.ptp(self.problem.mobility[TRANSLATION]) == 0

    @property
    def lit_alone(self) -> bool:
        """Whether only a single, steady beam and the weight act, besides drag and noise."""
        problem = self.problem
        several = problem.beside_the_light or problem.scene.more_beams
        return problem.force.steady and not several

    @property
    def oscillates(self) -> bool:
        """Whether a sphere with all its inertia oscillates, without memory: 4 tau kappa > 1.

        tau is the relaxation time of the velocity, and kappa is stiffness over drag.
        """
        problem, scene = self.problem, self.problem.scene
        forgets = scene.rarefied or scene.medium.inertia in ("none", "added-mass")
        forgets = forgets and not scene.medium.viscoelastic
        if not (forgets and self.model.name == "full" and self.even) or problem.force.oriented:
            return False
        tau = problem.effective_mass * problem.mobility[0]
        trap = problem.equilibrium
        rates = np.zeros(1) if trap is None else np.diag(rates_of(trap, problem.mobility))
        return bool(4 * tau * rates.max() > 1)

    @property
    def coupled(self) -> bool:
        """Whether the trap couples the axes."""
        trap = self.problem.equilibrium
        return trap is not None and not is_diagonal(rates_of(trap, self.problem.mobility))

    @property
    def names_another_model(self) -> bool:
        """Whether a scene with open inertia of the fluid names another model than `full`.

        Before a model is chosen, this is not a reason against hydrodynamic memory.
        """
        scene = self.problem.scene
        return scene.medium.inertia is None and scene.simulation.model not in (None, "full")

    def says(self, words: str) -> str:
        """Return words with the names of the model and the method filled in."""
        simulation = self.problem.scene.simulation
        where = "beside a wall" if self.walls else "under a drag that depends on the position"
        if self.body:
            where = "of a body that is not a sphere"
        return words.format(model=self.model.name, method=simulation.method, where=where)


class Choice(NamedTuple):
    """Value for a key of `simulation` that a scene with thermal motion leaves open."""

    key: str
    """name of the key"""
    value: str
    why: str
    """reason, in words"""
    where: Callable[[Facts], bool] = lambda _: True
    """whether the row applies, by the facts of the problem"""


#: Of each key the first row whose fact is there
CHOICES = (
    Choice("model", "overdamped", "the elements of a power law are followed without inertia",
           lambda its: its.problem.scene.medium.power_law is not None),
    Choice("model", "full", "inertia is exact at any step", lambda its: its.problem.drag.uniform),
    Choice("model", "overdamped", "the drag depends on the place"),
    Choice("method", "heun", "the gap as the radius of a motion in a plane, weak order 2",
           lambda its: its.walls),
    Choice("method", "euler-maruyama", "the drag depends on the place", lambda its: its.by_place),
    Choice("method", "heun", "steps on the group of poses, weak order 2", lambda its: its.body),
    Choice("method", "kick", "the bead oscillates, and the steps keep its energy",
           lambda its: its.oscillates),
    Choice("method", "heun", "exact drag and noise, weak order 2"),
)  # fmt: skip


def _beside_wall(scene: Scene) -> bool:
    """Return whether a body starts so near to a wall that the wall's drag is not negligible."""
    if scene.wall is None:
        return False
    z, nearest = scene.start_position[2], _FAR_FROM_WALLS * scene.body.size
    return any(abs(z - position) < nearest for position, _ in scene.wall.planes)


class Need(NamedTuple):
    """Property of a scene that a model or a method does not support, with the error message."""

    key: str
    """what is refused: "section.name" of a key of the scene, or the name of an argument"""
    unmet: Callable[[Facts], bool]
    """whether the property is present, so that the scene is refused"""
    problem: str
    """what is wrong, in words, with {model} and {where}"""
    remedy: Callable[[Facts], str]
    """one change that corrects the scene, in words"""

    def refusal(self, its: Facts) -> str:
        """Return the message by which the scene is refused."""
        section, _, name = self.key.partition(".")
        given = getattr(getattr(its.problem.scene, section), name) if name else None
        value = "" if isinstance(given, BaseModel | None) else f" = {given!r}"
        return f"{self.key}{value}: {its.says(self.problem)}; {self.remedy(its)}"


def _set(key: str, value: str) -> Callable[[Facts], str]:
    """Return a remedy that sets a key to a value."""
    return lambda _: f"set {key} to {value}"


def _one_of(key: str, allowed: Callable[[Facts], list[str]]) -> Callable[[Facts], str]:
    """Return a remedy that lists the allowed values of a key and sets it to the first."""
    return lambda its: f"must be {' or '.join(allowed(its))}; set {key} to {allowed(its)[0]}"


def _thermal_methods(suits: Callable[[Method], bool]) -> list[str]:
    """Return the names of the methods for thermal motion that a condition allows."""
    return [each.name for each in methods(thermal=True) if suits(each)]


_HEUN = _set("simulation.method", "heun")
_WHERE_NAMED = "with the model {model} only where it is named"
_WITHOUT_TRAP = "requires a stable equilibrium, and the scene has none"
_EVEN_DRAG = "requires a drag that is the same everywhere"

#: Of a model that the scene names, in thermal motion
OF_MODEL = (
    Need("simulation.model", lambda its: its.model.name not in its.followed,
         "cannot follow thermal motion {where}",
         _one_of("simulation.model", lambda its: its.followed)),
)  # fmt: skip
#: Of a model and a method that are decided, in thermal motion
NEEDS = (
    Need("simulation.method",
         lambda its: its.body and its.model.name not in getattr(its.method, "bodies", ()),
         "cannot follow a body that is not a sphere in the model {model}",
         _one_of("simulation.method", lambda its: _thermal_methods(
             lambda each: its.model.name in each.bodies))),
    Need("wall", lambda its: its.body and its.problem.scene.wall is not None,
         "thermal motion beside a wall requires a sphere", lambda _: "remove wall"),
    Need("beam.noise",
         lambda its: its.problem.scene.noisy_light
         and not (its.has("impulses") and its.lit_alone and its.problem.equilibrium),
         "is computed for a bead that oscillates in the stable equilibrium of a single, steady "
         "beam, by the method kick, under light and weight alone", lambda _: "remove beam.noise"),
    Need("forces.recoil",
         lambda its: its.problem.scene.forces.recoil
         and (its.body or its.walls or its.by_place or not its.problem.scene.lit
              or not its.problem.force.steady),
         "is computed for a sphere in steady light, with a drag that is the same everywhere",
         _set("forces.recoil", "false")),
    Need("simulation.model",
         lambda its: its.body and its.model.inertia and its.problem.scene.camera is not None,
         "is not available for a body that is not a sphere and a camera",
         _set("simulation.model", "overdamped")),
    Need("simulation.model", lambda its: its.gyroscopic,
         "leaves out the gyroscopic force, which is noticeable in so thin a medium",
         _set("simulation.model", "overdamped")),
    Need("simulation.method",
         lambda its: its.has("spring_only") and not its.problem.force.steady,
         "follows a trap at rest, but a force or a beam changes in time", _HEUN),
    Need("simulation.method",
         lambda its: its.has("spring_only") and its.coupled
         and its.problem.scene.medium.viscoelastic,
         "cannot follow a viscoelastic medium in a trap that couples the axes", _HEUN),
    Need("simulation.method",
         lambda its: its.walls and its.model.name not in getattr(its.method, "beside_wall", ()),
         "cannot keep a bead on its side of a wall in the model {model}",
         _one_of("simulation.method", lambda its: _thermal_methods(
             lambda each: its.model.name in each.beside_wall))),
    Need("simulation.model",
         lambda its: its.walls and its.model.inertia and its.problem.rotates,
         "cannot follow thermal rotation beside a wall", _set("simulation.model", "overdamped")),
    Need("simulation.method", lambda its: its.by_place and its.has("uniform_drag"), _EVEN_DRAG,
         _one_of("simulation.method", lambda _: _thermal_methods(
             lambda each: not each.uniform_drag))),
    Need("forces.brownian", lambda its: its.by_place and its.problem.rotates,
         f"thermal rotation {_EVEN_DRAG}", _set("forces.brownian", "false")),
    Need("simulation.method", lambda its: its.problem.force.oriented and its.has("spring_only"),
         "follows no force that turns the bead", _HEUN),
    Need("simulation.model", lambda its: its.problem.force.oriented and bool(its.model.scheme),
         "follows no force that turns the bead", _set("simulation.model", "full")),
    Need("simulation.method",
         lambda its: its.has("spring_only") and its.problem.equilibrium is None,
         _WITHOUT_TRAP, _HEUN),
    Need("start.drawn",
         lambda its: its.body and its.problem.scene.start.drawn in ("equilibrium", "boltzmann")
         and bool(its.problem.others),
         "determines the pose of a body that is not a sphere from light and weight alone, without "
         "forces of your own", _set("start.drawn", "no")),
    Need("start.drawn",
         lambda its: its.problem.scene.start.drawn in ("equilibrium", "boltzmann")
         and its.problem.equilibrium is None and its.problem.pose is None,
         _WITHOUT_TRAP, _set("start.drawn", "no")),
)  # fmt: skip
#: Of thermal motion in which events are looked for
WATCHED = (
    Need("events", lambda its: its.problem.scene.camera is not None,
         "cannot be combined with a camera in thermal motion", lambda _: "omit one of them"),
    Need("simulation.method", lambda its: not its.has("displacements"),
         "does not reproduce displacements, so that events would be wrong",
         lambda _: "with events allowed: "
         + ", ".join(_thermal_methods(lambda each: each.displacements))),
)  # fmt: skip
#: Of the emitted equations of motion of a model
OF_EQUATIONS = (
    Need("simulation.model",
         lambda its: its.body and its.model.name in ("scaled", "first-order"),
         "applies to spheres", _set("simulation.model", "full")),
    Need("wall", lambda its: its.body and _beside_wall(its.problem.scene),
         "the drag beside a wall is known for spheres; a body of another shape must be at least "
         f"{_FAR_FROM_WALLS:g} times its largest radius from it", lambda _: "remove wall"),
    Need("simulation.model",
         lambda its: not its.problem.drag.uniform and "beta_v" in its.problem.emitted.PARAMS,
         _EVEN_DRAG, _set("simulation.model", "full")),
)  # fmt: skip
#: Requirements of the method `exponential`
OF_METHOD = (
    Need("simulation.method",
         lambda its: its.has("exact_drag") and not its.problem.takes_drag_exactly,
         "requires a sphere under forces that do not depend on the orientation, or a body of "
         "another shape, and no first-order model", _set("simulation.method", "auto")),
)  # fmt: skip

#: Motions that may include the memory of the fluid; the linear motion about an equilibrium is
#: computed for a scene whose model and method are not decided
DETERMINISTIC, THERMAL, LINEAR = "deterministic", "thermal", "linear"


class Forgotten(NamedTuple):
    """Property of a scene that excludes hydrodynamic memory for some motions."""

    motions: tuple[str, ...]
    """the motions concerned: `DETERMINISTIC`, `THERMAL`, `LINEAR`"""
    unmet: Callable[[Facts], bool]
    """whether the fact is present"""
    why: str
    """reason, in words, with {model} and {method}"""


#: For each motion, the first one counts
MEMORY = (
    Forgotten((DETERMINISTIC, LINEAR), lambda its: its.names_another_model, _WHERE_NAMED),
    Forgotten((DETERMINISTIC, LINEAR), lambda its: its.method is not None and not its.has("memory"),
              "the method {method} cannot follow it"),
    Forgotten((DETERMINISTIC,), lambda its: not its.problem.drag.uniform,
              "the drag depends on the position, as it does beside a wall"),
    Forgotten((DETERMINISTIC,), lambda its: not its.problem.takes_drag_exactly,
              "it requires a sphere, a drag that is the same everywhere, and forces that do not "
              "depend on the orientation"),
    Forgotten((THERMAL,), lambda its: not (its.scheme.memory and its.model.inertia),
              "the model {model} by {method} cannot follow it"),
    Forgotten((THERMAL, LINEAR), lambda its: not its.even,
              "the drag depends on the position or the direction"),
    Forgotten((THERMAL,), lambda its: its.has("spring_only") and its.coupled,
              "{method} cannot follow it in a trap that couples the axes"),
    Forgotten((THERMAL,), lambda its: its.names_another_model, _WHERE_NAMED),
    Forgotten((DETERMINISTIC, LINEAR), lambda its: its.body, "it is known for spheres only"),
    Forgotten((DETERMINISTIC, THERMAL, LINEAR), lambda its: its.problem.scene.rarefied,
              "the gas is no continuum for the bead"),
    Forgotten((DETERMINISTIC, THERMAL), lambda its: its.problem.rings_with_fluid,
              "the elements of the viscoelastic medium would ring with it"),
)  # fmt: skip


def choice(problem: AnyProblem, key: str) -> tuple[AnyProblem, str]:
    """Return a problem with a key of `simulation` decided for thermal motion, and the reason."""
    its = Facts(problem)
    row = next(each for each in CHOICES if each.key == key and each.where(its))
    return problem.decided(simulation={key: row.value}), f"{row.value}: {row.why}"


def check(problem: Bound, needs: tuple[Need, ...]) -> None:
    """Raise `SceneError` for the first of some needs that is not met."""
    its = Facts(problem)
    for need in needs:
        if need.unmet(its):
            raise SceneError(need.refusal(its))


def without_memory(problem: Bound, motion: str) -> str:
    """Return why a motion of `MEMORY` cannot include hydrodynamic memory; empty if it can."""
    its = Facts(problem)
    rows = (row for row in MEMORY if motion in row.motions)
    return next((its.says(row.why) for row in rows if row.unmet(its)), "")


def with_inertia_of_the_fluid(
    problem: AnyProblem, memory: Callable[[AnyProblem], tuple[int, str]]
) -> tuple[AnyProblem, str]:
    """Choose fluid inertia for a problem whose model of motion has been chosen.

    Returns the problem with this choice, and the reason for it. The memory of the fluid is a sum of
    exponentials; `memory` returns their number (poles) for a problem, and the reason.

    Raises `SceneError` if the scene sets `memory` and it cannot be included.
    """
    medium = problem.scene.medium
    missing = without_memory(problem, THERMAL if problem.scene.forces.brownian else DETERMINISTIC)
    if not missing:
        poles, why = memory(problem)
        return problem.remembering(poles), why
    if medium.inertia == "memory":
        raise SceneError(
            f"medium.inertia = 'memory': {missing}; must be none or added-mass; set medium.inertia "
            "to none"
        )
    if medium.poles is not None:
        raise SceneError(
            f"medium.poles = {medium.poles}: requires the memory of the fluid, but {missing}; "
            "remove medium.poles"
        )
    return problem.decided(medium={"inertia": "none"}), f"no inertia of the fluid: {missing}"


def is_diagonal(rates: Array) -> bool:
    """Return whether a matrix (3, 3) couples no axis to another."""
    return np.array_equal(rates, np.diag(np.diag(rates)))


def rates_of(equilibrium: Equilibrium, mobility: Array) -> Array:
    """Return mobility times stiffness, (3, 3) 1/s; entries that are only rounding are set to zero.

    mobility: at least (3,), s/kg, along the axes first.
    """
    stiffness = np.array(equilibrium.stiffness)
    stiffness[np.abs(stiffness) < _ROUNDING * np.abs(stiffness).max()] = 0.0
    return mobility[TRANSLATION, None] * stiffness
