"""What a camera sees: exposures against closed forms and fine paths, noise, the same bits."""

from __future__ import annotations

import filecmp
import itertools
import math

import numpy as np
import pytest

import tweezer
from tests.reference.detected_bead import correlation
from tweezer.dynamics.walk import Walk, walk
from tweezer.ensembles import job
from tweezer.plots.report import page_of
from tweezer.values.errors import ResultError, SceneError

SCENE = tweezer.load_scene("silica-1um").replace(
    forces={"brownian": True},
    optics={"evaluator": "map", "table_tolerance": 1e-4},
    start={"drawn": "boltzmann"},
    simulation={"duration": "20 ms", "samples": 21, "model": "overdamped"},
)


def filmed(scene, beads, seed=1, cuts=(0, 20)):
    """Frames (beads, frames, axes) of a walk that is taken on from cut to cut."""
    bound, who = walk(scene, seed), np.arange(beads)
    states, seen = bound.start(who), []
    for first, last in itertools.pairwise(cuts):
        out = np.empty((beads, last - first, len(bound.columns)))
        seen.append(bound.filmed(states, who, first, out))
    return bound, np.concatenate(seen, axis=1)


def averaged(kappa, exposure, apart):
    """Covariance, over the variance, of means of an Ornstein-Uhlenbeck process: at no distance, and
    at one of at least the exposure.
    """
    v = kappa * exposure
    if not v:
        return 1.0, math.exp(-kappa * apart)
    return (
        2 * (v - 1 + math.exp(-v)) / v**2,
        (math.sinh(v / 2) / (v / 2)) ** 2 * math.exp(-kappa * apart),
    )


@pytest.mark.parametrize(
    ("rate", "exposure"), [(2500.0, 4e-4), (9137.0, 0.0), (9137.0, 3.3e-5), (31e3, 1 / 31e3)]
)
def test_frames_have_the_moments_of_a_bead_in_a_spring(rate, exposure):
    """By the method that is exact at any step; x is five standard errors off at most."""
    camera = {"rate": rate, "exposure": exposure, "noise_along": 0.0}
    scene = SCENE.replace(simulation={"method": "harmonic"}, camera=camera)
    bound, seen = filmed(scene, 512)
    plan, bead = bound.plan, bound.problem.bead
    for axis in (0, 2):
        kappa = bound.equilibrium.stiffness[axis][axis] / bead.drag
        x = (seen[..., axis] - plan.centre[axis]) / math.sqrt(plan.diffusion[axis] / kappa)
        square, product = averaged(kappa, exposure, 1 / rate)
        for each, expected in (
            ((x**2).mean(axis=1), square),
            ((np.diff(x, axis=1) ** 2).mean(axis=1), 2 * (square - product)),
        ):
            error = each.std() / math.sqrt(len(each))
            assert abs(each.mean() - expected) < 5 * error
            assert error < 0.02 * expected


@pytest.mark.parametrize("exposure", [0.0, 1 / 31e3])
def test_frames_of_a_bead_far_from_its_spring_follow_the_bend_of_its_path(exposure):
    """The mean of 256 beads from 3 um away; the chord between steps would be 7 nm off."""
    rate = 31e3
    scene = SCENE.replace(
        start={"drawn": "no", "position": ["3 um", 0, 0]},
        camera={"rate": rate, "exposure": exposure}, simulation={"method": "harmonic"},
    )  # fmt: skip
    bound, seen = filmed(scene, 256, cuts=(0, 1))
    kappa = bound.equilibrium.stiffness[0][0] / bound.problem.bead.drag
    for j, x in enumerate(seen[:, :6, 0].T):
        v = kappa * exposure
        mean = (1 - math.exp(-v)) / v if v else 1.0
        expected = 3e-6 * math.exp(-kappa * j / rate) * mean
        assert abs(x.mean() - expected) < 5 * x.std() / 16 + 1e-9


def test_frames_of_a_bead_with_inertia_move_from_one_to_the_next_as_it_does():
    """The oracle is the closed form of the correlation. The limit for x and y is five standard
    errors, 2 %.

    The force alone allows a step of 3.6 frames, with which they move 4 % more: nine errors.
    """
    exposure = 5e-6
    camera = {"rate": 1 / exposure, "exposure": exposure, "noise_along": 0.0}
    bound, seen = filmed(
        SCENE.replace(simulation={"model": "full"}, camera=camera), 64, cuts=(0, 10)
    )
    assert bound.problem.scene.medium.inertia == "memory"
    bead, (nodes, weights) = bound.problem.bead, np.polynomial.legendre.leggauss(16)
    for axis in (0, 1):
        k = bound.equilibrium.stiffness[axis][axis]
        of_bead = k, bead.drag, bead.mass, bead.displaced_mass
        # how far apart two moments in exposures are: a triangle about the time between these
        u = (nodes + 1) / 2
        square, product = (
            sum((1 - u) * weights / 2 @ correlation(np.abs(apart + way * u * exposure), *of_bead)
                for way in (-1, 1))
            for apart in (0.0, exposure)
        )  # fmt: skip
        expected = 2 * (square - product)
        squares = np.diff(seen[..., axis], axis=1) ** 2 * k / bound.plan.kT
        each = squares.mean(axis=1)
        error = each.std() / math.sqrt(len(each))
        assert abs(each.mean() - expected) < 5 * error
        assert error < 0.005 * expected


def test_beside_a_wall_frames_diffuse_as_the_bead_does_there():
    """Three to a step, at a gap of 60 nm, where D is 0.46 and 0.1 of that far away."""
    scene = SCENE.replace(
        forces={"gravity": False}, beam={"power_through_pupil": "1 mW"},
        wall={"position": "-0.56 um"}, start={"drawn": "no", "position": [0, 0, 0]},
        simulation={"duration": "0.2 ms", "samples": 3, "step": "0.1 ms"},
        camera={"rate": 3e4, "exposure": 0.0, "noise_along": 0.0},
    )  # fmt: skip
    bound, seen = filmed(scene, 512, cuts=(0, 2))
    places = seen[:, :-1].reshape(-1, 3)
    D = bound.plan.kT * bound.problem.mobilities(places)[:, :3].mean(axis=0)
    squares = np.diff(seen, axis=1).reshape(-1, 3) ** 2 * 3e4 / 2
    error = squares.std(axis=0) / math.sqrt(len(squares))
    assert len(squares) == 512 * 6
    assert np.all(np.abs(squares.mean(axis=0) - D) < 5 * error)


def test_frames_are_means_of_the_path():
    """Of steps that are all in the output: what is between them is 0.3 nm, a thermal move 60 nm."""
    scene = SCENE.replace(
        camera={"rate": "777 Hz", "exposure": "0.6 ms", "noise_along": 0.0},
        simulation={"duration": "10 ms", "samples": 10001},
    )
    run = tweezer.simulate(scene, seed=2)
    assert run.attrs["steps"] == 10000
    assert run.sizes["frame"] == 8
    for j, seen in enumerate(run["seen"].values):
        middle = j / 777 + 0.3e-3
        assert run["frame_time"].values[j] == pytest.approx(middle, rel=1e-12)
        there = np.abs(run["time"].values - middle) <= 0.3e-3
        assert np.abs(run["position"].values[there].mean(axis=0) - seen).max() < 1e-9


@pytest.mark.parametrize("model", ["overdamped", "full"])
@pytest.mark.parametrize("exposure", [0.0, 1 / 1300])
def test_the_same_bits_however_a_walk_is_cut(model, exposure):
    camera = {"rate": 1300.0, "exposure": exposure, "noise": "5 nm"}
    scene = SCENE.replace(simulation={"model": model}, camera=camera)
    _, seen = filmed(scene, 9)
    _, cut = filmed(scene, 9, cuts=(0, 1, 5, 6, 20))
    _, alone = filmed(scene, 1)
    assert np.array_equal(seen, cut)
    assert np.array_equal(seen[:1], alone)
    assert seen.shape == (9, 26 + (exposure == 0), 2)


def test_a_camera_changes_no_motion_and_a_run_is_of_its_ensemble():
    scene = SCENE.replace(camera={"rate": "1.3 kHz", "exposure": "0.5 ms", "noise": "5 nm"})
    run, without = tweezer.simulate(scene, seed=3), tweezer.simulate(SCENE, seed=3)
    assert np.array_equal(run["position"], without["position"])
    assert "seen" not in without
    many = tweezer.ensemble(scene, 2, seed=3)
    assert np.array_equal(many["seen"][0], run["seen"])
    assert np.array_equal(many["frame_time"], run["frame_time"])
    quiet = tweezer.simulate(scene.replace(camera={"noise": 0.0}), seed=3)
    noise = (run["seen"] - quiet["seen"]).values
    assert 0.6 < noise.std() / 5e-9 < 1.4  # of 50 numbers


def test_a_store_goes_on_to_the_same_bytes(tmp_path, monkeypatch):
    """Broken off in a block, with frames in chunks of several windows, one of them torn."""
    monkeypatch.setattr(job, "_WINDOW_NUMBERS", 64 * 3 * 4)
    scene = SCENE.replace(
        camera={"rate": "1.3 kHz", "exposure": "0.5 ms", "noise": "5 nm"},
        simulation={"samples": 24},
    )
    whole, cut = tmp_path / "whole.zarr", tmp_path / "cut.zarr"
    seen = tweezer.ensemble(scene, 70, seed=3, out=whole)["seen"].values
    filmed, calls = Walk.filmed, itertools.count()

    def breaking(*arguments):
        if next(calls) == 3:
            raise RuntimeError("broken off")
        return filmed(*arguments)

    monkeypatch.setattr(Walk, "filmed", breaking)
    with pytest.raises(RuntimeError, match="broken off"):
        tweezer.ensemble(scene, 70, seed=3, out=cut, workers=1)
    (written, *_) = sorted(path for path in (cut / "seen" / "c").rglob("*") if path.is_file())
    written.write_bytes(b"torn")
    tweezer.ensemble(scene, 70, seed=3, out=cut, resume=True)
    files = [path.relative_to(whole) for path in whole.rglob("c/**/*") if path.is_file()]
    same, different, missing = filecmp.cmpfiles(whole, cut, files, shallow=False)
    assert (different, missing) == ([], [])
    assert len([each for each in same if each.parts[0] == "seen"]) > 4
    assert np.isfinite(seen).all()


def test_a_bead_without_thermal_motion_is_seen_too():
    """Against the trapezium rule on 200 samples of each exposure; z is not seen."""
    camera = {"rate": "2 kHz", "exposure": "0.2 ms"}
    scene = tweezer.load_scene("silica-1um").replace(
        simulation={"duration": "5 ms", "samples": 5001}, camera=camera
    )
    whole = tweezer.simulate(scene)
    assert whole["seen"].shape == (10, 2)
    for j, seen in enumerate(whole["seen"].values):
        there = slice(500 * j, 500 * j + 201)
        mean = np.trapezoid(whole["position"].values[there], dx=1 / 200, axis=0)
        np.testing.assert_allclose(seen, mean[:2], atol=1e-11)
    noisy = scene.replace(camera={"exposure": 0.0, "noise": "5 nm"}, simulation={"samples": 11})
    runs = [tweezer.simulate(noisy, seed=seed) for seed in (1, 1, 2)]
    assert [run.attrs["seed"] for run in runs] == [1, 1, 2]
    seen = [run["seen"].values for run in runs]
    path = whole["position"].values[::500, :2]
    assert np.array_equal(seen[0], seen[1])
    assert not np.array_equal(seen[0], seen[2])
    assert 0.5 < (seen[0] - path).std() / 5e-9 < 1.5
    with pytest.raises(SceneError, match="seed: requires"):
        tweezer.simulate(scene, seed=1)


def test_frames_end_where_a_bead_is_lost():
    scene = SCENE.replace(
        beam={"power_through_pupil": "1 uW"}, camera={"rate": "100 Hz", "exposure": "10 ms"},
        start={"drawn": "no", "position": [0, 0, "1 um"]},
        simulation={"loss_distance": "1.05 um", "duration": "1 s", "samples": 2001},
    )  # fmt: skip
    run = tweezer.simulate(scene, seed=1)
    assert run.attrs["status"] == "lost"
    whole = int(run["time"].values[-1] * 100)
    assert whole <= run.sizes["frame"] <= whole + 1
    assert np.isfinite(run["seen"].values).all()


@pytest.mark.parametrize(
    ("sections", "said"),
    [
        ({"camera": {"rate": "1 kHz", "exposure": "2 ms"}}, "camera.*exposure = 0.002: must be"),
        ({"camera": {"rate": "1 Hz", "exposure": "1 s"}}, "must be at most simulation.duration"),
        ({"camera": {"rate": "1e12 Hz"}}, "2e.10 frames in .*= 0.02; must be at most 10,000,000"),
        ({"camera": {"exposure": "1 ms"}}, "camera.rate"),
        ({"camera": {"rate": "1 kHz", "nose": "1 nm"}}, "did you mean noise"),
        (
            {"camera": {"rate": "1 kHz"}, "simulation": {"method": "one-call"}},
            "one-call.*a camera requires displacements",
        ),
    ],
)
def test_cameras_that_are_none(sections, said):
    with pytest.raises(SceneError, match=said):
        SCENE.replace(**sections)


def test_a_saved_run_is_read_as_what_its_camera_saw(command_line, tmp_path):
    """And calibrated by the exposure and the noise of that camera."""
    path = tmp_path / "run.nc"
    outcome = command_line(
        "run", "silica-1um", "--set", "forces.brownian=true", "--set", "optics.evaluator=map",
        "--set", "optics.table_tolerance=1e-4", "--set", "simulation.model=overdamped",
        "--set", "camera.rate=2.5 kHz", "--set", "camera.exposure=0.4 ms",
        "--set", "camera.noise=5 nm", "--set", "camera.noise_along=20 nm", "--set",
        "start.drawn=boltzmann", "--duration", "0.4 s", "--seed", "4", "--out", path,
    )  # fmt: skip
    assert outcome.code == 0, outcome.err
    assert "1000 frames, one every 0.4 ms" in outcome.out
    run = tweezer.load_run(path)
    assert run["seen"].dims == ("frame", "seen_axis")
    assert "frame_time" in run.coords
    recording = tweezer.load_recording(path)
    assert (recording.exposure, recording.noise) == (4e-4, (5e-9, 5e-9, 20e-9))
    assert recording.axes == ("x", "y", "z")
    assert np.array_equal(recording.positions, run["seen"])
    assert recording.step == pytest.approx(4e-4)
    track = tweezer.load_track(run)
    assert np.array_equal(track.positions, run["seen"][:, :2])
    assert np.array_equal(track.times, run["frame_time"])
    assert track.exposure == 4e-4
    run["seen"].attrs["units"] = "um"
    with pytest.raises(ResultError, match="not a run: its seen is not in m"):
        tweezer.load_recording(run)
    with pytest.raises(ResultError, match="its camera frames are not over time and axis"):
        tweezer.load_recording(run.drop_vars("frame_time"))
    found = tweezer.calibrate(recording)
    assert [axis.fit.bead.noise for axis in found.axes] == [5e-9, 5e-9, 20e-9]
    assert found.axes[0].fit.bead.exposure == pytest.approx(4e-4)
    true = np.diag(tweezer.characterise(tweezer.scene_of(run)).equilibrium.stiffness)
    for axis, k in zip(found.axes, true, strict=True):
        each = axis["power spectrum"]
        assert abs(each.stiffness - k) < 4 * each.uncertainty
    facts = dict(page_of(recording, found).facts)
    assert facts["noise of the detector"] == "5, 20 nm"
    assert facts["exposure of each sample"] == "0.4 ms"
    with pytest.raises(ResultError, match="must end in"):
        tweezer.write_report(recording, found, tmp_path / "page.txt")
