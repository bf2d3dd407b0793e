"""Signals of a detector in runs and ensembles: motion, shot noise, bandwidth."""

import math

import numpy as np
import pytest
import xarray as xr

import tweezer
from tweezer import SceneError
from tweezer.dynamics.detector import _LowPass

QUANTUM = 1.054571817e-34 * 2 * math.pi * 299792458.0 / 1.064e-6
BASE = tweezer.load_scene("silica-1um").replace(
    forces={"brownian": True}, simulation={"duration": "2 ms", "samples": 2001},
    start={"position": [0, 0, 5e-8]},
)  # fmt: skip
SEEN = BASE.replace(detector={"numerical_aperture": 0.9, "efficiency": 0.5})


@pytest.fixture(scope="module")
def run():
    return tweezer.simulate(SEEN, seed=1)


def test_detector_leaves_the_motion_as_it_is(run):
    alone = tweezer.simulate(BASE, seed=1)
    np.testing.assert_array_equal(run["position"], alone["position"])
    assert "signal" not in alone


def test_signals_of_run_are_those_at_its_positions(run):
    silent = tweezer.simulate(SEEN.replace(detector={"noise": False}), seed=1)
    expected = tweezer.detect(SEEN, silent["position"][::100])["signal"]
    np.testing.assert_allclose(silent["signal"][::100], expected, rtol=0, atol=1e-11)
    assert run["signal"].dims == ("time", "channel")


def test_shot_noise_of_run_is_that_of_its_photons(run):
    """Variance hbar omega S/tau, S the detected light. Within 4.5 standard deviations."""
    silent = tweezer.simulate(SEEN.replace(detector={"noise": False}), seed=1)
    noise = (run["signal"] - silent["signal"]).values
    interval = float(run["time"][1] - run["time"][0])
    light = silent["signal"].sel(channel="z").values[:, None]
    drawn = noise / np.sqrt(QUANTUM * light / interval)
    assert abs((drawn**2).mean() - 1) < 4.5 * math.sqrt(2 / drawn.size)
    correlations = np.corrcoef(drawn.T) - np.eye(3)
    assert np.abs(correlations).max() < 4.5 / math.sqrt(len(drawn))
    assert abs((drawn[1:] * drawn[:-1]).mean()) < 4.5 / math.sqrt(drawn.size)


def test_bandwidth_filters_signals_like_a_resistor_and_a_capacitor():
    """A ramp follows by the time 1/(2 pi f), and a slow sine loses amplitude and phase."""
    low_pass, times = _LowPass(1e3, 1e-5), np.arange(4001) * 1e-5
    delay = 1 / (2 * math.pi * 1e3)
    ramp = low_pass.of_signal(np.tile(times[None, :, None], (1, 1, 3)))[0, :, 1]
    np.testing.assert_allclose(ramp, times - delay * -np.expm1(-times / delay), atol=1e-15)
    turn = 2 * math.pi * 300
    sine = low_pass.of_signal(np.sin(turn * times)[None, :, None])[0, :, 0]
    answer = np.imag(np.exp(1j * turn * times) / (1 + 1j * turn * delay))
    np.testing.assert_allclose(
        sine[2000:], answer[2000:], atol=2e-4
    )  # between samples it is linear


def test_bandwidth_filters_shot_noise():
    """Variance 2 hbar omega S (pi/2) f, and exp(-2 pi f tau) from one sample to the next."""
    given = {"numerical_aperture": 0.9, "bandwidth": "50 kHz"}
    noisy, silent = (
        tweezer.simulate(BASE.replace(detector={**given, "noise": noise}), seed=2)
        for noise in (True, False)
    )
    width = math.pi / 2 * 50e3
    light = silent["signal"].sel(channel="z").values[:, None]
    drawn = (noisy["signal"] - silent["signal"]).values / np.sqrt(2 * QUANTUM * light * width)
    kept = math.exp(-2 * math.pi * 50e3 * 1e-6)
    samples = drawn.size * (1 - kept**2) / (1 + kept**2)
    assert abs((drawn**2).mean() - 1) < 4.5 * math.sqrt(2 / samples)
    assert abs((drawn[1:] * drawn[:-1]).mean() - kept) < 4.5 * math.sqrt(2 / samples)


def test_signals_of_ensemble_are_those_of_its_runs(run, tmp_path):
    for out in (None, tmp_path / "seen.zarr"):
        found = tweezer.ensemble(SEEN, 3, seed=1, out=out)
        assert found["signal"].dims == ("trajectory", "time", "channel")
        np.testing.assert_allclose(found["signal"][0], run["signal"], rtol=0, atol=1e-11)
        assert not np.allclose(found["signal"][1], found["signal"][0], rtol=0, atol=1e-9)


def test_signals_of_continued_run_are_those_of_the_whole(run):
    half = tweezer.simulate(SEEN, "1 ms", seed=1)
    rest = tweezer.simulate(SEEN, "1 ms", continue_from=half)
    both = xr.concat([half["signal"], rest["signal"][1:]], "time")
    whole = tweezer.simulate(SEEN.replace(simulation={"samples": 4001}), "2 ms", seed=1)
    np.testing.assert_allclose(both, whole["signal"], rtol=0, atol=1e-11)


def test_signals_end_with_a_lost_bead():
    """A bead that goes beyond the loss distance is lost."""
    lost = SEEN.replace(
        simulation={"loss_distance": 1e-6}, start={"position": [9.5e-7, 0, 0]},
        beam={"power_through_pupil": 1e-9},
    )  # fmt: skip
    found = tweezer.ensemble(lost, 4, seed=3)
    gone = np.isnan(found["position"][..., 0].values)
    assert gone.any()
    np.testing.assert_array_equal(
        np.isnan(found["signal"].values), np.repeat(gone[..., None], 3, 2)
    )


def test_run_without_thermal_motion_has_shot_noise_of_a_seed():
    still = SEEN.replace(forces={"brownian": False})
    one, same, other = (tweezer.simulate(still, "0.1 ms", seed=seed) for seed in (1, 1, 2))
    np.testing.assert_array_equal(one["signal"], same["signal"])
    assert (one["signal"] != other["signal"]).all()
    with pytest.raises(SceneError, match="camera or detector with noise"):
        tweezer.simulate(still.replace(detector={"noise": False}), "0.1 ms", seed=1)


def test_bandwidth_in_ensembles_and_continued_runs_is_refused():
    filtered = SEEN.replace(detector={"bandwidth": "10 kHz"})
    with pytest.raises(SceneError, match=r"detector.bandwidth = 10000: applies to single runs"):
        tweezer.ensemble(filtered, 2)
    begun = tweezer.simulate(filtered, "10 us")
    with pytest.raises(SceneError, match=r"detector.bandwidth: .* remove it from both scenes"):
        tweezer.simulate(filtered, "10 us", continue_from=begun)
