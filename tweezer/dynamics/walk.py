"""Brownian motion of a scene's bead: the scheme and its step, bound once, and beads taken along."""

from __future__ import annotations

import dataclasses
import functools
import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tweezer.dynamics.beside_wall import held
from tweezer.dynamics.body import BodyMotion
from tweezer.dynamics.brownian import (
    crossing,
    feedback,
    laser,
    lock_in,
    march,
    memory,
    noise,
    propagator,
)
from tweezer.dynamics.brownian.batch import Linear, Plan, Scheme
from tweezer.dynamics.brownian.crossing import Boundary, share
from tweezer.dynamics.brownian.exposure import HELD
from tweezer.dynamics.brownian.propagator import Weights
from tweezer.dynamics.camera import Exposure, Frames, at_short_times
from tweezer.dynamics.continuing import Continued, End
from tweezer.dynamics.layout import FEEDBACK, POSITION, ROTATION, TRANSLATION, Layout
from tweezer.dynamics.mirror import in_mirror
from tweezer.dynamics.models import Motion
from tweezer.dynamics.needs import Facts, is_diagonal, rates_of
from tweezer.dynamics.problem import Problem, bound_once
from tweezer.dynamics.step_bias import energy_loss
from tweezer.dynamics.thermal import Linearised, decide, steps_of
from tweezer.forces.data import Part
from tweezer.forces.equilibria import Equilibrium
from tweezer.forces.force import Force, bound
from tweezer.forces.own import fault_of, forget_faults
from tweezer.scene import Scene
from tweezer.scene.arguments import check_thermal
from tweezer.values.arrays import Array
from tweezer.values.errors import IntegrationError, SceneError, warn

Integers = NDArray[np.int64]

#: Relative difference of hidden variables that rounding may cause
_SAME = 1e-6
#: Error of the variance by the step above which a warning is given, and the smallest reported one
_WARNED, _TOLD = 0.01, 1e-5
#: Relative delay of losses with one force call per step, divided by the step in relaxation times
#: and by the depth in k_B T, as measured on springs. The second is the smallest reported delay
_LATE, _TOLD_LATE = 0.25, 1e-3
#: Number of oscillations in the relaxation time above which the energy loss by steps is measured
_MANY_SWINGS = 100.0
#: Normal numbers of a release without those of the memory, which follow
_DRAWN = Layout({"position": 3, "velocity": 3, "angular_velocity": 3})
#: Blocks of a state, besides a sample, that are kept for a continued run
_HIDDEN = ("memory", "laser", "control")
#: Blocks of a state that are 0 at the release
_AT_REST = ("in_phase", "quadrature", *FEEDBACK)
#: Steps of all beads that are stored for a camera in one pass
_STEPS_AT_ONCE = 2**17


@dataclass(frozen=True)
class Walk:
    """Brownian motion of a scene's bead with fixed steps, ready to run.

    Each random number is a function of the seed, the index of the trajectory and the index of the
    step, so a trajectory does not depend on how many others are computed or in which order.
    """

    problem: Problem
    """with its model and method decided"""
    seed: int
    why: str
    """reasons for the choice of model, method and step"""
    step: float
    """length of a step, s"""
    per_sample: int
    """number of steps between samples"""
    times: Array
    """(samples,) times of the samples, s"""
    layout: Layout
    """layout of a state: the quantities of a sample, with the angular velocity about the inertial
    axes; integrals of a camera's exposure; hidden variables of the hydrodynamic memory; time of
    loss, s
    """
    plan: Plan
    weights: Weights
    edge: Boundary
    """boundary at which a bead is lost"""
    exposure: Exposure | None = None
    """exposure of the scene's camera; None without a camera"""
    late_losses: float = 0.0
    """approximate relative delay of the times of loss due to the step, for each k_B T
    of well depth
    """
    variance_bias: float | None = None
    """approximate relative error of the position's variance due to the step; None if it is small"""

    @property
    def others(self) -> tuple[Force, ...]:
        """Forces of the user."""
        return self.problem.others

    @property
    def origin(self) -> tuple[float, ...]:
        """Equilibrium of the bead, or its position at the start without one, m."""
        if self.equilibrium:
            return tuple(self.plan.centre[TRANSLATION])
        return self.scene.start_position

    @property
    def reach(self) -> float:
        """Distance from the focus at which a bead is lost, m."""
        return self.scene.simulation.loss_distance

    @property
    def coefficients(self) -> tuple[Any, ...]:
        """Numbers from which the steps are computed, without addresses of this process."""
        (*plan, drag, laser, lock_in, control), (*edge, _, _) = self.plan, self.edge
        return (*plan, laser, lock_in, control, drag.data.numbers, *edge, *self.weights)

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
        return Facts(self.problem).scheme

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
        """Warn if the step changes the variance of the position by more than one percent."""
        bias = self.variance_bias or 0.0
        if abs(bias) > _WARNED:
            size, part = "large", _WARNED / abs(bias)
            if bias < 0:  # r/(r + 1/tau) of a loss r of order 3 in the step
                size, part = "small", (_WARNED / (1 - _WARNED) * (1 + bias) / -bias) ** (1 / 3)
            warn(
                f"{self.scene.name}: with steps of {self.step:.3g} s the variance of the position "
                f"is about {100 * abs(bias):.2g} % too {size}; simulation.step of "
                f"{part * self.step:.1g} s or less reduces the error to 1 %"
            )

    @property
    def scene(self) -> Scene:
        """Scene, with its model and method decided."""
        return self.problem.scene

    @property
    def equilibrium(self) -> Equilibrium | None:
        """Stable equilibrium nearest the focus, or None."""
        return self.problem.equilibrium

    def start(self, trajectories: Integers) -> Array:
        """Return the states (n, layout.width) at times[0] of the trajectories with these indices.

        The time of loss is infinite for a bead that is not lost.
        """
        start, plan, n = self.scene.start, self.plan, len(trajectories)
        if self.problem.body is not None and start.drawn in ("equilibrium", "boltzmann"):
            return self._at_rest(
                self.problem.body, trajectories, thermal=start.drawn == "boltzmann"
            )
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
        elif thermal and self.equilibrium is not None and self.problem.drag.walls is not None:
            x += held(self.problem, self.problem.drag.walls, plan.kT, drawn)
        elif thermal and self.equilibrium is not None:
            tau = plan.tau[TRANSLATION] if "velocity" in self.layout else np.zeros(3)
            rates = rates_of(self.equilibrium, plan.mobility)
            root = propagator.stationary_root(tau, rates, plan.diffusion[TRANSLATION])
            apart = drawn[:, : len(root)] @ root.T
            x += apart[:, _DRAWN.at("position")]
            v = apart[:, _DRAWN.at("velocity")]
        parts |= {"position": x, "velocity": v, "exposure": np.zeros((n, HELD))}
        parts |= {"laser": np.zeros((n, laser.NUMBERS)), "lost_time": np.full((n, 1), np.inf)}
        parts |= {name: np.zeros((n, 3)) for name in self.layout.blocks if name in _AT_REST}
        parts |= {"control": np.zeros((n, self.layout.blocks.get("control", 0)))}
        if "orientation" in self.layout:
            e = self.problem.orientation
            w = rotation_matrices(e[None])[0] @ start.angular_velocity
            parts |= {"orientation": np.tile(e, (n, 1)), "angular_velocity": np.tile(w, (n, 1))}
            if thermal and "angular_velocity" in self.layout:
                turning = drawn[:, _DRAWN.at("angular_velocity")]
                parts["angular_velocity"] = turning * speed[ROTATION]
        return np.ascontiguousarray(np.hstack([parts[name] for name in self.layout.blocks]))

    def _at_rest(self, body: BodyMotion, trajectories: Integers, *, thermal: bool) -> Array:
        """Return states (n, layout.width) of a body that is no sphere at its equilibrium pose.

        If `thermal`, poses are in the stationary distribution about it (`PoseSearch.drawn`), and
        the twists V have the covariance kT M^-1. Otherwise the body has the initial velocities of
        the scene.
        """
        from tweezer.dynamics import poses  # spheres do without

        start, pose, n = self.scene.start, self.problem.pose, len(trajectories)
        assert pose is not None  # a scene without one is refused
        x, e = np.tile(pose.position, (n, 1)), np.tile(pose.orientation, (n, 1))
        twists = np.zeros((n, 6))
        twists[:, ROTATION] = start.angular_velocity
        if thermal:
            drawn = Layout({"twist": twists.shape[1], "pose": poses.DRAWN.width})
            normals = np.empty((drawn.width, n))
            noise.normals(self.seed, trajectories, 0, noise.START, normals)
            twists = math.sqrt(self.plan.kT) * normals[drawn.at("twist")].T @ body.velocities.T
            x, e = self.problem.poses.drawn(pose, self.plan.kT, normals[drawn.at("pose")].T)
        turned = rotation_matrices(e)
        v, w = (
            np.einsum("nij,nj->ni", turned, twists[:, part]) for part in (TRANSLATION, ROTATION)
        )
        parts = {
            "position": x, "velocity": v if thermal else v + start.velocity, "orientation": e,
            "angular_velocity": w, "exposure": np.zeros((n, HELD)),
            "lost_time": np.full((n, 1), np.inf),
        }  # fmt: skip
        return np.ascontiguousarray(np.hstack([parts[name] for name in self.layout.blocks]))

    def _memory(self, drawn: Array, v: Array, *, thermal: bool) -> tuple[Array, Array]:
        """Return initial displacements (n, 3), m, and hidden variables (3, k, n) in equilibrium.

        `drawn` (n, 9 + hidden) contains standard normal random numbers, with one row for each bead.
        The hidden variables reproduce the initial velocities `v` (n, 3), m/s. If `thermal`,
        velocities are drawn and `v` is ignored.
        """
        of_step, n = self.weights.memory, len(drawn)
        place, hidden = drawn[:, _DRAWN.at("position")], drawn[:, _DRAWN.width :]
        normal = hidden.T.reshape(3, -1, n)
        z = _summed(of_step[:, memory.ROOT :], normal)
        if not thermal and "velocity" not in self.layout:
            return np.zeros((n, 3)), z
        if not thermal:
            # given the velocity: in a fluid at rest on average, of a bead struck to it
            seen = of_step[:, memory.SEEN]
            short = v.T[:, None] - _summed(seen[:, None], z)
            share = seen / (seen**2).sum(axis=1, keepdims=True)
            return np.zeros((n, 3)), z + share[..., None] * short
        if self.equilibrium is None:
            return np.zeros((n, 3)), z
        rates = rates_of(self.equilibrium, self.plan.mobility)
        if self.weights.kappa.any() and not is_diagonal(rates):
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
        """Overwrite a state of `start` with the state at the end of the run that is continued.

        Raises `SceneError` if the hidden variables of the fluid's memory are defined differently.
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
        if len(begun.begin.inner) != len(self._kept):
            raise SceneError("continue_from: beam.noise and feedback must be the same in both runs")
        state[self._kept] = begun.begin.inner

    @property
    def _kept(self) -> Integers:
        """Columns of a state that are kept for a continued run: the sample and the hidden
        variables.
        """
        columns = np.arange(self.layout.width)
        names = [*self.shown.blocks, *(each for each in _HIDDEN if each in self.layout)]
        return np.concatenate([columns[self.layout.at(name)] for name in names])

    def seen(self, states: Array) -> Array:
        """Return the samples (n, len(columns)) contained in states."""
        return states[:, : self.shown.width]

    def lost(self, states: Array) -> Array:
        """Return the times at which the beads of states were lost, (n,) s; infinite for
        the others.
        """
        return states[:, self.layout.first("lost_time")]

    def advance(self, states: Array, trajectories: Integers, sample: int, out: Array) -> None:
        """Advance states over some samples, in place.

        Other threads can run meanwhile. Results do not depend, to the last bit, on how trajectories
        are grouped and times divided.

        Parameters
        ----------
        states : ndarray, shape (n, state)
            States at times[sample], which become those at times[sample + out.shape[1]].
        trajectories : ndarray of int, shape (n,)
            Numbers of the trajectories.
        sample : int
            Index of the sample that `states` belongs to.
        out : ndarray, shape (n, s, len(columns))
            Array to fill with the samples after `sample`; NaN once a bead is lost.

        Raises
        ------
        IntegrationError
            If a position is not finite.
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
        """Advance as `advance`; return the positions that the camera records, (n, frames, axes) m.

        They are the positions in the frames that end meanwhile; NaN once a bead is lost. Without a
        camera there are no frames.

        Parameters
        ----------
        states : ndarray, shape (n, state)
            States at times[sample], advanced in place.
        trajectories : ndarray of int, shape (n,)
            Numbers of the trajectories.
        sample : int
            Index of the sample that `states` belongs to.
        out : ndarray, shape (n, s, len(columns))
            Array to fill with the samples after `sample`.
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
        """Advance `states` from a sample by the steps of `plan`, in place; see `advance`.

        The code that detects losses is compiled when a bead first comes near the boundary: the loop
        then reports `NEAR`, and the advance is repeated from a copy of the states.
        """
        force, steps = self._compiled
        before, edge = states.copy(), self.edge._replace(find=crossing.finder_if_compiled())
        rest = self.layout, trajectories, states, sample, out
        failed = march.advance(force, steps, plan, self.weights, edge, *rest)
        if failed == march.NEAR:
            states[:] = before
            edge = edge._replace(find=crossing.finder())
            failed = march.advance(force, steps, plan, self.weights, edge, *rest)
        if failed >= 0:
            if fault := fault_of(self.problem.force):
                raise IntegrationError(f"trajectory {trajectories[failed]}: {fault}")
            raise IntegrationError(
                f"trajectory {trajectories[failed]}: the force or the position is not finite after "
                f"{sample * plan.per_sample * plan.step:.6g} s: the step of {self.step:.3g} s is "
                "too long"
            )

    def before_mirror(self, samples: Array) -> Integers:
        """Return the numbers of samples (n, s, columns) before beads reach the mirror, (n,)."""
        reached = in_mirror(self.scene, samples[..., POSITION][..., 2])
        return np.where(reached.any(axis=1), reached.argmax(axis=1), reached.shape[1])

    def motion(self, samples: Array) -> Motion:
        """Return samples (n, len(columns)) as named quantities, with the angular velocity in the
        body frame.
        """
        parts = {name: samples[:, self.shown.at(name)] for name in self.shown.blocks}
        if "angular_velocity" in parts:
            turned = rotation_matrices(parts["orientation"])
            w = parts["angular_velocity"]
            parts["angular_velocity"] = np.einsum("nji,nj->ni", turned, w)
        _, *names = (each.name for each in dataclasses.fields(Motion))
        return Motion(parts["position"], *map(parts.get, names))

    @functools.cached_property
    def _compiled(self) -> tuple[Part, march.Steps]:
        """Force and steps as arguments of the compiled loop."""
        scheme = self.scheme
        force = bound(self.problem.force, gradient=scheme.gradient)
        return force, march.steps(scheme, self.layout, self.scene.feedback)


def walk(scene: Scene | Problem, seed: int = 0, fewest: int = 1) -> Walk:
    """Return the Brownian motion of the bead of `scene`, with the random numbers of a seed.

    A scene that names no model gets `full`, whose inertia is exact at any step, and the method
    "auto" becomes exponential Heun. Steps are equal and divide the time between samples. They are
    at most a fifth of the fastest time scale of the force, or a tenth of an oscillation period at
    low damping, or `simulation.step`. Rotation may require shorter ones
    (`tweezer.dynamics.brownian.rotation`). Beside a wall the model is overdamped, and the motion
    towards the wall near the bead is another time scale (`tweezer.dynamics.brownian.wall`). If the
    drag depends on the position for another reason, the model is overdamped and the method is
    Euler-Maruyama. In a step a bead then diffuses over at most a twentieth of the length in which
    the drag changes.

    A scene that leaves `medium.inertia` open gets the memory of the fluid with the model `full`, if
    the method can follow it.

    `fewest` is the smallest number of steps between samples. Random numbers are selected by the
    number of the step, so a continued run with at least as many steps as before repeats none.

    Raises `SceneError` if thermal motion is off or the seed is no whole number from 0 to 2^63 - 1.
    It is also raised if the scene requires a stable equilibrium that does not exist.
    """
    problem = bound_once(scene)
    check_thermal(problem.scene, seed)
    problem, reasons = decide(problem)
    linear = Linearised.of(problem)
    step, per_sample, reason = steps_of(problem, linear, fewest)
    if linear.recoil is not None:
        reasons.append(linear.recoil.words)
    simulation, scheme = problem.scene.simulation, Facts(problem).scheme
    taken = _taken_exactly(problem, linear)
    weights = scheme.weights(step, taken)
    late = 0.0
    if not linear.method.displacements:
        late = _LATE * step * float(np.linalg.eigvals(linear.rates).real.max())
    bias = linear.bias * step
    exposure = _exposure(problem, linear, step)
    plan = _plan(problem, linear, scheme, seed, step, per_sample)
    layout = Layout.of_samples(
        inertial=linear.inertial, rotates=problem.rotates,
        lock_in=problem.scene.lock_in is not None,
        feedback="" if problem.scene.feedback is None else problem.scene.feedback.output,
    ).followed_by(
        exposure=HELD if exposure else 0, memory=3 * weights.memory.shape[2],
        laser=laser.NUMBERS if problem.scene.beam.noise else 0,
        control=feedback.width_of(plan.feedback), lost_time=1,
    )  # fmt: skip
    found = Walk(
        problem, seed, "; ".join([*reasons, reason]), step, per_sample,
        np.linspace(0.0, simulation.duration, simulation.samples), layout,
        plan, weights,
        _boundary(problem, linear, step), exposure, late, bias if bias > _TOLD else None,
    )  # fmt: skip
    forget_faults(problem.force)  # where equilibria were sought
    if _loses_energy(problem, linear):
        found = dataclasses.replace(found, variance_bias=-energy_loss(found, taken))
    return found


def _taken_exactly(problem: Problem, linear: Linearised) -> Linear:
    """Return the linear part of the equations, which a scheme may integrate exactly.

    Across a wall the diffusion is in the plane whose radius gives the gap.
    """
    shaken = linear.diffusion.copy()
    if problem.body is not None:  # of its six modes of velocity
        shaken = linear.kT * linear.tau
    elif problem.drag.walls is not None:
        shaken[2] /= 2 * problem.drag.walls.radius**2  # in the plane
    elif not linear.inertial:
        shaken[ROTATION] = 0.0  # rotational diffusion without inertia is drawn by itself
    times = parts = np.zeros(0)
    if linear.modes is not None and len(linear.modes.times) > 1:
        times, parts = linear.modes
    return Linear(
        linear.tau, linear.kappa, shaken, problem.relaxation_time, linear.rates, times, parts,
        problem.network,
    )  # fmt: skip


def _plan(
    problem: Problem, linear: Linearised, scheme: Scheme, seed: int, step: float, per_sample: int
) -> Plan:
    """Return the step, drag and noise of the beads."""
    dims, walls = len(linear.tau), problem.drag.walls
    tau = linear.tau if linear.inertial else np.full(dims, problem.relaxation_time)
    load = np.zeros(dims)
    load[TRANSLATION] = problem.bead.weight
    resisting = problem.drag.part
    if problem.body is not None and scheme.body is not None:
        resisting = Part(0, scheme.body(problem.body, linear.kT, step))
    if walls is not None and scheme.data is not None:  # its step reads them, and calls no kernel
        resisting = Part(0, scheme.data(walls, linear.kT))
    return Plan(
        seed, step, per_sample, tau, linear.mobility, load, linear.diffusion, linear.centre,
        linear.kT, problem.drag.uniform or walls is not None, resisting,
        _noise_of_laser(problem, linear, step), _lock_in(problem, step),
        _feedback(problem, step),
    )  # fmt: skip


def _lock_in(problem: Problem, step: float) -> Array:
    """Return the data of the lock-in, (0,) without one."""
    amplifier = problem.scene.lock_in
    return np.zeros(0) if amplifier is None else lock_in.data_of(amplifier, step)


def _feedback(problem: Problem, step: float) -> Array:
    """Return the data of the controller, (0,) without one."""
    controller = problem.scene.feedback
    if controller is None:
        return np.zeros(0)
    return feedback.data_of(controller, step, problem.effective_mass)


def _noise_of_laser(problem: Problem, linear: Linearised, step: float) -> Array:
    """Return the data of the noise of the laser, (0,) without it."""
    noise, trap = problem.scene.beam.noise, problem.equilibrium
    if noise is None:
        return np.zeros(0)
    stiffness = np.zeros((3, 3)) if trap is None else trap.stiffness
    return laser.data_of(noise, step, stiffness, float(linear.tau[0] / linear.mobility[0]))


def _boundary(problem: Problem, linear: Linearised, step: float) -> Boundary:
    """Return the boundary at which a bead is lost, and the longest displacement in a step."""
    scene, modes = problem.scene, linear.modes
    lens = -math.inf
    if scene.lens.focal_length is not None:
        lens = scene.body.support() - scene.lens.focal_length
    softest = float(linear.mobility[TRANSLATION].max())
    pushed = scene.lit or any(problem.bead.weight) or problem.beside_the_light
    drift = problem.fastest if pushed else 0.0
    margin = crossing.way(step, linear.kT, softest, modes, drift)
    return Boundary(
        scene.simulation.loss_distance, lens,
        margin + step * float(np.linalg.norm(scene.start.velocity)),
        2 * linear.kT * step * (share(step, modes) if modes else 1.0), softest,
        problem.drag.uniform, problem.drag.part, 0,
    )  # fmt: skip


def _exposure(problem: Problem, linear: Linearised, step: float) -> Exposure | None:
    """Return the exposure of the scene's camera; None without one."""
    if (frames := Frames.of(problem.scene)) is None:
        return None
    mobility = linear.mobility[TRANSLATION]
    if problem.body is not None:  # its mean over all orientations
        mobility = problem.mobility[TRANSLATION]
    short = linear.kT * mobility
    if linear.modes is not None:
        short = at_short_times(step, short, linear.modes)
    spring = linear.centre[TRANSLATION] if linear.method.spring_only else None
    return Exposure(
        frames, problem, step, short, mobility, np.diag(linear.rates).copy(),
        spring,
    )  # fmt: skip


def _loses_energy(problem: Problem, linear: Linearised) -> bool:
    """Return whether a bead oscillates so many times that the steps may remove
    noticeable energy.
    """
    others = problem.body is not None or problem.network is not None
    if not linear.inertial or linear.towards is not None or others:
        return False
    swings = math.sqrt(float(linear.tau[0] * linear.kappa[TRANSLATION].max()))
    return swings > _MANY_SWINGS and linear.method.name == "heun" and problem.force.steady


def _summed(matrices: Array, columns: Array) -> Array:
    """Return products (k, i, n) of matrices (k, i, j) and columns (k, j, n).

    The sum is written out, because the rounding of a matrix product could depend on n.
    """
    made = np.zeros((*matrices.shape[:2], columns.shape[2]))
    for j in range(columns.shape[1]):
        made += matrices[:, :, j, None] * columns[:, None, j]
    return made


def rotation_matrices(e: Array) -> Array:
    """Return the rotation matrices R (A.2), from body to inertial axes, (n, 3, 3).

    e: (n, 4) Euler parameters of length 1.
    """
    from scipy.spatial.transform import Rotation

    return Rotation.from_quat(e, scalar_first=True).as_matrix()
