"""Faults from outside: each ends whole, or as one error of tweezer's own; never wrong in silence.

`python -m tests.stress_faults` prints how they ended; `make stress` calls it. A kind of fault is a
function `kind(count)` that makes so many and counts how they ended; what must not happen raises
AssertionError, which names the fault.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

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


def damaged_caches(count: int) -> Counter[str]:
    """Damage files of compiled code and of a table: the forces stay the same but for rounding.

    What is compiled again is linked in another order, which may change the last bit.
    """
    rng = np.random.default_rng(1)
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
        for _ in range(count):
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


#: name, what makes the faults, and how many
FAULTS: list[tuple[str, Callable[[int], Counter[str]], int]] = [
    ("damaged files of compiled code and tables", damaged_caches, 100),
    ("changed scenes", mutated_scenes, 1000),
    ("changed command lines", mutated_command_lines, 1000),
    ("changed recordings", mutated_recordings, 1000),
]


if __name__ == "__main__":
    began = time.perf_counter()
    for name, make, count in FAULTS:
        print(f"{count} {name}", flush=True)
        for ended, times in make(count).most_common():
            print(f"{times:8d}  {ended}")
    print(f"{time.perf_counter() - began:8.0f}  s")
