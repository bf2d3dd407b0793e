"""Calibration with the inertia of the fluid and with a detector: against spectra typed by hand."""

import dataclasses
import itertools
import json
import math
from pathlib import Path

import numpy as np
import pytest
from lumicks.pylake.force_calibration.detail import hydrodynamics
from scipy.linalg import toeplitz

import tweezer
from tests.reference import detected_bead
from tests.reference.detected_bead import BOLTZMANN
from tweezer.analysis import Recording, TrappedBead

T = 293.15
KT = BOLTZMANN * T
VISCOSITY, WATER = 1.002e-3, 998.2


def bead(radius, density, stiffness, **changes):
    volume = 4 / 3 * math.pi * radius**3
    drag = 6 * math.pi * VISCOSITY * radius
    masses = {"mass": density * volume, "displaced_mass": WATER * volume}
    return TrappedBead(stiffness, drag, T, **masses, **changes)


def numbers(of):
    return of.stiffness, of.drag, of.temperature, of.mass, of.displaced_mass


def by_hand(of, f):
    return detected_bead.density(f, *numbers(of), of.exposure)


BEADS = {
    "250 nm": (250e-9, 2000.0), "500 nm": (500e-9, 1050.0), "500 nm silica": (500e-9, 2000.0),
    "1.5 um": (1.5e-6, 2000.0),
}  # fmt: skip
EVERY = [(*BEADS[name], k) for name, k in itertools.product(BEADS, (1e-6, 2e-5, 1e-4, 1e-3))]


@pytest.mark.parametrize("of", EVERY)
def test_a_bead_in_a_fluid_with_inertia_against_closed_forms(of):
    """In time by Faddeeva's function; in frequency by hand and, sampled at 4 MHz, by aliases."""
    found = bead(*of)
    times = np.geomspace(1e-9, 0.1, 200)
    k, drag, _, *masses = numbers(found)
    exact = detected_bead.correlation(times, k, drag, *masses)
    np.testing.assert_allclose(found.autocovariance(times) * k / KT, exact, rtol=0, atol=5e-6)
    f = np.geomspace(1.0, 1e6, 60)
    np.testing.assert_allclose(found.spectrum(f), by_hand(found, f), rtol=1e-10)
    aliases = detected_bead.sampled(f, 2.5e-7, lambda f: by_hand(found, f), 1000)
    np.testing.assert_allclose(found.sampled_spectrum(f, 2.5e-7), aliases, rtol=1e-4)


@pytest.mark.parametrize("of", EVERY)
def test_its_decays_add_up(of):
    """To k_B T/k, from it without a slope, and to the zero frequency of the spectrum."""
    found = bead(*of)
    parts, rates = np.array(found._decays).T
    assert (rates.real > 0).all()
    assert parts.sum() == pytest.approx(KT / found.stiffness, rel=1e-12)
    assert abs((parts * rates).sum()) < 1e-12 * abs(parts * rates).max()
    assert (parts / rates).sum() == pytest.approx(KT * found.drag / found.stiffness**2, rel=1e-9)


def test_two_rates_that_are_nearly_equal():
    """The trap is made stiffer until two of the rates meet, and become a pair that rings."""
    stiff, soft = 1e-4, 2e-5
    for _ in range(60):
        k = (stiff + soft) / 2
        rings = any(isinstance(rate, complex) for _, rate in bead(500e-9, 2000.0, k)._decays)
        stiff, soft = (k, soft) if rings else (stiff, k)
    times = np.geomspace(1e-7, 0.01, 50)
    for k in (soft, stiff, soft * (1 - 1e-12), stiff * (1 + 1e-9)):
        found = bead(500e-9, 2000.0, k)
        exact = detected_bead.correlation(times, k, found.drag, *numbers(found)[3:])
        np.testing.assert_allclose(found.autocovariance(times) * k / KT, exact, rtol=0, atol=5e-6)


@pytest.mark.parametrize("exposure", [0.0, 6e-6])
def test_the_sampled_spectrum_with_memory_is_the_sum_of_all_aliases(exposure):
    """40,001 of them; those left out fall as f^-3.5."""
    found = bead(500e-9, 2000.0, 1e-4, exposure=exposure)
    f = np.linspace(50, 49_950, 12)
    aliases = detected_bead.sampled(f, 1e-5, lambda f: by_hand(found, f), 20_000)
    np.testing.assert_allclose(found.sampled_spectrum(f, 1e-5), aliases, rtol=4e-5)


def test_the_expected_periodogram_of_a_finite_record_with_memory():
    """E|sum x e^(-i w t)|^2 = w* C w, with the closed form of each of its covariances."""
    found, samples, step = bead(500e-9, 2000.0, 1e-4), 64, 1e-5
    k, drag, _, *masses = numbers(found)
    lags = np.maximum(step * np.arange(samples), 1e-30)
    C = KT / k * toeplitz(detected_bead.correlation(lags, k, drag, *masses))
    waves = np.exp(-2j * np.pi * np.outer(np.arange(1, 32), np.arange(samples)) / samples)
    expected = 2 * step / samples * np.einsum("fi,ij,fj->f", waves, C, waves.conj()).real
    f = np.arange(1, 32) / (samples * step)
    np.testing.assert_allclose(found.sampled_spectrum(f, step, samples), expected, rtol=1e-4)
    assert found.variance_of_mean(step, samples) == pytest.approx(C.mean(), rel=1e-5)


def test_the_spectrum_with_memory_is_that_of_pylake():
    found = bead(500e-9, 2000.0, 1e-4)
    f = np.geomspace(1, 1e6, 50)
    theirs = hydrodynamics.passive_power_spectrum_model_hydro(
        f, found.corner_frequency, found.diffusion, found.drag, 500e-9, WATER, 2000.0, None
    )
    np.testing.assert_allclose(found.spectrum(f), theirs, rtol=1e-9)


def test_a_fluid_without_inertia_is_none():
    """rho_f = 0: the numbers of a bead with its own mass, and nothing else."""
    heavy = dataclasses.replace(bead(500e-9, 2000.0, 1e-4), displaced_mass=None)
    f = np.geomspace(1, 1e5, 50)
    light = dataclasses.replace(heavy, displaced_mass=1e-9 * heavy.mass)
    np.testing.assert_array_equal(
        heavy.sampled_spectrum(f, 1e-6), dataclasses.replace(
            heavy, displaced_mass=0.0
        ).sampled_spectrum(f, 1e-6),
    )  # fmt: skip
    np.testing.assert_allclose(
        light.sampled_spectrum(f, 1e-6), heavy.sampled_spectrum(f, 1e-6), rtol=1e-4
    )


def recorded(of, step, samples, seed, records=1):
    return detected_bead.drawn(lambda f: by_hand(of, f), step, samples, seed, records)


def recording(x, step, **more):
    return Recording("record", np.arange(len(x)) * step, x[:, None], ("x",), **more)


def test_estimates_with_memory_are_as_uncertain_as_they_say():
    """24 records of a 1 um bead at 100 kHz: (k - true)/uncertainty has mean 0 and deviation 1, in 4
    scatters (0.2 and 0.14, and 0.2 of a bias): false alarm 1e-3. Without the inertia of the fluid
    the drag is off by many uncertainties, and no number is trusted.
    """
    true, step = bead(500e-9, 2000.0, 2e-4), 1e-5
    scores = {}
    for i, x in enumerate(recorded(true, step, 2**15, 3, 24)):
        known = {"temperature": T, "mass": true.mass, "displaced_mass": true.displaced_mass}
        found = tweezer.calibrate(recording(x, step), drag=true.drag, exposure=0.0, **known)
        for estimate in found.axes[0].estimates:
            score = (estimate.stiffness - true.stiffness) / estimate.uncertainty
            scores.setdefault(estimate.method, []).append(score)
        free = found.axes[0].free_fit
        scores.setdefault("drag", []).append((free.bead.drag - true.drag) / free.drag_uncertainty)
        if not i:
            without = tweezer.calibrate(recording(x, step), temperature=T, exposure=0.0).axes[0]
            off = (without.fit.bead.drag - true.drag) / without.fit.drag_uncertainty
            assert abs(off) > 10
            assert all(estimate.caveat for estimate in without.estimates)
    assert len(scores) == 7
    for method, values in scores.items():
        assert abs(np.mean(values)) < 1.0, method
        assert 0.45 < np.std(values) < 1.55, method


def test_the_inertia_of_a_fluid_needs_that_of_the_bead():
    x = recording(recorded(bead(500e-9, 2000.0, 1e-4), 1e-5, 500, 1)[0], 1e-5)
    with pytest.raises(tweezer.ResultError, match="needs the bead's mass too"):
        tweezer.calibrate(x, temperature=T, displaced_mass="0.5 pg")
    with pytest.raises(tweezer.ResultError, match=r"displaced_mass = -1.*must be positive"):
        tweezer.calibrate(x, temperature=T, mass=1e-15, displaced_mass=-1.0)


KNOWN = ["--temperature", "20 degC", "--radius", "500 nm", "--viscosity", "1.002 mPa s"]


def write_table(name, step, **columns):
    times = step * np.arange(len(columns["x"]))
    table = np.column_stack([times, *columns.values()])
    np.savetxt(name, table, delimiter=",", header=",".join(["t", *columns]), comments="")


def test_command_with_the_inertia_of_the_fluid(command_line):
    true = bead(500e-9, 2000.0, 1e-4)
    write_table("mine.csv", 1e-5, x=recorded(true, 1e-5, 4000, 1)[0])
    densities = ["--density", "2000 kg/m^3", "--fluid-density", "998.2 kg/m^3"]
    outcome = command_line("calibrate", "mine.csv", *KNOWN, *densities, "--out", "k.json")
    assert (outcome.code, outcome.err) == (0, "")
    written = json.loads(Path("k.json").read_text())
    assert written["mass"] == pytest.approx(true.mass)
    assert written["displaced_mass"] == pytest.approx(true.displaced_mass)
    outcome = command_line("calibrate", "mine.csv", *KNOWN, *densities[2:])
    assert (outcome.code, outcome.err) == (2, "mine.csv: --fluid-density needs --density\n")
