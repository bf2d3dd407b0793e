"""What a run, a recording and a trap tell: derived quantities, outcome, calibration, worth."""

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
from tweezer.analysis.derived import derived_quantities
from tweezer.analysis.recording import Recording, load_recording
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
    "Efficiency",
    "Equilibrium",
    "Escape",
    "EscapeTimes",
    "Estimate",
    "Potential",
    "Recording",
    "SpectrumFit",
    "Summary",
    "Trap",
    "TrappedBead",
    "Tuned",
    "Tuning",
    "autocovariance",
    "calibrate",
    "characterise",
    "derived_quantities",
    "escape_times",
    "load_recording",
    "mean_squared_displacement",
    "potential",
    "power_spectrum",
    "standard_error",
    "statistical_inefficiency",
    "summarise",
    "tune",
]
