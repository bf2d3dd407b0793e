"""A trap over the height of its focus: against scenes one by one, and against the cover's face."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import tweezer
from tests import readable
from tests.reference import wall
from tweezer.plots import heights_figure, run_figure, trap_figure
from tweezer.trap import heights
from tweezer.values.errors import SceneError

COVER = {"lens": {"cover": {"refractive_index": 1.518, "depth": "3 um"}}}


@pytest.fixture(scope="module")
def silica():
    return tweezer.load_scene("silica-1um")


@pytest.fixture(scope="module")
def over_glass(silica):
    heights = np.array([0.8, 1.5, 3.0, 6.0]) * 1e-6
    return tweezer.trap_over_heights(silica.replace(**COVER), heights)


def test_every_height_is_a_scene_of_its_own(silica, over_glass):
    """Light, wall and drag from the same height: what `characterise` has of that scene."""
    for at in (over_glass.isel(height=i) for i in (0, 3)):
        height = float(at["height"])
        scene = silica.replace(
            lens={"cover": {"refractive_index": 1.518, "depth": height}},
            wall={"side": "above"}, start={"position": [0.0, 0.0, 0.0]},
            medium={"inertia": "none"},
        )  # fmt: skip
        assert scene.wall.position == -height
        place = tweezer.characterise(scene).equilibrium
        np.testing.assert_allclose(at["equilibrium"], place.position, rtol=0, atol=1e-15)
        np.testing.assert_allclose(at["stiffness"], np.diag(place.stiffness), rtol=1e-9)
        gap = place.position[2] + height - scene.bead.radius
        assert float(at["gap"]) == pytest.approx(gap, rel=1e-9)
        assert float(at["equilibrium_error"]) < 1e-13


def test_no_map_is_made_for_each_height(silica):
    """With a cover the light is another one at each, so that the quadrature computes it."""
    mapped = silica.replace(optics={"evaluator": "map"})
    assert heights.at_height(mapped, 2e-6).optics.evaluator == "map"
    assert heights.at_height(mapped.replace(**COVER), 2e-6).optics.evaluator == "quadrature"


def test_deeper_the_aberration_shifts_and_softens_the_trap(over_glass):
    """A focus in water behind glass lies nearer to the glass, as the marginal rays say: by more
    than paraxial ones, 1 - n_m/n_1 of the depth.
    """
    shift = np.diff(over_glass["equilibrium"].sel(axis="z")) / np.diff(over_glass["height"])
    paraxial = 1 - 1.326 / 1.518
    assert ((shift < -paraxial) & (shift > -3 * paraxial)).all()
    assert (np.diff(over_glass["stiffness"].sel(axis="z")) < 0).all()
    assert (over_glass["state"] == "held").all()


def test_without_a_cover_the_light_is_the_same_and_the_drag_is_the_walls(silica):
    """Drag away from the wall and along it by the exact series."""
    heights = np.array([0.55, 1.0, 5.0]) * 1e-6
    free = tweezer.characterise(silica).equilibrium
    found = tweezer.trap_over_heights(silica, heights)
    np.testing.assert_allclose(found["equilibrium"].sel(axis="z"), free.position[2], rtol=1e-9)
    np.testing.assert_allclose(
        found["stiffness"], np.tile(np.diag(free.stiffness), (3, 1)), rtol=1e-6
    )
    for at in (found.isel(height=i) for i in range(3)):
        gap = float(at["gap"]) / silica.bead.radius
        away, along, *_ = wall.mobilities(gap, 12)
        for axis, mobility in (("x", along), ("y", along), ("z", away)):
            drag = float(at["drag"].sel(axis=axis) / at["free_drag"])
            assert drag == pytest.approx(float(1 / mobility), rel=1e-6)
    corner = found["stiffness"] / (2 * math.pi * found["drag"])
    np.testing.assert_allclose(found["corner_frequency"], corner, rtol=1e-12)


def test_heights_at_which_nothing_holds_the_bead_are_marked(silica):
    """Weak light does not lift a heavy bead; titania is pushed away by the light it throws back."""
    heavy = silica.replace(bead={"diameter": "3 um"}, beam={"power_through_pupil": "0.3 mW"})
    found = tweezer.trap_over_heights(heavy, [1e-6, 8e-6])
    assert found["state"].values.tolist() == ["rests on the wall", "held"]
    assert np.isnan(found.isel(height=0)["stiffness"]).all()
    assert float(found.isel(height=1)["gap"]) > 0
    weightless = {"gravity": False, "buoyancy": False}
    titania = silica.replace(forces=weightless, bead={"refractive_index": 2.3})
    lost = tweezer.trap_over_heights(titania, [2e-6])
    assert lost["state"].values.tolist() == ["not held"]
    figure = heights_figure(found)
    readable.check(figure)


def test_a_wall_above_the_bead_and_a_second_one(silica):
    """Turned over without weight, light from below: the height is counted downwards."""
    scene = silica.replace(
        forces={"gravity": False, "buoyancy": False},
        wall={"position": "5 um", "side": "below", "opposite": "-7 um"},
        medium={"inertia": "none"},
    )
    found = tweezer.trap_over_heights(scene, [2e-6])
    z = float(found["equilibrium"].sel(axis="z")[0])
    assert float(found["gap"][0]) == pytest.approx(2e-6 - z - 0.5e-6, rel=1e-9)


def test_an_interruption_keeps_what_was_reached(silica):
    def stop(done):
        if done > 0.4:
            raise KeyboardInterrupt

    found = tweezer.trap_over_heights(silica, np.linspace(1e-6, 4e-6, 4), progress=stop)
    assert found.attrs["status"] == "interrupted"
    np.testing.assert_allclose(found["height"], [1e-6, 2e-6])
    assert np.isfinite(found["stiffness"]).all()


@pytest.mark.parametrize(
    ("heights", "complaint"),
    [([1e-6, 0.0], "heights: 0 m: must be above 0"), ([math.nan], "heights: nan m"),
     ([], "must be a list"), (1e-6, "must be a list"), (["low"], "heights: must be a number in m")],
)  # fmt: skip
def test_heights_that_are_none(silica, heights, complaint):
    with pytest.raises(SceneError, match=complaint):
        tweezer.trap_over_heights(silica, heights)


def test_command(command_line):
    outcome = command_line(
        "trap", "silica-1um", "--heights", "0.7 um", "3 um", "--count", "3", "--out", "h.nc",
        "--plot", "h.png",
    )  # fmt: skip
    assert (outcome.code, outcome.err) == (0, "")
    found = xr.load_dataset("h.nc")
    np.testing.assert_allclose(found["height"], [0.7e-6, 1.85e-6, 3e-6])
    for gap in 1e6 * found["gap"].values:
        assert f"{gap:.4g}" in outcome.out
    assert Path("h.png").read_bytes().startswith(b"\x89PNG")
    wrong = command_line("trap", "silica-1um", "--heights", "1 kg", "3 um")
    assert (wrong.code, len(wrong.err.splitlines())) == (2, 1)
    assert "--heights '1 kg'" in wrong.err


def test_an_interrupted_command_writes_what_was_reached(command_line, monkeypatch):
    whole, reached = heights._trapped, []

    def stopped(problem):
        if len(reached) == 2:
            raise KeyboardInterrupt
        reached.append(problem)
        return whole(problem)

    monkeypatch.setattr(heights, "_trapped", stopped)
    command = ("trap", "silica-1um", "--heights", "1 um", "4 um", "--count", "4", "--out", "h.nc")
    outcome = command_line(*command)
    assert outcome.code == 130
    assert "interrupted after 2 of 4 heights" in outcome.err
    np.testing.assert_allclose(xr.load_dataset("h.nc")["height"], [1e-6, 2e-6])
    assert command_line(*command[:-2]).code == 130  # none is reached
    alone = command_line("trap", "silica-1um", "--count", "4")
    assert (alone.code, alone.err) == (2, "--count: requires --heights\n")


def test_beside_a_wall_the_trap_has_its_gap_and_drag_and_the_pull_ends_at_the_wall(
    silica, command_line
):
    scene = silica.replace(wall={"position": "-0.9 um"}, medium={"inertia": "none"})
    trap = tweezer.characterise(scene)
    z = trap.equilibrium.position[2]
    assert trap.gap == pytest.approx(z + 0.4e-6, rel=1e-9)
    beta = tweezer.bead_properties(scene).drag
    away, *_ = wall.mobilities(trap.gap / 0.5e-6, 12)
    assert trap.drag[2] == pytest.approx(beta / float(away), rel=1e-6)
    down = next(escape for escape in trap.escapes if escape.direction == "-z")
    assert (down.range, down.wall_at) == (None, pytest.approx(trap.gap))
    assert down.force_at <= down.wall_at
    assert all(each.wall_at is None for each in trap.escapes if each.direction != "-z")
    assert all(scene.room(each.position[2]) > 0 for each in trap.equilibria)
    outcome = command_line(
        "trap", "silica-1um", "--set", "wall.position=-0.9 um", "--out", "t.json"
    )
    assert f"wall at {1e6 * trap.gap:.4g}" in outcome.out
    assert json.loads(Path("t.json").read_text())["trap"]["gap"] == pytest.approx(trap.gap)
    axes = trap_figure(scene, trap).axes
    (curve,) = [line for line in axes[0].lines if len(line.get_xdata()) > 100]
    assert curve.get_xdata().min() > -0.4 - 1e-9


def test_a_run_tells_its_gap_and_the_smallest_between_samples(silica):
    """A bead that the light draws past the wall: 5 samples miss the lowest place, 2,001 do not."""
    scene = silica.replace(
        wall={"position": "-1.1 um"}, start={"position": ["0.9 um", "0 um", "-0.4 um"]},
        beam={"power_through_pupil": "2 mW"}, medium={"inertia": "none"},
        simulation={"model": "overdamped", "duration": "200 ms", "samples": 5},
    )  # fmt: skip
    few = tweezer.simulate(scene)
    many = tweezer.simulate(scene.replace(simulation={"samples": 2001}))
    for run in (few, many):
        expected = run["position"].sel(axis="z") + 1.1e-6 - 0.5e-6
        np.testing.assert_allclose(run["gap"], expected, rtol=0, atol=1e-15)
    told = tweezer.summarise(few)
    assert told.smallest_gap < float(few["gap"].min())
    assert told.smallest_gap == pytest.approx(float(many["gap"].min()), abs=1e-9)
    assert abs(told.smallest_gap - float(many["gap"].min())) < told.smallest_gap_error + 1e-10
    part = tweezer.summarise(many.isel(time=slice(0, 100)))
    assert part.smallest_gap == float(many["gap"][:100].min())
    readable.check(run_figure(few))
