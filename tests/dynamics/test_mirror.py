"""Traps and runs beside a mirror, beyond which no force is known."""

import numpy as np
import pytest

import tweezer
from tweezer import PhysicsWarning
from tweezer.dynamics.events import Event
from tweezer.values.errors import IntegrationError

RADIUS = 0.15e-6
SCENE = tweezer.load_scene("polystyrene-500nm").replace(
    bead={"radius": RADIUS}, mirror={"position": "0.8 um"}, start={"position": [0, 0, 0]}
)
#: A heavy bead without light above a mirror, 50 nm from it
FALLING = SCENE.replace(
    bead={"density": "19 g/cm^3"}, beam={"power_through_pupil": 0, "direction": "down"},
    mirror={"position": "-0.2 um"}, simulation={"duration": "0.2 s"},
)  # fmt: skip


@pytest.fixture(scope="module")
def trap():
    return tweezer.characterise(SCENE)


def test_equilibria_are_in_front_of_the_mirror(trap):
    heights = [each.position[2] for each in trap.equilibria]
    assert len(heights) > 3
    assert max(heights) < 0.8e-6 - RADIUS
    assert trap.lifetime_caveat == "not computed with a mirror"


def test_escape_towards_the_mirror_ends_there():
    """The force is restoring up to the mirror, beyond which the light would let go."""
    near = tweezer.characterise(SCENE.replace(mirror={"position": "0.35 um"}))
    (way,) = (each for each in near.escapes if each.direction == "+z")
    z = near.equilibrium.position[2]
    assert way.range is None
    assert way.wall_at == pytest.approx(0.35e-6 - RADIUS - z, abs=1e-15)


def test_run_fails_at_the_mirror():
    with pytest.warns(PhysicsWarning, match="reached the mirror"):
        run = tweezer.simulate(FALLING)
    assert run.attrs["status"] == "failed"
    assert run.position.sel(axis="z").min() > -0.2e-6 + RADIUS - 2e-9


def test_thermal_run_and_ensemble_fail_at_the_mirror():
    thermal = FALLING.replace(forces={"brownian": True}, simulation={"samples": 2001})
    with pytest.warns(PhysicsWarning, match="trajectory 0: the bead reached the mirror"):
        run = tweezer.simulate(thermal, seed=1)
    assert run.attrs["status"] == "failed"
    height = run.position.sel(axis="z").values + 0.2e-6 - RADIUS
    assert len(height) > 10
    assert height.min() >= 0
    on = tweezer.simulate(thermal.replace(mirror={"position": "-2 um"}), seed=1)
    beyond = on.position.sel(axis="z").values + 0.2e-6 - RADIUS < 0
    assert len(height) == beyond.argmax()
    np.testing.assert_array_equal(run.position, on.position[: len(height)])
    with pytest.raises(IntegrationError, match="the bead reached the mirror"):
        tweezer.ensemble(thermal, 2, seed=1)


def test_plane_of_the_index_of_the_medium_reflects_nothing():
    index = SCENE.medium.refractive_index
    places = np.array([[1e-7, 5e-8, 2e-7], [0, 0, -1e-7]])
    alone = SCENE.model_dump(exclude={"mirror"}, exclude_none=True)
    np.testing.assert_allclose(
        tweezer.optical_force(SCENE.replace(mirror={"refractive_index": index}), places),
        tweezer.optical_force(tweezer.load_scene(alone), places), rtol=1e-7, atol=1e-20,
    )  # fmt: skip


def test_plane_of_nearly_the_index_of_the_medium_has_the_usual_error():
    places = np.array([[1e-7, 5e-8, 2e-7], [0, 0, -1e-7]])
    near, usual = (
        SCENE.replace(mirror={"refractive_index": SCENE.medium.refractive_index + step})
        for step in (1e-8, 1e-2)
    )
    stated = tweezer.optical_force_error(near, places)
    np.testing.assert_allclose(stated, tweezer.optical_force_error(usual, places), rtol=0.1)


def test_camera_and_events_of_a_thermal_run_end_at_the_mirror():
    thermal = FALLING.replace(forces={"brownian": True}, simulation={"samples": 2001})
    camera = {"rate": "1 kHz", "exposure": "0.1 ms"}
    filmed = tweezer.load_scene({**thermal.model_dump(exclude_none=True), "camera": camera})
    with pytest.warns(PhysicsWarning, match="reached the mirror"):
        run = tweezer.simulate(filmed, seed=1)
    last = float(run.time[-1])
    frame = float(run.frame_time[-1])
    assert frame <= last < frame + 1e-3
    above = Event("far", lambda time, state: state[:, 2] + 0.01e-6)
    with pytest.warns(PhysicsWarning, match="reached the mirror"):
        watched = tweezer.simulate(thermal, seed=1, events=[above])
    np.testing.assert_array_equal(watched.time, run.time)
