"""Sweeps of traps of bodies: every case is the trap of the body at its own orientation."""

import numpy as np
import pytest

import tweezer

pytestmark = pytest.mark.filterwarnings("ignore:Knudsen number")


def test_cases_are_the_traps_of_the_body():
    """Between these lengths the rod turns from the polarisation to the axis of the light."""
    scene = tweezer.load_scene("flipping-rod").replace(bead={"diameter": "0.4 um"})
    lengths = [0.42e-6, 0.8e-6]
    swept = tweezer.sweep(scene, {"bead.length": lengths}, workers=1).load()
    for i, length in enumerate(lengths):
        trap = tweezer.characterise(scene.replace(bead={"length": length}))
        held, case = trap.equilibrium, swept.isel({"bead.length": i})
        assert case["outcome"] == "held"
        assert case["equilibrium"].values == pytest.approx(held.position, abs=1e-15)
        assert case["stiffness"].values == pytest.approx(np.diag(held.stiffness)[:3])
        assert case["escape_force"].values == pytest.approx([each.force for each in trap.escapes])
        energies = [each.energy_kT for each in trap.escapes]
        assert case["escape_energy"].values == pytest.approx(energies)
        assert np.isnan(case["lifetime"])
    # not the stiffness of the rod as it is released
    released = -tweezer.optical_jacobian(scene.replace(bead={"length": lengths[0]}), [0, 0, 0])
    assert swept["stiffness"][0, 0] != pytest.approx(released[0, 0], rel=0.01)


def test_weak_light_holds_no_body():
    swept = tweezer.sweep(
        "flipping-rod", {"beam.power_through_pupil": ["0.1 mW", "2 mW", "20 mW"]}, workers=1
    ).load()
    assert swept["outcome"].values.tolist() == ["not held", "shallow", "held"]
    assert "takes" in str(swept["reason"][0].values)
