"""Momentum diffusion of a scene's sphere by the shot noise of its light."""

from __future__ import annotations

import numpy as np

from tweezer.optics.binding import Beams, light_force
from tweezer.optics.light import LightForce
from tweezer.optics.of_scene import light
from tweezer.optics.waves.light import Waves
from tweezer.optics.waves.recoil import momentum_diffusion
from tweezer.scene import Scene, SceneLike
from tweezer.values.arrays import Array
from tweezer.values.errors import SceneError
from tweezer.values.units import QuantitiesLike, QuantityLike, to_si

#: Signs of the coordinates in light that travels down, rotated by 180 degrees about x
_DOWN = np.array([1.0, -1.0, -1.0])


def recoil(scene: SceneLike, positions: QuantitiesLike, *, time: QuantityLike = 0.0) -> Array:
    r"""Return the momentum diffusion of a sphere by the recoil of photons, d<P_i P_j>/dt.

    For light of power P it is hbar omega (n_m/c)^2 P (Re <v_i|v_j> + Re <s_i p|(1 - S+ S)|s_j p>).
    The vectors are amplitudes of partial waves: p of the light, and v_i = S s_i p - s_i S p, where
    the matrix S describes scattering and s is the direction. The first term belongs to scattered
    photons, the second to absorbed ones. The light is in a coherent state, and beams do not
    interfere. Runs do not include recoil, which exceeds the collisions with the medium in high
    vacuum only.

    Parameters
    ----------
    scene : Scene, str or mapping
        Scene with a sphere, in wave optics.
    positions : array_like, shape (..., 3)
        Positions of the bead from the focus, m, z along the light. Quantities with units are
        accepted.
    time : float or str, optional
        Time of beams that move or change, s.

    Returns
    -------
    ndarray, shape (..., 3, 3)
        Momentum diffusion, N^2 s = (kg m/s)^2/s. Its error is below 1e-8 of the largest value about
        the focus. A free bead gains the mean kinetic energy (xx + yy + zz)/(2 m) per time.

    Raises
    ------
    ValueError
        For positions of another shape, or that are not finite.
    SceneError
        For rays, for a bead that is not a sphere, for light too uneven for this error, and where
        the bead would be inside a wall.

    Examples
    --------
    >>> scene = tweezer.load_scene("silica-1um")
    >>> x, y, z = tweezer.recoil(scene, [0, 0, 0]).diagonal()
    >>> bool(abs(x - y) < 1e-8 * x)  # circularly polarised light
    True
    """
    of = light(scene)
    places, time = of._places(positions), to_si(time, "s")
    listed = places.reshape(-1, 3)
    found = np.zeros((len(listed), 3, 3))
    for waves, seen, factor, axes in lights_on(of.scene, listed, time):
        found += factor * momentum_diffusion(waves, seen) * np.outer(axes, axes)
    return found.reshape(*places.shape, 3)


def lights_on(
    scene: Scene, positions: Array, time: float
) -> list[tuple[Waves, Array, float, Array]]:
    """Return each beam of a scene with its light, which waves describe, at a time, s.

    With the light come positions (n, 3) in its frame, m, the factor of its power, and the signs of
    its axes, (3,). Raises `SceneError` for rays and for a bead that is not a sphere.
    """
    if scene.bead.shape != "sphere":
        raise SceneError(
            f"bead.shape = {scene.bead.shape!r}: scattered light is computed for a sphere only"
        )
    if not scene.lit:
        return []
    if scene.theory == "rays":
        raise SceneError(
            "optics.theory = 'rays': has no recoil and no detector; set optics.theory = 'waves'"
        )
    force = light_force(scene)
    if isinstance(force, LightForce):
        found = [(force.light, positions, 1.0, np.ones(3))]
    else:
        assert isinstance(force, Beams)
        found = [
            (
                each.light, moved.within(positions, time), float(moved.strength.at(time)[0]),
                _DOWN if moved.down else np.ones(3),
            )
            for moved, each in zip(force.forces, force.lights, strict=True)
        ]  # fmt: skip
    return [
        (waves, seen, factor, axes)
        for waves, seen, factor, axes in found
        if isinstance(waves, Waves)
    ]
