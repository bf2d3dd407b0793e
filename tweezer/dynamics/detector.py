"""Signals of a scene's detector along a motion, with its bandwidth and shot noise."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tweezer.dynamics.brownian import noise
from tweezer.optics.detection import Detection, detection
from tweezer.scene import Scene
from tweezer.values.arrays import Array

Integers = NDArray[np.int64]

#: Purpose of a random number for a detector (`noise`); the words before it are sample and
#: trajectory
_SHOT = -3


@dataclass(frozen=True)
class Signals:
    """Signals of a detector in a run, sampled at even intervals."""

    scene: Scene
    """scene with a detector"""
    seed: int
    """seed of the run"""
    interval: float
    """time between samples, s"""

    @classmethod
    def of(cls, scene: Scene, seed: int, times: Array) -> Signals:
        """Return the signals of a scene's detector at even times, (2 or more,) s."""
        return cls(scene, seed, float(times[1] - times[0]))

    @functools.cached_property
    def _of(self) -> Detection:
        """Signals as functions of the position."""
        return detection(self.scene)

    def recorded(self, positions: Array, trajectories: Integers, first: int = 0) -> Array:
        """Return the signals of x, y and z at successive samples, (m, n, 3) W.

        They are NaN where the position is NaN, and with a bandwidth also at all later samples.
        Before the first position the bead is at rest. Between samples signals are linear.

        Parameters
        ----------
        positions : ndarray, shape (m, n, 3)
            Positions of each trajectory, m.
        trajectories : ndarray of int, shape (m,)
            Numbers of the trajectories, which with seed and sample determine the noise.
        first : int, optional
            Number of the first sample.
        """
        detector = self.scene.detector
        assert detector is not None
        along = self._of.along(positions.reshape(-1, 3))
        found, spectrum = (each.reshape(positions.shape) for each in along)
        low_pass, width = None, 0.5 / self.interval
        if detector.bandwidth is not None:
            width = math.pi / 2 * detector.bandwidth
            low_pass = _LowPass(detector.bandwidth, self.interval)
            found = low_pass.of_signal(found)
        if not detector.noise:
            return found
        samples = np.arange(first, first + positions.shape[1])
        white = np.empty((len(positions), 3, len(samples)))
        for drawn, trajectory in zip(white, trajectories, strict=True):
            noise.normals(self.seed, samples, int(trajectory), _SHOT, drawn)
        white = white.swapaxes(1, 2)
        if low_pass is not None:
            white = low_pass.of_noise(white)
        return np.asarray(found + np.sqrt(spectrum * width) * white)


class _LowPass:
    """First-order low-pass filter of a half-power frequency, Hz, for samples at an interval, s."""

    def __init__(self, frequency: float, interval: float) -> None:
        self._turn = 2 * math.pi * frequency * interval
        self._kept = math.exp(-self._turn)

    def of_signal(self, values: Array) -> Array:
        """Return values (m, n, 3) behind the filter, exactly for values linear between samples."""
        mean = -math.expm1(-self._turn) / self._turn
        return self._filtered(values, [1 - mean, mean - self._kept])

    def of_noise(self, drawn: Array) -> Array:
        """Return noise of unit variance behind the filter, of white normal numbers (m, n, 3)."""
        size = math.sqrt(-math.expm1(-2 * self._turn))
        return self._filtered(np.concatenate([drawn[:, :1], size * drawn[:, 1:]], axis=1), [1.0])

    def _filtered(self, values: Array, numerator: list[float]) -> Array:
        """Return y_k = kept y_(k-1) + numerator values over axis 1, from y_0 = values_0."""
        from scipy.signal import lfilter

        begin = values[:, :1]
        state = self._kept * begin + sum(numerator[1:]) * begin
        found, _ = lfilter(numerator, [1.0, -self._kept], values[:, 1:], axis=1, zi=state)
        return np.concatenate([begin, found], axis=1)
