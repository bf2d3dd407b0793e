"""Maximum-likelihood fits of the spectrum of a trapped bead."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.constants import Boltzmann
from scipy.linalg import eigh
from scipy.optimize import minimize

from tweezer.analysis.spectra import TrappedBead, power_spectrum, statistical_inefficiency

Array = NDArray[np.float64]

#: Highest frequency of a fit, in units of the roll-off of the spectrum.
_RANGE = 20.0
#: Largest product of the number of ordinates and the square of the leaked fraction.
_LEAKAGE = 0.1
#: Smallest number of ordinates of a fit.
_LEAST_ORDINATES = 50
#: Number of blocks of a periodogram, evenly spaced in the logarithm of the frequency.
_BLOCKS = 1000

#: First step of a fit, in the logarithm of each parameter.
_FIRST_STEP = 0.2


@dataclass(frozen=True)
class Periodogram:
    """A periodogram averaged over blocks in which the spectrum is nearly constant."""

    frequencies: Array
    """(blocks,) Hz, the mean of each block"""
    density: Array
    """(blocks,) m^2/Hz"""
    counts: Array
    """(blocks,) number of ordinates"""
    step: float
    """s"""
    samples: float
    """length of the record; infinite if leakage is left out"""

    @classmethod
    def of(cls, positions: Array, step: float) -> Periodogram:
        """The periodogram of `positions` (n,), m, one every `step` (s)."""
        frequencies, density = power_spectrum(positions, step)
        n = frequencies.size
        edges = np.unique(np.geomspace(1, n + 1, min(_BLOCKS, n)).astype(int)) - 1
        starts = np.arange(n) if n <= _BLOCKS else edges[:-1]
        counts = np.diff([*starts, n]).astype(np.float64)
        f, mean = (np.add.reduceat(values, starts) / counts for values in (frequencies, density))
        return cls(f, mean, counts, step, len(positions))

    def __getitem__(self, part: slice | NDArray[np.bool_]) -> Periodogram:
        return dataclasses.replace(
            self,
            frequencies=self.frequencies[part],
            density=self.density[part],
            counts=self.counts[part],
        )

    def expected(self, bead: TrappedBead) -> Array:
        """Expected density for a record of that bead, (blocks,) m^2/Hz."""
        return bead.sampled_spectrum(self.frequencies, self.step, self.samples)

    def log_likelihood(self, bead: TrappedBead) -> float:
        """Log-likelihood of exponential ordinates (P. Whittle, Ark. Mat. 2, 423 (1953))."""
        expected = self.expected(bead)
        if not (expected > 0).all():  # rounding, far from any real bead
            return -math.inf
        return -float(self.counts @ (np.log(expected) + self.density / expected))

    def slopes(self, bead: TrappedBead, free: int) -> Array:
        """(free, blocks): d ln S / d ln k, and d ln S / d ln beta if both are free."""

        def logarithm(k: float, drag: float) -> Array:
            changed = dataclasses.replace(
                bead, stiffness=bead.stiffness * math.exp(k), drag=bead.drag * math.exp(drag)
            )
            return np.log(self.expected(changed))

        h = 1e-4
        ways = ((h, 0.0), (0.0, h))[:free]
        return np.stack([(logarithm(*d) - logarithm(-d[0], -d[1])) / (2 * h) for d in ways])


@dataclass(frozen=True)
class WhittleFit:
    """The bead whose spectrum fits a periodogram best."""

    bead: TrappedBead
    periodogram: Periodogram
    """the fitted periodogram"""
    free: int
    """number of fitted parameters: 2 for stiffness and drag, 1 for stiffness alone"""

    @cached_property
    def log_likelihood(self) -> float:
        """Log-likelihood, to compare with other fits of the same ordinates."""
        return self.periodogram.log_likelihood(self.bead)

    @cached_property
    def slopes(self) -> Array:
        """(free, blocks): d ln S / d ln of each parameter."""
        return self.periodogram.slopes(self.bead, self.free)

    @cached_property
    def covariance(self) -> Array:
        """Covariance of the logarithms, (free, free), by Fisher's information."""
        return inverse((self.slopes * self.periodogram.counts) @ self.slopes.T)

    def uncertainty(self, *of: float) -> float:
        """Standard uncertainty of of[0] ln k + of[1] ln beta."""
        of_free = np.array(of[: self.free])
        return math.sqrt(of_free @ self.covariance @ of_free)


def inverse(information: Array) -> Array:
    """Covariance of parameters; one without any information has an uncertainty of 10^6."""
    values, vectors = eigh(information)
    return np.asarray((vectors / np.maximum(values, 1e-12)) @ vectors.T)


def fitted(
    periodogram: Periodogram, start: TrappedBead, free: int, tolerance: float = 1e-4
) -> WhittleFit:
    """The fit of stiffness and drag (free = 2), or of the stiffness alone, starting at `start`.

    tolerance: of the logarithms; a tenth of it for the log-likelihood.
    """

    def bead(logarithms: Array) -> TrappedBead:
        k, drag = [*np.exp(logarithms), start.drag][:2]
        return dataclasses.replace(start, stiffness=float(k), drag=float(drag))

    first = np.log([start.stiffness, start.drag])[:free]
    found = minimize(
        lambda logarithms: -periodogram.log_likelihood(bead(logarithms)),
        first,
        method="Nelder-Mead",
        options={
            "xatol": tolerance, "fatol": tolerance / 10,
            "initial_simplex": first + _FIRST_STEP * np.eye(free + 1, free, -1),
        },
    ).x  # fmt: skip
    return WhittleFit(bead(found), periodogram, free)


def usable(periodogram: Periodogram, start: TrappedBead) -> Periodogram:
    """The frequencies to fit: where the bead still moves, and leakage, which correlates the
    ordinates, stays below the noise of their sum.
    """
    sampled = start.sampled_spectrum(periodogram.frequencies, periodogram.step)
    leakage = periodogram.expected(start) / sampled - 1
    before = np.cumsum(periodogram.counts) - 1
    leaking = np.flatnonzero(before * leakage**2 > _LEAKAGE)
    within = int((periodogram.frequencies <= _RANGE * start.roll_off).sum())
    least = int(np.searchsorted(before, _LEAST_ORDINATES - 1)) + 1
    return periodogram[: max(min(within, *leaking[:1], before.size), least)]


def best_start(periodogram: Periodogram, positions: Array, given: TrappedBead) -> TrappedBead:
    """The most probable of some beads, as the start of a fit: overdamped, and with a mass
    underdamped.

    given: the temperature, mass and exposure, and the drag or NaN.
    """
    kT = Boltzmann * given.temperature
    k = kT / np.var(positions)
    # squares decay twice as fast; for an underdamped bead in m/beta
    memory = periodogram.step * statistical_inefficiency((positions - positions.mean()) ** 2)
    starts = [dataclasses.replace(given, stiffness=k, drag=k * memory)]
    if given.mass is not None:
        peak = periodogram.frequencies[periodogram.density.argmax()]
        ringing = given.mass * (2 * math.pi * peak) ** 2
        starts.append(dataclasses.replace(given, stiffness=ringing, drag=given.mass / memory))
    if not math.isnan(given.drag):
        starts += [dataclasses.replace(start, drag=given.drag) for start in starts]
    return max(starts, key=periodogram.log_likelihood)
