"""T-matrices in files of the T-matrix data format: ours, those of treams, and damaged ones."""

from __future__ import annotations

import dataclasses
import json
import math
import shutil
from pathlib import Path

import h5py
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import tweezer
from tests.optics.bodies.maxwell import Sphere, force_and_torque
from tweezer.optics.bodies.files import load_t_matrix, save_t_matrix
from tweezer.optics.bodies.t_matrix import sphere_t_matrix
from tweezer.optics.waves.sphere import mie_coefficients
from tweezer.values.errors import ResultError, SceneError

DATA = Path(__file__).parents[2] / "data"
#: Three spheres without symmetry, electric and magnetic modes, degree 4, written by treams 0.4.7
TREAMS = DATA / "treams-cluster.tmat.h5"
#: Numbers that treams computes from this file
NUMBERS = json.loads((DATA / "treams-cluster.json").read_text())
WAVELENGTH, INDEX = 1.064e-6, 1.33
WAVENUMBER = 2 * math.pi * INDEX / WAVELENGTH


def sphere(index, radius=0.2e-6, degree=4):
    a, b = mie_coefficients(((radius, index / INDEX),), WAVENUMBER, degree)
    lossless = complex(index).imag == 0
    return sphere_t_matrix(a, b, WAVENUMBER, INDEX, radius, lossless=lossless)


def cluster():
    return load_t_matrix(TREAMS)


def difference(one, other):
    return np.abs(one.matrix - other.matrix).max()


# --- our files --------------------------------------------------------------------------------


@pytest.mark.parametrize("polarisation", ["helicity", "electric/magnetic"])
@pytest.mark.parametrize("body", [cluster(), sphere(1.57), sphere(0.26 + 6.97j)],
                         ids=["cluster", "sphere", "gold"])  # fmt: skip
def test_saved_t_matrix_loads_unchanged(tmp_path, body, polarisation):
    path = save_t_matrix(body, tmp_path / "body.tmat.h5", polarisation=polarisation)
    loaded = load_t_matrix(path)
    assert difference(loaded, body) < 1e-15
    for name in ("wavenumber", "refractive_index", "radius"):
        assert getattr(loaded, name) == pytest.approx(getattr(body, name), rel=1e-14)
    assert loaded.lossless is body.lossless
    assert loaded.error == pytest.approx(body.error, abs=1e-14)
    with h5py.File(path) as file:
        assert set(file["modes/polarization"].asstr()[:]) == (
            {"positive", "negative"} if polarisation == "helicity" else {"electric", "magnetic"}
        )


def test_save_method_writes_the_same_file(tmp_path):
    body = cluster()
    body.save(tmp_path / "body.tmat.h5", polarisation="electric/magnetic", permittivity=2.25)
    loaded = load_t_matrix(tmp_path / "body.tmat.h5", radius=body.radius)
    assert difference(loaded, body) < 1e-15


def test_save_refuses_other_endings_and_polarisations(tmp_path):
    with pytest.raises(ResultError, match=r"body\.h5: must end in \.tmat\.h5"):
        save_t_matrix(cluster(), tmp_path / "body.h5")
    with pytest.raises(ValueError, match="polarisation = 'linear': must be 'helicity' or"):
        save_t_matrix(cluster(), tmp_path / "body.tmat.h5", polarisation="linear")
    assert not list(tmp_path.iterdir())


# --- files of treams --------------------------------------------------------------------------


def test_treams_file_is_read_with_its_units_and_geometry():
    body = cluster()
    assert body.degree == 4
    assert body.wavenumber == pytest.approx(2 * math.pi * 1.33 / 1064e-9, rel=1e-14)
    assert body.refractive_index == pytest.approx(1.33, rel=1e-14)
    assert body.radius == pytest.approx((math.hypot(0, 95, 85) + 50) * 1e-9, rel=1e-14)
    assert body.lossless
    assert body.reciprocity < 1e-12
    assert body.error == body.unitarity < 1e-8


def test_helicity_elements_agree_with_treams():
    body = cluster()
    rows = body.modes.tolist()
    for element in NUMBERS["helicity_elements"]:
        i, j = rows.index(element["scattered"]), rows.index(element["incident"])
        assert body.matrix[i, j] == pytest.approx(complex(*element["value"]), abs=1e-16)


def test_extinction_of_plane_waves_agrees_with_treams():
    """The reference uses the same vector spherical waves as treams."""
    body = cluster()
    around = Sphere(body.modes)
    mean = -2 * math.pi / body.wavenumber**2 * np.trace(body.matrix).real
    assert mean == pytest.approx(NUMBERS["average_extinction"], rel=1e-12)
    for wave in NUMBERS["plane_waves"]:
        E = np.array([complex(*each) for each in wave["polarisation"]])
        incident = around.amplitudes(
            around.plane_waves(np.array([wave["direction"]]), np.array([E]))
        )
        scattered = body.matrix @ incident
        extinction = -np.vdot(incident, scattered).real / body.wavenumber**2
        scattering = np.vdot(scattered, scattered).real / body.wavenumber**2
        assert extinction == pytest.approx(wave["extinction"], rel=1e-12)
        assert scattering == pytest.approx(wave["scattering"], rel=1e-12)


def test_force_and_torque_on_the_body_of_a_file_agree_with_the_stress_tensor():
    """All six components, for a tilted body off the axis in elliptic light."""
    body = cluster()
    scene = tweezer.load_scene("silica-1um").replace(
        optics={"theory": "waves", "tolerance": 1e-6},
        medium={"refractive_index": INDEX},
        beam={"polarisation": "linear", "jones": [[0.6, 0], [0.3, 0.74]], "wavelength": WAVELENGTH},
        bead={
            "shape": "t-matrix", "file": str(TREAMS), "radius": body.radius, "density": 1050,
            "material": None, "refractive_index": None,
        },
    )  # fmt: skip
    position, orientation = np.array([0.31e-6, -0.2e-6, 0.4e-6]), np.array([0.5, -0.3, 0.7, 0.41])
    rotation = Rotation.from_quat(orientation, scalar_first=True).as_matrix()
    force, torque, _ = force_and_torque(scene, body, position, rotation)
    orientation /= np.linalg.norm(orientation)
    found = tweezer.optical_force(scene, position, orientation)
    assert found == pytest.approx(force, abs=1e-12 * np.abs(force).max())
    found = tweezer.optical_torque(scene, position, orientation)
    assert found == pytest.approx(torque, abs=1e-12 * np.abs(torque).max())


# --- other ways to write the same -------------------------------------------------------------


@pytest.fixture
def copy(tmp_path):
    """A copy of the file of treams, and a function that opens it for changes."""
    path = tmp_path / "body.tmat.h5"
    shutil.copy(TREAMS, path)
    return path


def replace(file, name, value, unit=None):
    if name in file:
        unit = file[name].attrs.get("unit", unit)
        del file[name]
    file[name] = value
    if unit is not None:
        file[name].attrs["unit"] = unit


K0 = 2 * math.pi / 1064e-9
FREQUENCIES = [
    ("vacuum_wavelength", 1.064, "um"), ("vacuum_wavelength", 1.064, "µm"),
    ("vacuum_wavelength", 1.064e-6, "m"),
    ("frequency", 299792.458 / 1064, "THz"), ("frequency", 299792458 / 1064, "ns^{-1}"),
    ("vacuum_wavenumber", 1e7 / 1064, "cm^{-1}"),
    ("angular_frequency", 299792458 * K0, "s^{-1}"), ("angular_frequency", 299792458 * K0, "rad/s"),
    ("angular_vacuum_wavenumber", K0 * 1e-6, "1/um"),
]  # fmt: skip


@pytest.mark.parametrize(("key", "value", "unit"), FREQUENCIES)
def test_every_frequency_key_and_unit_is_read(copy, key, value, unit):
    with h5py.File(copy, "a") as file:
        del file["angular_vacuum_wavenumber"]
        replace(file, key, value, unit)
    assert load_t_matrix(copy).wavenumber == pytest.approx(K0 * 1.33, rel=1e-14)


def permuted(file, seed=1):
    order = np.random.default_rng(seed).permutation(48)
    replace(file, "tmatrix", file["tmatrix"][0][order][:, order])
    for key in ("l", "m", "polarization"):
        replace(file, f"modes/{key}", file[f"modes/{key}"][:][order])


def other_names(file):
    names = {b"electric": "tm", b"magnetic": "te"}
    replace(file, "modes/polarization", [names[each] for each in file["modes/polarization"][:]])


def fixed_length(file):
    replace(file, "modes/polarization", file["modes/polarization"][:].astype("S9"))
    replace(file, "modes/l", file["modes/l"][:].astype(float))
    file["angular_vacuum_wavenumber"].attrs["unit"] = np.array([b"nm^{-1}"])


def separate_lists(file):
    order = np.random.default_rng(2).permutation(48)
    replace(file, "tmatrix", file["tmatrix"][:][:, order])
    for key in ("l", "m", "polarization"):
        values = file[f"modes/{key}"][:]
        replace(file, f"modes/{key}_scattered", values[order])
        replace(file, f"modes/{key}_incident", values)
        del file[f"modes/{key}"]


def one_origin(file):
    file["modes/index"] = np.zeros(48, int)
    replace(file, "modes/positions", np.zeros((1, 3)), "nm")


def medium_by_index(file):
    del file["embedding/relative_permittivity"], file["embedding/relative_permeability"]
    file["embedding/refractive_index"] = [1.33]


def matrix_in_single_frequency(file):
    replace(file, "tmatrix", file["tmatrix"][0])


@pytest.mark.parametrize(
    "change",
    [permuted, other_names, fixed_length, separate_lists, one_origin, medium_by_index,
     matrix_in_single_frequency],
)  # fmt: skip
def test_other_layouts_of_the_same_body_are_read(copy, change):
    with h5py.File(copy, "a") as file:
        change(file)
    assert difference(load_t_matrix(copy), cluster()) == 0


def test_polarisation_names_of_helicity_modes_are_read(tmp_path):
    path = cluster().save(tmp_path / "body.tmat.h5")
    with h5py.File(path, "a") as file:
        names = {"positive": "plus", "negative": "minus"}
        found = [names[each] for each in file["modes/polarization"].asstr()[:]]
        replace(file, "modes/polarization", found)
    assert difference(load_t_matrix(path), cluster()) == 0


def several_wavelengths(file):
    T = file["tmatrix"][0]
    replace(file, "tmatrix", np.array([T * factor for factor in (0.5, 1, 0.25)]))
    del file["angular_vacuum_wavenumber"]
    replace(file, "vacuum_wavelength", [800.0, 1064.0, 1200.0], "nm")
    replace(file, "embedding/relative_permittivity", [1.332**2, 1.33**2, 1.329**2])


def test_wavelength_selects_a_t_matrix(copy):
    with h5py.File(copy, "a") as file:
        several_wavelengths(file)
    for asked, factor, index in (("800 nm", 0.5, 1.332), (1.064e-6, 1, 1.33)):
        found = load_t_matrix(copy, wavelength=asked, refractive_index=index)
        assert np.array_equal(found.matrix, factor * cluster().matrix)
        assert found.refractive_index == pytest.approx(index, rel=1e-14)


@pytest.mark.parametrize(
    ("shape", "lengths", "radius"),
    [
        ("sphere", {"radius": 100}, 100), ("spheroid", {"radiusxy": 50, "radiusz": 120}, 120),
        ("ellipsoid", {"radiusx": 50, "radiusy": 70, "radiusz": 60}, 70),
        ("cylinder", {"radius": 30, "height": 80}, 50),
        ("cube", {"length": 100}, 50 * math.sqrt(3)),
        ("rectangular_cuboid", {"lengthx": 20, "lengthy": 40, "lengthz": 40}, 30),
        ("torus", {"radius_major": 100, "radius_minor": 20}, 120),
        ("ring", {"radius_major": 40, "radius_minor": 20, "height": 60}, 50),
        ("convex_polyhedron", {"points": [[30, 0, 40], [-10, 0, 0], [0, 10, 0], [0, 0, 1]]}, 50),
        ("sphere", {"radius": 100, "position": [0, 30, 40]}, 150),
        ("sphere", {"radius": 100, "position": [0, 30, 40], "expansion_center": [0, 30, 0]}, 140),
        ("helix", {"radius_helix": 100}, None),
    ],
)  # fmt: skip
def test_enclosing_radius_follows_from_the_geometry(copy, shape, lengths, radius):
    with h5py.File(copy, "a") as file:
        del file["scatterer_0"], file["scatterer_1"], file["scatterer_2"]
        geometry = file.create_group("scatterer/geometry")
        geometry.attrs["shape"], geometry.attrs["unit"] = shape, "nm"
        for key, value in lengths.items():
            geometry[key] = value
    if radius is None:
        with pytest.raises(SceneError, match="does not determine the size of the body; give radiu"):
            load_t_matrix(copy)
    else:
        assert load_t_matrix(copy).radius == pytest.approx(radius * 1e-9, rel=1e-14)
    assert load_t_matrix(copy, radius="0.2 um").radius == 0.2e-6


@pytest.mark.parametrize(
    ("body", "permittivity", "lossless"),
    [
        (sphere(1.57), None, True), (sphere(1.57 + 1e-3j), None, False),
        (sphere(1.57), 1.57**2, True), (sphere(1.57 + 1e-12j), (1.57 + 1e-6j) ** 2, False),
    ],
)  # fmt: skip
def test_absorption_follows_from_permittivity_or_t_matrix(tmp_path, body, permittivity, lossless):
    path = body.save(tmp_path / "body.tmat.h5", permittivity=permittivity)
    with h5py.File(path, "a") as file:
        del file.attrs["keywords"], file["scatterer/material"].attrs["keywords"]
    assert load_t_matrix(path).lossless is lossless


def test_error_is_the_accuracy_unless_the_t_matrix_contradicts_it(tmp_path):
    rng = np.random.default_rng(5)
    body = sphere(1.57)
    noise = rng.normal(size=body.matrix.shape) * 1e-9
    for stated, within in ((1e-7, (1e-7, 1e-7)), (1e-13, (1e-9, 1e-7)), (0.0, (1e-9, 1e-7))):
        noisy = dataclasses.replace(body, matrix=body.matrix + noise, error=stated)
        loaded = load_t_matrix(noisy.save(tmp_path / "body.tmat.h5"))
        assert within[0] <= loaded.error <= within[1]


# --- damaged and unsuitable files -------------------------------------------------------------


def put(name, value, unit=None):
    return lambda file: replace(file, name, value, unit)


def drop(*names):
    def change(file):
        for name in names:
            del file[name]

    return change  # fmt: skip


def attribute(name, key, value):
    return lambda file: file[name].attrs.__setitem__(key, value)


def no_attribute(name, key):
    return lambda file: file[name].attrs.__delitem__(key)


def edited(name, function):
    return lambda file: replace(file, name, function(file[name][()]))


def element(name, at, value):
    def change(values):
        values[at] = value
        return values

    return edited(name, change)


def group(name):
    def change(file):
        del file[name]
        file.create_group(name)

    return change  # fmt: skip


def elsewhere(file):
    del file["tmatrix"]
    file["tmatrix"] = h5py.ExternalLink("other.h5", "tmatrix")


def helicity_and_parity(file):
    separate_lists(file)
    electric = file["modes/polarization_scattered"][:] == b"electric"
    replace(file, "modes/polarization_scattered", np.where(electric, b"positive", b"negative"))


def fewer_incident(file):
    separate_lists(file)
    replace(file, "tmatrix", file["tmatrix"][:][..., :30])
    for key in ("l", "m", "polarization"):
        replace(file, f"modes/{key}_incident", file[f"modes/{key}_incident"][:30])


def two_frequencies(file):
    file["vacuum_wavelength"] = 1060.0
    file["vacuum_wavelength"].attrs["unit"] = "nm"


def several_without_choice(file):
    several_wavelengths(file)
    replace(file, "embedding/relative_permittivity", 1.33**2)


def many_wavelengths(file):
    replace(file, "tmatrix", np.repeat(file["tmatrix"][:], 20, axis=0))
    del file["angular_vacuum_wavenumber"]
    replace(file, "vacuum_wavelength", np.linspace(400, 780, 20), "nm")


KEY = "angular_vacuum_wavenumber"
MEDIUM = "embedding/relative_permittivity"
GEOMETRY = "scatterer_0/geometry"
ASKED = {"wavelength": "1064 nm"}
CHANGES = {
    # change of the file, part of the message, arguments
    "no-t-matrix": (drop("tmatrix"), "tmatrix: missing"),
    "t-matrix-group": (group("tmatrix"), "tmatrix: is a group"),
    "t-matrix-real": (edited("tmatrix", lambda T: T.real), "tmatrix: has values of type float64"),
    "t-matrix-text": (put("tmatrix", "T"), "tmatrix: has values of type object"),
    "t-matrix-vector": (edited("tmatrix", lambda T: T[0, 0]), r"tmatrix: has the shape \(48,\)"),
    "t-matrix-4d": (edited("tmatrix", lambda T: T[None]), r"has the shape \(1, 1, 48, 48\)"),
    "t-matrix-empty": (edited("tmatrix", lambda T: T[:0]), r"has the shape \(0, 48, 48\)"),
    "t-matrix-small": (edited("tmatrix", lambda T: T[:, :30, :30]), r"\(1, 30, 30\) for 48 scat"),
    "t-matrix-not-square": (edited("tmatrix", lambda T: T[:, :, :46]), r"\(1, 48, 46\) for 48"),
    "nan": (element("tmatrix", (0, 3, 4), np.nan), "tmatrix: contains NaN or infinity"),
    "infinity": (element("tmatrix", (0, 3, 4), np.inf), "tmatrix: contains NaN or infinity"),
    "huge": (element("tmatrix", (0, 3, 4), 1e200), "tmatrix: has an element of size 1e.200"),
    "elsewhere": (elsewhere, "tmatrix: is stored in another file"),
    "gain": (edited("tmatrix", lambda T: -T), "tmatrix: scatters .* more than it receives"),
    "gain-beyond-accuracy": (
        lambda file: (file["computation"].attrs.__setitem__("accuracy", 1e-9),
                      edited("tmatrix", lambda T: T * 1.001)(file)),
        "must be at most 1e-06",
    ),
    "accuracy-text": (attribute("computation", "accuracy", "high"), "accuracy = 'high': must be"),
    "accuracy-negative": (attribute("computation", "accuracy", -1.0), "accuracy = '-1.0': must be"),
    "accuracy-nan": (attribute("computation", "accuracy", np.nan), "accuracy = 'nan': must be 0"),
    "no-modes": (drop("modes"), "modes/l: missing"),
    "no-l": (drop("modes/l"), "modes/l: missing"),
    "no-m": (drop("modes/m"), "modes/m: missing"),
    "no-polarisation": (drop("modes/polarization"), "modes/polarization: missing"),
    "l-text": (put("modes/l", ["1"] * 48), "modes/l: has values of type object"),
    "l-empty": (put("modes/l", np.zeros(0, int)), "modes/l: is empty"),
    "l-negative": (element("modes/l", 5, -1), "modes/l = -1: must be at least 1"),
    "l-zero": (element("modes/l", 5, 0), "modes/l = 0: must be at least 1"),
    "l-half": (edited("modes/l", lambda l: l + 0.5), "modes/l = 1.5: must be an integer"),
    "l-nan": (edited("modes/l", lambda l: l * np.nan), "modes/l = nan: must be an integer"),
    "l-huge": (element("modes/l", 5, 10**6), "l = 1, m = 1, magnetic is missing"),
    "l-short": (edited("modes/l", lambda l: l[:-1]), "differ in length .modes/l 47, modes/m 48"),
    "m-beyond-l": (element("modes/m", 0, 3), "modes/m = 3: must be from -1 to 1 for l = 1"),
    "duplicate": (element("modes/m", 0, 0), "l = 1, m = 0, electric occurs twice"),
    "missing": (element("modes/l", 0, 5), "l = 1, m = -1, electric is missing"),
    "unknown-polarisation": (element("modes/polarization", 2, b"x"), "modes/polarization = 'x'"),
    "no-name": (element("modes/polarization", 2, b""), "modes/polarization = '': must be"),
    "mixed": (element("modes/polarization", 2, b"positive"), "modes/polarization: mixes helicity"),
    "bases-differ": (helicity_and_parity, "scattered helicity and incident electric/magnetic"),
    "fewer-incident": (fewer_incident, "has 48 scattered and 30 incident modes"),
    "several-origins": (put("modes/index", np.arange(48) % 3), "modes/index: has modes about sev"),
    "positions": (put("modes/positions", np.ones((2, 3)), "nm"), "modes/positions: has 2 origins"),
    "displaced": (put("modes/positions", [[0, 0, 5.0]], "nm"), "modes/positions = 0 0 5: must be"),
    "no-frequency": (drop(KEY), "vacuum_wavelength: missing; one of"),
    "no-unit": (no_attribute(KEY, "unit"), f"{KEY}: has no attribute unit"),
    "unknown-unit": (attribute(KEY, "unit", "furlong"), f"{KEY}, unit = 'furlong': must be an inv"),
    "length-unit": (attribute(KEY, "unit", "nm"), f"{KEY}, unit = 'nm': must be an inverse"),
    "unit-number": (attribute(KEY, "unit", 3.0), f"{KEY}, unit = '3.0': must be"),
    "zero": (put(KEY, 0.0), f"{KEY} = 0: must be finite and positive"),
    "negative": (put(KEY, -0.006), f"{KEY} = -0.006: must be finite and positive"),
    "frequency-nan": (put(KEY, np.nan), f"{KEY} = nan: must be finite"),
    "frequency-complex": (put(KEY, 0.006 + 0.001j), f"{KEY}: has values of type complex128"),
    "two-values": (put(KEY, [0.006, 0.007]), f"{KEY}: has 2 values; must have 1"),
    "disagreeing": (two_frequencies, f"{KEY}: is another wavelength than vacuum_wavelength"),
    "several": (several_without_choice, "800 nm, 1064 nm, 1200 nm: has several; choose one"),
    "between": (several_without_choice, "does not include 900 nm as asked", {"wavelength": 9e-7}),
    "many": (many_wavelengths, "20 wavelengths from 400 nm to 780 nm: does not include 1064 nm as "
             "asked, the nearest is 780 nm", ASKED),
    "other-wavelength": (put(KEY, 0.0059), "does not include 1064 nm as asked", ASKED),
    "other-medium": (None, "index of 1.33; must be 1.36", {"refractive_index": 1.36}),
    "no-medium": (drop("embedding"), f"{MEDIUM}: missing"),
    "absorbing-medium": (put(MEDIUM, 1.77 + 0.01j), f"{MEDIUM} = 1.77.0.01j: the medium absorbs"),
    "metallic-medium": (put(MEDIUM, -1.77), f"{MEDIUM} = -1.77: must be positive"),
    "medium-nan": (put(MEDIUM, np.nan), f"{MEDIUM} = nan: must be finite"),
    "media": (put(MEDIUM, [1.77, 1.78]), f"{MEDIUM}: has 2 values; must have 1"),
    "magnetic-medium": (put("embedding/relative_permeability", 1.1), "bility = 1.1: must be 1"),
    "chiral-medium": (put("embedding/chirality", 0.1), "embedding/chirality = 0.1: must be 0"),
    "no-geometry": (drop("scatterer_1/geometry"), "scatterer/geometry: does not determine"),
    "no-scatterer": (drop("scatterer_0", "scatterer_1", "scatterer_2"), "does not determine the"),
    "no-radius": (drop(f"{GEOMETRY}/radius"), "does not determine the size of the body"),
    "radius-unit": (attribute(f"{GEOMETRY}/radius", "unit", "THz"), "radius, unit = 'THz': must"),
    "radius-negative": (put(f"{GEOMETRY}/radius", -90.0), "radius = -90: must be positive"),
    "radius-text": (put(f"{GEOMETRY}/radius", "large"), "radius: has values of type object"),
    "position-2d": (put(f"{GEOMETRY}/position", [1.0, 2.0]), "position: must have three"),
    "too-large": (put(f"{GEOMETRY}/radius", 900.0), "modes/l = 1 to 4: too few for a body"),
    "asked-too-large": (None, "too few for a body of radius 1e-06 m", {"radius": "1 um"}),
    "radius-zero": (None, "radius = 0: must be positive", {"radius": 0}),
    "wavelength-unit": (None, "wavelength = 3 s: ", {"wavelength": "3 s"}),
    "index-nan": (None, "refractive_index = nan: must be finite", {"refractive_index": math.nan}),
}  # fmt: skip


@pytest.mark.parametrize("case", CHANGES.values(), ids=CHANGES)
def test_unsuitable_file_is_refused_in_one_line(copy, case):
    change, told, *asked = case
    if change is not None:
        with h5py.File(copy, "a") as file:
            change(file)
    with pytest.raises(SceneError, match=told) as refused:
        load_t_matrix(copy, **(asked[0] if asked else {}))
    message = str(refused.value)
    assert message.startswith(f"{copy}: ")
    assert "\n" not in message
    assert len(message) < len(str(copy)) + 200


BYTES = {
    "empty": lambda content: b"",
    "text": lambda content: b"l m polarization\n1 0 electric\n",
    "head": lambda content: content[:4],
    "truncated": lambda content: content[: len(content) // 2],
    "almost-whole": lambda content: content[:-5000],
    "signature": lambda content: b"\0" * 8 + content[8:],
    "middle": lambda content: content[:48] + b"\xff" * 400 + content[448:],
}


@pytest.mark.parametrize("damage", BYTES.values(), ids=BYTES)
def test_damaged_file_is_refused_in_one_line(copy, damage):
    copy.write_bytes(damage(copy.read_bytes()))
    with pytest.raises(SceneError) as refused:
        load_t_matrix(copy)
    message = str(refused.value)
    assert message.startswith(f"{copy}: ")
    assert "\n" not in message


def test_missing_file_and_folder_are_refused(tmp_path):
    with pytest.raises(SceneError, match=r"body\.tmat\.h5: no such file"):
        load_t_matrix(tmp_path / "body.tmat.h5")
    with pytest.raises(SceneError, match="is a folder; must be a file"):
        load_t_matrix(tmp_path)
