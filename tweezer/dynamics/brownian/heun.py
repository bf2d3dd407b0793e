"""Exponential Heun: two forces a step, weak order 2 at any step over tau; the default.

Drag, the trap's own stiffness and the noise are taken exactly (`propagator`); what the force has
beyond the spring is predicted by a step of order 1, and taken as growing in proportion to the time
up to there. A harmonic trap of a diagonal stiffness is exact at any step; entries beside the
diagonal are of weak order 2, as what the force has beyond the spring. Without inertia it is
stochastic Heun (Kloeden and Platen 1992, 15.1) with the spring exact.
"""

from __future__ import annotations

from tweezer.compiled import cached_njit
from tweezer.dynamics.brownian import propagator
from tweezer.dynamics.brownian.batch import (
    Linear,
    Scheme,
    slow_velocities,
    velocities_after,
)
from tweezer.dynamics.brownian.propagator import Weights


@cached_njit(error_model="numpy", nogil=True)
def step(force, plan, weights, beads):  # type: ignore[no-untyped-def]
    """One step of all beads."""
    dims, n = beads.x.shape
    inertial = beads.v.shape[0] > 0
    slow_velocities(force, plan, beads, beads.now[0], beads.x, beads.u)
    for k in range(dims):
        by_u, spread = weights.by_u[k], weights.noise_x[k]
        x, u, ahead, normal = beads.x[k], beads.u[k], beads.ahead[k], beads.normal[k]
        for i in range(n):
            ahead[i] = x[i] + by_u * u[i] + spread * normal[i]
        if inertial:
            by_v, v = weights.by_v[k], beads.v[k]
            for i in range(n):
                ahead[i] += by_v * v[i]
    velocities_after(weights, beads)
    after = beads.now[0] + plan.step
    slow_velocities(force, plan, beads, after, beads.ahead, beads.u_ahead)
    for k in range(dims):
        kappa, by_rise = weights.kappa[k], weights.by_rise[k]
        x, u, ahead, u_ahead = beads.x[k], beads.u[k], beads.ahead[k], beads.u_ahead[k]
        for i in range(n):
            # of the force beyond the spring
            u_ahead[i] += kappa * (ahead[i] - x[i]) - u[i]
            x[i] = ahead[i] + by_rise * u_ahead[i]
        if inertial:
            v_by_rise, v = weights.v_by_rise[k], beads.v[k]
            for i in range(n):
                v[i] += v_by_rise * u_ahead[i]


def weights(step: float, linear: Linear) -> Weights:
    """Drag, spring and noise, exactly."""
    return propagator.exact(step, linear.tau, linear.kappa, linear.diffusion)


HEUN = Scheme(step, weights, force_calls=2)
