"""The stable equilibrium of a bead in the light of a scene."""

from __future__ import annotations

import numpy as np

from tweezer.forces.equilibria import Equilibrium, equilibria_about, nearest_stable
from tweezer.forces.force import Wrench
from tweezer.optics.binding import light_force
from tweezer.scene import Scene
from tweezer.scene.bead import bead_properties
from tweezer.values.arrays import Array


def at_rest(scene: Scene) -> Equilibrium | None:
    """Return the stable equilibrium of light and weight nearest the focus; None if none exists."""
    force, weight = light_force(scene), np.array(bead_properties(scene).weight)

    def field(places: Array, *, gradient: bool = False) -> Wrench:
        """Return the force of the light."""
        return force.field(places, gradient=gradient)

    return nearest_stable(equilibria_about(
        force.foci(), scene.bead.radius, force.search, field,
        lambda places: force.field(places).force + weight, lambda *_: 0.0,
    ))  # fmt: skip
