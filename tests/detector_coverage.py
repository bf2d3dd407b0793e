"""Trap stiffness from signals of a quadrant diode: how often intervals contain the true value.

`python -m tests.detector_coverage [RECORDINGS]` simulates recordings of a 1 um silica bead with 20,
50 and 100 nm rms along x. It calibrates them by the detector of their scene, by the slopes of its
signals at the equilibrium, and, for comparison, by the positions themselves. For each axis it
prints the share of 95 % confidence intervals that contain the true stiffness, averaged over the
thermal motion, and the mean deviation from it. It takes several minutes.
"""

from __future__ import annotations

import sys
import warnings

import numpy as np

import tweezer
from tweezer.calibration.by_detector import from_signals
from tweezer.dynamics.problem import bound_once
from tweezer.optics.detection import detection
from tweezer.tracking.mean_spring import mean_spring

BOLTZMANN = 1.380649e-23
#: rms along x, m; number of samples of a recording, and their number in a relaxation time
SPREADS, SAMPLES, EACH = (20e-9, 50e-9, 100e-9), 4001, 4
METHOD = "power spectrum"


def scene_of(spread):
    """Return the scene whose trap gives the bead this rms along x, m."""
    scene = tweezer.load_scene("silica-1um").replace(
        detector={"numerical_aperture": 0.5}, forces={"gravity": False, "buoyancy": False},
        beam={"polarisation": "linear", "power_through_pupil": 1e-3},
    )  # fmt: skip
    one = tweezer.characterise(scene)
    power = 1e-3 * BOLTZMANN * scene.medium.temperature / spread**2 / one.stiffness_xyz[0]
    step = one.drag[0] / one.stiffness_xyz[0] * 1e-3 / power / EACH
    return scene.replace(
        beam={"power_through_pupil": power}, forces={"brownian": True},
        start={"drawn": "equilibrium"},
        simulation={"samples": SAMPLES, "duration": (SAMPLES - 1) * step, "model": "overdamped"},
    )  # fmt: skip


def judged(recordings, truth):
    """Return the share of intervals that contain the true stiffness, and the mean deviation."""
    inside, off = [], []
    for recording in recordings:
        found = tweezer.calibrate(recording)
        each = [found.axes[axis][METHOD] for axis in "xyz"]
        values = np.array([one.stiffness for one in each])
        inside.append(np.abs(values - truth) < 1.96 * np.array([one.uncertainty for one in each]))
        off.append(values / truth - 1)
    return np.mean(inside, axis=0), np.mean(off, axis=0)


def main(count):
    """Print coverage and bias for each rms."""
    warnings.simplefilter("ignore")
    for spread in SPREADS:
        scene = scene_of(spread)
        place = tweezer.characterise(scene).equilibrium
        truth = mean_spring(bound_once(scene), place).stiffness
        runs = tweezer.ensemble(scene, count, seed=1)
        times, signals = runs["time"].values, runs["signal"].values
        seen = detection(scene)
        (at_rest,), (slope,), _ = seen.with_slopes(seen.rest[None])
        linear = seen.rest + (signals - at_rest) / slope.diagonal()
        methods = {"positions": runs["position"].values, "slopes": linear}
        together = tweezer.Recording(
            np.arange(signals.size // 3) * times[1], signals.reshape(-1, 3), ("x", "y", "z"),
            unit="W",
        )  # fmt: skip
        try:
            methods["scene"] = from_signals(together, scene).positions.reshape(signals.shape)
        except tweezer.ResultError as refused:
            print(f"{1e9 * spread:.0f} nm: {refused}")
        for name, positions in methods.items():
            recordings = [
                tweezer.Recording(times, each, ("x", "y", "z"), scene=scene) for each in positions
            ]
            inside, off = judged(recordings, truth)
            told = ", ".join(
                f"{axis} {100 * share:.0f} % ({100 * bias:+.1f} %)"
                for axis, share, bias in zip("xyz", inside, off, strict=True)
            )
            print(f"{1e9 * spread:.0f} nm by {name}: {told}")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 100)
