"""Forces by themselves and put together, against closed forms; and a user's own in a run."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import tweezer
from tests.reference.fields import GaussianWell, LinearTrap, QuarticTrap
from tweezer.forces import (
    Course,
    Moved,
    Sum,
    UserForce,
    kernel,
    matrix,
    number,
    tensor,
    vector,
)
from tweezer.forces.data import integers, packed, part, tensor_of_four
from tweezer.forces.force import bound
from tweezer.values.errors import SceneError

RNG = np.random.default_rng(101)
PLACES = RNG.normal(size=(7, 3)) * 2e-7
TIMES = RNG.uniform(0, 1e-3, 7)
WELL = GaussianWell(2e-5, 3e-7)
DARK = tweezer.load_scene("silica-1um").replace(
    forces={"optical": False, "gravity": False, "buoyancy": False}, start={"position": [0, 0, 0]}
)
BEAD = tweezer.bead_properties(DARK)
KT = 1.380649e-23 * DARK.medium.temperature
STIFFNESS = 2e-5
TRAP = BEAD.drag / STIFFNESS


@kernel
def spring(pose, data, wrench):
    stiffness, centre = number(data, 0), vector(data, 1)
    for i in range(len(pose.position)):
        for k in range(3):
            wrench.force[i, k] -= stiffness * (pose.position[i, k] - centre[k])


def own_spring(centre=(0.0, 0.0, 0.0)):
    return UserForce(spring, (STIFFNESS, centre))


# --- data -----------------------------------------------------------------------------------------


def test_entries_are_read_as_they_were_packed():
    arrays = [RNG.normal(size=shape) for shape in ((), (5,), (2, 3), (2, 3, 4), (2, 3, 4, 5))]
    whole = RNG.integers(-(2**31), 2**31, 7).astype(np.int32)
    inner = bound(WELL, gradient=False)
    within = packed(*arrays, whole, inner, 3.0)
    for entry, (read, array) in enumerate(
        zip((number, vector, matrix, tensor, tensor_of_four), arrays, strict=True)
    ):
        np.testing.assert_array_equal(read(within, entry), array)
    # data within data, twice
    outer = packed(1.0, bound(Sum((WELL, LinearTrap(1.0))), gradient=True), within.numbers)
    np.testing.assert_array_equal(integers(within, 5), whole)
    assert number(within, 7) == 3.0
    assert part(within, 6).kernel == inner.kernel
    np.testing.assert_array_equal(part(within, 6).data.numbers, inner.data.numbers)
    two = part(outer, 1).data
    assert [number(part(two, 1).data, 0), number(part(two, 1).data, 1)] == [2e-5, 3e-7]
    assert number(part(two, 2).data, 0) == 1.0


# --- put together ---------------------------------------------------------------------------------


def read(force, places=PLACES, **how):
    return force.field(places, gradient=True, **how)


def compiled(force, places=PLACES, times=0.0):
    """By the compiled kernel, whatever `field` does."""
    return super(type(force), force).field(places, gradient=True, time=times)


def assert_same(one, other, scale=1e-12):
    for name, a, b in zip(one._fields, one, other, strict=True):
        np.testing.assert_allclose(a, b, rtol=1e-12, atol=scale * np.abs(b).max(), err_msg=name)


@pytest.mark.parametrize("reading", [read, compiled])
def test_a_sum_is_the_sum_of_its_forces(reading):
    light = tweezer.optics.light_force(tweezer.load_scene("silica-1um"))
    parts = (WELL, LinearTrap(1e-6, (1e-20, 2e-20, 3e-20)), QuarticTrap(1e-6, 1e7), light)
    found = reading(Sum(parts))
    total = [np.zeros_like(each) for each in found]
    for each in parts:
        for into, value in zip(total, read(each), strict=True):
            np.add(into, value, out=into)
    assert_same(found, type(found)(*total))
    assert (found.error > 0).all()


def test_a_force_is_moved_and_made_stronger_in_time():
    """F(x - a(t)) p(t); a: a sine and a straight line, p: steps."""
    amplitude, line = np.array([1e-7, -2e-7, 3e-7]), np.array([3e-4, 0.0, -1e-4])
    place = Course(np.array([0.0, 1e-3]), np.array([0 * line, 1e-3 * line]), amplitude, 700.0, 0.4)
    steps = Course(np.array([2e-4, 2e-4, 6e-4, 6e-4]), np.array([[1.0], [2.0], [2.0], [-0.5]]),
                   np.zeros(1))  # fmt: skip
    found = read(Moved(WELL, place, steps), time=TIMES)
    a = line * TIMES[:, None] + amplitude * np.sin(2 * np.pi * 700 * TIMES + 0.4)[:, None]
    p = np.select([TIMES < 2e-4, TIMES < 6e-4], [1.0, 2.0], -0.5)
    there = read(WELL, PLACES - a)
    np.testing.assert_allclose(found.force, p[:, None] * there.force, rtol=1e-12)
    np.testing.assert_allclose(
        found.force_gradient, p[:, None, None] * there.force_gradient, rtol=1e-12, atol=1e-19
    )


def test_light_from_above_is_light_turned_over():
    """By a rotation of 180 degrees about x, with moment and gradients."""
    scene = tweezer.load_scene("silica-1um").replace(beam={"torque": "thesis"})
    light = tweezer.optics.light_force(scene)
    found = read(Moved(light, Course.constant(0.0, 0.0, 0.0), Course.constant(1.0), down=True))
    R = np.diag([1.0, -1.0, -1.0])
    there = read(light, PLACES @ R)
    np.testing.assert_allclose(found.force, there.force @ R, rtol=1e-12)
    np.testing.assert_allclose(found.moment, there.moment @ R, rtol=1e-12)
    for found_gradient, gradient in ((found.force_gradient, there.force_gradient),
                                     (found.moment_gradient, there.moment_gradient)):  # fmt: skip
        np.testing.assert_allclose(found_gradient, R @ gradient @ R, rtol=1e-12)


def test_what_looks_at_the_orientation_sees_it_turned_over():
    """A force along the bead's first axis, from above: R e_1 in the frame turned over."""
    orientations = RNG.normal(size=(7, 4))
    orientations /= np.linalg.norm(orientations, axis=1, keepdims=True)
    still = Course.constant(0.0, 0.0, 0.0), Course.constant(1.0)
    swimmer = UserForce(swim, (1e-13, 0.0), turns=True)
    np.testing.assert_allclose(
        Moved(swimmer, *still, down=True).field(PLACES, orientations=orientations).force,
        swimmer.field(PLACES, orientations=orientations).force, rtol=0, atol=1e-27,
    )  # fmt: skip


@settings(max_examples=60, deadline=None)
@given(st.lists(st.floats(0, 1), min_size=1, max_size=6), st.integers(0, 2**32), st.floats(-1, 4))
def test_a_course_goes_straight_between_its_points(gaps, seed, time):
    times = np.cumsum(np.array(gaps))
    values = np.random.default_rng(seed).normal(size=(len(gaps), 2))
    found = Course(times, values, np.zeros(2)).at(time)
    if (np.abs(times - time) > 0).all():
        expected = [np.interp(time, times, column) for column in values.T]
        np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-9)
    else:  # at a jump the last of the points holds
        np.testing.assert_array_equal(found, values[np.flatnonzero(times == time)[-1]])


def test_a_course_that_repeats_has_its_kinks_again_and_again():
    square = Course(np.array([0.0, 0.3, 0.3, 1.0]), np.array([[1.0], [1.0], [0.0], [0.0]]),
                    np.zeros(1), period=1.0)  # fmt: skip
    np.testing.assert_allclose(square.kinks(2.5), [0.3, 1.0, 1.3, 2.0, 2.3])
    assert [square.at(t)[0] for t in (0.1, 0.3, 0.9, 1.0, 1.29, 1.31, 7.2)] == [1, 0, 0, 1, 1, 0, 1]
    assert not square.steady
    assert Course.constant(1.0, 2.0).steady
    assert not Course(np.zeros(1), np.zeros((1, 1)), np.ones(1), 5.0).steady


def test_course_that_does_not_jump_at_its_period_has_no_kink_there():
    dark = Course(np.array([0.2, 0.2, 0.6, 0.6]), np.array([[0.0], [1.0], [1.0], [0.0]]),
                  np.zeros(1), period=1.0)  # fmt: skip
    np.testing.assert_allclose(dark.kinks(2.5), [0.2, 0.6, 1.2, 1.6, 2.2])
    assert dark.shortest_time(2.5) == pytest.approx(0.2)
    bends = Course(np.array([0.0, 0.5, 1.0]), np.array([[0.0], [1.0], [0.0]]), np.zeros(1),
                   period=1.0)  # fmt: skip
    np.testing.assert_allclose(bends.kinks(2.2), [0.5, 1.0, 1.5, 2.0])


def test_course_that_repeats_equals_the_course_with_every_period_written_out():
    rng = np.random.default_rng(430)
    times, values, period = np.sort(rng.uniform(0, 1, 6)), rng.normal(size=(6, 3)), 1.25
    repeated = Course(times, values, np.zeros(3), period=period)
    every = np.concatenate([[n * period, *(n * period + times), (n + 1) * period]
                            for n in range(40)])  # fmt: skip
    held = np.tile(np.concatenate([values[:1], values, values[-1:]]), (40, 1))
    written = Course(every, held, np.zeros(3))
    for time in rng.uniform(0, 50, 300):
        np.testing.assert_allclose(repeated.at(time), written.at(time), rtol=0, atol=1e-11)
    inside = repeated.kinks(50.0)
    np.testing.assert_allclose(inside, np.unique(every[(every > 0) & (every < 50)]), rtol=1e-14)


def test_course_takes_a_phase_for_each_value():
    turning = Course(np.zeros(1), np.zeros((1, 2)), [2.0, 2.0], 5.0, ["90 deg", 0.0])
    for time in (0.0, 0.03, 7.01):
        angle = 2 * np.pi * 5 * time
        np.testing.assert_allclose(
            turning.at(time), [2 * np.cos(angle), 2 * np.sin(angle)], atol=1e-11
        )
    with pytest.raises(ValueError, match="phase: must be one number, or one for each value"):
        Course(np.zeros(1), np.zeros((1, 2)), np.ones(2), 5.0, [0.0, 1.0, 2.0])


def test_gradients_of_a_force_that_has_none_are_differences():
    np.testing.assert_allclose(
        read(own_spring((1e-7, 0, 0))).force_gradient,
        np.broadcast_to(-STIFFNESS * np.eye(3), (7, 3, 3)), rtol=1e-6, atol=1e-11,
    )  # fmt: skip
    without = own_spring().field(PLACES)
    np.testing.assert_allclose(read(own_spring()).force, without.force, rtol=1e-14)


# --- in a run -------------------------------------------------------------------------------------


def test_a_bead_on_a_user_s_spring_spreads_as_boltzmann_says():
    """<x^2> = kT/k: 6 standard deviations of 3 x 12,000 samples, 1 seed in 10^9."""
    scene = DARK.replace(
        forces={"brownian": True}, simulation={"duration": 12000 * 3 * TRAP, "samples": 12001}
    )
    run = tweezer.simulate(scene, forces=[own_spring((1e-7, 0.0, 0.0))], seed=3)
    x = run["position"].values[10:] - [1e-7, 0, 0]
    error = math.sqrt(2 / x.size * (1 + math.exp(-6)) / (1 - math.exp(-6)))
    assert (x**2).mean() * STIFFNESS / KT == pytest.approx(1, abs=6 * error)
    assert run.attrs["other_forces"] == 1
    np.testing.assert_allclose(
        run["net_force"], -STIFFNESS * (run["position"].values - [1e-7, 0, 0]), rtol=1e-9
    )


@pytest.mark.parametrize(
    ("model", "method"),
    [("overdamped", "dop853"), ("overdamped", "dormand-prince"), ("full", "exponential"),
     ("overdamped", "scipy:RK45"), ("full", "scipy:LSODA")],
)  # fmt: skip
def test_a_trap_that_is_dragged_and_jumps_is_followed(model, method):
    """A spring dragged at v up to t1, and then to -d at once: x lags by v tau (1 - e^-t/tau)."""
    v, t1, d = 1e-4, 2 * TRAP, 5e-8
    course = Course(
        np.array([0.0, t1, t1]), np.array([[0, 0, 0], [v * t1, 0, 0], [-d, 0, 0]]), np.zeros(3)
    )
    scene = DARK.replace(medium={"inertia": "none"}, simulation={
        "model": model, "method": method, "duration": 5 * TRAP, "samples": 51,
        "relative_tolerance": 1e-9, "position_tolerance": 1e-15,
    })  # fmt: skip
    moved = Moved(own_spring(), course, Course.constant(1.0))
    run = tweezer.simulate(scene, forces=[moved])
    t = run["time"].values
    at_jump = v * (t1 - TRAP * (1 - math.exp(-t1 / TRAP)))
    after = -d + (at_jump + d) * np.exp(-(t - t1) / TRAP)
    expected = np.where(t < t1, v * (t - TRAP * (1 - np.exp(-t / TRAP))), after)
    # what inertia moves the bead by, with the jump's speed
    inertia = 2 * BEAD.relaxation_time * (at_jump + d) / TRAP if model == "full" else 0.0
    off = np.abs(run["position"].values[:, 0] - expected).max()
    assert off < inertia + 3e-14
    assert run.attrs["rejected_steps"] <= 2


@kernel
def swim(pose, data, wrench):
    """A push along the bead's first axis, and a moment about z."""
    push, moment = number(data, 0), number(data, 1)
    for i in range(len(pose.position)):
        e0, e1, e2, e3 = pose.orientation[i]
        wrench.force[i, 0] += push * (e0**2 + e1**2 - e2**2 - e3**2)
        wrench.force[i, 1] += push * 2 * (e1 * e2 + e0 * e3)
        wrench.force[i, 2] += push * 2 * (e1 * e3 - e0 * e2)
        wrench.moment[i, 2] += moment


@pytest.mark.parametrize("model", ["overdamped", "full"])
def test_a_bead_that_pushes_itself_swims_in_a_circle(model):
    """Turned at W, it goes round a circle of radius v/W."""
    W, v = 2 * math.pi / 1e-3, 1e-4
    scene = DARK.replace(simulation={
        "model": model, "method": "dop853", "samples": 21,
        "duration": "1 ms" if model == "overdamped" else "20 us",
        "relative_tolerance": 1e-9, "position_tolerance": 1e-15, "orientation_tolerance": 1e-11,
    }, start={"velocity": [v, 0, 0], "angular_velocity": [0, 0, W]})  # fmt: skip
    swimmer = UserForce(swim, (v * BEAD.drag, W * BEAD.rotational_drag), turns=True)
    run = tweezer.simulate(scene, forces=[swimmer])
    t, x = run["time"].values, run["position"].values
    circle = v / W * np.stack([np.sin(W * t), 1 - np.cos(W * t), 0 * t], axis=1)
    lag = 0.0 if model == "overdamped" else v * W * BEAD.relaxation_time * 20e-6
    assert np.abs(x - circle).max() < 1e-13 + lag
    assert "orientation" in run


def test_the_first_order_model_takes_the_gradient_of_a_user_s_force():
    scene = DARK.replace(
        start={"position": [1e-7, 0, 0]},
        simulation={
            "model": "first-order",
            "method": "dop853",
            "duration": 3 * TRAP,
            "samples": 101,
            "relative_tolerance": 1e-9,
            "position_tolerance": 1e-15,
        },
    )
    run = tweezer.simulate(scene, forces=[own_spring()])
    # to first order in the relaxation time: k/beta (1 + k tau/beta)
    tau = BEAD.relaxation_time
    rate = (1 + tau / TRAP) / TRAP
    t = run["time"].values[20:]
    expected = 1e-7 * (1 + tau / TRAP) * np.exp(-rate * t)
    np.testing.assert_allclose(run["position"].values[20:, 0], expected, rtol=3e-6)


def test_no_rotation_is_followed_for_a_force_that_turns_nothing():
    run = tweezer.simulate(DARK, "10 us", forces=[own_spring()])
    assert "orientation" not in run


def test_what_is_no_force_is_refused():
    with pytest.raises(SceneError, match="forces: must be a list of"):
        tweezer.simulate(DARK, "1 us", forces=[spring])


def test_a_force_that_looks_at_the_orientation_is_asked_with_one():
    """Of places alone: not turned."""
    swimmer = UserForce(swim, (1e-13, 0.0), turns=True)
    np.testing.assert_allclose(swimmer.field(np.zeros((50, 3))).force, [[1e-13, 0, 0]] * 50)
    thermal = DARK.replace(forces={"brownian": True}, simulation={"samples": 3})
    run = tweezer.simulate(thermal, "10 us", forces=[swimmer])
    assert "orientation" in run
    for changes in ({"model": "first-order"}, {"method": "harmonic", "model": "overdamped"}):
        with pytest.raises(SceneError, match="follows no force that turns the bead"):
            tweezer.simulate(thermal.replace(simulation=changes), "1 us", forces=[swimmer])


@pytest.mark.parametrize(
    "wrong",
    [
        lambda: Course(np.array([0.0, 1.0]), np.array([1.0, 2.0]), np.zeros(1)),
        lambda: Course(np.array([1.0, 0.0]), np.zeros((2, 1)), np.zeros(1)),
        lambda: Course(np.zeros(1), np.zeros((1, 1)), np.zeros(1), frequency=-1.0),
        lambda: Course(np.zeros(1), np.full((1, 1), np.nan), np.zeros(1)),
        lambda: Moved(WELL, Course.constant(0.0, 0.0), Course.constant(1.0)),
        lambda: UserForce(lambda pose, data, wrench: None),
    ],
)
def test_what_cannot_be_put_together_is_refused(wrong):
    with pytest.raises(ValueError, match=r"do not fit|ascend|negative|numbers|courses|decorator"):
        wrong()


def test_whole_numbers_are_numbers():
    force = UserForce(spring, (np.array(3, np.int32), [1, 2, 3]))
    np.testing.assert_allclose(force.field(np.zeros((1, 3))).force, [[3, 6, 9]])


def test_places_that_cannot_be_written_are_read():
    places = PLACES.copy()
    places.flags.writeable = False
    np.testing.assert_array_equal(WELL.field(places).force, WELL.field(PLACES).force)
