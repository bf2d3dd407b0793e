"""Scenes: units, the two ways to say one thing, changed copies, and the shipped ones."""

from __future__ import annotations

import itertools
import math
import subprocess
import sys
import warnings

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from tweezer.optics import light_force
from tweezer.scene import Scene, load_scene, shipped_scenes, value_at, with_settings
from tweezer.values.errors import PhysicsWarning, SceneError, UnitWarning
from tweezer.values.prefixes import FREQUENT
from tweezer.values.units import registry, to_si

ROUNDING = 1e-15
PREFIXES = {"": 1, "m": 1e-3, "u": 1e-6, "µ": 1e-6, "n": 1e-9, "k": 1e3}


@pytest.fixture
def scene() -> Scene:
    return load_scene("thesis-990nm")


@pytest.fixture
def in_si() -> dict:
    """A scene in bare SI numbers."""
    return {
        "bead": {"radius": 0.5e-6, "density": 2000.0, "refractive_index": 1.45},
        "medium": {
            "refractive_index": 1.33, "density": 1000.0, "viscosity": 1e-3, "temperature": 293.15,
        },
        "lens": {"map": "tan", "radius": 2.5e-3, "focal_length": 2e-3},
        "beam": {"wavelength": 1e-6, "power": 0.125, "sigma": 1e-3},
        "start": {"position": (0.0, 1e-6, -2e-6)},
        "simulation": {"duration": 0.02},
    }  # fmt: skip


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("500 nm", "m", 500e-9),
        ("0.5um", "m", 0.5e-6),
        ("0.5 µm", "m", 0.5e-6),
        ("0.5\u00a0μm", "m", 0.5e-6),
        (" 2.5e-1 mm ", "m", 0.25e-3),
        ("-3 Å", "m", -3e-10),
        ("156 mW", "W", 0.156),
        ("20 dBm", "W", 0.1),
        ("20 degC", "K", 293.15),
        ("20 °C", "K", 293.15),
        ("293.15 K", "K", 293.15),
        ("1.05 g/cm^3", "kg/m^3", 1050.0),
        ("1.05 g/cm³", "kg/m^3", 1050.0),
        ("1.05 g/cm**3", "kg/m^3", 1050.0),
        ("1050 kg m^-3", "kg/m^3", 1050.0),
        ("1.002 mPa s", "Pa s", 1.002e-3),
        ("1.002 mPa*s", "Pa s", 1.002e-3),
        ("1.002 cP", "Pa s", 1.002e-3),
        ("12 ms", "s", 12e-3),
        ("3 1/s", "rad/s", 3.0),
        ("1.002 mPa·s", "Pa s", 1.002e-3),
        ("1.002e-3 kg/(m s)", "Pa s", 1.002e-3),
        ("1.002e-3 N s / (m*m)", "Pa s", 1.002e-3),
        ("30 rpm", "rad/s", math.pi),
        ("180 deg/s", "rad/s", math.pi),
        (3, "m", 3.0),
        (2.5e-7, "m", 2.5e-7),
    ],
)
def test_quantities(text, unit, value):
    assert to_si(text, unit) == pytest.approx(value, rel=ROUNDING)


@settings(deadline=None)
@given(
    number=st.floats(1e-100, 1e100).map(float),
    prefix=st.sampled_from(sorted(PREFIXES)),
    space=st.sampled_from(["", " ", "  "]),
)
def test_a_unit_is_a_factor(number, prefix, space):
    assert to_si(f"{number!r}{space}{prefix}m", "m") == pytest.approx(
        number * PREFIXES[prefix], rel=1e-12, abs=0
    )


@pytest.mark.parametrize("number", [-3.3, 0.0, 1.002, 990, 7e-5])
def test_frequent_units_are_read_bit_for_bit_as_pint_reads_them(number):
    cases = [(text, unit) for unit, factors in FREQUENT.items() for text in factors]
    for text, unit in [*cases, ("degC", "K")]:
        expected = registry().Quantity(number, text).to(unit).magnitude
        assert to_si(f"{number} {text}", unit) == expected


@pytest.mark.parametrize("prefix", ["", *"fpnumcdk"])
@pytest.mark.parametrize(
    ("name", "factor", "unit"),
    [("m", 1, "m"), ("s", 1, "s"), ("sec", 1, "s"), ("W", 1, "W"), ("g", 1e-3, "kg"),
     ("K", 1, "K"), ("Pa s", 1, "Pa s"), ("P", 0.1, "Pa s"), ("L", 1e-3, "m^3"),
     ("N s/m^2", 1, "Pa s"), ("rad/s", 1, "rad/s")],
)  # fmt: skip
def test_every_prefix_of_every_unit(prefix, name, factor, unit):
    """None of them is another unit by chance, as Pint's min is no milli-inch."""
    power = dict(zip("fpnumcdk", (-15, -12, -9, -6, -3, -2, -1, 3), strict=True)).get(prefix, 0)
    assert to_si(f"2 {prefix}{name}", unit) == pytest.approx(
        2 * factor * 10.0**power, rel=1e-12, abs=0
    )


@pytest.mark.parametrize(
    ("text", "unit", "answer"),
    [("1 px", "m", "must be convertible to m, such as um, nm, mm"),
     ("1 pixel", "m", "unknown unit"), ("1 point", "m", "unknown unit"), ("1 pica", "m", "unknown"),
     ("1 pt", "m", "unknown unit"), ("1 dot", "m", "unknown unit"), ("1 em", "m", "unknown unit"),
     ("1 V", "m", "unknown unit"), ("1 u", "kg", "unknown unit"), ("1 t", "kg", "unknown unit"),
     ("1 a", "s", "unknown unit"), ("1 frame", "s", "unknown unit"), ("1 %", "m", "unknown unit"),
     ("1 Hz", "rad/s", "must be convertible to rad/s, such as deg/s, rpm"),
     ("1 in", "m", "unknown unit"), ("1 degC m", "K", "unknown unit"), ("1 dBm s", "W", "unknown"),
     ("80mw", "W", "did you mean mW?"), ("80 MW", "W", "did you mean mW?"),
     ("20 C", "K", "did you mean degC?"), ("68 F", "K", "did you mean degF?"),
     ("1 UM", "m", "did you mean um?"), ("1 µM", "m", "did you mean um?"),
     ("1 mPas", "Pa s", "did you mean mPa s?"), ("1 MPa s", "Pa s", "did you mean mPa s?")],
)  # fmt: skip
def test_units_that_mean_something_else_are_refused(text, unit, answer):
    with pytest.raises(ValueError, match="has an unknown unit; ") as refused:
        to_si(text, unit)
    assert answer in str(refused.value)


@pytest.mark.parametrize(
    ("changes", "said"),
    [({"beam": {"power": 80}}, 'beam.power = 80 is 80 W; 80 mW is written "80 mW"'),
     ({"beam": {"waist": 2e-1}}, 'beam.waist = 0.2 is 0.2 m; 0.2 um is written "0.2 um"'),
     ({"beam": {"wavelength": 5e-4}}, "beam.wavelength = 0.0005 is 0.0005 m"),
     ({"medium": {"viscosity": 1.002}}, "medium.viscosity = 1.002 is 1.002 Pa s; 1.002 mPa s is"),
     ({"bead": {"density": 1.05}}, "bead.density = 1.05 is 1.05 kg/m^3; 1.05 g/cm^3 is"),
     ({"simulation": {"duration": 20}}, 'simulation.duration = 20 is 20 s; 20 ms is written'),
     ({"start": {"velocity": [0, 0, -50]}}, "start.velocity = -50 is -50 m/s; -50 um/s is"),
     ({"beam": {"motion": {"kind": "ramp", "velocity": [30, 0, 0]}}},
      "beam.motion.velocity = 30 is 30 m/s; 30 um/s is"),
     ({"beam": {"motion": {"kind": "steps", "times": [0, 20], "positions": 2 * [[0, 0, 1e-6]]}}},
      "beam.motion.times = 20 is 20 s; 20 ms is"),
     ({"beam": {"modulation": {"kind": "ramp", "factor": 2, "end": 12}}},
      "beam.modulation.end = 12 is 12 s; 12 ms is"),
     ({"beam": {"motion": {"kind": "table", "times": [0, 1], "positions": 2 * [[0.1, 0, 0.2]]}}},
      "beam.motion.positions = 0.1 is 0.1 m; 0.1 um is")],
)  # fmt: skip
def test_a_bare_number_that_is_unusual_names_its_unit(scene, changes, said):
    with pytest.warns(UnitWarning, match="written") as warned:
        changed = scene.replace(**changes)
    (warning,) = warned
    assert str(warning.message).startswith(said)
    with warnings.catch_warnings(action="error"):
        changed.replace(bead={"refractive_index": 1.5})  # not again
        scene.replace(beam={"power": "80 W"})  # nor where the unit is there


@settings(deadline=None)
@given(st.floats(allow_nan=False, allow_infinity=False))
def test_a_bare_number_is_taken_bit_for_bit(number):
    assert to_si(number, "m").hex() == number.hex()


def test_units_make_the_same_scene_as_si(in_si):
    with_units = {
        "bead": {"diameter": "1000 nm", "density": "2 g/cm^3", "refractive_index": 1.45},
        "medium": {
            "refractive_index": 1.33, "density": "1 kg/l", "viscosity": "1 mPa s",
            "temperature": "20 degC",
        },
        "lens": {"map": "tan", "radius": "2.5 mm", "focal_length": "2 mm"},
        "beam": {"wavelength": "1 um", "power": "125 mW", "waist": "2 mm"},
        "start": {"position": [0, "1 um", "-2 um"]},
        "simulation": {"duration": "20 ms"},
    }  # fmt: skip
    given_in_si, given_with_units = load_scene(in_si), load_scene(with_units)
    for section in in_si:
        expected = getattr(given_in_si, section).model_dump(exclude_none=True)
        found = getattr(given_with_units, section).model_dump(exclude_none=True)
        assert found.keys() == expected.keys()
        for key, value in expected.items():
            if isinstance(value, float | tuple):
                assert found[key] == pytest.approx(value, rel=ROUNDING, abs=0), (section, key)
            else:
                assert found[key] == value, (section, key)


@pytest.mark.parametrize(
    ("section", "key", "double"), [("bead", "radius", "diameter"), ("beam", "sigma", "waist")]
)
def test_half_of_the_other_way_to_say_it(in_si, section, key, double):
    expected = load_scene(in_si)
    in_si[section][double] = 2 * in_si[section].pop(key)
    assert load_scene(in_si) == expected


def test_a_mapping_is_not_changed_by_loading_it(in_si):
    in_si["bead"]["diameter"] = 2 * in_si["bead"].pop("radius")
    load_scene(in_si)
    assert in_si["bead"]["diameter"] == 1e-6


def test_a_scene_is_immutable_and_hashable(scene):
    with pytest.raises(AttributeError, match=r"scene\.replace"):
        scene.bead.radius = 1e-6
    with pytest.raises(AttributeError, match=r"scene\.replace"):
        scene.bead = scene.bead
    with pytest.raises(TypeError):
        scene.start.position[0] = 1.0
    assert {scene: 1}[load_scene("thesis-990nm")] == 1


def test_replace_changes_what_it_names_and_nothing_else(scene):
    changed = scene.replace(beam={"power": "80 mW"}, forces={"gravity": False}, name="dim")
    assert (changed.beam.power, changed.forces.gravity, changed.name) == (0.08, False, "dim")
    assert scene.beam.power == 0.156
    undone = changed.replace(beam={"power": 0.156}, forces={"gravity": True}, name=scene.name)
    assert undone == scene


def test_a_scene_is_shown_in_short(scene):
    assert (
        repr(scene)
        == str(scene)
        == (
            "Scene of thesis-990nm\n"
            "  bead    0.99 µm, index 1.5777, 1050 kg/m³\n"
            "  medium  index 1.33, 1.002 mPa·s, 293.15 K\n"
            "  light   156 mW at 800 nm; ray optics (optics.theory = 'rays')\n"
            "  start   0, -2.045, -4.05 µm from the focus\n"
            "  forces  optical, gravity, buoyancy\n"
            "  run     12 ms, 2001 samples"
        )
    )
    changed = scene.replace(beam={"power": "80 mW"}, simulation={"model": None})
    assert repr(changed).endswith("\n  changed  beam.power = 0.08; simulation.model = None")
    assert "changed" not in repr(changed.replace(name="mine"))


def test_replacing_nothing_is_the_same_scene(scene):
    assert scene.replace() == scene
    assert scene.replace(beam={}) == scene


@pytest.mark.parametrize(
    ("section", "changes", "key", "value", "displaced"),
    [
        ("bead", {"diameter": "1 um"}, "radius", 0.5e-6, None),
        ("beam", {"waist": "4 mm"}, "sigma", 2e-3, None),
        ("beam", {"power_through_pupil": "10 mW"}, "power_through_pupil", 0.01, "power"),
    ],
)
def test_replace_displaces_what_says_the_same(scene, section, changes, key, value, displaced):
    changed = getattr(scene.replace(**{section: changes}), section)
    assert getattr(changed, key) == pytest.approx(value, rel=ROUNDING)
    assert displaced is None or getattr(changed, displaced) is None


@pytest.mark.parametrize(
    ("changes", "line"),
    [
        ({"bead": {"radius": -1}}, "bead.radius = -1: must be from 1e-09 to 0.001 m"),
        ({"bead": {"size": 1}}, "bead.size = 1: unknown key"),
        ({"beads": {"radius": 1}}, "beads = {'radius': 1}: unknown key; did you mean bead?"),
        ({"simulation": {"loss_distance": 1e-6}}, "must be nearer than simulation.loss_distance"),
        ({"beam": {"power": 1, "power_through_pupil": 1}}, "give only one"),
        ({"bead": None}, "bead = None: must be a section [bead]"),
    ],
    ids=["value", "key", "section", "between sections", "alternatives", "no section"],
)
def test_replace_validates_again(scene, changes, line):
    with pytest.raises(SceneError) as refused:
        scene.replace(**changes)
    assert line in str(refused.value)


def test_settings_are_toml_or_text(scene):
    changed = with_settings(
        scene,
        {
            "beam.power": "80 mW",
            "beam.divisions": "50",
            "beam.torque": "thesis",
            "forces.gravity": "False",
            "forces.buoyancy": "false",
            "bead.density": "'1.1 g/cm^3'",
            "start.velocity": "[0, '1 mm/s', 2e-3]",
        },
    )
    assert changed.beam.power == 0.08
    assert changed.beam.divisions == 50
    assert changed.beam.torque == "thesis"
    assert (changed.forces.gravity, changed.forces.buoyancy) == (False, False)
    assert with_settings(changed, {"forces.gravity": "True"}).forces.gravity is True
    assert changed.bead.density == pytest.approx(1100, rel=ROUNDING)
    assert changed.start.velocity == pytest.approx((0, 1e-3, 2e-3), rel=ROUNDING)
    assert with_settings(scene, {}) == scene


#: Tables B.2-B.4 and 5.1: radius, sigma, a2, start from the lens (m)
OF_THE_BEAD = {
    "thesis-500nm": (0.25e-6, 2.5e-3, 3e-5, (0, 2.0616e-6, 1.99795e-3)),
    "thesis-990nm": (0.495e-6, 1.0e-3, 1.2e-3, (0, -2.045e-6, 1.99595e-3)),
    "thesis-1950nm": (0.975e-6, 1.85e-3, 8e-3, (0, 3.4043e-6, 1.9929e-3)),
}


@pytest.mark.parametrize("name", OF_THE_BEAD)
def test_shipped_scenes_are_the_tables_of_the_thesis(name):
    scene = load_scene(name)
    radius, sigma, scaling_factor, from_lens = OF_THE_BEAD[name]
    bead, medium, lens, beam, simulation = (
        scene.bead, scene.medium, scene.lens, scene.beam, scene.simulation,
    )  # fmt: skip
    in_scene = [
        bead.radius, bead.density, bead.refractive_index,
        medium.refractive_index, medium.density, medium.viscosity, medium.temperature,
        lens.radius, lens.focal_length, lens.numerical_aperture,
        beam.wavelength, beam.power, beam.sigma,
        scene.forces.gravitational_acceleration,
        simulation.scaling_factor, simulation.relative_tolerance, simulation.position_tolerance,
        *scene.start.position,
    ]  # fmt: skip
    in_thesis = [
        radius, 1050, 1.57773,
        1.33, 998.2071, 1.002e-3, 293.15,
        2.6e-3, 2e-3, 1.3,
        0.8e-6, 0.156, sigma,
        9.80665,
        scaling_factor, 1e-7, 1e-11,
        *from_lens,
    ]  # fmt: skip
    assert in_scene == pytest.approx(in_thesis, rel=ROUNDING, abs=0)
    assert (scene.start.frame, lens.map, beam.divisions) == ("lens", "tan", 100)
    assert (simulation.model, simulation.method) == ("scaled", "dormand-prince")
    assert (beam.polarisation, beam.torque) == ("averaged-reflectance", "none")
    assert (beam.profile, scene.optics.evaluator) == ("gaussian", "grid")
    assert scene.name == name


def test_shipped_scenes_load_without_pint():
    """It takes half a second to import."""
    program = (
        "import sys, tweezer\n"
        "for name in tweezer.shipped_scenes(): tweezer.load_scene(name)\n"
        "print('pint' in sys.modules)"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert done.stdout == "False\n"


def test_shipped_scenes_load_without_a_warning():
    of_several_beams = {"two-traps", "moving-trap", "optical-stretcher"}
    of_waves = {"silica-1um", "polystyrene-500nm", "gold-100nm", "coated-1um"}
    of_bodies = {"flipping-rod"}
    of_pupils = {"astigmatic-trap", "optical-conveyor", "three-foci"}
    of_media = {"levitated-200nm", "polymer-solution"}
    of_several_beads = {"two-beads", "dna-between-beads", "dumbbell"}
    assert set(shipped_scenes()) == {
        *OF_THE_BEAD, *of_waves, *of_several_beams, *of_bodies, *of_pupils, *of_media,
        *of_several_beads,
    }  # fmt: skip
    with warnings.catch_warnings(action="error"):
        for name, path in shipped_scenes().items():
            assert load_scene(name) == load_scene(path)
            assert load_scene(name).description


@given(
    x=st.floats(-4e-6, 4e-6), y=st.floats(-4e-6, 4e-6), z=st.floats(-4e-6, 4e-6),
    focal_length=st.floats(1e-3, 5e-3),
)  # fmt: skip
def test_the_lens_is_a_focal_length_before_the_focus(x, y, z, focal_length):
    from_focus = load_scene("thesis-990nm").replace(
        lens={"focal_length": focal_length}, start={"frame": "focus", "position": [x, y, z]}
    )
    from_lens = from_focus.replace(start={"frame": "lens", "position": [x, y, focal_length + z]})
    assert from_focus.start_position == (x, y, z)
    assert from_lens.start_position == pytest.approx((x, y, z), rel=0, abs=1e-18)


@pytest.mark.parametrize("name", shipped_scenes())
def test_json_keeps_a_scene_bit_for_bit(name):
    scene = load_scene(name)
    assert Scene.model_validate_json(scene.model_dump_json(exclude_none=True)) == scene


@pytest.mark.filterwarnings("ignore:beam.power:tweezer.UnitWarning")
@settings(deadline=None)
@given(
    radius=st.floats(2e-7, 1e-3), power=st.floats(0, 1e6), brightest=st.booleans(),
    orientation=st.tuples(*4 * [st.floats(-1e100, 1e100)]),
)  # fmt: skip
def test_json_keeps_any_scene_bit_for_bit(radius, power, brightest, orientation):
    assume(math.hypot(*orientation) >= 1e-100)
    scene = load_scene("silica-1um").replace(
        bead={"radius": radius},
        beam={"power" if brightest else "power_through_pupil": power},
        start={"orientation": orientation},
    )
    assert Scene.model_validate_json(scene.model_dump_json(exclude_none=True)) == scene


@settings(deadline=None)
@given(
    amplitudes=st.tuples(*4 * [st.floats(-1e100, 1e100)]), points=st.integers(4, 20), data=st.data()
)
def test_json_keeps_any_profile_and_polarisation_bit_for_bit(amplitudes, points, data):
    a_re, a_im, b_re, b_im = amplitudes
    assume(math.hypot(*amplitudes) >= 1e-100)
    steps = data.draw(st.lists(st.floats(1e-6, 1e-2), min_size=points - 1, max_size=points - 1))
    scene = load_scene("silica-1um").replace(
        beam={
            "profile": "table",
            "profile_radius": [0.0, *itertools.accumulate(steps)],
            "profile_intensity": [1.0, *steps],
            "polarisation": "linear",
            "jones": [[a_re, a_im], [b_re, b_im]],
        },
        optics={"evaluator": "quadrature", "table_range": 2.5},
    )
    assert math.hypot(*scene.beam.jones[0], *scene.beam.jones[1]) == pytest.approx(1, rel=1e-14)
    assert Scene.model_validate_json(scene.model_dump_json(exclude_none=True)) == scene
    assert scene.replace() == scene


ROOT_HALF = math.sqrt(0.5)


@pytest.mark.parametrize(
    ("given_as", "jones"),
    [
        (None, ((1, 0), (0, 0))),
        ([1, 0], ((1, 0), (0, 0))),
        ([0, -3], ((0, 0), (-1, 0))),
        ([3, 4], ((0.6, 0), (0.8, 0))),
        ([1, "1j"], ((ROOT_HALF, 0), (0, ROOT_HALF))),
        (["2", " -2 j "], ((ROOT_HALF, 0), (0, -ROOT_HALF))),
        (["0.5+0.5j", "0.5 - 0.5j"], ((0.5, 0.5), (0.5, -0.5))),
        (["3e-100", "4e-100j"], ((0.6, 0), (0, 0.8))),
        ([[3, 0], [0, 4]], ((0.6, 0), (0, 0.8))),
    ],
    ids=str,
)
def test_a_jones_vector_is_read_in_any_form_and_normalised(scene, given_as, jones):
    beam = {"polarisation": "linear", **({"jones": given_as} if given_as else {})}
    read = scene.replace(beam=beam).beam.jones
    assert [*read[0], *read[1]] == pytest.approx([*jones[0], *jones[1]], rel=1e-15)


def test_a_choice_displaces_the_keys_that_do_not_go_with_it(scene):
    points = {"profile_radius": [0, 1e-3, 2e-3, 3e-3], "profile_intensity": [1, 1, 1, 0]}
    linear = scene.replace(beam={"polarisation": "linear", "profile": "donut"})
    assert linear.beam.sigma == scene.beam.sigma
    uniform = linear.replace(beam={"profile": "uniform", "polarisation": "circular"})
    assert (uniform.beam.sigma, uniform.beam.jones) == (None, None)
    table = scene.replace(beam={"profile": "table", **points})
    assert table.beam.profile_radius == (0, 1e-3, 2e-3, 3e-3)
    assert table.replace(beam={"profile": "gaussian", "waist": "2 mm"}) == scene
    with pytest.raises(SceneError, match="does not apply to profile = 'uniform'"):
        scene.replace(beam={"profile": "uniform", "sigma": 1e-3})
    with pytest.raises(SceneError, match="sigma or waist: one is required"):
        table.replace(beam={"profile": "donut"})


@pytest.mark.parametrize("dark", [{"forces": {"optical": False}}, {"beam": {"power": 0}}])
def test_in_the_dark_no_beam_is_too_narrow(scene, dark):
    narrow = {"sigma": 1e-9} | dark.get("beam", {})
    assert not scene.replace(**{**dark, "beam": narrow}).lit


def test_only_the_grid_needs_a_beam_wider_than_its_squares(scene):
    assert scene.optics.evaluator == "grid"
    with pytest.raises(SceneError, match="half the side of a square"):
        scene.replace(beam={"sigma": 1e-5})
    free = scene.replace(beam={"sigma": 1e-5}, optics={"evaluator": "auto", "theory": "auto"})
    assert free.optics == load_scene("silica-1um").optics
    assert free.optics.model_dump() == {
        "theory": "auto", "evaluator": "auto", "tolerance": 1e-8, "table_tolerance": 1e-7,
        "table_range": 3.0,
    }  # fmt: skip


#: the 990 nm bead of the thesis as waves
WAVES = {
    "optics": {"theory": "waves", "evaluator": "auto"},
    "beam": {"polarisation": "unpolarised"},
}
COVER = {"cover": {"refractive_index": 1.52, "depth": "9 um"}}
#: id: (changes of silica-1um, its theory, the reason)
THEORIES = {
    "small": ({}, "waves", "the size parameter k a = 3.92 is at most 120"),
    "large": ({"bead": {"diameter": "32 um"}, "start": {"position": [0, 0, 0]}}, "rays",
              "the size parameter k a = 125 is above 120"),
    "named rays": ({"optics": {"theory": "rays"}}, "rays", "optics.theory = 'rays'"),
    "named waves": ({"optics": {"theory": "waves"}, "bead": {"diameter": "32 um"}}, "waves",
                    "optics.theory = 'waves'"),
    "dark": ({"forces": {"optical": False}, "beam": {"vortex": 1}, "optics": {"theory": "rays"}},
             "rays", "no light"),
    "averaged reflectance": ({"beam": {"polarisation": "averaged-reflectance"}}, "rays",
                             "beam.polarisation = 'averaged-reflectance' requires ray optics"),
    "moment": ({"beam": {"torque": "thesis"}}, "rays",
               "beam.torque = 'thesis' requires ray optics"),
    "grid": ({"optics": {"evaluator": "grid"}}, "rays",
             "optics.evaluator = 'grid' requires ray optics"),
    "donut": ({"beam": {"profile": "donut"}}, "rays",
              "beam.profile = 'donut' without a vortex, or radial or azimuthal polarisation, "
              "requires ray optics"),
    "donut with a phase": ({"beam": {"profile": "donut", "vortex": -1}}, "waves",
                           "beam.vortex = -1 requires wave optics"),
    "azimuthal donut": ({"beam": {"profile": "donut", "polarisation": "azimuthal"}}, "waves",
                        "beam.polarisation = 'azimuthal' requires wave optics"),
    "absorbing and large": (
        {"bead": {"diameter": "32 um", "refractive_index": [1.5, 0.01]},
         "start": {"position": [0, 0, 0]}},
        "waves", "bead.refractive_index = 1.5+0.01j requires wave optics",
    ),
    "layers": ({"bead": {"layers": [{"diameter": "0.5 um", "refractive_index": 1.0},
                                    {"diameter": "1 um", "refractive_index": 1.5}]}},
               "waves", "bead.layers (2 layers) requires wave optics"),
    "cover": ({"lens": COVER}, "waves", "lens.cover requires wave optics"),
    "far": ({"simulation": {"loss_distance": "200 um"}},
            "rays", "k times simulation.loss_distance = 1.57e+03 is above 1000"),
    "map of linear light": ({"beam": {"polarisation": "linear"}, "optics": {"evaluator": "map"}},
                            "waves", "the size parameter k a = 3.92 is at most 120"),
}  # fmt: skip


@pytest.mark.parametrize(("changes", "theory", "reason"), THEORIES.values(), ids=THEORIES)
def test_a_scene_takes_waves_where_they_mean_something_and_are_cheap(changes, theory, reason):
    scene = load_scene("silica-1um").replace(**changes)
    assert (scene.theory, scene.theory_reason) == (theory, reason)


def test_all_beams_are_of_one_theory():
    two = load_scene("two-traps")
    assert [two.with_one_beam(beam).theory for beam in two.beams] == ["waves", "waves"]
    one_as_rays = two.replace(**{"beam[2]": {"polarisation": "averaged-reflectance"}})
    reason = "beam[2].polarisation = 'averaged-reflectance' requires ray optics"
    assert one_as_rays.theory_reason == reason
    assert [one_as_rays.with_one_beam(beam).theory for beam in two.beams] == ["rays", "rays"]
    # the shortest wavelength has the largest size
    short = two.replace(**{"beam[2]": {"wavelength": "34 nm"}})
    assert short.theory_reason == "the size parameter k a = 123 is above 120"


@pytest.mark.parametrize(
    ("given_as", "stored"),
    [(1.5, 1.5), ("1.5", 1.5), ("1.59+0.01j", (1.59, 0.01)), ([0.26, 6.97], (0.26, 6.97)),
     ("1.5+0j", 1.5), ([1.5, 0], 1.5), ("1.5 + 1e-3j", (1.5, 1e-3))],
    ids=str,
)  # fmt: skip
def test_an_index_is_read_in_any_form_and_real_where_it_is_real(given_as, stored):
    changed = load_scene("silica-1um").replace(bead={"refractive_index": given_as})
    bead = changed.bead
    assert bead.refractive_index == stored
    assert bead.index == (complex(*stored) if isinstance(stored, tuple) else stored)
    assert bead.shells == ((0.5e-6, bead.index),)
    assert bead.absorbs == isinstance(stored, tuple)
    assert Scene.model_validate_json(changed.model_dump_json(exclude_none=True)) == changed
    assert changed.replace() == changed


def test_layers_are_the_bead():
    """From the core outwards; kept by JSON and by changes, and displaced by another bead."""
    scene = load_scene("silica-1um")
    layers = [{"diameter": "0.6 um", "refractive_index": "0.3+7j"},
              {"radius": 4e-7, "refractive_index": 1.45}]  # fmt: skip
    coated = scene.replace(bead={"layers": layers})
    assert coated.bead.radius == 4e-7
    assert coated.bead.shells == ((3e-7, 0.3 + 7j), (4e-7, 1.45))
    assert (coated.bead.index, coated.bead.absorbs) == (1.45, True)
    assert coated.title.startswith("silica-1um, changed: bead.layers = [{diameter = 0.6 um, refrac")
    assert "bead.layers = ({'radius': 3e-07" in repr(coated)
    json = coated.model_dump_json(exclude_none=True)
    assert '"radius":4e-7' in json
    assert Scene.model_validate_json(json) == coated == load_scene(coated.model_dump())
    assert coated.replace(bead={"density": 1500}).bead.shells == coated.bead.shells
    as_text = '[{diameter = "0.6 um", refractive_index = "0.3+7j"}, ' \
              '{radius = 4e-7, refractive_index = 1.45}]'  # fmt: skip
    assert with_settings(scene, {"bead.layers": as_text}) == coated
    assert hash(with_settings(scene, {"bead.layers": as_text})) == hash(coated)
    assert coated.replace(bead={"diameter": "1 um", "refractive_index": 1.45}) == scene
    with pytest.raises(SceneError, match=r"bead\.radius = 1e-06: cannot be combined with layers"):
        coated.replace(bead={"radius": 1e-6})


def test_a_cover_is_changed_key_by_key():
    scene = load_scene("silica-1um").replace(lens=COVER, beam={"vortex": 2})
    assert (scene.lens.cover.refractive_index, scene.lens.cover.depth) == (1.52, 9e-6)
    deeper = with_settings(scene, {"lens.cover.depth": "12 um"})
    assert (deeper.lens.cover.refractive_index, deeper.lens.cover.depth) == (1.52, 12e-6)
    assert "lens.cover = {depth = 12 um}" in deeper.title
    assert Scene.model_validate_json(deeper.model_dump_json(exclude_none=True)) == deeper
    assert load_scene("silica-1um").lens.cover is None
    # the aperture may be above the medium's index, and below that of the cover
    assert deeper.replace(lens={"numerical_aperture": 1.4}).lens.numerical_aperture == 1.4


def test_a_start_is_between_the_faces_of_the_covers():
    """Of two beams that face each other each has its own face."""
    scene = load_scene("silica-1um").replace(lens=COVER)
    below, above = {"position": [0, 0, "-8.4 um"]}, {"position": [0, 0, "8.6 um"]}
    assert scene.replace(start=below).start_position[2] == pytest.approx(-8.4e-6)
    beam = scene.beam.model_dump(exclude_none=True)
    facing = [beam, {**beam, "direction": "down"}]
    scene.replace(start=above)
    with pytest.raises(SceneError, match=r"beyond the face of lens\.cover, which is 9e-06 m"):
        scene.replace(start=above, beam=facing)
    scene.replace(start=below, beam=facing)
    with pytest.raises(SceneError, match=r"beyond the face of lens\.cover"):
        scene.replace(start={"position": [0, 0, "-8.51 um"]})


@pytest.mark.parametrize(
    ("given_as", "stored", "reach", "radii"),
    [(4, 4.0, 2e-6, 4.0), ("5 um", "5e-06 m", 5e-6, 10.0), ("777 nm", "7.77e-07 m", 777e-9, 1.554)],
)
def test_a_map_reaches_a_number_of_radii_or_a_length(given_as, stored, reach, radii):
    changed = load_scene("silica-1um").replace(optics={"table_range": given_as})
    assert changed.table_reach == pytest.approx(reach, rel=1e-14)
    assert changed.table_radii == pytest.approx(radii, rel=1e-14)
    assert changed.replace(bead={"diameter": "2 um"}).table_reach == pytest.approx(
        reach if isinstance(given_as, str) else 2 * reach, rel=1e-14
    )
    assert changed.optics.table_range == stored
    assert Scene.model_validate_json(changed.model_dump_json(exclude_none=True)) == changed


@pytest.mark.parametrize(("diameter", "rare"), [("299 nm", True), ("301 nm", False)])
def test_a_bead_too_small_for_a_continuum_warns(scene, diameter, rare):
    with warnings.catch_warnings(record=True, action="always") as said:
        scene.replace(bead={"diameter": diameter})
    assert [warning.category for warning in said] == rare * [PhysicsWarning]
    assert all("Knudsen number 0.001 is above 0.001" in str(warning.message) for warning in said)


@pytest.mark.parametrize(
    ("changes", "turns"),
    [({}, False), ({"beam": {"torque": "thesis"}}, True),
     ({"start": {"angular_velocity": [0, 0, 1]}}, True),
     ({**WAVES, "bead": {"refractive_index": "1.57+1e-4j"}}, True), (WAVES, False),
     ({**WAVES, "bead": {"refractive_index": "1.57+1e-4j"}, "forces": {"optical": False}}, False)],
    ids=["nothing", "moment of the light", "spin", "absorption", "waves", "absorption in the dark"],
)  # fmt: skip
def test_a_bead_rotates_only_if_something_turns_it(scene, changes, turns):
    assert scene.replace(**changes).rotates is turns


def test_the_title_of_a_changed_scene_names_what_was_changed():
    """Not the description, which speaks of the scene as it was; also once written and read."""
    scene = load_scene("silica-1um")
    assert scene.title == scene.description
    larger = scene.replace(bead={"diameter": "1.5 um"}, forces={"gravity": True})
    assert larger.title == "silica-1um, changed: bead.diameter = 1.5 um"
    both = with_settings(larger, {"forces.brownian": "true", "start.position": "[0, 0, 1e-7]"})
    assert both.title == (
        "silica-1um, changed: bead.diameter = 1.5 um, forces.brownian = true, "
        "start.position = [0, 0, 1e-07]"
    )
    assert both.replace(bead={"radius": 1e-6}).title.count("bead.") == 1
    assert Scene.model_validate_json(both.model_dump_json(exclude_none=True)).title == both.title
    assert load_scene(both.model_dump(exclude_none=True)).title == both.title
    assert both.replace(description="anew", simulation={"samples": 7}).title == "anew"
    assert scene.replace(bead=larger.bead).title == "silica-1um, changed: bead.radius = 7.5e-07"
    assert scene.decided(simulation={"model": "full"}).title == scene.description


def test_the_title_names_the_power_however_it_is_given():
    """Also where the scene gives it in that way already, and without what no longer holds."""
    scene = load_scene("silica-1um")
    weak = scene.replace(beam={"power_through_pupil": "5 mW"})
    assert weak.title == "silica-1um, changed: beam.power_through_pupil = 5 mW"
    assert weak.replace(beam={"power": "9 mW"}).title == "silica-1um, changed: beam.power = 9 mW"
    wide = weak.replace(beam={"waist": "7 mm"}).replace(beam={"profile": "uniform"})
    assert "beam.profile = uniform" in wide.title
    assert "waist" not in wide.title


def test_a_scene_is_what_it_says_however_it_was_changed():
    scene = load_scene("silica-1um")
    there_and_back = scene.replace(bead={"diameter": "2 um"}).replace(bead={"diameter": "1 um"})
    assert there_and_back == scene
    assert hash(there_and_back) == hash(scene)
    assert scene.replace(bead={"diameter": "2 um"}) != scene


def test_an_aperture_without_effect_is_warned_of():
    """The force with the tan map stays the same to the last bit, and with the sine map does not."""
    tan = load_scene("thesis-990nm")
    sine = tan.replace(lens={"map": "sine"})
    place = np.array([[0.0, 0.0, -3e-7]])
    with pytest.warns(PhysicsWarning, match="numerical_aperture: has no effect") as seen:
        narrow = tan.replace(lens={"numerical_aperture": 1.1})
    assert len(seen) == 1
    assert narrow.replace(beam={"power": "10 mW"}).replace(lens={"map": "sine"}).lens.map == "sine"
    narrow_sine = sine.replace(lens={"numerical_aperture": 1.1})
    forces = [
        light_force(scene).field(place).force[0, 2] for scene in (tan, narrow, sine, narrow_sine)
    ]
    assert forces[0] == forces[1]
    assert forces[2] != forces[3]


def test_a_temperature_changed_alone_is_warned_of():
    scene = load_scene("silica-1um")
    with pytest.warns(PhysicsWarning, match="37 degC: viscosity, density and") as seen:
        warm = with_settings(scene, {"medium.temperature": "37 degC"})
    assert len(seen) == 1
    assert "still those of 293.15 K" in str(seen[0].message)
    assert "37 degC (viscosity, density and refractive_index as before)" in warm.title
    given = warm.replace(medium={"viscosity": "0.6913 mPa s"})  # no warning, and none left
    assert "as before" not in given.title
    with pytest.warns(PhysicsWarning, match="still those of"):
        scene.replace(description="warm", medium={"temperature": "37 degC"})
    with_viscosity = {"viscosity": "0.6913 mPa s", "temperature": "37 degC"}
    scene.replace(description="warm", medium=with_viscosity)
    assert "as before" not in scene.replace(medium=with_viscosity).title
    warm.replace(forces={"gravity": False})


@pytest.mark.parametrize(
    ("key", "text", "value"),
    [("bead.diameter", "0.8 um", 0.8e-6), ("bead.radius", "0.8 um", 0.8e-6),
     ("beam.power_through_pupil", "3 mW", 3e-3)],
)  # fmt: skip
def test_value_of_a_key_is_the_one_that_was_set(key, text, value):
    """A key may stand for twice another, and the section may have it as a property."""
    scene = with_settings(load_scene("silica-1um"), {key: text})
    assert value_at(scene, key) == pytest.approx(value)


@pytest.mark.parametrize(
    ("section", "described", "words"),
    [
        ("wall", {"position": -3e-6}, "at -3 um"),
        ("wall", {"position": -6e-6, "opposite": 7e-6}, "at -6 um and 7 um"),
        ("wall", {"position": -3e-6, "reflects": True}, "at -3 um, reflects with index 1.518"),
        ("mirror", {"position": 3e-6}, "at 3 um, perfect"),
        ("mirror", {"position": 3e-6, "refractive_index": 1.5}, "at 3 um, reflects with index 1.5"),
        ("mirror", {"position": 3e-6, "refractive_index": "0.2+6j"},
         "at 3 um, reflects with index 0.2+6j"),
    ],
)  # fmt: skip
def test_card_shows_how_walls_and_mirrors_reflect(section, described, words):
    scene = load_scene("silica-1um").model_dump(exclude_none=True)
    (row,) = (
        row for row in load_scene({**scene, section: described}).card().rows if row.name == section
    )
    assert row.value == words
