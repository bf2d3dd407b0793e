"""`tweezer new`: what it asks, what it writes without a terminal, and that its scenes are whole."""

import io
import re
import shlex
import sys
import tomllib
from pathlib import Path

import pytest

import tweezer
from tweezer.cli import new
from tweezer.scene import load_scene
from tweezer.scene.materials import materials

#: Radius of the pupil, mm: NA times 200 mm (Nikon), 180 mm (Olympus) or 164.5 mm (Zeiss), over the
#: magnification
PUPILS = {
    "60x/1.20 water": 4.0, "63x/1.20 water": 3.13, "100x/1.30 oil": 2.6, "100x/1.40 oil": 2.52,
    "100x/1.45 oil": 2.9, "40x/0.75 air": 3.75,
}  # fmt: skip


def test_without_a_terminal_it_takes_the_defaults_and_says_so(command_line):
    done = command_line("new")
    assert done.code == 0
    assert done.out.splitlines() == [
        "wrote mine.toml",
        "  tweezer view mine.toml   to see it",
        "  tweezer trap mine.toml   for its trap",
    ]
    assert done.err.splitlines() == [
        "--bead not given: polystyrene",
        "--diameter not given: 1 um",
        "--objective not given: 60x/1.20 water",
        "--laser not given: 1064 nm",
        "--power not given: 50 mW",
        "--depth not given: none",
    ]
    scene = load_scene("mine.toml")
    assert scene.bead.radius == 5e-7
    assert scene.bead.index == pytest.approx(1.5715, abs=1e-4)
    assert scene.medium.refractive_index == pytest.approx(1.326, abs=2e-3)
    assert (scene.lens.radius, scene.lens.numerical_aperture) == (4e-3, 1.2)
    assert scene.beam.power_through_pupil == 0.05


def test_every_bead_and_every_objective_make_a_scene(command_line):
    pairs = [(each, "silica") for each in PUPILS]
    for objective, bead in [*pairs, *(("60x/1.20 water", each) for each in materials())]:
        options = ["--objective", objective, "--bead", bead, "--laser", "980", "--overwrite"]
        done = command_line("new", *options)
        assert done.code == 0, (objective, bead, done.err)
        scene = load_scene("mine.toml")
        assert 1e3 * scene.lens.radius == pytest.approx(PUPILS[objective], abs=5e-3)
        assert scene.beam.sigma == scene.lens.radius / 2
        assert scene.bead.material == bead
        assert (scene.wall is None) == ("oil" not in objective)
        if scene.wall:
            assert scene.wall.position == -scene.lens.cover.depth == pytest.approx(-5e-6)
    assert set(PUPILS) == set(new.OBJECTIVES)


@pytest.mark.parametrize(
    "options",
    [["--bead", "silica", "--diameter", "100 nm"],
     ["--bead", "pmma", "--diameter", "300 nm", "--power", "20 mW"],
     ["--bead", "melamine", "--diameter", "1 um", "--objective", "100x/1.30 oil"]],
)  # fmt: skip
def test_the_duration_is_enough_to_come_to_rest(command_line, options):
    """As the force of the light has it, which `tweezer new` does not compute; not far too long."""
    assert command_line("new", *options).code == 0
    scene = load_scene("mine.toml")
    summary = tweezer.summarise(tweezer.simulate(scene))
    assert summary.outcome == "captured"
    assert 0.1 < summary.outcome_time / scene.simulation.duration < 0.95


def test_a_comment_gives_the_numbers_of_the_material(command_line):
    done = command_line("new", "a b.toml", "--bead", "gold", "--laser", "532")
    assert done.out.count("'a b.toml'") == 2
    text = Path("a b.toml").read_text()
    own = re.search(r"numbers: (refractive_index = .*) and (density = .*)", text)
    assert own.groups() == ('refractive_index = "0.544+2.23j"', 'density = "19300 kg/m^3"')
    with_own = re.sub("material = .*", f"{own[1]}\n{own[2]}", text)
    Path("own.toml").write_text(with_own)
    bead, other = load_scene("a b.toml").bead, load_scene("own.toml").bead
    assert other.index == pytest.approx(bead.index, rel=1e-3)
    assert (other.density, other.material) == (bead.density, None)


def test_a_file_that_is_there_is_kept(command_line):
    Path("mine.toml").write_text("mine")
    done = command_line("new")
    assert (done.code, done.out) == (2, "")
    assert done.err == "mine.toml: already exists; choose another FILE or pass --overwrite\n"
    assert Path("mine.toml").read_text() == "mine"
    assert command_line("new", "--overwrite").code == 0
    assert Path("mine.toml").read_text() != "mine"


@pytest.mark.parametrize(
    ("options", "line"),
    [
        (["mine.txt"], "mine.txt: must end in .toml"),
        (["--bead", "polystirene"], "--bead 'polystirene': did you mean polystyrene?"),
        (["--bead", "wood"], "--bead 'wood': allowed: polystyrene, silica, pmma, melamine, gold, "
                             "silicon"),
        (["--diameter", "1 mw"], "--diameter '1 mw': has an unknown unit; must be"),
        (["--diameter", "5 mm"], "--diameter '5 mm': must be from 2e-09 to 0.002 m"),
        (["--diameter", "1.5"], 'must be from 2e-09 to 0.002 m; for 1.5 um write "1.5 um"'),
        (["--objective", "60x/1.3"], "--objective '60x/1.3': did you mean 100x/1.30 oil?"),
        (["--objective", "100x"], "--objective '100x': did you mean 100x/1.30 oil?"),
        (["--laser", "1550 nm"], "--laser '1550 nm': the index of polystyrene is known from"),
        (["--laser", "1550 nm", "--bead", "silica"], "--laser '1550 nm': the index of water is"),
        (["--power", "20mw"], "did you mean mW?"),
        (["--power", "0 mW"], "--power '0 mW': must be greater than 0"),
        (["--depth", "1 um"], "--depth '1 um': must be more than 1.2 um, for a bead of 1 um"),
        (["--depth", "none", "--objective", "100x/1.40 oil"], "--depth 'none': must be a length"),
    ],
)  # fmt: skip
def test_bad_options_are_one_line(command_line, options, line):
    done = command_line("new", *options)
    assert (done.code, done.out) == (2, "")
    assert line in done.err.splitlines()[-1]
    assert not list(Path().iterdir())


@pytest.mark.parametrize(
    ("option", "text", "named"),
    [("bead", "PS", "polystyrene"), ("bead", "SiO2", "silica"), ("bead", "poly", "polystyrene"),
     ("bead", "Au", "gold"), ("bead", "si", "silicon"),
     ("objective", "60x 1.2", "60x/1.20 water"), ("objective", "100x1.4", "100x/1.40 oil")],
)  # fmt: skip
def test_other_words_and_beginnings_are_understood(option, text, named):
    read = {"bead": new._material, "objective": new._objective}[option]
    assert read(text).name == named


def test_at_a_terminal_numbers_choose_and_enter_accepts_what_was_meant(command_line, monkeypatch):
    answers = ["2", "", "60 water", "", "2", "", ""]
    monkeypatch.setattr(new, "_asks", lambda: True)
    monkeypatch.setattr(sys, "stdin", io.StringIO("\n".join(answers) + "\n"))
    done = command_line("new", "chosen.toml")
    assert done.code == 0
    assert "did you mean 60x/1.20 water? Press Enter to accept." in done.out
    assert "focus depth behind the cover glass (none: far from it) [none]: " in done.out
    scene = load_scene("chosen.toml")
    assert scene.bead.material == "silica"
    assert (scene.lens.radius, scene.lens.numerical_aperture) == (4e-3, 1.2)
    assert scene.beam.wavelength == pytest.approx(980e-9)


def test_at_a_terminal_it_asks_again_after_a_bad_answer(command_line, monkeypatch):
    answers = ["", "1 mw", "2 um", "oil", "100x/1.3 oil", "785", "0.1 W", "none", "8 um"]
    monkeypatch.setattr(new, "_asks", lambda: True)
    monkeypatch.setattr(sys, "stdin", io.StringIO("\n".join(answers) + "\n"))
    done = command_line("new", "big.toml")
    assert done.code == 0
    assert done.out.count("Error: ") + done.err.count("Error: ") == 3
    scene = load_scene("big.toml")
    assert (scene.bead.material, scene.bead.radius) == ("polystyrene", 1e-6)
    assert (scene.lens.numerical_aperture, scene.lens.cover.depth) == (1.3, 8e-6)
    assert (scene.beam.wavelength, scene.beam.power_through_pupil) == (785e-9, 0.1)


def test_the_page_about_the_first_trap_shows_the_written_scene(command_line):
    page = (Path(__file__).parents[2] / "docs" / "first-trap.md").read_text(encoding="utf-8")
    (command,) = re.findall(r"(?s)^tweezer (new .*?[^\\\\])$", page, re.MULTILINE)[:1]
    shown = re.findall(r"(?ms)^```toml\n(.*?)^```$", page)[0]
    assert command_line(*shlex.split(command.replace("\\\n", ""))).code == 0
    written = tomllib.loads(Path("mine.toml").read_text())
    written.pop("description")
    assert tomllib.loads(shown) == written
