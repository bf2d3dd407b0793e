"""Liquids and gases by name: values of published tables, ranges, and what is refused."""

import math

import pytest
from iapws import D2O
from scipy import constants

import tweezer
from tweezer.scene import load_scene
from tweezer.scene.media import MEDIA, SODIUM
from tweezer.scene.water import water
from tweezer.values.errors import SceneError

#: Index of air by which indices of tables, relative to air, become those relative to vacuum
AIR = 1.00027
#: Viscosity of glycerol in water, mPa s, by % of mass and degC: J. B. Segur and H. E. Oberstar,
#: Ind. Eng. Chem. 43, 2117 (1951)
GLYCEROL = {
    (10, 20): 1.31, (20, 20): 1.76, (30, 20): 2.50, (40, 20): 3.72, (50, 20): 6.00, (60, 20): 10.8,
    (70, 20): 22.5, (80, 20): 60.1, (90, 20): 219, (100, 20): 1410, (20, 0): 3.44, (50, 0): 14.6,
    (80, 0): 255, (30, 50): 1.16, (60, 50): 3.76, (90, 50): 35.5, (60, 90): 1.52, (80, 100): 3.18,
    (100, 100): 14.8,
}  # fmt: skip
#: Density of glycerol in water at 20 degC, kg/m^3: L. W. Bosart and A. O. Snoddy, Ind. Eng. Chem.
#: 20, 1377 (1928)
GLYCEROL_DENSITY = {10: 1022.1, 30: 1072.7, 50: 1126.3, 70: 1181.3, 90: 1235.1, 100: 1261.1}
#: and at other temperatures, degC: A. Melinder (2010), from CoolProp 8.0.0
GLYCEROL_WARM = {(20, 0): 1051.51, (60, 0): 1163.96, (20, 40): 1039.67, (60, 40): 1142.40}
#: Sodium chloride in water at 20 degC, by mol/kg: density, kg/m^3, viscosity, mPa s, and index in
#: air at 589 nm: CRC Handbook of Chemistry and Physics
SALT = {
    0.901: (1034.0, 1.085, 1.3418),
    1.901: (1070.7, 1.193, 1.3505),
    4.278: (1147.8, 1.557, 1.3684),
}
#: Sucrose in water at 20 degC, by % of mass, likewise; viscosity relative to water's
SUCROSE = {
    10: (1038.1, 1.333, 1.3478), 20: (1081.0, 1.941, 1.3639), 30: (1127.0, 3.181, 1.3811),
    40: (1176.5, 6.150, 1.3997), 50: (1229.5, 15.40, 1.4200), 60: (1286.4, 58.37, 1.4418),
}  # fmt: skip
#: Viscosity of sucrose in water, mPa s, by % of mass and degC: E. C. Bingham and R. F. Jackson,
#: Bull. Bur. Stand. 14, 59 (1918)
SUCROSE_WARM = {
    (20, 10): 2.652, (20, 30): 1.504, (20, 50): 0.970, (40, 30): 4.382, (40, 50): 2.497,
    (60, 30): 33.78, (60, 40): 21.28, (60, 50): 14.01, (60, 60): 9.83,
}  # fmt: skip
#: Viscosity of ethanol, mPa s, by degC: CRC Handbook of Chemistry and Physics
ETHANOL = {0: 1.786, 25: 1.074, 50: 0.694}
#: Density of ethanol, kg/m^3, by degC: CoolProp 8.0.0 (Schroeder, Penoncello and Schroeder 2014)
ETHANOL_DENSITY = {5: 802.181, 25: 785.133, 55: 758.653}
#: Density, kg/m^3, and viscosity, uPa s, of gases at 101325 Pa, by K: CoolProp 8.0.0
GAS = {
    "air": {250: (1.41331, 16.0381), 300: (1.17700, 18.5373), 400: (0.882307, 23.0554)},
    "nitrogen": {250: (1.36664, 15.4996), 300: (1.13816, 17.8901), 400: (0.853230, 22.2085)},
    "argon": {250: (1.94994, 19.4817), 300: (1.62376, 22.7410), 400: (1.21710, 28.7037)},
    "oxygen": {250: (1.56201, 17.7954), 300: (1.30069, 20.6524), 400: (0.974922, 25.8396)},
    "helium": {200: (0.243710, 15.1424), 300: (0.162516, 19.9297), 500: (0.0975300, 28.3631)},
}
#: n - 1 at 589 nm, 0 degC and 101325 Pa, but of air at 15 degC: G. W. C. Kaye and T. H. Laby,
#: Tables of Physical and Chemical Constants
REFRACTIVITY = {
    "air": 2.77e-4, "nitrogen": 2.98e-4, "argon": 2.81e-4, "oxygen": 2.71e-4, "helium": 3.5e-5,
}  # fmt: skip


def at(name, celsius, part=0.0, wavelength=SODIUM):
    """Properties and errors of a medium."""
    fluid = MEDIA[name]
    found = fluid.at(celsius + 273.15, part, wavelength)
    return found, fluid.errors(found)


@pytest.mark.parametrize(("percent", "celsius"), GLYCEROL)
def test_viscosity_of_glycerol_in_water(percent, celsius):
    found, error = at("glycerol", min(celsius, 99.9), percent / 100)
    expected = 1e-3 * GLYCEROL[percent, celsius]
    assert found.viscosity == pytest.approx(expected, abs=error.viscosity)


def test_density_of_glycerol_in_water():
    table = {(percent, 20): each for percent, each in GLYCEROL_DENSITY.items()} | GLYCEROL_WARM
    for (percent, celsius), expected in table.items():
        found, error = at("glycerol", celsius, percent / 100)
        assert found.density == pytest.approx(expected, abs=error.density)
        assert found.density == pytest.approx(expected, rel=5e-4)


@pytest.mark.parametrize("molality", SALT)
def test_salt_water_is_that_of_the_handbook(molality):
    density, viscosity, index = SALT[molality]
    found, error = at("salt-water", 20, molality)
    assert found.density == pytest.approx(density, abs=error.density)
    assert found.viscosity == pytest.approx(1e-3 * viscosity, abs=error.viscosity)
    assert found.refractive_index == pytest.approx(AIR * index, abs=error.refractive_index)


@pytest.mark.parametrize("celsius", [20, 37, 80])
def test_salt_water_is_that_of_another_program(celsius):
    """Kestin's equations as pylake has them, without their pressure."""
    from lumicks.pylake.force_calibration.detail import salty_water

    kelvin = 273.15 + celsius
    of_water = (
        salty_water.zero_pressure_viscosity(celsius, 0.0),
        salty_water._density_of_salt_solution(celsius, 0.0, 0.0),
    )
    for molality in (0.15, 1.0, 6.0):
        found, _ = at("salt-water", celsius, molality)
        viscosity = salty_water.zero_pressure_viscosity(celsius, molality) / of_water[0]
        density = salty_water._density_of_salt_solution(celsius, molality, 0.0) / of_water[1]
        assert found.viscosity / water(kelvin).viscosity == pytest.approx(viscosity, rel=1e-9)
        assert found.density / water(kelvin).density == pytest.approx(density, rel=1e-9)


@pytest.mark.parametrize("percent", SUCROSE)
def test_sucrose_in_water_is_that_of_the_handbook(percent):
    density, ratio, index = SUCROSE[percent]
    found, error = at("sucrose", 20, percent / 100)
    expected = ratio * water(293.15).viscosity
    assert found.density == pytest.approx(density, abs=error.density)
    assert found.viscosity == pytest.approx(expected, abs=error.viscosity)
    assert found.refractive_index == pytest.approx(AIR * index, abs=error.refractive_index)


def test_viscosity_of_warm_sucrose():
    for (percent, celsius), expected in SUCROSE_WARM.items():
        found, error = at("sucrose", celsius, percent / 100)
        assert found.viscosity == pytest.approx(1e-3 * expected, abs=error.viscosity)


def test_ethanol_is_that_of_the_handbook():
    for celsius, expected in ETHANOL.items():
        found, error = at("ethanol", celsius)
        assert found.viscosity == pytest.approx(1e-3 * expected, abs=error.viscosity)
    for celsius, expected in ETHANOL_DENSITY.items():
        assert at("ethanol", celsius)[0].density == pytest.approx(expected, rel=1e-5)
    found, error = at("ethanol", 25)
    assert found.refractive_index == pytest.approx(1.3594, abs=error.refractive_index)


@pytest.mark.parametrize("celsius", [4, 20, 37, 60, 99.9])
def test_heavy_water_is_that_of_the_releases(celsius):
    """IAPWS R16-17 and R17-20 as the package `iapws` has them."""
    full = D2O(T=celsius + 273.15, P=0.101325)
    found, error = at("heavy-water", celsius)
    assert found.density == pytest.approx(full.rho, abs=error.density)
    assert found.density == pytest.approx(full.rho, rel=5e-6)
    assert found.viscosity == pytest.approx(full.mu, rel=5e-4)


def test_index_of_pure_liquids_at_the_sodium_line():
    """Indices in air at 20 degC of the CRC Handbook."""
    for name, part, expected in (
        ("heavy-water", 0.0, 1.3284), ("ethanol", 0.0, 1.3614), ("glycerol", 1.0, 1.4735),
        ("glycerol", 0.5, 1.3981),
    ):  # fmt: skip
        found, error = at(name, 20, part)
        assert found.refractive_index == pytest.approx(AIR * expected, abs=error.refractive_index)


@pytest.mark.parametrize("wavelength", [0.45e-6, SODIUM, 1.064e-6])
@pytest.mark.parametrize(
    ("name", "parts"), [("glycerol", (1e-6,)), ("salt-water", (0.0, 1e-9)), ("sucrose", (0, 1e-9))]
)
def test_mixtures_without_solute_are_water(name, parts, wavelength):
    for part in parts:
        found, _ = at(name, 25, part, wavelength)
        for mixed, pure in zip(found[:3], water(298.15, wavelength), strict=True):
            assert mixed == pytest.approx(pure, rel=3e-6)


@pytest.mark.parametrize("name", GAS)
def test_gases_are_those_of_the_tables(name):
    fluid = MEDIA[name]
    for kelvin, (density, viscosity) in GAS[name].items():
        found = fluid.at(kelvin, 101325.0, SODIUM)
        error = fluid.errors(found)
        assert found.density == pytest.approx(density, abs=error.density)
        assert found.viscosity == pytest.approx(1e-6 * viscosity, abs=error.viscosity)


@pytest.mark.parametrize("name", GAS)
def test_index_and_free_path_of_a_gas(name):
    fluid = MEDIA[name]
    found = fluid.at(288.15 if name == "air" else 273.15, 101325.0, SODIUM)
    error = fluid.errors(found).refractive_index
    assert found.refractive_index - 1 == pytest.approx(REFRACTIVITY[name], abs=error)
    # mean free path of hard spheres of the same viscosity, mu = 0.499 rho <c> l
    speed = math.sqrt(8 * constants.R * 273.15 / (math.pi * fluid.molar_mass))
    cold = fluid.at(273.15, 1e-3, SODIUM)
    expected = cold.viscosity / (0.499 * cold.density * speed)
    assert cold.mean_free_path == pytest.approx(expected, rel=3e-3, abs=0)


def scene(**medium):
    """A scene in a medium, with a lens for air."""
    data = load_scene("silica-1um").model_dump(exclude_none=True)
    lens = {**data["lens"], "numerical_aperture": 0.8}
    return {**data, "lens": lens, "medium": {"temperature": 300, **medium}}


GLYCERINE = {"name": "glycerol", "temperature": 300, "fraction": 0.5}


@pytest.mark.parametrize(
    ("medium", "told"),
    [
        ({"name": "glycerol"}, "medium.fraction: missing; medium.name = 'glycerol' requires it"),
        ({"name": "air"}, "medium.pressure: missing; medium.name = 'air' requires it"),
        ({"name": "sucrose", "fraction": 0.7}, "medium.fraction = 0.7: outside the known range of "
         "sucrose; must be from 0 to 0.6"),
        ({"name": "salt-water", "molality": 1, "temperature": "10 degC"},
         "medium.temperature = '10 degC': outside the known range of salt-water; must be from "
         "293.15 to 373.12 K"),
        ({"name": "air", "pressure": "3 bar"}, "medium.pressure = '3 bar': outside the known range "
         "of air; must be from 1e-10 to 200000 Pa"),
        ({"name": "water", "pressure": 1}, "medium.pressure: requires name = 'air' or 'nitrogen'"),
        ({"name": "water", "accommodation": 0.9}, "medium.accommodation: requires name = 'air' or"),
        ({"name": "sucrose", "fraction": 0.1, "molality": 1}, "medium.molality: requires name = "
         "'salt-water'; remove it"),
        ({"name": "air", "pressure": "1 mbar", "inertia": "memory"}, "medium.inertia = 'memory': "
         "the mean free path in the gas is 1.4e+02 of the radius"),
        ({"name": "air", "pressure": "1 mm"}, "medium.pressure = '1 mm': has the wrong unit"),
    ],
)  # fmt: skip
def test_what_a_medium_cannot_be_is_refused_in_one_line(medium, told):
    with pytest.raises(SceneError) as refused:
        load_scene(scene(**medium))
    assert told in str(refused.value)
    assert len(str(refused.value).splitlines()) == 1


def test_wavelength_beyond_the_range_requires_an_index():
    data = scene(**GLYCERINE)
    data["beam"]["wavelength"] = "1.55 um"
    with pytest.raises(SceneError, match=r"index of glycerol .* give medium.refractive_index"):
        load_scene(data)
    data["medium"]["refractive_index"] = 1.39
    assert load_scene(data).medium.filled == {"density", "viscosity"}
    data["medium"] = {"name": "air", "temperature": 300, "pressure": 100}
    assert load_scene(data).medium.refractive_index == pytest.approx(1, abs=1e-6)


def test_own_numbers_win_and_alone_are_kept_with_the_scene():
    found = load_scene(scene(**GLYCERINE, viscosity="6 mPa s"))
    assert found.medium.viscosity == 6e-3
    kept = found.model_dump(exclude_none=True)["medium"]
    assert set(kept) == {"name", "temperature", "fraction", "viscosity", "mean_free_path"}
    assert load_scene(found.model_dump(exclude_none=True)) == found


def test_another_name_removes_the_keys_of_the_former():
    found = load_scene(scene(**GLYCERINE)).replace(medium={"name": "air", "pressure": "1 mbar"})
    assert found.medium.fraction is None
    assert found.medium.filled == {"refractive_index", "density", "viscosity", "mean_free_path"}
    assert load_scene(found.model_dump(exclude_none=True)) == found
    wet = found.replace(medium={"name": "water"}).medium
    assert (wet.pressure, wet.mean_free_path) == (None, 3e-10)


def test_bead_in_glycerol_has_its_drag():
    found = tweezer.bead_properties(scene(**{**GLYCERINE, "temperature": "20 degC"}))
    assert found.drag == pytest.approx(6 * math.pi * 6.0e-3 * 0.5e-6, rel=0.06, abs=0)
