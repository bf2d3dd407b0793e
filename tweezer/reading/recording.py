"""Recordings and tracks of a bead's position, from runs of tweezer and from tables."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar, NamedTuple, NoReturn

import numpy as np

from tweezer.reading import (
    HDF5,
    Columns,
    Reading,
    Wanted,
    damaged,
    datasets,
    measured,
    only,
    read_table,
    refuse_too_long,
    without_gaps,
)
from tweezer.results.io import check_seal, scene_of
from tweezer.scene import Scene
from tweezer.scene.arguments import in_si, name_last, numbers_in_si
from tweezer.values.arrays import Array
from tweezer.values.errors import ResultError, TooFewError, warn
from tweezer.values.hdf5 import check_result
from tweezer.values.printed import in_unit, printed, signal_unit
from tweezer.values.saved import kind_of_file
from tweezer.values.shown import Card, Row, Shown
from tweezer.values.units import QuantityLike

if TYPE_CHECKING:
    import xarray as xr


#: Smallest number of samples in a recording
LEAST_SAMPLES = 100
#: Smallest number of frames in a track
LEAST_FRAMES = 10
#: Largest deviation of a time from an even grid, in steps, which allows for rounded times
_UNEVEN = 0.1
#: Allowed range of the extent of a recording, m
_EXTENTS = (1e-15, 1e-3)
#: Allowed range of the extent of a recording in volts
_VOLTS = (1e-12, 1e4)

_AXES = ("x", "y", "z")


@name_last
@dataclass(frozen=True, repr=False)
class Recording(Shown):
    """Positions of a bead at evenly spaced times, or the detector voltages.

    Raises
    ------
    ResultError
        If there are fewer than 100 samples, the shapes differ from those below, a value is not
        finite, a coordinate is constant, or a time deviates from even spacing by more than 0.1 of
        the sampling interval. The message names the sample.

    Examples
    --------
    >>> times = [1e-3 * i for i in range(200)]
    >>> positions = [1e-8 * (i % 7) for i in range(200)]
    >>> tweezer.Recording(times, positions, ("x",)).step
    0.001
    """

    times: Array
    """(n,) s"""
    positions: Array
    """(n, axes) m, or V; (n,) is accepted for a single axis"""
    axes: tuple[str, ...]
    """names of the axes: one or more of "x", "y" and "z\""""
    name: str = field(default="recording", kw_only=True)
    """file, or title of the run"""
    scene: Scene | None = None
    """scene, if it is a run of tweezer"""
    note: str = ""
    """samples that were omitted or filled in, in words"""
    unit: str = "m"
    """of the positions: "m", or "V" or "W" of signals"""
    drive: Array | None = None
    """(n,) motion of the stage, which moves the fluid with it, m"""
    exposure: float | None = None
    """exposure time over which each position is averaged, s; None if not known"""
    noise: tuple[float, ...] | None = None
    """standard deviation of the white noise along each axis, m or V; None if not known"""
    dated: bool = False
    """whether times or frame numbers were read with the positions, so that their order is known"""

    def __post_init__(self) -> None:
        """Convert the arrays, and raise `ResultError` if the samples are not a valid recording."""
        _of_shapes(self, len(self.axes))
        if len(self.times) < LEAST_SAMPLES:
            why = f"; {self.note}" if self.note else ""
            raise TooFewError(
                f"{self.name}: has {len(self.times)} samples; for a trap it must have "
                f"{LEAST_SAMPLES} or more{why}"
            )
        finite = np.isfinite(self.times) & np.isfinite(self.positions).all(axis=1)
        if self.drive is not None:
            drive = numbers_in_si(f"{self.name}: drive", self.drive, "m")
            object.__setattr__(self, "drive", drive)
            if drive.shape != self.times.shape:
                self._refuse(f"drive of shape {drive.shape}; must be {self.times.shape}")
            finite &= np.isfinite(drive)
            if np.ptp(drive) > _EXTENTS[1]:
                extent = f"{np.ptp(drive):.3g} m; must be at most {_EXTENTS[1]:g} m"
                self._refuse(f"its drive extends over {extent}. Is its unit missing?")
        if not finite.all():
            at = int(np.argmin(finite))
            self._refuse("not finite; calibrate the samples before and after it separately", at)
        steps = np.diff(self.times)
        if (steps <= 0).any():
            self._refuse(
                "its time is not later than the previous time",
                1 + int(np.argmax(steps <= 0)),
            )
        even = np.linspace(self.times[0], self.times[-1], len(self.times))
        if np.abs(self.times - even).max() > _UNEVEN * self.step:
            usual = float(np.median(steps))
            off = np.abs(steps - usual)
            self._refuse(
                f"its time is off the even step of {usual:.4g} s, which is required; if only "
                f'the time stamps are uneven, give the rate: --rate "{1 / self.step:.4g} Hz"',
                1 + int(np.argmax(off > 0.99 * off.max())),
            )
        low, high = _EXTENTS if self.unit == "m" else _VOLTS
        for axis, extent in zip(self.axes, np.ptp(self.positions, axis=0), strict=True):
            if extent <= 0:
                self._refuse(f"{axis} does not change, so there is nothing to calibrate")
            if not low <= extent <= high:
                self._refuse(
                    f"{axis} extends over {extent:.3g} {self.unit}; must be from {low:g} to "
                    f"{high:g} {self.unit}. Is its unit missing? For pixels give --scale"
                )

    def _refuse(self, why: str, sample: int | None = None) -> NoReturn:
        """Raise `ResultError` with a reason, and the number of the sample (from 0) if given."""
        place = "" if sample is None else f"sample {sample + 1}: "
        raise ResultError(f"{self.name}: {place}{why}")

    def card(self) -> Card:
        """Return the card with number of samples, spread along each axis, exposure and noise."""
        unit = signal_unit(self.unit)
        spread = self.positions.std(axis=0)
        rate = 1 / self.step
        rows = [
            Row(
                "samples", f"{len(self.times)}, {rate:.5g} Hz, {self.step * len(self.times):.4g} s"
            ),
            *(
                Row(f"{axis}, standard deviation", printed(each, unit))
                for axis, each in zip(self.axes, spread, strict=True)
            ),
            Row("exposure", _known(self.exposure)),
        ]
        if self.noise is not None:
            rows.append(Row("noise of the detector", printed(self.noise, unit, 3)))
        if self.drive is not None:
            rows.append(Row("stage, standard deviation", printed(self.drive.std(), "nm")))
        return Card("Recording", self.name, tuple(rows), notes=(self.note,) if self.note else ())

    @property
    def step(self) -> float:
        """Time between samples, s."""
        return float(self.times[-1] - self.times[0]) / (len(self.times) - 1)

    def since(self, time: QuantityLike) -> Recording:
        """Return the recording without its first `time` seconds.

        Parameters
        ----------
        time : float or str
            Time to omit, s.

        Raises
        ------
        ResultError
            If fewer than 100 samples remain.
        """
        time = in_si(f"{self.name}: since", time, "s", error=ResultError)
        kept = self.times >= self.times[0] + time
        drive = None if self.drive is None else self.drive[kept]
        return replace(self, times=self.times[kept], positions=self.positions[kept], drive=drive)


@name_last
@dataclass(frozen=True, repr=False)
class Track(Shown):
    """Coordinates x and y of a bead seen by a camera, at times that need not be even.

    Raises
    ------
    ResultError
        If the shapes differ from those below, times are not finite and ascending, a coordinate is
        infinite, fewer than ten frames or not the first frame have both coordinates, or the extent
        exceeds a microscope image. The message names the frame.
    """

    times: Array
    """(n,) s"""
    positions: Array
    """(n, 2) m, x and y relative to the beam axis; NaN where a coordinate is missing"""
    name: str = field(default="track", kw_only=True)
    """file, or title of the run"""
    scene: Scene | None = None
    """scene, if it is a run of tweezer"""
    exposure: float | None = None
    """time over which each frame averages, s; None if not known"""
    unit: ClassVar[str] = "m"

    def __post_init__(self) -> None:
        """Convert the arrays, and raise `ResultError` if the frames are not a valid track."""
        _of_shapes(self, 2)
        steps = np.diff(self.times)
        for wrong, why, first in (
            (~np.isfinite(self.times), "its time is not finite", 1),
            (np.isinf(self.positions).any(axis=1), "not finite", 1),
            (~(steps > 0), "its time is not later than the previous time", 2),
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
                f"{_EXTENTS[0]:g} to {_EXTENTS[1]:g} m. Is its unit missing? For pixels give "
                "--scale"
            )

    def card(self) -> Card:
        """Return the card with number of frames, of complete frames, times and extent."""
        both = int(np.isfinite(self.positions).all(axis=1).sum())
        x, y = (printed(each, "um") for each in np.nanmax(np.abs(self.positions), axis=0))
        first, last = in_unit(self.times[0], "ms"), printed(self.times[-1], "ms")
        rows = (
            Row("frames", f"{len(self.times)}, {both} of them with x and y"),
            Row("times", f"{first} to {last}"),
            Row("farthest from the axis", f"x {x}, y {y}"),
            Row("exposure", _known(self.exposure)),
        )
        return Card("Track", self.name, rows)


def _known(exposure: float | None) -> str:
    """Return an exposure, s, as text; "not known" for None."""
    return "not known" if exposure is None else printed(exposure, "ms")


def _of_shapes(record: Recording | Track, axes: int) -> None:
    """Convert times and positions to arrays; refuse other shapes than (n,) and (n, axes).

    Positions along a single axis may also have the shape (n,).
    """
    for name, unit in (("times", "s"), ("positions", record.unit)):
        array = numbers_in_si(f"{record.name}: {name}", getattr(record, name), unit)
        if name == "positions" and axes == array.ndim == 1:
            array = array[:, None]
        object.__setattr__(record, name, array)
    if record.exposure is not None:
        exposure = in_si(f"{record.name}: exposure", record.exposure, "s", error=ResultError)
        object.__setattr__(record, "exposure", exposure)
    shapes = record.times.shape, record.positions.shape
    if record.times.ndim != 1 or record.positions.shape != (len(record.times), axes):
        raise ResultError(
            f"{record.name}: times of shape {shapes[0]}, positions of shape {shapes[1]}; must be "
            f"(n,) and (n, {axes})"
        )


def load_recording(
    source: str | Path | xr.Dataset,
    drive: str | None = None,
    *,
    columns: str | Sequence[str] | Mapping[str, str | int] | None = None,
    rate: QuantityLike | None = None,
    scale: QuantityLike | None = None,
    bead: str | int | None = None,
    signals: bool = False,
) -> Recording:
    """Return the recording in a run of tweezer or in a table.

    For a run, the recording contains the positions until the bead was lost. If the scene has a
    camera, it contains the frames instead, with exposure and noise, up to the last whole step
    before the loss.

    A table has the columns t, x, y and z, of which t and x are required. Its file is text (.csv,
    .tsv, .txt, .dat, .asc, .lvm, .prn), HDF5 or NetCDF 4 (.h5, .hdf5, .nc, also of Lumicks), NumPy
    (.npy, .npz), MATLAB (.mat) or TDMS (.tdms). A heading contains t, time, x, y or z, possibly
    with other words and a unit, such as "X position (nm)". Numbers without a unit are SI. Positions
    may be in volts. Other columns are ignored. The page "Recordings" of the documentation gives the
    details.

    Rows are sorted by time if the sorted times are evenly spaced. Gaps of up to 10 samples are
    filled in from the surrounding samples, if they are at most 5 % of all samples. Otherwise the
    longest stretch without a gap is used. `Recording.note` reports this.

    Parameters
    ----------
    source : str, Path or xarray.Dataset
        File, or run of tweezer.
    drive : str, optional
        Heading, without its unit, of the column with the motion of the stage.
    columns : str, sequence of str or mapping, optional
        Columns to read, either in file order ("t [s],-,x [um]") or by heading or number from 1
        ("t=Zeit,x=4").
    rate : float or str, optional
        Sampling rate, Hz, e.g. "15 Hz". It applies to rows without times, to frame numbers, and to
        evenly spaced samples with inaccurate time stamps.
    scale : float or str, optional
        Size of a pixel or a volt, m, e.g. "85.8 nm", "11.66 px/um" or "0.5 um/V". It applies to
        positions without a unit or in this unit.
    bead : str or int, optional
        Bead to read from a table of several, as its column names it.
    signals : bool, optional
        Whether to read the signals of the detector of a run, W, instead of its positions.

    Returns
    -------
    Recording
        Positions at even times.

    Raises
    ------
    ResultError
        For a file of an unsupported kind, and for samples that `Recording` refuses. The message
        names the file and the sample.

    Examples
    --------
    >>> recording = tweezer.load_recording(tweezer.simulate("silica-1um", "2 ms"))
    >>> recording.axes, recording.unit
    (('x', 'y', 'z'), 'm')
    """
    reading = Reading.of(columns, rate, scale, drive, bead)
    read = read_source(source, reading, Wanted(() if reading.columns else ("x",), volts=True))
    if isinstance(read, Run):
        if signals:
            read = _of_detector(source, read)
        if drive is not None:
            raise ResultError(f"{read.name}: a run of tweezer has no column {drive!r}")
        return Recording(**read._asdict())
    found = only(str(source), read)
    there = [axis for axis in _AXES if axis in found.columns]
    still = [axis for axis in there if axis != "x" and _is_still(found.columns[axis])]
    if reading.columns:
        still = []
    axes = tuple(axis for axis in there if axis not in still)
    notes = [found.note, *(f"{axis} does not change, and is left out" for axis in still)]
    names = [*axes, *(["drive"] if drive is not None else [])]
    table = np.stack([found.columns[name] for name in names], axis=1)
    kept, times, positions, of_digits = measured(found.times, table[:, : len(axes)])
    table = np.hstack([positions, table[kept, len(axes) :]])
    times, table, note = without_gaps(
        str(source), times, table, LEAST_SAMPLES, len(names) - len(axes)
    )
    return Recording(
        times, table[:, : len(axes)], axes, name=str(source), unit=found.unit,
        drive=table[:, -1] if drive is not None else None,
        note="; ".join(filter(None, [*notes, of_digits, note])), dated=found.dated,
    )  # fmt: skip


def _is_still(positions: Array) -> bool:
    """Return whether a coordinate is the same in all samples that have it."""
    seen = positions[np.isfinite(positions)]
    return len(seen) > 0 and np.ptp(seen) == 0


def load_track(
    source: str | Path | xr.Dataset,
    *,
    columns: str | Sequence[str] | Mapping[str, str | int] | None = None,
    rate: QuantityLike | None = None,
    scale: QuantityLike | None = None,
    bead: str | int | None = None,
) -> Track:
    """Return the track in a run of tweezer or in a table with columns t, x and y.

    An empty cell, or NaN, is a missing coordinate. Frames without a time are omitted, and so are
    frames before the first one with both coordinates.

    Parameters
    ----------
    source : str, Path or xarray.Dataset
        File, or run of tweezer, as in `load_recording`.
    columns : str, sequence of str or mapping, optional
        Columns to read, either in file order ("t [s],x [um],y [um]") or by heading or number from
        1.
    rate : float or str, optional
        Frame rate, Hz, for frame numbers or rows without times.
    scale : float or str, optional
        Size of a pixel, m, e.g. "85.8 nm" or "11.66 px/um".
    bead : str or int, optional
        Bead to read from a table of several, as its column names it.

    Returns
    -------
    Track
        Two coordinates over time.

    Raises
    ------
    ResultError
        For a file that `load_recording` would refuse, and for a track that `Track` refuses. The
        message names the file and the frame.

    Examples
    --------
    >>> track = tweezer.load_track(tweezer.simulate("silica-1um", "2 ms"))
    >>> track.positions.shape
    (2001, 2)
    """
    read = read_source(source, Reading.of(columns, rate, scale, bead=bead), Wanted(("x", "y")))
    if isinstance(read, Run):
        return Track(read.times, read.positions[:, :2], read.scene, read.exposure, name=read.name)
    found = only(str(source), read)
    if found.note:
        warn(f"{source}: {found.note}", UserWarning)
    positions = np.stack([found.columns["x"], found.columns["y"]], axis=1)
    there = ~np.isnan(found.times)
    both = np.isfinite(positions).all(axis=1) & there
    if not both.any():
        raise ResultError(f"{source}: has no frame with x and y")
    there[: int(np.argmax(both))] = False
    return Track(found.times[there], positions[there], name=str(source))


class Run(NamedTuple):
    """Positions in a run of tweezer, with the fields of a `Recording`."""

    name: str
    times: Array
    """(n,) s"""
    positions: Array
    """(n, axes) m"""
    axes: tuple[str, ...]
    scene: Scene
    note: str
    exposure: float | None = None
    noise: tuple[float, ...] | None = None
    unit: str = "m"


def _of_detector(source: str | Path | xr.Dataset, read: Run) -> Run:
    """Return a run with the signals of its detector in place of the positions."""
    from tweezer.results.io import load_run

    run = load_run(source) if isinstance(source, str | Path) else source
    if "signal" not in run:
        raise ResultError(f"{read.name}: has no signal; add [detector] to its scene and run it")
    values = run["signal"].values
    there = int(np.isfinite(values).all(axis=1).cumprod().sum())
    return read._replace(
        times=run["time"].values[:there], positions=values[:there],
        axes=tuple(map(str, run["channel"].values)), exposure=None, noise=None, unit="W",
    )  # fmt: skip


def read_source(
    source: str | Path | xr.Dataset, reading: Reading, wanted: Wanted
) -> Run | dict[str, Columns]:
    """Load a run of tweezer, or the columns of a table by the label of the bead."""
    if not isinstance(source, str | os.PathLike):
        return _of_run(source, source.attrs.get("title", "run"), reading)
    path = Path(source)
    kind = kind_of_file(path)
    if kind is not None and kind.name not in ("recording", "run"):
        raise ResultError(f"{path}: is {kind.told}, not a recording{kind.way(path.name)}")
    if not os.path.isfile(path):  # noqa: PTH113 - `Path.is_file` raises for a name that is too long
        raise ResultError(f"{path}: {'is a folder' if os.path.isdir(path) else 'no such file'}")  # noqa: PTH112
    if path.suffix.lower() in HDF5:
        try:
            check_seal(path)
            if _is_run(path):
                import xarray as xr

                check_result(path)
                with xr.open_dataset(path, engine="h5netcdf", decode_times=False) as dataset:
                    return _of_run(dataset, str(path), reading)
        except ResultError:
            raise
        except Exception as error:  # h5py and h5netcdf raise errors of any type for damaged files
            raise damaged(path, error) from None
    return read_table(path, reading, wanted)


def _is_run(path: Path) -> bool:
    """Return whether an HDF5 file contains a run of tweezer.

    Raises `ResultError` if its data are in other files, or are too long.
    """
    import h5py

    with h5py.File(path) as file:
        if "scene" not in file.attrs or "position" not in file:
            return False
        for name, dataset in datasets(path, file):
            refuse_too_long(str(path), name, max(dataset.shape or (), default=0))
        return True


def _of_run(run: xr.Dataset, name: str, reading: Reading) -> Run:
    """Return the positions in a run until the bead was lost, or the frames of its camera.

    `name` is used in messages. The options in `reading` are refused for a run.
    """
    if reading.given:
        raise ResultError(
            f"{name}: is a run of tweezer, to which --{reading.given[0]} does not apply"
        )
    if "scene" not in run.attrs or "position" not in run:
        raise ResultError(f"{name}: not a run: it has no scene or no position over time")
    if run["position"].dims != ("time", "axis") or not {"time", "axis"} <= set(run.coords):
        raise ResultError(f"{name}: not a run: its position is not over time and axis")
    units = {"position": "m", "time": "s"}
    if "seen" in run:
        if run["seen"].dims != ("frame", "seen_axis") or not {"frame_time", "seen_axis"} <= set(
            run.coords
        ):
            raise ResultError(f"{name}: not a run: its camera frames are not over time and axis")
        units |= {"seen": "m", "frame_time": "s"}
    for quantity, unit in units.items():
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
        return Run(name, times, places, axes, scene, note, camera.exposure, camera.noises)
    axes = tuple(map(str, run["axis"].values))
    return Run(name, run["time"].values[:there], positions[:there], axes, scene, note)
