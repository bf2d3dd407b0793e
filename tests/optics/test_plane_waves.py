"""The exact force plane wave by plane wave, which other tests rely on, against what is known."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

import tweezer
from tests.reference import waves
from tests.reference.plane_waves import SPEED_OF_LIGHT, Light, Sphere, dyad, lens, push
from tests.reference.waves_table import ERROR, exact, rows
from tweezer.optics import beam

N_M = 1.33
VACUUM = 1.064e-6
WAVELENGTH = VACUUM / N_M
OMEGA = 2 * math.pi * SPEED_OF_LIGHT / VACUUM
NA_12 = math.asin(1.2 / N_M)
NA_10 = math.asin(1.0 / N_M)
HELICITY = {+1: (math.sqrt(0.5), math.sqrt(0.5) * 1j), -1: (math.sqrt(0.5), -math.sqrt(0.5) * 1j)}
ELLIPTIC = (0.6, 0.8j * np.exp(0.4j))


def light(polarisation, *, angle=NA_12, waist=1.0, vortex=0, cover=None):
    W = lens(angle, waist, abs(vortex))
    return Light(N_M, VACUUM, angle, W, polarisation, vortex, cover)


def bead(diameter, index):
    return Sphere(((diameter / 2, index),))


# --- the lens ---------------------------------------------------------------------------------


@pytest.mark.parametrize("profile", ["gaussian", "donut"])
@pytest.mark.parametrize("name", ["silica-1um", "thesis-990nm"])
def test_the_light_behind_a_lens_is_that_of_the_rays(name, profile):
    scene = tweezer.load_scene(name)
    waist = 2 * scene.beam.sigma / scene.lens.radius
    cone = beam.cone(scene.replace(beam={"profile": profile}))
    ring = {"gaussian": 0, "donut": 1}[profile]
    W = lens(cone.half_angle, waist, ring, scene.lens.map)
    theta = np.linspace(0, cone.half_angle, 7)
    expected = cone.radiance(np.cos(theta)) / cone.power
    assert W(theta) == pytest.approx(expected, rel=1e-9, abs=1e-10 * expected.max())


# --- the force --------------------------------------------------------------------------------


@pytest.mark.parametrize(("diameter", "waist"), [(0.3e-6, 0.7), (1e-6, 10.0), (2e-6, 1.0)])
def test_the_force_is_that_of_the_multipoles(diameter, waist):
    here, there = light(HELICITY[1], waist=waist), light(HELICITY[-1], waist=waist)
    sphere = bead(diameter, 1.59)
    places = np.array([[0.3, 0, 0.2], [0.5, 0, -0.6], [1.4, 0, 0.3], [0, 0, 1.0]]) * diameter
    expected = waves.force(
        waves.Light(1.2 / N_M, waist),
        waves.Sphere(diameter / 2 / WAVELENGTH, 1.59 / N_M),
        places[:, 0] / WAVELENGTH,
        places[:, 2] / WAVELENGTH,
    )
    expected *= N_M / SPEED_OF_LIGHT
    largest = abs(expected).max()
    assert push(here, sphere, places).force == pytest.approx(expected, abs=1e-12 * largest)
    mirrored = expected * [1, -1, 1]
    assert push(there, sphere, places).force == pytest.approx(mirrored, abs=1e-12 * largest)
    # a place off the x axis: the force turns with it
    turn = np.array([[0.28, -0.96, 0], [0.96, 0.28, 0], [0, 0, 1]])
    turned = push(here, sphere, places[:2] @ turn.T).force
    assert turned == pytest.approx(expected[:2] @ turn.T, abs=1e-12 * largest)


@pytest.mark.parametrize(
    ("diameter", "waist", "state", "stiffness", "rest"),
    [
        (0.99, 1, "circular", (3.795, 3.795, 0.920), 0.192),
        (2.0, 1, "circular", (1.229, 1.229, 0.372), 0.136),
        (0.5, 10, "x", (2.406, 3.460, 0.541), 0.2354),
        (2.0, 10, "x", (1.015, 0.850, 0.549), 0.0686),
    ],
)
def test_a_third_program_finds_the_same_stiffness_and_rest(diameter, waist, state, stiffness, rest):
    # fatcuda 0.6.5 (MIT): PS in water, NA 1.2; pN/um per mW, um
    shone = light({"circular": HELICITY[1], "x": (1, 0)}[state], waist=waist)
    sphere = bead(diameter * 1e-6, 1.59)

    def forces(*places):
        return push(shone, sphere, np.array(places) * 1e-6).force

    z = brentq(lambda z: forces((0, 0, z))[0, 2], rest - 0.03, rest + 0.03, xtol=1e-6)
    h = 1e-3
    ends = forces((h, 0, z), (-h, 0, z), (0, h, z), (0, -h, z), (0, 0, z + h), (0, 0, z - h))
    found = [-(ends[2 * i, i] - ends[2 * i + 1, i]) / (2 * h) * 1e9 for i in range(3)]
    assert found == pytest.approx(stiffness, abs=1.5e-3)
    assert z == pytest.approx(rest, abs=6e-4)


# --- dipoles ----------------------------------------------------------------------------------


def field(shone, place):
    """E, and d_i E_j, in the Debye field; |E|^2 in W/m^2."""
    k, turns = shone.k, 96
    x, weight = np.polynomial.legendre.leggauss(60)
    theta, weight = shone.angle * (x[:, None] + 1) / 2, weight[:, None] * shone.angle / 2
    sin, cos = np.sin(theta)[..., None], np.cos(theta)[..., None]
    phi = 2 * math.pi * np.arange(turns) / turns
    z = np.array([0, 0, 1])
    rho = np.stack([np.cos(phi), np.sin(phi), 0 * phi], axis=-1)
    in_pupil = {"radial": rho, "azimuthal": np.cross(z, rho)}
    e = in_pupil.get(shone.polarisation)
    if e is None:
        e = np.array([*shone.polarisation, 0])
    along = (e * rho).sum(-1, keepdims=True)
    # the lens turns the part along rho towards -z, and rays towards the axis
    bent, s = rho * cos - sin * z, rho * sin + cos * z
    amplitude = np.sqrt(shone.W(theta)) * weight * np.sin(theta) * (2 * math.pi / turns)
    amplitude = amplitude * np.exp(1j * shone.vortex * phi + 1j * k * s @ place)
    A = 1j * k / (2 * math.pi) * amplitude[..., None] * (e - along * rho + along * bent)
    return A.sum((0, 1)), 1j * k * np.einsum("tfi,tfj->ij", s, A)


def on_a_dipole(shone, place, alpha, static):
    """Force, torque and absorbed power on a dipole; alpha, m^3, is with radiation reaction.

    Without it, alpha is the static one: what its field alone takes up is absorbed.
    """
    E, gradient = field(shone, place)
    p = alpha * E
    speed = SPEED_OF_LIGHT / N_M
    force = (gradient.conj() @ p).real / speed
    torque = np.cross(p, (p / static).conj()).real / speed
    return force, torque, shone.k * (p @ (p / static).conj()).imag


class Dipole(Sphere):
    """A sphere without multipoles but the electric dipole."""

    def coefficients(self, k, medium):
        a, b = super().coefficients(k, medium)
        return a[:1], 0 * b[:1]


@pytest.mark.parametrize(
    "shone",
    [
        light((1, 0)),
        light(HELICITY[-1], angle=NA_10),
        light(ELLIPTIC, vortex=1),
        light(ELLIPTIC, vortex=-2, angle=NA_10),
        light("radial", vortex=1),
        light("azimuthal"),
    ],
    ids=["linear", "circular", "vortex 1", "vortex -2", "radial", "azimuthal"],
)
@pytest.mark.parametrize("index", [1.59, 0.26 + 6.97j, 1.5 + 0.3j])
def test_a_dipole_is_pushed_and_turned_by_its_field(shone, index):
    place = np.array([0.21e-6, -0.33e-6, 0.4e-6])
    sphere = Dipole(((50e-9, index),))
    (a_1,), _ = sphere.coefficients(shone.k, N_M)
    alpha = 6j * math.pi * a_1 / shone.k**3
    static = 1 / (1 / alpha + 1j * shone.k**3 / (6 * math.pi))
    force, torque, absorbed = on_a_dipole(shone, place, alpha, static)
    found = push(shone, sphere, place)
    assert found.force == pytest.approx(force, abs=1e-12 * np.linalg.norm(force))
    assert found.torque * OMEGA == pytest.approx(torque * OMEGA, abs=1e-12 * absorbed + 1e-17)
    assert found.absorbed == pytest.approx(absorbed, rel=1e-12, abs=1e-17)


@pytest.mark.parametrize(("index", "share"), [(1.59, 0.1), (0.26 + 6.97j, 0.5)])
def test_a_small_bead_is_a_dipole_of_clausius_and_mossotti(index, share):
    place = np.array([0.1e-6, -0.15e-6, 0.2e-6])
    shone = light(HELICITY[1])
    for radius in (10e-9, 20e-9):
        m2 = (index / N_M) ** 2
        static = 4 * math.pi * radius**3 * (m2 - 1) / (m2 + 2)
        alpha = static / (1 - 1j * shone.k**3 * static / (6 * math.pi))
        expected, *_ = on_a_dipole(shone, place, alpha, static)
        found = push(shone, bead(2 * radius, index), place).force
        off = np.linalg.norm(found - expected) / np.linalg.norm(expected)
        assert off < share * (shone.k * radius) ** 2


# --- conservation -----------------------------------------------------------------------------

GOLD = 0.26 + 6.97j
COATED = Sphere(((0.4e-6, 1.59), (0.55e-6, 1.9)))
OFF = np.array([0.3e-6, -0.2e-6, 0.5e-6])


@pytest.mark.parametrize(
    ("shone", "sphere"),
    [
        (light(ELLIPTIC), bead(1e-6, 1.59)),
        (light("unpolarised", cover=(1.518, 5e-6)), COATED),
        (light((1, 0), vortex=-2), Sphere(((0.3e-6, 1.0), (0.5e-6, 1.45)))),
    ],
    ids=["homogeneous", "coated", "hollow"],
)
def test_a_bead_that_does_not_absorb_is_not_turned(shone, sphere):
    found = push(shone, sphere, OFF)
    assert abs(found.absorbed) < 1e-13
    assert np.linalg.norm(found.torque) * OMEGA < 1e-12


@pytest.mark.parametrize("cover", [None, (1.518, 4e-6)], ids=["no cover", "cover"])
@pytest.mark.parametrize(
    ("polarisation", "vortex", "angular"),
    [
        (HELICITY[1], 0, 1),
        (HELICITY[-1], 0, -1),
        (HELICITY[1], 1, 2),
        (HELICITY[-1], 1, 0),
        ("radial", 0, 0),
        ("azimuthal", -2, -2),
    ],
    ids=["left", "right", "left 1", "right 1", "radial", "azimuthal -2"],
)
def test_on_the_axis_absorbed_light_leaves_its_angular_momentum(
    polarisation, vortex, angular, cover
):
    # J_z of one sign throughout: M_z omega = (l + helicity) P_abs
    sphere = Sphere(((0.3e-6, GOLD), (0.45e-6, 1.59 + 0.01j)))
    shone = light(polarisation, vortex=vortex, cover=cover)
    found = push(shone, sphere, np.array([0, 0, 0.4e-6]))
    assert found.absorbed > 1e-4
    expected = [0, 0, angular * found.absorbed]
    assert found.torque * OMEGA == pytest.approx(expected, abs=1e-13)
    assert found.force[:2] == pytest.approx([0, 0], abs=1e-13 * N_M / SPEED_OF_LIGHT)


def test_unpolarised_light_is_the_mean_of_any_two_orthogonal_states():
    sphere = bead(0.8e-6, 1.59 + 0.01j)
    mean = push(light("unpolarised"), sphere, OFF)
    each = [push(light(state), sphere, OFF) for state in HELICITY.values()]
    for name in ("force", "torque", "absorbed"):
        expected = sum(getattr(one, name) for one in each) / 2
        scale = np.linalg.norm(expected)
        assert getattr(mean, name) == pytest.approx(expected, abs=1e-12 * scale)


# --- a plane wave -----------------------------------------------------------------------------

MIE = [
    (0.1, 1.2),
    (0.1, 0.2 + 5j),
    (3.0, 1.2 + 0.01j),
    (3.0, 0.2 + 5j),
    (12.0, 0.75),
    (20.0, 1.2),
    (30.0, 1.5 + 0.1j),
]


@pytest.mark.parametrize(("x", "m"), MIE)
def test_the_coefficients_are_those_of_miepython(x, m):
    import miepython

    k = 2 * math.pi / WAVELENGTH
    theirs = miepython.coefficients(np.conj(m), x)
    ours = Sphere(((x / k, m * N_M),)).coefficients(k, N_M)
    for a, b in zip(ours, theirs, strict=True):
        number = min(len(a), len(b))
        assert a[:number] == pytest.approx(b[:number], rel=1e-9, abs=1e-13)


@pytest.mark.parametrize(("x", "m"), MIE[2:4])
def test_a_narrow_cone_is_a_plane_wave(x, m):
    import miepython

    angle = 1e-4
    shone = Light(
        N_M, VACUUM, angle, lambda theta: np.full_like(theta, 1 / (math.pi * angle**2)), HELICITY[1]
    )
    radius = x / shone.k
    found = push(shone, Sphere(((radius, m * N_M),)), np.zeros(3))
    intensity = (shone.k / (2 * math.pi)) ** 2 * math.pi * angle**2
    extinguished, scattered, _, g = miepython.efficiencies_mx(np.conj(m), x)
    power = intensity * math.pi * radius**2
    pressure = (extinguished - g * scattered) * power * N_M / SPEED_OF_LIGHT
    assert found.force == pytest.approx([0, 0, pressure], rel=1e-6, abs=1e-9 * pressure)
    assert found.absorbed == pytest.approx((extinguished - scattered) * power, rel=1e-6)


def test_the_dyad_is_S1_across_the_plane_and_S2_in_it():
    import miepython

    x, m, before, after = 5.0, 1.2 + 0.05j, 0.7, 2.1
    k = 2 * math.pi / WAVELENGTH
    a, b = Sphere(((x / k, m * N_M),)).coefficients(k, N_M)
    S, slope = dyad(a, b, after, np.array([[before]]), np.array([0.0]))
    S1, S2 = miepython.S1_S2(np.conj(m), x, np.array([math.cos(after - before)]), norm="wiscombe")
    assert S[..., 0, 0] == pytest.approx(np.diag(np.conj([S2[0], S1[0]])), abs=1e-9)
    h = 1e-5
    ends = [dyad(a, b, after + end, np.array([[before]]), np.array([0.9]))[0] for end in (h, -h)]
    slope = dyad(a, b, after, np.array([[before]]), np.array([0.9]))[1]
    assert slope == pytest.approx((ends[0] - ends[1]) / (2 * h), abs=1e-7)


# --- layers, and a cover ----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("layers", "same", "error"),
    [
        (((0.1e-6, 1.59), (0.3e-6, 1.59), (0.5e-6, 1.59)), (0.5e-6, 1.59), 1e-14),
        (((0.2e-6, GOLD), (0.45e-6, GOLD)), (0.45e-6, GOLD), 1e-14),
        (((0.4e-6, 1.9 + 0.1j), (0.7e-6, N_M)), (0.4e-6, 1.9 + 0.1j), 1e-14),
        (((0.3e-6, 1.0), (3e-6, GOLD)), (3e-6, GOLD), 1e-14),
        (((1e-10, 3.0), (2e-6, 1.59)), (2e-6, 1.59), 1e-9),
    ],
    ids=["equal", "equal metal", "shell of the medium", "opaque shell", "tiny core"],
)
def test_layers_that_light_does_not_see_change_nothing(layers, same, error):
    k = 2 * math.pi / WAVELENGTH
    ours, theirs = (Sphere(one).coefficients(k, N_M) for one in (layers, (same,)))
    for a, b in zip(ours, theirs, strict=True):
        number = min(len(a), len(b))
        assert a[:number] == pytest.approx(b[:number], rel=0, abs=error)


def test_of_the_medium_there_is_nothing():
    found = push(light(ELLIPTIC), Sphere(((0.2e-6, N_M), (0.5e-6, N_M))), OFF)
    assert np.linalg.norm(found.force) < 1e-50
    assert abs(found.absorbed) < 1e-50


def test_a_cover_passes_the_power_that_fresnel_lets_through():
    n1, n2 = 1.518, N_M
    W = lens(math.asin(1.2 / n1))
    shone = Light(n2, VACUUM, math.asin(1.2 / n1), W, (1, 0), cover=(n1, 7e-6))
    theta, weight = shone.nodes(40)
    before = np.arcsin(n2 / n1 * np.sin(theta))
    cos1, cos2 = np.cos(before), np.cos(theta)
    R = [
        ((n1 * cos1 - n2 * cos2) / (n1 * cos1 + n2 * cos2)) ** 2,
        ((n1 * cos2 - n2 * cos1) / (n1 * cos2 + n2 * cos1)) ** 2,
    ]
    p, s = (abs(g) ** 2 for g in shone.profile(theta))
    solid_angles = n2**2 * cos2 / (n1**2 * cos1)
    assert s == pytest.approx(W(before) * (1 - R[0]) * solid_angles, rel=1e-13)
    assert p == pytest.approx(W(before) * (1 - R[1]) * solid_angles, rel=1e-13)
    total = 2 * math.pi * weight @ (p + s) / 2
    assert 0.99 < total < 1


def test_a_cover_of_the_mediums_index_changes_nothing():
    sphere = bead(0.8e-6, 1.59)
    bare, covered = (
        push(light(ELLIPTIC, cover=cover), sphere, OFF) for cover in (None, (N_M, 5e-6))
    )
    assert covered.force == pytest.approx(bare.force, rel=1e-12)


def test_a_cover_of_oil_draws_the_focus_towards_it():
    # the rays of a narrow cone bend from n1 theta to n2 theta', so that they cross at d n2/n1
    n1, depth = 1.518, 20e-6

    def rest(cover):
        before = N_M if cover is None else n1
        shone = light((1, 0), angle=math.asin(0.3 / before), cover=cover)
        sphere = bead(20e-9, 1.59)
        return brentq(lambda z: push(shone, sphere, np.array([0, 0, z])).force[2], -4e-6, 2e-6)

    moved = rest((n1, depth)) - rest(None)
    assert moved == pytest.approx(-depth * (1 - N_M / n1), rel=0.05)


# --- the table that other tests read --------------------------------------------------------------


@pytest.mark.parametrize("row", rows()[::9], ids=lambda row: row["name"])
def test_the_table_holds_what_this_finds(row):
    found = exact(row)
    largest = np.linalg.norm(row["force"])
    assert found.force == pytest.approx(row["force"], abs=ERROR * largest)
    assert found.torque == pytest.approx(row["torque"], abs=ERROR * largest * row["wavelength"])
    assert found.absorbed == pytest.approx(row["absorbed"], abs=ERROR * largest * SPEED_OF_LIGHT)
