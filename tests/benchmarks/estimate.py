"""The estimate of the integration's error beside the truth, over random scenes.

A bead of random size, place and power, by rays or by waves (by map), with all its inertia, the
thesis's scaling or none, is followed at a random tolerance. Its `integration_error` is compared
with its largest distance to the same equations integrated at the tightest tolerance. A truth that
is wanted to its last digits is itself known to some error: its difference from one at ten times its
tolerance, and rounding. Scenes whose error is below ten times that are counted apart.

`python -m tests.benchmarks.estimate 300 20`, of scenes and a seed, prints the distribution and the
scenes that break it.
"""

from __future__ import annotations

import sys
import time
import warnings
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

import tweezer
from tweezer.dynamics import bind, integrate
from tweezer.dynamics.budget import error_budget
from tweezer.dynamics.models import EquationsOfMotion
from tweezer.dynamics.problem import Problem, bound_once
from tweezer.scene import Scene

Array = NDArray[np.float64]
Results = dict[str, Any]

#: Number of random scenes, and of those of a quick run
SCENES, QUICK = 300, 10
#: Least estimate over error, and largest in the median
LEAST, MEDIAN = 1.0 / 3.0, 30.0
#: Radii of beads by waves, whose map is of one size, m
_RADII = tuple(np.geomspace(0.1e-6, 1e-6, 6).round(8).tolist())
#: Reach of the maps, radii
_REACH = 8.0
_TRUTH = 1e-13
#: Number of times at which runs are compared
_TIMES = 2001
#: Error over that of the truth from which the truth is known well enough
_KNOWN = 10.0
#: Rounding of a place in many steps, as a part of it
_ROUNDING = 1e-14
_SEED = 20


def _changes(rng: np.random.Generator) -> tuple[Results, float]:
    """Changes of the scene of a silica bead, and its tolerance."""

    def decades(low: float, high: float) -> float:
        return float(10 ** rng.uniform(np.log10(low), np.log10(high)))

    theory = str(rng.choice(["rays", "waves"]))
    radius = decades(0.1e-6, 3e-6)
    if theory == "waves":
        radius = float(rng.choice(_RADII))
    direction = rng.normal(size=3)
    place = direction / np.linalg.norm(direction) * decades(0.05, 6.0) * radius
    model = str(rng.choice(["full", "scaled", "overdamped"]))
    tolerance = decades(1e-9, 1e-5)
    return {
        "bead": {"radius": radius},
        "beam": {"power_through_pupil": decades(1e-3, 0.3), "polarisation": "circular"},
        "start": {"frame": "focus", "position": place.tolist()},
        "optics": {"theory": theory, "evaluator": "map", "table_range": _REACH,
                   "tolerance": 1e-8},
        "simulation": {
            "model": model, "scaling_factor": decades(1e-3, 1.0), "method": "exponential",
            "relative_tolerance": tolerance, "position_tolerance": 1e-6 * tolerance,
        },
    }, decades(0.3, 300.0)  # fmt: skip


def scenes(count: int, seed: int = _SEED) -> Iterator[Scene]:
    """Random scenes, followed from a part of the time in which they fall to rest to many of it."""
    rng = np.random.default_rng(seed)
    for number in range(count):
        changes, times = _changes(rng)
        scene = tweezer.load_scene("silica-1um").replace(**changes, name=f"random-{number}")
        yield scene.replace(simulation={"duration": times * _time(bound_once(scene))})


def _time(problem: Problem) -> float:
    """In which the bead passes its radius at a speed that it hardly exceeds, s."""
    return min(problem.scene.bead.radius / problem.fastest, 1.0)


def _tightly(equations: EquationsOfMotion, times: Array, tolerance: float) -> Array | None:
    problem = equations.problem.changed(
        relative_tolerance=tolerance, position_tolerance=max(1e-6 * tolerance, 1e-18)
    )
    exact = bind(problem)
    run = integrate(exact, times)
    return exact.motion(run.times, run.states).position if run.status == "complete" else None


def compared(scene: Scene) -> Results:
    """Estimate and truth of one scene."""
    equations = bind(scene)
    times = _times(scene.simulation.duration)
    run = integrate(equations, times)
    position = equations.motion(run.times, run.states).position
    told = error_budget(equations, run, position).integration_error
    simulation = scene.simulation
    exact, nearly = (_tightly(equations, times, _TRUTH * by) for by in (1.0, 10.0))
    about = {
        "scene": scene.name, "theory": scene.optics.theory, "model": simulation.model,
        "radius_um": 1e6 * scene.bead.radius, "status": run.status,
        "start_radii": float(np.linalg.norm(scene.start_position) / scene.bead.radius),
        "tolerance": simulation.relative_tolerance, "duration": simulation.duration,
        "steps": run.steps, "rejected": run.rejected, "force_calls": run.force_calls,
    }  # fmt: skip
    if exact is None or nearly is None or run.status != "complete":
        return about | {"failed": True}
    off = np.linalg.norm(position - exact, axis=1)
    known = np.linalg.norm(nearly - exact, axis=1).max()
    known = max(known, _ROUNDING * np.linalg.norm(exact, axis=1).max())
    return about | {
        "told_um": 1e6 * told, "true_um": 1e6 * float(off.max()), "known_um": 1e6 * float(known),
        "worst_at": float(times[off.argmax()]), "ratio": told / max(off.max(), 1e-300),
    }  # fmt: skip


def _times(duration: float) -> Array:
    """At which runs are compared: some soon after the release, s."""
    early = np.geomspace(1e-6, 1e-3, 200) * duration
    return np.union1d(np.linspace(0.0, duration, _TIMES), early)


def measure(count: int, say: Callable[[str], object], seed: int = _SEED) -> Results:
    """Estimates over errors of that many random scenes."""
    each = []
    with warnings.catch_warnings(action="ignore"):  # of small beads by rays, and in thin air
        for number, scene in enumerate(scenes(count, seed)):
            if number % 20 == 0:
                say(f"estimate of the error: {number} of {count} random scenes")
            each.append(compared(scene))
    return {"scenes": count, "entries": each, **verdict(each)}


def verdict(entries: list[Results]) -> Results:
    """The distribution of estimate over error, and what breaks it."""
    sound = [each for each in entries if "failed" not in each]
    told = [each for each in sound if each["true_um"] > _KNOWN * each["known_um"]]
    ratios = np.array([each["ratio"] for each in told])
    return {
        "failed": len(entries) - len(sound),
        "below_the_truth": len(sound) - len(told),
        "least": float(ratios.min()), "median": float(np.median(ratios)),
        "largest": float(ratios.max()),
        "tenth": float(np.quantile(ratios, 0.1)), "nine_tenths": float(np.quantile(ratios, 0.9)),
        "too_small": [each["scene"] for each in told if each["ratio"] < LEAST],
    }  # fmt: skip


if __name__ == "__main__":
    began = time.process_time()
    found = measure(
        int(sys.argv[1]), lambda text: print(text, file=sys.stderr), *map(int, sys.argv[2:])
    )
    for entry in found["entries"]:
        if "failed" in entry or entry["scene"] in found["too_small"]:
            print(entry)
    print({key: value for key, value in found.items() if key != "entries"})
    print(f"{time.process_time() - began:.0f} s of CPU")
