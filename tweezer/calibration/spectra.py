"""Autocovariance, mean squared displacement and power spectral density, of records and models."""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tweezer.scene.choices import POLES
from tweezer.values.arrays import Array, Complex
from tweezer.values.constants import Boltzmann

if TYPE_CHECKING:
    from tweezer.fluid import Memory

#: Amplitudes (m^2) and rates (1/s) of exponential decays; complex if a decay oscillates
Decays = list[tuple[complex, complex]]

#: Length of Sokal's window, in statistical inefficiencies
_WINDOW = 3.0
#: Largest number of blocks into which a series is averaged to find the variance of its mean
_BLOCKS = 2**15
#: Distance from critical damping below which the two rates count as equal
_CRITICAL = 1e-5
#: Exposure, in decay times, below which `_overlap` uses a series to avoid cancellation.
_SHORT = 1e-2
#: Remainder of a decay after a step that counts as 0
_NOTHING = 1e-18
#: Number of steps of Newton's method for the rates of a bead with memory.
_NEWTON = 3
#: Relative changes of stiffness, tried in turn, that separate two equal rates of a bead with
#: memory; also the error of the sum of amplitudes that reveals equal rates.
_DOUBLE = 1e-7
#: Relative difference between a rate and the diode's rate below which they count as equal.
_EQUAL = 1e-6


def power_spectrum(positions: Array, step: float, segments: int = 1) -> tuple[Array, Array]:
    """Return frequencies, Hz, and the one-sided power spectral density, m^2/Hz, of a recording.

    The frequencies are the Fourier frequencies between 0 and Nyquist's, both excluded. For a series
    much longer than its correlation time, the ratio of each value to its expectation is an
    independent Gamma(segments)/segments.

    Parameters
    ----------
    positions : ndarray, shape (n,)
        Positions, m.
    step : float
        Sampling interval, s.
    segments : int, optional
        Number of equal parts without overlap, each minus its mean, over which the periodogram is
        averaged (Bartlett's method).

    Returns
    -------
    frequencies : ndarray
        Frequencies, Hz.
    density : ndarray
        Power spectral density, m^2/Hz.

    Examples
    --------
    >>> from tweezer.calibration import power_spectrum
    >>> positions = 1e-8 * np.random.default_rng(1).normal(size=1000)
    >>> frequencies, density = power_spectrum(positions, step=1e-3)
    >>> bool(0.9 < 500 * density.mean() / positions.var() < 1.1)  # their integral is the variance
    True
    """
    from scipy.fft import rfft

    length = len(positions) // segments
    parts = positions[: segments * length].reshape(segments, length)
    waves = rfft(parts - parts.mean(axis=1, keepdims=True), overwrite_x=True)
    waves = waves[:, 1 : (length + 1) // 2]
    density = waves.real**2
    density += waves.imag**2
    density *= 2 * step / length
    mean = density[0] if segments == 1 else density.mean(axis=0)
    return np.arange(1, mean.size + 1) / (length * step), mean


def within(frequencies: Array, bands: Iterable[tuple[float, float]]) -> NDArray[np.bool_]:
    """Return which frequencies (n,), Hz, are in one of the bands (lowest, highest), Hz."""
    found = np.zeros(frequencies.shape, bool)
    for low, high in bands:
        found |= (frequencies >= low) & (frequencies <= high)
    return found


def autocovariance(positions: Array, lags: NDArray[np.int64] | None = None) -> Array:
    """Return the autocovariance of a record about its mean.

    Each lag is averaged over all its pairs. Because the record's own mean is subtracted, every
    value is too low by the variance of the mean (`TrappedBead.variance_of_mean`).

    Parameters
    ----------
    positions : ndarray, shape (n,)
        Record, m.
    lags : ndarray of int, shape (m,), optional
        Lags in samples, from 0 to n - 1. Default: all of them, by FFT. A few lags cost one pass
        over the record each.

    Returns
    -------
    ndarray, shape (m,)
        Autocovariance, m^2.
    """
    n = len(positions)
    return _products(positions, lags) / (n - (np.arange(n) if lags is None else lags))


def mean_squared_displacement(positions: Array, lags: NDArray[np.int64] | None = None) -> Array:
    """Return the mean squared displacement of a record, averaged over all overlapping pairs.

    Parameters
    ----------
    positions : ndarray, shape (n,)
        Record, m.
    lags : ndarray of int, shape (m,), optional
        Lags in samples, from 0 to n - 1. Default: all of them, by FFT.

    Returns
    -------
    ndarray, shape (m,)
        Mean squared displacement, m^2; unbiased.
    """
    n = len(positions)
    deviations = positions - np.mean(positions)
    squares, every = deviations**2, np.arange(n) if lags is None else lags
    ends = np.concatenate([[0.0], np.cumsum(squares)])
    both_ends = ends[n - every] + ends[n] - ends[every]
    return np.maximum(both_ends - 2 * _products(positions, lags), 0.0) / (n - every)


def _products(positions: Array, lags: NDArray[np.int64] | None = None) -> Array:
    """Return the sums (lags,), m^2, of products of deviations from the mean, a lag apart.

    `positions` (n,) are in m and `lags` in samples. The default is all lags from 0 to n - 1, by
    FFT.
    """
    from scipy.fft import irfft, next_fast_len, rfft

    n = len(positions)
    deviations = positions - positions.mean()
    if lags is not None:
        pairs = ((deviations[: n - lag], deviations[lag:]) for lag in lags)
        return np.array([np.einsum("i,i", *pair) for pair in pairs])  # on one core
    length = next_fast_len(2 * n, real=True)
    return np.asarray(irfft(np.abs(rfft(deviations, length)) ** 2, length)[:n])


def statistical_inefficiency(series: Array) -> float:
    """Return the number of samples of a `series` (n,) per independent sample, at least 1.

    It is 1 + 2 sum rho_j, where rho_j is the correlation at a lag of j samples. The sum ends at a
    lag of three times its value (A. Sokal's window), and is corrected for the mean of the record
    (U. Wolff, Comput. Phys. Commun. 156, 143 (2004)). A series that stays correlated to its end has
    the value n. A long series is first averaged over short blocks, which does not change its mean.
    """
    of_one = float(np.var(series))
    if of_one <= 0:
        return 1.0
    of_mean = variance_of_means(block_means(series))
    return min(max(of_mean * len(series) / of_one, 1.0), float(len(series)))


def standard_error(series: Array) -> float:
    """Return the standard error of the mean of a correlated series.

    It follows from the statistical inefficiency, the number of samples per independent sample.

    Parameters
    ----------
    series : ndarray, shape (n,)
        The series.
    """
    return math.sqrt(np.var(series) * statistical_inefficiency(series) / len(series))


def block_means(series: Array) -> Array:
    """Return the means (blocks,) of successive blocks of a long `series` (n,).

    Samples at the end that do not fill a block are omitted. If blocks are longer than the
    correlation time, there are enough of them to estimate the variance of the mean to 1 %.
    Otherwise they resolve the correlation.
    """
    length = -(-len(series) // _BLOCKS)
    if length == 1:
        return series
    return np.asarray(series[: len(series) // length * length].reshape(-1, length).mean(axis=1))


def variance_of_means(series: Array) -> float:
    """Return the variance of the mean of a correlated `series` (n,).

    It is a sum of correlations up to Sokal's window (`statistical_inefficiency`). For a series that
    stays correlated to its end, it is the variance of one sample.
    """
    n = len(series)
    covariance = autocovariance(series)
    if covariance[0] <= 0:
        return 0.0
    sums = 2 * np.cumsum(covariance / covariance[0]) - 1
    ends = np.flatnonzero(np.arange(n) >= _WINDOW * sums)
    if not ends.size:
        return float(covariance[0])
    window = int(ends[0])
    return float(covariance[0] * max(sums[window], 0.0) * (1 + (2 * window + 1) / n) / n)


def _overlap(v: NDArray[Any]) -> NDArray[Any]:
    """Return h(v) = e^-v - 1 + v, as a series for small v, where the terms cancel.

    It occurs in averages over an exposure: the integral of e^(-r|s - t|) over 0 < s, t < v/r is
    2 h(v)/r^2.
    """
    series = v**2 / 2 * (1 - v / 3 * (1 - v / 4 * (1 - v / 5 * (1 - v / 6))))
    return np.where(np.abs(v) < _SHORT, series, np.expm1(-v) + v)


@dataclass(frozen=True)
class TrappedBead:
    """Bead in a harmonic trap, m x'' + drag + k x = thermal noise, with its detector.

    Here x is the position, m the mass and k the stiffness. Without a mass the bead is overdamped
    (the Ornstein-Uhlenbeck process). The drag is beta x'. If the mass m_f of the displaced fluid
    is given, it is the drag of Boussinesq and Basset instead, with the Laplace transform gamma(s) =
    beta (1 + sqrt(s tau_f) + s tau_f/9) and tau_f = 9 m_f/(2 beta). This drag depends on earlier
    motion and adds m_f/2 to the mass. The memory is approximated by a sum of exponentials in time
    (`tweezer.fluid.memory`). Beside a wall the drag includes the reflected flow
    (`tweezer.fluid.reflection`).

    The autocovariance of the position is a sum of exponentials e^-rt with rates r. The detector
    changes it in four ways:

    * The signal is the position times `response`, V/m (1 for positions in metres).
    * A photodiode detects a fraction a of the signal without delay. It multiplies the power at the
      frequency f by a^2 + (1 - a^2)/(1 + (f/f_3)^2) (K. Berg-Sorensen et al., Rev. Sci. Instrum.
      77, 063106 (2006)). With w = 2 pi f_3, e^-rt becomes
      a^2 e^-rt + (1 - a^2) (w^2 e^-rt - r w e^-wt)/(w^2 - r^2).
    * Each sample is the mean over the exposure W (motion blur: W. P. Wong and K. Halvorsen, Opt.
      Express 14, 12517 (2006)). At t >= W, e^-rt becomes (sinh(rW/2)/(rW/2))^2 e^-rt. At t = 0 it
      becomes 2 (rW - 1 + e^-rW)/(rW)^2.
    * White noise is added to each sample.
    """

    stiffness: float
    """k, N/m"""
    drag: float
    """beta, kg/s"""
    temperature: float
    """T, K"""
    mass: float | None = None
    """m of the bead alone, kg"""
    exposure: float = 0.0
    """W, exposure time over which each position is averaged, s"""
    displaced_mass: float | None = None
    """m_f, mass of the displaced fluid, kg; None for a fluid without inertia"""
    poles: int = POLES
    """number of poles of the fluid's memory; with 24 the spectrum is exact to 5e-5 below 1 MHz"""
    diode_frequency: float | None = None
    """f_3, frequency at which the power of the delayed part is halved, Hz; None without delay"""
    diode_fraction: float = 0.0
    """a, fraction of the signal that a photodiode detects without delay, from 0 to 1"""
    noise: float = 0.0
    """standard deviation of the white noise in a sample, m or V"""
    response: float = 1.0
    """ratio of signal to position: V/m, or 1 for positions in m"""
    wall: float | None = None
    """distance of the bead's centre from a wall, in radii; None far from walls. The steady `drag`
    includes the wall already. The distance matters only with `displaced_mass`"""
    across: bool = False
    """whether the bead moves perpendicular to that wall, not parallel to it"""

    @property
    def variance(self) -> float:
        """Variance of recorded positions, m^2 or V^2: k_B T/k (equipartition), as detected."""
        return float(self.autocovariance(0.0))

    @property
    def corner_frequency(self) -> float:
        """Corner frequency k/(2 pi beta), Hz."""
        return self.stiffness / (2 * math.pi * self.drag)

    @property
    def diffusion(self) -> float:
        """Diffusion coefficient k_B T/beta, m^2/s (Einstein)."""
        return Boltzmann * self.temperature / self.drag

    @property
    def relaxation_time(self) -> float:
        """Time constant of the slowest decay, s: beta/k, or 2m/beta if the bead is underdamped.

        Hydrodynamic memory is ignored, because it decays without a slowest time constant.
        """
        return 1 / min(rate.real for _, rate in self._forgetful)

    @property
    def seen_as_it_is(self) -> bool:
        """Whether recorded positions equal the true ones, apart from a factor."""
        return not (self.exposure or self.diode_frequency or self.noise)

    @property
    def roll_off(self) -> float:
        """Frequency above which the spectrum decreases, Hz: the corner or resonance frequency."""
        mass = self._inertia
        if not mass:
            return self.corner_frequency
        return min(self.corner_frequency, math.sqrt(self.stiffness / mass) / (2 * math.pi))

    @property
    def _inertia(self) -> float:
        """Effective mass in fast motion, kg: that of the bead, and the added mass of the fluid.

        The added mass is half the mass of the displaced fluid, or more beside a wall.
        """
        if not self.displaced_mass:
            return self.mass or 0.0
        return (self.mass or 0.0) + self._memory.added * self.displaced_mass

    @property
    def _memory(self) -> Memory:
        """Hydrodynamic memory of the fluid, far from walls or beside one, with `poles` poles."""
        from tweezer.fluid import memory_beside, memory_far

        if self.wall is None:
            return memory_far(self.poles)
        return memory_beside(self.wall, across=self.across, poles=self.poles)

    def _drag_at(self, frequencies: Array) -> Complex:
        """Return the complex drag gamma(2 pi i f), kg/s, at `frequencies` f (n,), Hz.

        It includes the added mass and the hydrodynamic memory of the fluid.
        """
        from tweezer.fluid import drag_at

        fluid = self.displaced_mass or 0.0
        if self.wall is None or not fluid:
            return drag_at(frequencies, self.drag, fluid)
        return self._memory.drag_at(frequencies, self.drag, fluid)

    @cached_property
    def _forgetful(self) -> Decays:
        """Amplitudes (m^2) and rates (1/s) of the autocovariance of a bead without fluid memory.

        An overdamped bead has one exponential, and a bead with a mass two.
        """
        equipartition = Boltzmann * self.temperature / self.stiffness
        mass = self._inertia
        if not mass:
            return [(equipartition, self.stiffness / self.drag)]
        split = cmath.sqrt(1 - 4 * mass * self.stiffness / self.drag**2)
        if abs(split) < _CRITICAL:
            split = complex(_CRITICAL)  # the error is of second order
        fast = self.drag / (2 * mass) * (1 + split)
        slow = self.stiffness / mass / fast
        ratios = (fast / (fast - slow), slow), (-slow / (fast - slow), fast)
        return _plain((equipartition * part, rate) for part, rate in ratios)

    @cached_property
    def _decays(self) -> Decays:
        """Amplitudes (m^2) and rates (1/s) of the exponentials in the autocovariance.

        With memory, the Laplace transform of the autocovariance is C(s) = (k_B T/k) Z/(s Z + k),
        where Z(s) = m s + gamma(s) is the impedance of the bead. The poles of C are at s = -rate.
        """
        if not self.displaced_mass:
            return self._forgetful
        memory = self._memory
        time = 4.5 * self.displaced_mass / (self.drag * memory.mobility)
        inertia = self._inertia / (self.drag * time)
        parts, rates = _relaxation(inertia, self.stiffness * time / self.drag, memory)
        equipartition = Boltzmann * self.temperature / self.stiffness
        return _plain(zip(equipartition * parts, rates / time, strict=True))

    @cached_property
    def _detected(self) -> Decays:
        """Amplitudes (m^2 or V^2) and rates (1/s) in the autocovariance of the signal.

        They follow from those of the position. The squared response multiplies the amplitudes, and
        a diode adds its own rate. Exposure and noise are not included.
        """
        square = self.response**2
        decays = [(square * amplitude, rate) for amplitude, rate in self._decays]
        if not self.diode_frequency:
            return decays
        w = 2 * math.pi * self.diode_frequency
        # equal rates of bead and diode would divide by zero, so the latter is shifted slightly
        while any(abs(rate / w - 1) < _EQUAL for _, rate in decays):
            w *= 1 + 2 * _EQUAL
        late = 1 - self.diode_fraction**2
        seen, of_diode = [], 0.0j
        for amplitude, rate in decays:
            share = late * amplitude / (1 - (rate / w) ** 2)
            seen.append((self.diode_fraction**2 * amplitude + share, rate))
            of_diode -= share * rate / w
        return _plain([*seen, (of_diode.real, w)])

    def autocovariance(self, times: ArrayLike) -> Array:
        """Return the autocovariance <x(0) x(t)>, m^2 or V^2, of recorded positions.

        `times` are the lags t, s. The effects of exposure, diode and noise are included.
        """
        past = np.abs(np.asarray(times, np.float64))
        covariance = np.where(past == 0, self.noise**2, 0.0)
        for amplitude, rate in self._detected:
            decay = np.exp(-rate * past)
            if self.exposure:
                u, v = rate * self.exposure, rate * np.minimum(past, self.exposure)
                apart = _overlap(v + u) - 2 * _overlap(v) + _overlap(u - v)
                late = np.exp(-rate * np.maximum(past - self.exposure, 0)) * np.expm1(-u) ** 2
                decay = np.where(past < self.exposure, apart, late) / u**2
            covariance += np.real(amplitude * decay)
        return covariance

    def mean_squared_displacement(self, times: ArrayLike) -> Array:
        """Return <(x(t) - x(0))^2>, m^2 or V^2, of recorded positions x, at `times` t, s."""
        return 2 * (self.variance - self.autocovariance(times))

    def spectrum(self, frequencies: ArrayLike) -> Array:
        """Return the one-sided power spectral density, m^2/Hz or V^2/Hz, at `frequencies` f, Hz.

        It describes the continuous signal without noise. It is a Lorentzian, with a mass its
        inertial form, and with the mass of the fluid the exact hydrodynamic form (K. Berg-Sorensen
        and H. Flyvbjerg, Rev. Sci. Instrum. 75, 594 (2004)). It is multiplied by the response of
        the diode and by sinc^2(f W) for the exposure W.
        """
        f = np.asarray(frequencies, np.float64)
        s = 2j * np.pi * f
        gamma = self._drag_at(f)
        resistance = self.stiffness + s * gamma + (self.mass or 0.0) * s**2
        force = 4 * Boltzmann * self.temperature * gamma.real
        return np.asarray(force / np.abs(resistance) ** 2 * self._passed(f))

    def _passed(self, frequencies: Array) -> Array:
        """Return the ratio of signal power to the power of the motion at `frequencies`, Hz.

        It includes the response, the exposure and the diode, but no noise.
        """
        passed = (self.response * np.sinc(frequencies * self.exposure)) ** 2
        if self.diode_frequency:
            square = self.diode_fraction**2
            passed *= square + (1 - square) / (1 + (frequencies / self.diode_frequency) ** 2)
        return np.asarray(passed)

    def driven(self, frequencies: ArrayLike) -> Complex:
        """Return the complex ratio of signal to stage motion, V/m or 1, at `frequencies` f, Hz.

        Fluid and walls move with the stage, so gamma (s x - s x_s) + k x + m s^2 x = m_f s^2 x_s.
        Here x is the position of the bead, x_s the position of the stage and s = 2 pi i f. The last
        term is the pressure that accelerates the fluid (M. R. Maxey and J. J. Riley, Phys. Fluids
        26, 883 (1983)). The detector affects only the magnitude, not the phase.
        """
        f = np.asarray(frequencies, np.float64)
        s = 2j * np.pi * f
        fluid = self.displaced_mass or 0.0
        gamma = self._drag_at(f)
        moved = s * (gamma + s * fluid) / (s * gamma + self.stiffness + (self.mass or 0.0) * s**2)
        return np.asarray(moved * np.sqrt(self._passed(f)))

    def sampled_spectrum(
        self, frequencies: ArrayLike, step: float, samples: float = math.inf
    ) -> Array:
        """Return the one-sided power spectral density, m^2/Hz or V^2/Hz, of sampled positions.

        `frequencies` are in Hz and `step`, s, is the sampling interval. The density includes all
        aliases. It is the Fourier sum over the autocovariance of the samples, which is a sum of
        geometric series for lags of at least 1 (S. F. Norrelykke and H. Flyvbjerg, Phys. Rev. E 83,
        041103 (2011)). If `samples` is finite, the result is the expected periodogram at the
        Fourier frequencies of a record of that length, which includes leakage (A. M. Sykulski et
        al., Biometrika 106, 251 (2019)). The exposure must not exceed the step.
        """
        angle = 2 * np.pi * step * np.asarray(frequencies, np.float64)
        away = 2 * np.sin(angle / 2) ** 2  # 1 - cos
        turned = away - 1j * np.sin(angle) if any(map(_rings, self._detected)) else away  # 1 - e^ia
        density = np.full(angle.shape, self.variance)
        for amplitude, rate in self._detected:
            # sum over lags j of first e^(-(j - 1) rate step + i j angle), minus j/samples of each
            first = amplitude * np.exp(-rate * (step - self.exposure))
            if self.exposure:
                first *= (np.expm1(-rate * self.exposure) / (rate * self.exposure)) ** 2
            if abs(first) < _NOTHING * abs(amplitude):
                continue
            lost, kept = -np.expm1(-rate * step), np.exp(-rate * step)
            ends = -np.expm1(-rate * step * samples) / samples if math.isfinite(samples) else 0.0
            if _rings((amplitude, rate)):
                rest = lost + kept * turned
                density += 2 * np.real(first * (1 - turned) * (1 / rest - ends / rest**2))
                continue
            per_square = 1 / (lost**2 + 2 * kept * away)
            density += 2 * first * (lost - away) * per_square
            if ends:
                twice = lost**2 - (1 + kept**2) * away
                density -= 2 * first * ends * twice * per_square**2
        return 2 * step * density

    def variance_of_mean(self, step: float, samples: float) -> float:
        """Return the variance, m^2, of the mean of `samples` positions taken every `step`, s."""
        return float(self.sampled_spectrum(0.0, step, samples)) / (2 * step * samples)


def _plain(decays: Iterable[tuple[complex, complex]]) -> Decays:
    """Return decays in which amplitudes and rates are real numbers if the rate is real."""
    return [
        (complex(a), complex(r)) if complex(r).imag else (complex(a).real, complex(r).real)
        for a, r in decays
    ]


def _rings(decay: tuple[complex, complex]) -> bool:
    """Return whether a decay (amplitude, rate) from `_plain` oscillates, that is, is complex."""
    return isinstance(decay[1], complex)


def _relaxation(inertia: float, stiffness: float, memory: Memory) -> tuple[Complex, Complex]:
    """Return the exponentials in the autocovariance of a bead with memory: amplitudes and rates r.

    The units are the drag beta and tau_f = 9 m_f/(2 beta), the time in which vorticity diffuses
    over the bead (m_f: mass of the displaced fluid). `inertia` is the mass including the added
    mass, in beta tau_f. `stiffness` is k, in beta/tau_f. The rates are in 1/tau_f. `memory` has the
    rates p and weights c. With the impedance Z(s) = inertia s + 1 + sum c s/(s + p), the rates are
    r = -s at the zeros of D(s) = s Z(s) + k. They are computed as eigenvalues of an equivalent
    system, in which the bead drags one mass per pole by a dashpot c, and refined by Newton's
    method. The amplitudes, relative to the variance, are k/(r D'(-r)) and add up to 1.
    """
    p, c = memory.rates[::-1], memory.weights[::-1]
    n = len(p)
    each = np.arange(n)  # fast rates first, so that small eigenvalues keep their digits
    # a slightly different stiffness separates equal rates
    for k in stiffness * (1 + _DOUBLE * np.arange(3)):
        matrix = np.zeros((n + 2, n + 2))
        matrix[each, each] = -p
        matrix[each, n] = matrix[n, each] = np.sqrt(c * p / inertia)
        matrix[n, n] = -(1 + c.sum()) / inertia
        matrix[n + 1, n] = math.sqrt(k / inertia)
        matrix[n, n + 1] = -matrix[n + 1, n]
        s = np.linalg.eigvals(matrix).astype(np.complex128)[:, None]
        for _ in range(_NEWTON + 1):
            per_pole = 1 / (s + p)
            slope = 2 * inertia * s + 1 + (s * (1 + p * per_pole) * per_pole) @ c[:, None]
            parts = -k / (s * slope)
            rates = -s
            s = s - (inertia * s**2 + s * (1 + (s * per_pole) @ c[:, None]) + k) / slope
        if abs(parts.real.sum() - 1) < _DOUBLE:
            return parts[:, 0], rates[:, 0]
    raise ArithmeticError("the rates of a bead with memory are not found")
