"""Forces between a bead and a wall: double-layer and van der Waals forces, and contact.

They depend only on the gap between the surfaces, and act along the normal of the wall.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from tweezer.compiled import cached_njit
from tweezer.forces.data import Data, number, packed
from tweezer.forces.force import Force, Kernel

#: Smallest gap of two surfaces that touch, m: below it van der Waals's force grows no further
#: (J. N. Israelachvili, Intermolecular and Surface Forces, 3rd ed., 13.13)
CLOSEST = 0.165e-9
#: Length in which the repulsion of atoms that touch falls to 1/e, m (ibid., 7.1)
BORN = 2e-11
#: Gap, in units of `BORN`, beyond which this repulsion is negligible
_GONE = 60.0


@dataclass(frozen=True)
class Dlvo(Force):
    """Force of Derjaguin, Landau, Verwey and Overbeek (DLVO) between a sphere and a plane.

    Its potential is B exp(-gap/l_D) - A_H r/(6 gap): both double layers in Derjaguin's
    approximation, and the van der Waals attraction near contact, without retardation. At gaps below
    `CLOSEST` the force is constant.
    """

    radius: float
    """radius r of the sphere, m"""
    position: float
    """z of the wall, m"""
    normal: float
    """1 or -1: sign of z of the normal into the medium, see `tweezer.scene.sections.Wall`"""
    strength: float
    """strength B of the double-layer repulsion, J"""
    debye_length: float
    """l_D, m"""
    hamaker_constant: float
    """A_H, J"""

    def compiled(self, *, gradient: bool) -> tuple[Kernel, Data]:  # noqa: ARG002
        """Return the kernel of this force and its data; see `Force.compiled`."""
        return _add_dlvo, packed(
            self.radius, self.position, self.normal, self.strength / self.debye_length,
            1 / self.debye_length, self.hamaker_constant * self.radius / 6,
        )  # fmt: skip

    @property
    def attraction(self) -> float:
        """Van der Waals attraction at the smallest gap, `CLOSEST`, N."""
        return self.hamaker_constant * self.radius / 6 / CLOSEST**2


@cached_njit(error_model="numpy", nogil=True)
def _add_dlvo(pose, data, wrench):  # type: ignore[no-untyped-def]
    """Add the force of `Dlvo` along z, as a kernel.

    `data` contains the radius r, m, the wall's position along z, m, and its normal, 1 or -1. The
    double layer follows with B/l_D, N, and 1/l_D, 1/m. The last entry is A_H r/6, J m, of the van
    der Waals attraction.
    """
    radius, position, normal = number(data, 0), number(data, 1), number(data, 2)
    push, rate, pull = number(data, 3), number(data, 4), number(data, 5)
    for i in range(len(pose.time)):
        gap = normal * (pose.position[i, 2] - position) - radius
        held = max(gap, CLOSEST)
        repulsion, attraction = push * math.exp(-rate * held), pull / (held * held)
        wrench.force[i, 2] += normal * (repulsion - attraction)
        if len(wrench.force_gradient) > 0 and gap > CLOSEST:
            slope = 2.0 * attraction / held - rate * repulsion
            wrench.force_gradient[i, 2, 2] += slope


@dataclass(frozen=True)
class Contact(Force):
    """Contact force, which keeps a bead from sinking into a wall: F_0 exp(-gap/`BORN`).

    The form is Born and Mayer's. Under a force F the bead rests at the gap l ln(F_0/F), with l =
    `BORN`, which is 7 l or more. Near the wall the mobility is proportional to the gap. The bead
    therefore comes to rest at the rate b F/r times a logarithm, where b is the mobility far away.
    This is no faster than the motion under the same force far from the wall, so the equations are
    not stiff.
    """

    radius: float
    """radius r of the bead, m"""
    position: float
    """z of the wall, m"""
    normal: float
    """1 or -1: sign of z of the normal into the medium, see `tweezer.scene.sections.Wall`"""
    largest: float
    """F_0, N: about 1000 times the largest force towards the wall"""

    def compiled(self, *, gradient: bool) -> tuple[Kernel, Data]:  # noqa: ARG002
        """Return the compiled function that adds the contact force, and its data.

        The function adds the gradient where the kernel asks for one. See `Force.compiled`.
        """
        return _add_contact, packed(self.radius, self.position, self.normal, self.largest)


@cached_njit(error_model="numpy", nogil=True)
def _add_contact(pose, data, wrench):  # type: ignore[no-untyped-def]
    """Add the force of `Contact` along z, as a kernel.

    `data` contains r (m), z of the wall (m), the normal (1 or -1) and F_0 (N).
    """
    radius, position = number(data, 0), number(data, 1)
    normal, largest = number(data, 2), number(data, 3)
    for i in range(len(pose.time)):
        gap = normal * (pose.position[i, 2] - position) - radius
        if gap < _GONE * BORN:
            push = largest * math.exp(-max(gap, 0.0) / BORN)
            wrench.force[i, 2] += normal * push
            if len(wrench.force_gradient) > 0 and gap > 0.0:
                wrench.force_gradient[i, 2, 2] -= push / BORN
