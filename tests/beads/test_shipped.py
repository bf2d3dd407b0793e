"""The shipped scenes of several beads."""

import numpy as np
import pytest

import tweezer

SCENES = [name for name in tweezer.shipped_scenes() if tweezer.load_scene(name).more_beads]


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.filterwarnings("error")
def test_shipped_scenes_of_several_beads_run_and_stay_in_their_traps(name):
    scene = tweezer.load_scene(name)
    run = tweezer.simulate(scene.replace(simulation={"duration": "1 ms", "samples": 11}), seed=1)
    assert run.attrs["status"] == "complete"
    foci = np.array([beam.position for beam in scene.beams])
    assert np.abs(run.position.values[:, :, :2] - foci[:, :2]).max() < 0.1e-6
    assert (run.force_between > 0).all() == bool(scene.tether)
