"""The force between bead and wall: against its potential, and where a bead comes to rest on it."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

import tweezer
from tweezer.dynamics import bound_once
from tweezer.forces.wall import CLOSEST, Contact, Dlvo
from tweezer.values.errors import SceneError

STRENGTH, DEBYE, HAMAKER, RADIUS = 4e-18, 12e-9, 5e-21, 1e-6


def potential(gap, hamaker=HAMAKER):
    return STRENGTH * math.exp(-gap / DEBYE) - hamaker * RADIUS / (6 * gap)


@pytest.mark.parametrize(("position", "normal"), [(-2e-6, 1.0), (3e-6, -1.0)])
def test_force_and_gradient_are_those_of_the_potential(position, normal):
    force = Dlvo(RADIUS, position, normal, STRENGTH, DEBYE, HAMAKER)
    gaps = np.array([0.5e-9, 3e-9, 20e-9, 80e-9])
    places = np.zeros((4, 3))
    places[:, 2] = position + normal * (RADIUS + gaps)
    found = force.field(places, gradient=True)
    for i, gap in enumerate(gaps):
        h = 1e-4 * gap
        by_potential = -(potential(gap + h) - potential(gap - h)) / (2 * h)
        assert found.force[i, 2] == pytest.approx(normal * by_potential, rel=1e-6)
        ahead, behind = (force.field(places + each).force[i, 2] for each in ([0, 0, h], [0, 0, -h]))
        assert found.force_gradient[i, 2, 2] == pytest.approx((ahead - behind) / (2 * h), rel=1e-5)
    alone = force.field(places[1:2], gradient=True)
    assert alone.force_gradient[0, 2, 2] == found.force_gradient[1, 2, 2]
    assert not found.force[:, :2].any()
    assert np.count_nonzero(found.force_gradient) == len(gaps)


def test_it_is_finite_in_contact_and_behind():
    force = Dlvo(RADIUS, 0.0, 1.0, STRENGTH, DEBYE, HAMAKER)
    z = RADIUS + np.array([CLOSEST, 1e-12, 0.0, -1e-6])
    found = force.field(np.column_stack([0 * z, 0 * z, z]), gradient=True).force[:, 2]
    assert np.ptp(found) == 0
    assert found[0] == pytest.approx(
        STRENGTH / DEBYE * math.exp(-CLOSEST / DEBYE) - force.attraction, rel=1e-9
    )


def scene_with(**dlvo):
    return tweezer.load_scene("silica-1um").replace(
        bead={"radius": RADIUS, "density": 2000},
        forces={"optical": False, "dlvo": dlvo},
        wall={"position": "-1.2 um"},
        start={"position": [0, 0, 0]},
        simulation={"duration": "4 s", "model": None, "samples": 21},
    )


def test_a_bead_comes_to_rest_where_repulsion_carries_it():
    scene = scene_with(strength="4 aJ", debye_length="12 nm", hamaker_constant="1 zJ")
    weight = -tweezer.bead_properties(scene).weight[2]

    def net(gap):
        repulsion = STRENGTH / DEBYE * math.exp(-gap / DEBYE)
        return repulsion - 1e-21 * RADIUS / (6 * gap**2) - weight

    run = tweezer.simulate(scene)
    gap = scene.gap(run["position"].sel(axis="z").values[-1])
    rest = brentq(net, 20e-9, 200e-9, xtol=1e-18)
    assert gap == pytest.approx(rest, abs=3e-12)
    problem = bound_once(scene)
    gaps = [scene.gap(each.position[2]) for each in problem.equilibria(problem.net_force)]
    # there, at the barrier, and in contact
    assert len(gaps) == 3
    assert max(gaps) == pytest.approx(rest, rel=1e-6)


def test_without_a_barrier_it_sticks_to_the_wall():
    scene = scene_with(strength=0.0, debye_length="1 nm", hamaker_constant="8 zJ")
    run = tweezer.simulate(scene)
    gap = scene.gap(run["position"].sel(axis="z").values)
    assert (gap > 0).all()
    assert 0.1e-9 < gap[-1] < 0.2e-9
    assert gap[-1] == pytest.approx(gap[-4], abs=1e-12)


def test_contact_pushes_away_and_not_without_end():
    force = Contact(RADIUS, 0.0, 1.0, 1e-9)
    gaps = np.array([0.3e-9, 0.1e-9, 0.02e-9, 0.0, -1e-9])
    z = RADIUS + gaps
    found = force.field(np.column_stack([0 * z, 0 * z, z]), gradient=True)
    pushes = found.force[:, 2]
    np.testing.assert_allclose(pushes[:3], 1e-9 * np.exp(-gaps[:3] / 2e-11), rtol=1e-4)
    assert pushes[3] == pushes[4] == 1e-9
    np.testing.assert_allclose(found.force_gradient[:3, 2, 2], -pushes[:3] / 2e-11, rtol=1e-9)


@pytest.mark.parametrize(
    ("sections", "words"),
    [
        ({"forces": {"dlvo": {"strength": "4 aJ", "debye_length": "9 nm"}}}, "requires a .wall."),
        ({"forces": {"dlvo": {"strength": "4 aJ"}}}, r"forces.dlvo.debye_length: missing"),
        ({"forces": {"dlvo": {"strength": "4 nm", "debye_length": 1e-8}}}, "must be convertible"),
    ],
)
def test_what_is_wrong_is_said_in_one_line(sections, words):
    with pytest.raises(SceneError, match=words):
        tweezer.load_scene("silica-1um").replace(**sections)


def test_a_thermal_bead_that_sticks_stays():
    """A trap that moves into the wall brings it there: steps see the well, or the run says so."""
    scene = tweezer.load_scene("moving-trap").replace(
        wall={"position": "-1 um"},
        optics={"evaluator": "map"},
        start={"position": [0, 0, "-0.45 um"]},
        beam={"motion": {"kind": "ramp", "velocity": [0, 0, "-1 mm/s"], "begin": 0, "end": "2 ms"}},
        forces={
            "brownian": True,
            "dlvo": {"strength": 0.0, "debye_length": "10 nm", "hamaker_constant": "10 zJ"},
        },
        simulation={"model": "overdamped", "duration": "6 ms", "samples": 61},
    )
    run = tweezer.simulate(scene, seed=2)
    pull = 1e-20 * scene.bead.radius / 6 / CLOSEST**2
    kT = 1.380649e-23 * scene.medium.temperature
    assert run.attrs["step"] < 0.2 * 2 * scene.bead.radius * 9.5e-9 / pull
    stuck = run["gap"].values[-10:]
    assert (stuck > 0).all()
    assert stuck.mean() < 4 * kT / pull
    coarse = scene.replace(simulation={"step": "20 us"})
    with pytest.warns(tweezer.PhysicsWarning, match="touched the wall, where van der Waals"):
        tweezer.simulate(coarse, seed=2)
