"""Velocities that relax to the force's, and the regions in which it is smooth."""

import math

import mpmath as mp
import numpy as np
import pytest
import scipy.linalg

import tweezer
from tests.reference.fields import in_trap
from tweezer.compiled import cached_njit
from tweezer.dynamics import bind, integrators
from tweezer.dynamics.integrators.modes import NODES, relaxed
from tweezer.dynamics.solution import Solver
from tweezer.fluid import Modes
from tweezer.forces.composed import Course, Moved, Sum
from tweezer.forces.force import evaluated, numbered
from tweezer.optics import light_force


@cached_njit()
def _relaxed(s, tau, out):
    relaxed(s, tau, out)


@pytest.mark.parametrize("ratio", [1e-9, 0.1, 3.99, 4.01, 50.0, 1e6])
def test_functions_of_a_mode_against_mpmath(ratio):
    """chi_m(z) = 1/m! - phi_m(z), with phi_m as an integral of the exponential."""
    found = np.empty(NODES + 1)
    _relaxed(ratio * 3e-8, 3e-8, found)
    with mp.workdps(120):
        phi, expected = mp.exp(-mp.mpf(ratio)), []
        for m in range(NODES + 1):
            expected.append(float(1 / mp.factorial(m) - phi))
            phi = (phi - 1 / mp.factorial(m)) / -mp.mpf(ratio)
    np.testing.assert_allclose(found, expected, rtol=2e-14)


def test_a_mode_without_inertia_follows_at_once():
    found = np.empty(NODES + 1)
    _relaxed(1e-7, 0.0, found)
    np.testing.assert_allclose(found, [1 / math.factorial(m) for m in range(NODES + 1)], rtol=1e-15)


def test_a_sum_of_modes_in_a_linear_trap():
    """Against the matrix exponential, along the motion of a bead struck at the begin."""
    scene = tweezer.load_scene("thesis-990nm").replace(
        start={"frame": "focus", "position": [1e-7, -2e-7, 3e-7], "velocity": [1e-4, 0, -2e-4]},
        forces={"gravity": False, "buoyancy": False},
        simulation={"model": "full", "method": "exponential", "relative_tolerance": 1e-11,
                    "position_tolerance": 1e-17},
    )  # fmt: skip
    stiffness = 2e-5
    equations = in_trap(bind(scene), stiffness)
    rate = stiffness / equations.bead.drag
    times, weights = np.array([30.0, 1.0, 0.01]) * 1e-6, np.array([0.3, 0.5, 0.2])
    relaxation = equations.relaxation._replace(
        modes=Modes(np.tile(times, (3, 1)), np.tile(weights, (3, 1)))
    )
    equations.__dict__["relaxation"] = relaxation
    end = 2.5 / rate
    solver, pieces = Solver(equations, "exponential", end=end), []
    while not pieces or pieces[-1][1] == integrators.FULL:
        pieces.append(solver.advance())
    # x' = sum a_i v_i, v_i' = (-rate x - v_i)/tau_i
    matrix = np.vstack([[0.0, *weights], np.column_stack([-rate / times, -np.diag(1 / times)])])
    struck = 1 / times / (weights / times).sum()
    for t in np.linspace(0, end, 40)[1:]:
        step = scipy.linalg.expm(t * matrix)
        piece = next(each for each, _ in pieces if t <= each.end)
        found = piece.states(np.array([t]))[0]
        for i in range(3):
            x, *v = step @ [scene.start_position[i], *(scene.start.velocity[i] * struck)]
            assert found[i] == pytest.approx(x, abs=1e-15)
            assert found[3 + i] == pytest.approx(weights @ v, abs=1e-10)


@pytest.fixture(scope="module")
def of_rays():
    """Rays on a bead of silica, by quadrature."""
    return light_force(tweezer.load_scene("silica-1um").replace(optics={"theory": "rays"}))


def _numbers(force, places):
    found = evaluated(numbered(force), np.ascontiguousarray(places), gradient=False)
    return found.error


def _lines_passed(force, places):
    """Outside, of the half-angles at which a bead touches a ray of the rim, those it is beyond."""
    radius, cone = force.light.radius, force.light.cone.half_angle
    d = np.linalg.norm(places, axis=1) / radius
    gamma = np.arccos(places[:, 2] / radius / d)
    eta = np.arccos(1 / np.maximum(d, 1))
    rims = np.array([math.pi / 2 - cone, math.pi / 2 + cone])
    rims = np.concatenate([-rims[:1], rims, math.pi + rims[:1]])
    return d < 1, [(each[:, None] >= rims).sum(axis=1) for each in (gamma - eta, gamma + eta)]


def test_regions_of_rays_end_where_the_rim_touches(of_rays):
    places = np.random.default_rng(3).normal(size=(4000, 3)) * of_rays.light.radius
    places *= np.random.default_rng(4).uniform(0.2, 3, size=(4000, 1))
    inside, (p, q) = _lines_passed(of_rays, places)
    expected = np.where(inside, 0, 1 + 5 * p + q)
    np.testing.assert_array_equal(_numbers(of_rays, places), expected)
    assert len(np.unique(expected)) > 6


def test_regions_of_two_beams_are_told_apart(of_rays):
    """Each in its own frame, as digits; light as waves and other forces have one region."""
    shift = np.array([1e-6, -2e-6, 5e-7])
    one = Course.constant(1.0)
    moved = Moved(of_rays, Course.constant(*shift), one, down=True)
    places = np.random.default_rng(5).normal(size=(50, 3)) * 2e-6
    turned = (places - shift) * [1, -1, -1]
    np.testing.assert_array_equal(_numbers(moved, places), _numbers(of_rays, turned))
    both = _numbers(Sum((of_rays, moved)), places)
    np.testing.assert_array_equal(both, _numbers(of_rays, places) + 64 * _numbers(of_rays, turned))
    assert numbered(light_force(tweezer.load_scene("silica-1um"))) is None


def test_steps_end_where_rays_are_not_smooth():
    """A bead that comes from outside: a step ends at d = r, where the force has its worst kink."""
    scene = tweezer.load_scene("thesis-990nm").replace(
        simulation={"model": "full", "method": "exponential", "scaling_factor": None},
        optics={"evaluator": "quadrature"},
    )
    solver = Solver(bind(scene), "exponential", end=8e-3)
    piece, _ = solver.advance()
    far = np.linalg.norm(piece.records.state[:, :3], axis=1) / scene.bead.radius
    assert far[0] > 2
    assert far[-1] < 0.5
    assert np.abs(far - 1).min() < 1e-4


@pytest.mark.parametrize("factor", [0.01, 0.03])
def test_what_newton_learned_ends_at_a_jump_of_the_power(factor):
    """Of dim light it does not hold for bright light: against tolerances 1000 times tighter."""
    scene = tweezer.load_scene("thesis-990nm").replace(
        beam={"modulation": {"kind": "steps", "times": [0, 1e-3], "factors": [factor, 1]}},
        forces={"gravity": False, "buoyancy": False}, optics={"evaluator": "quadrature"},
        simulation={"model": "full", "method": "exponential", "scaling_factor": None,
                    "duration": "8 ms", "samples": 401},
    )  # fmt: skip
    run, exact = (tweezer.simulate(scene, tolerance=each) for each in (1e-7, 1e-10))
    off = np.linalg.norm(run["position"].values - exact["position"].values, axis=1).max()
    assert off < scene.simulation.position_tolerance


def test_a_given_step_that_is_too_long_is_said_to_be():
    scene = tweezer.load_scene("thesis-990nm").replace(
        simulation={"model": "full", "method": "exponential", "scaling_factor": None,
                    "duration": "8 ms", "step": "2 ms"},
    )  # fmt: skip
    with pytest.warns(tweezer.PhysicsWarning, match="the given step is too long"):
        assert tweezer.simulate(scene).attrs["status"] == "failed"
