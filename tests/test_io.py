"""Saved runs: bit for bit, and whole or not at all."""

from __future__ import annotations

import errno
import json
import math
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import tweezer
from tweezer.errors import ResultError
from tweezer.io import write_json


def test_a_run_is_read_back_bit_for_bit(turning_run, tmp_path):
    path = tweezer.save_run(turning_run, tmp_path / "run.nc")
    loaded = tweezer.load_run(path)
    assert set(loaded.variables) == set(turning_run.variables)
    for name, variable in turning_run.variables.items():
        assert loaded[name].dims == variable.dims
        assert loaded[name].attrs == variable.attrs
        assert loaded[name].dtype.kind == variable.dtype.kind
        if variable.dtype.kind == "f":
            assert loaded[name].values.tobytes() == variable.values.tobytes()
        else:
            assert loaded[name].values.tolist() == variable.values.tolist()
    assert {key: np.asarray(value).item() for key, value in loaded.attrs.items()} == (
        turning_run.attrs
    )


def test_the_saved_scene_is_the_scene_of_the_run(turning_run, turning_scene, tmp_path):
    loaded = tweezer.load_run(tweezer.save_run(turning_run, tmp_path / "run.nc"))
    assert tweezer.scene_of(turning_run) == turning_scene
    assert tweezer.scene_of(loaded) == turning_scene


def test_every_variable_says_what_it_is(turning_run):
    of_text = {"axis", "body_axis", "euler_parameter"}
    for name, variable in turning_run.variables.items():
        if name not in of_text:
            assert variable.attrs["units"], name
            assert variable.attrs["long_name"], name


def test_the_attributes_say_how_a_run_was_made(turning_run, turning_scene):
    attributes = turning_run.attrs
    assert attributes["title"] == turning_scene.description
    assert (attributes["model"], attributes["method"]) == ("full", "scipy:LSODA")
    assert attributes["emitted_module"] == "full_sphere"
    assert (attributes["status"], attributes["message"]) == ("complete", "")
    assert attributes["steps"] > 0
    assert attributes["force_calls"] >= attributes["steps"]
    for package in ("tweezer", "numpy", "scipy", "numba"):
        assert attributes[f"{package}_version"]


def test_saving_replaces_the_file_and_leaves_nothing_beside_it(turning_run, tmp_path):
    path = tmp_path / "run.nc"
    path.write_text("an old file")
    tweezer.save_run(turning_run, path)
    assert tweezer.load_run(path).attrs["status"] == "complete"
    assert list(tmp_path.iterdir()) == [path]


def test_the_longest_name_of_a_file_is_not_too_long(turning_run, tmp_path):
    path = tmp_path / f"{252 * 'r'}.nc"
    tweezer.save_run(turning_run, path)
    assert path.is_file()


def test_a_full_disk_leaves_the_old_file(turning_run, tmp_path, monkeypatch):
    path = tmp_path / "run.nc"
    path.write_text("an old file")

    def write_half(self: xr.Dataset, path: Path, **_: object) -> None:
        Path(path).write_text("half a fi")
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(xr.Dataset, "to_netcdf", write_half)
    with pytest.raises(ResultError, match=r"run\.nc: cannot be written: No space left on device"):
        tweezer.save_run(turning_run, path)
    assert path.read_text() == "an old file"
    assert list(tmp_path.iterdir()) == [path]


def test_a_folder_that_is_not_there(turning_run, tmp_path):
    with pytest.raises(ResultError, match="cannot be written: No such file or directory"):
        tweezer.save_run(turning_run, tmp_path / "none" / "run.nc")
    assert not list(tmp_path.iterdir())


def test_files_that_are_no_runs(tmp_path):
    with pytest.raises(ResultError, match="no such file"):
        tweezer.load_run(tmp_path / "none.nc")
    text = tmp_path / "text.nc"
    text.write_text("not a run")
    with pytest.raises(ResultError, match="not a saved run"):
        tweezer.load_run(text)
    other = tmp_path / "other.nc"
    xr.Dataset({"height": ("time", [1.0, 2.0])}).to_netcdf(other, engine="h5netcdf")
    with pytest.raises(ResultError, match="names no scene"):
        tweezer.load_run(other)
    with pytest.raises(ResultError, match="not a saved run"):
        tweezer.load_run(tmp_path)


def test_a_run_is_not_held_open_by_loading_it(turning_run, tmp_path):
    path = tweezer.save_run(turning_run, tmp_path / "run.nc")
    loaded = tweezer.load_run(path)
    tweezer.save_run(loaded, path)
    path.unlink()
    assert loaded["position"].shape == turning_run["position"].shape


def test_json_has_null_for_a_number_that_is_not_known(tmp_path):
    """Strict JSON: `NaN` and `Infinity` are no words of it."""
    results = {
        "known": [1e-300, np.float64(0.1), 3],
        "name": "1 µm",
        "unknown": [math.nan, math.inf],
    }
    write_json(results, tmp_path / "results.json")
    text = (tmp_path / "results.json").read_text(encoding="utf-8")
    read = json.loads(text, parse_constant=pytest.fail)
    assert read == {**results, "unknown": [None, None]}
