"""Known bead, medium, wall and detector for a calibration, from the user and the recording."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from tweezer.calibration.inertia import Inertia
from tweezer.calibration.left_out import LeftOut
from tweezer.calibration.spectra import TrappedBead
from tweezer.calibration.wall import ACROSS, Height
from tweezer.reading.recording import Recording
from tweezer.scene import Scene
from tweezer.scene.arguments import in_si
from tweezer.scene.bead import bead_properties
from tweezer.scene.media import GASES
from tweezer.scene.sphere import drag_of_translation
from tweezer.values.errors import ResultError
from tweezer.values.rounding import most
from tweezer.values.units import TEMPERATURE, QuantityLike, bare

#: SI units of the quantities of bead and medium
_UNITS = {
    "temperature": "K", "drag": "kg/s", "mass": "kg", "displaced_mass": "kg", "radius": "m",
    "viscosity": "Pa s",
}  # fmt: skip
#: Axes of a simulated run
_EVERY_AXIS = ("x", "y", "z")
#: Number of positions over which the drag of a run is averaged
_PLACES = 1000
#: Relative excess of the exposure over the sampling interval that is allowed as rounding
_UNEVEN = 1e-3


class Detector(NamedTuple):
    """Detector of a recording, in SI units."""

    exposure: float | None
    """exposure time of a sample, s; None if unknown or fitted"""
    diode: tuple[float, float] | None
    """half-power frequency of a photodiode, Hz, and the fraction of the signal that it detects
    without delay; None without a diode, or if fitted"""
    noise: float | None
    """standard deviation of the noise along the first axis, m or V; None if unknown or fitted"""
    noises: dict[str, float]
    """standard deviation of the noise by axis, m or V; 0 if unknown"""
    fitted: tuple[str, ...]
    """names of the parameters that are fitted, as in `TrappedBead`"""

    @property
    def exposure_known(self) -> bool:
        """Whether the exposure is given or fitted."""
        return self.exposure is not None or "exposure" in self.fitted


@dataclass(frozen=True)
class Known:
    """Known bead, medium, wall and detector of a recording, in SI units; None if unknown."""

    temperature: float
    drag: float | None
    """drag far from walls, kg/s"""
    mass: float | None
    displaced_mass: float | None
    """mass of the displaced fluid, kg; None without fluid inertia"""
    radius: float | None
    viscosity: float | None
    poles: int
    """number of poles of the hydrodynamic memory"""
    wall: Height | None
    detector: Detector
    left_out: LeftOut
    """frequencies excluded from the record"""
    drags: dict[str, float]
    """drag by axis at the position of the bead, kg/s; unknown axes are missing"""

    def bead(self, axis: str, step: float) -> TrappedBead:
        """Return the bead along an axis, sampled every `step`, s, with NaN for unknown values."""
        wall, detector = self.wall, self.detector
        frequency, fraction = detector.diode or (None, 0.0)
        return TrappedBead(
            math.nan, self.drags.get(axis, math.nan) if self.exact else math.nan,
            self.temperature, self.mass, min(detector.exposure or 0.0, step), self.displaced_mass,
            self.poles, frequency, fraction, detector.noises[axis],
            wall=None if wall is None else wall.radii, across=axis == ACROSS,
        )  # fmt: skip

    @property
    def exact(self) -> bool:
        """Whether the height above a wall, and with it the drag, has no uncertainty."""
        return self.wall is None or not self.wall.uncertainty


@dataclass(frozen=True, kw_only=True)
class Setup:
    """Bead, medium, wall and detector as the user gives them, in SI or as text; None if not given.

    The fields are the keywords of `calibrate`, which documents them.
    """

    temperature: QuantityLike | None = None
    drag: QuantityLike | None = None
    mass: QuantityLike | None = None
    displaced_mass: QuantityLike | None = None
    wall: QuantityLike | tuple[QuantityLike, QuantityLike] | None = None
    radius: QuantityLike | tuple[QuantityLike, QuantityLike] | None = None
    viscosity: QuantityLike | None = None
    exposure: QuantityLike | None = None
    diode: QuantityLike | tuple[QuantityLike, QuantityLike] | None = None
    noise: QuantityLike | None = None
    leave_out: Sequence[str | tuple[float, float]] = ()
    drift: QuantityLike | None = None
    fit_range: str | tuple[float, float] | None = None
    pressure: QuantityLike | tuple[QuantityLike, QuantityLike] | None = None
    density: QuantityLike | tuple[QuantityLike, QuantityLike] | None = None
    gas: Scene | None = None
    """scene of the gas about an oscillating bead; None for other media"""

    def of(self, recording: Recording) -> Known:
        """Return the known properties for a recording, from this setup and the scene of a run.

        Raises `ResultError` with the name of the recording if a quantity is invalid or missing, or
        contradicts another one.
        """
        name, scene = recording.name, recording.scene
        given = {
            key: given_in_si(name, key, getattr(self, key), unit) for key, unit in _UNITS.items()
        }
        left_out = LeftOut.of(name, self.leave_out, self.drift, self.fit_range)
        left_out.refuse_too_much(name, len(recording.times), recording.step)
        detector = self._detector(recording)
        poles, on_the_way = TrappedBead.poles, False
        if scene is not None:
            if not scene.forces.brownian:
                raise ResultError(
                    f"{name}: simulated without thermal motion, so there is nothing to calibrate"
                )
            from tweezer.optics.heat import heated  # loads Numba, which recordings do without

            scene = heated(scene)
            on_the_way = given["drag"] is None and self.wall is None
            mass, fluid = Inertia.of(scene).masses(scene)
            if given["displaced_mass"] is None:
                poles = scene.medium.poles or poles
            of_scene = {
                "temperature": scene.noise_temperature, "drag": bead_properties(scene).drag,
                "mass": mass, "displaced_mass": fluid, "radius": scene.bead.radius,
                "viscosity": scene.medium.viscosity,
            }  # fmt: skip
            given = {key: of_scene[key] if value is None else value for key, value in given.items()}
        elif given["drag"] is None:
            radius, viscosity = given["radius"], given["viscosity"]
            if radius is not None and viscosity is not None:
                given["drag"] = drag_of_translation(viscosity, radius)
        temperature = _checked(name, given)
        wall = None if self.wall is None else Height.of(name, self.wall, given["radius"])
        if wall is not None and given["displaced_mass"] is not None:
            _refuse_too_low(recording, wall)
        coldest, hottest = TEMPERATURE
        if not coldest <= temperature <= hottest:
            raise ResultError(
                f"{name}: temperature = {temperature:g}: must be from {coldest:g} to {hottest:g} K"
            )
        _refuse_detector(recording, detector)
        return Known(
            temperature, given["drag"], given["mass"], given["displaced_mass"], given["radius"],
            given["viscosity"], poles, wall, detector, left_out,
            _drags(recording, given["drag"], wall, on_the_way=on_the_way),
        )  # fmt: skip

    def _detector(self, recording: Recording) -> Detector:
        """Return the given detector, completed by exposure and noise of the recording."""
        asked = {"exposure": self.exposure, "diode_frequency": self.diode, "noise": self.noise}
        fitted = tuple(name for name, value in asked.items() if value == "fit")
        exposure, diode, noise = (None if value == "fit" else value for value in asked.values())
        exposed = given_in_si(recording.name, "exposure", exposure, "s")  # type: ignore[arg-type]
        pair = None if diode is None else _diode(recording.name, diode)
        level = given_in_si(recording.name, "noise", noise, recording.unit)  # type: ignore[arg-type]
        noises = dict.fromkeys(recording.axes, level or 0.0)
        if level is None and "noise" not in fitted and recording.noise is not None:
            level = recording.noise[0]
            noises = dict(zip(recording.axes, recording.noise, strict=True))
        if exposed is None and "exposure" not in fitted:
            exposed = recording.exposure
            if exposed is None and recording.scene is not None:
                exposed = 0.0
        if "diode_frequency" in fitted:
            fitted += ("diode_fraction",)
        return Detector(exposed, pair, level, noises, fitted)


def describes_gas(scene: Scene) -> bool:
    """Return whether a scene describes the gas about a bead, without a detector of its signals.

    Parameters
    ----------
    scene : Scene
        The scene.
    """
    return scene.medium.name in GASES and scene.detector is None


def given_in_si(recording: str, name: str, value: QuantityLike | None, unit: str) -> float | None:
    """Return an argument of a calibration in its SI unit; None if not given.

    Parameters
    ----------
    recording : str
        Name of the recording, for error messages.
    name : str
        Name of the argument.
    value : float, str or quantity, optional
        Its value.
    unit : str
        Its SI unit.
    """
    if value is None:
        return None
    return in_si(f"{recording}: {name}", value, unit, error=ResultError)


def _diode(
    recording: str, value: QuantityLike | tuple[QuantityLike, QuantityLike]
) -> tuple[float, float]:
    """Return the half-power frequency of a diode, Hz, and the fraction detected without delay.

    `value` is a frequency, or a frequency and a fraction, as numbers or text.
    """
    parts: Sequence[QuantityLike]
    if isinstance(value, str):
        parts = value.split(",")
    else:
        parts = value if isinstance(value, tuple) else (value,)
    if len(parts) > 2:
        raise ResultError(
            f"{recording}: diode = {value!r}: must be a frequency, optionally with the fraction "
            'from 0 to 1 that is detected without delay: "14 kHz, 0.3"'
        )
    frequency, fraction = (
        in_si(f"{recording}: diode", bare(part), unit, error=ResultError)
        for part, unit in zip((*parts, 0.0), ("1/s", ""), strict=False)
    )
    if frequency <= 0 or not 0 <= fraction < 1:
        raise ResultError(
            f"{recording}: diode = {value!r}: its frequency must be positive, and the fraction "
            "detected without delay from 0 to below 1"
        )
    return frequency, fraction


def _checked(name: str, given: dict[str, float | None]) -> float:
    """Return the temperature, K; raise `ResultError` for a missing or non-positive quantity.

    `given` contains the quantities in SI units by name. `name` is the name of the recording.
    """
    temperature = given["temperature"]
    if temperature is None:
        raise ResultError(f"{name}: requires the temperature of the medium")
    for key, value in given.items():
        if value is not None and value <= 0:
            raise ResultError(f"{name}: {key} = {value}: must be positive")
    if given["displaced_mass"] is not None and given["mass"] is None:
        raise ResultError(f"{name}: fluid inertia requires the bead's mass too")
    return temperature


def _refuse_detector(recording: Recording, detector: Detector) -> None:
    """Refuse an exposure longer than the sampling interval, and a negative noise."""
    exposure, noise, step = detector.exposure, detector.noise, recording.step
    if exposure is not None and not 0 <= exposure <= step * (1 + _UNEVEN):
        raise ResultError(
            f"{recording.name}: exposure = {exposure:g} s: must be from 0 to the "
            f"sampling interval, {most(step, 4)} s"
        )
    if noise is not None and noise < 0:
        raise ResultError(f"{recording.name}: noise = {noise:g}: must not be negative")


def _refuse_too_low(recording: Recording, height: Height) -> None:
    """Refuse a height at which the drag with fluid inertia is not known."""
    from tweezer.fluid import LOWEST

    for axis in recording.axes:
        way = "across" if axis == ACROSS else "along"
        if height.radii < LOWEST[way]:
            raise ResultError(
                f"{recording.name}: wall = {height.distance:g}: with fluid inertia, the drag "
                f"along {axis} ({way} the wall) is known only above {LOWEST[way]:g} radii; omit "
                "the displaced mass, or that column"
            )


def _drags(
    recording: Recording, drag: float | None, height: Height | None, *, on_the_way: bool
) -> dict[str, float]:
    """Return the known drags along the axes, kg/s.

    `drag` applies far from walls. If `on_the_way`, the drags are averages over the positions in a
    run, computed from its scene.
    """
    if drag is None:
        return {}
    if height is not None:
        return {axis: drag / height.mobility(axis) for axis in recording.axes}
    if not on_the_way or recording.scene is None:
        return dict.fromkeys(recording.axes, drag)
    from tweezer.fluid import drag as drag_of

    beside = drag_of(recording.scene)
    if beside.uniform:
        return dict.fromkeys(recording.axes, drag)
    if recording.axes != _EVERY_AXIS:  # the full position is not known
        return {}
    every = max(len(recording.positions) // _PLACES, 1)
    places = recording.positions[::every]
    mobilities = beside.mobilities(places).value.mean(axis=0)
    return {axis: 1 / float(mobilities[int(axis == ACROSS)]) for axis in recording.axes}
