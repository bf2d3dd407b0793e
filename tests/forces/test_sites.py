"""Stable equilibria beside the axes of the foci: of a known potential, and of holograms."""

import math

import numpy as np
import pytest

import tweezer
from tests.optics.waves.test_pupil import of_hologram
from tweezer.forces.equilibria import Search
from tweezer.forces.sites import starts
from tweezer.optics import light_force

SEARCH = Search(near=5e-6, spacing=4e-8, beside=4e-9, reach=5e-6, coarsest=7e-8)
#: wave numbers of an egg crate, and its shift
B = np.array([1.4e7, 1.1e7, 4.0e6])
SHIFT = np.array([3e-8, -5e-8, 1e-7])


def egg_crate(places):
    """Minus the gradient of -sum cos(B_i (x_i - s_i)): stable where every cosine is 1."""
    return -np.sin(B * (places - SHIFT))


def test_every_minimum_of_an_egg_crate_is_a_start():
    foci, half = np.array([[0, 0, 0], [1.2e-6, 0.4e-6, 0.0]]), np.array([9e-7, 9e-7, 1.7e-6])
    found = starts(foci, half, SEARCH, egg_crate)
    n = np.stack(np.meshgrid(*[np.arange(-9, 10)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    minima = SHIFT + 2 * math.pi * n / B
    inside = (np.abs(minima[:, None] - foci) < half).all(axis=2).any(axis=1)
    assert inside.sum() > 20
    for each in minima[inside]:
        assert (np.abs(found - each) < 0.05 * 2 * math.pi / B).all(axis=1).any()
    # and nothing starts at a saddle or a maximum
    assert (np.cos(B * (found - SHIFT)) > 0.5).all()


def test_no_start_is_outside_the_known_force():
    near = SEARCH._replace(known=1e-6)
    found = starts(np.zeros((1, 3)), np.full(3, 2e-6), near, egg_crate)
    assert len(found)
    assert np.linalg.norm(found, axis=1).max() < 1e-6


def hologram(foci, diameter, **changes):
    return of_hologram([{"position": each} for each in foci], polarisation="circular", jones=None,
                       power_through_pupil="50 mW").replace(
        bead={"diameter": diameter}, optics={"tolerance": 1e-8}, **changes,
    )  # fmt: skip


@pytest.fixture(scope="module")
def pair():
    """Two foci 1 um apart in phase, on a bead of 0.3 um."""
    return hologram([(0.5e-6, 0, 0), (-0.5e-6, 0, 0)], "0.3 um")


@pytest.fixture(scope="module")
def sites(pair):
    found = tweezer.characterise(pair).equilibria
    return np.array([each.position for each in found if each.stable])


def test_sites_beside_the_foci_are_stable_in_independent_evaluations(pair, sites):
    """Two foci in phase are bright where their paths differ by wavelengths, beside both axes."""
    beside = (np.abs(sites[:, 0]) < 0.2e-6) | (np.abs(sites[:, 0]) > 0.8e-6)
    assert beside.sum() >= 4
    step = 2e-9
    for place in sites:
        around = np.vstack([place, place + step * np.eye(3), place - step * np.eye(3)])
        force = tweezer.optical_force(pair, around)
        ahead, behind = np.diag(force[1:4]), np.diag(force[4:])
        assert (ahead < behind).all()


def test_sites_have_the_symmetry_of_the_light(sites):
    """Half a turn about z leaves the light of both foci as it is."""
    for place in sites:
        turned = place * [-1, -1, 1]
        assert np.linalg.norm(sites - turned, axis=1).min() < 1e-9


@pytest.mark.usefixtures("cache_folder")
def test_map_finds_the_sites_of_the_quadrature(pair, sites):
    mapped = pair.replace(optics={"evaluator": "map", "table_range": "1.5 um"})
    found = tweezer.characterise(mapped).equilibria
    stable = np.array([each.position for each in found if each.stable])
    assert len(stable) == len(sites)
    for place in sites:
        assert np.linalg.norm(stable - place, axis=1).min() < 1e-10


def test_every_focus_of_a_square_is_listed_as_stable():
    square = [(1e-6, 0, 0), (0, 1e-6, 0), (-1e-6, 0, 0), (0, -1e-6, 0)]
    trap = tweezer.characterise(hologram(square, "1 um"))
    stable = np.array([each.position for each in trap.equilibria if each.stable])
    for focus in light_force(trap.scene).foci()[:-1]:
        assert np.linalg.norm(stable - focus, axis=1).min() < 1e-7
    rows = [row.name for row in trap.card().rows if not row.detail]
    assert rows.count("another stable equilibrium") >= 3
