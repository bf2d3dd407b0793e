"""Leimkuhler and Matthews with exact drag: one force a step, for histograms and stiffness.

The force is evaluated at x* = x + tau (1 - e^(-h/tau)) v/2 + xi_x/2, and x* is also the sample
(Appl. Math. Res. Express 2013:34; here with the exact noise of the position). In a harmonic trap
the distribution of x* is exact up to steps of two trap times. The displacement of x* over a step
is wrong by construction, so its spectra are not the bead's.
"""

from __future__ import annotations

from tweezer.compiled import cached_njit
from tweezer.compiled.lanes import LANES, lanes, store
from tweezer.compiled.stack import borrowed
from tweezer.dynamics.brownian import memory
from tweezer.dynamics.brownian.batch import (
    Scheme,
    exact_without_springs,
    slow_velocities,
    velocities_after,
    without_memory,
)


@cached_njit(error_model="numpy", nogil=True)
def step(force, plan, weights, beads):  # type: ignore[no-untyped-def]
    """Advance all beads by one step with one force evaluation, at x*, which is left in
    `beads.ahead`.
    """
    force, plan, weights, beads = borrowed((force, plan, weights, beads))
    dims, width = beads.x.shape
    x, v, u, ahead = beads.x, beads.v, beads.u, beads.ahead
    first = without_memory(weights)
    if first > 0:
        u[:first] = 0.0
        memory.lead(weights, beads, ahead)
    for i in range(0, first * width, LANES):
        led = lanes(ahead, i)
        store(ahead, i, 0.5 * (lanes(x, i) + led))
        store(x, i, led)
    for k in range(first, dims):
        by_v, spread = weights.by_v[k], weights.noise_x[k]
        for i in range(k * width, (k + 1) * width, LANES):
            way = spread * lanes(beads.normal, i)
            if v.shape[0] > 0:
                way = way + by_v * lanes(v, i)
            store(ahead, i, lanes(x, i) + 0.5 * way)
            store(x, i, lanes(x, i) + way)
    slow_velocities(force, plan, beads, beads.now[0] + 0.5 * plan.step, ahead, u)
    for k in range(dims):
        by_u = weights.by_u[k]
        for i in range(k * width, (k + 1) * width, LANES):
            store(x, i, lanes(x, i) + by_u * lanes(u, i))
    velocities_after(weights, beads)


ONE_CALL = Scheme(step, exact_without_springs, force_calls=1, samples_ahead=True, memory=True)
