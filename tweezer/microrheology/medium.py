"""Viscoelastic medium of Maxwell elements, and a bead that is trapped in it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from tweezer.calibration.spectra import Decays, TrappedBead
from tweezer.fluid.network import Network
from tweezer.values.arrays import Array, Complex
from tweezer.values.constants import Boltzmann


@dataclass(frozen=True)
class Medium:
    """Viscosity mu(s) = eta_s + sum eta_j/(1 + s tau_j) of a solvent and of Maxwell elements."""

    solvent: float
    """eta_s, viscosity of the solvent, Pa s"""
    viscosities: tuple[float, ...] = ()
    """eta_j, viscosity of each element, Pa s"""
    times: tuple[float, ...] = ()
    """tau_j, relaxation time of each element, s"""

    def modulus(self, frequencies: ArrayLike) -> Complex:
        """Return the complex modulus G* = s mu(s), s = 2 pi i f, at `frequencies` f (n,), Hz.

        The result (n,), Pa, is G' + i G'', with the storage modulus G' and the loss modulus G''.
        """
        f = np.atleast_1d(np.asarray(frequencies, np.float64))
        return 2j * np.pi * f * _network(self.solvent, self.viscosities, self.times).drag_at(f)

    def slopes(self, frequencies: Array) -> Complex:
        """Return the derivatives of the modulus by the logarithms of its parameters.

        The result (1 + 2 elements, n), Pa, has a row for eta_s, then for each eta_j, then for each
        tau_j. `frequencies` (n,) are in Hz.
        """
        s = 2j * np.pi * frequencies
        relaxed = 1 / (1 + np.multiply.outer(self.times, s))
        elements = s * np.array(self.viscosities)[:, None] * relaxed
        return np.concatenate([[s * self.solvent], elements, elements * (relaxed - 1)])


@dataclass(frozen=True)
class ViscoelasticBead(TrappedBead):
    """Bead without mass in a harmonic trap and a viscoelastic medium, with its detector.

    The drag has the Laplace transform gamma(s) = beta + sum b_j/(1 + s tau_j), a dashpot beside
    Maxwell elements. `drag` is beta, the part of the solvent.
    """

    drags: tuple[float, ...] = ()
    """b_j, steady drag of each element, kg/s"""
    times: tuple[float, ...] = ()
    """tau_j, relaxation time of each element, s"""

    @cached_property
    def network(self) -> Network:
        """Elements of the medium that act on the bead."""
        return _network(self.drag, self.drags, self.times)

    def _drag_at(self, frequencies: Array) -> Complex:
        """Return the complex drag gamma(2 pi i f), kg/s, at `frequencies` f (n,), Hz."""
        return self.network.drag_at(frequencies)

    @cached_property
    def _forgetful(self) -> Decays:
        """Amplitudes (m^2) and rates (1/s) of the autocovariance, one more than elements."""
        rates, vectors = np.linalg.eigh(-self.network.matrix(self.stiffness))
        amplitudes = Boltzmann * self.temperature / self.stiffness * vectors[0] ** 2
        return [*zip(amplitudes.tolist(), rates.tolist(), strict=True)]


def _network(dashpot: float, coefficients: tuple[float, ...], times: tuple[float, ...]) -> Network:
    """Return a dashpot beside Maxwell elements, as drags, kg/s, or as viscosities, Pa s."""
    return Network(0.0, dashpot, (np.array(coefficients), np.array(times)))
