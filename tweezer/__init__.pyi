from .analysis import Summary, Trap, Tuned, Tuning, characterise, summarise, tune
from .bead import BeadProperties, bead_properties
from .dynamics import Event, bind, capture, chosen
from .errors import (
    IntegrationError,
    PhysicsWarning,
    ResultError,
    SceneError,
    TweezerError,
)
from .io import load_run, save_run, scene_of
from .optics import optical_force, optical_jacobian, optical_torque
from .scene import Scene, load_scene, shipped_scenes
from .simulation import simulate

__all__ = [
    "BeadProperties",
    "Event",
    "IntegrationError",
    "PhysicsWarning",
    "ResultError",
    "Scene",
    "SceneError",
    "Summary",
    "Trap",
    "Tuned",
    "Tuning",
    "TweezerError",
    "bead_properties",
    "bind",
    "capture",
    "characterise",
    "chosen",
    "load_run",
    "load_scene",
    "optical_force",
    "optical_jacobian",
    "optical_torque",
    "save_run",
    "scene_of",
    "shipped_scenes",
    "simulate",
    "summarise",
    "tune",
]
