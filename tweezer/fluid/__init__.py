"""Resistance of the fluid to the motion of a bead: mobilities by position, and fluid inertia."""

from __future__ import annotations

from tweezer.fluid.binding import drag, left_out_of_walls
from tweezer.fluid.drag import Drag, Mobility, Stokes, Walls, by_axis, stokes
from tweezer.fluid.memory import Modes, drag_at, enough_poles, modes, other_poles, single
from tweezer.fluid.mobilities import wall_mobilities
from tweezer.fluid.network import Decays, Network
from tweezer.fluid.reflection import LOWEST, Memory, memory_beside, memory_far, steady
from tweezer.fluid.resisted import Resisted
from tweezer.fluid.viscoelastic import network as network_of
from tweezer.fluid.wall import BesideWall

__all__ = [
    "LOWEST",
    "BesideWall",
    "Decays",
    "Drag",
    "Memory",
    "Mobility",
    "Modes",
    "Network",
    "Resisted",
    "Stokes",
    "Walls",
    "by_axis",
    "drag",
    "drag_at",
    "enough_poles",
    "left_out_of_walls",
    "memory_beside",
    "memory_far",
    "modes",
    "network_of",
    "other_poles",
    "single",
    "steady",
    "stokes",
    "wall_mobilities",
]
