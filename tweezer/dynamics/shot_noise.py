"""Recoil of photons as a bath beside the medium: the noise of the light's momentum.

The momentum of a bead diffuses at the rate S_ij = d<P_i P_j>/dt by its collisions with photons
(`tweezer.optics.recoil`), as it does at the rate 2 beta kT by those with molecules. The noise of
both is white on the time scale of a bead, so that the diffusion coefficient along an axis becomes

    D_i = (kT + S_ii/(2 beta))/beta,

but the drag remains that of the medium. An axis of a trap with little drag has the temperature
T + S_ii/(2 beta k_B).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tweezer.dynamics.layout import TRANSLATION
from tweezer.dynamics.problem import Problem
from tweezer.optics.recoil import recoil
from tweezer.values.arrays import Array
from tweezer.values.constants import Boltzmann


class Recoil(NamedTuple):
    """Momentum diffusion of a bead along the axes."""

    rates: Array
    """(3,) S_ii, N^2 s, at the equilibrium, or at the start without one"""
    left_out: float
    """largest entry beside the diagonal over the largest on it; it is left out"""
    varies: float
    """largest relative change of a rate one standard deviation from there"""

    @property
    def words(self) -> str:
        """Description of the bath in a few words."""
        largest = float(self.rates.max())
        return (
            f"recoil of the light: {largest:.2g} N^2 s at the equilibrium; it changes by "
            f"{100 * self.varies:.1g} % within a standard deviation, and "
            f"{100 * self.left_out:.1g} % of it couples the axes, both left out"
        )


def recoil_of(problem: Problem) -> Recoil:
    """Return the momentum diffusion of the bead of a problem by recoil."""
    trap, scene = problem.equilibrium, problem.scene
    kT = Boltzmann * scene.noise_temperature
    if trap is None:
        places = np.array([scene.start_position])
    else:
        spread = np.diag(np.sqrt(kT / trap.stiffness_xyz))
        places = trap.position + np.vstack([np.zeros(3), spread, -spread])
    found = recoil(scene, places)
    here = found[0]
    rates = np.diag(here).copy()
    beside = np.abs(here - np.diag(rates)).max() / rates.max()
    along = found[:, range(3), range(3)]
    return Recoil(rates, float(beside), float((np.abs(along - rates) / rates.max()).max()))


def with_recoil(diffusion: Array, mobility: Array, found: Recoil) -> Array:
    """Return diffusion coefficients (dims,) with the recoil, from those in the medium.

    `mobility` (dims,) is in s/kg, then 1/(N m s). Rotation is not changed.
    """
    heated = diffusion.copy()
    heated[TRANSLATION] += 0.5 * found.rates * mobility[TRANSLATION] ** 2
    return heated
