"""Drag of a sphere near a plane, or between two, from the exact mobilities.

They are the mobilities in Stokes flow (H. Brenner, Chem. Eng. Sci. 16:242 (1961); G. B. Jeffery
1915; M. E. O'Neill 1964; W. R. Dean and M. E. O'Neill 1963), derived in `derivation.wall`. Far away
they follow Stokes's law. Near contact the mobility towards the wall is proportional to the gap.

With a second plane, the additional resistances due to both planes are added (C. W. Oseen,
Hydrodynamik (1927)). In a cell of thickness L this overestimates the friction. To leading order, in
the middle of the cell, the error is 1.6 r/L of Stokes's friction for motion across the cell and
0.25 r/L along it. Next to a plane, which screens the other one, the error along the cell is 0.6
r/L. In the middle the exact friction is 1 + 2.903 r/L and 1 + 2.008 r/L, against 1 + 4.5 r/L and 1
+ 2.25 r/L (L. Lobry, N. Ostrowsky, Phys. Rev. B 53:12050 (1996)).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tweezer.compiled import cache_functions, cached_njit, named_njit
from tweezer.fluid.drag import Drag, Kernel, Stokes, Walls
from tweezer.forces.data import Data, matrix, number, packed
from tweezer.forces.wall import BORN
from tweezer.generated import wall

cache_functions(wall)

#: Gap below which the mobilities are constant, m: a bead that is pushed back must still move
_NEAREST = 0.1 * BORN


@dataclass(frozen=True)
class BesideWall(Drag):
    """Drag of a sphere beside one plane across z, or between two."""

    stokes: Stokes
    """drag in an unbounded fluid"""
    radius: float
    """radius r of the sphere, m"""
    planes: tuple[tuple[float, float], ...]
    """position, m, and normal, 1 or -1 towards the bead, of one plane or two"""

    @property
    def walls(self) -> Walls:
        """Walls of this drag, as planes, for the schemes of thermal motion."""
        return self

    def compiled(self) -> tuple[Kernel, Data]:
        """Return the compiled kernel and its data: drag far away, radius and planes."""
        free = self.stokes
        return _beside_walls, packed(free.translation, free.rotation, self.radius, self.planes)


@cached_njit(error_model="numpy", nogil=True)
def _beside_walls(pose, data, mobility):  # type: ignore[no-untyped-def]
    """Fill the mobilities and, if requested, their gradients, as the kernel of `BesideWall`.

    The data contain beta_v (kg/s) and beta_w (N m s) far from everything, the radius (m), and the
    planes (1 or 2, 2) with position (m) and normal. A bead nearer than `_NEAREST` to a plane has
    the mobilities at this gap. A bead inside a plane has those of its mirror image. A bead that is
    pushed back must be able to move.
    """
    translation, rotation = 1.0 / number(data, 0), 1.0 / number(data, 1)
    radius, planes = number(data, 2), matrix(data, 3)
    position, normal = planes[0, 0], planes[0, 1]
    room = abs(planes[1, 0] - position) / radius - 2.0 if len(planes) > 1 else np.inf
    nearest = _NEAREST / radius
    for i in range(len(pose.position)):
        g = (normal * (pose.position[i, 2] - position) - radius) / radius
        by = normal / radius
        if g < nearest:
            by = by if g > 0.0 else -by
            g = min(max(nearest, -g), room - nearest)
        elif g > room - nearest:
            by = by if g < room else -by
            g = max(min(room - nearest, 2.0 * room - g), nearest)
        found = between_walls(g, room)
        across, along, spin, turn, roll = found[:5]
        scales = translation, translation, rotation, rotation, normal * translation / radius
        for k, value in enumerate((along, across, turn, spin, roll)):
            mobility.value[i, k] = scales[k] * value
        if len(mobility.gradient) > 0:
            across, along, spin, turn, roll = found[5:]
            for k, slope in enumerate((along, across, turn, spin, roll)):
                mobility.gradient[i, k, 0] = mobility.gradient[i, k, 1] = 0.0
                mobility.gradient[i, k, 2] = scales[k] * by * slope


@named_njit(inner=True, error_model="numpy")
def between_walls(g, room):  # type: ignore[no-untyped-def]
    """Return five mobilities over Stokes's beside one plane or between two, and their derivatives.

    `g` is the gap to one plane, and `room` the sum of the gaps to both, infinite for one plane;
    both are in radii. The five mobilities apply to motion perpendicular and parallel to the planes,
    spin, turn and rolling (times a radius). They are followed by their derivatives with respect to
    g.
    """
    across, along, spin, turn, roll, across_by, along_by, spin_by, turn_by, roll_by = (
        wall.mobilities(g)
    )
    rolling, rolling_by = roll * along, roll_by * along + roll * along_by
    if room < np.inf:
        other = wall.mobilities(room - g)
        across, across_by = _together(across, across_by, other[0], other[5])
        along, along_by = _together(along, along_by, other[1], other[6])
        spin, spin_by = _together(spin, spin_by, other[2], other[7])
        turn, turn_by = _together(turn, turn_by, other[3], other[8])
        rolling -= other[4] * other[1]
        rolling_by += other[9] * other[1] + other[4] * other[6]
    return across, along, spin, turn, rolling, across_by, along_by, spin_by, turn_by, rolling_by


@named_njit(inner=True, error_model="numpy")
def _together(one, by_gap, other, by_other):  # type: ignore[no-untyped-def]
    """Return a mobility between two planes and its derivative by the gap to the first plane.

    `one` and `other` are the mobilities beside each plane alone, over Stokes's. `by_gap` and
    `by_other` are their derivatives, each by the gap to its own plane. The resistances, 1/mobility,
    less Stokes's are added.
    """
    both = one + other - one * other
    own, others = other / both, one / both
    return one * own, own * own * by_gap - others * others * by_other
