from .calibration import (
    AxisCalibration,
    Calibration,
    Estimate,
    SpectrumFit,
    calibrate,
    in_metres,
)
from .depth import DepthFit, Minimum, Parameter, fit_depth
from .derived import derived_quantities
from .driving import Answer
from .escape import Escape
from .findings import Finding
from .first_passage import EscapeTimes, escape_times
from .free import Diffusion, FreeAxis, FreeTrack, Inferred
from .heights import trap_over_heights
from .histogram import Potential, potential
from .holding import Lifetime
from .inference import FittedKey, SceneFit, fit
from .least_power import LeastPower, least_power
from .recording import Recording, Track, load_recording, load_track
from .spectra import (
    TrappedBead,
    autocovariance,
    mean_squared_displacement,
    power_spectrum,
    standard_error,
    statistical_inefficiency,
)
from .summary import Summary, summarise
from .surface import Surface, find_wall
from .together import Together, together
from .trajectories import Trajectory, diffusion, load_trajectories
from .trap import Efficiency, Equilibrium, Trap, characterise
from .tuning import Tuned, Tuning, tune
from .wall import Height
from .whittle import Detected

__all__ = [
    "Answer",
    "AxisCalibration",
    "Calibration",
    "DepthFit",
    "Detected",
    "Diffusion",
    "Efficiency",
    "Equilibrium",
    "Escape",
    "EscapeTimes",
    "Estimate",
    "Finding",
    "FittedKey",
    "FreeAxis",
    "FreeTrack",
    "Height",
    "Inferred",
    "LeastPower",
    "Lifetime",
    "Minimum",
    "Parameter",
    "Potential",
    "Recording",
    "SceneFit",
    "SpectrumFit",
    "Summary",
    "Surface",
    "Together",
    "Track",
    "Trajectory",
    "Trap",
    "TrappedBead",
    "Tuned",
    "Tuning",
    "autocovariance",
    "calibrate",
    "characterise",
    "derived_quantities",
    "diffusion",
    "escape_times",
    "find_wall",
    "fit",
    "fit_depth",
    "in_metres",
    "least_power",
    "load_recording",
    "load_track",
    "load_trajectories",
    "mean_squared_displacement",
    "potential",
    "power_spectrum",
    "standard_error",
    "statistical_inefficiency",
    "summarise",
    "together",
    "trap_over_heights",
    "tune",
]
