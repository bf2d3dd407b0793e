"""Motions known in closed form: sedimentation, the linear trap, spin-up, free tops."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from scipy.special import ellipj

import tweezer
from tests.reference.fields import LinearTrap, in_trap
from tests.reference.rigid_body import rotation_matrix
from tweezer.dynamics import bind, integrate
from tweezer.fluid import Stokes
from tweezer.scene.bead import bead_properties

COMPILED = ["dormand-prince", "dop853", "exponential"]
TIGHT = {"relative_tolerance": 1e-12, "position_tolerance": 1e-18, "orientation_tolerance": 1e-13}


def scene_with(simulation, **sections):
    return tweezer.load_scene("thesis-990nm").replace(
        simulation={**TIGHT, **simulation}, **sections
    )


@pytest.mark.parametrize(
    "method", [*COMPILED, "scipy:RK45", "scipy:DOP853", "scipy:Radau", "scipy:LSODA"]
)
@pytest.mark.parametrize("model", ["full", "scaled"])
def test_sedimentation(model, method):
    """Constant force: x = (F/beta)(t - tau (1 - e^(-t/tau))), with tau/a2 for the scaled model."""
    scene = scene_with(
        {"model": model, "method": method, "scaling_factor": 0.1, "samples": 41},
        forces={"optical": False},
    )
    bead = bead_properties(scene)
    tau = bead.relaxation_time / (0.1 if model == "scaled" else 1)
    run = tweezer.simulate(scene, duration=20 * tau)
    t = run["time"].values
    terminal = bead.weight[2] / bead.drag
    exact = terminal * (t + tau * np.expm1(-t / tau))
    fallen = run["position"].sel(axis="z").values - scene.start_position[2]
    # the start is micrometres away: differences keep 1e-16 of that
    np.testing.assert_allclose(fallen, exact, rtol=1e-6, atol=1e-20)
    rtol = 1e-6 if method == "scipy:LSODA" else 1e-7  # LSODA's dense output is of lower order
    np.testing.assert_allclose(
        run["velocity"].sel(axis="z"), -terminal * np.expm1(-t / tau), rtol=rtol, atol=1e-18
    )


def trap_solution(t, mass, drag, stiffness, x0, v0):
    """x(t) of m x'' + beta x' + k x = 0."""
    slow, fast = np.sort_complex(np.roots([mass, drag, stiffness]).astype(complex))[::-1]
    a = (v0 - fast * x0) / (slow - fast)
    b = x0 - a
    return (a * np.exp(slow * t) + b * np.exp(fast * t)).real


@pytest.mark.parametrize("damping", ["overdamped", "underdamped"])
@pytest.mark.parametrize(
    ("model", "method"),
    [*itertools.product(["full", "scaled"], COMPILED),
     ("full", "scipy:DOP853"), ("scaled", "scipy:Radau"), ("full", "scipy:LSODA")],
)  # fmt: skip
def test_linear_trap(model, method, damping):
    """Both sides of k = beta^2/4m; the scaled model as the full one of mass m/a2."""
    scene = scene_with(
        {"model": model, "method": method, "scaling_factor": 0.25, "samples": 60},
        start={"frame": "focus", "position": [1e-7, -2e-7, 3e-7], "velocity": [1e-2, 0, -2e-2]},
        forces={"gravity": False, "buoyancy": False},
    )
    bead = bead_properties(scene)
    mass = bead.mass / (0.25 if model == "scaled" else 1)
    critical = bead.drag**2 / (4 * mass)
    stiffness = critical * (0.3 if damping == "overdamped" else 20)
    equations = in_trap(bind(scene), stiffness)
    times = np.linspace(0, 10 * mass / bead.drag, 60)
    result = integrate(equations, times)
    motion = equations.motion(result.times, result.states)
    for axis in range(3):
        x0, v0 = scene.start_position[axis], scene.start.velocity[axis]
        exact = trap_solution(times, mass, bead.drag, stiffness, x0, v0)
        scale = np.abs(motion.position).max()
        np.testing.assert_allclose(motion.position[:, axis], exact, atol=1e-8 * scale)


def slow_errors(model, epsilons, v0):
    """Largest error against the closed form over a trap time, for tau k/beta = epsilon."""
    errors = []
    for epsilon in epsilons:
        scene = scene_with(
            {"model": model, "method": "dop853", "samples": 50},
            start={"frame": "focus", "position": [1e-6, 0, 0], "velocity": [v0, 0, 0]},
            forces={"gravity": False, "buoyancy": False},
        )
        bead = bead_properties(scene)
        stiffness = epsilon * bead.drag / bead.relaxation_time
        equations = in_trap(bind(scene), stiffness)
        trap_time = bead.drag / stiffness
        times = np.linspace(0, 3 * trap_time, 50)
        result = integrate(equations, times)
        x = equations.motion(result.times, result.states).position[:, 0]
        exact = trap_solution(times, bead.mass, bead.drag, stiffness, 1e-6, v0)
        errors.append(np.abs(x - exact)[25:].max() / 1e-6)
    return np.array(errors)


@pytest.mark.parametrize(("model", "order"), [("overdamped", 1), ("first-order", 2)])
def test_slow_models_err_by_their_power_of_epsilon(model, order):
    """The expansion to order n leaves an error of order n + 1, here by fitted slope."""
    epsilons = np.array([1e-3, 2e-3, 4e-3, 8e-3])
    errors = slow_errors(model, epsilons, v0=0.0)
    slope = np.polyfit(np.log(epsilons), np.log(errors), 1)[0]
    assert slope == pytest.approx(order, abs=0.1)


def test_matched_start_carries_the_first_order():
    """Without the shift tau (v0 - u) of the start the error falls as epsilon, not epsilon^2."""
    scene = scene_with({"model": "first-order"}, start={"velocity": [1e-3, 0, 0]})
    equations = bind(scene)
    shift = equations.initial_state - np.array(scene.start_position)
    bead = bead_properties(scene)
    u = (tweezer.optical_force(scene, scene.start_position) + bead.weight) / bead.drag
    expected = bead.relaxation_time * (np.array([1e-3, 0, 0]) - u)
    np.testing.assert_allclose(shift, expected, rtol=1e-6, atol=1e-21)
    motion = equations.motion(np.array([0.0]), equations.initial_state[None])
    np.testing.assert_allclose(motion.position[0], scene.start_position, rtol=1e-12)
    # at the start the layer brings the velocity back to the released one, up to order tau
    np.testing.assert_allclose(motion.velocity[0], [1e-3, 0, 0], atol=1e-3 * np.abs(u).max())


def test_models_agree_on_the_thesis_bead():
    """full, first-order and overdamped, released from rest: one path at this scale."""
    scene = scene_with({"method": "scipy:LSODA", "relative_tolerance": 1e-9, "samples": 50})
    paths = {
        model: tweezer.simulate(scene, duration=2e-4, model=model)["position"].values
        for model in ("full", "first-order", "overdamped")
    }
    travelled = np.abs(paths["full"][-1] - paths["full"][0]).max()
    assert np.abs(paths["first-order"] - paths["full"]).max() < 1e-5 * travelled
    overdamped_error = np.abs(paths["overdamped"] - paths["full"]).max()
    tau = bead_properties(scene).relaxation_time
    speed = travelled / 2e-4
    assert overdamped_error == pytest.approx(tau * speed, rel=0.2)  # the start it does not shift


@pytest.mark.parametrize("rotation_state", ["angular-velocity", "euler-rates"])
@pytest.mark.parametrize("model", ["full", "first-order", "overdamped"])
def test_turning_under_a_constant_moment(model, rotation_state):
    """A sphere spins up to M/beta_w with I/beta_w and turns about a fixed axis, past e0 = 0."""
    scene = scene_with(
        {"model": model, "method": "dop853", "rotation_state": rotation_state, "samples": 101},
        beam={"torque": "thesis"},
        forces={"gravity": False, "buoyancy": False},
    )
    bead = bead_properties(scene)
    tau = bead.moments_of_inertia[0] / bead.rotational_drag
    spin = 0.3 / tau if model == "full" else 0.001 / tau
    moment = np.array([0.6, 0, 0.8]) * spin * bead.rotational_drag
    equations = in_trap(bind(scene), 0.0, tuple(moment))
    times = np.linspace(0, 8 / spin, 101)  # more than a turn of 2 pi
    result = integrate(equations, times)
    motion = equations.motion(result.times, result.states)
    if model == "overdamped":
        angle, rate = spin * times, np.full_like(times, spin)
    else:
        angle = spin * (times + tau * np.expm1(-times / tau))
        rate = -spin * np.expm1(-times / tau)
    exact = np.column_stack([np.cos(angle / 2), np.outer(np.sin(angle / 2), [0.6, 0, 0.8])])
    # a turn of more than pi in the initial layer is beyond a first-order start
    atol = 1e-9 if model != "first-order" else 1e-6
    np.testing.assert_allclose(motion.orientation, exact, atol=atol)
    np.testing.assert_allclose(
        motion.angular_velocity, np.outer(rate, [0.6, 0, 0.8]), atol=1e-8 * spin
    )
    assert np.abs(motion.orientation[:, 0]).min() < 0.05  # went through e0 = 0
    assert np.abs(np.linalg.norm(motion.orientation, axis=1) - 1).max() < 1e-12


# --- free tops ------------------------------------------------------------------------------
MOMENTS = np.array([1.0, 1.7, 2.2]) * 1e-28
TURNS = 1000


def free_top(moments, omega, turns, samples, rotation_state):
    """Motion of a body that nothing acts on, and the times."""
    duration = turns * 2 * np.pi / np.linalg.norm(omega)
    scene = tweezer.load_scene("thesis-990nm").replace(
        bead={"moments_of_inertia": list(moments)},
        start={"angular_velocity": list(omega), "orientation": [0.0, 0.6, 0.0, 0.8]},
        simulation={
            "model": "full", "method": "dop853", "rotation_state": rotation_state,
            "relative_tolerance": 1e-13, "orientation_tolerance": 1e-13,
        },
    )  # fmt: skip
    bound = bind(scene)
    problem = replace(
        bound.problem, bead=replace(bound.bead, weight=(0.0, 0.0, 0.0)), light=LinearTrap(0.0),
        drag=Stokes(1e-60, 1e-60),
    )  # fmt: skip
    equations = type(bound)(problem, bound.module)
    result = integrate(equations, np.linspace(0, duration, samples))
    assert result.status == "complete"
    raw = np.abs(np.linalg.norm(result.states[:, 3:7], axis=1) - 1).max()
    print(f"{turns} turns in {result.steps} steps, |e| - 1 of the solver's states {raw:.1e}")
    assert raw < 1e-12
    return result.times, equations.motion(result.times, result.states)


def conserved(motion, moments):
    """Rotational energy, and angular momentum in the inertial frame, over the run."""
    w = motion.angular_velocity
    energy = 0.5 * (w * w * moments).sum(axis=1)
    momentum = np.array(
        [rotation_matrix(e) @ h for e, h in zip(motion.orientation, w * moments, strict=True)]
    )
    return energy, momentum


@pytest.mark.parametrize("rotation_state", ["angular-velocity", "euler-rates"])
def test_free_asymmetric_top_for_1000_turns(rotation_state):
    """Jacobi's elliptic functions, and energy, angular momentum and |e| kept."""
    I1, I2, I3 = MOMENTS
    omega0 = np.array([20.0, 0.0, 55.0])  # L^2 > 2 E I2: it circles the third axis
    times, motion = free_top(MOMENTS, omega0, TURNS, 2001, rotation_state)
    energy, momentum = conserved(motion, MOMENTS)
    assert np.abs(energy / energy[0] - 1).max() < 1e-9
    drift = np.linalg.norm(momentum - momentum[0], axis=1) / np.linalg.norm(momentum[0])
    assert drift.max() < 1e-9
    print(f"energy {np.abs(energy / energy[0] - 1).max():.1e}, momentum {drift.max():.1e}")

    # Landau and Lifshitz, Mechanics, section 37: cn, sn, dn with t = 0 at omega2 = 0
    two_E, L2 = 2 * energy[0], (momentum[0] ** 2).sum()
    amplitude = np.sqrt(
        [(two_E * I3 - L2) / (I1 * (I3 - I1)), (two_E * I3 - L2) / (I2 * (I3 - I2)),
         (L2 - two_E * I1) / (I3 * (I3 - I1))]
    )  # fmt: skip
    rate = np.sqrt((I3 - I2) * (L2 - two_E * I1) / (I1 * I2 * I3))
    m = (I2 - I1) * (two_E * I3 - L2) / ((I3 - I2) * (L2 - two_E * I1))
    sn, cn, dn, _ = ellipj(rate * times, m)
    exact = amplitude * np.column_stack([cn, sn, dn])
    np.testing.assert_allclose(motion.angular_velocity, exact, atol=1e-7 * np.linalg.norm(omega0))


def test_free_symmetric_top_precesses():
    """The symmetry axis circles the angular momentum at L/I1, at a fixed angle."""
    I1, I3 = 1.0e-28, 1.8e-28
    moments = np.array([I1, I1, I3])
    times, motion = free_top(moments, [12.0, 0.0, 30.0], TURNS, 4001, "angular-velocity")
    energy, momentum = conserved(motion, moments)
    assert np.abs(energy / energy[0] - 1).max() < 1e-9
    L = momentum[0]
    length = np.linalg.norm(L)
    assert np.linalg.norm(momentum - L, axis=1).max() < 1e-9 * length
    axis = np.array([rotation_matrix(e)[:, 2] for e in motion.orientation])
    np.testing.assert_allclose(axis @ L / length, axis[0] @ L / length, atol=1e-9)
    across = axis[0] - (axis[0] @ L) * L / length**2
    third = np.cross(L / length, across)
    angle = length / I1 * times
    exact = np.outer(np.cos(angle), across) + np.outer(np.sin(angle), third)
    exact += (axis[0] @ L) * L / length**2
    np.testing.assert_allclose(axis, exact, atol=1e-7)
