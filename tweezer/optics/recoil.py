"""Momentum diffusion of a scene's sphere by the shot noise of its light."""

from __future__ import annotations

import numpy as np

from tweezer.optics.binding import paths_of_light
from tweezer.optics.of_scene import light
from tweezer.optics.waves.recoil import momentum_diffusion
from tweezer.scene import Scene, SceneLike
from tweezer.scene.interference import groups
from tweezer.values.arrays import Array
from tweezer.values.errors import SceneError
from tweezer.values.units import QuantitiesLike, QuantityLike, to_si


def recoil(scene: SceneLike, positions: QuantitiesLike, *, time: QuantityLike = 0.0) -> Array:
    r"""Return the momentum diffusion of a sphere by the recoil of photons, d<P_i P_j>/dt.

    For light of power P it is hbar omega (n_m/c)^2 P (Re <v_i|v_j> + Re <s_i p|(1 - S+ S)|s_j p>).
    The vectors are amplitudes of partial waves: p of the light, and v_i = S s_i p - s_i S p, where
    the matrix S describes scattering and s is the direction. The first term belongs to scattered
    photons, the second to absorbed ones. The light is in a coherent state. Runs do not include
    recoil, which exceeds the collisions with the medium in high vacuum only.

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
    listed, found = places.reshape(-1, 3), np.zeros((places.size // 3, 3, 3))
    check_scattered(of.scene)
    for group in groups(of.scene) if of.scene.lit else ():
        if paths := paths_of_light(of.scene, group):
            found += momentum_diffusion(paths, listed, time)
    return found.reshape(*places.shape, 3)


def check_scattered(scene: Scene) -> None:
    """Raise `SceneError` for a scene whose scattered light is not computed."""
    if scene.bead.shape != "sphere":
        raise SceneError(
            f"bead.shape = {scene.bead.shape!r}: scattered light is computed for a sphere only"
        )
    if scene.lit and scene.theory == "rays":
        raise SceneError(
            "optics.theory = 'rays': has no recoil and no detector; set optics.theory = 'waves'"
        )
