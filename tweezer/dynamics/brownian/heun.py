"""Exponential Heun: two forces a step, weak order 2 at any step over tau; the default.

Drag, the trap's own stiffness and the noise are taken exactly (`propagator`); what the force has
beyond the spring is predicted by a step of order 1, and taken as growing in proportion to the time
up to there. A harmonic trap is exact at any step. Without inertia it is stochastic Heun (Kloeden
and Platen 1992, 15.1) with the spring exact.
"""

from __future__ import annotations

import hashlib
from pathlib import Path

from numba import njit

from tweezer.dynamics.brownian.batch import slow_velocities

DIGEST = hashlib.sha256(Path(__file__).read_bytes()).hexdigest()


@njit(error_model="numpy")
def step(kernel, beyond, system, plan, weights, beads):  # type: ignore[no-untyped-def]
    """One step of all beads."""
    x, v, u, ahead, normal = beads.x, beads.v, beads.u, beads.ahead, beads.normal
    n, dims = x.shape
    slow_velocities(kernel, beyond, system, plan, beads, x, u)
    for i in range(n):
        for k in range(dims):
            ahead[i, k] = x[i, k] + weights.by_u[k] * u[i, k] + weights.noise_x[k] * normal[i, k]
    if v.shape[1] > 0:
        for i in range(n):
            for k in range(dims):
                ahead[i, k] += weights.by_v[k] * v[i, k]
                v[i, k] = (
                    weights.decay[k] * v[i, k] + weights.v_by_u[k] * u[i, k]
                    + weights.noise_xv[k] * normal[i, k] + weights.noise_v[k] * normal[i, dims + k]
                )  # fmt: skip
    slow_velocities(kernel, beyond, system, plan, beads, ahead, beads.u_ahead)
    for i in range(n):
        for k in range(dims):
            rise = beads.u_ahead[i, k] - u[i, k] + weights.kappa[k] * (ahead[i, k] - x[i, k])
            x[i, k] = ahead[i, k] + weights.by_rise[k] * rise
            if v.shape[1] > 0:
                v[i, k] += weights.v_by_rise[k] * rise
