"""How a run ended: captured or lost, when, and what it passed through."""

from __future__ import annotations

import dataclasses
import json
import math
from dataclasses import dataclass

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from tweezer.bead import bead_properties
from tweezer.dynamics.budget import ErrorBudget
from tweezer.dynamics.integrate import Integration
from tweezer.dynamics.path import Passage, Path, passage
from tweezer.io import scene_of
from tweezer.optics import optical_force, optical_jacobian
from tweezer.scene import Scene

Array = NDArray[np.float64]

#: a captured bead stays this close to the equilibrium, in radii
CAPTURE_RADII = 0.1

#: most places of a path at which the force and its error are looked at
_PLACES = 1000


@dataclass(frozen=True)
class Summary:
    """What became of the bead.

    Of a run without thermal motion the numbers are those of the motion between the samples too,
    and do not depend on how many there are. Their errors are those of the integration and of
    locating; what the model and the force are off comes besides.
    """

    outcome: str
    """"captured", "lost", "not captured", or the status of a run that ended early, or with forces
    of your own, of which the summary knows no equilibrium"""
    outcome_time: float
    """s: when it was captured, when it left the trap, or when the run ended"""
    overshoot: float
    """m: how far it went past the beam's axis, on the side away from the start"""
    closest_approach: float | None
    """m: distance to the focus at the first closest approach (FCA); None if there is none"""
    closest_approach_time: float | None
    """s"""
    largest_reynolds_number: float | None
    """None for thermal motion without inertia"""
    largest_force: float
    """N, of the light, at places along the path"""
    force_error: float
    """N, the largest error of the light's force at these places"""
    end: tuple[float, float, float]
    """m from the focus"""
    by_samples: bool
    """whether all this is of the output's samples alone, and what happened between them is missed:
    thermal motion, a run that failed or has too many steps to be held, a part of a run, a file of
    an older version"""
    outcome_time_error: float | None = None
    """s; None where it is not known, as are the others"""
    overshoot_error: float | None = None
    """m"""
    closest_approach_error: float | None = None
    """m"""
    closest_approach_time_error: float | None = None
    """s"""
    largest_reynolds_number_error: float | None = None


def summarise(run: xr.Dataset) -> Summary:
    """Summary of a run of `tweezer.simulate`.

    Captured: the bead ends within a tenth of its radius of a stable equilibrium of the light and
    its weight, by one Newton step; the time is from when on it stays that near to it. In thermal
    motion, which leaves that neighbourhood again and again: the mean of the last tenth of the run
    is within its radius of the equilibrium, and the time is when the bead first came within a tenth
    of its radius of it. The first closest approach is the first local minimum of the distance to
    the focus.

    The run holds what its motion between the samples shows; where it does not, the summary is by
    the samples alone, and says so, as is that of a part of the run.
    """
    times = run["time"].values
    position = run["position"].values
    if "summary" in run.attrs:
        summary = _read(run.attrs["summary"])
        if times[0] == 0 and summary.end == _point(position[-1]):  # not of a part of the run
            return summary
    outcome, outcome_time, _ = _outcome(run, times, position)
    approach, approach_time = _closest_approach(run)
    return Summary(
        outcome=outcome,
        outcome_time=outcome_time,
        overshoot=_overshoot(position),
        closest_approach=approach,
        closest_approach_time=approach_time,
        largest_reynolds_number=(
            float(run["reynolds_number"].max()) if "reynolds_number" in run else None
        ),
        largest_force=_largest(run["optical_force"].values) if "optical_force" in run else math.nan,
        force_error=float(run["force_error"].max()) if "force_error" in run else math.nan,
        end=_point(position[-1]),
        by_samples=True,
    )


def summary_of_path(run: xr.Dataset, integrated: Integration, budget: ErrorBudget) -> str:
    """The attribute `summary` of a run, which `summarise` reads.

    run: the dataset without it. integrated: the run, with its path.
    """
    path = integrated.path
    assert path is not None
    scene = path.equations.scene
    times, position = run["time"].values, run["position"].values
    nearby = CAPTURE_RADII * scene.bead.radius
    outcome, outcome_time, rest = _outcome(run, times, position)
    here, located = passage(path, integrated.events, rest, nearby)
    errors = _errors(here, located, budget, rest, nearby)
    outcome_time_error = 0.0
    if outcome == "captured":
        outcome_time, outcome_time_error = here.settled, errors.settled
    elif outcome == "lost":
        away = position[-1] / np.linalg.norm(position[-1])
        outcome_time_error = budget.integration_error / abs(
            float(run["velocity"].values[-1] @ away)
        )
    elif outcome == "ended":
        outcome_time_error = math.nan
    number = float(2 * scene.medium.density * scene.bead.radius / scene.medium.viscosity)  # (5.1)
    largest_force, force_error = _force(path)
    found = Summary(
        outcome=outcome,
        outcome_time=outcome_time,
        overshoot=here.overshoot,
        closest_approach=_known(here.closest_approach),
        closest_approach_time=_known(here.closest_approach_time),
        largest_reynolds_number=number * here.largest_speed,
        largest_force=largest_force,
        force_error=force_error,
        end=_point(position[-1]),
        by_samples=False,
        outcome_time_error=_known(outcome_time_error),
        overshoot_error=_known(errors.overshoot),
        closest_approach_error=_known(errors.closest_approach),
        closest_approach_time_error=_known(errors.closest_approach_time),
        largest_reynolds_number_error=_known(number * errors.largest_speed),
    )
    return json.dumps(dataclasses.asdict(found))


def _read(text: str) -> Summary:
    values = json.loads(text)
    return Summary(**{**values, "end": tuple(values["end"])})


def _errors(
    here: Passage, located: Passage, budget: ErrorBudget, rest: Array, nearby: float
) -> Passage:
    """By the differences from the finer run; NaN where there is none."""
    finer = budget.finer
    if finer is None or finer.run.path is None:
        return Passage(*[math.nan] * len(here))
    there, also = passage(finer.run.path, finer.run.events, rest, nearby)
    ratio = finer.error_per_difference
    return Passage(*(
        ratio * abs(a - b) + by + by_too
        for a, b, by, by_too in zip(here, there, located, also, strict=True)
    ))  # fmt: skip


def _force(path: Path) -> tuple[float, float]:
    """Largest force of the light along the path, and largest error of it, N."""
    times = path.checkpoints
    times = times[:: -(-len(times) // _PLACES)]
    places = path.positions(times)
    bound = path.equations.problem.light
    field = bound.field(places, time=times)
    return _largest(field.force), float(bound.error_of(places, field, times).max())


def _largest(vectors: Array) -> float:
    return float(np.linalg.norm(vectors, axis=1).max())


def _point(position: Array) -> tuple[float, float, float]:
    x, y, z = position.tolist()
    return x, y, z


def _known(value: float) -> float | None:
    return None if math.isnan(value) else value


def _outcome(run: xr.Dataset, times: Array, position: Array) -> tuple[str, float, Array]:
    """What became of the bead, when by the samples, s, and where it settled, (3,) m."""
    status = run.attrs["status"]
    if status != "complete" or run.attrs.get("other_forces"):
        return status, float(times[-1]), position[-1]
    scene = scene_of(run)
    nearby = CAPTURE_RADII * scene.bead.radius
    if scene.forces.brownian:
        settled = position[-max(1, len(position) // 10) :].mean(axis=0)
        light_force = optical_force(scene, settled, time=times[-1])
        force = light_force + bead_properties(scene).weight
        step = _to_stable_equilibrium(scene, settled, times[-1], force)
        near = np.linalg.norm(position - (settled + step), axis=1) < nearby
        if not (np.linalg.norm(step) < scene.bead.radius and near.any()):
            return "not captured", float(times[-1]), settled
        return "captured", float(times[near.argmax()]), settled + step
    last = run["net_force"].values[-1]
    step = _to_stable_equilibrium(scene, position[-1], times[-1], last)
    if not np.linalg.norm(step) < nearby:
        return "not captured", float(times[-1]), position[-1]
    rest = position[-1] + step
    away = np.linalg.norm(position - rest, axis=1) > nearby
    last_away = int(np.flatnonzero(away)[-1]) if away.any() else -1
    return "captured", float(times[last_away + 1]), rest


def _to_stable_equilibrium(scene: Scene, place: Array, time: float, force: Array) -> Array:
    """The Newton step from a place, where the net force is that, to where no force is left.

    time: s. Infinite if the forces there do not drive the bead back from every side.
    """
    gradient = optical_jacobian(scene, place, time=time)
    if np.linalg.eigvalsh(gradient + gradient.T).max() >= 0:
        return np.full(3, math.inf)
    return np.linalg.solve(gradient, -force).astype(float)


def _overshoot(position: Array) -> float:
    """Largest lateral excursion against the direction of the start; 0 for a start on the axis."""
    lateral = position[:, :2]
    distance = np.linalg.norm(lateral[0])
    if distance == 0.0:
        return 0.0
    return max(0.0, -float((lateral @ lateral[0]).min() / distance))


def _closest_approach(run: xr.Dataset) -> tuple[float, float] | tuple[None, None]:
    """Distance, m, and time, s, of the first closest approach; None where there is none."""
    for event in json.loads(run.attrs.get("events", "[]")):
        if event["name"] == "closest approach":
            return float(np.linalg.norm(event["position"])), event["time"]
    distance = run["distance"].values
    change = np.diff(distance)
    minima = np.flatnonzero((change[:-1] < 0) & (change[1:] >= 0)) + 1
    if not minima.size:
        return None, None
    return float(distance[minima[0]]), float(run["time"].values[minima[0]])
