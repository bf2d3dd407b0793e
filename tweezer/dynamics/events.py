"""Events: sign changes of functions of the motion, located on the dense output of a run."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from tweezer.dynamics.layout import POSITION
from tweezer.scene import Scene
from tweezer.scene.arguments import in_si, numbers_in_si
from tweezer.values.arrays import Array
from tweezer.values.errors import IntegrationError, SceneError
from tweezer.values.units import QuantitiesLike, QuantityLike

#: Number of parts into which a time with a change of sign is divided
_PARTS = 64
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
    """

    name: str
    value: Callable[[Array, Array], Array]
    direction: int = 0
    terminal: bool = False
    once: bool = False
    hold: float = 0.0
    ends_as: str = "ended"
    _sign: float = field(default=0.0, init=False, repr=False)
    """sign of the value at the end of the last piece; 0 before the first piece"""
    _since: Occurrence | None = field(default=None, init=False, repr=False)
    """occurrence whose sign has not yet persisted for `hold`"""
    _done: bool = field(default=False, init=False, repr=False)
    """whether no further occurrence counts"""
    _close: Array = field(default_factory=lambda: np.zeros(1), init=False, repr=False)
    """(state,) or (1,), changes of the states that do not count"""

    def restarted(self, state: Array, close: Array | None = None) -> Event:
        """Return the same event for a new run.

        Parameters
        ----------
        state : ndarray, shape (state,)
            State at the beginning of the run.
        close : ndarray, shape (state,), optional
            Change of the state that is negligible. If such a change can change the sign, the sign
            is ignored, because rounding errors move even a bead at rest.

        Raises
        ------
        SceneError
            If `value` does not return one finite number for each time.
        """
        again = Event(
            self.name, self.value, self.direction, self.terminal, self.once, self.hold, self.ends_as
        )
        try:
            given = np.asarray(self.value(np.zeros(2), np.array([state, state])), np.float64)
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
        times = piece.checkpoints()
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
            doubt += np.abs(np.asarray(self.value(times, moved), np.float64) - values)
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
        return Occurrence(self.name, time, piece.states(np.array([time]))[0], certain)

    def _values(self, piece: Piece, times: Array) -> Array:
        """Return the values of the function at ascending times, (n,); raise `IntegrationError` if
        not finite.
        """
        values = np.asarray(self.value(times, piece.states(times)), dtype=np.float64)
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

    def restarted(self, state: Array, close: Array | None = None) -> Event:  # noqa: ARG002
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


def capture(
    radius: QuantityLike,
    time: QuantityLike,
    centre: QuantitiesLike = (0.0, 0.0, 0.0),
    *,
    terminal: bool = False,
) -> Event:
    """Return the event that the bead comes within `radius` of `centre` and stays there for `time`.

    Parameters
    ----------
    radius : float or str
        Largest distance from `centre`, m.
    time : float or str
        Time for which the bead must stay, s. The time of the event is the time of the approach.
    centre : array_like, shape (3,), optional
        Position, m from the focus. Default: the focus.
    terminal : bool, optional
        Whether the event ends the run, once the bead has stayed for `time`.

    Returns
    -------
    Event
        Event for `tweezer.simulate(scene, events=[...])`. It counts once.

    Examples
    --------
    >>> event = tweezer.capture("0.3 um", "1 ms", terminal=True)
    >>> run = tweezer.simulate("silica-1um", "2 ms", events=[event])
    >>> run.status
    'ended'
    """
    radius, time = in_si("radius", radius, "m"), in_si("time", time, "s")
    place = numbers_in_si("centre", centre, "m", SceneError)
    return Event(
        "capture",
        lambda _, y: np.linalg.norm(y[:, POSITION] - place, axis=1) - radius,
        direction=-1, terminal=terminal, once=True, hold=time,
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
