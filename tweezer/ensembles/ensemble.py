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
import xarray as xr

from tweezer.dynamics.walk import Walk
from tweezer.ensembles.job import Job
from tweezer.ensembles.motion import Moving, moving
from tweezer.ensembles.store import (
    Gathered,
    Joined,
    Trajectories,
    at_work,
)
from tweezer.ensembles.workers import cluster, threads
from tweezer.forces.force import Force
from tweezer.forces.named import origins_of
from tweezer.scene import SceneLike, checked_scene
from tweezer.scene.arguments import check_ensemble, samples_skipped
from tweezer.values.errors import ResultError, SceneError
from tweezer.values.units import QuantityLike

if TYPE_CHECKING:
    from distributed import Client


#: Number of blocks submitted ahead of the results, for each worker
_AHEAD = 4
#: Time between reports of progress, s
_TICK = 0.2
#: Time between counts of the workers of a scheduler, s
_LOOK = 2.0
#: Largest size of trajectories that are returned in memory, bytes
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

    The numbers do not depend on workers or interruptions. For trajectories they do not depend on
    blocks and windows either.

    Parameters
    ----------
    scene : Scene, str or mapping
        Scene with thermal motion.
    trajectories : int
        Number of trajectories.
    duration : float or str, optional
        Duration, s, e.g. "20 ms". Default: the scene's.
    seed : int, optional
        Seed of the random numbers. Trajectory i does not depend on the number of trajectories.
    out : str or Path, optional
        File to write: a Zarr store of trajectories, or a NetCDF file of statistics. Default: the
        result is in memory.
    statistics : bool, optional
        Compute statistics and store no trajectory.
    skip : float or str, optional
        Time after the release that is omitted from all statistics except the moments over
        trajectories, s.
    scheduler : str or distributed.Client, optional
        Dask scheduler, in place of `workers`. Requires `out`, in a file system that its workers
        share.
    workers : int, optional
        Threads on this machine. Default: one for each core.
    resume : bool, optional
        Continue the ensemble at `out`, if it exists. A missing or truncated chunk is computed
        again. A chunk with wrong bytes fails its checksum when it is read.
    forces : sequence of Force or str, optional
        Your own forces, in addition to the scene's (`tweezer.forces`). With `out` name each by its
        Python file, "handles.py:spring". An ensemble can be resumed only with an unchanged file.
    progress : callable, optional
        Called with the finished fraction.

    Returns
    -------
    xarray.Dataset
        Trajectories, which are read from the store when they are used (`xarray.open_zarr` opens
        it), or statistics. Every chunk has a checksum.

        The trajectories are NaN after a bead is lost:

        * position (trajectory, time, axis): position relative to the focus, m; for several beads
          (trajectory, time, bead, axis), relative to the origin. A trajectory ends with the loss
          of its first bead
        * velocity: m/s, if the model has one
        * orientation (trajectory, time, euler_parameter): if the bead rotates
        * angular_velocity (trajectory, time, body_axis): rad/s, if the rotation has inertia
        * lost_time (trajectory): s; infinite for a bead that is never lost, and NaN for a
          trajectory that is not yet computed
        * seen (trajectory, frame, seen_axis): position in the frames of a camera, m; NaN from the
          frame in which a bead was lost
        * signal (trajectory, time, channel): signals x, y and z of a detector with its shot noise,
          W; NaN after a bead is lost

        The statistics describe the motion without a camera:

        * position_..., velocity_..., angular_velocity_...: mean, variance, skewness and excess
          kurtosis over the trajectories at up to 10,000 times
        * stationary_mean, stationary_variance (axis): moments of the positions after `skip`
        * counts, density (bin, axis): histogram of the positions after `skip`
        * msd (axis, lag): mean-square displacement; not for the method "one-call", whose
          displacements from step to step differ from the motion's
        * psd (axis, frequency): one-sided spectrum of windows of at most 2^14 samples (Bartlett's
          method, mean removed; instantaneous positions, therefore aliased); not for "one-call"
        * X_error: standard error of X. It is computed over the trajectories, and for the density
          over blocks of trajectories. For stationary statistics, msd and psd it is computed over
          windows, which are independent if they are much longer than the relaxation time. The error
          is NaN if there are too few trajectories, windows or blocks.

        Samples after a loss are excluded. Windows with a loss are excluded from msd and psd. Both
        are counted. Skewness and kurtosis of equal values are NaN.

        The attributes contain the scene, the seed, the versions, the step and the reason for it.
        The returned dataset also has `status`, "complete" or "interrupted" (Ctrl-C), and
        `trajectories_done`.

    Raises
    ------
    SceneError
        For arguments that are not valid, and for a scene without thermal motion.
    ResultError
        If `out` exists and is not to be resumed, belongs to another ensemble, or cannot be written.
        The results written before remain.
    IntegrationError
        If a force is not finite.

    Examples
    --------
    >>> scene = tweezer.load_scene("silica-1um").replace(forces={"brownian": True})
    >>> beads = tweezer.ensemble(scene, 3, duration="1 ms", seed=1)
    >>> dict(beads.position.sizes)
    {'trajectory': 3, 'time': 2001, 'axis': 3}
    """
    scene = checked_scene(scene, several=True)
    if duration is not None:
        scene = scene.replace(simulation={"duration": duration})
    check_ensemble(
        scene, trajectories, seed=seed, out=out, statistics=statistics, skip=skip,
        scheduler=scheduler, workers=workers,
    )  # fmt: skip
    bound = moving(scene, seed, forces)
    if bound.others and scheduler is not None:
        raise SceneError("forces: cannot be combined with scheduler; omit the scheduler")
    if bound.others and out is not None and not origins_of(bound.others):
        raise SceneError(
            "forces: cannot be combined with out unless named by files, as 'handles.py:spring'; "
            "omit out, and save the result"
        )
    if isinstance(bound, Walk):
        bound.warn_of_bias()
    needed = 8 * bound.shown.size * trajectories * len(bound.times)
    if out is None and not statistics and needed > _MEMORY:
        raise SceneError(
            f"out: missing; {trajectories} trajectories take {needed / 1e9:.3g} GB, too much "
            "for the memory; name a Zarr store, or compute statistics"
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
    bound: Moving,
    scheduler: str | Client | None,
    workers: int | None,
    progress: Callable[[float], None] | None,
) -> xr.Dataset:
    """Compute the missing blocks of an ensemble, and return the result.

    A few blocks per worker are submitted ahead, and recorded when they end. On Ctrl-C the workers
    stop, and the result contains the finished blocks. `scheduler`, `workers` and `progress` are the
    arguments of `ensemble`.
    """
    if scheduler is None:
        opened = threads(job, bound, workers or numba.config.NUMBA_NUM_THREADS)
    else:
        opened = cluster(job, scheduler)
    with opened as pool:
        output = Trajectories(job, bound) if job.skipped is None else Joined(job, bound)
        queue = deque(output.missing)
        done = 1 - sum(job.share(index) for index in queue)
        flying: dict[Future[Gathered | None], int] = {}
        #: finished fraction of each block in flight. Finished blocks arrive through the queue
        #: `ended`, because polling all futures would take longer the more there are
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
                        raise ResultError(f"{job.out}: a worker cannot find {job.part}")
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
