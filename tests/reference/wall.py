"""A sphere beside a wall by its exact series, with as many digits as asked.

Bispherical coordinates; gaps in radii, resistances over Stokes's:

* away from the wall: H. Brenner, Chem. Eng. Sci. 16, 242 (1961), his eq. 2.19;
* spinning about the normal: G. B. Jeffery, Proc. London Math. Soc. 14, 327 (1915);
* along the wall: M. E. O'Neill, Mathematika 11, 67 (1964); turning: W. R. Dean and M. E. O'Neill,
  Mathematika 10, 13 (1963); forces and moments of both: A. J. Goldman, R. G. Cox and H. Brenner,
  Chem. Eng. Sci. 22, 637 (1967).

Everything is a hyperbolic function with digits to spare, and the equations for A_n are solved as a
banded system by elimination from its end. `python -m tests.reference.wall` makes
tests/data/wall.json in minutes: near the wall the series have thousands of terms.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import NamedTuple

import mpmath as mp

FILE = Path(__file__).parents[1] / "data" / "wall.json"
#: Gaps of the table, radii, none of them an end of a piece of any series
GAPS = (
    *("1e-4", "1.7e-4", "3e-4", "6e-4", "1e-3", "2e-3", "3.3e-3", "0.006", "0.01", "0.013", "0.02"),
    *("0.037", "0.06", "0.1", "0.14", "0.2", "0.33", "0.5", "0.7", "1", "1.4", "2", "3.1", "5"),
    *("7.7", "12", "20", "31", "50", "120", "1000"),
)
#: Digits of its numbers, which are made with 30
SHOWN = 22


class Resistance(NamedTuple):
    """F = -6 pi eta a (Ft U - Fr a W), T = 8 pi eta a^2 (Tt U - Tr a W), W as a ball rolls."""

    away: mp.mpf
    spin: mp.mpf
    Ft: mp.mpf
    Tt: mp.mpf
    Fr: mp.mpf
    Tr: mp.mpf


def resistance(gap, digits=30):
    """All six at a gap in radii."""
    with mp.workdps(digits + 15):
        h = 1 + mp.mpf(gap)
        al = mp.acosh(h)
        last = int(mp.ceil((digits + 8) * mp.log(10) / al)) + 10
        return Resistance(
            _away(al, last), _spin(al, last), *_along(al, last, turning=False),
            *_along(al, last, turning=True),
        )  # fmt: skip


def mobilities(gap, digits=30):
    """Perpendicular, parallel, spin, turn and roll of a free bead, each over that far away."""
    r = resistance(gap, digits)
    with mp.workdps(digits + 15):
        # U and a W of a force 6 pi eta a along the wall, and of a moment 8 pi eta a^2
        U, aW = mp.lu_solve(mp.matrix([[r.Ft, -r.Fr], [-r.Tt, r.Tr]]), mp.matrix([1, 0]))
        _, turned = mp.lu_solve(mp.matrix([[r.Ft, -r.Fr], [-r.Tt, r.Tr]]), mp.matrix([0, 1]))
        return [1 / r.away, U, 1 / r.spin, turned, aW / U]


def with_slopes(gap, digits=30):
    """Mobilities, and their derivatives over the gap by differences of third order."""
    with mp.workdps(digits + 15):
        g = mp.mpf(gap)
        step = g * mp.mpf(10) ** (-digits // 5)
        at = {k: mobilities(g + k * step, digits) for k in (-2, -1, 1, 2)}
        columns = zip(*(at[k] for k in (-2, -1, 1, 2)), strict=True)
        slopes = [(a - 8 * b + 8 * c - d) / (12 * step) for a, b, c, d in columns]
        return mobilities(g, digits), slopes


def _away(al, last):
    whole = mp.mpf(0)
    for n in range(1, last):
        m = 2 * n + 1
        top = 2 * mp.sinh(m * al) + m * mp.sinh(2 * al)
        bottom = (2 * mp.sinh(m * al / 2)) ** 2 - (m * mp.sinh(al)) ** 2
        whole += mp.mpf(n * (n + 1)) / ((m - 2) * (m + 2)) * (top / bottom - 1)
    return mp.mpf(4) / 3 * mp.sinh(al) * whole


def _spin(al, last):
    return mp.fsum((mp.sinh(al) / mp.sinh(n * al)) ** 3 for n in range(1, last))


def _along(al, last, turning):
    """Force and moment of a sphere that shifts by 1, or turns by 1 over its radius."""
    sinh, coth = mp.sinh(al), mp.coth(al)
    half = [(n + mp.mpf(1) / 2) * al for n in range(last + 2)]
    csch, cth = [mp.csch(x) for x in half], [mp.coth(x) for x in half]
    k = [(n + mp.mpf(1) / 2) * cth[n] - coth for n in range(last + 2)]
    away = [mp.exp(-x) for x in half]
    two = mp.sqrt(2)
    L = [
        -(mp.exp(al - half[n]) / (2 * n - 1) - mp.exp(-al - half[n]) / (2 * n + 3)) / two
        for n in range(last)
    ]

    def side(n):
        if not turning:
            return two * (2 * cth[n] - cth[n - 1] - cth[n + 1])
        own = (2 * n + 1) ** 2 * (mp.exp(al) / (2 * n - 1) + mp.exp(-al) / (2 * n + 3)) * csch[n]
        others = (2 * n - 1) * csch[n - 1] + (2 * n + 3) * csch[n + 1]
        return -two * away[n] / ((2 * n + 1) * sinh) * (own - others)

    # A_n = p_n A_(n-1) + q_n, from the last down
    p, q = [mp.mpf(0)] * (last + 1), [mp.mpf(0)] * (last + 1)
    for n in range(last - 1, 0, -1):
        low = (2 * n - 1) * k[n - 1] - (2 * n - 3) * k[n]
        high = (2 * n + 5) * k[n] - (2 * n + 3) * k[n + 1]
        of_before = low * (n - 1) / (2 * n - 1)
        of_own = -(low * n + high * (n + 1)) / (2 * n + 1)
        of_after = high * (n + 2) / (2 * n + 3)
        divisor = of_own + of_after * p[n + 1]
        p[n], q[n] = -of_before / divisor, (side(n) - of_after * q[n + 1]) / divisor
    A = [mp.mpf(0)] * (last + 1)
    for n in range(1, last):
        A[n] = p[n] * A[n - 1] + q[n]

    force = moment = mp.mpf(0)
    for n in range(last - 1):
        before, own, after = (A[n - 1] if n else mp.mpf(0)), A[n], A[n + 1]
        # the two parts of C_n and E_n are over 2n-1 and 2n+3
        lower, upper = before / (2 * n - 1), after / (2 * n + 3)
        B = (n - 1) * before - (2 * n + 1) * own + (n + 2) * after
        C = -2 * k[n] * ((n - 1) * lower - own + (n + 2) * upper)
        D = ((n + 1) * (n + 2) * after - (n - 1) * n * before) / 2
        E = k[n] * (n * (n - 1) * lower - (n + 1) * (n + 2) * upper)
        if turning:
            C += 4 * L[n] * csch[n] / sinh
            E += (two * (2 * n + 1) * away[n] - L[n] / sinh) * csch[n]
        else:
            E += 2 * two * away[n] * csch[n]
        n2, fall, angle = n * (n + 1), away[n] ** 2, 2 * n + 1 - coth
        force += E + n2 * C
        moment += (2 + fall) * (n2 * (2 * own + C * coth) - angle * E)
        moment += (2 - fall) * (n2 * B * coth - angle * D)
    if turning:
        return -two / 6 * sinh**2 * force, (1 - sinh**3 * moment / (4 * two)) / 3
    return two / 6 * sinh * force, sinh**2 * moment / (12 * two)


def main():
    """Write the table."""
    rows = []
    for gap in GAPS:
        values, slopes = with_slopes(gap)
        columns = {"values": values, "slopes": slopes}
        shown = {name: [mp.nstr(x, SHOWN) for x in column] for name, column in columns.items()}
        rows.append({"gap": gap, **shown})
    about = (
        "Mobilities of a sphere beside a plane wall, over those far away, and their derivatives "
        "over the gap in radii: perpendicular, parallel, spin, turn, roll (a W/U)."
    )
    FILE.write_text(json.dumps({"about": about, "rows": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()
