"""The command `tweezer stretch`."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Annotated

import typer

from tweezer.cli.app import (
    Changes,
    Details,
    JsonFile,
    Overwrite,
    Quiet,
    SceneName,
    app,
    scene_with,
    settings_of,
)
from tweezer.cli.console import (
    begin,
    showing_progress,
    tell_written,
    writable_result,
    write_result,
)
from tweezer.cli.tables import print_card


@app.command()
def stretch(
    scene: SceneName,
    seed: Annotated[int, typer.Option(help="Seed of the thermal motion.")] = 0,
    windows: Annotated[
        int, typer.Option(help="Number of windows of time that are averaged.", min=5)
    ] = 40,
    recording: Annotated[
        Path | None,
        typer.Option(
            help='Text file of an experiment with the columns "extension [nm]" and "force [pN]", '
            "at equal intervals, to use instead of a simulation.",
            metavar="FILE",
        ),
    ] = None,
    set: Changes = None,
    out: JsonFile = None,
    overwrite: Overwrite = False,
    details: Details = False,
    quiet: Quiet = False,
) -> None:
    """Stretch the molecule between two beads.

    The command simulates SCENE, in which a beam moves and pulls the beads apart, and fits contour
    length and persistence length to the force-extension curve. With --recording it fits the curve
    of an experiment, with the law, stretch modulus and temperature of SCENE.
    """
    begin(details=details, quiet=quiet)
    described = scene_with(scene, settings_of(set or []))
    out = out and writable_result(out, ("json",), overwrite=overwrite)
    from tweezer.tracking.stretching import stretch as stretched

    with showing_progress(described.name):
        found = stretched(described, seed, windows, recording=recording)
    print_card(found.fit.card())
    if out:
        curve = ("extension", "extension_error", "force", "force_error", "width")
        content = {name: getattr(found, name) for name in curve}
        write_result({"curve": content, "chain": dataclasses.asdict(found.fit)}, out)
    tell_written(out)
