"""Channels of TDMS files, which LabVIEW writes."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from tweezer.errors import ResultError
from tweezer.reading.table import MOST_SAMPLES, Array, Column, Table

#: First bytes of a TDMS file
_BEGINNING = b"TDSm"
#: Properties of a channel that have its unit
_UNITS = ("unit_string", "NI_UnitDescription", "Unit", "unit")


def open_tdms(path: Path) -> Table:
    """The channels of a TDMS file, with the step of their waveforms if they have one."""
    try:
        from nptdms import TdmsFile
    except ImportError:
        raise ResultError(
            f'{path}: npTDMS reads TDMS files, and is not there: pip install "tweezer[recordings]"'
        ) from None
    with path.open("rb") as file:
        if file.read(len(_BEGINNING)) != _BEGINNING:
            raise ValueError("its beginning is another")
    columns, places = [], []
    for group in TdmsFile.read_metadata(path).groups():
        for channel in group.channels():
            if channel.dtype.kind not in "fiu" or len(channel) < 2:
                continue
            name = f"{group.name}/{channel.name}"
            if len(channel) > MOST_SAMPLES:
                raise ResultError(
                    f"{path}: {name}: has {len(channel):,} samples; must have at most "
                    f"{MOST_SAMPLES:,}"
                )
            unit = next(
                (str(channel.properties[each]) for each in _UNITS if channel.properties.get(each)),
                None,
            )
            step = float(channel.properties.get("wf_increment", 0.0))
            columns.append(Column(name, channel.name, unit, step if step > 0 else None))
            places.append((group.name, channel.name))

    def numbers(chosen: Sequence[int]) -> list[Array]:
        with TdmsFile.open(path) as file:
            return [
                np.asarray(file[group][channel][:], dtype=np.float64)
                for group, channel in (places[i] for i in chosen)
            ]

    return Table(str(path), columns, numbers)
