"""Tables from channels of TDMS files, which LabVIEW writes."""

from __future__ import annotations

import contextlib
import logging
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from tweezer.reading.table import Array, Column, Table
from tweezer.values.errors import ResultError

#: First bytes of a TDMS file
_BEGINNING = b"TDSm"
#: Properties of a channel that may contain its unit
_UNITS = ("unit_string", "NI_UnitDescription", "Unit", "unit")


def open_tdms(path: Path) -> Table:
    """Return the channels of a TDMS file as columns, with the sampling interval of waveforms."""
    try:
        from nptdms import TdmsFile
    except ImportError:
        raise ResultError(
            f"{path}: reading TDMS files requires npTDMS; install it with pip install "
            '"tweezer[recordings]"'
        ) from None
    with path.open("rb") as file:
        if file.read(len(_BEGINNING)) != _BEGINNING:
            raise ValueError(f"does not begin with the bytes {_BEGINNING.decode()}")
    columns, places = [], []
    with _silent():
        read = TdmsFile.read_metadata(path)
    cut = "its end is missing" if read.file_status.incomplete_final_segment else ""
    for group in read.groups():
        for channel in group.channels():
            if channel.dtype.kind not in "fiu" or len(channel) < 2:
                continue
            name = f"{group.name}/{channel.name}"
            told = channel.properties
            unit = next((str(told[each]) for each in _UNITS if told.get(each)), None)
            step = float(told.get("wf_increment", 0.0))
            columns.append(
                Column(name, channel.name, unit, step if step > 0 else None, cut, len(channel))
            )
            places.append((group.name, channel.name))

    def numbers(chosen: Sequence[int]) -> list[Array]:
        """Return the numbers in these columns, after opening the file again."""
        with _silent(), TdmsFile.open(path) as file:
            return [
                np.asarray(file[group][channel][:], dtype=np.float64)
                for group, channel in (places[i] for i in chosen)
            ]

    return Table(str(path), columns, numbers)


@contextlib.contextmanager
def _silent() -> Iterator[None]:
    """Return a context in which npTDMS logs nothing, for example about a truncated file."""
    from nptdms.log import log_manager

    before = log_manager.log_level
    log_manager.set_level(logging.ERROR)
    try:
        yield
    finally:
        log_manager.set_level(before)
