"""Drag of a sphere beside a plane, or between two: the exact mobilities by the gap.

They are those of Stokes flow (H. Brenner, Chem. Eng. Sci. 16:242 (1961); G. B. Jeffery 1915;
M. E. O'Neill 1964; W. R. Dean and M. E. O'Neill 1963), as `derivation.wall` has them. Far away they
are Stokes's; at contact the one towards the wall is in proportion to the gap.

With a second plane the resistances of both, less Stokes's, add up (C. W. Oseen, Hydrodynamik
(1927)). In the middle of a cell of thickness L that makes the mobility too small by about
1.6 r/L across it and 0.25 r/L along it, which is the leading term of what is left out
(H. Faxen 1922; P. Ganatos, S. Weinbaum, R. Pfeffer, J. Fluid Mech. 99:739 (1980)).
"""

from __future__ import annotations

from dataclasses import dataclass

from tweezer.compiled import cached_njit, named_njit
from tweezer.fluid.drag import Drag, Kernel, Stokes
from tweezer.forces.data import Data, matrix, number, packed
from tweezer.forces.wall import BORN
from tweezer.generated import wall

#: Gap below which the mobilities stay as they are, m: what is pushed back must still move
_NEAREST = 0.1 * BORN


@dataclass(frozen=True)
class BesideWall(Drag):
    """Drag of a sphere beside planes across z."""

    stokes: Stokes
    """far from everything"""
    radius: float
    """r, m"""
    planes: tuple[tuple[float, float], ...]
    """position, m, and normal, 1 or -1 towards the bead, of one plane or two"""

    def compiled(self) -> tuple[Kernel, Data]:
        """See `Drag.compiled`."""
        free = self.stokes
        return _beside_walls, packed(free.translation, free.rotation, self.radius, self.planes)


@cached_njit(error_model="numpy", nogil=True)
def _beside_walls(pose, data, mobility):  # type: ignore[no-untyped-def]
    translation, rotation = 1.0 / number(data, 0), 1.0 / number(data, 1)
    radius, planes = number(data, 2), matrix(data, 3)
    gradient = len(mobility.gradient) > 0
    for i in range(len(pose.position)):
        across, along, turn, spin, roll = _beside(pose.position[i, 2], radius, planes[0])
        if len(planes) > 1:
            other = _beside(pose.position[i, 2], radius, planes[1])
            across, along = _together(across, other[0]), _together(along, other[1])
            turn, spin = _together(turn, other[2]), _together(spin, other[3])
            roll = roll[0] + other[4][0], roll[1] + other[4][1]
        entries = along, across, turn, spin, roll
        scales = translation, translation, rotation, rotation, translation
        for k in range(5):
            mobility.value[i, k] = scales[k] * entries[k][0]
            if gradient:
                mobility.gradient[i, k, 0] = mobility.gradient[i, k, 1] = 0.0
                mobility.gradient[i, k, 2] = scales[k] * entries[k][1]


@named_njit(inner=True, error_model="numpy")
def _beside(z, radius, plane):  # type: ignore[no-untyped-def]
    """Mobilities beside one plane, and their derivatives over z: across, along, turn, spin, roll.

    Over Stokes's; that of rolling over Stokes's of translation, 1/m. Behind the plane, where no
    bead is but a step may try to go, they are those before it.
    """
    gap = plane[1] * (z - plane[0]) - radius
    normal = plane[1] if gap > 0.0 else -plane[1]
    found = wall.mobilities(max(abs(gap), _NEAREST) / radius)
    across, along, spin, turn, roll, across_by, along_by, spin_by, turn_by, roll_by = found
    by, rolls = normal / radius, plane[1] / radius
    rolling = rolls * roll * along, rolls * by * (roll_by * along + roll * along_by)
    return (across, by * across_by), (along, by * along_by), (turn, by * turn_by), (
        spin, by * spin_by,
    ), rolling  # fmt: skip


@named_njit(inner=True, error_model="numpy")
def _together(one, other):  # type: ignore[no-untyped-def]
    """Resistances added up, over Stokes's, of two mobilities and their derivatives."""
    both = one[0] + other[0] - one[0] * other[0]
    left, right = other[0] / both, one[0] / both
    return one[0] * left, left * left * one[1] + right * right * other[1]
