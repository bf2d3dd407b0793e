"""A step of a bead in a fluid with inertia: its velocity is a sum of independent Langevin modes.

    x' = sum a_j v_j,   tau_j v_j' = u - v_j + sqrt(2 D/a_j) xi_j,   sum a_j = 1,

with <v_j^2> = D/(tau_j a_j), and the slow velocity u, which includes the trap's spring
(`tweezer.fluid.memory`). In coordinates y of variance 1 a step h is y -> E y + (effect of u and its
rise) + noise, with E = e^(A h) and the noise covariance 1 - E E^T. A short step is doubled, which
keeps the digits of both. Among the velocities E is symmetric, because x and the v_j are even and
odd under time reversal. So there are orthogonal, independent combinations of velocities that decay
separately.

Combinations that decay within the step are merged. However many they are, only two of them matter:
the one that displaces x, and the remaining one that contributes to the velocity.

The noise of n + 1 variables would require n + 1 normal numbers, the most expensive part of a step.
But only position and velocity are observed, and the hidden variables respond to the force plus a
Gaussian process. Any noise that gives position and velocity the same law thus gives the same
motion under every force. The variables z are therefore the conditional mean of the hidden variables
given the positions and velocities so far. The noise of a step is the innovation of the next
position and velocity: two numbers per axis, as without memory (Kalman's filter of observations
without error). The variance of z is less than 1 by the part that positions and velocities do not
determine, which solves a Riccati equation.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from tweezer.compiled import named_njit
from tweezer.compiled.lanes import LANES, lanes, spread, store
from tweezer.dynamics.brownian.coordinate import beyond_spring, led
from tweezer.values.arrays import Array

#: Size of the longest step of the series, norm of the matrix times the step
_SHORT = 1 / 64
#: Terms of the series: of the step, and of its noise
_TERMS = 12
#: Decay over a step below which a combination of velocities is gone
GONE = 1e-10
#: Part of a combination below which it is rounding
_ROUNDING = 1e-9
#: Most doublings of the Riccati equation
_DOUBLINGS = 100

#: Rows of the weights (3, 7 + n, n) of the n hidden variables z along each axis. In a
#: step x gains X_BY z (m) in addition to the terms of `Weights`. The new z is DECAY z + BY_U u +
#: BY_RISE du + NOISE n + OWN n', with the random numbers n of the position and n' of the velocity.
#: The velocity is SEEN z, m/s. Rows ROOT to ROOT + n - 1 are a root of the stationary covariance of
#: z. All share one array, because each array costs time in a call
X_BY, DECAY, BY_U, BY_RISE, NOISE, OWN, SEEN, ROOT = range(8)
#: Weights of a bead without memory
NONE = np.zeros((3, 0, 0))


class Axis(NamedTuple):
    """Coefficients of a step of one axis in a fluid with memory."""

    z: Array
    """(7 + n, n) coefficients of its n hidden variables z, in the rows X_BY, DECAY and so on"""
    x_by_u: float
    """displacement per slow velocity, s"""
    x_by_rise: float
    """displacement per change of the slow velocity, s"""
    noise_x: float
    """standard deviation of the noise of the position, m"""


def axis(
    h: float, times: Array, parts: Array, kappa: float, diffusion: float, gone: float = GONE
) -> Axis:
    """Return the coefficients of a step of one axis.

    Parameters
    ----------
    h : float
        Length of the step, s.
    times, parts : ndarray, shape (n,)
        Relaxation times tau_j, s, and weights a_j of the velocity modes.
    kappa : float
        Stiffness over drag, 1/s; 0 without a spring.
    diffusion : float
        Diffusion coefficient kT/beta, m^2/s.
    gone : float, optional
        Fraction left after the step below which a combination of velocities is dropped.
    """
    n = len(times)
    length = math.sqrt(diffusion * h)
    speed = np.sqrt(diffusion * parts / times)  # of the velocity by coordinates of variance 1
    pushed = speed / diffusion * length
    # place in lengths, velocities, slow velocity in lengths over h, and its rise
    A = np.zeros((n + 3, n + 3))
    v = np.arange(1, n + 1)
    A[0, v] = speed / length
    A[v, 0] = -kappa * pushed
    A[v, v] = -1 / times
    A[v, n + 1] = pushed / h
    A[n + 1, n + 2] = 1 / h
    shaken = np.zeros_like(A)
    shaken[v, v] = 2 / times
    E, Q = of_linear_motion(A, shaken, h)

    kept = _kept(E[v[:, None], v], E[0, v], speed, gone)
    T = np.zeros((1 + len(kept), n + 1))
    T[0, 0], T[1:, 1:] = 1.0, kept
    decay = ((kept @ E[v[:, None], v]) * kept).sum(axis=1)
    decay[np.abs(decay) <= gone] = 0.0
    x_by, seen = kept @ E[0, v], kept @ speed
    left = np.zeros((len(T), len(T)))
    left[0, 1:] = x_by
    np.fill_diagonal(left[1:, 1:], decay)
    told = np.zeros((2, len(T)))
    told[0, 0], told[1, 1:] = 1.0, seen / np.linalg.norm(seen)
    noise, untold = innovations(left, T @ Q[: n + 1, : n + 1] @ T.T, told)
    variance, directions = np.linalg.eigh(np.eye(len(kept)) - untold[1:, 1:])
    rows = [
        x_by * length, decay, kept @ E[v, n + 1] * h / length, kept @ E[v, n + 2] * h / length,
        noise[1:, 0], noise[1:, 1], seen, *(directions * np.sqrt(np.maximum(variance, 0.0))),
    ]  # fmt: skip
    return Axis(np.array(rows), h * E[0, n + 1], h * E[0, n + 2], length * noise[0, 0])


def together(axes: list[Axis]) -> Array:
    """Return the coefficients of z for all axes, (3, 7 + n, n), padded with zeros to the same n."""
    n = max(each.z.shape[1] for each in axes)
    return np.array([np.pad(each.z, (0, n - each.z.shape[1])) for each in axes])


def of_linear_motion(A: Array, shaken: Array, h: float) -> tuple[Array, Array]:
    """Return e^(A h) and the noise covariance of dy = A y dt + sqrt(shaken) dW over a step h.

    `A` (m, m) is in 1/s, and `shaken` (m, m) in variances per second. The series of a short step is
    doubled to h, so that coordinates of very different size keep their digits.
    """
    size = float(np.linalg.norm(A, 2)) * h
    halvings = max(0, math.ceil(math.log2(max(size / _SHORT, 1.0))))
    A, covariance = A * math.ldexp(h, -halvings), np.zeros_like(A)
    change, power, noise = np.zeros_like(A), np.eye(len(A)), shaken * math.ldexp(h, -halvings)
    for k in range(1, _TERMS):
        power = power @ A / k
        change = change + power
        covariance = covariance + noise
        noise = (A @ noise + noise @ A.T) / (k + 1)
    for _ in range(halvings):
        left = np.eye(len(A)) + change
        covariance = covariance + left @ covariance @ left.T
        change = 2 * change + change @ change
    return np.eye(len(A)) + change, covariance


def _kept(E: Array, x_by: Array, seen: Array, gone: float) -> Array:
    """Return orthonormal combinations (m, n) of the n mode velocities that must be followed.

    They are the eigenvectors of the symmetric step E (n, n) with |eigenvalue| > gone, which survive
    a step. The remainders of `x_by` (n,) and `seen` (n,), by which the velocities contribute to the
    displacement and to the bead's velocity, are added to them.
    """
    decay, directions = np.linalg.eigh((E + E.T) / 2)
    slow = directions[:, np.abs(decay) > gone].T
    found = [*slow]
    for row in (x_by, seen):
        rest = row
        for _ in range(2):  # twice, to remove rounding errors
            rest = rest - sum((each * (each @ rest) for each in found), np.zeros_like(rest))
        if np.linalg.norm(rest) > _ROUNDING * np.linalg.norm(row):
            found.append(rest / np.linalg.norm(rest))
    return np.array(found)


def innovations(left: Array, noise: Array, told: Array) -> tuple[Array, Array]:
    """Return the noise (n, 2) of the innovations, and the covariance (n, n) that stays unknown.

    In a step the variables y become `left` y + noise; `left` is (n, n) and `noise` its covariance
    (n, n). Two combinations of them, C y with C = `told` (2, n), are observed without error. The
    innovations are the unpredictable part of the next observation. The covariance S of y given all
    observations solves S = P - P C^T (C P C^T)^-1 C P with P = left S left^T + noise. It is found
    by doubling (E. K.-W. Chu, H.-Y. Fan, W.-W. Lin, Linear Algebra Appl. 396, 55 (2005)).
    """
    one = np.eye(len(left))
    of_told = told @ noise @ told.T
    gain = np.linalg.solve(of_told, told @ noise).T
    H = told @ left
    A, G = (left - gain @ H).T, H.T @ np.linalg.solve(of_told, H)
    S = noise - gain @ told @ noise
    S = (S + S.T) / 2
    for _ in range(_DOUBLINGS):
        ahead, more = np.linalg.solve(one + G @ S, A), np.linalg.solve(one + G @ S, G)
        change = A.T @ S @ ahead
        G = G + A @ (more + more.T) @ A.T / 2
        S, A = S + (change + change.T) / 2, A @ ahead
        if np.abs(change).max() < 1e-17:
            break
    P = left @ S @ left.T + noise
    root = np.linalg.cholesky(told @ P @ told.T)
    return np.linalg.solve(root, told @ P).T, S


@named_njit(inner=True, error_model="numpy")
def lead(weights, beads, out):  # type: ignore[no-untyped-def]
    """Fill `out` (dims, w) with the positions after a step under the present u, z and noise.

    Only the three axes of translation are filled. u is the slow velocity at the beginning of the
    step. The hidden variables z are in `beads.v` after the velocities. `out` may be `beads.x`.
    """
    x, u, z, normal = beads.x, beads.u, beads.v, beads.normal
    memory, n = weights.memory, weights.memory.shape[2]
    dims, width = x.shape
    for k in range(3):
        by_u, wide = weights.by_u[k], weights.noise_x[k]
        for i in range(0, width, LANES):
            at = k * width + i
            there = led(lanes(x, at), lanes(u, at), lanes(normal, at), by_u, wide)
            for j in range(n):
                there = there + memory[k, X_BY, j] * lanes(z, (dims + k * n + j) * width + i)
            store(out, at, there)


@named_njit(inner=True, error_model="numpy")
def after(weights, beads):  # type: ignore[no-untyped-def]
    """Advance the hidden variables z by a step, from the initial slow velocity and the noise.

    They are rows of `beads.v`, changed in place; `rise` adds the effect of the changing force.
    """
    u, z, normal = beads.u, beads.v, beads.normal
    dims, width = beads.x.shape
    memory, n = weights.memory, weights.memory.shape[2]
    for k in range(3):
        for i in range(0, width, LANES):
            at = k * width + i
            pull, news, own = lanes(u, at), lanes(normal, at), lanes(normal, at + dims * width)
            for j in range(n):
                here = (dims + k * n + j) * width + i
                pushed = memory[k, BY_U, j] * pull + memory[k, NOISE, j] * news
                left = memory[k, DECAY, j] * lanes(z, here)
                store(z, here, left + (pushed + memory[k, OWN, j] * own))


@named_njit(inner=True, error_model="numpy")
def rise(weights, beads):  # type: ignore[no-untyped-def]
    """Complete a step of Heun: store the positions in `beads.x`, and correct z.

    The slow velocity changes over the step by more than the spring's change. This difference is
    added, with its weights, to the positions `beads.ahead` and to the hidden variables z.
    """
    x, u, z, ahead = beads.x, beads.u, beads.v, beads.ahead
    memory, n = weights.memory, weights.memory.shape[2]
    dims, width = x.shape
    for k in range(3):
        kappa, by_rise = weights.kappa[k], weights.by_rise[k]
        for i in range(0, width, LANES):
            at = k * width + i
            there, u_there = lanes(ahead, at), lanes(beads.u_ahead, at)
            rise = beyond_spring(lanes(x, at), there, lanes(u, at), u_there, kappa)
            store(x, at, there + by_rise * rise)
            for j in range(n):
                here = (dims + k * n + j) * width + i
                store(z, here, lanes(z, here) + memory[k, BY_RISE, j] * rise)


@named_njit(inner=True, error_model="numpy")
def velocities(weights, beads):  # type: ignore[no-untyped-def]
    """Fill the first rows of `beads.v` with the translational velocities SEEN z, m/s."""
    memory, n, z = weights.memory, weights.memory.shape[2], beads.v
    dims, width = beads.x.shape
    for k in range(3):
        for i in range(0, width, LANES):
            v = spread(0.0)
            for j in range(n):
                v = v + memory[k, SEEN, j] * lanes(z, (dims + k * n + j) * width + i)
            store(beads.v, k * width + i, v)
