"""Thermal motion of two beads: a step in the coordinates of `tweezer.beads.plane`."""

from __future__ import annotations

import math

import numpy as np

from tweezer.beads.forces import add_forces
from tweezer.beads.plane import (
    ACROSS,
    ALONG,
    GAMMA,
    OTHER,
    PHI,
    SLOPE,
    TURN,
    B,
    S,
    T,
    read,
)
from tweezer.compiled import cached_njit, named_njit
from tweezer.dynamics.brownian.noise import NOISE, normals

#: Random numbers of a step
DRAWS = 7


@named_njit(inner=True, error_model="numpy")
def _rates(plane, at, rho, n, f, turning, moving):  # type: ignore[no-untyped-def]
    """Return the drift of W over W, 1/s; fill the rates of n, 1/s, and of X, m/s.

    at: (10,) functions at the distance rho, m. n: (3,) direction. f: (2, 3) N forces on the beads.
    The rate of X leaves out the part gamma of the motion across n.
    """
    phi = at[PHI]
    along, total_along = 0.0, 0.0
    for j in range(3):
        total_along += (f[0, j] + f[1, j]) * n[j]
        along += 0.5 * (f[1, j] - f[0, j]) * n[j]
    for j in range(3):
        total = f[0, j] + f[1, j]
        total_across = total - total_along * n[j]
        apart_across = 0.5 * (f[1, j] - f[0, j]) - along * n[j]
        pushed = apart_across + (phi / rho + at[GAMMA]) * total_across
        turning[j] = at[B] / rho * pushed
        moving[j] = at[ALONG] * total_along * n[j] + at[ACROSS] * total_across
    apart = along + at[SLOPE] * total_along + 2.0 * plane.kT / rho
    return at[S] * apart + at[T]


@named_njit(inner=True, error_model="numpy")
def _basis(n, e):  # type: ignore[no-untyped-def]
    """Fill e (2, 3) with unit vectors across n, without a division by a small number."""
    sign = 1.0 if n[2] >= 0.0 else -1.0
    a = -1.0 / (sign + n[2])
    b = n[0] * n[1] * a
    e[0, 0], e[0, 1], e[0, 2] = 1.0 + sign * n[0] * n[0] * a, sign * b, -sign * n[0]
    e[1, 0], e[1, 1], e[1, 2] = b, sign + n[1] * n[1] * a, -n[1]


@named_njit(inner=True, error_model="numpy")
def _turned(n, by, out):  # type: ignore[no-untyped-def]
    """Fill out (3,) with n after a turn by the vector `by` across it, rad."""
    angle = math.sqrt(by[0] * by[0] + by[1] * by[1] + by[2] * by[2])
    cosine = math.cos(angle)
    sine = math.sin(angle) / angle if angle > 0.0 else 1.0
    norm = 0.0
    for j in range(3):
        out[j] = cosine * n[j] + sine * by[j]
        norm += out[j] * out[j]
    norm = math.sqrt(norm)
    for j in range(3):
        out[j] /= norm


@named_njit(inner=True, error_model="numpy")
def _place(plane, at, place, n, x):  # type: ignore[no-untyped-def]
    """Fill x (2, 3) with the beads at the place X (3,), the direction n and a gap of the table."""
    rho = plane.total + math.exp(at[OTHER])
    for j in range(3):
        centre = place[j] + n[j] * at[PHI]
        x[0, j] = centre - 0.5 * rho * n[j]
        x[1, j] = centre + 0.5 * rho * n[j]
    return rho


@cached_njit(error_model="numpy", nogil=True)
def advance(acting, plane, seed, step, who, first, per_sample, x, out):  # type: ignore[no-untyped-def]
    """Advance copies of two beads, sample by sample.

    Parameters
    ----------
    acting : Acting
        Forces.
    plane : Plane
        Mobilities of the two beads.
    seed : int
        Seed of the random numbers.
    step : float
        Length of a step, s.
    who : ndarray of int64, shape (copies,)
        Numbers of the trajectories, which determine the random numbers.
    first : int
        Number of the first step.
    per_sample : int
        Number of steps from sample to sample.
    x : ndarray, shape (copies, 2, 3)
        Positions, m; replaced.
    out : ndarray, shape (copies, samples, 2, 3)
        Filled with the positions after every `per_sample` steps, m.
    """
    copies = who.size
    drawn = np.empty((DRAWS, copies))
    f, ahead = np.empty((copies, 2, 3)), np.empty((copies, 2, 3))
    begun, e = np.empty((copies, 10)), np.empty((2, 3))
    at, later = np.empty(10), np.empty(10)
    n, place = np.empty((copies, 3)), np.empty((copies, 3))
    turning, moving = np.empty((copies, 3)), np.empty((copies, 3))
    turned, moved, by, end, there = (
        np.empty(3), np.empty(3), np.empty(3), np.empty(3), np.empty(3),
    )  # fmt: skip
    W, pull, apart = np.empty((copies, 2)), np.empty(copies), np.empty(copies)
    root = math.sqrt(step)
    for s in range(first, first + per_sample * out.shape[1]):
        normals(seed, who, s, NOISE, drawn)
        add_forces(acting, s * step, x, f)
        for i in range(copies):
            rho = 0.0
            for j in range(3):
                n[i, j] = x[i, 1, j] - x[i, 0, j]
                rho += n[i, j] * n[i, j]
            rho = apart[i] = math.sqrt(rho)
            gap = max(rho - plane.total, 1e-12 * plane.total)
            read(plane.by_gap, plane.ends[0], plane.ends[1], math.log(gap), begun[i])
            for j in range(3):
                n[i, j] /= rho
                place[i, j] = 0.5 * (x[i, 0, j] + x[i, 1, j]) - n[i, j] * begun[i, PHI]
            R = math.exp(begun[i, OTHER])
            pull[i] = _rates(plane, begun[i], rho, n[i], f[i], turning[i], moving[i]) * R
            W[i, 0], W[i, 1] = R + root * drawn[0, i], root * drawn[1, i]
            ahead_x, ahead_y = W[i, 0] + step * pull[i], W[i, 1]
            length = 0.5 * math.log(ahead_x * ahead_x + ahead_y * ahead_y)
            read(plane.by_length, plane.ends[2], plane.ends[3], length, at)
            _noise(plane, begun[i], begun[i], n[i], drawn, i, root, e, by, moved)
            for j in range(3):
                by[j] += step * turning[i, j]
            _turned(n[i], by, end)
            for j in range(3):
                there[j] = place[i, j] + moved[j] + step * moving[i, j]
                there[j] += begun[i, GAMMA] * rho * (end[j] - n[i, j])
            _place(plane, at, there, end, ahead[i])
        add_forces(acting, (s + 1) * step, ahead, f)
        for i in range(copies):
            rho = 0.0
            for j in range(3):
                end[j] = ahead[i, 1, j] - ahead[i, 0, j]
                rho += end[j] * end[j]
            rho = math.sqrt(rho)
            for j in range(3):
                end[j] /= rho
            ahead_x, ahead_y = W[i, 0] + step * pull[i], W[i, 1]
            length = 0.5 * math.log(ahead_x * ahead_x + ahead_y * ahead_y)
            read(plane.by_length, plane.ends[2], plane.ends[3], length, at)
            rate = _rates(plane, at, rho, end, f[i], turned, moved)
            W[i, 0] += 0.5 * step * (pull[i] + rate * ahead_x)
            W[i, 1] += 0.5 * step * rate * ahead_y
            length = 0.5 * math.log(W[i, 0] * W[i, 0] + W[i, 1] * W[i, 1])
            read(plane.by_length, plane.ends[2], plane.ends[3], length, later)
            along = turned[0] * n[i, 0] + turned[1] * n[i, 1] + turned[2] * n[i, 2]
            for j in range(3):
                turning[i, j] = 0.5 * (turning[i, j] + turned[j] - along * n[i, j])
                moving[i, j] = 0.5 * (moving[i, j] + moved[j])
            _noise(plane, begun[i], later, n[i], drawn, i, root, e, by, moved)
            for j in range(3):
                by[j] += step * turning[i, j]
            _turned(n[i], by, end)
            gamma = 0.5 * (begun[i, GAMMA] + later[GAMMA])
            mean = 0.5 * (apart[i] + plane.total + math.exp(later[OTHER]))
            for j in range(3):
                there[j] = place[i, j] + moved[j] + step * moving[i, j]
                there[j] += gamma * mean * (end[j] - n[i, j])
            _place(plane, later, there, end, x[i])
        sample = (s + 1 - first) // per_sample
        if sample * per_sample == s + 1 - first:
            out[:, sample - 1] = x


@named_njit(inner=True, error_model="numpy")
def _noise(plane, begun, ended, n, drawn, i, root, e, by, moved):  # type: ignore[no-untyped-def]
    """Fill the random turn `by` (3,), rad, and the random part `moved` (3,), m, of X.

    The diffusion is the mean over the begin and the end of the step.
    """
    _basis(n, e)
    turn = root * math.sqrt(plane.kT * (begun[TURN] + ended[TURN]))
    along = root * math.sqrt(plane.kT * (begun[ALONG] + ended[ALONG]))
    across = root * math.sqrt(plane.kT * (begun[ACROSS] + ended[ACROSS]))
    for j in range(3):
        by[j] = turn * (drawn[2, i] * e[0, j] + drawn[3, i] * e[1, j])
        moved[j] = along * drawn[4, i] * n[j]
        moved[j] += across * (drawn[5, i] * e[0, j] + drawn[6, i] * e[1, j])
