"""Tables from channels of HDF5 files written by Lumicks's Bluelake."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from tweezer.reading.hdf5 import datasets, text_of
from tweezer.reading.table import Array, Column, Table, refuse_too_long
from tweezer.values.errors import ResultError

#: Attribute by which a Bluelake file is recognised
_VERSION = "Bluelake version"
#: Entry of a force calibration with the force per volt, which every such calibration has
_RESPONSE = "Response (pN/V)"
#: Group with the force calibrations
_CALIBRATIONS = "Calibration"


def is_lumicks(path: Path) -> bool:
    """Return whether an HDF5 file was written by Bluelake."""
    with h5py.File(path) as file:
        return _VERSION in file.attrs


def open_lumicks(path: Path) -> Table:
    """Return the channels of a Bluelake file as columns; forces are converted back to volts."""
    try:
        from lumicks import pylake
    except ImportError:
        raise ResultError(
            f"{path}: reading Bluelake files requires pylake; install it with pip install "
            '"tweezer[recordings]"'
        ) from None
    with h5py.File(path) as file:
        names = {
            name: dataset.shape[0] for name, dataset in datasets(path, file)
            if text_of(dataset.attrs.get("Kind", "")) in ("Continuous", "TimeSeries")
            and not name.startswith(_CALIBRATIONS)
        }  # fmt: skip
    opened = pylake.File(path)
    columns, channels = [], []
    for name, samples in names.items():
        refuse_too_long(str(path), name, samples)
        group, _, channel = name.rpartition("/")
        piece = opened[group][channel]
        rate = piece.sample_rate
        force = channel.startswith("Force ")
        response = force and _response(piece)
        note = f"{channel} in pN is divided by its {response:.6g} pN/V" if response else ""
        columns.append(
            Column(name, channel, "V" if force else None, 1 / rate if rate else None, note)
        )
        channels.append((piece, response or 1.0))

    def numbers(chosen: Sequence[int]) -> list[Array]:
        """Return the numbers in these columns, with forces converted to volts."""
        return [
            np.asarray(piece.data, np.float64) / factor
            for piece, factor in (channels[i] for i in chosen)
        ]

    return Table(str(path), columns, numbers)


def _response(piece: Any) -> float | None:
    """Return the calibration factor of a force, pN/V; None for a channel in volts."""
    found = [abs(item[_RESPONSE]) for item in piece.calibration if _RESPONSE in item]
    return float(found[0]) if found and found[0] else None
