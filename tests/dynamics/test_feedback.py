"""Controllers that measure a bead and act on it, against linear theory and closed forms.

Variances of n independent beads have a standard error of sqrt(2/n). The bounds are 4.5 of them,
which a right program exceeds once in 150,000 comparisons.
"""

import math

import numpy as np
import pytest
from scipy.constants import Boltzmann
from scipy.linalg import expm, solve_discrete_lyapunov
from scipy.special import erfcx

import tweezer
from tests.dynamics.test_brownian import BEAD, DARK, KT, STIFFNESS
from tweezer.dynamics import bound_once
from tweezer.dynamics.problem import Problem
from tweezer.dynamics.walk import walk
from tweezer.forces.composed import Sum
from tweezer.forces.driven import DrivenLight
from tweezer.forces.spring import Elastic

MASS = BEAD.mass
#: Angular frequency of the bead in its spring, rad/s
SWING = math.sqrt(STIFFNESS / MASS)
COPIES = 4000
#: What each kind of controller changes
OUTPUTS = {"clamp": "position", "parametric": "power", "pid": "force"}
#: Relative bound of a variance of that many beads
BOUND = 4.5 * math.sqrt(2 / COPIES)


def held(quality, feedback, *, model="full", time=1.0, samples=2, **simulation):
    """Return beads in a spring of a quality factor with a controller, at `time` in ticks."""
    viscosity = DARK.medium.viscosity * MASS * SWING / BEAD.drag / quality
    rate = feedback["rate"]
    scene = DARK.replace(
        medium={"viscosity": viscosity}, feedback=feedback,
        simulation={"model": model, "duration": time / rate, "samples": samples} | simulation,
    )  # fmt: skip
    return walk(bound_once(scene, [Elastic(STIFFNESS, (0.0, 0.0, 0.0))]))


def ends(bound, copies=COPIES, first=0):
    """Return the states at the end of copies of a walk."""
    who = np.arange(first, first + copies)
    states, out = bound.start(who), np.empty((copies, len(bound.times) - 1, bound.shown.width))
    bound.advance(states, who, 0, out)
    return states


def sampled(quality, rate, F, G, H, J, late, noise, swing=SWING):
    """Return the covariance of (x, v, c, queue, force) after a tick of a linear controller.

    The motion between ticks is exact, with the noise by a matrix exponential (Van Loan 1978).
    """
    rate = rate / swing  # in units of m, sqrt(m/k) and kT
    A, B, T = np.array([[0, 1], [-1, -1 / quality]]), np.array([[0], [1]]), 1 / rate
    step = expm(np.block([[A, B], [np.zeros((1, 3))]]) * T)
    Ad, Bd = step[:2, :2], step[:2, 2:]
    Q = np.diag([0, 2 / quality])
    loan = expm(np.block([[-A, Q], [np.zeros((2, 2)), A.T]]) * T)
    spread = loan[2:, 2:].T @ loan[:2, 2:]
    n = len(G)
    size = 2 + n + late + 1  # the last one acts
    M, R = np.zeros((size, size)), np.zeros((size, size))
    M[:2, :2], M[:2, -1:] = Ad, Bd
    R[:2, :2] = spread
    y = M[0].copy()  # of the new position
    M[2 : 2 + n] = np.outer(G, y)
    M[2 : 2 + n, 2 : 2 + n] += F
    u = J * y + H @ M[2 : 2 + n]
    # noise of the new position goes into c and u
    into = np.zeros((size, size))
    into[:2, :2] = np.eye(2)
    into[2 : 2 + n, 0] = G
    own = np.zeros(size)
    own[2 : 2 + n] = G
    if late:
        M[-1] = 0
        M[-1, 2 + n] = 1
        for j in range(late - 1):
            M[2 + n + j, 2 + n + j + 1] = 1
        M[2 + n + late - 1] = u
        out = 2 + n + late - 1
    else:
        M[-1] = u
        out = size - 1
    into[out, 0] = J + H @ G
    own[out] = J + H @ G
    noisy = into @ R @ into.T + noise * rate * np.outer(own, own)
    return solve_discrete_lyapunov(M, noisy)


@pytest.mark.parametrize(
    ("quality", "damping", "ticks", "late", "noise"),
    [
        (5.0, 0.3, 60, 0, 0.0),
        (5.0, 0.3, 12, 1, 0.0),
        (20.0, 0.2, 25, 3, 0.0),
        (5.0, 0.5, 20, 0, 1e-26),
    ],
)
def test_cold_damping_has_the_moments_of_the_sampled_loop(quality, damping, ticks, late, noise):
    """`ticks` per period 2 pi/SWING; `damping` in units of SWING."""
    rate = ticks * SWING / (2 * math.pi)
    gain = damping * SWING
    settled = math.ceil(12 * ticks / (2 * math.pi) / (damping / 2 + 0.5 / quality))
    bound = held(
        quality,
        {"kind": "cold", "rate": rate, "gain": gain, "delay": late / rate, "noise": noise},
        time=settled,
    )
    found = ends(bound)
    size = damping * rate / SWING
    F, G, H = np.array([[0, 0], [1, 0]]), np.array([1, 0]), np.array([-size, size])
    expected = sampled(quality, rate, F, G, H, 0.0, late, noise * SWING * STIFFNESS / KT)
    x, v = found[:, bound.layout.first("position")], found[:, bound.layout.first("velocity")]
    force = found[:, bound.layout.first(bound.scene.feedback.output)]
    assert x.var() * STIFFNESS / KT == pytest.approx(expected[0, 0], rel=BOUND)
    assert v.var() * MASS / KT == pytest.approx(expected[1, 1], rel=BOUND)
    assert force.var() / (KT * STIFFNESS) == pytest.approx(expected[-1, -1], rel=BOUND)
    # the two other axes are free of the controller
    free = found[:, bound.layout.first("position") + 1]
    assert free.var() == pytest.approx(KT / STIFFNESS, rel=BOUND)


def driven_light(monkeypatch, power, *others):
    """Replace the force of a scene's light by a spring that a controller drives."""
    light = DrivenLight(Elastic(STIFFNESS, (0.0, 0.0, 0.0)), power)
    force = Sum((light, *others)) if others else light
    monkeypatch.setattr(Problem, "force", property(lambda _: force))
    return DARK.replace(forces={"optical": True})


def test_a_delayed_force_has_the_variance_of_the_delay_equation():
    """x' = -a x - b x(t - T) + noise (Kuechler and Mensch 1992), b > a; the hold counts as 1/2."""
    ticks, ahead = 40, 1.2  # of a delay T; b T
    a = STIFFNESS / BEAD.drag
    b = 2 * a
    delay = ahead / b
    rate = (ticks + 0.5) / delay
    feedback = {
        "kind": "pid", "measures": ["x", "y", "z"], "rate": rate, "delay": ticks / rate,
        "gains": [b * BEAD.drag, 0, 0],
    }  # fmt: skip
    scene = DARK.replace(
        feedback=feedback, simulation={"model": "overdamped", "duration": 1600 / rate, "samples": 2}
    )
    bound = walk(bound_once(scene, [Elastic(STIFFNESS, (0.0, 0.0, 0.0))]))
    found = ends(bound)[:, bound.layout.at("position")]
    w = math.sqrt(b * b - a * a)
    D = KT / BEAD.drag
    expected = D * (1 + b / w * math.sin(w * delay)) / (a + b * math.cos(w * delay))
    assert (found**2).mean() == pytest.approx(expected, rel=BOUND / math.sqrt(3))


def test_a_force_clamp_keeps_the_force_on_a_tether(monkeypatch):
    """X' = I (x - X - d): mean force k d, variance k^2 D/(I + (k + k_t)/beta)."""
    tether, drag = 0.5 * STIFFNESS, BEAD.drag
    target, clamp = 30e-9, 0.3 * STIFFNESS / drag
    rate = 100 * clamp
    scene = driven_light(monkeypatch, False, Elastic(tether, (0.0, 0.0, 0.0))).replace(
        feedback={"kind": "clamp", "rate": rate, "gain": clamp, "target": target},
        simulation={"model": "overdamped", "duration": 25 / clamp, "samples": 2},
    )
    bound = walk(bound_once(scene))
    found = ends(bound)
    force = STIFFNESS * (found[:, bound.layout.first(bound.scene.feedback.output)] - found[:, 0])
    variance = STIFFNESS**2 * KT / drag / (clamp + (STIFFNESS + tether) / drag)
    assert force.var() == pytest.approx(variance, rel=BOUND + 0.01)  # ticks of 1/100
    assert force.mean() == pytest.approx(
        -STIFFNESS * target, abs=4.5 * math.sqrt(variance / COPIES)
    )


def test_parametric_cooling_has_the_energy_of_the_published_distribution(monkeypatch):
    """p(E) ~ exp(-E/kT - c (E/kT)^2), c = e kT/(4 m W G) (Gieseler 2015)."""
    quality, c = 30.0, 0.5
    gain = 4 * c * STIFFNESS / KT / quality  # e/W = 4 c m G/kT
    scene = driven_light(monkeypatch, True)
    viscosity = DARK.medium.viscosity * MASS * SWING / BEAD.drag / quality
    rate = 120 * SWING / (2 * math.pi)
    scene = scene.replace(
        medium={"viscosity": viscosity},
        feedback={"kind": "parametric", "rate": rate, "gain": gain / SWING},
        simulation={"model": "full", "duration": 120 * 25 / rate, "samples": 2},
    )
    bound = walk(bound_once(scene))
    found = ends(bound)
    x, v = found[:, 0], found[:, bound.layout.first("velocity")]
    energy = (0.5 * STIFFNESS * x**2 + 0.5 * MASS * v**2) / KT
    Z = math.sqrt(math.pi / (4 * c)) * erfcx(1 / (2 * math.sqrt(c)))
    mean = (1 - Z) / (2 * c * Z)
    square = (1 - mean) / (2 * c)  # from the derivative of the distribution
    spread = math.sqrt((square - mean**2) / COPIES)
    assert energy.mean() == pytest.approx(mean, abs=4.5 * spread)


def test_bits_do_not_depend_on_pieces_and_groups():
    feedback = {"kind": "cold", "rate": 3e5, "gain": 1e5, "delay": 1e-5, "noise": 1e-26}
    bound = held(5.0, feedback, time=300, samples=101)
    who = np.arange(6)
    whole, out = bound.start(who), np.empty((6, 100, bound.shown.width))
    bound.advance(whole, who, 0, out)
    pieces = np.empty_like(out)
    for group in (who[:1], who[1:]):
        states = bound.start(group)
        for begin, end in ((0, 7), (7, 62), (62, 100)):
            piece = np.empty((len(group), end - begin, bound.shown.width))
            bound.advance(states, group, begin, piece)
            pieces[group, begin:end] = piece
        np.testing.assert_array_equal(states, whole[group])
    np.testing.assert_array_equal(pieces, out)


@pytest.mark.parametrize("late", [0, 2])
def test_moments_of_a_scene_are_those_of_the_sampled_loop(late):
    scene = tweezer.load_scene("silica-1um").replace(
        forces={"brownian": True}, medium={"inertia": "none"}, simulation={"model": "full"},
        beam={"polarisation": "linear"},  # circular light also drives the axes by each other
    )  # fmt: skip
    stiffness = np.diag(tweezer.characterise(scene).stiffness)
    mass = tweezer.bead_properties(scene).mass
    swing = math.sqrt(stiffness[0] / mass)
    quality = mass * swing / tweezer.bead_properties(scene).drag
    rate, damping, noise = 8 * swing, 0.2, 1e-27
    feedback = {
        "kind": "cold", "rate": rate, "gain": damping * swing, "delay": late / rate, "noise": noise,
    }  # fmt: skip
    found = tweezer.loop_moments(scene.replace(
        feedback=feedback,
        simulation={"duration": 800 / rate, "samples": 101},
    ))  # fmt: skip
    size = damping * rate / swing
    F, G, H = np.array([[0, 0], [1, 0]]), np.array([1, 0]), np.array([-size, size])
    kT = Boltzmann * scene.medium.temperature
    expected = sampled(
        quality, rate, F, G, H, 0.0, late, noise * swing * stiffness[0] / kT, swing=swing
    )
    assert found.position_variance[0] == pytest.approx(kT / stiffness[0] * expected[0, 0], rel=1e-6)
    assert found.velocity_variance[0] == pytest.approx(kT / mass * expected[1, 1], rel=1e-6)
    force = kT * stiffness[0] * expected[-1, -1]
    assert found.output_variance[0] == pytest.approx(force, rel=1e-6)
    assert found.temperature[1] == pytest.approx(scene.medium.temperature, rel=1e-6)
    # the spectrum adds up to the variance
    even = (np.arange(4000) + 0.5) * rate / 8000
    spectrum = tweezer.loop_moments(
        scene.replace(feedback=feedback, simulation={"duration": 800 / rate, "samples": 101}), even
    ).position_spectrum[0]
    variance = float(found.position_variance[0])
    assert float(spectrum.sum()) * rate / 8000 == pytest.approx(variance, rel=1e-3)


def test_a_run_contains_the_output_and_can_be_continued(tmp_path):
    scene = tweezer.load_scene("silica-1um").replace(
        forces={"brownian": True}, medium={"inertia": "none"},
        simulation={"model": "full", "duration": "0.2 ms", "samples": 201},
        feedback={"kind": "pid", "rate": 1e6, "gains": [1e-4, 1e-2, 0], "delay": 2e-6},
    )  # fmt: skip
    whole = tweezer.simulate(scene, seed=3)
    force, x = whole.feedback_force.values[:, 0], whole.position.values[:, 0]
    assert not force[:3].any()
    total = np.cumsum(x[1:]) * 1e-6
    np.testing.assert_allclose(force[3:], -(1e-4 * x[1:-2] + 1e-2 * total[:-2]), rtol=1e-9)
    assert not whole.feedback_force.values[:, 1:].any()
    assert whole.feedback_force.attrs["units"] == "N"
    short = scene.replace(simulation={"duration": "0.1 ms", "samples": 101})
    rest = tweezer.simulate(short, continue_from=tweezer.simulate(short, seed=3))
    np.testing.assert_array_equal(rest.position[-1], whole.position[-1])
    tweezer.save(whole, tmp_path / "run.nc")
    assert tweezer.load(tmp_path / "run.nc").feedback_force.equals(whole.feedback_force)


@pytest.mark.parametrize(
    "controller",
    [
        {"kind": "clamp", "gain": 1e4, "target": "20 nm"},
        {"kind": "parametric", "gain": 3e9},
        {"kind": "pid", "gains": [1e-4, 0, 0]},
    ],
    ids=lambda controller: controller["kind"],
)
def test_forces_of_a_run_include_the_controller(controller):
    scene = tweezer.load_scene("silica-1um").replace(
        forces={"brownian": True}, medium={"inertia": "none"}, start={"position": [1e-7, 0, 0]},
        simulation={"model": "full", "duration": "0.1 ms", "samples": 101},
    )  # fmt: skip
    run = tweezer.simulate(scene.replace(feedback=controller | {"rate": 1e6}), seed=2)
    place, output = (
        run.position.values.copy(),
        run[f"feedback_{OUTPUTS[controller['kind']]}"].values,
    )
    assert np.abs(output[50:, 0]).min() > 0
    strength, push = np.ones(101), np.zeros((101, 3))
    match controller["kind"]:
        case "clamp":
            place -= output
        case "parametric":
            strength = np.maximum(1 + output.sum(axis=1), 0)  # no light is the least
            assert np.ptp(strength) > 0.02
        case _:
            push = output
    light = strength[:, None] * tweezer.optical_force(scene, place)
    np.testing.assert_allclose(run.optical_force, light, rtol=1e-6, atol=1e-18)
    weight = tweezer.bead_properties(scene).weight
    np.testing.assert_allclose(run.net_force, light + push + weight, rtol=1e-6, atol=1e-18)
    assert run.force_error.max() < 1e-3 * np.abs(light).max()


def test_a_controller_may_have_no_state():
    scene = tweezer.load_scene("silica-1um").replace(
        forces={"brownian": True}, medium={"inertia": "none"},
        simulation={"model": "full", "duration": "0.1 ms", "samples": 101},
    )  # fmt: skip
    given = {"rate": 1e6, "kind": "matrices", "F": [], "G": [], "H": [], "J": -1e-4}
    same = {"rate": 1e6, "kind": "pid", "gains": [1e-4, 0, 0]}
    one, other = (tweezer.simulate(scene.replace(feedback=each), seed=1) for each in (given, same))
    np.testing.assert_allclose(one.position, other.position, rtol=1e-12, atol=1e-20)
    one, other = (tweezer.loop_moments(scene.replace(feedback=each)) for each in (given, same))
    np.testing.assert_allclose(one.position_variance, other.position_variance, rtol=1e-9)


def test_an_unstable_loop_and_other_impossible_controllers_are_refused():
    scene = tweezer.load_scene("silica-1um").replace(
        forces={"brownian": True}, medium={"inertia": "none"},
        simulation={"duration": "1 ms", "samples": 101},
    )  # fmt: skip
    cold = {"kind": "cold", "rate": 1e5, "gain": 1e5}
    with pytest.raises(tweezer.SceneError, match="not stable; a disturbance is multiplied"):
        tweezer.loop_moments(scene.replace(feedback=cold | {"gain": -1e8}))
    for changed, message in (
        ({"gain": None}, "gain: is missing"),
        ({"gains": [1, 2, 3]}, "gains: does not apply"),
        ({"delay": 1.5e-5}, r"1\.5 ticks"),
        ({"rate": 1.3e5}, r"1\.3 ticks from sample to sample"),
        ({"drives": "beam.power"}, "must be 'force'"),
        ({"measures": ["x", "x"]}, "one to three axes once"),
        ({"kind": "matrices", "gain": None, "F": [[1, 2]], "G": [1], "H": [1], "J": 0}, "n x n"),
    ):
        given = {key: value for key, value in (cold | changed).items() if value is not None}
        with pytest.raises(tweezer.SceneError, match=message):
            scene.replace(feedback=given)
    with pytest.raises(tweezer.SceneError, match=r"requires forces\.brownian"):
        scene.replace(feedback=cold, forces={"brownian": False})
