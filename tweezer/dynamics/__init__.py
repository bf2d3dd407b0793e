"""Equations of motion of the bead, and their integration in time."""

from tweezer.dynamics.integrate import Integration, integrate
from tweezer.dynamics.models import EquationsOfMotion, Motion, bind

__all__ = ["EquationsOfMotion", "Integration", "Motion", "bind", "integrate"]
