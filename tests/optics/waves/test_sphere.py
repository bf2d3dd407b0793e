"""Mie coefficients against a transfer from layer to layer at 80 digits; what they weigh."""

import mpmath
import numpy as np
import pytest

from tweezer.optics.waves.sphere import mie_coefficients, weights

DIGITS = 80


def psi(n, z):
    return mpmath.sqrt(mpmath.pi * z / 2) * mpmath.besselj(n + mpmath.mpf(1) / 2, z)


def chi(n, z):
    return -mpmath.sqrt(mpmath.pi * z / 2) * mpmath.bessely(n + mpmath.mpf(1) / 2, z)


def slope(f, n, z):
    return f(n - 1, z) - n * f(n, z) / z


def transferred(shells, n):
    """a_n, b_n from the factors of psi_n and chi_n in each layer, at 80 digits."""
    found = []
    for electric in (True, False):
        by_psi, by_chi = mpmath.mpf(1), mpmath.mpf(0)
        around = [mpmath.mpmathify(index) for _, index in shells[1:]] + [mpmath.mpf(1)]
        for (radius, index), outside in zip(shells, around, strict=True):
            inside = mpmath.mpmathify(index)
            z = inside * mpmath.mpf(radius)
            value = by_psi * psi(n, z) + by_chi * chi(n, z)
            change = by_psi * slope(psi, n, z) + by_chi * slope(chi, n, z)
            if electric:
                value *= inside / outside
            else:
                change *= inside / outside
            z = outside * mpmath.mpf(radius)
            # psi chi' - psi' chi = 1
            by_psi = value * slope(chi, n, z) - change * chi(n, z)
            by_chi = change * psi(n, z) - value * slope(psi, n, z)
        # psi - a (psi - i chi)
        found.append(by_chi / (by_chi + 1j * by_psi))
    return found


def highest(shells):
    x = shells[-1][0]
    return max(3, int(x + 4 * x ** (1 / 3) + 2))


@pytest.mark.parametrize(
    "shells",
    [
        *(((x, m),) for m in (1.2, 1.2 + 0.01j, 0.2 + 5j) for x in (0.01, 1.0, np.pi, 100.0)),
        ((400.0, 5.0),),
        ((200.0, 0.2 + 10j),),
        ((0.07, 1.2), (0.1, 1.5)),
        ((7.0, 1.2), (7.5, 0.9), (10.0, 1.5)),
        ((5.0, 1.3), (6.0, 0.15 + 4j), (7.0, 1.2)),
        ((0.001, 1.2), (100.0, 1.33)),
        ((10.0, 1.2), (11.0, 0.2 + 5j)),
    ],
    ids=str,
)  # fmt: skip
def test_coefficients_are_those_of_the_transfer(shells):
    """a_n and b_n each to 1e-12 of the larger; the real part by itself too."""
    n_max = highest(shells)
    coefficients = mie_coefficients(shells, 1.0, n_max)
    with mpmath.workdps(DIGITS):
        for n in {1, 2, int(0.8 * n_max), n_max}:
            expected = transferred(shells, n)
            largest = max(abs(each) for each in expected)
            for found, exact in zip(coefficients, expected, strict=True):
                assert abs(mpmath.mpmathify(found[n - 1]) - exact) < 1e-12 * largest
                lossless = all(complex(index).imag == 0 for _, index in shells)
                if lossless:
                    assert abs(found[n - 1].real - exact.real) < 2e-12 * exact.real


def test_nothing_scatters_at_equal_indices():
    for shells in (((1.0, 1.0),), ((3.0, 1.0), (400.0, 1 + 0j))):
        assert not np.any(mie_coefficients(shells, 1.0, 20))


def test_a_layer_of_no_contrast_is_none():
    whole = mie_coefficients(((2.0, 1.2 + 0.1j),), 5.0, 20)
    in_two = mie_coefficients(((1.0, 1.2 + 0.1j), (2.0, 1.2 + 0.1j)), 5.0, 20)
    np.testing.assert_array_equal(in_two, whole)


def test_a_thick_metal_hides_its_core():
    metal = mie_coefficients(((100.0, 0.2 + 10j),), 1.0, 120)
    coated = mie_coefficients(((10.0, 1.2), (100.0, 0.2 + 10j)), 1.0, 120)
    np.testing.assert_allclose(coated, metal, rtol=1e-13)


def test_far_more_orders_than_there_is_light_are_zeros():
    coefficients = np.array(mie_coefficients(((0.005, 0.2 + 5j), (0.01, 1.2)), 1.0, 100))
    assert np.isfinite(coefficients).all()
    assert not coefficients[:, 80:].any()


@pytest.mark.parametrize("index", [1.2, 1.2 + 0.3j])
def test_weights_are_those_of_the_matrix_in_helicity(index):
    a, b = mie_coefficients(((4.0, index),), 1.0, 12)
    keeps, turns = 1 - np.append(a + b, 0), np.append(b - a, 0)
    U, V, K = weights(a, b, 1)
    between = keeps[1:].conj() * keeps[:-1] + turns[1:].conj() * turns[:-1] - 1
    keeps, turns = keeps[:-1], turns[:-1]
    np.testing.assert_allclose(U, [between], atol=1e-14)
    np.testing.assert_allclose(V, [abs(keeps) ** 2 - abs(turns) ** 2 - 1], atol=1e-14)
    np.testing.assert_allclose(K, [abs(keeps) ** 2 + abs(turns) ** 2 - 1], atol=1e-14)
    assert K.max() < 1e-14 if index.imag == 0 else K[0, 0] < -0.1


def test_weights_of_the_electric_and_the_magnetic_component():
    a, b = mie_coefficients(((0.3, 1.2),), 1.0, 12)
    S = 1 - 2 * np.append([a, b], np.zeros((2, 1)), axis=1)
    U, V, K = weights(a, b, 2)
    np.testing.assert_allclose(U, S[:, 1:].conj() * S[:, :-1] - 1, atol=1e-15)
    np.testing.assert_allclose(V, S[:, :-1].conj() * S[::-1, :-1] - 1, atol=1e-15)
    assert abs(K).max() < 1e-19
