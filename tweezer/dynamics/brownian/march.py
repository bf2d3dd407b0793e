"""The compiled loop over steps and samples, for every scheme and every force.

Beads go in batches: the numbers, the force and the step of a whole batch in turn. The scheme's step
and the force's kernel are called by their addresses, once a batch.
"""

from __future__ import annotations

import functools
import math
from typing import Any, NamedTuple

import numpy as np
from numba import typeof, types
from numpy.typing import NDArray

from tweezer.compiled import address, cached_njit, call, named_njit
from tweezer.dynamics.brownian import batch, crossing, memory, rotation
from tweezer.dynamics.brownian.batch import PART, PLAN, STEP, WEIGHTS, Scheme
from tweezer.dynamics.brownian.crossing import BOUNDARY
from tweezer.dynamics.brownian.noise import NOISE, normals

Array = NDArray[np.float64]

#: Beads side by side: calls by address cost little for so many, and what they need stays in cache
_BATCH = 128
#: Returned where a bead comes near a boundary that is not looked at
NEAR = -2


class Steps(NamedTuple):
    """How the loop steps beads. The last four are 0 or 1."""

    scheme: int
    """address of its step"""
    draws: int
    """normal numbers of a step"""
    memory: int
    """count of the hidden variables of each axis of translation; they follow the columns"""
    velocity: int
    """where the velocity begins in a state; -1 without inertia"""
    orientation: int
    """where the orientation begins; -1 without rotation"""
    angular_velocity: int
    """where the angular velocity begins, about the inertial axes; -1 without one of the two"""
    gradient: int
    samples_ahead: int
    force_first: int
    """see `Scheme`"""
    diffuses: int
    """whether rotational diffusion is drawn by itself"""


def steps(scheme: Scheme, columns: tuple[str, ...], hidden: int = 0) -> Steps:
    """The steps of a scheme, for states of these columns (`tweezer.dynamics.walk.Walk`).

    hidden: count of the numbers of a state that are hidden.
    """
    places = [columns.index(name) if name in columns else -1 for name in ("vx", "e0", "wx")]
    dims = 6 if "e0" in columns else 3
    diffuses = "vx" not in columns and not scheme.beside_wall and dims == 6
    draws = 3 if diffuses else dims
    if "vx" in columns and scheme.noise_of_position:
        draws *= 2
    draws += scheme.beside_wall
    flags = scheme.gradient, scheme.samples_ahead, scheme.force_first, diffuses
    return Steps(address(scheme.step, STEP), draws, hidden // 3, *places, *map(int, flags))


@functools.cache
def loop() -> Any:
    """The compiled loop.

    advance(force, steps, plan, weights, edge, trajectories, states, sample, out) takes states
    (n, ...), as `tweezer.dynamics.walk.Walk` has them, from that sample to the last of
    out (n, samples, ...). It returns the row of a bead whose place is not finite, or -1. It returns
    `NEAR`, with states and out changed, where a bead comes near the boundary and `edge` has no
    function for that.
    """

    def advance(  # type: ignore[no-untyped-def]
        force, steps, plan, weights, edge, trajectories, states, sample, out
    ):
        last = states.shape[1] - 1
        inertial, rotates = steps.velocity >= 0, steps.orientation >= 0
        dims = 6 if rotates else 3
        purpose = np.int64(NOISE)  # a constant would be compiled apart
        for begin in range(0, states.shape[0], _BATCH):
            n = min(_BATCH, states.shape[0] - begin)
            beads = batch.beads(
                n, dims, inertial, steps.gradient, plan.uniform, steps.memory, steps.draws
            )
            who = np.zeros(beads.x.shape[1], np.int64)
            x, normal = beads.x, beads.normal[: steps.draws]
            hidden = beads.v[dims:]
            kept = last - 3 * steps.memory  # where a state has what is hidden
            for i in range(n):
                who[i] = trajectories[begin + i]
                _load(steps, states[begin + i], beads, i)
                for k in range(3 * steps.memory):
                    hidden[k, i] = states[begin + i, kept + k]
            watched = not crossing.all_far(edge, x, n)
            before, lost = np.empty((3, x.shape[1])), np.empty(n)
            if steps.force_first:
                now = sample * plan.per_sample * plan.step
                batch.slow_velocities(force, plan, beads, now, x, beads.u)
            for number in range(out.shape[1]):
                for within in range(plan.per_sample):
                    at = (sample + number) * plan.per_sample + within
                    beads.now[0] = at * plan.step
                    if watched:
                        for k in range(3):
                            for i in range(n):
                                before[k, i] = x[k, i]
                    normals(plan.seed, who, at, purpose, normal)
                    call(steps.scheme, (force, plan, weights, beads))
                    if rotates:
                        rotation.turn_by_steps(beads)
                        if steps.diffuses:
                            rotation.diffuse(plan, who, at, beads)
                    if watched or not crossing.all_far(edge, x, n):
                        if edge.find == 0:
                            return NEAR
                        for i in range(n):
                            lost[i] = -1.0 if states[begin + i, last] < np.inf else 2.0
                        found = (edge, plan.seed, who, at, before, watched, beads, lost)
                        call(edge.find, found)
                        for i in range(n):
                            if math.isnan(lost[i]):
                                return begin + i
                            if 0.0 <= lost[i] <= 1.0:
                                states[begin + i, last] = (at + lost[i]) * plan.step
                                _park(beads, i)
                        watched = not crossing.all_far(edge, x, n)
                if steps.memory > 0:
                    memory.velocities(weights, beads)
                for i in range(n):
                    if states[begin + i, last] < np.inf:
                        out[begin + i, number] = np.nan
                    elif steps.samples_ahead:
                        _save(steps, beads, beads.ahead, i, out[begin + i, number])
                    else:
                        _save(steps, beads, x, i, out[begin + i, number])
            for i in range(n):
                _save(steps, beads, x, i, states[begin + i])
                for k in range(3 * steps.memory):
                    states[begin + i, kept + k] = hidden[k, i]
        return -1

    signature = types.int64(
        PART, typeof(Steps(*[0] * len(Steps._fields))), PLAN, WEIGHTS, BOUNDARY, types.int64[::1],
        types.float64[:, ::1], types.int64, types.float64[:, :, :],
    )  # fmt: skip
    return cached_njit(signature, error_model="numpy", nogil=True)(advance)


@named_njit(inner=True, error_model="numpy")
def _load(steps, state, beads, i):  # type: ignore[no-untyped-def]
    """Bead i from a state, but for what is hidden."""
    for k in range(3):
        beads.x[k, i] = state[k]
    if steps.velocity >= 0:
        for k in range(3):
            beads.v[k, i] = state[steps.velocity + k]
    if steps.orientation >= 0:
        for k in range(4):
            beads.e[i, k] = state[steps.orientation + k]
    if steps.angular_velocity >= 0:
        for k in range(3):
            beads.v[3 + k, i] = state[steps.angular_velocity + k]


@named_njit(inner=True, error_model="numpy")
def _save(steps, beads, place, i, out):  # type: ignore[no-untyped-def]
    """The inverse of `_load`, with a place of one's own."""
    for k in range(3):
        out[k] = place[k, i]
    if steps.velocity >= 0:
        for k in range(3):
            out[steps.velocity + k] = beads.v[k, i]
    if steps.orientation >= 0:
        for k in range(4):
            out[steps.orientation + k] = beads.e[i, k]
    if steps.angular_velocity >= 0:
        for k in range(3):
            out[steps.angular_velocity + k] = beads.v[3 + k, i]


@named_njit(inner=True, error_model="numpy")
def _park(beads, i):  # type: ignore[no-untyped-def]
    """A lost bead is kept at the focus: its samples are no numbers."""
    for k in range(beads.x.shape[0]):
        beads.x[k, i] = 0.0
    for k in range(beads.v.shape[0]):
        beads.v[k, i] = 0.0
