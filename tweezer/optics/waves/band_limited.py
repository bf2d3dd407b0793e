"""Band-limited functions of the position at many positions, by Chebyshev interpolation in a box.

A function without wavenumbers above B, sampled at n Chebyshev nodes on an interval of half-width h,
is interpolated with an error of at most 2 (B h/2)^n/n! of its largest value (Bernstein).
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from tweezer.values.arrays import Array

#: Error of the interpolation along each axis, as a part of the function's largest value
_ERROR = 1e-12
#: Number of positions at which products are computed together, and the function itself
_TOGETHER, _TOGETHER_DIRECT = 4096, 256


def at_many(function: Callable[[Array], Array], positions: Array, band: Array) -> Array:
    """Return a band-limited function at positions (n, 3), m: (n, f) numbers.

    Parameters
    ----------
    function : callable
        Function of positions (m, 3), with f numbers for each. It is called at the nodes of a box
        around the positions, of boxes around parts of them, or at the positions themselves if
        these are fewer.
    positions : ndarray, shape (n, 3)
        Positions, m.
    band : ndarray, shape (3,)
        Largest wavenumber along each axis, 1/m.
    """
    if not len(positions):
        return function(positions)
    low, high = positions.min(axis=0), positions.max(axis=0)
    half, middle = (high - low) / 2, (high + low) / 2
    counts = [_nodes(float(each)) for each in band * half]
    if math.prod(counts) >= len(positions):
        if len(positions) <= _TOGETHER_DIRECT:
            return function(positions)
        parts = np.array_split(positions, 2)
        return np.concatenate([at_many(function, part, band) for part in parts])
    axes = [np.cos(math.pi * (np.arange(n) + 0.5) / n) for n in counts]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    series = function(middle + half * grid).reshape(*counts, -1)
    for axis, (n, at) in enumerate(zip(counts, axes, strict=True)):
        weights = 2 / n * _polynomials(at, n)
        weights[:, 0] /= 2
        series = np.moveaxis(np.tensordot(weights, series, axes=(0, axis)), 0, axis)
    width = np.where(half > 0, half, 1.0)
    return np.concatenate([
        _evaluated(series, (positions[first : first + _TOGETHER] - middle) / width)
        for first in range(0, len(positions), _TOGETHER)
    ])  # fmt: skip


def _nodes(phase: float) -> int:
    """Return the number of nodes for a phase B h, rad."""
    n, error = 1, phase
    while 2 * error > _ERROR:
        n += 1
        error *= phase / (2 * n)
    return n


def _polynomials(x: Array, count: int) -> Array:
    """Return the Chebyshev polynomials T_0 to T_(count - 1) at x (n,), (n, count)."""
    return np.asarray(np.cos(np.arange(count) * np.arccos(np.clip(x, -1, 1))[:, None]))


def _evaluated(series: Array, x: Array) -> Array:
    """Return a series (a, b, c, f) of products of Chebyshev polynomials at x (n, 3): (n, f)."""
    a, b, c, f = series.shape
    of_x, of_y, of_z = (_polynomials(x[:, i], n) for i, n in enumerate((a, b, c)))
    planes = (of_x @ series.reshape(a, -1)).reshape(len(x), b, c * f)
    lines = np.matmul(of_y[:, None], planes).reshape(len(x), c, f)
    return np.matmul(of_z[:, None], lines)[:, 0]
