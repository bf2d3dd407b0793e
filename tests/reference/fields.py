"""Fields of force with closed-form motion, in place of the light of a scene."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tweezer.optics import Field


@dataclass(frozen=True)
class LinearTrap:
    """F = -k q and M = moment, a constant; the interface of `tweezer.optics.Light`."""

    stiffness: float
    constant_moment: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def field(self, positions, *, gradient=False):
        n = len(positions)
        gradients = n if gradient else 0
        return Field(
            -self.stiffness * positions,
            np.tile(self.constant_moment, (n, 1)),
            np.tile(-self.stiffness * np.eye(3), (gradients, 1, 1)),
            np.zeros((gradients, 3, 3)),
            np.zeros(n),
        )


def in_trap(equations, stiffness, moment=(0.0, 0.0, 0.0)):
    """`equations` bound again with a linear trap in place of the light."""
    return type(equations)(
        equations.scene, equations.module, equations.bead, LinearTrap(stiffness, moment)
    )
