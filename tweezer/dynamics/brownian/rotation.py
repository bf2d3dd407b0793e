"""A sphere's orientation under drag and thermal torque (2.17): |e| = 1 by construction.

With inertia, the angular velocity of a sphere in the inertial frame follows the same equation as
its velocity. A step therefore turns it by an angle known exactly. The noise is 2 beta_w kT (L_C is
2 r/sqrt(3) times the random force). A finite turn by that angle is not the product of its parts:
the axis diffuses faster than it should by about D_r h/6, which bounds the step.

Without inertia the diffusion itself is exact, up to D_r h = 1/4. An angle w is drawn from
N(0, 2 D_r h) and accepted with probability sin(|w|/2)/(|w|/2). The turn by a constant torque
commutes with it.
"""

from __future__ import annotations

import math

import numpy as np
from numba import types

from tweezer.compiled import cached_njit, named_njit
from tweezer.dynamics.brownian.batch import BEADS, PLAN
from tweezer.dynamics.brownian.noise import TURN, normals
from tweezer.dynamics.integrators.turning import turn

#: Longest step of the exact diffusion, in 1/D_r
LONGEST = 0.25
#: Longest step of a turn with inertia, in 1/D_r
LONGEST_WITH_INERTIA = 0.002
#: Signature of `turn_by_steps` and `turn_and_diffuse`
TURNS = types.void(PLAN, types.int64[::1], types.int64, BEADS)


@cached_njit(error_model="numpy", nogil=True)
def turn_by_steps(plan, trajectories, at, beads):  # type: ignore[no-untyped-def]  # noqa: ARG001
    """Rotate every bead by the angles of its step, `beads.x[3:6]`, and set the angles to 0.

    `trajectories` and `at` are not used; they give it the signature of `turn_and_diffuse`.
    """
    _turn(beads)


@cached_njit(error_model="numpy", nogil=True)
def turn_and_diffuse(plan, trajectories, at, beads):  # type: ignore[no-untyped-def]
    """Rotate every bead by the angles of its step, then by exact free rotational diffusion.

    The indices `trajectories` (w,) of the beads and `at` of the step select the random numbers.
    """
    _turn(beads)
    _diffuse(plan, trajectories, at, beads)


@named_njit(inner=True, error_model="numpy")
def _turn(beads):  # type: ignore[no-untyped-def]
    """Rotate every bead by the angles of its step, `beads.x[3:6]`, rad, and set the angles to 0."""
    for i in range(beads.e.shape[0]):
        turn(beads.x[3, i], beads.x[4, i], beads.x[5, i], beads.e[i], beads.e[i])
        for k in range(3, 6):
            beads.x[k, i] = 0.0


@named_njit(inner=True, error_model="numpy")
def _diffuse(plan, trajectories, at, beads):  # type: ignore[no-untyped-def]
    """Rotate every bead by a random angle of free rotational diffusion over a step, by rejection.

    A rotation vector w (rad, standard deviation `spread`) is accepted with the probability
    sin(|w|/2)/(|w|/2); beads without an accepted one draw again. The numbers `trajectories` (w,) of
    the beads and `at` of the step select the random numbers.
    """
    spread = math.sqrt(2.0 * plan.diffusion[3] * plan.step)
    drawn = np.empty((4, trajectories.size))
    left = np.ones(beads.e.shape[0], np.bool_)
    attempt = 0
    while left.any():
        normals(plan.seed, trajectories, at, TURN + attempt, drawn)
        for i in range(left.size):
            if not left[i]:
                continue
            w1, w2, w3 = spread * drawn[0, i], spread * drawn[1, i], spread * drawn[2, i]
            half = 0.5 * math.sqrt(w1 * w1 + w2 * w2 + w3 * w3)
            # a uniform number: the distribution function of a normal one
            chance = 0.5 * math.erfc(drawn[3, i] / math.sqrt(2.0))
            if half < 1e-8 or chance * half < math.sin(half):
                left[i] = False
                turn(w1, w2, w3, beads.e[i], beads.e[i])
        attempt += 1
