"""Surfaces of bodies that are not spheres, as triangles with normals, for drawing them."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tweezer.scene.choices import SHAPES, at
from tweezer.scene.meshes import triangles
from tweezer.scene.solids import about_centre
from tweezer.values.arrays import Array

#: Corners of a half circle from pole to pole, and of a circle about the axis
_ROWS, _COLUMNS = 25, 48
#: Largest angle between neighbouring faces that are drawn as one smooth surface, rad
_SMOOTH = math.radians(30)


class Surface(NamedTuple):
    """A closed surface in the body's frame, as triangles."""

    vertices: Array
    """(n, 3) m, from the centre of mass"""
    normals: Array
    """(n, 3) outward normals of length 1. Vertices at an edge of the body occur once for each side
    of the edge"""
    faces: NDArray[np.int64]
    """(m, 3) vertices of each triangle, anticlockwise as seen from outside"""


def surface_of(bead: Any) -> Surface | None:
    """Return the surface of the body of a bead; None for a sphere, and if it is not known."""
    place = SHAPES[bead.shape].surface
    return at(place)(bead) if place else None


def spheroid(bead: Any) -> Surface:
    """Return the surface of an ellipsoid of revolution about z."""
    return _ellipsoid((bead.radius, bead.radius, bead.length / 2))


def ellipsoid(bead: Any) -> Surface:
    """Return the surface of an ellipsoid."""
    return _ellipsoid(bead.semi_axes)


def cluster(bead: Any) -> Surface:
    """Return the surfaces of all spheres of a cluster."""
    each = [_ellipsoid(3 * (sphere.radius,)) for sphere in bead.spheres]
    counts = np.cumsum([0, *(len(one.vertices) for one in each)])
    return Surface(
        np.concatenate([one.vertices + at for one, at in zip(each, bead.centres, strict=True)]),
        np.concatenate([one.normals for one in each]),
        np.concatenate([one.faces + first for one, first in zip(each, counts, strict=False)]),
    )


def cylinder(bead: Any) -> Surface:
    """Return the surface of a cylinder about z."""
    a, half = bead.radius, bead.length / 2
    return _revolved(np.array([(0.0, -half), (a, -half), (a, half), (0.0, half)]))


def capsule(bead: Any) -> Surface:
    """Return the surface of a cylinder about z with half spheres at its ends."""
    a, half = bead.radius, bead.length / 2 - bead.radius
    circle = a * _half_circle()
    up = np.array([0.0, half])
    return _revolved(np.concatenate([circle[: _ROWS // 2 + 1] - up, circle[_ROWS // 2 :] + up]))


def profile(bead: Any) -> Surface:
    """Return the surface of a body of revolution about z."""
    points = about_centre(bead.points)
    return _revolved(points if points[-1, 1] > points[0, 1] else points[::-1])


def mesh(bead: Any) -> Surface:
    """Return the surface of a mesh, smooth except at its edges."""
    corners = triangles(bead.file, bead.scale)
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    flat = _unit(across)
    _, vertex = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    around: dict[int, list[int]] = {}
    for corner, number in enumerate(vertex.reshape(-1)):
        around.setdefault(int(number), []).append(corner // 3)
    normals = np.empty((len(vertex.reshape(-1)), 3))
    for corner, number in enumerate(vertex.reshape(-1)):
        near = np.array(around[int(number)])
        alike = near[flat[near] @ flat[corner // 3] > math.cos(_SMOOTH)]
        normals[corner] = across[alike].sum(axis=0)
    faces = np.arange(3 * len(corners)).reshape(-1, 3)
    return Surface(corners.reshape(-1, 3), _unit(normals), faces)


def _ellipsoid(semi_axes: tuple[float, ...]) -> Surface:
    """Return the surface of an ellipsoid with semi-axes along x, y and z, m."""
    found = _revolved(_half_circle())
    return Surface(
        found.vertices * semi_axes, _unit(found.vertices / np.array(semi_axes)), found.faces
    )


def _half_circle() -> Array:
    """Return points of a half circle of radius 1 about the origin, (rows, 2), from below."""
    angle = np.linspace(0.0, math.pi, _ROWS)
    points = np.stack([np.sin(angle), -np.cos(angle)], axis=1)
    points[[0, -1], 0] = 0.0
    return points


def _revolved(points: Array) -> Surface:
    """Return the surface of revolution about z of a profile (n, 2), m, from below to above.

    Every part of the profile has its own vertices, and neighbouring parts share their normals
    unless there is an edge between them.
    """
    step = np.diff(points, axis=0)
    flat = _unit(np.stack([step[:, 1], -step[:, 0]], axis=1))
    smooth = (flat[1:] * flat[:-1]).sum(axis=1, keepdims=True) > math.cos(_SMOOTH)
    shared = _unit(flat[1:] + flat[:-1])
    ends = np.stack([flat, flat], axis=1)  # (part, end, 2)
    ends[1:, 0] = np.where(smooth, shared, flat[1:])
    ends[:-1, 1] = np.where(smooth, shared, flat[:-1])
    around = np.linspace(0.0, 2 * math.pi, _COLUMNS + 1)
    turn = np.stack([np.cos(around), np.sin(around)], axis=1)
    corners = np.stack([points[:-1], points[1:]], axis=1)

    def turned(rows: Array) -> Array:
        """Return radius and height (part, end, 2) all around, (part * end * columns, 3)."""
        across = rows[:, :, None, :1] * turn
        along = np.broadcast_to(rows[:, :, None, 1:], (*across.shape[:3], 1))
        return np.concatenate([across, along], axis=-1).reshape(-1, 3)

    below = np.arange(_COLUMNS)
    one = np.concatenate([
        np.stack([below, below + 1, below + _COLUMNS + 2], axis=1),
        np.stack([below, below + _COLUMNS + 2, below + _COLUMNS + 1], axis=1),
    ])  # fmt: skip
    first = 2 * (_COLUMNS + 1) * np.arange(len(step))
    faces = (one + first[:, None, None]).reshape(-1, 3)
    vertices = turned(corners)
    sides = vertices[faces]
    area = np.linalg.norm(np.cross(sides[:, 1] - sides[:, 0], sides[:, 2] - sides[:, 0]), axis=1)
    return Surface(vertices, turned(ends), faces[area > 1e-12 * area.max()])


def _unit(vectors: Array) -> Array:
    """Return vectors (..., n) with length 1."""
    length: Array = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return vectors / length
