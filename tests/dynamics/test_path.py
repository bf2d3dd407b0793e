"""What is found between the samples: functions whose peaks and crossings are known."""

import math

import numpy as np
import pytest

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
