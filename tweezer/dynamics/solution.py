"""Integration by a compiled method: its steps, and the states between them."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from tweezer.dynamics import integrators
from tweezer.dynamics.integrators import Bound, Control, Records
from tweezer.dynamics.needs import OF_METHOD, check
from tweezer.scene.choices import METHODS
from tweezer.values.arrays import Array

if TYPE_CHECKING:
    from tweezer.dynamics.models import EquationsOfMotion


#: Number of steps of the first call of a loop
_FIRST_STEPS = 128
#: Largest number of steps of a call; what ends a run early is seen between calls
_MOST_STEPS = 4096
#: Part of the time of a kink at which steps end, so that the force after it is not evaluated
BEFORE = 1 - 1e-14


@dataclass(frozen=True)
class Steps:
    """Consecutive steps of a compiled method; implements `Piece`."""

    bound: Bound
    """method that took them"""
    records: Records
    """beginning, length, state and dense output of each step"""
    end: float
    """time at the end of the last step, s"""

    @property
    def begin(self) -> float:
        """Time at the beginning of the first step, s."""
        return float(self.records.begin[0])

    def checkpoints(self) -> Array:
        """Return ascending times from the beginning to the end, four in each step, s."""
        records = self.records
        within = records.begin[:, None] + records.length[:, None] * np.array([0, 0.25, 0.5, 0.75])
        return np.append(within, self.end)

    def step_lengths(self, end: float) -> Array:
        """Return the lengths of the steps that begin before `end`, s; the last one is cut off
        there.
        """
        records = self.records
        return np.minimum(records.length, end - records.begin)[records.begin < end]

    def states(self, times: Array) -> Array:
        """Return states in the form of the emitted equations at ascending `times`, s,
        (n, state).
        """
        return self.bound.states(self.records, np.ascontiguousarray(times, dtype=np.float64))

    def inner(self, time: float) -> Array:
        """Return the state at a time, s, in the form that the method's loop uses, (inner,)."""
        states = self.bound.inner or self.bound.states
        return states(self.records, np.array([time]))[0]


class Solver:
    """Compiled method bound to equations of motion; `advance` continues from the present time."""

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
        """Time reached so far, s."""
        return float(self._clock[0])

    @property
    def steps(self) -> int:
        """Number of steps completed so far."""
        return int(self._counts[0])

    @property
    def rejected(self) -> int:
        """Number of steps repeated because their error was too large."""
        return int(self._counts[1])

    @property
    def force_calls(self) -> int:
        """Number of force evaluations so far."""
        return int(self._counts[2])

    def advance(self) -> tuple[Steps | None, int]:
        """Take some more steps; return them, or None, and the status: `integrators.REACHED` and so
        on.

        `FULL` means that the motion continues. Stepping pauses at kinks of the force, where the
        method restarts.
        """
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
