"""Mass, inertia and extent of bodies of any shape, against slices and closed forms."""

import itertools

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.spatial.transform import Rotation

import tweezer

SCENE = tweezer.load_scene("silica-1um").replace(optics={"theory": "waves"})
UM = 1e-6
TURNED = [Rotation.from_rotvec(each) for each in ([0, 0, 0], [0.4, -1.1, 0.7], [1, 2, 0.3])]


def body_of(shape, **keys):
    return SCENE.replace(bead={"shape": shape, "material": None, "density": 2000, **keys}).body


def of_slices(radius, breaks):
    """Volume, centre and moments across and about the axis of slices, in units of the density."""

    def integral(function):
        return sum(
            quad(function, a, b, epsabs=1e-13, epsrel=1e-12)[0]
            for a, b in itertools.pairwise(breaks)
        )  # fmt: skip

    volume = integral(lambda z: np.pi * radius(z) ** 2)
    centre = integral(lambda z: np.pi * radius(z) ** 2 * z) / volume
    axial = integral(lambda z: np.pi * radius(z) ** 4 / 2)
    across = integral(lambda z: np.pi * radius(z) ** 2 * (radius(z) ** 2 / 4 + (z - centre) ** 2))
    return volume, centre, across, axial


def round_off(z):
    """Radius of a capsule of diameter 1 and length 3."""
    return np.sqrt(np.maximum(0.25 - np.maximum(abs(z) - 1, 0) ** 2, 0))


#: id: (body, radius by height, heights of its edges), in um
REVOLVED = {
    "cylinder": (
        ("cylinder", {"diameter": 1 * UM, "length": 3 * UM}), lambda z: 0.5, (-1.5, 1.5)
    ),
    "capsule": (
        ("capsule", {"diameter": 1 * UM, "length": 3 * UM}), round_off, (-1.5, -1, 1, 1.5)
    ),
    "profile": (
        ("profile", {"points": [[0, 0], [UM, 0.5 * UM], [0.4 * UM, 2 * UM], [0, 2 * UM]]}),
        None, (0, 0.5, 2),
    ),
    "profile downwards": (
        ("profile", {"points": [[0, 2 * UM], [0.4 * UM, 2 * UM], [UM, 0.5 * UM], [0, 0]]}),
        None, (0, 0.5, 2),
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", REVOLVED)
def test_body_of_revolution_has_the_moments_of_its_slices(name):
    (shape, keys), radius, breaks = REVOLVED[name]
    if radius is None:  # the hollow below the first corner is cut out of the slices
        radius = lambda z: z / 0.5 if z < 0.5 else 1 - 0.6 * (z - 0.5) / 1.5  # noqa: E731
    body = body_of(shape, **keys)
    volume, centre, across, axial = of_slices(radius, breaks)
    assert body.volume == pytest.approx(volume * 1e-18, rel=1e-10, abs=0)
    assert body.mass == pytest.approx(2000 * body.volume, rel=1e-14, abs=0)
    expected = 2000 * np.array([across, across, axial]) * 1e-30
    assert body.moments_of_inertia == pytest.approx(expected, rel=1e-10, abs=0)
    assert np.array(body.inertia) == pytest.approx(np.diag(expected), rel=1e-10, abs=1e-60)
    assert body.centre_of_volume == (0, 0, 0)
    # points of the surface, from the centre of mass
    z = np.concatenate([np.linspace(a, b, 2001) for a, b in itertools.pairwise(breaks)])
    r = np.array([radius(each) for each in z])
    phi = np.linspace(0, 2 * np.pi, 721)[:, None]
    points = np.stack([r * np.cos(phi), r * np.sin(phi), 0 * phi + z - centre], axis=-1) * UM
    reach = np.linalg.norm(points, axis=-1).max()
    assert body.size == pytest.approx(reach, rel=1e-5, abs=0)
    for normal, turn in itertools.product((1.0, -1.0), TURNED):
        lowest = -(normal * (points @ turn.as_matrix()[2])).min()
        found = body.support(normal, turn.as_quat(scalar_first=True))
        assert found == pytest.approx(lowest, rel=1e-4, abs=0)


def test_given_body_has_its_numbers():
    inertia = [[3e-28, 1e-29, 0], [1e-29, 2e-28, 0], [0, 0, 2e-28]]
    numbers = {
        "mass": "1 pg", "volume": "0.5 um^3", "inertia": inertia,
        "centre_of_volume": [0, 0, "0.1 um"], "resistance": np.diag([1e-8] * 3 + [1e-21] * 3),
    }  # fmt: skip
    scene = SCENE.replace(
        bead={"shape": "given", "diameter": UM, "material": None, "density": None, "given": numbers}
    )
    body = scene.body
    assert body.mass == pytest.approx(1e-15)
    assert body.volume == pytest.approx(5e-19)
    assert np.array(body.inertia) == pytest.approx(np.array(inertia), abs=1e-40)
    assert body.centre_of_volume == pytest.approx((0, 0, 1e-7))
    assert body.support() == body.size == 0.5 * UM
    assert scene.bead.density == pytest.approx(2000)
    assert tweezer.load_scene(scene.model_dump()) == scene


# --- meshes -----------------------------------------------------------------------------------


def box(sides, corner=(0, 0, 0)):
    """Vertices and faces of a box, with outward normals."""
    vertices = np.array(list(itertools.product((0, 1), repeat=3))) * sides + corner
    squares = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = [tri for a, b, c, d in squares for tri in ((a, b, c), (a, c, d))]
    return vertices, np.array(faces)


def obj(path, vertices, faces):
    lines = [f"v {x} {y} {z}" for x, y, z in vertices]
    lines += ["f " + " ".join(str(i + 1) for i in face) for face in faces]
    path.write_text("\n".join(lines), encoding="utf-8")
    return str(path)


def stl(path, vertices, faces):
    corners = [f"vertex {x} {y} {z}" for face in faces for x, y, z in vertices[face]]
    triangles = [
        "facet normal 0 0 0\nouter loop\n" + "\n".join(corners[i : i + 3]) + "\nendloop\nendfacet"
        for i in range(0, len(corners), 3)
    ]
    path.write_text("\n".join(["solid a", *triangles, "endsolid a"]), encoding="utf-8")
    return str(path)


def mesh_of(file, scale=UM):
    return SCENE.replace(
        bead={"shape": "mesh", "file": file, "scale": scale, "material": None, "density": 2000}
    )


@pytest.fixture
def trimesh():
    return pytest.importorskip("trimesh")


@pytest.mark.usefixtures("trimesh")
@pytest.mark.parametrize(("write", "name"), [(obj, "box.obj"), (stl, "box.stl")])
@pytest.mark.parametrize("inverted", [False, True])
def test_box_in_a_file(tmp_path, write, name, inverted):
    sides = np.array([1.0, 2.0, 0.5])
    vertices, faces = box(sides, corner=(5, -3, 7))
    scene = mesh_of(write(tmp_path / name, vertices, faces[:, ::-1] if inverted else faces))
    body = scene.body
    volume = sides.prod() * 1e-18
    assert body.volume == pytest.approx(volume, rel=1e-9, abs=0)
    squares = (sides * UM) ** 2
    expected = 2000 * volume * (squares.sum() - squares) / 12
    assert np.array(body.inertia) == pytest.approx(np.diag(expected), rel=1e-9, abs=1e-36)
    assert body.size == scene.bead.radius == pytest.approx(np.linalg.norm(sides) / 2 * UM)
    for normal, turn in itertools.product((1.0, -1.0), TURNED):
        lowest = np.abs(turn.as_matrix()[2] * sides).sum() / 2 * UM
        assert body.support(normal, turn.as_quat(scalar_first=True)) == pytest.approx(lowest)
    assert tweezer.load_scene(scene.model_dump()) == scene


@pytest.mark.usefixtures("trimesh")
@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda v, f: (v, f[1:]), "has 3 edges that do not belong to two triangles; it must be"),
        (lambda v, f: (v, np.concatenate([f[:1, ::-1], f[1:]])), "has 3 edges at which the orient"),
        (lambda v, f: (v[:3], np.array([[0, 1, 2], [2, 1, 0]])), "encloses no volume"),
        (lambda v, f: (v[:0], f[:0]), "not a readable mesh|contains no triangles"),
    ],
    ids=["open", "inverted face", "flat", "empty"],
)
def test_mesh_that_bounds_no_body_is_refused(tmp_path, change, message):
    file = obj(tmp_path / "bad.obj", *change(*box(np.ones(3))))
    with pytest.raises(tweezer.SceneError, match=rf"^bead\.file = '.*bad.obj': .*({message})"):
        mesh_of(file)


@pytest.mark.usefixtures("trimesh")
def test_mesh_of_too_many_triangles_has_no_resistance(tmp_path):
    vertices, faces = box(np.ones(3))
    for _ in range(4):
        a, b, c = (vertices[faces[:, i]] for i in range(3))
        p, q, r = (a + b) / 2, (b + c) / 2, (c + a) / 2
        parts = [(a, p, r), (p, b, q), (r, q, c), (p, q, r)]
        vertices = np.concatenate([np.stack(each, axis=1) for each in parts]).reshape(-1, 3)
        faces = np.arange(len(vertices)).reshape(-1, 3)
    scene = mesh_of(obj(tmp_path / "fine.obj", vertices, faces))
    with pytest.raises(tweezer.SceneError, match=r"^bead\.file: the mesh has 3072 triangles; the"):
        tweezer.resistance(scene)
