from .analysis import rheology
from .medium import Medium, ViscoelasticBead
from .results import AxisRheology, Element, Modulus, Residuals, Rheology

__all__ = [
    "AxisRheology",
    "Element",
    "Medium",
    "Modulus",
    "Residuals",
    "Rheology",
    "ViscoelasticBead",
    "rheology",
]
