"""Forces as they move a bead where the drag depends on the place."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tweezer.compiled import address, cached_njit, call
from tweezer.fluid.drag import DRAG_KERNEL, Drag, Kernel, Mobility
from tweezer.forces.data import Data, Part, packed, part, vector
from tweezer.forces.force import Force, Wrench, add, bound

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Resisted(Force):
    """The force that moves a bead of other mobilities, the same everywhere, as this one is moved.

    It is b(x) (F(x) + W) over these mobilities, along each axis.
    """

    force: Force
    """F"""
    drag: Drag
    """b"""
    weight: Array
    """W, (3,) N"""
    reference: Array
    """(3,) s/kg, the other mobilities"""

    @property
    def steady(self) -> bool:
        """See `Force.steady`."""
        return self.force.steady

    def kinks(self, end: float) -> Array:
        """See `Force.kinks`."""
        return self.force.kinks(end)

    def compiled(self, *, gradient: bool) -> tuple[Kernel, Data]:
        """See `Force.compiled`."""
        kernel, data = self.drag.compiled()
        drag = Part(address(kernel, DRAG_KERNEL), data)
        return _add_resisted, packed(
            bound(self.force, gradient=gradient), drag, self.weight, self.reference
        )


@cached_njit(error_model="numpy", nogil=True)
def _add_resisted(pose, data, wrench):  # type: ignore[no-untyped-def]
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
        for k in range(3):
            entry = 1 if k == 2 else 0
            factor = mobility.value[i, entry] / reference[k]
            force = pushed.force[i, k] + weight[k]
            wrench.force[i, k] += factor * force
            for l in range(3 if gradients > 0 else 0):
                changing = mobility.gradient[i, entry, l] / reference[k]
                wrench.force_gradient[i, k, l] += (
                    factor * pushed.force_gradient[i, k, l] + changing * force
                )
        wrench.error[i] += pushed.error[i]
