"""How the benchmarks take times, and on what machine."""

from __future__ import annotations

import contextlib
import gc
import json
import math
import multiprocessing
import os
import platform
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from importlib.metadata import version
from itertools import chain
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

ROOT = Path(__file__).parents[2]
#: shortest timed call, s
CALL = 150e-6


class Call(NamedTuple):
    """Something timed."""

    run: Callable[[], object]
    items: int
    """how many positions, steps, ... it goes through"""


def machine() -> dict[str, str | int | None]:
    """Return what the results depend on: the commit of the code, the machine and the versions."""
    return {
        "commit": commit(),
        "processor": _processor(),
        "cores": os.cpu_count(),
        "system": platform.system(),
        "python": platform.python_version(),
        **{name: version(name) for name in ("numpy", "numba", "llvmlite")},
    }


def commit() -> str:
    """Return the commit of this checkout, with a plus if files differ from it."""

    def git(*words: str) -> str:
        done = subprocess.run(
            ["git", *words], cwd=ROOT, capture_output=True, text=True, check=False
        )
        return done.stdout.strip() if done.returncode == 0 else ""

    changed = git("status", "--porcelain", "--untracked-files=no")
    return f"{git('rev-parse', '--short=8', 'HEAD') or 'unknown'}{'+' if changed else ''}"


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor()
    names = (line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    return next(names, platform.machine())


def per_item(groups: Sequence[Sequence[Call]], rounds: int) -> Iterator[tuple[float, float]]:
    """Least and median time per item of each group of calls, s.

    Every round does every call once, so that all of them meet the same conditions. Calls should be
    short, some 100 us: the least of many short times is what the machine takes when nothing else
    disturbs it.
    """
    calls = list(chain.from_iterable(groups))
    times = np.empty((rounds, len(calls)))
    for call in calls:
        call.run()
    gc.disable()
    try:
        for of_round in times:
            for i, call in enumerate(calls):
                start = time.perf_counter_ns()
                call.run()
                of_round[i] = 1e-9 * (time.perf_counter_ns() - start)
    finally:
        gc.enable()
    least, median = iter(times.min(axis=0)), iter(np.median(times, axis=0))
    for group in groups:
        items = sum(call.items for call in group)
        yield (
            float(sum(next(least) for _ in group)) / items,
            float(sum(next(median) for _ in group)) / items,
        )


def roughly(run: Callable[[], object]) -> float:
    """Time that a call takes, s, to plan by."""
    ((least, _),) = per_item([[Call(run, 1)]], 3)
    return least


def calls_over(
    evaluate: Callable[[Array], object], positions: Array, at_least: int
) -> Iterator[Call]:
    """Calls of `CALL` or longer over positions (n, 3), in turn and as often as that takes."""
    a_call = 1
    while roughly(partial(evaluate, np.resize(positions, (a_call, 3)))) < CALL:
        a_call *= 2
    count = max(at_least, a_call)
    positions = np.resize(positions, (count, 3))
    for part in np.array_split(positions, math.ceil(count / a_call)):
        yield Call(partial(evaluate, part), len(part))


@contextlib.contextmanager
def dask_clients(counts: Iterable[int]) -> Iterator[dict[int, Any]]:
    """A client of Dask for each number of workers of one thread, on this machine."""
    from distributed import Client, LocalCluster

    with tempfile.TemporaryDirectory() as folder, contextlib.ExitStack() as stack:
        clients = {}
        for count in counts:
            cluster = LocalCluster(
                n_workers=count, threads_per_worker=1, dashboard_address=":0",
                local_directory=folder,
            )  # fmt: skip
            clients[count] = stack.enter_context(Client(stack.enter_context(cluster)))
        yield clients


def in_fresh_process(program: str, environment: dict[str, str]) -> dict[str, float]:
    """Run a program that prints times as JSON, and among them `"at": time.time()`.

    Returns them, and in place of "at" as "process_s" the time from before the process was started.
    """
    start = time.time()
    done = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", program],
        cwd=ROOT, env={**os.environ, **environment}, stdout=subprocess.PIPE, text=True, check=True,
    )  # fmt: skip
    times: dict[str, float] = json.loads(done.stdout)
    times["process_s"] = times.pop("at") - start
    return times


def least_step_times(
    walks: dict[Any, Any], beads: int, samples: int, rounds: int, say: Callable[[Any], object]
) -> dict[Any, float]:
    """s a step of a bead of each walk, in turn: the least of the rounds.

    say: called with the key of a walk before its steps.
    """
    who = np.arange(beads)
    least = dict.fromkeys(walks, math.inf)
    for _ in range(rounds):
        for key, bound in walks.items():
            say(key)
            states = bound.start(who)
            out = np.empty((beads, samples, len(bound.columns)))
            began = time.perf_counter()
            bound.advance(states, who, 0, out)
            spent = time.perf_counter() - began
            least[key] = min(least[key], spent / (beads * samples * bound.per_sample))
    return least


def on_all_cores(
    run: Callable[..., Any], tasks: Sequence[tuple[Any, ...]], say: Callable[[str], object]
) -> dict[Any, list[Any]]:
    """What `run` gives of the tasks, by the first entry of each, in fresh processes."""
    found: dict[Any, list[Any]] = {first: [] for first, *_ in tasks}
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(os.cpu_count(), mp_context=context) as executor:
        parts = executor.map(run, *zip(*tasks, strict=True))
        for i, ((first, *_), part) in enumerate(zip(tasks, parts, strict=True), 1):
            found[first].append(part)
            say(f"{i} of {len(tasks)} sets of records")
    return found
