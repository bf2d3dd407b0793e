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
from tweezer.optics.recoil import recoil
from tweezer.scene import Scene
from tweezer.values.arrays import Array
from tweezer.values.constants import Boltzmann


class Recoil(NamedTuple):
    """Momentum diffusion of a bead, and its change over the thermal motion."""

    diffusion: Array
    """(3, 3) S, N^2 s, at a position"""
    beside: Array
    """(2, 3, 3, 3) S one standard deviation beside it, in both directions along each axis"""

    @property
    def words(self) -> str:
        """Description of the bath in a few words."""
        rates = self.diffusion.diagonal()
        largest = float(rates.max())
        varies = np.abs(self.beside.diagonal(axis1=2, axis2=3) - rates).max() / largest
        couples = np.abs(self.diffusion - np.diag(rates)).max() / largest
        return (
            f"recoil of the light: {largest:.2g} N^2 s where the bead rests; it changes by "
            f"{100 * varies:.1g} % within a standard deviation, and {100 * couples:.1g} % of it "
            "couples the axes, both left out"
        )

    def added_to(self, diffusion: Array, mobility: Array) -> Array:
        """Return diffusion coefficients (dims,) in the medium and the light.

        `diffusion` (dims,) belongs to the medium. `mobility` (dims,) is in s/kg, then 1/(N m s).
        Rotation is not changed.
        """
        heated = diffusion.copy()
        heated[TRANSLATION] += 0.5 * self.diffusion.diagonal() * mobility[TRANSLATION] ** 2
        return heated


def recoil_at(scene: Scene, position: Array, stiffness: Array) -> Recoil:
    """Return the momentum diffusion of a bead by recoil.

    Parameters
    ----------
    scene : Scene
        Scene of a sphere in light.
    position : ndarray, shape (3,)
        Position of the equilibrium, or another one, m.
    stiffness : ndarray, shape (3,)
        Stiffness along each axis, N/m, which gives the standard deviations; infinite for a bead
        that is not trapped.

    Raises
    ------
    SceneError
        For light whose scattering is not computed; see `tweezer.recoil`.
    """
    spread = np.diag(np.sqrt(Boltzmann * scene.noise_temperature / stiffness))
    displaced = np.stack([spread, -spread]).reshape(-1, 3)
    found = recoil(scene, position + np.vstack([np.zeros(3), displaced]))
    return Recoil(found[0], found[1:].reshape(2, 3, 3, 3))
