"""The resistance of the bead of a scene."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from tweezer.fluid.resistance.ellipsoid import ellipsoid_resistance
from tweezer.fluid.resistance.resistance import Resistance
from tweezer.fluid.resistance.row import row_resistance
from tweezer.scene import Scene, SceneLike, checked_scene
from tweezer.values.arrays import Array
from tweezer.values.errors import SceneError
from tweezer.values.vectors import fixed

#: Relative error of a closed form
_ROUNDING = 1e-14
#: Distance from a line that counts as rounding, as a part of the size of a cluster
_ON_LINE = 1e-9


def resistance(scene: SceneLike) -> Resistance:
    """Return the resistance of the bead of a scene in an unbounded fluid.

    Walls and the inertia of the fluid are not included.

    Parameters
    ----------
    scene : Scene, str or mapping
        Scene of the bead: a sphere, a spheroid, or a cluster of spheres in a row.

    Returns
    -------
    Resistance
        Resistance about the centre of mass, in the body's frame.

    Raises
    ------
    SceneError
        For another shape.

    Examples
    --------
    >>> found = tweezer.resistance("silica-1um")
    >>> f"{found.matrix[0, 0]:.2e} kg/s"
    '9.44e-09 kg/s'
    """
    scene = checked_scene(scene)
    bead, viscosity = scene.bead, scene.medium.viscosity
    error, method = _ROUNDING, "Carlson's elliptic integrals"
    if bead.shape == "sphere":
        matrix = ellipsoid_resistance((bead.radius,) * 3, viscosity)
    elif bead.length is not None:
        axes = (bead.radius, bead.radius, bead.length / 2)
        matrix = ellipsoid_resistance(axes, viscosity)
    elif bead.spheres is not None:
        matrix, error = _of_row(scene)
        method = "multipoles about each sphere"
    else:
        raise SceneError(
            f"bead.shape = {bead.shape!r}: the resistance requires the surface of the body; "
            "allowed: 'sphere', 'spheroid', 'spheres'"
        )
    return Resistance(fixed(matrix), scene.medium.temperature, error, method)


def _of_row(scene: Scene) -> tuple[Array, float]:
    """Return the resistance of a cluster of spheres in a row, and its relative error."""
    bead = scene.bead
    assert bead.spheres is not None
    centres, radii = np.array(bead.centres), np.array([each.radius for each in bead.spheres])
    _, sizes, axes = np.linalg.svd(np.concatenate([centres, np.zeros((3, 3))]))
    if sizes[1] > _ON_LINE * bead.radius:
        raise SceneError(
            "bead.spheres: the resistance is computed for spheres in a row; the centres deviate "
            f"from a line by {sizes[1]:.3g} m"
        )
    axis = axes[0]
    matrix, error = row_resistance(centres @ axis, radii, scene.medium.viscosity)
    to_axis = Rotation.align_vectors(axis, [0.0, 0.0, 1.0])[0].as_matrix()
    turned = np.kron(np.eye(2), to_axis)
    return turned @ matrix @ turned.T, error
