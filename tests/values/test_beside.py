"""Names beside an output, and the files that remain after a failed write."""

from __future__ import annotations

import fcntl
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

import tweezer
from tests import write_faults
from tests.write_faults import content
from tweezer.results.io import write_json
from tweezer.values import files

SCENE = tweezer.load_scene("silica-1um")
THERMAL = SCENE.replace(
    forces={"brownian": True, "optical": False, "gravity": False, "buoyancy": False},
    simulation={"model": "overdamped", "duration": 1e-3, "samples": 5},
)
MAKES = {
    "a.zarr": lambda out, **kind: tweezer.ensemble(THERMAL, 3, out=out, **kind),
    "a.nc": lambda out, **kind: tweezer.ensemble(THERMAL, 3, out=out, statistics=True, **kind),
    "sweep.zarr": lambda out, **kind: tweezer.sweep(
        SCENE, {"bead.diameter": [1e-6]}, out=out, workers=1, **kind
    ),
}


@pytest.mark.parametrize("name", write_faults.KINDS)
def test_failed_write_loses_nothing(name):
    """A sweep has 475 writes, and ensembles have 96 and 31. The test lets some of them fail, and
    `make stress` lets all fail.
    """
    ended = write_faults.at_each_write(
        name, ("full disk", "Ctrl-C"), lambda count: {*range(2, count, 83), count - 4, count - 1}
    )
    assert sum(ended.values()) >= 4


@pytest.mark.parametrize("name", MAKES)
@pytest.mark.parametrize("resume", [False, True])
def test_foreign_file_beside_output_is_refused_and_kept(name, resume, tmp_path):
    """A folder, a file, a link, a pipe of each name; with the names of tweezer's own files within.

    In the end the folder is as it was, and so is what links lead to.
    """
    out, victim = tmp_path / name, tmp_path / "victim"
    victim.mkdir()
    (victim / "thesis.tex").write_text("precious")
    part, lock = Path(f"{out}.part"), Path(f"{out}.lock")

    def folder_with(inner):
        def made():
            part.mkdir()
            inner(part)

        return made

    foreign = {
        "a lock with content": lambda: lock.write_text("precious"),
        "a lock that is a link": lambda: lock.symlink_to(victim / "thesis.tex"),
        "a lock that is a second name": lambda: os.link(victim / "thesis.tex", lock),
        "a lock that leads nowhere": lambda: lock.symlink_to("none"),
        "a lock that is a folder": lock.mkdir,
        "a lock that is a pipe": lambda: os.mkfifo(lock),
        "a file": lambda: part.write_text("precious"),
        "a link": lambda: part.symlink_to(victim),
        "a link that leads nowhere": lambda: part.symlink_to("none"),
        "new": folder_with(lambda part: (part / "new").mkdir()),
        "new-": folder_with(lambda part: (part / "new-0123456789abcdef").mkdir()),
        "journal": folder_with(lambda part: (part / "journal.jsonl").write_text("precious")),
        "journal that is a link": folder_with(
            lambda part: (part / "journal.jsonl").symlink_to(victim / "thesis.tex")
        ),
        "blocks": folder_with(lambda part: (part / "0.npz").write_text("precious")),
        "marker that is a link": folder_with(
            lambda part: [
                (part / f"of-{of}").symlink_to(victim / "thesis.tex")
                for of in ("a-sweep", "an-ensemble")
            ]
        ),
        "marker of another": folder_with(
            lambda part: [
                (part / f"of-{of}").write_text("precious") for of in ("a-sweep", "an-ensemble")
            ]
        ),
    }
    for what, make in foreign.items():
        make()
        before, links = content(tmp_path), sorted(tmp_path.rglob("*"))
        with pytest.raises(tweezer.ResultError, match=r"already exists and (is not|belongs)"):
            MAKES[name](out, resume=resume)
        assert content(tmp_path) == before, what
        assert sorted(tmp_path.rglob("*")) == links, what
        for path in (part, lock):
            if path.is_dir() and not path.is_symlink():
                subprocess.run(["rm", "-r", path], check=True)
            else:
                path.unlink(missing_ok=True)


def test_journal_that_is_foreign_is_refused_in_a_folder_of_its_own(tmp_path):
    """The folder contains a marker, as after an interruption; later files are kept."""
    out, thesis = tmp_path / "s.zarr", tmp_path / "thesis.tex"
    thesis.write_text("precious")
    part = tmp_path / "s.zarr.part"

    def stop(_):
        raise KeyboardInterrupt

    over = {"bead.diameter": [1e-6, 2e-6]}
    tweezer.sweep(SCENE, over, out=out, workers=1, progress=stop)
    journal = part / "journal.jsonl"
    text = journal.read_text()
    for make in (
        lambda: journal.write_text("precious"),
        lambda: journal.symlink_to(thesis),
        lambda: os.link(thesis, journal),
        journal.mkdir,
    ):
        journal.unlink()
        make()
        with pytest.raises(tweezer.ResultError, match="already exists and is not a journal"):
            tweezer.sweep(SCENE, over, out=out, workers=1, resume=True)
        assert thesis.read_text() == "precious"
    journal.rmdir()
    journal.write_text(text)
    (part / "notes.txt").write_text("mine")
    (part / "new").mkdir()
    assert tweezer.sweep(SCENE, over, out=out, workers=1, resume=True).attrs["cases_done"] == 2
    assert sorted(path.name for path in part.iterdir()) == ["new", "notes.txt"]


def test_unfinished_file_of_a_killed_process_is_removed_later(tmp_path):
    """The next write into the folder removes it, but no file of a living process or of the user."""
    dead, file = files._begun(tmp_path)
    file.close()
    alive, writing = files._begun(tmp_path)
    mine = tmp_path / ".saving-0123456789abcdef"
    mine.write_text("precious")
    link, third = files._begun(tmp_path)
    third.close()
    link.unlink()
    link.symlink_to(mine)
    write_json({}, tmp_path / "a.json")
    assert not dead.exists()
    assert {each.name for each in tmp_path.iterdir()} == {
        alive.name, mine.name, link.name, "a.json"
    }  # fmt: skip
    assert mine.read_text() == "precious"
    fcntl.flock(writing, fcntl.LOCK_UN)
    writing.close()


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
def test_process_that_is_terminated_while_it_writes_ends_afterwards(number, tmp_path):
    program = f"""
import os, signal, sys
from pathlib import Path
from tweezer.results.io import write_json
sound = Path.replace
def replace(self, target):
    os.kill(os.getpid(), {number})
    print("goes on", flush=True)
    return sound(self, target)
Path.replace = replace
write_json([1], Path(sys.argv[1]))
print("is too late", flush=True)
"""
    command = [sys.executable, "-c", program, str(tmp_path / "a.json")]
    ended = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (ended.returncode, ended.stdout) == (-number, "goes on\n")
    assert [path.name for path in tmp_path.iterdir()] == ["a.json"]


def test_interrupted_last_write_of_a_sweep_is_reported(tmp_path, monkeypatch):
    out = tmp_path / "s.zarr"
    sound = os.replace

    def interrupted(path, target, **options):
        if str(target) == str(out):
            raise KeyboardInterrupt
        sound(path, target, **options)

    over = {"bead.diameter": [1e-6, 2e-6]}
    with monkeypatch.context() as patch:
        patch.setattr(os, "replace", interrupted)
        found = tweezer.sweep(SCENE, over, out=out, workers=1)
    assert (found.attrs["status"], found.attrs["cases_done"]) == ("interrupted", 2)
    monkeypatch.setattr("tweezer.sweeps.quantities.Asked.compute", None)  # nothing is computed
    found = tweezer.sweep(SCENE, over, out=out, workers=1, resume=True)
    assert found.attrs["status"] == "complete"
