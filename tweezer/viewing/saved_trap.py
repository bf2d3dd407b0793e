"""The page of a trap saved by `tweezer trap --out`."""

from __future__ import annotations

import dataclasses
from pathlib import Path

from tweezer.trap.saved_trap import load_trap
from tweezer.values.errors import ResultError
from tweezer.values.saved import SHOWN, kind_of_file, refusal
from tweezer.viewing import of_trap
from tweezer.viewing.content import Content


def content(path: Path) -> Content:
    """Return the content of the page of a saved trap, with a note that it was saved.

    Raises `ResultError` if the file is not a saved trap.
    """
    if (kind := kind_of_file(path)) and kind.name != "trap":
        raise ResultError(f"{path}: {refusal(kind, 'view', SHOWN)}")
    trap, version = load_trap(path)
    shown = of_trap.content(trap)
    return dataclasses.replace(
        shown,
        facts=shown.facts | {"subtitle": f"saved in {path.name}, computed by tweezer {version}"},
        notes=[
            f"Equilibria, stiffness, ways out and all else in the summary are those of the saved "
            f"trap {path.name}, which tweezer {version} computed. The force in the slice was "
            "computed from the scene in that file when this page was made.",
            *shown.notes,
        ],
    )
