"""Line of a bead of high quality behind the lock-in: its width and its temperature.

`python -m tests.lock_in_line [QUALITY [BEADS [SEED]]]` releases beads in a linear trap at 20
standard deviations and follows them for a fifth of the time 1/Gamma. The mean amplitude falls as
e^(-Gamma t/2) and the variance grows as (2 kT/k)(1 - e^(-Gamma t)), which are the width of the line
and the temperature. A spectrum resolves the width only after many times 1/Gamma. The defaults are
the quality 1e6 and 3000 beads. The time is in proportion to both.
"""

from __future__ import annotations

import math
import sys
import time

import numpy as np

import tweezer
from tests.dynamics.test_baths import BEAD, KT, NU, STIFFNESS
from tests.dynamics.test_lock_in import in_gas
from tests.reference.fields import LinearTrap, in_place
from tweezer.dynamics import bound_once
from tweezer.dynamics.walk import walk

#: Initial position, standard deviations, and duration in units of 1/Gamma
RELEASED, LIVES = 20.0, 0.2
SAMPLES = 41


def amplitudes(quality, beads, seed):
    """Return the damping rate, 1/s, bandwidth, times, (samples,), and z, (beads, samples, axes).

    Samples are whole half-periods apart, so that what the low-pass leaves of the image at twice the
    reference is the same in each.
    """
    gamma = 2 * math.pi * NU / quality
    interval = math.ceil(LIVES / gamma / (SAMPLES - 1) * 2 * NU) / (2 * NU)
    away = RELEASED * math.sqrt(KT / STIFFNESS)
    bandwidth = 0.5 / interval
    scene = in_gas(quality, bandwidth, SAMPLES, (SAMPLES - 1) * interval).replace(
        start={"position": [away, away, away], "drawn": "no"},
        simulation={"loss_distance": 50 * away},
    )
    one = walk(in_place(bound_once(scene), LinearTrap(STIFFNESS)), seed)
    out = np.empty((beads, SAMPLES - 1, 12))
    one.advance(one.start(np.arange(beads)), np.arange(beads), 0, out)
    gamma = tweezer.bead_properties(scene).drag / BEAD.mass
    return gamma, bandwidth, one.times[1:], out[..., 6:9] + 1j * out[..., 9:]


def main(quality: float = 1e6, beads: float = 3000, seed: float = 1) -> None:
    """Print the damping rate over that of the gas, and the temperature over that of the scene."""
    begun = time.perf_counter()
    gamma, bandwidth, times, z = amplitudes(quality, int(beads), int(seed))
    settled = np.searchsorted(times, 10 / (2 * math.pi * bandwidth))
    first, last = z[:, settled], z[:, -1]
    passed = 1 / (1 + gamma / 2 / (2 * math.pi * bandwidth))
    lasted = times[-1] - times[settled]
    ratio = np.abs(last.mean(axis=0)).sum() / np.abs(first.mean(axis=0)).sum()
    width = -2 * math.log(ratio) / (gamma * lasted)
    left = math.exp(-gamma * lasted / 2)
    apart = last - last.mean(axis=0) - left * (first - first.mean(axis=0))
    grown = 2 * KT / STIFFNESS * (1 - left**2) * passed
    warmth = (np.abs(apart) ** 2).mean() / grown
    independent = 3 * beads
    of_amplitude = math.sqrt(grown / 2 / independent) / (left * np.abs(first).mean())
    of_width = of_amplitude * 2 / (gamma * lasted)
    print(f"quality {quality:g}, {beads:g} beads, {time.perf_counter() - begun:.0f} s")
    print(f"width {width:.4f} +- {of_width:.4f} of that of the gas")
    print(f"temperature {warmth:.4f} +- {1 / math.sqrt(independent):.4f} of that of the gas")


if __name__ == "__main__":
    main(*map(float, sys.argv[1:]))
