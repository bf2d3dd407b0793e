"""Steps beside a wall, without inertia: Heun and one-call steps in a plane whose radius is the gap.

Towards the wall a bead moves in that plane (`tweezer.dynamics.brownian.plane`). Each step starts
from (r, 0) and uses exponential Heun, or the method of Leimkuhler and Matthews. The bead cannot
pass through the wall, however long the step. Along the wall

    dx = mu_par (D/kT) F dt + sqrt(2 D mu_par) dB

causes no drift, as mu_par depends on the gap alone. The noise of a Heun step uses the mean of
mu_par at the beginning and the end. The one-call step uses mu_par where the force is evaluated.

Rotation is treated in the same way. Turning about an axis along the wall and shifting across that
axis share one matrix of mobilities, and their noise is correlated. The angles of a step are one
finite turn, which bounds the step (`tweezer.dynamics.brownian.rotation`).
"""

from __future__ import annotations

import math

import numpy as np

from tweezer.compiled import cached_njit, named_njit
from tweezer.compiled.lanes import LANES, lanes, root, store
from tweezer.compiled.stack import borrowed
from tweezer.dynamics.brownian.batch import (
    Scheme,
    exact,
    exact_without_springs,
    slow_velocities,
)
from tweezer.dynamics.brownian.plane import RADIUS, RATE, by_gap, by_square, data_of, nearest
from tweezer.forces.data import number

#: Torque at unit angular velocity over force at unit velocity, far away, in squared radii
_ARM = 4 / 3

#: Rows that a step keeps of each bead: the predicted position in the plane (W, ACROSS), then r and
#: its rate at the beginning. PULL and DRIFT give the rate at the predicted position. Then come the
#: direction from the nearer plane and its position, and the four mobilities (along the plane, of
#: turning, spinning and rolling) at the beginning and at the predicted position
W, ACROSS, R, CHANGE, PULL, DRIFT, AWAY, PLANE, BEGIN, AHEAD, ROWS = *range(9), 12, 16


@named_njit(inner=True, error_model="numpy", forceinline=True)
def _keep(kept, first, i, mobilities):  # type: ignore[no-untyped-def]
    """Store four mobilities of the eight beads i to i + 7 in the rows from `first` of `kept`."""
    width = kept.shape[1]
    for k in range(4):
        store(kept, (first + k) * width + i, mobilities[k])


@named_njit(inner=True, error_model="numpy", forceinline=True)
def _kept(kept, first, i):  # type: ignore[no-untyped-def]
    """Return the four mobilities of eight beads that `_keep` stored."""
    at, width = first * kept.shape[1] + i, kept.shape[1]
    return (
        lanes(kept, at), lanes(kept, at + width), lanes(kept, at + 2 * width),
        lanes(kept, at + 3 * width),
    )  # fmt: skip


@named_njit(inner=True, error_model="numpy", forceinline=True)
def _slow_down(u, radius, mobilities, i):  # type: ignore[no-untyped-def]
    """Convert slow velocities of eight beads far from the wall to those beside it, in place.

    `u` (dims, w) are velocities along (m/s) and angular velocities about (rad/s) each axis. The row
    across the wall is not changed. `mobilities`, along the wall, of turning, spinning and rolling,
    are relative to those far away (rolling in velocity/radius, with `radius` in m). `i` is the
    column of the first bead.
    """
    dims, width = u.shape
    along, turn, spin, roll = mobilities
    x, y = lanes(u, i), lanes(u, width + i)
    if dims == 3:
        store(u, i, along * x)
        store(u, width + i, along * y)
    else:
        about_x, about_y = lanes(u, 3 * width + i), lanes(u, 4 * width + i)
        of_turn, of_shift = (_ARM * radius) * roll, roll / radius
        store(u, i, along * x + of_turn * about_y)
        store(u, width + i, along * y - of_turn * about_x)
        store(u, 3 * width + i, turn * about_x - of_shift * y)
        store(u, 4 * width + i, turn * about_y + of_shift * x)
        store(u, 5 * width + i, spin * lanes(u, 5 * width + i))


@named_njit(inner=True, error_model="numpy", forceinline=True)
def _shake(weights, beads, mobilities, i):  # type: ignore[no-untyped-def]
    """Fill `beads.kick` with the noise of eight beads along the wall (m) and of their angles (rad).

    `mobilities`, relative to those far away, are along the wall, of turning, spinning and rolling.
    Shifting along the wall and turning have correlated noise. `i` is the column of the first bead.
    """
    normal, kick = beads.normal, beads.kick
    dims, width = kick.shape
    along, turn, spin, roll = mobilities
    scale = root(along)
    for k in range(2):
        at = k * width + i
        store(kick, at, (weights.noise_x[k] * scale) * lanes(normal, at))
    if dims > 3:
        wide = weights.noise_x[3]
        shared = math.sqrt(_ARM) * roll / scale
        own = root(turn - shared * shared)
        x, y = lanes(normal, i), lanes(normal, width + i)
        about_x, about_y = lanes(normal, 3 * width + i), lanes(normal, 4 * width + i)
        store(kick, 3 * width + i, wide * (own * about_x - shared * y))
        store(kick, 4 * width + i, wide * (own * about_y + shared * x))
        store(kick, 5 * width + i, wide * (root(spin) * lanes(normal, 5 * width + i)))


@cached_njit(error_model="numpy", nogil=True)
def heun_step(force, plan, weights, beads):  # type: ignore[no-untyped-def]
    """Advance all beads by one step of Heun beside a wall, with two force evaluations.

    plan: its drag has the data of `plane.data_of`. weights: exact without the wall. The gap moves
    as the length of W = (w, across) in a plane, see the module `plane`; the other coordinates as
    usual.
    """
    force, plan, weights, beads = borrowed((force, plan, weights, beads))
    data, radius = plan.drag.data, number(plan.drag.data, RADIUS)
    dims, width = beads.x.shape
    x, u, ahead, u_ahead, normal = beads.x, beads.u, beads.ahead, beads.u_ahead, beads.normal
    kappa, by_u, by_rise, wide = (
        weights.kappa[2], weights.by_u[2], weights.by_rise[2], weights.noise_x[2],
    )  # fmt: skip
    kept = np.empty((ROWS, width))
    slow_velocities(force, plan, beads, beads.now[0], x, u)
    for i in range(0, width, LANES):
        g, away, plane = nearest(data, lanes(x, 2 * width + i))
        r, S, T, mobilities = by_gap(data, g, away)
        change = (
            S * (away * lanes(u, 2 * width + i)) / (2.0 * radius) + number(data, RATE) * T
        ) * r
        w = r + by_u * change + wide * lanes(normal, 2 * width + i)
        across = wide * lanes(normal, dims * width + i)
        _slow_down(u, radius, mobilities, i)
        _shake(weights, beads, mobilities, i)
        for k in range(2):
            at = k * width + i
            led = weights.by_u[k] * lanes(u, at) + lanes(beads.kick, at)
            store(ahead, at, lanes(x, at) + led)
        _keep(kept, BEGIN, i, mobilities)
        g, S, T, mobilities = by_square(data, w * w + across * across, away)
        store(ahead, 2 * width + i, plane + away * (radius + radius * g))
        _keep(kept, AHEAD, i, mobilities)
        store(kept, W * width + i, w)
        store(kept, ACROSS * width + i, across)
        store(kept, R * width + i, r)
        store(kept, CHANGE * width + i, change)
        store(kept, PULL * width + i, S * away / (2.0 * radius))
        store(kept, DRIFT * width + i, number(data, RATE) * T)
        store(kept, AWAY * width + i, away)
        store(kept, PLANE * width + i, plane)
    slow_velocities(force, plan, beads, beads.now[0] + plan.step, ahead, u_ahead)
    for i in range(0, width, LANES):
        w, across = lanes(kept, W * width + i), lanes(kept, ACROSS * width + i)
        of_w = lanes(kept, PULL * width + i) * lanes(u_ahead, 2 * width + i)
        of_w = of_w + lanes(kept, DRIFT * width + i) + kappa
        begun = lanes(kept, CHANGE * width + i) + kappa * lanes(kept, R * width + i)
        w = w + by_rise * (of_w * w - begun)
        across = across + by_rise * (of_w * across)
        away = lanes(kept, AWAY * width + i)
        g, _, _, mobilities = by_square(data, w * w + across * across, away)
        store(x, 2 * width + i, lanes(kept, PLANE * width + i) + away * (radius + radius * g))
        _slow_down(u_ahead, radius, _kept(kept, AHEAD, i), i)
        begun = _kept(kept, BEGIN, i)
        _shake(weights, beads, (
            0.5 * (begun[0] + mobilities[0]), 0.5 * (begun[1] + mobilities[1]),
            0.5 * (begun[2] + mobilities[2]), 0.5 * (begun[3] + mobilities[3]),
        ), i)  # fmt: skip
        for k in range(dims):
            if k != 2:
                at = k * width + i
                rise = lanes(u_ahead, at) - lanes(u, at)
                if k < 2:
                    rise = rise + weights.kappa[k] * (lanes(ahead, at) - lanes(x, at))
                way = weights.by_u[k] * lanes(u, at) + weights.by_rise[k] * rise
                store(x, at, lanes(x, at) + (way + lanes(beads.kick, at)))


@cached_njit(error_model="numpy", nogil=True)
def one_call_step(force, plan, weights, beads):  # type: ignore[no-untyped-def]
    """Advance all beads by a step of Leimkuhler and Matthews beside a wall, with one force call.

    The force is evaluated after half of the noise, at `beads.ahead`, which is also the sample. W =
    (w, across) is the vector whose length gives the gap, see the module `plane`.
    """
    force, plan, weights, beads = borrowed((force, plan, weights, beads))
    data, radius = plan.drag.data, number(plan.drag.data, RADIUS)
    dims, width = beads.x.shape
    x, u, ahead, normal = beads.x, beads.u, beads.ahead, beads.normal
    by_u, wide = weights.by_u[2], weights.noise_x[2]
    kept = np.empty((ROWS, width))
    for i in range(0, width, LANES):
        g, away, plane = nearest(data, lanes(x, 2 * width + i))
        r = by_gap(data, g, away)[0]
        w = r + (0.5 * wide) * lanes(normal, 2 * width + i)
        across = (0.5 * wide) * lanes(normal, dims * width + i)
        g, S, T, mobilities = by_square(data, w * w + across * across, away)
        _shake(weights, beads, mobilities, i)
        for k in range(2):
            at = k * width + i
            store(ahead, at, lanes(x, at) + 0.5 * lanes(beads.kick, at))
        store(ahead, 2 * width + i, plane + away * (radius + radius * g))
        _keep(kept, AHEAD, i, mobilities)
        store(kept, W * width + i, w)
        store(kept, ACROSS * width + i, across)
        store(kept, R * width + i, r)
        store(kept, PULL * width + i, S * away / (2.0 * radius))
        store(kept, DRIFT * width + i, number(data, RATE) * T)
        store(kept, AWAY * width + i, away)
        store(kept, PLANE * width + i, plane)
    slow_velocities(force, plan, beads, beads.now[0] + 0.5 * plan.step, ahead, u)
    for i in range(0, width, LANES):
        w, across = lanes(kept, W * width + i), lanes(kept, ACROSS * width + i)
        of_w = lanes(kept, PULL * width + i) * lanes(u, 2 * width + i)
        of_w = of_w + lanes(kept, DRIFT * width + i)
        end = 2.0 * w - lanes(kept, R * width + i) + by_u * (of_w * w)
        across = 2.0 * across + by_u * (of_w * across)
        away = lanes(kept, AWAY * width + i)
        g = by_square(data, end * end + across * across, away)[0]
        store(x, 2 * width + i, lanes(kept, PLANE * width + i) + away * (radius + radius * g))
        _slow_down(u, radius, _kept(kept, AHEAD, i), i)
        for k in range(dims):
            if k != 2:
                at = k * width + i
                way = weights.by_u[k] * lanes(u, at) + lanes(beads.kick, at)
                store(x, at, lanes(x, at) + way)


HEUN = Scheme(heun_step, exact, force_calls=2, data=data_of)
ONE_CALL = Scheme(
    one_call_step, exact_without_springs, force_calls=1, samples_ahead=True, data=data_of
)
