"""Reading and checking of the traps of bodies that `tweezer trap --out` saves."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter, ValidationError

from tweezer.dynamics.escape import Escape
from tweezer.results.schema import of_validation
from tweezer.trap.body import BodyEquilibrium, BodyTrap
from tweezer.values.errors import ResultError
from tweezer.values.version import __version__


def content_of(trap: BodyTrap) -> dict[str, Any]:
    """Return the content of the file of the trap of a body."""
    scene = trap.scene.model_dump(mode="json", exclude_none=True)
    return {"tweezer_version": __version__, "scene": scene, "body_trap": trap.content()}


def result_in(saved: Any, path: Path) -> BodyTrap:
    """Return the trap of a body in the content of a file, for `tweezer.load`.

    Raises `ResultError` if the content is not the trap of a body.
    """
    try:
        found = _known(BodyTrap, saved["body_trap"])
        held = found["equilibrium"]
        trap: BodyTrap = TypeAdapter(BodyTrap).validate_python(
            found
            | {
                "scene": saved["scene"],
                "equilibria": _each(BodyEquilibrium, found["equilibria"]),
                "equilibrium": held and _known(BodyEquilibrium, held),
                "escapes": _each(Escape, found["escapes"]),
            }
        )
        for reason in _wrong(trap):
            raise ValueError(reason)
    except ValidationError as error:
        raise ResultError(f"{path}: not the trap of a body: {of_validation(error)}") from None
    except KeyError as error:
        raise ResultError(f"{path}: not the trap of a body: it has no {error.args[0]}") from None
    except (TypeError, ValueError, AttributeError) as error:
        reason = " ".join(str(error).split())
        raise ResultError(f"{path}: not the trap of a body: {reason}") from None
    return trap


def _each(of: type[Any], saved: Any) -> Any:
    """Return a list of entries for a class, as `_known` does; anything else is unchanged."""
    return [_known(of, each) for each in saved] if isinstance(saved, list) else saved


def _known(of: type[Any], saved: dict[str, Any]) -> dict[str, Any]:
    """Return the entries `saved` for a class, with NaN for numbers that JSON stores as null."""
    lost = [each.name for each in dataclasses.fields(of) if each.type == "float"]
    return saved | {name: math.nan for name in lost if saved[name] is None}


def _wrong(trap: BodyTrap) -> Iterator[str]:
    """Yield messages about contradictions and wrong shapes in a saved trap."""
    if trap.scene.bead.shape == "sphere":
        yield "its bead is a sphere"
    for each in trap.equilibria:
        for name, shape in (
            ("position", (3,)), ("orientation", (4,)), ("stiffness", (6, 6)),
            ("eigenvalues", (6, 2)), ("relaxation_rates", (6, 2)), ("rotation", (3,)),
        ):  # fmt: skip
            found = getattr(each, name)
            if found is not None and found.shape != shape:
                yield f"{name}: must have the shape {shape}"
    if trap.equilibrium is not None and trap.equilibrium not in trap.equilibria:
        yield "its stable equilibrium is not among its equilibria"
    if bool(trap.escapes) != (trap.equilibrium is not None):
        yield "it has escapes without an equilibrium, or an equilibrium without escapes"
