"""Heun for the model of first order in tau: the corrected Smoluchowski equation as increments.

Its flux is J = (1 - tau Du)(u n - D grad n) (`derivation.langevin.SMOLUCHOWSKI`; Wilemski, J. Stat.
Phys. 14:153 (1976), Titulaer, Physica A 91:321 (1978)). The same flux results from

    dx = (1 - tau Du) u dt + sqrt(2 D) (1 - tau Du/2) dW,

where the factor of the noise is taken at the end of the step (Hanggi-Klimontovich). This adds the
drift D div(1 - tau Du), which the flux implies.
"""

from __future__ import annotations

from tweezer.compiled import cached_njit, named_njit
from tweezer.compiled.lanes import LANES, lanes, store
from tweezer.compiled.stack import borrowed
from tweezer.dynamics.brownian import propagator
from tweezer.dynamics.brownian.batch import Linear, Scheme, slow_velocities
from tweezer.dynamics.brownian.coordinate import beyond_spring, led
from tweezer.dynamics.brownian.propagator import Weights


@named_njit(inner=True, error_model="numpy")
def _reduced(part, gradient, vectors, out):  # type: ignore[no-untyped-def]
    """Fill `out` (3, n) with (1 - part G) times each vector, where G is the force gradient.

    So (1 - tau Du) acts on slow velocities u and on the noise. `part` is mobility times relaxation
    time, or half of it (m/N), and `gradient` (n, 3, 3) is dF_i/dx_j (N/m). `vectors` (3, n) and
    `out` may be the same array.
    """
    for i in range(gradient.shape[0]):
        x, y, z = vectors[0, i], vectors[1, i], vectors[2, i]
        for k in range(3):
            change = gradient[i, k, 0] * x + gradient[i, k, 1] * y + gradient[i, k, 2] * z
            out[k, i] = vectors[k, i] - part * change


@cached_njit(error_model="numpy", nogil=True)
def step(force, plan, weights, beads):  # type: ignore[no-untyped-def]
    """Advance all beads by one step of Heun for the corrected Smoluchowski equation.

    The force and its gradient are evaluated at `beads.x` and `beads.ahead`.
    """
    force, plan, weights, beads = borrowed((force, plan, weights, beads))
    x, u, ahead, u_ahead, kick = beads.x, beads.u, beads.ahead, beads.u_ahead, beads.kick
    part, gradient = plan.tau[0] * plan.mobility[0], beads.wrench.force_gradient
    width = x.shape[1]
    slow_velocities(force, plan, beads, beads.now[0], x, u)
    _reduced(part, gradient, u, u)
    _reduced(0.5 * part, gradient, beads.normal, kick)
    for k in range(3):
        by_u, spread = weights.by_u[k], weights.noise_x[k]
        for i in range(k * width, (k + 1) * width, LANES):
            store(ahead, i, led(lanes(x, i), lanes(u, i), lanes(kick, i), by_u, spread))
    slow_velocities(force, plan, beads, beads.now[0] + plan.step, ahead, u_ahead)
    _reduced(part, gradient, u_ahead, u_ahead)
    _reduced(0.5 * part, gradient, beads.normal, kick)
    for k in range(3):
        kappa, by_rise = weights.kappa[k], weights.by_rise[k]
        by_u, spread = weights.by_u[k], weights.noise_x[k]
        for i in range(k * width, (k + 1) * width, LANES):
            begun, pull = lanes(x, i), lanes(u, i)
            rise = beyond_spring(begun, lanes(ahead, i), pull, lanes(u_ahead, i), kappa)
            way = by_u * pull + by_rise * rise + spread * lanes(kick, i)
            store(x, i, begun + way)


def weights(step: float, linear: Linear) -> Weights:
    """Return the exact coefficients of spring and noise in a step of the length `step`, s.

    The rate of the spring is kappa (1 + kappa tau), to first order in the relaxation time tau.
    """
    kappa = linear.kappa * (1 + linear.kappa * linear.epsilon)
    return propagator.exact(step, linear.tau, kappa, linear.diffusion)


FIRST_ORDER = Scheme(step, weights, force_calls=2, gradient=True)
