"""Many Brownian trajectories of one scene."""

from __future__ import annotations

import contextlib
import functools
import time
from collections import deque
from collections.abc import Callable, Sequence
from concurrent.futures import Future, wait
from pathlib import Path
from queue import Empty, SimpleQueue
from typing import TYPE_CHECKING

import numba
import numpy as np
import xarray as xr
from numpy.typing import NDArray

from tweezer.arguments import check_ensemble, samples_skipped
from tweezer.dynamics.problem import bound_once
from tweezer.dynamics.walk import Walk, walk
from tweezer.ensembles.job import Job
from tweezer.ensembles.store import (
    Gathered,
    Joined,
    Trajectories,
    at_work,
)
from tweezer.ensembles.workers import cluster, threads
from tweezer.errors import ResultError, SceneError
from tweezer.forces.force import Force
from tweezer.forces.named import origins_of
from tweezer.scene import SceneLike, checked_scene
from tweezer.units import QuantityLike

if TYPE_CHECKING:
    from distributed import Client

Array = NDArray[np.float64]

#: Blocks in flight for each worker
_AHEAD = 4
#: Time between reports of progress, s
_TICK = 0.2
#: Time between counts of the workers, s
_LOOK = 2.0
#: Largest size of trajectories in memory, bytes
_MEMORY = 2**31


def ensemble(
    scene: SceneLike,
    trajectories: int,
    *,
    duration: QuantityLike | None = None,
    seed: int = 0,
    out: str | Path | None = None,
    statistics: bool = False,
    skip: QuantityLike = 0.0,
    scheduler: str | Client | None = None,
    workers: int | None = None,
    resume: bool = False,
    forces: Sequence[Force | str] = (),
    progress: Callable[[float], None] | None = None,
) -> xr.Dataset:
    """Release the bead of `scene` many times, each with its own thermal motion.

    duration: s, or text such as "20 ms", in place of the scene's. seed: of the random numbers;
    trajectory i of a seed does not depend on their number. out: the file to write, a Zarr store
    of trajectories or a NetCDF file of statistics; in memory if not given. statistics: gather these
    and store no trajectory. skip: s or text, time after the release that only the moments over time
    include. scheduler: address of a Dask scheduler, or a `distributed.Client`; its workers must see
    the file system of `out`, which is then needed. Without it, workers: threads on this machine, by
    default one for each core. resume: continue the ensemble at `out`, if there is one; a missing or
    truncated chunk is computed again, a chunk with wrong bytes fails its checksum when it is read.
    forces: of your own, beside those of the scene (`tweezer.forces`). With `out` each must be named
    by its Python file, "handles.py:spring", whose digest tells whether an ensemble can be resumed.
    progress: called with the finished part.

    Returns, and writes, trajectories as position (trajectory, time, axis) in m from the focus,
    velocity in m/s if the model has one, orientation (trajectory, time, euler_parameter) and, with
    inertia, angular_velocity (trajectory, time, body_axis) in rad/s if the scene has a rotation,
    all NaN once a bead is lost, and lost_time (trajectory), s: infinite for a bead never lost, NaN
    for a trajectory not yet computed; with a camera what it saw, seen (trajectory, frame,
    seen_axis) in m, NaN from the frame in which a bead was lost. They are read from the store when
    used; `xarray.open_zarr` opens it. Every chunk has a checksum.

    Statistics, which are of the motion and leave out a camera, are the mean, variance, skewness and
    excess kurtosis over the trajectories at up to 10,000 times, of position_..., velocity_...,
    angular_velocity_...; and of the positions from `skip` on their stationary_mean and
    stationary_variance (axis), counts and density (bin, axis), the mean-square displacement msd
    (axis, lag) and the one-sided spectrum psd (axis, frequency) of windows of at most 2^14 samples
    (Bartlett's method, mean removed; of instantaneous positions, so aliased). X_error is the
    standard error of X: over the trajectories; for stationary statistics, msd and psd over windows,
    taken as independent, which they are if windows are much longer than the trap's relaxation; for
    the density over blocks of trajectories. Samples after a loss are excluded, and from spectra and
    displacements the windows with a loss; both are counted. An error that would need more
    trajectories, windows or blocks is NaN, as its comment says, and so are skewness and kurtosis of
    equal values. There are no msd and psd for the method "one-call", whose displacements from step
    to step are not those of the motion.

    The numbers do not depend on workers, interruptions, or, for trajectories, on blocks and
    windows. The attributes hold the scene, the seed, the versions, the step and why it was chosen;
    those returned also status, "complete" or "interrupted" (Ctrl-C), and trajectories_done.

    Raises `SceneError` for arguments that are not valid, and for a scene without thermal motion;
    `ResultError` if `out` exists and is not to be resumed, belongs to another ensemble, or cannot
    be written (what was written stays); `IntegrationError` if a force is not finite.
    """
    scene = checked_scene(scene)
    if duration is not None:
        scene = scene.replace(simulation={"duration": duration})
    check_ensemble(
        scene, trajectories, seed=seed, out=out, statistics=statistics, skip=skip,
        scheduler=scheduler, workers=workers,
    )  # fmt: skip
    problem = bound_once(scene, forces)
    if problem.others and scheduler is not None:
        raise SceneError("forces: cannot be combined with scheduler; omit the scheduler")
    if problem.others and out is not None and not origins_of(problem.others):
        raise SceneError(
            "forces: cannot be combined with out unless named by files, as 'handles.py:spring'; "
            "omit out, and save the result"
        )
    bound = walk(problem, seed)
    bound.warn_of_bias()
    needed = 8 * len(bound.columns) * trajectories * len(bound.times)
    if out is None and not statistics and needed > _MEMORY:
        raise SceneError(
            f"out: missing; {trajectories} trajectories take {needed / 1e9:.3g} GB, too much to "
            "hold in memory: name a Zarr store, or gather statistics"
        )
    skipped = samples_skipped(scene, skip) if statistics else None
    job = Job.of(bound, trajectories, skipped, None if out is None else Path(out).absolute())
    run = functools.partial(_run, job, bound, scheduler, workers, progress)
    if job.out is None:
        return run()
    with at_work(job, bound, resume):
        return run()


def _run(
    job: Job,
    bound: Walk,
    scheduler: str | Client | None,
    workers: int | None,
    progress: Callable[[float], None] | None,
) -> xr.Dataset:
    """Compute what is missing."""
    if scheduler is None:
        opened = threads(job, bound, workers or numba.config.NUMBA_NUM_THREADS)
    else:
        opened = cluster(job, scheduler)
    with opened as pool:
        output = Trajectories(job, bound) if job.skipped is None else Joined(job, bound)
        queue = deque(output.missing)
        done = 1 - sum(job.share(index) for index in queue)
        flying: dict[Future[Gathered | None], int] = {}
        #: of the blocks in flight; they come as they end, for to look at all takes the longer the
        #: more there are
        parts: dict[int, float] = {}
        ended: SimpleQueue[Future[Gathered | None]] = SimpleQueue()
        width, looked = pool.width(), time.monotonic()
        try:
            while queue or flying:
                if time.monotonic() > looked + _LOOK:
                    width, looked = pool.width(), time.monotonic()
                while queue and len(flying) + output.waiting < _AHEAD * width:
                    index = queue.popleft()
                    parts[index] = 0.0
                    future = pool.submit(index, output.arrays, parts)
                    flying[future] = index
                    future.add_done_callback(ended.put)
                with contextlib.suppress(Empty):
                    future = ended.get(timeout=_TICK)
                    index, gathered = flying[future], future.result()
                    if gathered is None:
                        raise ResultError(f"{job.out}: a worker does not find {job.part}")
                    output.take(index, gathered)
                    del flying[future], parts[index]
                    done += job.share(index)
                if progress:
                    progress(done + sum(parts.values()))
        except KeyboardInterrupt:
            pool.stop()
            stopped, others = wait(flying, pool.patience)
            for future in others:
                future.cancel()
            failed = None
            for future in sorted(stopped, key=flying.__getitem__):
                if future.cancelled():
                    continue
                if error := future.exception():
                    failed = failed or error
                else:
                    output.take(flying[future], future.result())
            reached = output.finish(complete=False)
            if failed:
                raise failed from None
            return reached
        except BaseException:
            pool.stop()
            raise
        return output.finish(complete=True)
