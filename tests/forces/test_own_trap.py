"""The trap of a scene with forces of the user's own: Newton's method on the sum is the oracle."""

import numpy as np
import pytest
from scipy.optimize import root

import tweezer
from tweezer.forces import UserForce, kernel, matrix, number, vector
from tweezer.values.errors import ForceError, ResultError

SCENE = tweezer.load_scene("silica-1um")
DARK = SCENE.replace(forces={"optical": False})
WEIGHT = np.array(tweezer.bead_properties(SCENE).weight)
K = np.array([[1e-5, 4e-6, 0.0], [4e-6, 2e-5, 0.0], [0.0, 0.0, 3e-5]])
CENTRE = np.array([1e-7, -5e-8, 8e-8])


@kernel
def tether(pose, data, wrench):
    """F = -K (x - c), and NaN beyond a distance along x."""
    stiffness, centre = matrix(data, 0), vector(data, 1)
    for i in range(len(pose.time)):
        for k in range(3):
            for l in range(3):
                wrench.force[i, k] -= stiffness[k, l] * (pose.position[i, l] - centre[l])
        wrench.error[i] += 1e-17
        if pose.position[i, 0] > number(data, 2):
            wrench.force[i, 0] += np.nan


def tethered(until=1.0):
    return [UserForce(tether, (K, CENTRE, until))]


def test_equilibrium_stiffness_and_escape_are_of_all_forces():
    trap = tweezer.characterise(SCENE, forces=tethered())

    def net(place):
        return tweezer.optical_force(SCENE, place) + WEIGHT - K @ (place - CENTRE)

    found = root(lambda x: 1e12 * net(1e-7 * x), [0.0, 0.0, 0.5], tol=1e-12).x * 1e-7
    np.testing.assert_allclose(trap.equilibrium.position, found, atol=1e-14)
    assert abs(found[0]) > 1e-9  # off the axis
    steps = 1e-10 * np.eye(3)
    slope = np.array([(net(found - each) - net(found + each)) / 2e-10 for each in steps]).T
    np.testing.assert_allclose(trap.stiffness, slope, atol=1e-5 * slope.max())
    assert [each.direction for each in trap.escapes] == ["+x", "-x", "+y", "-y", "+z", "-z"]
    for each in trap.escapes[:2]:  # they are not alike
        way = np.array([1.0 if each.direction == "+x" else -1.0, 0.0, 0.0])
        assert -way @ net(found + each.force_at * way) == pytest.approx(each.force, rel=1e-6)
    assert trap.escapes[0].force != pytest.approx(trap.escapes[1].force, rel=1e-6)
    assert trap.force_error >= 1e-17
    assert trap.other_forces == 1


def test_force_alone_holds_the_bead():
    trap = tweezer.characterise(DARK, forces=tethered())
    (place,) = trap.equilibria
    np.testing.assert_allclose(place.position, CENTRE + np.linalg.solve(K, WEIGHT), atol=1e-15)
    np.testing.assert_allclose(trap.stiffness, K, atol=1e-11)


def test_quantities_of_the_scene_alone_are_refused_with_other_forces():
    """The lifetime and the picture do not know the force."""
    trap = tweezer.characterise(SCENE, forces=tethered())
    assert "not yet computed" not in repr(trap)
    assert "forces of your own       1\n" in repr(trap)
    assert trap.lifetime is None
    assert trap.lifetime_without_light is None
    assert trap.lifetime_caveat == "not computed with your own forces"
    with pytest.raises(ResultError, match="this trap has 1 of your own"):
        tweezer.view(trap)
    assert not tweezer.compare(trap, tweezer.characterise(SCENE)).agrees


def test_force_that_goes_wrong_on_the_way_is_refused():
    with pytest.raises(ForceError, match=r"forces: tether, line 2\d.*the place"):
        tweezer.characterise(SCENE, forces=tethered(until=2e-6))
    with pytest.raises(tweezer.SceneError, match="must be a list of UserForce"):
        tweezer.characterise(SCENE, forces=tether)
