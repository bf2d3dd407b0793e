"""Autocovariance, mean squared displacement and power spectrum, of a record and of a model."""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.constants import Boltzmann

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

#: Length of Sokal's window, in statistical inefficiencies
_WINDOW = 3.0
#: Distance from critical damping below which the two rates count as equal
_CRITICAL = 1e-5
#: Exposure, in decay times, below which h(v) of `_overlap` is a series, to avoid cancellation.
_SHORT = 1e-2


def power_spectrum(positions: Array, step: float, segments: int = 1) -> tuple[Array, Array]:
    """One-sided power spectral density by Bartlett's method.

    positions: (n,) m, one every `step` (s). Returns frequencies (Hz) and densities (m^2/Hz), for
    the Fourier frequencies between 0 and Nyquist's, both excluded: the periodogram averaged over
    `segments` equal parts without overlap, each minus its mean. For a series much longer than its
    correlation time, the ratio of each value to its expectation is an independent
    Gamma(segments)/segments.
    """
    from scipy.signal import welch

    length = len(positions) // segments
    frequencies, density = welch(
        positions, 1 / step, window="boxcar", nperseg=length, noverlap=0, detrend="constant"
    )
    inside = slice(1, (length + 1) // 2)
    return frequencies[inside], density[inside]


def autocovariance(positions: Array) -> Array:
    """Autocovariance (n,) at lags 0 to n-1 of `positions` (n,) about their mean, by FFT.

    Each lag is an average over all its pairs. The mean is that of the record, which lowers every
    value by the variance of the mean (`TrappedBead.variance_of_mean`).
    """
    return _products(positions) / np.arange(len(positions), 0, -1)


def mean_squared_displacement(positions: Array) -> Array:
    """Mean squared displacement (n,) at lags 0 to n-1 of `positions` (n,), by FFT.

    Averaged over all n - lag pairs, which overlap; unbiased.
    """
    n = len(positions)
    deviations = positions - np.mean(positions)
    squares = np.concatenate([[0.0], np.cumsum(deviations**2)])
    lags = np.arange(n)
    both_ends = squares[n - lags] + squares[n] - squares[lags]
    return np.maximum(both_ends - 2 * _products(positions), 0.0) / (n - lags)


def _products(positions: Array) -> Array:
    """Sum at lags 0 to n-1 of the products of two deviations from the mean."""
    from scipy.fft import irfft, next_fast_len, rfft

    deviations = positions - np.mean(positions)
    length = next_fast_len(2 * len(positions), real=True)
    return irfft(np.abs(rfft(deviations, length)) ** 2, length)[: len(positions)]


def statistical_inefficiency(series: Array) -> float:
    """Number of samples of `series` (n,) per independent sample: 1 + 2 sum rho_j, at least 1.

    The sum ends at a lag of three times its value (A. Sokal's window), and is corrected for the
    mean of the record (U. Wolff, Comput. Phys. Commun. 156, 143 (2004)). A series that stays
    correlated to its end has n.
    """
    covariance = autocovariance(series)
    if covariance[0] <= 0:
        return 1.0
    sums = 2 * np.cumsum(covariance / covariance[0]) - 1
    ends = np.flatnonzero(np.arange(len(sums)) >= _WINDOW * sums)
    if not ends.size:
        return float(len(series))
    window = int(ends[0])
    return max(float(sums[window]) * (1 + (2 * window + 1) / len(series)), 1.0)


def standard_error(series: Array) -> float:
    """Standard error of the mean of a correlated `series` (n,), by its statistical inefficiency."""
    return math.sqrt(np.var(series) * statistical_inefficiency(series) / len(series))


def _overlap(v: NDArray[Any]) -> NDArray[Any]:
    """h(v) = e^-v - 1 + v: twice the integral of e^-r|s-t| over 0 < s, t < v/r is 2 h(v)/r^2."""
    series = v**2 / 2 * (1 - v / 3 * (1 - v / 4 * (1 - v / 5 * (1 - v / 6))))
    return np.where(np.abs(v) < _SHORT, series, np.expm1(-v) + v)


@dataclass(frozen=True)
class TrappedBead:
    """A bead in a harmonic trap, m x'' + beta x' + k x = thermal noise, and its recording.

    Without a mass it is overdamped: the Ornstein-Uhlenbeck process. The noise is white: the effect
    of the medium's inertia on the drag (Basset) is left out. A recorded position is the mean over
    the exposure (motion blur: W. P. Wong and K. Halvorsen, Opt. Express 14, 12517 (2006)). By the
    exposure a decay e^-rt becomes (sinh(rW/2)/(rW/2))^2 e^-rt from t = W on, and
    2 (rW - 1 + e^-rW)/(rW)^2 at t = 0.
    """

    stiffness: float
    """k, N/m"""
    drag: float
    """beta, kg/s"""
    temperature: float
    """T, K"""
    mass: float | None = None
    """m, kg"""
    exposure: float = 0.0
    """W, s: the time over which each recorded position is averaged"""

    @property
    def variance(self) -> float:
        """Variance of recorded positions, m^2: k_B T/k (equipartition), reduced by the exposure."""
        return float(self.autocovariance(0.0))

    @property
    def corner_frequency(self) -> float:
        """k/(2 pi beta), Hz."""
        return self.stiffness / (2 * math.pi * self.drag)

    @property
    def diffusion(self) -> float:
        """k_B T/beta, m^2/s: Einstein."""
        return Boltzmann * self.temperature / self.drag

    @property
    def relaxation_time(self) -> float:
        """Time of the slowest decay, s: beta/k, or 2m/beta if the bead is underdamped."""
        return 1 / min(rate.real for _, rate in self._decays())

    @property
    def roll_off(self) -> float:
        """Frequency above which the spectrum falls, Hz: the corner, or the resonance."""
        if self.mass is None:
            return self.corner_frequency
        return min(self.corner_frequency, math.sqrt(self.stiffness / self.mass) / (2 * math.pi))

    def _decays(self) -> list[tuple[complex, complex]]:
        """Amplitudes (m^2) and rates (1/s) of the exponentials in the autocovariance."""
        equipartition = Boltzmann * self.temperature / self.stiffness
        if self.mass is None:
            return [(equipartition, self.stiffness / self.drag)]
        split = cmath.sqrt(1 - 4 * self.mass * self.stiffness / self.drag**2)
        if abs(split) < _CRITICAL:
            split = complex(_CRITICAL)  # the error is of second order
        fast = self.drag / (2 * self.mass) * (1 + split)
        slow = self.stiffness / self.mass / fast
        return [
            (equipartition * fast / (fast - slow), slow),
            (-equipartition * slow / (fast - slow), fast),
        ]

    def autocovariance(self, times: ArrayLike) -> Array:
        """<x(0) x(t)>, m^2, of recorded positions, at `times` (s)."""
        past = np.abs(np.asarray(times, np.float64))
        covariance = np.zeros(past.shape)
        for amplitude, rate in self._decays():
            decay = np.exp(-rate * past)
            if self.exposure:
                u, v = rate * self.exposure, rate * np.minimum(past, self.exposure)
                apart = _overlap(v + u) - 2 * _overlap(v) + _overlap(u - v)
                late = np.exp(-rate * np.maximum(past - self.exposure, 0)) * np.expm1(-u) ** 2
                decay = np.where(past < self.exposure, apart, late) / u**2
            covariance += np.real(amplitude * decay)
        return covariance

    def mean_squared_displacement(self, times: ArrayLike) -> Array:
        """<(x(t) - x(0))^2>, m^2, of recorded positions, at `times` (s)."""
        return 2 * (self.variance - self.autocovariance(times))

    def spectrum(self, frequencies: ArrayLike) -> Array:
        """One-sided power spectral density, m^2/Hz, of the motion itself at `frequencies` (Hz).

        The Lorentzian, or with a mass its inertial form (K. Berg-Sorensen and H. Flyvbjerg,
        Rev. Sci. Instrum. 75, 594 (2004)); times sinc^2(f W) for the exposure.
        """
        f = np.asarray(frequencies, np.float64)
        omega = 2 * np.pi * f
        restoring = self.stiffness - (self.mass or 0.0) * omega**2
        force = 4 * Boltzmann * self.temperature * self.drag
        density = force / (restoring**2 + (self.drag * omega) ** 2)
        return density * np.sinc(f * self.exposure) ** 2

    def sampled_spectrum(
        self, frequencies: ArrayLike, step: float, samples: float = math.inf
    ) -> Array:
        """One-sided power spectral density, m^2/Hz, of positions taken every `step` (s).

        It includes all aliases: it is the Fourier sum over the autocovariance of the samples, which
        from lag 1 on is one or two geometric series (S. F. Norrelykke and H. Flyvbjerg, Phys. Rev.
        E 83, 041103 (2011)). With `samples`, the expected periodogram at the Fourier frequencies of
        a record of that length, which also includes leakage (A. M. Sykulski et al., Biometrika 106,
        251 (2019)). The exposure must not exceed the step.
        """
        turn = 2j * np.pi * np.asarray(frequencies, np.float64) * step
        density = np.full(turn.shape, self.variance)
        for amplitude, rate in self._decays():
            ends = -np.expm1(-rate * step * samples) / samples if math.isfinite(samples) else 0.0
            rest = -np.expm1(turn - rate * step)
            if self.exposure:
                u = rate * self.exposure
                amplitude *= (np.expm1(-u) / u) ** 2  # noqa: PLW2901
                first = np.exp(turn - rate * (step - self.exposure))
            else:
                first = 1 - rest
            density += 2 * np.real(amplitude * first * (1 / rest - ends / rest**2))
        return 2 * step * density

    def variance_of_mean(self, step: float, samples: float) -> float:
        """Variance of the mean of `samples` positions taken every `step` (s), m^2."""
        lags = np.arange(1, samples)
        covariance = self.autocovariance(lags * step)
        return (self.variance + 2 * float((1 - lags / samples) @ covariance)) / samples
