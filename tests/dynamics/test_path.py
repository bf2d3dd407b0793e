"""What is found between the samples: functions whose peaks and crossings are known."""

import math

import numpy as np
import pytest

import tweezer
from tweezer.dynamics import Event, events, path
from tweezer.dynamics.path import greatest, last_fall


def test_the_greatest_of_several_peaks_between_the_points_looked_at():
    """sin(t) + t/100 peaks at arccos(-1/100) and 2 pi later, the last higher; no point is near."""
    times = np.linspace(0, 4 * math.pi, 24)

    def value(at):
        return np.sin(at) + at / 100

    peak = math.acos(-0.01) + 2 * math.pi
    found = greatest(value, times)
    assert value(times).max() < value(peak) - 1e-3
    assert found.time == pytest.approx(peak, abs=2e-3)
    assert abs(found.value - value(peak)) <= found.error < 1e-6


def test_a_peak_whose_points_are_lower_than_those_of_another():
    """Two humps: the higher falls between points, one of the lower is hit."""
    times = np.linspace(0, 8, 9)

    def value(at):
        return 1.05 * np.exp(-((at - 2.5) ** 2)) + np.exp(-((at - 6) ** 2))

    assert value(times).argmax() == 6
    assert greatest(value, times).time == pytest.approx(2.5, abs=1e-3)


@pytest.mark.parametrize("times", [np.array([3.0]), np.array([3.0, 5.0])])
def test_the_greatest_at_an_end(times):
    found = greatest(lambda at: at, times)
    assert (found.value, found.time) == (times[-1], times[-1])


@pytest.mark.parametrize("points", [7, 40, 400])
def test_the_last_fall_is_after_the_last_peak_above_zero(points):
    """exp(-t) cos(2 pi t) - exp(-2.2): last above 0 about t = 2, for 0.2, between few points."""
    times = np.linspace(0, 6, points)
    found = last_fall(lambda at: np.exp(-at) * np.cos(2 * math.pi * at) - math.exp(-2.2), times)
    expected = 2.0 + np.linspace(0, 0.25, 2_000_001)
    above = np.exp(-expected) * np.cos(2 * math.pi * expected) > math.exp(-2.2)
    if points == 7:  # points at whole numbers: the peak is hit
        assert times[2] == 2.0
    assert found == pytest.approx(expected[above].max(), abs=1e-6)


def test_what_was_never_above_zero_fell_at_once():
    assert last_fall(lambda at: -1 - at, np.linspace(0.5, 6, 20)) == 0.5


def test_the_greatest_of_many_peaks_that_are_nearly_equal():
    """Ten peaks of a sine that grows by 1e-4; the samples are highest at others than the last."""
    found = greatest(
        lambda at: (1 + 1e-4 * at) * np.sin(20 * np.pi * at), np.linspace(0.0, 1.0, 104)
    )
    assert found.time == pytest.approx(0.925, abs=1e-4)
    assert abs(found.value - (1 + 0.925e-4)) <= found.error < 1e-7


@pytest.mark.parametrize("level", [0.0, 1.0, -3e-7])
def test_the_greatest_of_rounding_alone_is_not_looked_for(level):
    """A constant with a wobble of its last digits has a maximum at every third point."""
    times, looked = np.linspace(0.0, 1.0, 10_001), []

    def value(at):
        looked.append(len(at))
        return level * (1 + 4e-16 * np.round(np.sin(1e6 * at)))

    found = greatest(value, times)
    assert len(looked) <= 5
    assert found.value == pytest.approx(level, rel=1e-14)
    assert found.error < 1e-13


@pytest.fixture
def looked(monkeypatch):
    """Number of maxima and of crossings that were located."""
    count = dict.fromkeys(("_located", "crossing"), 0)

    def count_calls(name, module):
        located = getattr(module, name)

        def counted(*args):
            count[name] += 1
            return located(*args)

        monkeypatch.setattr(module, name, counted)

    for name, module in (("_located", path), ("crossing", path), ("crossing", events)):
        count_calls(name, module)
    return count


def test_a_bead_at_rest_is_summarised_without_a_search(looked):
    """Each of 2000 steps is a maximum of its speed and of its distances, which are all equal."""
    scene = tweezer.load_scene("silica-1um").replace(
        forces={"optical": False, "gravity": False, "buoyancy": False},
        medium={"inertia": "none"},
        simulation={"model": "overdamped", "method": "dormand-prince", "step": 1e-6,
                    "duration": 2e-3},
    )  # fmt: skip
    run = tweezer.simulate(scene)
    assert run.attrs["steps"] >= 2000
    assert tweezer.summarise(run).overshoot == 0
    assert looked["_located"] < 20
    assert looked["crossing"] == 0


def test_slow_motion_in_short_steps_is_summarised_without_a_search(looked):
    """The distance to the focus and the speed wobble in each of 3700 steps by rounding."""
    scene = tweezer.load_scene("thesis-500nm").replace(
        medium={"viscosity": 60.0}, simulation={"duration": 1e-4, "samples": 11}
    )
    run = tweezer.simulate(scene)
    assert run.attrs["steps"] > 3000
    assert run.attrs["events"] == "[]"
    assert looked["_located"] + looked["crossing"] < 30


def test_signs_of_rounding_are_no_events(looked):
    """A bead beside the axis: y is rounding alone, x crosses 100 nm once."""
    scene = tweezer.load_scene("silica-1um").replace(
        start={"position": [3e-7, 1e-21, 0]},
        beam={"polarisation": "linear"},
        medium={"inertia": "none"},
        simulation={"model": "overdamped", "method": "dormand-prince", "step": 1e-6,
                    "duration": 1e-3},
    )  # fmt: skip
    wobbles = 1e-21

    def of_y(t, y):
        return y[:, 1] + wobbles * np.sin(1e8 * t)

    run = tweezer.simulate(
        scene, events=[Event("y", of_y), Event("x", lambda _, y: y[:, 0] - 1e-7)]
    )
    assert '"y"' not in run.attrs["events"]
    assert run.attrs["events"].count('"x"') == 1
    assert looked["crossing"] < 10
