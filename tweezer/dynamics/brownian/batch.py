"""What every scheme shares: some beads side by side, and the force on all of them at once."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]

DIGEST = hashlib.sha256(Path(__file__).read_bytes()).hexdigest()


class Plan(NamedTuple):
    """How beads walk."""

    seed: int
    step: float
    """s"""
    per_sample: int
    loss: float
    """m, distance from the focus at which a bead is lost"""
    tau: Array
    """(dims,) s; 0 without inertia"""
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

    The angles are those turned in a step, about the inertial axes; e says what came before.
    """

    x: Array
    """(n, dims) m, and rad"""
    v: Array
    """(n, dims); (n, 0) without inertia"""
    e: Array
    """(n, 4); (n, 0) without rotation"""
    u: Array
    """(n, dims) slow velocities"""
    ahead: Array
    """(n, dims) where a step of lower order leads"""
    u_ahead: Array
    kick: Array
    """(n, dims) of the noise, where it depends on the place"""
    normal: Array
    """(n, dims or twice that)"""
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
        np.zeros((n, dims)), np.zeros((n, dims if inertial else 0)),
        np.zeros((n, 4 if dims == 6 else 0)), np.zeros((n, dims)), np.zeros((n, dims)),
        np.zeros((n, dims)), np.zeros((n, dims)), np.zeros((n, 2 * dims if inertial else dims)),
        np.zeros((n, 3)), np.zeros((n, 3)), np.zeros((n, 3)), np.zeros((gradients, 3, 3)),
        np.zeros((gradients, 3, 3)), np.zeros(n),
    )  # fmt: skip


@njit(error_model="numpy")
def slow_velocities(kernel, beyond, system, plan, beads, place, out):  # type: ignore[no-untyped-def]
    """u = (F + W)/beta_v, and M/beta_w, at `place` (n, dims)."""
    position, error = beads.position, beads.error
    n, dims = place.shape
    for i in range(n):
        for k in range(3):
            position[i, k] = place[i, k]
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
            out[i, k] = plan.mobility[k] * (beads.force[i, k] + plan.load[k])
        if dims == 6:
            for k in range(3):
                out[i, 3 + k] = plan.mobility[3 + k] * beads.moment[i, k]
