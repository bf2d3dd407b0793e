"""Diffusion of free beads against dense Gaussians and exact records, and what follows from it."""

import dataclasses
import math

import numpy as np
import pytest

import tweezer
from tests.reference.free_bead import free
from tests.reference.trapped_bead import BOLTZMANN, trapped
from tweezer.calibration.free import Given, free_bead
from tweezer.calibration.steps import Steps
from tweezer.reading import Recording

T, RADIUS, VISCOSITY = 293.15, 0.5e-6, 1.002e-3
DRAG = 6 * math.pi * VISCOSITY * RADIUS
D, STEP = BOLTZMANN * T / DRAG, 0.05
#: Of a step.
SIZE = math.sqrt(2 * D * STEP)
KNOWN = Given(T, RADIUS, VISCOSITY, DRAG)


def seen(seed, samples=800, count=2, **how):
    return free(STEP, samples, D, seed, count=count, **how).T


def found(positions, given=KNOWN):
    axes = ("x", "y", "z")[: positions.shape[1]]
    return free_bead("mine", axes, [positions], STEP, given)


def test_the_likelihood_is_that_of_the_dense_gaussian():
    """With the drift integrated over, as the steps about an arbitrary one are without it."""
    rng = np.random.default_rng(2)
    pieces = [rng.standard_normal(n) for n in (17, 9)]
    fit, n = Steps(pieces, STEP), 26
    every, ones = np.concatenate(pieces), np.ones(n)

    def dense(A, B):
        s = (B - A) / 4
        covariance = np.zeros((n, n))
        for start, length in ((0, 17), (17, 9)):
            block = slice(start, start + length)
            beside = np.eye(length, k=1) + np.eye(length, k=-1)
            covariance[block, block] = (A + 2 * s) * np.eye(length) - s * beside
        inverse = np.linalg.inv(covariance * fit.square)
        drift = (ones @ inverse @ every) / (ones @ inverse @ ones)
        off = every - drift
        value = np.linalg.slogdet(covariance)[1] + off @ inverse @ off
        return value + math.log(ones @ inverse @ ones), drift

    places = [(0.8, 0.3), (1.5, 2.0), (0.2, 4.0)]
    ours = [fit.misfit(math.log(A), math.log(B)) for A, B in places]
    theirs, drifts = zip(*(dense(A, B) for A, B in places), strict=True)
    np.testing.assert_allclose(np.diff(ours), np.diff(theirs), rtol=1e-9)
    own = [fit.drifts(math.log(A), math.log(B))[0][0] for A, B in places]
    np.testing.assert_allclose(own, np.array(drifts) / STEP, rtol=1e-9)


def test_diffusion_is_as_uncertain_as_it_says():
    """30 records of two axes, blurred, with noise and drift: false alarms below 1e-3 each."""
    how = {"exposure": STEP, "noise": 0.5 * SIZE, "drift": 2e-7}
    every = free(STEP, 400, D, 57, count=60, **how).reshape(30, 2, 400)
    results = [found(each.T) for each in every]
    z = np.array([math.log(each.diffusion / D) * D / each.uncertainty for each in results])
    assert abs(z.mean()) < 3.9 / math.sqrt(30)
    assert 10 < (z**2).sum() < 63  # chi-square
    inside = [each.interval[0] < D < each.interval[1] for each in results]
    assert sum(inside) >= 23
    alone = np.array(
        [(axis.by_covariance - D) / axis.by_covariance_uncertainty
         for each in results for axis in each.axes]
    )  # fmt: skip
    assert abs(alone.mean()) < 0.5
    assert 29 < (alone**2).sum() < 104
    drift = np.array(
        [(axis.drift - 2e-7) / axis.drift_uncertainty for each in results for axis in each.axes]
    )
    assert 29 < (drift**2).sum() < 104
    assert sum(bool(each.findings) for each in results) <= 3


def test_noise_is_told_if_the_exposure_is():
    record = seen(3, 4000, exposure=STEP, noise=0.7 * SIZE)
    assert all(axis.noise is None and axis.noise_limit is None for axis in found(record).axes)
    for axis in found(record, KNOWN._replace(exposure=STEP)).axes:
        assert axis.noise == pytest.approx(0.7 * SIZE, rel=0.1)
        assert axis.noise < axis.noise_limit < 0.8 * SIZE
    clear = found(seen(4, exposure=STEP), KNOWN._replace(exposure=STEP)).axes[0]
    assert clear.noise is None
    assert clear.noise_limit < 0.4 * SIZE


def test_known_noise_and_exposure_narrow_the_interval():
    record = seen(5, exposure=STEP / 2, noise=SIZE)
    fitted = found(record)
    known = found(record, KNOWN._replace(exposure=STEP / 2, noise=dict.fromkeys("xy", SIZE)))
    assert known.uncertainty < 0.9 * fitted.uncertainty
    assert known.interval[0] < D < known.interval[1]
    whole = seen(17, 4000, exposure=STEP, noise=SIZE / 4)
    told = found(whole, KNOWN._replace(exposure=STEP, noise=dict.fromkeys("xy", SIZE / 4)))
    assert not told.findings
    assert told.interval[0] < D < told.interval[1]
    wrong = found(record, KNOWN._replace(exposure=STEP / 2, noise=dict.fromkeys("xy", 2 * SIZE)))
    assert {each.name for each in wrong.findings} == {"noise"}
    assert wrong.interval == pytest.approx(fitted.interval)


def test_what_is_not_given_follows_by_einstein():
    record = seen(6, 3000)
    whole = found(record)
    low, high = whole.interval
    assert whole.expected == pytest.approx(D, rel=1e-9)
    assert whole.inferred.name == "Boltzmann"
    assert whole.inferred.interval == pytest.approx((DRAG * low / T, DRAG * high / T))
    assert not whole.findings
    for given, name, true in (
        (Given(T, radius=RADIUS), "viscosity", VISCOSITY),
        (Given(T, viscosity=VISCOSITY), "radius", RADIUS),
        (Given(T), "drag", DRAG),
    ):
        told = found(record, given).inferred
        assert (told.name, told.value) == (name, pytest.approx(true * D / whole.diffusion))
        assert told.interval == pytest.approx((true * D / high, true * D / low))
    assert found(record, Given()).inferred is None
    twice = found(record, KNOWN._replace(drag=2 * DRAG))
    assert [each.name for each in twice.findings] == ["Einstein"]
    assert f"{twice.diffusion / D * 2:.3g} times Einstein's" in twice.findings[0].text


def test_mobilities_beside_a_wall_are_counted():
    record = seen(7)
    record[:, 1] *= math.sqrt(0.5)
    assert [each.name for each in found(record).findings] == ["Einstein", "axes"][::-1]
    beside = found(record, KNOWN._replace(mobilities={"x": 1.0, "y": 0.5}))
    assert not beside.findings
    assert beside.interval[0] < D < beside.interval[1]


def test_jumps_are_left_out_and_tails_widen():
    record = seen(8, exposure=STEP)
    plain = found(record)
    jumped = record.copy()
    jumped[300:, 0] += 12 * SIZE
    told = found(jumped)
    assert told.axes[0].jumps == (300,)
    assert told.remarks == ("omitted: jumps before 15 s (x)",)
    assert told.diffusion == pytest.approx(plain.diffusion, rel=0.01)
    rng = np.random.default_rng(9)
    tailed = np.cumsum(SIZE * rng.standard_t(5, (2000, 1)), axis=0)
    told = found(tailed)
    assert "large steps are frequent" in told.remarks[-1]
    assert told.uncertainty > 1.05 * math.sqrt(6 / 2000) * told.diffusion  # Gaussian, without noise


def test_what_is_no_free_bead_is_said():
    held = trapped(STEP, 2000, DRAG / (10 * STEP), DRAG, None, T, 10)
    assert "confined" in {each.name for each in found(held.T).findings}
    wandering = seen(11, 2000, count=1)
    wandering[:, 0] += 150 * SIZE * np.cos(np.arange(2000) / 300)
    assert "drift" in {each.name for each in found(wandering).findings}
    changed = seen(12, 2000, count=1)
    changed[1000:] = changed[1000] + 1.5 * (changed[1000:] - changed[1000])
    assert "halves" in {each.name for each in found(changed).findings}
    rough = seen(13, 2002, count=1, exposure=STEP)
    smoothed = (rough[2:] + rough[1:-1] + rough[:-2]) / 3
    assert "smoothed" in found(smoothed).remarks[-1]
    with pytest.raises(tweezer.ResultError, match="all displacements are equal"):
        found(np.linspace(0, 1e-6, 300)[:, None])


def test_a_record_in_coarse_digits_still_tells():
    """Most of its steps are nothing."""
    coarse = 2 * SIZE * np.round(seen(14, 4000) / (2 * SIZE))
    assert (np.diff(coarse[:, 0]) == 0).mean() > 0.5
    told = found(coarse)
    assert told.interval[0] < D < told.interval[1]
    assert told.interval[1] < 1.3 * told.interval[0]


def test_the_calibration_tells_a_free_bead_from_a_trapped_one():
    """Blurred, noisy and drifting; what calibrate is given it hands on."""
    times = STEP * np.arange(800)
    record = seen(15, exposure=STEP, noise=2 * SIZE, drift=3e-7)
    known = {"temperature": T, "radius": RADIUS, "viscosity": VISCOSITY, "exposure": STEP}
    calibration = tweezer.calibrate(Recording(times, record, ("x", "y"), name="mine"), **known)
    assert calibration.drag == pytest.approx(DRAG, rel=1e-12)
    expected = found(record, KNOWN._replace(exposure=STEP))
    assert dataclasses.asdict(calibration.free) == dataclasses.asdict(expected)
    for axis in ("x", "y"):
        assert f"  stiffness, {axis}                  no trap is detected\n" in repr(calibration)
    held = trapped(STEP, 800, DRAG / (5 * STEP), DRAG, None, T, 16)
    both = np.column_stack([record[:, 0], held[0]])
    mixed = tweezer.calibrate(Recording(times, both, ("x", "y"), name="mine"), temperature=T)
    assert [each.axis for each in mixed.free.axes] == ["x"]
    drowned = seen(1, 300, count=1, noise=5 * SIZE)
    told = tweezer.calibrate(Recording(times[:300], drowned, ("x",), name="mine"), temperature=T)
    assert "free" not in {each.name for each in told.axes[0].findings}
    assert told.free is None or told.free.interval[0] > 0
