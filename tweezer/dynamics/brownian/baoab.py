"""BAOAB (Leimkuhler and Matthews 2013), OpenMM's LangevinMiddle but for the place of the kicks.

It is here for comparison: it samples positions right, but its clock is wrong at steps above tau:
the bead moves (h/2 tau) coth(h/2 tau) times too easily, and at long steps it is unstable.
"""

from __future__ import annotations

import hashlib
import math
from pathlib import Path

from numba import njit

from tweezer.dynamics.brownian.batch import slow_velocities

DIGEST = hashlib.sha256(Path(__file__).read_bytes()).hexdigest()


@njit(error_model="numpy")
def step(kernel, beyond, system, plan, beads):  # type: ignore[no-untyped-def]
    """One step of all beads; u is that at x, before and after."""
    x, v, u, normal = beads.x, beads.v, beads.u, beads.normal
    n, dims = x.shape
    h = plan.step
    for k in range(dims):
        kick = 0.5 * h / plan.tau[k]
        decay = math.exp(-h / plan.tau[k])
        spread = math.sqrt(-math.expm1(-2.0 * h / plan.tau[k]) * plan.diffusion[k] / plan.tau[k])
        for i in range(n):
            half = v[i, k] + kick * u[i, k]
            turned = decay * half + spread * normal[i, k]
            x[i, k] += 0.5 * h * (half + turned)
            v[i, k] = turned
    slow_velocities(kernel, beyond, system, plan, beads, x, u)
    for i in range(n):
        for k in range(dims):
            v[i, k] += 0.5 * h / plan.tau[k] * u[i, k]
