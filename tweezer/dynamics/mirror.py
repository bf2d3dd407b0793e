"""Runs that end as the bead reaches the mirror."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tweezer.scene import Scene
from tweezer.scene.interference import bounds
from tweezer.values.arrays import Array

#: Reason of a run that failed as the bead reached the mirror
AT_MIRROR = (
    "the bead reached the mirror, beyond which no force is known; a [wall] in front of it stops "
    "the bead"
)


def in_mirror(scene: Scene, z: Array, depth: float = 0.0) -> NDArray[np.bool_]:
    """Return whether a bead reaches into the mirror of a scene by more than a depth, m.

    Its centre is at the heights z (n,), m.
    """
    if scene.mirror is None:
        return np.full(np.shape(z), False)
    normal = bounds(scene)[scene.mirror.position]
    return np.asarray(normal * (z - scene.mirror.position) < scene.body.support(normal) - depth)
