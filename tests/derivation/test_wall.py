"""Beside a wall: the plane of the gap proven, the series against what is known of them."""

import itertools
import math

import mpmath as mp
import pytest
import sympy as sp

from derivation import langevin, wall
from derivation import wall_coefficients as wc
from derivation.equations import is_zero

#: digits that the series are summed with here
DIGITS = 30


# --- the plane -----------------------------------------------------------------------------------
def test_the_plane_gives_the_motion_of_the_gap():
    """Ito: the drift mu F + mu' and the squared noise 2 mu, whatever mu is."""
    drift, noise = (wall.on_circle(each) for each in wall.by_ito(wall.g))
    mu = wall.root**2 / 2
    assert is_zero(drift - (mu * wall.F + wall.mu_g))
    assert is_zero(noise - 2 * mu)
    assert is_zero(wall.DRIFT_OF_GAP - drift)


def test_the_same_by_cartesian_derivatives():
    """Of one mobility, given by g(r) = r^2/2 + c r^4: by nothing of the module but the drift."""
    c, F = sp.symbols("c F", positive=True)
    x, y, r = *wall.PLACE, wall.r
    g = r**2 / 2 + c * r**4
    known = {wall.root: g.diff(r), wall.mu_g: g.diff(r, 2), wall.F: F}
    drift = [each.subs(known).subs(r, sp.sqrt(x**2 + y**2)) for each in wall.DRIFT]
    gap = g.subs(r, sp.sqrt(x**2 + y**2))
    gained = sum(gap.diff(w) * b + gap.diff(w, 2) / 2 for w, b in zip((x, y), drift, strict=True))
    # mu of that gap, and its derivative over the gap
    mu = g.diff(r) ** 2 / 2
    known = (mu * F + mu.diff(r) / g.diff(r)).subs(r, sp.sqrt(x**2 + y**2))
    assert sp.simplify(gained - known) == 0
    noise = gap.diff(x) ** 2 + gap.diff(y) ** 2
    assert sp.simplify(noise - 2 * mu.subs(r, sp.sqrt(x**2 + y**2))) == 0


def test_boltzmanns_density_has_no_flux():
    """In the plane, of e^(-U/kT) R/r; and what of it is between two gaps is e^(-U/kT) dg."""
    phi = sp.Function("phi")(wall.g)
    density = sp.exp(phi) * wall.root / wall.r
    for along, drift in zip(wall.PLACE, wall.DRIFT, strict=True):
        slope = wall.over_place(density, along).subs(phi.diff(wall.g), wall.F) / density
        assert is_zero(slope - 2 * drift)
        assert is_zero(slope - along / wall.r * wall.BOLTZMANN)
    # the ring between r and r + dr
    assert is_zero(density * 2 * sp.pi * wall.r - 2 * sp.pi * sp.exp(phi) * wall.root)


def test_what_moves_the_plane_far_from_it_has_another_drift():
    """The proof can fail: without the second component of the noise the drift is not mu'."""
    one = wall.over_place(wall.g, wall.PLACE[0])
    short = (
        sum(
            wall.over_place(wall.g, along) * own
            for along, own in zip(wall.PLACE, wall.DRIFT, strict=True)
        )
        + wall.over_place(one, wall.PLACE[0]) / 2
    )
    assert not is_zero(wall.on_circle(short) - (wall.root**2 / 2 * wall.F + wall.mu_g))


# --- with inertia --------------------------------------------------------------------------------
def test_a_mobility_that_changes():
    """First order in mu' of the means of x and v: their equations hold, and they begin at 0."""
    x, v, tau = wall.CHANGE_OF_PLACE, wall.CHANGE_OF_VELOCITY, wall.tau
    assert is_zero(wall.over_time(v) - (wall.CORRELATION - v) / tau)
    assert is_zero(wall.over_time(x) - v)
    assert all(is_zero(change.subs({wall.h: 0, wall.E: 1})) for change in (x, v))
    # without inertia all of the drift, in the place
    assert is_zero(v.subs(wall.E, 0) - 1)
    assert sp.limit(x.subs(wall.E, 0) / wall.h, tau, 0) == 1


def test_what_drives_it():
    """-v/(m mu(x)) to first order in x - x_0, and <(x - x_0) v> = kT mu (1 - E)."""
    m, mu, slope, away, v, kT = sp.symbols("m mu slope away v kT", positive=True)
    first = (-v / (m * (mu + slope * away))).diff(away).subs(away, 0)
    tau = m * mu
    # over kT mu', with <(x - x_0) v> for away v
    driven = (first * away).subs(v, kT * mu * wall.CORRELATION / away) / (kT * slope)
    assert is_zero(driven - wall.CORRELATION / tau)
    # 2 kT mu (h - tau (1 - E)) is the mean squared displacement of Langevin
    moved = 2 * (wall.h - wall.tau * (1 - wall.E))
    assert is_zero(wall.over_time(moved) / 2 - wall.CORRELATION)


def test_noise_of_the_place():
    """Its variance, as `derivation.langevin` has it, is that of h' without inertia."""
    d = langevin.CLOSED[langevin.d].subs({langevin.slow: 0, langevin.E_slow: 1})
    known = d.subs({langevin.fast: 1 / wall.tau, langevin.E_fast: wall.E})
    # c_xx' = 2 d^2/tau, over kT/m = kT mu/tau
    assert is_zero(2 * wall.over_time(wall.SPREADING) - 2 * known**2 / wall.tau**2)
    assert is_zero(wall.SPREADING.subs({wall.h: 0, wall.E: 1}))


# --- derivatives of the mobilities ---------------------------------------------------------------
@pytest.mark.parametrize("name", wall.MOBILITIES)
def test_slopes(name):
    """By SymPy's own chain rule, with s, rest and the factors as functions of the gap."""
    g = wall.g
    functions = [sp.Function(str(factor))(g) for factor in wall.FACTORS]
    known = {wall.s: 1 / (1 + g), wall.rest: g / (1 + g)}
    known |= dict(zip(wall.FACTORS, functions, strict=True))
    rates = {rate: f.diff(g) for rate, f in zip(wall.RATES, functions, strict=True)}
    expected = wall.MOBILITIES[name].subs(known).diff(g)
    assert sp.simplify(wall.SLOPES[name].subs(known).subs(rates) - expected) == 0
    w = sp.log(1 + 2 / g)
    assert sp.simplify(wall.CHANGE_OF_W.subs(known) - w.diff(g)) == 0


# --- the series ----------------------------------------------------------------------------------
@pytest.fixture(scope="module")
def by_gap():
    """Resistances at some gaps."""
    with mp.workdps(DIGITS):
        return {g: wc.resistances(mp.mpf(g)) for g in ("0.003", "0.01", "0.2", "1.5", "300", "600")}


def test_reciprocity(by_gap):
    """Lorentz: the force by turning is the moment by moving, F_r = (4/3) T_t; O'Neill, Dean."""
    with mp.workdps(DIGITS):
        for each in by_gap.values():
            assert abs(each.force_by_turning / each.moment_by_velocity * 3 / 4 - 1) < 1e-15


def test_far_series(by_gap):
    """Faxen's and Lorentz's; what is left goes with the power that they leave out."""
    half = mp.mpf(1) / 2
    series = {
        "perpendicular": (
            lambda m: 1 / m.perpendicular,
            {0: 1, 1: -9 * half / 4, 3: half, 4: -mp.mpf(135) / 256, 5: -half / 4},
        ),
        "parallel": (
            lambda m: 1 / m.force_by_velocity,
            {0: 1, 1: -9 * half / 8, 3: half / 4, 4: -mp.mpf(45) / 256, 5: -half / 8},
        ),
        "spin": (lambda m: 1 / m.spin, {0: 1, 3: -half / 4}),
        "turn": (lambda m: m.mobilities().turn, {0: 1, 3: -5 * half / 8}),
        "roll": (lambda m: m.mobilities().roll, {4: 3 * half / 16, 5: -9 * half / 128}),
    }
    with mp.workdps(DIGITS):
        for name, (value, terms) in series.items():
            left = []
            for g in (300, 600):
                s = 1 / mp.mpf(1 + g)
                power = max(terms) + 1
                rest = value(by_gap[str(g)]) - mp.fsum(c * s**n for n, c in terms.items())
                left.append(abs(rest) / s**power)
            # bounded: the next coefficient, or less
            assert max(left) < 1.5, name


def test_lubrication(by_gap):
    """Terms up to g ln(1/g), as recalled, of D. J. Jeffrey and Y. Onishi (1984).

    Constants of M. Chaoui and F. Feuillebois (2003), near those of 1967: 0.9588, -0.1895.
    """
    with mp.workdps(DIGITS):
        for g in map(mp.mpf, ("0.003", "0.01")):
            found, ln = by_gap[mp.nstr(g, 3)], mp.log(1 / g)
            for value, series in (
                (
                    found.force_by_velocity,
                    mp.mpf(8) / 15 * ln + 0.95429 + mp.mpf(64) / 375 * g * ln,
                ),
                (found.moment_by_turning, mp.mpf(2) / 5 * ln + 0.37089 + mp.mpf(66) / 125 * g * ln),
                (found.moment_by_velocity, ln / 10 - 0.19295 + mp.mpf(43) / 250 * g * ln),
                (found.perpendicular, 1 / g + ln / 5 + 0.97128 + g * ln / 21),
            ):
                # what is left goes with g, and the constants are rounded
                assert abs(value - series) < 0.6 * g + 1e-5


# --- the committed coefficients ------------------------------------------------------------------
def test_a_piece_is_made_again():
    """The cheapest two: their values at the nodes give the committed numbers."""
    kept, digits = wc.load(), mp.mp.dps
    try:
        for piece in (0, 3):
            for made, committed in zip(wc.piece_of(piece), kept[piece], strict=True):
                assert made == pytest.approx(committed, rel=1e-12, abs=1e-20)
    finally:
        mp.mp.dps = digits


def test_what_is_left_out():
    """The degrees that are not emitted, the last counted twice for those beyond: the bound.

    Of values, and of derivatives over x, of which T_k has k^2.
    """
    for piece in wc.load():
        for series in piece:
            left = [abs(c) for c in series[wall.TERMS :]]
            left.append(left[-1])
            assert sum(left) < 3e-12
            assert sum(c * k**2 for k, c in enumerate(left, wall.TERMS)) < 3e-10


def test_pieces_meet():
    """Series of neighbours agree where one ends: an error of one of them would show."""
    for left, right in itertools.pairwise(wc.load()):
        for a, b in zip(left, right, strict=True):
            begin = math.fsum(c * (-1) ** k for k, c in enumerate(b))
            assert abs(math.fsum(a) - begin) < 1e-13 * max(abs(begin), 1)
