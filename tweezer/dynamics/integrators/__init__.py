"""Compiled methods of integration in time; the loops have no Python in them."""

from tweezer.dynamics.integrators import explicit, exponential
from tweezer.dynamics.integrators.dop853 import DOP853
from tweezer.dynamics.integrators.dormand_prince import DORMAND_PRINCE
from tweezer.dynamics.integrators.system import (
    COLLAPSED,
    EXHAUSTED,
    FULL,
    NOT_FINITE,
    RATES,
    REACHED,
    Control,
    Records,
    System,
)

#: explicit methods by name
TABLEAUX = {"dormand-prince": DORMAND_PRINCE, "dop853": DOP853}

__all__ = [
    "COLLAPSED",
    "EXHAUSTED",
    "FULL",
    "NOT_FINITE",
    "RATES",
    "REACHED",
    "TABLEAUX",
    "Control",
    "Records",
    "System",
    "explicit",
    "exponential",
]
