"""The benchmark of rods runs, counts rightly, and the documentation quotes what was committed."""

import json

import numpy as np
import pytest

from tests.benchmarks import pages, rods, rods_report
from tests.benchmarks.pose_grid import Nodes


def test_quick_run_of_rods(command_line, tmp_path):
    done = command_line("bench", "rods", "--quick", "--out", "rods.json", "--plot", "rods.png")
    assert (done.code, done.err) == (0, "")
    assert (tmp_path / "rods.png").stat().st_size > 10_000
    results = json.loads((tmp_path / "rods.json").read_text())
    committed = pages.committed("rods")
    assert results.keys() == committed.keys()
    for name in ("hopping", "one_trap"):
        assert results[name][0].keys() == committed[name][0].keys()
        assert results[name][0]["path_rms_kT"] < 0.01
    assert results["rotations"]["length_error"] < 1e-15
    assert results["rotations"]["orientation_error_rad"] < 1e-11


def test_page_quotes_the_committed_rods():
    committed = pages.committed("rods")
    assert pages.quoted("rods") == rods_report.block(committed)
    assert not committed["quick"]
    assert committed["time"]["ratio"] < 1.5
    *_, opposed = committed["hopping"]
    for quantity in ("hops", "flips"):
        rate, error = opposed[f"{quantity}_per_s"]
        for bound in opposed[f"{quantity}_at_most_per_s"]:
            assert 0.9 * bound - 4 * error < rate < bound + 4 * error
    *_, opposed = committed["one_trap"]
    for (share, error), expected in zip(
        opposed["runs"][0]["shares"], opposed["shares_by_energy"][0], strict=True
    ):
        assert abs(share - expected) < 4 * error
    top = committed["top"]
    for quantity in ("rotation", "heat"):
        deviation, error = top[f"{quantity}_deviation"]
        assert abs(deviation) < 0.003 + 4 * error
    assert committed["rotations"]["turns"] > 1e8
    assert committed["rotations"]["length_error"] < 1e-15


def test_passages_are_counted_between_cores_only():
    values = np.array([0.0, 1, 0.4, 1, 0, -0.4, 0, -1, -0.4, 1, 1])
    np.testing.assert_array_equal(
        np.flatnonzero(rods.passages(values, 0.5)), [7, 9]
    )  # first entry is none


def test_work_of_nodes_is_the_integral_from_the_origin():
    nodes = Nodes.of(-1.0, 3.0, 7, 0.5)
    np.testing.assert_allclose(nodes.work @ nodes.at**5, (nodes.at**6 - 0.5**6) / 6, atol=1e-10)
    assert nodes.weight @ nodes.at**4 == pytest.approx((3**5 + 1) / 5)
