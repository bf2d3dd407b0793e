"""The summands of light on a body against matrices of s and J, for a random body."""

import importlib

import numpy as np
import pytest
from scipy.linalg import expm

from tests.generated.summing import HARMONICS, HIGHEST, J, M, N, S, elements_about, shifted

bodies = importlib.import_module("tweezer.generated.bodies")

#: highest degrees of the light and of its change by the body
LIGHT, CHANGED = HIGHEST - 1, HIGHEST - 2
NINE = [(by_n, by_m) for by_m in (-1, 0, 1) for by_n in (-1, 0, 1)]
STEP = 1e-3
LIFT = [M, np.sqrt((N + M) * (N - M + 1)), np.sqrt((N - M) * (N + M + 1))]
GENERATORS = np.concatenate([S, J])


@pytest.fixture(scope="module")
def light():
    """Amplitudes of helicity +1 and -1."""
    return _random(1, (2, len(HARMONICS)), LIGHT).ravel()


@pytest.fixture(scope="module")
def change():
    """S - 1 between all harmonics of both helicities: any matrix will do."""
    size = len(HARMONICS)
    row = _random(2, (2, size, 2, size), CHANGED) * (N <= CHANGED)[:, None, None]
    return row.reshape(2 * size, 2 * size)


def _random(seed, shape, degree):
    rng = np.random.default_rng(seed)
    return (rng.normal(size=shape) + 1j * rng.normal(size=shape)) * (degree >= N)


def components(amplitudes):
    """Electric and magnetic parts of amplitudes of helicity +1 and -1."""
    plus, minus = np.reshape(amplitudes, (2, -1))
    return [(plus + minus) / 2**0.5, (plus - minus) / 2**0.5]


def neighbours(amplitudes, k):
    """The 24 arguments of component k, in their order."""
    own, partner = components(amplitudes)[k], components(amplitudes)[1 - k]
    nine = [part for place in NINE for part in shifted(own, *place)]
    return nine + [part for by_m in (-1, 0, 1) for part in shifted(partner, 0, by_m)]


def turning(amplitudes, k):
    """Amplitudes at m - 1, m and m + 1, and the elements of J."""
    own = components(amplitudes)[k]
    return [part for by_m in (-1, 0, 1) for part in shifted(own, 0, by_m)] + LIFT


def parts(amplitudes, k):
    own = components(amplitudes)[k]
    return [own.real, own.imag]


def complexes(numbers):
    """Complex arrays of alternating real and imaginary parts."""
    numbers = [np.broadcast_to(each, N.shape) for each in numbers]
    return np.array(numbers[::2]) + 1j * np.array(numbers[1::2])


def total(summand, *arguments):
    """Sum of a summand over harmonics and components; arguments are functions of the component."""
    terms = (summand.py_func(*(each for of in arguments for each in of(k))) for k in (0, 1))
    return sum(np.array([np.sum(value) for value in term]) for term in terms)


def bilinear(matrices, t, v):
    """-Re<t|A|v>."""
    return np.array([-np.vdot(t, matrix @ v).real for matrix in matrices])


@pytest.mark.parametrize("k", [0, 1], ids=["electric", "magnetic"])
def test_generators(light, k):
    found = bodies.generators.py_func(*neighbours(light, k), *LIFT, *elements_about())
    expected = [components(matrix @ light)[k] for matrix in GENERATORS]
    np.testing.assert_allclose(complexes(found), expected, rtol=0, atol=1e-13)


def test_force_is_the_momentum_that_the_light_loses(light, change):
    """-Re<t|s|2p+t> = -(<q|s|q> - <p|s|p>)."""
    t = change @ light
    summed = total(
        bodies.force_summand,
        lambda k: parts(t, k),
        lambda k: neighbours(2 * light + t, k),
        lambda _k: elements_about(),
    )
    q = light + t
    expected = bilinear(S, q, q) - bilinear(S, light, light)
    np.testing.assert_allclose(summed, expected, rtol=0, atol=1e-13 * abs(expected).max())


def test_torque_and_absorbed_power(light, change):
    t = change @ light
    summed = total(
        bodies.torque_summand, lambda k: parts(t, k), lambda k: turning(2 * light + t, k)
    )
    q, operators = light + t, [*J, np.eye(len(light))]
    expected = bilinear(operators, q, q) - bilinear(operators, light, light)
    np.testing.assert_allclose(summed, expected, rtol=0, atol=1e-13 * abs(expected).max())


def _derivatives(p, change, which):
    """Sum of `derivative_summand` over all harmonics, for one of s and J."""
    t = change @ p
    returned = GENERATORS[which] @ t + change.conj().T @ (GENERATORS[which] @ (p + t))
    return total(
        bodies.derivative_summand,
        lambda k: parts(returned, k),
        lambda k: bodies.generators.py_func(*neighbours(p, k), *LIFT, *elements_about()),
    )


@pytest.mark.parametrize("column", range(6))
def test_derivatives_of_force_and_torque(light, change, column):
    """Against differences over exp(i x A) on the light."""
    p = light * np.tile(N < LIGHT, 2)  # its derivative is of one degree more
    generator = GENERATORS[column]

    def wrench(x):
        moved = expm(1j * x * generator) @ p
        t = change @ moved
        return bilinear(GENERATORS, t, 2 * moved + t)

    def central(step):
        return (wrench(step) - wrench(-step)) / (2 * step)

    found = [_derivatives(p, change, which)[column] for which in range(6)]
    expected = (4 * central(STEP / 2) - central(STEP)) / 3
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9 * abs(expected).max())


def of_revolution():
    """S - 1 of a body without loss: S is unitary and keeps m."""
    order, degree = np.tile(M, 2), np.tile(N, 2)
    hermitian = _random(3, (2, len(HARMONICS), 2, len(HARMONICS)), CHANGED).reshape(
        len(order), len(order)
    )
    kept = (order[:, None] == order) * np.outer(degree <= CHANGED, degree <= CHANGED)
    return expm(1j * (hermitian + hermitian.conj().T) * kept) - np.eye(len(order))


def test_body_of_revolution_is_turned_about_its_axis_without_a_change(light):
    """With A = s, J and B = J_z, the derivatives are F x z and M x z."""
    change = of_revolution()
    t = change @ light
    vectors = bilinear(GENERATORS, t, 2 * light + t).reshape(2, 3)
    found = [_derivatives(light, change, which)[5] for which in range(6)]
    expected = np.cross(vectors, [0, 0, 1]).ravel()
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12 * abs(expected).max())


def test_body_of_revolution_without_loss_has_no_torque_about_its_axis(light):
    """-Re<t|J_z|v> vanishes, the other components do not."""
    t = of_revolution() @ light
    x, y, z, absorbed = total(
        bodies.torque_summand, lambda k: parts(t, k), lambda k: turning(2 * light + t, k)
    )
    assert max(abs(z), abs(absorbed)) < 1e-12 * max(abs(x), abs(y))
