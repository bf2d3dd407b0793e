"""A short form of `make stress`."""

from tests import stress


def test_random_scenes_end_finite_or_with_a_typed_error():
    counted = stress.outcomes(20, 20_251)
    assert sum(counted.values()) == 20
    assert counted["complete"] > 10


def test_random_scenes_with_thermal_motion_end_finite_or_with_a_typed_error(monkeypatch):
    """By the scheme that is chosen: `make stress` has all, each some more loops to compile."""
    monkeypatch.setattr(stress, "STOCHASTIC", ("auto",))
    counted = stress.outcomes(40, 20_252, thermal=True)
    assert sum(counted.values()) == 40
    assert counted["complete"] > 20


def test_random_scenes_beside_walls_end_on_their_side():
    for thermal in (False, True):
        counted = stress.outcomes(20, 20_253, thermal=thermal, walls=True)
        assert sum(counted.values()) == 20
        assert counted["complete"] > 5
