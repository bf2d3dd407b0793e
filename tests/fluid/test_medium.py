"""`tweezer.medium`: the numbers of a scene's medium with their errors."""

import math

import numpy as np
import pytest
from iapws import IAPWS95
from scipy import constants

import tweezer
from tweezer.values.errors import SceneError

SILICA = tweezer.load_scene("silica-1um")


def in_medium(**medium):
    """The numbers of a medium about the silica bead, with an index for any lens."""
    index = {"refractive_index": 1.33} if "pressure" in medium else {}
    return tweezer.medium(SILICA.replace(medium={"temperature": 300, **medium, **index}))


def test_water_is_that_of_iapws_within_its_errors():
    for celsius in (5, 25, 60):
        kelvin = 273.15 + celsius
        full = IAPWS95(T=kelvin, P=0.101325, l=1e6 * SILICA.beam.wavelength)
        found = in_medium(name="water", temperature=kelvin)
        assert found.density == pytest.approx(full.rho, rel=1e-5, abs=0)
        assert found.viscosity == pytest.approx(full.mu, rel=3e-5, abs=0)
        assert found.refractive_index == pytest.approx(full.n, abs=1e-5)
        assert found.density_error == pytest.approx(1e-6 * full.rho, rel=1e-3, abs=0)
        assert found.viscosity_error == pytest.approx(0.01 * full.mu, rel=1e-3, abs=0)
        assert found.refractive_index_error == 6e-5


def test_error_of_viscosity_is_that_of_the_drag_of_a_liquid():
    found = in_medium(name="glycerol", fraction=0.5)
    radius, mass = SILICA.bead.radius, tweezer.bead_properties(SILICA).mass
    assert found.viscosity_error == pytest.approx(0.06 * found.viscosity, rel=1e-9, abs=0)
    assert found.drag_error == pytest.approx(
        6 * math.pi * radius * found.viscosity_error, rel=1e-9, abs=0
    )
    assert found.rotational_drag_error == pytest.approx(
        0.06 * found.rotational_drag, rel=1e-9, abs=0
    )
    assert found.damping_rate == pytest.approx(found.drag / mass, rel=1e-9, abs=0)
    assert found.damping_rate_error == pytest.approx(0.06 * found.damping_rate, rel=1e-9, abs=0)


def test_errors_of_numbers_that_the_scene_gives_are_not_known():
    found = tweezer.medium(SILICA)
    assert math.isnan(found.viscosity_error)
    assert math.isnan(found.drag_error)
    found = in_medium(name="water", viscosity=1e-3)
    assert math.isnan(found.drag_error)
    assert found.density_error > 0


#: Cunningham's factors 1 + Kn (A + B exp(-C/Kn)): Davies (1945), Allen and Raabe (1985), Kim et al.
#: (2005)
CUNNINGHAM = ((1.257, 0.400, 1.10), (1.142, 0.558, 0.999), (1.165, 0.483, 0.997))


@pytest.mark.parametrize("pressure", np.geomspace(1, 1e5, 11))
@pytest.mark.parametrize("factor", CUNNINGHAM)
def test_measured_slip_is_within_the_error_of_the_drag(pressure, factor):
    found = in_medium(name="air", pressure=pressure)
    A, B, C = factor
    Kn = found.knudsen
    assert Kn == pytest.approx(found.mean_free_path / SILICA.bead.radius, rel=1e-9, abs=0)
    stokes = 6 * math.pi * found.viscosity * SILICA.bead.radius
    measured = stokes / (1 + Kn * (A + B * math.exp(-C / Kn)))
    assert abs(found.drag - measured) < found.drag_error
    assert found.drag_error < 0.055 * found.drag


def test_incomplete_accommodation_is_uncertain_between_the_limits():
    """Maxwell's slip, 1.22 (2 - a)/a mean free paths, where the gas is nearly a continuum."""
    found = in_medium(name="air", pressure=1e5, accommodation=0.8)
    Kn = found.knudsen
    assert 0.1 < Kn < 0.2
    stokes = 6 * math.pi * found.viscosity * SILICA.bead.radius
    maxwell = stokes / (1 + 1.22 * 1.2 / 0.8 * Kn)
    assert 0.01 * found.drag < abs(found.drag - maxwell) < found.drag_error
    free = in_medium(name="air", pressure=1e-3, accommodation=0.8)
    assert free.drag_error < 0.055 * free.drag


def test_density_of_a_gas_is_ideal():
    found = in_medium(name="nitrogen", pressure=1e3)
    mass = 0.02801348 / constants.N_A
    assert found.density == pytest.approx(1e3 * mass / (constants.k * 300), rel=1e-9, abs=0)
    assert found.density_error == pytest.approx(5e-5 * found.density, rel=1e-3, abs=0)


def test_card_has_numbers_and_errors():
    told = repr(in_medium(name="glycerol", fraction=0.5))
    assert "MediumProperties of glycerol" in told
    assert "4.68 ± 0.28" in told
    assert "Knudsen number" in told


def test_bodies_of_other_shapes_are_refused():
    with pytest.raises(SceneError, match="has no single drag coefficient"):
        tweezer.medium("flipping-rod")
