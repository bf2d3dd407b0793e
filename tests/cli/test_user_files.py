"""Files of users where tweezer reads or writes: of another kind, endless, and not to be lost."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

import tweezer
from tweezer.cli.console import writable_figure
from tweezer.plots.style import new, save
from tweezer.sweeps.cases import cases_of

SHIPPED = tweezer.shipped_scenes()["silica-1um"]


@pytest.fixture(autouse=True)
def _here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def test_scene_file_may_begin_with_a_byte_order_mark():
    Path("mine.toml").write_bytes(b"\xef\xbb\xbf" + SHIPPED.read_bytes())
    assert tweezer.load_scene("mine.toml").bead == tweezer.load_scene("silica-1um").bead


def test_pipes_and_devices_are_refused_immediately():
    """Each where a file of its kind is read: they may never end."""
    motion = "[beam.motion]\nfile = 'path.csv'\n"
    Path("moved.toml").write_text(SHIPPED.read_text() + motion)
    scene = tweezer.load_scene("silica-1um")
    readers = {
        "mine.toml": tweezer.load_scene,
        "mine.json": tweezer.view,
        "mine.nc": tweezer.load_run,
        "mine.csv": tweezer.load_recording,
        "cases.csv": lambda path: tweezer.sweep(scene, cases=path),
        "path.csv": lambda _: tweezer.load_scene("moved.toml"),
    }
    for name, read in readers.items():
        for make in (os.mkfifo, lambda name: Path(name).symlink_to("/dev/zero")):
            make(name)
            with pytest.raises(tweezer.TweezerError, match=r"pipe or a device|no such file"):
                read(name)
            Path(name).unlink()


@pytest.mark.parametrize(
    ("name", "kind"),
    [("track.csv", "a recording, not a"), ("t.npy", "a recording"), ("page.html", "a page"),
     ("t.h5", "a recording"), ("figure.png", "a figure")],
)  # fmt: skip
def test_file_of_another_kind_is_named(name, kind):
    Path(name).write_text("t,x\n0,1\n")
    way = f"use `tweezer calibrate {name}`" if "recording" in kind else ""
    for read in (tweezer.view, tweezer.load_scene, lambda name: tweezer.compare(name, name)):
        with pytest.raises(tweezer.TweezerError, match=rf"{name}'?: is {kind}.*{way}"):
            read(name)
    Path("mine.toml").write_text("")
    with pytest.raises(tweezer.ResultError, match=r"is a scene, not a recording; use `tweezer run"):
        tweezer.load_recording("mine.toml")


def test_many_values_are_compared_and_many_errors_reported_in_few_lines():
    values = np.linspace(1e-6, 2e-6, 40_000)
    assert cases_of({"simulation.loss_distance": values}, None).count == 40_000
    with pytest.raises(tweezer.SceneError, match="is given twice"):
        cases_of({"simulation.loss_distance": [*values, values[7]]}, None)
    with pytest.raises(tweezer.SceneError) as told:
        tweezer.load_scene({f"k{i}": 1 for i in range(20_000)} | {" " * 2500: 1})
    lines = str(told.value).splitlines()
    assert len(lines) == 21
    assert lines[-1].endswith(" more")
    assert max(map(len, lines)) < 300


@pytest.mark.parametrize("ending", ["png", "svg", "pdf"])
def test_only_a_figure_of_tweezer_is_replaced_unasked(ending):
    path = Path(f"figure.{ending}")
    path.write_bytes(b"precious")
    with pytest.raises(tweezer.ResultError, match="already exists and is not a figure of tweezer"):
        writable_figure(path)
    assert writable_figure(path, overwrite=True) == path
    figure = new(3, 2)
    figure.subplots().plot([1, 2])
    save(figure, path, ending)
    assert writable_figure(path) == path


def test_pipe_in_place_of_an_output_stays():
    os.mkfifo("run.nc")
    run = tweezer.simulate(tweezer.load_scene("silica-1um"), duration=1e-6)
    with pytest.raises(tweezer.ResultError, match="cannot be written: is a pipe or a device"):
        tweezer.save_run(run, "run.nc")
    assert Path("run.nc").is_fifo()
