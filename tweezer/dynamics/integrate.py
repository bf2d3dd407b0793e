"""Integration in time with a compiled method or a solver of SciPy, piece by piece.

Because the integration advances piece by piece, a run can report progress, detect events, stop when
the bead is lost, and keep the computed motion if it is interrupted or fails.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tweezer.dynamics import integrators
from tweezer.dynamics.choose import method_for
from tweezer.dynamics.events import Event, Occurrence, Piece, ending
from tweezer.dynamics.layout import POSITION
from tweezer.dynamics.mirror import AT_MIRROR, in_mirror
from tweezer.dynamics.models import EquationsOfMotion
from tweezer.dynamics.path import UNTOLD, Path
from tweezer.dynamics.solution import BEFORE, Solver, Steps
from tweezer.dynamics.timing import timed
from tweezer.forces.own import fault_of, forget_faults
from tweezer.scene import Scene
from tweezer.scene.choices import METHODS
from tweezer.values.arrays import Array
from tweezer.values.errors import IntegrationError, SceneError

#: most steps whose dense output is held in memory, some 250 bytes each
MOST_HELD = 2**18

#: message for each way in which a compiled loop fails
_FAILURES = {
    integrators.COLLAPSED: "the step has collapsed: no step meets the tolerances, or the given "
    "step is too long",
    integrators.NOT_FINITE: "the force or the state is not finite",
    integrators.EXHAUSTED: "simulation.most_force_calls is spent",
}
#: reason of `COLLAPSED` for a run that entered a wall
_IN_A_WALL = "the bead entered the wall: the given step is too long, or the contact is too soft"
#: Depth in a wall, m, and in tolerances of the position, up to which contact is soft
SOFT, SOFT_IN_TOLERANCES = 1e-9, 3.0


@dataclass(frozen=True)
class Integration:
    """States at the output times that a run reached, and how it ended."""

    method: str
    times: Array
    """(n,) output times, s"""
    states: Array
    """(n, state) states at these times, as the emitted equations have them"""
    steps: int
    """number of steps up to the end of the run"""
    rejected: int
    """number of steps that were repeated because their error was too large"""
    force_calls: int
    """number of force evaluations, including steps that a compiled method took past the end of the
    run
    """
    status: str
    """"complete", "lost", "ended" by another event, "interrupted" or "failed" """
    message: str
    """reason for the end of the run; empty if it reached the last time"""
    events: list[Occurrence]
    """in the order of their times"""
    step_time: float
    """time spent on steps, s, without binding, compiling, events and output"""
    step_lengths: Array
    """lengths of the steps of a compiled method up to the end of the run, s; (0,) for a solver of
    SciPy
    """
    path: Path | None
    """the motion between `times`; None for a run that failed, or with more steps than are kept in
    memory
    """
    inner: Array | None = None
    """last state in the form that the method's loop uses, (inner,); None for a run that failed"""

    @property
    def end(self) -> tuple[Array, Array] | None:
        """Last state in the form of the emitted equations and in that of the loop; None for a
        failed run.
        """
        return None if self.inner is None else (self.states[-1], self.inner)


def integrate(
    equations: EquationsOfMotion,
    times: Array,
    events: Sequence[Event] = (),
    progress: Callable[[float], None] | None = None,
    *,
    tightened: float = 1.0,
    prescribed: Array | None = None,
    most_held: int = MOST_HELD,
) -> Integration:
    """Integrate from times[0] to times[-1] by the scene's method, with output at `times`.

    An interrupt (Ctrl-C) or a failure ends the run early. The result contains the motion up to this
    time and is marked. An interrupt before the first step is raised.

    Parameters
    ----------
    times : ndarray, shape (n,)
        Output times, s. The first one is 0, or the time at which the equations begin.
    events
        Events to locate on the dense output. The time of an event that ends the run is the last
        returned time.
    progress
        Called with the time reached, s.
    tightened
        Factor of all tolerances.
    prescribed
        All steps of a compiled method, s, instead of its own steps.
    most_held
        Largest number of steps for which the result has a `path`.
    """
    method: str = equations.scene.simulation.method
    if method == "auto":
        method, _ = method_for(equations)
    start, close = equations.begin_state, UNTOLD * equations.absolute_tolerance
    events = [event.restarted(start, equations.layout, close) for event in events]
    so_far = _SoFar(equations, times, [start[None]], most_held)
    force = equations.force
    forget_faults(force)
    solver: Solver | SciPySolver | None = None
    try:
        if METHODS[method].solver:
            solver = SciPySolver(equations, method, float(times[-1]), tightened)
        else:
            solver = Solver(
                equations, method, end=float(times[-1]), tightened=tightened,
                fixed=equations.scene.simulation.step or 0.0, prescribed=prescribed,
            )  # fmt: skip
        why = integrators.FULL
        while why == integrators.FULL and so_far.status == "complete":
            with timed() as stepping:
                piece, why = solver.advance()
            so_far.step_time += stepping["wall_time"]
            if piece is not None:
                end = so_far.take(piece, events, solver.steps)
                if progress:
                    progress(end)
            if why in _FAILURES and so_far.status == "complete":
                raise IntegrationError(_FAILURES[why])
            # steps that shrink towards a place without a force would go on for ever
            if piece is not None and why == integrators.FULL and fault_of(force, piece.end):
                raise IntegrationError(_FAILURES[integrators.NOT_FINITE])
    except KeyboardInterrupt:
        if so_far.reached == 1:  # as while it is compiled
            raise
        so_far.status, so_far.message = "interrupted", f"interrupted at {so_far.time:.6g} s"
    except (IntegrationError, ArithmeticError, np.linalg.LinAlgError) as error:
        begin = so_far.time
        so_far.status = "failed"
        so_far.message = f"failed after {begin:.6g} s: {fault_of(force, begin) or error}"
    return so_far.result(method, solver)


@dataclass
class _SoFar:
    """Part of a run that has been integrated so far."""

    equations: EquationsOfMotion
    times: Array
    """(n,) s, output times; an event that ends the run replaces the last one"""
    sampled: list[Array]
    """states at the output times that were reached, in blocks (n, state)"""
    most_held: int
    reached: int = 1
    """number of output times with states"""
    status: str = "complete"
    message: str = ""
    step_time: float = 0.0
    happened: list[Occurrence] = dataclasses.field(default_factory=list)
    """events that occurred"""
    lengths: list[Array] = dataclasses.field(default_factory=lambda: [np.zeros(0)])
    """lengths of the steps in each piece, s"""
    pieces: list[Piece] = dataclasses.field(default_factory=list)
    """pieces of the motion that are kept for the path"""
    latest: Steps | _Step | None = None
    """steps that contain the last output time"""

    @property
    def time(self) -> float:
        """Last output time that was reached, s."""
        return float(self.times[self.reached - 1])

    def take(self, piece: Steps | _Step, events: Sequence[Event], steps: int) -> float:
        """Add a piece of the motion, up to an event that ends the run; return the time reached, s.

        steps: number of steps of the run so far. Raises `IntegrationError` for states that are not
        finite or in a wall.
        """
        end = self._events(piece, events)
        self.lengths.append(piece.step_lengths(end))
        if steps <= self.most_held:
            self.pieces.append(piece)
        last = int(np.searchsorted(self.times, end, side="right"))
        wanted = self.times[self.reached : last]
        latest = wanted[-1] if wanted.size else self.times[self.reached - 1]
        if self.status != "complete" and latest < end:
            wanted = np.append(wanted, end)
            self.times = np.append(self.times[:last], end)
        if wanted.size:
            self._sample(piece, wanted)
        return end

    def _events(self, piece: Steps | _Step, events: Sequence[Event]) -> float:
        """Record the events within a piece; return the time at which the piece, or the run, ends,
        s.
        """
        end, seen = piece.end, self.equations.released(piece)
        found = [(event, each) for event in events for each in event.occurrences(seen)]
        for event, each in sorted(found, key=lambda pair: pair[1].certain):
            if each.certain > end:
                continue
            self.happened.append(each)
            if event.terminal:
                end = each.certain
                self.status, self.message = event.ends_as, ending(event, end)
        return end

    def _sample(self, piece: Steps | _Step, wanted: Array) -> None:
        """Append the states at output times `wanted`, s, within a piece."""
        states = piece.states(wanted)
        # a step may end at numbers so large that those within it overflow
        sound = np.asarray(np.isfinite(states).all(axis=1))
        scene = self.equations.scene
        mirrored = in_mirror(scene, states[:, POSITION][:, 2], _soft(scene))
        failed = np.flatnonzero(~sound | _in_a_wall(self.equations, states) | mirrored)
        kept = int(failed[0]) if len(failed) else len(wanted)
        self.sampled.append(states[:kept])
        self.reached, self.latest = self.reached + kept, piece
        if kept < len(wanted):
            if not sound[kept]:
                raise IntegrationError(_FAILURES[integrators.NOT_FINITE])
            raise IntegrationError(AT_MIRROR if mirrored[kept] else _IN_A_WALL)

    def result(self, method: str, solver: Solver | SciPySolver | None) -> Integration:
        """Return the result of a run that ended."""
        step_lengths = np.concatenate(self.lengths)
        steps = solver.steps if solver else 0
        path = inner = None
        if self.status != "failed" and self.reached > 1 and steps <= self.most_held:
            path = Path(self.equations, self.pieces, self.time)
        if self.status != "failed" and self.latest is not None:
            inner = self.latest.inner(self.time)
        return Integration(
            method,
            self.times[: self.reached],
            np.concatenate(self.sampled),
            len(step_lengths) or steps,
            solver.rejected if solver else 0,
            solver.force_calls if solver else 0,
            self.status,
            self.message,
            sorted(self.happened, key=lambda event: event.time),
            self.step_time,
            step_lengths,
            path,
            inner,
        )


def _in_a_wall(equations: EquationsOfMotion, states: Array) -> NDArray[np.bool_]:
    """Return for states (n, state) whether the bead is in a wall, (n,).

    Contact is soft, so a depth up to `SOFT` or some tolerances of the position is allowed.
    """
    scene = equations.scene
    if scene.wall is None:
        return np.full(len(states), False)
    inside: NDArray[np.bool_] = scene.room(states[:, POSITION][:, 2]) < -_soft(scene)
    return inside


def _soft(scene: Scene) -> float:
    """Return the depth in a wall up to which contact is soft, m."""
    return max(SOFT, SOFT_IN_TOLERANCES * scene.simulation.position_tolerance)


@dataclass(frozen=True)
class _Step:
    """One step of a solver of SciPy; implements `Piece`."""

    dense: Callable[[Array], Array]
    """dense output of the step: states (state, n) at times (n,), s"""
    begin: float
    """time at the beginning of the step, s"""
    end: float
    """time at the end of the step, s"""

    def checkpoints(self) -> Array:
        return np.linspace(self.begin, self.end, 5)

    def states(self, times: Array) -> Array:
        return np.asarray(self.dense(times)).T

    def step_lengths(self, end: float) -> Array:  # noqa: ARG002
        """Return an empty array: step lengths are known for compiled methods only."""
        return np.zeros(0)

    def inner(self, time: float) -> Array:
        """Return the state at a time, s; solvers of SciPy use the form of the emitted equations."""
        return self.states(np.array([time]))[0]


class SciPySolver:
    """Solver of SciPy bound to equations of motion; `advance` takes one step."""

    rejected = 0

    def __init__(
        self, equations: EquationsOfMotion, method: str, end: float, tightened: float = 1.0
    ) -> None:
        simulation = equations.scene.simulation
        self._equations, self._method = equations, method
        self._one_step = not METHODS[method].multistep
        self._calls_before = equations.force_calls
        self._most_calls = simulation.most_force_calls
        self._options: dict[str, Any] = {
            "rtol": simulation.relative_tolerance * tightened,
            "atol": equations.absolute_tolerance * tightened,
        }
        if METHODS[method].implicit and equations.module.JACOBIAN_INPUTS:
            self._options["jac"] = equations.jacobian
        kinks = equations.force.kinks(end)
        self._ends = [*kinks[kinks > equations.begin_time].tolist(), end]
        self._begin(equations.begin_time, equations.begin_state)
        self.steps = 0

    def _begin(self, time: float, state: Array) -> None:
        """Start the solver at a time, s, and a state, up to the next kink of the force
        or the end.
        """
        self._end = self._ends.pop(0)
        last = self._end * BEFORE if self._ends else self._end
        self._solver = METHODS[self._method].load()(
            self._equations.rhs, time, state, last, **self._options
        )

    @property
    def force_calls(self) -> int:
        """Number of positions at which the force was evaluated."""
        return self._equations.force_calls - self._calls_before

    def advance(self) -> tuple[_Step | None, int]:
        """Take one step; return it and why stepping paused, as `Solver.advance` does."""
        solver = self._solver
        if self.force_calls > self._most_calls:
            return None, integrators.EXHAUSTED
        try:
            failure = solver.step()
        except (IntegrationError, SceneError) as error:  # or a place that is too far
            if self.steps:
                raise IntegrationError(str(error)) from None
            raise IntegrationError(
                f"{error}: the first step, which {self._method} chooses by itself, is too long"
            ) from None
        if solver.status == "failed":
            raise IntegrationError(failure or "the solver failed")
        self.steps += 1
        # the dense output of the step as it was taken; of DOP853 it costs force calls
        piece = _Step(solver.dense_output(), float(solver.t_old), float(solver.t))
        if self._one_step and self._equations.rotates:
            solver.y = self._equations.on_constraints(solver.y)
        if solver.status == "finished" and self._ends:
            self._begin(self._end, solver.y)
            return dataclasses.replace(piece, end=self._solver.t), integrators.FULL
        return piece, integrators.FULL if solver.status == "running" else integrators.REACHED
