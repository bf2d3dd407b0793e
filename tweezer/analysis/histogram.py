"""The potential along a line, from a histogram of positions (Boltzmann)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.constants import Boltzmann

from tweezer.analysis.spectra import standard_error, statistical_inefficiency
from tweezer.arguments import in_si, numbers_in_si
from tweezer.errors import ResultError
from tweezer.rounding import with_uncertainty
from tweezer.shown import Card, Row, Shown
from tweezer.units import TEMPERATURE, QuantitiesLike, QuantityLike

Array = NDArray[np.float64]

#: Half the width of a histogram, in standard deviations.
_REACH = 4.0
#: Smallest and largest width of its bins, in standard deviations.
_NARROWEST, _WIDEST = 0.2, 0.5
#: Smallest number of independent samples in a bin.
_COUNTS = 10.0
#: Number of independent samples that a bin at two standard deviations should have.
_COUNTS_AT_TWO = 20.0
#: Density of a Gaussian at two standard deviations.
_DENSITY_AT_TWO = math.exp(-2) / math.sqrt(2 * math.pi)
#: Height above the bottom up to which a potential is fitted by a parabola, k_B T.
_PARABOLA = 2.0
#: Smallest number of bins for that fit.
_LEAST_BINS = 5


@dataclass(frozen=True, repr=False)
class Potential(Shown):
    """Potential energy along a line from the histogram of positions."""

    coordinates: Array
    """(bins,) m, centres of the bins with enough samples"""
    energy: Array
    """(bins,) J, above the bottom of the parabola, or above the lowest bin if there is none"""
    errors: Array
    """(bins,) standard errors, J"""
    stiffness: float | None
    """curvature of the parabola fitted within 2 k_B T of the bottom, N/m; None with fewer than 5
    bins there, or a negative curvature"""
    uncertainty: float | None
    """its standard uncertainty, N/m"""
    minimum: float | None
    """bottom of the parabola, m"""

    def card(self) -> Card:
        """Its reach, and the parabola."""
        low, high = 1e9 * self.coordinates[[0, -1]]
        told = "not determined"
        if self.stiffness is not None and self.uncertainty is not None:
            told = f"{with_uncertainty(1e6 * self.stiffness, 1e6 * self.uncertainty)} pN/um"
        rows = (
            Row("bins", f"{len(self.coordinates)}, {low:.4g} to {high:.4g} nm"),
            Row("highest", f"{1e21 * self.energy.max():.3g} zJ"),
            Row("stiffness of its bottom", told),
        )
        return Card("Potential", "", rows)


def potential(positions: QuantitiesLike, temperature: QuantityLike) -> Potential:
    """U = -k_B T ln p (Boltzmann) from the histogram of `positions` (n,), m, in equilibrium.

    Bins reach 4 standard deviations to both sides of the mean. Their width is a fifth of a standard
    deviation, or larger, up to a half, if a Gaussian would leave less than 20 independent samples
    in a bin at two. Bins with less than 10 independent samples are omitted; the number of
    independent samples of a bin follows from the statistical inefficiency of its indicator. The
    curvature is corrected for the width of the bins (Sheppard). Its error is that of the mean over
    the record of its influence function, and so includes the correlation between bins. Raises
    `ResultError` for positions of another shape, or positions that do not change.
    """
    x = numbers_in_si("positions", positions, "m")
    temperature = in_si("temperature", temperature, "K", *TEMPERATURE, error=ResultError)
    if x.ndim != 1 or not x.size or not np.isfinite(x).all() or np.ptp(x) == 0:
        raise ResultError("positions: must be a row of finite numbers, not all the same")
    kT, centre, deviation = Boltzmann * temperature, x.mean(), x.std()
    independent = x.size / statistical_inefficiency((x - centre) ** 2)
    width = min(max(_COUNTS_AT_TWO / (_DENSITY_AT_TWO * independent), _NARROWEST), _WIDEST)
    count = math.ceil(2 * _REACH / width)
    edges = width * (np.arange(count + 1) - count / 2)
    bins = np.searchsorted(edges, (x - centre) / deviation) - 1
    at = (edges[:-1] + edges[1:]) / 2
    visited, relative = np.zeros(count), np.full(count, np.inf)
    for index in np.unique(bins[(bins >= 0) & (bins < count)]):
        inside = (bins == index).astype(np.float64)
        visited[index] = inside.mean()
        relative[index] = standard_error(inside) / visited[index]
    enough = relative**2 <= 1 / _COUNTS
    at, visited, relative = at[enough], visited[enough], relative[enough]
    U = -np.log(visited) - relative**2 / 2  # in k_B T; the logarithm is concave
    height = U - U.min(initial=np.inf)
    stiffness = uncertainty = minimum = None
    parabola = _parabola(at, height)
    if parabola is not None:
        (a, b, c), low, influence = parabola
        height = height - (c - b**2 / (4 * a))
        stiffness = float(2 * a * (1 + 2 * a * width**2 / 12) * kT / deviation**2)
        minimum = float(centre - deviation * b / (2 * a))
        weights = np.zeros(count + 2)  # also left and right of the bins
        weights[1 + np.flatnonzero(enough)[low]] = influence / visited[low]
        error = standard_error(weights[np.clip(bins, -1, count) + 1])
        uncertainty = float(error * kT / deviation**2)
    return Potential(
        centre + deviation * at, kT * height, kT * relative, stiffness, uncertainty, minimum
    )


def _parabola(at: Array, height: Array) -> tuple[Array, NDArray[np.int64], Array] | None:
    """Coefficients of the parabola at the bottom, its bins, and d(curvature)/d(height).

    Weights and bins follow from a first parabola, so that they depend little on the noise.
    """
    if not at.size:
        return None
    lowest, fitted = int(height.argmin()), height
    for _ in range(2):
        high = np.flatnonzero(fitted > _PARABOLA)
        low = np.arange(
            high[high < lowest].max(initial=-1) + 1, high[high > lowest].min(initial=at.size)
        )
        if low.size < _LEAST_BINS:
            return None
        root = np.exp(-np.clip(fitted[low], 0, None) / 2)
        solution = np.linalg.pinv(np.vander(at[low], 3) * root[:, None]) * root
        coefficients = solution @ height[low]
        a, b, _ = coefficients
        if a <= 0:
            return None
        fitted = a * (at + b / (2 * a)) ** 2
        lowest = int(fitted.argmin())
    return coefficients, low, 2 * solution[0]
