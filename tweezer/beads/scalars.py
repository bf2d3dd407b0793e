"""Mobilities of two beads over their gap, in SI units."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tweezer.fluid.pair import NAMES
from tweezer.fluid.pair_table import PairTable, pair_table
from tweezer.values.arrays import Array


class At(NamedTuple):
    """Mobilities at gaps (n,), s/kg each; x along the line of centres, and y across it."""

    x11: Array
    x22: Array
    x12: Array
    y11: Array
    y22: Array
    y12: Array
    relative_x: Array
    """of the distance by opposite forces"""
    relative_y: Array
    slope_x: Array
    """derivative of `relative_x` by the gap, s/(kg m)"""


class Scalars(NamedTuple):
    """Mobilities of two beads."""

    radii: tuple[float, float]
    """m"""
    unit: float
    """1/(6 pi mu), m s/kg"""

    @property
    def table(self) -> PairTable:
        """The table for these radii."""
        return pair_table(self.radii[1] / self.radii[0])

    def at(self, gaps: Array) -> At:
        """Return the mobilities at gaps (n,), m."""
        radius = self.radii[0]
        value, slope = self.table.mobilities(np.asarray(gaps) / radius)
        own = {name: value[NAMES.index(name)] * self.unit / radius for name in At._fields[:-1]}
        return At(**own, slope_x=slope[NAMES.index("relative_x")] * self.unit / radius**2)
