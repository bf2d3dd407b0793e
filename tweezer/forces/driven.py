"""Forces that a controller changes: a uniform force, and light of changed power or position.

The output of the controller is `Pose.drive`, three numbers for each bead, by axis. Without a
controller the array is empty, as for an output of 0.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tweezer.compiled import cached_njit
from tweezer.forces.data import Data, number, packed, part
from tweezer.forces.force import Force, Kernel, Pose, Wrench, add, bound
from tweezer.values.arrays import Array


class DrivenForce(Force):
    """A uniform force, N, that a controller sets."""

    def compiled(self, *, gradient: bool) -> tuple[Kernel, Data]:  # noqa: ARG002
        """Return the kernel of this force and its data; see `Force.compiled`."""
        return _push, packed()


@dataclass(frozen=True)
class DrivenLight(Force):
    """Force of light whose power or position a controller changes."""

    force: Force
    """the force of the light with an output of 0"""
    power: bool
    """whether the output changes the power, by a part; otherwise the position, m"""

    @property
    def parts(self) -> tuple[Force, ...]:
        """Forces of which this force is a combination; see `Force.parts`."""
        return (self.force,)

    @property
    def oriented(self) -> bool:
        """Whether the force depends on the orientation or turns the bead; see `Force.oriented`."""
        return self.force.oriented

    @property
    def steady(self) -> bool:
        """Whether the force is constant in time; see `Force.steady`."""
        return self.force.steady

    def kinks(self, end: float) -> Array:
        """Return the times in (0, end) at which the force jumps or bends, s; see `Force.kinks`."""
        return self.force.kinks(end)

    def shortest_time(self, end: float) -> float:
        """Return the shortest time scale of changes, s; see `Force.shortest_time`."""
        return self.force.shortest_time(end)

    def regions(self) -> tuple[Kernel, Data] | None:
        """Return a kernel that numbers the regions in which the force is smooth, and its data."""
        return self.force.regions()

    def error_of(self, positions: Array, field: Wrench, time: float | Array = 0.0) -> Array:
        """Return the error of a force that has been computed; see `Force.error_of`."""
        return self.force.error_of(positions, field, time)

    def compiled(self, *, gradient: bool) -> tuple[Kernel, Data]:
        """Return the kernel of this force and its data; see `Force.compiled`."""
        return _add_driven, packed(bound(self.force, gradient=gradient), float(self.power))


@cached_njit(error_model="numpy", nogil=True)
def _push(pose, data, wrench):  # type: ignore[no-untyped-def]  # noqa: ARG001
    """Add the output of a controller as a force, N."""
    for i in range(len(pose.drive)):
        for k in range(3):
            wrench.force[i, k] += pose.drive[i, k]


@cached_njit(error_model="numpy", nogil=True)
def _add_driven(pose, data, wrench):  # type: ignore[no-untyped-def]
    """Add the force of light that a controller changes.

    `data` contains the force with an output of 0 (`Part`), and 1 if the output changes the power:
    the sum of its components is the relative change. Otherwise it displaces the light.
    """
    force, power = part(data, 0), number(data, 1) > 0.0
    if len(pose.drive) == 0:
        add(force, pose, wrench)
        return
    n, gradients = len(pose.time), len(wrench.force_gradient)
    here = Pose(pose.time, pose.position.copy(), pose.orientation, pose.drive)
    found = Wrench(
        np.zeros((n, 3)), np.zeros((n, 3)), np.zeros((gradients, 3, 3)),
        np.zeros((gradients, 3, 3)), np.zeros(n),
    )  # fmt: skip
    if not power:
        for i in range(n):
            for k in range(3):
                here.position[i, k] -= pose.drive[i, k]
    add(force, here, found)
    for i in range(n):
        strength = 1.0
        if power:
            strength += pose.drive[i, 0] + pose.drive[i, 1] + pose.drive[i, 2]
            strength = max(strength, 0.0)
        wrench.error[i] += strength * found.error[i]
        for k in range(3):
            wrench.force[i, k] += strength * found.force[i, k]
            wrench.moment[i, k] += strength * found.moment[i, k]
            for l in range(3):
                if gradients > 0:
                    wrench.force_gradient[i, k, l] += strength * found.force_gradient[i, k, l]
                    wrench.moment_gradient[i, k, l] += strength * found.moment_gradient[i, k, l]
