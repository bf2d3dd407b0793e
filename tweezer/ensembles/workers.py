"""Computation of blocks, on threads of this process or on the workers of a Dask scheduler."""

from __future__ import annotations

import contextlib
import functools
import json
import platform
import threading
import uuid
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError, Future, ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tweezer.dynamics.layout import POSITION, Layout
from tweezer.dynamics.mirror import AT_MIRROR
from tweezer.dynamics.walk import Walk
from tweezer.ensembles.job import SEEN, SIGNAL, Job, found_of, identity_of, plan_of
from tweezer.ensembles.motion import Moving, moving
from tweezer.ensembles.scheduler import PATIENCE, client_of
from tweezer.ensembles.statistics import Statistics
from tweezer.ensembles.store import (
    Gathered,
    Samples,
    chunk_of,
    keep,
    kept,
    stored,
    sums_of,
)
from tweezer.scene import Scene
from tweezer.values.arrays import Array
from tweezer.values.beside import telling
from tweezer.values.errors import IntegrationError, TweezerError
from tweezer.values.stores import checksum

if TYPE_CHECKING:
    from distributed import Client


#: Number of samples between two checks whether to stop
_PIECE_SAMPLES = 2**17
#: Number of steps between two checks whether to stop
_PIECE_STEPS = 2**22
#: Number of steps of a block between checkpoints within a window (minutes of work)
_KEPT_STEPS = 2**31


@dataclass(frozen=True)
class Pool:
    """Workers that compute blocks: functions to submit blocks and to stop them."""

    submit: Callable[[int, Samples | None, dict[int, float]], Future[Gathered | None]]
    """submits the block with a given index; threads write to the given arrays, and update the
    block's finished fraction of the ensemble in the dictionary"""
    width: Callable[[], int]
    """returns the number of blocks computed simultaneously"""
    stop: Callable[[], None]
    """asks the workers to abandon their blocks soon"""
    patience: float | None = None
    """longest time to wait for workers to stop, s; None for no limit"""


@contextlib.contextmanager
def threads(job: Job, bound: Moving, workers: int) -> Iterator[Pool]:
    """Provide a pool of `workers` threads of this process; `bound` is the walk of the scene."""
    stopped = threading.Event()
    with ThreadPoolExecutor(workers) as executor:
        yield Pool(
            lambda index, arrays, parts: executor.submit(
                _block, job, index, bound, arrays, stopped.is_set, parts
            ),
            lambda: workers,
            stopped.set,
        )


@contextlib.contextmanager
def cluster(job: Job, scheduler: str | Client) -> Iterator[Pool]:
    """Provide a pool of the workers of a Dask scheduler, given by its address or client.

    The workers stop when a file in the ensemble's folder is removed, which all of them can see.
    """
    with contextlib.ExitStack() as stack:
        client = stack.enter_context(client_of(scheduler))
        from distributed import KilledWorker

        executor = client.get_executor(pure=False)
        run = job.part / f"{uuid.uuid4().hex}.run"
        with telling(job.out):
            run.touch()

        def stop() -> None:
            """Remove the file whose existence the workers check."""
            with contextlib.suppress(OSError):
                run.unlink(missing_ok=True)

        stack.callback(stop)
        try:
            yield Pool(
                lambda index, *_: executor.submit(_block_there, job, run, index),
                lambda: max(1, sum(client.nthreads().values())),
                stop,
                PATIENCE,
            )
        except KilledWorker:
            raise TweezerError(f"{job.out}: workers died too often; continue with resume") from None
        except CancelledError:
            raise TweezerError(
                f"{job.out}: connection to the scheduler lost; continue with resume"
            ) from None


def _block_there(job: Job, run: Path, index: int) -> Gathered | None:
    """Compute a block in another process by `_block`, until the file `run` is removed.

    Raises `TweezerError` if this process would compute different numbers. The statistics stay in
    the block's checkpoint, so that they do not pass through the scheduler.
    """
    bound = _walk_of(job.scene, job.seed)
    for key, value in found_of(bound).items():
        if value != job.found[key]:
            raise TweezerError(
                f"{job.out}: worker {platform.node()} computes with another "
                f"{key.replace('_', ' ')}: {value}, not {job.found[key]}"
            )
    gathered = _block(job, index, bound, None, lambda: not run.exists(), {})
    return None if gathered is None else {}


@functools.lru_cache(maxsize=2)
def _walk_of(scene: str, seed: int) -> Moving:
    """Return the thermal motion of a scene (JSON), ready to be simulated with this seed.

    It is cached, so that a worker prepares it once for all its blocks of trajectories.
    """
    return moving(Scene.model_validate_json(scene), seed)


@dataclass
class _Output:
    """Output of a block: chunks of arrays with their checksums, and checkpoints."""

    job: Job
    """description of the ensemble"""
    index: int
    """number of the block"""
    bound: Moving
    """equations of motion and times of samples"""
    identity: str
    """digest of the ensemble, by which its checkpoints are recognised"""
    arrays: Samples | None
    """arrays of trajectories to write to; None for statistics"""
    sums: dict[str, str]
    """checksums of the written chunks, by file name"""
    written: int
    """number of camera frames written so far"""
    frames: list[Array] = field(default_factory=list)
    """frames that ended since then, (trajectories, frames, axes), m, each"""

    @functools.cached_property
    def members(self) -> slice:
        """Numbers of the trajectories in the block, as a slice."""
        return self.job.members(self.index)

    def _note(self, name: str, *at: int) -> None:
        """Record the checksum of a written chunk of an array, with the chunk indices `at`."""
        if self.job.out is not None and self.arrays is not None:
            chunk = chunk_of(self.arrays, name, *at)
            self.sums[chunk] = checksum(self.job.out / chunk)

    def write_frames(self) -> None:
        """Write the camera frames that ended since the last call."""
        if not self.frames or self.arrays is None:
            return
        seen = np.concatenate(self.frames, axis=1)
        first, self.written = self.written, self.written + seen.shape[1]
        self.arrays[SEEN][self.members, first : self.written] = seen
        self.frames.clear()
        if self.job.out is not None:
            _, most, _ = self.arrays[SEEN].shape
            _, length, _ = self.arrays[SEEN].chunks
            whole = self.written // length
            ended = -(-self.written // length) if self.written == most else whole
            for chunk in range(first // length, ended):
                self._note(SEEN, self.index, chunk)

    def write_window(self, window: int, samples: Array, lost: Array) -> None:
        """Write the samples of a window and, after the last window, the times of loss.

        `samples` is (trajectories, samples, columns), and `lost` (trajectories,) is in s, infinite
        without a loss.
        """
        if self.arrays is None:
            return
        first, end = self.job.cuts[window : window + 2]
        layout = self.bound.shown
        for name in layout.blocks:
            self.arrays[name][self.members, first:end] = samples[..., layout.at(name)]
            self._note(name, self.index, window)
        if (scene := self.bound.scene).detector is not None:
            from tweezer.dynamics.detector import Signals

            members = np.arange(self.members.start, self.members.stop)
            signals = Signals.of(scene, self.job.seed, self.bound.times)
            places = np.ascontiguousarray(samples[..., layout.at("position")])
            self.arrays[SIGNAL][self.members, first:end] = signals.recorded(places, members, first)
            self._note(SIGNAL, self.index, window)
        self.write_frames()
        if window == len(self.job.cuts) - 2:
            self.arrays["lost_time"][self.members] = lost
            self._note("lost_time", self.index)

    def keep(
        self, window: int, states: Array, samples: Array, statistics: Statistics | None
    ) -> None:
        """Write the checkpoint of a block within a window, or at its beginning.

        `window` is the number of the window. `states` are the states of the walk, `samples`
        (trajectories, samples, columns) those of the window so far, and `statistics` those of the
        block so far, or None if trajectories are stored.
        """
        if self.job.out is None:
            return
        begun = {
            "identity": self.identity, "block": self.index, "window": window, "states": states,
            "held": samples,
        }  # fmt: skip
        more = statistics.arrays() if statistics else {"sums": json.dumps(self.sums)}
        keep(self.job.checkpoint(self.index), begun | more)


def _block(
    job: Job,
    index: int,
    bound: Moving,
    arrays: Samples | None,
    stopped: Callable[[], bool],
    parts: dict[int, float],
) -> Gathered | None:
    """Compute block `index`, starting from its checkpoint; return its statistics, or None if
    stopped.

    `arrays` are the arrays of trajectories to write to. They are None for statistics, and in
    another process, which opens the store itself. `stopped` returns whether to abandon the block.
    `parts[index]` is updated with the finished fraction of the ensemble in this block.
    """
    if stopped():
        return None
    members = job.members(index)
    trajectories = np.arange(members.start, members.stop)
    identity = identity_of(job, bound)
    layout, statistics = bound.shown, None
    if job.skipped is not None:
        layout = Layout({"position": layout.blocks["position"]}, layout.bodies)
        statistics = Statistics(plan_of(bound, job.skipped))
    elif arrays is None:
        arrays = stored(job)
    window, states = 0, bound.start(trajectories)
    sums: dict[str, str] = {}  # checksums of the written chunks, by file name
    before = np.empty((len(trajectories), 0, *layout.shape))  # samples of the current window
    if job.out is not None and (begun := kept(job, index, identity)):
        window, states, before = int(begun["window"]), begun["states"], begun["held"]
        sums = sums_of(begun)
        if statistics:
            statistics = Statistics.of(statistics.plan, begun)
    written = bound.frames(max(job.cuts[window] + before.shape[1] - 1, 0))
    output = _Output(job, index, bound, identity, arrays, sums, written)
    windows = len(job.cuts) - 1
    for i in range(window, windows):
        first, end = job.cuts[i], job.cuts[i + 1]
        samples = np.empty((len(trajectories), end - first, *layout.shape))
        samples[:, : before.shape[1]] = before
        last = first + before.shape[1]
        before = before[:, :0]
        pieces = _advance(bound, states, trajectories, last, end, filmed=arrays is not None)
        for at, piece, seen in pieces:
            if stopped():
                return None
            if seen.size:
                output.frames.append(seen)
            reached = at + piece.shape[1]
            samples[:, at - first : reached - first] = piece[..., : layout.width]
            if statistics:
                statistics.add_piece(at, piece)
            parts[index] = job.share(index) * reached / job.cuts[-1]
            if len(trajectories) * (reached - last) * bound.per_sample >= _KEPT_STEPS:
                with telling(job.out):
                    output.write_frames()
                    output.keep(i, states, samples[:, : reached - first], statistics)
                last = reached
        if statistics:
            statistics.add_window(first, samples)
            if i == windows - 1:
                statistics.close(bound.lost(states))
        with telling(job.out):
            output.write_window(i, samples, bound.lost(states))
            output.keep(i + 1, states, before, statistics)
    return statistics.arrays() if statistics else {}


def _advance(
    bound: Moving,
    states: Array,
    trajectories: NDArray[np.int64],
    first: int,
    end: int,
    *,
    filmed: bool,
) -> Iterator[tuple[int, Array, Array]]:
    """Compute samples `first` to `end` - 1, and yield them in pieces.

    A piece consists of the number of its first sample and the samples (trajectories, n, columns),
    followed, if `filmed`, by the camera frames that end during it, (trajectories, frames, axes).
    `states` of the walk are updated. The numbers of the `trajectories` determine their noise.
    """
    n = len(trajectories)
    if first == 0:
        yield 0, _in_the_body(bound, bound.seen(states)[:, None].copy()), np.empty((n, 0, 0))
    most = max(1, min(_PIECE_SAMPLES, _PIECE_STEPS // bound.per_sample) // n)
    for at in range(max(1, first), end, most):
        piece = np.empty((n, min(most, end - at), *bound.shown.shape))
        seen = np.empty((n, 0, 0))
        if filmed:
            seen = bound.filmed(states, trajectories, at - 1, piece)
        else:
            bound.advance(states, trajectories, at - 1, piece)
        reached = bound.before_mirror(piece) < piece.shape[1]
        if reached.any():
            raise IntegrationError(f"trajectory {trajectories[reached][0]}: {AT_MIRROR}")
        yield at, _in_the_body(bound, piece), seen


def _in_the_body(bound: Moving, samples: Array) -> Array:
    """Return samples (..., columns) with the angular velocity about the axes of the body.

    It is converted in place from the form that the walk integrates. NaN after a loss remain NaN.
    """
    held = ~np.isnan(samples[..., POSITION.start])
    if isinstance(bound, Walk) and "angular_velocity" in bound.shown and held.any():
        columns = bound.shown.at("angular_velocity")
        samples[held, columns] = bound.motion(samples[held]).angular_velocity
    return samples
