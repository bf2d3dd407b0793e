"""`medium.name = "water"`: values of the releases, own numbers, changes, and what is refused."""

import json
import subprocess
import sys

import numpy as np
import pytest
from iapws import IAPWS95

import tweezer
from tweezer.scene import by_key, load_scene
from tweezer.scene.water import water
from tweezer.values.errors import PhysicsWarning, SceneError

#: Density, kg/m^3, and viscosity, mPa s, at 1 atm: as IAPWS's releases of 1995 and 2008 give them;
#: 1.0016 is ISO/TR 3666's standard at 20 degC
KNOWN = {
    20: (998.207, 1.0016),
    25: (997.047, 0.8900),
    60: (983.196, 0.4660),
}


@pytest.mark.parametrize("celsius", KNOWN)
def test_density_and_viscosity_are_those_of_the_releases(celsius):
    density, viscosity = KNOWN[celsius]
    found = water(celsius + 273.15)
    assert found.density == pytest.approx(density, abs=1e-3)
    assert 1e3 * found.viscosity == pytest.approx(viscosity, abs=6e-5)


@pytest.mark.parametrize("kelvin", np.linspace(273.15, 373.12, 11))
def test_properties_agree_with_the_full_formulations(kelvin):
    """IAPWS-95, R12-08 and R9-97 as the package `iapws` has them, over all of liquid water.

    The differences are the accuracy of the short forms of SR6-08.
    """
    full, found = IAPWS95(T=kelvin, P=0.101325, l=0.5893), water(kelvin)
    assert found.density == pytest.approx(full.rho, rel=5e-8)
    assert found.viscosity == pytest.approx(full.mu, rel=3.1e-5)
    assert found.refractive_index == pytest.approx(full.n, abs=2e-8)


def test_density_is_that_of_the_release():
    """Table 7 of IAPWS-95: 996.556 kg/m^3 at 300 K and 0.0992418352 MPa, and the compression."""
    expected = 996.556 * (1 + 4.50e-10 * (101325 - 99241.8352))
    assert water(300).density == pytest.approx(expected, rel=5e-8)


@pytest.mark.parametrize(
    ("celsius", "micrometres", "index"),
    # table 3 of R9-97: at 0.1 MPa, and at 997.047435 kg/m^3
    [(0, 0.2265, 1.394527), (0, 0.589, 1.334344), (0, 1.01398, 1.326135), (25, 0.2265, 1.392778)],
)
def test_index_is_that_of_the_release(celsius, micrometres, index):
    found = water(celsius + 273.15, 1e-6 * micrometres).refractive_index
    assert found == pytest.approx(index, abs=1.5e-6)


def plain(**medium):
    """A scene whose medium is that."""
    scene = load_scene("silica-1um").model_dump(exclude_none=True)
    return {**scene, "medium": medium}


def test_a_name_and_a_temperature_are_enough():
    scene = load_scene(plain(name="water", temperature="25 degC"))
    assert scene.medium.density == pytest.approx(997.047, abs=1e-3)
    assert scene.medium.viscosity == pytest.approx(0.8900e-3, rel=1e-4)
    expected = water(298.15, scene.beam.wavelength).refractive_index
    assert scene.medium.refractive_index == expected
    assert 1.32 < expected < 1.335


def test_own_numbers_win_and_alone_are_kept_with_the_scene():
    scene = load_scene(plain(name="water", temperature="25 degC", viscosity="1.2 mPa s"))
    assert scene.medium.viscosity == 1.2e-3
    assert scene.medium.density == water(298.15).density
    kept = scene.model_dump(exclude_none=True)["medium"]
    assert set(kept) == {"name", "temperature", "viscosity", "mean_free_path"}
    assert load_scene(scene.model_dump(exclude_none=True)) == scene
    assert '"density"' not in scene.medium.model_dump_json()


def test_another_temperature_takes_all_along(recwarn):
    scene = load_scene(plain(name="water", temperature="20 degC"))
    warm = scene.replace(medium={"temperature": "37 degC"})
    assert warm.medium.viscosity == water(310.15).viscosity < 0.7 * scene.medium.viscosity
    assert "as before" not in warm.title
    assert by_key(warm.model_dump())["medium.temperature"] == 310.15
    assert not [each for each in recwarn if each.category is PhysicsWarning]
    assert warm != scene
    assert warm.replace(medium={"temperature": "20 degC"}) == scene


def test_a_name_takes_the_place_of_numbers():
    scene = load_scene("silica-1um")
    named = scene.replace(medium={"name": "water", "viscosity": "1.1 mPa s"})
    assert named.medium.filled == {"density", "refractive_index"}
    assert named.medium.viscosity == 1.1e-3
    assert "medium.density" not in repr(named)
    own = named.replace(medium={"density": 1010})
    assert (own.medium.density, own.medium.filled) == (1010, {"refractive_index"})


@pytest.mark.parametrize(
    ("medium", "told"),
    [
        ({"name": "water", "temperature": "-4 degC"}, "= '-4 degC': water is ice"),
        ({"name": "water", "temperature": 400}, "= 400: water is steam at 400 K; "
         "must be from 273.15 to 373.12 K"),
        ({"name": "oil", "temperature": 300}, "medium.name = 'oil': allowed: 'water'"),
        ({"name": "water"}, "medium.temperature: missing"),
        ({"name": "water", "temperature": "20 C"}, "did you mean degC?"),
        ({"temperature": 300, "density": 1000, "viscosity": 1e-3},
         "medium.refractive_index: missing"),
    ],
)  # fmt: skip
def test_what_it_cannot_be_is_refused_in_one_line(medium, told):
    with pytest.raises(SceneError) as refused:
        load_scene(plain(**medium))
    assert told in str(refused.value)
    if "oil" not in told:
        assert len(str(refused.value).splitlines()) == 1


def test_wavelengths_beyond_the_release_need_an_index():
    scene = plain(name="water", temperature=300)
    scene["beam"]["wavelength"] = "1.55 um"
    with pytest.raises(SceneError, match=r"beam.wavelength .* give medium.refractive_index"):
        load_scene(scene)
    scene["medium"]["refractive_index"] = 1.318
    assert load_scene(scene).medium.filled == {"density", "viscosity"}


def test_beams_of_two_colours_need_an_index():
    scene = plain(name="water", temperature=300)
    del scene["more_beams"]
    scene["beam"] = [scene["beam"], {**scene["beam"], "wavelength": "0.8 um"}]
    with pytest.raises(SceneError, match="each of the beams' wavelengths; give medium"):
        load_scene(scene)
    scene["medium"]["refractive_index"] = 1.33
    assert len(load_scene(scene).beams) == 2


def test_water_is_not_compiled():
    program = "import sys, tweezer.scene.water as w; w.water(300.0); print('numba' in sys.modules)"
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == "False"


def test_a_run_keeps_the_name():
    scene = load_scene(plain(name="water", temperature="25 degC"))
    run = tweezer.simulate(scene, duration="10 us")
    assert load_scene(json.loads(run.attrs["scene_as_given"])).medium == scene.medium
