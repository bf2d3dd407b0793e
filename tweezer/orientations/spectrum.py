"""Power spectral density of the components of a direction, with errors from its segments."""

from __future__ import annotations

import numpy as np

from tweezer.values.arrays import Array

#: Smallest number of samples in a segment
_SHORTEST = 8


class Spectrum:
    """Mean periodogram over segments of trajectories, with the sums that give its error."""

    def __init__(self, samples: int, step: float, segments: int) -> None:
        """Begin without a trajectory of `samples` samples, one every `step`, s."""
        self.step = step
        self.segments = max(1, min(segments, samples // _SHORTEST))
        self.length = samples // self.segments
        self.frequency = np.arange(1, self.length // 2 + 1) / (self.length * step)
        self.number = 0
        self.total = np.zeros((self.frequency.size, 3))
        self.squares = np.zeros((self.frequency.size, 3))

    def add(self, direction: Array) -> None:
        """Add directions (trajectories, n, 3); segments with NaN are excluded."""
        from scipy.signal import periodogram

        held = direction[:, : self.segments * self.length].reshape(-1, self.length, 3)
        held = held[np.isfinite(held).all(axis=(1, 2))]
        if not held.size:
            return
        _, density = periodogram(held, 1 / self.step, "hann", detrend="constant", axis=1)
        self.number += len(held)
        self.total += density[:, 1:].sum(axis=0)
        self.squares += np.square(density[:, 1:]).sum(axis=0)

    @property
    def mean(self) -> Array:
        """Power spectral density (3, frequencies), 1/Hz; NaN without a segment."""
        return np.asarray(self.total.T / (self.number or np.nan))

    @property
    def error(self) -> Array:
        """Standard error of `mean`; NaN for fewer than two segments."""
        if self.number < 2:
            return np.full(self.total.T.shape, np.nan)
        scatter = np.maximum(self.squares.T / self.number - self.mean**2, 0.0)
        return np.asarray(np.sqrt(scatter / (self.number - 1)))
