"""Events of poses: capture in orientation and flips, against closed forms and dense samples."""

import json
import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import tweezer
from tweezer import SceneError
from tweezer.dynamics import bind

DARK = tweezer.load_scene("silica-1um").replace(
    forces={"optical": False, "gravity": False, "buoyancy": False}, start={"position": [0, 0, 0]}
)
#: Spins about y at first, so that its z axis turns towards x
SPUN = DARK.replace(
    start={"angular_velocity": [0, 4e8, 0]},
    simulation={"model": "full", "method": "auto", "duration": "2 us", "samples": 11},
)
ROD = {"shape": "spheroid", "diameter": "0.2 um", "length": "0.4 um"}
FREE_ROD = DARK.replace(
    bead=ROD, forces={"brownian": True}, beam={"power_through_pupil": 0},
    simulation={"model": "overdamped", "step": "10 us", "duration": "100 ms", "samples": 10001},
)  # fmt: skip


def events_of(run):
    return json.loads(run.attrs["events"])


def along(run, axis=(0.0, 0.0, 1.0)):
    """Return the directions of an axis of the body at the samples."""
    return Rotation.from_quat(run["orientation"].values, scalar_first=True).apply(axis)


@pytest.mark.parametrize("state", ["angular-velocity", "euler-rates"])
def test_flips_of_a_sphere_whose_spin_decays(state):
    """The angle is w tau (1 - exp(-t/tau)), whatever the layout of the state."""
    scene = SPUN.replace(simulation={"rotation_state": state})
    tau = bind(scene).problem.bead.moments_of_inertia[1] * tweezer.resistance(scene).mobility[4, 4]
    most = 4e8 * tau
    run = tweezer.simulate(scene, events=[tweezer.flip(angle="50 deg")])
    found = [each for each in events_of(run) if each["name"] == "flip"]
    arrivals = np.radians([130, 310, 490, 670, 850, 1030])
    arrivals = arrivals[arrivals < most * (1 - math.exp(-2e-6 / tau))]
    assert len(arrivals) >= 3
    expected = -tau * np.log(1 - arrivals / most)
    assert [each["time"] for each in found] == pytest.approx(expected, rel=1e-6)
    for k, each in enumerate(found):
        z = Rotation.from_quat(each["orientation"], scalar_first=True).apply([0, 0, 1])
        side = -1 if k % 2 == 0 else 1
        assert z[2] == pytest.approx(side * math.cos(math.radians(50)), rel=1e-6)


def counted(cosines, least):
    """Return the samples at which a cosine arrives at the other end, by a loop over them."""
    end, found = 0, []
    for i, c in enumerate(cosines):
        now = 1 if c > least else -1 if c < -least else 0
        if now and now != end:
            if end:
                found.append(i)
            end = now
    return found


@pytest.mark.parametrize("model", ["overdamped", "full"])
def test_flips_of_a_rod_in_thermal_motion(model):
    """Events are located within the step that the samples, one for each step, show."""
    scene = FREE_ROD.replace(simulation={"model": model})
    event = tweezer.flip((1, 0, 0), angle="70 deg", axis=(0, 0, 2))
    run = tweezer.simulate(scene, seed=3, events=[event])
    at = counted(along(run)[:, 0], math.cos(math.radians(70)))
    times = run["time"].values
    found = [each["time"] for each in events_of(run)]
    assert len(found) == len(at) > 5
    for each, i in zip(found, at, strict=True):
        assert times[i - 1] <= each <= times[i]
    first = tweezer.simulate(
        scene, seed=3, events=[tweezer.flip((1, 0, 0), angle="70 deg", terminal=True)]
    )
    assert first.attrs["status"] == "ended"
    assert first["time"].values[-1] == found[0]


def test_capture_of_a_rod_waits_for_its_orientation():
    scene = tweezer.load_scene("polystyrene-500nm").replace(
        bead={"shape": "spheroid", "diameter": "0.4 um", "length": "0.8 um"},
        start={"position": ["0.1 um", "0 um", "0 um"], "orientation": [0.8, 0.5, 0.2, 0.1]},
        simulation={"duration": "4 ms", "samples": 4001},
    )
    centre, radius = [0, 0, 0], "0.4 um"
    place = tweezer.capture(radius, "0.1 ms", centre)
    pose = tweezer.capture(radius, "0.1 ms", centre, direction=(0, 0, -3), angle="5 deg")
    run = tweezer.simulate(scene, events=[place, pose])
    by_place, by_pose = (each for each in events_of(run) if each["name"] == "capture")
    assert by_place["time"] == 0
    assert "orientation" not in by_place
    tilt = np.degrees(np.arccos(np.abs(along(run)[:, 2])))
    first = int(np.argmax(tilt < 5))
    assert (tilt[first : first + 100] < 5).all()
    times = run["time"].values
    assert times[first - 1] < by_pose["time"] <= times[first]
    z = Rotation.from_quat(by_pose["orientation"], scalar_first=True).apply([0, 0, 1])
    assert math.degrees(math.acos(abs(z[2]))) == pytest.approx(5, abs=1e-6)


def test_events_of_poses_refuse_what_they_cannot_use():
    with pytest.raises(SceneError, match="requires the orientation"):
        tweezer.simulate("silica-1um", "10 us", events=[tweezer.flip()])
    with pytest.raises(SceneError, match="direction"):
        tweezer.flip(direction=(0, 0, 0))
    with pytest.raises(SceneError, match="axis"):
        tweezer.capture("1 um", "1 ms", direction=(1, 0, 0), axis=(1, 0))
    with pytest.raises(SceneError, match="angle"):
        tweezer.flip(angle="90 deg")


@pytest.mark.parametrize(
    ("key", "given"),
    [
        ("radius", {"radius": "-1 um"}),
        ("radius", {"radius": 0}),
        ("time", {"time": "-1 ms"}),
        ("time", {"time": 0}),
        ("centre", {"centre": (0, 0)}),
        ("centre", {"centre": (0, 0, math.nan)}),
        ("angle: requires direction", {"angle": "5 deg"}),
        ("axis: requires direction", {"axis": (1, 0, 0)}),
    ],
)
def test_capture_refuses_arguments_without_meaning(key, given):
    with pytest.raises(SceneError, match=f"^{key}"):
        tweezer.capture(**({"radius": "1 um", "time": "1 ms"} | given))


@pytest.mark.filterwarnings("error")
def test_length_of_a_direction_does_not_matter():
    for length in (1e-200, 1e200):
        event = tweezer.flip(direction=(0, 0, length), angle="60 deg")
        pose = np.array([[0, 0, 0, 1.0, 0, 0, 0]])
        assert event.value(np.zeros(1), pose) == pytest.approx(0.5)
