"""Temperatures in the light of a scene with heat."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Heating:
    """Temperatures of the medium and of the bead in the light, and their effect on the motion."""

    water: float = 0.0
    """temperature rise of the medium about the bead, K"""
    water_error: float = 0.0
    bead: float = 0.0
    """temperature of the bead's surface above that of the medium about it, K"""
    bead_error: float = 0.0
    noise: float = 0.0
    """temperature of the thermal motion above that of the medium about the bead, K"""
    noise_error: float = 0.0
    drag: float = 1.0
    """drag over that of a bead as warm as the medium about it"""
    rotational_drag: float = 1.0
    """the same of the rotational drag"""
    drag_error: float = 0.0
    """relative error of the drag by those of the temperatures"""
