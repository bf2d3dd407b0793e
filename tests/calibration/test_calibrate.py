"""Calibration: theory against matrix exponentials, estimates against exact synthetic records."""

import contextlib
import dataclasses
import itertools
import math
import tracemalloc

import numpy as np
import pytest
from lumicks import pylake
from scipy import stats
from scipy.integrate import quad
from scipy.linalg import expm, solve_continuous_lyapunov, toeplitz
from scipy.signal import lfilter

import tweezer
from tests.reference.trapped_bead import BOLTZMANN, double_well, trapped
from tweezer.calibration import (
    TrappedBead,
    autocovariance,
    mean_squared_displacement,
    power_spectrum,
    standard_error,
    statistical_inefficiency,
)
from tweezer.calibration.histogram import resolution_of
from tweezer.calibration.in_time import (
    covariance_of_averages,
    of_products,
    of_squared_displacements,
)
from tweezer.calibration.left_out import Missing
from tweezer.reading import Recording
from tweezer.values.rounding import with_uncertainty

T = 293.15
K = 1e-5
DRAG = 6 * math.pi * 1.002e-3 * 0.5e-6
TAU = DRAG / K
KT = BOLTZMANN * T
#: masses, in units of beta^2/k: overdamped, a little inertia, critical, ringing
MASSES = {"overdamped": None, "inertial": 0.05, "critical": 0.25, "ringing": 5.0}


def mass(name):
    return None if MASSES[name] is None else MASSES[name] * DRAG * TAU


def record(positions, step):
    return Recording(np.arange(len(positions)) * step, positions[:, None], ("x",), name="record")


def covariance(name, times):
    """<x(0) x(t)> by the matrix exponential of the Langevin equation, t in tau, over kT/k."""
    if MASSES[name] is None:
        return np.exp(-times)
    m = MASSES[name]
    A = np.array([[0.0, 1.0], [-1 / m, -1 / m]])
    equilibrium = solve_continuous_lyapunov(A, -np.diag([0.0, 2 / m**2]))
    return np.array([(expm(A * t) @ equilibrium)[0, 0] for t in times])


@pytest.mark.parametrize("name", MASSES)
def test_theory_in_time(name):
    times = np.linspace(0, 7, 50)
    bead = TrappedBead(K, DRAG, T, mass(name))
    expected = KT / K * covariance(name, times)
    np.testing.assert_allclose(bead.autocovariance(times * TAU), expected, rtol=0, atol=1e-24)
    np.testing.assert_allclose(
        bead.mean_squared_displacement(times * TAU), 2 * (KT / K - expected), rtol=0, atol=1e-24
    )


@pytest.mark.parametrize("name", MASSES)
def test_the_sampled_spectrum_is_the_sum_of_all_aliases(name):
    """Those left out of the sum fall as 1/f^2 or faster: their integral is below 2e-4 of it."""
    step, aliases = 0.8 * TAU, np.arange(-3000, 3001)
    frequencies = np.linspace(0.01, 0.49, 25) / step
    omega = 2 * math.pi * np.abs(frequencies[:, None] + aliases / step)
    m = mass(name) or 0.0
    lorentzians = 4 * KT * DRAG / ((K - m * omega**2) ** 2 + (DRAG * omega) ** 2)
    bead = TrappedBead(K, DRAG, T, mass(name))
    np.testing.assert_allclose(
        bead.sampled_spectrum(frequencies, step), lorentzians.sum(axis=1), rtol=3e-4
    )
    np.testing.assert_allclose(bead.spectrum(frequencies), lorentzians[:, 3000], rtol=1e-12)


@pytest.mark.parametrize("name", MASSES)
def test_the_expected_periodogram_of_a_finite_record(name):
    """E|sum x e^(-i w t)|^2 = w* C w with the covariance matrix C of the whole record."""
    samples, step = 64, 0.3
    C = KT / K * toeplitz(covariance(name, step * np.arange(samples)))
    waves = np.exp(-2j * np.pi * np.outer(np.arange(1, 32), np.arange(samples)) / samples)
    expected = 2 * step * TAU / samples * np.einsum("fi,ij,fj->f", waves, C, waves.conj()).real
    frequencies = np.arange(1, 32) / (samples * step * TAU)
    bead = TrappedBead(K, DRAG, T, mass(name))
    found = bead.sampled_spectrum(frequencies, step * TAU, samples)
    np.testing.assert_allclose(found, expected, rtol=1e-8)
    assert bead.variance_of_mean(step * TAU, samples) == pytest.approx(C.mean(), rel=1e-9, abs=0)


@pytest.mark.parametrize("name", ["overdamped", "critical"])
def test_rates(name):
    bead = TrappedBead(K, DRAG, T, mass(name))
    assert bead.corner_frequency == pytest.approx(1 / (2 * math.pi * TAU))
    relaxation = TAU if name == "overdamped" else TAU / 2
    assert bead.relaxation_time == pytest.approx(relaxation, rel=1e-4, abs=0)
    assert bead.diffusion * bead.drag == pytest.approx(KT, rel=1e-9, abs=0)
    assert bead.variance * bead.stiffness == pytest.approx(KT, rel=1e-9, abs=0)


@pytest.mark.parametrize(
    ("name", "exposure"), [("overdamped", 1e-4), *itertools.product(MASSES, [0.3, 0.8])]
)
def test_exposed_positions_are_means_over_the_exposure(name, exposure):
    """Against the mean over two exposures of <x(s) x(t)>, by quadrature; and E|sum x e^-iwt|^2 as
    above.
    """
    samples, step = 64, 0.8
    bead = dataclasses.replace(TrappedBead(K, DRAG, T, mass(name)), exposure=exposure * TAU)

    def exposed(lag):
        def weighted(apart):
            past = np.array([abs(lag + apart)])
            return (exposure - abs(apart)) / exposure**2 * covariance(name, past)[0]

        kinks = [0.0, -lag] if lag < exposure else [0.0]
        return quad(weighted, -exposure, exposure, points=kinks, epsabs=1e-12)[0]

    lags = np.array([0.0, 0.4 * exposure, 0.8, 1.6])
    expected = KT / K * np.array([exposed(lag) for lag in lags])
    np.testing.assert_allclose(bead.autocovariance(lags * TAU), expected, rtol=1e-9)
    assert bead.variance == pytest.approx(expected[0], rel=1e-9)
    C = toeplitz(bead.autocovariance(step * TAU * np.arange(samples)))
    waves = np.exp(-2j * np.pi * np.outer(np.arange(1, 32), np.arange(samples)) / samples)
    periodogram = 2 * step * TAU / samples * np.einsum("fi,ij,fj->f", waves, C, waves.conj()).real
    frequencies = np.arange(1, 32) / (samples * step * TAU)
    found = bead.sampled_spectrum(frequencies, step * TAU, samples)
    np.testing.assert_allclose(found, periodogram, rtol=1e-8)


def test_the_spectrum_of_exposed_positions_is_that_of_pylake():
    """Its Lorentzian times sinc^2, over 201 aliases: those left out are below 2e-5."""
    models = pylake.force_calibration.detail.power_models
    rate, bead = 1 / (2 * TAU), TrappedBead(K, DRAG, T, exposure=1.6 * TAU)
    blurred = models.motion_blur_spectrum(models.passive_power_spectrum_model, bead.exposure)
    frequencies = np.linspace(0.01, 0.49, 25) * rate
    theirs = models.alias_spectrum(blurred, rate, 100)(
        frequencies, bead.corner_frequency, bead.diffusion
    )
    np.testing.assert_allclose(bead.sampled_spectrum(frequencies, 1 / rate), theirs, rtol=2e-5)


def test_averages_over_a_record_are_their_definitions():
    x = np.cumsum(np.random.default_rng(1).standard_normal(501))
    about = x - x.mean()
    for lag in (0, 1, 17, 499):
        products = about[: 501 - lag] * about[lag:]
        assert autocovariance(x)[lag] == pytest.approx(products.mean(), rel=1e-9)
        squares = (x[lag:] - x[: 501 - lag]) ** 2
        assert mean_squared_displacement(x)[lag] == pytest.approx(squares.mean(), abs=1e-9)
    frequencies, density = power_spectrum(x, 0.1)
    assert density.sum() * frequencies[0] == pytest.approx(x.var(), rel=1e-12)  # Parseval
    parts = [power_spectrum(part, 0.1)[1] for part in np.split(x[:500], 5)]
    np.testing.assert_allclose(power_spectrum(x, 0.1, 5)[1], np.mean(parts, axis=0), rtol=1e-12)


def test_standard_error_of_a_correlated_mean():
    """AR(1): 1 + 2 sum phi^j = (1 + phi)/(1 - phi) = 19. The error of one estimate is sqrt(2 (2 W +
    1)/n) = 3.4 %, W the window of 57; 5 of them: false alarm 6e-7. Of white noise it is 1 to 2 %.
    """
    rng = np.random.default_rng(2)
    white = rng.standard_normal(200_000)
    series = white.copy()
    for i in range(1, series.size):
        series[i] += 0.9 * series[i - 1]
    assert statistical_inefficiency(series) == pytest.approx(19, rel=0.17)
    assert standard_error(series) == pytest.approx(10 / math.sqrt(series.size), rel=0.09)
    assert statistical_inefficiency(white) == pytest.approx(1, rel=0.02)
    assert statistical_inefficiency(np.arange(1000.0)) > 100


def test_statistical_inefficiency_is_its_definition():
    """Sums written out: rho_j to the first W of three times the sum, times 1 + (2W + 1)/n."""
    x = np.random.default_rng(12).standard_normal(60).cumsum()[::2]
    about = x - x.mean()
    rho = [(about[: 30 - j] @ about[j:]) / (30 - j) for j in range(30)]
    inefficiency, window = 1.0, 0
    while window < 3 * inefficiency:
        window += 1
        inefficiency += 2 * rho[window] / rho[0]
    assert window > 3
    assert statistical_inefficiency(x) == pytest.approx(inefficiency * (1 + (2 * window + 1) / 30))


#: name, step and length in tau
RECORDS = {
    "sampled well": ("overdamped", 0.2, 600),
    "sampled at the corner": ("overdamped", 2.0, 1000),
    "inertial": ("inertial", 0.15, 400),
    "ringing": ("ringing", 0.3, 1500),
}


@pytest.mark.parametrize("case", RECORDS)
def test_estimates_are_as_uncertain_as_they_say(case):
    """60 records: (k - true)/uncertainty has mean 0 and deviation 1.

    The mean of 60 scatters by 0.13; what is left of the bias of a record is up to 0.2. The
    deviation scatters by 0.09, and uncertainties are good to a tenth. Bounds are 3.1 and 2.8 of
    these scatters beyond that: false alarm 2e-3 and 5e-3, seeds are fixed.
    """
    name, step, length = RECORDS[case]
    step *= TAU
    samples = round(length * TAU / step)
    records = trapped(step, samples, K, DRAG, mass(name), T, 11, 60)
    scores, p_values = {}, []
    for positions in records:
        found = tweezer.calibrate(
            record(positions, step), temperature=T, drag=DRAG, mass=mass(name)
        ).axes[0]
        for estimate in found.estimates:
            score = (estimate.stiffness - K) / estimate.uncertainty
            scores.setdefault(estimate.method, []).append(score)
        free = found.free_fit
        scores.setdefault("drag", []).append((free.bead.drag - DRAG) / free.drag_uncertainty)
        corner = free.bead.corner_frequency - 1 / (2 * math.pi * TAU)
        scores.setdefault("corner", []).append(corner / free.corner_frequency_uncertainty)
        p_values.append(found.fit.p_value)
    assert len(scores) == 8
    for method, values in scores.items():
        assert len(values) == 60, method
        assert abs(np.mean(values)) < 0.6, method
        assert 0.65 < np.std(values) < 1.35, method
    # p-values are uniform or larger: 15 below 0.1 or 4 below 0.01 have probability 1e-3, 3e-3
    assert sum(p < 0.1 for p in p_values) < 15
    assert sum(p < 0.01 for p in p_values) < 4


def test_covariance_of_averages_over_a_record():
    """4000 records: each covariance scatters by 2.2 % of the root of its variances, sqrt 2 more for
    pairs; 8 % is 3.5 scatters (12 numbers, false alarm 1e-2, the seed is fixed).
    """
    step, samples, lags = 0.3 * TAU, 300, np.array([1, 4, 12])
    x = trapped(step, samples, K, DRAG, None, T, 17, 4000)
    products = [(x[:, : samples - lag] * x[:, lag:]).mean(axis=1) for lag in lags]
    squares = [((x[:, lag:] - x[:, : samples - lag]) ** 2).mean(axis=1) for lag in lags]
    bead = TrappedBead(K, DRAG, T)
    for averages, of_one in (
        (products, of_products), (squares, of_squared_displacements),
    ):  # fmt: skip
        measured = np.cov(averages)
        expected = covariance_of_averages(
            bead, step, samples, lags, of_one, Missing(np.empty(0), np.empty(0))
        )
        size = np.sqrt(np.diag(measured))
        assert np.abs((measured - expected) / np.outer(size, size)).max() < 0.08


def test_what_is_trusted_and_how_well_it_is_known():
    """Uncertainty of k at known drag: Fisher's information of the Lorentzian, 2 tau/t relative."""
    step, samples = 0.05 * TAU, 40_000
    positions = trapped(step, samples, K, DRAG, None, T, 3)[0]
    calibration = tweezer.calibrate(record(positions, step), temperature=T, drag=DRAG)
    found = calibration.axes[0]
    assert [estimate.caveat for estimate in found.estimates] == [""] * 6
    assert (calibration.samples, calibration.step) == (samples, pytest.approx(step))
    spectrum = found["power spectrum"]
    assert spectrum.uncertainty / spectrum.stiffness == pytest.approx(
        math.sqrt(2 * TAU / (samples * step)), rel=0.06
    )
    fit = found.fit
    assert fit.bead.drag == DRAG
    assert fit.drag_uncertainty is None
    assert fit.corner_frequency_uncertainty / fit.bead.corner_frequency == pytest.approx(
        spectrum.uncertainty / spectrum.stiffness
    )
    fitted = tweezer.calibrate(record(positions, step), temperature=T).axes[0]
    assert fitted.fit == fitted.free_fit == found.free_fit
    assert [estimate.method for estimate in fitted.estimates] == [
        "power spectrum", "equipartition", "displacement", "potential",
    ]  # fmt: skip


def test_pylake_recovers_the_same_stiffness():
    """Its fit of the same record, to the Lorentzian well below Nyquist, differs by its blocking and
    range alone: by less than one uncertainty; both are within 4 of the truth (false alarm 6e-5).
    """
    rate = 78125.0
    positions = trapped(1 / rate, 2**17, K, DRAG, None, T, 5)[0]
    theirs = pylake.calibrate_force(
        positions * 1e6, 1.0, T - 273.15, sample_rate=rate, viscosity=1.002e-3, fast_sensor=True,
        fit_range=(10, 8000), num_points_per_block=100,
    )  # fmt: skip
    found = tweezer.calibrate(record(positions, 1 / rate), temperature=T, drag=DRAG).axes[0]
    k, uncertainty = theirs.stiffness * 1e-3, theirs.stiffness_std_err * 1e-3
    ours = found["power spectrum, drag fitted"]
    assert abs(k - K) < 4 * uncertainty
    assert abs(ours.stiffness - K) < 4 * ours.uncertainty
    assert ours.uncertainty == pytest.approx(uncertainty, rel=0.2)
    # theirs takes the drag from the viscosity and the corner frequency from the fit
    corner, error = found.free_fit.bead.corner_frequency, ours.uncertainty / K * 169
    assert theirs.corner_frequency == pytest.approx(corner, abs=error)
    assert k == pytest.approx(2 * math.pi * DRAG * corner, abs=ours.uncertainty)


def test_blocks_of_ordinates_change_no_number(monkeypatch):
    """4,095 ordinates in 1,000 blocks: the stiffness moves by less than a fiftieth of its error,
    the drag by less than an eighth.
    """
    step = 0.1 * TAU
    positions = trapped(step, 8192, K, DRAG, None, T, 41)[0]
    blocks = tweezer.calibrate(record(positions, step), temperature=T).axes[0].fit
    monkeypatch.setattr("tweezer.calibration.whittle._BLOCKS", 10**6)
    each = tweezer.calibrate(record(positions, step), temperature=T).axes[0].fit
    assert blocks.stiffness_uncertainty == pytest.approx(each.stiffness_uncertainty, rel=1e-3)
    assert abs(blocks.bead.stiffness - each.bead.stiffness) < each.stiffness_uncertainty / 50
    assert abs(blocks.bead.drag - each.bead.drag) < each.drag_uncertainty / 8


@pytest.mark.parametrize("known", [{}, {"drag": DRAG}], ids=["drag fitted", "drag given"])
def test_an_exposure_is_corrected_for_if_given_and_seen_if_not(known):
    """A whole step of 1.5 tau. Of 11 numbers each is within 4 uncertainties: false alarm 7e-4."""
    step = 1.5 * TAU
    positions = trapped(step, 8000, K, DRAG, None, T, 51, exposure=step)[0]
    given = tweezer.calibrate(record(positions, step), temperature=T, exposure=step, **known)
    assert given.exposure == step
    for estimate in given.axes[0].estimates:
        assert not estimate.caveat
        assert abs(estimate.stiffness - K) < 4 * estimate.uncertainty
    blind = tweezer.calibrate(record(positions, step), temperature=T, **known)
    assert blind.exposure is None
    for estimate in blind.axes[0].estimates:
        assert "blur" in names(estimate.findings)
    assert blind.axes[0]["equipartition"].stiffness > 1.5 * K


def test_a_known_exposure_is_not_asked_for():
    step = 0.5 * TAU
    positions = trapped(step, 8000, K, DRAG, None, T, 51, exposure=step)[0]
    told = tweezer.calibrate(record(positions, step), temperature=T, exposure=0.0)
    (text,) = [each.text for each in told.axes[0].findings if each.name == "blur"]
    assert text == "the bead moves less from sample to sample than in a trap"


def test_an_exposure_that_the_record_cannot_tell_is_asked_for():
    """Samples every 3 tau, drag fitted: exposed for long, a softer trap looks the same."""
    step = 3 * TAU
    for exposure in (0.0, step):
        positions = trapped(step, 3000, K, DRAG, None, T, 52, exposure=exposure)[0]
        found = tweezer.calibrate(record(positions, step), temperature=T).axes[0]
        assert names(found.findings) & {"exposure", "blur"}
        found = tweezer.calibrate(record(positions, step), temperature=T, exposure=exposure)
        assert not found.axes[0].findings


def test_equipartition_is_as_uncertain_as_the_motion_makes_it():
    """Var(s^2)/s^4 = 2/n sum of e^(-2 |j| h): 2 coth(h)/n, of which the mean takes 2 tau/t less."""
    samples, h = 20_000, 0.2
    positions = trapped(h * TAU, samples, K, DRAG, None, T, 53)[0]
    found = tweezer.calibrate(record(positions, h * TAU), temperature=T, drag=DRAG).axes[0]
    estimate = found["equipartition"]
    expected = math.sqrt(2 / math.tanh(h * estimate.stiffness / K) / samples)
    assert estimate.uncertainty / estimate.stiffness == pytest.approx(expected, rel=0.01)


def names(findings):
    return {finding.name for finding in findings}


def spoilt(how, positions):
    """The record with one of the things that microscopes do to it."""
    size, n = positions.std(), positions.size
    if how == "drift":
        return positions + 2 * size * np.linspace(-0.5, 0.5, n)
    if how == "drift there and back":
        return positions + 2 * size * np.abs(np.linspace(-1, 1, n))
    if how == "noise":
        return positions + 0.3 * size * np.random.default_rng(1).standard_normal(n)
    if how == "halves":
        return np.append(positions[: n // 2], 1.4 * positions[n // 2 :])
    return (positions[1:] + positions[:-1]) / 2  # blur


@pytest.mark.parametrize("known", [{}, {"drag": DRAG}], ids=["drag fitted", "drag given"])
@pytest.mark.parametrize("how", ["drift", "drift there and back", "noise", "halves", "blur"])
def test_what_spoils_a_record_is_said_of_every_number(how, known):
    """Each is 5 or more standard deviations of its test: one is missed with probability 3e-3."""
    step = 0.2 * TAU
    positions = spoilt(how, trapped(step, 4000, K, DRAG, None, T, 54)[0])
    found = tweezer.calibrate(record(positions, step), temperature=T, **known).axes[0]
    assert how.split()[0] in names(found.findings)
    assert len(found.estimates) == (6 if known else 4)
    for estimate in found.estimates:
        assert set(found.findings) <= set(estimate.findings)


def test_a_record_of_a_trapped_bead_is_seldom_marked():
    """40 records: each is marked with probability 0.03; more than 5 are with 2e-3."""
    step = 0.2 * TAU
    records = trapped(step, 1500, K, DRAG, None, T, 55, 40)
    found = [tweezer.calibrate(record(x, step), temperature=T).axes[0] for x in records]
    assert sum(bool(each.findings) for each in found) <= 5


def test_white_noise_leaves_the_autocorrelation_as_it_is():
    """Noise of 0.2 adds 4 % to lag 0 alone: without it k moves by less than half its error."""
    step = 0.1 * TAU
    positions = trapped(step, 8000, K, DRAG, None, T, 56)[0]
    noise = 0.2 * positions.std() * np.random.default_rng(2).standard_normal(8000)
    clean, noisy = (
        tweezer.calibrate(record(x, step), temperature=T, drag=DRAG).axes[0]["autocorrelation"]
        for x in (positions, positions + noise)
    )
    assert abs(clean.stiffness - noisy.stiffness) < clean.uncertainty / 2


@pytest.mark.parametrize(
    ("value", "uncertainty", "text"),
    [(50.3456, 0.4912, "50.35 +- 0.49"), (1069.2, 19.3, "1069 +- 19"),
     (4915.0, 158.0, "4920 +- 160"), (0.00001, 0.0996, "0.00 +- 0.10"),
     (-0.00001, 0.02, "0.000 +- 0.020"), (1.325e-16, 2.4e-19, "1.3250e-16 +- 0.0024e-16"),
     (8.15e8, 2.2e6, "8.150e8 +- 0.022e8"), (3.14159, math.nan, "3.142"),
     (27.6749178, 3e-7, "27.67"), (1763.21, 0.52, "1763"), (9.99961, 1e-8, "10.00"),
     (0.5274712, 1.2e-4, "0.52747 +- 0.00012"), (123456.0, 1.0, "123500"), (5.0, 0.0, "5"),
     (1.23456e-9, 1e-15, "1.235e-9")],
)  # fmt: skip
def test_numbers_have_the_digits_that_their_uncertainty_leaves(value, uncertainty, text):
    assert with_uncertainty(value, uncertainty) == text


def caveats(positions, step, **known):
    found = tweezer.calibrate(record(positions, step), **{"temperature": T, "drag": DRAG, **known})
    return {estimate.method: estimate.caveat for estimate in found.axes[0].estimates}


def test_a_free_bead_is_never_taken_for_a_trapped_one():
    """30 free beads, each taken for trapped with a probability below 1e-2 per Dickey and Fuller."""
    steps = np.random.default_rng(8).standard_normal((30, 3000))
    marked = 0
    for positions in np.cumsum(math.sqrt(2 * KT / DRAG * 1e-5) * steps, axis=1):
        said = caveats(positions, 1e-5)
        assert all(said.values())
        marked += "relaxation times" in said["power spectrum"]
    assert marked == 30


def test_what_is_not_to_be_trusted_says_why():
    step, samples = 0.1 * TAU, 10_000
    positions = trapped(step, samples, K, DRAG, None, T, 21)[0]
    noise = np.random.default_rng(1).standard_normal(samples)
    noisy = caveats(positions + 0.5 * math.sqrt(KT / K) * noise, step)
    assert "disagrees with a trapped bead" in noisy["power spectrum"]
    wrong_drag = caveats(positions, step, drag=1.5 * DRAG)
    assert all("implies 0.6" in caveat for caveat in wrong_drag.values())
    hot = caveats(positions, step, temperature=1.5 * T)
    assert all("implies 1.5" in caveat for caveat in hot.values())
    # but where the drag is fitted nothing can tell
    assert not any(caveats(positions, step, temperature=1.5 * T, drag=None).values())
    short = caveats(positions[:200], step)
    assert all("relaxation times" in caveat for caveat in short.values())
    transient = positions.copy()
    transient[:30] += 40 * math.sqrt(KT / K) * np.exp(-0.1 * np.arange(30))
    assert all("omit the beginning" in caveat for caveat in caveats(transient, step).values())
    ringing = trapped(step, samples, K, DRAG, mass("ringing"), T, 22)[0]
    assert "disagrees with a trapped bead" in caveats(ringing, step)["power spectrum"]
    # sampled every 8 tau: the samples are independent and say nothing of time
    slow = trapped(8 * TAU, 2000, K, DRAG, None, T, 23)[0]
    said = caveats(slow, 8 * TAU, exposure=0.0)
    assert not said["power spectrum"]
    assert not said["equipartition"]
    assert said["autocorrelation"] == "not determined"
    # a static tilt of the record: no method agrees with the spectrum, or that is refused
    drifting = positions + np.linspace(0, 8 * math.sqrt(KT / K), samples)
    assert all(caveats(drifting, step).values())


def test_bad_numbers_are_refused():
    positions = trapped(TAU, 200, K, DRAG, None, T, 1)[0]
    for known, why in (
        ({"temperature": 0.0}, "must be positive"),
        ({"drag": -1.0}, "must be positive"),
        ({"mass": math.inf}, "must be finite"),
        ({"temperature": "20 C"}, "did you mean degC"),
        ({"drag": "9.4 nm"}, "wrong unit"),
        ({"exposure": [TAU]}, "must be a number"),
    ):
        with pytest.raises(tweezer.ResultError, match=why):
            caveats(positions, TAU, **known)
    with pytest.raises(tweezer.ResultError, match="requires the temperature"):
        caveats(positions, TAU, temperature=None)
    for exposure in (-1e-6, 1.1 * TAU):
        with pytest.raises(tweezer.ResultError, match="must be from 0 to the sampling"):
            caveats(positions, TAU, exposure=exposure)


def test_what_is_known_may_be_text_with_a_unit():
    seen = record(good_record(200), 1e-4)
    numbers = tweezer.calibrate(seen, temperature=293.15, drag=9.4e-9, mass=1e-15, exposure=5e-5)
    text = tweezer.calibrate(
        seen, temperature="20 degC", drag="9.4 pN s/mm", mass="1 pg", exposure="50 us"
    )
    for name in ("temperature", "drag", "mass", "exposure"):
        assert getattr(text, name) == pytest.approx(getattr(numbers, name), rel=1e-14)


def test_potential_of_a_double_well():
    """Independent positions: bins scatter about -kT ln of the integral over each, as chi-square."""
    barrier, minima = 3 * KT, 1e-7
    well = tweezer.potential(double_well(barrier, minima, 50_000, T, 6), T)
    assert well.coordinates.size > 15
    width = np.diff(well.coordinates).min()

    def density(x):
        return math.exp(-barrier * ((x / minima) ** 2 - 1) ** 2 / KT)

    expected = -KT * np.log(
        [quad(density, x - width / 2, x + width / 2)[0] / width for x in well.coordinates]
    )
    weights = 1 / well.errors**2
    apart = well.energy - expected
    apart -= (weights @ apart) / weights.sum()
    chi_square = weights @ apart**2
    assert 1e-3 < stats.chi2.sf(chi_square, well.coordinates.size - 1) < 1 - 1e-3
    # the parabola at the bottom of one of the wells: U'' = 8 barrier/minima^2, less by the quartic
    assert abs(well.minimum) == pytest.approx(minima, rel=0.1)
    assert well.stiffness == pytest.approx(8 * barrier / minima**2, rel=0.25)


def test_a_potential_of_too_few_samples_has_no_parabola():
    x = np.random.default_rng(1).standard_normal(60) * 1e-8
    well = tweezer.potential(x, T)
    assert (well.stiffness, well.uncertainty, well.minimum) == (None, None, None)


def test_a_potential_in_wide_bins_is_as_stiff():
    """Of 800 positions bins are 0.46 deviations wide: without Sheppard's correction k is 1.8 % too
    small. The mean of 400 such k scatters by 0.4 %: false alarm 1e-2, the seed is fixed.
    """
    x = 1e-8 * np.random.default_rng(12).standard_normal((400, 800))
    wells = [tweezer.potential(positions, T) for positions in x]
    stiffness = np.array([well.stiffness for well in wells])
    assert stiffness.mean() == pytest.approx(KT / 1e-16, rel=0.01)
    scatter = np.mean([well.uncertainty for well in wells])
    assert stiffness.std() == pytest.approx(scatter, rel=0.15)


@pytest.mark.parametrize("step", [0.05, 0.13, 0.4, 0.6])
def test_a_potential_of_digitised_positions_is_as_stiff(step):
    """The 95 % intervals of 143 +- 2.7 of 150 recordings contain k, and fewer than 131 with the
    probability 1e-4. With bins of any width they were 73 % at 0.4 deviations. One sample in 200
    lies between the recorded values.
    """
    rng = np.random.default_rng(31)
    x = rng.standard_normal((150, 1500)) + 0.3 * np.linspace(0, 1, 150)[:, None]
    x = step * np.rint(x / step)
    x[:, 5::200] += step * rng.uniform(-0.5, 0.5, x[:, 5::200].shape)
    wells = [tweezer.potential(1e-8 * positions, T) for positions in x]
    k = np.array([(well.stiffness, well.uncertainty) for well in wells])
    inside = np.abs(k[:, 0] - KT / 1e-16) < 1.96 * k[:, 1]
    assert inside.sum() > 130


def test_the_step_of_a_digitised_record():
    rng = np.random.default_rng(32)
    x = 1e-8 * rng.standard_normal(20_000)
    assert resolution_of(x) == 0.0
    for step in (2e-8, 3e-9, 1e-10):
        digitised = 5e-7 + step * np.rint(x / step)
        assert resolution_of(digitised) == pytest.approx(step, rel=1e-4)
    assert resolution_of(digitised + 1e-9 * rng.standard_normal(x.size)) == 0.0
    assert resolution_of(np.ones(10)) == 0.0


@pytest.mark.parametrize("ratio", [0.05, 0.6])
def test_calibration_takes_little_memory(ratio):
    """At most ten times that of the record, 3.2 MB; longer records take relatively less."""
    n = 400_000
    x = lfilter([1], [1, -math.exp(-ratio)], np.random.default_rng(33).standard_normal(n))
    step = ratio * TAU
    recording = Recording(step * np.arange(n), 1e-9 * x[:, None], ("x",), name="record")
    tracemalloc.start()
    try:
        tweezer.calibrate(recording, temperature=T)
        assert tracemalloc.get_traced_memory()[1] < 10 * x.nbytes
    finally:
        tracemalloc.stop()


def journeys(times, escapes):
    """Beads at 0 that are at 2 from `escapes` on."""
    return np.where(times >= np.asarray(escapes)[:, None], 2.0, 0.0)[..., None]


def test_escape_times_with_censoring():
    """Exponential times, a third censored: the interval holds the mean in 95 % of 400 cases or
    more (below 93 %: false alarm 4e-2 per scatter of 1.1 %; below 91.6 %: 1e-3), and the p-value of
    a constant rate is uniform (Kolmogorov and Smirnov, false alarm 1e-3).
    """
    rng = np.random.default_rng(4)
    times = np.linspace(0, 1.1, 1101)
    inside, p_values = 0, []
    for _ in range(400):
        escapes = rng.exponential(1.0, 60)
        found = tweezer.escape_times(times, journeys(times, escapes), 1.0)
        assert (found.escaped == (escapes <= 1.1)).all()
        assert found.mean == pytest.approx(found.times.sum() / found.escaped.sum())
        inside += found.interval[0] < 1.0 < found.interval[1]
        p_values.append(found.p_value)
    assert inside > 0.916 * 400
    assert stats.kstest(p_values, "uniform").pvalue > 1e-3
    early = tweezer.escape_times(times, journeys(times, 0.5 * rng.weibull(3.0, 60)), 1.0)
    assert early.p_value < 1e-6


def test_the_score_of_a_constant_rate():
    """Against Weibull's likelihood, differentiated numerically at shape 1 and the mean."""
    times = np.linspace(0, 1.5, 1501)
    found = tweezer.escape_times(
        times, journeys(times, np.random.default_rng(14).exponential(1.0, 40)), 1.0
    )
    t, escaped, h = found.times, found.escaped, 1e-3

    def likelihood(shape, scale):
        weibull = stats.weibull_min(shape, scale=scale * found.mean)
        return weibull.logpdf(t[escaped]).sum() + weibull.logsf(t[~escaped]).sum()

    def second(i, j):
        return sum(
            a * b * likelihood(1 + h * (a * i[0] + b * j[0]), 1 + h * (a * i[1] + b * j[1]))
            for a in (-1, 1)
            for b in (-1, 1)
        ) / (4 * h**2)

    shape, scale = (1, 0), (0, 1)
    score = (likelihood(1 + h, 1) - likelihood(1 - h, 1)) / (2 * h)
    hessian = -np.array(
        [[second(shape, shape), second(shape, scale)], [second(scale, shape), second(scale, scale)]]
    )
    expected = 2 * stats.norm.sf(abs(score) * math.sqrt(np.linalg.inv(hessian)[0, 0]))
    assert found.p_value == pytest.approx(expected, rel=1e-3)


def test_survival_is_the_part_that_is_left():
    times = np.arange(11.0)
    found = tweezer.escape_times(times, journeys(times, [2, 4, 4, 7, 20, 30]), 1.0)
    moments, left, low, high = found.survival
    kept = dict(zip(moments, left, strict=True))
    assert [kept[t] for t in (2, 4, 7)] == pytest.approx([5 / 6, 3 / 6, 2 / 6])
    assert (low[:3] <= left[:3]).all()
    assert (left[:3] <= high[:3]).all()
    assert found.p_value is None
    assert found.mean == pytest.approx((2 + 4 + 4 + 7 + 10 + 10) / 4)
    lost = journeys(times, [2, 20])
    lost[1, 5:] = np.nan
    assert tweezer.escape_times(times, lost, 1.0).times.tolist() == [2, 5]


def test_without_an_escape_there_is_a_lower_limit():
    times = np.arange(11.0)
    found = tweezer.escape_times(times, journeys(times, [20] * 8), 1.0)
    assert (found.mean, found.p_value, found.interval[1]) == (None, None, None)
    # no escape in 80 s: exp(-80/mean) = 0.025 at the limit
    assert found.interval[0] == pytest.approx(80 / -math.log(0.025))
    with pytest.raises(tweezer.ResultError, match="trajectory 1 starts outside"):
        tweezer.escape_times(times, journeys(times, [20, 0]), 1.0)


def test_escape_of_a_free_bead_takes_its_diffusion_time():
    """<t> = a^2/2D out of |x| < a; a walk in steps overshoots by 0.5826 sqrt(2 D h) (D. Siegmund,
    Adv. Appl. Probab. 11, 701 (1979)). t scatters by sqrt(2/3) <t>; 4 errors: false alarm 6e-5.
    """
    steps = math.sqrt(2e-3) * np.random.default_rng(9).standard_normal((600, 6000))
    steps[:, 0] = 0
    walks = np.cumsum(steps, axis=1)[..., None]
    found = tweezer.escape_times(np.arange(6000) * 1e-3, walks, 1.0)
    expected = (1 + 0.5826 * math.sqrt(2e-3)) ** 2 / 2
    assert found.mean == pytest.approx(expected, abs=4 * math.sqrt(2 / 3 / 600) * expected)
    assert found.p_value < 1e-3  # the rate is not constant: none escapes at once


def test_a_fit_is_the_best_of_its_neighbours():
    """The likelihood at the fit is not exceeded by one a hundredth of an uncertainty away."""
    step = 0.2 * TAU
    positions = trapped(step, 2000, K, DRAG, None, T, 31)[0]
    fit = tweezer.calibrate(record(positions, step), temperature=T).axes[0].fit
    frequencies, density = power_spectrum(positions, step)
    used = frequencies <= fit.highest_frequency

    def likelihood(k, drag):
        bead = dataclasses.replace(fit.bead, stiffness=k, drag=drag)
        model = bead.sampled_spectrum(frequencies[used], step, 2000)
        return stats.expon.logpdf(density[used], scale=model).sum()

    k, drag = fit.bead.stiffness, fit.bead.drag
    dk, db = 0.01 * fit.stiffness_uncertainty, 0.01 * fit.drag_uncertainty
    around = [likelihood(k + i * dk, drag + j * db) for i in (-1, 0, 1) for j in (-1, 0, 1)]
    assert max(around) - likelihood(k, drag) < 1e-5


def good_record(samples=20_000):
    return trapped(1e-4, samples, K, DRAG, None, T, 77)[0]


@pytest.mark.parametrize("known", [{}, {"drag": DRAG}])
@pytest.mark.parametrize(
    ("spoil", "said"),
    [
        (
            lambda x, s: np.append(x[:-200], x[-200:] + np.linspace(0, 100, 200) * s),
            "deviations from the median",
        ),
        (
            lambda x, s: np.append(x[:-40], x[-40:] + np.linspace(0, 20, 40) * s),
            "deviations from the median",
        ),
        (lambda x, s: np.where(np.arange(x.size) == 9_000, 40 * s, x), "sample 9001 is"),
        (lambda x, s: np.where(np.arange(x.size) < 5_000, x, 0.0), "its samples are equal"),
        (lambda x, s: np.minimum(x, 2 * s), "samples equal the largest one"),
        (lambda x, s: np.maximum(np.round(x / s, 1) * s, -2 * s), "samples equal the smallest one"),
        (lambda x, s: x + s * np.sin(np.arange(x.size) / 300), "it oscillates at 5.5 Hz"),
    ],
    ids=["escape", "short escape", "spike", "stuck", "clipped", "clipped and rounded", "line"],
)
def test_what_is_far_off_spoils_every_estimate_and_is_told(spoil, said, known):
    x = good_record()
    spoilt = record(spoil(x, x.std()), 1e-4)
    found = tweezer.calibrate(spoilt, temperature=T, **known).axes[0]
    assert all(said in estimate.caveat for estimate in found.estimates)


@pytest.mark.parametrize("digits", [0, 1])
def test_a_record_that_is_rounded_is_not_clipped(digits):
    x = good_record(2000)
    rounded = np.round(x / x.std(), digits) * x.std()
    findings = tweezer.calibrate(record(rounded, 1e-4), temperature=T).axes[0].findings
    assert not {"clipped", "line"} & {finding.name for finding in findings}


@pytest.mark.parametrize("x", [np.tile([1e-8, -1e-8], 500), np.linspace(0, 1e-6, 1000) ** 2 * 1e6])
def test_what_no_bead_does_is_refused_or_not_trusted(x):
    for known in ({}, {"drag": DRAG}, {"drag": DRAG, "mass": 1e-15}):
        estimates = ()
        with contextlib.suppress(tweezer.ResultError):
            estimates = tweezer.calibrate(record(x, 1e-4), temperature=T, **known).axes[0].estimates
        assert all(estimate.caveat for estimate in estimates)


@pytest.mark.parametrize("temperature", [20.0, 1e-300, 1e5])
def test_a_temperature_that_no_medium_has_is_refused(temperature):
    with pytest.raises(tweezer.ResultError, match="must be from 50 to 5000 K"):
        tweezer.calibrate(record(good_record(200), 1e-4), temperature=temperature)


@pytest.mark.parametrize(
    "positions", [[], np.zeros((3, 4)), [1.0, np.nan, 2.0], [1e-9, 1e-9]], ids=str
)
def test_potential_refuses_what_is_no_row_of_positions(positions):
    with pytest.raises(tweezer.ResultError, match="positions"):
        tweezer.potential(positions, T)


@pytest.mark.parametrize(
    ("times", "positions", "radius"),
    [
        (np.arange(5.0), np.zeros((2, 9, 3)), 1e-6),
        (np.arange(5.0), np.zeros((0, 5, 3)), 1e-6),
        (np.arange(5.0), np.zeros((2, 5)), 1e-6),
        (np.arange(5.0), np.full((2, 5, 3), np.nan), 1e-6),
        (np.arange(5.0), np.zeros((2, 5, 3)), np.nan),
    ],
)
def test_escape_times_refuse_arrays_that_do_not_fit(times, positions, radius):
    with pytest.raises(tweezer.ResultError):
        tweezer.escape_times(times, positions, radius)
