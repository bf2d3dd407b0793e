"""The emitted step of drag and noise against closed forms with 60 digits, at any step."""

import mpmath as mp
import numpy as np
import pytest

from tweezer.dynamics.brownian.propagator import inertial_block, overdamped_block

#: largest relative error, of numbers made by up to 40 doublings
ROUNDING = 3e-15
TAU = 1e-7


def exact(h, kappa):
    """d, j, l, c_xx, c_vv from the two rates; kappa tau = 1/4 and kappa = 0 by a nearby one."""
    with mp.workdps(60):
        tau = mp.mpf(TAU)
        h, kappa = mp.mpf(h), mp.mpf(kappa) or mp.mpf("1e-30") / tau
        root = mp.sqrt(mp.mpc(1 - 4 * kappa * tau)) or mp.mpf("1e-14")
        slow, fast = (1 - root) / (2 * tau), (1 + root) / (2 * tau)

        def gone(rate):
            return -mp.expm1(-rate * h) / rate

        apart = fast - slow
        d = (mp.exp(-slow * h) - mp.exp(-fast * h)) / apart
        j = (gone(slow) - gone(fast)) / apart
        l = ((h - gone(slow)) / slow - (h - gone(fast)) / fast) / apart
        by = 2 * (slow + fast) / apart**2
        xx = by * (gone(2 * slow) - 2 * gone(slow + fast) + gone(2 * fast))
        vv = by * (
            slow**2 * gone(2 * slow)
            - 2 * slow * fast * gone(slow + fast)
            + fast**2 * gone(2 * fast)
        )
        return [mp.re(value) for value in (d, j, l, xx, vv)]


@pytest.mark.parametrize("damping", [0.0, 1e-8, 1e-3, 0.2, 0.24, 0.25, 0.26, 1.0, 30.0, -1e-3])
def test_block_keeps_its_digits_at_any_step(damping):
    """kappa tau from free to far more spring than drag, and on a hill; ten decades of h/tau."""
    kappa = damping / TAU
    for h in TAU * np.logspace(-4, 6, 41):
        if abs(kappa) * h > 20:
            continue
        block, true = inertial_block(h, TAU, kappa), exact(h, kappa)
        # d passes through zero, or dies away: what counts is the displacement it stands for
        scale = mp.sqrt(true[3] * TAU / 2 / h) if damping > 0.1 else true[0]
        assert abs(block[0] - true[0]) < 1e-13 * abs(scale) + 1e-15 * TAU
        for value, exactly in zip(block[1:], true[1:], strict=True):
            # on a hill the result is e^(|kappa| h), and that many times as sensitive to kappa
            assert abs(value / exactly - 1) < ROUNDING * max(1.0, -2 * kappa * h)


def test_block_without_inertia_keeps_its_digits():
    for g in (*np.logspace(-9, 1.3, 30), *-np.logspace(-9, 1, 10)):
        d, j = overdamped_block(2.0, g / 2)
        with mp.workdps(60):
            kappa = mp.mpf(g) / 2
            true = -mp.expm1(-2 * kappa) / kappa
            assert abs(d / true - 1) < ROUNDING
            assert abs(j / ((2 - true) / kappa) - 1) < ROUNDING
    assert tuple(overdamped_block(2.0, 0.0)) == (2.0, 2.0)
