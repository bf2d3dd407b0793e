"""Events: what is looked for on the dense output of a run, and located there."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from tweezer.dynamics.layout import POSITION
from tweezer.scene import Scene
from tweezer.scene.arguments import in_si, numbers_in_si
from tweezer.values.errors import IntegrationError, SceneError
from tweezer.values.units import QuantitiesLike, QuantityLike

Array = NDArray[np.float64]

#: Number of parts into which a time with a change of sign is divided
_PARTS = 64
#: Depth of a minimum, over the rise that makes it count, below which it is not located at once
_SHALLOW = 1e-3


class Piece(Protocol):
    """Part of a motion: some steps of a solver."""

    @property
    def begin(self) -> float:
        """s"""

    @property
    def end(self) -> float:
        """s"""

    def checkpoints(self) -> Array:
        """Ascending times from begin to end, several to a step."""

    def states(self, times: Array) -> Array:
        """States at ascending times, (n, state); the position comes first."""


@dataclass(frozen=True)
class Occurrence:
    """An event that happened."""

    name: str
    time: float
    """s"""
    state: Array
    certain: float
    """s, when it was certain: later than `time` for one that had to last"""


@dataclass
class Event:
    """Where a function of the motion changes sign.

    value: of times (n,) s and states (n, state), the position first; gives (n,). direction: +1
    where it rises through 0, -1 where it falls, 0 for both. terminal: the run ends there. once:
    only the first one counts. hold: s, for which the sign must last for the event to count; it is
    then told for the time of the change, and ends a run when the time is over.
    """

    name: str
    value: Callable[[Array, Array], Array]
    direction: int = 0
    terminal: bool = False
    once: bool = False
    hold: float = 0.0
    ends_as: str = "ended"
    """status of a run that it ends"""
    _sign: float = field(default=0.0, init=False, repr=False)
    """of the last value, from piece to piece"""
    _since: Occurrence | None = field(default=None, init=False, repr=False)
    _done: bool = field(default=False, init=False, repr=False)
    _close: Array = field(default_factory=lambda: np.zeros(1), init=False, repr=False)
    """(state,) or (1,), changes of the states that do not count"""

    def restarted(self, state: Array, close: Array | None = None) -> Event:
        """Return the same event for a new run from `state`.

        A sign that changes of the state as small as `close`, (state,), could change does not count:
        a bead at rest wobbles by rounding.

        Raises `SceneError` if `value` does not give one finite number for each time.
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
        """What happens in a piece; pieces come in the order of time."""
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
        """Signs of the value at some times, (n,): 0 where changes that do not count may make it."""
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
        """What a change of sign means."""
        begins = self.direction in (0.0, self._sign)
        if not self.hold:
            if begins:
                self._done = self.once
                yield self._at(piece, time, time)
            return
        yield from self._held(time)
        self._since = self._at(piece, time, time + self.hold) if begins else None

    def _held(self, now: float) -> Iterator[Occurrence]:
        """The event, if the sign has lasted up to `now` for long enough."""
        if self._since is not None and now >= self._since.certain:
            self._done = self.once
            yield self._since
            self._since = None

    def _at(self, piece: Piece, time: float, certain: float) -> Occurrence:
        return Occurrence(self.name, time, piece.states(np.array([time]))[0], certain)

    def _values(self, piece: Piece, times: Array) -> Array:
        values = np.asarray(self.value(times, piece.states(times)), dtype=np.float64)
        if not np.isfinite(values).all():
            raise IntegrationError(f"the value of the event {self.name!r} is not finite")
        return values

    def _root(self, piece: Piece, begin: float, end: float) -> float:
        """Where the value is 0 between two times at which its signs differ."""
        first, last = self._values(piece, np.array([begin, end]))
        if first * last >= 0:  # a value of rounding alone need not have its sign a second time
            return begin if abs(first) < abs(last) else end
        return crossing(lambda times: self._values(piece, times), begin, end, 1e-15 * end)


def ending(event: Event, time: float) -> str:
    """Return the message of a run that an event ended."""
    match event.ends_as:
        case "lost":
            return f"the bead left the trap at {time:.6g} s"
        case "failed":
            return f"the bead reached the {event.name} at {time:.6g} s"
    return f"{event.name} at {time:.6g} s"


def crossing(value: Callable[[Array], Array], begin: float, end: float, tolerance: float) -> float:
    """Where a function of time that differs in sign at two times is 0, to `tolerance`, s.

    By division into equal parts, because a function costs as much at all their ends as at one.
    """
    while end - begin > tolerance:
        times = np.linspace(begin, end, _PARTS + 1)
        signs = np.sign(value(times[:-1]))
        after = int((signs == signs[0]).argmin()) or _PARTS
        begin, end = float(times[after - 1]), float(times[after])
    return (begin + end) / 2


@dataclass(frozen=True)
class _Low:
    """A local minimum of the distance to the focus."""

    piece: Piece
    begin: float
    """s, a time before it; that of the minimum once it is located"""
    end: float
    """s, a time after it, or the same"""
    distance: float
    """m, the least that is known"""


@dataclass
class ClosestApproach(Event):
    """The first local minimum of the distance to the focus.

    It counts once the distance has risen by more than `rise`, m, above it: a bead at rest wobbles
    within the tolerance of its position.
    """

    rise: float = 0.0
    _lowest: _Low | None = field(default=None, init=False, repr=False)

    def restarted(self, state: Array, close: Array | None = None) -> Event:  # noqa: ARG002
        """Return the same event for a new run."""
        return closest_approach(self.rise)

    def occurrences(self, piece: Piece) -> Iterator[Occurrence]:
        """The minimum, when it counts.

        A minimum no deeper than a part of `rise` is located only if it is the one that counts.
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
        """Return whether distances since the lowest one are larger by enough."""
        lowest = self._lowest
        return lowest is not None and far.max(initial=0.0) > lowest.distance + self.rise

    def _located(self, low: _Low) -> _Low:
        """Return the minimum at its time."""
        if low.begin == low.end:
            return low
        time = self._root(low.piece, low.begin, low.end)
        state = low.piece.states(np.array([time]))[0]
        return _Low(low.piece, time, time, float(np.linalg.norm(state[POSITION])))

    def _values(self, piece: Piece, times: Array) -> Array:
        """Change of the distance squared, over a short time about each time."""
        apart = 1e-3 * np.diff(piece.checkpoints()).min()
        before = np.maximum(times - apart, piece.begin)
        after = np.minimum(times + apart, piece.end)
        both = np.concatenate([before, after])
        ascending = np.argsort(both)
        squared = np.empty(len(both))
        squared[ascending] = np.sum(piece.states(both[ascending])[:, POSITION] ** 2, axis=1)
        return squared[len(times) :] - squared[: len(times)]


def closest_approach(rise: float = 0.0) -> Event:
    """The first closest approach to the focus (FCA); rise: m, see `ClosestApproach`."""
    return ClosestApproach("closest approach", lambda times, _: times, direction=1, rise=rise)


def loss(distance: float) -> Event:
    """The bead is as far as `distance`, m, from the focus: the end of a run."""
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
    """The bead comes within `radius`, m, of `centre` and stays for `time`, s.

    Each a number, or with its unit.
    """
    radius, time = in_si("radius", radius, "m"), in_si("time", time, "s")
    place = numbers_in_si("centre", centre, "m", SceneError)
    return Event(
        "capture",
        lambda _, y: np.linalg.norm(y[:, POSITION] - place, axis=1) - radius,
        direction=-1, terminal=terminal, once=True, hold=time,
    )  # fmt: skip


def lens_touched(scene: Scene) -> Event | None:
    """The bead reaches the lens, a focal length before the focus; None if that is not known."""
    if scene.lens.focal_length is None:
        return None
    nearest = scene.body.support() - scene.lens.focal_length
    return Event(
        "lens", lambda _, y: y[:, 2] - nearest, direction=-1, terminal=True, ends_as="failed"
    )
