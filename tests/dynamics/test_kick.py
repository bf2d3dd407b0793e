"""Kicks between exact swings: the step, its order, energy without damping, thermal energy.

Seeds are fixed; a right program would exceed a stochastic bound for one seed in a million.
"""

import dataclasses
import math

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.linalg import expm

from tests.dynamics.test_brownian import BEAD, DARK, FAR, KT, STIFFNESS, drawn_for, followed
from tests.dynamics.test_step_bias import SWING, Whirl, levitated
from tests.reference.fields import LinearTrap, QuarticTrap
from tweezer.dynamics import bound_once
from tweezer.dynamics.brownian import propagator
from tweezer.dynamics.walk import walk

#: Quartic well, k x^2/2 + c x^4/4, with c <x^2> = 0.25 k for the harmonic <x^2>
QUARTIC = 0.25 * STIFFNESS**2 / KT
#: Change of a scene to a thin gas
THIN = {
    "medium": {"name": "air", "pressure": "1 mbar"}, "lens": {"numerical_aperture": 0.8},
}  # fmt: skip


def in_well(field, quality, **simulation):
    """Return a bead in a field and a medium of that quality factor, by kicks."""
    viscosity = levitated(1.0, 60).scene.medium.viscosity / quality
    given = {"model": "full", "method": "kick", "duration": 1e-4, "samples": 2} | simulation
    scene = DARK.replace(medium={"viscosity": viscosity}, simulation=given)
    return walk(bound_once(scene, [field]))


def without_damping(depth, per_period, periods, samples):
    """Return kicks in a Gaussian well of that depth, kT, without drag and noise."""
    step = 2 * math.pi * SWING / per_period
    given = {"step": 1.0001 * step, "duration": periods * per_period * step, "samples": samples}
    one = levitated(1e6, depth, method="kick", **given)
    none = 1e-9
    tau, kappa = one.plan.tau / none, one.weights.kappa / none
    return dataclasses.replace(
        one,
        plan=one.plan._replace(tau=tau, mobility=one.plan.mobility / none),
        weights=propagator.exact(one.step / 2, tau, kappa, np.zeros_like(tau)),
        edge=one.edge._replace(margin=0.0),
    )


def energies(states, depth):
    """Return the energy of states in a Gaussian well, kT."""
    away = (states[..., :3] ** 2).sum(axis=-1) * STIFFNESS / KT
    moving = (states[..., 3:6] ** 2).sum(axis=-1) * BEAD.mass / KT
    return moving / 2 - depth * np.expm1(-away / (2 * depth))


def released(one, beads, energy, samples, seed=5):
    """Return initial and later energies of beads of about `energy`, kT, in a well of 20 kT."""
    rng, part = np.random.default_rng(seed), math.sqrt(energy / 3)
    states = one.start(np.arange(beads))
    states[:, :3] = part * math.sqrt(KT / STIFFNESS) * rng.choice([-1, 1], (beads, 3))
    states[:, 3:6] = part * math.sqrt(KT / BEAD.mass) * rng.choice([-1, 1], (beads, 3))
    begun = energies(states, 20)
    out = np.empty((beads, samples - 1, 6))
    one.advance(states, np.arange(beads), 0, out)
    return begun, energies(out, 20)


def test_step_is_two_swings_between_three_kicks():
    """A compiled step agrees with matrix exponentials, for a spring other than the trap's."""
    h = 0.9 * SWING
    one = in_well(LinearTrap(STIFFNESS), 2.0, step=h, duration=h)
    tau = one.plan.tau[0]
    who, rng = np.arange(70), np.random.default_rng(9)
    x = rng.normal(size=(70, 3)) * math.sqrt(KT / STIFFNESS)
    v = rng.normal(size=(70, 3)) * math.sqrt(KT / BEAD.mass)
    other = dataclasses.replace(
        one, problem=dataclasses.replace(one.problem, others=(LinearTrap(1.5 * STIFFNESS),))
    )
    states, out = np.hstack([x, v, np.full((70, 1), np.inf)]), np.empty((70, 1, 6))
    other.advance(states, who, 0, out)

    swing = np.array([[0, 1], [-STIFFNESS / BEAD.mass, -1 / tau]])
    spread = np.array([[0, 0], [0, 2 * KT / BEAD.mass / tau]])
    both = expm(h / 2 * np.block([[-swing, spread], [np.zeros((2, 2)), swing.T]]))
    left = both[2:, 2:].T
    root = np.linalg.cholesky(left @ both[:2, 2:])
    drawn = drawn_for(one.seed, who, 0, 12)

    def kicked(x, v, part):
        return v - part * h * 0.5 * STIFFNESS / BEAD.mass * x

    for i in range(2):
        v = kicked(x, v, (1 / 6, 2 / 3)[i])
        n = drawn[:, 6 * i : 6 * i + 3], drawn[:, 6 * i + 3 : 6 * i + 6]
        x, v = (left[j, 0] * x + left[j, 1] * v + root[j, 0] * n[0] + root[j, 1] * n[1]
                for j in range(2))  # fmt: skip
    np.testing.assert_allclose(out[:, 0, :3], x, rtol=1e-9, atol=1e-20)
    np.testing.assert_allclose(out[:, 0, 3:], kicked(x, v, 1 / 6), rtol=1e-9, atol=1e-16)


def test_energy_does_not_drift_without_damping():
    """Over 2e4 periods in 20 kT the energy of each bead stays within 5e-5, and its mean in 1e-6."""
    samples = 401
    begun, later = released(without_damping(20, 16, 20_000, samples), 8, 1.5, samples)
    off = later / begun[:, None] - 1
    assert np.abs(off).max() < 5e-5
    drift = off[:, -100:].mean(axis=1) - off[:, :100].mean(axis=1)
    assert np.abs(drift).max() < 1e-6


def test_energy_error_has_order_four_in_a_nearly_harmonic_well():
    """The rest of the force is a small part of it, so that e h^4 is left."""
    sizes = []
    for per_period in (12, 24):
        begun, later = released(without_damping(20, per_period, 200, 401), 8, 0.05, 401)
        sizes.append(np.abs(later / begun[:, None] - 1).max())
    assert 3.7 < math.log2(sizes[0] / sizes[1]) < 4.4


@pytest.mark.parametrize("quality", [2.0, 10.0])
def test_thermal_energy_in_a_quartic_well(quality):
    """<x^2>, <x^4> and <v^2> follow Boltzmann's distribution."""
    relaxation = quality * SWING
    one = in_well(
        QuarticTrap(STIFFNESS, QUARTIC), quality, duration=(6 + 60 / quality) * relaxation,
        samples=61,
    )  # fmt: skip
    found = followed(one, 2000)[:, 20:]

    def weight(r):
        return math.exp(-r * r / 2 - 0.25 * r**4 / 4)

    total = quad(weight, -9, 9)[0]
    for power in (2, 4):
        exact = quad(lambda r, power=power: r**power * weight(r), -9, 9)[0] / total
        scaled = found[..., :3] * math.sqrt(STIFFNESS / KT)
        of_each = (scaled**power).mean(axis=(1, 2)) / exact
        assert abs(of_each.mean() - 1) < FAR * of_each.std() / math.sqrt(len(of_each))
    of_each = (found[..., 3:] ** 2).mean(axis=(1, 2)) * BEAD.mass / KT
    assert abs(of_each.mean() - 1) < FAR * of_each.std() / math.sqrt(len(of_each))


def test_force_round_the_axis_grows_or_decays_at_its_rate():
    """Without noise a bead spirals at the root of m l^2 + beta l + k +- i c = 0."""
    quality, share = 200.0, 0.02
    rate = 1 / (quality * SWING)
    root = np.roots([1, rate * SWING, 1 + 1j * share])
    growth = root.real.max() / SWING
    assert growth > 0
    one = in_well(
        Whirl(STIFFNESS, share * STIFFNESS), quality, duration=2 / growth, samples=401,
        step=0.1 * SWING,
    )  # fmt: skip
    still = np.zeros_like(one.plan.tau)
    calm = one.weights._replace(noise_x=still, noise_xv=still, noise_v=still)
    one = dataclasses.replace(one, weights=calm, edge=one.edge._replace(margin=0.0))
    states = one.start(np.arange(1))
    states[:, :2] = 0.1 * math.sqrt(KT / STIFFNESS)
    out = np.empty((1, 400, 6))
    one.advance(states, np.arange(1), 0, out)
    energy = (out[0, :, :2] ** 2).sum(axis=1) + (out[0, :, 3:5] ** 2).sum(axis=1) * SWING**2
    measured = np.polyfit(one.times[201:], np.log(energy[200:]), 1)[0] / 2
    assert measured == pytest.approx(growth, rel=2e-3)


@pytest.mark.parametrize(
    ("changes", "stiffness", "method"),
    [
        (THIN, STIFFNESS, "kick"),
        (THIN, 1e-9 * STIFFNESS, "heun"),
        ({"medium": {"name": "water", "inertia": "none"}}, STIFFNESS, "heun"),
        (THIN | {"simulation": {"model": "overdamped"}}, STIFFNESS, "heun"),
        (
            {
                "medium": {"inertia": "none"},
                "simulation": {"model": "full", "scaling_factor": 1e-6},
            },
            STIFFNESS,
            "heun",
        ),
    ],
)
def test_auto_kicks_a_bead_that_oscillates(changes, stiffness, method):
    one = walk(bound_once(DARK.replace(**changes), [LinearTrap(stiffness)]))
    assert one.scene.simulation.method == method
    assert ("keep its energy" in one.why) == (method == "kick")


def test_auto_follows_a_force_that_depends_on_the_orientation_by_heun():
    class Turning(LinearTrap):
        oriented = True

    one = walk(bound_once(DARK.replace(**THIN), [Turning(STIFFNESS)]))
    assert one.scene.simulation.method == "heun"


def test_step_at_low_damping_is_not_limited_by_diffusion():
    """<x^2> grows as kT/m t^2 within a swing, however large kT/beta is."""
    steps = [levitated(Q, 60).step for Q in (1e2, 1e6)]
    assert steps[0] == pytest.approx(steps[1], rel=1e-6)
