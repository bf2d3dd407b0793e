"""Tables from datasets of HDF5 files, including MATLAB 7.3 and NetCDF 4."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import islice
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from tweezer.reading.table import (
    Array,
    Column,
    Table,
    column_of,
    columns_of,
    rate_among,
)
from tweezer.values.hdf5 import item_of

#: Depth to which nested groups are read
_DEPTH = 4
#: Largest number of datasets of a group that are considered
_MOST_ITEMS = 1000
#: Attributes that may contain the unit of a dataset
_UNIT_ATTRIBUTES = ("units", "unit", "Unit", "Units")


def open_hdf5(path: Path) -> Table:
    """Return the datasets of an HDF5 file as columns, named by their paths."""
    columns: list[Column] = []
    places: list[tuple[str, int]] = []
    scalars: dict[str, float] = {}
    with h5py.File(path) as file:
        for name, dataset in datasets(path, file):
            if dataset.dtype.kind not in "fiu" or dataset.shape is None:
                continue
            if dataset.size == 1:
                scalars[name] = float(np.asarray(dataset[()]).reshape(()))
                continue
            heading, unit = name.rpartition("/")[2], _unit(dataset)
            found = columns_of(name, heading, dataset.shape, unit)
            columns += found
            places += [(name, number) for number in range(len(found))]

    def numbers(chosen: Sequence[int]) -> list[Array]:
        """Return the numbers in these columns, after opening the file again."""
        with h5py.File(path) as file:
            return [_column(file[name], number) for name, number in (places[i] for i in chosen)]

    return Table(str(path), columns, numbers, rate_beside=rate_among(scalars))


def datasets(path: Path, file: h5py.File) -> Iterator[tuple[str, h5py.Dataset]]:
    """Yield the datasets of a file and of its groups with their paths, each group once.

    Raises `ResultError` for a dataset whose data are in another file. A dataset may declare any
    length without data, so callers check it (`refuse_too_long`).
    """
    waiting: list[tuple[str, h5py.Group, int]] = [("", file, 0)]
    seen: set[int] = set()
    for before, group, depth in waiting:
        for name in islice(group, _MOST_ITEMS):
            label = f"{before}{name}"
            item = item_of(path, group, name, label)
            if isinstance(item, h5py.Dataset):
                yield label, item
            elif isinstance(item, h5py.Group) and depth < _DEPTH and not name.startswith("#"):
                address = h5py.h5o.get_info(item.id).addr
                if address not in seen:
                    seen.add(address)
                    waiting.append((f"{label}/", item, depth + 1))


def text_of(value: Any) -> str:
    """Return an attribute as text."""
    return value.decode(errors="replace") if isinstance(value, bytes) else str(value)


def _unit(dataset: h5py.Dataset) -> str | None:
    """Return the unit from an attribute of a dataset, or None."""
    for name in _UNIT_ATTRIBUTES:
        if name in dataset.attrs and np.ndim(dataset.attrs[name]) == 0:
            return text_of(dataset.attrs[name]).strip() or None
    return None


def _column(dataset: h5py.Dataset, number: int) -> Array:
    """Return a column of a dataset, decoded by NetCDF attributes: fill value, factor and offset."""
    column = column_of(dataset[()], number)
    for name in ("_FillValue", "missing_value"):
        if name in dataset.attrs:
            fill = np.float64(np.ravel(dataset.attrs[name])[0])
            column = np.where(column == fill, np.nan, column)
    factor, offset = (
        np.ravel(dataset.attrs.get(name, [default]))[0]
        for name, default in (("scale_factor", 1.0), ("add_offset", 0.0))
    )
    return column if (factor, offset) == (1.0, 0.0) else column * factor + offset
