"""Figures of runs, traps, calibrations and fits, in the look of `tweezer.style`.

Each function returns a Matplotlib Figure and changes no global state.
"""

from tweezer.plots.calibration import calibration_figure, draw_calibration
from tweezer.plots.depth import depth_figure
from tweezer.plots.fit import fit_figure
from tweezer.plots.heights import heights_figure
from tweezer.plots.run import run_figure
from tweezer.plots.trap import trap_figure
from tweezer.plots.tuning import tuning_figure

__all__ = [
    "calibration_figure",
    "depth_figure",
    "draw_calibration",
    "fit_figure",
    "heights_figure",
    "run_figure",
    "trap_figure",
    "tuning_figure",
]
