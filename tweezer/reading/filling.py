"""Random values for missing samples of a recording, given their neighbours."""

from __future__ import annotations

import zlib
from typing import NamedTuple

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from tweezer.reading.table import Array

#: Largest number of consecutive missing samples that are filled
LONGEST = 10
#: Number of samples on each side of a gap that determine its distribution
_NEIGHBOURS = 4
#: Ratio of an eigenvalue of the neighbours' covariance to the largest below which it is rounding
_ALIKE = 1e-12
#: Number of passes; each computes correlations from the record filled by the previous one
_PASSES = 3


class _Rule(NamedTuple):
    """Conditional normal distribution of the samples in a gap, given the samples around it.

    With m samples in the gap and k known neighbours, a draw is `weights @ neighbours + scatter @ n`
    with m independent standard normal numbers n.
    """

    weights: Array
    """(m, k) factors of the neighbours in the conditional mean"""
    scatter: Array
    """(m, m) square root of the conditional covariance, in the unit of the samples"""


def filled(column: Array, there: NDArray[np.bool_]) -> Array:
    """Return a recorded column, (n,), with its missing samples replaced by random values.

    They are drawn from the normal distribution conditional on the neighbouring samples, with the
    correlations of the record itself (J.-P. Chilès and P. Delfiner, Geostatistics, 2012). This
    preserves variances and spectra on average, while a straight line would remove thermal motion.

    `there` (n,) is False for missing samples. Gaps must have at most `LONGEST` samples, and the
    first and the last sample must exist.
    """
    seed = zlib.crc32(column[there].tobytes())  # the same record is always filled in the same way
    places, mean = np.arange(len(column)), np.mean(column[there])
    values = np.interp(places, places[there], column[there] - mean)
    for _ in range(_PASSES):
        _draw(values, there, np.random.default_rng(seed))
    return values + mean


def _draw(values: Array, there: NDArray[np.bool_], normal: np.random.Generator) -> None:
    """Replace the missing samples of `values`, (n,), in place by random values.

    The covariance is computed from all of `values`, which must have the mean 0 and an initial value
    for each missing sample. Gaps are filled from left to right, and a filled gap counts as known
    for the next one. `there` (n,) is False for missing samples. `normal` generates the random
    numbers.
    """
    windows = sliding_window_view(values, 2 * _NEIGHBOURS + LONGEST)
    covariance = windows.T @ windows / len(windows)
    known, edges = there.copy(), np.flatnonzero(np.diff(there))
    rules: dict[tuple[bytes, int], _Rule] = {}
    for first, end in zip(edges[::2] + 1, edges[1::2] + 1, strict=True):
        around = slice(max(0, first - _NEIGHBOURS), end + _NEIGHBOURS)
        # gaps of the same length with the same known neighbours share one rule
        key = known[around].tobytes(), first - around.start
        if key not in rules:
            gap = np.arange(first, end) - around.start
            rules[key] = _rule(covariance, np.flatnonzero(known[around]), gap)
        rule = rules[key]
        scatter = rule.scatter @ normal.standard_normal(end - first)
        values[first:end] = rule.weights @ values[around][known[around]] + scatter
        known[first:end] = True


def _rule(covariance: Array, neighbours: NDArray[np.int64], gap: NDArray[np.int64]) -> _Rule:
    """Return the distribution of the samples in a gap conditional on its neighbours.

    `covariance` is the covariance of the samples in a window. `neighbours` and `gap` are the
    offsets of the known and of the missing samples in the window. Eigenvalues at the rounding level
    are excluded from the inverse, because neighbours in a smooth record are nearly dependent.
    """
    across = covariance[np.ix_(gap, neighbours)]
    sizes, directions = np.linalg.eigh(covariance[np.ix_(neighbours, neighbours)])
    sure = sizes > _ALIKE * sizes[-1]
    weights = across @ (directions[:, sure] / sizes[sure]) @ directions[:, sure].T
    sizes, directions = np.linalg.eigh(covariance[np.ix_(gap, gap)] - weights @ across.T)
    return _Rule(weights, directions * np.sqrt(np.maximum(sizes, 0.0)))
