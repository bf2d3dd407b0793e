"""Scene files: the shipped ones by name, and the data in a file."""

from __future__ import annotations

import difflib
import tomllib
from pathlib import Path
from typing import Any

from tweezer.scene.courses import with_tables
from tweezer.values.errors import SceneError
from tweezer.values.files import read_text
from tweezer.values.saved import kind_of_file

SHIPPED = Path(__file__).parents[1] / "scenes"
#: Errors of `tomllib`: its own, and those for numbers that are too long or nesting too deep
NOT_TOML = (ValueError, RecursionError)


def shipped_scenes() -> dict[str, Path]:
    """Return the shipped scene files by name.

    Returns
    -------
    dict of str to Path
        Files, by the names that `load_scene` accepts.

    Examples
    --------
    >>> "silica-1um" in tweezer.shipped_scenes()
    True
    """
    return {path.stem: path for path in sorted(SHIPPED.glob("*.toml"))}


def read_scene(name: str) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the data of a shipped scene or a TOML file, with and without its tables from files.

    Raises `SceneError` if there is no such scene or it cannot be read.
    """
    if not name:
        raise SceneError("no scene given; must be a shipped scene or a TOML file")
    path = shipped_scenes().get(name, Path(name))
    try:
        data = tomllib.loads(read_text(path))
    except FileNotFoundError:
        raise SceneError(
            f"no scene file {name!r}, and no shipped scene of that name; {_shipped_like(path)}"
        ) from None
    except (*NOT_TOML, OSError) as error:
        if (kind := kind_of_file(path)) and kind.name != "scene":
            reason = f"is {kind.told}, not a scene{kind.way(name)}"
        elif isinstance(error, UnicodeDecodeError):
            reason = "not a text file in UTF-8"
        elif isinstance(error, OSError):
            reason = f"cannot be read: {error.strerror}"
        else:
            reason = f"not valid TOML: {error}"
        raise SceneError(f"{name!r}: {reason}") from None
    if not data:
        raise SceneError(f"{name!r}: is empty; `tweezer new` writes a scene")
    try:
        whole = with_tables(data, path.parent)
    except ValueError as error:
        raise SceneError(f"{name!r}: {error}") from None
    return {"name": path.stem, **whole}, data


def _shipped_like(path: Path) -> str:
    """Return the end of a message: the shipped scene that was probably meant, or all of them."""
    shipped = list(shipped_scenes())
    near = difflib.get_close_matches(path.name.removesuffix(".toml"), shipped, n=1, cutoff=0.5)
    near += [name for name in shipped if path.stem and path.stem in name]
    return f"did you mean {near[0]}?" if near else f"shipped: {', '.join(shipped)}"
