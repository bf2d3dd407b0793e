"""Two beads pulled together by a constant force: their gap against the closed form.

`python -m tests.reference.pressed_beads [STEP]` follows 8,000 pairs with steps of 0.2 (STEP) of the
relaxation time of the gap, for about two minutes. It prints the mean gap and the time at gaps below
a tenth of it, over the values of the density rho^2 exp(-P rho/a), with their standard errors.
`tests/beads/test_two.py` follows fewer pairs.
"""

from __future__ import annotations

import math
import sys

import numpy as np
from scipy.integrate import quad

from tests.beads.springs import KT, UNIT, dark, pair
from tweezer.beads import two

#: Radius a, m, and the force P that pulls the beads together, in kT/a
RADIUS, PULL = 0.5e-6, 50.0
#: Steps before the first sample
SETTLING = 100


def density(gap):
    """Density of the gap, in radii, up to a factor."""
    return (2 + gap) ** 2 * math.exp(-PULL * gap)


def expected():
    """Mean gap, in radii, and part of the time at gaps below a tenth of it."""
    whole = quad(density, 0, 1)[0]
    mean = quad(lambda gap: gap * density(gap), 0, 1)[0] / whole
    return mean, quad(density, 0, 0.1 * mean)[0] / whole


def deviations(copies, samples, between, part=0.2):
    """Return mean gap and time near contact over the expected values, (2,), and standard errors.

    The errors follow from the means of the copies, which are independent. The first samples come
    after `SETTLING` steps from a gap of 0.02 radii, and the others after `between` steps each. A
    step is the `part` of the relaxation time a^2/(4 D P), with the diffusivity D of a bead alone.
    """
    _, plane = pair((RADIUS, RADIUS))
    force = PULL * KT / RADIUS
    soft = 1e-9  # a spring whose tension hardly changes: 1e-9 N/m over a micrometre
    acting = dark((RADIUS, RADIUS), [(0, 1)], [(0, 0, 0)], [(soft, -force / soft, 0, 0)])
    step = part * RADIUS / (4 * UNIT / RADIUS * force)
    mean, near = expected()
    x = np.zeros((copies, 2, 3))
    x[:, 1, 0] = 2.02 * RADIUS
    out = np.empty((copies, 1, 2, 3))
    who, steps = np.arange(copies), 0
    sums = np.zeros((copies, 2))
    for of_sample in (SETTLING, *[between] * samples):
        two.advance(acting, plane, 1, step, who, steps, of_sample, x, out)
        gap = np.linalg.norm(x[:, 1] - x[:, 0], axis=1) / RADIUS - 2
        assert gap.min() > 0
        if steps:
            sums += np.stack([gap / mean, (gap < 0.1 * mean) / near], axis=1)
        steps += of_sample
    of_each = sums / samples
    return of_each.mean(axis=0), of_each.std(axis=0) / math.sqrt(copies)


def main(part=0.2):
    """Print the deviations after 10,000 steps of 8,000 pairs."""
    found, error = deviations(8000, 1000, 10, part)
    for name, value, of in zip(("mean gap", "time near contact"), found, error, strict=True):
        print(f"{name}: {100 * (value - 1):+.2f} % with a standard error of {100 * of:.2f} %")


if __name__ == "__main__":
    main(*map(float, sys.argv[1:]))
