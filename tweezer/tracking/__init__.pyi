from .chain_fit import ChainFit, fit_chain
from .depth import DepthFit, Minimum, Parameter, fit_depth
from .inference import FittedKey, SceneFit, fit
from .stretching import Stretched, stretch

__all__ = [
    "ChainFit",
    "DepthFit",
    "FittedKey",
    "Minimum",
    "Parameter",
    "SceneFit",
    "Stretched",
    "fit",
    "fit_chain",
    "fit_depth",
    "stretch",
]
