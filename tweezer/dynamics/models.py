"""Equations of motion bound to a scene: the emitted model that suits it, and the light.

The choices that depend on the scene are made here, once: the emitted module, whether rotation is
included, and which derivatives of the force are needed.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from types import ModuleType
from typing import Any

import numpy as np

from tweezer.compiled import address, cache_functions
from tweezer.dynamics.body import BodyMotion
from tweezer.dynamics.continuing import Begin
from tweezer.dynamics.emitted import module, takes_drag_exactly
from tweezer.dynamics.events import Piece
from tweezer.dynamics.integrators.exponential import Relaxation
from tweezer.dynamics.integrators.system import DERIVATIVES, RATES, System
from tweezer.dynamics.layout import POSITION, ROTATION, TRANSLATION, Layout
from tweezer.dynamics.needs import OF_EQUATIONS, check
from tweezer.dynamics.problem import Problem, bound_once
from tweezer.fluid import Modes, Resisted
from tweezer.forces.data import Part, packed
from tweezer.forces.force import Force, bound, numbered
from tweezer.forces.wall import BORN
from tweezer.generated import kinematics
from tweezer.scene import Scene
from tweezer.scene.choices import MODELS
from tweezer.values.arrays import Array
from tweezer.values.errors import IntegrationError, SceneError
from tweezer.values.shown import Card, Row, Shown

cache_functions(kinematics)


#: rates carry the tolerance of their coordinate per this time (the thesis's unit of time), s
RATE_TIME = 1e-3


#: relaxation times after which nothing is left of the initial layer
_LAYER = 50.0


#: Largest tolerance of a position beside a wall, over the length of the force of contact
_OF_CONTACT = 0.005


@dataclass(frozen=True)
class Motion:
    """Position, velocity and orientation of a bead at n times."""

    position: Array
    """(n, 3) m from the focus"""
    velocity: Array | None
    """(n, 3) m/s; None for thermal motion without inertia, which has none"""
    orientation: Array | None
    """(n, 4) Euler parameters of length 1, or None for a scene without rotation"""
    angular_velocity: Array | None
    """(n, 3) rad/s, body frame; None if `velocity` or `orientation` is None"""
    in_phase: Array | None = None
    """(n, 3) m, amplitude in phase with the reference of the lock-in; None without one"""
    quadrature: Array | None = None
    """(n, 3) m, amplitude a quarter of a period ahead of the reference; None without a lock-in"""
    feedback_force: Array | None = None
    """(n, 3) N, force by a controller; None without one that sets a force"""
    feedback_power: Array | None = None
    """(n, 3) relative changes of the power by a controller; None without one that sets it"""
    feedback_position: Array | None = None
    """(n, 3) m, displacement of the light by a controller; None without one that moves it"""


@dataclass(repr=False)
class EquationsOfMotion(Shown):
    """Equations of motion: one emitted model with a scene's parameters and light.

    `rhs(t, y)` and `jacobian(t, y)` can be passed to any solver. `initial_state` is the state at
    the release, and `motion` converts states to positions and velocities.
    """

    problem: Problem
    module: ModuleType
    begin: Begin | None = None
    """end of the run that is continued; None for a run from the release"""
    force_calls: int = field(default=0, init=False)
    """number of positions at which `rhs` and `jacobian` have evaluated the light so far"""
    rotates: bool = field(init=False)
    """whether the state contains an orientation"""
    inertial: bool = field(init=False)
    """whether the state contains velocities, which relax much faster than the position"""

    def __post_init__(self) -> None:
        self.scene, self.bead = self.problem.scene, self.problem.bead
        self.force, self.drag = self.problem.force, self.problem.drag
        simulation = self.scene.simulation
        values = _parameter_values(self.problem, simulation.scaling_factor)
        self.params = np.array([values[name] for name in self.module.PARAMS])
        self.layout = Layout.of_emitted(self.module.STATE)
        self._size = self.layout.size
        self.rotates = "orientation" in self.layout
        self._constrained = "euler_rates" in self.layout
        self.inertial = "velocity" in self.layout
        self._asks_orientation = self.force.oriented or self.drag.oriented
        self._rhs_inputs = self._inputs(self.module.RHS_INPUTS)
        self._jacobian_inputs = self._inputs(self.module.JACOBIAN_INPUTS)
        self.initial_state = self._initial_state()
        self.absolute_tolerance = self._absolute_tolerance()

    def __reduce__(self) -> tuple[Any, ...]:
        """Bind the problem again in another process."""
        return _bound_again, (self.problem, self.name, self.begin)

    def card(self) -> Card:
        """Return the summary that is shown: model, variables, tolerances."""
        simulation = self.scene.simulation
        rows = (
            Row("model", f"{simulation.model}, emitted as {self.name}"),
            Row("variables", ", ".join(self.module.STATE)),
            Row("relative tolerance", f"{simulation.relative_tolerance:g}"),
            Row("force calls so far", f"{self.force_calls}"),
        )
        return Card("EquationsOfMotion", self.scene.name, rows)

    @functools.cached_property
    def relaxation(self) -> Relaxation:
        """Relaxation of the velocities towards force over drag, as the exponential method requires
        it.

        The relaxation times and mobilities are found by evaluating the emitted rates, with the drag
        at the start. Assumes equal moments of inertia.
        """
        names, first = self.module.PARAMS, self.layout.first
        rest = np.zeros(self._size)
        if self.rotates:
            rest[first("orientation")] = 1.0
        # rates of the velocities or, without inertia, velocities: e' is half the angular velocity
        begins = [first("velocity"), first("angular_velocity")]
        if not self.inertial:
            begins = [first("position"), first("orientation") + 1]
        where = [begin + i for begin in begins[: 1 + self.rotates] for i in range(3)]
        scale = np.ones(len(where))
        if not self.inertial:
            scale[ROTATION] = 2.0
        none, weightless = np.zeros((3, 3)), self.params.copy()
        weightless[[name.startswith("W") for name in names]] = 0.0
        mobility = self.drag.mobilities(np.array([self.scene.start_position])).value[0]
        mobility[4] = 0.0  # rolling is part of `moving`

        def rates(params: Array, y: Array, pushed: int | None = None) -> Array:
            """Return the emitted rates of the velocities in a state y.

            pushed: index of a force or torque component that is 1, the others being 0; None for no
            force.
            """
            wrench, out = np.zeros(6), np.empty(self._size)
            if pushed is not None:
                wrench[pushed] = 1.0
            force, moment = wrench[TRANSLATION], wrench[ROTATION]
            self.module.rates(0.0, y, force, moment, none, none, mobility, params, out)
            return scale * out[where]

        many = range(len(where))
        times = np.ones(len(where))
        if self.inertial:  # without the weight, so that the drag alone keeps its digits
            moving = rest + np.eye(self._size)[where]
            times = np.array([-1.0 / rates(weightless, moving[i])[i] for i in many])
        response = np.array([times[i] * rates(weightless, rest, i)[i] for i in many])
        drift = (times * rates(self.params, rest))[TRANSLATION]
        if not self.inertial:
            times[:] = 0.0
        inertia = np.zeros(0)
        if not self.drag.uniform:  # the weight is part of the force
            drift, along = np.zeros(3), times[TRANSLATION]
            inertia = (along / response[TRANSLATION])[along > 0]
        return Relaxation(
            bound(self.moving, gradient=False), self._modes(times), 0,
            numbered(self.force) or Part(0, packed()), response, drift,
            0.0, self.problem.fastest, inertia, np.zeros(0), np.zeros(0),
        )  # fmt: skip

    @functools.cached_property
    def moving(self) -> Force:
        """Force on the bead; if the drag depends on the position, an equivalent force.

        With the constant mobilities at the start, the equivalent force gives the same velocities.
        """
        if self.drag.uniform:
            return self.force
        weight, mobility = np.array(self.bead.weight), self.problem.mobility
        return Resisted(self.force, self.drag, weight, mobility)

    def _modes(self, times: Array) -> Modes:
        """Return the modes of the velocity along and about each axis.

        times: (axes,) relaxation times by the emitted rates, s. Hydrodynamic memory replaces those
        of translation by several modes.
        """
        if not self.remembers:
            return Modes(times[:, None], np.ones((len(times), 1)))
        memory = self.problem.modes
        found = Modes(*np.zeros((2, len(times), memory.times.size)))
        found.times[TRANSLATION], found.weights[TRANSLATION] = memory
        # a rotation has no memory
        found.times[ROTATION, 0], found.weights[ROTATION, 0] = times[ROTATION], 1.0
        return found

    @property
    def remembers(self) -> bool:
        """Whether hydrodynamic memory, or that of a viscoelastic medium, is part of the motion;
        the emitted rates do not contain it.
        """
        return self.scene.medium.inertia == "memory" or self.problem.network is not None

    @property
    def fastest_relaxation(self) -> float:
        """Shortest relaxation time of a velocity at the start, s, scaled if the model is."""
        factor = self.scene.simulation.scaling_factor if "a2" in self.module.PARAMS else None
        return float(self._relaxation_times.min()) / (factor or 1.0)

    @property
    def _relaxation_times(self) -> Array:
        """Relaxation times of the velocities at the start, s: (3,), or (6,) with rotation."""
        bead, mobility = self.bead, self.problem.mobility
        translation = self.problem.effective_mass * mobility[TRANSLATION]
        if self.body is not None:
            return self.body.relaxation_times
        if not self.rotates:
            return translation
        return np.append(translation, np.array(bead.moments_of_inertia) * mobility[ROTATION])

    @property
    def body(self) -> BodyMotion | None:
        """Drag and inertia of a body that is no sphere; None for a sphere."""
        return self.problem.body

    @property
    def begin_time(self) -> float:
        """Time since the release at which the integration begins, s."""
        return 0.0 if self.begin is None else self.begin.time

    @property
    def begin_state(self) -> Array:
        """State (state,) at `begin_time`."""
        return self.initial_state if self.begin is None else self.begin.state

    @property
    def takes_drag_exactly(self) -> bool:
        """Whether the exponential method can integrate these equations."""
        return takes_drag_exactly(self.module, self.force, self.drag, self.body)

    @property
    def name(self) -> str:
        """Name of the emitted module."""
        return self.module.__name__.rpartition(".")[2]

    def system(self, *, gradient: bool, rates: bool = True, derivatives: bool = False) -> System:
        """Return the arguments of compiled loops.

        `gradient` is whether the force returns its gradients. `rates` and `derivatives` are whether
        the loop calls the emitted rates, and their derivatives.
        """
        return System(
            bound(self.force, gradient=gradient),
            self.drag.part,
            self.drag.uniform,
            address(self.module.rates, RATES) if rates else 0,
            address(self.module.derivatives, DERIVATIVES) if derivatives else 0,
            self.params,
            self.layout.first("orientation") if self._asks_orientation else -1,
        )

    def rhs(self, t: float, y: Array) -> Array:
        """Return the rate of change of the state y at a time t, s, as solvers call it.

        Raises `IntegrationError` if it is not finite, and `SceneError` for a motion with
        hydrodynamic memory, which these rates do not contain.
        """
        self._refuse_memory()
        inputs = (each[0] for each in self._rhs_inputs(np.array([t]), y[None]))
        rates = np.empty(self._size)
        self.module.rhs(t, y, *inputs, self.params, rates)
        if not np.isfinite(rates).all():
            raise IntegrationError("the rate of change of the state is not finite")
        return rates

    def _refuse_memory(self) -> None:
        """Raise `SceneError` for a motion with hydrodynamic memory, which the rates do
        not contain.
        """
        if self.problem.network is not None:
            raise SceneError(
                "medium.relaxing: `rhs` and `jacobian` cannot follow a viscoelastic medium; "
                "tweezer.simulate can"
            )
        if self.remembers:
            raise SceneError(
                "medium.inertia = 'memory': `rhs` and `jacobian` cannot follow the memory; "
                "allowed: none, added-mass; set medium.inertia to none"
            )

    def _rates(self, times: Array, states: Array) -> Array:
        """Return the rates of change of `states` (n, state) at `times` (n,), s.

        The emitted function is called as Python: it contains only arithmetic, which works on
        arrays.
        """
        inputs = [np.moveaxis(np.asarray(each), 0, -1) for each in self._rhs_inputs(times, states)]
        rates = np.empty((len(states), self._size))
        self.module.rhs.py_func(times, states.T, *inputs, self.params, rates.T)
        return rates

    def jacobian(self, t: float, y: Array) -> Array:
        """Return d(rate i)/d(state j) at a time t, s, for implicit solvers.

        It raises the same errors as `rhs`.
        """
        self._refuse_memory()
        derivative = np.empty((self._size, self._size))
        inputs = (each[0] for each in self._jacobian_inputs(np.array([t]), y[None]))
        self.module.jacobian(t, y, *inputs, self.params, derivative)
        return derivative

    def on_constraints(self, states: Array) -> Array:
        """Return states (..., state) with |e| = 1 (A.21) and, if they contain e', e.e' = 0 (A.22).

        This replaces the stabilising terms of (A.26). Neither the orientation nor the angular
        velocity changes.
        """
        if not self.rotates:
            return states
        states, e = np.array(states, order="C"), self.layout.at("orientation")
        if self._constrained:
            rates, projected = self.layout.at("euler_rates"), np.empty(8)
            for y in states.reshape(-1, self._size):
                kinematics.project(y[e], y[rates], projected)
                y[e], y[rates] = np.split(projected, 2)
        else:
            states[..., e] /= np.linalg.norm(states[..., e], axis=-1, keepdims=True)
        return states

    def motion(self, times: Array, states: Array) -> Motion:
        """Return the positions, velocities and orientations of `states` (n, state) at `times` (n,),
        s.

        If the model has no velocities in its state, they are the rates of change. The first-order
        model adds what remains of its initial layer, so that its position begins where the bead is
        released, and its velocity at the initial velocity to leading order.
        """
        states = self.on_constraints(states)
        # the slow models have no velocities in their state: they are its rates of change
        part = self._part
        position = part(states, "position")
        rates = None if self.inertial else self._rates(times, states)
        velocity = part(states, "velocity") if rates is None else part(rates, "position")
        orientation = angular_velocity = None
        if self.rotates:
            orientation = part(states, "orientation")
            if "angular_velocity" in self.layout:
                angular_velocity = part(states, "angular_velocity")
            else:
                edot = part(states, "euler_rates") if rates is None else part(rates, "orientation")
                angular_velocity = np.empty((len(times), 3))
                kinematics.angular_velocity.py_func(orientation.T, edot.T, angular_velocity.T)
        if hasattr(self.module, "initial_layer"):
            self._add_layer(times, position, velocity, orientation, angular_velocity)
        if orientation is not None:
            orientation /= np.linalg.norm(orientation, axis=1, keepdims=True)
        return Motion(position, velocity, orientation, angular_velocity)

    def released(self, piece: Piece) -> Piece:
        """Return a piece of the motion whose positions include the remaining initial layer.

        For a model without an initial layer, or once it has decayed, the piece is returned
        unchanged.
        """
        if not hasattr(self.module, "initial_layer"):
            return piece
        passed = piece.begin > _LAYER * self.problem.relaxation_time
        return piece if passed else _Released(piece, self)

    def _part(self, states: Array, name: str) -> Array:
        """Return a copy of the columns of a block in states (n, state)."""
        return states[:, self.layout.at(name)].copy()

    def _inputs(
        self, names: tuple[str, ...]
    ) -> Callable[[Array, Array], list[Sequence[Array] | Array]]:
        """Return a function of times (n,) and states (n, state) that evaluates the inputs of
        emitted functions.

        names: names of the inputs between state and parameters, such as force and mobility; their
        values are returned in this order, each with n entries.
        """
        gradient = "force_gradient" in names
        # of a uniform drag: the same at every place
        everywhere = self.drag.mobilities(np.zeros((1, 3)), gradient=True)
        curvature = any(name.endswith("curvature") for name in names)

        def evaluate(times: Array, states: Array) -> list[Sequence[Array] | Array]:
            """Return the inputs at times (n,), s, and states (n, state), in the order
            of `names`.
            """
            self.force_calls += len(states)
            turned = None
            if self._asks_orientation and self.rotates:
                turned = self._part(states, "orientation")
                turned /= np.linalg.norm(turned, axis=1, keepdims=True)
            places = states[:, POSITION]
            at = self.force.field(places, gradient=gradient, time=times, orientations=turned)
            values: dict[str, Sequence[Array] | Array] = {"force": at.force, "moment": at.moment}
            if "mobility" in names:
                if self.drag.uniform:
                    values["mobility"] = [everywhere.value[0]] * len(states)
                    values["mobility_gradient"] = [everywhere.gradient[0]] * len(states)
                else:
                    found = self.drag.mobilities(
                        places, gradient=gradient, time=times, orientations=turned
                    )
                    values["mobility"], values["mobility_gradient"] = found
            if gradient:
                values["force_gradient"] = at.force_gradient
                values["moment_gradient"] = at.moment_gradient
            if curvature:
                (position,), (force,) = places, at.force  # the Jacobian's, of one state
                curvatures = self._curvatures(times[0], position, force)
                values |= {name: each[None] for name, each in curvatures.items()}
            return [values[name] for name in names]

        return evaluate

    def _curvatures(self, time: float, position: Array, force: Array) -> dict[str, Array]:
        """Return the rates of change of the force and torque gradients along (F + W)/beta_v.

        Each is (3, 3), a central difference. Only the Jacobian of the first-order model needs them,
        and this accuracy is enough for an implicit solver. `time` is in s, `position` (3,) in m and
        `force` (3,) in N.
        """
        velocity = (force + self.bead.weight) * self.problem.mobility[TRANSLATION]
        speed = float(np.linalg.norm(velocity))
        if speed == 0.0:
            return dict.fromkeys(("force_curvature", "moment_curvature"), np.zeros((3, 3)))
        step = 1e-4 * self.scene.body.size
        ends = position + np.outer([-step, step], velocity / speed)
        self.force_calls += 2
        at = self.problem.field(ends, gradient=True, time=time)
        scale = speed / (2 * step)
        return {
            "force_curvature": (at.force_gradient[1] - at.force_gradient[0]) * scale,
            "moment_curvature": (at.moment_gradient[1] - at.moment_gradient[0]) * scale,
        }

    def _released(self) -> dict[str, Array]:
        """Return the blocks of the state at the release: q and v, or q, e, v and omega with
        rotation.
        """
        start = self.scene.start
        position, velocity = np.array(self.scene.start_position), np.array(start.velocity)
        if not self.rotates:
            return {"position": position, "velocity": velocity}
        return {
            "position": position,
            "orientation": self.problem.orientation,
            "velocity": velocity,
            "angular_velocity": np.array(start.angular_velocity),
        }

    def _release_inputs(self) -> tuple[Array, ...]:
        """Return the inputs of emitted functions of the release: its state, force and torque,
        parameters.
        """
        at = self.problem.field(np.array([self.scene.start_position]))
        fields = (at.force[0], at.moment[0]) if self.rotates else (at.force[0],)
        return (np.concatenate([*self._released().values()]), *fields, self.params)

    def _initial_state(self) -> Array:
        """Return the state at the release, (state,), as the emitted module has it."""
        if hasattr(self.module, "matched_start"):
            start = np.empty(self._size)
            self.module.matched_start(*self._release_inputs(), start)
            return start
        released = self._released()
        if self._constrained:
            edot = released["euler_rates"] = np.empty(4)
            kinematics.euler_rates(released["orientation"], released["angular_velocity"], edot)
        return np.concatenate([released[name] for name in self.layout.blocks])

    def _add_layer(
        self,
        times: Array,
        position: Array,
        velocity: Array,
        orientation: Array | None,
        angular_velocity: Array | None,
    ) -> None:
        """Add the remaining initial layer to a slow motion, in place.

        times: (n,) s. The other arguments are the quantities of `Motion`, (n, 3) or (n, 4).
        """
        remains = np.empty(6 if orientation is None else 12)
        inputs = self._release_inputs()
        for i in np.flatnonzero(times < _LAYER * self._relaxation_times.max()):
            self.module.initial_layer(times[i], *inputs, remains)
            moved, sped, *turning = remains.reshape(-1, 3)
            position[i] += moved
            velocity[i] += sped
            if orientation is not None and angular_velocity is not None:
                turned = np.empty(4)
                kinematics.euler_rates(orientation[i], turning[0], turned)
                orientation[i] += turned
                angular_velocity[i] += turning[1]

    def _absolute_tolerance(self) -> Array:
        """Return the absolute tolerance of each component of a state, (state,), in its unit."""
        simulation = self.scene.simulation
        position = simulation.position_tolerance
        if self.problem.walls:  # what touches must not sink in
            position = min(position, _OF_CONTACT * BORN)
        tolerances = {
            "position": position,
            "velocity": simulation.position_tolerance / RATE_TIME,
            "orientation": simulation.orientation_tolerance,
            "euler_rates": simulation.orientation_tolerance / RATE_TIME,
            "angular_velocity": simulation.orientation_tolerance / RATE_TIME,
        }
        each = [np.full(width, tolerances[name]) for name, width in self.layout.blocks.items()]
        return np.concatenate(each)


@dataclass(frozen=True)
class _Released:
    """Piece of a motion whose positions include the initial layer, see
    `EquationsOfMotion.released`.
    """

    piece: Piece
    equations: EquationsOfMotion

    @property
    def begin(self) -> float:
        return self.piece.begin

    @property
    def end(self) -> float:
        return self.piece.end

    def checkpoints(self) -> Array:
        return self.piece.checkpoints()

    def states(self, times: Array) -> Array:
        states = self.piece.states(times)
        states[:, POSITION] = self.equations.motion(times, states).position
        return states


def bind(scene: Scene | Problem, begin: Begin | None = None) -> EquationsOfMotion:
    """Return the equations of motion of a scene: the smallest emitted model that is sufficient.

    If the scene does not set a model, the unscaled equations are used. If it does not set fluid
    inertia, fluid inertia is omitted, whereas `tweezer.simulate` chooses it.

    Parameters
    ----------
    scene : Scene or Problem
        Scene, or the problem bound to it.
    begin : Begin, optional
        State from which the equations continue. Default: the release.

    Returns
    -------
    EquationsOfMotion
        Rates, state and units of the model.
    """
    problem = bound_once(scene)
    check(problem, OF_EQUATIONS)
    return EquationsOfMotion(problem, problem.emitted, begin)


def bind_translation(problem: Problem, model: str) -> EquationsOfMotion:
    """Return the equations of motion of a model without rotation, whether the bead
    rotates or not.
    """
    return EquationsOfMotion(problem, module(f"{MODELS[model].modules}_translation"))


def _bound_again(problem: Problem, name: str, begin: Begin | None) -> EquationsOfMotion:
    """Return equations of motion from a problem and the name of the emitted module, after
    unpickling.
    """
    return EquationsOfMotion(problem, module(name), begin)


def _parameter_values(problem: Problem, scaling_factor: float | None) -> dict[str, float]:
    """Return the values of the emitted modules' parameters by name, in SI units."""
    bead, mobility = problem.bead, problem.mobility
    return {
        **({} if problem.body is None else problem.body.parameters),
        "m": problem.effective_mass,
        "I": bead.moments_of_inertia[0],
        **{f"I{i + 1}": moment for i, moment in enumerate(bead.moments_of_inertia)},
        "a2": scaling_factor if scaling_factor is not None else 1.0,
        **{f"W{i + 1}": component for i, component in enumerate(bead.weight)},
        # of a uniform drag
        "beta_v": 1 / mobility[0],
        "beta_w": 1 / mobility[3],
    }
