"""Outcome of the run of a body that is not a sphere, whose equilibria are poses."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from tweezer.dynamics.escape import too_shallow
from tweezer.results.run import Run
from tweezer.values.arrays import Array

if TYPE_CHECKING:
    from tweezer.dynamics.poses import Rest
    from tweezer.scene import Scene

#: Outcomes of a bead that is held by an equilibrium, and of one that is not
CAPTURED, NOT_CAPTURED = "captured", "not captured"


def outcome_of_body(
    run: Run, scene: Scene, nearby: float, reach: float
) -> tuple[str, float, Array | Rest, float]:
    """Return the outcome of a complete run, its time, the pose of rest, and the pose's error.

    The body is captured if the pose at the end of its run leads to a stable equilibrium near it.

    Parameters
    ----------
    run : Run
        Complete run in light that does not change at its end.
    scene : Scene
        Scene of the run.
    nearby : float
        Without thermal motion, largest distance of a captured body from its pose of rest, m, with
        angles times its radius (`Rest.distances`).
    reach : float
        With thermal motion, largest distance of the mean position over the last tenth of the run
        from the pose of rest, and the distance at which the body is captured first, m.
    """
    times, position, orientation = run["time"], run["position"], run["orientation"]
    brownian, end = scene.forces.brownian, float(times[-1])
    settled = position[-max(1, len(position) // 10) :] if brownian else position[-1:]
    free = NOT_CAPTURED, end, settled.mean(axis=0), 0.0
    if not scene.lit:
        return free
    from tweezer.dynamics.poses import PoseSearch  # spheres do without

    search = PoseSearch(scene, end)
    place = search.relaxed(position[-1], orientation[-1])
    if place is None or not place.stable:
        return free
    rest = search.rest(place)
    away = rest.distances(position, orientation) > (reach if brownian else nearby)
    if brownian:
        aside = np.linalg.norm(rest.apart(settled).mean(axis=0)) > reach
        if aside or away.all() or too_shallow(search.escapes(place)):
            return free
        return CAPTURED, float(times[away.argmin()]), rest, 0.0
    if away[-1]:
        return free
    last_away = int(np.flatnonzero(away)[-1]) if away.any() else -1
    off = place.residual / float(np.abs(np.asarray(place.eigenvalues)[:, 0]).max())
    return CAPTURED, float(times[last_away + 1]), rest, off
