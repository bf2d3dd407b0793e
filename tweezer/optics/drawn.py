"""The cone of light as figures and pages draw it."""

from __future__ import annotations

import math

from tweezer.optics.beam import behind_face, cone
from tweezer.scene import Scene

#: Largest sine of the angle at which light is drawn
_STEEPEST = 0.999


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
