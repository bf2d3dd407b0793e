"""The light of a scene as one dataset: its form, its numbers and its refusals."""

import math

import numpy as np
import pint
import pytest
import xarray as xr

import tweezer
from tweezer.optics import LightForce
from tweezer.values.saved import kind_of

SCENE = tweezer.load_scene("silica-1um")
PLACES = np.array([[1e-7, 0.0, 2e-7], [-2e-7, 3e-7, -1e-7]])
SHORTHANDS = {
    "force": tweezer.optical_force,
    "torque": tweezer.optical_torque,
    "gradient": tweezer.optical_jacobian,
    "force_error": tweezer.optical_force_error,
    "absorbed_power": tweezer.absorbed_power,
}


def gold():
    return tweezer.load_scene("gold-100nm")


# --- numbers --------------------------------------------------------------------------------------


@pytest.mark.parametrize("theory", ["rays", "waves"])
def test_gradient_is_the_difference_of_forces(theory):
    light = tweezer.light(
        SCENE.replace(optics={"theory": theory, "evaluator": "quadrature", "tolerance": 1e-10})
    )
    step = 1e-9
    shifts = step * np.eye(3)
    ahead, behind = (light.field(PLACES[:, None] + sign * shifts).force for sign in (1, -1))
    differences = (ahead.values - behind.values) / (2 * step)  # [place, along, axis]
    gradient = light.field(PLACES).gradient.transpose("place", "along", "axis")
    np.testing.assert_allclose(gradient, differences, rtol=0, atol=1e-4 * abs(differences).max())


def test_lights_of_several_beams_add_up():
    two = tweezer.load_scene("two-traps")
    alone = SCENE.replace(beam={"power_through_pupil": "20 mW"})
    field = tweezer.light(two).field(PLACES)
    parts = [tweezer.light(alone).field(PLACES - [side, 0, 0]) for side in (-1.5e-6, 1.5e-6)]
    for name in ("force", "gradient"):
        expected = sum(part[name].values for part in parts)
        scale = np.abs(expected).max()
        np.testing.assert_allclose(field[name], expected, rtol=0, atol=1e-12 * scale)


@pytest.mark.filterwarnings("ignore:Knudsen number")
def test_light_on_a_small_sphere_is_the_light_on_a_dipole():
    """Its gradient force is proportional to a^3 (m^2 - 1)/(m^2 + 2) at the focus."""
    n_m = SCENE.medium.refractive_index

    def stiffness(radius, index):
        small = SCENE.replace(bead={"radius": radius, "refractive_index": index})
        gradient = tweezer.light(small).field([0.0, 0.0, 0.0]).gradient
        return -gradient.sel(axis="x", along="x").item()

    def polarisability(radius, index):
        square = (index / n_m) ** 2
        return radius**3 * (square - 1) / (square + 2)

    weak = stiffness(5e-9, 1.45)
    assert weak > 0
    for radius, index in ((10e-9, 1.45), (5e-9, 1.6), (8e-9, 1.35)):
        expected = polarisability(radius, index) / polarisability(5e-9, 1.45)
        assert stiffness(radius, index) / weak == pytest.approx(expected, rel=1e-3)


def test_lossless_sphere_in_linear_light_takes_no_torque_and_no_power():
    field = tweezer.light("polystyrene-500nm").field(PLACES)
    assert field.force.any()
    assert not field.torque.any()
    assert not field.absorbed_power.any()


def test_torque_of_circular_light_is_one_quantum_for_each_photon():
    scene = gold()
    omega = 2 * math.pi * 299792458 / scene.beam.wavelength
    field = tweezer.light(scene).field([0, 0, 0])
    power = field.absorbed_power.item()
    assert power > 0
    assert field.torque.sel(axis="z").item() * omega == pytest.approx(power, rel=1e-6)


def test_error_of_the_grid_is_the_distance_to_the_quadrature():
    scene = tweezer.load_scene("thesis-990nm").replace(beam={"divisions": 20})
    fine = scene.replace(optics={"evaluator": "quadrature", "tolerance": 1e-10})
    field, exact = (tweezer.light(each).field(PLACES) for each in (scene, fine))
    apart = np.linalg.norm(field.force - exact.force, axis=-1)
    assert (apart > 0).all()
    np.testing.assert_allclose(field.force_error, apart, rtol=1e-3)


def test_light_at_a_time_is_the_light_of_the_beam_where_it_is_then():
    motion = {"kind": "ramp", "velocity": ["100 um/s", 0, 0]}
    moving = tweezer.light(SCENE.replace(beam={"motion": motion}))
    then = moving.field(PLACES, time="2 ms")
    still = tweezer.light(SCENE).field(PLACES - [2e-7, 0, 0])
    assert then.light_time == 2e-3
    for name in ("force", "gradient"):
        scale = np.abs(still[name]).max()
        np.testing.assert_allclose(then[name], still[name], rtol=0, atol=1e-12 * scale)


# --- form -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("shape", "over"), [
        ((), ()), ((4,), ("place",)), ((0,), ("place",)), ((2, 3), ("place_0", "place_1")),
    ],
)  # fmt: skip
def test_dataset_has_dimensions_units_and_names(shape, over):
    positions = 1e-7 * np.random.default_rng(11).normal(size=(*shape, 3))
    field = tweezer.light(SCENE).field(positions)
    expected = {
        "force": ("N", (*over, "axis")),
        "torque": ("N m", (*over, "axis")),
        "gradient": ("N/m", (*over, "axis", "along")),
        "force_error": ("N", over),
        "absorbed_power": ("W", over),
        "position": ("m", (*over, "axis")),
    }
    assert set(field.data_vars) | {"position"} == set(expected)
    for name, (unit, dimensions) in expected.items():
        assert (field[name].units, field[name].dims) == (unit, dimensions)
        assert field[name].long_name
    assert tuple(field.sizes[each] for each in over) == shape
    assert field.force.ancillary_variables == "force_error"
    assert list(field.axis.values) == list(field.along.values) == ["x", "y", "z"]
    np.testing.assert_array_equal(field.position, positions)
    assert tweezer.scene_of(field) == SCENE


def test_positions_may_have_units():
    unit = pint.UnitRegistry()
    field = tweezer.light(SCENE).field(unit.Quantity(PLACES * 1e6, "um"))
    np.testing.assert_allclose(field.position, PLACES, rtol=1e-15)
    np.testing.assert_allclose(field.force, tweezer.optical_force(SCENE, PLACES), rtol=1e-9)


def test_positions_of_xarray_keep_their_dimensions_and_coordinates(tmp_path):
    position = xr.DataArray(
        1e6 * PLACES[None], dims=("trajectory", "time", "axis"), attrs={"units": "um"},
        coords={"time": ("time", [0.0, 1e-3]), "axis": list("xyz"), "seed": 3},
    )  # fmt: skip
    field = tweezer.light(SCENE).field(position)
    assert field.force.dims == ("trajectory", "time", "axis")
    assert (list(field.time.values), field.seed) == ([0.0, 1e-3], 3)
    np.testing.assert_allclose(field.force[0], tweezer.light(SCENE).field(PLACES).force, rtol=1e-9)
    field.to_netcdf(tmp_path / "light.nc", engine="h5netcdf")
    with xr.open_dataset(tmp_path / "light.nc", engine="h5netcdf") as read:
        xr.testing.assert_identical(read.load(), field)
        assert kind_of(read).told == "the light of a scene"


# --- shorthands -----------------------------------------------------------------------------------


@pytest.mark.parametrize("scene", [SCENE, gold(), tweezer.load_scene("two-traps")])
@pytest.mark.parametrize("name", SHORTHANDS)
def test_shorthand_is_one_variable(scene, name):
    positions = PLACES[:, None] * [[[0.5]], [[1.0]]]
    variable = tweezer.light(scene).field(positions)[name]
    values = SHORTHANDS[name](scene, positions)
    assert values.shape == variable.shape
    scale = np.abs(values).max()
    atol = scale if name == "force_error" else 1e-9 * scale
    np.testing.assert_allclose(values, variable, rtol=0, atol=atol)


@pytest.mark.parametrize("name", SHORTHANDS)
def test_only_the_jacobian_computes_a_gradient(name, monkeypatch):
    asked, field = [], LightForce.field

    def recorded(self, positions, *, gradient=False, **others):
        asked.append(gradient)
        return field(self, positions, gradient=gradient, **others)

    monkeypatch.setattr(LightForce, "field", recorded)
    SHORTHANDS[name](SCENE, PLACES)
    assert any(asked) == (name == "gradient")


# --- refusals -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("positions", "message"), [
        ([1.0, 2.0], r"positions must have the shape \(\.\.\., 3\), not \(2,\)"),
        (3.0, "positions must have the shape"),
        ([[math.nan, 0, 0]], "positions must be finite"),
        ([math.inf, 0, 0], "positions must be finite"),
        (["a", "b", "c"], "positions: "),
        (xr.DataArray([1.0, 2, 3], dims="axis", attrs={"units": "N"}), "wrong unit"),
    ],
)  # fmt: skip
def test_positions_that_are_none_are_refused(positions, message):
    with pytest.raises(ValueError, match=message):
        tweezer.light(SCENE).field(positions)


def test_no_light_in_a_wall():
    light = tweezer.light(SCENE.replace(wall={"position": "-1 um"}))
    assert np.isfinite(light.field([0, 0, -0.4e-6]).force).all()
    with pytest.raises(tweezer.SceneError, match="reaches into the wall at z = -1 um"):
        light.field([[0, 0, 0], [0, 0, -0.6e-6]])


def test_a_time_in_another_unit_is_refused():
    with pytest.raises(ValueError, match="must be convertible to s"):
        tweezer.light(SCENE).field(PLACES, time="1 m")


def test_positions_whose_axes_are_in_another_order_are_refused():
    places = xr.DataArray(
        [[0.0, 0.0, 3e-7]], dims=("bead", "axis"), coords={"axis": ["x", "y", "z"]}
    )
    light = tweezer.light(tweezer.load_scene("silica-1um"))
    assert light.field(places)["force"].dims == ("bead", "axis")
    with pytest.raises(ValueError, match="the coordinate axis must be x, y, z in this order"):
        light.field(places.sel(axis=["z", "y", "x"]))
