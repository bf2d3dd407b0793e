"""Command line. Nothing heavy is imported until a command needs it."""

from __future__ import annotations

import contextlib
import dataclasses
import errno
import importlib
import itertools
import math
import os
import signal
import sys
import warnings
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console

from tweezer.choices import MODELS, methods
from tweezer.errors import PhysicsWarning, ResultError, SceneError, TweezerError
from tweezer.rounding import rounded, with_uncertainty

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure
    from rich.table import Table

    from tweezer.analysis import (
        AxisCalibration,
        Calibration,
        DepthFit,
        Efficiency,
        Escape,
        Finding,
        Height,
        Recording,
        Summary,
        Surface,
        Together,
        Trap,
    )
    from tweezer.compiled import Compilation
    from tweezer.equilibria import Equilibrium
    from tweezer.optics import Table as Map
    from tweezer.run import Run
    from tweezer.scene import Scene

app = typer.Typer(
    help="Simulate a bead in an optical trap.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)
bench = typer.Typer(
    help="Measure speed and errors, from a checkout.",
    no_args_is_help=True,
    rich_markup_mode=None,
)
app.add_typer(bench, name="bench")
SceneName = Annotated[str, typer.Argument(help="Shipped scene or TOML file.", metavar="SCENE")]
Changes = Annotated[
    list[str] | None,
    typer.Option(
        help='Change the scene: --set "beam.power=80 mW". May be repeated.', metavar="KEY=VALUE"
    ),
]
JsonFile = Annotated[Path | None, typer.Option(help="JSON file to write.")]
FigureFile = Annotated[Path | None, typer.Option(help="Figure to write (png, pdf, svg).")]


def _console(*, stderr: bool) -> Console:
    """Console that prints text literally: names of files and scenes may hold brackets or colons."""
    console = Console(stderr=stderr, markup=False, emoji=False)
    if console.width < 1:  # COLUMNS=0
        console.width = 80
    return console


_out, _err = _console(stderr=False), _console(stderr=True)

_FIGURE_FORMATS = ("pdf", "png", "svg")
#: Part of the stiffness below which one across the axes is not shown
_NEGLIGIBLE = 1e-6
#: Type of an option for a folder of many files
_STORES = ("zarr",)
_BAD_INPUT, _FAILED, _INTERRUPTED = 2, 1, 130


def main() -> None:
    """Run the command line; an expected error is one line and exit code 2.

    SIGTERM and SIGHUP are treated as an interruption: results so far are written.
    """
    warnings.showwarning = _show_warning  # type: ignore[assignment]
    # matrices are small here: threads for them take longer to start than they save
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    for number in {signal.SIGTERM, getattr(signal, "SIGHUP", signal.SIGTERM)}:
        if signal.getsignal(number) is signal.SIG_DFL:
            signal.signal(number, signal.default_int_handler)
    try:
        app()
    except TweezerError as error:
        _complain(str(error))
        sys.exit(_BAD_INPUT)
    except OSError as error:
        if error.errno != errno.ENOSPC:
            raise
        _complain(f"what is printed cannot be written: {error.strerror}")
        os._exit(_FAILED)  # or the interpreter would flush once more


def _version(asked: bool) -> None:
    if asked:
        from tweezer.version import __version__

        _out.print(f"tweezer {__version__}", highlight=False)
        raise typer.Exit


@app.callback()
def _commands(
    version: Annotated[
        bool,
        typer.Option("--version", callback=_version, is_eager=True, help="Show the version."),
    ] = False,
) -> None:
    pass


@app.command()
def scenes() -> None:
    """List the shipped scenes."""
    from tweezer.scene import SHIPPED, load_scene, shipped_scenes

    table = _table("scene", "what it shows")
    for name in shipped_scenes():
        table.add_row(name, load_scene(name).description)
    _out.print(table)
    _out.print(f"files to copy and change: {SHIPPED}", highlight=False, soft_wrap=True)


@app.command()
def run(
    scene: SceneName,
    duration: Annotated[
        str | None, typer.Option(help='Time simulated: "20 ms", or seconds.')
    ] = None,
    model: Annotated[
        str | None,
        typer.Option(help=f"{', '.join(MODELS)}; by the tolerance if not given."),
    ] = None,
    method: Annotated[
        str | None,
        typer.Option(
            help=f"auto, {', '.join(each.name for each in methods(thermal=False))}; with thermal "
            f"motion auto, {', '.join(each.name for each in methods(thermal=True))}."
        ),
    ] = None,
    seed: Annotated[int | None, typer.Option(help="Of the thermal motion; 0 if not given.")] = None,
    set: Changes = None,
    out: Annotated[
        Path | None, typer.Option(help="NetCDF file to write; SCENE.nc if not given.")
    ] = None,
    plot: FigureFile = None,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Replace OUT, whatever it is.")
    ] = False,
) -> None:
    """Follow the bead of SCENE.

    Writes the trajectory. An OUT that is there is replaced by a run of the same scene, settings and
    seed, and by no other without --overwrite. A run that is interrupted, or fails, replaces none:
    it is written beside.
    """
    from tweezer.arguments import check_run

    settings = _settings(set or [], duration=duration, model=model, method=method)
    described = _described(scene, settings)
    check_run(described, seed)
    out = _writable(out or Path(f"{described.name}.nc"), ("nc",))
    plot = plot and _writable(plot, _FIGURE_FORMATS)
    if not overwrite and (reason := _not_replaced(out, described, seed)):
        raise ResultError(f"{out}: {reason}; name another --out, or --overwrite it")
    _bind_light(described)
    result = _followed_with_progress(described, seed)
    status = result.attributes["status"]
    ended = status not in ("failed", "interrupted")
    if out.exists() and not (ended and (overwrite or not _not_replaced(out, described, seed))):
        out, plot = _beside(out, plot)

    from tweezer.io import write_run

    write_run(result, out)
    try:
        if plot:
            from tweezer.plots import run_figure

            _write_figure(run_figure(result.dataset()), plot)
    finally:
        _print_summary(described, result)
        _tell_written(out)
    _tell_written(plot)
    if not ended:
        message = result.attributes["message"]
        _complain(f"{described.name}: {message}; what was reached is in {out}")
        failed = status == "failed"
        raise typer.Exit(_FAILED if failed else _INTERRUPTED)


@app.command()
def trap(
    scene: SceneName,
    heights: Annotated[
        tuple[str, str] | None,
        typer.Option(
            help='Heights of the focus above the wall: "1 um" "10 um". Stiffness, equilibrium and '
            "drag at each."
        ),
    ] = None,
    count: Annotated[
        int | None, typer.Option(help="How many heights; 19 if not given.", min=1, max=10_000)
    ] = None,
    set: Changes = None,
    out: Annotated[Path | None, typer.Option(help="JSON file to write; of heights NetCDF.")] = None,
    plot: FigureFile = None,
) -> None:
    """Characterise the trap of SCENE.

    Equilibrium, stiffness, escape, range, efficiencies; or what changes with the height above a
    wall.
    """
    described = _described(scene, _settings(set or []))
    out = out and _writable(out, ("nc",) if heights else ("json",))
    plot = plot and _writable(plot, _FIGURE_FORMATS)
    if heights:
        _trap_over(described, heights, count or 19, out, plot)
        return
    if count is not None:
        raise SceneError("--count: goes with --heights")
    _bind_light(described)

    from tweezer.analysis import characterise

    characterised = characterise(described)
    _print_trap(described, characterised)
    if out:
        _write_trap(described, characterised, out)
    if plot:
        from tweezer.plots import trap_figure

        _write_figure(trap_figure(described, characterised), plot)
    _tell_written(out, plot)


def _trap_over(
    scene: Scene, ends: tuple[str, str], count: int, out: Path | None, plot: Path | None
) -> None:
    """The trap over heights: table, file, figure; of an interrupted one what was reached."""
    from tweezer.optics import ray_optics_caveat
    from tweezer.units import PositiveLength

    low, high = (_quantity("--heights", text, PositiveLength) for text in ends)
    step = (high - low) / max(count - 1, 1)
    if caveat := ray_optics_caveat(scene):
        _show_warning(caveat)
    with (
        _progress(scene.name, 1.0) as progress,
        warnings.catch_warnings(action="ignore", category=PhysicsWarning),  # said above
    ):
        from tweezer.analysis import trap_over_heights

        found = trap_over_heights(scene, [low + i * step for i in range(count)], progress=progress)
    _print_heights(found)
    if out:
        from tweezer.io import save_run

        save_run(found, out)
    if plot and found.sizes["height"]:
        from tweezer.plots import heights_figure

        _write_figure(heights_figure(found), plot)
    _tell_written(out, plot)
    if found.attrs["status"] == "interrupted":
        _complain(f"{scene.name}: interrupted after {found.sizes['height']} of {count} heights")
        raise typer.Exit(_INTERRUPTED)


@app.command()
def tune(
    scene: SceneName,
    factor: Annotated[
        list[float] | None,
        typer.Option(
            help="A scaling factor; may be repeated. From epsilon to 1 if none.", metavar="A2"
        ),
    ] = None,
    duration: Annotated[
        str | None, typer.Option(help='Time compared over: "1 ms", or seconds.')
    ] = None,
    deviation: Annotated[
        str, typer.Option(help="Deviation from the unscaled bead that is allowed.")
    ] = "10 nm",
    method: Annotated[str, typer.Option(help="Method of the scaled runs.")] = "dormand-prince",
    set: Changes = None,
    out: JsonFile = None,
    plot: FigureFile = None,
) -> None:
    """Scaled against unscaled motion of SCENE.

    For a list of a2: the thesis's search.
    """
    from tweezer.units import PositiveLength

    described = _described(scene, _settings(set or [], duration=duration))
    allowed = _quantity("--deviation", deviation, PositiveLength)
    out = out and _writable(out, ("json",))
    plot = plot and _writable(plot, _FIGURE_FORMATS)

    from tweezer.analysis.tuning import scaled_scenes
    from tweezer.analysis.tuning import tune as compared

    scaled_scenes(described, factor, method)  # errors before the light is bound
    _bind_light(described)
    with _progress(described.name, 1.0) as progress:
        tuning = compared(described, factor, method=method, progress=progress)
    table = _table("a2", "off the unscaled bead", "steps", "force calls", "time")
    for entry in [*tuning.entries, tuning.unscaled]:
        first = "unscaled" if entry is tuning.unscaled else f"{entry.scaling_factor:.3g}"
        off = "failed"
        if entry.deviation is not None:
            off = _located(entry.deviation, entry.deviation_error, 1e6, "um")
        table.add_row(
            first, off, f"{entry.steps}", f"{entry.force_calls}", _duration(entry.seconds)
        )
    _out.print(table)
    most = tuning.most_scaling_within(allowed)
    found = "none of these a2" if most is None else f"a2 down to {most.scaling_factor:.3g}"
    _out.print(
        f"within {deviation}: {found}; the thesis's first guess, epsilon: {tuning.epsilon:.3g}",
        highlight=False, soft_wrap=True,
    )  # fmt: skip
    if out:
        _write_json(dataclasses.asdict(tuning), out)
    if plot:
        from tweezer.plots import tuning_figure

        _write_figure(tuning_figure(tuning, described.title), plot)
    _tell_written(out, plot)


@app.command()
def ensemble(
    scene: SceneName,
    trajectories: Annotated[int, typer.Option(help="How many.")],
    duration: Annotated[
        str | None, typer.Option(help='Time simulated: "20 ms", or seconds.')
    ] = None,
    seed: Annotated[int, typer.Option(help="Seed of the random numbers.")] = 0,
    statistics: Annotated[
        bool, typer.Option("--statistics", help="Gather statistics and keep no trajectory.")
    ] = False,
    skip: Annotated[
        str | None, typer.Option(help='Time left out of the statistics of a trap at rest: "5 ms".')
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            help="Zarr store of trajectories, or NetCDF file of statistics, to write; SCENE.zarr "
            "or SCENE-statistics.nc if not given."
        ),
    ] = None,
    resume: Annotated[
        bool, typer.Option("--resume", help="Go on with what is there, if anything is.")
    ] = False,
    workers: Annotated[
        int | None, typer.Option(help="Threads; one for each core if not given.")
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(help="Address of a Dask scheduler whose workers compute, and write OUT."),
    ] = None,
    set: Changes = None,
) -> None:
    """Release the bead of SCENE many times.

    Each time with thermal motion of its own. Stopped at any time, by Ctrl-C or worse, it goes on
    with --resume where it was.
    """
    from tweezer.arguments import check_ensemble
    from tweezer.units import Time

    described = _described(scene, _settings(set or [], duration=duration))
    skipped = _quantity("--skip", skip, Time) if skip else 0.0
    out = out or Path(f"{described.name}-statistics.nc" if statistics else f"{described.name}.zarr")
    out = _writable(out, ("nc",) if statistics else _STORES)
    check_ensemble(
        described, trajectories, seed=seed, out=out, statistics=statistics, skip=skipped,
        scheduler=scheduler, workers=workers,
    )  # fmt: skip
    _bind_light(described)
    with (
        _progress(described.name, 1.0) as progress,
        warnings.catch_warnings(action="ignore", category=PhysicsWarning),  # said above
    ):
        from tweezer.ensembles import ensemble as computed

        result = computed(
            described, trajectories, seed=seed, out=out, statistics=statistics, skip=skipped,
            scheduler=scheduler, workers=workers, resume=resume, progress=progress,
        )  # fmt: skip
    _print_ensemble(described, result)
    if result.attrs["status"] == "interrupted":
        done = f"{result.attrs['trajectories_done']} of {trajectories} trajectories"
        _complain(f"{described.name}: interrupted after {done}; go on with --resume")
        raise typer.Exit(_INTERRUPTED)
    _tell_written(out)


@app.command()
def calibrate(
    recordings: Annotated[
        list[str],
        typer.Argument(
            help="NetCDF file of a run; or CSV, HDF5 or NetCDF with t, x, y, z. Several of one "
            "trap are put together.",
            metavar="RECORDING...",
        ),
    ],
    temperature: Annotated[
        str | None, typer.Option(help='Of the medium: "20 degC", or kelvins. A run has its own.')
    ] = None,
    radius: Annotated[
        str | None, typer.Option(help='Of the bead: "500 nm". The drag is fitted if not given.')
    ] = None,
    viscosity: Annotated[
        str | None, typer.Option(help='Of the medium: "1 mPa s"; goes with --radius.')
    ] = None,
    density: Annotated[
        str | None,
        typer.Option(help='Of the bead: "2000 kg/m^3", to have its inertia; goes with --radius.'),
    ] = None,
    fluid_density: Annotated[
        str | None,
        typer.Option(help='Of the medium: "998 kg/m^3", to have its inertia; goes with --density.'),
    ] = None,
    wall: Annotated[
        str | None,
        typer.Option(
            help='Distance of the centre of the bead from a wall across the light: "1.2 um", or '
            '"1.2 um +- 50 nm"; goes with --radius.',
            metavar="HEIGHT",
        ),
    ] = None,
    focus: Annotated[
        str | None,
        typer.Option(
            help='Position of the focus in each RECORDING, larger farther from a wall: "0 um, 0.5 '
            'um, 1 um". The place of the wall is fitted.',
            metavar="POSITIONS",
        ),
    ] = None,
    focal_shift: Annotated[
        str | None,
        typer.Option(help="How far the bead moves by a unit of --focus, 1 if not given; or fit."),
    ] = None,
    drive: Annotated[
        str | None,
        typer.Option(
            help="Heading of a column: the motion of the stage, which oscillates. Drag, and of "
            "volts the metres, are measured by it.",
            metavar="COLUMN",
        ),
    ] = None,
    blur: Annotated[
        str | None,
        typer.Option(
            "--blur", "--exposure",
            help='Time that each position is averaged over: "2 ms", up to the step; or fit.',
        ),
    ] = None,
    diode: Annotated[
        str | None,
        typer.Option(
            help='Detector that is late: "14 kHz", where its power is halved; "14 kHz, 0.3", with '
            "the part that it detects at once; or fit."
        ),
    ] = None,
    noise: Annotated[
        str | None,
        typer.Option(help='White noise of the detector, a standard deviation: "1 nm"; or fit.'),
    ] = None,
    skip: Annotated[str, typer.Option(help='Time left out at the beginning: "5 ms".')] = "0",
    out: JsonFile = None,
    plot: FigureFile = None,
) -> None:  # fmt: skip
    """Stiffness of a trap from a RECORDING.

    From the thermal motion of the bead, by several methods, and from its answer to a drive.
    """
    from tweezer.analysis import calibrate as calibrated
    from tweezer.analysis import find_wall, load_recording, together
    from tweezer.units import BeadRadius, Density, Temperature, Time, Viscosity

    given = {
        name: _quantity(f"--{name}", text, kind)
        for name, text, kind in (
            ("temperature", temperature, Temperature),
            ("radius", radius, BeadRadius),
            ("viscosity", viscosity, Viscosity),
            ("density", density, Density),
            ("fluid-density", fluid_density, Density),
        )
        if text is not None
    }
    skipped = _quantity("--skip", skip, Time)
    exposed: float | str | None = blur
    if blur not in (None, "fit"):
        exposed = _quantity("--blur", blur, Time)
    out = out and _writable(out, ("json",))
    plot = plot and _writable(plot, _FIGURE_FORMATS)
    if plot and len(recordings) > 1:
        raise ResultError(f"--plot draws one recording, not {len(recordings)}")
    places, shift = _places(focus, focal_shift, len(recordings))
    if places and "fluid-density" in given:
        raise ResultError("--focus: without the inertia of the fluid; leave out --fluid-density")
    loaded = [load_recording(each, drive).since(skipped) for each in recordings]
    asked = [name for name, value in (("--wall", wall), ("--focus", focus)) if value is not None]
    if len(asked) > 1:
        raise ResultError("--wall gives what --focus finds; must be one of them")
    for each in loaded:
        _check_known(each, given, asked)
    drag = mass = displaced = None
    if "radius" in given:
        from tweezer.fluid import stokes

        drag = stokes(given["viscosity"], given["radius"]).translation
    if "density" in given:
        volume = 4 / 3 * math.pi * given["radius"] ** 3
        mass = given["density"] * volume
        if "fluid-density" in given:
            displaced = given["fluid-density"] * volume
    calibrations = []
    for each in loaded:
        calibrations.append(
            calibrated(
                each, temperature=given.get("temperature"), drag=None if places else drag,
                mass=mass, displaced_mass=displaced, wall=_bare(wall), radius=given.get("radius"),
                exposure=exposed, diode=diode, noise=_bare(noise),
            )
        )  # fmt: skip
        if len(loaded) > 1:
            _out.print(f"{each.name}:", highlight=False, soft_wrap=True)
        _print_calibration(calibrations[-1])
    put_together = together(calibrations) if len(loaded) > 1 and not places else ()
    surface = None
    if places:
        surface = find_wall(calibrations, places, radius=given["radius"], drag=drag, shift=shift)
        _print_surface(surface, calibrations, places)
    if put_together:
        _print_together(calibrations, put_together)
    if out:
        written = [dataclasses.asdict(each) for each in calibrations]
        every = [dataclasses.asdict(each) for each in put_together]
        result = {"recordings": written, "together": every} if every else written[0]
        if surface:
            result = {"recordings": written, "surface": dataclasses.asdict(surface)}
        _write_json(result, out)
    if plot:
        from tweezer.plots import calibration_figure

        _write_figure(calibration_figure(loaded[0], calibrations[0]), plot)
    _tell_written(out, plot)


def _places(
    focus: str | None, shift: str | None, recordings: int
) -> tuple[list[float], float | None]:
    """Positions of the focus, m, and by how much the bead moves with it; None if that is fitted.

    recordings: their number.
    """
    from tweezer.units import Length

    if focus is None:
        if shift is not None:
            raise ResultError("--focal-shift: goes with --focus")
        return [], 1.0
    places = [_quantity("--focus", each, Length) for each in focus.split(",")]
    if len(places) != recordings:
        raise ResultError(
            f"--focus {focus!r}: has {len(places)} positions; must be {recordings}, one for each "
            "recording"
        )
    factor = None if shift == "fit" else _bare(shift or "1")
    if factor is not None and not (isinstance(factor, float) and 0 < factor < math.inf):
        raise ResultError(f"--focal-shift {shift!r}: must be a positive number, or fit")
    return places, factor


def _check_known(loaded: Recording, given: dict[str, float], beside: list[str]) -> None:
    """Refuse what does not go together, or with that recording.

    beside: options of a wall that are given.
    """
    for option in beside:
        if loaded.scene is not None:
            raise ResultError(f"{loaded.name}: its scene has the wall; {option} is not for a run")
        if "radius" not in given:
            raise ResultError(f"{loaded.name}: {option} needs --radius and --viscosity")
    if loaded.scene is not None and given:
        raise ResultError(
            f"{loaded.name}: its scene has the {', the '.join(given)}; not to be given"
        )
    if loaded.scene is None and "temperature" not in given:
        raise ResultError(
            f"{loaded.name}: needs --temperature, and --radius and --viscosity if known"
        )
    if ("radius" in given) != ("viscosity" in given) or ("density" in given) > ("radius" in given):
        raise ResultError(
            f"{loaded.name}: --radius and --viscosity go together; --density needs both"
        )
    if ("fluid-density" in given) > ("density" in given):
        raise ResultError(f"{loaded.name}: --fluid-density needs --density")


def _bare(text: str | None) -> float | str | None:
    """A number where text is one."""
    try:
        return None if text is None else float(text)
    except ValueError:
        return text


@app.command()
def reproduce(
    what: Annotated[
        list[str] | None,
        typer.Argument(
            help="Figures of the thesis, 5.1 to 5.15 and C.1 to C.12; claims; waves; memory; "
            "study. All if none.",
            metavar="WHAT",
        ),
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder to write to.")] = Path("thesis-results"),
    seed: Annotated[int, typer.Option(help="Of the thermal motions.")] = 1,
) -> None:
    """Reproduce the thesis: figures and claims.

    The claims with verdicts, what becomes of them with light as waves and in a
    fluid with inertia, and the lost 500 nm bead.
    """
    from tweezer.thesis import reproduce as reproduced

    with (
        _progress("reproduce", 1.0) as progress,
        warnings.catch_warnings(action="ignore", category=PhysicsWarning),
    ):
        result = reproduced(what or (), out, seed=seed, progress=progress)
    if result.claims:
        table = _table("where", "claim", "verdict", "by waves")
        for claim in result.claims:
            table.add_row(claim.where, claim.text, claim.verdict, claim.verdict_by_waves)
        _out.print(table)
    _out.print(f"wrote {len(result.files)} files into {out}", highlight=False, soft_wrap=True)


@app.command("fit-depth")
def fit_depth(
    track: Annotated[
        str,
        typer.Argument(
            help="CSV, HDF5 or NetCDF with t, x, y; or NetCDF file of a run.", metavar="TRACK"
        ),
    ],
    scene: Annotated[str, typer.Option(help="Shipped scene or TOML file.", metavar="SCENE")],
    noise: Annotated[
        str | None, typer.Option(help='Of the camera: "15 nm". Fitted if not given.')
    ] = None,
    search: Annotated[
        tuple[str, str] | None,
        typer.Option(help='Where the start may be: "-8 um" "2 um"; 3/4 of the map if not given.'),
    ] = None,
    fit: Annotated[
        list[str] | None,
        typer.Option(
            help="What else to fit: power, radius, scaling_factor, release. May be repeated.",
            metavar="NAME",
        ),
    ] = None,
    set: Changes = None,
    out: JsonFile = None,
    plot: FigureFile = None,
) -> None:
    """Depth at which the bead of a TRACK started.

    The depth is along the light, the track in the plane across it.
    """
    from tweezer.units import Length, PositiveLength

    described = _described(scene, _settings(set or []))
    given = _quantity("--noise", noise, PositiveLength) if noise is not None else None
    range_ = None
    if search is not None:
        low, high = (_quantity("--search", text, Length) for text in search)
        range_ = low, high
    out = out and _writable(out, ("json",))
    plot = plot and _writable(plot, _FIGURE_FORMATS)

    from tweezer.analysis import fit_depth as fitted
    from tweezer.analysis import load_track
    from tweezer.optics import ray_optics_worth

    loaded = load_track(track)
    if loaded.scene is not None and loaded.scene.bead != described.bead:
        raise ResultError(f"{track}: is a run of another bead than that of {described.name}")
    with _progress(described.name, 1.0) as progress:
        found = fitted(
            loaded, described, noise=given, search=range_, fit=fit or (), progress=progress
        )
    _print_depth(found, described)
    if out:
        result = {
            field.name: getattr(found, field.name)
            for field in dataclasses.fields(found)
            if field.name not in ("minima", "parameters", "path")
        }
        lists = {
            name: [dataclasses.asdict(each) for each in getattr(found, name)]
            for name in ("minima", "parameters")
        }
        worth = ray_optics_worth(described)
        _write_json({**result, **lists, "ray_optics": worth and dataclasses.asdict(worth)}, out)
    if plot:
        from tweezer.plots import depth_figure

        _write_figure(depth_figure(loaded, found), plot)
    _tell_written(out, plot)


@app.command("map")
def force_map(
    scene: SceneName,
    set: Annotated[
        list[str] | None,
        typer.Option(
            help='Change the scene: --set "optics.table_tolerance=1e-8". May be repeated.',
            metavar="KEY=VALUE",
        ),
    ] = None,
) -> None:
    """Compute the map of the force of SCENE.

    Its error is shown. The map is stored; evaluator = "map" in [optics] then reads it.
    """
    described = _described(scene, {"optics.evaluator": "map", **_settings(set or [])})
    if (other := described.optics.evaluator) != "map":
        raise SceneError(f"optics.evaluator = {other!r}: must be 'map' where the map is made")
    _print_map(described, _map_of(described))


@app.command()
def warmup(
    scene: Annotated[
        list[str] | None,
        typer.Argument(help="Shipped scenes or TOML files; all shipped if none.", metavar="SCENE"),
    ] = None,
) -> None:
    """Compile ahead what commands on SCENE need.

    Its map is computed too, if it has one. Without SCENE: what the shipped scenes need; for those
    without a grid also thermal motion, and a bead of a lower index than the medium.
    """
    from tweezer.scene import load_scene, shipped_scenes

    described = [load_scene(name) for name in scene or shipped_scenes()]
    with _err.status("loading") as status:
        from tweezer.compiled import compilation, found
        from tweezer.warmup import usual_scenes, warm_up

        def say(compiling: Compilation) -> None:
            status.update(f"compiling {compiling.latest}, {compiling.seconds:.0f} s so far")

        with compilation(say) as compiling:
            for each in described:
                for usual in [each] if scene else usual_scenes(each):
                    warm_up(usual)
    _out.print(
        f"compiled {compiling.functions} functions in {compiling.seconds:.0f} s; {found()} were "
        "there already"
    )


def _add_benchmark(name: str, report_name: str, told: str) -> None:
    """The command `tweezer bench NAME`: its modules are tests/benchmarks/NAME.py and REPORT.py."""

    @bench.command(name, help=told)
    def measured(
        quick: Annotated[
            bool, typer.Option("--quick", help="Less of everything, to see that it runs.")
        ] = False,
        out: JsonFile = None,
        plot: FigureFile = None,
    ) -> None:
        benchmark, report = _benchmark(name), _benchmark(report_name)
        out = out and _writable(out, ("json",))
        plot = plot and _writable(plot, _FIGURE_FORMATS)
        with _err.status(name) as status:
            results = benchmark.measure(quick=quick, say=status.update)
        for table in report.tables(results):
            _print_benchmark(table)
        if out:
            _write_json(results, out)
        if plot:
            _write_figure(report.figure(results), plot)
        _tell_written(out, plot)


_add_benchmark(
    "force", "report",
    "Optical force: error against time. Grid, quadrature, map, and a sum in NumPy.",
)  # fmt: skip
_add_benchmark(
    "integrate", "integrate_report",
    "Integration: error against time. Ours, SciPy's, CVODE, others, the thesis's scaling.",
)  # fmt: skip
_add_benchmark(
    "brownian", "brownian_report",
    "Thermal motion: speed and bias. Against step and cost; scaling, memory.",
)  # fmt: skip
_add_benchmark(
    "scaling", "scaling_report",
    "Ensembles past one machine. Costs of blocks, files and tasks, and a model of clusters.",
)  # fmt: skip
_add_benchmark(
    "depth", "depth_report",
    "Depth from tracks: coverage and bias. Of starts in z that tracks in the plane tell.",
)  # fmt: skip
_add_benchmark(
    "fluid", "fluid_report",
    "The fluid's inertia: error against poles. Force calls of captures, thermal steps.",
)  # fmt: skip
_add_benchmark(
    "wall", "wall_report",
    "Thermal motion beside a wall: bias. First passage, inertia, step rates.",
)  # fmt: skip
_add_benchmark(
    "calibrate", "calibrate_report",
    "Calibration: coverage, and what is marked. Known traps.",
)  # fmt: skip
_add_benchmark(
    "hydro", "hydro_report",
    "Calibration of fast records: bias. The fluid's inertia, detectors, a driven stage; pylake.",
)  # fmt: skip
_add_benchmark(
    "heights", "heights_report",
    "Calibration beside a wall: coverage. At given heights, and where the wall is found.",
)  # fmt: skip


def _benchmark(name: str) -> ModuleType:
    """Import a module of tests/benchmarks, which only a checkout has."""
    root = Path(__file__).parents[1]
    if not (root / "tests" / "benchmarks" / f"{name}.py").is_file():
        raise TweezerError("bench: runs from a checkout of tweezer's sources, which this is not")
    sys.path.insert(0, str(root))
    return importlib.import_module(f"tests.benchmarks.{name}")


def _described(scene: str, settings: dict[str, str]) -> Scene:
    from tweezer.scene import load_scene, with_settings

    described = load_scene(scene)
    return with_settings(described, settings) if settings else described


def _settings(changes: list[str], **simulation: str | None) -> dict[str, str]:
    settings = {}
    for change in changes:
        key, equals, value = change.partition("=")
        if not equals:
            raise SceneError(f"--set {change!r}: must be key=value, such as beam.power=80 mW")
        settings[key.strip()] = value.strip()
    named = {f"simulation.{key}": value for key, value in simulation.items() if value is not None}
    return {**settings, **named}


def _writable(path: Path, formats: tuple[str, ...]) -> Path:
    """`path`; refused before any computation if it cannot be written."""
    if path.suffix.lstrip(".").lower() not in formats:
        raise ResultError(f"{path}: must end in .{', .'.join(formats)}")
    if not path.parent.is_dir():
        raise ResultError(f"{path}: no such folder: {path.parent}")
    if not os.access(path.parent, os.W_OK):
        raise ResultError(f"{path}: cannot be written: no permission to write in {path.parent}")
    try:
        if path.is_symlink():
            raise ResultError(f"{path}: is a link; name the file it leads to: {path.readlink()}")
        if path.is_dir() and formats != _STORES:
            raise ResultError(f"{path}: is a folder")
    except OSError as error:
        raise ResultError(f"{path}: cannot be written: {error.strerror}") from None
    return path


def _not_replaced(out: Path, scene: Scene, seed: int | None) -> str:
    """Why a run of `scene` must not replace `out`; "" if it may."""
    if not out.exists():
        return ""
    from tweezer.io import unlike

    reason = unlike(out, scene, seed or 0)
    return reason and f"is there, and is {reason}"


def _beside(out: Path, figure: Path | None) -> tuple[Path, Path | None]:
    """The same names with the first number that makes them unused."""
    for number in itertools.count(2):
        new = _numbered(out, number), figure and _numbered(figure, number)
        if not any(path and path.exists() for path in new):
            break
    return new


def _numbered(path: Path, number: int) -> Path:
    return path.with_stem(f"{path.stem}-{number}")


@contextlib.contextmanager
def _progress(
    description: str, total: float, afterwards: str = ""
) -> Iterator[Callable[[float], None]]:
    """Context with a progress bar and the notice of compilation; yields the callback for progress.

    afterwards: what remains to be done when `total` is reached.
    """
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        TextColumn("{task.percentage:>3.0f} %"),
        TimeRemainingColumn(),
    )
    disabled = not _err.is_terminal
    with Progress(*columns, console=_err, transient=True, disable=disabled) as progress:
        task = progress.add_task(description, total=total)

        from tweezer.compiled import compilation

        doing = description

        def say(compiling: Compilation) -> None:
            spent = f"compiling, once: {compiling.seconds:.0f} s so far"
            progress.update(task, description=f"{doing} ({spent})", refresh=True)

        def reach(reached: float) -> None:
            nonlocal doing
            if afterwards and reached >= total:
                doing = f"{description}: {afterwards}"
            progress.update(task, description=doing, completed=reached)

        with compilation(say):
            yield reach


def _followed_with_progress(scene: Scene, seed: int | None) -> Run:
    with (
        _progress(scene.name, scene.simulation.duration, "errors") as progress,
        warnings.catch_warnings(action="ignore", category=PhysicsWarning),  # said at the end
    ):
        from tweezer.simulation import followed

        return followed(scene, seed, progress=progress)


def _bind_light(scene: Scene) -> None:
    """Show the caveat of ray optics, and compute the maps that the scene needs."""
    from tweezer.optics import light, ray_optics_caveat

    if caveat := ray_optics_caveat(scene):
        _show_warning(caveat)
    for alone in map(scene.with_one_beam, scene.beams):
        if alone.lit and scene.optics.evaluator == "map":
            _map_of(alone)
    with warnings.catch_warnings(action="ignore", category=PhysicsWarning):  # said above
        light(scene)


def _map_of(scene: Scene) -> Map:
    with _progress(f"map of {scene.name}", 1.0) as progress:
        from tweezer.optics import force_map

        return force_map(scene, progress)


def _print_map(scene: Scene, made: Map) -> None:
    table = _table(scene.name, "")
    table.add_row("largest force", f"{1e12 * made.largest_force:.4g} pN")
    part = made.certified_error / made.largest_force if made.largest_force else 0.0
    error = f"{1e12 * made.certified_error:.2g} pN, {part:.2g} of the largest force"
    table.add_row("certified error", error)
    table.add_row("range", f"{1e6 * made.range:.4g} um from the focus")
    table.add_row("pieces", f"{made.pieces}")
    if made.path:
        table.add_row("size of the file", f"{made.path.stat().st_size / 1e6:.2g} MB")
    table.add_row("time to make", f"{made.build_time:.2g} s")
    _add_light(table, scene)
    _out.print(table)
    if made.path:
        _out.print(f"kept in {made.path}", highlight=False, soft_wrap=True)


def _print_summary(scene: Scene, result: Run) -> None:
    from tweezer.analysis.summary import summary_of

    summary = summary_of(result)
    attributes = result.attributes
    x, y, z = (round(1e6 * coordinate, 4) + 0.0 for coordinate in summary.end)  # no -0.0
    model: str = attributes["model"]
    if model == "scaled":
        model += f", a2 = {scene.simulation.scaling_factor:g}"
    table = _table(scene.name, "")
    when = _located(summary.outcome_time, summary.outcome_time_error, 1e3, "ms")
    table.add_row("outcome", f"{summary.outcome}, {when}")
    table.add_row("end (x, y, z)", f"{x:.4f}, {y:.4f}, {z:.4f} um from the focus")
    if summary.smallest_gap is not None:
        gap = _located(summary.smallest_gap, summary.smallest_gap_error, 1e6, "um")
        table.add_row("smallest gap to the wall", gap)
    if scene.forces.brownian:
        table.add_row("seed of the thermal motion", f"{attributes['seed']}")
    else:
        _add_approach(table, summary)
    table.add_row("model, method", f"{model}; {attributes['method']}")
    table.add_row("inertia of the fluid", attributes["fluid_inertia"])
    where = " at the samples" if summary.by_samples else ""
    largest, error = summary.largest_force, summary.force_error
    table.add_row("force by", attributes["force_evaluator"])
    _add_light(table, scene)
    if largest > 0:
        share = f"{100 * error / largest:.1g} % of the largest"
        table.add_row("error of the force", f"up to {1e12 * error:.1g} pN{where}, {share}")
    if scene.forces.brownian:
        table.add_row("step", f"{attributes['step']:.3g} s")
    else:
        integration, by_model = (
            "not known" if math.isnan(error) else f"up to {1e6 * error:.1g} um{where}"
            for error in (attributes["integration_error"], attributes["model_error"])
        )
        table.add_row("error of the integration", integration)
        if attributes["model_error"] != 0:
            table.add_row("off the motion with all inertia", by_model)
    table.add_row("steps", f"{attributes['steps']}")
    table.add_row("force calls", f"{attributes['force_calls']}")
    if summary.by_samples:
        table.add_row("resolved by", "the samples: what happens between them is not seen")
    seconds = f"{attributes['wall_time']:.2g} s, {attributes['step_time']:.2g} s of it stepping"
    if attributes["compile_time"] > 0:
        seconds += f", and {attributes['compile_time']:.0f} s to compile, once"
    table.add_row("time", seconds)
    _out.print(table)


def _add_light(table: Table, scene: Scene) -> None:
    """Add the theory of the light, why it is that one, and what ray optics is worth."""
    from tweezer.optics import ray_optics_worth

    table.add_row("light", _theory(scene))
    if worth := ray_optics_worth(scene):
        table.add_row("ray optics", worth.in_short)


def _theory(scene: Scene) -> str:
    return f"{scene.theory} ({scene.theory_reason})" if scene.lit else "none"


def _add_approach(table: Table, summary: Summary) -> None:
    overshoot = _located(summary.overshoot, summary.overshoot_error, 1e6, "um")
    table.add_row("overshoot past the axis", overshoot)
    approach = "none"
    if summary.closest_approach is not None and summary.closest_approach_time is not None:
        distance = _located(summary.closest_approach, summary.closest_approach_error, 1e6, "um")
        at = _located(summary.closest_approach_time, summary.closest_approach_time_error, 1e3, "ms")
        approach = f"{distance} at {at}"
    table.add_row("first closest approach", approach)
    number = _located(
        summary.largest_reynolds_number or 0.0, summary.largest_reynolds_number_error, 1.0, ""
    )
    table.add_row("largest Reynolds number", number)


def _duration(seconds: float) -> str:
    return f"{seconds:.3g} s" if seconds >= 1 else f"{1e3 * seconds:.3g} ms"


def _located(value: float, error: float | None, scale: float, unit: str) -> str:
    """A number of a run, rounded to its error if that is known."""
    text = f"{scale * value:.3g}"
    if error == 0:
        text = f"{scale * value:.4g}"
    elif error is not None:
        digits = math.floor(math.log10(max(abs(value), error))) - math.floor(math.log10(error)) + 1
        text = f"{scale * value:.{digits}g} +- {scale * error:.1g}"
    return f"{text} {unit}".rstrip()


def _print_ensemble(scene: Scene, result: xr.Dataset) -> None:
    attributes = result.attrs
    table = _table(scene.name, "")
    done = attributes["trajectories_done"]
    table.add_row("trajectories", f"{done} of {attributes['trajectories']}")
    lost = result["trajectories_lost"] if "trajectories_lost" in result else (
        (result["lost_time"] < math.inf).sum()
    )  # fmt: skip
    table.add_row("lost", f"{int(lost)}")
    table.add_row("samples", f"{attributes['samples']} in {1e3 * attributes['duration']:.4g} ms")
    if "stationary_mean" in result:
        mean, error = (1e6 * result[f"stationary_mean{of}"].values for of in ("", "_error"))
        row = map(with_uncertainty, mean, error)
        table.add_row("mean (x, y, z)", ", ".join(row) + " um from the focus")
        variance, error = (result[f"stationary_variance{of}"].values for of in ("", "_error"))
        deviation = variance**0.5
        error = 1e9 * error / (2 * deviation)
        row = map(with_uncertainty, 1e9 * deviation, error)
        table.add_row("standard deviation (x, y, z)", ", ".join(row) + " nm")
        table.add_row("windows", f"{int(result['windows'])} of {attributes['samples_per_window']} "
                      f"samples, {int(result['windows_lost'])} not used")  # fmt: skip
    table.add_row("model, method", f"{attributes['model']}; {attributes['method']}")
    _add_light(table, scene)
    table.add_row("step", f"{attributes['step']:.3g} s")
    _out.print(table)


def _determined(value: float, uncertainty: float, unit: str) -> str:
    if not 0 < uncertainty < value:
        return "not determined"
    return f"{with_uncertainty(value, uncertainty)} {unit}"


def _quantity(option: str, text: str, annotation: object) -> float:
    """`text` of `option` as a quantity of type `annotation`: with a unit, or a number in SI."""
    from tweezer.units import quantity_of, to_si

    quantity = quantity_of(annotation)
    assert quantity is not None  # all annotations of tweezer.units have one
    try:
        value: str | float = float(text)
    except ValueError:
        value = text
    try:
        number = to_si(value, quantity.unit, quantity.low, quantity.high)
    except ValueError as error:
        raise SceneError(f"{option} {text!r}: {error}") from None
    if doubt := quantity.doubt(value):
        _show_warning(f"{option} {text} {doubt}")
    return number


def _print_calibration(calibration: Calibration) -> None:
    for axis in calibration.axes:
        if {finding.name for finding in axis.findings} & {"free", "drift"} == {"free"}:
            _print_free(axis)
        else:
            _print_trapped(axis, calibration.unit)
        if calibration.wall is not None and axis.drag is not None:
            _print_wall(calibration.wall, axis)
    if calibration.note:
        _show_warning(calibration.note)


def _print_free(axis: AxisCalibration) -> None:
    D, uncertainty = axis.free_diffusion, axis.free_diffusion_uncertainty
    diffusion = "not determined"
    if D is not None and uncertainty is not None:
        diffusion = _determined(1e12 * D, 1e12 * uncertainty, "um^2/s")
    _out.print(
        f"{axis.axis}: no trap is seen: the bead looks free, or the record is too short; the "
        f"diffusion of a free bead, from displacements: {diffusion}",
        highlight=False, soft_wrap=True,
    )  # fmt: skip


def _print_wall(wall: Height, axis: AxisCalibration) -> None:
    """What is known of the drag by the height, and what the record tells."""
    known = axis.drag
    assert known is not None
    ratio = 1 / wall.mobility(axis.axis)
    error = wall.relative_uncertainty(axis.axis)
    drag = f"{1e9 * known:.4g}"
    if error:
        drag = with_uncertainty(1e9 * known, 1e9 * known * error)
    way = "across" if axis.fit.bead.across else "along"
    _out.print(
        f"{1e6 * wall.distance:.4g} um from the wall, {way} it: drag {drag} nN s/m, {ratio:.4g} "
        "times that far away",
        highlight=False, soft_wrap=True,
    )  # fmt: skip


def _print_trapped(axis: AxisCalibration, unit: str) -> None:
    """A table of estimates, and below it numbered notes on what speaks against them."""
    every = [*axis.findings, *(f for estimate in axis.estimates for f in estimate.findings)]
    listed = [finding for finding in dict.fromkeys(every) if finding.name != "undetermined"]

    def mark(against: Iterable[Finding]) -> str:
        numbers = ", ".join(str(listed.index(f) + 1) for f in against if f in listed)
        return numbers and f"not trusted: {numbers}"

    table = _table(f"{axis.axis}: stiffness by", "pN/um", "+-", "")
    for estimate in axis.estimates:
        k, error = rounded(1e6 * estimate.stiffness, 1e6 * estimate.uncertainty)
        judgement = mark(estimate.findings)
        if any(finding.name == "undetermined" for finding in estimate.findings):
            k = error = "-"
            judgement = "; ".join(filter(None, ["not determined", judgement]))
        table.add_row(estimate.method, k, error, judgement)
    _out.print(table)
    for number, finding in enumerate(listed, 1):
        _out.print(f" {number}  {finding.text}", highlight=False, soft_wrap=True)
    fit, free = axis.fit, axis.free_fit
    corner = _determined(fit.bead.corner_frequency, fit.corner_frequency_uncertainty, "Hz")
    diffusion = _determined(1e12 * free.bead.diffusion, 1e12 * axis.diffusion_uncertainty, "um^2/s")
    line = f"corner frequency {corner}; diffusion {diffusion}; p = {free.p_value:.2g}"
    if free.drag_uncertainty is None:
        line = f"corner frequency {corner}; p = {free.p_value:.2g}"
    against = mark(axis.findings)
    _out.print(f"{line}; {against}" if against else line, highlight=False, soft_wrap=True)
    for line in (*_detected(axis, unit), *(finding.text for finding in axis.remarks)):
        _out.print(line, highlight=False, soft_wrap=True)


def _detected(axis: AxisCalibration, unit: str) -> Iterable[str]:
    """Lines on what the record tells of the detector, and of the drive."""
    volt, nano = (1e3, "mV") if unit == "V" else (1e9, "nm")
    words = {
        "exposure": ("blur", 1e6, "us"),
        "diode_frequency": ("diode", 1e-3, "kHz"),
        "diode_fraction": ("detected at once", 1.0, ""),
        "noise": ("noise", volt, nano),
    }
    told = [
        f"{words[each.name][0]} {_scaled(each.value, each.uncertainty, *words[each.name][1:])}"
        for each in axis.detector
        if each.value is not None
    ]
    if told:
        yield "; ".join(told)
    if axis.sensitivity is not None:
        drag = axis.free_fit
        metres = axis.sensitivity, axis.sensitivity_uncertainty
        force = axis.force_sensitivity, axis.force_sensitivity_uncertainty
        parts = [f"recorded metres are {_scaled(*metres, 1.0, 'm')}"]
        if unit == "V":
            parts = [_scaled(*metres, 1e6, "um/V"), _scaled(*force, 1e12, "pN/V")]
        parts.append(f"drag {_scaled(drag.bead.drag, drag.drag_uncertainty, 1e9, 'nN s/m')}")
        yield "; ".join(parts)
    for each in axis.answers:
        answer = _scaled(each.signal, each.signal_uncertainty, volt, nano)
        yield f"stage {each.frequency:.5g} Hz, {1e9 * each.stage:.4g} nm: {answer}"


def _scaled(value: float | None, uncertainty: float | None, factor: float, unit: str) -> str:
    error = math.nan if uncertainty is None else factor * uncertainty
    return f"{with_uncertainty(factor * (value or math.nan), error)} {unit}".rstrip()


def _print_together(calibrations: list[Calibration], every: tuple[Together, ...]) -> None:
    """A table over recordings, and their means."""
    from tweezer.analysis.together import QUANTITIES

    factors = {"stiffness": (1e6, "pN/um"), "drag": (1e9, "nN s/m"), "sensitivity": (1e6, "um/V")}
    if any(each.unit != "V" for each in calibrations):
        factors["sensitivity"] = (1.0, "")
    for each in every:
        factor, unit = factors[each.quantity]
        table = _table(f"{each.axis}: {each.quantity}", unit, "+-", "")
        for calibration in calibrations:
            for axis in calibration.axes:
                found = QUANTITIES[each.quantity](axis) if axis.axis == each.axis else None
                if found:
                    judgement = "" if calibration.name in each.recordings else "not trusted"
                    numbers = rounded(*(factor * number for number in found))
                    table.add_row(calibration.name, *numbers, judgement)
        if each.mean is not None and each.uncertainty is not None:
            mean = rounded(factor * each.mean, factor * each.uncertainty)
            table.add_row("together", *mean, f"p = {each.p_value:.2g}")
        _out.print(table)
        for finding in each.findings:
            _out.print(finding.text, highlight=False, soft_wrap=True)


def _print_surface(surface: Surface, calibrations: list[Calibration], places: list[float]) -> None:
    """A table of heights, and where the wall is."""
    table = _table("height by the drag", "focus, um", "height, um", "+-", "")
    for each, place, height in zip(calibrations, places, surface.heights, strict=True):
        numbers = rounded(1e6 * height.distance, 1e6 * height.uncertainty)
        judgement = "" if each.name in surface.recordings else "not trusted"
        table.add_row(each.name, f"{1e6 * place:.4g}", *numbers, judgement)
    _out.print(table)
    wall = with_uncertainty(1e6 * surface.position, 1e6 * surface.uncertainty)
    line = f"the bead's centre would be in the wall with the focus at {wall} um"
    if surface.shift_uncertainty is not None:
        shift = with_uncertainty(surface.shift, surface.shift_uncertainty)
        line += f"; it moves by {shift} of the focus"
    if surface.p_value is not None:
        line += f"; p = {surface.p_value:.2g}"
    _out.print(line, highlight=False, soft_wrap=True)
    for finding in surface.findings:
        _out.print(finding.text, highlight=False, soft_wrap=True)


def _print_depth(found: DepthFit, scene: Scene) -> None:
    table = _table(f"{found.name}, {found.scene}", "")
    table.add_row("start in z", f"{1e6 * found.z:.4g} um from the focus")
    pieces = ", ".join(f"{1e6 * low:.4g} to {1e6 * high:.4g}" for low, high in found.intervals)
    table.add_row("95 % confidence", f"{pieces} um")
    others = ", ".join(f"{1e6 * each.z:.4g} um (+{each.misfit:.3g})" for each in found.minima[1:])
    table.add_row("other minima (misfit above)", others or "none")
    for each in found.parameters:
        scale, unit = (1e6, "um") if each.unit == "m" else (1.0, each.unit)
        uncertainty = math.nan if each.uncertainty is None else each.uncertainty
        value = f"{with_uncertainty(scale * each.value, scale * uncertainty)} {unit}".rstrip()
        unknown = ", not determined" if each.uncertainty is None else ""
        table.add_row(each.name, value + unknown)
    table.add_row("frames, outliers", f"{found.frames}, {found.outliers}")
    table.add_row("residuals white, p", f"{found.p_value:.2g}")
    _add_light(table, scene)
    _out.print(table)
    _out.print(found.statement, highlight=False, soft_wrap=True)


def _print_trap(scene: Scene, characterised: Trap) -> None:
    from tweezer.optics.worth import between

    table = _table(scene.name, "")
    power = f"{1e3 * characterised.power_through_pupil:.4g} mW"
    if characterised.fraction_through_pupil is not None:
        power += f", {100 * characterised.fraction_through_pupil:.4g} % of the beam"
    table.add_row("power through the pupil", power)
    if scene.plain:
        table.add_row("backward Q, largest", _efficiency(characterised.backward_efficiency))
        table.add_row("lateral Q, largest", _efficiency(characterised.lateral_efficiency))
    place, frequencies = characterised.equilibrium, characterised.corner_frequencies
    if place is None or frequencies is None:
        on_wall = "; it rests on the wall" if characterised.rests else ""
        table.add_row("equilibrium", f"no stable equilibrium{on_wall}")
    else:
        (kx, kxy, _), (kyx, ky, _), (_, _, kz) = place.stiffness
        worth = characterised.ray_optics
        doubt = "" if worth is None or worth.trusted else ", not to be trusted"
        where = f"z = {_micrometres(place.position[2])} um, {doubt[2:] or 'on the axis'}"
        table.add_row("stable equilibrium", where if scene.plain else f"{_where(place)}{doubt}")
        if worth and worth.equilibrium_shift:
            low, high = (f"{1e6 * shift:+.2g}" for shift in worth.equilibrium_shift)
            table.add_row("  by wave optics", f"{low} to {high} um from there")
        stiffness = _three(1e6 * kx, 1e6 * ky, 1e6 * kz)
        table.add_row("stiffness (x, y, z)", f"{stiffness} pN/um{doubt}")
        if abs(kxy + kyx) > _NEGLIGIBLE * kx:
            table.add_row("stiffness, xy", f"{1e6 * (kxy + kyx) / 2:.4g} pN/um{doubt}")
        if abs(place.turn) > _NEGLIGIBLE * kx:
            turn = f"{1e6 * place.turn:.4g} pN/um, (dFy/dx - dFx/dy)/2"
            table.add_row("push round the axis", turn)
        if worth and worth.stiffness_across:
            across, along = between(worth.stiffness_across), between(worth.stiffness_along)
            table.add_row("  by wave optics", f"{across} times that, z {along} times")
        if characterised.gap is not None and characterised.drag is not None:
            table.add_row("gap to the wall there", f"{_micrometres(characterised.gap)} um")
            drag = _three(*(1e9 * each for each in characterised.drag))
            table.add_row("drag there (x, y, z)", f"{drag} nN s/m")
        table.add_row("corner frequencies", f"{_three(*frequencies)} Hz{doubt}")
    if characterised.absorbed_power is not None and characterised.torque is not None:
        table.add_row("absorbed power", f"{1e3 * characterised.absorbed_power:.4g} mW")
        torque = _three(*(1e18 * each for each in characterised.torque))
        table.add_row("torque about the bead's centre", f"{torque} pN um")
    others = [each for each in characterised.equilibria if each.stable and each is not place]
    if others and scene.plain:
        heights = ", ".join(_micrometres(each.position[2]) for each in others)
        table.add_row("other stable equilibria", f"z = {heights} um")
    unstable = [each for each in characterised.equilibria if not each.stable]
    if unstable and scene.plain:
        heights = ", ".join(_micrometres(each.position[2]) for each in unstable)
        table.add_row("unstable equilibria", f"z = {heights} um")
    elif not scene.plain:
        for each in characterised.equilibria:
            if each is not place:
                kind = "another equilibrium" if each.stable else "unstable equilibrium"
                table.add_row(kind, _where(each))
    error = characterised.force_error
    table.add_row("error of the force", f"{1e12 * error:.1g} pN")
    table.add_row("force by", characterised.evaluator)
    table.add_row("light", _theory(scene))
    _out.print(table)
    if characterised.escapes:
        _print_escapes(characterised)


def _print_heights(found: xr.Dataset) -> None:
    """A row for each height."""
    rows = [
        ["height, um", "equilibrium, um", "gap, um", "stiffness (x, y, z), pN/um",
         "drag across, along, times", "corner frequencies, Hz"]
    ]  # fmt: skip
    for at in (found.isel(height=i) for i in range(found.sizes["height"])):
        first = _micrometres(float(at["height"]))
        if (state := str(at["state"].values)) != "held":
            rows.append([first, state, *4 * [""]])
            continue
        x, y, z = at["equilibrium"].values
        across, _, along = at["drag"].values / found["free_drag"].values
        rows.append([
            first,
            _micrometres(z) if x == y == 0 else ", ".join(map(_micrometres, (x, y, z))),
            f"{1e6 * float(at['gap']):.4g}",
            _three(*(1e6 * at["stiffness"].values)),
            f"{across:.4g}, {along:.4g}",
            _three(*at["corner_frequency"].values),
        ])  # fmt: skip
    _print_benchmark(rows)


def _where(place: Equilibrium) -> str:
    return f"{', '.join(map(_micrometres, place.position))} um"


def _print_escapes(characterised: Trap) -> None:
    from tweezer.optics.worth import between

    worth = characterised.ray_optics
    beyond = f"over {1e6 * characterised.reach:.4g}"
    headings = ("escape", "force, pN", "at, um", "energy, kT", "range, um")
    table = _table(*headings, *(["by waves, times"] if worth else []))
    for escape in characterised.escapes:
        by_waves = ""
        if worth and not worth.trusted:
            by_waves = "not to be trusted"
        elif worth and worth.escape_across:
            axial = {"+z": worth.escape_forward, "-z": worth.escape_backward}
            by_waves = between(axial.get(escape.direction, worth.escape_across))
        table.add_row(
            escape.direction,
            f"{1e12 * escape.force:.4g}",
            f"{1e6 * escape.force_at:.4g}",
            f"{escape.energy_kT:.4g}",
            _range(escape, beyond),
            *([by_waves] if worth else []),
        )
    _out.print(table)


def _range(escape: Escape, beyond: str) -> str:
    if escape.wall_at is not None:
        return f"wall at {_micrometres(escape.wall_at)}"
    return beyond if escape.range is None else f"{1e6 * escape.range:.4g}"


def _micrometres(metres: float) -> str:
    """Four digits, without -0 and without rounding errors of zero."""
    return f"{round(1e6 * metres, 9) + 0.0:.4g}"


def _three(x: float, y: float, z: float) -> str:
    return f"{x:.4g}, {y:.4g}, {z:.4g}"


def _efficiency(found: Efficiency | None) -> str:
    return "none" if found is None else f"{found.Q:.4g}, at {_micrometres(found.at)} um"


def _write_trap(scene: Scene, characterised: Trap, path: Path) -> None:
    from tweezer.version import __version__

    result = {
        "tweezer_version": __version__,
        "scene": scene.model_dump(mode="json", exclude_none=True),
        "trap": dataclasses.asdict(characterised),
    }
    _write_json(result, path)


def _tell_written(*paths: Path | None) -> None:
    written = " and ".join(str(path) for path in paths if path)
    if written:
        _out.print(f"wrote {written}", highlight=False, soft_wrap=True)


def _write_json(value: object, path: Path) -> None:
    from tweezer.io import write_json  # here, as it loads xarray

    write_json(value, path)


def _write_figure(figure: Figure, path: Path) -> None:
    from tweezer.io import replacing

    with replacing(path) as whole:
        figure.savefig(whole, format=path.suffix[1:].lower(), dpi=150)


def _table(*headings: str) -> Table:
    from rich import box
    from rich.table import Table

    return Table(*headings, box=box.SIMPLE_HEAD)


def _print_benchmark(rows: list[list[str]]) -> None:
    """Print a table without breaking words; its first row has the headings.

    Rows become lists if the terminal is too narrow; a pipe or a file has no width.
    """
    console = _out if _out.is_terminal else Console(width=10_000)
    columns = list(zip(*rows, strict=True))
    by_cells = [max(map(len, cells)) for cells in columns]
    by_words = [
        max(len(word) for cell in cells for word in [*cell.split(), ""]) for cells in columns
    ]
    by_words[0] = max(by_words[0], min(by_cells[0], 30))  # names of rows preferably in one line
    headings, *rest = rows
    for widths in (by_cells, by_words):
        if sum(widths) + 3 * len(widths) + 1 <= console.width:
            table = _table(*headings)
            for column, width in zip(table.columns, widths, strict=True):
                column.width = width
            for row in rest:
                table.add_row(*row)
            console.print(table)
            return
    for name, *values in rest:
        console.print(f"\n{headings[0]}: {name}", highlight=False)
        for heading, value in zip(headings[1:], values, strict=True):
            console.print(f"  {heading}: {value}", highlight=False)


def _complain(text: str) -> None:
    _err.print(text, style="red", highlight=False, soft_wrap=True)


def _show_warning(message: Warning | str, *_: object) -> None:
    _err.print(f"warning: {message}", style="yellow", highlight=False, soft_wrap=True)
