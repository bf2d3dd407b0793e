"""Preparation of thermal motion beside a wall: stiffness and step towards it, and release."""

from __future__ import annotations

import dataclasses
import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr, ndtri

from tweezer.dynamics.brownian.propagator import stationary_root
from tweezer.dynamics.layout import TRANSLATION
from tweezer.dynamics.needs import rates_of
from tweezer.dynamics.problem import Problem
from tweezer.fluid import Walls
from tweezer.forces.wall import Dlvo
from tweezer.values.arrays import Array
from tweezer.values.constants import Boltzmann

#: Number of gaps on the whole line from contact, and number of more gaps next to the trap
_POINTS = 300
#: How far the line goes beyond the trap, in radii
_AROUND = 1.5
#: How far the gaps next to the trap are from it, in radii
_ABOUT = 0.5
#: Height of a barrier that is not crossed, over kT
_BARRIER = 20.0
#: Fraction of the time for which the drift may change faster than `Towards.fastest`
_RARELY = 0.01


class Towards(NamedTuple):
    """Motion towards the wall, in the plane whose radius r gives the gap (`brownian.plane`)."""

    spring: float
    """mean rate at which the drift decreases the distance between two beads, 1/s; otherwise 0
    """
    fastest: float
    """largest rate of change of the drift where the bead is for 99 % of the time, 1/s"""


def without_walls(problem: Problem) -> Problem:
    """Return the problem without the forces of its walls."""
    return dataclasses.replace(problem, walls=())


def towards(problem: Problem, walls: Walls) -> Towards:
    """Return the rates of the motion towards the wall, at the probable positions of the bead.

    The probable positions follow from Boltzmann's distribution on a line perpendicular to the wall,
    through the trap or the release position, up to barriers that are not crossed.
    """
    scene = problem.scene
    trap = problem.equilibrium
    middle = np.array(scene.start_position if trap is None else trap.position)
    radius, kT = walls.radius, Boltzmann * scene.noise_temperature
    position, normal = walls.planes[0]
    at = normal * (middle[2] - position) / radius - 1
    most = at + _AROUND if trap is not None else 2 * at + _AROUND
    if len(walls.planes) > 1:
        most = min(most, abs(walls.planes[1][0] - position) / radius - 2)
    about = np.linspace(max(at - _ABOUT, 0.0), min(at + _ABOUT, most), _POINTS)
    root = np.unique(np.sqrt(np.concatenate([np.linspace(0, most**0.5, _POINTS) ** 2, about])))
    root = root[(root > 0) & (root**2 < most)]
    gap = root**2
    places = np.tile(middle, (len(gap), 1))
    places[:, 2] = position + normal * radius * (1 + gap)
    found = problem.drag.mobilities(places, gradient=True)
    mu = found.value[:, 1] * walls.stokes.translation
    slope = found.gradient[:, 1, 2] * walls.stokes.translation * normal * radius
    scale = np.sqrt(2 * mu)
    by_root = 2 * root / scale
    r = by_root[0] * root[0] + np.concatenate(
        [[0.0], np.cumsum(0.5 * (by_root[1:] + by_root[:-1]) * np.diff(root))]
    )
    lit = np.abs(places[:, 2]) <= max(problem.light.search.reach, abs(middle[2]))
    gap, r, scale, slope = gap[lit], r[lit], scale[lit], slope[lit]
    force = normal * problem.net_force(places[lit])[:, 2] * radius / kT
    energy = -np.concatenate([[0.0], np.cumsum(0.5 * (force[1:] + force[:-1]) * np.diff(gap))])
    here = int(np.argmin(np.abs(gap - at)))
    reached = _this_side(energy, here)
    if trap is not None:
        energy[here:] = np.maximum.accumulate(energy[here:])
        energy[: here + 1] = np.maximum.accumulate(energy[here::-1])[::-1]
    density = np.exp(energy[reached].min() - np.where(reached, energy, np.inf)) * np.gradient(gap)
    density /= density.sum()
    rate = kT / walls.stokes.translation / radius**2
    drift = 0.5 * (force * scale + slope / scale - 1 / r)
    change = -rate * np.gradient(drift, r)
    order = np.argsort(np.abs(change))
    most_of_it = int(np.searchsorted(np.cumsum(density[order]), 1 - _RARELY))
    fastest = float(np.abs(change)[order[min(most_of_it, len(order) - 1)]])
    if trap is None:
        fastest = max(fastest, abs(float(change[here])), rate / (1 + at) ** 2)
    return Towards(max(float(density @ change), 0.0), fastest)


def _this_side(energy: Array, here: int) -> NDArray[np.bool_]:
    """Return which positions a bead can reach from the position `here` without a high barrier,
    (n,).

    energy: (n,) potential along the line, over kT. here: index in it.
    """
    found = np.full(len(energy), False)
    for away in (slice(here, None), slice(here, None, -1)):
        on = energy[away]
        passed = on - np.minimum.accumulate(on) < _BARRIER
        found[away] = np.logical_and.accumulate(passed)
    return found


def rate_of_sticking(problem: Problem) -> float:
    """Return the rate at which van der Waals attraction pulls a bead in contact to the wall, 1/s.

    It is D/r^2 times F r/(2 kT), in the plane where the gap is a radius. 0 without this attraction.
    """
    walls = problem.drag.walls
    if walls is None:
        return 0.0
    pulls = [each.attraction for each in problem.walls if isinstance(each, Dlvo)]
    return max(pulls, default=0.0) / (2 * walls.radius * walls.stokes.translation)


def held(problem: Problem, walls: Walls, kT: float, normal: Array) -> Array:
    """Return initial displacements from the trap, (n, 3) m, of beads trapped beside a wall.

    They follow the Gaussian distribution of the trap's spring, cut off at contact.

    Parameters
    ----------
    problem : Problem
        Bead, medium and forces.
    walls : Walls
        The walls.
    kT : float
        Thermal energy, J.
    normal : ndarray, shape (n, 3)
        Standard normal numbers.
    """
    trap = problem.equilibrium
    assert trap is not None
    mobility = problem.mobilities(np.array([trap.position]))[0, TRANSLATION]
    root = stationary_root(np.zeros(3), rates_of(trap, mobility), kT * mobility)
    covariance = root @ root.T
    spread = math.sqrt(covariance[2, 2])
    ends = np.array([-math.inf, math.inf])
    for position, direction in walls.planes:
        room = direction * (trap.position[2] - position) - walls.radius
        ends[int(direction < 0)] = -direction * room / spread
    z = cut(normal[:, 2], *ends.tolist())
    with_z = covariance[:2, 2] / spread
    beside = np.linalg.cholesky(covariance[:2, :2] - np.outer(with_z, with_z))
    x, y = normal[:, 0], normal[:, 1]
    return np.column_stack([
        with_z[0] * z + beside[0, 0] * x,
        with_z[1] * z + beside[1, 0] * x + beside[1, 1] * y,
        spread * z,
    ])  # fmt: skip


def cut(normal: Array, low: float, high: float) -> Array:
    """Return normal numbers (n,) restricted to an interval, from unrestricted ones.

    Each result increases with its input. low, high: ends of the interval, low < 0 < high; may be
    infinite.
    """
    below, above = ndtr(low), ndtr(-high)
    left, right = (side + ndtr(sign * normal) * (1 - below - above) for side, sign in (
        (below, 1.0), (above, -1.0),
    ))  # fmt: skip
    return np.where(normal < 0, ndtri(left), -ndtri(right))
