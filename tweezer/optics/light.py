"""The force of a scene's light on its bead, bound once and evaluated many times."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tweezer.optics.kernels import Kernel, kernel
from tweezer.optics.rays import Rays, grid
from tweezer.scene import Scene

Array = NDArray[np.float64]

SPEED_OF_LIGHT = 299792458.0
"""c, m/s (Table B.1)"""


@dataclass(frozen=True)
class Field:
    """What the light does to a bead at n positions, inertial frame."""

    force: Array
    """(n, 3) N"""
    moment: Array
    """(n, 3) N m"""
    force_gradient: Array
    """(n, 3, 3) N/m, [i, j] = dF_i/dx_j"""
    moment_gradient: Array
    """(n, 3, 3) N, [i, j] = dM_i/dx_j"""


@dataclass(frozen=True)
class Light:
    """The sum over the rays of a scene; no rays at all is darkness."""

    directions: Array
    strengths: Array
    half_angle: float
    radius: float
    index_ratio: float
    averaged: bool
    torque: bool

    def field(self, positions: Array, *, gradient: bool = False) -> Field:
        """Force and moment at `positions` (n, 3) m from the focus, and their gradients if asked.

        What is not asked for, or not exerted, is zero and costs nothing.
        """
        n = len(positions)
        gradients = n if gradient else 0
        field = Field(
            np.zeros((n, 3)),
            np.zeros((n, 3)),
            np.zeros((gradients, 3, 3)),
            np.zeros((gradients, 3, 3)),
        )
        if self.strengths.size:
            self._kernel(gradient)(
                positions,
                self.directions,
                self.strengths,
                self.half_angle,
                self.radius,
                self.index_ratio,
                field.force,
                field.moment,
                field.force_gradient,
                field.moment_gradient,
            )
        return field

    def _kernel(self, gradient: bool) -> Kernel:
        return kernel(
            averaged=self.averaged,
            denser_medium=self.index_ratio > 1,
            gradient=gradient,
            moment=self.torque,
        )


@functools.lru_cache(maxsize=16)
def light(scene: Scene) -> Light:
    """The light of `scene`: no rays if it is off."""
    rays = (
        grid(scene.lens, scene.beam, scene.medium)
        if scene.lit
        else Rays(np.empty((3, 0)), np.empty(0))
    )
    n_m = scene.medium.refractive_index
    return Light(
        directions=rays.directions,
        strengths=n_m * rays.powers / SPEED_OF_LIGHT,
        half_angle=math.acos(rays.directions[2].min(initial=1.0)),
        radius=scene.bead.radius,
        index_ratio=n_m / scene.bead.refractive_index,
        averaged=scene.beam.polarisation == "averaged-reflectance",
        torque=scene.beam.torque == "thesis",
    )


def optical_force(scene: Scene, positions: ArrayLike) -> Array:
    """Force of the light on the bead (3.26), N.

    positions: (..., 3) m from the focus, z along the light. Returns (..., 3).
    Raises `ValueError` for another shape or a position that is not finite.
    """
    points, shape = _points(positions)
    return light(scene).field(points).force.reshape(shape)


def optical_jacobian(scene: Scene, positions: ArrayLike) -> Array:
    """Derivative of the force over the position, N/m: [..., i, j] = dF_i/dx_j.

    positions: (..., 3) m from the focus. Returns (..., 3, 3). Raises `ValueError` as
    `optical_force`. Of the sum over the grid's rays: rays that begin or cease to hit the bead
    make that sum jump, and the jumps are not in its derivative.
    """
    points, shape = _points(positions)
    return light(scene).field(points, gradient=True).force_gradient.reshape((*shape, 3))


def optical_torque(scene: Scene, positions: ArrayLike) -> Array:
    """Moment of the light about the bead's centre, inertial frame, N m.

    positions: (..., 3) m from the focus. Returns (..., 3). Zero for `beam.torque = "none"`: every
    ray leaves a lossless isotropic sphere with the impact parameter it came with, so it leaves
    its angular momentum as it was. With "thesis" the moment (3.25). Raises `ValueError` as
    `optical_force`.
    """
    points, shape = _points(positions)
    return light(scene).field(points).moment.reshape(shape)


def _points(positions: ArrayLike) -> tuple[Array, tuple[int, ...]]:
    array = np.ascontiguousarray(positions, dtype=np.float64)
    if array.ndim == 0 or array.shape[-1] != 3:
        raise ValueError(f"positions must have the shape (..., 3), not {array.shape}")
    if not np.isfinite(array).all():
        raise ValueError("positions must be finite")
    return array.reshape(-1, 3), array.shape
