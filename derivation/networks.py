"""Passive networks: the resolvent of a bead with one element of each kind, and its noise.

In coordinates of variance 1 the motion is y' = A y + noise of the covariance -(A + A^T). The
functions return expressions that are zero.
"""

from __future__ import annotations

import sympy as sp

M, beta, b, t, c, p, k = sp.symbols("M beta b t c p k", positive=True)
s = sp.Symbol("s")
#: Z(s) = M s + gamma(s) + k/s
IMPEDANCE = M * s + beta + b / (1 + s * t) + c * s / (s + p) + k / s
#: A of position, velocity, Maxwell element and dragged mass
A = sp.Matrix([
    [0, sp.sqrt(k / M), 0, 0],
    [-sp.sqrt(k / M), -(beta + c) / M, -sp.sqrt(b / t / M), sp.sqrt(c * p / M)],
    [0, sp.sqrt(b / t / M), -1 / t, 0],
    [0, sp.sqrt(c * p / M), 0, -p],
])  # fmt: skip


def resolvent() -> sp.Expr:
    """Return M Z times the response of the velocity to a force, less M."""
    rest = s * sp.eye(4) - A
    response = rest.minor(1, 1) / rest.det()
    return sp.simplify(response * IMPEDANCE - M)


def noise() -> tuple[sp.Expr, ...]:
    """Return what -(A + A^T) has beyond the noise of the dashpots beta, b and c alone.

    The dashpot c shakes bead and dragged mass with opposite forces, whose impulses are exchanged.
    """
    between = sp.Matrix([0, sp.sqrt(c / M), 0, -sp.sqrt(p)])
    of_dashpots = sp.diag(0, 2 * beta / M, 2 / t, 0) + 2 * between * between.T
    return tuple(sp.simplify(each) for each in -(A + A.T) - of_dashpots)
