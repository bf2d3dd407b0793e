"""Traps of spheroids and clusters: equilibria computed with other code, and exact relations."""

from __future__ import annotations

import functools

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import tweezer

pytestmark = pytest.mark.filterwarnings("ignore:Knudsen number")

POLYSTYRENE, SILICA = 1.57, 1.45
UM = 1e-6


def spheroid(diameter, length, index):
    return {
        "shape": "spheroid", "diameter": diameter * UM, "length": length * UM,
        "refractive_index": index,
    }  # fmt: skip


PAIR = {
    "shape": "spheres", "radius": None, "refractive_index": None,
    "spheres": [
        {"diameter": 0.5 * UM, "refractive_index": POLYSTYRENE, "position": [0, 0, z * UM]}
        for z in (-0.25, 0.25)
    ],
}  # fmt: skip

#: id: (body, z of its equilibrium in um, its axis)
TRAPS = {
    "polystyrene rod": (spheroid(0.4, 0.8, POLYSTYRENE), 0.174, (0, 0, 1)),
    "long silica rod": (spheroid(0.5, 1.5, SILICA), 0.053, (0, 0, 1)),
    "thin silica rod": (spheroid(0.2, 0.6, SILICA), 0.041, (0, 0, 1)),
    "small rod, along the polarisation": (spheroid(0.1, 0.2, POLYSTYRENE), 0.039, (1, 0, 0)),
    "disc, edge-on": (spheroid(0.8, 0.4, POLYSTYRENE), 0.309, (0, 1, 0)),
    "thick disc, edge-on": (spheroid(1.0, 0.8, SILICA), 0.091, (0, 1, 0)),
    "dumbbell": (PAIR, 0.235, (0, 0, 1)),
}


def scene_of(bead, **sections):
    """Light of filling 0.5, polarised along x, alone."""
    changes = {
        "optics": {"theory": "waves"}, "medium": {"refractive_index": 1.33},
        "lens": {"numerical_aperture": 1.2}, "beam": {"polarisation": "linear"},
        "forces": {"gravity": False, "buoyancy": False}, "bead": {"density": 1050, **bead},
        **sections,
    }  # fmt: skip
    return tweezer.load_scene("silica-1um").replace(**changes)


@functools.cache
def trap_of(name):
    return tweezer.characterise(scene_of(TRAPS[name][0]))


@pytest.mark.parametrize("name", TRAPS)
def test_body_rests_where_other_code_finds_it(name):
    """The positions and axes come from NumPy code without a line in common with the package."""
    _, z, axis = TRAPS[name]
    held = trap_of(name).equilibrium
    assert held.stable
    assert held.position[2] * 1e6 == pytest.approx(z, abs=6e-4)
    assert np.abs(held.position[:2]).max() < 1e-12
    assert np.abs(held.axis) == pytest.approx(axis, abs=1e-7)


@pytest.mark.parametrize("name", ["polystyrene rod", "disc, edge-on"])
def test_force_and_torque_vanish_at_every_equilibrium(name):
    trap = trap_of(name)
    scale = trap.scene.beam.power_through_pupil * 1.33 / 2.998e8
    assert len(trap.equilibria) > 1
    for each in trap.equilibria:
        force = tweezer.optical_force(trap.scene, each.position, each.orientation)
        torque = tweezer.optical_torque(trap.scene, each.position, each.orientation)
        assert np.abs(force).max() < 1e-9 * scale
        assert np.abs(torque).max() < 1e-9 * scale * each.length
        jacobian = tweezer.optical_jacobian(trap.scene, each.position, each.orientation)
        assert np.array(each.stiffness) == pytest.approx(-jacobian, rel=1e-12)
    assert [each.stable for each in trap.equilibria] == sorted(
        (each.stable for each in trap.equilibria), reverse=True
    )


def test_body_that_is_moved_and_turned_is_pulled_back():
    held = trap_of("disc, edge-on").equilibrium
    scene = trap_of("disc, edge-on").scene
    start = Rotation.from_quat(held.orientation, scalar_first=True)
    for i, axis in enumerate(np.eye(3)):
        force = tweezer.optical_force(scene, held.position + 5e-9 * axis, held.orientation)
        assert force[i] < 0
        if i != 1:  # not about its own axis
            turned = (Rotation.from_rotvec(0.02 * axis) * start).as_quat(scalar_first=True)
            assert tweezer.optical_torque(scene, held.position, turned)[i] < 0


def test_eigenvalues_are_those_of_the_stiffness():
    held = trap_of("long silica rod").equilibrium
    assert held.length == pytest.approx(0.75e-6)
    scales = np.array([1, 1, 1, held.length, held.length, held.length])
    expected = np.linalg.eigvals(np.array(held.stiffness) / np.outer(scales, scales))
    found = np.array(held.eigenvalues) @ [1, 1j]
    assert np.sort(found.real) == pytest.approx(np.sort(expected.real), abs=1e-12)
    # a body of revolution turns freely about its own axis
    assert np.abs(found[0]) < 1e-9 * np.abs(found).max()
    assert (found.real[1:] > 0).all()
    assert 0 < held.coupling < 1


def test_weight_lowers_the_equilibrium():
    """Newton's step from the equilibrium without weight is exact to first order."""
    rod, force = TRAPS["polystyrene rod"][0], 50e-15
    held = trap_of("polystyrene rod").equilibrium
    volume = np.pi / 6 * (0.4 * UM) ** 2 * 0.8 * UM
    g = 9.81
    density = 998.2 + force / (volume * g)
    heavy = scene_of(
        {**rod, "density": density},
        forces={"gravity": True, "buoyancy": True, "gravitational_acceleration": g},
        medium={"refractive_index": 1.33, "density": 998.2},
    )
    lower = tweezer.characterise(heavy).equilibrium
    drop = held.position[2] - lower.position[2]
    assert drop == pytest.approx(force / np.array(held.stiffness)[2, 2], rel=1e-2)


def test_buoyancy_turns_a_cluster_of_two_densities():
    """Torque and stiffness about the centre of mass are the light's and the buoyancy's."""
    densities, centre = (19e3, 1e3), np.array([0.25e-6 * 18 / 20, 0, 0])
    spheres = [
        {**each, "position": [x * UM, 0, 0], "density": density}
        for each, x, density in zip(PAIR["spheres"], (-0.25, 0.25), densities, strict=True)
    ]
    scene = scene_of(
        {**PAIR, "spheres": spheres},
        forces={"gravity": True, "buoyancy": True, "gravitational_acceleration": 9.81},
        beam={"polarisation": "linear", "power_through_pupil": 2e-4},
    )
    lift = np.array([0, 0, scene.medium.density * 9.81 * np.pi / 3 * (0.5 * UM) ** 3])

    def torque(position, turned):
        buoyant = np.cross(turned.apply(centre), lift)
        orientation = turned.as_quat(scalar_first=True)
        return tweezer.optical_torque(scene, position, orientation) + buoyant

    trap = tweezer.characterise(scene)
    assert trap.equilibria
    for each in trap.equilibria:
        turned = Rotation.from_quat(each.orientation, scalar_first=True)
        scale = np.linalg.norm(lift) * centre[0]
        assert np.abs(torque(each.position, turned)).max() < 1e-6 * scale
        by_differences = [
            (torque(each.position, Rotation.from_rotvec(-1e-4 * axis) * turned)
             - torque(each.position, Rotation.from_rotvec(1e-4 * axis) * turned)) / 2e-4
            for axis in np.eye(3)
        ]  # fmt: skip
        found = np.array(each.stiffness)[3:, 3:]
        assert found == pytest.approx(np.array(by_differences).T, abs=1e-5 * scale)


def test_power_scales_the_stiffness_alone():
    scene = scene_of(TRAPS["thin silica rod"][0])
    one = trap_of("thin silica rod")
    other = tweezer.characterise(scene.of_power(2 * scene.beam.power_through_pupil))
    assert other.equilibrium.position == pytest.approx(one.equilibrium.position, abs=1e-15)
    assert np.array(other.equilibrium.stiffness) == pytest.approx(
        2 * np.array(one.equilibrium.stiffness), rel=1e-9, abs=1e-12 * 1e-6
    )
    assert other.torque_efficiency == pytest.approx(one.torque_efficiency, rel=1e-9)


def test_escape_forces_are_the_largest_along_the_axes():
    trap = trap_of("polystyrene rod")
    held = np.array(trap.equilibrium.position)
    assert trap.escapes
    for each in trap.escapes:
        axis = np.eye(3)["xyz".index(each.direction[-1])] * (-1 if each.direction[0] == "-" else 1)
        far = np.linspace(0, 1.2e-6, 400)[:, None] * axis
        pulled = -tweezer.optical_force(trap.scene, held + far, trap.equilibrium.orientation) @ axis
        assert abs(each.force) == pytest.approx(pulled.max(), rel=1e-3)


def test_card_reports_equilibrium_and_certificates():
    text = repr(trap_of("disc, edge-on"))
    assert "along y" in text
    assert "0.309" in text
    assert "escape force" in text
    content = trap_of("disc, edge-on").content()
    assert content["equilibrium"]["stable"] is True
    assert "t_matrix" not in content


def test_metal_rod_reports_the_power_that_it_absorbs():
    scene = scene_of(spheroid(0.05, 0.12, [0.26, 6.97]))
    trap = tweezer.characterise(scene)
    held = trap.equilibrium
    if held is None:
        pytest.fail("a gold nanorod is trapped")
    expected = tweezer.absorbed_power(scene, held.position, held.orientation)
    assert expected > 0
    assert trap.absorbed_power == pytest.approx(float(expected))
    assert trap_of("polystyrene rod").absorbed_power is None


@pytest.mark.parametrize("polarisation", ["linear", "circular"])
def test_both_ends_of_an_unequal_pair_are_searched(polarisation):
    """The axis is along the light, up and down, at places where force and torque vanish."""
    spheres = [
        {"diameter": d * UM, "refractive_index": POLYSTYRENE, "position": [0, 0, z * UM]}
        for d, z in ((0.5, -0.25), (0.3, 0.15))
    ]
    scene = scene_of(PAIR | {"spheres": spheres}, beam={"polarisation": polarisation})
    found = [each for each in tweezer.characterise(scene).equilibria if each.stable]
    up = Rotation.from_quat([e.orientation for e in found], scalar_first=True).apply([0, 0, 1])
    assert sorted(up[:, 2]) == pytest.approx([-1, 1], abs=1e-9)
    for each in found:
        force = tweezer.optical_force(scene, each.position, each.orientation)
        assert np.linalg.norm(force) < 1e-18
