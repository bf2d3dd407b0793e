"""Plain Numba in place of tweezer's own compiling: the same results but for rounding."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np

import tweezer

ROOT = Path(__file__).parents[2]
#: Modules that use internals of Numba's dispatcher, cache and linker
OWN = {f"tweezer.compiled.{name}" for name in ("cache", "callers", "environments", "linked")}
PROGRAM = """
import json, sys
from tests.compiled.test_plain import results
print(json.dumps([results(), list(sys.modules)]))
"""


def results():
    """Return forces of rays, and positions of thermal motion without light."""
    rays = tweezer.load_scene("thesis-990nm")
    force = tweezer.optical_force(rays, [[0.0, 0, 2e-7], [3e-7, 1e-7, 0]])
    dark = tweezer.load_scene("silica-1um").replace(
        simulation={"model": "overdamped", "method": "euler-maruyama", "samples": 11},
        forces={"brownian": True, "optical": False},
    )
    run = tweezer.simulate(dark, duration="1 ms", seed=1)
    return [force.tolist(), run["position"].values.tolist()]


def test_results_are_the_same_but_for_rounding():
    done = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", PROGRAM], cwd=ROOT, capture_output=True, text=True,
        env={**os.environ, "TWEEZER_PLAIN_NUMBA": "1"}, check=True, timeout=600,
    )  # fmt: skip
    plain, modules = json.loads(done.stdout)
    assert "tweezer.compiled.plain" in modules
    assert not OWN & set(modules)
    for one, other in zip(plain, results(), strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-11, atol=1e-22)
