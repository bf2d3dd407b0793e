"""What shells complete: scenes, keys of `--set` and their values, names."""

import subprocess
import sys
from pathlib import Path

import pytest
import typer

from tweezer import cli
from tweezer.cli.completion import (
    among,
    complete_key,
    complete_scene,
    complete_setting,
    complete_shown,
)
from tweezer.cli.new import OBJECTIVES, _objective
from tweezer.scene import SHIPPED, load_scene, settable, shipped_scenes, with_settings
from tweezer.scene.choices import SWEPT
from tweezer.values.errors import SceneError


def test_scenes_are_the_shipped_ones_and_files_here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert complete_scene("") == [*shipped_scenes()]
    for name in ("silica-mine.toml", "silica.nc", "silicas/a.toml", "silicas/b.txt", ".silica/c"):
        Path(name).parent.mkdir(exist_ok=True)
        Path(name).touch()
    assert complete_scene("sil") == ["silica-1um", "silica-mine.toml", "silicas/"]
    assert complete_shown("silica.") == ["silica.nc"]
    assert complete_shown("silica-1") == ["silica-1um"]
    assert complete_scene("silicas/") == ["silicas/a.toml"]
    assert complete_scene(f"{tmp_path}/silica-") == [f"{tmp_path}/silica-mine.toml"]
    assert complete_scene("nowhere/") == []
    assert f"{SHIPPED}/thesis-500nm.toml" in complete_scene(f"{SHIPPED}/")


def test_settings_are_keys_and_then_their_values():
    assert complete_setting("beam.wav") == ["beam.wavelength="]
    assert complete_setting("bead.dia") == ["bead.diameter="]
    assert complete_setting("lens.cover.d") == ["lens.cover.depth="]
    assert complete_setting("forces.brownian=") == [
        "forces.brownian=true", "forces.brownian=false",
    ]  # fmt: skip
    assert complete_setting("forces.brownian=t") == ["forces.brownian=true"]
    assert complete_setting("optics.th") == [
        "optics.theory=auto", "optics.theory=rays", "optics.theory=waves",
    ]  # fmt: skip
    assert complete_setting("beam.power=") == complete_setting("nothing") == []
    assert complete_key("camera.n") == ["camera.noise", "camera.noise_along"]


def test_every_value_that_is_offered_is_one():
    """Some do not go with this scene, which is another complaint than that of an unknown value."""
    scene = load_scene("silica-1um")
    complaints = []
    for key, choice in ((key, choice) for key, of in settable().items() for choice in of):
        try:
            with_settings(scene, {key: choice})
        except SceneError as error:
            complaints.append(str(error))
    unknown = ("allowed: '", "true or false", "unknown key")
    assert not [each for each in complaints if any(words in each for words in unknown)]


def test_every_key_of_the_shipped_scenes_is_offered():
    for name in shipped_scenes():
        data = load_scene(name).model_dump(exclude_none=True)
        keys = {f"{section}.{key}" for section, of in data.items() if isinstance(of, dict)
                for key, value in of.items() if not isinstance(value, dict)}  # fmt: skip
        assert keys <= settable().keys(), name


def test_names_are_offered_without_spaces_and_understood():
    for name, offered in zip(OBJECTIVES, among(OBJECTIVES)(""), strict=True):
        assert " " not in offered
        assert _objective(offered).name == name


def test_commands_that_take_scenes_and_settings_complete_them():
    commands = typer.main.get_command(cli.app).commands
    for name in ("run", "trap", "tune", "ensemble", "sweep", "map", "fit", "fit-depth"):
        custom = {param.name for param in commands[name].params if param._custom_shell_complete}
        assert {"scene", "set"} <= custom, name


@pytest.mark.parametrize(
    ("words", "values"),  # as Bash parts them
    [
        ("run x --set forces.brownian =", ["true", "false"]),
        ("run x --set optics.theory = w", ["waves"]),
        ("run x --set optics.th", [f"optics.theory={each}" for each in ("auto", "rays", "waves")]),
        ("run silica-", ["silica-1um"]),
        ("new --bead si", ["silica", "silicon"]),
    ],
)
@pytest.mark.usefixtures("main_undone")
def test_what_bash_asks(words, values, monkeypatch, capsys, tmp_path):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("_TWEEZER_COMPLETE", "complete_bash")
    monkeypatch.setenv("COMP_WORDS", "\n".join(["tweezer", *words.split()]))
    monkeypatch.setenv("COMP_CWORD", f"{len(words.split())}")
    cli.main()
    assert capsys.readouterr().out.splitlines() == values


def test_keys_are_completed_without_numbers_and_validators():
    """A shell waits for it."""
    program = """
import os, sys
from tweezer import cli
os.environ |= {"_TWEEZER_COMPLETE": "complete_bash", "COMP_CWORD": "4",
               "COMP_WORDS": "tweezer run silica-1um --set optics.th"}
cli.main()
from tweezer.scene.sections import Beam
print(sorted(sys.modules.keys() & {"numpy", "numba", "scipy", "pint", "xarray", "matplotlib"}))
print(Beam.__pydantic_complete__)
"""
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    *offered, imported, validated = done.stdout.splitlines()
    assert "optics.theory=waves" in offered
    assert (imported, validated) == ("[]", "False")


@pytest.mark.parametrize(
    ("key", "told"),
    [
        ("power", "'power': must be section.key; did you mean beam.power?"),
        ("frequency", "'frequency': must be section.key; did you mean lock_in.frequency?"),
        ("refractive_index", "did you mean bead.refractive_index or medium.refractive_index or "),
        ("colour", "'colour': must be section.key, such as beam.power"),
    ],
)
def test_a_key_without_its_section_is_told_it(key, told):
    with pytest.raises(SceneError) as refused:
        with_settings(load_scene("silica-1um"), {key: "1"})
    assert told in str(refused.value)


def test_quantity_of_a_sweep_is_completed():
    command = typer.main.get_command(cli.app).commands["sweep"]
    (of,) = [each for each in command.params if "--of" in each.opts]
    with command.make_context("sweep", [], resilient_parsing=True) as context:
        offered = of.shell_complete(context, "")
    assert [each.value for each in offered] == [*SWEPT]
