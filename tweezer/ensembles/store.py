"""Files of an ensemble: its output and its checkpoints."""

from __future__ import annotations

import contextlib
import json
import math
import re
import shutil
import warnings
import zipfile
from collections.abc import Iterator, Mapping
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
import zarr
from numpy.typing import NDArray
from pydantic import ValidationError
from zarr.codecs import Crc32cCodec, ZstdCodec

from tweezer.dynamics.layout import QUANTITIES
from tweezer.ensembles.job import (
    SEEN,
    SIGNAL,
    Attributes,
    Job,
    attributes_of,
    identity_of,
    plan_of,
)
from tweezer.ensembles.motion import Moving
from tweezer.ensembles.statistics import Statistics
from tweezer.results.io import load_result, save_run
from tweezer.scene import Scene
from tweezer.values.beside import held, remove, telling
from tweezer.values.errors import ResultError
from tweezer.values.files import write_whole
from tweezer.values.stores import checksum, checksums, description_of_store, open_written, seal
from tweezer.values.version import FORMAL

#: Arrays of trajectories by name, in memory or in a Zarr store
Samples = Mapping[str, Any]
#: Statistics of a block by name; empty if trajectories are written
Gathered = Mapping[str, NDArray[np.float64]]

#: Size of the checksum at the end of a chunk, bytes
_CHECKSUM = 4
#: Number of blocks joined between two saves of the statistics
_JOINED = 16
#: Errors when reading a file that is damaged or of another kind
_UNREADABLE = (OSError, EOFError, ValueError, KeyError, zipfile.BadZipFile)
#: Names of files that an interrupted write of Zarr leaves in the store
_TORN = re.compile(r"\d+\.[0-9a-f]+\.partial")


def _begun(job: Job, bound: Moving, resume: bool) -> bool:
    """Return whether an ensemble at `job.out` was begun earlier.

    Raises `ResultError` if it was and `resume` is not set, or if it has another scene or other
    settings.
    """
    made = _made(job)
    if made is None:
        return False
    if not resume:
        raise ResultError(
            f"{job.out}: already exists or is unfinished; resume it or choose another file"
        )
    for key, value in attributes_of(job, bound).items():
        if key in FORMAL:  # the scene contains the same as numbers
            continue
        if key == "scene":
            if not _same_scene(made.get(key), value):
                raise ResultError(
                    f"{job.out}: belongs to another scene and cannot be resumed with this one"
                )
        elif made.get(key) != value:
            raise ResultError(
                f"{job.out}: made with {key.replace('_', ' ')} {made.get(key)}, which cannot be "
                f"resumed with {value}"
            )
    return True


def _same_scene(made: object, scene: str) -> bool:
    """Return whether two scenes, as JSON, are equal; False if `made` is not a scene."""
    if not isinstance(made, str):
        return False
    try:
        return Scene.model_validate_json(made) == Scene.model_validate_json(scene)
    except ValidationError:
        return False


def _made(job: Job) -> Attributes | None:
    """Return the attributes of an ensemble begun earlier at `job.out`; None without one.

    Raises `ResultError` for a file of another kind, or a damaged one.
    """
    assert job.out is not None
    try:
        if job.out.exists():
            if job.skipped is None:
                return description_of_store(job.out)[0]
            return dict(load_result(job.out).attrs)
        if job.skipped is not None and job.total.exists():
            return dict(json.loads(str(_read(job.total)["attributes"])))
    except ResultError:
        raise
    except Exception as error:  # Zarr raises errors of any type for a damaged file
        reason = " ".join(str(error).split())
        raise ResultError(f"{job.out}: not an ensemble: {reason}") from None
    return None


@contextlib.contextmanager
def at_work(job: Job, bound: Moving, resume: bool) -> Iterator[None]:
    """Lock the folder beside the output during the computation, so that no other process uses it.

    Raises `ResultError` if it is locked, or if an ensemble at `job.out` must not be resumed.
    """
    assert job.out is not None
    with held(job.out):
        begun = _begun(job, bound, resume)
        with telling(job.out):
            job.beside.make()
            for path in job.beside.files():  # left by a deleted ensemble or its workers
                if not begun or path.suffix != ".npz":
                    remove(path)
        try:
            yield
        finally:
            job.beside.remove_if_empty()


def keep(path: Path, arrays: Mapping[str, Any]) -> None:
    """Write arrays to an npz file atomically."""
    content = BytesIO()
    np.savez(content, **arrays)
    write_whole(path, content)


def _read(path: Path) -> dict[str, Any]:
    """Return the arrays of an npz file by name."""
    with path.open("rb") as opened, np.load(opened) as arrays:
        return dict(arrays)


def kept(job: Job, index: int, identity: str) -> dict[str, Any] | None:
    """Return the arrays of the checkpoint of block `index`, by name.

    Returns None if the checkpoint is missing or damaged, or if it belongs to another block or to an
    ensemble whose digest is not `identity`.
    """
    try:
        arrays = _read(job.checkpoint(index))
        own = str(arrays["identity"]) == identity and int(arrays["block"]) == index
    except _UNREADABLE:
        return None
    return arrays if own else None


def stored(job: Job) -> Samples:
    """Open the arrays of the Zarr store for writing, by name.

    Empty chunks are written too, so a missing chunk is an error.
    """
    return {
        name: array.with_config({"write_empty_chunks": True})
        for name, array in zarr.open_group(job.out, mode="r+", zarr_format=3).arrays()
    }


def chunk_of(arrays: Samples, name: str, *at: int) -> str:
    """Return the file name of an array's chunk in the store, with the chunk indices `at`.

    Indices that are left out are 0.
    """
    array = arrays[name]
    at = (*at, *[0] * (array.ndim - len(at)))
    return f"{name}/{array.metadata.encode_chunk_key(at)}"


def sums_of(begun: Mapping[str, Any] | None) -> dict[str, str]:
    """Return the checksums, by file name, of the chunks written before the checkpoint `begun`.

    Chunks that are written to again later are excluded.
    """
    return dict(json.loads(str(begun["sums"]))) if begun and "sums" in begun else {}


def _described(arrays: Samples) -> dict[str, str]:
    """Return the metadata of arrays by name, to compare the two copies that Zarr stores.

    One copy is in the array's own file, the other in the file of the store.
    """
    return {name: str(array.metadata.to_dict()) for name, array in arrays.items()}


class Trajectories:
    """Output of an ensemble that stores its trajectories, in memory or in a Zarr store.

    `missing` lists the indices of the blocks to compute, and `left` those not yet done.
    """

    waiting = 0
    """number of finished blocks waiting for earlier ones; always 0 here, unlike `Joined.waiting`"""

    def __init__(self, job: Job, bound: Moving) -> None:
        """Create the arrays or the store, or open an existing store and find its missing blocks."""
        self.job, self.bound = job, bound
        self.missing = list(range(job.blocks))
        #: checksums of chunks written by an earlier process, by file name
        self.sums: dict[str, str] = {}
        if job.out is None:
            self.arrays: Samples = {
                name: np.full(shape, np.nan) for name, _, shape, _ in self._variables()
            }
        else:
            begun = job.out.exists()
            if not begun:
                with telling(job.out):
                    self._create(job.out)
            self._open()
            if begun:
                self.sums = description_of_store(job.out)[1]
                with telling(job.out):
                    self.missing = [i for i in self.missing if not self._found(i)]
        self.left = set(self.missing)

    def take(self, index: int, gathered: Gathered | None) -> None:
        """Record a block whose worker has written it; `gathered` is None if it was stopped."""
        if gathered is not None:
            self.left.discard(index)

    def finish(self, complete: bool) -> xr.Dataset:
        """Return the result so far.

        If it is complete, write the checksums of the store and remove the folder of checkpoints.
        """
        job = self.job
        if job.out is None:
            dataset = xr.Dataset(
                {name: (dimensions, self.arrays[name], attributes)
                 for name, dimensions, _, attributes in self._variables()},
                {name: (dimension, values, attributes)
                 for name, (dimension, values, attributes) in self._coordinates().items()},
                attributes_of(job, self.bound),
            )  # fmt: skip
        else:
            if complete:
                with contextlib.suppress(OSError):
                    for name, *_ in self._variables():
                        for path in (job.out / name / "c").rglob("*.partial"):
                            if _TORN.fullmatch(path.name):
                                path.unlink(missing_ok=True)
                with telling(job.out):
                    self._seal(job.out)
                job.beside.remove()
            dataset = open_written(job.out)
        left = (job.members(index) for index in self.left)
        done = job.trajectories - sum(members.stop - members.start for members in left)
        return _ended(dataset, complete, done)

    def _seal(self, out: Path) -> None:
        """Write the checksums of all chunks, which the blocks recorded when they wrote them."""
        sums = checksums(out) | self.sums
        for index in range(self.job.blocks):
            sums |= sums_of(kept(self.job, index, identity_of(self.job, self.bound)))
        seal(out, sums)

    def _open(self) -> None:
        """Open the arrays of the store; raises `ResultError` if they do not match the job."""
        damaged = f"{self.job.out}: damaged: its arrays differ from those that were written"
        try:
            self.arrays = stored(self.job)
            own = {
                name: zarr.open_array(f"{self.job.out}/{name}", mode="r", zarr_format=3)
                for name in self.arrays
            }
            as_written = (
                _described(own) == _described(self.arrays)
                and all(
                    (self.arrays[name].shape, self.arrays[name].chunks)
                    == (shape, self._chunks(name, shape))
                    and self.arrays[name].dtype == np.float64
                    for name, _, shape, _ in self._variables()
                )
                and all(
                    np.array_equal(self.arrays[name][:], values)
                    for name, (_, values, _) in self._coordinates().items()
                )
            )
        except Exception as error:  # Zarr raises errors of any type for a damaged file
            raise ResultError(f"{damaged}: {' '.join(str(error).split())}") from None
        if not as_written:
            raise ResultError(damaged)

    def _found(self, index: int) -> bool:
        """Return whether a block is complete in the store, by the sizes and checksums of its files.

        A block that is not continues from its checkpoint, if all chunks before it are present.
        Otherwise it is computed again.
        """
        job, names = self.job, [*self.bound.shown.blocks]
        if SIGNAL in self.arrays:
            names.append(SIGNAL)
        windows = range(len(job.cuts) - 1)
        begun = kept(job, index, identity_of(job, self.bound))
        self.sums |= sums_of(begun)
        lacking = (
            w for w in windows
            if not all(self._whole(name, index, w) for name in names)
            or not self._filmed(index, w)
        )  # fmt: skip
        reached = next(lacking, len(windows))
        if reached == len(windows) and self._whole("lost_time", index):
            return True
        self._chunk("lost_time", index).unlink(missing_ok=True)
        if begun and int(begun["window"]) > min(reached, windows[-1]):
            job.checkpoint(index).unlink()
        return False

    def _filmed(self, index: int, window: int) -> bool:
        """Return whether the chunks of camera frames that end in a window of a block are intact."""
        if SEEN not in self.arrays:
            return True
        first, end = self.job.cuts[window : window + 2]
        ended = self.bound.frames(max(first - 1, 0)), self.bound.frames(end - 1)
        length = self.arrays[SEEN].chunks[1]
        found = True
        for chunk in range(ended[0] // length, -(-ended[1] // length)):
            if not self._whole(SEEN, index, chunk):  # a damaged chunk cannot be extended
                self._chunk(SEEN, index, chunk).unlink(missing_ok=True)
                found = False
        return found

    def _chunk(self, name: str, *at: int) -> Path:
        """Return the file of the chunk of an array at the chunk indices `at`."""
        assert self.job.out is not None
        return self.job.out / chunk_of(self.arrays, name, *at)

    def _whole(self, name: str, *at: int) -> bool:
        """Return whether the file of a chunk has the expected size and checksum."""
        size = 8 * math.prod(self.arrays[name].chunks) + _CHECKSUM
        noted = self.sums.get(chunk_of(self.arrays, name, *at))
        path = self._chunk(name, *at)
        try:
            return path.stat().st_size == size and noted in (None, checksum(path))
        except FileNotFoundError:
            return False

    def _variables(self) -> Iterator[tuple[str, tuple[str, ...], tuple[int, ...], Attributes]]:
        """Yield name, dimensions, shape and attributes of each array of the result."""
        n, samples = self.job.trajectories, self.job.cuts[-1]
        shown = self.bound.shown
        among = ("bead",) if shown.bodies > 1 else ()
        for name in shown.blocks:
            each = QUANTITIES[name]
            yield (
                name, ("trajectory", "time", *among, each.dimension),
                (n, samples, *shown.shape[:-1], len(each.columns)),
                {"units": each.unit, "long_name": each.long_name},
            )  # fmt: skip
        if (exposure := self.bound.exposure) is not None:
            shape = n, len(exposure.frames.opens), len(exposure.frames.camera.axes)
            yield (
                SEEN, ("trajectory", "frame", "seen_axis"), shape,
                {"units": "m", "long_name": "position that the camera saw"},
            )  # fmt: skip
        if self.bound.scene.detector is not None:
            yield (
                SIGNAL, ("trajectory", "time", "channel"), (n, samples, 3),
                {"units": "W", "long_name": "signal of the detector"},
            )  # fmt: skip
        yield (
            "lost_time", ("trajectory",), (n,),
            {"units": "s", "long_name": "when the bead was lost; infinite: it was not"},
        )  # fmt: skip

    def _coordinates(self) -> dict[str, tuple[str, NDArray[Any], Attributes]]:
        """Return dimension, values and attributes of each coordinate by name."""
        about = {"units": "s", "long_name": "time since release"}
        found: dict[str, tuple[str, NDArray[Any], Attributes]] = {
            "time": ("time", self.bound.times, about)
        }
        for name in self.bound.shown.blocks:
            each = QUANTITIES[name]
            found[each.dimension] = each.dimension, *each.coordinate
        if self.bound.shown.bodies > 1:
            names = np.array(self.bound.scene.bead_names)
            found["bead"] = "bead", names, {"long_name": "name of the bead"}
        if (exposure := self.bound.exposure) is not None:
            middle = "time since release, middle of the exposure"
            about = {"units": "s", "long_name": middle}
            found["frame_time"] = "frame", exposure.frames.times, about
            about = {"long_name": "axis of a frame"}
            found["seen_axis"] = "seen_axis", np.array(exposure.frames.camera.axes), about
        if self.bound.scene.detector is not None:
            about = {"long_name": "signal of the detector"}
            found["channel"] = "channel", np.array(["x", "y", "z"]), about
        return found

    def _chunks(self, name: str, shape: tuple[int, ...]) -> tuple[int, ...]:
        """Return the chunk shape of an array, which covers a window of samples in a block.

        A chunk of camera frames has the average number of frames that end in a window.
        """
        window = self.job.cuts[1]
        if name == SEEN:
            window = -(-shape[1] // (len(self.job.cuts) - 1))
        return tuple(map(min, shape, (self.job.block, window, *shape[2:])))

    def _create(self, out: Path) -> None:
        """Create the Zarr store without samples; raises `ResultError` if the disk is too full."""
        taken = sum(8 * math.prod(shape) for _, _, shape, _ in self._variables())
        free = shutil.disk_usage(out.parent).free
        if taken > free:
            raise ResultError(
                f"{out}: {self.job.trajectories} trajectories take {taken / 1e9:.3g} GB, and "
                f"{free / 1e9:.3g} GB are free; choose another folder, or compute statistics"
            )
        whole = self.job.beside.new()
        group = zarr.create_group(whole, attributes=attributes_of(self.job, self.bound))
        for name, dimensions, shape, attributes in self._variables():
            group.create_array(
                name, shape=shape, dtype="float64", fill_value=np.nan, dimension_names=dimensions,
                chunks=self._chunks(name, shape),
                compressors=[Crc32cCodec()],  # noise does not compress
                attributes=attributes | ({"coordinates": "frame_time"} if name == SEEN else {}),
            )  # fmt: skip
        for name, (dimension, values, attributes) in self._coordinates().items():
            array = group.create_array(
                name, shape=values.shape, dtype=str if values.dtype.kind == "U" else values.dtype,
                dimension_names=(dimension,), attributes=attributes,
                compressors=[ZstdCodec(), Crc32cCodec()], config={"write_empty_chunks": True},
            )  # fmt: skip
            array[:] = values
        with warnings.catch_warnings(action="ignore"):  # not yet in the specification of Zarr
            zarr.consolidate_metadata(whole)
        seal(whole)
        whole.replace(out)


class Joined:
    """Output of an ensemble that stores statistics, joined block by block in order.

    Because of the fixed order, the result does not depend on the order in which workers finish.
    """

    arrays = None
    """None, because no trajectories are stored; corresponds to `Trajectories.arrays`"""

    def __init__(self, job: Job, bound: Moving) -> None:
        """Start without blocks, or with the joined blocks that an interrupted ensemble saved."""
        self.job, self.attributes = job, attributes_of(job, bound)
        self.identity = identity_of(job, bound)
        self.plan = plan_of(bound, job.skipped or 0)
        #: number of joined blocks and their statistics, in one object so that both change together
        self.joined = 0, Statistics(self.plan)
        #: finished blocks not yet joined; empty entries are read from the checkpoint of the block
        self.later: dict[int, Gathered] = {}
        self.written = 0
        if job.out is not None:
            if job.out.exists():
                self.joined = job.blocks, self.joined[1]
            elif job.total.exists():
                begun = _read(job.total)
                self.written = int(begun["next"])
                self.joined = self.written, Statistics.of(self.plan, begun)
            else:
                with telling(job.out):
                    self._write()
        self.missing = range(self.joined[0], job.blocks)

    @property
    def waiting(self) -> int:
        """Number of finished blocks waiting for earlier ones."""
        return len(self.later)

    def take(self, index: int, gathered: Gathered | None) -> None:
        """Record a finished block, and join all blocks before the first missing one.

        `gathered` contains the statistics of block `index`. It is empty if they are in its
        checkpoint, and None if the worker was stopped. A block may be recorded twice.
        """
        if gathered is None or index < self.joined[0]:
            return
        self.later[index] = gathered
        while self.joined[0] in self.later:
            blocks, statistics = self.joined
            statistics = statistics.join(self._of(blocks))
            self.joined = blocks + 1, statistics
            del self.later[blocks]
        if self.job.out is not None and self.joined[0] >= self.written + _JOINED:
            with telling(self.job.out):
                self._write()

    def _of(self, index: int) -> Statistics:
        """Return the statistics of a waiting block, from memory or from its checkpoint."""
        gathered = self.later[index] or kept(self.job, index, self.identity)
        if gathered is None or not gathered["blocks"]:
            raise ResultError(
                f"{self.job.checkpoint(index)}: damaged; resume the ensemble to compute this "
                "block again"
            )
        return Statistics.of(self.plan, gathered)

    def _write(self) -> None:
        """Write the joined statistics, then remove the checkpoints that they replace."""
        blocks, statistics = self.joined
        attributes = json.dumps(self.attributes)
        keep(self.job.total, statistics.arrays() | {"next": blocks, "attributes": attributes})
        for index in range(self.written, blocks):
            self.job.checkpoint(index).unlink(missing_ok=True)
        self.written = blocks

    def finish(self, complete: bool) -> xr.Dataset:
        """Return the statistics of all finished blocks, including waiting ones.

        Complete statistics are written to `job.out`.
        """
        job = self.job
        if job.out is not None and job.out.exists():
            dataset = load_result(job.out)
        else:
            blocks, statistics = self.joined
            for index in sorted(self.later):
                if index >= blocks:
                    statistics = statistics.join(self._of(index))
            dataset = statistics.dataset().assign_attrs(self.attributes)
            if job.out is not None:
                with telling(job.out):
                    self._write()
                    if complete:
                        save_run(dataset, job.out)
        if complete and job.out is not None:
            job.beside.remove()
        return _ended(dataset, complete, int(dataset["trajectories"]))


def _ended(dataset: xr.Dataset, complete: bool, done: int) -> xr.Dataset:
    """Return a result with its status and the number of finished trajectories, `done`."""
    return dataset.assign_attrs(
        status="complete" if complete else "interrupted", trajectories_done=done
    )
