"""Open sectors of the pupil, against plane waves and identities of light."""

import math

import numpy as np
import pytest

import tweezer
from tests.optics.waves.test_pupil import (
    ANGLE,
    EVEN,
    N_M,
    ONE,
    PLACES,
    VACUUM,
    in_lens,
    polynomial,
)
from tests.reference.plane_waves import Light, Sphere, lens, push
from tweezer import SceneError
from tweezer.optics.sectors import Sectors

RADIUS = 2.5e-3
SILICA = Sphere(((0.5e-6, 1.45),))
TWO = ((-0.4, 1.1), (2.0, 3.9))
#: Highest harmonic of the plane waves, above all that reach the bead at `PLACES`
HIGHEST = 36


def sectors(*edges, scene=EVEN, **keys):
    """Return a scene with open sectors."""
    described = scene.model_dump(exclude_none=True)
    described["beam"] |= {"sectors": [list(each) for each in edges], **keys}
    described["optics"]["tolerance"] = 1e-9
    described["simulation"]["loss_distance"] = 2e-6
    if described["beam"]["polarisation"] != "linear":
        described["beam"].pop("jones", None)
    return tweezer.load_scene(described)


def open_part(edges):
    return sum(end - begin for begin, end in edges) / (2 * math.pi)


def factor(edges):
    """Return the Fourier series of the open part, as a function of the azimuth."""
    q = np.arange(-HIGHEST, HIGHEST + 1)
    q[HIGHEST] = 1  # replaced by the mean
    t = sum(np.exp(-1j * q * begin) - np.exp(-1j * q * end) for begin, end in edges)
    t /= 2j * math.pi * q
    t[HIGHEST], q[HIGHEST] = open_part(edges), 0
    return lambda phi: t @ np.exp(1j * np.outer(q, phi))


def coma(theta, phi):
    return np.exp(0.2j * math.pi * polynomial(3, 1, np.sin(theta) / math.sin(ANGLE), phi))


CASES = {
    "two": (TWO, {}, {}, {}),
    "coma, unpolarised": (TWO, {"of": coma, "polarisation": "unpolarised"},
                          {"aberration": [[3, 1, 0.1]], "polarisation": "unpolarised"}, {}),
    "narrow, circular, behind a cover": (
        ((1.0, 1.1), (2.0, 2.05)), {"cover": (1.518, 5e-6), "polarisation": (ONE, 1j * ONE)},
        {"polarisation": "circular"}, {"cover": (1.518, 5e-6)},
    ),
    "tan map": (TWO, {"kind": "tan"}, {}, {"kind": "tan"}),
}  # fmt: skip


def waves(edges, of=None, kind="sine", cover=None, polarisation=(1, 0)):
    """Return 1 W through the sectors of an evenly lit pupil."""
    angle = math.asin(1.2 / (N_M if cover is None else cover[0]))
    whole, around = lens(angle, kind=kind), factor(edges)

    def T(theta, phi):
        return (1 if of is None else of(theta, phi)) * (around(phi) + 0 * theta)

    return Light(
        N_M, VACUUM, angle, lambda theta: whole(theta) / open_part(edges), polarisation, 0, cover,
        T, HIGHEST + (20 if of else 0),
    )  # fmt: skip


@pytest.mark.parametrize(("edges", "light", "keys", "lens"), CASES.values(), ids=CASES.keys())
def test_force_of_sectors_is_that_of_plane_waves(edges, light, keys, lens):
    """Within 1e-9 of the largest component; the stated error is not below the true one."""
    scene = in_lens(sectors(*edges, **keys), **lens)
    expected = push(waves(edges, **light), SILICA, PLACES[:2]).force
    found = tweezer.optical_force(scene, PLACES[:2])
    largest = np.abs(expected).max()
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9 * largest)
    stated = tweezer.optical_force_error(scene, PLACES[:2])
    assert (np.linalg.norm(found - expected, axis=1) <= stated + 1e-11 * largest).all()


def test_sectors_over_the_whole_pupil_are_the_whole_pupil():
    expected = tweezer.optical_force(EVEN, PLACES)
    for edges in (((0.5, 0.5 + 2 * math.pi),), ((-1, 1), (1, 3), (3, 2 * math.pi - 1))):
        found = tweezer.optical_force(sectors(*edges), PLACES)
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12 * np.abs(expected).max())


def test_two_coherent_halves_are_the_whole_pupil():
    """Their fields add: forces alone would differ, because the halves interfere."""
    described = sectors((0.2, 0.2 + math.pi)).model_dump(exclude_none=True)
    described.pop("more_beams", None)
    half = {**described["beam"], "coherent": "a", "power_through_pupil": 0.5}
    other = {**half, "sectors": [[0.2 - math.pi, 0.2]]}
    described["beam"] = [half, other]
    found = tweezer.optical_force(tweezer.load_scene(described), PLACES[:2])
    expected = tweezer.optical_force(EVEN, PLACES[:2])
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9 * np.abs(expected).max())


def test_turned_sectors_turn_the_force():
    turn = 0.7
    c, s = math.cos(turn), math.sin(turn)
    turned = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    expected = tweezer.optical_force(sectors(*TWO), PLACES[:2]) @ turned.T
    edges = [(begin + turn, end + turn) for begin, end in TWO]
    scene = sectors(*edges, polarisation="linear", jones=[c, s])
    found = tweezer.optical_force(scene, PLACES[:2] @ turned.T)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9 * np.abs(expected).max())


def test_sectors_and_their_complement_pass_all_the_light():
    """The terms of both add to those of the whole pupil, of which only c_00 = 1 is not zero."""
    edges = ((-0.4, 1.1), (2.0, 3.9))
    others = ((1.1, 2.0), (3.9, 2 * math.pi - 0.4))
    found = Sectors(edges).terms(31) + Sectors(others).terms(31)
    expected = np.zeros((32, 63))
    expected[0, 31] = 1
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-13)


def test_power_before_sectors_is_that_of_the_whole_beam():
    keys = {"power": 1.0, "power_through_pupil": None}
    for more, share in (
        ({}, open_part(TWO)),
        ({"profile": "gaussian", "sigma": 2 * RADIUS}, open_part(TWO) * -math.expm1(-0.125)),
    ):
        scene = sectors(*TWO, **keys, **more)
        found = tweezer.optics.fraction_through_pupil(scene.lens, scene.beam)
        assert found == pytest.approx(share, rel=1e-9)
    through = sectors(*TWO, power_through_pupil=open_part(TWO))
    expected = tweezer.optical_force(through, PLACES[:1])
    found = tweezer.optical_force(sectors(*TWO, **keys), PLACES[:1])
    np.testing.assert_allclose(found, expected, rtol=1e-12)


def test_half_of_a_beam_beside_the_axis_passes_its_part():
    """Along x the power of a Gaussian at x0 has the distribution function of erf."""
    x0, sigma = 0.3e-3, 0.4e-3
    keys = {"profile": "gaussian", "sigma": sigma, "offset": [x0, 0.0], "power": 1.0}
    scene = sectors((-math.pi / 2, math.pi / 2), **keys, power_through_pupil=None)
    found = tweezer.optics.fraction_through_pupil(scene.lens, scene.beam)
    passed = (1 + math.erf(x0 / sigma / math.sqrt(2))) / 2
    assert found == pytest.approx(passed, rel=1e-6)  # 4e-8 of the light misses the pupil


def test_azimuths_may_be_given_in_degrees():
    scene = sectors(("-90 deg", "90 deg"), scene=tweezer.load_scene("silica-1um"))
    assert scene.beam.sectors == ((-math.pi / 2, math.pi / 2),)
    assert tweezer.load_scene(scene.model_dump(exclude_none=True)).beam == scene.beam


BAD_KEYS = {
    "sectors.0 = .*larger than the first": {"sectors": [[1, 1]]},
    "sectors.0 = .*by at most 2 pi": {"sectors": [[0, 6.3]]},
    "sectors.1 = .*larger than the first": {"sectors": [[0, 1], [3, 2]]},
    "from 0 rad and from 0.5 rad overlap": {"sectors": [[0, 1], [0.5, 2]]},
    "overlap": {"sectors": [[0, 1], [5, 6.5]]},
    "must have 1 to 100 entries": {"sectors": []},
    "must have 2 entries": {"sectors": [[1, 2, 3]]},
    "beam.sectors": {"sectors": [[0, 30]]},
    "vortex = 1: cannot be combined with sectors": {"vortex": 1},
    "'radial': cannot be combined with sectors": {"polarisation": "radial"},
    "mask: cannot be combined with sectors": {"mask": "a.npy"},
    "sectors: cannot be combined with annulus": {"annulus": [0.0, 1e-3]},
    "sectors: cannot be combined with focus": {"focus": [{"position": [0, 0, 0]}]},
    "sectors: cannot be combined with axicon": {"axicon": 1.0},
}


@pytest.mark.parametrize(("said", "keys"), BAD_KEYS.items(), ids=range(len(BAD_KEYS)))
def test_wrong_sectors_are_refused_in_one_line(said, keys):
    with pytest.raises(SceneError, match=said) as refusal:
        sectors(*keys.pop("sectors", [(0, 1)]), **keys)
    assert "\n" not in str(refusal.value)


def test_light_beyond_the_computed_orders_is_refused_by_its_key():
    scene = sectors((0, 1)).replace(simulation={"loss_distance": 80e-6})
    with pytest.raises(SceneError, match=r"beam\.sectors: more than 480 orders"):
        tweezer.optical_force(scene, PLACES[:1])


def test_rays_refuse_sectors():
    with pytest.raises(SceneError, match=r"beam\.sectors requires wave optics"):
        sectors((0, 1)).replace(optics={"theory": "rays"})
