"""Files: runs as NetCDF, results as JSON, written whole or not at all."""

from __future__ import annotations

import contextlib
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Literal

import pydantic_core
import xarray as xr

from tweezer.errors import ResultError
from tweezer.scene import Scene

_ENGINE: Literal["h5netcdf"] = "h5netcdf"


def save_run(run: xr.Dataset, path: str | Path) -> Path:
    """Write `run` to `path` as NetCDF; the file there changes only once the new one is whole.

    Raises `ResultError` if it cannot be written.
    """
    path = Path(path)
    with replacing(path) as whole:
        run.to_netcdf(whole, engine=_ENGINE)
    return path


@contextlib.contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Lend a path to write to; what was written takes the place of `path` at the end.

    Raises `ResultError` if it cannot be written; the file at `path` is then as it was.
    """
    try:
        with tempfile.TemporaryDirectory(prefix=".saving-", dir=path.parent) as folder:
            whole = Path(folder) / path.name
            yield whole
            whole.replace(path)
    except OSError as error:
        raise ResultError(f"{path}: cannot be written: {error.strerror or error}") from None


def write_json(value: object, path: Path) -> None:
    """Write `value` to `path`; the file there changes only once the new one is whole.

    JSON has no NaN: a number that is not known, or not finite, is written as null. Raises
    `ResultError` if it cannot be written.
    """
    with replacing(path) as whole:
        whole.write_bytes(pydantic_core.to_json(value, indent=2, inf_nan_mode="null") + b"\n")


def load_run(path: str | Path) -> xr.Dataset:
    """A saved run, read into memory. Raises `ResultError` for a file that is not one."""
    try:
        run = xr.load_dataset(path, engine=_ENGINE)
    except FileNotFoundError:
        raise ResultError(f"{path}: no such file") from None
    except OSError as error:
        raise ResultError(f"{path}: not a saved run: {error}") from None
    if "scene" not in run.attrs:
        raise ResultError(f"{path}: not a saved run: it names no scene")
    return run


def scene_of(run: xr.Dataset) -> Scene:
    """The scene that `run` was made from."""
    return Scene.model_validate_json(run.attrs["scene"])
