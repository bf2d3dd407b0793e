"""What is left out of a record, against dense matrices and against records that lack nothing."""

import math

import numpy as np
import pytest
from scipy.fft import dct

import tweezer
from tests.reference.free_bead import free
from tests.reference.trapped_bead import BOLTZMANN, trapped
from tweezer.calibration import TrappedBead
from tweezer.calibration.left_out import LeftOut
from tweezer.calibration.whittle import Periodogram
from tweezer.reading import Recording

T, K = 293.15, 2e-5
DRAG = 6 * math.pi * 1.002e-3 * 0.5e-6
STEP, SAMPLES = 2e-4, 10_000
TIMES = STEP * np.arange(SAMPLES)
SIZE = math.sqrt(BOLTZMANN * T / K)
#: Drift there and back, and hum with an overtone.
DISTURBED = SIZE * (
    2 * np.cos(2.2 * TIMES)
    + 1.5 * np.sin(2 * np.pi * 50.3 * TIMES)
    + 0.7 * np.cos(2 * np.pi * 150.9 * TIMES)
)
CLEANED = {"leave_out": ["49 Hz..52 Hz", (149, 153)], "drift": "3 Hz"}


def calibrated(x, **how):
    recording = Recording(TIMES, x[:, None], ("x",), name="mine")
    return tweezer.calibrate(recording, temperature=T, drag=DRAG, exposure=0, **how)


@pytest.fixture(scope="module")
def clean():
    return trapped(STEP, SAMPLES, K, DRAG, None, T, 7)[0]


@pytest.mark.parametrize("left", [LeftOut(drift=12.0), LeftOut(bands=((40, 80), (90, 101)))])
def test_what_is_missing_is_the_mean_of_the_projected_covariance(left):
    """Averages over lags of P C P, with P the projection on what remains: by matrices."""
    n, bead = 400, TrappedBead(K, DRAG, T)
    at = np.arange(n)
    covariance = bead.variance * np.exp(-np.abs(at[:, None] - at) * K * STEP / DRAG)
    waves = dct(np.eye(n), norm="ortho", axis=0)
    rows = waves[1 : 1 + left.cosines(n, STEP)]
    if left.bands:
        f = np.fft.rfftfreq(n, STEP)
        used = f[((f >= 40) & (f <= 80)) | ((f >= 90) & (f <= 101))]
        angles = 2 * np.pi * STEP * np.outer(used, at)
        rows = np.vstack([np.cos(angles), np.sin(angles)]) * math.sqrt(2 / n)
    assert len(rows) == (1 if left.drift else 8)
    kept = np.eye(n) - rows.T @ rows
    changed = covariance - kept @ covariance @ kept
    lags = np.array([0, 3, 10, 30])
    expected = [np.diagonal(changed, lag).mean() for lag in lags]
    ours = left.missing(bead, n, STEP).autocovariance(lags * STEP)
    np.testing.assert_allclose(ours, expected, rtol=0.15, atol=1e-3 * bead.variance)


def test_a_periodogram_covers_what_it_counts(clean):
    bands = ((0, 3), (1000, 1003), (2000, math.inf))
    part = Periodogram.of(clean, STEP, bands)[20:-5]
    covered, density = part.covered
    assert density.mean() == pytest.approx(part.density @ part.counts / part.counts.sum())
    assert len(covered) == part.counts.sum()
    assert not ((covered >= 1000) & (covered <= 1003)).any()
    assert part.ends[0, 0] <= covered[0] < covered[-1] <= part.ends[-1, 1] < 2000


def test_drift_and_lines_are_taken_off():
    left = LeftOut(bands=((49, 52), (149, 153)), drift=3.0)
    kept = left.without(1e-6 + DISTURBED, STEP)
    assert kept.mean() == pytest.approx(1e-6 + DISTURBED.mean(), rel=1e-9)
    assert kept.std() < 0.03 * SIZE
    said = left.words(1e-6 + DISTURBED, kept, STEP, "m")
    assert said.startswith("left out: the drift, 12 cosines slower than 3 Hz, 49 to 52 Hz, 149 to ")
    assert left.words(kept, kept, STEP, "V").endswith("; together 0 mV rms")


def test_a_drifting_humming_record_gives_what_the_clean_one_does(clean):
    dirty = clean + DISTURBED
    spoilt = {each.name: each.text for each in calibrated(dirty).axes[0].findings}
    assert "nm rms below 1 Hz" in spoilt["drift"]
    assert "it oscillates at 50.5 and 151 Hz" in spoilt["line"]
    plain, cleaned = calibrated(clean).axes[0], calibrated(dirty, **CLEANED).axes[0]
    assert not plain.findings + cleaned.findings
    for estimate in plain.estimates:
        other = cleaned[estimate.method]
        assert not other.caveat
        assert abs(other.stiffness - estimate.stiffness) < estimate.uncertainty
        assert other.uncertainty == pytest.approx(estimate.uncertainty, rel=0.15)
    assert cleaned.remarks[0].text.startswith("left out: the drift, 12 cosines slower than 3 Hz")


def test_what_is_taken_off_is_corrected_for(clean):
    """A tenth of the motion is taken off; 2 of the uncertainties, which grow."""
    bead = TrappedBead(K, DRAG, T)
    much = {"leave_out": ["100 Hz..160 Hz"], "drift": "20 Hz"}
    share = LeftOut.of("mine", **much).missing(bead, SAMPLES, STEP).variances.sum() / bead.variance
    assert share > 0.1
    for estimate in calibrated(clean, **much).axes[0].estimates:
        assert abs(estimate.stiffness - K) < 2 * estimate.uncertainty
        assert estimate.uncertainty < 0.1 * K


def test_a_range_is_what_spectra_are_fitted_over(clean):
    drifting = clean + 2 * SIZE * np.cos(2.2 * TIMES)
    axis = calibrated(drifting, fit_range="20 Hz..1 kHz").axes[0]
    assert axis.fit.highest_frequency <= 1000
    assert not axis.findings
    assert not axis["power spectrum"].caveat
    assert abs(axis["power spectrum"].stiffness - K) < 3 * axis["power spectrum"].uncertainty
    assert "drift" in {each.name for each in axis["equipartition"].findings}


def test_command_leaves_out(command_line, clean):
    table = np.column_stack([TIMES, clean + DISTURBED])
    np.savetxt("mine.csv", table, delimiter=",", header="t,x", comments="")
    options = [part for band in ("49 Hz..52 Hz", "149..153") for part in ("--leave-out", band)]
    outcome = command_line(
        "calibrate", "mine.csv", "--temperature", "20 degC", "--blur", "0", *options, "--drift",
        "3 Hz", "--fit-range", "5 Hz..2 kHz",
    )  # fmt: skip
    assert outcome.code == 0
    assert "not trusted" not in outcome.out
    assert "left out: the drift, 12 cosines slower than 3 Hz, 49 to 52 Hz" in outcome.out


def test_a_free_bead_is_told_without_what_is_left_out():
    D, step = 0.4e-12, 0.01
    size = math.sqrt(2 * D * step)
    x = free(step, 4000, D, 3, exposure=step)[0]
    x += 3 * size * np.sin(2 * np.pi * 17.3 * step * np.arange(4000))
    recording = Recording(step * np.arange(4000), x[:, None], ("x",), name="mine")
    told = tweezer.calibrate(recording, temperature=T, leave_out=["16 Hz..19 Hz"], drift="0.1 Hz")
    low, high = told.free.interval
    assert low < D < high
    assert high < 1.2 * low


@pytest.mark.parametrize("how", [{"drift": "1 Hz"}, {"fit_range": "1 Hz..50 Hz"}])
def test_a_free_bead_without_its_slow_motion_is_no_trapped_one(how):
    """Records that a trap of 0.3 to 1 Hz fits; of 180 such ones none was taken for trapped."""
    D, step = BOLTZMANN * T / DRAG, 0.01
    for seed in (7, 8, 9, 10):
        x = free(step, 5000, D, seed)[0]
        recording = Recording(step * np.arange(5000), x[:, None], ("x",), name="mine")
        found = tweezer.calibrate(recording, temperature=T, drag=DRAG, exposure=0, **how)
        assert all("a free bead" in each.caveat for each in found.axes[0].estimates)
        low, high = found.free.interval
        assert 0.7 * D < low < high < 1.4 * D


def test_a_trap_faster_than_the_drift_stays_a_trap():
    """A corner frequency of 3 Hz, a drift slower than 1 Hz."""
    step, k = 0.01, 6 * math.pi * DRAG
    x = trapped(step, 5000, k, DRAG, None, T, 5)[0]
    recording = Recording(step * np.arange(5000), x[:, None], ("x",), name="mine")
    found = tweezer.calibrate(recording, temperature=T, drag=DRAG, exposure=0, drift="1 Hz")
    assert found.free is None
    assert abs(found.axes[0]["power spectrum"].stiffness - k) < 0.3 * k


@pytest.mark.parametrize(
    ("how", "complaint"),
    [({"leave_out": ["50 Hz"]}, 'leave_out = .50 Hz.: must have the form "49 Hz..51 Hz"'),
     ({"leave_out": [(60.0, 40.0)]}, "must end above where it begins"),
     ({"drift": "3 s"}, "drift = '3 s': has an unknown unit"),
     ({"drift": -1.0}, "must be a frequency, 0 Hz or more"),
     ({"fit_range": "10 Hz..11 Hz"}, "leaves 1 of 4999 frequencies; must leave 50 or more")],
)  # fmt: skip
def test_bad_ranges_are_refused(clean, how, complaint):
    with pytest.raises(tweezer.ResultError, match=complaint):
        calibrated(clean, **how)
