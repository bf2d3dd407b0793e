"""How a run ended: captured or lost, when, and what it passed through."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import xarray as xr

from tweezer.io import scene_of
from tweezer.optics import optical_jacobian
from tweezer.scene import Scene

#: a captured bead stays this close to where it ends, in radii
CAPTURE_RADII = 0.1


@dataclass(frozen=True)
class Summary:
    """What became of the bead. Times are resolved by the output's samples."""

    outcome: str
    """"captured", "lost", "not captured", or the status of a run that ended early"""
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
    end: tuple[float, float, float]
    """m from the focus"""


def summarise(run: xr.Dataset) -> Summary:
    """Summary of a run of `tweezer.simulate`.

    Captured: the bead ends within a tenth of its radius of a stable equilibrium of the light and
    its weight, by one Newton step; the time is from when on it stays within a tenth of its radius
    of where it ends. The first closest approach is the first local minimum of the distance to the
    focus.
    """
    times = run["time"].values
    position = run["position"].values
    outcome, outcome_time = _outcome(run, times, position)
    distance = run["distance"].values
    approach = _first_minimum(distance)
    return Summary(
        outcome=outcome,
        outcome_time=outcome_time,
        overshoot=_overshoot(position),
        closest_approach=None if approach is None else float(distance[approach]),
        closest_approach_time=None if approach is None else float(times[approach]),
        largest_reynolds_number=(
            float(run["reynolds_number"].max()) if "reynolds_number" in run else None
        ),
        end=tuple(float(coordinate) for coordinate in position[-1]),  # type: ignore[arg-type]
    )


def _outcome(run: xr.Dataset, times: np.ndarray, position: np.ndarray) -> tuple[str, float]:
    status = run.attrs["status"]
    if status != "complete":
        return status, float(times[-1])
    scene = scene_of(run)
    nearby = CAPTURE_RADII * scene.bead.radius
    if not _distance_to_stable_equilibrium(scene, run) < nearby:
        return "not captured", float(times[-1])
    away = np.linalg.norm(position - position[-1], axis=1) > nearby
    last_away = int(np.flatnonzero(away)[-1]) if away.any() else -1
    return "captured", float(times[last_away + 1])


def _distance_to_stable_equilibrium(scene: Scene, run: xr.Dataset) -> float:
    """Length of the Newton step from the end of the run to where no force is left; infinite if
    the forces there do not drive the bead back from every side.
    """
    gradient = optical_jacobian(scene, run["position"].values[-1])
    if np.linalg.eigvalsh(gradient + gradient.T).max() >= 0:
        return math.inf
    return float(np.linalg.norm(np.linalg.solve(gradient, run["net_force"].values[-1])))


def _overshoot(position: np.ndarray) -> float:
    """Largest lateral excursion against the direction of the start; 0 for a start on the axis."""
    lateral = position[:, :2]
    distance = np.linalg.norm(lateral[0])
    if distance == 0.0:
        return 0.0
    return max(0.0, -float((lateral @ lateral[0]).min() / distance))


def _first_minimum(distance: np.ndarray) -> int | None:
    change = np.diff(distance)
    minima = np.flatnonzero((change[:-1] < 0) & (change[1:] >= 0)) + 1
    return int(minima[0]) if minima.size else None
