"""The thesis's search for its scaling factor a2 (4.12), and what each a2 costs and gets wrong."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tweezer.bead import bead_properties
from tweezer.dynamics import bind, integrate
from tweezer.dynamics.models import RATE_TIME
from tweezer.errors import TweezerError
from tweezer.scene import Scene

Array = NDArray[np.float64]

#: a2 looked at if none are given: so many for each decade from epsilon to 1
_PER_DECADE = 3
#: times at which the responses are compared
_SAMPLES = 201


@dataclass(frozen=True)
class Tuned:
    """One scaling factor."""

    scaling_factor: float
    """a2"""
    deviation: float | None
    """m, largest distance to the unscaled response; None if the run failed"""
    steps: int
    force_calls: int
    seconds: float
    """run time, s, compiled"""


@dataclass(frozen=True)
class Tuning:
    """The scaled response against the unscaled one, by scaling factor."""

    entries: list[Tuned]
    """by descending scaling factor"""
    duration: float
    """s, compared over"""
    method: str
    epsilon: float
    """m/beta_v (4.6) in the thesis's unit of time, 1 ms: its first guess of a2"""
    unscaled: Tuned
    """the unscaled equations by the exponential method"""

    def most_scaling_within(self, deviation: float) -> Tuned | None:
        """The entry of least a2, that is of most scaling, that deviates no more than that, m."""
        within = [
            entry
            for entry in self.entries
            if entry.deviation is not None and entry.deviation <= deviation
        ]
        return min(within, key=lambda entry: entry.scaling_factor, default=None)


def tune(
    scene: Scene,
    factors: Sequence[float] | None = None,
    *,
    duration: float | None = None,
    method: str = "dormand-prince",
    progress: Callable[[float], None] | None = None,
) -> Tuning:
    """Compare the scaled model (4.17) with the unscaled equations for a list of a2.

    factors: from epsilon to 1 if not given. duration: s, the scene's if not given; the thesis
    compares over a short time. method: of the scaled runs; the thesis's Dormand-Prince if not
    given. The unscaled response is integrated by the exponential method. progress: called with the
    part done.

    The step is by the tolerances, whatever the scene says. Raises `SceneError` for a factor outside
    1e-12 to 1, or a scene with unequal moments of inertia, which the exponential method does not
    take.
    """
    bead = bead_properties(scene)
    epsilon = bead.relaxation_time / RATE_TIME
    if factors is None:
        first = min(max(epsilon, 1e-12), 0.1)
        factors = np.geomspace(1.0, first, math.ceil(-math.log10(first) * _PER_DECADE) + 1).tolist()
    if duration is not None:
        scene = scene.replace(simulation={"duration": duration})
    times = np.linspace(0.0, scene.simulation.duration, _SAMPLES)
    same = {"step": None, "rotation_state": "angular-velocity"}
    full = {"model": "full", "method": "exponential", "scaling_factor": None, **same}
    scaled = {"model": "scaled", "method": method, **same}
    scenes = [  # all are validated before the first one runs
        scene.replace(simulation={"scaling_factor": factor, **scaled})
        for factor in sorted(factors, reverse=True)
    ]
    unscaled, exact = _response(scene.replace(simulation=full), times, 1.0)
    if unscaled.deviation is None:
        raise TweezerError(f"{scene.name}: the unscaled response could not be integrated")
    entries = []
    for changed in scenes:
        factor = changed.simulation.scaling_factor or 1.0
        entries.append(_response(changed, times, factor, exact)[0])
        if progress:
            progress(len(entries) / len(scenes))
    return Tuning(entries, float(times[-1]), method, epsilon, unscaled)


def _response(
    scene: Scene, times: Array, factor: float, exact: Array | None = None
) -> tuple[Tuned, Array]:
    """What a run costs and how far it is from `exact` (n, 3), and its positions."""
    equations = bind(scene)
    if integrate(equations, times[:2]).status == "interrupted":  # compiles, which does not count
        raise KeyboardInterrupt
    began = time.perf_counter()
    run = integrate(equations, times)
    seconds = time.perf_counter() - began
    if run.status == "interrupted":
        raise KeyboardInterrupt
    positions = equations.motion(run.times, run.states).position
    deviation: float | None = None
    if run.status == "complete":
        deviation = 0.0
        if exact is not None:
            deviation = float(np.linalg.norm(positions - exact, axis=1).max())
    return Tuned(factor, deviation, run.steps, run.force_calls, seconds), positions
