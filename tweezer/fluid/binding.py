"""The drag of a scene's bead."""

from __future__ import annotations

from tweezer.fluid.drag import Drag, stokes
from tweezer.scene import Scene


def drag(scene: Scene) -> Drag:
    """Drag of the bead of `scene`."""
    return stokes(scene.medium.viscosity, scene.bead.radius)
