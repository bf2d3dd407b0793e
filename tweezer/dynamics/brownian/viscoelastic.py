"""A step of a bead in a viscoelastic medium, a network of elements (`tweezer.fluid.network`).

As in a fluid with inertia (`tweezer.dynamics.brownian.memory`), the step is exact, and its hidden
variables are conditional means given the observed motion. But its matrix is symmetric only without
masses or without springs. The combinations that decay separately are therefore the left
eigenvectors of the step. Combinations that decay within it are merged into the one that displaces
the bead and the remaining one that contributes to the velocity. Without mass the position alone is
observed, and a step needs one normal number for each axis.
"""

from __future__ import annotations

import math

import numpy as np

from tweezer.dynamics.brownian.memory import GONE, Axis, innovations, of_linear_motion
from tweezer.fluid import Network
from tweezer.values.arrays import Array
from tweezer.values.errors import SceneError

#: Part of a combination below which it is rounding
_ROUNDING = 1e-9
#: Decay over a step below which a pair of combinations that turn into each other is gone too. Their
#: part of the motion is much smaller
_PAIRS = 1e-3


def axis(h: float, network: Network, kappa: float, diffusion: float, gone: float = GONE) -> Axis:
    """Return the coefficients of a step of one axis.

    Parameters
    ----------
    h : float
        Length of the step, s.
    network : Network
        Bead and elements.
    kappa : float
        Trap stiffness over the solvent's drag, 1/s; 0 without a spring.
    diffusion : float
        kT over the solvent's drag, m^2/s.
    gone : float, optional
        Fraction left after the step below which a combination of velocities is dropped.

    Raises
    ------
    SceneError
        If the bead rings against the elements.
    """
    length = math.sqrt(diffusion * h)
    # with a spring by which the position in lengths has variance 1
    still = network.matrix(network.drag / h)
    n = len(still)
    # all coordinates, slow velocity in lengths over h, and its rise
    A, shaken = np.zeros((2, n + 2, n + 2))
    A[:n, :n], shaken[:n, :n] = still, -(still + still.T)
    A[:n, 0], A[:n, n] = still[:, 0] * kappa * h, -still[:, 0]
    A[n, n + 1] = 1 / h
    E, Q = of_linear_motion(A, shaken, h)

    v = np.arange(1, n)
    speed = np.zeros(n - 1)
    if network.mass:
        speed[0] = math.sqrt(diffusion * network.drag / network.mass)
    kept, decay, x_by, seen = _kept(E[v[:, None], v], E[0, v], speed, gone)
    T = np.zeros((1 + len(kept), n))
    T[0, 0], T[1:, 1:] = 1.0, kept
    left = np.zeros((len(T), len(T)))
    left[0, 1:] = x_by
    np.fill_diagonal(left[1:, 1:], decay)
    told = np.eye(1, len(T))
    if network.mass:
        told = np.vstack([told, np.append(0.0, seen / np.linalg.norm(seen))])
    noise, untold = innovations(left, T @ Q[:n, :n] @ T.T, told)
    variance, directions = np.linalg.eigh(kept @ kept.T - untold[1:, 1:])
    own = noise[1:, 1] if network.mass else np.zeros(len(kept))
    rows = [
        x_by * length, decay, kept @ E[v, n] * h / length, kept @ E[v, n + 1] * h / length,
        noise[1:, 0], own, seen, *(directions * np.sqrt(np.maximum(variance, 0.0))),
    ]  # fmt: skip
    return Axis(np.array(rows), h * E[0, n], h * E[0, n + 1], length * noise[0, 0])


def _kept(E: Array, x_by: Array, seen: Array, gone: float) -> tuple[Array, Array, Array, Array]:
    """Return combinations z (m, n) of the n hidden coordinates that must be followed.

    They are the left eigenvectors of the step E (n, n) with |eigenvalue| > gone. By `x_by` (n,) and
    `seen` (n,) the coordinates contribute to the displacement and to the velocity; the remainders
    of both are added. The function also returns the decay (m,) of the combinations in a step and
    their contributions (m,).
    """
    from scipy.linalg import eig

    values, onto, of = eig(E, left=True)
    pairs = values.imag != 0
    slow = np.abs(values) > np.where(pairs, _PAIRS, gone)
    if pairs[slow].any():
        raise SceneError(
            "medium.relaxing: the bead rings against the medium, which a step cannot follow; must "
            "be softer; set simulation.model to overdamped"
        )
    L, R = onto[:, slow].real.T, of[:, slow].real
    R = R @ np.linalg.inv(L @ R)
    kept, decay = [*L], [*values[slow].real]
    by = [[*(row @ R)] for row in (x_by, seen)]
    found: list[Array] = []
    for i, row in enumerate((x_by, seen)):
        rest = row - row @ R @ L
        size = float(np.linalg.norm(row))
        for j, each in enumerate(found):
            by[i][len(L) + j] = each @ rest
            rest = rest - each * (each @ rest)
        if np.linalg.norm(rest) > _ROUNDING * size:
            found.append(rest / np.linalg.norm(rest))
            for k in range(2):
                by[k].append(float(np.linalg.norm(rest)) if k == i else 0.0)
            kept.append(found[-1])
            decay.append(0.0)
    return np.array(kept), np.array(decay), np.array(by[0]), np.array(by[1])
