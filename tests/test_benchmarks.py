"""The benchmarks run, compare like with like, and the README quotes what was committed."""

import json
import math
import re
import time

import numpy as np
import pytest

import tweezer
from tests.benchmarks import force, integrate_report, numpy_sum, report
from tests.benchmarks.timing import Call, per_item
from tweezer import cli


@pytest.fixture(scope="module")
def committed():
    return report.read()


def shape(value):
    """Keys without their numbers."""
    return {key: shape(entry) for key, entry in value.items()} if isinstance(value, dict) else None


def numbers(value):
    return [n for entry in value.values() for n in numbers(entry)] if shape(value) else [value]


def test_quick_run(command_line, tmp_path, monkeypatch, committed):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    done = command_line(
        "bench", "force", "--quick", "--out", "force.json", "--plot", "force.png"
    )  # fmt: skip
    assert (done.code, done.err) == (0, "")
    assert "a ray that hits" in done.out
    assert (tmp_path / "force.png").stat().st_size > 10_000
    results = json.loads((tmp_path / "force.json").read_text())
    assert shape(results["headline"]) == shape(committed["headline"])
    assert all(math.isfinite(n) and n >= 0 for n in numbers(results["headline"]))
    for kind, of in results["headline"]["by_place"].items():
        assert of["quadrature_largest_error"] < 1e-8, kind
        assert of["quadrature_largest_error"] < of["grid_largest_error"], kind
        assert of.get("map_largest_error_over_largest_force", 0) < 1e-7, kind


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


def test_readme_quotes_the_committed_results(committed):
    (quoted,) = report.BLOCK.findall(report.README.read_text(encoding="utf-8"))
    assert quoted == report.block(committed)
    assert not committed["quick"]
    (times,) = re.findall(r"\| quadrature at 1e-8, µs \|(.*)\|", quoted)
    measured = [
        committed["headline"]["by_place"][kind]["quadrature_us"] for kind in report.HEADINGS[1:]
    ]
    assert [float(cell) for cell in times.split("|")] == pytest.approx(measured, rel=0.05)


def test_figure_shows_errors_of_zero(committed):
    results = json.loads(json.dumps(committed))
    results["places"]["inside"]["quadrature"][0]["median_error"] = 0.0
    drawn = [line.get_ydata() for axes in report.figure(results).axes for line in axes.lines]
    assert min(errors.min() for errors in drawn) > 0


def test_two_digits():
    values = (2134.5, 31.4, 1.04, 0.0516)
    assert [report.rounded(value) for value in values] == ["2100", "31", "1", "0.052"]


def test_needs_a_checkout(command_line, tmp_path, monkeypatch):
    monkeypatch.setattr(cli, "__file__", str(tmp_path / "tweezer" / "cli.py"))
    done = command_line("bench", "force")
    assert done.code == 2
    assert done.err.strip().splitlines() == [
        "bench: runs from a checkout of tweezer's sources, which this is not"
    ]


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


def test_readme_quotes_the_committed_integration():
    committed = integrate_report.read()
    (quoted,) = integrate_report.BLOCK.findall(report.README.read_text(encoding="utf-8"))
    assert quoted == integrate_report.block(committed)
    assert not committed["quick"]
