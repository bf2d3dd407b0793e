"""Times of the rows of a recording for which the user also gives a sampling rate."""

from __future__ import annotations

import numpy as np

from tweezer.reading.table import Array
from tweezer.values.errors import ResultError

#: Largest relative deviation of the given rate from the rate of the column of times
_RATE_OFF = 0.05
#: Relative deviation above which a note reports it
_RATE_SAID = 1e-3


def at_even_times(name: str, times: Array, rate: float) -> tuple[Array, str]:
    """Return even times for samples that have time stamps and a given rate, and a note.

    Each time is a whole number of sampling intervals after the first stamp, the nearest to its
    stamp. The note is "" if the stamps have the same rate. Raises `ResultError` if stamps and rate
    disagree.

    name: of the recording, for messages. times: (n,) stamps, s; NaN where missing. rate: Hz.
    """
    dated = np.isfinite(times)
    steps = np.diff(times[dated]) * rate  # in sampling intervals, so 1 if stamps and rate agree
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
    """Compare numbers of frames at a given rate with the times beside them, and return a note.

    The note is "" if they agree. Raises `ResultError` if they disagree.

    name: of the recording, for messages. frames: (n,) numbers of frames. times: (n,) s. rate: of
    the frames, Hz.
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
    """Compare a given rate, Hz, with the rate `found` from times, and return a note.

    The note is "" if the two agree within `finest`, the relative resolution of `found`. Raises
    `ResultError` if they differ by more than 5 % beyond it.

    way: text for --columns in that message, to read the file without its times.
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
