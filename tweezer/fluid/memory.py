"""Fluid inertia: the velocity of a sphere as a sum of modes that relax independently.

The drag of a sphere in a fluid with inertia (J. Boussinesq 1885, A. B. Basset 1888; L. D. Landau,
E. M. Lifshitz, Fluid Mechanics, section 24) is, for a motion v = e^(st),

    gamma(s) = beta (1 + sqrt(s tau_f) + s tau_f/9),    tau_f = r^2 rho_m/mu_m,

where the last term is the added mass, m_f/2. The square root describes the memory of the vorticity
that the bead shed earlier. It is approximated by a sum of c_k s tau_f/(s tau_f + p_k) with c_k, p_k
> 0 (`derivation/memory_poles.json`), as if the bead dragged fictitious masses through dashpots. The
response to a force then has one simple pole more than there are masses:

    1/(m s + gamma(s)) = (1/beta) sum_j a_j/(1 + s tau_j),    a_j > 0,    sum_j a_j = 1.

The velocity of the bead is therefore v = sum_j a_j v_j. Each v_j relaxes to the slow velocity
F/beta in the time tau_j, with independent thermal noise.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tweezer.generated import hydrodynamics, memory_poles
from tweezer.values.arrays import Array, Complex
from tweezer.values.errors import SceneError

#: The emitted drag as plain Python: a few frequencies do not repay the time of compilation
_drag_of_translation = np.vectorize(hydrodynamics.drag_of_translation.py_func, otypes="dd")

#: Poles of the root by their number: p_k and c_k
NODES = {n: (np.array(p), np.array(c)) for n, (p, c) in memory_poles.NODES.items()}
#: Halvings of an interval that leave nothing but rounding
_HALVINGS = 110
#: Error of the lag over that of a mean squared displacement (`memory_poles.ERRORS`), measured
_ERROR_PER_LAG = 3.0
#: Part of a tolerance that the poles may take
_PART = 0.3


class Modes(NamedTuple):
    """Modes of the velocity of a bead: v = sum a_j v_j, each v_j relaxing to force over drag in its
    tau_j.
    """

    times: Array
    """relaxation times tau_j, s, (modes,) or (axes, modes)"""
    weights: Array
    """weights a_j, of the shape of `times`; those of an axis add up to 1"""

    @property
    def struck(self) -> Array:
        """Velocities of the modes, (modes,), of a bead suddenly accelerated to 1 m/s.

        The fluid is at rest before.
        """
        stroke: Array = 1 / (self.times * (self.weights / self.times).sum())
        return stroke


def drag_at(frequencies: Array, drag: float, displaced_mass: float) -> Complex:
    """Return the drag gamma(2 pi i f), kg/s, with the added mass, at frequencies f (n,), Hz.

    `drag` is the steady drag beta, kg/s, and `displaced_mass` the mass of the displaced fluid, kg.
    """
    real, imaginary = _drag_of_translation(
        2 * np.pi * frequencies, drag, 4.5 * displaced_mass / drag
    )
    return np.asarray(real + 1j * imaginary)


def single(time: float) -> Modes:
    """Return the only mode of a bead without hydrodynamic memory, with relaxation `time`, s."""
    return Modes(np.array([time]), np.ones(1))


def modes(mass: float, drag: float, displaced_mass: float, poles: int) -> Modes:
    """Return the modes of a sphere, one more than `poles`, from the slowest to the fastest.

    Parameters
    ----------
    mass : float
        Mass of the bead alone, kg.
    drag : float
        Steady drag beta, kg/s.
    displaced_mass : float
        Mass m_f of the displaced fluid, kg. If it is 0, there is one mode with the relaxation time
        m/beta.
    poles : int
        Number of poles of the memory.

    Raises
    ------
    SceneError
        For a number of poles without a table.
    """
    if poles not in NODES:
        raise SceneError(f"medium.poles = {poles}: allowed: {', '.join(map(str, NODES))}")
    if displaced_mass == 0:
        return single(mass / drag)
    p, c = NODES[poles]
    vorticity_time = 4.5 * displaced_mass / drag
    mu = (mass + 0.5 * displaced_mass) / (drag * vorticity_time)

    # (m s + gamma(s))/beta at s = -rate/tau_f falls from pole to pole, from plus to minus infinity
    low, high = np.append(0.0, p), np.append(p, p[-1] + (1 + c.sum()) / mu)
    for _ in range(_HALVINGS):
        rates = 0.5 * (low + high)
        positive = 1 - mu * rates - rates * (c / (p - rates[:, None])).sum(axis=1) > 0
        low, high = np.where(positive, rates, low), np.where(positive, high, rates)
    slopes = mu + (c * p / (p - rates[:, None]) ** 2).sum(axis=1)
    return Modes(vorticity_time / rates, 1 / (slopes * rates))


def enough_poles(way: float, tolerance: float) -> int:
    """Return the smallest number of poles whose error is below a fraction of the tolerance.

    `way` is the lag of the bead due to fluid inertia, m, and `tolerance` that of the position, m.
    """
    for n, (_, error, *_) in memory_poles.ERRORS.items():
        if _ERROR_PER_LAG * error * way <= _PART * tolerance:
            return n
    return max(NODES)


def other_poles(poles: int) -> int:
    """Return a number of poles for comparison: the largest, or for the largest the next smaller
    one.

    The next larger number would not suffice: in a viscous liquid the motion changes less from 8
    poles to 12 than from 12 to 40.
    """
    numbers = sorted(NODES)
    return numbers[-1] if poles < numbers[-1] else numbers[-2]
