"""Quantities of pint, arrays and numbers with units, wherever a quantity is taken."""

import re

import numpy as np
import pint
import pytest
import xarray as xr

import tweezer
from tweezer.forces import Course, Moved, UserForce, kernel
from tweezer.values.rounding import least, most
from tweezer.values.units import array_in_si, in_base_units, to_si

#: a registry of a user, which is not that of tweezer
unit = pint.UnitRegistry()
#: another, whose units are written in short
short = pint.UnitRegistry()
short.formatter.default_format = "~"
SCENE = tweezer.load_scene("thesis-990nm").replace(
    start={"frame": "focus", "position": [0, 0, 0]}, optics={"theory": "rays"}
)


@pytest.mark.parametrize(
    ("value", "in_unit", "expected"),
    [
        (unit("80 mW"), "W", 0.08),
        (unit.Quantity(20.0, "degC"), "K", 293.15),
        (unit("0.9 cP"), "Pa s", 9e-4),
        (unit("3 kHz"), "1/s", 3000.0),
        (unit("30 rpm"), "rad/s", np.pi),
        (unit("180 deg"), "rad", np.pi),
        (short("30 rpm"), "rad/s", np.pi),
        (unit.Quantity(1.5, ""), "rad", 1.5),
        (unit("1.05 g/cm^3"), "kg/m^3", 1050.0),
        (unit.Quantity(1.33), "", 1.33),
        (unit.Quantity(np.float32(2.0), "um"), "m", 2e-6),
        (np.float32(0.5), "m", 0.5),
        (np.int64(3), "s", 3.0),
        (np.array(3.0), "s", 3.0),
        (xr.DataArray(5.0, attrs={"units": "ms"}), "s", 5e-3),
        (xr.DataArray(5.0), "s", 5.0),
    ],
)
def test_a_number_with_its_unit(value, in_unit, expected):
    assert to_si(value, in_unit) == pytest.approx(expected, rel=1e-14)


@pytest.mark.parametrize(
    ("value", "in_unit", "told"),
    [
        (unit("3 s"), "m", "must be convertible to m, such as um"),
        (unit("3 m"), "", "must be a number without one"),
        (unit("65 deg"), "", "must be a number without one"),  # pint would take it as 1.13
        (short("65 deg"), "", "must be a number without one"),
        (unit("3 um rad"), "m", "must be convertible to m"),
        (unit.Quantity(5.0, "delta_degC"), "K", "must be convertible to K, such as degC"),
        (short.Quantity(5.0, "delta_degC"), "K", "must be convertible to K, such as degC"),
        (unit("3 rad/s"), "1/s", "must be convertible to 1/s"),  # pint would take it as 3 Hz
        (unit("3 Hz"), "rad/s", "must be convertible to rad/s"),
        (unit.Quantity([1.0, 2.0], "m"), "m", "must be a number in m"),
        (np.True_, "m", "must be a number in m"),
        (unit.Quantity(np.nan, "m"), "m", "must be finite"),
        (xr.DataArray(5.0, attrs={"units": "ms"}), "m", "must be convertible to m"),
    ],
)
def test_what_is_no_such_quantity(value, in_unit, told):
    with pytest.raises(ValueError, match=re.escape(told)):
        to_si(value, in_unit)


@pytest.mark.parametrize(
    "values",
    [
        unit.Quantity([1.0, 2.0], "um"),
        [unit("1 um"), "2 um"],
        [unit("1 um"), 2e-6],
        xr.DataArray([1.0, 2.0], attrs={"units": "um"}),
        np.array([1e-6, 2e-6]),
    ],
)
def test_many_of_them(values):
    np.testing.assert_allclose(array_in_si(values, "m"), [1e-6, 2e-6], rtol=1e-14)


def test_a_scene_of_quantities():
    changed = SCENE.replace(
        beam={"power": unit("80 mW")},
        start={"position": unit.Quantity([0.1, 0.2, 0.3], "um")},
        medium={"temperature": unit.Quantity(25.0, "degC"), "viscosity": unit("0.9 cP")},
        optics={"table_range": unit("5 um")},
    )
    in_text = SCENE.replace(
        beam={"power": "80 mW"}, start={"position": ["0.1 um", "0.2 um", "0.3 um"]},
        medium={"temperature": "25 degC", "viscosity": "0.9 cP"}, optics={"table_range": "5 um"},
    )  # fmt: skip
    assert changed.start_position == pytest.approx(in_text.start_position, rel=1e-15)
    assert changed.replace(start={"position": in_text.start.position}) == in_text
    assert "beam.power = 80 mW, " in changed.title
    with pytest.raises(tweezer.SceneError, match=r"^beam.power = .*wrong unit.* such as mW, uW$"):
        SCENE.replace(beam={"power": unit("80 mm")})
    for section, key in (("lens", "numerical_aperture"), ("bead", "refractive_index")):
        with pytest.raises(tweezer.SceneError, match=f"^{section}.{key} = .*without one"):
            SCENE.replace(**{section: {key: unit("70 deg")}})
    absorbing = tweezer.load_scene("silica-1um").replace(bead={"refractive_index": 1.5 + 0.01j})
    assert absorbing.bead.refractive_index == (1.5, 0.01)


@kernel
def nothing(pose, data, wrench):
    """No force."""


def test_a_force_of_quantities():
    """Its data are those of the plain numbers, which is all that a kernel sees of them."""
    places = unit.Quantity([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]], "um")
    plain = UserForce(nothing, (2e-5, [0.0, 0.0, 1e-7], 3e3, 293.15, 0.5, [[1e-6], [2e-6]]))
    given = UserForce(nothing, (
        "20 pN/um", [unit("0 nm"), "0 um", 1e-7], unit("3 kHz"), "20 degC", 0.5,
        xr.DataArray([[1.0], [2.0]], attrs={"units": "um"}),
    ), step="0.1 nm")  # fmt: skip
    (_, expected), (_, found) = (each.compiled(gradient=False) for each in (plain, given))
    np.testing.assert_array_equal(found.shapes, expected.shapes)
    np.testing.assert_allclose(found.numbers[:17], expected.numbers[:17], rtol=1e-14)
    assert given.step == pytest.approx(plain.step, rel=1e-14)
    course = Course(["0 ms", unit("5 ms")], places, ["0 nm", "50 nm", "0 nm"], unit("2 kHz"),
                    "90 deg", "10 ms")  # fmt: skip
    bare = Course(np.array([0.0, 5e-3]), 1e-6 * places.magnitude, np.array([0.0, 5e-8, 0.0]), 2e3,
                  np.pi / 2, 1e-2)  # fmt: skip
    for time in (0.0, 1.3e-3, 7e-3):
        np.testing.assert_allclose(course.at(time), bare.at(time), rtol=1e-12)
    assert Course.constant("1 um", 2e-6, unit("3 um")).at(0.0) == pytest.approx([1e-6, 2e-6, 3e-6])
    Moved(given, course, Course.constant(2.0))


@pytest.mark.parametrize(
    ("make", "told"),
    [
        (lambda: UserForce(nothing, (1.0, "20 pN/foo")), "entries[1]: has an unknown unit"),
        (lambda: UserForce(nothing, ("20",)), "entries[0]: has no unit"),
        (lambda: UserForce(nothing, (["1 um", "1 s"],)), "entries[0]: has units of different"),
        (lambda: UserForce(nothing, (None,)), "entries[0]: must be numbers"),
        (lambda: UserForce(nothing, "20 pN/um"), "entries: must be a tuple"),
        (lambda: UserForce(nothing, (unit.Quantity(np.nan, "um"),)), "entries[0]: must be numbers"),
        (lambda: UserForce(nothing, (1j,)), "entries[0]: must be numbers"),
        (
            lambda: UserForce(nothing, ([[1.0], [1.0, 2.0]],)),
            "entries[0]: must be numbers, equally many",
        ),
        (lambda: UserForce(nothing, step="1 s"), "step: has the wrong unit"),
        (lambda: UserForce(nothing, step="-1 nm"), "step: must be above 0"),
        (lambda: Course([0.0], [[0.0]], [0.0], period=["1 s", "2 s"]), "period: must be one"),
        (lambda: Course(["1 um"], [[0.0]], [0.0]), "times: has the wrong unit"),
        (lambda: Course("1 s", [[0.0]], [0.0]), "times (n,), values (n, m)"),
        (lambda: Course([0.0], [["1 um"]], ["1 ms"]), "values in m and amplitude in s"),
        (lambda: Course([0.0], [[0.0]], [0.0], unit("5 nm")), "frequency: has the wrong unit"),
        (lambda: Moved(STILL, Course.constant(*["1 s"] * 3), ONE), "place: has the wrong unit, s"),
        (lambda: Moved(STILL, Course.constant(0, 0, 0), Course.constant("1 W")), "strength: has a"),
    ],
)
def test_a_force_of_wrong_quantities(make, told):
    with pytest.raises(ValueError, match=re.escape(told)):
        make()


STILL, ONE = UserForce(nothing), Course.constant(1.0)


@pytest.mark.parametrize(
    ("value", "number", "name"),
    [
        (2, 2.0, ""),
        ("20 pN/um", 2e-5, "kg/s**2"),
        ("3 kHz", 3e3, "1/s"),
        ("30 rpm", np.pi, "rad/s"),
        ("1.05 g/cm^3", 1050.0, "kg/m**3"),
        (unit.Quantity(50.0, "%"), 0.5, ""),
        (pint.UnitRegistry(system="cgs")("20 pN/um"), 2e-5, "kg/s**2"),
        (xr.DataArray(20.0, attrs={"units": "pN/um"}), 2e-5, "kg/s**2"),
    ],
)
def test_a_quantity_of_any_dimension(value, number, name):
    found, of = in_base_units(value)
    assert found == pytest.approx(number, rel=1e-14)
    assert of.replace(" ", "").replace("**1", "") == name


def test_positions_keep_their_unit():
    places = np.array([[0.2, 0.0, 0.1], [0.0, 0.3, 1.0]])
    plain = tweezer.optical_force(SCENE, places * 1e-6)
    np.testing.assert_array_equal(tweezer.optical_force(SCENE, unit.Quantity(places, "um")), plain)
    one_by_one = [[unit.Quantity(each, "um") for each in place] for place in places]
    np.testing.assert_allclose(tweezer.optical_force(SCENE, one_by_one), plain, rtol=1e-12)
    with pytest.raises(ValueError, match="positions: has the wrong unit; must be convertible to m"):
        tweezer.optical_force(SCENE, unit.Quantity(places, "s"))


def test_recordings_of_quantities():
    times, x = np.arange(200.0), np.sin(np.arange(200.0))
    record = tweezer.Recording(
        unit.Quantity(times, "ms"), unit.Quantity(x, "um"), ("x",), name="mine"
    )
    np.testing.assert_allclose(record.times, times * 1e-3, rtol=1e-14)
    np.testing.assert_allclose(record.positions, x[:, None] * 1e-6, rtol=1e-14)
    assert len(record.since(unit("50 ms")).times) == 150
    volts = tweezer.Recording(times, unit.Quantity(x, "mV"), ("x",), name="v", unit="V")
    np.testing.assert_allclose(volts.positions[:, 0], x * 1e-3, rtol=1e-14)
    with pytest.raises(tweezer.ResultError, match="mine: positions: has the wrong unit"):
        tweezer.Recording(times, unit.Quantity(x, "mV"), ("x",), name="mine")


def test_calibration_by_quantities():
    draw = np.random.default_rng(5)
    x = 1e-8 * draw.standard_normal(400)
    record = tweezer.Recording(1e-3 * np.arange(400), x, ("x",), name="mine")
    by = {"temperature": "20 degC", "drag": 9e-9, "noise": "1 nm", "diode": "14 kHz"}
    of = {
        "temperature": unit.Quantity(20.0, "degC"), "drag": unit("9e-9 kg/s"),
        "noise": unit("1 nm"), "diode": unit("14 kHz"),
    }  # fmt: skip
    bands = {"leave_out": ["49 Hz..51 Hz"]}, {"leave_out": [unit.Quantity([49, 51], "Hz")]}
    plain = tweezer.calibrate(record, **by, **bands[0])
    quantities = tweezer.calibrate(record, **of, **bands[1])
    assert plain.axes[0]["equipartition"].stiffness == pytest.approx(
        quantities.axes[0]["equipartition"].stiffness, rel=1e-12
    )
    with pytest.raises(tweezer.ResultError, match=r"mine: temperature = .*wrong unit"):
        tweezer.calibrate(record, **of | {"temperature": unit("3 m")})


def test_sweeps_over_quantities():
    powers, text = unit.Quantity([20.0, 50.0], "mW"), ["20 mW", "50 mW"]
    from tweezer.sweeps.cases import cases_of

    key = "beam.power_through_pupil"
    assert cases_of({key: powers}, None) == cases_of({key: text}, None)
    starts = {"start.position": [unit.Quantity([0, 0, 2], "um")]}
    assert cases_of(starts, None).axes[0].varied[0].values == ("[0.0, 0.0, 2e-06]",)
    with pytest.raises(tweezer.SceneError, match="must be a list of values"):
        cases_of({key: powers[0]}, None)
    with pytest.raises(tweezer.SceneError, match="wrong unit"):
        cases_of({key: unit.Quantity([1.0], "m")}, None)


def test_the_error_of_the_force():
    """Of the thesis's grid it is the distance to the integral over the lens."""
    scene = SCENE.replace(beam={"divisions": 20})
    places = np.array([[[2e-7, 0, 1e-7], [0, 3e-7, -4e-7]]])
    error = tweezer.optical_force_error(scene, unit.Quantity(places * 1e6, "um"))
    exact = tweezer.optical_force(
        scene.replace(optics={"evaluator": "quadrature", "tolerance": 1e-10}), places
    )
    apart = np.linalg.norm(tweezer.optical_force(scene, places) - exact, axis=-1)
    np.testing.assert_allclose(error, apart, rtol=1e-3)


@pytest.mark.parametrize(
    ("value", "unit", "bounds", "told"),
    [
        (1.5, "m", (2e-9, 2e-3), 'for 1.5 um write "1.5 um"'),
        (1064, "m", (1e-18, 1e-3), 'for 1064 nm write "1064 nm"'),
        (20, "K", (50, 5000), 'for 20 degC write "20 degC"'),
        (-1e-6, "m", (1e-9, 1e-3), ""),
        (0, "Pa s", (1e-12, 1e9), ""),
        ("0.5 km", "m", (2e-9, 2e-3), ""),
    ],
)
def test_bare_number_out_of_range_is_answered_with_its_unit(value, unit, bounds, told):
    with pytest.raises(ValueError, match="must be from") as refused:
        to_si(value, unit, *bounds)
    assert (told in str(refused.value)) if told else ("write" not in str(refused.value))


@pytest.mark.parametrize("value", [2.6000000000000002e-05, 2.6004e-05, 2.59999e-5, 1234.5, 0.99951])
def test_bounds_as_they_are_written_are_allowed(value):
    assert float(least(value)) >= value * (1 - 1e-12)
    assert float(most(value)) <= value * (1 + 1e-12)
    assert float(least(value)) == pytest.approx(value, rel=6e-3)
    assert float(most(value)) == pytest.approx(value, rel=6e-3)
