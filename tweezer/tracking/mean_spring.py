"""Harmonic trap that best approximates a real trap in thermal motion."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tweezer.dynamics.layout import TRANSLATION
from tweezer.dynamics.problem import Problem
from tweezer.forces.equilibria import Equilibrium
from tweezer.values.arrays import Array
from tweezer.values.constants import Boltzmann

#: Relative change of the stiffness at which iterations end, and largest number of iterations
_SETTLED, _MOST_ROUNDS = 1e-7, 50


class MeanSpring(NamedTuple):
    """Mean position, stiffness and drag of a bead in a trap."""

    position: Array
    """(3,) mean position of the bead, m"""
    stiffness: Array
    """(3,) mean stiffness along the axes, N/m"""
    drag: Array
    """(3,) inverse of the mean mobility along the axes, kg/s"""


def _cubature() -> tuple[Array, Array]:
    """Return points (19, 3) and weights (19,) for means over three independent standard normals.

    The mean of a function is the weighted sum of its values at the points. It is exact for
    polynomials up to degree 5 (J. McNamee and F. Stenger, Numer. Math. 10, 327 (1967)).
    """
    unit = np.eye(3)
    pairs = [unit[i] + sign * unit[j] for i in range(3) for j in range(i) for sign in (1, -1)]
    ends, edges = np.sqrt(5.0) * unit, np.sqrt(2.5) * np.array(pairs)
    points = np.concatenate([np.zeros((1, 3)), ends, -ends, edges, -edges])
    return points, np.repeat([2 / 5, 1 / 50, 1 / 25], [1, 6, 12])


_POINTS, _WEIGHTS = _cubature()


def mean_spring(problem: Problem, place: Equilibrium) -> MeanSpring | None:
    """Return the mean spring of a bead about an equilibrium, or None without a stable mean spring.

    The stiffness is the mean of -dF/dx over a Gaussian distribution (statistical linearisation).
    The mean force of this distribution vanishes, and its covariance is k_B T divided by the
    stiffness (J. B. Roberts and P. D. Spanos, Random Vibration and Statistical Linearization,
    1990). In a weakly anharmonic trap the mean spring has the same spectrum as the bead. The error
    is of second order in the relative difference between the mean stiffness and the stiffness at
    the equilibrium. The drag follows from the mean mobility.
    """
    kT = Boltzmann * problem.scene.noise_temperature
    position, stiffness = np.array(place.position), np.array(place.stiffness)
    stiffness = (stiffness + stiffness.T) / 2
    for _ in range(_MOST_ROUNDS):
        if not (np.isfinite(stiffness).all() and np.linalg.eigvalsh(stiffness).min() > 0):
            return None
        spread = np.linalg.cholesky(kT * np.linalg.inv(stiffness))
        points = position + _POINTS @ spread.T
        if np.linalg.norm(points, axis=1).max() > problem.light.search.reach:
            return None
        force = problem.net_force_apart(points)
        # the mean of dF/dx is the mean product of force and deviation, divided by the covariance
        found = -np.linalg.solve(spread.T, (_POINTS * _WEIGHTS[:, None]).T @ force)
        found = (found + found.T) / 2
        position = position + np.linalg.solve(stiffness, _WEIGHTS @ force)
        change = np.abs(found - stiffness).max() / np.abs(stiffness).max()
        stiffness = found
        if change < _SETTLED:
            mobility = _WEIGHTS @ problem.mobilities(points)[:, TRANSLATION]
            return MeanSpring(position, np.diag(stiffness).copy(), 1 / mobility)
    return None
