from .calibration import calibrate, in_metres
from .driving import Answer
from .findings import Finding
from .free import Diffusion, FreeAxis, FreeTrack, Inferred
from .histogram import Potential, potential
from .levitated import LevitatedBead, Resonance
from .results import AxisCalibration, Calibration, Estimate, SpectrumFit
from .spectra import (
    TrappedBead,
    autocovariance,
    mean_squared_displacement,
    power_spectrum,
    standard_error,
    statistical_inefficiency,
)
from .surface import Surface, find_wall
from .together import Together, together
from .trajectories import Trajectory, diffusion, load_trajectories
from .wall import Height
from .whittle import Detected

__all__ = [
    "Answer",
    "AxisCalibration",
    "Calibration",
    "Detected",
    "Diffusion",
    "Estimate",
    "Finding",
    "FreeAxis",
    "FreeTrack",
    "Height",
    "Inferred",
    "LevitatedBead",
    "Potential",
    "Resonance",
    "SpectrumFit",
    "Surface",
    "Together",
    "Trajectory",
    "TrappedBead",
    "autocovariance",
    "calibrate",
    "diffusion",
    "find_wall",
    "in_metres",
    "load_trajectories",
    "mean_squared_displacement",
    "potential",
    "power_spectrum",
    "standard_error",
    "statistical_inefficiency",
    "together",
]
