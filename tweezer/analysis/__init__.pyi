from .calibration import (
    AxisCalibration,
    Calibration,
    EscapeTimes,
    Estimate,
    Potential,
    SpectrumFit,
    calibrate,
    escape_times,
    potential,
)
from .depth import DepthFit, Minimum, Parameter, fit_depth
from .derived import derived_quantities
from .findings import Finding
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
from .trap import Efficiency, Equilibrium, Escape, Trap, characterise
from .tuning import Tuned, Tuning, tune

__all__ = [
    "AxisCalibration",
    "Calibration",
    "DepthFit",
    "Efficiency",
    "Equilibrium",
    "Escape",
    "EscapeTimes",
    "Estimate",
    "Finding",
    "Minimum",
    "Parameter",
    "Potential",
    "Recording",
    "SpectrumFit",
    "Summary",
    "Track",
    "Trap",
    "TrappedBead",
    "Tuned",
    "Tuning",
    "autocovariance",
    "calibrate",
    "characterise",
    "derived_quantities",
    "escape_times",
    "fit_depth",
    "load_recording",
    "load_track",
    "mean_squared_displacement",
    "potential",
    "power_spectrum",
    "standard_error",
    "statistical_inefficiency",
    "summarise",
    "tune",
]
