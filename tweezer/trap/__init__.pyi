from .body import BodyEquilibrium, BodyTrap
from .heights import trap_over_heights
from .holding import Lifetime
from .least_power import LeastPower, least_power
from .time_sharing import TimeSharing, time_sharing
from .trap import Efficiency, Equilibrium, Escape, Trap, characterise

__all__ = [
    "BodyEquilibrium",
    "BodyTrap",
    "Efficiency",
    "Equilibrium",
    "Escape",
    "LeastPower",
    "Lifetime",
    "TimeSharing",
    "Trap",
    "characterise",
    "least_power",
    "time_sharing",
    "trap_over_heights",
]
