"""Response of a trapped bead to a moving stage, which active calibration measures.

The fluid moves with the stage and displaces the bead. The displacement follows from stiffness and
drag, so that the bead's signal determines the displacement sensitivity (S. F. Tolic-Norrelykke et
al., Rev. Sci. Instrum. 77, 103101 (2006)). This module covers a stage that oscillates at a few
frequencies; `tweezer.calibration.following` covers any other motion.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize_scalar

from tweezer.calibration.answers import Answer
from tweezer.calibration.following import Followed, jumping
from tweezer.calibration.spectra import power_spectrum, within
from tweezer.values.arrays import Array, Complex

#: Largest number of frequencies of an oscillating stage
_MOST_LINES = 8
#: Smallest amplitude of a driven frequency, over the largest amplitude.
_WEAKEST = 0.03
#: Smallest power of a driven frequency, over the medians on both sides.
_DISTINCT = 1e3
#: Number of ordinates on each side, and their distance from the frequency.
_SIDE = 7
#: Motion that counts as rounding of a linear drift, over the extent of the drift.
_ROUNDING = 1e-6
#: Accuracy of a frequency, over the inverse duration of the record.
_FINE = 1e-4
#: Smallest number of periods of the drive in a record.
_LEAST_PERIODS = 5
#: Smallest amplitude of a visible response, in standard uncertainties.
_SEEN = 5.0
#: Number of ordinates on each side of a line from which the thermal motion is measured.
_AROUND = 50


def driven_frequencies(drive: Array, step: float) -> list[float]:
    """Return the frequencies, Hz, at which a stage oscillates, the strongest first.

    `drive` (n,), m, are positions of the stage every `step`, s. The largest ordinate of the
    spectrum (Hann window) that exceeds both sides is a frequency. It is refined, its oscillation is
    subtracted, and the search is repeated. A stage that does not oscillate has no frequencies.
    """
    from scipy.fft import rfft
    from scipy.ndimage import median_filter
    from scipy.signal.windows import hann

    n = len(drive)
    window = hann(n, sym=False)
    left = drive
    found: list[float] = []
    strongest = 0.0
    while len(found) < _MOST_LINES:
        power = np.abs(rfft(window * left)) ** 2
        beside = np.pad(median_filter(power, _SIDE, mode="nearest"), _SIDE, mode="edge")
        sides = np.maximum(beside[: -2 * _SIDE], beside[2 * _SIDE :])
        power[(power <= _DISTINCT * sides) | (np.arange(len(power)) < _LEAST_PERIODS)] = 0.0
        peak = int(power.argmax())
        if not power[peak]:
            break

        frequency, size = _refined(window * left, peak, step)
        amplitude = 2 * size / window.sum()
        strongest = max(strongest, amplitude)
        if amplitude < _WEAKEST * strongest:
            break
        found.append(frequency)
        left = drive - motion(drive, found, step)[1]
    return found


def strongest_line(signal: Array, step: float, band: tuple[float, float]) -> float | None:
    """Return the frequency, Hz, in a band at which a signal (n,) is strongest.

    `step`, s, is the sampling interval. Returns None if no Fourier frequency is in the band.
    """
    from scipy.fft import rfft
    from scipy.signal.windows import hann

    windowed = hann(len(signal), sym=False) * signal
    size = np.abs(rfft(windowed))
    frequencies = np.arange(len(size)) / (len(signal) * step)
    size[~within(frequencies, [band]) | (frequencies == 0)] = 0.0
    peak = int(size.argmax())
    return _refined(windowed, peak, step)[0] if peak else None


def _refined(windowed: Array, peak: int, step: float) -> tuple[float, float]:
    """Return the frequency, Hz, near ordinate `peak` that maximises the Fourier sum, and this sum.

    `windowed` (n,) is a signal multiplied by a window, sampled every `step`, s. The sum has the
    unit of the signal.
    """
    times = np.arange(len(windowed)) * step

    def missed(frequency: float) -> float:
        return -abs(np.exp(-2j * np.pi * frequency * times) @ windowed)

    bin_ = 1 / (len(windowed) * step)
    ends = (peak - 0.6) * bin_, (peak + 0.6) * bin_
    options = {"xatol": _FINE * bin_}
    best = minimize_scalar(missed, bounds=ends, method="bounded", options=options)
    return float(best.x), -float(best.fun)


def whole_periods(frequencies: Sequence[float], samples: int, step: float) -> int:
    """Return the number of samples that best contains whole periods of all frequencies, Hz.

    It is at most `samples`, and smaller by at most one period of the lowest frequency. `step`, s,
    is the sampling interval.
    """
    lengths = np.arange(max(samples - math.ceil(1 / (min(frequencies) * step)), 2), samples + 1)
    periods = np.outer(frequencies, lengths * step)
    return int(lengths[::-1][np.abs(periods - np.rint(periods)).max(axis=0)[::-1].argmin()])


def motion(signal: Array, frequencies: Sequence[float], step: float) -> tuple[Complex, Array]:
    """Return the oscillations of a signal (n,) at given frequencies, Hz, by least squares.

    The first result contains complex amplitudes c (frequencies,) of Re(c e^(i w t)), with w = 2 pi
    times the frequency, and t from 0 in steps of `step`, s. The second is the sum (n,) of these
    oscillations and the mean of the signal.
    """
    angles = 2 * np.pi * step * np.outer(frequencies, np.arange(len(signal)))
    waves = np.vstack([np.ones(len(signal)), np.cos(angles), np.sin(angles)])
    parts = np.linalg.solve(waves @ waves.T, waves @ signal)
    cosines, sines = np.split(parts[1:], 2)
    return cosines - 1j * sines, parts @ waves


@dataclass(frozen=True)
class Drive:
    """Motion of the stage in one record, separated into oscillations and other motion."""

    frequencies: tuple[float, ...]
    """frequencies at which the stage oscillates, Hz; empty for other motion"""
    amplitudes: Complex
    """(frequencies,) complex amplitudes of these oscillations, m"""
    uncertainty: Array
    """(frequencies,) standard uncertainty of the real and of the imaginary part, m"""
    beside: Array
    """(samples,) motion of the stage without these oscillations, m"""
    step: float
    """sampling interval, s"""
    jumps: float
    """fraction of the stage's path that it covers in jumps between samples, from 0 to 1"""

    @classmethod
    def of(cls, drive: Array, step: float) -> Drive | None:
        """Return the drive of the positions `drive` (n,), m; None if they do not oscillate."""
        from scipy.signal import detrend

        raw, drive = drive, detrend(drive)
        if np.ptp(drive) <= _ROUNDING * np.ptp(raw):
            return None
        frequencies = driven_frequencies(drive, step)
        samples = whole_periods(frequencies, len(drive), step) if frequencies else len(drive)
        amplitudes, moved = motion(drive[:samples], frequencies, step)
        still = detrend(raw[:samples] - moved)  # an incomplete period has a slope of its own
        spectrum = power_spectrum(still, step)
        error = [_thermal(spectrum, frequencies, each) for each in frequencies]
        return cls(
            tuple(frequencies), amplitudes, np.sqrt(error), still, step, jumping(drive)
        )  # fmt: skip

    def answers(self, signal: Array) -> tuple[Array, tuple[Answer, ...], tuple[float, ...]]:
        """Separate a signal (n,), m or V, into its responses to the drive and the remainder.

        Returns the remainder (samples,), the visible responses, and the frequencies, Hz, at which
        the stage's sensor has noise that the bead does not follow.
        """
        signal = signal[: len(self.beside)]
        amplitudes, moved = motion(signal, self.frequencies, self.step)
        rest = signal - moved
        lines = self._lines(amplitudes, rest)
        followed = Followed.of(rest, self.beside, self.step, lines, steady=not self.jumps)
        still = followed.still + signal.mean()
        return still, (*self._lines(amplitudes, still), *followed.answers), followed.noise

    def _lines(self, amplitudes: Complex, still: Array) -> list[Answer]:
        """Return the visible responses at the frequencies of the drive.

        Their uncertainty follows from the thermal motion in `still`, the signal without them.
        """
        spectrum = power_spectrum(still, self.step)
        found = []
        for f, stage, error, answer in zip(
            self.frequencies, self.amplitudes, self.uncertainty, amplitudes, strict=True
        ):
            variance = _thermal(spectrum, self.frequencies, f)
            power = abs(answer) ** 2 - variance  # thermal motion adds its variance to the square
            if power > _SEEN**2 * variance:
                seen = math.sqrt(power), math.sqrt(variance), cmath.phase(answer / stage)
                found.append(Answer(f, float(abs(stage)), float(error), *seen))
        return found


def _thermal(spectrum: tuple[Array, Array], lines: Sequence[float], at: float) -> float:
    """Return the variance of the real part of an amplitude at the frequency `at`, Hz.

    It is S/t, where S is the mean density of the `spectrum` (frequencies, Hz, and densities) around
    `at`, excluding other `lines` (Hz), and t is the duration of the record.
    """
    frequencies, density = spectrum
    others = np.ones(len(frequencies), bool)
    for line in lines:
        others &= np.abs(frequencies - line) > 2.5 * frequencies[0]
    here = int(np.searchsorted(frequencies, at))
    around = slice(max(here - _AROUND, 0), here + _AROUND)
    return float(density[around][others[around]].mean()) * frequencies[0]
