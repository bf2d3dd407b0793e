"""Outcomes and drawn releases of bodies, whose equilibria are poses."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import tweezer
from tweezer import SceneError
from tweezer.dynamics.poses import PoseSearch, Rest
from tweezer.forces import UserForce, kernel, number

BASE = tweezer.load_scene("polystyrene-500nm")
ROD = BASE.replace(
    bead={"shape": "spheroid", "diameter": "0.4 um", "length": "0.8 um"},
    start={"position": ["0.1 um", "0 um", "0 um"], "orientation": [0.8, 0.5, 0.2, 0.1]},
    simulation={"duration": "4 ms", "samples": 401},
)
DISC = BASE.replace(
    bead={"shape": "spheroid", "diameter": "0.8 um", "length": "0.4 um"},
    beam={"polarisation": "circular"},
)


@kernel
def push(pose, data, wrench):
    """Add a constant force along x."""
    for i in range(len(pose.position)):
        wrench.force[i, 0] += number(data, 0)


def axes_of(run):
    return Rotation.from_quat(
        run.orientation.values.reshape(-1, 4), scalar_first=True
    ).as_matrix()[:, :, 2]  # fmt: skip


def test_capture_time_of_a_rod_is_when_its_pose_stays_close():
    run = tweezer.simulate(ROD)
    summary = tweezer.summarise(run)
    held = tweezer.characterise(ROD).equilibrium
    size = 0.4e-6
    tilt = np.arccos(np.abs(axes_of(run)[:, 2]))
    far = np.hypot(np.linalg.norm(run.position - held.position, axis=1), size * tilt) > 0.1 * size
    last = int(np.flatnonzero(far)[-1])
    assert summary.outcome == "captured"
    assert run.time[last] < summary.outcome_time <= run.time[last + 1]
    assert 0 < summary.outcome_time_error < 1e-6
    by_samples = tweezer.summarise(run.isel(time=slice(1, None)))
    assert by_samples.outcome_time == run.time[last + 1]


def test_rod_that_is_still_turning_is_not_captured():
    """The rod is already at the focus, but its axis is not along the light."""
    short = ROD.replace(
        start={"position": [0, 0, "0.175 um"], "orientation": [0.9, 0.3, 0, 0]},
        simulation={"duration": "50 us"},
    )
    summary = tweezer.summarise(tweezer.simulate(short))
    assert summary.outcome == "not captured"


def test_disc_that_spins_at_its_place_is_captured():
    scene = DISC.replace(
        start={"orientation": [0.8, 0.5, 0.2, 0.1]},
        simulation={"duration": "20 ms", "samples": 21},
    )
    run = tweezer.simulate(scene)
    assert tweezer.summarise(run).outcome == "captured"
    assert np.abs(axes_of(run)[-1] @ axes_of(run)[-2]) < 0.999  # it has not stopped


def test_body_without_light_is_not_captured():
    dark = ROD.replace(beam={"power_through_pupil": 0}, simulation={"duration": "10 us"})
    assert tweezer.summarise(tweezer.simulate(dark)).outcome == "not captured"


def test_thermal_rod_is_captured_in_its_trap_and_not_in_weak_light():
    thermal = ROD.replace(forces={"brownian": True}, simulation={"duration": "5 ms"})
    assert tweezer.summarise(tweezer.simulate(thermal, seed=2)).outcome == "captured"
    flipping = tweezer.simulate(tweezer.load_scene("flipping-rod"), seed=1)
    assert tweezer.summarise(flipping).outcome == "captured"
    weak = thermal.replace(beam={"power_through_pupil": "0.05 mW"})
    assert tweezer.summarise(tweezer.simulate(weak, seed=2)).outcome == "not captured"


@pytest.mark.parametrize("model", ["overdamped", "full"])
def test_drawn_rods_have_the_boltzmann_distribution(model):
    """Variances of place and tilt are kT over the stiffness, and kT/m and kT/I of the velocities.

    A variance of 4000 draws has a standard error of 2.2 %; ten are compared within four.
    """
    n = 4000
    scene = ROD.replace(
        forces={"brownian": True}, start={"drawn": "boltzmann"},
        simulation={"model": model, "duration": "1 us", "samples": 2},
    )  # fmt: skip
    found = tweezer.ensemble(scene, n, seed=5).isel(time=0)
    held = tweezer.characterise(scene).equilibrium
    kT = 1.380649e-23 * scene.medium.temperature
    axis = axes_of(found)
    tilted = np.column_stack([-axis[:, 1], axis[:, 0]]) * np.sign(axis[:, 2:])
    moved = np.column_stack([found.position - held.position, tilted])
    stiffness = np.array(held.stiffness)[:5, :5]
    mobility = np.diag(np.diag(tweezer.resistance(scene).mobility))[:5, :5]
    from scipy.linalg import solve_continuous_lyapunov

    expected = solve_continuous_lyapunov(mobility @ stiffness, 2 * kT * mobility)
    error = np.sqrt(2 / n)
    np.testing.assert_allclose(np.var(moved, axis=0), np.diag(expected), rtol=4 * error)
    turn = Rotation.from_quat(found.orientation.values, scalar_first=True)
    spin = np.unwrap(2 * np.arctan2(turn.as_quat()[:, 2], turn.as_quat()[:, 3]))
    assert abs(np.exp(1j * spin).mean()) < 4 / math.sqrt(n)  # turns about its own axis are uniform
    if model == "full":
        mass, inertia = scene.body.mass, np.array(scene.body.inertia)
        np.testing.assert_allclose(np.var(found.velocity, axis=0), kT / mass, rtol=4 * error)
        spins = np.var(found.angular_velocity.values, axis=0)
        np.testing.assert_allclose(spins, kT / np.diag(inertia), rtol=4 * error)


def test_drawn_at_the_equilibrium_is_the_pose_of_the_trap():
    scene = ROD.replace(
        forces={"brownian": True}, start={"drawn": "equilibrium"},
        simulation={"duration": "1 us", "samples": 2},
    )  # fmt: skip
    run = tweezer.simulate(scene)
    held = tweezer.characterise(scene).equilibrium
    assert run.position.values[0] == pytest.approx(held.position, abs=1e-15)
    assert run.orientation.values[0] == pytest.approx(held.orientation, abs=1e-12)


def test_release_at_an_equilibrium_that_does_not_exist_is_refused():
    dark = ROD.replace(
        forces={"brownian": True}, start={"drawn": "equilibrium"}, beam={"power_through_pupil": 0}
    )
    with pytest.raises(SceneError, match=r"start\.drawn = 'equilibrium': requires a stable"):
        tweezer.simulate(dark)


@pytest.mark.parametrize("drawn", ["equilibrium", "boltzmann"])
def test_release_about_the_pose_without_own_forces_is_refused(drawn):
    """The force would move the equilibrium, which is searched for light and weight alone."""
    pushed = ROD.replace(forces={"brownian": True}, start={"drawn": drawn})
    with pytest.raises(SceneError, match=rf"start\.drawn = '{drawn}': .* without forces of your"):
        tweezer.simulate(pushed, forces=[UserForce(push, ("0.5 pN",))])


@pytest.mark.parametrize("seed", range(3))
def test_distances_do_not_count_turns_that_change_nothing(seed):
    rng = np.random.default_rng(seed)
    turns = Rotation.random(4, random_state=rng)
    here, spin, about, other = turns
    axis, z = np.array([0.6, 0, 0.8]), np.array([0, 0, 1.0])
    spin = Rotation.from_rotvec(rng.normal() * axis)
    about = Rotation.from_rotvec(rng.normal() * z)
    place = rng.normal(size=3)

    def distance(rest, positions, turned):
        e = turned.as_quat(scalar_first=True)
        return rest.distances(np.atleast_2d(positions), np.atleast_2d(e))[0]

    def rest(axes, around):
        e = here.as_quat(scalar_first=True)
        return Rest(place, e, 2.0, np.reshape(axes, (-1, 3)), around, alike=True)

    assert distance(rest(axis, False), place, here * spin) == pytest.approx(0, abs=1e-7)
    assert distance(rest([], True), about.apply(place), about * here) == pytest.approx(0, abs=1e-7)
    aside = here.apply(np.cross(axis, [0, 1, 0]))
    tilted = Rotation.from_rotvec(0.3 * aside) * here * spin
    assert distance(rest(axis, False), place + np.array([3, 0, 0]), tilted) == pytest.approx(
        math.hypot(3, 0.6), rel=1e-9
    )
    assert distance(rest([], False), place, other) == pytest.approx(
        2 * (other * here.inv()).magnitude(), rel=1e-9
    )
    angles = np.linspace(0, 2 * np.pi, 20001)
    turned = Rotation.from_rotvec(angles[:, None] * z) * other * here.inv()
    least = 2 * np.hypot(0, turned.magnitude()).min()
    assert distance(rest([], True), place, other) == pytest.approx(least, abs=1e-5)


def test_ends_that_differ_are_distinguished():
    here = [1.0, 0, 0, 0]
    over = np.array([[0, 1.0, 0, 0]])
    axes = np.array([[0, 0, 1.0]])
    for around in (False, True):
        for alike, angle in ((True, 0.0), (False, math.pi)):
            rest = Rest(np.zeros(3), here, 2.0, axes, around, alike)
            distance = rest.distances(np.zeros((1, 3)), over)
            assert distance == pytest.approx(2 * angle, abs=1e-7)


def test_mean_position_on_an_orbit_is_its_radius_and_height():
    here = np.array([1.0, 0, 0, 0])
    angle = np.linspace(0, 2 * np.pi, 100)
    orbit = np.column_stack([2 * np.cos(angle), 2 * np.sin(angle), np.full(100, 0.5)])
    rest = Rest(np.array([0, -2.0, 0.5]), here, 1.0, np.array([[0, 0, 1.0]]), True, True)
    assert rest.apart(orbit).mean(axis=0) == pytest.approx([0, 0], abs=1e-12)
    on_the_axis = Rest(np.array([0, 0, 0.5]), here, 1.0, np.array([[0, 0, 1.0]]), True, True)
    assert on_the_axis.apart(orbit).mean(axis=0) == pytest.approx([0.02, 0, 0], abs=1e-12)


def test_rod_that_orbits_steadily_is_captured():
    """Light with a vortex drives it around its axis. Without thermal motion its pose in the frame
    that turns with it does not change.
    """
    rod = {"shape": "spheroid", "diameter": "0.2 um", "length": "0.35 um"}
    scene = BASE.replace(
        bead=rod, beam={"polarisation": "circular", "vortex": 1},
        start={"position": ["0.3 um", 0, "0.1 um"]},
        simulation={"model": "overdamped", "duration": "40 ms", "samples": 401},
    )  # fmt: skip
    run = tweezer.simulate(scene)
    assert tweezer.summarise(run).outcome == "captured"
    search = PoseSearch(scene)
    place = search.relaxed(run.position.values[-1], run.orientation.values[-1])
    rates = tweezer.rotation(run, skip="35 ms").rate
    assert place.stable
    assert place.rotation[2] == pytest.approx(float(rates[2]), rel=1e-5)
    ways = search.escapes(place)
    assert [each.direction for each in ways] == ["outwards", "inwards", "+z", "-z"]
    assert all(each.force > 1e-14 for each in ways)


def test_drawn_angular_velocities_are_thermal_about_the_axes_of_a_rod_that_lies():
    """The frame of the rod is turned by a right angle. A variance of 4000 draws has a standard
    error of 2.2 %; three are compared within four.
    """
    n = 4000
    scene = tweezer.load_scene("flipping-rod").replace(
        start={"drawn": "boltzmann"}, medium={"inertia": "none"},
        simulation={"model": "full", "duration": "1 us", "samples": 2},
    )  # fmt: skip
    found = tweezer.ensemble(scene, n, seed=6).isel(time=0)
    assert np.mean(axes_of(found)[:, 0] ** 2) > 0.5
    spins = np.var(found.angular_velocity.values, axis=0)
    expected = 1.380649e-23 * scene.medium.temperature / np.diag(scene.body.inertia)
    np.testing.assert_allclose(spins, expected, rtol=4 * np.sqrt(2 / n))
