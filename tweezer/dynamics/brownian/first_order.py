"""Heun for the model of first order in tau: the corrected Smoluchowski equation as increments.

Its flux, J = (1 - tau Du)(u n - D grad n) (`derivation.langevin.SMOLUCHOWSKI`; Wilemski, J. Stat.
Phys. 14:153 (1976), Titulaer, Physica A 91:321 (1978)), is that of

    dx = (1 - tau Du) u dt + sqrt(2 D) (1 - tau Du/2) dW,

where the factor of the noise is taken at the end of the step (Hanggi-Klimontovich): that brings the
drift D div(1 - tau Du) which the flux implies.
"""

from __future__ import annotations

import hashlib
from pathlib import Path

from numba import njit

from tweezer.dynamics.brownian.batch import slow_velocities

DIGEST = hashlib.sha256(Path(__file__).read_bytes()).hexdigest()


@njit(error_model="numpy")
def _reduced(part, gradient, i, vectors, out):  # type: ignore[no-untyped-def]
    """out = (1 - part dF_i/dx_j) vectors, of bead i; out may be `vectors`."""
    x, y, z = vectors[i, 0], vectors[i, 1], vectors[i, 2]
    for k in range(3):
        change = gradient[i, k, 0] * x + gradient[i, k, 1] * y + gradient[i, k, 2] * z
        out[i, k] = vectors[i, k] - part * change


@njit(error_model="numpy")
def step(kernel, beyond, system, plan, weights, beads):  # type: ignore[no-untyped-def]
    """One step of all beads."""
    x, u, ahead, normal, kick = beads.x, beads.u, beads.ahead, beads.normal, beads.kick
    tau, mobility, gradient = plan.tau[0], plan.mobility[0], beads.force_gradient
    n = x.shape[0]
    slow_velocities(kernel, beyond, system, plan, beads, x, beads.u_ahead)
    for i in range(n):
        _reduced(tau * mobility, gradient, i, beads.u_ahead, u)
        _reduced(0.5 * tau * mobility, gradient, i, normal, kick)
        for k in range(3):
            ahead[i, k] = x[i, k] + weights.by_u[k] * u[i, k] + weights.noise_x[k] * kick[i, k]
    slow_velocities(kernel, beyond, system, plan, beads, ahead, beads.u_ahead)
    for i in range(n):
        _reduced(0.5 * tau * mobility, gradient, i, normal, kick)
        _reduced(tau * mobility, gradient, i, beads.u_ahead, beads.u_ahead)
        for k in range(3):
            rise = beads.u_ahead[i, k] - u[i, k] + weights.kappa[k] * (ahead[i, k] - x[i, k])
            x[i, k] += (
                weights.by_u[k] * u[i, k] + weights.by_rise[k] * rise
                + weights.noise_x[k] * kick[i, k]
            )  # fmt: skip
