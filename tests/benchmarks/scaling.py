"""What an ensemble of 10^15 steps takes on more machines than one: costs measured, then modelled.

Measured here: a block of an ensemble in a worker, what the process in charge does for each, a task
of the scheduler, a file. Steps a second are those of the committed `brownian` benchmark. The model
follows every block from its core through the file system, one queue for all, to the process in
charge, another; ensembles on one and two Dask workers check it. What no machine here can tell is in
`ASSUMED`. The results are plain data for JSON.
"""

from __future__ import annotations

import concurrent.futures
import contextlib
import heapq
import itertools
import math
import os
import statistics
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import tweezer
from tests.benchmarks import pages
from tests.benchmarks.brownian import SEED, _ensemble_scene, trap_of_scene
from tests.benchmarks.force import _to_four_digits
from tests.benchmarks.timing import dask_clients, machine
from tweezer.dynamics.walk import Walk, walk
from tweezer.ensembles import workers
from tweezer.ensembles.job import Job, plan_of
from tweezer.ensembles.statistics import Statistics
from tweezer.ensembles.store import Joined, Trajectories, at_work, keep
from tweezer.scene import Scene

Results = dict[str, Any]

BEADS, STEPS = 10**6, 10**9
MODELS = (
    ("full", "heun"), ("full", "one-call"), ("overdamped", "heun"), ("overdamped", "one-call"),
    ("first-order", "heun"), ("full", "harmonic"),
)  # fmt: skip
#: number of cores: this machine, and the two of the plan
CORES = (2, 100, 10_000)
LINE = (1, 10, 100, 1000, 3000, 10_000, 20_000, 50_000, 100_000)

#: not measured: what a cluster may have
ASSUMED = {
    "bandwidth_B_per_s": 50e9,
    "file_operations_per_s": 20e3,
    "scatter": 0.05,
}
#: of a chunk or checkpoint: make, write, close, rename; a checkpoint's folder, made and removed
_OPERATIONS_CHUNK, _OPERATIONS_CHECKPOINT = 4, 6
#: parts in which the model lets a block write
_PARTS = 4


class Kind(NamedTuple):
    """What is kept of how many beads followed how long."""

    label: str
    samples: int
    """of each bead"""
    gathered: bool
    """statistics, or trajectories"""
    beads: int = BEADS
    steps: int = STEPS


STATISTICS = Kind("statistics of 10^4 samples", 10_000, gathered=True)
KINDS = (
    STATISTICS,
    Kind("trajectories of 10^4 samples", 10_000, gathered=False),
    Kind("trajectories of 10^6 samples", 10**6, gathered=False),
    Kind("trajectories of 5·10^6 samples", 5 * 10**6, gathered=False),
    Kind("statistics, 10^9 beads of 10^6 steps", 100, gathered=True, beads=10**9, steps=10**6),
)


class Effort(NamedTuple):
    """How much is measured."""

    repeats: int
    trajectories: int
    """of the ensembles on Dask workers"""
    samples: tuple[int, int]
    """of each, in short and in long blocks"""
    tasks: int
    files: tuple[int, ...]
    """bytes"""
    workers: tuple[int, ...]
    """of Dask"""
    line: tuple[int, ...]
    """numbers of cores"""


FULL = Effort(
    repeats=3, trajectories=1024, samples=(4, 400), tasks=400,
    files=(30_000, 300_000, 3_000_000, 25_000_000), workers=(1, 2),
    line=LINE,
)  # fmt: skip
QUICK = Effort(
    repeats=1, trajectories=128, samples=(4, 40), tasks=20, files=(30_000, 3_000_000),
    workers=(1,), line=(100,),
)  # fmt: skip


class Work(NamedTuple):
    """Blocks, and what each of them takes."""

    blocks: int
    block_s: float
    """in its core"""
    stored_s: float
    """of the file system's time"""
    client_s: float
    """of the process in charge"""


def makespan(work: Work, cores: int, *, start_s: float, scatter: float) -> float:
    """Time until the last block is taken in, s.

    Each core computes a block in parts, each of which the file system writes in its turn; a block
    complete, the process in charge takes it, in its turn; that some blocks a core are submitted
    ahead keeps the core from waiting for that. The blocks' times are lognormal about `block_s`.
    """
    rng = np.random.default_rng(SEED)
    parts = work.block_s * np.exp(scatter * rng.standard_normal(work.blocks)) / _PARTS
    times = parts.tolist()
    stored = taken = start_s
    begun = min(cores, work.blocks)
    ends = [(start_s + times[index], index, 1) for index in range(begun)]
    heapq.heapify(ends)
    while ends:
        end, index, part = heapq.heappop(ends)
        stored = max(stored, end) + work.stored_s / _PARTS
        if part < _PARTS:
            heapq.heappush(ends, (stored + times[index], index, part + 1))
            continue
        taken = max(taken, stored) + work.client_s
        if begun < work.blocks:
            heapq.heappush(ends, (stored + times[begun], begun, 1))
            begun += 1
    return taken


def measure(*, quick: bool, say: Callable[[str], object]) -> Results:
    """The whole benchmark; `say` is told what is being measured."""
    effort = QUICK if quick else FULL
    scene = _ensemble_scene(trap_of_scene(), effort.samples[0])
    brownian = pages.committed("brownian")
    results: Results = {
        "machine": machine(), "quick": quick, "beads": BEADS, "steps": STEPS, "assumed": ASSUMED,
        "steps_per_s": {
            f"{each['model']}, {each['method']}": each["steps_per_s"]
            for each in brownian["rates"]
            if (each["model"], each["method"]) in MODELS
        },
        "start_s": sum(brownian["fresh_process"]["empty_cache"][f"{of}_s"]
                       for of in ("import", "bind", "first_step")),
        "step_s": walk(scene).step,
    }  # fmt: skip
    say("beads of a block")
    results["beads_of_a_block"] = _by_beads(scene, effort)
    say("files")
    results["files"] = [_file(size, effort) for size in effort.files]
    say("blocks")
    results["blocks"] = {}
    for gathered, samples in itertools.product((True, False), effort.samples):
        named = _named(gathered=gathered, short=samples == effort.samples[0])
        results["blocks"][named] = _block(scene, gathered, samples, effort)
    say("Dask workers")
    results |= _on_workers(scene, results["blocks"], effort)
    results["load_per_core"] = os.getloadavg()[0] / (os.cpu_count() or 1)
    say("model")
    results["bytes_per_number"] = _bytes_per_number(scene)
    results["plan"] = [_planned(results, kind, effort.line) for kind in KINDS]
    results["models"] = _models(results)
    rounded: Results = _to_four_digits(results)
    return rounded


def _named(*, gathered: bool, short: bool) -> str:
    return f"{'statistics' if gathered else 'trajectories'}, {'short' if short else 'long'} blocks"


def _least(run: Callable[[], object], repeats: int) -> float:
    """Least time of a call, s."""
    times = []
    for _ in range(repeats):
        began = time.perf_counter()
        run()
        times.append(time.perf_counter() - began)
    return min(times)


def _by_beads(scene: Scene, effort: Effort) -> list[Results]:
    """Steps a second of one core, by how many beads it takes along together."""
    bound = walk(scene, SEED)
    found = []
    for beads in (1, 4, 16, 64):
        who = np.arange(beads)
        states, out = bound.start(who), np.empty((beads, 1024 // beads, len(bound.columns)))
        steps = out.shape[0] * out.shape[1] * bound.per_sample
        run = _advancing(bound, states, who, out)
        run()
        found.append({"beads": beads, "steps_per_s": steps / _least(run, 5 * effort.repeats)})
    return found


def _advancing(bound: Walk, states: Any, who: Any, out: Any) -> Callable[[], None]:
    return lambda: bound.advance(states, who, 0, out)


def _file(size: int, effort: Effort) -> Results:
    """A checkpoint of so many bytes, written whole."""
    array = np.zeros(size // 8)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "0.npz"
        taken = _least(lambda: keep(path, {"states": array}), 5 * effort.repeats)
    return {"bytes": size, "written_s": taken}


@contextlib.contextmanager
def _begun(scene: Scene, gathered: bool, samples: int, beads: int) -> Iterator[tuple[Job, Walk]]:
    """An ensemble begun in a folder of its own."""
    scene = scene.replace(
        simulation={
            "samples": samples + 1,
            "duration": scene.simulation.duration * samples / (scene.simulation.samples - 1),
        }
    )
    bound = walk(scene, SEED)
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / ("a.nc" if gathered else "a.zarr")
        job = Job.of(bound, beads, 0 if gathered else None, out)
        with at_work(job, bound, resume=False):
            yield job, bound


def _block(scene: Scene, gathered: bool, samples: int, effort: Effort) -> Results:
    """A block as a worker computes it, and what the process in charge does for it, s.

    Medians over the blocks of an ensemble, the least of several. And what an ensemble takes once:
    one of a single block, less that block.
    """
    there, here = [], []

    def one() -> None:
        with tempfile.TemporaryDirectory() as folder:
            out = Path(folder) / ("a.nc" if gathered else "a.zarr")
            tweezer.ensemble(
                scene.replace(simulation={"samples": samples + 1}), 64, seed=SEED, workers=1,
                statistics=gathered, out=out,
                duration=scene.simulation.duration * samples / (scene.simulation.samples - 1),
            )  # fmt: skip

    one()
    whole = _least(one, effort.repeats)
    for _ in range(effort.repeats):
        with _begun(scene, gathered, samples, effort.trajectories) as (job, bound):
            output = Joined(job, bound) if gathered else Trajectories(job, bound)
            run = job.part / "0.run"
            run.touch()
            taken: dict[str, list[float]] = {"there": [], "here": []}
            for index in range(job.blocks):
                began = time.perf_counter()
                workers._block_there(job, run, index)
                ended = time.perf_counter()
                output.take(index, {})
                taken["there"].append(ended - began)
                taken["here"].append(time.perf_counter() - ended)
            there.append(statistics.median(taken["there"]))
            here.append(statistics.mean(taken["here"]))
    return {
        "gathered": gathered, "samples": samples, "beads": job.block, "number": job.blocks,
        "steps": job.block * samples * bound.per_sample,
        "worker_s": min(there), "client_s": min(here),
        "once_s": max(0.0, whole - min(there) - min(here)),
    }  # fmt: skip


def _on_workers(scene: Scene, blocks: dict[str, Results], effort: Effort) -> Results:
    """A task that does nothing; and ensembles on so many workers, as measured and modelled.

    The process in charge, the scheduler and the workers share this machine's cores: no time is
    less than the work of all over the cores.
    """
    found: Results = {"task_s": math.inf, "checks": []}
    with tempfile.TemporaryDirectory() as folder, dask_clients(effort.workers) as clients:
        executor = clients[1].get_executor(pure=False)

        def tasks() -> None:
            concurrent.futures.wait([executor.submit(abs, i) for i in range(effort.tasks)])

        found["task_s"] = _least(tasks, effort.repeats) / effort.tasks
        number = itertools.count()
        for name, block in blocks.items():
            for count, client in clients.items():

                def run(client: Any = client, block: Results = block) -> None:
                    suffix = ".nc" if block["gathered"] else ".zarr"
                    tweezer.ensemble(
                        scene.replace(simulation={"samples": block["samples"] + 1}),
                        effort.trajectories, seed=SEED, statistics=block["gathered"],
                        out=Path(folder) / f"{next(number)}{suffix}", scheduler=client,
                        duration=scene.simulation.duration * block["samples"] / effort.samples[0],
                    )  # fmt: skip

                run()
                client_s = block["client_s"] + found["task_s"]
                work = Work(block["number"], block["worker_s"], 0.0, client_s)
                of_all = block["number"] * (block["worker_s"] + client_s) / (os.cpu_count() or 1)
                modelled = max(of_all, makespan(work, count, start_s=0.0, scatter=0.0))
                modelled += block["once_s"]
                found["checks"].append(
                    {"blocks": name, "workers": count, "modelled_s": modelled,
                     "measured_s": _least(run, effort.repeats)}
                )  # fmt: skip
    return found


def _bytes_per_number(scene: Scene) -> float:
    """Of a trajectory in its store, checksums and all."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "a.zarr"
        runs = tweezer.ensemble(scene.replace(simulation={"samples": 1001}), 64, out=out)
        numbers = sum(runs[name].size for name in ("position", "velocity"))
        size = sum(
            path.stat().st_size
            for name in ("position", "velocity")
            for path in (out / name).rglob("*")
            if path.is_file()
        )
    return size / numbers


def _geometry(results: Results, kind: Kind) -> Results:
    """How an ensemble of a kind is divided, and what it writes; model "full"."""
    scene = trap_of_scene().scene.replace(
        simulation={
            "model": "full", "method": "heun", "step": results["step_s"],
            "samples": kind.samples + 1, "duration": results["step_s"] * kind.steps,
        }
    )  # fmt: skip
    bound = walk(scene, SEED)
    job = Job.of(bound, kind.beads, 0 if kind.gathered else None, None)
    windows = len(job.cuts) - 1
    steps = job.block * kind.steps
    kept = windows * (1 + int(steps / windows / workers._KEPT_STEPS))
    size = 0
    if kind.gathered:
        size = sum(a.nbytes for a in Statistics(plan_of(bound, 0)).arrays().values())
    partial = 8 * job.block * max(b - a for a, b in itertools.pairwise(job.cuts)) / 2
    columns = 3 if kind.gathered else len(bound.columns)
    trajectory = 0.0 if kind.gathered else results["bytes_per_number"] * columns * kind.samples
    chunks = 0 if kind.gathered else 2 * windows + 1
    return {
        "blocks": job.blocks, "block_beads": job.block, "windows": windows,
        "checkpoints": kept, "checkpoint_bytes": size, "chunks": chunks,
        "stored_bytes": job.block * trajectory,
        "written_bytes": job.block * trajectory + kept * size
        + (kept - windows) * partial * columns,
        "file_operations": _OPERATIONS_CHUNK * chunks + _OPERATIONS_CHECKPOINT * kept,
    }  # fmt: skip


def _work(results: Results, geometry: Results, kind: Kind, steps_per_s: float) -> Work:
    """What its blocks take."""
    name = _named(gathered=kind.gathered, short=True)
    short, assumed = results["blocks"][name], results["assumed"]
    beside = short["worker_s"] - short["steps"] / results["steps_per_s"]["full, heun"]
    written = results["files"][-1]["written_s"] / results["files"][-1]["bytes"]
    compute = geometry["block_beads"] * kind.steps / steps_per_s
    return Work(
        geometry["blocks"],
        compute + geometry["windows"] * max(beside, 0.0) + geometry["written_bytes"] * written,
        geometry["written_bytes"] / assumed["bandwidth_B_per_s"]
        + geometry["file_operations"] / assumed["file_operations_per_s"],
        short["client_s"] + results["task_s"],
    )


#: of more blocks than that a part is followed
_FOLLOWED = 20_000


def _time(results: Results, work: Work, cores: int) -> float:
    """`makespan`, s; of very many blocks that of a part of them, in proportion."""
    part = min(1.0, max(_FOLLOWED, 2 * cores) / work.blocks)
    some = work._replace(blocks=math.ceil(work.blocks * part))
    start = results["start_s"]
    run = makespan(some, cores, start_s=0.0, scatter=results["assumed"]["scatter"])
    return start + run * work.blocks / some.blocks


def _planned(results: Results, kind: Kind, line: tuple[int, ...]) -> Results:
    """Time and efficiency against cores of a kind of ensemble, and where its walls are."""
    geometry = _geometry(results, kind)
    work = _work(results, geometry, kind, results["steps_per_s"]["full, heun"])
    ideal = kind.beads * kind.steps / results["steps_per_s"]["full, heun"]
    entries = [
        {"cores": cores, "seconds": seconds, "efficiency": ideal / cores / seconds}
        for cores in sorted({*line, *CORES})
        for seconds in [_time(results, work, cores)]
    ]
    return {
        "kind": kind.label, "gathered": kind.gathered, **geometry,
        "block_s": work.block_s, "client_s": work.client_s, "storage_s": work.stored_s,
        "terabytes": 1e-12 * geometry["stored_bytes"] * geometry["blocks"],
        "most_cores": {
            "blocks": float(work.blocks),
            "file system": work.block_s / work.stored_s,
            "process in charge": work.block_s / work.client_s,
        },
        "cores": entries,
    }  # fmt: skip


def _models(results: Results) -> list[Results]:
    """Statistics of 10^6 beads over 10^9 steps, by model and method, on the cores of the plan."""
    geometry = _geometry(results, STATISTICS)
    found = []
    for name, rate in results["steps_per_s"].items():
        work = _work(results, geometry, STATISTICS, rate)
        found.append(
            {
                "model": name, "steps_per_s": rate,
                "core_hours": BEADS * STEPS / rate / 3600,
                "seconds": {str(cores): _time(results, work, cores) for cores in CORES},
            }
        )  # fmt: skip
    return found
