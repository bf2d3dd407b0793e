"""How a run ended: captured or lost, when, and what it passed through."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr

from tweezer.io import scene_of

#: a captured bead stays this close to where it ends, in radii
CAPTURE_RADII = 0.1
#: and its net force has fallen to this part of the largest in the run
REST_FORCE = 1e-2


@dataclass(frozen=True)
class Summary:
    """What became of the bead. Times are resolved by the output's samples."""

    outcome: str
    """"captured", "lost", "still moving", or the status of a run that ended early"""
    outcome_time: float
    """s: when it was captured, left the trap, or when the run ended"""
    overshoot: float
    """m: how far it went past the beam's axis, on the side away from the start"""
    closest_approach: float
    """m: smallest distance to the focus at the first closest approach (FCA)"""
    closest_approach_time: float
    """s"""
    largest_reynolds_number: float
    end: tuple[float, float, float]
    """m from the focus"""


def summarise(run: xr.Dataset) -> Summary:
    """Summary of a run of `tweezer.simulate`.

    Captured: at the end the net force has fallen below a hundredth of its largest value; the
    time is from when on the bead stays within a tenth of its radius of where it ends. The first
    closest approach is the first local minimum of the distance to the focus, or its last value
    if it has none.
    """
    times = run["time"].values
    position = run["position"].values
    outcome, outcome_time = _outcome(run, times, position)
    approach = _first_minimum(run["distance"].values)
    return Summary(
        outcome=outcome,
        outcome_time=outcome_time,
        overshoot=_overshoot(position),
        closest_approach=float(run["distance"][approach]),
        closest_approach_time=float(times[approach]),
        largest_reynolds_number=float(run["reynolds_number"].max()),
        end=tuple(float(coordinate) for coordinate in position[-1]),  # type: ignore[arg-type]
    )


def _outcome(run: xr.Dataset, times: np.ndarray, position: np.ndarray) -> tuple[str, float]:
    status = run.attrs["status"]
    if status != "complete":
        return status, float(times[-1])
    force = np.linalg.norm(run["net_force"].values, axis=1)
    if force[-1] >= REST_FORCE * force.max():
        return "still moving", float(times[-1])
    radius = scene_of(run).bead.radius
    away = np.linalg.norm(position - position[-1], axis=1) > CAPTURE_RADII * radius
    last_away = int(np.flatnonzero(away)[-1]) if away.any() else -1
    return "captured", float(times[last_away + 1])


def _overshoot(position: np.ndarray) -> float:
    """Largest lateral excursion against the direction of the start; 0 for a start on the axis."""
    lateral = position[:, :2]
    distance = np.linalg.norm(lateral[0])
    if distance == 0.0:
        return 0.0
    return max(0.0, -float((lateral @ lateral[0]).min() / distance))


def _first_minimum(distance: np.ndarray) -> int:
    rising = np.flatnonzero(np.diff(distance) > 0)
    falling_before = rising[rising > 0]
    return int(falling_before[0]) if falling_before.size else len(distance) - 1
