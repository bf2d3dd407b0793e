"""Runs that go on from the end of an earlier one."""

import json

import numpy as np
import pytest

import tweezer
from tweezer import ResultError, SceneError

SCENE = tweezer.load_scene("silica-1um").replace(simulation={"duration": "0.2 ms", "samples": 101})
MOVING = tweezer.load_scene("moving-trap").replace(simulation={"duration": "4 ms", "samples": 101})
THERMAL = SCENE.replace(
    forces={"brownian": True},
    optics={"evaluator": "map", "table_tolerance": 1e-4},
    simulation={"duration": "1 ms", "samples": 21},
)
STEPWISE = SCENE.replace(simulation={"model": "overdamped", "method": "scipy:LSODA"})
OVERDAMPED = THERMAL.replace(simulation={"model": "overdamped"})


def twice(scene):
    """Return the scene of one run as long as two."""
    simulation = scene.simulation
    return scene.replace(
        simulation={"duration": 2 * simulation.duration, "samples": 2 * simulation.samples - 1}
    )


def stokes(scene):
    """6 pi eta R, kg/s."""
    return 6 * np.pi * scene.medium.viscosity * scene.bead.radius


@pytest.fixture(scope="module")
def first():
    return tweezer.simulate(SCENE)


@pytest.fixture(scope="module")
def thermal():
    return tweezer.simulate(THERMAL, seed=5)


@pytest.mark.parametrize(
    ("scene", "changes"),
    [
        (SCENE, {}),
        (SCENE, {"medium": {"inertia": "none"}, "simulation": {"model": "full"}}),
        (SCENE, {"simulation": {"model": "overdamped"}}),
        (SCENE, {"simulation": {"model": "overdamped", "method": "dormand-prince"}}),
        (SCENE, {"simulation": {"model": "overdamped", "method": "scipy:LSODA"}}),
        (MOVING, {}),
    ],
    ids=["memory", "inertia", "overdamped", "explicit", "scipy", "moving trap, memory"],
)
def test_two_halves_are_one_run_within_its_error(scene, changes):
    scene = scene.replace(**changes)
    whole, half = tweezer.simulate(twice(scene)), tweezer.simulate(scene)
    rest = tweezer.simulate(scene, continue_from=half)
    assert rest["time"].values == pytest.approx(whole["time"].values[100:], rel=1e-12)
    apart = np.abs(rest["position"].values - whole["position"].values[100:]).max()
    assert apart <= rest.attrs["integration_error"] + whole.attrs["integration_error"]
    assert apart > 0 or scene is SCENE
    assert rest.attrs["integration_error"] < 1e-10
    assert rest["velocity"].values == pytest.approx(whole["velocity"].values[100:], abs=3e-7)


def test_error_of_a_continued_run_has_that_of_the_earlier_one_in_it():
    # without a trap nothing pulls the bead back: a difference at the end of the first run stays
    scene = SCENE.replace(simulation={"relative_tolerance": 1e-3, "position_tolerance": "0.1 nm"})
    half = tweezer.simulate(scene)
    off = half.attrs["integration_error"]
    rest = tweezer.simulate(scene, duration="1 ns", continue_from=half)
    end = json.loads(half.attrs["end"])
    apart = np.subtract(end["at"]["state"][:3], end["finer"]["state"][:3])
    assert np.linalg.norm(apart) > 0
    assert 3 * np.linalg.norm(apart) <= rest.attrs["integration_error"] * (1 + 1e-6)
    assert rest.attrs["integration_error"] <= 1.01 * off


def test_a_bead_without_its_hidden_state_goes_another_way(first):
    """The memory matters in these runs: without it, the halves do not fit."""
    rest = tweezer.simulate(SCENE, continue_from=first)
    struck = first.copy()
    end = json.loads(first.attrs["end"])
    modes = np.array(end["at"]["inner"])
    velocity = end["at"]["state"][3:6]
    modes[3:] = np.repeat(velocity, (len(modes) - 3) // 3)
    end["at"]["inner"] = modes.tolist()
    struck.attrs["end"] = json.dumps(end)
    other = tweezer.simulate(SCENE, continue_from=struck)
    apart = np.abs(rest["position"].values - other["position"].values).max()
    assert apart > 30 * rest.attrs["integration_error"]


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"medium": {"inertia": "none"}},
        {"simulation": {"model": "overdamped"}},
        {"simulation": {"method": "one-call"}},
    ],
    ids=["memory", "inertia", "overdamped", "one call"],
)
def test_thermal_run_goes_on_bit_for_bit(changes):
    scene = THERMAL.replace(**changes)
    whole, half = tweezer.simulate(twice(scene), seed=5), tweezer.simulate(scene, seed=5)
    rest = tweezer.simulate(scene, continue_from=half)
    assert rest.attrs["seed"] == 5
    assert np.array_equal(rest["position"], whole["position"][20:])
    assert rest["time"].values == pytest.approx(whole["time"].values[20:], rel=1e-12)


def test_thermal_run_draws_new_numbers_in_other_light():
    """A trap ten times weaker needs fewer steps, whose count could begin in used numbers."""
    scene = OVERDAMPED.replace(simulation={"samples": 201, "duration": "4 ms"})
    weak = scene.replace(beam={"power": "1 mW"}, simulation={"duration": "4 ms"})
    half = tweezer.simulate(scene, seed=2)
    rest = tweezer.simulate(weak, continue_from=half)
    assert rest.attrs["step"] <= half.attrs["step"] * (1 + 1e-12)
    then, now = (np.diff(each["position"].values, axis=0) for each in (half, rest))
    correlation = (then * now).sum() / np.sqrt((then**2).sum() * (now**2).sum())
    assert abs(correlation) < 4 / np.sqrt(600)  # false alarm: 6e-5
    # <dx^2> = 2 D dt (1 - dt k/2 beta + ...) of a weak trap, to 4 standard errors of 400 numbers
    D = 1.380649e-23 * weak.medium.temperature / stokes(weak)
    interval = 4e-3 / 200
    assert (now[:, :2] ** 2).mean() == pytest.approx(2 * D * interval, rel=4 * np.sqrt(2 / 400))


def test_moments_of_a_chain_of_runs_are_those_of_the_trap():
    scene = OVERDAMPED.replace(simulation={"duration": "40 ms", "samples": 401})
    stiffness = np.diag(tweezer.characterise(scene).equilibrium.stiffness)
    run = tweezer.simulate(scene, seed=1)
    pieces = [run]
    for _ in range(4):
        run = tweezer.simulate(scene, continue_from=run)
        pieces.append(run)
    x = np.concatenate([each["position"].values[1:] for each in pieces])
    assert pieces[-1]["time"].values[-1] == pytest.approx(0.2)
    beta = stokes(scene)
    kT = 1.380649e-23 * scene.medium.temperature
    for axis in range(2):
        # 0.2 s hold 0.2/tau relaxation times; the variance has the relative error sqrt(2 tau/T)
        error = np.sqrt(2 * beta / stiffness[axis] / 0.2)
        late = x[50:, axis]
        assert np.var(late) == pytest.approx(kT / stiffness[axis], rel=4 * error + 0.01)


def test_finished_run_can_be_saved_and_continued(thermal, tmp_path):
    path = tweezer.save_run(thermal, tmp_path / "run.nc")
    rest = tweezer.simulate(THERMAL, continue_from=path)
    again = tweezer.simulate(THERMAL, continue_from=thermal)
    assert np.array_equal(rest["position"], again["position"])
    more = tweezer.simulate(THERMAL, "0.5 ms", continue_from=rest)
    assert more["time"].values[[0, -1]] == pytest.approx([2e-3, 2.5e-3])
    assert len(more["time"]) == 11


@pytest.mark.parametrize("scene", [STEPWISE, OVERDAMPED], ids=["no noise", "thermal"])
def test_interrupted_run_goes_on(scene, monkeypatch):
    monkeypatch.setattr("tweezer.runs.simulation._STEPS_AT_ONCE", 1)
    whole = tweezer.simulate(scene)

    def stop(time):
        if time > 0.3 * scene.simulation.duration:
            raise KeyboardInterrupt

    part = tweezer.simulate(scene, progress=stop)
    assert part.attrs["status"] == "interrupted"
    left = scene.simulation.duration - float(part["time"][-1])
    rest = tweezer.simulate(scene, left, continue_from=part)
    assert rest["time"].values[-1] == pytest.approx(scene.simulation.duration)
    before = len(part["time"]) - 1
    assert before + len(rest["time"]) == len(whole["time"])
    apart = np.abs(rest["position"].values - whole["position"].values[before:]).max()
    assert apart <= (0 if scene is OVERDAMPED else 3 * whole.attrs["integration_error"])
    assert np.isnan(rest.attrs["integration_error"])


def test_summary_of_a_continued_run_is_by_its_path(first):
    """The bead falls into the trap in the second part."""
    rest = tweezer.simulate(SCENE, "1 ms", continue_from=first)
    summary = tweezer.summarise(rest)
    assert not summary.by_samples
    assert summary.outcome == "captured"
    whole = tweezer.summarise(tweezer.simulate(SCENE, "1.2 ms"))
    errors = summary.outcome_time_error + whole.outcome_time_error
    assert abs(summary.outcome_time - whole.outcome_time) <= errors < 1e-6
    assert tweezer.summarise(rest.isel(time=slice(1, None))).by_samples


def test_light_may_change(first):
    """A bead that goes on in the dark stops; with its memory it does not stop at once."""
    dark = SCENE.replace(beam={"power": "1 nW"})
    rest = tweezer.simulate(dark, continue_from=first)
    assert np.array_equal(rest["position"][0], first["position"][-1])
    assert np.linalg.norm(rest["velocity"][-1]) < 0.1 * np.linalg.norm(rest["velocity"][0])


def test_closest_approach_is_the_first_of_both(first):
    assert "closest approach" not in first.attrs["events"]
    events = [json.loads(first.attrs["events"])]
    run = first
    for _ in range(3):
        run = tweezer.simulate(SCENE, "3 ms", continue_from=run)
        events.append(json.loads(run.attrs["events"]))
    assert sum(each["name"] == "closest approach" for every in events for each in every) <= 1


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"bead": {"radius": "0.4 um"}}, "bead.radius = 4e-07: differs"),
        ({"medium": {"viscosity": "2 mPa s"}}, "medium.viscosity = 0.002: differs"),
        ({"start": {"position": ["1 um", 0, 0]}}, "start.position"),
        ({"simulation": {"model": "overdamped"}}, "simulation.model = overdamped: differs"),
        ({"forces": {"brownian": True}}, "forces.brownian = True: differs"),
        ({"camera": {"rate": "10 kHz"}}, "camera: this scene has one"),
        ({"start": {"angular_velocity": [1.0, 0, 0]}}, "start.angular_velocity"),
    ],
)
def test_what_a_state_depends_on_must_be_the_same(first, changes, told):
    with pytest.raises(SceneError, match=told.replace(".", r"\.")):
        tweezer.simulate(SCENE.replace(**changes), continue_from=first)


def test_memory_of_thermal_motion_belongs_to_its_trap(thermal):
    with pytest.raises(SceneError, match="hidden variables of the fluid's memory"):
        tweezer.simulate(THERMAL.replace(beam={"power": "10 mW"}), continue_from=thermal)


def test_runs_that_cannot_go_on(first, thermal):
    with pytest.raises(ResultError, match=r"samples are missing; the run ends at 0.0002 s"):
        tweezer.simulate(SCENE, continue_from=first.isel(time=slice(0, 50)))
    old = first.copy()
    del old.attrs["end"]
    with pytest.raises(ResultError, match="compute it again"):
        tweezer.simulate(SCENE, continue_from=old)
    for status in ("lost", "failed"):
        other = thermal.copy()
        other.attrs |= {"status": status, "message": "because"}
        with pytest.raises(ResultError, match="because; "):
            tweezer.simulate(THERMAL, continue_from=other)


def test_command_continues_a_file(command_line, tmp_path):
    settings = "--set", "simulation.samples=101"
    assert command_line("run", "silica-1um", "--duration", "0.2 ms", *settings).code == 0
    before = (tmp_path / "silica-1um.nc").read_bytes()
    onward = "run", "silica-1um", "--continue-from", "silica-1um.nc", "--duration", "0.1 ms"
    done = command_line(*onward)
    assert done.code == 0, done.err
    assert "0.2 ms after the release" in done.out
    rest = tweezer.load_run("silica-1um-2.nc")
    assert rest["time"].values[[0, -1]] == pytest.approx([2e-4, 3e-4])
    assert len(rest["time"]) == 51
    assert (tmp_path / "silica-1um.nc").read_bytes() == before
    refused = command_line(*onward, "--out", "silica-1um.nc")
    assert refused.code == 2
    assert "already holds a run from another beginning" in refused.err
    missing = command_line("run", "silica-1um", "--continue-from", "x.nc")
    assert (missing.code, missing.err) == (2, "x.nc: no such file\n")


def test_command_continues_the_scene_of_a_file(command_line):
    """The power that --set changed applies again; scenes of both parts are as given."""
    settings = "--duration", "0.2 ms", "--set", "simulation.samples=101"
    begun = command_line("run", "silica-1um", *settings, "--set", "beam.power=10 mW")
    assert begun.code == 0, begun.err
    named = "run", "silica-1um", *settings, "--set", "beam.power=10 mW", "--out", "named.nc"
    onward = "--continue-from", "silica-1um.nc"
    for done in (command_line("run", *onward), command_line(*named, *onward)):
        assert done.code == 0, done.err
    ours, theirs = tweezer.load_run("silica-1um-2.nc"), tweezer.load_run("named.nc")
    assert ours.attrs["scene_as_given"] == tweezer.load_run("silica-1um.nc").attrs["scene_as_given"]
    assert ours["time"].values[[0, -1]] == pytest.approx([2e-4, 4e-4])
    assert ours["position"].values.tolist() == theirs["position"].values.tolist()
    without = command_line("run")
    assert (without.code, without.err) == (
        2, "Missing argument SCENE: required without --continue-from\n"
    )  # fmt: skip
    missing = command_line("run", "--continue-from", "x.nc")
    assert (missing.code, missing.err) == (2, "x.nc: no such file\n")
