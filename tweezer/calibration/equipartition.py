"""Stiffness by the variance of positions, corrected for what a record shows of it."""

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

#: Distances from a stiffness, in its logarithm, at which another is looked for.
_REACHES = (0.1, 0.5, 2.0, 8.0, 16.0)


def equipartition(positions: Array, fits: Fits) -> tuple[float, float]:
    """Stiffness by the variance of positions, whose relative variance is that of the spectrum."""
    k = float(Boltzmann * fits.fit.bead.temperature / np.var(positions))
    relative = math.sqrt(relative_variance_of_variance(fits.fit.bead, fits.whole))
    return corrected(k, k * relative, fits)


def corrected(k: float, uncertainty: float, fits: Fits) -> tuple[float, float]:
    """k from k_B T over the variance of the record, corrected for what differs from the motion's.

    Missing are the variance of the mean, what was left out of the record and what the detector does
    not show; its noise is too much.
    Both depend on what was fitted, whose uncertainty adds to that of k.
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
        """The stiffness that such a bead seems to have."""
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

    # the fit tells what part of the motion is shown
    def hidden(other: TrappedBead) -> Array:
        return np.array(math.log(other.stiffness * other.variance))

    found = k * bead.stiffness / shown(bead.stiffness)
    used = np.isin(whole.frequencies, fit.periodogram.frequencies)
    power = whole.counts * whole.expected(bead)
    follows = fit.periodogram.differences(hidden, bead, fit.free)
    both = follows @ fit.covariance @ (fit.slopes @ power[used]) / power.sum()
    relative_square += float(follows @ fit.covariance @ follows - 2 * both)
    return found, found * math.sqrt(max(relative_square, 0.0))
