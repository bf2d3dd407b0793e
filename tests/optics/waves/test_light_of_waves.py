"""What must hold of the force of waves: symmetries, limits, its map, and its estimated error."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

import tweezer
from tweezer.optics import light_force
from tweezer.optics.waves.by_quadrature import WavesByQuadrature
from tweezer.optics.waves.light import waves_on_bead

SCENE = tweezer.load_scene("silica-1um")
DYED = {"refractive_index": [1.5, 0.02]}


def places(count, reach, seed):
    """Random places within `reach`, m."""
    rng = np.random.default_rng(seed)
    directions = rng.normal(size=(count, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    return reach * np.cbrt(rng.random((count, 1))) * directions


def size(vectors):
    return np.linalg.norm(vectors, axis=-1)


# --- symmetries and limits -----------------------------------------------------------------------


def test_a_sphere_of_the_medium_feels_exactly_nothing():
    scene = SCENE.replace(bead={"refractive_index": SCENE.medium.refractive_index})
    assert (tweezer.optical_force(scene, places(20, 3e-6, 1)) == 0).all()


def test_light_turned_with_the_bead_turns_the_force():
    """By 90 degrees about the axis: x becomes y."""
    at = places(20, 1e-6, 2)
    quarter = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]])
    x, y = (
        SCENE.replace(beam={"polarisation": "linear", "jones": jones})
        for jones in (["1", "0.3j"], ["-0.3j", "1"])
    )
    turned = tweezer.optical_force(y, at @ quarter.T)
    np.testing.assert_allclose(turned, tweezer.optical_force(x, at) @ quarter.T, atol=1e-24)


def test_the_mirror_image_of_the_light_mirrors_the_force():
    """y -> -y: the other helicity, the other vortex; a moment is an axial vector."""
    at, mirror = places(20, 1e-6, 3), np.array([1, -1, 1])
    one, other = (
        SCENE.replace(
            bead=DYED,
            beam={"polarisation": "linear", "jones": ["1", jones], "vortex": vortex},
        )
        for jones, vortex in (("1j", 2), ("-1j", -2))
    )
    there = at * mirror
    force, moment = tweezer.optical_force(one, at), tweezer.optical_torque(one, at)
    np.testing.assert_allclose(tweezer.optical_force(other, there), force * mirror, atol=1e-24)
    np.testing.assert_allclose(tweezer.optical_torque(other, there), -moment * mirror, atol=1e-30)


@pytest.mark.parametrize("vortex", [0, 1])
def test_unpolarised_light_is_the_mean_of_two_polarisations(vortex):
    at = places(20, 1e-6, 4)
    mean = SCENE.replace(bead=DYED, beam={"polarisation": "unpolarised", "vortex": vortex})
    for pair in ((["1", "0"], ["0", "1"]), (["1", "1j"], ["1", "-1j"])):
        each = [
            mean.replace(beam={"polarisation": "linear", "jones": jones, "vortex": vortex})
            for jones in pair
        ]
        for of in (tweezer.optical_force, tweezer.optical_torque, tweezer.absorbed_power):
            found, halves = of(mean, at), [of(scene, at) for scene in each]
            np.testing.assert_allclose(
                found, sum(halves) / 2, rtol=1e-9, atol=1e-12 * size(halves[0].ravel())
            )


def test_circular_is_helicity_plus_one():
    at = places(5, 1e-6, 5)
    jones = SCENE.replace(beam={"polarisation": "linear", "jones": ["1", "1j"]})
    np.testing.assert_allclose(
        tweezer.optical_force(jones, at), tweezer.optical_force(SCENE, at), rtol=1e-12
    )


def test_force_is_that_of_lengths_in_wavelengths_times_the_power():
    at, factor = places(10, 1e-6, 6), 0.7
    scaled = SCENE.replace(
        bead={"diameter": 0.7e-6},
        beam={"wavelength": 0.7 * 1.064e-6, "power_through_pupil": "5 mW"},
    )
    np.testing.assert_allclose(
        tweezer.optical_force(scaled, factor * at), 0.1 * tweezer.optical_force(SCENE, at),
        rtol=1e-9, atol=1e-24,
    )  # fmt: skip


def test_lossless_spheres_absorb_nothing_and_are_not_turned():
    scene = SCENE.replace(bead={"refractive_index": 1.7})
    assert not scene.rotates
    assert not tweezer.optical_torque(scene, [1e-7, 0, 0]).any()
    assert tweezer.absorbed_power(scene, [1e-7, 0, 0]) == 0.0


@pytest.mark.parametrize(
    ("beam", "j"),
    [({}, 1), ({"vortex": 1}, 2), ({"polarisation": "radial", "profile": "donut"}, 0)],
    ids=["circular", "vortex", "radial"],
)
def test_light_absorbed_on_the_axis_gives_its_angular_momentum(beam, j):
    scene = SCENE.replace(bead=DYED, beam=beam)
    at = np.array([[0, 0, -3e-7], [0, 0, 1e-6]])
    omega = 2 * np.pi * 299792458.0 / scene.beam.wavelength
    moment, power = tweezer.optical_torque(scene, at), tweezer.absorbed_power(scene, at)
    assert (power > 1e-5).all()
    np.testing.assert_allclose(moment[:, 2] * omega, j * power, rtol=1e-12, atol=1e-16)
    assert not moment[:, :2].any()
    assert not tweezer.optical_force(scene, at)[:, :2].any()


def test_the_mean_over_sizes_tends_to_rays():
    """Of the force at one place of beads of 6 to 7 wavelengths, over pi in k a."""
    at, wavelength = np.array([0.3, 0.2, 0.4]), 1.064e-6 / 1.326
    diameters = wavelength * (6 + np.linspace(0, 1, 13)[:-1])
    forces = {
        theory: np.mean([
            tweezer.optical_force(
                SCENE.replace(bead={"diameter": d}, optics={"theory": theory}), at * d / 2
            )
            for d in diameters
        ], axis=0)
        for theory in ("rays", "waves")
    }  # fmt: skip
    assert size(forces["waves"] - forces["rays"]) < 0.02 * size(forces["rays"])


# --- places --------------------------------------------------------------------------------------


def test_far_places_take_more_nodes():
    """A place beyond the reach of a run is computed as by a run that reaches it."""
    at = [30e-6, 20e-6, 50e-6]
    assert size(np.array(at)) > SCENE.simulation.loss_distance
    far = SCENE.replace(simulation={"loss_distance": "80 um"})
    np.testing.assert_allclose(
        tweezer.optical_force(SCENE, at), tweezer.optical_force(far, at), rtol=1e-7
    )


def test_a_beam_far_from_the_origin_reaches_the_bead():
    """A run is lost by its distance from the origin, and the light knows that from its focus."""
    at = np.array([0.0, 0.0, -15e-6])
    moved = SCENE.replace(
        beam={"motion": {"kind": "ramp", "velocity": [0, 0, 1.5e-3], "end": "10 ms"}},
        simulation={"duration": "20 ms"},
    )
    field = light_force(moved).field(at[None], time=0.01)
    assert field.error[0] < 1e-6 * size(field.force[0])
    np.testing.assert_allclose(
        field.force[0], tweezer.optical_force(SCENE, [0, 0, -30e-6]), rtol=1e-7
    )


# --- errors --------------------------------------------------------------------------------------

HARD = {
    "metal": {"bead": {"refractive_index": [0.2, 7.0], "diameter": "0.3 um"}},
    "bubble": {"bead": {"refractive_index": 1.0, "diameter": "2 um"}},
    "nearly the medium": {"bead": {"refractive_index": 1.326 * (1 + 1e-6)}},
    "tiny": {"bead": {"diameter": "20 nm"}, "medium": {"mean_free_path": "1e-12 m"}},
    "10 um": {"bead": {"diameter": "10 um"}},
    "narrow cone": {"lens": {"numerical_aperture": 0.1}},
    "wide cone": {"lens": {"numerical_aperture": 0.999 * 1.326}, "beam": {"profile": "uniform"}},
    "narrow beam": {"beam": {"waist": "0.3 mm"}},
    "bright axis": {"beam": {"polarisation": "radial"}},
    "phase plate": {"beam": {"profile": "uniform", "vortex": 3, "polarisation": "linear"}},
    "beside a wide cone": {"lens": {"numerical_aperture": 1.3}, "beam": {"wavelength": "532 nm"}},
    "cover": {"lens": {"cover": {"refractive_index": 1.518, "depth": "15 um"}}},
}


@pytest.mark.parametrize("changes", HARD.values(), ids=HARD)
def test_no_error_is_above_its_estimate(changes):
    """By a quadrature of another rule, to 1e-12."""
    tolerance = 1e-8
    waves = waves_on_bead(SCENE.replace(**changes))
    near, far = places(30, 2 * waves.radius, 7), places(30, 9e-6, 8)
    at = np.concatenate([near, far, [[0, 0, 0], [0, 0, 1e-6], [10e-6, 0, 0], [0, 20e-6, 0]]])
    found = WavesByQuadrature(waves, tolerance, 20e-6).field(at)
    exact = WavesByQuadrature(waves, 1e-12, 22e-6).field(at)
    assert np.isfinite(found.error).all()
    error = size(found.force - exact.force)
    assert (error <= found.error + exact.error).all()
    assert (found.error <= tolerance * (size(exact.force) * 1.001 + 0.01 * waves.strength)).all()


# --- the map -------------------------------------------------------------------------------------

MAPPED = {
    "circular": {},
    "linear": {"beam": {"polarisation": "linear", "jones": ["1", "0.3+0.4j"]}},
    "dyed, with a vortex": {"bead": DYED, "beam": {"polarisation": "linear", "vortex": 1}},
    "0.2 um, 3 um far": {
        "bead": {"diameter": "0.2 um"},
        "medium": {"mean_free_path": "1e-12 m"},
        "optics": {"table_range": "3 um"},
    },
    "radial, behind a cover": {
        "beam": {"polarisation": "radial"},
        "lens": {"cover": {"refractive_index": 1.518, "depth": "5 um"}},
    },
}


@pytest.fixture
def empty_cache(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))


@pytest.mark.usefixtures("empty_cache")
@pytest.mark.parametrize("changes", MAPPED.values(), ids=MAPPED)
def test_the_map_errs_by_less_than_it_certifies(changes):
    """Force, moment and gradients, also where it ends."""
    scene = SCENE.replace(**changes)
    mapped = scene.replace(optics={"evaluator": "map"})
    at = places(3000, 1.1 * scene.table_reach, 9)
    at[0] = 0.0
    read, true = (light_force(each).field(at, gradient=True) for each in (mapped, scene))
    table = tweezer.optics.force_map(mapped)
    inside = size(at) < table.range
    assert 0.5 < inside.mean() < 1
    assert table.certified_error <= 1e-7 * table.largest_force
    error = size(read.force - true.force)
    assert (error <= read.error + true.error).all()
    assert (read.error[inside] == table.certified_error).all()
    largest = np.abs(true.force_gradient).max()
    # a derivative errs by more: of degree 6 on a piece, where the force has 7
    assert np.abs(read.force_gradient - true.force_gradient).max() < 5e-6 * largest
    assert np.abs(read.moment - true.moment).max() <= 1e-6 * np.abs(true.moment).max()
    turning = np.abs(true.moment_gradient).max()
    assert np.abs(read.moment_gradient - true.moment_gradient).max() <= 1e-5 * turning


@pytest.mark.usefixtures("empty_cache")
def test_a_bead_of_another_radius_in_the_same_light():
    at = places(50, 0.6e-6, 10)
    for evaluator in ("quadrature", "map"):
        scene = SCENE.replace(optics={"evaluator": evaluator})
        other = scene.replace(bead={"diameter": "0.8 um"})
        force = light_force(scene).of_radius(0.4e-6).field(at).force
        expected = light_force(other).field(at).force
        assert size(force - expected).max() < 1e-7 * size(expected).max()


@pytest.mark.usefixtures("empty_cache")
def test_one_map_for_every_power_and_helicity_is_its_own():
    mapped = SCENE.replace(optics={"evaluator": "map"})
    first = tweezer.optics.force_map(mapped)
    assert tweezer.optics.force_map(mapped.replace(beam={"power": "3 mW"})).path == first.path
    for changes in (
        {"bead": {"diameter": "0.9 um"}}, {"beam": {"wavelength": "1 um"}},
        {"beam": {"polarisation": "unpolarised"}}, {"bead": {"refractive_index": "1.45+0.001j"}},
        {"optics": {"table_range": 2.0}},
    ):  # fmt: skip
        assert tweezer.optics.force_map(mapped.replace(**changes)).path != first.path


def test_a_map_of_too_many_pieces_is_refused():
    scene = SCENE.replace(
        bead={"diameter": "20 um"}, optics={"evaluator": "map", "table_range": "500 um"}
    )
    with pytest.raises(tweezer.SceneError, match="pieces are too many for a map"):
        tweezer.optics.force_map(scene)


def test_two_absorbing_beams_heat_by_both():
    one = SCENE.replace(bead=DYED)
    beam = one.beam.model_dump(exclude_none=True)
    two = one.replace(beam=[{**beam, "position": [1e-6, 0, 0]}, {**beam, "direction": "down"}])
    at = [2e-7, 1e-7, 3e-7]
    expected = tweezer.absorbed_power(one, [-8e-7, 1e-7, 3e-7])
    expected += tweezer.absorbed_power(one, [2e-7, -1e-7, -3e-7])
    assert tweezer.absorbed_power(two, at) == pytest.approx(expected, rel=1e-12)


def test_waves_farther_than_can_be_computed_are_refused():
    scene = SCENE.replace(optics={"theory": "waves"}, simulation={"loss_distance": "2 mm"})
    with pytest.raises(tweezer.SceneError, match=r"simulation\.loss_distance = 0\.002: waves are"):
        tweezer.optical_force(scene, [0, 0, 0])


def test_light_that_nodes_do_not_describe_is_refused():
    deep = SCENE.replace(lens={"cover": {"refractive_index": 1.518, "depth": "1 cm"}})
    with pytest.raises(
        tweezer.SceneError, match=r"lens\.cover\.depth: the light behind the lens is"
    ):
        tweezer.optical_force(deep, [0, 0, 0])


def test_beads_too_large_for_waves_are_refused():
    large = SCENE.replace(bead={"diameter": "60 um"}, optics={"theory": "waves"})
    with pytest.raises(
        tweezer.SceneError, match=r"bead\.radius = 3e-05: waves are computed for be"
    ):
        tweezer.optical_force(large, [0, 0, 0])


@pytest.mark.usefixtures("empty_cache")
def test_the_map_of_light_that_a_small_bead_does_not_see():
    """A vortex so strong that no wave reaches the bead."""
    dark = SCENE.replace(
        bead={"diameter": "0.2 um"}, medium={"mean_free_path": "1e-12 m"},
        beam={"vortex": 50}, optics={"evaluator": "map"},
    )  # fmt: skip
    assert not tweezer.optical_force(dark, [0, 0, 1e-7]).any()


def test_places_out_of_reach_of_a_compiled_loop_are_marked():
    waves = dataclasses.replace(light_force(SCENE), reach=2e-6)
    kernel_alone = super(WavesByQuadrature, waves).field(np.array([[0, 0, 1e-6], [0, 0, 1e-4]]))
    assert np.isinf(kernel_alone.error).tolist() == [False, True]
