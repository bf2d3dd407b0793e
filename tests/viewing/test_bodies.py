"""Pages of runs of bodies: surfaces, forces and energies, and where the browser draws the body."""

import base64

import numpy as np
import pytest
import trimesh
import xarray as xr
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

import tweezer
from tests.viewing.test_browser import WITHOUT, camera, on_screen, open_page, picture
from tweezer.results.run import Run
from tweezer.runs.resolved import resolved
from tweezer.scene.surfaces import surface_of

pytestmark = pytest.mark.filterwarnings("ignore:Knudsen number")

UM = 1e-6
DARK = {"power_through_pupil": 0}
POINTS = [[0, 0], [0.5 * UM, 0], [0.25 * UM, UM], [0, UM]]
GIVEN = {
    "mass": 1e-15, "volume": 0.5e-18, "inertia": [1e-28, 1e-28, 2e-28],
    "resistance": np.diag([1e-8, 1e-8, 1.2e-8, 1e-21, 1e-21, 2e-21]).tolist(),
}  # fmt: skip
#: bodies, with the volume and the farthest point from the centre of mass, in um^3 and um
BODIES = {
    "spheroid": ({"diameter": 0.2 * UM, "length": 0.4 * UM}, np.pi / 6 * 0.016, 0.2),
    "ellipsoid": ({"semi_axes": [0.2 * UM, 0.3 * UM, 0.5 * UM]}, 4 / 3 * np.pi * 0.03, 0.5),
    "cylinder": ({"diameter": 0.4 * UM, "length": UM}, np.pi * 0.04, np.hypot(0.2, 0.5)),
    "capsule": ({"diameter": 0.4 * UM, "length": UM}, np.pi * (0.024 + 4 / 3 * 0.008), 0.5),
    "profile": ({"points": POINTS}, np.pi / 3 * (0.25 + 0.125 + 0.0625), None),
    "spheres": (
        {
            "spheres": [
                {"diameter": 0.5 * UM, "refractive_index": 1.57, "position": [0, 0, z * UM]}
                for z in (-0.25, 0.25)
            ]
        },
        np.pi / 3 * 0.125,
        0.5,
    ),
}


def scene_of(shape, keys, **sections):
    """The body in water, by default without light."""
    indexed = {"refractive_index": 1.57} if shape == "spheroid" else {}
    bead = {"shape": shape, "density": 2000, **indexed, **keys}
    return tweezer.load_scene("polystyrene-500nm").replace(
        **{"bead": bead, "beam": DARK, **sections}
    )


@pytest.fixture(scope="module")
def box(tmp_path_factory):
    """A file of a box of 0.4 by 0.6 by 1 um."""
    path = tmp_path_factory.mktemp("mesh") / "box.stl"
    trimesh.creation.box((0.4, 0.6, 1.0)).export(path)
    return {"file": str(path), "scale": UM}


@pytest.mark.parametrize("shape", BODIES)
def test_surface_is_the_body(shape):
    """A formula gives the volume, and the normals lead outwards."""
    keys, volume, farthest = BODIES[shape]
    found = surface_of(scene_of(shape, keys).bead)
    corners = found.vertices[found.faces] / UM
    six = np.einsum("ni,ni->n", corners[:, 0], np.cross(corners[:, 1], corners[:, 2]))
    assert six.sum() / 6 == pytest.approx(volume, rel=0.01)
    outwards = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    outwards /= np.linalg.norm(outwards, axis=1, keepdims=True)
    assert (np.einsum("ni,nki->nk", outwards, found.normals[found.faces]) > 0.9).all()
    assert np.linalg.norm(found.normals, axis=1) == pytest.approx(1, abs=1e-12)
    if farthest:
        assert np.linalg.norm(found.vertices, axis=1).max() == pytest.approx(farthest * UM)


def test_surface_of_a_mesh_keeps_its_edges(box):
    found = surface_of(scene_of("mesh", box).bead)
    assert ConvexHull(found.vertices / UM).volume == pytest.approx(0.24, rel=1e-6)
    assert np.abs(found.normals).max(axis=1) == pytest.approx(1, abs=1e-9)  # along an axis each


@pytest.fixture(scope="module")
def rod():
    """A rod that turns in its trap, released askew and off the axis."""
    scene = scene_of(
        "spheroid", {"diameter": 0.2 * UM, "length": 0.4 * UM}, beam={},
        start={"position": [0.1 * UM, 0, 0], "orientation": [0.8, 0.5, 0.2, 0.1]},
        simulation={"duration": 4e-4, "samples": 201},
    )  # fmt: skip
    return tweezer.simulate(scene)


def lab_twist(run):
    """Velocity and angular velocity in the laboratory, (n, 6)."""
    turned = Rotation.from_quat(run["orientation"].values, scalar_first=True)
    return np.hstack([run["velocity"].values, turned.apply(run["angular_velocity"].values)])


def test_forces_on_a_body_add_to_its_acceleration(rod):
    arrays = tweezer.view(rod).content.arrays
    mass = 2000 * np.pi / 6 * 0.2**2 * 0.4 * UM**3
    change = mass * np.gradient(rod["velocity"].values, rod["time"].values, axis=0)
    total = arrays["force_sum"].values()
    middle = slice(10, -10)
    assert total[middle] == pytest.approx(change[middle], abs=2e-3 * np.abs(total[middle]).max())
    # and drag is far larger than their sum
    assert np.abs(arrays["force_drag"].values()[middle]).max() > 1e3 * np.abs(total[middle]).max()


def test_drag_of_an_unequal_pair_depends_on_its_rotation():
    """Without other forces, drag is mass times acceleration. It couples velocity and rotation."""
    spheres = [
        {"diameter": d * UM, "refractive_index": 1.57, "position": [0, 0, z * UM]}
        for d, z in ((0.5, -0.25), (0.3, 0.15))
    ]
    scene = scene_of(
        "spheres", {"spheres": spheres}, forces={"gravity": False, "buoyancy": False},
        medium={"inertia": "none"}, start={"position": [0, 0, 0], "angular_velocity": [0, 1e4, 0]},
        simulation={"model": "full", "method": "auto", "duration": 1e-7, "samples": 401},
    )  # fmt: skip
    run = tweezer.simulate(scene)
    change = scene.body.mass * np.gradient(run["velocity"].values, run["time"].values, axis=0)
    drag = tweezer.view(run).content.arrays["force_drag"].values()
    middle = slice(3, -3)
    assert drag[middle] == pytest.approx(change[middle], abs=2e-3 * np.abs(drag).max())


def test_energy_given_to_the_water_is_what_drag_dissipates(rod):
    """The integral of the power, from the resistance in the laboratory's frame.

    It begins at the second sample, because the rod starts at rest.
    """
    body = tweezer.resistance(tweezer.scene_of(rod)).matrix
    turned = Rotation.from_quat(rod["orientation"].values, scalar_first=True).as_matrix()
    twist = lab_twist(rod)
    both = np.zeros((len(turned), 6, 6))
    both[:, :3, :3] = both[:, 3:, 3:] = turned
    power = np.einsum("ni,nij,jk,nlk,nl->n", twist, both, np.array(body), both, twist)
    lost = np.trapezoid(power[1:], rod["time"].values[1:]) / (1.380649e-23 * 293.15)
    shown = tweezer.view(rod).content.arrays["energy_lost"].values()
    assert shown[-1] - shown[1] == pytest.approx(lost, rel=1e-4)


def test_samples_resolve_a_body_if_it_turns_slower(rod):
    """The limit is the fastest rate of mobility times stiffness, by differences of the wrench."""
    scene = tweezer.scene_of(rod)

    def wrench(run, i, step):
        position = run["position"].values[i] + step[:3]
        about = Rotation.from_rotvec(step[3:])
        turned = about * Rotation.from_quat(run["orientation"].values[i], scalar_first=True)
        pose = position, turned.as_quat(scalar_first=True)
        return np.hstack(
            [tweezer.optical_force(scene, *pose), tweezer.optical_torque(scene, *pose)]
        )

    fastest = 0.0
    for i in (0, -1):
        sizes = np.array([*3 * [1e-9], *3 * [1e-3]])
        steps = np.diag(sizes)
        slope = np.stack([wrench(rod, i, s) - wrench(rod, i, -s) for s in steps]).T / (2 * sizes)
        frame = Rotation.from_quat(rod["orientation"].values[i], scalar_first=True).as_matrix()
        both = np.kron(np.eye(2), frame)
        mobility = both @ np.linalg.inv(tweezer.resistance(scene).matrix) @ both.T
        fastest = max(fastest, np.abs(np.linalg.eigvals(mobility @ slope)).max())
    for factor, told in ((0.997, True), (1.003, False)):
        times = np.linspace(0, factor * 200 / fastest, 201)
        assert resolved(Run.of(rod.assign_coords(time=times))) is told


def test_motion_without_light_is_resolved():
    scene = scene_of("cylinder", BODIES["cylinder"][0], simulation={"duration": 1e-3, "samples": 3})
    content = tweezer.view(tweezer.simulate(scene)).content
    assert content.facts["resolved"]
    assert content.facts["body"]["plotted_axes"] == [2]


def test_page_of_a_body_of_unknown_surface_says_so():
    scene = scene_of(
        "given", {"diameter": UM, "given": GIVEN, "density": None},
        simulation={"duration": 1e-3, "samples": 3},
    )  # fmt: skip
    content = tweezer.view(tweezer.simulate(scene)).content
    assert content.facts["body"]["surface"] is None
    assert content.facts["shells"] == [0.5 * UM]
    assert any("The surface of the body is not known." in note for note in content.notes)


def test_a_body_without_axis_of_revolution_shows_two_axes(box):
    scene = scene_of("mesh", box, simulation={"duration": 1e-3, "samples": 3})
    content = tweezer.view(tweezer.simulate(scene)).content
    assert content.facts["body"]["plotted_axes"] == [2, 0]


# ---- in a browser


@pytest.fixture(scope="module")
def address(rod, tmp_path_factory):
    return tweezer.view(rod).save(tmp_path_factory.mktemp("page") / "rod.html").as_uri()


def vertices_of(rod, k, i):
    """Vertices of its surface with the numbers k, um, in the laboratory at the sample i."""
    packed = tweezer.view(rod).content.facts["body"]["surface"]["vertices"]
    vertices = np.frombuffer(base64.b64decode(packed["data"]), "<f4").reshape(-1, 3)[k]
    turned = Rotation.from_quat(rod["orientation"].values[i], scalar_first=True)
    return (turned.apply(vertices) + rod["position"].values[i]) / UM


MARKED = [0, 400, 1000, 1500]
VERTICES = "tweezer.seek(arguments[0]); return arguments[1].map((k) => tweezer.vertex(k))"


@pytest.mark.parametrize("sample", [0, 60, 200])
def test_the_body_is_turned_as_the_run_has_it(browser, address, rod, sample):
    open_page(browser, address, 1280, 800)
    found = browser.execute_script(VERTICES, float(rod["time"][sample]), MARKED)
    assert np.array(found) == pytest.approx(vertices_of(rod, MARKED, sample), abs=2e-6)
    assert browser.get_log("browser") == []


def test_a_plain_picture_turns_the_body_too(browser, address, rod):
    added = browser.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", {"source": WITHOUT})
    try:
        open_page(browser, address, 1280, 800)
        found = browser.execute_script(VERTICES, float(rod["time"][60]), MARKED)
        assert np.array(found) == pytest.approx(vertices_of(rod, MARKED, 60), abs=2e-6)
        assert browser.get_log("browser") == []
    finally:
        browser.execute_cdp_cmd("Page.removeScriptToEvaluateOnNewDocument", added)


def test_the_rod_covers_the_pixels_of_its_outline(browser, address, rod):
    """The picture with and without the rod differs within the hull of its vertices alone."""
    open_page(browser, address, 1280, 800)
    moment = float(rod["time"][60])
    browser.execute_script(
        "tweezer.look(2); tweezer.show('arrows', false); tweezer.show('path', false);"
        "tweezer.show('light', false); tweezer.seek(arguments[0])",
        moment,
    )
    browser.execute_script("tweezer.show('arrows', false)")
    shown = picture(browser)
    browser.execute_script("tweezer.show('bead', false)")
    changed = np.abs(shown - picture(browser)).max(axis=2) > 0.02
    seen = camera(browser)
    corners = np.array([on_screen(seen, v) for v in vertices_of(rod, slice(None), 60)])
    hull = ConvexHull(corners)
    rows, columns = np.nonzero(changed)
    # volume of a hull in two dimensions is its area; an edge is a pixel wide
    assert len(rows) == pytest.approx(hull.volume, rel=0.05)
    out = hull.equations[:, :2] @ np.array([columns + 0.5, rows + 0.5]) + hull.equations[:, 2:]
    assert out.max() < 2


def test_the_axis_of_the_body_and_its_angular_velocity_are_plotted(browser, address, rod):
    open_page(browser, address, 1280, 800)
    browser.execute_script("tweezer.seek(arguments[0])", float(rod["time"][60]))
    plots = browser.execute_script(
        "return [...document.querySelectorAll('.plot')].map((plot) => [plot.querySelector('h2')"
        ".textContent, [...plot.querySelectorAll('.number')].map((number) => number.textContent)])"
    )
    shown = dict(plots)
    turned = Rotation.from_quat(rod["orientation"].values[60], scalar_first=True)
    axis = [float(number.replace("\N{MINUS SIGN}", "-")) for number in shown["Body axis z"]]
    assert axis == pytest.approx(turned.apply([0, 0, 1]), abs=6e-4)
    speed = shown["Angular velocity about the body's axes (rad/s)"][:2]
    found = [float(number.replace("\N{MINUS SIGN}", "-")) for number in speed]
    assert found == pytest.approx(rod["angular_velocity"].values[60, :2], rel=6e-3)


@pytest.fixture(scope="module")
def rods():
    """Six rods at random orientations; the first is lost at the eighth time, and one is missing."""
    rng = np.random.default_rng(7)
    turned = Rotation.random(6 * 10, rng=rng).as_quat(scalar_first=True).reshape(6, 10, 4)
    position = 1e-7 * rng.normal(size=(6, 10, 3))
    lost = np.array([7e-3, *3 * [np.inf], np.nan, np.inf])
    position[0, 7:] = turned[0, 7:] = position[4] = turned[4] = np.nan
    scene = tweezer.load_scene("flipping-rod")
    about = {
        "title": "rods", "scene": scene.model_dump_json(exclude_none=True), "trajectories": 6,
        "seed": 7, "model": "overdamped", "method": "heun", "step": 1e-5, "tweezer_version": "0",
    }  # fmt: skip
    return xr.Dataset(
        {
            "position": (("trajectory", "time", "axis"), position),
            "orientation": (("trajectory", "time", "euler_parameter"), turned),
            "lost_time": ("trajectory", lost),
        },
        {"time": 1e-3 * np.arange(10), "axis": ["x", "y", "z"]},
        about,
    )


def test_alignment_of_an_ensemble_is_that_of_the_rods_left(rods):
    arrays = tweezer.view(rods).content.arrays
    for i in range(10):
        each = rods["orientation"].values[:, i]
        each = each[np.isfinite(each).all(axis=1)]
        squares = Rotation.from_quat(each, scalar_first=True).as_matrix()[:, :, 2] ** 2
        assert arrays["alignment"].values()[i] == pytest.approx(squares.mean(axis=0), abs=1e-6)
        error = squares.std(axis=0, ddof=1) / np.sqrt(len(each))
        assert arrays["alignment_error"].values()[i] == pytest.approx(error, abs=1e-6)


def test_the_first_rod_of_an_ensemble_is_drawn_until_it_is_lost(browser, rods, tmp_path):
    page = tweezer.view(rods)
    open_page(browser, page.save(tmp_path / "rods.html").as_uri(), 1280, 800)
    packed = page.content.facts["body"]["surface"]["vertices"]
    vertices = np.frombuffer(base64.b64decode(packed["data"]), "<f4").reshape(-1, 3)[MARKED]
    for i in (0, 6):
        found = browser.execute_script(VERTICES, 1e-3 * i + 1e-5, MARKED)
        turned = Rotation.from_quat(rods["orientation"].values[0, i], scalar_first=True)
        place = (turned.apply(vertices) + rods["position"].values[0, i]) / UM
        # positions are rounded to 1/131068 of their range
        assert np.array(found) == pytest.approx(place, abs=1e-5)
        assert browser.execute_script("return tweezer.bead().visible")
    browser.execute_script("tweezer.seek(0.0082)")
    assert not browser.execute_script("return tweezer.bead().visible")
    assert browser.get_log("browser") == []


def test_page_of_statistics_of_rods_says_that_none_is_drawn(browser, tmp_path):
    run = tweezer.ensemble("flipping-rod", 4, duration="2 ms", statistics=True)
    page = tweezer.view(run)
    assert any("The body is not drawn" in note for note in page.content.notes)
    open_page(browser, page.save(tmp_path / "rods.html").as_uri(), 1280, 800)
    assert not browser.execute_script("return tweezer.bead().visible")
    assert browser.get_log("browser") == []


def test_the_path_of_a_body_in_thermal_motion_is_hidden_at_first(browser, tmp_path):
    scene = tweezer.load_scene("flipping-rod")
    page = tweezer.view(tweezer.simulate(scene, "2 ms")).save(tmp_path / "rod.html")
    open_page(browser, page.as_uri(), 1280, 800)
    boxes = browser.execute_script(
        "return [...document.querySelectorAll('.layers label')]"
        ".map((label) => [label.textContent, label.querySelector('input').checked])"
    )
    assert dict(boxes) == {"light": True, "path": False, "bead": True, "grid": True}


def test_shipped_rod_aligns_and_turns_round():
    """In 200 ms it lies along the polarisation most of the time, and reverses.

    The seed is the default, so that the outcome is certain.
    """
    run = tweezer.simulate("flipping-rod")
    turned = Rotation.from_quat(run["orientation"].values, scalar_first=True)
    along = turned.apply([0, 0, 1])[:, 0]
    assert (along[200:] ** 2).mean() > 0.6  # a third if it were free
    ends = np.sign(along[np.abs(along) > 0.8])
    assert np.count_nonzero(np.diff(ends)) >= 2
