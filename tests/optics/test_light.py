"""The sum over the thesis's rays against the same written plainly, and its symmetries."""

import warnings

import numpy as np
import pytest

import tweezer
from tests.reference import memory
from tests.reference.ray_sum import force_and_moment, lens_squares
from tests.reference.raytracer import trace
from tweezer.generated import ray
from tweezer.optics import evaluators_of, fraction_through_pupil, grid, light_force, total_power
from tweezer.optics.binding import _warn_once
from tweezer.optics.rays.grid import TILE, near, tiles
from tweezer.optics.rays.ray_sum import TOTAL_REFLECTION

BEADS = ["thesis-500nm", "thesis-990nm", "thesis-1950nm"]


@pytest.fixture(scope="module", params=BEADS)
def scene(request):
    return tweezer.load_scene(request.param).replace(beam={"torque": "thesis"})


def places(scene, count=6, seed=50):
    """Inside, at the edge, outside, and the thesis's start."""
    rng = np.random.default_rng(seed)
    directions = rng.normal(size=(count, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    distances = np.array([0.1, 0.6, 0.99, 1.01, 2.0, 5.0])[:count, None] * scene.bead.radius
    return np.vstack([directions * distances, scene.start_position])


def test_grid_is_the_thesis_grid(scene):
    """n_div = 100 with whole squares: 7644 rays, in the order of no consequence."""
    rays = grid(scene.lens, scene.beam, scene.medium)
    assert rays.powers.size == 7644
    squares, _ = lens_squares(scene.lens.radius, 100)
    assert len(squares) == 7644
    np.testing.assert_allclose(np.linalg.norm(rays.directions, axis=0), 1, rtol=1e-14)


def test_force_and_moment_are_the_readable_sum(scene):
    positions = places(scene)
    forces = tweezer.optical_force(scene, positions)
    moments = tweezer.optical_torque(scene, positions)
    for position, force, moment in zip(positions, forces, moments, strict=True):
        expected, expected_moment = force_and_moment(scene, position)
        # (3.8) subtracts squares of millimetres to find micrometres: about 1e-8 is lost there
        scale = 1e-7 * np.abs(expected).max()
        np.testing.assert_allclose(force, expected, rtol=0, atol=scale)
        np.testing.assert_allclose(moment, expected_moment, rtol=0, atol=scale * scene.bead.radius)


def test_power_through_the_pupil(scene):
    """The 500 nm beam overfills the lens: 41 % of it passes, 63.8 mW on the grid."""
    rays = grid(scene.lens, scene.beam, scene.medium)
    through = fraction_through_pupil(scene.lens, scene.beam) * total_power(scene.lens, scene.beam)
    assert rays.powers.sum() == pytest.approx(through, rel=0.025)  # the staircase rim
    if scene.name == "thesis-500nm":
        assert rays.powers.sum() == pytest.approx(63.8e-3, abs=0.05e-3)
    fixed = scene.replace(beam={"power_through_pupil": through})
    assert total_power(fixed.lens, fixed.beam) == pytest.approx(0.156, rel=1e-12)


@pytest.mark.parametrize("polarisation", ["circular", "averaged-reflectance"])
@pytest.mark.parametrize("index", [1.0, 1.2, 1.45, 1.57773])
def test_jacobian_is_the_derivative(index, polarisation):
    """Of force and moment, where no ray begins or ceases to hit; totally reflected rays too."""
    scene = tweezer.load_scene("thesis-990nm").replace(
        bead={"refractive_index": index},
        beam={"torque": "thesis", "polarisation": polarisation},
    )
    position = np.array([0.2, -0.3, 0.1]) * scene.bead.radius
    if index < 1.33:  # far enough out that some rays are totally reflected, none missing
        position = np.array([0.0, 0.0, 0.97]) * scene.bead.radius
        u = grid(scene.lens, scene.beam, scene.medium).directions
        S = 0.97**2 * (1 - u[2] ** 2)
        assert ((index / 1.33) ** 2 < S).any() == (index == 1.0)
        assert S.max() < 1
    step = 1e-6 * scene.bead.radius
    shifts = step * np.eye(3)
    for function, derivative in (
        (tweezer.optical_force, tweezer.optical_jacobian(scene, position)),
        (
            tweezer.optical_torque,
            light_force(scene).field(position[None], gradient=True).moment_gradient[0],
        ),
    ):
        differences = (function(scene, position + shifts) - function(scene, position - shifts)) / (
            2 * step
        )
        # at total reflection Q has a square root: the few rays that cross it within a step show
        tolerance = 3e-4 if index == 1.0 else 2e-7
        np.testing.assert_allclose(
            derivative, differences.T, rtol=0, atol=tolerance * np.abs(derivative).max()
        )


@pytest.mark.parametrize("polarisation", ["circular", "averaged-reflectance"])
@pytest.mark.parametrize("map_", ["tan", "sine"])
def test_force_is_the_sum_of_traced_rays(map_, polarisation):
    """Each ray of a coarse grid followed bounce by bounce."""
    scene = tweezer.load_scene("thesis-990nm").replace(
        lens={"map": map_}, beam={"polarisation": polarisation, "divisions": 20}
    )
    rays = grid(scene.lens, scene.beam, scene.medium)
    averaged = polarisation == "averaged-reflectance"
    for radii in ([0.3, -0.5, 0.2], [1.0, 0.8, -1.5]):
        position = np.array(radii) * scene.bead.radius
        total = np.zeros(3)
        for direction, power in zip(rays.directions.T, rays.powers, strict=True):
            traced = trace(direction, position, scene.bead.radius, 1.33, 1.57773, averaged=averaged)
            if traced is not None:
                total += 1.33 * power / 299792458.0 * traced.force
        np.testing.assert_allclose(
            tweezer.optical_force(scene, position), total, rtol=0, atol=1e-11 * np.abs(total).max()
        )


def test_no_ray_is_lost_to_rounding_at_total_reflection():
    """What the kernel does not take as totally reflected has a finite efficiency."""
    rng = np.random.default_rng(51)
    refracted = 0
    for n_mP in rng.uniform(1.0, 1.6, 4000):
        critical = 1 / n_mP**2
        for ulps in range(-20, 7):
            S = critical * (1 + ulps * 2.0**-53)
            if ray.cos_squared_beta(S, n_mP) < TOTAL_REFLECTION or S >= 1:
                continue
            refracted += 1
            values = (*ray.circular_rates(S, n_mP), *ray.averaged_reflectance_rates(S, n_mP))
            assert np.isfinite(values).all(), (n_mP, S)
    assert refracted > 100


def test_force_scales_with_power_and_not_with_size(scene):
    """Linear in power; the same with all lengths of the bead's surroundings scaled."""
    position = np.array([0.4, 0.1, -0.5]) * scene.bead.radius
    force = tweezer.optical_force(scene, position)
    brighter = scene.replace(beam={"power": 2 * scene.beam.power})
    np.testing.assert_allclose(tweezer.optical_force(brighter, position), 2 * force, rtol=1e-14)
    larger = scene.replace(bead={"radius": 3 * scene.bead.radius})
    np.testing.assert_allclose(tweezer.optical_force(larger, 3 * position), force, rtol=1e-12)


@pytest.mark.parametrize("evaluator", ["grid", "quadrature"])
def test_the_light_on_a_bead_of_another_radius_is_that_of_its_scene(evaluator):
    scene = tweezer.load_scene("silica-1um").replace(optics={"evaluator": evaluator})
    larger = light_force(scene.replace(bead={"radius": "0.7 um"}))
    positions = places(scene)[:-1]
    np.testing.assert_allclose(
        light_force(scene).of_radius(0.7e-6).field(positions).force,
        larger.field(positions).force,
        rtol=1e-14,
    )


def test_force_has_the_symmetry_of_the_square_grid(scene):
    """Quarter turns about the axis and mirrors through it."""
    position = np.array([0.4, 0.15, -0.5]) * scene.bead.radius
    force = tweezer.optical_force(scene, position)
    atol = 1e-13 * np.abs(force).max()
    quarter = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]])
    mirror = np.diag([-1, 1, 1])
    for symmetry in (quarter, mirror):
        turned = tweezer.optical_force(scene, symmetry @ position)
        np.testing.assert_allclose(turned, symmetry @ force, atol=atol)


@pytest.mark.parametrize("polarisation", ["circular", "averaged-reflectance"])
@pytest.mark.parametrize("index", [1.0, 1.2, 1.33, 1.5, 2.5])
def test_any_index(index, polarisation):
    """Above, at and below the medium's index: finite, and exactly zero at equal indices."""
    scene = tweezer.load_scene("silica-1um").replace(
        bead={"refractive_index": index},
        medium={"refractive_index": 1.33},
        beam={"polarisation": polarisation, "torque": "thesis"},
    )
    positions = np.vstack([np.zeros(3), places(scene)])
    field = light_force(scene).field(positions, gradient=True)
    for values in (field.force, field.moment, field.force_gradient, field.moment_gradient):
        assert np.isfinite(values).all()
        assert values.any() == (index != 1.33)


@pytest.mark.parametrize("name", ["thesis-500nm", "silica-1um"])
def test_a_bead_beside_the_cone_of_light_is_left_alone(name):
    """Just outside the outermost rays there is no force, just inside there is one."""
    scene = tweezer.load_scene(name).replace(
        beam={"torque": "thesis"}, optics={"evaluator": "grid"}
    )
    widest = np.arccos(grid(scene.lens, scene.beam, scene.medium).directions[2].min())
    distance = 4 * scene.bead.radius
    tangent = widest + np.arcsin(1 / 4)
    for side in (1, -1):  # before and behind the focus
        for shift, lit in ((1e-9, False), (-1e-3, True)):
            angle = tangent + shift
            azimuths = np.linspace(0, 2 * np.pi, 721)
            around = distance * np.column_stack(
                [
                    np.sin(angle) * np.cos(azimuths),
                    np.sin(angle) * np.sin(azimuths),
                    np.full(721, side * np.cos(angle)),
                ]
            )
            field = light_force(scene).field(around, gradient=True)
            assert field.force.any() == lit
            assert field.moment.any() == lit
            assert field.force_gradient.any() == lit


@pytest.mark.parametrize("divisions", [4, 25, 100])
def test_no_tile_with_a_ray_that_hits_is_left_out(divisions):
    """Every ray that hits by |u x p| < r is among those that are looked at, before and behind."""
    scene = tweezer.load_scene("silica-1um").replace(
        beam={"divisions": divisions}, optics={"evaluator": "grid"}
    )
    rays = grid(scene.lens, scene.beam, scene.medium)
    source = tiles(rays.directions, rays.powers)
    rng = np.random.default_rng(52)
    seen = np.empty((0, 3))
    for position in rng.normal(size=(300, 3)) * rng.uniform(0.2, 8, (300, 1)):
        hits = np.linalg.norm(np.cross(rays.directions.T, position), axis=1) < 1
        looked_at = [near(source, tile, *position, 1.0) for tile in range(source.spread_cos.size)]
        u1, u2, _, weight = source.rays[:, np.repeat(looked_at, TILE)]
        lit = set(zip(u1[weight > 0], u2[weight > 0], strict=True))
        assert {(u1, u2) for u1, u2, _ in rays.directions.T[hits]} <= lit
        seen = np.vstack([seen, [hits.sum(), len(lit), hits.size]])
    if divisions == 100:
        far = seen[(seen[:, 0] > 0) & (seen[:, 0] < 0.02 * seen[:, 2])]
        assert len(far) > 20
        assert (far[:, 1] < 0.15 * far[:, 2]).all()  # and few that do not hit


def test_light_pushes_a_bead_on_the_axis_along_itself():
    """A bead in front of the focus on the axis: no lateral force, and upwards."""
    scene = tweezer.load_scene("silica-1um")
    force = tweezer.optical_force(scene, [0, 0, -3e-6])
    assert force[2] > 0
    assert np.abs(force[:2]).max() < 1e-12 * force[2]


def test_sine_map_reaches_the_aperture_and_tan_the_rim():
    """Error 10: tan(theta) = R/f gives 52.4 degrees, NA 1.3 in n 1.33 means 77.8."""
    tan = tweezer.load_scene("thesis-990nm").replace(beam={"divisions": 2000})
    sine = tan.replace(lens={"map": "sine"})
    for scene, angle in ((tan, 52.43), (sine, 77.82)):
        rays = grid(scene.lens, scene.beam, scene.medium)
        widest = np.degrees(np.arccos(rays.directions[2].min()))
        assert angle - 0.2 < widest < angle


def test_no_torque_by_default_and_no_rays_in_the_dark():
    scene = tweezer.load_scene("thesis-990nm")
    assert not tweezer.optical_torque(scene, [3e-7, 0, 0]).any()
    for dark in (scene.replace(beam={"power": 0}), scene.replace(forces={"optical": False})):
        assert evaluators_of(dark) == "dark"
        assert not tweezer.optical_force(dark, [3e-7, 0, 0]).any()


def test_shapes_in_and_out():
    scene = tweezer.load_scene("thesis-990nm")
    positions = np.zeros((2, 5, 3))
    assert tweezer.optical_force(scene, positions).shape == (2, 5, 3)
    assert tweezer.optical_torque(scene, positions).shape == (2, 5, 3)
    assert tweezer.optical_jacobian(scene, positions).shape == (2, 5, 3, 3)
    assert tweezer.optical_force(scene, np.empty((0, 3))).shape == (0, 3)
    for bad in ([1.0, 2.0], 3.0, [[np.nan, 0, 0]], [np.inf, 0, 0]):
        with pytest.raises(ValueError, match="positions must"):
            tweezer.optical_force(scene, bad)


@pytest.mark.parametrize("walled", [{"lens": {"cover": {"depth": 3e-6, "refractive_index": 1.5}}},
                                    {"wall": {"position": -3e-6, "opposite": 9e-6}}])  # fmt: skip
def test_no_force_on_a_bead_in_glass(walled):
    scene = tweezer.load_scene("silica-1um").replace(forces={"optical": False}, **walled)
    places = np.zeros((2, 3, 3))
    places[0, 1, 2] = -2.5e-6  # touches
    assert tweezer.optical_force(scene, places).shape == (2, 3, 3)
    places[1, 0] = 1e-6, 0, -2.9e-6
    places[1, 2, 2] = -5e-6
    line = r"at \(1, 0, -2.9\) um a bead of radius 0.5 um reaches into the .* at z = -3 um, where"
    for of in (
        tweezer.optical_force, tweezer.optical_force_error, tweezer.optical_jacobian,
        tweezer.optical_torque, tweezer.absorbed_power,
    ):  # fmt: skip
        with pytest.raises(tweezer.SceneError, match=line):
            of(scene, places)
    if "wall" in walled:
        with pytest.raises(tweezer.SceneError, match="the wall at z = 9 um"):
            tweezer.optical_force(scene, [0, 0, 8.6e-6])


@pytest.mark.parametrize("evaluator", ["grid", "quadrature"])
@pytest.mark.parametrize("polarisation", ["circular", "averaged-reflectance"])
def test_force_does_not_depend_on_what_memory_held(evaluator, polarisation):
    scene = tweezer.load_scene("thesis-990nm").replace(
        optics={"evaluator": evaluator}, beam={"polarisation": polarisation}
    )
    positions = scene.bead.radius * np.array([[0.3, 0.2, 0.9], [1.1, -0.4, -0.8], [0, 0, 3]])
    memory.leave(memory.ZEROS)
    first = tweezer.optical_jacobian(scene, positions)
    memory.leave(memory.NAN)
    np.testing.assert_array_equal(tweezer.optical_jacobian(scene, positions), first)


def test_the_worth_of_ray_optics_is_one_warning():
    """Once in a program, whatever is asked of however many scenes."""
    light_force.cache_clear()
    _warn_once.cache_clear()
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("default")
        scene = tweezer.load_scene("silica-1um")
        for evaluator in ("quadrature", "grid"):
            other = scene.replace(optics={"evaluator": evaluator})
            tweezer.optical_force(other, [0.0, 0.0, 0.0])
        with warnings.catch_warnings():  # forgets what was said
            tweezer.simulate(other, duration=1e-6)
        dark = scene.replace(beam={"power_through_pupil": 0})
        tweezer.optical_force(dark, [0.0, 0.0, 0.0])
    assert [warning.category for warning in said] == [tweezer.PhysicsWarning]
    assert "wavelengths across" in str(said[0].message)
    assert said[0].filename == __file__, "it points at the line of the user"


@pytest.mark.parametrize("evaluator", ["grid", "quadrature"])
def test_to_rays_unpolarised_light_is_as_circular(scene, evaluator):
    place = np.array([0.3, -0.2, 0.4]) * scene.bead.radius
    circular, unpolarised = (
        tweezer.optical_force(
            scene.replace(beam={"polarisation": kind}, optics={"evaluator": evaluator}), place
        )
        for kind in ("circular", "unpolarised")
    )
    np.testing.assert_array_equal(circular, unpolarised)
