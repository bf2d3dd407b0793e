"""A trap that `tweezer trap --out` has saved, and its page."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter

from tweezer.analysis import Escape, Trap
from tweezer.analysis.holding import Lifetime
from tweezer.errors import ResultError
from tweezer.saved import SHOWN, kind_of, read_json, refusal
from tweezer.viewing import of_trap
from tweezer.viewing.content import Content

#: What the file has beside the fields of `Trap`
_BESIDE = ("lifetime", "lifetime_caveat")


def content(path: Path) -> Content:
    """What the page of a saved trap shows, and that it is one.

    Raises `ResultError` for a file that is no saved trap.
    """
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


def load_trap(path: Path) -> tuple[Trap, str]:
    """The trap that a file of `tweezer trap --out` holds, and the version that computed it.

    Raises `ResultError` for a file that is none.
    """
    saved = read_json(path)
    if (kind := kind_of(saved)) and kind.name != "trap":
        raise ResultError(f"{path}: {refusal(kind, 'view', SHOWN)}")
    try:
        found, version = _known(Trap, saved["trap"]), str(saved["tweezer_version"])
        lifetime, _ = (found.pop(name) for name in _BESIDE)
        escapes = [_known(Escape, each) for each in found["escapes"]]
        trap = TypeAdapter(Trap).validate_python(
            found | {"scene": saved["scene"], "escapes": escapes}
        )
        if trap.equilibrium is not None:  # the file has it a second time
            same = trap.equilibria.index(trap.equilibrium)
            trap = dataclasses.replace(trap, equilibrium=trap.equilibria[same])
        if bool(trap.escapes) != (trap.equilibrium is not None):
            raise ValueError("ways out of no equilibrium, or none of one")
        vars(trap)["lifetime"] = lifetime and _lifetime(lifetime)
    except (KeyError, TypeError, ValueError):
        raise ResultError(f"{path}: no saved trap, of which there is a page") from None
    return trap, version


def _known(of: type[Trap] | type[Escape], saved: dict[str, Any]) -> dict[str, Any]:
    """With NaN for numbers that are null: JSON has none that is not finite."""
    lost = [each.name for each in dataclasses.fields(of) if each.type == "float"]
    return saved | {name: math.nan for name in lost if saved[name] is None}


def _lifetime(saved: dict[str, Any]) -> Lifetime:
    """A time that is null is infinite."""
    time = math.inf if saved["time"] is None else saved["time"]
    return TypeAdapter(Lifetime).validate_python(saved | {"time": time})
