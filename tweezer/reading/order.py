"""Sorting of the rows of a table by their times or frame numbers."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from tweezer.reading.table import Array
from tweezer.values.errors import ResultError

#: Largest deviation of a sorted step from a whole number of usual steps
_OFF = 0.2
#: Largest fraction of backward steps due to a clock; with more, rows are out of order
_FEW = 0.05
#: Largest fraction of repeated time stamps; with more, rows belong to several beads
_OFTEN = 0.3
#: Largest deviation of a step that is used to determine a rate, in median deviations
_FAR = 10.0


def in_order(
    name: str,
    stamps: Array,
    columns: Mapping[str, Array],
    without: str,
    rate: float | None,
) -> tuple[NDArray[np.int64], str]:
    """Return the rows in the order of their stamps, and a note on what was done.

    Rows are sorted only if each stamp occurs once and the sorted stamps are even, apart from gaps.
    A row that repeats another one exactly is omitted. Rows without a stamp come last.

    Parameters
    ----------
    name : str
        The file.
    stamps : ndarray, shape (n,)
        Times, or numbers of frames; NaN where a row has none.
    columns : mapping of str to ndarray, shape (n,)
        The other columns that are read.
    without : str
        Option that reads the same columns without the stamps, such as `x=Bead 1`.
    rate : float or None
        Sampling rate, Hz, if the user gives it.

    Raises
    ------
    ResultError
        If a stamp decreases or repeats, and sorting does not help.
    """
    rows = np.arange(len(stamps))
    dated = np.flatnonzero(~np.isnan(stamps))
    steps = np.diff(stamps[dated])
    if (steps > 0).all() or np.isinf(stamps).any():  # the caller refuses infinite stamps
        return rows, ""
    order = dated[np.argsort(stamps[dated], kind="stable")]
    again = np.zeros(len(order), bool)
    again[1:] = stamps[order[1:]] == stamps[order[:-1]]
    for column in columns.values():
        again[1:] &= _same(column[order[1:]], column[order[:-1]])
    kept = order[~again]
    ascending = np.diff(stamps[kept])
    usual = float(np.median(ascending)) if len(ascending) else 0.0
    if usual > 0 and (ascending > 0).all():
        leaps = np.maximum(np.rint(ascending / usual), 1.0)
        if (np.abs(ascending / usual - leaps) <= _OFF).all():
            notes = ["rows sorted by time"] if (np.diff(kept) < 0).any() else []
            if again.any():
                notes.append(f"{int(again.sum()):,} rows that repeat another one omitted")
            return np.concatenate([kept, np.flatnonzero(np.isnan(stamps))]), "; ".join(notes)
    at = 1 + int(np.argmax(steps <= 0))
    place = f"{name}: sample {int(dated[at]) + 1}: its time is not later than the previous time"
    back = float(np.mean(steps < 0))
    again_at = 1 - len(np.unique(stamps[dated])) / len(dated)
    if back and again_at > _OFTEN:
        raise ResultError(
            f"{place}; {100 * again_at:.0f} % of its times occur more than once, as in a table of "
            'several beads; name the column that distinguishes them, such as --columns "bead=ID,'
            '...", or keep the rows of one bead'
        )
    if back > _FEW:
        raise ResultError(
            f"{place}; its rows are out of order, and their times are uneven after sorting; "
            "correct the times"
        )
    usual = float(np.median(steps))
    spread = float(np.median(np.abs(steps - usual)))
    near = np.abs(steps - usual) <= max(_FAR * spread, usual)
    mean = float(steps[near].mean() if back else steps.mean())
    if not mean > 0:
        raise ResultError(f"{place}; the times do not give a rate; correct them")
    why = "its clock runs backwards" if back else f"{int((steps == 0).sum()):,} stamps repeat"
    rate = rate or 1 / mean
    raise ResultError(
        f"{place}: {why}; if the rows are in order and evenly spaced, read them without it: "
        f'--columns "{without}" --rate "{rate:.6g} Hz"'
    )


def refuse_another_order(name: str, column: str, stamps: Array, way: str) -> None:
    """Refuse rows that are read at a given rate although a column shows that they are out of order.

    Raises `ResultError` if more than 5 % of the stamps in `column` are before the previous stamp.

    Parameters
    ----------
    name, column : str
        The file, and the column of the stamps.
    stamps : ndarray, shape (n,)
        Times, or numbers of frames.
    way : str
        Option that reads the stamps too.
    """
    steps = np.diff(stamps[~np.isnan(stamps)])
    if len(steps) and np.mean(steps < 0) > _FEW:
        raise ResultError(
            f"{name}: its rows are not in the order of its column {column!r}; read this column "
            f"too: {way}"
        )


def _same(first: Array, second: Array) -> NDArray[np.bool_]:
    """Return which elements are equal in both arrays, where NaN equals NaN."""
    return np.asarray((first == second) | (np.isnan(first) & np.isnan(second)))
