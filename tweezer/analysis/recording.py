"""Recordings and tracks of a bead's position: runs of ours, and tables of one's own."""

from __future__ import annotations

import csv
import math
import re
import warnings
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NoReturn

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from tweezer.errors import ResultError
from tweezer.io import scene_of
from tweezer.scene import Scene
from tweezer.units import to_si

Array = NDArray[np.float64]

#: fewer samples, and frames, tell nothing
LEAST_SAMPLES, LEAST_FRAMES = 100, 10
#: how far a time may be from an even grid, in its steps: tables round their times
_UNEVEN = 0.1
#: m, which a recording may extend over
_EXTENTS = (1e-15, 1e-3)

_AXES = ("x", "y", "z")
_TABLES, _BINARIES = (".csv", ".tsv", ".txt"), (".h5", ".hdf5", ".nc")
_HEADING = re.compile(r"(?P<name>\w+)\s*(?:[\[(]\s*(?P<unit>.*?)\s*[\])])?")


@dataclass(frozen=True)
class Recording:
    """Positions of a bead at even times.

    Raises `ResultError`, naming the sample, unless there are 100 or more, all finite, at times that
    rise and are nowhere further than 0.1 steps from an even grid, and every position changes.
    """

    name: str
    """the file, or the title of the run"""
    times: Array
    """(n,) s"""
    positions: Array
    """(n, axes) m"""
    axes: tuple[str, ...]
    """"x", "y" and "z", as many as there are"""
    scene: Scene | None = None
    """what a run of ours was made from"""
    note: str = ""
    """what was left out"""

    def __post_init__(self) -> None:
        if len(self.times) < LEAST_SAMPLES:
            self._refuse(f"has {len(self.times)} samples; must have {LEAST_SAMPLES} or more")
        finite = np.isfinite(self.times) & np.isfinite(self.positions).all(axis=1)
        if not finite.all():
            self._refuse("not finite", int(np.argmin(finite)))
        steps = np.diff(self.times)
        if (steps <= 0).any():
            self._refuse("its time is not after the one before", 1 + int(np.argmax(steps <= 0)))
        even = np.linspace(self.times[0], self.times[-1], len(self.times))
        if np.abs(self.times - even).max() > _UNEVEN * self.step:
            usual = float(np.median(steps))
            off = np.abs(steps - usual)
            self._refuse(
                f"its time breaks the even step of {usual:.4g} s, which samples must have",
                1 + int(np.argmax(off > 0.99 * off.max())),
            )
        for axis, extent in zip(self.axes, np.ptp(self.positions, axis=0), strict=True):
            if extent <= 0:
                self._refuse(f"{axis} does not change: nothing to calibrate")
            if not _EXTENTS[0] <= extent <= _EXTENTS[1]:
                self._refuse(
                    f"{axis} extends over {extent:.3g} m; must be from {_EXTENTS[0]:g} to "
                    f"{_EXTENTS[1]:g} m. Is its unit missing?"
                )

    def _refuse(self, why: str, sample: int | None = None) -> NoReturn:
        place = "" if sample is None else f"sample {sample + 1}: "
        raise ResultError(f"{self.name}: {place}{why}")

    @property
    def step(self) -> float:
        """Time between samples, s."""
        return float(self.times[-1] - self.times[0]) / (len(self.times) - 1)

    def since(self, time: float) -> Recording:
        """What is recorded from `time` (s) after the first sample on.

        Raises `ResultError` if fewer than 100 samples are.
        """
        kept = self.times >= self.times[0] + time
        return replace(self, times=self.times[kept], positions=self.positions[kept])


@dataclass(frozen=True)
class Track:
    """What a camera saw of a bead: two coordinates, at times that need not be even.

    Raises `ResultError`, naming the frame, unless both are numbers, of those shapes, times are
    finite and rise, no coordinate is infinite, both are seen in ten frames or more, the first among
    them, and they extend over what a microscope shows.
    """

    name: str
    """the file, or the title of the run"""
    times: Array
    """(n,) s"""
    positions: Array
    """(n, 2) m, x and y from the axis of the light; NaN where a coordinate is missing"""
    scene: Scene | None = None
    """what a run of ours was made from"""

    def __post_init__(self) -> None:
        for name in ("times", "positions"):
            try:
                object.__setattr__(self, name, np.asarray(getattr(self, name), dtype=np.float64))
            except (TypeError, ValueError):
                raise ResultError(f"{self.name}: {name} must be an array of numbers") from None
        if self.times.ndim != 1 or self.positions.shape != (len(self.times), 2):
            raise ResultError(
                f"{self.name}: times of shape {self.times.shape}, positions of shape "
                f"{self.positions.shape}; must be (n,) and (n, 2)"
            )
        steps = np.diff(self.times)
        for wrong, why, first in (
            (~np.isfinite(self.times), "its time is not finite", 1),
            (np.isinf(self.positions).any(axis=1), "not finite", 1),
            (~(steps > 0), "its time is not after the one before", 2),
        ):
            if wrong.any():
                raise ResultError(f"{self.name}: frame {first + int(np.argmax(wrong))}: {why}")
        seen = np.isfinite(self.positions)
        frames = int(seen.all(axis=1).sum())
        if frames < LEAST_FRAMES:
            raise ResultError(
                f"{self.name}: has {frames} frames with x and y; must have {LEAST_FRAMES} or more"
            )
        if not seen[0].all():
            raise ResultError(f"{self.name}: frame 1: must have x and y")
        extent = float(np.nanmax(np.abs(self.positions)))
        if not _EXTENTS[0] <= extent <= _EXTENTS[1]:
            raise ResultError(
                f"{self.name}: extends to {extent:.3g} m from the axis; must be from "
                f"{_EXTENTS[0]:g} to {_EXTENTS[1]:g} m. Is its unit missing?"
            )


def load_recording(source: str | Path | xr.Dataset) -> Recording:
    """A run of ours, or the table in a file: columns t, x, y and z, of which t and x are needed.

    A run (dataset, or NetCDF file of `save_run`): its positions, up to where the bead was lost. CSV
    (.csv, .tsv, .txt; comma, semicolon or tab): headings such as "t", "x [um]" or "x (um)". HDF5
    and NetCDF 4 (.h5, .hdf5, .nc): a dataset for each column, its unit in the attribute `units`.
    Without a unit numbers are SI. "time" may stand for "t".

    Raises `ResultError`, naming the file and the sample, for a file that is none of these, and for
    what `Recording` refuses.
    """
    found = _read(source, gaps=False)
    return Recording(*found) if isinstance(found, tuple) else _of_columns(str(source), found)


def load_track(source: str | Path | xr.Dataset) -> Track:
    """A run of ours, or the table in a file, as `load_recording` has it: columns t, x and y.

    An empty cell, or NaN, is a coordinate that is missing; frames before the first with both
    coordinates are left out.

    Raises `ResultError`, naming the file and the frame, as `load_recording`, and for what `Track`
    refuses.
    """
    found = _read(source, gaps=True)
    if isinstance(found, tuple):
        name, times, positions, _, scene, _ = found
        return Track(name, times, positions[:, :2], scene)
    missing = [name for name in ("t", "x", "y") if name not in found]
    if missing:
        raise ResultError(f"{source}: has no column {' and no column '.join(missing)}")
    positions = np.stack([found["x"], found["y"]], axis=1)
    both = np.isfinite(positions).all(axis=1)
    if not both.any():
        raise ResultError(f"{source}: has no frame with x and y")
    begin = int(np.argmax(both))
    return Track(str(source), found["t"][begin:], positions[begin:])


#: what a `Recording` is made of
_Run = tuple[str, Array, Array, tuple[str, ...], Scene, str]


def _read(source: str | Path | xr.Dataset, *, gaps: bool) -> _Run | dict[str, Array]:
    """A run of ours, or the columns of a table; gaps: whether cells of a text may be empty."""
    if isinstance(source, xr.Dataset):
        return _of_run(source, source.attrs.get("title", "run"))
    path = Path(source)
    if not path.is_file():
        raise ResultError(f"{path}: {'is a folder' if path.is_dir() else 'no such file'}")
    if path.suffix.lower() in _TABLES:
        return _text_columns(path, gaps=gaps)
    if path.suffix.lower() not in _BINARIES:
        raise ResultError(f"{path}: must end in {', '.join(_TABLES + _BINARIES)}")
    try:
        with xr.open_dataset(
            path, engine="h5netcdf", phony_dims="sort", decode_times=False
        ) as dataset:
            if "scene" in dataset.attrs and "position" in dataset:
                return _of_run(dataset, str(path))
            return _binary_columns(path, dataset)
    except (OSError, KeyError, RuntimeError, TypeError, ValueError) as error:
        raise ResultError(f"{path}: not an HDF5 or NetCDF 4 file, or damaged: {error}") from None


def _of_run(run: xr.Dataset, name: str) -> _Run:
    if "scene" not in run.attrs or "position" not in run:
        raise ResultError(f"{name}: not a run: it has no scene or no position over time")
    if run["position"].dims != ("time", "axis") or not {"time", "axis"} <= set(run.coords):
        raise ResultError(f"{name}: not a run: its position is not over time and axis")
    for quantity, unit in (("position", "m"), ("time", "s")):
        if run[quantity].attrs.get("units", unit) != unit:
            raise ResultError(f"{name}: not a run: its {quantity} is not in {unit}")
    try:
        scene = scene_of(run)
    except ValueError as error:
        reason = str(error).splitlines()[0]
        raise ResultError(f"{name}: not a run: its scene is none: {reason}") from None
    positions = run["position"].values
    there = int(np.isfinite(positions).all(axis=1).cumprod().sum())
    note = ""
    if there < len(positions) or run.attrs.get("status", "complete") != "complete":
        status = run.attrs.get("status", "lost")
        note = f"the run is {status}: up to {run['time'].values[max(there - 1, 0)]:.4g} s only"
    return (
        name, run["time"].values[:there], positions[:there],
        tuple(map(str, run["axis"].values)), scene, note,
    )  # fmt: skip


def _of_columns(name: str, columns: Mapping[str, Array]) -> Recording:
    axes = tuple(axis for axis in _AXES if axis in columns)
    missing = [name for name in ("t", "x") if name not in columns]
    if missing:
        raise ResultError(f"{name}: has no column {' and no column '.join(missing)}")
    positions = np.stack([columns[axis] for axis in axes], axis=1)
    return Recording(name, columns["t"], positions, axes)


def _text_columns(path: Path, *, gaps: bool) -> dict[str, Array]:
    try:
        with path.open(encoding="utf-8-sig", errors="replace", newline="") as file:
            heading = file.readline()
            delimiter = next((mark for mark in ";\t" if mark in heading), ",")
            scales: dict[tuple[int, str], float] = {}  # by index and column
            for index, text in enumerate(heading.split(delimiter)):
                match = _HEADING.fullmatch(text.strip('# "\r\n'))
                if match and (column := _column(match["name"])):
                    if column in (known for _, known in scales):
                        raise ResultError(f"{path}: two columns for {column}")
                    scales[index, column] = _scale(path, match["name"], match["unit"])
            if not scales:
                return {}
            wanted = [index for index, _ in scales]
            with warnings.catch_warnings(action="ignore", category=UserWarning):  # of no rows
                table = np.loadtxt(
                    file,
                    delimiter=delimiter,
                    usecols=wanted,
                    comments=None,
                    ndmin=2,
                    quotechar='"',
                    converters=_number_or_gap if gaps else None,
                )
    except ValueError as error:
        raise ResultError(
            f"{path}: {_bad_line(path, delimiter, wanted, gaps=gaps) or error}"
        ) from None
    except OSError as error:
        raise ResultError(f"{path}: cannot be read: {error.strerror}") from None
    values = table.T if table.size else np.empty((len(wanted), 0))
    return {
        column: scale * row
        for ((_, column), scale), row in zip(scales.items(), values, strict=True)
    }


def _number_or_gap(text: str) -> float:
    return float(text.replace("_", "no digit")) if text.strip() else math.nan


def _bad_line(path: Path, delimiter: str, wanted: list[int], *, gaps: bool) -> str | None:
    """The first line without numbers in the columns `wanted`."""
    with path.open(encoding="utf-8-sig", errors="replace", newline="") as file:
        rows = csv.reader(file, delimiter=delimiter)
        next(rows)
        for row in filter(None, rows):
            for index in wanted:
                text = row[index] if index < len(row) else ""
                if gaps and index < len(row) and not text.strip():
                    continue
                try:
                    float(text.replace("_", "no digit"))
                except ValueError:
                    return f"line {rows.line_num}: {text!r} is not a number"
    return None


def _binary_columns(path: Path, dataset: xr.Dataset) -> dict[str, Array]:
    columns = {}
    for name, variable in dataset.variables.items():
        column = _column(str(name))
        if column is None:
            continue
        if variable.ndim != 1 or variable.dtype.kind not in "fiu":
            raise ResultError(f"{path}: {name}: must be a one-dimensional array of numbers")
        if column in columns:
            raise ResultError(f"{path}: two columns for {column}")
        scale = _scale(path, str(name), variable.attrs.get("units"))
        columns[column] = scale * variable.values.astype(np.float64)
    if len({len(values) for values in columns.values()}) > 1:
        raise ResultError(f"{path}: {', '.join(columns)}: must have the same length")
    return columns


def _column(name: str) -> str | None:
    """The column that a heading names: "t", "x", "y" or "z"."""
    lower = name.lower()
    if lower in ("t", "time"):
        return "t"
    return lower if lower in _AXES else None


def _scale(path: Path, name: str, unit: str | None) -> float:
    """What a number in `unit` is in SI."""
    if unit is None:
        return 1.0
    try:
        return to_si(f"1 {unit}", "s" if _column(name) == "t" else "m")
    except ValueError as error:
        raise ResultError(f"{path}: {name}: {unit!r} {error}") from None
