"""The resistance of a rigid body in Stokes flow."""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np

from tweezer.values.arrays import Array
from tweezer.values.constants import Boltzmann
from tweezer.values.printed import printed
from tweezer.values.shown import Card, Row, Shown
from tweezer.values.vectors import Vector, fixed


@dataclass(frozen=True, eq=False, repr=False)
class Resistance(Shown):
    """Resistance of a body about its centre of mass, in the body's frame.

    The drag on a body with the velocity u of its centre of mass and the angular velocity w is
    (F, T) = -R (u, w), with R = [[K, C^T], [C, Q]].
    """

    matrix: Vector
    """R, (6, 6), in kg/s, kg m/s and kg m^2/s; symmetric and positive"""
    temperature: float
    """temperature of the fluid, K"""
    error: float
    """largest relative error of the elements of K and Q"""
    method: str
    """method of the computation"""

    @functools.cached_property
    def mobility(self) -> Array:
        """Inverse of R, (6, 6), which gives velocities from force and torque."""
        return np.asarray(np.linalg.inv(self.matrix), float)

    @property
    def diffusion(self) -> Array:
        """Diffusion matrix k_B T R^-1, (6, 6), in m^2/s, m/s and 1/s."""
        return Boltzmann * self.temperature * self.mobility

    @property
    def centre_of_mobility(self) -> Array:
        """Point at which translation and rotation couple symmetrically, (3,) m, in the body's axes.

        A body of revolution is not turned by a force that acts there.
        """
        turning, coupled = self.mobility[3:, 3:], self.mobility[3:, :3]
        skew = coupled - coupled.T
        vector = np.array([skew[2, 1], skew[0, 2], skew[1, 0]])
        found: Array = np.linalg.solve(turning - np.trace(turning) * np.eye(3), vector)
        return 0.0 + found

    def at(self, point: Array) -> Resistance:
        """Return the resistance about another point, (3,) m, in the body's frame."""
        return Resistance(
            fixed(moved(self.matrix, point)), self.temperature, self.error, self.method
        )

    def card(self) -> Card:
        """Return the card with drag, diffusion coefficients and centre of mobility."""
        drag, diffusion = np.diag(self.matrix), np.diag(self.diffusion)
        turning = ", ".join(f"{each:.4g}" for each in diffusion[3:])
        rows = (
            Row("drag (x, y, z)", printed(tuple(drag[:3]), "nN s/m")),
            Row("rotational drag (x, y, z)", printed(tuple(drag[3:]), "pN nm s")),
            Row("diffusion (x, y, z)", printed(tuple(diffusion[:3]), "um^2/s")),
            Row("rotational diffusion (x, y, z)", f"{turning} rad^2/s"),
            Row("centre of mobility", printed(tuple(self.centre_of_mobility), "um")),
            Row("relative error", f"{self.error:.1g}"),
            Row("method", self.method, detail=True),
        )
        return Card("Resistance", "", rows)


def moved(matrix: Array, point: Array) -> Array:
    """Return a resistance matrix about another point, (3,) m from its own, in the same frame."""
    x, y, z = point
    shift = np.eye(6)
    shift[:3, 3:] = [[0, -z, y], [z, 0, -x], [-y, x, 0]]
    found: Array = shift.T @ matrix @ shift
    return found
