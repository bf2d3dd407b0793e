"""The command `tweezer rotation`."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from tweezer.cli.app import FigureFile, Overwrite, Quiet, Skip, app, quantity_in
from tweezer.cli.console import (
    begin,
    say,
    tell_written,
    writable_figure,
    writable_result,
    write_figure,
)
from tweezer.cli.tables import print_shown
from tweezer.values.printed import printed, with_error
from tweezer.values.rounding import with_uncertainty
from tweezer.values.shown import Row

if TYPE_CHECKING:
    import xarray as xr


@app.command()
def rotation(
    run: Annotated[
        Path,
        typer.Argument(
            help="File of a run (.nc), or of trajectories of an ensemble (.zarr).", metavar="RUN"
        ),
    ],
    axis: Annotated[
        tuple[float, float, float],
        typer.Option(
            help="Axis of the body, in its own frame, for order, correlations and spectrum. "
            "Default: its z axis.",
            metavar="X Y Z",
        ),
    ] = (0, 0, 1),
    skip: Skip = "0",
    segments: Annotated[
        int,
        typer.Option(
            help="Number of parts of each trajectory over which the spectrum is averaged. Fewer "
            "parts give sharper lines and larger errors."
        ),
    ] = 8,
    no_rates: Annotated[
        bool,
        typer.Option(
            "--no-rates", help="Omit rates, for samples too rare to resolve the rotation."
        ),
    ] = False,
    out: Annotated[Path | None, typer.Option(help="NetCDF file to write.")] = None,
    plot: FigureFile = None,
    overwrite: Overwrite = False,
    quiet: Quiet = False,
) -> None:
    """Analyse the rotation of the body in RUN.

    The command prints the mean angular velocity, the order parameter of an axis of the body, and
    its decay times, with 95 % confidence intervals. The file and the figure also contain its
    autocorrelation, its power spectral density and the mean squared angular displacement.
    """
    begin(quiet=quiet)
    out = out and writable_result(out, ("nc",), overwrite=overwrite)
    plot = writable_figure(plot, overwrite=overwrite)
    from tweezer.orientations import rotation as analysed
    from tweezer.values.units import Time

    skipped = quantity_in("--skip", skip, Time)
    found = analysed(run, axis, skip=skipped, segments=segments, rates=not no_rates)
    print_shown(run.name, _rows(found))
    say("+- is half of the 95 % confidence interval.")
    if out:
        from tweezer.results.io import save_run

        save_run(found, out)
    if plot:
        from tweezer.plots import rotation_figure

        write_figure(rotation_figure(found), plot)
    tell_written(out, plot)


def _rows(found: xr.Dataset) -> Iterator[Row]:
    """Yield the rows of rates, order and decay times, with half widths of their intervals."""
    half = {
        name: (found[f"{name}_interval"].diff("limit")[..., 0] / 2).values
        for name in found.data_vars
        if f"{name}_interval" in found
    }
    for name, frame in (("rate", "axis"), ("rate_body", "body_axis")):
        if name in found:
            for about, *rate in zip(
                found[frame].values, found[name].values, half[name], strict=True
            ):
                yield Row(f"angular velocity about {about}", f"{with_uncertainty(*rate)} rad/s")
    yield Row("axis n of the body", printed(found["body_direction"].values, ""))
    order = float(found["order_parameter"]), float(half["order_parameter"])
    yield Row("order parameter of n", with_uncertainty(*order))
    yield Row("director", ", ".join(f"{each:z.3f}" for each in found["director"].values))
    for i, name in enumerate("xyz"):
        value, error = (float(each[i, i]) for each in (found["order_tensor"], half["order_tensor"]))
        yield Row(f"<P2> of n along {name}", with_uncertainty(value, error))
    longest = printed(float(found["lag"][-1]), "ms")
    for name in ("p1", "p2"):
        time, error = float(found[f"{name}_decay_time"]), float(half[f"{name}_decay_time"])
        decay = f"longer than {longest}" if math.isnan(time) else with_error(time, error, "ms")
        yield Row(f"decay time of <{name.upper()}(n(0).n(t))>", decay)
