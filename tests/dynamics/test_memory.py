"""Motion without noise in a fluid with inertia: against closed forms, and the exact memory."""

import json
import math

import numpy as np
import pytest

import tweezer
from tests.reference.fields import in_trap
from tests.reference.fluid import Path, Sphere
from tweezer.dynamics import bind, bound_once, decided
from tweezer.dynamics.integrate import integrate

DARK = {"optical": False, "gravity": False, "buoyancy": False}


def remembering(poles=40, **sections):
    """The 1 um silica bead without light and weight, at tight tolerances."""
    simulation = {"model": "full", "method": "exponential", "relative_tolerance": 1e-12,
                  "position_tolerance": 1e-17} | sections.pop("simulation", {})  # fmt: skip
    scene = tweezer.load_scene("silica-1um").replace(
        medium={"inertia": "memory", "poles": poles}, forces=DARK, simulation=simulation,
        **sections,
    )  # fmt: skip
    bead = tweezer.bead_properties(scene)
    return scene, Sphere(bead.mass, bead.drag, bead.displaced_mass)


@pytest.mark.parametrize(("poles", "error"), [(24, 5e-6), (40, 3e-7)])
def test_a_bead_in_a_spring_returns_as_the_closed_form(poles, error):
    """Released at rest: over the axis, and back as t^(-3/2)."""
    start, stiffness = 1e-7, 5e-5
    scene, sphere = remembering(
        poles, start={"position": [start, 0, 0]}, simulation={"duration": "20 ms"}
    )
    times = np.append(0.0, np.geomspace(1e-8, 20e-3, 60))
    found = integrate(in_trap(bind(scene), stiffness), times).states[:, 0] / start
    expected = np.append(1.0, sphere.relaxation(times[1:], stiffness))
    assert np.abs(found - expected).max() < error
    assert -6e-4 < found.min() < -4e-4
    trap = sphere.drag / stiffness  # the tail, to its first correction
    tail = -trap * math.sqrt(sphere.vorticity_time / (4 * math.pi)) * times[-1] ** -1.5
    assert found[-1] == pytest.approx(tail, rel=0.15)


def test_a_bead_settles_and_is_struck_as_the_closed_forms():
    """Under its weight from rest; and struck to a velocity in fluid at rest."""
    scene, sphere = remembering(simulation={"duration": "1 ms", "samples": 101})
    falling = tweezer.simulate(scene.replace(forces={"gravity": True}))
    weight = tweezer.bead_properties(scene.replace(forces={"gravity": True})).weight[2]
    t = falling["time"].values[1:]
    z, speed = falling["position"].values[1:, 2], falling["velocity"].values[1:, 2]
    np.testing.assert_allclose(z - falling["position"].values[0, 2], weight * sphere.moved(t),
                               rtol=1e-6)  # fmt: skip
    np.testing.assert_allclose(speed, weight * sphere.settling(t), rtol=1e-6)

    struck = tweezer.simulate(scene.replace(start={"velocity": [0.01, 0, 0]}))
    v = struck["velocity"].values[:, 0]
    assert v[0] == pytest.approx(0.01, rel=1e-12)
    np.testing.assert_allclose(v[1:], 0.01 * sphere.velocity_correlation(t), atol=1e-8)
    impulse = 0.01 * sphere.total_mass
    moved = struck["position"].values[1:, 0] - struck["position"].values[0, 0]
    np.testing.assert_allclose(moved, impulse * sphere.settling(t), rtol=1e-5)


def test_a_capture_with_the_exact_memory():
    """The thesis's 990 nm bead in its light, by Volterra's equation: 71 nm behind at 6 ms."""
    end = 6e-3
    scene = tweezer.load_scene("thesis-990nm").replace(
        medium={"inertia": "memory"},
        optics={"evaluator": "quadrature", "tolerance": 1e-9},
        simulation={"model": "full", "scaling_factor": None, "method": "auto", "duration": end,
                    "samples": 7},
    )  # fmt: skip
    problem = bound_once(scene)
    bead = problem.bead
    sphere = Sphere(bead.mass, bead.drag, bead.displaced_mass)
    exact = Path(sphere, problem.net_force, scene.start_position, end, tolerance=1e-13)
    run = tweezer.simulate(scene)
    places = exact(run["time"].values[1:])
    assert np.abs(run["position"].values[1:] - places).max() < 1e-12
    assert run.attrs["integration_error"] < 2e-11
    assert run.attrs["model_error"] == 0
    # as the design's prototype found it with the exact kernel
    assert places[-1] * 1e6 == pytest.approx([0, -0.8483, -2.0120], abs=2e-4)

    without = tweezer.simulate(scene.replace(medium={"inertia": "none"}))
    apart = np.linalg.norm(without["position"].values - run["position"].values, axis=1)
    assert apart[-1] == pytest.approx(71e-9, abs=1e-9)
    assert without.attrs["model_error"] == pytest.approx(apart.max(), rel=0.02)
    assert run.attrs["force_calls"] < 1.6 * without.attrs["force_calls"]


def test_few_poles_are_told_in_the_error():
    scene, _ = remembering(8, simulation={"duration": "1 ms", "samples": 101})
    scene = scene.replace(forces={"optical": True})
    few = tweezer.simulate(scene)
    many = tweezer.simulate(scene.replace(medium={"poles": 40}))
    off = np.linalg.norm(few["position"].values - many["position"].values, axis=1).max()
    assert off > 1e-11
    assert off < few.attrs["integration_error"] < 10 * off
    assert few.attrs["fluid_inertia"] == "memory, 8 poles"


@pytest.mark.parametrize("viscosity", [1e-3, 0.05, 0.2, 1.4])
def test_integration_error_contains_the_missing_poles(viscosity):
    """Compared with 40 poles and tighter tolerances. From 8 to 12 poles little changes."""
    scene = tweezer.load_scene("silica-1um").replace(
        medium={"viscosity": viscosity},
        optics={"theory": "rays", "evaluator": "map"},
        simulation={"model": "full", "duration": 0.05, "samples": 201},
    )
    run = tweezer.simulate(scene)
    finer = tweezer.simulate(
        scene.replace(medium={"inertia": "memory", "poles": 40}), tolerance=1e-10
    )
    off = np.linalg.norm(finer["position"].values - run["position"].values, axis=1).max()
    assert off < run.attrs["integration_error"] < 5 * off


def test_poles_follow_duration_and_tolerance():
    def poles(**simulation):
        scene = tweezer.load_scene("silica-1um").replace(simulation=simulation)
        return decided(bound_once(scene))[0].scene.medium.poles

    found = [poles(position_tolerance=each) for each in ("1 nm", "10 pm", "1 pm", "0.01 pm")]
    assert found == sorted(found)
    assert found[0] < found[1] < found[-1]
    assert poles(duration="10 us") < poles(duration="10 ms")


def test_added_mass_is_one_mode():
    scene, sphere = remembering(None, start={"velocity": [0.01, 0, 0]},
                                simulation={"duration": "1 us", "samples": 11})  # fmt: skip
    scene = scene.replace(medium={"inertia": "added-mass", "poles": None})
    run = tweezer.simulate(scene)
    tau = sphere.total_mass / sphere.drag
    t = run["time"].values
    np.testing.assert_allclose(run["velocity"].values[:, 0], 0.01 * np.exp(-t / tau), rtol=1e-10)


def test_a_rigid_body_without_memory_is_told_its_lag():
    scene = tweezer.load_scene("silica-1um").replace(
        bead={"moments_of_inertia": [4e-29, 5e-29, 6e-29]},
        start={"angular_velocity": [10.0, 0, 0]},
        simulation={"model": "full", "method": "dop853", "duration": "20 us", "samples": 21},
    )
    run = tweezer.simulate(scene)
    assert "no inertia of the fluid" in run.attrs["chosen"]
    speed = np.linalg.norm(run["velocity"].values[-1])
    tau = tweezer.bead_properties(scene).vorticity_time
    lag = 2 * math.sqrt(tau * 20e-6 / math.pi) * speed
    assert run.attrs["model_error"] == pytest.approx(lag, rel=0.1)


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        (
            {"simulation": {"model": "overdamped"}},
            "falls behind by up to 3.6e-05 s times its speed",
        ),
        ({"simulation": {"model": "first-order"}}, "set simulation.model to full or scaled"),
        ({"simulation": {"method": "dop853"}}, "set simulation.method to auto or exponential"),
        (
            {"medium": {"inertia": "none", "poles": 16}},
            "does not apply to inertia = 'none'; remove it",
        ),
    ],
)
def test_what_has_no_memory_is_refused(changes, told):
    memory = {"medium": {"inertia": "memory"}}
    with pytest.raises(tweezer.SceneError, match=told):
        tweezer.load_scene("silica-1um").replace(**memory | changes)


@pytest.mark.parametrize("inertia", ["none", "added-mass", "memory", None])
def test_moments_of_a_bead_that_does_not_rotate_change_nothing(inertia):
    scene = tweezer.load_scene("silica-1um").replace(
        medium={"inertia": inertia}, simulation={"duration": "10 us", "samples": 3}
    )
    run = tweezer.simulate(scene.replace(bead={"moments_of_inertia": [4e-29, 5e-29, 6e-29]}))
    np.testing.assert_array_equal(run["position"], tweezer.simulate(scene)["position"])


def test_a_memory_is_not_in_the_rates_for_other_solvers():
    equations = bind(tweezer.load_scene("silica-1um").replace(medium={"inertia": "memory"}))
    for of in (equations.rhs, equations.jacobian):
        with pytest.raises(
            tweezer.SceneError, match="`rhs` and `jacobian` cannot follow the memory"
        ):
            of(0.0, equations.initial_state)


def test_poles_where_there_is_no_memory_are_refused():
    scene = tweezer.load_scene("silica-1um").replace(medium={"poles": 24})
    with pytest.raises(
        tweezer.SceneError,
        match="poles = 24: requires the memory of the fluid, but the method dop853 cannot",
    ):
        tweezer.simulate(scene, method="dop853")


def test_a_number_of_poles_without_a_table_is_refused():
    scene = tweezer.load_scene("silica-1um").replace(medium={"poles": 17})
    with pytest.raises(tweezer.SceneError, match=r"medium.poles = 17: allowed: 8, 10, 12, .*, 40"):
        tweezer.simulate(scene)


def test_a_run_says_what_inertia_it_had(tmp_path):
    scene = tweezer.load_scene("silica-1um").replace(simulation={"duration": "10 us"})
    run = tweezer.simulate(scene)
    medium = json.loads(run.attrs["scene"])["medium"]
    assert medium["inertia"] == "memory"
    assert run.attrs["fluid_inertia"] == f"memory, {medium['poles']} poles"
    assert f"memory of {medium['poles']} poles" in run.attrs["chosen"]
    assert "inertia" not in json.loads(run.attrs["scene_as_given"])["medium"]
