"""Networks of elements against inverse Laplace transforms and the Lyapunov equation."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest
from scipy.integrate import quad
from scipy.linalg import expm, solve_continuous_lyapunov

from tweezer.fluid.network import Network
from tweezer.values.errors import SceneError

KT = 4.1e-21
#: Stokes's drag per viscosity of a bead of 1 um
SIX = 6 * np.pi * 0.5e-6
WATER, MASS, STIFFNESS = 1e-3 * SIX, 1.3e-15, 1e-5
JEFFREYS = (SIX * np.array([4e-3]), np.array([5e-3]))
THREE = (SIX * np.array([4e-3, 1e-2, 2e-3]), np.array([5e-3, 1e-4, 0.3]))
MASSES = (np.array([1e-9, 1e-8]), np.array([1e4, 1e6]))
NETWORKS = {
    "Newtonian": Network(0.0, WATER),
    "Jeffreys": Network(0.0, WATER, JEFFREYS),
    "three elements": Network(0.0, WATER, THREE),
    "Jeffreys with mass": Network(MASS, WATER, JEFFREYS),
    "ringing": Network(MASS, WATER, (np.array([1e-7]), np.array([1e-7]))),
    "equal elements": Network(0.0, WATER, (np.repeat(JEFFREYS[0], 2), np.repeat(JEFFREYS[1], 2))),
    "all elements": Network(MASS, WATER, THREE, MASSES, 2e-6),
    "gel": Network(0.0, WATER, spring=2e-6),
}
TIMES = np.geomspace(1e-7, 10, 4)


def impedance(network: Network, s, stiffness: float = 0.0):  # type: ignore[no-untyped-def]
    """M s + gamma(s) + k/s in the arithmetic of s."""
    total = network.mass * s + network.drag + (network.spring + stiffness) / s
    total += sum(float(b) / (1 + s * float(t)) for b, t in zip(*network.maxwell, strict=True))
    return total + sum(float(c) * s / (s + float(p)) for c, p in zip(*network.dragged, strict=True))


def inverted(transform) -> np.ndarray:  # type: ignore[no-untyped-def, type-arg]
    """The function of time with this Laplace transform, by Talbot's contour."""
    with mpmath.workdps(22):
        return np.array([float(mpmath.invertlaplace(transform, t, method="talbot")) for t in TIMES])


@pytest.mark.parametrize("name", NETWORKS)
@pytest.mark.parametrize("stiffness", [0.0, STIFFNESS])
def test_displacement_matches_inverse_laplace_transform(name: str, stiffness: float) -> None:
    network = NETWORKS[name]
    expected = inverted(lambda s: 2 * KT / (s**2 * impedance(network, s, stiffness)))
    assert network.displacement(TIMES, KT, stiffness) == pytest.approx(expected, rel=1e-11)


@pytest.mark.parametrize("name", NETWORKS)
def test_relaxation_matches_inverse_laplace_transform(name: str) -> None:
    network = NETWORKS[name]
    held = STIFFNESS + network.spring
    expected = inverted(lambda s: (1 - held / (s * impedance(network, s, STIFFNESS))) / s)
    assert network.relaxation(STIFFNESS).at(TIMES) == pytest.approx(expected, abs=1e-11)


@pytest.mark.parametrize("name", NETWORKS)
def test_matrix_gives_relaxation_and_equipartition(name: str) -> None:
    network = NETWORKS[name]
    A = network.matrix(STIFFNESS)
    shaken = -(A + A.T)
    assert np.linalg.eigvalsh(shaken).min() >= -1e-12 * np.abs(A).max()
    assert solve_continuous_lyapunov(A, -shaken) == pytest.approx(np.eye(len(A)), abs=1e-9)
    found = [expm(A * t)[0, 0] for t in TIMES]
    assert network.relaxation(STIFFNESS).at(TIMES) == pytest.approx(found, abs=1e-9)


def test_spectrum_integrates_to_equipartition() -> None:
    network = NETWORKS["Jeffreys with mass"]

    def power(u: float) -> float:
        f = np.exp(u)
        return f * network.spectrum(np.array([f]), KT, STIFFNESS)[0]

    total = quad(power, np.log(1e-6), np.log(1e12), limit=400, epsabs=0, epsrel=1e-10)[0]
    assert total == pytest.approx(KT / STIFFNESS, rel=1e-6)


def test_modes_give_the_drag() -> None:
    network = NETWORKS["Jeffreys with mass"]
    modes = network.modes()
    assert modes.weights.sum() == pytest.approx(1, abs=1e-12)
    assert modes.weights.min() < -3
    f = np.geomspace(0.1, 1e7, 20)
    response = (modes.weights / (1 + 2j * np.pi * np.outer(f, modes.times))).sum(axis=1)
    expected = network.steady_drag / impedance(network, 2j * np.pi * f)
    assert np.abs(response / expected - 1).max() < 1e-12
    assert network.drag_at(f) == pytest.approx(
        impedance(network, 2j * np.pi * f) - MASS * 2j * np.pi * f, rel=1e-12
    )


def test_modes_without_mass_begin_with_the_solvent() -> None:
    modes = NETWORKS["Jeffreys"].modes()
    assert modes.times[0] == 0
    assert modes.weights == pytest.approx([5, -4], rel=1e-12)
    assert modes.times[1] == pytest.approx(1e-3, rel=1e-12)  # t beta_s/beta


def test_modes_refuse_a_bead_that_rings() -> None:
    with pytest.raises(SceneError, match=r"medium\.relaxing: the bead rings by itself at"):
        NETWORKS["ringing"].modes()


def test_velocity_autocovariance_begins_at_equipartition() -> None:
    network = NETWORKS["all elements"]
    assert network.velocity(np.array([1e-14]), KT)[0] == pytest.approx(KT / MASS, rel=1e-5)
