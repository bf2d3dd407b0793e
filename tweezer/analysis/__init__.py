"""What a run and a trap tell: derived quantities, how a run ended, what a trap is worth."""

from tweezer.analysis.derived import derived_quantities
from tweezer.analysis.summary import Summary, summarise
from tweezer.analysis.trap import Efficiency, Equilibrium, Escape, Trap, characterise
from tweezer.analysis.tune import Tuned, Tuning, tune

__all__ = [
    "Efficiency",
    "Equilibrium",
    "Escape",
    "Summary",
    "Trap",
    "Tuned",
    "Tuning",
    "characterise",
    "derived_quantities",
    "summarise",
    "tune",
]
