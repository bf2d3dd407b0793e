"""Thermal motion in a fluid with inertia: steps against the whole linear motion, and closed forms.

What two variables of a Gaussian motion have in common at all times is its law. So most is shown by
matrices, without sampling; where beads are sampled, seeds are fixed and the bounds are those that a
right program would exceed for one seed in the number given.
"""

import dataclasses
import math

import numpy as np
import pytest
from scipy.linalg import expm

import tweezer
from tests.dynamics.test_brownian import FAR, drawn_for, followed
from tests.reference.fields import LinearTrap, QuarticTrap, in_field, walk_in
from tests.reference.fluid import Sphere
from tweezer.dynamics import bind, integrate
from tweezer.dynamics.brownian import memory
from tweezer.dynamics.problem import bound_once
from tweezer.dynamics.walk import walk
from tweezer.fluid import modes
from tweezer.values.errors import SceneError

DARK = tweezer.load_scene("silica-1um").replace(
    forces={"brownian": True, "optical": False, "gravity": False, "buoyancy": False},
    start={"position": [0, 0, 0]}, medium={"inertia": "memory", "poles": 16},
    simulation={"model": "full", "method": "heun", "loss_distance": 1.0},
)  # fmt: skip
KT = 1.380649e-23 * DARK.medium.temperature
STIFFNESS = 6e-5
BEAD = tweezer.bead_properties(DARK)
SPHERE = Sphere(BEAD.mass, BEAD.drag, BEAD.displaced_mass)
TRAP = BEAD.drag / STIFFNESS
KAPPA = 1 / TRAP
DIFFUSION = KT / BEAD.drag
SPEED2 = KT / SPHERE.total_mass
STEPS = (1e-5, 1e-3, 0.01, 0.05, 0.1, 0.2, 1.0)


def modes_of(poles):
    return modes(BEAD.mass, BEAD.drag, BEAD.displaced_mass, poles)


def steps_of(h, poles, kappa, gone=memory.GONE):
    return memory.axis(h, *modes_of(poles), kappa, DIFFUSION, gone)


def as_matrices(one, kappa):
    """What a step leaves of (x, z), its noise (1 + n, 2), and x and v by (x, z)."""
    rows, n = one.z, one.z.shape[1]
    E, seen = np.zeros((n + 1, n + 1)), np.zeros((2, n + 1))
    E[0] = np.append(1 - one.x_by_u * kappa, rows[memory.X_BY])
    E[1:, 0] = -rows[memory.BY_U] * kappa
    E[1:, 1:] = np.diag(rows[memory.DECAY])
    noise = np.zeros((n + 1, 2))
    noise[0, 0] = one.noise_x
    noise[1:] = rows[[memory.NOISE, memory.OWN]].T
    seen[0, 0], seen[1, 1:] = 1.0, rows[memory.SEEN]
    return E, noise, seen


def stationary(E, noise):
    """Covariance X = E X E^T + noise noise^T, by doubling."""
    X = noise @ noise.T
    for _ in range(90):
        X, E = X + E @ X @ E.T, E @ E
    return X


def whole_motion(poles, kappa):
    """A of y' = A y, and (x, v) by y = (x, v_j) of variance 1."""
    times, parts = modes_of(poles)
    s, n = np.sqrt(kappa * parts / times), len(times)
    A, seen = np.zeros((n + 1, n + 1)), np.zeros((2, n + 1))
    A[0, 1:], A[1:, 0], A[1:, 1:] = s, -s, np.diag(-1 / times)
    seen[0, 0], seen[1, 1:] = math.sqrt(DIFFUSION / kappa), np.sqrt(DIFFUSION * parts / times)
    return A, seen


# --- the law of a step, without sampling ----------------------------------------------------------


@pytest.mark.parametrize("poles", [8, 16, 24, 36])
@pytest.mark.parametrize("step", STEPS)
def test_equipartition_at_any_step(poles, step):
    """Of the steps' own matrices: <x^2> = kT/k, <v^2> = kT/M, <x v> = 0."""
    E, noise, seen = as_matrices(steps_of(step * TRAP, poles, KAPPA), KAPPA)
    X = seen @ stationary(E, noise) @ seen.T
    assert abs(X[0, 0] * KAPPA / DIFFUSION - 1) < 1e-9
    assert abs(X[1, 1] / SPEED2 - 1) < 1e-9
    assert abs(X[0, 1]) < 1e-9 * math.sqrt(X[0, 0] * X[1, 1])


@pytest.mark.parametrize("step", STEPS)
def test_one_call_scheme_has_exact_moments_where_it_asks_the_force(step):
    """Of x* = x + (memory and noise)/2 in a harmonic trap, and of the velocity."""
    w = steps_of(step * TRAP, 16, 0.0)
    n = w.z.shape[1]
    E, noise, seen = np.zeros((n + 1, n + 1)), np.zeros((n + 1, 2)), np.zeros((2, n + 1))
    half = np.append(1.0, w.z[memory.X_BY] / 2)
    E[0] = 2 * half - np.append(1.0, np.zeros(n)) - KAPPA * w.x_by_u * half
    E[1:] = -KAPPA * np.outer(w.z[memory.BY_U], half)
    E[1:, 1:] += np.diag(w.z[memory.DECAY])
    noise[0, 0] = w.noise_x * (1 - KAPPA * w.x_by_u / 2)
    noise[1:] = w.z[[memory.NOISE, memory.OWN]].T
    noise[1:, 0] -= KAPPA * w.z[memory.BY_U] * w.noise_x / 2
    seen[0], seen[1, 1:] = half, w.z[memory.SEEN]
    X = seen @ stationary(E, noise) @ seen.T
    assert abs((X[0, 0] + w.noise_x**2 / 4) * KAPPA / DIFFUSION - 1) < 1e-9
    assert abs(X[1, 1] / SPEED2 - 1) < 1e-11


@pytest.mark.parametrize("poles", [16, 36])
@pytest.mark.parametrize("step", STEPS)
def test_places_and_velocities_have_the_covariances_of_the_whole_motion(poles, step):
    """<x x>, <x v>, <v x>, <v v> over 1 to 1000 steps: two numbers a step are noise enough."""
    E, noise, seen = as_matrices(steps_of(step * TRAP, poles, KAPPA), KAPPA)
    A, whole = whole_motion(poles, KAPPA)
    X = stationary(E, noise)
    scale = np.sqrt([DIFFUSION / KAPPA, SPEED2])
    for lag in (1, 2, 3, 10, 100, 1000):
        found = seen @ np.linalg.matrix_power(E, lag) @ X @ seen.T
        expected = whole @ expm(lag * step * TRAP * A) @ whole.T
        off = (found - expected) / np.outer(scale, scale)
        assert np.abs(off).max() < 2e-8


@pytest.mark.parametrize("step", STEPS)
def test_merging_what_is_gone_changes_nothing(step):
    merged = as_matrices(steps_of(step * TRAP, 24, KAPPA), KAPPA)
    apart = as_matrices(steps_of(step * TRAP, 24, KAPPA, gone=0.0), KAPPA)
    assert len(merged[0]) <= len(apart[0])
    assert len(merged[0]) < 20 or step < 1e-2
    for lag in (1, 3, 30, 300):
        found = [
            (seen @ np.linalg.matrix_power(E, lag) @ stationary(E, noise) @ seen.T)[0, 0]
            for E, noise, seen in (merged, apart)
        ]
        assert abs(found[0] - found[1]) * KAPPA / DIFFUSION < 3e-9


@pytest.mark.parametrize("kappa", [0.0, KAPPA])
@pytest.mark.parametrize("step", [1e-5, 1e-2, 0.2])
def test_the_thermal_start_is_stationary(kappa, step):
    """<z z^T> of the start is that which steps keep, with x of its own; free, of z alone."""
    one = steps_of(step * TRAP, 16, kappa)
    E, noise, seen = as_matrices(one, kappa)
    root = one.z[memory.ROOT :]
    X = np.zeros_like(E)
    X[0, 0], X[1:, 1:] = (DIFFUSION / kappa if kappa else 0.0), root @ root.T
    after = E @ X @ E.T + noise @ noise.T
    np.testing.assert_allclose(after[1:, 1:], X[1:, 1:], rtol=0, atol=1e-12)
    assert abs((seen @ after @ seen.T)[1, 1] / SPEED2 - 1) < 1e-12
    if kappa:
        assert abs(after[0, 0] / X[0, 0] - 1) < 1e-11
        assert np.abs(after[0, 1:]).max() < 1e-11 * math.sqrt(X[0, 0])


@pytest.mark.parametrize("step", [1e-4, 1e-2, 0.3])
def test_a_step_follows_the_force_as_the_modes_do(step):
    """From rest, under a constant slow velocity and one that rises; free, and in a trap."""
    h = step * TRAP
    times, parts = modes_of(16)
    n = len(times)
    for kappa in (0.0, KAPPA):
        one = steps_of(h, 16, kappa)
        seen = one.z[memory.SEEN]
        # (x, v_j, u beyond the spring, its rise)
        A = np.zeros((n + 3, n + 3))
        A[0, 1 : n + 1] = parts
        A[1 : n + 1, 0], A[1 : n + 1, n + 1] = -kappa / times, 1 / times
        A[1 : n + 1, 1 : n + 1] = np.diag(-1 / times)
        A[n + 1, n + 2] = 1 / h
        scale = np.concatenate([[h], np.ones(n + 2)])
        exact = expm(A * h * scale / scale[:, None]) * scale[:, None] / scale
        v = parts @ exact[1 : n + 1]
        for at, x_by, row in (
            (n + 1, one.x_by_u, memory.BY_U), (n + 2, one.x_by_rise, memory.BY_RISE),
        ):  # fmt: skip
            assert x_by == pytest.approx(exact[0, at], rel=1e-9)
            assert seen @ one.z[row] == pytest.approx(v[at], rel=1e-9)


def test_a_fall_lags_as_the_closed_form_says():
    """Many steps under a constant force, against the settling sphere."""
    h = 0.02 * TRAP
    one = steps_of(h, 24, 0.0)
    x, z = 0.0, np.zeros(one.z.shape[1])
    for number in range(1, 201):
        x += one.x_by_u + one.z[memory.X_BY] @ z
        z = one.z[memory.DECAY] * z + one.z[memory.BY_U]
        if number in (1, 5, 50, 200):
            assert x == pytest.approx(SPHERE.moved(number * h) * BEAD.drag, rel=5e-5)


@pytest.mark.parametrize("poles", [16, 24])
def test_the_autocorrelation_in_the_trap_is_the_closed_one(poles):
    E, noise, seen = as_matrices(steps_of(0.1 * TRAP, poles, KAPPA), KAPPA)
    X = stationary(E, noise)
    for lag in (1, 3, 10, 30):
        found = (seen @ np.linalg.matrix_power(E, lag) @ X @ seen.T)[0, 0] * KAPPA / DIFFUSION
        expected = SPHERE.relaxation(lag * 0.1 * TRAP, STIFFNESS)
        assert abs(found - expected) < (1e-4 if poles == 16 else 1e-5)


# --- compiled steps -------------------------------------------------------------------------------


def bound(step, *, method="heun", samples=2, per_sample=1, seed=1, field=None, kappa=0.0, **other):
    simulation = {
        "step": step, "samples": samples, "duration": step * per_sample * (samples - 1),
    } | other.pop("simulation", {})  # fmt: skip
    known = "heun" if method == "harmonic" else method
    one = walk(DARK.replace(simulation={"method": known} | simulation, **other), seed)
    scene = one.scene.model_copy(
        update={"simulation": one.scene.simulation.model_copy(update={"method": method})}
    )
    one = dataclasses.replace(one, problem=dataclasses.replace(one.problem, scene=scene))
    return one if field is None else walk_in(one, field, kappa)


@pytest.mark.parametrize("method", ["heun", "one-call", "harmonic"])
@pytest.mark.parametrize("step", [0.003, 0.3])
def test_a_compiled_step_is_that_of_the_weights(method, step):
    h = step * TRAP
    spring = 0.0 if method == "one-call" else KAPPA
    one = bound(h, method=method, field=LinearTrap(STIFFNESS), kappa=spring)
    w = steps_of(h, 16, spring)
    who, n = np.arange(70), w.z.shape[1]
    rng = np.random.default_rng(8)
    x, z = 1e-8 * rng.normal(size=(70, 3)), rng.normal(size=(70, 3, n))
    states = np.hstack([x, np.zeros((70, 3)), z.reshape(70, -1), np.full((70, 1), np.inf)])
    drawn = drawn_for(one.seed, who, 0, 6)
    way = z @ w.z[memory.X_BY] + w.noise_x * drawn[:, :3]
    u = -(x + way / 2 if method == "one-call" else x) * KAPPA
    left = w.z[memory.DECAY] * z + w.z[memory.BY_U] * u[..., None]
    left += w.z[memory.NOISE] * drawn[:, :3, None] + w.z[memory.OWN] * drawn[:, 3:, None]
    out = np.empty((70, 1, 6))
    one.advance(states, who, 0, out)
    after = x + way + w.x_by_u * u
    np.testing.assert_allclose(states[:, :3], after, rtol=1e-11, atol=1e-22)
    np.testing.assert_allclose(states[:, 6:-1].reshape(z.shape), left, rtol=1e-10, atol=1e-12)
    seen = x + way / 2 if method == "one-call" else after
    np.testing.assert_allclose(out[:, 0, :3], seen, rtol=1e-11, atol=1e-22)
    np.testing.assert_allclose(out[:, 0, 3:], left @ w.z[memory.SEEN], rtol=1e-9, atol=1e-16)


@pytest.mark.parametrize(("struck", "least"), [([0, 0, 0], 1.8), ([1e-2, 0, -2e-2], 1.3)])
def test_cold_bead_follows_the_deterministic_path_to_order_two(struck, least):
    """T -> 0: against the exponential method with memory, at 1e-12.

    The force on a struck bead rises like a root of the time until steps resolve the vorticity time.
    """
    field = QuarticTrap(STIFFNESS, STIFFNESS / (2e-7) ** 2)
    start = {"position": [2e-7, -1e-7, 1.5e-7], "velocity": struck}
    duration = 0.5 * TRAP
    warm = DARK.replace(
        forces={"brownian": False}, start=start,
        simulation={"method": "exponential", "duration": duration, "samples": 2,
                    "relative_tolerance": 1e-12, "position_tolerance": 1e-18},
    )  # fmt: skip
    equations = in_field(bind(bound_once(warm)), field)
    truth = integrate(equations, np.array([0.0, duration])).states[-1, :6]
    errors = []
    for steps in (40, 80, 160):
        one = bound(duration / steps, per_sample=steps, start=start)
        silent = one.weights.memory.copy()
        silent[:, [memory.NOISE, memory.OWN]] = 0.0
        silent[:, memory.ROOT :] = 0.0
        weights = one.weights._replace(noise_x=np.zeros(3), memory=silent)
        still = dataclasses.replace(one, weights=weights)
        still = dataclasses.replace(still, problem=walk_in(one, field).problem)
        end = followed(still, 1)[0, -1]
        errors.append(np.abs((end - truth) / np.repeat([1e-7, 1e-3], 3)).max())
    slopes = np.log2(np.divide(errors[:-1], errors[1:]))
    assert np.all((slopes > least) & (slopes < 2.8)), errors
    assert errors[-1] < 1e-3


# --- beads ----------------------------------------------------------------------------------------


def test_velocities_of_free_beads_forget_as_the_closed_form_says():
    """VACF and MSD from the thermal start, at steps that some modes outlive; one seed in 1e5."""
    n = 4000
    one = bound(0.3 * SPHERE.vorticity_time, samples=9, per_sample=3,
                medium={"poles": 24}, start={"drawn": "no"})  # fmt: skip
    scene = one.scene.model_copy(
        update={"start": one.scene.start.model_copy(update={"drawn": "boltzmann"})}
    )
    one = dataclasses.replace(one, problem=dataclasses.replace(one.problem, scene=scene))
    out = followed(one, n)
    x, v = out[..., :3], out[..., 3:]
    expected = SPHERE.velocity_correlation(one.times[1:])
    found = (v[:, 1:] * v[:, :1]).mean(axis=(0, 2)) / SPEED2
    spread = np.sqrt((1 + expected**2) / (3 * n))
    assert np.all(np.abs(found - expected) < FAR * spread)
    energy = (v**2).mean(axis=(0, 2)) / SPEED2
    assert np.all(np.abs(energy - 1) < FAR * math.sqrt(2 / (3 * n)))
    msd = ((x - x[:, :1]) ** 2).mean(axis=(0, 2))[1:]
    expected = SPHERE.mean_squared_displacement(one.times[1:], DARK.medium.temperature)
    assert np.all(np.abs(msd / expected - 1) < FAR * math.sqrt(2 / (3 * n)))


def test_released_at_rest_in_a_warm_fluid():
    """<x^2> is the thermal one less what the velocity at the start would have added."""
    n = 6000
    one = bound(0.5 * SPHERE.vorticity_time, samples=6, per_sample=4, medium={"poles": 24})
    states = one.start(np.arange(n))
    assert np.abs(states[:, 3:6]).max() < 1e-15
    x = followed(one, n)[:, 1:, :3]
    t = one.times[1:]
    expected = SPHERE.mean_squared_displacement(t, DARK.medium.temperature)
    # <x(t) v(0)> = kT times the way of a constant force's velocity: the settling speed
    expected = expected - KT * SPHERE.total_mass * SPHERE.settling(t) ** 2
    found = (x**2).mean(axis=(0, 2))
    assert np.all(np.abs(found / expected - 1) < FAR * math.sqrt(2 / (3 * n)))


def test_a_struck_bead_has_its_velocity_and_loses_it_as_the_closed_form_says():
    struck = [3.0, -2.0, 1.0]
    n = 4000
    one = bound(0.4 * SPHERE.vorticity_time, samples=4, start={"velocity": struck},
                medium={"poles": 24})  # fmt: skip
    out = followed(one, n)
    np.testing.assert_allclose(out[:, 0, 3:], np.tile(struck, (n, 1)), rtol=1e-10)
    fall = SPHERE.velocity_correlation(one.times)
    for k in (1, 2, 3):
        off = out[:, k, 3:].mean(axis=0) - fall[k] * np.array(struck)
        assert np.abs(off).max() < FAR * math.sqrt(SPEED2 / n) + 1e-5


def test_scheme_of_the_trap_is_stationary_also_where_its_spring_couples():
    """Circular light pushes round the axis; moments at the start and after: one seed in 1e5."""
    n = 20_000
    one = walk(
        tweezer.load_scene("silica-1um").replace(
            forces={"brownian": True}, start={"drawn": "boltzmann"},
            optics={"evaluator": "map", "table_tolerance": 1e-5},
            simulation={"model": "full", "duration": 2e-4, "samples": 3},
        ), 5,
    )  # fmt: skip
    assert one.scene.medium.inertia == "memory"
    out = followed(one, n)
    x = out[..., :3] - np.array(one.equilibrium.position)
    kT = 1.380649e-23 * one.scene.medium.temperature
    variance = kT / np.diag(one.equilibrium.stiffness)
    bead = tweezer.bead_properties(one.scene)
    mass = bead.mass + bead.displaced_mass / 2
    for k in range(3):
        energy = (out[:, k, 3:] ** 2).mean(axis=0) * mass / kT
        assert np.abs(energy - 1).max() < FAR * math.sqrt(2 / n)
        assert np.abs(x[:, k].var(axis=0) / variance - 1).max() < FAR * math.sqrt(2 / n) + 5e-3


# --- what it is, and what it is not ---------------------------------------------------------------


def test_a_fluid_without_mass_has_no_memory(monkeypatch):
    """The same bytes as `inertia = "none"`."""
    plain = bound(0.1 * TRAP, samples=4, medium={"inertia": "none", "poles": None})
    scene = plain.scene
    light = dataclasses.replace(BEAD, displaced_mass=0.0)
    monkeypatch.setattr("tweezer.dynamics.problem.bead_properties", lambda _: light)
    remembered = walk(scene.replace(medium={"inertia": "memory", "poles": 16}), 1)
    assert "memory" not in remembered.layout
    assert np.array_equal(followed(plain, 20), followed(remembered, 20))


def test_added_mass_is_one_mode():
    one = bound(0.1 * TRAP, medium={"inertia": "added-mass", "poles": None})
    assert "memory" not in one.layout
    assert one.plan.tau == pytest.approx(SPHERE.total_mass / BEAD.drag, rel=1e-14)


def test_what_is_open_is_decided_and_told():
    scene = DARK.replace(medium={"inertia": None, "poles": None}, simulation={"model": None})
    one = walk(scene)
    assert (one.scene.medium.inertia, one.scene.medium.poles) == ("memory", 24)
    assert "the fluid remembers, by 24 poles" in one.why
    for model, method in (("full", "baoab"), ("overdamped", "heun"), ("scaled", "heun")):
        simulation = {"model": model, "method": method, "scaling_factor": 0.1, "step": 1e-7}
        one = walk(scene.replace(simulation=simulation))
        assert one.scene.medium.inertia == "none"
        assert "memory" not in one.layout
        assert "no inertia of the fluid" in one.why


def test_named_where_it_cannot_be_it_is_refused():
    light = tweezer.load_scene("silica-1um").replace(
        forces={"brownian": True}, medium={"inertia": "memory"},
        simulation={"model": "full", "method": "harmonic"},
    )  # fmt: skip
    with pytest.raises(SceneError, match=r"couples the axes; must be none or added-mass; set"):
        walk(light)
    with pytest.raises(SceneError, match="baoab"):
        walk(DARK.replace(simulation={"method": "baoab"}))


@pytest.mark.parametrize("method", ["heun", "one-call"])
def test_a_rotation_keeps_its_one_mode(method):
    """The numbers that turn it are the same with memory as without."""
    turning = {"forces": {"brownian_torque": True}, "method": method, "samples": 3}
    with_memory = followed(bound(1e-8, **turning), 30)
    without = followed(bound(1e-8, medium={"inertia": "none", "poles": None}, **turning), 30)
    assert np.array_equal(with_memory[..., 6:], without[..., 6:])
    assert not np.array_equal(with_memory[..., :3], without[..., :3])


@pytest.mark.parametrize("method", ["heun", "one-call", "harmonic"])
def test_paths_do_not_depend_on_company_or_cuts(method):
    one = bound(0.1 * TRAP, method=method, samples=9, field=LinearTrap(STIFFNESS),
                kappa=0.0 if method == "one-call" else KAPPA, per_sample=3)  # fmt: skip
    together = followed(one, 130)
    for first, n in ((0, 1), (5, 64), (100, 30)):
        assert np.array_equal(followed(one, n, first), together[first : first + n])
    states, parts = one.start(np.arange(3)), np.empty((3, 9, 6))
    parts[:, 0] = one.seen(states)
    for begin, end in ((0, 1), (1, 4), (4, 8)):
        states = states.copy()
        one.advance(states, np.arange(3), begin, parts[:, begin + 1 : end + 1])
    assert np.array_equal(parts, together[:3])
