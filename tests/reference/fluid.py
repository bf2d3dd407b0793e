"""A sphere in a fluid with inertia: closed forms, the same by inversion, and the exact memory.

    M v' + beta v + beta sqrt(tau_f) (d/dt)^(1/2) v = F,    Z(s) = M s + beta (1 + sqrt(s tau_f))

with M = m + m_f/2, m_f the mass of displaced fluid, and tau_f = a^2 rho_f/eta = 4.5 m_f/beta. The
roots of Z in sqrt(s) give the closed forms (E. J. Hinch, J. Fluid Mech. 72, 499 (1975); H. J. H.
Clercx and P. P. J. M. Schram, Phys. Rev. A 46, 1942 (1992)), by w(i z) = exp(z^2) erfc(z).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import mpmath
import numpy as np
from scipy.special import wofz

BOLTZMANN = 1.380649e-23


@dataclass(frozen=True)
class Sphere:
    """SI. Without displaced mass: a bead in a fluid without inertia."""

    mass: float
    drag: float
    displaced_mass: float

    @classmethod
    def of(cls, radius, density, fluid_density=998.2, viscosity=1.0016e-3):
        """From its size and material, in water if nothing else is said."""
        volume = 4 / 3 * math.pi * radius**3
        return cls(density * volume, 6 * math.pi * viscosity * radius, fluid_density * volume)

    @property
    def total_mass(self):
        """M, with the added mass."""
        return self.mass + self.displaced_mass / 2

    @property
    def vorticity_time(self):
        """tau_f."""
        return 4.5 * self.displaced_mass / self.drag

    @property
    def time(self):
        """M/beta, the unit of time in what follows; that of mass is M."""
        return self.total_mass / self.drag

    @property
    def memory(self):
        """sqrt(tau_f) in that unit."""
        return math.sqrt(self.vorticity_time / self.time)

    def _free(self, t):
        """W_i, z_i, P_i and the time, for the roots of z^2 + memory z + 1."""
        return _by_roots([1, self.memory, 1], np.asarray(t, float) / self.time)

    def _trapped(self, t, k):
        polynomial = [1, self.memory, 1, 0, k * self.time / self.drag]
        return _by_roots(polynomial, np.asarray(t, float) / self.time)

    def velocity_correlation(self, t, k=0.0):
        """<v(0) v(t)> over kT/M."""
        if k:
            W, z, P, _ = self._trapped(t, k)
            return (W * z**3 / P).sum(axis=-1).real
        W, z, P, _ = self._free(t)
        return (W * z / P).sum(axis=-1).real

    def settling(self, t):
        """v(t)/F from rest under a constant force F, s/kg: the response of x to an impulse."""
        W, z, P, _ = self._free(t)
        return (1 + (W / (z * P)).sum(axis=-1).real) / self.drag

    def moved(self, t):
        """x(t)/F from rest under a constant force F, m/N."""
        W, z, P, T = self._free(t)
        sum_of_roots = -self.memory
        slow = T + 2 * sum_of_roots * np.sqrt(T / math.pi) + sum_of_roots**2 - 1
        return (slow + (W / (z**3 * P)).sum(axis=-1).real) * self.time / self.drag

    def mean_squared_displacement(self, t, temperature, k=0.0):
        """<(x(t) - x(0))^2>, m^2."""
        kT = BOLTZMANN * temperature
        if k:
            return 2 * kT / k * (1 - self.relaxation(t, k))
        return 2 * kT * self.moved(t)

    def relaxation(self, t, k):
        """x(t)/x(0), released at rest in a trap, the fluid at rest too: <x(0) x(t)>/<x^2>."""
        W, z, P, _ = self._trapped(t, k)
        return -k * self.time / self.drag * (W / (z * P)).sum(axis=-1).real

    def impedance(self, s):
        """Z(s), kg/s."""
        return self.total_mass * s + self.drag * (1 + np.sqrt(s * self.vorticity_time))

    def spectrum(self, f, temperature, k=0.0):
        """Of the position, one-sided, m^2/Hz."""
        s = 2j * math.pi * np.asarray(f, float)
        admittance = 1 / (self.impedance(s) + k / s)
        return 4 * BOLTZMANN * temperature * admittance.real / np.abs(s) ** 2

    @property
    def tail(self):
        """Factor of t^(-3/2) in the velocity's correlation over kT, s^(3/2)/kg."""
        return math.sqrt(self.vorticity_time / math.pi) / (2 * self.drag)

    # --- by another route ------------------------------------------------------------------------
    def inverted(self, name, t, k=0.0, digits=30):
        """One of the functions above at one time, by inversion of its Laplace transform."""
        with mpmath.workdps(digits):
            M, beta, root = self.total_mass, self.drag, mpmath.sqrt(self.vorticity_time)

            def Z(s):
                return M * s + beta * (1 + root * mpmath.sqrt(s))

            transform = {
                "velocity_correlation": lambda s: M / (Z(s) + k / s),
                "settling": lambda s: 1 / (s * Z(s)),
                "moved": lambda s: 1 / (s**2 * Z(s)),
                "relaxation": lambda s: Z(s) / (s * Z(s) + k),
            }[name]
            return float(mpmath.invertlaplace(transform, mpmath.mpf(t), method="talbot"))

    def by_rates(self, t, digits=20):
        """<v(0) v(t)> over kT/M of a free bead, as decays e^(-rate t) with a positive density."""
        M, beta, tau = self.total_mass, self.drag, self.vorticity_time
        with mpmath.workdps(digits):

            def integrand(ln_rate):
                rate = mpmath.exp(ln_rate)
                lag = beta * mpmath.sqrt(rate * tau)
                density = lag / mpmath.pi / ((beta - M * rate) ** 2 + lag**2)
                return M * rate * density * mpmath.exp(-rate * t)

            centre = math.log(1 / t)
            edges = [centre + edge for edge in (-60, -30, -15, -8, -4, -2, 0, 1, 2, 3, 4, 5)]
            return float(mpmath.quad(integrand, edges))


def _by_roots(polynomial, t):
    """w(-i z sqrt(t)), the roots z, the product of each one's distances from the others, and t."""
    with mpmath.workdps(30):
        exact = mpmath.polyroots([mpmath.mpf(c) for c in polynomial], maxsteps=200, extraprec=200)
        products = [mpmath.fprod(z - other for other in exact if other is not z) for z in exact]
        z, P = (np.array([complex(value) for value in values]) for values in (exact, products))
    return wofz(-1j * z * np.sqrt(t)[..., None]), z, P, t


# --- any force, with the exact memory ------------------------------------------------------------
#: Number of nodes of a piece
NODES = 12
#: Number of points of a panel
POINTS = 16
#: Largest number of iterations of a piece
ITERATIONS = 40


class Path:
    """A bead released at rest, the fluid at rest, under a force of its place: Volterra's equation.

        x(t) = x_0 + int_0^t G(t - s) F(x(s)) ds,   G = `Sphere.settling`

    F is a polynomial in each of many pieces, by its values at Gauss's nodes. Where t - s is small
    the integral is over u, t - s = u^2: G is an entire function of u.

    force: from places (n, 3) m to forces (n, 3) N, all of them (light, weight); start: (3,) m;
    tolerance: error of the place that a piece may add, m; impulse: given at t = 0, N s.
    """

    def __init__(self, sphere, force, start, end, tolerance=1e-13, impulse=(0.0, 0.0, 0.0)):
        self.sphere, self.force, self.end = sphere, force, end
        self.start, self.impulse = np.asarray(start, float), np.asarray(impulse, float)
        self.tolerance = tolerance
        self.nodes, _ = np.polynomial.legendre.leggauss(NODES)
        #: from values at the nodes to coefficients of Legendre's polynomials
        self.series = np.linalg.inv(np.polynomial.legendre.legvander(self.nodes, NODES - 1))
        #: begin, length and coefficients of the force of each piece
        self.pieces = []
        #: places and forces of a piece far from its end, as sources
        self.sources = []
        self.calls = 0
        self._matrices = {}
        self._march()

    def _march(self):
        at, length = 0.0, self.sphere.time / 100
        while at < self.end * (1 - 1e-12):
            length = min(length, self.end - at)
            solved = self._piece(at, length)
            if solved is None or solved[1] > self.tolerance:
                length /= 2
                if length < 1e-9 * self.end and length < self.sphere.time / 1e4:
                    raise ArithmeticError(f"no piece is short enough at {at} s")
                continue
            coefficients, error = solved
            self.pieces.append((at, length, coefficients))
            points, weights = np.polynomial.legendre.leggauss(2 * NODES)
            values = np.polynomial.legendre.legval(points, coefficients).T
            self.sources.append(
                (at + length * (points + 1) / 2, length / 2 * weights[:, None] * values)
            )
            at += length
            # an error of the order of NODES powers of the length
            if error < self.tolerance * 2.0 ** (-NODES + 2):
                length *= 2
            elif error > self.tolerance / 4:
                length *= 0.8

    def _piece(self, at, length):
        """Coefficients of the force in a piece, and an estimate of its error."""
        times = at + length * (self.nodes + 1) / 2
        known = self._places_without(times)
        matrix = self._matrix(length)
        F = self._foreseen(times)
        for _ in range(ITERATIONS):
            new = self.force(known + matrix @ F)
            self.calls += 1
            if not np.isfinite(new).all():
                return None
            change = np.abs(new - F).max() * length / self.sphere.drag
            F = new
            if change < 1e-2 * self.tolerance:
                break
        else:
            return None
        coefficients = self.series @ F
        return coefficients, np.abs(coefficients[-2:]).max() * length / self.sphere.drag

    def _foreseen(self, times):
        """The force as the piece before goes on, or that of the start."""
        if not self.pieces:
            return self.force(np.tile(self.start, (NODES, 1)))
        at, length, coefficients = self.pieces[-1]
        ahead = np.minimum(2 * (times - at) / length - 1, 3)
        # by its lowest powers: the others grow outside of their piece
        return np.polynomial.legendre.legval(ahead, coefficients[:4]).T

    def _matrix(self, length):
        """From the forces at the nodes of a piece to what they add to its places."""
        if length not in self._matrices:
            rows = []
            for node in self.nodes:
                reach = length * (node + 1) / 2
                lag, weights = self._panels(0.0, reach)
                values = np.polynomial.legendre.legvander(node - 2 * lag / length, NODES - 1)
                rows.append(weights @ values @ self.series)
            self._matrices = {length: np.array(rows)}
        return self._matrices[length]

    def _panels(self, low, high):
        """Lags t - s from low to high, and weights of a force there times G."""
        ends = [math.sqrt(low), math.sqrt(high)]
        edge = 0.5 * math.sqrt(self.sphere.time)
        inner = []
        while edge < ends[1]:
            if edge > ends[0]:
                inner.append(edge)
            edge *= 1.5
        edges = np.array([ends[0], *inner, ends[1]])
        points, weights = np.polynomial.legendre.leggauss(POINTS)
        half = np.diff(edges)[:, None] / 2
        u = (edges[:-1, None] + half * (points + 1)).ravel()
        lag = u**2
        return lag, (half * weights).ravel() * 2 * u * self.sphere.settling(lag)

    def _places_without(self, times, but_from=None):
        """The places at `times` if no force acted but in the pieces so far, all of which are past.

        but_from: number of the piece up to which forces count.
        """
        pieces, sources = self.pieces[:but_from], self.sources[:but_from]
        x = self.start + self.sphere.settling(times)[:, None] * self.impulse
        # far pieces all at once, near ones by panels
        far = [
            i for i, (at, length, _) in enumerate(pieces)
            if times.min() - (at + length) >= 0.9 * length
        ]  # fmt: skip
        if far:
            when = np.concatenate([sources[i][0] for i in far])
            what = np.concatenate([sources[i][1] for i in far])
            x = x + self.sphere.settling(times[:, None] - when) @ what
        for i in set(range(len(pieces))) - set(far):
            at, length, coefficients = pieces[i]
            for j, t in enumerate(times):
                lag, weights = self._panels(max(t - at - length, 0.0), t - at)
                place = 2 * (t - lag - at) / length - 1
                x[j] += np.polynomial.legendre.legval(place, coefficients) @ weights
        return x

    def __call__(self, times):
        """Places (n, 3), m."""
        times = np.atleast_1d(np.asarray(times, float))
        begins = np.array([at for at, _, _ in self.pieces])
        x = np.empty((len(times), 3))
        for i, t in enumerate(times):
            within = max(int(np.searchsorted(begins, t, side="right")) - 1, 0)
            at, length, coefficients = self.pieces[within]
            x[i] = self._places_without(times[i : i + 1], within)[0]
            lag, weights = self._panels(0.0, t - at)
            place = 2 * (t - lag - at) / length - 1
            x[i] += np.polynomial.legendre.legval(place, coefficients) @ weights
        return x
