"""Numba's cache follows a regenerated module, and is used when nothing changed.

A cached function that calls another file's function by name would keep running the old one.
"""

import importlib.util
import os
import subprocess
import sys
from pathlib import Path

import pytest

from tweezer.compiled import lanes

ROOT = Path(__file__).parents[2]

#: what to compute, and what was found in the cache and what was not
COUNTED = """
def counted(value, compiled):
    print(value, sum(compiled.stats.cache_hits.values()), sum(compiled.stats.cache_misses.values()))
"""
#: of a user's function that calls a part of the kernels, which calls the emitted ray
SCATTERING = """
import numpy as np
from tweezer.compiled import cached_njit
from tweezer.optics.rays import nodes, ray_sum

circular = ray_sum.Rays("circular", denser_medium=False, gradient=False, moment=False)
efficiencies = ray_sum.efficiencies_of_rings(circular)
Q, S = nodes.Q_OF, nodes.S_OF

@cached_njit()
def scattering(sine_squared):
    room = np.zeros((S + 1, 1))
    room[S, 0] = sine_squared
    efficiencies(room, 1, 1, 0.9)
    return room[Q, 0]

counted(scattering(0.25), scattering)
"""
#: of a motion without light: the emitted equations alone
VELOCITY = """
import numpy as np
import tweezer
from tweezer.dynamics import bind
from tweezer.generated import overdamped_translation
scene = tweezer.load_scene("thesis-990nm").replace(
    simulation={"model": "overdamped"}, forces={"optical": False}
)
counted(bind(scene).rhs(0.0, np.array([1e-7, 2e-7, -1e-7]))[2], overdamped_translation.rhs)
"""
#: of a user's function that calls the generator of noise by its own name
NOISE = """
import numpy as np
from tweezer.compiled import cached_njit
from tweezer.dynamics.brownian.noise import normals

@cached_njit()
def number(seed):
    numbers = np.empty((3, 1))
    normals(seed, np.arange(1), 0, 0, numbers)
    return numbers[0, 0]

counted(number(1), number)
"""
#: of the attitude, by one small emitted function
TURN = """
import numpy as np
from tweezer.dynamics.models import kinematics
out = np.empty((3, 3))
kinematics.rotation_matrix(np.array([0.5, 0.1, -0.7, 0.3]), out)
counted(out[0, 1], kinematics.rotation_matrix)
"""
#: of an error, which is a constant of another file
ESTIMATE = """
from tweezer.optics.rays.quadrature import ARCS, _estimate
counted(_estimate(0.1, ARCS, 0), _estimate)
"""

#: changes of a file
VELOCITY_TRIPLED = ("generated/overdamped_translation.py", "out[2] = ", "out[2] = 3.0 * ")
SCATTERING_DOUBLED = ("generated/ray.py", "return Q_sc, G\n", "return 2.0 * Q_sc, G\n")
NOISE_TURNED = (
    "tweezer/dynamics/brownian/noise.py",
    "    r = root(-2.0 * _logarithm(u))",
    "    r = -root(-2.0 * _logarithm(u))",
)
ERROR_DOUBLED = ("tweezer/optics/rays/panels.py", "ERROR_OF_ARCS = ((6.0", "ERROR_OF_ARCS = ((12.0")
ROTATION_DOUBLED = ("generated/kinematics.py", "out[0, 1] = ", "out[0, 1] = 2.0 * ")


@pytest.fixture
def tree(tmp_path):
    """A copy of the runtime with a cache of its own."""
    for name in ("tweezer", "generated"):
        subprocess.run(["cp", "-r", str(ROOT / name), str(tmp_path / name)], check=True)
    return tmp_path


def run(tree, *programs):
    """Value, hits and misses of each program, all in one fresh process."""
    environment = {
        **os.environ,
        "PYTHONPATH": str(tree),
        "NUMBA_CACHE_DIR": str(tree / "cache"),
    }
    (tree / "programs.py").write_text(COUNTED + "".join(programs), encoding="utf-8")
    result = subprocess.run(
        [sys.executable, "programs.py"], cwd=tree, env=environment,
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    return [tuple(map(float, line.split())) for line in result.stdout.splitlines()]


def edit(tree, name, old, new):
    path = tree / name
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))


def test_cache_follows_the_files_that_a_function_calls(tree):
    """One change after the other: only what calls the changed file is compiled again."""
    programs = (SCATTERING, VELOCITY, NOISE)
    (Q, *first), (velocity, *second), (x, *third) = run(tree, *programs)
    assert first == second == third == [0, 1]

    edit(tree, *VELOCITY_TRIPLED)
    same_Q, tripled_velocity, same_x = run(tree, *programs)
    assert (same_Q, same_x) == ((Q, 1, 0), (x, 1, 0))
    assert tripled_velocity == (pytest.approx(3 * velocity, rel=1e-12), 0, 1)

    edit(tree, *SCATTERING_DOUBLED)
    edit(tree, *NOISE_TURNED)
    doubled_Q, same_velocity, turned_x = run(tree, *programs)
    assert doubled_Q == (2 * Q, 0, 1)
    assert same_velocity == (tripled_velocity[0], 1, 0)
    assert turned_x == (-x, 0, 1)


def test_a_module_that_changes_under_a_running_program_does_not_spoil_the_cache(tree):
    """Imported, then replaced on disk, then first called: the old code under the old digest."""
    replacing = f"""
import tweezer.dynamics.models, tweezer.optics.rays.quadrature
from pathlib import Path
for name, old, new in ({ROTATION_DOUBLED}, {ERROR_DOUBLED}):
    text = Path(name).read_text()
    Path(name).write_text(text.replace(old, new))
"""
    (R12, *_), (error, *_) = run(tree, replacing, TURN, ESTIMATE)
    (R12_new, *counted), (error_new, *also_counted) = run(tree, TURN, ESTIMATE)
    assert counted == also_counted == [0, 1]
    assert (R12_new, error_new) == (2 * R12, 2 * error)


def test_arithmetic_of_lanes_that_changes_is_another_type(tmp_path):
    """A function that subtracts lanes does not name the code for it; it names their type."""
    text = Path(lanes.__file__).read_text(encoding="utf-8")
    names = set()
    for i, now in enumerate((text, text.replace('operator.sub, "fsub"', 'operator.sub, "fadd"'))):
        (tmp_path / f"lanes_{i}.py").write_text(now, encoding="utf-8")
        spec = importlib.util.spec_from_file_location(f"lanes_{i}", tmp_path / f"lanes_{i}.py")
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        names.add(module._LANES.name)
    assert len(names) == 2
    assert lanes._LANES.name in names
