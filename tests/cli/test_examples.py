"""`tweezer examples`: recordings that users try, whose right answers are known."""

import shlex
from pathlib import Path

import numpy as np
import pytest

import tweezer
from tests.examples import TRUTH
from tweezer.cli.examples import EXAMPLES, FOLDER


def test_examples_are_listed_and_copied(command_line):
    listed = command_line("examples")
    assert listed.code == 0
    assert all(name in listed.out for name in EXAMPLES)
    done = command_line("examples", "trapped-bead")
    assert (done.code, done.err) == (0, "")
    assert done.out.splitlines()[0] == "wrote trapped-bead.csv"
    assert Path("trapped-bead.csv").read_bytes() == (FOLDER / "trapped-bead.csv").read_bytes()
    again = command_line("examples", "trapped-bead.csv")
    assert again.code == 2
    assert again.err.startswith("trapped-bead.csv: already exists; ")
    assert [command_line("examples", odd).code for odd in (".", "", "../trapped-bead")] == [2] * 3
    wrong = command_line("examples", "bead")
    assert wrong.err == (
        "NAME = 'bead': no such recording; choose from: trapped-bead.csv, free-beads.csv\n"
    )


def test_every_example_is_shipped_and_has_a_truth():
    assert {path.name for path in FOLDER.iterdir()} == set(EXAMPLES) == set(TRUTH)


def test_the_trapped_bead_is_calibrated_right(command_line):
    """Within 3.3 standard errors of the trap of its scene: 1 in 500 seeds fails on two axes."""
    command_line("examples", "trapped-bead.csv")
    command = shlex.split(EXAMPLES["trapped-bead.csv"].command)[1:]
    assert command_line(*command, "--out", "k.json").code == 0
    calibration = tweezer.calibrate(
        "trapped-bead.csv", temperature=293.15, drag=9.4436e-9, exposure=0.0
    )
    scene = tweezer.load_scene("silica-1um").replace(
        beam={"power_through_pupil": TRUTH["trapped-bead.csv"]["power"]}
    )
    trap = np.diag(tweezer.characterise(scene).equilibrium.stiffness)
    for axis, known in zip(calibration.axes, trap, strict=False):
        for estimate in axis.estimates:
            assert estimate.stiffness == pytest.approx(known, abs=3.3 * estimate.uncertainty)
