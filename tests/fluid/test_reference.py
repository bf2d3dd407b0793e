"""The oracles of a fluid with inertia, held to each other: `tests.reference.fluid`."""

import functools
import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from tests.reference.fluid import BOLTZMANN, Path, Sphere

STIFFNESS = np.array([2e-5, 1e-5, 3e-6])
START = np.array([0.3e-6, -0.8e-6, 0.5e-6])
SPHERES = {
    "500 nm": Sphere.of(250e-9, 1050),
    "3 um, silica": Sphere.of(1.5e-6, 2000),
    # whose two roots are one pair of complex numbers, or nearly equal
    "bubble": Sphere.of(0.5e-6, 1.2),
    "light": Sphere.of(0.5e-6, 0.63 * 998.2),
}


@pytest.mark.parametrize("sphere", SPHERES.values(), ids=SPHERES)
@pytest.mark.parametrize("t", [1e-9, 1e-7, 1e-5, 1e-2])
def test_closed_forms_are_inverse_transforms(sphere, t):
    for k in (0.0, 2e-5):
        known = sphere.inverted("velocity_correlation", t, k)
        assert math.isclose(sphere.velocity_correlation(t, k), known, rel_tol=1e-9, abs_tol=1e-14)
    for name in ("settling", "moved"):
        assert math.isclose(getattr(sphere, name)(t), sphere.inverted(name, t), rel_tol=1e-9)
    known = sphere.inverted("relaxation", t, 2e-5)
    assert math.isclose(sphere.relaxation(t, 2e-5), known, abs_tol=1e-13)


@pytest.mark.parametrize("sphere", SPHERES.values(), ids=SPHERES)
def test_free_motion_decays_with_a_density_of_rates(sphere):
    for t in (1e-9, 1e-6):
        assert math.isclose(sphere.velocity_correlation(t), sphere.by_rates(t), rel_tol=1e-10)


def test_without_displaced_mass_the_forms_are_langevins():
    """Without a spring an exponential; with one two, of a damped oscillator."""
    bead, k = Sphere(5e-16, 9e-9, 0.0), 2e-3
    t = np.geomspace(1e-9, 1e-5, 20)
    np.testing.assert_allclose(
        bead.velocity_correlation(t), np.exp(-t * bead.drag / bead.mass), rtol=0, atol=1e-14
    )
    # by the roots of m s^2 + beta s + k
    one, other = np.roots([bead.mass, bead.drag, k])
    relaxed = (one * np.exp(other * t) - other * np.exp(one * t)) / (one - other)
    np.testing.assert_allclose(bead.relaxation(t, k), relaxed.real, rtol=0, atol=1e-13)


def test_spectrum_is_the_transform_of_the_mean_squared_displacement():
    """Its integral over frequency gives the stored energy, k <x^2> = kT."""
    bead, k = SPHERES["500 nm"], 2e-5
    f = np.geomspace(1e-4, 1e11, 40001)
    variance = np.trapezoid(bead.spectrum(f, 300, k) * f, np.log(f))
    assert math.isclose(variance, BOLTZMANN * 300 / k, rel_tol=1e-5)


@functools.cache
def trapped(tolerance):
    return Path(SPHERES["500 nm"], lambda x: -STIFFNESS * x, START, 6e-3, tolerance)


def test_path_of_a_trapped_bead_meets_the_closed_form():
    t = np.geomspace(1e-8, 6e-3, 40)
    relaxed = np.transpose([SPHERES["500 nm"].relaxation(t, k) for k in STIFFNESS]) * START
    for tolerance, error in ((1e-10, 1e-10), (1e-14, 2e-17)):
        assert np.abs(trapped(tolerance)(t) - relaxed).max() < error
    # released on one side, it ends on the other
    assert trapped(1e-14)([6e-3])[0, 0] < 0


def wavy(x):
    """Attraction into a well with ripples, and a weight."""
    r2 = (x**2).sum(axis=1, keepdims=True)
    well = -1e-5 * x * np.exp(-r2 / 0.8e-6**2) * (1 + 0.3 * np.cos(x[:, :1] / 2e-7))
    return well - [0, 0, 1e-14]


def test_path_without_displaced_mass_is_newtons():
    bead = Sphere(5e-16, 9e-9, 0.0)

    def rates(t, y):
        return np.concatenate([y[3:], (wavy(y[None, :3])[0] - bead.drag * y[3:]) / bead.mass])

    start, t = np.concatenate([START, np.zeros(3)]), np.geomspace(1e-7, 2e-3, 20)
    known = solve_ivp(
        rates, (0, 2e-3), start, method="Radau", t_eval=t, rtol=1e-11, atol=1e-18
    ).y[:3].T  # fmt: skip
    assert np.abs(Path(bead, wavy, START, 2e-3)(t) - known).max() < 1e-16
    assert np.abs(known[-1] - START).max() > 0.3e-6


def test_path_converges():
    """An error goes with the tolerance: of the nonlinear force in a fluid with inertia."""
    t = np.geomspace(1e-7, 2e-3, 20)
    best, fine, coarse = (
        Path(SPHERES["500 nm"], wavy, START, 2e-3, tolerance)(t)
        for tolerance in (1e-15, 1e-13, 1e-10)
    )
    assert np.abs(fine - best).max() < 1e-17 * 20
    assert 1e-14 < np.abs(coarse - best).max() < 1e-10


def test_path_of_a_struck_bead_is_settling():
    bead = SPHERES["500 nm"]
    t = np.geomspace(1e-9, 1e-4, 10)
    path = Path(bead, np.zeros_like, np.zeros(3), 1e-4, impulse=(1e-18, 0, 0))
    np.testing.assert_allclose(path(t)[:, 0], 1e-18 * bead.settling(t), rtol=1e-12)
