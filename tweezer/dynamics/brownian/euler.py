"""One force at the begin of the step: Euler and Maruyama, or the exact step of a harmonic trap.

Which of them is a matter of the weights. With those of Euler and Maruyama (Kloeden and Platen
1992, 10.2) the inertial equations want steps below two relaxation times. With the exact ones, and
the trap's spring for the force, it is the propagator of Norrelykke and Flyvbjerg (Phys. Rev. E
83:041103 (2011), arXiv 1102.0524).
"""

from __future__ import annotations

import hashlib
from pathlib import Path

from numba import njit

from tweezer.dynamics.brownian.batch import slow_velocities

DIGEST = hashlib.sha256(Path(__file__).read_bytes()).hexdigest()


@njit(error_model="numpy")
def step(kernel, beyond, system, plan, weights, beads):  # type: ignore[no-untyped-def]
    """One step of all beads under the light."""
    slow_velocities(kernel, beyond, system, plan, beads, beads.x, beads.u)
    _move(weights, beads)


@njit(error_model="numpy")
def harmonic_step(plan, weights, beads):  # type: ignore[no-untyped-def]
    """One step of all beads on the spring of the weights."""
    x = beads.x
    for i in range(x.shape[0]):
        for k in range(x.shape[1]):
            beads.u[i, k] = weights.kappa[k] * (plan.centre[k] - x[i, k])
    _move(weights, beads)


@njit(error_model="numpy")
def _move(weights, beads):  # type: ignore[no-untyped-def]
    x, v, u, normal = beads.x, beads.v, beads.u, beads.normal
    n, dims = x.shape
    for i in range(n):
        for k in range(dims):
            x[i, k] += weights.by_u[k] * u[i, k] + weights.noise_x[k] * normal[i, k]
            if v.shape[1] > 0:
                x[i, k] += weights.by_v[k] * v[i, k]
                v[i, k] = (
                    weights.decay[k] * v[i, k] + weights.v_by_u[k] * u[i, k]
                    + weights.noise_xv[k] * normal[i, k] + weights.noise_v[k] * normal[i, dims + k]
                )  # fmt: skip
