"""`bead.material`: indices of published tables, changes of the wavelength, layers, refusals."""

import math

import numpy as np
import pytest

from tests import catalogue_page
from tweezer.scene import by_key, load_scene, with_settings
from tweezer.scene.materials import materials
from tweezer.values.errors import SceneError

#: Index by vacuum wavelength, nm, as tables print it
PRINTED = {
    # Malitson (1965), fused silica at the lines of mercury, hydrogen, helium; 1064 nm: makers
    "silica": {404.656: 1.46962, 486.133: 1.46313, 546.073: 1.46008, 587.561: 1.45846,
               656.272: 1.45637, 1064: 1.44963},
    # Johnson and Christy (1972) at 2.38, 2.26, 1.88 and 1.14 eV, and what is usually quoted of them
    "gold": {520.94: 0.62 + 2.081j, 548.60: 0.43 + 2.455j, 659.49: 0.14 + 3.697j,
             1087.58: 0.27 + 7.150j, 532: 0.5439 + 2.2309j, 1064: 0.2585 + 6.9654j},
    # Green (2008): rows that are in the catalogue, and rows between them
    "silicon": {600: 3.940 + 1.9934e-2j, 750: 3.717 + 7.8185e-3j, 800: 3.675 + 5.4113e-3j,
                850: 3.641 + 3.612e-3j, 990: 3.575 + 6.2238e-4j, 1000: 3.572 + 5.0930e-4j,
                1050: 3.556 + 1.362e-4j, 1060: 3.553 + 9.3631e-5j, 1070: 3.550 + 6.8118e-5j,
                1190: 3.522 + 3.4091e-7j},
}  # fmt: skip
#: rounded as they are printed; the energies of gold are
CLOSE = {"silica": 6e-6, "gold": 4e-3, "silicon": 8e-4}


@pytest.mark.parametrize(("name", "nm"), [(name, nm) for name in PRINTED for nm in PRINTED[name]])
def test_indices_are_those_of_the_tables(name, nm):
    found = materials()[name].refractive_index(1e-9 * nm)
    assert found == pytest.approx(PRINTED[name][nm], abs=CLOSE[name])


@pytest.mark.parametrize(
    # index at helium's d line, and the number of Abbe, as data sheets of optical plastics have them
    ("name", "index", "abbe"), [("polystyrene", 1.591, 30.9), ("pmma", 1.492, 57.4)],
)  # fmt: skip
def test_plastics_are_those_of_the_data_sheets(name, index, abbe):
    n = {line: materials()[name].refractive_index(1e-9 * nm).real
         for line, nm in (("F", 486.13), ("d", 587.56), ("C", 656.27))}  # fmt: skip
    assert n["d"] == pytest.approx(index, abs=1.5e-3)
    assert (n["d"] - 1) / (n["F"] - n["C"]) == pytest.approx(abbe, rel=0.05)


def test_polystyrene_in_the_infrared_is_within_its_error_of_other_measurements():
    """Zhang et al. (2020), Matheson and Saunderson (1952), Ma et al. (2003): at 1064 nm."""
    others = [1.5695, 1.5663 + 7.85e3 / 1064**2 + 3.34e8 / 1064**4,
              1.5725 + 3.1080e3 / 1064**2 + 3.4779e8 / 1064**4]  # fmt: skip
    polystyrene = materials()["polystyrene"]
    found = polystyrene.refractive_index(1.064e-6)
    assert found.imag == 0
    assert found.real == pytest.approx(1.5715, abs=1e-4)
    assert max(abs(found.real - other) for other in others) < polystyrene.error + 1e-4


def test_pmma_between_its_absorptions_is_as_one_oscillator_has_it():
    """1/(n^2 - 1) of an undamped oscillator is a straight line in 1/l^2 (Sellmeier's equation with
    one term), as the other plastic here is given.
    """
    um = np.linspace(0.42, 1.62, 25)
    index = np.array([materials()["pmma"].refractive_index(1e-6 * each).real for each in um])
    line = np.polyval(np.polyfit(um**-2, 1 / (index**2 - 1), 1), um**-2)
    assert np.sqrt(1 + 1 / line) == pytest.approx(index, abs=9e-4)


def test_gold_between_its_points_is_near_what_free_electrons_have():
    """n k' of a Drude metal goes with the wavelength, which a straight line keeps."""
    gold = materials()["gold"]
    for nm in range(750, 1400, 50):
        low, high = (gold.refractive_index(1e-9 * (nm + d)).imag / (nm + d) for d in (-40, 40))
        assert gold.refractive_index(1e-9 * nm).imag / nm == pytest.approx(
            math.sqrt(low * high), rel=0.02
        )


@pytest.mark.parametrize(
    # how far a row may be off the cubic through its four neighbours: twice the farthest is
    ("name", "column", "used", "off"),
    [("silicon", 1, slice(1, -1), 1.4e-3), ("silicon", 2, slice(0, 33), 0.15),
     ("gold", 1, slice(1, -1), 0.2), ("gold", 2, slice(1, -1), 0.12)],
)  # fmt: skip
def test_rows_of_a_table_lie_on_a_smooth_curve(name, column, used, off):
    """A wrong digit stands out: of silicon, the second last of its index, the first of what it
    absorbs, of which the logarithm is taken; of gold, the first.
    """
    rows = np.array(materials()[name].numbers)
    along = 1 / rows[:, 0] if name == "gold" else rows[:, 0]
    value = np.log(rows[:, column]) if (name, column) == ("silicon", 2) else rows[:, column]
    found = []
    for i in range(len(rows)):
        first = min(max(i - 2, 0), len(rows) - 5)
        near = [j for j in range(first, first + 5) if j != i]
        found.append(np.polyfit(along[near] - along[i], value[near], 3)[-1] - value[i])
    assert np.abs(found[used]).max() < off


def of(bead, **beam):
    scene = load_scene("silica-1um").model_dump(exclude_none=True)
    return {**scene, "bead": bead, "beam": {**scene["beam"], **beam}}


def test_a_material_gives_index_and_density_at_the_wavelength():
    scene = load_scene(of({"material": "silica", "diameter": "1 um"}))
    assert scene.bead.density == 2000
    assert scene.bead.refractive_index == pytest.approx(1.44963, abs=1e-5)
    green = with_settings(scene, {"beam.wavelength": "546.073 nm"})
    assert green.bead.refractive_index == pytest.approx(1.46008, abs=1e-5)
    assert green.title.endswith("beam.wavelength = 546.073 nm")
    kept = green.model_dump(exclude_none=True)
    assert kept["bead"] == {"material": "silica", "radius": 5e-7}
    assert load_scene(kept) == green
    assert "µm of silica, index 1.4496, 2000 kg" in repr(scene)
    assert "bead.density" not in repr(scene)


def test_own_numbers_stand_beside_a_material_and_it_takes_the_place_of_others():
    scene = load_scene("silica-1um")
    gold = scene.replace(bead={"material": "gold"})
    assert gold.bead.filled == {"refractive_index", "density"}
    assert gold.bead.absorbs
    assert gold.bead.density == 19300
    own = gold.replace(bead={"refractive_index": "0.16+6.91j"})
    assert (own.bead.index, own.bead.density) == (0.16 + 6.91j, 19300)
    assert by_key(own.model_dump())["bead.refractive_index"] == (0.16, 6.91)


def test_layers_of_materials_weigh_what_their_volumes_do():
    shells = [{"material": "silica", "diameter": "0.5 um"}, {"material": "gold", "radius": 5e-7}]
    scene = load_scene(of({"layers": shells}))
    assert scene.bead.density == pytest.approx(2000 / 8 + 19300 * 7 / 8)
    assert [index for _, index in scene.bead.shells] == pytest.approx(
        [1.44963, 0.2585 + 6.9654j], abs=1e-4
    )
    assert load_scene(scene.model_dump(exclude_none=True)) == scene
    heavy = scene.replace(bead={"density": 5000})
    assert heavy.bead.density == 5000
    whole = heavy.replace(bead={"material": "pmma", "diameter": "1 um"}).bead
    assert (whole.layers, whole.density) == (None, 1190)


@pytest.mark.parametrize(
    ("bead", "beam", "told"),
    [
        ({"material": "polystyrene", "radius": 5e-7}, {"wavelength": "1.55 um"},
         "beam.wavelength = 1.55e-06: the index of polystyrene is known from 0.4368 to 1.1 um, "
         "not at 1.55 um; give bead.refractive_index"),
        ({"layers": [{"material": "silicon", "radius": 5e-7}]}, {"wavelength": "405 nm"},
         "known from 0.5 to 1.2 um, not at 0.405 um; give bead.layers.0.refractive_index"),
        ({"material": "polystirene", "radius": 5e-7}, {}, "bead.material = 'polystirene': allowed"),
        ({"material": "gold", "layers": [{"material": "gold", "radius": 5e-7}]}, {},
         "bead.material = gold: cannot be combined with layers"),
        ({"layers": [{"refractive_index": 2, "radius": 5e-7}]}, {}, "bead.density: missing"),
    ],
)  # fmt: skip
def test_what_it_cannot_be_is_refused(bead, beam, told):
    with pytest.raises(SceneError) as refused:
        load_scene(of(bead, **beam))
    (line,) = str(refused.value).splitlines()
    assert told in line


def test_beams_of_two_colours_need_an_index():
    scene = of({"material": "silica", "radius": 5e-7})
    del scene["more_beams"]
    scene["beam"] = [scene["beam"], {**scene["beam"], "wavelength": "0.8 um"}]
    water = {**scene, "medium": {"name": "water", "temperature": 300}}
    layers = [{"material": "silica", "radius": 4e-7}, {"material": "gold", "radius": 5e-7}]
    within = {"layers": [{**layers[0], "refractive_index": 1.45}, layers[1]]}
    several = "a different index at each of the beams' wavelengths; give"
    for line, wrong in [
        (f"bead.material = 'silica': has {several} bead.refractive_index", scene),
        (f"bead.material = 'silica' and medium.name = 'water': have {several} "
         "bead.refractive_index and medium.refractive_index", water),
        (f"bead.layers.1.material = 'gold' and medium.name = 'water': have {several} "
         "bead.layers.1.refractive_index and medium.refractive_index", {**water, "bead": within}),
    ]:  # fmt: skip
        with pytest.raises(SceneError) as refused:
            load_scene(wrong)
        assert str(refused.value) == line
    scene["bead"]["refractive_index"] = 1.45
    assert load_scene(scene).bead.filled == {"density"}


def test_every_index_is_known_in_its_whole_range_and_no_further():
    for material in materials().values():
        low, high = (1e-6 * um for um in material.used)
        for wavelength in (low, high):
            assert 0.1 < material.refractive_index(wavelength).real < 6
        for wavelength in (0.999 * low, 1.001 * high):
            with pytest.raises(ValueError, match=f"the index of {material.name} is known from"):
                material.refractive_index(wavelength)


def test_the_page_has_what_the_catalogues_have():
    page = catalogue_page.PAGE.read_text(encoding="utf-8")
    for name, block in catalogue_page.written().items():
        assert catalogue_page.between(name).findall(page) == [block]
