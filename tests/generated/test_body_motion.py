"""Emitted motion of a body of any shape against equations written by hand, and its limits."""

import importlib

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import block_diag, expm
from scipy.spatial.transform import Rotation
from scipy.special import ellipj

from tweezer.compiled import cache_functions


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
        values = {f"W{i + 1}": each for i, each in enumerate(self.weight)}
        matrices = {
            "M": lambda: self.inertia,
            "H": lambda: np.linalg.inv(self.inertia),
            "R": lambda: self.drag,
            "B": lambda: np.linalg.inv(self.drag),
        }
        for name in {each[0] for each in module.PARAMS} - {"W"}:
            matrix = matrices[name]()
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


# --- limits --------------------------------------------------------------------------------------
def test_sphere_moves_as_by_the_models_of_spheres():
    """At every order: drag and inertia of a sphere, against its emitted models."""
    rng = np.random.default_rng(2)
    for _ in range(100):
        mass, inertia, drag, turning = rng.uniform(0.5, 2, 4)
        body = Body(
            np.diag([mass] * 3 + [inertia] * 3), np.diag([drag] * 3 + [turning] * 3),
            rng.normal(size=3),
        )  # fmt: skip
        _, state, force, moment, *_ = random_case(rng)
        force_gradient, moment_gradient = rng.normal(size=(2, 3, 3))
        values = {"m": mass, "I": inertia, "beta_v": drag, "beta_w": turning}
        values |= {f"W{i + 1}": each for i, each in enumerate(body.weight)}
        mobility = np.array([1 / drag, 1 / drag, 1 / turning, 1 / turning, 0.0])
        rates = force_gradient, moment_gradient
        velocity = (force + body.weight) / drag
        slow = emitted("first_order_body")
        equivalent = np.empty(6)
        slow.slow_wrench(
            state[3:7], force, moment, *(each @ velocity for each in rates), body.params(slow),
            equivalent,
        )  # fmt: skip
        pairs = {
            "full_sphere": ("full_body", state, force, moment),
            "overdamped_rotation": ("overdamped_body", state[:7], force, moment),
            "first_order_sphere": ("first_order_body", state[:7], *np.split(equivalent, 2)),
        }
        for sphere, (name, y, *fields) in pairs.items():
            of_body, of_sphere = np.empty((2, len(y)))
            module, known = emitted(name), emitted(sphere)
            module.rates(0.0, y, *fields, *rates, mobility, body.params(module), of_body)
            params = np.array([values[each] for each in known.PARAMS])
            known.rates(0.0, y, force, moment, *rates, mobility, params, of_sphere)
            assert error(of_body, of_sphere) < 1e-13


NOTHING = np.zeros(3)


def free_motion(inertia, spin, times):
    """States of a body without drag and forces, (times, 13)."""
    module = emitted("full_body")
    params = Body(inertia, np.zeros((6, 6)), NOTHING).params(module)

    def rates(_, y):
        out = np.empty(13)
        module.rhs(0.0, y, NOTHING, NOTHING, params, out)
        return out

    start = np.concatenate([[0.1, 0.2, 0.3], [1, 0, 0, 0], [0.4, -0.7, 0.5], spin])
    ends = times[[0, -1]]
    return solve_ivp(rates, ends, start, "DOP853", times, rtol=1e-13, atol=1e-14).y.T


def test_body_with_added_mass_keeps_energy_and_both_momenta():
    """The inertia couples velocity and angular velocity: no velocity is conserved."""
    inertia, kept = positive(np.random.default_rng(3)), []
    for state in free_motion(inertia, [1.3, 0.0, 0.9], np.linspace(0, 20, 9)):
        rotation = turned(state[3:7])
        twist = np.concatenate([rotation.T @ state[7:10], state[10:]])
        momenta = inertia @ twist
        p, about = rotation @ momenta[:3], rotation @ momenta[3:]
        kept.append([twist @ momenta / 2, *p, *about + np.cross(state[:3], p)])
    np.testing.assert_allclose(kept, [kept[0]] * len(kept), rtol=0, atol=1e-10)


def test_free_top_turns_by_jacobis_functions():
    """Landau and Lifshitz, Mechanics, (37.10), in axes that are not those of inertia."""
    moments = i1, i2, i3 = np.array([1.0, 2.0, 3.5])
    tilt = Rotation.from_rotvec([0.4, -0.8, 0.3]).as_matrix()
    inertia = block_diag(2 * np.eye(3), tilt @ np.diag(moments) @ tilt.T)
    begin, times = np.array([1.3, 0.0, 0.9]), np.linspace(0, 30, 61)
    states = free_motion(inertia, tilt @ begin, times)
    twice_energy, square = moments @ begin**2, moments**2 @ begin**2
    assert square > twice_energy * i2
    high, low = twice_energy * i3 - square, square - twice_energy * i1
    rate = np.sqrt((i3 - i2) * low / moments.prod())
    sn, cn, dn, _ = ellipj(rate * times, (i2 - i1) * high / ((i3 - i2) * low))
    expected = np.column_stack([
        np.sqrt(high / (i1 * (i3 - i1))) * cn,
        np.sqrt(high / (i2 * (i3 - i2))) * sn,
        np.sqrt(low / (i3 * (i3 - i1))) * dn,
    ])  # fmt: skip
    np.testing.assert_allclose(states[:, 10:] @ tilt, expected, rtol=0, atol=1e-11)
    path = states[0, :3] + times[:, None] * states[0, 7:10]
    np.testing.assert_allclose(states[:, :3], path, rtol=0, atol=1e-11)
    angular = [turned(each[3:7]) @ inertia[3:, 3:] @ each[10:] for each in states]
    np.testing.assert_allclose(angular, [angular[0]] * len(times), rtol=0, atol=1e-11)


# --- the error of the first order ----------------------------------------------------------------
AXIS = np.array([0.3, -0.2, 0.9])
UP = np.array([0.0, 0.0, 1.0])


def field(q, e):
    """A trap that also drives round, pulls along the body's axis and aligns it."""
    n = turned(e) @ AXIS
    force = np.array([0.2, 0.1, 0.3]) - q + 0.7 * np.cross(UP, q) + 0.4 * n + 0.3 * np.sin(q)
    return force, 1.5 * np.cross(n, UP) + 0.5 * UP + 0.3 * q


def field_rates(q, e, twist):
    """Rates of the field along a twist in the body frame."""
    rotation = turned(e)
    v, turning = rotation @ twist[:3], rotation @ np.cross(twist[3:], AXIS)
    force = -v + 0.7 * np.cross(UP, v) + 0.4 * turning + 0.3 * np.cos(q) * v
    return force, 1.5 * np.cross(turning, UP) + 0.3 * v


def solved(rates, start, end, method):
    return solve_ivp(rates, (0, end), start, method, rtol=1e-12, atol=1e-14).y[:, -1]


def with_inertia(body, released, end):
    module = emitted("full_body")
    params = body.params(module)

    def rates(t, y):
        out = np.empty(13)
        module.rhs(t, y, *field(y[:3], y[3:7]), params, out)
        return out

    return solved(rates, released, end, "LSODA")[:7]


def to_first_order(body, released, end):
    module = emitted("first_order_body")
    params = body.params(module)

    def rates(t, y):
        q, e = y[:3], y[3:]
        slow, equivalent, out = np.empty(6), np.empty(6), np.empty(7)
        force, moment = field(q, e)
        module.slow_velocity(e, force, moment, params, slow)
        module.slow_wrench(e, force, moment, *field_rates(q, e, slow), params, equivalent)
        module.rhs(t, y, equivalent[:3], equivalent[3:], params, out)
        return out

    q, e, moved = released[:3], released[3:7], np.empty(6)
    module.matched_start(released, *field(q, e), params, moved)
    # one rigid motion of constant twist from the release
    generator = np.zeros((4, 4))
    generator[:3, :3] = np.cross(np.eye(3), moved[3:])
    generator[:3, 3] = moved[:3]
    motion = expm(generator)
    turn = np.roll(Rotation.from_matrix(turned(e) @ motion[:3, :3]).as_quat(), 1)
    return solved(rates, np.concatenate([q + turned(e) @ motion[:3, 3], turn]), end, "DOP853")


def ellipsoid():
    return np.diag([1, 1, 1, 0.2, 0.35, 0.5]), np.diag([1, 1.2, 1.5, 0.8, 1.1, 1.6])


def propeller():
    """Drag that couples translation and rotation strongly, and added mass."""
    drag = np.diag([1, 1.2, 1.5, 0.8, 1.1, 1.6])
    drag[:3, 3:] = [[0.5, 0.2, 0], [-0.1, -0.6, 0.3], [0.1, 0, 0.7]]
    drag[3:, :3] = drag[:3, 3:].T
    inertia = np.diag([1, 1.3, 1.1, 0.2, 0.35, 0.5])
    inertia[0, 4] = inertia[4, 0] = 0.1
    return inertia, drag


@pytest.mark.parametrize("shape", [ellipsoid, propeller])
def test_error_of_first_order_falls_as_the_inertia_squared(shape):
    inertia, drag = shape()
    assert np.linalg.eigvalsh(drag).min() > 0.1
    released = np.concatenate([[0.3, -0.2, 0.4], [1, 0, 0, 0], [0.5, 0.2, -0.4], [0.3, -0.6, 0.8]])
    errors = []
    for factor in (1e-3, 1e-4):
        body = Body(factor * inertia, drag, [0.1, -0.1, -0.2])
        states = with_inertia(body, released, 1.5), to_first_order(body, released, 1.5)
        pose, expected = ((y[:3], turned(y[3:])) for y in states)
        errors.append([np.linalg.norm(a - b) for a, b in zip(pose, expected, strict=True)])
    print(shape.__name__, *errors)
    ratio = np.divide(*errors)
    assert np.abs(ratio - 100).max() < 2
