"""Bodies that rotate steadily in light of circular polarisation, against their motion."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import solve_continuous_lyapunov
from scipy.spatial.transform import Rotation

import tweezer
from tweezer.dynamics.poses import DRAWN, PoseSearch

#: A disc stands on its edge and turns about the axis of the light
DISC = tweezer.load_scene("polystyrene-500nm").replace(
    bead={"shape": "spheroid", "diameter": "0.8 um", "length": "0.4 um"},
    beam={"polarisation": "circular"},
)


@pytest.fixture(scope="module")
def held():
    return tweezer.characterise(DISC).equilibrium


def test_disc_turns_as_its_run_does(held):
    """The run starts at the equilibrium, and its overdamped motion turns at the rate found."""
    start = {"position": list(held.position), "orientation": list(held.orientation)}
    scene = DISC.replace(
        start=start, simulation={"model": "overdamped", "duration": "10 ms", "samples": 21}
    )
    run = tweezer.simulate(scene)
    turns = Rotation.from_quat(run.orientation, scalar_first=True)
    rates = (turns[1:] * turns[:-1].inv()).as_rotvec() / np.diff(run.time)[:, None]
    assert held.stable
    assert held.rotation[2] > 100
    np.testing.assert_allclose(rates, np.tile(held.rotation, (20, 1)), atol=1e-4)
    np.testing.assert_allclose(run.position, np.tile(held.position, (21, 1)), atol=1e-13)


def test_rounding_of_the_rotation_is_not_printed(held):
    card = str(tweezer.characterise(DISC))
    assert f"steady rotation (x, y, z)   0, 0, {held.rotation[2]:.4g} rad/s" in card


def test_rate_is_torque_over_drag(held):
    torque = tweezer.optical_torque(DISC, held.position, held.orientation)
    across = tweezer.resistance(DISC).matrix[3, 3]  # about a diameter of the disc
    assert held.rotation == pytest.approx([0, 0, torque[2] / across], abs=1e-6)


def test_disc_turns_the_other_way_in_light_of_the_other_handedness(held):
    other = {"polarisation": "linear", "jones": [1.0, "-1j"]}
    trap = tweezer.characterise(DISC.replace(beam=other))
    assert trap.equilibrium.rotation[2] == pytest.approx(-held.rotation[2], rel=1e-6)


def test_displacements_decay_in_the_turning_frame(held):
    """Six displaced motions give a propagator, whose logarithm has the relaxation rates."""
    mobility = tweezer.resistance(DISC).mobility
    start = Rotation.from_quat(held.orientation, scalar_first=True)
    time, size = 5e-5, np.repeat([1e-11, 1e-4], 3)

    def velocity(_, moved):
        turned = Rotation.from_rotvec(moved[3:]) * start
        quaternion = turned.as_quat(scalar_first=True)
        wrench = np.concatenate([
            tweezer.optical_force(DISC, moved[:3], quaternion),
            tweezer.optical_torque(DISC, moved[:3], quaternion),
        ])  # fmt: skip
        frame = np.kron(np.eye(2), turned.as_matrix())
        twist = frame @ mobility @ frame.T @ (wrench + lift)
        angle = moved[3:]
        length = np.linalg.norm(angle)
        factor = 1 / 12 if length < 1e-3 else 1 / length**2 - 1 / (2 * length * np.tan(length / 2))
        once = np.cross(angle, twist[3:])
        return np.concatenate([twist[:3], twist[3:] - once / 2 + factor * np.cross(angle, once)])

    lift = np.concatenate([tweezer.bind(DISC).problem.bead.weight, np.zeros(3)])

    def end_of(displaced):
        begin = np.concatenate([np.array(held.position) + displaced[:3], displaced[3:]])
        return solve_ivp(velocity, (0, time), begin, method="DOP853", rtol=1e-10, atol=1e-18).y[
            :, -1
        ]

    reference = end_of(np.zeros(6))
    turned = Rotation.from_rotvec(reference[3:])
    columns = []
    for k in range(6):
        both = []
        for sign in (1, -1):
            end = end_of(sign * size[k] * np.eye(6)[k])
            apart = Rotation.from_rotvec(end[3:]) * turned.inv()
            both.append(np.concatenate([
                turned.apply(end[:3] - reference[:3], inverse=True),
                turned.apply(apart.as_rotvec(), inverse=True),
            ]))  # fmt: skip
        columns.append((both[0] - both[1]) / (2 * size[k]))
    values = np.linalg.eigvals(np.array(columns).T)
    found = np.sort_complex(-np.log(values.astype(complex)) / time)
    rates = np.array(held.relaxation_rates) @ [1, 1j]
    largest = np.abs(rates).max()
    np.testing.assert_allclose(found, np.sort_complex(rates), atol=2e-5 * largest)


def test_body_hangs_by_a_centre_of_volume_off_its_axis(tmp_path):
    """Buoyancy turns it about its axis until its centre of volume is above the axis."""
    rod = DISC.replace(
        bead={"shape": "spheroid", "diameter": "0.4 um", "length": "0.8 um"},
        beam={"polarisation": "linear"},
    )
    file = tmp_path / "rod.tmat.h5"
    tweezer.t_matrix(rod).save(file)
    given = {
        "mass": rod.body.mass, "volume": rod.body.volume, "centre_of_volume": [1e-7, 0, 0],
        "inertia": np.array(rod.body.inertia).tolist(),
        "resistance": np.array(tweezer.resistance(rod).matrix).tolist(),
    }  # fmt: skip
    body = {"shape": "given", "diameter": "0.8 um", "given": given, "t_matrix": str(file)}
    trap = tweezer.characterise(rod.replace(bead=body))
    lying = 0
    for each in trap.equilibria:
        assert each.rotation == pytest.approx([0, 0, 0], abs=1e-9)
        turned = Rotation.from_quat(each.orientation, scalar_first=True)
        if abs(turned.apply([0, 0, 1])[2]) < 1e-3:
            assert abs(turned.apply([1, 0, 0])[2]) == pytest.approx(1, abs=1e-6)
            lying += 1
    assert lying


def test_cluster_of_one_sphere_orbits_on_the_ring_of_the_sphere():
    sphere = DISC.replace(
        bead={"diameter": "0.3 um", "shape": "sphere"},
        beam={"polarisation": "circular", "vortex": 1},
    )
    one = {"diameter": "0.3 um", "refractive_index": 1.5715, "position": [0, 0, 0]}
    cluster = sphere.replace(bead={"shape": "spheres", "density": "1050 kg/m^3", "spheres": [one]})
    ring = tweezer.characterise(sphere).ring
    start = np.array([0.9 * ring.radius, 0, 0.9 * ring.height])
    found = PoseSearch(cluster).relaxed(start, np.array([1.0, 0, 0, 0]))
    assert found.stable
    assert np.hypot(*found.position[:2]) == pytest.approx(ring.radius, rel=1e-5)
    assert found.position[2] == pytest.approx(ring.height, rel=1e-5)
    mobility = tweezer.resistance(cluster).mobility[0, 0]
    rates = mobility * np.sort(np.linalg.eigvals(ring.stiffness).real)
    assert np.array(found.relaxation_rates)[-2:, 0] == pytest.approx(rates, rel=1e-3)
    # releases are uniform around the orbit, and their variances have standard errors of 2.2 %
    n, kT = 4000, 1e-3 * 1.380649e-23 * sphere.medium.temperature  # so that the motion is linear
    normals = np.random.default_rng(4).normal(size=(n, DRAWN.width))
    positions, _ = PoseSearch(cluster).drawn(found, kT, normals)
    across = np.hypot(positions[:, 0], positions[:, 1])
    expected = solve_continuous_lyapunov(np.array(ring.stiffness), 2 * kT * np.eye(2))
    spread = np.var([across, positions[:, 2]], axis=1)
    np.testing.assert_allclose(spread, np.diag(expected), rtol=4 * np.sqrt(2 / n))
    angle = np.arctan2(positions[:, 1], positions[:, 0])
    assert abs(np.exp(1j * angle).mean()) < 4 / np.sqrt(n)
