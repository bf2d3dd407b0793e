from .analysis import Summary, Trap, characterise, summarise
from .bead import BeadProperties, bead_properties
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
    "IntegrationError",
    "PhysicsWarning",
    "ResultError",
    "Scene",
    "SceneError",
    "Summary",
    "Trap",
    "TweezerError",
    "bead_properties",
    "characterise",
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
]
