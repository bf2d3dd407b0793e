"""Annuli, axicons and uneven amplitudes over the pupil, against plane waves."""

import math
from dataclasses import dataclass

import numpy as np
import pytest

import tweezer
from tests.optics.waves.test_pupil import ANGLE, EVEN, N_M, NA, PLACES, VACUUM, R, polynomial
from tests.reference.plane_waves import Light, Sphere, lens, push
from tweezer import SceneError

SILICA = Sphere(((0.5e-6, 1.45),))


@dataclass(frozen=True)
class Ring(Light):
    """Light from an inner angle on."""

    inner: float = 0.0

    def nodes(self, count):
        x, weight = np.polynomial.legendre.leggauss(count)
        theta = self.inner + (self.angle - self.inner) * (x + 1) / 2
        return theta, weight * (self.angle - self.inner) / 2 * np.sin(theta)


def with_beam(**keys):
    described = EVEN.model_dump(exclude_none=True)
    described["beam"] |= keys
    if described["beam"]["polarisation"] != "linear":
        described["beam"].pop("jones", None)
    return tweezer.load_scene(described)


def ring_light(inner, outer, factor=None, sigma=None, **keys):
    """Light of 1 W between two radii over R, of an even or a Gaussian pupil."""
    low, high = (math.asin(r * NA / N_M) for r in (inner, outer))
    whole = lens(ANGLE)

    def W(theta):
        rho = np.sin(theta) / math.sin(ANGLE)
        return whole(theta) * (1.0 if sigma is None else np.exp(-(rho**2) / (2 * sigma**2)))

    x, weight = np.polynomial.legendre.leggauss(100)
    theta = low + (high - low) * (x + 1) / 2
    power = math.pi * (high - low) * weight @ (W(theta) * np.sin(theta))
    return Ring(
        N_M, VACUUM, high, lambda theta: W(theta) / power, factor=factor,
        uneven=60 if factor else 0, inner=low, **keys,
    )  # fmt: skip


RINGS = {
    "even": (0.5, 0.9, {}, {}),
    "thin": (0.90, 0.93, {}, {}),
    "to the rim": (0.3, 1.0, {"polarisation": "radial"}, {"polarisation": "radial"}),
    "Gaussian": (0.4, 0.8, {"sigma": 0.5}, {"profile": "gaussian", "sigma": 0.5 * R}),
    "opening": (0.0, 0.6, {"polarisation": "unpolarised"}, {"polarisation": "unpolarised"}),
}


@pytest.mark.parametrize(("inner", "outer", "light", "keys"), RINGS.values(), ids=RINGS.keys())
def test_force_of_an_annulus_is_that_of_plane_waves(inner, outer, light, keys):
    """Within 1e-9 of the largest component; the stated error is not below the true one."""
    light = {"polarisation": (1, 0), **light}
    scene = with_beam(annulus=[inner * R, outer * R], **keys)
    expected = push(ring_light(inner, outer, **light), SILICA, PLACES).force
    found = tweezer.optical_force(scene, PLACES)
    largest = np.abs(expected).max()
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9 * largest)
    stated = tweezer.optical_force_error(scene, PLACES)
    assert (np.linalg.norm(found - expected, axis=1) <= stated + 1e-11 * largest).all()


def test_coma_in_an_annulus_is_that_of_plane_waves():
    def factor(theta, phi):
        return np.exp(0.2j * math.pi * polynomial(3, 1, np.sin(theta) / math.sin(ANGLE), phi))

    scene = with_beam(annulus=[0.4 * R, 0.9 * R], aberration=[[3, 1, 0.1]])
    expected = push(ring_light(0.4, 0.9, factor, polarisation=(1, 0)), SILICA, PLACES).force
    found = tweezer.optical_force(scene, PLACES)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9 * np.abs(expected).max())


@pytest.mark.parametrize(
    ("keys", "of"),
    [
        ({"axicon": 9.0}, lambda rho, _: np.exp(-9j * rho)),
        ({"amplitude_terms": [[2, 0, 0.2], [3, -1, 0.15]]},
         lambda *at: 1 + 0.2 * polynomial(2, 0, *at) + 0.15 * polynomial(3, -1, *at)),
        ({"amplitude_terms": [[5, 0.2]], "aberration_order": "osa", "axicon": -3.0},
         lambda rho, phi: (1 + 0.2 * polynomial(2, 2, rho, phi)) * np.exp(3j * rho)),
    ],
    ids=["axicon", "amplitude", "both"],
)  # fmt: skip
def test_force_of_an_uneven_pupil_is_that_of_plane_waves(keys, of):
    """The mean of |1 + sum a Z|^2 is 1 + sum a^2: the terms are orthonormal."""
    scene = with_beam(**keys)
    light = Light(
        N_M, VACUUM, ANGLE, lens(ANGLE), (1, 0), 0, None,
        lambda theta, phi: of(np.sin(theta) / math.sin(ANGLE), phi), 60,
    )  # fmt: skip
    mean = 1 + sum(term[-1] ** 2 for term in keys.get("amplitude_terms", ()))
    expected = push(light, SILICA, PLACES).force / mean
    found = tweezer.optical_force(scene, PLACES)
    largest = np.abs(expected).max()
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9 * largest)
    stated = tweezer.optical_force_error(scene, PLACES)
    assert (np.linalg.norm(found - expected, axis=1) <= stated + 1e-11 * largest).all()


def test_power_before_an_annulus_is_that_of_the_whole_beam():
    keys = {"annulus": [0.4 * R, 0.8 * R], "power": 1.0, "power_through_pupil": None}
    for more, share in (
        ({}, 0.8**2 - 0.4**2),
        ({"profile": "gaussian", "sigma": 0.5 * R}, math.exp(-0.32) - math.exp(-1.28)),
        ({"profile": "gaussian", "sigma": [0.5 * R, 0.5 * R]}, math.exp(-0.32) - math.exp(-1.28)),
    ):
        scene = with_beam(**keys, **more)
        found = tweezer.optics.fraction_through_pupil(scene.lens, scene.beam)
        assert found == pytest.approx(share, rel=1e-9)


def test_annulus_over_the_whole_pupil_is_the_whole_pupil():
    scene = with_beam(annulus=[0.0, 2 * R])
    expected = tweezer.optical_force(EVEN, PLACES)
    found = tweezer.optical_force(scene, PLACES)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-14 * np.abs(expected).max())


def test_map_of_an_annulus_is_its_force():
    scene = with_beam(annulus=[0.3 * R, 0.9 * R], axicon=2.0, polarisation="circular")
    expected = tweezer.optical_force(scene, PLACES)
    found = tweezer.optical_force(scene.replace(optics={"evaluator": "map"}), PLACES)
    np.testing.assert_allclose(found, expected, atol=1e-6 * np.abs(expected).max())


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ({"annulus": [1e-3, 1e-3]}, "the outer radius must be the larger one"),
        ({"annulus": [2e-3, 1e-3]}, "the outer radius must be the larger one"),
        ({"annulus": [-1e-3, 1e-3]}, "annulus"),
        ({"annulus": [1e-3]}, "annulus"),
        ({"axicon": 300}, "axicon"),
        ({"axicon": "steep"}, "axicon"),
        ({"amplitude_terms": [[2, 1, 0.1]]}, "amplitude_terms.0 = .*n - m even"),
        ({"amplitude_terms": [[4, 0.1]]}, "aberration_order: missing"),
        ({"amplitude_terms": [[2, 0, 6]]}, "at most 5"),
        ({"amplitude_terms": []}, "1 to 500"),
    ],
)
def test_wrong_keys_are_refused_in_one_line(keys, said):
    with pytest.raises(SceneError, match=said) as refusal:
        with_beam(**keys)
    assert "\n" not in str(refusal.value)


def test_annulus_without_light_is_refused():
    with pytest.raises(SceneError, match=r"beam\.annulus = .*transmits almost none"):
        tweezer.optical_force(with_beam(annulus=[1.2 * R, 2 * R]), PLACES)


@pytest.mark.parametrize("key", ["annulus", "axicon", "amplitude_terms"])
def test_rays_refuse_the_keys(key):
    value = {"annulus": [0, 1e-3], "axicon": 1.0, "amplitude_terms": [[2, 0, 0.1]]}[key]
    with pytest.raises(SceneError, match=rf"beam\.{key} requires wave optics"):
        with_beam(**{key: value}).replace(optics={"theory": "rays"})


@pytest.mark.parametrize("terms", [[[0, 0, -1]], [[0, 0, -0.5], [0, 0, -0.5]], [[0, 0, -1 + 1e-9]]])
def test_amplitude_terms_that_leave_no_light_are_refused(terms):
    with pytest.raises(SceneError, match=r"beam\.amplitude_terms: no light passes"):
        tweezer.optical_force(with_beam(amplitude_terms=terms), PLACES[:1])
