"""The commands `tweezer scenes` and `tweezer run`."""

from __future__ import annotations

import itertools
import math
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from tweezer.cli.app import (
    Changes,
    Details,
    FigureFile,
    Overwrite,
    OwnForces,
    Quiet,
    app,
    bind_light,
    quantity_in,
    scene_with,
    settings_of,
    with_thermal_motion,
)
from tweezer.cli.completion import among, complete_scene
from tweezer.cli.console import (
    FAILED,
    INTERRUPTED,
    OUT,
    begin,
    complain,
    showing_progress,
    tell_written,
    writable_figure,
    writable_result,
    write_figure,
)
from tweezer.cli.tables import print_shown, table_of
from tweezer.scene.choices import METHODS, MODELS, methods
from tweezer.values.errors import PhysicsWarning, SceneError
from tweezer.values.printed import printed
from tweezer.values.shown import Row

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from tweezer.dynamics.continuing import Continued
    from tweezer.forces.force import Force
    from tweezer.results.run import Run
    from tweezer.runs.summary import Summary
    from tweezer.scene import Scene

#: Name of the model error, the longest row name in the tables of a run
_BY_MODEL = "deviation from full inertia"


@app.command()
def scenes() -> None:
    """List the shipped scenes."""
    from tweezer.scene import SHIPPED, load_scene, shipped_scenes

    table = table_of("scene", "what it shows")
    for name in shipped_scenes():
        table.add_row(name, load_scene(name).description)
    OUT.print(table)
    OUT.print(f"files to copy and change: {SHIPPED}", highlight=False, soft_wrap=True)


# The options of `tweezer run`
_OptionalScene = Annotated[
    str | None,
    typer.Argument(
        help="Shipped scene or TOML file. Default with --continue-from: the scene of RUN.",
        metavar="SCENE",
        autocompletion=complete_scene,
    ),
]
_Duration = Annotated[
    str | None, typer.Option(help='Duration, s or e.g. "20 ms". Default: that of SCENE.')
]
_Model = Annotated[
    str | None,
    typer.Option(
        help=f"{', '.join(MODELS)}. Default: chosen by the tolerance.",
        autocompletion=among(MODELS),
    ),
]
_Method = Annotated[
    str | None,
    typer.Option(
        help=f"auto, {', '.join(each.name for each in methods(thermal=False))}; for thermal "
        f"motion auto, {', '.join(each.name for each in methods(thermal=True))}.",
        autocompletion=among(["auto", *METHODS]),
    ),
]
_Thermal = Annotated[
    bool, typer.Option("--thermal", help="Add thermal motion, with forces from a map.")
]
_Rate = Annotated[
    str | None, typer.Option(help='Samples kept per second, e.g. "50 kHz".', metavar="RATE")
]
_Seed = Annotated[int | None, typer.Option(help="Seed of the thermal motion. Default: 0.")]
_ContinueFrom = Annotated[
    Path | None,
    typer.Option(
        help="NetCDF file of an earlier run to continue for the duration of SCENE. Model, method "
        "and time between samples remain those of RUN.",
        metavar="RUN",
    ),
]
_Out = Annotated[
    Path | None,
    typer.Option(help="NetCDF file to write. Default: SCENE.nc, or RUN-2.nc to continue RUN."),
]


@app.command()
def run(
    scene: _OptionalScene = None,
    duration: _Duration = None,
    model: _Model = None,
    method: _Method = None,
    thermal: _Thermal = False,
    rate: _Rate = None,
    seed: _Seed = None,
    continue_from: _ContinueFrom = None,
    force: OwnForces = None,
    set: Changes = None,
    out: _Out = None,
    plot: FigureFile = None,
    overwrite: Overwrite = False,
    details: Details = False,
    quiet: Quiet = False,
) -> None:
    """Simulate the bead in SCENE.

    Write the trajectory to a NetCDF file.

    An existing OUT is replaced only by a run of the same scene, settings and seed. Any other run
    requires --overwrite. An interrupted or failed run never replaces a file, and is written to a
    new one.
    """
    begin(details=details, quiet=quiet)
    from tweezer.scene.arguments import check_run

    settings = settings_of(set or [], duration=duration, model=model, method=method)
    source = _scene_to_continue(continue_from) if scene is None else scene
    described = (with_thermal_motion if thermal else scene_with)(source, settings)
    if rate is not None:
        if continue_from is not None:
            raise SceneError(
                f"--rate {rate!r}: the run to continue gives the time between samples; omit --rate"
            )
        described = _sampled(described, rate, settings)
    check_run(described, seed)
    if described.more_beads:
        from tweezer.cli.several import run_of_several

        run_of_several(described, seed, out, plot, continue_from, force, overwrite=overwrite)
        return
    going_on = None
    default = f"{described.name}.nc"
    if continue_from is not None:
        from tweezer.runs.simulation import going_on_from

        going_on = going_on_from(described, continue_from)
        seed = going_on[1].seed if seed is None else seed
        default = _numbered(continue_from, 2).name
    from tweezer.forces.acting import forces_of
    from tweezer.forces.named import origins_of

    own = forces_of(force or [])
    begun = going_on[1].mark if going_on else "", origins_of(own)
    out = writable_result(
        out or Path(default),
        ("nc",),
        overwrite=overwrite,
        obstacle=lambda there: _obstacle(there, described, seed, *begun),
    )
    plot = writable_figure(plot, overwrite=overwrite)
    bind_light(described)

    from tweezer.dynamics.second_process import compiling_beside

    with compiling_beside(described):
        result, find_errors = followed_with_progress(described, seed, going_on, own)
        status = result.attributes["status"]
        ended = status not in ("failed", "interrupted")
        may = overwrite or not out.exists() or not _obstacle(out, described, seed, *begun)
        if out.exists() and not (ended and may):
            out, plot = _beside(out, plot)
        try:
            _print_summary(described, result)
            if plot:
                from tweezer.plots import run_figure

                write_figure(run_figure(result.dataset()), plot)
                tell_written(plot)
            find_errors()
            _print_errors(described, result)
        finally:
            from tweezer.results.io import write_run

            write_run(result, out)
            tell_written(out)
    if not ended:
        message = result.attributes["message"]
        complain(f"{described.name}: {message}; the trajectory so far was saved to {out}")
        failed = status == "failed"
        raise typer.Exit(FAILED if failed else INTERRUPTED)


def _scene_to_continue(run: Path | None) -> Scene:
    """Return the scene of an earlier run as it was given, before defaults were resolved."""
    if run is None:
        raise SceneError("Missing argument SCENE: required without --continue-from")
    from tweezer.results.io import load_run, scene_in

    return scene_in({"scene": load_run(run).attrs.get("scene_as_given")})


def _sampled(scene: Scene, rate: str, settings: dict[str, str]) -> Scene:
    """Return the scene with the number of samples that `rate` gives over its duration."""
    if "simulation.samples" in settings:
        raise SceneError(f"--rate {rate!r}: simulation.samples is set too; give one of the two")
    from tweezer.values.units import Frequency

    intervals = quantity_in("--rate", rate, Frequency) * scene.simulation.duration
    if intervals < 1:
        raise SceneError(
            f"--rate {rate!r}: gives less than one sample in {scene.simulation.duration:g} s; "
            "choose a higher rate or a longer --duration"
        )
    return scene.replace(simulation={"samples": round(intervals) + 1})


def _obstacle(out: Path, scene: Scene, seed: int | None, continued: str, forces_from: str) -> str:
    """Return why a run of `scene` must not replace the file at `out`; "" if it may.

    It passes its arguments to `tweezer.results.io.unlike`.
    """
    from tweezer.results.io import unlike

    return unlike(out, scene, seed or 0, continued, forces_from)


def _beside(out: Path, figure: Path | None) -> tuple[Path, Path | None]:
    """Return the names of output and figure with the first number for which neither file exists."""
    for number in itertools.count(2):
        new = _numbered(out, number), figure and _numbered(figure, number)
        if not any(path and path.exists() for path in new):
            break
    return new


def _numbered(path: Path, number: int) -> Path:
    """Return a path with a number at the end of its stem: run-2.nc for run.nc."""
    return path.with_stem(f"{path.stem}-{number}")


def followed_with_progress(
    scene: Scene,
    seed: int | None,
    going_on: tuple[Scene, Continued] | None = None,
    forces: Sequence[Force] = (),
) -> tuple[Run, Callable[[], None]]:
    """Return the run of a scene, and a function that computes its remaining errors.

    Both show progress bars.

    Parameters
    ----------
    scene, seed, going_on, forces
        As in `tweezer.runs.simulation.motion_of`.
    """
    end = (going_on[0] if going_on else scene).simulation.duration
    with (
        showing_progress(scene.name, end, "errors") as progress,
        warnings.catch_warnings(action="ignore", category=PhysicsWarning),  # shown at the end
    ):
        from tweezer.runs.simulation import motion_of

        run, find_errors = motion_of(scene, seed, forces, progress=progress, going_on=going_on)

    def with_progress() -> None:
        """Compute the remaining errors of the run, with a progress bar."""
        with (
            showing_progress(f"{scene.name}: errors"),
            warnings.catch_warnings(action="ignore", category=PhysicsWarning),  # shown before
        ):
            find_errors()

    return run, with_progress


def _print_summary(scene: Scene, result: Run) -> None:
    """Print the outcome of a run, and with --details how it was computed."""
    from tweezer.runs.summary import summary_of

    print_shown(scene.name, _rows(scene, result, summary_of(result)), len(_BY_MODEL))


def _rows(scene: Scene, result: Run, summary: Summary) -> Iterator[Row]:
    """Yield the rows of the outcome of a run and of its computation."""
    from tweezer.optics import rows_of_light

    attributes = result.attributes
    model: str = attributes["model"]
    if model == "scaled":
        model += f", a2 = {scene.simulation.scaling_factor:g}"
    yield from summary.outcome_rows()
    if not scene.forces.brownian:
        yield from summary.approach_rows()
    if scene.draws:
        of = "thermal motion" if scene.forces.brownian else "noise"
        yield Row(f"seed of the {of}", f"{attributes['seed']}")
    if scene.camera is not None and "seen" in result:
        frames = f"{len(result['seen'])} frames, one every {printed(1 / scene.camera.rate, 'ms')}"
        yield Row("seen by the camera", frames)
    if "continued_from" in attributes:
        yield Row("continued from", f"{printed(result['time'][0], 'ms', 6)} after the release")
    yield Row("model, method", f"{model}; {attributes['method']}")
    yield Row("inertia of the fluid", attributes["fluid_inertia"])
    yield Row("force by", attributes["force_evaluator"], detail=True)
    yield from rows_of_light(scene)
    if scene.forces.brownian:
        yield Row("step", f"{attributes['step']:.3g} s", detail=True)
    else:
        yield Row("error of the integration", _up_to(attributes["integration_error"], summary))
    yield Row("steps", f"{attributes['steps']}", detail=True)
    yield Row("force calls", f"{attributes['force_calls']}", detail=True)
    if summary.by_samples:
        yield Row("resolved by", "the samples: what happens between them is not seen")
    seconds = f"{attributes['wall_time']:.2g} s, {attributes['step_time']:.2g} s of it stepping"
    if attributes["compile_time"] > 0:
        seconds += f", and {attributes['compile_time']:.0f} s to compile, once"
    yield Row("time", seconds, detail=True)


def _print_errors(scene: Scene, result: Run) -> None:
    """Print the errors that are known last: see `tweezer.runs.simulation.motion_of`."""
    from tweezer.runs.summary import summary_of

    summary, by_model = summary_of(result), result.attributes["model_error"]
    rows = []
    if summary.largest_force > 0:
        largest, error = summary.largest_force, summary.force_error
        told = f"up to {printed(error, 'pN', 1)}{_where(summary)}, "
        told += f"{100 * error / largest:.1g} % of the largest"
        rows.append(Row("error of the force", "not known" if math.isnan(error) else told))
    if not scene.forces.brownian and by_model != 0:
        rows.append(Row(_BY_MODEL, _up_to(by_model, summary)))
    if rows:
        print_shown("errors", rows, len(_BY_MODEL))


def _up_to(error: float, summary: Summary) -> str:
    """Return the largest error of positions, m, as text."""
    return "not known" if math.isnan(error) else f"up to {printed(error, 'um', 1)}{_where(summary)}"


def _where(summary: Summary) -> str:
    """Return " at the samples" for a summary from samples alone, else ""."""
    return " at the samples" if summary.by_samples else ""
