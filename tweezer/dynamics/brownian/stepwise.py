"""Events of thermal motion: detected at the ends of steps, located by linear interpolation.

A Brownian path that reaches a surface crosses it many times. If it crosses the surface and returns
within one step, this is not detected. A first crossing is therefore found too late: without
inertia, as if the surface were further away by 0.58 sqrt(2 D h), for steps h and the diffusion
coefficient D (M. Broadie, P. Glasserman, S. Kou, Mathematical Finance 7, 325 (1997)).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tweezer.dynamics.events import Event, Occurrence, ending
from tweezer.dynamics.layout import Layout
from tweezer.values.arrays import Array


@dataclass(frozen=True)
class Line:
    """Part of a motion, straight from the end of each step to the end of the next."""

    times: Array
    """(n,) ends of the steps, s"""
    samples: Array
    """(n, columns) samples at these times"""

    @property
    def begin(self) -> float:
        """Time of the first sample, s."""
        return float(self.times[0])

    @property
    def end(self) -> float:
        """Time of the last sample, s."""
        return float(self.times[-1])

    def checkpoints(self) -> Array:
        """Return the ends of steps, (n,) s."""
        return self.times

    def states(self, times: Array) -> Array:
        """Return samples at `times` (n,), s, by linear interpolation, (n, columns)."""
        return np.column_stack([np.interp(times, self.times, each) for each in self.samples.T])


class Watch:
    """Events of a run, located while it proceeds."""

    def __init__(self, events: Sequence[Event], start: Array, layout: Layout) -> None:
        self._events = [event.restarted(start, layout) for event in events]
        self.happened: list[Occurrence] = []
        self.status, self.message = "", ""
        """of a run that an event ended; empty before"""
        self.last: tuple[float, Array] | None = None
        """time, s, and sample of the event that ended the run"""

    def look(self, line: Line) -> None:
        """Record the events in a part of the motion, up to one that ends the run."""
        found = [(event, each) for event in self._events for each in event.occurrences(line)]
        for event, each in sorted(found, key=lambda pair: pair[1].certain):
            self.happened.append(each)
            if event.terminal:
                self.status, self.message = event.ends_as, ending(event, each.certain)
                self.last = each.certain, line.states(np.array([each.certain]))[0]
                break
        self.happened.sort(key=lambda each: each.time)
