"""The drag of a scene's bead."""

from __future__ import annotations

from tweezer.fluid.drag import Drag, Stokes
from tweezer.fluid.wall import BesideWall
from tweezer.optics.heat import heated
from tweezer.scene import Scene
from tweezer.scene.bead import drags_of_sphere
from tweezer.values.arrays import Array


def drag(scene: Scene) -> Drag:
    """Return the drag of the bead of `scene`.

    With hydrodynamic memory, walls are ignored, because they must be far away
    (`tweezer.scene.FREE`).
    """
    scene = heated(scene)
    free = Stokes(*drags_of_sphere(scene))
    if scene.wall is None or scene.medium.inertia == "memory":
        return free
    return BesideWall(free, scene.bead.radius, scene.wall.planes)


def left_out_of_walls(scene: Scene, positions: Array) -> Array:
    """Return the fractions by which walls slow a bead parallel and perpendicular to them, (n, 2).

    They are the error of a fluid with memory, which ignores walls. `positions` are (n, 3) m.
    """
    scene = heated(scene)
    beside = drag(scene.decided(medium={"inertia": "none", "poles": None}))
    free = drags_of_sphere(scene)[0]
    slower: Array = 1 - beside.mobilities(positions).value[:, :2] * free
    return slower
