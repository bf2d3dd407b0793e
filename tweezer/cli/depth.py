"""The command `tweezer fit-depth`."""

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
    Quiet,
    Rate,
    Scale,
    app,
    quantity_in,
    scene_with,
    settings_of,
)
from tweezer.cli.completion import complete_scene
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
from tweezer.values.errors import ResultError

Frames = Annotated[
    str,
    typer.Argument(
        help="Table with t, x, y (CSV, HDF5, .npy, .mat), or NetCDF file of a run.",
        metavar="TRACK",
    ),
]
SceneOfTrack = Annotated[
    str,
    typer.Option(
        help="Shipped scene or TOML file.", metavar="SCENE", autocompletion=complete_scene
    ),
]
Noise = Annotated[
    str | None, typer.Option(help='Noise of the camera, e.g. "15 nm". Default: fitted.')
]
Exposure = Annotated[
    str | None,
    typer.Option(help='Exposure time of a frame, e.g. "2 ms". Default: that of a run, else 0.'),
]
Search = Annotated[
    tuple[str, str] | None,
    typer.Option(
        help='Range of release depths to search, e.g. "-8 um" "2 um". Default: three quarters of '
        "the force map."
    ),
]
Fitted = Annotated[
    list[str] | None,
    typer.Option(
        help="Further quantity to fit: power, radius, scaling_factor or release. May be repeated.",
        metavar="NAME",
    ),
]


@app.command("fit-depth")
def fit_depth(
    track: Frames, scene: SceneOfTrack, noise: Noise = None, exposure: Exposure = None,
    search: Search = None, fit: Fitted = None, columns: Columns = None, rate: Rate = None,
    scale: Scale = None, bead: Bead = None, set: Changes = None, out: JsonFile = None,
    plot: FigureFile = None, overwrite: Overwrite = False, details: Details = False,
    quiet: Quiet = False,
) -> None:  # fmt: skip
    """Determine the release depth from a TRACK.

    The depth is the coordinate along the light; the track contains the coordinates across the
    light. Exit code: 0 if the depth is determined, 1 if it is not or if the track refutes the
    scene, 2 if the input is refused.
    """
    begin(details=details, quiet=quiet)
    from tweezer.values.units import Length, PositiveLength, Time

    described = scene_with(scene, settings_of(set or []))
    given = quantity_in("--noise", noise, PositiveLength) if noise is not None else None
    exposed = quantity_in("--exposure", exposure, Time) if exposure is not None else None
    range_ = None
    if search is not None:
        low, high = (quantity_in("--search", text, Length) for text in search)
        range_ = low, high
    out = out and writable_result(out, ("json",), overwrite=overwrite)
    plot = writable_figure(plot, overwrite=overwrite)

    from tweezer.optics import ray_optics_worth, rows_of_light
    from tweezer.reading import load_track
    from tweezer.tracking import fit_depth as fitted

    loaded = load_track(track, columns=columns, rate=rate, scale=scale, bead=bead)
    if loaded.scene is not None and loaded.scene.bead != described.bead:
        raise ResultError(
            f"{track}: is a run of a bead that differs from the bead of {described.name}"
        )
    with showing_progress(described.name) as progress:
        found = fitted(
            loaded, described, noise=given, exposure=exposed, search=range_, fit=fit or (),
            progress=progress,
        )  # fmt: skip
    card = found.card()
    print_card(dataclasses.replace(card, rows=(*card.rows, *rows_of_light(described))))
    if out:
        apart = ("minima", "parameters", "path")
        result = {name: value for name, value in vars(found).items() if name not in apart}
        lists = {
            name: [dataclasses.asdict(each) for each in getattr(found, name)]
            for name in ("minima", "parameters")
        }
        worth = ray_optics_worth(described)
        write_result({**result, **lists, "ray_optics": worth and dataclasses.asdict(worth)}, out)
    if plot:
        from tweezer.plots import depth_figure

        write_figure(depth_figure(loaded, found), plot)
    tell_written(out, plot)
    if not found.determined:
        raise typer.Exit(FAILED)
