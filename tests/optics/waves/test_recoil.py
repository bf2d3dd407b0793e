"""Photon recoil, against plane waves, the limit of a small sphere, and identities."""

import dataclasses
import math

import numpy as np
import pytest

import tweezer
from tests.optics.waves.test_pupil import ANGLE, EVEN, N_M, ONE, VACUUM, reference, scene_with
from tests.reference.far_field import Far
from tests.reference.plane_waves import Light, Sphere, lens
from tweezer import SceneError
from tweezer.optics.waves import incident

RADIUS = 0.25e-6
SMALL = {"radius": RADIUS}
PLACE = np.array([0.2, -0.15, 0.25]) * 1e-6
#: hbar omega (n_m/c)^2, N^2 s per watt: `recoil` over it is a number per watt
UNIT = 1.054571817e-34 * 2 * math.pi * 299792458.0 / VACUUM * (N_M / 299792458.0) ** 2
CASES = {
    "linear": ([], {}, {}, 1.45),
    "absorbing, circular": (
        [], {"polarisation": (ONE, ONE * 1j)}, {"polarisation": "circular"}, 1.5 + 0.05j,
    ),
    "coma": ([(3, -1, 0.02)], {}, {}, 1.45),
    "unpolarised": (
        [], {"polarisation": "unpolarised"}, {"polarisation": "unpolarised"}, 1.45,
    ),
    "vortex, left circular": (
        [], {"polarisation": (ONE, -ONE * 1j), "vortex": 1}, {"jones": [1, "-1j"], "vortex": 1},
        1.6,
    ),
    "radial": ([], {"polarisation": "radial"}, {"polarisation": "radial"}, 1.45),
}  # fmt: skip


@pytest.mark.parametrize(("terms", "light", "keys", "index"), CASES.values(), ids=CASES.keys())
def test_recoil_is_that_of_plane_waves(terms, light, keys, index):
    lit = scene_with(terms, keys) if terms else EVEN.replace(beam=keys)
    scene = lit.replace(bead={**SMALL, "refractive_index": f"{index}".strip("()")})
    waves = dataclasses.replace(reference(terms, **light), uneven=12 if terms else 0)
    expected = Far(waves, Sphere(((RADIUS, index),)), PLACE).recoil()
    found = tweezer.recoil(scene, PLACE)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-10 * np.abs(expected).max())


def test_recoil_of_small_sphere_in_plane_light_is_that_of_dipole():
    """1/5, 2/5 and 7/5 of the scattered power along E, across E and along the light."""
    angle, radius, m = 0.02, 10e-9, 1.45 / N_M
    scene = EVEN.replace(
        bead={"radius": radius}, lens={"numerical_aperture": N_M * math.sin(angle)},
        medium={"mean_free_path": 1e-12},
    )  # fmt: skip
    k = 2 * math.pi * N_M / VACUUM
    section = 8 * math.pi / 3 * k**4 * radius**6 * ((m**2 - 1) / (m**2 + 2)) ** 2
    intensity = math.pi * math.sin(angle) ** 2 / (VACUUM / N_M) ** 2  # of 1 W in the focus
    found = tweezer.recoil(scene, [0, 0, 0]) / UNIT / (section * intensity)
    # of order (k a)^2 and the square of the angle
    np.testing.assert_allclose(found.diagonal(), [0.2, 0.4, 1.4], rtol=5e-3)
    share = found.diagonal() / (found.trace() / 2)
    np.testing.assert_allclose(share, [0.2, 0.4, 1.4], atol=1e-3)


@pytest.mark.parametrize("diameter", [0.1e-6, 0.6e-6, 2e-6])
def test_recoil_is_positive_and_at_most_four_photons_momenta(diameter):
    """Each photon gives the sphere at most the momentum 2 hbar k."""
    scene = EVEN.replace(bead={"diameter": diameter}, medium={"mean_free_path": 1e-11})
    places = np.random.default_rng(1).normal(scale=0.5e-6, size=(30, 3))
    found = tweezer.recoil(scene, places) / UNIT
    np.testing.assert_allclose(found, np.swapaxes(found, 1, 2), rtol=0, atol=1e-13)
    assert (np.linalg.eigvalsh(found) > 0).all()
    assert (np.trace(found, axis1=1, axis2=2) <= 4).all()


def test_light_turned_about_the_axis_turns_the_recoil():
    angle = 0.7
    turn = np.array([
        [math.cos(angle), -math.sin(angle), 0], [math.sin(angle), math.cos(angle), 0], [0, 0, 1],
    ])  # fmt: skip
    other = EVEN.replace(beam={"jones": (math.cos(angle), math.sin(angle))})
    found = tweezer.recoil(other, PLACE @ turn.T)
    expected = turn @ tweezer.recoil(EVEN, PLACE) @ turn.T
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12 * expected.max())


def test_imprecision_times_back_action_is_planck_constant_squared():
    """The derivative of the outgoing light over the position of the sphere gives its recoil."""
    scene, light, sphere = EVEN.replace(bead=SMALL), reference([]), Sphere(((RADIUS, 1.45),))
    step, weights, axis = 4e-9, {-2: 1 / 12, -1: -2 / 3, 1: 2 / 3, 2: -1 / 12}, np.eye(3)[1]
    u, shares = np.polynomial.legendre.leggauss(16)
    slopes, turns = 0.0, None
    for i, weight in weights.items():
        far = Far(light, sphere, PLACE + i * step * axis)
        turns = len(far.phi) if turns is None else turns
        outgoing = []
        for each in np.arccos(u):
            s = np.array([math.sin(each) * np.cos(far.phi), math.sin(each) * np.sin(far.phi),
                          np.full(len(far.phi), math.cos(each))])  # fmt: skip
            fixed = np.exp(-1j * light.k * (far.place @ s))
            series = np.fft.fft(far.scattered(each)[0] * fixed)[..., : len(far.phi)]
            assert len(far.phi) == turns
            outgoing.append(np.fft.ifft(series))
        slopes = slopes + weight * np.array(outgoing) / step
    knowable = (
        2 * math.pi / turns * shares @ (np.abs(slopes) ** 2).sum(axis=(1, 2, 3))
    ) / light.k**2
    assert tweezer.recoil(scene, PLACE)[1, 1] / UNIT == pytest.approx(knowable, rel=1e-6)


def test_recoil_of_beams_adds_and_follows_them():
    """Two beams, one from above with its own focus, of which the power changes."""
    up, down = (
        {**EVEN.beam.model_dump(exclude_none=True), **keys}
        for keys in (
            {"position": (0, 0, 0.1e-6)},
            {"direction": "down", "power_through_pupil": 0.5, "position": (0.1e-6, 0, 0),
             "modulation": {"kind": "ramp", "begin": 0, "end": 1, "factor": 3}},
        )
    )  # fmt: skip
    both = EVEN.replace(beam=[up, down])
    expected = tweezer.recoil(EVEN, PLACE - [0, 0, 0.1e-6])
    signs = np.array([1, -1, -1])
    turned = tweezer.recoil(EVEN, signs * (PLACE - [0.1e-6, 0, 0])) * np.outer(signs, signs)
    for time, power in ((0, 0.5), (1, 1.5)):
        found = tweezer.recoil(both, PLACE, time=time)
        np.testing.assert_allclose(
            found, expected + power * turned, rtol=0, atol=1e-12 * found.max()
        )


def test_recoil_without_light_is_zero():
    dark = EVEN.replace(beam={"power_through_pupil": 0.0})
    np.testing.assert_array_equal(tweezer.recoil(dark, np.zeros((2, 3))), np.zeros((2, 3, 3)))


def test_recoil_behind_a_cover_is_that_of_plane_waves():
    described = EVEN.replace(bead=SMALL).model_dump(exclude_none=True)
    described["lens"]["cover"] = {"refractive_index": 1.518, "depth": 5e-6}
    scene = tweezer.load_scene(described)
    angle = math.asin(N_M * math.sin(ANGLE) / 1.518)
    light = Light(N_M, VACUUM, angle, lens(angle), (1, 0), 0, (1.518, 5e-6))
    place = PLACE - np.array([0, 0, 0.6e-6])
    expected = Far(light, Sphere(((RADIUS, 1.45),)), place).recoil()
    found = tweezer.recoil(scene, place)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9 * np.abs(expected).max())


def test_recoil_of_rays_and_of_other_bodies_is_refused():
    with pytest.raises(SceneError, match=r"optics.theory = 'rays'.*set optics.theory = 'waves'"):
        tweezer.recoil("thesis-990nm", [0, 0, 0])
    with pytest.raises(SceneError, match=r"bead.shape = .*sphere"):
        tweezer.recoil("flipping-rod", [0, 0, 0])


def test_recoil_of_small_sphere_in_standing_wave_is_that_of_dipole():
    """In units of one beam's recoil along E, which is 1/5 of its scattered power.

    At an antinode the field is twice that of one beam: 1/5, 2/5 and 2/5 of four times its scattered
    power, as the momentum along the wave is zero before scattering. At a node nothing is scattered,
    and the gradient of the field along z gives 4 times one beam's scattered power.
    """
    keys = {
        "lens": {"numerical_aperture": N_M * math.sin(0.02)}, "bead": {"radius": 10e-9},
        "medium": {"mean_free_path": 1e-12},
    }  # fmt: skip
    beam = {**EVEN.beam.model_dump(exclude_none=True), "coherent": "a"}
    standing = EVEN.replace(beam=[beam, {**beam, "direction": "down"}], **keys)
    unit = tweezer.recoil(EVEN.replace(**keys), [0, 0, 0])[0, 0]
    antinode, node = tweezer.recoil(standing, [[0, 0, 0], [0, 0, VACUUM / N_M / 4]]) / unit
    np.testing.assert_allclose(antinode.diagonal(), [4, 8, 8], rtol=5e-3)
    np.testing.assert_allclose(node.diagonal(), [0, 0, 20], atol=5e-2)


def test_recoil_in_light_too_uneven_for_its_error_is_refused(monkeypatch):
    monkeypatch.setattr(incident, "SMALL", 1e-19)
    with pytest.raises(SceneError, match=r"beam: .* too uneven .* error would be"):
        tweezer.recoil(EVEN, PLACE)


def test_recoil_too_far_from_the_focus_is_refused():
    with pytest.raises(SceneError, match=r"positions = 0.01: .*allowed: up to that"):
        tweezer.recoil(EVEN, [0, 0, 0.01])
