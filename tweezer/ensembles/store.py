"""What an ensemble leaves on disk, and what it goes on from."""

from __future__ import annotations

import contextlib
import json
import shutil
import tempfile
import warnings
import zipfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
import zarr
from filelock import FileLock, Timeout
from numpy.typing import NDArray
from zarr.codecs import Crc32cCodec

from tweezer.dynamics.walk import Walk
from tweezer.ensembles.job import (
    COORDINATES,
    QUANTITIES,
    Attributes,
    Job,
    attributes_of,
    columns_of,
    plan_of,
)
from tweezer.ensembles.statistics import Statistics
from tweezer.errors import ResultError
from tweezer.io import load_run, save_run

#: arrays by name: in memory or in the store
Samples = Mapping[str, Any]
#: what a block gathered, by name: nothing where trajectories are written
Gathered = Mapping[str, NDArray[np.float64]]

#: blocks joined to the statistics before these are written
_JOINED = 16
#: what reading a file that is not what it should be raises
_UNREADABLE = (OSError, EOFError, ValueError, KeyError, zipfile.BadZipFile)


def refuse_another(job: Job, bound: Walk, resume: bool) -> None:
    """Raise `ResultError` unless the ensemble at `job.out`, if there is one, is this one."""
    made = _made(job)
    if made is None:
        return
    if not resume:
        raise ResultError(f"{job.out}: exists, or is begun; resume it, or name another file")
    for key, value in attributes_of(job, bound).items():
        if key == "scene" and made.get(key) != value:
            raise ResultError(f"{job.out}: made of another scene; it cannot be resumed with this")
        if made.get(key) != value:
            raise ResultError(
                f"{job.out}: made with {key.replace('_', ' ')} {made.get(key)}, which cannot be "
                f"resumed with {value}"
            )


def _made(job: Job) -> Attributes | None:
    """The attributes of the ensemble that is at `job.out`, or is begun."""
    assert job.out is not None
    try:
        if job.out.exists():
            if job.skipped is None:
                return dict(zarr.open_group(job.out, mode="r").attrs)
            return dict(load_run(job.out).attrs)
        if job.skipped is not None and job.total.exists():
            return dict(json.loads(str(_read(job.total)["attributes"])))
    except _UNREADABLE as error:
        raise ResultError(f"{job.out}: not an ensemble: {error}") from None
    return None


@contextlib.contextmanager
def at_work(job: Job) -> Iterator[None]:
    """Hold the folder beside the output, where no other process then works."""
    assert job.out is not None
    if not job.out.parent.is_dir():
        raise ResultError(f"{job.out}: no such folder: {job.out.parent}")
    with telling(job):
        job.part.mkdir(exist_ok=True)
        lock = FileLock(job.part / "lock")
        try:
            lock.acquire(timeout=0)
        except Timeout:
            raise ResultError(f"{job.out}: another process is at work on it") from None
    try:
        yield
    finally:
        lock.release()
        if job.part.exists() and {path.name for path in job.part.iterdir()} <= {"lock"}:
            shutil.rmtree(job.part)


@contextlib.contextmanager
def telling(job: Job) -> Iterator[None]:
    """Turn what the file system refuses into a `ResultError`."""
    try:
        yield
    except OSError as error:
        raise ResultError(
            f"{job.out}: cannot be written: {error.strerror or error}; what was written before is "
            "kept, and can be resumed"
        ) from None


def keep(path: Path, arrays: Mapping[str, Any]) -> None:
    """Write `arrays` to `path`, whole or not at all."""
    with tempfile.TemporaryDirectory(dir=path.parent) as folder:
        whole = Path(folder) / path.name
        np.savez(whole, **arrays)
        whole.replace(path)


def _read(path: Path) -> dict[str, Any]:
    with path.open("rb") as opened, np.load(opened) as arrays:
        return dict(arrays)


def kept(path: Path) -> dict[str, Any] | None:
    """What `keep` wrote, if it is there and whole."""
    try:
        return _read(path)
    except _UNREADABLE:
        return None


def stored(job: Job) -> Samples:
    """The arrays of the store."""
    return dict(zarr.open_group(job.out, mode="r+").arrays())


def _emptied(folder: Path) -> None:
    """Remove what an ensemble that is no longer there has left."""
    for path in folder.iterdir():
        if path.is_dir():
            shutil.rmtree(path)
        elif path.name != "lock":
            path.unlink()


class Trajectories:
    """Every sample, in memory or in the store."""

    waiting = 0
    """blocks taken that wait for those before them"""

    def __init__(self, job: Job, bound: Walk) -> None:
        self.job, self.bound = job, bound
        if job.out is None:
            self.arrays: Samples = {
                name: np.full(shape, np.nan) for name, _, shape, _ in self._variables()
            }
        else:
            if not job.out.exists():
                with telling(job):
                    self._create(job.out)
            self.arrays = stored(job)
        missing = np.isnan(self.arrays["lost_time"][:])
        self.missing = [i for i in range(job.blocks) if missing[job.members(i)].any()]

    def take(self, index: int, gathered: Gathered | None) -> None:
        """Block `index` was written by who computed it."""

    def finish(self, complete: bool) -> xr.Dataset:
        """What there is; if that is all, the folder beside the store is not needed any more."""
        job = self.job
        if job.out is None:
            dataset = xr.Dataset(
                {name: (dimensions, self.arrays[name], attributes)
                 for name, dimensions, _, attributes in self._variables()},
                {name: (name, values, attributes)
                 for name, values, attributes in self._coordinates()},
                attributes_of(job, self.bound),
            )  # fmt: skip
        else:
            if complete:
                for torn in job.out.rglob("*.partial"):  # of a process that was killed
                    torn.unlink()
                shutil.rmtree(job.part)
            dataset = xr.open_zarr(job.out, chunks=None)
        done = int((~np.isnan(self.arrays["lost_time"][:])).sum())
        return _ended(dataset, complete, done)

    def _variables(self) -> Iterator[tuple[str, tuple[str, ...], tuple[int, ...], Attributes]]:
        """Name, dimensions, shape and attributes."""
        n, samples = self.job.trajectories, self.job.cuts[-1]
        for name in columns_of(self.bound):
            columns, dimension, units, long_name = QUANTITIES[name]
            yield (
                name, ("trajectory", "time", dimension), (n, samples, len(columns)),
                {"units": units, "long_name": long_name},
            )  # fmt: skip
        yield (
            "lost_time", ("trajectory",), (n,),
            {"units": "s", "long_name": "when the bead was lost; infinite: it was not"},
        )  # fmt: skip

    def _coordinates(self) -> Iterator[tuple[str, NDArray[Any], Attributes]]:
        """Name, values and attributes."""
        yield "time", self.bound.times, {"units": "s", "long_name": "time since release"}
        for dimension in dict.fromkeys(QUANTITIES[name][1] for name in columns_of(self.bound)):
            yield dimension, np.array(COORDINATES[dimension]), {}

    def _create(self, out: Path) -> None:
        """The store before any sample."""
        _emptied(self.job.part)
        whole = self.job.part / "new"
        group = zarr.create_group(whole, attributes=attributes_of(self.job, self.bound))
        for name, dimensions, shape, attributes in self._variables():
            group.create_array(
                name, shape=shape, dtype="float64", fill_value=np.nan, dimension_names=dimensions,
                chunks=tuple(map(min, shape, (self.job.block, self.job.cuts[1], shape[-1]))),
                compressors=[Crc32cCodec()],  # noise is not made smaller
                attributes=attributes,
            )  # fmt: skip
        for name, values, attributes in self._coordinates():
            array = group.create_array(
                name, shape=values.shape, dtype=str if values.dtype.kind == "U" else values.dtype,
                dimension_names=(name,), attributes=attributes,
            )  # fmt: skip
            array[:] = values
        with warnings.catch_warnings(action="ignore"):  # Zarr's specification has it not yet
            zarr.consolidate_metadata(whole)
        whole.replace(out)


class Joined:
    """Statistics of the blocks, joined in their order, whichever is done first."""

    arrays = None

    def __init__(self, job: Job, bound: Walk) -> None:
        self.job, self.attributes = job, attributes_of(job, bound)
        self.joined = Statistics(plan_of(bound, job.skipped or 0))
        self.later: dict[int, Gathered] = {}
        self.next = self.written = 0
        if job.out is not None:
            if job.out.exists():
                self.next = job.blocks
            elif job.total.exists():
                begun = _read(job.total)
                self.joined = Statistics.of(self.joined.plan, begun)
                self.next = self.written = int(begun["next"])
            else:
                with telling(job):
                    _emptied(job.part)
                    self._write()
        self.missing = range(self.next, job.blocks)

    @property
    def waiting(self) -> int:
        """Blocks taken that wait for those before them."""
        return len(self.later)

    def take(self, index: int, gathered: Gathered | None) -> None:
        """Block `index` is done, unless it has gathered nothing."""
        if gathered is None:
            return
        self.later[index] = gathered
        while self.next in self.later:
            self.joined.join(Statistics.of(self.joined.plan, self.later.pop(self.next)))
            self.next += 1
        if self.job.out is not None and self.next >= self.written + _JOINED:
            with telling(self.job):
                self._write()

    def _write(self) -> None:
        """What is joined; and then remove what it was joined from."""
        attributes = json.dumps(self.attributes)
        keep(self.job.total, self.joined.arrays() | {"next": self.next, "attributes": attributes})
        for index in range(self.written, self.next):
            self.job.checkpoint(index).unlink(missing_ok=True)
        self.written = self.next

    def finish(self, complete: bool) -> xr.Dataset:
        """Statistics of what there is, written if that is all."""
        job = self.job
        if job.out is not None and job.out.exists():
            dataset = load_run(job.out)
        else:
            units = {name: (dimension, unit) for name, (_, dimension, unit, _) in
                     QUANTITIES.items()}  # fmt: skip
            dataset = self.joined.dataset(units).assign_attrs(self.attributes)
            if job.out is not None:
                with telling(job):
                    self._write()
                    if complete:
                        save_run(dataset, job.part / job.out.name).replace(job.out)
        if complete and job.out is not None:
            shutil.rmtree(job.part)
        return _ended(dataset, complete, int(dataset["trajectories"]))


def _ended(dataset: xr.Dataset, complete: bool, done: int) -> xr.Dataset:
    return dataset.assign_attrs(
        status="complete" if complete else "interrupted", trajectories_done=done
    )
