"""A sphere's orientation under drag and thermal torque (2.17): |e| = 1 by construction.

With inertia, the angular velocity of a sphere in the inertial frame follows the same equation as
its velocity, so a step turns it by an angle known exactly, with noise of 2 beta_w kT
(L_C = 2 r/sqrt(3) times that of the force). A finite turn by that angle is not the product of its
parts: the axis diffuses faster than it should by about D_r h/6, which bounds the step.

Without inertia the diffusion itself is exact: an angle w is drawn from N(0, 2 D_r h) and accepted
with probability sin(|w|/2)/(|w|/2), up to D_r h = 1/4; the turn of a constant torque commutes with
it.
"""

from __future__ import annotations

import hashlib
import math
from pathlib import Path

import numpy as np
from numba import njit

from tweezer.dynamics.brownian.noise import TURN, fill_normals

DIGEST = hashlib.sha256(Path(__file__).read_bytes()).hexdigest()

#: longest step of the exact diffusion, and of a turn with inertia, over 1/D_r
LONGEST, LONGEST_WITH_INERTIA = 0.25, 0.002


@njit(error_model="numpy")
def turn(e, i, w1, w2, w3):  # type: ignore[no-untyped-def]
    """Turn the orientation e[i] by an angle about inertial axes: e <- exp(w/2) e."""
    size = math.sqrt(w1 * w1 + w2 * w2 + w3 * w3)
    c = math.cos(0.5 * size)
    over = 0.5 - size * size / 48.0 if size < 1e-4 else math.sin(0.5 * size) / size
    r1, r2, r3 = over * w1, over * w2, over * w3
    e0, e1, e2, e3 = e[i, 0], e[i, 1], e[i, 2], e[i, 3]
    f0 = c * e0 - r1 * e1 - r2 * e2 - r3 * e3
    f1 = c * e1 + r1 * e0 + r2 * e3 - r3 * e2
    f2 = c * e2 + r2 * e0 + r3 * e1 - r1 * e3
    f3 = c * e3 + r3 * e0 + r1 * e2 - r2 * e1
    # rounding, step after step, would add up: one step of Newton to 1/|e|
    scale = 1.5 - 0.5 * (f0 * f0 + f1 * f1 + f2 * f2 + f3 * f3)
    e[i, 0], e[i, 1], e[i, 2], e[i, 3] = scale * f0, scale * f1, scale * f2, scale * f3


@njit(error_model="numpy")
def turn_by_steps(beads):  # type: ignore[no-untyped-def]
    """Turn every bead by the angles of its step, and put these back to 0."""
    for i in range(beads.x.shape[1]):
        turn(beads.e, i, beads.x[3, i], beads.x[4, i], beads.x[5, i])
        for k in range(3, 6):
            beads.x[k, i] = 0.0


@njit(error_model="numpy")
def diffuse(plan, trajectories, at, beads):  # type: ignore[no-untyped-def]
    """Turn every bead by a step, the one of that number, of free rotational diffusion."""
    spread = math.sqrt(2.0 * plan.diffusion[3] * plan.step)
    drawn = np.empty((4, 1))
    for i in range(beads.x.shape[1]):
        attempt = 0
        while True:
            fill_normals(plan.seed, trajectories[i : i + 1], at, TURN + attempt, drawn)
            w1, w2, w3 = spread * drawn[0, 0], spread * drawn[1, 0], spread * drawn[2, 0]
            half = 0.5 * math.sqrt(w1 * w1 + w2 * w2 + w3 * w3)
            # the distribution function of a number is uniform
            chance = 0.5 * math.erfc(drawn[3, 0] / math.sqrt(2.0))
            if half < 1e-8 or chance * half < math.sin(half):
                break
            attempt += 1
        turn(beads.e, i, w1, w2, w3)
