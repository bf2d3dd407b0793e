"""Findings about the digits and the order of samples, which involve no physics of a bead.

If samples are repeated, copied or out of order, the spectrum has no physical explanation. These
findings then replace findings that would name a physical cause.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from tweezer.calibration.findings import IMPROBABLE, Finding
from tweezer.reading import copied, step_of, unmeasured
from tweezer.values.arrays import Array
from tweezer.values.printed import printed, signal_unit

#: Names of physical findings that can also be caused by samples that were not measured
_CAUSED = {"noise", "blur", "exposure", "spectrum", "drag", "halves", "line", "drift"}
#: Largest fraction of the variance of displacements that rounding may cause without a finding
_ROUNDED = 0.05
#: Smallest standard deviation of displacements at which rounding errors are independent (with a
#: correlation of 1 %), in steps of the digits
_INDEPENDENT = 0.5
#: Smallest ratio of the known noise to the rounding noise at which the former includes the latter
_INCLUDED = 0.8
#: Largest number of beads whose rows may alternate
_MOST_IN_TURN = 8
#: Number of samples that are searched for alternating rows
_ENOUGH = 20_000
#: Largest ratio of the mean squared displacement over n rows to that over one row, if the rows of n
#: beads alternate
_IN_TURN = 0.5
#: Largest correlation between displacements of different beads; for one bead that oscillates with a
#: period of that many rows it is a third or more
_APART = 0.2
#: Number of lags at which independent samples have no autocorrelation
_LAGS = 16
#: Largest autocorrelation at these lags that counts as zero, in standard deviations
_NONE = 4.0


def of_samples(positions: Array) -> tuple[Finding, ...]:
    """Return findings for samples of positions, (n, axes), that were not measured.

    They are `lost`, `repeated`, `interpolated` and `copied`, in this order.
    """
    found = []
    missing = unmeasured(positions)
    n = len(positions)
    way = "record each frame once, with its time"
    if missing.marks.any():
        text = f"{missing.said[0].partition(':')[0]}: omit lost frames"
        found.append(Finding("lost", text))
    if missing.repeated.any():
        share = f"{100 * missing.repeated.mean():.2g} % of its {n:,} samples"
        text = f"{share} repeat the previous one to the last digit: {way}"
        found.append(Finding("repeated", text))
    if missing.between.any():
        share = f"{100 * missing.between.mean():.2g} % of its {n:,} samples"
        text = f"{share} are exactly between their neighbours, as if interpolated: {way}"
        found.append(Finding("interpolated", text))
    if said := copied(positions[~(missing.marks | missing.copies)]):
        found.append(Finding("copied", f"{said}: read the samples once"))
    return tuple(found)


def of_axis(
    positions: Array, noise: float, unit: str, error: float, *, dated: bool
) -> Finding | None:
    """Return a finding against the digits or the order of positions, (n,), along one axis.

    Parameters
    ----------
    positions : ndarray, shape (n,)
        m or V.
    noise : float
        Known standard deviation of the noise, m or V; 0 if not known.
    unit : str
        "m" or "V".
    error : float
        Relative uncertainty of the variance that is harmless.
    dated : bool
        Whether the order of the samples is known.
    """
    rounded = _rounded(positions, noise, unit, error)
    if dated:
        return rounded
    return _in_turn(positions) or rounded or _shuffled(positions)


def first(digits: Sequence[Finding], physical: Sequence[Finding]) -> list[Finding]:
    """Return the findings about `digits`, then the `physical` ones that these do not explain."""
    if not digits:
        return list(physical)
    caused = _CAUSED | ({"stuck"} if "rounded" in [each.name for each in digits] else set())
    return [*digits, *(each for each in physical if each.name not in caused)]


def _rounded(positions: Array, noise: float, unit: str, error: float) -> Finding | None:
    """Return a finding if rounding of `positions` (n,), m or V, adds to their motion.

    `noise` is the known noise, m or V, `unit` "m" or "V", and `error` the relative uncertainty of
    the variance that is harmless. If the bead moves by half a digit or more per step, rounding is
    white noise, which may be part of the known noise.
    """
    step = step_of(positions)
    variance, moved = float(np.var(positions)), float(np.var(np.diff(positions)))
    rounding = step**2 / 12
    if rounding < error * variance and 2 * rounding < _ROUNDED * moved:
        return None
    of = signal_unit(unit)
    text = f"its positions are whole multiples of {printed(step, of, 3)}"
    if math.sqrt(moved) < _INDEPENDENT * step:
        return Finding("rounded", f"{text}, more than it moves between samples: record more digits")
    if noise >= _INCLUDED * math.sqrt(rounding):
        return None
    white = printed(math.sqrt(rounding), of, 3)
    return Finding("rounded", f'{text}: their rounding is white noise; give --noise "{white}"')


def _in_turn(positions: Array) -> Finding | None:
    """Return a finding if `positions` (n,) look like alternating rows of several beads.

    Each sample then continues the sample of the same bead some rows before, and displacements of
    different beads are independent.
    """
    positions = positions[:_ENOUGH]
    for beads in range(2, _MOST_IN_TURN + 1):
        whole = len(positions) // beads * beads
        table = positions[:whole].reshape(-1, beads)
        series = (table - table.mean(axis=0)).ravel()
        near, far = np.diff(series), series[beads:] - series[:-beads]
        continues = (far @ far) / len(far) < _IN_TURN * (near @ near) / len(near)
        if continues and _autocorrelation(far, beads - 1).max() < _APART:
            text = (
                f"each sample continues the one {beads} before; the rows may be of {beads} beads "
                "in turn."
            )
            return Finding("turns", f"{text} Keep the rows of one bead")
    return None


def _shuffled(positions: Array) -> Finding | None:
    """Return a finding if samples are independent and not Gaussian, as if out of order.

    Independent samples of a trapped bead would be Gaussian. `positions` has the shape (n,).
    """
    away = positions - positions.mean()
    if _autocorrelation(away, _LAGS).max() > _NONE / math.sqrt(len(away)):
        return None
    from scipy.stats import kstest

    away = away / away.std()
    if _probable(away) and kstest(away, "norm").pvalue >= IMPROBABLE:
        return None
    text = "its samples are independent and not Gaussian; the rows may not be in time order."
    return Finding("order", f"{text} Read the column of times or frames too")


def _autocorrelation(series: Array, lags: int) -> Array:
    """Return the absolute autocorrelation of a `series` (n,) of mean 0 at the lags 1 to `lags`."""
    products = [series[lag:] @ series[:-lag] for lag in range(1, lags + 1)]
    return np.abs(products) / (series @ series)


def _probable(scaled: Array) -> bool:
    """Return whether the kurtosis of independent samples (n,) agrees with that of a Gaussian."""
    from scipy.stats import kurtosistest

    return bool(kurtosistest(scaled).pvalue >= IMPROBABLE)
