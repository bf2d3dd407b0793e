"""What several test files share: a short run, and the command line called in process."""

from __future__ import annotations

import gc
import os
import re
import sys
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import hypothesis
import pytest
import xarray as xr
from xdist.scheduler import LoadScopeScheduling

# what the tests compile knows their types: it is not kept beside the sources, where users look
os.environ.setdefault("NUMBA_CACHE_DIR", str(Path(__file__).parents[1] / ".numba_cache"))

# what commands print is as wide, and as plain, as without a terminal, wherever the tests run; so it
# is in the processes that they start
os.environ.update({"COLUMNS": "80", "LINES": "25"})
os.environ.pop("TERM", None)
os.environ.pop("COLORTERM", None)
os.environ.pop("NO_COLOR", None)
os.environ.pop("FORCE_COLOR", None)
os.environ.pop("TTY_COMPATIBLE", None)
os.environ.pop("TTY_INTERACTIVE", None)

import tweezer
from tests.browsing import chromium
from tweezer import cli

# a drawn example may take any time: the machine may be busy
slow = hypothesis.HealthCheck.too_slow
hypothesis.settings.register_profile("any time", deadline=None, suppress_health_check=[slow])
hypothesis.settings.load_profile("any time")

# Compiling makes many objects beside the many of the test session: collected less often, an eighth
# of the time is saved
gc.set_threshold(100_000, 50, 100)

#: what every command says of ray optics
CAVEAT = re.compile(r"warning: the bead is \S+ wavelengths across")


#: What comes first, in this order: one process compiles what most files need while another does
#: what needs nothing compiled; and none is left alone at the end with a long one
FIRST = [
    "tests/dynamics/test_binding.py",
    "derivation",
    "tests/thesis/test_thesis.py",
    "tests/calibration/test_calibrate.py",
    "tests/calibration/test_detected_bead.py",
    "tests/test_notebooks.py",
    "tests/test_docs.py",
    "tests/test_stress.py",
    "tests/test_site.py",  # its pages that play follow what others have compiled
]


def scope(nodeid: str) -> str:
    """What runs in one process: a file, or all files that derive the equations: once is enough."""
    file = nodeid.partition("::")[0]
    derives = file.startswith(("tests/derivation/", "tests/generated/"))
    return "derivation" if derives else file


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Sort by `FIRST`; all other files stay in their order."""
    names = {name: at for at, name in enumerate(FIRST)}
    items.sort(key=lambda item: names.get(scope(item.nodeid), len(FIRST)))


def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> LoadScopeScheduling:
    """Share the tests out by `scope`."""
    scheduling = LoadScopeScheduling(config, log)
    scheduling._split_scope = scope
    return scheduling


@dataclass(frozen=True)
class Outcome:
    """What a command left behind."""

    code: int | None
    out: str
    err: str
    """without the line about ray optics"""
    caveat: str
    """that line, or nothing"""


@pytest.fixture
def main_undone(monkeypatch) -> Iterator[None]:
    """What `cli.main` sets in a process is set back after the test."""
    monkeypatch.setattr(warnings, "showwarning", warnings.showwarning)
    monkeypatch.setattr(sys, "unraisablehook", sys.unraisablehook)
    yield
    gc.unfreeze()


@pytest.fixture
def command_line(tmp_path, monkeypatch, capsys, main_undone) -> Callable[..., Outcome]:
    """`command_line("run", "scene.toml")`: the command `tweezer` in an empty working directory."""
    monkeypatch.chdir(tmp_path)

    def call(*arguments: str) -> Outcome:
        monkeypatch.setattr(sys, "argv", ["tweezer", *arguments])
        with pytest.raises(SystemExit) as ended:
            cli.main()
        out, err = capsys.readouterr()
        caveat = [line for line in err.splitlines(True) if CAVEAT.match(line)]
        rest = [line for line in err.splitlines(True) if not CAVEAT.match(line)]
        return Outcome(ended.value.code, out, "".join(rest), "".join(caveat))

    return call


@pytest.fixture
def cache_folder(tmp_path_factory, monkeypatch) -> Path:
    """The user's cache folder: an empty one, and no table of the force is in memory."""
    from tweezer.optics.table import _in_memory

    folder = tmp_path_factory.mktemp("cache")
    monkeypatch.setenv("XDG_CACHE_HOME", str(folder))
    _in_memory.clear()
    return folder


@pytest.fixture(scope="session")
def turning_scene() -> tweezer.Scene:
    """Describe a spinning bead with the moment (3.25): every variable and energy is there."""
    return tweezer.load_scene("thesis-990nm").replace(
        beam={"torque": "thesis", "divisions": 20},
        start={"angular_velocity": [300.0, -200.0, 100.0]},
        simulation={"model": "full", "method": "scipy:LSODA", "duration": 0.2e-3, "samples": 21},
    )


@pytest.fixture(scope="session")
def turning_run(turning_scene) -> xr.Dataset:
    """Follow `turning_scene` for 0.2 ms."""
    return tweezer.simulate(turning_scene)


@pytest.fixture(scope="module")
def browser():
    """A Chromium without a window."""
    driver = chromium()
    if driver is None:
        pytest.skip("no chromium and chromedriver on this machine")
    yield driver
    driver.quit()
