"""The figure of a free bead, on a random walk with a known diffusion and drift."""

import numpy as np
import pytest

import tweezer
from tests import readable
from tweezer.plots import calibration_figure
from tweezer.reading import Recording

N, STEP, D, DRIFT = 2000, 1 / 15, 0.43e-12, np.array([5e-8, -2e-8])


@pytest.fixture(scope="module")
def figure():
    steps = np.random.default_rng(5).normal(0, np.sqrt(2 * D * STEP), (N, 2))
    times = STEP * np.arange(N)
    recording = Recording(
        times, np.cumsum(steps, axis=0) + times[:, None] * DRIFT, ("x", "y"), name="walk"
    )
    found = tweezer.calibrate(recording, temperature=293.15, viscosity=1.002e-3)
    assert not found.trapped
    return calibration_figure(recording, found)


def panel(figure, label):
    (axes,) = (axes for axes in figure.axes if axes.get_ylabel() == label)
    return axes


def test_free_bead_has_no_panel_of_a_trap(figure):
    readable.check(figure)
    assert figure.get_suptitle() == "Diffusion of walk"
    assert {axes.get_ylabel() for axes in figure.axes} == {
        "x (µm)", "y (µm)", "probability density (1/µm)", "mean squared displacement (µm²)",
        "diffusion by lag (µm²/s)",
    }  # fmt: skip
    assert "stiffness" not in figure.get_supxlabel()


def test_lines_have_the_diffusion_and_the_drift(figure):
    displacement = panel(figure, "mean squared displacement (µm²)")
    assert displacement.get_legend().get_texts()[0].get_text() == "4 D t"
    (line,) = (each for each in displacement.lines if each.get_label() == "4 D t")
    times, values = line.get_data()
    np.testing.assert_allclose(values / (4 * times), 1e12 * D, rtol=0.1)
    bars = displacement.containers[0].lines[0]
    np.testing.assert_allclose(bars.get_ydata()[:4], 4e12 * D * times[:4], rtol=0.1)
    by_lag = panel(figure, "diffusion by lag (µm²/s)").containers[0].lines[0].get_ydata()
    np.testing.assert_allclose(by_lag, bars.get_ydata() / (4 * times))
    for label, drift in zip(("x (µm)", "y (µm)"), DRIFT, strict=True):
        ends = panel(figure, label).lines[1].get_xydata()[[0, -1]]
        slope = np.diff(ends[:, 1]) / np.diff(ends[:, 0])
        error = 1e6 * np.sqrt(2 * D / (N * STEP))
        assert slope[0] == pytest.approx(1e6 * drift, abs=4 * error)


def test_steps_are_counted_once(figure):
    axes = panel(figure, "probability density (1/µm)")
    gaussian = next(line for line in axes.lines if line.get_label() == "from D")
    at, density = gaussian.get_data()
    assert np.trapezoid(density, at) == pytest.approx(1, abs=1e-3)
    assert density.max() == pytest.approx(1e-6 / np.sqrt(4 * np.pi * D * STEP), rel=0.1)
