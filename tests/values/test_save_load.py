"""`tweezer.save` and `tweezer.load` of every kind of result."""

import dataclasses
import functools
import json
import math
import re

import numpy as np
import pytest
import xarray as xr

import tweezer
from tests.beads.test_ensembles import PAIR
from tests.beads.test_motion import beads
from tests.damaged_results import SCENE, THERMAL
from tweezer.calibration import together
from tweezer.tracking.depth import Minimum, Parameter
from tweezer.tracking.filter import Filtered
from tweezer.values.measured import Result
from tweezer.values.saved import KINDS
from tweezer.values.shown import Shown


def calibration(seed=1):
    rng = np.random.default_rng(seed)
    positions = rng.normal(size=(2000, 2)) * 1e-8
    recording = tweezer.Recording(np.arange(2000) * 1e-4, positions, ("x", "y"), name="drawn")
    return tweezer.calibrate(recording, temperature="293 K", radius="0.5 um", viscosity="1 mPa s")


def rheology():
    from scipy.signal import lfilter

    noise = np.random.default_rng(1).normal(size=(2, 2000)) * 1e-8
    positions = lfilter([1], [1, -0.8], noise).T
    recording = tweezer.Recording(np.arange(2000) * 1e-3, positions, ("x", "y"), name="drawn")
    return tweezer.rheology(recording, temperature="293 K", radius="0.5 um", noise=0)


def surface():
    return tweezer.Surface(
        1e-6, 2e-8, 0.9, math.inf, 9e-9, None, calibration_heights(), ("a",), None, ()
    )


def calibration_heights():
    from tweezer.calibration.wall import Height

    return Height(2e-6, math.nan, 5e-7), Height(3e-6, 1e-8, 5e-7)


def fit():
    key = tweezer.FittedKey(
        "bead.diameter", "m", 1e-6, 1e-8, (9e-7, None), True, ((9e-7, 3.0), (1.1e-6, math.inf))
    )
    return tweezer.SceneFit(("a.csv",), SCENE, (key,), -12.5, 2000, 0.4, "Whittle", "determined")


def depth():
    path = Filtered(-3.0, *(np.array([[1.0, math.nan, 3.0]]) * 1e-6 for _ in range(4)))
    return tweezer.DepthFit(
        "a.csv", SCENE.name, -2e-6, ((-3e-6, -1e-6),), True, "determined", (Minimum(-2e-6, 0.0),),
        1.5e-8, (Parameter("noise", 1.5e-8, None, "m"),), (-8e-6, 2e-6), 0.0, 50, 1, 0.3,
        ((-2e-6, 0.0), (1e-6, math.inf)), path,
    )  # fmt: skip


def tuning():
    tuned = [tweezer.Tuned(a2, off, None, 10, 60, 0.1) for a2, off in ((1.0, None), (0.1, 1e-8))]
    unscaled = tweezer.Tuned(1.0, 0.0, 0.0, 20, 100, 0.2)
    return tweezer.Tuning(tuned, 1e-3, "dormand-prince", 1e-5, unscaled)


#: A rod that rotates
ROD = THERMAL.replace(bead={"shape": "spheroid", "diameter": "0.4 um", "length": "0.8 um"})

#: A result of each kind
MADE = {
    "light": lambda: tweezer.light(SCENE).field([[0, 0, 0], [1e-7, 0, 0]]),
    "sweep": lambda: tweezer.sweep(SCENE, {"bead.diameter": [5e-7, 1e-6]}, workers=1),
    "beads statistics": lambda: tweezer.ensemble(PAIR, 70, statistics=True),
    "beads ensemble": lambda: tweezer.ensemble(PAIR, 3),
    "statistics": lambda: tweezer.ensemble(THERMAL, 70, statistics=True),
    "ensemble": lambda: tweezer.ensemble(THERMAL, 3),
    "heights": lambda: tweezer.trap_over_heights(SCENE, [1e-6, 2e-6]),
    "rotation": lambda: tweezer.rotation(tweezer.simulate(ROD, seed=1)),
    "beads": lambda: tweezer.simulate(beads((0, 0, 0), (2e-6, 0, 0))),
    "run": lambda: tweezer.simulate(THERMAL, seed=1),
    "trap": lambda: tweezer.characterise(SCENE),
    "body trap": lambda: tweezer.characterise(ROD),
    "calibration": calibration,
    "rheology": rheology,
    "together": lambda: together([calibration(1), calibration(2)]),
    "surface": surface,
    "fit": fit,
    "depth": depth,
    "tuning": tuning,
}
#: Keys of a file that contain a result
WITHIN = ("trap", "body_trap", "together", "surface")
made = functools.cache(lambda name: MADE[name]())


def assert_same(one, other):
    """Compare two results field by field; NaN is equal to NaN."""
    if dataclasses.is_dataclass(one):
        assert type(one) is type(other)
        for each in dataclasses.fields(one):
            assert_same(getattr(one, each.name), getattr(other, each.name))
    elif isinstance(one, list | tuple):
        assert type(one) is type(other)
        assert len(one) == len(other)
        for parts in zip(one, other, strict=True):
            assert_same(*parts)
    elif isinstance(one, float | np.ndarray):
        np.testing.assert_array_equal(one, other)
    else:
        assert one == other


@pytest.mark.parametrize("kind", [each.name for each in KINDS])
def test_a_loaded_result_is_the_saved_one(kind, tmp_path):
    result = made(kind)
    path = tmp_path / f"saved{'.nc' if hasattr(result, 'attrs') else '.json'}"
    assert tweezer.save(result, path) == path
    loaded = tweezer.load(path)
    if isinstance(result, xr.Dataset):
        xr.testing.assert_identical(loaded, result.load())
        return
    assert_same(result, loaded)
    if isinstance(result, Shown):
        assert repr(loaded) == repr(result)
        assert loaded.card() == result.card()
    if isinstance(result, Result):
        assert str(list(loaded.quantities())) == str(list(result.quantities()))


@pytest.mark.parametrize("kind", [each.name for each in KINDS if each.of])
def test_a_file_with_a_changed_or_missing_value_is_refused(kind, tmp_path):
    path = tweezer.save(made(kind), tmp_path / "saved.json")
    saved = json.loads(path.read_text())
    path.write_text(re.sub(r"\d(?=\.\d)", "7", path.read_text(), count=1))
    if json.loads(path.read_text()) != saved:
        with pytest.raises(tweezer.ResultError, match="damaged"):
            tweezer.load(path)
    del saved["sha256"]
    inner = next((saved[key] for key in WITHIN if key in saved), saved)
    part = inner[0] if isinstance(inner, list) else inner
    name = next(iter(part))
    part[name] = {"x": "y"}
    path.write_text(json.dumps(saved))
    with (
        pytest.warns(UserWarning, match="has no digest"),
        pytest.raises(tweezer.ResultError, match=re.escape(name)),
    ):
        tweezer.load(path)


def test_null_in_the_file_of_a_command_is_nan(tmp_path):
    """`tweezer fit-depth --out` writes infinite misfits as null, and no path."""
    path = tweezer.save(depth(), tmp_path / "depth.json")
    saved = json.loads(path.read_text())
    del saved["path"], saved["sha256"]
    saved["profile"][1][1] = None
    path.write_text(json.dumps(saved))
    with pytest.warns(UserWarning, match="has no digest"):
        loaded = tweezer.load(path)
    assert loaded.path is None
    assert math.isnan(loaded.profile[1][1])
    assert repr(loaded) == repr(depth())


@pytest.mark.parametrize(
    ("result", "name", "reason"),
    [
        (xr.Dataset(), "x.nc", "Dataset is not a result of tweezer"),
        (3, "x.json", "this int is not a result"),
        ((), "x.json", "this tuple is not a result"),
        (tuning(), "x.nc", "must end in .json"),
    ],
)
def test_what_cannot_be_saved_is_refused(result, name, reason, tmp_path):
    with pytest.raises(tweezer.ResultError, match=reason):
        tweezer.save(result, tmp_path / name)
    assert not (tmp_path / name).exists()


def test_a_file_of_another_content_is_refused(tmp_path):
    path = tmp_path / "x.json"
    path.write_text('{"a": 1}')
    with pytest.raises(tweezer.ResultError, match="not a known kind of result"):
        tweezer.load(path)


@pytest.mark.parametrize("entries", [{"a": 1}, [10**400]])
def test_a_file_with_an_array_of_no_numbers_is_refused(entries, tmp_path):
    path = tweezer.save(depth(), tmp_path / "depth.json")
    saved = json.loads(path.read_text())
    del saved["sha256"]
    saved["path"][1] = entries
    path.write_text(json.dumps(saved))
    with (
        pytest.warns(UserWarning, match="has no digest"),
        pytest.raises(tweezer.ResultError, match="not an array of numbers"),
    ):
        tweezer.load(path)


def test_tuples_that_are_no_result_are_refused(tmp_path):
    for several in ((calibration(), calibration()), (surface(),), (calibration(), 3)):
        with pytest.raises(tweezer.ResultError, match="tuple is not a result"):
            tweezer.save(several, tmp_path / "x.json")
        with pytest.raises(tweezer.ResultError, match="not a known kind of result"):
            tweezer.compare(several, calibration())


def test_arrays_tables_and_dictionaries_are_no_results(tmp_path):
    field = tweezer.light(SCENE).field([0, 0, 0])
    for wrong in (field["force"], field["force"].to_series(), {"scene": 1, "trap": 2}):
        with pytest.raises(tweezer.ResultError, match="is not a result of tweezer"):
            tweezer.save(wrong, tmp_path / "x.nc")


def test_endings_may_be_in_capitals(tmp_path):
    path = tweezer.save(tweezer.light(SCENE).field([0, 0, 0]), tmp_path / "X.NC")
    assert "force" in tweezer.load(path)
    path = tweezer.save(made("trap"), tmp_path / "X.JSON")
    assert tweezer.compare(path, made("trap")).same
