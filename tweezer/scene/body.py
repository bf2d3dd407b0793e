"""Rigid bodies: their length scale, mass, inertia, and the gap to a plane."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any, TypeAlias

#: Rows of a symmetric tensor in the body's frame
Tensor: TypeAlias = tuple[tuple[float, float, float], ...]


class Body(ABC):
    """A rigid body, with size, mass, inertia and gap to a plane; a scene's is `Bead.body`.

    Its position is its centre of mass, which is also the origin of its frame.
    """

    size: float
    """length scale, m: the radius of a sphere"""
    volume: float
    """volume, m^3"""
    mass: float
    """mass m, kg"""
    moments_of_inertia: tuple[float, float, float]
    """principal moments I11, I22, I33 about the centre of mass (A.13), kg m^2"""
    centre_of_volume: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """point at which buoyancy acts, from the centre of mass in the body's frame, m"""

    @property
    def inertia(self) -> Tensor:
        """Inertia tensor about the centre of mass in the body's frame, (3, 3) kg m^2."""
        a, b, c = self.moments_of_inertia
        return (a, 0.0, 0.0), (0.0, b, 0.0), (0.0, 0.0, c)

    def starting(self, orientation: tuple[float, ...]) -> Body:  # noqa: ARG002
        """Return this body with Euler parameters at the start, which `support` takes by default."""
        return self

    @abstractmethod
    def support(self, normal: float = 1.0, orientation: Any = None) -> Any:
        """Return the distance of the position from a plane across the light that it touches, m.

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
