"""Errors of a run by time integration and by the model. The error of the force is separate."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from tweezer.dynamics.choose import decided
from tweezer.dynamics.continuing import Begin
from tweezer.dynamics.events import Event
from tweezer.dynamics.integrate import MOST_HELD, Integration, integrate
from tweezer.dynamics.models import EquationsOfMotion, bind
from tweezer.dynamics.path import largest_distance
from tweezer.dynamics.problem import Problem
from tweezer.dynamics.solution import BEFORE
from tweezer.fluid import left_out_of_walls, other_poles
from tweezer.fluid.drag import Stokes
from tweezer.scene.choices import METHODS
from tweezer.values.arrays import Array

#: at the lowest order of convergence, 1, half the steps leave half the error; where a force bends
#: or a table has seams, which does not fall with the step, somewhat more
_ERROR_PER_DISTANCE = 3.0
#: rounding of the times of steps, as a part of them
_ROUNDING = 1e-12
#: tolerances of a run that is to be exact by comparison, of the scene's
TIGHTER = 1.0 / 16.0


@dataclass(frozen=True)
class Finer:
    """Finer integration of the same motion."""

    run: Integration
    error_per_difference: float
    """error of the run over its difference from this finer one"""


@dataclass(frozen=True)
class ErrorBudget:
    """Errors of a run's positions, m; NaN if unknown."""

    integration_error: float
    """error of time integration. For a compiled method it is three times the largest distance to a
    run with halved steps and the largest number of poles of the hydrodynamic memory. A solver of
    SciPy is compared with a compiled method with tighter tolerances. NaN if a finer run is
    impossible, for example because it would exceed `simulation.most_force_calls`
    """
    finer: Finer | None
    """finer run from which the integration error follows; None if it is unknown"""


def error_budget(
    equations: EquationsOfMotion, run: Integration, position: Array, events: Sequence[Event] = ()
) -> ErrorBudget:
    """Return the errors of a run: the largest up to its end, located on the dense output.

    The errors are unknown if the run or the estimate was interrupted. Runs with more steps than
    `MOST_HELD`, which exceed the memory, are compared at the output times alone. The error of a
    continued run includes the error of the earlier run, because the finer run continues from its
    own end.

    Parameters
    ----------
    equations : EquationsOfMotion
        Equations of the run.
    run : Integration
        The run.
    position : ndarray, shape (n, 3)
        Output of the run, m.
    events : sequence of Event, optional
        Events to locate in the finer run too.
    """
    begin = equations.begin
    if run.status == "interrupted" or (begin is not None and begin.finer is None):
        return ErrorBudget(math.nan, None)
    if len(run.times) < 2:
        return ErrorBudget(0.0, None)
    try:
        finer, integration_error = _of_integration(equations, run, position, events)
    except KeyboardInterrupt:  # the run itself is complete
        return ErrorBudget(math.nan, None)
    return ErrorBudget(integration_error, finer)


def model_error(equations: EquationsOfMotion, run: Integration, position: Array) -> float:
    """Return the largest distance to the unscaled equations with all inertia, m.

    These equations include fluid inertia and are integrated by the exponential method. A run with
    the same equations has no model error; beside a wall it is the delay by the wall's drag. In a
    gas that is no continuum, their drag is larger by what the inertia of the gas might add. For a
    body that this method cannot integrate the error is NaN. With the model `full` it is then the
    largest lag due to fluid inertia (`Scene.lag`). If the drag depends on the position, as beside a
    wall, the error is the sum of this lag and the distance to the unscaled equations. For a body
    that is no sphere it is this sum too, with the first reflection of a wall.

    `position` (n, 3), m, contains the output of the run. The error is NaN for an interrupted run.
    It is NaN for a continued run too, unless the run uses these equations without a wall.
    """
    if equations.begin is not None:
        exact = equations.name.startswith("full") and equations.scene.medium.inertia == "memory"
        return 0.0 if exact and equations.scene.wall is None else math.nan
    if run.status == "interrupted":
        return math.nan
    if len(run.times) < 2:
        return 0.0
    full = equations.name.startswith("full")
    if full and equations.scene.medium.inertia == "memory":
        return _without_wall(equations, run)
    without_scaling = unscaled(equations.problem)
    if equations.drag.uniform and equations.body is None and without_scaling is not None:
        off = _compared(_in_thin_gas(without_scaling, equations, run), run, position)[1]
        return off + _lag(equations, run) if equations.problem.rings_with_fluid else off
    off = 0.0 if full else _compared(without_scaling, run, position)[1]
    return off + _lag(equations, run) + _slowed_by_walls(equations, run)


def _of_integration(
    equations: EquationsOfMotion, run: Integration, position: Array, events: Sequence[Event]
) -> tuple[Finer | None, float]:
    """Return the finer run, if one can be made, and the error of time integration, m."""
    problem: Problem | None
    if METHODS[run.method].solver:
        problem, ratio = _compiled(equations), 1.0
        how: dict[str, Any] = {"tightened": TIGHTER}
    else:
        problem = _with_other_poles(equations.problem.changed(method=run.method))
        ratio, how = _ERROR_PER_DISTANCE, {"prescribed": _finer_steps(equations, run)}
    begin = equations.begin.finer if equations.begin else None
    compared, distance = _compared(problem, run, position, begin, events=events, **how)
    fixed = equations.scene.simulation.step is not None
    if compared is None and "prescribed" in how and not fixed:
        # a force that bends may want shorter steps still
        how = {"tightened": TIGHTER}
        compared, distance = _compared(problem, run, position, begin, events=events, **how)
        if compared is not None and same_steps(run, compared):
            compared, distance = None, math.nan
    return Finer(compared, ratio) if compared else None, ratio * distance


def same_steps(one: Integration, other: Integration) -> bool:
    """Return whether two runs took the same steps, so that their difference is not their error.

    Tighter tolerances change neither a given step nor steps at the smallest tolerance.
    """
    a, b = one.step_lengths, other.step_lengths
    return len(a) > 0 and len(a) == len(b) and bool(np.allclose(a, b, rtol=_ROUNDING, atol=0.0))


def _with_other_poles(problem: Problem) -> Problem:
    """Return the problem with the most poles, or with fewer if it has these, if it has a memory."""
    poles = problem.scene.medium.poles
    return problem.decided(medium={"poles": other_poles(poles)}) if poles else problem


def _finer_steps(equations: EquationsOfMotion, run: Integration) -> Array:
    """Return the lengths of the steps of the finer run, s: half as long as the run's.

    Where the force jumps, and at the beginning, a series of ever longer steps resolves the
    relaxation of the velocity. A step much longer than the relaxation does not resolve it, and
    neither would half of that step.
    """
    lengths = run.step_lengths
    begin = equations.begin_time
    kinks = equations.force.kinks(begin + float(lengths.sum()))
    kinks = np.append(begin, kinks[kinks > begin])
    begins = begin + np.append(0.0, np.cumsum(lengths)[:-1])
    # every piece ends a little before its kink, and the sum of lengths falls short by all of them
    slack = _ROUNDING + (1 - BEFORE) * np.arange(len(kinks))
    after = np.searchsorted(begins, kinks * (1 - slack))
    finer = [np.full(2, each / 2) for each in lengths]
    if equations.takes_drag_exactly and equations.inertial:
        shortest = equations.fastest_relaxation
        for i in after[after < len(lengths)]:
            many = max(int(math.log2(lengths[i] / shortest)), 0)
            ends = lengths[i] * 0.5 ** np.arange(many + 1, -1, -1)
            finer[i] = np.diff(ends, prepend=0.0)
    return np.concatenate(finer)


def _without_wall(equations: EquationsOfMotion, run: Integration) -> float:
    """Return how much less the bead would have moved with the drag of the wall, m.

    A fluid with memory ignores that drag.
    """
    scene = equations.scene
    if scene.wall is None:
        return 0.0
    motion = equations.motion(run.times, run.states)
    share = left_out_of_walls(scene, motion.position)[:, 1]
    slower = share * np.linalg.norm(np.asarray(motion.velocity), axis=1)
    return float(np.trapezoid(slower, run.times))


def _lag(equations: EquationsOfMotion, run: Integration) -> float:
    """Return the largest lag due to fluid inertia, m, of a run without fluid inertia.

    Beside a wall vorticity diffuses only as far as the wall, which bounds the time.
    """
    motion, vorticity = equations.motion(run.times, run.states), equations.problem.vorticity_time
    times = run.times
    if equations.scene.wall is not None:
        height = equations.scene.gap(motion.position[:, 2]) / equations.scene.body.size + 1
        times = np.minimum(times, height**2 * vorticity)
    lags = 2 * np.sqrt(vorticity * times / math.pi)
    return float((lags * np.linalg.norm(np.asarray(motion.velocity), axis=1)).max())


def _in_thin_gas(problem: Problem, equations: EquationsOfMotion, run: Integration) -> Problem:
    """Return a problem whose drag is larger by what the inertia of a gas might add at most.

    For a gas that is no continuum this is the part sqrt(omega tau_f) of the drag. The frequency
    omega is the damping rate, or the largest speed over the largest excursion if it is larger.
    Other problems are returned unchanged.
    """
    if not problem.scene.rarefied:
        return problem
    motion = equations.motion(run.times, run.states)
    excursion = np.linalg.norm(motion.position - motion.position.mean(axis=0), axis=1).max()
    speed = np.linalg.norm(np.asarray(motion.velocity), axis=1).max()
    omega = max(1 / problem.relaxation_time, speed / excursion if excursion > 0 else 0.0)
    more = 1 + math.sqrt(omega * problem.vorticity_time)
    heavier = Stokes(more * problem.bead.drag, more * problem.bead.rotational_drag)
    return dataclasses.replace(problem, drag=heavier)


def _slowed_by_walls(equations: EquationsOfMotion, run: Integration) -> float:
    """Return how much less a body that is no sphere would have moved with the drag of walls, m.

    Its drag far from walls is used. The first reflection slows the motion across a wall at the
    distance h by 9 a/8 h, where 6 pi mu a is the largest drag coefficient (H. Brenner, J. Fluid
    Mech. 12, 35 (1962)). 0 for a sphere.
    """
    scene, body = equations.scene, equations.body
    if scene.wall is None or body is None:
        return 0.0
    motion = equations.motion(run.times, run.states)
    z = motion.position[:, 2]
    share = sum(
        9 / 8 * body.radius(scene.medium.viscosity) / np.abs(z - position)
        for position, _ in scene.wall.planes
    )
    slower = share * np.linalg.norm(np.asarray(motion.velocity), axis=1)
    return float(np.trapezoid(slower, run.times))


def _compiled(equations: EquationsOfMotion) -> Problem | None:
    """Return the problem with a compiled method that suits its equations, or None."""
    method = "exponential" if equations.takes_drag_exactly else "dop853"
    if equations.takes_drag_exactly or not equations.inertial:
        return equations.problem.changed(method=method, step=None)
    return None


def unscaled(problem: Problem) -> Problem | None:
    """Return the unscaled equations with all inertia; None if the method cannot integrate them."""
    full = problem.changed(
        model="full", method="exponential", scaling_factor=None, step=None,
        rotation_state="angular-velocity",
    )  # fmt: skip
    if not full.takes_drag_exactly:
        return None
    if not full.drag.uniform or full.body is not None:
        return full
    inertia = "none" if full.scene.rarefied or full.rings_with_fluid else "memory"
    found = full.decided(medium={"inertia": inertia})
    if found.network is not None and found.network.rings:
        return None
    return decided(found)[0]


def _compared(
    problem: Problem | None,
    run: Integration,
    position: Array,
    begin: Begin | None = None,
    **how: Any,
) -> tuple[Integration | None, float]:
    """Return the motion of `problem` at the times of a run, and its largest distance from the run,
    m.

    None and NaN if there is no problem or its motion is not completed. position: (n, 3) m, of the
    run.
    """
    if problem is None:
        return None, math.nan
    equations = bind(problem, begin)
    compared = integrate(equations, run.times, most_held=2 * MOST_HELD, **how)
    if compared.status == "interrupted":
        raise KeyboardInterrupt
    if compared.status != "complete":
        return None, math.nan
    if run.path is not None and compared.path is not None:
        found = largest_distance(run.path, compared.path)
        return compared, found.value + found.error
    there = equations.motion(compared.times, compared.states).position
    return compared, float(np.linalg.norm(there - position, axis=1).max())
