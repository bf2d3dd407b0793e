"""Likelihood of a recorded coordinate from its whitened power spectral density."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import chdtrc, kolmogorov

from tweezer.calibration.spectra import TrappedBead
from tweezer.calibration.whittle import Periodogram
from tweezer.values.arrays import Array


@dataclass(frozen=True)
class Whitened:
    """Periodogram of y_t = x_t - phi x_(t-1), where x is a recorded coordinate.

    Here phi is the correlation of successive samples of x. Therefore y is white for an overdamped
    bead, and nearly white for a bead with inertia. The ordinates of a white series are independent
    and have no leakage, unlike the ordinates of x in a short recording (D. B. Percival and A. T.
    Walden, Spectral Analysis for Physical Applications, 1993, section 6.5). Their Whittle
    likelihood equals the likelihood of x without its first sample (P. Whittle, Ark. Mat. 2, 423
    (1953)).
    """

    axis: str
    """"x", "y" or "z\""""
    periodogram: Periodogram
    """periodogram of y, averaged over blocks of frequencies"""
    phi: float
    """correlation of successive samples of x, below 1"""

    @classmethod
    def of(cls, axis: str, positions: Array, step: float) -> Whitened:
        """Return the periodogram of `positions` (n,), m, with the sampling interval `step` (s)."""
        x = positions - positions.mean()
        phi = float(x[1:] @ x[:-1] / (x[:-1] @ x[:-1]))
        return cls(axis, Periodogram.of(x[1:] - phi * x[:-1], step), phi)

    @property
    def _gain(self) -> Array:
        """(blocks,) ratio of the power of y to that of x, at the frequencies of the blocks."""
        turn = np.pi * self.periodogram.step * self.periodogram.frequencies
        return (1 - self.phi) ** 2 + 4 * self.phi * np.sin(turn) ** 2

    def expected(self, bead: TrappedBead) -> Array:
        """Return the expected density of y for a bead, (blocks,), m^2/Hz."""
        part = self.periodogram
        return self._gain * bead.sampled_spectrum(part.frequencies, part.step)

    def deviances(self, bead: TrappedBead) -> Array:
        """Return the signed deviances of the blocks, (blocks,).

        The square of a deviance is twice the log-likelihood ratio to the best density of its block.
        The squares add up to -2 log(likelihood), relative to a fit of each block by itself.
        """
        ratio = self.periodogram.density / self.expected(bead)
        above = np.maximum(ratio - 1 - np.log(ratio), 0.0)
        return np.asarray(np.sign(ratio - 1) * np.sqrt(2 * self.periodogram.counts * above))

    def p_value(self, bead: TrappedBead) -> float:
        """Return the p-value of the ordinates, for this bead.

        It is twice the smaller p-value of two tests. The first is Bartlett's test (Kolmogorov and
        Smirnov) of the cumulative periodogram. The second uses the sum of the ratios of ordinates
        to expected ordinates, which is distributed as half a chi-square.
        """
        counts = self.periodogram.counts
        passed = np.cumsum(counts * self.periodogram.density / self.expected(bead))
        uniform = np.cumsum(counts) / counts.sum()
        distance = float(np.abs(passed / passed[-1] - uniform).max())
        above = float(chdtrc(2 * counts.sum(), 2 * passed[-1]))
        white = float(kolmogorov(np.sqrt(counts.sum()) * distance))
        return min(2 * min(white, 2 * min(above, 1 - above)), 1.0)
