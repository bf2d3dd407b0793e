"""Times of rows, where a rate is given beside them."""

from __future__ import annotations

import numpy as np

from tweezer.reading.table import Array
from tweezer.values.errors import ResultError

#: Largest deviation of the rate from that of a column of times, over it
_RATE_OFF = 0.05
#: That beyond which it is said
_RATE_SAID = 1e-3


def at_even_times(name: str, times: Array, rate: float) -> tuple[Array, str]:
    """The times of samples at that rate, whose stamps are `times`: whole steps after the first.

    And what is to be said about the rate. Raises `ResultError` where the two do not agree.
    """
    dated = np.isfinite(times)
    steps = np.diff(times[dated]) * rate
    if not len(steps):
        return times, ""
    single = steps[steps < 1.5]  # those over no missing samples
    means = float(np.mean(steps)), float(np.mean(single) if len(single) else np.median(steps))
    usual = min(means, key=lambda mean: abs(mean - 1))
    said = _compared(name, rate / usual, rate, 1 / len(steps), "x=...")
    if (steps < 0.5).any():
        raise ResultError(
            f"{name}: its times are off those of --rate by half a step and more; name the columns "
            'without the time if the rows are at that rate: --columns "x=..."'
        )
    even = times.copy()
    even[dated] = times[dated][0] + np.concatenate([[0.0], np.cumsum(np.rint(steps))]) / rate
    return even, said


def of_frames(name: str, frames: Array, times: Array, rate: float) -> str:
    """What is to be said about frames at that rate, beside which the file has `times`.

    Raises `ResultError` where the two do not agree.
    """
    both = np.isfinite(frames) & np.isfinite(times)
    steps = np.abs(np.diff(times[both]))
    steps = steps[steps > 0]
    if not len(steps):
        return ""
    lasts = float(np.ptp(times[both]))
    finest = float(np.median(steps)) / lasts
    found = float(np.ptp(frames[both])) / lasts
    return _compared(name, found, rate, finest, "frame=...,x=...")


def _compared(name: str, found: float, rate: float, finest: float, way: str) -> str:
    """What is to be said of a rate beside the one `found`, known to `finest` of it.

    way: columns that are read where the times are wrong.
    """
    off = abs(rate / found - 1) if found else np.inf
    if off > _RATE_OFF + finest:
        raise ResultError(
            f"{name}: its times have {found:.6g} Hz, and --rate is {rate:g} Hz; leave out --rate, "
            f'or, if the times are wrong, name the columns without them: --columns "{way}"'
        )
    if off <= max(_RATE_SAID, finest):
        return ""
    return f"its times have {found:.6g} Hz; taken as {rate:.6g} Hz"
