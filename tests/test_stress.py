"""A short form of `make stress`."""

from tests.stress import outcomes


def test_random_scenes_end_finite_or_with_a_typed_error():
    counted = outcomes(200, 20_251)
    assert sum(counted.values()) == 200
    assert counted["complete"] > 100


def test_random_scenes_with_thermal_motion_end_finite_or_with_a_typed_error():
    counted = outcomes(100, 20_252, thermal=True)
    assert sum(counted.values()) == 100
    assert counted["complete"] > 30
