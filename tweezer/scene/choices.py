"""The one table of names: models, methods, theories of light and evaluators, with their
requirements.

Checks of scenes, errors, the command line's help and the documentation read it. The code behind a
name is loaded when it is used: importing this module loads nothing.
"""

from __future__ import annotations

import importlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

#: Poles of the memory of the fluid, of a run without a tolerance
POLES = 24
#: What a sweep computes of every case
SWEPT = ("trap", "run", "ensemble", "calibrate")


@dataclass(frozen=True)
class Model:
    """A model of motion: equations in modules that `derivation` has generated, one for each
    variant.
    """

    name: str
    about: str
    """description in a few words"""
    modules: str
    """first part of the names of its modules in `generated/`"""
    inertia: bool = False
    """whether its state contains velocities; only then can the fluid have inertia"""
    rotating: str = ""
    """last part of the name of its module with rotation, if that is the same for every body"""
    scheme: str = ""
    """"module:name" of its own scheme of thermal motion; "" if the method's scheme applies"""


@dataclass(frozen=True)
class Method:
    """A method of integrating the motion in time, and its capabilities."""

    name: str
    about: str
    """description in a few words"""
    place: str
    """"module:name" of its code: a method of `tweezer.dynamics.integrators`, a solver of
    `scipy.integrate`, or a `tweezer.dynamics.brownian.batch.Scheme`"""
    thermal: bool = False
    """whether it is for thermal motion, and for no other"""
    models: tuple[str, ...] = ("full", "scaled", "overdamped")
    """models of thermal motion that it can integrate"""
    fixed_steps: bool = True
    """whether it takes `simulation.step`"""
    spring_only: bool = False
    """whether it is exact for a trap at rest that is a linear spring, without torque, and for
    nothing else"""
    displacements: bool = True
    """whether displacements between samples have the right statistics"""
    implicit: bool = False
    """whether it needs the Jacobian of the right-hand side"""
    uniform_drag: bool = False
    """whether the drag must be the same everywhere"""
    beside_wall: Mapping[str, str] = field(default_factory=dict)
    """"module:name" of its scheme beside a wall, by the models that it can integrate there"""
    memory: bool = False
    """whether it can integrate the memory of a fluid with inertia"""
    exact_drag: bool = False
    """whether it integrates the drag exactly, and so only models with linear drag"""
    multistep: bool = False
    """whether it keeps differences of past states, which cannot be projected back on constraints"""

    @property
    def solver(self) -> bool:
        """Whether it is a solver of SciPy."""
        return self.place.startswith("scipy.")

    def load(self) -> Any:
        """Import and return its code, the object at `place`."""
        return at(self.place)


@dataclass(frozen=True)
class Inertia:
    """A degree to which the inertia of the fluid is taken into account."""

    name: str
    about: str


@dataclass(frozen=True)
class Theory:
    """A theory of light, ray optics or wave optics, and the function that makes its force map."""

    name: str
    about: str
    map: str
    """"module:name" of the function that makes the force map of a scene; it also takes a callback
    for its progress"""


@dataclass(frozen=True)
class Evaluator:
    """A way to compute the force of the light on the bead."""

    name: str
    about: str
    places: Mapping[str, str]
    """"module:name", by theory, of the function that returns the force of a scene's single beam, a
    `tweezer.optics.light.LightForce`"""
    symmetric: tuple[str, ...] = ()
    """theories in which it requires light that is symmetric about its axis"""
    mapped: bool = False
    """whether a force map replaces it in fits, which need many forces"""

    def load(self, theory: str) -> Any:
        """Import and return its function for a theory, the object at `places[theory]`."""
        return at(self.places[theory])


def at(place: str) -> Any:
    """Import and return the object at "module:name"."""
    module, _, name = place.partition(":")
    return getattr(importlib.import_module(module), name)


def _by_name(*entries: Any) -> dict[str, Any]:
    """Return the entries by their names."""
    return {each.name: each for each in entries}


_METHODS = "tweezer.dynamics.integrators"
_SCHEMES = "tweezer.dynamics.brownian"
_OPTICS = "tweezer.optics"

MODELS: dict[str, Model] = _by_name(
    Model("full", "(A.25)", "full", inertia=True),
    Model("scaled", "(4.17), inertia divided by the scaling factor", "scaled", inertia=True),
    Model("overdamped", "(5.2)", "overdamped", rotating="rotation"),
    Model(
        "first-order",
        "the expansion (4.11) carried to order epsilon",
        "first_order",
        scheme=f"{_SCHEMES}.first_order:FIRST_ORDER",
    ),
)

METHODS: dict[str, Method] = _by_name(
    Method("dormand-prince", "the thesis's ode45", f"{_METHODS}.dormand_prince:DORMAND_PRINCE"),
    Method("dop853", "for tight tolerances", f"{_METHODS}.dop853:DOP853"),
    Method("exponential", "collocation that takes the drag exactly; what auto takes for spheres",
           f"{_METHODS}.exponential:EXPONENTIAL",
           memory=True, exact_drag=True),
    *(
        Method(f"scipy:{name}", "a solver of scipy.integrate", f"scipy.integrate:{name}",
               fixed_steps=False, implicit=implicit, multistep=multistep)
        for name, implicit, multistep in (
            ("RK45", False, False), ("DOP853", False, False), ("Radau", True, False),
            ("BDF", True, True), ("LSODA", True, True),
        )
    ),
    Method("heun", "exponential Heun, what auto takes", f"{_SCHEMES}.heun:HEUN", thermal=True,
           models=("full", "scaled", "overdamped", "first-order"), uniform_drag=True, memory=True,
           beside_wall={"overdamped": f"{_SCHEMES}.wall:HEUN",
                        "full": f"{_SCHEMES}.wall_with_inertia:HEUN"}),
    Method("one-call", "one force a step, for distributions", f"{_SCHEMES}.one_call:ONE_CALL",
           thermal=True, displacements=False, uniform_drag=True, memory=True,
           beside_wall={"overdamped": f"{_SCHEMES}.wall:ONE_CALL"}),
    Method("harmonic", "the exact motion in the trap's spring", f"{_SCHEMES}.euler:HARMONIC",
           thermal=True, spring_only=True, uniform_drag=True, memory=True),
    Method("euler-maruyama", "for comparison; without inertia for a drag by place",
           f"{_SCHEMES}.euler:EULER_MARUYAMA", thermal=True),
    Method("baoab", "for comparison", f"{_SCHEMES}.baoab:BAOAB", thermal=True,
           models=("full", "scaled"), uniform_drag=True),
)  # fmt: skip

INERTIAS: dict[str, Inertia] = _by_name(
    Inertia("none", "Stokes's drag alone, as the thesis"),
    Inertia("added-mass", "half the mass of the displaced fluid moves with the bead"),
    Inertia("memory", "that and the vorticity shed before (Boussinesq, Basset)"),
)

THEORIES: dict[str, Theory] = _by_name(
    Theory("rays", "ray optics, as in the thesis (chapter 3)", f"{_OPTICS}.rays.by_map:ray_map"),
    Theory("waves", "focused plane waves scattered by a sphere (Debye, Mie), exact at any size",
           f"{_OPTICS}.waves.by_map:wave_map"),
)  # fmt: skip

EVALUATORS: dict[str, Evaluator] = _by_name(
    Evaluator("grid", "the thesis's sum over squares of the pupil (3.26), of rays alone",
              {"rays": f"{_OPTICS}.rays.by_grid:by_grid"}, mapped=True),
    Evaluator("quadrature", "the integral over the lens, to `tolerance`; what auto takes",
              {"rays": f"{_OPTICS}.rays.by_quadrature:by_quadrature",
               "waves": f"{_OPTICS}.waves.by_quadrature:by_quadrature"}, mapped=True),
    Evaluator("map", "a table of it, to `table_tolerance`",
              {"rays": f"{_OPTICS}.rays.by_map:by_map", "waves": f"{_OPTICS}.waves.by_map:by_map"},
              symmetric=("rays",), mapped=True),
)  # fmt: skip


def evaluator(name: str) -> Evaluator:
    """Return the evaluator with a name of `optics.evaluator`; for "auto" the quadrature."""
    return EVALUATORS["quadrature" if name == "auto" else name]


def told(entries: Iterable[Model | Method | Inertia | Theory | Evaluator]) -> str:
    """Return the descriptions of entries in one line; entries with the same one share it."""
    by_text: dict[str, list[str]] = {}
    for each in entries:
        by_text.setdefault(each.about, []).append(each.name)
    return "; ".join(f"{', '.join(names)}: {about}" for about, names in by_text.items())


def methods(*, thermal: bool) -> list[Method]:
    """Return the methods for thermal motion, or those for motion without it."""
    return [each for each in METHODS.values() if each.thermal == thermal]
