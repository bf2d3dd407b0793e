"""The command `tweezer compare`."""

from __future__ import annotations

from typing import Annotated

import typer

from tweezer.cli.app import Quiet, app
from tweezer.cli.console import FAILED, begin
from tweezer.cli.tables import print_card

Result = Annotated[
    str,
    typer.Argument(
        help="Run or statistics (.nc), ensemble or sweep (.zarr), trap or calibration (.json).",
        metavar="RESULT",
    ),
]


@app.command()
def compare(first: Result, second: Result, quiet: Quiet = False) -> None:
    """Test whether two results agree.

    Both results must be of the same kind, or a trap and a calibration, whose stiffnesses are
    compared. Runs agree if their distance at common times is within the sum of both errors. With
    thermal motion, means and variances are compared, and at most 1 % of comparisons differ by
    chance. The table lists the keys of the scene, methods and versions that differ. Exit code: 0 if
    the results agree, 1 if they differ, 2 if they cannot be compared.
    """
    begin(quiet=quiet)
    from tweezer.comparison import compare as compared

    found = compared(first, second)
    print_card(found.card())
    if not found.agrees:
        raise typer.Exit(FAILED)
