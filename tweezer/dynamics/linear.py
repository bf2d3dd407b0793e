"""The linear motion of a bead about an equilibrium, with its inertia and that of the fluid.

In a force -K x a bead of the mobility b, whose velocity has the modes (a_j, tau_j) of
`tweezer.fluid.memory`, moves by

    x' = sum_j a_j v_j,    tau_j v_j' = -b K x - v_j,

With one mode, tau = m/beta, this is m x'' = -beta x' - K x. If K is not symmetric, as in circularly
polarised light, the drag determines whether a displaced bead comes to rest. For the eigenvalues a
+- i b of K with a > 0, the motion with one mode has a growing root if and only if beta < |b|
sqrt(m/a). On the edge of growth, the root s = i w of m s^2 + beta s + a + i b = 0 has m w^2 = a and
beta w = -b. For a larger beta, both roots decay by the criterion of Routh and Hurwitz.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tweezer.fluid import Modes, modes, single
from tweezer.values.arrays import Array, Complex

#: Part of an eigenvalue, and of the slowest time of a motion, that is rounding
_ROUNDING = 1e-9
_OF_SLOWEST = 1e-13
#: Factor by which drag is larger than it has to be where no root is computed: the root of the
#: fluid's memory is a sum of poles, which is off by little
_SURELY = 2.0
#: Quality factor above which a displaced bead oscillates
CRITICAL = 0.5


class Resonances(NamedTuple):
    """Frequencies of a bead in a harmonic trap along each axis, (3,) each.

    An axis has either a corner frequency or a resonance frequency with a quality factor; the others
    are NaN.
    """

    corner_frequencies: Array
    """k_ii/(2 pi beta_v), Hz, if the bead is overdamped"""
    resonance_frequencies: Array
    """|s|/(2 pi), Hz, of the root s of the motion, if the bead oscillates: sqrt(k_ii/m)/(2 pi)
    without fluid inertia
    """
    quality_factors: Array
    """|s|/(2 |Re s|), above 1/2: sqrt(k_ii m)/beta_v without fluid inertia"""


@dataclass(frozen=True)
class LinearMotion:
    """The inertia of a bead in its motion about an equilibrium."""

    mass: float
    """mass of the bead with the added mass in a fluid without memory, kg; 0 in a model without
    inertia
    """
    displaced_mass: float = 0.0
    """mass of the displaced fluid, kg, with hydrodynamic memory; otherwise 0"""
    poles: int = 0
    """number of poles of the fluid's memory; 0 without it"""
    scale: float = 1.0
    """a2 of the scaled model, by which it divides the inertia of the bead"""
    expansion_time: float = 0.0
    """m/beta_v of the model of first order (4.11), s; 0 of others"""

    def spiral_rate(self, stiffness: Array, mobility: Array) -> float:
        """Return the growth rate of the linear motion of a displaced bead, 1/s.

        The eigenvalues of `stiffness` K, (3, 3) N/m, have positive real parts. `mobility` (3,)
        contains the mobilities of translation along the axes, s/kg. Returns 0 if every displacement
        decays.
        """
        rates = mobility[:, None] * stiffness
        kappa: Complex = np.linalg.eigvals(rates).astype(complex)
        turns = turning(kappa)
        if self.expansion_time:
            growing = -(kappa + self.expansion_time * kappa**2)[turns].real
            return float(max(growing.max(initial=0.0), 0.0))
        even = bool(np.ptp(mobility) == 0)
        if self.mass == 0 or (even and not turns.any()):
            return 0.0  # a passive drag takes energy from every motion in a potential
        if even and self._enough_drag(kappa[turns] / mobility[0], 1 / mobility[0]):
            return 0.0
        if even:
            inverse = _inverse(kappa[turns, None, None], self._modes(mobility[0], self.scale))
        else:
            of_axes = Modes((self.mass / self.scale * mobility)[:, None], np.ones((3, 1)))
            inverse = _inverse(rates[None], of_axes)
        times = np.linalg.eigvals(inverse)
        slowest = np.abs(times).max(axis=1, keepdims=True)
        grows = times.real > _OF_SLOWEST * slowest
        return float((1 / times[grows]).real.max(initial=0.0))

    def least_drag(self, stiffness: Array) -> float:
        """Return the drag, equal along all axes, above which every displacement decays, kg/s.

        It is the largest |b| sqrt(m/a) of the eigenvalues a +- i b of `stiffness` K, (3, 3) N/m,
        whose real parts are positive; 0 if all eigenvalues are real, and in a model without
        inertia. The memory of the fluid is left out; for |b| < a it lowers this drag.
        """
        kappa: Complex = np.linalg.eigvals(stiffness).astype(complex)
        mass = (self.mass + 0.5 * self.displaced_mass) / self.scale
        turns = kappa[turning(kappa)]
        needed = np.abs(turns.imag) * np.sqrt(mass / turns.real)
        return float(needed.max(initial=0.0))

    def _enough_drag(self, eigenvalues: Complex, drag: float) -> bool:
        """Return whether no root can grow, without computing the roots.

        eigenvalues: a + i b of K, N/m. A root on the edge of growth is i w with
        |b| = w (beta + r) and a = (m + m_f/2) w^2 + r w, where r > 0 is the real part of Basset's
        force over the velocity. It follows that
        |b| > beta w, and that w^2 > a/(2 m + m_f) for |b| < a/2.
        """
        a, b = eigenvalues.real, np.abs(eigenvalues.imag)
        mass = (self.mass + 0.5 * self.displaced_mass) / self.scale
        return bool(((b < a / 2) & (drag > _SURELY * b * np.sqrt(2 * mass / a))).all())

    def resonances(self, stiffness: Array, mobility: Array) -> Resonances:
        """Return the resonances of the bead for positive `stiffness` (3,), N/m.

        `mobility` (3,) is in s/kg. The scaling of the model has no effect, because it is not a
        property of the bead.
        """
        kappa = mobility * stiffness
        corner, resonance, quality = kappa / (2 * math.pi), np.full(3, np.nan), np.full(3, np.nan)
        for i in range(3) if self.mass else ():
            if self.quality(float(stiffness[i]), float(mobility[i])) <= CRITICAL:
                continue  # the fluid's memory only adds to the drag
            of_axis = self._modes(mobility[i], 1.0)
            roots = 1 / np.linalg.eigvals(_inverse(kappa[i, None, None, None], of_axis)[0])
            root = roots[np.abs(roots.imag).argmax()]
            swing = abs(root) / (2 * abs(root.real)) if root.real else math.inf
            if root.imag != 0 and swing > CRITICAL:
                corner[i], resonance[i], quality[i] = np.nan, abs(root) / (2 * math.pi), swing
        return Resonances(corner, resonance, quality)

    def quality(self, stiffness: float, mobility: float) -> float:
        """Return sqrt(k m)/beta_v with the mass that a sudden force accelerates; 0 without inertia.

        stiffness: k, N/m. mobility: 1/beta_v, s/kg.
        """
        mass = self.mass + 0.5 * self.displaced_mass
        return math.sqrt(stiffness * mass) * mobility

    def _modes(self, mobility: float, scale: float) -> Modes:
        """Return the modes of the velocity after a force, for a mobility, s/kg.

        scale: factor a2 by which the bead's mass is divided.
        """
        mass, drag = self.mass / scale, 1 / mobility
        if self.poles:
            return modes(mass, drag, self.displaced_mass, self.poles)
        return single(mass / drag)


def turning(eigenvalues: Complex) -> NDArray[np.bool_]:
    """Return which eigenvalues are complex beyond rounding."""
    turns: NDArray[np.bool_] = np.abs(eigenvalues.imag) > _ROUNDING * np.abs(eigenvalues)
    return turns


def _inverse(rates: Array | Complex, velocity: Modes) -> Array | Complex:
    """Return the inverse of the matrix of the linear motion, whose eigenvalues are 1/s for roots s.

    rates: (sets, axes, axes) mobility times stiffness, 1/s, of axes that are coupled. velocity:
    modes of the velocity, (modes,) or (axes, modes). In the inverse the slow motion keeps its
    digits, although some modes are faster by many decades.
    """
    sets, axes, _ = rates.shape
    times = np.broadcast_to(velocity.times, (axes, velocity.times.shape[-1]))
    lags = velocity.weights * times
    n = times.shape[1]
    made = np.zeros((sets, axes * (1 + n), axes * (1 + n)), rates.dtype)
    within = np.linalg.inv(rates)
    made[:, :axes, :axes] = -within
    for i in range(axes):
        of_axis = slice(axes + i * n, axes + (i + 1) * n)
        made[:, :axes, of_axis] = -within[:, :, i, None] * lags[i]
        made[:, of_axis, i] = 1.0
        made[:, of_axis, of_axis] = lags[i] - np.diag(times[i])
    return made
