"""T-matrices of clusters of spheres against plane waves, another program and exact relations."""

import functools
import itertools

import numpy as np
import pytest
from sympy.physics.wigner import wigner_3j

from tweezer.optics.bodies import cluster
from tweezer.optics.bodies.cluster import cluster_t_matrix
from tweezer.optics.bodies.rotation import rotation_matrix
from tweezer.optics.bodies.t_matrix import modes_up_to, sphere_t_matrix
from tweezer.optics.bodies.translation import Translation, three_j
from tweezer.optics.waves.harmonics import harmonics
from tweezer.optics.waves.sphere import mie_coefficients

WATER = 1.33
WAVENUMBER = 2 * np.pi * WATER / 1.064e-6
POLYSTYRENE = 1.57 / WATER
GLASS = 1.45 / WATER
UM = 1e-6


def of(*spheres, tolerance=1e-10):
    """T-matrix of spheres given in um; computed once for the same spheres and limits."""
    return computed(spheres, tolerance, cluster.HIGHEST_DEGREE, cluster.MOST_AMPLITUDES)


@functools.cache
def computed(spheres, tolerance, *limits):
    placed = [(np.array(c) * UM, radius * UM, index) for c, radius, index in spheres]
    return cluster_t_matrix(placed, WAVENUMBER, WATER, tolerance=tolerance)


THREE = (
    ((0, 0, -0.3), 0.2, POLYSTYRENE),
    ((0.05, 0.3, 0.2), 0.2, POLYSTYRENE),
    ((0.4, -0.1, 0.2), 0.15, GLASS),
)
FOUR = (
    ((0.1, 0.1, 0.1), 0.08, POLYSTYRENE),
    ((-0.1, -0.1, 0.1), 0.08, GLASS + 0.05j),
    ((-0.1, 0.1, -0.1), 0.1, GLASS),
    ((0.1, -0.1, -0.1), 0.08, POLYSTYRENE),
)
TOUCHING = (((0, 0, -0.25), 0.25, POLYSTYRENE), ((0, 0, 0.25), 0.25, POLYSTYRENE))
PAIR = (((0, 0, -0.15), 0.12, POLYSTYRENE), ((0, 0, 0.2), 0.15, GLASS))


def difference(one, other):
    """Largest difference of S - 1 up to the smaller degree."""
    degree = min(one.degree, other.degree)
    return np.abs(one.cut(degree).change - other.cut(degree).change).max()


def turned(spheres, R):
    return tuple(((*(R @ np.array(centre)),), radius, index) for centre, radius, index in spheres)


def a_rotation(seed):
    q, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    return q * np.sign(np.linalg.det(q))


@pytest.mark.parametrize(("shorter", "longer"), [(1, 1), (3, 7), (16, 19)])
def test_three_j_symbols_agree_with_sympy_in_all_digits(shorter, longer):
    found = three_j(shorter, np.array([longer]), np.arange(shorter + 1))[..., 0]
    for m, i in itertools.product({0, 1, shorter}, {0, 1, shorter, 2 * shorter}):
        expected = float(wigner_3j(shorter, longer, longer - shorter + i, -m, m, 0))
        sign = (-1) ** (longer - shorter)
        assert found[i, m] == pytest.approx(sign * expected, rel=1e-14, abs=0)


def by_plane_waves(vector, rows, columns, helicity):
    """Matrix elements of exp(i k s.d) by quadrature over the directions s of plane waves."""
    highest, nodes = max(rows, columns), 48
    u, weights = np.polynomial.legendre.leggauss(nodes)
    phi = 2 * np.pi * np.arange(2 * nodes) / (2 * nodes)
    f = harmonics(highest, 1 - u)
    waves = np.array(
        [
            ((f[highest + m] if helicity > 0 else (-1) ** m * f[highest - m])[:, n, None])
            * np.exp(1j * m * phi)
            for n in range(1, highest + 1)
            for m in range(-n, n + 1)
        ]
    ).reshape(highest * (highest + 2), -1)
    sine = np.sqrt(1 - u**2)[:, None]
    s = np.stack([sine * np.cos(phi), sine * np.sin(phi), u[:, None] + 0 * phi])
    phase = np.exp(1j * WAVENUMBER * np.tensordot(vector, s, 1)) * weights[:, None] * np.pi / nodes
    of_rows, of_columns = waves[: rows * (rows + 2)], waves[: columns * (columns + 2)]
    return of_rows.conj() * phase.ravel() @ of_columns.T


def test_translation_agrees_with_plane_waves():
    d = np.array([0.2, -0.5, 0.4]) * UM
    translation = Translation(d, WAVENUMBER, outgoing=False)
    A, B = (
        np.concatenate(each)
        for each in zip(*[translation.rows(n, 6) for n in range(1, 9)], strict=True)
    )
    assert np.abs(A + B - by_plane_waves(d, 8, 6, 1)).max() < 1e-13
    assert np.abs(A - B - by_plane_waves(d, 8, 6, -1)).max() < 1e-13


@pytest.mark.parametrize("place", [(0.1, 0.2, -0.3), (0, 0, 0.3)])
def test_displaced_sphere_agrees_with_plane_waves(place):
    radius, index, inner, outer = 0.2 * UM, POLYSTYRENE + 0.02j, 12, 5
    a, b = mie_coefficients(((radius, index),), WAVENUMBER, inner)
    n = np.concatenate([np.full(2 * n + 1, n - 1) for n in range(1, inner + 1)])
    d = np.array(place) * UM
    # light of each helicity at the sphere
    at = {helicity: by_plane_waves(d, inner, outer, helicity) for helicity in (1, -1)}
    T = of((place, radius / UM, index), tolerance=1e-14)
    modes = modes_up_to(outer)
    change = T.cut(outer).change
    for to, by in itertools.product((1, -1), repeat=2):
        kept = -(a + b) if to == by else -(a - b)
        expected = at[to].conj().T @ (kept[n, None] * at[by])
        found = change[np.ix_(modes[:, 2] == to, modes[:, 2] == by)]
        assert np.abs(found - expected).max() < 1e-13
    assert T.axial == (place[0] == 0)


def test_sphere_at_the_origin_is_the_sphere():
    T = of(((0, 0, 0), 0.3, POLYSTYRENE))
    a, b = mie_coefficients(((0.3 * UM, POLYSTYRENE),), WAVENUMBER, T.degree)
    sphere = sphere_t_matrix(a, b, WAVENUMBER, WATER, 0.3 * UM, lossless=True)
    assert difference(T, sphere) < T.error < 1e-10
    assert not T.matrix[sphere.matrix == 0].any()
    assert (T.radius, T.lossless) == (0.3 * UM, True)


def test_sphere_beside_an_invisible_one_is_the_sphere():
    alone = of(((0, 0, 0), 0.3, POLYSTYRENE))
    both = of(((0, 0, 0), 0.3, POLYSTYRENE), ((0, 0, 0.4), 0.05, 1.0))
    assert difference(both, alone) < 1e-10
    assert both.error < 1e-10


# Elements of T from treams 0.4.7 (`TMatrix.cluster(...).interaction.solve().expand(...)`), with the
# scattered and the incident mode (l, m, helicity) before each. The waves about the spheres have
# degrees up to 13 for THREE and 14 for TOUCHING.
FROM_TREAMS = [
    ((1, 0, 1), (1, 0, 1), -0.014056293528828893 + 0.09198840444348148j),
    ((1, 1, 1), (1, -1, -1), -0.0068402761927632925 + 0.010464412485517268j),
    ((2, -1, 1), (1, 1, 1), 0.006973052371264657 - 0.001839669168389131j),
    ((2, 2, -1), (2, 1, -1), -0.01733050559643419 - 0.009391622026161433j),
    ((1, 1, 1), (1, 1, -1), -0.007831589873975569 - 0.03660929027877872j),
    ((2, 0, 1), (1, 0, 1), 0.004305449665672986 - 0.018920737245387034j),
    ((2, 1, -1), (2, 1, -1), -0.015687376352023948 + 0.09421865303069404j),
]
TOUCHING_FROM_TREAMS = [
    ((1, 0, 1), (1, 0, 1), -0.06518381746564594 + 0.2296388045755576j),
    ((1, 1, 1), (1, 1, -1), 0.023025553637079612 - 0.026736224599038416j),
    ((2, 1, -1), (2, 1, -1), -0.044266330083348605 + 0.18584837156963435j),
]


def test_cluster_agrees_with_treams():
    T = of(*THREE, tolerance=1e-11)
    at = {tuple(mode): i for i, mode in enumerate(T.modes.tolist())}
    for to, by, element in FROM_TREAMS:
        assert abs(T.matrix[at[to], at[by]] - element) < 1e-12


def test_touching_spheres_agree_with_treams_at_the_same_degree(monkeypatch):
    monkeypatch.setattr(cluster, "HIGHEST_DEGREE", 14)
    T = of(*TOUCHING)
    assert 1e-8 < T.error < 1e-6
    at = {tuple(mode): i for i, mode in enumerate(T.modes.tolist())}
    for to, by, element in TOUCHING_FROM_TREAMS:
        assert abs(T.matrix[at[to], at[by]] - element) < 1e-12


@pytest.mark.parametrize("spheres", [THREE, PAIR])
def test_lossless_cluster_conserves_energy(spheres):
    T = of(*spheres, tolerance=1e-11)
    assert T.lossless
    assert T.unitarity < 1e-14
    assert T.reciprocity < 1e-14


def test_absorbing_cluster_emits_nothing():
    T = of(*FOUR)
    assert not T.lossless
    assert T.unitarity < 1e-14
    assert T.reciprocity < 1e-14
    assert np.linalg.eigvalsh(T.change + T.change.conj().T).min() < -1e-3


@pytest.mark.parametrize("spheres", [FOUR, PAIR])
def test_turned_cluster_has_the_turned_t_matrix(spheres):
    R = a_rotation(3)
    T, other = of(*spheres), of(*turned(spheres, R))
    D = rotation_matrix(T.degree, R)
    assert np.abs(D @ T.change @ D.conj().T - other.change).max() < 1e-10
    assert not other.axial


# a sphere of the medium's index does nothing but take the symmetry away
@pytest.mark.parametrize("centre", [(0.5, 0, 0), (0.2, 0.3, 0.5)])
def test_cluster_on_a_line_agrees_with_the_same_without_symmetry(centre):
    assert difference(of(*PAIR, (centre, 0.01, 1.0)), of(*PAIR)) < 2e-11


def test_cluster_in_a_plane_agrees_with_the_same_without_symmetry():
    flat = tuple(((2 * x, 2 * y, 0), *rest) for (x, y, _), *rest in FOUR[:3])
    assert difference(of(*flat), of(*flat, ((0, 0.1, 0.3), 0.01, 1.0))) < 2e-11


def test_elements_that_symmetry_forbids_are_zero():
    T = of(*PAIR)
    assert T.axial
    l, m, helicity = T.modes.T
    # of helicity +1, order m is helicity -1 of order -m
    mirrored = 2 * (l * l - 1 + l - m) + (helicity > 0)
    assert np.array_equal(np.abs(T.matrix), np.abs(T.matrix[np.ix_(mirrored, mirrored)]))


@pytest.mark.parametrize(
    "spheres",
    [TOUCHING, PAIR, FOUR, (TOUCHING[0], ((0, 0, 0.08), 0.08, 1.8)), turned(PAIR, a_rotation(3))],
)
def test_stated_error_exceeds_the_true_one(spheres):
    exact = of(*spheres, tolerance=1e-7)
    assert exact.error < 1e-7
    for tolerance in (1e-2, 1e-4, 1e-5):
        T = of(*spheres, tolerance=tolerance)
        assert np.abs(T.change - exact.change).max() < T.error + exact.error
        assert T.error < tolerance


def test_touching_metal_spheres_state_a_large_error(monkeypatch):
    monkeypatch.setattr(cluster, "HIGHEST_DEGREE", 24)
    gold = (0.26 + 6.97j) / WATER
    T = of(((0, 0, -0.05), 0.05, gold), ((0, 0, 0.05), 0.05, gold))
    assert T.error > 0.1


def test_limit_on_amplitudes_is_kept(monkeypatch):
    monkeypatch.setattr(cluster, "MOST_AMPLITUDES", 300)
    T = of(*FOUR)
    assert 1e-10 < T.error < 2
    assert difference(T, of(*FOUR)) < T.error


def test_numbers_that_overflow_end_the_degrees():
    tiny = 1e-4
    T = of(((0, 0, -tiny), tiny, 3.0), ((0, 0, tiny), tiny, 3.0), tolerance=1e-15)
    assert np.isfinite(T.matrix).all()
    assert 1e-15 < T.error / np.abs(T.change).max() < 1e-3


def test_small_cluster_has_the_relative_tolerance():
    near = of(((0, 0, -0.005), 0.004, GLASS), ((0, 0, 0.005), 0.004, GLASS))
    assert near.error < 1e-10 * np.abs(near.change).max() + 1e-13


def test_overlapping_spheres_are_refused():
    match = r"spheres 1 and 2: overlap, .*4.9e-07 m apart .* 5e-07 m; spheres may touch at most$"
    with pytest.raises(ValueError, match=match):
        of(TOUCHING[0], ((0, 0, 0.24), 0.25, POLYSTYRENE))


def test_touching_spheres_may_overlap_by_rounding():
    T = of(TOUCHING[0], ((0, 0, 0.25 * (1 - 1e-12)), 0.25, POLYSTYRENE), tolerance=1e-4)
    assert T.error < 1e-4
