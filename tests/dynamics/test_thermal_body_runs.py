"""Thermal motion of scenes with a rod, from the scene to runs and ensembles."""

import math

import numpy as np
import pytest

import tweezer
from tweezer.dynamics import bound_once
from tweezer.dynamics.walk import walk
from tweezer.values.errors import SceneError

#: five standard deviations
FAR = 5.0
ROD = {"shape": "spheroid", "diameter": "0.4 um", "length": "0.8 um"}
TRAPPED = tweezer.load_scene("polystyrene-500nm").replace(
    bead=ROD, forces={"brownian": True}, simulation={"duration": "0.1 ms", "samples": 5}
)
FREE = TRAPPED.replace(
    forces={"optical": False, "gravity": False, "buoyancy": False},
    start={"position": [0, 0, 0]},
    simulation={"duration": "20 ms", "samples": 11, "model": "overdamped"},
)
KT = 1.380649e-23 * FREE.medium.temperature


def followed(scene, n, seed=1):
    bound = walk(scene, seed)
    who = np.arange(n)
    states = bound.start(who)
    out = np.empty((n, len(bound.times), len(bound.columns)))
    out[:, 0] = bound.seen(states)
    bound.advance(states, who, 0, out[:, 1:])
    return bound, out


@pytest.mark.parametrize("model", ["overdamped", "full"])
def test_free_rod_diffuses_with_its_mobilities(model):
    """The axis decays at the rate 2 D across it, and the mean squared displacement is exact."""
    bound, out = followed(FREE.replace(simulation={"model": model}), 512)
    B = tweezer.resistance(FREE).mobility
    D, turns = KT * np.trace(B[:3, :3]) / 3, KT * np.diag(B)[3:]
    e = out[..., bound.shown.at("orientation")]
    n_z = 1 - 2 * (e[..., 1] ** 2 + e[..., 2] ** 2)
    expected = np.exp(-(turns[0] + turns[1]) * bound.times)
    spread = n_z.std(axis=0) / math.sqrt(len(out))
    assert (np.abs(n_z.mean(axis=0) - expected) <= 1e-3 + FAR * spread).all()
    squared = (out[..., :3] ** 2).sum(axis=-1)
    off = squared.mean(axis=0) - 6 * D * bound.times
    assert (np.abs(off) <= 1e-3 * 6 * D * bound.times + FAR * squared.std(axis=0) / 22).all()


def test_step_is_a_tenth_of_the_fastest_rotational_diffusion_of_a_free_rod():
    bound = walk(FREE.replace(simulation={"duration": "10 s", "samples": 2}), 1)
    D = KT * np.diag(tweezer.resistance(FREE).mobility)[3:].max()
    assert 0.09 < bound.step * D <= 0.1
    assert "0.1 of the time of rotational diffusion" in bound.why


def test_step_in_a_trap_is_a_fifth_of_its_fastest_time_scale():
    bound = walk(TRAPPED.replace(simulation={"duration": "1 s"}), 1)
    assert "0.2 of the fastest time scale of the force" in bound.why
    assert 1e-6 < bound.step < 3e-5


def test_run_is_trajectory_0_of_its_ensemble_and_cut_in_time():
    run = tweezer.simulate(TRAPPED, seed=3)
    many = tweezer.ensemble(TRAPPED, 3, seed=3)
    for name in ("position", "velocity", "orientation", "angular_velocity"):
        assert np.array_equal(many[name][0].values, run[name].values)
    assert run.orientation.dims == ("time", "euler_parameter")
    bound = walk(TRAPPED, 3)
    states, who = bound.start(np.array([0])), np.array([0])
    out = np.empty((1, 4, len(bound.columns)))
    for k in range(4):
        bound.advance(states, who, k, out[:, k : k + 1])
    assert np.array_equal(out[0, :, :3], run.position.values[1:])


def test_overdamped_rod_has_no_velocity():
    run = tweezer.simulate(TRAPPED.replace(simulation={"model": "overdamped"}), seed=3)
    assert "orientation" in run
    assert "angular_velocity" not in run


def test_rods_are_lost_at_the_loss_distance():
    scene = FREE.replace(simulation={"loss_distance": "0.3 um", "samples": 3})
    _, out = followed(scene, 64)
    lost = np.isnan(out[:, -1, 0])
    assert lost.sum() > 0


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"simulation": {"method": "baoab", "model": "full"}}, "heun; set simulation.method"),
        ({"simulation": {"method": "one-call", "model": "full"}}, "must be heun"),
        ({"simulation": {"method": "euler-maruyama"}}, "must be heun or one-call"),
        ({"simulation": {"method": "heun", "model": "first-order"}}, "must be full or overdamped"),
        (
            {"start": {"drawn": "boltzmann"}},
            "start.drawn = 'boltzmann': requires a stable equilibrium",
        ),
        ({"camera": {"rate": "1 kHz", "exposure": "0.5 ms"}}, "set simulation.model to overdamped"),
        ({"medium": {"inertia": "memory"}}, "medium.inertia = 'memory'"),
        ({"wall": {"position": "-5 um"}}, "thermal motion beside a wall requires a sphere"),
    ],
)
def test_what_is_not_available_for_a_body_is_refused(changes, said):
    dark = FREE.replace(simulation={"model": "full"}) if "camera" in changes else FREE
    if "medium" in changes:
        dark = FREE.replace(simulation={"model": "full"})
    with pytest.raises(SceneError, match="(?s)" + said.replace("(", r"\(")) as refusal:
        walk(bound_once(dark.replace(**changes)), 1)
    assert "\n" not in str(refusal.value)
