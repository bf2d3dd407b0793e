"""Thermal motion as a user meets it: `simulate`, its dataset, its file and the command line."""

import json

import numpy as np
import pytest
from typer.testing import CliRunner

import tweezer
from tweezer.cli import app
from tweezer.dynamics.walk import Walk, walk

SCENE = tweezer.load_scene("silica-1um").replace(
    forces={"brownian": True},
    optics={"evaluator": "map", "table_tolerance": 1e-4},
    simulation={"duration": "2 ms", "samples": 41},
)


@pytest.fixture(scope="module")
def run():
    return tweezer.simulate(SCENE, seed=3)


def test_a_run_is_trajectory_0_of_its_ensemble(run):
    bound = walk(SCENE, 3)
    states = bound.start(np.array([0]))
    out = np.empty((1, 40, 6))
    bound.advance(states, np.array([0]), 0, out)
    assert np.array_equal(run["position"].values[1:], out[0, :, :3])
    assert np.array_equal(run["velocity"].values[1:], out[0, :, 3:])


def test_the_seed_decides(run):
    again, other = tweezer.simulate(SCENE, seed=3), tweezer.simulate(SCENE, seed=4)
    assert np.array_equal(run["position"], again["position"])
    assert not np.array_equal(run["position"], other["position"])
    assert tweezer.simulate(SCENE).attrs["seed"] == 0


def test_a_run_says_what_it_is(run):
    assert run.attrs["status"] == "complete"
    assert run.attrs["model"] == "full"
    assert run.attrs["method"] == "heun"
    assert run.attrs["step"] * run.attrs["steps"] == pytest.approx(2e-3)
    assert run.attrs["force_calls"] == 2 * run.attrs["steps"]
    assert "exact drag" in run.attrs["chosen"]
    assert np.isnan(run.attrs["integration_error"])
    assert run["force_error"].max() > 0


def test_steps_divide_the_time_between_samples():
    for step in ("1 us", "3 us", "1 ms"):
        run = tweezer.simulate(SCENE.replace(simulation={"step": step}))
        per_sample = run.attrs["steps"] / 40
        assert per_sample == round(per_sample)
        assert run.attrs["step"] <= tweezer.values.units.to_si(step, "s", 0.0) * (1 + 1e-12)


def test_without_inertia_there_is_no_velocity():
    run = tweezer.simulate(SCENE, model="overdamped")
    assert not {"velocity", "speed", "kinetic_energy", "reynolds_number"} & set(run)
    assert {"position", "terminal_speed", "potential_energy", "force_error"} <= set(run)
    assert tweezer.summarise(run).largest_reynolds_number is None


def test_thermal_torque_turns_the_bead():
    scene = SCENE.replace(forces={"brownian_torque": True})
    for model in ("full", "overdamped"):
        run = tweezer.simulate(scene, model=model)
        lengths = np.linalg.norm(run["orientation"].values, axis=1)
        np.testing.assert_allclose(lengths, 1.0, atol=1e-14)
        assert ("angular_velocity" in run) == (model == "full")
        assert not np.array_equal(run["orientation"][0], run["orientation"][-1])


def test_a_scene_without_torque_carries_no_rotation(run):
    assert "orientation" not in run
    assert walk(SCENE).columns == ("x", "y", "z", "vx", "vy", "vz")


def test_a_lost_bead_ends_the_run():
    scene = SCENE.replace(
        beam={"power_through_pupil": "1 uW"},
        start={"position": [0, 0, "1 um"]},
        simulation={"loss_distance": "1.05 um", "duration": "1 s", "samples": 2001},
    )
    run = tweezer.simulate(scene, seed=1)
    assert run.attrs["status"] == "lost"
    assert run.sizes["time"] < 2001
    assert np.isfinite(run["position"]).all()


def test_an_interrupt_keeps_what_was_reached():
    def stop(time):
        raise KeyboardInterrupt

    scene = SCENE.replace(simulation={"step": "0.1 us", "duration": "50 ms", "samples": 501})
    run = tweezer.simulate(scene, progress=stop)
    assert run.attrs["status"] == "interrupted"
    assert 1 < run.sizes["time"] < 501
    assert np.isfinite(run["position"]).all()


def test_a_force_that_is_not_finite_fails_the_run(monkeypatch):
    from tweezer.values.errors import IntegrationError

    def fail(self, states, trajectories, sample, out):
        raise IntegrationError("trajectory 0: not finite")

    monkeypatch.setattr(Walk, "advance", fail)
    with pytest.warns(tweezer.PhysicsWarning, match="not finite"):
        run = tweezer.simulate(SCENE)
    assert run.attrs["status"] == "failed"
    assert run.sizes["time"] == 1


def test_a_run_ends_when_its_force_calls_are_spent():
    whole = tweezer.simulate(SCENE, seed=3)
    calls = whole.attrs["force_calls"]
    with pytest.warns(tweezer.PhysicsWarning, match="most_force_calls is reached"):
        run = tweezer.simulate(SCENE.replace(simulation={"most_force_calls": calls // 2}), seed=3)
    assert run.attrs["status"] == "failed"
    assert run.attrs["force_calls"] == calls // 2
    kept = run["position"].values
    assert np.array_equal(kept, whole["position"].values[: len(kept)])


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ({"tolerance": 1e-9}, "tolerance: cannot be combined with forces.brownian"),
        ({"seed": -1}, "seed = -1"),
        ({"method": "exponential"}, "does not compute thermal motion"),
    ],
)
def test_what_does_not_go_together_is_refused(arguments, said):
    with pytest.raises(tweezer.SceneError, match=said):
        tweezer.simulate(SCENE, **arguments)


def test_a_seed_without_thermal_motion_is_refused():
    with pytest.raises(tweezer.SceneError, match="seed"):
        tweezer.simulate(SCENE.replace(forces={"brownian": False}), seed=1)


def test_pylake_and_calibrate_find_the_stiffness_of_the_trap_in_a_run():
    """From force to trajectory to spectrum: within 4 uncertainties, but for one seed in 16,000."""
    from lumicks import pylake

    rate = 78125.0
    samples = 2**16 + 1
    run = tweezer.simulate(
        SCENE.replace(
            start={"drawn": "boltzmann"},
            simulation={"duration": (samples - 1) / rate, "samples": samples},
        ),
        seed=8,
    )
    trap = tweezer.characterise(SCENE).equilibrium
    ours = tweezer.calibrate(run)
    for axis in range(3):
        k = trap.stiffness[axis][axis]
        for method in ("power spectrum", "equipartition", "displacement", "autocorrelation"):
            found = ours.axes[axis][method]
            assert not found.caveat
            assert abs(found.stiffness - k) < 4 * found.uncertainty
        theirs = pylake.calibrate_force(
            run["position"].values[1:, axis] * 1e6, 2e6 * SCENE.bead.radius,
            SCENE.medium.temperature - 273.15, viscosity=SCENE.medium.viscosity, sample_rate=rate,
            fast_sensor=True, fit_range=(10, 8000), num_points_per_block=100,
        )  # fmt: skip
        assert abs(1e-3 * theirs.stiffness - k) < 4e-3 * theirs.stiffness_std_err


def test_command_line(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    arguments = [
        "run", "silica-1um", "--set", "forces.brownian=true", "--set", "simulation.samples=21",
        "--set", "start.drawn=boltzmann", "--model", "overdamped", "--duration", "1 ms",
        "--seed", "7", "--out", "a.nc", "--plot", "a.png",
    ]  # fmt: skip
    result = CliRunner().invoke(app, arguments)
    assert result.exit_code == 0, result.output
    assert "seed of the thermal motion" in result.output
    run = tweezer.load_run("a.nc")
    assert run.attrs["seed"] == 7
    assert json.loads(run.attrs["scene"])["start"]["drawn"] == "boltzmann"
    refused = CliRunner().invoke(app, ["run", "silica-1um", "--seed", "7"])
    assert "seed: requires forces.brownian" in str(refused.exception)
