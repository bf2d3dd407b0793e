"""`tweezer info` and `tweezer cache`: what they find, what they name, and what they remove."""

import gc
import getpass
import json
import os
import sys
import time
from importlib.metadata import version
from pathlib import Path

import pytest
from numba.core.dispatcher import Dispatcher

import tweezer
from tweezer.cli import info
from tweezer.compiled import folders
from tweezer.optics.rays.nodes import scratch


@pytest.fixture
def kept(cache_folder, tmp_path_factory, monkeypatch):
    """Files that tweezer keeps, and others: by path, whether it is to be removed."""
    compiled = tmp_path_factory.mktemp("compiled")
    tables = cache_folder / "tweezer" / "tables"
    tables.mkdir(parents=True)
    monkeypatch.setattr(folders, "folders", lambda: [compiled])
    old = time.time() - 3 * 86400
    goes = {}
    for folder, name, is_removed, is_old in (
        (compiled, "loop.march-10.py311.0123456789abcdef.nbc", True, False),
        (compiled, "scaled.rhs-35.py311.nbi", True, False),
        (compiled, "scaled.rhs-35.py311.1.nbc", True, False),
        (compiled, "loop.march-10.py311.0123456789abcdef.nbc.0123456789abcdef", False, False),
        (compiled, "loop.march-11.py311.0123456789abcdef.nbc.0123456789abcdef", True, True),
        (compiled, "loop.cpython-311.pyc", False, True),
        (compiled, "my.nbc", False, False),
        (compiled, "my.data-1.nbi", False, False),
        (tables, f"{32 * 'ab'}.table", True, False),
        (tables, "data.table", False, False),
        (tables, "ab.lock", False, False),
        (tables, ".saving-0123456789abcdef", False, False),
        (tables, ".saving-1123456789abcdef", True, True),
        (tables, "notes.txt", False, True),
        (cache_folder, "of-another.table", False, True),
    ):
        path = folder / name
        path.write_bytes(b"x" * 1000)
        if is_old:
            os.utime(path, (old, old))
        goes[path] = is_removed
    return goes


def test_the_folders_are_those_that_numba_chose():
    scratch()  # a small function, compiled here where nothing was before
    chosen = {
        Path(each.stats.cache_path)
        for each in gc.get_objects()
        if issubclass(type(each), Dispatcher)
        and (each.py_func.__module__ or "").startswith(("tweezer.", "generated."))
        and each.stats.cache_path is not None
    }
    chosen = {path for path in chosen if path.is_dir() and any(path.glob("*.nb?"))}
    assert chosen
    assert chosen <= set(folders.folders())


def test_cache_clears_what_tweezer_keeps_and_nothing_else(command_line, kept):
    listed = command_line("cache")
    assert listed.code == 0
    assert all(path.exists() for path in kept)
    assert [line.split()[-4:-1] for line in listed.out.splitlines() if " MB " in line] == [
        ["4", "0.004", "MB"], ["2", "0.002", "MB"],
    ]  # fmt: skip
    refused = command_line("cache", "--clear")
    assert (refused.code, refused.err) == (2, "--clear: requires --yes without a terminal\n")
    assert all(path.exists() for path in kept)
    done = command_line("cache", "--clear", "--yes")
    assert (done.code, done.out) == (0, "removed 6 files, 0.006 MB\n")
    assert {path: not path.exists() for path in kept} == kept
    assert command_line("cache", "--clear", "--yes").out == "removed 0 files, 0 MB\n"


@pytest.mark.parametrize("level", ["tables", "tweezer", "file"])
def test_cache_follows_no_link(level, command_line, cache_folder, tmp_path, monkeypatch):
    """A folder of tables that leads elsewhere, or a file that does."""
    monkeypatch.setattr(folders, "folders", list)
    victim, name = tmp_path / "victim", f"{64 * 'a'}.table"
    (victim / "tables").mkdir(parents=True)
    for folder in (victim, victim / "tables"):
        (folder / name).write_text("precious")
    own = cache_folder / "tweezer"
    if level == "tweezer":
        own.symlink_to(victim)
    elif level == "tables":
        own.mkdir()
        (own / "tables").symlink_to(victim)
    else:
        (own / "tables").mkdir(parents=True)
        (own / "tables" / name).symlink_to(victim / name)
    assert command_line("cache", "--clear", "--yes").out == "removed 0 files, 0 MB\n"
    assert (victim / name).exists()
    assert (victim / "tables" / name).exists()


def test_at_a_terminal_it_asks_first(command_line, kept, monkeypatch):
    monkeypatch.setattr(sys.stdin, "isatty", lambda: True, raising=False)
    monkeypatch.setattr("typer.confirm", lambda text, abort: (_ for _ in ()).throw(SystemExit(1)))
    assert command_line("cache", "--clear").code == 1
    assert all(path.exists() for path in kept)
    assert command_line("cache", "--clear", "--yes").out.startswith("removed 6 files")


def test_what_cannot_be_removed_is_said(command_line, kept, monkeypatch):
    unlink = Path.unlink

    def refused(path, *rest, **options):
        if path.suffix == ".table":
            raise PermissionError(13, "Permission denied")
        unlink(path, *rest, **options)

    monkeypatch.setattr(Path, "unlink", refused)
    done = command_line("cache", "--clear", "--yes")
    assert done.code == 1
    assert done.out == "removed 5 files, 0.005 MB\n"
    assert done.err == "1 files cannot be removed: Permission denied\n"


def test_info_is_for_a_report_and_names_no_user(command_line, kept, cache_folder, monkeypatch):
    monkeypatch.setenv("HOME", str(cache_folder))
    monkeypatch.setenv("NUMBA_CACHE_DIR", "/scratch/someone/numba")
    monkeypatch.setattr(getpass, "getuser", lambda: "someone")
    told = command_line("info", "--json")
    facts = json.loads(told.out)
    assert facts["tweezer"] == tweezer.__version__
    assert facts["Python"].startswith(sys.version.split()[0])
    assert facts["packages"]["numba"] == version("numba")
    assert facts["packages"]["xarray"] == version("xarray")
    assert facts["cores"]["of the machine"] == os.cpu_count()
    assert facts["compiled functions"]["files"] == 4
    assert facts["maps of forces"] == {"files": 2, "bytes": 2000, "in": ["~/tweezer/tables"]}
    assert facts["settings"]["NUMBA_CACHE_DIR"] == "/scratch/USER/numba"
    assert facts["extras"]["derive"] is True
    assert "bench" not in facts["extras"]
    assert str(cache_folder) not in told.out
    assert "someone" not in told.out
    in_words = command_line("info").out
    assert f"numba {version('numba')}" in in_words
    assert "2 files, 0.002 MB; ~/tweezer/tables" in in_words


def test_info_without_what_a_system_may_lack(monkeypatch):
    monkeypatch.delattr(os, "sched_getaffinity", raising=False)
    monkeypatch.setattr(os, "sysconf", lambda name: (_ for _ in ()).throw(ValueError(name)))
    assert info._cores() == os.cpu_count()
    assert info._memory() is None
    assert info._in_words(None) == "not known"
