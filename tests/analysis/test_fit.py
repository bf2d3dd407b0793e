"""Keys of a scene from recordings: against exact records of a linear trap, and what is refused."""

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import minimize_scalar

import tweezer
from tests.reference.trapped_bead import BOLTZMANN
from tweezer.analysis import Recording
from tweezer.analysis.scene_misfit import Difference, FreeKey, Misfit
from tweezer.errors import ResultError, SceneError
from tweezer.scene import value_at, with_settings
from tweezer.units import usual_unit

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
    return Recording("drawn", 3.0 + np.arange(FRAMES) / RATE, places, ("x", "y"))


@pytest.fixture(scope="module")
def found(scene, recording):
    guess = scene.replace(bead={"diameter": "1.05 um"}, beam={"power_through_pupil": "13 mW"})
    return tweezer.fit(recording, guess, free=[DIAMETER, POWER])


def test_size_and_power_of_an_exact_record(found):
    """Within four standard uncertainties, false alarm 1e-4; the size of these is that of theory.

    Diffusion is told by 2 N steps to sqrt(2/(2 N)) or somewhat worse for a bead that is blurred.
    """
    assert found.statement == f"the record determines {DIAMETER} and {POWER}"
    for key, true in ((DIAMETER, 1e-6), (POWER, 10e-3)):
        each = found[key]
        assert abs(each.value - true) < 4 * each.uncertainty
        low, high = each.interval
        assert low < each.value < high
        assert value_at(found.scene, key) == pytest.approx(each.value, rel=1e-12)
    finest = 1 / np.sqrt(FRAMES)
    assert finest < found[DIAMETER].uncertainty / found[DIAMETER].value < 4 * finest
    assert found.p_value > 1e-4


def test_the_misfit_of_the_filter_rises_by_that_of_the_interval(scene, recording, found):
    """3.84 at an end, at the least over the other key, sought on the filter alone."""
    misfit = Misfit([recording], scene, [DIAMETER, POWER])
    end = misfit.keys[0].place(found[DIAMETER].interval[1])
    power = misfit.keys[1].place(found[POWER].value)

    def rise(aside):
        (path,) = misfit.filtered(np.array([end, power + aside]))
        return 2 * (found.log_likelihood - path.log_likelihood)

    least = minimize_scalar(rise, bounds=(0.0, 0.25), method="bounded", options={"xatol": 3e-3})
    assert least.fun == pytest.approx(3.84, abs=0.15)


def test_a_wrong_camera_is_noticed(scene, recording):
    """Frames of half the exposure would be noisier than these."""
    other = scene.replace(camera={"exposure": 0.0})
    found = tweezer.fit(recording, other, free=[POWER])
    assert "the residuals are not those of the scene" in found.statement


def test_what_cannot_be_told_apart_is_named(scene, recording):
    """k/beta and k_B T/beta are two numbers: power, viscosity and temperature are three."""
    free = [POWER, "medium.viscosity", "medium.temperature"]
    found = tweezer.fit(recording, scene, free=free)
    assert found.statement.startswith("the record does not determine ")
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
        "--out", "fit.json", "--plot", "fit.png",
    )  # fmt: skip
    assert done.code == 0, done.err
    (key,) = json.loads(Path("fit.json").read_text())["keys"]
    exact = tweezer.fit(recording, scene, free=[POWER])[POWER]
    assert key["value"] == pytest.approx(exact.value, rel=1e-3)
    assert f"the record determines {POWER}" in done.out
    assert "mW" in done.out
    assert Path("fit.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("changes", "free", "line"),
    [({}, [], "free: nothing to fit"),
     ({}, ["bead.size"], "bead.size: unknown key"),
     ({}, ["beam.polarisation"], "free = 'beam.polarisation': is not a quantity"),
     ({}, ["beam.power"], "free = 'beam.power': the scene has no value of it"),
     ({"camera": {"noise": 0}}, ["camera.noise"], "must have a first guess above 0"),
     ({}, [POWER, POWER], "given more than once"),
     ({"camera": {"rate": 1000}}, [POWER], "its camera has rate = 2000, and the scene, or"),
     ({}, ["simulation.duration"], "tells nothing of a bead at rest"),
     ({}, ["bead.radius", DIAMETER], "bead.radius or diameter: not both"),
     ({"beam": {"power_through_pupil": 1e-9}}, [POWER], "the light holds no bead"),
     ({"beam": {"motion": {"kind": "ramp", "velocity": [1e-6, 0, 0]}}}, [POWER],
      "whose forces do not change in time")],
)  # fmt: skip
def test_refused(scene, recording, changes, free, line):
    with pytest.raises((SceneError, ResultError), match=line):
        tweezer.fit(recording, scene.replace(**changes), free=free)


def test_refused_recordings(scene, recording):
    with pytest.raises(ResultError, match="needs a scene"):
        tweezer.fit(recording, free=[POWER])
    volts = Recording("v", recording.times, recording.positions * 1e6, ("x", "y"), unit="V")
    with pytest.raises(ResultError, match="in volts"):
        tweezer.fit(volts, scene, free=[POWER])
    seen = np.column_stack([recording.positions, recording.positions[:, 0]])
    space = Recording("s", recording.times, seen, ("x", "y", "z"))
    with pytest.raises(ResultError, match=r"camera\.noise_along: missing"):
        tweezer.fit(space, scene, free=[POWER])


def test_the_difference_of_two_misfits_is_a_parabola_along_each_direction():
    directions = np.array([[0.3, 0.1], [-0.1, 0.3]])
    centre, bounds = np.array([1.0, 2.0]), np.array([[-5.0, 5.0], [-5.0, 2.2]])

    def parabola(q):
        t = (q - centre) @ np.linalg.inv(directions)
        return 2 * t[0] - t[1] + 3 * t[0] ** 2 + t[1] ** 2

    found = Difference(lambda q: 7 + parabola(q), centre, directions, bounds)
    for place in ([1.0, 2.0], [1.2, 2.1], [0.9, 1.8]):
        assert found(np.array(place)) == pytest.approx(parabola(np.array(place)))


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
    assert f"{POWER} at an end of what was tried: begin nearer" in found.statement
    assert "determine" not in found.statement


def test_cameras_of_several_records_must_agree(scene, recording):
    dark = tweezer.load_scene("silica-1um").replace(beam={"power_through_pupil": "10 mW"})
    sharp = dataclasses.replace(recording, exposure=0.0, noise=(NOISE, NOISE))
    with pytest.raises(ResultError, match="its camera has exposure = 0, and the scene, or another"):
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
