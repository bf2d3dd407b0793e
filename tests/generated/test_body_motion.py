"""Emitted motion of a body of any shape against equations written by hand, and its limits."""

import importlib

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tweezer.compiled import cache_functions

UPPER = np.triu_indices(6)


def emitted(name):
    return cache_functions(importlib.import_module(f"tweezer.generated.{name}"))


def positive(rng):
    """A symmetric positive 6x6 matrix that couples translation and rotation."""
    root = rng.normal(size=(6, 6))
    return root @ root.T / 6 + np.eye(6)


class Body:
    """Inertia, drag and weight of a body, in any consistent units."""

    def __init__(self, inertia, drag, weight):
        self.inertia, self.drag, self.weight = inertia, drag, np.asarray(weight)

    def params(self, module):
        matrices = {
            "M": self.inertia, "H": np.linalg.inv(self.inertia),
            "R": self.drag, "B": np.linalg.inv(self.drag),
        }  # fmt: skip
        values = {f"W{i + 1}": each for i, each in enumerate(self.weight)}
        for name, matrix in matrices.items():
            values |= {f"{name}{i + 1}{j + 1}": matrix[i, j] for i, j in np.ndindex(6, 6)}
        return np.array([values[name] for name in module.PARAMS])


def turned(e):
    """Matrix of body to inertial components; SciPy has the scalar last."""
    return Rotation.from_quat(np.roll(e, -1)).as_matrix()


def rate_of_e(e, w):
    e0, eps = e[0], e[1:]
    return np.append(-eps @ w, e0 * w + np.cross(eps, w)) / 2


def wrench(body, e, force, moment):
    to_body = turned(e).T
    return np.concatenate([to_body @ (force + body.weight), to_body @ moment])


def inertial(body, twist):
    """N(V) = (w x p, w x l + u x p)."""
    u, w = np.split(twist, 2)
    p, turning = np.split(body.inertia @ twist, 2)
    return np.concatenate([np.cross(w, p), np.cross(w, turning) + np.cross(u, p)])


def full(body, state, force, moment):
    e, v, w = state[3:7], state[7:10], state[10:]
    rotation = turned(e)
    twist = np.concatenate([rotation.T @ v, w])
    left = wrench(body, e, force, moment) - body.drag @ twist - inertial(body, twist)
    rate = np.linalg.solve(body.inertia, left)
    # v = R u, R' = R [w]x
    return np.concatenate([
        v, rate_of_e(e, w), rotation @ (rate[:3] + np.cross(w, twist[:3])), rate[3:]
    ])  # fmt: skip


def overdamped(body, e, equivalent):
    """(q', e') under a wrench in the body frame."""
    twist = np.linalg.solve(body.drag, equivalent)
    return np.concatenate([turned(e) @ twist[:3], rate_of_e(e, twist[3:])])


def first_order(body, e, force, moment, force_rate, moment_rate):
    """W - M B W' - N(V_0) in the body frame, all by solves."""
    to_body, here = turned(e).T, wrench(body, e, force, moment)
    slow = np.linalg.solve(body.drag, here)
    w = slow[3:]
    rate = np.concatenate([
        to_body @ force_rate - np.cross(w, here[:3]), to_body @ moment_rate - np.cross(w, here[3:])
    ])  # fmt: skip
    return here - body.inertia @ np.linalg.solve(body.drag, rate) - inertial(body, slow)


def random_case(rng):
    body = Body(positive(rng), positive(rng), rng.normal(size=3))
    state = rng.normal(size=13)
    state[3:7] /= np.linalg.norm(state[3:7])
    return body, state, *rng.normal(size=(4, 3))


def error(out, expected):
    return np.abs(out - expected).max() / np.abs(expected).max()


NONE = np.zeros((3, 3))


@pytest.fixture(params=range(200))
def case(request):
    return random_case(np.random.default_rng(request.param))


def cases():
    rng = np.random.default_rng(1)
    return [random_case(rng) for _ in range(300)]


def test_full_motion():
    module = emitted("full_body")
    for body, state, force, moment, *_ in cases():
        out = np.empty(13)
        module.rhs(0.0, state, force, moment, body.params(module), out)
        assert error(out, full(body, state, force, moment)) < 1e-13


@pytest.mark.parametrize("name", ["overdamped_body", "first_order_body"])
def test_motion_without_inertia(name):
    module = emitted(name)
    for body, state, force, moment, *_ in cases():
        e, out = state[3:7], np.empty(7)
        arguments = force, moment, NONE, NONE, np.empty(5), body.params(module), out
        module.rates(0.0, state[:7], *arguments)
        assert error(out, overdamped(body, e, wrench(body, e, force, moment))) < 1e-13


def test_slow_velocity_and_matched_start():
    module = emitted("first_order_body")
    for body, state, force, moment, *_ in cases():
        e, params = state[3:7], body.params(module)
        slow, start = np.empty((2, 6))
        module.slow_velocity(e, force, moment, params, slow)
        expected = np.linalg.solve(body.drag, wrench(body, e, force, moment))
        assert error(slow, expected) < 1e-13
        module.matched_start(state, force, moment, params, start)
        excess = np.concatenate([turned(e).T @ state[7:10], state[10:]]) - expected
        assert error(start, np.linalg.solve(body.drag, body.inertia @ excess)) < 1e-13


def test_slow_wrench_gives_the_motion_to_first_order():
    """The weight is added by `rates`, not by `slow_wrench`."""
    module = emitted("first_order_body")
    for body, state, *fields in cases():
        e, params = state[3:7], body.params(module)
        equivalent, out = np.empty(6), np.empty(7)
        module.slow_wrench(e, *fields, params, equivalent)
        expected = first_order(body, e, *fields)
        rotation = turned(e)
        in_frame = np.concatenate([
            rotation @ expected[:3] - body.weight, rotation @ expected[3:]
        ])  # fmt: skip
        assert error(equivalent, in_frame) < 1e-13
        module.rhs(0.0, state[:7], equivalent[:3], equivalent[3:], params, out)
        assert error(out, overdamped(body, e, expected)) < 1e-13


def test_inertial_forces_and_their_derivative():
    """N is quadratic: a central difference of any step has its derivative exactly."""
    module = emitted("body_motion")
    for body, state, *_ in cases():
        twist, out, gradient = state[7:], np.empty(6), np.empty((6, 6))
        module.kirchhoff(twist, body.inertia, out)
        assert error(out, inertial(body, twist)) < 1e-13
        module.kirchhoff_gradient(twist, body.inertia, gradient)
        columns = [
            inertial(body, twist + each) / 2 - inertial(body, twist - each) / 2
            for each in np.eye(6)
        ]
        assert error(gradient, np.transpose(columns)) < 1e-13
