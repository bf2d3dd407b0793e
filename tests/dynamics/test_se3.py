"""Poses on SE(3), against matrix exponentials."""

import numpy as np
import pytest
from numba import njit
from scipy.linalg import expm, logm
from scipy.spatial.transform import Rotation

from tweezer.dynamics import se3


def scalar_first(rotation):
    return rotation.as_quat(scalar_first=True)


def matrix(position, e):
    pose = np.eye(4)
    pose[:3, :3] = Rotation.from_quat(e, scalar_first=True).as_matrix()
    pose[:3, 3] = position
    return pose


def hat(xi):
    out = np.zeros((4, 4))
    x, y, z = xi[3:]
    out[:3, :3] = [[0, -z, y], [z, 0, -x], [-y, x, 0]]
    out[:3, 3] = xi[:3]
    return out


def called(function, *arguments):
    """Call a function that is inlined into compiled loops, as a loop does."""
    sizes = {"rotated": (3,), "rotated_back": (3,), "from_middle": (3,), "turn_in_body": (4,)}
    out = np.empty(sizes[function.__name__])

    @njit
    def loop(out, *rest):
        function(*rest, out)

    loop(out, *arguments)
    return out


@njit
def moving(position, e, xi, out_position, out_e):
    se3.moved(position, e, xi, out_position, out_e)


RNG = np.random.default_rng(5)
E = scalar_first(Rotation.random(random_state=3))


def test_vectors_rotate_there_and_back():
    v = RNG.normal(size=3)
    there = called(se3.rotated, E, v)
    assert there == pytest.approx(Rotation.from_quat(E, scalar_first=True).apply(v), rel=1e-14)
    assert called(se3.rotated_back, E, there) == pytest.approx(v, rel=1e-14)


@pytest.mark.parametrize("size", [0.0, 1e-9, 1e-3, 0.0199, 0.0201, 1.0, 3.1, 9.0])
def test_twist_is_the_exponential_of_se3(size):
    xi = RNG.normal(size=6)
    xi[3:] *= size / np.linalg.norm(xi[3:])
    position = RNG.normal(size=3)
    out, turned = np.empty(3), np.empty(4)
    moving(position, E, xi, out, turned)
    expected = matrix(position, E) @ expm(hat(xi))
    assert matrix(out, turned) == pytest.approx(expected, abs=3e-15 * (1 + size))
    assert np.linalg.norm(turned) == pytest.approx(1, abs=1e-15)
    w1, w2, w3 = xi[3:]
    assert called(se3.turn_in_body, E, w1, w2, w3) == pytest.approx(turned, abs=0)


@pytest.mark.parametrize("size", [0.0, 1e-6, 0.0999, 0.1001, 1.0, 2.5])
def test_rate_of_a_rotation_vector_follows_from_the_angular_velocity(size):
    theta, w = RNG.normal(size=3), RNG.normal(size=3)
    theta *= size / np.linalg.norm(theta)
    h = 1e-5

    def after(t):
        turned = logm(expm(hat([0, 0, 0, *theta])) @ expm(hat([0, 0, 0, *(t * w)])))
        return np.real([turned[2, 1], turned[0, 2], turned[1, 0]])

    rate = (8 * (after(h) - after(-h)) - (after(2 * h) - after(-2 * h))) / (12 * h)
    assert w + called(se3.from_middle, theta, w) == pytest.approx(rate, abs=1e-9)
    if size == 0.0999:  # the series meets the closed form
        beyond = called(se3.from_middle, theta / size * 0.1000001, w)
        assert called(se3.from_middle, theta / size * 0.0999999, w) == pytest.approx(
            beyond, abs=1e-6
        )
