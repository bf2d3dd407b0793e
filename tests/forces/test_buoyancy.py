"""Torque of buoyancy, against rotated vectors."""

import numpy as np
from scipy.spatial.transform import Rotation

from tweezer.forces.buoyancy import BuoyancyTorque


def test_torque_is_the_lift_at_the_rotated_centre_of_volume():
    lift, centre = 3e-15, (2e-7, -3e-7, 5e-7)
    turned = Rotation.random(20, random_state=2)
    found = BuoyancyTorque(lift, centre).field(
        np.zeros((20, 3)), orientations=turned.as_quat(scalar_first=True)
    )
    expected = np.cross(turned.apply(centre), [0, 0, lift])
    np.testing.assert_allclose(found.moment, expected, rtol=1e-12, atol=1e-35)
    assert not found.force.any()
