"""Bodies: what asks for a gap follows the shape, and what asks for a length scale the size."""

import math

import numpy as np
import pytest

import tweezer
from tweezer.scene.body import Body
from tweezer.scene.sections.bead import Bead


class Upright(Body):
    """A prolate spheroid whose long semi-axis, three times the short one, points along z."""

    def __init__(self, size, density):
        self.size = size
        self.volume = 4 / 3 * math.pi * 3 * size**3
        self.mass = density * self.volume
        across, along = 10 / 5 * self.mass * size**2, 2 / 5 * self.mass * size**2
        self.moments_of_inertia = (across, across, along)

    def support(self, normal=1.0, orientation=None):
        return 3 * self.size


@pytest.fixture
def upright(monkeypatch):
    monkeypatch.setattr(Bead, "body", property(lambda bead: Upright(bead.radius, bead.density)))


def walled(height):
    return tweezer.load_scene("silica-1um").replace(
        wall={"position": -4e-6, "opposite": 16e-6}, start={"position": [0, 0, height - 4e-6]}
    )


def test_sphere_is_a_body_of_its_radius():
    scene = walled(2e-6)
    body = scene.body
    assert body.size == body.support(-1.0) == scene.bead.radius
    assert body.gap((-4e-6, 1.0), -2e-6) == scene.gap(-2e-6) == 2e-6 - 0.5e-6
    assert body.mass == pytest.approx(2000 * math.pi / 6 * 1e-18)
    assert body.moments_of_inertia == pytest.approx([0.4 * body.mass * 0.25e-12] * 3)


def test_gap_and_mass_are_those_of_the_body(upright):
    scene = walled(2e-6)
    assert scene.gap(-2e-6) == pytest.approx(0.5e-6)
    assert scene.room(15e-6) == pytest.approx(16e-6 - 15e-6 - 1.5e-6)
    bead = tweezer.bead_properties(scene)
    assert bead.mass == pytest.approx(3 * 2000 * math.pi / 6 * 1e-18)
    assert bead.displaced_mass / bead.mass == pytest.approx(scene.medium.density / 2000)
    assert bead.moments_of_inertia[2] * 5 == pytest.approx(bead.moments_of_inertia[0])


def test_start_within_reach_of_the_body_is_refused(upright):
    with pytest.raises(tweezer.SceneError, match="its gap would be -1e-07 m"):
        walled(1.4e-6)


def test_force_is_refused_where_the_body_reaches_into_the_wall(upright):
    scene = walled(2e-6)
    with pytest.raises(tweezer.SceneError, match=r"reaches into the wall at z = -4 um"):
        tweezer.optical_force(scene, np.array([0, 0, -4e-6 + 1.4e-6]))
