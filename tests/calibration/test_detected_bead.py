"""Calibration with the inertia of the fluid and with a detector: against spectra typed by hand."""

import dataclasses
import itertools
import json
import math
import re
from pathlib import Path

import numpy as np
import pytest
from lumicks.pylake.force_calibration.detail import hydrodynamics
from scipy.linalg import toeplitz
from scipy.stats import chi2

import tweezer
from tests.reference import detected_bead
from tests.reference.detected_bead import BOLTZMANN
from tweezer.calibration import TrappedBead, together
from tweezer.calibration.by_axis import ByAxis
from tweezer.reading import Recording
from tweezer.values.rounding import rounded

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
    return Recording(np.arange(len(x)) * step, x[:, None], ("x",), name="record", **more)


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
            assert all(
                "fluid inertia matters; give it" in estimate.caveat
                for estimate in without.estimates
            )
    assert len(scores) == 7
    for method, values in scores.items():
        assert abs(np.mean(values)) < 1.0, method
        assert 0.45 < np.std(values) < 1.55, method


def test_the_inertia_of_a_fluid_needs_that_of_the_bead():
    x = recording(recorded(bead(500e-9, 2000.0, 1e-4), 1e-5, 500, 1)[0], 1e-5)
    with pytest.raises(tweezer.ResultError, match="requires the bead's mass too"):
        tweezer.calibrate(x, temperature=T, displaced_mass="0.5 pg")
    with pytest.raises(tweezer.ResultError, match=r"displaced_mass = -1.*must be positive"):
        tweezer.calibrate(x, temperature=T, mass=1e-15, displaced_mass=-1.0)


KNOWN = ["--temperature", "20 degC", "--radius", "500 nm", "--viscosity", "1.002 mPa s"]


def write_table(name, step, **columns):
    first = next(iter(columns.values()))
    table = np.column_stack([step * np.arange(len(first)), *columns.values()])
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
    assert (outcome.code, outcome.err) == (2, "mine.csv: --fluid-density requires --density\n")


#: exposure (s), f_3 (Hz) and a
DETECTORS = [(0.0, 9e3, 0.3), (6e-6, 9e3, 0.0), (1e-5, 4e4, 0.7)]


@pytest.mark.parametrize("detector", DETECTORS)
@pytest.mark.parametrize("fluid", [False, True])
def test_a_detector_changes_spectra_as_by_hand(detector, fluid):
    """Blur, diode, noise and volts; samples by 40,001 aliases, of which those left out are 1e-5."""
    exposure, f3, through = detector
    found = bead(500e-9, 2000.0, 1e-4, exposure=exposure, noise=2e-3, response=3e6)
    found = dataclasses.replace(found, diode_frequency=f3, diode_fraction=through)
    if not fluid:
        found = dataclasses.replace(found, mass=None, displaced_mass=None)
    k, drag, _, *masses = numbers(found)

    def density(f):
        seen = detected_bead.density(
            f, k, drag, T, *(mass or 0 for mass in masses), exposure, f3, through
        )
        return found.response**2 * seen

    f = np.linspace(50, 49_950, 12)
    np.testing.assert_allclose(found.spectrum(f), density(f), rtol=1e-9)
    aliases = detected_bead.sampled(f, 1e-5, density, 20_000) + 2 * 1e-5 * found.noise**2
    np.testing.assert_allclose(found.sampled_spectrum(f, 1e-5), aliases, rtol=4e-5)
    times = 1e-5 * np.arange(64)
    C = toeplitz(found.autocovariance(times))
    waves = np.exp(-2j * np.pi * np.outer(np.arange(1, 32), np.arange(64)) / 64)
    expected = 2 * 1e-5 / 64 * np.einsum("fi,ij,fj->f", waves, C, waves.conj()).real
    periodogram = found.sampled_spectrum(np.arange(1, 32) / 64e-5, 1e-5, 64)
    np.testing.assert_allclose(periodogram, expected, rtol=1e-8)


def test_a_diode_as_fast_as_a_decay():
    """Of the two exponentials' limit: (1 + w t) e^(-w t)/2."""
    found = TrappedBead(1e-5, 1e-8, T)
    rate = found.stiffness / found.drag
    found = dataclasses.replace(found, diode_frequency=rate / (2 * math.pi))
    t = np.linspace(0, 5, 30)
    expected = KT / 1e-5 * (1 + t) * np.exp(-t) / 2
    np.testing.assert_allclose(found.autocovariance(t / rate), expected, rtol=1e-5)


STEP, SAMPLES = 1 / 78125, 2**15
TRUE = bead(500e-9, 2000.0, 1e-4)
FLUID = {"temperature": T, "mass": TRUE.mass, "displaced_mass": TRUE.displaced_mass}


def seen(records, seed, noise=0.0, of=TRUE, **detector):
    """Records of the bead through a detector, m."""
    x = detected_bead.drawn(
        lambda f: detected_bead.density(f, *numbers(of), **detector), STEP, SAMPLES, seed, records
    )
    return x + noise * np.random.default_rng(seed).standard_normal(x.shape)


@pytest.mark.parametrize(
    ("name", "truth", "of", "asked"),
    [("exposure", 1e-5, {"exposure": 1e-5}, {"exposure": "fit"}),
     ("diode_frequency", 9e3, {"diode": 9e3, "through": 0.4}, {"diode": "fit", "exposure": 0.0}),
     ("diode_fraction", 0.4, {"diode": 9e3, "through": 0.4}, {"diode": "fit", "exposure": 0.0}),
     ("noise", 1e-9, {"noise": 1e-9}, {"noise": "fit", "exposure": 0.0})],
)  # fmt: skip
def test_a_detector_is_fitted(name, truth, of, asked):
    """10 records: (value - true)/uncertainty has mean 0 and deviation 1, in 4 scatters (0.32 and
    0.22): false alarm 1e-3. So have the stiffnesses.
    """
    scores = {}
    for x in seen(10, 61, **of):
        found = tweezer.calibrate(recording(x, STEP), **FLUID, **asked).axes[0]
        assert not found.findings
        (part,) = (each for each in found.detector if each.name == name)
        scores.setdefault(name, []).append((part.value - truth) / part.uncertainty)
        for estimate in found.estimates:
            score = (estimate.stiffness - TRUE.stiffness) / estimate.uncertainty
            scores.setdefault(estimate.method, []).append(score)
    assert set(scores) == {name, "power spectrum", "equipartition", "potential"}
    for each in scores.values():
        assert abs(np.mean(each)) < 1.3
        assert 0.6 < np.std(each) < 1.9


def test_a_detector_that_is_given_is_one_that_is_fitted():
    """What the record tells of it, given back: the same stiffness, better known."""
    (x,) = seen(1, 62, diode=9e3, through=0.4, exposure=5e-6)
    asked = {"exposure": 5e-6, "drag": TRUE.drag, **FLUID}
    free = tweezer.calibrate(recording(x, STEP), diode="fit", **asked).axes[0]
    diode = tuple(each.value for each in free.detector)
    given = tweezer.calibrate(recording(x, STEP), diode=diode, **asked)
    assert given.diode == diode
    assert len(given.axes[0].estimates) == 6
    first, second = free.estimates[0], given.axes[0].estimates[0]
    assert first.stiffness == pytest.approx(second.stiffness, abs=0.02 * second.uncertainty)
    assert first.uncertainty > second.uncertainty
    text = tweezer.calibrate(recording(x, STEP), diode=f"{diode[0]} Hz, {diode[1]}", **asked)
    assert text.axes[0].estimates[0] == second


def test_what_a_record_does_not_determine_is_said():
    (x,) = seen(1, 63)
    every = {"exposure": "fit", "diode": "fit", "noise": "fit"}
    found = tweezer.calibrate(recording(x, STEP), **FLUID, **every).axes[0]
    assert all(each.value is None and each.uncertainty is None for each in found.detector)
    said = " ".join(finding.text for finding in found.remarks)
    for what in ("the exposure", "the frequency of a diode", "white noise: below"):
        assert f"the recording does not determine {what}" in said
    assert not found.findings
    assert abs(found.estimates[0].stiffness - TRUE.stiffness) < 4 * found.estimates[0].uncertainty


def test_a_record_in_volts_with_a_known_drag():
    """The corner frequency is that of the record in metres, and the drag is the given one."""
    (x,) = seen(1, 64)
    signal = dataclasses.replace(recording(x, STEP), positions=3e6 * x[:, None], unit="V")
    found = tweezer.calibrate(signal, drag=TRUE.drag, exposure=0.0, **FLUID)
    metres = tweezer.calibrate(recording(x, STEP), exposure=0.0, **FLUID).axes[0]
    axis = found.axes[0]
    assert found.unit == "V"
    ours, theirs = axis.fit.bead, metres.fit.bead
    assert ours.drag == TRUE.drag
    assert ours.corner_frequency == pytest.approx(theirs.corner_frequency, rel=2e-3)
    assert axis.sensitivity * 3e6 == pytest.approx(math.sqrt(theirs.drag / ours.drag), rel=2e-3)
    assert axis.force_sensitivity == pytest.approx(ours.stiffness * axis.sensitivity)
    relative = metres.fit.drag_uncertainty / theirs.drag
    assert axis.sensitivity_uncertainty / axis.sensitivity == pytest.approx(relative / 2, rel=0.1)
    for estimate in axis.estimates:
        assert not estimate.caveat
        assert abs(estimate.stiffness - TRUE.stiffness) < 4 * estimate.uncertainty
    with pytest.raises(tweezer.ResultError, match="in volts: requires the drag, or the motion of"):
        tweezer.calibrate(signal, **FLUID)


def answer(of, f):
    """Motion of the bead by that of the stage, by hand: the force of the fluid (M. R. Maxey and
    J. J. Riley, Phys. Fluids 26, 883 (1983)) that moves as x_s e^(i w t) around it.
    """
    s = 2j * np.pi * f
    basset = np.sqrt(s) * math.sqrt(4.5 * of.displaced_mass * of.drag)
    on_fluid = of.drag * s + basset * s + 1.5 * of.displaced_mass * s**2
    return on_fluid / (
        of.stiffness + (of.drag + basset) * s + (of.mass + of.displaced_mass / 2) * s**2
    )


@pytest.mark.parametrize("f", [20.0, 300.0, 5e4])
def test_the_answer_to_a_stage(f):
    """By hand, and by pylake, which leaves out what moves the fluid: m_f s/gamma, 4e-4 at 1 kHz."""
    assert complex(TRUE.driven(f)) == pytest.approx(answer(TRUE, f), rel=1e-9)
    theirs = hydrodynamics.theoretical_driving_power_hydrodynamics(
        TRUE.corner_frequency, f, 1e-7, TRUE.drag, 500e-9, WATER, 2000.0, None
    )
    power = abs(complex(TRUE.driven(f))) ** 2 * 1e-14 / 2
    assert power == pytest.approx(theirs, rel=4e-7 * f + 1e-6 if f < 1e3 else 0.1)
    blurred = dataclasses.replace(TRUE, exposure=1e-5, diode_frequency=9e3, response=2.0)
    passed = 2 * np.sinc(1e-5 * f) / math.sqrt(1 + (f / 9e3) ** 2)
    assert complex(blurred.driven(f)) == pytest.approx(passed * answer(TRUE, f), rel=1e-9)


DRIVES = {"one": {37.0: 400e-9}, "three": {23.0: 400e-9, 61.7: 300e-9, 140.3: 200e-9}}


def driven(x, lines, of=TRUE, lag=0.0):
    """The record and the stage's motion; lag: of the record's clock, s."""
    t = STEP * np.arange(len(x))
    waves = {f: np.exp(2j * np.pi * f * t + 1j * f) for f in lines}
    stage = sum(lines[f] * wave.imag for f, wave in waves.items())
    moved = sum(
        lines[f] * (answer(of, f) * wave * np.exp(-2j * np.pi * f * lag)).imag
        for f, wave in waves.items()
    )
    return x + moved, stage


@pytest.mark.parametrize("lines", DRIVES.values(), ids=DRIVES)
def test_stiffness_drag_and_volts_by_a_drive(lines):
    """12 records: scores have mean 0 and deviation 1, in 4 scatters (0.29 and 0.2): false alarm
    1e-3. The stage's own noise moves nothing.
    """
    scores = {}
    for i, x in enumerate(seen(12, 65)):
        moved, stage = driven(x, lines)
        noise = 2e-9 * np.random.default_rng(i).standard_normal(len(x))
        signal = Recording(
            STEP * np.arange(len(x)), 3e6 * moved[:, None], ("x",), name="record", unit="V",
            drive=stage + noise,
        )  # fmt: skip
        found = tweezer.calibrate(signal, exposure=0.0, **FLUID).axes[0]
        assert not found.findings
        assert [a.frequency for a in found.answers] == pytest.approx(list(lines), abs=0.01)
        fit, k = found.free_fit, found.estimates[0]
        for each, (f, size) in zip(found.answers, lines.items(), strict=True):
            moved_by = 3e6 * size * abs(answer(TRUE, f))
            score = (each.signal - moved_by) / each.signal_uncertainty
            scores.setdefault(f"{f} Hz", []).append(score)
        equal = found["equipartition"]
        assert equal.uncertainty == pytest.approx(k.uncertainty, rel=0.1)  # that of the volts
        for name, value, uncertainty, true in (
            ("equipartition", equal.stiffness, equal.uncertainty, TRUE.stiffness),
            ("stiffness", k.stiffness, k.uncertainty, TRUE.stiffness),
            ("drag", fit.bead.drag, fit.drag_uncertainty, TRUE.drag),
            ("volts", found.sensitivity, found.sensitivity_uncertainty, 1 / 3e6),
            ("force", found.force_sensitivity, found.force_sensitivity_uncertainty, 1e-4 / 3e6),
        ):
            scores.setdefault(name, []).append((value - true) / uncertainty)
    for each in scores.values():
        assert abs(np.mean(each)) < 1.0
        assert 0.4 < np.std(each) < 1.8


def test_a_drive_and_a_drag_that_contradict_it():
    (x,) = seen(1, 66)
    moved, stage = driven(x, {37.0: 2e-6})
    signal = Recording(STEP * np.arange(len(x)), moved[:, None], ("x",), name="record", drive=stage)
    good = tweezer.calibrate(signal, drag=TRUE.drag, exposure=0.0, **FLUID).axes[0]
    assert good.sensitivity == pytest.approx(1, abs=4 * good.sensitivity_uncertainty)
    assert [estimate.method for estimate in good.estimates][:2] == [
        "power spectrum", "power spectrum, drag fitted",
    ]  # fmt: skip
    assert not good.findings
    bad = tweezer.calibrate(signal, drag=1.5 * TRUE.drag, exposure=0.0, **FLUID).axes[0]
    assert "drag" in [finding.name for finding in bad.findings]


def test_what_is_wrong_with_a_drive_is_said():
    (x,) = seen(1, 67)
    times = STEP * np.arange(len(x))

    def calibrated(moved, stage):
        signal = Recording(times, moved[:, None], ("x",), name="record", drive=stage)
        return tweezer.calibrate(signal, exposure=0.0, **FLUID).axes[0]

    late = calibrated(*driven(x, {140.0: 1e-6}, lag=2e-4))
    assert [finding.name for finding in late.remarks] == ["late"]
    assert "the signal is 0.2 ms behind" in late.remarks[0].text
    lines = {23.0: 1e-6, 140.3: 1e-6}
    moved, stage = driven(x, lines)
    other = driven(x, {23.0: 1e-6})[0] + 1.3 * (driven(0 * x, {140.3: 1e-6})[0])
    assert not calibrated(moved, stage).findings
    assert "drive" in [finding.name for finding in calibrated(other, stage).findings]
    drifting = 1e-9 * np.cumsum(np.random.default_rng(1).standard_normal(len(x)))
    for other, why in (
        (drifting, "no axis follows the drive"),
        (np.linspace(0, 1e-6, len(x)), "the drive does not oscillate"),
        (0 * x, "the drive does not oscillate"),
        (1e-6 * np.sin(300 * times), "no axis follows the drive"),
    ):
        with pytest.raises(tweezer.ResultError, match=why):
            calibrated(x, other)
    with pytest.raises(tweezer.ResultError, match="drive of shape"):
        calibrated(x, stage[:-1])
    with pytest.raises(tweezer.ResultError, match=r"drive extends over 2 m.*Is its unit missing"):
        calibrated(x, np.sin(300 * times))


def test_an_axis_that_is_not_driven_has_the_drag_of_one_that_is():
    x, y = seen(2, 68)
    moved, stage = driven(x, {37.0: 1e-6})
    signal = Recording(
        STEP * np.arange(len(x)), np.stack([2e6 * y, 3e6 * moved], axis=1), ("x", "y"),
        name="record", unit="V", drive=stage,
    )  # fmt: skip
    still, by_stage = tweezer.calibrate(signal, exposure=0.0, **FLUID).axes
    assert (len(still.answers), len(by_stage.answers)) == (0, 1)
    for axis, response in ((still, 2e6), (by_stage, 3e6)):
        assert axis.sensitivity == pytest.approx(1 / response, abs=4 * axis.sensitivity_uncertainty)
        k = axis.estimates[0]
        assert abs(k.stiffness - TRUE.stiffness) < 4 * k.uncertainty
    first, second = (axis.free_fit for axis in (still, by_stage))
    assert first.bead.drag == pytest.approx(second.bead.drag, rel=0.01)
    assert first.drag_uncertainty == pytest.approx(second.drag_uncertainty, rel=0.05)


def without_findings(calibration):
    """Return the numbers alone: about one record in a hundred has a finding by chance."""
    axes = [
        dataclasses.replace(
            axis,
            estimates=tuple(dataclasses.replace(each, findings=()) for each in axis.estimates),
        )
        for axis in calibration.axes
    ]
    return dataclasses.replace(calibration, axes=ByAxis(axes))


def test_recordings_put_together():
    """The weighted mean, by hand; and none where one of them is of another trap."""

    def calibrated(x):
        found = tweezer.calibrate(recording(x, STEP), drag=TRUE.drag, exposure=0.0, **FLUID)
        return without_findings(found)

    found = [calibrated(x) for x in seen(3, 71)]
    every = {each.quantity: each for each in together(found)}
    assert set(every) == {"stiffness", "drag"}
    estimates = [each.axes[0]["power spectrum"] for each in found]
    k = np.array([each.stiffness for each in estimates])
    weights = np.array([each.uncertainty**-2 for each in estimates])
    mean = every["stiffness"]
    assert mean.mean == pytest.approx((weights @ k) / weights.sum())
    assert mean.uncertainty == pytest.approx(weights.sum() ** -0.5)
    assert mean.p_value == pytest.approx(chi2.sf(weights @ (k - mean.mean) ** 2, 2))
    softer = bead(500e-9, 2000.0, 0.7e-4)
    (x,) = seen(1, 70, of=softer)
    apart = together([found[0], calibrated(x)])[0]
    assert apart.mean is None
    assert "differ by more than their uncertainties" in apart.findings[0].text
    assert together([found[0]])[0].mean is None


@pytest.mark.parametrize(
    ("known", "why"),
    [({"diode": "14 kHz, 0.3, 2"}, "must be a frequency, optionally with the fraction"),
     ({"diode": "14 nm"}, "diode = '14 nm': has an unknown unit"),
     ({"diode": (14e3, 1.0)}, "from 0 to below 1"),
     ({"diode": 0.0}, "its frequency must be positive"),
     ({"noise": -1e-9}, "noise = -1e-09: must not be negative"),
     ({"noise": "1 V"}, "noise = '1 V'"),
     ({"drive": "stage"}, "applies only when a file is read; this `Recording` has its own drive")],
)  # fmt: skip
def test_bad_detectors_are_refused(known, why):
    with pytest.raises(tweezer.ResultError, match=why):
        tweezer.calibrate(recording(seen(1, 71)[0], STEP), temperature=T, **known)


def test_command_with_a_drive_in_volts(command_line):
    x, y = seen(2, 72, noise=3e-10, diode=14e3, through=0.3)
    moved, stage = driven(x, {37.0: 1e-6})
    columns = {"x [mV]": 3e9 * moved, "y [mV]": 2e9 * y, "Stage X [nm]": 1e9 * stage}
    write_table("mine.csv", STEP, **columns)
    asked = ["--temperature", "20 degC", "--drive", "stage x", "--blur", "0", "--diode", "fit"]
    outcome = command_line(
        "calibrate", "mine.csv", *asked, "--noise", "fit", "--out", "k.json", "--plot", "k.png"
    )
    assert (outcome.code, outcome.err) == (0, "")
    assert "stage 37 Hz, 1000 nm: " in outcome.out
    assert " µm/V; " in outcome.out
    written = json.loads(Path("k.json").read_text())
    (axis, other) = written["axes"]
    assert written["unit"] == "V"
    assert abs(axis["sensitivity"] * 3e6 - 1) < 4 * 3e6 * axis["sensitivity_uncertainty"]
    assert [each["name"] for each in axis["detector"]] == [
        "diode_frequency", "noise", "diode_fraction",
    ]  # fmt: skip
    assert other["answers"] == []
    assert Path("k.png").read_bytes().startswith(b"\x89PNG")
    outcome = command_line("calibrate", "mine.csv", *KNOWN, "--drive", "table")
    assert (outcome.code, outcome.out) == (2, "")
    assert outcome.err.startswith("mine.csv: has no column table among 't', 'x [mV]'")


def test_command_on_several_recordings(command_line):
    for name, x in zip(("a.csv", "b.csv"), seen(2, 73), strict=True):
        write_table(name, STEP, x=x)
    known = [*KNOWN, "--density", "2000", "--fluid-density", "998.2", "--exposure", "0"]
    outcome = command_line("calibrate", "a.csv", "b.csv", *known, "--out", "k.json")
    assert (outcome.code, outcome.err) == (0, "")
    assert outcome.out.count("power spectrum, drag fitted") == 2
    written = json.loads(Path("k.json").read_text())
    assert len(written["recordings"]) == 2
    mean = written["together"][0]
    k, error = rounded(1e6 * mean["mean"], 1e6 * mean["uncertainty"])
    assert re.search(f"^ +together +{k} +{error} +p = ", outcome.out, re.MULTILINE)
    outcome = command_line("calibrate", "a.csv", "b.csv", *known, "--plot", "k.png")
    assert (outcome.code, outcome.err) == (2, "--plot applies to one recording, not 2\n")
