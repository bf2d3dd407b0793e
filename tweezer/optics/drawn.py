"""The cones of light as figures and pages draw them."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from tweezer.forces.composed import Course
from tweezer.optics.beam import behind_face, cone
from tweezer.optics.binding import factor_of, place_of
from tweezer.scene import Scene
from tweezer.scene.sections import Beam
from tweezer.values.arrays import Array

#: Largest sine of the angle at which light is drawn
_STEEPEST = 0.999


class DrawnCone(NamedTuple):
    """A cone of light that a picture shows: one for each focus of each lit beam."""

    beam: Beam
    """its beam"""
    offset: Array
    """(3,) position of its focus relative to the focus of the beam, m"""
    place: Course
    """position of the focus of the beam in time, (3,) m"""
    strength: Course
    """factor of the power in time, (1,)"""
    half_angle: float
    """angle of the outermost rays to the axis, rad"""

    def at(self, time: float) -> Array:
        """Return the position of the focus at a time, s, (3,) m."""
        return self.place.at(time) + self.offset


def drawn_cones(scene: Scene) -> list[DrawnCone]:
    """Return the cones of light of a scene, one for each focus of each lit beam."""
    found = []
    for beam in scene.beams:
        if not (alone := scene.with_one_beam(beam)).lit:
            continue
        turn = np.array([1, -1, -1] if beam.direction == "down" else [1, 1, 1])
        spots = [each.position for each in beam.focus or ()] or [(0.0, 0.0, 0.0)]
        found += [
            DrawnCone(beam, turn * np.array(spot), place_of(beam), factor_of(beam),
                      drawn_half_angle(alone))
            for spot in spots
        ]  # fmt: skip
    return found


def drawn_half_angle(scene: Scene) -> float:
    """Return the angle of the outermost rays to the axis at the bead, rad, for a picture of a beam.

    Behind a cover the rays are refracted; those that the cover reflects totally are left out, and
    the cone ends at 87.4 degrees.
    """
    angle, cover = cone(scene).half_angle, scene.lens.cover
    if cover is None:
        return angle
    refracted = behind_face(angle, cover.refractive_index, scene.medium.refractive_index)
    return min(refracted, math.asin(_STEEPEST))


def cone_caveat(scene: Scene) -> str | None:
    """Return a sentence on what the drawn cone leaves out; None if that is nothing."""
    cover = scene.lens.cover
    medium = scene.medium.refractive_index
    if cover is None or cover.refractive_index == medium or not scene.lit:
        return None
    return (
        "the cone of light is that of the nominal focus, without the spherical aberration of the "
        "cover glass"
    )
