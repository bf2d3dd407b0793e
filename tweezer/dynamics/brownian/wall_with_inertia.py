"""Steps beside a wall, with inertia: exact at constant friction, then corrected for its change.

An exact step h with the initial friction neglects the change of the friction. To first order the
correlation of position and velocity then lacks (`derivation.wall`)

    kT mu' [h - 2 tau (1 - E) + h E]   of the position,
    kT mu' [1 - E - (h/tau) E]   of the velocity,   E = e^(-h/tau), tau = m mu.

The first term is split. The noise spreads a bead by 2 kT mu h', with h' = h - 2 tau (1 - E) +
tau (1 - E^2)/2. The drift of the plane of the gap (`tweezer.dynamics.brownian.plane`) accounts for
the part h' of the term. In that plane noise, force and drift act for the time h', and the force
acts, by Heun's rule, for the rest of h. The displacement by the velocity, tau (1 - E) v, is added
to r such that the gap gains exactly this, up to its third power. Without inertia this is the step
of `tweezer.dynamics.brownian.wall`. As |W| gives the gap, no bead passes through the wall.

At contact the friction is infinite and inertia has no effect: the velocity relaxes within any step
and is Maxwell distributed. A fast bead is stopped by the friction and not thrown back. The step is
limited by the free flight of a bead, sqrt(kT m)/beta, in radii. In a liquid it is parts in a
thousand, so the force alone limits the step.

The friction along the wall depends on the gap alone and requires no correction.
"""

from __future__ import annotations

import math

import numpy as np

from tweezer.compiled import cached_njit, named_njit
from tweezer.compiled.lanes import LANES, lanes, store
from tweezer.compiled.stack import borrowed
from tweezer.dynamics.brownian.batch import Scheme, exact_without_springs, slow_velocities
from tweezer.dynamics.brownian.plane import RADIUS, RATE, by_gap, by_square, data_of, nearest
from tweezer.forces.data import number

#: Step over the relaxation time below which its functions are series
_SHORT = 1e-2

#: Rows that a step keeps of each bead. At the beginning: the direction from the nearer plane, its
#: position, r, S, T and the mobility along it. Then the predicted W in the plane (two rows), and S
#: and T there. Last come the results of `_of_step` along the plane (BESIDE) and towards it
AWAY, PLANE, R, S, T, ALONG, W, ACROSS, S_AHEAD, T_AHEAD, BESIDE, TOWARDS, ROWS = (
    *range(11), 15, 20,
)  # fmt: skip


@named_njit(inner=True, error_model="numpy")
def _of_step(step, tau):  # type: ignore[no-untyped-def]
    """Return five functions of a step h of a bead with the relaxation time tau, both in s.

    They are E = e^(-h/tau), 1 - E, tau (1 - E), the time h' whose diffusion has the spread of the
    step, and the displacement per change of the slow velocity over the step. The last three are in
    s.
    """
    if not tau > 0.0:
        return 0.0, 1.0, 0.0, step, 0.5 * step
    q = step / tau
    gone = -math.expm1(-q)
    left = 1.0 - gone
    if q < _SHORT:
        spreading = q * q * (1 / 3 - q * (1 / 4 - q * (7 / 60 - q / 24)))
        rise = q * (1 / 6 - q * (1 / 24 - q * (1 / 120 - q / 720)))
    else:
        spreading = 1.0 - (2.0 * gone - 0.5 * (1.0 - left * left)) / q
        rise = 0.5 - (1.0 - gone / q) / q
    return left, gone, tau * gone, step * spreading, step * rise


@named_njit(inner=True, error_model="numpy")
def _keep(kept, first, i, functions):  # type: ignore[no-untyped-def]
    """Store the five functions of `_of_step` for bead i, in the rows from `first` of `kept`."""
    kept[first, i], kept[first + 1, i], kept[first + 2, i] = functions[:3]
    kept[first + 3, i], kept[first + 4, i] = functions[3:]


@named_njit(inner=True, error_model="numpy")
def _kept(kept, first, i):  # type: ignore[no-untyped-def]
    """Return the five functions of `_of_step` for bead i that `_keep` stored."""
    return (
        kept[first, i], kept[first + 1, i], kept[first + 2, i], kept[first + 3, i],
        kept[first + 4, i],
    )  # fmt: skip


@named_njit(inner=True, error_model="numpy")
def _look(data, x, kept):  # type: ignore[no-untyped-def]
    """Fill the rows AWAY to ALONG of `kept` with plane, r, S, T and mobility when a step begins.

    `data` comes from `plane.data_of`, and `x` (3, w) are positions (m).
    """
    width = x.shape[1]
    for i in range(0, width, LANES):
        g, away, plane = nearest(data, lanes(x, 2 * width + i))
        r, of_force, drift, mobilities = by_gap(data, g, away)
        store(kept, AWAY * width + i, away)
        store(kept, PLANE * width + i, plane)
        store(kept, R * width + i, r)
        store(kept, S * width + i, of_force)
        store(kept, T * width + i, drift)
        store(kept, ALONG * width + i, mobilities[0])


@cached_njit(error_model="numpy", nogil=True)
def step(force, plan, weights, beads):  # type: ignore[no-untyped-def]  # noqa: ARG001
    """Advance all beads by one step with inertia beside a wall, with two force evaluations.

    Along the wall friction is constant in a step. Across it the gap is the length of W = (w,
    across) in a plane; see the module and `plane`.
    """
    force, plan, beads = borrowed((force, plan, beads))
    data = plan.drag.data
    radius, rate = number(data, RADIUS), number(data, RATE)
    width, h, free, D = beads.x.shape[1], plan.step, plan.tau[0], plan.diffusion[0]
    x, v, u, ahead, u_ahead, normal = (
        beads.x, beads.v, beads.u, beads.ahead, beads.u_ahead, beads.normal,
    )  # fmt: skip
    kept = np.empty((ROWS, width))
    slow_velocities(force, plan, beads, beads.now[0], x, u)
    _look(data, x, kept)
    for i in range(width):
        along = kept[ALONG, i]
        functions = _of_step(h, free * along)
        _keep(kept, BESIDE, i, functions)
        _, _, way, spreading, _ = functions
        for k in range(2):
            led = way * v[k, i] + along * (h - way) * u[k, i]
            ahead[k, i] = x[k, i] + led + math.sqrt(2.0 * D * along * spreading) * normal[k, i]
        r, scale = kept[R, i], kept[S, i] * kept[R, i]
        mu, slope = 0.5 * scale * scale, kept[S, i] * (2.0 * r * r * kept[T, i] + 1.0)
        functions = _of_step(h, free * mu)
        _keep(kept, TOWARDS, i, functions)
        left, gone, way, spreading, _ = functions
        # displacement by the velocity, over the derivative of the gap by r
        flight = 0.5 * free * gone * kept[AWAY, i] * v[2, i] / radius
        flown = flight * scale * (1.0 - 0.5 * slope * flight)
        rest = h * left - 0.5 * free * mu * (1.0 - left * left)
        flown += rate * slope * rest / scale if scale > 0.0 else 0.0
        pull = kept[S, i] * kept[AWAY, i] * u[2, i] / (2.0 * radius)
        wide = math.sqrt(rate * spreading)
        moved = ((h - way) * pull + spreading * rate * kept[T, i]) * r
        kept[W, i] = r + flown + moved + wide * normal[2, i]
        kept[ACROSS, i] = wide * normal[6, i]
    for i in range(0, width, LANES):
        w, across = lanes(kept, W * width + i), lanes(kept, ACROSS * width + i)
        away = lanes(kept, AWAY * width + i)
        g, of_force, drift, _ = by_square(data, w * w + across * across, away)
        store(ahead, 2 * width + i, lanes(kept, PLANE * width + i) + away * (radius + radius * g))
        store(kept, S_AHEAD * width + i, of_force)
        store(kept, T_AHEAD * width + i, drift)
    slow_velocities(force, plan, beads, beads.now[0] + h, ahead, u_ahead)
    for i in range(width):
        along = kept[ALONG, i]
        left, gone, way, spreading, by_rise = _kept(kept, BESIDE, i)
        shared, own = _noise_of_velocity(D * along, free * along, left, gone, spreading)
        for k in range(2):
            begun, rise = along * u[k, i], along * (u_ahead[k, i] - u[k, i])
            x[k, i] = ahead[k, i] + by_rise * rise
            v[k, i] = (
                left * v[k, i] + gone * begun + (1.0 - way / h) * rise
                + shared * normal[k, i] + own * normal[3 + k, i]
            )  # fmt: skip
        r, w, across, away = kept[R, i], kept[W, i], kept[ACROSS, i], kept[AWAY, i]
        scale, scale_ahead = kept[S, i] * r, kept[S_AHEAD, i] * math.sqrt(w * w + across * across)
        mu, mu_ahead = 0.5 * scale * scale, 0.5 * scale_ahead * scale_ahead
        slope = kept[S, i] * (2.0 * r * r * kept[T, i] + 1.0)
        left, gone, way, spreading, by_rise = _kept(kept, TOWARDS, i)
        pull = kept[S, i] * away * u[2, i] / (2.0 * radius)
        pull_ahead = kept[S_AHEAD, i] * away * u_ahead[2, i] / (2.0 * radius)
        drift = 0.5 * spreading * rate * kept[T, i]
        drift_ahead = 0.5 * spreading * rate * kept[T_AHEAD, i]
        kept[W, i] += by_rise * (pull_ahead * w - pull * r) + drift_ahead * w - drift * r
        kept[ACROSS, i] += (by_rise * pull_ahead + drift_ahead) * across
        shared, own = _noise_of_velocity(D * mu, free * mu, left, gone, spreading)
        changing = gone - h / (free * mu) * left if mu > 0.0 else 1.0
        v[2, i] = (
            left * v[2, i] + gone * mu * u[2, i]
            + (1.0 - way / h) * (mu_ahead * u_ahead[2, i] - mu * u[2, i])
            + away * (shared * normal[2, i] + radius * rate * slope * changing)
            + own * normal[5, i]
        )  # fmt: skip
    for i in range(0, width, LANES):
        w, across = lanes(kept, W * width + i), lanes(kept, ACROSS * width + i)
        away = lanes(kept, AWAY * width + i)
        g = by_square(data, w * w + across * across, away)[0]
        store(x, 2 * width + i, lanes(kept, PLANE * width + i) + away * (radius + radius * g))


@named_njit(inner=True, error_model="numpy")
def _noise_of_velocity(diffusion, tau, left, gone, spreading):  # type: ignore[no-untyped-def]
    """Return the velocity noise in a step (m/s): the part proportional to the position's, the rest.

    `diffusion` is D (m^2/s) and `tau` the relaxation time (s). `left`, `gone` and `spreading` are
    E = e^(-h/tau), 1 - E and the time h' whose diffusion has the spread of the step h (s).
    """
    if not tau > 0.0:
        return 0.0, 0.0
    shared = gone * gone * math.sqrt(0.5 * diffusion / spreading)
    return shared, math.sqrt(max((1.0 - left * left) * diffusion / tau - shared * shared, 0.0))


# its weights are those far from the wall, of which the step reads none
HEUN = Scheme(step, exact_without_springs, force_calls=2, data=data_of)
