"""The command `tweezer examples`, which copies recordings for trying calibrations."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, NamedTuple

import typer

from tweezer.cli.app import Overwrite, app
from tweezer.cli.completion import among
from tweezer.cli.console import OUT, writable_result
from tweezer.cli.tables import table_of
from tweezer.values.errors import ResultError
from tweezer.values.files import replacing

FOLDER = Path(__file__).parents[1] / "examples"


class Example(NamedTuple):
    """A shipped recording, with a command to try on it."""

    about: str
    """description in one line"""
    command: str
    """command line to try"""


EXAMPLES = {
    "trapped-bead.csv": Example(
        "1 um silica bead in a trap of 41.8 pN/um, 4 kHz, simulated",
        'tweezer calibrate trapped-bead.csv --temperature "20 degC" --radius "0.5 um" '
        '--viscosity "1.002 mPa s" --blur 0',
    ),
    "free-beads.csv": Example(
        "12 free beads that diffuse by 0.43 um^2/s, 20 frames a second, simulated",
        'tweezer calibrate free-beads.csv --rate "20 Hz" --temperature "20 degC" --blur 0',
    ),
}


@app.command()
def examples(
    name: Annotated[
        str | None,
        typer.Argument(
            help="Recording to copy to this folder.", metavar="NAME", autocompletion=among(EXAMPLES)
        ),
    ] = None,
    overwrite: Overwrite = False,
) -> None:
    """Copy an example recording, or list them.

    The recordings are simulated, so the true values are known.
    """
    if name is None:
        table = table_of("recording", "what it is")
        for each, example in EXAMPLES.items():
            table.add_row(each, example.about)
        OUT.print(table)
        OUT.print("tweezer examples NAME copies one here", highlight=False)
        return
    file = f"{name.removesuffix('.csv')}.csv"
    if file not in EXAMPLES:
        raise ResultError(f"NAME = {name!r}: no such recording; choose from: {', '.join(EXAMPLES)}")
    path = writable_result(Path(file), ("csv",), overwrite=overwrite, option="folder")
    with replacing(path) as whole:
        whole.write((FOLDER / file).read_bytes())
    OUT.print(f"wrote {path}", highlight=False)
    OUT.print(f"  {EXAMPLES[file].command}", highlight=False, soft_wrap=True)
