"""A motion followed by a compiled method: its steps, and the states between them."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tweezer.dynamics import integrators
from tweezer.dynamics.integrators import Bound, Control, Records
from tweezer.dynamics.needs import OF_METHOD, check
from tweezer.scene.choices import METHODS

if TYPE_CHECKING:
    from tweezer.dynamics.models import EquationsOfMotion

Array = NDArray[np.float64]

#: Number of steps of the first call of a loop
_FIRST_STEPS = 128
#: Largest number of steps of a call; what ends a run early is seen between calls
_MOST_STEPS = 4096
#: Part of the time of a kink at which steps end, so that the force after it is not evaluated
BEFORE = 1 - 1e-14


@dataclass(frozen=True)
class Steps:
    """Some steps on end."""

    bound: Bound
    """method that took them"""
    records: Records
    end: float
    """s"""

    @property
    def begin(self) -> float:
        """s"""
        return float(self.records.begin[0])

    def checkpoints(self) -> Array:
        """Ascending times from begin to end, four to a step."""
        records = self.records
        within = records.begin[:, None] + records.length[:, None] * np.array([0, 0.25, 0.5, 0.75])
        return np.append(within, self.end)

    def step_lengths(self, end: float) -> Array:
        """s, of the steps that begin before `end`; the last one ends there."""
        records = self.records
        return np.minimum(records.length, end - records.begin)[records.begin < end]

    def states(self, times: Array) -> Array:
        """States of the emitted module at ascending `times` within the piece, (n, state)."""
        return self.bound.states(self.records, np.ascontiguousarray(times, dtype=np.float64))

    def inner(self, time: float) -> Array:
        """Return the state at a time as the loop has it, (inner,)."""
        states = self.bound.inner or self.bound.states
        return states(self.records, np.array([time]))[0]


class Solver:
    """One compiled method bound to equations of motion; `advance` goes on from where it is."""

    def __init__(
        self,
        equations: EquationsOfMotion,
        method: str,
        *,
        end: float,
        fixed: float = 0.0,
        prescribed: Array | None = None,
        tightened: float = 1.0,
    ) -> None:
        check(equations.problem, OF_METHOD)
        simulation = equations.scene.simulation
        self._equations = equations
        self._bound: Bound = METHODS[method].load().bound(equations)
        gradient = self._bound.gradient or "force_gradient" in equations.module.RHS_INPUTS
        system = equations.system(gradient=gradient, rates=self._bound.rates)
        if self._bound.force is not None:
            system = system._replace(force=self._bound.force)
        self.control = Control(
            max(simulation.relative_tolerance * tightened, 1e-13),
            equations.absolute_tolerance * tightened,
            fixed,
            np.zeros(0) if prescribed is None else prescribed,
            end,
            simulation.most_force_calls,
            equations.layout.first("orientation"),
            equations.layout.first("euler_rates"),
        )
        self._y = self._bound.start
        self._clock = np.array([equations.begin_time, 0.0, 0.0])
        self._counts = np.array([0, 0, self._bound.calls])
        self._kinks = [each for each in equations.force.kinks(end) if each > self.time]
        self._call = functools.partial(self._bound.loop, system, self._bound.how)
        self._room = _FIRST_STEPS

    @property
    def time(self) -> float:
        """s, reached so far."""
        return float(self._clock[0])

    @property
    def steps(self) -> int:
        """Steps taken so far."""
        return int(self._counts[0])

    @property
    def rejected(self) -> int:
        """Steps that missed the tolerances."""
        return int(self._counts[1])

    @property
    def force_calls(self) -> int:
        """Places at which the force was evaluated so far."""
        return int(self._counts[2])

    def advance(self) -> tuple[Steps | None, int]:
        """Some more steps, if any, and why they ended: `integrators.REACHED` and so on."""
        room, n = self._room, len(self._y)
        shapes = (room,), (room,), (room, n), (room, *self._bound.shape)
        records = Records(*map(np.empty, shapes))
        end = self._kinks[0] * BEFORE if self._kinks else self.control.end
        control = self.control._replace(end=end)
        written, why = self._call(control, self._y, self._clock, self._counts, records)
        self._room = min(2 * room, _MOST_STEPS)
        if why == integrators.REACHED and self._kinks:
            self._clock[0] = self._kinks.pop(0)
            self._clock[1:] = 0.0
            why = integrators.FULL
        if not written:
            return None, why
        taken = Records(*(array[:written] for array in records))
        return Steps(self._bound, taken, self.time), why
