"""Compute the traps behind the knobs of the landing page: `python docs/knobs.py` writes knobs.json.

Every combination of the listed diameters, numerical apertures and powers is one case of a sweep
over the shipped scene silica-1um. The page shows these computed values and interpolates nothing.
"""

import json
import tempfile
import warnings
from pathlib import Path

import numpy as np

import tweezer

SCENE = "silica-1um"
DIAMETERS = [0.2, 0.3, 0.5, 0.75, 1, 1.5, 2, 3]  # um
APERTURES = [0.8, 0.9, 1, 1.1, 1.2, 1.25]
POWERS = [5, 10, 20, 50, 100, 200]  # mW through the pupil


def table(diameters: list[float], apertures: list[float], powers: list[float]) -> dict:
    """Return stiffness, equilibrium and well depth of each case, rounded to four digits.

    The nested lists are indexed by diameter, aperture and power. A case without a trap is null.
    """
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("ignore", tweezer.PhysicsWarning)  # about the smallest beads
        traps = tweezer.sweep(
            SCENE,
            {
                "bead.diameter": [f"{each} um" for each in diameters],
                "lens.numerical_aperture": apertures,
                "beam.power_through_pupil": [f"{each} mW" for each in powers],
            },
            out=Path(folder, "knobs.zarr"),
        ).load()
    return {
        "scene": SCENE,
        "diameter_um": diameters,
        "numerical_aperture": apertures,
        "power_mW": powers,
        "lateral_pN_per_um": _rounded(1e6 * traps.stiffness.sel(axis="x").values),
        "axial_pN_per_um": _rounded(1e6 * traps.stiffness.sel(axis="z").values),
        "equilibrium_z_um": _rounded(1e6 * traps.equilibrium.sel(axis="z").values),
        "depth_kT": _rounded(traps.escape_energy.min("direction", skipna=False).values),
    }


def _rounded(values: np.ndarray) -> list:
    """Return nested lists of four significant digits, None for NaN."""
    if values.ndim:
        return [_rounded(each) for each in values]
    return None if np.isnan(values) else float(f"{values:.4g}")


if __name__ == "__main__":
    text = json.dumps(table(DIAMETERS, APERTURES, POWERS))
    Path(__file__).with_suffix(".json").write_text(text + "\n", encoding="utf-8")
