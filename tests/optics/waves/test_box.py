"""Maps of light without an axis: the certificate, the reading, and scenes that use them.

Oracles: sums of plane waves in closed form, the quadrature, plane waves without partial waves.
"""

import math

import numpy as np
import pytest

import tweezer
from tests.optics.waves.test_pupil import EVEN, ONE, of_hologram, reference
from tests.reference.plane_waves import Sphere, push
from tweezer import SceneError
from tweezer.cli.app import with_thermal_motion
from tweezer.compiled import address
from tweezer.forces.data import Part
from tweezer.forces.force import KERNEL, Wrench, evaluated
from tweezer.optics import force_map, light_force
from tweezer.optics.beyond import unreached
from tweezer.optics.table import _load, _save
from tweezer.optics.waves import box
from tweezer.optics.waves.box import Region, Spline, _fit, _remainder, build, read_alone
from tweezer.optics.waves.lattice import Lattice

BAND = np.array([1.8, 1.8, 0.6])
LOW, HIGH = np.array([-7.0, -6.0, -8.0]), np.array([5.0, 6.0, 9.0])
SMALL = {"evaluator": "map", "table_range": "0.4 um", "table_tolerance": 1e-5}
UNEVEN = EVEN.replace(beam={"aberration": [[3, 1, 0.1], [2, -2, 0.1]]})


def norm(vectors):
    return np.linalg.norm(vectors, axis=-1)


class Field:
    """A sum of waves with random vectors in the band, and its gradient, in closed form."""

    def __init__(self, band=BAND, count=60, error=1e-13, components=3):
        rng = np.random.default_rng(7)
        self.vectors = rng.uniform(-band, band, (count, 3))
        self.vectors[:6] = np.vstack([np.diag(band), -np.diag(band)])
        self.sizes = rng.normal(size=(count, components)) / count
        self.phases = rng.uniform(0, 2 * math.pi, count)
        self.error = error

    def __call__(self, places):
        turned = np.cos(places @ self.vectors.T + self.phases)
        force = turned @ self.sizes
        empty = np.zeros((0, 3, 3))
        return Wrench(force[:, :3], force[:, 3:], empty, empty, np.full(len(places), self.error))

    def gradient(self, places):
        slopes = -np.sin(places @ self.vectors.T + self.phases)
        return np.einsum("ps,sk,sj->pkj", slopes, self.sizes, self.vectors)


def of_field(field, tolerance=1e-7, **how):
    about = {"region": Region(BAND, LOW, HIGH), "reach": 5.0, "moment": False} | how
    return build(field, tolerance=tolerance, **about)


@pytest.fixture(scope="module")
def places():
    """Random places of the box, and places on its faces, edges and corners."""
    rng = np.random.default_rng(11)
    inside = rng.uniform(LOW, HIGH, (2000, 3))
    ends = (1 - 1e-12) * np.where(rng.random((200, 3)) < 0.5, LOW, HIGH)
    faces = np.where(rng.random((200, 3)) < 0.6, ends, inside[:200])
    return np.vstack([inside, faces, ends[:8]])


# --- the certificate ------------------------------------------------------------------------------


@pytest.mark.parametrize("tolerance", [1e-4, 1e-7, 1e-9])
def test_error_is_below_the_certificate_and_the_tolerance(tolerance, places):
    field = Field()
    made = of_field(field, tolerance)
    error = norm(read_alone(made, places).force - field(places).force).max()
    assert error < made.certified < tolerance * made.largest
    assert made.certified < 30 * error  # the bound is not far above what it bounds
    assert made.largest == pytest.approx(norm(field(places).force).max(), rel=0.2)


@pytest.mark.parametrize("wider", [1.05, 2.0])
def test_certificate_contains_the_error_of_waves_outside_the_band(wider, places):
    """The theorem does not hold for this field, and the comparisons find that."""
    field = Field(wider * BAND)
    made = of_field(field, 1e-7)
    error = norm(read_alone(made, places).force - field(places).force).max()
    assert error < made.certified
    if wider > 1.5:
        assert made.certified > 1e-7 * made.largest


@pytest.mark.parametrize("tolerance", [1e-4, 1e-7])
def test_theorem_alone_bounds_the_error(tolerance, places, monkeypatch):
    monkeypatch.setattr(box, "_compared", lambda *_: (0.0, 0.0))
    field = Field()
    made = of_field(field, tolerance)
    error = norm(read_alone(made, places).force - field(places).force).max()
    assert error < made.certified < tolerance * made.largest


def test_certificate_contains_the_error_of_the_force_itself():
    """Errors of samples with the worst signs add up."""
    assert of_field(Field(error=1e-6)).certified > 5e-6


def test_remainder_bounds_the_polynomial_through_chebyshev_nodes():
    x = np.linspace(-1, 1, 1001)
    for phase in (0.5, 3.0, 20.0, 80.0):
        for nodes in (4, 12, 24, 40, 100):
            for turn in (0.0, 0.7, math.pi / 2):
                found = np.polynomial.Chebyshev.interpolate(
                    lambda u, b=phase, t=turn: np.cos(b * u + t), nodes - 1
                )
                error = np.abs(found(x) - np.cos(phase * x + turn)).max()
                assert error <= _remainder(phase, nodes) + 1e-13


def test_difference_of_the_spline_is_that_of_scipy():
    """The largest difference between the places that are searched is not much larger."""
    from scipy.interpolate import BSpline

    nodes, count, phase = 40, 30, 14.0
    fit = _fit(nodes, count)
    t = np.polynomial.chebyshev.chebpts1(nodes)
    coefficients = fit.coefficients @ np.cos(phase * t)
    knots = -1 + 2 / count * np.arange(-7, count + 8)
    x = np.linspace(-1, 1, 20011)
    error = np.abs(BSpline(knots, coefficients, 7)(x) - np.cos(phase * x)).max()
    found = np.abs(fit.difference @ np.cos(phase * t)).max()
    assert found <= error <= 1.2 * found


# --- reading --------------------------------------------------------------------------------------


def test_gradient_and_torque_are_those_of_the_field(places):
    field = Field(components=6)
    made = of_field(field, moment=True)
    unit, strength = 0.25, 3.0
    kernel = address(made.kernel(gradient=True), KERNEL)
    reader = Part(kernel, made.data(unit, strength, unreached()))
    read = evaluated(reader, unit * places, True)
    exact, slopes = field(places), field.gradient(places)
    for found, expected in (
        (read.force, strength * exact.force),
        (read.moment, strength * unit * exact.moment),
        (read.force_gradient, strength / unit * slopes[:, :3]),
        (read.moment_gradient, strength * slopes[:, 3:]),
    ):
        np.testing.assert_allclose(found, expected, rtol=0, atol=3e-6 * np.abs(expected).max())
    assert (read.error == made.certified * strength).all()


def test_only_places_in_the_box_are_read():
    made = of_field(Field(), 1e-4)
    edge = np.array([LOW, HIGH, [LOW[0], 0, 0], [0, 0, HIGH[2]]])
    assert np.isfinite(read_alone(made, edge * (1 - 1e-12)).error).all()
    outside = edge * (1 + 1e-12)
    assert np.isinf(read_alone(made, np.vstack([outside, [[np.nan, 0, 0]]])).error).all()


def test_table_is_read_as_it_was_made(tmp_path):
    made = of_field(Field(), 1e-3)
    _save(tmp_path / "one.table", "key", made)
    read = _load(tmp_path / "one.table", "key", Spline)
    for name, value in vars(made).items():
        assert type(getattr(read, name)) is type(value), name
        assert np.array_equal(getattr(read, name), value)


def test_progress_rises_to_the_end():
    parts = []
    of_field(Field(), 1e-3, progress=parts.append)
    assert parts == sorted(parts)
    assert parts[-1] == 1.0


# --- scenes ---------------------------------------------------------------------------------------


def cylindrical(order):
    return EVEN.replace(beam={"polarisation": "cylindrical", "order": order, "jones": None})


SCENES = {
    "aberrations": (UNEVEN, Spline),
    "absorbing bead": (
        UNEVEN.replace(bead={"refractive_index": "1.5+0.01j"}, beam={"polarisation": "circular"}),
        Spline,
    ),
    "foci": (of_hologram([{"position": [0.5e-6, 0, 0]}, {"position": [-0.3e-6, 0.2e-6, 0.4e-6]}]),
             Spline),
    "foci on the axis": (of_hologram([{"position": [0, 0, z]} for z in (4e-7, -4e-7)]), Spline),
    "cylindrical 2": (cylindrical(2), Lattice),
    "cylindrical 3": (cylindrical(3), Spline),
    "cover": (UNEVEN.replace(
        lens={"cover": {"refractive_index": 1.518, "depth": "2 um"}}), Spline),
}  # fmt: skip


@pytest.mark.usefixtures("cache_folder")
@pytest.mark.parametrize("name", SCENES)
def test_map_of_every_light_is_its_force_within_the_certificate(name):
    scene, kind = SCENES[name]
    mapped = scene.replace(optics=SMALL)
    made = force_map(mapped)
    assert isinstance(made.made, kind)
    assert made.certified_error < 1e-5 * made.largest_force
    rng = np.random.default_rng(3)
    foci = light_force(scene).foci()
    places = foci[rng.integers(len(foci), size=500)] + rng.uniform(-0.23e-6, 0.23e-6, (500, 3))
    read, exact = (light_force(each).field(places, gradient=True) for each in (mapped, scene))
    np.testing.assert_allclose(read.error, made.certified_error, rtol=1e-12)
    assert norm(read.force - exact.force).max() < made.certified_error
    for found, expected in (
        (read.force_gradient, exact.force_gradient), (read.moment, exact.moment),
        (read.moment_gradient, exact.moment_gradient),
    ):  # fmt: skip
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-3 * np.abs(expected).max())
    assert scene.bead.absorbs == bool(read.moment.any())
    outside = foci[:1] + np.array([[0.6e-6, 0, 0], [0, 2e-6, 0], [0, 0, -2e-6]])
    read, exact = (light_force(each).field(outside) for each in (mapped, scene))
    beyond = read.error != made.certified_error
    assert beyond.any()
    np.testing.assert_array_equal(read.force[beyond], exact.force[beyond])


@pytest.mark.usefixtures("cache_folder")
def test_map_is_the_force_of_plane_waves():
    terms = [(3, 1, 0.1), (2, -2, 0.1)]
    scene = UNEVEN.replace(beam={"polarisation": "circular"}, optics=SMALL)
    places = np.array([[0.2, -0.15, 0.25], [0.3, 0.3, -0.2], [0, 0, 0.3]]) * 1e-6
    light = reference(terms, polarisation=(ONE, ONE * 1j))
    expected = push(light, Sphere(((0.5e-6, 1.45),)), places).force
    found = tweezer.optical_force(scene, places)
    assert norm(found - expected).max() < force_map(scene).certified_error


@pytest.mark.usefixtures("cache_folder")
def test_stored_map_serves_every_power_and_another_radius_gets_its_own():
    scene = UNEVEN.replace(optics=SMALL)
    first = force_map(scene)
    double = scene.replace(beam={"power_through_pupil": 2.0})
    again = force_map(double)
    assert first.path == again.path
    assert again.largest_force == pytest.approx(2 * first.largest_force, rel=1e-12)
    smaller = light_force(scene).lights[0].of_radius(0.45e-6)
    place = np.array([[0.1e-6, 0.05e-6, 0.1e-6]])
    expected = tweezer.optical_force(
        UNEVEN.replace(bead={"diameter": 0.9e-6}, optics={"evaluator": "auto"}), place
    )
    assert norm(smaller.field(place).force - expected).max() < 1e-5 * first.largest_force


def test_map_about_distant_foci_is_refused_in_one_line():
    corners = [{"position": [a * 1.2e-5, b * 1.2e-5, c * 1.2e-5]}
               for a in (-1, 1) for b in (-1, 1) for c in (-1, 1)]  # fmt: skip
    scene = of_hologram(corners).replace(optics={"evaluator": "map"})
    with pytest.raises(SceneError, match=r"optics\.table_range: .* are too many") as refusal:
        force_map(scene)
    assert "\n" not in str(refusal.value)
    automatic = scene.replace(optics={"evaluator": "auto"})
    assert with_thermal_motion(automatic, {}).optics.evaluator == "auto"
    with pytest.raises(SceneError, match="are too many"):  # as asked for
        light_force(with_thermal_motion(scene, {}))


def test_thermal_motion_between_distant_coherent_foci_is_without_a_map():
    """Two beams 30 um apart across, and the same beams 1 um apart."""
    evaluators = []
    for apart in (15e-6, 0.5e-6):
        described = EVEN.model_dump(exclude_none=True)
        described.pop("more_beams")
        beams = [
            {**described["beam"], "coherent": "a", "position": [sign * apart, sign * apart, 0]}
            for sign in (-1, 1)
        ]
        scene = tweezer.load_scene({**described, "beam": beams})
        evaluators.append(with_thermal_motion(scene, {"optics.table_range": "2 um"}))
    assert [each.optics.evaluator for each in evaluators] == ["auto", "map"]


# --- what uses the force --------------------------------------------------------------------------

HELD = UNEVEN.replace(
    beam={"power_through_pupil": "5 mW"}, start={"position": [1e-7, -1e-7, 1e-7]},
    optics={"tolerance": 1e-9},
)  # fmt: skip
MAPPED = HELD.replace(optics={"evaluator": "map", "table_range": "0.6 um"})


@pytest.fixture(scope="module")
def kept(tmp_path_factory):
    """A cache folder for the map of several tests."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(tmp_path_factory.mktemp("cache")))
        yield


@pytest.mark.usefixtures("kept")
@pytest.mark.parametrize("thermal", [False, True])
def test_run_by_the_map_is_the_run_by_the_quadrature(thermal):
    how = {"model": "overdamped", "seed": 5 if thermal else None}
    runs = [
        tweezer.simulate(each.replace(forces={"brownian": thermal}), "100 us", **how)
        for each in (HELD, MAPPED)
    ]
    exact, read = (each.position.values for each in runs)
    assert norm(exact[-1] - exact[0]) > 1e-9
    softest = tweezer.characterise(MAPPED).stiffness_xyz.min()
    allowed = force_map(MAPPED).certified_error / softest
    assert norm(read - exact).max() < 2 * allowed + 2e-11


@pytest.mark.usefixtures("kept")
def test_trap_by_the_map_is_the_trap_by_the_quadrature():
    exact, read = tweezer.characterise(HELD), tweezer.characterise(MAPPED)
    error = force_map(MAPPED).certified_error
    assert read.evaluator == "map"
    assert read.force_error >= error
    shift = norm(np.subtract(read.equilibrium.position, exact.equilibrium.position))
    assert shift < error / exact.equilibrium.eigenvalues[0]
    np.testing.assert_allclose(
        read.stiffness, exact.stiffness, rtol=0, atol=1e-5 * exact.stiffness.max()
    )


def test_thermal_commands_use_a_map_if_the_light_has_one():
    beam = EVEN.beam.model_dump(exclude_none=True) | {"coherent": "pair"}
    moving = {**beam, "direction": "down", "phasing": {"kind": "ramp", "rate": 50.0}}
    pair = EVEN.model_dump(exclude_none=True) | {"beam": [beam, moving]}
    pair.pop("more_beams")
    coherent = tweezer.load_scene(pair)
    found = [with_thermal_motion(scene, {}).optics.evaluator for scene in (UNEVEN, coherent)]
    assert found == ["map", "auto"]
