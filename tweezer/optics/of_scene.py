"""The light of a scene at positions of its bead, with checks of the positions."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from tweezer.forces.force import Wrench
from tweezer.optics.binding import Beams, evaluators_of, light_force
from tweezer.optics.heat import heated
from tweezer.optics.light import LightForce
from tweezer.results.run import variable, with_error
from tweezer.scene import Scene, SceneLike
from tweezer.scene.interference import faces
from tweezer.values.arrays import Array
from tweezer.values.errors import SceneError, warn
from tweezer.values.printed import in_unit, printed
from tweezer.values.units import QuantitiesLike, QuantityLike, array_in_si, to_si
from tweezer.values.version import made_by, versions

if TYPE_CHECKING:
    import xarray as xr


#: How far into a wall a place may lie, in radii: as numbers are rounded
_ROUNDED = 1e-3


def light(scene: SceneLike) -> SceneLight:
    """Return the light of a scene, which can be evaluated at positions of the bead.

    Parameters
    ----------
    scene : Scene, str or mapping
        Scene with one or several beams.

    Returns
    -------
    SceneLight

    Examples
    --------
    >>> light = tweezer.light("silica-1um")
    >>> field = light.field([[0, 0, 0], [1e-7, 0, 0]])
    >>> bool(field.force.sel(axis="x")[1] < 0)  # towards the focus
    True
    """
    return SceneLight(heated(scene))


@dataclass(frozen=True)
class SceneLight:
    """Light of a scene on its bead. `tweezer.light` makes one."""

    scene: Scene
    """scene of the light"""

    def field(
        self,
        positions: QuantitiesLike,
        *,
        time: QuantityLike = 0.0,
        orientations: ArrayLike | None = None,
    ) -> xr.Dataset:
        """Return force, torque, gradient, error and absorbed power at positions of the bead.

        Parameters
        ----------
        positions : array_like, shape (..., 3)
            Positions of the bead from the focus, m, z along the light. Quantities with units are
            accepted.
        time : float or quantity, optional
            Time of beams that move or change, s.
        orientations : array_like, shape (..., 4), optional
            Euler parameters of the body, scalar first, from the body to the laboratory; one for
            each position or one for all. Default: those of the start.

        Returns
        -------
        xarray.Dataset
            Over `place`, or over `place_0`, `place_1` and so on for positions of more dimensions.
            If the positions are an xarray object whose last dimension is `axis`, as in a run, the
            result has the same dimensions and coordinates.

            * force: force of the light (3.26), N, over `axis`
            * torque: torque of the light about the bead's centre, N m, over `axis`
            * gradient: derivative of the force with respect to the position, N/m, over `axis` of
              the force and `along` of the position
            * force_error: error of the force, N; see `optical_force_error`
            * absorbed_power: power of the light that the bead absorbs, W

            The attribute `light_time` is `time`, s.

        Raises
        ------
        ValueError
            For positions of another shape, or that are not finite.
        SceneError
            Where the bead would be inside a wall or a cover glass.

        Warns
        -----
        PhysicsWarning
            If the quadrature misses its tolerance.
        """
        import xarray as xr

        places, time = self._places(positions), to_si(time, "s")
        turned = self._turned(places, orientations)
        wrench = self._wrench(places, time, turned, gradient=True)
        over, coordinates = before_axis(positions, places)
        described = {
            "force": (wrench.force, "N", "force of the light"),
            "torque": (wrench.moment, "N m", "torque of the light about the bead's centre"),
            "gradient": (wrench.force_gradient, "N/m", "derivative of the force over the position"),
            "force_error": (self._error(places, wrench, time), "N", "error of the force"),
            "absorbed_power": (
                self._absorbed(places, time, turned), "W",
                "power of the light that the bead absorbs",
            ),
        }  # fmt: skip
        variables = {
            name: variable(
                (*over, *("axis", "along")[: values.ndim - 1]),
                values.reshape(places.shape[:-1] + values.shape[1:]), *of,
            )
            for name, (values, *of) in described.items()
        }  # fmt: skip
        variables["force"] = with_error(variables["force"], "force_error")
        axes = np.array(["x", "y", "z"])
        coordinates |= {
            "position": variable((*over, "axis"), places, "m", "position of the bead's centre"),
            "axis": (("axis",), axes, {"long_name": "axis, z along the light"}),
            "along": (("along",), axes, {"long_name": "axis along which the position changes"}),
        }
        attributes = {
            "title": self.scene.title,
            "scene": self.scene.model_dump_json(exclude_none=True),
            "light_time": time,
            "force_evaluator": evaluators_of(self.scene),
            **versions(),
            **made_by("light", dated=True),
        }
        return xr.Dataset(variables, coordinates, attributes)

    @property
    def _force(self) -> LightForce | Beams:
        """Force of the light of the scene, of one beam or of several."""
        return light_force(self.scene)

    def _places(self, positions: QuantitiesLike) -> Array:
        """Return positions (..., 3) as an array in m.

        Raises `ValueError` for other arrays, and `SceneError` for positions in a wall of the scene.
        """
        labels: Any = getattr(positions, "coords", ())
        if "axis" in labels and list(labels["axis"].values) != ["x", "y", "z"]:
            raise ValueError("positions: the coordinate axis must be x, y, z in this order")
        try:
            array = np.ascontiguousarray(array_in_si(positions, "m"))
        except ValueError as error:
            raise ValueError(f"positions: {error}") from None
        if array.ndim == 0 or array.shape[-1] != 3:
            raise ValueError(f"positions must have the shape (..., 3), not {array.shape}")
        if not np.isfinite(array).all():
            raise ValueError("positions must be finite")
        _outside_walls(self.scene, array.reshape(-1, 3))
        return array

    def _turned(self, places: Array, orientations: ArrayLike | None) -> Array | None:
        """Return Euler parameters of length 1 for each position in a list, (n, 4), or None.

        Raises `ValueError` for other shapes, and for Euler parameters that are not finite or all 0.
        """
        if orientations is None and self.scene.bead.shape == "sphere":
            return None
        given = self.scene.start.orientation if orientations is None else orientations
        try:
            array = np.broadcast_to(np.asarray(given, np.float64), (*places.shape[:-1], 4))
        except (TypeError, ValueError):
            raise ValueError(
                "orientations must be numbers of the shape (4,) or (..., 4), as the positions"
            ) from None
        length = np.linalg.norm(array, axis=-1, keepdims=True)
        if not (np.isfinite(length) & (length > 0)).all():
            raise ValueError("orientations must be finite and not all 0")
        return np.ascontiguousarray(array / length).reshape(-1, 4)

    def _wrench(
        self, places: Array, time: float, turned: Array | None = None, *, gradient: bool = False
    ) -> Wrench:
        """Return force and torque at positions (..., 3), m, which are n in total.

        `time` is in s, and `turned` are Euler parameters (n, 4). If `gradient`, gradients are
        computed too. A warning is given if the error exceeds the tolerance. Raises `SceneError` for
        positions at which the force is not computed.
        """
        listed, force = places.reshape(-1, 3), self._force
        field = force.field(listed, gradient=gradient, time=time, orientations=turned)
        if (beyond := np.isinf(field.error)).any():
            far = float(np.linalg.norm(listed[beyond], axis=1).min())
            raise SceneError(
                f"positions = {far:.3g}: too far from the foci; light of several beams, or without "
                "an axis, is computed up to about 1.25 times simulation.loss_distance; increase it"
            )
        tolerance = self.scene.optics.tolerance
        doubtful = field.error > tolerance * np.linalg.norm(field.force, axis=1)
        if doubtful.any():
            allowed = _allowed_error(force, listed[doubtful], time)
            ratio = field.error[doubtful] / allowed
            if (missed := ratio > 1).any():
                warn(
                    f"the quadrature misses optics.tolerance = {tolerance:g} at {missed.sum()} of "
                    f"{len(listed)} positions: estimated errors are up to "
                    f"{ratio.max():.2g} times the allowed error",
                )
        return field

    def _error(self, places: Array, field: Wrench, time: float) -> Array:
        """Return the error of the force `field` at positions (..., 3), m, as a list (n,), N."""
        return self._force.error_of(places.reshape(-1, 3), field, time)

    def _absorbed(self, places: Array, time: float, turned: Array | None = None) -> Array:
        """Return the power that the bead absorbs at positions (..., 3), m, as a list (n,), W."""
        listed, force = places.reshape(-1, 3), self._force
        if self.scene.bead.shape != "sphere":
            from tweezer.optics.bodies.by_sums import absorbed_of

            assert turned is not None
            return absorbed_of(force, listed, turned, time)
        if isinstance(force, LightForce):
            return force.absorbed_power(listed)
        return force.absorbed_power(listed, time)


def before_axis(
    positions: QuantitiesLike, places: Array
) -> tuple[tuple[str, ...], dict[Hashable, Any]]:
    """Return the dimensions of positions (..., 3) before the last, and the coordinates along them.

    `positions` are as given; an xarray object with the last dimension "axis" keeps its dimensions.
    Otherwise the dimensions of the array `places`, m, are named `place`, or `place_0` and so on.
    """
    import xarray as xr

    if isinstance(positions, xr.DataArray) and positions.dims[-1] == "axis":
        over = tuple(map(str, positions.dims[:-1]))
        kept = {
            name: each.variable for name, each in positions.coords.items()
            if set(each.dims) <= set(over)
        }  # fmt: skip
        return over, kept
    if places.ndim == 2:
        return ("place",), {}
    return tuple(f"place_{number}" for number in range(places.ndim - 1)), {}


def optical_force(
    scene: SceneLike,
    positions: QuantitiesLike,
    orientations: ArrayLike | None = None,
    *,
    time: QuantityLike = 0.0,
) -> Array:
    """Return the force of the light on the bead (3.26).

    `optical_force_error` returns the errors.

    Parameters
    ----------
    scene : Scene, str or mapping
        Scene with one or several beams.
    positions : array_like, shape (..., 3)
        Positions of the bead from the focus, m, z along the light. Quantities with units are
        accepted.
    orientations : array_like, shape (..., 4), optional
        Euler parameters of the body, scalar first, from the body to the laboratory; one for each
        position or one for all. Default: those of the start.
    time : float or str, optional
        Time of beams that move or change, s.

    Returns
    -------
    ndarray, shape (..., 3)
        Force, N.

    Raises
    ------
    ValueError
        For positions of another shape, or that are not finite.
    SceneError
        Where the bead would be inside a wall or a cover glass.

    Warns
    -----
    PhysicsWarning
        If the quadrature misses its tolerance.

    Examples
    --------
    >>> force = tweezer.optical_force("silica-1um", [[1e-7, 0, 0], [-1e-7, 0, 0]])
    >>> bool(force[0, 0] < 0 < force[1, 0])  # towards the axis
    True
    """
    of = light(scene)
    places = of._places(positions)
    turned = of._turned(places, orientations)
    return of._wrench(places, to_si(time, "s"), turned).force.reshape(places.shape)


def optical_force_error(
    scene: SceneLike,
    positions: QuantitiesLike,
    orientations: ArrayLike | None = None,
    *,
    time: QuantityLike = 0.0,
) -> Array:
    """Return the error of the force of the light on the bead.

    It is the estimate of the quadrature, the certified bound of the force map, or the difference
    between the thesis's grid and the quadrature. The error of ray optics is not included.

    Parameters
    ----------
    scene : Scene, str or mapping
        Scene with one or several beams.
    positions : array_like, shape (..., 3)
        Positions of the bead from the focus, m.
    orientations : array_like, shape (..., 4), optional
        Euler parameters of the body, scalar first, from the body to the laboratory; one for each
        position or one for all. Default: those of the start.
    time : float or str, optional
        Time of beams that move or change, s.

    Returns
    -------
    ndarray, shape (...)
        Error, N.

    Raises
    ------
    ValueError, SceneError
        As `optical_force` does.
    """
    of = light(scene)
    places, time = of._places(positions), to_si(time, "s")
    turned = of._turned(places, orientations)
    field = of._force.field(places.reshape(-1, 3), time=time, orientations=turned)
    return of._error(places, field, time).reshape(places.shape[:-1])


def optical_jacobian(
    scene: SceneLike,
    positions: QuantitiesLike,
    orientations: ArrayLike | None = None,
    *,
    time: QuantityLike = 0.0,
) -> Array:
    """Return the derivative of the force with respect to the position.

    For a body that is not a sphere it is the derivative of force and torque over position and
    rotation. It is not symmetric, because the force of light has no potential.

    The sum over a grid of rays jumps where a ray begins or ceases to hit the bead. The derivative
    does not include these jumps.

    Parameters
    ----------
    scene : Scene, str or mapping
        Scene with one or several beams.
    positions : array_like, shape (..., 3)
        Positions of the bead from the focus, m.
    orientations : array_like, shape (..., 4), optional
        Euler parameters of the body, scalar first, from the body to the laboratory; one for each
        position or one for all. Default: those of the start.
    time : float or str, optional
        Time of beams that move or change, s.

    Returns
    -------
    ndarray, shape (..., 3, 3) or (..., 6, 6)
        Derivative, N/m, with [..., i, j] = dF_i/dx_j. For a body d(F, M)/d(position, angle), with
        angles of rotation about the laboratory's axes, in N/m, N, N and N m.

    Raises
    ------
    ValueError, SceneError
        As `optical_force` does.

    Examples
    --------
    >>> jacobian = tweezer.optical_jacobian("silica-1um", [0, 0, 0])
    >>> bool(-jacobian[0, 0] > 0)  # the light pulls the bead back to the axis
    True
    """
    of = light(scene)
    places = of._places(positions)
    if of.scene.bead.shape != "sphere":
        from tweezer.optics.bodies.by_sums import derivative_of

        turned = of._turned(places, orientations)
        assert turned is not None
        found = derivative_of(of._force, places.reshape(-1, 3), turned, to_si(time, "s"))
        return found.reshape((*places.shape[:-1], 6, 6))
    field = of._wrench(places, to_si(time, "s"), gradient=True)
    return field.force_gradient.reshape((*places.shape, 3))


def optical_torque(
    scene: SceneLike,
    positions: QuantitiesLike,
    orientations: ArrayLike | None = None,
    *,
    time: QuantityLike = 0.0,
) -> Array:
    """Return the torque of the light about the bead's centre, in the inertial frame.

    It is zero for a lossless sphere: every ray keeps its impact parameter, and every wave its
    angular momentum. An absorbing sphere takes up the angular momentum of the light that it
    absorbs. Bodies of other shapes are turned by scattering too. With `beam.torque = "thesis"` the
    result is the torque (3.25).

    Parameters
    ----------
    scene : Scene, str or mapping
        Scene with one or several beams.
    positions : array_like, shape (..., 3)
        Positions of the bead from the focus, m.
    orientations : array_like, shape (..., 4), optional
        Euler parameters of the body, scalar first, from the body to the laboratory; one for each
        position or one for all. Default: those of the start.
    time : float or str, optional
        Time of beams that move or change, s.

    Returns
    -------
    ndarray, shape (..., 3)
        Moment, N m.

    Raises
    ------
    ValueError, SceneError
        As `optical_force` does.
    """
    of = light(scene)
    places = of._places(positions)
    turned = of._turned(places, orientations)
    return of._wrench(places, to_si(time, "s"), turned).moment.reshape(places.shape)


def absorbed_power(
    scene: SceneLike,
    positions: QuantitiesLike,
    orientations: ArrayLike | None = None,
    *,
    time: QuantityLike = 0.0,
) -> Array:
    """Return the power of the light that the bead absorbs.

    It is zero unless an index is complex.

    Parameters
    ----------
    scene : Scene, str or mapping
        Scene with one or several beams.
    positions : array_like, shape (..., 3)
        Positions of the bead from the focus, m.
    orientations : array_like, shape (..., 4), optional
        Euler parameters of the body, scalar first, from the body to the laboratory; one for each
        position or one for all. Default: those of the start.
    time : float or str, optional
        Time of beams that move or change, s.

    Returns
    -------
    ndarray, shape (...)
        Power, W.

    Raises
    ------
    ValueError, SceneError
        As `optical_force` does.

    Examples
    --------
    >>> power = tweezer.absorbed_power("silica-1um", [0, 0, 0])
    >>> float(power)
    0.0
    """
    of = light(scene)
    places = of._places(positions)
    turned = of._turned(places, orientations)
    return of._absorbed(places, to_si(time, "s"), turned).reshape(places.shape[:-1])


def _outside_walls(scene: Scene, places: Array) -> None:
    """Raise `SceneError` for positions (n, 3) m at which the bead reaches into a wall or cover."""
    body, cover = scene.body, scene.lens.cover
    walls = faces(scene)
    if cover is not None:
        for beam in scene.beams:
            normal = 1.0 if beam.direction == "up" else -1.0
            walls[-normal * cover.depth] = normal, "cover glass"
    for z, (normal, name) in walls.items():
        inside = np.flatnonzero(normal * (places[:, 2] - z) < (1 - _ROUNDED) * body.support(normal))
        if inside.size:
            place = ", ".join(in_unit(each, "um") for each in places[inside[0]])
            raise SceneError(
                f"positions: at ({place}) um a bead of radius {printed(body.size, 'um')} reaches "
                f"into the {name} at z = {printed(z, 'um')}, where no force is known"
            )


def _allowed_error(force: LightForce | Beams, positions: Array, time: float) -> Array:
    """Return the error that the scene's tolerance allows at positions (n, 3) m, (n,) N.

    It is the sum over the beams. time: s.
    """
    if isinstance(force, LightForce):
        return force.allowed_error(force.field(positions).force)
    allowed = np.zeros(len(positions))
    for moved, each in zip(force.forces, force.lights, strict=True):
        if strength := abs(float(moved.strength.at(time)[0])):
            of_beam = moved.field(positions, time=time).force / strength
            allowed += strength * each.allowed_error(of_beam)
    return allowed
