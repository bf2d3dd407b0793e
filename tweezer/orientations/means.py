"""Means of correlated samples with standard errors, from the scatter of parts of the data.

The parts of an ensemble are its trajectories, which are independent. The parts of a run are blocks
of time, of which neighbours may be correlated.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Self

import numpy as np

from tweezer.values.arrays import Array

#: Number of blocks into which a run is divided
_BLOCKS = 20


@dataclass(frozen=True)
class Parts:
    """Sums over the samples of each part of the data, from which means and errors follow."""

    totals: Array
    """(parts, ...) sums of the values"""
    counts: Array
    """(parts,) numbers of samples in the sums"""
    successive: bool
    """whether the parts are successive blocks of a run, not trajectories"""

    @classmethod
    def of(cls, values: Array, *, successive: bool, span: int = 1) -> Self:
        """Return the sums of values (trajectories, n, ...), without samples that contain NaN.

        The blocks of a run, `successive`, are at least `span` samples long, so that values which
        extend over `span` samples correlate only neighbours.
        """
        n = values.shape[1]
        blocks = max(1, min(_BLOCKS, n // span)) if successive else 1
        begins = np.arange(blocks) * n // blocks
        totals = np.add.reduceat(values, begins, axis=1)
        counts = np.tile(np.diff(begins, append=n), (len(values), 1)).astype(np.float64)
        if np.isnan(totals).any():
            valid = np.isfinite(values).all(axis=tuple(range(2, values.ndim)))
            kept = np.where(valid.reshape(*valid.shape, *(1,) * (values.ndim - 2)), values, 0.0)
            totals = np.add.reduceat(kept, begins, axis=1)
            counts = np.add.reduceat(valid, begins, axis=1, dtype=np.float64)
        return cls(totals.reshape(-1, *values.shape[2:]), counts.ravel(), successive)

    @classmethod
    def joined(cls, several: Iterable[Parts]) -> Self:
        """Return the parts of several groups of trajectories together."""
        each = list(several)
        totals, counts = (np.concatenate([getattr(one, name) for one in each])
                          for name in ("totals", "counts"))  # fmt: skip
        return cls(totals, counts, each[0].successive)

    def times(self, matrix: Array) -> Parts:
        """Return the parts with each vector of values multiplied by a matrix."""
        return Parts(self.totals @ matrix.T, self.counts, self.successive)

    @property
    def mean(self) -> Array:
        """Mean over all samples; NaN without a sample."""
        number = self.counts.sum()
        return np.asarray(self.totals.sum(axis=0) / (number if number else np.nan))

    @property
    def freedom(self) -> int:
        """Degrees of freedom of the standard error: one fewer than parts with samples."""
        return max(int(np.count_nonzero(self.counts)) - 1, 0)

    @property
    def error(self) -> Array:
        """Standard error of the mean; NaN for a single part.

        It is the error of a ratio, total over number, because parts may differ in length (Cochran,
        Sampling Techniques, 2.11). A positive covariance of neighbouring blocks is added. It covers
        correlations up to the length of a block.
        """
        counts = self.counts.reshape(-1, *(1,) * (self.totals.ndim - 1))
        off = self.totals - self.mean * counts
        squares = np.sum(off**2, axis=0)
        if self.successive:
            squares = squares + 2 * np.maximum(np.sum(off[1:] * off[:-1], axis=0), 0.0)
        freedom = self.freedom or np.nan
        return np.asarray(np.sqrt(squares * (freedom + 1) / freedom) / self.counts.sum())
