"""The resistance of the bead of a scene."""

from __future__ import annotations

import functools
from typing import Any

import numpy as np

from tweezer.fluid.resistance.resistance import Resistance
from tweezer.optics.heat import heated
from tweezer.scene import SceneLike
from tweezer.scene.choices import SHAPES, at
from tweezer.scene.media import drag_factors
from tweezer.values.arrays import Array
from tweezer.values.errors import SceneError
from tweezer.values.vectors import fixed


def resistance(scene: SceneLike) -> Resistance:
    """Return the resistance of the bead of a scene in an unbounded fluid.

    Walls and the inertia of the fluid are not included.

    Parameters
    ----------
    scene : Scene, str or mapping
        Scene of the bead.

    Returns
    -------
    Resistance
        Resistance about the centre of mass, in the body's frame.

    Raises
    ------
    SceneError
        For a body whose surface is not known, a cluster of spheres that are not in a row, and a
        mesh of too many triangles.

    Examples
    --------
    >>> found = tweezer.resistance("silica-1um")
    >>> f"{found.matrix[0, 0]:.2e} kg/s"
    '9.44e-09 kg/s'
    """
    scene = heated(scene)
    matrix, error, method = _kept(scene.bead, scene.medium.viscosity)
    if scene.bead.shape == "sphere":
        medium = scene.medium
        factors = drag_factors(medium.name, scene.knudsen, medium.accommodation)
        hot = scene.heating.drag, scene.heating.rotational_drag
        matrix = matrix * np.repeat(np.multiply(factors, hot), 3)
    return Resistance(fixed(matrix), scene.noise_temperature, error, method)


@functools.lru_cache(maxsize=16)
def _kept(bead: Any, viscosity: float) -> tuple[Array, float, str]:
    """Return matrix, relative error and method of a bead's resistance; the last few are kept."""
    place = SHAPES[bead.shape].resistance
    if not place:
        allowed = ", ".join(repr(each.name) for each in SHAPES.values() if each.resistance)
        raise SceneError(
            f"bead.shape = {bead.shape!r}: the resistance requires the surface of the body; "
            f"allowed: {allowed}"
        )
    found: tuple[Array, float, str] = at(place)(bead, viscosity)
    return found
