"""Ensembles: the same numbers however they are computed, statistics against NumPy and SciPy."""

from __future__ import annotations

import dataclasses
import errno
import hashlib
import importlib
import itertools
import os
import re
import resource
import shutil
import threading
import tracemalloc
from pathlib import Path

import dask
import numpy as np
import pytest
import scipy.signal
import scipy.special
import scipy.stats
import xarray as xr
from filelock import FileLock
from scipy.constants import Boltzmann
from scipy.spatial.transform import Rotation

import tweezer
from tweezer.dynamics.walk import Walk, walk
from tweezer.ensembles import job, statistics, store
from tweezer.ensembles import workers as workers_module
from tweezer.ensembles.statistics import error_of_part, joined, moments
from tweezer.values import beside
from tweezer.values.rounding import with_uncertainty

ensemble_module = importlib.import_module("tweezer.ensembles.ensemble")

#: a bead that diffuses freely: no light, no weight
FREE = tweezer.load_scene("silica-1um").replace(
    forces={"brownian": True, "optical": False, "gravity": False, "buoyancy": False},
    start={"position": [3e-7, 2e-7, -3e-7]},
    simulation={"model": "overdamped", "duration": "10 ms", "samples": 101},
)
#: m^2/s
DIFFUSION = Boltzmann * FREE.medium.temperature / tweezer.bead_properties(FREE).drag
#: the same, lost soon: a third of the beads within the 10 ms
LEAVING = FREE.replace(simulation={"loss_distance": 600e-9})
#: and with velocities, in a fluid with memory
INERTIAL = FREE.replace(simulation={"model": "full"})
#: and with a rotation
TURNING = INERTIAL.replace(
    start={"angular_velocity": [2e5, -1e5, 3e5], "orientation": [0.5, 0.5, 0.1, 0.7]}
)


@pytest.mark.parametrize(("number", "total"), [(0, 50), (7, 50), (50, 50), (1, 1)])
def test_the_error_of_a_part_is_half_of_wilsons_interval(number, total):
    one_sigma = scipy.special.erf(np.sqrt(0.5))
    found = scipy.stats.binomtest(number, total).proportion_ci(one_sigma, method="wilson")
    half = (found.high - found.low) / 2
    assert error_of_part(number / total, total) == pytest.approx(half, rel=1e-12)


@pytest.fixture
def small(monkeypatch):
    """Blocks of 8 trajectories, windows of 32 samples: several of both in a small ensemble."""
    monkeypatch.setattr(job, "_BATCH", 8)
    monkeypatch.setattr(job, "_WINDOW_NUMBERS", 3 * 8 * 32)
    monkeypatch.setattr(statistics, "WINDOW", 32)


def fails_after(patch, last_sample, *, trajectory):
    """That trajectory fails past that sample, and its block with it."""
    sound = Walk.advance

    def advance(self, states, trajectories, sample, out):
        if trajectory in trajectories and sample > last_sample:
            raise tweezer.IntegrationError(f"trajectory {trajectory}: the force is not finite")
        sound(self, states, trajectories, sample, out)

    patch.setattr(Walk, "advance", advance)


def content(path: Path) -> dict[str, str]:
    """Digest of every file of a store, or of a file, by name."""
    files = [path] if path.is_file() else sorted(p for p in path.rglob("*") if p.is_file())
    return {
        str(file.relative_to(path)): hashlib.sha256(file.read_bytes()).hexdigest()
        for file in files
    }  # fmt: skip


#: a part of a small ensemble: more than the first samples of its blocks, less than one window, so
#: that it is reached once a window is to be kept, and not before, however slow the machine
BEGUN = 0.01


def interrupt_after(part: float):
    """A progress that presses Ctrl-C."""

    def progress(reached: float) -> None:
        if reached >= part:
            raise KeyboardInterrupt

    return progress


@pytest.mark.parametrize("scene", [LEAVING, INERTIAL], ids=["overdamped", "full"])
def test_trajectories_are_those_of_one_walk(scene, small, tmp_path):
    bound = walk(scene, 5)
    states = bound.start(np.arange(30))
    expected = np.empty((30, 101, len(bound.columns)))
    expected[:, 0] = bound.seen(states)
    rest = np.empty((30, 100, len(bound.columns)))
    bound.advance(states, np.arange(30), 0, rest)
    expected[:, 1:] = rest
    for out in (None, tmp_path / "runs.zarr"):
        runs = tweezer.ensemble(scene, 30, seed=5, out=out)
        assert runs["position"].dims == ("trajectory", "time", "axis")
        np.testing.assert_array_equal(runs["position"], expected[..., :3])
        np.testing.assert_array_equal(runs["lost_time"], states[:, -1])
        np.testing.assert_array_equal(runs["time"], np.linspace(0, 10e-3, 101))
        assert list(runs["axis"].values) == ["x", "y", "z"]
        assert ("velocity" in runs) == (scene is INERTIAL)
        assert (runs.attrs["status"], runs.attrs["trajectories_done"]) == ("complete", 30)
        assert tweezer.scene_of(runs).simulation.model == bound.scene.simulation.model
    if scene is INERTIAL:
        np.testing.assert_array_equal(runs["velocity"], expected[..., 3:])
    else:
        assert 0 < np.isfinite(runs["lost_time"]).sum() < 30
    assert [path.name for path in tmp_path.iterdir()] == ["runs.zarr"]
    opened = xr.open_zarr(out, chunks=None)
    xr.testing.assert_equal(opened, runs)


@pytest.mark.parametrize(
    ("scene", "batch", "window"),
    [(LEAVING, 64, 2**14), (LEAVING, 64, 7), (LEAVING, 8, 32), (LEAVING, 16, 1), (INERTIAL, 8, 32),
     (INERTIAL, 16, 1)],
    ids=str,
)  # fmt: skip
def test_the_same_bits_in_any_blocks_and_windows(scene, batch, window, monkeypatch, tmp_path):
    expected = tweezer.ensemble(scene, 70, seed=1)
    monkeypatch.setattr(job, "_BATCH", batch)
    columns = 3 if scene is LEAVING else 6
    monkeypatch.setattr(job, "_WINDOW_NUMBERS", columns * batch * window)
    runs = tweezer.ensemble(scene, 70, seed=1, out=tmp_path / "runs.zarr")
    for name in ("position", "lost_time", *(["velocity"] if columns == 6 else [])):
        assert runs[name].values.tobytes() == expected[name].values.tobytes()
    chunks = xr.open_zarr(tmp_path / "runs.zarr", chunks=None)["position"].encoding["chunks"]
    assert chunks == (min(70, batch), min(101, window), 3)


@pytest.mark.parametrize("scene", [LEAVING, INERTIAL], ids=["overdamped", "memory"])
@pytest.mark.parametrize("gathered", [False, True])
def test_the_same_bytes_on_any_threads(scene, gathered, small, tmp_path):
    contents = []
    for workers in (1, 2, 5):
        out = tmp_path / f"{workers}{'.nc' if gathered else '.zarr'}"
        tweezer.ensemble(scene, 100, seed=2, statistics=gathered, out=out, workers=workers)
        contents.append(content(out))
    assert contents[0] == contents[1] == contents[2]
    if scene is LEAVING:
        assert len(contents[0]) == (1 if gathered else 4 * 13 + 13 + 8)


def test_angular_velocity_is_about_the_axes_of_the_body(small, tmp_path):
    scene = TURNING.replace(simulation={"duration": "2 us", "loss_distance": "471 nm"})
    bound = walk(scene, 5)
    states = bound.start(np.arange(30))
    rows = np.empty((30, 101, 13))
    rows[:, 0] = bound.seen(states)
    rest = np.empty((30, 100, 13))
    bound.advance(states, np.arange(30), 0, rest)
    rows[:, 1:] = rest
    runs = tweezer.ensemble(scene, 30, seed=5, out=tmp_path / "runs.zarr")
    left = np.isfinite(rows[..., 0])
    assert 0 < left[:, -1].sum() < 30
    orientation = Rotation.from_quat(rows[left][:, 6:10], scalar_first=True)
    expected = orientation.inv().apply(rows[left][:, 10:])
    assert runs["angular_velocity"].dims == ("trajectory", "time", "body_axis")
    found = runs["angular_velocity"].values
    np.testing.assert_allclose(found[left], expected, rtol=1e-12, atol=1e-6)
    assert np.isnan(found[~left]).all()
    release = [scene.start.angular_velocity] * 30
    np.testing.assert_allclose(found[:, 0], release, rtol=1e-12)
    np.testing.assert_array_equal(runs["orientation"], rows[..., 6:10])
    averaged = tweezer.ensemble(scene, 30, seed=5, statistics=True)["angular_velocity_mean"]
    assert averaged.dims == ("time", "body_axis")
    np.testing.assert_allclose(averaged, np.nanmean(found, axis=0), rtol=1e-9, atol=1e-3)
    # one trajectory, one sample at a time
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(job, "_BATCH", 1)
        patch.setattr(job, "_WINDOW_NUMBERS", 3)
        again = tweezer.ensemble(scene, 2, seed=5)["angular_velocity"]
    assert again.values.tobytes() == found[:2].tobytes()


def test_another_seed_is_another_ensemble():
    first, second = (tweezer.ensemble(FREE, 3, seed=seed)["position"] for seed in (0, 1))
    assert (first[:, 1:] != second[:, 1:]).all()
    more = tweezer.ensemble(FREE, 5, seed=0)["position"]
    np.testing.assert_array_equal(more[:3], first)


def test_joined_moments_are_those_of_all():
    values = np.random.default_rng(0).gamma(2.0, size=(60, 4)) + 100.0
    values[10:40, 1] = np.nan
    values[:, 2] = np.nan
    values[:, 3] = 0.1
    whole = joined(joined(np.zeros((5, 4)), moments(values[:7], 4)), moments(values[7:], 4))
    for column in range(3):
        valid = values[~np.isnan(values[:, column]), column]
        n, mean, *central = whole[:, column]
        assert n == len(valid)
        if n:
            assert mean == pytest.approx(valid.mean(), rel=1e-15)
            for order, found in enumerate(central, start=2):
                expected = len(valid) * scipy.stats.moment(valid, order)
                assert found == pytest.approx(expected, rel=1e-9, abs=1e-14)
    np.testing.assert_array_equal(whole[:, 3], [60, 0.1, 0, 0, 0])


def brute_force_displacement(x: np.ndarray, lag: int) -> np.ndarray:
    """Mean-square displacement of windows (n, samples, 3), begun half a lag apart."""
    starts = range(0, x.shape[1] - lag, max(1, lag // 2))
    return np.mean([(x[:, i + lag] - x[:, i]) ** 2 for i in starts], axis=0)


@pytest.mark.parametrize("scene", [INERTIAL, LEAVING], ids=["held", "lost"])
def test_statistics_are_numpys_of_the_trajectories(scene, small, monkeypatch):
    monkeypatch.setattr(statistics, "_TIMES", 51)
    skipped, length = 6, 30  # 95 samples are left: three windows of 31, less one: 30 is 2*3*5
    runs = tweezer.ensemble(scene, 50, seed=3)
    found = tweezer.ensemble(scene, 50, seed=3, statistics=True, skip="0.6 ms")
    x = runs["position"].values
    np.testing.assert_array_equal(found["time"], runs["time"][::2])
    lost = np.isnan(x[..., 0])
    np.testing.assert_array_equal(found["trajectories_left"], 50 - lost[:, ::2].sum(axis=0))
    assert found["samples_lost"] == lost.sum()
    assert found["trajectories_lost"] == np.isfinite(runs["lost_time"]).sum()
    for name in ("position", "velocity"):
        if name not in runs:
            assert f"{name}_mean" not in found
            continue
        values = runs[name].values[:, 2::2]  # at the release all are equal
        n = 50 - lost[:, 2::2].sum(axis=0)[:, None]
        close = {"rtol": 1e-9, "atol": 0}
        for key, expected in {
            "mean": np.nanmean(values, axis=0),
            "mean_error": np.nanstd(values, axis=0, ddof=1) / np.sqrt(n),
            "variance": np.nanvar(values, axis=0, ddof=1),
            "skewness": scipy.stats.skew(values, nan_policy="omit"),
            "kurtosis": scipy.stats.kurtosis(values, nan_policy="omit"),
        }.items():
            np.testing.assert_allclose(
                found[f"{name}_{key}"][1:], expected, err_msg=key,
                **{**close, "atol": 1e-9 if key in ("skewness", "kurtosis") else 0},
            )  # fmt: skip
    windows = np.concatenate(
        [x[:, first : first + length] for first in range(skipped, 101 - length + 1, length)]
    )
    whole = windows[~np.isnan(windows).any(axis=(1, 2))]
    assert found["windows"] == len(whole)
    assert found["windows_lost"] == len(windows) - len(whole)
    assert len(windows) == 150
    np.testing.assert_allclose(found["stationary_mean"], whole.mean(axis=(0, 1)), rtol=1e-10)
    step = 1e-4
    frequency, power = scipy.signal.periodogram(whole, 1 / step, axis=1)
    np.testing.assert_allclose(found["frequency"], frequency[1:], rtol=1e-12)
    np.testing.assert_allclose(found["psd"].T, power.mean(axis=0)[1:], rtol=1e-9)
    error = power.std(axis=0, ddof=1)[1:] / np.sqrt(len(whole))
    np.testing.assert_allclose(found["psd_error"].T, error, rtol=1e-9)
    for i, lag in enumerate(np.rint(found["lag"].values / step).astype(int)):
        each = brute_force_displacement(whole, lag)
        np.testing.assert_allclose(found["msd"][:, i], each.mean(axis=0), rtol=1e-9)
        error = each.std(axis=0, ddof=1) / np.sqrt(len(whole))
        np.testing.assert_allclose(found["msd_error"][:, i], error, rtol=1e-9)
    samples = x[:, skipped:][~lost[:, skipped:]]
    reach = scene.simulation.loss_distance
    for axis in range(3):
        expected, edges = np.histogram(samples[:, axis], 2**15, range=(-reach, reach))
        at = np.searchsorted(edges, found["bin"].values) - 1
        np.testing.assert_array_equal(found["counts"][:, axis], expected[at])
        assert expected[at].sum() == len(samples)
    width = edges[1] - edges[0]
    np.testing.assert_allclose(found["density"].sum("bin") * width, 1, rtol=1e-11)


@pytest.mark.parametrize("trajectories", [1, 8, 9])
def test_an_error_that_nothing_tells_is_said_to_be_unknown(trajectories, small):
    """One trajectory, one block, and two."""
    scene = FREE.replace(simulation={"samples": 30})  # one window
    found = tweezer.ensemble(scene, trajectories, statistics=True)
    assert found["windows"] == trajectories
    for name, number, over in (
        ("position_mean", trajectories, "trajectories"),
        ("position_variance", trajectories, "trajectories"),
        ("stationary_mean", trajectories, "windows"),
        ("stationary_variance", trajectories, "windows"),
        ("msd", trajectories, "windows"),
        ("psd", trajectories, "windows"),
        ("density", -(-trajectories // 8), "blocks of trajectories"),
    ):
        error = found[f"{name}_error"]
        assert np.isfinite(error).any() == (number > 1), name
        comment = None if number > 1 else f"not known: takes at least 2 {over}"
        assert error.attrs.get("comment") == comment
    assert [name for name in found if "comment" in found[name].attrs and "error" not in name] == (
        [] if trajectories > 1 else ["position_variance", "stationary_variance"]
    )


def test_statistics_at_fewer_times_than_a_piece_has(small, monkeypatch):
    """Pieces between two of the times kept, before and after what is skipped."""
    runs = tweezer.ensemble(FREE, 20, seed=3)["position"]
    monkeypatch.setattr(workers_module, "_PIECE_SAMPLES", 8 * 3)
    for times in (5, 26, 101):
        monkeypatch.setattr(statistics, "_TIMES", times)
        every = -(-101 // times)
        for skip in (0.0, "3.3 ms", "6.5 ms"):
            found = tweezer.ensemble(FREE, 20, seed=3, statistics=True, skip=skip)
            expected = runs[:, ::every].mean("trajectory")
            np.testing.assert_allclose(found["position_mean"], expected, rtol=1e-12)


def test_statistics_of_more_times_than_are_kept():
    scene = FREE.replace(simulation={"samples": 20_001})
    found = tweezer.ensemble(scene, 3, seed=3, statistics=True)
    expected = tweezer.ensemble(scene, 3, seed=3)["position"][:, ::3].mean("trajectory")
    np.testing.assert_allclose(found["position_mean"], expected, rtol=1e-12)


def test_displacements_that_are_wrong_are_left_out(small, tmp_path):
    scene = tweezer.load_scene("silica-1um").replace(
        forces={"brownian": True},
        simulation={"model": "overdamped", "method": "one-call", "step": "20 us",
                    "duration": "2 ms", "samples": 101},
    )  # fmt: skip
    found = tweezer.ensemble(scene, 20, statistics=True, out=tmp_path / "a.nc")
    assert not {"msd", "msd_error", "psd", "psd_error", "lag", "frequency"} & set(found.variables)
    assert found.attrs["comment"].startswith("msd and psd left out: ")
    assert found["windows"] == 20 * 4
    x = tweezer.ensemble(scene, 20)["position"].values
    used = x[:, : 4 * found.attrs["samples_per_window"]]
    np.testing.assert_allclose(found["stationary_mean"], used.mean(axis=(0, 1)), rtol=1e-10)
    as_usual = tweezer.ensemble(FREE, 20, statistics=True)
    assert "comment" not in as_usual.attrs


def jackknife(values: np.ndarray, estimate) -> np.ndarray:
    """Standard error of `estimate` of `values` along axis 0."""
    n = len(values)
    left_out = np.array([estimate(np.delete(values, i, axis=0)) for i in range(n)])
    return np.sqrt((n - 1) / n * ((left_out - left_out.mean(axis=0)) ** 2).sum(axis=0))


def test_errors_are_those_of_the_jackknife(small):
    """The linearised errors agree with the jackknife's to order 1/n."""
    runs = tweezer.ensemble(FREE.replace(simulation={"samples": 30}), 200, seed=4)
    x = runs["position"].values
    found = tweezer.ensemble(tweezer.scene_of(runs), 200, seed=4, statistics=True)
    for name, estimate in {
        "stationary_mean": lambda x: x.mean(axis=(0, 1)),
        "stationary_variance": lambda x: x.var(axis=(0, 1)),
    }.items():
        expected = jackknife(x, estimate)
        np.testing.assert_allclose(found[f"{name}_error"], expected, rtol=0.02, err_msg=name)
    at_end = jackknife(x[:, -1], lambda x: x.var(axis=0, ddof=1))
    np.testing.assert_allclose(found["position_variance_error"][-1], at_end, rtol=0.02)
    reach = FREE.simulation.loss_distance
    middle = int(np.argmax(found["counts"][:, 0].values))
    centre, width = float(found["bin"][middle]), 2 * reach / 2**15
    within = np.abs(x[..., 0] - centre) < width / 2
    blocks = within.reshape(25, 8 * 30)  # of equal size
    expected = blocks.mean(axis=1).std(ddof=1) / 5 / width
    assert float(found["density_error"][middle, 0]) == pytest.approx(expected, rel=1e-9)


def test_free_diffusion():
    """<dx^2> = 2 D t (Einstein) at all lags, and uniform growth of the variance.

    90 numbers, each within 4.5 of its errors: false alarm below 90 * 7e-6 = 6e-4.
    """
    found = tweezer.ensemble(FREE, 4000, seed=7, statistics=True)
    off = (found["msd"] - 2 * DIFFUSION * found["lag"]) / found["msd_error"]
    assert np.abs(off).max() < 4.5
    later = found.isel(time=slice(10, None, 10))
    off = (later["position_variance"] - 2 * DIFFUSION * later["time"]) / later[
        "position_variance_error"
    ]
    assert np.abs(off).max() < 4.5
    assert float(found["msd_error"].isel(lag=0).max() / found["msd"].isel(lag=0).min()) < 0.01


def test_memory_does_not_grow_with_the_ensemble():
    """Eight times as many take as much, but for the blocks that wait to be joined."""
    peaks = []
    for trajectories in (8192, 65536):
        tracemalloc.start()
        tweezer.ensemble(
            FREE.replace(simulation={"samples": 11}), trajectories, statistics=True, workers=1
        )
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    assert peaks[1] < 1.5 * peaks[0] < 50e6


def test_memory_does_not_grow_with_the_columns_averaged():
    """13 columns: all of a window's would be 109 MB."""
    scene = TURNING.replace(simulation={"samples": 2**14, "step": "1 us", "duration": "16.384 ms"})
    tracemalloc.start()
    tweezer.ensemble(scene, 64, statistics=True, workers=1)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 100e6


@pytest.mark.parametrize("gathered", [False, True])
@pytest.mark.parametrize("part", [0.0, 0.4])
def test_an_interrupted_ensemble_is_resumed_to_the_same_bytes(gathered, part, small, tmp_path):
    suffix = ".nc" if gathered else ".zarr"
    whole, out = tmp_path / f"whole{suffix}", tmp_path / f"cut{suffix}"
    kind = {"seed": 6, "statistics": gathered, "workers": 2}
    tweezer.ensemble(LEAVING, 200, out=whole, **kind)
    cut = tweezer.ensemble(LEAVING, 200, out=out, progress=interrupt_after(part), **kind)
    assert cut.attrs["status"] == "interrupted"
    # two blocks of 8 may be begun
    assert 200 * part - 16 <= cut.attrs["trajectories_done"] < 200
    if not gathered:
        done = ~np.isnan(cut["lost_time"].values)
        assert done.sum() == cut.attrs["trajectories_done"]
    reached = []
    resumed = tweezer.ensemble(LEAVING, 200, out=out, resume=True, progress=reached.append, **kind)
    assert (resumed.attrs["status"], resumed.attrs["trajectories_done"]) == ("complete", 200)
    assert reached[0] >= part
    assert reached[-1] == pytest.approx(1)
    assert content(out) == content(whole)
    assert sorted(path.name for path in tmp_path.iterdir()) == [f"cut{suffix}", f"whole{suffix}"]
    again = tweezer.ensemble(LEAVING, 200, out=out, resume=True, **kind)
    xr.testing.assert_identical(again, resumed)


def test_only_what_is_missing_is_computed(small, tmp_path, monkeypatch):
    out = tmp_path / "runs.zarr"
    cut = tweezer.ensemble(FREE, 200, out=out, workers=1, progress=interrupt_after(0.5))
    done = cut.attrs["trajectories_done"]
    advanced = []
    sound = Walk.advance

    def counted(self, states, trajectories, sample, out):
        advanced.append(out.shape[0] * out.shape[1])
        sound(self, states, trajectories, sample, out)

    monkeypatch.setattr(Walk, "advance", counted)
    tweezer.ensemble(FREE, 200, out=out, workers=1, resume=True)
    # a block that was begun goes on from its last window
    assert (200 - done - 8) * 100 <= sum(advanced) <= (200 - done) * 100


def test_an_interrupted_ensemble_in_memory_is_what_was_reached(small):
    runs = tweezer.ensemble(FREE, 200, workers=1, progress=interrupt_after(0.3))
    done = ~np.isnan(runs["lost_time"].values)
    assert runs.attrs["status"] == "interrupted"
    assert 60 <= done.sum() == runs.attrs["trajectories_done"] < 200
    assert np.isfinite(runs["position"].values[done]).all()
    kind = {"statistics": True, "workers": 1}
    cut = tweezer.ensemble(FREE, 200, progress=interrupt_after(0.3), **kind)
    fewer = tweezer.ensemble(FREE, cut.attrs["trajectories_done"], **kind)
    xr.testing.assert_equal(cut, fewer)


def test_statistics_in_memory_behind_a_gap_are_kept(small, monkeypatch):
    """Block 0 is not done: 7 of those behind it are, which is how far ahead two threads are."""
    runs = tweezer.ensemble(FREE, 200)["position"]
    stopped = threading.Event()
    sound, sound_wait = Walk.advance, ensemble_module.wait

    def late(self, states, trajectories, sample, out):
        if 0 in trajectories:
            stopped.wait()
        sound(self, states, trajectories, sample, out)

    def wait(futures, timeout):  # after the pool was told to stop
        stopped.set()
        return sound_wait(futures, timeout)

    reached = []

    def interrupt(part):  # at the third look: at the first, the last block may still be at work
        reached.append(part)
        if len(reached) > 2 and min(reached[-3:]) > 56 / 200 - 1e-9:
            raise KeyboardInterrupt

    monkeypatch.setattr(Walk, "advance", late)
    monkeypatch.setattr(ensemble_module, "wait", wait)
    cut = tweezer.ensemble(FREE, 200, statistics=True, workers=2, progress=interrupt)
    assert (cut.attrs["status"], cut.attrs["trajectories_done"]) == ("interrupted", 56)
    np.testing.assert_allclose(
        cut["position_mean"], runs[8:64].mean("trajectory"), rtol=1e-12, atol=1e-20
    )


@pytest.mark.parametrize("after", [False, True])
@pytest.mark.parametrize("number", [1, 3])
def test_interrupted_while_blocks_are_joined(number, after, small, tmp_path, monkeypatch):
    kind = {"seed": 6, "statistics": True, "workers": 1}
    tweezer.ensemble(LEAVING, 100, out=tmp_path / "whole.nc", **kind)
    sound, calls = statistics.Statistics.join, itertools.count(1)

    def interrupted(self, other):
        now = next(calls) == number
        if now and not after:
            raise KeyboardInterrupt
        both = sound(self, other)
        if now:
            raise KeyboardInterrupt
        return both

    out = tmp_path / "cut.nc"
    with monkeypatch.context() as patch:
        patch.setattr(statistics.Statistics, "join", interrupted)
        cut = tweezer.ensemble(LEAVING, 100, out=out, **kind)
    assert cut.attrs["status"] == "interrupted"
    tweezer.ensemble(LEAVING, 100, out=out, resume=True, **kind)
    assert content(out) == content(tmp_path / "whole.nc")


@pytest.mark.parametrize("gathered", [False, True])
def test_checkpoints_of_another_ensemble_are_not_believed(gathered, small, tmp_path, monkeypatch):
    """As workers of a cluster write them that have not noticed that theirs is gone."""
    suffix = ".nc" if gathered else ".zarr"
    out, other = tmp_path / f"a{suffix}", tmp_path / f"b{suffix}"
    kind = {"statistics": gathered, "workers": 1}
    tweezer.ensemble(FREE, 100, seed=1, out=tmp_path / f"whole{suffix}", **kind)
    tweezer.ensemble(FREE, 100, seed=1, out=out, progress=interrupt_after(0.3), **kind)
    with monkeypatch.context() as patch:
        fails_after(patch, 50, trajectory=40)
        with pytest.raises(tweezer.IntegrationError):
            tweezer.ensemble(FREE, 100, seed=2, out=other, **kind)
    strange = list((tmp_path / f"b{suffix}.part").glob("[0-9]*.npz"))
    assert strange
    for path in strange:
        shutil.copy(path, tmp_path / f"a{suffix}.part")
    tweezer.ensemble(FREE, 100, seed=1, out=out, resume=True, **kind)
    assert content(out) == content(tmp_path / f"whole{suffix}")


def test_a_worker_without_its_client_or_unlike_it_stops(small, tmp_path):
    out, run = tmp_path / "a.zarr", tmp_path / "a.zarr.part" / "1.run"
    tweezer.ensemble(FREE, 50, out=out, progress=interrupt_after(BEGUN), workers=1)
    begun = job.Job.of(walk(FREE), 50, None, out)
    run.touch()
    before = content(tmp_path)
    for key, value in begun.found.items():
        unlike = dataclasses.replace(begun, found=begun.found | {key: f"not {value}"})
        complaint = f"worker .* computes with another {key.replace('_', ' ')}: {value}, not not"
        with pytest.raises(tweezer.TweezerError, match=complaint):
            workers_module._block_there(unlike, run, 5)
    assert workers_module._block_there(begun, run.with_name("2.run"), 5) is None
    assert content(tmp_path) == before
    assert workers_module._block_there(begun, run, 5) == {}
    assert content(tmp_path) != before
    tweezer.ensemble(FREE, 50, out=out, progress=interrupt_after(BEGUN), workers=1, resume=True)
    assert not run.exists()  # whoever goes on stops those before


def test_a_torn_checkpoint_is_not_believed(small, tmp_path):
    out, part = tmp_path / "runs.zarr", tmp_path / "runs.zarr.part"
    tweezer.ensemble(FREE, 64, out=tmp_path / "whole.zarr")
    tweezer.ensemble(FREE, 64, out=out, workers=1, progress=interrupt_after(BEGUN))
    identity = str(np.load(part / "0.npz")["identity"])
    good = {"identity": identity, "window": 2, "states": walk(FREE).start(np.arange(8))}
    for index, size in ((6, 400), (7, 0)):
        store.keep(part / f"{index}.npz", good)
        torn = (part / f"{index}.npz").read_bytes()[:size]
        (part / f"{index}.npz").write_bytes(torn)
    store.keep(part / "5.npz", good)
    damaged = bytearray((part / "5.npz").read_bytes())
    damaged[len(damaged) // 2] ^= 1
    (part / "5.npz").write_bytes(damaged)
    tweezer.ensemble(FREE, 64, out=out, resume=True)
    assert content(out) == content(tmp_path / "whole.zarr")


@pytest.mark.parametrize("gathered", [False, True])
def test_a_checkpoint_of_another_block_is_not_believed(gathered, small, tmp_path, monkeypatch):
    suffix = "nc" if gathered else "zarr"
    out, kind = tmp_path / f"cut.{suffix}", {"workers": 1, "statistics": gathered}
    tweezer.ensemble(FREE, 64, out=tmp_path / f"whole.{suffix}", **kind)
    with monkeypatch.context() as patch:
        fails_after(patch, 40, trajectory=8)  # in the second window of the second block
        with pytest.raises(tweezer.IntegrationError):
            tweezer.ensemble(FREE, 64, out=out, **kind)
    part = out.with_name(f"{out.name}.part")
    for other in range(2, 8):
        shutil.copy(part / "1.npz", part / f"{other}.npz")
    tweezer.ensemble(FREE, 64, out=out, resume=True, **kind)
    assert content(out) == content(tmp_path / f"whole.{suffix}")


FULL = OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
TOLD = r"cut\.(zarr|nc): cannot be written: No space left on device; the results written"


def test_what_failed_is_told_when_interrupted(small, tmp_path, monkeypatch):
    """Ctrl-C as a block has failed, before that is noticed."""
    interrupting, failed = threading.Event(), threading.Event()
    sound = Walk.advance

    def fails(self, states, trajectories, sample, out):
        if 40 in trajectories:
            interrupting.wait()
            failed.set()
            raise tweezer.IntegrationError("trajectory 40: the force is not finite")
        sound(self, states, trajectories, sample, out)

    def interrupt(reached):
        interrupting.set()
        failed.wait()
        raise KeyboardInterrupt

    out = tmp_path / "cut.zarr"
    with monkeypatch.context() as patch:
        patch.setattr(Walk, "advance", fails)
        with pytest.raises(tweezer.IntegrationError, match="trajectory 40"):
            tweezer.ensemble(FREE, 80, out=out, workers=2, progress=interrupt)
    tweezer.ensemble(FREE, 80, out=tmp_path / "whole.zarr")
    tweezer.ensemble(FREE, 80, out=out, resume=True)
    assert content(out) == content(tmp_path / "whole.zarr")


@pytest.mark.parametrize("gathered", [False, True])
@pytest.mark.parametrize("writes", [0, 3, 20])
def test_a_full_disk_keeps_what_was_written(gathered, writes, small, tmp_path, monkeypatch):
    suffix = ".nc" if gathered else ".zarr"
    whole, out = tmp_path / f"whole{suffix}", tmp_path / f"cut{suffix}"
    tweezer.ensemble(FREE, 100, statistics=gathered, out=whole)
    left = iter(range(writes))
    sound = store.keep

    def full(path, arrays):
        if next(left, None) is None:
            raise FULL
        sound(path, arrays)

    with monkeypatch.context() as patch:
        patch.setattr("tweezer.ensembles.store.keep", full)
        patch.setattr("tweezer.ensembles.workers.keep", full)
        with pytest.raises(tweezer.ResultError, match=TOLD):
            tweezer.ensemble(FREE, 100, statistics=gathered, out=out)
    tweezer.ensemble(FREE, 100, statistics=gathered, out=out, resume=True)
    assert content(out) == content(whole)


def test_a_chunk_half_written_is_written_again(small, tmp_path):
    """Files of 4096 bytes at most, of 6148; what Zarr leaves of a write that a kill cut short is
    removed as well.
    """
    tweezer.ensemble(FREE, 100, out=tmp_path / "whole.zarr")
    out = tmp_path / "cut.zarr"
    tweezer.ensemble(FREE, 100, out=out, progress=interrupt_after(0.2), workers=1)
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (4096, limits[1]))
    try:
        with pytest.raises(tweezer.ResultError, match="cannot be written: File too large"):
            tweezer.ensemble(FREE, 100, out=out, resume=True)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    (out / "position" / "c" / "0" / "0" / "0.1.partial").write_bytes(b"half a ch")
    tweezer.ensemble(FREE, 100, out=out, resume=True)
    assert content(out) == content(tmp_path / "whole.zarr")


@pytest.mark.parametrize(
    ("changes", "complaint"),
    [({"trajectories": 0}, "trajectories = 0: must be a whole number"),
     ({"trajectories": 10**12}, "trajectories = 1000000000000: must be a whole number from 1"),
     ({"trajectories": 2.5}, "trajectories = 2.5: must be a whole number"),
     ({"seed": -1}, "seed = -1: must be a whole number"),
     ({"workers": 0}, "workers = 0: must be a whole number"),
     ({"duration": "3 kg"}, "simulation.duration = '3 kg'"),
     ({"skip": "1 ms"}, "skip = '1 ms': requires statistics"),
     ({"statistics": True, "skip": "1 m"}, "skip = '1 m': "),
     ({"statistics": True, "skip": "9.95 ms"}, "must leave at least 2 of the 101 samples"),
     ({"statistics": True, "skip": -1.0}, "skip = -1.0: "),
     ({"scheduler": "tcp://127.0.0.1:1"}, "out: required"),
     ({"scheduler": "tcp://127.0.0.1:1", "workers": 2, "out": "a.zarr"}, "workers = 2: cannot be"),
     ({"trajectories": 10**6}, "trajectories take 2.42 GB, too much for the memory"),
     ({"trajectories": 6 * 10**5, "scene": INERTIAL}, "trajectories take 2.91 GB, too much"),
     ({"scene": FREE.replace(forces={"brownian": False})}, "forces.brownian = False")],
)  # fmt: skip
def test_bad_arguments_are_refused(changes, complaint, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    arguments = {"scene": FREE, "trajectories": 3, **changes}
    with pytest.raises(tweezer.SceneError) as refused:
        tweezer.ensemble(**arguments)
    assert complaint in str(refused.value)
    assert "\n" not in str(refused.value)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("address", "reason"),
    [("tcp://127.0.0.1:1", "Timed out trying to connect"),
     ("tls://127.0.0.1:1", "TLS expects .*; certificates are named in Dask's configuration"),
     ("ucx://127.0.0.1:1", "")],
)  # fmt: skip
def test_a_scheduler_that_is_not_there(address, reason, tmp_path, monkeypatch):
    monkeypatch.setattr("tweezer.ensembles.scheduler.PATIENCE", 0.5)
    with pytest.raises(tweezer.SceneError) as told:
        tweezer.ensemble(FREE, 3, scheduler=address, out=tmp_path / "a.zarr")
    assert re.fullmatch(f"scheduler = '{address}': cannot be reached: {reason}.*", str(told.value))
    assert dask.config.get("scheduler", None) is None  # what follows does not ask for it either
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("gathered", [False, True])
def test_only_the_same_ensemble_is_resumed(gathered, small, tmp_path):
    out = tmp_path / ("a.nc" if gathered else "a.zarr")
    kind = {"out": out, "statistics": gathered}
    for progress in (interrupt_after(BEGUN), None):  # begun, and complete
        tweezer.ensemble(FREE, 50, **kind, resume=progress is None, progress=progress)
        before = content(tmp_path)
        with pytest.raises(tweezer.ResultError, match="already exists or is unfinished"):
            tweezer.ensemble(FREE, 50, **kind)
        for scene, trajectories, seed, complaint in (
            (INERTIAL, 50, 0, "belongs to another scene"),
            (FREE.replace(simulation={"step": "20 us"}), 50, 0, "belongs to another scene"),
            (FREE, 51, 0, "made with trajectories 50, which cannot be resumed with 51"),
            (FREE, 50, 1, "made with seed 0, which cannot be resumed with 1"),
        ):
            with pytest.raises(tweezer.ResultError, match=complaint):
                tweezer.ensemble(scene, trajectories, seed=seed, **kind, resume=True)
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(job, "FORMAT", 0)
            with pytest.raises(tweezer.ResultError, match="format 6, which cannot be"):
                tweezer.ensemble(FREE, 50, **kind, resume=True)
        assert content(tmp_path) == before


@pytest.mark.parametrize("gathered", [False, True])
def test_what_cannot_be_removed_fails_no_complete_ensemble(gathered, tmp_path, monkeypatch):
    out = tmp_path / ("a.nc" if gathered else "a.zarr")
    sound = os.rmdir

    def busy(path, **kind):
        if str(path).endswith(".part"):
            raise OSError(errno.ENOTEMPTY, os.strerror(errno.ENOTEMPTY))
        sound(path, **kind)

    monkeypatch.setattr(os, "rmdir", busy)
    kind = {"out": out, "statistics": gathered}
    for resume in (False, True):
        assert tweezer.ensemble(FREE, 3, **kind, resume=resume).attrs["status"] == "complete"


def test_what_is_no_ensemble_is_left_alone(tmp_path):
    (tmp_path / "a.nc").write_text("not a file of statistics")
    (tmp_path / "a.zarr").mkdir()
    (tmp_path / "a.zarr" / "notes.txt").write_text("not a store")
    before = content(tmp_path)
    for name, gathered in (("a.nc", True), ("a.zarr", False)):
        with pytest.raises(tweezer.ResultError, match="not "):
            tweezer.ensemble(FREE, 3, out=tmp_path / name, statistics=gathered, resume=True)
        with pytest.raises(tweezer.ResultError, match="must end in"):
            tweezer.ensemble(FREE, 3, out=tmp_path / name, statistics=not gathered)
    with pytest.raises(tweezer.ResultError, match="no such folder"):
        tweezer.ensemble(FREE, 3, out=tmp_path / "none" / "b.zarr")
    assert content(tmp_path) == before


@pytest.mark.parametrize("gathered", [False, True])
def test_a_folder_it_has_not_made_is_left_alone(gathered, small, tmp_path):
    """Nor are files in its own folder that are not its own; a link is never followed."""
    out = tmp_path / ("a.nc" if gathered else "a.zarr")
    part, victim = tmp_path / f"{out.name}.part", tmp_path / "victim"
    kind = {"out": out, "statistics": gathered}
    for folder in (part / "raw", victim / "new"):
        folder.mkdir(parents=True)
        (folder / "0.npz").write_text("precious")
    (part / "0.npz").write_text("precious")
    before = content(tmp_path)
    for resume in (False, True):
        with pytest.raises(
            tweezer.ResultError, match="already exists and belongs to no ensemble; choose anoth"
        ):
            tweezer.ensemble(FREE, 3, **kind, resume=resume)
        assert content(tmp_path) == before
    part.rename(tmp_path / "mine")
    before = content(tmp_path)
    part.symlink_to(victim)
    with pytest.raises(tweezer.ResultError, match="already exists and belongs"):
        tweezer.ensemble(FREE, 3, **kind)
    part.unlink()
    part.write_text("a file")
    with pytest.raises(tweezer.ResultError, match="already exists and belongs"):
        tweezer.ensemble(FREE, 3, **kind)
    part.unlink()
    part.mkdir()  # by a process that was killed before it wrote anything
    tweezer.ensemble(FREE, 50, **kind, workers=1, progress=interrupt_after(BEGUN))
    assert part.is_dir()
    (part / "notes.txt").write_text("precious")
    (part / "new-0123456789abcdef").symlink_to(victim)
    tweezer.ensemble(FREE, 50, **kind, resume=True)
    assert {path.name for path in part.iterdir()} == {"notes.txt"}
    written = [f"{out.name}/{name}" for name in content(out)] if out.is_dir() else [out.name]
    after = content(tmp_path)
    assert set(after) == {*before, *written, f"{part.name}/notes.txt"}
    assert {name: after[name] for name in before} == before


def test_a_marker_that_is_a_link_is_not_written_to(tmp_path):
    (tmp_path / "thesis.tex").write_text("precious")
    (tmp_path / "a.zarr.part").mkdir()
    (tmp_path / "a.zarr.part" / "of-an-ensemble").symlink_to(tmp_path / "thesis.tex")
    with pytest.raises(tweezer.ResultError, match="already exists and belongs"):
        tweezer.ensemble(FREE, 3, out=tmp_path / "a.zarr")
    assert (tmp_path / "thesis.tex").read_text() == "precious"


def test_a_partial_file_that_zarr_has_not_left_is_kept(tmp_path):
    out = tmp_path / "a.zarr"
    tweezer.ensemble(FREE, 3, out=out)
    mine = [out / "my.partial", out / "position" / "c" / "0" / "notes.partial"]
    for path in mine:
        path.write_text("precious")
    tweezer.ensemble(FREE, 3, out=out, resume=True)
    assert all(path.read_text() == "precious" for path in mine)


def empty(path):
    path.write_bytes(b"")


def cut(path):
    path.write_bytes(path.read_bytes()[:-1])


def another(path):
    """Another chunk of the store, with its checksum."""
    sound = path.read_bytes()
    alike = (each for each in sorted(path.parents[3].rglob("*")) if each.is_file())
    found = (each.read_bytes() for each in alike if each.stat().st_size == len(sound))
    path.write_bytes(next((content for content in found if content != sound), sound))


@pytest.mark.parametrize("damage", [Path.unlink, empty, cut, another])
@pytest.mark.parametrize("part", [None, 0.5], ids=["complete", "begun"])
@pytest.mark.parametrize(
    "chunk", ["position/c/1/0/0", "position/c/12/6/0", "velocity/c/2/1/0", "lost_time/c/1"]
)
def test_a_damaged_chunk_is_computed_again(damage, part, chunk, stores, small, tmp_path):
    """In whole blocks, and in the last, which is of 4; of a complete store, and of one begun."""
    complete, begun = stores
    out = tmp_path / "a.zarr"
    shutil.copytree(begun if part else complete, out)
    if part:
        shutil.copytree(begun.with_name("begun.zarr.part"), tmp_path / "a.zarr.part")
    if (out / chunk).exists():  # some are not reached yet
        damage(out / chunk)
    again = tweezer.ensemble(INERTIAL, 100, out=out, workers=1, resume=True)
    assert again.attrs["trajectories_done"] == 100
    assert content(out) == content(complete)
    assert not (tmp_path / "a.zarr.part").exists()


@pytest.fixture(scope="module")
def stores(tmp_path_factory):
    """A complete ensemble and one half done, to be damaged in copies."""
    folder = tmp_path_factory.mktemp("stores")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(job, "_BATCH", 8)
        patch.setattr(job, "_WINDOW_NUMBERS", 3 * 8 * 32)
        tweezer.ensemble(INERTIAL, 100, out=folder / "whole.zarr")
        tweezer.ensemble(
            INERTIAL, 100, out=folder / "begun.zarr", workers=1, progress=interrupt_after(0.5)
        )
    return folder / "whole.zarr", folder / "begun.zarr"


def test_a_block_that_is_damaged_is_told_as_not_computed(small, tmp_path, monkeypatch):
    out = tmp_path / "a.zarr"
    tweezer.ensemble(FREE, 32, out=out)
    (out / "position" / "c" / "1" / "2" / "0").unlink()
    fails_after(monkeypatch, -1, trajectory=8)
    with pytest.raises(tweezer.IntegrationError):
        tweezer.ensemble(FREE, 32, out=out, resume=True)
    lost_time = xr.open_zarr(out, chunks=None)["lost_time"]
    np.testing.assert_array_equal(np.isnan(lost_time), np.arange(32) // 8 == 1)


def test_a_complete_store_is_neither_read_nor_computed_again(small, tmp_path, monkeypatch):
    """Also where all beads of a block are lost, so that its last chunks hold no number."""
    out = tmp_path / "a.zarr"
    scene = FREE.replace(simulation={"loss_distance": 470e-9})
    runs = tweezer.ensemble(scene, 16, out=out)
    assert np.isnan(runs["position"][:8, 96:]).all()
    monkeypatch.delattr(Walk, "advance")
    assert tweezer.ensemble(scene, 16, out=out, resume=True).attrs["trajectories_done"] == 16


@pytest.mark.parametrize("name", ["zarr.json", "time/zarr.json", "time/c/0", "axis/c/0"])
@pytest.mark.parametrize("text", ["[]", "null", "{}", "{", None])
def test_a_damaged_store_that_cannot_be_mended_is_told_in_one_line(name, text, tmp_path):
    out = tmp_path / "a.zarr"
    tweezer.ensemble(FREE, 3, out=out)
    (out / name).unlink() if text is None else (out / name).write_text(text)
    before = content(out)
    with pytest.raises(tweezer.ResultError) as told:
        tweezer.ensemble(FREE, 3, out=out, resume=True)
    assert "\n" not in str(told.value)
    assert content(out) == before


def test_more_trajectories_than_the_disk_holds_are_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(shutil, "disk_usage", lambda path: shutil._ntuple_diskusage(2, 1, 1e12))
    with pytest.raises(tweezer.ResultError, match=r"take 2\.43e\+03 GB, and 1e\+03 GB are free"):
        tweezer.ensemble(FREE, 10**9, out=tmp_path / "a.zarr")
    assert not list(tmp_path.iterdir())


def test_averages_of_a_trapped_bead_that_turns_are_taken_from_the_trap():
    scene = tweezer.load_scene("silica-1um").replace(
        forces={"brownian": True}, start={"angular_velocity": [2e5, -1e5, 3e5]}
    )
    bound = walk(scene)
    assert job.plan_of(bound, 0).origin == pytest.approx(bound.equilibrium.position, abs=0)


def test_a_failed_ensemble_keeps_what_was_written(small, tmp_path, monkeypatch):
    whole, out = tmp_path / "whole.zarr", tmp_path / "cut.zarr"
    tweezer.ensemble(FREE, 80, out=whole)
    with monkeypatch.context() as patch:
        fails_after(patch, 50, trajectory=40)
        with pytest.raises(tweezer.IntegrationError, match="trajectory 40"):
            tweezer.ensemble(FREE, 80, out=out, workers=1)
    done = ~np.isnan(xr.open_zarr(out, chunks=None)["lost_time"].values)
    assert done[:40].all()
    assert not done[40:48].any()
    tweezer.ensemble(FREE, 80, out=out, resume=True)
    assert content(out) == content(whole)


@pytest.mark.parametrize("gathered", [False, True])
def test_a_long_window_is_kept_on_the_way(gathered, tmp_path, monkeypatch):
    """A block of one window, kept every 10 samples, that fails at the 57th."""
    suffix = ".nc" if gathered else ".zarr"
    whole, out = tmp_path / f"whole{suffix}", tmp_path / f"cut{suffix}"
    kind = {"statistics": gathered, "workers": 1}
    tweezer.ensemble(LEAVING, 8, out=whole, **kind)
    monkeypatch.setattr(workers_module, "_PIECE_SAMPLES", 8 * 5)
    monkeypatch.setattr(workers_module, "_KEPT_STEPS", 8 * 10 * walk(LEAVING).per_sample)
    sound, advanced = Walk.advance, []

    def counted(self, states, trajectories, sample, out):
        advanced.append(out.shape[1])
        sound(self, states, trajectories, sample, out)

    with monkeypatch.context() as patch:
        fails_after(patch, 54, trajectory=0)
        with pytest.raises(tweezer.IntegrationError):
            tweezer.ensemble(LEAVING, 8, out=out, **kind)
    monkeypatch.setattr(Walk, "advance", counted)
    tweezer.ensemble(LEAVING, 8, out=out, resume=True, **kind)
    assert sum(advanced) == 50
    assert content(out) == content(whole)


def test_what_a_worker_of_a_cluster_gathered_is_in_its_file(small, tmp_path):
    """It is joined from there, whole or not at all."""
    whole, out = tmp_path / "whole.nc", tmp_path / "cut.nc"
    kind = {"statistics": True, "workers": 1}
    tweezer.ensemble(FREE, 24, out=whole, **kind)
    tweezer.ensemble(FREE, 24, out=out, progress=interrupt_after(BEGUN), **kind)
    bound = walk(FREE)
    begun, run = job.Job.of(bound, 24, 0, out), tmp_path / "cut.nc.part" / "1.run"
    run.touch()
    for index in (2, 1, 0):
        assert workers_module._block_there(begun, run, index) == {}
    joining = store.Joined(begun, bound)
    for index in (2, 1, 0):
        joining.take(index, {})
    assert joining.waiting == 0
    expected = xr.load_dataset(whole)
    xr.testing.assert_equal(joining.finish(complete=True), expected)
    (tmp_path / "none.nc.part").mkdir()
    joining = store.Joined(dataclasses.replace(begun, out=tmp_path / "none.nc"), bound)
    with pytest.raises(tweezer.ResultError, match=r"0\.npz: damaged; resume"):
        joining.take(0, {})


def test_chunks_are_large_however_many_steps_a_sample_takes():
    """25 MB of 64 beads, and no more beads where that is hours of work."""
    for samples, per_sample in ((10_000, 1), (10_000, 100_000)):
        scene = FREE.replace(
            simulation={"samples": samples + 1, "duration": 1e-6 * samples * per_sample,
                        "step": 1e-6}
        )  # fmt: skip
        divided = job.Job.of(walk(scene), 10**6, None, None)
        assert (divided.block, divided.cuts) == (64, (0, samples + 1))


def test_two_processes_do_not_work_on_one_store(small, tmp_path):
    out = tmp_path / "a.zarr"
    tweezer.ensemble(FREE, 50, out=out, progress=interrupt_after(BEGUN), workers=1)
    before = content(tmp_path)
    with (
        FileLock(tmp_path / "a.zarr.lock"),
        pytest.raises(tweezer.ResultError, match="another process is writing it"),
    ):
        tweezer.ensemble(FREE, 50, out=out, resume=True)
    assert content(tmp_path) == before | {"a.zarr.lock": hashlib.sha256().hexdigest()}


def test_an_ensemble_begun_by_another_process_meanwhile(small, tmp_path, monkeypatch):
    out = tmp_path / "a.zarr"

    class Late(FileLock):
        def acquire(self, *arguments, **kind):
            with pytest.MonkeyPatch.context() as patch:
                patch.setattr(beside, "FileLock", FileLock)
                tweezer.ensemble(FREE, 50, out=out, progress=interrupt_after(BEGUN), workers=1)
            return super().acquire(*arguments, **kind)

    monkeypatch.setattr(beside, "FileLock", Late)
    with pytest.raises(tweezer.ResultError, match="already exists or is unfinished"):
        tweezer.ensemble(FREE, 50, out=out)
    assert (tmp_path / "a.zarr.part").is_dir()


SHORT = [
    "silica-1um", "--trajectories", "200",
    *(argument for change in (
        "forces.brownian=true", "forces.optical=false", "simulation.model=overdamped",
        "simulation.samples=51") for argument in ("--set", change)),
]  # fmt: skip


def test_command(command_line):
    outcome = command_line(
        "ensemble", *SHORT, "--seed", "3", "--duration", "2 ms", "--plot", "beads.png"
    )
    assert (outcome.code, outcome.err) == (0, "")
    assert outcome.out.splitlines()[-1] == "wrote silica-1um.zarr and beads.png"
    assert Path("beads.png").read_bytes().startswith(b"\x89PNG")
    assert "200 of 200" in outcome.out
    runs = xr.open_zarr("silica-1um.zarr", chunks=None)
    expected = tweezer.ensemble(tweezer.scene_of(runs), 200, seed=3)
    np.testing.assert_array_equal(runs["position"], expected["position"])
    assert float(runs["time"][-1]) == 2e-3


def test_command_of_statistics(command_line):
    arguments = ["ensemble", *SHORT, "--statistics", "--skip", "1 ms", "--workers", "1"]
    outcome = command_line(*arguments)
    assert (outcome.code, outcome.err) == (0, "")
    found = xr.load_dataset("silica-1um-statistics.nc")
    variance, error = (float(found[f"stationary_variance{of}"][2]) for of in ("", "_error"))
    deviation = 1e9 * variance**0.5
    assert with_uncertainty(deviation, deviation * error / variance / 2, "±") in outcome.out
    assert f"{int(found['windows'])} of" in outcome.out
    again = command_line(*arguments)
    assert (again.code, len(again.err.splitlines())) == (2, 1)
    assert "already exists or is unfinished" in again.err
    assert command_line(*arguments, "--resume").out == outcome.out


def test_an_interrupted_command_is_resumed(command_line, monkeypatch):
    with monkeypatch.context() as patch:
        patch.setattr("rich.progress.Progress.update", interrupt_update)
        outcome = command_line("ensemble", *SHORT)
    assert outcome.code == 130
    (line,) = outcome.err.splitlines()
    assert line.startswith("silica-1um: interrupted after ")
    assert line.endswith(" of 200 trajectories; continue with --resume")
    assert command_line("ensemble", *SHORT, "--resume").code == 0
    assert [path.name for path in Path().iterdir()] == ["silica-1um.zarr"]


def interrupt_update(self, task, **changes):
    raise KeyboardInterrupt


def test_the_error_of_the_variance_keeps_its_digits_far_from_the_focus():
    """A bead held 20,000 standard deviations off: as one at the focus."""
    rng = np.random.default_rng(6)
    x = 5e-9 * rng.normal(size=(64, 400, 3))
    states = {}
    for offset in (0.0, 1e-4):
        plan = statistics.Plan(
            np.arange(400) * 1e-4, {"position": slice(0, 3)}, 0, 1.0, (offset, offset, offset), True
        )
        gathered = statistics.Statistics(plan)
        gathered.add_piece(0, x + offset)
        gathered.add_window(0, x + offset)
        gathered.close(np.full(64, np.inf))
        dataset = gathered.dataset()
        states[offset] = dataset
        np.testing.assert_allclose(
            dataset["stationary_mean"], offset, atol=5 * float(dataset["stationary_mean_error"][0])
        )
    for name in ("stationary_variance", "stationary_variance_error"):
        np.testing.assert_allclose(states[1e-4][name], states[0.0][name], rtol=1e-6)
    assert (states[0.0]["stationary_variance_error"] > 0).all()
