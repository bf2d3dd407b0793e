"""Bead in a gas, as its oscillation determines it: mass, density and the line along each axis."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

from tweezer.calibration.quantities import DRAG
from tweezer.values.measured import STANDARD, Measured, Quantity, Result
from tweezer.values.shown import Card

MASS = Quantity("mass", "kg", "mass of the bead", kind=STANDARD, shown="fg")
DENSITY = Quantity("density", "kg/m^3", "density of the bead", kind=STANDARD)
RADIUS = Quantity("radius", "m", "radius of the bead", kind=STANDARD, shown="nm")
PRESSURE = Quantity("pressure", "Pa", "pressure of the gas", kind=STANDARD)
RESONANCE = Quantity("resonance_frequency", "1/s", "resonance", kind=STANDARD, shown="kHz")
DAMPING = Quantity("damping_rate", "1/s", "damping rate", kind=STANDARD, shown="1/s")
#: Half the width of a 95 % interval, in standard uncertainties.
INTERVAL = 1.96


@dataclass(frozen=True)
class Resonance:
    """Line of a bead in gas along one axis: x'' + Gamma x' + Omega^2 x = thermal noise."""

    frequency: float
    """resonance frequency Omega/2 pi, Hz"""
    frequency_uncertainty: float
    """standard uncertainty, Hz"""
    damping_rate: float
    """damping rate Gamma, 1/s, of this axis alone"""
    damping_rate_uncertainty: float
    """standard uncertainty, 1/s"""
    damping_times: float
    """length of the record, in damping times 1/Gamma"""

    @property
    def quality_factor(self) -> float:
        """Quality factor Omega/Gamma."""
        return 2 * math.pi * self.frequency / self.damping_rate

    def quantities(self) -> Iterator[Measured]:
        """Yield resonance frequency and damping rate."""
        yield RESONANCE(self.frequency, self.frequency_uncertainty)
        yield DAMPING(self.damping_rate, self.damping_rate_uncertainty)

    @property
    def words(self) -> str:
        """The line in words."""
        resonance, damping = (each.words for each in self.quantities())
        return f"resonance {resonance}; damping rate {damping}; Q = {self.quality_factor:.3g}"


@dataclass(frozen=True, repr=False)
class LevitatedBead(Result):
    """Bead in a gas, whose mass m follows from the drag beta and the damping rate beta/m.

    The uncertainties include those of the damping rate, of the drag in the gas and of the given
    quantities. The bound of the error of the drag counts as two standard uncertainties.
    """

    QUANTITIES: ClassVar = (MASS, DENSITY, RADIUS, DRAG, PRESSURE)

    mass: float
    """mass m, kg"""
    mass_uncertainty: float
    """standard uncertainty, kg"""
    density: float
    """density, kg/m^3: given, or of the mass in the volume of the given radius"""
    density_uncertainty: float
    """standard uncertainty, kg/m^3"""
    radius: float
    """radius, m: given, or that of the mass with the given density"""
    radius_uncertainty: float
    """standard uncertainty, m"""
    drag: float
    """drag beta in the gas, kg/s"""
    drag_uncertainty: float
    """standard uncertainty, kg/s"""
    pressure: float
    """pressure of the gas, Pa"""
    pressure_uncertainty: float
    """standard uncertainty, Pa"""
    knudsen: float
    """Knudsen number: mean free path over the radius"""
    gas: str
    """name of the gas"""

    @property
    def mass_interval(self) -> tuple[float, float]:
        """Confidence interval (95 %) of the mass, kg, in which its logarithm is normal."""
        half = INTERVAL * self.mass_uncertainty / self.mass
        return self.mass * math.exp(-half), self.mass * math.exp(half)

    def quantities(self) -> Iterator[Measured]:
        """Yield mass, density, radius, drag and pressure."""
        for each in self.QUANTITIES:
            yield each(getattr(self, each.name), getattr(self, f"{each.name}_uncertainty"))

    def card(self) -> Card:
        """Return the card with all numbers."""
        rows = tuple(each.row() for each in self.quantities())
        return Card("LevitatedBead", self.gas, rows)

    @property
    def line(self) -> str:
        """The bead in one line."""
        found = self.numbers
        low, high = (f"{MASS.scale[0] * each:.3g}" for each in self.mass_interval)
        return (
            f"bead in {self.gas} (Kn = {self.knudsen:.3g}): mass {found['mass'].words}, "
            f"95 % from {low} to {high} fg; density {found['density'].words}; "
            f"radius {found['radius'].words}"
        )
