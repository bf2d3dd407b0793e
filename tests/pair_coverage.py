"""Coverage of the intervals of `tweezer.calibrate_pair`: `python -m tests.pair_coverage [RECORDS]`.

Two 1 um beads are in traps of 50 and 80 pN/um, 1.5 um apart. Their records are exact.
"""

import sys

import numpy as np

import tweezer
from tests.calibration.test_pair import ACROSS, ALONG, KNOWN, SENSITIVITY, STIFFNESS, recorded

#: mobility, sampling interval (s), number of samples and arguments
CASES = {
    "metres, along": (ALONG, 5e-5, 5000, {}),
    "metres, 1 kHz": (ALONG, 1e-3, 5000, {}),
    "volts, along": (ALONG, 5e-5, 5000, {"unit": "V"}),
    "volts, across": (ACROSS, 2e-5, 10_000, {"unit": "V", "direction": "across"}),
}


def coverage(case, records, seed=0):
    """Return the coverage of each interval, mean deviations, and the fraction with findings.

    Mean deviations are in standard errors.
    """
    mobility, step, samples, more = CASES[case]
    scale = SENSITIVITY if "unit" in more else 1.0
    true = np.concatenate([STIFFNESS, SENSITIVITY]) if "unit" in more else STIFFNESS
    inside, deviations, findings = [], [], 0
    for x in recorded(mobility, samples, step, seed, records):
        found = tweezer.calibrate_pair(x / scale, interval=step, **KNOWN, **more)
        values, errors, intervals = found.stiffness, found.stiffness_error, found.stiffness_interval
        if found.sensitivity is not None:
            values = np.concatenate([values, found.sensitivity])
            errors = np.concatenate([errors, found.sensitivity_error])
            intervals = np.concatenate([intervals, found.sensitivity_interval])
        inside.append((intervals[:, 0] < true) & (true < intervals[:, 1]))
        deviations.append((values - true) / errors)
        findings += bool(found.findings)
    return np.mean(inside, axis=0), np.mean(deviations, axis=0), findings / records


if __name__ == "__main__":
    records = int(sys.argv[1]) if len(sys.argv) > 1 else 400
    for case in CASES:
        print(case, *coverage(case, records))
