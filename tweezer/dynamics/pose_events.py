"""Events of poses: capture in position and orientation, and flips of a body."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from tweezer.dynamics.events import EULER_PARAMETERS, Event, Occurrence, Piece
from tweezer.dynamics.layout import POSITION, Layout
from tweezer.scene.arguments import in_si, numbers_in_si
from tweezer.values.arrays import Array
from tweezer.values.errors import SceneError
from tweezer.values.units import QuantitiesLike, QuantityLike

#: Allowed radii, m, and times, s, of a capture
_DISTANCES, _TIMES = (1e-12, 1.0), (1e-15, 1e6)


def capture(
    radius: QuantityLike,
    time: QuantityLike,
    centre: QuantitiesLike = (0.0, 0.0, 0.0),
    *,
    direction: QuantitiesLike | None = None,
    angle: QuantityLike | None = None,
    axis: QuantitiesLike | None = None,
    terminal: bool = False,
) -> Event:
    """Return the event that the bead comes within `radius` of `centre` and stays there for `time`.

    With a `direction`, an axis of the body must also stay parallel to it, within `angle`.

    Parameters
    ----------
    radius : float or str
        Largest distance from `centre`, m.
    time : float or str
        Time for which the bead must stay, s. The time of the event is the time of the approach.
    centre : array_like, shape (3,), optional
        Position, m from the focus. Default: the focus.
    direction : array_like, shape (3,), optional
        Direction in the laboratory to which the axis must be parallel. Both ends of the axis count.
    angle : float or str, optional
        Largest angle between the axis and `direction`, rad. It requires `direction`. Default: 10
        degrees.
    axis : array_like, shape (3,), optional
        Axis in the body's frame. It requires `direction`. Default: its z axis.
    terminal : bool, optional
        Whether the event ends the run, once the bead has stayed for `time`.

    Returns
    -------
    Event
        Event for `tweezer.simulate(scene, events=[...])`. It counts once.

    Raises
    ------
    SceneError
        If an argument is not valid.

    Examples
    --------
    >>> event = tweezer.capture("0.3 um", "1 ms", terminal=True)
    >>> run = tweezer.simulate("silica-1um", "2 ms", events=[event])
    >>> run.status
    'ended'
    """
    radius = in_si("radius", radius, "m", *_DISTANCES)
    time = in_si("time", time, "s", *_TIMES)
    place = numbers_in_si("centre", centre, "m", SceneError)
    if place.shape != (3,) or not np.isfinite(place).all():
        raise SceneError(f"centre = {centre}: must be three finite numbers in m")

    def outside(_: Array, y: Array) -> Array:
        """Return by how much the distance from `centre` exceeds `radius`, m."""
        return np.linalg.norm(y[:, POSITION] - place, axis=1) - radius

    if direction is None:
        for name, given in (("angle", angle), ("axis", axis)):
            if given is not None:
                raise SceneError(f"{name}: requires direction")
        return Event("capture", outside, -1, terminal, once=True, hold=time)
    along, own = _unit("direction", direction), _unit("axis", (0, 0, 1) if axis is None else axis)
    largest = in_si("angle", "10 deg" if angle is None else angle, "rad", 1e-6, math.pi / 2)

    def apart(times: Array, y: Array) -> Array:
        """Return the larger of the excess distance over `radius` and the excess angle over
        `angle`.
        """
        tilt = np.arccos(np.minimum(np.abs(turned(y, own) @ along), 1.0))
        return np.maximum(outside(times, y) / radius, tilt / largest - 1)

    return Event("capture", apart, -1, terminal, once=True, hold=time, poses=True)


def flip(
    direction: QuantitiesLike = (0.0, 0.0, 1.0),
    *,
    angle: QuantityLike = "60 deg",
    axis: QuantitiesLike = (0.0, 0.0, 1.0),
    terminal: bool = False,
) -> Event:
    """Return the event that an axis of the body turns over, from one end of a direction to the
    other.

    The axis belongs to an end once it is within `angle` of it, until it is within `angle` of the
    other end. A flip therefore counts when the axis arrives, and an axis that fluctuates about
    the plane between both ends does not flip.

    Parameters
    ----------
    direction : array_like, shape (3,), optional
        Direction in the laboratory. Default: the axis of the light.
    angle : float or str, optional
        Angle between the axis and an end within which the axis has arrived, rad; less than a right
        angle.
    axis : array_like, shape (3,), optional
        Axis in the body's frame. Default: its z axis.
    terminal : bool, optional
        Whether the first flip ends the run, as for its first-passage time.

    Returns
    -------
    Event
        Event for `tweezer.simulate(scene, events=[...])`. It counts each flip.

    Raises
    ------
    SceneError
        If an argument is not valid.

    Examples
    --------
    >>> event = tweezer.flip(direction=(1, 0, 0), terminal=True)
    """
    along, own = _unit("direction", direction), _unit("axis", axis)
    least = math.cos(in_si("angle", angle, "rad", 1e-6, 0.999 * math.pi / 2))

    def at(end: float) -> Event:
        """Return the arrival at an end of the direction, +1 or -1."""

        def beyond(_: Array, y: Array) -> Array:
            """Return by how much the cosine of the angle to the end exceeds the least."""
            return end * (turned(y, own) @ along) - least

        return Event("flip", beyond, direction=1, poses=True)

    ends = at(1.0), at(-1.0)
    return Flip("flip", ends[0].value, terminal=terminal, poses=True, ends=ends)


@dataclass
class Flip(Event):
    """Arrival of an axis at the other end of a direction."""

    ends: tuple[Event, ...] = ()
    """arrival at each end"""
    _end: int | None = field(default=None, init=False, repr=False)
    """end to which the axis belongs; None before it arrived at one"""

    def restarted(self, state: Array, layout: Layout, close: Array | None = None) -> Event:
        """Return the same event for a new run."""
        ends = tuple(each.restarted(state, layout, close) for each in self.ends)
        again = Flip(self.name, self.value, terminal=self.terminal, poses=True, ends=ends)
        for end, each in enumerate(ends):
            if each.value_at(state) > 0:
                again._end = end
        return again

    def occurrences(self, piece: Piece) -> Iterator[Occurrence]:
        """Yield the flips in a piece; pieces must be passed in the order of time."""
        found = [(each, end) for end, it in enumerate(self.ends) for each in it.occurrences(piece)]
        for each, end in sorted(found, key=lambda pair: pair[0].time):
            before, self._end = self._end, end
            if before is not None and before != end:
                yield each


def turned(poses: Array, axis: Array) -> Array:
    """Return the directions (n, 3) in the laboratory of a body's axis (3,) in poses (n, 7)."""
    from scipy.spatial.transform import Rotation  # runs without such events do without

    e = poses[:, EULER_PARAMETERS]
    found: Array = Rotation.from_quat(e, scalar_first=True).apply(axis)
    return found


def _unit(name: str, vector: QuantitiesLike) -> Array:
    """Return a direction (3,) of length 1. Raises `SceneError` if it has no direction."""
    given = numbers_in_si(name, vector, "", SceneError)
    if given.shape != (3,) or not np.isfinite(given).all() or not given.any():
        raise SceneError(f"{name} = {vector}: must be three numbers that are not all zero")
    given = given / np.abs(given).max()  # so that no square overflows or vanishes
    return np.asarray(given / np.linalg.norm(given))
