from .beads import beads_figure
from .body import body_trap_figure
from .calibration import calibration_figure, draw_calibration
from .depth import depth_figure
from .ensemble import ensemble_figure
from .fit import fit_figure
from .heights import heights_figure
from .optimum import optimum_figure
from .rheology import rheology_figure
from .rotation import rotation_figure
from .run import run_figure
from .sweeps import sweep_figure
from .trap import trap_figure
from .tuning import tuning_figure

__all__ = [
    "beads_figure",
    "body_trap_figure",
    "calibration_figure",
    "depth_figure",
    "draw_calibration",
    "ensemble_figure",
    "fit_figure",
    "heights_figure",
    "optimum_figure",
    "rheology_figure",
    "rotation_figure",
    "run_figure",
    "sweep_figure",
    "trap_figure",
    "tuning_figure",
]
