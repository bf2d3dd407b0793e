"""Check and completion of the bead, medium, wall and detector of a calibration."""

import math

import numpy as np
import pytest

from tweezer import Recording, ResultError
from tweezer.calibration.setup import Setup

STEP = 1e-4
#: Of a bead of 0.5 um in a medium of 1 mPa s: 6 pi mu r
STOKES = 6 * math.pi * 1e-3 * 0.5e-6


def recording(**given):
    positions = np.random.default_rng(1).normal(scale=1e-8, size=(400, 3))
    return Recording(STEP * np.arange(400), positions, ("x", "y", "z"), name="r", **given)


def test_drag_follows_from_radius_and_viscosity_on_every_axis():
    known = Setup(temperature="20 degC", radius="0.5 um", viscosity="1 mPa s").of(recording())
    assert known.temperature == 293.15
    assert known.drag == pytest.approx(STOKES, rel=1e-12)
    assert known.drags == dict.fromkeys("xyz", known.drag)
    bead = known.bead("y", STEP)
    assert (bead.drag, bead.mass, bead.exposure, bead.noise) == (known.drag, None, 0.0, 0.0)
    assert not known.detector.exposure_known


def test_drag_beside_a_wall_is_larger_across_it_and_not_exact_at_an_uncertain_height():
    given = {"temperature": 293.15, "radius": 0.5e-6, "viscosity": 1e-3}
    known = Setup(**given, wall="1 um").of(recording())
    assert known.drags["x"] == known.drags["y"]
    assert STOKES < known.drags["x"] < known.drags["z"]
    assert known.bead("z", STEP).across
    assert known.bead("z", STEP).wall == pytest.approx(2)
    uncertain = Setup(**given, wall=("1 um", "50 nm")).of(recording())
    assert uncertain.drags == known.drags
    assert math.isnan(uncertain.bead("z", STEP).drag)


def test_detector_is_given_fitted_or_that_of_the_recording():
    setup = Setup(temperature=293.15, exposure="fit", diode="fit", noise="2 nm")
    detector = setup.of(recording(noise=(1e-9, 1e-9, 3e-9), exposure=STEP / 2)).detector
    assert detector.fitted == ("exposure", "diode_frequency", "diode_fraction")
    assert detector.exposure_known
    assert (detector.exposure, detector.diode, detector.noise) == (None, None, 2e-9)
    own = Setup(temperature=293.15, diode="14 kHz, 0.3").of(
        recording(noise=(1e-9, 1e-9, 3e-9), exposure=STEP / 2)
    )
    assert own.detector.diode == (14e3, 0.3)
    assert (own.bead("z", STEP).noise, own.bead("x", STEP).exposure) == (3e-9, STEP / 2)


@pytest.mark.parametrize(("given", "told"), [
    ({}, "r: requires the temperature of the medium"),
    ({"temperature": 293, "mass": -1}, "r: mass = -1.0: must be positive"),
    ({"temperature": 293, "displaced_mass": 1e-15}, "r: fluid inertia requires"),
    ({"temperature": 293, "wall": 1e-6}, "r: wall: requires the bead's radius too"),
    ({"temperature": 9000}, "r: temperature = 9000: must be from 50 to 5000 K"),
    ({"temperature": 293, "exposure": 1}, "r: exposure = 1 s: must be from 0 to the sampling"),
    ({"temperature": 293, "noise": -1}, "r: noise = -1: must not be negative"),
    ({"temperature": 293, "diode": "0 Hz"}, "r: diode = '0 Hz': its frequency must be positive"),
])  # fmt: skip
def test_wrong_or_missing_value_is_refused_by_its_name(given, told):
    with pytest.raises(ResultError) as refused:
        Setup(**given).of(recording())
    assert str(refused.value).startswith(told)
