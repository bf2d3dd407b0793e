"""Rigid bodies: their length scale, mass, inertia, and the gap to a plane."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any


class Body(ABC):
    """A rigid body, with size, mass, inertia and gap to a plane; a scene's is `Bead.body`."""

    size: float
    """length scale, m: the radius of a sphere"""
    volume: float
    """volume, m^3"""
    mass: float
    """mass m, kg"""
    moments_of_inertia: tuple[float, float, float]
    """principal moments I11, I22, I33 about the centre of mass (A.13), kg m^2"""

    def starting(self, orientation: tuple[float, ...]) -> Body:  # noqa: ARG002
        """Return this body with Euler parameters at the start, which `support` takes by default."""
        return self

    @abstractmethod
    def support(self, normal: float = 1.0, orientation: Any = None) -> Any:
        """Return the distance of the centre from a plane across the light that the body touches, m.

        Parameters
        ----------
        normal : float
            Direction along z from the plane to the body, 1 or -1.
        orientation : array_like, shape (..., 4), optional
            Euler parameters. Default: the initial orientation in a scene.
        """

    def gap(self, plane: tuple[float, float], z: Any, orientation: Any = None) -> Any:
        """Return the distance of the surface from a plane, m, negative if the plane cuts the body.

        Parameters
        ----------
        plane : tuple of float
            Position along z, m, and normal of the plane, as in `Wall.planes`.
        z : array_like
            Position of the centre of mass along z, m.
        orientation : array_like, shape (..., 4), optional
            Euler parameters, as in `support`.
        """
        position, normal = plane
        return normal * (z - position) - self.support(normal, orientation)
