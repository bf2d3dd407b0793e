"""The command `tweezer reproduce`."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Annotated

import typer

from tweezer.cli.app import Quiet, app
from tweezer.cli.console import OUT, awaited, begin, showing_progress
from tweezer.cli.tables import table_of
from tweezer.values.errors import PhysicsWarning


@app.command()
def reproduce(
    what: Annotated[
        list[str] | None,
        typer.Argument(
            help="Figures of the thesis (5.1 to 5.15, C.1 to C.12), claims, waves, memory or "
            "study. Default: all.",
            metavar="WHAT",
        ),
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder to write to.")] = Path("thesis-results"),
    seed: Annotated[int, typer.Option(help="Seed of the thermal motion.")] = 1,
    quiet: Quiet = False,
) -> None:
    """Reproduce the thesis: figures and claims.

    The command draws the figures, and judges the claims with ray optics and wave optics. It also
    computes the captures in a fluid with inertia, and studies why the 500 nm bead is lost.
    """
    begin(quiet=quiet)
    from tweezer.thesis import reproduce as reproduced

    with (
        showing_progress("reproduce", 1.0) as progress,
        warnings.catch_warnings(action="ignore", category=PhysicsWarning),
    ):
        result = reproduced(what or (), awaited(out), seed=seed, progress=progress)
    if result.claims:
        table = table_of("section", "claim", "verdict", "with wave optics")
        for claim in result.claims:
            table.add_row(claim.where, claim.text, claim.verdict, claim.verdict_by_waves)
        OUT.print(table)
    OUT.print(f"wrote {len(result.files)} files into {out}", highlight=False, soft_wrap=True)
