"""Results of several axes by number and by name."""

import dataclasses
from types import SimpleNamespace

import numpy as np
import pytest

import tweezer
from tweezer.calibration.by_axis import ByAxis


def test_axes_are_found_by_number_and_by_name():
    axes = ByAxis(SimpleNamespace(axis=name) for name in "xz")
    assert axes["x"] is axes[0]
    assert axes["z"] is axes[-1]
    assert axes[:1] == (axes[0],)
    with pytest.raises(KeyError, match="no such axis; choose from: x, z"):
        axes["y"]


def test_axes_of_a_free_bead_have_names():
    rng = np.random.default_rng(1)
    places = np.cumsum(rng.normal(size=(500, 2)), axis=0) * 1e-8
    recording = tweezer.Recording(0.01 * np.arange(500), places, ("x", "y"), name="free")
    found = tweezer.calibrate(recording, temperature=293.15)
    assert found.axes["y"] is found.axes[1]
    assert found.free.axes["x"].axis == "x"
    assert dataclasses.replace(found).axes["x"] is found.axes["x"]
