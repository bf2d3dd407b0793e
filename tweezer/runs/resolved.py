"""Test whether the samples of a run resolve its motion."""

from __future__ import annotations

import numpy as np

from tweezer.fluid import drag
from tweezer.optics import light_force
from tweezer.results.io import scene_in
from tweezer.results.run import Run


def resolved(run: Run) -> bool:
    """Return whether the sampling interval is shorter than the relaxation time of the trap.

    The relaxation time is computed at both ends of the run.
    """
    scene, time, position = scene_in(run.attributes), run["time"], run["position"]
    if len(time) < 2:
        return False
    ends = position[[0, -1]]
    gradient = light_force(scene).field(ends, gradient=True, time=time[[0, -1]]).force_gradient
    mobility = drag(scene).mobilities(ends).value[:, :2].max(axis=1)
    if not (np.isfinite(gradient).all() and np.isfinite(mobility).all()):
        return False  # farther from the light than any bead
    rates = np.linalg.norm(gradient, ord=2, axis=(1, 2)) * mobility
    return bool((time[1] - time[0]) * rates.max() < 1)
