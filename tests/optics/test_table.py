"""The map: its certificate holds, it is smooth, and its file is found, refused or made again.

The oracle is the quadrature, at a tolerance far below the certificate.
"""

import ast
import dataclasses
import importlib
import inspect
import os
import shutil
import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest
from filelock import FileLock

import tweezer
from tweezer.optics import evaluators_of, force_map, light_force
from tweezer.optics.rays import tabulate
from tweezer.optics.table import _in_memory, _load, _save
from tweezer.optics.waves.lattice import Lattice

#: a table of a few pieces, made in no time
SMALL = {"table_range": 0.5, "table_tolerance": 1e-4}


@pytest.fixture(scope="module")
def kept(tmp_path_factory):
    """A cache folder for the tables that several tests read."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(tmp_path_factory.mktemp("cache")))
        yield


def mapped(scene, **optics):
    return scene.replace(optics={"theory": "rays", "evaluator": "map", **optics})


def exact(scene, tolerance=1e-12):
    return light_force(scene.replace(optics={"evaluator": "quadrature", "tolerance": tolerance}))


def within(scene, count, rng):
    """Places in the range of the map: two of five near d = r, where the force is least smooth."""
    directions = rng.normal(size=(count, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    reach = scene.optics.table_range
    distances = reach * np.cbrt(rng.random(count))
    near = 1 + np.geomspace(1e-9, 0.2, count // 5)
    distances[: len(near)] = near
    distances[len(near) : 2 * len(near)] = 2 - near
    return scene.bead.radius * np.minimum(distances, 0.999999 * reach)[:, None] * directions


def norm(vectors):
    return np.linalg.norm(vectors, axis=1)


def smooth(scene, positions):
    """Whether places are off d = r: the gradient there grows as log|d - r|, and no map follows."""
    return np.abs(norm(positions) / scene.bead.radius - 1) > 1e-4


@pytest.mark.usefixtures("kept")
def test_never_worse_than_its_certificate():
    scene = mapped(tweezer.load_scene("thesis-990nm"))
    positions = within(scene, 100_000, np.random.default_rng(81))
    read, true = light_force(scene).field(positions), exact(scene).field(positions)
    made = force_map(scene)
    assert (evaluators_of(scene), made.range) == ("map", 3 * scene.bead.radius)
    assert (read.error == made.certified_error).all()
    error = norm(read.force - true.force) + true.error
    assert error.max() < made.certified_error
    assert made.certified_error < 1e-7 * made.largest_force
    # and the certificate is not far above what it certifies
    assert made.certified_error < 6 * error.max()
    assert made.largest_force == pytest.approx(norm(true.force).max(), rel=0.01)


@pytest.mark.usefixtures("kept")
def test_jacobian():
    """It is that of the light's force, and of the very force that the map gives."""
    scene = mapped(tweezer.load_scene("thesis-990nm"))
    positions = within(scene, 20_000, np.random.default_rng(82))
    gradient = light_force(scene).field(positions, gradient=True).force_gradient
    true = exact(scene).field(positions, gradient=True).force_gradient
    error = np.abs(gradient - true).max(axis=(1, 2)) / np.abs(true).max()
    assert error[smooth(scene, positions)].max() < 2e-4
    assert np.median(error[8000:]) < 1e-8

    step = 1e-5 * scene.bead.radius
    inside = norm(positions) < 0.9 * scene.bead.radius  # far from where its pieces are small
    positions, gradient = positions[inside], gradient[inside]
    for axis, shift in enumerate(step * np.eye(3)):
        ahead, behind = (tweezer.optical_force(scene, positions + s) for s in (shift, -shift))
        differences = (ahead - behind) / (2 * step)
        off = np.abs(differences - gradient[:, :, axis]).max(axis=1) / np.abs(true).max()
        assert np.median(off) < 1e-9
        assert np.quantile(off, 0.95) < 1e-6


SCENES = {
    "circular": ("silica-1um", {}),
    "averaged reflectance": ("silica-1um", {"beam": {"polarisation": "averaged-reflectance"}}),
    "moment": ("thesis-990nm", {"beam": {"torque": "thesis"}}),
    "donut": ("silica-1um", {"beam": {"profile": "donut"}}),
    "narrow cone": ("silica-1um", {"lens": {"numerical_aperture": 0.1}}),
    "total reflection": ("silica-1um", {"bead": {"refractive_index": 1.2}}),
    "reach below r": ("silica-1um", {"optics": {"table_range": 0.9}}),
    "far reach": ("silica-1um", {"optics": {"table_range": 15}}),
}


@pytest.mark.usefixtures("kept")
@pytest.mark.parametrize("kind", SCENES)
def test_every_kind_of_light(kind):
    """Force, moment and their gradients against the quadrature."""
    name, changes = SCENES[kind]
    scene = tweezer.load_scene(name).replace(**changes)
    scene = mapped(scene, table_tolerance=1e-5)
    positions = within(scene, 10_000, np.random.default_rng(83))
    read = light_force(scene).field(positions, gradient=True)
    true = exact(scene, 1e-10).field(positions, gradient=True)
    made, differentiable = force_map(scene), smooth(scene, positions)
    assert norm(read.force - true.force).max() < made.certified_error < 1e-5 * made.largest_force
    pairs = [(read.force_gradient, true.force_gradient)]
    if kind == "moment":
        pairs += [(read.moment, true.moment), (read.moment_gradient, true.moment_gradient)]
    else:
        assert not read.moment.any()
        assert not read.moment_gradient.any()
    for ours, theirs in pairs:
        off = np.abs(ours - theirs).reshape(len(ours), -1).max(axis=1) / np.abs(theirs).max()
        assert off[differentiable].max() < 0.01
        assert np.median(off) < 1e-5


@pytest.mark.usefixtures("kept")
def test_at_the_singular_places():
    """On the axis, at the focus, at d = r, where a ray of the rim is tangent, and at the range."""
    scene = mapped(tweezer.load_scene("thesis-990nm"))
    bound, r = light_force(scene), scene.bead.radius
    th = bound.light.cone.half_angle
    arc = [np.pi / 2 - th, np.pi / 2, np.pi / 2 + th]
    places = [[0, 0, z] for z in (0, 1, -1, 0.6, -0.6, 2, -3, 3)]
    places += [[np.sin(a), 0, np.cos(a)] for a in arc]
    places += [[d * np.sin(a + e), 0, d * np.cos(a + e)]
               for d in (1.1, 2, 2.9) for e in (np.arccos(1 / d), -np.arccos(1 / d))
               for a in (arc[0], arc[2])]  # fmt: skip
    positions = (1 - 1e-15) * r * np.array(places)
    positions = np.vstack([positions, positions[:, [1, 0, 2]], [1e-300, 0, 0.0], [0, 1e-20, r]])
    read, true = (each.field(positions, gradient=True) for each in (bound, exact(scene)))
    assert (read.error == force_map(scene).certified_error).all()
    assert (norm(read.force - true.force) < read.error).all()
    assert np.isfinite(read.force_gradient).all()
    off = np.abs(read.force_gradient - true.force_gradient)[smooth(scene, positions)].max()
    assert off < 1e-3 * np.abs(true.force_gradient).max()


@pytest.mark.usefixtures("kept")
def test_beyond_its_range_the_quadrature_takes_over():
    scene = mapped(tweezer.load_scene("thesis-990nm").replace(beam={"torque": "thesis"}), **SMALL)
    rng = np.random.default_rng(84)
    positions = scene.bead.radius * rng.normal(size=(300, 3))
    field = light_force(scene).field(positions, gradient=True)
    beyond = exact(scene, scene.optics.tolerance).field(positions, gradient=True)
    outside = norm(positions) > force_map(scene).range
    assert 10 < outside.sum() < 290
    assert (field.error[~outside] == force_map(scene).certified_error).all()
    for name in ("force", "moment", "force_gradient", "moment_gradient", "error"):
        ours, theirs = getattr(field, name), getattr(beyond, name)
        np.testing.assert_array_equal(ours[outside], theirs[outside])
        assert np.abs(ours - theirs).max() > 0
    # to rounding: with the gradient the rings are summed by other rays
    largest = np.abs(field.force).max()
    np.testing.assert_allclose(
        light_force(scene).field(positions).force, field.force, rtol=0, atol=5e-13 * largest
    )


@pytest.mark.usefixtures("cache_folder")
def test_a_missed_tolerance_is_told_and_certified(monkeypatch):
    monkeypatch.setattr(tabulate, "_MOST_PIECES", 150)
    scene = mapped(tweezer.load_scene("silica-1um"), table_tolerance=1e-8)
    with pytest.warns(tweezer.PhysicsWarning, match=r"errs by up to .* of the largest force: it "):
        made = force_map(scene)
    assert made.pieces <= 150
    assert made.certified_error > 1e-8 * made.largest_force
    positions = within(scene, 20_000, np.random.default_rng(85))
    force = dataclasses.replace(light_force(scene), made=made.made).field(positions).force
    assert norm(force - exact(scene, 1e-10).field(positions).force).max() < made.certified_error


# --- its file -------------------------------------------------------------------------------------


@pytest.fixture
def scene():
    return mapped(tweezer.load_scene("silica-1um"), **SMALL)


@pytest.fixture
def builds(monkeypatch):
    """A list that grows by one with every table that is made."""
    made = []
    build = tabulate.build
    module = importlib.import_module("tweezer.optics.rays.by_map")
    monkeypatch.setattr(module, "build", lambda *a, **k: made.append(k) or build(*a, **k))
    return made


def fresh(scene):
    """The table as a new process would get it."""
    _in_memory.clear()
    return force_map(scene)


def test_made_once_and_then_read(cache_folder, scene, builds):
    parts = []
    first = force_map(scene, parts.append)
    assert parts == sorted(parts)
    assert parts[-1] == 1.0
    assert first.path is not None
    assert first.path.is_relative_to(cache_folder)
    again = fresh(scene)
    assert len(builds) == 1
    assert (again.certified_error, again.path) == (first.certified_error, first.path)
    np.testing.assert_array_equal(again.made.pieces, first.made.pieces)
    # another one in memory does not ask for the file
    first.path.unlink()
    assert force_map(scene).path == first.path
    assert len(builds) == 1


@pytest.mark.usefixtures("cache_folder")
def test_one_table_for_every_power_and_size(scene, builds):
    first = force_map(scene)
    larger = fresh(scene.replace(beam={"power": "17 mW"}, bead={"radius": "0.7 um"}))
    assert len(builds) == 1
    assert larger.path == first.path
    assert larger.range == pytest.approx(0.5 * 0.7e-6)
    assert larger.largest_force == pytest.approx(first.largest_force * 17 / 50)
    places = np.array([[1e-7, 2e-7, -1e-7]])
    np.testing.assert_allclose(
        light_force(scene).of_radius(0.7e-6).field(places).force,
        light_force(scene.replace(bead={"radius": "0.7 um"})).field(places).force,
        rtol=1e-12,
    )


CHANGES = {
    "bead.refractive_index": 1.46,
    "medium.refractive_index": 1.34,
    "lens.numerical_aperture": 1.1,
    "beam.sigma": "2.4 mm",
    "beam.polarisation": "averaged-reflectance",
    "beam.torque": "thesis",
    "optics.table_tolerance": 2e-4,
    "optics.table_range": 0.51,
}


@pytest.mark.usefixtures("cache_folder")
@pytest.mark.parametrize("key", CHANGES)
def test_another_table_for_anything_it_depends_on(scene, builds, key):
    section, _, name = key.partition(".")
    force_map(scene)
    force_map(scene.replace(**{section: {name: CHANGES[key]}}))
    assert len(builds) == 2


@pytest.mark.usefixtures("cache_folder")
def test_another_table_after_a_change_of_the_sources(scene, builds, monkeypatch):
    force_map(scene)
    module = importlib.import_module("tweezer.optics.rays.by_map")
    monkeypatch.setattr(module, "_SOURCES", module._SOURCES + "# changed")
    assert force_map(scene)
    assert len(builds) == 2


#: What a table does not depend on, but by the values of the light and the keys in its own key
BY_VALUE = (
    "tweezer.values", "tweezer.scene", "tweezer.compiled", "tweezer.optics.beam",
    "tweezer.forces.equilibria", "tweezer.forces.rings",
)  # fmt: skip


def reached(name, found):
    """Modules of tweezer that a module imports when it is imported, and those that these do."""
    module = importlib.import_module(name)
    found[name] = module
    for node in ast.parse(inspect.getsource(module)).body:
        if isinstance(node, ast.ImportFrom) and node.module.startswith("tweezer"):
            inner = [f"{node.module}.{alias.name}" for alias in node.names]
            modules = [each for each in inner if each in sys.modules]
            for each in modules or [node.module]:
                if each not in found and not each.startswith(BY_VALUE):
                    reached(each, found)
    return found


@pytest.mark.parametrize(
    ("maker", "some"),
    [("tweezer.optics.rays.by_map", {"tweezer.generated.ray", "tweezer.optics.rays.rule"}),
     ("tweezer.optics.waves.by_map", {"tweezer.generated.waves", "tweezer.optics.waves.nodes"})],
)  # fmt: skip
def test_every_source_that_makes_a_table_is_in_its_key(maker, some):
    modules = reached(maker, {})
    assert some < set(modules)
    sources = sys.modules[maker]._SOURCES
    assert [name for name in modules if inspect.getsource(modules[name]) not in sources] == []


def flipped(content):
    middle = len(content) // 2
    return content[:middle] + bytes([content[middle] ^ 1]) + content[middle + 1 :]


@pytest.mark.usefixtures("cache_folder")
@pytest.mark.parametrize(
    "damage",
    [flipped, lambda content: content[:-1], lambda content: content[:20], lambda content: b""],
    ids=["a flipped bit", "cut off", "cut short", "empty"],
)
def test_a_damaged_file_is_made_again(scene, builds, damage):
    first = force_map(scene)
    first.path.write_bytes(damage(first.path.read_bytes()))
    with pytest.warns(UserWarning, match="damaged; the table is computed again"):
        second = fresh(scene)
    assert second.certified_error == first.certified_error
    fresh(scene)  # sound again
    assert len(builds) == 2


@pytest.mark.usefixtures("cache_folder")
def test_the_file_of_another_table_is_not_taken(scene):
    first, other = force_map(scene), force_map(mapped(scene, table_tolerance=1e-3))
    shutil.copy(other.path, first.path)
    with pytest.warns(UserWarning, match="damaged"):
        assert fresh(scene).certified_error == first.certified_error


def test_without_a_place_to_keep_it(cache_folder, scene, monkeypatch):
    (cache_folder / "file").touch()
    monkeypatch.setenv("XDG_CACHE_HOME", str(cache_folder / "file"))
    with pytest.warns(UserWarning, match="the table is not saved"):
        made = force_map(scene)
    assert made.path is None
    with warnings.catch_warnings():  # and that is said once
        warnings.simplefilter("error")
        assert force_map(scene).certified_error == made.certified_error


@pytest.mark.usefixtures("cache_folder")
def test_a_lock_that_is_held_for_ever_is_told_and_ends(scene, monkeypatch, caplog):
    path = force_map(scene).path
    assert [each.suffix for each in path.parent.iterdir()] == [".table"]
    path.unlink()
    monkeypatch.setattr("tweezer.optics.table._PATIENCE", 0.01)
    monkeypatch.setattr("tweezer.optics.table._LONGEST_WAIT", 0.02)
    with (
        FileLock(path.with_suffix(".lock")),
        pytest.warns(UserWarning, match="the table is not saved"),
    ):
        assert fresh(scene).path is None
    assert "waiting up to 0.02 s for another process" in caplog.text
    assert fresh(scene).path == path


PROGRAM = """
import importlib
import sys
import numpy as np
import tweezer
from tweezer.optics import light_force
from tweezer.optics.rays import tabulate
from tweezer.optics.rays import quadrature
by_map = importlib.import_module("tweezer.optics.rays.by_map")
built = []
by_map.build = lambda *a, **k: built.append(1) or tabulate.build(*a, **k)
scene = tweezer.Scene.model_validate_json(sys.argv[1])
print("ready", flush=True)
sys.stdin.readline()
force = light_force(scene).field(np.full((1, 3), 1e-7)).force
kernels = quadrature.quadrature_kernel.cache_info().currsize
print(len(built), kernels, repr(float(force[0, 2])), flush=True)
"""


def started(scene):
    return subprocess.Popen(
        [sys.executable, "-c", PROGRAM, scene.model_dump_json(exclude_none=True)],
        cwd=Path(__file__).parents[2], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
        env=dict(os.environ),
    )  # fmt: skip


@pytest.mark.usefixtures("cache_folder")
def test_of_two_processes_one_makes_the_table(scene):
    """And a third, that finds it, does not so much as load the quadrature."""
    scene = mapped(scene, table_range=1.2, table_tolerance=1e-6)
    both = [started(scene), started(scene)]
    for process in both:
        assert process.stdout.readline() == "ready\n"
    for process in both:  # both are at the same point: they ask at once
        process.stdin.write("\n")
        process.stdin.flush()
    told = [process.communicate()[0].split() for process in both]
    third = started(scene).communicate("\n")[0].splitlines()[1].split()
    assert sorted(built for built, _, _ in told) == ["0", "1"]
    assert third[:2] == ["0", "0"]
    assert {force for _, _, force in told} == {third[2]}
    assert _load(force_map(scene).path, force_map(scene).path.stem, tabulate.Made) is not None


def test_a_table_is_read_as_it_was_made(tmp_path):
    """A flag of NumPy's would compile its kernels a second time."""
    made = Lattice(
        reach=2.0, width=np.ones(2), pieces=np.ones((1, 1, 3, 4, 4)), moment=False,
        certified=1e-9, largest=1.0, seconds=0.1,
    )  # fmt: skip
    _save(tmp_path / "one.table", "key", made)
    read = _load(tmp_path / "one.table", "key", Lattice)
    for name, value in vars(made).items():
        assert type(getattr(read, name)) is type(value), name
        assert np.array_equal(getattr(read, name), value)


def test_no_map_of_the_dark_or_of_linear_light(scene):
    with pytest.raises(tweezer.SceneError, match="requires light, but the scene is dark"):
        force_map(scene.replace(beam={"power": 0}))
    assert evaluators_of(scene.replace(beam={"power": 0})) == "dark"
    linear = scene.replace(
        optics={"evaluator": "auto"}, beam={"polarisation": "linear", "jones": [1, 0]}
    )
    with pytest.raises(tweezer.SceneError, match="the same all around the axis"):
        force_map(linear)
    dark = linear.replace(beam={"power": 0}, optics={"evaluator": "map"})
    assert evaluators_of(dark) == "dark"
    with pytest.raises(tweezer.SceneError, match="requires light, but the scene is dark"):
        force_map(dark)
