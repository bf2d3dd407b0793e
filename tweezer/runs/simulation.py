"""Simulation of a scene, with the result as an `xarray.Dataset` with units and provenance."""

from __future__ import annotations

import contextlib
import dataclasses
import json
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from tweezer.dynamics import (
    Event,
    Motion,
    Problem,
    bind,
    bound_once,
    closest_approach,
    decided,
    error_budget,
    integrate,
    lens_touched,
    loss,
    model_error,
)
from tweezer.dynamics.brownian.stepwise import Line, Watch
from tweezer.dynamics.budget import ErrorBudget
from tweezer.dynamics.camera import Frames
from tweezer.dynamics.continuing import Continued, End, as_attribute, continued, finer_state
from tweezer.dynamics.events import Occurrence
from tweezer.dynamics.integrate import Integration
from tweezer.dynamics.layout import POSITION, QUANTITIES
from tweezer.dynamics.mirror import AT_MIRROR
from tweezer.dynamics.models import EquationsOfMotion
from tweezer.dynamics.needs import WATCHED, check
from tweezer.dynamics.timing import timed
from tweezer.forces.force import Force, Wrench
from tweezer.forces.named import origins_of
from tweezer.optics import evaluators_of, worth_attributes
from tweezer.results.io import load_run
from tweezer.results.run import Run, Variable, variable
from tweezer.runs.derived import derived_quantities, fault_at, force_errors, light_on
from tweezer.runs.summary import force_error_along, stored, summary_of_path
from tweezer.scene import Scene, SceneLike, checked_scene
from tweezer.scene.arguments import check_run, in_si
from tweezer.values.arrays import Array
from tweezer.values.errors import IntegrationError, ResultError, SceneError, warn
from tweezer.values.units import QuantityLike
from tweezer.values.version import made_by, versions

if TYPE_CHECKING:
    import xarray as xr

    from tweezer.dynamics.walk import Walk


#: Gap below which a bead may have touched a wall between two samples, m
_TOUCHING = 5e-9
#: Number of thermal steps between two checks for progress and interrupts
_STEPS_AT_ONCE = 100_000


def simulate(
    scene: SceneLike,
    duration: QuantityLike | None = None,
    *,
    model: str | None = None,
    method: str | None = None,
    tolerance: float | None = None,
    seed: int | None = None,
    forces: Sequence[Force | str] = (),
    events: Sequence[Event] = (),
    progress: Callable[[float], None] | None = None,
    continue_from: xr.Dataset | str | Path | None = None,
) -> xr.Dataset:
    """Release the bead, or the beads, of `scene` and return the motion.

    With thermal motion the run is trajectory 0 of the ensemble with the same seed. Its steps are
    fixed, so it has no tolerances, and the integration error is NaN. Models without inertia have no
    velocity. Events are detected at the ends of steps and located by linear interpolation between
    them, to within a step (`event_resolution`, s). An event that begins and ends within one step is
    missed (`tweezer.dynamics.brownian.stepwise`). Events depend on the position, the orientation
    and, in models with inertia, on the velocities. The first closest approach is not searched.

    A continued run begins at the end of the earlier run, with the same position, orientation,
    velocities and hydrodynamic memory. Model, method and sampling interval are the same. With
    thermal motion the sequence of random numbers continues. Light, other forces and tolerances may
    differ. `integration_error` includes the error of the earlier run; it is NaN if that error is
    unknown, for example after an interrupt. An event with a required duration starts counting
    again.

    Parameters
    ----------
    scene : Scene, str or mapping
        Scene, name of a shipped scene, TOML file, or mapping.
    duration : float or str, optional
        Duration, s, e.g. "20 ms". Default: the scene's.
    model, method : str, optional
        Model and method, which replace the scene's.
    tolerance : float, optional
        Relative tolerance. The scene's absolute tolerances are scaled by the same factor.
    seed : int, optional
        Seed of the thermal motion and of the noise of camera and detector. Default: 0.
    forces : sequence of Force or str, optional
        Your own forces, in addition to the scene's (`tweezer.forces`), or the name of a force in a
        Python file, "handles.py:spring".
    events : sequence of Event, optional
        Events to locate (`tweezer.capture`, `tweezer.Event`), in addition to the first closest
        approach, the loss of the bead and its contact with the lens.
    progress : callable, optional
        Called with the time reached, s.
    continue_from : xarray.Dataset, str or Path, optional
        Earlier run, or its file, to continue for `duration` (`tweezer.dynamics.continuing`).

    Returns
    -------
    xarray.Dataset
        Run over `time`. Every variable has units and a long name.

        * position: position relative to the focus, m
        * velocity, m/s
        * orientation (Euler parameters) and angular_velocity (body frame): if the bead rotates
        * seen (frame, seen_axis): positions in the frames of a camera, m, with frame_time, s
        * of several beads: position (time, bead, axis), optical_force, N, and for each two of them
          distance and gap (time, pair), m, and force_between, N, positive for attraction
        * signal (time, channel): signals x, y and z of a detector, W, behind its bandwidth and with
          its shot noise
        * the quantities of `tweezer.runs.derived`

        The attributes include:

        * the scene, also as given, the versions, the model, the method, the inertia of the fluid,
          the evaluator of the force, steps and force calls
        * integration_error, model_error: largest errors at any time, m (`tweezer.dynamics.budget`)
        * step_time: time of the steps alone, s
        * wall_time: time with binding, events and output, without compiling (compile_time) and
          without the errors, s
        * status: "complete", "lost", "ended" (by one of your events), "interrupted" or "failed". A
          run that ended early contains the motion up to its end. A failed run gives a
          `PhysicsWarning`.
        * the events, and the input of `tweezer.summarise`

    Raises
    ------
    SceneError
        For an invalid scene, invalid events, a tolerance with thermal motion, a seed without
        thermal motion, and a run that cannot be continued.
    ResultError
        For a run that cannot be continued.

    Examples
    --------
    >>> run = tweezer.simulate("silica-1um", "1 ms")
    >>> run.position.sel(axis="z")[-1].item() < 1e-7  # m, near the focus
    True
    """
    scene = checked_scene(scene, several=True)
    scene = _adjusted(scene, duration, model, method, tolerance)
    if scene.forces.brownian and tolerance:
        raise SceneError("tolerance: cannot be combined with forces.brownian = true")
    if scene.more_beads:
        return _of_several_beads(scene, seed, forces, events, progress, continue_from)
    going_on = None if continue_from is None else going_on_from(scene, continue_from)
    run, find_errors = motion_of(scene, seed, forces, events, progress, going_on)
    find_errors()
    return run.dataset()


def _of_several_beads(
    scene: Scene,
    seed: int | None,
    forces: Sequence[Force | str],
    events: Sequence[Event],
    progress: Callable[[float], None] | None,
    continue_from: xr.Dataset | str | Path | None,
) -> xr.Dataset:
    """Return the run of a scene with several beads; refuse what requires a single one."""
    from tweezer.beads.motion import run_of

    for name, given in (("forces", forces), ("events", events)):
        if given:
            raise SceneError(f"{name}: require a single bead; omit {name}")
    if continue_from is not None:
        raise SceneError("continue_from: requires a single bead; simulate the whole duration")
    check_run(scene, seed)
    return run_of(scene, seed, progress).dataset()


def going_on_from(scene: Scene, earlier: xr.Dataset | str | Path) -> tuple[Scene, Continued]:
    """Return the scene of a run that continues an `earlier` one, and the state to continue from.

    `earlier` is a run or its file. Raises `ResultError` if it cannot be continued.
    """
    if isinstance(earlier, str | Path):
        earlier = load_run(earlier)
    attributes: dict[str, Any] = {str(key): value for key, value in earlier.attrs.items()}
    if "time" not in earlier.variables:
        raise ResultError("continue_from: not a run: it has no time")
    return continued(scene, attributes, earlier["time"].values)


def motion_of(
    scene: Scene,
    seed: int | None = None,
    forces: Sequence[Force | str] = (),
    events: Sequence[Event] = (),
    progress: Callable[[float], None] | None = None,
    going_on: tuple[Scene, Continued] | None = None,
) -> tuple[Run, Callable[[], None]]:
    """Return the run of `scene` without some of its errors, and a function that computes them.

    The errors of the force and of the model are NaN until this function is called, which adds them
    to the run. They may take longer than the motion itself, because most of the code compiled for
    a first run belongs to them. If it is interrupted, they remain NaN.
    Parameters
    ----------
    scene, seed, forces, events, progress
        As in `simulate`.
    going_on : tuple of Scene and Continued, optional
        Scene of a continued run, and the run that it continues.
    """
    check_run(scene, seed)
    if not all(isinstance(event, Event) for event in events):
        raise SceneError("events: must be a list of `tweezer.Event`")
    as_given: dict[str, Any] = {"scene_as_given": scene.model_dump_json(exclude_none=True)}
    begun: Continued | None = None
    if going_on is not None:
        scene, begun = going_on
        seed = begun.seed if seed is None else seed
        as_given |= {"continued_from": begun.mark, "begin_time": begun.end.time}
    if scene.forces.brownian:
        return _thermal_run(bound_once(scene, forces), seed or 0, progress, as_given, begun, events)
    problem, why = decided(bound_once(scene, forces))
    frames = Frames.of(problem.scene)
    scene, simulation = problem.scene, problem.scene.simulation
    first, begin, since = (begun.sample, begun.begin, begun.begin.time) if begun else (0, None, 0.0)
    times = np.linspace(since, simulation.duration, simulation.samples - first)
    approach = closest_approach(simulation.position_tolerance)
    approached = begun is not None and begun.approached
    looked_for = [*events, loss(simulation.loss_distance), *([] if approached else [approach])]
    looked_for += [contact] if (contact := lens_touched(scene)) else []
    with timed() as seconds:
        equations = bind(problem, begin)
        if begun:
            begun.check_module(equations.name)
        result = integrate(equations, times, looked_for, progress)
    motion = equations.motion(result.times, result.states)
    if result.status != "failed" and (fault := fault_at(problem, result.times, motion)):
        result = dataclasses.replace(result, status="failed", message=fault, path=None)
    budget = error_budget(equations, result, motion.position, [approach])
    attributes = {
        **_about_the_run(problem, why),
        **as_given,
        "emitted_module": equations.name,
        "method": result.method,
        **({"seed": seed or 0} if scene.draws else {}),
        "status": result.status,
        "message": result.message,
        "events": _as_text(result.events),
        "steps": result.steps,
        "rejected_steps": result.rejected,
        "force_calls": result.force_calls,
        **seconds,
        "step_time": result.step_time,
        "integration_error": budget.integration_error,
        "model_error": math.nan,
        **_end(equations, result, budget),
        **({"approached": 1} if approached else {}),
    }
    light = problem.light_along(motion.position, result.times, motion.orientation)
    run = _run(problem, result.times, motion, light, attributes)
    run = _detected(run, scene, seed or 0, times, first)
    if frames is not None and result.path is not None:
        run = _filmed(run, frames, *frames.seen(result.path, seed or 0))
    elif frames is not None and result.status != "failed":
        warn(f"{scene.name}: no camera frames, because the run has too many steps to store")
    summary = None
    with contextlib.suppress(KeyboardInterrupt):  # the run itself is complete
        if result.path is not None:
            summary = summary_of_path(run, result, budget)
            attributes["summary"] = stored(summary)
    if result.status == "failed":
        warn(f"{scene.name}: {result.message}")

    def find_errors() -> None:
        """Compute the errors of the force and of the model, and add them to the run."""
        with contextlib.suppress(KeyboardInterrupt):
            run.variables.update(force_errors(problem, result.times, motion, light))
            if result.path is not None and summary is not None:
                error = force_error_along(result.path)
                attributes["summary"] = stored(dataclasses.replace(summary, force_error=error))
            attributes["model_error"] = model_error(equations, result, motion.position)

    return run, find_errors


def _end(equations: EquationsOfMotion, result: Integration, budget: ErrorBudget) -> dict[str, str]:
    """Return the attribute with the final state, from which a run can be continued.

    The result is empty for a run without a final state.
    """
    if result.end is None:
        return {}
    finer = budget.finer.run.end if budget.finer else None
    time = float(result.times[-1])
    end = End.of(time, equations.name, result.end, finer=finer_state(finer))
    return as_attribute(end)


def _as_text(events: Sequence[Occurrence]) -> str:
    """Return events as JSON for the attribute of a run: name, time (s), position (m) and, for an
    event of poses, Euler parameters.
    """
    return json.dumps([
        {"name": event.name, "time": event.time, "position": event.state[POSITION].tolist()}
        | ({} if event.orientation is None else {"orientation": event.orientation.tolist()})
        for event in events
    ])  # fmt: skip


@dataclass
class _Followed:
    """Run with thermal motion (trajectory 0 of a `Walk`), as far as it has been computed."""

    bound: Walk
    """thermal motion: equations, scheme, steps and random numbers"""
    first: int
    """index, in the whole motion, of the first sample of this run"""
    state: Array
    """(1, state) state of the scheme at the last computed sample, advanced in place"""
    columns: Array
    """(1, samples, columns) output at the samples, filled up to `reached`"""
    watch: Watch
    """search for events during the motion"""
    reached: int = 1
    """number of samples computed so far"""
    status: str = "complete"
    message: str = ""
    step_time: float = 0.0
    """time of the steps, s"""
    seen: list[Array] = dataclasses.field(default_factory=list)
    """positions in the frames of a camera, (frames, axes), m, for each piece of the motion"""

    def __post_init__(self) -> None:
        """Set the times of the samples, s, and the number of force calls per sample."""
        self.times = self.bound.times[self.first :]
        self.end: Array | None = self.state.copy()  # None if the bead reached the mirror
        self.calls = self.bound.per_sample * self.bound.scheme.force_calls

    @classmethod
    def begin(cls, bound: Walk, begun: Continued | None, events: Sequence[Event]) -> _Followed:
        """Return a run at its initial state: the release, or the end of the run it continues."""
        first = begun.sample if begun else 0
        state = bound.start(np.zeros(1, np.int64))
        columns = np.empty((1, len(bound.times) - first, bound.shown.width))
        columns[:, 0] = bound.seen(state)
        if begun:
            bound.go_on(begun, state[0])
            columns[:, 0] = begun.begin.state
        return cls(bound, first, state, columns, Watch(events, columns[0, 0], bound.shown))

    @property
    def lost(self) -> float:
        """Time at which the bead was lost, s; infinite if it was not."""
        return float(self.bound.lost(self.state)[0])

    def follow(self, progress: Callable[[float], None] | None, *, watched: bool) -> None:
        """Compute the motion until its end, a loss, an event, an interrupt or a failure.

        `progress` is called with the time reached, s. Events are searched if `watched`.
        """
        times, samples = self.times, len(self.times)
        at_once = max(1, _STEPS_AT_ONCE // self.bound.per_sample)
        affordable = self.bound.scene.simulation.most_force_calls // max(self.calls, 1)
        try:
            while self.reached < samples and np.isinf(self.lost) and not self.watch.status:
                if self.reached > affordable:
                    raise IntegrationError("simulation.most_force_calls is reached")
                last = min(self.reached + at_once, samples, affordable + 1)
                with timed() as stepping:
                    self._step(last, watched=watched)
                self.step_time += stepping["wall_time"]
                before = self.reached
                front = int(self.bound.before_mirror(self.columns[:, before:last])[0])
                self.reached, self.end = before + front, self.state.copy()
                if self.reached < last:
                    self.end = None
                    self._keep_frames(before)
                    raise IntegrationError(f"trajectory 0: {AT_MIRROR}")
                if progress:
                    progress(float(times[last - 1]))
        except KeyboardInterrupt:
            if self.reached == 1:  # interrupted during compilation, for example
                raise
            self.status = "interrupted"
            self.message = f"interrupted at {times[self.reached - 1]:.6g} s"
        except IntegrationError as error:
            self.status = "failed"
            self.message = f"failed after {times[self.reached - 1]:.6g} s: {error}"
        if np.isfinite(lost := self.lost):
            self.status, self.message = "lost", f"the bead left the trap at {lost:.6g} s"
            if self.bound.loss_caveat:
                self.message += f"; {self.bound.loss_caveat}"
            self.reached = int(np.isfinite(self.columns[0, : self.reached, POSITION.start]).sum())

    def _step(self, last: int, *, watched: bool) -> None:
        """Compute the samples from `reached` up to index `last`; search events if `watched`."""
        trajectory, piece = np.zeros(1, np.int64), self.columns[:, self.reached : last]
        at = self.first + self.reached - 1
        if not watched:
            self.seen.append(self.bound.filmed(self.state, trajectory, at, piece)[0])
            return
        ends, steps = self.bound.advance_by_steps(self.state, trajectory, at, piece)
        held = int(np.isfinite(steps[0, :, POSITION.start]).sum())  # until the bead was lost
        held = min(held, int(self.bound.before_mirror(steps)[0]))
        self.watch.look(Line(ends[:held], steps[0, :held]))

    def _keep_frames(self, before: int) -> None:
        """Remove the camera frames after the last sample from those after `before` samples."""
        first, last = (self.bound.frames(self.first + each - 1) for each in (before, self.reached))
        if self.seen:
            self.seen[-1] = self.seen[-1][: last - first]

    def cut(self) -> tuple[Array, Array]:
        """Return times (n,), s, and output (n, columns) of the run until an event that ended it."""
        times, samples = self.times, self.columns[0, : self.reached]
        if self.watch.last is not None:
            self.status, self.message = self.watch.status, self.watch.message
            ended, there = self.watch.last
            self.reached = int(np.searchsorted(times[: self.reached], ended, side="right"))
            times, samples = times[: self.reached], self.columns[0, : self.reached]
            if times[-1] < ended:
                times = np.append(times, ended)
                samples = np.vstack([samples, there])
        return times[: len(samples)], samples


def _thermal_run(
    problem: Problem,
    seed: int,
    progress: Callable[[float], None] | None,
    as_given: dict[str, Any],
    begun: Continued | None,
    events: Sequence[Event],
) -> tuple[Run, Callable[[], None]]:
    """Return the run with thermal motion, trajectory 0 of the ensemble with the same seed.

    The second result is a function that adds missing errors to a run, as for `motion_of`; here it
    does nothing. `begun` is the run that this one continues, or None.
    """
    from tweezer.dynamics.walk import walk

    with timed() as seconds:
        bound = walk(problem, seed, begun.end.steps if begun else 1)
        bound.warn_of_bias()
        if events:
            check(bound.problem, WATCHED)
        run_of = _Followed.begin(bound, begun, events)
        run_of.follow(progress, watched=bool(events))
    times, samples = run_of.cut()
    motion = bound.motion(samples)
    if run_of.status != "failed" and (fault := fault_at(bound.problem, times, motion)):
        run_of.status, run_of.message = "failed", fault
    end = None
    if run_of.watch.last is None and run_of.end is not None:
        end = bound.end(float(times[-1]), samples[-1], run_of.end[0])
    model, inertia = bound.scene.simulation.model, bound.scene.medium.inertia
    all_inertia = model == "full" and inertia == "memory" and bound.scene.wall is None
    attributes = {
        **_about_the_run(bound.problem, bound.why),
        **as_given,
        "emitted_module": "langevin",
        "method": bound.scene.simulation.method,
        "seed": seed,
        "step": bound.step,
        **({} if bound.variance_bias is None else {"variance_bias": bound.variance_bias}),
        **({"loss_caveat": bound.loss_caveat} if bound.loss_caveat else {}),
        "status": run_of.status,
        "message": run_of.message,
        "events": _as_text(run_of.watch.happened),
        **({"event_resolution": bound.step} if events else {}),
        "steps": (run_of.reached - 1) * bound.per_sample,
        "rejected_steps": 0,
        "force_calls": (run_of.reached - 1) * run_of.calls,
        **seconds,
        "step_time": run_of.step_time,
        "integration_error": math.nan,
        "model_error": 0.0 if all_inertia else math.nan,
        **as_attribute(end),
    }
    if run_of.status == "failed":
        warn(f"{bound.scene.name}: {run_of.message}")
    _warn_of_sticking(bound, motion)
    light = light_on(bound.problem, times, motion)
    run = _run(bound.problem, times, motion, light, attributes)
    run.variables.update(force_errors(bound.problem, times, motion, light))
    run = _detected(run, bound.scene, seed, run_of.times, run_of.first)
    if bound.exposure is None:
        return run, lambda: None
    frames = bound.exposure.frames
    places = np.concatenate([np.empty((0, len(frames.camera.axes))), *run_of.seen])
    held = int(np.isfinite(places).all(axis=1).sum())  # until the bead was lost
    return _filmed(run, frames, frames.times[:held], places[:held]), lambda: None


def _warn_of_sticking(bound: Walk, motion: Motion) -> None:
    """Warn if steps are too long for a bead that touched the wall: it may detach wrongly."""
    from tweezer.dynamics.beside_wall import rate_of_sticking

    rate = rate_of_sticking(bound.problem)
    if rate * bound.step > 1 and bound.scene.room(motion.position[:, 2]).min() < _TOUCHING:
        warn(
            f"{bound.scene.name}: the bead touched the wall, where van der Waals forces require "
            f"steps of at most {1 / rate:.1g} s; with {bound.step:.1g} s it may detach wrongly"
        )


def _run(
    problem: Problem,
    times: Array,
    motion: Motion,
    light: Wrench,
    attributes: dict[str, Any],
) -> Run:
    """Return a run with motion and derived quantities at `times`, (n,), s.

    `light` is the optical force at these times.
    """
    coordinates: dict[str, Variable] = {
        "time": variable(("time",), times, "s", "time since release"),
    }
    variables: dict[str, Variable] = {}
    for name, each in QUANTITIES.items():
        if (values := getattr(motion, name)) is not None:
            dimensions = "time", each.dimension
            variables[name] = variable(dimensions, values, each.unit, each.long_name)
            coordinates[each.dimension] = (each.dimension,), *each.coordinate
    variables |= derived_quantities(problem, times, motion, light)
    return Run(coordinates, variables, attributes)


def _filmed(run: Run, frames: Frames, times: Array, places: Array) -> Run:
    """Return a run with the positions that its camera recorded.

    `times` (frames,), s, are the middles of the exposures, and `places` is (frames, axes), m.
    """
    coordinates: dict[str, Variable] = {
        "frame_time": variable(
            ("frame",), times, "s", "time since release, middle of the exposure"
        ),
        "seen_axis": (
            ("seen_axis",),
            np.array(frames.camera.axes),
            {"long_name": "axis of a frame"},
        ),
    }
    seen = variable(("frame", "seen_axis"), places, "m", "position that the camera saw")
    return Run(run.coordinates | coordinates, run.variables | {"seen": seen}, run.attributes)


def _detected(run: Run, scene: Scene, seed: int, times: Array, first: int) -> Run:
    """Return a run with the signals of its scene's detector, if there is one.

    `times` (n,), s, are the even times of all samples, and `first` is the number of the first.
    """
    if scene.detector is None:
        return run
    from tweezer.dynamics.detector import Signals

    signals, places = Signals.of(scene, seed, times), run.variables["position"][1]
    values = signals.recorded(places[None], np.zeros(1, np.int64), first)[0]
    names = np.array(["x", "y", "z"])
    channel: Variable = (("channel",), names, {"long_name": "signal of the detector"})
    signal = variable(("time", "channel"), values, "W", "signal of the detector")
    return Run(
        run.coordinates | {"channel": channel}, run.variables | {"signal": signal}, run.attributes
    )


def _about_the_run(problem: Problem, why: str) -> dict[str, Any]:
    """Return the attributes of every run; `why`: reason for the choice of model and method."""
    scene, medium = problem.scene, problem.scene.medium
    remembered = f", {medium.poles} poles" if medium.inertia == "memory" else ""
    others: dict[str, Any] = {}
    if problem.others:
        others = {"other_forces": len(problem.others), "forces_from": origins_of(problem.others)}
    return {
        "title": scene.title,
        "scene": scene.model_dump_json(exclude_none=True),
        "model": scene.simulation.model,
        "fluid_inertia": f"{medium.inertia or 'none'}{remembered}",
        "force_evaluator": evaluators_of(scene),
        **others,
        **worth_attributes(scene),
        "chosen": why,
        **versions(),
        **made_by("simulate", dated=True),
    }


def _adjusted(
    scene: Scene,
    duration: QuantityLike | None,
    model: str | None,
    method: str | None,
    tolerance: float | None,
) -> Scene:
    """Return a scene in which the arguments of `simulate` that are given replace its own keys."""
    given = {"duration": duration, "model": model, "method": method}
    changes: dict[str, object] = {key: each for key, each in given.items() if each is not None}
    if tolerance is not None:
        simulation = scene.simulation
        ratio = in_si("tolerance", tolerance, "", 1e-13, 0.1) / simulation.relative_tolerance
        changes |= {
            "relative_tolerance": tolerance,
            "position_tolerance": simulation.position_tolerance * ratio,
            "orientation_tolerance": simulation.orientation_tolerance * ratio,
        }
    return scene.replace(simulation=changes) if changes else scene
