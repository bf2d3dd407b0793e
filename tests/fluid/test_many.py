"""Mobility of many spheres against Lamb's solution, the exact pair, symmetries, definiteness."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import tweezer
from tests.reference import clusters, spheres
from tweezer.fluid.many import many_mobility

#: viscosity with which mobilities are over 1/(6 pi mu)
UNIT = 1 / (6 * math.pi)


def in_contact(gap, radii):
    """Centres of three spheres with the same gap between all of them."""
    a, b, c = radii
    first, second, third = a + b + gap, a + c + gap, b + c + gap
    x = (first**2 + second**2 - third**2) / (2 * first)
    return np.array([[0, 0, 0], [first, 0, 0], [x, math.sqrt(second**2 - x**2), 0]])


def modes(found, known):
    """Relative errors of the modes of motion, between two mobilities."""
    return np.linalg.eigvals(np.linalg.solve(known, found)).real - 1


def test_two_spheres_are_exact():
    """Along a random line, with the signs of rotation."""
    line = Rotation.random(rng=np.random.default_rng(2)).apply([0, 0, 1])
    found = many_mobility(np.array([0 * line, 2.0 * line]), np.array([1.0, 0.4]), UNIT)
    m = {name: float(value) for name, value in tweezer.pair_mobilities(1, 0.4, 0.6).items()}
    force = np.array([0.3, -1.0, 0.7])
    along, cross = line * (line @ force), np.cross(line, force)
    velocity = found.matrix[:, 3:6] @ force  # by a force on the second sphere
    across = force - along
    expected = [
        m["x12"] * along + m["y12"] * across, m["x22"] * along + m["y22"] * across,
        m["tr12"] * cross, -m["tr22"] * cross,
    ]  # fmt: skip
    np.testing.assert_allclose(velocity, np.concatenate(expected), atol=1e-8)
    velocity = found.matrix[:, 9:] @ force  # by a torque on it
    expected = [
        m["tr21"] * np.cross(force, -line), m["tr22"] * np.cross(force, -line),
        m["rrx12"] * along + m["rry12"] * across, m["rrx22"] * along + m["rry22"] * across,
    ]  # fmt: skip
    np.testing.assert_allclose(velocity, np.concatenate(expected), atol=1e-7)
    assert found.error < 1e-8


@pytest.mark.parametrize(
    ("gap", "degree", "bound", "falling"),
    [(0.2, 11, 0.15, 0.03), (0.5, 9, 0.07, 0.02), (1.0, 7, 0.02, 0.012)],
)
def test_triangle_of_equal_spheres(gap, degree, bound, falling):
    """Every mode of translation, and sedimentation, which is more accurate."""
    centres, radii = in_contact(gap, (1, 1, 1)), np.ones(3)
    known = spheres.mobility(centres, radii, degree)[:9, :9]
    found = many_mobility(centres, radii, UNIT)
    assert np.abs(modes(found.matrix[:9, :9], known)).max() < min(bound, found.error)
    together = np.tile(np.eye(3), (3, 1))
    off = (found.matrix[:9, :9] - known) @ together
    assert np.abs(off).max() < falling * np.abs(known @ together).max()


@pytest.mark.parametrize("radii", [(1.0, 0.5, 1.0), (1.0, 0.5, 0.5)])
def test_error_contains_unequal_triangles_and_chains(radii):
    gap = 1.0
    a, b, c = radii
    row = np.array([[0, 0, 0], [a + b + gap, 0, 0], [a + 2 * b + c + 2 * gap, 0, 0]])
    for centres in (row, in_contact(gap, radii)):
        known = spheres.mobility(centres, radii, 7)[:9, :9]
        found = many_mobility(centres, np.array(radii), UNIT)
        assert np.abs(modes(found.matrix[:9, :9], known)).max() < found.error


def test_far_spheres_are_those_of_rotne_and_prager():
    """Four spheres at distances of some 40 radii, against Lamb's solution."""
    centres = np.array([[0, 0, 0], [40, 0, 10], [5, 45, 0], [30, -20, 35.0]])
    radii = np.array([1.0, 1.0, 0.5, 0.25])
    known = spheres.mobility(centres, radii, 3)
    found = many_mobility(centres, radii, UNIT)
    np.testing.assert_allclose(found.matrix, known, atol=1e-5)
    assert found.error < 1e-4


def test_order_and_axes_do_not_matter():
    rng = np.random.default_rng(5)
    centres, radii = clusters.cluster(rng, [1.0, 0.5, 1.0, 0.25])
    found = many_mobility(centres, radii, UNIT).matrix
    np.testing.assert_array_equal(found, found.T)
    order, turn = np.array([2, 0, 3, 1]), Rotation.random(rng=rng)
    again = many_mobility(turn.apply(centres)[order] + 7, radii[order], UNIT).matrix
    rows = np.concatenate(
        [3 * order[:, None] + np.arange(3), 12 + 3 * order[:, None] + np.arange(3)]
    )
    whole = np.kron(np.eye(8), turn.as_matrix())
    expected = (whole @ found @ whole.T)[np.ix_(rows.ravel(), rows.ravel())]
    np.testing.assert_allclose(again, expected, rtol=1e-7, atol=1e-6)


def test_mobility_of_random_clusters_is_positive():
    """`python -m tests.reference.clusters` tries 1,000."""
    rng = np.random.default_rng(11)
    assert min(clusters.smallest_eigenvalue(rng) for _ in range(25)) > 0.1


def test_units():
    """In SI: one sphere has Stokes's mobilities."""
    found = many_mobility(np.zeros((1, 3)), np.array([1e-6]), 1e-3)
    stokes = [1 / (6e-9 * math.pi)] * 3 + [1 / (8e-21 * math.pi)] * 3
    np.testing.assert_allclose(found.matrix, np.diag(stokes), rtol=1e-12)
    assert found.error == 0


def test_overlap_is_refused():
    with pytest.raises(tweezer.SceneError, match=r"^spheres 1 and 3: overlap by 1e-07 m; "):
        many_mobility(np.array([[0, 0, 0], [9e-6, 0, 0], [0, 1.9e-6, 0]]), np.full(3, 1e-6), 1e-3)
