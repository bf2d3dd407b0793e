"""Noise of the laser: impulses at the ends of steps by its power and by the position of its focus.

If the power is P (1 + e) and the focus is at d, the force on a bead near its equilibrium is

    F_light(x - d) (1 + e) = F_light(x) + e F_light(x) + K d + ...,

with the trap stiffness K. The spectra of e and of the components of d are white up to a corner
frequency f_c. At the end of a step of length h the velocity gains h (e F_light + K d)/m. Each of
these numbers follows the recursion

    e -> c e + (1 - c) sqrt(S_e/(2 h)) n,    c = e^(-2 pi f_c h),

with a standard normal number n, so that its spectrum at low frequencies is the given one. A bead
that oscillates at the frequency nu changes its energy E at the rate

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
#: First entries of the data: c, and the factors of n for e and for a component of d. The matrix
#: K h/m follows, row by row
LEFT, POWER, POSITION, PULL = range(4)
SHAKES = types.void(PLAN, types.int64[::1], types.int64, BEADS)
"""signature of `shake`"""


def data_of(noise: LaserNoise, step: float, stiffness: Array, mass: float) -> Array:
    """Return the data of the laser's noise, (12,), as `shake` reads them.

    Parameters
    ----------
    noise : LaserNoise
        Spectra of the power and of the position.
    step : float
        Length of a step h, s.
    stiffness : ndarray, shape (3, 3)
        Trap stiffness K, N/m.
    mass : float
        Mass m, kg.
    """
    left = 0.0 if noise.corner is None else math.exp(-2 * math.pi * noise.corner * step)
    spread = (1 - left) * np.sqrt(np.array([noise.power, noise.position]) / (2 * step))
    return np.concatenate([[left], spread, (stiffness * (step / mass)).ravel()])


@cached_njit(error_model="numpy", nogil=True)
def shake(plan, trajectories, at, beads):  # type: ignore[no-untyped-def]
    """Advance the noise of the laser by a step, and change the velocities by its impulses.

    `beads.u` contains the slow velocities at `beads.x`. The indices `trajectories` (w,) and the
    number `at` of the step select the random numbers.
    """
    data, noise = plan.laser, beads.laser
    drawn = np.empty((NUMBERS, trajectories.size))
    normals(plan.seed, trajectories, at, LASER, drawn)
    for i in range(len(beads.pose.time)):
        for j in range(NUMBERS):
            spread = data[POWER] if j == 0 else data[POSITION]
            noise[j, i] = data[LEFT] * noise[j, i] + spread * drawn[j, i]
        for k in range(3):
            light = (beads.u[k, i] - plan.mobility[k] * plan.load[k]) / plan.tau[k]
            gain = plan.step * light * noise[0, i]
            for j in range(3):
                gain += data[PULL + 3 * k + j] * noise[1 + j, i]
            beads.v[k, i] += gain
