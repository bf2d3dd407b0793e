"""The start in z from tracks in the plane: filter against closed forms, fit against truth."""

import dataclasses
import json
import math
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import brentq
from scipy.stats import multivariate_normal

import tweezer
from tests import readable
from tests.benchmarks import depth, depth_report, pages
from tests.fluid.test_drag import growing
from tests.reference import memory
from tests.reference.trapped_bead import BOLTZMANN
from tests.reference.wall import resistance
from tweezer.dynamics import bound_once
from tweezer.dynamics.models import bind_translation
from tweezer.fluid import Stokes, stokes
from tweezer.fluid.wall import BesideWall
from tweezer.optics import light_force
from tweezer.plots import depth_figure
from tweezer.reading import Track
from tweezer.tracking import profile
from tweezer.tracking.filter import Bead, Camera, Filtered, kalman_filter
from tweezer.tracking.profile import LEVEL, Profile, descend
from tweezer.tracking.residuals import p_value
from tweezer.values.errors import ResultError, SceneError

T = 293.15
STUDY = depth.Study("thesis-990nm", 9e-3, 4e3, 15e-9)
Z = -4.05e-6


@pytest.fixture
def half_of_the_places(monkeypatch):
    """Those of the scan over the start."""
    monkeypatch.setattr(profile, "_PLACES", 41)


@pytest.fixture(scope="module")
def scene():
    return depth.unscaled(STUDY.scene)


@pytest.fixture(scope="module")
def tracks():
    return list(depth.tracks(STUDY, 14))


def moments(times, D, kappa, tau):
    """<x x'> of free beads (n, n), and with inertia, by the matrix exponential; from rest at 0.

    One coordinate in a spring of rate kappa = k/beta: dx = v dt, dv = (-kappa x - v)/tau dt and
    noise; without inertia dx = -kappa x dt + noise.
    """
    if tau == 0:
        A, G = np.array([[-kappa]]), np.array([[2 * D]])
    else:
        A = np.array([[0.0, 1.0], [-kappa / tau, -1 / tau]])
        G = np.array([[0.0, 0.0], [0.0, 2 * D / tau**2]])
    n = len(A)
    # of each time: int exp(A s) G exp(A s)^T ds (C. F. Van Loan, 1978)
    size = np.array([1.0, 1e3])[:n]  # so that the blocks are of like size
    A, G = A * size[None] / size[:, None], G / np.outer(size, size)
    spreads, maps = [], []
    for t in times:
        block = expm(t * np.block([[-A, G], [np.zeros((n, n)), A.T]]))
        maps.append(block[n:, n:].T)
        spreads.append(maps[-1] @ block[:n, n:])
    C = np.empty((len(times), len(times)))
    for i in range(len(times)):
        for j in range(i, len(times)):
            C[i, j] = C[j, i] = (expm((times[j] - times[i]) * A) @ spreads[i])[0, 0]
    return C, np.array([each[0] for each in maps]) / size


def averages(begins, exposure, D, tau):
    """Of a free bead over exposures: covariances (n, n), mean time and its share of a velocity.

    With inertia by Gauss's rule; without, <x x'> = 2 D min(s, t) in closed form.
    """
    n = len(begins)
    nodes, weights = np.polynomial.legendre.leggauss(8)
    times = begins[:, None] + exposure * (nodes + 1) / 2
    C, carried = moments(times.ravel(), D, 0.0, tau)
    C = np.einsum("iajb,a,b->ij", C.reshape(n, 8, n, 8), weights / 2, weights / 2)
    if tau == 0:
        C[np.diag_indices(n)] = 2 * D * (begins + exposure / 3)
        return C, begins + exposure / 2, None
    drifted = times - tau * (1 - np.exp(-times / tau))
    return C, drifted @ weights / 2, carried[:, 1].reshape(n, 8) @ weights / 2


@pytest.mark.parametrize("exposure", [0.0, 1e-4])
@pytest.mark.parametrize("tau", [0.0, 0.4e-3])
def test_likelihood_of_a_free_bead(scene, tau, exposure):
    """Next to no light: drift by a load, diffusion; one Gaussian vector has that density.

    The third exposure begins where the second ends.
    """
    radius, power = scene.bead.radius, 1e-15
    rng = np.random.default_rng(1)
    times = np.array([0.0, 0.3, 0.4, 1.7, 2.0, 5.0]) * 1e-3
    D, drift, noise = 4e-13, 3e-4, 20e-9
    spread = np.array([40e-9, 70e-9, 0.0])
    velocity = np.array([1e-4, -2e-4, 0.0])
    seen = 1e-7 * rng.normal(size=(6, 2))
    seen[2, 1] = np.nan
    problem = bound_once(scene)
    problem = dataclasses.replace(
        problem, drag=Stokes(1.0, 1.0),
        bead=dataclasses.replace(problem.bead, mass=tau, weight=(drift, 0.0, 0.0)),
    )  # fmt: skip
    bead = Bead(radius, power, D, np.zeros(3), spread, velocity, 0.0)
    filtered = kalman_filter(bind_translation(problem, "full" if tau else "overdamped"))
    camera = Camera(times, seen, np.full(2, noise), 0.0, exposure)
    memory.leave(memory.ZEROS)
    found = filtered(bead, camera)
    memory.leave(memory.NAN)
    np.testing.assert_array_equal(filtered(bead, camera).predicted, found.predicted)
    if exposure:
        C, drifted, moved = averages(times, exposure, D, tau)
    else:
        C, carried = moments(times, D, 0.0, tau)
        drifted = times - tau * (1 - np.exp(-times / tau)) if tau else times
        moved = carried[:, 1] if tau else None
    expected = 0.0
    for k, (force, values) in enumerate(zip((drift, 0.0), seen.T, strict=True)):
        mean = force * drifted
        if moved is not None:
            mean = mean + moved * velocity[k]
        there = np.isfinite(values)
        total = (C + spread[k] ** 2 + noise**2 * np.eye(6))[np.ix_(there, there)]
        expected += multivariate_normal(1e9 * mean[there], 1e18 * total).logpdf(1e9 * values[there])
        expected += there.sum() * math.log(1e9)
    # Gauss's rule over a square is inexact where the third derivative jumps, on its diagonal
    assert found.log_likelihood == pytest.approx(expected, abs=1e-5 if tau and exposure else 1e-6)


def test_where_the_mobility_grows_with_the_height_the_spread_is_the_closed_form(scene):
    """Mobility b g/l, a weight W: with c = kT/W and rate b W/l, m' = -rate (m - c) of the height,
    P' = -2 rate P + 2 rate c m of its variance; across, a load drifts by the integral of b m/l.
    """
    kT, weight, load, length, height, spread = 4e-21, 2e-14, 1e-14, 2e-6, 3e-6, 50e-9
    drag = growing(length=length)
    across, along, *_ = drag.values
    problem = bound_once(scene.replace(start={"position": [0, 0, 0], "frame": "focus"}))
    bead = dataclasses.replace(problem.bead, weight=(load, 0.0, -weight))
    problem = dataclasses.replace(problem, drag=drag, bead=bead)
    times = np.array([0.0, 0.03, 0.04, 0.17, 0.2, 0.5])
    found = kalman_filter(bind_translation(problem, "overdamped"))(
        Bead(
            scene.bead.radius, 1e-20, kT, np.array([0.0, 0.0, height - length]),
            np.array([0.0, 0.0, spread]), np.zeros(3), 0.0,
        ),
        Camera(times, np.full((6, 2), np.nan), np.full(2, 1e-9), 0.0),
    )  # fmt: skip
    c, rate = kT / weight, along * weight / length
    fallen = np.exp(-rate * times)
    mean = c + (height - c) * fallen
    variance = (
        spread**2 * fallen**2 + c**2 * (1 - fallen**2) + 2 * c * (height - c) * (fallen - fallen**2)
    )
    np.testing.assert_allclose(found.predicted[:, 2], mean - length, atol=1e-15)
    drifted = across / length * load * (c * times + (height - c) * (1 - fallen) / rate)
    np.testing.assert_allclose(found.predicted[:, 0], drifted, rtol=1e-9)
    # the noise of a step is the mean of both ends
    np.testing.assert_allclose(found.deviations[:, 2], np.sqrt(variance), rtol=1e-3)


def test_at_rest_beside_a_wall_the_spread_is_that_of_boltzmann(scene, beside):
    """Under its weight kT/W, about where b W = kT b', b by the exact series, in radii; in the
    trap sqrt(kT/k), about the equilibrium.
    """
    radius, kT, reach = scene.bead.radius, 4e-21, 0.1  # of kT/W, in radii
    problem = bound_once(scene.replace(start={"position": [0, 0, 0], "frame": "focus"}))
    weight = kT / (reach * radius)
    bead = dataclasses.replace(problem.bead, weight=(0.0, 0.0, -weight))
    wall = BesideWall(stokes(1e-3, radius), radius, ((-2e-6, 1.0),))
    problem = dataclasses.replace(problem, drag=wall, bead=bead)
    found = kalman_filter(bind_translation(problem, "overdamped"))(
        Bead(radius, 1e-20, kT, np.array([0.0, 0.0, radius - 1.9e-6]), np.zeros(3), np.zeros(3),
             0.0),
        Camera(np.array([0.0, 5.0, 5.1]), np.full((3, 2), np.nan), np.full(2, 1e-9), 0.0),
    )  # fmt: skip

    def excess(gap, h=1e-3):
        below, here, above = (1 / float(resistance(gap + k * h, 12).away) for k in (-1, 0, 1))
        return here - reach * (above - below) / (2 * h)

    gap = brentq(excess, 0.05, 0.2, xtol=1e-6)
    assert found.predicted[-1, 2] == pytest.approx(radius * (1 + gap) - 2e-6, abs=1e-4 * radius)
    assert found.deviations[-1, 2] == pytest.approx(radius * reach, rel=1e-4)

    near = beside.replace(wall={"position": "-0.6 um"}, start={"position": [0, 0, 0]})
    place = tweezer.characterise(near).equilibrium
    kT, middle = BOLTZMANN * T, np.array(place.position)
    found = kalman_filter(bind_translation(bound_once(near), "overdamped"))(
        Bead(near.bead.radius, 1.0, kT, middle, np.zeros(3), np.zeros(3), 0.0),
        Camera(np.array([0.0, 0.2, 0.3]), np.full((3, 2), np.nan), np.full(2, 1e-9), 0.0),
    )
    deviation = np.sqrt(kT / np.array([place.stiffness[0][0], place.stiffness[2][2]]))
    np.testing.assert_allclose(found.deviations[-1, [0, 2]], deviation, rtol=3e-3)
    assert abs(found.predicted[-1, 2] - middle[2]) < 0.01 * deviation[1]


def test_likelihood_in_the_trap(scene):
    """Within nanometres of the equilibrium the trap is harmonic: full covariance matrix."""
    trap = tweezer.characterise(scene).equilibrium
    beta = tweezer.bead_properties(scene).drag
    k, D = trap.stiffness[0][0], BOLTZMANN * T / beta
    times = np.array([0.0, 0.01, 0.02, 0.07, 0.2, 0.23]) * 1e-3
    seen = 3e-9 * np.random.default_rng(2).normal(size=(6, 2))
    spread = np.array([3e-9, 3e-9, 0.0])
    noise = 1e-9
    bead = Bead(
        scene.bead.radius, 1.0, BOLTZMANN * T, np.array(trap.position), spread, np.zeros(3), 0.0
    )
    filtered = kalman_filter(bind_translation(bound_once(scene), "overdamped"))
    found = filtered(bead, Camera(times, seen, np.full(2, noise), 0.0))
    C, carried = moments(times, D, k / beta, 0.0)
    total = C + spread[0] ** 2 * carried @ carried.T + noise**2 * np.eye(6)
    expected = sum(multivariate_normal(np.zeros(6), 1e18 * total).logpdf(1e9 * x) for x in seen.T)
    expected += 12 * math.log(1e9)
    # the force bends: stiffness changes by 1e-3 over 10 nm
    assert found.log_likelihood == pytest.approx(expected, abs=0.05)
    np.testing.assert_allclose(found.predicted[:, 2], trap.position[2], atol=2e-10)


def test_mean_is_the_motion(scene):
    """Without thermal motion to speak of, and nothing seen, the mean goes as the simulation."""
    run = tweezer.simulate(scene.replace(simulation={"samples": 31}), "6.5 ms", model="overdamped")
    positions = run["position"].values
    seen = np.full((31, 2), np.nan)
    found = kalman_filter(bind_translation(bound_once(scene), "overdamped"))(
        Bead(scene.bead.radius, 1.0, BOLTZMANN * 0.02, positions[0], np.zeros(3), np.zeros(3), 0.0),
        Camera(run["time"].values.copy(), seen, np.full(2, 1e-9), 0.0),
    )
    assert found.log_likelihood == 0.0
    np.testing.assert_allclose(found.predicted, positions, atol=2e-9)


@pytest.mark.usefixtures("half_of_the_places")
def test_coverage_and_bias(scene, tracks):
    """Of 14 intervals of 95 %, fewer than 10 hold the truth once in 2,200 seeds (binomial).

    The bias is below 0.28 of the interval: four of its standard errors are 0.27 of it. The
    benchmark of the depth has 200 tracks of each bead.
    """
    fits = [tweezer.fit_depth(track, scene) for track in tracks]
    assert all(fit.determined and len(fit.intervals) == 1 for fit in fits)
    covered = sum(low <= Z <= high for fit in fits for low, high in fit.intervals)
    assert covered >= 10
    length = np.mean([high - low for fit in fits for low, high in fit.intervals])
    assert length < 0.4e-6
    assert abs(np.mean([fit.z - Z for fit in fits])) < 0.28 * length
    deviation = np.std([fit.z for fit in fits])
    assert deviation == pytest.approx(length / 3.92, rel=0.78)  # 4 standard errors
    noise = np.mean([fit.noise for fit in fits])
    assert noise == pytest.approx(STUDY.noise, rel=0.13)
    # of 14 uniform numbers the least is below 1e-5 once in 7,000
    assert min(fit.p_value for fit in fits) > 1e-5
    assert sum(fit.outliers for fit in fits) < 5


def test_long_exposures(scene):
    """Frames of 2 ms without a pause, in which the bead falls by up to a micrometre."""
    fine, frames, step = 20, 12, 2e-3
    falling = scene.replace(
        forces={"brownian": True},
        simulation={"duration": frames * step, "samples": frames * fine + 1},
    )
    run = tweezer.simulate(falling, seed=2)
    x = run["position"].values[:, :2]
    means = [
        np.trapezoid(x[fine * i : fine * (i + 1) + 1], dx=1 / fine, axis=0) for i in range(frames)
    ]
    seen = means + 15e-9 * np.random.default_rng(2).normal(size=(frames, 2))
    track = Track(step * (0.5 + np.arange(frames)), seen, name="exposed")
    fit = tweezer.fit_depth(track, scene, noise=15e-9, exposure=step)
    assert fit.determined
    assert fit.intervals[0][0] < Z < fit.intervals[0][1]
    assert not tweezer.fit_depth(track, scene, noise=15e-9).determined
    with pytest.raises(ResultError, match=r"exposure = 0.0021 s: must be from 0 to the shortest"):
        tweezer.fit_depth(track, scene, exposure=2.1e-3)


def test_fitted_quantities_reduce_the_degrees_of_freedom():
    """With 13 numbers fitted to 24 residuals, p < 0.1 in a tenth of 300 tracks.

    The limit is four standard errors above. Counted as 24, they would be too small in 217.
    """
    rng = np.random.default_rng(8)
    away = np.linalg.qr(rng.normal(size=(24, 13)))[0]
    found = []
    for _ in range(300):
        drawn = rng.normal(size=24)
        residuals = (drawn - away @ (away.T @ drawn)).reshape(12, 2)
        path = Filtered(0.0, residuals, residuals, residuals, np.ones((12, 2)))
        found.append(p_value(path, sized=True, fitted=13))
    assert np.mean(np.array(found) < 0.1) < 0.1 + 4 * math.sqrt(0.09 / 300)


def test_outliers_and_gaps(scene, tracks):
    """5 % of numbers from anywhere, missing rows and cells: the fit stays where it was."""
    clean = tweezer.fit_depth(tracks[0], scene)
    positions = tracks[0].positions.copy()
    for frame, axis, off in ((0, 1, 1e-6), (9, 0, -0.8e-6), (20, 1, 0.6e-6), (22, 0, 1.2e-6)):
        positions[frame, axis] += off
    positions[7, 0] = positions[12] = np.nan
    kept = np.delete(np.arange(len(positions)), [15, 16, 17])
    fit = tweezer.fit_depth(Track(tracks[0].times[kept], positions[kept], name="dirty"), scene)
    assert fit.outliers == 4
    assert fit.determined
    (low, high), (clean_low, clean_high) = fit.intervals[0], clean.intervals[0]
    assert abs(fit.z - clean.z) < (clean_high - clean_low) / 2
    assert high - low < 1.6 * (clean_high - clean_low)
    assert low <= Z <= high


def test_a_bead_far_from_any_light_tells_nothing(scene):
    """It stays where it is, as it would anywhere: the interval is the whole search."""
    rng = np.random.default_rng(4)
    still = 15e-9 * rng.normal(size=(40, 2))
    fit = tweezer.fit_depth(
        Track(2.5e-4 * np.arange(40), still + np.array([0.0, 4.9e-6]), name="far"),
        scene.replace(beam={"power": 1e-9}),
        noise=15e-9,
    )
    assert not fit.determined
    assert fit.intervals == ((fit.search[0], fit.search[1]),)
    assert "does not determine z" in fit.statement
    assert "open at the end of the search" in fit.statement


def test_two_places(scene):
    """A bead at rest in the trap may have come from where it falls into it between two frames."""
    times = np.append(0.0, 2e-3 + 1e-3 * np.arange(20))
    seen = 15e-9 * np.random.default_rng(5).normal(size=(21, 2))
    fit = tweezer.fit_depth(Track(times, seen, name="trapped"), scene, noise=15e-9)
    assert not fit.determined or fit.intervals[0][1] - fit.intervals[0][0] > 1e-6
    assert any(low <= 0.15e-6 <= high for low, high in fit.intervals)


@pytest.mark.usefixtures("half_of_the_places")
def test_power_and_a_given_noise(scene, tracks):
    """What is not known widens the interval, and is found within its uncertainty."""
    known = tweezer.fit_depth(tracks[1], scene, noise=STUDY.noise, search=(-6e-6, -2e-6))
    fit = tweezer.fit_depth(
        tracks[1], scene, noise=STUDY.noise, search=(-6e-6, -2e-6), fit=["power"]
    )
    (power,) = fit.parameters
    true = light_force(scene).light.cone.power
    assert abs(power.value - true) < 4 * power.uncertainty  # false alarm 1e-4
    assert fit.intervals[-1][1] - fit.intervals[0][0] > 2 * (
        known.intervals[-1][1] - known.intervals[0][0]
    )
    assert not known.parameters
    told = tweezer.fit_depth(tracks[1], scene, noise=4e-9, search=(-6e-6, -2e-6))
    assert told.p_value < 1e-3
    assert "the residuals are not white" in told.statement
    assert not told.determined


def from_seed(scene, seed):
    """The track of the documentation, with another seed."""
    falling = scene.replace(
        forces={"brownian": True}, simulation={"duration": "9 ms", "samples": 37}
    )
    run = tweezer.simulate(falling, seed=seed)
    noise = np.random.default_rng(seed).normal(scale=15e-9, size=(37, 2))
    return Track(run["time"].values, run["position"].values[:, :2] + noise, name=f"seed {seed}")


@pytest.mark.usefixtures("half_of_the_places")
@pytest.mark.parametrize(("seed", "name", "factor"), [(11, "power", 1.25), (8, "radius", 1)])
def test_nothing_fits_better_than_the_best(scene, seed, name, factor):
    """The misfit at the truth, as a fit of what is known tells it, is not below the best of all.

    The noise of the camera is fitted, and is not at the end of its range.
    """
    track = from_seed(scene, seed)
    told = scene.replace(beam={"power": factor * scene.beam.power})
    fit = tweezer.fit_depth(track, told, fit=[name])
    known = tweezer.fit_depth(track, scene, search=(Z - 1e-9, Z + 1e-9))
    assert known.path.log_likelihood < fit.path.log_likelihood + 0.05
    assert 5e-9 < fit.noise < 30e-9
    assert all(each.uncertainty for each in fit.parameters)
    for low, high in fit.intervals:
        assert -7.5e-6 <= low < high < -1e-6


def test_a_straight_line_is_followed_from_everywhere():
    """Next to no noise: a covariance that is not symmetric to the last digit grows negative."""
    times = np.arange(51.0)
    line = np.column_stack([np.round(-2.94 + 0.0266 * times, 4), np.full(51, -0.17)])
    fit = tweezer.fit_depth(
        Track(1e-3 * times, 1e-6 * line, name="line"), depth.unscaled("thesis-1950nm")
    )
    assert np.isfinite(np.array(fit.profile)).all()
    assert not fit.determined


@pytest.fixture(scope="module")
def beside():
    """A bead of 1 um that starts a tenth of it above a wall, below the focus and beside it."""
    return tweezer.load_scene("silica-1um").replace(
        beam={"power_through_pupil": "5 mW"}, wall={"position": "-2 um"},
        start={"position": ["0.4 um", "0.2 um", "-1.4 um"]}, optics={"evaluator": "map"},
        simulation={"model": "overdamped", "duration": "40 ms", "samples": 41},
    )  # fmt: skip


def track_beside(scene, seed):
    jiggling = scene.replace(forces={"brownian": True})
    run = tweezer.simulate(jiggling, seed=seed)
    noise = np.random.default_rng(seed).normal(scale=10e-9, size=(41, 2))
    return Track(run["time"].values, run["position"].values[:, :2] + noise, name=f"seed {seed}")


def test_beside_a_wall_the_start_is_found_by_the_drag_there(beside):
    """Of 12 intervals of 95 %, fewer than 8 hold the truth once in 5,000 seeds (binomial). With
    the drag far away the bead would fall into the trap too fast: no interval holds it.
    """
    away = beside.replace(wall={"position": "-100 um"})
    held = {"beside": 0, "away": 0}
    starts = []
    for seed in range(12):
        track = track_beside(beside, seed)
        for name, scene in (("beside", beside), ("away", away)):
            fit = tweezer.fit_depth(track, scene, noise=10e-9, search=(-1.49e-6, 0.0))
            held[name] += any(low <= -1.4e-6 <= high for low, high in fit.intervals)
            if name == "beside":
                starts.append(fit.z)
                assert fit.p_value > 1e-5
    assert held["beside"] >= 8
    assert held["away"] <= 2
    # their deviation is 35 nm: four standard errors
    assert abs(np.mean(starts) + 1.4e-6) < 40e-9


def test_what_a_wall_leaves_out_of_the_fit_is_refused(beside):
    track = track_beside(beside, 0)
    fit = tweezer.fit_depth(track, beside, noise=10e-9)
    assert fit.search[0] == pytest.approx(-1.5e-6, abs=1e-9)
    assert all(low > -1.5e-6 for low, _ in fit.intervals)
    for options, complaint in (
        ({"search": (-1.6e-6, 0.0)}, "reaches into the wall"),
        ({"fit": ["scaling_factor"]}, "requires simulation.model = 'scaled'"),
    ):
        with pytest.raises(ResultError, match=complaint):
            tweezer.fit_depth(track, beside, **options)
    screened = beside.replace(forces={"dlvo": {"strength": 1e-19, "debye_length": "10 nm"}})
    with pytest.raises(ResultError, match=r"fit = 'power': cannot be combined with forces\.dlvo"):
        tweezer.fit_depth(track, screened, fit=["power"])
    scaled = beside.replace(simulation={"model": "scaled", "scaling_factor": 1e-3})
    with pytest.raises(SceneError, match="fitted without inertia"):
        tweezer.fit_depth(track, scaled)


def test_release(scene, tracks):
    """Held for ten frames before it falls."""
    track = tracks[2]
    step = track.times[1]
    rng = np.random.default_rng(6)
    held = track.positions[0] + STUDY.noise * rng.normal(size=(10, 2))
    late = Track(
        np.arange(len(track.times) + 10) * step, np.vstack([held, track.positions]), name="late"
    )
    fit = tweezer.fit_depth(late, scene, noise=STUDY.noise, search=(-6e-6, -2e-6), fit=["release"])
    (release,) = fit.parameters
    assert any(low <= Z <= high for low, high in fit.intervals)
    # false alarm 1e-4
    assert abs(release.value - 10 * step) < 4 * release.uncertainty < 6 * step


def test_scaled_model(scene):
    """The scaled bead is heavier: its tracks are fitted with its inertia."""
    scaled = scene.replace(simulation={"model": "scaled", "scaling_factor": 1.2e-3})
    run = tweezer.simulate(
        scaled.replace(forces={"brownian": True}, simulation={"samples": 37, "duration": "9 ms"}),
        seed=2,
    )
    seen = run["position"].values[:, :2] + 15e-9 * np.random.default_rng(7).normal(size=(37, 2))
    fit = tweezer.fit_depth(
        Track(run["time"].values, seen, name="scaled"), scaled, noise=15e-9, search=(-6e-6, -2e-6)
    )
    assert fit.determined
    (low, high) = fit.intervals[0]
    margin = high - low  # within three times the interval: false alarm below 1e-7
    assert low - margin < Z < high + margin
    assert fit.p_value > 1e-4


def test_a_jagged_profile_determines_nothing():
    """The scaled model of the small bead, on a track of the unscaled one: the misfit is jagged."""
    truth = depth.unscaled("thesis-500nm")
    run = tweezer.simulate(
        truth.replace(
            forces={"brownian": True}, simulation={"samples": 60, "duration": "11.8 ms"}
        ),
        seed=4,
    )  # fmt: skip
    seen = run["position"].values[:, :2] + 10e-9 * np.random.default_rng(1).normal(size=(60, 2))
    fit = tweezer.fit_depth(
        Track(run["time"].values, seen, name="jagged"), tweezer.load_scene("thesis-500nm"),
        noise=10e-9, search=(-3e-6, -1e-6),
    )  # fmt: skip
    assert not fit.determined
    assert "the misfit jumps" in fit.statement


def test_misfit_jumps_are_sought_and_told():
    """A parabola 40 nm wide is resolved; a step in it is not, and is halved five times."""

    class Likelihood:
        unit, bounds, steps, trials = 1e-6, np.empty((0, 2)), np.array([0.03]), np.empty((1, 0))

        def __init__(self, step):
            self.step = step

        def misfit(self, z, _, most=math.inf):
            return ((z - 0.11e-6) / 20e-9) ** 2 + (self.step if z > 0.12e-6 else 0.0)

    for step, jumps in ((0.0, False), (20.0, True)):
        profile = Profile(Likelihood(step), (-4e-6, 4e-6), None)
        profile.polish()
        profile.refine()
        assert profile.jumps(LEVEL).any() == jumps
        assert profile.places[profile.values.argmin()] == pytest.approx(
            0.11e-6, abs=3e-9
        )  # 0.02 of misfit
        if jumps:
            at = int(np.searchsorted(profile.places, 0.12e-6))
            assert profile.places[at] - profile.places[at - 1] < 2 * 0.1e-6 / 32


def test_the_lower_of_two_valleys_is_followed_from_both_sides():
    """Two valleys over z, each the lower on its side: every place has the lower one's value."""

    class Likelihood:
        unit, steps = 1.0, np.array([0.03, 0.05])
        bounds, trials = np.array([[-4.0, 4.0]]), np.array([[0.0], [-3.0], [3.0]])

        def valleys(self, z):
            return (z - 1) ** 2, (z + 1) ** 2 + 0.5

        def misfit(self, z, p, most=math.inf):
            left, right = self.valleys(z)
            if z > 3.5:
                return math.inf
            return min(left + 40 * (p[0] - 1.5 - 0.2 * z) ** 2, right + 40 * (p[0] + 2) ** 2)

    known = Likelihood()
    profile = Profile(known, (-4.0, 4.0), None)
    least = [min(known.valleys(z)) for z in profile.places]
    near = np.array(least) < 20
    followed = profile.places <= 3.5
    np.testing.assert_allclose(
        profile.values[near & followed], np.array(least)[near & followed], atol=0.02
    )
    assert np.isinf(profile.values[~followed]).all()
    assert profile.converged[near & followed].all()


def test_newton_keeps_to_its_bounds_and_leaves_a_ridge():
    """A slope without curvature ends at the bound; from a maximum's side it goes down."""
    steps = np.array([0.05, 0.05])
    bounds = np.array([[-1.0, 2.0], [-3.0, 3.0]])

    def misfit(p):
        return 5 * p[0] + 30 * (p[1] ** 2 - 1) ** 2

    found = descend(misfit, np.array([1.0, 0.1]), bounds, steps)
    np.testing.assert_allclose(found.at, [-1.0, 1.0], atol=5e-3)
    assert found.converged
    assert not descend(lambda p: math.inf, np.zeros(2), bounds, steps).converged


def test_wrong_start_and_gaps(scene, tracks):
    """A first frame off by 0.9 mm; every second frame missing; frames 2 to 7 missing."""
    track = tracks[4]
    outlier, alternating, late = (track.positions.copy() for _ in range(3))
    outlier[0, 0] += 0.9e-3
    alternating[1::2] = np.nan
    late[1:7] = np.nan
    for positions, outliers in ((outlier, 1), (alternating, 0), (late, 0)):
        fit = tweezer.fit_depth(
            Track(track.times, positions, name="gaps"), scene, search=(-6e-6, -2e-6)
        )  # fmt: skip
        assert fit.determined
        (low, high) = fit.intervals[0]
        margin = high - low  # within three times the interval: false alarm below 1e-7
        assert low - margin < Z < high + margin
        assert fit.outliers == outliers


def test_a_coordinate_that_is_exactly_predicted(scene, tracks):
    """The beads of the thesis start with x = 0, and stay there without thermal motion."""
    positions = tracks[0].positions.copy()
    positions[:, 0] = 0.0
    fit = tweezer.fit_depth(
        Track(tracks[0].times, positions, name="x = 0"), scene, noise=15e-9, search=(-6e-6, -2e-6)
    )
    assert math.isfinite(fit.p_value)
    assert fit.intervals[0][0] - 1e-6 < Z < fit.intervals[-1][1] + 1e-6


def test_a_noise_that_is_none_is_not_determined(scene):
    """The noise of a track that does not move at all lies at the end of its range."""
    still = np.tile([0.0, 4.9e-6], (20, 1))
    fit = tweezer.fit_depth(
        Track(2.5e-4 * np.arange(20), still, name="still"), scene, search=(-2e-6, 2e-6)
    )
    (noise,) = fit.parameters
    assert noise.uncertainty is None
    assert "the noise is too small to be determined" in fit.statement


@pytest.mark.parametrize(
    ("times", "positions", "complaint"),
    [(np.arange(20.0), np.ones((20, 3)), r"positions of shape \(20, 3\)"),
     (np.arange(21.0), np.ones((20, 2)), r"times of shape \(21,\)"),
     (np.arange(20.0)[:, None], np.ones((20, 2)), r"times of shape \(20, 1\)"),
     (np.arange(20.0), np.ones(20), r"positions of shape \(20,\)"),
     (np.arange(20.0), [["a", "b"]] * 20, "positions: must be a number in m")],
)  # fmt: skip
def test_shapes_of_a_track(times, positions, complaint):
    with pytest.raises(ResultError, match=complaint):
        Track(times, positions, name="wrong")


def test_a_track_of_lists_and_integers():
    track = Track(list(range(20)), np.ones((20, 2), dtype=np.float32) * 1e-6, name="lists")
    assert track.times.dtype == track.positions.dtype == np.float64


def test_fit_is_a_list(scene, tracks):
    with pytest.raises(ResultError, match="fit = 'power': must be a list of names"):
        tweezer.fit_depth(tracks[0], scene, fit="power")


def text(heading="t [ms],x [um],y [um]", **changed):
    """Lines of a table; `changed` by the number of the line, with an l before it."""
    rows = [f"{0.25 * i},{0.01 * (i % 3)},{-2 + 0.01 * (i % 5)}" for i in range(30)]
    lines = [heading, *rows]
    for line, row in changed.items():
        lines[int(line[1:]) - 1] = row
    return "\n".join(lines) + "\n"


@pytest.mark.parametrize(
    ("content", "options", "complaint"),
    [(text("t [ms],x [um]"), (), "has no column y"),
     (text("t [ms],x [kg],y [um]"), (), "x [kg]: 'kg' has the wrong unit"),
     (text(l9="1,0,-2"), (), "sample 8: its time is not later than the previous time"),
     (text(l9="inf,0,-2"), (), "frame 8: its time is not finite"),
     (text(l9="1.75,inf,-2"), (), "frame 8: not finite"),
     (text(l9="1.75,zero,-2"), (), "line 9: 'zero' is not a number"),
     (text("t,x,y"), (), "Is its unit missing?"),
     ("\n".join(text().splitlines()[:9]) + "\n", (), "must have 10 or more"),
     ("t [ms],x [um],y [um]\n", (), "track.csv: has no frame with x and y"),
     (text(), ("--noise", "1 mm"), "noise = 0.001 m: must be from 1e-10 to 1e-06 m"),
     (text(), ("--search", "1 um", "-1 um"), "must be an ascending range of z"),
     (text(), ("--search", "1 kg", "-1 um"), "--search '1 kg'"),
     (text(), ("--fit", "colour"), "fit = 'colour': allowed: power, radius"),
     (text(), ("--fit", "scaling_factor"), "requires simulation.model = 'scaled'"),
     (text(), ("--search", "-1 mm", "0 um"), "must be nearer than twice"),
     (text(), ("--out", "d.txt"), "must end in .json")],
)  # fmt: skip
def test_bad_input_is_one_line(command_line, content, options, complaint):
    Path("track.csv").write_text(content, encoding="utf-8")
    outcome = command_line(
        "fit-depth", "track.csv", "--scene", "thesis-990nm", "--set", "simulation.model=full",
        "--plot", "d.png", *options,
    )  # fmt: skip
    assert (outcome.code, outcome.out) == (2, "")
    assert len(outcome.err.splitlines()) == 1
    assert complaint in outcome.err
    assert [path.name for path in Path().iterdir()] == ["track.csv"]


def test_command(command_line, tracks):
    track = tracks[3]
    rows = [
        f"{1e3 * t:.9g},{1e6 * x:.9g},{1e6 * y:.9g}"
        for t, (x, y) in zip(track.times, track.positions, strict=True)
    ]
    rows[5] = rows[5].rsplit(",", 1)[0] + ","
    Path("track.csv").write_text("\n".join(["t [ms],x [um],y [um]", "-1,,0.1", *rows]) + "\n")
    outcome = command_line(
        "fit-depth", "track.csv", "--scene", "thesis-990nm", "--set", "simulation.model=full",
        "--search", "-7 um", "-1 um", "--out", "d.json", "--plot", "d.png",
    )  # fmt: skip
    assert (outcome.code, outcome.err) == (0, "")
    written = json.loads(Path("d.json").read_text())
    assert written["statement"].replace("+-", "±").replace(" um", " µm") in outcome.out
    assert written["frames"] == len(rows)
    assert written["determined"]
    assert written["search"] == pytest.approx([-7e-6, -1e-6])
    (low, high), z = written["intervals"][0], written["z"]
    assert low < z < high
    assert f"{1e6 * low:.4g} to {1e6 * high:.4g} µm" in outcome.out
    assert Path("d.png").read_bytes().startswith(b"\x89PNG")
    # of the profile, the interval is where it is below the level
    at, misfit = np.array(written["profile"]).T
    assert ((misfit < 3.8414) == ((at > low) & (at < high))).all()


def test_a_run_is_a_track(scene):
    run = tweezer.simulate(
        scene.replace(forces={"brownian": True}, simulation={"samples": 40, "duration": "9 ms"}),
        seed=8,
    )
    fit = tweezer.fit_depth(run, noise=1e-9, search=(-6e-6, -2e-6))
    assert fit.frames == 40
    low, high = fit.intervals[0]
    margin = high - low
    assert low - margin < Z < high + margin
    figure = depth_figure(tweezer.load_track(run), fit)
    readable.check(figure)


def test_page_quotes_the_committed_depths():
    committed = pages.committed("depth")
    assert pages.quoted("depth") == depth_report.block(committed)
    assert not committed["quick"]
    for each in committed["beads"]:
        assert each["tracks"] >= 100
        assert each["coverage"] >= 0.92
        assert each["determined"]["coverage"] >= 0.92
        assert each["determined"]["coverage_to"] >= 0.95
        assert abs(each["bias_of_interval"]) < 0.2 or each["fit"]


def test_medium_with_relaxing_elements_is_refused():
    scene = tweezer.load_scene("silica-1um").replace(
        medium={"relaxing": [{"viscosity": "4 mPa s", "time": "5 ms"}]}
    )
    track = Track(1e-3 * np.arange(20.0), 1e-9 * np.arange(20.0)[:, None] * [1.0, 0.0], name="line")
    with pytest.raises(SceneError, match=r"medium\.relaxing.*: a fit assumes a fluid without"):
        tweezer.fit_depth(track, scene, noise=1e-8, search=(-2e-6, -1e-6))
