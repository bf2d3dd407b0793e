"""Rotation on the page of an ensemble: orientation of the first body, and alignment of all."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from tweezer.values.arrays import Array
from tweezer.viewing.arrays import Packed, float32

if TYPE_CHECKING:
    import xarray as xr

#: Number of orientations read at a time
_READ = 500_000


def orientations(
    dataset: xr.Dataset, numbers: NDArray[np.int64], kept: NDArray[np.int64], axis: int
) -> dict[str, Packed]:
    """Return the arrays of an ensemble's page that show how its bodies turn, by name.

    * orientation: Euler parameters of the first body, (times, 4)
    * alignment: mean squared direction cosines of a body axis, (times, 3). Lost bodies do not
      count. Each mean is 1/3 if all directions are equally likely.
    * alignment_error: their standard errors

    Parameters
    ----------
    dataset : Dataset
        The ensemble.
    numbers : ndarray, shape (n,)
        Numbers of its trajectories that were computed.
    kept : ndarray, shape (times,)
        Numbers of the times that are shown.
    axis : int
        Axis of the body, 0 to 2.
    """
    found, of = dataset["orientation"], np.eye(3)[axis]
    sums = np.zeros((3, kept.size, 3))  # number, squares and their squares
    at_once = max(1, _READ // dataset.sizes["time"])
    for first in range(0, numbers.size, at_once):
        some = numbers[first : first + at_once]
        block = found[some[0] : some[-1] + 1].values[some - some[0]][:, kept]
        there = np.isfinite(block).all(axis=2)
        squares = np.zeros((*there.shape, 3))
        squares[there] = Rotation.from_quat(block[there], scalar_first=True).apply(of) ** 2
        sums += [np.repeat(there.sum(axis=0)[:, None], 3, 1), squares.sum(0), (squares**2).sum(0)]
    mean, error = _mean_with_error(*sums)
    return {
        "orientation": float32(found[numbers[0]].values[kept], "1"),
        "alignment": float32(mean, "1"),
        "alignment_error": float32(error, "1"),
    }


def _mean_with_error(count: Array, total: Array, squares: Array) -> tuple[Array, Array]:
    """Return the mean and its standard error from a number of values and two sums, like `count`."""
    with np.errstate(divide="ignore", invalid="ignore"):
        mean = total / count
        variance = np.maximum(squares / count - mean**2, 0.0) / (count - 1)
    return mean, np.sqrt(variance)
