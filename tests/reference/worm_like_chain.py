"""Chains by other means: published formulas with 30 digits, and the exact worm-like chain.

The formulas are written as published, with dimensions, and solved by mpmath. The exact chain is a
particle on a sphere in a uniform field: its extension is the mean cosine in the ground state.
"""

import mpmath as mp
import numpy as np
from scipy.linalg import eigh_tridiagonal

KT = mp.mpf("1.380649e-23")
#: powers of x/Lc from 2 to 7 (C. Bouchiat et al., Biophys. J. 76, 409 (1999))
BOUCHIAT = ("-0.5164228", "-2.737418", "16.07497", "-38.87607", "39.49944", "-14.17718")


def exact_extension(force, orders=150):
    """x/Lc of an infinitely long worm-like chain at F Lp/kT.

    H = L^2/2 - f cos(theta) over spherical harmonics with m = 0, in which the cosine couples
    neighbouring degrees.
    """
    degree = np.arange(orders)
    coupling = (degree[:-1] + 1) / np.sqrt((2 * degree[:-1] + 1) * (2 * degree[:-1] + 3))
    _, states = eigh_tridiagonal(
        degree * (degree + 1) / 2, -force * coupling, select="i", select_range=(0, 0)
    )
    ground = states[:, 0]
    return float(2 * (coupling * ground[:-1] * ground[1:]).sum())


def worm_like(x, Lc, Lp, T, S=None, *, bouchiat=False):
    """Force by Marko and Siggia, or by Bouchiat; with S, the chain has the length Lc (1 + F/S)."""

    def law(l):
        more = sum(mp.mpf(a) * l ** (i + 2) for i, a in enumerate(BOUCHIAT)) if bouchiat else 0
        return KT * T / Lp * (1 / (4 * (1 - l) ** 2) - mp.mpf(1) / 4 + l + more)

    if S is None:
        return law(x / Lc)
    return _root(lambda F: F - law(x / Lc - F / S), max(mp.mpf(0), (x / Lc - 1) * S), x / Lc * S)


def odijk(x, Lc, Lp, T, S):
    """Force at which x = Lc (1 - sqrt(kT/(F Lp))/2 + F/S)."""
    return _root(
        lambda F: 1 - mp.sqrt(KT * T / (F * Lp)) / 2 + F / S - x / Lc, mp.mpf(10) ** -16, S
    )


def jointed(x, Lc, Lp, T, S=None):
    """Force at which x = Lc (coth(2 F Lp/kT) - kT/(2 F Lp)) (1 + F/S)."""

    def error(F):
        u = 2 * F * Lp / (KT * T)
        return (mp.coth(u) - 1 / u) * (1 + (F / S if S else 0)) - x / Lc

    return _root(error, mp.mpf(10) ** -24, mp.mpf(10) ** -7)


def twistable(x, Lc, Lp, T, S, C, g0, g1, Fc):
    """Force at which x = Lc (1 - sqrt(kT/(F Lp))/2 + C F/(S C - g^2)), g = g0 + g1 max(F, Fc)."""

    def error(F):
        g = g0 + g1 * max(F, Fc)
        return 1 - mp.sqrt(KT * T / (F * Lp)) / 2 + C * F / (S * C - g**2) - x / Lc

    return _root(error, mp.mpf(10) ** -16, mp.mpf("7.5e-11"))


def _root(error, low, high):
    return mp.findroot(error, (low, high), solver="anderson", tol=1e-50, maxsteps=500, verify=False)
