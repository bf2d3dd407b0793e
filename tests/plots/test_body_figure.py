"""The figure of a trapped body: its outline, and its curves of force and torque."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import tweezer
from tweezer.plots.body import body_trap_figure, outline

ROD = tweezer.load_scene("silica-1um").replace(
    bead={"shape": "spheroid", "diameter": "0.4 um", "length": "0.8 um", "refractive_index": 1.57},
    beam={"polarisation": "linear"}, forces={"gravity": False, "buoyancy": False},
)  # fmt: skip
PAIR = ROD.replace(
    bead={
        "shape": "spheres", "length": None, "radius": None, "refractive_index": None,
        "spheres": [
            {"diameter": d, "refractive_index": 1.57, "position": [0, 0, z]}
            for d, z in ((3e-7, -2e-7), (2e-7, 2e-7))
        ],
    }
)  # fmt: skip
TURN = Rotation.from_rotvec([0.7, -0.4, 0.3])


@pytest.mark.parametrize("plane", ["xz", "yz"])
def test_outline_of_a_spheroid_encloses_its_points_and_touches_them(plane):
    (found,) = outline(ROD, TURN.as_quat(scalar_first=True), plane)
    theta, phi = np.meshgrid(np.linspace(0, np.pi, 301), np.linspace(0, 2 * np.pi, 301))
    points = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)])
    points = TURN.apply(points.reshape(3, -1).T * [2e-7, 2e-7, 4e-7])
    seen = points[:, ["xyz".index(each) for each in plane]]
    for angle in np.linspace(0, 2 * np.pi, 9):
        normal = np.array([np.cos(angle), np.sin(angle)])
        assert (found @ normal).max() == pytest.approx((seen @ normal).max(), rel=1e-3)
    assert found[0] == pytest.approx(found[-1])


@pytest.mark.parametrize("plane", ["xz", "yz"])
def test_outline_of_a_cluster_has_a_circle_for_each_sphere(plane):
    found = outline(PAIR, TURN.as_quat(scalar_first=True), plane)
    centres = TURN.apply(np.array(PAIR.bead.centres))
    assert len(found) == 2
    for circle, centre, radius in zip(found, centres, (1.5e-7, 1e-7), strict=True):
        middle = centre[["xyz".index(each) for each in plane]]
        assert np.linalg.norm(circle - middle, axis=1) == pytest.approx(radius)


@pytest.fixture(scope="module")
def drawn():
    trap = tweezer.characterise(ROD)
    figure = body_trap_figure(ROD, trap)
    return trap, {each.get_title(): each for each in figure.axes}


def test_figure_draws_the_body_at_its_equilibrium(drawn):
    trap, axes = drawn
    (patch,) = [each for each in axes["xz plane, to scale"].patches if each.get_alpha() == 0.35]
    points = patch.get_xy()
    middle = (points.max(0) + points.min(0)) / 2
    assert middle == pytest.approx([0, 1e6 * trap.equilibrium.position[2]], abs=1e-6)
    assert np.ptp(points, axis=0) == pytest.approx([0.4, 0.8], rel=1e-4)


@pytest.mark.parametrize(
    ("title", "first"),
    [("force along each axis, orientation held", 0), ("torque about each axis, position held", 3)],
)
def test_curves_have_the_stiffness_as_slope(drawn, title, first):
    trap, axes = drawn
    stiffness = np.array(trap.equilibrium.stiffness)
    lines = {each.get_label(): each for each in axes[title].lines}
    for i, name in enumerate("xyz"):
        x, y = lines[name].get_data()
        at = len(x) // 2
        slope = (y[at + 1] - y[at - 1]) / (x[at + 1] - x[at - 1])
        # pN/um, or pN um over degrees
        unit = 1e6 if first == 0 else 1e18 * np.pi / 180
        expected = -unit * stiffness[first + i, first + i]
        assert slope == pytest.approx(expected, rel=2e-2, abs=1e-9)
        assert y[at] == pytest.approx(0, abs=1e-6)


def test_figure_without_an_equilibrium_says_so():
    trap = dataclasses.replace(tweezer.characterise(ROD), equilibrium=None)
    figure = body_trap_figure(ROD, trap)
    text = " ".join(
        each.get_text() for each in figure.findobj(lambda each: hasattr(each, "get_text"))
    )
    assert "no stable equilibrium was found" in " ".join(text.split())
