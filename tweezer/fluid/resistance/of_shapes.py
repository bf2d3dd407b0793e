"""Resistance of the shapes that a scene describes, about the centre of mass.

Each function returns the matrix, the largest relative error of its diagonal, and the method.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import Any, TypeAlias

import numpy as np
from scipy.spatial.transform import Rotation

from tweezer.fluid.resistance.ellipsoid import ellipsoid_resistance
from tweezer.fluid.resistance.resistance import moved
from tweezer.fluid.resistance.rings import Piece, arc, line, revolved_resistance
from tweezer.fluid.resistance.row import row_resistance
from tweezer.fluid.resistance.triangles import mesh_resistance
from tweezer.scene.meshes import triangles
from tweezer.scene.solids import about_centre
from tweezer.values.arrays import Array
from tweezer.values.constants import Boltzmann
from tweezer.values.errors import SceneError

Found: TypeAlias = tuple[Array, float, str]

#: Relative error of a closed form
_ROUNDING = 1e-14
#: Distance from a line that counts as rounding, as a part of the size of a cluster
_ON_LINE = 1e-9
#: Centimetre in m
_CM = 0.01


def sphere(bead: Any, viscosity: float) -> Found:
    """Return the resistance of a sphere."""
    return _of_axes((bead.radius,) * 3, viscosity)


def spheroid(bead: Any, viscosity: float) -> Found:
    """Return the resistance of a spheroid."""
    return _of_axes((bead.radius, bead.radius, bead.length / 2), viscosity)


def ellipsoid(bead: Any, viscosity: float) -> Found:
    """Return the resistance of an ellipsoid."""
    return _of_axes(bead.semi_axes, viscosity)


def _of_axes(semi_axes: tuple[float, float, float], viscosity: float) -> Found:
    """Return the resistance of an ellipsoid with these semi-axes, m."""
    matrix = ellipsoid_resistance(semi_axes, viscosity)
    return matrix, _ROUNDING, "Carlson's elliptic integrals"


def row(bead: Any, viscosity: float) -> Found:
    """Return the resistance of a cluster of spheres in a row."""
    centres, radii = np.array(bead.centres), np.array([each.radius for each in bead.spheres])
    apart = centres - centres.mean(axis=0)
    _, sizes, axes = np.linalg.svd(np.concatenate([apart, np.zeros((3, 3))]))
    if sizes[1] > _ON_LINE * bead.radius:
        raise SceneError(
            "bead.spheres: the resistance is computed for spheres in a row; the centres deviate "
            f"from a line by {sizes[1]:.3g} m"
        )
    axis = axes[0]
    matrix, error = row_resistance(centres @ axis, radii, viscosity)
    to_axis = Rotation.align_vectors(axis, [0.0, 0.0, 1.0])[0].as_matrix()
    turned = np.kron(np.eye(2), to_axis)
    return turned @ matrix @ turned.T, error, "multipoles about each sphere"


def cylinder(bead: Any, viscosity: float) -> Found:
    """Return the resistance of a cylinder."""
    a, half = bead.radius, bead.length / 2
    return _revolved(_lines([(0.0, half), (a, half), (a, -half), (0.0, -half)]), viscosity)


def capsule(bead: Any, viscosity: float) -> Found:
    """Return the resistance of a cylinder with half spheres at its ends."""
    a, half, right = bead.radius, bead.length / 2 - bead.radius, math.pi / 2
    side = line((a, half), (a, -half))
    return _revolved(
        [arc(half, (a, a), 0.0, right), side, arc(-half, (a, a), right, math.pi)], viscosity
    )  # fmt: skip


def profile(bead: Any, viscosity: float) -> Found:
    """Return the resistance of a body of revolution with a profile of straight lines."""
    return _revolved(_lines(about_centre(bead.points)), viscosity)


def _lines(points: Sequence[tuple[float, float]] | Array) -> list[Piece]:
    """Return the straight pieces between points of a profile."""
    return [line((a, b), (c, d)) for (a, b), (c, d) in itertools.pairwise(points)]


def _revolved(pieces: Sequence[Piece], viscosity: float) -> Found:
    """Return the resistance of a body of revolution."""
    matrix, error = revolved_resistance(pieces, viscosity)
    return matrix, error, "single layer of rings"


def mesh(bead: Any, viscosity: float) -> Found:
    """Return the resistance of a body with a closed mesh."""
    matrix, error = mesh_resistance(triangles(bead.file, bead.scale), viscosity)
    return matrix, error, "single layer of triangles"


def given(bead: Any, viscosity: float) -> Found:
    """Return the resistance that is given, at the centre of mass and for a viscosity."""
    of = bead.given
    if of.resistance is not None:
        matrix = np.array(of.resistance)
    else:
        lengths = np.repeat([_CM, 1.0], 3)
        diffusion = np.array(of.diffusion) * lengths[:, None] * lengths
        matrix = Boltzmann * of.temperature * np.linalg.inv(diffusion)
    matrix = (matrix + matrix.T) / 2 * (viscosity / (of.viscosity or viscosity))
    return moved(matrix, -np.array(of.point)), _ROUNDING, "as given"
