"""Series of the mobilities beside a wall: `python -m derivation.wall_coefficients` makes them.

A sphere of radius a, its surface a gap of g radii from a plane; cosh(al) = 1 + g. Its resistances
are exact series in bispherical coordinates: H. Brenner, Chem. Eng. Sci. 16, 242 (1961), away from
the plane; G. B. Jeffery, Proc. London Math. Soc. 14, 327 (1915), spinning about the normal;
M. E. O'Neill, Mathematika 11, 67 (1964), and W. R. Dean and M. E. O'Neill, Mathematika 10, 13
(1963), along the plane and turning. With W in the sense in which a ball rolls,

    F = -6 pi eta a (F_t U - F_r a W),    T = 8 pi eta a^2 (T_t U - T_r a W).

They are summed here with 42 digits, of which cancellation takes ten at a gap of 1e-5. The smooth
factors of the mobilities (`derivation.wall`) become Chebyshev series over w = ln(1 + 2/g) on
pieces of one length. In g the series have singularities on [-2, 0] alone, which is |Im w| = pi.

Then the plane whose squared radius is the gap: r(g) = int_0^g dg/sqrt(2 mu), over ln of a
function near to g.

What this makes takes minutes and is data: `wall_coefficients.json` is committed, and emitted in
`generated/wall.py`.
"""

from __future__ import annotations

import bisect
import itertools
import json
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, NamedTuple

import mpmath
from mpmath import mp, mpf

#: the committed coefficients
DATA = Path(__file__).with_suffix(".json")
#: Digits of what is summed
DIGITS = 42
#: Series are summed until their terms have fallen by exp(-DECAY)
DECAY = 85
#: Gap, radii, down to which the series are used
CONTACT = mpf(1) / 100000
#: Pieces of w, and of the plane's variable
PIECES = 24
#: Coefficients of a series
MADE = 13
#: Gap, radii, up to which the plane has pieces
FAR = 500
#: Intervals of ln g for r(g)
INTERVALS = 40

#: by piece, function and degree
Series = list[list[list[float]]]


class Mobilities(NamedTuple):
    """Of a bead that nothing but one force or one moment acts on, over those far away."""

    perpendicular: Any
    parallel: Any
    spin: Any
    turn: Any
    roll: Any
    """a W/U of a bead pulled along the wall"""


class Resistances(NamedTuple):
    """Of motion along the wall and of turning, as above; and of the other two."""

    perpendicular: Any
    spin: Any
    force_by_velocity: Any
    moment_by_velocity: Any
    force_by_turning: Any
    moment_by_turning: Any

    def mobilities(self) -> Mobilities:
        """Their inverse."""
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


def _piece_of_mobilities(piece: int) -> list[list[float]]:
    mp.dps = DIGITS
    length = range_of_w() / PIECES
    places = _at_nodes(piece * length, (piece + 1) * length)
    columns = zip(*(factors(2 / mpmath.expm1(w)) for w in places), strict=True)
    return [_series(list(column)) for column in columns]


# --- the plane -----------------------------------------------------------------------------------
class _Plane:
    """r(g) = int_0^g dg/sqrt(2 mu) and its inverse, by the series made."""

    def __init__(self, series: Series) -> None:
        self.pieces = [[[mpf(c) for c in each] for each in piece[:2]] for piece in series]
        self.range = range_of_w()
        #: Gauss's rule, 24 nodes
        self.rule = mpmath.calculus.quadrature.GaussLegendre(mp).calc_nodes(4, mp.prec)
        #: ln g and r at the ends of intervals
        self.ends = mpmath.linspace(mpmath.log(CONTACT), mpmath.log(FAR), INTERVALS + 1)
        self.r = [_way_from_contact()]
        for low, high in itertools.pairwise(self.ends):
            self.r.append(self.r[-1] + self._way(low, high))

    def mobilities(self, g: Any) -> tuple[Any, Any, Any]:
        """Perpendicular, its derivative over g, and parallel."""
        place = mpmath.log1p(2 / g) / self.range * PIECES
        piece = min(int(place), PIECES - 1)
        (A, slope), (B, _) = (
            _clenshaw(each, 2 * (place - piece) - 1) for each in self.pieces[piece]
        )
        s = 1 / (1 + g)
        A_g = -slope * 4 * PIECES / self.range * s**2 / (1 - s**2)
        slope_of_value = s**2 * (1 + s * A) + (1 - s) * (s * A_g - s**2 * A)
        return (1 - s) * (1 + s * A), slope_of_value, 1 - s * B

    def _way(self, low: Any, high: Any) -> Any:
        """What r grows by between two values of ln g."""
        half, whole = (high - low) / 2, mpf(0)
        for x, weight in self.rule:
            g = mpmath.exp((low + high) / 2 + half * x)
            whole += weight * g / mpmath.sqrt(2 * self.mobilities(g)[0])
        return whole * half

    def gap(self, r: Any) -> Any:
        """g of r, by Newton's method."""
        at = max(bisect.bisect_right(self.r, r) - 1, 0)
        g = mpmath.exp(self.ends[at])
        for _ in range(60):
            slope = mpmath.sqrt(2 * self.mobilities(g)[0])
            step = (r - self.r[at] - self._way(self.ends[at], mpmath.log(g))) * slope
            g += step
            if abs(step) < mpf(10) ** -25 * g:
                return g
        raise ArithmeticError(f"no gap for r = {r}")

    def factors(self, r: Any) -> list[Any]:
        """The smooth factors, as in `derivation.wall.PLANE`."""
        g = self.gap(r)
        value, slope, parallel = self.mobilities(g)
        root = mpmath.sqrt(2 * value)
        return [
            g * (2 + r * mpmath.sqrt(2)) / r**2,
            root / r * (1 + r / mpmath.sqrt(2)),
            (slope / root - 1 / r) / (2 * r) * (1 + r**2),
            parallel,
        ]


def _clenshaw(series: list[Any], x: Any) -> tuple[Any, Any]:
    """A Chebyshev series and its derivative."""
    value, slope = series[0] + series[1] * x, series[1]
    T, U = (mpf(1), x), (mpf(1), 2 * x)
    for k, coefficient in enumerate(series[2:], 2):
        slope += coefficient * k * U[1]
        T, U = (T[1], 2 * x * T[1] - T[0]), (U[1], 2 * x * U[1] - U[0])
        value += coefficient * T[1]
    return value, slope


def _way_from_contact() -> Any:
    """r at CONTACT: by lubrication, 1/mu = 1/g + ln(1/g)/5 + c, with c of the series there."""
    c = resistances(CONTACT).perpendicular - 1 / CONTACT + mpmath.log(CONTACT) / 5
    edges = [0, mpmath.sqrt(CONTACT) / 100, mpmath.sqrt(CONTACT)]
    return mpmath.quad(lambda x: mpmath.sqrt(2 * (1 + x**2 * (c - 2 * mpmath.log(x) / 5))), edges)


def variable(r: Any) -> Any:
    """The variable of the plane's series: ln of `derivation.wall.NEAR`."""
    return mpmath.log(r**2 / (2 + r * mpmath.sqrt(2)))


def _place(y: Any) -> Any:
    """r of that variable."""
    half = mpmath.exp(y) / mpmath.sqrt(2)
    return half + mpmath.sqrt(half**2 + 2 * mpmath.exp(y))


# --- the file ------------------------------------------------------------------------------------
@dataclass(frozen=True)
class Coefficients:
    """What is emitted."""

    mobilities: Series
    """by piece of w, factor and degree"""
    plane: Series
    """by piece of the plane's variable, factor and degree"""
    touching: float
    """r at CONTACT"""
    far: float
    """r at the gap FAR"""


def make() -> Coefficients:
    """All of it, on all processors."""
    mp.dps = DIGITS
    with ProcessPoolExecutor() as pool:
        mobilities = list(pool.map(_piece_of_mobilities, reversed(range(PIECES))))[::-1]
    return with_plane(mobilities)


def with_plane(mobilities: Series) -> Coefficients:
    """The plane of these mobilities."""
    plane = _Plane(mobilities)
    low, high = variable(plane.r[0]), variable(plane.r[-1])
    pieces = []
    for piece in range(PIECES):
        ends = (low + (high - low) * each / PIECES for each in (piece, piece + 1))
        columns = zip(*(plane.factors(_place(y)) for y in _at_nodes(*ends)), strict=True)
        pieces.append([_series(list(column)) for column in columns])
    return Coefficients(mobilities, pieces, float(plane.r[0]), float(plane.r[-1]))


def load() -> Coefficients:
    """The committed coefficients."""
    return Coefficients(**json.loads(DATA.read_text()))


def main() -> None:
    """Make them again and write the file."""
    DATA.write_text(json.dumps(asdict(make()), indent=1) + "\n")


if __name__ == "__main__":
    main()
