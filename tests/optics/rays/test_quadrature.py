"""The quadrature against an integral in other variables to rounding, and what symmetry demands."""

import csv
import itertools
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.polynomial import chebyshev
from scipy.optimize import minimize_scalar

import tweezer
from tests.reference import lens_integral
from tests.reference.raytracer import trace
from tweezer.optics import cone, light_force

PUBLISHED = Path(__file__).parents[2] / "data" / "ashkin1992.csv"
SPEED_OF_LIGHT = 299792458.0
N_MEDIUM = 1.33
PUPIL = 2.5e-3
FOCAL_LENGTH = 2e-3

#: of the largest force: what rounding leaves where contributions of all rays cancel
ROUNDING = 4e-15
#: of the largest force: a force below needs no relative accuracy
VANISHING = 1e-6


def trap(
    *,
    index=1.57773,
    lens="sine",
    half_angle=60.0,
    profile="gaussian",
    width=1.0,
    tolerance=1e-8,
    radius=1e-6,
    **beam,
):
    """A scene with that half angle in degrees, and the sigma of the beam in pupil radii."""
    angle = np.radians(half_angle)
    if lens == "sine":
        lens = {"map": "sine", "radius": PUPIL, "numerical_aperture": N_MEDIUM * np.sin(angle)}
    else:
        pupil = FOCAL_LENGTH * np.tan(angle)
        lens = {"map": "tan", "radius": pupil, "focal_length": FOCAL_LENGTH}
    beam = {"wavelength": 1e-6, "power_through_pupil": 0.1, "profile": profile, **beam}
    if profile in {"gaussian", "donut"}:
        beam["sigma"] = width * lens["radius"]
    return tweezer.load_scene(
        {
            "bead": {"radius": radius, "density": 1050, "refractive_index": index},
            "medium": {
                "refractive_index": N_MEDIUM,
                "density": 998,
                "viscosity": 1e-3,
                "temperature": 293,
            },
            "lens": lens,
            "beam": beam,
            "start": {"position": [0, 0, 0]},
            "simulation": {"duration": 1e-3},
            "optics": {"theory": "rays", "evaluator": "quadrature", "tolerance": tolerance},
        }
    )


RISING = {
    "profile_radius": list(np.linspace(0, 1.2 * PUPIL, 13)),
    "profile_intensity": list(1 / (1 + np.exp(1.8 - 3 * np.linspace(0, 1.2, 13) ** 2))),
}
INSIDE_THE_PUPIL = {
    "profile_radius": list(np.linspace(0, 0.7 * PUPIL, 7)),
    "profile_intensity": [1.0, 0.95, 0.85, 0.7, 0.55, 0.4, 0.3],
}

KINDS = {
    "thesis": {"lens": "tan", "half_angle": 52.43, "width": 0.385,
               "polarisation": "averaged-reflectance"},
    "sine": {},
    "lighter": {"index": 1.1},
    "air": {"index": 1.0, "half_angle": 45.0},
    "lighter averaged": {"index": 1.25, "polarisation": "averaged-reflectance", "lens": "tan"},
    "barely denser": {"index": 1.3302, "half_angle": 50.0},
    "barely lighter": {"index": 1.3298, "half_angle": 50.0},
    "diamond": {"index": 2.42, "lens": "tan", "half_angle": 40.0},
    "weak lens": {"half_angle": 8.7, "profile": "uniform", "index": 1.45},
    "weak lens, tan": {"half_angle": 12.0, "lens": "tan", "polarisation": "averaged-reflectance"},
    "wide": {"half_angle": 75.0, "width": 0.7},
    "wide tan": {"half_angle": 75.0, "lens": "tan", "profile": "uniform"},
    "narrow beam": {"width": 0.12, "half_angle": 65.0},
    "uniform": {"profile": "uniform", "index": 1.6},
    "uniform lighter": {"profile": "uniform", "index": 1.2, "half_angle": 70.0},
    "donut": {"profile": "donut", "width": 0.35, "index": 1.45},
    "donut tan": {"profile": "donut", "width": 0.5, "lens": "tan", "half_angle": 55.0},
    "table": {"profile": "table", "index": 1.45, **RISING},
    "table inside": {"profile": "table", **INSIDE_THE_PUPIL},
    "linear": {"polarisation": "linear", "half_angle": 65.0},
    "linear, turned, tan": {"polarisation": "linear", "jones": [0.6, -0.8], "lens": "tan",
                            "half_angle": 50.0, "index": 1.45},
    "elliptical lighter": {"polarisation": "linear", "jones": [0.6, "0.8j"], "index": 1.15},
}  # fmt: skip


def half_angle(scene):
    """Of the outermost rays: those from the rim of the pupil or the end of a table."""
    lens, rim = scene.lens, scene.lens.radius
    if scene.beam.profile_radius is not None:
        rim = min(rim, scene.beam.profile_radius[-1])
    if lens.map == "tan":
        return np.arctan(rim / lens.focal_length)
    return np.arcsin(rim / lens.radius * lens.numerical_aperture / N_MEDIUM)


def radiance(scene):
    """W/sr over cos(theta): intensity in the pupil times its area per solid angle behind it."""
    lens, beam = scene.lens, scene.beam
    R, P = lens.radius, beam.power_through_pupil
    if beam.profile == "table":  # the series is the light
        lowest = np.cos(half_angle(scene))
        series = cone(scene).series
        return lambda c: chebyshev.chebval((2 * c - 1 - lowest) / (1 - lowest), series)
    if beam.profile == "uniform":

        def intensity(rho2):
            return P / (np.pi * R**2)

    else:
        a = 2 * beam.sigma**2
        t = R**2 / a
        if beam.profile == "gaussian":

            def intensity(rho2):
                return P / (np.pi * a * -np.expm1(-t)) * np.exp(-rho2 / a)

        else:

            def intensity(rho2):
                return P / (np.pi * a * (1 - (1 + t) * np.exp(-t))) * rho2 / a * np.exp(-rho2 / a)

    if lens.map == "tan":
        f2 = lens.focal_length**2
        return lambda c: intensity(f2 * (1 - c) * (1 + c) / c**2) * f2 / c**3
    scale = (R * N_MEDIUM / lens.numerical_aperture) ** 2
    return lambda c: intensity(scale * (1 - c) * (1 + c)) * scale * c


@dataclass(frozen=True)
class Truth:
    """The integral of `lens_integral` for a scene."""

    scene: tweezer.Scene

    def field(self, position, tolerance=1e-12, smallest=0.0):
        beam = self.scene.beam
        jones = {"jones": [complex(*entry) for entry in beam.jones]} if beam.jones else {}
        return lens_integral.force_and_moment(
            position,
            radius=self.scene.bead.radius,
            n_bead=self.scene.bead.refractive_index,
            n_medium=N_MEDIUM,
            half_angle=half_angle(self.scene),
            radiance=radiance(self.scene),
            polarisation=beam.polarisation,
            tolerance=tolerance,
            smallest=smallest,
            **jones,
        )

    def force(self, position):
        return self.field(position)[0]

    def moment(self, position):
        return self.field(position)[1]

    def largest(self):
        """About the largest force anywhere: of some places at the edge of the bead."""
        places = np.array([[0, 0, 1], [0, 0, -1], [0.8, 0, 0], [0.5, 0.5, -0.7]])
        return max(
            np.linalg.norm(self.field(self.scene.bead.radius * place, 1e-6)[0]) for place in places
        )


def places(scene, rng, count):
    """Positions in m where something is difficult, in turn; at random in all else."""
    rim = half_angle(scene)
    ratio = scene.bead.refractive_index / N_MEDIUM
    points = []
    for i in range(count):
        small = 10 ** rng.uniform(-12, -1) * rng.choice([-1, 1])
        d = rng.choice([rng.uniform(0, 0.95), 1 + small, rng.uniform(1, 3), rng.uniform(3, 20)])
        gamma = np.arccos(rng.uniform(-1, 1))
        match i % 10:
            case 0:  # over the focus
                d = rng.uniform(0, 0.9)
            case 1:  # the focus at the edge of the bead, beside the axis
                d, gamma = 1 + small, rng.uniform(np.pi / 2 - rim, np.pi / 2 + rim)
            case 2:  # near the axis
                gamma = abs(small) if rng.random() < 0.5 else np.pi - abs(small)
            case 3:  # on the rim of the cone, in front of and behind the focus
                gamma = abs(rim + small if rng.random() < 0.5 else np.pi - rim + small)
            case 4:  # the rim's rays graze the bead
                d = 1 / max(abs(np.sin(gamma + rng.choice([-1, 1]) * rim)), 0.05) + small
            case 5:  # the last or first rays that graze
                d = rng.uniform(1, 20)
                gamma = rim + np.arcsin(1 / d) - abs(small)
                gamma = gamma if rng.random() < 0.5 else np.pi - gamma
            case 6 if ratio < 1:  # total reflection sets in
                d = ratio + small
            case 9 if ratio < 1:  # it sets in on the rim
                d = ratio / max(abs(np.sin(gamma + rng.choice([-1, 1]) * rim)), 0.05) + small
            case 7:  # on the axis of the bead's edge with the rim
                d, gamma = 1 + small, np.pi / 2 + rng.choice([-1, 1]) * rim + small * rng.random()
            case 8:  # far away in the light, or behind the focus
                d, gamma = rng.uniform(3, 20), rng.uniform(0, rim)
                gamma = gamma if rng.random() < 0.5 else np.pi - gamma
        phi = rng.uniform(0, 2 * np.pi)
        lateral = abs(d) * np.sin(gamma)
        points.append([lateral * np.cos(phi), lateral * np.sin(phi), abs(d) * np.cos(gamma)])
    return scene.bead.radius * np.array(points)


def misses(scene, positions):
    """(error, estimate, allowed) at each position, N: the error beyond what rounding explains."""
    truth = Truth(scene)
    largest = truth.largest()
    field = light_force(scene).field(positions)
    rows = []
    for position, force, estimate in zip(positions, field.force, field.error, strict=True):
        expected, _, uncertain = truth.field(
            position, max(1e-3 * scene.optics.tolerance, 1e-14), VANISHING * largest
        )
        allowed = scene.optics.tolerance * max(np.linalg.norm(expected), VANISHING * largest)
        slack = min(uncertain, 0.1 * allowed) + ROUNDING * largest
        error = max(np.linalg.norm(force - expected) - slack, 0.0)
        rows.append((error, estimate, allowed))
    return np.array(rows)


def worst(error, bound):
    """Largest error in units of its bound; 0 where there is none."""
    ratio = np.full_like(error, np.inf)
    ratio[error == 0] = 0
    return np.divide(error, bound, out=ratio, where=bound > 0).max()


# --- the reference itself -------------------------------------------------------------------------


@pytest.mark.parametrize("averaged", [False, True])
@pytest.mark.parametrize("index", [1.2, 1.57773])
def test_reference_is_the_integral_of_traced_rays(index, averaged):
    """Over the lens's own angles, ray by ray and bounce by bounce: inside, where that is smooth."""
    scene = trap(
        index=index,
        polarisation="averaged-reflectance" if averaged else "circular",
        half_angle=50.0,
    )
    position = 0.2 * np.array([0.3, -0.8, 0.5]) * scene.bead.radius
    nodes, weights = np.polynomial.legendre.leggauss(14)
    rim, per_solid_angle = half_angle(scene), radiance(scene)
    total = np.zeros(3)
    for theta, weight in zip(rim / 2 * (1 + nodes), rim / 2 * weights, strict=True):
        power = weight * np.sin(theta) * per_solid_angle(np.cos(theta)) * 2 * np.pi / 20
        for phi in 2 * np.pi / 20 * np.arange(20):
            u = [np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)]
            ray = trace(u, position, scene.bead.radius, N_MEDIUM, index, averaged=averaged)
            total += power * N_MEDIUM / SPEED_OF_LIGHT * ray.force
    expected = Truth(scene).force(position)
    np.testing.assert_allclose(expected, total, rtol=0, atol=1e-11 * np.linalg.norm(total))


@pytest.mark.parametrize("index", [1.1, 1.57773])
@pytest.mark.parametrize(
    "place", [[0.9, 0.5, 0.2], [0.2, -1.2, 1.4], [1.5, 0, -2.2], [0, 0.01, -1.8], [2.5, 1.0, 3.0]]
)
def test_reference_is_a_plain_sum_of_very_many_rays(place, index):
    """Also where only some rays hit, some of them totally reflected: the arcs and break points."""
    scene = trap(index=index, polarisation="linear", jones=[0.6, "0.8j"], half_angle=65.0)
    position = np.array(place) * scene.bead.radius
    rim, count = half_angle(scene), 1200
    cosines = 1 - (1 - np.cos(rim)) * (np.arange(count) + 0.5) / count
    phi = 2 * np.pi * (np.arange(count) + 0.5) / count
    cosine, phi = (grid.ravel() for grid in np.meshgrid(cosines, phi))
    sine = np.sqrt(1 - cosine**2)
    u = np.array([sine * np.cos(phi), sine * np.sin(phi), cosine])
    power = radiance(scene)(cosine) * 2 * np.pi * (1 - np.cos(rim)) / count**2
    n = (position @ u) * u - position[:, None]
    b = np.linalg.norm(n, axis=0)
    hit = b < scene.bead.radius
    u, n, b, power, cosine, phi = u[:, hit], n[:, hit], b[hit], power[hit], cosine[hit], phi[hit]
    Q_s, Q_p = lens_integral.efficiencies(
        b / scene.bead.radius, N_MEDIUM / scene.bead.refractive_index, averaged=False
    )
    # the lens turns what is radial in the pupil, and leaves what is azimuthal
    azimuthal = np.array([-np.sin(phi), np.cos(phi), 0 * phi])
    radial = np.cross(azimuthal, u, axis=0)
    a, b_ = 0.6, 0.8j
    E = (a * np.cos(phi) + b_ * np.sin(phi)) * radial
    E = E + (b_ * np.cos(phi) - a * np.sin(phi)) * azimuthal
    s = np.cross(u, n, axis=0) / b
    share = np.abs((E * s).sum(0)) ** 2
    Q = share * Q_s + (1 - share) * Q_p
    total = N_MEDIUM / SPEED_OF_LIGHT * (u @ (power * Q.real) - n @ (power * Q.imag / b))
    expected = Truth(scene).force(position)
    assert np.linalg.norm(expected) > 1e-12
    np.testing.assert_allclose(expected, total, rtol=0, atol=4e-4 * np.linalg.norm(expected))


def test_reference_knows_what_is_polarised_across_the_plane_of_incidence():
    """Light along x, rays and bead in the x-z plane: all of it p; along y: all of it s."""
    frame = np.array([[0.8, 0, 0.6], [-0.6, 0, 0.8], [0, -1, 0]])
    g, psi = np.full((3, 1), 0.3), np.array([[0.0], [np.pi], [0.0]])
    for jones, share in (((1, 0), 0), ((0, 1), 1), ((0.6, 0.8j), 0.64)):
        s = lens_integral.s_polarised_share(g, psi, frame, jones)
        np.testing.assert_allclose(s, share, atol=1e-15)


RINGED = {
    "profile_radius": list(np.linspace(0, PUPIL, 200)),
    "profile_intensity": list(np.exp(-200 * (np.linspace(0, 1, 200) ** 2 - 0.5) ** 2)),
}


@pytest.mark.filterwarnings("ignore:beam.profile_intensity. points so uneven")
@pytest.mark.parametrize("polarisation", ["circular", "linear"])
def test_light_too_uneven_for_the_tolerance_ends_and_is_told(polarisation):
    """A thin ring of light takes more nodes than there are."""
    scene = trap(profile="table", tolerance=1e-12, polarisation=polarisation, **RINGED)
    positions = scene.bead.radius * np.array([[0.5845, 0.0, -0.8114], [0.3, 0.2, 0.9]])
    with pytest.warns(tweezer.PhysicsWarning, match="misses optics.tolerance = 1e-12 at"):
        force = tweezer.optical_force(scene, positions)
    beams = [scene.beam.model_dump(exclude_none=True)] * 2
    with pytest.warns(tweezer.PhysicsWarning, match="misses optics.tolerance = 1e-12 at"):
        tweezer.optical_force(scene.replace(beam=beams), positions)
    truth = Truth(scene)
    for position, here, estimate in zip(positions, force, light_force(scene).field(positions).error,
                                        strict=True):  # fmt: skip
        assert np.linalg.norm(here - truth.force(position)) <= 10 * estimate


# --- error and estimate ---------------------------------------------------------------------------


@pytest.mark.parametrize("kind", KINDS)
def test_error_is_within_the_tolerance_and_the_estimate(kind):
    """1e-8 of the force there, and never 10 times more than estimated."""
    scene = trap(**KINDS[kind])
    rng = np.random.default_rng(sorted(KINDS).index(kind))
    error, estimate, allowed = misses(scene, places(scene, rng, 20)).T
    assert worst(error, allowed) <= 1
    assert worst(error, estimate) <= 10


def test_error_is_estimated_where_the_rim_is_next_to_a_panel():
    """Panels triple in cos(g) from the onset of total reflection; one may end beside the rim."""
    scene = trap(index=1.2857, lens="tan", half_angle=62.48, profile="uniform")
    rim, m = half_angle(scene), N_MEDIUM / 1.2857
    points = []
    for gamma, beyond in itertools.product((2.14, 1.9, 1.3), (5e-4, 3e-5)):
        onset = np.cos(abs(rim - min(gamma, np.pi - gamma)) + beyond) / 3
        ratios = 1 / np.sqrt(1 + np.array([[-1], [1]]) * onset**2) / m
        points.extend(ratios * [np.sin(gamma), 0, np.cos(gamma)])
    error, estimate, allowed = misses(scene, scene.bead.radius * np.array(points)).T
    assert worst(error, allowed) <= 1
    assert worst(error, estimate) <= 10


@pytest.mark.parametrize("kind", ["sine", "uniform lighter"])
def test_far_away_at_the_edge_of_the_cone_the_force_is_finite(kind):
    """There the bead is a point, half in the light; its force falls with the distance squared."""
    scene = trap(**KINDS[kind], radius=2e-7)
    rng = np.random.default_rng(72)
    distance = 10 ** rng.uniform(-2.5, 1, 2000)
    gamma = half_angle(scene) * (1 + 10 ** rng.uniform(-17, -12, 2000) * rng.choice([-1, 1], 2000))
    side = rng.choice([-1, 1], 2000)
    direction = np.stack([np.sin(gamma), np.zeros(2000), side * np.cos(gamma)], axis=1)
    field = light_force(scene).field(distance[:, None] * direction, gradient=True)
    assert np.isfinite(field.force_gradient).all()
    at_one_metre = np.linalg.norm(field.force, axis=1) * distance**2
    assert at_one_metre.min() > 0
    assert at_one_metre.max() < 3 * at_one_metre.min()


@pytest.mark.parametrize("kind", ["sine", "thesis", "lighter", "linear"])
def test_every_tolerance_is_honoured(kind):
    rng = np.random.default_rng(70)
    scene = trap(**KINDS[kind])
    positions = places(scene, rng, 10)
    for exponent in range(2, 13, 2):
        loose = scene.replace(optics={"tolerance": 10.0**-exponent})
        error, estimate, allowed = misses(loose, positions).T
        assert worst(error, allowed) <= 1, exponent
        assert worst(error, estimate) <= 10, exponent


def test_a_looser_tolerance_is_not_ignored():
    """Some error is made of the freedom given: the tolerance is not a decoration."""
    scene = trap(tolerance=1e-2)
    positions = places(scene, np.random.default_rng(71), 40)
    loose = tweezer.optical_force(scene, positions)
    tight = light_force(trap(tolerance=1e-12)).field(positions).force
    assert np.abs(loose - tight).max() > 1e-7 * np.abs(tight).max()


@given(
    index=st.floats(1.0, 2.5),
    lens=st.sampled_from(["tan", "sine"]),
    half_angle=st.floats(5, 75),
    profile=st.sampled_from(["gaussian", "uniform", "donut"]),
    width=st.floats(0.15, 5),
    polarisation=st.sampled_from(["averaged-reflectance", "circular", "linear"]),
    radius=st.floats(2e-7, 1e-5),
    seed=st.integers(0, 2**32 - 1),
)
@settings(max_examples=60, deadline=None, derandomize=True)
def test_any_scene_and_place(seed, **kind):
    """Finite, within the momentum of the light, and both promises kept against the reference."""
    scene = trap(**kind)
    positions = places(scene, np.random.default_rng(seed), 10)[seed % 10 :][:2]
    field = light_force(scene).field(positions, gradient=True)
    assert np.isfinite(field.force_gradient).all()
    bound = 2 * N_MEDIUM * scene.beam.power_through_pupil / SPEED_OF_LIGHT
    assert (np.linalg.norm(field.force, axis=1) <= bound).all()
    error, estimate, allowed = misses(scene, positions).T
    assert worst(error, allowed) <= 1
    assert worst(error, estimate) <= 10


# --- what must hold exactly -----------------------------------------------------------------------


@pytest.mark.parametrize("polarisation", ["averaged-reflectance", "circular", "linear"])
def test_equal_indices_give_exactly_nothing(polarisation):
    scene = trap(index=N_MEDIUM, polarisation=polarisation, torque="thesis")
    field = light_force(scene).field(places(scene, np.random.default_rng(72), 30), gradient=True)
    for values in (field.force, field.moment, field.force_gradient, field.moment_gradient):
        assert not values.any()


def test_no_light_no_force_and_no_error():
    """A bead beside the cone of light, or in the dark."""
    scene = trap(half_angle=30.0)
    beside = [[3e-6, 0, 1e-6], [0, -5e-6, -2e-6]]
    dark = scene.replace(beam={"power_through_pupil": 0})
    for field in (
        light_force(scene).field(np.array(beside)),
        light_force(dark).field(np.array([[0.0, 0, 0], [3e-7, 0, 0]])),
    ):
        assert not field.force.any()
        assert not field.error.any()


@pytest.mark.parametrize("kind", ["sine", "lighter", "linear"])
def test_linear_in_power_and_free_of_scale(kind):
    """Twice the power, twice the force; bead and distances n times as large, the same force."""
    scene = trap(**KINDS[kind])
    positions = places(scene, np.random.default_rng(73), 20)
    force = tweezer.optical_force(scene, positions)
    atol = ROUNDING * np.abs(force).max()
    brighter = trap(**KINDS[kind], power_through_pupil=0.2)
    np.testing.assert_allclose(
        tweezer.optical_force(brighter, positions), 2 * force, rtol=1e-13, atol=atol
    )
    larger = trap(**KINDS[kind], radius=4e-6)  # a power of two: the same roundings
    np.testing.assert_allclose(
        tweezer.optical_force(larger, 4 * positions), force, rtol=1e-13, atol=atol
    )


@pytest.mark.parametrize("kind", ["thesis", "sine", "lighter"])
def test_turning_and_mirroring_the_place_turns_and_mirrors_the_force(kind):
    scene = trap(**KINDS[kind])
    positions = places(scene, np.random.default_rng(74), 30)
    force = tweezer.optical_force(scene, positions)
    for symmetry in (turn(0.7), turn(np.pi / 2), np.diag([-1, 1, 1]), np.diag([1, -1, 1])):
        moved = tweezer.optical_force(scene, positions @ symmetry.T)
        # a turn rounds the position, and near the bead's edge the force magnifies that
        np.testing.assert_allclose(
            moved, force @ symmetry.T, rtol=0, atol=1e-12 * np.abs(force).max()
        )


def test_turning_linear_light_with_the_place_turns_the_force():
    angle = 0.7
    scene = trap(polarisation="linear", jones=[0.6, "0.8j"])
    a, b = turn(angle)[:2, :2] @ [0.6, 0.8j]
    turned = trap(polarisation="linear", jones=[[a.real, a.imag], [b.real, b.imag]])
    positions = places(scene, np.random.default_rng(75), 30)
    force = tweezer.optical_force(scene, positions)
    size = np.linalg.norm(force, axis=1, keepdims=True) + VANISHING * np.abs(force).max()
    moved = tweezer.optical_force(turned, positions @ turn(angle).T)
    assert (np.abs(moved - force @ turn(angle).T) <= 2e-8 * size).all()
    # not that nothing had changed: the same light at the turned place pushes otherwise
    assert (
        np.abs(tweezer.optical_force(scene, positions @ turn(angle).T) - moved) > size / 50
    ).any()


def turn(angle):
    """About the z axis."""
    return np.array(
        [[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]]
    )


@pytest.mark.parametrize("index", [1.1, 1.57773])
def test_light_along_x_and_along_y_make_circular_light(index):
    positions = places(trap(index=index), np.random.default_rng(76), 30)
    x, y, circular = (
        tweezer.optical_force(trap(index=index, **beam), positions)
        for beam in (
            {"polarisation": "linear", "jones": [1, 0]},
            {"polarisation": "linear", "jones": [0, 1]},
            {"polarisation": "circular"},
        )
    )
    size = np.linalg.norm(x, axis=1) + np.linalg.norm(y, axis=1) + VANISHING * np.abs(x).max()
    assert (np.abs(x + y - 2 * circular).max(axis=1) <= 2e-8 * size).all()
    inside = np.linalg.norm(positions, axis=1) < 0.5e-6
    assert (np.abs(x - y)[inside].max(axis=1) > 1e-4 * size[inside]).any()


@pytest.mark.parametrize("kind", ["thesis", "sine", "lighter", "donut"])
def test_on_the_axis_the_force_is_along_it(kind):
    scene = trap(**KINDS[kind])
    heights = scene.bead.radius * np.array([-20, -3, -1.01, -1, -0.5, 0, 0.3, 1, 1 + 1e-7, 4, 20])
    field = light_force(scene).field(np.outer(heights, [0, 0, 1]), gradient=True)
    assert not field.force[:, :2].any()
    assert field.force[:, 2].all()
    J = field.force_gradient
    scale = 1e-12 * np.abs(J).max()
    np.testing.assert_allclose(J[:, 0, 0], J[:, 1, 1], rtol=0, atol=scale)
    for i, j in ((0, 1), (1, 0), (0, 2), (2, 0), (1, 2), (2, 1)):
        np.testing.assert_allclose(J[:, i, j], 0, atol=scale)


@pytest.mark.parametrize("kind", KINDS)
def test_the_force_is_within_the_momentum_of_the_light(kind):
    """No more than 2 n_m P/c, at random places out to 20 radii."""
    scene = trap(**KINDS[kind])
    field = light_force(scene).field(places(scene, np.random.default_rng(77), 300))
    bound = 2 * N_MEDIUM * scene.beam.power_through_pupil / SPEED_OF_LIGHT
    assert (np.linalg.norm(field.force, axis=1) <= bound).all()
    assert np.isfinite(field.error).all()


# --- derivatives and the moment -------------------------------------------------------------------

SMOOTH = [
    [0.3, -0.2, 0.25],
    [0, 0, 0.4],
    [0.8, 0, 0.1],
    [0.4, 1.5, -1.8],
    [-0.3, 0.2, 4.0],
    [1, 1.3, 0.6],
]


def derivative(function, position, step):
    """[i, j] = d(function_i)/dx_j by central differences, extrapolated to the sixth order."""
    columns = []
    for shift in step * np.eye(3):
        d1, d2, d3 = (
            (function(position + k * shift) - function(position - k * shift)) / (2 * k * step)
            for k in (1, 2, 3)
        )
        columns.append(1.5 * d1 - 0.6 * d2 + 0.1 * d3)
    return np.stack(columns, axis=1)


@pytest.mark.parametrize("kind", ["thesis", "sine", "lighter", "donut tan", "linear"])
def test_jacobian_is_the_derivative_of_the_reference(kind):
    scene = trap(**KINDS[kind])
    positions = scene.bead.radius * np.array(SMOOTH)
    jacobians = tweezer.optical_jacobian(scene, positions)
    for position, jacobian in zip(positions, jacobians, strict=True):
        expected = derivative(Truth(scene).force, position, 5e-4 * scene.bead.radius)
        np.testing.assert_allclose(
            jacobian, expected, rtol=0, atol=1e-6 * np.abs(expected).max(), err_msg=str(position)
        )


@pytest.mark.parametrize("kind", ["thesis", "sine", "lighter", "linear"])
def test_moment_and_its_gradient(kind):
    """(3.25): each ray's force applied where it enters."""
    scene = trap(**KINDS[kind], torque="thesis")
    positions = scene.bead.radius * np.array(SMOOTH)
    field = light_force(scene).field(positions, gradient=True)
    largest = np.abs(field.moment).max()
    for position, moment, gradient in zip(
        positions, field.moment, field.moment_gradient, strict=True
    ):
        np.testing.assert_allclose(
            moment, Truth(scene).moment(position), rtol=0, atol=1e-7 * largest
        )
        expected = derivative(Truth(scene).moment, position, 5e-4 * scene.bead.radius)
        atol = 1e-6 * largest / scene.bead.radius
        np.testing.assert_allclose(gradient, expected, rtol=0, atol=atol, err_msg=str(position))


@pytest.mark.parametrize("kind", ["sine", "lighter", "linear"])
def test_force_is_the_same_with_gradient_and_without(kind):
    scene = trap(**KINDS[kind], torque="thesis")
    positions = places(scene, np.random.default_rng(78), 40)
    plain = light_force(scene).field(positions)
    full = light_force(scene).field(positions, gradient=True)
    largest = np.abs(plain.force).max()
    size = np.linalg.norm(plain.force, axis=1, keepdims=True) + VANISHING * largest
    assert (np.abs(full.force - plain.force) <= 2e-8 * size).all()


# --- continuity -----------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", ["thesis", "sine", "lighter", "air", "wide", "linear"])
def test_no_jump_where_the_integral_is_divided_otherwise(kind):
    """Across d = r, the lines where the rim grazes the bead or total reflection sets in, the cone's
    rim, the level of the focus, and wherever one rule gives way to another along a line outwards.
    """
    scene = trap(**KINDS[kind])
    r, rim = scene.bead.radius, half_angle(scene)
    rng = np.random.default_rng(79)
    pairs = []
    for gamma in rng.uniform(0, np.pi, 12):
        distances = [1.0]
        for limit in (1.0, scene.bead.refractive_index / N_MEDIUM):
            distances += [limit, *(limit / abs(np.sin(gamma + rim * s)) for s in (-1, 1))]
        out = np.array([np.sin(gamma), 0, np.cos(gamma)])
        pairs += [(d * (1 - 1e-11) * out, d * (1 + 1e-11) * out) for d in distances if d < 20]
    for d in rng.uniform(0.2, 8, 12):
        for gamma in (rim, np.pi - rim, np.pi / 2):
            pairs.append(
                [d * np.array([np.sin(g), 0, np.cos(g)]) for g in (gamma - 1e-11, gamma + 1e-11)]
            )
    pairs = r * np.array(pairs)
    before, after = (tweezer.optical_force(scene, pairs[:, side]) for side in (0, 1))
    largest = np.abs(before).max()
    size = np.linalg.norm(before, axis=1) + VANISHING * largest
    assert (np.linalg.norm(after - before, axis=1) <= 2e-8 * size + 1e-9 * largest * 0.02).all()


@pytest.mark.parametrize("kind", ["thesis", "sine", "lighter"])
def test_the_force_along_a_line_has_no_steps(kind):
    """Second differences along lines through the trap: nothing beyond the tolerance."""
    scene = trap(**KINDS[kind])
    step = 1e-7
    s = np.linspace(0.05, 6, 500)
    for direction in ([0.6, 0, 0.8], [1, 0, 0], [0.2, 0, -1], [0.95, 0, 0.3]):
        line = np.outer(s, direction) * scene.bead.radius
        ahead = np.outer(s + step, direction) * scene.bead.radius
        behind = np.outer(s - step, direction) * scene.bead.radius
        forces = [tweezer.optical_force(scene, at) for at in (behind, line, ahead)]
        largest = np.abs(forces[1]).max()
        size = np.linalg.norm(forces[1], axis=1) + VANISHING * largest
        bend = np.linalg.norm(forces[0] - 2 * forces[1] + forces[2], axis=1)
        assert (bend <= 4e-8 * size + 1e-12 * largest).all()


# --- others' numbers ------------------------------------------------------------------------------


@pytest.mark.parametrize("place", [[0.3, 0.1, -0.4], [0.9, 0.4, 1.5]])
def test_the_grid_converges_to_the_quadrature(place):
    """Like 1/n_div inside: the staircase rim. Outside also by the rays that begin to hit."""
    scene = trap(lens="tan", half_angle=52.43, width=0.385)
    position = np.array(place) * scene.bead.radius
    exact = tweezer.optical_force(scene, position)
    divisions = np.array([25, 50, 100, 200, 400, 800, 1600])
    errors = [
        np.linalg.norm(
            tweezer.optical_force(
                scene.replace(beam={"divisions": int(n)}, optics={"evaluator": "grid"}), position
            )
            - exact
        )
        for n in divisions
    ]
    slope = np.polyfit(np.log(divisions), np.log(errors), 1)[0]
    assert -1.6 < slope < -0.7, slope
    assert errors[-1] < 3e-3 * np.linalg.norm(exact)


def published(kind):
    rows = (line for line in PUBLISHED.read_text().splitlines() if not line.startswith("#"))
    return [row for row in csv.DictReader(rows) if row["kind"] == kind]


@pytest.mark.parametrize("row", published("axial"), ids=lambda row: row["beam"] + row["n_rel"])
def test_published_axial_trap(row):
    """Ashkin (1992): the strongest pull back, and where; NA 1.25 in water by the tan map."""
    profile = row["beam"].split()[0]
    scene = trap(
        index=float(row["n_rel"]) * N_MEDIUM,
        lens="tan",
        half_angle=70.0,
        profile=profile,
        width=0.5,  # a waist of 2 sigma as wide as the pupil
    )
    unit = N_MEDIUM * scene.beam.power_through_pupil / SPEED_OF_LIGHT

    def Q_z(z):
        return tweezer.optical_force(scene, [0, 0, z * scene.bead.radius])[2] / unit

    strongest = minimize_scalar(Q_z, bounds=(0.7, 1.3), method="bounded", options={"xatol": 1e-6})
    assert strongest.fun == pytest.approx(float(row["Qg_or_Qz"]), abs=1.5e-3)
    assert strongest.x == pytest.approx(float(row["theta_deg_or_z"]), abs=0.01)
