"""The stiffest light: its forms, its bound, and the trap of the mask that is written."""

import numpy as np
import pytest

import tweezer
from tweezer import SceneError
from tweezer.optics.binding import light_force, paths_of_light
from tweezer.optics.waves.optimum import Forms, Limits, stiffest
from tweezer.optics.waves.phases import Phases

RADIUS = 0.25e-6
SCENE = tweezer.load_scene("silica-1um").replace(
    bead={"radius": RADIUS}, beam={"polarisation": "linear"}
)
BOTH = {"kx": {"x": 1.0}, "kz": {"z": 1.0}}


@pytest.fixture(scope="module")
def light():
    (path,) = paths_of_light(SCENE, (SCENE.beam,))
    return path.light


@pytest.fixture(scope="module")
def forms(light):
    return [Forms(light, odd=odd) for odd in (False, True)]


def even_light(forms):
    """Return the coefficients of light whose pupil has no factor."""
    harmonics = np.zeros((len(forms.orders), len(forms.nodes)), complex)
    harmonics[forms.orders == 0] = 1.0
    return forms.coefficients(harmonics)


def test_forms_are_force_and_stiffness_of_the_beam(light, forms):
    """Against the compiled sums, whose derivative is a difference of fourth order."""
    force, step = light_force(SCENE), 2e-9
    z = even_light(forms[0])
    means = forms[0].means(z)
    np.testing.assert_allclose(np.vdot(z, z).real, 1.0, rtol=1e-12)
    in_focus = force.field(np.zeros((1, 3))).force[0, 2] / light.strength
    np.testing.assert_allclose(means["f"], in_focus, rtol=1e-10)
    for i, axis in enumerate("xyz"):
        at = np.array([[-2], [-1], [1], [2]]) * step * np.eye(3)[i]
        slope = force.field(at).force[:, i] @ [1, -8, 8, -1] / (12 * step)
        expected = -slope / (light.strength * light.wavenumber)
        np.testing.assert_allclose(means[axis], expected, rtol=1e-8)


@pytest.mark.parametrize("polarisation", ["circular", "unpolarised"])
def test_forms_of_light_without_a_plane(polarisation):
    scene = SCENE.replace(beam={"polarisation": polarisation})
    (path,) = paths_of_light(scene, (scene.beam,))
    forms = Forms(path.light, odd=False)
    means = forms.means(even_light(forms))
    in_focus = light_force(scene).field(np.zeros((1, 3))).force[0, 2] / path.light.strength
    np.testing.assert_allclose(means["f"], in_focus, rtol=1e-10)
    np.testing.assert_allclose(means["x"], means["y"], rtol=1e-10)
    z, bound = stiffest(forms, {"x": 1.0}, Limits(0.0, {}))
    np.testing.assert_allclose(forms.means(z)["x"], bound, rtol=1e-6)


@pytest.mark.parametrize("goal", BOTH.values(), ids=BOTH)
@pytest.mark.parametrize("odd", [0, 1])
def test_no_light_is_stiffer_than_the_bound(forms, goal, odd):
    """The light found reaches the bound. Random light near it with the same force does not."""
    of, (axis,) = forms[odd], goal
    z, bound = stiffest(of, goal, Limits(1e-3, {}))
    means = of.means(z)
    assert abs(means["f"] - 1e-3) < 1e-9
    np.testing.assert_allclose(means[axis], bound, rtol=1e-6)
    rng, force = np.random.default_rng(5), of.force - 1e-3 * np.eye(len(z))
    tried = 0
    for _ in range(300):
        near = z + 0.05 * (rng.standard_normal(len(z)) + 1j * rng.standard_normal(len(z)))
        # Newton's method on the scale of a step along the gradient restores the force
        for _ in range(6):
            step = force @ near
            missed, slope = np.vdot(near, step).real, 2 * np.vdot(step, step).real
            near = near - missed / slope * step
        near /= np.linalg.norm(near)
        if abs(np.vdot(near, force @ near).real) < 1e-12:
            tried += 1
            assert of.means(near)[axis] < bound
    assert tried > 250


def test_lower_limits_are_met(forms):
    free = forms[0].means(stiffest(forms[0], {"x": 1.0}, Limits(0.0, {}))[0])
    least = 1.1 * free["z"]
    z, bound = stiffest(forms[0], {"x": 1.0}, Limits(0.0, {"z": least}))
    means = forms[0].means(z)
    np.testing.assert_allclose(means["z"], least, rtol=1e-6)
    assert 0.9 * free["x"] < means["x"] < free["x"]
    np.testing.assert_allclose(means["x"], bound, rtol=1e-5)
    with pytest.raises(SceneError, match="no light meets the limits"):
        stiffest(forms[0], {"x": 1.0}, Limits(0.0, {"z": 10 * least}))


def test_slopes_over_phases_are_differences(light, forms):
    of = forms[1]
    phases = Phases(of, light.pupil.radius, 32)
    start = np.random.default_rng(3).uniform(-1, 1, phases.half)
    form = of.stiffness["z"]

    def value(at):
        z = phases.coefficients(phases.light(at))
        return np.vdot(z, form @ z).real

    pixels = phases.light(start)
    slopes = phases.slopes(pixels, form @ phases.coefficients(pixels))
    for i in np.argsort(-np.abs(slopes))[:40:10]:
        change = 1e-4 * np.eye(1, phases.half, i)[0]
        difference = (value(start + change) - value(start - change)) / 2e-4
        np.testing.assert_allclose(slopes[i], difference, rtol=1e-6)


@pytest.mark.parametrize("field", [True, False], ids=["field", "phase"])
def test_trap_of_the_written_scene_is_the_predicted_one(field, tmp_path):
    best = tweezer.optimise(SCENE, "kz", field=field, file=tmp_path / "mask.npy")
    found = tweezer.characterise(best.scene).equilibrium
    np.testing.assert_allclose(found.stiffness_xyz, best.stiffness, rtol=1e-6)
    np.testing.assert_allclose(found.position, 0.0, atol=1e-12)
    before = tweezer.characterise(SCENE).equilibrium
    np.testing.assert_allclose(best.without, before.stiffness_xyz, rtol=1e-6)
    assert best.stiffness[2] < best.bound * (1 + 1e-9)
    if field:
        assert best.stiffness[2] > 0.999 * best.bound
        assert best.gain > 1.1
        assert np.iscomplexobj(best.mask)
    else:
        assert best.passed == 1
        assert best.gain > 1
    force = light_force(best.scene)
    for i, away in enumerate(best.linear_range):
        moved = np.array([[away], [-away]]) * np.eye(3)[i]
        pull = force.field(moved).force[:, i] - force.field(np.zeros((1, 3))).force[0, i]
        deviation = np.abs(pull / (best.stiffness[i] * np.array([-away, away])) - 1)
        assert abs(deviation.max() - 0.05) < 2e-3


@pytest.mark.parametrize(
    ("changes", "keywords", "message"),
    [
        ({}, {"goal": "k"}, "goal = 'k': must be one of kx, ky, kz, sum"),
        ({}, {"file": "mask.png"}, "must be a file .npy"),
        ({}, {"at_least": {"z": 1.0}}, "at_least: has 'z'; allowed: kx, ky, kz"),
        ({}, {"at_least": {"kz": -1.0}}, "at_least: kz = -1.0 is negative; must be at least 0"),
        ({}, {"at_least": {"kz": "5"}}, "at_least: kz = '5': has no unit"),
        ({}, {"file": "nowhere/mask.npy"}, "its folder does not exist; make it first"),
        ({}, {"at_least": {"kz": 1.0}}, "optimise: no light meets the limits"),
        ({"forces": {"optical": False}}, {}, "optimise: requires light in wave optics"),
        ({"optics": {"theory": "rays"}}, {}, "optimise: requires light in wave optics"),
        ({"beam": {"aberration": [[4, 0, 0.1]]}}, {}, "beam.aberration: optimise requires"),
        ({"beam": {"vortex": 1}}, {}, "vortex = 1: cannot be combined with a mask"),
        ({"beam": {"position": [1e-6, 0, 0]}}, {}, "optimise: requires one beam at rest"),
        ({"bead": {"radius": 8e-6}}, {}, "optimise requires a radius of at most"),
    ],
)
def test_wrong_scenes_and_goals_are_refused(changes, keywords, message, tmp_path):
    file = {"file": tmp_path / "mask.npy"}
    with pytest.raises(SceneError) as refused:
        tweezer.optimise(SCENE.replace(**changes), **{**file, **keywords})
    assert message in str(refused.value)
    assert "\n" not in str(refused.value)
    assert not list(tmp_path.iterdir())


def test_a_file_is_kept(tmp_path):
    file = tmp_path / "mask.npy"
    file.write_text("mine")
    with pytest.raises(SceneError, match="already exists; set overwrite"):
        tweezer.optimise(SCENE, file=file)
    assert file.read_text() == "mine"


def test_pixels_meet_lower_limits_and_the_start_may_be_far_away(light, forms, tmp_path):
    """The light of the details of pixels, which exerts no force, is compensated."""
    far = SCENE.replace(start={"position": [0, 0, 4e-6]})
    free = max(
        (each.means(stiffest(each, {"x": 1.0}, Limits(0.0, {}))[0]) for each in forms),
        key=lambda means: means["x"],
    )
    least = 1.02 * free["z"] * light.strength * light.wavenumber
    best = tweezer.optimise(far, "kx", file=tmp_path / "mask.npy", at_least={"kz": least})
    np.testing.assert_allclose(best.stiffness[2], least, rtol=2e-6)
    np.testing.assert_allclose(best.scene.simulation.loss_distance, 5e-6)
