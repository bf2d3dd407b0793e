"""The command `tweezer rheology`."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING, Annotated

import typer

from tweezer.cli.app import (
    Bead,
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
)
from tweezer.cli.calibrate import Diode, Drift, FitRange, LeaveOut, Noise, Temperature, Wall
from tweezer.cli.console import (
    FAILED,
    begin,
    show_warning,
    tell_written,
    writable_figure,
    writable_result,
    write_figure,
    write_result,
)
from tweezer.cli.tables import print_parts
from tweezer.values.errors import ResultError

if TYPE_CHECKING:
    from tweezer.reading import Recording


@app.command()
def rheology(
    recording: Annotated[
        str,
        typer.Argument(
            help="NetCDF file of a run, or a table with t, x, y, z (CSV, HDF5, .npy, .mat, TDMS).",
            metavar="RECORDING",
        ),
    ],
    temperature: Temperature = None,
    radius: Annotated[
        str | None,
        typer.Option(help='Radius of the bead, e.g. "500 nm". Default for a run: its own.'),
    ] = None,
    wall: Wall = None, columns: Columns = None, rate: Rate = None, scale: Scale = None,
    bead: Bead = None,
    blur: Annotated[
        str | None,
        typer.Option(
            "--blur", "--exposure",
            help='Exposure time of each position, e.g. "2 ms". At most the sampling interval.',
        ),
    ] = None,
    diode: Diode = None, noise: Noise = None, leave_out: LeaveOut = None, drift: Drift = None,
    fit_range: FitRange = None, skip: Skip = "0", out: JsonFile = None, plot: FigureFile = None,
    overwrite: Overwrite = False, details: Details = False, quiet: Quiet = False,
) -> None:  # fmt: skip
    """Measure viscoelastic moduli in a RECORDING.

    The thermal motion of a trapped bead determines the storage and the loss modulus of the medium,
    with 95 % confidence intervals. Exit code: 0 for moduli without findings, 1 with findings, 2 if
    the input is refused.
    """
    begin(details=details, quiet=quiet)
    from tweezer.calibration.setup import Setup
    from tweezer.values import units

    given = {
        name: quantity_in(f"--{name}", text, kind)
        for name, text, kind in (
            ("temperature", temperature, units.Temperature), ("radius", radius, units.BeadRadius),
        )
        if text is not None
    }  # fmt: skip
    exposed = None if blur is None else quantity_in("--blur", blur, units.Time)
    skipped = quantity_in("--skip", skip, units.Time)
    out = out and writable_result(out, ("json",), overwrite=overwrite)
    plot = writable_figure(plot, overwrite=overwrite)
    from tweezer.microrheology.analysis import analysed
    from tweezer.reading import load_recording

    loaded = load_recording(recording, columns=columns, rate=rate, scale=scale, bead=bead)
    _check_known(loaded, {*given} | ({"wall"} if wall else set()))
    setup = Setup(
        temperature=given.get("temperature"), radius=given.get("radius"), wall=units.bare(wall),
        exposure=exposed, diode=diode, noise=units.bare(noise), leave_out=leave_out or (),
        drift=drift, fit_range=fit_range,
    )  # fmt: skip
    found = analysed(loaded.since(skipped), setup)
    print_parts(found.printed())
    if found.note:
        show_warning(found.note)
    if out:
        write_result(dataclasses.asdict(found), out)
    if plot:
        from tweezer.plots import rheology_figure

        write_figure(rheology_figure(found), plot)
    tell_written(out, plot)
    if found.findings:
        raise typer.Exit(FAILED)


def _check_known(loaded: Recording, given: set[str]) -> None:
    """Refuse options that contradict the scene of a run, and missing ones for a table.

    `given` contains the names of the options that describe bead, medium and wall.
    """
    if loaded.scene is not None and given:
        raise ResultError(
            f"{loaded.name}: does not accept the {', the '.join(sorted(given))}, which its scene "
            "has"
        )
    if loaded.scene is None and not {"temperature", "radius"} <= given:
        raise ResultError(f"{loaded.name}: requires --temperature and --radius")
