"""Resistance by rings and by triangles, against ellipsoids, rows of spheres and limits."""

import itertools
import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tweezer.fluid.resistance import triangles
from tweezer.fluid.resistance.ellipsoid import ellipsoid_resistance
from tweezer.fluid.resistance.resistance import Resistance
from tweezer.fluid.resistance.rings import arc, line, revolved_resistance
from tweezer.fluid.resistance.row import row_resistance
from tweezer.fluid.resistance.triangles import mesh_resistance


def ellipse(across, along):
    """Generating curve of a spheroid."""
    return [arc(0.0, (across, along), 0.0, math.pi)]


def cylinder(half, radius=1.0):
    corners = [(0, half), (radius, half), (radius, -half), (0, -half)]
    return [line(a, b) for a, b in itertools.pairwise(corners)]


def globe(divisions, axes=(1, 1, 1)):
    """Triangles of an icosahedron, divided by four and moved to an ellipsoid."""
    g = (1 + math.sqrt(5)) / 2
    vertices = [(s, t * g, 0) for s in (1, -1) for t in (1, -1)]
    vertices = np.array([np.roll(each, i) for i in range(3) for each in vertices], float)
    apart = np.linalg.norm(vertices[:, None] - vertices, axis=2)
    near = (apart > 0) & (apart < 2.1)
    faces = [
        (i, j, k) for i in range(12) for j in range(i) for k in range(j)
        if near[i, j] and near[j, k] and near[i, k]
    ]  # fmt: skip
    corners = vertices[np.array(faces)]
    corners /= np.linalg.norm(corners, axis=2, keepdims=True)
    for _ in range(divisions):
        a, b, c = np.moveaxis(corners, 1, 0)
        p, q, r = (each / np.linalg.norm(each, axis=1, keepdims=True)
                   for each in (a + b, b + c, c + a))  # fmt: skip
        parts = [(a, p, r), (p, b, q), (r, q, c), (p, q, r)]
        corners = np.concatenate([np.stack(each, axis=1) for each in parts])
    return corners * np.array(axes)


# --- rings ------------------------------------------------------------------------------------


@pytest.mark.parametrize(("across", "along"), [(1, 1), (1, 3), (1, 0.2)])
def test_rings_of_a_spheroid(across, along):
    found, error = revolved_resistance(ellipse(across, along), 2.0)
    expected = ellipsoid_resistance((across, across, along), 2.0)
    np.testing.assert_allclose(np.diag(found), np.diag(expected), rtol=1e-8)
    np.testing.assert_allclose(found, expected, rtol=1e-8, atol=1e-9)
    assert error < 1e-5


#: L/2a: drag along and across, and about an axis across and about the axis, over mu a and mu a^3
CYLINDERS = {
    0.1: (16.8196, 12.7151, 12.5418, 14.7395),
    1.0: (22.63428, 22.82133, 48.70747, 39.84457),
}


@pytest.mark.parametrize("ratio", CYLINDERS)
def test_cylinder_has_the_published_drag(ratio):
    found, error = revolved_resistance(cylinder(2 * ratio, 2.0), 1.0)
    over = np.diag(found)[[2, 0, 3, 5]] / [2, 2, 8, 8]
    np.testing.assert_allclose(over, CYLINDERS[ratio], rtol=6e-6)
    assert error < 1e-5


def test_thin_cylinder_drags_as_a_disc():
    """The limits are 16 broadside and 32/3 otherwise; the edge adds a few times its height."""
    found, _ = revolved_resistance(cylinder(1e-4), 1.0)
    limits = np.array([32 / 3, 32 / 3, 16, 32 / 3, 32 / 3, 32 / 3])
    over = np.diag(found) / limits - 1
    assert (over > 0).all()
    assert (over < 1.2e-3).all()


def test_body_drags_more_than_a_body_inside():
    half, a = 1.5, 1.0
    capsule = [arc(half, (a, a), 0, math.pi / 2), line((a, half), (a, -half)),
               arc(-half, (a, a), math.pi / 2, math.pi)]  # fmt: skip
    inner = ellipsoid_resistance((a, a, half + a), 1.0)
    middle, _ = revolved_resistance(capsule, 1.0)
    outer, _ = revolved_resistance(cylinder(half + a), 1.0)
    assert (np.diag(inner) < np.diag(middle)).all()
    assert (np.diag(middle) < np.diag(outer)).all()


def test_two_unequal_spheres_by_rings_and_by_multipoles():
    """The two methods share nothing; the pair couples translation and rotation."""
    arcs = [arc(0.4, (1, 1), 0, math.pi), arc(-1.5, (0.5, 0.5), 0, math.pi)]
    found, _ = revolved_resistance(arcs, 1.0)
    expected, _ = row_resistance(np.array([0.4, -1.5]), np.array([1.0, 0.5]), 1.0)
    assert abs(expected[0, 4]) > 1
    np.testing.assert_allclose(found, expected, rtol=1e-7, atol=1e-7)


def test_cone_about_another_point():
    """A body without symmetry of up and down, about two origins and back."""
    low = [line((0, 1.0), (1.0, 0.0)), line((1.0, 0.0), (0, 0))]
    high = [line((0, 1.7), (1.0, 0.7)), line((1.0, 0.7), (0, 0.7))]
    one, other = (revolved_resistance(each, 1.0)[0] for each in (low, high))
    moved = Resistance(other, 300.0, 0.0, "").at(np.array([0, 0, 0.7]))
    np.testing.assert_allclose(moved.matrix, one, atol=2e-5)
    np.testing.assert_allclose(moved.at(np.array([0, 0, -0.7])).matrix, other, atol=1e-12)


# --- triangles --------------------------------------------------------------------------------


@pytest.mark.parametrize("axes", [(1, 1, 1), (1, 1.5, 3)])
def test_triangles_of_an_ellipsoid(axes, monkeypatch):
    """An inscribed mesh drags less; enlarged to the true volume it drags as the ellipsoid."""
    monkeypatch.setattr(triangles, "_LARGEST", 1280)
    corners = globe(2, axes)
    volume = abs(np.linalg.det(corners)).sum() / 6
    size = (4 / 3 * math.pi * math.prod(axes) / volume) ** (1 / 3)
    smaller, error = mesh_resistance(corners, 1.0)
    expected = ellipsoid_resistance(axes, 1.0)
    assert (np.diag(smaller) < np.diag(expected)).all()
    scale = np.repeat([size, size**3], 3)
    found = np.diag(smaller) * scale
    assert error < 5e-3
    np.testing.assert_allclose(found, np.diag(expected), rtol=3e-3 if len(set(axes)) == 1 else 1e-2)


def test_triangles_of_a_turned_and_moved_body(monkeypatch):
    monkeypatch.setattr(triangles, "_LARGEST", 400)
    corners = globe(1, (1, 1.5, 2.5))
    turn = Rotation.from_rotvec([0.3, -1.0, 0.6])
    shift = np.array([0.5, 0.2, -0.4])
    here, _ = mesh_resistance(corners, 1.0)
    there, _ = mesh_resistance(turn.apply(corners.reshape(-1, 3)).reshape(-1, 3, 3) + shift, 1.0)
    frame = np.kron(np.eye(2), turn.as_matrix())
    back = Resistance(there, 300.0, 0.0, "").at(shift).matrix
    np.testing.assert_allclose(frame.T @ back @ frame, here, atol=1e-3 * here.max())


def test_cylinder_by_triangles_and_by_rings(monkeypatch):
    """The prism of 16 sides is taken with the drag of the cylinder of its volume."""
    monkeypatch.setattr(triangles, "_LARGEST", 1024)
    sides, half = 16, 1.0
    angle = 2 * np.pi * np.arange(sides + 1) / sides
    ring = np.stack([np.cos(angle), np.sin(angle), np.full_like(angle, half)], axis=1)
    top, bottom = ring, ring * [1, 1, -1]
    faces = []
    for i in range(sides):
        a, b, c, d = top[i], top[i + 1], bottom[i], bottom[i + 1]
        faces += [(c, d, a), (d, b, a), (a, b, (0, 0, half)), (d, c, (0, 0, -half))]
    corners = np.array(faces, float)
    radius = math.sqrt(abs(np.linalg.det(corners)).sum() / 6 / (2 * math.pi * half))
    found, error = mesh_resistance(corners, 1.0)
    expected, _ = revolved_resistance(cylinder(half, radius), 1.0)
    assert error < 3e-2
    np.testing.assert_allclose(np.diag(found), np.diag(expected), rtol=error)
