"""Saved runs: bit for bit, and whole or not at all."""

from __future__ import annotations

import gc
import json
import math
import resource
from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray as xr

import tweezer
from tweezer.results.io import unlike, write_json
from tweezer.values.errors import ResultError


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
    attributes = {key: np.asarray(value).item() for key, value in loaded.attrs.items()}
    assert repr(attributes) == repr(turning_run.attrs)  # NaN is not equal to itself


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
    assert attributes["title"] == turning_scene.title
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


def test_a_full_disk_leaves_the_old_file(turning_run, tmp_path):
    """Files of 4096 bytes at most: HDF5, were it to write them, would end the process."""
    path = tmp_path / "run.nc"
    path.write_text("an old file")
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (4096, limits[1]))
    try:
        with pytest.raises(ResultError, match=r"run\.nc: cannot be written: File too large"):
            tweezer.save_run(turning_run, path)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    gc.collect()
    assert path.read_text() == "an old file"
    assert list(tmp_path.iterdir()) == [path]


def test_an_interrupt_while_a_file_is_written_leaves_nothing(tmp_path, monkeypatch):
    def interrupted(self, target):
        raise KeyboardInterrupt

    monkeypatch.setattr(Path, "replace", interrupted)
    with pytest.raises(KeyboardInterrupt):
        write_json({"a": 1}, tmp_path / "a.json")
    assert not list(tmp_path.iterdir())


def test_a_link_is_neither_replaced_nor_followed(turning_run, tmp_path):
    thesis, link = tmp_path / "thesis.tex", tmp_path / "run.nc"
    thesis.write_text("precious")
    link.symlink_to(thesis)
    with pytest.raises(ResultError, match=r"run\.nc: cannot be written: is a link, to .*thesis"):
        tweezer.save_run(turning_run, link)
    assert (thesis.read_text(), link.readlink()) == ("precious", thesis)


def test_any_damage_to_a_saved_run_is_noticed(turning_run, tmp_path):
    """Bits turned, bytes changed, ends cut off: `ResultError`, or the run as it was."""
    path = tweezer.save_run(turning_run, tmp_path / "run.nc")
    sound = path.read_bytes()
    draw = np.random.default_rng(4)
    for number in range(300):
        damaged = bytearray(sound)
        at = int(draw.integers(len(sound)))
        if number % 3:
            damaged[at] ^= int(draw.integers(1, 256))
        else:
            del damaged[at:]
        path.write_bytes(damaged)
        try:
            loaded = tweezer.load_run(path)
        except ResultError:
            with pytest.raises(ResultError):
                tweezer.load_track(path)
            continue
        assert at >= len(sound) - 48  # what stands behind the content
        xr.testing.assert_identical(loaded, turning_run)


def test_a_run_that_something_else_has_written_or_changed_is_read(turning_run, tmp_path):
    path = tmp_path / "run.nc"
    turning_run.to_netcdf(path, engine="h5netcdf")
    xr.testing.assert_identical(tweezer.load_run(path), turning_run)
    tweezer.save_run(turning_run, path)
    with h5py.File(path, "r+") as opened:
        opened["position"][0, 0] = 7.0
        opened.attrs["note"] = "corrected"
    loaded = tweezer.load_run(path)
    assert loaded["position"].values[0, 0] == 7.0
    assert loaded.attrs["note"] == "corrected"


def test_a_scene_that_is_none_is_a_result_error(turning_run):
    for scene in ("{", "{}", '{"bead": 3}', 7):
        with pytest.raises(ResultError, match="it contains no valid scene"):
            tweezer.scene_of(turning_run.assign_attrs(scene=scene))
    with pytest.raises(ResultError, match="it contains no valid scene"):
        tweezer.scene_of(turning_run.drop_attrs())


def test_a_folder_that_is_not_there(turning_run, tmp_path):
    with pytest.raises(ResultError, match="cannot be written: No such file or directory"):
        tweezer.save_run(turning_run, tmp_path / "none" / "run.nc")
    assert not list(tmp_path.iterdir())


def test_files_that_are_no_runs(tmp_path):
    with pytest.raises(ResultError, match="no such file"):
        tweezer.load_run(tmp_path / "none.nc")
    for read in (
        tweezer.load_run,
        lambda table: tweezer.sweep(tweezer.load_scene("silica-1um"), cases=table),
    ):
        with pytest.raises(ResultError, match="is a folder"):
            read(tmp_path)
    text = tmp_path / "text.nc"
    text.write_text("not a run")
    with pytest.raises(ResultError, match="not a saved run"):
        tweezer.load_run(text)
    other = tmp_path / "other.nc"
    xr.Dataset({"height": ("time", [1.0, 2.0])}).to_netcdf(other, engine="h5netcdf")
    with pytest.raises(ResultError, match="contains no scene"):
        tweezer.load_run(other)


def test_a_result_of_another_kind_is_told(turning_run, tmp_path):
    about = {"scene": turning_run.attrs["scene"], "status": "complete"}
    heights = xr.Dataset({"equilibrium": ("height", [0.0])}, {"height": [1e-6]}, about)
    path = tweezer.save_run(heights, tmp_path / "heights.nc")
    for reads, error, expected in (
        (tweezer.load_run, ResultError, "not a saved run: is a trap over heights; `xarray.open_da"),
        (tweezer.view, ResultError, "is a trap over heights; `tweezer view` accepts a sweep, "),
        (lambda path: tweezer.compare(path, path), ResultError, "is a trap over heights; `tweezer"),
        (tweezer.load_scene, tweezer.SceneError, "is a trap over heights, not a scene$"),
    ):
        with pytest.raises(error, match=expected):
            reads(path)
    path = tweezer.save_run(turning_run, tmp_path / "run.nc")
    with pytest.raises(
        tweezer.SceneError, match="is a run, not a scene; `tweezer view` shows it and `tweezer com"
    ):
        tweezer.load_scene(path)


def test_a_part_that_does_not_do_is_told(turning_run):
    for part, expected in (
        (turning_run.isel(time=slice(0, 0)), "a run without samples"),
        (turning_run.isel(time=0), "no position over time; select a part"),
        (turning_run[["speed"]], "not a run: it has no position"),
    ):
        for of in (tweezer.view, tweezer.summarise, lambda part: tweezer.compare(part, part)):
            with pytest.raises(ResultError, match=expected):
                of(part)
    with pytest.raises(ResultError, match="a part of a run: it has no optical_force"):
        tweezer.view(turning_run[["position"]])
    assert tweezer.summarise(turning_run[["position"]]) == tweezer.summarise(turning_run)


def test_a_name_of_another_kind_of_file_is_refused(turning_run, tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text("precious")
    with pytest.raises(ResultError, match=r"must end in \.nc"):
        tweezer.save_run(turning_run, path)
    with pytest.raises(ResultError, match=r"must end in \.html"):
        tweezer.view(turning_run).save(path)
    assert path.read_text() == "precious"


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


FREE = tweezer.load_scene("silica-1um").replace(simulation={"model": None, "duration": 1e-6})
THERMAL = FREE.replace(forces={"brownian": True})


@pytest.mark.parametrize(
    ("first", "second", "difference"),
    [((FREE, 0), (FREE, 0), ""),
     ((FREE, 0), (FREE, 1), ""),
     ((THERMAL, 1), (THERMAL, 1), ""),
     ((THERMAL, 1), (THERMAL, 0), "already holds a run with seed = 1"),
     ((FREE, 0), (THERMAL, 0), "already holds a run with forces.brownian = False"),
     ((THERMAL, 0), (FREE, 0), "already holds a run with forces.brownian = True"),
     ((FREE, 0), (FREE.replace(beam={"wavelength": 1e-6}), 0),
      "already holds a run with beam.wavelength = 1.064 um"),
     ((FREE, 0), (FREE.replace(simulation={"model": "full"}), 0),
      "already holds a run without simulation.model"),
     ((FREE.replace(simulation={"model": "full"}), 0), (FREE, 0),
      "already holds a run with simulation.model = full")],
)  # fmt: skip
def test_a_run_tells_how_it_differs_from_another(first, second, difference, turning_run, tmp_path):
    """By what was given, not by what was decided for it."""
    scene, seed = first
    attributes = {"scene_as_given": scene.model_dump_json(exclude_none=True)}
    if scene.forces.brownian:
        attributes["seed"] = seed
    path = tweezer.save_run(turning_run.assign_attrs(attributes), tmp_path / "a.nc")
    assert unlike(path, *second) == difference


def test_what_is_no_run_differs_from_all(turning_run, turning_scene, tmp_path):
    path = tmp_path / "a.nc"
    for attributes in ({}, {"scene_as_given": "{"}, {"scene_as_given": "[]"}):
        run = turning_run.drop_attrs().assign_attrs(scene=turning_run.attrs["scene"], **attributes)
        tweezer.save_run(run, path)
        assert (
            unlike(path, turning_scene, 0) == "already exists, and is no run that can be compared"
        )
    path.write_bytes(path.read_bytes()[:-1000])
    assert unlike(path, turning_scene, 0) == "already exists, and is no run that can be compared"
    tweezer.save_run(turning_run, path)
    assert not unlike(path, turning_scene, 0)
