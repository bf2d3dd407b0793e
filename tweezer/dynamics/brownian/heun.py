"""Exponential Heun method, the default: two force calls per step, weak order 2 for any step/tau.

Drag, the stiffness of the trap and the noise are integrated exactly (`propagator`). A step of order
1 predicts the position. The remaining force is assumed to change linearly in time up to the
predicted position. The motion in a harmonic trap with a diagonal stiffness matrix is exact for any
step. Off-diagonal entries, like the remaining force, are integrated with weak order 2. Without
inertia this is stochastic Heun (Kloeden and Platen 1992, 15.1) with an exact spring.
"""

from __future__ import annotations

from tweezer.compiled import cached_njit
from tweezer.compiled.lanes import LANES, lanes, store
from tweezer.compiled.stack import borrowed
from tweezer.dynamics.brownian import memory
from tweezer.dynamics.brownian.batch import (
    Scheme,
    exact,
    lead,
    slow_velocities,
    velocities_after,
    without_memory,
)
from tweezer.dynamics.brownian.coordinate import beyond_spring


@cached_njit(error_model="numpy", nogil=True)
def step(force, plan, weights, beads):  # type: ignore[no-untyped-def]
    """Advance all beads by one step of exponential Heun: predict with the force at x, then correct.

    Rows of `beads` are changed in place; the force is evaluated at `beads.x` and `beads.ahead`.
    """
    force, plan, weights, beads = borrowed((force, plan, weights, beads))
    dims, width = beads.x.shape
    x, v, u, ahead, u_ahead = beads.x, beads.v, beads.u, beads.ahead, beads.u_ahead
    inertial, first = v.shape[0] > 0, without_memory(weights)
    slow_velocities(force, plan, beads, beads.now[0], x, u)
    lead(weights, beads, ahead)
    velocities_after(weights, beads)
    slow_velocities(force, plan, beads, beads.now[0] + plan.step, ahead, u_ahead)
    if first > 0:
        memory.rise(weights, beads)
    for k in range(first, dims):
        kappa, by_rise, v_by_rise = weights.kappa[k], weights.by_rise[k], weights.v_by_rise[k]
        for i in range(k * width, (k + 1) * width, LANES):
            there = lanes(ahead, i)
            rise = beyond_spring(lanes(x, i), there, lanes(u, i), lanes(u_ahead, i), kappa)
            store(x, i, there + by_rise * rise)
            if inertial:
                store(v, i, lanes(v, i) + v_by_rise * rise)


HEUN = Scheme(step, exact, force_calls=2, memory=True)
