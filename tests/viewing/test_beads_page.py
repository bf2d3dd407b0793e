"""The page of a run of several beads: its numbers, and where beads and tethers are drawn."""

import numpy as np
import pytest
from selenium.webdriver.support.wait import WebDriverWait

import tweezer
from tweezer.results.io import scene_of
from tweezer.viewing import of_beads

NAMES = ("low", "high", "side")
RADII = (0.5, 0.4, 0.3)


@pytest.fixture(scope="module")
def run():
    """Three dark beads that sink: two of them tied, the third to a point."""
    data = tweezer.load_scene("silica-1um").model_dump(exclude_none=True)
    starts = ([0, 0, 0], [0, 0, 2e-6], [1.5e-6, 0, 0])
    data["bead"] = [
        {"name": name, "radius": 1e-6 * radius, "material": "silica", "start": start}
        for name, radius, start in zip(NAMES, RADII, starts, strict=True)
    ]
    data["tether"] = [
        {"model": "spring", "between": ["low", "high"], "stiffness": 1e-6},
        {"model": "spring", "between": ["side"], "point": [3e-6, 0, 1e-6], "stiffness": 1e-7},
    ]
    data["start"], data["forces"] = {}, {"optical": False}
    data["simulation"] = {"duration": 0.02, "samples": 21}
    return tweezer.simulate(data)


def test_arrays_and_summary_are_those_of_the_run(run, monkeypatch):
    content = of_beads.content(run)
    for name in ("time", "position", "distance", "force_between"):
        assert content.arrays[name].values() == pytest.approx(run[name].values, rel=1e-6, abs=1e-20)
    assert [each["name"] for each in content.facts["beads"]] == list(NAMES)
    assert [each["beads"] for each in content.facts["tethers"]] == [[0, 1], [2]]
    rows = {row.name: row.value for row in content.summary}
    gap = float(rows["smallest gap, low, high"].removesuffix(" nm"))
    assert gap == pytest.approx(1e9 * float(run.gap[:, 0].min()), rel=1e-3)
    assert "mean force between, low, side" not in rows
    assert content.facts["resolved"]
    # the pair that stays farthest apart is left out
    monkeypatch.setattr(of_beads, "_MOST", 2)
    few = of_beads.content(run)
    kept = [k for k in range(3) if k != int(np.argmax(run.distance.values.min(axis=0)))]
    assert few.facts["pairs"] == [run.pair.values[k] for k in kept]
    assert few.arrays["distance"].values() == pytest.approx(run.distance.values[:, kept], rel=1e-6)
    assert any("2 of 3 pairs" in note for note in few.notes)


def test_samples_of_thermal_motion_are_joined_if_they_are_close(run):
    """The samples are 1 ms apart: 10 steps, or 50."""
    thermal = scene_of(run).replace(forces={"brownian": True}, simulation={"method": "heun"})
    for step, resolved in ((1e-4, True), (2e-5, False)):
        about = {"scene": thermal.model_dump_json(exclude_none=True), "step": step, "seed": 1}
        content = of_beads.content(run.assign_attrs(about))
        assert content.facts["resolved"] == resolved
        assert any("drawn as points" in note for note in content.notes) != resolved


def test_beads_and_tethers_are_drawn_where_they_are(browser, run, tmp_path):
    page = tweezer.view(run).save(tmp_path / "page.html")
    calm = [{"name": "prefers-reduced-motion", "value": "reduce"}]
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": calm})
    browser.get(page.as_uri())
    WebDriverWait(browser, 30).until(
        lambda driver: driver.execute_script("return !!window.tweezer?.duration")
    )
    sample = 15
    browser.execute_script("tweezer.seek(arguments[0])", float(run.time[sample]))
    position = 1e6 * run.position.values[sample]
    for k in range(3):
        drawn = browser.execute_script("return tweezer.bead(arguments[0])", k)
        assert drawn == pytest.approx(position[k], abs=1e-4)
    line = position[1] - position[0]
    line /= np.linalg.norm(line)
    ends = browser.execute_script("return tweezer.tether(0)")
    expected = [position[0] + RADII[0] * line, position[1] - RADII[1] * line]
    assert np.array(ends) == pytest.approx(np.array(expected), abs=1e-4)
    _, point = browser.execute_script("return tweezer.tether(1)")
    assert point == pytest.approx([3, 0, 1], abs=1e-4)
    titles = [each.text for each in browser.find_elements("css selector", ".plot h2")]
    assert titles == [
        "Displacement in z (nm)",
        "Distance of the centres (µm)",
        "Force between (pN)",
    ]
    assert browser.get_log("browser") == []
