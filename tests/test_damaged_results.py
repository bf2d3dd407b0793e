"""Results that are damaged, edited or hostile, and files beside them: a part of `make stress`."""

from __future__ import annotations

import json
import shutil
import warnings
from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray as xr

import tweezer
from tests import damaged_results
from tests.damaged_results import PRIVATE, copied, sound
from tests.foreign_files import foreign_files
from tweezer.saved import kind_of_file


@pytest.fixture(autouse=True)
def _here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize(
    ("kind", "count"),
    [
        (damaged_results.damaged_results, 25),
        (damaged_results.edited_results, 25),
        (damaged_results.hostile_results, 15),
        (foreign_files, 10),
    ],
)
def test_fault_loses_nothing_and_is_told_in_one_line(kind, count):
    assert sum(kind(count).values()) == count


@pytest.mark.parametrize("name", ["ensemble.zarr", "sweep.zarr"])
def test_store_that_lacks_a_file_is_refused_or_marked(name):
    """Any of its files; without its times of losses a block of an ensemble is not computed."""
    path = copied(name)
    for file in sorted(each for each in path.rglob("*") if each.is_file()):
        if file.name == ".sha256":
            continue
        content = file.read_bytes()
        file.unlink()
        if "lost_time/c" in str(file):
            assert "are not computed" in tweezer.view(path).content.warning
            expected = "is not complete"
        else:
            expected = "(lacks .*: cut short or damaged|must have zarr.json)$"
            with pytest.raises(tweezer.ResultError, match=rf"^{name}: .*{expected}"):
                tweezer.view(path)
        with pytest.raises(tweezer.ResultError, match=expected):
            tweezer.compare(path, sound() / name)
        file.write_bytes(content)


def test_sweep_that_lacks_files_is_not_resumed_as_complete():
    path = copied("sweep.zarr")
    shutil.rmtree(path / "stiffness" / "c")
    over = {"bead.diameter": [0.5e-6, 1e-6]}
    with pytest.raises(tweezer.ResultError, match=r"lacks stiffness/c/0/0: cut short or damaged"):
        tweezer.sweep(damaged_results.SCENE, over, out=path, workers=1, resume=True)


def test_store_rewritten_by_xarray_is_read():
    """Other chunks, no checksums, and no digest of its description."""
    with xr.open_zarr(sound() / "sweep.zarr", chunks=None) as store:
        plain = store.load().drop_encoding()
    with warnings.catch_warnings(action="ignore"):
        plain.to_zarr("mine.zarr", zarr_format=3, write_empty_chunks=True)
    assert tweezer.compare("mine.zarr", sound() / "sweep.zarr").same
    assert kind_of_file(Path("mine.zarr")).name == "sweep"


def test_external_data_of_a_run_are_not_shown():
    path = copied("run.nc")
    with h5py.File("private.h5", "w") as private:
        private["x"] = np.full((11, 3), PRIVATE)
    with h5py.File(path, "r+") as file:
        del file["position"]
        file["position"] = h5py.ExternalLink("private.h5", "/x")
    for read in (tweezer.load_run, tweezer.view, lambda path: tweezer.compare(path, path)):
        with pytest.raises(tweezer.ResultError, match="position: is stored in another file"):
            read(path)


def test_times_that_fall_or_are_not_finite_are_refused():
    run = tweezer.load_run(sound() / "run.nc")
    for values, expected in (
        (run["time"].values[::-1], "does not increase after entry 1"),
        (np.where(np.arange(11) == 4, np.nan, run["time"].values), "is not finite at entry 5"),
    ):
        wrong = run.assign_coords(time=("time", values, run["time"].attrs))
        tweezer.save_run(wrong, "wrong.nc")
        with pytest.raises(tweezer.ResultError, match=rf"wrong\.nc: not a run .* time {expected}"):
            tweezer.view("wrong.nc")
        with pytest.raises(tweezer.ResultError, match=expected):
            tweezer.view(wrong)


def test_damage_found_late_is_told_with_the_name_of_the_file():
    """A bit of a chunk: its checksum is seen where it is read."""
    path = copied("ensemble.zarr")
    chunk = path / "position" / "c" / "1" / "0" / "0"
    content = bytearray(chunk.read_bytes())
    content[20] ^= 1
    chunk.write_bytes(content)
    for read in (tweezer.view, lambda it: tweezer.compare(it, sound() / "ensemble.zarr")):
        with pytest.raises(tweezer.ResultError, match=r"ensemble\.zarr: damaged, or not a result"):
            read(path)


def test_changed_description_is_told_with_what_to_do():
    path = copied("sweep.zarr")
    about = json.loads((path / "zarr.json").read_text())
    about["attributes"]["note"] = "mine"
    (path / "zarr.json").write_text(json.dumps(about))
    with pytest.raises(tweezer.ResultError, match=r"if you changed it, delete .*\.sha256"):
        tweezer.view(path)
    (path / ".sha256").unlink()
    assert tweezer.compare(path, sound() / "sweep.zarr").same
