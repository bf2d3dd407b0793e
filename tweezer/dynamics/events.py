"""Events: sign changes of functions of the motion, located on the dense output of a run."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from tweezer.dynamics.layout import POSITION, Layout
from tweezer.scene import Scene
from tweezer.values.arrays import Array
from tweezer.values.errors import IntegrationError, SceneError

#: Columns of the orientation in a pose
EULER_PARAMETERS = slice(3, 7)
#: Number of parts into which a time with a change of sign is divided
_PARTS = 64
#: Largest turn between two times at which an event of poses is evaluated, rad, and the most
#: halvings that lead to it
_TURN, _HALVINGS = 0.5, 12
#: Depth of a minimum, over the rise that makes it count, below which it is not located at once
_SHALLOW = 1e-3


class Piece(Protocol):
    """Part of a motion that consists of some steps of a solver."""

    @property
    def begin(self) -> float:
        """Time at which the piece begins, s."""

    @property
    def end(self) -> float:
        """Time at which the piece ends, s."""

    def checkpoints(self) -> Array:
        """Return ascending times from the beginning to the end, several in each step, s."""

    def states(self, times: Array) -> Array:
        """Return the states at ascending times, (n, state); the position comes first."""


@dataclass(frozen=True)
class Occurrence:
    """An event that happened."""

    name: str
    time: float
    """time of the event, s"""
    state: Array
    """(state,) state at this time"""
    certain: float
    """time at which the event was certain, s: later than `time` if its condition must persist"""
    orientation: Array | None = None
    """(4,) Euler parameters at this time, for an event of poses"""


@dataclass
class Event:
    """Event of a run, at which a function of the motion changes its sign.

    Parameters
    ----------
    name : str
        Name of the event in the run.
    value : callable
        Function of times (n,), s, and states (n, state), in which the position comes first. It
        returns an array (n,).
    direction : int, optional
        +1 for a value that rises through 0, -1 for one that falls. Default: 0, for both.
    terminal : bool, optional
        Whether the event ends the run.
    once : bool, optional
        Whether only the first occurrence counts.
    hold : float, optional
        Time for which the new sign must persist for the event to count, s. The time of the event is
        the time of the sign change; a terminal event ends the run when `hold` is over.
    ends_as : str, optional
        Status of a run that the event ends.
    poses : bool, optional
        Whether `value` receives poses (n, 7) instead of states: the position, m, and the Euler
        parameters of the orientation, scalar first, from the body to the laboratory.
    """

    name: str
    value: Callable[[Array, Array], Array]
    direction: int = 0
    terminal: bool = False
    once: bool = False
    hold: float = 0.0
    ends_as: str = "ended"
    poses: bool = False
    _pose: Array | None = field(default=None, init=False, repr=False)
    """(7,) columns of the pose in a state, for an event of poses"""
    _spin: slice | None = field(default=None, init=False, repr=False)
    """columns of e' or of the angular velocity in a state, for an event of poses in a dense output
    """
    _sign: float = field(default=0.0, init=False, repr=False)
    """sign of the value at the end of the last piece; 0 before the first piece"""
    _since: Occurrence | None = field(default=None, init=False, repr=False)
    """occurrence whose sign has not yet persisted for `hold`"""
    _done: bool = field(default=False, init=False, repr=False)
    """whether no further occurrence counts"""
    _close: Array = field(default_factory=lambda: np.zeros(1), init=False, repr=False)
    """(state,) or (1,), changes of the states that do not count"""

    def restarted(self, state: Array, layout: Layout, close: Array | None = None) -> Event:
        """Return the same event for a new run.

        Parameters
        ----------
        state : ndarray, shape (state,)
            State at the beginning of the run.
        layout : Layout
            Layout of the states.
        close : ndarray, shape (state,), optional
            Change of the state that is negligible. If such a change can change the sign, the sign
            is ignored, because rounding errors move even a bead at rest. Default: for a motion that
            is known at the ends of its steps alone.

        Raises
        ------
        SceneError
            If `value` does not return one finite number for each time, or requires an orientation
            that the run does not follow.
        """
        again = Event(
            self.name, self.value, self.direction, self.terminal, self.once, self.hold,
            self.ends_as, self.poses,
        )  # fmt: skip
        if self.poses:
            if "orientation" not in layout:
                raise SceneError(
                    f"event {self.name!r}: requires the orientation, which this run does not "
                    "follow, because nothing rotates the bead"
                )
            columns = np.arange(layout.width)
            again._pose = np.concatenate([columns[POSITION], columns[layout.at("orientation")]])
            rates = [each for each in ("angular_velocity", "euler_rates") if each in layout]
            again._spin = layout.at(rates[0]) if rates and close is not None else None
        try:
            given = again._value(np.zeros(2), np.array([state, state]))
        except Exception as error:
            raise SceneError(f"event {self.name!r}: {type(error).__name__}: {error}") from None
        if given.shape != (2,) or not np.isfinite(given).all():
            raise SceneError(
                f"event {self.name!r}: its value must be (n,) finite numbers for n times"
            )
        if close is not None:
            again._close = close
        return again

    def occurrences(self, piece: Piece) -> Iterator[Occurrence]:
        """Yield the occurrences in a piece; pieces must be passed in the order of time."""
        if self._done:
            return
        times = self._checkpoints(piece)
        signs = self._signs(piece, times)
        if self._sign == 0.0:  # a run that begins at 0 begins on the side where it goes
            self._sign = float(signs[np.flatnonzero(signs)[:1]].sum())
            if self.hold and self._sign == self.direction:
                self._since = self._at(piece, piece.begin, piece.begin + self.hold)
        # a value of 0 belongs to what was before
        told = np.flatnonzero(signs)
        changed = np.flatnonzero(np.diff(signs[told], prepend=self._sign))
        for k in changed.tolist():
            before = times[told[k - 1]] if k else times[max(told[0] - 1, 0)]
            self._sign = float(signs[told[k]])
            yield from self._changed(piece, self._root(piece, before, float(times[told[k]])))
            if self._done:
                return
        yield from self._held(piece.end)

    def _checkpoints(self, piece: Piece) -> Array:
        """Return the checkpoints of a piece, (n,) s; for poses, close enough to follow the turns.

        A step may contain several turns of a spinning bead. Intervals are halved until the body
        turns by less than `_TURN` in each.
        """
        times = piece.checkpoints()
        for _ in range(_HALVINGS if self._spin is not None else 0):
            # the angular speed is 2|e'|; if the state contains it, this is twice its value
            speed = 2 * np.linalg.norm(piece.states(times)[:, self._spin], axis=1)
            rough = np.maximum(speed[:-1], speed[1:]) * np.diff(times) > _TURN
            if not rough.any():
                break
            times = np.sort(np.concatenate([times, (times[:-1] + times[1:])[rough] / 2]))
        return times

    def _signs(self, piece: Piece, times: Array) -> Array:
        """Return the signs of the value at times (n,), s; 0 where the change by `_close` may change
        the sign.
        """
        values = self._values(piece, times)
        signs: Array = np.sign(values)
        if (signs == self._sign).all():
            return signs
        states = piece.states(times)
        doubt = np.zeros(len(times))
        for k in range(states.shape[1]):
            moved = states.copy()
            moved[:, k] += self._close[min(k, len(self._close) - 1)]
            doubt += np.abs(self._value(times, moved) - values)
        return np.where(np.abs(values) > doubt, signs, 0.0)

    def _changed(self, piece: Piece, time: float) -> Iterator[Occurrence]:
        """Yield the occurrences that follow from a change of sign at a time, s.

        Without `hold` the change is the event; with it, an earlier one may be complete, and a new
        one begins.
        """
        begins = self.direction in (0.0, self._sign)
        if not self.hold:
            if begins:
                self._done = self.once
                yield self._at(piece, time, time)
            return
        yield from self._held(time)
        self._since = self._at(piece, time, time + self.hold) if begins else None

    def _held(self, now: float) -> Iterator[Occurrence]:
        """Yield the pending occurrence if its sign has lasted for `hold` at the time `now`, s."""
        if self._since is not None and now >= self._since.certain:
            self._done = self.once
            yield self._since
            self._since = None

    def _at(self, piece: Piece, time: float, certain: float) -> Occurrence:
        """Return the occurrence at a time, s, that is certain at the time `certain`, s."""
        state = piece.states(np.array([time]))
        turned = None if self._pose is None else self._poses_in(state)[0, EULER_PARAMETERS]
        return Occurrence(self.name, time, state[0], certain, turned)

    def value_at(self, state: Array) -> float:
        """Return the value at a state (state,) at time 0."""
        return float(self._value(np.zeros(1), state[None])[0])

    def _value(self, times: Array, states: Array) -> Array:
        """Return what `value` returns for times (n,), s, and states (n, state)."""
        given = states if self._pose is None else self._poses_in(states)
        return np.asarray(self.value(times, given), np.float64)

    def _poses_in(self, states: Array) -> Array:
        """Return the poses (n, 7) in states (n, state), with Euler parameters of length 1."""
        poses = states[:, self._pose]
        poses[:, EULER_PARAMETERS] /= np.linalg.norm(poses[:, EULER_PARAMETERS], axis=1)[:, None]
        return poses

    def _values(self, piece: Piece, times: Array) -> Array:
        """Return the values of the function at ascending times, (n,); raise `IntegrationError` if
        not finite.
        """
        values = self._value(times, piece.states(times))
        if not np.isfinite(values).all():
            raise IntegrationError(f"the value of the event {self.name!r} is not finite")
        return values

    def _root(self, piece: Piece, begin: float, end: float) -> float:
        """Return the time between `begin` and `end`, s, at which the value is 0; its signs there
        differ.
        """
        first, last = self._values(piece, np.array([begin, end]))
        if first * last >= 0:  # a value of rounding alone need not have the same sign again
            return begin if abs(first) < abs(last) else end
        return crossing(lambda times: self._values(piece, times), begin, end, 1e-15 * end)


def ending(event: Event, time: float) -> str:
    """Return the message of a run that an event ended at a time, s."""
    match event.ends_as:
        case "lost":
            return f"the bead left the trap at {time:.6g} s"
        case "failed":
            return f"the bead reached the {event.name} at {time:.6g} s"
    return f"{event.name} at {time:.6g} s"


def crossing(value: Callable[[Array], Array], begin: float, end: float, tolerance: float) -> float:
    """Return the time at which a function is 0, between two times at which its signs differ, s.

    The interval is repeatedly divided into many equal parts instead of two, because evaluating the
    function at many times costs as much as at one.

    Parameters
    ----------
    value : callable
        Function of an array of times.
    begin, end : float
        Ends of the interval, s.
    tolerance : float
        Tolerance of the result, s.
    """
    while end - begin > tolerance:
        times = np.linspace(begin, end, _PARTS + 1)
        signs = np.sign(value(times[:-1]))
        after = int((signs == signs[0]).argmin()) or _PARTS
        begin, end = float(times[after - 1]), float(times[after])
    return (begin + end) / 2


@dataclass(frozen=True)
class _Low:
    """Local minimum of the distance to the focus."""

    piece: Piece
    """part of the motion that contains it"""
    begin: float
    """time before the minimum, s; its own time once it is located"""
    end: float
    """time after the minimum, s; its own time once it is located"""
    distance: float
    """smallest known distance, m"""


@dataclass
class ClosestApproach(Event):
    """The first local minimum of the distance to the focus.

    It counts once the distance has increased by more than `rise`, m, because a bead at rest moves
    within the tolerance of its position.
    """

    rise: float = 0.0
    _lowest: _Low | None = field(default=None, init=False, repr=False)

    def restarted(
        self,
        state: Array,  # noqa: ARG002
        layout: Layout,  # noqa: ARG002
        close: Array | None = None,  # noqa: ARG002
    ) -> Event:
        """Return the same event for a new run."""
        return closest_approach(self.rise)

    def occurrences(self, piece: Piece) -> Iterator[Occurrence]:
        """Yield the minimum in the piece in which it counts.

        A minimum that is shallower than a fraction of `rise` is located only if it is the one that
        counts.
        """
        if self._done:
            return
        times = piece.checkpoints()
        far = np.linalg.norm(piece.states(times)[:, POSITION], axis=1)
        signs = np.sign(self._values(piece, times))
        told = np.flatnonzero(signs)
        rising = np.diff(signs[told], prepend=self._sign or signs[told][:1]) > 0
        if len(told):
            self._sign = float(signs[told[-1]])
        reached = 0  # up to where the distances have been compared
        for k in told[rising].tolist():
            if self._has_risen(far[reached:k]):
                break
            before, reached = max(k - 1, 0), k
            least = float(far[before : k + 1].min())
            low = _Low(piece, float(times[before]), float(times[k]), least)
            if np.ptp(far[max(before - 1, 0) : k + 2]) > _SHALLOW * self.rise:
                low = self._located(low)
            if self._lowest is None or low.distance < self._lowest.distance:
                self._lowest = low
        if self._lowest is not None and self._has_risen(far[reached:]):
            self._done = True
            low = self._located(self._lowest)
            yield self._at(low.piece, low.begin, low.begin)

    def _has_risen(self, far: Array) -> bool:
        """Return whether any of the distances exceeds the lowest one so far by more than `rise`."""
        lowest = self._lowest
        return lowest is not None and far.max(initial=0.0) > lowest.distance + self.rise

    def _located(self, low: _Low) -> _Low:
        """Return a minimum with its time and distance determined."""
        if low.begin == low.end:
            return low
        time = self._root(low.piece, low.begin, low.end)
        state = low.piece.states(np.array([time]))[0]
        return _Low(low.piece, time, time, float(np.linalg.norm(state[POSITION])))

    def _values(self, piece: Piece, times: Array) -> Array:
        """Return the change of the squared distance over a short interval about each time, m^2."""
        apart = 1e-3 * np.diff(piece.checkpoints()).min()
        before = np.maximum(times - apart, piece.begin)
        after = np.minimum(times + apart, piece.end)
        both = np.concatenate([before, after])
        ascending = np.argsort(both)
        squared = np.empty(len(both))
        squared[ascending] = np.sum(piece.states(both[ascending])[:, POSITION] ** 2, axis=1)
        return squared[len(times) :] - squared[: len(times)]


def closest_approach(rise: float = 0.0) -> Event:
    """Return the event of the first closest approach to the focus (FCA).

    `rise` is the distance, m, by which the bead must move away again; see `ClosestApproach`.
    """
    return ClosestApproach("closest approach", lambda times, _: times, direction=1, rise=rise)


def loss(distance: float) -> Event:
    """Return the event that the bead reaches a `distance`, m, from the focus, which ends a run."""
    return Event(
        "loss", lambda _, y: np.linalg.norm(y[:, POSITION], axis=1) - distance, direction=1,
        terminal=True, ends_as="lost",
    )  # fmt: skip


def lens_touched(scene: Scene) -> Event | None:
    """Return the event that the bead reaches the lens, one focal length before the focus.

    The result is None if the focal length is unknown.
    """
    if scene.lens.focal_length is None:
        return None
    nearest = scene.body.support() - scene.lens.focal_length
    return Event(
        "lens", lambda _, y: y[:, 2] - nearest, direction=-1, terminal=True, ends_as="failed"
    )
