"""Mechanical properties of a scene's bead: mass, inertia, drag, weight (2.3, 2.11-2.15)."""

from __future__ import annotations

import math
from dataclasses import dataclass

from tweezer.fluid import stokes
from tweezer.scene import Scene, checked_scene


@dataclass(frozen=True)
class BeadProperties:
    """Numbers that enter the equations of motion, SI."""

    mass: float
    """m, kg"""
    displaced_mass: float
    """m_f, of the fluid in the place of the bead, kg"""
    moments_of_inertia: tuple[float, float, float]
    """I11, I22, I33 (A.13), kg m^2"""
    drag: float
    """beta_v (2.15), kg/s: Stokes's, far from everything"""
    rotational_drag: float
    """beta_w (2.15), N m s: Stokes's"""
    weight: tuple[float, float, float]
    """gravity (2.11) and buoyancy (2.12) as far as they act, N"""
    knudsen: float
    """mean free path over diameter (2.2.2)"""

    @property
    def relaxation_time(self) -> float:
        """m/beta_v, s: the epsilon of (4.6)."""
        return self.mass / self.drag

    @property
    def vorticity_time(self) -> float:
        """tau_f = r^2 rho_m/mu_m, s."""
        return 4.5 * self.displaced_mass / self.drag


def bead_properties(scene: Scene) -> BeadProperties:
    """Properties of the bead of `scene`."""
    r = checked_scene(scene).bead.radius
    volume = 4 / 3 * math.pi * r**3
    mass = scene.bead.density * volume
    g, forces = scene.forces.gravitational_acceleration, scene.forces
    sphere = 2 / 5 * mass * r**2
    lift = scene.medium.density * volume * g if forces.buoyancy else 0.0
    pull = mass * g if forces.gravity else 0.0
    free = stokes(scene.medium.viscosity, r)
    return BeadProperties(
        mass=mass,
        displaced_mass=scene.medium.density * volume,
        moments_of_inertia=scene.bead.moments_of_inertia or (sphere, sphere, sphere),
        drag=free.translation,
        rotational_drag=free.rotation,
        weight=(0.0, 0.0, lift - pull),
        knudsen=scene.medium.mean_free_path / (2 * r),
    )
