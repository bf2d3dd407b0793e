"""Equivalent force of a drag that depends on the position, for methods with constant mobilities."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tweezer.compiled import cached_njit, call, named_njit
from tweezer.fluid.drag import Drag, Kernel, Mobility
from tweezer.forces.data import Data, packed, part, vector
from tweezer.forces.force import Force, Wrench, add, bound
from tweezer.values.arrays import Array


@dataclass(frozen=True, eq=False)
class Resisted(Force):
    """Equivalent force and torque, for methods that assume constant mobilities.

    The force F(x), the weight and the torque give a bead a velocity and an angular velocity, which
    follow from the mobilities at its position (`derivation.drag`). The equivalent force is this
    velocity divided by the constant mobility along each axis, and the equivalent torque is the
    angular velocity divided by the constant mobility about each axis. With constant mobilities, the
    equivalent force and torque therefore cause the correct velocities.
    """

    force: Force
    """F, the force on the bead without drag and weight"""
    drag: Drag
    """b, the drag"""
    weight: Array
    """W, (3,) N, the weight less buoyancy"""
    reference: Array
    """(6,) s/kg and 1/(N m s), the constant mobilities along and about the axes"""

    @property
    def parts(self) -> tuple[Force, ...]:
        """Forces that this force contains: F."""
        return (self.force,)

    def compiled(self, *, gradient: bool) -> tuple[Kernel, Data]:
        """Return the compiled kernel and its data: force, drag, weight and constant mobilities."""
        return _add_resisted, packed(
            bound(self.force, gradient=gradient), self.drag.part, self.weight, self.reference
        )


@cached_njit(error_model="numpy", nogil=True)
def _add_resisted(pose, data, wrench):  # type: ignore[no-untyped-def]
    """Kernel of `Resisted`: add equivalent forces, torques and their gradients to `wrench`.

    Entries of the data: force, drag, weight (3,) N, and constant mobilities (6,).
    """
    drag, weight, reference = part(data, 1), vector(data, 2), vector(data, 3)
    n, gradients = len(pose.time), len(wrench.force_gradient)
    pushed = Wrench(
        np.zeros((n, 3)), np.zeros((n, 3)), np.zeros((gradients, 3, 3)),
        np.zeros((gradients, 3, 3)), np.zeros(n),
    )  # fmt: skip
    mobility = Mobility(np.empty((n, 5)), np.empty((gradients, 5, 3)))
    add(part(data, 0), pose, pushed)
    call(drag.kernel, (pose, drag.data, mobility))
    for i in range(n):
        force, moment = pushed.force[i] + weight, pushed.moment[i]
        _respond(mobility.value[i], force, moment, reference, wrench.force[i], wrench.moment[i])
        for l in range(3 if gradients > 0 else 0):
            by_force, by_moment = wrench.force_gradient[i, :, l], wrench.moment_gradient[i, :, l]
            _respond(mobility.gradient[i, :, l], force, moment, reference, by_force, by_moment)
            _respond(
                mobility.value[i], pushed.force_gradient[i, :, l], pushed.moment_gradient[i, :, l],
                reference, by_force, by_moment,
            )  # fmt: skip
        wrench.error[i] += pushed.error[i]


@named_njit(inner=True, error_model="numpy")
def _respond(mobility, force, moment, reference, out, turning):  # type: ignore[no-untyped-def]
    """Add the velocities of a bead, divided by the constant mobilities, to a force and a torque.

    `mobility` (5,) are mobilities or their derivatives. `force` and `moment` (3,) act on the bead
    (N and N m), and `reference` (6,) are constant mobilities along and about the axes. `out` and
    `turning` (3,) are the equivalent force and torque, to which this adds.
    """
    along, across = mobility[0], mobility[1]
    turn, spin, roll = mobility[2], mobility[3], mobility[4]
    out[0] += (along * force[0] + roll * moment[1]) / reference[0]
    out[1] += (along * force[1] - roll * moment[0]) / reference[1]
    out[2] += across * force[2] / reference[2]
    turning[0] += (turn * moment[0] - roll * force[1]) / reference[3]
    turning[1] += (turn * moment[1] + roll * force[0]) / reference[4]
    turning[2] += spin * moment[2] / reference[5]
