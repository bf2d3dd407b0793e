"""The command `tweezer optimise`: its table, and the files that it writes."""

import re

import numpy as np
import pytest

import tweezer

MASK = np.exp(1j * np.arange(16.0).reshape(4, 4))


@pytest.fixture
def asked(monkeypatch):
    """Replace the search by a known result, and return what it is called with."""
    calls = {}

    def found(scene, goal, *, field, at_least, file, overwrite):
        calls.update(goal=goal, field=field, at_least=at_least, overwrite=overwrite)
        np.save(file, MASK)
        masked = scene.replace(beam={"mask": str(file.absolute()), "mask_kind": "field"})
        return tweezer.Optimum(
            scene=masked, mask=MASK, goal=goal, stiffness=(3e-5, 2e-5, 1e-5),
            without=(1.5e-5, 1e-5, 1e-6), bound=4e-5, linear_range=(1e-7, 2e-7, 3e-7), passed=0.25,
        )  # fmt: skip

    monkeypatch.setattr("tweezer.optics.optimised.optimise", found)
    return calls


def test_optimise_writes_the_mask_and_its_scene(command_line, asked):
    outcome = command_line(
        "optimise", "silica-1um", "--set", "beam.polarisation=linear", "--for", "kx", "--with",
        "phase", "--at-least", "kz=5 pN/um", "--out", "mine.npy",
    )  # fmt: skip
    assert (outcome.code, outcome.err) == (0, "")
    assert asked == {
        "goal": "kx", "field": False, "at_least": {"kz": "5 pN/um"}, "overwrite": False,
    }  # fmt: skip
    words = [re.split(r"\s{2,}", line.strip()) for line in outcome.out.splitlines()]
    rows = {name: values for name, *values in words}
    assert rows["gain in kx"] == ["2"]
    assert rows["part of its upper bound"] == ["75 %"]
    assert rows["light that the mask transmits"] == ["25 %"]
    assert rows["stiffness, pN/µm"] == ["30", "20", "10"]
    assert rows["without the mask, pN/µm"] == ["15", "10", "1"]
    assert rows["linear within 5 % to, nm"] == ["100", "200", "300"]
    assert outcome.out.endswith("wrote mine.npy and mine.toml\n")
    scene = tweezer.load_scene("mine.toml")
    np.testing.assert_array_equal(np.load(scene.beam.mask), MASK)
    assert scene.beam.polarisation == "linear"
    assert scene.name == "mine"
    same = scene.replace(beam={"mask": None, "mask_kind": "phase"}, name="silica-1um")
    expected = tweezer.load_scene("silica-1um").replace(beam={"polarisation": "linear"})
    assert same == expected


@pytest.mark.usefixtures("asked")
def test_optimise_replaces_no_file(command_line, tmp_path):
    (tmp_path / "best-kx.toml").write_text("mine")
    outcome = command_line("optimise", "silica-1um")
    assert (outcome.code, outcome.out) == (2, "")
    assert "best-kx.toml" in outcome.err
    assert not (tmp_path / "best-kx.npy").exists()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--with", "amplitude"), "--with 'amplitude': must be field or phase"),
        (("--at-least", "kz"), "must be key=value, such as kz=5 pN/um"),
    ],
)
@pytest.mark.usefixtures("asked")
def test_wrong_options_are_refused_in_one_line(command_line, words, message):
    outcome = command_line("optimise", "silica-1um", *words)
    assert outcome.code == 2
    assert message in outcome.err
