"""Torque of buoyancy on a body whose centre of volume is not its centre of mass."""

from __future__ import annotations

from dataclasses import dataclass

from tweezer.compiled import cached_njit
from tweezer.forces.data import Data, number, packed
from tweezer.forces.force import Force, Kernel


@dataclass(frozen=True)
class BuoyancyTorque(Force):
    """Torque about the centre of mass of a lift along z that acts at the centre of volume.

    The lift itself is part of the weight in the fluid (2.12).
    """

    lift: float
    """weight of the displaced fluid, N"""
    centre_of_volume: tuple[float, float, float]
    """centre of volume c from the centre of mass in the body's frame, m"""

    @property
    def oriented(self) -> bool:
        """Whether the force depends on the orientation: always."""
        return True

    def compiled(self, *, gradient: bool) -> tuple[Kernel, Data]:  # noqa: ARG002
        """Return the kernel and its data; the torque does not depend on the position."""
        return _add_buoyancy, packed(self.lift, *self.centre_of_volume)


@cached_njit(error_model="numpy", nogil=True)
def _add_buoyancy(pose, data, wrench):  # type: ignore[no-untyped-def]
    """Kernel of `BuoyancyTorque`: add R c x (0, 0, lift), with R by (A.2)."""
    lift, c1, c2, c3 = number(data, 0), number(data, 1), number(data, 2), number(data, 3)
    for i in range(len(pose.orientation)):
        e0, e1, e2, e3 = pose.orientation[i]
        x = (
            (e0 * e0 + e1 * e1 - e2 * e2 - e3 * e3) * c1
            + 2.0 * (e1 * e2 - e0 * e3) * c2
            + 2.0 * (e1 * e3 + e0 * e2) * c3
        )
        y = (
            2.0 * (e1 * e2 + e0 * e3) * c1
            + (e0 * e0 - e1 * e1 + e2 * e2 - e3 * e3) * c2
            + 2.0 * (e2 * e3 - e0 * e1) * c3
        )
        wrench.moment[i, 0] += lift * y
        wrench.moment[i, 1] -= lift * x
