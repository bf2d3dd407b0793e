"""Test whether a recording begins before the bead has settled in its trap."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tweezer.calibration.spectra import statistical_inefficiency
from tweezer.values.arrays import Array

#: Standard deviation of a Gaussian over its median absolute deviation
_DEVIATION_PER_MEDIAN = 1.4826
#: Largest distance of a settled bead from the median, in standard deviations
FAR = 6.0
#: Distance from the median within which the bead has arrived, in standard deviations, and the
#: number of independent samples after which its approach is no longer visible
_NEAR, _AFTER = 3.0, 3.0


class Unsettled(NamedTuple):
    """Beginning of a recording, before the bead has settled in its trap."""

    off: float
    """distance of the first sample from the median, in standard deviations"""
    time: float
    """time to omit from the first sample on, s; rounded up to two digits"""


def spread(positions: Array) -> tuple[Array, float]:
    """Return the distances (n,) of positions (n,), m, from their median, and a standard deviation.

    The standard deviation follows from the median distance, so outliers do not affect it.
    """
    off = np.abs(positions - np.median(positions))
    return off, _DEVIATION_PER_MEDIAN * float(np.median(off))


def unsettled(positions: Array, step: float) -> Unsettled | None:
    """Return the beginning of positions (n,), m, before the bead settles; `step` in s.

    Returns None if the first position is within six standard deviations of the median.
    """
    off, deviation = spread(positions)
    if not off[0] > FAR * deviation:
        return None
    arrived = int(np.argmax(off < _NEAR * deviation))
    after = _AFTER * statistical_inefficiency(positions[arrived:])
    return Unsettled(float(off[0] / deviation), _rounded_up((arrived + after) * step))


def _rounded_up(time: float) -> float:
    """Return a time rounded up to two digits."""
    unit = 10.0 ** (np.floor(np.log10(time)) - 1)
    return float(np.ceil(time / unit) * unit)
