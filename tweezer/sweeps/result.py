"""Result of a sweep as a dataset, and its Zarr store."""

from __future__ import annotations

import shutil
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from tweezer.results.io import load_result
from tweezer.sweeps.cases import Cases
from tweezer.sweeps.quantities import FAILED, MISSING, QUANTITIES, Values
from tweezer.values.errors import ResultError
from tweezer.values.measured import DIMENSIONS
from tweezer.values.saved import kind_of
from tweezer.values.stores import checksums, seal

if TYPE_CHECKING:
    import xarray as xr

#: Descriptions of the variables that contain text
_WORDS = {
    "outcome": "what becomes of the bead, or of the case",
    "reason": "why a case failed, or where no trap was found",
    "caveat": "what speaks against the numbers of a case",
}
#: Descriptions of the dimensions that a quantity may have
_ALONG = {"axis": "axis, z along the light", "direction": "direction of the way out"}


def dataset_of(
    cases: Cases, of: str, done: Mapping[int, Values], attributes: Mapping[str, str]
) -> xr.Dataset:
    """Return the result of a sweep as a dataset, in the order of its cases.

    Parameters
    ----------
    cases : Cases
        Cases of the sweep.
    of : str
        Kind of sweep.
    done : mapping of int to Values
        Values of finished cases by index. Other cases get the outcome "not computed" and NaN.
    attributes : mapping of str to str
        Attributes of the dataset.
    """
    import xarray as xr

    names = [axis.name for axis in cases.axes]
    rows = [done.get(case, {"outcome": MISSING}) for case in range(cases.count)]
    variables: dict[str, Any] = {}
    for name, about in _WORDS.items():
        words = np.array([row.get(name, "") for row in rows], dtype=str).reshape(cases.shape)
        variables[name] = names, words, {"long_name": about}
    if of == "trap":
        held = np.array(["stiffness" in row and not row.get("reason") for row in rows])
        held = held.reshape(cases.shape)
        about = "whether it has a stable equilibrium at least 1 k_B T deep; false too of a failure"
        variables["trapped"] = names, held, {"long_name": about}
    for name, quantity in QUANTITIES[of].items():
        over = [quantity.along] if quantity.along else []
        in_kT = quantity.unit == "kT"
        unit, suffix = ("1", ", in k_B T") if in_kT else (quantity.unit, "")
        for each, about in ((name, quantity.about + suffix), (f"{name}_error", f"error of {name}")):
            if each != name and not quantity.kind:
                continue
            shape = [len(DIMENSIONS[dimension]) for dimension in over]
            missing = np.full(shape, np.nan)
            values = np.array([row.get(each, missing) for row in rows], np.float64)
            described = {"units": unit, "long_name": about}
            if each == name and quantity.kind:
                described["ancillary_variables"] = f"{name}_error"
            variables[each] = [*names, *over], values.reshape(*cases.shape, *shape), described
    coordinates: dict[str, Any] = {}
    for axis in cases.axes:
        for varied in axis.varied:
            described = {"units": varied.unit} if varied.unit else {}
            values = np.array(varied.values)
            coordinates[varied.key] = axis.name, values, {**described, "long_name": varied.about}
    for dimension in dict.fromkeys(each.along for each in QUANTITIES[of].values()):
        if not dimension:
            continue
        described = {"long_name": _ALONG[dimension]}
        coordinates[dimension] = (dimension,), np.array(DIMENSIONS[dimension]), described
    failed = sum(row["outcome"] == FAILED for row in rows)
    counted = {"cases": cases.count, "cases_failed": failed, "cases_done": len(done)}
    status = "complete" if len(done) == cases.count else "interrupted"
    return xr.Dataset(variables, coordinates, {**attributes, **counted, "status": status})


def write(dataset: xr.Dataset, new: Path, out: Path) -> None:
    """Write a dataset to the Zarr store `out` atomically, with checksums of chunks.

    It is first written under the name `new`.
    """
    from zarr.codecs import Crc32cCodec, ZstdCodec

    encoding = {name: {"compressors": [ZstdCodec(), Crc32cCodec()]} for name in dataset.variables}
    try:
        with warnings.catch_warnings(action="ignore"):  # texts are not yet in Zarr's specification
            dataset.to_zarr(
                new, mode="w-", zarr_format=3, consolidated=True, encoding=encoding,
                write_empty_chunks=True,
            )  # fmt: skip
        seal(new, checksums(new))
        new.replace(out)
    except BaseException:
        shutil.rmtree(new, ignore_errors=True)  # so that a full disk has room for the journal again
        raise


def read(out: Path) -> xr.Dataset:
    """Load the store of a sweep into memory; raises `ResultError` for any other file."""
    dataset = load_result(out)
    if (kind := kind_of(dataset)) is None or kind.name != "sweep":
        raise ResultError(f"{out}: not a sweep{f': is {kind.told}' if kind else ''}")
    return dataset.load()
