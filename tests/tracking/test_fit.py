"""Keys of a scene from recordings: against exact records of a linear trap, and what is refused.

Records with inertia are drawn from the closed spectrum of K. Berg-Sorensen and H. Flyvbjerg.
"""

import dataclasses
import json
import math
from functools import partial
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.linalg import expm, toeplitz
from scipy.optimize import minimize_scalar
from scipy.stats import multivariate_normal

import tweezer
from tests.reference import detected_bead
from tests.reference.trapped_bead import BOLTZMANN
from tweezer.calibration.inertia import Inertia
from tweezer.calibration.spectra import TrappedBead
from tweezer.calibration.whittle import Periodogram
from tweezer.dynamics import bound_once
from tweezer.dynamics.models import bind_translation
from tweezer.reading import Recording
from tweezer.scene import value_at, with_settings
from tweezer.scene.bead import bead_properties
from tweezer.tracking.filter import Bead, Camera, kalman_filter
from tweezer.tracking.mean_spring import mean_spring
from tweezer.tracking.scene_misfit import FreeKey, Misfit
from tweezer.tracking.whitened import Whitened
from tweezer.values.errors import ResultError, SceneError
from tweezer.values.prefixes import usual_unit

RATE, FRAMES, NOISE = 2000.0, 3000, 4e-9
POWER, DIAMETER = "beam.power_through_pupil", "bead.diameter"


def blurred(stiffness, drag, temperature, rng):
    """Means over whole frames of dx = -kappa x dt + noise, exactly: x and its integral are Gaussian
    over a frame, with the covariance of C. F. Van Loan (1978).
    """
    step, kappa, D = 1 / RATE, stiffness / drag, BOLTZMANN * temperature / drag
    A = np.array([[-kappa * step, 0.0], [1.0, 0.0]])  # of x and of its mean, per frame
    G = np.diag([2 * D * step, 0.0]) * 1e16
    block = expm(np.block([[-A, G], [np.zeros((2, 2)), A.T]]))
    Phi = block[2:, 2:].T
    root = np.linalg.cholesky(Phi @ block[:2, 2:]) * 1e-8
    x, seen = np.sqrt(D / kappa) * rng.normal(), np.empty(FRAMES)
    for i, normal in enumerate(rng.normal(size=(FRAMES, 2))):
        x, seen[i] = Phi @ (x, 0.0) + root @ normal
    return seen + NOISE * rng.normal(size=FRAMES)


@pytest.fixture(scope="module")
def scene():
    return tweezer.load_scene("silica-1um").replace(
        beam={"power_through_pupil": "10 mW"},
        camera={"rate": RATE, "exposure": 1 / RATE, "noise": NOISE},
        simulation={"model": "overdamped"},
    )


@pytest.fixture(scope="module")
def recording(scene):
    trap = tweezer.characterise(scene)
    rng = np.random.default_rng(13)
    seen = [
        blurred(trap.equilibrium.stiffness[i][i], trap.drag[i], scene.medium.temperature, rng)
        for i in range(2)
    ]
    places = np.stack(seen, axis=1) + np.array(
        [3e-6, -2e-6]
    )  # the trap is not at the camera's origin
    return Recording(3.0 + np.arange(FRAMES) / RATE, places, ("x", "y"), name="drawn")


@pytest.fixture(scope="module")
def found(scene, recording):
    guess = scene.replace(bead={"diameter": "1.05 um"}, beam={"power_through_pupil": "13 mW"})
    return tweezer.fit(recording, guess, free=[DIAMETER, POWER])


def test_size_and_power_of_an_exact_record(found):
    """Within four standard uncertainties, false alarm 1e-4; the size of these is that of theory.

    Diffusion is told by 2 N steps to sqrt(2/(2 N)) or somewhat worse for a bead that is blurred.
    """
    assert found.statement == f"the recording determines {DIAMETER} and {POWER}"
    for key, true in ((DIAMETER, 1e-6), (POWER, 10e-3)):
        each = found[key]
        assert abs(each.value - true) < 4 * each.uncertainty
        low, high = each.interval
        assert low < each.value < high
        assert value_at(found.scene, key) == pytest.approx(each.value, rel=1e-12)
    finest = 1 / np.sqrt(FRAMES)
    assert finest < found[DIAMETER].uncertainty / found[DIAMETER].value < 4 * finest
    assert found.p_value > 1e-4


def test_likelihood_of_kalman_filter_falls_by_that_of_the_interval(scene, recording, found):
    """The decrease is 3.84/2, maximised over the other key, and exact for nonlinear forces."""
    seen = recording.positions - recording.positions.mean(axis=0)
    noise = np.array([NOISE, NOISE])

    def misfit(diameter, power):
        there = with_settings(scene, {DIAMETER: f"{diameter} m", POWER: f"{power} W"})
        rest = tweezer.characterise(there).equilibrium
        kT = BOLTZMANN * there.medium.temperature
        spread = np.sqrt(kT / np.diag(rest.stiffness))
        bead = Bead(diameter / 2, 1.0, kT, np.array(rest.position), spread, np.zeros(3), 0.0)
        camera = Camera(np.arange(FRAMES) / RATE, seen, noise, 0.0, 1 / RATE)
        move = bind_translation(bound_once(there), "overdamped")
        return -2 * kalman_filter(move)(bead, camera).log_likelihood

    least = misfit(found[DIAMETER].value, found[POWER].value)
    end = found[DIAMETER].interval[1]
    beside = minimize_scalar(
        lambda part: misfit(end, part * found[POWER].value) - least,
        bounds=(1.0, 1.25), method="bounded", options={"xatol": 5e-3},
    )  # fmt: skip
    assert beside.fun == pytest.approx(3.84, abs=0.3)


def test_whitened_likelihood_is_that_of_the_gaussian_process():
    """The likelihood of the drag, for 12 relaxation times with 100 samples each: the PSD leaks.

    The exact likelihood uses the increments, because the recording's mean differs from the trap's.
    """
    step, samples = 2e-5, 1200
    beads = [TrappedBead(5e-6, drag, 293.15) for drag in (0.9e-8, 1e-8, 1.1e-8)]
    covariances = [toeplitz(bead.autocovariance(step * np.arange(samples))) for bead in beads]
    x = np.linalg.cholesky(covariances[1]) @ np.random.default_rng(4).normal(size=samples)
    exact = [
        multivariate_normal.logpdf(1e9 * np.diff(x), cov=1e18 * np.diff(np.diff(each).T))
        for each in covariances
    ]
    whitened = Whitened.of("x", x, step)
    found = [-(whitened.deviances(bead) ** 2).sum() / 2 for bead in beads]
    raw = [Periodogram.of(x, step).log_likelihood(bead) for bead in beads]
    assert np.diff(found) == pytest.approx(np.diff(exact), abs=0.3)
    assert np.abs(np.diff(raw) - np.diff(exact)).max() > 1.0


@pytest.fixture(scope="module")
def remembering():
    """A scene as shipped, and samples every 10 us of a bead in a fluid with inertia."""
    scene = tweezer.load_scene("silica-1um").replace(beam={"power_through_pupil": "10 mW"})
    trap, bead, step = tweezer.characterise(scene), bead_properties(scene), 10e-6
    seen = []
    for i in range(3):
        of_bead = partial(
            detected_bead.density, k=trap.equilibrium.stiffness[i][i], drag=bead.drag,
            temperature=scene.medium.temperature, mass=bead.mass,
            displaced_mass=bead.displaced_mass,
        )  # fmt: skip
        seen.append(detected_bead.drawn(of_bead, step, 8000, seed=i)[0])
    return scene, Recording(
        step * np.arange(8000), np.stack(seen, axis=1), tuple("xyz"), name="drawn"
    )


def test_fit_of_fast_record_has_the_inertia_of_bead_and_fluid(remembering):
    """The error is below four standard uncertainties (false alarm 6e-5). Without inertia it is
    15 % in the diameter.
    """
    scene, recording = remembering
    guess = scene.replace(bead={"diameter": "1.05 um"})
    found = tweezer.fit(recording, guess, free=[DIAMETER])
    assert found.statement == f"the recording determines {DIAMETER}"
    assert "inertia of the bead and of the fluid" in found.likelihood
    assert "steps of 10 us" in found.likelihood
    assert abs(found[DIAMETER].value - 1e-6) < 4 * found[DIAMETER].uncertainty
    assert found[DIAMETER].uncertainty < 0.01e-6


def test_fit_without_inertia_of_a_record_that_has_it_is_refuted(remembering):
    scene, recording = remembering
    wrong = scene.replace(simulation={"model": "overdamped"})
    found = tweezer.fit(recording, wrong, free=[DIAMETER])
    assert "without inertia" in found.likelihood
    assert found.p_value < 0.01
    assert "the spectrum disagrees with the scene" in found.statement
    assert not found.determined


def test_inertia_is_that_of_the_scene_or_of_a_measured_bead():
    scene = tweezer.load_scene("silica-1um")
    run = scene.replace(simulation={"model": "overdamped"})
    none = scene.replace(medium={"inertia": "none"})
    added = scene.replace(medium={"inertia": "added-mass"})
    scaled = scene.replace(simulation={"model": "scaled", "scaling_factor": 0.01})
    bead = bead_properties(scene)
    for each, words, masses in (
        (scene, "with the inertia of the bead and of the fluid", (bead.mass, bead.displaced_mass)),
        (run, "without inertia", (None, None)),
        (none, "with the inertia of the bead", (bead.mass, None)),
        (added, "with the inertia of the bead and the added mass",
         (bead.mass + bead.displaced_mass / 2, None)),
        (scaled, "with the inertia of the bead", (100 * bead.mass, None)),
    ):  # fmt: skip
        inertia = Inertia.of(each)
        assert inertia.words == words
        assert inertia.masses(scene) == pytest.approx(masses)


def test_a_run_has_the_inertia_that_it_was_made_with(scene, recording):
    """Whatever the scene of the fit says: the shipped one names the model with inertia."""
    of_run = dataclasses.replace(recording, scene=scene)
    shipped = scene.replace(simulation={"model": "full"})
    assert Misfit([of_run], shipped, [POWER]).inertia == Inertia.of(scene)


def test_runs_of_different_inertia_are_not_fitted_together(scene, recording):
    one = dataclasses.replace(recording, scene=scene)
    other = dataclasses.replace(recording, scene=scene.replace(simulation={"model": "full"}))
    with pytest.raises(ResultError, match=r"differ in simulation\.model or medium\.inertia; fit"):
        tweezer.fit([one, other], scene, free=[POWER])


def test_recording_that_begins_outside_the_trap_is_refused_with_the_time_to_skip(remembering):
    scene, recording = remembering
    step, before = recording.step, 300
    falling = 2e-6 * np.exp(-np.arange(before) / 30)[:, None] * np.array([1.0, 0.0, 0.3])
    seen = np.vstack([falling + recording.positions[:before], recording.positions[before:]])
    begun = dataclasses.replace(recording, positions=seen)
    with pytest.raises(
        ResultError, match=r"drawn: x starts .* standard deviations from"
    ) as refused:
        tweezer.fit(begun, scene, free=[DIAMETER])
    time = str(refused.value).partition('--skip "')[2].partition('"')[0]
    later = begun.since(time)
    assert 15e-3 > later.times[0] > 100 * step
    found = tweezer.fit(later, scene, free=[DIAMETER])
    assert found.determined
    assert abs(found[DIAMETER].value - 1e-6) < 4 * found[DIAMETER].uncertainty


def test_mean_spring_of_a_cubic_force_is_the_closed_form():
    """K = k + 3 g kT/K in each direction, about a place with a constant force taken off."""
    kT, k, g = BOLTZMANN * 300.0, np.array([1e-6, 2e-6, 0.5e-6]), np.array([2e7, -3e7, 1e7])
    place = np.array([0.0, 0.0, 1e-7])

    def force(positions):
        off = positions - place
        return -k * off - g * off**3

    problem = SimpleNamespace(
        scene=SimpleNamespace(noise_temperature=300.0),
        light=SimpleNamespace(search=SimpleNamespace(reach=1e-5)),
        net_force_apart=force, mobilities=lambda positions: np.full((len(positions), 6), 1e8),
    )  # fmt: skip
    found = mean_spring(problem, SimpleNamespace(position=place, stiffness=np.diag(k)))
    expected = k / 2 + np.sqrt(k**2 / 4 + 3 * g * kT)
    assert found.stiffness == pytest.approx(expected, rel=1e-5)
    assert np.abs(expected / k - 1).min() > 0.05
    assert found.drag == pytest.approx(1e-8)
    gone = SimpleNamespace(position=place, stiffness=np.diag(k * 1e-6))
    assert mean_spring(problem, gone) is None


def test_the_lowest_of_several_minima_is_found():
    """For a 1.5 um bead seen every millisecond, 1.2 um with less power also fits, but worse."""
    scene = tweezer.load_scene("silica-1um").replace(
        bead={"diameter": "1.5 um", "refractive_index": 1.59, "density": 1050},
        beam={"power_through_pupil": "20 mW"}, simulation={"model": "overdamped"},
    )  # fmt: skip
    trap, step, rng = tweezer.characterise(scene), 1e-3, np.random.default_rng(1)
    seen = []
    for k, drag in zip(np.diag(trap.equilibrium.stiffness), trap.drag, strict=True):
        decay, x = math.exp(-step * k / drag), np.empty(4000)
        x[0] = rng.normal()
        for i, normal in enumerate(rng.normal(size=len(x) - 1)):
            x[i + 1] = decay * x[i] + math.sqrt(1 - decay**2) * normal
        seen.append(x * math.sqrt(BOLTZMANN * scene.medium.temperature / k))
    times = step * np.arange(len(x))
    drawn = Recording(times, np.stack(seen, axis=1), ("x", "y", "z"), name="drawn")
    guess = scene.replace(bead={"diameter": "1.575 um"}, beam={"power_through_pupil": "13 mW"})
    misfit = Misfit([drawn], guess, [DIAMETER, POWER])
    best = misfit.minima(lambda _: None)[0]
    there = np.array([key.place(value_at(scene, key.key)) for key in misfit.keys])
    assert best.value < (misfit(there) ** 2).sum()
    assert misfit.p_value(best.at) > 1e-3


def test_a_wrong_camera_is_noticed(scene, recording):
    """Frames of half the exposure would be noisier than these."""
    other = scene.replace(camera={"exposure": 0.0})
    found = tweezer.fit(recording, other, free=[POWER])
    assert "the spectrum disagrees with the scene" in found.statement
    assert not found.determined


def test_what_cannot_be_told_apart_is_named(scene, recording):
    """k/beta and k_B T/beta are two numbers: power, viscosity and temperature are three."""
    free = [POWER, "medium.viscosity", "medium.temperature"]
    found = tweezer.fit(recording, scene, free=free)
    assert found.statement.startswith("the recording does not determine ")
    assert all(key in found.statement for key in free)
    assert "10 % more" in found.statement
    assert "fits as well" in found.statement
    told = {each.key: each.determined for each in found.keys}
    assert not any(told.values())
    assert all(each.uncertainty is None for each in found.keys)


def test_command(scene, recording, command_line):
    """From a table in pixels, without times: the figure, and the numbers of the Python function."""
    np.savetxt("a.csv", recording.positions / 80e-9, delimiter=",", header="x,y", comments="")
    settings = [f"camera.rate={RATE}", f"camera.exposure={1 / RATE}", f"camera.noise={NOISE}"]
    arguments = [part for each in settings for part in ("--set", each)]
    done = command_line(
        "fit", "a.csv", "--rate", f"{RATE} Hz", "--scale", "80 nm", "--scene", "silica-1um",
        *arguments, "--set", "beam.power_through_pupil=9 mW", "--free", POWER,
        "--set", "simulation.model=overdamped", "--out", "fit.json", "--plot", "fit.png",
    )  # fmt: skip
    assert done.code == 0, done.err
    (key,) = json.loads(Path("fit.json").read_text())["keys"]
    exact = tweezer.fit(recording, scene, free=[POWER])[POWER]
    assert key["value"] == pytest.approx(exact.value, rel=1e-3)
    assert f"the recording determines {POWER}" in done.out
    assert "mW" in done.out
    assert Path("fit.png").read_bytes().startswith(b"\x89PNG")


SPRING = """
from tweezer.forces import UserForce, kernel, number


@kernel
def pull(pose, data, wrench):
    for i in range(len(pose.position)):
        for k in range(3):
            wrench.force[i, k] -= number(data, 0) * pose.position[i, k]


spring = UserForce(pull, (2e-5,))
"""


def test_power_of_a_trap_beside_a_spring_of_known_stiffness(scene, tmp_path, command_line):
    """Within four standard uncertainties, false alarm 1e-4; without the spring it is too large."""
    trap = tweezer.characterise(scene)
    light, drag = trap.equilibrium.stiffness[0][0], trap.drag[0]
    rng = np.random.default_rng(17)
    seen = blurred(light + 2e-5, drag, scene.medium.temperature, rng)
    recording = Recording(np.arange(FRAMES) / RATE, seen[:, None], ("x",), name="two springs")
    (tmp_path / "handles.py").write_text(SPRING)
    own = f"{tmp_path / 'handles.py'}:spring"
    found = tweezer.fit(recording, scene, free=[POWER], forces=[own])
    assert abs(found[POWER].value - 10e-3) < 4 * found[POWER].uncertainty
    assert "with 1 force of your own" in found.likelihood
    alone = tweezer.fit(recording, scene, free=[POWER])[POWER]
    assert alone.value / 10e-3 == pytest.approx(1 + 2e-5 / light, rel=0.1)
    assert 1 + 2e-5 / light > 1.3
    np.savetxt("x.csv", recording.positions, header="x", comments="")
    settings = [f"camera.rate={RATE}", f"camera.exposure={1 / RATE}", f"camera.noise={NOISE}"]
    arguments = [part for each in settings for part in ("--set", each)]
    done = command_line(
        "fit", "x.csv", "--rate", f"{RATE} Hz", "--scene", "silica-1um", *arguments,
        "--set", "beam.power_through_pupil=10 mW", "--set", "simulation.model=overdamped",
        "--free", POWER, "--force", own, "--out", "own.json",
    )  # fmt: skip
    assert done.code == 0, done.err
    (key,) = json.loads(Path("own.json").read_text())["keys"]
    assert key["value"] == pytest.approx(found[POWER].value, rel=1e-6)


def test_exit_code_of_a_fit_that_determines_nothing_is_1(recording, command_line):
    np.savetxt("a.csv", recording.positions, delimiter=",", header="x [m],y [m]", comments="")
    done = command_line(
        "fit", "a.csv", "--rate", f"{RATE} Hz", "--scene", "silica-1um", "--free", POWER,
        "--out", "fit.json",
    )  # fmt: skip
    assert done.code == 1
    assert "the spectrum disagrees with the scene" in done.out
    assert not json.loads(Path("fit.json").read_text())["keys"][0]["determined"]


@pytest.mark.parametrize(
    ("changes", "free", "line"),
    [({}, [], "free: nothing to fit"),
     ({}, ["bead.size"], "bead.size: unknown key"),
     ({}, ["beam.polarisation"], "free = 'beam.polarisation': is not a quantity"),
     ({}, ["beam.power"], "free = 'beam.power': the scene has no initial value"),
     ({"camera": {"noise": 0}}, ["camera.noise"], "must have an initial value above 0"),
     ({}, [POWER, POWER], "given more than once"),
     ({"camera": {"rate": 1000}}, [POWER], "its camera has rate = 2000, but the scene or"),
     ({}, ["simulation.duration"], "does not affect a bead at rest"),
     ({}, ["bead.radius", DIAMETER], "bead.radius or diameter: give only one"),
     ({"beam": {"power_through_pupil": 1e-9}}, [POWER], "the scene has no stable trap"),
     ({"beam": {"motion": {"kind": "ramp", "velocity": [1e-6, 0, 0]}}}, [POWER],
      "forces that do not change in time")],
)  # fmt: skip
def test_refused(scene, recording, changes, free, line):
    with pytest.raises((SceneError, ResultError), match=line):
        tweezer.fit(recording, scene.replace(**changes), free=free)


def test_refused_recordings(scene, recording):
    with pytest.raises(ResultError, match="requires a scene"):
        tweezer.fit(recording, free=[POWER])
    volts = Recording(recording.times, recording.positions * 1e6, ("x", "y"), name="v", unit="V")
    with pytest.raises(ResultError, match="in volts"):
        tweezer.fit(volts, scene, free=[POWER])
    seen = np.column_stack([recording.positions, recording.positions[:, 0]])
    space = Recording(recording.times, seen, ("x", "y", "z"), name="s")
    with pytest.raises(ResultError, match=r"camera\.noise_along: missing"):
        tweezer.fit(space, scene, free=[POWER])


def test_a_limit_of_what_a_scene_may_have_is_no_end_of_an_interval(scene, recording):
    """The exposure, which is the whole time between frames, cannot be longer."""
    found = tweezer.fit(recording, scene, free=["camera.exposure"])["camera.exposure"]
    low, high = found.interval
    assert 0.9 / RATE < low < 1 / RATE
    assert (high, found.determined, found.uncertainty) == (None, False, None)


def test_a_guess_too_far_off_is_not_the_fault_of_the_record(scene, recording):
    found = tweezer.fit(
        recording, scene.replace(beam={"power_through_pupil": "80 mW"}), free=[POWER]
    )
    assert f"{POWER} reached the end of its range; start with" in found.statement
    assert "determine" not in found.statement


def test_cameras_of_several_records_must_agree(scene, recording):
    dark = tweezer.load_scene("silica-1um").replace(beam={"power_through_pupil": "10 mW"})
    sharp = dataclasses.replace(recording, exposure=0.0, noise=(NOISE, NOISE))
    with pytest.raises(ResultError, match="its camera has exposure = 0, but the scene or another"):
        tweezer.fit([dataclasses.replace(sharp, exposure=1 / RATE), sharp], dark, free=[POWER])


def test_places_of_keys(scene):
    """Logarithms, or radii where a key may be negative; the index of a bead is a number too."""
    beside = FreeKey(scene.replace(wall={"position": "-2 um"}), "wall.position")
    assert beside.setting(np.float64(0.5)) == "-1.75e-06 m"
    assert beside.place(-1.5e-6) == pytest.approx(1.0)
    assert beside.bounds == pytest.approx((-5.0, 5.0))
    index = FreeKey(scene, "bead.refractive_index")
    assert float(index.setting(np.log(1.02))) == pytest.approx(1.45 * 1.02)
    with_settings(scene, {"bead.refractive_index": index.setting(0.01)})


def test_usual_units():
    assert usual_unit(1e-6, "m") == (1e-6, "um")
    assert usual_unit(-250e-9, "m") == (1e-9, "nm")
    assert usual_unit(0.0, "W") == (1e-6, "uW")
    assert usual_unit(1.4, "") == (1.0, "")
