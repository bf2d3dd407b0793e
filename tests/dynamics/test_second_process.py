"""The process that compiles beside a run: when there is one, how the two share, how it ends."""

from __future__ import annotations

import fcntl
import subprocess
import sys

import numba
import pytest
from numba.core import event

import tweezer
from tweezer.compiled import cached_njit, compilation, shared
from tweezer.dynamics import second_process
from tweezer.dynamics.integrators.explicit import sample

SCALED = tweezer.load_scene("thesis-990nm")
HOLDER = """
import fcntl, sys
file = open(sys.argv[1], "w")
fcntl.flock(file, fcntl.LOCK_EX)
print(flush=True)
sys.stdin.read()
"""


@pytest.fixture
def folder(tmp_path):
    shared.share(tmp_path)
    yield tmp_path
    shared.share(None)


def test_process_waits_for_a_function_that_another_compiles(folder):
    assert shared.claim("a", sample)
    (path,) = folder.iterdir()
    shared.release()
    command = [sys.executable, "-c", HOLDER, str(path)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as other:
        other.stdout.readline()
        waited = []

        def wait(compiling):
            waited.append(compiling)
            other.stdin.close()

        with compilation(wait):
            assert shared.claim("b", sample)  # of another function: at once
            assert not waited
            assert shared.claim("a", sample)
    assert len(waited) == 1  # the notice and the time of compiling have it
    with path.open() as file, pytest.raises(BlockingIOError):
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)


def test_function_compiled_by_another_process_is_loaded(folder, tmp_path, monkeypatch):
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path))

    def function(x):
        return 3.0 * x

    one, other = (cached_njit(error_model="numpy")(function) for _ in range(2))
    claim = shared.claim

    def while_another_compiles(name, dispatcher):
        monkeypatch.setattr(shared, "claim", lambda *_: False)
        one(1.0)
        return claim(name, dispatcher)

    monkeypatch.setattr(shared, "claim", while_another_compiles)
    assert other(1.0) == 3.0
    assert sum(other.stats.cache_hits.values()) == 1


def test_without_its_folder_a_process_compiles_alone(folder):
    shared.share(folder / "none")
    assert not shared.claim("a", sample)


@pytest.mark.parametrize(
    ("scene", "processors", "possible", "started"),
    [
        (SCALED, 2, True, 1),
        (SCALED, 1, True, 0),
        (SCALED, 2, False, 0),
        (SCALED.replace(simulation={"model": "full"}), 2, True, 0),
        (tweezer.load_scene("silica-1um"), 2, True, 0),
    ],
    ids=["helps", "one processor", "no locks", "the model is exact", "the model is open"],
)
def test_a_process_is_started_once_where_it_helps(
    monkeypatch, scene, processors, possible, started
):
    begun, processes = [], []

    def pretended(scene, folder):
        begun.append(folder)
        sleeping = [sys.executable, "-c", "import time; time.sleep(600)"]
        processes.append(subprocess.Popen(sleeping, stdin=subprocess.PIPE))
        return processes[-1]

    monkeypatch.setattr(second_process, "_started", pretended)
    monkeypatch.setattr(second_process, "_processors", lambda: processors)
    monkeypatch.setattr(second_process, "_WORTH", -1.0)
    monkeypatch.setattr(shared, "POSSIBLE", possible)
    with second_process.compiling_beside(scene):
        for _ in range(2):
            with event.trigger_event("numba:compile", data={"dispatcher": sample}):
                pass
        assert len(begun) == started
    assert not any(folder.exists() for folder in begun)
    assert all(each.stdin.closed and each.returncode is not None for each in processes)
    assert not shared.claim("a", sample)  # no longer shared


def test_the_process_ends_with_the_first_one(tmp_path, monkeypatch):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "cache"))
    folder = tmp_path / "locks"
    folder.mkdir()
    process = second_process._started(SCALED, folder)
    process.stdin.close()  # as the kernel does when the first process ends in whatever way
    assert process.wait(timeout=120) == 0
    assert not folder.exists()
