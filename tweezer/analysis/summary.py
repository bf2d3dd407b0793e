"""How a run ended: captured or lost, when, and what it passed through."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from tweezer.bead import bead_properties
from tweezer.io import scene_of
from tweezer.optics import optical_force, optical_jacobian
from tweezer.scene import Scene

Array = NDArray[np.float64]

#: a captured bead stays this close to where it ends, in radii
CAPTURE_RADII = 0.1


@dataclass(frozen=True)
class Summary:
    """What became of the bead. Times are resolved by the output's samples, but for the first
    closest approach where the run has located it.
    """

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
    of where it ends. In thermal motion, which leaves that neighbourhood again and again: the mean
    of the last tenth of the run is within its radius of the equilibrium, and the time is when the
    bead first came within a tenth of its radius of it. The first closest approach is the first
    local minimum of the distance to the focus: the event of the run, or in thermal motion, which
    has no events, a sample.
    """
    times = run["time"].values
    position = run["position"].values
    outcome, outcome_time = _outcome(run, times, position)
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
        end=tuple(float(coordinate) for coordinate in position[-1]),  # type: ignore[arg-type]
    )


def _outcome(run: xr.Dataset, times: np.ndarray, position: np.ndarray) -> tuple[str, float]:
    status = run.attrs["status"]
    if status != "complete":
        return status, float(times[-1])
    scene = scene_of(run)
    nearby = CAPTURE_RADII * scene.bead.radius
    if scene.forces.brownian:
        settled = position[-max(1, len(position) // 10) :].mean(axis=0)
        force = optical_force(scene, settled) + bead_properties(scene).weight
        step = _to_stable_equilibrium(scene, settled, force)
        near = np.linalg.norm(position - (settled + step), axis=1) < nearby
        if not (np.linalg.norm(step) < scene.bead.radius and near.any()):
            return "not captured", float(times[-1])
        return "captured", float(times[near.argmax()])
    step = _to_stable_equilibrium(scene, position[-1], run["net_force"].values[-1])
    if not np.linalg.norm(step) < nearby:
        return "not captured", float(times[-1])
    away = np.linalg.norm(position - position[-1], axis=1) > nearby
    last_away = int(np.flatnonzero(away)[-1]) if away.any() else -1
    return "captured", float(times[last_away + 1])


def _to_stable_equilibrium(scene: Scene, place: Array, force: Array) -> Array:
    """The Newton step from a place, where the net force is that, to where no force is left;
    infinite if the forces there do not drive the bead back from every side.
    """
    gradient = optical_jacobian(scene, place)
    if np.linalg.eigvalsh(gradient + gradient.T).max() >= 0:
        return np.full(3, math.inf)
    return np.linalg.solve(gradient, -force).astype(float)


def _overshoot(position: np.ndarray) -> float:
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
