"""The sphere as a rigid body, and its Stokes drag far from walls (2.13-2.15)."""

from __future__ import annotations

import math
from typing import Any

from tweezer.scene.body import Body


class Sphere(Body):
    """A sphere, whose mass may be distributed unevenly around its centre.

    Parameters
    ----------
    radius : float
        Radius, m.
    density : float
        Mean density, kg/m^3.
    moments_of_inertia : tuple of float, optional
        Principal moments, kg m^2. Default: those of a uniform sphere.
    """

    def __init__(
        self,
        radius: float,
        density: float,
        moments_of_inertia: tuple[float, float, float] | None = None,
    ):
        self.size = radius
        self.volume = 4 / 3 * math.pi * radius**3
        self.mass = density * self.volume
        uniform = 2 / 5 * self.mass * radius**2
        self.moments_of_inertia = moments_of_inertia or (uniform, uniform, uniform)

    def support(self, normal: float = 1.0, orientation: Any = None) -> float:  # noqa: ARG002
        """Return the radius, m, which is the same in all directions."""
        return self.size


def sphere(bead: Any) -> Sphere:
    """Return the sphere of a bead, which encloses a body in a T-matrix file."""
    return Sphere(bead.radius, bead.density, bead.moments_of_inertia)


def drag_of_translation(viscosity: float, radius: float) -> float:
    """Return the Stokes drag coefficient beta_v = 6 pi mu r (2.15), kg/s.

    `viscosity` is mu, Pa s, and `radius` is r, m.
    """
    return 6 * math.pi * viscosity * radius


def drag_of_rotation(viscosity: float, radius: float) -> float:
    """Return the rotational Stokes drag coefficient beta_w = 8 pi mu r^3 (2.15), N m s.

    `viscosity` is mu, Pa s, and `radius` is r, m.
    """
    return 8 * math.pi * viscosity * radius**3
