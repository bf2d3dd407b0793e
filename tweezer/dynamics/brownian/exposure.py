"""Mean positions over the exposures of a camera, for beads that move in steps.

Between the ends of a step the bead follows a straight line plus a Brownian bridge of variance
2 D s (h - s)/h. Over a part g of a step its mean is the mean of the positions at both ends of this
part, with a variance D g/6. That is drawn once for a whole exposure.
"""

from __future__ import annotations

import math

import numpy as np

from tweezer.compiled import cached_njit

#: Normal random numbers per frame: for the ends of the exposure, its mean and the detector
ROWS = 12
#: Rows for the detector
DETECTOR = slice(9, 12)
#: Number of sums over the frame that is being exposed: integrals of x, y, z and their variances
HELD = 6
#: Time within which an exposure begins or ends with a step, in steps
OF_A_STEP = 1e-9
#: Likewise for rounding, as a part of the time
OF_THE_TIME = 1e-15


@cached_njit(error_model="numpy", nogil=True)
def expose(  # type: ignore[no-untyped-def]
    first, step, opens, closes, places, diffusion, numbers, held, means
):
    """Fill `means` (n, frames, 3), m, with mean positions over exposures that end in some steps.

    Before this call, `first` steps of length `step` (s) were taken. `places` (n, m + 1, 3) contains
    the positions (m) after them and after each of the next m steps. Exposures begin at `opens` and
    end at `closes`, (frames,) s; the first frame is not complete after `first` steps. `diffusion`
    is (n or 1, m or 1, 3), m^2/s, and `numbers` (n, ROWS, frames) are normal. `held` (n, HELD),
    updated in place, contains the integrals of x, y, z (m s), and their variances, for the frame
    that is being exposed.
    """
    n, frames = places.shape[0], len(opens)
    here, now = np.empty((n, 3)), np.empty((n, 3))
    f = 0
    for k in range(places.shape[1] - 1):
        if f == frames:
            break
        begin, end = (first + k) * step, (first + k + 1) * step
        by = end + (OF_A_STEP * step + OF_THE_TIME * end)
        opened = opens[f] <= begin + (OF_A_STEP * step + OF_THE_TIME * begin)
        if not opened and opens[f] > by:
            continue
        at = min(k, diffusion.shape[1] - 1)
        reached = 0.0
        for i in range(n):
            for d in range(3):
                here[i, d] = places[i, k, d]
        while True:
            closing = opened
            if f == frames:
                break
            goal = closes[f] if opened else opens[f]
            ended = goal > by
            if ended and not opened:
                break
            to = step if ended else min(max(goal - begin, reached), step)
            left, gap = step - reached, to - reached
            part = gap / left if left > 0 else 0.0
            apart = math.sqrt(2 * part * (step - to))
            row = 3 if closing else 0
            for i in range(n):
                for d in range(3):
                    D = diffusion[min(i, diffusion.shape[0] - 1), at, d]
                    x = here[i, d] + part * (places[i, k + 1, d] - here[i, d])
                    if not ended:
                        x += math.sqrt(D) * apart * numbers[i, row + d, f]
                    if closing:
                        held[i, d] += gap * (here[i, d] + x) / 2
                        held[i, 3 + d] += D * gap**3 / 6
                    now[i, d] = x
            here, now = now, here
            reached = to
            if ended:
                break
            opened = not opened
            if closing:
                width = closes[f] - opens[f]
                for i in range(n):
                    for d in range(3):
                        mean = here[i, d]
                        if width > 0:
                            spread = math.sqrt(held[i, 3 + d]) * numbers[i, 6 + d, f]
                            mean = (held[i, d] + spread) / width
                        means[i, f, d] = mean
                        held[i, d] = held[i, 3 + d] = 0.0
                f += 1
