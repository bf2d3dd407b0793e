"""Equations of motion of the bead, and their integration in time."""

from tweezer.compiled import compilation  # noqa: F401 (first: finds where to keep what it compiles)
from tweezer.dynamics.budget import error_budget, model_error, unscaled
from tweezer.dynamics.choose import chosen, decided
from tweezer.dynamics.events import Event, Occurrence, closest_approach, lens_touched, loss
from tweezer.dynamics.integrate import Integration, integrate
from tweezer.dynamics.models import EquationsOfMotion, Motion, bind
from tweezer.dynamics.pose_events import capture, flip
from tweezer.dynamics.problem import Problem, bound_once

__all__ = [
    "EquationsOfMotion",
    "Event",
    "Integration",
    "Motion",
    "Occurrence",
    "Problem",
    "bind",
    "bound_once",
    "capture",
    "chosen",
    "closest_approach",
    "decided",
    "error_budget",
    "flip",
    "integrate",
    "lens_touched",
    "loss",
    "model_error",
    "unscaled",
]
