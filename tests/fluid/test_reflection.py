"""The drag of a sphere beside a wall with the inertia of the fluid: plane waves one by one."""

import numpy as np
import pytest
from lumicks.pylake.force_calibration.detail import hydrodynamics
from scipy.optimize import nnls

from tests.reference import reflected_flow
from tweezer.fluid import memory_beside, memory_far, steady
from tweezer.fluid.reflection import reflected

HEIGHTS = [(1.5, False), (2.0, False), (2.0, True), (3.0, True), (6.0, False), (20.0, True)]
#: alpha r on s = i w: up to f = 200 nu/(pi r^2)
X = np.geomspace(0.02, 20.0, 9) * np.exp(0.25j * np.pi)


@pytest.mark.parametrize(("height", "across"), HEIGHTS)
def test_what_comes_back(height, across):
    """By amplitudes of each wave that are solved for as numbers; and Faxen's without inertia."""
    exact = [reflected_flow.returned(x, height, across) for x in X]
    np.testing.assert_allclose(reflected(X, height, across=across), exact, rtol=1e-6, atol=1e-9)
    size = 1 / height
    faxen = -9 / 16 * size + size**3 / 8 - size**5 / 16
    if across:
        faxen = -9 / 8 * size + size**3 / 2 - size**5 / 8
    assert reflected(np.array([1e-6]), height, across=across)[0] == pytest.approx(faxen, rel=2e-5)


#: largest deviation of the sum of poles from the reflected flow, up to f = 10 nu/(pi r^2)
WITHIN = {(1.5, False): 8e-3, (2.0, False): 2e-3, (2.0, True): 1.5e-2, (3.0, True): 2e-3}


@pytest.mark.parametrize(("height", "across"), HEIGHTS)
def test_memory_beside_a_wall(height, across):
    memory = memory_beside(height, across=across, poles=24)
    mobility = steady(height - 1)[int(across)]
    assert memory.mobility == mobility
    assert (memory.weights > 0).all()
    assert memory.mass > 0
    x = X[np.abs(X) < 4.5]
    f = np.abs(x) ** 2 / (2 * np.pi)  # tau_f is 1
    found = memory.drag_at(f, 1 / mobility, 1 / 4.5)
    exact = [reflected_flow.drag(each, height, mobility, across) for each in x]
    np.testing.assert_allclose(found, exact, rtol=WITHIN.get((height, across), 2e-4))
    # at late times the velocity forgets as t^(-5/2): no sqrt(s), as far away
    slow = memory.drag_at(np.array([1e-8, 4e-8]), 1.0, mobility / 4.5)
    assert slow[1].imag / slow[0].imag == pytest.approx(4, rel=0.01)


def test_memory_far_from_a_wall_is_that_without_one():
    f = np.geomspace(1e-4, 10, 30)
    far = memory_far(24).drag_at(f, 1.0, 1 / 4.5)
    beside = memory_beside(1e4, across=False, poles=24).drag_at(f, 1.0, 1 / 4.5)
    np.testing.assert_allclose(beside, far, rtol=3e-4)


def test_the_usual_formula_is_of_no_fluid():
    """Equation D6 of S. F. Tolic-Norrelykke et al. (2006), by pylake: its drag falls as the
    frequency rises, with sqrt(f); no sum of dashpots and masses comes nearer than 5 %. That of the
    reflected flow is such a sum.
    """
    height, ratio = 2.0, np.geomspace(1e-4, 10, 200)
    x = np.sqrt(2j * ratio)
    # radius 1, 6 pi eta = 1 and tau_f = 1: nu = 1, and f over nu/pi is the ratio
    real, imaginary = hydrodynamics.calculate_complex_drag(
        ratio / np.pi, 1.0, 1 / (6 * np.pi), 1.0, height
    )
    theirs = real - 1j * imaginary
    assert theirs[0].real == pytest.approx(1 / (1 - 9 / 32), rel=0.01)
    assert theirs[67].real < 0.97 * theirs[0].real  # f = 0.005 nu/(pi r^2)
    still = reflected(np.array([1e-6]), height, across=False).real[0]
    free = 1 + x + x**2 / 9
    ours = free / (1 + reflected(x, height, across=False) / free)
    rates = np.geomspace(1e-6, 1e4, 60)
    columns = np.column_stack([x[:, None] ** 2 / (x[:, None] ** 2 + rates), x**2])

    def misfit(drag, steady_drag):
        weight = 1 / np.abs(drag)
        matrix, target = weight[:, None] * columns, weight * (drag - steady_drag)
        found, _ = nnls(
            np.concatenate([matrix.real, matrix.imag]),
            np.concatenate([target.real, target.imag]),
            maxiter=10_000,
        )
        return np.abs(weight * (steady_drag + columns @ found - drag)).max()

    assert misfit(theirs, 1 / (1 - 9 / 32)) > 0.05
    assert misfit(ours, 1 / (1 + still)) < 1e-5
