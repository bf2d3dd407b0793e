"""Many scenes that differ in a few keys."""

from __future__ import annotations

import contextlib
import functools
import json
from collections.abc import Callable, Generator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tweezer.arguments import in_si
from tweezer.beside import held, telling
from tweezer.ensembles.scheduler import client_of
from tweezer.errors import ResultError, SceneError
from tweezer.forces.force import Force
from tweezer.scene import Scene, SceneLike, checked_scene
from tweezer.sweeps.cases import Cases, cases_of
from tweezer.sweeps.journal import Journal, check_same, part_of
from tweezer.sweeps.pool import Done, cluster, cores, here, processes, tasks_of
from tweezer.sweeps.quantities import USED, Asked, asked_of
from tweezer.sweeps.result import dataset_of, read, write
from tweezer.units import QuantityLike
from tweezer.version import made_by, versions

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr
    from distributed import Client

#: Cases as they are finished
Results = Generator[Done, None, None]
#: What computes the cases
Computing = Callable[..., Results]

#: Version of the files; those of another version cannot be resumed
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
    """Compute the same of many scenes that differ in a few keys.

    over: values by key, such as {"bead.diameter": ["0.5 um", 1e-6]}, each in SI or text with a
    unit; every combination of them is a case. A table (pandas, xarray) is taken as `cases`. cases:
    a table with a column for each key and a row for each case, or the name of such a CSV file, with
    a unit in the heading, "beam.power [mW]", or in the cells; beside `over` each row is computed
    for each combination. of: "trap" (`tweezer.characterise`), "run" (`tweezer.simulate` and
    `summarise`), "ensemble" (the statistics of `tweezer.ensemble`, of so many `trajectories`, 100
    if not given) or "calibrate" (`tweezer.calibrate` of a run). seed: of thermal motion, the same
    in every case; 0 if not given; not of "trap". skip: s or text, the time left out at the
    beginning by "ensemble" and "calibrate".

    out: the Zarr store to write; in memory if not given. workers: processes of this machine, by
    default one for each core; 1 is this process. scheduler: address of a Dask scheduler, or a
    `distributed.Client`, whose workers compute in their place. resume: continue the sweep at `out`,
    if there is one. forces: of your own, beside those of each scene (`tweezer.forces`), computed by
    this process alone and in memory; one that is named by its Python file, "handles.py:spring",
    can also be computed by other processes and stored at `out`. progress: called with the finished
    part.

    Returns a dataset over the swept keys, in SI with their units (over `case`, for a table). Each
    quantity has the variable `_error` beside it, which its attribute `ancillary_variables` names:
    of a trap the equilibrium, stiffness and corner frequency (axis), escape force and escape energy
    in k_B T (direction), the lifetime, infinite above 1e20 s, and whether there is a stable
    equilibrium (`trapped`), of which the outcome says "held", or "shallow" if the easiest straight
    way out takes less than 10 k_B T; of a run the time of its outcome, its end, overshoot and
    closest approach, the largest force and Reynolds number; of an ensemble the part that is
    `lost`, and the mean and variance of the position (axis); of a calibration stiffness, corner
    frequency and diffusion (axis). Errors of a trap are those of the force of the light, by its
    theory: `caveat` says in words what ray optics is worth. `outcome` says what becomes of each
    case; one that "failed" has its `reason`, and NaN for numbers. The attribute `status` is
    "complete", or "interrupted" of a dataset with the cases reached before Ctrl-C, which can be
    resumed.

    The numbers do not depend on workers and interruptions.

    Raises `SceneError` for keys and values that are none, for arguments that this kind of sweep
    does not use, and if no case is a valid scene; `ResultError` if `out` exists and is not to be
    resumed, is of another sweep, or cannot be written.
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
    """Take each case as it comes; an interruption ends those that compute."""
    with contextlib.closing(results):
        for case, values in results:
            journal.take(case, values)
            if progress:
                progress(len(journal.done) / count)


def _attributes(asked: Asked, grid: Cases, scene: Scene) -> dict[str, str]:
    """What the result says of itself, and what it is known by when it is resumed."""
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
    """The sweep that is there already. Raises `ResultError` unless it is this one."""
    if not resume:
        raise ResultError(f"{path}: already exists; resume it or choose another file")
    dataset = read(path)
    check_same(path, dataset.attrs, attributes)
    part_of(path).remove()
    return dataset


def _check_some_case(asked: Asked, grid: Cases) -> None:
    """Raises the `SceneError` of the first case if no case is valid."""
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
    """Return the number of workers: 1 with forces that no other process can read."""
    if not asked.forces or asked.forces_from:
        return workers
    for name, given in (("workers", workers if workers != 1 else None), ("scheduler", scheduler),
                        ("out", out)):  # fmt: skip
        if given is not None:
            raise SceneError(
                f"forces: cannot be combined with {name} unless named by files, as "
                f"'handles.py:spring'; omit {name}"
            )
    return 1


def _workers(workers: int | None, scheduler: object) -> int:
    if workers is None:
        return cores()
    if scheduler is not None:
        raise SceneError(f"workers = {workers}: not with a scheduler, which has its own")
    if isinstance(workers, bool) or not isinstance(workers, int) or not 1 <= workers <= _MOST:
        raise SceneError(f"workers = {workers!r}: must be a whole number from 1 to {_MOST}")
    return workers
