"""What a sweep varies, as a user gives it."""

import numpy as np
import pandas as pd
import pytest
import xarray as xr

import tweezer
from tweezer.scene.choices import SWEPT
from tweezer.sweeps.cases import cases_of, read_over
from tweezer.sweeps.quantities import QUANTITIES


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("bead.diameter=1um..3um:3", [1e-6, 2e-6, 3e-6]),
        ("bead.diameter = 100 nm .. 0.4um:3:log", [1e-7, 2e-7, 4e-7]),
        ("beam.power=1mW..1W:4:log", [1e-3, 1e-2, 1e-1, 1.0]),
        ("lens.numerical_aperture=0.8..1.2:3", [0.8, 1.0, 1.2]),
        ("medium.temperature=20 degC..30degC:2", [293.15, 303.15]),
        ("bead.diameter=500 nm,1e-6", [5e-7, 1e-6]),
        ("simulation.samples=101,201", [101, 201]),
        ("optics.theory=rays,waves", ["rays", "waves"]),
        ("forces.gravity=true,False", [True, False]),
        ('start.position=[0,0,"1 um"],[0, 0, 0]', ["[0.0, 0.0, 1e-06]", "[0.0, 0.0, 0.0]"]),
        ("medium.density=1 g/cm^3..2000 kg/m^3:2", [1000.0, 2000.0]),
        ("lens.cover.depth=5um,10um", [5e-6, 1e-5]),
    ],
)
def test_values_of_a_key(text, values):
    (axis,) = cases_of(read_over([text]), None).axes
    (varied,) = axis.varied
    assert varied.key == axis.name == text.partition("=")[0].strip()
    if isinstance(values[0], float):
        assert varied.values == pytest.approx(values, rel=1e-15)
    else:
        assert list(varied.values) == values


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("bead.diameter", "must be KEY=FROM..TO:COUNT"),
        ("bead.diameter=1um..2um", "must be FROM..TO:COUNT"),
        ("bead.diameter=1um..2um:1", "COUNT must be from 2"),
        ("bead.diameter=1um..2um:5:lin", "must be FROM..TO:COUNT"),
        ("bead.diameter=0um..2um:5:log", "both ends must be above 0"),
        ("bead.diameter=1uX..2um:5", "over bead.diameter = '1uX': has an unknown unit"),
        ("bead.diameter=1um,2mW", "over bead.diameter = '2mW': has the wrong unit"),
        ("optics.theory=a..b:3", "an end of a range must be a number"),
        ("bead.diametr=1um", "bead.diametr: unknown key; did you mean bead.diameter?"),
        ("bead.diameter=1..3um:3", "bead.diameter = 1..3um:3: give both ends a unit"),
        ("bead.diameter=1um,2um..3um:3", "must be a list or a range, not both"),
        ("bead.diameter=1um,1e-6", "bead.diameter = 1e-06: is given twice"),
        ("start.position=[0,0,1um]", "text within brackets needs quotes"),
        ('start.position=[0,0,"1 mW"]', "has the wrong unit"),
        ("bead.diameter.x=1", "bead.diameter.x: unknown key"),
        ("bead=1", "bead: must be section.key"),
        ("lens.cover=1", "lens.cover: must be section.key"),
    ],
)
def test_what_is_no_range(text, told):
    with pytest.raises(tweezer.SceneError, match=told.replace(".", "\\.").replace("?", "\\?")):
        cases_of(read_over([text]), None)


def test_a_table_beside_keys(tmp_path):
    """Of a file with units in headings and cells; each row is a case for each combination."""
    file = tmp_path / "beads.csv"
    file.write_text(
        "bead.refractive_index, bead.density [g/cm^3],beam.power\n1.45,2,1 mW\n1.57,1.05,2e-3\n"
    )
    cases = cases_of({"bead.diameter": ["1 um", "2 um", "3 um"]}, file)
    assert cases.shape == (2, 3)
    rows = cases.describe()["case"]
    assert rows["bead.refractive_index"] == [1.45, 1.57]
    assert rows["bead.density"] == pytest.approx([2000.0, 1050.0], rel=1e-15)
    assert rows["beam.power"] == [1e-3, 2e-3]
    assert {key: float(text) for key, text in cases.settings(4).items()} == pytest.approx({
        "bead.refractive_index": 1.57, "bead.density": 1050.0, "beam.power": 2e-3,
        "bead.diameter": 2e-6,
    })  # fmt: skip
    frame = pd.DataFrame({"bead.diameter [um]": [1.0, 2.0], "beam.power": ["1 mW", "2 mW"]})
    described = frame.rename(columns={"bead.diameter [um]": "bead.diameter"}).to_xarray()
    described["bead.diameter"].attrs["units"] = "um"
    coordinates = described.set_coords(["bead.diameter", "beam.power"])
    for table in (frame, frame.to_xarray(), described, coordinates, dict(frame)):
        (axis,) = cases_of(None, table).axes
        found = {each.key: each.values for each in axis.varied}
        assert found == {"bead.diameter": (1e-6, 2e-6), "beam.power": (1e-3, 2e-3)}
    across = xr.Dataset({"bead.diameter": ("i", [1e-6]), "beam.power": ("j", [1e-3])})
    with pytest.raises(tweezer.SceneError, match="must have one dimension, which all keys share"):
        cases_of(across, None)


def test_text_has_no_units():
    """Neither has a vector, which the result has as text."""
    over = {
        "start.position": [[0, 0, "1 um"]],
        "bead.diameter": ["1 um"],
        "optics.theory": ["rays"],
    }
    assert [axis.varied[0].unit for axis in cases_of(over, None).axes] == ["", "m", ""]


@pytest.mark.parametrize(
    ("content", "told"),
    [("bead.diameter,beam.power\n1 um,\n", "line 2: beam.power is empty"),
     ("bead.diameter,beam.power\n1 um\n", "line 2: 1 cells under 2 headings"),
     ("bead.diameter,beam.power\n1 um,1 W\n\n1 um,1 W,7\n", "line 4: 3 cells under 2 headings"),
     ("bead.diameter,bead.diameter\n1 um,2 um\n", "bead.diameter: is swept over twice"),
     ("bead.diameter um\n1\n", "'bead.diameter um': must be a key"),
     ("bead.size\n1 um\n", "bead.size: unknown key"),
     ("bead.diameter\n", "bead.diameter: has no values"),
     ("", "not a table of cases")],
)  # fmt: skip
def test_what_is_no_table(tmp_path, content, told):
    file = tmp_path / "cases.csv"
    file.write_text(content)
    with pytest.raises(tweezer.TweezerError, match=told):
        cases_of(None, file)


def test_groups_keep_to_a_light():
    """Whatever the order of the keys, cases of a group differ in the power alone."""
    powers, sizes = [1e-3, 2e-3, 3e-3], [1e-6, 2e-6]
    cases = cases_of({"beam.power": powers, "bead.diameter": sizes}, None)
    assert cases.by_light() == [[0, 2, 4], [1, 3, 5]]
    assert [cases.settings(case)["bead.diameter"] for case in (0, 2, 4)] == ["1e-06"] * 3
    assert cases_of({"bead.diameter": sizes}, None).by_light() == [[0], [1]]
    assert np.ravel(cases_of({"beam.power": powers}, None).by_light()).tolist() == [0, 1, 2]


def test_numbers_in_unusual_units_are_doubted():
    with pytest.warns(tweezer.UnitWarning, match="over beam.power: is 80 W"):
        cases_of({"beam.power": [1.0, 80.0]}, None)


def test_every_kind_of_sweep_has_its_quantities():
    assert tuple(QUANTITIES) == SWEPT
