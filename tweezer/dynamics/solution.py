"""A motion followed by a compiled method: its steps, and the states between them."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tweezer.compiled import address
from tweezer.dynamics import integrators
from tweezer.dynamics.integrators import Control, Records, System
from tweezer.errors import SceneError
from tweezer.forces.force import bound
from tweezer.generated import kinematics

if TYPE_CHECKING:
    from tweezer.dynamics.models import EquationsOfMotion

Array = NDArray[np.float64]

#: steps of the first call of a loop, and most of one: what ends a run early is seen between calls
_FIRST_STEPS, _MOST_STEPS = 128, 4096
#: steps end this little before a kink of the force: what it is from then on is not looked at
BEFORE = 1 - 1e-15


@dataclass(frozen=True)
class Piece:
    """Some steps on end."""

    solver: Solver
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
        return self.solver.states(self.records, np.ascontiguousarray(times, dtype=np.float64))


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
        simulation = equations.scene.simulation
        self._equations = equations
        state = equations.module.STATE
        gradient = "force_gradient" in equations.module.RHS_INPUTS
        oriented = equations.force.oriented
        system = System(
            bound(equations.force, gradient=gradient),
            address(equations.module.rates, integrators.RATES),
            equations.params,
            state.index("e0") if oriented and "e0" in state else -1,
        )
        self.control = Control(
            max(simulation.relative_tolerance * tightened, 1e-13),
            equations.absolute_tolerance * tightened,
            fixed,
            np.zeros(0) if prescribed is None else prescribed,
            end,
            simulation.most_force_calls,
            state.index("e0") if "e0" in state else -1,
            state.index("edot0") if "edot0" in state else -1,
        )
        how: Any
        if method == "exponential":
            if not equations.takes_drag_exactly:
                raise SceneError(
                    "simulation.method = 'exponential': needs velocities in the state and a "
                    f"sphere, which {equations.name} has not"
                )
            self._exponential = True
            how = equations.relaxation
            self._tau = how.times
            loop = integrators.exponential.loop()
            self._y = self._to_exponential(equations.initial_state)
            shape = (3, len(how.times))
        else:
            self._exponential = False
            how = integrators.TABLEAUX[method]
            loop = integrators.explicit.loop()
            self._y = equations.initial_state.copy()
            shape = (len(how.dense), len(self._y))
        self._shape = shape
        self._clock = np.zeros(4)
        self._counts = np.zeros(3, np.int64)
        self._kinks = equations.force.kinks(end).tolist()
        self._call = functools.partial(loop, system, how)
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

    def advance(self) -> tuple[Piece | None, int]:
        """Some more steps, if any, and why they ended: `integrators.REACHED` and so on."""
        room, n = self._room, len(self._y)
        records = Records(
            np.empty(room), np.empty(room), np.empty((room, n)), np.empty((room, *self._shape))
        )
        end = self._kinks[0] * BEFORE if self._kinks else self.control.end
        control = self.control._replace(end=end)
        written, why = self._call(control, self._y, self._clock, self._counts, records)
        self._room = min(2 * room, _MOST_STEPS)
        if why == integrators.REACHED and self._kinks:
            self._clock[0] = self._clock[3] = self._kinks.pop(0)
            self._clock[1:3] = 0.0
            why = integrators.FULL
        if not written:
            return None, why
        return Piece(self, Records(*(array[:written] for array in records)), self.time), why

    def states(self, records: Records, times: Array) -> Array:
        """See `Piece.states`."""
        out = np.empty((len(times), records.state.shape[1]))
        if self._exponential:
            integrators.exponential.sample(times, *records, self._tau, out)
            return self._from_exponential(out)
        integrators.explicit.sample(times, *records, out)
        return out

    def _to_exponential(self, state: Array) -> Array:
        """(x, v) or (x, 0, v, omega, e), omega in the inertial frame."""
        if len(state) == 6:
            return state.copy()
        e = state[3:7]
        omega = _rotation(e) @ state[10:13]
        return np.array([*state[:3], 0.0, 0.0, 0.0, *state[7:10], *omega, *e])

    def _from_exponential(self, y: Array) -> Array:
        if y.shape[1] == 6:
            return y
        states = np.concatenate([y[:, :3], y[:, 12:], y[:, 6:9], y[:, 9:12]], axis=1)
        for state in states:
            state[10:] = state[10:] @ _rotation(state[3:7])
        return states


def _rotation(e: Array) -> Array:
    """R (A.2)."""
    matrix = np.empty((3, 3))
    kinematics.rotation_matrix(np.ascontiguousarray(e), matrix)
    return matrix
