"""Mobilities of two spheres against sums of 30 digits, another solver, published values, limits."""

import json
import math

import mpmath as mp
import numpy as np
import pytest

import tweezer
from tests.reference import spheres
from tweezer.fluid.pair import NAMES, exact
from tweezer.fluid.pair_table import pair_table
from tweezer.fluid.two_spheres import resistances
from tweezer.generated import pair as emitted

ROWS = json.loads(spheres.FILE.read_text())["rows"]
IDS = [f"1:{row['radius']}, {row['gap']}" for row in ROWS]


def scale(name, radius):
    """Size of a mobility of spheres with the radii 1 and `radius` that are far from each other."""
    own, rotations = {"1": 1.0, "2": 1 / radius}, {"x": 0, "y": 0, "tr": 1, "rrx": 2, "rry": 2}
    if name.startswith("relative"):
        return 1 + 1 / radius
    kind, first, second = name[:-2], own[name[-2]], own[name[-1]]
    powers = {0: (0.5, 0.5), 1: (1.5, 0.5), 2: (1.5, 1.5)}[rotations[kind]]
    return 0.75 ** (rotations[kind] / 2) * first ** powers[0] * second ** powers[1]


# --- the reference -------------------------------------------------------------------------------
def test_table_is_made_again():
    """A row with fewer digits; making all of them takes minutes."""
    (row,) = (row for row in ROWS if (row["radius"], row["gap"]) == ("0.5", "3"))
    made = [each("0.5", "3", 14) for each in (spheres.along, spheres.spin, spheres.across)]
    values = {name: value for each in made for name, value in each.items()}
    assert values.keys() == set(NAMES)
    for name, value in values.items():
        assert abs(value - mp.mpf(row["values"][name])) < 1e-13


@pytest.fixture(scope="module")
def by_points():
    """Spheres of radii 1 and 0.5 with a gap of 1 along z, by Lamb's solution at points."""
    return spheres.mobility([[0, 0, 0], [0, 0, 2.5]], [1, 0.5], 11)


# --- exact values --------------------------------------------------------------------------------
@pytest.mark.parametrize("row", ROWS, ids=IDS)
def test_mobilities_agree_with_sums_of_30_digits(row):
    radius, gap = float(row["radius"]), float(row["gap"])
    found = tweezer.pair_mobilities(1, radius, gap)
    for name in NAMES:
        known = mp.mpf(row["values"][name])
        size = float(known) if name == "relative_x" else scale(name, radius)
        assert abs(mp.mpf(float(found[name])) - known) < float(found["error"]) * size
    assert float(found["error"]) < 1e-10


def test_mobilities_and_signs_agree_with_lambs_solution(by_points):
    """Sphere 1 is at z = 0 and sphere 2 above it, so that n_1 = z and n_2 = -z."""
    found = {name: float(value) for name, value in tweezer.pair_mobilities(1, 0.5, 1).items()}
    m = by_points
    known = {
        "x11": m[2, 2], "x12": m[2, 5], "x22": m[5, 5],
        "y11": m[0, 0], "y12": m[0, 3], "y22": m[3, 3],
        # the angular velocity about y by a force along x
        "tr11": m[7, 0], "tr12": m[7, 3], "tr21": -m[10, 0], "tr22": -m[10, 3],
        "rrx11": m[8, 8], "rrx12": m[8, 11], "rrx22": m[11, 11],
        "rry11": m[6, 6], "rry12": m[6, 9], "rry22": m[9, 9],
        "relative_x": m[2, 2] + m[5, 5] - 2 * m[2, 5],
        "relative_y": m[0, 0] + m[3, 3] - 2 * m[0, 3],
    }  # fmt: skip
    assert known.keys() == set(NAMES)
    for name, value in known.items():
        assert found[name] == pytest.approx(value, abs=3e-8)


@pytest.mark.parametrize(
    ("half_distance", "drag"),
    [(1.5431, 0.702), (2.3524, 0.768), (3.7622, 0.836), (6.1323, 0.892),
     (10.068, 0.931)],
)  # fmt: skip
def test_table_of_stimson_and_jeffery(half_distance, drag):
    """Drag of each of two equal spheres that follow each other, as recalled, to three digits."""
    found = tweezer.pair_mobilities(1, 1, 2 * half_distance - 2)
    assert 1 / float(found["x11"] + found["x12"]) == pytest.approx(drag, abs=6e-4)


def test_approach_of_equal_spheres():
    """H. Brenner (1961): drag at gaps of 0.01, 0.1 and 1 radii."""
    found = tweezer.pair_mobilities(1, 1, [0.01, 0.1, 1.0])
    np.testing.assert_allclose(
        2 / found["relative_x"], [53.422294, 7.4132976, 2.0386546], rtol=3e-8
    )


# --- limits --------------------------------------------------------------------------------------
def test_far_spheres_follow_the_series_of_jeffrey_and_onishi():
    """In 1/r, at two distances: the rest decreases with the next power of the series."""
    a, b = 1.0, 0.6
    series = {
        "x11": (4, lambda r: 1 - 15 / 4 * b**3 / r**4, 6),
        "x12": (1, lambda r: 1.5 / r - (a**2 + b**2) / (2 * r**3), 7),
        "y11": (6, lambda r: 1 - 17 / 16 * b**5 / r**6, 8),
        "y12": (1, lambda r: 0.75 / r + (a**2 + b**2) / (4 * r**3), 7),
        "tr12": (2, lambda r: 0.75 / r**2, 7),
        "rrx12": (3, lambda r: 0.75 / r**3, 9),
        "rry12": (3, lambda r: -0.375 / r**3, 9),
    }
    distances = np.array([20.0, 40.0])
    found = tweezer.pair_mobilities(a, b, distances - a - b)
    for name, (_, value, power) in series.items():
        rest = np.abs(found[name].values - value(distances)) * distances**power
        assert (rest < 12 + 1e-14 * distances**power).all(), name


@pytest.mark.parametrize("gap", [1e-3, 1e-4])
def test_lubrication_of_equal_spheres(gap):
    """D. J. Jeffrey and Y. Onishi (1984), with their constants of four digits."""
    r, ln = resistances(1, 1, gap), math.log(1 / gap)
    own = 1 / (4 * gap) + 9 / 40 * ln + 3 / 112 * gap * ln
    assert r.along[0, 0] == pytest.approx(own + 0.9954, abs=3 * gap + 1e-4)
    assert r.along[0, 1] == pytest.approx(-own - 0.3502, abs=3 * gap + 1e-4)
    assert r.across[0, 0] == pytest.approx(ln / 6 + 0.9983, abs=3 * gap * ln + 1e-4)
    assert r.across[0, 1] == pytest.approx(-ln / 6 - 0.2737, abs=3 * gap * ln + 1e-4)


def test_large_sphere_is_a_wall():
    """Resistances beside a fixed sphere of radii 50 to 200, extrapolated to a plane."""
    wall = tweezer.wall_mobilities(0.1)
    known = {
        "across": 1 / float(wall["perpendicular"]),
        "along": float(wall["parallel"]),
        "turn": 0.75 * float(wall["turn"]),
        "roll": float(wall["roll"] * wall["parallel"]),
    }
    found = []
    for radius in (50.0, 100.0, 200.0):
        r = resistances(1, radius, 0.1)
        free = np.linalg.inv(r.across[::2, ::2])
        found.append([r.along[0, 0], free[0, 0], free[1, 1], free[1, 0]])
    first, second, third = np.array(found)
    plane = (8 * third - 6 * second + first) / 3
    np.testing.assert_allclose(plane, [*known.values()], rtol=1e-4)


# --- the table for compiled code -----------------------------------------------------------------
@pytest.fixture(scope="module")
def table():
    """Return the table for the radii 1 and 0.5."""
    return pair_table(0.5)


def sizes(values, radius):
    """Scale of each mobility; relative_x is its own."""
    found = np.array([[scale(name, radius)] for name in NAMES]) * np.ones(values.shape[1])
    at = NAMES.index("relative_x")
    found[at] = values[at]
    return found


def test_table_agrees_with_the_sums(table):
    """At random gaps from the smallest to 50 radii."""
    gaps = table.lowest * np.exp(np.random.default_rng(1).uniform(0, 16, 25))
    values, _ = table.mobilities(gaps)
    known = np.array([exact(1.0, 0.5, float(gap))[0] for gap in gaps]).T
    assert (np.abs(values - known) <= table.error * sizes(known, 0.5)).all()
    assert table.error < 1e-8


def test_derivatives_of_the_table_agree_with_differences(table):
    gaps = np.array([0.02, 0.3, 1.0, 5.0])
    step = 0.02 * gaps
    at = [
        np.array([exact(1.0, 0.5, float(gap))[0] for gap in gaps + shift * step]).T
        for shift in (-3, -2, -1, 1, 2, 3)
    ]
    known = (45 * (at[3] - at[2]) - 9 * (at[4] - at[1]) + at[5] - at[0]) / (60 * step)
    _, slopes = table.mobilities(gaps)
    values = (at[2] + at[3]) / 2
    assert (np.abs(slopes - known) * gaps <= 2e-7 * sizes(values, 0.5)).all()


def test_table_goes_on_to_contact_and_to_infinity(table):
    along = NAMES.index("relative_x")
    gaps = np.array([-1.0, 0.0, 0.5, 1.0, 1.0 + 1e-12]) * table.lowest
    values, slopes = table.mobilities(gaps)
    np.testing.assert_allclose(values[along, :3], values[along, 3] * np.array([0, 0, 0.5]))
    np.testing.assert_allclose(slopes[along, :3], values[along, 3] / table.lowest, rtol=1e-12)
    np.testing.assert_allclose(values[:, 3], values[:, 4], rtol=1e-9)
    values, slopes = table.mobilities(np.array([np.inf]))
    expected = [1, 2, 0, 1, 2, 0, 0, 0, 0, 0, 0.75, 6, 0, 0.75, 6, 0, 3, 3]
    np.testing.assert_allclose(values[:, 0], expected, atol=1e-8)
    np.testing.assert_array_equal(slopes[:, 0], 0)


def test_table_of_too_unequal_spheres_is_refused():
    with pytest.raises(tweezer.SceneError, match=r"^ratio of radii = 30: too unequal .*; allowed"):
        pair_table(30)


# --- Rotne, Prager and Yamakawa ------------------------------------------------------------------
def test_emitted_far_mobility():
    """Zuk et al. (2014) for spheres that are apart, that overlap, and one inside the other."""
    a, b = 1.0, 0.4
    for r in (1.5, 4.0):
        along, across = emitted.rotne_prager(a, b, r)
        assert along == pytest.approx(1.5 / r * (1 - (a * a + b * b) / (3 * r * r)), rel=1e-14)
        assert across == pytest.approx(0.75 / r * (1 + (a * a + b * b) / (3 * r * r)), rel=1e-14)
    along, across = emitted.rotne_prager(a, a, 1.0)
    assert along == pytest.approx(1 - 9 / 32 + 3 / 32, rel=1e-14)
    assert across == pytest.approx(1 - 9 / 32, rel=1e-14)
    assert emitted.rotne_prager(a, b, 0.3) == (1.0, 1.0)
    far = dict(zip(NAMES, exact(1.0, 0.4, 30.0)[0], strict=True))
    turns = emitted.rotne_prager_turning(31.4)
    known = [far[name] for name in ("tr12", "rrx12", "rry12")]
    np.testing.assert_allclose(turns, known, rtol=1e-4)


# --- the public function -------------------------------------------------------------------------
def test_reciprocity_and_exchange_of_the_spheres():
    """The error of reciprocity is reported; exchanged spheres have exchanged names."""
    gaps = [1e-3, 0.1, 5.0]
    one, two = tweezer.pair_mobilities(1, 0.3, gaps), tweezer.pair_mobilities(0.3, 1, gaps)
    assert float(one["error"].max()) < 1e-9
    for name, other in (("x11", "x22"), ("y22", "y11"), ("y12", "y12"), ("relative_x",) * 2):
        np.testing.assert_allclose(one[name], two[other] / 0.3, rtol=1e-10)
    np.testing.assert_allclose(one["tr12"], two["tr21"] / 0.09, rtol=1e-10)


def test_units_and_viscosity():
    bare = tweezer.pair_mobilities(0.5, 1.0, 0.2)
    si = tweezer.pair_mobilities("0.5 um", "1 um", "0.2 um", viscosity="1 mPa s")
    stokes = 1 / (6 * math.pi * 1e-3 * 0.5e-6)
    for name, power in (("x12", 0), ("tr11", 1), ("rry22", 2)):
        assert float(si[name]) == pytest.approx(
            float(bare[name]) * stokes / 0.5e-6**power, rel=1e-12
        )
    assert [si[name].attrs["units"] for name in ("x11", "tr12", "rrx12")] == [
        "s kg-1", "s kg-1 m-1", "s kg-1 m-2"
    ]  # fmt: skip
    assert bare["x11"].attrs["units"] == "1"


@pytest.mark.parametrize("shape", [(), (1,), (2, 1), (0,)])
def test_gaps_of_any_shape(shape):
    found = tweezer.pair_mobilities(1, 1, np.full(shape, 0.5))
    assert tuple(found.data_vars) == (*NAMES, "error")
    assert all(found[name].shape == shape for name in (*NAMES, "error", "gap"))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((0, 1, 1), "radius_1 = 0: allowed: a positive finite number (m)"),
        ((1, math.inf, 1), "radius_2 = inf: allowed: a positive finite number (m)"),
        ((1, 1, [0.1, -1.0]), "gap = -1: allowed: positive finite numbers (m)"),
        ((1, 1, "near"), "gap = 'near': allowed: positive finite numbers (m)"),
        ((1, 1, 1, 0), "viscosity = 0: allowed: a positive finite number (Pa s)"),
        ((1, 1, 1e-9), "gap = 1e-09: too small for the series with the radii 1 and 1; allowed: at"),
        ((1, 1e6, 1), "gap = 1: too small for the series with the radii 1 and 1e+06; allowed: at"),
    ],
)
def test_wrong_arguments_are_refused(arguments, message):
    with pytest.raises(tweezer.SceneError) as told:
        tweezer.pair_mobilities(*arguments)
    assert str(told.value).startswith(message)
    assert "\n" not in str(told.value)
