"""Two or more beads in linear traps, without light: a system whose distribution is known."""

import math

import numpy as np

from tweezer.beads.forces import SPRING, Acting
from tweezer.beads.plane import plane_of
from tweezer.beads.scalars import Scalars
from tweezer.compiled import address
from tweezer.forces.data import Part, packed
from tweezer.forces.force import KERNEL, no_force

KT = 1.380649e-23 * 295.0
#: 1/(6 pi mu) of water, m s/kg
UNIT = 1 / (6 * math.pi * 1e-3)


def dark(radii, bonds, points, numbers):
    """Return forces of springs alone: (first, second) beads, points (m), and their parameters."""
    none = Part(address(no_force, KERNEL), packed())
    count = len(bonds)
    return Acting(
        packed(*(none for _ in radii)), np.zeros((len(radii), 3)), np.array(radii),
        np.array(bonds, np.int64).reshape(count, 2), np.array(points, float).reshape(count, 3),
        np.full(count, SPRING), np.array(numbers, float).reshape(count, 4),
        np.zeros((0, 5)),
    )  # fmt: skip


def in_traps(radii, centres, stiffness):
    """Return forces of linear traps at centres (beads, 3), m, of stiffnesses (beads,), N/m."""
    bonds = [(k, -1) for k in range(len(radii))]
    numbers = [(k, -a, 0, 0) for k, a in zip(stiffness, radii, strict=True)]
    return dark(radii, bonds, centres, numbers)


def pair(radii):
    """Return the mobilities of two beads, and their plane."""
    scalars = Scalars(radii, UNIT)
    return scalars, plane_of(scalars, KT)
