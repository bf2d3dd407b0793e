"""BAOAB (Leimkuhler and Matthews 2013), OpenMM's LangevinMiddle but for the place of the kicks.

It is here for comparison: it samples positions right, but its clock is wrong at steps above tau:
the bead moves (h/2 tau) coth(h/2 tau) times too easily, and at long steps it is unstable.
"""

from __future__ import annotations

from numba import njit

from tweezer.dynamics.brownian.batch import slow_velocities


@njit(error_model="numpy")
def step(kernel, beyond, system, plan, weights, beads):  # type: ignore[no-untyped-def]
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
    slow_velocities(kernel, beyond, system, plan, beads, beads.x, beads.u)
    for k in range(dims):
        kick, v, u = weights.v_by_u[k], beads.v[k], beads.u[k]
        for i in range(n):
            v[i] += kick * u[i]
