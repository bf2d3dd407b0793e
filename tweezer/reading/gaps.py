"""Samples that a recording lacks."""

from __future__ import annotations

import numpy as np

from tweezer.reading.filling import LONGEST, filled
from tweezer.reading.table import Array
from tweezer.values.errors import ResultError, TooFewError

#: Largest fraction of samples that are filled in
_FILLED = 0.05
#: Deviation of a step from the usual one, over it, beyond which it is another
_UNEVEN = 0.1
#: Fraction of steps that are others, beyond which times are uneven rather than with gaps
_OFTEN = 0.2
#: Deviation of a longer step from a whole number of steps, beyond which samples are not filled in
_OFF = 0.2


def without_gaps(
    name: str, times: Array, columns: Array, least: int, straight: int = 0
) -> tuple[Array, Array, str]:
    """Times (n,) and columns (n, k) without gaps, and what was done about them.

    A row that has no time, or lacks a column, is missing; so are rows where the time leaps. Those
    at the beginning and the end are left out. Gaps of up to 10 samples, of up to 5 % of the record
    together, are filled in (`filled`). Otherwise the longest stretch without a gap is taken.

    straight: number of columns at the end, of a stage, that are filled in by straight lines.

    Raises `TooFewError` if that has fewer than `least` samples.
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
    notes = [f"{_rows(outside)} without numbers at its ends left out"] if outside else []
    steps = np.diff(times)
    usual = float(np.median(steps)) if len(steps) else 0.0
    off = np.abs(steps - usual)
    uneven = (off > _UNEVEN * usual).sum() > _OFTEN * len(off)
    if not (steps > 0).all() or not np.isfinite(times).all() or uneven:
        return times[there], columns[there], "; ".join(notes)  # refused by who takes them
    leaps = np.maximum(np.rint(steps / usual), 1.0)
    if there.all() and (leaps == 1).all():
        return times, columns, "; ".join(notes)
    whole = bool((np.abs(steps / usual - leaps)[leaps > 1] <= _OFF).all())
    numbers = np.concatenate([[0.0], np.cumsum(leaps)])
    every = int(numbers[-1]) + 1
    lost = every - int(there.sum())
    said = f"samples missing: {lost:,} of {every:,}"
    longest_gap = int(np.diff(numbers[there]).max()) - 1
    few = every >= least and longest_gap <= LONGEST and lost <= _FILLED * every
    if whole and few:
        notes.append(f"{said}, filled in from those around them")
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
        f"{said}; the longest stretch without a gap is taken: {last - first:,} samples from "
        f"{times[first]:.6g} s on"
    )
    return times[first:last], columns[first:last], "; ".join(notes)


def _longest(there: np.ndarray, leaps: Array) -> tuple[int, int]:
    """Begin and end of the longest stretch of rows that are there, each a step after the other."""
    joined = there[1:] & there[:-1] & (leaps == 1)
    ends = np.flatnonzero(np.concatenate([~joined, [True]])) + 1
    begins = np.concatenate([[0], ends[:-1]])
    longest = int(np.argmax(ends - begins))
    return int(begins[longest]), int(ends[longest])


def _rows(count: int) -> str:
    return f"{count:,} row{'s' if count > 1 else ''}"
