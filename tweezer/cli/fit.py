"""The command `tweezer fit`."""

from __future__ import annotations

import dataclasses
from typing import Annotated

import typer

from tweezer.cli.app import (
    Bead,
    Changes,
    Columns,
    Details,
    FigureFile,
    JsonFile,
    Overwrite,
    OwnForces,
    Quiet,
    Rate,
    Scale,
    Skip,
    app,
    quantity_in,
    scene_with,
    settings_of,
)
from tweezer.cli.completion import complete_key, complete_scene
from tweezer.cli.console import (
    FAILED,
    begin,
    showing_progress,
    tell_written,
    writable_figure,
    writable_result,
    write_figure,
    write_result,
)
from tweezer.cli.tables import print_card
from tweezer.values.errors import SceneError


@app.command()
def fit(
    recordings: Annotated[
        list[str],
        typer.Argument(
            help="NetCDF file of a run, or a table with x, with x and y, or all three. Several "
            "recordings of one scene are fitted together.",
            metavar="RECORDING...",
        ),
    ],
    free: Annotated[
        list[str],
        typer.Option(
            help="Key of the scene to fit, e.g. bead.diameter. May be repeated.",
            metavar="KEY",
            autocompletion=complete_key,
        ),
    ],
    scene: Annotated[
        str | None,
        typer.Option(
            help="Shipped scene or TOML file with initial values. Default: the scene of the run.",
            metavar="SCENE",
            autocompletion=complete_scene,
        ),
    ] = None,
    set: Changes = None,
    force: OwnForces = None,
    columns: Columns = None,
    rate: Rate = None,
    scale: Scale = None,
    bead: Bead = None,
    skip: Skip = "0",
    out: JsonFile = None,
    plot: FigureFile = None,
    overwrite: Overwrite = False,
    details: Details = False,
    quiet: Quiet = False,
) -> None:
    """Fit keys of SCENE to a RECORDING.

    The keys are fitted by maximum likelihood, for a trapped bead. The scene's [camera] contains
    exposure and noise. Inertia is specified by the scene or the run; otherwise the inertia of bead
    and fluid is included. Exit code: 0 if every key is determined, 1 if a key is not or if the
    recording refutes the scene, 2 if the input is refused.
    """
    begin(details=details, quiet=quiet)
    from tweezer.values.units import Time

    if set and scene is None:
        raise SceneError("--set: requires --scene")
    described = scene_with(scene, settings_of(set or [])) if scene else None
    skipped = quantity_in("--skip", skip, Time)
    out = out and writable_result(out, ("json",), overwrite=overwrite)
    plot = writable_figure(plot, overwrite=overwrite)

    from tweezer.reading import load_recording
    from tweezer.tracking import fit as fitted

    loaded = [
        load_recording(each, columns=columns, rate=rate, scale=scale, bead=bead).since(skipped)
        for each in recordings
    ]
    with showing_progress(loaded[0].name) as progress:
        found = fitted(loaded, described, free=free, forces=force or [], progress=progress)
    print_card(found.card())
    if out:
        result = {
            name: value for name, value in vars(found).items() if name not in ("scene", "keys")
        }
        result["scene"] = found.scene.model_dump(mode="json", exclude_none=True)
        result["keys"] = [dataclasses.asdict(each) for each in found.keys]
        write_result(result, out)
    if plot:
        from tweezer.plots import fit_figure

        write_figure(fit_figure(found), plot)
    tell_written(out, plot)
    if not found.determined:
        raise typer.Exit(FAILED)
