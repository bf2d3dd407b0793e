"""The command line: what it imports, prints, writes, and leaves behind when it is stopped."""

from __future__ import annotations

import errno
import os
import re
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from matplotlib.figure import Figure

import tweezer
from tweezer import cli
from tweezer.dynamics.models import EquationsOfMotion

HEAVY = ["h5netcdf", "matplotlib", "numba", "numpy", "pint", "pydantic", "scipy", "xarray"]
#: the bead of the thesis for a short time
SHORT = ["thesis-990nm", "--duration", "0.2 ms", "--set", "simulation.samples=11"]
#: and long enough to be interrupted on the way, in steps as small as the samples
LONG = ["thesis-990nm", "--duration", "5 ms", "--set", "simulation.samples=101",
        "--set", "simulation.relative_tolerance=1e-12",
        "--set", "simulation.position_tolerance=1e-16"]  # fmt: skip


def test_help_imports_nothing_heavy():
    program = (
        "import sys; from tweezer.cli import main\n"
        "try: main()\n"
        f"finally: print('imported:', sorted(sys.modules.keys() & set({HEAVY!r})))"
    )
    done = subprocess.run(
        [sys.executable, "-c", program, "--help"], capture_output=True, text=True, check=True
    )
    assert "Simulate a bead in an optical trap." in done.stdout
    assert done.stdout.splitlines()[-1] == "imported: []"
    assert not done.stderr


def test_help_names_every_option(command_line):
    outcome = command_line("run", "--help")
    assert outcome.code == 0
    for option in ("--duration", "--model", "--method", "--set", "--out", "--plot"):
        assert option in outcome.out


def test_scenes_lists_all(command_line):
    outcome = command_line("scenes")
    assert (outcome.code, outcome.err) == (0, "")
    for name in tweezer.shipped_scenes():
        assert re.search(rf"^ +{name} +\S", outcome.out, re.MULTILINE)
    folder = Path(outcome.out.splitlines()[-1].partition(": ")[2])
    assert {path.stem for path in folder.glob("*.toml")} == set(tweezer.shipped_scenes())


def test_run_writes_a_trajectory_and_a_figure_and_prints_a_table(command_line):
    outcome = command_line("run", *SHORT)
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
        r"end \(x, y, z\)": f"{x:.4f}, {y:.4f}, {z:.4f} um from the focus",
        "overshoot past the axis": "0 um",
        "first closest approach": "none",
        "largest Reynolds number": f"{run['reynolds_number'].values.max():.3g}",
        "model, method": "scaled, a2 = 0.0012; RK45",
        "steps": f"{run.attrs['steps']}",
        "force calls": f"{run.attrs['force_calls']}",
    }.items():
        assert re.search(rf"^ +{row} +{re.escape(value)} *$", outcome.out, re.MULTILINE), row
    assert outcome.out.splitlines()[-1] == "wrote thesis-990nm.nc and thesis-990nm.png"


def test_every_option_has_its_effect(command_line):
    Path("results").mkdir()
    outcome = command_line(
        "run", "thesis-990nm", "--duration", "1e-4", "--model", "overdamped", "--method", "LSODA",
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
    assert (simulation.model, simulation.method) == ("overdamped", "LSODA")
    assert tweezer.scene_of(run).beam.power == 0.08
    assert run.sizes["time"] == 7
    assert (run.attrs["model"], run.attrs["method"]) == ("overdamped", "LSODA")
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
        "mine.toml", "mine.nc", "mine.png", "other.toml", "my bead.nc", "my bead.png",
    }  # fmt: skip


def test_the_scene_of_the_command_line_is_the_scene_of_python(command_line):
    assert command_line("run", *SHORT).code == 0
    scene = tweezer.load_scene("thesis-990nm").replace(simulation={"samples": 11})
    expected = tweezer.simulate(scene, duration="0.2 ms")
    xr.testing.assert_identical(
        tweezer.load_run("thesis-990nm.nc").drop_attrs(), expected.drop_attrs()
    )


def test_a_rerun_replaces_the_files(command_line):
    for name in ("thesis-990nm.nc", "thesis-990nm.png"):
        Path(name).write_text("an old file")
    assert command_line("run", *SHORT).code == 0
    assert tweezer.load_run("thesis-990nm.nc").sizes["time"] == 11
    assert Path("thesis-990nm.png").read_bytes().startswith(b"\x89PNG")
    assert len(list(Path().iterdir())) == 2


def test_an_interrupted_run_keeps_what_it_reached(command_line, monkeypatch):
    times_reported = []

    def interrupt_after(self, task, completed):
        times_reported.append(completed)
        if completed > 2e-3:
            raise KeyboardInterrupt

    monkeypatch.setattr("rich.progress.Progress.update", interrupt_after)
    outcome = command_line("run", *LONG)
    assert outcome.code == 130
    (line,) = outcome.err.splitlines()
    assert re.fullmatch(
        r"thesis-990nm: interrupted at 0\.002 s; what was reached is in thesis-990nm\.nc", line
    )
    run = tweezer.load_run("thesis-990nm.nc")
    assert run.attrs["status"] == "interrupted"
    assert 2e-3 <= run["time"].values[-1] <= times_reported[-1] < 2.1e-3
    assert np.isfinite(run["position"]).all()
    assert Path("thesis-990nm.png").is_file()
    assert "interrupted, 2 ms" in outcome.out


def test_an_interrupt_from_outside(tmp_path):
    program = (
        "import os, signal\n"
        "from rich.progress import Progress\n"
        "from tweezer.cli import main\n"
        "def update(self, task, completed):\n"
        "    if completed > 1e-3: os.kill(os.getpid(), signal.SIGINT)\n"
        "Progress.update = update\n"
        "main()\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program, "run", *LONG],
        cwd=tmp_path, capture_output=True, text=True, check=False,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )  # fmt: skip
    assert done.returncode == 130
    (line,) = done.stderr.splitlines()
    assert "interrupted at 0.001" in line
    run = tweezer.load_run(tmp_path / "thesis-990nm.nc")
    assert run.attrs["status"] == "interrupted"
    assert 1e-3 <= run["time"].values[-1] < 1.1e-3


def test_an_interrupt_before_the_first_step_writes_nothing(command_line, monkeypatch):
    def interrupted(scene):
        raise KeyboardInterrupt

    monkeypatch.setattr(cli, "_simulate_with_progress", interrupted)
    outcome = command_line("run", *SHORT)
    assert (outcome.code, outcome.out, outcome.err) == (130, "", "")
    assert not list(Path().iterdir())


@pytest.mark.parametrize("method", ["RK45", "DOP853", "Radau", "BDF", "LSODA"])
def test_a_failed_run_keeps_what_it_reached(command_line, monkeypatch, method):
    sound = EquationsOfMotion._inputs

    def inputs_that_fail_near_the_focus(self, names):
        evaluate = sound(self, names)

        def inputs(state):
            near = np.linalg.norm(state[:3]) < 4e-6
            return [np.full_like(value, np.nan) if near else value for value in evaluate(state)]

        return inputs

    monkeypatch.setattr(EquationsOfMotion, "_inputs", inputs_that_fail_near_the_focus)
    outcome = command_line(
        "run", "thesis-990nm", "--method", method, "--set", "simulation.samples=1201",
    )  # fmt: skip
    assert outcome.code == 1
    (line,) = outcome.err.splitlines()
    assert re.fullmatch(
        r"thesis-990nm: failed after \S+ s: \S.*; what was reached is in thesis-990nm\.nc",
        line,
    )
    run = tweezer.load_run("thesis-990nm.nc")
    assert run.attrs["status"] == "failed"
    assert run.attrs["message"] in line
    assert 1 < run.sizes["time"] < 1201
    assert run["distance"].values[-1] > 4e-6
    assert np.isfinite(run["position"]).all()
    assert Path("thesis-990nm.png").is_file()


def test_a_full_disk_leaves_the_old_files(command_line, monkeypatch):
    def full(self, path, **_):
        Path(path).write_text("half a fi")
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(xr.Dataset, "to_netcdf", full)
    Path("thesis-990nm.nc").write_text("an old run")
    Path("thesis-990nm.png").write_text("an old figure")
    outcome = command_line("run", *SHORT)
    assert outcome.code == 2
    assert outcome.err == "thesis-990nm.nc: cannot be written: No space left on device\n"
    assert Path("thesis-990nm.nc").read_text() == "an old run"
    assert Path("thesis-990nm.png").read_text() == "an old figure"
    assert len(list(Path().iterdir())) == 2


def test_a_figure_that_cannot_be_written_leaves_the_old_one_and_the_run(command_line, monkeypatch):
    def full(self, path, **_):
        Path(path).write_text("half a fi")
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(Figure, "savefig", full)
    Path("thesis-990nm.png").write_text("an old figure")
    outcome = command_line("run", *SHORT)
    assert outcome.code == 2
    assert outcome.err == "thesis-990nm.png: cannot be written: No space left on device\n"
    assert Path("thesis-990nm.png").read_text() == "an old figure"
    assert tweezer.load_run("thesis-990nm.nc").attrs["status"] == "complete"


def test_a_bead_too_small_for_a_continuum_is_one_warning(tmp_path):
    done = subprocess.run(
        [sys.executable, "-c", "from tweezer.cli import main; main()", "run", *SHORT,
         "--set", "bead.diameter=200 nm"],
        cwd=tmp_path, capture_output=True, text=True, check=True,
    )  # fmt: skip
    (line,) = done.stderr.splitlines()
    assert line.startswith("warning: Knudsen number 0.0015 is above 0.001")
