"""Recordings and tracks of a bead's position, from runs of tweezer and from files of tables."""

from __future__ import annotations

import math
import re
import warnings
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple, NoReturn

import h5py
import numpy as np
import xarray as xr
from numpy.typing import NDArray

from tweezer.errors import ResultError
from tweezer.io import check_seal, scene_of
from tweezer.scene import Scene
from tweezer.units import FREQUENT, to_si

Array = NDArray[np.float64]

#: Smallest number of samples in a recording
LEAST_SAMPLES = 100
#: Smallest number of frames in a track
LEAST_FRAMES = 10
#: Largest number of samples; more do not fit into the memory of most machines
MOST_SAMPLES = 50_000_000
#: Largest deviation of a time from an even grid, in steps, as tables round their times
_UNEVEN = 0.1
#: Extent that a recording may have, m
_EXTENTS = (1e-15, 1e-3)
#: Extent that a recording in volts may have
_VOLTS = (1e-12, 1e4)

_AXES = ("x", "y", "z")
_TABLES, _BINARIES = (".csv", ".tsv", ".txt"), (".h5", ".hdf5", ".nc")
#: Column and SI unit by the first word of a heading
_COLUMNS = {"t": "t", "time": "t", **{axis: axis for axis in _AXES}}
_SI = {"t": "s", **dict.fromkeys((*_AXES, "drive"), "m")}
#: Characters that may surround a heading
_AROUND = '# "\r\n\t'
#: Largest number of headings in an error message
_NAMES_TOLD = 10
_DECIMAL_COMMA = re.compile(r"[+-]?[0-9]*,[0-9]+(?:[eE][+-]?[0-9]+)?")


@dataclass(frozen=True)
class Recording:
    """Positions of a bead at even times, or the voltages of a detector of them.

    Raises `ResultError`, naming the sample, unless there are at least 100 samples of those shapes,
    all finite, at ascending times within 0.1 steps of an even grid, and each coordinate changes.
    """

    name: str
    """the file, or the title of the run"""
    times: Array
    """(n,) s"""
    positions: Array
    """(n, axes) m, or V"""
    axes: tuple[str, ...]
    """"x", "y" and "z", as many as there are"""
    scene: Scene | None = None
    """scene of a run of tweezer"""
    note: str = ""
    """what was omitted"""
    unit: str = "m"
    """of the positions: "m" or "V\""""
    drive: Array | None = None
    """(n,) m: the motion of the stage, and with it of the fluid"""
    exposure: float | None = None
    """s, over which each position is averaged; None if not known"""
    noise: tuple[float, ...] | None = None
    """standard deviation of the white noise along each axis, m or V; None if not known"""

    def __post_init__(self) -> None:
        _of_shapes(self, len(self.axes))
        if len(self.times) < LEAST_SAMPLES:
            self._refuse(f"has {len(self.times)} samples; must have {LEAST_SAMPLES} or more")
        finite = np.isfinite(self.times) & np.isfinite(self.positions).all(axis=1)
        if self.drive is not None:
            drive = np.asarray(self.drive, np.float64)
            object.__setattr__(self, "drive", drive)
            if drive.shape != self.times.shape:
                self._refuse(f"drive of shape {drive.shape}; must be {self.times.shape}")
            finite &= np.isfinite(drive)
            if np.ptp(drive) > _EXTENTS[1]:
                extent = f"{np.ptp(drive):.3g} m; must be at most {_EXTENTS[1]:g} m"
                self._refuse(f"its drive extends over {extent}. Is its unit missing?")
        if not finite.all():
            at = int(np.argmin(finite))
            self._refuse("not finite; calibrate the samples before and after it apart", at)
        steps = np.diff(self.times)
        if (steps <= 0).any():
            self._refuse("its time is not after the one before", 1 + int(np.argmax(steps <= 0)))
        even = np.linspace(self.times[0], self.times[-1], len(self.times))
        if np.abs(self.times - even).max() > _UNEVEN * self.step:
            usual = float(np.median(steps))
            off = np.abs(steps - usual)
            self._refuse(
                f"its time breaks the even step of {usual:.4g} s, which samples must have; "
                "calibrate those before and after a gap apart",
                1 + int(np.argmax(off > 0.99 * off.max())),
            )
        low, high = _VOLTS if self.unit == "V" else _EXTENTS
        for axis, extent in zip(self.axes, np.ptp(self.positions, axis=0), strict=True):
            if extent <= 0:
                self._refuse(f"{axis} does not change: nothing to calibrate")
            if not low <= extent <= high:
                self._refuse(
                    f"{axis} extends over {extent:.3g} {self.unit}; must be from {low:g} to "
                    f"{high:g} {self.unit}. Is its unit missing?"
                )

    def _refuse(self, why: str, sample: int | None = None) -> NoReturn:
        place = "" if sample is None else f"sample {sample + 1}: "
        raise ResultError(f"{self.name}: {place}{why}")

    @property
    def step(self) -> float:
        """Time between samples, s."""
        return float(self.times[-1] - self.times[0]) / (len(self.times) - 1)

    def since(self, time: float) -> Recording:
        """The recording from `time` (s) after the first sample on.

        Raises `ResultError` if it has fewer than 100 samples.
        """
        kept = self.times >= self.times[0] + time
        drive = None if self.drive is None else self.drive[kept]
        return replace(self, times=self.times[kept], positions=self.positions[kept], drive=drive)


@dataclass(frozen=True)
class Track:
    """A bead seen by a camera: two coordinates, at times that need not be even.

    Raises `ResultError`, naming the frame, unless the shapes are these, times are finite and
    ascending, no coordinate is infinite, at least ten frames have both coordinates, the first frame
    among them, and the extent is one of a microscope's image.
    """

    name: str
    """the file, or the title of the run"""
    times: Array
    """(n,) s"""
    positions: Array
    """(n, 2) m, x and y from the axis of the light; NaN where a coordinate is missing"""
    scene: Scene | None = None
    """scene of a run of tweezer"""

    def __post_init__(self) -> None:
        _of_shapes(self, 2)
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


def _of_shapes(record: Recording | Track, axes: int) -> None:
    """Convert times and positions to arrays; refuse other shapes than (n,) and (n, axes)."""
    for name in ("times", "positions"):
        try:
            array = np.asarray(getattr(record, name), dtype=np.float64)
        except (TypeError, ValueError):
            raise ResultError(f"{record.name}: {name} must be an array of numbers") from None
        object.__setattr__(record, name, array)
    shapes = record.times.shape, record.positions.shape
    if record.times.ndim != 1 or record.positions.shape != (len(record.times), axes):
        raise ResultError(
            f"{record.name}: times of shape {shapes[0]}, positions of shape {shapes[1]}; must be "
            f"(n,) and (n, {axes})"
        )


def load_recording(source: str | Path | xr.Dataset, drive: str | None = None) -> Recording:
    """A run of tweezer, or the table of a file: columns t, x, y and z, of which t and x are needed.

    A run (dataset, or NetCDF file of `save_run`): its positions, up to where the bead was lost; of
    a scene with a camera what that saw, with its exposure and noise. CSV
    (.csv, .tsv, .txt; comma, semicolon or tab): a heading is t, time, x, y or z, in capitals or
    not, perhaps with the word position or pos, then the unit in brackets, or behind a slash, a
    space or an underscore: "t", "x [um]", "X position (um)", "x/um", "x_um". HDF5 and NetCDF 4
    (.h5, .hdf5, .nc): a dataset for each column, named so, or with its unit in the attribute
    `units`. Numbers without a unit are SI. Other columns are ignored. What a detector gives may be
    in volts: "x [V]", "x_mV", for all axes alike.

    drive: heading, without its unit, of the column with the motion of the stage.

    Raises `ResultError`, naming the file and the sample, for a file of another kind, and for what
    `Recording` refuses.
    """
    found = _read(source, _Wanted(("t", "x"), drive, volts=True))
    if not isinstance(found, _Columns):
        if drive is not None:
            raise ResultError(f"{found[0]}: a run of tweezer has no column {drive!r}")
        return Recording(**found._asdict())
    columns, units = found
    axes = tuple(axis for axis in _AXES if axis in columns)
    unit = units["x"]
    if other := [axis for axis in axes if units[axis] != unit]:
        raise ResultError(
            f"{source}: x is in {unit}, and {other[0]} in {units[other[0]]}; must be in one unit"
        )
    positions = np.stack([columns[axis] for axis in axes], axis=1)
    return Recording(
        str(source), columns["t"], positions, axes, unit=unit, drive=columns.get("drive")
    )


def load_track(source: str | Path | xr.Dataset) -> Track:
    """A run of tweezer, or the table of a file as in `load_recording`: columns t, x and y.

    An empty cell, or NaN, is a missing coordinate; frames before the first with both coordinates
    are omitted.

    Raises `ResultError`, naming the file and the frame, as `load_recording`, and for what `Track`
    refuses.
    """
    found = _read(source, _Wanted(("t", "x", "y"), gaps=True))
    if not isinstance(found, _Columns):
        return Track(found.name, found.times, found.positions[:, :2], found.scene)
    columns = found.columns
    positions = np.stack([columns["x"], columns["y"]], axis=1)
    both = np.isfinite(positions).all(axis=1)
    if not both.any():
        raise ResultError(f"{source}: has no frame with x and y")
    begin = int(np.argmax(both))
    return Track(str(source), columns["t"][begin:], positions[begin:])


class _Run(NamedTuple):
    """Arguments of a `Recording`."""

    name: str
    times: Array
    positions: Array
    axes: tuple[str, ...]
    scene: Scene
    note: str
    exposure: float | None = None
    noise: tuple[float, ...] | None = None


class _Wanted(NamedTuple):
    """What a table is read for."""

    needed: tuple[str, ...]
    """columns that it must have"""
    drive: str | None = None
    """heading of the stage's motion, one more"""
    gaps: bool = False
    """whether cells of a text may be empty"""
    volts: bool = False
    """whether positions may be voltages"""


class _Columns(NamedTuple):
    """The columns of a table."""

    columns: dict[str, Array]
    """in SI units"""
    units: dict[str, str]


def _read(source: str | Path | xr.Dataset, wanted: _Wanted) -> _Run | _Columns:
    """A run of tweezer, or the columns of a table."""
    if isinstance(source, xr.Dataset):
        return _of_run(source, source.attrs.get("title", "run"))
    path = Path(source)
    if not path.is_file():
        raise ResultError(f"{path}: {'is a folder' if path.is_dir() else 'no such file'}")
    if path.suffix.lower() in _TABLES:
        return _text_columns(path, wanted)
    if path.suffix.lower() not in _BINARIES:
        raise ResultError(f"{path}: must end in {', '.join(_TABLES + _BINARIES)}")
    try:
        check_seal(path)
        _refuse_other_files(path)
        with xr.open_dataset(
            path, engine="h5netcdf", phony_dims="sort", decode_times=False
        ) as dataset:
            if "scene" in dataset.attrs and "position" in dataset:
                return _of_run(dataset, str(path))
            return _binary_columns(path, dataset, wanted)
    except ResultError:
        raise
    except Exception as error:  # h5py and h5netcdf raise errors of any kind for a damaged file
        reason = " ".join(str(error).split())
        raise ResultError(f"{path}: not an HDF5 or NetCDF 4 file, or damaged: {reason}") from None


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
    except ResultError as error:
        raise ResultError(f"{name}: {error}") from None
    positions = run["position"].values
    there = int(np.isfinite(positions).all(axis=1).cumprod().sum())
    note = ""
    if there < len(positions) or run.attrs.get("status", "complete") != "complete":
        status = run.attrs.get("status", "lost")
        note = f"the run is {status}: up to {run['time'].values[max(there - 1, 0)]:.4g} s only"
    if scene.camera is not None and "seen" in run:
        axes, camera = tuple(map(str, run["seen_axis"].values)), scene.camera
        times, places = run["frame_time"].values, run["seen"].values
        return _Run(name, times, places, axes, scene, note, camera.exposure, camera.noises)
    axes = tuple(map(str, run["axis"].values))
    return _Run(name, run["time"].values[:there], positions[:there], axes, scene, note)


def _text_columns(path: Path, wanted: _Wanted) -> _Columns:
    """The columns of a CSV."""
    row = _Row()
    try:
        with path.open(encoding="utf-8-sig", errors="replace", newline="") as file:
            first = file.readline()
            delimiter = next((mark for mark in ";\t" if mark in first), ",")
            headings = first.split(delimiter)
            found = _named_columns(path, [(each, None) for each in headings], wanted)
            places = [index for index, *_ in found.values()]
            with warnings.catch_warnings(action="ignore", category=UserWarning):  # of no rows
                table = np.loadtxt(
                    row.each(file, delimiter, len(headings)),
                    delimiter=delimiter,
                    usecols=places,
                    comments=None,
                    ndmin=2,
                    quotechar='"',
                    converters=_number_or_gap if wanted.gaps else None,
                )
    except ValueError as error:
        why = row.complaint(places, delimiter, gaps=wanted.gaps) or str(error).splitlines()[0]
        raise ResultError(f"{path}: line {row.number}: {why}") from None
    except OSError as error:
        raise ResultError(f"{path}: cannot be read: {error.strerror}") from None
    values = table.T if table.size else np.empty((len(places), 0))
    scales = [scale for _, scale, _ in found.values()]
    columns = [scale * row for scale, row in zip(scales, values, strict=True)]
    return _Columns(
        dict(zip(found, columns, strict=True)), {name: unit for name, (*_, unit) in found.items()}
    )


class _Row:
    """The current line of a CSV file."""

    number, text = 1, ""

    def each(self, file: Iterable[str], delimiter: str, most: int) -> Iterator[str]:
        """The lines of `file`, checked for the number of cells and for open quotes."""
        for self.number, self.text in enumerate(file, start=2):
            if self.text.count('"') % 2:
                raise ValueError("a quote is not closed")
            if self.text.count(delimiter) >= most and '"' not in self.text:
                cells = self.text.split(delimiter)
                if any(cell.strip() for cell in cells[most:]):
                    raise ValueError(
                        f"has {len(cells)} cells for {most} headings; decimals need a point"
                    )
            yield self.text

    def complaint(self, wanted: Sequence[int], delimiter: str, *, gaps: bool) -> str | None:
        """What is wrong with the cells `wanted`, if anything."""
        cells = [cell.strip('" \r\n') for cell in self.text.split(delimiter)]
        for index in wanted:
            text = cells[index] if index < len(cells) else ""
            if gaps and index < len(cells) and not text:
                continue
            try:
                float(text.replace("_", "no digit"))
            except ValueError:
                point = "; decimals need a point" if _DECIMAL_COMMA.fullmatch(text) else ""
                return f"{_short(text)!r} is not a number{point}"
        return None


def _number_or_gap(text: str) -> float:
    return float(text.replace("_", "no digit")) if text.strip() else math.nan


def _binary_columns(path: Path, dataset: xr.Dataset, wanted: _Wanted) -> _Columns:
    variables = list(dataset.variables.items())
    headings = [(str(name), variable.attrs.get("units")) for name, variable in variables]
    columns, found = {}, _named_columns(path, headings, wanted)
    for column, (index, scale, _) in found.items():
        name, variable = variables[index]
        if variable.ndim != 1 or variable.dtype.kind not in "fiu":
            raise ResultError(f"{path}: {name}: must be a one-dimensional array of numbers")
        columns[column] = scale * variable.values.astype(np.float64)
    if len({len(values) for values in columns.values()}) > 1:
        raise ResultError(f"{path}: {', '.join(columns)}: must have the same length")
    return _Columns(columns, {name: unit for name, (*_, unit) in found.items()})


def _refuse_other_files(path: Path) -> None:
    """Refuse an HDF5 file with data in other files, or with more than memory holds.

    A dataset may claim any length without data, and may name any file as the place of its data.
    """
    with h5py.File(path) as file:
        for name in file:
            linked = isinstance(file.get(name, getlink=True), h5py.ExternalLink)
            item = None if linked else file.get(name)
            if isinstance(item, h5py.Dataset):
                linked = bool(item.external) or item.is_virtual or item.file != file
                if item.shape and item.shape[0] > MOST_SAMPLES:
                    raise ResultError(
                        f"{path}: {name}: has {item.shape[0]:,} samples; must have at most "
                        f"{MOST_SAMPLES:,}"
                    )
            if linked:
                raise ResultError(f"{path}: {name}: lies in another file; must be in this one")


def _named_columns(
    path: Path, headings: Sequence[tuple[str, object]], wanted: _Wanted
) -> dict[str, tuple[int, float, str]]:
    """Column number, factor to SI and SI unit for each quantity that a heading names.

    headings: each with the unit given beside it, if any.
    """
    found: dict[str, tuple[int, float, str]] = {}
    needed = [*wanted.needed, *(["drive"] if wanted.drive is not None else [])]
    for index, (heading, beside) in enumerate(headings):
        column, unit = _column_and_unit(heading)
        if wanted.drive is not None and (driving := _after(heading, wanted.drive)) is not None:
            column, unit = "drive", driving or None
        if column is None:
            continue
        if column in found:
            raise ResultError(f"{path}: two columns for {column}")
        scales = {
            _scale(path, heading, column, each, volts=wanted.volts)
            for each in (unit, beside)
            if each is not None
        }
        if len(scales) > 1:
            raise ResultError(f"{path}: {heading}: is in {unit}, and in {beside}")
        found[column] = (index, *(scales.pop() if scales else (1.0, _SI[column])))
    missing = [
        f"no column {wanted.drive if column == 'drive' else column}"
        for column in needed
        if column not in found
    ]
    if missing:
        names = [_short(heading.strip(_AROUND)) for heading, _ in headings]
        there = f" among {', '.join(map(repr, names[:_NAMES_TOLD]))}" if any(names) else ""
        there += ", ..." if len(names) > _NAMES_TOLD else ""
        frames = any(name.lower().startswith("frame") for name in names)
        raise ResultError(
            f'{path}: has {" and ".join(missing)}{there}; headings are such as "t [s]" and '
            f'"x [um]"{"; frames are no times: divide them by their rate" if frames else ""}'
        )
    return found


def _column_and_unit(heading: str) -> tuple[str | None, str | None]:
    """The quantity and the unit that a heading names; None if it names none.

    A heading is t, time, x, y or z, perhaps with the word position or pos; then the unit, if any:
    in brackets, behind a slash, or behind a space or underscore.
    """
    name, unit = heading.strip(_AROUND), None
    if name.endswith(("]", ")")):
        name, _, unit = name[:-1].rpartition("[" if name.endswith("]") else "(")
    elif "/" in name:
        name, _, unit = name.partition("/")
    words = [
        word for word in name.replace("_", " ").split() if word.lower() not in ("position", "pos")
    ]
    if not words or words[0].lower() not in _COLUMNS:
        return None, None
    column = _COLUMNS[words[0].lower()]
    if len(words) == 1:
        return column, unit and unit.strip()
    if len(words) == 2 and unit is None and _is_unit(words[1], column):
        return column, words[1]
    return None, None


def _after(heading: str, name: str) -> str | None:
    """The unit of a heading with that name; "" without one; None for another heading."""
    text = heading.strip(_AROUND)
    if not text.lower().startswith(name.lower()):
        return None
    rest = text[len(name) :]
    unit = rest.strip("[]()/_ ")
    if rest and (rest[0] not in "[(/_ " or not _is_unit(unit, "drive")):
        return None
    return unit


def _is_unit(text: str, column: str) -> bool:
    if column in _AXES and text in FREQUENT["V"]:
        return True
    try:
        to_si(f"1 {text}", _SI[column])
    except ValueError:
        return False
    return True


def _scale(
    path: Path, heading: str, column: str, unit: object, *, volts: bool
) -> tuple[float, str]:
    """Factor from `unit` to SI, and the SI unit."""
    if volts and column in _AXES and unit in FREQUENT["V"]:
        return FREQUENT["V"][str(unit)], "V"
    try:
        return to_si(f"1 {unit}", _SI[column]), _SI[column]
    except ValueError as error:
        scaled = "; scale the column to lengths first" if column != "t" else ""
        raise ResultError(
            f"{path}: {_short(heading.strip(_AROUND))}: {_short(str(unit))!r} {error}{scaled}"
        ) from None


def _short(text: str) -> str:
    return text if len(text) <= 40 else text[:37] + "..."
