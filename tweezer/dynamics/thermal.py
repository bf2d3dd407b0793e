"""Model, method and step of thermal motion, decided before a run."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from tweezer.dynamics import thermal_body
from tweezer.dynamics.beside_wall import Towards, rate_of_sticking, towards, without_walls
from tweezer.dynamics.brownian import lock_in
from tweezer.dynamics.brownian.rotation import LONGEST, LONGEST_WITH_INERTIA
from tweezer.dynamics.camera import longest_step
from tweezer.dynamics.choose import rates_of_force
from tweezer.dynamics.layout import ROTATION, TRANSLATION
from tweezer.dynamics.needs import (
    NEEDS,
    OF_MODEL,
    Facts,
    check,
    choice,
    rates_of,
    with_inertia_of_the_fluid,
)
from tweezer.dynamics.problem import Problem
from tweezer.dynamics.shot_noise import Recoil, recoil_at
from tweezer.dynamics.step_bias import one_call_bias
from tweezer.fluid import Modes
from tweezer.scene.choices import METHODS, MODELS, POLES, Method
from tweezer.scene.sections import MOST_SAMPLES, Simulation
from tweezer.values.arrays import Array
from tweezer.values.constants import Boltzmann
from tweezer.values.errors import SceneError

#: Step over the fastest time scale of the force
_PART = 0.2
#: Largest error of the variance by the step, where the step follows it
_BIAS = 0.005
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
#: Upper bound on the steps of a sample interval
_MOST_PER_SAMPLE = 10**6


def decide(problem: Problem) -> tuple[Problem, list[str]]:
    """Return a problem with a model, a method and fluid inertia, and the reasons for them.

    Raises `SceneError` for a combination that is not possible (`tweezer.dynamics.needs`).
    """
    simulation, reasons = problem.scene.simulation, []
    if simulation.model is None:
        problem, why = choice(problem, "model")
        reasons.append(why)
    check(problem, OF_MODEL)
    if simulation.method == "auto":
        problem, why = choice(problem, "method")
        reasons.append(why)
    if problem.scene.medium.inertia in (None, "memory"):
        problem, why = with_inertia_of_the_fluid(problem, _memory)
        reasons.append(why)
    check(problem, NEEDS)
    return problem, reasons


def _memory(problem: Problem) -> tuple[int, str]:
    """Return the number of poles of the fluid's memory, and the reason."""
    poles = problem.scene.medium.poles or POLES
    return poles, f"the fluid remembers, by {poles} poles"


@dataclass(frozen=True)
class Linearised:
    """Linear motion of each coordinate of a decided problem; `dims` is 3, and 6 with a rotation."""

    method: Method
    kT: float
    """thermal energy, J"""
    tau: Array
    """(dims,) s, relaxation times of the velocity; 0 without inertia"""
    mobility: Array
    """(dims,) s/kg and 1/(N m s), at the start; beside a wall the one far from it"""
    diffusion: Array
    """(dims,) kT times mobility, with the recoil of the light, m^2/s and rad^2/s"""
    centre: Array
    """(dims,) m, position of the stable equilibrium"""
    rates: Array
    """(3, 3) 1/s, mobility times stiffness"""
    kappa: Array
    """(dims,) 1/s, stiffness over drag; across a wall the rate in the plane whose radius gives the
    gap
    """
    modes: Modes | None
    """modes of the velocity; None without inertia"""
    towards: Towards | None
    """rates of the motion towards a wall; None without one"""
    bias: float
    """relative error of the position's variance per step, 1/s"""
    recoil: Recoil | None = None
    """momentum diffusion by the recoil of the light; None without it"""

    @property
    def inertial(self) -> bool:
        """Whether the state contains velocities."""
        return self.modes is not None

    @classmethod
    def of(cls, problem: Problem) -> Linearised:
        """Return the linear motion about the stable equilibrium of the problem, if it has one."""
        scene, walls = problem.scene, problem.drag.walls
        dims = 6 if problem.rotates else 3
        method = METHODS[scene.simulation.method]
        kT = Boltzmann * scene.noise_temperature
        mobility = problem.mobility[:dims]
        if problem.body is not None:
            mobility = thermal_body.largest_mobilities(problem.body)
        if walls is not None:
            free = walls.stokes
            mobility = np.repeat([1 / free.translation, 1 / free.rotation], 3)[:dims]
        tau, modes = _velocities(problem, mobility)
        rates, kappa, centre = np.zeros((3, 3)), np.zeros(dims), np.zeros(dims)
        if (trap := problem.equilibrium) is not None:
            there = problem.mobilities(np.array([trap.position]))[0]
            rates = rates_of(trap, mobility if walls is None else there)
            kappa[TRANSLATION] = np.diag(rates)
            centre[TRANSLATION] = trap.position
        beside = None
        if walls is not None:
            beside = towards(problem, walls)
            kappa[2] = beside.spring
        bias = 0.0
        if not (method.displacements or method.spring_only or walls):
            bias = one_call_bias(problem, mobility[TRANSLATION], kT)
        diffusion, recoil = kT * mobility, None
        if scene.forces.recoil:
            place, stiffness = np.array(scene.start_position), np.full(3, math.inf)
            if trap is not None:
                place, stiffness = trap.position, trap.stiffness_xyz
            recoil = recoil_at(scene, place, stiffness)
            diffusion = recoil.added_to(diffusion, mobility)
        return cls(
            method, kT, tau, mobility, diffusion, centre, rates, kappa, modes, beside, bias, recoil
        )


def _velocities(problem: Problem, mobility: Array) -> tuple[Array, Modes | None]:
    """Return the relaxation times of the velocity, (dims,) s, and its modes: 0 and None without
    inertia.
    """
    simulation, dims = problem.scene.simulation, len(mobility)
    if not MODELS[str(simulation.model)].inertia:
        return np.zeros(dims), None
    if problem.body is not None:
        tau = problem.body.relaxation_times
        return tau, Modes(tau[-1:], np.ones(1))  # the shortest: no bead moves farther in a step
    inertias = np.repeat([problem.effective_mass, problem.bead.moments_of_inertia[0]], 3)[:dims]
    tau = inertias * mobility
    if simulation.model == "scaled" and simulation.scaling_factor:
        tau = tau / simulation.scaling_factor
    if problem.scene.medium.inertia == "memory" and problem.network is None:
        return tau, problem.modes
    return tau, Modes(tau[:1], np.ones(1))


def steps_of(problem: Problem, linear: Linearised, fewest: int) -> tuple[float, int, str]:
    """Return the step, s, the number of steps from sample to sample, and what limits the step.

    Raises `SceneError` for too many steps from sample to sample.
    """
    simulation = problem.scene.simulation
    interval = simulation.duration / (simulation.samples - 1)
    longest, reason = _longest(problem, linear)
    per_sample = max(fewest, math.ceil(interval / longest * (1 - 1e-12)))
    if (controller := problem.scene.feedback) is not None:  # ticks are at ends of steps
        apart = max(1, round(interval * controller.rate))
        per_sample = apart * math.ceil(per_sample / apart)
    if per_sample > _MOST_PER_SAMPLE:
        raise SceneError(_too_many_steps(simulation, longest))
    step = interval / per_sample
    return step, per_sample, f"steps of {step:.3g} s: {reason}"


def _longest(problem: Problem, linear: Linearised) -> tuple[float, str]:
    """Return the longest step that suits the scene, s, and what limits it."""
    given = problem.scene.simulation.step
    limits = list(_limits_of_any_step(problem, linear))
    if given is not None:
        return min(*limits, (given, "simulation.step"))
    return min([*limits, *_limits_of_forces(problem, linear), *_limits_of_drag(problem, linear)])


def _limits_of_any_step(problem: Problem, linear: Linearised) -> Iterator[tuple[float, str]]:
    """Yield limits, s, that also apply to a step that the scene sets, each with its reason."""
    simulation, kappa = problem.scene.simulation, linear.kappa
    yield math.inf, "from sample to sample"
    if problem.rotates:
        exact = linear.inertial or linear.towards is not None
        part = LONGEST_WITH_INERTIA if exact else LONGEST
        if problem.body is not None:
            part = thermal_body.LONGEST
        about = linear.diffusion[ROTATION][0]
        yield part / about, f"{part:g} of the time of rotational diffusion"
    if (camera := problem.scene.camera) is not None:
        if (rate := float(np.abs(kappa).max())) > 0:
            yield _PART / rate, f"{_PART:g} of the time of the trap, for the camera"
        if linear.modes is not None:
            yield longest_step(camera, linear.modes, _BIAS), "for inertia in the frames"
    if (amplifier := problem.scene.lock_in) is not None:
        yield lock_in.longest_step(amplifier), "for the lock-in"
    fastest = float(linear.diffusion[TRANSLATION].max())
    way = _PART_OF_LOSS * simulation.loss_distance
    # <x^2> is at most 2 D t, and with inertia at most kT/m t^2
    diffuses, flies = way**2 / (2 * fastest), way * math.sqrt(linear.tau[0] / fastest)
    yield max(diffuses, flies), f"thermal motion over {_PART_OF_LOSS:g} of simulation.loss_distance"
    if linear.method.spring_only and _reaches_loss(problem, linear):
        some = f"{_PART:g} of the time of the trap, for the times of loss"
        yield _PART / float(kappa[TRANSLATION].max()), some


def _limits_of_forces(problem: Problem, linear: Linearised) -> Iterator[tuple[float, str]]:
    """Yield limits, s, due to forces and their changes, each with its reason."""
    simulation, tau = problem.scene.simulation, linear.tau
    # not the largest: next to its surface at the focus a bead's force has an infinite derivative
    if problem.body is not None:
        about = thermal_body.rates_of_wrench(problem)
        turns = float(linear.diffusion[ROTATION][0])
        part = thermal_body.USUAL
        yield part / turns, f"{part:g} of the time of rotational diffusion"
    else:
        about = rates_of_force(problem if linear.towards is None else without_walls(problem))
    rate = max(float(np.quantile(about, _MOST)), float(np.abs(linear.kappa).max()))
    if rate > 0 and not linear.method.spring_only:
        decay = _PART / rate, f"{_PART:g} of the fastest time scale of the force"
        part = Facts(problem).scheme.part_of_swing
        swing = part * math.sqrt(tau[0] / rate), f"{part:g} of the time of a swing"
        yield max(decay, swing)  # at low damping the force acts as fast as a bead swings
    if linear.bias > 0:
        some = f"{100 * _BIAS:g} % of the variance, as the force is not a gradient"
        yield _BIAS / linear.bias, some
    if shortest := problem.force.shortest_time(simulation.duration):
        some = f"{_PART_OF_CHANGE:g} of the time in which the force changes"
        yield _PART_OF_CHANGE * shortest, some


def _limits_of_drag(problem: Problem, linear: Linearised) -> Iterator[tuple[float, str]]:
    """Yield limits, s, due to the drag and its changes, each with its reason."""
    tau = linear.tau
    if (beside := linear.towards) is not None:
        part = _PART
        if linear.inertial:
            flies = tau[0] * beside.fastest > _FLIES
            part = _PART_OF_FLIGHT if flies else _PART_WITH_INERTIA
        some = f"{part:g} of the time scale of the motion towards the wall"
        yield part / beside.fastest, some
        if not problem.force.steady and (rate := rate_of_sticking(problem)) > 0:
            yield _PART / rate, f"{_PART:g} of the time scale of a bead that sticks"
    elif (rate := _rate_of_drag(problem)) > 0:
        some = f"diffusion over {_PART_OF_LENGTH:g} of the length in which the drag changes"
        yield _PART_OF_LENGTH**2 / rate, some
    if linear.inertial and Facts(problem).scheme.resolves_drag:
        yield _PART_OF_TAU * tau.min(), f"{_PART_OF_TAU:g} of the relaxation time"


def _reaches_loss(problem: Problem, linear: Linearised) -> bool:
    """Return whether a bead in the trap's spring may reach the distance at which it is lost."""
    scene, trap = problem.scene, problem.equilibrium
    assert trap is not None  # a method that follows the spring alone refuses a scene without one
    spread = math.sqrt(float((linear.diffusion[TRANSLATION] / linear.kappa[TRANSLATION]).max()))
    places = np.array([trap.position, scene.start_position])
    left = scene.simulation.loss_distance - np.linalg.norm(places, axis=1).max()
    return bool(left < _FARTHEST * spread)


def _too_many_steps(simulation: Simulation, longest: float) -> str:
    """Return the message for a run with too many steps between samples; longest: step, s."""
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


def _rate_of_drag(problem: Problem) -> float:
    """Return the largest 2 D |grad b|^2/b^2 around the trap, 1/s: the rate at which the drag
    changes.

    b is the mobility and D = kT b. It is evaluated on lines from the trap, or the start, to
    positions about it. 0 for a uniform drag.
    """
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
    kT = Boltzmann * problem.scene.noise_temperature
    return float((2 * kT * change[there] ** 2 / b[there]).max(initial=0.0))
