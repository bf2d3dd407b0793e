"""Selection of the reader for a table by the format of its file."""

from __future__ import annotations

from pathlib import Path

import h5py

from tweezer.reading.arrays import open_matlab, open_numpy
from tweezer.reading.columns import Columns, Wanted, are_headings, read
from tweezer.reading.hdf5 import open_hdf5
from tweezer.reading.lumicks import is_lumicks, open_lumicks
from tweezer.reading.options import Reading
from tweezer.reading.table import Table
from tweezer.reading.tdms import open_tdms
from tweezer.reading.text import open_text
from tweezer.values.errors import ResultError
from tweezer.values.saved import HDF5, MATLAB, NUMPY, RECORDINGS, TDMS, TEXTS

#: Names of file formats in error messages, by suffix
_CALLED = {
    **dict.fromkeys(HDF5, "an HDF5 or NetCDF 4"), **dict.fromkeys(NUMPY, "a NumPy"),
    MATLAB: "a MATLAB", TDMS: "a TDMS",
}  # fmt: skip


def read_table(path: Path, reading: Reading, wanted: Wanted) -> dict[str, Columns]:
    """Return the required columns of a file by the label of the bead.

    Raises `ResultError` for a file of another format, a damaged one, or one with too many samples,
    and for columns that cannot be read.
    """
    kind = path.suffix.lower()
    if kind not in RECORDINGS:
        raise ResultError(
            f"{path}: must end in {', '.join(RECORDINGS)}; most measurement and spreadsheet "
            "programs can save .csv"
        )
    if kind in TEXTS:
        text = open_text(path, lambda cells: are_headings(cells, reading, wanted))
        _refuse_unnamed(text, reading)
        return read(text, reading, wanted)
    try:
        return read(_opened(path, kind), reading, wanted)
    except ResultError:
        raise
    except Exception as error:  # libraries raise errors of any type for a damaged file
        raise damaged(path, error) from None


def _refuse_unnamed(text: Table, reading: Reading) -> None:
    """Refuse a text without headings that has more columns than --columns names in file order."""
    count, named = len(text.columns), reading.in_order
    if named and not text.headed and count > named:
        raise ResultError(
            f"{text.name}: has {count} columns and no headings, and --columns names {named}; name "
            "the others -, or, if its decimals have commas, write them with points"
        )


def _opened(path: Path, kind: str) -> Table:
    """Return the table in a file with the suffix `kind`, such as ".npy"."""
    if kind in NUMPY:
        return open_numpy(path)
    if kind == TDMS:
        return open_tdms(path)
    if kind == MATLAB and not h5py.is_hdf5(path):
        return open_matlab(path)
    return open_lumicks(path) if is_lumicks(path) else open_hdf5(path)


def damaged(path: Path, error: Exception) -> ResultError:
    """Return the error for a file that cannot be read."""
    reason = " ".join(str(error).split())
    return ResultError(f"{path}: not {_CALLED[path.suffix.lower()]} file, or damaged: {reason}")
