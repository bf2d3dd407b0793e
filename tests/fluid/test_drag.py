"""Drag by place: mobilities of a made-up wall, motion against closed forms, and who refuses it."""

import dataclasses
import math
from dataclasses import dataclass

import numpy as np
import pytest
from scipy.constants import Boltzmann

import tweezer
from tests.reference.fields import LinearTrap, in_place
from tests.reference.rigid_body import Body
from tweezer.compiled import cached_njit
from tweezer.dynamics import Motion, bind, bound_once, choose, integrate
from tweezer.dynamics.models import bind_translation
from tweezer.dynamics.walk import rotation_matrices, walk
from tweezer.fluid import BesideWall, Drag, stokes
from tweezer.forces import UserForce, kernel
from tweezer.forces.data import number, packed, vector
from tweezer.runs.derived import derived_quantities
from tweezer.tracking.filter import kalman_filter
from tweezer.values.errors import SceneError

RADIUS, VISCOSITY = 0.5e-6, 1e-3
FREE = stokes(VISCOSITY, RADIUS)


@cached_njit()
def _growing(pose, data, mobility):
    """b(z) = b (1 + z/length), all five."""
    values, length = vector(data, 0), number(data, 1)
    for at in range(len(pose.position)):
        factor = 1.0 + pose.position[at, 2] / length
        for i in range(5):
            mobility.value[at, i] = values[i] * factor
            if len(mobility.gradient) > at:
                mobility.gradient[at, i, :2] = 0.0
                mobility.gradient[at, i, 2] = values[i] / length


@dataclass(frozen=True)
class Growing(Drag):
    """Mobilities that grow with the height."""

    values: tuple[float, ...]
    length: float

    def compiled(self):
        return _growing, packed(self.values, self.length)


def growing(roll=0.0, length=2e-6):
    across, along = 0.7 / FREE.translation, 0.4 / FREE.translation
    turn, spin = 0.9 / FREE.rotation, 0.95 / FREE.rotation
    return Growing((across, along, turn, spin, roll * math.sqrt(across * turn)), length)


def problem_of(scene, drag, field=None):
    """`scene` with a drag of its own, in the dark or in a field."""
    problem = dataclasses.replace(bound_once(scene), drag=drag)
    return problem if field is None else in_place(problem, field)


@pytest.fixture(scope="module")
def dark():
    return tweezer.load_scene("silica-1um").replace(
        bead={"radius": RADIUS},
        medium={"viscosity": VISCOSITY},
        forces={"optical": False, "gravity": True, "buoyancy": True},
        start={"position": [0.0, 0.0, 0.5e-6]},
        simulation={"relative_tolerance": 1e-10, "position_tolerance": 1e-14},
    )


def test_stokes_drag_is_that_of_the_thesis():
    """(2.15), with the thesis's own numbers: 500 nm across, 1.002 mPa s."""
    drag = stokes(1.002e-3, 0.25e-6)
    assert drag.translation == pytest.approx(4.722e-9, rel=1e-3, abs=0)
    assert drag.rotation == pytest.approx(3.935e-22, rel=1e-3, abs=0)
    found = drag.mobilities(np.zeros((2, 3)), gradient=True)
    b_v, b_w = 1 / drag.translation, 1 / drag.rotation
    np.testing.assert_allclose(found.value, [[b_v, b_v, b_w, b_w, 0.0]] * 2, rtol=1e-15)
    assert not found.gradient.any()
    with pytest.raises(ZeroDivisionError):
        stokes(0.0, 1e-6).mobilities(np.zeros((1, 3)))


@pytest.mark.parametrize("model", ["overdamped", "full"])
def test_bead_sinks_exponentially(dark, model):
    """dz/dt = b W (1 + z/l): z + l decays or grows as e^(b W t/l); inertia is 1e-7 of that."""
    drag = growing()
    scene = dark.replace(simulation={"model": model, "method": "auto", "duration": "1 s"})
    if model == "full":
        scene = scene.replace(simulation={"duration": "5 us", "method": "dop853"})
    problem, _ = choose.decided(problem_of(scene, drag))
    times = np.linspace(0, scene.simulation.duration, 11)
    run = integrate(bind(problem), times)
    assert run.status == "complete"
    rate = drag.values[1] * problem.bead.weight[2] / drag.length
    z0, l = 0.5e-6, drag.length
    if model == "overdamped":
        exact = (z0 + l) * np.exp(rate * times) - l
        np.testing.assert_allclose(run.states[:, 2], exact, atol=1e-13)
        assert exact[-1] < z0 - 0.1e-6
    else:
        # over 5 us the drag hardly changes: relaxation with the tau of that height
        tau = problem.bead.mass * drag.values[1] * (1 + z0 / l)
        terminal = rate * (z0 + l)
        exact = terminal * (times + tau * np.expm1(-times / tau))
        np.testing.assert_allclose(run.states[:, 2] - z0, exact, atol=1e-4 * abs(exact[-1]))


@pytest.mark.parametrize("state", ["angular-velocity", "euler-rates"])
@pytest.mark.parametrize("model", ["overdamped", "full"])
def test_rates_are_those_of_the_matrix_of_mobilities(dark, model, state):
    """The runtime hands over the mobilities of the place: against the inverse of the 6x6 matrix."""
    scene = dark.replace(simulation={"model": model, "rotation_state": state, "method": "dop853"})
    drag = growing(roll=0.3)
    field = LinearTrap(1e-6, (1e-20, 2e-20, -1e-20))
    problem = problem_of(scene.replace(beam={"polarisation": "linear"}), drag, field)
    equations = bind(dataclasses.replace(problem, others=(Turning(),)))
    assert equations.rotates
    rng = np.random.default_rng(3)
    y = equations.initial_state + 1e-7 * rng.normal(size=len(equations.initial_state))
    names = equations.module.STATE
    velocity = [1e-4, -2e-4, 3e-4]
    if "v1" in names:
        y[names.index("v1") : names.index("v1") + 3] = velocity
    value = drag.mobilities(y[None, :3]).value[0]
    matrix = Body(
        1.0, np.ones(3), 1.0, 1.0, np.zeros(3), mobility=value, growth=np.zeros((5, 3))
    ).mobility_matrix(y[:3])
    force = -1e-6 * y[:3] + np.array(problem.bead.weight)
    pushed = np.append(force, field.constant_moment)
    rates = equations.rhs(0.0, y)
    if "v1" in names:
        at = names.index("v1")
        edot = names.index("edot0") if "edot0" in names else None
        motion = equations.motion(np.zeros(1), y[None])
        omega = rotation_matrices(motion.orientation)[0] @ motion.angular_velocity[0]
        resisted = np.linalg.solve(matrix, np.append(velocity, omega))
        expected = (pushed - resisted)[:3] / problem.bead.mass
        np.testing.assert_allclose(rates[at : at + 3], expected, rtol=1e-10)
        assert edot is None or rates[edot : edot + 4].any()
    else:
        np.testing.assert_allclose(rates[:3], (matrix @ pushed)[:3], rtol=1e-12)
    scale = np.where([name[0] in "qv" for name in names], 1e-9, 1e-5)
    differences = np.empty((len(y), len(y)))
    for i, step in enumerate(np.diag(scale)):
        differences[:, i] = (equations.rhs(0.0, y + step) - equations.rhs(0.0, y - step)) / (
            2 * scale[i]
        )
    jacobian = equations.jacobian(0.0, y)
    size = np.abs(differences * scale).max(axis=1, keepdims=True)
    np.testing.assert_allclose(jacobian * scale / size, differences * scale / size, atol=1e-4)


class Turning(LinearTrap):
    """Nothing but the wish to see the orientation."""

    def __init__(self):
        super().__init__(0.0)

    oriented = True


def test_compiled_loops_and_scipy_follow_the_same_drag(dark):
    scene = dark.replace(simulation={"model": "overdamped", "duration": "100 ms"})
    ends = []
    for method in ("dop853", "dormand-prince", "scipy:Radau"):
        problem = problem_of(
            scene.replace(simulation={"method": method}), growing(), LinearTrap(1e-8)
        )
        run = integrate(bind(problem), np.array([0.0, 0.1]))
        ends.append(run.states[-1, :3])
    np.testing.assert_allclose(ends[1:], ends[:1] * 2, atol=1e-12)


def test_what_follows_from_the_drag_is_of_the_place(dark):
    problem = problem_of(dark, growing(), LinearTrap(1e-6))
    across, along, turn, spin, _ = growing().values
    expected = 1.25 * np.array([across, across, along, turn, turn, spin])
    np.testing.assert_allclose(problem.mobility, expected, rtol=1e-14)
    assert problem.relaxation_time == pytest.approx(
        problem.bead.mass * problem.mobility[0], rel=1e-14
    )
    weight = abs(problem.bead.weight[2])
    (equilibrium,) = [each for each in [problem.equilibrium] if each]
    assert equilibrium.position[2] == pytest.approx(-weight / 1e-6, rel=1e-6)
    places = problem.places_about()
    rates = 1e-6 * growing().values[0] * (1 + places[:, 2] / 2e-6)
    np.testing.assert_allclose(choose.rates_of_force(problem), rates, rtol=1e-12)
    run = tweezer.simulate(dark, "1 us")
    times = run["time"].values
    motion = Motion(run["position"].values, None, None, None)
    weighed = problem_of(dark, growing())
    unlit = weighed.light.field(motion.position, time=times)
    _, speed, _ = derived_quantities(weighed, times, motion, unlit)["terminal_speed"]
    heights = motion.position[:, 2]
    expected = weight * growing().values[1] * (1 + heights / 2e-6)
    np.testing.assert_allclose(speed, expected, rtol=1e-12)
    slowed = problem_of(dark, Slowing())
    _, timed, _ = derived_quantities(slowed, times, motion, unlit)["terminal_speed"]
    np.testing.assert_allclose(timed * (1 + times / 1e-6), timed[0], rtol=1e-12)


def test_thermal_motion_is_boltzmanns_whatever_the_drag(dark):
    """Mean and variance in a spring, 16,384 beads: 5 standard errors, and 2 % of the step's bias.

    Without the drift kT db/dx the mean would be off by kT/(k l), 12 standard errors.
    """
    k, drag = 1e-6, growing(length=0.64e-6)
    scene = dark.replace(
        forces={"brownian": True}, start={"position": [0.0, 0.0, 0.0]},
        simulation={"model": None, "duration": "250 ms", "samples": 2, "step": "0.5 ms"},
    )  # fmt: skip
    bound = walk(problem_of(scene, drag, LinearTrap(k)), seed=4)
    assert bound.scene.simulation.model == "overdamped"
    assert bound.scene.simulation.method == "euler-maruyama"
    beads = np.arange(16384)
    states, out = bound.start(beads), np.empty((len(beads), 1, 3))
    bound.advance(states, beads, 0, out)
    variance = Boltzmann * scene.medium.temperature / k
    error = math.sqrt(variance / len(beads))
    mean = np.array([0.0, 0.0, bound.problem.bead.weight[2] / k])
    np.testing.assert_allclose(out[:, 0].mean(axis=0), mean, atol=5 * error)
    np.testing.assert_allclose(
        out[:, 0].var(axis=0), variance, rtol=0.02 + 5 * math.sqrt(2 / 16384)
    )
    free = walk(problem_of(scene.replace(simulation={"step": None}), drag), seed=4)
    assert "length in which the drag changes" in free.why


@cached_njit()
def _step(pose, data, mobility):
    """b(z) = b (1 + a tanh(z/width)), with a jump of a factor 100."""
    values, width = vector(data, 0), number(data, 1)
    for at in range(len(pose.position)):
        rise = math.tanh(pose.position[at, 2] / width)
        for i in range(5):
            mobility.value[at, i] = values[i] * (0.505 + 0.495 * rise)
            if len(mobility.gradient) > at:
                mobility.gradient[at, i, :2] = 0.0
                mobility.gradient[at, i, 2] = values[i] * 0.495 * (1 - rise**2) / width


@dataclass(frozen=True)
class Step(Growing):
    """Mobilities that change by a factor of 100 over a few nanometres about z = 0."""

    def compiled(self):
        return _step, packed(self.values, self.length)


@cached_njit()
def _slowing(pose, data, mobility):
    for at in range(len(pose.position)):
        mobility.value[at, :4] = number(data, 0) / (1.0 + pose.time[at] / 1e-6)


@dataclass(frozen=True)
class Slowing(Drag):
    """Mobilities that fall in time."""

    def compiled(self):
        return _slowing, packed(1e8)


def test_thermal_steps_resolve_the_drag_wherever_it_changes(dark):
    """Half of 4,096 beads on either side: 5 standard errors. The start is far from the change."""
    scene = dark.replace(
        forces={"brownian": True, "gravity": False, "buoyancy": False},
        start={"position": [0.0, 0.0, 0.5e-6], "drawn": "boltzmann"},
        simulation={"model": None, "duration": "20 ms", "samples": 2},
    )  # fmt: skip
    drag = Step(growing().values, 50e-9)
    bound = walk(problem_of(scene, drag, LinearTrap(1e-6)), seed=2)
    assert "length in which the drag changes" in bound.why
    beads = np.arange(4096)
    states, out = bound.start(beads), np.empty((len(beads), 1, 3))
    bound.advance(states, beads, 0, out)
    assert abs((out[:, 0, 2] < 0).mean() - 0.5) < 5 * 0.5 / math.sqrt(len(beads))


def test_what_is_no_drag_is_refused(dark):
    """Mobilities that are negative, or by which a motion would give energy; other positions."""
    across, along, turn, spin, _ = growing().values
    for values in (
        (-across, along, turn, spin, 0.0),
        (across, along, turn, spin, 1.1 * math.sqrt(across * turn)),
        (across, math.nan, turn, spin, 0.0),
    ):
        with pytest.raises(SceneError, match="drag: the mobilities at the start"):
            bind(problem_of(dark, Growing(values, 1e-6)))
    with pytest.raises(SceneError, match=r"shape \(n, 3\)"):
        growing().mobilities(np.zeros(3))


def test_a_model_that_the_drag_refuses_is_not_chosen(dark):
    scene = dark.replace(simulation={"model": None, "method": "auto", "position_tolerance": 1e-9})
    problem, _ = choose.decided(problem_of(scene, growing(), LinearTrap(1e-3)))
    assert problem.scene.simulation.model != "first-order"


def test_what_needs_a_uniform_drag_says_so(dark):
    """One line for each: never another drag in its place."""
    scene = dark.replace(forces={"brownian": True})
    for changes, words in (
        ({"method": "heun", "model": "overdamped"}, "'heun': .* must be euler-maruyama"),
        ({"model": "full"}, "simulation.model = 'full': .* set simulation.model to overdamped"),
    ):
        with pytest.raises(SceneError, match=words):
            walk(problem_of(scene.replace(simulation=changes), growing()))
    turning = {"angular_velocity": [0.0, 0.0, 10.0]}
    problem = problem_of(dark.replace(simulation={"model": "first-order"}), growing())
    with pytest.raises(SceneError, match=r"simulation.model = 'first-order': requires a drag"):
        integrate(bind(problem), np.array([0.0, 1e-6]))
    with pytest.raises(SceneError, match="the Kalman filter does not support inertia"):
        kalman_filter(bind_translation(problem_of(dark, growing()), "full"))
    for start in (turning, {}):
        scene = dark.replace(start=start, simulation={"model": "full"})
        problem, _ = choose.decided(problem_of(scene, growing()))
        assert problem.scene.simulation.method == "exponential"


def test_mobility_matrix_of_a_sphere_far_from_everything():
    """1/(6 pi mu r) and 1/(8 pi mu r^3), and nothing that couples them."""
    found = FREE.mobility_matrices(np.zeros((2, 3)))
    v, w = 1 / (6 * math.pi * VISCOSITY * RADIUS), 1 / (8 * math.pi * VISCOSITY * RADIUS**3)
    np.testing.assert_allclose(found, [np.diag([v, v, v, w, w, w])] * 2, rtol=1e-14, atol=0)


@pytest.mark.parametrize("normal", [1.0, -1.0])
def test_mobility_matrix_beside_a_wall(normal):
    """Faxen's and Goldman's expansions; a bead pulled along a floor rolls as a ball does."""
    beside = BesideWall(FREE, RADIUS, ((0.0, normal),))
    height = 10.0
    matrix = beside.mobility_matrices(np.array([[0.0, 0.0, normal * height * RADIUS]]))[0]
    rho = 1 / height
    along = 1 - 9 / 16 * rho + rho**3 / 8
    across = 1 - 9 / 8 * rho + rho**3 / 2
    np.testing.assert_allclose(matrix[0, 0] * FREE.translation, along, atol=2 * rho**4)
    np.testing.assert_allclose(matrix[1, 1] * FREE.translation, along, atol=2 * rho**4)
    np.testing.assert_allclose(matrix[2, 2] * FREE.translation, across, atol=2 * rho**4)
    np.testing.assert_allclose(np.diag(matrix)[3:] * FREE.rotation, 1.0, atol=rho**3)
    rolls = normal * 3 / 32 * rho**4 * (1 - 3 / 8 * rho)
    velocity = matrix @ [1.0, 0, 0, 0, 0, 0]
    np.testing.assert_allclose(RADIUS * velocity[4] / velocity[0], rolls, rtol=0.1)
    velocity = matrix @ [0, 1.0, 0, 0, 0, 0]
    np.testing.assert_allclose(RADIUS * velocity[3] / velocity[1], -rolls, rtol=0.1)


def test_mobility_matrices_are_symmetric_and_positive_definite():
    """Reciprocity, and drag that takes energy from every motion, down to near contact."""
    heights = RADIUS * (1 + np.array([1e-4, 1e-2, 0.1, 1.0, 10.0]))
    places = np.column_stack([np.zeros((5, 2)), heights])
    found = BesideWall(FREE, RADIUS, ((0.0, 1.0),)).mobility_matrices(places)
    np.testing.assert_array_equal(found, found.transpose(0, 2, 1))
    units = np.repeat([1.0, 1 / RADIUS], 3)
    assert np.linalg.eigvalsh(found / (units[:, None] * units)).min() > 0
    assert (np.abs(found[:, [0, 1], [4, 3]]) > 0).all()


@cached_njit()
def _edgewise(pose, data, mobility):
    """Mobilities of a body that falls faster the more upright its axis is."""
    for at in range(len(pose.position)):
        e = pose.orientation[at]
        upright = (e[0] ** 2 - e[1] ** 2 - e[2] ** 2 + e[3] ** 2) ** 2
        mobility.value[at, :2] = number(data, 0) * (1.0 + upright)
        mobility.value[at, 2:4] = number(data, 1)


@dataclass(frozen=True)
class Edgewise(Drag):
    """Drag by the orientation."""

    oriented = True

    def compiled(self):
        return _edgewise, packed(1 / FREE.translation, 1 / FREE.rotation)


LYING = [math.sqrt(0.5), 0.0, math.sqrt(0.5), 0.0]


def test_drag_that_asks_for_the_orientation_gets_it(dark):
    """Without one the body is upright; a scene has that of its start, and the run follows it."""
    drag, places = Edgewise(), np.zeros((2, 3))
    both = np.array([[1.0, 0, 0, 0], LYING])
    across = drag.mobility_matrices(places, orientations=both)[:, 2, 2] * FREE.translation
    np.testing.assert_allclose(across, [2.0, 1.0], rtol=1e-14)
    np.testing.assert_allclose(drag.mobilities(places).value[:, 1] * FREE.translation, 2.0)
    scene = dark.replace(start={"orientation": LYING}, simulation={"model": "overdamped"})
    problem = problem_of(scene, drag)
    np.testing.assert_allclose(problem.mobility[:3] * FREE.translation, 1.0, rtol=1e-14)
    np.testing.assert_allclose(problem.mobilities(places)[:, 2] * FREE.translation, 1.0, rtol=1e-14)
    run = integrate(bind(choose.decided(problem)[0]), np.array([0.0, 1e-3]))
    assert run.status == "complete"
    way = 1e-3 * problem.bead.weight[2] / FREE.translation
    assert run.states[-1, 2] - run.states[0, 2] == pytest.approx(way, rel=1e-9)


@kernel
def _spring_of_a_body(pose, data, wrench):
    """A spring of 3 along the body's P3, of 1 across it, in uN/m."""
    for i in range(len(pose.position)):
        e = pose.orientation[i]
        axis = (
            2 * (e[1] * e[3] + e[0] * e[2]),
            2 * (e[2] * e[3] - e[0] * e[1]),
            e[0] ** 2 - e[1] ** 2 - e[2] ** 2 + e[3] ** 2,
        )
        along = 0.0
        for k in range(3):
            along += axis[k] * pose.position[i, k]
        for k in range(3):
            wrench.force[i, k] -= 1e-6 * (pose.position[i, k] + 2 * along * axis[k])


@pytest.mark.parametrize(("orientation", "stiff"), [([1, 0, 0, 0], 2), (LYING, 0)])
def test_stiffness_is_that_of_the_orientation_at_the_start(dark, orientation, stiff):
    scene = dark.replace(
        forces={"gravity": False, "buoyancy": False}, start={"orientation": orientation}
    )
    problem = bound_once(scene, [UserForce(_spring_of_a_body, (), turns=True)])
    expected = np.ones(3)
    expected[stiff] = 3.0
    trap = problem.equilibrium
    np.testing.assert_allclose(trap.stiffness, 1e-6 * np.diag(expected), atol=1e-11)
    x = np.array([[1e-8, 2e-8, 3e-8]])
    for found in (problem.net_force(x), problem.net_force_apart(x)):
        np.testing.assert_allclose(found, -1e-6 * expected * x, rtol=1e-9)
