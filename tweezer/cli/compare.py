"""The command compare."""

from __future__ import annotations

from typing import Annotated

import typer

from tweezer.cli.app import app
from tweezer.cli.console import FAILED
from tweezer.cli.tables import print_card

Result = Annotated[
    str,
    typer.Argument(
        help="Run or statistics (.nc), ensemble or sweep (.zarr), trap or calibration (.json).",
        metavar="RESULT",
    ),
]


@app.command()
def compare(first: Result, second: Result) -> None:
    """Whether two results agree within errors.

    Of runs the distance at common times and the sum of both errors; with thermal motion means and
    variances, told to differ by chance in at most 1 % of comparisons. And which keys of the scene,
    methods and versions differ. Exit code: 0 they agree, 1 they differ, 2 they cannot be compared.
    """
    from tweezer.comparison import compare as compared

    found = compared(first, second)
    print_card(found.card())
    if not found.agrees:
        raise typer.Exit(FAILED)
