"""Light with aberrations, against plane waves and against shifts and turns of the light."""

import math

import numpy as np
import pytest

import tweezer
from tests.reference.plane_waves import Light, Sphere, lens, push
from tweezer import SceneError
from tweezer.optics import light_force

N_M, VACUUM, NA = 1.33, 1.064e-6, 1.2
ANGLE = math.asin(NA / N_M)


def _even():
    """Return 1 W through an evenly lit pupil, on 1 um of silica."""
    described = tweezer.load_scene("silica-1um").model_dump(exclude_none=True)
    described["medium"] = {**described["medium"], "refractive_index": N_M}
    described["lens"] = {"map": "sine", "numerical_aperture": NA, "radius": 2.5e-3}
    described["beam"] = {
        "wavelength": VACUUM, "profile": "uniform", "power_through_pupil": 1.0,
        "polarisation": "linear",
    }  # fmt: skip
    described["optics"] = {"tolerance": 1e-11}
    return tweezer.load_scene(described)


EVEN = _even()
PLACES = np.array([[0.2, -0.15, 0.25], [0.3, 0.35, -0.2], [0.75, -0.6, 0.5], [0, 0, 0.4]]) * 1e-6
ONE = math.sqrt(0.5)


def polynomial(n, m, rho, phi):
    """Zernike term by the sum over powers of rho, with factorials."""
    radial = sum(
        (-1) ** k * math.factorial(n - k) * rho ** (n - 2 * k)
        / (math.factorial(k) * math.factorial((n + abs(m)) // 2 - k)
           * math.factorial((n - abs(m)) // 2 - k))
        for k in range((n - abs(m)) // 2 + 1)
    )  # fmt: skip
    norm = math.sqrt((n + 1) * (2 if m else 1))
    return norm * radial * (np.cos(m * phi) if m >= 0 else np.sin(-m * phi))


def reference(terms, polarisation=(1, 0), vortex=0, cover=None, kind="sine"):
    """Return the plane waves of an evenly lit pupil with these Zernike terms."""
    index = N_M if cover is None else cover[0]
    angle = math.asin(NA / index)

    def factor(theta, phi):
        of = np.sin if kind == "sine" else np.tan
        rho = of(theta) / of(angle)
        waves = sum(c * polynomial(n, m, rho, phi) for n, m, c in terms)
        return np.exp(2j * math.pi * waves)

    W = lens(angle, kind=kind)
    uneven = int(30 + 80 * sum(abs(c) * n for n, _, c in terms))
    return Light(N_M, VACUUM, angle, W, polarisation, vortex, cover, factor, uneven)


def cylindrical(order, phase=0.0):
    """Return the light and the keys of cylindrical polarisation."""
    light = {"polarisation": lambda phi: (np.cos(order * phi + phase), np.sin(order * phi + phase))}
    keys = {"polarisation": "cylindrical", "order": order, "order_phase": phase}
    return light, keys


CASES = {
    "tilt": ([(1, 1, 0.3), (1, -1, -0.2)], {}, {}),
    "defocus": ([(2, 0, 0.25)], {}, {}),
    "astigmatism": ([(2, 2, 0.1), (2, -2, 0.05)], {}, {}),
    "coma, circular": ([(3, 1, 0.15)], {"polarisation": (ONE, ONE * 1j)},
                       {"polarisation": "circular"}),
    "coma, other handedness": ([(3, 1, 0.1), (3, -1, 0.05)],
                               {"polarisation": (ONE, -ONE * 1j)}, {"jones": [1, "-1j"]}),
    "trefoil, elliptical": ([(3, 3, 0.1), (3, -3, 0.1)], {"polarisation": (0.6, 0.48 + 0.64j)},
                            {"jones": [0.6, "0.48+0.64j"]}),
    "spherical": ([(4, 0, 0.2)], {}, {}),
    "unpolarised": ([(2, 2, 0.1), (3, -1, 0.1)], {"polarisation": "unpolarised"},
                    {"polarisation": "unpolarised"}),
    "strong astigmatism": ([(2, 2, 1.0)], {}, {}),
    "vortex": ([(2, -2, 0.1)], {"vortex": 1}, {"vortex": 1}),
    "behind a cover": ([(2, 2, 0.1), (3, 1, 0.05)], {"cover": (1.518, 5e-6)}, {}),
    "tan map": ([(2, 2, 0.1), (3, -1, 0.1)], {"kind": "tan"}, {}),
    "radial": ([(3, 1, 0.1)], {"polarisation": "radial"}, {"polarisation": "radial"}),
    "cylindrical 2": ([(4, 0, 0.05)], *cylindrical(2)),
    "cylindrical 0": ([(4, 0, 0.05)], *cylindrical(0, 0.4)),
    "cylindrical -3, coma": ([(3, 1, 0.1)], *cylindrical(-3, 0.7)),
}  # fmt: skip


def scene_with(terms, changes):
    beam = {"aberration": [list(term) for term in terms], **changes}
    described = EVEN.model_dump(exclude_none=True)
    described["beam"] = {**described["beam"], **beam}
    if described["beam"]["polarisation"] != "linear":
        del described["beam"]["jones"]
    return tweezer.load_scene(described)


def in_lens(scene, cover=None, kind="sine"):
    """Return a scene with a cover glass or with the tan map."""
    described = scene.model_dump(exclude_none=True)
    if cover is not None:
        described["lens"]["cover"] = {"refractive_index": cover[0], "depth": cover[1]}
    if kind == "tan":
        del described["lens"]["numerical_aperture"]
        described["lens"] |= {"map": "tan", "focal_length": 2.5e-3 / math.tan(ANGLE)}
    return tweezer.load_scene(described)


@pytest.mark.parametrize(("terms", "light", "changes"), CASES.values(), ids=CASES.keys())
def test_force_is_that_of_plane_waves(terms, light, changes):
    """Within 1e-9 of the largest component; the stated error is not below the true one."""
    how = {key: light[key] for key in ("cover", "kind") if key in light}
    scene = in_lens(scene_with(terms, changes), **how)
    expected = push(reference(terms, **light), Sphere(((0.5e-6, 1.45),)), PLACES).force
    found = tweezer.optical_force(scene, PLACES)
    largest = np.abs(expected).max()
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9 * largest)
    stated = tweezer.optical_force_error(scene, PLACES)
    assert (np.linalg.norm(found - expected, axis=1) <= stated + 1e-11 * largest).all()


def test_tilt_moves_the_focus():
    """With the sine map, a tilt of c waves is a shift by -2 c wavelengths over the aperture."""
    tilted = scene_with([(1, 1, 0.2), (1, -1, 0.1)], {})
    shift = np.array([-2 * 0.2, -2 * 0.1, 0]) * VACUUM / NA
    expected = tweezer.optical_force(EVEN, PLACES)
    found = tweezer.optical_force(tilted, PLACES + shift)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-11 * np.abs(expected).max())
    held, there = (tweezer.characterise(each).equilibrium for each in (EVEN, tilted))
    assert there.position == pytest.approx(np.array(held.position) + shift, abs=1e-13)


def test_light_turned_about_the_axis_turns_the_force():
    angle = 0.7
    turned = np.array([
        [math.cos(angle), -math.sin(angle), 0], [math.sin(angle), math.cos(angle), 0], [0, 0, 1],
    ])  # fmt: skip
    terms, polarisation = [(2, 2, 0.1), (3, 1, 0.1)], {"jones": [1, 0]}
    new = [
        each
        for n, m, c in terms
        for each in ((n, m, c * math.cos(m * angle)), (n, -m, c * math.sin(m * angle)))
    ]
    other = {"jones": [math.cos(angle), math.sin(angle)]}
    here = tweezer.optical_force(scene_with(terms, polarisation), PLACES)
    there = tweezer.optical_force(scene_with(new, other), PLACES @ turned.T)
    np.testing.assert_allclose(there, here @ turned.T, rtol=0, atol=1e-11 * np.abs(here).max())


def test_gradient_is_the_slope_of_the_force():
    scene, step = scene_with([(3, 1, 0.1), (2, -2, 0.1)], {}), 1e-9
    found = light_force(scene).field(PLACES[:1], gradient=True).force_gradient[0]
    for axis in range(3):
        moved = [PLACES[0] + sign * step * np.eye(3)[axis] for sign in (1, -1)]
        slope = np.subtract(*tweezer.optical_force(scene, moved)) / (2 * step)
        np.testing.assert_allclose(found[:, axis], slope, atol=1e-4 * np.abs(found).max())


def test_body_that_is_a_sphere_feels_the_same_light():
    aberrated = {"beam": {"aberration": [[3, 1, 0.1], [2, -2, 0.05]]}}
    sphere = tweezer.load_scene("polystyrene-500nm").replace(**aberrated)
    body = sphere.replace(bead={"shape": "spheroid", "length": "0.5 um"})
    expected = tweezer.optical_force(sphere, PLACES)
    found = tweezer.optical_force(body, PLACES, [1, 0, 0, 0])
    np.testing.assert_allclose(found, expected, atol=1e-7 * np.abs(expected).max())


@pytest.mark.parametrize(
    ("order", "index", "indices"),
    [
        ("osa", 4, (2, 0)), ("osa", 7, (3, -1)), ("osa", 12, (4, 0)), ("osa", 5, (2, 2)),
        ("noll", 4, (2, 0)), ("noll", 7, (3, -1)), ("noll", 11, (4, 0)), ("noll", 6, (2, 2)),
        ("noll", 5, (2, -2)), ("noll", 9, (3, -3)),
    ],
)  # fmt: skip
def test_indices_are_those_of_their_convention(order, index, indices):
    """R. J. Noll, J. Opt. Soc. Am. 66, 207 (1976), table I; ANSI Z80.28."""
    beam = EVEN.replace(beam={"aberration": [[index, 0.1]], "aberration_order": order}).beam
    assert beam.wavefront == ((*indices, 0.1),)


@pytest.mark.parametrize(
    ("beam", "said"),
    [
        ({"aberration": [[2, 1, 0.1]]}, "n - m even"),
        ({"aberration": [[2, 4, 0.1]]}, r"\|m\| must be at most n"),
        ({"aberration": [[2.5, 0, 0.1]]}, "whole numbers"),
        ({"aberration": [[42, 0, 0.1]]}, "n must be at most 40"),
        ({"aberration": [[2, 2, 6]]}, "at most 5"),
        ({"aberration": [[2, 2, float("nan")]]}, "aberration"),
        ({"aberration": [[4, 0.1]]}, "aberration_order: missing"),
        ({"aberration": [[4, 0, 0.1]], "aberration_order": "noll"}, "applies to terms"),
        ({"aberration": [[0, 0.1]], "aberration_order": "noll"}, "at least 1"),
        ({"aberration": [[2, 2, 0.1], [4, 0.1]], "aberration_order": "osa"}, "applies to terms"),
        ({"aberration": []}, "1 to 500"),
        ({"aberration": "astigmatism"}, "aberration"),
        ({"aberration_order": "osa"}, "applies to terms"),
        ({"order": 2}, "order: does not apply to polarisation"),
        ({"order_phase": 0.5}, "order_phase: requires polarisation = 'cylindrical'"),
    ],
)
def test_wrong_aberrations_are_refused_in_one_line(beam, said):
    with pytest.raises(SceneError, match=said) as refusal:
        EVEN.replace(beam=beam)
    assert "\n" not in str(refusal.value)


def test_rays_refuse_aberrations():
    with pytest.raises(SceneError, match=r"beam\.aberration requires wave optics"):
        EVEN.replace(beam={"aberration": [[4, 0, 0.1]]}, optics={"theory": "rays"})


def test_map_of_spherical_aberration_is_the_force():
    scene = tweezer.load_scene("silica-1um").replace(
        beam={"aberration": [[4, 0, 0.1]]}, optics={"tolerance": 1e-10}
    )
    mapped = scene.replace(optics={"evaluator": "map"})
    expected = tweezer.optical_force(scene, PLACES)
    found = tweezer.optical_force(mapped, PLACES)
    np.testing.assert_allclose(found, expected, atol=1e-6 * np.abs(expected).max())


def test_torque_and_absorbed_power_of_an_absorbing_bead():
    terms, dyed = [(3, 1, 0.1), (2, 2, 0.1)], (1.59, 0.01)
    scene = scene_with(terms, {"polarisation": "circular"}).replace(
        bead={"refractive_index": "1.59+0.01j"}
    )
    light = reference(terms, polarisation=(ONE, ONE * 1j))
    expected = push(light, Sphere(((0.5e-6, complex(*dyed)),)), PLACES)
    for found, wanted in (
        (tweezer.optical_force(scene, PLACES), expected.force),
        (tweezer.optical_torque(scene, PLACES), expected.torque),
        (tweezer.absorbed_power(scene, PLACES), expected.absorbed),
    ):
        np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-9 * np.abs(wanted).max())


# --- beams that are not round ---------------------------------------------------------------------

R = 2.5e-3
SHAPES = {
    "elliptical": {"sigma": [0.8e-3, 1.6e-3]},
    "elliptical, turned": {"sigma": [0.8e-3, 1.6e-3], "angle": 0.5},
    "off-centre": {"sigma": 1.2e-3, "offset": [0.6e-3, -0.3e-3]},
    "Hermite-Gaussian 1, 0": {"sigma": 0.8e-3, "hermite": [1, 0]},
    "Hermite-Gaussian 1, 2, turned": {"sigma": [0.7e-3, 0.8e-3], "hermite": [1, 2], "angle": 0.3},
}


def shaped(beam, **changes):
    described = EVEN.model_dump(exclude_none=True)
    described["beam"] |= {"profile": "gaussian", **beam, **changes}
    return tweezer.load_scene(described)


def hermite(n, u):
    return {0: 1 + 0 * u, 1: 2 * u, 2: 4 * u**2 - 2}[n]


def amplitude(beam, x, y):
    a, b = np.broadcast_to(beam["sigma"], 2)
    x0, y0 = beam.get("offset", (0, 0))
    turn = np.exp(-1j * beam.get("angle", 0.0)) * ((x - x0) + 1j * (y - y0))
    u, v = turn.real / (math.sqrt(2) * a), turn.imag / (math.sqrt(2) * b)
    p, q = beam.get("hermite", (0, 0))
    return hermite(p, u) * hermite(q, v) * np.exp(-(u**2 + v**2) / 2)


def power_within(beam, radius):
    """Return the integral of the squared amplitude over a disc, by a square grid of midpoints."""
    n = 3000
    x = radius * (2 * np.arange(n) + 1 - n) / n
    inside = np.hypot(x[:, None], x) < radius
    return (amplitude(beam, x[:, None], x) ** 2 * inside).sum() * (2 * radius / n) ** 2


@pytest.mark.parametrize("beam", SHAPES.values(), ids=SHAPES.keys())
def test_force_of_a_beam_that_is_not_round_is_that_of_plane_waves(beam):
    def factor(theta, phi):
        rho = R * np.sin(theta) / math.sin(ANGLE)
        return amplitude(beam, rho * np.cos(phi), rho * np.sin(phi))

    light = Light(N_M, VACUUM, ANGLE, lens(ANGLE), (1, 0), 0, None, factor, 90)
    expected = push(light, Sphere(((0.5e-6, 1.45),)), PLACES).force
    found = tweezer.optical_force(shaped(beam), PLACES)
    scale = (found * expected).sum() / (expected**2).sum()
    np.testing.assert_allclose(found, scale * expected, rtol=0, atol=1e-9 * np.abs(found).max())
    # 1 W through the pupil: the mean of the squared amplitude over the pupil is divided out
    mean = power_within(beam, R) / (math.pi * R**2)
    assert scale == pytest.approx(1 / mean, rel=1e-4)


@pytest.mark.parametrize("beam", SHAPES.values(), ids=SHAPES.keys())
def test_power_before_the_pupil_is_the_power_of_the_whole_beam(beam):
    whole = shaped(beam, power=1.0, power_through_pupil=None)
    share = power_within(beam, R) / power_within(beam, 6 * R)
    found = tweezer.optical_force(whole, PLACES) / tweezer.optical_force(shaped(beam), PLACES)
    np.testing.assert_allclose(found, share, rtol=1e-3)


def test_round_beam_given_as_an_ellipse_is_the_round_beam():
    here = tweezer.optical_force(shaped({"sigma": 1.1e-3}), PLACES)
    there = tweezer.optical_force(shaped({"sigma": [1.1e-3, 1.1e-3], "angle": 1.0}), PLACES)
    np.testing.assert_allclose(there, here, rtol=0, atol=1e-11 * np.abs(here).max())


@pytest.mark.parametrize(
    ("beam", "said"),
    [
        ({"sigma": [1e-3, 2e-3], "profile": "donut"}, "sigma_y: requires profile = 'gaussian'"),
        ({"sigma": 1e-3, "vortex": 1, "hermite": [1, 0]}, "cannot be combined with a vortex"),
        ({"sigma": 1e-3, "angle": 0.3}, "angle: requires sigma_y or hermite"),
        ({"sigma": 1e-3, "hermite": [1.5, 0]}, "hermite"),
        ({"sigma": 1e-3, "hermite": [21, 0]}, "hermite"),
        ({"sigma": [1e-3, 1e-3, 1e-3]}, "sigma"),
        ({"sigma": 1e-3, "offset": [1e-3]}, "offset"),
        ({"sigma": [1e-3, 0]}, "sigma_y"),
    ],
)
def test_wrong_shapes_are_refused_in_one_line(beam, said):
    with pytest.raises(SceneError, match=said) as refusal:
        shaped(beam)
    assert "\n" not in str(refusal.value)


def test_beam_too_narrow_to_be_resolved_is_refused():
    scene = shaped({"sigma": [1e-3, 1e-6]})
    with pytest.raises(SceneError, match=r"beam\.sigma_y = 1e-06: a beam that is not round"):
        tweezer.optical_force(scene, PLACES)


def test_beam_beside_the_pupil_is_refused():
    scene = shaped({"sigma": 0.1e-3, "offset": [2.5e-3 + 1e-3, 0]})
    with pytest.raises(SceneError, match="almost no light within"):
        tweezer.optical_force(scene, PLACES)


def test_well_near_the_nominal_focus_of_defocused_light_is_found_for_a_body():
    """Defocus of 0.5 waves has a well near the nominal focus and one 3 um further."""
    sphere = tweezer.load_scene("polystyrene-500nm").replace(beam={"aberration": [[2, 0, 0.5]]})
    body = sphere.replace(bead={"shape": "spheroid", "length": "0.5 um"})
    z = [each.position[2] for each in tweezer.characterise(sphere).equilibria if each.stable]
    found = [each.position[2] for each in tweezer.characterise(body).equilibria if each.stable]
    nearest = min(z, key=abs)
    assert nearest < 1e-6
    assert min(found, key=abs) == pytest.approx(nearest, rel=1e-6)


def test_bead_is_held_in_a_lobe_of_a_hermite_gaussian_beam():
    """Both lobes hold it, at mirrored positions, where the force vanishes."""
    scene = shaped({"sigma": 0.8e-3, "hermite": [1, 0]}).replace(bead={"diameter": "0.3 um"})
    found = tweezer.characterise(scene).equilibria
    x = sorted(each.position[0] for each in found if each.stable and abs(each.position[2]) < 1e-6)
    assert len(x) == 2
    assert x[0] == pytest.approx(-x[1], rel=1e-6)
    assert x[1] > 0.15e-6


# --- holograms ------------------------------------------------------------------------------------

FOCI = [
    {"position": [0.8e-6, 0.3e-6, 0.5e-6]},
    {"position": [-1.0e-6, 0, 0], "amplitude": 0.7, "phase": 1.0},
    {"position": [0, -1.5e-6, -0.4e-6], "amplitude": 1.2},
]


def of_hologram(foci, **beam):
    described = EVEN.model_dump(exclude_none=True)
    described["beam"] |= {"focus": foci, **beam}
    return tweezer.load_scene(described)


def test_hologram_of_one_focus_is_the_shifted_focus():
    there = of_hologram([{"position": [0.4e-6, -0.2e-6, 0.6e-6], "amplitude": 3.0, "phase": 0.5}])
    expected = tweezer.optical_force(EVEN, PLACES)
    found = tweezer.optical_force(there, PLACES + np.array([0.4e-6, -0.2e-6, 0.6e-6]))
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-10 * np.abs(expected).max())


@pytest.mark.parametrize("polarisation", ["x", "circular"])
def test_force_of_a_hologram_is_that_of_plane_waves(polarisation):
    """The fields of three foci add; the power is that of the sum."""
    k = 2 * math.pi * N_M / VACUUM

    def factor(theta, phi):
        s = np.array([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi),
                      np.cos(theta) + 0 * phi])  # fmt: skip
        return sum(
            spot.get("amplitude", 1.0) * np.exp(1j * spot.get("phase", 0.0))
            * np.exp(-1j * k * np.einsum("i,i...->...", spot["position"], s))
            for spot in FOCI
        )  # fmt: skip

    jones, keys = ((1, 0), {}) if polarisation == "x" else (
        (ONE, ONE * 1j), {"jones": [1, "1j"]})  # fmt: skip
    light = Light(N_M, VACUUM, ANGLE, lens(ANGLE), jones, 0, None, factor, 90)
    places = PLACES + np.array([0.3e-6, 0, 0])
    expected = push(light, Sphere(((0.5e-6, 1.45),)), places).force
    found = tweezer.optical_force(of_hologram(FOCI, **keys), places)
    rho, phi = (np.arange(2000) + 0.5) / 2000, 2 * np.pi * np.arange(400) / 400
    power = np.abs(factor(np.arcsin(rho * NA / N_M)[:, None], phi)) ** 2
    expected = expected / ((power.mean(axis=1) * rho).sum() / rho.sum())
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-6 * np.abs(found).max())
    scale = (found * expected).sum() / (expected**2).sum()
    np.testing.assert_allclose(found, scale * expected, rtol=0, atol=1e-9 * np.abs(found).max())


def test_every_focus_of_a_hologram_holds_a_bead():
    foci = [{"position": [x, 0, 0]} for x in (-3e-6, 0, 3e-6)]
    scene = of_hologram(foci)
    held = [each for each in tweezer.characterise(scene).equilibria if each.stable]
    x = sorted(each.position[0] for each in held if abs(each.position[2]) < 1e-6)
    assert x == pytest.approx([-3e-6, 0, 3e-6], abs=5e-8)


@pytest.mark.parametrize(
    ("foci", "said"),
    [
        ([], "focus"), ([{"position": [0, 0]}], "focus"), ([{"amplitude": 1}], "position"),
        ([{"position": [0, 0, 3e-5]}], "position"),
        ([{"position": [0, 0, 0], "amplitude": 0}], "amplitude"),
        ([{"position": [0, 0, 0], "power": 1}], "power"),
    ],
)  # fmt: skip
def test_wrong_holograms_are_refused_in_one_line_for_each_key(foci, said):
    with pytest.raises(SceneError, match=said):
        of_hologram(foci)
