"""Reading and checking of traps saved by `tweezer trap --out`."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter, ValidationError

from tweezer.dynamics.escape import Escape
from tweezer.forces.equilibria import DIRECTIONS
from tweezer.results.schema import of_validation
from tweezer.scene.media import GASES
from tweezer.trap import levitation
from tweezer.trap.holding import Lifetime
from tweezer.trap.trap import Trap
from tweezer.values.errors import ResultError
from tweezer.values.saved import kind_of, read_json
from tweezer.values.version import __version__

#: Entries of the file that are not fields of `Trap`
_BESIDE = (
    "lifetime", "lifetime_caveat", "lifetime_without_light", "least_drag", "least_pressure",
    "recoil_heating", "recoil_pressures", "temperatures", "photon_recoil",
)  # fmt: skip
#: Entries that are missing in files of older versions, with their defaults
_NEWER: dict[str, Any] = {
    "resonance_frequencies": None, "quality_factors": None, "rings": [], "searched": "",
}  # fmt: skip
#: Largest plausible distance from the focus, m
_FARTHEST = 1.0


def content_of(trap: Trap) -> dict[str, Any]:
    """Return the content of the file of a trap, with its lifetime."""
    scene = trap.scene.model_dump(mode="json", exclude_none=True)
    content = dataclasses.asdict(trap)
    del content["scene"]
    held, without = trap.lifetime, trap.lifetime_without_light
    content["lifetime"] = held and dataclasses.asdict(held) | {"words": held.words}
    content["lifetime_caveat"] = trap.lifetime_caveat
    content["lifetime_without_light"] = without and dataclasses.asdict(without)
    if trap.scene.medium.name in GASES:
        content |= levitation.content_of(trap)
    return {
        "tweezer_version": __version__,
        "scene": scene,
        "trap": content,
    }


def result_in(saved: Any, path: Path) -> Trap:
    """Return the trap in the content of a file, for `tweezer.load`."""
    return trap_in(saved, path)[0]


def load_trap(path: Path) -> tuple[Trap, str]:
    """Return the trap in a file of `tweezer trap --out`, and the version that computed it.

    Raises `ResultError` if the file does not contain a trap.
    """
    return trap_in(read_json(path), path)


def trap_in(saved: Any, path: Path) -> tuple[Trap, str]:
    """Return the trap in the content of a file, and the version that computed it."""
    if (kind := kind_of(saved)) and kind.name != "trap":
        raise ResultError(f"{path}: not a saved trap: is {kind.told}{kind.way(path.name)}")
    try:
        found = _known(Trap, _NEWER | saved["trap"])
        version = str(saved["tweezer_version"])
        lifetime, _, without_light, *_, recoil = (found.pop(name, None) for name in _BESIDE)
        escapes = [_known(Escape, each) for each in found["escapes"]]
        rings = [each | {"escapes": _escapes(each["escapes"])} for each in found["rings"]]
        trap = TypeAdapter(Trap).validate_python(
            found | {"scene": saved["scene"], "escapes": escapes, "rings": rings}
        )
        for reason in _misshapen(trap):
            raise ValueError(reason)
        if trap.equilibrium is not None:  # the file contains it twice
            same = trap.equilibria.index(trap.equilibrium)
            trap = dataclasses.replace(trap, equilibrium=trap.equilibria[same])
        for reason in _wrong(trap):
            raise ValueError(reason)
        if "lifetime" in saved["trap"]:
            vars(trap)["lifetime"] = lifetime and _lifetime(lifetime)
            vars(trap)["lifetime_without_light"] = without_light and _lifetime(without_light)
        if "photon_recoil" in saved["trap"]:
            validated = TypeAdapter(levitation.Recoil | None).validate_python(recoil)
            vars(trap)["photon_recoil"] = validated
    except ValidationError as error:
        raise ResultError(f"{path}: not a saved trap: {of_validation(error)}") from None
    except KeyError as error:
        raise ResultError(f"{path}: not a saved trap: it has no {error.args[0]}") from None
    except (TypeError, ValueError, AttributeError) as error:
        raise ResultError(f"{path}: not a saved trap: {' '.join(str(error).split())}") from None
    return trap, version


def _known(of: type[Trap] | type[Escape], saved: dict[str, Any]) -> dict[str, Any]:
    """Return the entries `saved` for a class, with NaN for numbers that JSON stores as null."""
    lost = [each.name for each in dataclasses.fields(of) if each.type == "float"]
    return saved | {name: math.nan for name in lost if saved[name] is None}


def _escapes(saved: list[dict[str, Any]]) -> list[Escape]:
    """Return the escapes from their entries in a file."""
    return [TypeAdapter(Escape).validate_python(_known(Escape, each)) for each in saved]


def _lifetime(saved: dict[str, Any]) -> Lifetime:
    """Return a lifetime from its entries in a file, in which an infinite time is null."""
    time = math.inf if saved["time"] is None else saved["time"]
    return TypeAdapter(Lifetime).validate_python(saved | {"time": time})


def _misshapen(trap: Trap) -> Iterator[str]:
    """Yield messages about vectors and matrices with a wrong shape."""
    every: list[tuple[str, Any, tuple[int, ...]]] = [
        (name, getattr(trap, name), (3,))
        for name in (
            "drag", "corner_frequencies", "resonance_frequencies", "quality_factors", "torque",
        )
    ]  # fmt: skip
    for place in (*trap.equilibria, *([trap.equilibrium] if trap.equilibrium else ())):
        every += [
            ("position", place.position, (3,)), ("eigenvalues", place.eigenvalues, (3,)),
            ("stiffness", place.stiffness, (3, 3)),
        ]  # fmt: skip
    every += [("stiffness", ring.stiffness, (2, 2)) for ring in trap.rings]
    for name, found, shape in every:
        if found is not None and found.shape != shape:
            yield f"{name}: must have the shape {shape}"


def _wrong(trap: Trap) -> Iterator[str]:
    """Yield messages about contradictions and implausible lengths in a saved trap."""
    place = trap.equilibrium
    if bool(trap.escapes) != (place is not None):
        yield "it has escapes without an equilibrium, or an equilibrium without escapes"
    if place is not None:
        if trap.corner_frequencies is None or trap.drag is None:
            yield "it has an equilibrium without its drag or corner frequencies"
        if not all(0 < each < math.inf for each in place.eigenvalues):
            yield "its equilibrium is not stable"
        if [each.direction for each in trap.escapes] != list(DIRECTIONS):
            yield f"its escape directions are not {', '.join(DIRECTIONS)}"
    lengths = {
        "reach": [trap.reach],
        "equilibria": [z for each in trap.equilibria for z in each.position],
        "rings": [z for each in trap.rings for z in each.position],
        "escapes": [
            length
            for each in trap.escapes
            for length in (each.force_at, each.range, each.wall_at)
            if length is not None
        ],
    }
    for name, found in lengths.items():
        if not all(-_FARTHEST <= each <= _FARTHEST for each in found):
            yield f"{name}: must be within {_FARTHEST:g} m of the focus"
