"""Feedback: a controller measures a bead at even times (ticks), and changes what acts on it.

At a tick the measured position of an axis is y = x - x_0 + sqrt(S f) n. Here x_0 is the target, S
the two-sided spectral density of the detector's noise, f the rate of the ticks, and n a standard
normal number. A linear controller has a state c for each axis:

    c -> F c + G y,    u = H c + J y,

with the c after the tick in u. The output u waits d ticks in a queue and then acts until the next
one. Before the first output, 0 acts. A parametric controller adds g y (y - y_before) f to u, which
changes the power by the sum of u over the axes.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numba import types

from tweezer.compiled import cached_njit, named_njit
from tweezer.dynamics.brownian.batch import BEADS, PLAN
from tweezer.dynamics.brownian.noise import FEEDBACK, normals
from tweezer.values.arrays import Array

if TYPE_CHECKING:
    from tweezer.scene.sections import Feedback

#: First entries of the data: steps per tick, ticks of the delay, size of c, standard deviation
#: sqrt(S f), target x_0, gain g f, and 1 for each measured axis. F, G, H and J follow
EVERY, LATE, STATES, SPREAD, TARGET, GAIN, MEASURED = range(7)
#: First entry of the matrices
_MATRICES = MEASURED + 3
TICKS = types.void(PLAN, types.int64[::1], types.int64, BEADS)
"""signature of a tick"""


class Matrices(NamedTuple):
    """A linear controller of one axis: c -> F c + G y, u = H c + J y with the new c."""

    F: Array
    """(n, n)"""
    G: Array
    """(n,)"""
    H: Array
    """(n,)"""
    J: float


def matrices_of(feedback: Feedback, mass: float) -> Matrices:
    """Return the matrices of a controller.

    Those of a parametric one only store the measurement, which its tick multiplies.

    Parameters
    ----------
    feedback : Feedback
        Section of the scene.
    mass : float
        Effective mass m of the bead, kg.
    """
    f = feedback.rate
    match feedback.kind:
        case "cold":  # u = -m gain (y - y_before) f, with c = (y, y_before)
            size = mass * (feedback.gain or 0.0) * f
            return Matrices(
                np.array([[0.0, 0.0], [1.0, 0.0]]), np.array([1.0, 0.0]), np.array([-size, size]),
                0.0,
            )  # fmt: skip
        case "parametric":  # c = y
            return Matrices(np.zeros((1, 1)), np.ones(1), np.zeros(1), 0.0)
        case "clamp":  # X -> X + gain (y - X)/f
            part = -math.expm1(-(feedback.gain or 0.0) / f)
            return Matrices(np.array([[1 - part]]), np.array([part]), np.array([1.0]), 0.0)
        case "pid":  # c = (y, y_before, sum of y/f), without the sum if nothing reads it
            P, I, D = feedback.gains or (0.0, 0.0, 0.0)
            F = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
            n = 3 if I else 2
            G, H = np.array([1.0, 0.0, 1 / f]), np.array([-P - D * f, D * f, -I])
            return Matrices(F[:n, :n], G[:n], H[:n], 0.0)
    n = len(feedback.G or ())
    return Matrices(
        np.array(feedback.F, float).reshape(n, n), np.array(feedback.G, float),
        np.array(feedback.H, float), float(feedback.J or 0.0),
    )  # fmt: skip


def data_of(feedback: Feedback, step: float, mass: float) -> Array:
    """Return the data of a controller as a tick reads them, for steps of a length, s.

    `mass` is the effective mass of the bead, kg.
    """
    measured = [float(axis in feedback.measures) for axis in "xyz"]
    spread = math.sqrt(feedback.noise * feedback.rate)
    head = [round(1 / (feedback.rate * step)), feedback.ticks_late]
    F, G, H, J = matrices_of(feedback, mass)
    gain = (feedback.gain or 0.0) * feedback.rate if feedback.kind == "parametric" else 0.0
    own = [len(G), spread, feedback.target, gain, *measured]
    return np.concatenate([head, own, F.ravel(), G, H, [J]])


def width_of(data: Array) -> int:
    """Return how many numbers a controller keeps for a bead, besides its output."""
    return 3 * int(data[STATES] + data[LATE]) if len(data) else 0


@named_njit(inner=True, error_model="numpy")
def _put(data, row, drive, k, u):  # type: ignore[no-untyped-def]
    """Put the output u of axis k behind the queue in `row`, and take its first one as `drive`."""
    late, first = int(data[LATE]), 3 * int(data[STATES]) + k * int(data[LATE])
    if late == 0:
        drive[k] = u
        return
    drive[k] = row[first]
    for j in range(first, first + late - 1):
        row[j] = row[j + 1]
    row[first + late - 1] = u


@cached_njit(error_model="numpy", nogil=True)
def tick(plan, who, at, beads):  # type: ignore[no-untyped-def]
    """Measure, and act, after the step with the number `at`."""
    data, drawn = plan.feedback, np.zeros((3, who.size))
    states = int(data[STATES])
    if data[SPREAD] > 0.0:
        normals(plan.seed, who, at, FEEDBACK, drawn)
    F, G = _MATRICES, _MATRICES + states * states
    H, J = G + states, G + 2 * states
    c = np.empty(states)
    for i in range(len(beads.control)):
        row = beads.control[i]
        for k in range(3):
            if data[MEASURED + k] == 0.0:
                continue
            y = beads.x[k, i] - data[TARGET] + data[SPREAD] * drawn[k, i]
            u = data[J] * y
            if data[GAIN] != 0.0:  # c_0 is the measurement before
                u += data[GAIN] * y * (y - row[k * states])
            for a in range(states):
                c[a] = data[G + a] * y
                for b in range(states):
                    c[a] += data[F + a * states + b] * row[k * states + b]
            for a in range(states):
                row[k * states + a] = c[a]
                u += data[H + a] * c[a]
            _put(data, row, beads.pose.drive[i], k, u)
