"""What resists the bead: drag, as mobilities by place, and the inertia of the fluid."""

from __future__ import annotations

from tweezer.fluid.binding import drag
from tweezer.fluid.drag import DRAG_KERNEL, Drag, Mobility, Stokes, by_axis, stokes
from tweezer.fluid.memory import Modes, drag_at, enough_poles, modes, other_poles, single

__all__ = [
    "DRAG_KERNEL",
    "Drag",
    "Mobility",
    "Modes",
    "Stokes",
    "by_axis",
    "drag",
    "drag_at",
    "enough_poles",
    "modes",
    "other_poles",
    "single",
    "stokes",
]
