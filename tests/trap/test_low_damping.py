"""Equilibria of beads with inertia: whether drag is enough for them to come to rest."""

import csv
import json
import math

import numpy as np
import pytest
from scipy.optimize import newton

import tweezer
from tests.low_damping import OFF, OUTCOME, cases, compared, scene
from tweezer.dynamics import bound_once
from tweezer.dynamics.linear import LinearMotion
from tweezer.sweeps.quantities import values_of


@pytest.mark.parametrize(
    ("light", "viscosity"),
    [("linear", 1e-6), ("circular", 1e-6), ("circular", 9e-7), ("vortex", 1e-7), ("vortex", 1e-4)],
)
def test_equilibrium_is_stable_if_matrix_and_run_agree(light, viscosity):
    found = compared(light, viscosity)
    assert found.agrees, found


def test_forty_scenes_agree():
    """`python -m tests.low_damping` computes them again."""
    with OUTCOME.open() as file:
        rows = list(csv.DictReader(file))
    assert [(row["light"], float(row["viscosity"])) for row in rows] == [
        (light, pytest.approx(viscosity, rel=1e-3)) for light, viscosity in cases(40)
    ]
    for row in rows:
        assert (row["stable"] == "True") == (float(row["growth"]) < 0) == (float(row["run"]) < 1)
    assert 5 < sum(row["stable"] == "False" for row in rows) < 35


def test_bead_that_spirals_out_is_not_held():
    of = scene("circular", 5e-7)
    trap = tweezer.characterise(of)
    assert trap.equilibrium is None
    assert trap.lifetime is None
    place = min(trap.equilibria, key=lambda each: abs(each.position[2]))
    assert place.spiral_rate == pytest.approx(14793, rel=1e-3)
    assert place.eigenvalues.min() > 0
    assert "too little drag lets the push of the light round the axis drive it out" in trap.reason
    values = values_of(trap, trap.scene.medium.temperature)
    assert values["outcome"] == "not held"
    assert values["reason"] == trap.reason
    # so soon it has not gone far: a run ends beside the place, and is not captured all the same
    start = place.position + np.array([OFF, 0, 0])
    run = tweezer.simulate(of.replace(start={"position": start.tolist()}), "20 us")
    summary = tweezer.summarise(run)
    assert summary.outcome == "not captured"
    assert summary.untold == "; no stable equilibrium within 0.025 um of its end"
    of = of.replace(simulation={"model": "overdamped"})
    assert tweezer.characterise(of).equilibrium is not None  # without inertia it comes to rest


def test_bead_that_swings_has_resonances_and_no_lifetime():
    of = scene("linear", 1e-6)
    trap = tweezer.characterise(of)
    mass = bound_once(of).bead.mass
    k = trap.stiffness_xyz
    assert np.isnan(trap.corner_frequencies).all()
    assert trap.resonance_frequencies == pytest.approx(np.sqrt(k / mass) / (2 * math.pi))
    assert trap.quality_factors == pytest.approx(np.sqrt(k * mass) / trap.drag)
    assert trap.lifetime is None
    assert "Kramers's regime of low friction" in trap.lifetime_caveat
    text = repr(trap)
    assert "resonance frequencies" in text
    assert "corner frequencies" not in text
    values = values_of(trap, trap.scene.medium.temperature)
    assert np.isnan(values["corner_frequency"]).all()
    assert values["quality_factor"] == pytest.approx(trap.quality_factors)
    assert math.isnan(values["lifetime"])
    assert "Kramers" in values["caveat"]
    json.dumps(values)
    thick = tweezer.characterise(scene("linear", 1e-3))
    assert np.isnan(thick.resonance_frequencies).all()
    assert thick.corner_frequencies == pytest.approx(k / thick.drag / (2 * math.pi))
    assert thick.lifetime is not None


def test_spiral_with_the_memory_of_the_fluid():
    """The root of s (m s + gamma(s)) + kappa = 0 with the exact drag, whose root is no sum."""
    mass, displaced, drag, k, turn = 7e-17, 2e-17, 1e-12, 2e-5, 5e-6
    vorticity = 4.5 * displaced / drag
    kappa = complex(k, -turn)

    def balance(s):
        gamma = drag * (1 + np.sqrt(s * vorticity) + s * vorticity / 9)
        return s * (mass * s + gamma) + kappa

    swing = math.sqrt(k / (mass + displaced / 2))
    exact = max(newton(balance, sign * 1j * swing, maxiter=200).real for sign in (1, -1))
    K = np.array([[k, turn, 0], [-turn, k, 0], [0, 0, k]])
    found = LinearMotion(mass, displaced, 40).spiral_rate(K, np.full(3, 1 / drag))
    assert exact > 0
    assert found == pytest.approx(exact, rel=2e-3)
    still = LinearMotion(mass, displaced, 40).spiral_rate(K, np.full(3, 0.05 / drag))
    assert still == 0


def test_spiral_rates_of_the_models():
    rng = np.random.default_rng(4)
    mass, grows = 1e-16, 0
    for scaling in (1.0, 0.1):
        for _ in range(30):
            K = 1e-5 * (np.diag(rng.uniform(1, 2, 3)) + rng.uniform(-1, 1, (3, 3)))
            if np.linalg.eigvals(K).real.min() <= 0:
                continue
            mobility = rng.uniform(1, 2, 3) * 10 ** rng.uniform(9, 12)  # as beside a wall
            unit = math.sqrt(1e-5 / mass * scaling)
            matrix = np.block(
                [
                    [np.zeros((3, 3)), np.eye(3)],
                    [-K / mass * scaling / unit**2, -np.diag(scaling / mass / mobility) / unit],
                ]
            )
            growth = max(np.linalg.eigvals(matrix).real.max() * unit, 0.0)
            found = LinearMotion(mass, scale=scaling).spiral_rate(K, mobility)
            assert found == pytest.approx(growth, rel=1e-6, abs=1e-9 * unit)
            grows += growth > 0
    assert 5 < grows < 50
    K = np.array([[1e-5, 4e-5, 0], [-4e-5, 1e-5, 0], [0, 0, 1e-5]])
    assert LinearMotion(0.0).spiral_rate(K, np.full(3, 1e12)) == 0
    # of q' = u - tau (Du) u, which is -(kappa + tau kappa^2) q
    tau, kappa = 5e-8, 1e12 * (1e-5 + 4e-5j)
    first = LinearMotion(0.0, expansion_time=tau).spiral_rate(K, np.full(3, 1e12))
    assert first == pytest.approx(-(kappa + tau * kappa**2).real)
    # a spring far slower than the relaxation of the velocity is stable in spite of rounding
    thick = LinearMotion(1e-16).spiral_rate(1e-4 * K, np.full(3, 1e3))
    assert thick == 0
