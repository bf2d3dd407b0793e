"""Thermal motion beside a wall against Boltzmann, first passage, mobilities and closed forms.

Seeds are fixed. A bound of `FAR` standard deviations is exceeded by a right program for one seed in
1.7 million; the standard deviations are over beads, which are independent.
"""

import dataclasses
import math

import numpy as np
import pytest
from scipy import stats
from scipy.integrate import quad, solve_ivp

import tweezer
from tests.reference.fields import LinearTrap
from tweezer.dynamics import bound_once
from tweezer.dynamics.brownian import plane, propagator, wall_with_inertia
from tweezer.dynamics.walk import walk
from tweezer.generated import wall
from tweezer.values.errors import IntegrationError, SceneError

#: five standard deviations
FAR = 5.0
#: Bead of 3 um across, m, of silica under its weight in the dark, above a wall at z = 0
RADIUS = 1.5e-6
SINKING = tweezer.load_scene("silica-1um").replace(
    bead={"radius": RADIUS}, forces={"brownian": True, "optical": False},
    medium={"inertia": "none"}, wall={"position": 0.0},
    start={"frame": "focus", "position": [0, 0, 1.02 * RADIUS]},
    simulation={"model": "overdamped", "loss_distance": 1.0},
)  # fmt: skip
KT = 1.380649e-23 * SINKING.medium.temperature
BEAD = tweezer.bead_properties(SINKING)
#: Mean gap in radii, and the time in which it is reached, s: D/a^2 = `RATE`
MEAN = KT / (-BEAD.weight[2] * RADIUS)
RATE = KT / BEAD.drag / RADIUS**2
RELAXATION = MEAN / RATE


def bound(step, steps, *, per_sample=1, method="heun", seed=1, scene=SINKING, **sections):
    """A walk of so many samples, with that step."""
    simulation = {
        "step": step * (1 + 1e-9), "samples": steps + 1, "duration": step * per_sample * steps,
        "method": method,
    } | sections.pop("simulation", {})  # fmt: skip
    return walk(scene.replace(simulation=simulation, **sections), seed)


def followed(walk, n, states=None, first=0):
    """Samples (n, samples, columns)."""
    who = np.arange(first, first + n)
    states = walk.start(who) if states is None else states.copy()
    out = np.empty((n, len(walk.times), len(walk.columns)))
    out[:, 0] = walk.seen(states)
    walk.advance(states, who, 0, out[:, 1:])
    return out


def at_gaps(walk, gaps):
    """States of beads at these gaps, in radii, above the wall of the scene."""
    states = walk.start(np.arange(len(gaps)))
    place = walk.scene.wall
    states[:, 2] = place.position + place.normal * walk.scene.bead.radius * (1 + gaps)
    return states


def gaps_of(walk, samples):
    """Gaps in radii."""
    return walk.scene.gap(samples[..., 2]) / walk.scene.bead.radius


def off(found, expected):
    """How many standard deviations the mean of beads is off; found: (beads, ...)."""
    of_each = found.reshape(len(found), -1).mean(axis=1)
    return (of_each.mean() - expected) / (of_each.std() / math.sqrt(len(of_each)))


# --- the plane -----------------------------------------------------------------------------------


@pytest.mark.parametrize("room", [math.inf, 18.0])
def test_the_plane_is_the_integral_over_the_mobility(room):
    """r by an adaptive quadrature; what is read by r^2 is what is read by the gap; 1e-9."""

    def mobility(g):
        one = wall.mobilities(g)[0]
        other = wall.mobilities(room - g)[0] if room < math.inf else 1.0
        return 1 / (1 / one + 1 / other - 1)

    between, of_gaps, of_squares = plane.tables(room)
    for g in (2e-5, 1e-3, 0.0173, 0.4, 3.1, 8.9):
        r = quad(lambda x: 2 * x / math.sqrt(2 * mobility(x * x)), 1e-12, math.sqrt(g),
                 epsrel=1e-11, limit=200, points=[math.sqrt(wall.CONTACT)])[0]  # fmt: skip
        by_gap = _read(of_gaps, plane._GAPS, g)
        # between two planes the mobility is not quite in proportion to the gap next to contact
        near = 1e-9 if room == math.inf else 3e-7
        assert math.sqrt(by_gap[0] * g) == pytest.approx(r, rel=near)
        assert by_gap[1] * r == pytest.approx(math.sqrt(2 * mobility(g)), rel=near)
        if room == math.inf:
            assert by_gap[3:7] == pytest.approx(
                [wall.mobilities(g)[1], wall.mobilities(g)[3], wall.mobilities(g)[2],
                 wall.mobilities(g)[4] * wall.mobilities(g)[1]], rel=1e-9)  # fmt: skip
        square = by_gap[0] * g
        by_square = _read(of_squares, plane._SQUARES, square)
        assert by_square[0] * square == pytest.approx(g, rel=1e-9)
        assert by_square[1:] == pytest.approx(by_gap[1:], rel=1e-7)
    if room < math.inf:
        middle = quad(lambda g: 1 / math.sqrt(2 * mobility(g)), 0, room / 2, limit=200)[0]
        assert between == pytest.approx(2 * middle, rel=1e-6)


def _read(table, powers, number):
    """The polynomials of a number, by its logarithm."""
    power = math.floor(math.log2(number))
    part = (number / 2.0**power - 1) * 8
    row = (power - powers[0]) * 8 + int(part) + 1
    at = 2 * (part - int(part)) - 1
    return np.polynomial.polynomial.polyval(at, table[row])


# --- Boltzmann -----------------------------------------------------------------------------------


@pytest.mark.parametrize("side", ["above", "below"])
@pytest.mark.parametrize("method", ["heun", "one-call"])
def test_boltzmann_at_contact(method, side):
    """A step of 0.2 and 0.8 of the time in which the mean gap is reached, kT over the weight.

    And that the bead is below a tenth of it with 1 - e^(-0.1); within 1 % by the sampling error.
    """
    turned = {} if side == "above" else {
        "wall": {"position": 0.0, "side": "below"}, "start": {"position": [0, 0, -1.02 * RADIUS]},
        "forces": {"gravitational_acceleration": -9.80665},
    }  # fmt: skip
    for step in (0.2, 0.8):
        one = bound(step * RELAXATION, round(40 / step), method=method, **turned)
        rng = np.random.default_rng(5)
        found = gaps_of(one, followed(one, 4000, at_gaps(one, rng.exponential(MEAN, 4000))))
        assert found.min() > 0
        assert abs(off(found, MEAN)) < FAR
        assert abs(off(1.0 * (found < 0.1 * MEAN), -math.expm1(-0.1))) < FAR
        assert found.std() / math.sqrt(4000 * 20) < 0.005 * MEAN  # what it can see


@pytest.mark.parametrize("method", ["heun", "one-call"])
@pytest.mark.parametrize("room", [None, 21.0])
def test_boltzmann_in_a_soft_trap(method, room):
    """A spring about 0.15 radii of gap, a bead of 0.2 radii of spread; beside two planes too."""
    spread, middle = 0.2 * RADIUS, 0.15
    field = LinearTrap(KT / spread**2)
    scene = SINKING.replace(
        forces={"gravity": False, "buoyancy": False},
        wall={"position": -(1 + middle) * RADIUS},
        start={"position": [0, 0, 0]},
    )  # fmt: skip
    if room:
        scene = scene.replace(wall={"opposite": (room - 1 - middle) * RADIUS})
    step = 0.1 * (0.2**2 / RATE)
    problem = bound_once(
        scene.replace(simulation={"step": step * 1.0001, "samples": 401, "duration": 400 * step,
                                  "method": method}), [field])  # fmt: skip
    one = walk(problem, 2)
    mean, low = _truncated(middle / 0.2)
    found = gaps_of(one, followed(one, 2000))[:, 40:]
    assert found.min() > 0
    assert abs(off(found, 0.2 * mean)) < FAR
    assert abs(off(1.0 * (found < 0.02 * mean), low)) < FAR
    x = followed(one, 2000)[:, 40:, 0]
    assert abs(off(x**2, spread**2)) < FAR


def _truncated(middle):
    """Mean distance from the cut of a normal number about `middle` that is above it, and below a
    tenth of it.
    """
    law = stats.truncnorm(-middle, np.inf, loc=middle)
    return law.mean(), law.cdf(0.1 * law.mean())


def test_bias_is_of_second_order():
    """Heun without the spring: that of a step of 1.6 relaxation times is 4 times that of 0.8.

    Between 2.8 and 6: ten and more standard deviations.
    """
    biases = []
    for step in (1.6, 0.8):
        one = bound(step * RELAXATION, round(200 / step))
        shaken = np.array([1, 1, 0.5 / RADIUS**2]) * one.plan.diffusion
        plain = propagator.exact(one.step, np.zeros(3), np.zeros(3), shaken)
        one = dataclasses.replace(one, weights=plain)
        rng = np.random.default_rng(5)
        found = gaps_of(one, followed(one, 4000, at_gaps(one, rng.exponential(MEAN, 4000))))
        biases.append(found[:, 10:].mean() / MEAN - 1)
    assert 2.8 < biases[0] / biases[1] < 6


def test_a_cell_is_filled_evenly():
    """Nothing but two planes: a bead that goes from one to the other is anywhere alike.

    The square of the distance from the middle has the standard deviation of an even density.
    """
    room = 18.0
    scene = SINKING.replace(
        forces={"gravity": False, "buoyancy": False},
        wall={"opposite": (room + 2) * RADIUS},
        start={"position": [0, 0, 10 * RADIUS]},
    )
    for method in ("heun", "one-call"):
        one = bound(2.0 / RATE, 50, method=method, scene=scene)
        gaps = np.random.default_rng(3).uniform(0, room, 4000)
        found = gaps_of(one, followed(one, 4000, at_gaps(one, gaps)))[:, 25:]
        assert found.min() > 0
        assert found.max() < room
        assert abs(off(found / room, 0.5)) < FAR
        assert abs(off((found / room - 0.5) ** 2, 1 / 12)) < FAR
        near = np.minimum(found, room - found)
        assert abs(off(1.0 * (near < 0.5), 1 / 18)) < FAR
        crossed = (found[:, 0] < room / 2) != (found[:, -1] < room / 2)
        assert crossed.mean() > 0.05


@pytest.mark.parametrize("method", ["heun", "one-call"])
def test_boltzmann_above_double_layers(method):
    """DLVO's force and weight, at the step that suits them; a deep minimum at contact, behind a
    barrier that no bead crosses, does not make it short.
    """
    strength, length, hamaker = 1e-18, 1e-8, 1e-21
    scene = SINKING.replace(
        forces={"dlvo": {"strength": strength, "debye_length": length,
                         "hamaker_constant": hamaker}},
        start={"position": [0, 0, 1.06 * RADIUS]},
        simulation={"duration": 4.0, "samples": 101, "method": method},
    )  # fmt: skip
    one = walk(scene, 3)
    assert one.step > 5e-4
    y = np.linspace(0.005, 0.4, 40_000)
    energy = strength * np.exp(-y * RADIUS / length) / KT - hamaker / (6 * y) / KT + y / MEAN
    density = np.exp(energy.min() - energy)
    found = gaps_of(one, followed(one, 1000))[:, 25:]
    assert abs(off(found, (density * y).sum() / density.sum())) < FAR


# --- first passage -------------------------------------------------------------------------------


def test_mean_first_passage_away_from_the_wall():
    """From 0.2 to 2 mean gaps, under the weight: the double integral, within its sampling error.

    Between two steps a bead may have been there: the chance is that of a bridge in the plane.
    """
    begin, end, step, n = 0.2 * MEAN, 2.0 * MEAN, 0.05 * RELAXATION, 2000
    one = bound(step, 600)
    found = gaps_of(one, followed(one, n, at_gaps(one, np.full(n, begin))))
    grid = np.linspace(0, math.sqrt(30 * MEAN), 3000)[1:]
    change = 2 * grid / np.sqrt(2 * np.array([wall.mobilities(g)[0] for g in grid**2]))
    r = grid[0] * change[0] + np.append(
        0, np.cumsum(np.diff(grid) * (change[1:] + change[:-1]) / 2)
    )
    reached = np.interp(end, grid**2, r)
    away = reached - np.interp(found, grid**2, r)
    chance = np.exp(-2 * np.maximum(away[:, 1:], 0) * np.maximum(away[:, :-1], 0) / (step * RATE))
    passed = (away[:, 1:] <= 0) | (np.random.default_rng(1).random(chance.shape) < chance)
    assert passed.any(axis=1).all()
    # in the middle of the step, whose length is a hundredth of the result
    times = (passed.argmax(axis=1) + 0.5) * step
    assert abs(off(times[:, None], _passage(begin, end))) < FAR


def _passage(begin, end):
    """Mean time, s: int dy e^U/mu int_0^y e^-U of U = g/MEAN, in a^2/D."""

    def inner(y):
        return MEAN * math.expm1(y / MEAN) / wall.mobilities(y)[0]

    return quad(inner, begin, end)[0] / RATE


# --- along the wall, and rotation ----------------------------------------------------------------


@pytest.mark.parametrize("method", ["heun", "one-call"])
def test_diffusion_along_the_wall(method):
    """Over ten times of relaxation: 2 D t times the mean of the mobility over Boltzmann."""
    one = bound(0.4 * RELAXATION, 1, per_sample=25, method=method)
    rng = np.random.default_rng(8)
    found = followed(one, 20000, at_gaps(one, rng.exponential(MEAN, 20000)))
    mean = quad(lambda y: wall.mobilities(MEAN * y)[1] * math.exp(-y), 0, 40)[0]
    moved = (found[:, 1, :2] - found[:, 0, :2]) ** 2
    expected = 2 * KT / BEAD.drag * mean * one.times[1]
    if method == "one-call":  # the last sample is half a step ahead, with a quarter of its noise
        expected += KT / BEAD.drag * mean * one.step / 2
    assert abs(off(moved, expected)) < FAR


@pytest.mark.parametrize("method", ["heun", "one-call"])
@pytest.mark.parametrize("side", ["above", "below"])
def test_turning_and_shifting_beside_a_wall(method, side):
    """Covariances of a short step are 2 kT h times the mobilities; a shift turns the bead."""
    sign = 1 if side == "above" else -1
    scene = SINKING.replace(
        wall={"side": side}, start={"position": [0, 0, sign * 1.02 * RADIUS]},
        forces={"brownian_torque": True},
    )  # fmt: skip
    step = 1e-6 * RELAXATION
    one = bound(step, 1, method=method, scene=scene)
    n = 20000
    states = one.start(np.arange(n))
    one.advance(states, np.arange(n), 0, np.empty((n, 1, 7)))
    shift = states[:, :2]
    turn = 2 * states[:, 4:7] / states[:, 3:4]
    towards, along, spin, turning, roll = wall.mobilities(0.02)[:5]
    free, about = 2 * KT / BEAD.drag * step, 2 * KT / (4 / 3 * BEAD.drag * RADIUS**2) * step
    expected = np.diag([along * free] * 2 + [turning * about] * 2 + [spin * about])
    rolling = sign * roll * along / RADIUS * free
    # pushed along x above a wall below it, a bead rolls about +y; along y about -x
    expected[0, 3] = expected[3, 0] = rolling
    expected[1, 2] = expected[2, 1] = -rolling
    both = np.hstack([shift, turn])
    found = both.T @ both / n
    size = np.sqrt(np.diag(expected))
    error = np.sqrt((1 + (expected / np.outer(size, size)) ** 2) / n)
    assert (np.abs(found - expected) / np.outer(size, size) < FAR * error).all()
    assert abs(rolling) / (size[0] * size[3]) > 2 * FAR / math.sqrt(n)  # what it can see
    away = (states[:, 2] * sign / RADIUS - 1.02) ** 2
    assert abs(off(away[:, None], 2 * towards * RATE * step)) < FAR


# --- with inertia --------------------------------------------------------------------------------


@pytest.mark.parametrize("ratio", [0.3, 3.0, 300.0])
def test_boltzmann_and_maxwell_with_inertia(ratio):
    """Steps of so many relaxation times, and of a twentieth of that of the gap; within 1 %.

    The fluid is as thin as that makes it.
    """
    mass, weight = BEAD.mass, -BEAD.weight[2]
    drag = math.sqrt(mass * MEAN * weight * ratio / (RADIUS * 0.05))
    relaxation = RADIUS * drag / weight
    scene = SINKING.replace(medium={"viscosity": drag / (6 * math.pi * RADIUS)},
                            simulation={"model": "full"})  # fmt: skip
    n, steps = 3000, 800
    one = bound(0.05 * relaxation, steps, scene=scene)
    assert one.columns == ("x", "y", "z", "vx", "vy", "vz")
    rng = np.random.default_rng(4)
    states = at_gaps(one, rng.exponential(MEAN, n))
    states[:, 3:6] = rng.normal(size=(n, 3)) * math.sqrt(KT / mass)
    found = followed(one, n, states)
    gaps, v = gaps_of(one, found)[:, 100:], found[:, 100:, 3:]
    assert gaps.min() > 0
    error = gaps.mean(axis=1).std() / math.sqrt(n) / MEAN
    assert abs(gaps.mean() / MEAN - 1) < 0.01 + 3 * error
    assert error < 0.006
    assert (v[..., 2] ** 2).mean() * mass / KT == pytest.approx(1, abs=0.015)


def test_far_from_the_wall_a_step_with_inertia_is_exact():
    """Its weights are those of the propagator, from steps of a thousandth of tau to ten; 1e-9."""
    tau, diffusion = 2e-7, 1e-13
    for ratio in (1e-3, 9e-3, 1.1e-2, 0.1, 1.0, 10.0):
        h = ratio * tau
        left, gone, way, spreading, rise = wall_with_inertia._of_step.py_func(h, tau)
        split = wall_with_inertia._noise_of_velocity.py_func
        noise = split(diffusion, tau, left, gone, spreading)
        found = [way, h - way, rise, left, gone, 1 - way / h,
                 math.sqrt(2 * diffusion * spreading), *noise]  # fmt: skip
        exact = propagator.exact(h, np.array([tau]), np.zeros(1), np.array([diffusion]))
        names = ("by_v", "by_u", "by_rise", "decay", "v_by_u", "v_by_rise", "noise_x", "noise_xv",
                 "noise_v")  # fmt: skip
        assert found == pytest.approx([getattr(exact, name)[0] for name in names], rel=1e-9)


@pytest.mark.parametrize("sinks", [True, False])
def test_quiet_motion_of_a_step_with_inertia(sinks):
    """Without noise a bead that sinks, or flies, does as Newton's equation says."""
    scene = SINKING.replace(
        simulation={"model": "full"},
        start={"position": [0, 0, 1.5 * RADIUS],
               "velocity": [1e-3, 0, -1e-6 if sinks else -1e-2]},
    )  # fmt: skip
    mass, load = BEAD.mass, BEAD.weight[2]
    end = 2e-6

    def rates(_, y):
        g = y[1] / RADIUS - 1
        towards, along = wall.mobilities(g)[:2]
        return [y[2], y[3], -BEAD.drag * y[2] / along / mass,
                (load - BEAD.drag * y[3] / towards) / mass]  # fmt: skip

    v = scene.start.velocity
    exact = solve_ivp(rates, (0, end), [0, 1.5 * RADIUS, v[0], v[2]], rtol=1e-11, atol=1e-20).y
    errors = []
    for steps in (40, 80):
        one = bound(end / steps, steps, scene=scene)
        cold = plane.data_of(one.problem.drag, 1e-20 * KT)
        plan = one.plan._replace(
            diffusion=1e-20 * one.plan.diffusion, drag=one.plan.drag._replace(data=cold)
        )
        one = dataclasses.replace(one, plan=plan)
        found = followed(one, 1)[0, -1, [0, 2]]
        errors.append(np.abs(found - exact[:2, -1]).max())
    assert errors[1] < 1e-3 * np.abs(exact[1, -1] - 1.5 * RADIUS) + 1e-3 * exact[0, -1]
    assert errors[1] < max(0.7 * errors[0], 1e-15)  # of what the plane is read to


# --- never through, the same bits ----------------------------------------------------------------


@pytest.mark.parametrize("model", ["overdamped", "full"])
@pytest.mark.parametrize("room", [None, 21.0])
def test_no_step_is_too_long_for_the_wall(model, room):
    """Steps from 1 ns to 100 s, from contact and far away, in a trap: a place on its side, or an
    error of its own.
    """
    field = LinearTrap(1e-5)
    scene = SINKING.replace(
        wall={"position": -1.2 * RADIUS}, start={"position": [0, 0, 0]},
        simulation={"model": model, "loss_distance": 1e-3},
    )  # fmt: skip
    if room:
        scene = scene.replace(wall={"opposite": (room - 1.2) * RADIUS})
    for step in 10.0 ** np.arange(-9, 3):
        problem = bound_once(scene.replace(simulation={
            "step": step * 1.001, "samples": 31, "duration": 30 * step,
        }), [field])  # fmt: skip
        one = walk(problem, 2)
        states = at_gaps(one, np.geomspace(1e-12, 15.0, 64))
        try:
            found = followed(one, 64, states)
        except IntegrationError:
            continue
        there = np.isfinite(found[..., 2])
        gaps = gaps_of(one, found)[there]
        assert gaps.min() >= -1e-12
        if room:
            assert gaps.max() <= room - 2 + 1e-9


@pytest.mark.parametrize(
    ("method", "sections"),
    [
        ("heun", {}),
        ("one-call", {}),
        ("heun", {"forces": {"brownian_torque": True}}),
        ("heun", {"simulation": {"model": "full"}}),
        ("one-call", {"wall": {"opposite": 25 * RADIUS}}),
    ],
)
def test_the_same_bits_however_it_is_done(method, sections):
    """Of times cut and trajectories apart: what an ensemble is resumed by."""
    one = bound(0.1 * RELAXATION, 6, per_sample=3, method=method, **sections)
    whole = followed(one, 11)
    who = np.arange(4, 11)
    states = one.start(who)
    out = np.empty((7, 6, len(one.columns)))
    one.advance(states, who, 0, out[:, :2])
    one.advance(states.copy(), who, 2, np.empty((7, 1, len(one.columns))))
    for sample in range(2, 6):
        one.advance(states, who, sample, out[:, sample : sample + 1])
    assert "memory" not in one.layout
    np.testing.assert_array_equal(out, whole[4:, 1:])


# --- the start, the step, refusals ---------------------------------------------------------------


def test_a_thermal_start_is_cut_at_contact():
    """Gaussian along the wall, cut towards it: Kolmogorov's test, one seed in a million."""
    spread, middle = 0.2 * RADIUS, 0.15
    scene = SINKING.replace(
        forces={"gravity": False, "buoyancy": False}, wall={"position": -(1 + middle) * RADIUS},
        start={"position": [0, 0, 0], "drawn": "boltzmann"},
    )  # fmt: skip
    one = walk(bound_once(scene, [LinearTrap(KT / spread**2)]), 7)
    start = one.start(np.arange(20000))
    assert gaps_of(one, start).min() > 0
    cut = stats.truncnorm(-middle / 0.2, np.inf, scale=spread)
    for k, law in enumerate((stats.norm(scale=spread), stats.norm(scale=spread), cut)):
        assert stats.kstest(start[:, k], law.cdf).pvalue > 1e-6


def test_a_far_wall_costs_no_steps():
    """The step of a trap 40 radii from a wall is that without one, within what drag is left."""
    scene = tweezer.load_scene("silica-1um").replace(
        forces={"brownian": True}, optics={"evaluator": "map"}, medium={"inertia": "none"},
        simulation={"model": "overdamped", "method": "heun", "duration": 1.0, "samples": 2},
        start={"frame": "focus", "position": [0, 0, 0]},
    )  # fmt: skip
    free, beside = walk(scene), walk(scene.replace(wall={"position": -40e-6 / 2}))
    assert beside.step == pytest.approx(free.step, rel=0.1)
    assert walk(scene.replace(wall={"position": "-0.6 um"})).step > 0.5 * free.step


def test_a_bead_far_from_the_light_has_a_step_too():
    """The search for equilibria does not reach the bead and its wall."""
    small = tweezer.load_scene("silica-1um").replace(
        bead={"radius": 2e-7},
        wall={"position": "9 um", "side": "above"},
        start={"position": [0.0, 0.0, 9.3e-6], "frame": "focus"},
        forces={"brownian": True},
        simulation={"duration": 1e-6, "samples": 2},
    )
    assert abs(small.start_position[2]) > bound_once(small).light.search.reach
    step = walk(small, 1).step
    assert 0 < step <= 1e-6


def test_auto_takes_heun_without_inertia():
    scene = SINKING.replace(medium={"inertia": None}, simulation={"model": None, "method": "auto"})
    one = walk(scene)
    assert one.scene.simulation.model == "overdamped"
    assert one.scene.simulation.method == "heun"
    assert one.scene.medium.inertia == "none"
    assert "plane" in one.why


@pytest.mark.parametrize(
    ("sections", "message"),
    [
        ({"simulation": {"model": "scaled", "scaling_factor": 0.01}}, "must be overdamped or full"),
        ({"simulation": {"model": "first-order"}}, "must be overdamped or full"),
        ({"simulation": {"method": "euler-maruyama"}}, "must be heun or one-call"),
        ({"simulation": {"method": "baoab", "model": "full"}}, "must be heun"),
        ({"simulation": {"method": "one-call", "model": "full"}}, "must be heun"),
        (
            {"simulation": {"model": "full"}, "forces": {"brownian_torque": True}},
            "cannot follow thermal rotation",
        ),
    ],
)
def test_what_does_not_go_beside_a_wall_is_refused(sections, message):
    with pytest.raises(SceneError, match=message):
        walk(SINKING.replace(**sections))
