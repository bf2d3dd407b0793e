"""Noise of the laser: impulses at the ends of steps by its power and by the place of its focus.

If the power is P (1 + e) and the focus is at d, the force on a bead near its equilibrium is

    F_light(x - d) (1 + e) = F_light(x) + e F_light(x) + K d + ...,

with the trap stiffness K. The spectra of e and of the components of d are white up to a corner
frequency. At the end of a step of length h the velocity gains h (e F_light + K d)/m, where e and d
follow first-order recursions whose spectra are the given ones at low frequencies. A bead that
oscillates at the frequency nu gains the energy E at the rate

    dE/dt = pi^2 nu^2 S_e(2 nu) E + 4 pi^4 m nu^4 S_x(nu)

along each axis, with one-sided spectra (T. A. Savard, K. M. O'Hara, J. E. Thomas, Phys. Rev. A 56,
R1095 (1997)).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numba import types

from tweezer.compiled import cached_njit
from tweezer.dynamics.brownian.batch import BEADS, PLAN
from tweezer.dynamics.brownian.noise import LASER, normals
from tweezer.values.arrays import Array

if TYPE_CHECKING:
    from tweezer.scene.sections.light import LaserNoise

#: Numbers that the laser has for each bead: e, and the three components of d in m
NUMBERS = 4
#: First entries of the data: the part of a number left after a step, and the standard deviations of
#: e and of a component of d. The matrix K h/m follows, row by row
LEFT, POWER, PLACE, PULL = range(4)
SHAKES = types.void(PLAN, types.int64[::1], types.int64, BEADS)
"""signature of `shake`"""


def data_of(noise: LaserNoise, step: float, stiffness: Array, mass: float) -> Array:
    """Return the data of the laser's noise, (12,), as `shake` reads them.

    Parameters
    ----------
    noise : LaserNoise
        Spectra of the power and of the place.
    step : float
        Length of a step h, s.
    stiffness : ndarray, shape (3, 3)
        Trap stiffness K, N/m.
    mass : float
        Mass m, kg.
    """
    left = 0.0 if noise.corner is None else math.exp(-2 * math.pi * noise.corner * step)
    # the one-sided spectrum at frequency 0 is 2 h times the variance times (1 + left)/(1 - left)
    variances = np.array([noise.power, noise.position]) / (2 * step) * (1 - left) / (1 + left)
    pull = stiffness * (step / mass)
    return np.concatenate([[left], np.sqrt(variances), pull.ravel()])


@cached_njit(error_model="numpy", nogil=True)
def shake(plan, trajectories, at, beads):  # type: ignore[no-untyped-def]
    """Advance the noise of the laser by a step, and change the velocities by its impulses.

    `beads.u` contains the slow velocities at `beads.x`. The indices `trajectories` (w,) and the
    number `at` of the step select the random numbers.
    """
    data, noise = plan.laser, beads.laser
    left, n = data[LEFT], len(beads.pose.time)
    own = math.sqrt(1.0 - left * left)
    drawn = np.empty((NUMBERS, trajectories.size))
    normals(plan.seed, trajectories, at, LASER, drawn)
    for i in range(n):
        for j in range(NUMBERS):
            size = data[POWER] if j == 0 else data[PLACE]
            noise[j, i] = left * noise[j, i] + own * size * drawn[j, i]
        for k in range(3):
            light = (beads.u[k, i] - plan.mobility[k] * plan.load[k]) / plan.tau[k]
            gain = plan.step * light * noise[0, i]
            for j in range(3):
                gain += data[PULL + 3 * k + j] * noise[1 + j, i]
            beads.v[k, i] += gain
