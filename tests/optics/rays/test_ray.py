"""The emitted ray against a bounce-by-bounce vector ray tracer, and against published values."""

import csv
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.reference.raytracer import trace
from tweezer.generated import ray

PUBLISHED = Path(__file__).parents[2] / "data" / "ashkin1992.csv"
N_MEDIUM = 1.33


def emitted_force(direction, centre, radius, n_bead, *, averaged):
    """Force of one ray in units of n_m P/c, assembled from the emitted functions."""
    n_mP = N_MEDIUM / n_bead
    n1, n2, n3, S = ray.impact(*direction, *centre, radius)
    if S >= 1:
        return None
    if 1 / n_mP**2 <= S:
        Q_sc, G = ray.total_reflection(S)
    else:
        Q_sc, G = (ray.averaged_reflectance if averaged else ray.circular)(S, n_mP)
    force = ray.force(*direction, n1, n2, n3, radius, Q_sc, G)
    moment = ray.moment(*direction, n1, n2, n3, np.sqrt(1 - S), Q_sc, G)
    return np.array(force), np.array(moment), S


def random_ray(rng, radius):
    direction = rng.normal(size=3)
    centre = rng.normal(size=3) * radius * 0.8
    return direction / np.linalg.norm(direction), centre


@pytest.mark.parametrize("averaged", [False, True])
@pytest.mark.parametrize("n_bead", [1.0, 1.2, 1.332, 1.45, 1.57773, 2.5])
def test_force_of_a_ray(n_bead, averaged):
    """Momentum counted bounce by bounce; total internal reflection among the denser media."""
    rng, radius, hits, total = np.random.default_rng(40), 0.7, 0, 0
    for _ in range(400):
        direction, centre = random_ray(rng, radius)
        traced = trace(direction, centre, radius, N_MEDIUM, n_bead, averaged=averaged)
        emitted = emitted_force(direction, centre, radius, n_bead, averaged=averaged)
        assert (traced is None) == (emitted is None or emitted[2] > 1 - 1e-6)
        if traced is None or traced.power > 1e-13:  # light still inside after the last bounce
            continue
        hits += 1
        total += emitted[2] >= (n_bead / N_MEDIUM) ** 2
        np.testing.assert_allclose(emitted[0], traced.force, atol=3e-13)
    assert hits > 150
    assert (total > 0) == (n_bead < 1.3)


def test_rays_attract_a_denser_bead_and_repel_a_lighter_one():
    """The sign that (3.21) with (3.23) has wrong: the bead is drawn towards the ray's axis."""
    direction, centre, radius = (0.0, 0.0, 1.0), (0.3, 0.0, 0.0), 1.0
    towards_axis = np.array([-1.0, 0.0, 0.0])
    for n_bead, sign in ((1.57773, 1), (1.2, -1)):
        force, _, _ = emitted_force(direction, centre, radius, n_bead, averaged=False)
        assert sign * force @ towards_axis > 0


def test_a_lossless_sphere_takes_no_torque():
    """Each ray leaves with the impact parameter it came with, so (3.25) is not the true moment."""
    rng = np.random.default_rng(41)
    for _ in range(100):
        direction, centre = random_ray(rng, 1.0)
        traced = trace(direction, centre, 1.0, N_MEDIUM, 1.57773, averaged=False)
        if traced is not None:
            assert np.abs(traced.torque).max() < 1e-12


def test_thesis_moment_is_the_cross_product_of_entry_point_and_force():
    rng, radius = np.random.default_rng(42), 0.9
    for _ in range(100):
        direction, centre = random_ray(rng, radius)
        emitted = emitted_force(direction, centre, radius, 1.57773, averaged=True)
        if emitted is None:
            continue
        along = direction @ centre
        entry = (along - np.sqrt(radius**2 - centre @ centre + along**2)) * direction - centre
        np.testing.assert_allclose(emitted[1], np.cross(entry, emitted[0]), atol=1e-14)


@pytest.mark.parametrize("efficiencies", [ray.circular, ray.averaged_reflectance])
def test_equal_indices_give_exactly_nothing(efficiencies):
    for S in (0.0, 0.3, 0.999999):
        assert efficiencies(S, 1.0) == (0.0, 0.0)


@pytest.mark.parametrize("name", ["circular", "averaged_reflectance", "total_reflection"])
def test_rates_come_with_the_same_values(name):
    for S in (0.0, 0.2, 0.95):
        arguments = (S,) if name == "total_reflection" else (S, 0.8)
        Q_sc, G = getattr(ray, name)(*arguments)
        assert getattr(ray, f"{name}_rates")(*arguments)[::2] == pytest.approx((Q_sc, G), rel=1e-14)


@given(st.floats(0, 1, exclude_max=True), st.floats(0.3, 3.0))
@settings(max_examples=500, deadline=None)
def test_no_ray_gives_more_than_it_has(S, n_mP):
    """|Q| is at most 2: a ray turned back takes twice its momentum."""
    total = 1 / n_mP**2 <= S
    Q_sc, G = ray.total_reflection(S) if total else ray.circular(S, n_mP)
    assert np.isfinite([Q_sc, G]).all()
    assert 0 <= Q_sc <= 2
    assert np.hypot(Q_sc, G * np.sqrt(S)) <= 2


def published(kind):
    rows = (line for line in PUBLISHED.read_text().splitlines() if not line.startswith("#"))
    return [row for row in csv.DictReader(rows) if row["kind"] == kind]


@pytest.mark.parametrize("row", published("single-ray"), ids=lambda row: row["n_rel"])
def test_published_single_rays(row):
    """Ashkin (1992): largest gradient force of a ray and the scattering force beside it."""
    S = np.sin(np.radians(float(row["theta_deg_or_z"]))) ** 2
    Q_sc, G = ray.circular(S, 1 / float(row["n_rel"]))
    assert -G * np.sqrt(S) == pytest.approx(float(row["Qg_or_Qz"]), abs=1e-3)
    assert Q_sc == pytest.approx(float(row["Qs"]), abs=6e-3)
