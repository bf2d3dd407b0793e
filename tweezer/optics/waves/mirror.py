"""Light that a plane mirror reflects.

The mirror at the height h turns a plane wave along s into one along (s_x, s_y, -s_z). Its
amplitudes are r_p g_theta and r_s g_phi along its own unit vectors. Its e_theta is minus the mirror
image of the incident one. The reflected field is therefore the mirror image of light with the
amplitudes

    -r_p g_theta,   r_s g_phi,

and Fresnel's r_p and r_s. For a perfect mirror r_p = 1 and r_s = -1: the tangential field
vanishes on it, and the helicity changes its sign.
"""

from __future__ import annotations

import dataclasses
import functools
from dataclasses import dataclass

import numpy as np

from tweezer.generated import waves
from tweezer.optics.waves.focus import ComplexArray, Focus
from tweezer.optics.waves.light import Waves
from tweezer.values.arrays import Array


@dataclass(frozen=True)
class Reflected(Focus):
    """Mirror image of the plane waves that a mirror reflects."""

    index: complex | None = None
    """refractive index of the mirror relative to the medium; None for a perfect mirror"""

    def amplitudes(self, below: Array) -> tuple[ComplexArray, ComplexArray]:
        """Return the amplitudes along e_theta and e_phi; see `Focus.amplitudes`."""
        along, across = super().amplitudes(below)
        if self.index is None:
            return -along, -across
        sine = np.sqrt(below * (2 - below)) / self.index
        behind = np.sqrt(1 - sine**2 + 0j)
        # the light behind the face decays away from it
        behind = np.where((self.index * behind).imag < 0, -behind, behind)
        r_p, r_s = waves.reflect.py_func(1 - below, behind, 1.0, self.index)
        return -r_p * along, r_s * across


@dataclass(frozen=True, eq=False)
class ReflectedWaves(Waves):
    """Mirror image of the light of a beam that a mirror reflects, on a layered sphere."""

    index: complex | None = None
    """refractive index of the mirror relative to the medium; None for a perfect mirror"""

    @functools.cached_property
    def focus(self) -> Focus:
        """Plane waves of the mirror image."""
        return Reflected(self.cone, self.face, self.pupil, self.index)


def reflected(light: Waves, index: complex | None) -> ReflectedWaves:
    """Return the mirror image of the reflected light of a beam.

    Parameters
    ----------
    light : Waves
        Light of the beam. Its states need parts of both helicities, as behind a plane face, unless
        the mirror is perfect.
    index : complex or None
        Refractive index of the mirror relative to the medium; None for a perfect mirror.
    """
    fields = {each.name: getattr(light, each.name) for each in dataclasses.fields(light)}
    return ReflectedWaves(**fields, index=index)
