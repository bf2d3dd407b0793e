"""Detection of samples that were not measured, from the digits of a recording.

Each test compares exact coincidences with near ones, because displacements by a few of the last
digits are as probable as no displacement.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tweezer.reading.filling import LONGEST
from tweezer.reading.table import Array

Rows = NDArray[np.bool_]

#: Smallest number of exact coincidences, and its ratio to chance, that are significant
_LEAST, _RATIO = 5, 5.0
#: Smallest number of occurrences of a mark, the most frequent position
_LEAST_MARKS = 10
#: Number of neighbouring values on each side in which near coincidences are counted
_NEAR = 3
#: Largest step of the digits, over the scatter, for counting coincidences and straight lines
_FINE, _FINEST = 0.3, 0.05
#: Largest number of marks of lost frames
_MARKS = 3
#: Smallest distance of an isolated mark from all other positions, in their standard deviations
_ALONE = 0.5
#: Deviation from a whole number that counts as rounding
_WHOLE = 1e-3
#: Fraction of the extent below which a difference counts as zero
_ROUNDING = 1e-12
#: Fraction of rows that repeat earlier ones at one lag, above which they are a copy
_COPIED = 0.02
#: Smallest number of samples for the search for coincidences
_SHORTEST = 20
#: Number of samples whose copies are sought
_PROBES = 50
#: Number of samples in which a step or a mark is sought
_LOOKED_AT = 20_000
#: Factors that combine the coordinates of a row into one number (powers of the plastic number)
_PARTS = np.array([1.0, 0.7548776662466927, 0.5698402909980532])
#: Largest fraction of samples that may be made missing
_FEW = 0.05


class Unmeasured(NamedTuple):
    """Rows whose positions were not measured."""

    marks: Rows
    """(n,) whether a row has a number that marks a lost frame, such as 0 or -1"""
    repeated: Rows
    """(n,) whether a row equals the row before it"""
    between: Rows
    """(n,) whether a row is on the straight line between its neighbours"""
    said: tuple[str, ...]
    """phrase for each kind of row that was found, with the number of rows, for notes and findings
    """

    @property
    def copies(self) -> Rows:
        """Rows (n,) that were copied or interpolated from their neighbours, not measured."""
        return self.repeated | self.between


def unmeasured(positions: Array) -> Unmeasured:
    """Return which rows of positions, (n, axes), were not measured according to their digits.

    Marks of lost frames are sought in all axes together, then in each axis alone.
    """
    if np.isfinite(positions).all(axis=1).sum() < _SHORTEST:
        none = np.zeros(len(positions), bool)
        return Unmeasured(none, none, none, ())
    marks, of_marks = _marks(positions)
    for column in positions.T if positions.shape[1] > 1 else ():
        more, of_more = _marks(np.where(marks, np.nan, column)[:, None])
        marks = marks | more
        of_marks += [each.replace(": treated", " along one axis: treated") for each in of_more]
    repeated = _repeated(positions, marks)
    between = _between(positions, marks | repeated)
    said = list(of_marks)
    n = len(positions)
    if repeated.any():
        said.append(f"{_share(repeated, n)} samples repeat the previous one to the last digit")
    if between.any():
        said.append(f"{_share(between, n)} samples lie on the line between their neighbours")
    return Unmeasured(marks, repeated, between, tuple(said))


def measured(times: Array, positions: Array) -> tuple[NDArray[np.int64], Array, Array, str]:
    """Remove samples that were not measured from a recording.

    Marks of lost frames and long stretches without motion become missing (NaN). Repeated or
    interpolated samples become missing too if they are at most 5 % of all. If there are more, and
    the other samples are evenly spaced within half a step (a camera slower than its recorder), only
    the other samples are kept. Otherwise the samples stay as they are, for a finding to report.

    Parameters
    ----------
    times : ndarray, shape (n,)
        Times of the samples, s.
    positions : ndarray, shape (n, axes)
        Positions, NaN where a row has none.

    Returns
    -------
    tuple
        Indices of the rows that are kept, their times and positions, and a note on what was done
        ("" if nothing was).
    """
    every = np.arange(len(positions))
    found = unmeasured(positions)
    if not found.said:
        return every, times, positions, ""
    notes = [each for each in found.said if "the same numbers" in each]
    still = _long(found.repeated)
    lost = found.marks | still
    if still.any():
        notes.append(f"{int(still.sum()):,} samples in stretches without motion")
    copies = found.copies & ~lost
    kept = np.flatnonzero(~copies)
    if copies.mean() <= _FEW:
        if copies.any():
            notes += [each for each in found.said if "the same numbers" not in each]
        lost = lost | copies
    elif not lost.any() and len(kept) > 2 and np.isfinite(times).all():
        # kept rows are even if their indices are on a line: `slope` recorder steps per new sample
        slope, start = np.polyfit(np.arange(len(kept)), kept, 1)
        if np.abs(kept - start - slope * np.arange(len(kept))).max() <= 0.5 + _WHOLE:
            step = float(times[-1] - times[0]) / (len(times) - 1)
            at = times[kept]
            if len(set(np.diff(kept).tolist())) > 1:
                at = times[0] + step * (kept[0] + slope * np.arange(len(kept)))
            rate = f"the {len(kept):,} others, at {1 / (slope * step):.4g} Hz, are used"
            return kept, at, positions[kept], f"{found.said[0]}: {rate}"
    positions = np.where(lost[:, None], np.nan, positions)
    return every, times, positions, "; ".join(notes)


def step_of(values: Array) -> float:
    """Return the resolution of a recording: the step of which all values are multiples.

    The step, in the unit of the values, is the smallest gap between distinct values, averaged over
    all gaps. Returns 0 if no such step exists.
    """
    distinct = np.unique(_some(values[np.isfinite(values)]))
    if len(distinct) < 2:
        return 0.0
    gaps = np.diff(distinct)
    gaps = gaps[gaps > _ROUNDING * (distinct[-1] - distinct[0])]
    step = float(gaps.min()) if len(gaps) else 0.0
    if not step or (distinct[-1] - distinct[0]) / step > 1e8:
        return 0.0
    numbers = gaps / step  # number of steps in each gap, which must be whole
    if np.abs(numbers - np.rint(numbers)).max() > 0.1:
        return 0.0
    return float(gaps.sum() / np.rint(numbers).sum())


def copied(positions: Array) -> str:
    """Return a sentence on rows that are a copy of earlier ones; "" without a copy.

    A copy exists if, at one lag (a number of rows between original and copy), far more rows are
    equal than at the next lag, where equality is due to chance. The lag is the most frequent
    distance between equal positions around 50 probe rows.
    Parameters
    ----------
    positions : ndarray, shape (n, axes)
    """
    n, lags = len(positions), []
    for place in np.linspace(0, n - 1, _PROBES).astype(int):
        alike = np.flatnonzero(positions[:, 0] == positions[place, 0])
        if len(alike) <= _PROBES:  # otherwise the digits are too few
            lags += [abs(int(each) - int(place)) for each in alike if abs(int(each) - place) > 1]
    if not lags:
        return ""
    lag = max(set(lags), key=lambda each: (lags.count(each), -each))  # the shortest of equals
    same = (positions[lag:] == positions[:-lag]).all(axis=1)
    beside = (positions[lag + 1 :] == positions[: -lag - 1]).all(axis=1)
    if same.sum() <= max(_LEAST + _RATIO * beside.sum(), _COPIED * n):
        return ""
    first = lag + int(same.argmax())
    return (
        f"{100 * same.sum() / n:.2g} % of its samples are a copy of those {lag:,} before, as "
        f"sample {first + 1:,} is of sample {first + 1 - lag:,}"
    )


def _share(rows: Rows, n: int) -> str:
    """Return how many of `n` rows are set: as numbers below 1 %, otherwise as a percentage."""
    count = int(rows.sum())
    return f"{count:,} of {n:,}" if count < 0.01 * n else f"{100 * count / n:.2g} % of the"


def _marks(positions: Array) -> tuple[Rows, list[str]]:
    """Find the rows of `positions`, (n, axes), that contain a mark of a lost frame.

    A mark is one set of numbers, such as (0, 0), that occurs far more often than nearby values. It
    is among the positions or far outside them, but not at the end of their range. Up to three marks
    are found, the most frequent first. A stretch of equal rows counts once.

    Returns the rows, (n,) booleans, and a phrase for each mark.
    """
    n = len(positions)
    found, said = np.zeros(n, bool), []
    finite = np.isfinite(positions).all(axis=1)
    for _ in range(_MARKS):
        rest = finite & ~found
        if rest.sum() < 2:
            break
        begins = rest & ~(np.concatenate([[False], _same_as_before(positions)]))
        rows = _some(positions[begins])
        # Each row is represented by one number, a sum of the coordinates with irrational factors.
        # It differs for different rows and is faster to sort than rows.
        _, first, counts = np.unique(
            rows @ _PARTS[: rows.shape[1]], return_index=True, return_counts=True
        )
        mark = rows[first[counts.argmax()]]
        runs = int((begins & (positions == mark).all(axis=1)).sum())
        if counts.max() < 2 or runs <= _LEAST_MARKS:
            break
        others = positions[rest & (positions != mark).any(axis=1)]
        if not len(others):
            break
        # Number by chance: rows in the box of neighbouring values around the mark, divided by the
        # cells of the box. An axis with too few distinct values cannot be tested and is ignored.
        near, cells, edge = np.ones(len(others), bool), 1, False
        for column, value in zip(others.T, mark, strict=True):
            outside = value >= column.max() or value <= column.min()
            away = np.abs(column - value)
            edge |= outside and away[away > 0].min() < _ALONE * column.std()
            distinct = np.unique(np.append(_some(column), value))
            at = int(np.searchsorted(distinct, value))
            if len(distinct) > 2 * _NEAR / _FINE:
                around = distinct[max(at - _NEAR, 0) : at + _NEAR + 1]
                near &= (column >= around[0]) & (column <= around[-1])
                cells *= 2 * _NEAR + 1
        expected = near.sum() / (cells - 1) if cells > 1 else np.inf
        if edge or runs <= _LEAST_MARKS + _RATIO * expected:
            break
        rows_of_mark = rest & (positions == mark).all(axis=1)
        found |= rows_of_mark
        numbers = ", ".join(f"{each:.4g}" for each in mark)
        said.append(
            f"{int(rows_of_mark.sum()):,} samples have the same numbers ({numbers}): treated as "
            "lost frames"
        )
    return found, said


def _same_as_before(positions: Array) -> Rows:
    """Return whether each row after the first equals the previous row, as (n - 1,) booleans."""
    return np.asarray((positions[1:] == positions[:-1]).all(axis=1))


def _repeated(positions: Array, without: Rows) -> Rows:
    """Return the rows that equal the previous row in all axes, unless it may be by chance.

    The number expected by chance follows from displacements of up to three digits, which are as
    probable as no displacement. If the rows are not far more, none are returned. `positions` is
    (n, axes), and `without` (n,) selects rows that are excluded, such as marks.
    """
    none = np.zeros(len(positions), bool)
    same = np.concatenate([[False], _same_as_before(positions)]) & ~without
    for column in positions.T if same.any() else ():  # at the end of its range it may repeat, too
        for end in np.nanmin(column), np.nanmax(column):
            if ((column == end) & ~same).sum() > _LEAST:
                same &= column != end
    if same.sum() <= _LEAST:
        return none
    # A displacement of at most _NEAR distinct values in each axis is in one of `cells` equally
    # probable cells, one of which is no displacement. Axes with coarse digits cannot be tested.
    near, cells = np.ones(len(positions) - 1, bool), 1
    for column in positions.T:
        moves = np.diff(np.unique(column, return_inverse=True)[1].astype(np.int64))
        if moves.any() and moves[moves != 0].std() > 1 / _FINE:
            near &= np.abs(moves) <= _NEAR
            cells *= 2 * _NEAR + 1
    expected = (near & ~same[1:]).sum() / (cells - 1) if cells > 1 else np.inf
    return same if same.sum() > _LEAST + _RATIO * expected else none


def _between(positions: Array, without: Rows) -> Rows:
    """Return the rows on the line between their neighbours, unless it may be by chance.

    A row is on the line if its second difference is zero within rounding in all axes. The number
    expected by chance follows from rows within five times that distance. If the rows are not far
    more, none are returned. `positions` is (n, axes), and `without` (n,) selects rows that are
    excluded, such as marks.
    """
    exact, near = np.ones(len(positions), bool), np.ones(len(positions), bool)
    exact[[0, -1]] = near[[0, -1]] = False
    exact[1:-1] &= (positions[2:] != positions[:-2]).any(axis=1)
    # `inside`: bound on the second difference of three numbers on a line, in steps of the digits,
    # because rounding errors of half a step add up to 2. `levels`: number of axes with fine digits
    inside, levels = 2.1, 0
    for column in positions.T:
        bends = np.diff(column, 2)
        scatter = bends[np.isfinite(bends)].std()
        step = max(step_of(column), _ROUNDING * float(np.nanmax(np.abs(column))))
        if step > _FINEST * scatter:
            continue
        exact[1:-1] &= np.abs(bends) <= inside * step
        near[1:-1] &= np.abs(bends) <= 5 * inside * step
        levels += 1
    if not levels:
        return np.zeros(len(positions), bool)
    exact &= ~without
    # the near region is 5**levels times as large as the exact one, which it contains
    expected = (near & ~exact & ~without).sum() / (5**levels - 1)
    return exact if exact.sum() > _LEAST + _RATIO * expected else np.zeros(len(positions), bool)


def _some(rows: Array) -> Array:
    """Return every k-th row, so that at most about 40,000 rows remain for sorting."""
    return rows[:: max(len(rows) // _LOOKED_AT, 1)]


def _long(rows: Rows) -> Rows:
    """Return which rows are in stretches of more than `LONGEST` consecutive True, (n,).

    Gaps of up to `LONGEST` samples can be filled, longer ones cannot.
    """
    edges = np.flatnonzero(np.diff(np.concatenate([[False], rows, [False]])))
    found = np.zeros(len(rows), bool)
    for first, end in zip(edges[::2], edges[1::2], strict=True):
        found[first:end] = end - first > LONGEST
    return found
