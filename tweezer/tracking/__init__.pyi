from .depth import DepthFit, Minimum, Parameter, fit_depth
from .inference import FittedKey, SceneFit, fit

__all__ = [
    "DepthFit",
    "FittedKey",
    "Minimum",
    "Parameter",
    "SceneFit",
    "fit",
    "fit_depth",
]
