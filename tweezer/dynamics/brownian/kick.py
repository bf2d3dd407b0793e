"""Kicks between exact swings: the choice at low damping, with two force calls per step.

The force consists of the spring of the trap and the rest. Between kicks a bead moves exactly under
drag, spring and noise (`propagator`). A kick changes the velocity by the rest of the force. Kicks
have the times and weights of Simpson's rule, so that a step of length h is

    K(h/6) S(h/2) K(2h/3) S(h/2) K(h/6),    K(t): v -> v + t (F + k (x - x_0))/m,

where S is the exact motion for m, beta, k and kT. This is the method SBAB_2 (J. Laskar, P. Robutel,
Celest. Mech. Dyn. Astron. 80, 39 (2001)) with drag and noise. If the rest of the force is a small
part e of it, the error is of order e h^4 + e^2 h^2. Without damping the step is symplectic and
symmetric in time: the energy oscillates but does not drift. Heun's method loses energy at a rate
proportional to h^3.
"""

from __future__ import annotations

from tweezer.compiled import cached_njit, named_njit
from tweezer.compiled.lanes import LANES, lanes, spread, store
from tweezer.compiled.stack import borrowed
from tweezer.dynamics.brownian.batch import Linear, Scheme, exact, slow_velocities
from tweezer.dynamics.brownian.coordinate import led, relaxed
from tweezer.dynamics.brownian.propagator import Weights


@cached_njit(error_model="numpy", nogil=True)
def step(force, plan, weights, beads):  # type: ignore[no-untyped-def]
    """Advance all beads by one step: two swings, with kicks before, between and after them.

    `beads.u` contains the slow velocity (force over drag) at `beads.x` on entry and on return.
    `weights` belongs to a swing, which takes half a step.
    """
    force, plan, weights, beads = borrowed((force, plan, weights, beads))
    now, step, x, u = beads.now[0], plan.step, beads.x, beads.u
    _kick(step / 6, plan, weights, beads)
    _swing(0, plan, weights, beads)
    slow_velocities(force, plan, beads, now + 0.5 * step, x, u)
    _kick(2 * step / 3, plan, weights, beads)
    _swing(2 * x.shape[0], plan, weights, beads)
    slow_velocities(force, plan, beads, now + step, x, u)
    _kick(step / 6, plan, weights, beads)


@named_njit(inner=True, error_model="numpy")
def _kick(time, plan, weights, beads):  # type: ignore[no-untyped-def]
    """Change the velocities as the force beyond the spring's does in a time, s."""
    dims, width = beads.x.shape
    for k in range(dims):
        kappa, centre, part = weights.kappa[k], spread(plan.centre[k]), time / plan.tau[k]
        for i in range(k * width, (k + 1) * width, LANES):
            beyond = lanes(beads.u, i) - kappa * (centre - lanes(beads.x, i))
            store(beads.v, i, lanes(beads.v, i) + part * beyond)


@named_njit(inner=True, error_model="numpy")
def _swing(first, plan, weights, beads):  # type: ignore[no-untyped-def]
    """Advance positions and velocities exactly under drag, spring and noise.

    Its random numbers begin at the row `first` of `beads.normal`.
    """
    x, v, normal = beads.x, beads.v, beads.normal
    dims, width = x.shape
    for k in range(dims):
        kappa, centre = weights.kappa[k], spread(plan.centre[k])
        shared, own = weights.noise_xv[k], weights.noise_v[k]
        for i in range(k * width, (k + 1) * width, LANES):
            here, speed, number = lanes(x, i), lanes(v, i), lanes(normal, first * width + i)
            spring = kappa * (centre - here)
            drawn = shared * number + own * lanes(normal, (first + dims) * width + i)
            there = led(here, spring, number, weights.by_u[k], weights.noise_x[k])
            store(x, i, there + weights.by_v[k] * speed)
            store(v, i, relaxed(speed, spring, weights.decay[k], weights.v_by_u[k], drawn))


def weights(step: float, linear: Linear) -> Weights:
    """Return the exact coefficients of a swing, which takes half a step of the length `step`, s."""
    return exact(0.5 * step, linear)


KICK = Scheme(
    step, weights, force_calls=2, force_first=True, swings=2, resolves_drag=True, part_of_swing=0.4
)  # fmt: skip
