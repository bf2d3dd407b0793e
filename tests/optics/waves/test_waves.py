"""The force of waves against plane waves scattered one by one, and what must hold exactly."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import tweezer

ROWS = json.loads((Path(__file__).parents[2] / "data" / "waves.json").read_text())["rows"]
#: Pupil radius of all rows, m
PUPIL = 2.5e-3


def scene_of(row, **optics):
    """A row of the table of `tests.reference.waves_table` as a scene of 1 W."""
    light = row["polarisation"]
    beam = {"wavelength": row["wavelength"], "power_through_pupil": 1.0, "vortex": row["vortex"]}
    if isinstance(light, str):
        beam["polarisation"] = light
    else:
        beam |= {"polarisation": "linear", "jones": [light[:2], light[2:]]}
    if row["waist"] is None:
        beam["profile"] = "uniform"
    else:
        beam["waist"] = row["waist"] * PUPIL
        beam["profile"] = "donut" if row["ring"] and not row["vortex"] else "gaussian"
    sine = float(np.sin(row["half_angle"]))
    before = row["cover"][0] if row["cover"] else row["medium"]
    lens = {"map": row["lens"], "radius": PUPIL, "numerical_aperture": sine * before}
    if row["lens"] == "tan":
        lens = {"map": "tan", "radius": PUPIL, "focal_length": PUPIL / np.tan(row["half_angle"])}
    if row["cover"]:
        lens["cover"] = {"refractive_index": row["cover"][0], "depth": row["cover"][1]}
    if len(row["layers"]) == 1:
        radius, *index = row["layers"][0]
        bead = {"radius": radius, "refractive_index": index if index[1] else index[0]}
    else:
        bead = {"layers": [
            {"radius": radius, "refractive_index": index if index[1] else index[0]}
            for radius, *index in row["layers"]
        ]}  # fmt: skip
    return tweezer.load_scene({
        "bead": {"density": 1050, **bead},
        "medium": {
            "refractive_index": row["medium"], "density": 998, "viscosity": "1 mPa s",
            "temperature": "20 degC", "mean_free_path": "0.01 nm",
        },
        "lens": lens,
        "beam": beam,
        "start": {"position": [0, 0, 0]},
        "optics": {"theory": "waves", **optics},
        "simulation": {"duration": "1 ms"},
    })  # fmt: skip


@pytest.mark.parametrize("row", ROWS, ids=[f"{i}-{row['name']}" for i, row in enumerate(ROWS)])
def test_force_torque_and_absorbed_power_are_those_of_plane_waves(row):
    """Which `tests.reference.plane_waves` scatters one by one: no multipole of the beam is used."""
    scene, place = scene_of(row), row["place"]
    exact, strength = np.array(row["force"]), row["medium"] / 299792458.0
    force = tweezer.optical_force(scene, place)
    assert np.linalg.norm(force - exact) < 1e-8 * max(np.linalg.norm(exact), 1e-3 * strength)
    omega = 2 * np.pi * 299792458.0 / row["wavelength"]
    torque = tweezer.optical_torque(scene, place) * omega
    assert np.abs(torque - np.array(row["torque"]) * omega).max() < 1e-9
    assert tweezer.absorbed_power(scene, place) == pytest.approx(row["absorbed"], abs=1e-9)


def test_gradients_read_no_memory_that_was_not_written():
    """One place at a time, each after memory of that size was filled with NaN, and freed."""
    scene = tweezer.load_scene("silica-1um")
    place = np.array([0.0, 0.0, 2e-7])
    for size in range(600, 3000, 8):
        rubbish = np.full((2, size), np.nan)
        del rubbish
        assert np.isfinite(tweezer.optical_jacobian(scene, place)).all()
