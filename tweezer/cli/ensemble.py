"""The command `tweezer ensemble`."""

from __future__ import annotations

import math
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from tweezer.cli.app import (
    Changes,
    OwnForces,
    Resume,
    SceneName,
    app,
    bind_light,
    quantity_in,
    settings_of,
    with_thermal_motion,
)
from tweezer.cli.console import (
    INTERRUPTED,
    OUT,
    STORES,
    complain,
    showing_progress,
    tell_written,
    writable,
)
from tweezer.cli.tables import add_light, table_of
from tweezer.values.errors import PhysicsWarning
from tweezer.values.prefixes import per
from tweezer.values.printed import printed
from tweezer.values.rounding import with_uncertainty

if TYPE_CHECKING:
    import xarray as xr

    from tweezer.scene import Scene


@app.command()
def ensemble(
    scene: SceneName,
    trajectories: Annotated[int, typer.Option(help="Number of trajectories.")],
    duration: Annotated[
        str | None, typer.Option(help='Duration, s or e.g. "20 ms". Default: that of SCENE.')
    ] = None,
    seed: Annotated[int, typer.Option(help="Seed of the random numbers.")] = 0,
    statistics: Annotated[
        bool, typer.Option("--statistics", help="Store statistics instead of trajectories.")
    ] = False,
    skip: Annotated[
        str | None,
        typer.Option(help='Time to omit from statistics over time and beads, e.g. "5 ms".'),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            help="Zarr store of trajectories, or NetCDF file of statistics, to write. Default: "
            "SCENE.zarr or SCENE-statistics.nc."
        ),
    ] = None,
    resume: Resume = False,
    workers: Annotated[
        int | None, typer.Option(help="Number of threads. Default: one per core.")
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(help="Address of a Dask scheduler, whose workers compute and write OUT."),
    ] = None,
    force: OwnForces = None,
    set: Changes = None,
) -> None:
    """Simulate the bead in SCENE many times.

    Each trajectory has independent thermal motion, which the command adds to a scene without it.
    Continue an interrupted ensemble with --resume.
    """
    from tweezer.scene.arguments import check_ensemble
    from tweezer.values.units import Time

    described = with_thermal_motion(scene, settings_of(set or [], duration=duration))
    skipped = quantity_in("--skip", skip, Time) if skip else 0.0
    out = out or Path(f"{described.name}-statistics.nc" if statistics else f"{described.name}.zarr")
    out = writable(out, ("nc",) if statistics else STORES)
    check_ensemble(
        described, trajectories, seed=seed, out=out, statistics=statistics, skip=skipped,
        scheduler=scheduler, workers=workers,
    )  # fmt: skip
    bind_light(described)
    with (
        showing_progress(described.name, 1.0) as progress,
        warnings.catch_warnings(action="ignore", category=PhysicsWarning),  # shown above
    ):
        from tweezer.ensembles import ensemble as computed

        result = computed(
            described, trajectories, seed=seed, out=out, statistics=statistics, skip=skipped,
            scheduler=scheduler, workers=workers, resume=resume, progress=progress,
            forces=force or [],
        )  # fmt: skip
    _print_ensemble(described, result)
    if result.attrs["status"] == "interrupted":
        done = f"{result.attrs['trajectories_done']} of {trajectories} trajectories"
        complain(f"{described.name}: interrupted after {done}; go on with --resume")
        raise typer.Exit(INTERRUPTED)
    tell_written(out)


def _print_ensemble(scene: Scene, result: xr.Dataset) -> None:
    """Print the number of lost beads, means and standard deviations, and the method."""
    attributes = result.attrs
    table = table_of(scene.name, "")
    done = attributes["trajectories_done"]
    table.add_row("trajectories", f"{done} of {attributes['trajectories']}")
    lost = result["trajectories_lost"] if "trajectories_lost" in result else (
        (result["lost_time"] < math.inf).sum()
    )  # fmt: skip
    table.add_row("lost", f"{int(lost)}")
    if int(lost) and "loss_caveat" in attributes:
        table.add_row("", attributes["loss_caveat"])
    table.add_row("samples", f"{attributes['samples']} in {printed(attributes['duration'], 'ms')}")
    if "stationary_mean" in result:
        mean, error = (per("um") * result[f"stationary_mean{of}"].values for of in ("", "_error"))
        row = map(with_uncertainty, mean, error)
        table.add_row("mean (x, y, z)", ", ".join(row) + " um from the focus")
        variance, error = (result[f"stationary_variance{of}"].values for of in ("", "_error"))
        deviation = variance**0.5
        error = per("nm") * error / (2 * deviation)
        row = map(with_uncertainty, per("nm") * deviation, error)
        table.add_row("standard deviation (x, y, z)", ", ".join(row) + " nm")
        table.add_row("windows", f"{int(result['windows'])} of {attributes['samples_per_window']} "
                      f"samples, {int(result['windows_lost'])} not used")  # fmt: skip
    table.add_row("model, method", f"{attributes['model']}; {attributes['method']}")
    add_light(table, scene)
    table.add_row("step", f"{attributes['step']:.3g} s")
    OUT.print(table)
