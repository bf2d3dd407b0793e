"""Every emitted model against equations written by hand and against the 4x4 solve of (A.24)."""

import importlib

import numpy as np
import pytest

from tests.reference.rigid_body import (
    Body,
    L_matrix,
    QuadraticField,
    accelerations,
    complex_step_jacobian,
    first_order,
    full,
    full_by_A24,
    overdamped,
    quaternion_product,
    rotation_matrix,
    solve_A24,
)
from tweezer.compiled import cache_functions

MODELS = [
    "full_translation",
    "full_sphere",
    "full_rigid_body",
    "full_sphere_euler_rates",
    "full_rigid_body_euler_rates",
    "scaled_translation",
    "scaled_sphere",
    "scaled_rigid_body",
    "scaled_sphere_euler_rates",
    "scaled_rigid_body_euler_rates",
    "overdamped_translation",
    "overdamped_rotation",
    "first_order_translation",
    "first_order_sphere",
    "first_order_rigid_body",
]
STATES = 500


def emitted(name):
    return cache_functions(importlib.import_module(f"tweezer.generated.{name}"))


def by_hand(name, body, field, state):
    if name.endswith("euler_rates"):
        return full_by_A24(body, field, state, a2=body.a2 if "scaled" in name else 1.0)
    if name.startswith("overdamped"):
        return overdamped(body, field, state)
    if name.startswith("first_order"):
        return first_order(body, field, state)
    a2 = body.a2 if "scaled" in name else 1.0
    return full(body, field, state, a2=a2, rotates="translation" not in name)


def random_body(rng, name):
    inertia = rng.uniform(0.5, 2.0, 3)
    if "rigid_body" not in name:
        inertia[:] = inertia[0]
    drag, rotational_drag, a2 = rng.uniform(0.1, 2.0, 3)
    mobility = rng.uniform(0.5, 2.0, 5)
    mobility[4] *= rng.choice([-0.2, 0.2])
    return Body(
        rng.uniform(0.5, 2), inertia, drag, rotational_drag, rng.normal(size=3), a2 / 2,
        mobility, rng.uniform(-0.3, 0.3, (5, 3)),
    )  # fmt: skip


def random_state(rng, module, i):
    """Unit e for most, then |e0| < 1e-12, e0 = 0 exactly, and e of other lengths."""
    state = rng.normal(size=len(module.STATE))
    if "e0" in module.STATE:
        at = module.STATE.index("e0")
        e = state[at : at + 4]
        if i % 4 == 1:
            e[0] = rng.uniform(-1e-12, 1e-12)
        if i % 8 == 3:
            e[0] = 0.0
        if i % 8 != 5:
            e /= np.linalg.norm(e)
    return state


def inputs_at(names, field, body, q):
    u = (field.force(q) + body.weight) / body.drag
    values = {
        "force": lambda: field.force(q),
        "moment": lambda: field.moment(q),
        "force_gradient": lambda: field.force_gradient(q),
        "moment_gradient": lambda: field.moment_gradient(q),
        "force_curvature": lambda: field.force_curvature(q, u),
        "moment_curvature": lambda: field.moment_curvature(q, u),
        "mobility": lambda: body.mobilities(q),
        "mobility_gradient": lambda: body.mobility_gradient(q),
    }
    return [values[name]() for name in names]


def parameters(module, body):
    values = body.parameters()
    return np.array([values[name] for name in module.PARAMS])


def random_field(rng):
    return QuadraticField(rng.normal(size=(3, 10)), rng.normal(size=(3, 10)))


@pytest.mark.parametrize("name", MODELS)
def test_right_hand_side(name):
    """1e-13 of the largest component, over states with e0 = 0 and |e0| < 1e-12 among them."""
    module, rng = emitted(name), np.random.default_rng(20)
    worst = 0.0
    for i in range(STATES):
        body, field = random_body(rng, name), random_field(rng)
        state = random_state(rng, module, i)
        expected = by_hand(name, body, field, state)
        out = np.empty_like(state)
        given = inputs_at(module.RHS_INPUTS, field, body, state[:3])
        module.rhs(0.0, state, *given, parameters(module, body), out)
        worst = max(worst, np.abs(out - expected).max() / np.abs(expected).max())
    print(f"{name}: {worst:.1e}")
    assert worst < 1e-13


@pytest.mark.parametrize("name", MODELS)
def test_jacobian(name):
    """Against complex-step differentiation of the hand-written equations."""
    module, rng = emitted(name), np.random.default_rng(21)
    for i in range(100):
        body, field = random_body(rng, name), random_field(rng)
        state = random_state(rng, module, i)
        if name.endswith("euler_rates"):
            expected = complex_step_jacobian(
                lambda y, body=body, field=field: by_closed_form(name, body, field, y), state
            )
        else:
            expected = complex_step_jacobian(
                lambda y, body=body, field=field: by_hand(name, body, field, y), state
            )
        out = np.empty((len(state), len(state)))
        given = inputs_at(module.RHS_INPUTS + _further(module), field, body, state[:3])
        module.jacobian(0.0, state, *given, parameters(module, body), out)
        assert np.abs(out - expected).max() < 1e-12 * np.abs(expected).max()


def _further(module):
    """Inputs of the Jacobian after those of the right-hand side."""
    assert module.JACOBIAN_INPUTS[: len(module.RHS_INPUTS)] == module.RHS_INPUTS
    return module.JACOBIAN_INPUTS[len(module.RHS_INPUTS) :]


def by_closed_form(name, body, field, state):
    """`full_by_A24` with e'' in closed form: analytic, so complex-step differentiation works.

    Differentiating w = L e' and inserting Euler's equations gives
    e'' = L^T w'/(4 |e|^2) - e (e'.e')/|e|^2 with w' = I^-1 (M - w x I w); `test_right_hand_side`
    holds the same to the 4x4 solve.
    """
    a2 = body.a2 if "scaled" in name else 1.0
    q, e, v, edot = state[:3], state[3:7], state[7:10], state[10:]
    w = L_matrix(e) @ edot
    vdot, moment = accelerations(body, field, q, e, v, w, a2)
    wdot = (moment - np.cross(w, body.inertia * w)) / body.inertia
    eddot = (L_matrix(e).T @ wdot / 4 - e * (edot @ edot)) / (e @ e)
    return np.concatenate([v, edot, vdot, eddot])


def test_angular_velocity_form_is_the_thesis_form():
    """omega' of the emitted models is L e'' of (A.24), at |e| = 1."""
    module, rng = emitted("full_rigid_body"), np.random.default_rng(22)
    for _ in range(200):
        body, field = random_body(rng, "rigid_body"), random_field(rng)
        state = random_state(rng, module, 0)
        q, e, w = state[:3], state[3:7], state[10:]
        edot = L_matrix(e).T @ w / 4
        _, moment = accelerations(body, field, q, e, state[7:10], w, 1.0)
        out = np.empty(13)
        given = inputs_at(module.RHS_INPUTS, field, body, q)
        module.rhs(0.0, state, *given, parameters(module, body), out)
        expected = L_matrix(e) @ solve_A24(body, e, edot, moment)
        np.testing.assert_allclose(out[10:], expected, rtol=0, atol=1e-12 * np.abs(expected).max())


@pytest.mark.parametrize(("prefix"), ["full", "scaled"])
def test_reduced_models_are_the_full_one_restricted(prefix):
    """The sphere is the rigid body of equal moments; translation is the sphere at rest."""
    rng = np.random.default_rng(23)
    general, sphere, translation = (
        emitted(f"{prefix}_{kind}") for kind in ("rigid_body", "sphere", "translation")
    )
    for i in range(200):
        body, field = random_body(rng, "sphere"), random_field(rng)
        body.mobility[4] = 0.0  # a bead that rolls is dragged otherwise
        state = random_state(rng, general, i)
        moving = np.concatenate([state[:3], state[7:10]])
        out = []
        for module, y in ((general, state), (sphere, state), (translation, moving)):
            given = inputs_at(module.RHS_INPUTS, field, body, state[:3])
            out.append(np.empty_like(y))
            module.rhs(0.0, y, *given, parameters(module, body), out[-1])
        np.testing.assert_allclose(out[1], out[0], rtol=1e-12, atol=1e-12)
        np.testing.assert_allclose(out[2][3:], out[1][7:10], rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("prefix", ["overdamped", "first_order"])
def test_slow_models_take_no_moment_for_translation(prefix):
    rng = np.random.default_rng(24)
    rotating = emitted("overdamped_rotation" if prefix == "overdamped" else "first_order_sphere")
    translation = emitted(f"{prefix}_translation")
    body, field = random_body(rng, "sphere"), random_field(rng)
    body.mobility[4] = 0.0
    state = random_state(rng, rotating, 0)
    whole, part = np.empty(7), np.empty(3)
    for module, out, y in ((rotating, whole, state), (translation, part, state[:3].copy())):
        given = inputs_at(module.RHS_INPUTS, field, body, state[:3])
        module.rhs(0.0, y, *given, parameters(module, body), out)
    np.testing.assert_allclose(whole[:3], part, rtol=1e-14)


def test_matched_start_and_layer():
    """Slow start plus layer is the release; the layer decays with m/beta_v and I/beta_w."""
    rng = np.random.default_rng(25)
    module = emitted("first_order_rigid_body")
    body, field = random_body(rng, "rigid_body"), random_field(rng)
    released = rng.normal(size=13)
    released[3:7] /= np.linalg.norm(released[3:7])
    q, e, v, w = released[:3], released[3:7], released[7:10], released[10:]
    force, moment = field.force(q), field.moment(q)
    excess = v - (force + body.weight) / body.drag
    spin = w - rotation_matrix(e).T @ moment / body.rotational_drag
    start, layer = np.empty(7), np.empty(12)
    module.matched_start(released, force, moment, parameters(module, body), start)
    np.testing.assert_allclose(start[:3], q + body.mass / body.drag * excess, rtol=1e-13)
    turned = body.inertia / body.rotational_drag * spin
    expected = e + quaternion_product(e, np.concatenate([[0], turned])) / 2
    np.testing.assert_allclose(start[3:], expected, rtol=1e-13)
    t = 0.7
    module.initial_layer(t, released, force, moment, parameters(module, body), layer)
    decay = np.exp(-t * body.drag / body.mass)
    turning = np.exp(-t * body.rotational_drag / body.inertia)
    np.testing.assert_allclose(layer[:3], -body.mass / body.drag * excess * decay, rtol=1e-12)
    np.testing.assert_allclose(layer[3:6], excess * decay, rtol=1e-12)
    np.testing.assert_allclose(layer[6:9], -turned * turning, rtol=1e-12)
    np.testing.assert_allclose(layer[9:], spin * turning, rtol=1e-12)


def test_kinematics():
    module, rng = emitted("kinematics"), np.random.default_rng(26)
    for i in range(200):
        e, edot = rng.normal(size=(2, 4))
        if i % 3 == 0:
            e[0] = 0.0
        R, w, rates, projected = np.empty((3, 3)), np.empty(3), np.empty(4), np.empty(8)
        module.rotation_matrix(e, R)
        np.testing.assert_allclose(R, rotation_matrix(e), atol=1e-14)
        module.angular_velocity(e, edot, w)
        np.testing.assert_allclose(w, L_matrix(e) @ edot / (e @ e), rtol=1e-12, atol=1e-13)
        module.euler_rates(e, w, rates)
        np.testing.assert_allclose(rates, quaternion_product(e, np.append(0, w)) / 2, atol=1e-13)
        module.project(e, edot, projected)
        n, ndot = projected[:4], projected[4:]
        assert abs(n @ n - 1) < 1e-15
        assert abs(n @ ndot) < 1e-14 * np.linalg.norm(edot) / np.linalg.norm(e)
        module.angular_velocity(n, ndot, rates[:3])
        np.testing.assert_allclose(rates[:3], w, rtol=1e-10, atol=1e-13)


def test_A26_fails_where_the_projection_does_not():
    """The thesis's e0' = -(e1 e1' + ...)/e0 divides by e0 (A.26)."""
    e = np.array([0.0, 0.6, 0.0, 0.8])
    edot = np.array([0.3, 0.1, 0.2, -0.1])
    with np.errstate(divide="ignore", invalid="ignore"):
        assert not np.isfinite(-(e[1:] @ edot[1:]) / e[0])
    projected = np.empty(8)
    emitted("kinematics").project(e, edot, projected)
    assert np.isfinite(projected).all()
