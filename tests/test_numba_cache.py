"""Numba's cache follows a regenerated module, and is used when nothing changed.

A cached function that calls another file's function by name would keep running the old one.
"""

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]

PROGRAM = """
import numpy as np
import tweezer
from tweezer.dynamics import bind
from tweezer.optics.kernels import Rays, grid_kernel
scene = tweezer.load_scene("thesis-990nm").replace(simulation={"model": "overdamped"})
position = np.array([1e-7, 2e-7, -1e-7])
force = tweezer.optical_force(scene, position)
rates = bind(scene).rhs(0.0, position)
stats = grid_kernel(
    Rays("averaged-reflectance", denser_medium=False, gradient=False, moment=False)
).stats
print(force[2], rates[2], sum(stats.cache_hits.values()), sum(stats.cache_misses.values()))
"""


@pytest.fixture
def tree(tmp_path):
    """A copy of the runtime with a cache of its own."""
    for name in ("tweezer", "generated"):
        subprocess.run(["cp", "-r", str(ROOT / name), str(tmp_path / name)], check=True)
    return tmp_path


def run(tree, program=PROGRAM):
    environment = {
        **os.environ,
        "PYTHONPATH": str(tree),
        "NUMBA_CACHE_DIR": str(tree / "cache"),
    }
    result = subprocess.run(
        [sys.executable, "-c", program], cwd=tree, env=environment, capture_output=True, text=True,
        check=True,
    )  # fmt: skip
    force, velocity, hits, misses = map(float, result.stdout.split())
    return force, velocity, hits, misses


def edit(tree, name, old, new):
    path = tree / "generated" / name
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))


def test_cache_follows_a_regenerated_module(tree):
    force, velocity, hits, misses = run(tree)
    assert (hits, misses) == (0, 1)
    assert run(tree) == (force, velocity, 1, 0)

    edit(tree, "overdamped_translation.py", "out[2] = ", "out[2] = 3.0 * ")
    same_force, tripled_velocity, hits, misses = run(tree)
    assert (same_force, hits, misses) == (force, 1, 0)
    assert tripled_velocity == pytest.approx(3 * velocity, rel=1e-12)

    edit(tree, "ray.py", "return F1, F2, F3", "return F1, F2, 2.0 * F3")
    doubled_force, _, hits, misses = run(tree)
    assert (hits, misses) == (0, 1)
    assert doubled_force == pytest.approx(2 * force, rel=1e-12)
    assert run(tree)[2:] == (1, 0)


def test_a_module_that_changes_under_a_running_program_does_not_spoil_the_cache(tree):
    """Imported, then replaced on disk, then first called: the old code under the old digest."""
    lines = PROGRAM.strip().splitlines()
    replacing = (
        "path = 'generated/ray.py'; text = open(path).read();"
        "open(path, 'w').write(text.replace('return F1, F2, F3', 'return F1, F2, 2.0 * F3'))"
    )
    at = next(i for i, line in enumerate(lines) if line.startswith("scene ="))
    old_force, *_ = run(tree, "\n".join([*lines[:at], replacing, *lines[at:]]))
    new_force, _, hits, misses = run(tree)
    assert (hits, misses) == (0, 1)
    assert new_force == pytest.approx(2 * old_force, rel=1e-12)


WALK = """
import numpy as np
import tweezer
from tweezer.dynamics import walk
scene = tweezer.load_scene("silica-1um").replace(
    forces={"brownian": True, "optical": False, "gravity": False, "buoyancy": False},
    start={"position": [0, 0, 0]},
    simulation={"model": "overdamped", "samples": 2, "duration": 1e-3},
)
bound = walk(scene, 1)
states, out = bound.start(np.arange(1)), np.empty((1, 1, 3))
bound.advance(states, np.arange(1), 0, out)
stats = bound._compiled[1].stats
print(*out[0, 0, :2], sum(stats.cache_hits.values()), sum(stats.cache_misses.values()))
"""


def test_cache_of_a_walk_follows_the_files_that_it_calls(tree):
    before = run(tree, WALK)
    x, _, hits, _ = run(tree, WALK)
    assert hits > 0
    assert x == before[0]
    path = tree / "tweezer" / "dynamics" / "brownian" / "noise.py"
    text = path.read_text()
    old = "        return float(fraction) * _WIDTH[layer]"
    assert old in text
    path.write_text(text.replace(old, old.replace("return ", "return -")))
    assert run(tree, WALK)[0] == -x
