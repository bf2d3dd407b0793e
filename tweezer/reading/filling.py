"""Samples that are missing, drawn from what their neighbours tell of them."""

from __future__ import annotations

import zlib
from typing import NamedTuple

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from tweezer.reading.table import Array

#: Largest number of missing samples in a row that are filled in
LONGEST = 10
#: Number of samples on either side of a gap that tell of it
_NEIGHBOURS = 4
#: Eigenvalue over the largest, below which neighbours tell nothing more
_ALIKE = 1e-12
#: Number of times that the correlations are taken of the record as it is filled in
_PASSES = 3


class _Rule(NamedTuple):
    """How the samples of a gap follow from those around it."""

    weights: Array
    """(gap, neighbours), of the mean"""
    scatter: Array
    """(gap, gap): with independent normal numbers, what is about the mean"""


def filled(column: Array, there: NDArray[np.bool_]) -> Array:
    """The column with a draw for each sample that is not there.

    The draws are of the normal distribution that the samples around leave, with the correlations of
    the record itself (simulation conditional on neighbours: J.-P. Chilès and P. Delfiner,
    Geostatistics, 2012). So variances and spectra stay as they are on average, where a straight
    line would take thermal motion away.

    Gaps are of at most `LONGEST` samples, and the first and the last sample are there.
    """
    seed = zlib.crc32(column[there].tobytes())  # the same record is filled in the same way
    places, mean = np.arange(len(column)), np.mean(column[there])
    values = np.interp(places, places[there], column[there] - mean)
    for _ in range(_PASSES):
        _draw(values, there, np.random.default_rng(seed))
    return values + mean


def _draw(values: Array, there: NDArray[np.bool_], normal: np.random.Generator) -> None:
    """Draw the values that are not there, by the correlations of all."""
    windows = sliding_window_view(values, 2 * _NEIGHBOURS + LONGEST)
    covariance = windows.T @ windows / len(windows)
    known, edges = there.copy(), np.flatnonzero(np.diff(there))
    rules: dict[tuple[bytes, int], _Rule] = {}
    for first, end in zip(edges[::2] + 1, edges[1::2] + 1, strict=True):
        around = slice(max(0, first - _NEIGHBOURS), end + _NEIGHBOURS)
        key = known[around].tobytes(), first - around.start
        if key not in rules:
            gap = np.arange(first, end) - around.start
            rules[key] = _rule(covariance, np.flatnonzero(known[around]), gap)
        rule = rules[key]
        scatter = rule.scatter @ normal.standard_normal(end - first)
        values[first:end] = rule.weights @ values[around][known[around]] + scatter
        known[first:end] = True


def _rule(covariance: Array, neighbours: NDArray[np.int64], gap: NDArray[np.int64]) -> _Rule:
    across = covariance[np.ix_(gap, neighbours)]
    sizes, directions = np.linalg.eigh(covariance[np.ix_(neighbours, neighbours)])
    sure = sizes > _ALIKE * sizes[-1]
    weights = across @ (directions[:, sure] / sizes[sure]) @ directions[:, sure].T
    sizes, directions = np.linalg.eigh(covariance[np.ix_(gap, gap)] - weights @ across.T)
    return _Rule(weights, directions * np.sqrt(np.maximum(sizes, 0.0)))
