"""Momentum diffusion of a sphere by the shot noise of the light: photon recoil.

A sphere turns the incoming light p into the outgoing light S p, S = 1 + T. Scattering from s'
into s changes the sphere's momentum by hbar k (s' - s), coherently in s'. With

    v_i = S s_i p - s_i S p = T s_i p - s_i T p

for light of 1 W in a coherent state, the sphere's momentum diffuses by

    d<P_i P_j>/dt = hbar omega (n_m/c)^2 P (Re <v_i|v_j> + Re <s_i p|(1 - S+ S)|s_j p>),

where P is the power. The second term is the momentum of absorbed photons. The derivative of the
outgoing light over the sphere's position is i k v_i. The first term is therefore also the
information about the position in that light: imprecision times back-action is hbar^2.
"""

from __future__ import annotations

import numpy as np

from tweezer.optics.waves.incident import partial_waves
from tweezer.optics.waves.light import Waves
from tweezer.optics.waves.scattered import absorb, directed, moved, products, sphere
from tweezer.values.arrays import Array
from tweezer.values.constants import hbar

#: Error of sums and integrals, as a part of the largest amplitude
_SMALL = 1e-11
#: Number of positions that are computed together
_TOGETHER = 64


def recoil_per_watt(light: Waves, positions: Array) -> Array:
    """Return the momentum diffusion in units of hbar omega (n_m/c)^2 P, (n, 3, 3).

    omega is the frequency of the light, n_m the index of the medium, P the power. `positions` are
    (n, 3) from the focus, m.
    """
    a, b = sphere(light, _SMALL)
    found = np.empty((len(positions), 3, 3))
    for first in range(0, len(positions), _TOGETHER):
        some = slice(first, first + _TOGETHER)
        p = partial_waves(light, positions[some], len(a), _SMALL)
        v = moved(p, a, b)
        found[some] = products(v, v).real
        if light.absorbs:
            turned = directed(p)
            found[some] += products(turned, absorb(turned, a, b)).real
    return found


def momentum_diffusion(light: Waves, positions: Array) -> Array:
    """Return d<P_i P_j>/dt of a sphere at `positions` (n, 3) m from the focus, (n, 3, 3) N^2 s."""
    frequency = light.wavenumber / light.momentum_per_energy
    unit = hbar * frequency * light.momentum_per_energy**2 * light.cone.power
    return unit * recoil_per_watt(light, positions)
