"""Two coupled beads: tables of the plane, distributions and correlations.

Seeds are fixed; a right program would exceed a stochastic bound for one seed in a hundred thousand.
"""

import itertools
import math

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.linalg import expm

from tests.beads.springs import KT, UNIT, dark, in_traps, pair
from tests.reference.pressed_beads import deviations
from tweezer.beads import two
from tweezer.beads.plane import OTHER, B, S, T, read
from tweezer.compiled import cached_njit
from tweezer.fluid.pair import NAMES, exact

FAR = 4.5
A = 0.5e-6


def followed(acting, plane, step, steps, x, seed=1, first=0):
    """Advance copies x (copies, 2, 3) in place by a number of steps."""
    out = np.empty((len(x), 1, 2, 3))
    two.advance(acting, plane, seed, step, np.arange(len(x)), first, steps, x, out)
    np.testing.assert_array_equal(out[:, 0], x)


@cached_njit()
def _read(table, first, per, argument, found):  # type: ignore[no-untyped-def]
    """Call `read` from Python."""
    read(table, first, per, argument, found)


def at_gap(plane, gap):
    found = np.empty(10)
    _read(plane.by_gap, plane.ends[0], plane.ends[1], math.log(gap), found)
    return found


@pytest.mark.parametrize("radii", [(A, A), (A, 0.4 * A)])
def test_tables_are_integrals_of_the_exact_mobility(radii):
    """R, S and T by quadrature of the exact mobility, and the gap back from R."""
    _, plane = pair(radii)

    def mobility(gap):
        return UNIT * exact(*radii, gap)[0][NAMES.index("relative_x")]

    ends = np.geomspace(0.01, 2.0, 6) * A
    for low, high in itertools.pairwise(ends):
        length, _ = quad(
            lambda u: math.exp(u) / math.sqrt(2 * KT * mobility(math.exp(u))),
            math.log(low), math.log(high), epsrel=1e-9,
        )  # fmt: skip
        found = math.exp(at_gap(plane, high)[OTHER]) - math.exp(at_gap(plane, low)[OTHER])
        assert found == pytest.approx(length, rel=1e-7)
        at = at_gap(plane, high)
        R = math.exp(at[OTHER])
        assert at[S] == pytest.approx(math.sqrt(mobility(high) / (2 * KT)) / R, rel=1e-7)
        slope = (mobility(high * 1.001) - mobility(high / 1.001)) / (high * (1.001 - 1 / 1.001))
        drift = 0.5 * KT * slope / math.sqrt(2 * KT * mobility(high)) - 0.5 / R
        assert at[T] == pytest.approx(drift / R, rel=1e-4, abs=1e-5 / R**2)
        back = np.empty(10)
        _read(plane.by_length, plane.ends[2], plane.ends[3], at[OTHER], back)
        assert math.exp(back[OTHER]) == pytest.approx(high, rel=1e-9)
        np.testing.assert_allclose(back[1:], at[1:], rtol=1e-5, atol=1e-14)


def test_gap_of_beads_that_are_pulled_together():
    """The density rho^2 e^(-f rho/kT), steps of 0.2 T: mean gap and time near contact."""
    found, error = deviations(4000, 40, 25)
    assert (np.abs(found - 1) < FAR * error).all()
    assert (FAR * error < 0.05).all()


@pytest.mark.parametrize("second", [1.0, 0.4])
def test_pressed_together_in_two_traps(second):
    """All moments of Boltzmann's distribution, which rejection samples, of unequal beads too."""
    radii, L = (A, second * A), (0.9 + second) * A
    k = np.array([20.0, 30.0]) * KT / A**2
    _, plane = pair(radii)
    acting = in_traps(radii, [(0, 0, 0), (L, 0, 0)], k)
    step = 0.05 * A / (UNIT * k[0])
    x = np.zeros((3000, 2, 3))
    x[:, 1, 0] = sum(radii) + 0.05 * A
    followed(acting, plane, step, 200, x)
    found = []
    for n in range(24):
        followed(acting, plane, step, 30, x, first=200 + 30 * n)
        found.append(moments(x, L, radii).mean(axis=0))
    rng = np.random.default_rng(5)
    y = rng.normal(size=(600_000, 2, 3)) * np.sqrt(KT / k)[:, None]
    y[:, 1, 0] += L
    y = y[np.linalg.norm(y[:, 1] - y[:, 0], axis=1) > sum(radii)]
    expected = moments(y, L, radii)
    error = np.hypot(
        np.std(found, axis=0) / math.sqrt(len(found)) * 1.5,
        expected.std(axis=0) / math.sqrt(len(expected)),
    )
    # the bias of the variance by the step is 1e-3
    size = np.abs(expected).mean(axis=0)
    assert (
        np.abs(np.mean(found, axis=0) - expected.mean(axis=0)) < FAR * error + 2e-3 * size
    ).all()


def moments(x, L, radii):
    """Return gaps, their squares, and products of coordinates, (copies, 9)."""
    d = np.linalg.norm(x[:, 1] - x[:, 0], axis=1) - sum(radii)
    a, b = x[:, 0], x[:, 1] - [L, 0, 0]
    return np.stack(
        [d, d * d, a[:, 0], b[:, 0], a[:, 0] ** 2, b[:, 0] ** 2, a[:, 1] ** 2, b[:, 2] ** 2,
         a[:, 1] * b[:, 1]], axis=1,
    )  # fmt: skip


@pytest.mark.parametrize("second", [1.0, 0.5])
def test_correlations_of_two_traps(second):
    """e^(-M K t) kT/K along and across, at eight lags; no correlation at equal times."""
    radii, L, k, copies = (A, second * A), 4e-6, 3e-6, 12_000
    scalars, plane = pair(radii)
    of = scalars.at(np.array([L - sum(radii)]))
    acting = in_traps(radii, [(0, 0, 0), (L, 0, 0)], [k, k])
    step = 0.05 / (k * of.x22[0])
    rng = np.random.default_rng(3)
    x = rng.normal(size=(copies, 2, 3)) * math.sqrt(KT / k)
    x[:, 1, 0] += L
    begun = x - [[0, 0, 0], [L, 0, 0]]
    for n in range(8):
        followed(acting, plane, step, 10, x, first=10 * n)
        now = x - [[0, 0, 0], [L, 0, 0]]
        for axis, names in enumerate((("x11", "x12", "x22"), ("y11", "y12", "y22"))):
            own, cross, other = (float(getattr(of, name)[0]) for name in names)
            M = np.array([[own, cross], [cross, other]])
            C = expm(-k * M * step * 10 * (n + 1)) * KT / k
            products = now[:, :, None, axis] * begun[:, None, :, axis]
            error = products.std(axis=0) / math.sqrt(copies)
            # the mobility changes with the distance: less than a hundredth of it
            assert (np.abs(products.mean(axis=0) - C) < FAR * error + 0.01 * np.abs(C)).all()
            equal = now[:, 0, axis] * now[:, 1, axis]
            assert abs(equal.mean()) < FAR * equal.std() / math.sqrt(copies)


def test_far_beads_diffuse_alone():
    """At a distance of 4 mm each bead diffuses by Einstein's law, also the small one."""
    radii = (A, 0.3 * A)
    _, plane = pair(radii)
    acting = dark(radii, [], [], [])
    x = np.zeros((6000, 2, 3))
    x[:, 1, 2] = 4e-3
    step = 1e-3
    followed(acting, plane, step, 10, x)
    moved = x - [[0, 0, 0], [0, 0, 4e-3]]
    for bead, radius in enumerate(radii):
        expected = 2 * KT * UNIT / radius * 10 * step
        of_each = moved[:, bead] ** 2 / expected
        error = of_each.std(axis=0) / math.sqrt(len(of_each))
        assert (np.abs(of_each.mean(axis=0) - 1) < FAR * error).all()
    assert B == 9
