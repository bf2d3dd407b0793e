"""Wigner functions against SymPy, and rotations of fields."""

import numpy as np
import pytest
from sympy.physics.quantum.spin import Rotation

from tweezer.optics.bodies.rotation import (
    euler_angles,
    rotation_blocks,
    rotation_matrix,
    wigner_d,
    wigner_delta,
)
from tweezer.optics.waves.harmonics import harmonics


def about(axis, angle):
    """Rotation matrix by Rodrigues's formula."""
    x, y, z = np.asarray(axis) / np.linalg.norm(axis)
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K


def turned_by(alpha, beta, gamma):
    return about((0, 0, 1), alpha) @ about((0, 1, 0), beta) @ about((0, 0, 1), gamma)


@pytest.mark.parametrize(("n", "beta"), [(1, 0.4), (2, 2.9)])
def test_wigner_d_agrees_with_sympy(n, beta):
    orders = range(-n, n + 1)
    expected = [[complex(Rotation.d(n, a, b, beta).doit()).real for b in orders] for a in orders]
    assert np.abs(wigner_d(n, beta) - expected).max() < 2e-15


@pytest.mark.parametrize(("n", "to", "of"), [(4, 3, -1), (6, -5, 2)])
def test_elements_of_higher_degree_agree_with_sympy(n, to, of):
    expected = complex(Rotation.d(n, to, of, 0.7).doit()).real
    assert abs(wigner_d(n, 0.7)[n + to, n + of] - expected) < 2e-15


def test_wigner_d_at_a_right_angle_is_delta():
    for n, delta in enumerate(wigner_delta(6)):
        assert delta.shape == (2 * n + 1, 2 * n + 1)
        assert np.abs(wigner_d(n, np.pi / 2) - delta).max() < 2e-15


def test_delta_has_its_symmetries_and_is_orthogonal():
    n = 25
    delta = wigner_delta(n)[n]
    m = np.arange(-n, n + 1)
    sign = (-1.0) ** (m[:, None] - m)
    assert np.abs(delta @ delta.T - np.eye(2 * n + 1)).max() < 1e-14
    assert np.abs(delta - sign * delta.T).max() < 1e-14
    assert np.abs(delta - (-1.0) ** (n + m[:, None]) * delta[:, ::-1]).max() < 1e-14
    assert not delta.flags.writeable


@pytest.mark.parametrize(
    "angles", [(0.3, 1.1, -2.0), (2.0, 1e-9, 0.7), (-1.0, np.pi - 1e-9, 0.2), (3.0, 3.0, 3.0)]
)
def test_euler_angles_give_the_rotation_again(angles):
    R = turned_by(*angles)
    assert np.abs(turned_by(*euler_angles(R)) - R).max() < 1e-15


@pytest.mark.parametrize("beta", [0.0, np.pi])
def test_euler_angles_exist_where_the_axis_is_kept(beta):
    R = about((0, 0, 1), 0.8) @ np.diag([np.cos(beta), 1.0, np.cos(beta)])
    assert np.abs(turned_by(*euler_angles(R)) - R).max() < 1e-15


def test_two_rotations_in_turn_are_their_product():
    first, second = about((1, 2, -1), 0.9), about((-3, 0.5, 1), 2.2)
    blocks = zip(
        rotation_blocks(7, second),
        rotation_blocks(7, first),
        rotation_blocks(7, second @ first),
        strict=True,
    )
    for a, b, both in blocks:
        assert np.abs(a @ b - both).max() < 5e-15


def test_degree_one_turns_vectors():
    R = about((0.2, -1, 0.4), 1.3)
    spherical = np.array([[1, -1j, 0], [0, 0, np.sqrt(2)], [-1, -1j, 0]]) / np.sqrt(2)
    # the amplitude of e_m in a vector v is conj(e_m) . v
    expected = spherical.conj() @ R @ spherical.T
    assert np.abs(rotation_blocks(1, R)[1] - expected).max() < 1e-15


def test_harmonics_are_wigner_functions():
    beta = 1.234
    f = harmonics(6, np.array([1 - np.cos(beta)]))[:, 0, :]
    for n in range(1, 7):
        expected = -np.sqrt((2 * n + 1) / (4 * np.pi)) * wigner_d(n, beta)[:, n + 1]
        assert np.abs(f[6 - n : 7 + n, n] - expected).max() < 1e-14


def test_rotation_matrix_turns_each_helicity_alike():
    R = about((1, 1, 3), -0.6)
    D = rotation_matrix(3, R)
    assert D.shape == (30, 30)
    assert np.abs(D @ D.conj().T - np.eye(30)).max() < 1e-14
    assert np.array_equal(D[::2, ::2], D[1::2, 1::2])
    assert not D[::2, 1::2].any()
    assert np.array_equal(D[6:16:2, 6:16:2], rotation_blocks(2, R)[2])
