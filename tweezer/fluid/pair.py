"""The exact mobilities of two spheres in Stokes flow."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from tweezer.fluid.two_spheres import DECAY, geometry, nearest, resistances
from tweezer.values.arrays import Array
from tweezer.values.errors import SceneError
from tweezer.values.units import QuantitiesLike, QuantityLike, array_in_si, to_si
from tweezer.values.version import made_by

if TYPE_CHECKING:
    import xarray as xr

#: Meaning of each mobility, and the power of length that it contains
MEANINGS = {
    "x11": ("velocity of sphere 1 along the line of centres, by a force on it", 0),
    "x22": ("velocity of sphere 2 along the line of centres, by a force on it", 0),
    "x12": ("velocity of a sphere along the line of centres, by a force on the other", 0),
    "y11": ("velocity of sphere 1 across the line of centres, by a force on it", 0),
    "y22": ("velocity of sphere 2 across the line of centres, by a force on it", 0),
    "y12": ("velocity of a sphere across the line of centres, by a force on the other", 0),
    "tr11": ("angular velocity of sphere 1 by a force on it across the line", 1),
    "tr12": ("angular velocity of sphere 1 by a force on sphere 2 across the line", 1),
    "tr21": ("angular velocity of sphere 2 by a force on sphere 1 across the line", 1),
    "tr22": ("angular velocity of sphere 2 by a force on it across the line", 1),
    "rrx11": ("angular velocity of sphere 1 about the line, by a torque on it", 2),
    "rrx22": ("angular velocity of sphere 2 about the line, by a torque on it", 2),
    "rrx12": ("angular velocity of a sphere about the line, by a torque on the other", 2),
    "rry11": ("angular velocity of sphere 1 about an axis across the line, by a torque on it", 2),
    "rry22": ("angular velocity of sphere 2 about an axis across the line, by a torque on it", 2),
    "rry12": ("angular velocity of a sphere about such an axis, by a torque on the other", 2),
    "relative_x": ("relative velocity along the line by opposite forces", 0),
    "relative_y": ("relative velocity across the line by opposite forces", 0),
}
NAMES = tuple(MEANINGS)
#: index of each mobility after the spheres exchange their names
_SWAPPED = {name: name.translate(str.maketrans("12", "21")) for name in NAMES}
_EXCHANGED = [NAMES.index(swap if swap in NAMES else name) for name, swap in _SWAPPED.items()]
#: Decrease of the terms in the second computation, by which the error is estimated
_SHORTER = 32.0
#: Largest number of degrees, which limits the time to a second
_MOST_TERMS = 100_000
#: Largest relative error that is reported
_TRUSTED = 1e-7
#: Relative error by rounding, and its increase with the square of the number of degrees
_ROUNDING = (1e-14, 6e-18)
_UNITS = ("s kg-1", "s kg-1 m-1", "s kg-1 m-2")


def pair_mobilities(
    radius_1: QuantityLike,
    radius_2: QuantityLike,
    gap: QuantitiesLike,
    viscosity: QuantityLike | None = None,
) -> xr.Dataset:
    r"""Return the mobilities of two spheres in slow flow, as functions of the gap between them.

    The spheres are free: a force on one of them moves and rotates both. With the unit vector n
    along the line of centres, a force F on sphere j gives sphere i the velocity

    .. math:: v_i = [x_{ij}\, n n + y_{ij}\, (1 - n n)] \cdot F_j,

    and the angular velocity tr_ij n_i x F_j, where n_i points from sphere i to the other one. By
    reciprocity a torque T on sphere j adds tr_ji T_j x n_j to v_i. The angular velocity by this
    torque is [rrx_ij n n + rry_ij (1 - n n)] T_j.

    Parameters
    ----------
    radius_1, radius_2 : float or quantity
        Radii, m. Without `viscosity`, numbers in any unit of length are allowed.
    gap : array_like
        Distance between the surfaces, in the unit of the radii.
    viscosity : float or quantity, optional
        Viscosity of the medium, Pa s.

    Returns
    -------
    xarray.Dataset
        Over the dimensions of `gap`:

        * x11, x22, x12: translation along the line of centres
        * y11, y22, y12: translation across it
        * tr11, tr12, tr21, tr22: rotation by a force across the line
        * rrx11, rrx22, rrx12, rry11, rry22, rry12: rotation by a torque along and across the line
        * relative_x, relative_y: relative velocity by opposite forces, x11 + x22 - 2 x12 and the
          same of y; no digits cancel near contact
        * error: estimated largest error of them, relative to the mobilities of separate spheres;
          of relative_x it is relative to its value

        With `viscosity` they are in SI units. Without it, translation is relative to
        1/(6 pi mu radius_1), and tr and rr contain the further factors 1/radius_1 and
        1/radius_1^2.

    Raises
    ------
    SceneError
        For radii, gaps or a viscosity that are not positive, and for a gap that is too small for
        the series.

    Notes
    -----
    The mobilities are sums over bispherical harmonics. The error contains the deviation from
    reciprocity and the difference from a shorter series of the exchanged spheres. From gaps of 1e-3
    radii on and for radii up to 1:0.05 the mobilities agree with sums of 30 digits within 1e-10.

    References
    ----------
    M. Stimson and G. B. Jeffery (1926); A. D. Maude (1961); A. J. Goldman, R. G. Cox and H. Brenner
    (1966); M. E. O'Neill and S. R. Majumdar (1970); D. J. Jeffrey and Y. Onishi (1984).

    Examples
    --------
    >>> pair = tweezer.pair_mobilities("0.5 um", "0.5 um", ["0.05 um", "0.5 um", "5 um"])
    >>> pair.relative_x.round(3).values.tolist()
    [0.27, 0.981, 1.751]
    """
    radii = _positive("radius_1", radius_1, "m"), _positive("radius_2", radius_2, "m")
    unit = 1 / radii[0] if viscosity is None else None
    if unit is None:
        unit = 1 / (6 * np.pi * _positive("viscosity", viscosity, "Pa s"))
    gaps = _gaps(gap, *radii)
    found = np.empty((len(NAMES), gaps.size))
    errors = np.empty(gaps.size)
    for at, each in enumerate(gaps.flat):
        found[:, at], errors[at] = exact(*radii, float(each))
        if errors[at] > _TRUSTED:
            raise SceneError(
                f"gap = {each:g}: the mobilities would have an error of {errors[at]:.1g}; allowed: "
                f"errors up to {_TRUSTED:g}; use a larger gap or more similar radii"
            )
    return _dataset(gaps, found, errors, radii[0] if viscosity is None else None, unit)


def exact(radius_1: float, radius_2: float, gap: float) -> tuple[Array, float]:
    """Return the mobilities in the order of `NAMES`, (18,), and their relative error.

    They are over 1/(6 pi mu) and powers of length.
    """
    found, asymmetry = mobilities(radius_1, radius_2, gap, DECAY)
    again, other = mobilities(radius_2, radius_1, gap, _SHORTER)
    difference = np.abs(found - again[_EXCHANGED]) / scales(radius_1, radius_2)
    at = NAMES.index("relative_x")
    difference[at] = abs(again[at] / found[at] - 1)
    return found, float(max(asymmetry, other, difference.max()))


def mobilities(radius_1: float, radius_2: float, gap: float, decay: float) -> tuple[Array, float]:
    """Return the mobilities, (18,), and their relative error by rounding.

    It is the larger of the deviation from reciprocity and the usual error of a series of this
    length. The terms that decrease by more than e^(-decay) are left out.
    """
    r = resistances(radius_1, radius_2, gap, decay)
    between = r.along[0, 1]
    # forces of spheres that move together, which lubrication does not enter
    first, second = r.together
    determinant = first * second - between * (first + second)
    along = np.array([second - between, first - between, -between]) / determinant
    spin, across = np.linalg.inv(r.spin), np.linalg.inv(r.across)
    translation, turning, rotation = across[:2, :2], across[2:, :2], across[2:, 2:]
    found = np.array([
        *along, translation[0, 0], translation[1, 1], translation[0, 1],
        -turning[0, 0], -turning[0, 1], turning[1, 0], turning[1, 1],
        spin[0, 0], spin[1, 1], spin[0, 1], rotation[0, 0], rotation[1, 1], rotation[0, 1],
        (first + second) / determinant,
        translation[0, 0] + translation[1, 1] - 2 * translation[0, 1],
    ])  # fmt: skip
    sizes = np.array([radius_1, radius_2])
    sizes = np.sqrt(np.concatenate([sizes, 4 / 3 * sizes**3]))
    asymmetry = sizes[:, None] * sizes * np.abs(across - across.T)
    usual = _ROUNDING[0] + _ROUNDING[1] * geometry(radius_1, radius_2, gap).terms() ** 2
    return found, float(max(asymmetry.max(), abs(r.along[1, 0] / between - 1), usual))


def scales(radius_1: float, radius_2: float) -> Array:
    """Return the scale of each mobility, (18,): that of separate spheres, or the geometric mean."""
    one, two = 1 / radius_1, 1 / radius_2
    both, relative = np.sqrt(one * two), one + two
    turning = np.sqrt(0.75) * np.array(
        [one * one, one**1.5 * two**0.5, two**1.5 * one**0.5, two * two]
    )
    spin = 0.75 * np.array([one**3, two**3, both**3])
    translation = np.array([one, two, both])
    return np.concatenate(
        [translation, translation, turning, spin, spin, np.array([relative, relative])]
    )


def _positive(name: str, value: Any, unit: str) -> float:
    try:
        number = to_si(value, unit)
    except ValueError:
        number = np.nan
    if not number > 0:
        raise SceneError(f"{name} = {value!r}: allowed: a positive finite number ({unit})")
    return number


def _gaps(gap: QuantitiesLike, radius_1: float, radius_2: float) -> Array:
    """Return the gaps, after a check that they are positive and not too small."""
    try:
        gaps = array_in_si(gap, "m")
    except ValueError:
        raise SceneError(f"gap = {gap!r}: allowed: positive finite numbers (m)") from None
    wrong = gaps[~((gaps > 0) & np.isfinite(gaps))]
    if wrong.size:
        raise SceneError(f"gap = {wrong[0]:g}: allowed: positive finite numbers (m)")
    least = nearest(radius_1, radius_2, _MOST_TERMS)
    if gaps.size and gaps.min() < least:
        raise SceneError(
            f"gap = {gaps.min():g}: too small for the series with the radii {radius_1:g} and "
            f"{radius_2:g}; allowed: at least {least:.3g}"
        )
    return gaps


def _dataset(
    gaps: Array, found: Array, errors: Array, radius: float | None, unit: float
) -> xr.Dataset:
    """Return the dataset; `radius` is the unit of length, None for SI units."""
    import xarray as xr

    dims = ("gap",) if gaps.ndim == 1 else tuple(f"gap_{axis}" for axis in range(gaps.ndim))
    variables: dict[str, Any] = {}
    for (name, (meaning, power)), values in zip(MEANINGS.items(), found, strict=True):
        factor, units = unit, _UNITS[power]
        if radius is not None:
            factor, units = radius ** (1 + power), "1"
        about = {"long_name": meaning, "units": units}
        variables[name] = (dims, factor * values.reshape(gaps.shape), about)
    about = {"long_name": "estimated relative error of the mobilities", "units": "1"}
    variables["error"] = (dims, errors.reshape(gaps.shape), about)
    of_gap = {"long_name": "gap between the surfaces", "units": "m"}
    return xr.Dataset(
        variables,
        {"gap": (dims, gaps, of_gap)},
        {"title": "mobilities of two spheres", **made_by("pair_mobilities", dated=True)},
    )
