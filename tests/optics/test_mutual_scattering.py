"""Optical binding against rigid clusters, coupled dipoles, limits and its own errors."""

import functools

import numpy as np
import pytest

import tweezer
from tests.beads.test_motion import ONE
from tweezer.optics import mutual_scattering
from tweezer.optics.bodies import mutual
from tweezer.values.errors import SceneError

UM = 1e-6
BEAM = ONE["beam"]
WATER = ONE["medium"] | {"refractive_index": 1.33}
K = 2 * np.pi * 1.33 / 1.064e-6
PAIR = (((-0.3, 0.05, -0.1), 0.25, 1.45), ((0.25, -0.1, 0.2), 0.3, 1.6))
THREE = (*PAIR, ((0.1, 0.5, -0.1), 0.2, 1.5))
TWO_BEAMS = ((-0.2, 0, 0), (0.3, 0.1, 0))


def of(bead, foci=((0, 0, 0),), **sections):
    """Return the scene of a bead or several in the light of beams with foci, um."""
    data = {key: value for key, value in ONE.items() if key not in ("start", "name")}
    beams = [BEAM | {"position": [x * UM for x in each]} for each in foci]
    data |= {"medium": WATER, "bead": bead, "beam": beams, "simulation": {"duration": "1 ms"}}
    return tweezer.load_scene(data | sections)


def sphere(place, radius, index):
    """Return a bead of a radius at a place, um."""
    return {
        "diameter": 2 * radius * UM, "refractive_index": index, "density": 1050.0,
        "start": [x * UM for x in place],
    }  # fmt: skip


def spheres(*each, **sections):
    """Return the scene of spheres (place, radius, index), um, each of them a bead."""
    return of([sphere(*one) for one in each], **sections)


def traps(distance, index=1.57, radius=0.5, polarisation=(1, 0)):
    """Return two beads, each in its own linearly polarised trap of 100 mW, on the x axis."""
    beam = BEAM | {"polarisation": "linear", "jones": polarisation, "power_through_pupil": 0.1}
    places = [(-distance / 2, 0, 0), (distance / 2, 0, 0)]
    beams = [beam | {"position": [x * UM for x in place]} for place in places]
    return spheres(
        (places[0], radius, 1.57), (places[1], radius, index), beam=beams,
        lens=ONE["lens"] | {"numerical_aperture": 1.25},
    )  # fmt: skip


@functools.cache
def bound(distance):
    """Return the forces in two traps at a distance, um; computed once."""
    return tweezer.optical_binding(traps(distance))


@pytest.mark.parametrize("each", [PAIR, THREE])
def test_forces_add_up_to_the_force_on_a_rigid_cluster(each):
    """Momentum is conserved: the T-matrix of the cluster gives the sum, to 1e-8 of the forces."""
    found = tweezer.optical_binding(spheres(*each, foci=TWO_BEAMS))
    rigid = {
        "shape": "spheres", "density": 1050.0,
        "spheres": [
            {"position": [x * UM for x in place], "radius": radius * UM, "refractive_index": index}
            for place, radius, index in each
        ],
    }  # fmt: skip
    scene = of(rigid, TWO_BEAMS, start={"position": [0, 0, 0]})
    volumes = np.array([radius**3 for _, radius, _ in each])
    centre = volumes @ np.array([place for place, _, _ in each]) / volumes.sum() * UM
    expected = tweezer.optical_force(scene, centre, [1, 0, 0, 0])
    largest = np.abs(found.scattered).max().item()
    np.testing.assert_allclose(
        (found.force + found.scattered).sum("bead"),
        expected,
        rtol=0,
        atol=1e-8 * np.linalg.norm(expected),
    )
    assert largest > 1e4 * found.error.max().item()


@pytest.mark.filterwarnings("ignore:Knudsen number")
def test_small_beads_are_coupled_dipoles():
    """In the waist of a wide beam, the force along the line of two dipoles has a closed form.

    With E = G p of a dipole, F_x = Re(p* dG/dx p)/2, over the pressure k Im(alpha) |E|^2/2.
    """
    a, r, m = 0.02, 0.12, 1.57 / 1.33
    scene = spheres(
        ((-r / 2, 0, 0), a, 1.57), ((r / 2, 0, 0), a, 1.57),
        lens=ONE["lens"] | {"numerical_aperture": 0.1},
    )  # fmt: skip
    found = tweezer.optical_binding(scene)
    k = K * UM
    ratio = (m**2 - 1) / (m**2 + 2)
    alpha = 4 * np.pi * a**3 * ratio
    alpha /= 1 - 0.6 * (k * a) ** 2 * (m**2 - 2) / (m**2 + 2) - 1j * k**3 * alpha / (6 * np.pi)

    def green(r):
        """Field of a dipole along and across the line, of unit dipoles."""
        wave = np.exp(1j * k * r) / (4 * np.pi * r**3)
        return wave * np.array([2 - 2j * k * r, (k * r) ** 2 - 1 + 1j * k * r])

    slope = (green(r + 1e-6) - green(r - 1e-6)) / 2e-6
    p = alpha / (1 - alpha * green(r))  # circular light has both components
    expected = (slope.real * abs(p) ** 2).sum() / (2 * k * alpha.imag)
    along = found.scattered.sel(axis="x").values / found.force.sel(axis="z").values
    np.testing.assert_allclose(along, [-expected, expected], rtol=0.01)


def test_bead_of_the_index_of_water_scatters_nothing():
    found = tweezer.optical_binding(traps(1.1, index=1.33))
    np.testing.assert_allclose(found.scattered, 0, atol=1e-23)
    assert not np.allclose(found.force[0], 0, atol=1e-15)


@pytest.mark.parametrize(
    ("distance", "polarisation", "along", "up"),
    [
        (1.02, (1, 0), 1.12, -0.31), (1.02, (0, 1), -0.62, 0.55), (2, (1, 0), -0.074, -0.033),
        (2, (0, 1), 0.098, -0.012), (4, (1, 0), -0.012, -0.018), (4, (0, 1), -0.030, 0.011),
    ],
)  # fmt: skip
def test_force_in_two_traps_as_in_an_independent_program(distance, polarisation, along, up):
    """The program uses the translations of treams, and its beads are at their equilibria (pN)."""
    scene, height = traps(distance, polarisation=polarisation), 0.122115 * UM
    places = np.array([each.start for each in scene.beads]) + np.array([0, 0, height])
    found = tweezer.optical_binding(scene, places)
    first, second = found.scattered.values * 1e12
    np.testing.assert_allclose(second[[0, 2]], [along, up], atol=1e-3 + 0.005 * abs(along))
    np.testing.assert_allclose(first, second * [-1, 1, 1], atol=1e-5)


def test_force_vanishes_far_apart():
    """The waves fall as 1/r, so the force of incoherent traps does too, at most."""
    near, far = (np.abs(bound(r).scattered).max().item() for r in (4, 20))
    assert far < 0.25 * near


def test_displacement_is_the_force_over_the_stiffness():
    found = bound(2)
    stiffness = -tweezer.optical_jacobian(traps(2).alone(2), found.position[1].values)
    np.testing.assert_allclose(stiffness @ found.displacement[1].values, found.scattered[1],
                               rtol=1e-5, atol=1e-20)  # fmt: skip
    outside = tweezer.optical_binding(traps(2), [[-1 * UM, 0, 0], [0, 3 * UM, 0]])
    assert np.isfinite(outside.displacement[0]).all()
    assert np.isnan(outside.displacement[1]).all()


def test_error_contains_all_higher_degrees(monkeypatch):
    """At a gap of 20 nm the force changes by less than the error up to 36 degrees."""
    found = bound(1.02)
    seen = []
    monkeypatch.setattr(mutual_scattering, "scattered_force", seen.extend)
    with pytest.raises(TypeError):
        tweezer.optical_binding(traps(1.02))
    exact = sum(each.scattered(36) for each in seen)
    off = np.linalg.norm(exact - found.scattered.values, axis=1)
    assert (off < found.error.values).all()
    assert found.attrs["degree"] < 30


@pytest.mark.parametrize(("scale", "known"), [(5, True), (40, False)])
def test_attribute_of_runs_is_within_two_percent_or_not_known(monkeypatch, scale, known):
    """The force by waves up to the degree n deviates by e^(-n/scale); n is 45 at most."""
    degrees = []

    def scattered(of, degree):
        degrees.append(degree)
        return np.full((2, 3), 1e-12 * (1 - np.exp(-degree / scale)))

    monkeypatch.setattr(mutual.Spheres, "scattered", scattered)
    scene = traps(1.02)
    largest = mutual_scattering.largest_scattered(
        scene, np.array([[-0.51, 0, 0], [0.51, 0, 0]]) * UM
    )
    if known:
        assert largest == pytest.approx(np.sqrt(3) * 1e-12, rel=0.02)
        assert max(degrees) < 40
    else:
        assert np.isnan(largest)
    assert max(degrees) <= 45


def test_remainder_of_a_series_is_at_least_its_sum():
    """Twice the geometric series of the last two changes, or the last change."""
    before, change = np.array([1.0, 1.0, 1.0, 0.0]), np.array([0.5, 0.1, 1.0, 0.0])
    expected = [1.0, 0.1, np.inf, 0.0]
    np.testing.assert_allclose(mutual._remainder(before, change), expected)


def test_positions_may_have_units_and_default_to_the_starts():
    scene = traps(2)
    given = [["-1 um", 0, 0], ["1 um", 0, 0]]
    assert tweezer.optical_binding(scene, given).equals(bound(2))
    named = tweezer.optical_binding(scene)
    assert named.bead.values.tolist() == ["1", "2"]
    assert named.scattered.dims == ("bead", "axis")


def test_unsupported_scenes_and_positions_are_refused_in_one_line(monkeypatch):
    scene = traps(2)
    for wrong, positions, message in (
        (scene.alone(1), None, r"^bead: .*; add a \[\[bead\]\]$"),
        (scene.replace(optics={"theory": "rays"}), None, "optics.theory = 'rays': .*'waves'$"),
        (scene.replace(forces={"optical": False}), None, "^forces.optical: .*; add a beam$"),
        (scene, [[0, 0, 0], [0.9 * UM, 0, 0]], "overlaps bead 1 by 100 nm; must be farther away$"),
        (scene, [[0, 0, 0], [1, 0, 0]], "waves are computed up to"),
    ):
        with pytest.raises(SceneError, match=message) as refused:
            tweezer.optical_binding(wrong, positions)
        assert len(str(refused.value).splitlines()) == 1
    monkeypatch.setattr(mutual, "_MEMORY", 0.0)
    with pytest.raises(SceneError, match=r"an error of inf pN; allowed: 2%; increase the gap$"):
        tweezer.optical_binding(scene)
    with pytest.raises(ValueError, match=r"shape \(2, 3\)"):
        tweezer.optical_binding(scene, [0, 0, 0])
