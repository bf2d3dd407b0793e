"""The compiled loop over steps and samples, for every scheme and every kind of light.

Beads go in batches: the numbers, the force and the step of a whole batch in turn. The light's
kernel comes as a function pointer, called once a batch.
"""

from __future__ import annotations

import functools
import math
from typing import Any

import numpy as np
from numba import njit, typeof, types
from numpy.typing import NDArray

from tweezer.compiling import cached_njit, sources
from tweezer.dynamics.brownian import (
    baoab,
    batch,
    euler,
    first_order,
    heun,
    noise,
    one_call,
    rotation,
)
from tweezer.dynamics.brownian.batch import Plan
from tweezer.dynamics.brownian.noise import NOISE, normals
from tweezer.dynamics.brownian.propagator import Weights
from tweezer.dynamics.integrators import exponential, kernel_signature

Array = NDArray[np.float64]

#: how beads are stepped
HEUN, FIRST_ORDER, ONE_CALL, EULER, HARMONIC, BAOAB = range(6)
#: beads side by side: what they need stays in the first cache
_BATCH = 64

#: the files whose functions the loop calls
_CALLED = sources(baoab, batch, euler, exponential, first_order, heun, noise, one_call, rotation)

_empty = np.zeros(0)
_PLAN = typeof(Plan(0, 0.0, 0, 0.0, 0.0, *[_empty] * 5))
_WEIGHTS = typeof(Weights(*[_empty] * len(Weights._fields)))
_integers = typeof(np.zeros(0, np.int64))
_matrix, _tensor = types.float64[:, ::1], types.float64[:, :, :]


@functools.cache
def loop(
    source: types.Type,
    beyond: types.Type,
    system: types.Type,
    *,
    scheme: int,
    inertial: bool,
    rotates: bool,
) -> Any:
    """The compiled loop for one scheme and one kind of light.

    advance(kernel, beyond, system, plan, weights, trajectories, states, sample, out) takes
    states (n, ...), as `tweezer.dynamics.walk.Walk` has them, from that sample on to the last of
    out (n, samples, ...), and returns the row of a bead whose place is not finite, or -1.
    """
    dims = 6 if rotates else 3
    gradient = scheme == FIRST_ORDER
    # an angle without inertia is drawn by itself, and BAOAB's position has no noise of its own
    rows = 2 * dims if inertial and scheme != BAOAB else dims if inertial else 3

    def advance(  # type: ignore[no-untyped-def]
        kernel, beyond, system, plan, weights, trajectories, states, sample, out
    ):
        last = states.shape[1] - 1
        for begin in range(0, states.shape[0], _BATCH):
            n = min(_BATCH, states.shape[0] - begin)
            who = trajectories[begin : begin + n]
            beads = batch.beads(n, dims, inertial, gradient)
            x, normal = beads.x, beads.normal[:rows]
            for i in range(n):
                _load(states[begin + i], beads, i)
            if scheme == BAOAB:
                batch.slow_velocities(kernel, beyond, system, plan, beads, x, beads.u)
            for number in range(out.shape[1]):
                for within in range(plan.per_sample):
                    at = (sample + number) * plan.per_sample + within
                    normals(plan.seed, who, at, NOISE, normal)
                    if scheme == HEUN:
                        heun.step(kernel, beyond, system, plan, weights, beads)
                    elif scheme == FIRST_ORDER:
                        first_order.step(kernel, beyond, system, plan, weights, beads)
                    elif scheme == ONE_CALL:
                        one_call.step(kernel, beyond, system, plan, weights, beads)
                    elif scheme == EULER:
                        euler.step(kernel, beyond, system, plan, weights, beads)
                    elif scheme == HARMONIC:
                        euler.harmonic_step(plan, weights, beads)
                    else:
                        baoab.step(kernel, beyond, system, plan, weights, beads)
                    if rotates:
                        rotation.turn_by_steps(beads)
                        if not inertial:
                            rotation.diffuse(plan, who, at, beads)
                    for i in range(n):
                        squared = x[0, i] * x[0, i] + x[1, i] * x[1, i] + x[2, i] * x[2, i]
                        if not squared < plan.loss * plan.loss or x[2, i] <= plan.lens:
                            if not math.isfinite(squared):
                                return begin + i
                            if states[begin + i, last] == np.inf:
                                states[begin + i, last] = (at + 1) * plan.step
                            _park(beads, i)
                for i in range(n):
                    if states[begin + i, last] < np.inf:
                        out[begin + i, number] = np.nan
                    elif scheme == ONE_CALL:
                        _save(beads, beads.ahead, i, out[begin + i, number])
                    else:
                        _save(beads, x, i, out[begin + i, number])
            for i in range(n):
                _save(beads, x, i, states[begin + i])
        return -1

    signature = types.int64(
        types.FunctionType(kernel_signature(source)),
        types.FunctionType(kernel_signature(beyond)),
        system, _PLAN, _WEIGHTS, _integers, _matrix, types.int64, _tensor,
    )  # fmt: skip
    return cached_njit(signature, calls=_CALLED, error_model="numpy", nogil=True)(advance)


@njit(error_model="numpy")
def _load(state, beads, i):  # type: ignore[no-untyped-def]
    """Bead i from a state: place, velocity, orientation, angular velocity (inertial axes)."""
    x, v, e = beads.x, beads.v, beads.e
    inertial, rotates = v.shape[0] > 0, e.shape[0] > 0
    at = 3
    for k in range(3):
        x[k, i] = state[k]
        if inertial:
            v[k, i] = state[3 + k]
    if inertial:
        at += 3
    if rotates:
        for k in range(4):
            e[i, k] = state[at + k]
    if rotates and inertial:
        for k in range(3):
            v[3 + k, i] = state[10 + k]


@njit(error_model="numpy")
def _save(beads, place, i, out):  # type: ignore[no-untyped-def]
    """The inverse of `_load`, with a place of one's own."""
    v, e = beads.v, beads.e
    inertial, rotates = v.shape[0] > 0, e.shape[0] > 0
    at = 3
    for k in range(3):
        out[k] = place[k, i]
        if inertial:
            out[3 + k] = v[k, i]
    if inertial:
        at += 3
    if rotates:
        for k in range(4):
            out[at + k] = e[i, k]
    if rotates and inertial:
        for k in range(3):
            out[10 + k] = v[3 + k, i]


@njit(error_model="numpy")
def _park(beads, i):  # type: ignore[no-untyped-def]
    """A lost bead is kept at the focus: its samples are no numbers."""
    for k in range(beads.x.shape[0]):
        beads.x[k, i] = 0.0
    for k in range(beads.v.shape[0]):
        beads.v[k, i] = 0.0
