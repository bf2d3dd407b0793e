"""The summands of the waves against matrices of s and J between all harmonics, by quadrature."""

import importlib

import numpy as np
import pytest
from scipy.linalg import expm

from tests.generated.summing import (
    HARMONICS,
    HIGHEST,
    J,
    M,
    N,
    S,
    elements,
    elements_about,
    shifted,
)  # fmt: skip

waves = importlib.import_module("tweezer.generated.waves")

#: highest degree of the random light
LIGHT = 3


def scattering(a, b):
    """The sphere's matrix between harmonics of both helicities."""
    keeps, turns = (1 - a - b)[N - 1], (b - a)[N - 1]
    return np.block([[np.diag(keeps), np.diag(turns)], [np.diag(turns), np.diag(keeps)]])


def change(matrices, p, scattered):
    """-(<q|matrix|q> - <p|matrix|p>)."""
    q = scattered @ p
    return np.array([-(np.vdot(q, each @ q) - np.vdot(p, each @ p)).real for each in matrices])


class Light:
    """Random light, a random sphere, and the components that the summands take."""

    def __init__(self, components, seed):
        rng = np.random.default_rng(seed)
        size = len(HARMONICS)
        p = (rng.normal(size=(2, size)) + 1j * rng.normal(size=(2, size))) * (N <= LIGHT)
        if components == 1:
            p[1] = 0
        self.p = np.ravel(p)
        self.a, self.b = rng.normal(size=(2, HIGHEST)) + 1j * rng.normal(size=(2, HIGHEST))
        a, b = np.pad([self.a, self.b], ((0, 0), (0, 1)))
        reduced = p / 1j**M
        U_e, U_m = ((1 - 2 * c[1:].conj()) * (1 - 2 * c[:-1]) - 1 for c in (a, b))
        V_e = (1 - 2 * a[:-1].conj()) * (1 - 2 * b[:-1]) - 1
        K_e, K_m = (abs(1 - 2 * c[:-1]) ** 2 - 1 for c in (a, b))
        if components == 1:
            self.parts = reduced[:1]
            self.U, self.V, self.K = [(U_e + U_m) / 2], [(V_e + V_e.conj()) / 2], [(K_e + K_m) / 2]
        else:
            self.parts = [(reduced[0] + reduced[1]) / 2**0.5, (reduced[0] - reduced[1]) / 2**0.5]
            self.U, self.V, self.K = [U_e, U_m], [V_e, V_e.conj()], [K_e, K_m]

    def summed(self, summand, *arguments):
        """Sum of a summand over harmonics and components; arguments: functions of the component."""
        terms = (
            summand.py_func(*(value for each in arguments for value in each(self, k)))
            for k in range(len(self.parts))
        )
        return sum(np.array([np.sum(value) for value in each]) for each in terms)


def amplitudes(*places):
    return lambda light, k: [part for place in places for part in shifted(light.parts[k], *place)]


def partners(*by_m):
    return lambda light, k: [
        part for each in by_m for part in shifted(light.parts[-1 - k], 0, each)
    ]


def weights(light, k):
    U, V = np.pad(light.U[k], (1, 0)), light.V[k]
    return [part for each in (U[N], U[N - 1], V[N - 1]) for part in (each.real, each.imag)]


def turn(light, k):
    return [light.K[k][N - 1], M]


def lift(_light, _k):
    return [np.sqrt((N - M) * (N + M + 1))]


def lift_down(_light, _k):
    return [np.sqrt((N + M) * (N - M + 1))]


def elements_up(_light, _k):
    al_above, be = elements(N + 1, M)[0], elements(N, M)[1]
    return [al_above, be, *elements(N, M)[2:]]


def elements_all(_light, _k):
    return elements_about()


NINE = amplitudes(*((by_n, by_m) for by_m in (-1, 0, 1) for by_n in (-1, 0, 1)))
THREE = partners(-1, 0, 1)
STEP = 1e-3


def differences(of, light):
    """Derivatives of a function of the amplitudes as the bead moves, by differences: (i, j)."""

    def central(j, step):
        ahead, behind = (expm(1j * sign * step * S[j]) @ light.p for sign in (1, -1))
        return (of(ahead) - of(behind)) / (2 * step)

    fine = [(4 * central(j, STEP / 2) - central(j, STEP)) / 3 for j in range(3)]
    return np.transpose(fine)


@pytest.fixture(params=[1, 2], ids=["one helicity", "electric and magnetic"])
def light(request):
    return Light(request.param, seed=19)


def test_matrices_obey_the_algebra():
    """s.s = 1, s.J = l, [J_x, s_y] = i s_z: the quadrature and J are of the same harmonics."""
    inside = np.tile(N < HIGHEST, 2)
    unit = sum(each @ each for each in S)
    np.testing.assert_allclose(unit[inside][:, inside], np.eye(inside.sum()), atol=1e-13)
    along = sum(s @ j for s, j in zip(S, J, strict=True))
    np.testing.assert_allclose(along, np.diag(np.repeat([1, -1], len(N))), atol=1e-13)
    np.testing.assert_allclose(J[0] @ S[1] - S[1] @ J[0], 1j * S[2], atol=1e-13)


def test_force(light):
    summed = light.summed(
        waves.force_summand,
        amplitudes((0, 0), (1, 0)),
        partners(0),
        amplitudes((-1, 1), (0, 1), (1, 1)),
        weights,
        elements_up,
    )
    expected = change(S, light.p, scattering(light.a, light.b))
    np.testing.assert_allclose(summed, expected, rtol=0, atol=1e-13 * abs(expected).max())


def test_force_and_gradient(light):
    summed = light.summed(waves.force_and_gradient_summand, NINE, THREE, weights, elements_all)
    scattered = scattering(light.a, light.b)
    force = change(S, light.p, scattered)
    np.testing.assert_allclose(summed[:3], force, rtol=0, atol=1e-13 * abs(force).max())
    gradient = differences(lambda p: change(S, p, scattered), light)
    np.testing.assert_allclose(
        summed[3:].reshape(3, 3), gradient, rtol=0, atol=1e-9 * abs(gradient).max()
    )


def test_moment_and_absorbed_power(light):
    summed = light.summed(waves.moment_summand, amplitudes((0, 0), (0, 1)), turn, lift)
    expected = change([*J, np.eye(len(light.p))], light.p, scattering(light.a, light.b))
    np.testing.assert_allclose(summed, expected, rtol=0, atol=1e-13 * abs(expected).max())


def test_gradient_of_the_moment(light):
    summed = light.summed(
        waves.moment_gradient_summand, NINE, THREE, turn, lift_down, lift, elements_all
    )
    scattered = scattering(light.a, light.b)
    gradient = differences(lambda p: change(J, p, scattered), light)
    np.testing.assert_allclose(
        summed.reshape(3, 3), gradient, rtol=0, atol=1e-9 * abs(gradient).max()
    )
