"""Force, torque and absorbed power of light on bodies, from a scene to the numbers."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import tweezer
from tests.optics.bodies.maxwell import force_and_torque
from tweezer.optics.bodies.by_sums import LightOnBody
from tweezer.optics.bodies.t_matrix import sphere_t_matrix
from tweezer.optics.waves.light import waves_on_bead
from tweezer.optics.waves.sphere import mie_coefficients
from tweezer.values.constants import speed_of_light

UM = 1e-6
ELLIPTIC = {"polarisation": "linear", "jones": [[0.6, 0], [0.3, 0.74]]}
NO_INDEX = {"radius": None, "material": None, "refractive_index": None}


def spheroid(diameter, length, index=1.57):
    return {
        "shape": "spheroid", "diameter": diameter * UM, "length": length * UM,
        "refractive_index": index,
    }  # fmt: skip


def cluster(*spheres):
    """A cluster of spheres with centre, diameter (both um) and index."""
    listed = [
        {"position": [UM * x for x in centre], "diameter": UM * diameter, "refractive_index": index}
        for centre, diameter, index in spheres
    ]
    return {**NO_INDEX, "shape": "spheres", "spheres": listed}


BODIES = {
    "prolate": spheroid(0.4, 0.8),
    "oblate": spheroid(0.9, 0.45, 1.45),
    "absorbing": spheroid(0.5, 0.3, [1.57, 0.05]),
    "gold rod": spheroid(0.1, 0.3, [0.26, 6.97]),
    "touching pair": cluster(((0, 0, -0.1), 0.2, 1.57), ((0, 0, 0.1), 0.2, 1.57)),
    "triangle": cluster(
        ((0.15, 0, 0), 0.2, 1.57), ((-0.15, 0.05, 0), 0.16, 1.45), ((0, 0.22, 0), 0.12, [1.5, 0.1])
    ),
    "five": cluster(
        ((0, 0, 0), 0.14, 1.57), ((0.2, 0, 0), 0.1, 1.45), ((0, 0.2, 0.1), 0.1, 1.57),
        ((-0.13, -0.1, 0.2), 0.1, [1.57, 0.02]), ((0, -0.2, -0.15), 0.12, 1.45),
    ),
}  # fmt: skip


def scene_of(name, **light):
    return scene_with(BODIES[name], beam={**ELLIPTIC, **light})


def scene_with(bead, *, beam=None, **sections):
    changes = {
        "optics": {"theory": "waves", "tolerance": 1e-8}, "lens": {"numerical_aperture": 1.2},
        "bead": {"density": 1050, **bead}, "beam": ELLIPTIC if beam is None else beam, **sections,
    }  # fmt: skip
    return tweezer.load_scene("silica-1um").replace(**changes)


def poses(count, seed=5, reach=0.35):
    """Positions, m, and Euler parameters off the axis and tilted."""
    rng = np.random.default_rng(seed)
    turned = rng.normal(size=(count, 4))
    return (
        rng.uniform(-reach, reach, (count, 3)) * UM,
        turned / np.linalg.norm(turned, axis=1, keepdims=True),
    )


def matrix(orientation):
    return Rotation.from_quat(orientation, scalar_first=True).as_matrix()


def everything(scene, positions, orientations):
    """Force, torque and absorbed power from the functions of the package."""
    return (
        tweezer.optical_force(scene, positions, orientations),
        tweezer.optical_torque(scene, positions, orientations),
        tweezer.absorbed_power(scene, positions, orientations),
    )


@pytest.mark.parametrize("name", BODIES)
def test_force_torque_and_absorbed_power_agree_with_the_stress_tensor(name):
    scene = scene_of(name)
    body = tweezer.t_matrix(scene)
    positions, orientations = poses(2)
    force, torque, absorbed = everything(scene, positions, orientations)
    error = tweezer.optical_force_error(scene, positions, orientations)
    for i in range(len(positions)):
        F, M, P = force_and_torque(scene, body, positions[i], matrix(orientations[i]))
        assert force[i] == pytest.approx(F, abs=1e-8 * np.abs(F).max())
        assert torque[i] == pytest.approx(M, abs=1e-8 * np.abs(M).max())
        assert absorbed[i] == pytest.approx(P, abs=1e-9 * scene.beam.power_through_pupil)
        assert np.linalg.norm(force[i] - F) < error[i] < 1e-6 * np.linalg.norm(F)
        assert (absorbed[i] > 1e-7 * scene.beam.power_through_pupil) != body.lossless


@pytest.mark.parametrize("tolerance", [1e-3, 1e-5])
@pytest.mark.parametrize("name", ["prolate", "gold rod", "touching pair"])
def test_error_is_stated_for_looser_tolerances(name, tolerance):
    exact = scene_of(name)
    scene = exact.replace(optics={"tolerance": tolerance})
    positions, orientations = poses(40, reach=0.8)
    force = tweezer.optical_force(scene, positions, orientations)
    off = np.linalg.norm(force - tweezer.optical_force(exact, positions, orientations), axis=1)
    error = tweezer.optical_force_error(scene, positions, orientations)
    assert (off < error).all()
    size = np.linalg.norm(force, axis=1)
    assert (error < 2 * tolerance * (size + size.max())).all()
    assert off.max() > 0  # fewer degrees are used


# --- a sphere ---------------------------------------------------------------------------------

LIGHTS = {
    "elliptic": ELLIPTIC,
    "unpolarised": {"polarisation": "unpolarised"},
    "circular": {"polarisation": "circular"},
    "other hand": {"polarisation": "linear", "jones": [1, [0, -1]]},
    "radial": {"polarisation": "radial", "profile": "donut"},
    "vortex": {"polarisation": "unpolarised", "vortex": 2},
    "circular vortex": {"polarisation": "circular", "vortex": -1},
}


@pytest.mark.parametrize("index", [1.57, [1.57, 0.05]], ids=["lossless", "absorbing"])
@pytest.mark.parametrize("beam", LIGHTS.values(), ids=LIGHTS.keys())
def test_sphere_by_its_t_matrix_is_the_sphere(beam, index):
    scene = tweezer.load_scene("silica-1um").replace(
        optics={"theory": "waves", "tolerance": 1e-12}, beam=beam,
        bead={"radius": 0.3e-6, "refractive_index": index},
    )  # fmt: skip
    light = waves_on_bead(scene)
    a, b = mie_coefficients(light.shells, light.wavenumber, 16)
    body = sphere_t_matrix(
        a, b, light.wavenumber, scene.medium.refractive_index, 0.3e-6,
        lossless=not scene.bead.absorbs,
    )  # fmt: skip
    positions, orientations = poses(4)
    of_body = LightOnBody(light, body, 1e-12, 1e-6, (1.0, 0.0, 0.0, 0.0))
    found = of_body.field(positions, orientations=orientations)
    force, torque, absorbed = everything(scene, positions, None)
    assert np.abs(found.force - force).max() < 1e-13 * np.abs(force).max()
    largest = max(np.abs(torque).max(), 1e-1 * np.abs(force).max() / light.wavenumber)
    assert np.abs(found.moment - torque).max() < 1e-13 * largest
    # without absorption the torque on a sphere is exactly 0
    found_power = of_body.absorbed_power(positions, orientations)
    assert np.abs(found_power - absorbed).max() < 1e-14 * scene.beam.power_through_pupil
    assert (absorbed > 0).all() == (torque.any()) == scene.bead.absorbs


# --- derivative over position and rotation ----------------------------------------------------


def turned_further(orientations, angles):
    """Euler parameters turned by rotation vectors about the laboratory's axes."""
    found = Rotation.from_rotvec(angles) * Rotation.from_quat(orientations, scalar_first=True)
    return found.as_quat(scalar_first=True)


@pytest.mark.parametrize("name", ["prolate", "absorbing", "five"])
@pytest.mark.parametrize("polarisation", ["linear", "unpolarised"])
def test_jacobian_agrees_with_central_differences(name, polarisation):
    beam = ELLIPTIC if polarisation == "linear" else {"polarisation": polarisation}
    scene = scene_with(BODIES[name], beam=beam, optics={"theory": "waves", "tolerance": 1e-10})
    positions, orientations = poses(2, seed=8)
    step, turn = 1e-9, 1e-3

    def wrench(shift, angle):
        at, turned = positions + shift, turned_further(orientations, np.tile(angle, (2, 1)))
        return np.concatenate(
            [tweezer.optical_force(scene, at, turned), tweezer.optical_torque(scene, at, turned)], 1
        )

    columns = []
    for axis in np.eye(3):
        for shift, angle, by in ((step * axis, 0 * axis, step), (0 * axis, turn * axis, turn)):
            # the error is of the fourth order
            near, far = (
                (wrench(n * shift, n * angle) - wrench(-n * shift, -n * angle)) / (2 * n * by)
                for n in (1, 2)
            )
            columns.append((4 * near - far) / 3)
    expected = np.stack(columns, axis=-1)[..., [0, 2, 4, 1, 3, 5]]
    found = tweezer.optical_jacobian(scene, positions, orientations)
    assert found.shape == (2, 6, 6)
    for i in (slice(0, 3), slice(3, 6)):
        for j in (slice(0, 3), slice(3, 6)):
            block = expected[:, i, j]
            assert np.abs(found[:, i, j] - block).max() < 1e-7 * np.abs(block).max()
    field = tweezer.light(scene).field(positions, orientations=orientations)
    assert field.gradient.values == pytest.approx(found[:, :3, :3], rel=1e-12)


def cross(vector):
    x, y, z = vector
    return np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])


@pytest.mark.parametrize("name", ["prolate", "five"])
@pytest.mark.parametrize("polarisation", ["circular", "unpolarised"])
def test_jacobian_of_a_turn_about_the_axis_of_symmetric_light(name, polarisation):
    """Body and position turned about z: force and torque turn with them."""
    scene = scene_of(name, polarisation=polarisation, jones=None)
    positions, orientations = poses(2, seed=9)
    K = tweezer.optical_jacobian(scene, positions, orientations)
    force, torque, _ = everything(scene, positions, orientations)
    z = np.array([0, 0, 1.0])
    for i in range(len(positions)):
        change = K[i] @ np.concatenate([np.cross(z, positions[i]), z])
        expected = np.concatenate([np.cross(z, force[i]), np.cross(z, torque[i])])
        assert np.abs(change - expected)[:3].max() < 1e-12 * np.abs(force[i]).max()
        assert np.abs(change - expected)[3:].max() < 1e-11 * np.abs(torque[i]).max()


def test_body_of_revolution_feels_no_turn_about_its_own_axis():
    scene = scene_of("absorbing")
    positions, orientations = poses(3, seed=10)
    K = tweezer.optical_jacobian(scene, positions, orientations)
    for i in range(3):
        axis = matrix(orientations[i])[:, 2]
        column = K[i, :, 3:] @ axis
        assert np.abs(column[:3]).max() < 1e-12 * np.abs(K[i, :3, 3:]).max()
        assert np.abs(column[3:]).max() < 1e-12 * np.abs(K[i, 3:, 3:]).max()


def test_jacobian_is_not_symmetric():
    scene = scene_of("prolate", jones=[1, 0])
    K = tweezer.optical_jacobian(scene, *(each[0] for each in poses(1)))
    assert np.abs(K[:3, :3] - K[:3, :3].T).max() > 1e-3 * np.abs(K[:3, :3]).max()


# --- symmetries -------------------------------------------------------------------------------


def about_z(angle):
    return Rotation.from_rotvec([0, 0, angle])


@pytest.mark.parametrize("name", ["prolate", "triangle"])
def test_body_and_light_turned_together_feel_the_turned_force(name):
    angle = 0.8
    c, s = math.cos(angle), math.sin(angle)
    a, b = complex(*ELLIPTIC["jones"][0]), complex(*ELLIPTIC["jones"][1])
    jones = [[x.real, x.imag] for x in (c * a - s * b, s * a + c * b)]
    turn = about_z(angle)
    positions, orientations = poses(3)
    turned = (turn * Rotation.from_quat(orientations, scalar_first=True)).as_quat(scalar_first=True)
    force, torque, absorbed = everything(scene_of(name), positions, orientations)
    found = everything(scene_with(BODIES[name], beam={**ELLIPTIC, "jones": jones}),
                       turn.apply(positions), turned)  # fmt: skip
    assert np.abs(found[0] - turn.apply(force)).max() < 1e-13 * np.abs(force).max()
    assert np.abs(found[1] - turn.apply(torque)).max() < 1e-12 * np.abs(torque).max()
    assert np.abs(found[2] - absorbed).max() < 1e-14 * 0.05


@pytest.mark.parametrize("name", ["absorbing", "triangle"])
def test_mirror_image_of_body_and_light_feels_the_mirror_image_of_the_force(name):
    """The mirror image in y = 0 reverses the hand of the light, and the torque as an axial vector.

    The bodies are their own mirror images in z = 0, so that mirrored orientations exist.
    """
    mirror, own = np.diag([1.0, -1, 1]), np.diag([1.0, 1, -1])
    (a, b), positions = ELLIPTIC["jones"], poses(3)[0]
    orientations = poses(3)[1]
    frames = np.array([mirror @ matrix(each) @ own for each in orientations])
    mirrored = Rotation.from_matrix(frames).as_quat(scalar_first=True)
    scene = scene_with(BODIES[name], beam={**ELLIPTIC, "jones": [a, [-b[0], -b[1]]]})
    force, torque, absorbed = everything(scene_of(name), positions, orientations)
    found = everything(scene, positions @ mirror, mirrored)
    off = 1e-13 + 100 * tweezer.t_matrix(scene).error  # the T-matrix of a cluster is not symmetric
    assert np.abs(found[0] - force @ mirror).max() < off * np.abs(force).max()
    assert np.abs(found[1] + torque @ mirror).max() < 10 * off * np.abs(torque).max()
    assert found[2] == pytest.approx(absorbed, rel=1e-11)


def test_euler_parameters_of_both_signs_and_any_length_are_the_same_orientation():
    scene = scene_of("triangle")
    positions, orientations = poses(3)
    force = tweezer.optical_force(scene, positions, orientations)
    assert tweezer.optical_force(scene, positions, -3 * orientations) == pytest.approx(force)


def test_orientation_of_the_start_is_the_default():
    orientation = poses(1)[1][0]
    scene = scene_with(BODIES["triangle"], start={"orientation": orientation.tolist()})
    position = poses(1)[0][0]
    expected = everything(scene_of("triangle"), position, orientation)
    for one, other in zip(everything(scene, position, None), expected, strict=True):
        assert one == pytest.approx(other, rel=1e-13)
    upright = tweezer.optical_force(scene_of("triangle"), position)
    assert np.abs(upright - expected[0]).max() > 1e-2 * np.abs(upright).max()


def test_axis_of_the_start_is_the_axis_of_the_body():
    axis = np.array([0.48, 0.6, 0.64])
    scene = scene_with(BODIES["prolate"], start={"orientation": axis.tolist()})
    assert matrix(scene.start.orientation)[:, 2] == pytest.approx(axis, abs=1e-15)


# --- several beams, and power -----------------------------------------------------------------

HALF_TURN = np.diag([1.0, -1, -1])


def test_light_from_above_is_the_light_from_below_turned_about_x():
    positions, orientations = poses(3)
    down = scene_of("triangle", direction="down")
    turned = np.array([
        Rotation.from_matrix(HALF_TURN @ matrix(each)).as_quat(scalar_first=True)
        for each in orientations
    ])  # fmt: skip
    force, torque, absorbed = everything(scene_of("triangle"), positions @ HALF_TURN, turned)
    found = everything(down, positions, orientations)
    assert found[0] == pytest.approx(force @ HALF_TURN, abs=1e-12 * np.abs(force).max())
    assert found[1] == pytest.approx(torque @ HALF_TURN, abs=1e-12 * np.abs(torque).max())
    assert found[2] == pytest.approx(absorbed, rel=1e-12)
    K = tweezer.optical_jacobian(scene_of("triangle"), positions @ HALF_TURN, turned)
    six = np.kron(np.eye(2), HALF_TURN)
    expected = six @ K @ six
    found_K = tweezer.optical_jacobian(down, positions, orientations)
    for row in (slice(0, 3), slice(3, 6)):
        size = np.abs(expected[:, row]).max(axis=(0, 1))
        assert (np.abs(found_K - expected)[:, row].max(axis=(0, 1)) < 1e-12 * size).all()


def test_force_of_two_beams_is_the_sum():
    apart = np.array([0.5, -0.2, 0.4]) * UM
    first = scene_of("absorbing")
    second = {"position": apart.tolist(), "power_through_pupil": 0.02, "direction": "down"}
    both = first.replace(beam=[first.beam.model_dump(exclude_none=True),
                               {**first.beam.model_dump(exclude_none=True), **second}])  # fmt: skip
    other = scene_of("absorbing", direction="down", power_through_pupil=0.02)
    positions, orientations = poses(3)
    one = everything(first, positions, orientations)
    two = everything(other, positions - apart, orientations)
    found = everything(both, positions, orientations)
    for total, a, b in zip(found, one, two, strict=True):
        assert total == pytest.approx(a + b, abs=1e-11 * np.abs(total).max())
    K = tweezer.optical_jacobian(both, positions, orientations)
    K_sum = tweezer.optical_jacobian(first, positions, orientations) + tweezer.optical_jacobian(
        other, positions - apart, orientations
    )
    for row in (slice(0, 3), slice(3, 6)):
        for column in (slice(0, 3), slice(3, 6)):
            size = np.abs(K_sum[:, row, column]).max()
            assert np.abs(K - K_sum)[:, row, column].max() < 1e-11 * size


def test_everything_is_proportional_to_the_power():
    scene = scene_of("absorbing")
    stronger = scene.of_power(0.4)
    assert stronger.beam.power_through_pupil == pytest.approx(0.4)
    ratio = 0.4 / scene.beam.power_through_pupil
    positions, orientations = poses(3)
    for one, other in zip(
        (*everything(stronger, positions, orientations),
         tweezer.optical_force_error(stronger, positions, orientations),
         tweezer.optical_jacobian(stronger, positions, orientations)),
        (*everything(scene, positions, orientations),
         tweezer.optical_force_error(scene, positions, orientations),
         tweezer.optical_jacobian(scene, positions, orientations)),
        strict=True,
    ):  # fmt: skip
        assert one == pytest.approx(ratio * other, rel=1e-13)


@pytest.mark.parametrize("hand", [1, -1])
@pytest.mark.parametrize("name", ["absorbing", "gold rod"])
def test_torque_about_the_light_is_the_absorbed_power_over_omega(name, hand):
    """Each photon that a body of revolution on the axis absorbs leaves it hbar."""
    scene = scene_of(name, jones=[1, [0, hand]])
    positions = np.array([[0, 0, 0.2e-6], [0, 0, -0.7e-6]])
    _, torque, absorbed = everything(scene, positions, None)
    omega = 2 * math.pi * speed_of_light / scene.beam.wavelength
    assert torque[:, 2] == pytest.approx(hand * absorbed / omega, rel=1e-11)
    assert np.abs(torque[:, :2]).max() < 1e-12 * np.abs(torque).max()
    assert (absorbed > 0).all()


def test_lossless_body_of_revolution_feels_no_torque_about_its_axis():
    scene = scene_of("prolate")
    positions, orientations = poses(3)
    _, torque, absorbed = everything(scene, positions, orientations)
    axes = np.array([matrix(each)[:, 2] for each in orientations])
    assert np.abs((torque * axes).sum(1)).max() < 1e-13 * np.abs(torque).max()
    assert np.abs(absorbed).max() < 1e-15 * 0.05


def test_reach_grows_with_the_positions():
    """Positions beyond the distance of loss are computed with more degrees and nodes."""
    scene = scene_with(BODIES["prolate"], simulation={"loss_distance": 1e-6})
    far = np.array([2e-6, 0, 1e-6])
    force = tweezer.optical_force(scene, far)
    expected, _, _ = force_and_torque(scene, tweezer.t_matrix(scene), far, np.eye(3))
    assert np.linalg.norm(force - expected) < tweezer.optical_force_error(scene, far)
    assert force == pytest.approx(expected, abs=1e-8 * np.abs(expected).max())


def test_body_too_far_for_waves_is_refused():
    with pytest.raises(tweezer.SceneError, match=r"^positions = 0.01: waves are computed up to "):
        tweezer.optical_force(scene_of("prolate"), [0.01, 0, 0])


def test_body_in_a_beam_without_power_feels_nothing():
    dark = scene_with(BODIES["prolate"], beam={"power_through_pupil": 0})
    field = tweezer.light(dark).field([[0, 0, 1e-7]])
    assert not field.force.any()
    assert not field.absorbed_power.any()
    assert not tweezer.optical_jacobian(dark, [0, 0, 1e-7]).any()
