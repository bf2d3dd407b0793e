"""The BAOAB scheme (Leimkuhler and Matthews 2013), for comparison with the default.

It is OpenMM's LangevinMiddle with the kicks at other times. It samples positions correctly. At
steps h above tau its dynamics are too fast: the mobility is too large by (h/2 tau) coth(h/2 tau).
At long steps it is unstable.
"""

from __future__ import annotations

import numpy as np

from tweezer.compiled import cached_njit
from tweezer.compiled.lanes import LANES, lanes, store
from tweezer.compiled.stack import borrowed
from tweezer.dynamics.brownian.batch import Linear, Scheme, slow_velocities
from tweezer.dynamics.brownian.propagator import Weights


@cached_njit(error_model="numpy", nogil=True)
def step(force, plan, weights, beads):  # type: ignore[no-untyped-def]
    """Advance all beads by one step: half kick, half drift, drag and noise, half drift, half kick.

    `beads.u` contains the slow velocity (force over drag) at `beads.x` on entry and on return. The
    function `weights` returns the coefficients `weights`.
    """
    force, plan, weights, beads = borrowed((force, plan, weights, beads))
    dims, width = beads.x.shape
    x, v, u = beads.x, beads.v, beads.u
    for k in range(dims):
        drift, kick = weights.by_v[k], weights.v_by_u[k]
        decay, spread = weights.decay[k], weights.noise_v[k]
        for i in range(k * width, (k + 1) * width, LANES):
            half = lanes(v, i) + kick * lanes(u, i)
            after = decay * half + spread * lanes(beads.normal, i)
            store(v, i, after)
            store(x, i, lanes(x, i) + drift * (half + after))
    slow_velocities(force, plan, beads, beads.now[0] + plan.step, x, u)
    for k in range(dims):
        kick = weights.v_by_u[k]
        for i in range(k * width, (k + 1) * width, LANES):
            store(v, i, lanes(v, i) + kick * lanes(u, i))


def weights(step: float, linear: Linear) -> Weights:
    """Return the coefficients of a BAOAB step of the length `step`, s.

    The half drift by_v is half of the step, and the half kick v_by_u is by_v/tau. The exact effect
    of drag and noise on the velocity is given by decay and noise_v.
    """
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
