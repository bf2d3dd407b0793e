"""The fluid's memory as modes: against closed forms, sum rules, interlacing, and its tail."""

import functools

import numpy as np
import pytest
from scipy.constants import Boltzmann

from tests.reference.fluid import Sphere
from tweezer.fluid.memory import NODES, modes
from tweezer.generated.memory_poles import ERRORS
from tweezer.scene.choices import POLES

#: of 250 nm and 1.5 um radius, polystyrene and silica
BEADS = {
    f"{1e9 * radius:.0f} nm, {density} kg/m^3": Sphere.of(radius, density)
    for radius in (250e-9, 1.5e-6)
    for density in (1050, 2000)
}
STIFFNESSES = (1e-6, 2e-5, 2e-4)
TIMES = np.geomspace(1e-9, 0.1, 161)
FREQUENCIES = np.geomspace(1, 1e6, 121)
FINER = 32

every_bead = pytest.mark.parametrize("bead", BEADS.values(), ids=BEADS)


@functools.cache
def modes_of(bead, poles):
    """Relaxation times and weights."""
    return modes(bead.mass, bead.drag, bead.displaced_mass, poles)


def velocity_correlation(bead, poles, t):
    """Over kT/M: <v_j^2> = D/(tau_j a_j), independent of each other."""
    tau, a = modes_of(bead, poles)
    return bead.time * (a / tau * np.exp(-t[:, None] / tau)).sum(axis=1)


def displacement(bead, poles, t):
    """<(x(t) - x(0))^2>/(2 kT) of a free bead."""
    tau, a = modes_of(bead, poles)
    s = t[:, None] / tau
    # s - 1 + e^(-s), by its series where that has no digits
    lag = np.where(s < 1e-3, s**2 / 2 - s**3 / 6 + s**4 / 24, s + np.expm1(-s))
    return (a * tau * lag).sum(axis=1) / bead.drag


def admittance(bead, poles, s, k=0.0):
    tau, a = modes_of(bead, poles)
    Z = bead.drag / (a / (1 + s[:, None] * tau)).sum(axis=1)
    return 1 / (Z + k / s)


def matrix(bead, poles, k):
    """d(x, v_j)/dt = A (x, v_j) in a trap."""
    tau, a = modes_of(bead, poles)
    A = np.zeros((len(tau) + 1,) * 2)
    A[0, 1:], A[1:, 0] = a, -k / bead.drag / tau
    A[np.arange(1, len(A)), np.arange(1, len(A))] = -1 / tau
    return A


def relaxed(bead, poles, k, t):
    """x(t)/x(0), all at rest at first."""
    A = matrix(bead, poles, k)
    rates, vectors = np.linalg.eig(A)
    amplitudes = vectors[0] * np.linalg.solve(vectors, np.eye(len(A))[:, 0])
    return (np.exp(np.outer(t, rates)) * amplitudes).sum(axis=1).real


def errors(bead, poles):
    """Of velocity (of kT/M), displacement, spectrum and relaxation: as `ERRORS` has them."""
    s = 2j * np.pi * FREQUENCIES
    velocity = velocity_correlation(bead, poles, TIMES) - bead.velocity_correlation(TIMES)
    moved = displacement(bead, poles, TIMES) / bead.moved(TIMES) - 1
    exact = {k: (1 / (bead.impedance(s) + k / s)).real for k in (0.0, *STIFFNESSES)}
    spectra = [admittance(bead, poles, s, k).real / exact[k] - 1 for k in exact]
    released = [
        relaxed(bead, poles, k, TIMES) - bead.relaxation(TIMES, k) for k in STIFFNESSES
    ]  # fmt: skip
    return [np.abs(each).max() for each in (velocity, moved, spectra, released)]


@every_bead
def test_default_poles_meet_the_closed_forms(bead):
    """From 1 ns to 0.1 s, and below 1 MHz."""
    assert (np.array(errors(bead, POLES)) < (1e-5, 5e-5, 2e-4, 1e-5)).all()


@pytest.mark.parametrize("poles", NODES)
def test_errors_are_those_that_the_table_states(poles):
    """By other closed forms than those of the script, and of other beads between."""
    # a bead between may be a little worse
    between = np.array(errors(Sphere.of(0.5e-6, 1200), poles))
    assert (between < 1.05 * np.array(ERRORS[poles][:4])).all()
    of_all = np.max([errors(bead, poles) for bead in BEADS.values()], axis=0)
    assert (of_all <= ERRORS[poles][:4]).all()
    assert (of_all > 0.5 * np.array(ERRORS[poles][:4])).all()


@every_bead
def test_tail_over_five_decades(bead):
    """t^(-3/2), as a part of the closed form, from tau_f on."""
    t = bead.vorticity_time * np.geomspace(1, 1e5, 101)
    exact = bead.velocity_correlation(t)
    assert np.abs(velocity_correlation(bead, FINER, t) / exact - 1).max() < 1e-3
    last = t[-1:]
    power = bead.tail * bead.total_mass * last**-1.5
    assert velocity_correlation(bead, FINER, last) == pytest.approx(power, rel=5e-3)


def test_tail_does_not_depend_on_the_radius():
    """kT sqrt(rho_f)/(12 (pi eta)^(3/2)) t^(-3/2): the same of every bead."""
    t = np.array([1e-3, 5e-3])
    common = np.sqrt(998.2) / (12 * (np.pi * 1.0016e-3) ** 1.5) * t**-1.5
    for bead in BEADS.values():
        assert bead.tail * t**-1.5 == pytest.approx(common, rel=1e-12)
        of_modes = velocity_correlation(bead, FINER, t) / bead.total_mass
        # what is left is of the order (tau_f/t)^(1/2) over t/tau_f
        assert of_modes == pytest.approx(common, rel=1.5e-2)


@every_bead
@pytest.mark.parametrize("poles", NODES)
def test_weights_are_positive_and_rates_interlace_with_poles(bead, poles):
    """One rate below the first pole, one between each two, one above."""
    tau, a = modes_of(bead, poles)
    assert (a > 0).all()
    rates = np.sort(bead.vorticity_time / tau)
    p = NODES[poles][0]
    assert len(rates) == poles + 1
    assert (rates[:-1] < p).all()
    assert (p < rates[1:]).all()


@every_bead
@pytest.mark.parametrize("poles", NODES)
def test_sum_rules(bead, poles):
    """Einstein's: sum a_j = 1; equipartition: sum <(a_j v_j)^2> = kT/M."""
    tau, a = modes_of(bead, poles)
    assert a.sum() == pytest.approx(1, abs=1e-13)
    D = Boltzmann * 300 / bead.drag
    squared = (a**2 * D / (tau * a)).sum()
    assert squared == pytest.approx(Boltzmann * 300 / bead.total_mass, rel=1e-13)


@every_bead
@pytest.mark.parametrize("k", STIFFNESSES)
def test_relaxation_is_the_autocorrelation(bead, k):
    """Onsager: of a bead released at rest, and of the same bead in thermal equilibrium.

    In equilibrium by Lyapunov's equation, with <x^2> = kT/k and <v_j^2> = D/(tau_j a_j).
    """
    tau, a = modes_of(bead, POLES)
    A = matrix(bead, POLES, k)
    # over kT: moments of equilibrium, and the noise that keeps them
    moments = np.diag([1 / k, *1 / (bead.drag * tau * a)])
    noise = np.diag([0.0, *2 / (bead.drag * tau**2 * a)])
    balance = A @ moments + moments @ A.T + noise
    scale = np.sqrt(np.outer(np.diag(moments), np.diag(moments))) / tau.min()
    assert np.abs(balance / scale).max() < 1e-14
    # <x(t) x(0)> = e^(At) moments: only x correlates with x
    assert (moments[1:, 0] == 0).all()
    t = np.geomspace(1e-8, 0.1, 25)
    correlation = bead.relaxation(t, k)
    assert np.abs(relaxed(bead, POLES, k, t) - correlation).max() < 1e-5


@every_bead
def test_a_trapped_bead_overshoots(bead):
    """By memory: -(beta/k) sqrt(tau_f/4 pi) t^(-3/2) in the end."""
    k, t = 2e-5, np.array([30.0, 60.0]) * bead.drag / 2e-5
    tail = -bead.drag / k * np.sqrt(bead.vorticity_time / (4 * np.pi)) * t**-1.5
    assert relaxed(bead, FINER, k, t) == pytest.approx(tail, rel=0.12)
    assert bead.relaxation(t, k) == pytest.approx(tail, rel=0.12)
    without = Sphere(bead.mass, bead.drag, 0.0)
    assert np.abs(without.relaxation(t, k)).max() < 1e-12


def test_without_displaced_mass_one_mode_is_left():
    assert [list(each) for each in modes(5e-16, 1e-8, 0.0, POLES)] == [[5e-16 / 1e-8], [1.0]]
