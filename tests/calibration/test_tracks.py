"""The common diffusion of several, also short, tracks against exact records of free beads."""

import json
import math

import numpy as np
import pytest

import tweezer
from tests.reference.free_bead import free
from tests.reference.trapped_bead import BOLTZMANN, trapped
from tweezer.calibration import Trajectory, diffusion, load_trajectories
from tweezer.calibration.steps import Steps

D, STEP, NOISE, T = 1e-12, 0.01, 1e-7, 293.15


def tracks(seed, count=25, frames=41, axes=2, diffusions=None, gaps=0.0, **how):
    """Tracks, each with a drift of its own."""
    rng = np.random.default_rng(seed)
    how = {"noise": NOISE, **how}
    found = []
    for number in range(count):
        n = frames if isinstance(frames, int) else int(rng.integers(*frames))
        own = D if diffusions is None else diffusions[number % len(diffusions)]
        drift = 1e-6 * rng.standard_normal()
        x = free(STEP, n, own, [seed, number], count=axes, drift=drift, **how).T
        x[rng.random(n) < gaps] = np.nan
        found.append(Trajectory(STEP, x, ("x", "y", "z")[:axes], name=f"track {number}"))
    return found


def names(found):
    return {finding.name for finding in found.findings}


def write(path, every, column="particle"):
    rows = [
        f"{number},{frame}," + ",".join(f"{1e6 * x:.4f}" for x in place)
        for number, each in enumerate(every)
        for frame, place in enumerate(each.positions)
        if np.isfinite(place).all()
    ]
    path.write_text(f"{column},frame,x [um],y [um]\n" + "\n".join(rows), encoding="utf-8")


def test_the_likelihood_of_tracks_is_that_of_dense_gaussians():
    """Each track has its own drift, which two pieces of it share."""
    rng = np.random.default_rng(2)
    lengths, of = (17, 9, 12), (0, 1, 1)
    pieces = [rng.standard_normal(n) for n in lengths]
    fit = Steps(pieces, STEP, tracks=of)

    def dense(A, B):
        s, value = (B - A) / 4, 0.0
        for track in (0, 1):
            mine = [piece for piece, own in zip(pieces, of, strict=True) if own == track]
            every = np.concatenate(mine)
            covariance, at = np.zeros((2, len(every), len(every)))[0], 0
            for piece in mine:
                n = len(piece)
                beside = np.eye(n, k=1) + np.eye(n, k=-1)
                covariance[at : at + n, at : at + n] = (A + 2 * s) * np.eye(n) - s * beside
                at += n
            inverse, ones = np.linalg.inv(covariance * fit.square), np.ones(len(every))
            off = every - (ones @ inverse @ every) / (ones @ inverse @ ones)
            value += np.linalg.slogdet(covariance)[1] + off @ inverse @ off
            value += math.log(ones @ inverse @ ones)
        return value

    places = [(0.8, 0.3), (1.5, 2.0), (0.2, 4.0)]
    ours = [fit.misfit(math.log(A), math.log(B)) for A, B in places]
    theirs = [dense(A, B) for A, B in places]
    np.testing.assert_allclose(np.diff(ours), np.diff(theirs), rtol=1e-9)


@pytest.mark.parametrize(
    "how",
    [{}, {"exposure": STEP, "noise": 2e-8}, {"frames": (8, 70), "gaps": 0.1},
     {"axes": 3, "count": 12, "frames": 31}, {"axes": 1, "count": 50}],
    ids=["plane", "blurred", "gaps", "space", "line"],
)  # fmt: skip
def test_common_diffusion_has_the_stated_uncertainty(how):
    """9 sets each: false alarms below 1e-3."""
    every = [diffusion(tracks(seed, **how)) for seed in range(9)]
    z = np.array([math.log(each.diffusion / D) * D / each.uncertainty for each in every])
    assert abs(z.mean()) < 3.3 / 3
    assert (z**2).sum() < 27.9  # chi-square
    assert sum(each.interval[0] < D < each.interval[1] for each in every) >= 6
    assert np.median([each.uncertainty for each in every]) < 0.13 * D
    assert sum(each.homogeneity < 0.05 for each in every) <= 4


def test_tracks_of_different_beads_are_a_finding():
    found = diffusion(tracks(1, diffusions=(0.5 * D, 1.5 * D)))
    assert found.homogeneity < 1e-6
    assert "tracks" in names(found)
    assert len(found.tracks) == 25


@pytest.mark.parametrize("stiffness", [3e-7, 3e-6])
def test_held_beads_are_not_free(stiffness):
    held = [
        Trajectory(
            STEP, trapped(STEP, 41, stiffness, 4e-9, None, T, i, 2).T, ("x", "y"), name=str(i)
        )
        for i in range(25)
    ]
    found = diffusion(held, temperature=T)
    assert "confined" in names(found) or found.interval[0] == 0


def test_very_short_tracks_of_held_beads_are_a_finding():
    """Each has 10 frames over 3 relaxation times. Free beads have p < 1e-3 with this probability.

    A flow that drives the beads along does not lead them closer to their beginning.
    """
    drag = BOLTZMANN * T / D
    held = [
        Trajectory(
            STEP, trapped(STEP, 10, 2 * np.pi * 5 * drag, drag, None, T, i, 2).T, "xy", name=str(i)
        )
        for i in range(60)
    ]
    assert "confined" in names(diffusion(held))
    for seed in range(3):
        assert "confined" not in names(diffusion(tracks(seed, count=60, frames=10, noise=2e-8)))


def test_tracks_must_be_alike():
    first, second = tracks(1, count=2)
    with pytest.raises(tweezer.ResultError, match="track 1: has 50 Hz, and track 0 100 Hz"):
        diffusion([first, Trajectory(0.02, second.positions, ("x", "y"), name="track 1")])
    with pytest.raises(tweezer.ResultError, match="must be the same"):
        diffusion([first, Trajectory(STEP, second.positions[:, :1], ("x",), name="line")])
    with pytest.raises(tweezer.ResultError, match=r"exposure = 0\.02 s: must be at most the step"):
        diffusion([first], exposure="20 ms")


def test_a_table_of_short_tracks(command_line, tmp_path):
    write(tmp_path / "all.csv", tracks(3, gaps=0.05))
    rate = ("--rate", "100 Hz", "--temperature", "20 degC")
    outcome = command_line("calibrate", "all.csv", *rate, "--out", "a.json")
    assert outcome.code == 0
    first = outcome.out.splitlines()[0]
    assert first.startswith("x, y: 25 tracks together, treated as free beads: diffusion ")
    found = json.loads((tmp_path / "a.json").read_text("utf-8"))["diffusion"]
    assert found["interval"][0] < D < found["interval"][1]
    outcome = command_line("calibrate", "all.csv", *rate, "--bead", "7")
    assert "samples are too few to detect a trap; treated as a free bead: diffusion" in outcome.out
    outcome = command_line("calibrate", "all.csv", *rate, "--drift", "1 Hz")
    assert (outcome.code, "has 25 beads; name the one" in outcome.err) == (2, True)


def test_tracks_that_are_not_trusted_exit_with_1(command_line, tmp_path):
    write(tmp_path / "all.csv", tracks(1, diffusions=(0.5 * D, 1.5 * D)))
    outcome = command_line("calibrate", "all.csv", "--rate", "100 Hz", "--temperature", "20 degC")
    assert outcome.code == 1
    assert "not trusted: the tracks differ in their diffusion" in outcome.out


def test_several_files_of_free_beads_are_one_diffusion(command_line, tmp_path):
    """Long tracks, each of which is found to be free: no tables of stiffness."""
    for number, each in enumerate(tracks(4, count=2, frames=600)):
        table = np.column_stack([STEP * np.arange(600), 1e6 * each.positions])
        np.savetxt(tmp_path / f"{number}.csv", table, fmt="%.5f", delimiter=",",
                   header="t,x [um],y [um]", comments="")  # fmt: skip
    outcome = command_line(
        "calibrate", "0.csv", "1.csv", "--temperature", "20 degC", "--out", "a.json"
    )
    assert "stiffness" not in outcome.out
    assert "x, y: 2 tracks together, treated as free beads: diffusion" in outcome.out
    found = json.loads((tmp_path / "a.json").read_text("utf-8"))["diffusion"]
    assert found["interval"][0] < D < found["interval"][1]


def test_trapped_beads_in_a_table_are_calibrated_one_by_one(command_line, tmp_path):
    every = [
        Trajectory(
            STEP, 3e-6 * i + trapped(STEP, 200, 1e-6, 9.4e-9, None, T, i, 2).T, "xy", name=str(i)
        )
        for i in range(2)
    ]
    write(tmp_path / "a.csv", every, "TRACK_ID")
    rate = ("--rate", "100 Hz", "--temperature", "20 degC", "--blur", "0")
    outcome = command_line("calibrate", "a.csv", *rate)
    assert outcome.code == 2
    assert outcome.err == (
        "a.csv: has 2 beads that do not seem to diffuse freely; calibrate them one by "
        'one, such as --bead "0"\n'
    )
    assert "x: stiffness by" in command_line("calibrate", "a.csv", *rate, "--bead", "0").out


def test_trajectories_keep_their_gaps(tmp_path):
    every = tracks(5, count=3, gaps=0.1)
    write(tmp_path / "a.csv", every)
    read = load_trajectories(tmp_path / "a.csv", rate="100 Hz")
    assert [each.name for each in read] == [f"{tmp_path / 'a.csv'}, bead {i}" for i in range(3)]
    for mine, theirs in zip(read, every, strict=True):
        there = np.isfinite(theirs.positions).all(axis=1)
        first, last = np.flatnonzero(there)[[0, -1]]
        np.testing.assert_allclose(mine.positions, theirs.positions[first : last + 1], atol=1e-10)
    (tmp_path / "b.csv").write_text("t,x\n0,1e-9\n1,2e-9\n2,3e-9\n", encoding="utf-8")
    with pytest.raises(
        tweezer.ResultError, match="3 consecutive samples; a diffusion coefficient requires 4 or "
    ):
        load_trajectories(tmp_path / "b.csv")


@pytest.mark.parametrize("trapped_bead", [True, False], ids=["trapped", "free"])
def test_a_long_track_with_many_gaps(command_line, tmp_path, trapped_bead):
    """16 % of the frames are missing: a trap is refused, a diffusion is given."""
    x = trapped(STEP, 400, 2e-6, 9.4e-9, None, T, 7, 2)
    if not trapped_bead:
        x = free(STEP, 400, D, 7, count=2, noise=NOISE)
    there = np.random.default_rng(8).random(400) > 0.16
    table = np.column_stack([np.arange(400)[there], 1e6 * x[:, there].T])
    np.savetxt(tmp_path / "a.csv", table, fmt="%.5f", delimiter=",", header="frame,x [um],y [um]",
               comments="")  # fmt: skip
    outcome = command_line("calibrate", "a.csv", "--rate", "100 Hz", "--temperature", "20 degC")
    if trapped_bead:
        assert (outcome.code, outcome.out) == (2, "")
        assert "the longest stretch without a gap has" in outcome.err
    else:
        assert (
            "samples have too many gaps to detect a trap; treated as a free bead: diffus"
            in outcome.out
        )
