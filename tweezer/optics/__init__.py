"""The force of focused light on the bead, by ray optics."""

from tweezer.optics.light import (
    Field,
    Light,
    light,
    optical_force,
    optical_jacobian,
    optical_torque,
)
from tweezer.optics.rays import fraction_through_pupil, grid, total_power

__all__ = [
    "Field",
    "Light",
    "fraction_through_pupil",
    "grid",
    "light",
    "optical_force",
    "optical_jacobian",
    "optical_torque",
    "total_power",
]
