"""Motion in viscoelastic media, against closed forms and the Lyapunov equation of a step."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import tweezer
from tests.reference.fields import LinearTrap
from tweezer.dynamics.brownian import memory, viscoelastic
from tweezer.dynamics.problem import bound_once
from tweezer.values.constants import Boltzmann
from tweezer.values.errors import SceneError

SCENE = tweezer.load_scene("silica-1um")
DARK = SCENE.replace(forces={"optical": False, "gravity": False, "buoyancy": False})
KT = Boltzmann * SCENE.medium.temperature
STIFFNESS, START = 2e-5, 0.3e-6
JEFFREYS = {"relaxing": [{"viscosity": "4 mPa s", "time": "5 ms"}]}
POWER = {
    "power_law": {"exponent": 0.6, "modulus": "0.05 Pa", "at": "0.159 Hz",
                  "band": ["1 Hz", "1 MHz"]}
}  # fmt: skip


def in_medium(medium: dict[str, Any], model: str, **changes: Any) -> tweezer.Scene:
    return DARK.replace(
        medium=medium, simulation={"model": model, "duration": "20 ms", "samples": 41}, **changes
    )


def decaying(numerator: list[float], denominator: list[float], times: np.ndarray) -> np.ndarray:  # type: ignore[type-arg]
    """Inverse Laplace transform of a rational function with simple poles."""
    poles = np.roots(denominator)
    parts = np.polyval(numerator, poles) / np.polyval(np.polyder(denominator), poles)
    return (np.exp(np.multiply.outer(times, poles)) @ parts).real


@pytest.mark.parametrize("model", ["full", "overdamped"])
def test_bead_in_jeffreys_fluid_relaxes_as_in_closed_form(model: str) -> None:
    start = {"position": [START, 0, 0]}
    scene = in_medium(JEFFREYS | {"inertia": "none"}, model, start=start)
    run = tweezer.simulate(scene, forces=[LinearTrap(STIFFNESS)])
    beta = tweezer.bead_properties(scene).drag
    b, t = beta * 4e-3 / scene.medium.viscosity, 5e-3
    mass = tweezer.bead_properties(scene).mass if model == "full" else 0.0
    # (m s + beta + b/(1 + s t))(s x - x0) = -k x, times 1 + s t
    drag = np.polyadd(np.polymul([mass, beta], [t, 1]), [b])
    whole = np.polyadd(np.polymul([1, 0], drag), STIFFNESS * np.array([t, 1]))
    expected = START * decaying(drag.tolist(), np.trim_zeros(whole, "f").tolist(), run.time.values)
    assert np.abs(run.position.sel(axis="x").values - expected).max() < 1e-12
    assert run.integration_error < 1e-10


def test_bead_in_gel_creeps_to_the_balance_of_springs() -> None:
    start = {"position": [START, 0, 0]}
    medium = {"elasticity": "1 Pa", "inertia": "none"}
    scene = in_medium(medium, "overdamped", start=start)
    run = tweezer.simulate(scene, forces=[LinearTrap(STIFFNESS)])
    beta = tweezer.bead_properties(scene).drag
    g = 6 * np.pi * 0.5e-6 * 1.0
    t = run.time.values
    expected = START * (g + STIFFNESS * np.exp(-(g + STIFFNESS) * t / beta)) / (g + STIFFNESS)
    assert np.abs(run.position.sel(axis="x").values - expected).max() < 1e-12


def test_gel_at_the_trap_leaves_the_equilibrium() -> None:
    plain, gel = (
        bound_once(SCENE.replace(medium=each)).equilibrium
        for each in ({}, {"elasticity": "1 Pa", "anchor": "trap"})
    )
    assert plain is not None
    assert gel is not None
    assert gel.position == pytest.approx(plain.position, abs=1e-12)
    more = np.diag(gel.stiffness) - np.diag(plain.stiffness)
    assert more == pytest.approx(6 * np.pi * 0.5e-6, rel=1e-6)


CASES = {
    "Jeffreys": (JEFFREYS | {"inertia": "none"}, "overdamped", 1e-10),
    "Jeffreys with mass": (JEFFREYS | {"inertia": "none"}, "full", 1e-10),
    "Jeffreys with fluid inertia": (JEFFREYS | {"inertia": "memory"}, "full", 1e-10),
    "power law": (POWER, "overdamped", 1e-10),
}


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("part", [1e-3, 0.05, 1.0, 30.0])
def test_step_is_exact_in_a_trap(name: str, part: float) -> None:
    medium, model, allowed = CASES[name]
    network = bound_once(in_medium(medium, model)).network
    assert network is not None
    kappa, diffusion = STIFFNESS / network.drag, KT / network.drag
    h = part / kappa
    axis = viscoelastic.axis(h, network, kappa, diffusion)
    z, n = axis.z, axis.z.shape[1]
    A, noise = np.zeros((n + 1, n + 1)), np.zeros((n + 1, 2))
    A[0, 0], A[0, 1:] = 1 - axis.x_by_u * kappa, z[memory.X_BY]
    A[1:, 0], A[1:, 1:] = -kappa * z[memory.BY_U], np.diag(z[memory.DECAY])
    noise[0, 0], noise[1:] = axis.noise_x, z[[memory.NOISE, memory.OWN]].T
    covariance, power = noise @ noise.T, A.copy()
    while np.abs(power).max() > 1e-18:
        covariance, power = covariance + power @ covariance @ power.T, power @ power
    assert covariance[0, 0] == pytest.approx(KT / STIFFNESS, rel=allowed)
    relaxation = network.relaxation(STIFFNESS)
    for many in (1, 3, 20):
        found = (np.linalg.matrix_power(A, many) @ covariance)[0, 0] * STIFFNESS / KT
        assert found == pytest.approx(relaxation.at(np.array([many * h]))[0], abs=allowed)
    if network.mass:
        seen = z[memory.SEEN]
        assert seen @ covariance[1:, 1:] @ seen == pytest.approx(KT / network.mass, rel=1e-9)
    else:
        assert not z[memory.OWN].any()


def test_start_is_stationary() -> None:
    network = bound_once(in_medium(JEFFREYS | {"inertia": "none"}, "full")).network
    assert network is not None
    axis = viscoelastic.axis(1e-5, network, 0.0, KT / network.drag)
    z, root = axis.z, axis.z[memory.ROOT :]
    hidden = root @ root.T
    decayed = z[memory.DECAY][:, None] * hidden * z[memory.DECAY]
    drawn = z[[memory.NOISE, memory.OWN]]
    assert hidden == pytest.approx(decayed + drawn.T @ drawn, abs=1e-9)


def test_free_beads_spread_as_the_medium_lets_them() -> None:
    # 3 x 600 squares: a relative standard error of 0.033. Five of them fail once in 2e6 seeds
    for model in ("full", "overdamped"):
        scene = in_medium(JEFFREYS, model, forces={"brownian": True})
        scene = scene.replace(simulation={"step": "1 ms", "samples": 3})
        found = tweezer.ensemble(scene, 600, seed=5).position.values
        moved = found[:, 1:] - found[:, :1]
        times = np.array([10e-3, 20e-3])
        expected = tweezer.response(scene, times).msd_free.values
        assert (moved**2).mean(axis=(0, 2)) == pytest.approx(expected, rel=0.17)


def test_bead_that_rings_is_refused_in_one_line() -> None:
    medium = {"relaxing": [{"viscosity": "100 mPa s", "time": "1 us"}], "inertia": "none"}
    scene = in_medium(medium, "full")
    with pytest.raises(SceneError, match=r"medium\.relaxing: the bead rings by itself at") as error:
        tweezer.simulate(scene)
    assert "set simulation.model to overdamped" in str(error.value)
    assert tweezer.chosen(in_medium(JEFFREYS, "full"))[0].medium.inertia == "memory"


def test_run_continues_with_the_same_hidden_variables() -> None:
    scene = in_medium(JEFFREYS, "overdamped", forces={"brownian": True})
    whole = tweezer.simulate(scene, seed=2)
    half = tweezer.simulate(scene.replace(simulation={"samples": 21}), "10 ms", seed=2)
    rest = tweezer.simulate(scene, "10 ms", continue_from=half)
    assert rest.position.values[-1] == pytest.approx(whole.position.values[-1], rel=1e-12)
