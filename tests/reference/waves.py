"""The force of focused circular light on a sphere by wave optics: exact, and slow.

Debye's focus of an aplanatic lens (sine condition): plane waves in phase at the focus, of the power
per solid angle W(theta). Multipoles of helicity +-1 about the bead's centre; the sphere by Mie's
coefficients (Bohren and Huffman, Absorption and Scattering of Light by Small Particles, 1983,
chapter 4); the force from the momentum of the light before and after, which couples neighbouring
multipoles only (Maia Neto and Nussenzveig, Europhys. Lett. 50, 702, 2000; Mazolli, Maia Neto and
Nussenzveig, Proc. R. Soc. A 459, 3021, 2003).

Lengths are in wavelengths in the medium, forces in n_m P/c.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.polynomial.legendre import leggauss
from scipy.special import gammaln, jv, spherical_jn, spherical_yn

K = 2 * math.pi


@dataclass(frozen=True)
class Light:
    """Circular light of 1 W from a pupil with the intensity exp(-2 (rho/(waist R))^2)."""

    aperture: float
    """sin(theta_m) = NA/n_m"""
    waist: float
    """in radii R of the pupil"""

    def nodes(self, count):
        """cos(theta), weights, and W, 1/sr, at Gauss-Legendre nodes over the cone."""
        lowest = math.sqrt(1 - self.aperture**2)
        x, weight = leggauss(count)
        u, weight = lowest + (1 - lowest) * (x + 1) / 2, weight * (1 - lowest) / 2
        W = u * np.exp(-2 * (1 - u**2) / (self.aperture * self.waist) ** 2)
        return u, weight, W / (K * weight @ W)

    @cached_property
    def effective_aperture(self):
        """sqrt(2 <sin^2 theta>)."""
        u, weight, W = self.nodes(100)
        return math.sqrt(2 * K * weight @ (W * (1 - u**2)))


@dataclass(frozen=True)
class Sphere:
    """A sphere of that radius, of n_P/n_m."""

    radius: float
    index_ratio: float

    @cached_property
    def coefficients(self):
        """By Mie's a_n and b_n, n = 1, 2, ...: -(a + b) keeps the helicity, b - a turns it."""
        x = K * self.radius
        n = np.arange(1, int(x + 4 * x ** (1 / 3) + 4) + 2)
        m = self.index_ratio

        def riccati(function, argument):
            value = argument * function(n, argument)
            return value, function(n, argument) + argument * function(n, argument, True)

        (psi, d_psi), (chi, d_chi) = riccati(spherical_jn, x), riccati(spherical_yn, x)
        inner, d_inner = riccati(spherical_jn, m * x)
        xi, d_xi = psi + 1j * chi, d_psi + 1j * d_chi
        a = (m * inner * d_psi - psi * d_inner) / (m * inner * d_xi - xi * d_inner)
        b = (inner * d_psi - m * psi * d_inner) / (inner * d_xi - m * xi * d_inner)
        return -(a + b), b - a


def force(light, sphere, rho, z):
    """F_x, F_y, F_z at (rho, 0, z) from the focus, (n, 3)."""
    rho, z = np.broadcast_arrays(np.asarray(rho, float), np.asarray(z, float))
    T, S = sphere.coefficients
    highest = len(T)
    theta_m = math.asin(light.aperture)
    # phases over the cone, and multipoles about the axis that light beside it has
    phase = K * theta_m * (sphere.radius + np.hypot(rho, z).max())
    across = K * light.aperture * rho.max()
    M = min(highest, int(across + 5 * across ** (1 / 3) + 4)) if across > 0 else 2
    u, weight, W = light.nodes(int(phase / 3 + 3 * phase ** (1 / 3) + 10))
    waves = np.exp(1j * K * np.multiply.outer(z, u)) * weight * np.sqrt(W)
    bessel = K * np.multiply.outer(rho, np.sqrt(1 - u**2))
    p = {
        m: K * 1j ** ((m - 1) % 4) * harmonics(m, highest, u) @ (waves * jv(m - 1, bessel)).T
        for m in range(-M, M + 2)
    }
    n = np.arange(1.0, highest + 1)[:, None]
    T, S = T[:, None], S[:, None]
    V = 2 * T.real + abs(T) ** 2 - abs(S) ** 2
    U = T[1:].conj() + T[:-1] + T[1:].conj() * T[:-1] + S[1:].conj() * S[:-1]
    low, high = n[:-1], n[1:]
    along, sideways = np.zeros(len(z)), np.zeros(len(z), complex)
    for m in range(-M, M + 1):
        here, above = p[m], p[m + 1]
        along -= (2 * alpha(high, m) * (U * here[1:].conj() * here[:-1]).real).sum(0)
        along -= (m / (n * (n + 1)) * V * abs(here) ** 2).sum(0)
        up = -root((high**2 - 1) * (low + m + 1) * (low + m + 2) / (4 * high**2 - 1)) / high
        same = root((n - m) * (n + m + 1)) / (n * (n + 1))
        down = root((high**2 - 1) * (high - m) * (high - m - 1) / (4 * high**2 - 1)) / high
        sideways -= (up * U * above[1:].conj() * here[:-1]).sum(0)
        sideways -= (same * V * above.conj() * here).sum(0)
        sideways -= (down * U.conj() * above[:-1].conj() * here[1:]).sum(0)
    return np.stack([sideways.real, sideways.imag, along], axis=1)


def harmonics(m, highest, u):
    """f_nm(u) of the harmonics exp(i m phi) f_nm e_+ of helicity +1, n = 1 to highest, (n, q)."""
    f = np.zeros((highest + 2, len(u)))
    C, S = np.sqrt((1 + u) / 2), np.sqrt((1 - u) / 2)
    first, q = max(abs(m), 1), abs(m)
    if m == 0:
        f[1] = -math.sqrt(3 / K) * S * C
    elif first <= highest:
        logs = math.log((2 * first + 1) / (2 * K)) + gammaln(2 * q + 1) - gammaln(q + 2)
        size = np.exp((logs - gammaln(q)) / 2 + (q - 1) * np.log(S * C))
        f[first] = (-1) ** m * size * C**2 if m > 0 else -size * S**2
    for n in range(first, highest):
        beta = m / (n * (n + 1))
        f[n + 1] = ((u - beta) * f[n] - alpha(n, m) * f[n - 1]) / alpha(n + 1, m)
    return f[1:-1]


def alpha(n, m):
    """Element <n m|cos(theta)|n-1 m> between harmonics of helicity +-1."""
    return root((n**2 - m**2) * (n**2 - 1) / (4 * n**2 - 1)) / n


def root(square):
    """Of squares that are negative where no harmonic is."""
    return np.sqrt(np.maximum(square, 0.0))
