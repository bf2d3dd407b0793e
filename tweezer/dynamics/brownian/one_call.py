"""Leimkuhler and Matthews with exact drag: one force a step, for histograms and stiffness.

The force is asked at x* = x + tau (1 - e^(-h/tau)) v/2 + xi_x/2, and statistics are those of x*
(Appl. Math. Res. Express 2013:34; here with the exact noise of the position). In a harmonic trap
the distribution of x* is exact up to steps of two trap times; the displacement of x* over a step
is wrong by construction, so its spectra are not the bead's.
"""

from __future__ import annotations

import hashlib
from pathlib import Path

from numba import njit

from tweezer.dynamics.brownian.batch import slow_velocities

DIGEST = hashlib.sha256(Path(__file__).read_bytes()).hexdigest()


@njit(error_model="numpy")
def step(kernel, beyond, system, plan, weights, beads):  # type: ignore[no-untyped-def]
    """One step of all beads; `ahead` is left at x*."""
    x, v, u, ahead, normal = beads.x, beads.v, beads.u, beads.ahead, beads.normal
    n, dims = x.shape
    for i in range(n):
        for k in range(dims):
            moved = weights.noise_x[k] * normal[i, k]
            if v.shape[1] > 0:
                moved += weights.by_v[k] * v[i, k]
            ahead[i, k] = x[i, k] + 0.5 * moved
            x[i, k] += moved
    slow_velocities(kernel, beyond, system, plan, beads, ahead, u)
    for i in range(n):
        for k in range(dims):
            x[i, k] += weights.by_u[k] * u[i, k]
            if v.shape[1] > 0:
                v[i, k] = (
                    weights.decay[k] * v[i, k] + weights.v_by_u[k] * u[i, k]
                    + weights.noise_xv[k] * normal[i, k] + weights.noise_v[k] * normal[i, dims + k]
                )  # fmt: skip
