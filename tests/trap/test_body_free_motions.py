"""Traps of bodies that are not spheres: which equilibria count as stable, and as the same."""

import numpy as np
import pytest

import tweezer

BASE = tweezer.load_scene("polystyrene-500nm")
DISC = {"shape": "spheroid", "diameter": "0.8 um", "length": "0.4 um"}


def dumbbell(direction):
    """Return two touching spheres along a direction."""
    spheres = [
        {"diameter": "0.4 um", "refractive_index": 1.57, "position": list(2e-7 * sign * direction)}
        for sign in (-1, 1)
    ]
    return {"shape": "spheres", "density": "1050 kg/m^3", "spheres": spheres}


def test_trap_of_a_dumbbell_does_not_depend_on_its_direction_in_the_body_frame():
    along, tilted = (
        tweezer.characterise(BASE.replace(bead=dumbbell(np.array(axis))))
        for axis in ([0.0, 0, 1], [0.48, 0.64, 0.6])
    )
    assert along.equilibrium.stable
    assert along.equilibrium.position == pytest.approx(tilted.equilibrium.position, abs=1e-12)
    assert np.array(along.equilibrium.eigenvalues)[:, 0] == pytest.approx(
        np.array(tilted.equilibrium.eigenvalues)[:, 0], abs=1e-10
    )
    direction = tilted.equilibrium.direction_of(tilted.t_matrix.axes_of_revolution[0])
    assert direction == pytest.approx([0, 0, 1], abs=1e-6)


@pytest.mark.parametrize("polarisation", ["unpolarised", "radial"])
def test_disc_may_turn_freely_about_the_axis_of_symmetric_light(polarisation):
    trap = tweezer.characterise(BASE.replace(bead=DISC, beam={"polarisation": polarisation}))
    assert trap.equilibrium is not None
    assert trap.equilibrium.axis[2] == pytest.approx(0, abs=1e-6)  # edge-on
    assert [each.stable for each in trap.equilibria].count(True) == 1


def test_sphere_described_as_spheroid_rests_where_the_sphere_does():
    sphere = tweezer.characterise(BASE)
    size = {"shape": "spheroid", "diameter": "0.5 um", "length": "0.5 um"}
    body = tweezer.characterise(BASE.replace(bead=size))
    assert len(body.equilibria) == 1
    assert body.equilibrium.position[2] == pytest.approx(sphere.equilibrium.position[2], rel=1e-7)


def test_every_beam_of_a_scene_is_searched():
    rod = {"shape": "spheroid", "diameter": "0.4 um", "length": "0.8 um"}
    trap = tweezer.characterise(tweezer.load_scene("two-traps").replace(bead=rod))
    stable = sorted(each.position[0] for each in trap.equilibria if each.stable)
    assert stable == pytest.approx([-1.5e-6, 1.5e-6], abs=5e-8)


@pytest.mark.parametrize("axis", [[1, 0, 0], [0, 1, 0], [0, 0, 1], [0.6, 0, -0.8]])
def test_axis_of_revolution_of_a_cluster_is_found(axis):
    body = tweezer.t_matrix(BASE.replace(bead=dumbbell(np.array(axis, float))))
    (found,) = body.axes_of_revolution
    assert abs(found @ np.array(axis)) == pytest.approx(1)
