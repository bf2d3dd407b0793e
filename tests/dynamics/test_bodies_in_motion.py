"""Motion of rigid bodies of any shape, against equations written by hand and SciPy's solvers."""

import dataclasses

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

import tweezer
from tweezer.dynamics import bind, integrate
from tweezer.dynamics.body import BodyMotion
from tweezer.dynamics.problem import bound_once
from tweezer.forces import UserForce, kernel, number

#: Stiffness along x and y and along z, N/m, circulation, N/m, torque about z and alignment, N m
TRAP = (2e-6, 1e-6, 4e-7, 3e-21, 8e-20)
TIGHT = {"position_tolerance": 1e-14, "orientation_tolerance": 1e-10}


@kernel
def helical(pose, data, wrench):
    """A trap whose force drives the body round, with a torque about z and one that aligns P3."""
    across, along, turning = number(data, 0), number(data, 1), number(data, 2)
    about, aligning = number(data, 3), number(data, 4)
    for i in range(len(pose.position)):
        x, y, z = pose.position[i]
        wrench.force[i, 0] += -across * x - turning * y
        wrench.force[i, 1] += -across * y + turning * x
        wrench.force[i, 2] += -along * z
        e0, e1, e2, e3 = pose.orientation[i]
        n1, n2 = 2 * (e1 * e3 + e0 * e2), 2 * (e2 * e3 - e0 * e1)
        n3 = 1 - 2 * (e1 * e1 + e2 * e2)
        wrench.moment[i, 0] += aligning * n3 * n2
        wrench.moment[i, 1] += -aligning * n3 * n1
        wrench.moment[i, 2] += about


def force_and_torque(position, turned):
    """Return the force and torque of `helical` by vectors: the torque is n x z times n.z."""
    across, along, turning, about, aligning = TRAP
    z, n = np.array([0.0, 0.0, 1.0]), turned.apply([0.0, 0.0, 1.0])
    force = -np.array([across, across, along]) * position + turning * np.cross(z, position)
    return force, about * z + aligning * (n @ z) * np.cross(n, z)


def by_hand(body, weight):
    """Rate of change of position, Euler parameters, velocity and angular velocity, by vectors."""

    def rates(_, state):
        position, e, v, omega = np.split(state, [3, 7, 10])
        turned = Rotation.from_quat(e, scalar_first=True)
        force, torque = force_and_torque(position, turned)
        u = turned.apply(v, inverse=True)
        twist = np.concatenate([u, omega])
        p, l = np.split(body.inertia @ twist, 2)
        wrench = np.concatenate([
            turned.apply(force + weight, inverse=True), turned.apply(torque, inverse=True)
        ])  # fmt: skip
        wrench -= body.resistance @ twist
        wrench -= np.concatenate([np.cross(omega, p), np.cross(omega, l) + np.cross(u, p)])
        change = np.linalg.solve(body.inertia, wrench)
        e0, r = e[0], e[1:]
        turning = np.concatenate([[-r @ omega], e0 * omega + np.cross(r, omega)]) / 2
        return np.concatenate([
            v, turning, turned.apply(change[:3] + np.cross(omega, u)), change[3:],
        ])  # fmt: skip

    return rates


def scene_of(size, **simulation):
    """A spheroid without light, of the given size across and along its axis, m."""
    return tweezer.load_scene("polystyrene-500nm").replace(
        bead={"shape": "spheroid", "diameter": size[0], "length": size[1]},
        forces={"optical": False},
        start={
            "position": [2e-7, 1e-7, -3e-7], "orientation": [0.8, 0.5, 0.2, 0.1],
            "velocity": [1e-3, 0, 0],
        },
        simulation={"model": "full", "method": "exponential", **TIGHT, **simulation},
    )  # fmt: skip


def problem_of(size, **simulation):
    return bound_once(scene_of(size, **simulation), [UserForce(helical, TRAP, turns=True)])


def unequal(problem, factor=1.0):
    """The body with three unequal axes and coupled drag, as a propeller in thin gas has it."""
    rng = np.random.default_rng(3)
    mass, inertia = problem.body.inertia[0, 0], problem.body.inertia[3, 3]
    scale = np.repeat([1.0, np.sqrt(inertia / mass)], 3)
    mixed = np.eye(6) + 0.25 * rng.normal(size=(6, 6))
    drag = problem.body.resistance[0, 0] * factor
    resistance = drag * scale[:, None] * (mixed @ mixed.T) * scale
    tensor = np.diag([1.0, 1.6, 2.1]) + 0.1 * (np.ones((3, 3)) - np.eye(3))
    matrix = np.diag([mass] * 3 + [0.0] * 3)
    matrix[3:, 3:] = inertia * tensor
    return dataclasses.replace(problem, body=BodyMotion(resistance, matrix))


def compared(problem, duration, method="Radau"):
    """Run by collocation; largest distance, angle, and its force calls."""
    equations = bind(problem)
    times = np.linspace(0, duration, 9)
    run = integrate(equations, times)
    assert run.status == "complete", run.message
    found = equations.motion(times, run.states)
    reference = solve_ivp(
        by_hand(problem.body, np.array(problem.bead.weight)), (0, duration),
        equations.initial_state, method, times, rtol=1e-11,
        atol=1e-16 * np.array([1e2] * 3 + [1e4] * 4 + [1e2] * 3 + [1e7] * 3),
    )  # fmt: skip
    assert reference.status == 0
    position, e = reference.y[:3].T, reference.y[3:7].T
    turned = Rotation.from_quat(e, scalar_first=True)
    apart = turned.inv() * Rotation.from_quat(found.orientation, scalar_first=True)
    return (
        np.linalg.norm(found.position - position, axis=1).max(), apart.magnitude().max(), run,
    )  # fmt: skip


@pytest.mark.parametrize(
    "size", [(4e-7, 8e-7), (1e-7, 2e-6), (2.4e-6, 2e-7)], ids=["rod", "needle", "disc"]
)
def test_released_spheroid_follows_equations_written_by_hand(size):
    far, angle, run = compared(problem_of(size), 2e-3)
    assert far < 1e-14
    assert angle < 1e-9
    assert run.steps < 60


def test_body_with_coupled_drag():
    far, angle, _ = compared(unequal(problem_of((4e-7, 8e-7))), 2e-3)
    assert far < 1e-13
    assert angle < 1e-9


def test_spinning_body_in_thin_gas():
    """Gyroscopic terms matter: it turns about five times while its velocities relax."""
    problem = unequal(problem_of((4e-7, 8e-7)), 1e-4)
    start = {"angular_velocity": [2e5, 5e4, -3e5]}
    problem = dataclasses.replace(problem, scene=problem.scene.replace(start=start))
    far, angle, run = compared(problem, 1e-4, "DOP853")
    assert far < 1e-13
    assert angle < 1e-8
    assert run.steps < 400


def test_free_top_keeps_energy_and_angular_momentum():
    problem = bound_once(scene_of((4e-7, 8e-7)).replace(
        start={"angular_velocity": [2e4, 5e3, -3e4]}, forces={"gravity": False, "buoyancy": False},
    ))  # fmt: skip
    problem = unequal(problem)
    problem = dataclasses.replace(
        problem, body=BodyMotion(1e-25 * problem.body.resistance, problem.body.inertia)
    )
    equations = bind(problem)
    times = np.linspace(0, 2e-2, 33)
    run = integrate(equations, times)
    assert run.status == "complete", run.message
    motion = equations.motion(times, run.states)
    tensor = problem.body.inertia[3:, 3:]
    momentum = motion.angular_velocity @ tensor
    energy = (momentum * motion.angular_velocity).sum(axis=1)
    turned = Rotation.from_quat(motion.orientation, scalar_first=True)
    in_laboratory = turned.apply(momentum)
    assert np.ptp(motion.angular_velocity[:, 0]) > 1e4  # it tumbles
    np.testing.assert_allclose(energy, energy[0], rtol=1e-8)
    np.testing.assert_allclose(
        in_laboratory, np.tile(in_laboratory[0], (33, 1)), atol=1e-8 * np.linalg.norm(momentum[0])
    )
    assert np.abs(np.linalg.norm(motion.orientation, axis=1) - 1).max() < 1e-15


def test_motion_without_inertia_is_the_limit_of_no_mass():
    problem = unequal(problem_of((4e-7, 8e-7)))
    light = BodyMotion(problem.body.resistance, 1e-6 * problem.body.inertia)
    still = problem.scene.replace(start={"velocity": [0, 0, 0]})
    times = np.linspace(0, 2e-3, 9)
    found = []
    for model, body in (("overdamped", problem.body), ("full", light)):
        scene = still.replace(simulation={"model": model})
        equations = bind(dataclasses.replace(problem, scene=scene, body=body))
        run = integrate(equations, times)
        assert run.status == "complete", run.message
        found.append(equations.motion(times, run.states))
    np.testing.assert_allclose(found[0].position, found[1].position, atol=1e-14)
    np.testing.assert_allclose(found[0].orientation, found[1].orientation, atol=1e-9)
    late = [each.angular_velocity[1:] for each in found]  # after the release from rest
    assert late[0] == pytest.approx(late[1], abs=1e-3, rel=1e-6)


def test_rod_in_a_real_trap_takes_a_quarter_of_the_calls_of_lsoda():
    scene = tweezer.load_scene("polystyrene-500nm").replace(
        bead={"shape": "spheroid", "diameter": "0.4 um", "length": "0.8 um"},
        start={"position": ["0.1 um", "0.05 um", "-0.1 um"], "orientation": [0.8, 0.5, 0.2, 0.1]},
        simulation={"model": "full", "method": "exponential"},
    )  # fmt: skip
    times = np.linspace(0, 4e-3, 11)
    exact = bind(bound_once(scene))
    truth = exact.motion(times, integrate(exact, times, tightened=1e-4).states)

    def angle(equations, states):
        e = equations.motion(times, states).orientation
        return 2 * np.linalg.norm(e - truth.orientation, axis=1).max()

    equations = bind(bound_once(scene))
    run = integrate(equations, times)
    ours = angle(equations, run.states)
    assert ours < 2e-9
    scale = np.array([1e-7] * 3 + [1.0] * 4 + [1e-3] * 3 + [1e3] * 3)
    other = solve_ivp(
        equations.rhs, (0, 4e-3), equations.initial_state, "LSODA", times, rtol=1e-9,
        atol=1e-9 * scale,
    )  # fmt: skip
    assert angle(equations, other.y.T) > ours  # so that LSODA would need more calls still
    assert run.force_calls < equations.force_calls / 4


def test_pair_of_two_densities_turns_its_heavy_sphere_down():
    """A pendulum without inertia: tan(angle/2) falls at the rate lift times lever over drag."""
    spheres = [
        {"radius": "1 um", "density": "1050 kg/m^3", "position": [0, 0, "-1 um"]},
        {"radius": "1 um", "density": "2000 kg/m^3", "position": [0, 0, "1 um"]},
    ]
    description = tweezer.load_scene("polystyrene-500nm").model_dump(exclude_none=True)
    index = description["bead"]["refractive_index"]
    description["bead"] = {
        "shape": "spheres", "density": "1500 kg/m^3",
        "spheres": [{"refractive_index": index, **each} for each in spheres],
    }  # fmt: skip
    angle = 0.3
    scene = tweezer.load_scene(description).replace(
        forces={"optical": False},
        start={"position": [0, 0, 0], "orientation": [np.cos(angle / 2), np.sin(angle / 2), 0, 0]},
        simulation={"model": "overdamped", "method": "exponential", **TIGHT, "loss_distance": 1},
    )
    gravity = scene.forces.gravitational_acceleration
    masses = 4 / 3 * np.pi * 1e-18 * np.array([1050.0, 2000.0])
    below = -masses @ [-1e-6, 1e-6] / masses.sum()  # of the centre of volume in the body
    lift = scene.medium.density * gravity * 2 * 4 / 3 * np.pi * 1e-18
    resistance = tweezer.resistance(scene).matrix
    mobility = np.linalg.inv(resistance)
    # the weight at the centre of mass turns it too, because that is not the centre of mobility
    weight = (masses.sum() - scene.medium.density * 2 * 4 / 3 * np.pi * 1e-18) * gravity
    rate = mobility[3, 3] * lift * below + mobility[3, 1] * weight
    equations = bind(bound_once(scene))
    times = np.linspace(0, 1.0, 5)
    run = integrate(equations, times)
    assert run.status == "complete", run.message
    axis = Rotation.from_quat(
        equations.motion(times, run.states).orientation, scalar_first=True
    ).apply([0, 0, 1])
    tilt = np.arctan2(np.hypot(axis[:, 0], axis[:, 1]), axis[:, 2])
    exact = 2 * np.arctan(np.tan(angle / 2) * np.exp(-rate * times))
    assert np.abs(tilt - angle).max() > 0.1
    np.testing.assert_allclose(tilt, exact, atol=1e-8)
