"""What the pages of an ensemble, a trap and a sweep have: the numbers of what they show."""

import dataclasses
import math
import re

import numpy as np
import pytest
from matplotlib.figure import Figure

import tweezer
from tweezer.plots.scene import caveat_note, draw_cones
from tweezer.scene.heading import heading, of_changes
from tweezer.trap.holding import Lifetime
from tweezer.viewing import of_ensemble, of_sweep, of_trap, saved_trap
from tweezer.viewing.page import Page
from tweezer.viewing.setting import of_the_picture, scene_facts


@pytest.fixture(scope="module")
def ensemble(cloud):
    return of_ensemble.content(cloud)


def test_beads_are_where_the_ensemble_has_them(ensemble, cloud):
    for k, axis in enumerate("xyz"):
        packed = ensemble.arrays[axis]
        values, given = packed.values(), cloud["position"].values[:, :, k].T
        assert packed.type == "uint16"
        assert np.array_equal(np.isnan(values), np.isnan(given))
        assert np.nanmax(np.abs(values - given)) <= packed.rounding * (1 + 1e-9)
        assert packed.rounding <= np.ptp(given[~np.isnan(given)]) / 131068 * (1 + 1e-6)


def test_means_and_spreads_are_of_the_beads_left(ensemble, cloud):
    position = cloud["position"].values
    left = (~np.isnan(position[:, :, 0])).sum(axis=0)
    assert ensemble.arrays["left"].values() == pytest.approx(left)
    assert left[-1] < left[0]
    spread = np.nanstd(position, axis=0, ddof=1)
    for name, expected in (
        ("mean", np.nanmean(position, axis=0)),
        ("spread", spread),
        ("mean_error", spread / np.sqrt(left)[:, None]),
    ):
        size = np.abs(expected).max()
        assert ensemble.arrays[name].values() == pytest.approx(expected, rel=1e-6, abs=1e-7 * size)
    # of normal values the error of a spread is s/sqrt(2 (n - 1))
    normal = np.random.default_rng(3).normal(0, 2e-8, (4000, 3, 3))
    data = cloud.isel(trajectory=np.zeros(4000, int), time=slice(3)).copy()
    data["position"] = data["position"].dims, normal
    data["lost_time"] = data["lost_time"].dims, np.full(4000, np.inf)
    error = of_ensemble.content(data).arrays["spread_error"].values()
    assert error == pytest.approx(2e-8 / math.sqrt(2 * 3999), rel=0.06)


def test_too_many_positions_are_thinned_and_it_is_said(cloud, monkeypatch):
    monkeypatch.setattr(of_ensemble, "_MOST", 40)
    monkeypatch.setattr(of_ensemble, "_TIMES", 6)
    monkeypatch.setattr(of_ensemble, "_READ", 50)
    content = of_ensemble.content(cloud)
    kept = [0, 2, 4, 6, 8, 10, 11]
    drawn = content.facts["drawn"]
    assert content.arrays["x"].shape == (len(kept), drawn)
    assert drawn * content.arrays["x"].shape[0] <= 40
    taken = np.linspace(0, cloud.sizes["trajectory"] - 1, drawn).round().astype(int)
    expected = cloud["position"].values[taken][:, kept, 2].T
    assert content.arrays["z"].values() == pytest.approx(expected, abs=1e-10, nan_ok=True)
    assert content.arrays["time"].values() == pytest.approx(cloud["time"].values[kept])
    mean = np.nanmean(cloud["position"].values[:, kept], axis=0)
    assert content.arrays["mean"].values() == pytest.approx(mean, rel=1e-5, abs=1e-13)
    assert f"draws {drawn} of {cloud.sizes['trajectory']} beads" in " ".join(content.notes)
    assert "one in 2 of 12 times, and the last" in " ".join(content.notes)


def test_of_very_many_times_a_bead_is_drawn(monkeypatch):
    monkeypatch.setattr(of_ensemble, "_MOST", 40)
    monkeypatch.setattr(of_ensemble, "_TIMES", 6)
    kept, beads, taken = of_ensemble._thinned(80, 1)
    assert (len(kept), beads, taken.tolist()) == (41, 1, [0])


def test_a_name_that_is_no_text_is_shown(ensemble, tmp_path):
    named = dataclasses.replace(ensemble, title="bad\udcff.json")
    page = Page(named).save(tmp_path / "page.html").read_text(encoding="utf-8")
    assert "bad\ufffd.json" in page


def test_at_the_end_is_at_the_end(cloud):
    """Also where no bead is left by then, or one, which has no spread."""
    gone = cloud.copy(deep=True)
    gone["position"][1:, 6:], gone["lost_time"][1:] = np.nan, 1e-3
    rows = {row.name: row for row in of_ensemble.content(gone).summary}
    row = rows["spread of x of the remaining beads at the end"]
    assert (row.value, row.trusted) == ("not known", False)
    last = 1e6 * float(gone["position"][0, -1, 0])
    row = rows["mean of x of the remaining beads at the end"]
    assert float(row.value.removesuffix(" µm")) == pytest.approx(last, rel=1e-3)
    assert row.error == "not known"
    gone["position"][0, 6:], gone["lost_time"][0] = np.nan, 1e-3
    rows = [
        row for row in of_ensemble.content(gone).summary if "remaining beads at the end" in row.name
    ]
    assert len(rows) == 6
    assert {row.value for row in rows} == {"no beads remain"}


def test_trajectories_that_are_not_computed_are_left_out(cloud):
    stopped = cloud.copy(deep=True)
    stopped["lost_time"][2] = np.nan
    stopped["position"][2] = np.nan
    content = of_ensemble.content(stopped)
    assert content.facts["beads"] == cloud.sizes["trajectory"] - 1
    assert "1 of its" in content.warning
    others = np.delete(cloud["position"].values[:, 4, 0], 2)
    assert content.arrays["x"].values()[4] == pytest.approx(others, abs=1e-10, nan_ok=True)


def test_statistics_alone_have_a_page(gathered):
    found, content = gathered, of_ensemble.content(gathered)
    expected = np.sqrt(found["position_variance"].values)
    assert content.arrays["spread"].values() == pytest.approx(expected, rel=1e-6, nan_ok=True)
    density, bins = (content.arrays[name].values() for name in ("density", "bin"))
    for axis, values in zip("xyz", density, strict=True):
        counted = float(found["density"].sel(axis=axis).sum())
        width = float(found["bin"][1] - found["bin"][0])
        # bins at the end that fill no joined one are left out
        assert values.sum() * (bins[1] - bins[0]) == pytest.approx(counted * width, rel=0.01)


def test_numbers_of_a_sweep_are_those_of_its_cases(diagram):
    content = of_sweep.content(diagram)
    given = diagram.sortby("bead.diameter")
    for name, factor in (("stiffness", 1e6), ("escape_energy", 1.0), ("stiffness_error", 1e6)):
        values = content.arrays[name].values()
        assert values == pytest.approx(factor * given[name].values, rel=1e-7, nan_ok=True)
    # one that is infinite has no part in what rounding changes
    lifetime, endless = given["lifetime"].values, content.arrays["lifetime_endless"].values()
    assert np.array_equal(endless, np.isinf(lifetime))
    assert content.arrays["lifetime"].largest == lifetime[np.isfinite(lifetime)].max()
    for name in ("outcome", "reason"):
        numbers = content.arrays[name].values().astype(int)
        assert np.array_equal(
            np.array(content.facts["words"][name])[numbers], given[name].values.astype(str)
        )
    (across,), (down,) = (axis["keys"] for axis in content.facts["axes"])
    assert across["values"] == pytest.approx([0.5, 0.8, 1.2])
    assert (across["unit"], down["unit"]) == ("µm", "mW")
    assert (across["log"], down["log"]) == (False, True)


@pytest.mark.filterwarnings("ignore:.*has no digest")
def test_a_saved_trap_is_the_trap(trap, tmp_path):
    trap, path = dataclasses.replace(trap), tmp_path / "trap.json"
    vars(trap)["lifetime"] = Lifetime(3600.0, 30.0, 1e-5)
    vars(trap)["lifetime_without_light"] = Lifetime(9.0, 0.1, 1e-5)
    tweezer.save(trap, path)
    saved, version = saved_trap.load_trap(path)
    # Newton's method asked where the light has no force; the trap's error is of where it has one
    assert 0 < trap.force_error < 1e-6 * max(escape.force for escape in trap.escapes)
    assert saved == trap
    assert version == tweezer.__version__
    assert (saved.scene, saved.lifetime) == (trap.scene, trap.lifetime)
    assert saved.lifetime_without_light == trap.lifetime_without_light
    whole = re.sub(r',\s*"sha256": "[^"]*"', "", path.read_text())  # as an earlier version wrote it
    assert whole.count('"residual"') > 1
    for wrong in (
        "{}",
        "[]",
        whole.replace('"stable": true', '"stable": "perhaps"'),
        whole.replace('"error": 30.0', '"error": null'),
        re.sub('"residual": [^,]*', '"residual": 1', whole, count=1),
        re.sub(r'"escapes": \[.*?\n    \]', '"escapes": []', whole, flags=re.DOTALL),
    ):
        assert wrong != whole
        path.write_text(wrong)
        with pytest.raises(tweezer.ResultError, match="not a saved trap"):
            saved_trap.load_trap(path)


def test_a_cover_glass_is_a_wall_of_that_name():
    scene = tweezer.load_scene("silica-1um")
    lens = {"cover": {"depth": 5e-6, "refractive_index": 1.518}}
    glass = {"z": -5e-6, "normal": 1, "name": "cover glass"}
    assert scene_facts(scene)["walls"] == []
    assert scene_facts(scene.replace(lens=lens))["walls"] == [glass]
    wall = {"position": -5e-6, "opposite": 9e-6}
    assert scene_facts(scene.replace(lens=lens, wall=wall))["walls"] == [
        glass, {"z": 9e-6, "normal": -1, "name": "wall"},
    ]  # fmt: skip


@pytest.mark.parametrize(("aperture", "index"), [(1.25, 1.518), (1.4, 1.518), (1.25, None)])
def test_the_cone_of_light_is_that_in_the_medium(aperture, index):
    """In figures as on pages: by the sine condition sin(theta) = NA/n, whatever lies before."""
    lens = {"numerical_aperture": aperture, "cover": {"depth": 5e-6, "refractive_index": 1.518}}
    scene = tweezer.load_scene("silica-1um").replace(lens=lens)
    n = scene.medium.refractive_index
    if index is None:  # a cover of the index of the medium
        scene = scene.replace(lens={"cover": {"refractive_index": n}})
    sine = min(aperture / n, 0.999)
    (beam,) = scene_facts(scene)["beams"]
    assert math.sin(beam["half_angle"]) == pytest.approx(sine, rel=1e-12)
    figure = Figure()
    axes = figure.add_subplot()
    draw_cones(axes, scene, 1.0, np.array([1.0, 0.0]))
    tip, edge, _, _ = axes.patches[0].get_xy()
    across, along = np.abs(edge - tip)
    assert across / math.hypot(across, along) == pytest.approx(sine, rel=1e-12)
    told = "nominal focus, without the spherical aberration"
    assert any(told in note for note in of_the_picture(scene)) == (index is not None)
    assert (told in caveat_note(scene)) == (index is not None)


@pytest.mark.parametrize(
    ("changes", "told"),
    [({}, "1 um silica bead in water, 1064 nm, 50 mW through an NA 1.25 objective"),
     ({"bead": {"diameter": "0.8um"}, "medium": {"temperature": 293.0}},
      "silica-1um with bead diameter 0.8 um and temperature 293 K"),
     ({"forces": {"brownian": True, "gravity": False}, "start": {"position": [0, 0, 1e-6]},
       "simulation": {"samples": 5, "duration": 2e-3}},
      "silica-1um with thermal motion, no gravity, start position (0, 0, 1) um and 2 more changes"),
    ],
)  # fmt: skip
@pytest.mark.filterwarnings("ignore::tweezer.PhysicsWarning")
def test_a_heading_names_what_was_changed(changes, told):
    scene = tweezer.load_scene("silica-1um").replace(**changes)
    assert heading(scene, scene.title) == told
    assert heading(scene, "a title of its own") == "a title of its own"
    assert all(key in " ".join(of_changes(scene)) for key in scene.changed)


def test_tables_of_a_trap_reach_over_what_is_shown(trap):
    content = of_trap.content(trap)
    table, box = content.facts["tables"][0], content.facts["box"]
    _, _, tall, wide = content.arrays["table_0"].shape
    assert content.arrays["table_0"].shape[0] == 3  # light that is not round
    # the first node of either is one before the first that is used, and the last one after
    assert table["low"] + table["step"] <= box["low"]
    assert table["low"] + table["step"] * (tall - 2) >= box["high"]
    assert table["step"] * (wide - 3) >= math.hypot(box["across"], box["across"])
    assert content.arrays["errors_0"].values().max() < 1e-3 * content.facts["largest"]
    assert "inf" not in " ".join(row.value for row in content.summary)
    assert [row.value for row in content.summary if row.name == "outcome"] == ["held"]
