"""Compiled methods of integration in time; the loops have no Python in them."""

from tweezer.dynamics.integrators import explicit, exponential
from tweezer.dynamics.integrators.system import (
    COLLAPSED,
    EXHAUSTED,
    FULL,
    NOT_FINITE,
    RATES,
    REACHED,
    Bound,
    Control,
    Records,
    System,
)

__all__ = [
    "COLLAPSED",
    "EXHAUSTED",
    "FULL",
    "NOT_FINITE",
    "RATES",
    "REACHED",
    "Bound",
    "Control",
    "Records",
    "System",
    "explicit",
    "exponential",
]
