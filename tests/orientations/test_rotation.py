"""Rotation rates, correlations, order and spectra of orientations that are drawn here.

The orientations are products of small rotation vectors, composed by SciPy's `Rotation`, with the
diffusion coefficients D about the body's axes and constant rates. Bounds of five standard errors
with many degrees of freedom give a false alarm in 6e-7 of the comparisons; all seeds are fixed.
"""

import re

import numpy as np
import pytest
import xarray as xr
from scipy.spatial.transform import Rotation
from scipy.stats import binom

import tweezer

#: five standard errors
FAR = 5.0
# Diffusion coefficients about three unequal axes and of a body of revolution, 1/s
FAVRO = (0.5, 0.8, 2.0)
ROD = (0.5, 0.5, 0.8)


def dataset(rotations, step):
    """Trajectories from a list over time, whose entries contain the rotations of all of them."""
    e = np.stack([each.as_quat(scalar_first=True) for each in rotations], axis=1)
    dimensions = "trajectory", "time", "euler_parameter"
    return xr.Dataset({"orientation": (dimensions, e)}, {"time": np.arange(e.shape[1]) * step})


def diffusing(n, samples, step, D, *, rate=(0, 0, 0), rate_body=(0, 0, 0), seed, turns=4):
    """Trajectories of n bodies that turn at rates in both frames, rad/s, `turns` times a sample."""
    rng = np.random.default_rng(seed)
    h = step / turns
    of_laboratory = Rotation.from_rotvec(np.array(rate) * h)
    spread, drift = np.sqrt(2 * np.array(D) * h), np.array(rate_body) * h
    found = [Rotation.random(n, random_state=seed)]
    for _ in range(samples - 1):
        rotation = found[-1]
        for _ in range(turns):
            turn = Rotation.from_rotvec(rng.normal(size=(n, 3)) * spread + drift)
            rotation = of_laboratory * rotation * turn
        found.append(rotation)
    return dataset(found, step)


def spinning(rate, samples, step, first=None):
    """Run of one body that turns uniformly at `rate` (3,), rad/s, in the laboratory."""
    turns = Rotation.from_rotvec(np.outer(np.arange(samples) * step, rate))
    e = (turns * (first or Rotation.identity())).as_quat(scalar_first=True)
    time = {"time": np.arange(samples) * step}
    return xr.Dataset({"orientation": (("time", "euler_parameter"), e)}, time)


@pytest.fixture(scope="module")
def free():
    """400 bodies with three unequal diffusion coefficients."""
    return diffusing(400, 301, 0.01, FAVRO, seed=1)


def within(found, name, expected, bias=0.0):
    """Return whether a quantity is within five standard errors, and a relative bias, of a value."""
    return np.abs(found[name] - expected) <= FAR * found[f"{name}_error"] + bias * np.abs(expected)


def test_uniform_rotation_is_exact():
    """Rates, displacements beyond many full turns, and correlations of an oblique axis."""
    rate = np.array([3.0, -20.0, 11.0])
    first = Rotation.from_rotvec([0.4, 1.1, -0.3])
    found = tweezer.rotation(spinning(rate, 2000, 0.01, first), axis=[2, 0, 0])
    np.testing.assert_allclose(found.rate, rate, rtol=1e-12)
    np.testing.assert_allclose(found.rate_body, first.inv().apply(rate), rtol=1e-11)
    np.testing.assert_allclose(found.rate_interval.sel(limit="low"), rate, rtol=1e-11)
    t = found.lag.values
    assert found.msad.max() > 100 * np.pi**2
    np.testing.assert_allclose(found.msad, np.outer(rate**2, t**2), rtol=1e-10)
    speed = np.linalg.norm(rate)
    along = rate @ first.apply([1, 0, 0]) / speed
    cosine = along**2 + (1 - along**2) * np.cos(speed * t)
    np.testing.assert_allclose(found.p1, cosine, atol=1e-12)
    np.testing.assert_allclose(found.p2, 1.5 * cosine**2 - 0.5, atol=1e-12)


def test_sign_of_euler_parameters_does_not_matter():
    run = spinning([1.0, 2.0, 3.0], 100, 0.01)
    signs = np.where(np.random.default_rng(1).random(100) < 0.5, -1.0, 1.0)
    flipped = run.assign(orientation=run.orientation * xr.DataArray(signs, dims="time"))
    xr.testing.assert_allclose(tweezer.rotation(run), tweezer.rotation(flipped), rtol=1e-12)


@pytest.mark.parametrize("frame", ["rate", "rate_body"])
def test_rate_of_a_diffusing_body_is_unbiased(frame):
    """The turns between samples are 0.5 rad and diffuse by 0.3 rad about each axis.

    Their mean is 1.7 % too small. The corrected rate is required to 0.3 %, a fifth of that.
    """
    bodies = diffusing(1000, 401, 0.05, (1, 1, 1), **{frame: (0, 0, 10.0)}, seed=2)
    found = tweezer.rotation(bodies)
    assert (found[f"{frame}_error"] < 0.013).all()
    assert within(found, frame, np.array([0, 0, 10.0]), bias=0.003).all()


def test_free_body_decays_at_favros_rates(free):
    """<P1> of each axis, <P2> with two rates, and displacements about the body's axes."""
    D = np.array(FAVRO)
    mean, product = D.mean(), (D[0] * D[1] + D[1] * D[2] + D[2] * D[0]) / 3
    fast, slow = 6 * mean + 6 * np.sqrt(mean**2 - product) * np.array([1, -1])
    for i in range(3):
        found = tweezer.rotation(free, axis=np.eye(3)[i], lags=[0.05, 0.1, 0.2, 0.4, 0.8])
        across, t = D.sum() - D[i], found.lag
        assert within(found, "p1", np.exp(-across * t)).all()
        part = (3 * across - slow) / (fast - slow)
        p2 = part * np.exp(-fast * t) + (1 - part) * np.exp(-slow * t)
        assert within(found, "p2", p2).all()
        assert within(found, "p1_decay_time", 1 / across, bias=2e-3)
        assert within(found, "order_tensor", 0.0).all()
    # the variance of a turn is 2 D h (1 - D h/6) for a sphere, here with D h up to 0.02
    expected = 2 * found.lag * xr.DataArray(D, {"body_axis": found.body_axis})
    assert within(found, "msad_body", expected, bias=0.01).all()


def test_body_of_revolution_decays_as_two_exponentials():
    bodies = diffusing(400, 201, 0.02, (0.5, 0.5, 3.0), seed=3)
    found = tweezer.rotation(bodies)
    assert within(found, "p1", np.exp(-2 * 0.5 * found.lag)).all()
    assert within(found, "p2", np.exp(-6 * 0.5 * found.lag)).all()
    assert within(found, "p1_decay_time", 1.0, bias=2e-3) or np.isnan(found.p1_decay_time)
    assert within(found, "p2_decay_time", 1 / 3, bias=2e-3)


def test_confidence_intervals_of_runs_contain_the_true_values():
    """300 runs of 60 correlation times; 95 % intervals, from t with 19 degrees of freedom.

    They contain the true rates in the body's frame and, because the spinning axis diffuses, the
    rate 0 in the laboratory. At a coverage of 92 to 98 %, a false alarm has a probability of 1e-4
    at each end for each of the 24 numbers.
    """
    n, lag, spin = 300, 0.3, np.array([0.0, 0.0, 2.0])
    bodies = diffusing(n, 601, 0.1, ROD, rate_body=spin, seed=4, turns=2)
    expected = {
        "rate": np.zeros(3),
        "rate_body": spin,
        "order_tensor": np.zeros((3, 3)),
        "msad_body": 2 * np.array(ROD) * lag + (spin * lag) ** 2,
        "p1": np.exp(-2 * ROD[0] * lag),
        "p2": np.exp(-6 * ROD[0] * lag),
    }
    hits = dict.fromkeys(expected, 0)
    for k in range(n):
        found = tweezer.rotation(bodies.isel(trajectory=k), lags=[lag], segments=1).squeeze("lag")
        for name, true in expected.items():
            half = 2.093 * found[f"{name}_error"].values
            if f"{name}_interval" in found:
                half = np.diff(found[f"{name}_interval"].values)[..., 0] / 2
            hits[name] = hits[name] + (np.abs(found[name].values - true) <= half)
    low, high = binom.ppf(1e-4, n, 0.92), binom.ppf(1 - 1e-4, n, 0.98)
    for name, counts in hits.items():
        assert (counts >= low).all(), (name, counts / n)
        assert (counts <= high).all(), (name, counts / n)


def test_confidence_interval_of_an_ensemble_contains_the_true_rate():
    """200 ensembles of 5 bodies: t of 4 degrees of freedom, exact for Gaussian turns."""
    bodies = diffusing(1000, 41, 0.05, (0.1, 0.1, 0.1), rate_body=(0, 0, 1.0), seed=5)
    hits = 0
    for k in range(200):
        found = tweezer.rotation(bodies.isel(trajectory=slice(5 * k, 5 * k + 5)), lags=[0.1])
        low, high = found.rate_body_interval[2].values
        hits += low <= 1.0 <= high
    assert binom.ppf(1e-4, 200, 0.95) <= hits <= binom.ppf(1 - 1e-4, 200, 0.95)


def test_order_of_a_precessing_axis_is_exact():
    """An axis on a cone of half angle 0.5 about a direction, over whole turns."""
    about = np.array([0.6, 0.0, 0.8])
    first = Rotation.align_vectors([about], [[0, 0, 1]])[0] * Rotation.from_euler("y", 0.5)
    found = tweezer.rotation(spinning(2 * np.pi * about, 400, 0.01, first))
    s = 1.5 * np.cos(0.5) ** 2 - 0.5
    assert float(found.order_parameter) == pytest.approx(s, abs=1e-12)
    np.testing.assert_allclose(found.director, about, atol=1e-12)
    np.testing.assert_allclose(
        found.order_tensor, s * (1.5 * np.outer(about, about) - 0.5 * np.eye(3)), atol=1e-12
    )


def test_order_of_drawn_directions_is_that_of_their_distribution():
    """Independent axes with n.z = c of the density 4 c^3 on (0, 1), so that <P2> = 1/2."""
    rng = np.random.default_rng(6)
    angle = np.arccos(rng.random(4000) ** 0.25)
    tilt = Rotation.from_euler("ZY", np.stack([2 * np.pi * rng.random(4000), angle], axis=-1))
    run = (
        dataset([tilt], 0.1)
        .isel(time=0)
        .rename(trajectory="time")
        .assign_coords(time=0.1 * np.arange(4000))
    )
    found = tweezer.rotation(run, rates=False)
    assert set(found) & {"rate", "msad"} == set()
    expected = np.diag([-0.25, -0.25, 0.5])
    assert within(found, "order_tensor", expected).all()
    assert within(found, "order_parameter", 0.5, bias=1e-3)
    # Var P2 = (9/4) Var c^2 with <c^4> = 1/2, <c^2> = 2/3
    error = np.sqrt(2.25 * (1 / 2 - 4 / 9) / 4000)
    assert 0.4 * error < float(found.order_parameter_error) < 1.8 * error
    with pytest.raises(
        tweezer.ResultError, match=r"store samples more often, or omit the rates by rates=False"
    ):
        tweezer.rotation(run)


def test_rotation_is_a_line_of_the_spectrum():
    """An axis that turns 7.25 times a second about z: half a square radian in x and in y."""
    found = tweezer.rotation(spinning([0, 0, 2 * np.pi * 7.25], 4000, 0.01), axis=[0, 3, 0])
    width = float(found.frequency[0])
    for axis in "xy":
        line = found.psd.sel(axis=axis)
        assert abs(found.frequency.values[line.values.argmax()] - 7.25) <= width / 2
        assert float(line.sum()) * width == pytest.approx(0.5, rel=0.02)
    assert float(found.psd.sel(axis="z").max()) < 1e-20


def test_spectrum_of_free_diffusion_is_that_of_its_correlation(free):
    """Components of n decay as exp(-a t)/3: the aliased spectrum of a sampled exponential."""
    found = tweezer.rotation(free, segments=1)
    kept = np.exp(-(FAVRO[0] + FAVRO[1]) * 0.01)
    angle = 2 * np.pi * found.frequency * 0.01
    density = 2 * 0.01 / 3 * (1 - kept**2) / (1 - 2 * kept * np.cos(angle) + kept**2)
    middle = slice(5, None)  # below, the window and the mean of the record matter
    ratio = (found.psd / density)[:, middle]
    assert (np.abs(ratio - 1) <= FAR * (found.psd_error / density)[:, middle] + 0.03).all()
    assert abs(float(ratio.mean()) - 1) < 0.02


def test_samples_after_a_loss_are_excluded(free):
    """Trajectories of unequal length: means over all samples that there are."""
    some = free.isel(trajectory=slice(40)).copy(deep=True)
    last = np.random.default_rng(7).integers(50, 301, 40)
    last[0] = 0
    for k, end in enumerate(last):
        some.orientation[k, end:] = np.nan
    found = tweezer.rotation(some, lags=[0.1])
    total, number = np.zeros(3), 0
    cosines = []
    for e, end in zip(some.orientation.values, last, strict=True):
        if not end:
            continue
        each = Rotation.from_quat(e[:end], scalar_first=True)
        total += (each[1:] * each[:-1].inv()).as_rotvec().sum(axis=0)
        number += end - 1
        n = each.apply([0, 0, 1])
        cosines.append(np.sum(n[10:] * n[:-10], axis=1))
    np.testing.assert_allclose(found.rate, total / number / 0.01, rtol=0.02)  # D h/3 is below 1 %
    assert float(found.p1[0]) == pytest.approx(np.concatenate(cosines).mean(), rel=1e-12)
    for name in ("rate_error", "msad_error", "order_tensor_error", "p2_error", "psd_error"):
        assert (found[name] > 0).all()
    lost = some.isel(trajectory=slice(1))
    with pytest.raises(tweezer.ResultError, match="all values are NaN"):
        tweezer.rotation(lost)


def test_trajectories_are_processed_in_groups(free, monkeypatch):
    whole = tweezer.rotation(free)
    monkeypatch.setattr("tweezer.orientations.samples._READ", 7000)
    xr.testing.assert_allclose(tweezer.rotation(free), whole, rtol=1e-9, atol=1e-12)


def test_single_trajectory_is_analysed_as_a_run(free):
    """Its errors follow from blocks of time."""
    found = tweezer.rotation(free.isel(trajectory=slice(1)))
    assert found.identical(tweezer.rotation(free.isel(trajectory=0)))
    assert (found.rate_error > 0).all()


def test_start_is_skipped_and_a_last_sample_of_an_event_is_excluded():
    run = spinning([0, 0, 5.0], 101, 0.01)
    run.orientation[:30] = run.orientation[-1] = [1, 0, 0, 0]
    late = run.assign_coords(time=np.append(run.time[:-1], 0.9951))
    found = tweezer.rotation(late, skip="300 ms")
    np.testing.assert_allclose(found.rate, [0, 0, 5], atol=1e-12)


def test_two_samples_have_a_rate_without_an_error():
    found = tweezer.rotation(spinning([0, 0, 5.0], 2, 0.01))
    assert float(found.rate[2]) == pytest.approx(5.0)
    assert np.isnan(found.rate_error).all()
    assert np.isnan(found.rate_interval).all()


def test_decay_time_between_two_lags():
    """An exponential between 1 and a positive value, and a line to a negative one."""
    run = spinning([0, 0, 5.0], 200, 0.01)
    found = tweezer.rotation(run, axis=[1, 0, 0], lags=[0.28])
    p1, p2 = np.cos(1.4), 1.5 * np.cos(1.4) ** 2 - 0.5
    assert float(found.p1_decay_time) == pytest.approx(0.28 / -np.log(p1), rel=1e-9)
    assert float(found.p2_decay_time) == pytest.approx(0.28 * (1 - np.exp(-1)) / (1 - p2), rel=1e-9)
    found = tweezer.rotation(run, axis=[1, 0, 0])
    assert float(found.p1_decay_time) == pytest.approx(np.arccos(np.exp(-1)) / 5, rel=0.02)


def test_spun_body_without_decay_has_no_decay_time():
    found = tweezer.rotation(spinning([0, 0, 5.0], 200, 0.01))
    assert np.isnan(found.p1_decay_time)
    assert np.isnan(found.p2_decay_time_error)


RUN = spinning([0, 0, 5.0], 100, 0.01)


@pytest.mark.parametrize(
    ("run", "options", "said"),
    [
        (RUN.drop_vars("orientation"), {}, "run: contains no orientation over time; must be"),
        ({"orientation": [1, 0, 0, 0]}, {}, "run: contains no orientation over time; must be"),
        (RUN.orientation, {}, "run: contains no orientation over time; must be"),
        (RUN.isel(time=0), {}, "orientation is over (euler_parameter); must be over"),
        (RUN.expand_dims(trajectory=0), {}, "run: contains no trajectory"),
        (RUN.isel(time=[3]), {}, "run: contains fewer than 2 samples"),
        (RUN.isel(time=[]), {}, "run: contains fewer than 2 samples"),
        (RUN, {"skip": 0.99}, "contains fewer than 2 samples after skip = 0.99 s"),
        (RUN.isel(time=[0, 1, 3, 4]), {}, "samples must be evenly spaced"),
        (RUN.isel(time=slice(None, None, -1)), {}, "time: must increase from sample to sample"),
        (RUN.assign_coords(time=np.arange(100) * np.timedelta64(10, "ms")), {}, "numbers in s"),
        (RUN.assign_coords(time=RUN.time.assign_attrs(units="m")), {}, "time: has the wrong unit"),
        (RUN.isel(euler_parameter=[0, 1, 2]), {}, "must have 4 Euler parameters"),
        (RUN.assign(orientation=1.1 * RUN.orientation), {}, "must have the length 1"),
        (RUN.assign(orientation=np.nan * RUN.orientation), {}, "all values are NaN"),
        (spinning([0, 0, 250.0], 100, 0.01), {}, "turns by 2.5 rad between two samples"),
        (RUN, {"axis": [0, 0, 0]}, "axis = [0, 0, 0]: must be 3 numbers that are not all 0"),
        (RUN, {"axis": [1, 0]}, "must be 3 numbers"),
        (RUN, {"axis": [np.nan, 0, 1]}, "must be 3 numbers"),
        (RUN, {"axis": "P3"}, "axis: "),
        (RUN, {"lags": [0.02, 1.0]}, "lags: must be from the sampling interval, 0.01 s, to 0.99 s"),
        (RUN, {"lags": [0.001]}, "lags: must be from the sampling interval"),
        (RUN, {"lags": []}, "lags: must be from the sampling interval"),
        (RUN, {"lags": [np.nan]}, "lags: must be from the sampling interval"),
        (RUN, {"segments": 0}, "segments = 0: must be a whole number of at least 1"),
        (RUN, {"segments": 2.5}, "segments = 2.5: must be a whole number of at least 1"),
        (RUN, {"skip": -1}, "skip = -1"),
    ],
)  # fmt: skip
def test_bad_input_is_refused_in_one_line(run, options, said):
    with pytest.raises(tweezer.ResultError, match=re.escape(said)) as refused:
        tweezer.rotation(run, **options)
    assert "\n" not in str(refused.value)


def test_axis_is_scaled_to_length_1():
    xr.testing.assert_identical(tweezer.rotation(RUN, [0, 2, 0]), tweezer.rotation(RUN, [0, 1, 0]))


def test_time_is_converted_from_the_unit_of_the_dataset():
    in_ms = RUN.assign_coords(time=(1e3 * RUN.time).assign_attrs(units="ms"))
    found = tweezer.rotation(in_ms)
    assert found.rate.values == pytest.approx([0, 0, 5.0], abs=1e-12)
    assert found.lag.values == pytest.approx(tweezer.rotation(RUN).lag.values)
