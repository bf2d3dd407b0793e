"""Resistance of a body with a closed mesh, by a single layer of constant forces on its triangles.

The flow is the one of `rings`, u(x_0) = 1/(8 pi mu) int G f dS. The force f per area is constant on
each triangle, and at every centroid the velocity equals the one of the body.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.linalg import solve

from tweezer.values.arrays import Array
from tweezer.values.errors import SceneError

#: Most triangles of the finer division, whose system has three times as many unknowns
_LARGEST = 2560
#: Distance between centroids, in longest edges, within which a triangle is divided once more
_NEAR = 1.5
#: Points at which the velocity is computed at a time
_CHUNK = 64
#: Radon's rule of degree 5 on a triangle: barycentric coordinates and weights
_ROOT = math.sqrt(15)
_CORNERS = np.ones((3, 3)) - 3 * np.eye(3)
_RULE = np.concatenate([
    np.full((1, 3), 1 / 3), 1 / 3 - _CORNERS * (1 + _ROOT) / 21, 1 / 3 - _CORNERS * (1 - _ROOT) / 21
])  # fmt: skip
_WEIGHTS = np.repeat([9 / 40, (155 - _ROOT) / 1200, (155 + _ROOT) / 1200], [1, 3, 3])


def mesh_resistance(corners: Array, viscosity: float) -> tuple[Array, float]:
    """Return the resistance of a body with a closed mesh about the origin, and its relative error.

    The triangles are divided until there are `_LARGEST`. Results for the last two divisions are
    extrapolated. The error of flat parts decreases as the edges squared, and the one near edges as
    the edges, so a power of 4/3 is assumed.

    Parameters
    ----------
    corners : ndarray, shape (n, 3, 3)
        Corners of the triangles, m.
    viscosity : float
        Viscosity, Pa s.

    Returns
    -------
    matrix : ndarray, shape (6, 6)
        Resistance matrix.
    error : float
        Largest relative change of an element of the diagonal by the extrapolation.
    """
    if 2 * len(corners) > _LARGEST:
        raise SceneError(
            f"bead.file: the mesh has {len(corners)} triangles; the resistance is computed for at "
            f"most {_LARGEST // 2}; simplify the mesh"
        )
    unit = float(np.abs(corners).max())
    coarse = corners / unit
    while 16 * len(coarse) <= _LARGEST:
        coarse = _in_four(coarse)
    fine = _in_four(coarse) if 4 * len(coarse) <= _LARGEST else _in_two(coarse)
    ratio = len(fine) / len(coarse)
    found, first = _matrix(fine), _matrix(coarse)
    change = (found - first) / (ratio ** (2 / 3) - 1)
    matrix = found + change
    error = np.abs(np.diag(change) / np.diag(matrix)).max()
    scale = np.array([1.0, 1.0, 1.0, unit, unit, unit])
    return viscosity * unit * scale[:, None] * scale * matrix, float(error)


def _in_four(corners: Array) -> Array:
    """Return triangles divided at the middles of their edges."""
    a, b, c = np.moveaxis(corners, 1, 0)
    ab, bc, ca = (a + b) / 2, (b + c) / 2, (c + a) / 2
    parts = ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))
    return np.stack([np.stack(each, axis=1) for each in parts], axis=1).reshape(-1, 3, 3)


def _in_two(corners: Array) -> Array:
    """Return triangles divided at the middle of their longest edge."""
    first = _edges(corners).argmax(axis=1)
    order = (first[:, None] + np.arange(3)) % 3
    a, b, c = np.moveaxis(np.take_along_axis(corners, order[:, :, None], axis=1), 1, 0)
    middle = (a + b) / 2
    parts = np.stack([np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1)], axis=1)
    return parts.reshape(-1, 3, 3)


def _edges(corners: Array) -> Array:
    """Return the lengths of the edges of triangles, from each corner to the next, (n, 3)."""
    return np.asarray(np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2))


def _matrix(corners: Array) -> Array:
    """Return the resistance matrix about the origin for the viscosity 1."""
    centres = corners.mean(axis=1)
    moved = np.zeros((len(corners), 3, 6))
    moved[:, :, :3] = np.eye(3)
    moved[:, :, 3:] = np.moveaxis(np.cross(np.eye(3)[:, None], centres), 0, 2)
    motions = moved.reshape(-1, 6)
    forces = solve(_layer(corners), motions, overwrite_a=True, check_finite=False)
    found = 8 * math.pi * (motions * np.repeat(_areas(corners), 3)[:, None]).T @ forces
    return (found + found.T) / 2


def _areas(corners: Array) -> Array:
    """Return the areas of triangles."""
    a, b, c = np.moveaxis(corners, 1, 0)
    return np.asarray(np.linalg.norm(np.cross(b - a, c - a), axis=1)) / 2


def _layer(corners: Array) -> Array:
    """Return the integrals of G over all triangles at all centroids, (3 n, 3 n)."""
    count, centres, areas = len(corners), corners.mean(axis=1), _areas(corners)
    points = np.einsum("qk,nkd->nqd", _RULE, corners)
    weights = areas[:, None] * _WEIGHTS
    quarters = np.einsum("qk,nfkd->nfqd", _RULE, _in_four(corners).reshape(count, 4, 3, 3))
    finer = quarters.reshape(count, -1, 3)
    finer_weights = np.tile(weights / 4, 4)
    reach = _NEAR * _edges(corners).max(axis=1)
    found = np.empty((count, 3, count, 3))
    for start in range(0, count, _CHUNK):
        at = slice(start, start + _CHUNK)
        block = _stokeslets(centres[at, None, None] - points, weights)
        apart = np.linalg.norm(centres[at, None] - centres, axis=2)
        target, source = np.nonzero((apart < reach) & (apart > 0))
        block[target, source] = _stokeslets(
            centres[at][target][:, None] - finer[source], finer_weights[source]
        )
        found[at] = block.transpose(0, 2, 1, 3)
    each = np.arange(count)
    found[each, :, each, :] = _own(corners)
    return found.reshape(3 * count, 3 * count)


def _stokeslets(apart: Array, weights: Array) -> Array:
    """Return weighted sums of 1/R + X X^T/R^3 over the last axis but one of X, (..., 3, 3).

    Where R is 0, the terms have any finite value, because such sums are not used.
    """
    square = np.einsum("...i,...i->...", apart, apart)
    single = weights / np.sqrt(np.where(square > 0, square, 1.0))
    scaled = apart * np.sqrt(single / np.where(square > 0, square, 1.0))[..., None]
    found = np.swapaxes(scaled, -1, -2) @ scaled
    found[..., range(3), range(3)] += single.sum(axis=-1)[..., None]
    return found


def _own(corners: Array) -> Array:
    """Return the integrals of G over each triangle at its own centroid, (n, 3, 3).

    The triangle is divided into three, each with an edge and the centroid as its corners. In polar
    coordinates about the centroid R^2 G and dS leave an integral over the angle from the
    perpendicular to the edge, which has a closed form.
    """
    found = np.zeros((len(corners), 3, 3))
    apart = corners - corners.mean(axis=1, keepdims=True)
    for i in range(3):
        start, end = apart[:, i], apart[:, (i + 1) % 3]
        along = (end - start) / np.linalg.norm(end - start, axis=1, keepdims=True)
        first, last = (np.einsum("ni,ni->n", each, along) for each in (start, end))
        foot = start - first[:, None] * along
        height = np.linalg.norm(foot, axis=1)
        across = foot / height[:, None]
        secant = np.arcsinh(last / height) - np.arcsinh(first / height)
        low, high = np.arctan2(first, height), np.arctan2(last, height)
        sine, cosine = np.sin(high) - np.sin(low), np.cos(low) - np.cos(high)
        mixed = np.einsum("ni,nj->nij", across, along)
        found += (height * secant)[:, None, None] * np.eye(3)
        found += np.einsum("n,ni,nj->nij", height * sine, across, across)
        found += np.einsum("n,ni,nj->nij", height * (secant - sine), along, along)
        found += (height * cosine)[:, None, None] * (mixed + np.swapaxes(mixed, 1, 2))
    return found
