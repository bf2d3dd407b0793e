"""What every scheme shares: some beads side by side, and the force on all of them at once."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numba import typeof, types
from numpy.typing import NDArray

from tweezer.compiled import cached_njit, named_njit
from tweezer.compiled.lanes import LANES, columns, lanes, store, store_columns
from tweezer.dynamics.brownian import memory, propagator
from tweezer.dynamics.brownian.coordinate import led, relaxed
from tweezer.dynamics.brownian.propagator import Weights
from tweezer.fluid import Mobility, Walls
from tweezer.forces.data import Data, Part, packed
from tweezer.forces.force import Pose, Wrench, add, clear

Array = NDArray[np.float64]


class Plan(NamedTuple):
    """How beads walk."""

    seed: int
    step: float
    """s"""
    per_sample: int
    tau: Array
    """(dims,) s; m/beta_v where inertia is left out"""
    mobility: Array
    """(dims,) 1/beta_v, and 1/beta_w, at the start"""
    load: Array
    """(dims,) N: gravity and buoyancy"""
    diffusion: Array
    """(dims,) m^2/s, and rad^2/s"""
    centre: Array
    """(dims,) m, of the spring that is taken exactly"""
    kT: float
    """J"""
    uniform: bool
    """whether a step asks for no mobility by place: the drag is the same everywhere, or the scheme
    is one beside a wall"""
    drag: Part
    """its kernel and data; beside a wall the data of `tweezer.dynamics.brownian.plane` alone"""


class Beads(NamedTuple):
    """n beads, and room to move them in. Coordinates are three, and with a rotation three angles.

    The angles are those turned in a step, about the inertial axes; e says what came before. Beads
    are along the last axis, so that a step is the same arithmetic on a row of numbers, eight at a
    time: a row has room for w beads, n rounded up to a multiple of eight.
    """

    x: Array
    """(dims, w) m, and rad"""
    v: Array
    """(dims, w); (0, w) without inertia. In a fluid with memory the first three rows are up to date
    at samples alone, and the n hidden variables of each axis of translation follow the rows"""
    e: Array
    """(n, 4); (0, 4) without rotation"""
    u: Array
    """(dims, w) slow velocities"""
    ahead: Array
    """(dims, w) where a step of lower order leads"""
    u_ahead: Array
    kick: Array
    """(dims, w) of the noise, where it depends on the place"""
    normal: Array
    """(dims or twice that, and one more for the plane beside a wall, w)"""
    now: Array
    """(1,) s, the begin of the step"""
    pose: Pose
    wrench: Wrench
    """both of n beads, in memory that has room for w"""
    resisted: Mobility
    """at the position that the force was last evaluated at; empty for a uniform drag"""


def beads(
    n: int,
    dims: int,
    inertial: bool,
    gradient: bool,
    uniform: bool,
    hidden: int = 0,
    draws: int = 0,
) -> Beads:
    """Return arrays of zeros for a batch of beads.

    Parameters
    ----------
    n : int
        Number of beads.
    dims : int
        Degrees of freedom, 3 or 6.
    inertial : bool
        Whether the state includes velocities.
    gradient : bool
        Whether the force gradients are needed.
    uniform : bool
        Whether the drag is the same everywhere.
    hidden : int
        Number of hidden variables of the hydrodynamic memory along an axis.
    draws : int
        Number of normal random numbers per bead and step.
    """
    gradients = n if gradient else 0
    places = 0 if uniform else n
    width = -(-n // LANES) * LANES
    e = np.zeros((n if dims == 6 else 0, 4))
    return Beads(
        np.zeros((dims, width)), np.zeros((dims + 3 * hidden if inertial else 0, width)), e,
        np.zeros((dims, width)), np.zeros((dims, width)), np.zeros((dims, width)),
        np.zeros((dims, width)), np.zeros((max(2 * dims if inertial else dims, draws), width)),
        np.zeros(1),
        Pose(np.zeros(n), np.zeros((width, 3))[:n], e),
        Wrench(
            np.zeros((width, 3))[:n], np.zeros((width, 3))[:n], np.zeros((gradients, 3, 3)),
            np.zeros((gradients, 3, 3)), np.zeros(n),
        ),
        Mobility(np.zeros((places, 5)), np.zeros((places, 5, 3))),
    )  # fmt: skip


@cached_njit(error_model="numpy", forceinline=True, nogil=True)
def slow_velocities(force, plan, beads, time, place, out):  # type: ignore[no-untyped-def]
    """u = (F + W)/beta_v, and M/beta_w, at a time and at `place` (dims, w)."""
    pose, wrench = beads.pose, beads.wrench
    dims, width = place.shape
    for i in range(len(pose.time)):
        pose.time[i] = time
    for i in range(0, width, LANES):
        x, y, z = lanes(place, i), lanes(place, width + i), lanes(place, 2 * width + i)
        store_columns(pose.position, 3 * i, x, y, z)
    clear(wrench)
    add(force, pose, wrench)
    for i in range(0, width, LANES):
        pulls = columns(wrench.force, 3 * i)
        for k in range(3):
            store(out, k * width + i, plan.mobility[k] * (pulls[k] + plan.load[k]))
        if dims > 3:
            turns = columns(wrench.moment, 3 * i)
            for k in range(3):
                store(out, (3 + k) * width + i, plan.mobility[3 + k] * turns[k])


@named_njit(inner=True, error_model="numpy", forceinline=True)
def without_memory(weights):  # type: ignore[no-untyped-def]
    """The first coordinate that has none."""
    return 3 if weights.memory.shape[2] > 0 else 0


@named_njit(inner=True, error_model="numpy", forceinline=True)
def lead(weights, beads, out):  # type: ignore[no-untyped-def]
    """Where velocity or memory, u and noise lead, to `out`, which may be x."""
    dims, width = beads.x.shape
    x, v, u, normal = beads.x, beads.v, beads.u, beads.normal
    inertial, first = v.shape[0] > 0, without_memory(weights)
    if first > 0:
        memory.lead(weights, beads, out)
    for k in range(first, dims):
        by_v, by_u, spread = weights.by_v[k], weights.by_u[k], weights.noise_x[k]
        for i in range(k * width, (k + 1) * width, LANES):
            there = led(lanes(x, i), lanes(u, i), lanes(normal, i), by_u, spread)
            if inertial:
                there = there + by_v * lanes(v, i)
            store(out, i, there)


@named_njit(inner=True, error_model="numpy", forceinline=True)
def velocities_after(weights, beads):  # type: ignore[no-untyped-def]
    """What drag, u and noise make of the velocities, or of the memory, in place."""
    dims, width = beads.x.shape
    v, u, normal = beads.v, beads.u, beads.normal
    if v.shape[0] == 0:
        return
    if weights.memory.shape[2] > 0:
        memory.after(weights, beads)
    for k in range(without_memory(weights), dims):
        decay, by_u = weights.decay[k], weights.v_by_u[k]
        shared, own = weights.noise_xv[k], weights.noise_v[k]
        for i in range(k * width, (k + 1) * width, LANES):
            drawn = shared * lanes(normal, i) + own * lanes(normal, i + dims * width)
            store(v, i, relaxed(lanes(v, i), lanes(u, i), decay, by_u, drawn))


_empty, _row = np.zeros(0), np.zeros((0, 0))
PART = typeof(Part(0, packed()))
PLAN = typeof(
    Plan(
        0, 0.0, 0, _empty, _empty, _empty, _empty, _empty, 0.0, True, Part(0, packed())
    )
)  # fmt: skip
WEIGHTS = typeof(Weights(*[_empty] * (len(Weights._fields) - 3)))
BEADS = typeof(beads(0, 3, True, True, True))
STEP = types.void(PART, PLAN, WEIGHTS, BEADS)
"""signature of a scheme's step"""


class Linear(NamedTuple):
    """The linear part of the equations of each coordinate, all (dims,)."""

    tau: Array
    """s, of the velocity; 0 where inertia is left out"""
    kappa: Array
    """1/s, rate of return of the trap's spring"""
    diffusion: Array
    """m^2/s, and rad^2/s; 0 where the diffusion is drawn by itself"""
    epsilon: float
    """s, m/beta_v (4.6) of the bead, whatever the model"""
    rates: Array
    """(3, 3) 1/s, mobility times stiffness: what the spring does between the coordinates too"""
    times: Array = _empty
    """(n,) s, the tau_j of a fluid with memory (`tweezer.dynamics.brownian.memory`); else empty"""
    parts: Array = _empty
    """(n,) its a_j"""


def exact(step: float, linear: Linear) -> Weights:
    """Return the exact weights of drag, springs and noise."""
    weights = propagator.exact(step, linear.tau, linear.kappa, linear.diffusion)
    if not len(linear.times):
        return weights
    return propagator.with_memory(step, linear.times, linear.parts, weights, linear.diffusion)


def exact_without_springs(step: float, linear: Linear) -> Weights:
    """Return the exact weights of drag and noise."""
    return exact(step, linear._replace(kappa=np.zeros_like(linear.kappa)))


class Scheme(NamedTuple):
    """A way to step beads."""

    step: Callable[..., None]
    """compiled, `step(force, plan, weights, beads)`"""
    weights: Callable[[float, Linear], Weights]
    """what a step of that length, s, of drag and noise does"""
    force_calls: int
    """places of a bead at which a step asks for the force"""
    gradient: bool = False
    """whether it needs the gradient of the force"""
    noise_of_position: bool = True
    """whether the noise of the position is apart from that of the velocity"""
    samples_ahead: bool = False
    """whether a sample is the place that the last step asked the force at"""
    memory: bool = False
    """whether it follows the memory of the fluid"""
    force_first: bool = False
    """whether a step wants the slow velocity of the one before"""
    resolves_drag: bool = False
    """whether its steps must be shorter than the relaxation times"""
    data: Callable[[Walls, float], Data] | None = None
    """of a scheme beside a wall: what its step reads, by the walls and kT, J, in place of a drag"""

    @property
    def beside_wall(self) -> bool:
        """Whether it is one beside a wall: it takes the rotation with it, and one number more."""
        return self.data is not None
