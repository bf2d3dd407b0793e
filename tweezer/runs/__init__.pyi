from .derived import derived_quantities
from .simulation import simulate
from .summary import Summary, summarise
from .tuning import Tuned, Tuning, tune

__all__ = [
    "Summary",
    "Tuned",
    "Tuning",
    "derived_quantities",
    "simulate",
    "summarise",
    "tune",
]
