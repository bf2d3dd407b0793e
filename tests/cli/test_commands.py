"""The command line: what it imports, prints, writes, and leaves behind when it is stopped."""

from __future__ import annotations

import ctypes
import json
import os
import re
import resource
import signal
import subprocess
import sys
import time
import warnings
from importlib.metadata import version
from pathlib import Path

import numpy as np
import pytest
import typer
import xarray as xr

import tweezer
from tweezer import cli
from tweezer.dynamics.models import EquationsOfMotion
from tweezer.optics import force_map
from tweezer.optics.rays import tabulate
from tweezer.runs import simulation
from tweezer.values.signs import typeset

HEAVY = ["h5netcdf", "matplotlib", "numba", "numpy", "pint", "pydantic", "scipy", "xarray"]
#: the bead of the thesis for a short time
SHORT = ["thesis-990nm", "--duration", "0.2 ms", "--set", "simulation.samples=11"]
#: and long enough to be interrupted on the way, in steps as small as the samples
LONG = ["thesis-990nm", "--duration", "5 ms", "--set", "simulation.samples=101",
        "--set", "simulation.relative_tolerance=1e-12",
        "--set", "simulation.position_tolerance=1e-16"]  # fmt: skip
#: in no time: a bead that nothing but its drag acts on
FREE = ["silica-1um", "--duration", "1 us", "--set", "simulation.samples=3",
        "--set", "forces.optical=false"]  # fmt: skip
#: the figure of `SHORT`
DRAWN = ["--plot", "thesis-990nm.png"]


def without_the_compiler(told):
    """The lines of stderr but the notice that something is compiled, if nothing was kept yet."""
    return [line for line in told.splitlines() if not line.startswith("compiling, once")]


def test_help_imports_nothing_heavy():
    """Of tweezer, of its commands and of theirs; typer itself loads pydantic to read a command."""
    program = f"""
import sys
import typer
from tweezer import cli
commands = typer.main.get_command(cli.app).commands
benches = [("bench", name) for name in commands["bench"].commands]
for names in ((), *((name,) for name in commands), *benches):
    sys.argv[1:] = [*names, "--help"]
    try:
        cli.main()
    except SystemExit as ended:
        print("ended:", ended.code)
        print("imported:", sorted(sys.modules.keys() & set({HEAVY!r})))
"""
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert "Simulate a bead in an optical trap." in done.stdout
    ended = [line for line in done.stdout.splitlines() if line.startswith("ended:")]
    assert len(ended) > 10
    assert set(ended) == {"ended: 0"}
    imported = [line for line in done.stdout.splitlines() if line.startswith("imported:")]
    assert imported == ["imported: []", *["imported: ['pydantic']"] * (len(ended) - 1)]
    assert not done.stderr


def test_commands_import_what_they_use(tmp_path):
    """The garbage collector also skips the objects that an import makes."""
    program = """
import gc, sys
from tweezer import cli
try:
    cli.main()
except SystemExit:
    unused = {"dask", "matplotlib", "pint", "scipy.stats", "xarray"}
    of_motion = {"pandas", "scipy.integrate", "scipy.optimize"}
    unused |= {"numba"} if sys.argv[1] == "calibrate" else of_motion
    print(sorted(sys.modules.keys() & unused), gc.isenabled(), gc.get_freeze_count() > 20_000)
"""
    recording = Path(cli.__file__).parents[1] / "examples" / "trapped-bead.csv"
    known = ["--temperature", "293 K", "--radius", "0.5 um", "--viscosity", "1 mPa s"]
    calibrate = ["calibrate", str(recording), *known, "--blur", "0"]
    for arguments in (["run", *FREE], ["trap", FREE[0]], calibrate):
        done = subprocess.run(
            [sys.executable, "-c", program, *arguments],
            cwd=tmp_path, capture_output=True, text=True, check=True,
        )  # fmt: skip
        assert done.stdout.splitlines()[-1] == "[] True True"


@pytest.mark.parametrize(
    ("command", "options"),
    [("run", ["--duration", "--model", "--method", "--set", "--out", "--plot"]),
     ("trap", ["--set", "--out", "--plot"]),
     ("map", ["--set"])],
)  # fmt: skip
def test_help_names_every_option(command_line, command, options):
    outcome = command_line(command, "--help")
    assert outcome.code == 0
    for option in options:
        assert option in outcome.out
    assert "--set KEY=VALUE" in outcome.out
    assert "May be repeated" in " ".join(outcome.out.split())


@pytest.mark.parametrize("command", [["tweezer"], ["tweezer", "bench"]], ids=" ".join)
def test_summaries_are_whole(command_line, command):
    """On the site's page too, which has 45 columns for them."""
    outcome = command_line(*command[1:], "--help")
    listed = outcome.out.partition("Commands:\n")[2].splitlines()
    assert len(listed) >= 5
    for line in listed:
        summary = line.split(maxsplit=1)[1]
        assert summary.endswith(".")
        assert len(summary) <= 45
        assert not summary.endswith("...")


def test_the_version(tmp_path):
    expected = version("tweezer")
    assert tweezer.__version__ == expected
    program = [sys.executable, "-m", "tweezer", "--version"]
    told = subprocess.run(program, cwd=tmp_path, capture_output=True, text=True, check=True)
    assert (told.stdout, told.stderr) == (f"tweezer {expected}\n", "")


def test_shells_can_complete_commands(tmp_path):
    asked = {"_TWEEZER_COMPLETE": "complete_bash", "COMP_WORDS": "tweezer cal", "COMP_CWORD": "1"}
    program = [sys.executable, "-c", "import sys; sys.argv = ['tweezer']\n"
               "from tweezer.cli import main; main()"]  # fmt: skip
    told = subprocess.run(
        program, cwd=tmp_path, env=os.environ | asked, capture_output=True, text=True, check=True
    )
    assert told.stdout.split() == ["calibrate"]


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a device that is full")
def test_output_that_cannot_be_written_is_one_line(tmp_path):
    with Path("/dev/full").open("w") as full:
        told = subprocess.run(
            [sys.executable, "-m", "tweezer", "scenes"],
            cwd=tmp_path, stdout=full, stderr=subprocess.PIPE, text=True, check=False,
        )  # fmt: skip
    assert told.returncode == 1
    assert told.stderr == "cannot write to standard output: No space left on device\n"


def test_scenes_lists_all(command_line):
    outcome = command_line("scenes")
    assert (outcome.code, outcome.err) == (0, "")
    for name in tweezer.shipped_scenes():
        assert re.search(rf"^ +{name} +\S", outcome.out, re.MULTILINE)
    folder = Path(outcome.out.splitlines()[-1].partition(": ")[2])
    assert {path.stem for path in folder.glob("*.toml")} == set(tweezer.shipped_scenes())


def test_run_writes_a_trajectory_and_a_figure_and_prints_a_table(command_line):
    outcome = command_line("run", *SHORT, *DRAWN, "--details")
    assert (outcome.code, outcome.err) == (0, "")
    assert sorted(path.name for path in Path().iterdir()) == [
        "thesis-990nm.nc", "thesis-990nm.png",
    ]  # fmt: skip
    run = tweezer.load_run("thesis-990nm.nc")
    assert run["time"].values == pytest.approx(np.linspace(0, 0.2e-3, 11), rel=1e-12)
    assert (run.attrs["status"], run.attrs["model"]) == ("complete", "scaled")
    assert Path("thesis-990nm.png").read_bytes().startswith(b"\x89PNG")
    x, y, z = np.round(1e6 * run["position"].values[-1], 4) + 0.0
    for row, value in {
        "outcome": "not captured, 0.2 ms",
        r"end \(x, y, z\)": f"{x:.4f}, {y:.4f}, {z:.4f} µm from the focus",
        "overshoot past the axis": "0 µm",
        "first closest approach": "none",
        "model, method": "scaled, a2 = 0.0012; dormand-prince",
        "steps": f"{run.attrs['steps']}",
        "force calls": f"{run.attrs['force_calls']}",
    }.items():
        assert re.search(rf"^ +{row} +{re.escape(value)} *$", outcome.out, re.MULTILINE), row
    told = re.search(r"largest Reynolds number +(\S+) *$", outcome.out, re.MULTILINE)
    summary = tweezer.summarise(run)
    assert float(told[1]) == pytest.approx(summary.largest_reynolds_number, rel=5e-4)
    assert 0 < summary.largest_reynolds_number_error < 1e-4 * summary.largest_reynolds_number
    written = [each for each in outcome.out.splitlines() if each.startswith("wrote")]
    assert written == ["wrote thesis-990nm.png", "wrote thesis-990nm.nc"]


def test_every_option_has_its_effect(command_line):
    Path("results").mkdir()
    outcome = command_line(
        "run", "thesis-990nm", "--duration", "1e-4",
        "--model", "overdamped", "--method", "scipy:LSODA",
        "--set", "simulation.samples=7", "--set", "beam.power = 80 mW",
        "--out", "results/bead.nc", "--plot", "results/bead.pdf",
    )  # fmt: skip
    assert outcome.code == 0
    assert sorted(str(path) for path in Path().rglob("*.*")) == [
        "results/bead.nc", "results/bead.pdf",
    ]  # fmt: skip
    run = tweezer.load_run("results/bead.nc")
    simulation = tweezer.scene_of(run).simulation
    assert (simulation.duration, simulation.samples) == (1e-4, 7)
    assert (simulation.model, simulation.method) == ("overdamped", "scipy:LSODA")
    assert tweezer.scene_of(run).beam.power == 0.08
    assert run.sizes["time"] == 7
    assert (run.attrs["model"], run.attrs["method"]) == ("overdamped", "scipy:LSODA")
    assert run.attrs["emitted_module"] == "overdamped_translation"
    np.testing.assert_allclose(run["speed"], run["terminal_speed"], rtol=1e-12)
    assert Path("results/bead.pdf").read_bytes().startswith(b"%PDF")


def test_a_scene_file_names_its_results(command_line):
    text = tweezer.shipped_scenes()["silica-1um"].read_text(encoding="utf-8")
    Path("mine.toml").write_text(text, encoding="utf-8")
    Path("other.toml").write_text(f'name = "my bead"\n{text}', encoding="utf-8")
    for scene in ("mine.toml", "other.toml"):
        options = ["--duration", "10 us", "--set", "simulation.samples=3"]
        assert command_line("run", scene, *options).code == 0
    assert {path.name for path in Path().iterdir()} == {
        "mine.toml", "mine.nc", "other.toml", "my bead.nc",
    }  # fmt: skip


def test_names_are_printed_as_they_stand(command_line):
    """No bracket or colon in them is read as a colour or a picture."""
    Path("out[").mkdir()
    names = ["out[/b].nc", "out[bold]:smile:.png"]
    text = tweezer.shipped_scenes()["thesis-990nm"].read_text(encoding="utf-8")
    Path("a[red]:bee:.toml").write_text(text, encoding="utf-8")
    outcome = command_line(
        "run", "a[red]:bee:.toml", *SHORT[1:], "--out", names[0], "--plot", names[1]
    )
    assert outcome.code == 0
    wrote = [line for line in outcome.out.splitlines() if line.startswith("wrote ")]
    assert sorted(wrote) == sorted(f"wrote {name}" for name in names)
    assert "a[red]:bee:" in outcome.out
    assert all(Path(name).is_file() for name in names)


def test_a_terminal_without_a_width_is_a_usual_one(monkeypatch):
    monkeypatch.setenv("COLUMNS", "0")
    assert cli.console._console(stderr=False).width == 80


def test_a_bare_number_that_is_unusual_is_said(command_line):
    with warnings.catch_warnings():
        warnings.simplefilter("always")
        outcome = command_line("trap", "silica-1um", "--set", "beam.power=80", "--out", "no/k.json")
    said = 'warning: beam.power = 80 is 80 W; 80 mW is written "80 mW"\n'
    assert outcome.err.startswith(said)


def test_the_scene_of_the_command_line_is_the_scene_of_python(command_line):
    assert command_line("run", *SHORT).code == 0
    scene = tweezer.load_scene("thesis-990nm").replace(simulation={"samples": 11})
    expected = tweezer.simulate(scene, duration="0.2 ms")
    xr.testing.assert_identical(
        tweezer.load_run("thesis-990nm.nc").drop_attrs(), expected.drop_attrs()
    )


def content(*names):
    return [Path(name).read_bytes() for name in names]


def test_a_rerun_replaces_the_files(command_line):
    assert command_line("run", *SHORT).code == 0
    Path("thesis-990nm.png").write_text("no figure of tweezer")
    first = Path("thesis-990nm.nc").stat().st_ino
    refused = command_line("run", *SHORT, *DRAWN)
    assert refused.err.startswith(
        "thesis-990nm.png: already exists and is not a figure of tweezer; "
    )
    for overwrite in (["--overwrite"], []):  # the second time it is one
        assert command_line("run", *SHORT, *DRAWN, *overwrite).code == 0
        assert Path("thesis-990nm.nc").stat().st_ino != first
    assert Path("thesis-990nm.png").read_bytes().startswith(b"\x89PNG")
    assert len(list(Path().iterdir())) == 2


def test_a_run_of_other_settings_is_not_replaced(command_line):
    to = ["--out", "a.nc", "--plot", "a.png"]
    assert command_line("run", *FREE, *to).code == 0
    before = content("a.nc", "a.png")
    other = ["run", *FREE, "--duration", "2 us", *to]
    refused = command_line(*other)
    assert (refused.code, refused.out) == (2, "")
    assert refused.err == (
        "a.nc: already holds a run with simulation.duration = 1 us; choose another --out or pass "
        "--overwrite\n"
    )
    assert content("a.nc", "a.png") == before
    assert command_line(*other, "--overwrite").code == 0
    assert all(new != old for new, old in zip(content("a.nc", "a.png"), before, strict=True))
    assert sorted(path.name for path in Path().iterdir()) == ["a.nc", "a.png"]


def test_familiar_words_stand_for_commands_options_and_keys(command_line):
    setting = ["--set", "lens.NA=1.1", "--set", "bead.size=0.9 um"]
    done = command_line("characterise", "silica-1um", *setting, "--json", "trap.json")
    assert done.code == 0
    scene = tweezer.load_scene(json.loads(Path("trap.json").read_text())["scene"])
    assert scene.lens.numerical_aperture == 1.1
    assert scene.bead.radius == pytest.approx(0.45e-6)


def test_thermal_motion_at_a_rate_takes_two_options(command_line):
    options = ["--thermal", "--rate", "100 kHz", "--seed", "3", "--duration", "0.2 ms"]
    assert command_line("run", "silica-1um", *options).code == 0
    run = tweezer.load_run("silica-1um.nc")
    assert (run.sizes["time"], run.attrs["seed"]) == (21, 3)
    scene = tweezer.load_scene(json.loads(run.attrs["scene_as_given"]))
    assert scene.forces.brownian
    assert scene.optics.evaluator == "map"


def test_a_file_that_is_no_run_is_not_replaced(command_line):
    Path("a.nc").write_text("an old file")
    refused = command_line("run", *FREE, "--out", "a.nc")
    assert (refused.code, refused.out) == (2, "")
    assert refused.err.startswith(
        "a.nc: already exists, and is no run that can be compared; choose "
    )
    assert Path("a.nc").read_text() == "an old file"
    assert command_line("run", *FREE, "--out", "a.nc", "--overwrite").code == 0
    assert tweezer.load_run("a.nc").sizes["time"] == 3


KNOWN_BEAD = ("--temperature", "20 degC", "--radius", "500 nm", "--viscosity", "1 mPa s")


@pytest.mark.parametrize(
    ("option", "name", "arguments"),
    [("--out", "a.json", ("trap", "silica-1um")),
     ("--out", "a.nc", ("trap", "silica-1um", "--heights", "1 um", "3 um")),
     ("--out", "a.json", ("tune", "thesis-990nm")),
     ("--out", "a.json", ("fit", "none.csv", "--free", "bead.diameter")),
     ("--out", "a.json", ("fit-depth", "none.csv", "--scene", "thesis-990nm")),
     ("--out", "a.json", ("calibrate", "none.csv", *KNOWN_BEAD)),
     ("--report", "a.html", ("calibrate", "none.csv", *KNOWN_BEAD))],
    ids=lambda given: given if isinstance(given, str) else given[0],
)  # fmt: skip
def test_a_result_that_is_there_is_not_replaced(command_line, option, name, arguments):
    Path(name).write_text("the only copy")
    refused = command_line(*arguments, option, name)
    assert (refused.code, refused.out) == (2, "")
    assert refused.err == f"{name}: already exists; choose another {option} or pass --overwrite\n"
    assert Path(name).read_text() == "the only copy"


def test_whoever_writes_a_result_takes_overwrite_or_resume():
    """But `reproduce` and the benchmarks, which measure again."""
    commands = typer.main.get_command(cli.app).commands
    writing = {
        name: options
        for name, command in commands.items()
        if (options := {option for each in command.params for option in each.opts})
        & {"--out", "--report"}
    }
    assert {"run", "trap", "calibrate", "ensemble", "reproduce"} <= set(writing)
    neither = {name for name, each in writing.items() if not each & {"--overwrite", "--resume"}}
    assert neither == {"reproduce"}
    said = {
        option.help
        for name in writing
        for option in commands[name].params
        if "--overwrite" in option.opts
    }
    assert len(said) == 1


def test_a_run_that_another_has_written_meanwhile_is_not_replaced(command_line, monkeypatch):
    sound = cli.runs.followed_with_progress

    def while_another_runs(*arguments):
        Path("a.nc").write_text("of another process")
        return sound(*arguments)

    monkeypatch.setattr(cli.runs, "followed_with_progress", while_another_runs)
    outcome = command_line("run", *FREE, "--out", "a.nc", "--plot", "a.png")
    assert outcome.code == 0
    written = [each for each in outcome.out.splitlines() if each.startswith("wrote")]
    assert written == ["wrote a-2.png", "wrote a-2.nc"]
    assert Path("a.nc").read_text() == "of another process"


def test_the_figure_and_the_result_come_before_the_slow_errors(command_line, monkeypatch):
    sound = simulation.force_errors

    def after_the_figure(*arguments):
        assert Path("a.png").exists()
        assert not Path("a.nc").exists()
        return sound(*arguments)

    monkeypatch.setattr(simulation, "force_errors", after_the_figure)
    outcome = command_line(
        "run", *FREE, "--model", "overdamped", "--out", "a.nc", "--plot", "a.png"
    )
    assert outcome.code == 0
    result, errors = outcome.out.split("wrote a.png")
    assert "outcome" in result
    assert "deviation from full inertia" in errors


def test_a_figure_that_fails_leaves_the_run(command_line, monkeypatch):
    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr("tweezer.plots.run_figure", interrupted)
    outcome = command_line("run", *FREE, "--out", "a.nc", "--plot", "a.png")
    assert outcome.code == 130
    assert "interrupted: wrote a.nc" in outcome.err
    assert np.isnan(tweezer.load_run("a.nc").attrs["model_error"])


def test_an_output_that_is_a_link_is_refused(command_line):
    Path("thesis.tex").write_text("precious")
    for name in ("a.nc", "a.png", "a.json", "a.zarr"):
        Path(name).symlink_to("thesis.tex")
    thermal = [*FREE, "--set", "forces.brownian=true", "--trajectories", "3"]
    for name, arguments in (
        ("a.nc", ["run", *FREE, "--out", "a.nc", "--overwrite"]),
        ("a.png", ["run", *FREE, "--plot", "a.png"]),
        ("a.json", ["trap", "silica-1um", "--out", "a.json"]),
        ("a.zarr", ["ensemble", *thermal, "--out", "a.zarr"]),
        ("a.nc", ["ensemble", *thermal, "--statistics", "--out", "a.nc"]),
    ):
        refused = command_line(*arguments)
        assert (refused.code, refused.out) == (2, "")
        assert refused.err == f"{name}: is a link; give its target instead: thesis.tex\n"
    assert Path("thesis.tex").read_text() == "precious"
    assert len(list(Path().iterdir())) == 5


def test_an_interrupted_run_keeps_what_it_reached(command_line, monkeypatch):
    times_reported = []

    def interrupt_after(self, task, completed=0.0, **told):
        times_reported.append(completed)
        if completed > 2e-3:
            raise KeyboardInterrupt

    monkeypatch.setattr("rich.progress.Progress.update", interrupt_after)
    outcome = command_line("run", *LONG, *DRAWN)
    assert outcome.code == 130
    (line,) = outcome.err.splitlines()
    assert re.fullmatch(
        r"thesis-990nm: interrupted at 0\.00\d+ s; "
        r"the trajectory so far was saved to thesis-990nm\.nc",
        line,
    )
    run = tweezer.load_run("thesis-990nm.nc")
    assert run.attrs["status"] == "interrupted"
    assert 2e-3 <= run["time"].values[-1] <= max(times_reported) < 5e-3
    assert np.isfinite(run["position"]).all()
    assert Path("thesis-990nm.png").is_file()
    assert re.search(r"interrupted, \d\.?\d* ms", outcome.out)
    before = content("thesis-990nm.nc", "thesis-990nm.png")
    for number in (2, 3):  # a run that has not ended replaces none, though it may be asked to
        again = command_line("run", *LONG, *DRAWN, "--overwrite")
        assert again.code == 130
        assert again.err.endswith(
            f"; the trajectory so far was saved to thesis-990nm-{number}.nc\n"
        )
        assert tweezer.load_run(f"thesis-990nm-{number}.nc").attrs["status"] == "interrupted"
        assert Path(f"thesis-990nm-{number}.png").is_file()
    assert content("thesis-990nm.nc", "thesis-990nm.png") == before


@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM"])
def test_an_interrupt_from_outside(name, tmp_path):
    program = (
        "import os, signal\n"
        "from rich.progress import Progress\n"
        "from tweezer.cli import main\n"
        "def update(self, task, completed=0.0, **told):\n"
        f"    if completed > 1e-3: os.kill(os.getpid(), signal.{name})\n"
        "Progress.update = update\n"
        "main()\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program, "run", *LONG],
        cwd=tmp_path, capture_output=True, text=True, check=False,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )  # fmt: skip
    assert done.returncode == 130
    caveat, line = without_the_compiler(done.stderr)
    assert "wavelengths across" in caveat
    assert "interrupted at 0.00" in line
    run = tweezer.load_run(tmp_path / "thesis-990nm.nc")
    assert run.attrs["status"] == "interrupted"
    assert 1e-3 <= run["time"].values[-1] < 5e-3


def interrupted(*_, **__):
    raise KeyboardInterrupt


@pytest.mark.parametrize("compiled", [False, True])
@pytest.mark.parametrize(
    ("arguments", "at"),
    [
        (["run", *SHORT], "tweezer.dynamics.solution.Solver.__init__"),  # where loops are compiled
        (["view", *SHORT[:1], "--out", "a.html"], "tweezer.dynamics.solution.Solver.__init__"),
        (["run", *FREE, "--set", "forces.brownian=true"], "tweezer.dynamics.walk.Walk.filmed"),
        (["trap", *SHORT[:1], "--out", "a.json"], "tweezer.trap.characterise"),
        (["ensemble", *FREE, "--trajectories", "2"], "tweezer.scene.arguments.check_ensemble"),
        (["sweep", *SHORT[:1]], "tweezer.sweeps.sweep"),
        (["calibrate", "a.csv"], "tweezer.reading.load_recording"),
    ],
)
def test_an_interrupt_before_anything_is_reached(
    command_line, monkeypatch, arguments, at, compiled
):
    monkeypatch.setattr(at, interrupted)
    monkeypatch.setattr("tweezer.compiled.compiling.kept", lambda: compiled)
    outcome = command_line(*arguments)
    assert (outcome.code, outcome.out) == (130, "")
    kept = "; what was compiled so far is kept" if compiled else ""
    assert without_the_compiler(outcome.err) == [f"interrupted: nothing was written{kept}"]
    assert not list(Path().iterdir())


def test_an_interrupt_while_the_line_is_read(command_line, monkeypatch):
    monkeypatch.setattr("typer.core.TyperGroup.parse_args", interrupted)
    monkeypatch.setattr("tweezer.compiled.compiling.kept", lambda: False)
    outcome = command_line("scenes")
    assert (outcome.code, outcome.err) == (130, "interrupted: nothing was written\n")


def test_an_interrupt_after_a_file_is_written(command_line, monkeypatch):
    monkeypatch.setattr("tweezer.plots.run_figure", interrupted)
    outcome = command_line("run", *FREE, *DRAWN)
    assert outcome.code == 130
    assert outcome.err.splitlines()[-1].startswith("interrupted: wrote silica-1um.nc")
    assert [path.name for path in Path().iterdir()] == ["silica-1um.nc"]


@pytest.mark.parametrize(
    ("compiled", "kept"), [(False, ""), (True, "; what was compiled so far is kept")]
)
def test_an_interrupt_after_a_file_is_in_its_folder(command_line, monkeypatch, compiled, kept):
    def write_one(_what, out, **_):
        (out / "figure-5.1.png").touch()
        raise KeyboardInterrupt

    Path("figures").mkdir()
    Path("figures/of-before.png").touch()
    monkeypatch.setattr("tweezer.thesis.reproduce", write_one)
    monkeypatch.setattr("tweezer.compiled.compiling.kept", lambda: compiled)
    outcome = command_line("reproduce", "5.1", "--out", "figures")
    assert (outcome.code, outcome.err) == (130, f"interrupted: wrote figures{kept}\n")


def test_an_interrupt_that_python_ignores_is_made_again(monkeypatch):
    """In a callback, such as those of Numba's compiler, an exception ends nothing."""
    monkeypatch.setattr(sys, "unraisablehook", cli._interrupt_again)
    callback = ctypes.CFUNCTYPE(None)(lambda: signal.raise_signal(signal.SIGINT))

    def called():
        callback()
        for _ in range(1000):
            time.sleep(0.01)

    # a shell starts what runs in the background with interrupts ignored
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with pytest.raises(KeyboardInterrupt):
            called()
    finally:
        signal.signal(signal.SIGINT, before)


@pytest.mark.parametrize(
    "method", ["scipy:RK45", "scipy:DOP853", "scipy:Radau", "scipy:BDF", "scipy:LSODA"]
)
def test_a_failed_run_keeps_what_it_reached(command_line, monkeypatch, method):
    sound = EquationsOfMotion._inputs

    def inputs_that_fail_near_the_focus(self, names):
        evaluate = sound(self, names)

        def inputs(times, states):
            near = np.linalg.norm(states[:, :3], axis=1).min() < 4e-6
            return [
                np.full_like(value, np.nan) if near else value for value in evaluate(times, states)
            ]

        return inputs

    monkeypatch.setattr(EquationsOfMotion, "_inputs", inputs_that_fail_near_the_focus)
    outcome = command_line(
        "run", "thesis-990nm", "--method", method, "--set", "simulation.samples=1201", *DRAWN,
    )  # fmt: skip
    assert outcome.code == 1
    (line,) = outcome.err.splitlines()
    assert re.fullmatch(
        r"thesis-990nm: failed after \S+ s: \S.*; "
        r"the trajectory so far was saved to thesis-990nm\.nc",
        line,
    )
    run = tweezer.load_run("thesis-990nm.nc")
    assert run.attrs["status"] == "failed"
    assert run.attrs["message"] in line
    assert 1 < run.sizes["time"] < 1201
    assert run["distance"].values[-1] > 4e-6
    assert np.isfinite(run["position"]).all()
    assert Path("thesis-990nm.png").is_file()


@pytest.mark.parametrize(("largest", "name"), [(4096, "a.nc"), (49152, "a.png")])
def test_a_full_disk_leaves_the_old_files(command_line, largest, name):
    """A run is of 46 kB, a figure of more; what is not written is told, and the run's summary."""
    written = ["--out", "a.nc", "--plot", "a.png"]
    assert command_line("run", *SHORT, *written).code == 0
    before = content("a.nc", "a.png")
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (largest, limits[1]))
    try:
        outcome = command_line("run", *SHORT, *written)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert (outcome.code, outcome.err) == (2, f"{name}: cannot be written: File too large\n")
    assert content("a.png") == before[1:]
    assert (content("a.nc") == before[:1]) == (name == "a.nc")
    assert outcome.out.endswith("wrote a.nc\n") == (name == "a.png")
    assert tweezer.load_run("a.nc").attrs["status"] == "complete"
    assert len(list(Path().iterdir())) == 2


@pytest.mark.filterwarnings("default")
def test_a_bead_too_small_for_a_continuum_is_one_warning(command_line):
    done = command_line("run", *SHORT, "--set", "bead.diameter=200 nm")
    assert done.code == 0
    (knudsen,) = done.err.splitlines()
    assert knudsen.startswith("warning: Knudsen number 0.0015 is above 0.001")
    assert "wavelengths across" in done.caveat


def test_a_reader_that_leaves_costs_no_file(tmp_path):
    """As `tweezer run ... | head -1` does."""
    reading, writing = os.pipe()
    os.close(reading)
    done = subprocess.run(
        [sys.executable, "-c", "from tweezer.cli import main; main()", "run", *FREE],
        cwd=tmp_path, stdout=writing, stderr=subprocess.PIPE, text=True, check=False,
    )  # fmt: skip
    os.close(writing)
    assert done.returncode == 1
    assert len(without_the_compiler(done.stderr)) <= 1
    assert {path.name for path in tmp_path.iterdir()} == {"silica-1um.nc"}


@pytest.mark.parametrize(
    ("arguments", "line"),
    [(["run", "silica-1um", "--seed", "3"],
      "seed: requires forces.brownian = true, or a camera or detector with noise"),
     (["run", *FREE, "--set", "forces.brownian=true", "--seed", "-3"],
      "seed = -3: must be a whole number from 0 to 2^63 - 1"),
     (["run", "silica-1um", "--rate", "1 Hz"],
      "--rate '1 Hz': gives less than one sample in 0.004 s; choose a higher rate or a longer "
      "--duration"),
     (["run", "silica-1um", "--rate", "1 kHz", "--set", "simulation.samples=3"],
      "--rate '1 kHz': simulation.samples is set too; give one of the two"),
     (["run", "silica-1um", "--set", "lens.NA=1.1", "--set", "lens.numerical_aperture=1"],
      "lens.numerical_aperture: lens.numerical_aperture is set twice"),
     (["run", "silica-1um", "--set", "lens.NA=1.4"],
      'lens.numerical_aperture = 1.4: must be less than medium.refractive_index = 1.326 for the '
      'sine map; give lens.cover for an oil immersion objective, as `tweezer new --objective '
      '"100x/1.40 oil"` does'),
     (["sweep", "silica-1um", "--over", "beam.power=1mW,2mW", "--skip", "5 ms"],
      "skip: applies to sweeps of ensemble, calibrate, not of trap"),
     (["sweep", "silica-1um", "--over", "beam.power=1mW,2mW", "--seed", "0"],
      "seed: applies to sweeps of run, ensemble, calibrate, not of trap"),
     (["sweep", "silica-1um", "--over", "beam.power=1mW,2mW", "--of", "calibrate",
       "--trajectories", "5"], "trajectories: applies to sweeps of ensemble, not of calibrate"),
     (["trap", "silica-1um", "--heights", "1 um", "30 um", "--count", "1"],
      "--count 1: heights from 1 um to 30 um require 2 or more"),
     (["run", "silica-1um", "--set", "beam.power=1mW", "--set", "beam.power = 2mW"],
      "--set 'beam.power = 2mW': beam.power is set twice"),
     (["run", "silica-1um", "--duration", "1 ms", "--set", "simulation.duration=2ms"],
      "--duration: simulation.duration is set twice, also by --set"),
     (["ensemble", *FREE, "--set", "forces.brownian=true", "--trajectories", "0"],
      "trajectories = 0: must be a whole number from 1 to 1e+09"),
     (["ensemble", *FREE, "--set", "forces.brownian=true", "--trajectories", "3", "--statistics",
       "--skip", "1 s"], "skip = 1.0: must leave at least 2 of the 3 samples")],
)  # fmt: skip
def test_arguments_are_refused_before_the_light_is_bound(
    command_line, monkeypatch, arguments, line
):
    for module in (cli.runs, cli.ensemble):
        monkeypatch.delattr(module, "bind_light")
    outcome = command_line(*arguments)
    assert (outcome.code, outcome.out, outcome.err) == (2, "", f"{line}\n")


def test_trap_prints_what_characterise_tells(command_line):
    changes = "beam.power_through_pupil=80 mW", "optics.theory=rays"
    settings = "--set", changes[0], "--set", changes[1]
    outcome = command_line("trap", "silica-1um", *settings, "--details")
    assert outcome.code == 0
    scene = tweezer.load_scene("silica-1um").replace(
        beam={"power_through_pupil": 80e-3}, optics={"theory": "rays"}
    )
    trap = tweezer.characterise(scene)
    kx, ky, kz = 1e6 * np.diag(trap.equilibrium.stiffness)
    fx, fy, fz = trap.corner_frequencies
    backward, lateral = trap.backward_efficiency, trap.lateral_efficiency
    (unstable,) = [place for place in trap.equilibria if not place.stable]
    for row, value in {
        "power through the pupil": "80 mW, 86.47 % of the beam",
        "backward Q, largest": f"{backward.Q:.4g}, at {1e6 * backward.at:.4g} µm",
        "lateral Q, largest": f"{lateral.Q:.4g}, at {1e6 * lateral.at:.4g} µm",
        "stable equilibrium": f"z = {1e6 * trap.equilibrium.position[2]:.4g} µm, on the axis",
        r"stiffness \(x, y, z\)": f"{kx:.4g}, {ky:.4g}, {kz:.4g} pN/µm",
        "corner frequencies": f"{fx:.4g}, {fy:.4g}, {fz:.4g} Hz",
        "held for": "practically for ever (longer than 1e+20 s)",
        "unstable equilibria": f"z = {1e6 * unstable.position[2]:.4g} µm",
        "error of the force": f"{1e12 * trap.force_error:.1g} pN",
        "force by": "quadrature",
        "light": "rays",
        "  because": "optics.theory = 'rays'",
    }.items():
        assert re.search(rf"^ +{row} +{re.escape(value)} *$", outcome.out, re.MULTILINE), row
    worth = trap.ray_optics
    beside = {"+z": worth.escape_forward, "-z": worth.escape_backward}
    for escape in trap.escapes:
        ends = "over 10" if escape.faint_at is None else f"{1e6 * escape.faint_at:.4g}"
        numbers = [f"{1e12 * escape.force:.4g}", f"{1e6 * escape.force_at:.4g}",
                   f"{escape.energy_kT:.4g}", ends,
                   "{:.2g} to {:.2g}".format(
                       *beside.get(escape.direction, worth.escape_across))]  # fmt: skip
        cells = " +".join(re.escape(text) for text in (escape.direction, *numbers))
        assert re.search(rf"^ +{cells} *$", outcome.out, re.MULTILINE), escape.direction
    across, along = worth.stiffness_across, worth.stiffness_along
    times = "{:.2g} to {:.2g} times that, z {:.2g} to {:.2g} times".format(*across, *along)
    assert re.search(rf"^ +by wave optics +{times} *$", outcome.out, re.MULTILINE)
    assert (outcome.err, outcome.caveat) == ("", f"warning: {typeset(trap.caveat)}\n")
    assert not list(Path().iterdir())


def test_every_number_of_a_trap_of_a_weak_lens_is_marked(command_line):
    weak = "lens.numerical_aperture=0.3"
    outcome = command_line("trap", "silica-1um", "--set", weak, "--set", "optics.theory=rays")
    for row in ("stable equilibrium", "stiffness (x, y, z)", "corner frequencies", "+x ", "-z "):
        (line,) = [line for line in outcome.out.splitlines() if line.lstrip().startswith(row)]
        assert line.rstrip().endswith("not to be trusted"), row


def test_trap_writes_what_it_is_asked_to(command_line):
    Path("mine.json").write_text("an old file")
    outcome = command_line(
        "trap", "silica-1um", "--set", "optics.theory=rays", "--out", "mine.json",
        "--plot", "mine.svg", "--overwrite",
    )  # fmt: skip
    assert outcome.code == 0
    assert outcome.out.splitlines()[-1] == "wrote mine.json and mine.svg"
    assert {path.name for path in Path().iterdir()} == {"mine.json", "mine.svg"}
    assert "<svg" in Path("mine.svg").read_text(encoding="utf-8")
    written = json.loads(Path("mine.json").read_text(encoding="utf-8"))
    scene = tweezer.load_scene("silica-1um").replace(optics={"theory": "rays"})
    assert tweezer.load_scene(written["scene"]) == scene
    trap = tweezer.characterise(scene)
    assert written["trap"]["equilibrium"]["stiffness"][0][0] == trap.equilibrium.stiffness[0][0]
    assert [escape["range"] for escape in written["trap"]["escapes"]] == [
        escape.range for escape in trap.escapes
    ]
    assert written["trap"]["lifetime"] == {
        "time": None, "error": 0.0, "lost_at": trap.reach, "words": "longer than 1e+20 s"
    }  # fmt: skip
    assert written["trap"]["lifetime_caveat"] is None
    assert "scene" not in written["trap"]
    worth = written["trap"]["ray_optics"]
    assert tuple(worth["escape_across"]) == trap.ray_optics.escape_across
    assert Path("mine.svg").stat().st_size < 1e6


def test_trap_tells_off_diagonal_stiffness(command_line):
    settings = ["--set", "beam.polarisation=linear", "--set", 'beam.jones=["1", "1"]']
    outcome = command_line("trap", "silica-1um", *settings)
    assert outcome.code == 0
    scene = tweezer.load_scene("silica-1um").replace(
        beam={"polarisation": "linear", "jones": ["1", "1"]}
    )
    kxy = 1e6 * tweezer.characterise(scene).equilibrium.stiffness[0][1]
    assert f"stiffness, xy             {kxy:.4g} pN/µm" in outcome.out


def test_trap_that_holds_nothing(command_line):
    outcome = command_line(
        "trap", "silica-1um", "--set", "forces.optical=false", "--out", "dark.json"
    )
    assert (outcome.code, outcome.err) == (0, "")
    none = r"^ +equilibrium +no stable equilibrium on the axis within 10 µm of +$"
    assert re.search(none, outcome.out, re.MULTILINE)
    assert "escape" not in outcome.out
    written = json.loads(Path("dark.json").read_text(encoding="utf-8"))["trap"]
    assert (written["equilibrium"], written["equilibria"], written["escapes"]) == (None, [], [])
    Path("dark.json").write_text("a scratch file")
    again = ("trap", "silica-1um", "--set", "forces.optical=false", "--out", "dark.json")
    assert command_line(*again, "--overwrite").code == 0
    assert json.loads(Path("dark.json").read_text(encoding="utf-8"))["trap"] == written


def test_trap_by_the_grid_tells_its_distance_to_the_quadrature(command_line):
    outcome = command_line("trap", "thesis-990nm", "--out", "grid.json")
    assert outcome.code == 0
    error = json.loads(Path("grid.json").read_text(encoding="utf-8"))["trap"]["force_error"]
    shown = re.escape(f"{1e12 * error:.1g} pN")
    assert re.search(rf"^ +error of the force +{shown} *$", outcome.out, re.MULTILINE)


@pytest.mark.parametrize(
    ("arguments", "line"),
    [(["nowhere"], "no scene file 'nowhere', and no shipped scene of that name; shipped: .*"),
     (["silica-1um", "--set", "bead"], "--set 'bead': must be key=value, .*"),
     (["silica-1um", "--set", "beam.power=-1 mW"], r"beam\..*"),
     (["silica-1um", "--out", "trap.nc"], r"trap\.nc: must end in \.json"),
     (["silica-1um", "--plot", "trap.gif"], r"trap\.gif: must end in \.pdf, \.png, \.svg"),
     (["silica-1um", "--out", "no/trap.json"], r"no/trap\.json: no such folder: no")],
)  # fmt: skip
def test_trap_refuses_bad_input_in_one_line(command_line, arguments, line):
    outcome = command_line("trap", *arguments)
    assert (outcome.code, outcome.out) == (2, "")
    assert re.fullmatch(line + r"\n", outcome.err)
    assert not list(Path().iterdir())


#: a map that is made in no time
SMALL_MAP = ["--set", "optics.table_range=0.5", "--set", "optics.table_tolerance=1e-4"]


def test_map_makes_a_map_or_finds_it(command_line, cache_folder):
    """Of a scene that names another evaluator, too."""
    first = command_line("map", "thesis-990nm", *SMALL_MAP, "--details")
    assert (first.code, first.err) == (0, "")
    again = command_line("map", "thesis-990nm", *SMALL_MAP, "--details")
    assert again.out == first.out
    scene = tweezer.load_scene("thesis-990nm").replace(
        optics={"evaluator": "map", "table_range": 0.5, "table_tolerance": 1e-4}
    )
    made = force_map(scene)
    error = made.certified_error
    for row, value in {
        "largest force": f"{1e12 * made.largest_force:.4g} pN",
        "certified error": f"{1e12 * error:.2g} pN, {error / made.largest_force:.2g} of the ",
        "range": "0.2475 µm from the focus",
        "pieces": f"{made.pieces}",
        "size of the file": f"{made.path.stat().st_size / 1e6:.2g} MB",
        "time to make": f"{made.build_time:.2g} s",
    }.items():
        assert re.search(rf"^ +{row} +{re.escape(value)}", first.out, re.MULTILINE), row
    assert first.out.splitlines()[-1] == f"kept in {made.path}"
    assert list(cache_folder.rglob("*.table")) == [made.path]


@pytest.mark.usefixtures("cache_folder")
def test_map_without_a_place_to_keep_it(command_line, monkeypatch, tmp_path):
    (tmp_path / "file").touch()
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    with warnings.catch_warnings():
        warnings.simplefilter("always")
        outcome = command_line("map", "silica-1um", *SMALL_MAP)
    assert outcome.code == 0
    assert re.fullmatch(r"warning: .*\.table: the table is not saved: .*\n", outcome.err)
    assert "file" not in outcome.out


@pytest.mark.parametrize(
    ("settings", "line"),
    [(["beam.polarisation=linear", "optics.theory=rays"], "optics.evaluator = .map.: rays need .*"),
     (["beam.power_through_pupil=0"], "optics.evaluator = 'map': requires light, .*"),
     (["optics.evaluator=grid"], "optics.evaluator = 'grid': must be 'map' .*"),
     (["bead.shape=spheroid", "bead.length=2 um"], "bead.shape = 'spheroid': .* no force map, .*"),
     (["optics.table_range=0.4"], "optics.table_range = 0.4: must be from 0.5 to 20")],
)  # fmt: skip
def test_map_refuses_bad_input_in_one_line(command_line, settings, line):
    options = [option for setting in settings for option in ("--set", setting)]
    outcome = command_line("map", "silica-1um", *options)
    assert (outcome.code, outcome.out) == (2, "")
    assert re.fullmatch(line + r"\n", outcome.err)


@pytest.mark.usefixtures("cache_folder")
def test_run_says_once_that_its_map_misses_the_tolerance(command_line, monkeypatch):
    monkeypatch.setattr(tabulate, "_MOST_PIECES", 60)
    options = ["--set", "optics.evaluator=map", "--set", "optics.table_range=1.5"]
    with warnings.catch_warnings():
        warnings.simplefilter("always")
        outcome = command_line("run", *SHORT, *options)
    assert outcome.code == 0
    assert re.fullmatch(r"warning: the table errs by up to .* = 1e-07\n", outcome.err)
    run = tweezer.load_run("thesis-990nm.nc")
    assert run.attrs["force_evaluator"] == "map"
