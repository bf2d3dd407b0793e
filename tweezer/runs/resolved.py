"""Test whether the samples of a run resolve its motion."""

from __future__ import annotations

import numpy as np

from tweezer.dynamics.body import BodyMotion, body_motion
from tweezer.fluid import drag
from tweezer.optics import light_force
from tweezer.optics.heat import heated
from tweezer.results.io import scene_in
from tweezer.results.run import Run
from tweezer.scene import Scene
from tweezer.scene.bead import bead_properties
from tweezer.values.arrays import Array


def resolved(run: Run) -> bool:
    """Return whether the sampling interval is shorter than the relaxation time of the trap.

    The relaxation time is computed at both ends of the run. For a body that is not a sphere it is
    the shortest one of position and orientation. For a sphere that oscillates it is sqrt(m/k).
    """
    scene, time = scene_in(run.attributes), run["time"]
    if len(time) < 2:
        return False
    body = body_motion(scene)
    rates = _rates(scene, run) if body is None else _rates_of_body(scene, body, run)
    return bool((time[1] - time[0]) * rates.max() < 1)


def _rates(scene: Scene, run: Run) -> Array:
    """Return the largest rate of a sphere at both ends of a run, (2,) 1/s.

    It is k/beta_v, but at most sqrt(k/m) if the run has a velocity.
    """
    ends, time = run["position"][[0, -1]], run["time"][[0, -1]]
    gradient = light_force(scene).field(ends, gradient=True, time=time).force_gradient
    mobility = drag(scene).mobilities(ends).value[:, :2].max(axis=1)
    if not (np.isfinite(gradient).all() and np.isfinite(mobility).all()):
        return np.full(2, np.inf)  # farther from the light than any bead
    stiffness = np.linalg.norm(gradient, ord=2, axis=(1, 2))
    rates = np.asarray(stiffness * mobility)
    if "velocity" not in run:
        return rates
    return np.minimum(rates, np.sqrt(stiffness / bead_properties(heated(scene)).mass))


def _rates_of_body(scene: Scene, body: BodyMotion, run: Run) -> Array:
    """Return the largest relaxation rate of a body at both ends of a run, (2,) 1/s."""
    from scipy.spatial.transform import Rotation  # a sphere does without

    from tweezer.optics.bodies.by_sums import derivative_of

    if not scene.lit:
        return np.zeros(2)
    light, found = light_force(scene), np.zeros(2)
    for i in (0, -1):
        position, orientation = run["position"][i], run["orientation"][i]
        change = derivative_of(light, position[None], orientation[None], float(run["time"][i]))[0]
        if not np.isfinite(change).all():
            return np.full(2, np.inf)
        turn = np.kron(np.eye(2), Rotation.from_quat(orientation, scalar_first=True).as_matrix())
        found[i] = np.abs(np.linalg.eigvals(turn @ body.mobility @ turn.T @ change)).max()
    return found
