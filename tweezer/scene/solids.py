"""Bodies that are not spheres as rigid bodies: mass, inertia and extent."""

from __future__ import annotations

import copy
import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.polynomial.legendre import leggauss

from tweezer.scene.body import Body, Tensor
from tweezer.scene.sections.shapes import densities
from tweezer.values.errors import SceneError


def _vector(values: Any) -> tuple[float, float, float]:
    """Return three numbers as a tuple."""
    x, y, z = map(float, values)
    return x, y, z


def _axis(orientation: Any, normal: float) -> Any:
    """Return `normal` times z in the body's frame, turned by Euler parameters, (..., 3)."""
    w, x, y, z = np.moveaxis(np.asarray(orientation, float), -1, 0)
    rows = (2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z)
    return np.stack([normal * row / (w * w + x * x + y * y + z * z) for row in rows], axis=-1)


class _Turned(Body):
    """A body whose extent depends on its orientation."""

    _start: tuple[float, ...] = (1.0, 0.0, 0.0, 0.0)

    def starting(self, orientation: tuple[float, ...]) -> Body:
        """Return this body with Euler parameters at the start; see `Body.starting`."""
        found = copy.copy(self)
        found._start = orientation
        return found

    def support(self, normal: float = 1.0, orientation: Any = None) -> Any:
        """Return the distance of the position from a plane that the body touches; see `Body`."""
        return self._extent(_axis(self._start if orientation is None else orientation, normal))

    def _extent(self, direction: Any) -> Any:
        """Return the distance from a plane with a normal to the body, in its frame."""
        raise NotImplementedError


class Ellipsoid(_Turned):
    """A homogeneous ellipsoid.

    Parameters
    ----------
    semi_axes : tuple of float
        Semi-axes along x, y and z of the body, m.
    density : float
        Density, kg/m^3.
    """

    def __init__(self, semi_axes: tuple[float, float, float], density: float):
        a, b, c = semi_axes
        self.size = max(semi_axes)
        self.volume = 4 / 3 * math.pi * a * b * c
        self.mass = density * self.volume
        fifth = self.mass / 5
        self.moments_of_inertia = (
            fifth * (b * b + c * c), fifth * (c * c + a * a), fifth * (a * a + b * b)
        )  # fmt: skip
        self.semi_axes = semi_axes

    def _extent(self, direction: Any) -> Any:
        """Return the distance from a plane; see `_Turned`."""
        return np.sqrt(((np.array(self.semi_axes) * direction) ** 2).sum(axis=-1))


class Solid(_Turned):
    """A rigid body whose convex hull is the one of balls and of rings across the body's z axis.

    Parameters
    ----------
    mass : float
        Mass, kg.
    volume : float
        Volume, m^3.
    inertia : array_like, shape (3, 3)
        Inertia tensor about the centre of mass, kg m^2.
    centres : array_like, shape (n, 3)
        Centres of the balls or rings from the centre of mass, m.
    balls, rings : array_like, shape (n,), optional
        Radii of the balls and of the rings, m. Default: 0.
    centre_of_volume : sequence of float, optional
        Centre of volume from the centre of mass, m. Default: the centre of mass.
    """

    def __init__(
        self,
        mass: float,
        volume: float,
        inertia: Any,
        centres: Any,
        balls: Any = 0.0,
        rings: Any = 0.0,
        centre_of_volume: Sequence[float] = (0.0, 0.0, 0.0),
    ):
        self.mass, self.volume = float(mass), float(volume)
        self.centre_of_volume = _vector(centre_of_volume)
        self._inertia = np.array(inertia, float)
        diagonal = np.diag(self._inertia)
        principal = (self._inertia == np.diag(diagonal)).all()
        self.moments_of_inertia = _vector(
            diagonal if principal else np.linalg.eigvalsh(self._inertia)
        )
        at = np.array(centres, float)
        self._at, self._balls, self._rings = at, balls, rings
        across = np.hypot(at[:, 0], at[:, 1]) + rings
        self.size = float((np.hypot(across, at[:, 2]) + balls).max())

    @property
    def inertia(self) -> Tensor:
        """Inertia tensor about the centre of mass in the body's frame, (3, 3) kg m^2."""
        return tuple(_vector(row) for row in self._inertia)

    def _extent(self, direction: Any) -> Any:
        """Return the distance from a plane; see `_Turned`."""
        tilt = np.sqrt(np.maximum(1 - direction[..., 2:] ** 2, 0.0))
        return (self._balls + self._rings * tilt - direction @ self._at.T).max(axis=-1)


def spheroid(bead: Any) -> Body:
    """Return the solid of a homogeneous ellipsoid of revolution about z."""
    return Ellipsoid((bead.radius, bead.radius, bead.length / 2), bead.density)


def ellipsoid(bead: Any) -> Body:
    """Return the solid of a homogeneous ellipsoid."""
    return Ellipsoid(bead.semi_axes, bead.density)


def cluster(bead: Any) -> Body:
    """Return the solid of a rigid cluster of homogeneous spheres."""
    at, r = np.array(bead.centres), np.array([each.radius for each in bead.spheres])
    volumes = 4 / 3 * math.pi * r**3
    masses = volumes * densities(bead.spheres, bead.density)
    own = 2 / 5 * masses * r**2
    inertia = (own + masses * (at**2).sum(axis=1)).sum() * np.eye(3)
    inertia -= np.einsum("k,ki,kj->ij", masses, at, at)
    centre = volumes @ at / volumes.sum()
    return Solid(masses.sum(), volumes.sum(), inertia, at, balls=r, centre_of_volume=centre)


def cylinder(bead: Any) -> Body:
    """Return the solid of a homogeneous cylinder about z."""
    a, half = bead.radius, bead.length / 2
    volume = math.pi * a**2 * bead.length
    mass = bead.density * volume
    across = mass * (a**2 / 4 + half**2 / 3)
    ends = [(0.0, 0.0, half), (0.0, 0.0, -half)]
    return Solid(mass, volume, np.diag([across, across, mass * a**2 / 2]), ends, rings=a)


def capsule(bead: Any) -> Body:
    """Return the solid of a homogeneous cylinder about z with half spheres at its ends."""
    a, half = bead.radius, bead.length / 2 - bead.radius
    if not half > 1e-9 * a:
        raise SceneError(
            f"length = {bead.length:.4g}: must be above the diameter of the capsule, {2 * a:.4g} m"
        )
    volumes = math.pi * a**2 * np.array([2 * half, 4 / 3 * a])
    rod, ball = bead.density * volumes
    # the centre of mass of a half sphere is 3a/8 from its face
    caps = ball * (2 / 5 * a**2 + half**2 + 3 / 4 * half * a)
    across = rod * (a**2 / 4 + half**2 / 3) + caps
    inertia = np.diag([across, across, rod * a**2 / 2 + ball * 2 / 5 * a**2])
    ends = [(0.0, 0.0, half), (0.0, 0.0, -half)]
    return Solid(rod + ball, volumes.sum(), inertia, ends, balls=a)


def profile(bead: Any) -> Body:
    """Return the solid of a homogeneous body of revolution, by exact integrals of its frusta."""
    points = about_centre(bead.points)
    x, w = leggauss(3)
    start, step = points[:-1, :, None], np.diff(points, axis=0)[:, :, None]
    r, z = np.moveaxis(start + step * (1 + x) / 2, 1, 0)
    slices = math.pi * r**2 * step[:, 1] * w / 2
    volume, axial, across = (
        (slices * each).sum() for each in (np.ones_like(r), r**2 / 2, r**2 / 4 + z**2)
    )
    inertia = bead.density * np.diag(np.abs([across, across, axial]))
    centres = np.stack([0 * points[:, 0], 0 * points[:, 0], points[:, 1]], axis=1)
    mass = bead.density * abs(volume)
    return Solid(mass, abs(volume), inertia, centres, rings=points[:, 0])


def about_centre(points: Sequence[tuple[float, float]]) -> Any:
    """Return the points of a profile from the centre of mass of the body, (n, 2) m."""
    found = np.array(points)
    x, w = leggauss(3)
    start, step = found[:-1, :, None], np.diff(found, axis=0)[:, :, None]
    r, z = np.moveaxis(start + step * (1 + x) / 2, 1, 0)
    slices = r**2 * step[:, 1] * w
    return found - [0.0, (slices * z).sum() / slices.sum()]


def given(bead: Any) -> Body:
    """Return the solid of a body whose numbers are given, with the extent of a sphere."""
    of = bead.given
    return Solid(
        of.mass, of.volume, of.inertia, np.zeros((1, 3)), balls=bead.radius,
        centre_of_volume=of.centre_of_volume,
    )  # fmt: skip
