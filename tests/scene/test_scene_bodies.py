"""Scenes of bodies that are not spheres: those that are wrong, and their mass, inertia and size.

Every wrong scene is answered with one line on stderr that names the key, and nothing is computed.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.polynomial.legendre import leggauss
from scipy.spatial.transform import Rotation

import tweezer
from tweezer.dynamics.poses import PoseSearch
from tweezer.scene import solids

#: A good scene of a rod, key by key as TOML
GOOD = {
    "bead.shape": '"spheroid"',
    "bead.diameter": '"0.4 um"',
    "bead.length": '"0.8 um"',
    "bead.density": "1050",
    "bead.refractive_index": "1.57",
    "medium.refractive_index": "1.33",
    "medium.density": "998.2",
    "medium.viscosity": '"1 mPa s"',
    "medium.temperature": '"20 degC"',
    "lens.map": '"sine"',
    "lens.radius": '"2.5 mm"',
    "lens.numerical_aperture": "1.2",
    "beam.wavelength": '"1064 nm"',
    "beam.power_through_pupil": '"50 mW"',
    "beam.waist": '"2.5 mm"',
    "beam.polarisation": '"linear"',
    "start.position": "[0, 0, 0]",
    "simulation.duration": '"1 ms"',
}
ABSENT = None
LAYERS = "[{ radius = 3e-7, refractive_index = 1.5 }]"


def sphere(z, *, radius="radius = 1e-7", index="refractive_index = 1.57", more=""):
    position = f"position = [0, 0, {z}]" if z is not None else ""
    return "{ " + ", ".join(each for each in (radius, index, position, more) if each) + " }"


def spheres(*listed, **more):
    """Changes that make the good scene one of a cluster."""
    own = {f"bead.{key}": ABSENT for key in ("diameter", "length", "refractive_index")}
    text = "[" + ", ".join(listed) + "]"
    return {**own, "bead.shape": '"spheres"', "bead.spheres": text, **more}


def shaped(shape):
    """Changes that make the good scene one of another shape."""
    gone = ("diameter", "length", "refractive_index")
    return {**{f"bead.{key}": ABSENT for key in gone}, "bead.shape": f'"{shape}"'}


def profiled(points):
    return {**shaped("profile"), "bead.points": f"[{points}]"}


def matrix(above=0.0, below=0.0):
    """A resistance whose elements couple motion along x and rotation about y."""
    rows = [[(1e-8 if i < 3 else 1e-16) * (i == j) for j in range(6)] for i in range(6)]
    rows[0][4], rows[4][0] = above, below
    return f"resistance = {rows}, "


RESISTANCE = matrix()


def given(more, inertia="[1e-28, 1e-28, 1e-28]", **changes):
    """Changes that make the good scene one of a body with given numbers."""
    numbers = f"{more}mass = 1e-15, volume = 5e-19, inertia = {inertia}"
    own = {"bead.diameter": '"1 um"', "bead.density": ABSENT, "bead.given": f"{{ {numbers} }}"}
    return {**shaped("given"), **own, **changes}


TREAMS = Path(__file__).parents[1] / "data" / "treams-cluster.tmat.h5"
FILE = {
    "bead.shape": '"t-matrix"', "bead.length": ABSENT, "bead.refractive_index": ABSENT,
    "bead.diameter": '"0.4 um"', "bead.file": f'"{TREAMS}"',
}  # fmt: skip
SHAPES = "allowed: 'sphere', 'spheroid', 'spheres', 't-matrix', 'ellipsoid', 'cylinder', "
RANGE = "must be from 1e-18 to 1 m"

#: id: (changes of the good scene, part of the line it is answered with)
BAD = {
    "unknown shape": ({"bead.shape": '"rod"'}, f"bead.shape = 'rod': {SHAPES}"),
    "number as a shape": ({"bead.shape": "3"}, f"bead.shape = 3: {SHAPES}"),
    # length
    "spheroid without length": (
        {"bead.length": ABSENT}, "bead.length: missing; shape = 'spheroid' requires it"
    ),
    "sphere with length": (
        {"bead.shape": ABSENT},
        "bead.length: does not apply to shape = 'sphere'; remove it, or set shape to spheroid",
    ),
    "no length at all": ({"bead.length": "0"}, f"bead.length = 0: {RANGE}"),
    "negative length": ({"bead.length": "-1e-6"}, f"bead.length = -1e-06: {RANGE}"),
    "length without a unit": ({"bead.length": '"0.8"'}, "bead.length = '0.8': has no unit"),
    "length in kilograms": ({"bead.length": '"1 kg"'}, "bead.length = '1 kg': has the wrong unit"),
    "length that is no number": ({"bead.length": "nan"}, "bead.length = nan: must be finite"),
    "list of lengths": ({"bead.length": "[1e-6]"}, "bead.length = [1e-06]: must be a number in m"),
    "too long": (
        {"bead.length": '"2.1 um"'},
        "bead.length = 2.1e-06: is 5.25 times bead.diameter; spheroids are computed from 1/5 to 5",
    ),
    "too flat": ({"bead.length": '"0.06 um"'}, "bead.length = 6e-08: is 0.15 times bead.diameter"),
    "too large": (
        {"bead.diameter": '"10 um"', "bead.length": '"12 um"'},
        "bead.shape = 'spheroid': the body reaches 6e-06 m from its centre; computed up to 3.82e-0",
    ),
    "no diameter": ({"bead.diameter": ABSENT}, "bead.radius or diameter: one is required"),
    "radius and diameter": ({"bead.radius": "1e-7"}, "bead.radius or diameter: give only one"),
    "no index": ({"bead.refractive_index": ABSENT}, "bead.refractive_index: missing"),
    "no density": ({"bead.density": ABSENT}, "bead.density: missing"),
    "spheroid in layers": (
        {"bead.layers": LAYERS, "bead.diameter": ABSENT, "bead.refractive_index": ABSENT},
        "bead.layers: do not apply to shape = 'spheroid'; remove them, or the shape",
    ),
    "spheroid with moments of inertia": (
        {"bead.moments_of_inertia": "[1e-30, 1e-30, 1e-30]"},
        "bead.moments_of_inertia: follow from density and size for shape = 'spheroid'; remove them",
    ),
    "spheroid with a file": (
        {"bead.file": '"body.tmat.h5"'},
        "bead.file: does not apply to shape = 'spheroid'; remove it, or set shape to t-matrix",
    ),
    # clusters
    "cluster without spheres": (
        spheres(**{"bead.spheres": ABSENT}),
        "bead.spheres: missing; shape = 'spheres' requires them",
    ),
    "spheres without the shape": (
        spheres(sphere(0), **{"bead.shape": ABSENT}),
        "bead.spheres: does not apply to shape = 'sphere'; remove it, or set shape to spheres",
    ),
    "empty cluster": (spheres(), "bead.spheres = []: must have 1 to 20 entries"),
    "number of spheres": (spheres(**{"bead.spheres": "2"}), "bead.spheres = 2: must be a list"),
    "too many spheres": (
        spheres(*(sphere(f"{3 * i}e-7") for i in range(21))), ": must have 1 to 20 entries"
    ),
    "spheres that overlap": (
        spheres(sphere("-1e-7"), sphere("0.5e-7"), sphere("3e-7")),
        "bead.spheres: 1 and 2 overlap; their centres are 1.5e-07 m apart and must be at least "
        "2e-07 m apart",
    ),
    "the same sphere twice": (spheres(sphere(0), sphere(0)), "bead.spheres: 1 and 2 overlap"),
    "cluster with a radius": (
        spheres(sphere(0), **{"bead.radius": "1e-7"}),
        "bead.radius = 1e-07: cannot be combined with spheres",
    ),
    "cluster with a length": (
        spheres(sphere(0), **{"bead.length": "1e-7"}),
        "bead.length: does not apply to shape = 'spheres'",
    ),
    "cluster in layers": (
        spheres(sphere(0), **{"bead.layers": LAYERS}),
        "bead.layers: do not apply to shape = 'spheres'",
    ),
    "cluster with moments of inertia": (
        spheres(sphere(0), **{"bead.moments_of_inertia": "[1e-30, 1e-30, 1e-30]"}),
        "bead.moments_of_inertia: follow from density and size for shape = 'spheres'",
    ),
    "sphere without a position": (
        spheres(sphere(None)), "bead.spheres.0.position: missing"
    ),
    "sphere without a radius": (
        spheres(sphere(0), sphere("3e-7", radius="")),
        "bead.spheres.1.radius or diameter: one is required",
    ),
    "sphere without a density": (
        spheres(sphere(0, more="density = 1050"), sphere("3e-7"), **{"bead.density": ABSENT}),
        "bead.density: missing",
    ),
    "sphere of negative density": (
        spheres(sphere(0, more="density = -1")), "bead.spheres.0.density = -1: must be from 1e-06"
    ),
    "sphere of a wrong density, cluster of none": (
        spheres(sphere(0, more='density = "heavy"'), **{"bead.density": ABSENT}),
        "bead.spheres.0.density = 'heavy': must be a number",
    ),
    "sphere without an index": (
        spheres(sphere(0, index="")), "bead.spheres.0.refractive_index: missing"
    ),
    "sphere with another key": (
        spheres(sphere(0, more="colour = 3")), "bead.spheres.0.colour = 3: unknown key; allowed: "
    ),
    "sphere of negative radius": (
        spheres(sphere(0, radius="radius = -1e-7")),
        "bead.spheres.0.radius = -1e-07: must be from 1e-09 to 0.001 m",
    ),
    "sphere of a low index": (
        spheres(sphere(0, index="refractive_index = 0.9")),
        "bead.spheres.0.refractive_index = 0.9: must be from 1 to 10",
    ),
    "sphere in a plane": (
        spheres(sphere(None, more="position = [0, 0]")),
        "bead.spheres.0.position = [0, 0]: must have 3 entries",
    ),
    "sphere nowhere": (spheres(sphere("nan")), "bead.spheres.0.position.2 = nan: must be finite"),
    "spheres far apart": (
        spheres(sphere("-1e-5"), sphere("1e-5")),
        "bead.shape = 'spheres': the body reaches 1.01e-05 m from its centre; computed up to 3.82",
    ),
    # files
    "no file": ({**FILE, "bead.file": ABSENT}, "bead.file: missing; shape = 't-matrix' requires"),
    "number as a file": ({**FILE, "bead.file": "3"}, "bead.file = 3: must be text"),
    "file that does not exist": ({**FILE, "bead.file": '"no.tmat.h5"'}, "no.tmat.h5: no such file"),
    "scene as a file": (
        {**FILE, "bead.file": '"scene.toml"'}, "scene.toml: not a readable HDF5 file: "
    ),
    "folder as a file": ({**FILE, "bead.file": '"."'}, ": is a folder; must be a file .tmat.h5"),
    "file for another wavelength": (
        {**FILE, "beam.wavelength": '"800 nm"'},
        "angular_vacuum_wavenumber = 1064 nm: does not include 800 nm as asked",
    ),
    "file for another medium": (
        {**FILE, "medium.refractive_index": "1.326"},
        "embedding/relative_permittivity = 1.7689: is a refractive index of 1.33; must be 1.326",
    ),
    "file without a diameter": (
        {**FILE, "bead.diameter": ABSENT}, "bead.radius or diameter: one is required"
    ),
    "file of too few modes": (
        {**FILE, "bead.diameter": "4e-6"}, "modes/l = 1 to 4: too few for a body of radius 2e-06 m"
    ),
    # other shapes
    "ellipsoid with a length": (
        {"bead.shape": '"ellipsoid"', "bead.diameter": ABSENT},
        "bead.length: does not apply to shape = 'ellipsoid'; remove it, or set shape to spheroid, "
        "cylinder or capsule",
    ),
    "ellipsoid with a diameter": (
        {**shaped("ellipsoid"), "bead.diameter": '"1 um"', "bead.semi_axes": "[1e-6, 1e-6, 1e-6]"},
        "bead.diameter = 1 um: cannot be combined with semi_axes",
    ),
    "ellipsoid without semi-axes": (
        shaped("ellipsoid"),
        "bead.semi_axes: missing; shape = 'ellipsoid' requires them",
    ),
    "light on an ellipsoid": (
        {**shaped("ellipsoid"), "bead.semi_axes": "[1e-7, 2e-7, 3e-7]"},
        "bead.t_matrix: missing; the light on an ellipsoid requires a T-matrix file, or set the "
        "beam's power to 0",
    ),
    "light on a long ellipsoid": (
        {**shaped("ellipsoid"), "bead.semi_axes": "[1e-7, 1e-7, 9e-7]",
         "bead.refractive_index": "1.5"},
        "bead.semi_axes = [1e-07, 1e-07, 9e-07]: the last is 9 times the others; spheroids are",
    ),
    "light on a cylinder": (
        {**shaped("cylinder"), "bead.diameter": '"1 um"', "bead.length": '"2 um"'},
        "bead.t_matrix: missing; the light on a cylinder requires a T-matrix file, or set the ",
    ),
    "cylinder with an index": (
        {"bead.shape": '"cylinder"'},
        "bead.refractive_index: does not apply to shape = 'cylinder', because the file has",
    ),
    "file of the light on a sphere": (
        {"bead.shape": ABSENT, "bead.length": ABSENT, "bead.t_matrix": '"a.tmat.h5"'},
        "bead.t_matrix: does not apply to shape = 'sphere'; remove it, or set shape to ellipsoid,",
    ),
    "short capsule": (
        {**shaped("capsule"), "bead.diameter": '"1 um"', "bead.length": '"1 um"'},
        "bead.length = 1e-06: must be above the diameter of the capsule, 1e-06 m",
    ),
    "profile off the axis": (
        profiled("[1e-7, 0], [2e-7, 0], [0, 1e-7]"), "bead.points.0 = [1e-07, 0.0]: must be on the"
    ),
    "profile that touches the axis": (
        profiled("[0, 0], [1e-7, 0], [0, 1e-7], [0, 2e-7]"), "bead.points.2 = [0.0, 1e-07]: must be"
    ),
    "profile that meets itself": (
        profiled("[0, 0], [3e-7, 0], [3e-7, 2e-7], [1e-7, -1e-7], [0, 3e-7]"),
        "bead.points: the lines from 0 and from 2 meet",
    ),
    "profile of a negative radius": (
        profiled("[0, 0], [-1e-7, 0], [0, 1e-7]"), "bead.points.1.0 = -1e-07: must be from 0 to"
    ),
    "profile with a repeated point": (
        profiled("[0, 0], [1e-7, 0], [1e-7, 0], [0, 1e-7]"), "bead.points: 1 and 2 are at the same"
    ),
    "mesh that does not exist": (
        {**shaped("mesh"), "bead.file": '"no.stl"', "bead.scale": '"1 um"'},
        "no.stl': no such file",
    ),
    "mesh without a scale": (
        {**shaped("mesh"), "bead.file": '"no.stl"'},
        "bead.scale: missing; shape = 'mesh' requires it",
    ),
    "mesh of another format": (
        {**shaped("mesh"), "bead.file": '"no.txt"', "bead.scale": '"1 um"'},
        "no.txt': a mesh must be a file .stl, .obj, .ply",
    ),
    "given body with a density": (
        given(RESISTANCE, **{"bead.density": "1000"}),
        "bead.density = 1000: cannot be combined with given; remove it",
    ),
    "given body without a matrix": (
        given(""), "bead.given.resistance or diffusion: one is required"
    ),
    "given resistance and diffusion": (
        given(RESISTANCE + RESISTANCE.replace("resistance", "diffusion")),
        "bead.given.resistance or diffusion: give only one",
    ),
    "given diffusion without a temperature": (
        given(RESISTANCE.replace("resistance", "diffusion")),
        "bead.given.temperature: missing; diffusion requires it",
    ),
    "resistance that is not symmetric": (
        given(matrix(1e-13)), "bead.given.resistance: opposite elements differ by 0.1 of the "
    ),
    "resistance that is not positive": (
        given(matrix(-2e-12, -2e-12)),
        "bead.given.resistance: has the eigenvalue -1 in units of its diagonal; must be positive",
    ),
    "resistance that is negative": (
        given(RESISTANCE.replace("1e-08", "-1e-08")),
        "bead.given.resistance: has -1e-08 on its diagonal; must be positive",
    ),
    "matrix of five rows": (
        given("resistance = [[1], [2], [3], [4], [5]], "), "resistance = [[1], [2], [3], [4], [5]]"
    ),
    "inertia of no body": (
        given(RESISTANCE, inertia="[1e-30, 1e-30, 3e-30]"),
        "bead.given.inertia: the principal moments 1e-30, 1e-30, 3e-30 are of no body",
    ),
    # orientation
    "axis of no length": (
        {"start.orientation": "[0, 0, 0]"},
        "start.orientation = [0, 0, 0]: an axis must have a finite length above 0",
    ),
    "axis without an end": (
        {"start.orientation": "[0, inf, 0]"},
        "start.orientation = [0, inf, 0]: an axis must have a finite length above 0",
    ),
    "axis in words": ({"start.orientation": '"up"'}, "start.orientation = 'up': must be a list"),
    "axis of truth values": (
        {"start.orientation": "[true, false, false]"},
        "start.orientation = [True, False, False]: must have 4 entries",
    ),
    "too many Euler parameters": (
        {"start.orientation": "[1, 0, 0, 0, 0]"},
        "start.orientation = [1, 0, 0, 0, 0]: must have 4 entries",
    ),
    "Euler parameters that are all 0": (
        {"start.orientation": "[0, 0, 0, 0]"},
        "start.orientation = [0.0, 0.0, 0.0, 0.0]: the Euler parameters must not all be 0",
    ),
    # light and walls
    "force map": ({"optics.evaluator": '"map"'}, "a body that turns has no force map, because"),
    "grid of rays": (
        {"optics.evaluator": '"grid"'},
        "optics.evaluator = 'grid' requires ray optics, and bead.shape = 'spheroid' requires wave",
    ),
    "rays": ({"optics.theory": '"rays"'},
             "optics.theory = 'rays': bead.shape = 'spheroid' requires wave optics"),
    "reflectance averaged over polarisations": (
        {"beam.polarisation": '"averaged-reflectance"'},
        "beam.polarisation = 'averaged-reflectance' requires ray optics, and bead.shape =",
    ),
    "wall": ({"wall.position": "-3e-6"},
             "wall: bead.shape = 'spheroid' is characterised without walls; remove it"),
    "start in the wall": (
        {"wall.position": "-0.3e-6"}, "start.position = [0.0, 0.0, 0.0]: the bead must start beside"
    ),
    "no light": ({"beam.power_through_pupil": "0"}, "beam: a body requires light to be trapped"),
}  # fmt: skip


def as_toml(changes):
    values = {key: text for key, text in {**GOOD, **changes}.items() if text is not ABSENT}
    return "\n".join(f"{key} = {text}" for key, text in values.items())


@pytest.fixture
def never_computed(monkeypatch):
    def accepted(*arguments):
        pytest.fail("accepted")

    monkeypatch.setattr(PoseSearch, "relaxed", accepted)


def assert_refused(command_line, arguments, expected):
    outcome = command_line(*arguments)
    assert outcome.code == 2
    (line,) = outcome.err.splitlines()
    assert expected in line
    assert not outcome.out


@pytest.mark.usefixtures("never_computed")
@pytest.mark.parametrize(("changes", "expected"), BAD.values(), ids=BAD.keys())
def test_wrong_scene_of_a_body_is_refused_in_one_line(command_line, changes, expected):
    Path("scene.toml").write_text(as_toml(changes), encoding="utf-8")
    assert_refused(command_line, ["trap", "scene.toml"], expected)


@pytest.mark.usefixtures("never_computed")
@pytest.mark.parametrize(
    "changes", [{}, spheres(sphere("-1e-7"), sphere("1e-7")), FILE], ids=["rod", "pair", "file"]
)
def test_right_scene_of_a_body_is_accepted(command_line, changes):
    Path("scene.toml").write_text(as_toml(changes), encoding="utf-8")
    with pytest.raises(pytest.fail.Exception, match="accepted"):
        command_line("trap", "scene.toml")


DRAG = "bead.shape = 'spheroid': has no single drag coefficient; allowed: 'sphere'"


@pytest.mark.usefixtures("never_computed")
@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (["tune"], "bead.shape = 'spheroid': models and methods are compared for spheres"),
        (["trap", "--heights", "1 um", "2 um"], DRAG),
        (["map"], "bead.shape = 'spheroid': a body that turns has no force map"),
        (["view", "--trap"], "its trap has no interactive page; use `tweezer trap --plot`"),
    ],
    ids=lambda each: "-".join(each[:2]) if isinstance(each, list) else None,
)
def test_command_for_spheres_refuses_a_body(command_line, arguments, expected):
    Path("scene.toml").write_text(as_toml({}), encoding="utf-8")
    command, *options = arguments
    assert_refused(command_line, [command, "scene.toml", *options], expected)


def test_scene_of_two_wavelengths_has_no_t_matrix():
    scene = rod().replace(
        beam=[{"wavelength": 1.064e-6, "power_through_pupil": 0.05, "waist": 2.5e-3},
              {"wavelength": 0.8e-6, "power_through_pupil": 0.05, "waist": 2.5e-3}]
    )  # fmt: skip
    with pytest.raises(tweezer.SceneError, match=r"^beam: a T-matrix requires beams of one wavele"):
        tweezer.t_matrix(scene)


@pytest.mark.parametrize(
    ("orientations", "problem"),
    [
        ([0, 0, 0, 0], "must be finite and not all 0"),
        ([np.nan, 0, 0, 0], "must be finite and not all 0"),
        ([1, 0, 0], r"must be numbers of the shape \(4,\)"),
        ([[1, 0, 0, 0]] * 3, r"must be numbers of the shape \(4,\)"),
        ("up", r"must be numbers of the shape \(4,\)"),
    ],
)
def test_orientations_that_are_none_are_refused(orientations, problem):
    with pytest.raises(ValueError, match=f"^orientations {problem}"):
        tweezer.optical_force(rod(), [[0, 0, 0], [0, 0, 1e-7]], orientations)


# --- mass, inertia and size -------------------------------------------------------------------


def rod(**bead):
    values = {"shape": "spheroid", "diameter": 0.4e-6, "length": 0.8e-6, **bead}
    return tweezer.load_scene("silica-1um").replace(bead=values, optics={"theory": "waves"})


def inside_unit_ball(count=12):
    """Points in the unit ball and their weights: exact for polynomials of degree below 2 count."""
    u, u_weight = leggauss(count)
    r, r_weight = (u + 1) / 2, u_weight / 2
    phi = 2 * np.pi * np.arange(2 * count) / (2 * count)
    r, u, phi = (each.ravel() for each in np.meshgrid(r, u, phi, indexing="ij"))
    weight = np.einsum("i,j,k->ijk", r_weight, u_weight, np.full(2 * count, np.pi / count)).ravel()
    sine = np.sqrt(1 - u**2)
    return np.stack([r * sine * np.cos(phi), r * sine * np.sin(phi), r * u], 1), weight * r**2


def moments(points, weights):
    """Mass, centre and inertia tensor about the origin of weighted points."""
    mass = weights.sum()
    square = (points**2).sum(1)
    tensor = (weights * square).sum() * np.eye(3) - (points.T * weights) @ points
    return mass, weights @ points / mass, tensor


TURNED = [Rotation.from_rotvec(each) for each in ([0, 0, 0], [0.4, -1.1, 0.7], [1, 2, 0.3])]


@pytest.mark.parametrize("axes", [(0.2, 0.2, 0.5), (0.5, 0.5, 0.2), (0.3, 0.2, 0.7)])
def test_ellipsoid_has_the_moments_of_its_points(axes):
    points, weights = inside_unit_ball()
    mass, centre, tensor = moments(points * axes, 3.0 * weights * np.prod(axes))
    body = solids.Ellipsoid(axes, 3.0)
    assert body.mass == pytest.approx(mass, rel=1e-13)
    assert 3.0 * body.volume == pytest.approx(mass, rel=1e-13)
    assert np.abs(centre).max() < 1e-15
    assert np.diag(body.moments_of_inertia) == pytest.approx(tensor, abs=1e-13 * tensor.max())
    assert np.array(body.inertia) == pytest.approx(tensor, abs=1e-13 * tensor.max())
    assert body.centre_of_volume == (0, 0, 0)
    assert body.size == max(axes)


@pytest.mark.parametrize("normal", [1.0, -1.0])
def test_ellipsoid_touches_a_plane_with_its_lowest_point(normal):
    axes = np.array([0.2, 0.3, 0.5])
    body = solids.Ellipsoid((0.2, 0.3, 0.5), 1.0)
    theta, phi = np.meshgrid(np.linspace(0, np.pi, 801), np.linspace(0, 2 * np.pi, 801))
    surface = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)])
    points = surface.reshape(3, -1).T * axes
    for turn in TURNED:
        orientation = turn.as_quat(scalar_first=True)
        lowest = -(normal * turn.apply(points)[:, 2]).min()
        assert body.support(normal, orientation) == pytest.approx(lowest, rel=1e-4)
        assert body.support(normal, 2 * orientation) == pytest.approx(lowest, rel=1e-4)
        assert body.starting(tuple(orientation)).support(normal) == pytest.approx(lowest, rel=1e-4)
    assert body.support(normal) == 0.5


def test_cluster_has_the_moments_of_its_points():
    centres = np.array([[0.1, 0.2, -0.3], [-0.2, 0.3, 0.1], [0.3, -0.1, 0.3]])
    radii, densities = np.array([0.15, 0.2, 0.1]), np.array([2.0, 1.0, 19.0])
    masses, volumes = densities * radii**3, radii**3
    centres -= masses @ centres / masses.sum()
    points, weights = inside_unit_ball()
    every = np.concatenate([c + r * points for c, r in zip(centres, radii, strict=True)])
    of_each = np.concatenate([mass * weights for mass in masses])
    mass, centre, tensor = moments(every, of_each)
    listed = [
        {"radius": r * 1e-6, "position": at * 1e-6, "density": rho * 1e3, "refractive_index": 1.5}
        for at, r, rho in zip(np.add(centres, [1, 2, 3]), radii, densities, strict=True)
    ]
    body = tweezer.load_scene("silica-1um").replace(
        bead={"shape": "spheres", "radius": None, "refractive_index": None, "spheres": listed}
    ).body  # fmt: skip
    mass, tensor, centres, radii = mass * 1e-15, tensor * 1e-27, centres * 1e-6, radii * 1e-6
    assert body.mass == pytest.approx(mass, rel=1e-13)
    assert np.abs(centre).max() < 1e-15
    assert np.array(body.inertia) == pytest.approx(tensor, abs=1e-13 * tensor.max())
    assert body.moments_of_inertia == pytest.approx(np.linalg.eigvalsh(tensor), rel=1e-12, abs=0)
    assert body.centre_of_volume == pytest.approx(volumes @ centres / volumes.sum(), abs=1e-18)
    assert body.size == pytest.approx((np.linalg.norm(centres, axis=1) + radii).max())
    for normal in (1.0, -1.0):
        for turn in TURNED:
            orientation = turn.as_quat(scalar_first=True)
            lowest = -(normal * turn.apply(centres)[:, 2] - radii).min()
            assert body.support(normal, orientation) == pytest.approx(lowest, rel=1e-14)


def pair(*listed, **bead):
    """A cluster in water, of spheres at heights."""
    listed = [{"diameter": 4e-7, "position": [1e-6, 0, z], **own} for z, own in listed]
    own = {"shape": "spheres", "radius": None, "refractive_index": None, "material": None}
    return tweezer.load_scene("silica-1um").replace(
        bead={**own, "density": None, "spheres": listed, **bead}, optics={"theory": "waves"}
    )


SILICA, POLYSTYRENE = {"material": "silica"}, {"material": "polystyrene"}


def test_cluster_of_two_materials_is_about_its_centre_of_mass():
    scene = pair((0.0, SILICA), (4e-7, POLYSTYRENE))
    bead = scene.bead
    heavy, light = (each.density for each in bead.spheres)
    assert heavy > 1.5 * light > 1500
    assert bead.density == pytest.approx((heavy + light) / 2)
    assert "density" in bead.filled
    lower = -4e-7 * light / (heavy + light)
    assert bead.centres == pytest.approx(np.array([[0, 0, lower], [0, 0, lower + 4e-7]]))
    assert bead.body.centre_of_volume == pytest.approx([0, 0, lower + 2e-7])
    assert bead.radius == bead.body.size == pytest.approx(lower + 6e-7)
    written = scene.model_dump()
    assert not any("density" in each for each in (written["bead"], *written["bead"]["spheres"]))
    assert tweezer.load_scene(written) == scene


@pytest.mark.parametrize(
    ("own", "bead", "expected"),
    [
        (({}, {}), {"material": "silica"}, (1, 1)),
        (({}, POLYSTYRENE), {"material": "silica"}, (1, 0)),
        ((SILICA, POLYSTYRENE), {"density": 1200.0}, (1200, 1200)),
        (({**SILICA, "density": 3000.0}, POLYSTYRENE), {"density": 1200.0}, (3000, 1200)),
        (({**SILICA, "density": 3000.0}, POLYSTYRENE), {}, (3000, 0)),
    ],
)
def test_density_of_a_sphere_is_its_own_or_that_of_the_bead_or_of_its_material(own, bead, expected):
    named = [pair((0.0, each)).bead.density for each in (POLYSTYRENE, SILICA)]
    spheres = pair((0.0, own[0]), (4e-7, own[1]), **bead).bead
    found = [spheres.density if each.density is None else each.density for each in spheres.spheres]
    assert found == [named[each] if each < 2 else each for each in expected]


def test_several_orientations_have_several_supports():
    orientations = np.array([each.as_quat(scalar_first=True) for each in TURNED])
    rings = solids.Solid(1, 1, np.eye(3), [(0, 0, 1), (0, 0, -1)], rings=0.5)
    for body in (solids.Ellipsoid((0.2, 0.3, 0.5), 1.0), rings):
        found = body.support(1.0, orientations)
        assert found.shape == (3,)
        assert found == pytest.approx([body.support(1.0, each) for each in orientations])


def test_bead_of_a_scene_is_the_body_of_its_shape():
    body = rod(density=1100).body
    assert isinstance(body, solids.Ellipsoid)
    assert body.mass == pytest.approx(1100 * 4 / 3 * np.pi * 0.2**2 * 0.4 * 1e-18)
    listed = [{"diameter": d, "refractive_index": 1.5, "position": [1e-6, 0, z]}
              for d, z in ((2e-7, 0), (4e-7, 3e-7))]  # fmt: skip
    pair = {"shape": "spheres", "radius": None, "refractive_index": None, "spheres": listed}
    scene = tweezer.load_scene("silica-1um").replace(bead=pair, optics={"theory": "waves"})
    # volumes 1 and 8: the centre is 8/9 of the way
    assert scene.bead.centres == pytest.approx(np.array([[0, 0, -8 / 3e7], [0, 0, 1 / 3e7]]))
    assert isinstance(scene.body, solids.Solid)
    assert scene.bead.radius == scene.body.size == pytest.approx(1.1e-6 / 3)
    assert scene.replace(bead={"density": 900}).bead.radius == scene.bead.radius


def test_gap_to_a_wall_depends_on_the_orientation_of_the_start():
    walled = rod().replace(wall={"position": -1e-6}, start={"position": [0, 0, 0]})
    assert walled.gap(0.0) == pytest.approx(0.6e-6)
    lying = walled.replace(start={"orientation": [1, 0, 0]})
    assert lying.gap(0.0) == pytest.approx(0.8e-6)


@pytest.mark.parametrize("shape", ["cone", "Sphere", ["a"], 3])
def test_unknown_shape_is_refused_in_one_line(shape):
    with pytest.raises(tweezer.SceneError) as refused:
        tweezer.load_scene("silica-1um").replace(bead={"shape": shape})
    (line,) = str(refused.value).splitlines()
    assert line.startswith(f"bead.shape = {shape!r}: allowed: 'sphere', 'spheroid', ")
