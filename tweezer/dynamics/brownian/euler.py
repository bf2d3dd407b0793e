"""One force at the begin of the step: Euler and Maruyama, or the exact step of a harmonic trap.

Which of them is a matter of the weights. With those of Euler and Maruyama (Kloeden and Platen
1992, 10.2) the inertial equations want steps below two relaxation times. With the exact ones, and
the trap's spring for the force, it is the propagator of Norrelykke and Flyvbjerg (Phys. Rev. E
83:041103 (2011), arXiv 1102.0524).
"""

from __future__ import annotations

from numba import njit

from tweezer.dynamics.brownian.batch import slow_velocities, velocities_after


@njit(error_model="numpy")
def step(kernel, beyond, system, plan, weights, beads):  # type: ignore[no-untyped-def]
    """One step of all beads under the light."""
    slow_velocities(kernel, beyond, system, plan, beads, beads.x, beads.u)
    _move(weights, beads)


@njit(error_model="numpy")
def harmonic_step(plan, weights, beads):  # type: ignore[no-untyped-def]
    """One step of all beads on the spring of the weights."""
    dims, n = beads.x.shape
    for k in range(dims):
        kappa, centre, x, u = weights.kappa[k], plan.centre[k], beads.x[k], beads.u[k]
        for i in range(n):
            u[i] = kappa * (centre - x[i])
    _move(weights, beads)


@njit(error_model="numpy")
def _move(weights, beads):  # type: ignore[no-untyped-def]
    dims, n = beads.x.shape
    for k in range(dims):
        by_u, spread = weights.by_u[k], weights.noise_x[k]
        x, u, normal = beads.x[k], beads.u[k], beads.normal[k]
        for i in range(n):
            x[i] += by_u * u[i] + spread * normal[i]
        if beads.v.shape[0] > 0:
            by_v, v = weights.by_v[k], beads.v[k]
            for i in range(n):
                x[i] += by_v * v[i]
    velocities_after(weights, beads)
