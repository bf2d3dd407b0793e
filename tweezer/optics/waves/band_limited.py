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
_ERROR = 1e-10
#: Number of positions at which products are computed together
_TOGETHER = 4096
#: Number of positions at which the function itself is computed together
_DIRECT = 256

Function = Callable[[Array], Array]


class InBox:
    """A band-limited function of the position in a box, interpolated in Chebyshev polynomials.

    Parameters
    ----------
    function : callable
        Function of positions (m, 3), m, with f numbers for each.
    low, high : ndarray, shape (3,)
        Corners of the box, m.
    band : ndarray, shape (3,)
        Largest wavenumber along each axis, 1/m.
    """

    def __init__(self, function: Function, low: Array, high: Array, band: Array) -> None:
        self._middle, half = (high + low) / 2, (high - low) / 2
        self._half = np.where(half > 0, half, 1.0)
        counts = counts_of(half, band)
        axes = [np.cos(math.pi * (np.arange(n) + 0.5) / n) for n in counts]
        grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
        series = function(self._middle + half * grid).reshape(*counts, -1)
        for axis, (n, at) in enumerate(zip(counts, axes, strict=True)):
            weights = 2 / n * _polynomials(at, n)[0].T
            weights[0] /= 2
            series = np.moveaxis(np.tensordot(weights, series, axes=(1, axis)), 0, axis)
        self._series = series

    def at(self, positions: Array) -> Array:
        """Return the function at positions (n, 3), m: (n, f)."""
        return np.concatenate([
            self._product([values for values, _ in self._of_axes(part)])
            for part in _parts(positions)
        ])  # fmt: skip

    def with_slopes(self, positions: Array) -> tuple[Array, Array]:
        """Return the function at positions (n, 3), m, (n, f), and its gradient (n, f, 3)."""
        found, slopes = [], []
        for part in _parts(positions):
            axes = self._of_axes(part)
            values = [each for each, _ in axes]
            found.append(self._product(values))
            changed = [
                self._product([*values[:axis], slope / self._half[axis], *values[axis + 1 :]])
                for axis, (_, slope) in enumerate(axes)
            ]
            slopes.append(np.stack(changed, axis=-1))
        return np.concatenate(found), np.concatenate(slopes)

    def _of_axes(self, positions: Array) -> list[tuple[Array, Array]]:
        """Return the polynomials and their slopes along each axis."""
        x = (positions - self._middle) / self._half
        return [_polynomials(x[:, i], n) for i, n in enumerate(self._series.shape[:3])]

    def _product(self, of_axes: list[Array]) -> Array:
        """Return the series with numbers for the polynomials of each axis, (n, count): (n, f)."""
        of_x, of_y, of_z = of_axes
        a, b, c, f = self._series.shape
        planes = (of_x @ self._series.reshape(a, -1)).reshape(len(of_x), b, c * f)
        lines = np.matmul(of_y[:, None], planes).reshape(len(of_x), c, f)
        return np.matmul(of_z[:, None], lines)[:, 0]


def at_many(function: Function, positions: Array, band: Array) -> Array:
    """Return a band-limited function at positions (n, 3), m: (n, f) numbers.

    It is called at the nodes of a box around the positions, of boxes around parts of them, or at
    the positions themselves if these are fewer.

    Parameters
    ----------
    function : callable
        Function of positions (m, 3), m, with f numbers for each.
    positions : ndarray, shape (n, 3)
        Positions, m.
    band : ndarray, shape (3,)
        Largest wavenumber along each axis, 1/m.
    """
    if not len(positions):
        return function(positions)
    low, high = positions.min(axis=0), positions.max(axis=0)
    if math.prod(counts_of((high - low) / 2, band)) < len(positions):
        return InBox(function, low, high, band).at(positions)
    if len(positions) <= _DIRECT:
        return function(positions)
    parts = np.array_split(positions, 2)
    return np.concatenate([at_many(function, part, band) for part in parts])


def counts_of(half: Array, band: Array) -> list[int]:
    """Return the number of nodes along each axis of a box with half-widths (3,), m."""
    return [_nodes(float(each)) for each in band * half]


def _nodes(phase: float) -> int:
    """Return the number of nodes for a phase B h, rad."""
    n, error = 1, phase
    while 2 * error > _ERROR:
        n += 1
        error *= phase / (2 * n)
    return n


def _polynomials(x: Array, count: int) -> tuple[Array, Array]:
    """Return the Chebyshev polynomials T_0 to T_(count - 1) at x (n,), and slopes, (n, count)."""
    values, slopes = np.ones((2, len(x), count))
    slopes[:, 0] = 0.0
    if count > 1:
        values[:, 1] = x
    second = np.stack([np.ones_like(x), 2 * x])  # U_(k-1) and U_k
    for k in range(2, count):
        values[:, k] = 2 * x * values[:, k - 1] - values[:, k - 2]
        slopes[:, k] = k * second[1]
        second = np.stack([second[1], 2 * x * second[1] - second[0]])
    return values, slopes


def _parts(positions: Array) -> list[Array]:
    """Return positions in parts that are computed together."""
    return np.array_split(positions, max(1, -(-len(positions) // _TOGETHER)))
