"""What several test files share: a short run, and the command line called in process."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Callable
from dataclasses import dataclass

import pytest
import xarray as xr

import tweezer
from tweezer import cli


@dataclass(frozen=True)
class Outcome:
    """What a command left behind."""

    code: int | None
    out: str
    err: str


@pytest.fixture
def command_line(tmp_path, monkeypatch, capsys) -> Callable[..., Outcome]:
    """`command_line("run", "scene.toml")`: the command `tweezer` in an empty working directory."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(warnings, "showwarning", warnings.showwarning)

    def call(*arguments: str) -> Outcome:
        monkeypatch.setattr(sys, "argv", ["tweezer", *arguments])
        with pytest.raises(SystemExit) as ended:
            cli.main()
        out, err = capsys.readouterr()
        return Outcome(ended.value.code, out, err)

    return call


@pytest.fixture(scope="session")
def turning_scene() -> tweezer.Scene:
    """Describe a spinning bead with the moment (3.25): every variable and energy is there."""
    return tweezer.load_scene("thesis-990nm").replace(
        beam={"torque": "thesis", "divisions": 20},
        start={"angular_velocity": [300.0, -200.0, 100.0]},
        simulation={"model": "full", "method": "LSODA", "duration": 0.2e-3, "samples": 21},
    )


@pytest.fixture(scope="session")
def turning_run(turning_scene) -> xr.Dataset:
    """Follow `turning_scene` for 0.2 ms."""
    return tweezer.simulate(turning_scene)
