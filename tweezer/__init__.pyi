from .beads.correlations import cross_correlation, cross_spectrum
from .calibration import Calibration, Surface, calibrate, find_wall, potential
from .calibration.pair import PairCalibration, calibrate_pair
from .comparison import Comparison, compare
from .dynamics import Event, bind, capture, chosen, flip
from .dynamics.loops import loop_moments
from .ensembles import escape_times
from .ensembles.ensemble import ensemble
from .fluid import wall_mobilities
from .fluid.medium import MediumProperties, medium
from .fluid.pair import pair_mobilities
from .fluid.resistance.of_scene import resistance
from .fluid.resistance.resistance import Resistance
from .forces.chains import chain_force
from .microrheology.analysis import rheology
from .microrheology.results import Rheology
from .optics import (
    SceneLight,
    absorbed_power,
    optical_force,
    optical_force_error,
    optical_jacobian,
    optical_torque,
)
from .optics.bodies.files import load_t_matrix
from .optics.bodies.shapes import t_matrix
from .optics.bodies.t_matrix import TMatrix
from .optics.detected import detect
from .optics.mutual_scattering import optical_binding
from .optics.of_scene import light
from .optics.optimised import Optimum, optimise
from .optics.recoil import recoil
from .orientations import rotation
from .plots.report import write_report
from .reading import Recording, Track, load_recording, load_track
from .results.io import load_run, save_run, scene_of
from .results.saving import load, save
from .runs import Summary, Tuned, Tuning, summarise, tune
from .runs.response import response
from .runs.simulation import simulate
from .scene import Scene, load_scene, shipped_scenes
from .scene.bead import BeadProperties, bead_properties
from .sweeps.sweep import sweep
from .tracking import (
    ChainFit,
    DepthFit,
    FittedKey,
    SceneFit,
    Stretched,
    fit,
    fit_chain,
    fit_depth,
    stretch,
)
from .trap import BodyTrap, LeastPower, Lifetime, Trap, characterise, trap_over_heights
from .trap.least_power import least_power
from .trap.time_sharing import TimeSharing, time_sharing
from .values.errors import (
    IntegrationError,
    PhysicsWarning,
    ResultError,
    SceneError,
    TweezerError,
    UnitWarning,
)
from .values.units import QuantitiesLike, QuantityLike
from .values.version import __version__
from .viewing import view

__all__ = [
    "BeadProperties",
    "BodyTrap",
    "Calibration",
    "ChainFit",
    "Comparison",
    "DepthFit",
    "Event",
    "FittedKey",
    "IntegrationError",
    "LeastPower",
    "Lifetime",
    "MediumProperties",
    "Optimum",
    "PairCalibration",
    "PhysicsWarning",
    "QuantitiesLike",
    "QuantityLike",
    "Recording",
    "Resistance",
    "ResultError",
    "Rheology",
    "Scene",
    "SceneError",
    "SceneFit",
    "SceneLight",
    "Stretched",
    "Summary",
    "Surface",
    "TMatrix",
    "TimeSharing",
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
    "calibrate_pair",
    "capture",
    "chain_force",
    "characterise",
    "chosen",
    "compare",
    "cross_correlation",
    "cross_spectrum",
    "detect",
    "ensemble",
    "escape_times",
    "find_wall",
    "fit",
    "fit_chain",
    "fit_depth",
    "flip",
    "least_power",
    "light",
    "load",
    "load_recording",
    "load_run",
    "load_scene",
    "load_t_matrix",
    "load_track",
    "loop_moments",
    "medium",
    "optical_binding",
    "optical_force",
    "optical_force_error",
    "optical_jacobian",
    "optical_torque",
    "optimise",
    "pair_mobilities",
    "potential",
    "recoil",
    "resistance",
    "response",
    "rheology",
    "rotation",
    "save",
    "save_run",
    "scene_of",
    "shipped_scenes",
    "simulate",
    "stretch",
    "summarise",
    "sweep",
    "t_matrix",
    "time_sharing",
    "trap_over_heights",
    "tune",
    "view",
    "wall_mobilities",
    "write_report",
]
