"""The scenes of several beads in the documentation."""

from pathlib import Path

import numpy as np
import pytest

import tweezer

EXAMPLES = sorted((Path(__file__).parents[2] / "docs/examples").glob("*.toml"))


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
@pytest.mark.filterwarnings("error")
def test_examples_run_and_stay_in_their_traps(path):
    scene = tweezer.load_scene(path)
    assert scene.name == path.stem
    run = tweezer.simulate(scene.replace(simulation={"duration": "1 ms", "samples": 11}), seed=1)
    assert run.attrs["status"] == "complete"
    foci = np.array([beam.position for beam in scene.beams])
    assert np.abs(run.position.values[:, :, :2] - foci[:, :2]).max() < 0.1e-6
    assert (run.force_between > 0).all() == bool(scene.tether)
