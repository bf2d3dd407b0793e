"""Steps with one initial force: Euler-Maruyama, or the exact step of a harmonic trap.

The weights decide between them. With those of Euler and Maruyama (Kloeden and Platen 1992, 10.2)
the inertial equations require steps below two relaxation times. Without inertia the drag may depend
on the position: the noise uses its initial value, and the drift kT db/dx makes the distribution
Boltzmann's (Ermak and McCammon, J. Chem. Phys. 69:1352 (1978)). With the exact weights, and the
trap's spring as the force, the step is the propagator of Norrelykke and Flyvbjerg (Phys. Rev. E
83:041103 (2011), arXiv 1102.0524).
"""

from __future__ import annotations

import math

import numpy as np

from tweezer.compiled import cached_njit, call, named_njit
from tweezer.compiled.lanes import LANES, lanes, store
from tweezer.compiled.lanes import spread as spread_out
from tweezer.compiled.stack import borrowed
from tweezer.dynamics.brownian import propagator
from tweezer.dynamics.brownian.batch import (
    Linear,
    Scheme,
    exact,
    lead,
    slow_velocities,
    velocities_after,
)
from tweezer.dynamics.brownian.propagator import Weights
from tweezer.dynamics.layout import TRANSLATION


@cached_njit(error_model="numpy", nogil=True)
def step(force, plan, weights, beads):  # type: ignore[no-untyped-def]
    """Advance all beads by one step with the initial force.

    With a uniform drag the weights decide between Euler-Maruyama and an exact step.
    """
    force, plan, weights, beads = borrowed((force, plan, weights, beads))
    slow_velocities(force, plan, beads, beads.now[0], beads.x, beads.u)
    if plan.uniform:
        lead(weights, beads, beads.x)
        velocities_after(weights, beads)
    else:
        _move_by_place(plan, beads)


@named_njit(inner=True, error_model="numpy")
def _move_by_place(plan, beads):  # type: ignore[no-untyped-def]
    """Advance all beads by an Euler-Maruyama step with the drag at their present positions.

    It adds the drift kT db/dx of a mobility b that depends on the position. The force was evaluated
    before.
    """
    value, gradient = beads.resisted.value, beads.resisted.gradient
    call(plan.drag.kernel, (beads.pose, plan.drag.data, beads.resisted))
    for k in range(3):
        entry = 1 if k == 2 else 0
        x, force, normal = beads.x[k], beads.wrench.force, beads.normal[k]
        for i in range(force.shape[0]):
            mobility = value[i, entry]
            drift = mobility * (force[i, k] + plan.load[k]) + plan.kT * gradient[i, entry, k]
            spread = math.sqrt(2.0 * plan.kT * mobility * plan.step)
            x[i] += drift * plan.step + spread * normal[i]


@cached_njit(error_model="numpy", nogil=True)
def harmonic_step(force, plan, weights, beads):  # type: ignore[no-untyped-def]  # noqa: ARG001
    """Advance all beads by one exact step on the spring of the weights; no force is evaluated."""
    plan, weights, beads = borrowed((plan, weights, beads))
    dims, width = beads.x.shape
    for k in range(dims):
        kappa, centre = weights.kappa[k], plan.centre[k]
        for i in range(k * width, (k + 1) * width, LANES):
            store(beads.u, i, kappa * (centre - lanes(beads.x, i)))
    coupled = weights.coupled.shape[0]
    if coupled > 0:
        _move_coupled(plan, weights, beads)
    lead(weights, beads, beads.x)
    velocities_after(weights, beads)
    if coupled > 0:
        for k in range(3):
            beads.x[k] = beads.ahead[k]
            if coupled > 3:
                beads.v[k] = beads.u_ahead[k]


@named_njit(inner=True, error_model="numpy")
def _move_coupled(plan, weights, beads):  # type: ignore[no-untyped-def]
    """Compute an exact step on a spring that couples the axes, from a full matrix.

    New positions are stored in `beads.ahead` and new velocities in `beads.u_ahead`, because the old
    ones are needed until all are computed.
    """
    dims, width = beads.x.shape
    x, v, normal = beads.x, beads.v, beads.normal
    size = weights.coupled.shape[0]
    for k in range(size):
        out = beads.ahead if k < 3 else beads.u_ahead
        for i in range(0, width, LANES):
            led = spread_out(plan.centre[k]) if k < 3 else spread_out(0.0)
            for j in range(3):
                at = j * width + i
                left, spread = weights.coupled[k, j], weights.coupled_noise[k, j]
                led = led + left * (lanes(x, at) - plan.centre[j]) + spread * lanes(normal, at)
            for j in range(3, size):
                at = (j - 3) * width + i
                left, spread = weights.coupled[k, j], weights.coupled_noise[k, j]
                led = led + left * lanes(v, at) + spread * lanes(normal, at + dims * width)
            store(out, (k % 3) * width + i, led)


def weights(step: float, linear: Linear) -> Weights:
    """Return the coefficients of a step of Euler and Maruyama of the length `step`, s.

    The noise is a force of the variance 2 beta kT/h for the step h (2.16-2.20).
    """
    tau = linear.tau
    inertial = tau > 0
    none = np.zeros_like(tau)
    per_tau = np.divide(1.0, tau, out=none.copy(), where=inertial)
    spread = np.sqrt(2 * linear.diffusion * step)
    return Weights(
        by_v=np.where(inertial, step, 0.0),
        by_u=np.where(inertial, 0.0, step),
        by_rise=none,
        decay=np.where(inertial, 1 - step * per_tau, 0.0),
        v_by_u=step * per_tau,
        v_by_rise=none,
        kappa=none,
        noise_x=np.where(inertial, 0.0, spread),
        noise_xv=none,
        noise_v=spread * per_tau,
    )


def harmonic_weights(step: float, linear: Linear) -> Weights:
    """Return the exact coefficients of drag, any spring and noise for the length `step`, s."""
    alone = exact(step, linear)
    if np.array_equal(linear.rates, np.diag(np.diag(linear.rates))):
        return alone
    both = propagator.coupled(
        step, linear.tau[TRANSLATION], linear.rates, linear.diffusion[TRANSLATION]
    )
    return alone._replace(coupled=both[0], coupled_noise=both[1])


EULER_MARUYAMA = Scheme(step, weights, force_calls=1, resolves_drag=True)
HARMONIC = Scheme(harmonic_step, harmonic_weights, force_calls=0, memory=True)
