"""Stokes's drag of a sphere far from everything, without inertia of the fluid (2.13-2.15)."""

from __future__ import annotations

import math


def drag_of_translation(viscosity: float, radius: float) -> float:
    """beta_v = 6 pi mu r, kg/s (2.15), from the viscosity, Pa s, and the radius, m."""
    return 6 * math.pi * viscosity * radius


def drag_of_rotation(viscosity: float, radius: float) -> float:
    """beta_w = 8 pi mu r^3, N m s, from the viscosity, Pa s, and the radius, m."""
    return 8 * math.pi * viscosity * radius**3
