"""Safety checks of HDF5 files: no references to other files, unknown decoders or false sizes.

They apply to runs and statistics (NetCDF 4) and to recordings.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import h5py

from tweezer.values.errors import ResultError
from tweezer.values.files import check_regular

#: Filters that h5py includes: deflate, shuffle, fletcher32, szip, nbit, scale-offset, LZF
_FILTERS = (1, 2, 3, 4, 5, 6, 32000)
#: Largest ratio of numbers to compressed bytes, which applies only to more numbers than this
_RATIO, _FEW = 64, 2**28
#: Size of the length and the address of a text of variable length, bytes
_TEXT = 16
#: Largest number of groups and datasets of a result
_MOST_ITEMS = 10_000
#: Marker by which netCDF identifies a dataset as a dimension without values
_NO_VARIABLE = b"This is a netCDF dimension but not a netCDF variable"


def item_of(path: Path, group: h5py.Group, name: str, label: str) -> Any:
    """Return an item of a group, or None for a link without a target.

    Parameters
    ----------
    path : Path
        File, for the error message.
    group : h5py.Group
        Group with the item.
    name : str
        Name of the item in the group.
    label : str
        Name of the item in the error message.

    Raises
    ------
    ResultError
        If the item or its data is stored in another file.
    """
    elsewhere = isinstance(group.get(name, getlink=True), h5py.ExternalLink)
    item = None if elsewhere else group.get(name)
    if item is not None:
        elsewhere = item.file != group.file
        if isinstance(item, h5py.Dataset):
            elsewhere = elsewhere or bool(item.external) or item.is_virtual
    if elsewhere:
        raise ResultError(f"{path}: {label}: is stored in another file; must be in this file")
    return item


def check_result(path: Path) -> None:
    """Raise `ResultError` unless the HDF5 file itself contains all numbers that it declares.

    Raises `OSError` if it is not an HDF5 file.
    """
    check_regular(path)
    with h5py.File(path) as file:
        for label, dataset in _datasets(path, file):
            if reason := _unsound(dataset):
                raise ResultError(f"{path}: {label}: {reason}")


def names_in(path: Path) -> set[str]:
    """Return the names of the attributes, variables and dimensions of a NetCDF file."""
    check_regular(path)
    with h5py.File(path) as file:
        return {*file.attrs, *file}


def _datasets(path: Path, file: h5py.File) -> Iterator[tuple[str, h5py.Dataset]]:
    """Yield all datasets of a file with their paths, each group once, as links may be cyclic."""
    waiting: list[tuple[str, h5py.Group]] = [("", file)]
    seen: set[int] = set()
    count = 0
    for before, group in waiting:
        for name in group:
            count += 1
            if count > _MOST_ITEMS:
                raise ResultError(f"{path}: has more than {_MOST_ITEMS} variables: is no result")
            label = f"{before}{name}"
            item = item_of(path, group, name, label)
            if isinstance(item, h5py.Dataset):
                yield label, item
            elif isinstance(item, h5py.Group):
                address = h5py.h5o.get_info(item.id).addr
                if address not in seen:
                    seen.add(address)
                    waiting.append((f"{label}/", item))


def _unsound(dataset: h5py.Dataset) -> str:
    """Return why the numbers of a dataset cannot be read as written; "" if they can."""
    about = dataset.attrs.get("NAME", b"")
    if isinstance(about, bytes) and about.startswith(_NO_VARIABLE):
        return ""
    plan = dataset.id.get_create_plist()
    filters = [plan.get_filter(number)[0] for number in range(plan.get_nfilters())]
    if not set(filters) <= set(_FILTERS):
        return f"is compressed by an unknown filter, {max(filters)}"
    if not dataset.size:
        return ""
    item = _TEXT if dataset.dtype.kind == "O" else dataset.id.get_type().get_size()
    declared, stored = item * dataset.size, dataset.id.get_storage_size()
    lacks = f"declares {dataset.size:,} numbers, and not all are in the file: cut short or damaged"
    if dataset.chunks is None:
        return "" if stored == declared else lacks
    of_each = zip(dataset.shape, dataset.chunks, strict=True)
    if dataset.id.get_num_chunks() != math.prod(-(-size // chunk) for size, chunk in of_each):
        return lacks
    unpacked = max(declared, item * math.prod(dataset.chunks))
    if filters and unpacked > max(_FEW, _RATIO * stored):
        return f"{stored:,} bytes unpack to {unpacked:,}; must be at most {_RATIO} times as many"
    return ""
