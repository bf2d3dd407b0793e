"""The exact mobilities of a sphere near a plane wall."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from tweezer.compiled import cache_functions, cached_njit
from tweezer.generated import wall
from tweezer.values.errors import SceneError
from tweezer.values.units import QuantitiesLike, array_in_si
from tweezer.values.version import made_by

if TYPE_CHECKING:
    import xarray as xr

cache_functions(wall)

#: What each of them is of
_MEANINGS = {
    "perpendicular": "velocity across the wall due to a force",
    "parallel": "velocity along the wall due to a force",
    "spin": "angular velocity about the wall's normal due to a torque",
    "turn": "angular velocity about an axis along the wall due to a torque",
    "roll": "radius times angular velocity, over velocity, of a bead pulled along the wall",
}


@cached_njit()
def _fill(gaps, found):  # type: ignore[no-untyped-def]
    """Fill found (5, n) with the mobilities of `_MEANINGS`, in this order, at gaps (n,)
    in radii.
    """
    for at in range(len(gaps)):
        found[0, at], found[1, at], found[2, at], found[3, at], found[4, at] = wall.mobilities(
            gaps[at]
        )[:5]


def wall_mobilities(gap_over_radius: QuantitiesLike) -> xr.Dataset:
    """Return the mobilities of a sphere near a plane wall in slow flow, as functions of the gap.

    Each mobility is relative to its value far from the wall. The mobilities apply to a free bead:
    when a force pulls it along the wall it rolls, and when a torque turns it, it also translates.

    Parameters
    ----------
    gap_over_radius : array_like
        Gap between the wall and the surface of the sphere, in radii.

    Returns
    -------
    xarray.Dataset
        Over the dimensions of `gap_over_radius`:

        * perpendicular, parallel: translational mobilities perpendicular and parallel to the wall
        * spin, turn: rotational mobilities about the normal of the wall and about an axis parallel
          to it
        * roll: radius times angular velocity divided by velocity, for a bead that a force pulls
          along the wall; positive in the sense in which a ball rolls

    Raises
    ------
    SceneError
        For a gap that is not a positive finite number.

    Notes
    -----
    The values agree with the exact series to a relative 2e-12, down to a gap of 1e-5 radii. At
    smaller gaps, at which real surfaces are rough, `perpendicular` is proportional to the gap and
    the others are constant.

    References
    ----------
    H. Brenner (1961); G. B. Jeffery (1915); M. E. O'Neill (1964); W. R. Dean and M. E. O'Neill
    (1963).

    Examples
    --------
    >>> beside = tweezer.wall_mobilities([0.1, 1.0, 10.0])
    >>> beside.parallel.round(2).values.tolist()
    [0.44, 0.72, 0.95]
    """
    try:
        gaps = array_in_si(gap_over_radius, "")
    except ValueError:
        raise SceneError(
            f"gap_over_radius = {gap_over_radius!r}: allowed: positive finite numbers"
        ) from None
    wrong = gaps[~((gaps > 0) & np.isfinite(gaps))]
    if wrong.size:
        raise SceneError(f"gap_over_radius = {wrong[0]:g}: allowed: positive finite numbers")
    import xarray as xr

    found = np.empty((len(_MEANINGS), gaps.size))
    _fill(gaps.ravel(), found)
    name = "gap_over_radius"
    dims = (name,) if gaps.ndim == 1 else tuple(f"gap_{axis}" for axis in range(gaps.ndim))
    variables = {
        mobility: (dims, values.reshape(gaps.shape), {"long_name": meaning, "units": "1"})
        for (mobility, meaning), values in zip(_MEANINGS.items(), found, strict=True)
    }
    return xr.Dataset(
        variables,
        {name: (dims, gaps, {"long_name": "gap over radius", "units": "1"})},
        {"title": "mobilities beside a wall", **made_by("wall_mobilities", dated=True)},
    )
