"""Series of the mobilities beside a wall, which `python -m derivation.wall_coefficients` computes.

The surface of a sphere of radius a is g radii from a plane, and cosh(al) = 1 + g. Its resistances
are exact series in bispherical coordinates. The series away from the plane is by H. Brenner (Chem.
Eng. Sci. 16, 242 (1961)). Spinning about the normal is by G. B. Jeffery (Proc. London Math. Soc.
14, 327 (1915)). Motion along the plane and turning are by M. E. O'Neill (Mathematika 11, 67
(1964)) and by W. R. Dean and M. E. O'Neill (Mathematika 10, 13 (1963)). With W in the sense in
which a ball rolls,

    F = -6 pi eta a (F_t U - F_r a W),    T = 8 pi eta a^2 (T_t U - T_r a W).

They are summed here with 42 digits, of which ten cancel at a gap of 1e-5. The smooth factors of the
mobilities (`derivation.wall`) become Chebyshev series over w = ln(1 + 2/g) on pieces of equal
length. In g the series are singular only on [-2, 0], which is |Im w| = pi.

The last part is the plane whose squared radius is the gap: r(g) = int_0^g dg/sqrt(2 mu), over ln of
a function close to g.

The computation takes minutes, so its result is data: `wall_coefficients.json` is committed, and
emitted in `generated/wall.py`.
"""

from __future__ import annotations

import json
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any, NamedTuple

import mpmath
from mpmath import mp, mpf

#: the committed coefficients
DATA = Path(__file__).with_suffix(".json")
#: Digits of the sums
DIGITS = 42
#: Series are summed until their terms have fallen by exp(-DECAY)
DECAY = 85
#: Gap, radii, down to which the series are used
CONTACT = mpf(1) / 100000
#: Pieces of w
PIECES = 24
#: Coefficients of a series
MADE = 13

#: by piece, factor and degree
Series = list[list[list[float]]]


class Mobilities(NamedTuple):
    """Mobilities of a bead under a single force or moment, over those far away."""

    perpendicular: Any
    parallel: Any
    spin: Any
    turn: Any
    roll: Any
    """a W/U of a bead pulled along the wall"""


class Resistances(NamedTuple):
    """Resistances to motion across the wall, spinning, motion along the wall and turning."""

    perpendicular: Any
    spin: Any
    force_by_velocity: Any
    moment_by_velocity: Any
    force_by_turning: Any
    moment_by_turning: Any

    def mobilities(self) -> Mobilities:
        """Return the mobilities, the inverse of these resistances."""
        F_t, T_t, F_r, T_r = self[2:]
        determinant = F_t * T_r - F_r * T_t
        return Mobilities(
            1 / self.perpendicular, T_r / determinant, 1 / self.spin, F_t / determinant, T_t / T_r
        )


class _Bispherical:
    """Functions of n + 1/2 that all series share, up to n = terms + 2."""

    def __init__(self, gap: Any) -> None:
        g = mpf(gap)
        self.al = mpmath.log1p(g + mpmath.sqrt(g * (2 + g)))
        self.terms = int(DECAY / self.al) + 12
        self.e = mpmath.exp(self.al)
        self.sinh, self.coth = mpmath.sinh(self.al), mpmath.coth(self.al)
        #: e^(-(n+1/2) al), coth and 1/sinh of (n+1/2) al, and k_n
        self.decay = [mpmath.exp(-self.al / 2)]
        for _ in range(self.terms + 2):
            self.decay.append(self.decay[-1] / self.e)
        squared = [each * each for each in self.decay]
        self.coths = [(1 + q) / (1 - q) for q in squared]
        self.cschs = [2 * each / (1 - q) for each, q in zip(self.decay, squared, strict=True)]
        self.k = [(n + mpf(1) / 2) * each - self.coth for n, each in enumerate(self.coths)]


def resistances(gap: Any) -> Resistances:
    """The exact series at a gap in radii."""
    b = _Bispherical(gap)
    lower, diagonal, upper = _matrix(b)
    sides = _translation(b), _turning(b)
    for n in range(2, b.terms + 1):
        factor = lower[n] / diagonal[n - 1]
        diagonal[n] -= factor * upper[n - 1]
        for side in sides:
            side[n] -= factor * side[n - 1]
    sums = []
    for turning, side in enumerate(sides):
        A = [mpf(0)] * (b.terms + 2)
        for n in range(b.terms, 0, -1):
            A[n] = (side[n] - upper[n] * A[n + 1]) / diagonal[n]
        sums.append(_sums(b, A, bool(turning)))
    (S_t, T_t), (S_r, T_r) = sums
    root = mpmath.sqrt(2)
    return Resistances(
        _perpendicular(b),
        _spin(b),
        root / 6 * b.sinh * S_t,
        b.sinh**2 * T_t / (12 * root),
        -root / 6 * b.sinh**2 * S_r,
        (1 - b.sinh**3 * T_r / (4 * root)) / 3,
    )


def _perpendicular(b: _Bispherical) -> Any:
    whole, sinh_twice = mpf(0), mpmath.sinh(2 * b.al)
    for n in range(1, b.terms):
        square = 1 / b.cschs[n] ** 2
        above = 4 * square * b.coths[n] + (2 * n + 1) * sinh_twice
        below = 4 * square - ((2 * n + 1) * b.sinh) ** 2
        whole += mpf(n * (n + 1)) / ((2 * n - 1) * (2 * n + 3)) * (above / below - 1)
    return mpf(4) / 3 * b.sinh * whole


def _spin(b: _Bispherical) -> Any:
    whole, decay = mpf(0), mpf(1)
    for _ in range(1, b.terms):
        decay /= b.e
        whole += (2 * decay * b.sinh / (1 - decay * decay)) ** 3
    return whole


def _matrix(b: _Bispherical) -> tuple[list[Any], list[Any], list[Any]]:
    lower, diagonal, upper = ([mpf(0)] * (b.terms + 1) for _ in range(3))
    for n in range(1, b.terms + 1):
        before = (2 * n - 1) * b.k[n - 1] - (2 * n - 3) * b.k[n]
        after = (2 * n + 5) * b.k[n] - (2 * n + 3) * b.k[n + 1]
        lower[n] = before * (n - 1) / (2 * n - 1)
        diagonal[n] = -(before * n + after * (n + 1)) / (2 * n + 1)
        upper[n] = after * (n + 2) / (2 * n + 3)
    return lower, diagonal, upper


def _translation(b: _Bispherical) -> list[Any]:
    root, c = mpmath.sqrt(2), b.coths
    sides = [root * (2 * c[n] - c[n - 1] - c[n + 1]) for n in range(1, b.terms + 1)]
    return [mpf(0), *sides]


def _turning(b: _Bispherical) -> list[Any]:
    sides = [mpf(0)]
    for n in range(1, b.terms + 1):
        own = (2 * n + 1) ** 2 * (b.e / (2 * n - 1) + 1 / b.e / (2 * n + 3)) * b.cschs[n]
        others = (2 * n - 1) * b.cschs[n - 1] + (2 * n + 3) * b.cschs[n + 1]
        sides.append(-mpmath.sqrt(2) * b.decay[n] / ((2 * n + 1) * b.sinh) * (own - others))
    return sides


def _sums(b: _Bispherical, A: list[Any], turning: bool) -> tuple[Any, Any]:
    """S and T of the coefficients A_n: the force and the moment."""
    root, S, T = mpmath.sqrt(2), mpf(0), mpf(0)
    for n in range(b.terms):
        before, own, after = A[n - 1] if n else mpf(0), A[n], A[n + 1]
        B = (n - 1) * before - (2 * n + 1) * own + (n + 2) * after
        D = (-(n - 1) * n * before + (n + 1) * (n + 2) * after) / 2
        C = -2 * b.k[n] * ((n - 1) * before / (2 * n - 1) - own + (n + 2) * after / (2 * n + 3))
        E = b.k[n] * (n * (n - 1) * before / (2 * n - 1) - (n + 1) * (n + 2) * after / (2 * n + 3))
        if turning:
            L = -b.decay[n] * (b.e / (2 * n - 1) - 1 / b.e / (2 * n + 3)) / root
            C += 4 * L / b.sinh * b.cschs[n]
            E += (root * (2 * n + 1) * b.decay[n] - L / b.sinh) * b.cschs[n]
        else:
            E += 2 * root * b.decay[n] * b.cschs[n]
        q, angular = b.decay[n] ** 2, 2 * n + 1 - b.coth
        S += E + n * (n + 1) * C
        T += (2 + q) * (n * (n + 1) * (2 * own + C * b.coth) - angular * E)
        T += (2 - q) * (n * (n + 1) * B * b.coth - angular * D)
    return S, T


# --- the smooth factors --------------------------------------------------------------------------
def spin_at_contact() -> Any:
    """1 - 1/zeta(3): how much less a touching bead spins (Jeffery's series at al = 0)."""
    return 1 - 1 / mpmath.zeta(3)


def factors(gap: Any) -> list[Any]:
    """The smooth factors of the five mobilities, as in `derivation.wall.MOBILITIES`."""
    m = resistances(gap).mobilities()
    s = 1 / (1 + mpf(gap))
    return [
        (m.perpendicular / (1 - s) - 1) / s,
        (1 - m.parallel) / s,
        ((1 - m.spin) / s**3 - spin_at_contact()) / (1 - s),
        (1 - m.turn) / s**3,
        m.roll / s**4,
    ]


def _at_nodes(low: Any, high: Any) -> list[Any]:
    """Chebyshev's nodes on an interval."""
    cosines = [mpmath.cospi((j + mpf(1) / 2) / MADE) for j in range(MADE)]
    return [(low + high) / 2 + (high - low) / 2 * each for each in cosines]


def _series(values: list[Any]) -> list[float]:
    """Coefficients of Chebyshev's series, of which the first counts whole, by values at nodes."""
    coefficients = []
    for k in range(MADE):
        waves = (mpmath.cospi(k * (j + mpf(1) / 2) / MADE) for j in range(MADE))
        whole = mpmath.fsum(value * wave for value, wave in zip(values, waves, strict=True))
        coefficients.append(float((1 if k == 0 else 2) * whole / MADE))
    return coefficients


def range_of_w() -> Any:
    """Largest w: that of contact."""
    return mpmath.log1p(2 / CONTACT)


def piece_of(piece: int) -> list[list[float]]:
    """The series of a piece."""
    mp.dps = DIGITS
    length = range_of_w() / PIECES
    places = _at_nodes(piece * length, (piece + 1) * length)
    columns = zip(*(factors(2 / mpmath.expm1(w)) for w in places), strict=True)
    return [_series(list(column)) for column in columns]


# --- the file ------------------------------------------------------------------------------------
def make() -> Series:
    """All pieces, on all processors."""
    mp.dps = DIGITS
    with ProcessPoolExecutor() as pool:
        return list(pool.map(piece_of, reversed(range(PIECES))))[::-1]


def load() -> Series:
    """The committed series."""
    read: Series = json.loads(DATA.read_text())
    return read


def main() -> None:
    """Make them again and write the file."""
    DATA.write_text(json.dumps(make(), indent=1) + "\n")


if __name__ == "__main__":
    main()
