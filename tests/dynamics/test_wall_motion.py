"""Deterministic motion beside a wall: settling, contact, the pick-up by a trap, and refusals.

Friction towards the wall is here Brenner's sum (Chem. Eng. Sci. 16:242 (1961)) in plain NumPy.
"""

import dataclasses
import math

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

import tweezer
from tests.reference.fields import LinearTrap, in_place
from tweezer.dynamics import bind, bound_once, choose
from tweezer.dynamics.walk import walk
from tweezer.fluid import BesideWall
from tweezer.values.errors import SceneError

RADIUS, VISCOSITY = 1e-6, 1e-3
DRAG = 6 * math.pi * VISCOSITY * RADIUS
TIGHT = {"relative_tolerance": 1e-11, "position_tolerance": 1e-15}


def friction(gap):
    """F/(6 pi eta a U) towards a wall, by the gap over the radius."""
    al = np.arccosh(1 + gap)
    n = np.arange(1, 30 + int(45 / al))
    with np.errstate(over="ignore"):
        upper = 2 * np.sinh((2 * n + 1) * al) + (2 * n + 1) * np.sinh(2 * al)
        lower = 4 * np.sinh((n + 0.5) * al) ** 2 - ((2 * n + 1) * np.sinh(al)) ** 2
        ratio = np.where(np.isfinite(upper / lower), upper / lower, 1.0)
    terms = n * (n + 1) / ((2 * n - 1) * (2 * n + 3)) * (ratio - 1)
    return 4 / 3 * np.sinh(al) * terms.sum()


@pytest.fixture(scope="module")
def falling():
    """3 um above the wall, in the dark."""
    return tweezer.load_scene("silica-1um").replace(
        bead={"radius": RADIUS},
        medium={"viscosity": VISCOSITY},
        forces={"optical": False},
        wall={"position": "-4 um"},
        start={"position": [0, 0, 0]},
        simulation={**TIGHT, "model": None, "samples": 41},
    )


def with_own_forces(scene, field):
    """`scene` in a field in place of the light."""
    return in_place(bound_once(scene), field)


@pytest.mark.parametrize("side", ["above", "below"])
@pytest.mark.parametrize(
    ("model", "method"),
    [("overdamped", "exponential"), ("overdamped", "dop853"), ("full", "exponential")],
)
def test_a_bead_settles_as_brenner_has_it(falling, model, method, side):
    """t = int friction(g) beta a dg/W from gap to gap: by quadrature of the exact sum."""
    scene = falling.replace(simulation={"model": model, "method": method, "duration": "4.4 s"})
    if side == "below":  # the bead rises to a wall above it
        wall = {"position": "4 um", "side": "below"}
        scene = scene.replace(wall=wall, forces={"gravitational_acceleration": -9.80665})
    run = tweezer.simulate(scene)
    pull = abs(tweezer.bead_properties(scene).weight[2])
    gaps = scene.gap(run["position"].sel(axis="z").values) / RADIUS
    assert gaps[-1] < 0.05
    took = [quad(friction, gap, 3.0, epsrel=1e-10, limit=200)[0] for gap in gaps[4::9]]
    times = np.array(took) * DRAG * RADIUS / pull
    np.testing.assert_allclose(run["time"].values[4::9], times, rtol=3e-6)
    error = float(run.attrs["integration_error"])
    assert error < 1e-12


def test_a_bead_rests_on_the_wall_and_is_picked_up(falling):
    """Pressed by 5 pN it stops within 0.3 nm, and leaves as fast as lubrication lets it."""
    trap = {"power": "40 mW", "modulation": {"kind": "steps", "times": [0, 1.0], "factors": [0, 1]}}
    scene = falling.replace(
        beam=trap, forces={"optical": True}, optics={"evaluator": "map"}, bead={"density": 10_000},
        wall={"position": "-2.2 um"}, start={"position": [0, 0, "-1.1 um"]},
        simulation={"duration": "2 s", "position_tolerance": 1e-12, "relative_tolerance": 1e-8},
    )  # fmt: skip
    run = tweezer.simulate(scene)
    gap = scene.gap(run["position"].sel(axis="z").values)
    assert run.attrs["status"] == "complete"
    assert (gap > 0).all()
    before = run["time"].values < 1.0
    assert 0.1e-9 < gap[before][-1] < 0.3e-9
    # At rest the steps leave the gap between 0.208 and 0.262 nm, beyond the tolerance of 1e-12 m.
    # Two samples may agree by chance, so all of the last eight are compared.
    assert np.ptp(gap[before][-8:]) < 8e-11
    assert gap[-1] > 0.5e-6
    assert abs(run["position"].sel(axis="z").values[-1]) < 0.5e-6


@pytest.mark.parametrize("viscosity", [2e-5, 2e-4])
def test_friction_that_stands_still_for_a_step_is_of_order_two(falling, viscosity):
    """Inertia of a sphere in a trap beside a wall, in air or thin oil, against Radau's method."""
    stiffness, start = 2e-5, 0.6e-6
    scene = falling.replace(
        medium={"viscosity": viscosity, "inertia": "none"},
        forces={"gravity": False, "buoyancy": False},
        wall={"position": "-1.3 um"},
        start={"position": [0, 0, start]},
        simulation={"model": "full", "method": "exponential", "duration": "400 us", "samples": 11},
    )
    mass = tweezer.bead_properties(scene).mass
    free = 6 * math.pi * viscosity * RADIUS

    def rates(_, y):
        drag = free * friction((y[0] + 0.3e-6) / RADIUS)
        return [y[1], (-stiffness * y[0] - drag * y[1]) / mass]

    exact = solve_ivp(
        rates, (0, 400e-6), [start, 0.0], "Radau", rtol=1e-10, atol=[1e-17, 1e-13],
        t_eval=np.linspace(0, 400e-6, 11),
    ).y[0]  # fmt: skip
    errors = []
    for steps in (256, 512):
        problem = with_own_forces(
            scene.replace(simulation={"step": 400e-6 / steps}), LinearTrap(stiffness)
        )
        run = tweezer.dynamics.integrate(bind(problem), np.linspace(0, 400e-6, 11))
        errors.append(np.abs(run.states[:, 2] - exact).max())
    assert 1.8 < math.log2(errors[0] / errors[1]) < 2.2
    assert errors[-1] < 1e-3 * start
    chosen = with_own_forces(scene, LinearTrap(stiffness))
    run = tweezer.dynamics.integrate(bind(chosen), np.linspace(0, 400e-6, 11))
    assert np.abs(run.states[:, 2] - exact).max() < 1e-12


def test_between_two_walls_resistances_add_up():
    free = tweezer.load_scene("silica-1um").replace(
        wall={"position": "-2 um", "opposite": "9 um"}, start={"position": [0, 0, 0]}
    )
    radius = free.bead.radius
    problem = bound_once(free)
    assert isinstance(problem.drag, BesideWall)
    z = np.array([-1.2e-6, 0.0, 5e-6, 8.2e-6])
    places = np.column_stack([0 * z, 0 * z, z])
    both = problem.drag.mobilities(places, gradient=True)
    sums = np.array([friction((h + 2e-6) / radius - 1) + friction((9e-6 - h) / radius - 1) - 1
                     for h in z])  # fmt: skip
    np.testing.assert_allclose(both.value[:, 1] * problem.bead.drag, 1 / sums, rtol=1e-6)
    beside = np.array([0, 0, 1e-10])
    ahead = problem.drag.mobilities(places + beside).value
    behind = problem.drag.mobilities(places - beside).value
    slopes = (ahead - behind) / 2e-10
    scale = np.abs(slopes).max(axis=0)
    assert (np.abs(both.gradient[:, :, 2] - slopes) < 1e-6 * scale).all()
    # beside the nearer wall alone what rolls is nearly that of one; far above it the sign changes
    assert both.value[0, 4] > 0 > both.value[-1, 4]


def test_equilibria_are_in_the_fluid(falling):
    """A trap whose focus is in the wall holds the bead against the wall, not behind it."""
    scene = falling.replace(
        forces={"optical": True},
        optics={"evaluator": "map"},
        wall={"position": "-0.6 um"},
        start={"position": [0, 0, "1 um"]},
    )
    place = bound_once(scene).equilibrium
    assert place is not None
    assert 0 < scene.gap(place.position[2]) < 0.4e-9
    hard = scene.replace(forces={"brownian": True}, wall={"position": "-0.6 um"})
    problem = bound_once(hard)  # thermal motion needs no contact: nothing holds the bead there
    places = problem.equilibria(problem.net_force)
    assert all(scene.gap(each.position[2]) > 1e-6 for each in places)


def test_what_the_run_says_of_the_model(falling):
    """Beside a wall the fluid's inertia is left out, and the lag by it is quoted."""
    scene = falling.replace(simulation={"duration": "1 s", "model": "full"})
    run = tweezer.simulate(scene)
    assert run.attrs["fluid_inertia"] == "none"
    velocity = np.linalg.norm(run["velocity"].values, axis=1)
    height = scene.gap(run["position"].sel(axis="z").values) + RADIUS
    reached = np.minimum(run["time"].values, height**2 / (VISCOSITY / scene.medium.density))
    lag = 2 * np.sqrt(RADIUS**2 * scene.medium.density / VISCOSITY * reached / math.pi)
    assert run.attrs["model_error"] == pytest.approx((lag * velocity).max(), rel=1e-6)


def test_memory_and_a_wall(falling):
    """Nearer than 20 radii it is refused; farther what is left out is said."""
    near = {"wall": {"position": "-19 um"}, "medium": {"inertia": "memory"}}
    with pytest.raises(SceneError, match=r"medium.inertia = 'memory': a wall within"):
        falling.replace(**near)
    scene = falling.replace(wall={"position": "-25 um"}, medium={"inertia": "memory"})
    problem, why = choose.decided(bound_once(scene))
    assert problem.drag.uniform
    assert "2.2 % along it and 4.5 % across" in why
    run = tweezer.simulate(scene.replace(simulation={"duration": "1 ms"}))
    way = abs(float(run["position"].sel(axis="z").values[-1]))
    held = 1 - 1 / friction(24.0)
    assert run.attrs["model_error"] == pytest.approx(held * way, rel=0.01)
    sinking = scene.replace(bead={"density": 10_000}, simulation={"duration": "0.5 s"})
    for brownian in (False, True):  # it ends where the wall is no longer far
        run = tweezer.simulate(sinking.replace(forces={"brownian": brownian}))
        assert run.attrs["status"] == "lost"
        heights = scene.gap(run["position"].sel(axis="z").values) / RADIUS + 1
        assert 19.9 < heights.min() < 20.6
    near = {"drawn": "ball", "ball_radius": "6 um"}
    with pytest.raises(SceneError, match="must be nearer than"):
        tweezer.simulate(scene.replace(start=near, forces={"brownian": True}))


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"wall": {"position": "-0.9 um"}}, "must start beside wall, not in it"),
        ({"wall": {"position": "-4 um", "opposite": "10 um"}}, "must be at least 20 radii"),
        ({"wall": {"position": "-4 um", "opposite": "-30 um"}}, "must be on the side of the bead"),
        ({"wall": {"position": "-29 um", "opposite": "0.5 um"}}, "beside wall.opposite"),
        ({"wall": {"position": "4 um"}}, "must start beside wall"),
        ({"wall": {"position": 1.0}}, "must be from -0.01 to 0.01 m"),
        ({"wall": {"position": "-2 um", "side": "left"}}, "allowed: 'above' or 'below'"),
        ({"wall": {"side": "above"}, "lens": {"cover": None}}, None),
    ],
)
def test_a_wall_that_cannot_be_is_refused(falling, changes, words):
    if words is None:
        with pytest.raises(SceneError, match=r"wall\.position: missing"):
            tweezer.load_scene("silica-1um").replace(wall={})
        return
    with pytest.raises(SceneError, match=words):
        falling.replace(**changes)


def test_a_wall_out_of_reach_of_the_light():
    """1 cm away nothing asks for the light next to it: trap, thermal motion, heights."""
    scene = tweezer.load_scene("silica-1um").replace(wall={"position": "-1 cm"})
    assert tweezer.characterise(scene).equilibrium is not None
    heights = tweezer.trap_over_heights(scene, [1e-5, 1e-3])
    assert list(heights["state"].values) == ["held", "held"]
    run = tweezer.simulate(scene.replace(forces={"brownian": True}), duration="20 us", seed=1)
    assert run.attrs["status"] == "complete"


def test_with_a_cover_the_wall_is_its_face():
    scene = tweezer.load_scene("silica-1um").replace(
        lens={"cover": {"refractive_index": 1.518, "depth": "2 um"}}, wall={}
    )
    assert scene.wall.position == -2e-6
    deeper = scene.replace(lens={"cover": {"depth": "3 um"}})
    assert (deeper.wall.position, deeper.gap(0.0)) == (-3e-6, 2.5e-6)
    assert tweezer.load_scene(deeper.model_dump(exclude_none=True)) == deeper
    for wall in ({"position": "-2.5 um"}, {"position": "2 um", "side": "below"}):
        with pytest.raises(SceneError, match=r"with lens.cover the wall is its face"):
            scene.replace(wall=wall)


def test_a_bead_beside_the_wall_keeps_its_way_in_mirror_image(falling):
    """The same motion with everything upside down: light excluded, an own field, roll and all."""
    scene = falling.replace(
        wall={"position": "-1.5 um"},
        start={"position": ["0.3 um", "0.1 um", "0.2 um"]},
        simulation={"duration": "20 ms", "samples": 5, "model": "overdamped"},
    )
    upside_down = scene.replace(
        wall={"position": "1.5 um", "side": "below"},
        start={"position": ["0.3 um", "0.1 um", "-0.2 um"]},
        forces={"gravitational_acceleration": -9.80665},
    )
    times = np.linspace(0, 0.02, 5)
    ways = [
        tweezer.dynamics.integrate(bind(with_own_forces(each, LinearTrap(3e-6))), times).states
        for each in (scene, upside_down)
    ]
    np.testing.assert_allclose(ways[0][:, :3], ways[1][:, :3] * [1, 1, -1], atol=1e-15)


def test_a_wall_far_away_changes_nothing(falling):
    """At 1 mm the mobility is 1e-3 less: the way is shorter by that."""
    scene = falling.replace(
        simulation={"duration": "1 ms", "model": "full"}, medium={"inertia": "none"}
    )
    ways = []
    for wall in ({"position": "-1 mm"}, None):
        run = tweezer.simulate(scene.replace(wall=wall))
        ways.append(run["position"].sel(axis="z").values[-1])
    assert ways[0] / ways[1] == pytest.approx(1 - 9 / 8 * 1e-3, abs=1e-6)


@pytest.mark.parametrize("model", ["overdamped", "full"])
def test_rotation_beside_a_wall(falling, model):
    """A bead that is turned and pulled, by the exponential method and by one that knows no drag."""
    scene = falling.replace(
        wall={"position": "-1.7 um"},
        start={"position": ["0.8 um", "0.3 um", "-0.4 um"], "angular_velocity": [100, 20, 5]},
        simulation={"duration": "5 ms", "model": model, "orientation_tolerance": 1e-12},
    )
    times, field = np.linspace(0, 5e-3, 11), LinearTrap(2e-5, (3e-18, 1e-18, -2e-18))
    found = []
    for method in ("exponential", "scipy:LSODA"):
        equations = bind(in_place(bound_once(scene.replace(simulation={"method": method})), field))
        run = tweezer.dynamics.integrate(equations, times)
        found.append(equations.motion(run.times, run.states))
    ours, theirs = found
    # with inertia what rolls is left out of the relaxation: tau times the angular velocity
    position, angle = (2e-14, 2e-5) if model == "full" else (1e-15, 1e-9)
    np.testing.assert_allclose(ours.position, theirs.position, atol=position)
    np.testing.assert_allclose(ours.orientation, theirs.orientation, atol=angle)
    fastest = np.abs(theirs.angular_velocity).max()
    off = np.abs(ours.angular_velocity - theirs.angular_velocity)[1:].max()
    assert off < angle * fastest


def test_a_bead_pulled_along_a_wall_rolls(falling):
    """omega r/v is the roll of the mobilities."""
    scene = falling.replace(
        wall={"position": "-1.1 um"},
        start={"angular_velocity": [1e-3, 0, 0]},
        forces={"gravity": False, "buoyancy": False},
        simulation={"duration": "1 ms", "model": "overdamped"},
    )
    problem = with_own_forces(scene, LinearTrap(1e-6))
    problem = dataclasses.replace(problem, scene=scene.replace(start={"position": [1e-6, 0, 0]}))
    run = tweezer.dynamics.integrate(bind(problem), np.linspace(0, 1e-3, 3))
    found = bind(problem).motion(run.times, run.states)
    roll = float(tweezer.wall_mobilities(0.1)["roll"])
    np.testing.assert_allclose(
        found.angular_velocity[:, 1] * RADIUS / found.velocity[:, 0], roll, rtol=1e-6
    )


@pytest.mark.parametrize("side", ["above", "below"])
@pytest.mark.parametrize(("method", "model"), [("heun", "overdamped"), ("one-call", "overdamped"),
                                               ("heun", "full")])  # fmt: skip
def test_a_strong_pull_leads_thermal_motion_as_any_other(falling, method, model, side):
    """A trap of nanonewtons and a moment: the mean of 100 beads is at the deterministic place.

    Within five standard deviations of that mean: exceeded by a right program for one seed in 1e6 a
    number.
    """
    sign = 1.0 if side == "above" else -1.0
    turns = model == "overdamped"
    scene = falling.replace(
        wall={"position": -1.3e-6 * sign, "side": side},
        start={"position": [0.7e-6, 0.4e-6, 0.5e-6 * sign]},
        forces={"brownian": True, "brownian_torque": turns, "gravity": False, "buoyancy": False},
        simulation={"model": model, "method": method, "step": 2e-8, "duration": "20 us",
                    "samples": 3, "loss_distance": 1e-3},
    )  # fmt: skip
    field = LinearTrap(1e-3, (3e-16, -2e-16, 2e-16) if turns else (0.0, 0.0, 0.0))
    thermal = walk(scene, seed=8)
    thermal = dataclasses.replace(thermal, problem=in_place(thermal.problem, field))
    who = np.arange(100)
    states, out = thermal.start(who), np.empty((100, 2, len(thermal.columns)))
    thermal.advance(states, who, 0, out)

    still = scene.replace(
        forces={"brownian": False, "brownian_torque": False},
        start={"angular_velocity": [1e-9, 0, 0] if turns else [0, 0, 0]},
        simulation={"method": "exponential", "step": None},
    )
    equations = bind(in_place(bound_once(still), field))
    times = np.linspace(0, 20e-6, 3)
    found = equations.motion(times, tweezer.dynamics.integrate(equations, times).states)
    quantities = {"x": found.position}
    if turns:
        quantities["e0"] = found.orientation
    for name, expected in quantities.items():
        at = thermal.columns.index(name)
        drawn = out[:, :, at : at + expected.shape[1]]
        spread = drawn.std(axis=0, ddof=1) / math.sqrt(len(who))
        assert (np.abs(drawn.mean(axis=0) - expected[1:]) < 5 * spread).all()
        moved = np.abs(expected[2] - expected[0])
        assert (spread[1] < 0.02 * moved.max()).all()
