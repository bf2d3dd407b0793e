"""Analysis of runs, recordings and traps: derived quantities, outcome, calibration, depth."""

from tweezer.analysis.calibrate import (
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
from tweezer.analysis.depth import DepthFit, Minimum, Parameter, fit_depth
from tweezer.analysis.derived import derived_quantities
from tweezer.analysis.findings import Finding
from tweezer.analysis.recording import Recording, Track, load_recording, load_track
from tweezer.analysis.spectra import (
    TrappedBead,
    autocovariance,
    mean_squared_displacement,
    power_spectrum,
    standard_error,
    statistical_inefficiency,
)
from tweezer.analysis.summary import Summary, summarise
from tweezer.analysis.trap import Efficiency, Equilibrium, Escape, Trap, characterise
from tweezer.analysis.tune import Tuned, Tuning, tune

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
