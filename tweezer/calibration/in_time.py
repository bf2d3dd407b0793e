"""Stiffness from averages of a record at several lags: squared displacements, autocorrelation."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cholesky, solve_triangular
from scipy.optimize import least_squares

from tweezer.calibration.left_out import Missing
from tweezer.calibration.spectra import TrappedBead, autocovariance, mean_squared_displacement
from tweezer.calibration.whittle import inverse
from tweezer.values.arrays import Array

#: Smallest and largest lag of the fits in time, in relaxation times.
_LAGS = (0.1, 2.0)
#: Number of lags in a fit.
_LAG_COUNT = 10
#: Number of relaxation times after which correlations are negligible.
_FORGOTTEN = 20.0


def lags_of(samples: int, step: float, bead: TrappedBead) -> NDArray[np.int64]:
    """Return the lags of a fit, in samples, approximately evenly spaced in the logarithm.

    They range from 0.1 to 2 relaxation times of `bead`, and up to a quarter of the `samples`, which
    are `step`, s, apart.
    """
    shortest, longest = (lags * bead.relaxation_time / step for lags in _LAGS)
    most = samples // 4
    ends = min(max(shortest, 1), most - 3), min(max(longest, 3), most)
    return np.unique(np.rint(np.geomspace(*ends, _LAG_COUNT)).astype(np.int64))


def displacement(
    positions: Array,
    step: float,
    bead: TrappedBead,
    lags: NDArray[np.int64],
    missing: Missing,
    drag_known: bool,
) -> tuple[float, float]:
    """Return the stiffness from mean squared displacements, and its standard uncertainty, N/m.

    Parameters
    ----------
    positions : ndarray, shape (n,)
        Positions, m.
    step : float
        Sampling interval, s.
    bead : TrappedBead
        Start of the fit.
    lags : ndarray of int
        Lags of the fit, in samples.
    missing : Missing
        Part of the bead's motion that was removed from the positions.
    drag_known : bool
        Whether the drag is known. Otherwise it is fitted too.
    """
    lost = 2 * (missing.variances.sum() - missing.autocovariance(lags * step)) / bead.variance

    def predicted(logarithms: Array) -> Array:
        values = [*np.exp(logarithms), bead.drag]
        other = dataclasses.replace(bead, stiffness=values[0], drag=values[1])
        return other.mean_squared_displacement(lags * step) - lost * other.variance

    covariance = covariance_of_averages(
        bead, step, len(positions), lags, of_squared_displacements, missing
    )
    values = mean_squared_displacement(positions, lags)
    start = np.log([bead.stiffness] if drag_known else [bead.stiffness, bead.drag])
    return _least_squares(values, covariance, predicted, start)


def autocorrelation(
    positions: Array, step: float, bead: TrappedBead, lags: NDArray[np.int64], missing: Missing
) -> tuple[float, float]:
    """Return the stiffness from the decay of the autocorrelation, and its uncertainty, N/m.

    The variance is fitted too.

    Parameters
    ----------
    positions : ndarray, shape (n,)
        Positions, m.
    step : float
        Sampling interval, s.
    bead : TrappedBead
        Start of the fit.
    lags : ndarray of int
        Lags of the fit, in samples, without 0, which is the only lag affected by white noise.
    missing : Missing
        Part of the bead's motion that was removed from the positions.
    """
    lost = bead.variance_of_mean(step, len(positions)) + missing.autocovariance(lags * step)
    lost = lost / bead.variance

    def predicted(logarithms: Array) -> Array:
        k, variance = np.exp(logarithms)
        other = dataclasses.replace(bead, stiffness=k)
        return variance * (other.autocovariance(lags * step) / other.variance - lost)

    covariance = covariance_of_averages(bead, step, len(positions), lags, of_products, missing)
    values = autocovariance(positions, lags)
    start = np.log([bead.stiffness, bead.variance])
    return _least_squares(values, covariance, predicted, start)


Covariance = Callable[[NDArray[np.int64]], Array]
"""Function that returns the covariance, m^2, of two positions for lags in samples of any sign."""


def of_squared_displacements(C: Covariance, s: NDArray[np.int64], i: int, j: int) -> Array:
    """Return the covariance, m^4, of two squared displacements, over i and over j samples.

    Parameters
    ----------
    C : callable
        Function that returns the covariance of two positions for a lag.
    s : ndarray of int
        Distances between the starts of the two displacements, in samples.
    i, j : int
        Lengths of the two displacements, in samples.
    """
    return 2 * (C(s + j - i) - C(s - i) - C(s + j) + C(s)) ** 2


def of_products(C: Covariance, s: NDArray[np.int64], i: int, j: int) -> Array:
    """Return the covariance, m^4, of products of positions that are i and j samples apart.

    Parameters
    ----------
    C : callable
        Function that returns the covariance of two positions for a lag.
    s : ndarray of int
        Distances between the starts of the two products, in samples.
    i, j : int
        Distances between the positions in each product, in samples.
    """
    return C(s) * C(s + j - i) + C(s + j) * C(s - i)


def covariance_of_averages(
    bead: TrappedBead,
    step: float,
    samples: int,
    lags: NDArray[np.int64],
    of_one: Callable[[Covariance, NDArray[np.int64], int, int], Array],
    missing: Missing,
) -> Array:
    """Return the covariance (lags, lags), m^4, of averages over a recording at several lags.

    Each average is over all pairs of positions at that lag.

    Parameters
    ----------
    bead : TrappedBead
        Bead whose motion is Gaussian.
    step : float
        Sampling interval, s.
    samples : int
        Number of positions.
    lags : ndarray of int
        Lags, in samples.
    of_one : callable
        Function such as `of_products`, which returns the covariance of two averaged terms
        (Isserlis's theorem).
    missing : Missing
        Part of the bead's motion that the recording lacks.
    """
    longest = int(lags[-1])
    reach = min(samples, math.ceil(_FORGOTTEN * bead.relaxation_time / step)) + longest
    times = step * np.arange(reach + 2 * longest + 1, dtype=np.float64)
    table = bead.autocovariance(times) - missing.autocovariance(times)
    apart = np.arange(-reach, reach + 1)
    result = np.empty((lags.size, lags.size))
    for a, i in enumerate(lags):
        for b, j in enumerate(lags[: a + 1]):
            pairs = np.clip(samples - max(i, j) - np.abs(apart), 0, None)
            products = of_one(lambda lag: table[np.abs(lag)], apart, i, j)
            result[a, b] = result[b, a] = pairs @ products / ((samples - i) * (samples - j))
    return result


def _least_squares(
    values: Array, covariance: Array, predicted: Callable[[Array], Array], start: Array
) -> tuple[float, float]:
    """Return the stiffness that fits `values` best, and its standard uncertainty, N/m.

    `values` (n,) have the `covariance` (n, n). `predicted` returns their expectations for the
    logarithms of the parameters, the first of which is the stiffness, N/m. `start` contains the
    initial logarithms. The uncertainty follows from the derivatives there.
    """
    size = np.sqrt(np.diag(covariance))
    correlation = covariance / np.outer(size, size) + 1e-10 * np.eye(size.size)
    root = cholesky(correlation, lower=True)  # dividing residuals by it makes them independent

    def residuals(parameters: Array) -> Array:
        return solve_triangular(root, (values - predicted(parameters)) / size, lower=True)

    found = least_squares(residuals, start, x_scale=0.1).x
    slopes = np.stack(
        [(residuals(start + d) - residuals(start - d)) / 2e-4 for d in 1e-4 * np.eye(start.size)]
    )
    k = math.exp(found[0])
    return k, k * math.sqrt(inverse(slopes @ slopes.T)[0, 0])
