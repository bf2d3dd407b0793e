"""Command line. Nothing heavy is imported until a command needs it."""

from __future__ import annotations

import os
import sys
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console

from tweezer.errors import PhysicsWarning, ResultError, SceneError, TweezerError

if TYPE_CHECKING:
    import xarray as xr
    from rich.table import Table

    from tweezer.scene import Scene

app = typer.Typer(
    help="Simulate a bead in an optical trap.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)
_out = Console()
_err = Console(stderr=True)

_FIGURE_FORMATS = ("pdf", "png", "svg")
_BAD_INPUT, _FAILED, _INTERRUPTED = 2, 1, 130


def main() -> None:
    """Run the command line; an error made on purpose is one line and exit code 2."""
    warnings.showwarning = _show_warning  # type: ignore[assignment]
    try:
        app()
    except TweezerError as error:
        _complain(str(error))
        sys.exit(_BAD_INPUT)


@app.callback()
def _commands() -> None:
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
    scene: Annotated[str, typer.Argument(help="Shipped scene or TOML file.")],
    duration: Annotated[
        str | None, typer.Option(help='Time simulated: "20 ms", or seconds.')
    ] = None,
    model: Annotated[
        str | None, typer.Option(help="full, scaled, overdamped or first-order.")
    ] = None,
    method: Annotated[str | None, typer.Option(help="RK45, DOP853, Radau, BDF or LSODA.")] = None,
    set: Annotated[
        list[str] | None, typer.Option(help='Change the scene: --set "beam.power=80 mW".')
    ] = None,
    out: Annotated[
        Path | None, typer.Option(help="NetCDF file to write; SCENE.nc if not given.")
    ] = None,
    plot: Annotated[
        Path | None, typer.Option(help="Figure to write (png, pdf, svg); SCENE.png if not given.")
    ] = None,
) -> None:
    """Release the bead of SCENE and follow it; write the trajectory and a figure."""
    from tweezer.scene import load_scene

    settings = _settings(set or [], duration=duration, model=model, method=method)
    described = load_scene(scene)
    if settings:
        from tweezer.scene import with_settings

        described = with_settings(described, settings)
    out = _writable(out or Path(f"{described.name}.nc"), ("nc",))
    plot = _writable(plot or Path(f"{described.name}.png"), _FIGURE_FORMATS)
    result = _simulate_with_progress(described)

    from tweezer.io import save_run

    save_run(result, out)
    _print_summary(described, result)
    _write_figure(result, plot)
    _out.print(f"wrote {out} and {plot}", highlight=False, soft_wrap=True)
    if result.attrs["status"] in ("failed", "interrupted"):
        _complain(f"{described.name}: {result.attrs['message']}; what was reached is in {out}")
        failed = result.attrs["status"] == "failed"
        raise typer.Exit(_FAILED if failed else _INTERRUPTED)


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
    """`path`, refused before any work is done if it cannot be written."""
    if path.suffix.lstrip(".").lower() not in formats:
        raise ResultError(f"{path}: must end in .{', .'.join(formats)}")
    if not path.parent.is_dir():
        raise ResultError(f"{path}: no such folder: {path.parent}")
    if not os.access(path.parent, os.W_OK):
        raise ResultError(f"{path}: cannot be written: no permission to write in {path.parent}")
    try:
        if path.is_dir():
            raise ResultError(f"{path}: is a folder")
    except OSError as error:
        raise ResultError(f"{path}: cannot be written: {error.strerror}") from None
    return path


def _simulate_with_progress(scene: Scene) -> xr.Dataset:
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.percentage:>3.0f} %"),
        TimeRemainingColumn(),
    )
    with (
        Progress(*columns, console=_err, transient=True, disable=not _err.is_terminal) as progress,
        warnings.catch_warnings(action="ignore", category=PhysicsWarning),  # said at the end
    ):
        task = progress.add_task(
            f"{scene.name} (the first run also compiles)", total=scene.simulation.duration
        )
        from tweezer.simulation import simulate

        return simulate(scene, progress=lambda reached: progress.update(task, completed=reached))


def _print_summary(scene: Scene, result: xr.Dataset) -> None:
    from tweezer.analysis import summarise

    summary = summarise(result)
    attributes = result.attrs
    x, y, z = (round(1e6 * coordinate, 4) + 0.0 for coordinate in summary.end)  # no -0.0
    model: str = scene.simulation.model
    if model == "scaled":
        model += f", a2 = {scene.simulation.scaling_factor:g}"
    table = _table(scene.name, "")
    table.add_row("outcome", f"{summary.outcome}, {1e3 * summary.outcome_time:.4g} ms")
    table.add_row("end (x, y, z)", f"{x:.4f}, {y:.4f}, {z:.4f} um from the focus")
    table.add_row("overshoot past the axis", f"{1e6 * summary.overshoot:.3g} um")
    approach = "none"
    if summary.closest_approach is not None and summary.closest_approach_time is not None:
        micrometres, milliseconds = (
            1e6 * summary.closest_approach,
            1e3 * summary.closest_approach_time,
        )
        approach = f"{micrometres:.3g} um at {milliseconds:.4g} ms"
    table.add_row("first closest approach", approach)
    table.add_row("largest Reynolds number", f"{summary.largest_reynolds_number:.3g}")
    table.add_row("model, method", f"{model}; {scene.simulation.method}")
    table.add_row("steps", f"{attributes['steps']}")
    table.add_row("force calls", f"{attributes['force_calls']}")
    table.add_row("time", f"{attributes['wall_time']:.2f} s")
    _out.print(table)


def _write_figure(result: xr.Dataset, path: Path) -> None:
    from tweezer.io import replacing
    from tweezer.plots import run_figure

    figure = run_figure(result)
    with replacing(path) as whole:
        figure.savefig(whole, dpi=150)


def _table(*headings: str) -> Table:
    from rich import box
    from rich.table import Table

    return Table(*headings, box=box.SIMPLE_HEAD)


def _complain(text: str) -> None:
    _err.print(text, style="red", markup=False, highlight=False, soft_wrap=True)


def _show_warning(message: Warning | str, *_: object) -> None:
    _err.print(f"warning: {message}", style="yellow", markup=False, highlight=False, soft_wrap=True)
