"""The figure of an ensemble: its curves are the mean and the spread of the trajectories."""

import numpy as np
import pytest
import xarray as xr

import tweezer
from tweezer.plots import ensemble_figure


@pytest.fixture
def walks():
    """Fifteen trajectories that are made up; two beads are lost."""
    scene = tweezer.load_scene("silica-1um").replace(
        forces={"brownian": True, "optical": False}, simulation={"duration": "2 ms"}
    )
    steps = 2e-7 * np.random.default_rng(5).normal(size=(15, 12, 3))
    times, position = np.linspace(0, 2e-3, 12), steps.cumsum(axis=1)
    lost = np.full(15, np.inf)
    for bead, sample in ((3, 5), (8, 9)):
        position[bead, sample:] = np.nan
        lost[bead] = times[sample]
    return xr.Dataset(
        {"position": (("trajectory", "time", "axis"), position), "lost_time": ("trajectory", lost)},
        {"time": times, "axis": ["x", "y", "z"]},
        {
            "title": "beads that are made up", "scene": scene.model_dump_json(exclude_none=True),
            "trajectories": 15, "trajectories_done": 15, "seed": 5, "model": "overdamped",
            "method": "heun", "step": 1e-5, "tweezer_version": "0.1.0", "status": "complete",
        },
    )  # fmt: skip


def test_curves_are_mean_spread_and_number_of_beads(walks):
    figure = ensemble_figure(walks)
    by_label = {axes.get_ylabel(): axes for axes in figure.axes}
    position = 1e6 * walks["position"].values
    for k, name in enumerate("xyz"):
        axes = by_label[f"{name} (µm)"]
        time, mean = axes.lines[0].get_data()
        np.testing.assert_allclose(time, 1e3 * walks["time"])
        np.testing.assert_allclose(mean, np.nanmean(position[:, :, k], axis=0))
        band = axes.collections[0].get_paths()[0].vertices[:, 1]
        spread = np.nanstd(position[:, :, k], axis=0, ddof=1)
        assert band.max() == pytest.approx((mean + spread).max(), rel=1e-9)
        assert band.min() == pytest.approx((mean - spread).min(), rel=1e-9)
    time, left = by_label["beads not lost"].lines[0].get_data()
    assert left[0] == 15
    assert left[-1] == 13
