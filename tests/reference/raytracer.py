"""A ray through a sphere, bounce by bounce, with vectors: no angles, no series, no formula for Q.

The sphere takes the momentum and angular momentum that the ray brings, less what leaves.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Transfer:
    """What the sphere takes from a ray of unit power, in units of n_m/c."""

    force: np.ndarray
    torque: np.ndarray
    """about the centre"""
    power: float
    """absorbed: zero but for what is left after the last bounce"""


def refract(direction, normal, ratio):
    """Snell's law for vectors, `normal` against the ray, `ratio` n_here/n_there; None if total."""
    cosine = -normal @ direction
    k = 1 - ratio**2 * (1 - cosine**2)
    if k < 0:
        return None
    return ratio * direction + (ratio * cosine - np.sqrt(k)) * normal


def fresnel(n_here, n_there, cos_here, cos_there):
    """Reflectances (s, p) from the amplitudes as in textbooks."""
    s = (n_here * cos_here - n_there * cos_there) / (n_here * cos_here + n_there * cos_there)
    p = (n_there * cos_here - n_here * cos_there) / (n_there * cos_here + n_here * cos_there)
    return np.array([s**2, p**2])


def trace(direction, centre, radius, n_medium, n_bead, *, averaged, bounces=4000):
    """Follow the ray through the origin along `direction`; None if it misses or grazes the sphere.

    averaged: one ray with the mean reflectance, in place of an s and a p ray of half the power.
    """
    direction = np.asarray(direction, float)
    centre = np.asarray(centre, float)
    along = direction @ centre
    half_chord_squared = radius**2 - (centre @ centre - along**2)
    if half_chord_squared <= 0:
        return None
    entry = (along - np.sqrt(half_chord_squared)) * direction - centre
    powers = np.array([1.0]) if averaged else np.array([0.5, 0.5])

    def reflectance(n_here, n_there, cos_here, cos_there):
        both = fresnel(n_here, n_there, cos_here, cos_there)
        return np.array([both.mean()]) if averaged else both

    momentum_out = np.zeros(3)
    angular_out = np.zeros(3)
    power_out = 0.0

    def leave(point, heading, power):
        nonlocal momentum_out, angular_out, power_out
        momentum_out = momentum_out + power * heading
        angular_out = angular_out + power * np.cross(point, heading)
        power_out += power

    normal = entry / radius
    cos_in = -normal @ direction
    mirrored = direction + 2 * cos_in * normal
    inside = refract(direction, normal, n_medium / n_bead)
    if inside is None:
        leave(entry, mirrored, powers.sum())
    else:
        R = reflectance(n_medium, n_bead, cos_in, -normal @ inside)
        leave(entry, mirrored, (R * powers).sum())
        powers = (1 - R) * powers
        point, heading = entry, inside
        for _ in range(bounces):
            point = point - 2 * (point @ heading) * heading
            point *= radius / np.linalg.norm(point)
            inward = -point / radius
            out = refract(heading, inward, n_bead / n_medium)
            if out is None:  # along the surface but for rounding: a ray from outside always leaves
                return None
            R = reflectance(n_bead, n_medium, -inward @ heading, -inward @ out)
            leave(point, out, ((1 - R) * powers).sum())
            powers = R * powers
            heading = heading - 2 * (heading @ inward) * inward
            heading /= np.linalg.norm(heading)
            if powers.sum() < 1e-18:
                break
    return Transfer(direction - momentum_out, np.cross(entry, direction) - angular_out,
                    1 - power_out)  # fmt: skip
