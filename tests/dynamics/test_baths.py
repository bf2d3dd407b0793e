"""Recoil of light and noise of the laser as baths of a bead in thin gas.

Energies are compared with rate equations. Seeds are fixed; a right program would exceed a bound for
one seed in a million.
"""

import dataclasses
import math

import numpy as np
import pytest

import tweezer
from tests.reference.fields import LinearTrap, in_place
from tweezer.dynamics import bound_once
from tweezer.dynamics.shot_noise import recoil_at
from tweezer.dynamics.walk import walk
from tweezer.values.errors import SceneError

FAR = 5.0
#: A 150 nm bead of silica in linearly polarised light
SCENE = tweezer.load_scene("silica-1um").replace(
    bead={"diameter": "150 nm"},
    lens={"numerical_aperture": 0.8},
    beam={"polarisation": "linear"},
    medium={"name": "air", "pressure": "1e-9 mbar", "temperature": 300.0},
    forces={"brownian": True, "gravity": False},
    start={"position": [0.0, 0.0, 0.0], "drawn": "equilibrium"},
)
BEAD = tweezer.bead_properties(SCENE)
KT = 1.380649e-23 * 300.0
GAMMA = BEAD.drag / BEAD.mass
NU = 1e5
STIFFNESS = BEAD.mass * (2 * math.pi * NU) ** 2


def energies(periods, beads, seed=1, **sections):
    """Return the energies per axis, (beads, 3) J, after some periods in a linear trap."""
    scene = SCENE.replace(**sections).replace(simulation={"duration": periods / NU, "samples": 2})
    one = walk(in_place(bound_once(scene), LinearTrap(STIFFNESS)), seed)
    who = np.arange(beads)
    states, out = one.start(who), np.empty((beads, 1, 6))
    begun = states.copy()
    one.advance(states, who, 0, out)
    return _energy(begun), _energy(out[:, 0])


def _energy(states):
    return 0.5 * (STIFFNESS * states[:, :3] ** 2 + BEAD.mass * states[:, 3:6] ** 2)


def agrees(found, expected, most):
    """Return whether the mean of samples (n,) is `expected`, and known to a part `most` of it."""
    error = found.std() / math.sqrt(len(found))
    return abs(found.mean() - expected) < FAR * error < FAR * most * expected


def test_recoil_heats_each_axis_at_its_rate():
    """dE/dt = Gamma kT + S_ii/(2 m), known to 1 % from the three axes of 6000 beads."""
    rates = tweezer.recoil(SCENE, [0, 0, 0]).diagonal() / 2 / BEAD.mass
    _, found = energies(25, 6000, forces={"recoil": True})
    assert (rates > 20 * GAMMA * KT).all()
    expected = (GAMMA * KT + rates) * 25 / NU
    assert agrees((found / expected).ravel(), 1.0, 0.01)
    for k in range(3):
        assert agrees(found[:, k], expected[k], 0.02)


def test_change_of_the_recoil_is_sampled_on_both_sides_of_the_equilibrium():
    stiffness = np.array([1.0, 2.0, 0.5]) * STIFFNESS
    found = recoil_at(SCENE, np.zeros(3), stiffness)
    for side, sign in enumerate((1, -1)):
        for k in range(3):
            place = np.zeros(3)
            place[k] = sign * math.sqrt(KT / stiffness[k])
            np.testing.assert_allclose(
                found.beside[side, k], tweezer.recoil(SCENE, place),
                rtol=0, atol=1e-12 * found.diffusion.max(),
            )  # fmt: skip
    free = recoil_at(SCENE, np.zeros(3), np.full(3, math.inf))
    assert "it changes by 0 % within" in free.words


def test_stationary_energy_with_recoil():
    """<E> = kT + S_ii/(2 m Gamma), at a pressure where both matter."""
    scene = SCENE.replace(
        medium={"pressure": "2e-4 mbar"}, start={"drawn": "boltzmann"}, forces={"recoil": True}
    )
    rates = tweezer.recoil(SCENE, [0, 0, 0]).diagonal()
    gamma = tweezer.bead_properties(scene).drag / BEAD.mass
    one = walk(in_place(bound_once(scene), LinearTrap(STIFFNESS)))
    found = _energy(one.start(np.arange(40_000)))
    heated = KT + rates / 2 / BEAD.mass / gamma
    assert heated.max() > 1.0003 * KT
    for k in range(3):
        assert agrees(found[:, k], heated[k], 0.006)
    assert one.plan.diffusion[:3] * one.plan.tau[:3] * gamma**2 * BEAD.mass == pytest.approx(
        heated * gamma, rel=1e-6
    )
    assert "recoil of the light" in one.why


@pytest.mark.parametrize("corner", [None, 1e5])
def test_noise_of_the_power_multiplies_the_energy(corner):
    """dE/dt = pi^2 nu^2 S(2 nu) E."""
    growth, periods = 0.5, 200
    at_twice = growth * NU / periods / (math.pi * NU) ** 2
    flat = at_twice * (1 if corner is None else 1 + (2 * NU / corner) ** 2)
    begun, found = energies(
        periods, 4000, start={"drawn": "boltzmann"},
        beam={"noise": {"power": flat, "corner": corner}},
    )  # fmt: skip
    assert agrees((found / begun.mean()).ravel(), math.exp(growth), 0.02)


@pytest.mark.parametrize("corner", [None, 2e4])
def test_noise_of_the_focus_adds_energy(corner):
    """dE/dt = 4 pi^4 m nu^4 S(nu)."""
    gain, periods = 50 * KT, 100
    at_nu = gain * NU / periods / (4 * math.pi**4 * BEAD.mass * NU**4)
    flat = at_nu * (1 if corner is None else 1 + (NU / corner) ** 2)
    _, found = energies(periods, 3000, beam={"noise": {"position": flat, "corner": corner}})
    assert agrees(found.ravel(), gain, 0.02)


def test_noise_does_not_depend_on_how_a_run_is_divided():
    scene = SCENE.replace(
        simulation={"duration": 100 / NU, "samples": 11},
        beam={"noise": {"power": "1e-9 1/Hz", "position": "1e-24 m^2/Hz", "corner": "50 kHz"}},
    )
    one = walk(in_place(bound_once(scene), LinearTrap(STIFFNESS)))
    whole, parts = np.empty((5, 10, 6)), np.empty((5, 10, 6))
    who = np.arange(5)
    one.advance(one.start(who), who, 0, whole)
    for some in (who[:2], who[2:]):
        states = one.start(some)
        rows = slice(some[0], some[-1] + 1)
        one.advance(states, some, 0, parts[rows, :4])
        for i in some:
            at = states[i - some[0] : i - some[0] + 1].copy()
            one.advance(at, np.array([i]), 4, parts[i : i + 1, 4:])
    np.testing.assert_array_equal(whole, parts)


@pytest.mark.parametrize(
    ("sections", "message"),
    [
        ({"forces": {"brownian": False, "recoil": True}, "start": {"drawn": "no"}},
         "forces.recoil = True: requires forces.brownian"),
        ({"forces": {"brownian": False}, "start": {"drawn": "no"},
          "beam": {"noise": {"power": 1e-12}}}, "beam.noise: requires forces.brownian"),
        ({"bead": {"diameter": "1 um"}, "medium": {"name": "water", "pressure": None},
          "beam": {"noise": {"power": 1e-12}}},
         "a bead that oscillates"),
        ({"forces": {"recoil": True, "optical": False}, "start": {"drawn": "no"}},
         "computed for a sphere in steady light"),
        ({"beam": {"noise": {"power": "1e-12 W/Hz"}}}, "convertible to 1/Hz"),
        ({"beam": {"noise": {"position": "1e-12 m"}}}, r"convertible to m\^2/Hz"),
    ],
)  # fmt: skip
def test_wrong_baths_are_refused(sections, message):
    with pytest.raises(SceneError, match=message):
        walk(in_place(bound_once(SCENE.replace(**sections)), LinearTrap(STIFFNESS)))


@pytest.mark.parametrize(
    ("sections", "message"),
    [
        ({"forces": {"recoil": True}}, "computed for a sphere in steady light"),
        ({"beam": {"noise": {"power": 1e-12}}}, "a single, steady beam"),
    ],
)
def test_baths_in_light_that_changes_are_refused(sections, message):
    blinking = SCENE.replace(beam={"modulation": {"kind": "on-off", "frequency": "1 kHz"}})
    with pytest.raises(SceneError, match=message):
        walk(bound_once(blinking.replace(**sections)))


@pytest.mark.parametrize("brownian", [True, False])
def test_noise_of_a_second_beam_is_refused(brownian):
    data = SCENE.model_dump(exclude_none=True)
    data["more_beams"] = [data["beam"] | {"noise": {"power": 1e-12}}]
    data["forces"]["brownian"] = brownian
    data["start"]["drawn"] = "no"
    with pytest.raises(SceneError, match=r"beam\.noise: "):
        walk(bound_once(tweezer.load_scene(data)))


def test_noise_beside_forces_other_than_light_is_refused():
    problem = bound_once(SCENE.replace(beam={"noise": {"power": 1e-12}}), [LinearTrap(1e-9)])
    with pytest.raises(SceneError, match="light and weight alone"):
        walk(dataclasses.replace(problem, light=LinearTrap(STIFFNESS)))
