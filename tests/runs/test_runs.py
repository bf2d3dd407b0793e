"""Derived quantities by formulas typed anew, and the summary of trajectories made up here."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
import xarray as xr
from scipy.optimize import brentq

import tweezer
from tweezer.runs import summarise

RADIUS = 0.495e-6
MASS = 1050 * 4 / 3 * math.pi * RADIUS**3
DRAG = 6 * math.pi * 1.002e-3 * RADIUS
WEIGHT = -(1050 - 998.2071) * 4 / 3 * math.pi * RADIUS**3 * 9.80665
ROUNDING = 1e-12


def length(vectors: xr.DataArray) -> np.ndarray:
    return np.array([math.hypot(*vector) for vector in vectors.values])


def test_distance_and_speed(turning_run):
    np.testing.assert_allclose(
        turning_run["distance"], length(turning_run["position"]), rtol=ROUNDING
    )
    np.testing.assert_allclose(turning_run["speed"], length(turning_run["velocity"]), rtol=ROUNDING)
    assert turning_run["distance"][0] == pytest.approx(math.hypot(2.045e-6, 4.05e-6), rel=1e-9)


def test_reynolds_number_is_5_1(turning_run):
    expected = 998.2071 * length(turning_run["velocity"]) * 2 * RADIUS / 1.002e-3
    np.testing.assert_allclose(turning_run["reynolds_number"], expected, rtol=ROUNDING)
    assert 1e-9 < turning_run["reynolds_number"].max() < 1e-3


def test_net_force_is_light_gravity_and_buoyancy(turning_run, turning_scene):
    light = tweezer.optical_force(turning_scene, turning_run["position"].values)
    np.testing.assert_array_equal(turning_run["optical_force"], light)
    np.testing.assert_allclose(
        turning_run["net_force"], light + np.array([0, 0, WEIGHT]), rtol=ROUNDING, atol=1e-26
    )
    assert np.abs(light).max() > 10 * abs(WEIGHT)


def test_terminal_speed_is_5_2(turning_run):
    expected = length(turning_run["net_force"]) / DRAG
    np.testing.assert_allclose(turning_run["terminal_speed"], expected, rtol=ROUNDING)
    np.testing.assert_allclose(turning_run["speed"][5:], expected[5:], rtol=0.02)


def test_energies(turning_run):
    moment = 2 / 5 * MASS * RADIUS**2
    speed, spin = length(turning_run["velocity"]), length(turning_run["angular_velocity"])
    kinetic = MASS * speed**2 / 2 + moment * spin**2 / 2
    potential = -WEIGHT * turning_run["position"].values[:, 2]
    np.testing.assert_allclose(turning_run["kinetic_energy"], kinetic, rtol=ROUNDING)
    np.testing.assert_allclose(turning_run["potential_energy"], potential, rtol=ROUNDING)
    np.testing.assert_allclose(turning_run["total_energy"], kinetic + potential, rtol=ROUNDING)
    of_rotation = moment * spin[0] ** 2 / 2
    assert 0 < of_rotation == pytest.approx(kinetic[0], rel=ROUNDING)


@pytest.mark.parametrize(
    ("forces", "weight"),
    [
        ({"gravity": False}, 998.2071),
        ({"buoyancy": False}, -1050),
        ({"gravity": False, "buoyancy": False}, 0),
        ({"gravitational_acceleration": -9.80665}, 1050 - 998.2071),
    ],
    ids=["no gravity", "no buoyancy", "neither", "light downwards"],
)
def test_forces_that_are_off_do_not_act(turning_scene, forces, weight):
    scene = turning_scene.replace(
        forces={"optical": False, **forces}, simulation={"samples": 2, "duration": 1e-6}
    )
    run = tweezer.simulate(scene)
    volume = 4 / 3 * math.pi * RADIUS**3
    np.testing.assert_array_equal(run["optical_force"], 0.0)
    np.testing.assert_allclose(
        run["net_force"][-1], [0, 0, weight * volume * 9.80665], rtol=ROUNDING
    )


def trajectory(times: np.ndarray, position: np.ndarray, status: str = "complete") -> xr.Dataset:
    """Make what `summarise` reads of a run of the 990 nm bead."""
    return xr.Dataset(
        {
            "position": (("time", "axis"), position),
            "distance": ("time", np.linalg.norm(position, axis=1)),
            "reynolds_number": ("time", np.linspace(2e-4, 1e-5, len(times))),
        },
        coords={"time": times},
        attrs={
            "status": status,
            "scene": tweezer.load_scene("thesis-990nm").model_dump_json(exclude_none=True),
        },
    )


@pytest.fixture(scope="module")
def rest() -> float:
    """Distance of the 990 nm bead's equilibrium behind the focus, m."""
    scene = tweezer.load_scene("thesis-990nm")
    return brentq(lambda z: tweezer.optical_force(scene, [0, 0, z])[2] + WEIGHT, 0, 3e-7)


@pytest.fixture
def ringing(rest) -> xr.Dataset:
    """Let 2 um exp(-t/ms) cos(pi t/ms) ring along the diagonal of x and y, for 10 ms."""
    times = np.linspace(0, 10e-3, 10_001)
    lateral = 2e-6 * np.exp(-times / 1e-3) * np.cos(np.pi * times / 1e-3)
    diagonal = np.array([1.0, -1.0, 0.0]) / math.sqrt(2)
    return trajectory(times, lateral[:, None] * diagonal + [0, 0, rest])


def test_overshoot_is_the_farthest_beyond_the_axis(ringing):
    turn = math.pi - math.atan(1 / math.pi)
    expected = -2e-6 * math.exp(-turn / math.pi) * math.cos(turn)
    assert summarise(ringing).overshoot == pytest.approx(expected, rel=1e-5)


def test_closest_approach_is_the_first_of_several(ringing, rest):
    summary = summarise(ringing)
    assert summary.closest_approach_time == pytest.approx(0.5e-3, abs=1e-9)
    assert summary.closest_approach == pytest.approx(rest, rel=1e-5)


def test_captured_from_when_on_it_stays_within_a_tenth_of_a_radius(ringing):
    summary = summarise(ringing)
    times = ringing["time"].values
    away = np.linalg.norm(ringing["position"] - ringing["position"][-1], axis=1) > RADIUS / 10
    last_away = max(time for time, far in zip(times, away, strict=True) if far)
    assert summary.outcome == "captured"
    assert summary.outcome_time == pytest.approx(last_away + 1e-6, abs=1e-12)
    envelope = 1e-3 * math.log(2e-6 / (RADIUS / 10))
    assert envelope - 1e-3 < summary.outcome_time < envelope
    assert summary.end == tuple(ringing["position"].values[-1])
    assert summary.largest_reynolds_number == 2e-4


def test_at_rest_from_the_start_is_captured_at_once(rest):
    times = np.linspace(0, 1e-3, 5)
    summary = summarise(trajectory(times, np.tile([1e-8, 1e-8, rest], (5, 1))))
    assert (summary.outcome, summary.outcome_time) == ("captured", 0.0)


def test_thermal_motion_is_captured_when_it_first_arrives():
    """A trap whose thermal spread along z is above a tenth of the radius: the bead leaves that
    neighbourhood again and again, and where it ends is chance. It arrives about when it does
    without noise: some trap times, 0.15 ms, from 0.9 um off.
    """
    scene = tweezer.load_scene("silica-1um").replace(
        forces={"brownian": True}, optics={"evaluator": "map"},
        beam={"power_through_pupil": "4 mW"},
    )  # fmt: skip
    run = tweezer.simulate(scene, duration="100 ms", seed=3)
    radius = scene.bead.radius
    z = run["position"].sel(axis="z").values
    assert z[len(z) // 2 :].std() > radius / 20
    summary = summarise(run)
    assert summary.outcome == "captured"
    still = tweezer.simulate(scene.replace(forces={"brownian": False}), duration="100 ms")
    assert summary.outcome_time == pytest.approx(summarise(still).outcome_time, rel=0.5)


@pytest.mark.parametrize(("radii", "outcome"), [(0.11, "not captured"), (0.09, "captured")])
def test_captured_only_within_a_tenth_of_a_radius_of_the_equilibrium(radii, outcome, rest):
    times = np.linspace(0, 1e-3, 11)
    position = np.linspace([1e-6, 0, -1e-6], [radii * RADIUS, 0, rest], 11)
    assert summarise(trajectory(times, position)).outcome == outcome


@pytest.mark.parametrize(("steps", "error"), [(30, 1e-3), (1, 1.0)])
def test_the_time_of_capture_does_not_depend_on_the_end_of_the_run(steps, error, monkeypatch):
    """Even if the run ends where the bead has hardly come near. One step of Newton's method is not
    enough to find the equilibrium; then the error says so.
    """
    scene = tweezer.load_scene("silica-1um")
    whole = summarise(tweezer.simulate(scene))
    monkeypatch.setattr("tweezer.runs.summary._STEPS", steps)
    soon = summarise(tweezer.simulate(scene, duration=1.01 * whole.outcome_time))
    assert soon.outcome == "captured"
    errors = soon.outcome_time_error + whole.outcome_time_error
    assert abs(soon.outcome_time - whole.outcome_time) < errors < error * whole.outcome_time


@pytest.mark.parametrize(("duration", "outcome"), [("3 ms", "complete"), ("8 ms", "captured")])
def test_capture_is_told_once_the_trap_is_at_rest(duration, outcome):
    """The trap is dragged until 4 ms; its axis goes with it."""
    summary = summarise(tweezer.simulate(tweezer.load_scene("moving-trap"), duration=duration))
    assert summary.outcome == outcome
    assert ("capture is not told" in repr(summary)) == (outcome == "complete")
    assert math.isnan(summary.overshoot)
    assert "overshoot" not in repr(summary)
    if outcome == "captured":
        assert 4e-3 < summary.outcome_time < 8e-3


@pytest.mark.parametrize(
    ("name", "changes"),
    [
        ("thesis-500nm", {"simulation": {"loss_distance": "20 um"}}),
        ("silica-1um", {"bead": {"refractive_index": 1.2}, "simulation": {"duration": "50 ms"}}),
        ("silica-1um", {"beam": {"power_through_pupil": 0}, "forces": {"gravity": False}}),
    ],
    ids=["carried out of the trap", "repelled", "in the dark"],
)
def test_a_bead_far_from_any_equilibrium_is_not_captured(name, changes):
    """Small forces alone are no capture: outside the light there are none."""
    run = tweezer.simulate(tweezer.load_scene(name).replace(**changes))
    assert summarise(run).outcome == "not captured"


def test_a_bead_released_in_the_trap_is_captured():
    scene = tweezer.load_scene("silica-1um").replace(start={"position": [0, 0, 0]})
    assert summarise(tweezer.simulate(scene, duration="1 ms")).outcome == "captured"


@pytest.mark.parametrize("status", ["lost", "interrupted", "failed"])
def test_a_run_that_ended_early_says_so(status):
    times = np.linspace(0, 1e-3, 11)
    position = np.linspace([0, 1e-6, 0], [0, 1e-6, 6e-6], 11)
    summary = summarise(trajectory(times, position, status))
    assert (summary.outcome, summary.outcome_time) == (status, 1e-3)


@pytest.mark.parametrize("end", [[0, 1.5e-6, -2e-6], [0, 6e-6, -8e-6]], ids=["nearing", "leaving"])
def test_without_a_minimum_there_is_no_closest_approach(end):
    times = np.linspace(0, 1e-3, 11)
    position = np.linspace([0, 3e-6, -4e-6], end, 11)
    summary = summarise(trajectory(times, position))
    assert summary.closest_approach is None
    assert summary.closest_approach_time is None
    assert summary.overshoot == 0.0


def test_closest_approach_after_an_excursion():
    """The distance rises first, falls, and rises again."""
    times = np.linspace(0, 1e-3, 301)
    distance = 2e-6 + 1e-6 * np.sin(3 * np.pi * times / 1e-3)
    position = np.outer(distance, [0, 0, 1])
    summary = summarise(trajectory(times, position))
    assert summary.closest_approach == pytest.approx(1e-6)
    assert summary.closest_approach_time == pytest.approx(0.5e-3)


def test_energy_of_a_rigid_body_takes_each_moment_about_its_own_axis(turning_scene):
    moments = np.array([2.0, 3.0, 4.0]) * 1e-29
    scene = turning_scene.replace(
        bead={"moments_of_inertia": list(moments)},
        start={"angular_velocity": [1e5, 2e5, 4e5]},
        beam={"torque": "none"},
        simulation={"samples": 3, "duration": 1e-9},
    )
    run = tweezer.simulate(scene)
    of_rotation = (moments * run["angular_velocity"].values ** 2).sum(axis=1) / 2
    of_translation = MASS * length(run["velocity"]) ** 2 / 2
    np.testing.assert_allclose(run["kinetic_energy"], of_rotation + of_translation, rtol=1e-9)


def test_a_bead_on_the_axis_does_not_overshoot():
    times = np.linspace(0, 1e-3, 11)
    position = np.linspace([0, 0, -4e-6], [0, 0, 2e-6], 11)
    assert summarise(trajectory(times, position)).overshoot == 0.0


def test_a_run_of_a_single_sample_has_a_summary():
    summary = summarise(trajectory(np.zeros(1), np.ones((1, 3)) * 1e-6, "failed"))
    assert (summary.outcome, summary.outcome_time) == ("failed", 0.0)
    assert summary.closest_approach is None


def test_a_real_run_that_leaves_the_trap_is_lost(turning_scene):
    scene = turning_scene.replace(
        beam={"torque": "none"},
        start={"frame": "focus", "position": [0, 0, 5e-6], "angular_velocity": [0, 0, 0]},
        forces={"gravitational_acceleration": -1e4},
        simulation={"loss_distance": "5.1 um", "duration": 20e-3, "samples": 2001},
    )
    run = tweezer.simulate(scene)
    summary = summarise(run)
    assert run.attrs["status"] == summary.outcome == "lost"
    assert 0 < summary.outcome_time < 20e-3
    assert run["time"].size < 2001


TOLD = [
    field.name
    for field in dataclasses.fields(tweezer.Summary)
    if field.name.endswith("_error") and field.name not in ("force_error", "smallest_gap_error")
]


@pytest.fixture(scope="module")
def thinly_sampled() -> xr.Dataset:
    """Follow a bead with inertia past the focus, with 21 samples."""
    scene = tweezer.load_scene("silica-1um").replace(
        simulation={"model": "scaled", "scaling_factor": 1e-3, "duration": "10 ms", "samples": 21}
    )
    return tweezer.simulate(scene)


def test_the_summary_does_not_depend_on_the_samples(thinly_sampled):
    """Nor on how long the bead is followed after it has come to rest, within the errors told."""
    few = summarise(thinly_sampled)
    assert not few.by_samples
    assert few.overshoot > 1e-9
    scene = tweezer.results.io.scene_of(thinly_sampled)
    many = summarise(tweezer.simulate(scene.replace(simulation={"samples": 2001})))
    assert dataclasses.replace(many, end=few.end) == few
    longer = summarise(tweezer.simulate(scene, duration="20 ms"))
    for told in TOLD:
        name = told.removesuffix("_error")
        allowed = getattr(few, told) + getattr(longer, told)
        assert abs(getattr(longer, name) - getattr(few, name)) <= allowed, name


def test_the_summary_is_as_near_to_the_truth_as_it_says(thinly_sampled):
    """Against the same motion to 1e-4 of the tolerances, on 200,001 samples."""
    found, scene = summarise(thinly_sampled), tweezer.results.io.scene_of(thinly_sampled)
    run = tweezer.simulate(scene.replace(simulation={"samples": 200_001}), tolerance=1e-11)
    position, times = run["position"].values, run["time"].values
    distance = np.linalg.norm(position, axis=1)
    nearest = int(np.argmax(np.diff(distance) > 0))
    rest = tweezer.characterise(scene).equilibrium.position
    away = np.linalg.norm(position - rest, axis=1) > 0.1 * scene.bead.radius
    start = position[0, :2] / np.linalg.norm(position[0, :2])
    spacing = times[1]
    fastest = float(run["speed"].max())
    for value, error, truth, resolved in (
        (found.largest_reynolds_number, found.largest_reynolds_number_error,
         float(run["reynolds_number"].max()), 0.0),
        (found.overshoot, found.overshoot_error, -(position[:, :2] @ start).min(), 0.0),
        (found.closest_approach, found.closest_approach_error, distance[nearest],
         spacing * fastest),
        (found.closest_approach_time, found.closest_approach_time_error, times[nearest], spacing),
        (found.outcome_time, found.outcome_time_error, times[np.flatnonzero(away)[-1]], spacing),
    ):  # fmt: skip
        assert abs(value - truth) <= error + resolved + 1e-6 * abs(truth)
        assert error < 0.01 * abs(truth)


def test_an_interrupt_of_the_summary_leaves_the_run(turning_scene, monkeypatch):
    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr("tweezer.runs.simulation.summary_of_path", interrupted)
    run = tweezer.simulate(turning_scene, duration=1e-6)
    assert run.attrs["status"] == "complete"
    assert summarise(run).by_samples


@pytest.mark.parametrize("error", ["force_errors", "model_error"])
def test_an_interrupt_of_an_error_leaves_the_run_and_its_summary(turning_scene, monkeypatch, error):
    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(f"tweezer.runs.simulation.{error}", interrupted)
    run = tweezer.simulate(turning_scene, duration=1e-6)
    assert run.attrs["status"] == "complete"
    assert np.isnan(run.attrs["model_error"])
    assert np.isnan(run["force_error"]).all() == (error == "force_errors")
    assert not summarise(run).by_samples


def test_a_saved_run_has_the_same_summary(thinly_sampled, tmp_path):
    """One without it, as older versions wrote them, says that its numbers are of the samples."""
    saved = tweezer.load_run(tweezer.save_run(thinly_sampled, tmp_path / "run.nc"))
    assert summarise(saved) == summarise(thinly_sampled)
    for part in (slice(5), slice(1, None)):  # not that of the whole run
        assert summarise(saved.isel(time=part)).by_samples
    del saved.attrs["summary"]
    of_samples = summarise(saved)
    assert of_samples.by_samples
    assert [getattr(of_samples, told) for told in TOLD] == [None] * len(TOLD)
    assert of_samples.overshoot < summarise(thinly_sampled).overshoot
