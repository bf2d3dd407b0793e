"""A scene bound to an emitted model: which one, its Jacobian, and what the integration returns."""

import itertools

import numpy as np
import pytest

import tweezer
from tweezer.dynamics import bind, integrate

ROTATIONS = {
    "no rotation": {},
    "sphere": {"beam": {"torque": "thesis"}, "start": {"angular_velocity": [2e4, -1e4, 3e4]}},
    "rigid body": {
        "beam": {"torque": "thesis"},
        "start": {"angular_velocity": [2e4, -1e4, 3e4]},
        "bead": {"moments_of_inertia": [4e-29, 5e-29, 6e-29]},
    },
}
METHODS = [
    "dormand-prince", "dop853", "exponential",
    "scipy:RK45", "scipy:DOP853", "scipy:Radau", "scipy:BDF", "scipy:LSODA",
]  # fmt: skip
MODELS = ("full", "scaled", "overdamped", "first-order")
STATES = ("angular-velocity", "euler-rates")


def bound(model, rotation, rotation_state, **simulation):
    changes = {section: dict(keys) for section, keys in ROTATIONS[rotation].items()}
    changes.setdefault("start", {}).update(
        frame="focus", position=[1e-7, -1.5e-7, 0.8e-7], velocity=[1e-3, 0, 2e-3],
        orientation=[0.5, -0.1, 0.7, 0.3],
    )  # fmt: skip
    changes["simulation"] = {"model": model, "rotation_state": rotation_state, **simulation}
    return bind(tweezer.load_scene("thesis-990nm").replace(**changes))


@pytest.mark.parametrize(
    ("model", "rotation", "rotation_state"), list(itertools.product(MODELS, ROTATIONS, STATES))
)
def test_the_smallest_model_that_holds_the_scene_is_bound(model, rotation, rotation_state):
    name = bound(model, rotation, rotation_state).name
    prefix = model.replace("-", "_")
    if rotation == "no rotation":
        assert name == f"{prefix}_translation"
    elif model == "overdamped":
        assert name == "overdamped_rotation"
    else:
        rates = "_euler_rates" if "euler" in rotation_state and model != "first-order" else ""
        assert name == f"{prefix}_{rotation.replace(' ', '_')}{rates}"


@pytest.mark.parametrize(
    "changes",
    [
        {"beam": {"torque": "thesis", "power": 0}},
        {"beam": {"torque": "thesis"}, "forces": {"optical": False}},
    ],
    ids=["no power", "light off"],
)
def test_darkness_turns_nothing(changes):
    bound = bind(tweezer.load_scene("thesis-990nm").replace(**changes))
    assert bound.name == "scaled_translation"
    assert repr(bound).splitlines()[:3] == [
        "EquationsOfMotion of thesis-990nm",
        "  model               scaled, emitted as scaled_translation",
        "  variables           q1, q2, q3, v1, v2, v3",
    ]


@pytest.mark.parametrize(
    ("model", "rotation", "rotation_state"), list(itertools.product(MODELS, ROTATIONS, STATES))
)
def test_jacobian_is_the_derivative_of_the_right_hand_side(model, rotation, rotation_state):
    """Central differences of the whole: emitted model and light."""
    equations = bound(model, rotation, rotation_state)
    y = equations.initial_state
    scale = np.abs(y) + equations.absolute_tolerance
    scale[:3] = 1e-7
    if "e0" in equations.module.STATE:
        scale[3:7] = 1.0
    jacobian = equations.jacobian(0.0, y) * scale
    differences = np.empty_like(jacobian)
    for i in range(len(y)):
        step = np.zeros_like(y)
        step[i] = 1e-5 * scale[i]
        differences[:, i] = (equations.rhs(0.0, y + step) - equations.rhs(0.0, y - step)) / 2e-5
    # each row against its own largest entry: rates differ by twenty powers of ten
    error = np.abs(jacobian - differences).max(axis=1) / np.abs(differences).max(axis=1)
    # the first-order model's second derivatives are themselves differences of a sum over a grid
    assert error.max() < (1e-3 if model == "first-order" else 1e-6)


def test_start_is_the_scene_s():
    for rotation_state in STATES:
        equations = bound("full", "rigid body", rotation_state)
        motion = equations.motion(np.zeros(1), equations.initial_state[None])
        np.testing.assert_allclose(motion.position[0], [1e-7, -1.5e-7, 0.8e-7])
        np.testing.assert_allclose(motion.velocity[0], [1e-3, 0, 2e-3])
        e = np.array([0.5, -0.1, 0.7, 0.3])
        np.testing.assert_allclose(motion.orientation[0], e / np.linalg.norm(e), rtol=1e-14)
        np.testing.assert_allclose(motion.angular_velocity[0], [2e4, -1e4, 3e4], rtol=1e-13)


def test_absolute_tolerances_follow_coordinates_and_rates():
    equations = bound("full", "sphere", "euler-rates", position_tolerance=3e-12,
                      orientation_tolerance=5e-9)  # fmt: skip
    expected = [3e-12] * 3 + [5e-9] * 4 + [3e-9] * 3 + [5e-6] * 4
    np.testing.assert_allclose(equations.absolute_tolerance, expected)


def test_tolerance_scales_all_tolerances():
    scene = tweezer.load_scene("thesis-990nm")
    run = tweezer.simulate(scene, duration="20 us", tolerance=1e-9)
    simulation = tweezer.scene_of(run).simulation
    assert simulation.relative_tolerance == 1e-9
    assert simulation.position_tolerance == pytest.approx(1e-13)
    assert simulation.orientation_tolerance == pytest.approx(1e-10)


@pytest.mark.parametrize("method", METHODS)
def test_every_sample_is_there_up_to_the_last(method):
    scene = tweezer.load_scene("thesis-990nm").replace(simulation={"samples": 7})
    run = tweezer.simulate(scene, duration="50 us", method=method)
    np.testing.assert_allclose(run["time"], np.linspace(0, 50e-6, 7), rtol=1e-14)
    assert run.attrs["status"] == "complete"


def test_moment_of_loss_is_located():
    """A heavy bead falls at its terminal velocity through the boundary, within one long step."""
    scene = tweezer.load_scene("thesis-990nm").replace(
        start={"frame": "focus", "position": [0, 0, 0]},
        forces={"optical": False},
        simulation={"model": "overdamped", "method": "scipy:DOP853", "loss_distance": "1 um",
                    "duration": 1.0, "samples": 11},
    )  # fmt: skip
    bead = tweezer.bead_properties(scene)
    crossing = 1e-6 * bead.drag / abs(bead.weight[2])
    run = tweezer.simulate(scene, duration=2.4 * crossing)
    assert run.attrs["status"] == "lost"
    assert float(run["time"][-1]) == pytest.approx(crossing, rel=1e-9)
    assert float(run["distance"][-1]) == pytest.approx(1e-6, rel=1e-9)
    assert len(run["time"]) == 6  # four samples after the start, and the moment of loss


def test_multistep_solvers_stay_near_the_constraint():
    """Their states are not put back after each step; their drift is within the tolerance."""
    for method in ("scipy:BDF", "scipy:LSODA"):
        equations = bound("full", "rigid body", "euler-rates", method=method)
        result = integrate(equations, np.linspace(0, 5e-6, 11))
        drift = np.abs(np.linalg.norm(result.states[:, 3:7], axis=1) - 1).max()
        assert drift < 1e-5
        motion = equations.motion(result.times, result.states)
        assert np.abs(np.linalg.norm(motion.orientation, axis=1) - 1).max() < 1e-12
