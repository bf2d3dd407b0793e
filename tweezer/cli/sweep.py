"""The command `tweezer sweep`."""

from __future__ import annotations

import warnings
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from tweezer.cli.app import (
    Changes,
    FigureFile,
    Overwrite,
    OwnForces,
    Quiet,
    Resume,
    SceneName,
    app,
    quantity_in,
    scene_with,
    settings_of,
)
from tweezer.cli.completion import among, complete_setting
from tweezer.cli.console import (
    INTERRUPTED,
    OUT,
    STORES,
    begin,
    complain,
    showing_progress,
    tell_written,
    writable,
    writable_figure,
    write_figure,
)
from tweezer.cli.tables import table_of
from tweezer.scene.choices import SWEPT

if TYPE_CHECKING:
    import xarray as xr

#: Number of different reasons for failed cases that are shown
_REASONS = 5


@app.command()
def sweep(
    scene: SceneName,
    over: Annotated[
        list[str] | None,
        typer.Option(
            help="Key with its values: a range, e.g. beam.power=1mW..1W:60, with :log at the end "
            "for equal ratios, or a list, e.g. bead.diameter=0.5um,1um. May be repeated; every "
            "combination is a case.",
            metavar="KEY=VALUES",
            autocompletion=complete_setting,
        ),
    ] = None,
    cases: Annotated[
        Path | None,
        typer.Option(
            help="CSV file with one case per row. Headings are keys, optionally with a unit, e.g. "
            '"beam.power [mW]".'
        ),
    ] = None,
    of: Annotated[
        str,
        typer.Option(help=f"Quantity to compute: {', '.join(SWEPT)}.", autocompletion=among(SWEPT)),
    ] = "trap",
    out: Annotated[
        Path | None, typer.Option(help="Zarr store to write. Default: SCENE-sweep.zarr.")
    ] = None,
    resume: Resume = False,
    workers: Annotated[
        int | None, typer.Option(help="Number of processes. Default: one per core.")
    ] = None,
    scheduler: Annotated[
        str | None, typer.Option(help="Address of a Dask scheduler whose workers compute.")
    ] = None,
    trajectories: Annotated[
        int | None, typer.Option(help="Trajectories of each ensemble. Default: 100.")
    ] = None,
    seed: Annotated[
        int | None, typer.Option(help="Seed of the thermal motion in every case. Default: 0.")
    ] = None,
    skip: Annotated[
        str | None,
        typer.Option(
            help='Time to omit at the beginning, for ensemble and calibrate, e.g. "5 ms".'
        ),
    ] = None,
    force: OwnForces = None,
    set: Changes = None,
    plot: FigureFile = None,
    overwrite: Overwrite = False,
    quiet: Quiet = False,
) -> None:
    """Compute a quantity for many scenes.

    The scenes differ from SCENE in a few keys. Continue a sweep that was stopped, for example by
    Ctrl-C or a crash, with --resume. --overwrite applies only to the figure of --plot; a store is
    never replaced.
    """
    begin(quiet=quiet)
    from tweezer.values.units import Time

    described = scene_with(scene, settings_of(set or []))
    out = writable(out or Path(f"{described.name}-sweep.zarr"), STORES)
    plot = writable_figure(plot, overwrite=overwrite)
    skipped = quantity_in("--skip", skip, Time) if skip else None
    if plot:
        _check_drawn(over or [], cases)
    with showing_progress(described.name) as progress:
        from tweezer.sweeps import sweep as computed
        from tweezer.sweeps.cases import read_over

        result = computed(
            described, read_over(over or []), of, out, cases=cases, workers=workers,
            scheduler=scheduler, trajectories=trajectories, seed=seed, skip=skipped, resume=resume,
            progress=progress, forces=force or [],
        )  # fmt: skip
    _print_sweep(described.name, result)
    if result.attrs["status"] == "interrupted":
        done = f"{result.attrs['cases_done']} of {result.attrs['cases']} cases"
        complain(f"{described.name}: interrupted after {done}; continue with --resume")
        raise typer.Exit(INTERRUPTED)
    if plot:
        from tweezer.plots.sweeps import sweep_figure

        write_figure(sweep_figure(result), plot)
    tell_written(out, plot)


def _check_drawn(over: list[str], cases: Path | None) -> None:
    """Raise `ResultError` before the computation if a sweep cannot be drawn."""
    from tweezer.plots.sweeps import drawn_over
    from tweezer.sweeps.cases import cases_of, read_over

    with warnings.catch_warnings(action="ignore"):  # the sweep repeats these warnings
        grid = cases_of(read_over(over), cases)
    drawn_over({axis.name: axis.size for axis in grid.axes})


def _print_sweep(name: str, result: xr.Dataset) -> None:
    """Print the number of cases with each outcome, and the reasons for failures."""
    from tweezer.sweeps.quantities import FAILED

    table = table_of(name, "")
    over = [f"{result.sizes[key]} {key}" for key in result["outcome"].dims]
    table.add_row("cases", f"{result.attrs['cases']}: {' x '.join(over)}")
    outcomes = Counter(result["outcome"].values.ravel().tolist())
    for outcome, count in outcomes.most_common():
        table.add_row(outcome, f"{count}")
    said = result["outcome"].values.ravel(), result["reason"].values.ravel()
    told = [(str(outcome), str(reason)) for outcome, reason in zip(*said, strict=True) if reason]
    reasons = Counter(reason for outcome, reason in told if outcome == FAILED)
    for reason, count in reasons.most_common(_REASONS):
        table.add_row(f"failed, {count}", reason)
    if len(reasons) > _REASONS:
        table.add_row("failed", f"for {len(reasons) - _REASONS} more reasons")
    for outcome in outcomes:
        of_outcome = [reason for each, reason in told if each == outcome != FAILED]
        if of_outcome:
            table.add_row(f"{outcome}, the first", of_outcome[0])
    caveats = result["caveat"].values.ravel()
    if doubtful := int((caveats != "").sum()):
        first = str(caveats[caveats != ""][0])
        table.add_row("with findings", f"{doubtful}; the first: {first}")
    OUT.print(table)
