"""Gaps in recordings: filled, or avoided by using the longest stretch without a gap."""

from __future__ import annotations

import numpy as np

from tweezer.reading.filling import LONGEST, filled
from tweezer.reading.table import Array
from tweezer.values.errors import ResultError, TooFewError

#: Largest fraction of samples that may be filled
_FILLED = 0.05
#: Relative deviation of a time step from the median step above which it counts as different
_UNEVEN = 0.1
#: Fraction of different steps above which times are uneven rather than interrupted by gaps
_OFTEN = 0.2
#: Deviation of a longer step from a whole number of steps above which samples are not filled
_OFF = 0.2


def without_gaps(
    name: str, times: Array, columns: Array, least: int, straight: int = 0
) -> tuple[Array, Array, str]:
    """Return the times (n,) and columns (n, k) of a recording without gaps, and a note.

    A row is missing if its time or one of its columns is NaN, or if the times skip it. Missing rows
    at the beginning and the end are omitted. Gaps of up to 10 samples are filled (`filled`) if all
    gaps together are at most 5 % of the record. Otherwise the longest stretch without a gap is
    returned. Uneven times are returned unchanged, for the caller to refuse.

    Parameters
    ----------
    name : str
        Name of the recording in messages.
    times : ndarray, shape (n,)
        s.
    columns : ndarray, shape (n, k)
        Positions, then the columns of a stage.
    least : int
        Smallest number of samples that the result may have.
    straight : int
        Number of columns at the end, for the stage, that are interpolated linearly.

    Raises
    ------
    TooFewError
        If the longest stretch has fewer than `least` samples.
    """
    dated = ~np.isnan(times)
    there = dated & ~np.isnan(columns).any(axis=1)
    if not len(there):
        return times, columns, ""
    if not there.any():
        raise ResultError(f"{name}: has no row in which all columns have numbers")
    rows = np.flatnonzero(there)
    inside = slice(rows[0], rows[-1] + 1)
    outside = len(times) - (inside.stop - inside.start)
    times, columns, there, dated = times[inside], columns[inside], there[inside], dated[inside]
    times, columns, there = times[dated], columns[dated], there[dated]
    notes = [f"{_rows(outside)} without numbers at its ends omitted"] if outside else []
    steps = np.diff(times)
    usual = float(np.median(steps)) if len(steps) else 0.0
    off = np.abs(steps - usual)
    uneven = (off > _UNEVEN * usual).sum() > _OFTEN * len(off)
    if not (steps > 0).all() or not np.isfinite(times).all() or uneven:
        return times[there], columns[there], "; ".join(notes)  # the caller refuses uneven times
    leaps = np.maximum(np.rint(steps / usual), 1.0)  # sampling intervals from each row to the next
    if there.all() and (leaps == 1).all():
        return times, columns, "; ".join(notes)
    whole = bool((np.abs(steps / usual - leaps)[leaps > 1] <= _OFF).all())
    numbers = np.concatenate([[0.0], np.cumsum(leaps)])  # position of each row in the even grid
    every = int(numbers[-1]) + 1
    lost = every - int(there.sum())
    said = f"samples missing: {lost:,} of {every:,}"
    longest_gap = int(np.diff(numbers[there]).max()) - 1
    few = every >= least and longest_gap <= LONGEST and lost <= _FILLED * every
    if whole and few:
        notes.append(f"{said}, filled from the samples around them")
        grid, known = np.arange(every), numbers[there]
        there_on_grid = np.isin(grid, known)
        lines = np.stack([np.interp(grid, known, column[there]) for column in columns.T], axis=1)
        for column in lines.T[: lines.shape[1] - straight]:
            column[:] = filled(column, there_on_grid)
        return np.interp(grid, numbers, times), lines, "; ".join(notes)
    first, last = _longest(there, leaps)
    if last - first < least:
        raise TooFewError(
            f"{name}: {said}; the longest stretch without a gap has {last - first} samples, and "
            f"must have {least} or more"
        )
    notes.append(
        f"{said}; the longest stretch without a gap is used: {last - first:,} samples from "
        f"{times[first]:.6g} s onwards"
    )
    return times[first:last], columns[first:last], "; ".join(notes)


def _longest(there: np.ndarray, leaps: Array) -> tuple[int, int]:
    """Return the range [first, end) of the longest stretch of rows without a gap.

    `there` (n,) is False for missing rows. `leaps` (n - 1,) are the sampling intervals from each
    row to the next, 1 if no row is missing between them.
    """
    joined = there[1:] & there[:-1] & (leaps == 1)
    ends = np.flatnonzero(np.concatenate([~joined, [True]])) + 1
    begins = np.concatenate([[0], ends[:-1]])
    longest = int(np.argmax(ends - begins))
    return int(begins[longest]), int(ends[longest])


def _rows(count: int) -> str:
    """Return a number of rows in words, such as "3 rows"."""
    return f"{count:,} row{'s' if count > 1 else ''}"
