"""How long a trap holds its bead: closed forms, another solver, and the power for an hour."""

import dataclasses
import math

import numpy as np
import pytest

import tweezer
from tests.reference import exit_times
from tweezer.dynamics import bound_once
from tweezer.trap.exit_time import Grid, Region
from tweezer.trap.holding import LONGEST, Lifetime, _extrapolated, _field, _log_escape_time

#: J, s/kg, m
THERMAL, MOBILITY, RADIUS = 4e-21, 1e8, 1e-6


def silica(**changes):
    return tweezer.load_scene("silica-1um").replace(**changes)


def weak(**changes):
    """A trap of a few k_B T, whose ball ends 1.5 um from the focus."""
    return silica(
        bead={"diameter": "0.3 um", "refractive_index": 1.57, "density": "1050 kg/m^3"},
        beam={"power_through_pupil": "0.9 mW"},
        simulation={"loss_distance": "1.5 um"},
    ).replace(**changes)


@pytest.mark.parametrize("depth", [0, 2, 10, 25, 60])
def test_spring_in_a_ball(depth):
    """Up to 1e21 s, where subtracting anything would leave nothing."""
    stiffness = 2 * depth * THERMAL / RADIUS**2

    def field(rho, z):
        mobile = np.full_like(z, MOBILITY)
        return -stiffness * rho, -stiffness * z, mobile, mobile

    log, error = _log_escape_time(Region(RADIUS, 12e-9), field, (0.0, 0.0), THERMAL)
    expected = math.log(exit_times.of_spring(depth, RADIUS, THERMAL * MOBILITY))
    assert abs(log - expected) < max(error, 2e-3)
    assert error < 0.1


@pytest.mark.parametrize("wall", [None, -0.25e-6, 0.05e-6])
def test_barrier_with_a_mobility_that_changes_along_it(wall):
    """Across the axis a stiff spring, so that the way is a line; below a wall that lets none out.

    The spring changes along the line: the field has no potential.
    """
    scale, barrier = 0.3e-6, 12 * THERMAL

    def along(z):
        return -6 * barrier / scale * (z / scale) * (1 - z / scale) * (z > -0.7e-6)

    def mobility(z):
        return MOBILITY * (1 + 0.5 * np.tanh(z / scale))

    def field(rho, z):
        stiff = 4000 * THERMAL / RADIUS**2 * (1 + 0.5 * np.sin(z / 0.2e-6))
        return -stiff * rho, along(z), mobility(z), mobility(z)

    low = -math.inf if wall is None else wall
    log, error = _log_escape_time(Region(0.6e-6, 8e-9, low=low), field, (0.0, 0.1e-6), THERMAL)
    z = np.linspace(max(low, -0.6e-6), 0.6e-6, 200_001)
    expected = exit_times.along_a_line(
        z, along(z), THERMAL * mobility(z), THERMAL, 0.1e-6, wall=wall is not None
    )
    assert abs(log - math.log(expected)) < error + 0.02
    assert error < 0.05


def test_a_narrow_trap_far_from_the_focus_has_closer_nodes():
    """By those of the focus the error would be 0.4."""
    height, scale, barrier = 0.5e-6, 0.3e-6, 12 * THERMAL

    def along(z):
        x = (z - height) / scale
        return -6 * barrier / scale * x * (1 - x) * (x > -2)

    def field(rho, z):
        mobile = np.full_like(z, MOBILITY)
        return -4000 * THERMAL / RADIUS**2 * rho, along(z), mobile, mobile

    region = Region(1.1e-6, 30e-9)
    log, error = _log_escape_time(region, field, (0.0, height), THERMAL)
    z = np.linspace(-0.1e-6, 1.1e-6, 200_001)
    diffusion = THERMAL * MOBILITY
    expected = exit_times.along_a_line(z, along(z), diffusion, THERMAL, height, wall=True)
    assert abs(log - math.log(expected)) < error + 0.01
    assert error < 0.05 < _extrapolated(region, field, (0.0, height), THERMAL)[1]


def test_work_between_nodes_is_that_of_a_force_that_bends():
    """To a tenth of what the force in the middle alone would give."""
    wave = 2 * math.pi / 0.8e-6

    def field(rho, z):
        mobile = np.full_like(z, MOBILITY)
        return np.zeros_like(z), 1e-14 * np.cos(wave * z), mobile, mobile

    grid = Grid.of(Region(RADIUS, 40e-9), field, THERMAL)
    work, z = grid.upwards.work[:, 0] * THERMAL, grid.along
    middle = 1e-14 * np.cos(wave * (z[1:] + z[:-1]) / 2) * np.diff(z)
    exact = np.diff(1e-14 * np.sin(wave * z)) / wave
    counted = np.abs(z[1:]) < 0.7 * RADIUS
    error = np.abs(work - exact)[counted].max()
    assert error < 0.2 * np.abs(middle - exact)[counted].max()


def test_bead_beside_a_wall_has_its_weight_and_the_mobility_there():
    scene = weak(wall={"position": "-0.4 um"}, start={"position": [0, 0, 0]})
    rho, z = np.array([0.1e-6, 0.2e-6, 0.0]), np.array([-0.2e-6, 0.0, 0.3e-6])
    across, along, mobile, mobile_along = _field(bound_once(scene), (0.0, 0.0), 0)(rho, z)
    bead = tweezer.bead_properties(scene)
    light = tweezer.optical_force(scene, np.stack([rho, 0 * rho, z], axis=1))
    np.testing.assert_allclose(across, light[:, 0], rtol=1e-9, atol=1e-24)
    np.testing.assert_allclose(along, light[:, 2] + bead.weight[2], rtol=1e-9)
    expected = tweezer.wall_mobilities((z + 0.4e-6) / 0.15e-6 - 1)
    np.testing.assert_allclose(mobile * bead.drag, expected.parallel, rtol=1e-6)
    np.testing.assert_allclose(mobile_along * bead.drag, expected.perpendicular, rtol=1e-6)


def test_a_weak_trap_loses_its_bead_when_another_solver_says():
    scene = weak()
    trap = tweezer.characterise(scene)
    weight = np.array(tweezer.bead_properties(scene).weight)
    thermal = 1.380649e-23 * scene.medium.temperature
    drag = tweezer.bead_properties(scene).drag
    coarse, fine = (
        exit_times.on_a_square_grid(
            lambda places: tweezer.optical_force(scene, places) + weight,
            thermal / drag, thermal, 1.5e-6, step, trap.equilibrium.position[2],
        )
        for step in (60e-9, 30e-9)
    )  # fmt: skip
    assert trap.lifetime.lost_at == 1.5e-6
    assert trap.lifetime.time == pytest.approx(2 * fine - coarse, rel=0.05)
    assert 0 < trap.lifetime.error < 0.05 * trap.lifetime.time


def test_a_bead_that_is_lost_inside_a_deep_trap():
    """It is lost after a tenth of a micrometre, and pulled back for much longer."""
    scene = silica(
        beam={"power_through_pupil": "20 mW"}, start={"position": [0, 0, 0]},
        simulation={"loss_distance": "0.1 um"},
    )  # fmt: skip
    trap = tweezer.characterise(scene)
    assert min(escape.energy_kT for escape in trap.escapes) > 1000
    weight = np.array(tweezer.bead_properties(scene).weight)
    thermal = 1.380649e-23 * scene.medium.temperature
    expected = exit_times.on_a_square_grid(
        lambda places: tweezer.optical_force(scene, places) + weight,
        thermal / tweezer.bead_properties(scene).drag, thermal, 0.1e-6, 2e-9,
        trap.equilibrium.position[2],
    )  # fmt: skip
    assert trap.lifetime.time == pytest.approx(expected, rel=0.1)


def test_linear_light_says_by_how_much_it_is_not_round():
    round_one = tweezer.characterise(weak()).lifetime
    linear = [
        tweezer.characterise(weak(beam={"polarisation": "linear", "jones": jones})).lifetime
        for jones in (["1", "0"], ["0", "1"])
    ]
    assert linear[0].time == pytest.approx(linear[1].time, rel=1e-6)
    assert abs(linear[0].time - round_one.time) < linear[0].error + round_one.error
    assert linear[0].error > 2 * round_one.error


def test_a_bead_next_to_where_it_is_lost():
    """A place where a bead of lower index hovers, a hundredth of k_B T deep."""
    scene = silica(bead={"refractive_index": 1.2}, beam={"power_through_pupil": "9 mW"})
    trap = tweezer.characterise(scene)
    assert min(escape.energy_kT for escape in trap.escapes) < 0.02
    apart = trap.lifetime.lost_at + trap.equilibrium.position[2]
    diffusion = 1.380649e-23 * 293.15 / tweezer.bead_properties(scene).drag
    assert 0 < trap.lifetime.time < 100 * apart**2 / diffusion


def test_what_has_no_lifetime():
    assert tweezer.characterise(silica(bead={"refractive_index": 1.2})).lifetime is None
    two = silica(beam={"position": ["0.1 um", "0 um", "0 um"]})
    assert tweezer.characterise(two).lifetime is None
    deep = tweezer.characterise(silica()).lifetime
    assert (deep.time, deep.error) == (math.inf, 0.0)


def test_beside_a_wall_a_bead_is_held_longer():
    """The wall in its way, and the drag beside it."""
    free = tweezer.characterise(weak()).lifetime
    beside = tweezer.characterise(
        weak(wall={"position": "-0.4 um"}, start={"position": [0, 0, 0]})
    ).lifetime
    assert free.time < beside.time < 30 * free.time


def test_least_power_holds_for_that_time_and_no_longer():
    scene = weak()
    least = tweezer.least_power(scene, "1 h")
    assert least.lifetime.time == pytest.approx(3600, rel=5e-3)
    assert 0 < least.error < 0.01 * least.power
    for factor in (0.98, 1.02):
        power = factor * least.power
        held = tweezer.characterise(scene.replace(beam={"power_through_pupil": power})).lifetime
        assert (held.time > 3600) == (factor > 1)


def test_least_power_may_be_that_of_the_least_trap():
    """A bead that is not lost so soon even when it is free, but has no trap in so little light."""
    scene = weak()
    least = tweezer.least_power(scene, "10 ms")
    assert least.lifetime.time > 0.1
    assert least.error < 1e-3 * least.power
    assert (
        tweezer.characterise(
            scene.replace(beam={"power_through_pupil": 0.99 * least.power})
        ).equilibrium
        is None
    )


def test_time_without_light_is_that_of_free_diffusion():
    """(R^2 - z^2)/(6 D) from a place at a distance z from the middle of a ball."""
    none = {"gravity": False, "buoyancy": False}
    trap = tweezer.characterise(weak(beam={"power_through_pupil": 1e-5}, forces=none))
    scene, z = trap.scene, trap.equilibrium.position[2]
    diffusion = 1.380649e-23 * scene.medium.temperature / trap.drag[0]
    free = trap.lifetime_without_light
    expected = (free.lost_at**2 - z**2) / (6 * diffusion)
    assert free.time == pytest.approx(expected, rel=2e-3)
    assert abs(free.time - expected) < 4 * free.error
    assert trap.lifetime.time < 1.1 * free.time
    assert "the light adds nothing" in repr(trap)
    held = tweezer.characterise(weak())
    assert held.lifetime.time > 5 * held.lifetime_without_light.time
    assert "the light adds nothing" not in repr(held)
    assert tweezer.characterise(silica()).lifetime_without_light is None


def test_least_power_that_only_carries_the_weight():
    """Below it there is no equilibrium, and above it the light adds nothing."""
    least = tweezer.least_power(tweezer.load_scene("silica-1um"), "1 s")
    assert least.no_trap_below
    assert least.lifetime.time > 5
    assert least.without_light.time > 0.9 * least.lifetime.time
    assert "below it there is no equilibrium" in repr(least)
    assert "the light adds nothing" in repr(least)


def test_least_power_of_what_is_never_held():
    searched = r"no stable equilibrium on the axis within .* um of the focus .*, nor on a ring"
    with pytest.warns(
        tweezer.PhysicsWarning,
        match=f"the lifetime is shorter at every power from 1 mW to 100 W; at 100 W: {searched}",
    ):
        assert tweezer.least_power(silica(bead={"refractive_index": 1.2})) is None
    with pytest.raises(tweezer.SceneError, match="least power: requires one beam"):
        tweezer.least_power(silica(forces={"optical": False}))
    with pytest.raises(tweezer.SceneError, match=r"time = '5 um': "):
        tweezer.least_power(silica(), "5 um")
    with pytest.raises(tweezer.SceneError, match="time = 0"):
        tweezer.least_power(silica(), 0)
    with pytest.raises(tweezer.SceneError, match="a free bead stays within reach for longer"):
        tweezer.least_power(weak(forces={"gravity": False, "buoyancy": False}), "10 ms")


@pytest.mark.parametrize(
    ("time", "error", "words"),
    [
        (11520.0, 360.0, "3.2 +- 0.1 h"),
        (0.0123, 0.0004, "12.3 +- 0.4 ms"),
        (3.1e11, 3e9, "9823 +- 95 years"),
        (8.9e17, 1e16, "2.8e+10 years, within 1 %"),
        (math.inf, 0.0, f"longer than {LONGEST:.0e} s"),
        (2e-6, 1e-7, "2.0 +- 0.1 us"),
        (16.609, 0.0042, "16.61 s, within 0.03 %"),
        (51.0, 4.8e4, "about 5e+01 s, within a factor of 9e+02"),
    ],
)
def test_words(time, error, words):
    assert Lifetime(time, error, 1e-6).words == words


def test_a_trap_may_be_replaced_by_one_of_another_reach():
    trap = tweezer.characterise(silica())
    nearer = dataclasses.replace(trap, reach=1e-6)
    assert nearer != trap
    assert nearer.lifetime.lost_at == 1e-6


def test_what_is_left_out_of_a_lifetime_is_said():
    assert tweezer.characterise(silica()).lifetime_caveat is None
    assert tweezer.characterise(silica(bead={"refractive_index": 1.2})).lifetime_caveat is None
    two = tweezer.characterise(tweezer.load_scene("two-traps"))
    assert two.lifetime_caveat == "not computed for several beams"
    gold = tweezer.load_scene("gold-100nm")
    trap = tweezer.characterise(gold)
    warmer = trap.absorbed_power / (4 * math.pi * 0.6 * 50e-9)
    assert warmer == pytest.approx(19, abs=1)
    assert trap.lifetime_caveat == (
        f"at the temperature of the medium, but in water the light heats the bead by {warmer:.2g} K"
    )
    # its equilibrium is 0.3 um from the focus
    near = tweezer.characterise(
        gold.replace(simulation={"loss_distance": "0.2 um"}, start={"position": [0, 0, 0]})
    )
    assert near.lifetime is None
    assert near.lifetime_caveat == "not computed for an equilibrium beyond simulation.loss_distance"
