"""Files of results, written atomically: runs as NetCDF and others as JSON."""

from __future__ import annotations

import contextlib
import hashlib
import json
import sys
from collections.abc import Iterator, Mapping
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import pydantic_core
from pydantic import ValidationError

from tweezer.results.run import Run
from tweezer.results.schema import checked
from tweezer.scene import Scene, by_key, described_at
from tweezer.values.errors import ResultError
from tweezer.values.files import check_regular, digest, replacing
from tweezer.values.prefixes import usual_unit
from tweezer.values.saved import DIGEST, RESULTS, check_ending, kind_of, kind_of_file

if TYPE_CHECKING:
    import xarray as xr

_ENGINE: Literal["h5netcdf"] = "h5netcdf"

#: Marker between the content of a saved run and its SHA-256. HDF5 ignores bytes after its own end,
#: and drops them when it changes a file.
_SEAL = b"\ntweezer sha256:\n"
#: Number of bytes that enter the digest at a time
_AT_ONCE = 2**24


def save_run(run: xr.Dataset, path: str | Path) -> Path:
    """Write a run to a NetCDF file, which changes only once the new content is complete.

    A checksum at the end of the file lets `load_run` detect damage.

    Parameters
    ----------
    run : xarray.Dataset
        Run of `tweezer.simulate`.
    path : str or Path
        Name of the file, ending in .nc.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    ResultError
        If the file cannot be written, or its name does not end in .nc.
    """
    path = Path(path)
    check_ending(path, ("nc",))
    no_fill: dict[Any, Any] = {name: {"_FillValue": None} for name in run.coords}  # as CF wants
    with _no_cluster():
        content = run.to_netcdf(engine=_ENGINE, encoding=no_fill)
    _write_sealed(content, path)
    return path


def write_run(run: Run, path: Path) -> None:
    """Write a run to a file before it becomes a dataset, as `save_run` does."""
    import h5netcdf
    import h5py

    content = BytesIO()
    with h5netcdf.File(content, "w") as file:
        file.attrs.update(run.attributes)
        for name, (dimensions, values, attributes) in (run.coordinates | run.variables).items():
            for dimension, length in zip(dimensions, values.shape, strict=True):
                file.dimensions.setdefault(dimension, length)
            text = values.dtype.kind == "U"
            stored = values.astype(h5py.string_dtype()) if text else values
            fill = None if text or name in run.coordinates else np.nan
            made = file.create_variable(name, dimensions, data=stored, fillvalue=fill)
            made.attrs.update(attributes)
            if beside := run.beside(name):
                made.attrs["coordinates"] = " ".join(beside)
    _write_sealed(content.getbuffer(), path)


def _write_sealed(content: memoryview, path: Path) -> None:
    """Write the content of a file, followed by its digest."""
    with replacing(path) as whole:
        whole.write(content)
        whole.write(_SEAL + hashlib.sha256(content).digest())


def _no_cluster() -> contextlib.AbstractContextManager[object]:
    """Return a context in which xarray does not request a lock from the cluster of a Dask client.

    Such a lock is named after the file, and a file in memory has no name.
    """
    if "distributed" not in sys.modules:
        return contextlib.nullcontext()
    import dask

    return dask.config.set(scheduler="single-threaded")


def write_json(value: object, path: Path) -> None:
    """Write `value` to `path` as JSON; an existing file changes only once the new one is complete.

    Numbers that are unknown or not finite become null, because JSON has no NaN. Raises
    `ResultError` if the file cannot be written.
    """
    with replacing(path) as whole:
        whole.write(_as_json(value))


def write_result(
    result: Mapping[str, Any], path: Path, not_finite: Literal["null", "strings"] = "null"
) -> None:
    """Write a result as JSON with a digest, by which `saved.read_json` detects changes.

    It is written as by `write_json`. With `not_finite="strings"`, numbers that are not finite are
    written as "NaN", "Infinity" and "-Infinity".
    """
    with replacing(path) as whole:
        plain = json.loads(_as_json(result, not_finite))
        whole.write(_as_json(plain | {DIGEST: digest(plain)}))


def _as_json(value: object, not_finite: Literal["null", "strings"] = "null") -> bytes:
    """Return a value as JSON; `not_finite` numbers become null or strings."""
    text = pydantic_core.to_json(
        value, indent=2, inf_nan_mode=not_finite, fallback=lambda array: array.tolist()
    )
    return text + b"\n"


def load_run(path: str | Path) -> xr.Dataset:
    """Return a saved run, read into memory.

    Parameters
    ----------
    path : str or Path
        File of a run.

    Returns
    -------
    xarray.Dataset
        The run.

    Raises
    ------
    ResultError
        For a file that does not contain a run, and for a damaged file.
    """
    run = load_result(Path(path))
    kind = kind_of(run)
    if kind is None:
        raise ResultError(
            f"{path}: not a saved run: an attribute or a variable of a run is missing"
        )
    if kind.name not in ("run", "beads"):
        raise ResultError(
            f"{path}: not a saved run: is {kind.told}; `xarray.open_dataset` reads it"
        )
    return run


def load_result(path: Path) -> xr.Dataset:
    """Load a saved result: a file (.nc), or a store (.zarr), which is read on demand.

    Raises `ResultError` for a file or folder that is not a result, is damaged, or incomplete.
    """
    if path.suffix.lower() == ".zarr":
        from tweezer.values.stores import open_store

        return checked(open_store(path), f"{path}")
    if path.suffix.lower() not in RESULTS and (kind := kind_of_file(path)):
        raise ResultError(f"{path}: is {kind.told}, not a result{kind.way(path.name)}")
    import xarray as xr

    with _reading(path):
        result = xr.load_dataset(path, engine=_ENGINE, decode_times=False)
    if "scene" not in result.attrs:
        raise ResultError(f"{path}: not a saved run: it contains no scene")
    return checked(result, f"{path}")


@contextlib.contextmanager
def _reading(path: Path) -> Iterator[None]:
    """Return a context for reading the file of a run; raises `ResultError` if it is damaged."""
    from tweezer.values.hdf5 import check_result

    try:
        check_seal(path)
        check_result(path)
        yield
    except FileNotFoundError:
        raise ResultError(f"{path}: no such file") from None
    except IsADirectoryError:
        raise ResultError(f"{path}: is a folder") from None
    except ResultError:
        raise
    except Exception as error:  # h5py and h5netcdf raise errors of any type for a damaged file
        reason = " ".join(str(error).split())
        raise ResultError(f"{path}: not a saved run: {reason}") from None


def check_seal(path: Path) -> None:
    """Raise `ResultError` if the digest at the end of a file does not match its content.

    A file without a digest is accepted.
    """
    check_regular(path)
    behind = len(_SEAL) + hashlib.sha256().digest_size
    end = path.stat().st_size - behind
    if end <= 0:
        return
    with path.open("rb") as file:
        file.seek(end)
        seal = file.read(behind)
        if not seal.startswith(_SEAL):
            return
        file.seek(0)
        digest = hashlib.sha256()
        while end > 0 and (part := file.read(min(end, _AT_ONCE))):
            digest.update(part)
            end -= len(part)
    if seal != _SEAL + digest.digest():
        raise ResultError(f"{path}: damaged: its content differs from what was saved")


def scene_of(run: xr.Dataset) -> Scene:
    """Return the scene of a run.

    Parameters
    ----------
    run : xarray.Dataset
        Run of tweezer.

    Returns
    -------
    Scene
        Scene that the run stores.

    Raises
    ------
    ResultError
        If the run has no valid scene.

    Examples
    --------
    >>> run = tweezer.simulate("silica-1um", "1 ms")
    >>> tweezer.scene_of(run).bead.radius
    5e-07
    """
    return scene_in(run.attrs)


def scene_in(attributes: Mapping[str, Any]) -> Scene:
    """Return the scene in the attributes of a run; raise `ResultError` without a valid one."""
    try:
        return Scene.model_validate_json(attributes["scene"])
    except (KeyError, ValidationError):
        raise ResultError("not a run: it contains no valid scene") from None


def unlike(path: Path, scene: Scene, seed: int, continued: str = "", forces_from: str = "") -> str:
    """Return how the file at `path` differs from a run of `scene` and `seed`; "" if it does not.

    The name of a run and its method of computation are not compared.
    Parameters
    ----------
    path : Path
        File to compare.
    scene : Scene
        Scene of the run.
    seed : int
        Seed of the thermal motion.
    continued : str
        Attribute `continued_from` of the run; "" for a run from the release.
    forces_from : str
        Attribute `forces_from` of the run; "" without the user's own forces.
    """
    import h5netcdf

    try:
        with _reading(path), h5netcdf.File(path, "r") as file:
            made = dict(file.attrs)
        there = by_key(json.loads(made["scene_as_given"]))
    except (ResultError, KeyError, ValueError, AttributeError):
        return "already exists, and is no run that can be compared"
    if made.get("other_forces", 0) and not (made.get("forces_from") == forces_from != ""):
        return "already holds a run with other forces beside those of its scene"
    if forces_from and not made.get("other_forces", 0):
        return "already holds a run without forces beside those of its scene"
    if made.get("continued_from", "") != continued:
        return "already holds a run from another beginning"
    here = by_key(scene.model_dump(mode="json", exclude_none=True))
    if scene.draws:
        there, here = there | {"seed": made.get("seed")}, here | {"seed": seed}
    different = [key for key in here | there if here.get(key) != there.get(key)]
    for key in different:
        if key in there:
            return f"already holds a run with {key} = {_shown(key, there[key])}"
    return f"already holds a run without {different[0]}" if different else ""


def _shown(key: str, value: Any) -> str:
    """Return the value of a scene's key as text, with quantities in a usual unit."""
    if isinstance(value, bool) or not isinstance(value, int | float) or key == "seed":
        return str(value)
    quantity, _ = described_at(key)
    if quantity is None or not quantity.unit:
        return f"{value:.6g}"
    factor, unit = usual_unit(value, quantity.unit)
    return f"{value / factor:.6g} {unit}"
