"""The light of one beam by direction, and its partial waves about the bead, in the scene's frame.

The light is a sum of plane waves g(s) exp(i k s.r) over directions s = (theta, phi), with
components g_+ and g_- along e_+ and e_- of `tweezer.optics.waves.focus`. About a bead at r it has
the amplitudes

    p^l_nm = integral f^l_nm(theta) exp(-i m phi) g_l(s) exp(i k s.r) dOmega.

Light of 1 W has sum |p|^2 = 1 W over helicities l, degrees n and orders m. Each
polarised state has its share of the power, so that quantities of several states add up.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from tweezer.optics.waves.focus import Part, State
from tweezer.optics.waves.harmonics import harmonics
from tweezer.optics.waves.light import Waves
from tweezer.optics.waves.nodes import Nodes
from tweezer.values.arrays import Array
from tweezer.values.errors import SceneError

ComplexArray = NDArray[np.complex128]

#: Largest error, in units of the allowed one
_MISSED = 10.0
#: Number of positions that are computed together
_TOGETHER = 64


def by_direction(light: Waves, below: Array, phi: Array) -> ComplexArray:
    """Return the amplitudes g_+ and g_- of light of 1 W, sqrt(W/sr).

    Parameters
    ----------
    light : Waves
        Light of one beam.
    below : ndarray, shape (n,)
        1 - cos(theta) of the directions, within the cone of light.
    phi : ndarray, shape (m,)
        Azimuths, rad.

    Returns
    -------
    ndarray of complex, shape (states, 2, n, m)
    """
    along, across = light.focus.amplitudes(below)
    of_states = []
    for weight, parts in _mirrored(light.states):
        g = np.zeros((2, len(below), len(phi)), np.complex128)
        for mirrored, part in parts:
            helicity, momentum = part.helicity, part.angular_momentum
            if mirrored:
                helicity, momentum = -helicity, -momentum
            size = part.coefficient * part.amplitude(along, across)
            g[(1 - helicity) // 2] += size[:, None] * np.exp(1j * momentum * phi)
        of_states.append(math.sqrt(weight) * g)
    found = np.stack(of_states)
    if light.pupil is not None:
        found *= light.focus.factor(below, phi)
    return found


def _mirrored(states: tuple[State, ...]) -> Iterator[tuple[float, list[tuple[bool, Part]]]]:
    """Return weight and parts of each polarised state, each part with whether it is mirrored.

    A state of equal shares of light and its mirror image, y -> -y, becomes two.
    """
    for state in states:
        images = {1.0: (False,), -1.0: (True,), 0.0: (False, True)}[state.handedness]
        for mirrored in images:
            yield state.weight / len(images), [(mirrored, part) for part in state.parts]


def partial_waves(light: Waves, positions: Array, highest: int, small: float) -> ComplexArray:
    """Return the amplitudes p_nm of light of 1 W about a bead, sqrt(W).

    Parameters
    ----------
    light : Waves
        Light of one beam.
    positions : ndarray, shape (n, 3)
        Positions of the bead from the focus, m.
    highest : int
        Highest degree.
    small : float
        Allowed error, as a part of the light's amplitude.

    Returns
    -------
    ndarray of complex, shape (n, states, 2, 2 highest + 1, highest + 1)
        By helicity +1 and -1, order m from -highest to highest, and degree n from 0.

    Raises
    ------
    SceneError
        If the light over the cone is too uneven for this error.
    """
    nodes = Nodes(light.focus, light.kinds, small)
    if nodes.error > _MISSED * small:
        raise SceneError(
            f"beam: the light behind the lens is too uneven for an error of {small:g} of its "
            f"scattered light; it is {nodes.error:.2g}"
        )
    across, along = nodes.variable.phases
    far = light.wavenumber * np.abs(positions)
    side = np.hypot(far[:, 0], far[:, 1]).max()
    phase = highest * light.focus.half_angle + side * across
    phase += (far[:, 2].max() + abs(nodes.shift)) * along
    rule = nodes.up_to(phase)[-1]
    orders = np.arange(-highest, highest + 1)
    widest = 0 if light.pupil is None else max(map(abs, light.pupil.orders))
    momenta = [abs(part.angular_momentum) for each in light.states for part in each.parts]
    x = side * math.sin(light.focus.half_angle)
    count = math.ceil(highest + max(momenta) + widest + x + 5 * x ** (1 / 3) + 8)
    phi = 2 * math.pi * np.arange(count) / count
    g = by_direction(light, rule.below, phi) * (2 * math.pi / count * rule.weight)[:, None]
    f = harmonics(highest, rule.below)
    by_helicity = np.stack([f, (-1.0) ** orders[:, None, None] * f[::-1]])
    sine = np.sqrt(rule.below * (2 - rule.below))[:, None]
    s = np.stack(
        [
            sine * np.cos(phi),
            sine * np.sin(phi),
            np.broadcast_to((1 - rule.below)[:, None], (len(sine), count)),
        ]
    )
    found = np.empty((len(positions), len(g), 2, len(orders), highest + 1), np.complex128)
    for first in range(0, len(positions), _TOGETHER):
        some = slice(first, first + _TOGETHER)
        turned = np.exp(1j * light.wavenumber * np.einsum("pi,iqf->pqf", positions[some], s))
        around = np.fft.fft(g * turned[:, None, None], axis=-1)[..., orders]
        found[some] = np.einsum("lmqn,pslqm->pslmn", by_helicity, around, optimize=True)
    return found
