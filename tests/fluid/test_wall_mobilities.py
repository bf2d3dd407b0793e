"""Mobilities beside a wall against the exact series, what is printed of them, and their limits."""

import json
import math

import mpmath as mp
import numpy as np
import pytest
import xarray as xr

import tweezer
from tests.reference import wall as reference
from tweezer.compiled import cache_functions
from tweezer.generated import wall

ROWS = json.loads(reference.FILE.read_text())["rows"]
NAMES = ("perpendicular", "parallel", "spin", "turn", "roll")
#: what rounding adds to the emitted bounds: most by 1 - s at small gaps
ROUNDING = 1e-12

cache_functions(wall)


# --- the reference -------------------------------------------------------------------------------
@pytest.mark.parametrize("gap", ["0.02", "0.7", "31"])
def test_the_table_is_made_again(gap):
    (row,) = (row for row in ROWS if row["gap"] == gap)
    values, slopes = reference.with_slopes(gap)
    with mp.workdps(30):
        for made, kept in zip(values + slopes, row["values"] + row["slopes"], strict=True):
            assert abs(made / mp.mpf(kept) - 1) < 1e-17


@pytest.mark.parametrize("gap", ["0.003", "0.3", "8", "50"])
def test_reciprocity(gap):
    """H. A. Lorentz: F_r = (4/3) T_t. Translation and rotation have equations of their own."""
    r = reference.resistance(gap)
    with mp.workdps(30):
        assert abs(r.Fr / r.Tt * 3 / 4 - 1) < 1e-20


@pytest.mark.parametrize(
    ("h", "force", "moment"),
    [
        (10.0677, 1.0591, None), (3.7622, 1.1738, 4.2160e-4), (2.3524, 1.3079, 2.6425e-3),
        (1.5431, 1.5675, 1.4649e-2), (1.1276, 2.1514, 7.3718e-2), (1.0453, 2.6475, 0.14552),
        (1.003202, 4.0223, None),
    ],
)  # fmt: skip
def test_goldmans_table_of_translation(h, force, moment):
    """A. J. Goldman, R. G. Cox, H. Brenner (1967), table 2, as recalled: heights over the radius,
    -F_x* and T_y*. Its rounded heights move the moments; two are not remembered well enough.
    """
    r = reference.resistance(mp.mpf(str(h)) - 1)
    assert float(r.Ft) == pytest.approx(force, rel=3e-4)
    if moment:
        assert float(r.Tt) == pytest.approx(moment, rel=1e-3)


@pytest.mark.parametrize(
    ("al", "drag"), [(0.5, 9.2518), (1.0, 3.0361), (1.5, 1.8375), (2.0, 1.4129), (3.0, 1.1252)]
)
def test_brenners_table(al, drag):
    """H. Brenner (1961), table 1, as recalled: to a solid plane, by arccosh(h/a)."""
    r = reference.resistance(mp.cosh(al) - 1)
    assert float(r.away) == pytest.approx(drag, rel=1e-4)


def test_a_touching_sphere_spins():
    """G. B. Jeffery: at contact the resistance is zeta(3), and the emitted series goes on to it."""
    near = reference.resistance("1e-3").spin
    assert float(near) == pytest.approx(float(mp.zeta(3)), rel=3e-3)
    assert abs(wall.TOUCHING + 1 / mp.zeta(3) - 1) < 1e-15
    assert wall.mobilities(wall.CONTACT)[2] == pytest.approx(1 - wall.TOUCHING, rel=1e-4)


# --- the emitted functions -----------------------------------------------------------------------
@pytest.mark.parametrize("row", ROWS, ids=[row["gap"] for row in ROWS])
def test_values_and_derivatives(row):
    found = wall.mobilities(float(row["gap"]))
    bounds = [*zip(*wall.BOUNDS.values(), strict=True)]
    known = zip(found, row["values"] + row["slopes"], bounds[0] + bounds[1], strict=True)
    for value, true, bound in known:
        assert abs(mp.mpf(value) / mp.mpf(true) - 1) < bound + ROUNDING


def test_bounds():
    """What was asked for is 1e-7."""
    assert tuple(wall.BOUNDS) == NAMES
    assert max(max(bounds) for bounds in wall.BOUNDS.values()) < 1e-9


def test_pieces_meet_in_values_and_derivatives():
    """At every end of a piece, from both sides."""
    for piece in range(1, wall.PIECES):
        gap = 2 / math.expm1(piece / wall.PIECES_PER_W)
        sides = (wall.mobilities(gap * (1 + side)) for side in (-1e-13, 1e-13))
        np.testing.assert_allclose(*sides, rtol=3e-10)


def test_contact():
    """In proportion to the gap, the others as they are; nothing below zero, and no NaN."""
    near, at = wall.mobilities(0.3 * wall.CONTACT), wall.mobilities(wall.CONTACT)
    assert near[0] == pytest.approx(0.3 * at[0], rel=1e-14)
    assert near[1:5] == at[1:5]
    assert near[5] == pytest.approx(at[0] / wall.CONTACT)
    assert wall.mobilities(0.0)[0] == wall.mobilities(-0.1)[0] == 0
    assert math.isnan(wall.mobilities(math.nan)[0])
    # and no step there: lubrication goes on
    beyond = wall.mobilities(wall.CONTACT * (1 + 1e-12))
    np.testing.assert_allclose(beyond[:5], at[:5], rtol=1e-9)


def test_far_away():
    """To infinity: H. Faxen's series, relative in what is left of 1 too."""
    for gap in (200.0, 1e4, 1e7):
        s = 1 / (1 + gap)
        across, along, _, _, roll, *slopes = wall.mobilities(gap)
        assert 1 - across == pytest.approx(9 * s / 8 - s**3 / 2, rel=1e-7, abs=2e-16)
        assert 1 - along == pytest.approx(9 * s / 16 - s**3 / 8, rel=1e-7, abs=2e-16)
        assert roll == pytest.approx(3 / 32 * s**4 * (1 - 3 * s / 8), rel=1e-5)
        known = (9 * s**2 / 8, 9 * s**2 / 16, 3 * s**4 / 8, 15 * s**4 / 16, -3 * s**5 / 8)
        np.testing.assert_allclose(slopes, known, rtol=5e-3 if gap < 1e3 else 1e-4)
    np.testing.assert_array_equal(wall.mobilities(math.inf), [1, 1, 1, 1, 0, 0, 0, 0, 0, 0])


# --- the public function -------------------------------------------------------------------------
def test_wall_mobilities():
    gaps = np.array([1e-4, 0.1, 1.0, 50.0])
    found = tweezer.wall_mobilities(gaps)
    assert isinstance(found, xr.Dataset)
    assert tuple(found.data_vars) == NAMES
    assert found["parallel"].dims == ("gap_over_radius",)
    expected = np.array([wall.mobilities(gap)[:5] for gap in gaps])
    np.testing.assert_allclose(
        np.stack([found[name] for name in NAMES], axis=1), expected, rtol=1e-14
    )
    np.testing.assert_array_equal(found["gap_over_radius"], gaps)


@pytest.mark.parametrize("shape", [(), (1,), (2, 3), (0,), (2, 1, 2)])
def test_any_shape(shape):
    gaps = np.full(shape, 0.5)
    found = tweezer.wall_mobilities(gaps)
    for name in NAMES:
        assert found[name].shape == shape
    assert found["gap_over_radius"].shape == shape
    if shape == ():
        assert float(tweezer.wall_mobilities(0.5)["turn"]) == float(found["turn"])


@pytest.mark.parametrize("wrong", [0, -0.1, math.nan, math.inf, [1.0, -2.0], "near", None, 1j])
def test_gaps_that_are_none(wrong):
    with pytest.raises(
        tweezer.SceneError, match=r"^gap_over_radius = .*: allowed: positive"
    ) as told:
        tweezer.wall_mobilities(wrong)
    assert "\n" not in str(told.value)
