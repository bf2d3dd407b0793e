"""Stiffness from the variance of positions, corrected for motion that the record lacks."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
from scipy.optimize import brentq

from tweezer.calibration.findings import Fits, relative_variance_of_variance
from tweezer.calibration.spectra import TrappedBead
from tweezer.calibration.whittle import STIFFNESS
from tweezer.values.arrays import Array
from tweezer.values.constants import Boltzmann

#: Distances from a stiffness, in its logarithm, to which the search is extended in turn.
_REACHES = (0.1, 0.5, 2.0, 8.0, 16.0)


def equipartition(positions: Array, fits: Fits) -> tuple[float, float]:
    """Return the stiffness from the variance of `positions` (n,), m, and its uncertainty, N/m.

    The uncertainty of the variance follows from the fitted spectrum.
    """
    k = float(Boltzmann * fits.fit.bead.temperature / np.var(positions))
    relative = math.sqrt(relative_variance_of_variance(fits.fit.bead, fits.whole))
    return corrected(k, k * relative, fits)


def corrected(k: float, uncertainty: float, fits: Fits) -> tuple[float, float]:
    """Correct a stiffness k = k_B T/(variance of the record), N/m, and its uncertainty, N/m.

    The variance of a record lacks the variance of its mean, the excluded frequencies and the motion
    that the detector averages out, and it contains the detector noise. These corrections follow
    from the `fits`, whose uncertainties add to the uncertainty of k.
    """
    whole, fit, bead = fits.whole, fits.fit, fits.fit.bead
    relative_square = (uncertainty / k) ** 2
    missing = bead.variance_of_mean(whole.step, whole.samples)
    missing += fits.left_out.missing(bead, int(whole.samples), whole.step).variances.sum()
    missing /= bead.variance
    # if the record does not resolve the relaxation, only rounding is left
    k *= max(1 - missing, 1 / whole.samples)
    if bead.seen_as_it_is and "response" not in fit.free:
        return k, k * math.sqrt(relative_square)

    def shown(stiffness: float) -> float:
        """Return k_B T/(recorded variance), N/m, for a bead of the given true stiffness, N/m."""
        other = dataclasses.replace(bead, stiffness=stiffness)
        return Boltzmann * bead.temperature / other.variance

    if fit.free == STIFFNESS:

        def excess(logarithm: float) -> float:
            return math.log(shown(math.exp(logarithm)) / k)

        here = math.log(bead.stiffness)
        reach = next((r for r in _REACHES if excess(here - r) < 0 < excess(here + r)), None)
        if reach is None:
            raise ArithmeticError("no stiffness has that variance")
        found = math.exp(brentq(excess, here - reach, here + reach))
        slope = math.log(shown(found * 1.001) / shown(found / 1.001)) / math.log(1.001**2)
        return found, found * math.sqrt(relative_square) / slope

    def hidden(other: TrappedBead) -> Array:
        """Return ln(stiffness times recorded variance), which depends only on the detector."""
        return np.array(math.log(other.stiffness * other.variance))

    found = k * bead.stiffness / shown(bead.stiffness)
    used = np.isin(whole.frequencies, fit.periodogram.frequencies)
    power = whole.counts * whole.expected(bead)
    follows = fit.periodogram.differences(hidden, bead, fit.free)
    both = follows @ fit.covariance @ (fit.slopes @ power[used]) / power.sum()
    relative_square += float(follows @ fit.covariance @ follows - 2 * both)
    return found, found * math.sqrt(max(relative_square, 0.0))
