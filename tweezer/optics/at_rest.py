"""The stable equilibrium of a bead in the light of a scene."""

from __future__ import annotations

import math

import numpy as np

from tweezer.forces.equilibria import (
    Equilibrium,
    equilibria_about,
    equilibrium_at,
    nearest_stable,
)
from tweezer.forces.force import Wrench
from tweezer.forces.rings import Motion, off_axis, rings
from tweezer.optics.binding import light_force
from tweezer.optics.light import LightForce
from tweezer.scene import Scene
from tweezer.scene.bead import bead_properties
from tweezer.values.arrays import Array


def at_rest(scene: Scene) -> Equilibrium | None:
    """Return the stable equilibrium of light and weight nearest the focus; None if none exists.

    If the light of one beam has no equilibrium on its axis near the focus, positions off the axis
    are searched too. The result is also None for a ring, on which the bead has no fixed position.
    """
    force, weight = light_force(scene), np.array(bead_properties(scene).weight)
    search = force.search
    if scene.wall is None and weight.any() and force.smooth:
        search = search._replace(farthest=scene.simulation.loss_distance)

    def field(places: Array, *, gradient: bool = False) -> Wrench:
        """Return the force of the light."""
        return force.field(places, gradient=gradient)

    def net_force(places: Array) -> Array:
        """Return the force of light and weight."""
        return field(places).force + weight

    def spiral_rate(place: Array, stiffness: Array) -> float:  # noqa: ARG001
        """Return the rate of a growing spiral: none without inertia."""
        return 0.0

    radius, of = scene.bead.radius, (search, field, net_force, spiral_rate)
    nearest = nearest_stable(equilibria_about(force.foci(), radius, *of))
    if not (isinstance(force, LightForce) and scene.plain and force.smooth):
        return nearest
    box = force.light.box
    away = math.inf if nearest is None else math.hypot(*nearest.position)
    if away < box.width:
        return nearest
    if force.symmetric:
        mobility = 1 / (6 * math.pi * scene.medium.viscosity * radius)
        motion = Motion(0.0, lambda places: np.full((len(places), 2), mobility), search.beside)
        ring = next(rings(radius, box, force, net_force, motion), None)
        return nearest if ring is None or math.hypot(*ring.position) > away else None
    beside = (equilibrium_at(each, *of) for each in off_axis(radius, box, force, net_force))
    return nearest_stable([*([] if nearest is None else [nearest]), *beside])
