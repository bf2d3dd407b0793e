"""Integration in time by SciPy's solvers, one step at a time.

Stepping by hand, rather than through `solve_ivp`, lets a run report progress, stop when the
bead is lost, and keep what it has when it is interrupted or fails.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import BDF, DOP853, LSODA, RK45, Radau
from scipy.optimize import brentq

from tweezer.dynamics.models import EquationsOfMotion
from tweezer.errors import IntegrationError

Array = NDArray[np.float64]

SOLVERS: dict[str, Any] = {
    "RK45": RK45,
    "DOP853": DOP853,
    "Radau": Radau,
    "BDF": BDF,
    "LSODA": LSODA,
}
#: solvers that take the Jacobian of the right-hand side
IMPLICIT = frozenset({"Radau", "BDF", "LSODA"})
#: solvers that begin each step from the state alone, so that it can be put back on its constraints;
#: the others carry differences of past states, and their results are put back on output
ONE_STEP = frozenset({"RK45", "DOP853", "Radau"})


@dataclass(frozen=True)
class Integration:
    """States at those of the times asked for that were reached."""

    times: Array
    """(n,) s"""
    states: Array
    """(n, state)"""
    steps: int
    status: str
    """"complete", "lost", "interrupted" or "failed" """
    message: str
    """what ended the run, if it did not reach the last time"""


def integrate(
    equations: EquationsOfMotion,
    times: Array,
    escape: Callable[[Array], float],
    progress: Callable[[float], None] | None = None,
) -> Integration:
    """Integrate from times[0] to times[-1], with output at `times` by the solver's dense output.

    escape: function of the state that becomes positive where the bead is lost, which ends the run;
    the moment is located on the dense output and is the last time returned.
    progress: called with the time reached.
    An interrupt (Ctrl-C) or a failure ends the run early, marked, with what was reached.
    """
    simulation = equations.scene.simulation
    options: dict[str, Any] = {}
    if simulation.method in IMPLICIT:
        options["jac"] = equations.jacobian
    sampled: list[Array] = [equations.initial_state[None]]
    reached, steps = 1, 0
    status, message = "complete", ""
    try:
        solver = SOLVERS[simulation.method](
            equations.rhs,
            times[0],
            equations.initial_state,
            times[-1],
            rtol=simulation.relative_tolerance,
            atol=equations.absolute_tolerance,
            **options,
        )
        while solver.status == "running":
            failure = solver.step()
            if solver.status == "failed":
                raise IntegrationError(failure or "the solver gave up")
            steps += 1
            if escape(solver.y) > 0:
                end, at_end = _escape(escape, solver)
                inside = max(reached, int(np.searchsorted(times, end, side="left")))
                if inside > reached:
                    sampled.append(solver.dense_output()(times[reached:inside]).T)
                times = np.append(times[:inside], end)
                sampled.append(at_end[None])
                reached = len(times)
                status, message = "lost", f"the bead left the trap at {end:.6g} s"
                break
            last = int(np.searchsorted(times, solver.t, side="right"))
            if last > reached:
                sampled.append(solver.dense_output()(times[reached:last]).T)
                reached = last
            if progress:
                progress(float(solver.t))
            if simulation.method in ONE_STEP:
                solver.y = equations.on_constraints(solver.y)
    except KeyboardInterrupt:
        status, message = "interrupted", f"interrupted at {times[reached - 1]:.6g} s"
    except (IntegrationError, ArithmeticError, np.linalg.LinAlgError) as error:
        status = "failed"
        message = f"failed after {times[reached - 1]:.6g} s: {error}"
    return Integration(times[:reached], np.concatenate(sampled), steps, status, message)


def _escape(escape: Callable[[Array], float], solver: Any) -> tuple[float, Array]:
    """When `escape` becomes positive within the solver's last step, and the state then."""
    dense = solver.dense_output()
    begin, end = solver.t_old, solver.t
    # rounding can put an end of the step on the other side in the dense output
    if escape(dense(begin)) >= 0:
        return begin, dense(begin)
    if escape(dense(end)) > 0:
        end = brentq(lambda t: escape(dense(t)), begin, end)
    return end, dense(end)
