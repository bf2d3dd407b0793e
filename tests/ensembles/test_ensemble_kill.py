"""Ensembles whose processes are killed: nothing is lost or wrong, and the bytes are the same.

`make stress` kills 20 times, by TWEEZER_KILLS.
"""

from __future__ import annotations

import contextlib
import functools
import logging
import multiprocessing
import os
import signal
import threading
import time
from pathlib import Path

import numpy as np
import pytest

import tweezer
from tests.beads.test_ensembles import PAIR
from tests.ensembles.test_ensemble import FREE, INERTIAL, content, interrupt_after
from tweezer.ensembles import job, statistics, store

KILLS = int(os.environ.get("TWEEZER_KILLS", "2"))
TRAJECTORIES = 1024
ROD = FREE.replace(bead={"shape": "spheroid", "length": "2 um"}, simulation={"duration": "100 ms"})

CONTROLLED = FREE.replace(
    feedback={"kind": "pid", "rate": 1e5, "delay": 3e-5, "noise": 1e-24, "gains": [1e-6, 0, 1e-10]}
)


def work(
    out: Path, gathered: bool, scheduler: str | None = None, scene: tweezer.Scene = FREE
) -> None:
    """Compute an ensemble of 16 blocks of 7 windows, or go on with it."""
    job._WINDOW_NUMBERS, statistics.WINDOW, store._JOINED = 3 * 64 * 16, 16, 2
    kind = {"seed": 8, "statistics": gathered, "scheduler": scheduler, "resume": True}
    tweezer.ensemble(scene, TRAJECTORIES, out=out, **kind)


@pytest.fixture(scope="module")
def process():
    """`process(work, ...)`: a process started, from one that has imported what it needs."""
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(["tests.ensembles.test_ensemble_kill", "tweezer.ensembles"])

    def start(*arguments):
        started = context.Process(target=work, args=arguments, daemon=True)
        started.start()
        return started

    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PYTHONPATH", str(Path(__file__).parents[2]))  # where these are found
        yield start


def written(out: Path) -> set[tuple[Path, int]]:
    """The files that an ensemble at work has written, and when."""
    part = out.with_name(f"{out.name}.part")
    found = set()
    with contextlib.suppress(FileNotFoundError):  # one may go while it is looked at
        for path in (*out.rglob("*"), *part.glob("*.npz"), out.with_name(f"{out.name}.lock")):
            found.add((path, path.stat().st_mtime_ns))
    return found


def wait_for(condition) -> None:
    end = time.monotonic() + 300
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.002)


def has_written(process, out: Path, number: int, seen: set[tuple[Path, int]]) -> bool:
    """Whether so many files were written beside those `seen` before, or no more will be."""
    seen |= written(out)
    return len(seen) >= number or not process.is_alive()


@pytest.mark.parametrize("gathered", [False, True])
@pytest.mark.parametrize(
    "scene", [FREE, INERTIAL, ROD, PAIR, CONTROLLED],
    ids=["overdamped", "memory", "body", "pair", "controller"],
)  # fmt: skip
def test_killed_at_random_and_resumed(scene, gathered, process, tmp_path):
    suffix = ".nc" if gathered else ".zarr"
    whole = tmp_path / f"whole{suffix}"
    finished = process(whole, gathered, None, scene)
    finished.join()
    assert finished.exitcode == 0
    expected = content(whole)
    draw = np.random.default_rng(20 + gathered)
    kills, stores = 0, 0
    while kills < KILLS:
        stores += 1
        out = tmp_path / f"{stores}{suffix}"
        while not out.exists() or out.with_name(f"{out.name}.part").exists():  # until all is done
            before = written(out)
            going = process(out, gathered, None, scene)
            if kills < KILLS:
                number = len(before) + draw.integers(1, 40)  # the first is the lock
                wait_for(functools.partial(has_written, going, out, number, before))
                going.kill()
            going.join()
            assert going.exitcode in (0, -signal.SIGKILL)
            kills += going.exitcode != 0
        assert content(out) == expected
    left = {f"{name}{suffix}" for name in ("whole", *range(1, stores + 1))}
    assert {path.name for path in tmp_path.iterdir()} == left


@pytest.fixture(scope="module")
def cluster():
    """Two worker processes, which are started again when they die."""
    distributed = pytest.importorskip("distributed")
    with (
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, dashboard_address=":0", silence_logs=logging.CRITICAL
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        yield client


def begun(out: Path):
    """Whether some blocks are done, or begun."""
    part = out.with_name(f"{out.name}.part")
    return lambda: len(list(part.glob("[0-9]*.npz"))) > 3


@pytest.mark.parametrize("gathered", [False, True])
def test_a_worker_is_killed(gathered, cluster, tmp_path):
    suffix = ".nc" if gathered else ".zarr"
    kind = {"seed": 9, "statistics": gathered}
    scene = FREE.replace(simulation={"samples": 1001})
    tweezer.ensemble(scene, 2048, out=tmp_path / f"whole{suffix}", **kind)
    out = tmp_path / f"cut{suffix}"
    before = cluster.run(os.getpid)

    def kill() -> None:
        wait_for(begun(out))
        os.kill(next(iter(before.values())), signal.SIGKILL)

    killer = threading.Thread(target=kill)
    killer.start()
    runs = tweezer.ensemble(scene, 2048, out=out, scheduler=cluster, **kind)
    killer.join()
    assert runs.attrs["status"] == "complete"
    wait_for(lambda: len(cluster.scheduler_info()["workers"]) == 2)
    assert set(cluster.run(os.getpid).values()) != set(before.values())
    assert content(out) == content(tmp_path / f"whole{suffix}")


@pytest.mark.parametrize("killed", [False, True])
def test_a_client_goes_while_workers_are_at_work(killed, cluster, process, tmp_path, monkeypatch):
    monkeypatch.setattr(job, "_WINDOW_NUMBERS", 3 * 64 * 16)
    whole, out = tmp_path / "whole.zarr", tmp_path / "cut.zarr"
    tweezer.ensemble(FREE, TRAJECTORIES, seed=8, out=whole)
    if killed:
        client = process(out, False, cluster.scheduler.address)
        wait_for(begun(out))
        client.kill()
        client.join()
        assert client.exitcode == -signal.SIGKILL
    else:
        runs = tweezer.ensemble(
            FREE, TRAJECTORIES, seed=8, out=out, scheduler=cluster, progress=interrupt_after(0.1)
        )
        assert runs.attrs["status"] == "interrupted"
    tweezer.ensemble(FREE, TRAJECTORIES, seed=8, out=out, resume=True)
    assert content(out) == content(whole)
