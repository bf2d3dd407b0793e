"""Drag in a gas from continuum to free molecules, and the inertia that it does not have."""

import math
import warnings

import numpy as np
import pytest
from scipy import constants

import tweezer
from tweezer.fluid import drag
from tweezer.scene import load_scene
from tweezer.scene.media import MEDIA
from tweezer.values.errors import PhysicsWarning

RADIUS, KELVIN = 75e-9, 300.0
#: Pressures over 12 decades, Pa
PRESSURES = np.geomspace(1e-7, 1e5, 25)


def levitated(pressure, name="air", **changes):
    """A silica bead in a gas."""
    data = load_scene("silica-1um").model_dump(exclude_none=True)
    medium = {"name": name, "temperature": KELVIN, "pressure": pressure}
    return load_scene({
        **data, "lens": {**data["lens"], "numerical_aperture": 0.8},
        "bead": {**data["bead"], "radius": RADIUS},
        "medium": {**medium, **changes.pop("medium", {})}, **changes,
    })  # fmt: skip


def mean_free_path(name, pressure):
    """(mu/p) sqrt(pi k T/(2 m)) for the viscosity of the scene."""
    fluid = MEDIA[name]
    mass = fluid.molar_mass / constants.N_A
    viscosity = levitated(pressure, name).medium.viscosity
    return viscosity / pressure * math.sqrt(math.pi * constants.k * KELVIN / (2 * mass))


@pytest.mark.parametrize("name", ["air", "helium"])
def test_drag_is_the_published_one_over_12_decades(name):
    """T. Li, Fundamental Tests of Physics with Optically Trapped Microspheres (2011)."""
    for pressure in PRESSURES:
        scene = levitated(pressure, name)
        Kn = mean_free_path(name, pressure) / RADIUS
        slip = 0.31 * Kn / (0.785 + 1.152 * Kn + Kn**2)
        published = (
            6 * math.pi * scene.medium.viscosity * RADIUS * 0.619 / (0.619 + Kn) * (1 + slip)
        )
        assert tweezer.bead_properties(scene).drag == pytest.approx(published, rel=5e-5, abs=0)
        assert drag(scene).translation == tweezer.bead_properties(scene).drag


@pytest.mark.parametrize("name", ["air", "nitrogen", "argon", "oxygen", "helium"])
@pytest.mark.parametrize("accommodation", [1.0, 0.5])
def test_drag_of_free_molecules_is_epstein_s(name, accommodation):
    """Integral of the momentum of Maxwell's molecules over the sphere, with diffuse reflection."""
    for pressure in (1e-7, 1e-3, 1.0):
        scene = levitated(pressure, name, medium={"accommodation": accommodation})
        mass = MEDIA[name].molar_mass / constants.N_A
        flux = pressure / (constants.k * KELVIN) * mass  # density
        speed = math.sqrt(8 * constants.k * KELVIN / (math.pi * mass))
        factor = 4 * math.pi / 3 * RADIUS**2 * flux * speed
        found = tweezer.bead_properties(scene)
        expected = factor * (1 + math.pi * accommodation / 8)
        assert found.drag == pytest.approx(expected, rel=2e-3, abs=0)
        expected = 2 * math.pi / 3 * accommodation * RADIUS**4 * flux * speed
        assert found.rotational_drag == pytest.approx(expected, rel=2e-3, abs=0)


def test_drag_of_a_continuum_is_stokes_s():
    scene = levitated("2 bar").replace(bead={"radius": "50 um"})
    assert scene.knudsen < 1e-3
    found, viscosity = tweezer.bead_properties(scene), scene.medium.viscosity
    assert found.drag == pytest.approx(6 * math.pi * viscosity * 50e-6, rel=2e-3, abs=0)
    assert found.rotational_drag == pytest.approx(
        8 * math.pi * viscosity * 50e-6**3, rel=5e-3, abs=0
    )
    assert found.vorticity_time == pytest.approx(scene.vorticity_time, rel=1e-12, abs=0)


def test_every_drag_of_a_scene_is_the_same():
    scene = levitated(1000.0)
    found = tweezer.bead_properties(scene)
    diagonal = np.diagonal(tweezer.resistance(scene).matrix)
    expected = np.repeat([found.drag, found.rotational_drag], 3)
    np.testing.assert_allclose(diagonal, expected, rtol=1e-14)
    mobility = drag(scene).mobilities(np.zeros((1, 3))).value[0, :4]
    np.testing.assert_allclose(1 / mobility, np.repeat(expected[[0, 3]], 2), rtol=1e-14)


def test_only_a_drag_that_is_not_known_is_warned_of():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        scene = levitated(100.0)
    assert "not to be trusted" not in repr(tweezer.bead_properties(scene))
    with pytest.warns(PhysicsWarning, match="Knudsen number"):
        levitated(100.0, wall={"position": "-5 um"})


def test_gas_that_is_no_continuum_has_no_inertia():
    free = levitated(1e4, forces={"optical": False, "gravity": True})
    assert free.rarefied
    scene, why = tweezer.chosen(free)
    assert (scene.medium.inertia, scene.simulation.model) == ("none", "full")
    assert "no inertia of the fluid: the gas is no continuum for the bead" in why
    large = free.replace(bead={"radius": "30 um"}, medium={"pressure": "1 bar"})
    assert not large.rarefied
    assert tweezer.chosen(large)[0].medium.inertia == "memory"


def test_run_in_a_gas_falls_as_its_drag_says():
    """x'' = g - x'/tau from rest; the model error is the effect of sqrt(tau_f/tau) more drag."""
    scene = levitated(1e4, forces={"optical": False, "gravity": True, "buoyancy": False})
    run = tweezer.simulate(scene, duration="20 us")
    bead = tweezer.bead_properties(scene)
    t, g = run["time"].values, scene.forces.gravitational_acceleration

    def fallen(tau):
        return g * tau * (t + tau * np.expm1(-t / tau))

    tau = bead.mass / bead.drag
    z = run["position"].values[:, 2] - scene.start_position[2]
    np.testing.assert_allclose(-z, fallen(tau), atol=1e-12 * fallen(tau)[-1] + 1e-20)
    off = fallen(tau) - fallen(tau / (1 + math.sqrt(bead.vorticity_time / tau)))
    speed, excursion = g * tau * -np.expm1(-t[-1] / tau), np.abs(z - z.mean()).max()
    assert speed / excursion < 1 / tau
    assert run.attrs["model_error"] == pytest.approx(off.max(), rel=1e-3, abs=0)
