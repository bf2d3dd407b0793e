"""Sweeps: time of a trapping diagram, the same bytes after kills, workers of Dask.

Traps of a silica bead, by waves, over sizes and powers. The sweep of two processes is a command of
its own, so that its time has its start in it; another is killed by SIGKILL after random numbers of
cases and resumed. Of Dask's workers the time is that of the best round, and beside it the processor
time of the busiest one: what is left of the time where other programs use the machine too.
"""

from __future__ import annotations

import functools
import hashlib
import math
import os
import random
import resource
import signal
import subprocess
import sys
import tempfile
import time
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import tweezer
from tests.benchmarks.force import _to_four_digits
from tests.benchmarks.timing import dask_clients, machine

Results = dict[str, Any]

SCENE = "silica-1um"
#: m, and W
SIZES, POWERS = (0.2e-6, 3e-6), (1e-3, 1.0)
#: of the grid, and of that for Dask
GRID, DASK = (40, 60), (48, 30)
PROCESSES = 2
KILLS, ROUNDS = 10, 3
#: time between looks at a journal, s
LOOK = 0.02


def measure(*, quick: bool, say: Callable[[str], object]) -> Results:
    """The whole benchmark; `say` is told what is being measured."""
    grid, dask = ((3, 4), (3, 4)) if quick else (GRID, DASK)
    kills, rounds = (1, 1) if quick else (KILLS, ROUNDS)
    with tempfile.TemporaryDirectory() as folder:
        say("a sweep by two processes")
        whole = _whole(Path(folder), grid)
        say(f"the same, killed {kills} times")
        killed = _killed(Path(folder), grid, kills)
    say("workers of Dask")
    results: Results = _to_four_digits(
        {
            "machine": machine(), "quick": quick, "scene": SCENE, "grid": list(grid),
            "processes": PROCESSES, "whole": whole, "killed": killed,
            "dask": _dask(dask, rounds),
        }
    )  # fmt: skip
    return results


def _command(out: Path, grid: tuple[int, int]) -> list[str]:
    sizes, powers = (
        f"{low!r} {unit}..{high!r} {unit}:{count}:log"
        for (low, high), unit, count in zip((SIZES, POWERS), "mW", grid, strict=True)
    )
    return [
        sys.executable, "-m", "tweezer", "sweep", SCENE, "--over", f"bead.diameter={sizes}",
        "--over", f"beam.power_through_pupil={powers}", "--workers", str(PROCESSES), "--out",
        str(out), "--resume",
    ]  # fmt: skip


def _whole(folder: Path, grid: tuple[int, int]) -> Results:
    before, began = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    _end(_begin(_command(folder / "whole.zarr", grid)))
    wall, after = time.perf_counter() - began, resource.getrusage(resource.RUSAGE_CHILDREN)
    spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return {"wall_s": wall, "cpu_s": spent, "cases": math.prod(grid)}


def _begin(command: list[str]) -> subprocess.Popen[str]:
    return subprocess.Popen(
        command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, encoding="utf-8"
    )


def _end(running: subprocess.Popen[str]) -> None:
    _, told = running.communicate()
    if running.returncode:
        raise RuntimeError(told)


def _killed(folder: Path, grid: tuple[int, int], kills: int) -> Results:
    """The sweep killed so often, and resumed; whether its store is that of the whole one.

    It is killed when it has gone on by a random number of cases, fewer than all over the kills.
    """
    rng, out = random.Random(23), folder / "killed.zarr"
    journal = out.with_name(out.name + ".part") / "journal.jsonl"
    done = [0]
    for _ in range(kills):
        going_on = rng.randrange(max(1, math.prod(grid) // (kills + 1)))
        running = _begin(_command(out, grid))
        while _lines(journal) < done[-1] + going_on and running.poll() is None:
            time.sleep(LOOK)
        running.send_signal(signal.SIGKILL)
        running.communicate()
        if running.returncode != -signal.SIGKILL:
            break
        done.append(_lines(journal))
    _end(_begin(_command(out, grid)))
    return {
        "kills": len(done) - 1,
        "cases_done_at_each": done,
        "same_bytes": _digest(out) == _digest(folder / "whole.zarr"),
    }


def _lines(journal: Path) -> int:
    """Number of cases in a journal."""
    return max(0, journal.read_bytes().count(b"\n") - 1) if journal.exists() else 0


def _digest(store: Path) -> str:
    """Digest of the names and contents of all files of a store."""
    digest = hashlib.sha256()
    for file in sorted(path for path in store.rglob("*") if path.is_file()):
        digest.update(str(file.relative_to(store)).encode() + b"\0" + file.read_bytes())
    return digest.hexdigest()


def _dask(grid: tuple[int, int], rounds: int) -> Results:
    """Time by one worker of one thread and by two, s."""
    scene = tweezer.load_scene(SCENE)
    names = ("bead.diameter", "beam.power_through_pupil")
    over = {
        name: np.geomspace(*ends, count)
        for name, ends, count in zip(names, (SIZES, POWERS), grid, strict=True)
    }
    first = {name: values[-1:] for name, values in over.items()}
    least = {1: math.inf, 2: math.inf}
    busiest = {1: math.inf, 2: math.inf}
    load, _, _ = os.getloadavg()
    with (
        dask_clients(least) as clients,
        warnings.catch_warnings(action="ignore", category=tweezer.PhysicsWarning),  # of small beads
    ):
        for client in clients.values():  # what is compiled is loaded before
            client.run(functools.partial(tweezer.sweep, scene, first, workers=1))
        for _ in range(rounds):
            for count, client in clients.items():
                before, began = client.run(time.process_time), time.perf_counter()
                tweezer.sweep(scene, over, scheduler=client)
                least[count] = min(least[count], time.perf_counter() - began)
                after = client.run(time.process_time)
                most = max(after[worker] - before[worker] for worker in after)
                busiest[count] = min(busiest[count], most)
    return {
        "cases": math.prod(grid),
        "wall_s": {str(count): least[count] for count in least},
        "busiest_cpu_s": {str(count): busiest[count] for count in busiest},
        "load_before": load,
        "speed_up": least[1] / least[2],
        "speed_up_of_processor_time": busiest[1] / busiest[2],
    }
