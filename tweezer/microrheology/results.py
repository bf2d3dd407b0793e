"""Result of microrheology: moduli of a medium over frequency, and the trap in it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from tweezer.calibration.by_axis import ByAxis
from tweezer.calibration.findings import Finding, in_words
from tweezer.calibration.left_out import NOTHING, LeftOut
from tweezer.calibration.quantities import STIFFNESS
from tweezer.values.measured import DIMENSIONS, STANDARD, Measured, Quantity, Result, figure
from tweezer.values.printed import in_unit, printed, with_error
from tweezer.values.shown import Card, Row, Table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SOLVENT = Quantity("solvent_viscosity", "Pa s", "viscosity of the solvent", kind=STANDARD)
EQUIPARTITION = STIFFNESS._replace(name="equipartition", about="stiffness by equipartition")
#: Rows of the printed table of moduli in a decade of frequency
_PER_DECADE = 2

Interval = tuple[float, float]


@dataclass(frozen=True)
class Modulus:
    """Storage or loss modulus over frequency, with 95 % confidence intervals."""

    values: tuple[float, ...]
    """modulus at each frequency, Pa"""
    low: tuple[float, ...]
    """lower end of each interval, Pa"""
    high: tuple[float, ...]
    """upper end of each interval, Pa"""


@dataclass(frozen=True)
class Element:
    """Maxwell element of a medium: a viscosity that relaxes in a time."""

    viscosity: float
    """eta, Pa s"""
    viscosity_interval: Interval
    """95 % confidence interval of `viscosity`, Pa s"""
    time: float
    """relaxation time tau, s; 0 for the solvent, which is a dashpot"""
    time_interval: Interval
    """95 % confidence interval of `time`, s"""


@dataclass(frozen=True)
class Residuals:
    """Power spectral density of the positions in bins of frequency, compared with the fit."""

    frequencies: tuple[float, ...]
    """mean frequency of each bin, Hz"""
    density: tuple[float, ...]
    """one-sided density of the data, m^2/Hz"""
    fitted: tuple[float, ...]
    """density of the fit, m^2/Hz, which includes aliases, exposure and noise"""
    ratios: tuple[float, ...]
    """mean of data over fit"""
    uncertainties: tuple[float, ...]
    """standard uncertainty of each ratio for a correct fit"""


@dataclass(frozen=True)
class AxisRheology:
    """Trap and spectrum along one axis of a recording in a viscoelastic medium."""

    axis: str
    """"x", "y" or "z\""""
    stiffness: float
    """k of the trap, by the likelihood, N/m"""
    stiffness_uncertainty: float
    """standard uncertainty of `stiffness`, N/m"""
    equipartition: float
    """k_B T over the variance of the positions, N/m"""
    equipartition_uncertainty: float
    """standard uncertainty of `equipartition`, N/m"""
    noise: float
    """standard deviation of the white noise, given or fitted, m"""
    p_value: float
    """p-value of the fitted spectrum (Bartlett's test)"""
    residuals: Residuals
    """spectrum, compared with the fit"""
    findings: tuple[Finding, ...]
    """findings about the record along this axis"""


@dataclass(frozen=True, repr=False)
class Rheology(Result):
    """Storage and loss modulus of the medium about a trapped bead, from its thermal motion, SI."""

    QUANTITIES: ClassVar = (STIFFNESS, EQUIPARTITION, SOLVENT)

    name: str
    """name of the recording"""
    temperature: float
    """temperature of the medium, K"""
    radius: float
    """radius of the bead, m"""
    exposure: float | None
    """exposure time of a sample, s; None if unknown and taken as 0"""
    samples: int
    """number of samples"""
    step: float
    """sampling interval, s"""
    note: str
    """samples that were omitted from the recording, in words"""
    band: tuple[float, float]
    """lowest and highest frequency at which the moduli may be read, Hz"""
    frequencies: tuple[float, ...]
    """frequencies of the moduli, Hz"""
    storage: Modulus
    """storage modulus G'"""
    loss: Modulus
    """loss modulus G''"""
    elements: tuple[Element, ...]
    """the solvent, then the Maxwell elements in the order of their times"""
    noisy: bool
    """whether white noise was fitted"""
    axes: ByAxis[AxisRheology]
    """trap along each axis, by index or by name: axes["x"]"""
    remarks: tuple[Finding, ...]
    """findings about the medium"""
    inertia: float
    """largest relative change of the drag by fluid inertia, which is neglected"""
    left_out: LeftOut = NOTHING
    """drift and bands left out of the record, and the frequency range of the fit"""

    @property
    def findings(self) -> tuple[Finding, ...]:
        """All findings, first those about the record along each axis."""
        return tuple(
            dict.fromkeys([*(f for each in self.axes for f in each.findings), *self.remarks])
        )

    def plot(self) -> Figure:
        """Draw the moduli and the spectra: `tweezer.plots.rheology_figure`."""
        return figure("rheology_figure", self)

    def quantities(self) -> Iterator[Measured]:
        """Yield both stiffnesses along x, y and z, NaN for absent axes, and the solvent."""
        names = DIMENSIONS["axis"]
        found = np.full((4, len(names)), np.nan)
        for each in self.axes:
            found[:, names.index(each.axis)] = (
                each.stiffness, each.stiffness_uncertainty,
                each.equipartition, each.equipartition_uncertainty,
            )  # fmt: skip
        yield STIFFNESS(*found[:2])
        yield EQUIPARTITION(*found[2:])
        low, high = self.elements[0].viscosity_interval
        yield SOLVENT(self.elements[0].viscosity, (high - low) / (2 * 1.96))

    def words(self) -> dict[str, str]:
        """Return whether the moduli can be trusted, and the findings against them."""
        outcome = "not to be trusted" if self.findings else "determined"
        return {"outcome": outcome, "caveat": in_words(self.findings)}

    def card(self) -> Card:
        """Return the card with the traps, the medium and the moduli."""
        rows = [
            Row(
                f"stiffness, {each.axis}",
                STIFFNESS(each.stiffness, each.stiffness_uncertainty).words,
                in_words(each.findings),
            )
            for each in self.axes
        ]
        rows += [
            Row("temperature", f"{self.temperature:.5g} K"),
            Row("samples", f"{self.samples}, {1 / self.step:.5g} Hz"),
            Row("moduli", self._readable, in_words(self.remarks)),
        ]
        notes = (self.note,) if self.note else ()
        return Card("Rheology", self.name, tuple(rows), (self._medium, self._moduli), notes)

    @property
    def _readable(self) -> str:
        """Band in which the moduli may be read, in words."""
        low, high = self.band
        return f"valid from {low:.3g} to {high:.5g} Hz"

    @property
    def _medium(self) -> Table:
        """Table of the elements."""
        rows = []
        for i, each in enumerate(self.elements):
            time = ("", "") if not i else _cells(each.time, *each.time_interval, "ms")
            name = f"element {i}" if i else "solvent"
            rows.append((name, *_cells(each.viscosity, *each.viscosity_interval, "mPa s"), *time))
        return Table(("medium", "viscosity, mPa s", "95 %", "time, ms", "95 %"), tuple(rows))

    @property
    def _moduli(self) -> Table:
        """Table of the moduli at a few frequencies."""
        at = np.log10(self.frequencies)
        few = np.arange(np.ceil(_PER_DECADE * at[0]), _PER_DECADE * at[-1] + 1) / _PER_DECADE
        shown = sorted({int(np.abs(at - each).argmin()) for each in few})
        rows = []
        for i in shown:
            cells = [
                cell
                for part in (self.storage, self.loss)
                for cell in _cells(part.values[i], part.low[i], part.high[i], "Pa")
            ]
            rows.append((f"{self.frequencies[i]:.4g}", *cells))
        return Table(("Hz", "G', Pa", "95 %", "G'', Pa", "95 %"), tuple(rows))

    def printed(self) -> Iterator[Table | str]:
        """Yield the tables and lines that the command prints."""
        yield self._medium
        yield self._moduli
        for each in self.axes:
            found = STIFFNESS(each.stiffness, each.stiffness_uncertainty).words
            beside = with_error(each.equipartition, each.equipartition_uncertainty, "pN/um")
            parts = [f"{each.axis}: stiffness {found}, by equipartition {beside}"]
            if each.noise:
                parts.append(f"noise {printed(each.noise, 'nm', 3)}")
            yield "; ".join((*parts, f"p = {each.p_value:.2g}"))
        yield (
            f"moduli: {self._readable}; neglected fluid inertia: up to {100 * self.inertia:.2g} % "
            "of the drag"
        )
        yield from (f"not trusted: {finding.text}" for finding in self.findings)


def _cells(value: float, low: float, high: float, unit: str) -> tuple[str, str]:
    """Return a number and its interval as texts in a unit, without its name."""
    return in_unit(value, unit, 3), f"{in_unit(low, unit, 3)} to {in_unit(high, unit, 3)}"
