"""The detector of a scene: its signals as functions of the position of the bead."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass

import numpy as np

from tweezer.optics.at_rest import at_rest
from tweezer.optics.binding import paths_of_light
from tweezer.optics.waves.band_limited import at_many
from tweezer.optics.waves.detector import Diode
from tweezer.scene import Scene
from tweezer.values.arrays import Array
from tweezer.values.constants import hbar
from tweezer.values.errors import SceneError

#: Names of the signals
CHANNELS = ("x", "y", "z")


@dataclass(frozen=True, eq=False)
class Detection:
    """Signals of the detector of a scene for positions of its bead. `detection` makes one."""

    scene: Scene
    diode: Diode
    power: float
    """power of the light that is detected if all of it is collected, W: with the efficiency"""

    def signals(self, positions: Array) -> Array:
        """Return the signals of x, y and z for positions (n, 3) m, (n, 3) W."""
        return self.power * self.diode.signals(positions)[0]

    def with_slopes(self, positions: Array) -> tuple[Array, Array, Array]:
        """Return signals (n, 3) W, slopes (n, 3, 3) W/m and spectra of shot noise (n, 3) W^2/Hz.

        Slopes are by signal and axis; spectra are one-sided.
        """
        signals, slopes, squares = self.diode.signals(positions, slopes=True)
        return self.power * signals, self.power * slopes, self._noise * squares

    def along(self, positions: Array) -> tuple[Array, Array]:
        """Return signals (n, 3) W and one-sided spectra of shot noise (n, 3) W^2/Hz of a path.

        At many positions they are interpolated, to 1e-10 of all light. Both are NaN where a
        position is.
        """
        known = np.isfinite(positions).all(axis=1)

        def both(places: Array) -> Array:
            """Return signals and squares at places (m, 3), m, for light of 1 W, (m, 6)."""
            signals, _, squares = self.diode.signals(places)
            return np.concatenate([signals, squares], axis=1)

        found = np.full((len(positions), 6), np.nan)
        found[known] = at_many(both, positions[known], self.band)
        return self.power * found[:, :3], self._noise * np.maximum(found[:, 3:], 0.0)

    @property
    def band(self) -> Array:
        """Largest wavenumber of the signals along each axis, (3,) 1/m."""
        light, angle = self.diode.light, self.diode.light.focus.half_angle
        return light.wavenumber * np.array([2, 2, math.tan(angle / 2)]) * math.sin(angle)

    @property
    def frequency(self) -> float:
        """Angular frequency of the light, 1/s."""
        return self.diode.light.wavenumber / self.diode.light.momentum_per_energy

    @property
    def _noise(self) -> float:
        """One-sided spectrum of shot noise, W^2/Hz, for a mean square of 1."""
        return 2 * hbar * self.frequency * self.power

    @functools.cached_property
    def rest(self) -> Array:
        """Stable equilibrium of light and weight nearest the focus, (3,) m.

        Raises `SceneError` if none exists.
        """
        nearest = at_rest(self.scene)
        if nearest is None:
            raise SceneError(
                "detector: the light has no stable equilibrium, about which its signals are "
                "described; give a scene that traps the bead"
            )
        return np.array(nearest.position)


@functools.lru_cache(maxsize=8)
def detection(scene: Scene) -> Detection:
    """Return the signals of the detector of a scene.

    Raises `SceneError` for a scene without a detector.
    """
    if scene.detector is None:
        raise SceneError("detector: missing; give [detector] with a numerical_aperture")
    (path,) = paths_of_light(scene, (scene.beam,))
    detector = scene.detector
    half_angle = math.asin(min(1.0, detector.numerical_aperture / scene.medium.refractive_index))
    diode = Diode(path, half_angle, detector.kind, detector.side == "forward")
    return Detection(scene, diode, detector.efficiency * path.light.cone.power)
