"""The force of light at positions that scenes with different powers share."""

from __future__ import annotations

import functools

import numpy as np

from tweezer.optics.beam import cone
from tweezer.optics.binding import light_of_one_beam
from tweezer.scene import Scene
from tweezer.values.arrays import Array

#: Number of lists of places whose forces are kept, over all lights
_LISTS = 64


def sampled(scene: Scene, positions: Array) -> tuple[Array, Array]:
    """Return the force of the light of the only beam of `scene`, (n, 3) N, and its error, (n,) N.

    positions: (n, 3) m. The force is proportional to the power: it is computed for 1 W, once for
    each light and list of positions, kept, and multiplied.
    """
    if not scene.lit:
        return np.zeros((len(positions), 3)), np.zeros(len(positions))
    force, error = _of_one_watt(scene.of_power(1.0), np.ascontiguousarray(positions).tobytes())
    power = cone(scene).power
    return power * force, power * error


@functools.lru_cache(maxsize=_LISTS)
def _of_one_watt(scene: Scene, places: bytes) -> tuple[Array, Array]:
    """Return force and error as `sampled`, for a scene of 1 W.

    places: memory of the positions (n, 3), as bytes, which can be the key of a cache.
    """
    positions = np.frombuffer(places).reshape(-1, 3)
    light = light_of_one_beam(scene)
    field = light.field(positions)
    return field.force, light.error_of(positions, field)
