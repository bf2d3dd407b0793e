"""Tables from arrays in NumPy and MATLAB files."""

from __future__ import annotations

import zipfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tweezer.reading.matlab import check_elements
from tweezer.reading.table import (
    MOST_SAMPLES,
    Array,
    Column,
    Table,
    column_of,
    columns_of,
    last_part,
    rate_among,
    refuse_too_long,
)
from tweezer.values.errors import ResultError

#: First bytes of a .npy
_NPY = b"\x93NUMPY"
#: Largest size of an array in a compressed file, bytes
_MOST_BYTES = 64 * MOST_SAMPLES
#: Depth to which nested structures are read
_DEPTH = 4


def open_numpy(path: Path) -> Table:
    """Return the columns of a .npy file, or of the named arrays in a .npz file."""
    if path.suffix.lower() == ".npz":
        with zipfile.ZipFile(path) as packed:
            if any(each.file_size > _MOST_BYTES for each in packed.infolist()):
                raise ResultError(f"{path}: has more than {MOST_SAMPLES:,} samples")
        with np.load(path, allow_pickle=False) as arrays:
            return table_of_arrays(str(path), dict(arrays))
    with path.open("rb") as file:
        if file.read(len(_NPY)) != _NPY:
            raise ValueError("does not begin with the bytes of the .npy format")
    array = np.load(path, mmap_mode="r", allow_pickle=False)
    if array.dtype.names:
        return table_of_arrays(str(path), {name: array[name] for name in array.dtype.names})
    table = table_of_arrays(str(path), {"": array})
    return Table(
        table.name,
        [Column(f"{i + 1}", "") for i in range(len(table.columns))],
        table.numbers,
        headed=False,
    )


def open_matlab(path: Path) -> Table:
    """Return the columns of a .mat file of versions 4 to 7."""
    from scipy.io import loadmat, matlab, whosmat

    if matlab.matfile_version(path)[0] == 1:
        check_elements(path, _MOST_BYTES)
    for name, shape, _ in whosmat(path):
        refuse_too_long(str(path), name, max(shape, default=0))  # loadmat reads all of them
    variables = loadmat(path, squeeze_me=True, struct_as_record=False)
    arrays, opaque = {}, False
    for name, value in _fields(variables, _DEPTH):
        if isinstance(value, matlab.MatlabOpaque):
            opaque = True
        elif isinstance(value, np.ndarray | int | float):
            arrays[name] = np.asarray(value)
    table = table_of_arrays(str(path), arrays)
    if opaque and not table.columns:
        raise ResultError(
            f"{path}: has tables or timetables, which only MATLAB can read; save their columns "
            "as arrays, or with writetable as CSV"
        )
    return table


def _fields(variables: Any, depth: int, before: str = "") -> Iterator[tuple[str, Any]]:
    """Yield variables, and fields of structures, with their names joined by dots.

    `depth` is the number of levels of structures that are read.
    """
    from scipy.io import matlab

    of = variables if isinstance(variables, dict) else vars(variables)
    for name, value in of.items():
        if name.startswith("_"):
            continue
        if isinstance(value, matlab.mat_struct):
            if depth:
                yield from _fields(value, depth - 1, f"{before}{name}.")
        else:
            yield f"{before}{name}", value


def table_of_arrays(name: str, arrays: dict[str, NDArray[Any]]) -> Table:
    """Return the columns of arrays with one or several columns each.

    A single number may be the sampling rate.
    """
    columns: list[Column] = []
    places: list[tuple[NDArray[Any], int]] = []
    scalars = {}
    for label, array in arrays.items():
        if array.dtype.kind not in "fiu":
            continue
        if array.size == 1:
            scalars[label] = float(array.reshape(()))
            continue
        found = columns_of(label, last_part(label), array.shape)
        columns += found
        places += [(array, number) for number in range(len(found))]

    def numbers(chosen: Sequence[int]) -> list[Array]:
        """Return the numbers in the columns with these indices."""
        return [column_of(*places[index]) for index in chosen]

    return Table(name, columns, numbers, rate_beside=rate_among(scalars))
