"""The force of light by interpolation in a table; by quadrature outside the table's range."""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np

from tweezer.compiled import address
from tweezer.forces.data import Data, Part
from tweezer.forces.force import KERNEL, Kernel, Wrench, bound, evaluated
from tweezer.optics.beyond import unreached
from tweezer.optics.light import LightForce
from tweezer.optics.table import Made
from tweezer.values.arrays import Array


@dataclass(frozen=True, eq=False)
class Mapped(LightForce):
    """Force read from a table of polynomials, with its certified error."""

    made: Made
    """the table"""
    unit: float
    """unit of the table's lengths, m"""
    outside: LightForce
    """the force outside the table's range"""

    def field(
        self,
        positions: Array,
        *,
        gradient: bool = False,
        time: float | Array = 0.0,
        orientations: Array | None = None,
    ) -> Wrench:
        """Return force and torque at positions of the bead; see `Force.field`.

        The quadrature is compiled only if a position is out of the table's range.

        Parameters
        ----------
        positions : ndarray, shape (n, 3)
            Positions from the focus, m.
        gradient : bool, optional
            Whether to compute gradients too.
        time : float or ndarray, shape (n,), optional
            Time, s.
        orientations : ndarray, shape (n, 4), optional
            Euler parameters.
        """
        if gradient not in self._parts:
            kernel = address(self.made.kernel(gradient=gradient), KERNEL)
            self._parts[gradient] = Part(kernel, self._data(unreached()))
        wrench = evaluated(self._parts[gradient], positions, gradient, time, orientations)
        out = np.isinf(wrench.error)
        if out.any():
            beyond = self.outside.field(positions[out], gradient=gradient)
            for everywhere, there in zip(wrench, beyond, strict=True):
                if len(everywhere):
                    everywhere[out] = there
        return wrench

    def absorbed_power(self, positions: Array, *, time: float = 0.0) -> Array:
        """Return the power that the bead absorbs, (n,) W, by quadrature, as it is not tabulated."""
        return self.outside.absorbed_power(positions, time=time)

    def compiled(self, *, gradient: bool) -> tuple[Kernel, Data]:
        """Return the kernel of this force and its data; see `Force.compiled`."""
        data = self._with_gradient if gradient else self._without_gradient
        return self.made.kernel(gradient=gradient), data

    def _data(self, beyond: Part) -> Data:
        """Return the data of the kernel; beyond: the force outside the table's range."""
        return self.made.data(self.unit, self.light.strength, beyond)

    @functools.cached_property
    def _with_gradient(self) -> Data:
        """Data of the kernel, with a force outside the table that adds gradients."""
        return self._data(bound(self.outside, gradient=True))

    @functools.cached_property
    def _without_gradient(self) -> Data:
        """Data of the kernel, with a force outside the table that adds no gradients."""
        return self._data(bound(self.outside, gradient=False))
