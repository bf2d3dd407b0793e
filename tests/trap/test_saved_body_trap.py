"""Saved traps of bodies: the file contains the whole trap, and files that are wrong are refused."""

import json
from pathlib import Path

import numpy as np
import pytest

import tweezer
from tweezer.values.saved import DIGEST

pytestmark = pytest.mark.filterwarnings("ignore:Knudsen number")


@pytest.fixture(scope="module")
def trap():
    return tweezer.characterise("flipping-rod")


@pytest.fixture
def file(trap, tmp_path):
    return tweezer.save(trap, tmp_path / "rod.json")


def test_saved_trap_of_a_body_is_the_trap(trap, file):
    found = tweezer.load(file)
    assert found == trap
    assert found.scene == trap.scene
    assert repr(found) == repr(trap)
    held, saved = trap.equilibrium, json.loads(file.read_text())["body_trap"]["equilibrium"]
    assert np.array(saved["stiffness"]).tolist() == np.asarray(held.stiffness).tolist()
    assert saved["orientation"] == np.asarray(held.orientation).tolist()


def test_file_of_the_command_is_loaded_and_compared(trap, tmp_path, command_line):
    for name, power in (("one.json", "20 mW"), ("other.json", "21 mW")):
        change = f"beam.power_through_pupil={power}"
        done = command_line("trap", "flipping-rod", "--set", change, "--out", name, "--quiet")
        assert done.code == 0, done.err
    assert tweezer.load("one.json") == trap
    same = command_line("compare", "one.json", "one.json")
    assert (same.code, "the same numbers" in same.out) == (0, True)
    apart = tweezer.compare("one.json", "other.json")
    assert not apart.agrees
    names = {each.name for each in apart.quantities if not each.agrees}
    # the weight is the same, so the rod rests elsewhere
    escapes = {"escape force", "escape energy"}
    assert names == {"equilibrium", "stiffness", "rotational stiffness", *escapes}
    assert ("beam.power_through_pupil", "0.02", "0.021") in apart.differing
    refused = command_line("view", "one.json", "--out", "one.html")
    assert refused.code == 2
    assert "one.json: is the trap of a body; `tweezer view` accepts" in refused.err


def test_coarser_computation_agrees_within_the_errors(trap):
    """Errors include the difference to another tolerance of the light."""
    other = tweezer.characterise(trap.scene.replace(optics={"tolerance": 1e-5}))
    assert tweezer.compare(trap, other).agrees


def test_traps_of_a_body_and_of_a_sphere_are_not_compared(trap):
    with pytest.raises(tweezer.ResultError, match="first is of kind body trap, and second"):
        tweezer.compare(trap, tweezer.characterise("polystyrene-500nm"))


def _changed(file: Path, change) -> Path:
    saved = json.loads(file.read_text())
    del saved[DIGEST]
    change(saved["body_trap"], saved)
    file.write_text(json.dumps(saved))
    return file


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda trap, _: trap.pop("searched"), "searched"),
        (lambda trap, _: trap.pop("force_error"), "it has no force_error"),
        (lambda trap, _: trap["equilibria"][0].update(orientation=[1, 0, 0]), "orientation: must"),
        (lambda trap, _: trap["equilibria"][0].update(stiffness=[[1.0]]), "stiffness: must"),
        (lambda trap, _: trap["equilibria"].pop(0), "not among its equilibria"),
        (lambda trap, _: trap.update(escapes=[]), "an equilibrium without escapes"),
        (lambda _, saved: saved.update(scene="silica-1um"), "not the trap of a body"),
    ],
)
def test_wrong_file_is_refused_in_one_line(file, change, message):
    with (
        pytest.warns(UserWarning, match="has no digest"),
        pytest.raises(tweezer.ResultError, match=message) as refused,
    ):
        tweezer.load(_changed(file, change))
    assert "\n" not in str(refused.value)


def test_changed_number_is_noticed(file):
    file.write_text(file.read_text().replace("0.02", "0.03", 1))
    with pytest.raises(tweezer.ResultError, match="damaged"):
        tweezer.load(file)
