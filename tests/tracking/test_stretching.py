"""A DNA that two traps stretch: the simulated experiment gives its lengths back.

`python -m tests.stretch_coverage` measures the coverage of the intervals.
"""

import re

import numpy as np
import pytest

import tweezer
from tests.beads.test_motion import ONE
from tweezer.values.errors import ResultError, SceneError

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


def recorded(path, headings="extension [nm],force [pN]"):
    """Write the samples of a DNA by Marko and Siggia's formula, with a noise of the deflection."""
    rng = np.random.default_rng(4)
    x = np.linspace(0.6e-6, 0.95e-6, 4000)
    part = x / CONTOUR
    law = 1.380649e-23 * 293.15 / PERSISTENCE * (0.25 / (1 - part) ** 2 - 0.25 + part)
    noise = 2e-9 * rng.normal(size=x.size)
    table = np.stack([1e9 * (x - noise), 1e12 * (law + 1e-4 * noise)], axis=1)
    np.savetxt(path, table, delimiter=",", header=headings, comments="", fmt="%.6f")
    return path


def siggia(**tether):
    """Return a scene with traps at rest and the law of Marko and Siggia."""
    beam = ONE["beam"]
    scene = dna("1 ms", 1001, "10 um/s", beam=[beam, beam | {"position": ["1.6 um", 0, 0]}])
    law = scene.tether[0].model_copy(
        update={"model": "marko-siggia", "stretch_modulus": None} | tether
    )
    return scene.model_copy(update={"tether": (law,)})


def test_lengths_of_a_recorded_molecule_are_found(tmp_path):
    """The lengths in the scene are not used."""
    found = tweezer.stretch(
        siggia(contour_length=2e-6, persistence_length=20e-9),
        recording=recorded(tmp_path / "dna.csv"),
    )
    fit = found.fit
    assert found.run is None
    for true, length, (low, high) in (
        (CONTOUR, fit.contour_length, fit.contour_length_interval),
        (PERSISTENCE, fit.persistence_length, fit.persistence_length_interval),
    ):
        error = (high - low) / 3.92
        assert abs(length - true) < 3.5 * error < 0.05 * true
    assert fit.p_value > 1e-3


@pytest.mark.parametrize(
    ("name", "headings", "message"),
    [
        ("dna.csv", "x [nm],force [pN]", "has 0 columns with the heading extension"),
        ("dna.csv", "extension [nm],force", "force: requires a unit of N"),
        ("dna.csv", "extension [pN],force [pN]", "extension: requires a unit of m"),
        ("dna.txt", "force [pN],force [pN]", "has 0 columns with the heading extension"),
        ("dna.xls", "extension [nm],force [pN]", "must end in .csv"),
    ],
)
def test_other_tables_are_refused(tmp_path, name, headings, message):
    with pytest.raises(ResultError, match=message):
        tweezer.stretch(siggia(), recording=recorded(tmp_path / name, headings))


def test_command_prints_the_lengths_of_a_recording(tmp_path, command_line):
    """The scene has another law, which the findings report."""
    recording = str(recorded(tmp_path / "dna.csv"))
    done = command_line("stretch", "dna-between-beads", "--recording", recording)
    assert done.code == 0
    assert re.search(r"contour length\s+99\d\.\d+ ± 0\.\d+ nm", done.out)
    assert "the residuals exceed the errors" in done.out


def test_recordings_need_samples(tmp_path):
    with pytest.raises(SceneError, match="windows = 500: allowed: from 5 to 200"):
        tweezer.stretch(siggia(), windows=500, recording=recorded(tmp_path / "dna.csv"))


def test_windows_need_samples():
    with pytest.raises(SceneError, match="windows = 100: allowed: from 5 to 50"):
        tweezer.stretch(dna("1 ms", 1001, "10 um/s"), windows=100)
    with pytest.raises(SceneError, match="stretching requires two beads; the scene has 1"):
        tweezer.stretch("silica-1um")
