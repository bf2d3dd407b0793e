"""Figure of the mask that makes a trap stiffest."""

import numpy as np
import pytest

import tweezer
from tweezer.plots import optimum_figure

SCENE = tweezer.load_scene("silica-1um")
X = np.linspace(-1, 1, 8)
PHASE = X[:, None] + 2 * X


@pytest.mark.parametrize("mask", [PHASE, 0.5 * np.exp(1j * PHASE)], ids=["phase", "field"])
def test_figure_shows_mask_and_force(mask):
    """The scene of this result has no mask, so that both curves differ by the equilibrium alone."""
    best = tweezer.Optimum(
        scene=SCENE, mask=mask, goal="ky", stiffness=(1e-5,) * 3, without=None, bound=1e-5,
        linear_range=(1e-7,) * 3, passed=1.0,
    )  # fmt: skip
    amplitude, phase, force, *_ = optimum_figure(best, SCENE).axes
    inside = np.hypot(X, X[:, None]) <= 1
    size = np.ones((8, 8)) if mask is PHASE else np.abs(mask)
    for axes, values in ((amplitude, size), (phase, PHASE)):
        shown = axes.images[0].get_array()
        np.testing.assert_array_equal(~shown.mask, inside)
        np.testing.assert_allclose(shown[inside], values[inside])
    curves = {line.get_label(): line.get_xydata() for line in force.lines}
    rest = tweezer.characterise(SCENE).equilibrium.position
    for label, place in (("with the mask", np.zeros(3)), ("without", rest)):
        y, pull = curves[label][100]
        expected = tweezer.optical_force(SCENE, place + 1e-6 * y * np.eye(3)[1])[1]
        np.testing.assert_allclose(pull, 1e12 * expected, rtol=1e-6)
