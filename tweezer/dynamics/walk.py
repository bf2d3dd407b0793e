"""Brownian motion of a scene's bead: the scheme and its step, bound once, and beads taken along."""

from __future__ import annotations

import dataclasses
import functools
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tweezer.compiled import address
from tweezer.dynamics.beside_wall import (
    Towards,
    cut,
    rate_of_sticking,
    towards,
    without_walls,
)
from tweezer.dynamics.brownian import crossing, march, memory, noise, plane, propagator
from tweezer.dynamics.brownian.batch import Linear, Plan, Scheme
from tweezer.dynamics.brownian.crossing import Boundary, share
from tweezer.dynamics.brownian.exposure import HELD
from tweezer.dynamics.brownian.propagator import Weights
from tweezer.dynamics.brownian.rotation import LONGEST, LONGEST_WITH_INERTIA
from tweezer.dynamics.camera import Exposure, Frames, at_short_times, longest_step
from tweezer.dynamics.choose import poles_without_memory, rates_of_force, without_memory
from tweezer.dynamics.continuing import Continued, End
from tweezer.dynamics.layout import POSITION, ROTATION, TRANSLATION, Layout
from tweezer.dynamics.models import Motion
from tweezer.dynamics.problem import Problem, bound_once
from tweezer.dynamics.step_bias import energy_loss, one_call_bias
from tweezer.fluid import DRAG_KERNEL, BesideWall, Modes
from tweezer.forces.data import Part
from tweezer.forces.equilibria import Equilibrium
from tweezer.forces.force import bound
from tweezer.forces.own import fault_of, forget_faults
from tweezer.scene import Scene
from tweezer.scene.arguments import check_thermal
from tweezer.scene.choices import METHODS, MODELS, POLES, at, methods
from tweezer.scene.sections import MOST_SAMPLES, Simulation
from tweezer.values.constants import Boltzmann
from tweezer.values.errors import IntegrationError, SceneError, warn

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

#: Difference of what hidden variables are that rounding may make, as a part of it
_SAME = 1e-6
#: Step over the fastest time scale of the force
_PART = 0.2
#: Step over the time of a swing, sqrt(m/k), where that is longer: 63 steps a period
_PART_OF_SWING = 0.1
#: Largest error of the variance by the step, where the step follows it; and where it is warned of
_BIAS, _WARNED = 0.005, 0.01
#: Smallest error of the variance that is reported
_TOLD = 1e-5
#: Lateness of losses by one call of the force, over the step in relaxation times of the trap and
#: its depth in k_B T, as measured on springs; and the smallest that is reported
_LATE, _TOLD_LATE = 0.25, 1e-3
#: Number of swings in the relaxation time above which the energy that steps take is measured
_MANY_SWINGS = 100.0
#: Step over the relaxation time, for methods that must resolve it
_PART_OF_TAU = 0.2
#: Quantile of |dF/dx| b around the trap that sets the time scale
_MOST = 0.9
#: Step over the time scale of the motion towards a wall with inertia; and where a bead flies freely
#: for more than the last part of that time
_PART_WITH_INERTIA, _PART_OF_FLIGHT, _FLIES = 0.1, 0.025, 1e-3
#: Step over the shortest time in which a force changes, as a jump is smeared over a step
_PART_OF_CHANGE = 0.05
#: Diffusion in a step over the length in which the drag changes
_PART_OF_LENGTH = 0.05
#: Diffusion in a step over the distance at which a bead is lost
_PART_OF_LOSS = 0.25
#: Standard deviations from the trap that a bead does not reach
_FARTHEST = 8.0
#: Number of points on each line from the trap at which the drag is evaluated
_ON_A_LINE = 65
#: Part of the largest stiffness below which an entry of it is rounding
_ROUNDING = 1e-9
#: Upper bound on the steps of a sample interval
_MOST_PER_SAMPLE = 10**6
#: Normal numbers of a start that are not of the memory; those of the memory follow
_DRAWN = Layout({"position": 3, "velocity": 3, "angular_velocity": 3})
#: Steps of all beads between two looks of a camera
_STEPS_AT_ONCE = 2**17


@dataclass(frozen=True)
class Walk:
    """Brownian motion of a scene's bead, bound: fixed steps, numbers drawn by counter."""

    problem: Problem
    """with its model and method decided"""
    seed: int
    why: str
    """what chose model, method and step"""
    step: float
    """s"""
    per_sample: int
    """steps from one sample to the next"""
    times: Array
    """(samples,) s"""
    layout: Layout
    """of a state: the quantities of a sample, the angular velocity about the inertial axes; what a
    camera gathers; the hidden variables of the fluid's memory; when a bead was lost, s"""
    plan: Plan
    weights: Weights
    edge: Boundary
    """where a bead is lost"""
    exposure: Exposure | None = None
    """of the scene's camera"""
    late_losses: float = 0.0
    """relative lateness of times of loss by the step, about, for each k_B T of the well's depth"""
    variance_bias: float | None = None
    """relative error of the variance of the position by the step, about; None where it is small"""

    @functools.cached_property
    def shown(self) -> Layout:
        """Layout of a sample."""
        return self.layout.shown

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the columns of a sample, as the end of a run names them."""
        return self.shown.columns

    @property
    def scheme(self) -> Scheme:
        """Scheme of its steps."""
        return _scheme(self.problem)

    @property
    def loss_caveat(self) -> str:
        """Caveat on the times of losses; "" without one."""
        if self.late_losses < _TOLD_LATE:
            return ""
        return (
            f"times of loss by {self.scene.simulation.method} are late, by about "
            f"{100 * self.late_losses:.2g} % for each kT of the well's depth; heun has them right"
        )

    def warn_of_bias(self) -> None:
        """Warn of a step by which the variance is off by more than a hundredth."""
        bias = self.variance_bias or 0.0
        if abs(bias) > _WARNED:
            size, part = "large", _WARNED / abs(bias)
            if bias < 0:  # r/(r + 1/tau) of a loss r of order 3 in the step
                size, part = "small", (_WARNED / (1 - _WARNED) * (1 + bias) / -bias) ** (1 / 3)
            warn(
                f"{self.scene.name}: with steps of {self.step:.3g} s the variance of the position "
                f"is about {100 * abs(bias):.2g} % too {size}; simulation.step of "
                f"{part * self.step:.1g} s or less makes that 1 %"
            )

    @property
    def scene(self) -> Scene:
        """With its model and method decided."""
        return self.problem.scene

    @property
    def equilibrium(self) -> Equilibrium | None:
        """The stable one nearest the focus."""
        return self.problem.equilibrium

    def start(self, trajectories: Integers) -> Array:
        """States at times[0] of the trajectories of numbers (n,): (n, layout.width).

        The time of loss is infinite for a bead that is not lost.
        """
        start, plan, n = self.scene.start, self.plan, len(trajectories)
        remembers = "memory" in self.layout
        numbers = np.empty((_DRAWN.width + self.layout.blocks.get("memory", 0), n))
        if start.drawn in ("ball", "boltzmann") or remembers:
            noise.normals(self.seed, trajectories, 0, noise.START, numbers)
        drawn = numbers.T
        thermal = start.drawn == "boltzmann"

        x = np.tile(self.scene.start_position, (n, 1))
        if start.drawn == "ball":
            # the direction of five numbers, its first three: uniform in the unit ball
            size = np.linalg.norm(drawn[:, :5], axis=1, keepdims=True)
            direction = drawn[:, _DRAWN.at("position")] / size
            x += start.ball_radius * direction
        elif start.drawn != "no":
            x = np.tile(plan.centre[TRANSLATION], (n, 1))
        speed = np.sqrt(plan.diffusion / plan.tau)
        v = np.tile(start.velocity, (n, 1))
        if thermal:
            v = drawn[:, _DRAWN.at("velocity")] * speed[TRANSLATION]
        parts: dict[str, Array] = {}
        if remembers:
            place, z = self._memory(drawn, v, thermal=thermal)
            x += place
            v = _summed(self.weights.memory[:, None, memory.SEEN], z)[:, 0].T
            parts["memory"] = z.reshape(-1, n).T
        elif thermal and self.equilibrium is not None and self._beside_wall:
            x += self._held(drawn)
        elif thermal and self.equilibrium is not None:
            tau = plan.tau[TRANSLATION] if "velocity" in self.layout else np.zeros(3)
            rates = _rates(self.equilibrium, plan.mobility)
            root = propagator.stationary_root(tau, rates, plan.diffusion[TRANSLATION])
            apart = drawn[:, : len(root)] @ root.T
            x += apart[:, _DRAWN.at("position")]
            v = apart[:, _DRAWN.at("velocity")]
        parts |= {"position": x, "velocity": v, "exposure": np.zeros((n, HELD))}
        parts["lost_time"] = np.full((n, 1), np.inf)
        if "orientation" in self.layout:
            e = np.array(start.orientation)
            e /= np.linalg.norm(e)
            w = rotation_matrices(e[None])[0] @ start.angular_velocity
            parts |= {"orientation": np.tile(e, (n, 1)), "angular_velocity": np.tile(w, (n, 1))}
            if thermal and "angular_velocity" in self.layout:
                turning = drawn[:, _DRAWN.at("angular_velocity")]
                parts["angular_velocity"] = turning * speed[ROTATION]
        return np.ascontiguousarray(np.hstack([parts[name] for name in self.layout.blocks]))

    @property
    def _beside_wall(self) -> bool:
        return isinstance(self.problem.drag, BesideWall)

    def _held(self, drawn: Array) -> Array:
        """Places from the trap, (n, 3), of beads that it holds beside a wall.

        drawn: the numbers (n, 3 or more). Gaussian as far as its spring goes, and cut at contact.
        """
        equilibrium, drag = self.equilibrium, self.problem.drag
        assert equilibrium is not None
        assert isinstance(drag, BesideWall)
        mobility = self.problem.mobilities(np.array([equilibrium.position]))[0]
        rates = _rates(equilibrium, mobility)
        root = propagator.stationary_root(np.zeros(3), rates, self.plan.kT * mobility[TRANSLATION])
        covariance = root @ root.T
        spread = math.sqrt(covariance[2, 2])
        ends = np.array([-math.inf, math.inf])
        for position, normal in drag.planes:
            room = normal * (equilibrium.position[2] - position) - drag.radius
            ends[int(normal < 0)] = -normal * room / spread
        z = cut(drawn[:, 2], *ends.tolist())
        with_z = covariance[:2, 2] / spread
        beside = np.linalg.cholesky(covariance[:2, :2] - np.outer(with_z, with_z))
        x, y = drawn[:, 0], drawn[:, 1]
        return np.column_stack([
            with_z[0] * z + beside[0, 0] * x,
            with_z[1] * z + beside[1, 0] * x + beside[1, 1] * y,
            spread * z,
        ])  # fmt: skip

    def _memory(self, drawn: Array, v: Array, *, thermal: bool) -> tuple[Array, Array]:
        """Places from where beads start, (n, 3), and z (3, k, n): a fluid of the temperature.

        drawn: the numbers (n, 9 + hidden). v: the velocity (n, 3), unless it is thermal.
        """
        of_step, n = self.weights.memory, len(drawn)
        place, hidden = drawn[:, _DRAWN.at("position")], drawn[:, _DRAWN.width :]
        normal = hidden.T.reshape(3, -1, n)
        z = _summed(of_step[:, memory.ROOT :], normal)
        if not thermal:
            # given the velocity: in a fluid at rest on average, of a bead struck to it
            seen = of_step[:, memory.SEEN]
            short = v.T[:, None] - _summed(seen[:, None], z)
            share = seen / (seen**2).sum(axis=1, keepdims=True)
            return np.zeros((n, 3)), z + share[..., None] * short
        if self.equilibrium is None:
            return np.zeros((n, 3)), z
        rates = _rates(self.equilibrium, self.plan.mobility)
        if self.weights.kappa.any() and not _diagonal(rates):
            root = propagator.stationary_root_with_memory(self.weights, rates)
            both = _summed(root[None], np.hstack([place, hidden]).T[None])[0]
            apart, z = np.split(both, [POSITION.stop])
            return apart.T, z.reshape(normal.shape)
        root = propagator.stationary_root(np.zeros(3), rates, self.plan.diffusion[TRANSLATION])
        return _summed(root[None], place.T[None])[0].T, z

    @property
    def _hidden_as(self) -> Array:
        """Weights (6 n,) that define the hidden variables of the hydrodynamic memory, in two rows.

        The variables are combinations of velocities that depend on the step and the trap stiffness.
        """
        rows = [memory.DECAY, memory.SEEN] if "memory" in self.layout else []
        return self.weights.memory[:, rows].ravel()

    def end(self, time: float, sample: Array, state: Array) -> End:
        """Return the end of a run at a time, s, from its sample and its state in `start`.

        The end does not include an unfinished frame of a camera.
        """
        inner = state[self._kept]
        about = {"steps": self.per_sample, "memory": self._hidden_as.tolist()}
        return End.of(time, ",".join(self.columns), (sample, inner), **about)

    def go_on(self, begun: Continued, state: Array) -> None:
        """Fill a state of `start` with that of the end of a run.

        Raises `SceneError` if its variables are others.
        """
        begun.check_module(",".join(self.columns))
        own, then = self._hidden_as, np.array(begun.end.memory)
        if own.shape != then.shape or not np.allclose(own, then, rtol=_SAME, atol=0.0):
            raise SceneError(
                "continue_from: the hidden variables of the fluid's memory belong to the step "
                f"({self.step:.3g} s now) and to the trap stiffness of the run; must be the same "
                "light, forces and simulation.step; or let medium.inertia = 'added-mass' in both "
                "runs"
            )
        state[self._kept] = begun.begin.inner

    @property
    def _kept(self) -> Integers:
        """Columns of a state that the end of a run keeps: a sample, and the fluid's memory."""
        columns = np.arange(self.layout.width)
        names = [*self.shown.blocks, *(["memory"] if "memory" in self.layout else [])]
        return np.concatenate([columns[self.layout.at(name)] for name in names])

    def seen(self, states: Array) -> Array:
        """The samples (n, len(columns)) that states show."""
        return states[:, : self.shown.width]

    def lost(self, states: Array) -> Array:
        """When the beads of states were lost, (n,) s: infinite for those that are not."""
        return states[:, self.layout.first("lost_time")]

    def advance(self, states: Array, trajectories: Integers, sample: int, out: Array) -> None:
        """Take `states`, at times[sample], on to times[sample + out.shape[1]], in place.

        out: (n, s, len(columns)), filled with the samples after `sample`: NaN once a bead is lost.
        Other threads run meanwhile. The same bit for bit however trajectories are put together,
        and times cut. Raises `IntegrationError` if a place is not finite.
        """
        self._advance(states, trajectories, sample, out, self.plan)

    def advance_by_steps(
        self, states: Array, trajectories: Integers, sample: int, out: Array
    ) -> tuple[Array, Array]:
        """Advance as `advance`, and return the times (m + 1,), s, and samples (n, m + 1, ...).

        They contain every step, beginning with times[sample].

        Parameters
        ----------
        states, trajectories, sample, out
            As in `advance`.
        """
        total, first = out.shape[1] * self.per_sample, sample * self.per_sample
        steps = np.empty((len(states), total + 1, self.shown.width))
        steps[:, 0] = self.seen(states)
        self._advance(states, trajectories, first, steps[:, 1:], self.plan._replace(per_sample=1))
        out[:] = steps[:, self.per_sample :: self.per_sample]
        return (first + np.arange(total + 1)) * self.step, steps

    def frames(self, sample: int) -> int:
        """Return the number of camera frames that are complete at times[sample]."""
        return self.exposure.closed(sample * self.per_sample) if self.exposure else 0

    def filmed(self, states: Array, trajectories: Integers, sample: int, out: Array) -> Array:
        """As `advance`, and what the camera sees in the frames that end, (n, frames, axes) m.

        NaN once a bead is lost; no frames without a camera.
        """
        if self.exposure is None:
            self.advance(states, trajectories, sample, out)
            return np.empty((len(states), 0, 0))
        n, held = len(states), self.layout.at("exposure")
        plan = self.plan._replace(per_sample=1)
        seen, total = [], out.shape[1] * self.per_sample
        most = max(1, _STEPS_AT_ONCE // n)
        for done in range(0, total, most):
            steps = np.empty((n, min(most, total - done) + 1, self.shown.width))
            steps[:, 0] = self.seen(states)
            steps[self.lost(states) < np.inf, 0] = np.nan
            first = sample * self.per_sample + done
            self._advance(states, trajectories, first, steps[:, 1:], plan)
            gathered = states[:, held].copy()
            places = np.ascontiguousarray(steps[..., POSITION])
            seen.append(self.exposure.expose(self.seed, trajectories, first, places, gathered))
            states[:, held] = gathered
            samples = np.arange(
                -(-(done + 1) // self.per_sample), 1 + (done + most) // self.per_sample
            )
            samples = samples[samples <= out.shape[1]]
            out[:, samples - 1] = steps[:, samples * self.per_sample - done]
        return np.concatenate(seen, axis=1)

    def _advance(
        self, states: Array, trajectories: Integers, sample: int, out: Array, plan: Plan
    ) -> None:
        force, steps, weights = self._compiled
        before, edge = states.copy(), self.edge._replace(find=crossing.finder_if_compiled())
        rest = self.layout, trajectories, states, sample, out
        failed = march.advance(force, steps, plan, weights, edge, *rest)
        if failed == march.NEAR:
            states[:] = before
            edge = edge._replace(find=crossing.finder())
            failed = march.advance(force, steps, plan, weights, edge, *rest)
        if failed >= 0:
            if fault := fault_of(self.problem.force):
                raise IntegrationError(f"trajectory {trajectories[failed]}: {fault}")
            raise IntegrationError(
                f"trajectory {trajectories[failed]}: the force or the place is not finite after "
                f"{sample * plan.per_sample * plan.step:.6g} s: the step of {self.step:.3g} s is "
                "too long"
            )

    @property
    def force_calls(self) -> int:
        """Places at which a step evaluates the light."""
        return self.scheme.force_calls

    def motion(self, samples: Array) -> Motion:
        """Samples (n, len(columns)) as the quantities they are; angular velocity in the body."""
        parts = {name: samples[:, self.shown.at(name)] for name in self.shown.blocks}
        if "angular_velocity" in parts:
            turned = rotation_matrices(parts["orientation"])
            w = parts["angular_velocity"]
            parts["angular_velocity"] = np.einsum("nji,nj->ni", turned, w)
        velocity, orientation = parts.get("velocity"), parts.get("orientation")
        return Motion(parts["position"], velocity, orientation, parts.get("angular_velocity"))

    @functools.cached_property
    def _compiled(self) -> tuple[Part, march.Steps, Weights]:
        """Constant arguments of the compiled loop."""
        scheme = self.scheme
        steps = march.steps(scheme, self.layout)
        force = bound(self.problem.force, gradient=scheme.gradient)
        return force, steps, self.weights


def walk(scene: Scene | Problem, seed: int = 0, fewest: int = 1) -> Walk:
    """Brownian motion of the bead of `scene`, with numbers of that seed.

    A scene that names no model gets `full`, whose inertia is exact at any step, and for the method
    "auto" exponential Heun. Steps are equal, and divide the time from sample to sample. They are a
    fifth of the fastest time scale of the force at most, at low damping a tenth of a swing, or
    `simulation.step`; with a rotation, no longer than that allows
    (`tweezer.dynamics.brownian.rotation`). Beside a wall it is the overdamped model, and the time
    scale also that of the motion towards the wall where the bead is found
    (`tweezer.dynamics.brownian.wall`). Under another drag that depends on the place it is the
    overdamped model and the method of Euler and Maruyama, and a bead diffuses in a step over a
    twentieth of the length in which the drag changes, at most.

    A scene that leaves `medium.inertia` open gets the memory of the fluid with the model `full`
    where the method takes it.

    fewest: smallest number of steps from sample to sample. Numbers are drawn by the count of steps,
    so a run that goes on with as many steps as before, or more, draws none again.

    Raises `SceneError` if thermal motion is off, the seed is no whole number from 0 to 2^63 - 1,
    or what the scene asks for needs a stable equilibrium and there is none.
    """
    problem = bound_once(scene)
    check_thermal(problem.scene, seed)
    reasons = []
    simulation = problem.scene.simulation
    uniform, wall = problem.drag.uniform, problem.drag
    beside_wall = isinstance(wall, BesideWall)
    follows = [name for name, each in MODELS.items() if not (each.inertia or each.scheme)]
    if beside_wall:
        follows = list(METHODS["heun"].beside_wall)
    if not uniform and simulation.model not in (None, *follows):
        where = "beside a wall" if beside_wall else "under a drag that depends on the position"
        raise SceneError(
            f"simulation.model = {simulation.model!r}: cannot follow thermal motion {where}; must "
            f"be {' or '.join(follows)}; set simulation.model to {follows[0]}"
        )
    if simulation.model is None:
        problem = problem.decided(simulation={"model": "full" if uniform else "overdamped"})
        about = "inertia is exact at any step" if uniform else "the drag depends on the place"
        reasons.append(f"{problem.scene.simulation.model}: {about}")
    if simulation.method == "auto":
        method, about = "heun", "exact drag and noise, weak order 2"
        if beside_wall:
            about = "the gap as the radius of a motion in a plane, weak order 2"
        elif not uniform:
            method, about = "euler-maruyama", "the drag depends on the place"
        problem = problem.decided(simulation={"method": method})
        reasons.append(f"{method}: {about}")
    problem, about = _with_inertia_of_the_fluid(problem)
    if about:
        reasons.append(about)
    scene, bead = problem.scene, problem.bead
    simulation = scene.simulation
    model = MODELS[str(simulation.model)]
    inertial = model.inertia
    dims = 6 if problem.rotates else 3
    tau, mobility = np.zeros(dims), problem.mobility[:dims]
    if isinstance(wall, BesideWall):
        free = wall.stokes
        mobility = np.repeat([1 / free.translation, 1 / free.rotation], 3)[:dims]
    if inertial:
        inertias = np.repeat([problem.effective_mass, bead.moments_of_inertia[0]], 3)[:dims]
        tau = inertias * mobility
        if simulation.model == "scaled" and simulation.scaling_factor:
            tau = tau / simulation.scaling_factor
    how = METHODS[simulation.method]
    _check_goes_together(problem)
    equilibrium = problem.equilibrium
    rates = np.zeros((3, 3))
    if equilibrium is not None:
        there = problem.mobilities(np.array([equilibrium.position]))[0]
        rates = _rates(equilibrium, there if beside_wall else mobility)
    if equilibrium is None:
        for key, value, needing, instead in (
            ("simulation.method", simulation.method, METHODS[simulation.method].spring_only,
             "heun"),
            ("start.drawn", scene.start.drawn, scene.start.drawn in ("equilibrium", "boltzmann"),
             "no"),
        ):  # fmt: skip
            if needing:
                raise SceneError(
                    f"{key} = {value!r}: requires a stable equilibrium, and the scene has none; "
                    f"set {key} to {instead}"
                )
    kappa, centre = np.zeros(dims), np.zeros(dims)
    if equilibrium is not None:
        kappa[TRANSLATION] = np.diag(rates)
        centre[TRANSLATION] = equilibrium.position
    diffusion = Boltzmann * scene.medium.temperature * mobility
    beside = towards(problem) if beside_wall else None
    if beside is not None:
        kappa[2] = beside.spring
    times = np.linspace(0.0, simulation.duration, simulation.samples)
    interval = simulation.duration / (simulation.samples - 1)
    kT = Boltzmann * scene.medium.temperature
    bias = 0.0
    if not (how.displacements or how.spring_only or beside_wall):
        bias = one_call_bias(problem, mobility[TRANSLATION], kT)
    of_velocity = None
    if inertial:
        remembers = scene.medium.inertia == "memory"
        of_velocity = problem.modes if remembers else Modes(tau[:1], np.ones(1))
    longest, reason = _longest_step(problem, tau, kappa, diffusion, beside, bias, of_velocity)
    per_sample = max(fewest, math.ceil(interval / longest * (1 - 1e-12)))
    if per_sample > _MOST_PER_SAMPLE:
        raise SceneError(_too_many_steps(simulation, longest))
    step = interval / per_sample
    reasons.append(f"steps of {step:.3g} s: {reason}")
    # rotational diffusion without inertia is drawn by itself
    drawn_apart = (tau == 0) & (np.arange(dims) >= 3) & (not beside_wall)
    shaken = np.where(drawn_apart, 0.0, diffusion)
    if isinstance(wall, BesideWall):
        shaken[2] /= 2 * wall.radius**2  # in the plane
    linear = Linear(tau, kappa, shaken, problem.relaxation_time, rates)
    if scene.medium.inertia == "memory" and len(problem.modes.times) > 1:
        linear = linear._replace(times=problem.modes.times, parts=problem.modes.weights)
    weights = _scheme(problem).weights(step, linear)
    if not inertial:
        tau = np.full(dims, problem.relaxation_time)
    load = np.zeros(dims)
    load[TRANSLATION] = bead.weight
    lens = -math.inf
    if scene.lens.focal_length is not None:
        lens = scene.bead.radius - scene.lens.focal_length
    kernel, data = problem.drag.compiled()
    resisting = Part(address(kernel, DRAG_KERNEL), data)
    if isinstance(wall, BesideWall):  # the scheme reads the plane's data, and calls no kernel
        resisting = Part(0, plane.data_of(wall, kT))
    plan = Plan(
        seed, step, per_sample, tau, mobility, load, diffusion, centre, kT,
        uniform or beside_wall, resisting,
    )  # fmt: skip
    softest = float(mobility[TRANSLATION].max())
    margin = crossing.way(step, kT, softest, of_velocity, _drift(problem))
    edge = Boundary(
        simulation.loss_distance, lens,
        margin + step * float(np.linalg.norm(scene.start.velocity)),
        2 * kT * step * (share(step, of_velocity) if of_velocity else 1.0), softest, uniform,
        Part(address(kernel, DRAG_KERNEL), data), 0,
    )  # fmt: skip
    exposure = None
    if (frames := Frames.of(scene)) is not None:
        short = diffusion[TRANSLATION]
        if of_velocity is not None:
            short = at_short_times(step, short, of_velocity)
        spring = centre[TRANSLATION] if how.spring_only else None
        exposure = Exposure(
            frames, problem, step, short, mobility[TRANSLATION], np.diag(rates).copy(), spring
        )
    late = 0.0
    if not how.displacements:
        late = _LATE * step * float(np.linalg.eigvals(rates).real.max())
    forget_faults(problem.force)  # where equilibria were sought
    layout = Layout.of_samples(inertial=inertial, rotates=problem.rotates).followed_by(
        exposure=HELD if exposure else 0, memory=3 * weights.memory.shape[2], lost_time=1
    )
    found = Walk(
        problem, seed, "; ".join(reasons), step, per_sample, times, layout, plan, weights, edge,
        exposure, late, bias * step if bias * step > _TOLD else None,
    )  # fmt: skip
    swings = 0.0
    if inertial and not beside_wall:
        swings = math.sqrt(float(tau[0] * kappa[TRANSLATION].max()))
    if swings > _MANY_SWINGS and simulation.method == "heun" and problem.force.steady:
        found = dataclasses.replace(found, variance_bias=-energy_loss(found, linear))
    return found


def _check_goes_together(problem: Problem) -> None:
    """Raise `SceneError` for a model, a method and a body that do not go together.

    Each message ends with one change that mends what it names.
    """
    simulation, wall = problem.scene.simulation, isinstance(problem.drag, BesideWall)
    model, how = MODELS[str(simulation.model)], METHODS[simulation.method]
    by_method = f"simulation.method = {how.name!r}: "
    by_model = f"simulation.model = {model.name!r}: "
    if how.spring_only and not problem.force.steady:
        raise SceneError(
            f"{by_method}follows a trap at rest, but a force or a beam changes in time; set "
            "simulation.method to heun"
        )
    if wall and model.name not in how.beside_wall:
        allowed = [each.name for each in methods(thermal=True) if model.name in each.beside_wall]
        raise SceneError(
            f"{by_method}cannot keep a bead on its side of a wall in the model {model.name}; must "
            f"be {' or '.join(allowed)}; set simulation.method to {allowed[0]}"
        )
    if wall and model.inertia and problem.rotates:
        raise SceneError(
            f"{by_model}cannot follow thermal rotation beside a wall; set simulation.model to "
            "overdamped"
        )
    if not (problem.drag.uniform or wall) and how.uniform_drag:
        allowed = [each.name for each in methods(thermal=True) if not each.uniform_drag]
        raise SceneError(
            f"{by_method}requires a drag that is the same everywhere; must be "
            f"{' or '.join(allowed)}; set simulation.method to {allowed[0]}"
        )
    if not (problem.drag.uniform or wall) and problem.rotates:
        raise SceneError(
            "forces.brownian = True: thermal rotation requires a drag that is the same everywhere; "
            "set forces.brownian to false"
        )
    if problem.force.oriented and how.spring_only:
        raise SceneError(
            f"{by_method}follows no force that turns the bead; set simulation.method to heun"
        )
    if problem.force.oriented and model.scheme:
        raise SceneError(
            f"{by_model}follows no force that turns the bead; set simulation.model to full"
        )


def _too_many_steps(simulation: Simulation, longest: float) -> str:
    """Return the message for a run of too many steps from sample to sample."""
    interval = simulation.duration / (simulation.samples - 1)
    told = (
        f"simulation.samples = {simulation.samples}: is {interval / longest:.2g} steps of "
        f"{longest:.2g} s from sample to sample; must be at most {_MOST_PER_SAMPLE:.0g}; set "
    )
    needed = math.ceil(1.01 * simulation.duration / (longest * _MOST_PER_SAMPLE)) + 1
    if needed <= MOST_SAMPLES:
        return f"{told}simulation.samples to {needed}"
    short = 0.99 * (simulation.samples - 1) * longest * _MOST_PER_SAMPLE
    return f"{told}simulation.duration to {short:.2g}"


def _with_inertia_of_the_fluid(problem: Problem) -> tuple[Problem, str]:
    """A problem of a decided model and method with what it has of the fluid's inertia, and why.

    Raises `SceneError` if the scene names a memory that cannot be followed.
    """
    medium, simulation = problem.scene.medium, problem.scene.simulation
    if medium.inertia in ("none", "added-mass"):
        return problem, ""
    missing = ""
    if not _scheme(problem).memory or not MODELS[str(simulation.model)].inertia:
        missing = f"the model {simulation.model} by {simulation.method} cannot follow it"
    elif not (problem.drag.uniform and np.ptp(problem.mobility[TRANSLATION]) == 0):
        missing = "the drag depends on the position or the direction"
    elif (
        METHODS[simulation.method].spring_only
        and problem.equilibrium is not None
        and not _diagonal(_rates(problem.equilibrium, problem.mobility))
    ):
        missing = f"{simulation.method} cannot follow it in a trap that couples the axes"
    if medium.inertia == "memory":
        if missing:
            raise SceneError(without_memory(missing))
    elif simulation.model != "full":
        missing = missing or f"with the model {simulation.model} only where it is named"
    if missing:
        if medium.poles is not None:
            raise SceneError(poles_without_memory(medium.poles, missing))
        return problem.decided(medium={"inertia": "none"}), f"no inertia of the fluid: {missing}"
    problem = problem.remembering(medium.poles or POLES)
    return problem, f"the fluid remembers, by {problem.scene.medium.poles} poles"


def _summed(matrices: Array, columns: Array) -> Array:
    """Products of matrices (k, i, j) and columns (k, j, n): the same bits for whatever n."""
    made = np.zeros((*matrices.shape[:2], columns.shape[2]))
    for j in range(columns.shape[1]):
        made += matrices[:, :, j, None] * columns[:, None, j]
    return made


def _diagonal(rates: Array) -> bool:
    return np.array_equal(rates, np.diag(np.diag(rates)))


def _rates(equilibrium: Equilibrium, mobility: Array) -> Array:
    """Mobility times stiffness, (3, 3) 1/s; entries that are rounding are zero."""
    stiffness = np.array(equilibrium.stiffness)
    stiffness[np.abs(stiffness) < _ROUNDING * np.abs(stiffness).max()] = 0.0
    return mobility[TRANSLATION, None] * stiffness


def _scheme(problem: Problem) -> Scheme:
    simulation = problem.scene.simulation
    model, method = MODELS[str(simulation.model)], METHODS[simulation.method]
    place = model.scheme or method.place
    if isinstance(problem.drag, BesideWall):
        place = method.beside_wall.get(model.name, place)
    scheme: Scheme = at(place)
    return scheme


def _longest_step(
    problem: Problem, tau: Array, kappa: Array, diffusion: Array, beside: Towards | None,
    bias: float, of_velocity: Modes | None,
) -> tuple[float, str]:  # fmt: skip
    """Return the longest step that suits the scene, s, and what limits it.

    bias: of the variance over the step, 1/s. of_velocity: modes of a bead with inertia.
    """
    simulation = problem.scene.simulation
    limits = [(math.inf, "from sample to sample")]
    if len(tau) == 6:
        part = LONGEST if tau[0] == 0 and beside is None else LONGEST_WITH_INERTIA
        limits.append((part / diffusion[3], f"{part:g} of the time of rotational diffusion"))
    if (camera := problem.scene.camera) is not None:
        if (rate := float(np.abs(kappa).max())) > 0:
            limits.append((_PART / rate, f"{_PART:g} of the time of the trap, for the camera"))
        if of_velocity is not None:
            limits.append((longest_step(camera, of_velocity, _BIAS), "for inertia in the frames"))
    fastest = float(diffusion[TRANSLATION].max())
    way = (_PART_OF_LOSS * simulation.loss_distance) ** 2 / (2 * fastest)
    limits.append((way, f"diffusion over {_PART_OF_LOSS:g} of simulation.loss_distance"))
    if METHODS[simulation.method].spring_only and _reaches_loss(problem, kappa, diffusion):
        some = f"{_PART:g} of the time of the trap, for the times of loss"
        limits.append((_PART / float(kappa[TRANSLATION].max()), some))
    if simulation.step is not None:
        return min(*limits, (simulation.step, "simulation.step"))
    # not the largest: next to its surface at the focus a bead's force has an infinite derivative
    about = rates_of_force(problem if beside is None else without_walls(problem))
    rate = max(float(np.quantile(about, _MOST)), float(np.abs(kappa).max()))
    if rate > 0 and not METHODS[simulation.method].spring_only:
        decay = _PART / rate, f"{_PART:g} of the fastest time scale of the force"
        swing = (
            _PART_OF_SWING * math.sqrt(tau[0] / rate),
            f"{_PART_OF_SWING:g} of the time of a swing",
        )
        limits.append(max(decay, swing))  # at low damping the force acts as fast as a bead swings
    if bias > 0:
        some = f"{100 * _BIAS:g} % of the variance, as the force is not a gradient"
        limits.append((_BIAS / bias, some))
    if beside is not None:
        part = _PART
        if tau[0] > 0:
            flies = tau[0] * beside.fastest > _FLIES
            part = _PART_OF_FLIGHT if flies else _PART_WITH_INERTIA
        some = f"{part:g} of the time scale of the motion towards the wall"
        limits.append((part / beside.fastest, some))
        if not problem.force.steady and (rate := rate_of_sticking(problem)) > 0:
            limits.append((_PART / rate, f"{_PART:g} of the time scale of a bead that sticks"))
    elif (rate := _rate_of_drag(problem)) > 0:
        some = f"diffusion over {_PART_OF_LENGTH:g} of "
        limits.append((_PART_OF_LENGTH**2 / rate, some + "the length in which the drag changes"))
    if shortest := problem.force.shortest_time(simulation.duration):
        limits.append((_PART_OF_CHANGE * shortest, f"{_PART_OF_CHANGE:g} of the time in which the "
                       "force changes"))  # fmt: skip
    if tau[0] > 0 and _scheme(problem).resolves_drag:
        limits.append((_PART_OF_TAU * tau.min(), f"{_PART_OF_TAU:g} of the relaxation time"))
    return min(limits)


def _drift(problem: Problem) -> float:
    """Return the largest slow velocity at places about the foci and at the start, m/s."""
    pushed = problem.scene.lit or any(problem.bead.weight) or problem.beside_the_light
    return problem.fastest if pushed else 0.0


def _reaches_loss(problem: Problem, kappa: Array, diffusion: Array) -> bool:
    """Return whether a bead in the spring of the trap comes to where it is lost."""
    scene, trap = problem.scene, problem.equilibrium
    assert trap is not None  # a method that follows the spring alone refuses a scene without one
    spread = math.sqrt(float((diffusion[TRANSLATION] / kappa[TRANSLATION]).max()))
    places = np.array([trap.position, scene.start_position])
    left = scene.simulation.loss_distance - np.linalg.norm(places, axis=1).max()
    return bool(left < _FARTHEST * spread)


def _rate_of_drag(problem: Problem) -> float:
    """Largest 2 D |grad b|^2/b^2 on lines from the trap to places about it, 1/s; D = kT b."""
    if problem.drag.uniform:
        return 0.0
    middle = problem.scene.start_position
    if problem.equilibrium is not None:
        middle = tuple(problem.equilibrium.position.tolist())
    lines = problem.places_about() - np.array(middle)
    places = np.array(middle) + np.linspace(0, 1, _ON_A_LINE)[:, None, None] * lines
    value, gradient = problem.drag.mobilities(places.reshape(-1, 3), gradient=True)
    b, change = value[:, :2], np.linalg.norm(gradient[:, :2], axis=2)
    there = (b > 0).all(axis=1)  # behind a wall there is no mobility
    kT = Boltzmann * problem.scene.medium.temperature
    return float((2 * kT * change[there] ** 2 / b[there]).max(initial=0.0))


def rotation_matrices(e: Array) -> Array:
    """R (A.2) of orientations (n, 4) of length 1, (n, 3, 3): body to inertial axes."""
    from scipy.spatial.transform import Rotation

    return Rotation.from_quat(e, scalar_first=True).as_matrix()
