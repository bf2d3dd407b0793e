"""The phase over the pupil whose trap is stiffest.

The pupil is an array of square pixels of modulus 1, even or odd under half a turn about its centre.
With z the coefficients of its light (`tweezer.optics.waves.optimum`), the goal and the conditions
are forms of z, and z is linear in the pixels. The phases of the pixels are found by gradients
(L-BFGS), with the conditions in an augmented Lagrangian. The goal has many local maxima, so that
the search starts at several phases.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from tweezer.optics.waves.optimum import Forms, Limits, combined, projected_on
from tweezer.values.arrays import Array

ComplexArray = NDArray[np.complex128]

#: Searches with multipliers of the conditions, and steps of each
_ROUNDS, _STEPS = 6, 80
#: Radii and azimuths of the sums over the pupil, per pixel along its diameter
_RADII, _AZIMUTHS = 1, 4
#: Weight of the squares of missed conditions at first, and its growth
_PENALTY, _STIFFER = 10.0, 3.0


class Phases:
    """Phases of pixels over the pupil, and force and stiffness in their light."""

    def __init__(self, forms: Forms, radius: Callable[[Array], Array], pixels: int) -> None:
        """Prepare the sums over the pupil.

        Parameters
        ----------
        forms : Forms
            Force and stiffness as forms. If their orders are odd, half a turn about the centre
            changes the sign of the light.
        radius : callable
            Function from 1 - cos(theta) behind the lens to the distance from the axis, in pupil
            radii.
        pixels : int
            Even number of pixels along the diameter of the pupil.
        """
        self.forms, self.pixels = forms, pixels
        self.azimuths = _AZIMUTHS * pixels
        below, self.power = forms.rule(_RADII * pixels)
        self.functions, rho = forms.functions(below), radius(below)
        phi = 2 * math.pi * (np.arange(self.azimuths) + 0.5) / self.azimuths
        column, row = (
            np.minimum((np.outer(rho, each) + 1) * pixels / 2, pixels - 1).astype(int)
            for each in (np.cos(phi), np.sin(phi))
        )
        self.at = row * pixels + column  # pixel of each node and azimuth
        self.shift = np.exp(-1j * forms.orders * phi[0]) / self.azimuths

    @property
    def half(self) -> int:
        """Number of phases: half of the pixels have their own."""
        return self.pixels**2 // 2

    def light(self, phases: Array) -> ComplexArray:
        """Return T of all pixels, (pixels, pixels), from the phases of one half."""
        own = np.exp(1j * phases)
        turned = own[::-1] * (-1.0 if self.forms.odd else 1.0)
        return np.concatenate([own, turned]).reshape(self.pixels, self.pixels)

    def of(self, light: ComplexArray) -> Array:
        """Return the phases of half of the pixels of light (pixels, pixels)."""
        return np.angle(light).ravel()[: self.half]

    def coefficients(self, light: ComplexArray) -> ComplexArray:
        """Return z of light (pixels, pixels), with each node in one of the pixels."""
        around = np.fft.fft(light.ravel()[self.at], axis=1)[:, self.forms.orders]
        return projected_on(self.functions, self.power, (around * self.shift).T)

    def _back(self, z: ComplexArray) -> ComplexArray:
        """Return the adjoint of `coefficients` by node and azimuth, (nodes, azimuths)."""
        series = np.zeros((len(self.power), self.azimuths), np.complex128)
        harmonics = self.power * combined(self.functions, z)
        series[:, self.forms.orders] = harmonics.T * self.shift.conj()
        return np.asarray(np.fft.ifft(series, axis=1, norm="forward"))

    def slopes(self, light: ComplexArray, z: ComplexArray) -> Array:
        """Return the derivatives of a form over the phases: z is the form times coefficients."""
        every = 2 * (self._back(z).conj() * (1j * light.ravel()[self.at])).real
        found = np.bincount(self.at.ravel(), every.ravel(), self.pixels**2)
        return np.asarray(found[: self.half] + found[: self.half - 1 : -1])

    def stiffest(self, start: Array, goal: Mapping[str, float], limits: Limits) -> Array:
        """Return phases with a locally largest sum of weighted stiffnesses, near a start."""
        form = sum(share * self.forms.stiffness[axis] for axis, share in goal.items())
        ties = {"f": (self.forms.force, limits.force)}
        ties |= {axis: (self.forms.stiffness[axis], least) for axis, least in limits.least.items()}
        size = float(np.abs(np.linalg.eigvalsh(form)).max())
        sizes = {
            name: float(np.abs(np.linalg.eigvalsh(each)).max()) for name, (each, _) in ties.items()
        }
        multipliers, penalty, phases = dict.fromkeys(ties, 0.0), _PENALTY, start

        def lagrangian(phases: Array, kept: dict[str, float]) -> tuple[float, Array]:
            """Return the value to be minimised and its derivatives; keep missed conditions."""
            light = self.light(phases)
            z = self.coefficients(light)
            moved = form @ z
            value, slope = -float(np.vdot(z, moved).real) / size, -moved / size
            for name, (tie, level) in ties.items():
                turned = tie @ z
                miss = (float(np.vdot(z, turned).real) - level) / sizes[name]
                # of a lower limit only a miss below counts
                pull = multipliers[name] + penalty * miss
                if name != "f" and pull > 0:
                    pull, miss = 0.0, -multipliers[name] / penalty
                value += multipliers[name] * miss + penalty / 2 * miss**2
                slope = slope + pull / sizes[name] * turned
                kept[name] = miss
            return value, self.slopes(light, slope)

        for _ in range(_ROUNDS):
            kept: dict[str, float] = {}
            phases = minimize(
                functools.partial(lagrangian, kept=kept), phases, jac=True, method="L-BFGS-B",
                options={"maxiter": _STEPS, "maxcor": 20},
            ).x  # fmt: skip
            lagrangian(phases, kept)
            multipliers = {name: y + penalty * kept[name] for name, y in multipliers.items()}
            penalty *= _STIFFER
        return np.asarray(phases)
