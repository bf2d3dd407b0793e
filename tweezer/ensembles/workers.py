"""Computing blocks: on threads of this machine, or on the workers of a Dask scheduler."""

from __future__ import annotations

import contextlib
import functools
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError, Future, ThreadPoolExecutor
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tweezer.dynamics.walk import Walk, walk
from tweezer.ensembles.job import Job, columns_of, plan_of
from tweezer.ensembles.statistics import Statistics
from tweezer.ensembles.store import (
    Gathered,
    Samples,
    keep,
    kept,
    stored,
    telling,
)
from tweezer.errors import SceneError, TweezerError
from tweezer.scene import Scene

if TYPE_CHECKING:
    from distributed import Client

Array = NDArray[np.float64]

#: samples computed, and steps, between two looks at whether to stop
_PIECE_SAMPLES, _PIECE_STEPS = 2**17, 2**22
#: s to wait for a scheduler
_PATIENCE = 10


@dataclass(frozen=True)
class Pool:
    """Where blocks are computed."""

    submit: Callable[[int, Samples | None, dict[int, float]], Future[Gathered | None]]
    """a block, where threads write it, and what they tell of it"""
    width: Callable[[], int]
    """blocks computed at a time"""
    stop: Callable[[], None]
    """blocks then end, unfinished, soon"""


@contextlib.contextmanager
def threads(job: Job, bound: Walk, workers: int) -> Iterator[Pool]:
    """So many threads."""
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
    """The workers of a Dask scheduler."""
    try:
        from distributed import Client, KilledWorker
    except ImportError:
        raise TweezerError("scheduler: needs `pip install tweezer[cluster]`") from None
    with contextlib.ExitStack() as stack:
        if isinstance(scheduler, Client):
            client = scheduler
        else:
            try:
                client = stack.enter_context(Client(scheduler, timeout=_PATIENCE))
            except (OSError, ValueError) as error:
                reason = " ".join(str(error).split())
                raise SceneError(f"scheduler = {scheduler!r}: not reached: {reason}") from None
        job.stop.unlink(missing_ok=True)
        executor = client.get_executor(pure=False)
        try:
            yield Pool(
                lambda index, *_: executor.submit(_block_there, job, index),
                lambda: max(1, sum(client.nthreads().values())),
                job.stop.touch,
            )
        except KilledWorker:
            raise TweezerError(f"{job.out}: workers died too often; it can be resumed") from None
        except CancelledError:
            raise TweezerError(f"{job.out}: the scheduler is gone; it can be resumed") from None


def _block_there(job: Job, index: int) -> Gathered | None:
    """`_block` in another process."""
    return _block(job, index, _bound(job.scene, job.seed), None, job.stop.exists, {})


@functools.lru_cache(maxsize=2)
def _bound(scene: str, seed: int) -> Walk:
    return walk(Scene.model_validate_json(scene), seed)


def _block(
    job: Job,
    index: int,
    bound: Walk,
    arrays: Samples | None,
    stopped: Callable[[], bool],
    parts: dict[int, float],
) -> Gathered | None:
    """Compute a block from where it was left; what is gathered of it, or None if `stopped`.

    parts: is told the part of the ensemble that is done of this block.
    """
    members = job.members(index)
    trajectories = np.arange(members.start, members.stop)
    statistics = None
    if job.skipped is not None:
        statistics = Statistics(plan_of(bound, job.skipped))
    elif arrays is None:
        arrays = stored(job)
    window, states = 0, bound.start(trajectories)
    if job.out is not None and (begun := kept(job.checkpoint(index))):
        window, states = int(begun["window"]), begun["states"]
        if statistics:
            statistics = Statistics.of(statistics.plan, begun)
    windows = len(job.cuts) - 1
    for i in range(window, windows):
        samples = np.empty((len(trajectories), job.cuts[i + 1] - job.cuts[i], len(bound.columns)))
        for reached in _advance(bound, states, trajectories, job.cuts[i], samples):
            if stopped():
                return None
            parts[index] = job.share(index) * reached / job.cuts[-1]
        if statistics:
            statistics.add(job.cuts[i], samples)
            if i == windows - 1:
                statistics.close(states[:, -1])
        with telling(job):
            if arrays is not None:
                within = slice(job.cuts[i], job.cuts[i + 1])
                for name, columns in columns_of(bound).items():
                    arrays[name][members, within] = samples[..., columns]
                if i == windows - 1:
                    arrays["lost_time"][members] = states[:, -1]
            if job.out is not None:
                begun = {"window": i + 1, "states": states}
                keep(job.checkpoint(index), begun | (statistics.arrays() if statistics else {}))
    return statistics.arrays() if statistics else {}


def _advance(
    bound: Walk, states: Array, trajectories: NDArray[np.int64], first: int, samples: Array
) -> Iterator[int]:
    """Fill `samples`, of which the first is sample `first`; how many are done, piece by piece."""
    begin = 0
    if first == 0:
        samples[:, 0] = states[:, :-1]
        begin = 1
    most = max(1, min(_PIECE_SAMPLES, _PIECE_STEPS // bound.per_sample) // len(trajectories))
    for at in range(begin, samples.shape[1], most):
        piece = np.empty((len(trajectories), min(most, samples.shape[1] - at), samples.shape[2]))
        bound.advance(states, trajectories, first + at - 1, piece)
        samples[:, at : at + piece.shape[1]] = piece
        yield first + at + piece.shape[1]
