from .analysis import (
    Calibration,
    DepthFit,
    Recording,
    Summary,
    Track,
    Trap,
    Tuned,
    Tuning,
    calibrate,
    characterise,
    escape_times,
    fit_depth,
    load_recording,
    load_track,
    potential,
    summarise,
    trap_over_heights,
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
    UnitWarning,
)
from .fluid import wall_mobilities
from .io import load_run, save_run, scene_of
from .optics import absorbed_power, optical_force, optical_jacobian, optical_torque
from .scene import Scene, load_scene, shipped_scenes
from .simulation import simulate
from .version import __version__

__all__ = [
    "BeadProperties",
    "Calibration",
    "DepthFit",
    "Event",
    "IntegrationError",
    "PhysicsWarning",
    "Recording",
    "ResultError",
    "Scene",
    "SceneError",
    "Summary",
    "Track",
    "Trap",
    "Tuned",
    "Tuning",
    "TweezerError",
    "UnitWarning",
    "__version__",
    "absorbed_power",
    "bead_properties",
    "bind",
    "calibrate",
    "capture",
    "characterise",
    "chosen",
    "ensemble",
    "escape_times",
    "fit_depth",
    "load_recording",
    "load_run",
    "load_scene",
    "load_track",
    "optical_force",
    "optical_jacobian",
    "optical_torque",
    "potential",
    "save_run",
    "scene_of",
    "shipped_scenes",
    "simulate",
    "summarise",
    "trap_over_heights",
    "tune",
    "wall_mobilities",
]
