"""Mobility of many spheres in Stokes flow: far mobilities with lubrication of pairs.

The mobility of Rotne, Prager and Yamakawa, with rotation, is exact for spheres far from each other.
Its inverse is a resistance, to which the lubrication of each pair is added (L. Durlofsky, J. F.
Brady and G. Bossis, J. Fluid Mech. 180, 21 (1987)):

    R = inv(M_far) + sum over pairs [inv(M_exact) - inv(M_far of the pair)].

For two spheres it is exact. Each term of the sum is positive, which makes the mobility positive.
The sum of exact *mobilities* of pairs is indefinite near contact.
"""

from __future__ import annotations

from itertools import combinations
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tweezer.fluid.pair import NAMES
from tweezer.fluid.pair_table import pair_table
from tweezer.generated import pair as emitted
from tweezer.values.arrays import Array
from tweezer.values.errors import SceneError

#: Largest relative error of a mode of motion of three spheres, by the gap over the larger radius.
#: At gaps below 0.1 it was not measured
_ERRORS = (
    (0.01, 0.35),
    (0.1, 0.25),
    (0.2, 0.2),
    (0.5, 0.09),
    (1.0, 0.045),
    (2.0, 0.018),
    (4.0, 0.004),
)


class Mobility(NamedTuple):
    """Mobility of spheres, as `many_mobility` returns it."""

    matrix: Array
    """(6N, 6N): the velocities of all spheres and then their angular velocities, by the forces on
    all spheres and then the torques on them; s/kg, 1/(N s) and 1/(N m s)"""
    error: float
    """estimated largest relative error of a mode of translation"""


def many_mobility(positions: Array, radii: Array, viscosity: float) -> Mobility:
    """Return the mobility of spheres that do not overlap.

    Without torques, the first 3N rows and columns give the velocities.

    Parameters
    ----------
    positions : ndarray, shape (N, 3)
        Centres, m.
    radii : ndarray, shape (N,)
        Radii, m.
    viscosity : float
        Viscosity of the medium, Pa s.

    Returns
    -------
    Mobility
        The matrix, symmetric and positive, and its error.

    Raises
    ------
    SceneError
        For spheres that overlap or touch, and for pairs of too unequal radii.

    Notes
    -----
    The error for three and more spheres was measured with triangles and chains of equal spheres
    against Lamb's solution. It depends on the smallest gap at which one sphere has two neighbours.
    """
    positions, radii = np.asarray(positions, np.float64), np.asarray(radii, np.float64)
    unit = float(radii.max())
    x, a = positions / unit, radii / unit
    order = np.argsort(-a, kind="stable")  # the first of a pair is the larger one
    pairs = [(int(i), int(j)) for i, j in combinations(order, 2)]
    count = len(a)
    far = np.diag(np.concatenate([np.repeat(1 / a, 3), np.repeat(0.75 / a**3, 3)]))
    lubrication = np.zeros_like(far)
    gaps = np.full((count, count), np.inf)
    of_tables = 0.0
    for i, j in pairs:
        line = x[j] - x[i]
        r = float(np.linalg.norm(line))
        gaps[i, j] = gaps[j, i] = gap = r - a[i] - a[j]
        if not gap > 0:
            raise SceneError(
                f"spheres {min(i, j) + 1} and {max(i, j) + 1}: overlap by {-gap * unit:.3g} m; "
                "allowed: gaps greater than 0; move them apart"
            )
        table = pair_table(a[j] / a[i])
        of_tables = max(of_tables, table.error)
        exact = _blocks(_exact(table.mobilities(np.array([gap / a[i]]))[0][:, 0], a[i]), line / r)
        approximate = _blocks(_far(float(a[i]), float(a[j]), r), line / r)
        at = _indices(count, i, j)
        far[at] = approximate
        lubrication[at] += np.linalg.inv(exact) - np.linalg.inv(approximate)
    matrix = np.linalg.inv(np.linalg.inv(far) + lubrication)
    matrix = (matrix + matrix.T) / 2
    sizes = np.repeat([1.0, 1 / unit], 3 * count)
    scale = 6 * np.pi * viscosity * unit
    return Mobility(sizes[:, None] * sizes * matrix / scale, max(of_tables, _error(gaps, a)))


def _indices(count: int, i: int, j: int) -> tuple[NDArray[np.int_], ...]:
    """Return the index of the rows and columns of two spheres: velocities, then angular ones."""
    first = np.array([3 * i, 3 * j, 3 * (count + i), 3 * (count + j)])
    return np.ix_(*[(first[:, None] + np.arange(3)).ravel()] * 2)


def _exact(values: Array, radius: float) -> dict[str, float]:
    """Return exact mobilities of a pair; that along the line keeps its digits near contact."""
    powers = [1 + ("tr" in name) + 2 * ("rr" in name) for name in NAMES]
    found = dict(zip(NAMES, values / radius ** np.array(powers), strict=True))
    found["x12"] = (found["x11"] + found["x22"] - found["relative_x"]) / 2
    return found


def _far(radius_1: float, radius_2: float, distance: float) -> dict[str, float]:
    """Return the mobilities of a pair by Rotne, Prager and Yamakawa."""
    along, across = emitted.rotne_prager(radius_1, radius_2, distance)
    turn, spin, roll = emitted.rotne_prager_turning(distance)
    own = {"11": radius_1, "22": radius_2}
    found = {f"{kind}{which}": 1 / a for kind in "xy" for which, a in own.items()}
    found |= {f"{kind}{which}": 0.75 / a**3 for kind in ("rrx", "rry") for which, a in own.items()}
    found |= {"tr11": 0.0, "tr22": 0.0, "tr12": turn, "tr21": turn}
    return found | {"x12": along, "y12": across, "rrx12": spin, "rry12": roll}


def _blocks(m: dict[str, float], line: Array) -> Array:
    """Return the mobility (12, 12) of a pair, whose unit vector from 1 to 2 is `line`."""
    along = np.outer(line, line)
    across = np.eye(3) - along
    cross = np.array([[0, -line[2], line[1]], [line[2], 0, -line[0]], [-line[1], line[0], 0]])

    def symmetric(kind: str, on_line: str) -> Array:
        both = [m[on_line + k] * along + m[kind + k] * across for k in ("11", "12", "22")]
        return np.block([[both[0], both[1]], [both[1], both[2]]])

    turning = np.block(
        [[m["tr11"] * cross, m["tr12"] * cross], [-m["tr21"] * cross, -m["tr22"] * cross]]
    )
    return np.block([[symmetric("y", "x"), turning.T], [turning, symmetric("rry", "rrx")]])


def _error(gaps: Array, radii: Array) -> float:
    """Return the relative error of modes, by the smallest gap at which three spheres are near."""
    if len(radii) < 3:
        return 0.0
    own = np.sort(gaps / np.maximum(radii[:, None], radii), axis=1)[:, 1]
    nearest, errors = np.array(_ERRORS).T
    gap = float(own.min())
    if gap > nearest[-1]:  # the next reflection: a fourth power of the distance
        return float(errors[-1] * ((nearest[-1] + 2) / (gap + 2)) ** 4)
    return float(np.exp(np.interp(np.log(gap), np.log(nearest), np.log(errors))))
