"""Resistance of ellipsoids and of spheres in a row, against closed forms and published values."""

import math

import mpmath
import numpy as np
import pytest
from scipy.constants import Boltzmann

import tweezer
from tweezer.fluid.resistance.ellipsoid import ellipsoid_resistance
from tweezer.fluid.resistance.resistance import Resistance
from tweezer.fluid.resistance.row import row_resistance

SCENE = tweezer.load_scene("silica-1um")


def pair(*positions, diameters=None):
    diameters = diameters or [1e-6] * len(positions)
    spheres = [
        {"diameter": diameter, "position": list(position), "material": "silica"}
        for diameter, position in zip(diameters, positions, strict=True)
    ]
    return SCENE.replace(bead={"shape": "spheres", "spheres": spheres, "density": 2000})


def perrin(semi_axes):
    """Drag over viscosity along and about each axis, by quadrature of the integrals."""
    a = [mpmath.mpf(float(each)) for each in semi_axes]

    def integral(*powers):
        def integrand(u):  # s = 1/u^2 - 1, whose integrand is smooth
            product = 2 / u**3
            for axis, power in zip(a, powers, strict=True):
                product *= (axis**2 + 1 / u**2 - 1) ** power
            return product

        return mpmath.quad(integrand, [0, 1])

    half = mpmath.mpf(-1) / 2
    whole = integral(half, half, half)
    each = [integral(*(half - (i == j) for j in range(3))) for i in range(3)]
    along = [16 * mpmath.pi / (whole + a[i] ** 2 * each[i]) for i in range(3)]
    about = [
        16 * mpmath.pi / 3 * (a[j] ** 2 + a[k] ** 2)
        / (a[j] ** 2 * each[j] + a[k] ** 2 * each[k])
        for j, k in ((1, 2), (2, 0), (0, 1))
    ]  # fmt: skip
    return np.array([float(value) for value in (*along, *about)])


@pytest.mark.parametrize("axes", [(1, 1, 1), (1, 1, 3), (2, 2, 1), (1, 1.5, 3), (1, 1, 1.001)])
def test_ellipsoid_against_quadrature(axes):
    found = np.diag(ellipsoid_resistance(axes, 1.0))
    np.testing.assert_allclose(found, perrin(axes), rtol=1e-12)


def test_disc_is_the_limit_of_a_flat_spheroid():
    """Broadside 16 mu a, edgewise 32/3 mu a, and 32/3 mu a^3 for all rotations."""
    found = np.diag(ellipsoid_resistance((1, 1, 1e-9), 1.0))
    expected = [32 / 3, 32 / 3, 16, 32 / 3, 32 / 3, 32 / 3]
    np.testing.assert_allclose(found, expected, rtol=1e-8)


def test_one_sphere():
    matrix, _ = row_resistance(np.zeros(1), np.full(1, 2.0), 3.0)
    expected = np.diag([36 * math.pi] * 3 + [8 * math.pi * 24] * 3)
    np.testing.assert_allclose(matrix, expected, rtol=0, atol=1e-11)


def stimson_and_jeffery(gap):
    """Drag on each of two equal spheres that move along their line, over 6 pi mu a."""
    alpha = mpmath.acosh(1 + mpmath.mpf(gap) / 2)

    def term(n):
        w = 2 * n + 1
        numerator = 4 * mpmath.sinh((n + 0.5) * alpha) ** 2 - w**2 * mpmath.sinh(alpha) ** 2
        denominator = 2 * mpmath.sinh(w * alpha) + w * mpmath.sinh(2 * alpha)
        factor = mpmath.mpf(n) * (n + 1) / ((2 * n - 1) * (2 * n + 3))
        return factor * (1 - numerator / denominator)

    total = mpmath.nsum(term, [1, 400], method="direct")
    return float(4 * mpmath.sinh(alpha) / 3 * total)


@pytest.mark.parametrize("gap", [0.2, 1.0, 4.0])
def test_two_spheres_along_their_line(gap):
    half = 1 + gap / 2
    matrix, error = row_resistance(np.array([-half, half]), np.ones(2), 1.0)
    expected = 2 * 6 * math.pi * stimson_and_jeffery(gap)
    assert abs(matrix[2, 2] / expected - 1) < max(1e-12, error)


def test_touching_spheres():
    """Turned about their line, the torque is (3/4) zeta(3) of two spheres; others as published."""
    matrix, error = row_resistance(np.array([-1.0, 1.0]), np.ones(2), 1.0)
    found = np.array([matrix[2, 2], matrix[0, 0]]) / (12 * math.pi)
    np.testing.assert_allclose(found, [0.6451414255, 0.7246610990], rtol=1e-8)
    assert abs(matrix[5, 5] / (16 * math.pi) - 0.75 * float(mpmath.zeta(3))) < 1e-9
    assert error < 1e-8


def test_resistance_about_another_point():
    """A row about two origins differs by the shift of the point of reference alone."""
    places, radii = np.array([0.0, 1.7]), np.array([1.0, 0.5])
    one, _ = row_resistance(places, radii, 1.0)
    other, _ = row_resistance(places - 0.6, radii, 1.0)
    found = Resistance(one, 300.0, 0.0, "")
    np.testing.assert_allclose(found.at(np.array([0, 0, 0.6])).matrix, other, atol=1e-9)


def test_cluster_is_turned_to_its_frame():
    upright = tweezer.resistance(pair((0, 0, 0), (0, 0, 1e-6))).matrix
    lying = tweezer.resistance(pair((0, 0, 0), (1e-6, 0, 0))).matrix
    assert lying[0, 0] == pytest.approx(upright[2, 2], rel=1e-9)
    assert lying[3, 3] == pytest.approx(upright[5, 5], rel=1e-9)
    np.testing.assert_allclose(lying, lying.T, rtol=0, atol=1e-9 * lying.max())


def test_unequal_pair_couples_about_its_centre_of_mass():
    """The matrix is positive, and no force at the centre of mobility turns the pair."""
    found = tweezer.resistance(pair((0, 0, 0), (0, 0, 1.2e-6), diameters=[1.6e-6, 0.8e-6]))
    assert (np.linalg.eigvalsh(found.matrix) > 0).all()
    centre = found.centre_of_mobility
    assert abs(centre[2]) > 1e-9
    moved = found.at(centre)
    coupling = moved.mobility[3:, :3]
    assert abs(coupling).max() < 1e-9 * abs(found.mobility[3:, :3]).max()


def test_diffusion_is_that_of_einstein():
    found = tweezer.resistance(SCENE)
    expected = Boltzmann * SCENE.medium.temperature / tweezer.bead_properties(SCENE).drag
    assert found.diffusion[0, 0] == pytest.approx(expected, rel=1e-12)


def test_spheroid_of_a_scene():
    scene = SCENE.replace(bead={"shape": "spheroid", "diameter": 1e-6, "length": 3e-6})
    expected = ellipsoid_resistance((0.5e-6, 0.5e-6, 1.5e-6), scene.medium.viscosity)
    np.testing.assert_array_equal(tweezer.resistance(scene).matrix, expected)


def test_triangle_is_refused():
    scene = pair((0, 0, 0), (1e-6, 0, 0), (0.5e-6, 0.9e-6, 0))
    with pytest.raises(tweezer.SceneError, match=r"^bead\.spheres: .* in a row; .* line by"):
        tweezer.resistance(scene)
