"""Rays through the pupil: the thesis's squares (3.1)-(3.7), and where the lens sends them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tweezer.optics.beam import intensity, polar_sine_and_cosine
from tweezer.scene.sections import Beam, Lens, Medium
from tweezer.values.arrays import Array


@dataclass(frozen=True)
class Rays:
    """Rays that all pass through the focus."""

    directions: Array
    """(3, n) unit vectors u_i (3.2), z along the light"""
    powers: Array
    """(n,) P_i (3.7), W"""


def grid(lens: Lens, beam: Beam, medium: Medium) -> Rays:
    """Return the thesis's rays, one from the centre of each square wholly inside the pupil.

    n_div = 100 gives 7644 squares (the thesis says 7645; no rule tried gives that number).
    The power of a ray is intensity times area (3.5)-(3.7). The staircase rim and the power that it
    cuts off are not corrected: the grid serves to reproduce the thesis. Raises `SceneError` for a
    table that `tweezer.optics.beam.cone` refuses.
    """
    half_side = lens.radius / beam.divisions
    centres = (2 * np.arange(beam.divisions) + 1 - beam.divisions) * half_side
    x, y = (axis.ravel() for axis in np.meshgrid(centres, centres, indexing="ij"))
    # in units of half a side the corners are integers, so rounding does not decide what is inside
    corners = (np.rint(np.abs(x) / half_side) + 1) ** 2 + (np.rint(np.abs(y) / half_side) + 1) ** 2
    inside = corners <= beam.divisions**2
    x, y = x[inside], y[inside]
    rho = np.hypot(x, y)
    powers = intensity(lens, beam, medium)(rho) * (2 * half_side) ** 2
    sine, cosine = polar_sine_and_cosine(rho, lens, medium)
    along = np.divide(sine, rho, out=np.zeros_like(rho), where=rho > 0)
    return Rays(np.array([-x * along, -y * along, cosine]), powers)
