"""The beam in the pupil and the cone of light behind the lens, against integrals of the profile.

The oracles are the profiles written out here, integrated over the pupil by scipy: what passes a
pupil of radius rho(theta) is what the cone holds within theta.
"""

from __future__ import annotations

import itertools
import math
import warnings
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import quad

import tweezer
from tweezer.optics import (
    cone,
    fraction_through_pupil,
    grid,
    light_force,
    total_power,
)
from tweezer.optics.beam import intensity
from tweezer.values.errors import PhysicsWarning, SceneError

RADIUS, FOCAL_LENGTH, INDEX = 2.6e-3, 2e-3, 1.33
#: part of the power per area at rho of a beam of standard deviation s
DENSITY = {
    "gaussian": lambda rho, s: math.exp(-((rho / s) ** 2) / 2) / (2 * math.pi * s**2),
    "donut": lambda rho, s: rho**2 * math.exp(-((rho / s) ** 2) / 2) / (4 * math.pi * s**4),
    "uniform": lambda rho, s: 1 / (math.pi * RADIUS**2),
}
#: of the two maps, with the aperture of the sine map
LENSES = {
    "tan": {"map": "tan", "focal_length": FOCAL_LENGTH},
    "sine": {"map": "sine", "numerical_aperture": 1.2},
    "low aperture": {"map": "sine", "numerical_aperture": 0.05},
    "nearly all of the half space": {"map": "sine", "numerical_aperture": 1.3299999},
}


def scene_of(lens="tan", **beam):
    """A scene with a beam of 0.1 W and the lens of that name."""
    return tweezer.load_scene(
        {
            "bead": {"radius": 5e-6, "density": 1050, "refractive_index": 1.57},
            "medium": {
                "refractive_index": INDEX, "density": 1000, "viscosity": 1e-3, "temperature": 293,
            },
            "lens": {"radius": RADIUS, **LENSES[lens]},
            "beam": {"wavelength": 8e-7, "power": 0.1, **beam},
            "start": {"position": [0, 0, 0]},
            "simulation": {"duration": 1e-3},
        }
    )  # fmt: skip


def scene_with(profile, lens="tan", width=0.4):
    """A beam of that profile, its sigma in pupil radii."""
    sigma = {} if profile == "uniform" else {"sigma": width * RADIUS}
    return scene_of(lens, profile=profile, **sigma)


def table_of(radii, intensities, lens="tan", **beam):
    """A beam through these points, radii in pupil radii."""
    return scene_of(
        lens, profile="table", profile_radius=[RADIUS * float(rho) for rho in radii],
        profile_intensity=[float(i) for i in intensities], **beam,
    )  # fmt: skip


def pupil_radius(theta, lens):
    """rho(theta), m: tan(theta) = rho/f, or sin(theta) = (rho/R) NA/n_m."""
    if lens == "tan":
        return FOCAL_LENGTH * math.tan(theta)
    return RADIUS * math.sin(theta) * INDEX / LENSES[lens]["numerical_aperture"]


def power_within_radius(density, rho):
    # a narrow beam would slip through quad's first nodes
    pieces = np.linspace(0, 1, 9) ** 2 * rho
    return sum(
        quad(lambda x: density(x) * 2 * math.pi * x, a, b, epsabs=0, epsrel=1e-13)[0]
        for a, b in itertools.pairwise(pieces)
    )


def power_within_angle(behind, theta):
    """Integral of the radiance over solid angle, up to theta."""
    return quad(
        lambda t: 2 * math.pi * math.sin(t) * float(behind.radiance(np.cos(t))), 0, theta,
        epsabs=0, epsrel=1e-12,
    )[0]  # fmt: skip


@pytest.mark.parametrize("width", [0.03, 0.2, 0.5, 1.0, 3.0, 100.0])
@pytest.mark.parametrize("profile", DENSITY)
def test_fraction_through_the_pupil(profile, width):
    scene = scene_with(profile, width=width)
    inside = RADIUS if profile == "uniform" else min(RADIUS, 12 * width * RADIUS)  # the rest: 1e-30
    expected = power_within_radius(lambda rho: DENSITY[profile](rho, width * RADIUS), inside)
    found = fraction_through_pupil(scene.lens, scene.beam)
    assert found == pytest.approx(expected, rel=1e-12)
    assert total_power(scene.lens, scene.beam) == 0.1
    assert cone(scene).power == pytest.approx(0.1 * expected, rel=1e-12)
    measured = scene.replace(beam={"power_through_pupil": 0.1 * found})
    assert total_power(measured.lens, measured.beam) == pytest.approx(0.1, rel=1e-14)
    assert cone(measured).power == pytest.approx(cone(scene).power, rel=1e-14)


@pytest.mark.parametrize("lens", LENSES)
@pytest.mark.parametrize("profile", DENSITY)
def test_the_cone_holds_within_an_angle_what_enters_within_its_radius(profile, lens):
    behind = cone(scene_with(profile, lens))
    assert pupil_radius(behind.half_angle, lens) == pytest.approx(RADIUS, rel=1e-12)
    for part in (0.1, 0.5, 0.9, 1.0):
        theta = part * behind.half_angle
        rho = pupil_radius(theta, lens)
        expected = 0.1 * power_within_radius(lambda x: DENSITY[profile](x, 0.4 * RADIUS), rho)
        assert power_within_angle(behind, theta) == pytest.approx(expected, rel=1e-10)


@pytest.mark.parametrize("lens", LENSES)
@pytest.mark.parametrize("profile", DENSITY)
@pytest.mark.parametrize("width", [0.01, 0.03, 0.1, 0.2, 0.5, 1.0, 3.0, 100.0])
def test_the_series_is_the_profile(profile, lens, width):
    """To 1e-14 of the largest radiance, with few coefficients, for narrow beams and wide ones."""
    scene = scene_with(profile, lens, width)
    behind = cone(scene)
    assert behind.deviation < 1e-14
    assert len(behind.series) <= 62
    assert np.isfinite(behind.series).all()
    # the formulas of the radiance, in place of its integral
    theta = np.linspace(0, behind.half_angle, 701)
    rho = np.array([pupil_radius(t, lens) for t in theta])
    scale = FOCAL_LENGTH if lens == "tan" else pupil_radius(math.pi / 2, lens)
    area = scale**2 * (np.cos(theta) ** -3 if lens == "tan" else np.cos(theta))
    exact = 0.1 * area * [DENSITY[profile](x, width * RADIUS) for x in rho]
    # (1 - cos(theta))/(1 - cos(half_angle)) of a narrow cone, which its cosines round away
    below = (np.sin(theta / 2) / np.sin(behind.half_angle / 2)) ** 2
    found = np.polynomial.Chebyshev(behind.series)(1 - 2 * below)
    assert np.abs(found - exact).max() < 5e-14 * exact.max()
    if profile != "uniform" and width < 0.1:
        dark = math.exp(-((rho[-1] / (width * RADIUS)) ** 2) / 2)
        assert rho[-1] < 0.99 * RADIUS
        assert dark * 100 < 1e-18


@pytest.mark.parametrize("lens", ["tan", "sine"])
@pytest.mark.parametrize(
    ("vortex", "width"), [(1, 0.4), (-2, 0.1), (3, 5.0), (10, 0.4), (-50, 0.01), (50, 0.4)]
)
def test_a_gaussian_vortex_is_a_laguerre_gauss_beam(vortex, width, lens):
    """rho^(2|l|) times the Gaussian: in the pupil, through it, and in the cone."""
    n, s = abs(vortex), width * RADIUS

    def density(rho):
        t = (rho / s) ** 2 / 2
        return 0.0 if t == 0 else math.exp(n * math.log(t) - t - math.lgamma(n + 1) - power)

    power = math.log(2 * math.pi * s**2)
    scene = scene_with("gaussian", lens, width).replace(beam={"vortex": vortex})
    ring = s * math.sqrt(2 * n)
    inside = power_within_radius(density, min(RADIUS, ring + 9 * s))
    assert fraction_through_pupil(scene.lens, scene.beam) == pytest.approx(inside, rel=1e-12)
    behind = cone(scene)
    assert behind.power == pytest.approx(0.1 * inside, rel=1e-12)
    theta = 0.97 * behind.half_angle  # nearer to the axis some rings are darker than rounding
    rho = pupil_radius(theta, lens)
    within = 0.1 * power_within_radius(density, rho)
    assert power_within_angle(behind, theta) == pytest.approx(within, rel=1e-10)
    found = intensity(scene.lens, scene.beam, scene.medium)(np.array([rho / 2, rho]))
    np.testing.assert_allclose(found, [0.1 * density(rho / 2), 0.1 * density(rho)], rtol=1e-12)


def test_of_other_profiles_a_vortex_is_the_phase_alone():
    for profile in ("uniform", "donut"):
        scene = scene_with(profile)
        twisted = cone(scene.replace(beam={"vortex": 3}))
        np.testing.assert_array_equal(twisted.series, cone(scene).series)
    donut, gaussian = cone(scene_with("donut")), scene_with("gaussian").replace(beam={"vortex": -1})
    np.testing.assert_array_equal(cone(gaussian).series, donut.series)
    wide = scene_with("gaussian", width=100).replace(beam={"vortex": 50})
    with pytest.raises(
        SceneError, match=r"beam\.sigma = 0\.26: almost no light within lens.radius"
    ):
        cone(wide)


def test_with_a_cover_the_cone_is_that_before_its_face():
    """The sine condition holds in the medium there; the light is that of a lens in it."""
    scene = scene_with("gaussian", "sine").replace(
        lens={"numerical_aperture": 1.4, "cover": {"refractive_index": 1.52, "depth": "9 um"}}
    )
    behind = cone(scene)
    assert math.sin(behind.half_angle) == pytest.approx(1.4 / 1.52, rel=1e-14)
    theta = 0.6
    rho = RADIUS * math.sin(theta) * 1.52 / 1.4
    expected = 0.1 * power_within_radius(lambda x: DENSITY["gaussian"](x, 0.4 * RADIUS), rho)
    assert power_within_angle(behind, theta) == pytest.approx(expected, rel=1e-10)


@pytest.mark.parametrize("degrees", [1, 30, 60, 80, 85, 89])
@pytest.mark.parametrize("profile", DENSITY)
def test_the_tan_map_up_to_the_stated_angle(profile, degrees):
    focal_length = RADIUS / math.tan(math.radians(degrees))
    scene = scene_with(profile, width=1.0).replace(lens={"focal_length": focal_length})
    if degrees == 89:
        with pytest.raises(SceneError, match=r"^lens: the light reaches 89 degrees off the axis"):
            cone(scene)
        return
    behind = cone(scene)
    assert behind.deviation < 1e-14
    assert math.degrees(behind.half_angle) == pytest.approx(degrees, rel=1e-13)
    expected = 0.1 * power_within_radius(lambda x: DENSITY[profile](x, RADIUS), RADIUS)
    assert power_within_angle(behind, behind.half_angle) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("lens", ["tan", "sine"])
@pytest.mark.parametrize("profile", [*DENSITY, "table"])
def test_the_grid_carries_the_power_through_the_pupil(profile, lens):
    """All but the staircase rim, which shrinks like 1/n_div."""
    if profile == "table":
        scene = table_of([0, 0.4, 0.8, 1.1], [0.5, 1, 0.6, 0.2], lens)
    else:
        scene = scene_with(profile, lens)
    whole = cone(scene).power
    for divisions in (25, 100, 400):
        fine = scene.replace(beam={"divisions": divisions})
        powers = grid(fine.lens, fine.beam, fine.medium).powers
        assert abs(powers.sum() - whole) < 3 * whole / divisions
        assert (powers >= 0).all()


@pytest.mark.parametrize("lens", ["tan", "sine"])
@pytest.mark.parametrize("profile", DENSITY)
def test_intensity_in_the_pupil(profile, lens):
    scene = scene_with(profile, lens)
    rho = np.linspace(0, RADIUS, 57)
    expected = [0.1 * DENSITY[profile](x, 0.4 * RADIUS) for x in rho]
    found = intensity(scene.lens, scene.beam, scene.medium)(rho)
    np.testing.assert_allclose(found, expected, rtol=1e-14)


@pytest.mark.parametrize("lens", ["tan", "sine"])
@pytest.mark.parametrize("profile", ["gaussian", "donut"])
def test_a_sampled_beam_is_the_beam(profile, lens):
    """Cubics between 200 points of a beam, out to where it is dark, make the same light of it."""
    radii = np.linspace(0, 6 * 0.4, 200)
    points = [DENSITY[profile](rho, 0.4) for rho in radii]
    exact, sampled = cone(scene_with(profile, lens)), cone(table_of(radii, points, lens))
    assert sampled.half_angle == exact.half_angle
    assert sampled.power == pytest.approx(exact.power, rel=1e-4)
    assert sampled.deviation < 1e-3
    cosine = np.cos(np.linspace(0, exact.half_angle, 301))
    largest = exact.radiance(cosine).max()
    assert np.abs(sampled.radiance(cosine) - exact.radiance(cosine)).max() < 1e-3 * largest


@pytest.mark.parametrize("lens", ["tan", "sine"])
def test_a_table_of_equal_points_is_uniform(lens):
    exact = cone(scene_with("uniform", lens).replace(beam={"power_through_pupil": 0.05}))
    sampled = cone(table_of([0, 0.3, 1, 3], [7, 7, 7, 7], lens, power=0.45))
    assert sampled.power == pytest.approx(0.05, rel=1e-14)
    cosine = np.cos(np.linspace(0, exact.half_angle, 101))
    np.testing.assert_allclose(sampled.radiance(cosine), exact.radiance(cosine), rtol=1e-3)


@pytest.mark.parametrize("lens", ["tan", "sine"])
def test_a_table_is_the_same_light_on_the_grid_and_in_the_cone(lens):
    """Its series: within 1 % of the points, and the power exact."""
    radii, points = [0, 0.2, 0.4, 0.6, 0.8, 0.9, 1.2], [0.5, 1, 1, 0.8, 0.6, 0.2, 0]
    scene = table_of(radii, points, lens)
    behind = cone(scene)
    assert behind.deviation < 0.01
    assert power_within_angle(behind, behind.half_angle) == pytest.approx(behind.power, rel=1e-10)
    of = intensity(scene.lens, scene.beam, scene.medium)
    rho = np.array(radii[:-1]) * RADIUS
    found = of(rho) / of(rho)[1]
    np.testing.assert_allclose(found, points[:-1], rtol=0, atol=0.01)
    through = power_within_radius(lambda x: float(of(np.array(x))), RADIUS)
    assert through == pytest.approx(behind.power, rel=1e-8)
    for theta in (0.2, 0.5, 0.8):
        rho = min(pupil_radius(theta, lens), RADIUS)
        part = power_within_radius(lambda x: float(of(np.array(x))), rho)
        assert power_within_angle(behind, theta) == pytest.approx(part, rel=1e-8)


@pytest.mark.parametrize("lens", ["tan", "sine"])
def test_a_table_may_end_inside_the_pupil(lens):
    scene = table_of([0, 0.1, 0.2, 0.3, 0.5], [1, 0.9, 0.8, 0.7, 0.4], lens)
    behind = cone(scene)
    assert pupil_radius(behind.half_angle, lens) == pytest.approx(RADIUS / 2, rel=1e-12)
    assert behind.power == 0.1
    of = intensity(scene.lens, scene.beam, scene.medium)
    assert of(np.array([0.4999, 0.5001]) * RADIUS)[1] == 0 < of(np.array([0.4999]) * RADIUS)[0]
    rays = grid(scene.lens, scene.beam, scene.medium)
    np.testing.assert_array_equal(
        rays.powers > 0, rays.directions[2] > math.cos(behind.half_angle) * (1 - 1e-12)
    )


@pytest.mark.parametrize("factor", [1e-90, 1e-10, 1e10, 1e99])
def test_the_unit_of_a_table_does_not_matter(factor):
    points = np.array([1, 0.8, 0.4, 0.1])
    behind = cone(table_of([0, 0.5, 0.9, 1.2], points))
    scaled = cone(table_of([0, 0.5, 0.9, 1.2], factor * points))
    np.testing.assert_allclose(scaled.series, behind.series, rtol=0, atol=1e-13 * behind.power)


#: id: (radii, intensities, the line)
REFUSED = {
    "step": ([0, 0.5, 0.5001, 1], [1, 1, 0, 0], "beam.profile_intensity: points too uneven; "),
    "spike": ([0, 0.4, 0.400001, 0.400002, 1], [0, 0, 1, 0, 0], "points too uneven; a series of "),
    "light beside the pupil": ([0, 1, 2, 3], [0, 0, 1, 0], "no light within lens.radius = 0.0026"),
    "next to no light": ([0, 1, 2, 3], [1e-120, 1e-120, 1, 1], "no light within lens.radius = "),
}


@pytest.mark.parametrize(("radii", "points", "line"), REFUSED.values(), ids=REFUSED.keys())
@pytest.mark.parametrize("lens", ["tan", "sine"])
@pytest.mark.parametrize("measured", ["power", "power_through_pupil"])
def test_tables_that_are_refused(radii, points, line, lens, measured):
    scene = table_of(radii, points, lens).replace(beam={measured: 0.1})
    for function in (cone, lambda scene: intensity(scene.lens, scene.beam, scene.medium)):
        with pytest.raises(SceneError) as refused:
            function(scene)
        assert line in str(refused.value)
        assert len(str(refused.value).splitlines()) == 1
    for dark in (scene.replace(beam={measured: 0}), scene.replace(forces={"optical": False})):
        behind = cone(dark)
        assert (behind.power, behind.radiance(np.array(0.9)).item()) == (0, 0)
        assert not tweezer.optical_force(dark, [1e-6, 0, 0]).any()


def test_a_refused_table_is_one_line_on_the_command_line(command_line):
    """Exit code 2, nothing written, though the scene itself could be read."""
    Path("scene.toml").write_text(
        """
        bead = { radius = 5e-6, density = 1050, refractive_index = 1.57 }
        medium = { refractive_index = 1.33, density = 1e3, viscosity = 1e-3, temperature = 293 }
        lens = { map = "sine", radius = 2.6e-3, numerical_aperture = 1.2 }
        start = { position = [0, 0, 0] }
        simulation = { duration = 1e-3 }
        [beam]
        wavelength = 8e-7
        power = 0.1
        profile = "table"
        profile_radius = [0, "1 mm", "1.001 mm", "2 mm"]
        profile_intensity = [1, 1, 0, 0]
        """
    )
    outcome = command_line("run", "scene.toml")
    assert outcome.code == 2
    (line,) = outcome.err.splitlines()
    assert line.startswith("beam.profile_intensity: points too uneven; a series of degree 120")
    assert not outcome.out
    assert [path.name for path in Path().iterdir()] == ["scene.toml"]


@pytest.mark.filterwarnings("ignore:beam.profile_intensity. points so uneven")
def test_the_light_of_every_profile_exerts_a_finite_force():
    for lens in LENSES:
        scenes = [scene_with(profile, lens) for profile in DENSITY]
        scenes.append(table_of([0, 0.2, 0.5, 0.9], [0, 1, 1, 0], lens))
        for scene in scenes:
            force = light_force(scene).field(np.array([[1e-6, 0.0, 2e-6]])).force
            assert np.isfinite(force).all()
            assert force.any()


def test_uneven_points_are_told():
    smooth = table_of(np.linspace(0, 1, 21), np.exp(-(np.linspace(0, 1, 21) ** 2)))
    uneven = table_of([0, 0.1, 0.2, 0.9], [0, 1, 1, 0])
    off = 100 * cone(uneven).deviation
    assert off > 0.1
    with pytest.warns(PhysicsWarning, match=f"points so uneven .* up to {off:.2g} % of the peak"):
        light_force(uneven)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.filterwarnings("ignore", "the bead is")
        light_force(smooth)
