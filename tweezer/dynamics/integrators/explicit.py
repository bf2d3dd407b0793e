"""Explicit Runge-Kutta methods with an embedded error estimate and dense output.

A method is a `Tableau`; the loop is the same for all. Hairer, Norsett, Wanner, "Solving ordinary
differential equations I", II.4-II.6.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numba import typeof

from tweezer.compiled import cached_njit, named_njit
from tweezer.dynamics.integrators.system import (
    GOING_ON,
    NOT_FINITE,
    Array,
    Bound,
    Equations,
    Records,
    all_finite,
    by_tolerance,
    next_step,
    put_on_constraints,
    rate_of_change,
    scratch,
    signature,
    step_to_try,
)

#: a step may grow by this factor
_GROWTH = 5.0
#: Factor by which a rate for the dense output alone may be larger than the others
_WILD = 8.0
#: Factor by which a step is shortened if its dense output misses the motion
_SHORTER = 0.3


class Tableau(NamedTuple):
    """Coefficients of a method of s stages; row s stands for the rate at the end of the step."""

    order: int
    """order of the solution: its error in a run is proportional to this power of the step"""
    estimate: int
    """power of the step with which the error estimate of one step scales"""
    c: Array
    """(s + 1 + x,) times of the s stages, of the end of the step and of the x extra stages, as
    fractions of the step
    """
    a: Array
    """(s, s) weights of the earlier rates in the state of each stage"""
    b: Array
    """(s,) weights of the rates in the state at the end of the step"""
    error: Array
    """(s + 1,) weights of the rates in the error estimate E"""
    damping: Array
    """(s + 1,) weights of the rates in a second estimate E3, if the error is E^2/sqrt(E^2 + 0.01
    E3^2); or (0,)
    """
    extra: Array
    """(x, s + 1 + x) weights of the rates in the states of the extra stages, which only the dense
    output needs
    """
    dense: Array
    """(degree, s + 1 + x) weights of the rates in the dense output: row p has the coefficient of
    theta^(p + 1), where theta is the fraction of the step
    """


@functools.cache
def loop() -> Any:
    """Return the compiled loop, `advance(system, tableau, control, y, clock, counts, records)`.

    It returns the number of records written and the status with which it stopped. `y` is the
    (state,) at the time clock[0]. `clock` (3,) contains the time (s), the step to try (s; if 0, the
    loop chooses it) and the error of the last step over the tolerance. `counts` (3,) are steps,
    rejected steps and force calls. All three are updated in place, so a further call continues the
    run.
    """

    def advance(  # type: ignore[no-untyped-def]
        system, tableau, control, y, clock, counts, records
    ):
        """Take steps until the run ends or the records are full; see `loop`.

        k: (stages, state) rates; the last rate of a step is the first one of the next.
        """
        adaptive = by_tolerance(control)
        n, stages = y.size, tableau.b.size
        k = np.zeros((stages + 1 + len(tableau.extra), n))
        inner, new = np.empty(n), np.empty(n)
        at = scratch(system)
        written = 0
        rate_of_change(system, at, clock[0], y, k[0])
        counts[2] += 1
        if clock[1] == 0.0:
            clock[1] = control.fixed
            if adaptive:
                clock[1] = _first_step(system, at, tableau, control, clock[0], y, k[0], inner, new)
                counts[2] += 1
        rejected = False
        while True:
            time = clock[0]
            step, last, why = step_to_try(control, clock, counts, records.begin.size - written)
            if why != GOING_ON:
                return written, why
            for stage in range(1, stages):
                _combined(y, step, k, tableau.a[stage], stage, inner)
                rate_of_change(system, at, time + tableau.c[stage] * step, inner, k[stage])
            _combined(y, step, k, tableau.b, stages, new)
            rate_of_change(system, at, time + step, new, k[stages])
            counts[2] += stages
            error = _error(tableau, control, y, new, step, k) if adaptive else 0.0
            if not (all_finite(new) and all_finite(k[stages])):
                error = np.inf
                if not adaptive or not all_finite(k[0]):
                    return written, NOT_FINITE
            if error > 1.0:
                rejected = True
                counts[1] += 1
                clock[1] = next_step(step, error, clock[2], tableau.estimate, _GROWTH, rejected)
                continue
            for extra in range(len(tableau.extra)):
                stage = stages + 1 + extra
                _combined(y, step, k, tableau.extra[extra], stage, inner)
                rate_of_change(system, at, time + tableau.c[stage] * step, inner, k[stage])
                counts[2] += 1
            if adaptive and not system.uniform and _wild(tableau, control, y, step, k):
                rejected = True
                counts[1] += 1
                clock[1] = _SHORTER * step
                continue
            records.begin[written] = time
            records.length[written] = step
            for i in range(n):
                records.state[written, i] = y[i]
                for power in range(len(tableau.dense)):
                    total = 0.0
                    for stage in range(len(k)):
                        total += tableau.dense[power, stage] * k[stage, i]
                    records.shape[written, power, i] = step * total
            written += 1
            counts[0] += 1
            clock[0] = control.end if last else time + step
            if adaptive:
                clock[1] = next_step(step, error, clock[2], tableau.estimate, _GROWTH, rejected)
                clock[2] = error
            rejected = False
            for i in range(n):
                y[i] = new[i]
                k[0, i] = k[stages, i]
            if control.orientation >= 0:
                put_on_constraints(y, control.orientation, control.euler_rates)
                rate_of_change(system, at, clock[0], y, k[0])
                counts[2] += 1

    typed = signature(_TABLEAU)
    return cached_njit(typed, error_model="numpy", nogil=True)(advance)


@named_njit(inner=True, error_model="numpy")
def _wild(tableau, control, y, step, k):  # type: ignore[no-untyped-def]
    """Return whether a rate of the extra stages is far larger than those that determine the error.

    This happens where an extra stage, used for the dense output only, is evaluated behind a wall
    that the other stages did not reach. `k` (stages, state) are rates, `step` is in s, and `y` is
    the initial (state,).
    """
    first = len(k) - len(tableau.extra)
    for i in range(y.size):
        most = 0.0
        for stage in range(first):
            most = max(most, abs(k[stage, i]))
        allowed = _WILD * most + (control.absolute[i] + control.relative * abs(y[i])) / step
        for stage in range(first, len(k)):
            if not abs(k[stage, i]) <= allowed:
                return True
    return False


@named_njit(inner=True, error_model="numpy")
def _combined(y, step, k, weights, stages, out):  # type: ignore[no-untyped-def]
    """Fill `out` (state,) with y + step times the weighted sum of the first `stages`
    rates in `k`.
    """
    for i in range(y.size):
        total = 0.0
        for stage in range(stages):
            total += weights[stage] * k[stage, i]
        out[i] = y[i] + step * total


@named_njit(inner=True, error_model="numpy")
def _error(tableau, control, y, new, step, k):  # type: ignore[no-untyped-def]
    """Return the root mean square of the error of a step over the tolerances of the state.

    `y` and `new` are the (state,) before and after the step of length `step` (s). `k` (stages,
    state) are rates.
    """
    squared = damping = 0.0
    for i in range(y.size):
        scale = control.absolute[i] + control.relative * max(abs(y[i]), abs(new[i]))
        of_state = 0.0
        for stage in range(tableau.error.size):
            of_state += tableau.error[stage] * k[stage, i]
        squared += (of_state / scale) ** 2
        if tableau.damping.size > 0:
            of_state = 0.0
            for stage in range(tableau.damping.size):
                of_state += tableau.damping[stage] * k[stage, i]
            damping += (of_state / scale) ** 2
    if squared == 0.0:
        return 0.0
    if tableau.damping.size > 0:
        return step * squared / np.sqrt((squared + 0.01 * damping) * y.size)
    return step * np.sqrt(squared / y.size)


@named_njit(inner=True, error_model="numpy")
def _first_step(  # type: ignore[no-untyped-def]
    system, at, tableau, control, time, y, rate, inner, new
):
    """Return the length of the first step, s, by Hairer's algorithm (section II.4 of the book).

    It compares the state, its rate and the change of the rate over a trial step with the
    tolerances. `at` is the workspace of the force, and `y` and `rate` are the initial (state,) and
    its rate. `inner` and `new` (state,) are workspace.
    """
    size = speed = 0.0
    for i in range(y.size):
        scale = control.absolute[i] + control.relative * abs(y[i])
        size += (y[i] / scale) ** 2
        speed += (rate[i] / scale) ** 2
    size, speed = np.sqrt(size / y.size), np.sqrt(speed / y.size)
    step = 1e-6 * control.end if size < 1e-5 or speed < 1e-5 else 0.01 * size / speed
    step = min(step, control.end)
    for i in range(y.size):
        inner[i] = y[i] + step * rate[i]
    rate_of_change(system, at, time + step, inner, new)
    change = 0.0
    for i in range(y.size):
        scale = control.absolute[i] + control.relative * abs(y[i])
        change += ((new[i] - rate[i]) / scale) ** 2
    change = np.sqrt(change / y.size) / step
    fastest = max(speed, change)
    if not fastest > 1e-15:
        return min(max(1e-6 * control.end, 1e-3 * step), control.end)
    return min(100.0 * step, (0.01 / fastest) ** (1.0 / tableau.estimate), control.end)


@cached_njit(error_model="numpy")
def sample(times, begin, length, state, shape, out):  # type: ignore[no-untyped-def]
    """Fill `out` (n, state) with the states at ascending `times` (n,), s, from recorded steps.

    begin, length, state, shape: the fields of `Records`; the dense output of a step is a polynomial
    in the fraction of the step.
    """
    step = 0
    for at in range(times.size):
        while step + 1 < begin.size and times[at] >= begin[step + 1]:
            step += 1
        place = (times[at] - begin[step]) / length[step]
        for i in range(state.shape[1]):
            total = 0.0
            for power in range(shape.shape[1] - 1, -1, -1):
                total = (total + shape[step, power, i]) * place
            out[at, i] = state[step, i] + total


@dataclass(frozen=True)
class Explicit:
    """Explicit Runge-Kutta method, given by its tableau."""

    tableau: Tableau

    def bound(self, equations: Equations) -> Bound:
        """Return the method bound to equations of motion."""
        start = equations.initial_state if equations.begin is None else equations.begin.inner
        shape = len(self.tableau.dense), len(start)
        return Bound(loop(), self.tableau, start.copy(), shape, _states)


def _states(records: Records, times: Array) -> Array:
    """Return the states (n, state) at ascending times, s, from the records of an
    explicit method.
    """
    out = np.empty((len(times), records.state.shape[1]))
    sample(times, *records, out)
    return out


_vector, _matrix = np.zeros(0), np.zeros((0, 0))
_TABLEAU = typeof(Tableau(0, 0, _vector, _matrix, _vector, _vector, _vector, _matrix, _matrix))
