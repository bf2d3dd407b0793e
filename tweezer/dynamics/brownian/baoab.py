"""BAOAB (Leimkuhler and Matthews 2013), OpenMM's LangevinMiddle but for the place of the kicks.

It is here for comparison: it samples positions right, but its clock is wrong at steps above tau:
the bead moves (h/2 tau) coth(h/2 tau) times too easily, and at long steps it is unstable.
"""

from __future__ import annotations

import numpy as np

from tweezer.compiled import cached_njit
from tweezer.dynamics.brownian.batch import Linear, Scheme, slow_velocities
from tweezer.dynamics.brownian.propagator import Weights


@cached_njit(error_model="numpy", nogil=True)
def step(force, plan, weights, beads):  # type: ignore[no-untyped-def]
    """One step of all beads; u is that at x, before and after."""
    dims, n = beads.x.shape
    for k in range(dims):
        drift, kick = weights.by_v[k], weights.v_by_u[k]
        decay, spread = weights.decay[k], weights.noise_v[k]
        x, v, u, normal = beads.x[k], beads.v[k], beads.u[k], beads.normal[k]
        for i in range(n):
            half = v[i] + kick * u[i]
            v[i] = decay * half + spread * normal[i]
            x[i] += drift * (half + v[i])
    slow_velocities(force, plan, beads, beads.now[0] + plan.step, beads.x, beads.u)
    for k in range(dims):
        kick, v, u = weights.v_by_u[k], beads.v[k], beads.u[k]
        for i in range(n):
            v[i] += kick * u[i]


def weights(step: float, linear: Linear) -> Weights:
    """The parts of a step of BAOAB: by_v half a drift, v_by_u half a kick, and what drag leaves."""
    tau = linear.tau
    none = np.zeros_like(tau)
    return Weights(
        by_v=np.full_like(tau, 0.5 * step),
        by_u=none,
        by_rise=none,
        decay=np.exp(-step / tau),
        v_by_u=0.5 * step / tau,
        v_by_rise=none,
        kappa=none,
        noise_x=none,
        noise_xv=none,
        noise_v=np.sqrt(-np.expm1(-2 * step / tau) * linear.diffusion / tau),
    )


BAOAB = Scheme(
    step, weights, force_calls=1, noise_of_position=False, force_first=True,
    resolves_drag=True,
)  # fmt: skip
