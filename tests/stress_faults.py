"""External faults: each ends with a complete result or one error of tweezer, never silently wrong.

`python -m tests.stress_faults` prints the outcomes; `make stress` calls it. Each kind runs on all
cores. A part with a forbidden outcome is WRONG, and the other parts continue. Words select the
faults with such a word in their name. Two numbers, FIRST and COUNT, select a part of each kind:
`python -m tests.stress_faults damaged killed 200 50`.

A kind of fault is a function `kind(count, first)`. It makes `count` faults, beginning with number
`first`, and counts their outcomes. A forbidden outcome raises AssertionError with the fault's name.
"""

from __future__ import annotations

import multiprocessing
import os
import resource
import signal
import subprocess
import sys
import tempfile
import time
import traceback
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import tweezer
from tests import write_faults
from tests.damaged_results import damaged_results, edited_results, hostile_results
from tests.foreign_files import foreign_files
from tests.mutated_kernels import mutated_kernels
from tests.mutations import mutated_command_lines, mutated_recordings, mutated_scenes
from tweezer.ensembles import job, statistics, store

ROOT = Path(__file__).parents[1]

#: Forces by the map, at its edge and beyond it: what reads compiled code and a table
FORCES = """
import numpy as np
import tweezer
scene = tweezer.load_scene("silica-1um").replace(
    optics={"evaluator": "map", "table_range": 2.0, "table_tolerance": 1e-4}
)
places = 0.5e-6 * np.random.default_rng(1).normal(size=(20, 3))
print(*(component for place in places for component in tweezer.optical_force(scene, place)))
"""


#: Number of files that are damaged for a process
_AT_ONCE = 10


def _damage(rng: np.random.Generator, sound: dict[Path, bytes]) -> str:
    """Damage one of the files, if no fault before has made it a folder."""
    tables = [path for path in sound if path.suffix == ".table"]
    # every fifth time a table, of which there is one
    path = rng.choice(tables if rng.random() < 0.2 else list(sound))
    kind = str(rng.choice(["changed", "cut", "empty", "longer", "another's", "a folder"]))
    content = bytearray(sound[path])
    if kind == "changed":
        for at in rng.integers(len(content), size=rng.integers(1, 9)):
            content[at] ^= rng.integers(1, 256)
    elif kind == "cut":
        del content[rng.integers(len(content)) :]
    elif kind == "empty":
        content.clear()
    elif kind == "longer":
        content += rng.bytes(100)
    elif kind == "another's":
        content[:] = sound[rng.choice(list(sound))]
    if path.is_dir():
        path.rmdir()
    else:
        path.unlink()
    path.mkdir() if kind == "a folder" else path.write_bytes(content)
    return f"{path.suffix} {kind}"


def damaged_caches(count: int, first: int = 0) -> Counter[str]:
    """Damage files of compiled code and of a table: the forces stay the same but for rounding.

    What is compiled again is linked in another order, which may change the last bit.
    """
    ended: Counter[str] = Counter()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        caches = {"NUMBA_CACHE_DIR": f"{folder}/compiled", "XDG_CACHE_HOME": f"{folder}/cache"}

        def forces() -> NDArray[np.float64]:
            said = subprocess.run(
                [sys.executable, "-c", FORCES], env={**os.environ, **caches}, cwd=ROOT,
                capture_output=True, text=True, check=True, timeout=600,
            )  # fmt: skip
            return np.array(said.stdout.split(), dtype=np.float64)

        right = forces()
        sound = {path: path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}
        for begin in range(first, first + count, _AT_ONCE):
            faults = [
                _damage(np.random.default_rng([1, number]), sound)
                for number in range(begin, min(begin + _AT_ONCE, first + count))
            ]
            different = np.abs(forces() - right).max() / np.abs(right).max()
            assert different < 1e-13, f"forces differ by {different:.2g}: {begin}: {faults}"
            ended.update(f"the same forces: {fault}" for fault in faults)
            for left in [each for each in folder.rglob("*") if each not in sound]:
                if left.is_file():
                    left.unlink()
            for path, content in sound.items():
                if path.is_dir():
                    path.rmdir()
                path.write_bytes(content)
    return ended


#: Names of the two kinds of output
OUTPUTS = ("a.zarr", "a.nc")
#: These, and that of a sweep
WITH_SWEEP = (*OUTPUTS, "sweep.zarr")


def _work(out: Path, workers: int) -> None:
    """An ensemble of 16 blocks of 7 windows, trajectories or statistics, or a sweep of them.

    What is left to do of it is done.
    """
    scene = tweezer.load_scene("silica-1um").replace(
        forces={"brownian": True, "optical": False, "gravity": False, "buoyancy": False},
        simulation={"model": "overdamped", "duration": 1e-2, "samples": 101, "loss_distance": 1e-6},
    )
    if out.name == "sweep.zarr":
        over = {"simulation.duration": [1e-3 * number for number in range(1, 31)]}
        tweezer.sweep(
            scene, over, "ensemble", out, trajectories=64, seed=8, workers=workers, resume=True
        )
    else:  # of an ensemble alone: the processes of a sweep keep the sizes of the package
        job._WINDOW_NUMBERS, statistics.WINDOW, store._JOINED = 3 * 64 * 16, 16, 2
        tweezer.ensemble(scene, 1000, seed=8, out=out, statistics=out.suffix == ".nc", resume=True)


class _Ensemble:
    """A process that computes an ensemble or a sweep, or goes on with it.

    The process is a copy of this one, in which everything is imported and compiled.

    Parameters
    ----------
    out : Path
        Output of the ensemble or sweep.
    most_bytes : int
        Largest size of a file, as on a full disk.
    workers : int
        Number of processes of a sweep. Two start without compiled code.
    """

    def __init__(
        self, out: Path, most_bytes: int = resource.RLIM_INFINITY, workers: int = 1
    ) -> None:
        self._said, saying = multiprocessing.Pipe(duplex=False)
        process = multiprocessing.get_context("fork").Process(
            target=self._run, args=(out, most_bytes, workers, saying)
        )
        with warnings.catch_warnings(action="ignore"):  # of Zarr's thread, which Zarr begins anew
            process.start()
        self.process = process
        saying.close()

    def _run(self, out: Path, most_bytes: int, workers: int, saying: Any) -> None:
        self._said.close()
        resource.setrlimit(resource.RLIMIT_FSIZE, (most_bytes, most_bytes))
        warnings.simplefilter("ignore")
        try:
            _work(out, workers)
        except tweezer.TweezerError as error:
            saying.send(f"refused: {error}")
            sys.exit(1)
        except Exception:
            saying.send(traceback.format_exc())
            sys.exit(1)

    def ended(self) -> tuple[int, str]:
        """Wait for the end; the exit code, and what was said."""
        try:
            said = self._said.recv()
        except EOFError:
            said = ""
        self.process.join()
        return self.process.exitcode or 0, said


def _content(out: Path) -> dict[Path, bytes]:
    """The files of a store, or a file."""
    files = [out] if out.is_file() else [path for path in out.rglob("*") if path.is_file()]
    return {path.relative_to(out): path.read_bytes() for path in files}


def _whole(folder: Path, outputs: tuple[str, ...]) -> dict[str, dict[Path, bytes]]:
    """What is written if nothing goes wrong, by name of the output."""
    found = {}
    for name in outputs:
        out = folder / "whole" / name
        out.parent.mkdir(exist_ok=True)
        _work(out, workers=1)
        found[name] = _content(out)
    return found


def _mended(out: Path, expected: dict[Path, bytes], fault: str) -> str:
    """Go on with an ensemble: the bytes are those of one that met no fault, or it is refused."""
    code, said = _Ensemble(out).ended()
    if code == 0:
        assert _content(out) == expected, f"{fault}: other bytes"
        assert [path.name for path in out.parent.iterdir()] == [out.name], f"{fault}: leftovers"
        return "the same bytes"
    assert said.startswith("refused: "), f"{fault}: {said}"
    assert len(said.splitlines()) == 1, f"{fault}: {said}"
    return "refused in one line"


def _places(
    count: int, first: int, outputs: tuple[str, ...] = WITH_SWEEP
) -> Iterator[tuple[int, Path, dict[Path, bytes]]]:
    """So many places for an output: number, path, and what is written if nothing goes wrong."""
    with tempfile.TemporaryDirectory() as name:
        expected = _whole(Path(name), outputs)
        for number in range(first, first + count):
            out = Path(name) / f"{number}" / outputs[number % len(outputs)]
            out.parent.mkdir()
            yield number, out, expected[out.name]


def kills(count: int, first: int = 0) -> Counter[str]:
    """Kill ensembles and sweeps at random, and go on with them: the bytes are the same."""
    ended: Counter[str] = Counter()
    for number, out, expected in _places(count, first):
        rng = np.random.default_rng([2, number])
        going = _Ensemble(out, workers=1 + (number % 15 == WITH_SWEEP.index("sweep.zarr")))
        while not list(out.parent.iterdir()) and going.process.is_alive():
            time.sleep(0.001)
        time.sleep(rng.uniform(0, 0.3))
        if going.process.is_alive():
            os.kill(going.process.pid, rng.choice([signal.SIGKILL, signal.SIGTERM, signal.SIGHUP]))
        code, _ = going.ended()
        left = _mended(out, expected, f"kill {number}")
        assert left == "the same bytes", f"kill {number}: {left}"
        ended[f"{out.name}, killed: {code != 0}; then {left}"] += 1
    return ended


def full_disk(count: int, first: int = 0) -> Counter[str]:
    """Let no file be longer than so much: one line, and then the same bytes."""
    ended: Counter[str] = Counter()
    for number, out, expected in _places(count, first):
        rng = np.random.default_rng([3, number])
        most = int(rng.integers(50_000))
        code, said = _Ensemble(out, most).ended()
        fault = f"files of {most} bytes"
        if code:
            assert said.startswith("refused: "), f"{fault}: {said}"
            assert len(said.splitlines()) == 1, f"{fault}: {said}"
        left = _mended(out, expected, fault)
        assert left == "the same bytes", f"{fault}: {left}"
        ended[f"{out.name}, full: {code != 0}; then {left}"] += 1
    return ended


def damaged_stores(count: int, first: int = 0) -> Counter[str]:
    """Damage a file of an ensemble begun or complete: the same bytes, or one line.

    A byte that is changed in a chunk is left to its checksum, which readers see. Another chunk in
    its place is noticed.
    """
    ended: Counter[str] = Counter()
    for number, out, expected in _places(count, first, OUTPUTS):
        rng = np.random.default_rng([4, number])
        going = _Ensemble(out)
        if number % 4 < 2:
            while not list(out.parent.glob("*.part/*.npz")) and going.process.is_alive():
                time.sleep(0.001)
            time.sleep(rng.uniform(0, 0.2))
            going.process.kill()
        going.ended()
        files = [path for path in sorted(out.parent.rglob("*")) if path.is_file()]
        path = files[rng.integers(len(files))]
        sound = path.read_bytes()
        kind = rng.choice(["changed", "cut", "empty", "missing", "another's"])
        chunk = "c" in path.relative_to(out.parent).parts
        if kind == "changed" and sound and not chunk:
            at = rng.integers(len(sound))
            path.write_bytes(sound[:at] + bytes([sound[at] ^ 1]) + sound[at + 1 :])
        elif kind == "missing":
            path.unlink()
        elif kind == "another's":
            others = [each for each in files if each.stat().st_size == len(sound)]
            path.write_bytes(others[rng.integers(len(others))].read_bytes())
        else:
            path.write_bytes(sound[: rng.integers(len(sound)) if kind == "cut" and sound else 0])
        ended[_mended(out, expected, f"{number}: {path} {kind}")] += 1
    return ended


def failing_writes(count: int, first: int = 0) -> Counter[str]:
    """Let each write of a sweep and of ensembles fail: by a full disk, a broken disk, and Ctrl-C.

    `count` writes fail, beginning with number `first`; a sweep has the most, fewer than 600.
    """
    ended: Counter[str] = Counter()
    for name in write_faults.KINDS:
        ended += write_faults.at_each_write(
            name,
            write_faults.ERRORS,
            lambda writes: range(1 + first, 1 + min(writes, first + count)),
        )
    return ended


#: name, what makes the faults, and how many
FAULTS: list[tuple[str, Callable[[int, int], Counter[str]], int]] = [
    ("damaged files of compiled code and tables", damaged_caches, 1000),
    ("changed scenes", mutated_scenes, 10_000),
    ("changed command lines", mutated_command_lines, 10_000),
    ("changed recordings", mutated_recordings, 10_000),
    ("changed functions of own forces", mutated_kernels, 200),
    ("results that are damaged", damaged_results, 10_000),
    ("results that another program has edited", edited_results, 10_000),
    ("results that are hostile", hostile_results, 5000),
    ("foreign files beside outputs", foreign_files, 5000),
    ("writes that fail, each of a sweep and of ensembles", failing_writes, 600),
    ("ensembles and sweeps that are killed", kills, 750),
    ("ensembles and sweeps on a disk that is full", full_disk, 750),
    ("damaged files of ensembles", damaged_stores, 1000),
]


def _part(number: int, count: int, first: int) -> Counter[str]:
    """Make some faults of the kind with this number; a forbidden outcome counts as "WRONG"."""
    try:
        return FAULTS[number][1](count, first)
    except AssertionError as error:
        traceback.print_exception(error)
        return Counter({f"WRONG: {error}": 1})


def _make(arguments: list[str]) -> bool:
    """Make the faults that the arguments name on all cores, print how they ended: all well?"""
    words = [each for each in arguments if not each.isdigit()]
    numbers = [int(each) for each in arguments if each.isdigit()]
    cores, well = os.cpu_count() or 1, True
    with ProcessPoolExecutor(cores, multiprocessing.get_context("spawn")) as pool:
        for number, (name, _, all_of_them) in enumerate(FAULTS):
            if words and not any(word in name for word in words):
                continue
            first, count = numbers or (0, all_of_them)
            began = time.perf_counter()
            print(f"{count} {name}, from {first}", flush=True)
            each = -(-count // cores)
            parts = [
                pool.submit(_part, number, min(each, first + count - begin), begin)
                for begin in range(first, first + count, each)
            ]
            ended = sum((part.result() for part in parts), Counter[str]())
            for what, times in ended.most_common():
                print(f"{times:8d}  {what}")
                well &= not what.startswith("WRONG")
            print(f"{time.perf_counter() - began:8.0f}  s", flush=True)
    return well


if __name__ == "__main__":
    sys.exit(not _make(sys.argv[1:]))
