"""Calibration of a trap from a recording of thermal motion: stiffness, drag and sensitivity."""

from __future__ import annotations

import dataclasses
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from scipy.linalg import LinAlgWarning

from tweezer.calibration import digits
from tweezer.calibration.answers import KnownDrag
from tweezer.calibration.axis import along
from tweezer.calibration.by_axis import ByAxis
from tweezer.calibration.driving import Drive
from tweezer.calibration.fits import Record
from tweezer.calibration.free import Diffusion, Given, not_trapped
from tweezer.calibration.inertia import Inertia
from tweezer.calibration.results import AxisCalibration, Calibration
from tweezer.calibration.setup import Known, Setup, describes_gas
from tweezer.calibration.wall import Height
from tweezer.reading.recording import Recording, load_recording
from tweezer.scene import SceneLike, checked_scene
from tweezer.values.errors import ResultError
from tweezer.values.units import QuantityLike

if TYPE_CHECKING:
    import xarray as xr


def calibrate(
    source: Recording | xr.Dataset | str | Path,
    *,
    scene: SceneLike | None = None,
    temperature: QuantityLike | None = None,
    drag: QuantityLike | None = None,
    mass: QuantityLike | None = None,
    displaced_mass: QuantityLike | None = None,
    wall: QuantityLike | tuple[QuantityLike, QuantityLike] | None = None,
    radius: QuantityLike | tuple[QuantityLike, QuantityLike] | None = None,
    viscosity: QuantityLike | None = None,
    exposure: QuantityLike | None = None,
    diode: QuantityLike | tuple[QuantityLike, QuantityLike] | None = None,
    noise: QuantityLike | None = None,
    drive: str | None = None,
    leave_out: Sequence[str | tuple[float, float]] = (),
    drift: QuantityLike | None = None,
    fit_range: str | tuple[float, float] | None = None,
    pressure: QuantityLike | tuple[QuantityLike, QuantityLike] | None = None,
    density: QuantityLike | tuple[QuantityLike, QuantityLike] | None = None,
) -> Calibration:
    """Return the trap stiffness along each axis of a recording, by several methods.

    The recording is tested first (`tweezer.calibration.findings`). Its findings apply to every
    number of the axis. The methods are:

    * Equipartition: k_B T divided by the variance, corrected for the exposure and for the
      subtracted mean. The uncertainty follows from the sum of the ordinates of the spectrum.
    * Power spectrum: the expected periodogram of the sampled bead (`TrappedBead.sampled_spectrum`,
      with aliases and leakage, and with inertia if masses are given). It is fitted by maximum
      likelihood for exponentially distributed ordinates (P. Whittle, Ark. Mat. 2, 423 (1953)), with
      the drag given and with the drag fitted. The uncertainties follow from Fisher's information,
      and the p-value from Bartlett's test (Kolmogorov and Smirnov).
    * Displacement and autocorrelation: least squares over ten lags, from 0.1 to 2 relaxation times,
      weighted with the covariance of these averages for Gaussian motion (M. S. Bartlett, J. R.
      Stat. Soc. Suppl. 8, 27 (1946)). The autocorrelation uses only the rate of decay. It requires
      a drag but no temperature.
    * Potential: `potential`, with the corrections of equipartition.

    Along axes on which no trap is detected, the bead is treated as free. `Calibration.free`
    contains its diffusion coefficient and the quantity that follows from it: the viscosity, the
    radius or Boltzmann's constant, whichever is not given.

    If `scene` describes a bead in a named gas (`medium.name`), without a detector, the bead is an
    oscillator. The spectrum of each axis determines its resonance frequency Omega, damping rate
    Gamma and variance, by the exact spectrum of the samples and maximum likelihood. With the drag
    beta of the gas (`tweezer.medium`), the mass is m = beta/Gamma and the stiffness m Omega^2.
    Equipartition, <x^2> = k_B T/(m Omega^2), gives the displacement sensitivity. For a recording in
    metres, it tests the mass. `Calibration.levitated` contains mass, density and radius of the
    bead, and `AxisCalibration.resonance` the line of each axis.

    `tweezer bench calibrate` measures how often the confidence intervals contain the true value.

    Parameters
    ----------
    source : Recording, xarray.Dataset, str or Path
        A recording, or a source for `load_recording`.
    scene : Scene, str or mapping, optional
        Scene with the detector that recorded the signals x, y and z of `source`: a run with
        `signal`, or a table in volts, where z is all of the light. Signals are converted to
        positions by wave optics, beyond the range in which they are linear
        (`tweezer.calibration.by_detector`). The scene also gives temperature, radius and viscosity.
        A scene with a named gas, without a detector, describes the gas about an oscillating bead.
    temperature : float or str, optional
        Temperature of the medium, K. This and the following values default to the scene for a run
        of tweezer.
    drag : float or str, optional
        Drag coefficient beta, kg/s. For a run beside a wall it follows from the mean mobility.
    mass : float or str, optional
        Mass of the bead, kg. For a run it follows from the model and `medium.inertia`: no mass
        without inertia, m/a2 in the scaled model, and m + m_f/2 with an added mass.
    displaced_mass : float or str, optional
        Mass of the displaced fluid, kg, for hydrodynamic memory (`TrappedBead`). Requires `mass`.
    wall : float, str or pair, optional
        Distance of the bead centre from a wall perpendicular to the beam, m, optionally with its
        standard uncertainty, "1.2 um +- 50 nm". Requires `radius`. `drag` is then the drag far from
        the wall. The exact mobility parallel to the wall applies to x and y, and the perpendicular
        mobility to z. If the height is uncertain, so is the drag, and the spectral fit determines
        it too. With fluid inertia the drag includes the flow that the wall reflects
        (`tweezer.fluid.reflection`), above 1.5 radii for x and y, and above 2 radii for z.
    radius : float or str, optional
        Radius of the bead, m. In a gas it may have a standard uncertainty, "75 nm +- 3 %".
    viscosity : float or str, optional
        Viscosity of the medium, Pa s. With `radius` it sets the drag.
    exposure : float or str, optional
        Exposure time of each position, s, from 0 to the sampling interval, or "fit". If it is not
        given, 0 is assumed, and a finding reports motion blur that is present or possible. For a
        run, exposure and noise default to the scene's camera, and to 0 without a camera.
    diode : float, str or pair, optional
        Photodiode response: half-power frequency f_3 of the delayed part, Hz, optionally with the
        fraction a that is detected without delay; or "fit".
    noise : float or str, optional
        Standard deviation of the white detector noise, in the unit of the recording, or "fit". A
        value to fit is determined with its uncertainty, or reported as not determined.
    drive : str, optional
        Heading of the column with the position of the stage, m, which may oscillate in any way
        (active calibration, `tweezer.calibration.driving`). One fit then determines stiffness, drag
        and displacement sensitivity from the spectrum and the responses. For a recording in volts
        the displacement sensitivity is always fitted, which requires the drag or a drive.
    leave_out : sequence of str or pair, optional
        Frequency bands to remove from the recording, "49 Hz..51 Hz" or two numbers, Hz. The
        results are corrected for the motion of the bead that this and `drift` remove
        (`tweezer.calibration.left_out`).
    drift : float or str, optional
        Frequency below which drift is removed, Hz.
    fit_range : str or pair, optional
        Frequency range of the spectral fits, "10 Hz..10 kHz" or two numbers, Hz. The other methods
        use all frequencies.
    pressure : float, str or pair, optional
        Pressure of the gas, Pa, optionally with its standard uncertainty, "10 mbar +- 5 %".
        Default: that of the scene.
    density : float, str or pair, optional
        Density of a bead in gas, kg/m^3, optionally with its standard uncertainty. The recording
        then determines its radius, instead of its density from the radius.

    Returns
    -------
    Calibration
        Stiffness of each axis by each method, with uncertainties and findings.

    Raises
    ------
    ResultError
        Without a temperature, for an exposure longer than the sampling interval, for a source that
        `load_recording` refuses, for a bead in the wall, and for a run without thermal motion. In a
        gas, for an overdamped bead, and for a recording shorter than 30 damping times 1/Gamma.

    Examples
    --------
    >>> thermal = {"forces": {"brownian": True}, "simulation": {"model": "overdamped"}}
    >>> run = tweezer.simulate(tweezer.load_scene("silica-1um").replace(**thermal), "20 ms")
    >>> found = tweezer.calibrate(tweezer.load_recording(run).since("2 ms"))
    >>> 7e-5 < found.axes["x"]["power spectrum"].stiffness < 14e-5  # N/m
    True
    """
    described = None if scene is None else checked_scene(scene)
    gas = described if described is not None and describes_gas(described) else None
    signals = described is not None and gas is None
    recording = (
        source if isinstance(source, Recording) else load_recording(source, drive, signals=signals)
    )
    if isinstance(source, Recording) and drive is not None:
        raise ResultError(
            f"{recording.name}: `drive` applies only when a file is read; this `Recording` has its "
            "own drive"
        )
    setup = Setup(
        temperature=temperature, drag=drag, mass=mass, displaced_mass=displaced_mass, wall=wall,
        radius=radius, viscosity=viscosity, exposure=exposure, diode=diode, noise=noise,
        leave_out=leave_out, drift=drift, fit_range=fit_range, pressure=pressure,
        density=density, gas=gas,
    )  # fmt: skip
    if described is not None and gas is None:  # wave optics takes long to import
        from tweezer.calibration.by_detector import completed, from_signals

        recording = from_signals(recording, described)
        if recording.scene is None:
            setup = completed(setup, described)
    return calibrated(recording, setup)


def calibrated(recording: Recording, setup: Setup) -> Calibration:
    """Return the calibration of a recording, with bead, medium, wall and detector from `setup`."""
    if recording.unit == "W":
        raise ResultError(
            f"{recording.name}: in watts: requires --scene, the scene with the detector"
        )
    Inertia.refuse_relaxing(recording.scene)
    if setup.gas is not None:
        from tweezer.calibration.in_gas import in_gas  # loads Numba

        return in_gas(recording, setup)
    for key in ("pressure", "density"):
        if getattr(setup, key) is not None:
            raise ResultError(
                f"{recording.name}: {key}: requires the scene of a bead in a named gas, without a "
                "detector"
            )
    known = setup.of(recording)
    records = _records(recording, known)
    axes: dict[str, AxisCalibration] = {}
    for record in records:
        beside = record.beside
        # a record in volts without drag or drive uses the drag fitted along the first axis
        if axes and not record.answers and recording.unit == "V" and known.drag is None:
            beside = (_told_by(next(iter(axes.values())), record.axis, known.wall),)
        if record.axis in known.drags and known.wall is not None and not known.exact:
            uncertain = known.wall.relative_uncertainty(record.axis)
            beside = (*beside, KnownDrag(known.drags[record.axis], uncertain))
        try:
            with (
                warnings.catch_warnings(action="error", category=LinAlgWarning),
                np.errstate(divide="raise", over="raise", invalid="raise"),
            ):
                axes[record.axis] = along(dataclasses.replace(record, beside=beside))
        except (ArithmeticError, ValueError, np.linalg.LinAlgError, LinAlgWarning):
            raise ResultError(
                f"{recording.name}: {record.axis}: the signal is not that of a trapped bead; "
                "it may be noise, or another quantity"
            ) from None
    in_order = ByAxis(axes[axis] for axis in recording.axes)
    detector = known.detector
    return Calibration(
        recording.name, known.temperature, known.drag, known.mass, known.displaced_mass,
        detector.exposure, detector.diode, detector.noise, recording.unit,
        len(records[0].signal), recording.step, recording.note, in_order, known.wall,
        _free(recording, known, records, in_order), known.left_out, known.radius, known.viscosity,
    )  # fmt: skip


def _records(recording: Recording, known: Known) -> list[Record]:
    """Return the record of each axis; driven axes come first, because they determine the drag."""
    drive = None
    if recording.drive is not None:
        drive = Drive.of(recording.drive, recording.step)
        if drive is None:
            raise ResultError(
                f"{recording.name}: the drive does not oscillate; it must be the column of a "
                "moving stage"
            )
    if recording.unit == "V" and known.drag is None and drive is None:
        raise ResultError(
            f"{recording.name}: in volts: requires the drag, or the motion of the stage that "
            "drives the bead"
        )
    unmeasured = digits.of_samples(recording.positions) if recording.scene is None else ()
    records = []
    for axis, signal in zip(recording.axes, recording.positions.T, strict=True):
        # signal without responses to the stage, the responses, frequencies of the sensor's noise
        still, answers, unfollowed = drive.answers(signal) if drive else (signal, (), ())
        records.append(
            Record(recording, axis, known, still, answers, drive, unfollowed, unmeasured)
        )
    if drive and not any(each.answers for each in records):
        raise ResultError(f"{recording.name}: no axis follows the drive")
    return sorted(records, key=lambda each: not each.answers)


def _told_by(other: AxisCalibration, axis: str, height: Height | None) -> KnownDrag:
    """Return the drag along `axis` as evidence for a fit, from the calibration of another axis.

    Beside a wall, at the known height, the drags along two axes differ by the ratio of mobilities.
    """
    fit = other.free_fit
    assert fit.drag_uncertainty is not None
    ratio = 1.0 if height is None else height.mobility(other.axis) / height.mobility(axis)
    return KnownDrag(ratio * fit.bead.drag, fit.drag_uncertainty / fit.bead.drag)


def _free(
    recording: Recording, known: Known, records: list[Record], axes: ByAxis[AxisCalibration]
) -> Diffusion | None:
    """Return the diffusion along the axes on which no trap is detected, or None if all have one.

    `known` contains bead, medium and detector, and `axes` the calibrations with their findings.
    Findings about the samples of `recording` are included.
    """
    detector, left, drag = known.detector, known.left_out, known.drag
    mobilities = (
        {axis: drag / beside for axis, beside in known.drags.items()} if drag is not None else {}
    )
    given = Given(
        known.temperature, known.radius, known.viscosity, drag, detector.exposure,
        {} if detector.noise is None else detector.noises, mobilities, recording.unit,
        (*left.bands, (0.0, left.drift), *left.of_fit),
    )  # fmt: skip
    signals = {each.axis: each.signal for each in records}
    free = not_trapped(
        recording.name, {each.axis: each.findings for each in axes},
        np.stack([signals[axis] for axis in recording.axes], axis=1), recording.step, given,
    )  # fmt: skip
    unmeasured = records[0].unmeasured
    if free is None or not unmeasured:
        return free
    return dataclasses.replace(free, findings=tuple(digits.first(unmeasured, free.findings)))


def in_metres(recording: Recording, calibration: Calibration) -> Recording:
    """Return the recording as it was calibrated: in metres, without drift and excluded bands.

    Responses of the bead to a drive are removed, too.

    Parameters
    ----------
    recording : Recording
        Recording that was calibrated.
    calibration : Calibration
        Its calibration.
    """
    moved = None if recording.drive is None else Drive.of(recording.drive, recording.step)
    columns = [
        (axis.sensitivity or 1.0)
        * calibration.left_out.without(
            moved.answers(signal)[0] if moved else signal, recording.step
        )
        for axis, signal in zip(calibration.axes, recording.positions.T, strict=True)
    ]
    return dataclasses.replace(
        recording, times=recording.times[: len(columns[0])], positions=np.stack(columns, axis=1),
        unit="m", drive=None,
    )  # fmt: skip
