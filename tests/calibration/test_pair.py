"""Calibration of two traps with coupled beads, against exact Ornstein-Uhlenbeck processes."""

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import minimize

import tweezer
from tweezer.values.errors import ResultError

KT = 1.380649e-23 * 295.0
A = 0.5e-6
#: mobilities of two equal spheres at a gap of one radius, along and across, s/kg: published values
UNIT = 1 / (6 * np.pi * 1e-3 * A)
ALONG = UNIT * np.array([[0.96128, 0.47076], [0.47076, 0.96128]])
ACROSS = UNIT * np.array([[0.99824, 0.26857], [0.26857, 0.99824]])
STIFFNESS = np.array([5e-5, 8e-5])
SENSITIVITY = np.array([1e-6, 2.5e-6])
STEP = 5e-5
KNOWN = {
    "distance": "1.5 um", "radius_1": A, "radius_2": A, "viscosity": "1 mPa s",
    "temperature": 295.0,
}  # fmt: skip


def recorded(mobility, samples, step, seed, copies=1):
    """Return positions (copies, samples, 2), m, of the exact process x' = E x + noise."""
    kept = expm(-mobility @ np.diag(STIFFNESS) * step)
    covariance = KT * np.diag(1 / STIFFNESS)
    rng = np.random.default_rng(seed)
    root = np.linalg.cholesky(covariance - kept @ covariance @ kept.T)
    x = rng.normal(size=(samples, copies, 2)) @ root.T
    x[0] = rng.normal(size=(copies, 2)) * np.sqrt(np.diag(covariance))
    for n in range(1, samples):
        x[n] += x[n - 1] @ kept.T
    return x.transpose(1, 0, 2)


@pytest.fixture(scope="module")
def records():
    """Return the calibrations of 100 records in volts."""
    return [
        tweezer.calibrate_pair(x / SENSITIVITY, interval=STEP, unit="V", **KNOWN)
        for x in recorded(ALONG, 3000, STEP, 1, 100)
    ]


def test_intervals_contain_the_true_values(records):
    """The coverage of each of four 95 % intervals is at least 88 of 100.

    A correct one fails with a probability of 0.2 %. The same holds for the limits of means,
    spreads and p-values.
    """
    true = np.concatenate([STIFFNESS, SENSITIVITY])
    values = np.array([[*each.stiffness, *each.sensitivity] for each in records])
    errors = np.array([[*each.stiffness_error, *each.sensitivity_error] for each in records])
    intervals = np.array([
        [*each.stiffness_interval, *each.sensitivity_interval] for each in records
    ])  # fmt: skip
    covered = ((intervals[..., 0] < true) & (true < intervals[..., 1])).sum(axis=0)
    assert (covered >= 88).all()
    deviations = (values - true) / errors
    assert (np.abs(deviations.mean(axis=0)) < 0.35).all()
    assert (np.abs(deviations.std(axis=0) - 1) < 0.24).all()
    p_values = np.array([each.p_value for each in records])
    assert (p_values < 0.05).sum() <= 13
    assert 30 <= (p_values < 0.5).sum() <= 70
    # errors of the stiffnesses are correlated with those of the sensitivities, as the matrix states
    found = np.corrcoef(np.log(values).T)
    np.testing.assert_allclose(found, records[0].correlation, atol=0.35)


def test_ignored_coupling_biases_the_stiffness_as_predicted(records):
    """The bias minimises the divergence of the spectrum of one bead from that of two."""
    frequencies = np.arange(1, 1500) / (3000 * STEP)
    turns = np.exp(-2j * np.pi * frequencies * STEP)
    kept = expm(-ALONG @ np.diag(STIFFNESS) * STEP)
    covariance = KT * np.diag(1 / STIFFNESS)
    noise = covariance - kept @ covariance @ kept.T
    passed = np.linalg.inv(np.eye(2) - turns[:, None, None] * kept)
    spectra = (2 * STEP * passed @ noise @ passed.conj().transpose(0, 2, 1)).real

    def predicted(k):
        def divergence(logs):
            decay = np.exp(-STIFFNESS[k] * np.exp(logs[0]) * UNIT * STEP)
            power = KT / STIFFNESS[k] * np.exp(logs[1]) * (1 - decay**2)
            alone = 2 * STEP * power / np.abs(1 - turns * decay) ** 2
            return (np.log(alone / spectra[:, k, k]) + spectra[:, k, k] / alone).sum()

        found = minimize(divergence, [0.0, 0.0], method="Nelder-Mead", options={"xatol": 1e-6})
        return np.exp(found.x[0]) - 1

    bias = np.array([each.uncoupled_stiffness / STIFFNESS - 1 for each in records])
    expected = np.array([predicted(0), predicted(1)])
    assert (expected < -0.03).all()
    assert (np.abs(bias.mean(axis=0) - expected) < 4 * bias.std(axis=0) / 10).all()
    # the difference of both fits has a smaller spread
    shift = np.array([each.uncoupled_bias for each in records])
    assert (np.abs(shift.mean(axis=0) - expected) < 4 * shift.std(axis=0) / 10 + 2e-3).all()


def test_positions_in_metres_across_the_line_with_exposure():
    """Exposed samples are means over the last 8 of 10 intermediate positions."""
    fine = recorded(ACROSS, 60_000, STEP / 10, 1)[0]
    x = fine.reshape(-1, 10, 2)[:, 2:].mean(axis=1)
    found = tweezer.calibrate_pair(
        x, interval=STEP, direction="across", exposure=0.8 * STEP, **KNOWN
    )
    assert found.sensitivity is None
    np.testing.assert_allclose(found.mobility, ACROSS, rtol=1e-4)
    assert (np.abs(found.stiffness - STIFFNESS) < 3.5 * found.stiffness_error).all()
    assert (found.stiffness_error < 0.04 * STIFFNESS).all()
    assert found.p_value > 1e-3
    assert tweezer.calibrate_pair(x, interval=STEP, direction="across", **KNOWN).findings


def test_fit_range_omits_drift():
    x = recorded(ALONG, 20_000, STEP, 3)[0]
    drift = 30e-9 * np.sin(np.linspace(0, 9, len(x)))[:, None]
    refuted = tweezer.calibrate_pair(x + drift, interval=STEP, **KNOWN)
    assert [each.name for each in refuted.findings] == ["spectra"]
    assert "check distance" in str(refuted)
    found = tweezer.calibrate_pair(x + drift, interval=STEP, fit_range="20 Hz..5 kHz", **KNOWN)
    assert not found.findings
    assert found.highest_frequency <= 5e3
    assert (np.abs(found.stiffness - STIFFNESS) < 3.5 * found.stiffness_error).all()


@pytest.mark.parametrize("change", [{"distance": "3 um"}, {"second": -1.0}])
def test_wrong_distance_or_sign_of_a_detector_is_found(change):
    x = recorded(ALONG, 20_000, STEP, 4)[0] * [1.0, change.pop("second", 1.0)]
    found = tweezer.calibrate_pair(x, interval=STEP, **KNOWN | change)
    assert found.p_value < 1e-6
    assert found.findings


def test_simulated_run_recovers_the_stiffness_of_each_trap():
    scene = tweezer.load_scene("two-beads").replace(
        simulation={"duration": "0.2 s", "samples": 4001}
    )
    run = tweezer.simulate(scene, seed=3)
    found = tweezer.calibrate_pair(
        run.position.sel(axis="x").values, interval="50 us", distance="3 um", radius_1=A,
        radius_2=A, viscosity=scene.medium.viscosity, temperature=scene.medium.temperature,
    )  # fmt: skip
    mean = run.position.mean("time").values
    true = [-tweezer.optical_jacobian(scene.alone(k + 1), mean[k])[0, 0] for k in (0, 1)]
    assert (np.abs(found.stiffness - true) < 3.5 * found.stiffness_error).all()
    assert (found.stiffness_error < 0.04 * found.stiffness).all()
    assert not found.findings


NOISE = np.random.default_rng(5).normal(size=(2000, 2)) * 1e-8


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"positions": NOISE[:, 0]}, r"positions: has the shape \(2000,\)"),
        ({"positions": NOISE[:50]}, "100 samples or more"),
        ({"positions": np.where(NOISE > 3e-8, np.nan, NOISE)}, "not finite"),
        ({"positions": NOISE * [1, 0]}, "does not move"),
        ({"viscosity": 0}, "viscosity = 0"),
        ({"distance": "0.9 um"}, "the beads overlap; must exceed the sum of the radii, 1e-06 m"),
        ({"unit": "mV"}, "unit = 'mV': choose from m, V"),
        ({"direction": "x"}, "choose from along, across"),
        ({"exposure": "1 s"}, "exposure = '1 s'"),
        ({"fit_range": (100.0, 101.0)}, "fit_range: leaves"),
        ({"positions": np.diff(NOISE, axis=0), "unit": "V"}, "positions: do not determine the"),
        ({"distance": "1.05 um"}, "distance: thermal motion"),
        (
            {"positions": np.cumsum(NOISE, axis=0), "distance": "30 um"},
            "relaxation times; must last 30 or more",
        ),
    ],
)
def test_refused(change, message):
    given = {"positions": NOISE, "interval": STEP} | KNOWN | change
    with pytest.raises(ResultError, match=message):
        tweezer.calibrate_pair(**given)
