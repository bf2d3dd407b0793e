"""Events of thermal motion, by the ends of steps that a run with a sample a step shows."""

import json
import math

import numpy as np
import pytest

import tweezer
from tweezer import Event, SceneError

FREE = tweezer.load_scene("silica-1um").replace(
    forces={"brownian": True, "optical": False, "gravity": False, "buoyancy": False},
    start={"position": [0, 0, 0]},
    simulation={"model": "overdamped", "step": "10 us", "duration": "10 ms", "samples": 11},
)
EVERY = FREE.replace(simulation={"samples": 1001})
PLANE = 5e-8


def plane(**how):
    return Event("plane", lambda _, y: y[:, 0] - PLANE, **how)


@pytest.fixture(scope="module")
def steps():
    """Return times and positions of the same motion, with a sample for each step."""
    run = tweezer.simulate(EVERY, seed=6)
    return run["time"].values, run["position"].values


def test_crossings_are_where_straight_lines_cross(steps):
    times, x = steps[0], steps[1][:, 0] - PLANE
    changed = np.flatnonzero(np.sign(x[1:]) != np.sign(x[:-1]))
    expected = times[changed] + np.diff(times)[changed] * x[changed] / (x[changed] - x[changed + 1])
    run = tweezer.simulate(FREE, seed=6, events=[plane()])
    found = [each["time"] for each in json.loads(run.attrs["events"])]
    assert len(found) > 3
    assert found == pytest.approx(expected, rel=1e-9)
    assert run.attrs["event_resolution"] == pytest.approx(1e-5)
    assert np.array_equal(run["position"], steps[1][::100])  # to look changes nothing


def test_terminal_event_ends_the_run_there(steps):
    first = tweezer.simulate(FREE, seed=6, events=[plane(once=True)])
    run = tweezer.simulate(FREE, seed=6, events=[plane(terminal=True)])
    (event,) = json.loads(run.attrs["events"])
    assert event == json.loads(first.attrs["events"])[0]
    assert run.attrs["status"] == "ended"
    assert run.attrs["message"] == f"plane at {event['time']:.6g} s"
    assert run["time"].values[-1] == event["time"]
    assert run["position"].values[-1, 0] == pytest.approx(PLANE, rel=1e-9)
    assert np.array_equal(run["position"][:-1], steps[1][: 100 * (len(run["time"]) - 1) : 100])
    with pytest.raises(tweezer.ResultError, match="ended by an event"):
        tweezer.simulate(FREE, continue_from=run)


def test_capture_must_last(steps):
    """Within 60 nm for 0.5 ms: the first stretch of steps that lasts."""
    times, x = steps
    inside = np.linalg.norm(x, axis=1) < 6e-8
    run = tweezer.simulate(FREE, seed=6, events=[tweezer.capture("60 nm", "0.3 ms")])
    events = json.loads(run.attrs["events"])
    begins = [i for i in range(len(inside)) if inside[i : i + 31].all()][:1]
    assert len(events) == len(begins) == 1
    assert events[0]["time"] == pytest.approx(times[begins[0]], abs=1.001e-5)


def test_first_passage_is_late_by_the_law_of_looking_at_steps():
    """For a free bead the plane is further by 0.5826 sqrt(2 D h), with P = erfc(a/sqrt(4 D t))."""
    scene = FREE.replace(simulation={"step": "0.2 ms", "duration": "10 ms", "samples": 2})
    D = 1.380649e-23 * scene.medium.temperature
    D /= 6 * math.pi * scene.medium.viscosity * scene.bead.radius
    passed = 0
    many = 300
    for seed in range(many):
        run = tweezer.simulate(scene, seed=seed, events=[plane(terminal=True)])
        passed += run.attrs["status"] == "ended"
    farther = PLANE + 0.5826 * math.sqrt(2 * D * 2e-4)
    law, exact = (math.erfc(a / math.sqrt(4 * D * 1e-2)) for a in (farther, PLANE))
    spread = math.sqrt(law * (1 - law) / many)
    assert abs(passed / many - law) < 4 * spread  # false alarm: 6e-5
    assert exact - law > spread


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"camera": {"rate": "1 kHz"}}, "events: cannot be combined with a camera"),
        ({"simulation": {"method": "one-call"}}, "with events allowed: heun"),
    ],
)
def test_events_that_cannot_be_seen_are_refused(changes, told):
    with pytest.raises(SceneError, match=told):
        tweezer.simulate(FREE.replace(**changes), events=[plane()])
