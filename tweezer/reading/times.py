"""Times of rows in a recording whose sampling rate the user also gives."""

from __future__ import annotations

import numpy as np

from tweezer.reading.table import Array
from tweezer.values.errors import ResultError

#: Largest relative deviation of the given rate from the rate in the column of times
_RATE_OFF = 0.05
#: Relative deviation above which a note reports the difference
_RATE_SAID = 1e-3


def at_even_times(name: str, times: Array, rate: float) -> tuple[Array, str]:
    """Return even times for samples that have time stamps and a given rate, and a note.

    Each time is the multiple of the sampling interval after the first stamp that is nearest to its
    stamp. The note is "" if the stamps have the same rate. Raises `ResultError` if stamps and rate
    disagree.

    `name` is the name of the recording, for messages. `times` (n,) are the stamps, s, NaN where
    missing, and `rate` is in Hz.
    """
    dated = np.isfinite(times)
    steps = np.diff(times[dated]) * rate  # in sampling intervals, 1 if stamps and rate agree
    if not len(steps):
        return times, ""
    single = steps[steps < 1.5]  # steps without missing samples
    means = float(np.mean(steps)), float(np.mean(single) if len(single) else np.median(steps))
    usual = min(means, key=lambda mean: abs(mean - 1))
    said = _compared(name, rate / usual, rate, 1 / len(steps), "x=...")
    if (steps < 0.5).any():
        raise ResultError(
            f"{name}: its times deviate from those of --rate by half a step or more; name the "
            'columns without the time if the rate is correct: --columns "x=..."'
        )
    even = times.copy()
    even[dated] = times[dated][0] + np.concatenate([[0.0], np.cumsum(np.rint(steps))]) / rate
    return even, said


def of_frames(name: str, frames: Array, times: Array, rate: float) -> str:
    """Compare frame numbers at a given rate with their times, and return a note.

    The note is "" if they agree.

    Parameters
    ----------
    name : str
        Name of the recording, for messages.
    frames : ndarray, shape (n,)
        Frame numbers.
    times : ndarray, shape (n,)
        Times of the frames, s.
    rate : float
        Frame rate, Hz.

    Raises
    ------
    ResultError
        If they disagree.
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
    `ResultError` if they differ by more than 5 % beyond it. `way` is the text for --columns in this
    message that reads the file without its times.
    """
    off = abs(rate / found - 1) if found else np.inf
    if off > _RATE_OFF + finest:
        raise ResultError(
            f"{name}: its times have {found:.6g} Hz, but --rate is {rate:g} Hz; omit --rate, "
            f'or, if the times are wrong, name the columns without them: --columns "{way}"'
        )
    if off <= max(_RATE_SAID, finest):
        return ""
    return f"its times have {found:.6g} Hz; {rate:.6g} Hz is used"
