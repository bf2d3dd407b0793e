"""Loss of a bead within a step: the motion between the ends of a step is a Brownian bridge.

A bead is inside a boundary by the distances a and b at the ends of a step h. It has crossed the
boundary in between with the probability

    p = exp(-a b/(D h)),

and crosses it after the fraction s/(1 + s) of the step. The distribution of s is inverse Gaussian
with the mean a/|b| and the shape a^2/(2 D h). A step that ends outside, b < 0, has crossed it at
such a time too. Both laws are exact for a plane under a constant drift. They are also exact for a
sphere without drift. The distance of a free bead from a point is a Bessel process in three
dimensions, and its bridge is a Brownian bridge on a line that stays above 0 (D. Revuz, M. Yor,
Continuous Martingales and Brownian Motion, 1999, XI.3). The number s has the distribution of a
first passage, because a bridge is a Brownian motion in another time.

A velocity makes the motion smooth within the relaxation time. D is then smaller. It is chosen so
that the position in the middle of a step has the right variance for given velocities at its ends
(`share`).

Beads further inside than the reach of a step are not tested. The loop compares the distances at the
ends of steps with another threshold for this, at no extra cost.
"""

from __future__ import annotations

import functools
import math
from typing import NamedTuple

import numpy as np
from numba import typeof, types

from tweezer.compiled import address, cached_njit, call, named_njit
from tweezer.dynamics.brownian import memory
from tweezer.dynamics.brownian.batch import BEADS
from tweezer.dynamics.brownian.noise import CROSSING, normals
from tweezer.fluid import Mobility, Modes
from tweezer.forces.data import Part, packed
from tweezer.forces.force import Pose

#: Standard deviations of a step beyond which no step goes: the random numbers end at 8.57
_MOST = 8.6
#: Exponent of a negligible probability
_NONE = 40.0


class Boundary(NamedTuple):
    """Surfaces at which a bead is lost, and what the test for a crossing within a step needs."""

    loss: float
    """radius of the sphere about the focus at which a bead is lost, m"""
    lens: float
    """m, z at which a bead touches the lens"""
    margin: float
    """longest displacement of a bead in a step, m: beads further inside need no test"""
    spread: float
    """variance of the displacement in a step without drift, over the mobility, J s"""
    mobility: float
    """mobility of translation, s/kg, if the drag is the same everywhere"""
    uniform: bool
    """whether the drag is the same everywhere"""
    drag: Part
    """compiled drag with its data, used if the drag depends on the position"""
    find: int
    """address of the function `find`; 0 until a bead comes near, because not all scenes compile it
    """


def way(step: float, kT: float, mobility: float, modes: Modes | None, drift: float) -> float:
    """Return the longest displacement of a bead in a step, without an initial velocity, m.

    Parameters
    ----------
    step : float
        Length of the step, s.
    kT : float
        Thermal energy, J.
    mobility : float
        Mobility of translation, s/kg.
    modes : Modes or None
        Modes of the velocity; None without inertia.
    drift : float
        Largest slow velocity, m/s.
    """
    part = 1.0  # by which inertia shortens the mean squared displacement, and the drift from rest
    if modes is not None:
        late = modes.weights * modes.times * np.expm1(-step / modes.times)
        part = max(1 + float(late.sum()) / step, 0.0)
    return _MOST * math.sqrt(2 * kT * mobility * step * part) + drift * step * part


def share(step: float, modes: Modes) -> float:
    """Return the variance in the middle of a step, divided by the variance of a Brownian bridge.

    The positions and velocities of a free bead are known at both ends. `modes` describes its
    velocity correlation.
    """
    n = len(modes.times)
    speed = np.sqrt(modes.weights / modes.times * step)  # place in sqrt(D h), time in h
    A, shaken = np.zeros((n + 1, n + 1)), np.zeros((n + 1, n + 1))
    A[0, 1:] = speed
    rates = step / modes.times
    A[range(1, n + 1), range(1, n + 1)] = -rates
    shaken[range(1, n + 1), range(1, n + 1)] = 2 * rates
    E, Q = memory.of_linear_motion(A, shaken, 0.5)
    gain = np.linalg.solve(E @ Q @ E.T + Q, E @ Q).T
    return float(max((Q - gain @ E @ Q)[0, 0] * 2, 0.0))


BOUNDARY = typeof(Boundary(0.0, 0.0, 0.0, 0.0, 0.0, True, Part(0, packed()), 0))
#: Signature of `find`
FIND = types.void(
    BOUNDARY, types.int64, types.int64[::1], types.int64, types.float64[:, ::1], types.boolean,
    BEADS, types.float64[::1],
)  # fmt: skip


@functools.cache
def finder() -> int:
    """Return the address of `find`, compiled once in a process."""
    return address(find, FIND)


def finder_if_compiled() -> int:
    """Return the address of `find`; 0 if this process has not needed it."""
    return finder() if finder.cache_info().currsize else 0


@named_njit(inner=True, error_model="numpy")
def all_far(edge, x, n):  # type: ignore[no-untyped-def]
    """Return whether no bead can be lost in the next step and all positions are finite.

    edge: `Boundary`. x: (3, w) positions, m, of which the first n columns are beads.
    """
    far, near = edge.lens + edge.margin, max(edge.loss - edge.margin, 0.0)
    there, near = True, near * near
    for i in range(n):
        squared = x[0, i] * x[0, i] + x[1, i] * x[1, i] + x[2, i] * x[2, i]
        there &= (squared < near) & (x[2, i] > far)
    return there


@cached_njit(error_model="numpy", nogil=True)
def find(edge, seed, who, at, before, watched, beads, lost):  # type: ignore[no-untyped-def]
    """Fill `lost` (n,) with the fraction of a step after which each bead is lost; 2 if not lost.

    `edge` is a `Boundary`. `seed`, the indices `who` of the trajectories and the index `at` of the
    step select the random numbers. The positions `before` (3, w) the step, m, are valid if
    `watched`; otherwise only the end of the step is tested. On entry `lost` is negative for beads
    that were lost earlier. It becomes NaN for a position that is not finite.
    """
    x, n, many = beads.x, lost.size, 0
    few, index = np.empty(n, np.int64), np.empty(n, np.int64)
    begun, ended, wide = np.empty(n), np.empty(n), np.empty(n)
    resisted = Mobility(np.empty((0, 5)), np.empty((0, 5, 3)))
    if watched and not edge.uniform:
        resisted = Mobility(np.zeros((n, 5)), np.zeros((n, 5, 3)))
        places = np.empty((n, 3))
        for i in range(n):
            for k in range(3):
                places[i, k] = before[k, i]
        pose = Pose(np.zeros(n), places, beads.e, np.zeros((0, 3)))
        call(edge.drag.kernel, (pose, edge.drag.data, resisted))
    for i in range(n):
        if lost[i] < 0:
            continue
        away = math.sqrt(x[0, i] * x[0, i] + x[1, i] * x[1, i] + x[2, i] * x[2, i])
        if not math.isfinite(away):
            lost[i] = math.nan
            continue
        to_sphere, to_lens = edge.loss - away, x[2, i] - edge.lens
        lost[i] = 1.0 if to_sphere <= 0 or to_lens <= 0 else 2.0
        if not watched:
            continue
        away = math.sqrt(
            before[0, i] * before[0, i] + before[1, i] * before[1, i] + before[2, i] * before[2, i]
        )
        from_sphere, from_lens = edge.loss - away, before[2, i] - edge.lens
        if not (from_sphere < edge.margin or from_lens < edge.margin):
            continue
        across = from_lens * to_lens < from_sphere * to_sphere
        a, b = (from_lens, to_lens) if across else (from_sphere, to_sphere)
        mobility = edge.mobility
        if not edge.uniform:
            up = 1.0 if across else (before[2, i] / away) ** 2
            mobility = up * resisted.value[i, 1] + (1 - up) * resisted.value[i, 0]
        variance = edge.spread * mobility
        if a > 0 and 2 * a * b < _NONE * variance:
            few[many], index[many] = who[i], i
            begun[many], ended[many], wide[many] = a, b, variance
            many += 1
    if many > 0:
        drawn = np.empty(3 * many).reshape((3, many))
        normals(seed, few[:many], at, np.int64(CROSSING), drawn)
        for j in range(many):
            a, b, variance = begun[j], ended[j], wide[j]
            # a uniform number, from a normal one: below exp(-2 a b/variance) the bead crossed
            chance = 0.5 * math.erfc(drawn[0, j] / math.sqrt(2.0))
            if b <= 0 or chance * math.exp(2 * a * b / variance) < 1:
                lost[index[j]] = _when(a, abs(b), variance, drawn[1, j], drawn[2, j])


@named_njit(inner=True, error_model="numpy")
def _when(a, b, variance, normal, other):  # type: ignore[no-untyped-def]
    """Return the fraction of the step after which a boundary is crossed, from two normal numbers.

    a, b: distances inside the boundary at the beginning and, in modulus, at the end of the step, m.
    variance: of the displacement across it in a step, m^2. The fraction is s/(1 + s), with s from
    an inverse Gaussian distribution: J. R. Michael, W. R. Schucany, R. W. Haas, Am. Stat. 30, 88
    (1976).
    """
    squared = normal * normal
    if not a * a > 0 or not variance > 0:
        return a / (a + b) if a + b > 0 else 0.0
    shape = a * a / variance
    if b < 1e-9 * a:
        s = shape / squared
        return s / (1 + s) if squared > 0 else 1.0
    mean = a / b
    half = mean * squared / (2 * shape)
    s = mean / (1 + half + math.sqrt(half * (2 + half)))
    if 0.5 * math.erfc(other / math.sqrt(2.0)) * (mean + s) > mean:
        s = mean * mean / s
    return s / (1 + s)
