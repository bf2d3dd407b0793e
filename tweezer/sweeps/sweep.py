"""Many scenes that differ in a few keys."""

from __future__ import annotations

import contextlib
import functools
import json
from collections.abc import Callable, Generator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tweezer.ensembles.scheduler import client_of
from tweezer.forces.force import Force
from tweezer.scene import Scene, SceneLike, checked_scene
from tweezer.scene.arguments import in_si
from tweezer.sweeps.cases import Cases, cases_of
from tweezer.sweeps.journal import Journal, check_same, part_of
from tweezer.sweeps.pool import Done, cluster, cores, here, processes, tasks_of
from tweezer.sweeps.quantities import USED, Asked, asked_of
from tweezer.sweeps.result import dataset_of, read, write
from tweezer.values.beside import held, telling
from tweezer.values.errors import ResultError, SceneError
from tweezer.values.units import QuantityLike
from tweezer.values.version import made_by, versions

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr
    from distributed import Client

#: Numbers and values of cases in the order in which they finish
Results = Generator[Done, None, None]
#: Function that computes cases: `here`, `processes` or `cluster`
Computing = Callable[..., Results]

#: Version of the file format; files of another version cannot be resumed
FORMAT = "2"
#: Largest number of processes
_MOST = 10_000


def sweep(
    scene: SceneLike,
    over: Mapping[str, Any] | pd.DataFrame | xr.Dataset | None = None,
    of: str = "trap",
    out: str | Path | None = None,
    *,
    cases: str | Path | Mapping[str, Any] | pd.DataFrame | xr.Dataset | None = None,
    trajectories: int | None = None,
    seed: int | None = None,
    skip: QuantityLike | None = None,
    workers: int | None = None,
    scheduler: str | Client | None = None,
    resume: bool = False,
    forces: Sequence[Force | str] = (),
    progress: Callable[[float], None] | None = None,
) -> xr.Dataset:
    """Compute a trap, run, ensemble or calibration for many scenes that differ in a few keys.

    The numbers do not depend on workers and interruptions.

    Parameters
    ----------
    scene : Scene, str or mapping
        Scene that all cases share.
    over : mapping, DataFrame or Dataset, optional
        Values by key, such as {"bead.diameter": ["0.5 um", 1e-6]}, in SI or as text with a unit.
        Every combination of them is a case. A table (pandas, xarray) is used as `cases`.
    of : str
        "trap" (`tweezer.characterise`), "run" (`tweezer.simulate` and `summarise`), "ensemble" (the
        statistics of `tweezer.ensemble`) or "calibrate" (`tweezer.calibrate` for a run).
    out : str or Path, optional
        Zarr store to write. Default: the result is in memory.
    cases : table or path, optional
        Table with a column for each key and a row for each case, or the name of such a CSV file,
        with a unit in the heading, "beam.power [mW]", or in the cells. With `over` each row is
        computed for each combination.
    trajectories : int, optional
        Number of trajectories of "ensemble". Default: 100.
    seed : int, optional
        Seed of the thermal motion, the same in every case, except for "trap". Default: 0.
    skip : float or str, optional
        Time to omit at the beginning in "ensemble" and "calibrate", s.
    workers : int, optional
        Processes on this machine; 1 is this process. Default: one for each core.
    scheduler : str or distributed.Client, optional
        Dask scheduler, whose workers replace the local processes.
    resume : bool, optional
        Continue the sweep at `out`, if it exists.
    forces : sequence of Force or str, optional
        Your own forces, in addition to each scene's (`tweezer.forces`). An object requires this
        process and a result in memory. A force that is named by its Python file,
        "handles.py:spring", may be computed by other processes and stored at `out`.
    progress : callable, optional
        Called with the finished fraction.

    Returns
    -------
    xarray.Dataset
        Dataset over the swept keys, in SI units (over `case`, for a table). For each quantity there
        is a variable with the suffix `_error`, which the attribute `ancillary_variables` names.

        * trap: equilibrium, stiffness and corner frequency (axis), escape force and escape energy
          in k_B T (direction), lifetime (infinite above 1e20 s), in a gas least pressure, recoil
          heating and temperatures (axis), and `trapped`, whether there is a
          stable equilibrium at least 1 k_B T deep. The outcome is "held", "shallow" if the easiest
          straight escape requires less than 10 k_B T, or "not held" if it requires less than
          1 k_B T. The errors are those of the optical force in its theory; `caveat` describes the
          deviation of ray optics in words.
        * run: time of its outcome, its end, overshoot and closest approach, largest force and
          Reynolds number
        * ensemble: fraction `lost`, mean and variance of the position (axis)
        * calibrate: stiffness, corner frequency and diffusion (axis)

        `outcome` is the outcome of each case. A case that "failed" has a `reason`, and NaN for
        numbers. The attribute `status` is "complete", or "interrupted" if the dataset contains only
        the cases that were finished before Ctrl-C. An interrupted sweep can be resumed.

    Raises
    ------
    SceneError
        For invalid keys and values, for arguments that this kind of sweep does not use, and if no
        case is a valid scene.
    ResultError
        If `out` exists and is not to be resumed, belongs to another sweep, or cannot be written.

    Examples
    --------
    >>> over = {"bead.diameter": ["0.8 um", "1 um"]}
    >>> traps = tweezer.sweep("silica-1um", over, workers=1)
    >>> traps.outcome.values.tolist()
    ['held', 'held']
    """
    scene = checked_scene(scene)
    grid = cases_of(over, cases)
    skipped = None if skip is None else in_si("skip", skip, "s", 0.0)
    asked = asked_of(scene, of, forces, trajectories=trajectories, seed=seed, skip=skipped)
    count = _workers(_workers_of(asked, workers, scheduler, out), scheduler)
    _check_some_case(asked, grid)
    if out is not None and not isinstance(out, str | Path):
        raise SceneError(f"out = {out!r}: must be the name of a Zarr store")
    path = None if out is None else Path(out).absolute()
    if path is not None and path.suffix != ".zarr":
        raise ResultError(f"{out}: must end in .zarr")
    attributes = _attributes(asked, grid, scene)
    with contextlib.ExitStack() as stack:
        if path is not None:
            stack.enter_context(held(path))
            if path.exists():
                return _finished(path, attributes, resume=resume)
        computing: Computing = here
        if scheduler is not None:
            client = stack.enter_context(client_of(scheduler))
            count = max(1, sum(client.nthreads().values()))
            computing = functools.partial(cluster, client=client)
        elif count > 1:
            computing = functools.partial(processes, workers=count)
        journal = Journal(path, attributes, resume=resume)
        try:
            with contextlib.suppress(KeyboardInterrupt):
                left = set(range(grid.count)) - journal.done.keys()
                results = computing(asked, tasks_of(grid, of, left, count))
                _record(results, journal, grid.count, progress)
            dataset = dataset_of(grid, of, journal.done, attributes)
            if dataset.attrs["status"] == "complete" and path is not None:
                try:
                    with telling(path):
                        write(dataset, journal.new, path)
                except KeyboardInterrupt:
                    return dataset.assign_attrs(status="interrupted")
        finally:
            journal.close()
        if dataset.attrs["status"] == "complete":
            journal.remove()
    return dataset


def _record(
    results: Results, journal: Journal, count: int, progress: Callable[[float], None] | None
) -> None:
    """Record each case in the journal when it is finished, and report the finished fraction.

    `count` is the number of all cases. An interruption closes `results`, which stops the workers.
    """
    with contextlib.closing(results):
        for case, values in results:
            journal.take(case, values)
            if progress:
                progress(len(journal.done) / count)


def _attributes(asked: Asked, grid: Cases, scene: Scene) -> dict[str, str]:
    """Return the attributes of the result, by which a sweep to be resumed is recognised."""
    used = {
        "seed": str(asked.seed),
        "trajectories": str(asked.trajectories),
        "skip": f"{asked.skip!r} s",
    }
    return {
        "title": scene.title,
        "of": asked.of,
        "over": json.dumps(grid.describe()),
        **{name: used[name] for name in USED[asked.of]},
        "scene": asked.scene,
        **({"forces_from": asked.forces_from} if asked.forces_from else {}),
        "format": FORMAT,
        **versions(),
        **made_by("sweep", dated=False),
    }


def _finished(path: Path, attributes: Mapping[str, str], *, resume: bool) -> xr.Dataset:
    """Return the finished sweep at `path`, and remove its journal.

    Raises `ResultError` unless it is the same sweep and `resume` is set.
    """
    if not resume:
        raise ResultError(f"{path}: already exists; resume it or choose another file")
    dataset = read(path)
    check_same(path, dataset.attrs, attributes)
    part_of(path).remove()
    return dataset


def _check_some_case(asked: Asked, grid: Cases) -> None:
    """Raise the `SceneError` of the first case if no case of the sweep is valid."""
    first = None
    for case in range(grid.count):
        try:
            asked.check(asked.case(grid.settings(case)))
        except SceneError as error:
            first = first or error
        else:
            return
    if first:
        raise first


def _workers_of(asked: Asked, workers: int | None, scheduler: object, out: object) -> int | None:
    """Return the given number of workers, or 1 with forces that cannot be sent to a process.

    Raises `SceneError` if such forces are combined with other workers, a scheduler or an output.
    """
    if not asked.forces or asked.forces_from:
        return workers
    for name, given in (("workers", workers if workers != 1 else None), ("scheduler", scheduler),
                        ("out", out)):  # fmt: skip
        if given is not None:
            raise SceneError(
                f"forces: can be combined with {name} only if each is given as a file and a name, "
                f"such as 'handles.py:spring'; name them so, or omit {name}"
            )
    return 1


def _workers(workers: int | None, scheduler: object) -> int:
    """Return the number of processes: as given, or one per core; raises `SceneError`."""
    if workers is None:
        return cores()
    if scheduler is not None:
        raise SceneError(
            f"workers = {workers}: cannot be combined with a scheduler; omit one of them"
        )
    if isinstance(workers, bool) or not isinstance(workers, int) or not 1 <= workers <= _MOST:
        raise SceneError(f"workers = {workers!r}: must be a whole number from 1 to {_MOST}")
    return workers
