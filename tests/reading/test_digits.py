"""Samples that were not measured, recognised from the digits of a recording."""

import numpy as np
import pytest

import tweezer
from tests.reference.trapped_bead import BOLTZMANN, trapped
from tweezer.reading import Recording, copied, measured, step_of, unmeasured

T, STEP, N = 293.15, 1e-3, 3000
K, DRAG = 2e-6, 9.44e-9
RNG = np.random.default_rng(11)
#: um, with five digits, of a bead with a relaxation time of 4.7 steps
POSITIONS = np.round(1e6 * trapped(STEP, N, K, DRAG, None, T, 12, 2).T, 5)
TIMES = STEP * np.arange(N)


def held(lost):
    """Return the series with each lost sample replaced by the previous one."""
    last = np.maximum.accumulate(np.where(lost, 0, np.arange(N)))
    return POSITIONS[last]


def at(share):
    lost = RNG.random(N) < share
    lost[[0, -1]] = False
    return lost


def marked(mark, axes=2):
    positions = POSITIONS[:, :axes].copy()
    positions[at(0.02)] = mark
    return positions


def one_axis(mark):
    positions = POSITIONS.copy()
    positions[at(0.02), 0] = mark
    return positions


def interpolated(lost):
    there = ~lost
    every = np.arange(N)
    lines = [np.interp(every, every[there], column[there]) for column in POSITIONS.T]
    return np.round(np.stack(lines, axis=1), 5)


def calibrated(positions, step=STEP, **known):
    recording = Recording(
        step * np.arange(len(positions)),
        1e-6 * positions,
        ("x", "y")[: positions.shape[1]],
        name="mine",
    )
    return tweezer.calibrate(recording, temperature=T, drag=DRAG, exposure=0, **known)


def names(calibration):
    return {finding.name for axis in calibration.axes for finding in axis.findings}


@pytest.mark.parametrize(
    "rounded",
    [lambda x: x, lambda x: np.round(x / 0.01) * 0.01, lambda x: np.round(x / 0.06) * 0.06,
     lambda x: 1e-6 * x, lambda x: x[:, :1], lambda x: np.clip(x, -0.08, 0.08),
     np.vectorize(lambda each: float(f"{each:.3g}")), lambda x: x[::20]],
    ids=["fine", "coarse", "levels", "metres", "axis", "clipped", "three digits", "white"],
)  # fmt: skip
def test_measured_samples_are_left_alone(rounded):
    positions = rounded(POSITIONS)
    assert unmeasured(positions).said == ()
    assert copied(positions) == ""


@pytest.mark.parametrize(
    ("positions", "which", "said"),
    [(held(at(0.03)), "copies", "samples repeat the previous one"),
     (marked(0), "marks", "samples have the same numbers (0, 0): treated as lost frames"),
     (marked((-1, -1)), "marks", "(-1, -1): treated as lost frames"),
     (marked(0, axes=1), "marks", "(0): treated as lost frames"),
     (one_axis(0), "marks", "same numbers (0) along one axis: treated as lost frames"),
     (interpolated(at(0.03)), "copies", "samples lie on the line between")],
)  # fmt: skip
def test_few_unmeasured_samples_become_missing(positions, which, said):
    found = getattr(unmeasured(positions), which)
    truth = (positions != POSITIONS[:, : positions.shape[1]]).any(axis=1)
    assert (found != truth).sum() <= 4  # ends of runs, and equal by chance
    _, times, kept, note = measured(TIMES, positions)
    assert said in note
    assert (np.isnan(kept).any(axis=1) == found).all()
    np.testing.assert_array_equal(times, TIMES)


@pytest.mark.parametrize(
    ("positions", "rate"),
    [(np.repeat(POSITIONS, 2, axis=0), 500.0),
     (POSITIONS[np.floor(0.84 * np.arange(int(N / 0.84))).astype(int)], 840.0)],
    ids=["twice", "slower camera"],
)  # fmt: skip
def test_a_recorder_that_is_faster_than_its_camera(tmp_path, positions, rate):
    table = np.column_stack([STEP * np.arange(len(positions)), positions])
    np.savetxt(tmp_path / "a.csv", table, fmt="%.5f", delimiter=",", header="t,x [um],y [um]",
               comments="")  # fmt: skip
    recording = tweezer.load_recording(tmp_path / "a.csv")
    assert abs(1 / recording.step - rate) < 1e-3 * rate
    assert len(recording.times) == pytest.approx(N, abs=1)
    assert "repeat the previous one" in recording.note
    np.testing.assert_allclose(recording.positions, 1e-6 * POSITIONS[: len(recording.times)])


def test_a_stretch_without_motion_is_left_out():
    lost = np.zeros(N, bool)
    lost[1000:1120] = True
    _, _, kept, note = measured(TIMES, held(lost))
    assert "120 samples in stretches without motion" in note
    assert (np.isnan(kept).any(axis=1) == lost).all()


def test_copies_of_a_record():
    found = copied(np.vstack([POSITIONS, POSITIONS[500:900]]))
    assert found.endswith("those 2,500 before, as sample 3,001 is of sample 501")
    assert "67 % of its samples are a copy of those 1,000" in copied(
        np.tile(POSITIONS[:1000], (3, 1))
    )


def test_steps_of_digits():
    assert step_of(np.round(POSITIONS[:, 0] / 0.02) * 0.02 - 0.3) == pytest.approx(0.02)
    assert step_of(1e-9 * np.arange(50) ** 2) == pytest.approx(1e-9)
    assert step_of(np.random.default_rng(1).random(500)) == 0.0


def test_repeated_frames_and_no_physical_cause_are_named():
    """16 % at random: no wall, as the digits come first; without them nothing is found."""
    calibration = calibrated(held(at(0.16)))
    assert names(calibration) == {"repeated"}
    assert all(each.findings for axis in calibration.axes for each in axis.estimates)
    assert names(calibrated(POSITIONS)) == set()


@pytest.mark.parametrize(
    ("positions", "name"),
    [(interpolated(at(0.3)), "interpolated"), (np.tile(POSITIONS[:1500], (2, 1)), "copied"),
     (np.stack([POSITIONS[:1500] + 0.3, POSITIONS[1500:]], axis=1).reshape(-1, 2), "turns"),
     (np.round(POSITIONS / 0.1) * 0.1, "rounded")],
    ids=["interpolated", "copied", "in turn", "rounded"],
)  # fmt: skip
def test_the_cause_of_a_digit_is_named_alone(positions, name):
    assert names(calibrated(positions)) == {name}


def test_rounding_is_known_noise():
    """The advice of the finding, followed: the stiffness is right, and nothing is found."""
    positions = np.round(POSITIONS / 0.04) * 0.04
    rounded = calibrated(positions)
    assert names(rounded) == {"rounded"}
    advice = rounded.axes[0].findings[0].text
    assert advice.endswith('give --noise "11.5 nm"')
    known = calibrated(positions, noise="11.5 nm")
    assert names(known) == set()
    for axis in known.axes:
        found = axis["power spectrum"]
        assert abs(found.stiffness - K) < 4 * found.uncertainty


def test_fine_rounding_is_named_where_it_shows_as_noise():
    """Below the limit of the part of rounding; the advice of the finding leads to the truth."""
    x = 1e6 * trapped(2e-4, 20_000, 1e-5, DRAG, None, T, 6)[0]
    positions = np.round(x[:, None] / 0.006) * 0.006
    noisy = {each.name: each.text for each in calibrated(positions, 2e-4).axes[0].findings}
    advice = "of which 1.7 nm is the rounding to multiples of 6 nm: give --noise fit"
    assert noisy["noise"].endswith(advice)
    (axis,) = calibrated(positions, 2e-4, noise="fit").axes
    assert axis.findings == ()
    assert axis.detector[0].value == pytest.approx(6e-9 / np.sqrt(12), rel=0.3)
    assert abs(axis.free_fit.bead.drag - DRAG) < 3 * axis.free_fit.drag_uncertainty


@pytest.mark.parametrize(
    ("frequency", "quality", "step"), [(50e3, 30, 5e-6), (40e3, 60, 5e-6), (50e3, 30, 2e-5 / 3)]
)
def test_an_oscillation_is_no_row_of_beads(frequency, quality, step):
    """At 4, 5 and 3 samples in a period: the advice to keep each fourth would alias it."""
    k = 1e-4
    mass = k / (2 * np.pi * frequency) ** 2
    drag = mass * 2 * np.pi * frequency / quality
    x = trapped(step, 20_000, k, drag, mass, T, 5)[0]
    recording = Recording(step * np.arange(len(x)), x[:, None], ("x",), name="ringing")
    known = {"temperature": T, "drag": drag, "exposure": 0}
    assert not {"turns", "order"} & names(tweezer.calibrate(recording, **known))
    found = tweezer.calibrate(recording, mass=mass, **known).axes[0]["power spectrum"]
    assert abs(found.stiffness - k) < 4 * found.uncertainty


def test_hum_at_a_quarter_of_the_rate_is_no_other_order():
    """The autocorrelation is 0 over one step and -1 over two; rows with times are in order."""
    hum = 6 * POSITIONS.std() * np.sqrt(2) * np.sin(np.pi / 2 * np.arange(N) + 0.3)[:, None]
    found = names(calibrated(POSITIONS + hum))
    assert "line" in found
    assert not {"turns", "order"} & found


def test_rows_with_times_are_in_order(tmp_path):
    walk = np.cumsum(RNG.standard_normal((N, 1)), axis=0)
    rows = np.column_stack([TIMES, 1e-2 * RNG.permutation(walk)])
    found = []
    for columns, rate in (("t,x", None), ("x", "1 kHz")):
        np.savetxt(tmp_path / f"{columns}.csv", rows[:, -len(columns.split(",")) :], delimiter=",",
                   header=f"{columns} [um]", comments="")  # fmt: skip
        recording = tweezer.load_recording(tmp_path / f"{columns}.csv", rate=rate)
        found.append(names(tweezer.calibrate(recording, temperature=T)))
    assert "order" not in found[0]
    assert "order" in found[1]


def test_one_row_is_refused_without_a_warning(tmp_path):
    (tmp_path / "a.csv").write_text("t [s],x [um]\n0,1\n", encoding="utf-8")
    with pytest.raises(tweezer.ResultError, match="1 samples"):
        tweezer.load_recording(tmp_path / "a.csv")


def test_shuffled_rows_of_a_walk_are_no_trap():
    steps = np.sqrt(2 * BOLTZMANN * T / DRAG * STEP) * RNG.standard_normal((N, 2))
    walk = 1e6 * RNG.permutation(np.cumsum(steps, axis=0))
    assert "order" in names(calibrated(walk))
    white = POSITIONS[RNG.permutation(N)]  # Gaussian, as a trap is that is sampled slowly
    assert "order" not in names(calibrated(white))
