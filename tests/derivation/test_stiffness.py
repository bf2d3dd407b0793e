"""Forms of force and stiffness: identities, and matrices of random numbers."""

import numpy as np
import scipy.linalg
import sympy as sp
from sympy.physics.quantum import Commutator, Dagger

from derivation import stiffness
from derivation.stiffness import T, k, of_force, s


def test_force_without_scattering_is_zero():
    assert stiffness.force().subs(T, 0) == 0
    assert sp.expand(Dagger(stiffness.force()) - stiffness.force()) == 0


def test_stiffness_is_a_commutator_and_hermitian():
    found = stiffness.stiffness()
    expected = -sp.I * k * Commutator(of_force, s).doit()
    assert sp.expand(found - expected) == 0
    assert sp.expand(Dagger(found) - found) == 0


def test_stiffness_is_the_slope_of_the_moved_force():
    """Matrix exponentials and a difference of fourth order give the same slope."""
    rng = np.random.default_rng(1)
    F, direction = (
        each + each.conj().T
        for each in rng.standard_normal((2, 5, 5)) + 1j * rng.standard_normal((2, 5, 5))
    )

    def moved(x):
        turn = scipy.linalg.expm(1j * 1.3 * x * direction)
        return turn.conj().T @ F @ turn

    h = 1e-3
    slope = (moved(-2 * h) - 8 * moved(-h) + 8 * moved(h) - moved(2 * h)) / (12 * h)
    expected = -1j * 1.3 * (F @ direction - direction @ F)
    np.testing.assert_allclose(-slope, expected, rtol=0, atol=1e-7 * np.abs(expected).max())
