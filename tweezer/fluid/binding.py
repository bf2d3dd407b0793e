"""The drag of a scene's bead."""

from __future__ import annotations

import numpy as np

from tweezer.fluid.drag import Drag, stokes
from tweezer.fluid.wall import BesideWall
from tweezer.scene import Scene


def drag(scene: Scene) -> Drag:
    """Drag of the bead of `scene`.

    In a fluid with memory a wall is so far away (`tweezer.scene.FREE`) that it is left out.
    """
    free = stokes(scene.medium.viscosity, scene.bead.radius)
    if scene.wall is None or scene.medium.inertia == "memory":
        return free
    return BesideWall(free, scene.bead.radius, scene.wall.planes)


def without_wall(scene: Scene) -> str:
    """What a scene with a memory leaves out of its wall, as the end of a sentence; "" without."""
    if scene.wall is None:
        return ""
    beside = drag(scene.decided(medium={"inertia": "none", "poles": None}))
    free = stokes(scene.medium.viscosity, scene.bead.radius).translation
    along, across = 1 - beside.mobilities(np.array([scene.start_position])).value[0, :2] * free
    return (
        f"; the wall is left out, by which the bead would be slower by {100 * along:.2g} % along "
        f"it and {100 * across:.2g} % across, at the start; nearer to it than 20 radii it is lost"
    )
