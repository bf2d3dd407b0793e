"""Two results side by side: whether they agree within their errors, and where not."""

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from scipy import stats

import tweezer
from tweezer.calibration.findings import Finding
from tweezer.results.io import write_result

SCENE = tweezer.load_scene("thesis-990nm").replace(
    start={"frame": "focus", "position": [1e-7, 0, 1e-7]}, beam={"divisions": 20},
    simulation={"model": "overdamped", "method": "auto", "duration": 1e-3, "samples": 101,
                "scaling_factor": None},
)  # fmt: skip
THERMAL = SCENE.replace(forces={"brownian": True})
STEP = 1e-3


def described(variables: dict, coordinates: dict, scene=THERMAL, **attributes) -> xr.Dataset:
    attributes = {"scene": scene.model_dump_json(exclude_none=True), "model": "m"} | attributes
    return xr.Dataset(variables, coordinates, attributes)


def walk(draw, samples: int, size: float = 1e-8) -> np.ndarray:
    """Draw positions (samples, 3) m that forget themselves in ten samples, from equilibrium on."""
    kept, new = np.exp(-0.1), np.sqrt(-np.expm1(-0.2))
    x = np.empty((samples, 3))
    x[0] = draw.standard_normal(3)
    for i, noise in enumerate(draw.standard_normal((samples - 1, 3))):
        x[i + 1] = kept * x[i] + new * noise
    return size * x


def thermal(places: np.ndarray, status: str = "complete") -> xr.Dataset:
    return described(
        {"position": (("time", "axis"), places)}, {"time": STEP * np.arange(len(places))},
        status=status,
    )  # fmt: skip


def ensemble(places: np.ndarray, lost: int = 0) -> xr.Dataset:
    times = np.where(np.arange(len(places)) < lost, 0.01, np.inf)
    return described(
        {"position": (("trajectory", "time", "axis"), places), "lost_time": ("trajectory", times)},
        {"time": STEP * np.arange(places.shape[1])},
    )


def straight(speed: float, times: np.ndarray, error: float, **attributes) -> xr.Dataset:
    """Move a bead along x at that speed, with an error of its integration."""
    places = np.outer(times, [speed, 0.0, 0.0])
    about = {"integration_error": error, "model_error": 1e-9, "status": "complete"}
    return described(
        {"position": (("time", "axis"), places)}, {"time": times}, SCENE, **about | attributes
    )


def test_runs_differ_where_they_are_farther_apart_than_their_errors():
    times = np.linspace(0, 1e-3, 11)
    a = straight(1e-3, times, 2e-10)
    near = tweezer.compare(a, straight(1e-3 + 2.9e-7, times, 1e-10))  # 0.29 nm at the end
    assert near.agrees
    assert not near.same
    (distance,) = near.quantities
    assert (distance.count, distance.where) == (10, "at 1 ms")
    assert distance.difference == pytest.approx(2.9e-10, rel=1e-6)
    assert distance.allowed == pytest.approx(3e-10, rel=1e-6)
    far = tweezer.compare(a, straight(1e-3 + 3.1e-7, times, 1e-10))
    assert not far.agrees
    assert "differs at 1 ms" in repr(far)
    # of another model: the errors of both models count too
    assert tweezer.compare(a, straight(1e-3 + 2.2e-6, times, 1e-10, model="n")).agrees
    assert not tweezer.compare(a, straight(1e-3 + 2.4e-6, times, 1e-10, model="n")).agrees
    assert not tweezer.compare(a, straight(1e-3, times, 1e-10, status="lost")).agrees


def test_only_times_that_both_have_are_compared():
    fine, coarse = np.linspace(0, 1e-3, 31), np.linspace(0, 1e-3, 11)
    found = tweezer.compare(straight(1e-3, fine, 1e-10), straight(1e-3, coarse, 1e-10))
    assert found.agrees
    assert found.quantities[0].count == 10
    shifted = straight(1e-3, np.linspace(0, 1.1e-3, 8), 1e-10)
    with pytest.raises(tweezer.ResultError, match="no time in common after the release"):
        tweezer.compare(straight(1e-3, coarse, 1e-10), shifted)
    with pytest.raises(tweezer.ResultError, match="error of its integration is not known"):
        tweezer.compare(straight(1e-3, fine, 1e-10), straight(1e-3, fine, np.nan))


def test_two_methods_agree_on_a_run_and_two_powers_do_not(tmp_path, command_line):
    run = tweezer.simulate(SCENE)
    other = tweezer.simulate(SCENE, method="dormand-prince", tolerance=1e-5)
    weaker = tweezer.simulate(SCENE.replace(beam={"power": "155 mW"}))
    for name, each in (("a", run), ("b", other), ("c", weaker)):
        tweezer.save_run(each, tmp_path / f"{name}.nc")
    assert tweezer.compare(run, tmp_path / "a.nc").same
    agreed = command_line("compare", "a.nc", "b.nc")
    assert agreed.code == 0
    assert "agree within their errors" in agreed.out
    assert "simulation.method" in agreed.out
    apart = np.linalg.norm(run["position"] - weaker["position"], axis=1)
    found = tweezer.compare(run, weaker)
    assert found.quantities[0].difference == pytest.approx(apart.max(), rel=1e-3)
    assert found.differing == (("beam.power", "0.156", "0.155"),)
    assert command_line("compare", "a.nc", "c.nc").code == 1
    refused = command_line("compare", "a.nc", "none.nc")
    assert (refused.code, refused.err) == (2, "none.nc: no such file\n")


def test_thermal_motion_is_compared_by_its_statistics():
    draw = np.random.default_rng(7)
    places = walk(draw, 4000)
    assert tweezer.compare(thermal(places), thermal(places.copy())).same
    alike = tweezer.compare(thermal(places), thermal(walk(draw, 4000)))
    assert alike.agrees
    assert not alike.same
    assert {each.name for each in alike.quantities} == {"mean over time", "variance over time"}
    wider = tweezer.compare(thermal(places), thermal(walk(draw, 4000, 1.5e-8)))
    assert [each.agrees for each in wider.quantities] == [True, False]
    shifted = tweezer.compare(thermal(places), thermal(walk(draw, 4000) + np.array([0, 5e-9, 0])))
    assert [each.agrees for each in shifted.quantities] == [False, True]
    assert shifted.quantities[0].where == "along y"
    with pytest.raises(tweezer.ResultError, match="independent samples"):
        tweezer.compare(thermal(places), thermal(places[:150]))
    assert tweezer.compare(thermal(places[:150]), thermal(places[:150])).same
    with pytest.raises(tweezer.ResultError, match="of kind thermal run, and second of kind run"):
        tweezer.compare(thermal(places), straight(1e-3, np.arange(5.0), 1e-9))


def test_false_alarms_are_as_rare_as_is_said():
    """Of 150 comparisons of ensembles of 25 Gaussian trajectories at 8 times."""
    draw = np.random.default_rng(11)
    alarms = sum(
        not tweezer.compare(*(ensemble(draw.standard_normal((25, 8, 3))) for _ in range(2))).agrees
        for _ in range(150)
    )
    assert alarms <= 6  # more of 150 with one in a hundred: 0.1 %


def test_false_alarms_are_as_rare_where_one_result_is_larger():
    """Of 60 comparisons of 20 Gaussian trajectories with 1000, and a real difference."""
    draw = np.random.default_rng(13)
    large = [ensemble(draw.standard_normal((1000, 8, 3))) for _ in range(10)]
    small = [draw.standard_normal((20, 8, 3)) for _ in range(60)]
    alarms = sum(
        not tweezer.compare(ensemble(x), large[i % 10]).agrees for i, x in enumerate(small)
    )
    assert alarms <= 4  # more of 60 with one in a hundred: 0.04 %
    for factor in (0.3, 3):
        (found,) = (
            each
            for each in tweezer.compare(large[0], ensemble(factor * small[0])).quantities
            if each.name == "variance over trajectories"
        )
        assert not found.agrees


def test_a_ratio_of_variances_has_the_f_distribution():
    """By the formulas of Shoemaker, of samples of one shape whose variances are 1 and 2.5."""
    n, ratio = 21, 2.5
    x = stats.norm.ppf((np.arange(n) + 0.5) / n)
    x /= x.std(ddof=1)
    a, b = (np.broadcast_to(size * x[:, None, None], (n, 2, 3)) for size in (1, ratio**0.5))
    freedom = 2 * n / (stats.kurtosis(x, fisher=False) - (n - 3) / (n - 1))
    freedom *= (1 + ratio) ** 2 / (2 * (1 + ratio**2))  # the scatter of both, by the mean variance
    deviate = stats.norm.isf(stats.f.sf(ratio, freedom, freedom))
    found = tweezer.compare(ensemble(a), ensemble(b)).quantities[1]
    assert found.p_value == pytest.approx(7 * 2 * stats.t.sf(deviate, 2 * (n - 1)), rel=1e-6)


def test_false_alarms_are_as_rare_where_most_beads_are_lost():
    """Of 250 comparisons of 22 beads that are left of 1000, at 20 times."""
    draw = np.random.default_rng(12)

    def some() -> xr.Dataset:
        places = np.full((1000, 21, 3), np.nan)
        places[:22] = draw.standard_normal((22, 21, 3))
        return ensemble(places)

    assert sum(not tweezer.compare(some(), some()).agrees for _ in range(250)) <= 6


def test_nothing_known_is_no_agreement():
    draw = np.random.default_rng(4)
    a, b = draw.standard_normal((2, 200, 6, 3))
    b += 50
    a[15:, 1:] = b[15:, 1:] = np.nan
    with pytest.raises(
        tweezer.ResultError, match="error for mean over trajectories, variance over"
    ):
        tweezer.compare(ensemble(a), ensemble(b))
    assert tweezer.compare(ensemble(a), ensemble(a)).same
    a, b = draw.standard_normal((2, 200, 6, 3))
    a[15:, 3:] = b[15:, 3:] = np.nan
    found = tweezer.compare(ensemble(a), ensemble(b))
    assert found.agrees
    assert [each.count for each in found.quantities] == [6, 6, 1]
    assert sum("9 of 15 numbers are left out" in note for note in found.notes) == 2
    a[:, 3:] = b[:, 3:] = np.nan  # of what neither has, nothing is left out
    assert not any("left out" in note for note in tweezer.compare(ensemble(a), ensemble(b)).notes)


def test_the_end_of_a_thermal_run_is_compared():
    draw = np.random.default_rng(8)
    a, b = walk(draw, 4000), walk(draw, 4000)
    cut = tweezer.compare(thermal(a), thermal(b[:1500], "interrupted"))
    assert not cut.agrees
    assert cut.differing == (("status", "complete", "interrupted"),)
    b[1500:] = np.nan
    found = tweezer.compare(thermal(a), thermal(b))
    assert found.agrees
    assert "second: 2500 of 4000 samples are left out, for they hold no position" in found.notes
    with pytest.raises(tweezer.ResultError, match="second: contains no position"):
        tweezer.compare(thermal(a), thermal(np.full_like(a, np.nan)))


def calibrations(outcomes: list[str], stiffness: list[float]) -> xr.Dataset:
    """Make a sweep of calibrations, one number and its error in each case."""
    error = np.where(np.isnan(stiffness), np.nan, 1e-7)
    about = {"units": "N/m", "ancillary_variables": "stiffness_error"}
    return described(
        {"outcome": ("case", outcomes), "stiffness": ("case", stiffness, about),
         "stiffness_error": ("case", error)},
        {}, of="calibrate", over="{}",
    )  # fmt: skip


def test_what_became_of_the_cases_of_a_sweep_is_compared():
    nan = np.nan
    fine = calibrations(["calibrated"] * 3, [1e-6, 2e-6, 3e-6])
    none = calibrations(["failed"] * 3, [nan] * 3)
    found = tweezer.compare(fine, none)
    assert not found.agrees
    assert [key for key, *_ in found.differing] == [f"outcome of case {i}" for i in range(3)]
    assert "nan" not in repr(found)
    assert "stiffness: 3 of 3 numbers are left out" in repr(found)
    with pytest.raises(tweezer.ResultError, match="they contain no number"):
        tweezer.compare(none, none)
    # what the noise of a record decides is no difference
    doubted = calibrations(["calibrated", "not to be trusted", "calibrated"], [1e-6, nan, 3.1e-6])
    found = tweezer.compare(fine, doubted)
    assert found.agrees
    assert "stiffness: 1 of 3 numbers are left out" in repr(found)
    with pytest.raises(tweezer.ResultError, match="error for stiffness"):
        tweezer.compare(fine, calibrations(["not to be trusted"] * 3, [nan] * 3))


def sweep_of_ensembles(mean: float, lost: float) -> xr.Dataset:
    about = {"units": "m", "ancillary_variables": "mean_error"}
    return described(
        {"outcome": ("case", ["some lost"]), "lost": ("case", [lost]),
         "mean": (("case", "axis"), [[mean, 0, 0]], about),
         "mean_error": (("case", "axis"), [[1e-9] * 3])},
        {}, of="ensemble", over="{}", trajectories=1000,
    )  # fmt: skip


def test_a_sweep_of_ensembles_has_the_freedom_of_the_beads_left():
    first, second = sweep_of_ensembles(0.0, 0.978), sweep_of_ensembles(4.5e-9, 0.978)
    (found,) = tweezer.compare(first, second).quantities
    assert found.p_value == pytest.approx(3 * 0.0045, rel=0.03)  # of 21 degrees of freedom


def test_a_number_of_one_alone_is_a_difference():
    times = np.linspace(0, 1e-3, 11)
    a, b = straight(1e-3, times, 2e-10), straight(1e-3, times, 2e-10)
    b["position"][6:] = np.nan
    found = tweezer.compare(a, b)
    assert not found.agrees
    assert "a finite number in one alone" in repr(found)
    assert "nan" not in repr(found)


def test_ensembles_differ_by_mean_spread_and_losses():
    draw = np.random.default_rng(3)
    places = draw.standard_normal((400, 6, 3))
    others = draw.standard_normal((400, 6, 3))
    assert tweezer.compare(ensemble(places), ensemble(places)).same
    assert tweezer.compare(ensemble(places), ensemble(others)).agrees
    moved = tweezer.compare(ensemble(places), ensemble(others + np.array([0, 0, 0.5])))
    assert [each.agrees for each in moved.quantities] == [False, True, True]
    assert moved.quantities[0].where.endswith("along z")
    lost = tweezer.compare(ensemble(places), ensemble(others, lost=40))
    assert [each.agrees for each in lost.quantities] == [True, True, False]


def test_statistics_by_the_errors_they_have():
    values = {"units": "m", "ancillary_variables": "position_mean_error"}

    def gathered(shift: float, left: int = 1000) -> xr.Dataset:
        mean = np.zeros((5, 3)) + shift
        return described(
            {"position_mean": (("time", "axis"), mean, values),
             "position_mean_error": (("time", "axis"), np.full((5, 3), 1e-9), {"units": "m"}),
             "stationary_mean": ("axis", np.zeros(3), {"units": "m"}),
             "trajectories_left": ("time", np.array([1000.0, 1000, 1000, left, 19])),
             "trajectories": 1000.0, "windows": 5.0},
            {"time": np.arange(5.0)},
        )  # fmt: skip

    found = tweezer.compare(gathered(0.0), gathered(3e-9))
    (same,) = found.quantities
    # 2.12 standard errors of the difference, among 9 numbers: at the last time too few are left
    assert same.p_value == pytest.approx(9 * 0.0339, rel=0.03)
    assert any("position mean: 3 of 12 numbers are left out" in note for note in found.notes)
    assert not tweezer.compare(gathered(0.0), gathered(8e-9)).agrees
    few = gathered(0.0, left=22)
    shifted = gathered(0.0, left=22)
    shifted["position_mean"][3] += 4.5e-9
    # 3.18 standard errors by Student's distribution of 21 degrees of freedom, not of 999
    (found,) = tweezer.compare(few, shifted).quantities
    assert found.p_value == pytest.approx(9 * 0.0045, rel=0.03)


@pytest.mark.filterwarnings("ignore:.*has no digest")
def test_traps_and_calibrations(tmp_path):
    trap = tweezer.characterise(tweezer.load_scene("silica-1um").replace(optics={"theory": "rays"}))
    scene = trap.scene.model_dump(mode="json", exclude_none=True)
    told = dataclasses.asdict(trap) | {"scene": None}
    made = {"tweezer_version": "1", "scene": scene, "trap": told}
    write_result(made, tmp_path / "trap.json")
    assert tweezer.compare(trap, tmp_path / "trap.json").same
    told["escapes"][2]["force"] += 2.1 * trap.force_error
    write_result(made, tmp_path / "trap.json")
    other = tweezer.compare(trap, tmp_path / "trap.json")
    assert [each.name for each in other.quantities if not each.agrees] == ["escape force"]
    assert "differs on the way to +y" in repr(other)

    draw = np.random.default_rng(5)
    found = [
        tweezer.calibrate(
            tweezer.Recording(STEP * np.arange(4000), walk(draw, 4000, size), "xyz", name="mine"),
            temperature=293,
        )
        for size in (1e-8, 1e-8, 1.3e-8)
    ]
    write_result(dataclasses.asdict(found[1]), tmp_path / "c.json")
    assert tweezer.compare(found[0], found[1]).agrees
    assert not tweezer.compare(found[0], found[2]).agrees
    assert not tweezer.compare(trap, found[0]).agrees
    lost = dataclasses.replace(trap, equilibrium=None)
    with pytest.raises(
        tweezer.ResultError, match="first: has no equilibrium, and therefore no stiffness"
    ):
        tweezer.compare(lost, found[0])
    with pytest.raises(
        tweezer.ResultError, match=r"c\.json: is a calibration; `tweezer view` accepts"
    ):
        tweezer.view(tmp_path / "c.json")
    with pytest.raises(tweezer.SceneError, match="is a calibration, not a scene; `tweezer compare"):
        tweezer.load_scene(tmp_path / "c.json")
    for text in ("{}", "[]", "no json", '{"trap": 1, "scene": 2}'):
        (tmp_path / "bad.json").write_text(text)
        with pytest.raises(tweezer.ResultError, match=r"bad.json: "):
            tweezer.compare(tmp_path / "bad.json", trap)


def test_the_same_are_all_numbers_and_their_times():
    times = np.linspace(0, 1e-3, 11)
    run = straight(1e-3, times, 2e-10)
    assert tweezer.compare(run, run.copy(deep=True)).same
    part = tweezer.compare(run, run.isel(time=slice(2)))
    assert (part.agrees, part.same) == (True, False)
    assert "at 1 times that both have" in part.notes
    draw = np.random.default_rng(6)
    beads = ensemble(draw.standard_normal((30, 31, 3)))
    other = beads.copy(deep=True)
    other["position"][7, 2, 1] += 1.0  # not among the times that are compared
    found = tweezer.compare(beads, other)
    assert (found.agrees, found.same) == (True, False)
    assert "at 20 times that both have" in found.notes
    white = thermal(draw.standard_normal((300, 3)))
    slower = tweezer.compare(white, white.assign_coords(time=10 * white["time"]))
    assert (slower.agrees, slower.same) == (True, False)
    white["position"][200:] = np.nan
    found = tweezer.compare(white, white.copy(deep=True))
    assert found.same
    assert "first: 100 of 300 samples are left out, for they hold no position" in found.notes


def test_a_damaged_store_is_told_alike(tmp_path):
    (tmp_path / "bad.zarr").mkdir()
    for reads in (tweezer.view, lambda path: tweezer.compare(path, path)):
        with pytest.raises(tweezer.ResultError, match=r"bad\.zarr: not a result of tweezer: "):
            reads(tmp_path / "bad.zarr")


def test_sweeps_case_by_case(tmp_path):
    dark = SCENE.replace(forces={"optical": False})
    over = {"beam.power": ["20 mW", "30 mW"]}
    first = tweezer.sweep(dark, over, of="run", workers=1, out=tmp_path / "a.zarr")
    second = first.copy(deep=True)
    second["end"][1, 2] += 3 * float(first["end_error"][1, 2])
    assert tweezer.compare(first, tmp_path / "a.zarr").same
    found = tweezer.compare(first, second)
    assert [each.name for each in found.quantities if not each.agrees] == ["end"]
    assert "differs beam.power 0.03, axis z" in repr(found)
    second.attrs["over"] = "{}"
    with pytest.raises(tweezer.ResultError, match="swept over other keys or values"):
        tweezer.compare(first, second)


@pytest.mark.parametrize(("off", "agrees"), [(0.0, True), (1.0, True), (6.0, False)])
def test_a_calibration_is_compared_with_the_trap_of_a_scene(command_line, off, agrees):
    """The stiffness along each axis is compared; an estimate with a finding does not count."""
    assert command_line("trap", "silica-1um", "--out", "trap.json").code == 0
    trap = json.loads(Path("trap.json").read_text())
    k = np.diag(trap["trap"]["equilibrium"]["stiffness"])

    def axis(name, size):
        estimates = [
            {"method": "power spectrum", "stiffness": size + off * 0.01 * size,
             "uncertainty": 0.01 * size, "findings": []},
            {"method": "potential", "stiffness": 3 * size, "uncertainty": 0.01 * size,
             "findings": [{"name": "few", "text": "short"}]},
        ]  # fmt: skip
        return calibrated | {"axis": name, "estimates": estimates}

    command_line("examples", "trapped-bead")
    options = ["--temperature", "20 degC", "--radius", "0.5 um", "--viscosity", "1 mPa s"]
    command_line("calibrate", "trapped-bead.csv", *options, "--blur", "0", "--out", "k.json")
    calibration = json.loads(Path("k.json").read_text())
    del calibration["sha256"]
    calibrated = calibration["axes"][0]
    calibration["axes"] = [axis("y", k[1]), axis("z", k[2])]
    write_result(calibration, Path("k.json"))
    for pair in (("trap.json", "k.json"), ("k.json", "trap.json")):
        found = tweezer.compare(*pair)
        assert [each.name for each in found.quantities] == [
            "stiffness y, power spectrum", "stiffness z, power spectrum",
        ]  # fmt: skip
        assert (found.agrees, found.kind) == (agrees, "trap and calibration")
    done = command_line("compare", "trap.json", "k.json")
    assert done.code == (0 if agrees else 1)
    assert "pN/µm, p = " in done.out


def wall(position: float, uncertainty: float = 2e-8) -> tweezer.Surface:
    return tweezer.Surface(position, uncertainty, 1.0, None, 9e-9, 1e-10, (), ("a",), None, ())


def test_walls_are_compared_by_their_standard_uncertainties(tmp_path):
    """2.9 standard errors have a probability of 0.37 %, 2.7 of 0.69 %; twice of two numbers."""
    apart = 2.9 * np.hypot(2e-8, 1e-8)
    first = tweezer.save(wall(1e-6), tmp_path / "first.json")
    for other in (wall(1e-6 + apart, 1e-8), wall(1e-6 + apart * 2.7 / 2.9, 1e-8)):
        found = tweezer.compare(first, other)
        position, drag = found.quantities
        assert drag.difference == 0
        chance = 2 * stats.norm.sf(abs(other.position - 1e-6) / np.hypot(2e-8, 1e-8))
        assert position.p_value == pytest.approx(2 * chance, rel=1e-3)  # the largest of two
        assert found.agrees == (2 * chance > 0.01)
    assert tweezer.compare(first, wall(1e-6)).same
    with_finding = dataclasses.replace(wall(1e-6), findings=(Finding("undetermined", "by 2"),))
    assert [each.name for each in tweezer.compare(with_finding, first).quantities] == ["drag"]
    thinner = dataclasses.replace(wall(1e-6), drag=3e-9)
    assert not tweezer.compare(first, thinner).agrees
    with pytest.raises(tweezer.ResultError, match="of kind surface"):
        tweezer.compare(first, tweezer.characterise(tweezer.load_scene("silica-1um")))
