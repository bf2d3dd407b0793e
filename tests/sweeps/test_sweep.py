"""A sweep computes each case as it is alone, in whatever order, and as often as it is stopped."""

import hashlib
import io
import json
import re
import subprocess
import sys

import numpy as np
import pytest
import xarray as xr
from matplotlib.collections import QuadMesh
from scipy.constants import Boltzmann
from typer.testing import CliRunner

import tweezer
from tweezer.cli.app import app
from tweezer.ensembles import scheduler
from tweezer.plots.sweeps import sweep_figure
from tweezer.sweeps import pool
from tweezer.sweeps.journal import check_same
from tweezer.sweeps.quantities import asked_of, values_of

SCENE = tweezer.load_scene("silica-1um")
#: an aperture beyond the index of water is refused; the sine map has none
OVER = {
    "beam.power_through_pupil": ["5 mW", "50 mW"],
    "bead.diameter": [4e-7, 6e-7],
    "lens.numerical_aperture": [0.4, 1.25, 1.4],
}
#: a bead without light
FREE = SCENE.replace(
    forces={"brownian": True, "optical": False, "gravity": False, "buoyancy": False},
    start={"position": [3e-7, 2e-7, -3e-7]},
    simulation={"model": "overdamped", "duration": "10 ms", "samples": 101},
)


def content(store):
    """Digest of every file of a store by name."""
    return {
        str(file.relative_to(store)): hashlib.sha256(file.read_bytes()).hexdigest()
        for file in sorted(store.rglob("*")) if file.is_file()
    }  # fmt: skip


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The sweep without an interruption, and its store."""
    store = tmp_path_factory.mktemp("sweep") / "whole.zarr"
    return tweezer.sweep(SCENE, OVER, out=store, workers=1), store


def test_each_case_is_as_it_is_alone(whole):
    result, _ = whole
    assert result["outcome"].dims == tuple(OVER)
    assert result["bead.diameter"].attrs["units"] == "m"
    assert result["beam.power_through_pupil"].values == pytest.approx([5e-3, 50e-3])
    for power in (5e-3, 50e-3):
        for diameter in OVER["bead.diameter"]:
            for aperture in (0.4, 1.25):
                scene = SCENE.replace(
                    beam={"power_through_pupil": power}, bead={"diameter": diameter},
                    lens={"numerical_aperture": aperture},
                )  # fmt: skip
                trap = tweezer.characterise(scene)
                case = result.sel({
                    "beam.power_through_pupil": power, "bead.diameter": diameter,
                    "lens.numerical_aperture": aperture,
                })  # fmt: skip
                assert case["reason"] == trap.reason
                assert case["force_error"] == pytest.approx(trap.force_error, rel=1e-9)
                if trap.equilibrium is None:
                    assert case["outcome"] == "not held"
                    assert not case["trapped"]
                    assert np.isnan(case["stiffness"]).all()
                    continue
                depth = min(each.energy_kT for each in trap.escapes)
                assert case["trapped"] == (depth >= 1)
                words = {depth < 1: "not held", 1 <= depth < 10: "shallow", depth >= 10: "held"}
                assert case["outcome"] == words[True]
                k = np.diag(trap.equilibrium.stiffness)
                assert case["stiffness"].values == pytest.approx(k, rel=1e-9)
                assert case["equilibrium"].values == pytest.approx(trap.equilibrium.position)
                assert case["corner_frequency"].values == pytest.approx(trap.corner_frequencies)
                energy = [each.energy for each in trap.escapes]
                depth = np.array(energy) / (Boltzmann * SCENE.medium.temperature)
                assert case["escape_energy"].values == pytest.approx(depth, rel=1e-6)
                force = [each.force for each in trap.escapes]
                assert case["escape_force"].values == pytest.approx(force, rel=1e-6)
    assert set(result["outcome"].values.ravel()) == {"held", "not held", "failed"}


@pytest.mark.parametrize(("power", "outcome"), [("0.075 mW", "shallow"), ("0.16 mW", "held")])
def test_a_trap_of_less_than_ten_kT_is_shallow(power, outcome):
    """By the diagram of docs/trapping-diagram.md: 4.9 kT, and that which holds for an hour."""
    trap = tweezer.characterise(SCENE.replace(beam={"power_through_pupil": power}))
    values = values_of(trap, trap.scene.medium.temperature)
    assert values["outcome"] == outcome
    assert np.isfinite(values["stiffness"]).all()


def test_the_error_of_the_stiffness_holds(whole):
    """Against a tolerance a thousand times smaller."""
    result, _ = whole
    chosen = {"beam.power_through_pupil": 0.05, "lens.numerical_aperture": 1.25}
    case = result.sel(chosen).isel({"bead.diameter": 1})
    finer = SCENE.replace(
        optics={"tolerance": 1e-12}, bead={"diameter": 6e-7}, beam={"power_through_pupil": 0.05}
    )
    exact = np.diag(tweezer.characterise(finer).equilibrium.stiffness)
    error = np.abs(case["stiffness"].values - exact)
    assert (error <= case["stiffness_error"].values + 1e-12 * exact).all()
    assert case["stiffness_error"].max() < 1e-5 * exact.min()


def test_failed_cases_are_marked(whole):
    result, _ = whole
    failed = result.sel({"lens.numerical_aperture": 1.4})
    assert (failed["outcome"] == "failed").all()
    assert np.isnan(failed["force_error"]).all()
    for reason in failed["reason"].values.ravel():
        assert re.match(r"lens.numerical_aperture = 1.4: must be less than medium", reason)
    assert result.attrs["cases_failed"] == 4
    assert result.attrs["status"] == "complete"


def test_every_quantity_names_its_error(whole):
    result, _ = whole
    named = {name: of.attrs.get("ancillary_variables") for name, of in result.items()}
    assert named["stiffness"] == "stiffness_error"
    names = {name for name in named if name.endswith("_error")} - {"force_error"}
    assert {error for error in named.values() if error} == names
    for name in names:
        of = result[name.removesuffix("_error")]
        assert (np.isnan(result[name]) == np.isnan(of)).all()
        errors = result[name].values[~np.isnan(of.values)]
        assert (errors > 0).all() or name == "lifetime_error"  # of an infinite one it is 0


def test_the_store_is_the_result(whole):
    result, store = whole
    xr.testing.assert_identical(xr.open_zarr(store).load(), result)
    assert tweezer.scene_of(result) == SCENE
    again = tweezer.sweep(SCENE, OVER, out=store, workers=1, resume=True)
    xr.testing.assert_identical(again, result)


def test_the_order_does_not_matter(whole):
    """A case is the same whichever power of a light comes first."""
    result, _ = whole
    turned = {key: values[::-1] for key, values in reversed(OVER.items())}
    other = tweezer.sweep(SCENE, turned, workers=1)
    for name, values in result.data_vars.items():
        same = other[name].isel({key: slice(None, None, -1) for key in OVER})
        np.testing.assert_array_equal(same.transpose(*values.dims).values, values.values, name)


def test_stopped_and_resumed_it_has_the_same_bytes(whole, tmp_path):
    """After every case, twice with a line of the journal cut off, and once with the store torn."""
    _, store = whole
    out, journal = tmp_path / "sweep.zarr", tmp_path / "sweep.zarr.part" / "journal.jsonl"

    def stop(done):
        raise KeyboardInterrupt

    for count in range(1, 12):
        stopped = tweezer.sweep(SCENE, OVER, out=out, workers=1, resume=True, progress=stop)
        assert stopped.attrs["status"] == "interrupted"
        assert (stopped["outcome"] != "not computed").sum() == stopped.attrs["cases_done"] > 0
        assert not out.exists()
        text = journal.read_text()
        if count in (3, 7):
            journal.write_text(text[:-40])
        if count == 5:
            journal.write_text(text + '00000000 [3,{"outcome":"he')
        if count == 8:  # a number that reads well, but is another
            journal.write_text(text.replace("0.0", "0.1"))
    torn = journal.parent / "new-0123456789abcdef"
    torn.mkdir()
    (torn / "zarr.json").write_text("{")
    tweezer.sweep(SCENE, OVER, out=out, workers=1, resume=True)
    assert content(out) == content(store)
    assert [path.name for path in tmp_path.iterdir()] == ["sweep.zarr"]


def test_what_is_there_is_not_lost(whole, tmp_path):
    _, store = whole
    before = content(store)
    with pytest.raises(tweezer.ResultError, match="already exists; resume it"):
        tweezer.sweep(SCENE, OVER, out=store, workers=1)
    with pytest.raises(tweezer.ResultError, match="sweeps over other keys or values; choose"):
        tweezer.sweep(SCENE, {**OVER, "bead.diameter": [1e-6]}, out=store, workers=1, resume=True)
    other = SCENE.replace(medium={"viscosity": "1 mPa s"})
    with pytest.raises(tweezer.ResultError, match="is a sweep of another scene; choose"):
        tweezer.sweep(other, OVER, out=store, workers=1, resume=True)
    with pytest.raises(tweezer.ResultError, match="is a sweep of trap, not of run; choose another"):
        tweezer.sweep(SCENE, OVER, "run", out=store, workers=1, resume=True)
    with pytest.raises(tweezer.ResultError, match="is made with seed 3, not 4; choose another"):
        check_same(store, {"seed": "3"}, {"seed": "4"})
    assert content(store) == before
    out = tmp_path / "sweep.zarr"
    foreign = tmp_path / "sweep.zarr.part"
    foreign.mkdir()
    (foreign / "notes.txt").write_text("mine")
    with pytest.raises(tweezer.ResultError, match="already exists and belongs to no sweep"):
        tweezer.sweep(SCENE, OVER, out=out, workers=1)
    (foreign / "notes.txt").rename(foreign / "journal.jsonl")
    for resume in (False, True):
        with pytest.raises(tweezer.ResultError, match="already exists and belongs to no sweep"):
            tweezer.sweep(SCENE, OVER, out=out, workers=1, resume=resume)
    assert (foreign / "journal.jsonl").read_text() == "mine"


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        ({"over": {}}, "over: nothing to sweep over"),
        ({"over": {"bead.diameter": "1 um"}}, "must be a list of values"),
        ({"over": {"bead.diameter": [1e-6]}, "of": "traps"}, "of = 'traps': allowed: trap, run"),
        ({"over": {"lens.numerical_aperture": [1.4]}}, "lens.numerical_aperture = 1.4: must be"),
        ({"over": {"beam.power": [1.0]}, "workers": 0}, "workers = 0: must be a whole number"),
        ({"over": {"beam.power": [1.0]}, "of": "ensemble"}, "all trajectories would be equal"),
        ({"over": {"beam.power": [1.0]}, "out": "sweep.nc"}, "must end in .zarr"),
        ({"over": {"beam.power": [1.0]}, "out": 3}, "out = 3: must be the name of a Zarr store"),
        ({"over": {"bead.diameter": [1e-6], "bead.radius": [1e-6]}}, "bead"),
    ],
)
def test_what_is_no_sweep(arguments, told):
    with pytest.raises(tweezer.TweezerError, match=told):
        tweezer.sweep(SCENE, **arguments)


def test_why_a_lifetime_is_doubtful_or_missing():
    over = {"simulation.loss_distance": ["20 um", "0.2 um"]}
    gold = tweezer.load_scene("gold-100nm").replace(start={"position": [0, 0, 0]})
    found = tweezer.sweep(gold, over, workers=1)
    assert found["outcome"].values.tolist() == ["held", "held"]
    assert np.isnan(found["lifetime"].values).tolist() == [False, True]
    heated, beyond = found["caveat"].values.tolist()
    assert re.fullmatch(r"lifetime: at the temperature .* the light heats the bead by 19 K", heated)
    assert beyond.startswith("lifetime: not computed for an equilibrium beyond")


def test_thermal_quantities():
    """Of ensembles and calibrations, as they are alone."""
    over = {"simulation.loss_distance": ["0.6 um", "20 um"]}
    found = tweezer.sweep(FREE, over, "ensemble", trajectories=50, seed=3, workers=1)
    for i, distance in enumerate((6e-7, 2e-5)):
        scene = FREE.replace(simulation={"loss_distance": distance})
        alone = tweezer.ensemble(scene, 50, seed=3, statistics=True, workers=1)
        case = found.isel({"simulation.loss_distance": i})
        assert case["lost"] == float(alone["trajectories_lost"]) / 50
        assert (case["variance"].values == alone["stationary_variance"].values).all()
        assert (case["variance_error"].values == alone["stationary_variance_error"].values).all()
    assert found["outcome"].values.tolist() == ["some lost", "all held"]
    p = float(found["lost"][0])
    assert found["lost_error"][0] == pytest.approx((p * (1 - p) / 50) ** 0.5, rel=0.1)
    assert 0 < found["lost_error"][1] < 0.02

    run = tweezer.simulate(FREE.replace(simulation={"samples": 201}), seed=3)
    alone = tweezer.calibrate(run)
    found = tweezer.sweep(FREE, {"simulation.samples": [201]}, "calibrate", seed=3, workers=1)
    assert found["outcome"].item() == "not to be trusted"
    assert "x: " in found["caveat"].item()
    for i, axis in enumerate(alone.axes):
        assert found["stiffness"][0, i] == axis["power spectrum"].stiffness
        assert found["stiffness_error"][0, i] == axis["power spectrum"].uncertainty


def test_runs():
    scene = FREE.replace(
        forces={"brownian": False, "gravity": True}, simulation={"duration": "1 ms"}
    )
    found = tweezer.sweep(scene, {"bead.density": ["1.2 g/cm^3", 3000.0]}, "run", workers=1)
    for i, density in enumerate((1200.0, 3000.0)):
        run = tweezer.simulate(scene.replace(bead={"density": density}))
        summary = tweezer.summarise(run)
        assert found["outcome"][i] == summary.outcome
        assert found["end"][i].values.tolist() == list(summary.end)
        assert found["end_error"][i, 0] >= run.attrs["integration_error"]


#: a process that dies at case 3, always, and once at case 1
PROCESS = """
import json, os, pathlib, sys
sys.stdin.readline()
for line in sys.stdin:
    for case, settings in json.loads(line):
        died = pathlib.Path(sys.argv[1])
        if case == 3 or (case == 1 and not died.exists()):
            died.touch()
            os._exit(7)
        print(json.dumps([case, {"outcome": "held", "force_error": case}]), flush=True)
"""


def test_processes_that_die_are_replaced(monkeypatch, tmp_path):
    def process(asked):
        made = subprocess.Popen(
            [sys.executable, "-S", "-c", PROCESS, str(tmp_path / "died")],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
        )  # fmt: skip
        made.stdin.write("{}\n")
        return made

    monkeypatch.setattr(pool, "_process", process)
    over = {"bead.diameter": np.linspace(4e-7, 6e-7, 6)}
    found = tweezer.sweep(SCENE, over, workers=2)
    assert found["outcome"].values.tolist() == ["held"] * 3 + ["failed"] + ["held"] * 2
    assert found["force_error"].values[[0, 1, 2, 4, 5]].tolist() == [0, 1, 2, 4, 5]
    assert found["reason"][3] == "its process died 3 times, last with exit status 7"


def test_process_without_a_parent_ends_silently(monkeypatch, capfd):
    monkeypatch.setattr(pool.sys, "stdin", io.StringIO())
    for name in ("signal.signal", "logging.disable"):
        monkeypatch.setattr(f"tweezer.sweeps.pool.{name}", lambda *_: None)
    pool.serve()
    assert capfd.readouterr() == ("", "")


def test_a_process_serves(whole):
    """A true one gives what this one gives, and ends with its input."""
    result, _ = whole
    asked = asked_of(SCENE, "trap")
    over = {"beam.power_through_pupil": "5 mW", "bead.diameter": "4e-07"}
    tasks = [[(7, {**over, "lens.numerical_aperture": text}) for text in ("1.25",)]]
    ((case, values),) = pool.processes(asked, tasks, 1)
    assert case == 7
    same = result.isel({"beam.power_through_pupil": 0, "bead.diameter": 0}).sel(
        {"lens.numerical_aperture": 1.25}
    )
    assert values["stiffness"] == same["stiffness"].values.tolist()
    assert json.loads(json.dumps(values)) == values


def test_a_cluster_gives_the_same(whole, monkeypatch):
    distributed = pytest.importorskip("distributed")
    result, _ = whole
    over = {**OVER, "lens.numerical_aperture": [1.25]}
    with distributed.Client(
        processes=False, n_workers=1, threads_per_worker=1, dashboard_address=None
    ) as client:
        other = tweezer.sweep(SCENE, over, scheduler=client)
        client.retire_workers()
        monkeypatch.setattr(scheduler, "PATIENCE", 0.05)
        with pytest.raises(tweezer.SceneError, match="scheduler: has no workers"):
            tweezer.sweep(SCENE, over, scheduler=client)
    with pytest.raises(tweezer.SceneError, match="scheduler: the client is closed"):
        tweezer.sweep(SCENE, over, scheduler=client)
    with pytest.raises(tweezer.SceneError, match="scheduler = 'foo': must be an address with a"):
        tweezer.sweep(SCENE, over, scheduler="foo")
    for name in ("stiffness", "escape_energy", "outcome"):
        same = result[name].sel({"lens.numerical_aperture": [1.25]})
        np.testing.assert_array_equal(other[name].values, same.values)


def test_figures(whole):
    """A map shows the numbers of the result; curves have one line for each member of the family."""
    result, _ = whole
    family = result.sel({"lens.numerical_aperture": 1.25})
    drawn = sweep_figure(family).axes
    (panel,) = (
        axes
        for axes in drawn
        if axes.get_title().startswith("stiffness") and axes.get_title().endswith(", x")
    )
    assert panel.get_ylabel() == "stiffness (pN/µm)"
    assert panel.get_xlabel() == "bead diameter (µm)"
    assert "cross" not in drawn[0].figure.get_supxlabel()  # none of them is lost
    curves = [bars.lines[0].get_ydata() for bars in panel.containers]
    assert np.allclose(curves, 1e6 * family["stiffness"].sel(axis="x").values, rtol=1e-12)
    assert [text.get_text() for text in drawn[0].get_legend().get_texts()] == ["5 mW", "50 mW"]
    with pytest.raises(tweezer.ResultError, match="a figure requires one or two keys"):
        sweep_figure(result)
    wide = xr.concat([result] * 5, "bead.diameter").isel({"lens.numerical_aperture": 1})
    wide = xr.concat([wide] * 5, "beam.power_through_pupil")
    wide = wide.assign_coords(
        {
            "bead.diameter": 1e-6 * np.arange(1, 11),
            "beam.power_through_pupil": np.geomspace(1, 9, 10),
        }
    )
    drawn = sweep_figure(wide).axes
    (panel,) = (
        axes
        for axes in drawn
        if axes.get_title().startswith("stiffness") and axes.get_title().endswith(", x")
    )
    (mesh,) = (each for each in panel.collections if isinstance(each, QuadMesh))
    k = wide["stiffness"].sel(axis="x").transpose("beam.power_through_pupil", "bead.diameter")
    assert mesh.get_array().data.ravel() == pytest.approx(1e6 * k.values.ravel())
    mixed = wide.isel({"bead.diameter": [3, 9, 0, 5, 1, 8, 2, 4, 7, 6]})
    for axes, other in zip(drawn, sweep_figure(mixed).axes, strict=True):
        for one, two in zip(axes.collections, other.collections, strict=True):
            if isinstance(one, QuadMesh):
                np.testing.assert_array_equal(one.get_array(), two.get_array())
                np.testing.assert_array_equal(one.get_coordinates(), two.get_coordinates())


def test_a_lifetime_without_end_is_no_point(whole):
    """It has an arrow in its place, on an axis that is logarithmic even where all are such."""
    result, _ = whole
    curve = result.isel({"beam.power_through_pupil": 1, "lens.numerical_aperture": 1})
    curve = curve.assign(lifetime=curve["lifetime"] * np.inf)
    assert np.isposinf(curve["lifetime"]).all()
    panel = sweep_figure(curve).axes[1]
    assert panel.get_title().startswith("lifetime")
    assert panel.get_yscale() == "log"
    (bars,) = panel.containers
    assert np.isnan(bars.lines[0].get_ydata()).all()
    (arrows,) = (line for line in panel.lines if line.get_marker() == "^")
    assert arrows.get_xdata() == pytest.approx([0.4, 0.6])


def test_what_cannot_be_drawn_is_not_computed(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    arguments = ["sweep", "silica-1um", "--over", "bead.diameter=1um", "--plot", "a.png"]
    found = CliRunner().invoke(app, arguments).exception
    assert str(found) == "a figure requires one or two keys with several values, not 0"
    assert not any(tmp_path.iterdir())
