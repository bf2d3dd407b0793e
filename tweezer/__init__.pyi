from .analysis import (
    Calibration,
    Recording,
    Summary,
    Trap,
    Tuned,
    Tuning,
    calibrate,
    characterise,
    escape_times,
    load_recording,
    potential,
    summarise,
    tune,
)
from .bead import BeadProperties, bead_properties
from .dynamics import Event, bind, capture, chosen
from .ensembles import ensemble
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
    "Calibration",
    "Event",
    "IntegrationError",
    "PhysicsWarning",
    "Recording",
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
    "calibrate",
    "capture",
    "characterise",
    "chosen",
    "ensemble",
    "escape_times",
    "load_recording",
    "load_run",
    "load_scene",
    "optical_force",
    "optical_jacobian",
    "optical_torque",
    "potential",
    "save_run",
    "scene_of",
    "shipped_scenes",
    "simulate",
    "summarise",
    "tune",
]
