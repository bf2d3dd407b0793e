"""Results that are damaged, edited or hostile, and files beside them: a part of `make stress`."""

from __future__ import annotations

import hashlib
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
from tweezer.results.io import load_result
from tweezer.results.schema import checked
from tweezer.values.saved import kind_of_file, read_json


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
def test_fault_loses_nothing_and_is_reported_in_one_line(kind, count):
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
            assert "were not computed" in tweezer.view(path).content.warning
            expected = "is not complete"
        else:
            expected = "(lacks .*: cut short or damaged|must have zarr.json)$"
            with pytest.raises(tweezer.ResultError, match=rf"^{name}: .*{expected}"):
                tweezer.view(path)
        with pytest.raises(tweezer.ResultError, match=expected):
            tweezer.compare(path, sound() / name)
        file.write_bytes(content)


@pytest.mark.parametrize("name", ["ensemble.zarr", "sweep.zarr"])
def test_store_with_another_chunk_in_place_of_one_is_refused(name):
    """With its checksum, and as large: of another array, place or store."""
    path, other = copied(name), Path("other.zarr")
    if name == "sweep.zarr":
        over = {"bead.diameter": [0.6e-6, 0.8e-6]}
        tweezer.sweep(damaged_results.SCENE, over, out=other, workers=1)
    else:
        tweezer.ensemble(damaged_results.THERMAL, 70, seed=2, out=other)
    assert tweezer.view(other).content
    chunks = sorted(each for each in path.glob("*/c/**/*") if each.is_file())
    replaced = 0
    for chunk in chunks:
        sound = chunk.read_bytes()
        for source in (other / chunk.relative_to(path), *chunks):
            content = source.read_bytes()
            if len(content) != len(sound) or content == sound:
                continue
            chunk.write_bytes(content)
            of = chunk.relative_to(path)
            expected = f"{of} (differs from the chunk that was saved|is cut short or damaged)"
            with pytest.raises(tweezer.ResultError, match=expected):
                load_result(path)
            replaced += 1
        chunk.write_bytes(sound)
    assert replaced > 5
    load_result(path)


def test_store_of_the_last_release_is_read():
    """The seal has no checksums of chunks."""
    path = copied("sweep.zarr")
    about = json.loads((path / "zarr.json").read_text())
    digest = hashlib.sha256(json.dumps(about, sort_keys=True).encode()).hexdigest()
    (path / ".sha256").write_text(digest)
    assert tweezer.compare(path, sound() / "sweep.zarr").same
    (path / ".sha256").write_text(digest[:-1] + "x")
    with pytest.raises(
        tweezer.ResultError, match=r"damaged: its zarr\.json differs from what was saved"
    ):
        load_result(path)


def test_list_of_checksums_that_is_cut_is_refused():
    path = copied("sweep.zarr")
    lines = (path / ".sha256").read_text().splitlines(keepends=True)
    assert len(lines) > 5
    for left in (lines[:1], lines[:-1], [*lines[:-1], lines[-1].replace("0", "1")]):
        (path / ".sha256").write_text("".join(left))
        with pytest.raises(tweezer.ResultError, match=r"damaged: its zarr\.json"):
            load_result(path)


@pytest.mark.parametrize("name", ["trap.json", "calibration.json"])
def test_json_with_another_number_is_refused(name):
    """Another layout is accepted, and a file without a digest, as in the last release."""
    path = copied(name)
    whole = json.loads(path.read_text())
    path.write_text(json.dumps(dict(reversed(whole.items())), separators=(",", ":")))
    assert read_json(path) == read_json(sound() / name)
    key = "exposure" if name[0] == "c" else "force_error"
    within = whole if name[0] == "c" else whole["trap"]
    within[key] = 1.5 * (within[key] or 1e-6)
    path.write_text(json.dumps(whole))
    expected = rf'^{name}: damaged: .* differs from what was saved; .* delete the key "sha256"$'
    for read in (lambda it: tweezer.compare(it, sound() / name), read_json):
        with pytest.raises(tweezer.ResultError, match=expected):
            read(path)
    del whole["sha256"]
    path.write_text(json.dumps(whole))
    with pytest.warns(UserWarning, match=f"^{name}: has no digest, so a change"):
        assert read_json(path) == whole


def test_json_without_a_digest_is_read_with_one_warning():
    path = copied("trap.json")
    whole = json.loads(path.read_text())
    del whole["sha256"]
    path.write_text(json.dumps(whole))
    for read in (lambda it: tweezer.compare(it, sound() / "trap.json"), tweezer.view):
        with pytest.warns(UserWarning, match="has no digest") as told:
            read(path)
        assert len(told) == 1


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


def test_run_without_its_status_is_refused():
    run = tweezer.load_run(sound() / "run.nc")
    del run.attrs["status"]
    with pytest.raises(tweezer.ResultError, match="not a run: it has no attribute status"):
        tweezer.summarise(run.isel(time=slice(2, 6)))  # a part, which has no summary of its own
    run.to_netcdf("wrong.nc", engine="h5netcdf")
    with pytest.raises(tweezer.ResultError, match=r"wrong\.nc: not a saved run: an attribute or"):
        tweezer.load_run("wrong.nc")


@pytest.mark.parametrize("name", ["step", "seed"])
def test_thermal_run_without_its_step_or_seed_is_refused(name):
    run = tweezer.load_run(sound() / "thermal.nc")
    del run.attrs[name]
    run.to_netcdf("wrong.nc", engine="h5netcdf")
    for read in (tweezer.view, tweezer.load_run):
        with pytest.raises(tweezer.ResultError, match=f"it has no attribute {name}"):
            read("wrong.nc")


def test_run_with_a_position_beyond_all_reach_is_refused():
    run = tweezer.load_run(sound() / "thermal.nc")
    run["position"] = run["position"].copy(data=run["position"].values * 1e160)
    tweezer.save_run(run, "wrong.nc")
    for read in (tweezer.view, tweezer.load_run, lambda it: tweezer.compare(it, run)):
        with pytest.raises(tweezer.ResultError, match="its position exceeds"):
            read("wrong.nc")


def test_dimension_with_a_long_name_is_refused_in_one_short_line():
    run = tweezer.load_run(sound() / "run.nc").rename(axis="[" * 3000)
    with pytest.raises(tweezer.ResultError, match=r"its position is over") as it:
        checked(run, "run.nc")
    assert len(str(it.value)) < 1500


def test_run_with_a_negative_error_is_refused():
    run = tweezer.load_run(sound() / "run.nc")
    run["force_error"] = -run["force_error"]
    tweezer.save_run(run, "wrong.nc")
    with pytest.raises(tweezer.ResultError, match=r"wrong\.nc: .* its force_error is negative"):
        tweezer.load_run("wrong.nc")


def test_damage_found_late_is_reported_with_the_file_name():
    """A bit of a chunk: its checksum is seen where it is read."""
    path = copied("ensemble.zarr")
    chunk = path / "position" / "c" / "1" / "0" / "0"
    content = bytearray(chunk.read_bytes())
    content[20] ^= 1
    chunk.write_bytes(content)
    for read in (tweezer.view, lambda it: tweezer.compare(it, sound() / "ensemble.zarr")):
        with pytest.raises(tweezer.ResultError, match=r"ensemble\.zarr: damaged, or not a result"):
            read(path)


def test_changed_description_is_reported_with_a_remedy():
    path = copied("sweep.zarr")
    about = json.loads((path / "zarr.json").read_text())
    about["attributes"]["note"] = "mine"
    (path / "zarr.json").write_text(json.dumps(about))
    with pytest.raises(tweezer.ResultError, match=r"if you changed it, delete .*\.sha256"):
        tweezer.view(path)
    (path / ".sha256").unlink()
    assert tweezer.compare(path, sound() / "sweep.zarr").same
