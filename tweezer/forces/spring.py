"""Spring of an elastic medium, which pulls the bead back to where the medium formed."""

from __future__ import annotations

from dataclasses import dataclass

from tweezer.compiled import cached_njit
from tweezer.forces.data import Data, number, packed
from tweezer.forces.force import Force, Kernel


@dataclass(frozen=True)
class Elastic(Force):
    """Force -g (x - anchor) of a gel of shear modulus G on a sphere, with g = 6 pi r G."""

    stiffness: float
    """g, N/m"""
    anchor: tuple[float, float, float]
    """position at which the force vanishes, m"""

    def compiled(self, *, gradient: bool) -> tuple[Kernel, Data]:
        """Return the kernel and its data."""
        return _pull, packed(self.stiffness, *self.anchor, float(gradient))


@cached_njit(error_model="numpy", nogil=True)
def _pull(pose, data, wrench):  # type: ignore[no-untyped-def]
    """Kernel of `Elastic`."""
    stiffness = number(data, 0)
    for at in range(len(pose.position)):
        for i in range(3):
            wrench.force[at, i] -= stiffness * (pose.position[at, i] - number(data, 1 + i))
            if number(data, 4) > 0.0:
                wrench.force_gradient[at, i, i] -= stiffness
