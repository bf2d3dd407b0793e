"""The compiled methods: order, stiffness, constraints, events, failures, and what they tell.

Oracles: motions in closed form, and SciPy's solvers.
"""

import itertools
import json

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from scipy.special import expi

import tweezer
from tests.dynamics.test_closed_forms import trap_solution
from tests.reference import memory
from tests.reference.fields import GaussianWell, LinearTrap, in_field, in_trap
from tests.reference.rigid_body import rotation_matrix
from tweezer.compiled import cached_njit
from tweezer.dynamics import (
    Event,
    bind,
    capture,
    closest_approach,
    integrate,
    integrators,
    solution,
)
from tweezer.dynamics.layout import Layout
from tweezer.dynamics.solution import Solver
from tweezer.forces.data import number, packed
from tweezer.scene.choices import METHODS

COMPILED = ["dormand-prince", "dop853", "exponential"]
ORDER = {"dormand-prince": 5, "dop853": 8}
TIGHT = {"relative_tolerance": 1e-12, "position_tolerance": 1e-18, "orientation_tolerance": 1e-13}


def scene_with(method, model="full", start=(1e-7, -2e-7, 3e-7), velocity=(0, 0, 0), **simulation):
    return tweezer.load_scene("thesis-990nm").replace(
        start={"frame": "focus", "position": list(start), "velocity": list(velocity)},
        forces={"gravity": False, "buoyancy": False},
        simulation={"model": model, "method": method, **simulation},
    )


def overdamped_in_well(t, rate, width, x0):
    """x(t) of x' = -rate x exp(-x^2/(2 s^2)): Ei(x^2/(2 s^2)) falls at 2 rate."""
    w0 = x0**2 / (2 * width**2)
    w = [brentq(lambda w, s=s: expi(w) - expi(w0) + 2 * rate * s, 1e-12, w0, xtol=1e-16, rtol=1e-15)
         for s in t]  # fmt: skip
    return width * np.sqrt(2 * np.array(w))


# --- order ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("method", ["dormand-prince", "dop853"])
def test_order_conditions(method):
    """Row sums, quadrature, and bushy trees up to the order (Hairer, Norsett, Wanner, II.2)."""
    table = METHODS[method].load().tableau
    c = table.a.sum(axis=1)
    powers = range(1, table.order + 1)
    np.testing.assert_allclose([table.b @ c ** (k - 1) for k in powers], [1 / k for k in powers],
                               rtol=1e-13)  # fmt: skip
    for k in range(1, table.order):
        tree = table.b @ (c * (table.a @ c ** (k - 1)))
        assert tree == pytest.approx(1 / (k * (k + 2)), rel=1e-12) or k + 2 > table.order
    # the dense output ends where the step does, and begins with the rate at its start
    ends = table.dense.sum(axis=0)
    np.testing.assert_allclose(ends[: table.b.size], table.b, atol=1e-12)
    np.testing.assert_allclose(ends[table.b.size :], 0, atol=1e-12)


@pytest.mark.parametrize("method", ["dormand-prince", "dop853"])
def test_order_in_a_gaussian_well(method):
    """By the slope of the error over fixed steps, against the closed form."""
    scene = scene_with(method, "overdamped", start=(1.5e-7, 0, 0))
    bead = tweezer.bead_properties(scene)
    rate, width = 2e4, 1e-7
    duration = 2.5 / rate
    exact = overdamped_in_well([duration], rate, width, 1.5e-7)[0]
    # the error of order 8 falls a little faster yet at the steps that rounding leaves room for
    counts = np.array([24, 32, 48, 64, 96] if method == "dormand-prince" else [5, 6, 8, 10, 12])
    errors = []
    for count in counts:
        equations = in_field(bind(scene), GaussianWell(rate * bead.drag, width))
        solver = Solver(equations, method, end=duration, fixed=duration / count)
        piece, _ = solver.advance()
        assert solver.steps == count
        errors.append(abs(piece.states(np.array([duration]))[0, 0] - exact) / 1e-7)
    slope = -np.polyfit(np.log(counts), np.log(errors), 1)[0]
    assert ORDER[method] - 0.3 < slope < ORDER[method] + (0.3 if method == "dormand-prince" else 2)


@pytest.mark.parametrize(
    ("model", "per_step", "order"), [("overdamped", 0.0, 16), ("full", 0.02, 9), ("full", 1.0, 9)]
)
def test_order_of_the_exponential_method(model, per_step, order):
    """16 at the ends of steps of a bead without inertia in a linear trap, and 9 with it.

    per_step: relaxation times in a tenth of the trap's time.
    """
    scene = scene_with("exponential", model, **TIGHT)
    bead = tweezer.bead_properties(scene)
    tau, mass = bead.relaxation_time, bead.mass if per_step else 1e-30
    stiffness = bead.drag * (per_step or 0.02) / (10 * tau)
    slow = np.roots([mass, bead.drag, stiffness]).real.max()
    scene = scene.replace(start={"position": [1e-7, 0, 0], "velocity": [slow * 1e-7, 0, 0]})
    duration = 20 * bead.drag / stiffness
    errors, counts = [], np.array([5, 6, 7, 8])
    for count in counts:
        equations = in_trap(bind(scene), stiffness)
        solver = Solver(equations, "exponential", end=duration, fixed=duration / count)
        piece, _ = solver.advance()
        assert solver.steps == count
        exact = trap_solution(duration, mass, bead.drag, stiffness, 1e-7, slow * 1e-7)
        errors.append(abs(piece.states(np.array([duration]))[0, 0] - exact))
    slope = -np.polyfit(np.log(counts), np.log(errors), 1)[0]
    assert slope > order - 1


def test_exponential_error_falls_with_the_relaxation_time():
    """At one step, as tau falls from 1e-3 to 1e-9 of the trap time: in proportion, or rounding."""
    scene = scene_with("exponential", start=(1e-7, 0, 0), **TIGHT)
    stiffness = 1e-5
    errors = []
    ratios = 10.0 ** -np.arange(3, 10)
    for small in ratios:
        equations = in_trap(bind(scene), stiffness)
        bead = equations.bead
        mass = small * bead.drag**2 / stiffness
        equations.params[equations.module.PARAMS.index("m")] = mass
        trap_time = bead.drag / stiffness
        solver = Solver(equations, "exponential", end=3 * trap_time, fixed=0.5 * trap_time)
        while (part := solver.advance())[1] != 0:
            pass
        x = part[0].states(np.array([3 * trap_time]))[0, 0]
        errors.append(abs(x - trap_solution(3 * trap_time, mass, bead.drag, stiffness, 1e-7, 0.0)))
    assert (np.array(errors) < 1e-7 * (1e-3 * ratios + 1e-14)).all()


# --- dense output, restarts, constraints ----------------------------------------------------------


@pytest.mark.parametrize("method", COMPILED)
@pytest.mark.parametrize("velocity", [0.0, 2e-2])
def test_dense_output_follows_the_motion(method, velocity):
    """Between steps as at their ends, the initial layer included."""
    scene = scene_with(method, start=(1e-7, 0, 0), velocity=(velocity, 0, 0),
                       relative_tolerance=1e-9, position_tolerance=1e-15)  # fmt: skip
    bead = tweezer.bead_properties(scene)
    stiffness = 0.01 * bead.drag / bead.relaxation_time
    times = np.linspace(0, 30 * bead.relaxation_time, 1001)
    result = integrate(in_trap(bind(scene), stiffness), times)
    assert result.steps < 400
    exact = trap_solution(times, bead.mass, bead.drag, stiffness, 1e-7, velocity)
    np.testing.assert_allclose(result.states[:, 0], exact, atol=3e-14)


@pytest.mark.parametrize("method", COMPILED)
@pytest.mark.parametrize("fixed", [0.0, 2e-6])
def test_a_restart_changes_nothing(method, fixed, monkeypatch):
    """A loop called again for every step, or once for all."""
    scene = scene_with(method, relative_tolerance=1e-6).replace(
        beam={"torque": "thesis"}, start={"angular_velocity": [2e3, -1e3, 3e3]}
    )
    duration = 2e-4 if method == "exponential" else 2e-6
    fixed = fixed if method == "exponential" else fixed / 100

    def final():
        equations = in_field(bind(scene), GaussianWell(2e-5, 4e-7))
        solver, pieces = Solver(equations, method, end=duration, fixed=fixed), []
        while not pieces or pieces[-1][1] != 0:
            pieces.append(solver.advance())
        return solver.steps, len(pieces), pieces[-1][0].states(np.array([duration]))[0]

    steps, _, at_once = final()
    monkeypatch.setattr(solution, "_FIRST_STEPS", 1)
    monkeypatch.setattr(solution, "_MOST_STEPS", 1)
    again, calls, in_parts = final()
    assert (steps, steps) == (again, calls)
    np.testing.assert_array_equal(at_once, in_parts)


@pytest.mark.parametrize("method", COMPILED)
@pytest.mark.parametrize("fixed", [0.0, 1e-8])
def test_what_memory_held_changes_nothing(method, fixed):
    scene = scene_with(method).replace(
        beam={"torque": "thesis"}, start={"angular_velocity": [2e3, -1e3, 3e3]}
    )
    equations = in_field(bind(scene), GaussianWell(2e-5, 4e-7))
    found = []
    for byte in (memory.ZEROS, memory.NAN):
        solver = Solver(equations, method, end=1e-6, fixed=fixed)
        memory.leave(byte)
        piece, why = solver.advance()
        assert why == integrators.REACHED
        found.append((solver.steps, solver.rejected, piece.states(np.linspace(0, 1e-6, 9))))
    (steps, rejected, states), (again, rejected_again, states_again) = found
    assert (steps, rejected) == (again, rejected_again)
    np.testing.assert_array_equal(states, states_again)


def test_orientation_does_not_drift():
    """|e| = 1 by construction: rounding alone, over 10^6 steps of a bead spun and turned."""
    scene = scene_with("exponential", most_force_calls=10**8).replace(
        beam={"torque": "thesis"}, start={"angular_velocity": [2e4, -1e4, 3e4]}
    )
    equations = in_trap(bind(scene), 1e-5, (1e-21, 2e-21, -3e-21))
    solver = Solver(equations, "exponential", end=1.0, fixed=1e-6)
    while (part := solver.advance())[1] != 0:
        pass
    assert solver.steps > 999_990
    e = part[0].states(np.array([1.0]))[0, 3:7]
    # a random walk of 10^6 roundings is 1e-13
    assert abs(np.linalg.norm(e) - 1) < 1e-12


def test_spun_sphere_turns_by_the_closed_form():
    """Constant moment in the inertial frame: the angle is (M/beta_w)(t - tau_r (1 - e^(-t/tau_r)));
    a sphere spun about another axis at first turns about both, against DOP853 of SciPy.
    """
    moment = np.array([1e-19, 2e-19, -3e-19])
    for spin in ([0.0, 0.0, 0.0], [3e5, -1e5, 2e5]):
        scene = scene_with("exponential", **TIGHT).replace(
            beam={"torque": "thesis"}, start={"angular_velocity": spin or [0, 0, 0]}
        )
        bead = tweezer.bead_properties(scene)
        tau = bead.moments_of_inertia[0] / bead.rotational_drag
        times = np.linspace(0, 40 * tau, 41)
        equations = in_trap(bind(scene), 1e-5, tuple(moment))
        ours = integrate(equations, times)
        if not any(spin):
            angle = moment / bead.rotational_drag * (times + tau * np.expm1(-times / tau))[:, None]
            size = np.linalg.norm(angle, axis=1)
            turned = 2 * np.arcsin(np.linalg.norm(ours.states[:, 4:7], axis=1))
            np.testing.assert_allclose(turned, size, atol=1e-10 * size[-1])
            for e, turned in zip(ours.states[1:, 3:7], angle[1:], strict=True):
                np.testing.assert_allclose(rotation_matrix(e) @ turned, turned, rtol=1e-12)
        other = scene.replace(simulation={"method": "scipy:DOP853"})
        theirs = integrate(in_trap(bind(other), 1e-5, tuple(moment)), times)
        np.testing.assert_allclose(ours.states[:, 3:7], theirs.states[:, 3:7], atol=1e-9)
        np.testing.assert_allclose(ours.states[:, 10:], theirs.states[:, 10:], atol=1e-6 * 3e5)


@pytest.mark.parametrize("body", ["sphere", "rigid body"])
@pytest.mark.parametrize("state", ["angular-velocity", "euler-rates"])
@pytest.mark.parametrize("method", ["dormand-prince", "dop853"])
def test_explicit_methods_turn_as_scipy_does(method, state, body):
    moments = {"moments_of_inertia": [4e-29, 5e-29, 6e-29]} if body == "rigid body" else {}
    scene = scene_with(method, rotation_state=state, **TIGHT).replace(
        beam={"torque": "thesis"}, bead=moments, start={"angular_velocity": [2e4, -1e4, 3e4]},
        simulation={"relative_tolerance": 1e-10},
    )  # fmt: skip
    times = np.linspace(0, 4e-7, 5)
    ours = bind(scene)
    theirs = bind(scene.replace(simulation={"method": "scipy:DOP853"}))
    a = ours.motion(times, integrate(ours, times).states)
    b = theirs.motion(times, integrate(theirs, times).states)
    np.testing.assert_allclose(a.position, b.position, atol=1e-16)
    np.testing.assert_allclose(a.orientation, b.orientation, atol=1e-9)
    np.testing.assert_allclose(a.angular_velocity, b.angular_velocity, atol=1e-8 * 3e4)


@pytest.mark.parametrize(
    ("model", "method"),
    [("full", "exponential"), ("first-order", "dop853"), ("first-order", "dormand-prince")],
)
def test_thesis_bead_against_scipy(model, method):
    """The unscaled 990 nm bead over the edge of the light and into the trap."""
    scene = tweezer.load_scene("thesis-990nm").replace(
        optics={"evaluator": "quadrature", "tolerance": 1e-10},
        start={"frame": "focus", "position": [0, 6e-7, -5e-7]},
        simulation={"model": model, "method": method, "duration": "0.4 ms", "samples": 101,
                    "relative_tolerance": 1e-10, "position_tolerance": 1e-16},
    )  # fmt: skip
    ours = tweezer.simulate(scene)
    theirs = tweezer.simulate(scene, model="full", method="scipy:LSODA")
    apart = np.abs(ours["position"] - theirs["position"]).max()
    assert float(apart) < (2e-12 if model == "full" else 2e-11)
    assert ours.attrs["force_calls"] < 0.5 * theirs.attrs["force_calls"]


# --- events ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("method", [*COMPILED, "scipy:LSODA"])
def test_events_are_where_the_closed_form_has_them(method):
    scene = scene_with(method, start=(1e-7, 0, 0), relative_tolerance=1e-10,
                       position_tolerance=1e-17)  # fmt: skip
    bead = tweezer.bead_properties(scene)
    stiffness = 20 * bead.drag**2 / (4 * bead.mass)  # underdamped: it rings through the focus

    def x(t):
        return trap_solution(t, bead.mass, bead.drag, stiffness, 1e-7, 0.0)

    tau = bead.relaxation_time
    grid = np.linspace(0, 30 * tau, 20_001)
    crossings = [brentq(x, a, b) for a, b in itertools.pairwise(grid) if x(a) * x(b) < 0]
    inside = np.abs(x(grid)) < 2e-8
    edge = grid[np.flatnonzero(~inside)[-1]]
    entered = brentq(lambda t: abs(x(t)) - 2e-8, edge, edge + grid[1])
    events = [
        closest_approach(),
        Event("upwards", lambda t, y: y[:, 0], direction=1),
        capture(2e-8, 10 * tau),
        capture(2e-8, 10 * tau, centre=(1e-3, 0, 0)),
    ]
    result = integrate(in_trap(bind(scene), stiffness), grid[::100], events)
    found = {}
    for event in result.events:
        found.setdefault(event.name, []).append(event.time)
    assert found["closest approach"] == pytest.approx(crossings[:1], abs=1e-4 * tau)
    rising = [t for t in crossings if x(t + 0.01 * tau) > 0]
    assert found["upwards"] == pytest.approx(rising, abs=1e-6 * tau)
    assert found["capture"] == pytest.approx([entered], abs=1e-5 * tau)


def test_an_event_of_the_user_ends_the_run():
    scene = tweezer.load_scene("thesis-990nm").replace(simulation={"model": "full"})
    half = Event("half way", lambda t, y: y[:, 2] + 4e-6, direction=1, terminal=True)
    run = tweezer.simulate(scene, method="exponential", events=[half])
    assert run.attrs["status"] == "ended"
    assert run.attrs["message"].startswith("half way at ")
    assert float(run["position"][-1, 2]) == pytest.approx(-4e-6, abs=1e-15)
    assert '"half way"' in run.attrs["events"]


def test_the_lens_ends_a_run():
    """A bead pushed towards the lens in the dark."""
    scene = tweezer.load_scene("thesis-990nm").replace(
        forces={"optical": False}, lens={"focal_length": "2 um"},
        start={"frame": "focus", "position": [0, 0, -1e-6], "velocity": [0, 0, -10.0]},
        simulation={"model": "full", "duration": "1 us"},
    )  # fmt: skip
    with pytest.warns(tweezer.PhysicsWarning, match="reached the lens"):
        run = tweezer.simulate(scene)
    assert run.attrs["status"] == "failed"
    assert float(run["position"][-1, 2]) == pytest.approx(scene.bead.radius - 2e-6, abs=1e-15)


def in_pieces(event, ends):
    """Occurrences of an event over pieces of the motion x = t."""

    class Straight:
        def __init__(self, begin, end):
            self.begin, self.end = begin, end

        def checkpoints(self):
            return np.linspace(self.begin, self.end, 5)

        def states(self, times):
            return np.stack([times, 0 * times, 0 * times], axis=1)

    event = event.restarted(np.zeros(3), Layout({"position": 3}))
    return [
        each for begin, end in itertools.pairwise(ends)
        for each in event.occurrences(Straight(begin, end))
    ]  # fmt: skip


def test_events_are_found_across_the_ends_of_pieces():
    """Where a value is 0 at the end of a piece or the begin of the run; and with their state."""
    crossing = Event("one", lambda t, _: t - 1.0, direction=1)
    for ends in ([0, 1, 2], [0, 0.5, 1.5, 2], [0, 2], [0, 1, 1.5, 2]):
        (found,) = in_pieces(crossing, ends)
        assert found.time == pytest.approx(1.0, abs=1e-12)
    from_zero = Event("later", lambda t, _: t, direction=1, hold=1.5)
    (found,) = in_pieces(from_zero, [0, 0.5, 1, 2, 3])
    assert (found.time, found.certain) == (0, 1.5)
    held = Event("held", lambda t, _: t - 0.75, direction=1, hold=1.5)
    (found,) = in_pieces(held, [0, 0.5, 1, 2, 3])
    assert found.state[0] == found.time == pytest.approx(0.75, abs=1e-12)
    assert found.certain == pytest.approx(2.25, abs=1e-12)
    assert not in_pieces(held, [0, 1, 2])
    both = Event("both", lambda t, _: np.sin(t))
    assert [each.time for each in in_pieces(both, np.linspace(0, 10, 14))] == pytest.approx(
        [np.pi, 2 * np.pi, 3 * np.pi]
    )


def test_a_bead_at_rest_approaches_nothing():
    """Its wobble within the tolerance is no closest approach."""
    scene = tweezer.load_scene("silica-1um").replace(
        medium={"inertia": "none"},
        start={"frame": "focus", "position": [0, 0, 4e-7]},
        simulation={"model": "full", "duration": "10 ms", "samples": 11},
    )
    assert tweezer.simulate(scene).attrs["events"] == "[]"


def test_the_first_order_model_has_its_events_on_the_released_bead():
    """Within the initial layer, 5 ns after a bead is thrown."""
    scene = tweezer.load_scene("silica-1um").replace(
        medium={"inertia": "none"},
        start={"frame": "focus", "position": [0, 0, -6e-7], "velocity": [0, 0, 2.0]},
        simulation={"duration": "1 us"},
    )
    times = []
    for model in ("full", "first-order"):
        line = Event("line", lambda _, y: y[:, 2] + 5.9e-7, direction=1)
        run = tweezer.simulate(scene, model=model, method="auto", events=[line])
        times += [event["time"] for event in json.loads(run.attrs["events"])]
    assert times == pytest.approx([5.1e-9, 5.1e-9], rel=0.02)


@pytest.mark.parametrize(
    "value", [lambda _, y: 1.0, lambda _, y: y, lambda t, _: t * np.nan, lambda _, y: y[9]]
)
def test_events_that_give_no_numbers_are_refused(value):
    with pytest.raises(tweezer.SceneError, match="event 'bad': "):
        tweezer.simulate(tweezer.load_scene("silica-1um"), events=[Event("bad", value)])
    with pytest.raises(tweezer.SceneError, match="events: must be a list"):
        tweezer.simulate(tweezer.load_scene("silica-1um"), events=[value])


def test_an_interrupted_run_is_not_run_again_for_its_error(monkeypatch):
    calls = []

    def interrupted(reached):
        calls.append(reached)
        raise KeyboardInterrupt

    run = tweezer.simulate(tweezer.load_scene("silica-1um"), progress=interrupted)
    assert run.attrs["status"] == "interrupted"
    assert len(calls) == 1
    assert np.isnan(run.attrs["integration_error"])


@pytest.mark.parametrize(
    "simulation",
    [
        {"model": "overdamped", "method": "dormand-prince", "step": 1.5e-4},
        {"model": "overdamped", "method": "dop853", "step": 2e-4},
        {"model": "full", "method": "exponential", "step": 1e-3},
    ],
)
def test_integration_error_without_a_finer_run_is_not_known(simulation):
    """Half of a given step takes more force calls than are allowed: nothing is compared."""
    scene = tweezer.load_scene("silica-1um").replace(
        medium={"inertia": "none"}, simulation=simulation
    )
    calls = tweezer.simulate(scene).attrs["force_calls"]
    assert calls >= 100
    run = tweezer.simulate(scene.replace(simulation={"most_force_calls": int(calls)}))
    assert run.attrs["status"] == "complete"
    assert np.isnan(run.attrs["integration_error"])
    summary = tweezer.summarise(run)
    assert summary.overshoot_error is summary.outcome_time_error is None


# --- failures -------------------------------------------------------------------------------------


@cached_njit()
def _breaks(pose, data, wrench):
    """A spring that gives NaN within its width of the centre."""
    p = pose.position
    wrench.force[:] -= number(data, 0) * p
    for i in range(len(p)):
        if np.abs(p[i]).max() < number(data, 1):
            wrench.force[i] = np.nan


class Broken(LinearTrap):
    """A spring that breaks near the centre."""

    def compiled(self, *, gradient):
        return _breaks, packed(self.stiffness, 5e-8)


@pytest.mark.parametrize("fixed", [None, 1e-8])
@pytest.mark.parametrize("method", COMPILED)
def test_a_force_that_is_not_finite_fails_and_keeps_what_was_reached(method, fixed):
    scene = scene_with(method, "full" if method == "exponential" else "overdamped", step=fixed)
    equations = in_field(bind(scene), Broken(1e-5))
    result = integrate(equations, np.linspace(0, 2e-3, 2001))
    assert result.status == "failed"
    assert 10 < len(result.times) < 2001
    assert np.isfinite(result.states).all()
    assert np.abs(result.states[-1, :3]).max() > 5e-8


def test_fixed_steps_that_are_too_long_fail():
    """An explicit method at 20 relaxation times grows until its dense output overflows."""
    scene = scene_with("dop853", step=1.2e-6, velocity=(1e-5, 2e-5, 3e-5))
    result = integrate(in_trap(bind(scene), 1e-5), np.linspace(0, 1e-4, 501))
    assert result.status == "failed"
    assert "not finite" in result.message
    assert 2 < len(result.times) < 501
    assert np.isfinite(result.states).all()


@pytest.mark.parametrize("method", [*COMPILED, "scipy:RK45"])
def test_a_run_gives_up_when_its_work_is_spent(method):
    scene = tweezer.load_scene("thesis-990nm").replace(
        simulation={"model": "full", "method": method, "most_force_calls": 200}
    )
    with pytest.warns(tweezer.PhysicsWarning, match="most_force_calls is spent"):
        run = tweezer.simulate(scene)
    assert run.attrs["status"] == "failed"
    assert 150 < run.attrs["force_calls"] < 230
    assert np.isfinite(run["position"]).all()


def test_methods_that_do_not_fit_are_refused():
    for changes in (
        {"simulation": {"model": "first-order", "method": "exponential"}},
        {
            "simulation": {"model": "full", "method": "exponential"},
            "start": {"angular_velocity": [1.0, 0, 0]},
            "bead": {"moments_of_inertia": [4e-29, 5e-29, 6e-29]},
        },
        {"simulation": {"method": "scipy:LSODA", "step": 1e-6}},
    ):
        with pytest.raises(tweezer.SceneError, match=r"exponential|fixed steps"):
            tweezer.simulate(tweezer.load_scene("thesis-990nm").replace(**changes))


# --- what is chosen, and what is told -------------------------------------------------------------


@pytest.mark.parametrize(
    ("changes", "model", "method", "inertia"),
    [
        ({}, "full", "exponential", "memory"),
        ({"simulation": {"position_tolerance": "20 nm"}}, "full", "exponential", "memory"),
        ({"simulation": {"position_tolerance": "20 nm"}, "medium": {"inertia": "none"}},
         "overdamped", "exponential", "none"),
        ({"simulation": {"position_tolerance": "20 nm"}, "medium": {"inertia": "added-mass"}},
         "full", "exponential", "added-mass"),
        ({"simulation": {"position_tolerance": "0.2 um"}}, "overdamped", "exponential", "none"),
        (
            {"simulation": {"model": "overdamped", "relative_tolerance": 1e-10}},
            "overdamped", "exponential", "none",
        ),
        ({"simulation": {"method": "dop853"}}, "full", "dop853", "none"),
        ({"simulation": {"model": "scaled", "scaling_factor": 0.01}}, "scaled", "exponential",
         "none"),
        ({"simulation": {"model": "scaled", "scaling_factor": 0.01},
          "medium": {"inertia": "memory"}}, "scaled", "exponential", "memory"),
        (
            {"bead": {"moments_of_inertia": [4e-29, 5e-29, 6e-29]}, "beam": {"torque": "thesis"},
             "simulation": {"position_tolerance": "1 nm"}}, "first-order", "dormand-prince", "none",
        ),
        (
            {"bead": {"moments_of_inertia": [4e-29, 5e-29, 6e-29]}, "beam": {"torque": "thesis"},
             "simulation": {"model": "full"}}, "full", "scipy:LSODA", "none",
        ),
        (
            {"bead": {"moments_of_inertia": [4e-29, 5e-29, 6e-29]}, "beam": {"torque": "thesis"},
             "simulation": {"model": "full", "duration": "1 us"}}, "full", "dop853", "none",
        ),
    ],
)  # fmt: skip
def test_what_is_chosen_for_a_scene(changes, model, method, inertia):
    bare = tweezer.load_scene("silica-1um").model_dump(exclude_none=True)
    bare["simulation"] = {"duration": 2e-3}
    scene, why = tweezer.dynamics.chosen(tweezer.load_scene(bare).replace(**changes))
    found = scene.simulation.model, scene.simulation.method, scene.medium.inertia
    assert found == (model, method, inertia)
    assert why.count(":") >= 1


def test_told_errors_are_not_below_the_true_ones():
    """Twenty random scenes; rounding of the quadrature's 1e-10 aside."""
    rng = np.random.default_rng(11)
    below = []
    for _ in range(20):
        radius = 10 ** rng.uniform(-6.8, -5.5)
        place = rng.normal(size=3)
        place *= rng.uniform(0.2, 3) * radius / np.linalg.norm(place)
        scene = tweezer.load_scene("silica-1um").replace(
            bead={"radius": radius},
            start={"frame": "focus", "position": place.tolist()},
            beam={"power": 10 ** rng.uniform(-4, 0)},
            optics={"tolerance": 1e-10},
            simulation={"model": "full", "method": "exponential",
                        "duration": 10 ** rng.uniform(-6, -3),
                        "relative_tolerance": 1e-5, "position_tolerance": 1e-4 * radius,
                        "samples": 41, "loss_distance": 1e-3},
        )  # fmt: skip
        run = tweezer.simulate(scene)
        exact = tweezer.simulate(scene, tolerance=1e-10)
        error = float(np.linalg.norm(run["position"] - exact["position"], axis=1).max())
        below.append(error / run.attrs["integration_error"])
    assert max(below) < 1
    assert np.median(below) > 0.1


def test_a_scene_that_leaves_all_open_can_be_bound_and_integrated():
    """With the unscaled equations; and its callables are what any solver takes."""
    scene = scene_with("auto", None)
    equations = bind(scene)
    assert equations.name == "full_translation"
    times = np.linspace(0, 1e-4, 5)
    ours = integrate(equations, times)
    theirs = solve_ivp(
        equations.rhs, (0, 1e-4), equations.initial_state, "Radau", times, jac=equations.jacobian,
        rtol=1e-9, atol=1e-16,
    )  # fmt: skip
    np.testing.assert_allclose(ours.states[:, :3], theirs.y[:3].T, atol=1e-11)


# --- nothing a scene does not need ----------------------------------------------------------------


@pytest.mark.parametrize("method", COMPILED)
def test_a_bead_on_the_axis_stays_there(method):
    """To the last bit."""
    scene = tweezer.load_scene("silica-1um").replace(
        start={"frame": "focus", "position": [0, 0, -1e-6]},
        simulation={"model": "full" if method == "exponential" else "overdamped",
                    "method": method, "duration": "1 ms", "samples": 11},
    )  # fmt: skip
    run = tweezer.simulate(scene)
    assert not run["position"][:, :2].any()
    assert "orientation" not in run


def test_a_bead_beside_the_light_takes_long_steps():
    """No ray meets it. It only sinks: once the initial layer has passed, a handful for 10 ms."""
    scene = tweezer.load_scene("silica-1um").replace(
        medium={"inertia": "none"},
        optics={"theory": "rays"},
        start={"frame": "focus", "position": [12e-6, 0, 0]},
        simulation={"model": "full", "method": "exponential", "duration": "10 ms"},
    )
    run = tweezer.simulate(scene)
    assert not run["optical_force"].any()
    assert run.attrs["steps"] < 20
    bead = tweezer.bead_properties(scene)
    sunk = bead.weight[2] / bead.drag * (10e-3 - bead.relaxation_time)
    assert float(run["position"][-1, 2]) == pytest.approx(sunk, rel=1e-9)


def test_a_tightened_run_has_smaller_tolerances():
    """What tells the error of a solver of SciPy's must be the more exact of the two."""
    equations = tweezer.bind(tweezer.load_scene("silica-1um"))
    simulation = equations.scene.simulation
    control = Solver(equations, "exponential", end=1e-6, tightened=1 / 16).control
    assert control.relative == simulation.relative_tolerance / 16
    assert control.absolute[0] == simulation.position_tolerance / 16
