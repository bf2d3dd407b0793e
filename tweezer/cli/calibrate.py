"""The command `tweezer calibrate`."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import typer

from tweezer.cli.app import (
    Bead,
    Changes,
    Columns,
    Details,
    FigureFile,
    JsonFile,
    Overwrite,
    Quiet,
    Rate,
    Scale,
    Skip,
    app,
    quantity_in,
    scene_with,
    settings_of,
)
from tweezer.cli.completion import complete_scene
from tweezer.cli.console import (
    FAILED,
    OUT,
    begin,
    show_warning,
    tell_written,
    writable_figure,
    writable_result,
    write_figure,
    write_result,
)
from tweezer.cli.tables import print_parts
from tweezer.values.errors import ResultError, SeveralBeadsError, TooFewError

if TYPE_CHECKING:
    from tweezer.calibration import Diffusion, Trajectory
    from tweezer.calibration.setup import Setup
    from tweezer.reading import Recording
    from tweezer.scene import Scene

#: Smallest number of frames in each track for which trapped beads must be calibrated one by one
_LONG = 100

Recordings = Annotated[
    list[str],
    typer.Argument(
        help="NetCDF file of a run, or a table with t, x, y, z (CSV, HDF5, .npy, .mat, TDMS). "
        "Recordings of one trap are combined.",
        metavar="RECORDING...",
    ),
]
OfDetector = Annotated[
    str | None,
    typer.Option(
        help="Scene with the detector that recorded the signals x, y and z, to convert them to "
        "positions by wave optics; or of a bead in a named gas, to determine its mass.",
        metavar="SCENE",
        autocompletion=complete_scene,
    ),
]
Temperature = Annotated[
    str | None,
    typer.Option(help='Temperature of the medium, e.g. "20 degC". Default for a run: its own.'),
]
Radius = Annotated[
    str | None,
    typer.Option(
        help='Radius of the bead, e.g. "500 nm". Without it the drag is fitted. In a gas '
        'optionally with its uncertainty, "75 nm +- 3 %".'
    ),
]
Viscosity = Annotated[
    str | None,
    typer.Option(
        help='Viscosity of the medium, e.g. "1 mPa s". With --radius it sets the drag. For a '
        "free bead, give either one to determine the other."
    ),
]
Density = Annotated[
    str | None,
    typer.Option(
        help='Density of the bead, e.g. "2000 kg/m^3", to include its inertia. Requires --radius. '
        "In a gas it determines the radius instead."
    ),
]
Pressure = Annotated[
    str | None,
    typer.Option(
        help='Pressure of the gas of --scene, e.g. "10 mbar" or "10 mbar +- 5 %". Default: that of '
        "the scene.",
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
        help='Distance of the bead\'s centre from a wall normal to the light, e.g. "1.2 um" '
        'or "1.2 um +- 50 nm". Requires --radius.',
        metavar="HEIGHT",
    ),
]
Focus = Annotated[
    str | None,
    typer.Option(
        help='Position of the focus in each RECORDING, increasing away from a wall, e.g. "0 um, '
        '0.5 um, 1 um". The position of the wall is fitted.',
        metavar="POSITIONS",
    ),
]
FocalShift = Annotated[
    str | None,
    typer.Option(help='Displacement of the bead per unit of --focus, or "fit". Default: 1.'),
]
Stage = Annotated[
    str | None,
    typer.Option(
        help="Heading of the column with the motion of an oscillating stage. It determines the "
        "drag and, for positions in volts, the displacement sensitivity.",
        metavar="COLUMN",
    ),
]
Exposure = Annotated[
    str | None,
    typer.Option(
        "--blur", "--exposure",
        help='Exposure time of each position, e.g. "2 ms", or "fit". At most the sampling '
        "interval.",
    ),
]  # fmt: skip
Diode = Annotated[
    str | None,
    typer.Option(
        help='Photodiode response: half-power frequency, e.g. "14 kHz"; with the fraction detected '
        'without delay, e.g. "14 kHz, 0.3"; or "fit".'
    ),
]
Noise = Annotated[
    str | None,
    typer.Option(help='Standard deviation of the detector noise, e.g. "1 nm", or "fit".'),
]
LeaveOut = Annotated[
    list[str] | None,
    typer.Option(
        help='Frequency band to remove from the recording, e.g. "49 Hz..51 Hz". May be repeated.',
        metavar="BAND",
    ),
]
Drift = Annotated[
    str | None,
    typer.Option(
        help='Remove drift below this frequency, as whole cosines, e.g. "0.5 Hz".',
        metavar="FREQUENCY",
    ),
]
FitRange = Annotated[
    str | None,
    typer.Option(
        help='Frequency range of the spectral fits, e.g. "10 Hz..10 kHz".', metavar="BAND"
    ),
]
Report = Annotated[
    Path | None,
    typer.Option(help="Page to write (html, pdf), with figures, numbers and findings."),
]


@app.command()
def calibrate(
    recordings: Recordings,
    scene: OfDetector = None,
    set: Changes = None,
    temperature: Temperature = None, radius: Radius = None, viscosity: Viscosity = None,
    density: Density = None, fluid_density: FluidDensity = None, pressure: Pressure = None,
    wall: Wall = None,
    focus: Focus = None, focal_shift: FocalShift = None, columns: Columns = None,
    rate: Rate = None, scale: Scale = None, bead: Bead = None, drive: Stage = None,
    blur: Exposure = None, diode: Diode = None, noise: Noise = None, leave_out: LeaveOut = None,
    drift: Drift = None, fit_range: FitRange = None, skip: Skip = "0", out: JsonFile = None,
    plot: FigureFile = None, report: Report = None, overwrite: Overwrite = False,
    details: Details = False, quiet: Quiet = False,
) -> None:  # fmt: skip
    """Determine trap stiffness from a RECORDING.

    Several methods use the thermal motion of the bead and its response to a drive. For a free bead
    the command determines the diffusion coefficient. Exit code: 0 if every axis of each RECORDING
    has a result without findings, 1 if an axis has none, 2 if the input is refused.
    """
    begin(details=details, quiet=quiet)
    if set and scene is None:
        raise ResultError("--set: requires --scene")
    from tweezer.calibration.setup import Setup
    from tweezer.values import units

    described, gas = _described(scene, set)
    of_gas = _of_gas(gas, radius, density, pressure, fluid_density)
    given = {
        name: quantity_in(f"--{name}", text, kind)
        for name, text, kind in (
            ("temperature", temperature, units.Temperature), ("radius", radius, units.BeadRadius),
            ("viscosity", viscosity, units.Viscosity), ("density", density, units.Density),
            ("fluid-density", fluid_density, units.Density),
        )
        if text is not None and name not in of_gas
    }  # fmt: skip
    skipped = quantity_in("--skip", skip, units.Time)
    exposed = blur if blur in (None, "fit") else quantity_in("--blur", blur, units.Time)
    out = out and writable_result(out, ("json",), overwrite=overwrite)
    plot = writable_figure(plot, overwrite=overwrite)
    report = report and writable_result(
        report, ("html", "pdf"), overwrite=overwrite, option="--report"
    )
    if plot and len(recordings) > 1:
        raise ResultError(f"--plot applies to one recording, not {len(recordings)}")
    if report and len(recordings) > 1:
        raise ResultError(f"--report applies to one recording, not {len(recordings)}")
    focuses = _focuses(focus, focal_shift, len(recordings))
    if focuses.positions and "fluid-density" in given:
        raise ResultError("--focus: cannot be combined with --fluid-density; omit one of them")
    setup = Setup(
        temperature=given.get("temperature"), wall=units.bare(wall),
        viscosity=given.get("viscosity"), exposure=exposed, diode=diode, noise=units.bare(noise),
        leave_out=leave_out or (), drift=drift, fit_range=fit_range, gas=gas,
        **({"radius": given.get("radius")} | of_gas), **_masses(given),
    )  # fmt: skip
    loaded, tracks, few = _loaded(
        recordings, drive, skipped,
        {"columns": columns, "rate": rate, "scale": scale, "bead": bead}
        | ({"signals": True} if described and not gas else {}),
        (scene, wall, focus, density, drive, diode, leave_out, drift, fit_range, plot, report),
    )  # fmt: skip
    if described is not None and gas is None:
        from tweezer.calibration.by_detector import completed, from_signals

        loaded = [from_signals(each, described) for each in loaded]
        if all(each.scene is None for each in loaded):
            setup = completed(setup, described)
            keys = ("temperature", "radius", "viscosity")
            given |= {key: getattr(setup, key) for key in keys}
    if tracks:
        _calibrate_tracks(tracks, few, setup, out)
        return
    asked = [name for name, value in (("--wall", wall), ("--focus", focus)) if value is not None]
    if len(asked) > 1:
        raise ResultError(
            "--wall: cannot be combined with --focus, which determines the wall; omit one of them"
        )
    for each in loaded if gas is None else ():
        _check_known(each, given, asked)
    _calibrate_traps(loaded, setup, focuses, out, plot, report)


class _Focuses(NamedTuple):
    """Options on the position of the focus above a wall."""

    positions: list[float]
    """focus position of each recording, m; empty without --focus"""
    shift: float | None
    """displacement of the bead for a unit displacement of the focus; None if it is to be fitted"""


def _described(scene: str | None, changes: list[str] | None) -> tuple[Scene | None, Scene | None]:
    """Return the scene of --scene with its changes, and again if it describes a gas."""
    if scene is None:
        return None, None
    from tweezer.calibration.setup import describes_gas

    described = scene_with(scene, settings_of(changes or []))
    return described, described if describes_gas(described) else None


def _of_gas(
    gas: Scene | None, radius: str | None, density: str | None, pressure: str | None,
    fluid_density: str | None,
) -> dict[str, str]:  # fmt: skip
    """Return the options on a bead in a gas that are given, by the argument of `Setup`."""
    if gas is None:
        if pressure is not None:
            raise ResultError("--pressure: requires --scene with a bead in a named gas")
        return {}
    if fluid_density is not None:
        raise ResultError("--fluid-density: does not apply to a gas, whose scene has its density")
    given = {"radius": radius, "density": density, "pressure": pressure}
    return {name: text for name, text in given.items() if text is not None}


def _masses(given: dict[str, float]) -> dict[str, float]:
    """Return the masses, kg, of the bead and the displaced fluid whose densities are given."""
    volume = 4 / 3 * math.pi * given.get("radius", 0.0) ** 3
    names = {"density": "mass", "fluid-density": "displaced_mass"}
    return {names[name]: given[name] * volume for name in names if name in given}


def _loaded(
    paths: list[str],
    drive: str | None,
    skipped: float,
    how: dict[str, Any],
    of_traps: Sequence[object],
) -> tuple[list[Recording], list[Trajectory], ResultError | None]:
    """Load recordings of trapped beads, or else tracks of free beads.

    Also returns the reason why the last file is not a valid recording of a trapped bead.
    `of_traps` contains the values of options that apply only to traps: if one is given, a file
    that is not a valid recording is refused.
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
    """Determine the common diffusion coefficient of tracks; print it, and write it if asked."""
    common = _diffusion(tracks, setup)
    _print_tracks(common, tracks, few)
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
    """Calibrate recordings of trapped beads; print the results, and write and draw them if asked.

    Several recordings are combined; with focus positions they determine the wall. Exits with
    code 1 if a result has findings or an axis has no stiffness.
    """
    from tweezer.calibration import Trajectory, find_wall, together
    from tweezer.calibration.calibration import calibrated
    from tweezer.calibration.together import printed

    several, places = len(loaded) > 1, focuses.positions
    calibrations = []
    for each in loaded:
        with_drag = dataclasses.replace(setup, viscosity=None) if places else setup
        calibrations.append(calibrated(each, with_drag))
        if several:
            OUT.print(f"{each.name}:", highlight=False, soft_wrap=True)
        print_parts(calibrations[-1].printed())
        if calibrations[-1].note:
            show_warning(calibrations[-1].note)
    put_together = together(calibrations) if several and not places else ()
    free = surface = None
    if several and not places and not any(each.trapped for each in calibrations):
        tracks = [*map(Trajectory.of, loaded)]
        free = _diffusion(tracks, setup)
        _print_tracks(free, tracks, None)
    if places:
        from tweezer.scene.sphere import drag_of_translation

        assert isinstance(setup.radius, float)
        assert isinstance(setup.viscosity, float)
        drag = drag_of_translation(setup.viscosity, setup.radius)
        surface = find_wall(
            calibrations, places, radius=setup.radius, drag=drag, shift=focuses.shift
        )
        print_parts(surface.printed([each.name for each in calibrations], places))
    print_parts(printed(calibrations, put_together))
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


def _diffusion(tracks: list[Trajectory], setup: Setup) -> Diffusion:
    """Return the common diffusion coefficient of tracks, using known properties of the beads."""
    from tweezer.calibration import diffusion

    exposure, noise = (None if each == "fit" else each for each in (setup.exposure, setup.noise))
    return diffusion(
        tracks, temperature=setup.temperature,
        radius=setup.radius,  # type: ignore[arg-type]  # without an uncertainty for a free bead
        viscosity=setup.viscosity,
        exposure=exposure, noise=noise,
    )  # fmt: skip


def _print_tracks(free: Diffusion, tracks: list[Trajectory], few: ResultError | None) -> None:
    """Print the diffusion coefficient of one track, or the common one of several tracks.

    `few` is the reason why the last track cannot be calibrated as a trapped bead, if any. Raises
    `ResultError` for long tracks of trapped beads, which must be calibrated one by one.
    """
    first = tracks[0]
    held = any(each.name == "confined" for each in free.findings)
    held |= not free.interval[0] or free.uncertainty > free.diffusion / 2
    held &= min(each.frames for each in tracks) >= _LONG
    if len(tracks) > 1 and held:
        source, _, label = first.name.rpartition(", bead ")
        way = f'--bead "{label}"' if source else first.name
        raise ResultError(
            f"{source or first.name}: has {len(tracks)} beads that do not seem to diffuse freely; "
            f"calibrate them one by one, such as {way}"
        )
    if held and few is not None:
        raise few
    seen = f"{len(tracks)} tracks together, treated as free beads"
    if len(tracks) == 1:
        why = "samples are too few" if first.frames < _LONG else "samples have too many gaps"
        seen = f"{first.frames} {why} to detect a trap; treated as a free bead"
    print_parts(free.lines(first.unit, seen))


def _focuses(focus: str | None, shift: str | None, recordings: int) -> _Focuses:
    """Return the options on the focus, parsed from their text, for this number of recordings."""
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
    """Refuse options that contradict each other or the recording, or that require other options.

    `given` contains quantities by option, and `beside` the options given that concern a wall.
    """
    for option in beside:
        if loaded.scene is not None:
            raise ResultError(
                f"{loaded.name}: {option}: does not apply to a run, whose scene has the wall"
            )
        if not {"radius", "viscosity"} <= set(given):
            raise ResultError(f"{loaded.name}: {option} requires --radius and --viscosity")
    if loaded.scene is not None and given:
        raise ResultError(
            f"{loaded.name}: does not accept the {', the '.join(given)}, which its scene has"
        )
    if loaded.scene is None and "temperature" not in given:
        raise ResultError(
            f"{loaded.name}: requires --temperature, and --radius and --viscosity if known"
        )
    if "density" in given and not {"radius", "viscosity"} <= set(given):
        raise ResultError(f"{loaded.name}: --density requires --radius and --viscosity")
    if ("fluid-density" in given) > ("density" in given):
        raise ResultError(f"{loaded.name}: --fluid-density requires --density")
