"""Signals of the detector of a scene, and how they depend on the position of its bead."""

from __future__ import annotations

from collections.abc import Hashable
from typing import TYPE_CHECKING, Any

import numpy as np

from tweezer.optics.detection import CHANNELS, Detection, detection
from tweezer.optics.linear_range import linear_range
from tweezer.optics.of_scene import before_axis, light
from tweezer.optics.recoil import recoil
from tweezer.results.run import variable
from tweezer.scene import SceneLike
from tweezer.values.arrays import Array
from tweezer.values.constants import hbar
from tweezer.values.units import QuantitiesLike
from tweezer.values.version import made_by, versions

if TYPE_CHECKING:
    import xarray as xr

#: Displacement for which the crosstalk is given, m
DISPLACED = 1e-7
#: Samples of a wavelength in the medium in the search for the end of the linear range
_SAMPLES = 500
#: Distance of this search, in bead radii and in wavelengths in the medium
_RADII, _WAVELENGTHS = 2.0, 2.0


def detect(scene: SceneLike, positions: QuantitiesLike | None = None) -> xr.Dataset:
    """Return the signals of the scene's detector, and how they depend on the position of the bead.

    The signals are powers on a photodiode, computed by wave optics without approximation. Their
    error is below 1e-9 of the collected light.

    Parameters
    ----------
    scene : Scene, str or mapping
        Scene with a `[detector]`.
    positions : array_like, shape (..., 3), optional
        Positions of the bead from the focus, m, z along the light. Quantities with units are
        accepted. Default: the stable equilibrium.

    Returns
    -------
    xarray.Dataset
        Over `place` and the signals in `channel`, x, y and z. Positions that are an xarray object
        keep their dimensions.

        * signal: power in the signal, W
        * slope: derivative of the signal with respect to the position along `axis`, W/m
        * shot_noise: root of the one-sided spectral density of the position, from shot noise and
          the slope along the same axis, m/sqrt(Hz)
        * information: part of the information in all scattered light that the signal has about the
          position along the same axis, 1; the largest value is 1 (see `recoil`)

        And about the stable equilibrium, `rest`:

        * linear_range: displacement along the same axis at which the signal deviates from its
          tangent by 5 %, m; the smaller one of both directions
        * crosstalk: apparent displacement in the signal, of a bead that is displaced by 0.1 um
          along `axis`, m. On the diagonal it contains the nonlinearity

    Raises
    ------
    ValueError
        For positions of another shape, or that are not finite.
    SceneError
        For a scene without a detector or without a stable equilibrium, and where the bead would be
        inside a wall.

    Examples
    --------
    >>> scene = tweezer.load_scene("silica-1um")
    >>> found = tweezer.detect(scene.replace(detector={"numerical_aperture": 0.9}))
    >>> bool(found.linear_range.sel(channel="x") > 5e-8)
    True
    """
    import xarray as xr

    of = light(scene)
    seen = detection(of.scene)
    given = seen.rest if positions is None else positions
    places = of._places(given)
    over, coordinates = before_axis(given, places)
    listed = places.reshape(-1, 3)
    signals, slopes, noise = seen.with_slopes(listed)
    own = np.diagonal(slopes, axis1=1, axis2=2)
    # the information of all light about x: 4 <v_x|v_x> k^2 P/(hbar omega) per time
    most = 4 * np.diagonal(recoil(of.scene, listed), axis1=1, axis2=2) / hbar**2
    shape = places.shape[:-1]
    described = {
        "signal": (signals, ("channel",), "W", "power in the signal"),
        "slope": (slopes, ("channel", "axis"), "W/m", "derivative of the signal"),
        "shot_noise": (
            np.sqrt(noise) / np.abs(own), ("channel",), "m/sqrt(Hz)",
            "shot noise as a displacement, root of the one-sided spectral density",
        ),
        "information": (
            2 * own**2 / noise / most, ("channel",), "1",
            "part of the information about the position",
        ),
    }  # fmt: skip
    variables: dict[Hashable, Any] = {
        name: variable((*over, *dims), values.reshape(shape + values.shape[1:]), unit, said)
        for name, (values, dims, unit, said) in described.items()
    }
    variables["linear_range"] = variable(
        ("channel",),
        linear_ranges(seen),
        "m",
        "displacement that is nonlinear by 5 %",
    )
    variables["crosstalk"] = variable(
        ("channel", "axis"),
        _crosstalk(seen),
        "m",
        "apparent displacement for 0.1 um",
    )
    coordinates |= {
        "position": variable((*over, "axis"), places, "m", "position of the bead's centre"),
        "rest": variable(("axis",), seen.rest, "m", "stable equilibrium"),
        "channel": (("channel",), np.array(CHANNELS), {"long_name": "signal"}),
        "axis": (("axis",), np.array(CHANNELS), {"long_name": "axis, z along the light"}),
    }
    attributes = {
        "title": of.scene.title,
        "scene": of.scene.model_dump_json(exclude_none=True),
        **versions(),
        **made_by("detect", dated=True),
    }
    return xr.Dataset(variables, coordinates, attributes)


def _crosstalk(seen: Detection) -> Array:
    """Return the apparent displacement by signal and axis, (3, 3) m, of a displaced bead."""
    (at_rest,), (slope,), _ = seen.with_slopes(seen.rest[None])
    moved = seen.signals(seen.rest + DISPLACED * np.eye(3)) - at_rest
    return np.asarray((moved / np.diagonal(slope)).T)


def linear_ranges(seen: Detection) -> Array:
    """Return the displacement at which each signal deviates from its tangent by 5 %, (3,) m.

    It is measured from the equilibrium along the axis of the signal. If the deviation stays small,
    the result is the end of the search.
    """
    (at_rest,), (slope,), _ = seen.with_slopes(seen.rest[None])
    return np.array([_linear_range(seen, i, at_rest[i], slope[i, i]) for i in range(3)])


def _linear_range(seen: Detection, i: int, at_rest: float, slope: float) -> float:
    """Return the linear range of signal i, m; its value and slope at rest are in W and W/m."""
    wavelength = 2 * np.pi / seen.diode.light.wavenumber
    end = _RADII * seen.diode.light.radius + _WAVELENGTHS * wavelength
    distances = np.linspace(0.0, end, int(_SAMPLES * end / wavelength))[1:]
    displaced = np.concatenate([-distances[::-1], distances])
    signals, _ = seen.along(seen.rest + displaced[:, None] * np.eye(3)[i])
    deviation = np.abs((signals[:, i] - at_rest) / (slope * displaced) - 1)
    below, above = deviation[: len(distances)][::-1], deviation[len(distances) :]
    return min(linear_range(side, distances) for side in (below, above))
