"""What resists the bead: drag, as mobilities by place."""

from __future__ import annotations

from tweezer.fluid.binding import drag
from tweezer.fluid.drag import DRAG_KERNEL, Drag, Mobility, Stokes, by_axis, stokes

__all__ = ["DRAG_KERNEL", "Drag", "Mobility", "Stokes", "by_axis", "drag", "stokes"]
