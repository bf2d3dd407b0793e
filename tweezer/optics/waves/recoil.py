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

from tweezer.optics.waves.amplitudes import Path
from tweezer.optics.waves.incident import SMALL, TOGETHER, Incident
from tweezer.optics.waves.scattered import absorb, directed, moved, products, sphere
from tweezer.values.arrays import Array
from tweezer.values.constants import hbar


def momentum_diffusion(paths: tuple[Path, ...], positions: Array, time: float) -> Array:
    """Return d<P_i P_j>/dt of a sphere in light whose paths interfere, (n, 3, 3) N^2 s.

    `positions` are (n, 3) in the frame of the scene, m, at one time, s.
    """
    light = paths[0].light
    a, b = sphere(light, SMALL)
    incident = Incident(paths, positions, len(a), time)
    found = np.empty((len(positions), 3, 3))
    for first in range(0, len(positions), TOGETHER):
        some = slice(first, first + TOGETHER)
        p = incident.about(positions[some])
        v = moved(p, a, b)
        found[some] = products(v, v).real
        if light.absorbs:
            turned = directed(p)
            found[some] += products(turned, absorb(turned, a, b)).real
    frequency = light.wavenumber / light.momentum_per_energy
    return hbar * frequency * light.momentum_per_energy**2 * incident.power * found
