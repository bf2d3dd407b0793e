"""A short form of `make stress`."""

from tests.stress import outcomes


def test_random_scenes_end_finite_or_with_a_typed_error():
    counted = outcomes(200, 20_251)
    assert sum(counted.values()) == 200
    assert counted["complete"] > 100
