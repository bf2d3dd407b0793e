"""Positions of a bead from the signals of a scene's detector, beyond its linear range.

The three signals V = (V_x, V_y, V_z) are functions of the position r, computed by wave optics. At
each sample the equations V(r) = V are solved by Newton's method from the equilibrium. They have one
solution there as long as the bead stays where V_x rises with x, and so on.
"""

from __future__ import annotations

import dataclasses

import numpy as np

from tweezer.calibration.setup import Setup
from tweezer.fluid.medium import medium
from tweezer.optics.detected import linear_ranges
from tweezer.optics.detection import CHANNELS, Detection, detection
from tweezer.optics.heat import heated
from tweezer.optics.waves.band_limited import InBox
from tweezer.reading.recording import Recording
from tweezer.scene import Scene
from tweezer.scene.bead import bead_properties
from tweezer.scene.media import GASES
from tweezer.values.arrays import Array
from tweezer.values.errors import ResultError
from tweezer.values.printed import in_unit

#: Half-width of the box of positions: so many times the largest displacement of linear signals,
#: plus a length, m
_WIDER, _MORE = 1.8, 20e-9
#: Largest half-width: so many wavelengths in the medium, plus so many bead radii
_WAVELENGTHS, _RADII = 0.5, 0.5
#: Newton's method: largest number of steps, and length of the last, m
_STEPS, _LAST = 40, 1e-13
#: Rounds in which the gain follows from the mean of all light
_ROUNDS = 4


def from_signals(recording: Recording, scene: Scene) -> Recording:
    """Return the positions in a recording of the detector of a scene.

    Parameters
    ----------
    recording : Recording
        Signals x, y and z of the detector: in watts, or in volts. The mean of z, which is all of
        the light, then determines the gain, and those of x and y belong to the equilibrium.
    scene : Scene
        Scene with the detector.

    Returns
    -------
    Recording
        Positions, m. Its note contains the range in which the signals are linear within 5 %.

    Raises
    ------
    SceneError
        For a scene without a detector or an equilibrium.
    ResultError
        For a recording without all three signals, and one in which the bead leaves the range in
        which the signals determine its position.
    """
    seen, name = detection(heated(scene)), recording.name
    if recording.unit == "m" or recording.axes != CHANNELS:
        raise ResultError(
            f"{name}: --scene requires the signals x, y and z of its detector; give a run with a "
            "detector, or a table in volts"
        )
    if recording.unit == "W":
        positions = _Inverse(seen, recording.positions, name).positions(recording.positions)
    else:
        positions = _of_volts(seen, recording.positions, name)
    ranges = (
        f"{in_unit(each, 'nm')} nm in {axis}"
        for axis, each in zip(CHANNELS, linear_ranges(seen), strict=True)
    )
    note = f"the signals are linear within 5 % up to {', '.join(ranges)}"
    of_medium = medium(scene)
    if scene.medium.name is not None and of_medium.drag_error > 0:
        known = 100 * of_medium.drag_error / of_medium.drag
        note += f"; the drag in {scene.medium.name} is known within {known:.2g} %"
    return dataclasses.replace(
        recording, positions=positions, unit="m",
        note="; ".join(filter(None, [recording.note, note])),
    )  # fmt: skip


def completed(setup: Setup, scene: Scene) -> Setup:
    """Return a setup with bead and medium of a scene where they are not given."""
    scene = heated(scene)
    fluid = scene.medium
    drag, given = setup.drag, (setup.drag, setup.radius, setup.viscosity)
    if (fluid.name in GASES or scene.heat is not None) and given == (None, None, None):
        drag = bead_properties(scene).drag
    return dataclasses.replace(
        setup,
        temperature=scene.noise_temperature if setup.temperature is None else setup.temperature,
        drag=drag,
        radius=scene.bead.radius if setup.radius is None else setup.radius,
        viscosity=fluid.viscosity if setup.viscosity is None else setup.viscosity,
    )


class _Inverse:
    """Positions as functions of the signals, in a box that contains those of some signals.

    `signals` are (n, 3) W, and `name` names their recording.
    """

    def __init__(self, seen: Detection, signals: Array, name: str) -> None:
        self.seen, self._name = seen, name
        (self.at_rest,), (self._slope,), _ = seen.with_slopes(seen.rest[None])
        light = seen.diode.light
        most = _WAVELENGTHS * 2 * np.pi / light.wavenumber + _RADII * light.radius
        self._half = np.minimum(_WIDER * np.abs(self._linear(signals)).max(axis=0) + _MORE, most)
        low, high = seen.rest - self._half, seen.rest + self._half
        self._box = InBox(seen.signals, low, high, seen.band)

    def _linear(self, signals: Array) -> Array:
        """Return the displacements (n, 3) m of signals that are linear."""
        return np.linalg.solve(self._slope, (signals - self.at_rest).T).T

    def positions(self, signals: Array) -> Array:
        """Return the positions (n, 3) m that belong to signals (n, 3) W, by Newton's method."""
        rest, half = self.seen.rest, self._half
        places = rest + np.clip(self._linear(signals), -half, half)
        left, side = np.arange(len(signals)), np.sign(np.linalg.det(self._slope))
        for _ in range(_STEPS):
            found, slopes = self._box.with_slopes(places[left])
            rising = np.sign(np.linalg.det(slopes)) == side
            slopes[~rising] = self._slope
            step = np.linalg.solve(slopes, (signals[left] - found)[..., None])[..., 0]
            places[left] = np.clip(places[left] + step, rest - half, rest + half)
            left = left[(np.abs(step).max(axis=1) > _LAST) | ~rising]
            if not left.size:
                return places
        share = 100 * left.size / len(signals)
        raise ResultError(
            f"{self._name}: {share:.2g} % of the signals have no position about the equilibrium; "
            "the bead moves too far for this detector, or the scene does not describe the recording"
        )


def _of_volts(seen: Detection, volts: Array, name: str) -> Array:
    """Return the positions (n, 3) m that belong to signals (n, 3) in volts."""
    light = volts[:, 2].mean()
    if light <= 0:
        raise ResultError(f"{name}: z: is not all of the light, which must be above 0 V")
    at_rest = seen.signals(seen.rest[None])[0]
    mean, inverse = at_rest[2], None
    for _ in range(_ROUNDS):
        signals = mean / light * (volts - [*volts.mean(axis=0)[:2], 0]) + [*at_rest[:2], 0]
        inverse = inverse or _Inverse(seen, signals, name)
        positions = inverse.positions(signals)
        # the bead is in equilibrium on average: only its spread changes the mean of the light
        centred = positions - [0, 0, positions[:, 2].mean() - seen.rest[2]]
        mean = float(seen.along(centred)[0][:, 2].mean())
    return positions
