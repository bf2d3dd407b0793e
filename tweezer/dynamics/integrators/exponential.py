"""Exponential Runge-Kutta of stiff order 4 with an embedded estimate: the drag is taken exactly.

The full model is x'' = (u(x) - x')/tau with u = F/beta, and for a sphere, in the inertial frame,
w' = (m(x) - w)/tau_r: stiff, but linear and constant. Applied to them, with
u = sum u_k s^k/(k! h^k) in the step from s = 0 to h, the method of Hochbruck and Ostermann (SIAM J.
Numer. Anal. 43:1069 (2005), five stages) is

    x(s) = x + tau (1 - e^(-s/tau)) v + sum (s^2/tau) phi_(k+2)(-s/tau) (s/h)^k u_k
    v(s) = e^(-s/tau) v + sum (s/tau) phi_(k+1)(-s/tau) (s/h)^k u_k

(phi_0 = exp, phi_(k+1) = (phi_k - 1/k!)/z; 1/k! - phi_k = -z phi_(k+1) has been put in), where the
u_k are those of the parabola through the stages at 0, h/2 and h. For h >> tau it goes over into a
classical method on x' = u; nothing is unstable at any h/tau, and the error is of order 4 whatever
h/tau is. Krogstad's method, with four stages, has an error tau h^2 beside it: measured, twice as
large at tau = 1e-3 and h = 0.1 of the trap time. The force at the end of the step, which the next
one needs anyway, in place of the one at the last stage gives a solution of order 3: their
difference estimates the error.

What the polynomial does not follow is the initial layer of a bead released off its slow velocity,
so the first step is tau/2 at most, and steps double until the layer has passed.

The orientation follows by Magnus' expansion, so |e| = 1 by construction: its first term, the angle
turned, as x above; the second by two Gauss nodes (Iserles, Norsett, Phil. Trans. R. Soc. A 357:983
(1999)).
"""

from __future__ import annotations

import functools
import math
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
    rate_of_change,
    scratch,
    signature,
    step_to_try,
)
from tweezer.errors import SceneError
from tweezer.generated import kinematics

#: Largest factor from one step to the next
_GROWTH = 4.0
#: The same in the initial layer
_GROWTH_IN_LAYER = 2.0
#: Duration of the initial layer, in relaxation times
_LAYER = 16.0
#: Order of the error estimate in the step
_ESTIMATE = 4
#: Taylor's coefficients 1/n!
_INVERSE_FACTORIALS = tuple(1.0 / math.factorial(n) for n in range(24))
#: Times of the stages, in parts of the step
_STAGES = (0.0, 0.5, 0.5, 1.0, 0.5)
#: Gauss's nodes of a step
_GAUSS = (0.5 - math.sqrt(3.0) / 6.0, 0.5 + math.sqrt(3.0) / 6.0)


class Relaxation(NamedTuple):
    """The linear part of the equations, and where things stand in the state."""

    times: Array
    """(3,) or (6,) s: tau of v, and of the angular velocity"""
    state: Array
    """(state,) of the emitted module, at rest and unturned: what u and m are evaluated at"""
    first_rate: int
    """where the velocities begin in that state"""


@named_njit(inner=True, error_model="numpy")
def _phi(z, out):  # type: ignore[no-untyped-def]
    """phi_0 to phi_4 of z <= 0."""
    if z > -1.0:
        for k in range(5):
            value = 0.0
            for n in range(18, -1, -1):
                value = value * z + _INVERSE_FACTORIALS[n + k]
            out[k] = value
        return
    out[0] = math.exp(z)
    for k in range(4):
        out[k + 1] = (out[k] - _INVERSE_FACTORIALS[k]) / z


@named_njit(inner=True, error_model="numpy")
def _moved(s, part, tau, v, u0, u1, u2, phi):  # type: ignore[no-untyped-def]
    """Displacement and velocity a time s into a step of which that is the part s/h.

    phi: of -s/tau.
    """
    u1, u2 = part * u1, part * part * u2
    per_tau = s / tau
    displacement = s * phi[1] * v + s * per_tau * (phi[2] * u0 + phi[3] * u1 + phi[4] * u2)
    velocity = phi[0] * v + per_tau * (phi[1] * u0 + phi[2] * u1 + phi[3] * u2)
    return displacement, velocity


@functools.cache
def loop() -> Any:
    """The compiled loop for one kind of light; as `explicit.loop`, with a `Relaxation`.

    y: (6,) x, v; or (16,) x, angle turned (0), v, w in the inertial frame, and e. The dense output
    holds u0, u1, u2 of v, w.
    """

    def advance(  # type: ignore[no-untyped-def]
        system, relaxation, control, y, clock, counts, records
    ):
        adaptive = by_tolerance(control)
        many = relaxation.times.size
        turns = many == 6
        tau = relaxation.times
        at, phi = scratch(system), np.empty(5)
        place, rate = relaxation.state.copy(), np.empty(relaxation.state.size)
        u, weights = np.empty((5, many)), np.empty((many, 2, 4))
        stage, new = np.empty(y.size), np.empty(y.size)
        written = 0
        _slow(system, relaxation, at, clock[0], place, rate, y, u[0])
        counts[2] += 1
        if clock[1] == 0.0:
            clock[1] = 0.5 * min(tau[0], tau[many - 1])
            if control.fixed > 0.0:
                clock[1] = min(clock[1], control.fixed)
        rejected = False
        while True:
            time = clock[0]
            step, last, why = step_to_try(control, clock, counts, records.begin.size - written)
            if why != GOING_ON:
                return written, why
            _weights(step, tau, phi, weights)
            for number in range(1, 5):
                _stage(number, weights, y, u, stage)
                there = time + _STAGES[number] * step
                _slow(system, relaxation, at, there, place, rate, stage, u[number])
            # the parabola through the stages at the begin, the middle and the end
            for i in range(many):
                last_stage, middle = u[3, i], u[4, i]
                u[1, i] = -3.0 * u[0, i] + 4.0 * middle - last_stage
                u[2, i] = 4.0 * (u[0, i] - 2.0 * middle + last_stage)
            _to(step, 1.0, tau, y, u[0], u[1], u[2], phi, new)
            _slow(system, relaxation, at, time + step, place, rate, new, u[4])
            counts[2] += 5
            in_layer = time - clock[3] < _LAYER * max(tau[0], tau[many - 1])
            growth = _GROWTH_IN_LAYER if in_layer else _GROWTH
            error = 0.0
            if adaptive:
                error = _error(control, tau, step, u, y, new, phi)
            if turns:
                turned = _turn(step, tau, y, u, phi, new, True)
                if adaptive:
                    error = max(error, turned / control.absolute[control.orientation])
            if not all_finite(u) or not all_finite(new):
                error = np.inf
                if not adaptive or not all_finite(u[0]):
                    return written, NOT_FINITE
            if error > 1.0:
                rejected = True
                counts[1] += 1
                clock[1] = next_step(step, error, clock[2], _ESTIMATE, growth, rejected)
                continue
            records.begin[written] = time
            records.length[written] = step
            for i in range(y.size):
                records.state[written, i] = y[i]
            for i in range(many):
                for k in range(3):
                    records.shape[written, k, i] = u[k, i]
            written += 1
            counts[0] += 1
            clock[0] = control.end if last else time + step
            if control.fixed > 0.0 and not last:
                clock[1] = min(growth * step, control.fixed)
            elif adaptive:
                clock[1] = next_step(step, error, clock[2], _ESTIMATE, growth, rejected)
                clock[2] = error
            rejected = False
            for i in range(y.size):
                y[i] = new[i]
            for i in range(many):
                u[0, i] = u[4, i]

    typed = signature(_RELAXATION)
    return cached_njit(typed, error_model="numpy", nogil=True)(advance)


@named_njit(inner=True, error_model="numpy")
def _weights(step, tau, phi, out):  # type: ignore[no-untyped-def]
    """For half the step and all of it: tau (1 - e^(-s/tau)), and the displacement by h phi_k of u.

    out: (velocity, half or whole, 4).
    """
    for i in range(tau.size):
        for whole in range(2):
            part = 1.0 if whole else 0.5
            if i > 0 and tau[i] == tau[i - 1]:
                for k in range(4):
                    out[i, whole, k] = out[i - 1, whole, k]
                continue
            s = part * step
            _phi(-s / tau[i], phi)
            out[i, whole, 0] = s * phi[1]
            for k in range(1, 4):
                out[i, whole, k] = s * step / tau[i] * phi[k + 1]


@named_njit(inner=True, error_model="numpy")
def _stage(number, weights, y, u, out):  # type: ignore[no-untyped-def]
    """Positions, and angles turned, of the stages 2 to 5: at h/2, h/2, h, h/2."""
    many = len(weights)
    for i in range(many):
        half, whole = weights[i, 0], weights[i, 1]
        if number == 1:
            moved = 0.5 * half[1] * u[0, i]
        elif number == 2:
            moved = (0.5 * half[1] - half[2]) * u[0, i] + half[2] * u[1, i]
        elif number == 3:
            moved = (whole[1] - 2.0 * whole[2]) * u[0, i] + whole[2] * (u[1, i] + u[2, i])
        else:
            a52 = 0.5 * half[2] - whole[3] + 0.25 * whole[2] - 0.5 * half[3]
            a54 = 0.25 * half[2] - a52
            moved = (0.5 * half[1] - 2.0 * a52 - a54) * u[0, i]
            moved += a52 * (u[1, i] + u[2, i]) + a54 * u[3, i]
        decay = whole[0] if number == 3 else half[0]
        out[i] = y[i] + decay * y[many + i] + moved


@named_njit(inner=True, error_model="numpy")
def _slow(  # type: ignore[no-untyped-def]
    system, relaxation, at, time, place, rate, y, out
):
    """u, and m, at the position in y: tau times the rates of a bead at rest."""
    for i in range(3):
        place[i] = y[i]
    rate_of_change(system, at, time, place, rate)
    for i in range(out.size):
        out[i] = relaxation.times[i] * rate[relaxation.first_rate + i]


@named_njit(inner=True, error_model="numpy")
def _to(s, part, tau, y, u0, u1, u2, phi, out):  # type: ignore[no-untyped-def]
    """Positions, angles turned and velocities a time s into a step."""
    many = tau.size
    for i in range(many):
        if i == 0 or tau[i] != tau[i - 1]:
            _phi(-s / tau[i], phi)
        moved, velocity = _moved(s, part, tau[i], y[many + i], u0[i], u1[i], u2[i], phi)
        out[i] = y[i] + moved
        out[many + i] = velocity


@named_njit(inner=True, error_model="numpy")
def _weight_of_last_stage(step, tau, phi):  # type: ignore[no-untyped-def]
    """Of u at the last stage: in the displacement, and in what the velocity still brings.

    phi: of -step/tau.
    """
    of_displacement = step * step / tau * abs(4.0 * phi[4] - phi[3])
    return of_displacement + step * abs(4.0 * phi[3] - phi[2])


@named_njit(inner=True, error_model="numpy")
def _error(control, tau, step, u, y, new, phi):  # type: ignore[no-untyped-def]
    """Of the positions, over the tolerances: what the force at the end makes of the last stage."""
    squared = 0.0
    for i in range(3):
        if i == 0 or tau[i] != tau[i - 1]:
            _phi(-step / tau[i], phi)
        off = _weight_of_last_stage(step, tau[i], phi) * (u[4, i] - u[3, i])
        scale = control.absolute[i] + control.relative * max(abs(y[i]), abs(new[i]))
        squared += (off / scale) ** 2
    return math.sqrt(squared / 3.0)


@named_njit(inner=True, error_model="numpy")
def turn(w1, w2, w3, e, out):  # type: ignore[no-untyped-def]
    """out = exp(w/2) e, (4,): an orientation turned by an angle about inertial axes (A.2).

    out may be `e`.
    """
    size = math.sqrt(w1 * w1 + w2 * w2 + w3 * w3)
    c = math.cos(0.5 * size)
    over = 0.5 - size * size / 48.0 if size < 1e-4 else math.sin(0.5 * size) / size
    r1, r2, r3 = over * w1, over * w2, over * w3
    e0, e1, e2, e3 = e[0], e[1], e[2], e[3]
    out[0] = c * e0 - r1 * e1 - r2 * e2 - r3 * e3
    out[1] = c * e1 + r1 * e0 + r2 * e3 - r3 * e2
    out[2] = c * e2 + r2 * e0 + r3 * e1 - r1 * e3
    out[3] = c * e3 + r3 * e0 + r1 * e2 - r2 * e1
    # the same rounding, step after step, would add up: one step of Newton to 1/|e|
    squared = out[0] ** 2 + out[1] ** 2 + out[2] ** 2 + out[3] ** 2
    for i in range(4):
        out[i] *= 1.5 - 0.5 * squared


@named_njit(inner=True, error_model="numpy")
def _turn(s, tau, y, u, phi, out, whole):  # type: ignore[no-untyped-def]
    """Put the orientation a time s into a step into `out`; returns what the angle may be off.

    whole: s is the step. y, out: (16,), e last.
    """
    w = np.empty((2, 3))
    angle = np.empty(3)
    for i in range(3):
        k = 3 + i
        for node in range(2):
            _phi(-_GAUSS[node] * s / tau[k], phi)
            _, w[node, i] = _moved(
                _GAUSS[node] * s, _GAUSS[node], tau[k], y[6 + k], u[0, k], u[1, k], u[2, k], phi
            )
        _phi(-s / tau[k], phi)
        angle[i], _ = _moved(s, 1.0, tau[k], y[6 + k], u[0, k], u[1, k], u[2, k], phi)
    by = math.sqrt(3.0) / 12.0 * s * s
    second = np.empty(3)
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        second[i] = -by * (w[0, j] * w[1, k] - w[0, k] * w[1, j])
        angle[i] += second[i]
    size = math.sqrt(angle[0] ** 2 + angle[1] ** 2 + angle[2] ** 2)
    turn(angle[0], angle[1], angle[2], y[12:], out[12:])
    out[3] = out[4] = out[5] = 0.0
    # the next term is smaller than the second by the angle; and what the light may be off
    bound = math.sqrt(second[0] ** 2 + second[1] ** 2 + second[2] ** 2) * size
    if whole:
        for i in range(3, 6):
            _phi(-s / tau[i], phi)
            bound += _weight_of_last_stage(s, tau[i], phi) * abs(u[4, i] - u[3, i])
    return bound


@cached_njit(error_model="numpy")
def sample(times, begin, length, state, shape, tau, out):  # type: ignore[no-untyped-def]
    """States as the loop has them at `times`, ascending, from the steps that hold them."""
    phi = np.empty(5)
    step, many = 0, tau.size
    for at in range(times.size):
        while step + 1 < begin.size and times[at] >= begin[step + 1]:
            step += 1
        s = times[at] - begin[step]
        part = s / length[step]
        u = np.zeros((3, many))
        for i in range(many):
            u[0, i] = shape[step, 0, i]
            u[1, i] = part * shape[step, 1, i]
            u[2, i] = part * part * shape[step, 2, i]
        _to(s, 1.0, tau, state[step], u[0], u[1], u[2], phi, out[at])
        if many == 6:
            _turn(s, tau, state[step], u, phi, out[at], False)


class Exponential:
    """The method."""

    def bound(self, equations: Equations) -> Bound:
        """The method bound to equations of motion.

        Raises `SceneError` for those whose drag it cannot take exactly.
        """
        if not equations.takes_drag_exactly:
            raise SceneError(
                "simulation.method = 'exponential': needs velocities in the state, a sphere, a "
                "drag that is the same everywhere, and forces that do not look at the orientation, "
                f"which {equations.name} has not"
            )
        relaxation = equations.relaxation
        columns = {name: i for i, name in enumerate(equations.module.STATE)}

        def states(records: Records, times: Array) -> Array:
            out = np.empty((len(times), records.state.shape[1]))
            sample(times, *records, relaxation.times, out)
            return _emitted(out, columns)

        start = _in_inertial_frame(equations.initial_state, columns)
        return Bound(loop(), relaxation, start, (3, len(relaxation.times)), states)


EXPONENTIAL = Exponential()


def _in_inertial_frame(state: Array, columns: dict[str, int]) -> Array:
    """(x, v), or (x, 0, v, omega, e) with omega in the inertial frame, of an emitted state."""
    x, v = (state[columns[name] : columns[name] + 3] for name in ("q1", "v1"))
    if "e0" not in columns:
        return np.array([*x, *v])
    e = state[columns["e0"] : columns["e0"] + 4]
    omega = state[columns["omega1"] : columns["omega1"] + 3]
    return np.array([*x, 0.0, 0.0, 0.0, *v, *_rotation(e) @ omega, *e])


def _emitted(y: Array, columns: dict[str, int]) -> Array:
    """The inverse of `_in_inertial_frame`, (n, state)."""
    states = np.empty((len(y), len(columns)))
    if "e0" not in columns:
        parts = {"q1": y[:, :3], "v1": y[:, 3:]}
    else:
        e = y[:, 12:]
        omega = np.array([row[9:12] @ _rotation(row[12:]) for row in y]).reshape(-1, 3)
        parts = {"q1": y[:, :3], "e0": e, "v1": y[:, 6:9], "omega1": omega}
    for name, values in parts.items():
        states[:, columns[name] : columns[name] + values.shape[1]] = values
    return states


def _rotation(e: Array) -> Array:
    """R (A.2)."""
    matrix = np.empty((3, 3))
    kinematics.rotation_matrix(np.ascontiguousarray(e), matrix)
    return matrix


_vector = np.zeros(0)
_RELAXATION = typeof(Relaxation(_vector, _vector, 0))
