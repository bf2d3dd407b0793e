"""What every scheme shares: some beads side by side, and the force on all of them at once."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Plan(NamedTuple):
    """How beads walk."""

    seed: int
    step: float
    """s"""
    per_sample: int
    loss: float
    """m, distance from the focus at which a bead is lost"""
    lens: float
    """m, z at which a bead touches the lens, and is lost"""
    tau: Array
    """(dims,) s; 0 where inertia is left out"""
    mobility: Array
    """(dims,) 1/beta_v, and 1/beta_w"""
    load: Array
    """(dims,) N: gravity and buoyancy"""
    diffusion: Array
    """(dims,) m^2/s, and rad^2/s"""
    centre: Array
    """(dims,) m, of the spring that is taken exactly"""


class Beads(NamedTuple):
    """n beads, and room to move them in. Coordinates are three, and with a rotation three angles.

    The angles are those turned in a step, about the inertial axes; e says what came before. Beads
    are along the last axis, so that a step is the same arithmetic on a row of numbers.
    """

    x: Array
    """(dims, n) m, and rad"""
    v: Array
    """(dims, n); (0, n) without inertia"""
    e: Array
    """(n, 4); (0, 4) without rotation"""
    u: Array
    """(dims, n) slow velocities"""
    ahead: Array
    """(dims, n) where a step of lower order leads"""
    u_ahead: Array
    kick: Array
    """(dims, n) of the noise, where it depends on the place"""
    normal: Array
    """(dims or twice that, n)"""
    position: Array
    force: Array
    moment: Array
    force_gradient: Array
    moment_gradient: Array
    error: Array


@njit
def beads(n, dims, inertial, gradient):  # type: ignore[no-untyped-def]
    """Room for n beads."""
    gradients = n if gradient else 0
    return Beads(
        np.zeros((dims, n)), np.zeros((dims if inertial else 0, n)),
        np.zeros((n if dims == 6 else 0, 4)), np.zeros((dims, n)), np.zeros((dims, n)),
        np.zeros((dims, n)), np.zeros((dims, n)), np.zeros((2 * dims if inertial else dims, n)),
        np.zeros((n, 3)), np.zeros((n, 3)), np.zeros((n, 3)), np.zeros((gradients, 3, 3)),
        np.zeros((gradients, 3, 3)), np.zeros(n),
    )  # fmt: skip


@njit(error_model="numpy")
def slow_velocities(kernel, beyond, system, plan, beads, place, out):  # type: ignore[no-untyped-def]
    """u = (F + W)/beta_v, and M/beta_w, at `place` (dims, n)."""
    position, error = beads.position, beads.error
    dims, n = place.shape
    for k in range(3):
        for i in range(n):
            position[i, k] = place[k, i]
    kernel(
        position, system.source, system.radius, system.n_mP, system.jones,
        beads.force, beads.moment, beads.force_gradient, beads.moment_gradient, error,
    )  # fmt: skip
    for i in range(n):
        if error[i] == np.inf:  # no table there
            beyond(
                position[i : i + 1], system.beyond, system.radius, system.n_mP, system.jones,
                beads.force[i : i + 1], beads.moment[i : i + 1],
                beads.force_gradient[i : i + 1], beads.moment_gradient[i : i + 1],
                error[i : i + 1],
            )  # fmt: skip
    for k in range(3):
        mobility, load = plan.mobility[k], plan.load[k]
        for i in range(n):
            out[k, i] = mobility * (beads.force[i, k] + load)
    for k in range(3, dims):
        for i in range(n):
            out[k, i] = plan.mobility[k] * beads.moment[i, k - 3]


@njit(error_model="numpy")
def velocities_after(weights, beads):  # type: ignore[no-untyped-def]
    """What drag, u and noise make of the velocities, in place."""
    dims, n = beads.x.shape
    if beads.v.shape[0] == 0:
        return
    for k in range(dims):
        decay, by_u = weights.decay[k], weights.v_by_u[k]
        shared, own = weights.noise_xv[k], weights.noise_v[k]
        v, u = beads.v[k], beads.u[k]
        with_x, alone = beads.normal[k], beads.normal[dims + k]
        for i in range(n):
            v[i] = decay * v[i] + by_u * u[i] + shared * with_x[i] + own * alone[i]
