"""A DNA that two traps stretch: the simulated experiment gives its lengths back.

`python -m tests.stretch_coverage` measures the coverage of the intervals.
"""

import numpy as np
import pytest

import tweezer
from tests.beads.test_motion import ONE
from tweezer.values.errors import SceneError

CONTOUR, PERSISTENCE = 1e-6, 50e-9


def dna(duration, samples, velocity, **sections):
    """Return a scene in which the second of two beams pulls a DNA straight."""
    data = {key: value for key, value in ONE.items() if key not in ("start", "name")}
    bead = {"diameter": "1 um", "density": 1050.0, "refractive_index": 1.57}
    beam = data["beam"] | {"power_through_pupil": "100 mW"}
    ramp = {"kind": "ramp", "velocity": [velocity, 0, 0]}
    data |= {
        "bead": [bead, bead],
        "beam": [beam, beam | {"position": ["1.6 um", 0, 0], "motion": ramp}],
        "tether": [{
            "model": "bouchiat", "between": ["1", "2"], "contour_length": CONTOUR,
            "persistence_length": PERSISTENCE, "stretch_modulus": "1000 pN",
        }],
        "optics": {"evaluator": "map", "table_range": "4 um"},
        "start": {"drawn": "equilibrium"}, "forces": {"brownian": True, "gravity": False},
        "simulation": {"duration": duration, "samples": samples},
    }  # fmt: skip
    return tweezer.load_scene(data | sections)


def test_lengths_of_a_molecule_are_found():
    """Within 4 standard errors, for a ramp that ends at 98 % of the contour length.

    The force is compared with the law at the measured extension.
    """
    found = tweezer.stretch(dna("60 ms", 1501, "10 um/s"), seed=1, windows=30)
    fit = found.fit
    for true, length, (low, high) in (
        (CONTOUR, fit.contour_length, fit.contour_length_interval),
        (PERSISTENCE, fit.persistence_length, fit.persistence_length_interval),
    ):
        error = (high - low) / 3.92
        assert abs(length - true) < 4 * error < 0.2 * true
    law = tweezer.chain_force(
        "bouchiat", found.extension, contour_length=CONTOUR, persistence_length=PERSISTENCE,
        temperature=293.15, stretch_modulus=1e-9,
    )  # fmt: skip
    off = (found.force - law) / found.force_error
    assert np.abs(off).mean() < 3
    assert found.force.max() > 10e-12
    assert (found.width < 20e-9).all()


@pytest.mark.parametrize(
    ("sections", "message"),
    [
        ({"tether": []}, "tether: stretching requires one chain"),
        (
            {"tether": [{"model": "spring", "between": ["1", "2"], "stiffness": 1e-6}]},
            "tether: stretching requires one chain",
        ),
        (
            {"forces": {"brownian": True, "between": {"kind": "spring", "stiffness": 1e-6}}},
            "forces.between: acts beside the molecule",
        ),
        ({"beam": [ONE["beam"], ONE["beam"] | {"position": [1.6e-6, 0, 0]}]}, "a beam that moves"),
        ({"forces": {"brownian": False}, "start": {"drawn": "no"}}, "forces.brownian = False"),
    ],
)
def test_refused(sections, message):
    with pytest.raises(SceneError, match=message):
        tweezer.stretch(dna("1 ms", 1001, "10 um/s", **sections))


def test_windows_need_samples():
    with pytest.raises(SceneError, match="windows = 100: allowed: from 5 to 50"):
        tweezer.stretch(dna("1 ms", 1001, "10 um/s"), windows=100)
    with pytest.raises(SceneError, match="stretching requires two beads; the scene has 1"):
        tweezer.stretch("silica-1um")
