"""The figure of a run: what its axes say, and that its artists have the numbers of the run."""

import numpy as np
import pytest
from matplotlib.collections import LineCollection
from matplotlib.patches import Circle, Polygon

import tweezer
from tests import readable
from tweezer.plots import run_figure


@pytest.fixture(scope="module")
def run():
    return tweezer.simulate(tweezer.load_scene("silica-1um"))


@pytest.fixture(scope="module")
def thermal():
    scene = tweezer.load_scene("silica-1um").replace(
        forces={"brownian": True}, optics={"evaluator": "map"}, medium={"inertia": "none"},
        simulation={"model": "overdamped", "duration": "20 ms", "samples": 1001},
    )  # fmt: skip
    return tweezer.simulate(scene, seed=3)


def letters(figure):
    return [axes.get_title(loc="left") for axes in figure.axes if axes.get_title(loc="left")]


def test_path_shows_direction_and_time(run):
    figure = run_figure(run)
    readable.check(figure)
    assert letters(figure) == ["a", "b", "c"]
    path = figure.axes[0]
    (drawn,) = (each for each in path.collections if isinstance(each, LineCollection))
    np.testing.assert_allclose(drawn.get_array(), 1e3 * run["time"][:-1])
    x, y, z = 1e6 * run["position"].values.T
    lateral = (x * x[0] + y * y[0]) / np.hypot(x[0], y[0])
    segments = np.array(drawn.get_segments())
    np.testing.assert_allclose(segments[:, 0], np.column_stack([lateral, z])[:-1], atol=1e-9)
    assert sum(text.arrow_patch is not None for text in path.texts) == 2
    assert path.child_axes[0].get_ylabel() == "time (ms)"


def test_path_fills_its_panel(run):
    """The bead at both ends lies within the limits, and spans more than half of each side."""
    axes = run_figure(run).axes[0]
    circles = [patch for patch in axes.patches if isinstance(patch, Circle)]
    for k, (low, high) in enumerate((axes.get_xlim(), axes.get_ylim())):
        ends = [circle.center[k] + side * 0.5 for circle in circles for side in (-1, 1)]
        assert low < min(ends)
        assert max(ends) < high
        assert max(ends) - min(ends) > 0.5 * (high - low)


def test_notes_explain_speeds_and_memory_without_the_thesis(run):
    figure = run_figure(run)
    note = " ".join(figure.get_supxlabel().split())
    assert figure.get_suptitle().startswith("1 µm silica bead")
    assert "the speed at which the drag balances the other forces" in note
    assert "the fluid that the bead has set in motion" in note
    assert "(5." not in note + "".join(axes.get_ylabel() for axes in figure.axes)
    at_rest = run.assign(terminal_speed=run["speed"])
    assert "set in motion" not in run_figure(at_rest).get_supxlabel()


def test_changes_stand_below_the_figure(thermal):
    figure = run_figure(thermal)
    assert figure.get_suptitle() == "silica-1um with changes"
    first = figure.get_supxlabel().splitlines()[0]
    assert first.startswith("Changed: thermal motion, ")
    assert "duration 20 ms" in first


def test_thermal_records_have_panels_and_histograms_of_their_own(thermal):
    figure = run_figure(thermal)
    readable.check(figure)
    assert letters(figure) == ["a", "b", "c", "d", "e"]
    by_label = {axes.get_ylabel(): axes for axes in figure.axes}
    for i, name in enumerate("xyz"):
        (line,) = (each for each in by_label[f"{name} (µm)"].lines if len(each.get_xdata()) > 2)
        np.testing.assert_allclose(line.get_ydata(), 1e6 * thermal["position"][:, i])
    assert by_label["distance (µm)"].get_title() == "distance to the equilibrium"
    centre = tweezer.characterise(tweezer.load_scene("silica-1um")).equilibrium.position
    (line,) = by_label["distance (µm)"].lines
    expected = 1e6 * np.linalg.norm(thermal["position"].values - centre, axis=1)
    np.testing.assert_allclose(line.get_ydata(), expected, atol=1e-3)
    histograms = [axes for axes in figure.axes if len(axes.patches) == 60]
    assert len(histograms) == 4
    low, high = by_label["x (µm)"].get_ylim()
    inside = (1e6 * thermal["position"][:, 0] >= low) & (1e6 * thermal["position"][:, 0] <= high)
    assert sum(bar.get_width() for bar in histograms[0].patches) == int(inside.sum())


def test_rod_is_drawn_at_its_orientation():
    """A rod released at 45 degrees to z, in the plane of z and its lateral position."""
    half = np.pi / 8
    run = tweezer.simulate(
        tweezer.load_scene("polystyrene-500nm").replace(
            bead={"shape": "spheroid", "diameter": "0.4 um", "length": "0.8 um"},
            forces={"optical": False, "brownian": False},
            start={
                "position": ["0 um", "1 um", "0 um"],
                "orientation": [np.cos(half), -np.sin(half), 0, 0],  # its axis towards +y and +z
            },
            simulation={"duration": "1 us", "samples": 3},
        )
    )  # fmt: skip
    patches = [each for each in run_figure(run).axes[0].patches if isinstance(each, Polygon)]
    outlines = [each.get_xy() for each in patches if len(each.get_xy()) > 100]
    assert len(outlines) == 2
    points = outlines[0] - [1.0, 0.0]
    far = points[np.linalg.norm(points, axis=1).argmax()]
    assert np.linalg.norm(far) == pytest.approx(0.4, rel=1e-2)
    assert far[0] / far[1] == pytest.approx(1, rel=0.05)
