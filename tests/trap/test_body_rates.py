"""Relaxation rates of a trapped body, against the sphere and against small steps of its motion."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

import tweezer

SCENE = tweezer.load_scene("silica-1um").replace(
    bead={"diameter": "0.6 um"}, forces={"gravity": False, "buoyancy": False}
)


def test_rates_of_a_nearly_round_spheroid_are_those_of_the_sphere():
    """The spheroid is longer than wide by 0.1 %, and its rates differ as much."""
    sphere = tweezer.characterise(SCENE)
    round_ = SCENE.replace(bead={"shape": "spheroid", "length": "0.6006 um"})
    rates = np.array(tweezer.characterise(round_).equilibrium.relaxation_rates)
    expected = np.sort(2 * np.pi * np.array(sphere.corner_frequencies))
    np.testing.assert_allclose(np.sort(rates[:, 0])[3:], expected, rtol=2e-3)
    assert abs(rates[:3]).max() < 0.01 * expected.max()


@pytest.mark.parametrize("light", [{"polarisation": "linear"}])
def test_slowest_rate_is_that_of_the_motion(light):
    """Overdamped motion from a small displacement decays as exp(-rate t) along its eigenvector."""
    scene = SCENE.replace(
        bead={"shape": "spheroid", "diameter": "0.4 um", "length": "0.8 um"}, beam=light
    )
    held = tweezer.characterise(scene).equilibrium
    resistance = tweezer.resistance(scene)
    start = Rotation.from_quat(held.orientation, scalar_first=True)

    def velocity(_, moved):
        turned = (Rotation.from_rotvec(moved[3:]) * start).as_quat(scalar_first=True)
        place = np.array(held.position) + moved[:3]
        wrench = np.concatenate([
            tweezer.optical_force(scene, place, turned),
            tweezer.optical_torque(scene, place, turned),
        ])  # fmt: skip
        frame = np.kron(np.eye(2), Rotation.from_quat(turned, scalar_first=True).as_matrix())
        return frame @ resistance.mobility @ frame.T @ wrench

    rates, ways = np.linalg.eig(
        np.kron(np.eye(2), start.as_matrix()) @ resistance.mobility
        @ np.kron(np.eye(2), start.as_matrix()).T @ np.array(held.stiffness)
    )  # fmt: skip
    which = np.argsort(rates.real)[1]
    rate = rates[which].real
    way = np.real(ways[:, which])
    way *= 1e-10 / np.linalg.norm(way * [1, 1, 1, 4e-7, 4e-7, 4e-7])
    end = solve_ivp(velocity, (0, 1 / rate), way, rtol=1e-9, atol=1e-16).y[:, -1]
    assert end @ way / (way @ way) == pytest.approx(np.exp(-1), rel=1e-3)
    assert np.array(held.relaxation_rates)[1, 0] == pytest.approx(rate, rel=1e-9)
