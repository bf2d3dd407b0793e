"""Errors of means of correlated series, against the variance of the mean in closed form."""

import numpy as np
from scipy.signal import lfilter

from tweezer.orientations.means import Parts


def test_covariance_of_neighbouring_blocks_is_in_the_error():
    """Autoregressive series whose 20 blocks are 3 correlation times long.

    The scatter of such blocks alone gives 0.69 of the variance. The mean of 400 estimates, each
    with a relative standard deviation of about 0.5, is known to 0.025.
    """
    series, n, kept = 400, 1200, np.exp(-1 / 20)
    rng = np.random.default_rng(1)
    noise = rng.normal(size=(series, n)) * np.sqrt(1 - kept**2)
    noise[:, 0] = rng.normal(size=series)
    values = lfilter([1], [1, -kept], noise, axis=1)
    lags = np.arange(1, n)
    exact = (1 + 2 * np.sum((1 - lags / n) * kept**lags)) / n
    squares = [Parts.of(each[None, :, None], successive=True).error[0] ** 2 for each in values]
    assert 0.9 < np.mean(squares) / exact < 1.15
    parts = Parts.of(values[..., None], successive=False)
    assert parts.freedom == series - 1
    assert 0.8 < parts.error[0] ** 2 / (exact / series) < 1.2


def test_blocks_are_as_long_as_overlapping_displacements():
    """Means over 1100 overlapping displacements across 200 white steps.

    In 20 blocks of 55 samples a displacement would extend over five blocks, and the mean of the
    estimated variances would be 0.54 of the exact one. With 5 blocks it is 0.79, because their own
    mean is subtracted. Each ratio is known to 0.02.
    """
    series, lag, n = 2000, 200, 1100
    steps = np.random.default_rng(2).normal(size=(series, n + lag - 1))
    ends = np.concatenate([np.zeros((series, 1)), np.cumsum(steps, axis=1)], axis=1)
    displaced = ends[:, lag:] - ends[:, :-lag]
    lags = np.arange(1, lag)
    exact = (lag + 2 * np.sum((1 - lags / n) * (lag - lags))) / n
    squares = [Parts.of(each[None, :, None], successive=True, span=lag).error[0] ** 2
               for each in displaced]  # fmt: skip
    assert 0.7 < np.mean(squares) / exact < 1.1
    assert Parts.of(displaced[:1, :, None], successive=True, span=lag).freedom == 4


def test_error_of_trajectories_of_unequal_length():
    """Totals over numbers: 400 sets of 50 trajectories, each with one value near 10 repeated.

    The variance of a ratio is sum n^2/(sum n)^2 for independent trajectories of variance 1.
    """
    rng = np.random.default_rng(3)
    squares, exact = [], []
    for _ in range(400):
        numbers = rng.integers(1, 10, 50)
        values = np.where(np.arange(9) < numbers[:, None], rng.normal(10, 1, size=(50, 1)), np.nan)
        parts = Parts.of(values[..., None], successive=False)
        assert parts.counts.sum() == numbers.sum()
        squares.append(parts.error[0] ** 2)
        exact.append(np.sum(numbers**2) / numbers.sum() ** 2)
    assert 0.93 < np.mean(squares) / np.mean(exact) < 1.05
