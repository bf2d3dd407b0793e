"""The needs of models and methods: one table of the facts of a scene against their traits.

A row of `CHOICES` gives what a key is, where a scene with thermal motion leaves it open. A row of
`NEEDS` gives a fact of the scene that a model or method cannot follow, and the refusal in words. A
row of `MEMORY` gives why a motion cannot have the memory of the fluid. The scene is refused if it
names the memory; otherwise its motion has no inertia of the fluid. A scene's own validators refuse
what needs no bound problem (`tweezer.scene.scene`).
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tweezer.dynamics.brownian.batch import Scheme
from tweezer.dynamics.layout import TRANSLATION
from tweezer.dynamics.models import bind
from tweezer.dynamics.problem import Problem
from tweezer.forces.equilibria import Equilibrium
from tweezer.scene.choices import METHODS, MODELS, Method, Model, at, methods
from tweezer.values.errors import SceneError

Array = NDArray[np.float64]

#: Part of the largest stiffness below which an entry of it is rounding
_ROUNDING = 1e-9


@dataclass(frozen=True)
class Facts:
    """Facts of a problem, and traits of its model and its method."""

    problem: Problem

    @functools.cached_property
    def model(self) -> Model:
        """Model that the scene names, or has been given; `full` before."""
        return MODELS[self.problem.scene.simulation.model or "full"]

    @functools.cached_property
    def method(self) -> Method | None:
        """Method that the scene names, or has been given; None before."""
        return METHODS.get(self.problem.scene.simulation.method)

    def has(self, trait: str) -> bool:
        """Return whether a method is decided that has a trait."""
        return bool(getattr(self.method, trait, False))

    @property
    def thermal(self) -> bool:
        """Whether the motion is thermal."""
        return bool(self.problem.scene.forces.brownian)

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
        if self.walls:
            return list(METHODS["heun"].beside_wall)
        slow = (name for name, each in MODELS.items() if not (each.inertia or each.scheme))
        return list(MODELS) if self.problem.drag.uniform else list(slow)

    @property
    def scheme(self) -> Scheme:
        """Scheme of the steps of thermal motion."""
        assert self.method is not None
        place = self.model.scheme or self.method.place
        if self.walls:
            place = self.method.beside_wall.get(self.model.name, place)
        scheme: Scheme = at(place)
        return scheme

    @property
    def even(self) -> bool:
        """Whether the drag is the same everywhere and in every direction."""
        return self.problem.drag.uniform and np.ptp(self.problem.mobility[TRANSLATION]) == 0

    @property
    def coupled(self) -> bool:
        """Whether the trap couples the axes."""
        trap = self.problem.equilibrium
        return trap is not None and not is_diagonal(rates_of(trap, self.problem.mobility))

    @property
    def exact(self) -> bool:
        """Whether the exponential method takes the drag of the model exactly."""
        return bind(self.problem.changed(model=self.model.name)).takes_drag_exactly

    def says(self, words: str) -> str:
        """Return words with the names of the model and the method filled in."""
        simulation = self.problem.scene.simulation
        where = "beside a wall" if self.walls else "under a drag that depends on the position"
        return words.format(model=self.model.name, method=simulation.method, where=where)


class Choice(NamedTuple):
    """Value of a key of `simulation` that a scene with thermal motion leaves open."""

    key: str
    value: str
    why: str
    where: Callable[[Facts], bool] = lambda _: True


#: Of each key the first row whose fact is there
CHOICES = (
    Choice("model", "full", "inertia is exact at any step", lambda its: its.problem.drag.uniform),
    Choice("model", "overdamped", "the drag depends on the place"),
    Choice("method", "heun", "the gap as the radius of a motion in a plane, weak order 2",
           lambda its: its.walls),
    Choice("method", "euler-maruyama", "the drag depends on the place", lambda its: its.by_place),
    Choice("method", "heun", "exact drag and noise, weak order 2"),
)  # fmt: skip


class Need(NamedTuple):
    """A fact that a model or a method cannot follow."""

    key: str
    """key of the scene that is refused, "section.name" """
    unmet: Callable[[Facts], bool]
    problem: str
    """in words, with {model} and {where}"""
    instead: tuple[str, str] = ("", "")
    """key and value that mend the scene; without a value the first one of `allowed`"""
    allowed: Callable[[Facts], list[str]] | None = None
    """values that the message lists"""

    def refusal(self, its: Facts) -> str:
        """Return the message, which ends with one change that mends the scene."""
        section, name = self.key.split(".")
        value = getattr(getattr(its.problem.scene, section), name)
        message = f"{self.key} = {value!r}: {its.says(self.problem)}; "
        key, instead = self.instead
        if self.allowed is not None:
            allowed = self.allowed(its)
            message += f"must be {' or '.join(allowed)}; "
            key, instead = self.key, allowed[0]
        return f"{message}set {key} to {instead}"


_HEUN = "simulation.method", "heun"
_WITHOUT_TRAP = "requires a stable equilibrium, and the scene has none"

#: Of a model that the scene names
OF_MODEL = (
    Need("simulation.model", lambda its: its.model.name not in its.followed,
         "cannot follow thermal motion {where}", allowed=lambda its: its.followed),
)  # fmt: skip
#: Of a model and a method that are decided
NEEDS = (
    Need("simulation.method",
         lambda its: its.has("spring_only") and not its.problem.force.steady,
         "follows a trap at rest, but a force or a beam changes in time", _HEUN),
    Need("simulation.method",
         lambda its: its.walls and its.model.name not in getattr(its.method, "beside_wall", ()),
         "cannot keep a bead on its side of a wall in the model {model}",
         allowed=lambda its: [each.name for each in methods(thermal=True)
                              if its.model.name in each.beside_wall]),
    Need("simulation.model",
         lambda its: its.walls and its.model.inertia and its.problem.rotates,
         "cannot follow thermal rotation beside a wall", ("simulation.model", "overdamped")),
    Need("simulation.method", lambda its: its.by_place and its.has("uniform_drag"),
         "requires a drag that is the same everywhere",
         allowed=lambda _: [each.name for each in methods(thermal=True) if not each.uniform_drag]),
    Need("forces.brownian", lambda its: its.by_place and its.problem.rotates,
         "thermal rotation requires a drag that is the same everywhere",
         ("forces.brownian", "false")),
    Need("simulation.method", lambda its: its.problem.force.oriented and its.has("spring_only"),
         "follows no force that turns the bead", _HEUN),
    Need("simulation.model", lambda its: its.problem.force.oriented and bool(its.model.scheme),
         "follows no force that turns the bead", ("simulation.model", "full")),
    Need("simulation.method",
         lambda its: its.has("spring_only") and its.problem.equilibrium is None,
         _WITHOUT_TRAP, _HEUN),
    Need("start.drawn",
         lambda its: its.problem.scene.start.drawn in ("equilibrium", "boltzmann")
         and its.problem.equilibrium is None,
         _WITHOUT_TRAP, ("start.drawn", "no")),
)  # fmt: skip

_WHERE_NAMED = "with the model {model} only where it is named"


def _open(its: Facts) -> bool:
    """Whether the scene leaves the inertia of the fluid open, and its model is another than `full`.

    Before a model is decided this is no reason.
    """
    scene = its.problem.scene
    return scene.medium.inertia is None and scene.simulation.model not in (None, "full")


#: Whether a row is one of thermal motion, the fact, and the reason; the first one counts
MEMORY: tuple[tuple[bool, Callable[[Facts], bool], str], ...] = (
    (False, _open, _WHERE_NAMED),
    (False, lambda its: its.method is not None and not its.method.memory,
     "the method {method} cannot follow it"),
    (False, lambda its: not its.problem.drag.uniform,
     "the drag depends on the position, as it does beside a wall"),
    (False, lambda its: not its.exact,
     "it requires a sphere, a drag that is the same everywhere, and forces that do not depend on "
     "the orientation"),
    (True, lambda its: not (its.scheme.memory and its.model.inertia),
     "the model {model} by {method} cannot follow it"),
    (True, lambda its: not its.even, "the drag depends on the position or the direction"),
    (True, lambda its: its.has("spring_only") and its.coupled,
     "{method} cannot follow it in a trap that couples the axes"),
    (True, _open, _WHERE_NAMED),
)  # fmt: skip


def choice(problem: Problem, key: str) -> tuple[Problem, str]:
    """Return a problem whose key of `simulation` is decided for thermal motion, and why."""
    its = Facts(problem)
    row = next(each for each in CHOICES if each.key == key and each.where(its))
    return problem.decided(simulation={key: row.value}), f"{row.value}: {row.why}"


def check(problem: Problem, needs: tuple[Need, ...]) -> None:
    """Raise `SceneError` for the first of some needs that is not met."""
    its = Facts(problem)
    for need in needs:
        if need.unmet(its):
            raise SceneError(need.refusal(its))


def without_memory(problem: Problem) -> str:
    """Return why a motion cannot have the memory of the fluid; empty if it can."""
    its = Facts(problem)
    rows = (row for row in MEMORY if row[0] == its.thermal)
    return next((its.says(why) for _, unmet, why in rows if unmet(its)), "")


def with_inertia_of_the_fluid(
    problem: Problem, memory: Callable[[Problem], tuple[int, str]]
) -> tuple[Problem, str]:
    """Return a problem of a decided model with what it has of the fluid's inertia, and why.

    `memory` gives the number of poles and the reason of a problem that has the memory. Raises
    `SceneError` if the scene names a memory that cannot be followed.
    """
    medium = problem.scene.medium
    missing = without_memory(problem)
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
    """Return whether no axis is coupled to another."""
    return np.array_equal(rates, np.diag(np.diag(rates)))


def rates_of(equilibrium: Equilibrium, mobility: Array) -> Array:
    """Return mobility times stiffness, (3, 3) 1/s; entries that are rounding are zero."""
    stiffness = np.array(equilibrium.stiffness)
    stiffness[np.abs(stiffness) < _ROUNDING * np.abs(stiffness).max()] = 0.0
    return mobility[TRANSLATION, None] * stiffness
