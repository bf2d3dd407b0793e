"""Stretching of a DNA between two traps: how often the intervals contain the true lengths.

`python -m tests.stretch_coverage [RECORDS [SEED]]` simulates the scene of
`tests/tracking/test_stretching.py` for a number of seeds, 100 by default. It prints the share of
95 % confidence intervals that contain contour length and persistence length, the mean deviation in
standard errors, and the number of findings. It takes about ten seconds for each record.
"""

from __future__ import annotations

import sys
import warnings

import numpy as np

import tweezer
from tests.tracking.test_stretching import CONTOUR, PERSISTENCE, dna


def main(records: int = 100, seed: int = 0) -> None:
    """Print the coverage."""
    warnings.simplefilter("ignore")
    scene = dna("0.3 s", 3001, "2 um/s")
    inside, apart, findings = [], [], 0
    for each in range(seed, seed + records):
        fit = tweezer.stretch(scene, each).fit
        lengths = (
            (CONTOUR, fit.contour_length, fit.contour_length_interval),
            (PERSISTENCE, fit.persistence_length, fit.persistence_length_interval),
        )
        inside.append([low <= true <= high for true, _, (low, high) in lengths])
        apart.append([3.92 * (x - true) / (high - low) for true, x, (low, high) in lengths])
        findings += bool(fit.findings)
    for k, name in enumerate(("contour length", "persistence length")):
        share, mean = np.mean(inside, axis=0)[k], np.mean(apart, axis=0)[k]
        print(f"{name}: {100 * share:.1f} % of {records}, mean deviation {mean:+.2f} errors")
    print(f"findings in {findings} of {records}")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
