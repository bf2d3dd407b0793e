"""A short form of `make stress`."""

from tests.stress import outcomes


def test_random_scenes_end_finite_or_with_a_typed_error():
    counted = outcomes(80, 20_251)
    assert sum(counted.values()) == 80
    assert counted["complete"] > 40


def test_random_scenes_with_thermal_motion_end_finite_or_with_a_typed_error():
    """Without thermal torque, whose loops are another dozen to compile."""
    counted = outcomes(60, 20_252, thermal=True)
    assert sum(counted.values()) == 60
    assert counted["complete"] > 20
