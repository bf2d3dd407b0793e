"""Lock-in amplifier: the oscillation of a bead about a reference frequency, as a slow amplitude.

The position is multiplied by the reference and passes a low-pass of the bandwidth B,

    x(t) = Re{z(t) e^(2 pi i f t)},    z' = 2 pi B (2 x e^(-2 pi i f t) - z),

for each axis. Re z is the in-phase part, and Im z the quadrature. Both change slowly, so a record
with two samples per 1/B is enough, however many periods lie between them. The filter multiplies the
spectrum of z by 1/(1 + (df/B)^2) at the distance df from the reference.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numba import types

from tweezer.compiled import cached_njit
from tweezer.dynamics.brownian.batch import BEADS, PLAN
from tweezer.values.arrays import Array

if TYPE_CHECKING:
    from tweezer.scene.sections import LockIn

#: Entries of the data: the angle of the reference per step, and the part of z left after a step
TURN, LEFT = range(2)
#: Steps per period of the reference, and steps per radian of the low-pass, at least
_FEWEST, _SLOWER = 8, 20
MIXES = types.void(PLAN, types.int64, BEADS)
"""signature of `mix`"""


def longest_step(lock_in: LockIn) -> float:
    """Return the longest step, s, at which the mixer and the low-pass see the motion as it is."""
    turning = 1 / (_FEWEST * lock_in.frequency)
    return min(turning, 1 / (_SLOWER * 2 * math.pi * lock_in.bandwidth))


def data_of(lock_in: LockIn, step: float) -> Array:
    """Return the data of the lock-in, (2,), as `mix` reads them, for steps of the length `step`, s.

    The angle is a fraction of a turn, so that many steps keep its digits.
    """
    left = math.exp(-2 * math.pi * lock_in.bandwidth * step)
    return np.array([lock_in.frequency * step, left])


@cached_njit(error_model="numpy", nogil=True)
def mix(plan, at, beads):  # type: ignore[no-untyped-def]
    """Advance the amplitudes z by a step with the number `at`, from the positions after it."""
    turns, left = plan.lock_in[TURN] * (at + 1), plan.lock_in[LEFT]
    angle = 2.0 * math.pi * (turns - math.floor(turns))
    along, across = 2.0 * (1.0 - left) * math.cos(angle), -2.0 * (1.0 - left) * math.sin(angle)
    z = beads.lock_in
    for k in range(3):
        for i in range(z.shape[1]):
            z[k, i] = left * z[k, i] + along * beads.x[k, i]
            z[3 + k, i] = left * z[3 + k, i] + across * beads.x[k, i]
