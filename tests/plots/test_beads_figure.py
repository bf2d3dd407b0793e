"""The figure of a run of several beads."""

import numpy as np
import pytest

import tweezer
from tests import readable
from tweezer.plots import beads_figure

BEAD = {"diameter": "1 um", "material": "silica"}


def sinking(**changes):
    """Return two dark beads, one above the other, which sink."""
    data = tweezer.load_scene("silica-1um").model_dump(exclude_none=True)
    data["bead"] = [
        BEAD | {"name": "low", "start": [0, 0, 0]},
        BEAD | {"name": "high", "start": [0, 0, 2e-6]},
    ]
    data["start"] = {}
    data["forces"] = {"optical": False}
    data["simulation"] = {"duration": 0.01, "samples": 21}
    return tweezer.load_scene(data | changes)


@pytest.mark.parametrize("tied", [False, True])
def test_panels_contain_displacements_distance_and_force(tied):
    tether = {"model": "spring", "between": ["low", "high"], "stiffness": 1e-6}
    run = tweezer.simulate(sinking(tether=[tether] if tied else []))
    figure = beads_figure(run)
    readable.check(figure)
    moved, distance, *force = figure.axes
    assert moved.get_ylabel() == "displacement in z (nm)"
    z = run.position.sel(axis="z").values
    for line, each in zip(moved.get_lines(), z.T, strict=True):
        np.testing.assert_allclose(line.get_xdata(), 1e3 * run.time)
        np.testing.assert_allclose(line.get_ydata(), 1e9 * (each - each[0]), atol=1e-9)
    assert [text.get_text() for text in moved.get_legend().get_texts()] == ["low", "high"]
    (line,) = distance.get_lines()
    np.testing.assert_allclose(line.get_ydata(), 1e6 * run.distance[:, 0])
    assert len(force) == tied
    for panel in force:
        (line,) = panel.get_lines()
        np.testing.assert_allclose(line.get_ydata(), 1e12 * run.force_between[:, 0])
