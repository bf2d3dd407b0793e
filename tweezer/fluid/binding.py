"""The drag of a scene's bead."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tweezer.fluid.drag import Drag, stokes
from tweezer.fluid.wall import BesideWall
from tweezer.scene import Scene

Array = NDArray[np.float64]


def drag(scene: Scene) -> Drag:
    """Drag of the bead of `scene`.

    In a fluid with memory a wall is so far away (`tweezer.scene.FREE`) that it is left out.
    """
    free = stokes(scene.medium.viscosity, scene.bead.radius)
    if scene.wall is None or scene.medium.inertia == "memory":
        return free
    return BesideWall(free, scene.bead.radius, scene.wall.planes)


def left_out_of_walls(scene: Scene, positions: Array) -> Array:
    """By how much of its speed a wall slows a bead along it and across it, (n, 2).

    A fluid with memory leaves that out. positions: (n, 3) m.
    """
    beside = drag(scene.decided(medium={"inertia": "none", "poles": None}))
    free = stokes(scene.medium.viscosity, scene.bead.radius).translation
    slower: Array = 1 - beside.mobilities(positions).value[:, :2] * free
    return slower
