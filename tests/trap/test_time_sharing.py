"""Traps that share a beam in time, beside the trap of the averaged force."""

import math

import numpy as np
import pytest

import tweezer
from tweezer.trap.time_sharing import cycle
from tweezer.values.errors import SceneError, TweezerError

ONE = tweezer.load_scene("silica-1um")
#: relaxation rate, 1/s, period, s, distance of the places from the middle, m, and mobility, s/kg
RATE, PERIOD, SITE, MOBILITY = 9e3, 1e-4, 8e-8, 1e8
DIFFUSION = 4e-13


def shared(distance, period=1e-4, **keys):
    """Return a scene with a beam that jumps between -distance and distance along x, m."""
    places = [[-distance, 0, 0], [distance, 0, 0]]
    steps = {"kind": "steps", "times": [0, period / 2], "period": period, "positions": places}
    return ONE.replace(beam={"motion": steps}, **keys)


def harmonic(places, stiffness, steps=24):
    """Return the cycle of a spring with a centre and a stiffness at each time of a period.

    places(t): centre along x, m. stiffness(t): relative stiffness. Both are functions of t/T.
    """
    k = RATE / MOBILITY
    times = (np.arange(steps) + 0.5) / steps * PERIOD

    def pull(at, t):
        centre = np.zeros_like(at)
        centre[:, 0] = [places(each / PERIOD) for each in t]
        factor = k * np.array([stiffness(each / PERIOD) for each in t])
        return -factor[:, None] * (at - centre), -factor[:, None, None] * np.eye(3)

    mobility, diffusion = np.full(3, MOBILITY), np.full(3, DIFFUSION)
    lengths = np.full(steps, PERIOD / steps)
    return cycle(pull, mobility, diffusion, times, lengths, np.full((steps, 3), 1e-8))


def test_ripple_between_two_places_is_the_closed_form():
    """x = d (1 - exp(k T/4 - k t)/cosh(k T/4)) for half a period, then the opposite.

    The mean of x^2 is d^2 (1 - tanh(u)/u) with u = k T/4.
    """
    found = harmonic(lambda t: SITE if t < 0.5 else -SITE, lambda t: 1.0, steps=96)
    u = RATE * PERIOD / 4
    assert found.of_path[0, 0] == pytest.approx(SITE**2 * (1 - math.tanh(u) / u), rel=1e-6, abs=0)
    np.testing.assert_allclose(found.mean, 0, atol=1e-18)
    thermal = found.covariance - found.of_path
    np.testing.assert_allclose(thermal, DIFFUSION / RATE * np.eye(3), atol=1e-25)


def test_variance_in_light_that_blinks_is_the_closed_form():
    """Variance v' = -2 K v + 2 D at twice the mean rate K for half a period, then free."""
    found = harmonic(lambda t: 0.0, lambda t: 2.0 if t < 0.5 else 0.0, steps=96)
    half, K = PERIOD / 2, 2 * RATE
    rest, decay = DIFFUSION / K, math.exp(-2 * K * half)
    low = rest + 2 * DIFFUSION * half * decay / (1 - decay)  # at the end of the light
    high = low + 2 * DIFFUSION * half
    lit = rest + (high - rest) * (1 - decay) / (2 * K * half)
    assert found.covariance[1, 1] == pytest.approx((lit + (low + high) / 2) / 2, rel=1e-6, abs=0)
    assert found.covariance[1, 1] > 1.05 * DIFFUSION / RATE


def test_circle_of_a_focus_turns_the_bead_by_the_closed_form():
    """The bead follows with |x| = R/sqrt(1 + (w/k)^2)."""
    steps, at = 200, 2 * math.pi
    k = RATE / MOBILITY

    def pull(places, t):
        centre = np.zeros_like(places)
        centre[:, 0], centre[:, 1] = SITE * np.cos(at * t / PERIOD), SITE * np.sin(at * t / PERIOD)
        return -k * (places - centre), np.tile(-k * np.eye(3), (len(places), 1, 1))

    times = (np.arange(steps) + 0.5) / steps * PERIOD
    found = cycle(
        pull, np.full(3, MOBILITY), np.full(3, DIFFUSION), times, np.full(steps, PERIOD / steps),
        np.zeros((steps, 3)),
    )  # fmt: skip
    radius2 = SITE**2 / (1 + (at / PERIOD / RATE) ** 2)
    np.testing.assert_allclose(np.diag(found.of_path), [radius2 / 2] * 2 + [0], rtol=1e-3)


def test_averaged_scene_has_the_mean_force():
    scene = shared(1e-7).replace(beam={"modulation": {"kind": "on-off", "frequency": "20 kHz",
                                                      "phase": "90 deg"}})  # fmt: skip
    found = tweezer.time_sharing(scene)
    assert [beam.position for beam in found.averaged.beams] == [(-1e-7, 0, 0), (1e-7, 0, 0)]
    at = np.random.default_rng(3).normal(size=(4, 3)) * 2e-7
    times = (np.arange(400) + 0.5) / 400 * 1e-4
    mean = np.mean([tweezer.optical_force(scene, at, time=t) for t in times], axis=0)
    np.testing.assert_allclose(tweezer.optical_force(found.averaged, at), mean, rtol=1e-9)


def test_variance_of_thermal_motion_exceeds_the_average_as_reported():
    """Two places at 10 kHz; the error of the measured excess is about 2 %, and the bound a factor
    of 1.5, so a false alarm is impossible in practice.
    """
    scene = shared(
        1e-7, optics={"evaluator": "map"}, forces={"brownian": True},
        start={"position": [0, 0, 1e-7]},
    )  # fmt: skip
    found = tweezer.time_sharing(scene)
    assert found.period == pytest.approx(1e-4)
    assert not found.sufficient
    variances = []
    for each in (scene, found.averaged):
        run = tweezer.simulate(
            each.replace(simulation={"duration": "52 ms", "samples": 4001}), seed=2
        )
        variances.append(run["position"].values[200:, 0].var())
    measured = variances[0] - variances[1]
    assert measured == pytest.approx(found.excess_variance[0], rel=0.1, abs=0)
    assert variances[1] == pytest.approx(found.variance[0], rel=0.3, abs=0)


def test_excess_falls_with_the_square_of_the_frequency():
    """The memory of the fluid resists fast motion more, so the excess falls somewhat faster."""
    slow, fast = tweezer.time_sharing(shared(3e-8)), tweezer.time_sharing(shared(3e-8, 1e-5))
    assert slow.relative_excess[0] / fast.relative_excess[0] == pytest.approx(130, rel=0.3)
    enough = tweezer.time_sharing(shared(3e-8, 1 / fast.sufficient_frequency))
    assert enough.relative_excess[0] == pytest.approx(0.01, rel=0.2)
    assert "about" in repr(slow)


BLINKING = {"kind": "on-off", "frequency": "10 kHz"}


@pytest.mark.parametrize(
    ("scene", "error", "message"),
    [
        (ONE, SceneError, "beam: is at rest; time sharing requires"),
        (ONE.replace(beam={"modulation": {"kind": "ramp", "factor": 2, "end": "1 ms"}}), SceneError,
         "beam.modulation: must repeat for time sharing; use sine, circle or on-off, or set"),
        (shared(1e-7, 1e-2), SceneError, "repeats at 100 Hz, below the corner frequency of"),
        (ONE.replace(beam={"modulation": BLINKING, "motion": {
            "kind": "circle", "radius": 1e-8, "frequency": "10.0001 kHz"}}), SceneError,
         "beam: periods of 0.099999, 0.1 ms: must have a common multiple"),
        (ONE.replace(beam={"modulation": BLINKING, "noise": {"power": 1e-12}},
                     forces={"brownian": True}), SceneError,
         "beam.noise: cannot be combined with time sharing"),
        (shared(1e-7, bead={"refractive_index": 1.2}), TweezerError,
         "the averaged trap does not hold the bead: no stable equilibrium"),
    ],
)  # fmt: skip
def test_traps_without_a_fast_average_are_refused_in_one_line(scene, error, message):
    with pytest.raises(error, match=message) as refused:
        tweezer.time_sharing(scene)
    assert len(str(refused.value).splitlines()) == 1
