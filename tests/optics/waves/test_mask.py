"""Light through arrays of pixels, against plane waves and exact coefficients of coarse arrays."""

import math
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.special import eval_jacobi

import tweezer
from tests.optics.waves.test_pupil import (
    EVEN,
    N_M,
    NA,
    ONE,
    PLACES,
    VACUUM,
    in_lens,
)
from tests.reference.plane_waves import Light, Sphere, lens, push
from tweezer import SceneError
from tweezer.optics.mask import Mask, mask_of
from tweezer.optics.waves.binding import _rules
from tweezer.optics.waves.nodes import Rule
from tweezer.optics.zernike import projected

RADIUS = 2.5e-3
SILICA = Sphere(((0.5e-6, 1.45),))


def arcs(values, width, rho, orders):
    """Harmonics of an array on circles, exact between the crossings of circle and grid, (n, m)."""
    rows, columns = values.shape
    size, found = width / columns, []
    for r in rho:
        cuts = [0.0, 2 * math.pi]
        for j in range(columns + 1):
            if abs(c := size * (j - columns / 2) / r) < 1:
                cuts += [math.acos(c), 2 * math.pi - math.acos(c)]
        for i in range(rows + 1):
            if abs(s := size * (i - rows / 2) / r) < 1:
                cuts += [math.asin(s) % (2 * math.pi), math.pi - math.asin(s)]
        cuts = np.sort(cuts)
        middle = (cuts[1:] + cuts[:-1]) / 2
        j = np.floor(r * np.cos(middle) / size + columns / 2).astype(int)
        i = np.floor(r * np.sin(middle) / size + rows / 2).astype(int)
        there = (j >= 0) & (j < columns) & (i >= 0) & (i < rows)
        of = np.where(there, values[np.clip(i, 0, rows - 1), np.clip(j, 0, columns - 1)], 0)
        m = np.array(orders)[:, None]
        half = (cuts[1:] - cuts[:-1]) / 2
        whole = np.exp(-1j * m * middle) * half * np.sinc(m * half / math.pi)
        found.append((of * whole).sum(axis=1) / math.pi)
    return np.array(found)


def exact(values, width, terms):
    """Coefficients of terms [n, m] of an array: panels between radii where circles touch lines."""
    rows, columns = values.shape
    size = width / columns
    x = np.abs(size * (np.arange(columns + 1) - columns / 2))
    y = np.abs(size * (np.arange(rows + 1) - rows / 2))
    radii = np.concatenate([x, y, np.hypot(x[:, None], y).ravel(), [0.0, 1.0]])
    radii = np.unique(np.round(radii[radii <= 1], 14))
    u, weight = np.polynomial.legendre.leggauss(40)
    v = (u + 1) / 2
    found = np.zeros(len(terms), complex)
    orders = sorted({m for _, m in terms})
    for a, b in pairwise(radii):
        rho = a + (b - a) * v**2 * (3 - 2 * v)  # roots at both ends become smooth
        share = weight / 2 * (b - a) * 6 * v * (1 - v) * rho
        t = arcs(values, width, rho, orders)
        for at, (n, m) in enumerate(terms):
            radial = share * radial_polynomial(n, abs(m), rho)
            found[at] += 2 * (n + 1) * (radial * t[:, orders.index(m)]).sum()
    return found


def radial_polynomial(n, m, rho):
    return rho**m * eval_jacobi((n - m) // 2, 0, m, 2 * rho**2 - 1)


def terms_up_to(degree):
    return [(n, m) for n in range(degree + 1) for m in range(-n, n + 1, 2)]


@pytest.mark.parametrize(("shape", "width"), [((4, 4), 2.0), ((3, 5), 1.5), ((5, 2), 0.9)])
def test_coefficients_are_the_exact_ones_of_a_coarse_array(shape, width):
    random = np.random.default_rng(1)
    values = random.normal(size=shape) + 1j * random.normal(size=shape)
    terms = terms_up_to(14)
    found = projected(values, width, 14)
    expected = exact(values, width, terms)
    np.testing.assert_allclose([found[n, 14 + m] for n, m in terms], expected, rtol=0, atol=1e-12)


def test_coefficients_of_512_pixels_do_not_depend_on_the_axis_of_integration():
    """An array turned by a right angle exchanges the sums along x and along y."""
    values = np.random.default_rng(2).choice([1.0, -1.0], (512, 512)) + 0j
    degree = 30
    here, there = (projected(each, 2.0, degree) for each in (values, np.rot90(values, -1)))
    orders = np.arange(-degree, degree + 1)
    largest = np.abs(here).max()
    np.testing.assert_allclose(there, here * 1j ** (-orders % 4), rtol=0, atol=1e-11 * largest)
    finer = projected(np.kron(values, np.ones((2, 2))), 2.0, degree)
    np.testing.assert_allclose(finer, here, rtol=0, atol=1e-11 * largest)


# --- forces ---------------------------------------------------------------------------------------

DEGREE = 44
RANDOM = np.random.default_rng(3)
PHASES = RANDOM.uniform(0, 2 * math.pi, (4, 4))
FIELD = RANDOM.uniform(0.2, 1, (4, 4)) * np.exp(1j * PHASES)


def masked(tmp_path, values, scene=EVEN, **keys):
    """Return a scene with a mask in a file."""
    file = tmp_path / "mask.npy"
    np.save(file, values)
    described = scene.model_dump(exclude_none=True)
    described["beam"] |= {"mask": str(file), **keys}
    described["optics"]["tolerance"] = 1e-9
    described["simulation"]["loss_distance"] = 2e-6
    if described["beam"]["polarisation"] != "linear":
        described["beam"].pop("jones", None)
    return tweezer.load_scene(described)


def factor(values, degree=DEGREE, width=2.0):
    """Return T of the exact coefficients, as a function of rho and phi."""
    terms = terms_up_to(degree)
    coefficients = exact(values, width, terms)

    def of(rho, phi):
        harmonics = dict.fromkeys(range(-degree, degree + 1), 0)
        for (n, m), c in zip(terms, coefficients, strict=True):
            harmonics[m] = harmonics[m] + c * radial_polynomial(n, abs(m), rho)
        return sum(t * np.exp(1j * m * phi) for m, t in harmonics.items())

    return of


def waves_of(of, kind="sine", uneven=60, **light):
    angle = math.asin(NA / light.get("cover", (N_M,))[0])
    sine = math.sin if kind == "sine" else math.tan
    turn = np.sin if kind == "sine" else np.tan
    return Light(
        N_M, VACUUM, angle, lens(angle, kind=kind), light.get("polarisation", (1, 0)), 0,
        light.get("cover"), lambda theta, phi: of(turn(theta) / sine(angle), phi), uneven,
    )  # fmt: skip


CASES = {
    "phase": (np.exp(1j * PHASES), PHASES, {}, {}, {}),
    "circular": (np.exp(1j * PHASES), PHASES, {"polarisation": (ONE, 1j * ONE)},
                 {"polarisation": "circular"}, {}),
    "field": (FIELD, FIELD, {}, {"mask_kind": "field"}, {}),
    "behind a cover": (np.exp(1j * PHASES), PHASES, {"cover": (1.518, 5e-6)}, {},
                       {"cover": (1.518, 5e-6)}),
    "tan map": (np.exp(1j * PHASES), PHASES, {"kind": "tan"}, {}, {"kind": "tan"}),
}  # fmt: skip


@pytest.mark.parametrize(("T", "values", "light", "keys", "lens"), CASES.values(), ids=CASES.keys())
def test_force_of_a_mask_is_that_of_plane_waves(tmp_path, T, values, light, keys, lens):
    """Within 1e-9 of the largest component; the stated error is not below the true one."""
    scene = in_lens(masked(tmp_path, values, **keys), **lens)
    degree = 90 if lens else DEGREE
    expected = push(waves_of(factor(T, degree), uneven=degree, **light), SILICA, PLACES[:2]).force
    expected /= exact(np.abs(T) ** 2 + 0j, 2.0, [(0, 0)])[0].real  # 1 W through the pupil
    found = tweezer.optical_force(scene, PLACES[:2])
    largest = np.abs(expected).max()
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9 * largest)
    stated = tweezer.optical_force_error(scene, PLACES[:2])
    assert (np.linalg.norm(found - expected, axis=1) <= stated + 1e-11 * largest).all()


class Vortex(Mask):
    """Exact terms of exp(i l phi), instead of pixels."""

    def terms(self, degree):
        found = np.zeros((degree + 1, 2 * degree + 1), complex)
        u, weight = np.polynomial.legendre.leggauss(200)
        rho, weight = (u + 1) / 2, weight / 2
        for n in range(2, degree + 1, 2):
            integral = (weight * rho * radial_polynomial(n, 2, rho)).sum()
            found[n, degree + 2] = 2 * (n + 1) * integral
        return found


def test_vortex_of_a_mask_is_the_vortex_of_the_beam(tmp_path, monkeypatch):
    """Zernike terms of a singular phase, whose series converges slowly, as far as they count."""
    scene = masked(tmp_path, np.zeros((4, 4)))
    vortex = scene.replace(beam={"mask": None, "vortex": 2})
    monkeypatch.setattr(
        "tweezer.optics.waves.light.mask_of",
        lambda beam, _: None if beam.mask is None else Vortex(np.ones((2, 2)) + 0j, 2.0, 0.0),
    )
    expected = tweezer.optical_force(vortex, PLACES[:2])
    found = tweezer.optical_force(scene, PLACES[:2])
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12 * np.abs(expected).max())


def test_mask_that_is_even_leaves_the_light_as_it_is(tmp_path):
    scene = masked(tmp_path, np.full((7, 7), 0.4), profile="gaussian", sigma=1.5e-3)
    expected = tweezer.optical_force(scene.replace(beam={"mask": None}), PLACES)
    found = tweezer.optical_force(scene, PLACES)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12 * np.abs(expected).max())


def terms_of(scene):
    return mask_of(scene.beam, RADIUS).terms(20)


def test_mask_turned_and_flipped_is_the_array_turned_and_flipped(tmp_path):
    scene = masked(tmp_path, PHASES)
    for keys, values in (
        ({"mask_angle": math.pi / 2}, np.rot90(PHASES, -1)),
        ({"mask_flip": "x"}, PHASES[:, ::-1]),
        ({"mask_flip": "y"}, PHASES[::-1]),
        ({"mask_flip": "both", "mask_angle": math.pi}, PHASES),
    ):
        found = terms_of(scene.replace(beam=keys))
        expected = projected(np.exp(1j * values), 2.0, 20)
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-11)


def test_amplitude_and_size_of_an_array_set_the_power_that_passes(tmp_path):
    """Half of a Gaussian beam is dark; a small array passes what falls on it."""
    half = np.repeat([[1.0, 0.0]], 2, axis=0)
    keys = {"profile": "gaussian", "sigma": 1.2e-3, "mask_kind": "amplitude", "power": 1.0}
    scene = masked(tmp_path, half, **keys, power_through_pupil=None)
    bare = scene.replace(beam={"mask": None, "mask_kind": "phase"})
    share = {}
    for name, each in (("half", scene), ("bare", bare)):
        share[name] = tweezer.optics.fraction_through_pupil(each.lens, each.beam)
    assert share["half"] == pytest.approx(share["bare"] / 2, rel=1e-9)
    small = scene.replace(beam={"mask_extent": 1e-3})
    along = math.erf(0.5e-3 / math.sqrt(2) / 1.2e-3)
    found = tweezer.optics.fraction_through_pupil(small.lens, small.beam)
    assert found == pytest.approx(along**2 / 2, rel=1e-8)
    through = scene.replace(beam={"power": None, "power_through_pupil": share["half"]})
    np.testing.assert_allclose(
        tweezer.optical_force(through, PLACES[:1]), tweezer.optical_force(scene, PLACES[:1]),
        rtol=1e-12,
    )  # fmt: skip


def test_body_that_is_a_sphere_feels_the_light_of_a_mask(tmp_path):
    sphere = masked(tmp_path, 0.5 * PHASES, tweezer.load_scene("polystyrene-500nm"))
    sphere = sphere.replace(optics={"tolerance": 1e-8}, simulation={"loss_distance": "1 um"})
    body = sphere.replace(bead={"shape": "spheroid", "length": "0.5 um"})
    places = PLACES[:2]
    expected = tweezer.optical_force(sphere, places)
    found = tweezer.optical_force(body, places, [1, 0, 0, 0])
    np.testing.assert_allclose(found, expected, atol=1e-7 * np.abs(expected).max())


def test_blazed_grating_moves_the_trap(tmp_path):
    """2 pi over the pupil's diameter shift the focus by half a wavelength over the aperture."""
    x = (np.arange(64) + 0.5) / 64
    scene = masked(tmp_path, np.tile(-2 * math.pi * x, (64, 1)))
    place = tweezer.characterise(scene).equilibrium.position
    assert place[0] == pytest.approx(VACUUM / NA / 2, rel=0.01)
    assert place[1] == pytest.approx(0.0, abs=1e-9)


def test_phase_of_a_hologram_is_the_mask_of_that_phase(tmp_path):
    """The phase of two equal foci along x is a binary grating, times the phase of their height."""
    k = 2 * math.pi * N_M / VACUUM
    x = (np.arange(512) + 0.5) / 256 - 1
    rho = np.hypot(x, x[:, None])
    across = x / rho.clip(1) * NA / N_M  # pixels beyond the rim are those on the rim
    sine = rho.clip(0, 1) * NA / N_M
    grating = np.pi * (np.cos(k * 1e-6 * across) < 0)
    values = grating - k * 0.2e-6 * np.sqrt(1 - sine**2)
    scene = masked(tmp_path, values)
    foci = [{"position": [sign * 1e-6, 0, 0.2e-6]} for sign in (1, -1)]
    hologram = scene.replace(beam={"mask": None, "focus": foci, "foci": "phase"})
    expected = tweezer.optical_force(scene, PLACES[:2])
    found = tweezer.optical_force(hologram, PLACES[:2])
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9 * np.abs(expected).max())


def test_two_coherent_halves_of_a_masked_beam_are_the_beam(tmp_path):
    scene = masked(tmp_path, PHASES)
    half = {"coherent": "a", "power_through_pupil": 0.25}
    described = scene.model_dump(exclude_none=True)
    described.pop("more_beams", None)
    described["beam"] = [{**described["beam"], **half}] * 2
    found = tweezer.optical_force(tweezer.load_scene(described), PLACES[:2])
    expected = tweezer.optical_force(scene, PLACES[:2])
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9 * np.abs(expected).max())


def test_rules_with_more_nodes_than_a_later_one_are_left_out():
    """The compiled sums have room for the nodes of the last rule."""
    rules = [Rule(np.zeros(n), np.zeros(n), 1.0 + i) for i, n in enumerate((8, 120, 96, 96, 108))]
    nodes = SimpleNamespace(
        up_to=lambda _: rules, variable=SimpleNamespace(phases=(1.0, 1.0)), shift=0.0
    )
    light = SimpleNamespace(
        size_parameter=2.0, wavenumber=1.0, focus=SimpleNamespace(half_angle=1.0)
    )
    assert _rules(light, nodes, 3.0) == [rules[2], rules[3], rules[4]]


# --- files ----------------------------------------------------------------------------------------


def test_image_and_archive_are_read_as_the_array(tmp_path):
    from matplotlib.image import imsave

    levels = np.random.default_rng(4).integers(0, 256, (6, 6))
    shades = np.repeat(levels[::-1, :, None], 3, axis=2).astype(np.uint8)
    imsave(tmp_path / "mask.png", shades)
    np.savez(tmp_path / "mask.npz", phase=2 * math.pi * levels / 200)
    np.save(tmp_path / "levels.npy", levels)
    scene = masked(tmp_path, 2 * math.pi * levels / 200)
    for name, keys in (("mask.png", {"mask_levels": 200}), ("mask.npz", {}),
                       ("levels.npy", {"mask_levels": 200})):  # fmt: skip
        other = scene.replace(beam={"mask": str(tmp_path / name), **keys})
        np.testing.assert_allclose(terms_of(other), terms_of(scene), rtol=0, atol=1e-12)


def test_file_is_relative_to_the_scene_and_saved_by_its_whole_path(tmp_path, monkeypatch):
    np.save(tmp_path / "mask.npy", PHASES)
    text = tweezer.shipped_scenes()["silica-1um"].read_text()
    text = text.replace("[beam]", '[beam]\nmask = "mask.npy"', 1)
    (tmp_path / "masked.toml").write_text(text)
    monkeypatch.chdir("/")
    scene = tweezer.load_scene(tmp_path / "masked.toml")
    assert scene.beam.mask == str(tmp_path / "mask.npy")
    again = tweezer.load_scene(scene.model_dump(exclude_none=True))
    assert again.beam == scene.beam


BAD_KEYS = {
    "mask_kind: requires a mask": {"mask": None, "mask_kind": "field"},
    "mask_levels: requires a mask": {"mask": None, "mask_levels": 16},
    "mask_extent: requires a mask": {"mask": None, "mask_extent": 1e-3},
    "mask_flip: requires a mask": {"mask": None, "mask_flip": "x"},
    "mask_angle: requires a mask": {"mask": None, "mask_angle": 0.1},
    "cannot be combined with a mask; add": {"vortex": 1},
    "polarisation = 'radial': cannot be": {"polarisation": "radial"},
    "cannot be combined with focus": {"focus": [{"position": [0, 0, 0]}]},
    "mask_levels": {"mask_levels": 1},
    "mask_kind": {"mask_kind": "colour"},
    "mask_flip": {"mask_flip": "z"},
    "mask_extent": {"mask_extent": -1e-3},
    "beam.mask = 3": {"mask": 3},
    "mask = '': must name a file": {"mask": ""},
    "foci: requires focus": {"mask": None, "foci": "phase"},
}


@pytest.mark.parametrize(("said", "keys"), BAD_KEYS.items(), ids=range(len(BAD_KEYS)))
def test_wrong_keys_of_a_mask_are_refused_in_one_line(tmp_path, said, keys):
    with pytest.raises(SceneError, match=said) as refusal:
        masked(tmp_path, PHASES, **keys)
    assert "\n" not in str(refusal.value)


def written(path, content):
    if isinstance(content, bytes):
        path.write_bytes(content)
    elif path.suffix == ".npz":
        np.savez(path, **content)
    else:
        np.save(path, content, allow_pickle=True)


NAN = np.where(np.eye(4) > 0, np.nan, 1.0)
BAD_FILES = {
    "no such": ("absent.npy", None, {}, "No such file"),
    "folder": ("", None, {}, "Is a directory"),
    "ending": ("a.tiff", b"II*", {}, r"must be a file \.npy"),
    "empty": ("a.npy", b"", {}, "cannot be read as .npy"),
    "damaged": ("a.npy", b"\x93NUMPY\x01", {}, "cannot be read as .npy"),
    "no array": ("a.npy", b"text" * 20, {}, "read as .npy: contains no array of numbers$"),
    "objects": ("a.npy", np.array([[1, "a"], [2, None]], object), {},
                "cannot be read as .npy: contains no array of numbers$"),
    "text as npz": ("a.npz", b"text" * 20, {}, "read as .npz: contains no array of numbers$"),
    "objects in npz": ("a.npz", {"a": np.array([[1, "a"], [2, None]], object)}, {},
                       "cannot be read as .npz: contains no array of numbers$"),
    "no image": ("a.png", b"PNG" * 20, {}, "cannot be read as .png"),
    "no archive": ("a.npz", b"PK" * 20, {}, "cannot be read as .npz"),
    "npy as npz": ("b.npz", "npy", {}, "one array"),
    "two arrays": ("a.npz", {"a": PHASES, "b": PHASES}, {}, "must contain one array, and has 2"),
    "text": ("a.npy", np.array([["a", "b"], ["c", "d"]]), {}, "must contain numbers"),
    "one row": ("a.npy", np.zeros((1, 4)), {}, "has the shape 1 x 4"),
    "line": ("a.npy", np.zeros(16), {}, "has the shape 16;"),
    "stack": ("a.npy", np.zeros((4, 4, 3)), {}, "has the shape 4 x 4 x 3"),
    "number": ("a.npy", np.float64(1.0), {}, "has the shape a number"),
    "large": ("a.npy", np.zeros((2, 4097)), {}, "2 to 4096 rows and columns"),
    "NaN": ("a.npy", NAN, {}, "contains NaN"),
    "infinite": ("a.npy", NAN * np.inf, {"mask_kind": "amplitude"}, "contains NaN or infinite"),
    "complex": ("a.npy", FIELD, {}, "contains complex numbers"),
    "negative": ("a.npy", -np.ones((4, 4)), {"mask_kind": "amplitude"}, "the amplitude -1"),
    "bright": ("a.npy", 2 * FIELD, {"mask_kind": "field"}, "must be at most 1"),
    "amplified": ("a.npy", np.full((4, 4), 1.5), {"mask_kind": "amplitude"}, "must be at most 1"),
    "dark": ("a.npy", np.zeros((4, 4)), {"mask_kind": "amplitude"}, "transmits no light"),
    "levels": ("a.npy", PHASES, {"mask_levels": 8}, "mask_levels requires whole numbers"),
    "narrow": ("a.npy", PHASES, {"profile": "gaussian", "sigma": 5e-5}, "beam.sigma = 5e-05"),
    "table": ("a.npy", PHASES, {
        "profile": "table", "profile_radius": [0, 1e-3, 1.5e-3, 2e-3],
        "profile_intensity": [1, 0.9, 0.6, 0.5],
    }, "profile_radius: ends at 0.002 m"),
    "misses": ("a.npy", np.kron(np.eye(40)[[0]].T @ np.eye(40)[[0]], np.ones((2, 2))),
               {"mask_kind": "amplitude"}, "transmits almost none"),
}  # fmt: skip


@pytest.mark.parametrize(("name", "content", "keys", "said"), BAD_FILES.values(), ids=BAD_FILES)
def test_wrong_files_are_refused_in_one_line(tmp_path, name, content, keys, said):
    scene = masked(tmp_path, PHASES)
    if isinstance(content, str):
        np.save(tmp_path / "a.npy", PHASES)
        (tmp_path / "a.npy").rename(tmp_path / name)
    elif content is not None:
        written(tmp_path / name, content)
    scene = scene.replace(beam={"mask": str(tmp_path / name), **keys})
    with pytest.raises(SceneError, match=said) as refusal:
        tweezer.optical_force(scene, PLACES[:1])
    assert "\n" not in str(refusal.value)
    assert str(tmp_path) in str(refusal.value) or keys.get("profile")


def test_rays_refuse_a_mask(tmp_path):
    scene = masked(tmp_path, PHASES)
    with pytest.raises(SceneError, match=r"beam\.mask requires wave optics"):
        scene.replace(optics={"theory": "rays"})
