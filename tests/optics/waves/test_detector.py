"""Signals of photodiodes behind a bead, against plane waves, closed forms and momentum."""

import dataclasses
import math

import numpy as np
import pytest

import tweezer
from tests.optics.waves.test_pupil import ANGLE, EVEN, N_M, ONE, VACUUM, reference, scene_with
from tests.reference.far_field import Far
from tests.reference.plane_waves import Sphere, lens
from tweezer import SceneError
from tweezer.optics.detection import detection
from tweezer.optics.waves import detector

PLACE = np.array([0.2, -0.15, 0.25]) * 1e-6
QUANTUM = 1.054571817e-34 * 2 * math.pi * 299792458.0 / VACUUM


def scene_of(radius, index, terms=(), light=None, **detector):
    lit = scene_with(terms, light or {}) if terms else EVEN.replace(beam=light or {})
    bead = {"radius": radius, "refractive_index": f"{index}".strip("()")}
    return lit.replace(bead=bead, detector=detector)


def weights(kind, widest):
    """Return rows of the weights of a diode's signals at one polar angle and azimuths."""

    def of(theta, phi):
        s = np.array([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi),
                      np.full_like(phi, np.cos(theta))])  # fmt: skip
        return {
            "quadrant": np.array([np.sign(np.cos(phi)), np.sign(np.sin(phi)), np.ones_like(phi)]),
            "linear": np.array([*s[:2] / math.sin(widest), np.ones_like(phi)]),
            "momentum": s,
        }[kind]

    return of


CASES = {
    "narrow": (0.25e-6, 1.57, (), {}, {"numerical_aperture": 0.5}),
    "as the lens": (0.25e-6, 1.57, (), {}, {"numerical_aperture": 1.2}),
    "wider than the lens": (0.5e-6, 1.45, (), {}, {"numerical_aperture": 1.3}),
    "linear diode": (
        0.25e-6, 1.5 + 0.02j, (), {"polarisation": "circular"},
        {"numerical_aperture": 0.9, "kind": "linear"},
    ),
    "backward": (
        0.25e-6, 1.57, (), {"polarisation": "unpolarised"},
        {"numerical_aperture": 1.2, "side": "backward"},
    ),
    "unpolarised": (
        0.2e-6, 1.45, (), {"polarisation": "unpolarised"}, {"numerical_aperture": 0.9},
    ),
    "coma": (0.2e-6, 1.45, ((3, -1, 0.02),), {}, {"numerical_aperture": 0.9}),
    "momentum": (
        0.25e-6, 1.57, (), {"polarisation": "radial"},
        {"numerical_aperture": 0.9, "kind": "momentum"},
    ),
}  # fmt: skip
LIGHTS = {
    "circular": {"polarisation": (ONE, ONE * 1j)}, "unpolarised": {"polarisation": "unpolarised"},
    "radial": {"polarisation": "radial"},
}  # fmt: skip


def expected(radius, index, terms, light, detector, place=PLACE):
    """Return the signals by the reference, with an aperture in one or two panels."""
    waves = reference(terms, **LIGHTS.get(light.get("polarisation"), {}))
    waves = dataclasses.replace(waves, uneven=12 if terms else 0)
    widest = math.asin(detector["numerical_aperture"] / N_M)
    edges = [0, widest] if widest < ANGLE + 1e-9 else [0, ANGLE, widest]
    if detector.get("side") == "backward":
        edges = [math.pi - widest, math.pi]
    of = weights(detector.get("kind", "quadrant"), widest)
    return Far(waves, Sphere(((radius, index),)), place).signal(edges, of, count=20, around=16)


@pytest.mark.parametrize(
    ("radius", "index", "terms", "light", "detector"), CASES.values(), ids=CASES.keys()
)
def test_signals_are_those_of_plane_waves(radius, index, terms, light, detector):
    scene = scene_of(radius, index, terms, light, **detector)
    found, _, _ = detection(scene).with_slopes(PLACE[None])
    power = expected(radius, index, terms, light, detector)
    np.testing.assert_allclose(found[0], power, rtol=0, atol=1e-9)


def test_slopes_are_those_of_plane_waves():
    """The reference is differentiated over four places along x and z."""
    case, step = CASES["narrow"], 4e-9
    _, (slopes,), _ = detection(scene_of(*case[:4], **case[4])).with_slopes(PLACE[None])
    for axis in (0, 2):
        change = sum(
            weight * expected(*case, place=PLACE + i * step * np.eye(3)[axis]) / step
            for i, weight in ((-2, 1 / 12), (-1, -2 / 3), (1, 2 / 3), (2, -1 / 12))
        )
        np.testing.assert_allclose(
            slopes[:, axis], change, rtol=0, atol=1e-6 * np.abs(change).max()
        )


def test_signal_of_small_bead_in_weak_focus_is_that_of_gittes_and_schmidt():
    """Opt. Lett. 23, 7 (1998): (16/sqrt(pi)) (k alpha/w^2) exp(-2 u^2) integral exp(y^2), u = x/w.

    The bead scatters like a dipole of the polarisability alpha. Corrections are of order (k a)^2
    and of the square of the angle.
    """
    from scipy.special import dawsn

    radius, spread, m = 20e-9, 0.02, 1.45 / N_M
    aperture = N_M * math.sin(6 * spread)
    scene = EVEN.replace(
        bead={"radius": radius}, medium={"mean_free_path": 1e-12},
        lens={"numerical_aperture": aperture},
        beam={"profile": "gaussian", "sigma": spread / math.sin(6 * spread) * 2.5e-3},
        detector={"numerical_aperture": aperture},
    )  # fmt: skip
    k = 2 * math.pi * N_M / VACUUM
    waist = 1 / (k * spread)
    alpha = radius**3 * (m**2 - 1) / (m**2 + 2)
    u = np.array([0.1, 0.4, 1.0])
    integral = dawsn(u) * np.exp(-(u**2))
    theory = 16 / math.sqrt(math.pi) * k * alpha / waist**2 * integral
    signals = detection(scene).signals(np.outer(u * waist, [1, 0, 0]))
    np.testing.assert_allclose(signals[:, 0] / signals[:, 2], theory, rtol=3e-3)


def test_momentum_of_all_light_is_minus_the_force():
    """The light comes with the mean of cos(theta) along z and loses what the bead gains."""
    whole = {"numerical_aperture": N_M, "kind": "momentum"}
    signals = sum(
        detection(scene_of(0.5e-6, 1.57, **whole, side=side)).signals(PLACE[None])[0]
        for side in ("forward", "backward")
    )
    W, (x, weight) = lens(ANGLE), np.polynomial.legendre.leggauss(60)
    theta = ANGLE * (x + 1) / 2
    came = math.pi * ANGLE * weight @ (W(theta) * np.cos(theta) * np.sin(theta))
    force = tweezer.optical_force(scene_of(0.5e-6, 1.57, **whole), PLACE)
    gained = (np.array([0, 0, came]) - signals) * N_M / 299792458.0
    np.testing.assert_allclose(gained, force, rtol=0, atol=1e-9 * np.abs(force).max())


def test_diode_without_scattering_receives_the_light_within_its_aperture():
    """An evenly lit pupil: the power goes as the square of the aperture, and the halves agree."""
    scene = scene_of(0.25e-6, N_M, numerical_aperture=0.9, efficiency=0.8)
    signals, slopes, _ = detection(scene).with_slopes(PLACE[None])
    np.testing.assert_allclose(signals[0], [0, 0, 0.8 * (0.9 / 1.2) ** 2], rtol=0, atol=1e-12)
    np.testing.assert_array_equal(slopes, 0.0)


def test_quarter_turn_of_circular_light_exchanges_x_and_y():
    scene = scene_of(0.5e-6, 1.45, (), {"polarisation": "circular"}, numerical_aperture=0.9)
    x, y, z = PLACE
    (a, b, c), turned = detection(scene).signals(np.array([[x, y, z], [-y, x, z]]))
    np.testing.assert_allclose(turned, [-b, a, c], rtol=0, atol=1e-13)


def test_signals_along_a_path_are_those_at_its_positions():
    seen = detection(scene_of(0.5e-6, 1.45, numerical_aperture=0.9))
    path = PLACE + np.random.default_rng(1).normal(scale=[3e-8, 5e-8, 9e-8], size=(8000, 3))
    path[17] = np.nan
    signals, noise = seen.along(path)
    assert np.isnan(signals[17]).all()
    assert np.isnan(noise[17]).all()
    direct, _, spectra = seen.with_slopes(path[:12])
    np.testing.assert_allclose(signals[:12], direct, rtol=0, atol=1e-10)
    np.testing.assert_allclose(noise[:12], spectra, rtol=1e-9)
    np.testing.assert_allclose(noise[:12, 0], 2 * QUANTUM * direct[:, 2], rtol=1e-9)


DETECTED = scene_of(0.25e-6, 1.57, numerical_aperture=0.9, efficiency=0.5)


@pytest.fixture(scope="module")
def found():
    return tweezer.detect(DETECTED)


def test_default_position_is_the_equilibrium(found):
    rest = tweezer.characterise(DETECTED).equilibrium.position
    np.testing.assert_allclose(found["rest"], rest, rtol=0, atol=1e-13)
    np.testing.assert_array_equal(found["position"], found["rest"])


def test_shot_noise_is_that_of_the_photons(found):
    """In a time tau the diode counts S tau/(hbar omega) photons; the PSD is twice the variance."""
    slope = np.diagonal(found["slope"])
    expected = np.sqrt(2 * QUANTUM * float(found["signal"].sel(channel="z"))) / np.abs(slope)
    np.testing.assert_allclose(found["shot_noise"], expected, rtol=1e-9)


def test_information_of_the_signals_is_at_most_that_of_all_scattered_light(found):
    recoil = tweezer.recoil(DETECTED, found["rest"].values)
    bound = 1.054571817e-34**2 / 4 / recoil.diagonal()
    share = bound / (found["shot_noise"].values ** 2 / 2)
    np.testing.assert_allclose(found["information"], share, rtol=1e-8)
    assert ((share > 0) & (share < 1)).all()


def test_linear_range_and_crosstalk_are_those_of_the_signals(found):
    rest, slope = found["rest"].values, np.diagonal(found["slope"])
    at_rest = found["signal"].values
    for i, end in enumerate(found["linear_range"].values):
        distances = np.array([-1.001, -0.999, 0.999, 1.001]) * end
        moved = tweezer.detect(DETECTED, rest + distances[:, None] * np.eye(3)[i])["signal"][:, i]
        off = np.abs((moved - at_rest[i]) / (slope[i] * distances) - 1)
        assert max(off[1], off[2]) < 0.05 < max(off[0], off[3])
    moved = tweezer.detect(DETECTED, rest + 1e-7 * np.eye(3))["signal"].values
    apparent = (moved - at_rest) / slope
    np.testing.assert_allclose(found["crosstalk"], apparent.T, rtol=0, atol=1e-15)


def test_detect_keeps_the_dimensions_of_positions():
    several = tweezer.detect(DETECTED, np.zeros((2, 3, 3)))
    assert several["slope"].dims == ("place_0", "place_1", "channel", "axis")
    again = tweezer.detect(DETECTED, several["position"][0])
    assert again["signal"].dims == ("place_1", "channel")
    np.testing.assert_allclose(again["signal"], several["signal"][0], rtol=0, atol=1e-14)
    assert tweezer.detect(DETECTED, np.zeros((0, 3)))["slope"].shape == (0, 3, 3)


@pytest.mark.parametrize(("changes", "message"), [
    ({"detector": {"numerical_aperture": 1.4}}, r"numerical_aperture = 1.4: must be at most"),
    ({"detector": {"kind": "quadrant"}}, r"detector.numerical_aperture"),
    ({"detector": {"numerical_aperture": 1, "efficiency": 2}}, r"detector.efficiency"),
    ({"beam": {"direction": "down"}}, "detector: requires a single beam along"),
    ({"beam": {"power_through_pupil": 0.0}}, "detector: requires light"),
])  # fmt: skip
def test_scenes_without_a_signal_are_refused(changes, message):
    with pytest.raises(SceneError, match=message):
        EVEN.replace(**{"detector": {"numerical_aperture": 0.9}, **changes})


def test_detector_of_rays_and_of_other_bodies_is_refused():
    detector = {"numerical_aperture": 0.9}
    with pytest.raises(SceneError, match="detector: requires wave optics"):
        tweezer.load_scene("thesis-990nm").replace(detector=detector)
    with pytest.raises(SceneError, match=r"detector: requires bead.shape = 'sphere'"):
        tweezer.load_scene("flipping-rod").replace(detector=detector)


def test_detect_without_detector_or_equilibrium_is_refused():
    weak = scene_of(0.5e-6, 1.57, numerical_aperture=0.3).replace(
        lens={"numerical_aperture": 0.3}, forces={"gravity": False, "buoyancy": False}
    )
    with pytest.raises(SceneError, match="detector: missing"):
        tweezer.detect(EVEN)
    with pytest.raises(SceneError, match="no stable equilibrium"):
        tweezer.detect(weak)


def test_detector_of_light_too_uneven_is_refused(monkeypatch):
    monkeypatch.setattr(detector, "_MOST_DEGREE", 3)
    with pytest.raises(SceneError, match=r"beam: .* too uneven for a detector"):
        tweezer.detect(DETECTED.replace(detector={"numerical_aperture": 0.8}))


def test_rest_off_the_axis_is_the_equilibrium_of_the_trap():
    """Light pushes a small bead of low index aside; on a ring, a bead is not at rest."""
    described = tweezer.load_scene("silica-1um").model_dump(exclude_none=True)
    described["bead"] |= {"radius": 0.15e-6, "refractive_index": 1.25}
    described["beam"]["polarisation"] = "linear"
    scene = tweezer.load_scene({**described, "detector": {"numerical_aperture": 0.9}})
    rest = detection(scene).rest
    expected = tweezer.characterise(scene).equilibrium.position
    assert math.hypot(*rest[:2]) > 0.5e-6
    np.testing.assert_allclose(np.abs(rest), np.abs(expected), atol=1e-11)  # or after half a turn
    ring = scene.replace(bead={"refractive_index": 1.45},
                         beam={"vortex": 1, "polarisation": "circular"})  # fmt: skip
    with pytest.raises(SceneError, match="no stable equilibrium"):
        tweezer.detect(ring)
