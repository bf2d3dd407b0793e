"""Motion between the output times, from the dense output of its steps, and derived quantities."""

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from tweezer.dynamics.events import Occurrence, Piece, crossing
from tweezer.dynamics.layout import POSITION
from tweezer.dynamics.models import EquationsOfMotion, Motion
from tweezer.values.arrays import Array

if TYPE_CHECKING:
    from tweezer.dynamics.poses import Rest

#: of ascending times (n,) s, gives (n,)
Value = Callable[[Array], Array]

#: Number of rounds in which a peak is located
_ROUNDS = 4
#: Number of points of each round
_POINTS = 17
#: Part of the tolerance of a position, or of a speed, below which its changes are not looked at
UNTOLD = 1e-3
#: Rounding of a value, as a part of it
_ROUNDING = 1e-14
#: Tolerance of the time of a crossing, as a part of the run
_CROSSING = 1e-12


@dataclass(frozen=True)
class Path:
    """Motion from its release to `end`."""

    equations: EquationsOfMotion
    pieces: Sequence[Piece]
    """consecutive pieces of the motion"""
    end: float
    """time at its end, s"""

    @functools.cached_property
    def checkpoints(self) -> Array:
        """Ascending times from the release to the end, several in each step, (n,) s."""
        times = np.unique(np.concatenate([piece.checkpoints() for piece in self.pieces]))
        return np.append(times[times < self.end], self.end)

    def positions(self, times: Array) -> Array:
        """Return positions from the focus at ascending times (n,), s: (n, 3) m."""
        released = self.equations.released
        return np.concatenate(
            [released(piece).states(part)[:, POSITION] for piece, part in self._parts(times)]
        )

    @property
    def position_tolerance(self) -> float:
        """Distance below which two positions are not distinguished, m."""
        return UNTOLD * float(self.equations.absolute_tolerance[POSITION].max())

    @property
    def speed_tolerance(self) -> float:
        """Difference below which two speeds are not distinguished, m/s.

        Such a speed moves the bead by the position tolerance in the time between two checkpoints.
        """
        begin = self.equations.begin_time
        return self.position_tolerance * len(self.checkpoints) / (self.end - begin)

    def motion(self, times: Array) -> Motion:
        """Return velocities and orientations at ascending times (n,), s."""
        states = np.concatenate([piece.states(part) for piece, part in self._parts(times)])
        return self.equations.motion(times, states)

    def speeds(self, times: Array) -> Array:
        """Return speeds at ascending times (n,), s: (n,) m/s."""
        velocity = self.motion(times).velocity
        assert velocity is not None  # thermal motion alone has none, and no pieces
        return np.linalg.norm(velocity, axis=1)

    @functools.cached_property
    def _begins(self) -> Array:
        """Times at the beginning of all pieces but the first, s."""
        return np.array([piece.begin for piece in self.pieces[1:]])

    def _parts(self, times: Array) -> list[tuple[Piece, Array]]:
        """Return each piece that contains some of the ascending times, with these times."""
        if len(self.pieces) == 1:
            return [(self.pieces[0], times)]
        index = np.searchsorted(self._begins, times, side="right")
        parts = np.split(times, np.flatnonzero(np.diff(index)) + 1)
        return [(self.pieces[i], part) for i, part in zip(np.unique(index), parts, strict=True)]


class Greatest(NamedTuple):
    """Largest value of a function of time."""

    value: float
    time: float
    """time of this value, s"""
    error: float
    """largest amount by which the function may exceed the value between the evaluated points"""


def greatest(value: Value, times: Array, tolerance: float = 0.0) -> Greatest:
    """Return the largest value from times[0] to times[-1] of a function smooth between `times`.

    `value` is a function of ascending times (n,), s, that returns (n,). Each local maximum at
    `times` is located between its neighbours if it may exceed the largest value by more than
    `tolerance`. This omits the maxima at every second point of a function that is constant up to
    rounding. The possible remainder is included in the error.
    """
    values = value(times)
    tolerance = max(tolerance, _ROUNDING * float(np.abs(values).max()))
    best = int(values.argmax())
    drop = np.maximum(values[1:-1] - values[:-2], values[1:-1] - values[2:])
    peaks = (values[1:-1] >= values[:-2]) & (values[1:-1] >= values[2:])
    peaks &= values[1:-1] + drop >= values[best]  # a parabola rises by an eighth of it at most
    reach = values.copy()
    reach[1:-1] += drop
    last = len(times) - 1
    found = _located(value, times[max(best - 1, 0)], times[min(best + 1, last)])
    for k in sorted(np.flatnonzero(peaks) + 1, key=lambda k: -float(reach[k])):
        if reach[k] <= found.value + tolerance:
            left = float(reach[k]) - found.value
            return found._replace(error=max(found.error, left))
        if k != best:
            other = _located(value, times[k - 1], times[k + 1])
            found = max(found, other, key=lambda each: each.value)
    return found


def _located(value: Value, low: float, high: float) -> Greatest:
    """Return the largest value between two times, s, with one maximum between them."""
    for _ in range(_ROUNDS):
        times = np.linspace(low, high, _POINTS)
        values = value(times)
        k = int(values.argmax())
        beside = max(k - 1, 0), min(k + 1, _POINTS - 1)
        low, high = (float(times[i]) for i in beside)
    error = float(values[k]) - min(float(values[i]) for i in beside)
    return Greatest(float(values[k]), float(times[k]), error)


def largest_distance(one: Path, other: Path) -> Greatest:
    """Return the largest distance between two motions at equal times, m, up to the earlier end."""
    end = min(one.end, other.end)
    times = np.union1d(one.checkpoints, other.checkpoints)
    times = times[times <= end]
    return greatest(
        lambda at: np.linalg.norm(one.positions(at) - other.positions(at), axis=1),
        times,
        min(one.position_tolerance, other.position_tolerance),
    )


def last_fall(value: Value, times: Array, tolerance: float = 0.0) -> float:
    """Return the time at which a function that ends below 0 last fell to 0, s.

    It is times[0] if the function is never above 0. A peak between `times` that may be above 0 by
    less than `tolerance` is not searched for.
    """
    fell = float(times[0])
    while times.size:
        above = times[value(times) > 0]
        if above.size:
            latest = float(above[-1])
        else:
            peak = greatest(value, times, tolerance)
            if not peak.value > 0:
                break
            latest = peak.time
        times = times[times > latest]
        fell = crossing(value, latest, float(times[0]), _CROSSING * float(times[-1]))
    return fell


class Passage(NamedTuple):
    """Extreme values of a motion, from its dense output; also used for their errors.

    The values are searched on the whole path, not only at the times of the samples. A value that is
    undefined, such as a gap without a wall, is NaN.
    """

    largest_speed: float
    """largest speed, m/s"""
    overshoot: float
    """largest distance beyond the beam's axis, on the side opposite to the start, m"""
    closest_approach: float
    """distance from the focus at its first local minimum, m"""
    closest_approach_time: float
    """time of this minimum, s"""
    settled: float
    """time from which on the bead stays near its final position, s"""
    smallest_gap: float
    """smallest gap to the nearer wall, m"""


def passage(
    path: Path, events: Sequence[Occurrence], rest: Array | Rest, near: float
) -> tuple[Passage, Passage]:
    """Return the passage of a motion, and the accuracy of its location on the dense output.

    Parameters
    ----------
    path : Path
        Dense output of the run.
    events : sequence of Occurrence
        Events of the run, including its closest approach.
    rest : ndarray or Rest
        Position, ring or pose at which the bead settles, as in `distances_from`, m.
    near : float
        Largest distance from `rest` that counts as near, m.
    """
    times = path.checkpoints
    close = path.position_tolerance
    fastest = greatest(path.speeds, times, path.speed_tolerance)
    over = _overshoot(path, times)
    approach = next((each for each in events if each.name == "closest approach"), None)
    distance = time = settled = np.nan
    nearest = Greatest(np.nan, 0.0, np.nan)
    if (scene := path.equations.scene).wall is not None:
        nearest = greatest(lambda at: -scene.room(path.positions(at)[:, 2]), times, close)
    if approach is not None:
        distance, time = float(np.linalg.norm(approach.state[POSITION])), approach.time

    def away(at: Array) -> Array:
        """Return by how much the distance from rest exceeds `near` at times (n,), s: (n,) m."""
        turned = None if isinstance(rest, np.ndarray) else path.motion(at).orientation
        return distances_from(rest, path.positions(at), turned) - near

    if away(times[-1:])[0] < 0:
        settled = last_fall(away, times, close)
    rounding = _CROSSING * path.end
    return (
        Passage(fastest.value, over.value, distance, time, settled, -nearest.value),
        Passage(fastest.error, over.error, 0.0, rounding, rounding, nearest.error),
    )


def distances_from(
    rest: Array | Rest, positions: Array, orientations: Array | None = None
) -> Array:
    """Return distances of `positions` (n, 3), m, from a point, a ring or a pose, (n,) m.

    rest: (3,) position of the point, (2,) radius and height of the ring, m, or a pose, which
    requires `orientations` (n, 4), Euler parameters.
    """
    if not isinstance(rest, np.ndarray):
        assert orientations is not None  # a body that has poses rotates
        return rest.distances(positions, orientations)
    if len(rest) == 3:
        return np.linalg.norm(positions - rest, axis=1)
    return np.linalg.norm(across_axis(positions) - rest, axis=1)


def across_axis(positions: Array) -> Array:
    """Return the cylindrical coordinates rho and z of `positions` (n, 3), m: (n, 2) m."""
    return np.column_stack([np.hypot(positions[:, 0], positions[:, 1]), positions[:, 2]])


def _overshoot(path: Path, times: Array) -> Greatest:
    """Return the largest lateral displacement opposite to the start, m; 0 for a start
    on the axis.
    """
    start = path.positions(times[:1])[0, :2]
    size = float(np.linalg.norm(start))
    none = Greatest(0.0, 0.0, 0.0)
    if size == 0.0:
        return none
    found = greatest(
        lambda at: -(path.positions(at)[:, :2] @ start) / size, times, path.position_tolerance
    )
    return found if found.value > 0 else none
