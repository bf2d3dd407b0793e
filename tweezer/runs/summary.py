"""Summary of a run: its outcome, captured or lost, with the time and the extremes of the motion."""

from __future__ import annotations

import dataclasses
import json
import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from pydantic import TypeAdapter, ValidationError

from tweezer.dynamics.budget import ErrorBudget
from tweezer.dynamics.escape import escapes, escapes_from_ring, too_shallow
from tweezer.dynamics.integrate import Integration
from tweezer.dynamics.path import Passage, Path, across_axis, distances_from, passage
from tweezer.dynamics.problem import Problem, bound_once
from tweezer.forces.force import Wrench
from tweezer.forces.rings import held_on, ring_near
from tweezer.results.io import scene_in
from tweezer.results.run import Run
from tweezer.results.schema import events_in, of_validation
from tweezer.runs import quantities as known
from tweezer.runs.outcome_of_body import CAPTURED, NOT_CAPTURED, outcome_of_body
from tweezer.values.arrays import Array
from tweezer.values.errors import ResultError
from tweezer.values.measured import Measured, Result
from tweezer.values.printed import printed, scaled, with_error
from tweezer.values.shown import Card, Row

if TYPE_CHECKING:
    import xarray as xr

    from tweezer.dynamics.poses import Rest
    from tweezer.scene import Scene


#: Largest distance of a captured bead from the equilibrium, in radii
CAPTURE_RADII = 0.1
#: Outcome of a bead that is held by a ring
ON_RING = "captured on a ring"

#: Newton's method ends after this number of steps, or after a step shorter than this fraction of
#: the allowed distance from its start
_STEPS, _CLOSE = 30, 1e-10

#: Largest number of positions on a path at which the force and its error are computed
_PLACES = 1000


@dataclass(frozen=True, repr=False)
class Summary(Result):
    """Outcome of a run.

    Without thermal motion the numbers include the motion between the samples, so they do not depend
    on the number of samples. Their errors are those of integration and of locating an event; errors
    of the model and of the force are not included.
    """

    QUANTITIES: ClassVar = known.QUANTITIES

    outcome: str
    """"captured", "captured on a ring", "lost" or "not captured"; or the status of the run, if it
    ended early or its equilibria are not searched, because the light changed until the end or the
    run had your own forces"""
    outcome_time: float
    """time of capture, of loss, or of the end of the run, s"""
    overshoot: float
    """largest excursion beyond the beam's axis, on the side away from the start, m; NaN if the axis
    moves"""
    closest_approach: float | None
    """distance to the focus at the first closest approach (FCA), m; None if there is none"""
    closest_approach_time: float | None
    """time of the first closest approach, s; None if there is none"""
    largest_reynolds_number: float | None
    """largest Reynolds number (5.1); None for thermal motion without inertia"""
    largest_force: float
    """largest force of the light at positions along the path, N"""
    force_error: float
    """largest error of the light's force at these positions, N"""
    end: tuple[float, float, float]
    """last position, m from the focus"""
    by_samples: bool
    """whether all numbers come from the samples alone, without the motion between them. This is so
    for thermal motion, a run that failed or had too many steps to store, a part of a run, and a
    file from an older version"""
    outcome_time_error: float | None = None
    """error of `outcome_time`, s; None if not known, as for the other errors"""
    overshoot_error: float | None = None
    """error of `overshoot`, m"""
    closest_approach_error: float | None = None
    """error of `closest_approach`, m"""
    closest_approach_time_error: float | None = None
    """error of `closest_approach_time`, s"""
    largest_reynolds_number_error: float | None = None
    """error of `largest_reynolds_number`"""
    smallest_gap: float | None = None
    """smallest distance between bead and nearer wall, m; None without a wall"""
    smallest_gap_error: float | None = None
    """error of `smallest_gap`, m"""
    sought_within: float | None = None
    """distance from the last position within which an equilibrium was searched, m"""

    @property
    def untold(self) -> str:
        """Explanation of the outcome: where no equilibrium was found, or why none was searched.

        It is "" for other outcomes.
        """
        if self.outcome == NOT_CAPTURED and self.sought_within is not None:
            within = printed(self.sought_within, "um", 3)
            return f"; no stable equilibrium within {within} of its end"
        if self.outcome != "complete":
            return ""
        return "; capture is not told: the light changes until the end, or forces are your own"

    def quantities(self) -> Iterator[Measured]:
        """Yield the quantities of the summary; the run contains the error of the last position."""
        for quantity in known.QUANTITIES:
            error = self.force_error if quantity is known.LARGEST_FORCE else None
            yield quantity(
                getattr(self, quantity.name), getattr(self, f"{quantity.name}_error", error)
            )

    def words(self) -> dict[str, str]:
        """Return the outcome, and the reason if it is unknown or the bead is not captured."""
        return {"outcome": self.outcome, "reason": self.untold.removeprefix("; ")}

    def card(self) -> Card:
        """Return the card with outcome, end, approach and force."""
        doubt = "by the samples: what happens between them is not seen" if self.by_samples else ""
        force = with_error(self.largest_force, self.force_error, "pN")
        largest = "not known" if math.isnan(self.largest_force) else force
        rows = (*self.outcome_rows(doubt), *self.approach_rows(), Row("largest force", largest))
        return Card("Summary", "", rows)

    def outcome_rows(self, doubt: str = "") -> Iterator[Row]:
        """Yield the rows on the outcome, the end and the smallest gap.

        doubt: caveat of the outcome; "" for none.
        """
        when = with_error(self.outcome_time, self.outcome_time_error, "ms")
        if self.outcome == NOT_CAPTURED and self.sought_within is not None:
            yield Row("outcome", f"{self.outcome}, {when}", doubt)
            within = printed(self.sought_within, "um", 3)
            yield Row("no stable equilibrium", f"within {within} of its end")
        else:
            yield Row("outcome", f"{self.outcome}, {when}{self.untold}", doubt)
        x, y, z = (round(scaled(coordinate, "um"), 4) + 0.0 for coordinate in self.end)  # no -0.0
        yield Row("end (x, y, z)", f"{x:.4f}, {y:.4f}, {z:.4f} um from the focus")
        if self.smallest_gap is not None:
            gap = with_error(self.smallest_gap, self.smallest_gap_error, "um")
            yield Row("smallest gap to the wall", gap)

    def approach_rows(self) -> Iterator[Row]:
        """Yield the rows on the overshoot, the first closest approach and the Reynolds number."""
        if not math.isnan(self.overshoot):
            overshoot = with_error(self.overshoot, self.overshoot_error, "um")
            yield Row("overshoot past the axis", overshoot)
        approach = "none"
        if self.closest_approach is not None and self.closest_approach_time is not None:
            distance = with_error(self.closest_approach, self.closest_approach_error, "um")
            at = with_error(self.closest_approach_time, self.closest_approach_time_error, "ms")
            approach = f"{distance} at {at}"
        yield Row("first closest approach", approach)
        if self.largest_reynolds_number is not None:
            number = self.largest_reynolds_number, self.largest_reynolds_number_error
            yield Row("largest Reynolds number", with_error(*number, ""))


def summarise(run: xr.Dataset) -> Summary:
    """Return the summary of a run of `tweezer.simulate`.

    The outcomes are:

    * captured: the last position is within a tenth of the bead radius of a stable equilibrium,
      which is located by Newton's method for all forces except drag. The capture time is the time
      after which the bead stays there. The stability of the equilibrium takes the scene's inertia
      into account.
    * captured: the last pose of a body that is no sphere is within a tenth of its radius, and of
      a radian, of a stable equilibrium. The body may rotate steadily there.
    * captured on a ring: the last position is as close to a ring around the beam axis, on which the
      light holds the bead, at rest or in motion around the axis.
    * complete: the light moves or changes until the end, so there is no fixed equilibrium.

    With thermal motion, a bead leaves this neighbourhood many times. It is captured if its mean
    position over the last tenth of the run is within its radius of the equilibrium. The capture
    time is then the time of the first approach to a tenth of its radius. A bead that rests on a
    wall without another equilibrium is not captured. The first closest approach is the first local
    minimum of the distance to the focus.

    A run stores the summary of its motion between the samples. For a run without it, or a part of a
    run, the summary uses the samples alone, and its card reports this.

    Parameters
    ----------
    run : xarray.Dataset
        Run of `tweezer.simulate`.

    Returns
    -------
    Summary
        Outcome and its time, overshoot, closest approach and largest force.

    Examples
    --------
    >>> tweezer.summarise(tweezer.simulate("silica-1um", "2 ms")).outcome
    'captured'
    """
    return summary_of(Run.of(run))


def summary_of(run: Run) -> Summary:
    """Return the summary of a run before it becomes a dataset; `summarise` describes it."""
    times, position = run["time"], run["position"]
    if "summary" in run.attributes:
        summary = _read(run.attributes["summary"])
        begin = run.attributes.get("begin_time", 0.0)
        if times[0] == begin and summary.end == _point(position[-1]):  # the whole run, not a part
            return summary
    scene = scene_in(run.attributes)
    outcome, outcome_time, _, _ = _outcome(run, times, position, scene)
    sought = _sought(scene) if outcome == NOT_CAPTURED else None
    approach, approach_time = _closest_approach(run)
    return Summary(
        outcome=outcome,
        outcome_time=outcome_time,
        overshoot=math.nan if scene.light_moves else _overshoot(position),
        closest_approach=approach,
        closest_approach_time=approach_time,
        largest_reynolds_number=(
            float(run["reynolds_number"].max()) if "reynolds_number" in run else None
        ),
        largest_force=_largest(run["optical_force"]) if "optical_force" in run else math.nan,
        force_error=float(run["force_error"].max()) if "force_error" in run else math.nan,
        end=_point(position[-1]),
        by_samples=True,
        smallest_gap=float(run["gap"].min()) if "gap" in run else None,
        sought_within=sought,
    )


def summary_of_path(run: Run, integrated: Integration, budget: ErrorBudget) -> Summary:
    """Return the summary of a run from its path between samples, with the error of the force NaN.

    `run` has samples and attributes, `integrated` is the integration with its path, and `budget`
    contains its errors with the finer run from which the errors of events follow.
    """
    path = integrated.path
    assert path is not None
    scene = path.equations.scene
    times, position = run["time"], run["position"]
    nearby = CAPTURE_RADII * scene.body.size
    outcome, outcome_time, rest, off = _outcome(run, times, position, scene, path.equations.problem)
    here, located = passage(path, integrated.events, rest, nearby)
    errors = _errors(here, located, budget, rest, nearby)
    outcome_time_error = 0.0
    if outcome in (CAPTURED, ON_RING):
        outcome_time, outcome_time_error = here.settled, errors.settled
        if here.settled > 0:
            outcome_time_error += off / float(path.speeds(np.array([here.settled]))[0])
    elif outcome == "lost":
        away = position[-1] / np.linalg.norm(position[-1])
        outcome_time_error = budget.integration_error / abs(float(run["velocity"][-1] @ away))
    elif outcome == "ended":
        outcome_time_error = math.nan
    number = float(2 * scene.medium.density * scene.body.size / scene.medium.viscosity)  # (5.1)
    places, at = _places(path)
    overshoot = 0.0 if here.overshoot <= errors.overshoot else here.overshoot
    return Summary(
        outcome=outcome,
        outcome_time=outcome_time,
        overshoot=math.nan if scene.light_moves else overshoot,
        closest_approach=_known(here.closest_approach),
        closest_approach_time=_known(here.closest_approach_time),
        largest_reynolds_number=number * here.largest_speed,
        largest_force=_largest(_light_along(path, places, at).force),
        force_error=math.nan,
        end=_point(position[-1]),
        by_samples=False,
        outcome_time_error=_known(outcome_time_error),
        overshoot_error=None if scene.light_moves else _known(errors.overshoot),
        closest_approach_error=_known(errors.closest_approach),
        closest_approach_time_error=_known(errors.closest_approach_time),
        largest_reynolds_number_error=_known(number * errors.largest_speed),
        smallest_gap=_known(here.smallest_gap),
        smallest_gap_error=_known(errors.smallest_gap),
        sought_within=_sought(scene) if outcome == NOT_CAPTURED else None,
    )


def stored(summary: Summary) -> str:
    """Return the attribute `summary` of a run, which `summarise` reads."""
    return json.dumps(dataclasses.asdict(summary))


def _read(text: str) -> Summary:
    """Return the summary stored in a run; raise `ResultError` if the text is not a summary."""
    try:
        return TypeAdapter(Summary).validate_json(text)
    except ValidationError as error:
        raise ResultError(f"not a run: its summary: {of_validation(error)}") from None


def _errors(
    here: Passage, located: Passage, budget: ErrorBudget, rest: Array | Rest, nearby: float
) -> Passage:
    """Return the errors of the events on a path, by comparison with a finer run; NaN without one.

    `here` contains the events of the run, `located` the errors of locating them, and `budget` the
    finer run. `rest` is the position (3,) where the bead settles, or radius and height of a ring,
    m, or a pose, and `nearby` the distance from it within which it has settled, m. Each error is
    the difference from the finer run, times the ratio of error to difference, plus both errors of
    locating.
    """
    finer = budget.finer
    if finer is None or finer.run.path is None:
        return Passage(*[math.nan] * len(here))
    there, also = passage(finer.run.path, finer.run.events, rest, nearby)
    ratio = finer.error_per_difference
    return Passage(*(
        ratio * abs(a - b) + by + by_too
        for a, b, by, by_too in zip(here, there, located, also, strict=True)
    ))  # fmt: skip


def force_error_along(path: Path) -> float:
    """Return the largest error of the optical force along the path, N."""
    light = path.equations.problem.light
    places, times = _places(path)
    return float(light.error_of(places, _light_along(path, places, times), times).max())


def _light_along(path: Path, places: Array, times: Array) -> Wrench:
    """Return the force of the light at places (n, 3), m, of a path and their times (n,), s."""
    problem = path.equations.problem
    turned = path.motion(times).orientation if problem.light.oriented else None
    return problem.light_along(places, times, turned)


def _places(path: Path) -> tuple[Array, Array]:
    """Return at most 1000 positions on a path, (n, 3), m, and their times, (n,), s."""
    times = path.checkpoints
    times = times[:: -(-len(times) // _PLACES)]
    return path.positions(times), times


def _largest(vectors: Array) -> float:
    """Return the largest magnitude of vectors (n, 3)."""
    return float(np.linalg.norm(vectors, axis=1).max())


def _point(position: Array) -> tuple[float, float, float]:
    """Return an array of three coordinates as a tuple of floats."""
    x, y, z = position.tolist()
    return x, y, z


def _known(value: float) -> float | None:
    """Return a value, or None for NaN."""
    return None if math.isnan(value) else value


def _outcome(
    run: Run, times: Array, position: Array, scene: Scene, bound: Problem | None = None
) -> tuple[str, float, Array | Rest, float]:
    """Return the outcome of a run, its time, where the bead settled, and the error of that
    position.

    The time, s, follows from the samples. The position is (3,), or radius and height of a ring, m,
    and its error has the same shape. For a body that is no sphere it is a pose. `times` (n,) are in
    s and `position` (n, 3) in m. `bound` is the scene with its equations, if they are bound
    already.
    """
    if "status" not in run.attributes:
        raise ResultError("not a run: it has no attribute status")
    status, end = run.attributes["status"], float(times[-1])
    changing = scene.last_change >= end > 0
    if status != "complete" or run.attributes.get("other_forces") or changing:
        return status, end, position[-1], 0.0
    if scene.bead.shape != "sphere":
        return outcome_of_body(run, scene, CAPTURE_RADII * scene.body.size, _sought(scene))
    problem = bound or bound_once(scene)
    nearby = CAPTURE_RADII * scene.body.size
    settled = position[-max(1, len(position) // 10) :] if scene.forces.brownian else position[-1:]
    outcome, found = CAPTURED, _stable_equilibrium(problem, settled, end, _sought(scene))
    if found is None:
        outcome, found = ON_RING, _ring(problem, settled, _sought(scene))
    if found is None:
        return NOT_CAPTURED, end, settled.mean(axis=0), 0.0
    away = distances_from(found[0], position) > nearby
    if scene.forces.brownian:
        if away.all() or _too_shallow(problem, outcome, found[0]):
            return NOT_CAPTURED, end, settled.mean(axis=0), 0.0
        return outcome, float(times[away.argmin()]), *found
    last_away = int(np.flatnonzero(away)[-1]) if away.any() else -1
    return outcome, float(times[last_away + 1]), *found


def _too_shallow(problem: Problem, outcome: str, rest: Array) -> bool:
    """Return whether an equilibrium or a ring is too shallow to hold a bead in thermal motion.

    `rest` is the position (3,) of the equilibrium, or radius and height (2,) of the ring, m.
    """
    about = problem.scene, problem.search, problem.net_force
    if outcome == CAPTURED:
        on_axis = problem.symmetric and not rest[:2].any()
        return bool(too_shallow(escapes(*about, rest, symmetric=on_axis)))
    return bool(too_shallow(escapes_from_ring(*about, np.array([rest[0], 0.0, rest[1]]))))


def _sought(scene: Scene) -> float:
    """Return the distance from a run's end within which an equilibrium captures the bead, m."""
    return (1.0 if scene.forces.brownian else CAPTURE_RADII) * scene.body.size


def _stable_equilibrium(
    problem: Problem, settled: Array, time: float, reach: float
) -> tuple[Array, float] | None:
    """Return the stable equilibrium near the mean of positions, (3,), m, and its error, m.

    It is the zero of all forces except drag at `time`, s, found by Newton's method, and the last
    step is its error. `settled` (n, 3), m, are positions at the end of the run. Returns None if
    there is no equilibrium within `reach`, m, or if it is not stable.
    """
    place = settled.mean(axis=0)
    rest, step = place, np.full(3, math.inf)
    for _ in range(_STEPS):
        field = problem.field(rest[None], gradient=True, time=time)
        gradient, force = field.force_gradient[0], field.force[0] + problem.bead.weight
        if np.linalg.eigvals(gradient).real.max() >= 0:
            return None
        step = np.linalg.solve(gradient, -force)
        rest = rest + step
        if not np.linalg.norm(rest - place) < reach:
            return None
        if np.linalg.norm(step) < _CLOSE * reach:
            break
    if problem.spiral_rate(rest, -gradient) > 0:
        return None
    return rest, float(np.linalg.norm(step))


def _ring(problem: Problem, settled: Array, reach: float) -> tuple[Array, float] | None:
    """Return the ring near the mean of positions, as radius and height (2,), m, and its error, m.

    Returns None if there is no ring within `reach`, m, or if a bead does not stay on it. `settled`
    (n, 3), m, are positions at the end of the run.
    """
    if not problem.round_axis:
        return None
    start = across_axis(settled).mean(axis=0)
    if start[0] == 0.0:
        return None
    forces = problem.force, problem.net_force, problem.ring_motion
    place = ring_near(start, problem.scene.body.size, *forces, problem.light.search.known)
    if place is None or not np.linalg.norm(place - start) < reach:
        return None
    ring = held_on(place, *forces)
    if ring is None:
        return None
    return place, ring.residual / float(np.linalg.eigvals(ring.stiffness).real.min())


def _overshoot(position: Array) -> float:
    """Return the largest excursion across the axis, on the side opposite to the release, m.

    It is 0 for a release on the axis. `position` is (n, 3), m.
    """
    lateral = position[:, :2]
    distance = np.linalg.norm(lateral[0])
    if distance == 0.0:
        return 0.0
    return max(0.0, -float((lateral @ lateral[0]).min() / distance))


def _closest_approach(run: Run) -> tuple[float, float] | tuple[None, None]:
    """Return distance, m, and time, s, of the first closest approach to the focus; None without
    one.

    They come from the events of the run, or from its samples if there is no event.
    """
    for event in events_in(run.attributes):
        within = run["time"][0] <= event.time <= run["time"][-1]  # `run` may be a part of a run
        if event.name == "closest approach" and within:
            return float(np.linalg.norm(event.position)), event.time
    distance = run["distance"]
    change = np.diff(distance)
    minima = np.flatnonzero((change[:-1] < 0) & (change[1:] >= 0)) + 1
    if not minima.size:
        return None, None
    return float(distance[minima[0]]), float(run["time"][minima[0]])
