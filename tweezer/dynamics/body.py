"""Drag and inertia of a rigid body of any shape, as constant matrices in the body's frame.

The twist V = (u, w) are the velocity of the centre of mass and the angular velocity, in the body's
components. With the resistance R and the inertia M (6 x 6, symmetric, positive), the force and
torque W and the gyroscopic terms N,

    M V' = W - R V - N(V).

The eigenvectors of M^-1/2 R M^-1/2 give six velocities z, V = P z, each of which relaxes with a
time of its own.
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass

import numpy as np

from tweezer.dynamics.layout import ROTATION, TRANSLATION
from tweezer.scene import Scene
from tweezer.scene.bead import BeadProperties, properties_with_drag
from tweezer.values.arrays import Array
from tweezer.values.errors import SceneError


@dataclass(frozen=True, eq=False)
class BodyMotion:
    """Resistance and inertia of a body about its centre of mass, in the body's frame."""

    resistance: Array
    """R, (6, 6), in kg/s, kg m/s and kg m^2/s"""
    inertia: Array
    """M, (6, 6), in kg, kg m and kg m^2"""

    @functools.cached_property
    def mobility(self) -> Array:
        """B = R^-1, (6, 6)."""
        found = np.asarray(np.linalg.inv(self.resistance), float)
        return 0.5 * (found + found.T)

    @functools.cached_property
    def _modes(self) -> tuple[Array, Array]:
        """Relaxation times, (6,) s, and P, (6, 6)."""
        masses, axes = np.linalg.eigh(self.inertia)
        root = axes @ np.diag(masses**-0.5) @ axes.T
        rates, vectors = np.linalg.eigh(root @ self.resistance @ root)
        return 1 / rates, root @ vectors

    @property
    def relaxation_times(self) -> Array:
        """Relaxation times of the six velocities, (6,) s, the longest first."""
        return self._modes[0]

    @property
    def velocities(self) -> Array:
        """P, (6, 6): twist of each of the six velocities, V = P z, with P^T M P = 1."""
        return self._modes[1]

    def radius(self, viscosity: float) -> float:
        """Return the radius of the sphere with the largest drag coefficient of translation, m."""
        return float(np.linalg.eigvalsh(self.resistance[TRANSLATION, TRANSLATION])[-1]) / (
            6 * math.pi * viscosity
        )

    @property
    def parameters(self) -> dict[str, float]:
        """Values of the emitted modules' parameters by name: R, B = R^-1, M and H = M^-1."""
        matrices = {
            "R": self.resistance, "B": self.mobility, "M": self.inertia,
            "H": np.linalg.inv(self.inertia),
        }  # fmt: skip
        return {
            f"{letter}{i + 1}{j + 1}": float(matrix[i, j])
            for letter, matrix in matrices.items() for i in range(6) for j in range(i, 6)
        }  # fmt: skip


def body_motion(scene: Scene) -> BodyMotion | None:
    """Return the drag and inertia of the body of a scene; None for a sphere.

    Raises `SceneError` for a body whose resistance or added mass cannot be computed.
    """
    if scene.bead.shape == "sphere":
        return None
    from tweezer.fluid.resistance.of_scene import resistance  # a sphere does without

    body = scene.body
    inertia = np.zeros((6, 6))
    inertia[TRANSLATION, TRANSLATION] = body.mass * np.eye(3)
    inertia[ROTATION, ROTATION] = np.array(body.inertia)
    if scene.medium.inertia == "added-mass":
        inertia += np.diag(_added_mass(scene))
    return BodyMotion(np.array(resistance(scene).matrix), inertia)


def _added_mass(scene: Scene) -> Array:
    """Return the added inertia of an ellipsoid along and about its axes, (6,); refuse others."""
    from tweezer.fluid.added_mass import ellipsoid_added_mass
    from tweezer.scene.solids import Ellipsoid

    body = scene.body
    if not isinstance(body, Ellipsoid):
        raise SceneError(
            "medium.inertia = 'added-mass': is known for spheres, spheroids and ellipsoids; set "
            "medium.inertia to none"
        )
    return ellipsoid_added_mass(body.semi_axes, scene.medium.density * body.volume)


def properties_of_body(scene: Scene, motion: BodyMotion) -> BeadProperties:
    """Return mass, weight and mean drag coefficients of a body."""
    mean = [3 / np.trace(motion.mobility[part, part]) for part in (TRANSLATION, ROTATION)]
    return properties_with_drag(scene, float(mean[0]), float(mean[1]))
