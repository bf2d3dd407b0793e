"""The benchmarks run, compare like with like, and the documentation quotes what was committed."""

import contextlib
import io
import itertools
import json
import math
import os
import re
import subprocess
import time
import warnings

import numpy as np
import pytest
import typer
from rich.console import Console
from scipy.linalg import eigh_tridiagonal

import tweezer
from tests.benchmarks import (
    ages,
    bodies,
    bodies_report,
    brownian,
    brownian_report,
    calibrate,
    calibrate_report,
    camera,
    camera_report,
    commands,
    commands_report,
    depth_report,
    diagram,
    diagram_report,
    estimate,
    fit_report,
    fluid_report,
    force,
    free,
    free_report,
    heights,
    heights_report,
    hydro,
    hydro_report,
    integrate_report,
    numpy_sum,
    pages,
    peers,
    real_tracks,
    report,
    rods_report,
    scaling,
    scaling_report,
    summary_report,
    sweep,
    sweep_report,
    view_report,
    wall_report,
    waves_report,
)
from tests.benchmarks.timing import Call, in_fresh_process, per_item
from tweezer import cli
from tweezer.dynamics import bind
from tweezer.dynamics.brownian import euler
from tweezer.dynamics.brownian.batch import Linear


@pytest.fixture(scope="module")
def committed():
    return pages.committed("force")


def shape(value):
    """Keys without their numbers."""
    return {key: shape(entry) for key, entry in value.items()} if isinstance(value, dict) else None


def numbers(value):
    return [n for entry in value.values() for n in numbers(entry)] if shape(value) else [value]


@pytest.fixture
def here(monkeypatch):
    """Programs of fresh processes run in this one, where what they import is at hand."""

    def timed(program, environment):
        start = time.time()
        with (
            monkeypatch.context() as patch,
            warnings.catch_warnings(action="ignore"),
            contextlib.redirect_stdout(io.StringIO()) as printed,
        ):
            for name, value in environment.items():
                patch.setenv(name, value)
            exec(program, {})
        times = json.loads(printed.getvalue())
        return times | {"process_s": times.pop("at") - start}

    monkeypatch.setattr(force, "in_fresh_process", timed)
    monkeypatch.setattr(brownian, "in_fresh_process", timed)


def test_quick_run_of_bodies(command_line, tmp_path, monkeypatch):
    monkeypatch.setattr(bodies, "treams_version", lambda: None)
    done = command_line(
        "bench", "bodies", "--quick", "--out", "bodies.json", "--plot", "bodies.png"
    )  # fmt: skip
    assert (done.code, done.err) == (0, "")
    assert (tmp_path / "bodies.png").stat().st_size > 10_000
    results = json.loads((tmp_path / "bodies.json").read_text())
    committed = pages.committed("bodies")
    assert results.keys() == committed.keys()
    assert results["bodies"][0].keys() == committed["bodies"][0].keys()
    assert results["treams"]["version"] is None
    for body in results["bodies"]:
        assert max(body["force_off_stress"], body["torque_off_stress"]) < 1e-11
        for each in body["tolerances"]:
            assert each["error_over_largest_force"] < each["tolerance"]
            assert each["least_estimate_over_error"] > 1
    for each in results["t_matrices"]:
        assert max(each["error"], each["unitarity"], each["reciprocity"]) < 1e-9
    for each in results["published"]:
        assert each["difference"] < each["accuracy"]


def test_cluster_of_the_benchmark_agrees_with_treams_where_it_is_installed():
    pytest.importorskip("treams")
    found = bodies._treams(bodies.QUICK)
    assert found["degrees"][0]["difference"] < 1e-13
    # waves of degree 3 about the spheres are too few for more
    assert max(found["force_difference"], found["torque_difference"]) < 1e-3


def test_page_quotes_the_committed_bodies():
    committed = pages.committed("bodies")
    assert pages.quoted("bodies") == bodies_report.block(committed)
    assert not committed["quick"]
    assert committed["treams"]["version"]
    assert committed["treams"]["force_difference"] < committed["treams"]["tolerance"]
    for body in committed["bodies"]:
        for each in body["tolerances"]:
            assert each["error_over_largest_force"] < each["tolerance"]
            assert each["least_estimate_over_error"] > 1


def test_bodies_are_reported_without_treams():
    results = pages.committed("bodies")
    results["treams"] = {"version": None, "name": "3 spheres apart", "degrees": []}
    assert "| 3 spheres apart | not installed, not compared |" in bodies_report.block(results)
    assert bodies_report.figure(results).axes


def test_bodies_of_the_benchmark_have_the_stated_size():
    assert bodies.spheroid(0.5, 2).scene.bead.length == pytest.approx(
        2 * bodies.spheroid(0.5, 2).scene.bead.diameter
    )
    for body in (bodies.spheroid(0.5, 2), bodies.spheroid(1, 0.5), *bodies.clusters()):
        volume = 4 / 3 * math.pi * body.radius**3
        assert body.scene.bead.body.mass == pytest.approx(1050 * volume)
        at, turned = bodies.poses(body, 50)
        assert np.linalg.norm(at, axis=1).max() < bodies.NEAR * body.radius
        np.testing.assert_allclose(np.linalg.norm(turned, axis=1), 1)


def test_a_row_that_is_not_as_long_as_its_headings_is_no_table():
    with pytest.raises(ValueError, match="2 headings, 3 cells"):
        pages.markdown(("model", "for"), [("full", "spectra"), ("full", "heun", "spectra")])


def test_every_committed_result_names_its_commit_and_has_a_subject():
    results = {path.stem for path in (pages.ROOT / "tests/benchmarks/results").glob("*.json")}
    assert set(ages.SUBJECTS) == results
    for name, paths in ages.SUBJECTS.items():
        assert re.fullmatch(r"[0-9a-f]{7,40}", ages.measured(name)), name
        missing = [path for path in paths if not (pages.ROOT / path).exists()]
        assert not missing, (name, missing)


def test_results_older_than_the_code_of_their_subject_are_listed(tmp_path, monkeypatch):
    def git(*words):
        who = ("-c", "user.name=a", "-c", "user.email=a@b.c")
        command = ["git", *who, "-C", str(tmp_path), *words]
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()

    def commit(path, text):
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / path).write_text(text)
        git("add", "-A")
        git("commit", "-qm", text)
        return git("rev-parse", "--short", "HEAD")

    git("init", "-q")
    measured = commit("tweezer/viewing/page.py", "the page")
    monkeypatch.setattr(ages, "measured", lambda name: measured)
    commit("tweezer/optics/light.py", "another subject")
    assert ages.later("view", tmp_path) == []
    newer = commit("tweezer/viewing/page.py", "the page again")
    assert ages.later("view", tmp_path) == [f"{newer} the page again"]
    monkeypatch.setattr(ages, "measured", lambda name: "0123abc")
    (line,) = ages.later("view", tmp_path)
    assert line.startswith("unknown: ")


def test_a_fresh_process_is_timed_from_before_its_start():
    program = "import json, os, time; print(json.dumps({'at': time.time(), 'is': os.getpid()}))"
    started = time.time()
    times = in_fresh_process(program, {})
    assert times["is"] != os.getpid()
    assert 0 < times["process_s"] < time.time() - started


def test_quick_run(here, command_line, tmp_path, monkeypatch, committed):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    done = command_line(
        "bench", "force", "--quick", "--out", "force.json", "--plot", "force.png"
    )  # fmt: skip
    assert (done.code, done.err) == (0, "")
    assert "one ray that hits" in done.out
    assert (tmp_path / "force.png").stat().st_size > 10_000
    results = json.loads((tmp_path / "force.json").read_text())
    assert shape(results["headline"]) == shape(committed["headline"])
    assert all(math.isfinite(n) and n >= 0 for n in numbers(results["headline"]))
    for kind, of in results["headline"]["by_place"].items():
        assert of["quadrature_largest_error"] < 1e-8, kind
        assert of["quadrature_largest_error"] < of["grid_largest_error"], kind
        assert of.get("map_largest_error_over_largest_force", 0) < 1e-7, kind
        assert of["waves_largest_error"] < 1e-8, kind
        assert of.get("waves_map_largest_error_over_largest_force", 0) < 1e-7, kind
    waves = results["waves"]
    for name, bead in waves["beads"].items():
        assert bead["largest_error"] < 1e-8, name
        assert bead["least_estimate_over_error"] > 0.1, name
        assert bead["truth_off_plane_waves"] < 1e-11, name
    for size in waves["sizes"]:
        assert size["map"]["error_over_largest_force"] < 1e-7
        assert size["numpy"]["largest_error"] < 1e-11
        assert size["numpy"]["quadrature_largest_error"] < 1e-11


@pytest.mark.parametrize("name", force.THESIS)
def test_numpy_sum_is_the_grid(name):
    scene = tweezer.load_scene(name)
    rays = numpy_sum.pupil(scene)
    assert len(rays.powers) == 7644
    places = scene.bead.radius * np.random.default_rng(1).normal(size=(20, 3))
    places = np.vstack([places, scene.start_position])
    by_grid = tweezer.optical_force(scene, places)
    by_numpy = [numpy_sum.force(scene, rays, place) for place in places]
    np.testing.assert_allclose(by_numpy, by_grid, rtol=0, atol=1e-7 * np.abs(by_grid).max())


def test_times_are_least_and_median_per_item(monkeypatch):
    """On a clock that only the calls move."""
    now = 0

    def waiting(*milliseconds):
        durations = iter(milliseconds)

        def wait():
            nonlocal now
            now += 1_000_000 * next(durations)

        return wait

    monkeypatch.setattr(time, "perf_counter_ns", lambda: now)
    untimed = 50
    groups = [
        [Call(waiting(untimed, 2, 8, 4), 4)],
        [Call(waiting(untimed, 6, 7, 9), 1), Call(waiting(untimed, 3, 2, 4), 1)],
    ]
    one, two = per_item(groups, rounds=3)
    assert one == pytest.approx((0.5e-3, 1e-3))
    assert two == pytest.approx((4e-3, 5e-3))


def test_places_are_where_they_say():
    for kind, places in force._kinds(force.FULL).items():
        for scene, positions in places:
            distance = np.linalg.norm(positions, axis=1) / scene.bead.radius
            low, high = force.BANDS.get(kind, (1, 20))
            assert ((low <= distance) & (distance <= high)).all()
            assert len(positions) == (1 if kind == force.STARTS else force.FULL.places)


def test_page_quotes_the_committed_results(committed):
    quoted = pages.quoted("force")
    assert quoted == report.block(committed)
    assert pages.quoted("waves") == waves_report.block(committed)
    assert not committed["quick"]
    (times,) = re.findall(r"\| quadrature at 1e-8, µs \|(.*)\|", quoted)
    measured = [committed["headline"]["by_place"][kind]["quadrature_us"] for kind in report.KINDS]
    assert [float(cell) for cell in times.split("|")] == pytest.approx(measured, rel=0.05)


def test_summary_page_quotes_the_committed_results():
    """Every result has a row, but for the tracks that are an example on another page."""
    quoted = pages.quoted("overview")
    assert quoted == summary_report.overview()
    results = {path.stem for path in (pages.ROOT / "tests/benchmarks/results").glob("*.json")}
    assert set(re.findall(r"\| `(\w+)` \w{8}\+? \|", quoted)) == results - {"real_tracks"}


def test_figure_shows_errors_of_zero(committed):
    results = json.loads(json.dumps(committed))
    results["places"]["inside"]["quadrature"][0]["median_error"] = 0.0
    drawn = [line.get_ydata() for axes in report.figure(results).axes for line in axes.lines]
    assert min(np.min(errors) for errors in drawn if len(errors)) > 0


def test_two_digits():
    values = (2134.5, 31.4, 1.04, 0.0516)
    assert [report.rounded(value) for value in values] == ["2100", "31", "1", "0.052"]


def test_needs_a_checkout(command_line, tmp_path, monkeypatch):
    elsewhere = tmp_path / "tweezer" / "cli" / "bench.py"
    monkeypatch.setattr(cli.bench, "__file__", str(elsewhere))
    done = command_line("bench", "force")
    assert done.code == 2
    assert done.err.strip().splitlines() == ["bench: requires a checkout of tweezer's sources"]


def test_quick_run_of_the_integration(command_line, tmp_path):
    done = command_line(
        "bench", "integrate", "--quick", "--out", "integrate.json", "--plot", "integrate.png"
    )  # fmt: skip
    assert (done.code, done.err) == (0, "")
    assert (tmp_path / "integrate.png").stat().st_size > 10_000
    results = json.loads((tmp_path / "integrate.json").read_text())
    well = results["motions"]["gaussian-well"]
    assert well["solvers_agree_to_um"] < 1e-6
    errors = {
        (entry["model"], entry["method"], entry["tolerance"]): entry["during_um"]
        for entry in well["entries"]
    }
    assert errors["full", "exponential", 1e-9] < 1e-6
    assert errors["full", "exponential", 1e-9] < errors["full", "exponential", 1e-6]
    # without inertia the bead is off by tau over the trap's time
    assert errors["first-order", "dop853", 1e-9] < 1e-2 * errors["overdamped", "dop853", 1e-9]
    assert integrate_report.block(results).startswith("<!-- bench-integrate -->")
    # another solver by address meets the same motion
    assert errors["full", "LSODA", 1e-10] < 1e-6
    bead = results["motions"]["thesis-990nm, rays, map"]
    exact = min(e["force_calls"] for e in bead["entries"] if e["method"] == "exponential")
    assert 0 < bead["least_force_calls"] < exact
    estimated = results["estimate"]
    assert estimated["least"] > estimate.LEAST
    assert estimated["median"] < estimate.MEDIAN
    assert estimated["failed"] == 0


@pytest.mark.parametrize(
    "changes",
    [{}, {"beam": {"torque": "thesis"}}, {"simulation": {"model": "scaled"}}],
    ids=["unscaled", "turned", "scaled"],
)
def test_peers_integrate_our_equations(changes):
    """The compiled right-hand side by address beside the one through Python."""
    scene = tweezer.load_scene("thesis-990nm").replace(simulation={"model": "full"})
    equations = bind(scene.replace(**changes))
    direct = peers.Direct(equations)
    y = equations.initial_state.copy()
    y[-6:] += np.linspace(1e-4, 2e-4, 6)
    y[:3] *= 0.1
    np.testing.assert_array_equal(direct.rates(0.0, y), equations.rhs(0.0, y))
    np.testing.assert_array_equal(direct.jacobian(0.0, y), equations.jacobian(0.0, y))
    assert direct.calls == 2


@pytest.mark.parametrize("terminal", [True, False], ids=["80 columns", "pipe"])
@pytest.mark.parametrize(
    ("name", "report"),
    [("force", report), ("bodies", bodies_report), ("rods", rods_report),
     ("integrate", integrate_report),
     ("brownian", brownian_report), ("fluid", fluid_report),
     ("wall", wall_report), ("scaling", scaling_report),
     ("depth", depth_report), ("calibrate", calibrate_report), ("hydro", hydro_report),
     ("heights", heights_report), ("camera", camera_report),
     ("free", free_report),
     ("diagram", diagram_report), ("sweep", sweep_report), ("fit", fit_report),
     ("view", view_report)],
)  # fmt: skip
def test_tables_can_be_read(name, report, terminal, monkeypatch, capsys):
    """Words are whole in a window of 80 columns, and in a pipe each row is a line; with signs."""
    monkeypatch.setattr(
        cli.tables, "OUT", Console(width=80, force_terminal=terminal, no_color=True)
    )
    for rows in report.tables(pages.committed(name)):
        cli.tables.print_rows(rows)
        shown = [[re.sub(r"\bum\b", "µm", cell).replace("+-", "±") for cell in row] for row in rows]
        printed = re.sub(r"\x1b\[[0-9;]*m", "", capsys.readouterr().out)
        lines = [line.split() for line in printed.splitlines() if line.strip(" ─")]
        if terminal:
            assert max(map(len, printed.splitlines())) <= 80
            words = {word.strip(":") for line in lines for word in line}
            cells = (cell for row in shown for cell in row)
            assert {word.strip(":") for cell in cells for word in cell.split()} <= words
        else:
            filled = [[word for cell in row for word in cell.split()] for row in shown]
            assert lines == [row for row in filled if row]


def test_quick_run_of_the_fluid(command_line, tmp_path):
    path = tmp_path / "fluid.json"
    command_line("bench", "fluid", "--quick", "--out", path)
    results = json.loads(path.read_text())
    coarse, fine = results["modes"]
    assert fine["poles"] == 2 * coarse["poles"]
    for quantity in ("velocity", "displacement", "spectrum", "relaxation", "tail"):
        assert fine[quantity] < 0.1 * coarse[quantity]
    (capture,) = results["captures"]
    assert capture["by_poles"][1]["error_um"] < 1e-5 < 0.06 < capture["without_um"]
    assert all(each["true_m"] <= each["told_m"] for each in results["told"]["runs"])
    assert fluid_report.figure(results).axes


def test_page_quotes_the_committed_fluid():
    """No reported error is below the true one. It is announced as three times the difference, and
    four leaves room for rounding.
    """
    committed = pages.committed("fluid")
    assert pages.quoted("fluid") == fluid_report.written(committed)
    runs = committed["told"]["runs"]
    assert len(runs) == 40
    for each in runs:
        assert each["true_m"] <= each["told_m"] < 4 * each["true_m"]


def test_quick_run_beside_a_wall(command_line, tmp_path):
    path = tmp_path / "wall.json"
    command_line("bench", "wall", "--quick", "--out", path)
    results = json.loads(path.read_text())
    bias = {each["scheme"]: each for each in results["bias"]}
    for scheme in ("heun", "one-call"):
        assert abs(bias[scheme]["mean"]) < 5 * bias[scheme]["mean_error"]
    assert bias["euler, no drift"]["mean"] < -50
    (passage,) = results["passages"]
    assert abs(passage["off"]) < 5 * passage["error"]
    assert wall_report.figure(results).axes


def test_page_quotes_the_committed_motion_beside_a_wall():
    """And what is asked of it: 1 % at a fifth of T and with inertia, passages, half the rate."""
    committed = pages.committed("wall")
    assert pages.quoted("wall") == wall_report.written(committed)
    for each in committed["bias"]:
        if each["scheme"] in ("heun", "one-call") and each["step"] <= 0.2:
            assert abs(each["mean"]) < 1
            assert abs(each["low"]) < 1
    assert all(abs(each["off"]) < max(1, 3 * each["error"]) for each in committed["passages"])
    assert all(abs(each["mean"]) < 1 for each in committed["inertia"])
    for each in committed["steps"]:
        if each["model"] == "overdamped" and each["walls"] == "one":
            assert each["rate"] > 0.5


def test_page_quotes_the_committed_integration():
    committed = pages.committed("integrate")
    quoted = pages.quoted("integrate")
    assert quoted == integrate_report.block(committed)
    assert not committed["quick"]


@pytest.fixture(scope="module")
def stiff_trap():
    """kappa tau = 0.1, in units of its own."""
    return brownian.Trap(
        tweezer.load_scene("silica-1um"), stiffness=0.1, mass=1.0, drag=1.0, tau=1.0, kT=2.0
    )


def inertial_euler_maruyama(trap, step):
    """<x^2> and <v^2> over their true values, by hand from the stationary covariance; step: tau."""
    slow = trap.kappa * step * trap.tau
    v2 = 1 / (1 - step / 2 - slow * (1 - 3 * step / 4 + slow * step / 4))
    return v2 * (1 - step / 2 + slow * step / 2), v2


def test_quick_run_of_brownian_motion(here, command_line, tmp_path):
    done = command_line(
        "bench", "brownian", "--quick", "--out", "brownian.json", "--plot", "brownian.png"
    )  # fmt: skip
    assert (done.code, done.err) == (0, "")
    assert (tmp_path / "brownian.png").stat().st_size > 10_000
    results = json.loads((tmp_path / "brownian.json").read_text())
    assert brownian_report.block(results).startswith("<!-- bench-brownian -->")
    committed = pages.committed("brownian")
    assert results.keys() == committed.keys()
    assert results["headline"].keys() == committed["headline"].keys()
    assert all(each["steps_per_s"] > 0 for each in results["rates"] + results["cores"])
    entries = {
        (name, brownian.way_of(entry), entry["step_trap_times"]): entry
        for name, of in results["wells"].items()
        for entry in of
    }
    # seeds are fixed; for others five standard errors would fail once in a million
    for name in (brownian.GAUSSIAN, brownian.MILD):
        entry = entries[name, brownian.DEFAULT, 0.2]
        assert abs(entry["x2_bias"]) < 0.003 + 5 * entry["x2_error"]
        assert abs(entry["v2_bias"]) < 0.001 + 5 * entry["v2_error"]
    harmonic = entries[brownian.HARMONIC, brownian.DEFAULT, 0.8]
    for key in ("x2", "v2", "corner"):
        assert abs(harmonic[f"{key}_bias"]) < 1e-6
    # overdamped Euler-Maruyama: <x^2> is 1/(1 - kappa h/2) times the true one, x' = (1 - kappa h) x
    euler = brownian.Way("overdamped", "euler-maruyama")
    entry = entries[brownian.HARMONIC, euler, 0.2]
    assert entry["x2_bias"] == pytest.approx(0.1 / 0.9, rel=1e-3)
    # inertia, which it leaves out, changes rates by kappa tau
    trap = brownian.trap_of_scene()
    corner = -math.log(0.8) / 0.2 - 1
    assert entry["corner_bias"] == pytest.approx(corner, abs=3 * trap.kappa * trap.tau)
    (entry,) = (
        each
        for (name, way, _), each in entries.items()
        if (name, way) == (brownian.MILD, brownian.Way("full", "euler-maruyama"))
    )
    x2, v2 = inertial_euler_maruyama(trap, 1.9)
    # the well's stiffness is 15 per cent above the trap's, on the average
    assert entry["x2_bias"] == pytest.approx(x2 - 1, abs=0.2 * (x2 - 1) + 5 * entry["x2_error"])
    assert entry["v2_bias"] == pytest.approx(v2 - 1, rel=0.05)


def test_page_quotes_the_committed_brownian_motion():
    committed = pages.committed("brownian")
    quoted = pages.quoted("brownian")
    assert quoted == brownian_report.block(committed)
    assert not committed["quick"]


@pytest.mark.parametrize("step", [0.1, 0.5, 1.0, 1.8])
def test_moments_of_euler_maruyama(stiff_trap, step):
    x2, v2 = inertial_euler_maruyama(stiff_trap, step)
    biases = brownian.euler_maruyama_bias(stiff_trap, step)
    assert biases == pytest.approx((x2 - 1, v2 - 1), rel=1e-9)
    linear = Linear(np.array([1.0]), np.zeros(1), np.array([2.0]), 0.0, np.zeros((3, 3)))
    weights = euler.weights(step, linear)
    moments = brownian.linear_moments(weights._replace(kappa=np.array([0.1])), [0, 1])
    assert moments[1] == pytest.approx(2.0 * v2, rel=1e-9)
    assert moments[2] == pytest.approx(moments[0], rel=1e-9)
    # x' = x + h v, and <x v> = -h <v^2>/2
    assert moments[3] == pytest.approx(moments[0] - step**2 * moments[1] / 2, rel=1e-9)


def test_needed_step_has_the_bias():
    trap = brownian.trap_of_scene()
    step = brownian.euler_maruyama_step(trap, 1e-3)
    assert inertial_euler_maruyama(trap, step)[0] - 1 == pytest.approx(1e-3, rel=1e-3)


def test_numpy_euler_maruyama(stiff_trap):
    """Against its stationary covariance; five standard errors fail once in a million seeds."""
    rng = np.random.default_rng(4)
    x, v = np.zeros((30_000, 3)), np.zeros((30_000, 3))
    brownian.numpy_euler_maruyama(lambda x: -0.1 * x, x, v, 0.5, 300, stiff_trap, rng)
    for values, true, ratio in zip(
        (x, v), (20.0, 2.0), inertial_euler_maruyama(stiff_trap, 0.5), strict=True
    ):
        error = math.sqrt(2 / values.size)
        assert np.mean(values**2) / (true * ratio) == pytest.approx(1, abs=5 * error)


def test_autocorrelation_in_a_harmonic_trap(stiff_trap):
    """Uhlenbeck and Ornstein, Phys. Rev. 36:823 (1930)."""
    times = np.array([0.0, 0.3, 2.0, 15.0])
    root = math.sqrt(1 - 4 * 0.1)
    slow, fast = (1 - root) / 2, (1 + root) / 2
    expected = (fast * np.exp(-slow * times) - slow * np.exp(-fast * times)) / root
    np.testing.assert_allclose(
        brownian.autocorrelation(stiff_trap, 0.0, times), expected, rtol=1e-9
    )


@pytest.mark.parametrize("quartic", [0.0, *brownian.QUARTICS])
def test_autocorrelation_in_a_quartic_trap(quartic):
    """Its last decay is the gap of the Schroedinger operator of the motion without inertia."""
    trap = brownian.trap_of_scene()
    before, after = brownian.autocorrelation(trap, quartic, np.array([5.0, 5.5]) / trap.kappa)
    x, dx = np.linspace(-9, 9, 4001, retstep=True)
    slope, curvature = x + quartic * x**3, 1 + 3 * quartic * x**2
    levels = eigh_tridiagonal(
        2 / dx**2 + slope**2 / 4 - curvature / 2, np.full(4000, -1 / dx**2),
        select="i", select_range=(0, 1), eigvals_only=True,
    )  # fmt: skip
    # inertia changes rates by kappa tau
    assert 2 * math.log(before / after) == pytest.approx(levels[1] - levels[0], rel=2e-3)


def test_control_variates():
    """What goes along is taken off; five standard errors fail once in a million seeds."""
    rng = np.random.default_rng(2)
    controls = [rng.normal(size=2000) for _ in range(2)]
    rest = 0.1 * rng.normal(size=2000)
    values = 0.3 + 2 * controls[0] - controls[1] + rest
    mean, error = brownian._controlled(values, controls)
    assert error == pytest.approx(0.1 / math.sqrt(2000), rel=0.1)
    assert mean == pytest.approx(0.3, abs=5 * error)


def test_quick_run_of_scaling(command_line, tmp_path):
    done = command_line(
        "bench", "scaling", "--quick", "--out", "scaling.json", "--plot", "scaling.png"
    )  # fmt: skip
    assert (done.code, done.err) == (0, "")
    assert (tmp_path / "scaling.png").stat().st_size > 10_000
    results = json.loads((tmp_path / "scaling.json").read_text())
    committed = pages.committed("scaling")
    assert results.keys() == committed.keys()
    assert results["plan"][0].keys() == committed["plan"][0].keys()
    assert scaling_report.block(results).startswith("<!-- bench-scaling -->")
    for each in results["plan"]:
        assert all(0 < entry["efficiency"] <= 1 for entry in each["cores"])
    # 8 bytes, and a checksum of 4 for each chunk
    assert 8 < results["bytes_per_number"] < 9


def test_page_quotes_the_committed_sweep():
    committed = pages.committed("sweep")
    assert pages.quoted("sweep") == sweep_report.block(committed)
    assert not committed["quick"]
    assert committed["killed"]["same_bytes"]
    assert committed["killed"]["kills"] == sweep.KILLS


def test_page_quotes_the_committed_pages():
    """A run under 3 MB and 1 s, an ensemble under 20 MB and 5 s, nothing in the console."""
    committed = pages.committed("view")
    assert pages.quoted("view") == view_report.block(committed)
    assert not committed["quick"]
    for each, megabytes, seconds in zip(committed["pages"], (3, 20), (1, 5), strict=True):
        assert each["megabytes"] < megabytes
        assert each["written_s"] < seconds
        assert each["console_messages"] == 0


def test_page_quotes_the_committed_scaling():
    committed = pages.committed("scaling")
    quoted = pages.quoted("scaling")
    assert quoted == scaling_report.block(committed)
    assert not committed["quick"]


@pytest.mark.parametrize(
    ("work", "cores", "expected"),
    [
        # as many rounds as it takes
        (scaling.Work(10, 6.0, 0.0, 0.0), 4, 18.0),
        # all wait for the process in charge, but for the first block
        (scaling.Work(50, 1.0, 0.0, 2.0), 10, 1.0 + 50 * 2.0),
        # and for the file system, which a block asks four times
        (scaling.Work(40, 1.0, 4.0, 0.0), 40, 0.25 + 40 * 4.0),
        # one core does one thing after the other
        (scaling.Work(5, 3.0, 0.5, 0.25), 1, 5 * 3.5 + 0.25),
    ],
)
def test_model_of_a_cluster(work, cores, expected):
    """Cases worked out by hand, and a start before them all."""
    found = scaling.makespan(work, cores, start_s=7.0, scatter=0.0)
    assert found == pytest.approx(7.0 + expected)


def test_quick_run_of_commands():
    """Of the help alone, which compiles nothing."""
    told = []
    results = commands.measure(quick=True, say=told.append)
    (alone,), (one,) = results["commands"], results["in_order"]
    assert alone["command"] == one["command"] == "tweezer --help"
    assert (alone["functions_kept"], one["functions_added"]) == (0, 0)
    assert alone["warm_cpu_s"] > 0
    assert [len(table) for table in commands_report.tables(results)] == [2, 2]


def test_page_quotes_the_committed_commands():
    results = pages.committed("commands")
    assert pages.quoted("commands") == commands_report.block(results)
    assert [each["command"] for each in results["commands"]] == [
        each.told for each in commands.COMMANDS
    ]


def test_a_command_that_fails_is_not_timed(tmp_path):
    with pytest.raises(RuntimeError, match=r"nothing\.toml"):
        commands._cost(("run", "nothing.toml"), tmp_path, os.environ)


def test_every_command_is_timed():
    """Exceptions are the benchmarks, `examples`, which copies a file, and `detect`, `optimise`,
    `rheology` and `stretch`, which are newer than the committed measurement.
    """
    timed = {each.arguments[0] for each in commands.COMMANDS}
    every = set(typer.main.get_command(cli.app).commands)
    assert every - timed == {"bench", "examples", "detect", "optimise", "rheology", "stretch"}


def test_durations():
    values = (3.2, 90, 7200, 2e5, 1e8)
    assert [scaling_report.duration(value) for value in values] == [
        "3.2 s", "1.5 min", "2 h", "2.3 days", "3.2 years"
    ]  # fmt: skip


def test_page_quotes_the_committed_calibration():
    assert pages.quoted("calibrate") == calibrate_report.block(pages.committed("calibrate"))


def test_page_quotes_the_committed_calibration_of_what_a_camera_saw():
    """And what is asked of it: of every method 93 to 97 % of the numbers that are trusted."""
    results = pages.committed("camera")
    assert pages.quoted("camera") == camera_report.block(results)
    assert {each["rate"] for each in results["studies"]} == {500, 2500}
    for study in results["studies"]:
        assert study["records"] == 200
        for count, inside in camera_report.pooled(study).values():
            assert count >= 198
            assert 0.93 < inside / count < 0.97


def test_page_quotes_the_committed_diffusion_of_free_beads():
    """And what is asked of it: 93 to 97 % of the intervals hold the diffusion."""
    results = pages.committed("free")
    assert pages.quoted("free") == free_report.block(results)
    for study in results["studies"]:
        assert study["tracks"] == 200
        assert study["seen_free"] >= 199
        assert 0.93 <= study["inside"] / study["seen_free"] <= 0.97
        assert abs(study["mean_ratio"] - 1) < 0.02


def test_page_quotes_what_the_real_tracks_tell():
    """No trap is seen in any; the 3 um beads agree with their displacements lag by lag."""
    results = pages.committed("real_tracks")
    assert pages.quoted("real-tracks") == real_tracks.block(results)
    assert len(results["tracks"]) == 10
    for track in results["tracks"]:
        assert track["axes"] == ["x", "y"]
        if track["name"].startswith("3um"):
            low, high = track["interval"]
            assert low < track["by_pairs"][0] < high


def test_displacements_lag_by_lag():
    """Of a track of three steps of 1, 2 and 3 m in 2 s each, whose mean is taken off."""
    positions = np.array([[0.0], [1.0], [3.0], [6.0]])
    assert real_tracks._displacement(positions[:, 0], 1) == pytest.approx(2 / 3)
    steep = np.cumsum(np.random.default_rng(1).standard_normal(50_000))
    one, other = real_tracks._by_pairs(steep, 2.0)
    assert one == pytest.approx(0.25, rel=0.05)
    assert other == pytest.approx(0.25, rel=0.1)


def test_tracks_of_free_beads_are_counted():
    """Two short ones, of one of which a trap was seen."""
    tracks = free.analysed(free.STUDIES[3], 1, 2)
    assert all(track.seen_free and 0.3 < track.ratio < 3 for track in tracks)
    found = free.judged([[*tracks, None]])
    assert (found["tracks"], found["seen_free"]) == (3, 2)
    assert found["alone_inside"] == sum(track.alone for track in tracks)


def test_what_a_camera_saw_is_counted():
    """Two short records: of each axis, by each method, and of the truth they are compared with."""
    found = camera.judged([camera.calibrated(camera.STUDIES[0], 1, 2, frames=1000)])
    ways = {each["by"] for each in found["numbers"]}
    assert ways >= {f"{axis}, power spectrum" for axis in "xyz"}
    for each in found["numbers"]:
        assert each["numbers"] <= 2
        assert abs(each["mean_score"]) < 4


def test_page_quotes_the_committed_calibration_of_fast_records():
    assert pages.quoted("hydro") == hydro_report.block(pages.committed("hydro"))


def test_page_quotes_the_committed_calibration_beside_a_wall():
    assert pages.quoted("heights") == heights_report.block(pages.committed("heights"))


def test_page_quotes_the_committed_fits():
    """Fewer than 51 of 60 intervals of 95 % contain the true value once in 2,900 (binomial)."""
    results = pages.committed("fit")
    assert pages.quoted("fit") == fit_report.block(results)
    *others, degenerate = results["studies"]
    for study in others:
        for of in study["keys"].values():
            assert of["inside"] >= 0.84 * study["records"]
            assert abs(of["score"]) < max(0.5, 4 * of["score_error"])
    for study in others[:2]:
        assert study["records"] == 60
        for of in study["keys"].values():
            assert abs(of["score"]) < 0.5
    assert "fits as well" in degenerate["statement"]


def test_page_quotes_the_committed_trapping_diagram():
    results = pages.committed("diagram")
    assert pages.quoted("diagram") == diagram_report.block(results)
    numbers = diagram_report.NUMBERS.read_text(encoding="utf-8").splitlines()
    assert len(numbers) == 1 + len(results["least"]) * len(diagram.TIMES)
    for each in results["ensembles"]:
        assert abs(diagram_report.off(each)) < 4


@pytest.mark.parametrize(
    "study", [heights.STEADY[1], heights.DRIVEN[1], heights.FLUID[1], heights.SERIES[0]]
)
def test_records_beside_a_wall_are_counted(study):
    """Two short ones: numbers of each way, and of the truth that they are compared with."""
    short = study._replace(samples=2**14 if study.kind == "driven" else 2**13)
    found = heights.judged([heights.calibrated(short, 1, 2)])
    ways = {(each["by"].split(", ")[-1], each["quantity"]) for each in found["numbers"]}
    assert (
        ways
        >= {
            "steady": {("metres", "drag"), ("volts", "m/V"), ("uncertain height", "drag")},
            "driven": {("stage", "stiffness"), ("stage", "m/V")},
            "fluid": {("metres", "drag"), ("volts", "m/V"), ("pylake", "m/V")},
            "series": {("all given", "wall"), ("both fitted", "drag far away")},
        }[study.kind]
    )
    for each in found["numbers"]:
        assert each["numbers"] == 2
        if "pylake" not in each["by"]:
            assert abs(each["mean_score"]) < 4


@pytest.mark.parametrize("study", [hydro.PASSIVE[1], hydro.DETECTORS[3], hydro.DRIVEN[0]])
def test_fast_records_are_counted(study):
    """Two short ones: numbers of each way, and of the truth that they are compared with."""
    short = study._replace(samples=2**16 if study.drive else 2**14)  # pylake wants periods
    found = hydro.judged([hydro.calibrated(short, 1, 2)])
    ways = {each["by"] for each in found["numbers"]}
    assert ways >= {
        "passive": {"volts", "volts, no inertia", "pylake", "pylake, no inertia"},
        "detector": {"drag fitted"}, "driven": {"volts", "pylake"},
    }[study.kind]  # fmt: skip
    for each in found["numbers"]:
        assert each["numbers"] <= 2
        if "no inertia" not in each["by"] and "as called" not in each["by"]:
            assert abs(each["mean_score"]) < 4
    ours, theirs = (
        [each for each in found["numbers"] if each["by"] == by] for by in ("volts", "pylake")
    )
    for a, b in itertools.product(ours, theirs):
        if a["quantity"] == b["quantity"]:  # of the same records, within both errors
            assert abs(a["bias"] - b["bias"]) < a["uncertainty"] + b["uncertainty"]


def test_records_of_the_calibration_are_counted():
    """Two of a camera: every one is inside or outside, marked or not, and says by what."""
    study = calibrate.Study(50e-6, 1 / 2500, 1000, True, 1.0, False)
    counted = calibrate._judged(study, calibrate.calibrated(study, 1, 2))
    assert (counted["records"], counted["clean"]) == (2, 0)
    assert sum(counted["findings"].values()) >= 2
    for each in counted["methods"].values():
        assert each["records"] == 2
        assert 0 <= each["unmarked_and_inside"] <= min(each["unmarked"], each["inside"])
