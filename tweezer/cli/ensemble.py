"""The command `tweezer ensemble`."""

from __future__ import annotations

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
    STORES,
    begin,
    complain,
    showing_progress,
    tell_written,
    writable,
    writable_figure,
    write_figure,
)
from tweezer.cli.tables import print_shown
from tweezer.values.errors import PhysicsWarning, SceneError
from tweezer.values.prefixes import per
from tweezer.values.printed import printed
from tweezer.values.rounding import with_uncertainty
from tweezer.values.shown import Row

if TYPE_CHECKING:
    from collections.abc import Iterator

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
    plot: FigureFile = None,
    overwrite: Overwrite = False,
    details: Details = False,
    quiet: Quiet = False,
) -> None:
    """Simulate the bead in SCENE many times.

    Each trajectory has independent thermal motion, which the command adds to a scene without it.
    Continue an interrupted ensemble with --resume. --overwrite applies only to the figure of
    --plot.
    """
    begin(details=details, quiet=quiet)
    from tweezer.scene.arguments import check_ensemble
    from tweezer.values.units import Time

    described = with_thermal_motion(scene, settings_of(set or [], duration=duration))
    skipped = quantity_in("--skip", skip, Time) if skip else 0.0
    out = out or Path(f"{described.name}-statistics.nc" if statistics else f"{described.name}.zarr")
    out = writable(out, ("nc",) if statistics else STORES)
    plot = writable_figure(plot, overwrite=overwrite)
    check_ensemble(
        described, trajectories, seed=seed, out=out, statistics=statistics, skip=skipped,
        scheduler=scheduler, workers=workers,
    )  # fmt: skip
    if plot and described.more_beads:
        raise SceneError("--plot: requires a single bead; omit it")
    for number in range(1, len(described.beads) + 1):
        bind_light(described.alone(number))
    with (
        showing_progress(described.name) as progress,
        warnings.catch_warnings(action="ignore", category=PhysicsWarning),  # shown above
    ):
        from tweezer.ensembles import ensemble as computed

        result = computed(
            described, trajectories, seed=seed, out=out, statistics=statistics, skip=skipped,
            scheduler=scheduler, workers=workers, resume=resume, progress=progress,
            forces=force or [],
        )  # fmt: skip
    print_shown(described.name, _rows(described, result))
    if result.attrs["status"] == "interrupted":
        done = f"{result.attrs['trajectories_done']} of {trajectories} trajectories"
        complain(f"{described.name}: interrupted after {done}; continue with --resume")
        raise typer.Exit(INTERRUPTED)
    if plot:
        from tweezer.plots import ensemble_figure

        write_figure(ensemble_figure(result), plot)
    tell_written(out, plot)


def _rows(scene: Scene, result: xr.Dataset) -> Iterator[Row]:
    """Yield the rows of an ensemble: losses, means, standard deviations and the computation."""
    from tweezer.optics import rows_of_light

    attributes = result.attrs
    done = attributes["trajectories_done"]
    yield Row("trajectories", f"{done} of {attributes['trajectories']}")
    lost = result["trajectories_lost"] if "trajectories_lost" in result else (
        (result["lost_time"] < math.inf).sum()
    )  # fmt: skip
    yield Row("lost", f"{int(lost)}")
    if int(lost) and "loss_caveat" in attributes:
        yield Row("", attributes["loss_caveat"])
    yield Row("samples", f"{attributes['samples']} in {printed(attributes['duration'], 'ms')}")
    if "stationary_mean" in result:
        several = len(scene.beads) > 1
        for k, name in enumerate(scene.bead_names):
            one = result.isel(bead=k) if several else result
            yield from _moments(one, f"{name}, " if several else "")
        windows = f"{int(result['windows'])} of {attributes['samples_per_window']} samples, "
        yield Row("windows", f"{windows}{int(result['windows_lost'])} not used", detail=True)
    yield Row("model, method", f"{attributes['model']}; {attributes['method']}")
    yield from rows_of_light(scene)
    yield Row("step", f"{attributes['step']:.3g} s", detail=True)


def _moments(result: xr.Dataset, of: str) -> Iterator[Row]:
    """Yield mean and standard deviation of the position of a bead; `of` begins the names."""
    mean, error = (per("um") * result[f"stationary_mean{each}"].values for each in ("", "_error"))
    row = map(with_uncertainty, mean, error)
    yield Row(f"{of}mean (x, y, z)", ", ".join(row) + " um from the focus")
    variance, error = (result[f"stationary_variance{each}"].values for each in ("", "_error"))
    deviation = variance**0.5
    error = per("nm") * error / (2 * deviation)
    row = map(with_uncertainty, per("nm") * deviation, error)
    yield Row(f"{of}standard deviation (x, y, z)", ", ".join(row) + " nm")
