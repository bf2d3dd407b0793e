"""Microrheology of simulated recordings: how often the intervals contain the true moduli.

`python -m tests.rheology_coverage [MEDIUM [RECORDINGS [SEED]]]` simulates recordings of 6.6 s at
20 kHz of a 1 um bead in a trap of 10 pN/um. MEDIUM is `one` or `two`; the default is both. The
solvent has 1 mPa s. `one` has an element of 4 mPa s and 5 ms, and 200 recordings. `two` has an
element of 2 mPa s and 0.5 ms, another of 10 mPa s and 20 ms, and 60 recordings. For each frequency
the program prints the share of 95 % confidence intervals that contain the true modulus and the
relative rms error, and for the trap the share of intervals of the stiffness. It takes about a
second for each recording.
"""

from __future__ import annotations

import sys
from collections import Counter

import numpy as np

import tweezer
from tests.reference.trapped_bead import viscoelastic

RADIUS, TEMPERATURE, STIFFNESS, SOLVENT = 0.5e-6, 295.0, 1e-5, 1e-3
STEP, SAMPLES = 5e-5, 132_000
#: Viscosities, Pa s, and times, s, of the elements, and the number of recordings
MEDIA = {"one": ([(4e-3, 5e-3)], 200), "two": ([(2e-3, 5e-4), (1e-2, 2e-2)], 60)}
#: Frequencies at which moduli are compared, Hz
FREQUENCIES = np.array([3.0, 30.0, 300.0, 3000.0])
#: Recordings that are simulated together
TOGETHER = 20


def modulus(elements):
    """Return G* of the medium, (frequencies,), Pa."""
    s = 2j * np.pi * FREQUENCIES
    return s * SOLVENT + sum(s * eta / (1 + s * tau) for eta, tau in elements)


def results(elements, count, seed):
    """Yield the rheology of each recording."""
    per_viscosity = 6 * np.pi * RADIUS
    springs = [(per_viscosity * eta, tau) for eta, tau in elements]
    times = STEP * np.arange(SAMPLES)
    for first in range(0, count, TOGETHER):
        number = min(TOGETHER, count - first)
        positions = viscoelastic(
            STEP, SAMPLES, STIFFNESS, per_viscosity * SOLVENT, springs, TEMPERATURE,
            [seed, first, len(elements)], number,
        )  # fmt: skip
        for each in positions:
            recording = tweezer.Recording(times, each, ("x",))
            yield tweezer.rheology(
                recording, temperature=TEMPERATURE, radius=RADIUS, exposure=0,
                frequencies=FREQUENCIES,
            )  # fmt: skip


def main(medium, count, seed):
    """Print coverage and errors in one medium."""
    elements, usual = MEDIA[medium]
    every = [*results(elements, count or usual, seed)]
    true = modulus(elements)
    numbers = Counter(len(each.elements) - 1 for each in every)
    print(f"{medium}: {len(every)} recordings; by number of elements: {dict(numbers)}")
    for name, truth in (("storage", true.real), ("loss", true.imag)):
        parts = [getattr(each, name) for each in every]
        inside = [(part.low <= truth) & (truth <= part.high) for part in parts]
        errors = [np.array(part.values) / truth - 1 for part in parts]
        shares, rms = np.mean(inside, axis=0), np.sqrt(np.mean(np.square(errors), axis=0))
        for f, share, error in zip(FREQUENCIES, shares, rms, strict=True):
            print(f"  {name}, {f:g} Hz: coverage {100 * share:.1f} %, rms error {error:.4f}")
        print(f"  {name}: coverage {100 * np.mean(inside):.1f} %")
    traps = [each.axes["x"] for each in every]
    inside = [abs(each.stiffness - STIFFNESS) < 1.96 * each.stiffness_uncertainty for each in traps]
    print(f"  stiffness: coverage {100 * np.mean(inside):.1f} %")
    findings = Counter(found.name for each in every for found in each.findings)
    print(f"  findings: {dict(findings)}")


if __name__ == "__main__":
    asked = sys.argv[1:]
    for each in asked[:1] or MEDIA:
        main(each, int(asked[1]) if asked[1:] else 0, int(asked[2]) if asked[2:] else 1)
