"""Saving and loading of every kind of result of `tweezer.values.saved.KINDS`."""

from __future__ import annotations

import dataclasses
import importlib
import math
from pathlib import Path
from types import NoneType
from typing import Any, get_args, get_origin, get_type_hints

from pydantic import BaseModel, TypeAdapter, ValidationError

from tweezer.results.io import load_result, save_run, write_result
from tweezer.results.schema import of_validation
from tweezer.values.errors import ResultError
from tweezer.values.saved import Kind, check_ending, kind_of, read_json


def save(result: Any, path: str | Path) -> Path:
    """Save a result to a file, from which `load` returns it.

    An existing file is replaced once the new one is complete. The file contains a checksum, with
    which `load` detects damage.

    Parameters
    ----------
    result : Dataset, Trap, Calibration, Rheology, SceneFit or another result
        A result of `simulate`, `ensemble`, `sweep`, `trap_over_heights`, `SceneLight.field`,
        `characterise`, `calibrate`, `rheology`, `find_wall`, `fit`, `fit_depth`, `tune` or
        `calibration.together`, which returns a tuple.
    path : str or Path
        Name of the file. It must end in `.nc` for a dataset and in `.json` for any other result.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    ResultError
        If the result is of an unknown kind, the name has another ending, or the file cannot be
        written.

    Notes
    -----
    The lifetime of a trap is saved too, and is computed if it is not known yet.

    Examples
    --------
    >>> trap = tweezer.characterise(tweezer.load_scene("silica-1um"))
    >>> path = tweezer.save(trap, "trap.json")
    >>> tweezer.load(path).reach == trap.reach
    True
    """
    path = Path(path)
    kind = None if isinstance(result, dict) else kind_of(result)
    if kind is None:
        name = type(result).__name__
        raise ResultError(f"{path}: cannot be saved: this {name} is not a result of tweezer")
    if not kind.of:
        return save_run(result, path)
    check_ending(path, ("json",))
    content = content_of(result)
    if kind.within:
        content = dict.fromkeys(kind.marks, ()) | {kind.within: content}
    write_result(content, path, not_finite="strings")
    return path


def content_of(result: Any) -> dict[str, Any]:
    """Return the content of the JSON file of a result that is not a dataset."""
    kind = kind_of(result)
    if kind is not None and kind.reader:
        content: dict[str, Any] = importlib.import_module(kind.reader).content_of(result)
        return content
    plain: dict[str, Any] = _plain(result)
    return plain


def load(path: str | Path) -> Any:
    """Load a result from a file of `save`, or of `--out` of a command.

    Parameters
    ----------
    path : str or Path
        File (`.nc`, `.json`) or store (`.zarr`) of a result.

    Returns
    -------
    Dataset, Trap, Calibration, Rheology, SceneFit or another result
        The result, with the type that it had when it was computed. A dataset in a store is read on
        demand.

    Raises
    ------
    ResultError
        If the file contains no result, is damaged, or lacks a value.

    Notes
    -----
    A file that a command wrote contains less than a file of `save`:

    * An infinite or unknown number is stored as null. It is loaded as NaN where a number is
      required.
    * The file of `tweezer fit-depth` lacks the predicted path: `DepthFit.path` is None.
    * The file of `tweezer calibrate` for several recordings also contains their calibrations. Only
      the means, or the wall position, are loaded.

    Examples
    --------
    >>> run = tweezer.simulate(tweezer.load_scene("silica-1um"), duration="1 ms")
    >>> path = tweezer.save(run, "run.nc")
    >>> tweezer.load(path).identical(run)
    True
    """
    path = Path(path)
    if path.suffix.lower() != ".json":
        return load_result(path)
    return result_in(read_json(path), path)


def result_in(content: Any, path: Path) -> Any:
    """Return the result in the content of a JSON file, for `load`."""
    kind = kind_of(content)
    if kind is None or not kind.of:
        raise ResultError(f"{path}: is not a known kind of result")
    if kind.reader:
        return importlib.import_module(kind.reader).result_in(content, path)
    return _loaded(kind, content, path)


def _plain(value: Any) -> Any:
    """Return a result as dictionaries and lists, with the set keys of a scene."""
    if isinstance(value, BaseModel):
        return value.model_dump(mode="json", exclude_none=True)
    if dataclasses.is_dataclass(value):
        return {each.name: _plain(getattr(value, each.name)) for each in dataclasses.fields(value)}
    if isinstance(value, list | tuple):
        return [_plain(each) for each in value]
    return value


def _loaded(kind: Kind, content: dict[str, Any], path: Path) -> Any:
    """Return the result of a kind from the content of a JSON file."""
    module, name = kind.of.split(":")
    of: Any = getattr(importlib.import_module(module), name)
    saved = content[kind.within] if kind.within else content
    if kind.several:
        of = tuple[of, ...]
    try:
        return TypeAdapter(of).validate_python(_with_nan(of, saved))
    except ValidationError as error:
        raise ResultError(
            f"{path}: not {kind.told} as tweezer saves it: {of_validation(error)}"
        ) from None


def _with_nan(of: Any, saved: Any) -> Any:
    """Return `saved` with NaN instead of null where its type requires a number."""
    parts = [each for each in get_args(of) if each is not Ellipsis]
    if NoneType in parts:
        return None if saved is None else _with_nan(parts[0], saved)
    if of is float and saved is None:
        return math.nan
    if dataclasses.is_dataclass(of) and isinstance(saved, dict):
        types = get_type_hints(of)
        return {name: _with_nan(types.get(name), each) for name, each in saved.items()}
    collection = get_origin(of) or of
    entries = isinstance(collection, type) and issubclass(collection, list | tuple)
    if isinstance(saved, list) and entries and parts:
        every = parts if len(parts) == len(saved) else parts[:1] * len(saved)
        return [_with_nan(part, each) for part, each in zip(every, saved, strict=True)]
    return saved
