"""The compiled loop over steps and samples, for every scheme and every force.

Beads go in batches: the numbers, the force and the step of a whole batch in turn. The scheme's step
and the force's kernel are called by their addresses, once a batch.
"""

from __future__ import annotations

import functools
import math
from typing import Any, NamedTuple

import numpy as np
from numba import njit, typeof, types
from numpy.typing import NDArray

from tweezer.compiled import address, cached_njit, call
from tweezer.dynamics.brownian import batch, rotation
from tweezer.dynamics.brownian.batch import PART, PLAN, STEP, WEIGHTS, Scheme
from tweezer.dynamics.brownian.noise import NOISE, normals

Array = NDArray[np.float64]

#: beads side by side: what they need stays in the first cache
_BATCH = 64


class Steps(NamedTuple):
    """How the loop steps beads: numbers of 0 or 1, but for the first two."""

    scheme: int
    """address of its step"""
    draws: int
    """normal numbers of a step"""
    inertial: int
    rotates: int
    gradient: int
    samples_ahead: int
    force_first: int
    """see `Scheme`"""


def steps(scheme: Scheme, *, inertial: bool, rotates: bool) -> Steps:
    """The steps of a scheme."""
    dims = 6 if rotates else 3
    # without inertia a rotation's noise is drawn by itself
    draws = dims * (2 if scheme.noise_of_position else 1) if inertial else 3
    flags = inertial, rotates, scheme.gradient, scheme.samples_ahead, scheme.force_first
    return Steps(address(scheme.step, STEP), draws, *map(int, flags))


@functools.cache
def loop() -> Any:
    """The compiled loop.

    advance(force, steps, plan, weights, trajectories, states, sample, out) takes states (n, ...),
    as `tweezer.dynamics.walk.Walk` has them, from that sample on to the last of
    out (n, samples, ...), and returns the row of a bead whose place is not finite, or -1.
    """

    def advance(  # type: ignore[no-untyped-def]
        force, steps, plan, weights, trajectories, states, sample, out
    ):
        last = states.shape[1] - 1
        dims = 6 if steps.rotates else 3
        for begin in range(0, states.shape[0], _BATCH):
            n = min(_BATCH, states.shape[0] - begin)
            who = trajectories[begin : begin + n]
            beads = batch.beads(n, dims, steps.inertial, steps.gradient)
            x, normal = beads.x, beads.normal[: steps.draws]
            for i in range(n):
                _load(states[begin + i], beads, i)
            if steps.force_first:
                now = sample * plan.per_sample * plan.step
                batch.slow_velocities(force, plan, beads, now, x, beads.u)
            for number in range(out.shape[1]):
                for within in range(plan.per_sample):
                    at = (sample + number) * plan.per_sample + within
                    beads.now[0] = at * plan.step
                    normals(plan.seed, who, at, NOISE, normal)
                    call(steps.scheme, (force, plan, weights, beads))
                    if steps.rotates:
                        rotation.turn_by_steps(beads)
                        if not steps.inertial:
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
                    elif steps.samples_ahead:
                        _save(beads, beads.ahead, i, out[begin + i, number])
                    else:
                        _save(beads, x, i, out[begin + i, number])
            for i in range(n):
                _save(beads, x, i, states[begin + i])
        return -1

    signature = types.int64(
        PART, typeof(Steps(*[0] * len(Steps._fields))), PLAN, WEIGHTS, types.int64[::1],
        types.float64[:, ::1], types.int64, types.float64[:, :, :],
    )  # fmt: skip
    return cached_njit(signature, error_model="numpy", nogil=True)(advance)


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
