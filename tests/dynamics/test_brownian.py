"""Thermal motion against closed forms, other generators, limits and orders of convergence.

Seeds are fixed, so a test passes or fails for good; the bounds are those that a right program
would exceed for one seed in the number given.
"""

import dataclasses
import math

import mpmath as mp
import numpy as np
import pytest
from scipy import stats
from scipy.integrate import quad
from scipy.spatial.transform import Rotation

import tweezer
from tests.reference import memory
from tests.reference.fields import GaussianWell, LinearTrap, QuarticTrap, in_field, walk_in
from tweezer.compiled import cached_njit
from tweezer.dynamics import bind, integrate
from tweezer.dynamics.brownian import batch, euler, heun, noise, propagator
from tweezer.dynamics.walk import walk
from tweezer.forces.data import packed
from tweezer.forces.force import Force
from tweezer.forces.force import bound as bound_force
from tweezer.values.errors import IntegrationError, SceneError

#: five standard deviations: one seed in 1.7 million
FAR = 5.0

DARK = tweezer.load_scene("silica-1um").replace(
    forces={"brownian": True, "optical": False, "gravity": False, "buoyancy": False},
    start={"position": [0, 0, 0]}, medium={"inertia": "none"},
)  # fmt: skip
KT = 1.380649e-23 * DARK.medium.temperature
STIFFNESS = 6e-5
BEAD = tweezer.bead_properties(DARK)
DRAG, TAU = BEAD.drag, BEAD.relaxation_time
TRAP = DRAG / STIFFNESS
DIFFUSION = KT / DRAG


def bound(model, method, step, *, samples=2, per_sample=1, seed=1, **sections):
    """A walk in the dark with that step; `harmonic` about the focus, with no light to say so."""
    known = "heun" if method == "harmonic" else method
    simulation = {
        "model": model, "method": known, "step": step, "samples": samples,
        "duration": step * per_sample * (samples - 1), "loss_distance": 1.0,
    } | sections.pop("simulation", {})  # fmt: skip
    one = walk(DARK.replace(simulation=simulation, **sections), seed)
    problem = dataclasses.replace(one.problem, scene=_with_method(one.scene, method))
    return dataclasses.replace(one, problem=problem)


def _with_method(scene, method):
    return scene.model_copy(
        update={"simulation": scene.simulation.model_copy(update={"method": method})}
    )


def followed(bound, n, first=0):
    """Samples (n, samples, columns) of trajectories first, first + 1, ..."""
    trajectories = np.arange(first, first + n)
    states = bound.start(trajectories)
    out = np.empty((n, len(bound.times), len(bound.columns)))
    out[:, 0] = bound.seen(states)
    bound.advance(states, trajectories, 0, out[:, 1:])
    return out


def drawn_for(seed, trajectories, step, many, purpose=noise.NOISE):
    """So many normal numbers of each trajectory, (n, many)."""
    out = np.empty((many, len(trajectories)))
    noise.normals(seed, trajectories, step, purpose, out)
    return out.T


# --- random numbers ------------------------------------------------------------------------------


#: Rotations of Threefry-4x64 by round, modulo 8 (Salmon et al., SC'11, table 2)
ROTATIONS = ((14, 16), (52, 57), (23, 40), (5, 37), (25, 33), (46, 12), (58, 22), (32, 32))
WORD = 2**64
#: counter, key and words of Random123's known answers (its kat_vectors, threefry4x64 20)
ANSWERS = [
    ([0] * 4, [0] * 4, "09218ebde6c85537 55941f5266d86105 4bd25e16282434dc ee29ec846bd2e40b"),
    (
        [WORD - 1] * 4, [WORD - 1] * 4,
        "29c24097942bba1b 0371bbfb0f6f4e11 3c231ffa33f83a1c cd29113fde32d168",
    ),
    (
        [0x243F6A8885A308D3, 0x13198A2E03707344, 0xA4093822299F31D0, 0x082EFA98EC4E6C89],
        [0x452821E638D01377, 0xBE5466CF34E90C6C, 0xBE5466CF34E90C6C, 0xC0AC29B7C97C50DD],
        "a7e8fde591651bd9 baafd0c30138319b 84a5c1a729e685b9 901d406ccebc1ba4",
    ),
]  # fmt: skip


def threefry(counter, key):
    """Words of Threefry-4x64 with 20 rounds, as the paper has it."""
    schedule = [*key, 0x1BD11BDAA9FC1A22 ^ key[0] ^ key[1] ^ key[2] ^ key[3]]
    words = [(c + k) % WORD for c, k in zip(counter, key, strict=True)]
    for number in range(20):
        for i, bits in zip((0, 2), ROTATIONS[number % 8], strict=True):
            j = (i + 1) % 4 if number % 2 == 0 else (i + 3) % 4
            words[i] = (words[i] + words[j]) % WORD
            words[j] = (words[j] << bits | words[j] >> (64 - bits)) % WORD ^ words[i]
        if number % 4 == 3:
            at = number // 4 + 1
            words = [(word + schedule[(at + i) % 5]) % WORD for i, word in enumerate(words)]
            words[3] = (words[3] + at) % WORD
    return words


@pytest.mark.parametrize(("counter", "key", "answer"), ANSWERS)
def test_words_are_the_published_ones_of_threefry(counter, key, answer):
    assert " ".join(f"{word:016x}" for word in threefry(counter, key)) == answer


def test_numbers_are_the_pairs_of_box_and_muller():
    """Of words of Threefry; 52 bits for a radius and 32 for an angle, in other functions."""
    rng = np.random.default_rng(3)
    who = np.append(rng.integers(0, 2**63, 9), 0)
    for seed, step, purpose in (*rng.integers(0, 2**62, (3, 3)).tolist(), (0, 0, 0)):
        drawn = drawn_for(seed, who, step, 12, purpose)
        for trajectory, row in zip(who.tolist(), drawn, strict=True):
            for block in range(2):
                *radii, last = threefry([block, trajectory, step, purpose], [seed, 0, 0, 0])
                ends = [radius % 2**11 for radius in radii]
                rest = ends[0] + 2**11 * ends[1] + 2**22 * (ends[2] % 2**10)
                angles = last % 2**32, last >> 32, rest
                for k, (radius, angle) in enumerate(zip(radii, angles, strict=True)):
                    length = math.sqrt(-2 * math.log(((radius >> 12) + 0.5) / 2**52))
                    turn = math.pi / 2 * ((angle % 2**30 + 0.5) / 2**30 - 0.5)
                    pair = [length * math.cos(turn), length * math.sin(turn)]
                    if angle & 2**30:
                        pair.reverse()
                    if angle & 2**31:
                        pair = [-pair[0], -pair[1]]
                    at = 6 * block + 2 * k
                    np.testing.assert_allclose(row[at : at + 2], pair, rtol=1e-14, atol=1e-15)


def test_numbers_are_normal():
    """Kolmogorov-Smirnov, tails and moments: each fails for one seed in a million or fewer."""
    n = 200_000
    drawn = drawn_for(5, np.arange(n), 0, 6)
    for row in drawn.T:
        assert stats.kstest(row, "norm").pvalue > 1e-6
    for edge in (0.01, 3.0, 4.2):
        for beyond in ((drawn > edge).sum(), (drawn < -edge).sum()):
            assert stats.binomtest(int(beyond), drawn.size, stats.norm.sf(edge)).pvalue > 1e-6
    tail = np.abs(drawn[np.abs(drawn) > 3.0])
    assert stats.kstest(tail, stats.truncnorm(3.0, np.inf).cdf).pvalue > 1e-6
    for power, mean, second in ((1, 0, 1), (2, 1, 3), (3, 0, 15), (4, 3, 105), (6, 15, 10395)):
        spread = math.sqrt((second - mean**2) / drawn.size)
        assert abs((drawn**power).mean() - mean) < FAR * spread


def test_numbers_of_other_columns_trajectories_steps_and_seeds_are_independent():
    """Correlations of 100,000 pairs: beyond 5/sqrt(100,000) for one seed in 1.7 million each."""
    n = 100_000
    base = drawn_for(5, np.arange(n), 7, 8)
    for seed, shift, step, purpose in ((6, 0, 7, 0), (5, 1, 7, 0), (5, 0, 8, 0), (5, 0, 7, 1)):
        other = drawn_for(seed, np.arange(n) + shift, step, 1, purpose)
        assert abs((base[:, 0] * other[:, 0]).mean()) < FAR / math.sqrt(n)
    for numbers in (base, base**2):  # the numbers of a pair share their radius
        correlation = np.corrcoef(numbers.T) - np.eye(8)
        assert np.abs(correlation).max() < FAR / math.sqrt(n)


def test_a_number_does_not_depend_on_what_is_drawn_beside_it():
    wide, narrow = drawn_for(9, np.arange(100), 4, 12), drawn_for(9, np.array([42]), 4, 3)
    assert np.array_equal(wide[42, :3], narrow[0])


# --- stationary moments without sampling: the discrete Lyapunov equation -------------------------


def stationary(M, G):
    """Covariance X = M X M^T + G G^T, with 40 digits."""
    n = M.rows
    kron = mp.matrix(n * n, n * n)
    for i, j, k, l in np.ndindex(n, n, n, n):
        kron[n * i + j, n * k + l] = M[i, k] * M[j, l]
    S = G * G.T
    flat = mp.lu_solve(
        mp.eye(n * n) - kron, mp.matrix([S[i, j] for i in range(n) for j in range(n)])
    )
    return mp.matrix([[flat[n * i + j] for j in range(n)] for i in range(n)])


def digits(weights):
    """The weights of the first coordinate, as `Weights` of exact numbers."""
    return propagator.Weights(*(mp.mpf(float(each[0])) for each in weights if each.ndim == 1))


def weights_of(h, tau, kappa):
    return propagator.exact(h, np.array([tau]), np.array([kappa]), np.array([DIFFUSION]))


@pytest.mark.parametrize("damping", [1e-6, 1e-3, 0.1, 0.25, 10.0])
def test_exact_propagator_has_exact_moments_at_any_step(damping):
    """Second moments to 1e-12, from 1e-3 tau to 10 trap times."""
    kappa = damping / TAU
    with mp.workdps(40):
        for h in np.geomspace(1e-3 * TAU, 10 / kappa, 30):
            w = digits(weights_of(h, TAU, kappa))
            M = mp.matrix([[1 - w.by_u * kappa, w.by_v], [-w.v_by_u * kappa, w.decay]])
            X = stationary(M, mp.matrix([[w.noise_x, 0], [w.noise_xv, w.noise_v]]))
            assert abs(X[0, 0] * kappa / DIFFUSION - 1) < 1e-12
            assert abs(X[1, 1] * TAU / DIFFUSION - 1) < 1e-12
            assert abs(X[0, 1]) < 1e-12 * mp.sqrt(X[0, 0] * X[1, 1])


@pytest.mark.parametrize("damping", [1e-8, 1e-6, 1e-3, 0.1])
def test_one_call_scheme_has_an_exact_position_up_to_two_trap_times(damping):
    """Of x* = x + (by_v v + noise)/2; eight decades of h/tau."""
    kappa = damping / TAU
    with mp.workdps(40):
        for h in np.geomspace(1e-3 * TAU, 1.99 / kappa, 30):
            w = digits(weights_of(h, TAU, 0.0))
            pulled = 1 - w.by_u * kappa / 2
            M = mp.matrix(
                [[1 - w.by_u * kappa, w.by_v * pulled],
                 [-w.v_by_u * kappa, w.decay - w.v_by_u * kappa * w.by_v / 2]]
            )  # fmt: skip
            G = mp.matrix(
                [[w.noise_x * pulled, 0],
                 [w.noise_xv - w.v_by_u * kappa * w.noise_x / 2, w.noise_v]]
            )  # fmt: skip
            X = stationary(M, G)
            variance = X[0, 0] + w.by_v * X[0, 1] + w.by_v**2 * X[1, 1] / 4 + w.noise_x**2 / 4
            assert abs(variance * kappa / DIFFUSION - 1) < 1e-10


def test_without_inertia_the_moments_are_exact_too():
    with mp.workdps(40):
        for g in np.geomspace(1e-8, 10, 30):
            w = digits(weights_of(g * TRAP, 0.0, 1 / TRAP))
            M = mp.matrix([[1 - w.by_u / TRAP]])
            X = stationary(M, mp.matrix([[w.noise_x]]))
            assert abs(X[0, 0] / (DIFFUSION * TRAP) - 1) < 1e-12


@pytest.mark.parametrize(
    ("model", "method", "field", "sections"),
    [
        ("full", "heun", LinearTrap(STIFFNESS), {}),
        ("full", "harmonic", LinearTrap(STIFFNESS), {}),
        ("full", "one-call", LinearTrap(STIFFNESS), {}),
        ("full", "euler-maruyama", LinearTrap(STIFFNESS), {}),
        ("scaled", "heun", LinearTrap(STIFFNESS), {"simulation": {"scaling_factor": 0.01}}),
        ("overdamped", "heun", LinearTrap(STIFFNESS), {}),
        ("overdamped", "one-call", LinearTrap(STIFFNESS), {}),
        ("overdamped", "harmonic", LinearTrap(STIFFNESS), {}),
        ("overdamped", "euler-maruyama", LinearTrap(STIFFNESS), {}),
    ],
)
def test_a_compiled_step_is_that_of_the_weights(model, method, field, sections):
    """So what the Lyapunov equation says of the weights holds for the steps taken."""
    step = 0.3 * (TAU if method == "euler-maruyama" and model == "full" else TRAP)
    kappa = 1 / TRAP if method in ("heun", "harmonic") else 0.0
    one = walk_in(bound(model, method, step, **sections), field, kappa)
    who = np.arange(70)
    rng = np.random.default_rng(8)
    dims = len(one.columns)
    states = np.hstack([rng.normal(size=(70, dims)) * 1e-8, np.full((70, 1), np.inf)])
    if dims == 6:
        states[:, 3:6] *= 1e4
    drawn = drawn_for(one.seed, who, 0, dims)
    w = one.weights
    x, v = states[:, :3], states[:, 3:6] if dims == 6 else np.zeros((70, 3))
    moved = x + w.by_v * v + w.noise_x * drawn[:, :3]
    seen = x + (w.by_v * v + w.noise_x * drawn[:, :3]) / 2
    u = -(seen if method == "one-call" else x) / TRAP
    expected = [seen if method == "one-call" else moved + w.by_u * u]
    if dims == 6:
        expected.append(
            w.decay * v + w.v_by_u * u + w.noise_xv * drawn[:, :3] + w.noise_v * drawn[:, 3:]
        )
    out = np.empty((70, 1, dims))
    one.advance(states, who, 0, out)
    np.testing.assert_allclose(out[:, 0], np.hstack(expected), rtol=1e-12, atol=1e-24)


# --- a spring that couples the coordinates --------------------------------------------------------

#: Stiffness of a trap that pushes round its axis by a share of it, over that along x
ROUND = np.array([[1.0, 0.3, 0.0], [-0.3, 1.0, 0.0], [0.0, 0.0, 0.4]])


def of_round_trap(damping, *, inertial):
    """tau, rates and diffusion of `ROUND`, with rate times tau = `damping` along x."""
    tau = np.full(3, TAU) if inertial else np.zeros(3)
    return tau, damping / TAU * ROUND, np.full(3, DIFFUSION)


def across(matrix, *, inertial):
    """The part of x and y of a propagator as a complex matrix of x + iy, and of its velocity."""
    parts = [0, 3] if inertial else [0]
    return np.array([[matrix[i, j] + 1j * matrix[i + 1, j] for j in parts] for i in parts])


@pytest.mark.parametrize("damping", [1e-4, 0.1, 3.0])
def test_a_step_of_a_trap_that_pushes_round_is_that_of_its_complex_rates(damping):
    """x + iy = e^(lambda t) with tau lambda^2 + lambda + kappa (1 - 0.3i) = 0; and so without."""
    rate = damping / TAU * (1 - 0.3j)
    slow, fast = np.roots([TAU, 1.0, rate])[::-1]
    for h in np.geomspace(1e-3 * TAU, 3 * TAU / damping, 7):
        left, _ = propagator.coupled(h, *of_round_trap(damping, inertial=False))
        assert abs(across(left, inertial=False)[0, 0] - np.exp(-rate * h)) < 1e-13
        left, _ = propagator.coupled(h, *of_round_trap(damping, inertial=True))
        modes = np.array([[1, 1], [slow, fast]])
        exact = modes @ np.diag(np.exp([slow * h, fast * h])) @ np.linalg.inv(modes)
        scale = np.array([[1, TAU], [1 / TAU, 1]])
        assert np.abs((across(left, inertial=True) - exact) / scale).max() < 1e-11


@pytest.mark.parametrize("inertial", [False, True])
@pytest.mark.parametrize("damping", [1e-4, 0.1, 3.0])
def test_noise_of_a_trap_that_pushes_round_keeps_its_stationary_covariance(damping, inertial):
    """kT/k without inertia; with it kT/(k - m (turn/beta)^2), <x vy> = turn/beta <x^2>, and
    <v^2> = k/m <x^2>.
    """
    tau, rates, diffusion = of_round_trap(damping, inertial=inertial)
    kappa, turn = rates[0, 0], rates[0, 1]
    root = propagator.stationary_root(tau, rates, diffusion)
    covariance = root @ root.T
    variance = DIFFUSION / (kappa - TAU * turn**2 * inertial)
    expected = np.diag([variance, variance, DIFFUSION / rates[2, 2]])
    scale = np.full(3, math.sqrt(DIFFUSION / kappa))
    if inertial:
        crossed = np.zeros((3, 3))
        crossed[0, 1], crossed[1, 0] = turn * variance, -turn * variance
        speed = kappa / TAU * variance
        of_v = np.diag([speed, speed, DIFFUSION / TAU])
        expected = np.block([[expected, crossed], [crossed.T, of_v]])
        scale = np.append(scale, np.full(3, math.sqrt(DIFFUSION / TAU)))
    scale = np.outer(scale, scale)
    np.testing.assert_allclose(covariance / scale, expected / scale, rtol=0, atol=1e-10)
    for h in np.geomspace(1e-2 * TAU, 3 * TAU / damping, 5):
        left, noise = propagator.coupled(h, tau, rates, diffusion)
        after = left @ covariance @ left.T + noise @ noise.T
        np.testing.assert_allclose(after / scale, expected / scale, rtol=0, atol=1e-9)


def test_a_spring_that_couples_nothing_has_the_step_of_each_coordinate():
    tau, rates, diffusion = np.full(3, TAU), np.diag([1.0, 2.0, 0.5]) / TRAP, np.full(3, DIFFUSION)
    for h in (0.01 * TAU, TAU, 0.3 * TRAP):
        w = propagator.exact(h, tau, np.diag(rates), diffusion)
        left, noise = propagator.coupled(h, tau, rates, diffusion)
        e_xx = np.diag(1 - w.by_u * np.diag(rates))
        e_vx = np.diag(-w.v_by_u * np.diag(rates))
        expected = np.block([[e_xx, np.diag(w.by_v)], [e_vx, np.diag(w.decay)]])
        scale = np.repeat([1.0, 1 / TAU], 3)[:, None] / np.repeat([1.0, 1 / TAU], 3)
        assert np.abs((left - expected) / scale).max() < 1e-11
        spread = np.block([
            [np.diag(w.noise_x), np.zeros((3, 3))], [np.diag(w.noise_xv), np.diag(w.noise_v)]
        ])  # fmt: skip
        np.testing.assert_allclose(noise @ noise.T, spread @ spread.T, rtol=1e-8, atol=1e-30)


@pytest.mark.parametrize("model", ["full", "overdamped"])
def test_harmonic_steps_take_the_whole_stiffness_of_circular_light(model):
    scene = tweezer.load_scene("silica-1um").replace(
        forces={"brownian": True}, start={"drawn": "boltzmann"},
        simulation={"model": model, "method": "harmonic", "step": 1e-5, "duration": 1e-4,
                    "samples": 11},
    )  # fmt: skip
    one = walk(scene, 3)
    who, dims = np.arange(70), len(one.columns)
    states = one.start(who)
    place = np.append(one.equilibrium.position, np.zeros(dims - 3))
    away = one.seen(states) - place
    tau = one.plan.tau if model == "full" else np.zeros(3)
    rates = one.plan.mobility[:, None] * np.array(one.equilibrium.stiffness)
    left, noise = propagator.coupled(1e-5, tau, rates, one.plan.diffusion)
    assert abs(left[1, 0]) > 1e-3
    out = np.empty((70, 1, dims))
    one.advance(states, who, 0, out)
    expected = place + away @ left.T + drawn_for(3, who, 0, dims) @ noise.T
    scale = np.abs(expected).max(axis=0)
    np.testing.assert_allclose(out[:, 0] / scale, expected / scale, rtol=0, atol=1e-9)


def test_a_push_round_the_axis_drives_a_bead_of_weak_drag_out():
    """Its circles grow once (turn/beta)^2 > kappa/tau."""
    with pytest.raises(SceneError, match=r"start.drawn = 'boltzmann': .* circles grow by"):
        propagator.stationary_root(*of_round_trap(12.0, inertial=True))
    propagator.stationary_root(*of_round_trap(11.0, inertial=True))


def test_scaled_model_keeps_boltzmann_in_position_and_has_velocities_of_a2_T():
    a2 = 1e-3
    one = bound("scaled", "heun", TRAP / 10, simulation={"scaling_factor": a2})
    tau = float(one.plan.tau[0])
    assert tau == pytest.approx(TAU / a2)
    with mp.workdps(40):
        w = digits(weights_of(one.step, tau, 1 / TRAP))
        M = mp.matrix([[1 - w.by_u / TRAP, w.by_v], [-w.v_by_u / TRAP, w.decay]])
        X = stationary(M, mp.matrix([[w.noise_x, 0], [w.noise_xv, w.noise_v]]))
        assert abs(X[0, 0] * STIFFNESS / KT - 1) < 1e-12
        assert abs(X[1, 1] * BEAD.mass / (a2 * KT) - 1) < 1e-12


def test_a_scaling_factor_belongs_to_the_scaled_model_alone():
    one = bound("full", "heun", TRAP / 10, simulation={"scaling_factor": 1e-3})
    assert one.plan.tau == pytest.approx(TAU)


# --- spreading and relaxing, by sampling ---------------------------------------------------------


def spread_of(h, tau, kappa):
    """MSD of a thermal bead in a trap after a time h: 2 kT/k (1 - e_xx)."""
    if tau == 0:
        return 2 * DIFFUSION / kappa * -math.expm1(-kappa * h)
    root = np.sqrt(complex(1 - 4 * kappa * tau))
    slow, fast = (1 - root) / (2 * tau), (1 + root) / (2 * tau)
    left = (fast * np.exp(-slow * h) - slow * np.exp(-fast * h)) / (fast - slow)
    return 2 * DIFFUSION / kappa * (1 - left.real)


@pytest.mark.parametrize("steps_per_tau", [0.2, 5.0])
def test_free_bead_spreads_and_forgets_its_velocity(steps_per_tau):
    """MSD 2 D (t - tau (1 - e^(-t/tau))) and VACF kT/m e^(-t/tau), from thermal velocities."""
    n = 20_000
    one = bound("full", "heun", TAU / steps_per_tau, samples=9)
    states = one.start(np.arange(n))
    drawn = drawn_for(77, np.arange(n), 0, 3, noise.START)
    states[:, 3:6] = drawn * math.sqrt(KT / BEAD.mass)
    first = states[:, 3:6].copy()
    out = np.empty((n, 8, 6))
    one.advance(states, np.arange(n), 0, out)
    t = one.times[1:]
    msd = (out[:, :, :3] ** 2).mean(axis=(0, 2))
    expected = 2 * DIFFUSION * (t + TAU * np.expm1(-t / TAU))
    assert np.all(np.abs(msd / expected - 1) < FAR * math.sqrt(2 / (3 * n)))
    vacf = (out[:, :, 3:6] * first[:, None]).mean(axis=(0, 2)) * BEAD.mass / KT
    assert np.all(np.abs(vacf - np.exp(-t / TAU)) < FAR * math.sqrt(2 / (3 * n)))
    energy = (out[:, -1, 3:6] ** 2).mean() * BEAD.mass / KT
    assert abs(energy - 1) < FAR * math.sqrt(2 / (3 * n))


@pytest.mark.parametrize(
    ("model", "per_sample", "step"),
    [("full", 1, 0.5 * TRAP), ("full", 7, 0.3 * TAU), ("scaled", 3, 0.1 * TRAP),
     ("overdamped", 1, 0.5 * TRAP), ("first-order", 4, 0.1 * TRAP)],
)  # fmt: skip
def test_trapped_bead_spreads_as_it_should(model, per_sample, step):
    """MSD from the equilibrium, over lags of samples; from Boltzmann's distribution."""
    n = 20_000
    scaling = {"simulation": {"scaling_factor": 1e-3}} if model == "scaled" else {}
    one = walk_in(
        bound(model, "heun", step, samples=6, per_sample=per_sample, **scaling),
        LinearTrap(STIFFNESS), 1 / TRAP,
    )  # fmt: skip
    tau = float(one.plan.tau[0]) if model in ("full", "scaled") else 0.0
    states = one.start(np.arange(n))
    drawn = drawn_for(5, np.arange(n), 0, 6, noise.START)
    states[:, :3] = drawn[:, :3] * math.sqrt(KT / STIFFNESS)
    if tau:
        states[:, 3:6] = drawn[:, 3:] * math.sqrt(DIFFUSION / tau)
    first = states[:, :3].copy()
    out = np.empty((n, 5, len(one.columns)))
    one.advance(states, np.arange(n), 0, out)
    for k, t in enumerate(one.times[1:]):
        measured = ((out[:, k, :3] - first) ** 2).mean()
        assert abs(measured / spread_of(t, tau, 1 / TRAP) - 1) < FAR * math.sqrt(2 / (3 * n))
    variance = (out[:, -1, :3] ** 2).mean() * STIFFNESS / KT
    assert abs(variance - 1) < FAR * math.sqrt(2 / (3 * n))


def test_boltzmann_start_is_the_stationary_distribution():
    """Of the real trap: positions by its stiffness, velocities by kT/m. KS at one seed in 1e5."""
    scene = tweezer.load_scene("silica-1um").replace(
        forces={"brownian": True, "brownian_torque": True}, start={"drawn": "boltzmann"},
        simulation={"model": "full"}, medium={"inertia": "none"},
    )  # fmt: skip
    one = walk(scene, 4)
    states = one.start(np.arange(5000))
    k = np.diag(one.equilibrium.stiffness)
    kT = 1.380649e-23 * scene.medium.temperature
    bead = tweezer.bead_properties(scene)
    for axis in range(3):
        x = (states[:, axis] - one.equilibrium.position[axis]) / math.sqrt(kT / k[axis])
        v = states[:, 3 + axis] / math.sqrt(kT / bead.mass)
        w = states[:, 10 + axis] / math.sqrt(kT / bead.moments_of_inertia[0])
        for drawn in (x, v, w):
            assert stats.kstest(drawn, "norm").pvalue > 1e-5


def test_ball_start_is_uniform():
    one = bound("overdamped", "heun", 1e-6, start={"drawn": "ball", "ball_radius": 3e-7})
    x = one.start(np.arange(20_000))[:, :3] / 3e-7
    assert stats.kstest(np.linalg.norm(x, axis=1) ** 3, "uniform").pvalue > 1e-5
    assert stats.kstest(x[:, 2] / np.linalg.norm(x, axis=1), "uniform", (-1, 2)).pvalue > 1e-5


# --- order of convergence ------------------------------------------------------------------------

QUARTIC = QuarticTrap(STIFFNESS, 0.1 * STIFFNESS**2 / KT)


def mean_square():
    """<x^2> in that trap."""
    sigma = math.sqrt(KT / STIFFNESS)

    def weight(x):
        return math.exp(-(x**2) / 2 - 0.1 * x**4 / 4)

    whole = quad(weight, -9, 9, epsabs=1e-13)[0]
    return quad(lambda x: x * x * weight(x), -9, 9, epsabs=1e-13)[0] / whole * sigma**2


def bias(model, method, step, kappa, field=QUARTIC, truth=mean_square):
    """Of <x^2> at that step, relative, and its standard error over independent trajectories."""
    n, samples = 2048, 1200
    one = bound(model, method, step, samples=samples)
    there = (followed(walk_in(one, field, kappa), n)[:, 200:, :3] ** 2).mean(axis=(1, 2)) / truth()
    # the same noise in a harmonic trap, where the variance is known, takes most of the scatter off
    exact = walk_in(bound(model, "heun", step, samples=samples), LinearTrap(STIFFNESS), 1 / TRAP)
    known = (followed(exact, n)[:, 200:, :3] ** 2).mean(axis=(1, 2)) * STIFFNESS / KT
    covariance = np.cov(there, known)
    of_each = there - 1 - covariance[0, 1] / covariance[1, 1] * (known - 1)
    return of_each.mean(), of_each.std() / math.sqrt(n)


#: width of a Gaussian well 20 kT deep, in kT/k
WIDTH_SQUARED = 20.0


def mean_square_in_the_well():
    """<x^2> = <r^2>/3 in it, up to 2.5 widths: the rim is not passed in the time simulated."""

    def weight(r):
        return r * r * math.exp(WIDTH_SQUARED * math.expm1(-r * r / (2 * WIDTH_SQUARED)))

    end = 2.5 * math.sqrt(WIDTH_SQUARED)
    whole = quad(weight, 0, end, epsabs=1e-13)[0]
    return quad(lambda r: r * r * weight(r), 0, end, epsabs=1e-13)[0] / whole / 3 * KT / STIFFNESS


@pytest.mark.parametrize("model", ["full", "overdamped"])
@pytest.mark.parametrize(("method", "kappa"), [("heun", 1 / TRAP), ("one-call", 0.0)])
def test_bias_in_an_anharmonic_well_is_below_0_3_per_cent_at_a_fifth_of_its_time(
    model, method, kappa
):
    well = GaussianWell(STIFFNESS, math.sqrt(WIDTH_SQUARED * KT / STIFFNESS))
    off, error = bias(model, method, 0.2 * TRAP, kappa, well, mean_square_in_the_well)
    assert abs(off) < 0.003
    assert error < 0.0008  # so that it can be told


@pytest.mark.parametrize("model", ["full", "overdamped"])
def test_heun_is_of_weak_order_two(model):
    """Without the spring in the exact block. The slope's own standard error is about 0.06."""
    coarse, _ = bias(model, "heun", 0.6 * TRAP, 0.0)
    fine, error = bias(model, "heun", 0.3 * TRAP, 0.0)
    assert abs(fine) > 20 * error
    assert 1.7 < math.log2(coarse / fine) < 2.6


def test_euler_maruyama_is_of_weak_order_one():
    coarse, _ = bias("overdamped", "euler-maruyama", 0.3 * TRAP, 0.0)
    fine, error = bias("overdamped", "euler-maruyama", 0.15 * TRAP, 0.0)
    assert abs(fine) > 20 * error
    assert 0.9 < math.log2(coarse / fine) < 1.4


def stepped(field, h, tau, x, v, normal):
    """One exponential Heun step of beads (n, 3) with that noise, the spring not exact."""
    weights = propagator.exact(h, np.full(3, tau), np.zeros(3), np.full(3, DIFFUSION))
    beads = batch.beads(len(x), 3, True, False, True)
    beads.x[:], beads.v[:], beads.normal[:] = x.T, v.T, normal.T
    plan = walk(DARK.replace(simulation={"model": "full"})).plan
    plan = plan._replace(load=np.zeros(3), mobility=np.full(3, 1 / DRAG))
    heun.step(bound_force(field, gradient=False), plan, weights, beads)
    return beads.x.T.copy(), beads.v.T.copy()


def noise_of(weights, normal):
    """(xi_x, xi_v) of normal numbers (n, 6)."""
    return (
        weights.noise_x * normal[:, :3],
        weights.noise_xv * normal[:, :3] + weights.noise_v * normal[:, 3:],
    )


@pytest.mark.parametrize("steps_per_tau", [1e-3, 1.0])
def test_heun_is_of_strong_order(steps_per_tau):
    """Along one path of the noise, at long and at short steps over tau.

    The noise of a step of 2 h is put together from that of its halves, as the exact propagator
    says. Additive noise: order 1 in the positions where h >> tau, 2 where the velocity is
    resolved.
    """
    rng = np.random.default_rng(2)
    n, finest = 400, 64
    h = (0.8 * TRAP if steps_per_tau < 1 else 0.8 * TAU) / finest
    tau = TAU
    path = rng.normal(size=(finest, n, 6))
    three = np.full(3, tau), np.zeros(3), np.full(3, DIFFUSION)
    xi = [noise_of(propagator.exact(h, *three), each) for each in path]
    ends = []
    for level in range(4):
        step = h * 2**level
        w = propagator.exact(step, *three)
        x, v = np.full((n, 3), 2e-8), np.zeros((n, 3))
        for xi_x, xi_v in xi:
            first = xi_x / w.noise_x
            normal = np.hstack([first, (xi_v - w.noise_xv * first) / w.noise_v])
            x, v = stepped(QUARTIC, step, tau, x, v, normal)
        ends.append(x)
        xi = [
            (a_x + w.by_v * a_v + b_x, w.decay * a_v + b_v)
            for (a_x, a_v), (b_x, b_v) in zip(xi[::2], xi[1::2], strict=True)
        ]
    away = [np.sqrt(((a - b) ** 2).mean()) for a, b in zip(ends[1:], ends, strict=False)]
    slope = np.polyfit(np.arange(3), np.log2(away), 1)[0]
    if steps_per_tau < 1:
        assert 0.85 < slope < 1.3
    else:
        assert 1.8 < slope < 2.3


def test_cold_bead_follows_the_deterministic_path_to_order_two():
    """T -> 0: against the exponential method at 1e-12."""
    field = QuarticTrap(STIFFNESS, STIFFNESS / (2e-7) ** 2)
    released = {"start": {"position": [2e-7, -1e-7, 1.5e-7]}}
    warm = DARK.replace(
        forces={"brownian": False}, **released,
        simulation={"model": "full", "method": "exponential", "duration": TRAP, "samples": 2,
                    "relative_tolerance": 1e-12, "position_tolerance": 1e-18},
    )  # fmt: skip
    equations = in_field(bind(warm), field)
    truth = integrate(equations, np.array([0.0, TRAP])).states[-1, :3]
    errors = []
    for steps in (40, 80, 160):
        one = walk_in(bound("full", "heun", TRAP / steps, per_sample=steps, **released), field)
        silent = one.weights._replace(
            noise_x=np.zeros(3), noise_xv=np.zeros(3), noise_v=np.zeros(3)
        )
        end = followed(dataclasses.replace(one, weights=silent), 1)[0, -1, :3]
        errors.append(np.linalg.norm(end - truth))
    slopes = np.log2(np.divide(errors[:-1], errors[1:]))
    assert np.all((slopes > 1.8) & (slopes < 2.3))


# --- schemes for comparison ----------------------------------------------------------------------


def test_baoab_moves_too_easily_at_long_steps():
    """Free diffusion: D (h/2 tau) coth(h/2 tau), as its authors' analysis says."""
    n, h = 20_000, 6 * TAU
    one = bound("full", "baoab", h, samples=2, per_sample=50)
    x = followed(one, n)[:, -1, :3]
    half = h / (2 * TAU)
    t = one.times[-1]
    # the velocity at the begin is 0, and what it lacks is below a relaxation time or two
    measured = (x**2).mean() / (2 * DIFFUSION * t)
    assert measured == pytest.approx(half / math.tanh(half), rel=0.02)


def test_a_compiled_baoab_step_is_kick_drift_noise_drift_kick():
    h = 0.7 * TAU
    one = walk_in(bound("full", "baoab", h), LinearTrap(STIFFNESS))
    who = np.arange(70)
    rng = np.random.default_rng(9)
    x, v = rng.normal(size=(70, 3)) * 1e-8, rng.normal(size=(70, 3)) * 1e-4
    states, out = np.hstack([x, v, np.full((70, 1), np.inf)]), np.empty((70, 1, 6))
    one.advance(states, who, 0, out)
    kT_over_m, decay = KT / BEAD.mass, math.exp(-h / TAU)
    v = v - 0.5 * h * STIFFNESS / BEAD.mass * x
    x = x + 0.5 * h * v
    v = decay * v + math.sqrt((1 - decay**2) * kT_over_m) * drawn_for(one.seed, who, 0, 3)
    x = x + 0.5 * h * v
    v = v - 0.5 * h * STIFFNESS / BEAD.mass * x
    np.testing.assert_allclose(out[:, 0], np.hstack([x, v]), rtol=1e-11, atol=1e-22)


def test_baoab_samples_a_harmonic_position_exactly():
    one = walk_in(bound("full", "baoab", 0.5 * TAU, samples=120, per_sample=20), LinearTrap(1e-2))
    x = followed(one, 3000)[:, 40:, :3]
    of_each = (x**2).mean(axis=(1, 2)) * 1e-2 / KT
    assert abs(of_each.mean() - 1) < FAR * of_each.std() / math.sqrt(len(of_each))


def test_euler_maruyama_errs_in_the_variance_as_known():
    """Overdamped and linear: kT/k / (1 - h/(2 trap times)), by the weights."""
    linear = batch.Linear(np.zeros(1), np.zeros(1), np.array([DIFFUSION]), 0.0, np.zeros((3, 3)))
    with mp.workdps(40):
        w = digits(euler.weights(0.5 * TRAP, linear))
        X = stationary(mp.matrix([[1 - w.by_u / TRAP]]), mp.matrix([[w.noise_x]]))
        assert abs(X[0, 0] * STIFFNESS / KT * (1 - mp.mpf("0.25")) - 1) < 1e-12


# --- other exact results -------------------------------------------------------------------------


@pytest.mark.parametrize(("per_trap", "radius"), [(0.02, 1.5), (0.2, 2.5)])
def test_first_passage_time_is_the_exact_double_integral(per_trap, radius):
    """From the centre of a harmonic trap to 1.5 and 2.5 sigma, by the time of loss.

    At the ends of steps alone the passage is seen late, as if the radius were larger by
    0.5826 sqrt(2 D h) (Broadie, Glasserman, Kou, Math. Finance 7:325 (1997)).
    """
    n, sigma = 8000, math.sqrt(KT / STIFFNESS)
    step = per_trap * TRAP
    one = walk_in(
        bound("overdamped", "heun", step, samples=2, per_sample=int(150 / per_trap),
              simulation={"loss_distance": radius * sigma}),
        LinearTrap(STIFFNESS), 1 / TRAP,
    )  # fmt: skip
    states = one.start(np.arange(n))
    one.advance(states, np.arange(n), 0, np.empty((n, 1, 3)))
    times = states[:, -1]
    assert np.isfinite(times).all()

    def inner(r):
        return quad(lambda s: s * s * math.exp(-s * s / 2), 0, r)[0]

    expected = TRAP * quad(lambda r: math.exp(r * r / 2) / r**2 * inner(r), 0, radius)[0]
    assert abs(times.mean() / expected - 1) < FAR * times.std() / times.mean() / math.sqrt(n)


def test_jarzynskis_equality_for_a_dragged_trap():
    """<e^(-W/kT)> = 1, and the mean lag v beta/k; the trap is moved between exact steps."""
    n, h, tau = 40_000, 0.2 * TRAP, TAU
    speed = 0.5 * math.sqrt(KT / STIFFNESS) / TRAP
    w = propagator.exact(h, np.full(3, tau), np.full(3, 1 / TRAP), np.full(3, DIFFUSION))
    one = walk_in(bound("full", "harmonic", h), LinearTrap(STIFFNESS), 1 / TRAP)
    who = np.arange(n)
    states = np.hstack([np.zeros((n, 6)), np.full((n, 1), np.inf)])
    drawn = drawn_for(21, who, 0, 6, noise.START)
    states[:, :3] = drawn[:, :3] * math.sqrt(KT / STIFFNESS)
    states[:, 3:6] = drawn[:, 3:] * math.sqrt(KT / BEAD.mass)
    work, out = np.zeros(n), np.empty((n, 1, 6))
    one = dataclasses.replace(one, weights=w)
    for number in range(40):
        before = states[:, 0].copy()
        states[:, 0] -= speed * h  # in the frame of the trap
        work += 0.5 * STIFFNESS * (states[:, 0] ** 2 - before**2)
        one.advance(states, who, number, out)
    weight = np.exp(-work / KT)
    assert abs(weight.mean() - 1) < FAR * weight.std() / math.sqrt(n)
    # between moves the trap rests: the lag before a move is that of steps of v h
    decay = 1 - float(w.by_u[0]) / TRAP
    lag = speed * h * decay / (1 - decay)
    spread = states[:, 0].std() / math.sqrt(n)
    assert abs(-states[:, 0].mean() - lag) < FAR * spread + 1e-3 * lag


# --- rotation ------------------------------------------------------------------------------------


def legendre(cosine):
    return np.array([stats_l.mean() for stats_l in (
        cosine, (3 * cosine**2 - 1) / 2, (5 * cosine**3 - 3 * cosine) / 2,
        (35 * cosine**4 - 30 * cosine**2 + 3) / 8,
    )])  # fmt: skip


@pytest.mark.parametrize("torque", [(0.0, 0.0, 0.0), (0.0, 0.0, 1.0)])
def test_rotational_diffusion_is_exact_at_its_longest_step(torque):
    """<P_l> = e^(-l (l + 1) D t) after steps of D h = 1/4; a torque about z leaves cos(theta)."""
    n = 100_000
    diffusion = KT / BEAD.rotational_drag
    h = 0.25 / diffusion
    one = bound(
        "overdamped", "heun", h, samples=3, forces={"brownian_torque": True},
    )  # fmt: skip
    moment = tuple(3 * BEAD.rotational_drag / h * each for each in torque)
    one = walk_in(one, LinearTrap(STIFFNESS, moment), 1 / TRAP)
    out = followed(one, n)
    assert np.abs(np.linalg.norm(out[:, :, 3:], axis=2) - 1).max() < 1e-14
    for k in (1, 2):
        axis = Rotation.from_quat(out[:, k, 3:], scalar_first=True).apply([0.0, 0.0, 1.0])
        l = np.arange(1, 5)
        expected = np.exp(-l * (l + 1) * 0.25 * k)
        assert np.all(np.abs(legendre(axis[:, 2]) - expected) < FAR / np.sqrt(n * (2 * l + 1)))


def test_torque_turns_the_mean_axis():
    """Diffusion and the turn of a constant torque commute: the mean of x turns and shrinks."""
    n = 50_000
    diffusion = KT / BEAD.rotational_drag
    h = 0.1 / diffusion
    one = bound("overdamped", "heun", h, samples=4, forces={"brownian_torque": True})
    turn = 0.7
    moment = (0.0, 0.0, turn * BEAD.rotational_drag / h)
    one = walk_in(one, LinearTrap(STIFFNESS, moment), 1 / TRAP)
    out = followed(one, n)
    for k in (1, 2, 3):
        mean = Rotation.from_quat(out[:, k, 3:], scalar_first=True).apply([1.0, 0, 0]).mean(axis=0)
        size = math.exp(-2 * 0.1 * k)
        expected = size * np.array([math.cos(turn * k), math.sin(turn * k), 0.0])
        assert np.all(np.abs(mean - expected) < FAR / math.sqrt(3 * n) * 1.5)


def test_angular_velocity_is_thermal_and_the_axis_diffuses():
    """Equipartition I <w^2> = 3 kT, and <P_1> = e^(-2 D (t - tau_r (1 - e^(-t/tau_r))))."""
    n = 20_000
    drag, inertia = BEAD.rotational_drag, BEAD.moments_of_inertia[0]
    tau, diffusion = inertia / drag, KT / drag
    h = 2e-3 / diffusion
    one = bound("full", "heun", h, samples=3, per_sample=20, forces={"brownian_torque": True})
    one = walk_in(one, LinearTrap(STIFFNESS), 1 / TRAP)
    out = followed(one, n)
    w = out[:, -1, 10:]
    assert abs((w**2).mean() * inertia / KT - 1) < FAR * math.sqrt(2 / (3 * n))
    for k in (1, 2):
        t = one.times[k]
        axis = Rotation.from_quat(out[:, k, 6:10], scalar_first=True).apply([0.0, 0.0, 1.0])
        # released without an angular velocity: 3/2 relaxation times late
        expected = math.exp(-2 * diffusion * (t - 1.5 * tau))
        assert abs(axis[:, 2].mean() - expected) < FAR * axis[:, 2].std() / math.sqrt(n)


def test_torque_noise_is_that_of_the_force_by_the_arm():
    """L_C = 2 r/sqrt(3) of (2.17), in the strengths that the steps are made with."""
    one = bound("full", "heun", TAU, forces={"brownian_torque": True})
    force = 2 * KT / one.plan.mobility[0]
    torque = 2 * KT / one.plan.mobility[3]
    arm = 2 * DARK.bead.radius / math.sqrt(3)
    assert torque == pytest.approx(arm**2 * force, rel=1e-14)


# --- the same numbers, whatever is done beside ---------------------------------------------------


REAL = tweezer.load_scene("silica-1um").replace(
    forces={"brownian": True},
    optics={"evaluator": "map", "table_tolerance": 1e-4},
    start={"drawn": "ball", "ball_radius": "1.8 um"},  # in and out of the table's range
    simulation={"duration": 4e-4, "samples": 9},
)


@pytest.fixture(scope="module", params=["full", "overdamped", "first-order"])
def real(request):
    return walk(REAL.replace(simulation={"model": request.param}), 12)


def test_trajectories_do_not_depend_on_their_company(real):
    together = followed(real, 130)
    for first, n in ((0, 1), (5, 64), (100, 30)):
        assert np.array_equal(followed(real, n, first), together[first : first + n])


def test_trajectories_do_not_depend_on_what_memory_held(real):
    memory.leave(memory.ZEROS)
    one = followed(real, 70)
    memory.leave(memory.NAN)
    assert np.array_equal(followed(real, 70), one)


def test_trajectories_do_not_depend_on_where_time_is_cut(real):
    who = np.arange(3)
    whole = followed(real, 3)
    states, parts = real.start(who), np.empty_like(whole)
    parts[:, 0] = real.seen(states)
    for begin, end in ((0, 1), (1, 4), (4, 8)):
        states = states.copy()
        real.advance(states, who, begin, parts[:, begin + 1 : end + 1])
    assert np.array_equal(whole, parts)


def test_another_seed_is_another_path(real):
    assert not np.array_equal(followed(real, 2), followed(walk(real.scene, 13), 2))


def test_evaluators_agree_along_a_path():
    """Table, quadrature and thesis's grid of rays drive the same bead by the same noise."""
    ends = {}
    for evaluator in ("map", "quadrature", "grid"):
        scene = REAL.replace(
            optics={"theory": "rays", "evaluator": evaluator, "table_tolerance": 1e-6},
            start={"drawn": "no", "position": [1e-7, 0, 0]},
            simulation={"model": "full", "duration": 2e-4, "samples": 3},
        )
        ends[evaluator] = followed(walk(scene, 2), 1)[0, -1, :3]
    assert np.linalg.norm(ends["map"] - ends["quadrature"]) < 1e-12
    # the sum over squares is off by about 1 %, and its trap by nanometres
    assert np.linalg.norm(ends["grid"] - ends["quadrature"]) < 1e-8


# --- a scene bound as it is ----------------------------------------------------------------------


@pytest.mark.parametrize("model", ["full", "scaled", "overdamped", "first-order"])
def test_the_spring_taken_exactly_is_that_of_the_scene(model):
    """By `characterise`, and for first order the rate of the slow decay, kappa (1 + kappa tau)."""
    scene = REAL.replace(
        simulation={"model": model, "scaling_factor": 0.1}, medium={"inertia": "none"}
    )
    one = walk(scene)
    stiffness = np.diag(tweezer.characterise(scene).equilibrium.stiffness)
    kappa = stiffness / DRAG
    if model == "first-order":
        kappa = kappa * (1 + kappa * TAU)
        slow = (1 - np.sqrt(1 - 4 * stiffness / DRAG * TAU)) / (2 * TAU)
        np.testing.assert_allclose(kappa, slow, rtol=3 * (stiffness.max() / DRAG * TAU) ** 2)
    np.testing.assert_allclose(one.weights.kappa, kappa, rtol=1e-12)
    tau = {"full": TAU, "scaled": TAU / 0.1}.get(model, 0.0)
    expected = propagator.exact(one.step, np.full(3, tau), kappa, np.full(3, DIFFUSION))
    for name in propagator.Weights._fields:
        np.testing.assert_allclose(getattr(one.weights, name), getattr(expected, name), rtol=1e-12)


@pytest.mark.parametrize("method", ["harmonic", "heun", "one-call"])
def test_a_bead_stays_about_the_equilibrium_of_the_scene(method):
    """Mean and variance of independent places; the well's anharmonicity is below 0.3 %."""
    n = 20_000
    scene = REAL.replace(
        start={"drawn": "equilibrium"}, optics={"table_tolerance": 1e-6},
        simulation={"model": "overdamped", "method": method, "duration": 5e-3, "samples": 2},
    )  # fmt: skip
    one = walk(scene, 3)
    place = np.array(one.equilibrium.position)
    assert np.array_equal(one.start(np.arange(2))[:, :3], np.array([place, place]))
    x = followed(one, n)[:, -1] - place
    variance = KT / np.diag(one.equilibrium.stiffness)
    assert np.all(np.abs(x.mean(axis=0)) < FAR * np.sqrt(variance / n) + 2e-3 * np.sqrt(variance))
    assert np.all(np.abs(x.var(axis=0) / variance - 1) < FAR * math.sqrt(2 / n) + 3e-3)


# --- ends and refusals ---------------------------------------------------------------------------


def test_a_lost_bead_is_no_number_from_then_on():
    one = bound("overdamped", "heun", 5e-3, samples=50, simulation={"loss_distance": 3e-7})
    states = one.start(np.arange(20))
    out = np.empty((20, 49, 3))
    one.advance(states, np.arange(20), 0, out)
    lost = states[:, -1]
    assert np.isfinite(lost).sum() > 5
    for i in range(20):
        after = one.times[1:] >= lost[i] * (1 - 1e-12)
        assert np.isnan(out[i, after]).all()
        assert np.isfinite(out[i, ~after]).all()
        assert (np.linalg.norm(out[i, ~after], axis=1) < 3e-7).all()


def test_a_bead_is_lost_at_the_plane_of_the_lens_and_nowhere_near_it():
    """f = 6 um: sideways a bead may go 20 um, towards the lens to z = r - f."""
    lens = {"map": "tan", "radius": "5 um", "focal_length": "6 um", "numerical_aperture": None}
    base = {"lens": lens, "simulation": {"loss_distance": 20e-6}}
    aside = bound("overdamped", "heun", 1e-4, start={"position": [8e-6, 0, 0]}, **base)
    states = aside.start(np.arange(20))
    aside.advance(states, np.arange(20), 0, np.empty((20, 1, 3)))
    assert np.isinf(states[:, -1]).all()
    near = bound("overdamped", "heun", 1e-2, start={"position": [0, 0, -5.49e-6]}, **base)
    states, out = near.start(np.arange(200)), np.empty((200, 1, 3))
    near.advance(states, np.arange(200), 0, out)
    lost = np.isfinite(states[:, -1])
    part = math.erfc(10e-9 / math.sqrt(4 * DIFFUSION * 1e-2))  # 10 nm away, also within the step
    assert abs(lost.sum() - 200 * part) < FAR * math.sqrt(200 * part * (1 - part))
    assert (out[~lost, 0, 2] > 0.5e-6 - 6e-6).all()


@pytest.mark.parametrize("model", ["full", "overdamped"])
def test_a_step_turns_the_bead_no_further_than_its_rotation_allows(model):
    diffusion = KT / BEAD.rotational_drag
    one = bound(model, "heun", 10.0, per_sample=1, forces={"brownian_torque": True})
    allowed = 0.25 if model == "overdamped" else 0.002
    assert one.step * diffusion <= allowed
    assert "rotational diffusion" in one.why


def test_steps_that_are_too_long_end_in_losses():
    stiff = walk_in(bound("full", "euler-maruyama", 30 * TAU, samples=3000), LinearTrap(STIFFNESS))
    states = stiff.start(np.arange(4))
    stiff.advance(states, np.arange(4), 0, np.empty((4, 2999, 6)))
    assert np.isfinite(states[:, -1]).all()


def test_a_force_that_is_not_finite_is_an_error():
    one = walk_in(bound("overdamped", "heun", 1e-6, samples=3), LinearTrap(math.nan))
    with pytest.raises(IntegrationError, match="not finite"):
        followed(one, 2)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"simulation": {"method": "harmonic"}}, "requires a stable equilibrium"),
        ({"start": {"drawn": "boltzmann"}}, "requires a stable equilibrium"),
        ({"simulation": {"duration": 1e5, "samples": 2, "step": 1e-6}}, "steps"),
    ],
)
def test_what_cannot_be_done_is_refused(changes, said):
    with pytest.raises(SceneError, match=said):
        walk(DARK.replace(**changes))


@pytest.mark.parametrize("seed", [-1, 2**63, 1.5, True])
def test_a_seed_is_a_whole_number(seed):
    with pytest.raises(SceneError, match="seed"):
        walk(DARK, seed)


def test_a_bead_at_rest_is_refused():
    with pytest.raises(SceneError, match="trajectories would be equal"):
        walk(DARK.replace(forces={"brownian": False}))


@cached_njit()
def _rising(pose, data, wrench):
    wrench.force[:] += pose.position + 1
    wrench.moment[:] += 10 * pose.position + np.array([1.0, 2.0, 3.0])


def test_the_light_turns_beads_about_every_axis():
    """u and omega are force and moment times their own mobilities."""
    one = batch.beads(2, 6, False, False, True)
    place = np.arange(48.0).reshape(6, 8)  # a row has room for eight

    class Field(Force):
        def compiled(self, *, gradient):
            return _rising, packed()

    plan = walk(DARK).plan._replace(mobility=np.arange(1.0, 7.0), load=np.full(6, 0.5))
    out = np.empty((6, 8))
    force = bound_force(Field(), gradient=False)
    batch.slow_velocities(force, plan, one, 0.0, place, out)
    x, out = place[:3, :2], out[:, :2]
    np.testing.assert_allclose(out[:3], plan.mobility[:3, None] * (x + 1.5))
    np.testing.assert_allclose(out[3:], plan.mobility[3:, None] * (10 * x + [[1], [2], [3]]))
