"""The command calibrate."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import typer

from tweezer.cli.app import (
    Bead,
    Columns,
    FigureFile,
    JsonFile,
    Overwrite,
    Rate,
    Scale,
    Skip,
    app,
    quantity_in,
)
from tweezer.cli.console import (
    FAILED,
    OUT,
    show_warning,
    tell_written,
    writable_figure,
    writable_result,
    write_figure,
    write_result,
)
from tweezer.cli.free import print_free, print_tracks
from tweezer.cli.tables import print_table, table_of
from tweezer.values.errors import ResultError, SeveralBeadsError, TooFewError
from tweezer.values.printed import in_unit, pair, printed, with_error

if TYPE_CHECKING:
    from tweezer.calibration import (
        AxisCalibration,
        Calibration,
        Diffusion,
        Height,
        Surface,
        Together,
        Trajectory,
    )
    from tweezer.calibration.setup import Setup
    from tweezer.reading import Recording


Recordings = Annotated[
    list[str],
    typer.Argument(
        help="NetCDF file of a run; or a table with t, x, y, z: CSV, HDF5, .npy, .mat, TDMS. "
        "Recordings of one trap are combined.",
        metavar="RECORDING...",
    ),
]
Temperature = Annotated[
    str | None,
    typer.Option(help='Temperature of the medium, e.g. "20 degC". Default for a run: its own.'),
]
Radius = Annotated[
    str | None,
    typer.Option(help='Radius of the bead, e.g. "500 nm". Without it the drag is fitted.'),
]
Viscosity = Annotated[
    str | None,
    typer.Option(
        help='Viscosity of the medium, e.g. "1 mPa s". With --radius it gives the drag. For a '
        "free bead, one of the two determines the other."
    ),
]
Density = Annotated[
    str | None,
    typer.Option(
        help='Density of the bead, e.g. "2000 kg/m^3", to include its inertia. Requires --radius.'
    ),
]
FluidDensity = Annotated[
    str | None,
    typer.Option(
        help='Density of the medium, e.g. "998 kg/m^3", to include its inertia. Requires --density.'
    ),
]
Wall = Annotated[
    str | None,
    typer.Option(
        help='Distance of the bead\'s centre from a wall across the light, e.g. "1.2 um" or '
        '"1.2 um +- 50 nm". Requires --radius.',
        metavar="HEIGHT",
    ),
]
Focus = Annotated[
    str | None,
    typer.Option(
        help='Position of the focus in each RECORDING, larger farther from a wall: "0 um, 0.5 '
        'um, 1 um". The place of the wall is fitted.',
        metavar="POSITIONS",
    ),
]
FocalShift = Annotated[
    str | None,
    typer.Option(help="How far the bead moves by a unit of --focus, 1 if not given; or fit."),
]
Stage = Annotated[
    str | None,
    typer.Option(
        help="Heading of a column: the motion of the stage, which oscillates. Drag, and of "
        "volts the metres, are measured by it.",
        metavar="COLUMN",
    ),
]
Exposure = Annotated[
    str | None,
    typer.Option(
        "--blur", "--exposure",
        help='Time that each position is averaged over: "2 ms", up to the step; or fit.',
    ),
]  # fmt: skip
Diode = Annotated[
    str | None,
    typer.Option(
        help='Detector that is late: "14 kHz", where its power is halved; "14 kHz, 0.3", with '
        "the part that it detects at once; or fit."
    ),
]
Noise = Annotated[
    str | None,
    typer.Option(help='White noise of the detector, a standard deviation: "1 nm"; or fit.'),
]
LeaveOut = Annotated[
    list[str] | None,
    typer.Option(
        help='Frequencies that are taken out of the record: "49 Hz..51 Hz". May be repeated.',
        metavar="BAND",
    ),
]
Drift = Annotated[
    str | None,
    typer.Option(
        help='What is slower is taken off, as whole cosines: "0.5 Hz".', metavar="FREQUENCY"
    ),
]
FitRange = Annotated[
    str | None,
    typer.Option(help='Frequencies that spectra are fitted over: "10 Hz..10 kHz".', metavar="BAND"),
]
Report = Annotated[
    Path | None,
    typer.Option(help="Page with figures, numbers and what is not to be trusted: .html, .pdf."),
]


@app.command()
def calibrate(
    recordings: Recordings,
    temperature: Temperature = None, radius: Radius = None, viscosity: Viscosity = None,
    density: Density = None, fluid_density: FluidDensity = None, wall: Wall = None,
    focus: Focus = None, focal_shift: FocalShift = None, columns: Columns = None,
    rate: Rate = None, scale: Scale = None, bead: Bead = None, drive: Stage = None,
    blur: Exposure = None, diode: Diode = None, noise: Noise = None, leave_out: LeaveOut = None,
    drift: Drift = None, fit_range: FitRange = None, skip: Skip = "0", out: JsonFile = None,
    plot: FigureFile = None, report: Report = None, overwrite: Overwrite = False,
) -> None:  # fmt: skip
    """Determine trap stiffness from a RECORDING.

    Several methods use the thermal motion of the bead and its response to a drive. For a free bead
    the diffusion coefficient is determined. Exit code: 0 if every axis of each RECORDING has a
    number without a finding, 1 if an axis has none, 2 if the input is refused.
    """
    from tweezer.calibration.setup import Setup
    from tweezer.values import units

    kinds = {
        "temperature": (temperature, units.Temperature), "radius": (radius, units.BeadRadius),
        "viscosity": (viscosity, units.Viscosity), "density": (density, units.Density),
        "fluid-density": (fluid_density, units.Density),
    }  # fmt: skip
    given = {
        name: quantity_in(f"--{name}", text, kind)
        for name, (text, kind) in kinds.items()
        if text is not None
    }
    skipped = quantity_in("--skip", skip, units.Time)
    exposed: float | str | None = blur
    if blur not in (None, "fit"):
        exposed = quantity_in("--blur", blur, units.Time)
    out = out and writable_result(out, ("json",), overwrite=overwrite)
    plot = writable_figure(plot, overwrite=overwrite)
    report = report and writable_result(
        report, ("html", "pdf"), overwrite=overwrite, option="--report"
    )
    if plot and len(recordings) > 1:
        raise ResultError(f"--plot draws one recording, not {len(recordings)}")
    if report and len(recordings) > 1:
        raise ResultError(f"--report tells of one recording, not {len(recordings)}")
    focuses = _focuses(focus, focal_shift, len(recordings))
    if focuses.positions and "fluid-density" in given:
        raise ResultError("--focus: without the inertia of the fluid; leave out --fluid-density")
    setup = Setup(
        temperature=given.get("temperature"), wall=units.bare(wall), radius=given.get("radius"),
        viscosity=given.get("viscosity"), exposure=exposed, diode=diode, noise=units.bare(noise),
        leave_out=leave_out or (), drift=drift, fit_range=fit_range,
    )  # fmt: skip
    loaded, tracks, few = _loaded(
        recordings, drive, skipped,
        {"columns": columns, "rate": rate, "scale": scale, "bead": bead},
        (wall, focus, density, drive, diode, leave_out, drift, fit_range, plot, report),
    )  # fmt: skip
    if tracks:
        _calibrate_tracks(tracks, few, setup, out)
        return
    asked = [name for name, value in (("--wall", wall), ("--focus", focus)) if value is not None]
    if len(asked) > 1:
        raise ResultError("--wall gives what --focus finds; must be one of them")
    for each in loaded:
        _check_known(each, given, asked)
    _calibrate_traps(loaded, _with_masses(setup, given), focuses, out, plot, report)


class _Focuses(NamedTuple):
    """Positions of the focus above a wall."""

    positions: list[float]
    """m, one for each recording; none without --focus"""
    shift: float | None
    """by how much the bead moves with it; None if that is fitted"""


def _with_masses(setup: Setup, given: dict[str, float]) -> Setup:
    """Return the setup with the masses of the bead and of the fluid in its place."""
    volume = 4 / 3 * math.pi * given.get("radius", 0.0) ** 3
    bead, fluid = (
        given[name] * volume if name in given else None for name in ("density", "fluid-density")
    )
    return dataclasses.replace(setup, mass=bead, displaced_mass=fluid)


def _loaded(
    paths: list[str],
    drive: str | None,
    skipped: float,
    how: dict[str, Any],
    of_traps: Sequence[object],
) -> tuple[list[Recording], list[Trajectory], ResultError | None]:
    """Return recordings of traps; or tracks of free beads, and why the last one is no recording.

    `of_traps` are the values of options that tracks do not take: with one of them, what is no
    recording is refused.
    """
    from tweezer.calibration import Trajectory, load_trajectories
    from tweezer.reading import load_recording

    loaded: list[Recording] = []
    tracks: list[Trajectory] = []
    few = None
    for path in paths:
        try:
            loaded.append(load_recording(path, drive, **how).since(skipped))
        except (TooFewError, SeveralBeadsError) as error:
            if any(option is not None for option in of_traps):
                raise
            few = error
            tracks += [track.since(skipped) for track in load_trajectories(path, **how)]
    return loaded, [*tracks, *map(Trajectory.of, loaded)] if tracks else [], few


def _calibrate_tracks(
    tracks: list[Trajectory], few: ResultError | None, setup: Setup, out: Path | None
) -> None:
    """Print and write the common diffusion of tracks."""
    common = _diffusion(tracks, setup)
    print_tracks(common, tracks, few)
    for note in dict.fromkeys(track.note for track in tracks if track.note):
        show_warning(note)
    if out:
        write_result({"diffusion": dataclasses.asdict(common)}, out)
    tell_written(out)
    if common.findings:
        raise typer.Exit(FAILED)


def _calibrate_traps(
    loaded: list[Recording],
    setup: Setup,
    focuses: _Focuses,
    out: Path | None,
    plot: Path | None,
    report: Path | None,
) -> None:
    """Print, draw and write calibrations and the mean of several recordings."""
    from tweezer.calibration import Trajectory, find_wall, together
    from tweezer.calibration.calibration import calibrated

    several, places = len(loaded) > 1, focuses.positions
    calibrations = []
    for each in loaded:
        with_drag = dataclasses.replace(setup, viscosity=None) if places else setup
        calibrations.append(calibrated(each, with_drag))
        if several:
            OUT.print(f"{each.name}:", highlight=False, soft_wrap=True)
        _print_calibration(calibrations[-1])
    put_together = together(calibrations) if several and not places else ()
    free = surface = None
    if several and not places and all(map(_is_free, calibrations)):
        tracks = [*map(Trajectory.of, loaded)]
        free = _diffusion(tracks, setup)
        print_tracks(free, tracks, None)
    if places:
        from tweezer.scene.sphere import drag_of_translation

        assert isinstance(setup.radius, float)
        assert isinstance(setup.viscosity, float)
        drag = drag_of_translation(setup.viscosity, setup.radius)
        surface = find_wall(
            calibrations, places, radius=setup.radius, drag=drag, shift=focuses.shift
        )
        _print_surface(surface, calibrations, places)
    if put_together:
        _print_together(calibrations, put_together)
    if out:
        written = [dataclasses.asdict(each) for each in calibrations]
        every = [dataclasses.asdict(each) for each in put_together]
        result = {"recordings": written, "together": every} if every else written[0]
        if free:
            result = {"recordings": written, "diffusion": dataclasses.asdict(free)}
        if surface:
            result = {"recordings": written, "surface": dataclasses.asdict(surface)}
        write_result(result, out)
    if plot:
        from tweezer.plots import calibration_figure

        write_figure(calibration_figure(loaded[0], calibrations[0]), plot)
    if report:
        from tweezer.plots.report import write_report

        write_report(loaded[0], calibrations[0], report)
    tell_written(out, plot, report)
    refuted = any(each is not None and each.findings for each in (surface, free))
    if refuted or not all(each.determined for each in calibrations):
        raise typer.Exit(FAILED)


def _is_free(calibration: Calibration) -> bool:
    """Return whether no trap is detected along any axis."""
    free = calibration.free
    return free is not None and len(free.axes) == len(calibration.axes)


def _diffusion(tracks: list[Trajectory], setup: Setup) -> Diffusion:
    """Return the common diffusion coefficient of tracks, with the given values of the beads."""
    from tweezer.calibration import diffusion

    exposure, noise = (None if each == "fit" else each for each in (setup.exposure, setup.noise))
    return diffusion(
        tracks, temperature=setup.temperature, radius=setup.radius, viscosity=setup.viscosity,
        exposure=exposure, noise=noise,
    )  # fmt: skip


def _focuses(focus: str | None, shift: str | None, recordings: int) -> _Focuses:
    """Return the positions of the focus in that number of recordings."""
    from tweezer.values.units import Length, bare

    if focus is None:
        if shift is not None:
            raise ResultError("--focal-shift: requires --focus")
        return _Focuses([], 1.0)
    places = [quantity_in("--focus", each, Length) for each in focus.split(",")]
    if len(places) != recordings:
        raise ResultError(
            f"--focus {focus!r}: has {len(places)} positions; must be {recordings}, one for each "
            "recording"
        )
    factor = None if shift == "fit" else bare(shift or "1")
    if factor is not None and not (isinstance(factor, float) and 0 < factor < math.inf):
        raise ResultError(f"--focal-shift {shift!r}: must be a positive number, or fit")
    return _Focuses(places, factor)


def _check_known(loaded: Recording, given: dict[str, float], beside: list[str]) -> None:
    """Refuse what does not go together, or with that recording.

    beside: options of a wall that are given.
    """
    for option in beside:
        if loaded.scene is not None:
            raise ResultError(f"{loaded.name}: its scene has the wall; {option} is not for a run")
        if not {"radius", "viscosity"} <= set(given):
            raise ResultError(f"{loaded.name}: {option} needs --radius and --viscosity")
    if loaded.scene is not None and given:
        raise ResultError(
            f"{loaded.name}: its scene has the {', the '.join(given)}; not to be given"
        )
    if loaded.scene is None and "temperature" not in given:
        raise ResultError(
            f"{loaded.name}: needs --temperature, and --radius and --viscosity if known"
        )
    if "density" in given and not {"radius", "viscosity"} <= set(given):
        raise ResultError(f"{loaded.name}: --density needs --radius and --viscosity")
    if ("fluid-density" in given) > ("density" in given):
        raise ResultError(f"{loaded.name}: --fluid-density needs --density")


def _print_calibration(calibration: Calibration) -> None:
    free = calibration.free
    if free is not None:
        print_free(free, calibration.unit)
    for axis in calibration.axes:
        if free is None or axis.axis not in [each.axis for each in free.axes]:
            _print_trapped(axis, calibration.unit)
        if calibration.wall is not None and axis.drag is not None:
            _print_wall(calibration.wall, axis)
    if calibration.note:
        show_warning(calibration.note)


def _print_wall(wall: Height, axis: AxisCalibration) -> None:
    """What is known of the drag by the height, and what the record tells."""
    known = axis.drag
    assert known is not None
    ratio = 1 / wall.mobility(axis.axis)
    error = wall.relative_uncertainty(axis.axis)
    drag = with_error(known, known * error if error else None, "nN s/m")
    way = "across" if axis.fit.bead.across else "along"
    OUT.print(
        f"{printed(wall.distance, 'um')} from the wall, {way} it: drag {drag}, {ratio:.4g} times "
        "that far away",
        highlight=False, soft_wrap=True,
    )  # fmt: skip


def _print_trapped(axis: AxisCalibration, unit: str) -> None:
    """A table of estimates, and below it numbered notes on what speaks against them."""
    from tweezer.calibration.wording import axis_in_words

    print_table(axis.table())
    notes = [finding.text for finding in axis.listed]
    for number, note in enumerate(notes, 1):
        OUT.print(f" {number}  {note}", highlight=False, soft_wrap=True)
    for line in axis_in_words(axis, unit, notes):
        OUT.print(line, highlight=False, soft_wrap=True)


def _print_together(calibrations: list[Calibration], every: tuple[Together, ...]) -> None:
    """A table over recordings, and their means."""
    from tweezer.calibration.together import QUANTITIES

    metric = any(each.unit != "V" for each in calibrations)
    units = {"stiffness": "pN/um", "drag": "nN s/m", "sensitivity": "" if metric else "um/V"}
    for each in every:
        unit = units[each.quantity]
        table = table_of(f"{each.axis}: {each.quantity}", unit, "+-", "")
        for calibration in calibrations:
            for axis in calibration.axes:
                found = QUANTITIES[each.quantity](axis) if axis.axis == each.axis else None
                if found:
                    judgement = "" if calibration.name in each.recordings else "not trusted"
                    numbers = pair(*found, unit)
                    table.add_row(calibration.name, *numbers, judgement)
        if each.mean is not None and each.uncertainty is not None:
            mean = pair(each.mean, each.uncertainty, unit)
            table.add_row("together", *mean, f"p = {each.p_value:.2g}")
        OUT.print(table)
        for finding in each.findings:
            OUT.print(finding.text, highlight=False, soft_wrap=True)


def _print_surface(surface: Surface, calibrations: list[Calibration], places: list[float]) -> None:
    """A table of heights, and where the wall is."""
    table = table_of("height by the drag", "focus, um", "height, um", "+-", "")
    for each, place, height in zip(calibrations, places, surface.heights, strict=True):
        numbers = pair(height.distance, height.uncertainty, "um")
        judgement = "" if each.name in surface.recordings else "not trusted"
        table.add_row(each.name, in_unit(place, "um"), *numbers, judgement)
    OUT.print(table)
    wall = with_error(surface.position, surface.uncertainty, "um")
    line = f"the bead's centre would be in the wall with the focus at {wall}"
    if surface.shift_uncertainty is not None:
        shift = with_error(surface.shift, surface.shift_uncertainty, "")
        line += f"; it moves by {shift} of the focus"
    if surface.p_value is not None:
        line += f"; p = {surface.p_value:.2g}"
    OUT.print(line, highlight=False, soft_wrap=True)
    for finding in surface.findings:
        OUT.print(finding.text, highlight=False, soft_wrap=True)
