"""Potential energy along a line, from a histogram of positions by Boltzmann's law."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from tweezer.calibration.quantities import BOTTOM, MINIMUM
from tweezer.calibration.spectra import statistical_inefficiency, variance_of_means
from tweezer.scene.arguments import in_si, numbers_in_si
from tweezer.values.arrays import Array
from tweezer.values.constants import Boltzmann
from tweezer.values.errors import ResultError
from tweezer.values.measured import Measured, Result
from tweezer.values.printed import in_unit, printed
from tweezer.values.shown import Card, Row
from tweezer.values.units import TEMPERATURE, QuantitiesLike, QuantityLike

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
#: Energy above the bottom up to which a parabola is fitted, k_B T.
_PARABOLA = 2.0
#: Smallest number of bins for a parabola.
_LEAST_BINS = 5
#: Largest number of counts (bins times blocks of the record) for estimating errors.
_CELLS = 2**18
#: Number of samples in which the step of a digitised record is sought.
_LOOKED_AT = 10_000
#: Finest step that is detected, and rounding of positions, in standard deviations.
_FINEST, _ROUNDED = 2e-3, 1e-6
#: Largest distance from a multiple of the step, and the fraction of samples that must be within it.
_ON_STEP, _STEPPED = 0.05, 0.99


@dataclass(frozen=True, repr=False)
class Potential(Result):
    """Potential energy along a line from the histogram of positions."""

    QUANTITIES: ClassVar = (BOTTOM, MINIMUM)

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
    """standard uncertainty of `stiffness`, N/m"""
    minimum: float | None
    """bottom of the parabola, m"""

    def quantities(self) -> Iterator[Measured]:
        """Yield stiffness and position of the bottom, if there is a parabola."""
        if self.stiffness is not None:
            yield BOTTOM(self.stiffness, self.uncertainty)
            yield MINIMUM(self.minimum)

    def card(self) -> Card:
        """Return the card with the number and range of the bins, the highest energy and the trap
        stiffness.
        """
        low, high = self.coordinates[[0, -1]]
        bottom = self.numbers.get(BOTTOM.name)
        rows = (
            Row("bins", f"{len(self.coordinates)}, {in_unit(low, 'nm')} to {printed(high, 'nm')}"),
            Row("highest", printed(self.energy.max(), "zJ", 3)),
            bottom.row() if bottom else Row(BOTTOM.about, "not determined"),
        )
        return Card("Potential", "", rows)


def potential(
    positions: QuantitiesLike, temperature: QuantityLike, resolution: QuantityLike | None = None
) -> Potential:
    """Return U = -k_B T ln p (Boltzmann) from the histogram of positions in equilibrium.

    Bins reach 4 standard deviations to both sides of the mean. Their width is a fifth of a standard
    deviation, or larger, up to a half, if a Gaussian would leave less than 20 independent samples
    in a bin at two standard deviations. In a digitised recording the width is a whole multiple of
    its resolution, so that every bin contains the same number of recorded values. Bins with less
    than 10 independent samples are omitted. The number of independent samples in a bin follows from
    the variance of its counts in successive blocks. The curvature is corrected for the width of the
    bins (Sheppard). Its error is the error of the mean influence function over the recording, which
    includes the correlation between bins.

    Parameters
    ----------
    positions : array_like, shape (n,)
        Positions, m. Quantities with units are accepted.
    temperature : float or str
        Temperature of the medium, K.
    resolution : float or str, optional
        Step of a digitised recording, m; 0 for a recording that is not digitised. Default:
        determined from the positions. Give it if drift was removed after the positions were
        digitised.

    Returns
    -------
    Potential
        Energy of each bin, and the parabola at the bottom.

    Raises
    ------
    ResultError
        For positions of another shape, or positions that do not change.

    Examples
    --------
    >>> positions = 1e-8 * np.random.default_rng(1).normal(size=10_000)
    >>> found = tweezer.potential(positions, "20 degC")
    >>> round(1e6 * found.stiffness)  # pN/um, near k_B T over the variance
    41
    """
    x = numbers_in_si("positions", positions, "m")
    temperature = in_si("temperature", temperature, "K", *TEMPERATURE, error=ResultError)
    if x.ndim != 1 or not x.size or not np.isfinite(x).all() or np.ptp(x) == 0:
        raise ResultError(
            "positions: must be a one-dimensional array of finite numbers, not all equal"
        )
    kT, centre, deviation = Boltzmann * temperature, x.mean(), x.std()
    step = resolution_of(x) if resolution is None else in_si("resolution", resolution, "m")
    independent = x.size / statistical_inefficiency((x - centre) ** 2)
    width = min(max(_COUNTS_AT_TWO / (_DENSITY_AT_TWO * independent), _NARROWEST), _WIDEST)
    if step:
        width = max(round(width * deviation / step), 1) * step / deviation
    count = math.ceil(2 * _REACH / width)
    low = centre - deviation * width * count / 2
    if step:  # edges halfway between the recorded values
        edge = _recorded_value(x, step) + step / 2
        low = edge + step * round((low - edge) / step)
    at = (low - centre) / deviation + width * (np.arange(count) + 0.5)
    # number 0 is left of the first bin, and the last number is right of the last bin
    bins = np.clip((x - low) * (1 / (width * deviation)) + 1, 0, count + 1).astype(np.int64)
    blocks = _counts_of_blocks(bins, count + 2)
    visited = np.bincount(bins, minlength=count + 2)[1:-1] / x.size
    of_mean = np.array([variance_of_means(each) for each in blocks[1:-1]])
    of_mean = np.maximum(of_mean, visited * (1 - visited) / x.size)
    relative = np.full(count, np.inf)
    np.divide(np.sqrt(of_mean), visited, out=relative, where=visited > 0)
    enough = np.flatnonzero(relative**2 <= 1 / _COUNTS)
    at, visited, relative = at[enough], visited[enough], relative[enough]
    U = -np.log(visited) - relative**2 / 2  # in k_B T; the logarithm is concave
    height = U - U.min(initial=np.inf)
    stiffness = uncertainty = minimum = None
    parabola = _parabola(at, height)
    if parabola is not None:
        (a, b, c), lowest, influence = parabola  # coefficients, fitted bins, d(curvature)/d(height)
        height = height - (c - b**2 / (4 * a))
        stiffness = float(2 * a * (1 + 2 * a * width**2 / 12) * kT / deviation**2)
        minimum = float(centre - deviation * b / (2 * a))
        error = variance_of_means((influence / visited[lowest]) @ blocks[1 + enough[lowest]])
        uncertainty = math.sqrt(error) * kT / deviation**2
    return Potential(
        centre + deviation * at, kT * height, kT * relative, stiffness, uncertainty, minimum
    )


def _counts_of_blocks(bins: NDArray[np.int64], count: int) -> Array:
    """Return the fraction of each block's samples that falls in each bin, (count, blocks).

    `bins` (n,) contains the bin number of each sample, from 0 to `count` - 1. Blocks are successive
    parts of the recording with equal lengths. Samples at the end may be omitted.
    """
    length = math.ceil(bins.size * count / _CELLS)
    blocks = bins.size // length
    cells = bins[: blocks * length].reshape(blocks, length) + count * np.arange(blocks)[:, None]
    found = np.bincount(cells.ravel(), minlength=blocks * count).reshape(blocks, count)
    return np.true_divide(found.T, length, order="C")


def resolution_of(positions: Array) -> float:
    """Return the step of a digitised record, m.

    Parameters
    ----------
    positions : ndarray, shape (n,)
        Recorded positions, m. One in a hundred may lie between the recorded values, as samples that
        were filled in.

    Returns
    -------
    float
        Distance of neighbouring values, m; 0 if they have no common step of a five-hundredth of a
        standard deviation or more.
    """
    deviation = float(positions.std())
    if deviation == 0:
        return 0.0
    some = (positions[:: -(-len(positions) // _LOOKED_AT)] - positions[0]) / deviation
    values, counts = np.unique(np.rint(some / _ROUNDED), return_counts=True)
    values = _ROUNDED * values[counts > 1]
    if values.size < 2 or (step := float(np.diff(values).min())) < _FINEST:
        return 0.0
    step = (values[-1] - values[0]) / round((values[-1] - values[0]) / step)
    off = some / step - _recorded_value(some, step) / step
    if np.mean(np.abs(off - np.rint(off)) < _ON_STEP) < _STEPPED:
        return 0.0
    return float(step * deviation)


def _recorded_value(positions: Array, step: float) -> float:
    """Return one of the values that a digitised recording can have.

    `positions` (n,) and the distance `step` between values have the same unit. The value follows
    from the mean phase of the positions within a step, which averages rounding errors.
    """
    some = positions[:: -(-len(positions) // _LOOKED_AT)] - positions[0]
    phase = np.angle(np.exp(2j * np.pi * some / step).mean())
    return float(positions[0] + step * phase / (2 * np.pi))


def _parabola(at: Array, height: Array) -> tuple[Array, NDArray[np.int64], Array] | None:
    """Fit a x^2 + b x + c to the bottom of a potential, up to 2 k_B T above it.

    `at` (bins,) are the centres x of the bins, in standard deviations of the position, and `height`
    (bins,) are the energies, in k_B T. Returns a, b and c (3,), the indices of the fitted bins, and
    the derivatives of the curvature 2 a with respect to their energies. Returns None without a
    minimum or with too few bins. Weights and bins follow from a preliminary parabola, so they
    depend little on noise.
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
        # square root of the weights, which are the expected counts exp(-height)
        root = np.exp(-np.clip(fitted[low], 0, None) / 2)
        solution = np.linalg.pinv(np.vander(at[low], 3) * root[:, None]) * root
        coefficients = solution @ height[low]
        a, b, _ = coefficients
        if a <= 0:
            return None
        fitted = a * (at + b / (2 * a)) ** 2
        lowest = int(fitted.argmin())
    return coefficients, low, 2 * solution[0]
