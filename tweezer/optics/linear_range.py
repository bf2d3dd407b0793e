"""Displacement at which a signal or a force is no longer linear."""

from __future__ import annotations

import numpy as np

from tweezer.values.arrays import Array

#: Deviation from a linear function at which the linear range ends
NONLINEAR = 0.05


def linear_range(deviation: Array, distances: Array) -> float:
    """Return the distance at which a deviation first exceeds `NONLINEAR`, by interpolation.

    Parameters
    ----------
    deviation : ndarray, shape (n,)
        Relative deviations.
    distances : ndarray, shape (n,)
        Their distances, ascending.

    Returns
    -------
    float
        The distance; the last one if the deviation stays smaller.
    """
    beyond = np.flatnonzero(deviation > NONLINEAR)
    if not beyond.size:
        return float(distances[-1])
    at = max(int(beyond[0]), 1)
    return float(np.interp(NONLINEAR, deviation[at - 1 : at + 1], distances[at - 1 : at + 1]))
