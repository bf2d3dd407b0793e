"""The thesis's chapter 3 as a user would write it in NumPy: the baseline of the benchmark.

Vectorised over the rays, with the angles (3.13) and (3.16) by arctan as they are printed, and the
two signs that docs/errata.md corrects (3.11, 3.21). What does not depend on the bead's position is
computed once.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tweezer.scene import Scene

Array = NDArray[np.float64]

SPEED_OF_LIGHT = 299792458.0


class Pupil(NamedTuple):
    """The rays where they leave the lens."""

    origins: Array
    """(n, 3) O_i, m from the focus"""
    directions: Array
    """(n, 3) u_i (3.2)"""
    powers: Array
    """(n,) P_i (3.7), W"""


def pupil(scene: Scene) -> Pupil:
    """One ray from each square that lies wholly inside the lens (3.1)-(3.7); tan map, Gaussian."""
    lens, beam = scene.lens, scene.beam
    side = 2 * lens.radius / beam.divisions
    centres = (np.arange(beam.divisions) + 0.5) * side - lens.radius
    x, y = (axis.ravel() for axis in np.meshgrid(centres, centres))
    farthest_corner = np.hypot(np.abs(x) + side / 2, np.abs(y) + side / 2)
    inside = farthest_corner <= lens.radius * (1 + 1e-12)
    x, y = x[inside], y[inside]
    origins = np.column_stack([x, y, np.full(x.size, -lens.focal_length)])
    directions = -origins / np.linalg.norm(origins, axis=1, keepdims=True)
    peak = beam.power / (2 * np.pi * beam.sigma**2)
    powers = peak * np.exp(-(x**2 + y**2) / (2 * beam.sigma**2)) * side**2
    return Pupil(origins, directions, powers)


def force(scene: Scene, rays: Pupil, position: Array) -> Array:
    """Force on the bead at `position` (3,) m from the focus, N: (3.8)-(3.24) summed (3.26)."""
    n_m, n_P, r = scene.medium.refractive_index, scene.bead.refractive_index, scene.bead.radius
    P_PO = rays.origins - position
    along = np.sum(rays.directions * P_PO, axis=1)
    discriminant = along**2 - np.sum(P_PO**2, axis=1) + r**2
    hit = discriminant >= 0  # (3.8)
    u, P_PO, along = rays.directions[hit], P_PO[hit], along[hit]
    d = -along - np.sqrt(discriminant[hit])  # (3.9)
    P_PC = P_PO + d[:, None] * u  # (3.10)

    distance = np.linalg.norm(P_PC, axis=1)
    cos_alpha = -np.sum(u * P_PC, axis=1) / distance  # (3.11)
    sin_alpha = np.linalg.norm(np.cross(u, P_PC), axis=1) / distance  # (3.12)
    alpha = np.arctan(sin_alpha / cos_alpha)  # (3.13)
    sin_beta = n_m * sin_alpha / n_P  # (3.14)
    cos_beta = np.sqrt(1 - sin_beta**2)  # (3.15)
    beta = np.arctan(sin_beta / cos_beta)  # (3.16)

    r_s = (n_m * cos_alpha - n_P * cos_beta) / (n_m * cos_alpha + n_P * cos_beta)
    r_p = (n_m * cos_beta - n_P * cos_alpha) / (n_m * cos_beta + n_P * cos_alpha)
    R = (r_s**2 + r_p**2) / 2  # (3.17)
    T = 1 - R  # (3.18)
    series = T**2 / (1 + R**2 + 2 * R * np.cos(2 * beta))
    a = series * (np.cos(2 * alpha - 2 * beta) + R * np.cos(2 * alpha))  # (3.20)
    b = series * (np.sin(2 * alpha - 2 * beta) + R * np.sin(2 * alpha))  # (3.22)
    momentum = n_m * rays.powers[hit] / SPEED_OF_LIGHT
    F_sc = momentum * (1 + R * np.cos(2 * alpha) - a)  # (3.19)
    F_gr = -momentum * (R * np.sin(2 * alpha) - b)  # (3.21)

    to_axis = P_PO - along[:, None] * u
    n = to_axis / np.linalg.norm(to_axis, axis=1, keepdims=True)  # (3.23)
    return np.sum(F_sc[:, None] * u + F_gr[:, None] * n, axis=0)  # (3.24), (3.26)
