from .body import BodyEquilibrium, BodyTrap
from .heights import trap_over_heights
from .holding import Lifetime
from .least_power import LeastPower, least_power
from .trap import Efficiency, Equilibrium, Escape, Trap, characterise

__all__ = [
    "BodyEquilibrium",
    "BodyTrap",
    "Efficiency",
    "Equilibrium",
    "Escape",
    "LeastPower",
    "Lifetime",
    "Trap",
    "characterise",
    "least_power",
    "trap_over_heights",
]
