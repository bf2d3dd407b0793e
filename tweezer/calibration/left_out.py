"""Exclusion of slow drift and frequency bands from a record, and the frequency range of fits."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from tweezer.calibration.driving import motion, strongest_line
from tweezer.calibration.spectra import TrappedBead, within
from tweezer.values.arrays import Array
from tweezer.values.errors import ResultError
from tweezer.values.printed import printed, signal_unit
from tweezer.values.units import QuantityLike, bare, to_si

Band = tuple[float, float]

#: Largest number of frequencies that represent an excluded band.
_MOST = 500
#: Smallest number of ordinates that must remain in a spectrum.
LEAST_ORDINATES = 50


class Missing(NamedTuple):
    """Part of a bead's motion that a record lacks, as a sum of n cosines."""

    frequencies: Array
    """(n,) frequencies of the cosines, Hz"""
    variances: Array
    """(n,) expected variances of the cosines in the bead's motion, m^2 or V^2"""

    def autocovariance(self, times: ArrayLike) -> Array:
        """Return the autocovariance of the missing motion at `times`, s, in m^2 or V^2."""
        angles = 2 * np.pi * np.multiply.outer(times, self.frequencies)
        return np.asarray(np.cos(angles) @ self.variances)


@dataclass(frozen=True)
class LeftOut:
    """Drift and frequency bands excluded from a record, and the frequency range of its fits.

    Drift is removed as whole cosines (DCT-II), from half a period in the record up to the drift
    frequency. A band is removed as its strongest line and the Fourier components in it. Together
    with them, a part of the bead's own motion is removed, which `missing` computes from the fit.
    """

    bands: tuple[Band, ...] = ()
    """lowest and highest frequency of each band, Hz"""
    drift: float = 0.0
    """frequency below which motion is removed, Hz"""
    fit_range: Band = (0.0, math.inf)
    """lowest and highest frequency of spectral fits, Hz; the record retains other frequencies"""

    @classmethod
    def of(
        cls,
        name: str,
        leave_out: Sequence[str | Band] = (),
        drift: QuantityLike | None = None,
        fit_range: str | Band | None = None,
    ) -> LeftOut:
        """Return the exclusions, from numbers in Hz or texts such as "49 Hz..51 Hz".

        Parameters
        ----------
        name : str
            Name of the recording, for the `ResultError` about an invalid value.
        leave_out : sequence of str or pair, optional
            Frequency bands that were removed, Hz.
        drift : float or str, optional
            Frequency below which drift was removed, Hz.
        fit_range : str or pair, optional
            Frequency range of the spectral fits, Hz.
        """
        bands = tuple(_band(name, "leave_out", each) for each in leave_out)
        slowest = 0.0 if drift is None else _hertz(name, "drift", drift, drift)
        within = (0.0, math.inf) if fit_range is None else _band(name, "fit_range", fit_range)
        return cls(bands, slowest, within)

    def cosines(self, samples: int, step: float) -> int:
        """Return the number of cosines removed as drift, for an interval of `step`, s."""
        return math.floor(2 * self.drift * samples * step)

    def refuse_too_much(self, name: str, samples: int, step: float) -> None:
        """Raise `ResultError` if too few Fourier frequencies remain for a fit.

        The record `name` has this number of `samples`, taken every `step`, s.
        """
        frequencies = np.arange(1, (samples + 1) // 2) / (samples * step)
        kept = ~within(frequencies, (*self.of_record(samples, step), *self.of_fit))
        if kept.sum() < min(LEAST_ORDINATES, len(frequencies)):
            raise ResultError(
                f"{name}: leaves {kept.sum()} of {len(frequencies)} frequencies; must leave "
                f"{LEAST_ORDINATES} or more of those from {frequencies[0]:.3g} to "
                f"{frequencies[-1]:.3g} Hz"
            )

    def of_record(self, samples: int, step: float) -> tuple[Band, ...]:
        """Return the bands, Hz, whose ordinates are excluded from the record's spectrum."""
        if not (taken := self.cosines(samples, step)):
            return self.bands
        return (*self.bands, (0.0, (taken + 1) / (2 * samples * step)))

    @property
    def of_fit(self) -> tuple[Band, ...]:
        """Bands of frequencies, Hz, that spectral fits exclude."""
        low, high = self.fit_range
        bands = [(0.0, low)] if low else []
        return (*bands, (high, math.inf)) if math.isfinite(high) else tuple(bands)

    def without(self, signal: Array, step: float) -> Array:
        """Return a signal (n,), sampled every `step`, s, without drift and excluded bands."""
        from scipy.fft import dct, idct, irfft, rfft

        if taken := self.cosines(len(signal), step):
            parts = dct(signal, norm="ortho")
            parts[1 : taken + 1] = 0.0
            signal = idct(parts, norm="ortho")
        if self.bands:
            for band in self.bands:  # first the strongest line, which leaks out of the band
                line = strongest_line(signal - signal.mean(), step, band)
                if line is not None:
                    moving = motion(signal, [line], step)[1]
                    signal = signal - (moving - moving.mean())
            waves = rfft(signal)
            frequencies = np.arange(len(waves)) / (len(signal) * step)
            waves[within(frequencies, self.bands) & (frequencies > 0)] = 0.0
            signal = irfft(waves, len(signal))
        return signal

    def missing(self, bead: TrappedBead, samples: int, step: float) -> Missing:
        """Return the part of a bead's motion that a record lacks after the exclusions.

        At most 500 frequencies represent each band.
        """
        duration = samples * step
        taken = self.cosines(samples, step)
        every = [(np.arange(1, taken + 1) / (2 * duration), 1 / (2 * duration))]
        fourier = np.arange(1, (samples + 1) // 2) / duration
        every += [(fourier[within(fourier, [band])], 1 / duration) for band in self.bands]
        rows = [
            (float(part.mean()), len(part) * width)
            for frequencies, width in every
            for part in np.array_split(frequencies, min(len(frequencies), _MOST) or 1)
            if len(part)
        ]
        frequencies, widths = np.array(rows).reshape(-1, 2).T
        return Missing(frequencies, widths * bead.sampled_spectrum(frequencies, step, samples))

    def words(self, signal: Array, kept: Array, step: float, unit: str) -> str:
        """Return a description of the exclusions from a signal; "" without exclusions.

        Parameters
        ----------
        signal : ndarray, shape (n,)
            The signal.
        kept : ndarray, shape (n,)
            The remaining signal.
        step : float
            Sampling interval, s.
        unit : str
            Unit of the signal, "m" or "V".
        """
        taken = self.cosines(len(signal), step)
        parts = [f"the drift, {taken} cosines slower than {self.drift:.3g} Hz"] if taken else []
        parts += [f"{low:.4g} to {high:.4g} Hz" for low, high in self.bands]
        if not parts:
            return ""
        size = float(np.std(signal - kept))
        together = printed(size, signal_unit(unit), 2)
        return f"left out: {', '.join(parts)}; together {together} rms"


def _band(name: str, key: str, value: str | Band) -> Band:
    """Return the ends of a band, Hz; messages contain the name of the record and the `key`."""
    ends: Sequence[QuantityLike] = value.split("..") if isinstance(value, str) else value
    if len(ends) != 2:
        raise ResultError(f'{name}: {key} = {value!r}: must have the form "49 Hz..51 Hz"')
    low, high = (_hertz(name, key, each, value) for each in ends)
    if not low < high:
        raise ResultError(f"{name}: {key} = {value!r}: must end above where it begins")
    return low, high


def _hertz(name: str, key: str, value: QuantityLike, given: object) -> float:
    """Return a frequency, Hz; messages quote `given`, the complete argument `key`."""
    try:
        number = to_si(bare(value), "1/s")
    except ValueError as error:
        raise ResultError(f"{name}: {key} = {given!r}: {error}") from None
    if not 0 <= number < math.inf:
        raise ResultError(f"{name}: {key} = {given!r}: must be a frequency, 0 Hz or more")
    return number


#: No exclusions.
NOTHING = LeftOut()
