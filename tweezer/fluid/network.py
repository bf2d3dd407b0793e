r"""Passive viscoelastic drag of a bead: a network of dashpots, springs and masses.

The force -gamma(s) v on a bead that moves with v = e^(st) is, in every passive linear medium, that
of elements with positive coefficients only,

    gamma(s) = beta_s + sum_j b_j/(1 + s t_j) + sum_i c_i s/(s + p_i) + g/s.

They are the solvent (beta_s), Maxwell elements (springs b_j/t_j behind dashpots b_j), masses
c_i/p_i dragged through dashpots c_i, and the spring g of a gel. In coordinates of variance 1 the
motion of the bead of mass M in a trap of stiffness k and of all elements is

    y' = A y + noise of the covariance -(A + A^T) per second,

so fluctuation and dissipation balance whatever the network. The position has the impedance
Z(s) = M s + gamma(s) + k/s. Its zeros s = -l are the eigenvalues of A, and the response of the
velocity to a force is

    1/Z(s) = w_0 + sum_l w_l/(s + l),    w_l = 1/Z'(-l).
"""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from tweezer.fluid.memory import Modes
from tweezer.values.arrays import Array, Complex
from tweezer.values.errors import SceneError

#: No elements
NONE = (np.zeros(0), np.zeros(0))
#: Halvings of an interval that leave nothing but rounding
_HALVINGS = 150
#: Steps of Newton's method for the decay rates
_NEWTON = 4
#: Newton's step over the distance from the nearest element's rate, above which it is not taken
_LONGEST = 0.1
#: Imaginary part of a rate, and asymmetry of a matrix, that is rounding
_ROUNDING = 1e-9
#: Deviation of the sum of amplitudes from 1 that reveals wrong rates
_LOST = 1e-6
#: Argument of x - 1 + e^-x below which its series is summed, and the terms of the series
_SHORT, _TERMS = 0.5, 14


class Decays(NamedTuple):
    """Sum of exponentials in time, sum a_n e^(-l_n t). A bead that rings has complex pairs."""

    amplitudes: Complex
    """(n,) a_n"""
    rates: Complex
    """(n,) l_n, 1/s, the slowest first"""

    def at(self, times: Array) -> Array:
        """Return the sum at `times` (n,), s."""
        decay = np.exp(-np.multiply.outer(np.asarray(times, float), self.rates))
        total: Array = (decay @ self.amplitudes).real
        return total


@dataclass(frozen=True, eq=False)
class Network:
    """Bead with the elements of a passive medium.

    All coefficients are positive or zero. Without a mass the solvent's drag must not be zero.
    """

    mass: float
    """effective mass M that a sudden force accelerates, with the added mass, kg; 0 without
    inertia"""
    drag: float
    """drag beta_s of the solvent, kg/s"""
    maxwell: tuple[Array, Array] = NONE
    """drags b_j, kg/s, and relaxation times t_j, s, of Maxwell elements"""
    dragged: tuple[Array, Array] = NONE
    """drags c_i, kg/s, and rates p_i, 1/s, of dragged masses c_i/p_i"""
    spring: float = 0.0
    """stiffness g of the medium's permanent elasticity, N/m"""

    @property
    def steady_drag(self) -> float:
        """Drag beta at no frequency, kg/s, without the spring."""
        return self.drag + float(self.maxwell[0].sum())

    @property
    def fast_drag(self) -> float:
        """Drag at frequencies above those of all elements, kg/s."""
        return self.drag + float(self.dragged[0].sum())

    @property
    def rings(self) -> bool:
        """Whether the velocity of the free bead oscillates."""
        return bool(np.iscomplexobj(self._zeros(0.0)[0]))

    def drag_at(self, frequencies: Array) -> Complex:
        """Return gamma(2 pi i f), kg/s, at `frequencies` f > 0 (n,), Hz, without the mass."""
        s = 2j * np.pi * np.asarray(frequencies, float)
        gamma: Complex = self._impedance(s, self.spring)[0] - self.mass * s
        return gamma

    def matrix(self, stiffness: float = 0.0) -> Array:
        """Return A, 1/s, for a trap stiffness k, N/m.

        The coordinates of variance 1 are, as far as they exist, the position x sqrt((k + g)/kT)
        for k + g > 0, the velocity v sqrt(M/kT) for M > 0, the forces f_j/sqrt(kT b_j/t_j) of the
        Maxwell elements, and the velocities u_i sqrt(c_i/(p_i kT)) of the dragged masses.

        Returns
        -------
        ndarray, shape (n, n)
            A, which is symmetric if there are no springs, or no masses: then no bead rings.
        """
        (b, t), (c, p) = self.maxwell, self.dragged
        held = self.spring + stiffness
        springs = np.concatenate([np.full(int(held > 0), held), b / t])
        # coupling of the elements to the velocity of the bead, and their own decay
        to_bead = np.concatenate([-np.sqrt(springs), np.sqrt(c * p)])
        from_bead = np.abs(to_bead)
        own = np.diag(-np.concatenate([np.zeros(int(held > 0)), 1 / t, p]))
        if self.mass == 0:
            return own + np.outer(from_bead, to_bead) / self.fast_drag
        A = np.zeros((len(own) + 1, len(own) + 1))
        at = int(held > 0)  # the velocity follows the position
        others = np.delete(np.arange(len(A)), at)
        A[np.ix_(others, others)] = own
        A[others, at] = from_bead / np.sqrt(self.mass)
        A[at, others] = to_bead / np.sqrt(self.mass)
        A[at, at] = -self.fast_drag / self.mass
        return A

    def mobility(self, stiffness: float = 0.0) -> tuple[float, Decays]:
        """Return w_0, s/kg, and the weights w_l, 1/kg, and rates l of 1/(M s + gamma + k/s).

        `stiffness` k is in N/m. w_0 is 0 with a mass.
        """
        rates, slopes = self._zeros(self.spring + stiffness)
        instant = 0.0 if self.mass else 1 / self.fast_drag
        return instant, Decays(1 / slopes, rates)

    def relaxation(self, stiffness: float = 0.0) -> Decays:
        """Return the autocovariance of the position over the variance kT/(k + g).

        `stiffness` k is in N/m. It is also the position, over the first one, of a bead that a force
        held at rest until all elements were, if the spring was relaxed at the trap's centre.
        Raises `ValueError` without a spring and a trap.
        """
        held = self.spring + stiffness
        if held == 0:
            raise ValueError("stiffness = 0: a free bead has no stationary position")
        rates, slopes = self._zeros(held)
        amplitudes = -held / (rates**2 * slopes)
        if not abs(amplitudes.sum() - 1) < _LOST:
            raise ArithmeticError("the rates of a bead in a viscoelastic medium are not found")
        return Decays(amplitudes, rates)

    def modes(self) -> Modes:
        """Return the modes of the velocity: v = sum a_j v_j, v_j relaxing to F/beta in tau_j.

        beta is the steady drag, and the a_j add up to 1; some are negative beside Maxwell elements.
        The first mode has no inertia, tau = 0, if the bead has no mass. The spring g is not
        included: it is a force.

        Raises
        ------
        SceneError
            If the bead rings by itself, with a complex rate.
        """
        free = Network(self.mass, self.drag, self.maxwell, self.dragged)
        instant, (weights, rates) = free.mobility()
        if np.iscomplexobj(rates):
            ringing = float(np.abs(rates.imag).max() / (2 * np.pi))
            raise SceneError(
                f"medium.relaxing: the bead rings by itself at {ringing:.3g} Hz, which the modes "
                "of its velocity cannot describe; must be softer; set simulation.model to "
                "overdamped"
            )
        beta = self.steady_drag
        times, parts = 1 / rates.real, beta * weights.real / rates.real
        if instant:
            times, parts = np.append(0.0, times), np.append(beta * instant, parts)
        return Modes(times, parts)

    def displacement(self, times: Array, kT: float, stiffness: float = 0.0) -> Array:
        """Return the mean squared displacement along an axis at `times` (n,), s, in m^2.

        `kT` is in J, and the stiffness k of the trap in N/m.
        """
        t = np.asarray(times, float)
        if held := self.spring + stiffness:
            amplitudes, rates = self.relaxation(stiffness)
            moved: Array = -(np.expm1(-np.multiply.outer(t, rates)) @ amplitudes).real
            return 2 * kT / held * moved
        instant, (weights, rates) = self.mobility()
        lag: Array = (_lag(np.multiply.outer(t, rates)) @ (weights / rates**2)).real
        return 2 * kT * (instant * t + lag)

    def velocity(self, times: Array, kT: float, stiffness: float = 0.0) -> Array:
        """Return the velocity autocovariance at `times` (n,) > 0, s, in m^2/s^2.

        Without a mass it lacks the part 2 kT w_0 delta(t). `kT` is in J, and `stiffness` in N/m.
        """
        return kT * self.mobility(stiffness)[1].at(times)

    def spectrum(self, frequencies: Array, kT: float, stiffness: float = 0.0) -> Array:
        """Return the one-sided power spectral density of the position, m^2/Hz.

        It is 4 kT Re(1/Z)/w^2 at `frequencies` (n,) > 0, Hz, with w = 2 pi f. `kT` is in J, and the
        stiffness k of the trap in N/m.
        """
        w = 2 * np.pi * np.asarray(frequencies, float)
        Z = self._impedance(1j * w, self.spring + stiffness)[0]
        density: Array = 4 * kT * Z.real / np.abs(w * Z) ** 2
        return density

    def _impedance(self, s: Any, held: float) -> tuple[Any, Any]:
        """Return Z(s) and Z'(s) at s (n,), 1/s, for the spring and the trap `held` = k + g."""
        (b, t), (c, p) = self.maxwell, self.dragged
        relaxing, dragging = 1 + np.multiply.outer(s, t), np.add.outer(s, p)
        Z = self.mass * s + self.drag + held / s
        Z = Z + (b / relaxing).sum(axis=-1) + (c / dragging).sum(axis=-1) * s
        slope = self.mass - held / s**2 if held else np.full_like(s, self.mass)
        slope = slope - (b * t / relaxing**2).sum(axis=-1) + (c * p / dragging**2).sum(axis=-1)
        return Z, slope

    @functools.lru_cache(maxsize=8)  # noqa: B019
    def _zeros(self, held: float) -> tuple[Any, Any]:
        """Return the rates l, 1/s, of the zeros Z(-l) = 0, and Z'(-l), for `held` = k + g.

        The eigenvalues of A have the error of its largest one; Newton's method gives the slow ones
        all their digits.
        """
        if self.mass == 0 and not self.dragged[0].size:
            s: Any = -self._between_elements(held)
        else:
            A = Network(self.mass, self.drag, self.maxwell, self.dragged).matrix(held)
            even = np.abs(A - A.T).max() <= _ROUNDING * np.abs(A).max()
            s = np.linalg.eigvalsh((A + A.T) / 2) if even else np.linalg.eigvals(A)
        if np.iscomplexobj(s) and np.abs(s.imag).max() == 0:
            s = s.real
        elements = -np.concatenate([[0.0], 1 / self.maxwell[1], self.dragged[1]])
        with np.errstate(all="ignore"):  # an element without effect has its own rate
            for _ in range(_NEWTON):
                Z, slope = self._impedance(s, held)
                step = Z / slope
                room = np.abs(s[:, None] - elements).min(axis=1)
                s = np.where(np.abs(step) < _LONGEST * room, s - step, s)
            slopes = self._impedance(s, held)[1]
            slopes = np.where(np.isfinite(slopes), slopes, np.inf)
        order = np.argsort(np.abs(s))
        return -s[order], slopes[order]

    def _between_elements(self, held: float) -> Array:
        """Return the rates of a bead without masses, 1/s, one above the rate of each spring.

        Z(-l) rises from minus to plus infinity between the rates 0 (for `held` > 0) and 1/t_j.
        """
        b, t = self.maxwell
        springs = np.append(0.0, 1 / t) if held else 1 / t
        low = np.sort(springs)
        high = np.append(low[1:], low.max(initial=0.0) + ((b / t).sum() + held) / self.drag)
        with np.errstate(all="ignore"):
            for _ in range(_HALVINGS):
                middle = 0.5 * (low + high)
                below = self._impedance(-middle, held)[0] < 0
                low, high = np.where(below, middle, low), np.where(below, high, middle)
        return 0.5 * (low + high)


def _lag(x: Any) -> Any:
    """Return x - 1 + e^-x, by its series where |x| is small."""
    series = np.ones_like(x)
    for n in range(_TERMS, 2, -1):
        series = 1 - series * x / n
    return np.where(np.abs(x) < _SHORT, series * x**2 / 2, x + np.expm1(-x))
