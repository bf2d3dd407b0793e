"""Loss of beads within a step: against closed forms of first passages, at steps that are long.

Seeds are fixed; the bounds are those that a right program would exceed for one seed in 100,000.
"""

import math
import re

import numpy as np
import pytest
from scipy import stats
from scipy.linalg import expm

import tweezer
from tests.dynamics.test_brownian import DIFFUSION, DRAG, TAU, bound
from tests.forces.test_named import SPRING, STIFFNESS
from tweezer.dynamics.brownian.crossing import share
from tweezer.fluid import Modes

#: p-value below which a law is refused
RARE = 1e-5
#: Radius of the sphere, m
REACH = 3e-7


def losses(one, n):
    """When n beads are lost, s; infinite for those that are not."""
    beads = np.arange(n)
    states = one.start(beads)
    one.advance(states, beads, 0, np.empty((n, len(one.times) - 1, len(one.columns))))
    return states[:, -1]


def sphere_left_by(t, start):
    """Probability that a free bead has left the sphere by t, from `start` of its radius."""
    n = np.arange(1, 400)[:, None]
    decay = np.exp(-((n * math.pi / REACH) ** 2) * DIFFUSION * t)
    terms = -((-1.0) ** n) / n * np.sin(n * math.pi * start) * decay
    return 1 - 2 / (math.pi * start) * terms.sum(axis=0)


@pytest.mark.parametrize("model", ["overdamped", "full"])
@pytest.mark.parametrize("start", [0.1, 0.8])
@pytest.mark.parametrize("part", [0.1, 0.25])
def test_a_free_bead_leaves_a_sphere_when_it_should(model, start, part):
    """At steps of a tenth and a quarter of the radius, of which samples show every third."""
    step = (part * REACH) ** 2 / (2 * DIFFUSION)
    most = math.ceil(2 * REACH**2 / DIFFUSION / step / 3) + 1
    one = bound(
        model, "heun", step, samples=most, per_sample=3,
        start={"position": [0, start * REACH, 0]}, simulation={"loss_distance": REACH},
    )  # fmt: skip
    lost = losses(one, 4000)
    assert np.isfinite(lost).all()
    assert stats.kstest(lost, lambda t: sphere_left_by(t, start)).pvalue > RARE


def test_a_falling_bead_reaches_a_plane_when_it_should():
    """The lens below it, by its weight: the inverse Gaussian law."""
    away = 2e-7
    scene = {"forces": {"gravity": True, "buoyancy": True}, "lens": {"focal_length": "10 um"}}
    step = (0.3 * away) ** 2 / (2 * DIFFUSION)
    one = bound(
        "overdamped", "heun", step, samples=400,
        start={"frame": "focus", "position": [0, 0, 5e-7 - 10e-6 + away]}, **scene,
    )  # fmt: skip
    speed = -one.problem.bead.weight[2] / DRAG
    assert speed * away / DIFFUSION > 0.1
    lost = losses(one, 4000)
    lost[np.isinf(lost)] = one.times[-1] * 2

    def reached(t):
        root = np.sqrt(2 * DIFFUSION * t)
        ahead = math.exp(speed * away / DIFFUSION) * stats.norm.cdf(-(away + speed * t) / root)
        return np.where(t > one.times[-1], 1.0, stats.norm.cdf((speed * t - away) / root) + ahead)

    part = float(reached(np.array([one.times[-1]]))[0])
    found = lost[lost < one.times[-1] * 1.5]
    assert abs(len(found) - 4000 * part) < 5 * math.sqrt(4000 * part * (1 - part))
    assert stats.kstest(found, lambda t: reached(t) / part).pvalue > RARE


def test_a_thrown_bead_is_lost_between_the_ends_of_a_step():
    """Thrown at 2 m/s, it is lost where it passes, as steps are short over its relaxation time."""
    step = TAU / 5
    one = bound(
        "full", "heun", step, samples=11,
        start={"velocity": [2.0, 0, 0]}, simulation={"loss_distance": 1.1e-7},
    )  # fmt: skip
    lost = losses(one, 100)
    passed = -TAU * math.log(1 - 1.1e-7 / (2.0 * TAU))
    assert 0.2 < passed / step % 1 < 0.8
    assert abs(np.median(lost) - passed) < 0.1 * step
    assert np.ptp(lost) < step


@pytest.mark.parametrize("step", [1e-3, 0.3, 1.0, 20.0, 1e4])
def test_variance_in_the_middle_of_a_step_for_given_velocities(step):
    """The oracle is Van Loan's matrix exponential, with the limits (step/tau)^2/48 and
    1 - 4 tau/step.
    """

    def noise_of(h):
        A = np.array([[0.0, 1.0], [0.0, -1.0]])
        block = expm(h * np.block([[-A, np.diag([0.0, 2.0])], [np.zeros((2, 2)), A.T]]))
        return block[2:, 2:].T, block[2:, 2:].T @ block[:2, 2:]

    found = share(step, Modes(np.ones(1), np.ones(1)))
    if step < 100:
        E, Q = noise_of(step / 2)
        both = E @ Q @ E.T + Q
        middle = Q - Q @ E.T @ np.linalg.solve(both, E @ Q)
        expected = middle[0, 0] / (step / 2)
        assert found == pytest.approx(expected, rel=1e-9 if step > 0.1 else 1e-3)
    if step < 0.01:
        assert found == pytest.approx(step**2 / 48, rel=0.01)
    if step > 100:
        assert found == pytest.approx(1 - 4 / step, abs=1e-6)


def test_beads_are_lost_alike_however_the_work_is_cut():
    """Beads together or one by one, and samples at once or in pieces."""
    step = (0.2 * REACH) ** 2 / (2 * DIFFUSION)
    one = bound("overdamped", "heun", step, samples=9, per_sample=1,
                simulation={"loss_distance": REACH})  # fmt: skip
    whole = losses(one, 150)
    assert 20 < np.isfinite(whole).sum() < 150
    assert (whole[np.isfinite(whole)] / step % 1 > 0).mean() > 0.5
    for bead in (3, 77, 149):
        beads = np.array([bead])
        states = one.start(beads)
        for first, last in ((0, 1), (1, 4), (4, 8)):
            one.advance(states, beads, first, np.empty((1, last - first, 3)))
        assert states[0, -1] == whole[bead]


def test_losses_by_one_call_are_as_late_as_the_result_says():
    """In a spring that ends 4.5 kT up, against Heun's method, to 3 standard errors."""
    stiffness, depth = STIFFNESS, 4.5
    scene = tweezer.load_scene("silica-1um").replace(
        forces={"brownian": True, "optical": False, "gravity": False, "buoyancy": False},
        medium={"inertia": "none"},
        start={"position": [0, 0, 0]},
    )
    kT = 1.380649e-23 * scene.medium.temperature
    tau = 6 * math.pi * scene.medium.viscosity * scene.bead.radius / stiffness
    found = {}
    for method, step in (("heun", 0.2), ("one-call", 0.2)):
        changed = scene.replace(simulation={
            "model": "overdamped", "method": method, "step": step * tau, "samples": 3,
            "loss_distance": math.sqrt(2 * depth * kT / stiffness), "duration": 200 * tau,
        })  # fmt: skip
        found[method] = tweezer.ensemble(changed, 2000, seed=1, forces=[SPRING])
    means = {name: float(each["lost_time"].mean()) for name, each in found.items()}
    assert "loss_caveat" not in found["heun"].attrs
    told = re.search(r"about (\S+) % for each kT", found["one-call"].attrs["loss_caveat"])
    late = float(told[1]) / 100 * depth
    ratio, error = means["one-call"] / means["heun"], math.sqrt(2 / 2000)
    assert 1 + late / 2 - 3 * error < ratio < 1 + 2 * late + 3 * error
    assert ratio > 1 + 3 * error
