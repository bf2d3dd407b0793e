"""Correlations and spectra of several beads against closed forms and against SciPy."""

import math

import numpy as np
import pytest
from scipy.signal import csd

import tweezer
from tests.beads.test_motion import beads
from tweezer.beads.correlations import linear_motion
from tweezer.values.errors import ResultError

K = 5e-6
L = 3e-6


def springs(about=2e-6):
    """Return springs that hold two beads from six sides each: a trap without light."""
    return [
        {"model": "spring", "between": [str(k)], "point": [place + x, y, z], "stiffness": K}
        for k, place in ((1, -L / 2), (2, L / 2))
        for x, y, z in np.vstack([about * np.eye(3), -about * np.eye(3)]).tolist()
    ]


def test_linear_motion_of_equal_traps():
    """The covariance is kT/K, and the mobility is exact."""
    scene = beads(
        (-L / 2, 0, 0), (L / 2, 0, 0), forces={"brownian": True},
        tether=[*springs(), {"model": "spring", "between": ["1", "2"], "stiffness": K}],
    )  # fmt: skip
    rates, covariance, mobility = linear_motion(scene)
    kT = 1.380649e-23 * scene.medium.temperature
    stiffness = np.linalg.solve(mobility, rates)
    np.testing.assert_allclose(
        covariance, kT * np.linalg.inv(stiffness), rtol=0, atol=1e-6 * kT / K
    )
    assert covariance[0, 3] > 0.05 * covariance[0, 0]  # the spring between them
    unit = 1 / (6 * math.pi * scene.medium.viscosity * 0.5e-6)
    rest = L - 2 * 0.5e-6
    assert unit * float(tweezer.pair_mobilities(1.0, 1.0, rest / 0.5e-6).x12) == pytest.approx(
        mobility[0, 3], rel=0.2
    )


def test_run_agrees_with_its_closed_form():
    """The correlation dips; it and the mean spectrum are within 5 standard errors."""
    scene = beads(
        (-L / 2, 0, 0), (L / 2, 0, 0), forces={"brownian": True}, tether=springs(),
        simulation={"duration": "6 s", "samples": 30_001},
    )  # fmt: skip
    run = tweezer.simulate(scene, seed=2)
    found = tweezer.cross_correlation(run, [0, 2e-4, 4e-4, 8e-4, 1.2e-3, 1.6e-3, 2.4e-3, 3.2e-3])
    apart = np.abs(found.correlation - found.expected) / found.correlation_error
    assert float(apart.max()) < 5
    cross = found.expected.sel(axis="x", bead="1", other="2")
    assert abs(float(cross[0])) < 1e-3 * float(found.expected.max())
    assert float(cross.min()) < -0.05 * float(found.expected.max())
    spectrum = tweezer.cross_spectrum(run)
    low = spectrum.where(spectrum.frequency < 100, drop=True)
    for first, second in (("1", "1"), ("1", "2")):
        each = low.sel(bead=first, other=second).mean("frequency")
        error = np.sqrt((low.sel(bead=first, other=second).spectrum_error**2).mean("frequency")
                        / low.sizes["frequency"])  # fmt: skip
        assert float((np.abs(each.spectrum - each.expected) / error).max()) < 5
    # the integral of the spectrum is the variance
    total = (spectrum.expected.sum("frequency") * spectrum.frequency.values[0]).sel(axis="x")
    variance = found.expected.isel(lag=0).sel(axis="x")
    assert float(total[0, 0] / variance[0, 0]) == pytest.approx(1, abs=0.05)


def test_arrays_by_scipy():
    """Spectra are Welch's without overlap and window, and correlations plain means."""
    rng = np.random.default_rng(1)
    x = rng.normal(size=(4000, 2)) @ np.array([[1.0, 0.5], [0.0, 1.0]])
    found = tweezer.cross_spectrum(x, interval="1 ms")
    frequencies, expected = csd(
        x[:, 1] - x[:, 1].mean(), x[:, 0] - x[:, 0].mean(), 1000.0, "boxcar", 200, 0,
        detrend=False,
    )  # fmt: skip
    assert "expected" not in found
    np.testing.assert_allclose(found.frequency, frequencies[1:100])
    np.testing.assert_allclose(
        found.spectrum.sel(axis="x", bead="1", other="2"), expected.real[1:100], atol=1e-15
    )
    correlation = tweezer.cross_correlation(x, [0.0, "2 ms"], interval="1 ms").correlation
    y = x - x.mean(axis=0)
    blocks = y.reshape(20, 200, 2)
    later = (blocks[:, 2:, 0] * blocks[:, :-2, 1]).mean()
    assert float(correlation.sel(bead="1", other="2", axis="x")[1]) == pytest.approx(later)
    assert float(correlation.sel(bead="1", other="1", axis="x")[0]) == pytest.approx(y[:, 0].var())


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ((np.zeros((500, 2)), None, None), "interval: missing"),
        ((np.zeros((500, 1)), None, 1e-3), "must be"),
        ((np.zeros((100, 2)), None, 1e-3), "at least 200 samples"),
        ((np.zeros((500, 2)), [-1.0], 1e-3), "lags: allowed"),
        ((np.zeros((500, 2)), [1.0], 1e-3), "lags: allowed"),
    ],
)
def test_refused(given, message):
    x, lags, interval = given
    with pytest.raises(ResultError, match=message):
        tweezer.cross_correlation(x, lags, interval=interval)


def test_runs_of_one_bead_are_refused():
    run = tweezer.simulate("silica-1um", "0.1 ms")
    with pytest.raises(ResultError, match="must be a run of several beads"):
        tweezer.cross_correlation(run)
