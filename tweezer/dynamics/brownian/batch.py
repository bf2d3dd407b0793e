"""Arrays, parameters and operations that all schemes of thermal motion share.

Beads are processed side by side in batches, and the force is evaluated on a whole batch.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numba import typeof, types

from tweezer.compiled import cached_njit, named_njit
from tweezer.compiled.lanes import LANES, columns, lanes, store, store_columns
from tweezer.dynamics.body import BodyMotion
from tweezer.dynamics.brownian import memory, propagator
from tweezer.dynamics.brownian.coordinate import led, relaxed
from tweezer.dynamics.brownian.propagator import Weights
from tweezer.fluid import Mobility, Network, Walls
from tweezer.forces.data import Data, Part, packed
from tweezer.forces.force import Pose, Wrench, add, clear
from tweezer.values.arrays import Array


class Plan(NamedTuple):
    """Step, drag and noise of the beads in a run."""

    seed: int
    """seed of the random numbers"""
    step: float
    """length of a step, s"""
    per_sample: int
    """number of steps between samples"""
    tau: Array
    """(dims,) relaxation time of the velocity m/beta_v and of the angular velocity, s, even where
    the model has no inertia
    """
    mobility: Array
    """(dims,) 1/beta_v, s/kg, and 1/beta_w, 1/(N m s), at the start"""
    load: Array
    """(dims,) N: weight less buoyancy; 0 for the angles"""
    diffusion: Array
    """(dims,) kT times mobility, m^2/s and rad^2/s"""
    centre: Array
    """(dims,) m, equilibrium position of the spring whose motion is exact"""
    kT: float
    """thermal energy, J"""
    uniform: bool
    """whether a step needs no mobility by position: the drag is the same everywhere, or the scheme
    is made for walls
    """
    drag: Part
    """compiled drag with its data; beside a wall only the data, from
    `tweezer.dynamics.brownian.plane`
    """
    laser: Array = np.zeros(0)
    """(12,) noise of the laser, see `tweezer.dynamics.brownian.laser`; (0,) without it"""
    lock_in: Array = np.zeros(0)
    """(2,) data of the lock-in, see `tweezer.dynamics.brownian.lock_in`; (0,) without one"""
    feedback: Array = np.zeros(0)
    """data of a controller, see `tweezer.dynamics.brownian.feedback`; (0,) without one"""


class Beads(NamedTuple):
    """State of n beads, and workspace for a step. Each has three coordinates, and with rotation
    three angles.

    The angles are those turned in a step, about the inertial axes; `e` is the orientation before
    it. Beads are along the last axis, so a step does the same arithmetic on a row of numbers, eight
    at a time. A row has room for w beads: n rounded up to a multiple of eight.
    """

    x: Array
    """(dims, w) positions, m, and angles, rad"""
    v: Array
    """(dims, w) velocities, m/s, and angular velocities, rad/s; (0, w) without inertia. In a fluid
    with memory the first three rows are valid only at samples, and 3 n rows follow with the n
    hidden variables of each axis of translation
    """
    e: Array
    """(n, 4) Euler parameters; (0, 4) without rotation"""
    u: Array
    """(dims, w) slow velocities (force over drag) at `x`"""
    ahead: Array
    """(dims, w) positions predicted by a step of lower order"""
    u_ahead: Array
    """(dims, w) slow velocities at `ahead`"""
    kick: Array
    """(dims, w) noise of the positions, where it depends on the position"""
    normal: Array
    """(dims or 2 dims, and one more for the plane beside a wall, w) standard normal
    random numbers
    """
    now: Array
    """(1,) time at the beginning of the step, s"""
    pose: Pose
    """time, position and orientation of n beads, as the force reads them; spheres share the
    orientation with `e`
    """
    wrench: Wrench
    """force and torque on n beads; as `pose`, in memory that has room for w"""
    resisted: Mobility
    """mobilities where the force was last evaluated; empty for a uniform drag"""
    laser: Array
    """(4, w) noise of the laser: relative change of the power, and position of the focus, m;
    (0, w) without it
    """
    lock_in: Array
    """(6, w) in-phase parts and quadratures of the axes behind the lock-in, m; (0, w) without one
    """
    control: Array
    """(n, numbers) state and queue of a controller, whose output is `pose.drive`; (0, numbers)
    without one
    """


def beads(
    n: int,
    dims: int,
    inertial: bool,
    gradient: bool,
    uniform: bool,
    hidden: int = 0,
    draws: int = 0,
    body: bool = False,
    laser: int = 0,
    lock_in: int = 0,
    control: int = -1,
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
    body : bool
        Whether the force is read at other orientations than those at the beginning of a step.
    laser : int
        Number of random numbers that the laser has for each bead.
    lock_in : int
        Number of amplitudes of a bead behind the lock-in.
    control : int
        Number of numbers that a controller keeps for a bead; -1 without a controller.
    """
    gradients = n if gradient else 0
    places = 0 if uniform else n
    driven = n if control >= 0 else 0
    width = -(-n // LANES) * LANES
    inertial = inertial or hidden > 0  # the hidden variables follow the velocities
    e = np.zeros((n if dims == 6 else 0, 4))
    return Beads(
        np.zeros((dims, width)), np.zeros((dims + 3 * hidden if inertial else 0, width)), e,
        np.zeros((dims, width)), np.zeros((dims, width)), np.zeros((dims, width)),
        np.zeros((dims, width)), np.zeros((max(2 * dims if inertial else dims, draws), width)),
        np.zeros(1),
        Pose(
            np.zeros(n), np.zeros((width, 3))[:n], e.copy() if body else e,
            np.zeros((driven, 3)),
        ),
        Wrench(
            np.zeros((width, 3))[:n], np.zeros((width, 3))[:n], np.zeros((gradients, 3, 3)),
            np.zeros((gradients, 3, 3)), np.zeros(n),
        ),
        Mobility(np.zeros((places, 5)), np.zeros((places, 5, 3))), np.zeros((laser, width)),
        np.zeros((lock_in, width)), np.zeros((driven, max(control, 0))),
    )  # fmt: skip


@cached_njit(error_model="numpy", forceinline=True, nogil=True)
def slow_velocities(force, plan, beads, time, place, out):  # type: ignore[no-untyped-def]
    """Fill `out` (dims, w) with the slow velocities (F + W)/beta_v and M/beta_w of all beads.

    F, W and M are force, weight and torque; beta_v and beta_w are the drag. `time` is in s, and
    `place` are positions (dims, w) in m. `beads.pose` and `beads.wrench` are overwritten.
    """
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
    """Return the first coordinate without hydrodynamic memory: 3 in a fluid with memory, else 0."""
    return 3 if weights.memory.shape[2] > 0 else 0


@named_njit(inner=True, error_model="numpy", forceinline=True)
def lead(weights, beads, out):  # type: ignore[no-untyped-def]
    """Fill `out` (dims, w) with the positions after a step under constant slow velocities and
    noise.

    They start from `beads.x` with the velocities, or the hidden variables of the memory, in
    `beads.v`. `out` may be `beads.x`.
    """
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
    """Advance velocities, or hidden variables of the memory, by a step under constant slow
    velocities.

    `beads.v` is changed in place; without inertia it is empty, and nothing is done.
    """
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
    """Linear part of the equations of motion of each coordinate, all (dims,) unless stated
    otherwise.
    """

    tau: Array
    """relaxation time of the velocity, s; 0 where inertia is left out"""
    kappa: Array
    """stiffness of the trap over drag, 1/s"""
    diffusion: Array
    """kT over drag, m^2/s and rad^2/s; 0 where the diffusion is drawn separately"""
    epsilon: float
    """m/beta_v of the bead (4.6), s, in every model"""
    rates: Array
    """(3, 3) mobility times stiffness, 1/s, with the entries that couple the axes"""
    times: Array = _empty
    """(n,) relaxation times tau_j of the velocity modes of a fluid with memory, s; else empty"""
    parts: Array = _empty
    """(n,) weights a_j of these modes"""
    network: Network | None = None
    """elements of a viscoelastic medium, which include its modes; None in a Newtonian fluid"""


def exact(step: float, linear: Linear) -> Weights:
    """Return the exact weights of drag, springs and noise."""
    weights = propagator.exact(step, linear.tau, linear.kappa, linear.diffusion)
    if linear.network is not None:
        return propagator.with_network(step, linear.network, weights, linear.diffusion)
    if not len(linear.times):
        return weights
    return propagator.with_memory(step, linear.times, linear.parts, weights, linear.diffusion)


def exact_without_springs(step: float, linear: Linear) -> Weights:
    """Return the exact weights of drag and noise."""
    return exact(step, linear._replace(kappa=np.zeros_like(linear.kappa)))


class Scheme(NamedTuple):
    """Method of stepping beads in thermal motion."""

    step: Callable[..., None]
    """compiled function `step(force, plan, weights, beads)`"""
    weights: Callable[[float, Linear], Weights]
    """function that returns the coefficients of a step of given length, s, under drag and noise"""
    force_calls: int
    """number of force evaluations of a bead in a step"""
    gradient: bool = False
    """whether it needs the gradient of the force"""
    noise_of_position: bool = True
    """whether the position has noise of its own besides the velocity's"""
    samples_ahead: bool = False
    """whether a sample is the position at which the last step evaluated the force"""
    memory: bool = False
    """whether the scheme can follow the hydrodynamic memory"""
    force_first: bool = False
    """whether a step reads the slow velocity that the step before left"""
    resolves_drag: bool = False
    """whether its steps must be shorter than the relaxation times"""
    swings: int = 1
    """number of parts of a step with random numbers of their own"""
    part_of_swing: float = 0.1
    """its step over the time of a swing, sqrt(m/k), at low damping: 63 steps a period"""
    data: Callable[[Walls, float], Data] | None = None
    """for a scheme beside walls, a function of the walls and kT, J, which returns the data that its
    step reads in place of a drag
    """
    body: Callable[[BodyMotion, float, float], Data] | None = None
    """for a scheme of rigid bodies that also rotates them, a function of the body, kT, J, and the
    step, s, which returns the data that its step reads in place of a drag
    """

    @property
    def beside_wall(self) -> bool:
        """Whether the scheme is made for walls: it includes the rotation and draws one
        number more.
        """
        return self.data is not None
