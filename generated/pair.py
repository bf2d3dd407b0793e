"""Two spheres: mobilities by series over their gap, and those of Rotne, Prager and Yamakawa.

Made by `python -m derivation` from derivation/pair.py; do not edit.
SymPy 1.14.0.

Mobilities are over 1/(6 pi mu) and powers of length.
"""

import math

from numba import njit

#: terms of a series, and number of mobilities
TERMS, MOBILITIES = 14, 18


@njit(cache=True)
def place(gap, total):
    """Place of a gap in the series, and its derivative over the gap.

    gap: between the surfaces
    total: sum of the radii, in the same unit
    Returns w and dw/dgap, with w = ln(1 + 2 total/gap).
    """
    return math.log1p(2.0 * total / gap), -2.0 * total / (gap * (gap + 2.0 * total))


@njit(cache=True)
def vanishing(gap, total):
    """Factor of the relative mobility along the line that vanishes with the gap, and its slope."""
    return 1.0 / (1.0 + total / gap), total / ((gap + total) * (gap + total))


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def mobilities(powers, total, lowest, per_w, gap, value, slope):
    """Mobilities of two spheres, and their derivatives over the gap.

    powers: (pieces, terms, mobilities) series over pieces of w, with the highest power first; the
        last but one is the relative mobility along the line, over `vanishing`
    total: sum of the radii
    lowest: smallest gap of the series; below it that mobility is proportional to the gap, and the
        others stay
    per_w: pieces in a unit of w
    gap: between the surfaces
    value, slope: (mobilities,) filled with the result.
    """
    at = gap if gap > lowest else lowest
    w, change = place(at, total)
    piece = min(int(w * per_w), len(powers) - 1)
    x = 2.0 * (w * per_w - piece) - 1.0
    change *= 2.0 * per_w
    for j in range(MOBILITIES):
        own, rising = powers[piece, 0, j], 0.0
        for k in range(1, TERMS):
            rising = rising * x + own
            own = own * x + powers[piece, k, j]
        value[j], slope[j] = own, change * rising
    along = MOBILITIES - 2
    factor, rising = vanishing(at, total)
    slope[along] = factor * slope[along] + rising * value[along]
    value[along] *= factor
    if not gap > lowest:
        for j in range(MOBILITIES):
            slope[j] = 0.0
        slope[along] = value[along] / lowest
        value[along] = 0.0 if gap < 0.0 else gap * slope[along]


@njit(cache=True)
def rotne_prager(a_1, a_2, r):
    """Mobility of a sphere by a force on another one, by Rotne, Prager and Yamakawa.

    a_1, a_2: radii
    r: distance of the centres; spheres that overlap have the mobility that stays positive
    Returns the mobilities along and across the line of centres.
    """
    if r > a_1 + a_2:
        return (1.0 / 2.0) * (-(a_1 * a_1) - (a_2 * a_2) + 3.0 * (r * r)) / (r * r * r), (
            1.0 / 4.0
        ) * ((a_1 * a_1) + (a_2 * a_2) + 3.0 * (r * r)) / (r * r * r)
    if r > abs(a_1 - a_2):
        return (3.0 / 32.0) * (
            (-(r * r) + ((a_1 - a_2) * (a_1 - a_2))) * (-(r * r) + ((a_1 - a_2) * (a_1 - a_2)))
        ) / (a_1 * a_2 * (r * r * r)) + (1.0 / 32.0) * (
            16.0 * (r * r * r) * (a_1 + a_2)
            - (
                (3.0 * (r * r) + ((a_1 - a_2) * (a_1 - a_2)))
                * (3.0 * (r * r) + ((a_1 - a_2) * (a_1 - a_2)))
            )
        ) / (a_1 * a_2 * (r * r * r)), (1.0 / 32.0) * (
            16.0 * (r * r * r) * (a_1 + a_2)
            - (
                (3.0 * (r * r) + ((a_1 - a_2) * (a_1 - a_2)))
                * (3.0 * (r * r) + ((a_1 - a_2) * (a_1 - a_2)))
            )
        ) / (a_1 * a_2 * (r * r * r))
    largest = max(a_1, a_2)
    return 1.0 / largest, 1.0 / largest


@njit(cache=True)
def rotne_prager_turning(r):
    """Rotation of a sphere that is apart from another one, on which force and torque act.

    r: distance of the centres
    Returns tr, rrx and rry: by a force across the line, by a torque along it and across it.
    """
    return (3.0 / 4.0) / (r * r), (3.0 / 4.0) / (r * r * r), -(3.0 / 8.0) / (r * r * r)
