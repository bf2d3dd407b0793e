"""Spheroids and clusters of spheres as rigid bodies: mass, inertia and size."""

from __future__ import annotations

import copy
import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from tweezer.scene.body import Body, Tensor


def _axis(orientation: Any, normal: float, i: int) -> Any:
    """Return the component along `normal` z of the body's axis `i`, turned by Euler parameters."""
    w, x, y, z = np.moveaxis(np.asarray(orientation, float), -1, 0)
    rows = (2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z)
    return normal * rows[i] / (w * w + x * x + y * y + z * z)


def _vector(values: Any) -> tuple[float, float, float]:
    """Return three numbers as a tuple."""
    x, y, z = map(float, values)
    return x, y, z


class _Turned(Body):
    """A body whose extent depends on its orientation."""

    _start: tuple[float, ...] = (1.0, 0.0, 0.0, 0.0)

    def starting(self, orientation: tuple[float, ...]) -> Body:
        """Return this body with Euler parameters at the start; see `Body.starting`."""
        found = copy.copy(self)
        found._start = orientation
        return found


class Spheroid(_Turned):
    """A homogeneous ellipsoid of revolution about the body's z axis.

    Parameters
    ----------
    across, along : float
        Semi-axes across and along the axis, m.
    density : float
        Density, kg/m^3.
    """

    def __init__(self, across: float, along: float, density: float):
        self.size = max(across, along)
        self.volume = 4 / 3 * math.pi * across**2 * along
        self.mass = density * self.volume
        side = self.mass * (across**2 + along**2) / 5
        self.moments_of_inertia = (side, side, 2 / 5 * self.mass * across**2)
        self._across, self._along = across, along

    def support(self, normal: float = 1.0, orientation: Any = None) -> Any:
        """Return the distance of the centre from a plane that the body touches; see `Body`."""
        turned = self._start if orientation is None else orientation
        tilt = _axis(turned, normal, 2) ** 2
        return np.sqrt(self._along**2 * tilt + self._across**2 * (1 - tilt))


class Cluster(_Turned):
    """A rigid cluster of homogeneous spheres, about its centre of mass.

    Parameters
    ----------
    centres : sequence of tuple
        Centres of the spheres from the centre of mass, m.
    radii : sequence of float
        Radii, m.
    densities : sequence of float
        Density of each sphere, kg/m^3.
    """

    def __init__(
        self,
        centres: Sequence[tuple[float, float, float]],
        radii: Sequence[float],
        densities: Sequence[float],
    ):
        at, r = np.array(centres, float), np.array(radii, float)
        volumes = 4 / 3 * math.pi * r**3
        masses = volumes * np.array(densities, float)
        self.size = float((np.linalg.norm(at, axis=1) + r).max())
        self.volume, self.mass = float(volumes.sum()), float(masses.sum())
        self.centre_of_volume = _vector(volumes @ at / self.volume)
        own = 2 / 5 * masses * r**2
        tensor = (own + masses * (at**2).sum(axis=1)).sum() * np.eye(3)
        self._inertia = tensor - np.einsum("k,ki,kj->ij", masses, at, at)
        self.moments_of_inertia = _vector(np.linalg.eigvalsh(self._inertia))
        self._at, self._radii = at, r

    @property
    def inertia(self) -> Tensor:
        """Inertia tensor about the centre of mass in the body's frame, (3, 3) kg m^2."""
        return tuple(_vector(row) for row in self._inertia)

    def support(self, normal: float = 1.0, orientation: Any = None) -> Any:
        """Return the distance of the centre from a plane that the body touches; see `Body`."""
        turned = self._start if orientation is None else orientation
        z = np.stack([_axis(turned, normal, i) for i in range(3)], axis=-1)
        return (self._radii - z @ self._at.T).max(axis=-1)
