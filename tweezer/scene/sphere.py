"""The sphere as a body, and Stokes's drag of it far from everything (2.13-2.15)."""

from __future__ import annotations

import math
from typing import Any

from tweezer.scene.body import Body


class Sphere(Body):
    """A sphere, whose mass may be distributed unevenly about its centre.

    Parameters
    ----------
    radius : float
        Radius, m.
    density : float
        Mean density, kg/m^3.
    moments_of_inertia : tuple of float, optional
        Principal moments, kg m^2; those of a uniform sphere if not given.
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
        """Return the radius, m: a sphere is the same from all sides."""
        return self.size


def drag_of_translation(viscosity: float, radius: float) -> float:
    """Return Stokes's drag coefficient beta_v = 6 pi mu r (2.15), kg/s.

    viscosity: mu, Pa s. radius: r, m.
    """
    return 6 * math.pi * viscosity * radius


def drag_of_rotation(viscosity: float, radius: float) -> float:
    """Return Stokes's rotational drag coefficient beta_w = 8 pi mu r^3 (2.15), N m s.

    viscosity: mu, Pa s. radius: r, m.
    """
    return 8 * math.pi * viscosity * radius**3
