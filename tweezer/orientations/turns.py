"""Turns between orientations and directions of a body's axis, from Euler parameters.

Euler parameters e = (e0, e1, e2, e3), scalar first, rotate components in the body's frame to those
in the laboratory. Arrays have any leading dimensions, and NaN remain NaN.
"""

from __future__ import annotations

import numpy as np

from tweezer.values.arrays import Array


def in_laboratory(orientation: Array, vector: Array) -> Array:
    """Return a vector (..., 3) in laboratory axes (A.2).

    `orientation` (..., 4) are Euler parameters of length 1, and `vector` (..., 3) has components in
    the body's frame.
    """
    scalar, axis = orientation[..., :1], orientation[..., 1:]
    twice = 2 * np.cross(axis, vector)
    return np.asarray(vector + scalar * twice + np.cross(axis, twice))


def turns(orientation: Array) -> Array:
    """Return the rotation vectors (..., n - 1, 3), rad, between successive orientations.

    `orientation` (..., n, 4) are Euler parameters of length 1. Each vector is log(R_k^T R_{k+1}),
    the shortest turn. Its components are the same in the body's frame at both times.
    """
    before, after = orientation[..., :-1, :], orientation[..., 1:, :]
    scalar = np.sum(before * after, axis=-1, keepdims=True)
    b0, b, a0, a = before[..., :1], before[..., 1:], after[..., :1], after[..., 1:]
    vector = (b0 * a - a0 * b - np.cross(b, a)) * np.where(scalar < 0, -1.0, 1.0)
    sine = np.linalg.norm(vector, axis=-1, keepdims=True)
    angle = 2 * np.arctan2(sine, np.abs(scalar))
    return np.asarray(vector * np.divide(angle, sine, out=np.full_like(sine, 2), where=sine > 0))
