"""Steps of a free bead between samples: their spectrum, and its exact likelihood."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from scipy.fft import dst
from scipy.optimize import minimize_scalar

from tweezer.calibration.spectra import within
from tweezer.values.arrays import Array

#: Number of blocks of ordinates, evenly spaced in the logarithm of the frequency.
_BLOCKS = 1000
#: Largest number of steps of Fisher's scoring.
_SCORINGS = 40
#: Range of ln(B/A) in a fit.
_NOISY = (-7.0, 16.0)
#: Tolerance of the logarithms of A and B.
EXACT = 1e-5


class Steps:
    """Steps of one coordinate between jumps and gaps, as sums over blocks of frequencies.

    The power of the steps at the angle phi = 2 pi frequency dt, from 0 to pi, is
    A (1 + cos phi)/2 + B (1 - cos phi)/2. A = 2 D dt is the power at low frequencies, with the
    diffusion coefficient D and the sampling interval dt. B = A + 4 s is the power at the Nyquist
    frequency, where -s is the covariance of successive steps. The methods take a = ln A and
    b = ln B, with A and B in units of `square`. Each track has its own drift.

    Parameters
    ----------
    pieces : sequence of ndarray
        Rows of successive steps, m.
    step : float
        Sampling interval, s.
    without : sequence of (float, float)
        Bands of frequencies (Hz) whose ordinates are not used.
    tracks : sequence of int
        Index of the track to which each piece belongs. Default: all pieces belong to one track.
    square : float
        Unit of A and B, m^2. Default: the mean squared step.
    """

    def __init__(
        self,
        pieces: Sequence[Array],
        step: float,
        without: Sequence[tuple[float, float]] = (),
        tracks: Sequence[int] | None = None,
        square: float | None = None,
    ):
        every = np.concatenate(pieces)
        self.count, self.step = len(every), step
        self.square = square or float(np.var(every))
        tracks = tracks or [0] * len(pieces)
        # sine components of the steps and of a steady drift, with their angles phi and track
        # numbers
        rows = []
        for piece, track in zip(pieces, tracks, strict=True):
            n = len(piece)
            angle = np.pi * np.arange(1, n + 1) / (n + 1)
            # sine transform of a constant, which is the contribution of a steady drift
            ones = np.sqrt(2 / (n + 1)) / np.tan(angle / 2) * (np.arange(1, n + 1) % 2)
            ordinate = dst(piece, type=1, norm="ortho")
            frequency = angle / (2 * np.pi * step)
            kept = ~within(frequency, without)
            rows.append(np.stack([angle, ordinate, ones, np.full(n, track)])[:, kept])
        angle, ordinate, ones, of = np.concatenate(rows, axis=1)
        order = np.argsort(angle, kind="stable")
        self.track = of[order].astype(int)
        self.ordinates, self.ones = ordinate[order] / math.sqrt(self.square), ones[order]
        self.share = (1 + np.cos(angle[order])) / 2  # coefficient of A in the power; 1 - share of B
        # Sums over blocks of neighbouring frequencies, in which the power is nearly constant: the
        # number of ordinates, their shares and squares. For each track, also the products of
        # ordinates and drift, and the squares of the drift.
        n = len(order)
        starts = np.arange(n)
        if n > 2 * _BLOCKS:
            starts = np.unique(np.geomspace(1, n + 1, _BLOCKS).astype(int))[:-1] - 1
        self._counts = np.diff([*starts, n]).astype(np.float64)
        self._share = np.add.reduceat(self.share, starts) / self._counts
        self._squares = np.add.reduceat(self.ordinates**2, starts)
        block = np.repeat(np.arange(len(starts)), self._counts.astype(int))
        self._cross, self._drift = np.zeros((2, 1 + max(tracks), len(starts)))
        np.add.at(self._cross, (self.track, block), self.ordinates * self.ones)
        np.add.at(self._drift, (self.track, block), self.ones**2)
        self._near = 0.0  # ln B of the last fit, the initial value of the next one

    def misfit(self, a: float, b: float) -> float:
        """Return -2 log(likelihood) for a = ln A and b = ln B, integrated over all drifts."""
        spectrum = math.exp(a) * self._share + math.exp(b) * (1 - self._share)
        per = 1 / spectrum
        of_drift = self._drift @ per
        value = self._counts @ np.log(spectrum) + self._squares @ per
        return float(value - ((self._cross @ per) ** 2 / of_drift - np.log(of_drift)).sum())

    def best(self, a: float) -> tuple[float, float]:
        """Return the smallest misfit for a = ln A over all B, and ln B at this minimum.

        Fisher's scoring usually finds ln B in a few steps. If it does not converge, a bounded
        search over ln(B/A) is used.
        """
        A, b = math.exp(a), self._near if abs(self._near - a) < _NOISY[1] else a
        for _ in range(_SCORINGS):
            of_b = math.exp(b) * (1 - self._share)  # contribution of B to the power of each block
            per = 1 / (A * self._share + of_b)
            slope = of_b * per  # derivative of the logarithm of the power with respect to ln B
            again = slope * per
            of_drift, cross = self._drift @ per, self._cross @ per
            change = self._counts @ slope - self._squares @ again
            change += (2 * cross * (self._cross @ again) / of_drift).sum()
            change -= ((self._drift @ again) * (cross**2 / of_drift + 1) / of_drift).sum()
            move = -float(change) / float(self._counts @ slope**2)
            b = min(max(b + min(max(move, -1.0), 1.0), a + _NOISY[0]), a + _NOISY[1])
            if abs(move) < EXACT:
                self._near = b
                return self.misfit(a, b), b
        found = minimize_scalar(
            lambda noisy: self.misfit(a, a + noisy), bounds=_NOISY, method="bounded",
            options={"xatol": EXACT},
        )  # fmt: skip
        return float(found.fun), a + float(found.x)

    def information(self, a: float, b: float) -> Array:
        """Return Fisher's information on ln A and ln B, (2, 2), for a = ln A and b = ln B."""
        A, B = math.exp(a), math.exp(b)
        spectrum = A * self._share + B * (1 - self._share)
        slopes = np.stack([A * self._share, B * (1 - self._share)]) / spectrum
        return np.asarray((slopes * self._counts) @ slopes.T / 2)

    def drifts(self, a: float, b: float) -> tuple[Array, Array]:
        """Return the drift of each track and its standard uncertainty, m/s, for a = ln A, b = ln B.

        The drift is the weighted mean step of the track divided by the sampling interval.
        """
        per = 1 / (math.exp(a) * self._share + math.exp(b) * (1 - self._share))
        of_drift = self._drift @ per
        unit = math.sqrt(self.square) / self.step
        return unit * (self._cross @ per) / of_drift, unit / np.sqrt(of_drift)

    def ratios(self, a: float, b: float) -> tuple[Array, Array]:
        """Return the normalised periodogram of the steps, and the mean of each of its values.

        For the spectrum with a = ln A and b = ln B, each squared ordinate is divided by its
        expectation. Both arrays have one value per ordinate, in the order of frequency. The means
        are slightly less than 1, because the drift of each track is fitted.
        """
        drifts, errors = self.drifts(a, b)
        unit = self.step / math.sqrt(self.square)
        spectrum = math.exp(a) * self.share + math.exp(b) * (1 - self.share)
        off = self.ordinates - unit * drifts[self.track] * self.ones
        taken = (unit * errors[self.track] * self.ones) ** 2 / spectrum
        return off**2 / spectrum, 1 - taken
