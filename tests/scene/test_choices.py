"""A name is written down once: a method and a scheme that are added to the table work at once."""

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]

PROGRAM = """
import sys
from tweezer.scene import choices

# a scheme is one file with its step and its traits; here the file is this one
sys.modules["mine"] = sys.modules["__main__"]
choices.METHODS["mine"] = choices.Method("mine", "a scheme of mine", "mine:SCHEME", thermal=True,
                                         models=("overdamped",))
choices.METHODS["also-mine"] = choices.Method("also-mine", "a method of mine", "mine:METHOD")
choices.MODELS["slow"] = choices.Model("slow", "a model of mine", "overdamped", rotating="rotation")
choices.EVALUATORS["by-hand"] = choices.Evaluator("by-hand", "an evaluator of mine",
                                                   {"rays": "mine:mine"})

import numpy as np
import tweezer
from tests.reference.fields import LinearTrap
from tweezer import cli
from tweezer.tracking.depth import _Likelihood
from tweezer.reading.recording import Track
from tweezer.dynamics.brownian.euler import EULER_MARUYAMA as SCHEME
from tweezer.dynamics.integrators.dop853 import DOP853 as METHOD
from tweezer.optics.light import LightForce
from tweezer.optics.rays.light import light_on_bead


class Mine(LightForce):
    def compiled(self, *, gradient):
        return LinearTrap(1e3 * self.light.cone.power * 1e-6).compiled(gradient=gradient)


def mine(scene):
    return Mine(light_on_bead(scene))


# its force is that of the scene: in the public functions, in two beams, and in a run
mW = tweezer.load_scene("silica-1um").replace(
    optics={"evaluator": "by-hand"}, beam={"power_through_pupil": "2 mW"},
    simulation={"samples": 3, "method": "dop853"},
)
place = np.array([1e-7, 0, -2e-7])
np.testing.assert_allclose(tweezer.optical_force(mW, place), -2e-6 * place, rtol=1e-12)
beam = {key: of for key, of in mW.beam.model_dump().items() if of is not None}
both = mW.replace(beam=[beam, {**beam, "position": [1e-6, 0, 0]}])
np.testing.assert_allclose(
    tweezer.optical_force(both, place), -2e-6 * (2 * place - [1e-6, 0, 0]), rtol=1e-12
)
followed = tweezer.simulate(mW, "20 us")
np.testing.assert_allclose(
    followed["optical_force"].values, -2e-6 * followed["position"].values, rtol=1e-9
)
assert followed.attrs["force_evaluator"] == "by-hand"
force = tweezer.optics.light_of_one_beam(mW)
assert force.of_radius(mW.bead.radius) is force
try:  # nothing says that it scales with the radius
    force.of_radius(2e-6)
except tweezer.SceneError as error:
    assert "bead.radius: Mine gives the force at 5e-07 m alone" in str(error), error
else:
    raise AssertionError
try:  # it is of rays
    mW.replace(optics={"theory": "waves"})
except tweezer.SceneError as error:
    assert "optics.evaluator = 'by-hand' requires ray optics" in str(error), error
else:
    raise AssertionError
# a fit of the depth takes it, not the map of ray optics
track = Track(1e-3 * np.arange(10), np.full((10, 2), 1e-7), name="at rest")
assert isinstance(_Likelihood(track, mW, 1e-8, 0.0, ())._light, Mine)

dark = tweezer.load_scene("silica-1um").replace(
    forces={"optical": False}, simulation={"model": "overdamped", "samples": 3}
)
run = tweezer.simulate(dark, "1 us", method="also-mine")
assert run.attrs["method"] == "also-mine"
slow = tweezer.simulate(dark, "1 us", model="slow")
assert (slow["position"].values == run["position"].values).all()
thermal = dark.replace(forces={"brownian": True})
theirs = tweezer.simulate(thermal, "1 us", method="euler-maruyama")
mine = tweezer.simulate(thermal, "1 us", method="mine")
assert (mine["position"].values == theirs["position"].values).all()

keys = tweezer.scene.sections.Simulation.model_fields
for name in ("mine", "also-mine"):
    assert f"{name}: " in keys["method"].description
assert "slow: a model of mine" in keys["model"].description
assert "by-hand: " in tweezer.scene.sections.Optics.model_fields["evaluator"].description


def refused(**changes):
    try:
        dark.replace(**changes)
    except tweezer.SceneError as error:
        return str(error)


for name in ("mine", "also-mine"):
    assert repr(name) in refused(simulation={"method": "newton"})
assert "'slow'" in refused(simulation={"model": "fast"})
assert "'by-hand'" in refused(optics={"evaluator": "guess"})
assert "requires forces.brownian = true" in refused(simulation={"method": "mine"})
assert "set simulation.model to overdamped" in refused(
    forces={"brownian": True}, simulation={"method": "mine", "model": "full"}
)
sys.argv[1:] = ["run", "--help"]
cli.main()
"""


def test_what_is_added_to_the_table_is_known_everywhere():
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM], cwd=ROOT, capture_output=True, text=True, check=False,
        env={**os.environ, "COLUMNS": "300"},
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert "also-mine" in "".join(done.stdout.split())  # lines may break within it
