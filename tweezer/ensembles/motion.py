"""Thermal motions whose trajectories an ensemble computes: of one bead, or of several."""

from __future__ import annotations

from collections.abc import Sequence

from tweezer.beads.thermal import Coupled, coupled
from tweezer.dynamics.problem import bound_once
from tweezer.dynamics.walk import Walk, walk
from tweezer.forces.force import Force
from tweezer.scene import Scene
from tweezer.values.errors import SceneError

#: Thermal motion of the beads of a scene, bound
Moving = Walk | Coupled


def moving(scene: Scene, seed: int, forces: Sequence[Force | str] = ()) -> Moving:
    """Return the thermal motion of a scene with the random numbers of a seed.

    `forces` are forces of the user, which several beads do not support.
    """
    if not scene.more_beads:
        return walk(bound_once(scene, forces), seed)
    if forces:
        raise SceneError("forces: require a single bead; omit forces")
    return coupled(scene, seed)
