"""Leimkuhler and Matthews with exact drag: one force a step, for histograms and stiffness.

The force is asked at x* = x + tau (1 - e^(-h/tau)) v/2 + xi_x/2, and statistics are those of x*
(Appl. Math. Res. Express 2013:34; here with the exact noise of the position). In a harmonic trap
the distribution of x* is exact up to steps of two trap times; the displacement of x* over a step
is wrong by construction, so its spectra are not the bead's.
"""

from __future__ import annotations

import numpy as np

from tweezer.compiled import cached_njit
from tweezer.dynamics.brownian import propagator
from tweezer.dynamics.brownian.batch import Linear, Scheme, slow_velocities, velocities_after
from tweezer.dynamics.brownian.propagator import Weights


@cached_njit(error_model="numpy", nogil=True)
def step(force, plan, weights, beads):  # type: ignore[no-untyped-def]
    """One step of all beads; `ahead` is left at x*."""
    dims, n = beads.x.shape
    for k in range(dims):
        spread = weights.noise_x[k]
        x, ahead, normal = beads.x[k], beads.ahead[k], beads.normal[k]
        for i in range(n):
            ahead[i] = x[i] + 0.5 * spread * normal[i]
            x[i] += spread * normal[i]
        if beads.v.shape[0] > 0:
            by_v, v = weights.by_v[k], beads.v[k]
            for i in range(n):
                ahead[i] += 0.5 * by_v * v[i]
                x[i] += by_v * v[i]
    middle = beads.now[0] + 0.5 * plan.step
    slow_velocities(force, plan, beads, middle, beads.ahead, beads.u)
    for k in range(dims):
        by_u, x, u = weights.by_u[k], beads.x[k], beads.u[k]
        for i in range(n):
            x[i] += by_u * u[i]
    velocities_after(weights, beads)


def weights(step: float, linear: Linear) -> Weights:
    """Drag and noise, exactly."""
    none = np.zeros_like(linear.kappa)
    return propagator.exact(step, linear.tau, none, linear.diffusion)


ONE_CALL = Scheme(step, weights, force_calls=1, samples_ahead=True)
