"""Scenes with several beads: names, starts, and what is refused."""

import pytest

import tweezer
from tests.beads.test_motion import ONE, beads
from tweezer.scene.settings import value_at, with_settings
from tweezer.values.errors import SceneError

SCENE = beads((-1e-6, 0, 0), (1e-6, 0, 0))
SPRING = {"model": "spring", "between": ["1", "2"], "stiffness": 1e-6}


def test_keys_of_a_bead_are_numbered():
    changed = with_settings(SCENE, {"bead[2].diameter": "0.8 um"})
    assert [each.diameter for each in changed.beads] == [1e-6, 0.8e-6]
    assert value_at(changed, "bead[2].diameter") == 0.8e-6
    assert value_at(changed, "bead[3].diameter") is None
    assert changed.changed == {"bead[2].diameter": "0.8 um"}
    assert tweezer.load_scene(changed.model_dump(exclude_none=True)) == changed
    assert tweezer.Scene.model_validate_json(changed.model_dump_json(exclude_none=True)) == changed


def test_bead_begins_at_the_focus_of_its_beam():
    data = SCENE.model_dump(exclude_none=True)
    del data["start"], data["bead"]["start"], data["more_beads"][0]["start"]
    data["beam"] = [ONE["beam"] | {"position": [x, 0, 0]} for x in ("-2 um", "3 um")]
    found = tweezer.load_scene(data)
    assert [each.start for each in found.beads] == [(-2e-6, 0, 0), (3e-6, 0, 0)]
    data["beam"] = data["beam"][:1]
    with pytest.raises(SceneError, match=r"bead\[2\].start: missing; there is no beam\[2\]"):
        tweezer.load_scene(data)


def test_one_of_the_beads_alone():
    alone = SCENE.replace(**{"bead[2]": {"diameter": "0.6 um"}}).alone(2)
    assert alone.start.position == (1e-6, 0, 0)
    assert alone.bead.diameter == 0.6e-6
    assert tweezer.load_scene(alone.model_dump(exclude_none=True)) == alone
    assert tweezer.bead_properties(alone).mass > 0
    one = tweezer.load_scene("silica-1um")
    assert one.alone(1) is one
    with pytest.raises(SceneError, match="number = 3: the scene has 2 beads"):
        SCENE.alone(3)


def test_card_lists_beads_and_tethers():
    text = str(SCENE.replace(tether=[SPRING]))
    assert text.count("bead  ") == 2
    assert "spring of 1 and 2" in text


@pytest.mark.parametrize(
    ("sections", "message"),
    [
        (
            {"bead[2]": {"start": [-0.3e-6, 0, 0]}},
            r"bead\[2\].start = .*overlaps bead\[1\] by 300 nm",
        ),
        ({"bead[2]": {"name": "1"}}, "bead.name = '1': is given to several beads"),
        ({"bead": {"diameter": "2 um"}}, "bead.diameter: does not name a bead"),
        ({"bead[3]": {"diameter": "2 um"}}, r"bead\[3\]: the scene has 2 beads"),
        ({"bead[2]": {"diameter": "3 kg"}}, r"bead\[2\].diameter = '3 kg'"),
        ({"bead[2]": {"shape": "spheroid", "length": "2 um"}}, r"bead\[2\].shape = 'spheroid'"),
        (
            {"tether": [SPRING | {"between": ["1"], "point": [-1.2e-6, 0, 0]}]},
            r"tether\[1\].point = .* is inside its bead",
        ),
        ({"tether": [SPRING | {"stiffness": "1 kg"}]}, r"tether\[1\].stiffness = '1 kg'"),
        ({"bead[2]": {"diameter": "40 nm"}}, r"bead\[2\].radius = 2e-08: too different"),
        ({"start": {"position": [1e-6, 0, 0]}}, r"start.position = .*set bead\[1\].start instead"),
        ({"start": {"frame": "lens"}}, "start.frame = 'lens': requires a single bead"),
        ({"wall": {"position": "-5 um"}}, "wall: requires a single bead"),
        ({"medium": {"inertia": "memory"}}, "medium.inertia = 'memory': applies to a single bead"),
        ({"simulation": {"model": "full"}}, "simulation.model = 'full'"),
        (
            {"simulation": {"method": "dop853"}},
            "simulation.method = 'dop853': several beads are followed by their own",
        ),
        (
            {"start": {"drawn": "boltzmann"}, "forces": {"brownian": True}},
            "start.drawn = 'boltzmann'",
        ),
        ({"start": {"velocity": [1e-3, 0, 0]}}, "have no initial velocity"),
        (
            {"tether": [SPRING | {"between": ["1", "x"]}]},
            r"tether\[1\].between = 'x': unknown bead; allowed: '1', '2'",
        ),
        ({"tether": [SPRING | {"between": ["1"]}]}, "must name two beads, or one bead and a point"),
        ({"tether": [SPRING | {"between": ["1", "1"]}]}, "must name two different beads"),
        (
            {"tether": [SPRING | {"model": "fjc"}]},
            "contour_length: missing; model = 'fjc' requires it",
        ),
        ({"forces": {"between": {"kind": "wca", "strength": 1e-20}}}, "range: missing"),
        (
            {"forces": {"between": {"kind": "spring", "stiffness": 1e-6, "range": 1e-7}}},
            "range = 1e-07: does not apply to kind = 'spring'",
        ),
    ],
)
def test_refused(sections, message):
    with pytest.raises(SceneError, match=message):
        SCENE.replace(**sections)


@pytest.mark.parametrize("key", ["name", "start"])
def test_keys_of_several_beads_are_refused_for_one(key):
    value = {"name": "left", "start": [0.0, 0.0, 0.0]}[key]
    with pytest.raises(SceneError, match=f"bead.{key}: requires several beads"):
        tweezer.load_scene("silica-1um").replace(bead={key: value})


def test_tether_and_force_between_are_refused_for_one():
    with pytest.raises(SceneError, match="tether: requires several beads"):
        tweezer.load_scene("silica-1um").replace(tether=[SPRING])
    between = {"kind": "spring", "stiffness": 1e-6}
    with pytest.raises(SceneError, match=r"forces\.between: requires several beads"):
        tweezer.load_scene("silica-1um").replace(forces={"between": between})


@pytest.mark.parametrize(
    "call",
    [
        tweezer.characterise, tweezer.bead_properties, tweezer.bind, tweezer.light, tweezer.medium,
        lambda scene: tweezer.optical_force(scene, [0, 0, 0]),
    ],
)  # fmt: skip
def test_functions_of_a_single_bead_refuse_several(call):
    with pytest.raises(SceneError, match="the scene has 2 beads, and this requires one"):
        call(SCENE)


def test_material_of_every_bead_needs_one_wavelength():
    data = SCENE.model_dump(exclude_none=True)
    beam = ONE["beam"]
    data["beam"] = [beam, beam | {"wavelength": "850 nm"}]
    made = {"diameter": 1e-6, "material": "polystyrene", "start": [1e-6, 0, 0]}
    data["bead"] = [data["bead"], made]
    del data["more_beads"]
    with pytest.raises(SceneError, match=r"bead\[2\].material = 'polystyrene'"):
        tweezer.load_scene(data)


def test_unknown_material_of_the_second_bead_is_the_only_error():
    with pytest.raises(SceneError) as refused:
        SCENE.replace(**{"bead[2]": {"material": "silca", "density": None}})
    assert "density: missing" not in str(refused.value)
