"""Signals of six beads at three apertures against plane waves, and their slopes and shot noise.

`python -m tests.detector_table` compares the signals of quadrant diodes, 1 for all of the light,
with `tests.reference.far_field` at a place off the axis. It prints the largest deviation, and the
slopes over the light, linear ranges, information and shot noise at rest. It takes some minutes.
"""

import math

import numpy as np

import tweezer
from tests.optics.waves.test_detector import weights
from tests.reference.far_field import Far
from tests.reference.plane_waves import Light, Sphere, lens
from tweezer.optics.detection import detection

N_M, VACUUM, NA, FILLING = 1.33, 1.064e-6, 1.2, 0.6
ANGLE = math.asin(NA / N_M)
BEADS = ((0.2e-6, 1.59), (0.5e-6, 1.59), (1e-6, 1.59), (1e-6, 1.45), (2e-6, 1.45), (3e-6, 1.45))
APERTURES = (0.5, 0.9, 1.2)
PLACE = np.array([0.12, -0.09, 0.15]) * 1e-6


def scene_of(diameter, index, aperture):
    """Return 1 mW of linearly polarised light through an objective, on a bead in water."""
    described = tweezer.load_scene("silica-1um").model_dump(exclude_none=True)
    described["bead"] = {"diameter": diameter, "refractive_index": index, "density": 1050}
    described["medium"] |= {"refractive_index": N_M, "mean_free_path": 1e-10}
    described["lens"] = {"map": "sine", "numerical_aperture": NA, "radius": 2.5e-3}
    described["beam"] = {
        "wavelength": VACUUM, "profile": "gaussian", "sigma": FILLING * 2.5e-3,
        "power_through_pupil": 1e-3, "polarisation": "linear",
    }  # fmt: skip
    described["detector"] = {"numerical_aperture": aperture}
    return tweezer.load_scene(described)


def main():
    """Print a line for each bead and aperture."""
    light = Light(N_M, VACUUM, ANGLE, lens(ANGLE, 2 * FILLING), (1, 0))
    worst = 0.0
    for diameter, index in BEADS:
        far = Far(light, Sphere(((diameter / 2, index),)), PLACE)
        for aperture in APERTURES:
            scene = scene_of(diameter, index, aperture)
            widest = math.asin(aperture / N_M)
            expected = far.signal([0, widest], weights("quadrant", widest), 30, 30)
            signals = detection(scene).signals(PLACE[None])[0] / 1e-3
            off = float(np.abs(signals - expected).max())
            worst = max(worst, off)
            found = tweezer.detect(scene)
            slopes = np.diagonal(found["slope"]) / float(found["signal"][2]) * 1e-6
            print(
                f"{1e6 * diameter:g} um, index {index}, NA {aperture}: deviation {off:.1e}; slopes "
                f"{slopes[0]:.2f} {slopes[1]:.2f} {slopes[2]:.2f}/um, linear to "
                f"{1e6 * found['linear_range'].values.round(9)} um, information "
                f"{found['information'].values.round(3)}, noise "
                f"{(1e12 * found['shot_noise'].values).round(3)} pm/sqrt(Hz)"
            )
    print(f"largest deviation: {worst:.1e}")


if __name__ == "__main__":
    main()
