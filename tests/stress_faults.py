"""External faults: each ends with a complete result or one error of tweezer, never silently wrong.

`python -m tests.stress_faults` prints how they ended; `make stress` calls it. With words it makes
the faults whose names have one of them, and with numbers FIRST and COUNT that part of each:
`python -m tests.stress_faults damaged killed 200 50`.

A kind of fault is a function `kind(count, first)`. It makes `count` faults, beginning with number
`first`, and counts their outcomes. A forbidden outcome raises AssertionError with the fault's name.
"""

from __future__ import annotations

import os
import resource
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tests import write_faults
from tests.damaged_results import damaged_results, edited_results, hostile_results
from tests.foreign_files import foreign_files
from tests.mutated_kernels import mutated_kernels
from tests.mutations import mutated_command_lines, mutated_recordings, mutated_scenes

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
        tables = [path for path in sound if path.suffix == ".table"]
        for number in range(first, first + count):
            rng = np.random.default_rng([1, number])
            # every fifth time a table, of which there is one
            path = rng.choice(tables if rng.random() < 0.2 else list(sound))
            kind = rng.choice(["changed", "cut", "empty", "longer", "another's", "a folder"])
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
            path.unlink()
            path.mkdir() if kind == "a folder" else path.write_bytes(content)
            fault = f"{path.suffix} {kind}"
            different = np.abs(forces() - right).max() / np.abs(right).max()
            assert different < 1e-13, f"forces differ by {different:.2g}: {fault}: {path.name}"
            ended[f"the same forces: {fault}"] += 1
            for left in folder.rglob("*"):
                if left.is_file() and left not in sound:
                    left.unlink()
            if kind == "a folder":
                path.rmdir()
            path.write_bytes(sound[path])
    return ended


#: An ensemble of 16 blocks of 7 windows, or what is left to do of it: trajectories, or statistics
ENSEMBLE = """
import resource
import sys
import tweezer
from tweezer.ensembles import job, statistics, store
job._WINDOW_NUMBERS, statistics.WINDOW, store._JOINED = 3 * 64 * 16, 16, 2
scene = tweezer.load_scene("silica-1um").replace(
    forces={"brownian": True, "optical": False, "gravity": False, "buoyancy": False},
    simulation={"model": "overdamped", "duration": 1e-2, "samples": 101, "loss_distance": 1e-6},
)
out, most_bytes = sys.argv[1], int(sys.argv[2])
resource.setrlimit(resource.RLIMIT_FSIZE, (most_bytes, most_bytes))
try:
    if out.endswith("sweep.zarr"):
        over = {"simulation.duration": [1e-3 * number for number in range(1, 31)]}
        tweezer.sweep(
            scene, over, "ensemble", out, trajectories=64, seed=8, workers=2, resume=True
        )
    else:
        tweezer.ensemble(scene, 1000, seed=8, out=out, statistics=out.endswith("nc"), resume=True)
except tweezer.TweezerError as error:
    sys.exit(f"refused: {error}")
"""
#: Names of the two kinds of output
OUTPUTS = ("a.zarr", "a.nc")
#: These, and that of a sweep
WITH_SWEEP = (*OUTPUTS, "sweep.zarr")


def _ensemble(out: Path, most_bytes: int = resource.RLIM_INFINITY) -> subprocess.Popen[str]:
    """Start the ensemble, or go on with it; most_bytes: of a file, as on a disk that is full."""
    return subprocess.Popen(
        [sys.executable, "-c", ENSEMBLE, str(out), str(most_bytes)], cwd=ROOT,
        stderr=subprocess.PIPE, text=True,
    )  # fmt: skip


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
        assert _ensemble(out).wait() == 0
        found[name] = _content(out)
    return found


def _mended(out: Path, expected: dict[Path, bytes], fault: str) -> str:
    """Go on with an ensemble: the bytes are those of one that met no fault, or it is refused."""
    going = _ensemble(out)
    said = going.communicate()[1]
    if going.returncode == 0:
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
        going = _ensemble(out)
        while not list(out.parent.iterdir()) and going.poll() is None:
            time.sleep(0.01)
        time.sleep(rng.uniform(0, 0.5))
        going.send_signal(rng.choice([signal.SIGKILL, signal.SIGTERM, signal.SIGHUP]))
        going.wait()
        left = _mended(out, expected, f"kill {number}")
        assert left == "the same bytes", f"kill {number}: {left}"
        ended[f"killed: {going.returncode != 0}; then {left}"] += 1
    return ended


def full_disk(count: int, first: int = 0) -> Counter[str]:
    """Let no file be longer than so much: one line, and then the same bytes."""
    ended: Counter[str] = Counter()
    for number, out, expected in _places(count, first):
        rng = np.random.default_rng([3, number])
        most = int(rng.integers(50_000))
        going = _ensemble(out, most)
        said = going.communicate()[1]
        fault = f"files of {most} bytes"
        if going.returncode:
            assert said.startswith("refused: "), f"{fault}: {said}"
            assert len(said.splitlines()) == 1, f"{fault}: {said}"
        left = _mended(out, expected, fault)
        assert left == "the same bytes", f"{fault}: {left}"
        ended[f"full: {going.returncode != 0}; then {left}"] += 1
    return ended


def damaged_stores(count: int, first: int = 0) -> Counter[str]:
    """Damage a file of an ensemble begun or complete: the same bytes, or one line.

    A byte that is changed in a chunk is left to its checksum, which readers see.
    """
    ended: Counter[str] = Counter()
    for number, out, expected in _places(count, first, OUTPUTS):
        rng = np.random.default_rng([4, number])
        going = _ensemble(out)
        if number % 4 < 2:
            while not list(out.parent.glob("*.part/*.npz")) and going.poll() is None:
                time.sleep(0.01)
            time.sleep(rng.uniform(0, 0.3))
            going.kill()
        going.wait()
        files = [path for path in sorted(out.parent.rglob("*")) if path.is_file()]
        path = files[rng.integers(len(files))]
        sound = path.read_bytes()
        kind = rng.choice(["changed", "cut", "empty", "missing"])
        chunk = "c" in path.relative_to(out.parent).parts
        if kind == "changed" and sound and not chunk:
            at = rng.integers(len(sound))
            path.write_bytes(sound[:at] + bytes([sound[at] ^ 1]) + sound[at + 1 :])
        elif kind == "missing":
            path.unlink()
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


def _make(arguments: list[str]) -> None:
    """Make the faults that the arguments name, and print how they ended."""
    words = [each for each in arguments if not each.isdigit()]
    numbers = [int(each) for each in arguments if each.isdigit()]
    for name, make, all_of_them in FAULTS:
        if words and not any(word in name for word in words):
            continue
        first, count = numbers or (0, all_of_them)
        began = time.perf_counter()
        print(f"{count} {name}, from {first}", flush=True)
        for ended, times in make(count, first).most_common():
            print(f"{times:8d}  {ended}")
        print(f"{time.perf_counter() - began:8.0f}  s", flush=True)


if __name__ == "__main__":
    _make(sys.argv[1:])
