"""Partial waves of the light about a sphere, and the light of a beam by direction.

The light of a beam is a sum of plane waves g(s) exp(i k s.r) over directions s = (theta, phi),
where r begins at its focus. Their components g_+ and g_- are along e_+ and e_- of
`tweezer.optics.waves.focus`.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from tweezer.optics.waves.amplitudes import Amplitudes, Path
from tweezer.optics.waves.harmonics import harmonics
from tweezer.optics.waves.light import Waves
from tweezer.values.arrays import Array
from tweezer.values.errors import SceneError

ComplexArray = NDArray[np.complex128]

#: Wanted error of sums and integrals, as a part of the light's amplitude
SMALL = 1e-11
#: Largest error, in units of the wanted one
_MISSED = 10.0
#: Reach of the sums, in largest distances
_FARTHER = 1 + 1e-9
#: Number of positions whose arrays fit into the cache of a processor
TOGETHER = 16


class Incident:
    """Partial waves of the light about a sphere at some positions, at one time.

    Parameters
    ----------
    paths : tuple of Path
        Paths of the light, which interfere.
    positions : ndarray, shape (n, 3)
        Positions of the sphere in the frame of the scene, m; no other is farther away.
    degree : int
        Highest degree N.
    time : float
        Time, s.

    Raises
    ------
    SceneError
        If a position is too far from the focus, or the light is too uneven for an error of 1e-10.
    """

    def __init__(self, paths: tuple[Path, ...], positions: Array, degree: int, time: float) -> None:
        light, reach = paths[0].light, float(np.linalg.norm(positions, axis=1).max(initial=0.0))
        if reach > light.farthest:
            raise SceneError(
                f"positions = {reach:.3g}: waves are computed up to {light.farthest:.3g} m from "
                "the focus; allowed: up to that"
            )
        self._amplitudes = Amplitudes(paths, degree, reach * _FARTHER, time, SMALL)
        self._time = time
        self._roots = np.sqrt([state.weight for state in self._amplitudes.states])
        if self._amplitudes.error > _MISSED * len(paths) * SMALL:
            raise SceneError(
                "beam: the light behind the lens is too uneven for scattered light and recoil; "
                f"their error would be {self._amplitudes.error:.2g}"
            )

    @property
    def power(self) -> float:
        """Power of the light, W."""
        return self._amplitudes.power

    def about(self, positions: Array) -> ComplexArray:
        """Return the amplitudes p_nm about spheres at `positions` (n, 3) m, for light of 1 W.

        They are (n, states, 2, orders, degrees): helicity +1 and -1, order m from -N to N, and
        degree n from 0 to N. Each polarised state has its share of the power.
        """
        found = self._amplitudes.at(positions, self._time)
        return found * self._roots[:, None, None, None]


def by_direction(light: Waves, below: Array, phi: Array) -> ComplexArray:
    """Return the amplitudes g_+ and g_- of light of 1 W, sqrt(W/sr).

    Each polarised state has its share of the power.

    Parameters
    ----------
    light : Waves
        Light of one beam, with a pupil, and states without mirror images.
    below : ndarray, shape (n,)
        1 - cos(theta) of the directions, within the cone of light.
    phi : ndarray, shape (m,)
        Azimuths, rad.

    Returns
    -------
    ndarray of complex, shape (states, 2, n, m)
    """
    mask = None if light.pupil is None else light.pupil.mask
    if mask is not None or light.cone.inner > 0:
        key = "annulus" if mask is None else mask.key
        raise SceneError(f"beam.{key}: cannot be combined with a detector; remove one of them")
    along, across = light.focus.amplitudes(below)
    found = np.zeros((len(light.states), 2, len(below), len(phi)), np.complex128)
    for g, state in zip(found, light.states, strict=True):
        for part in state.parts:
            size = math.sqrt(state.weight) * part.coefficient * part.amplitude(along, across)
            turned = np.exp(1j * part.angular_momentum * phi)
            g[(1 - part.helicity) // 2] += size[:, None] * turned
    return found * light.focus.factor(below, phi)


def widest_order(light: Waves) -> int:
    """Return the largest azimuthal order of light with a pupil about its axis."""
    assert light.pupil is not None
    momenta = [abs(part.angular_momentum) for each in light.states for part in each.parts]
    return max(momenta) + max(map(abs, light.pupil.orders))


def directions(below: Array, phi: Array) -> Array:
    """Return unit vectors at 1 - cos(theta) = `below` (n,) and azimuths (m,), rad, (3, m, n)."""
    sine = np.sqrt(below * (2 - below))
    return np.stack([
        np.outer(np.cos(phi), sine), np.outer(np.sin(phi), sine),
        np.broadcast_to(1 - below, (len(phi), len(below))),
    ])  # fmt: skip


def harmonics_of_both(highest: int, below: Array) -> Array:
    """Return harmonics of helicity +1 and -1 at 1 - cos(theta) = `below`, (nodes,).

    They are (2, orders m from -highest to highest, nodes, degrees n from 0); see `harmonics`.
    """
    f = harmonics(highest, below)
    signs = (-1.0) ** np.arange(-highest, highest + 1)
    return np.stack([f, signs[:, None, None] * f[::-1]])
