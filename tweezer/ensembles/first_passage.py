"""First times at which beads leave a sphere, including beads that never do."""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import chdtri, ndtr

from tweezer.scene.arguments import in_si, numbers_in_si
from tweezer.values.arrays import Array
from tweezer.values.errors import ResultError
from tweezer.values.shown import Card, Row, Shown
from tweezer.values.units import QuantitiesLike, QuantityLike


@dataclass(frozen=True, repr=False)
class EscapeTimes(Shown):
    """First times at which beads are outside a radius."""

    times: Array
    """(trajectories,) s, from the first sample to the escape, or else to the end of the record"""
    escaped: NDArray[np.bool_]
    """(trajectories,)"""
    mean: float | None
    """mean escape time for a constant rate of escape, s; None without an escape"""
    interval: tuple[float, float | None]
    """95 % confidence interval of that mean, s; no upper end without an escape"""
    p_value: float | None
    """p-value of a constant rate; None below 5 escapes"""
    survival: tuple[Array, Array, Array, Array]
    """times (s), the fraction still inside after each, and its 95 % confidence limits; NaN where
    they do not exist"""

    def card(self) -> Card:
        """Return the card with the number of escapes, their mean time and the test of the rate."""
        low, high = self.interval
        mean = "not known" if self.mean is None else f"{self.mean:.4g} s"
        told = f"above {low:.3g} s" if high is None else f"{low:.3g} to {high:.3g} s"
        rate = "not known" if self.p_value is None else f"p = {self.p_value:.2g}"
        rows = (
            Row("escaped", f"{int(self.escaped.sum())} of {len(self.times)}"),
            Row("mean time", f"{mean} (95 %: {told})"),
            Row("constant rate", rate),
        )
        return Card("EscapeTimes", "", rows)


def escape_times(
    times: QuantitiesLike,
    positions: QuantitiesLike,
    radius: QuantityLike,
    centre: QuantitiesLike = 0.0,
) -> EscapeTimes:
    """Determine the first times at which trajectories are further than `radius` from `centre`.

    A trajectory that stays inside is censored at its end. An escape is located at the first sample
    outside, so an excursion between two samples is missed.

    Parameters
    ----------
    times : array_like, shape (n,)
        Times of the samples, s.
    positions : array_like, shape (trajectories, n, axes)
        Positions, m. They are NaN after a bead is lost.
    radius : float or str
        Distance from `centre`, m.
    centre : array_like, shape (axes,), optional
        Centre, m. Default: the focus.

    Returns
    -------
    EscapeTimes
        Times, their mean with its confidence interval, a test of the rate, and the survival curve.
        The mean is the maximum-likelihood estimate for a constant rate, the sum of the times over
        the number of escapes. Its interval follows from the chi-square distribution, and is not
        below 95 % for recordings of a fixed length. A score test against Weibull's distribution
        tests whether the rate is constant.

    Raises
    ------
    ResultError
        If a bead starts outside, or for arrays of other shapes.

    References
    ----------
    J. F. Lawless, Statistical Models and Methods for Lifetime Data, 4.1 (interval). E. L. Kaplan
    and P. Meier, J. Am. Stat. Assoc. 53, 457 (1958), for the survival curve, with log-log limits
    (`scipy.stats.ecdf`).

    Examples
    --------
    >>> positions = [[[0.0], [1.0], [3.0]], [[0.0], [0.0], [1.0]]]
    >>> tweezer.escape_times([0, 1, 2], positions, radius=2).escaped.tolist()
    [True, False]
    """
    from scipy.stats import CensoredData, ecdf

    t = numbers_in_si("times", times, "s")
    places = numbers_in_si("positions", positions, "m")
    radius = in_si("radius", radius, "m", error=ResultError)
    if places.ndim != 3 or 0 in places.shape or t.shape != places.shape[1:2]:
        raise ResultError(
            f"positions {places.shape}: must be (trajectories, n, axes), with times {t.shape} (n,)"
        )
    if np.isnan(places[:, 0]).any() or not radius > 0:
        raise ResultError(
            "every trajectory must have a position at the first time, and the radius must be "
            "positive"
        )
    away = np.linalg.norm(places - numbers_in_si("centre", centre, "m"), axis=-1)
    outside = ~(away <= radius)
    if outside[:, 0].any():
        start = int(np.argmax(outside[:, 0]))
        raise ResultError(
            f"trajectory {start} starts outside {radius:g} m, so its escape time is not defined"
        )
    escaped = outside.any(axis=1)
    last = np.where(escaped, outside.argmax(axis=1), t.size - 1)
    durations = t[last] - t[0]
    escapes, total = int(escaped.sum()), float(durations.sum())
    upper = 2 * total / chdtri(2 * escapes, 0.975) if escapes else None
    lower = 2 * total / chdtri(2 * escapes + 2, 0.025)
    data = CensoredData(uncensored=durations[escaped], right=durations[~escaped])
    survival = ecdf(data).sf
    with warnings.catch_warnings(action="ignore", category=RuntimeWarning):  # caused by NaN
        limits = survival.confidence_interval(0.95, method="log-log")
    return EscapeTimes(
        durations,
        escaped,
        total / escapes if escapes else None,
        (lower, upper),
        _constant_rate(durations, escaped) if escapes >= 5 else None,
        (
            survival.quantiles, survival.probabilities,
            limits.low.probabilities, limits.high.probabilities,
        ),
    )  # fmt: skip


def _constant_rate(durations: Array, escaped: NDArray[np.bool_]) -> float:
    """Return the p-value of a constant escape rate: exponential against Weibull, by a score test.

    `durations` (trajectories,) are the times to the escape or the end of the record, s, and
    `escaped` (trajectories,) states whether the bead escaped.
    """
    u = durations * escaped.sum() / durations.sum()
    weighted = u * np.log(u)
    score = escaped.sum() + np.log(u[escaped]).sum() - weighted.sum()
    information = escaped.sum() + (weighted * np.log(u)).sum()
    information -= weighted.sum() ** 2 / escaped.sum()
    return 2 * float(ndtr(-abs(score) / math.sqrt(information)))
