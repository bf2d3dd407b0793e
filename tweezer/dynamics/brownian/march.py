"""The loop over steps and samples, compiled, for every scheme and every force.

Beads are advanced in batches: random numbers, force and step are computed for a whole batch in
turn. The scheme's step and the force's kernel are called by their addresses, once per batch.
"""

from __future__ import annotations

import functools
import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numba import typeof, types
from numpy.typing import NDArray

from tweezer.compiled import address, cached_njit, call, named_njit
from tweezer.dynamics.brownian import batch, crossing, feedback, laser, lock_in, memory, rotation
from tweezer.dynamics.brownian.batch import (
    BEADS,
    PART,
    PLAN,
    STEP,
    WEIGHTS,
    Beads,
    Plan,
    Scheme,
)
from tweezer.dynamics.brownian.crossing import BOUNDARY, Boundary
from tweezer.dynamics.brownian.noise import NOISE, normals
from tweezer.dynamics.brownian.propagator import Weights
from tweezer.dynamics.brownian.rotation import TURNS
from tweezer.dynamics.layout import FEEDBACK, ROTATION, TRANSLATION, Layout
from tweezer.forces.data import Part
from tweezer.values.arrays import Array

if TYPE_CHECKING:
    from tweezer.scene.sections import Feedback

#: Beads in a batch: calls by address cost little for so many, and their data stay in the cache
_BATCH = 128
#: Returned where a bead comes near a boundary that is not tested
NEAR = -2
#: Returned if all beads are inside and finite
_ALL = -1


class Steps(NamedTuple):
    """Parameters of the compiled loop over steps. `gradient` to `force_first` are 0 or 1."""

    scheme: int
    """address of the compiled step of the scheme"""
    draws: int
    """normal random numbers of a bead in a step"""
    memory: int
    """number of hidden variables of each axis of translation"""
    velocity: int
    """first column of the velocity in a sample; -1 without inertia"""
    orientation: int
    """first column of the orientation; -1 without rotation"""
    angular_velocity: int
    """first column of the angular velocity, about the inertial axes; -1 without
    rotation or inertia
    """
    gradient: int
    """whether the scheme needs the force gradient, see `Scheme`"""
    samples_ahead: int
    """whether samples are the positions of the last force evaluation, see `Scheme`"""
    force_first: int
    """whether the slow velocity is computed before the first step, see `Scheme`"""
    turn: int
    """address of the function that rotates the beads after a step; 0 without rotation, or if the
    step rotates them
    """
    shake: int
    """address of the function that adds the noise of the laser after a step; 0 without it"""
    mix: int
    """address of the function of the lock-in after a step; 0 without one"""
    tick: int
    """address of the tick of a controller; 0 without one"""
    in_phase: int
    """first column of the in-phase parts, before those of the quadratures; -1 without a lock-in"""
    output: int
    """first column of the output of a controller; -1 without one"""


def steps(scheme: Scheme, layout: Layout, controller: Feedback | None) -> Steps:
    """Return the parameters of the loop for a scheme, states of a layout and a controller."""
    inertial = "velocity" in layout
    dims = _dimensions(layout)
    spheres = dims == 6 and scheme.body is None
    diffuses = not inertial and not scheme.beside_wall and spheres
    draws = 3 if diffuses else dims
    if inertial and scheme.noise_of_position:
        draws *= 2
    draws *= scheme.swings
    draws += scheme.beside_wall
    turn = 0
    if spheres:
        turn = address(rotation.turn_and_diffuse if diffuses else rotation.turn_by_steps, TURNS)
    shake = address(laser.shake, laser.SHAKES) if "laser" in layout else 0
    mix = address(lock_in.mix, lock_in.MIXES) if "in_phase" in layout else 0
    tick = 0 if controller is None else address(feedback.tick, feedback.TICKS)
    return Steps(
        address(scheme.step, STEP), draws, layout.blocks.get("memory", 0) // 3,
        layout.first("velocity"), layout.first("orientation"), layout.first("angular_velocity"),
        int(scheme.gradient), int(scheme.samples_ahead), int(scheme.force_first), turn, shake, mix,
        tick, layout.first("in_phase"),
        -1 if controller is None else layout.first(controller.output),
    )  # fmt: skip


def _dimensions(layout: Layout) -> int:
    """Return the number of degrees of freedom of a body: 6 with rotation, else 3."""
    return 6 if "orientation" in layout else 3


def advance(
    force: Part, steps: Steps, plan: Plan, weights: Weights, edge: Boundary, layout: Layout,
    trajectories: NDArray[np.int64], states: Array, sample: int, out: Array,
) -> int:  # fmt: skip
    """Advance the states of beads to the last sample, in place.

    Parameters
    ----------
    force : Part
        Compiled force and its data.
    steps : Steps
        Parameters of the loop over steps.
    plan : Plan
        Length of the steps, their number between samples, drag and noise.
    weights : Weights
        Coefficients of a step.
    edge : Boundary
        Boundary at which a bead is lost.
    layout : Layout
        Layout of the states.
    trajectories : ndarray, shape (n,)
        Indices of the trajectories, which select the random numbers.
    states : ndarray, shape (n, layout.width)
        States, a row for each bead.
    sample : int
        Index of the sample that `states` belongs to.
    out : ndarray, shape (n, samples, columns)
        Filled with the samples after that one.

    Returns
    -------
    int
        Row of a bead whose position is not finite, or -1. `NEAR` if a bead approaches the boundary
        and `edge` has no function for this case; `states` and `out` are changed then.
    """
    follow = loop()
    inertial, dims, lost = "velocity" in layout, _dimensions(layout), layout.first("lost_time")
    gradient, uniform = bool(steps.gradient), plan.uniform
    body = dims == 6 and steps.turn == 0
    for begin in range(0, len(states), _BATCH):
        part = slice(begin, begin + _BATCH)
        here = states[part]
        n = len(here)
        beads = batch.beads(
            n, dims, inertial, gradient, uniform, steps.memory, steps.draws, body,
            layout.blocks.get("laser", 0), 6 if "in_phase" in layout else 0,
            layout.blocks.get("control", 0) if steps.tick else -1,
        )  # fmt: skip
        who = np.zeros(beads.x.shape[1], np.int64)
        who[:n] = trajectories[part]
        held = _held(layout, beads, n)
        for columns, room in held:
            room[:] = here[:, columns].T
        if steps.force_first:
            now = sample * plan.per_sample * plan.step
            batch.slow_velocities(force, plan, beads, now, beads.x, beads.u)
        failed = follow(
            force, steps, plan, weights, edge, who, beads, here[:, lost], sample, out[part]
        )
        if failed != _ALL:
            return failed if failed == NEAR else begin + failed
        for columns, room in held:
            here[:, columns] = room.T
    return _ALL


def _held(layout: Layout, beads: Beads, n: int) -> list[tuple[slice, Array]]:
    """Return, for each block of a state, its columns and the array of `beads` that stores it.

    `n` is the number of beads.
    """
    rooms = {
        "position": beads.x[TRANSLATION, :n],
        "velocity": beads.v[TRANSLATION, :n],
        "orientation": beads.e.T,
        "angular_velocity": beads.v[ROTATION, :n],
        "memory": beads.v[len(beads.x) :, :n],
        "laser": beads.laser[:, :n],
        "in_phase": beads.lock_in[:3, :n],
        "quadrature": beads.lock_in[3:, :n],
        **dict.fromkeys(FEEDBACK, beads.pose.drive.T),
        "control": beads.control.T,
    }
    return [(layout.at(name), room) for name, room in rooms.items() if name in layout]


@functools.cache
def loop() -> Any:
    """Return the compiled loop over the steps and samples of one batch of beads.

    It fills `out` (n, samples, columns) for the trajectories with the indices `who`. Steps are
    counted from the sample with the index `sample`. `lost_at` (n,) are times of loss, s, infinite
    for beads that are not lost. The result is `_ALL` (-1), `NEAR`, or the row of a bead whose
    position is not finite.
    """

    def follow(  # type: ignore[no-untyped-def]
        force, steps, plan, weights, edge, who, beads, lost_at, sample, out
    ):
        """Advance one batch of beads through all samples of `out`; see `loop`."""
        n, x, normal = out.shape[0], beads.x, beads.normal[: steps.draws]
        # a variable, as Numba would compile `normals` a second time for a constant
        purpose = np.int64(NOISE)
        watched = not crossing.all_far(edge, x, n)
        before, lost = np.empty((3, x.shape[1])), np.empty(n)
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
                if steps.turn != 0:
                    call(steps.turn, (plan, who, at, beads))
                if steps.shake != 0:
                    call(steps.shake, (plan, who, at, beads))
                if steps.mix != 0:
                    call(steps.mix, (plan, at, beads))
                if steps.tick != 0 and (at + 1) % np.int64(plan.feedback[feedback.EVERY]) == 0:
                    call(steps.tick, (plan, who, at, beads))
                    if steps.force_first:
                        now = (at + 1) * plan.step
                        batch.slow_velocities(force, plan, beads, now, x, beads.u)
                if watched or not crossing.all_far(edge, x, n):
                    if edge.find == 0:
                        return NEAR
                    for i in range(n):  # `find` skips beads that were lost before
                        lost[i] = -1.0 if lost_at[i] < np.inf else 2.0
                    call(edge.find, (edge, plan.seed, who, at, before, watched, beads, lost))
                    for i in range(n):
                        if math.isnan(lost[i]):
                            return i
                        if 0.0 <= lost[i] <= 1.0:
                            lost_at[i] = (at + lost[i]) * plan.step
                            _park(beads, i)
                    watched = not crossing.all_far(edge, x, n)
            if steps.memory > 0:
                memory.velocities(weights, beads)
            place, turned = x, beads.e
            if steps.samples_ahead:
                place, turned = beads.ahead, beads.pose.orientation
            for i in range(n):
                if lost_at[i] < np.inf:
                    out[i, number] = np.nan
                else:
                    _save(steps, beads, place, turned, i, out[i, number])
        return _ALL

    signature = types.int64(
        PART, typeof(Steps(*[0] * len(Steps._fields))), PLAN, WEIGHTS, BOUNDARY, types.int64[::1],
        BEADS, types.float64[:], types.int64, types.float64[:, :, :],
    )  # fmt: skip
    return cached_njit(signature, error_model="numpy", nogil=True)(follow)


@named_njit(inner=True, error_model="numpy")
def _save(steps, beads, place, turned, i, out):  # type: ignore[no-untyped-def]
    """Store the state of bead i in a sample `out`.

    `place` (dims, w) has the positions to store, and `turned` (n, 4) the orientations.
    """
    for k in range(3):
        out[k] = place[k, i]
    if steps.velocity >= 0:
        for k in range(3):
            out[steps.velocity + k] = beads.v[k, i]
    if steps.orientation >= 0:
        for k in range(4):
            out[steps.orientation + k] = turned[i, k]
    if steps.angular_velocity >= 0:
        for k in range(3):
            out[steps.angular_velocity + k] = beads.v[3 + k, i]
    if steps.in_phase >= 0:
        for k in range(6):
            out[steps.in_phase + k] = beads.lock_in[k, i]
    if steps.output >= 0:
        for k in range(3):
            out[steps.output + k] = beads.pose.drive[i, k]


@named_njit(inner=True, error_model="numpy")
def _park(beads, i):  # type: ignore[no-untyped-def]
    """Move a lost bead i to the focus at rest, so that it stays finite; its samples are NaN."""
    for k in range(beads.x.shape[0]):
        beads.x[k, i] = 0.0
    for k in range(beads.v.shape[0]):
        beads.v[k, i] = 0.0
