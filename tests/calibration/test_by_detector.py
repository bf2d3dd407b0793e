"""Calibration by the signals of a scene's detector, beyond the range in which they are linear."""

from pathlib import Path

import numpy as np
import pytest

import tweezer
from tweezer import ResultError
from tweezer.calibration import by_detector
from tweezer.calibration.by_detector import completed, from_signals
from tweezer.calibration.setup import Setup
from tweezer.optics.detection import detection

SCENE = tweezer.load_scene("silica-1um").replace(
    detector={"numerical_aperture": 0.5, "noise": False}, beam={"polarisation": "linear"}
)
GAIN, OFFSET = 12.0, np.array([0.3, -0.2, 0.0])


def of_positions(scale=(4e-8, 3e-8, 4e-8), seed=1, samples=1000):
    """Return positions about the equilibrium, normally distributed, and their signals, W."""
    seen = detection(SCENE)
    drawn = np.random.default_rng(seed).normal(scale=scale, size=(samples, 3))
    positions = seen.rest + np.clip(drawn, *(np.outer([-3.6, 3.6], scale)))
    return positions, seen.along(positions)[0]


def recorded(signals, unit="W", axes=("x", "y", "z")):
    return tweezer.Recording(np.arange(len(signals)) * 1e-4, signals, axes, unit=unit)


POSITIONS, SIGNALS = of_positions()


@pytest.fixture(scope="module")
def found():
    return from_signals(recorded(SIGNALS), SCENE)


def test_positions_are_those_of_the_signals(found):
    """At displacements for which linear signals would be wrong by 10 nm."""
    assert found.unit == "m"
    np.testing.assert_allclose(found.positions, POSITIONS, rtol=0, atol=1e-12)
    seen = detection(SCENE)
    (at_rest,), (slope,), _ = seen.with_slopes(seen.rest[None])
    linear = seen.rest + np.linalg.solve(slope, (SIGNALS - at_rest).T).T
    assert np.abs(linear - POSITIONS)[:, 0].max() > 1e-8


def test_recording_of_signals_is_shown_in_milliwatts():
    row = str(recorded(SIGNALS)).split("x, standard deviation")[1].splitlines()[0]
    assert row.split() == [f"{1e3 * SIGNALS[:, 0].std():.4g}", "mW"]


def test_note_contains_the_linear_range(found):
    ends = tweezer.detect(SCENE)["linear_range"].values
    assert found.note.startswith("the signals are linear within 5 % up to ")
    told = [float(word) for word in found.note.split() if word[0].isdigit()][1:]
    np.testing.assert_allclose(told, 1e9 * ends, rtol=1e-3)


def test_note_contains_the_error_of_a_named_medium():
    named = SCENE.replace(medium={"name": "water", "temperature": "20 degC"})
    note = from_signals(recorded(SIGNALS), named).note
    assert note.endswith("; the drag in water is known within 1 %")


def test_setup_has_the_drag_of_the_gas_of_a_scene():
    gas = {"name": "air", "pressure": "10 mbar", "temperature": 300}
    thin = SCENE.replace(medium=gas, lens={"numerical_aperture": 0.8})
    setup = completed(Setup(), thin)
    assert setup.drag == tweezer.bead_properties(thin).drag < 1e-3 * tweezer.medium(SCENE).drag
    assert completed(Setup(viscosity=1e-3), thin).drag is None
    assert completed(Setup(), SCENE).drag is None


def test_gain_of_volts_follows_from_all_of_the_light():
    """The positions are right to 2 %, and to 3 nm, as the mean of the samples is not zero."""
    found = from_signals(recorded(GAIN * SIGNALS + OFFSET, "V"), SCENE).positions
    difference = found - POSITIONS
    assert (np.abs(difference.mean(axis=0)) < 3e-9).all()
    assert (difference.std(axis=0) < 0.02 * POSITIONS.std(axis=0)).all()


@pytest.fixture(scope="module")
def run():
    """Thermal motion of a bead with 20 nm rms along x."""
    thermal = SCENE.replace(
        beam={"power_through_pupil": 4e-3}, start={"drawn": "equilibrium"},
        forces={"brownian": True, "gravity": False, "buoyancy": False},
        simulation={"duration": "0.2 s", "samples": 401, "model": "overdamped"},
    )  # fmt: skip
    return tweezer.simulate(thermal, seed=2)


def test_calibration_of_signals_is_that_of_the_positions(run):
    scene = tweezer.scene_of(run)
    expected, found = tweezer.calibrate(run), tweezer.calibrate(run, scene=scene)
    for axis in "xyz":
        one, other = (each.axes[axis]["power spectrum"] for each in (expected, found))
        assert other.stiffness == pytest.approx(one.stiffness, rel=1e-5)


def test_table_of_volts_is_calibrated_by_the_scene_alone(run, command_line):
    """The command needs neither temperature nor radius, and prints the linear range."""
    table = np.column_stack([run["time"], GAIN * run["signal"] + OFFSET])
    np.savetxt("volts.csv", table, delimiter=",", header="t (s),x (V),y (V),z (V)", comments="")
    Path("scene.toml").write_text(toml_of(tweezer.scene_of(run)))
    outcome = command_line(
        "calibrate", "volts.csv", "--scene", "scene.toml", "--json", "found.json"
    )
    assert "the signals are linear within 5 % up to" in outcome.err
    found, expected = tweezer.load("found.json"), tweezer.calibrate(run)
    for axis in "xyz":
        one, other = (each.axes[axis]["equipartition"] for each in (expected, found))
        assert other.stiffness == pytest.approx(one.stiffness, rel=0.03)


def toml_of(scene):
    """Return a shipped scene with a detector and another power as a file."""
    assert scene.beam.power_through_pupil == 4e-3
    text = Path(tweezer.shipped_scenes()["silica-1um"]).read_text()
    text = text.replace('"circular"', '"linear"').replace("50 mW", "4 mW")
    return text + "\n[detector]\nnumerical_aperture = 0.5\n"


def test_bead_beyond_the_signals_is_refused(monkeypatch):
    """Beyond the largest box, here 0.15 um."""
    monkeypatch.setattr(by_detector, "_WAVELENGTHS", 0.0)
    monkeypatch.setattr(by_detector, "_RADII", 0.3)
    signals = SIGNALS.copy()
    signals[7, 0] = 0.9 * signals[7, 2]
    with pytest.raises(ResultError, match=r"0.1 % of the signals have no position"):
        from_signals(recorded(signals), SCENE)


def test_recordings_without_three_signals_are_refused():
    for recording in (recorded(POSITIONS, "m"), recorded(SIGNALS[:, :2], "V", ("x", "y"))):
        with pytest.raises(ResultError, match="--scene requires the signals x, y and z"):
            from_signals(recording, SCENE)
    with pytest.raises(ResultError, match="z: is not all of the light"):
        from_signals(recorded(-SIGNALS, "V"), SCENE)
    with pytest.raises(ResultError, match="in watts: requires --scene"):
        tweezer.calibrate(recorded(SIGNALS))


def test_changes_of_a_scene_require_a_scene(command_line):
    outcome = command_line("calibrate", "run.nc", "--set", "beam.power=1 mW")
    assert (outcome.code, outcome.err) == (2, "--set: requires --scene\n")


def test_run_without_a_detector_has_no_signals_to_calibrate():
    plain = tweezer.simulate("silica-1um", "1 ms")
    with pytest.raises(ResultError, match=r"has no signal; add \[detector\]"):
        tweezer.calibrate(plain, scene=SCENE)
