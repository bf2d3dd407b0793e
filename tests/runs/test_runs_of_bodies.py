"""Results of runs of bodies that are not spheres."""

import numpy as np
import pytest

import tweezer

ROD = {"shape": "spheroid", "diameter": "0.4 um", "length": "0.8 um"}
TILTED = {"position": ["0.1 um", "0 um", "0 um"], "orientation": [0.8, 0.5, 0.2, 0.1]}


def rod(brownian):
    return tweezer.load_scene("polystyrene-500nm").replace(
        bead=ROD, start=TILTED, forces={"brownian": brownian},
        simulation={"model": "full", "method": "auto", "duration": "1 ms", "samples": 21},
    )  # fmt: skip


@pytest.mark.parametrize("brownian", [False, True])
def test_stored_force_is_at_the_orientation_of_each_sample(brownian):
    scene = rod(brownian)
    run = tweezer.simulate(scene, seed=1) if brownian else tweezer.simulate(scene)
    for i in (3, -1):
        there = tweezer.optical_force(scene, run.position[i], run.orientation[i])
        np.testing.assert_allclose(run.optical_force[i], there, rtol=1e-6, atol=1e-18)
    if not brownian:
        summary = tweezer.summarise(run)
        assert summary.outcome == "captured"
        largest = np.linalg.norm(run.optical_force, axis=1).max()
        assert summary.largest_force == pytest.approx(largest, rel=0.05)


def test_kinetic_energy_of_a_dumbbell_has_its_inertia_by_axis():
    """The pair spins about the line of centres, z: 2/5 m r^2 for each sphere."""
    description = tweezer.load_scene("polystyrene-500nm").model_dump(exclude_none=True)
    index = description["bead"]["refractive_index"]
    description["bead"] = {
        "shape": "spheres", "density": "1050 kg/m^3",
        "spheres": [
            {"radius": "0.2 um", "refractive_index": index, "position": [0, 0, z]}
            for z in ("-0.2 um", "0.2 um")
        ],
    }  # fmt: skip
    scene = tweezer.load_scene(description).replace(
        forces={"optical": False},
        start={"angular_velocity": [0, 0, 1e4]},
        simulation={"model": "full", "method": "auto", "duration": "1 us", "samples": 3},
    )
    run = tweezer.simulate(scene)
    mass = 1050 * 4 / 3 * np.pi * 0.2e-6**3
    spinning = 0.5 * 2 * (2 / 5 * mass * 0.2e-6**2) * 1e8
    assert run.kinetic_energy.values[0] == pytest.approx(spinning, rel=1e-9)


def test_double_layer_of_a_rod_is_refused_in_one_line():
    scene = rod(False).replace(
        wall={"position": "-5 um"},
        forces={"optical": False, "dlvo": {"strength": "1e-18 J", "debye_length": "10 nm",
                                          "hamaker_constant": "1e-20 J"}},
    )  # fmt: skip
    with pytest.raises(tweezer.SceneError, match=r"^forces\.dlvo: is known for spheres; remove"):
        tweezer.simulate(scene)


def test_terminal_speed_of_a_rod_follows_its_own_drag():
    """A rod that lies along x: its drag across the axis slows its fall."""
    scene = rod(False).replace(
        start={"orientation": [np.sqrt(0.5), 0, np.sqrt(0.5), 0]}, forces={"optical": False},
    )  # fmt: skip
    run = tweezer.simulate(scene)
    weight = (scene.body.mass - scene.medium.density * scene.body.volume) * (
        scene.forces.gravitational_acceleration
    )
    across = tweezer.resistance(scene).matrix[0, 0]
    assert run.terminal_speed.values[0] == pytest.approx(weight / across, rel=1e-12)


def test_least_power_for_a_rod_is_refused_in_one_line():
    with pytest.raises(tweezer.SceneError, match=r"^bead\.shape = 'spheroid': lifetimes are"):
        tweezer.least_power(rod(True), "1 h")
