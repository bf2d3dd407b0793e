"""Displacement, relaxation and spectrum of a bead in its medium, without a simulation."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from tweezer.dynamics import Problem, bound_once
from tweezer.fluid import Network, network_of
from tweezer.results.run import Run, Variable, variable
from tweezer.scene import SceneLike
from tweezer.scene.choices import MODELS
from tweezer.values.arrays import Array
from tweezer.values.constants import Boltzmann
from tweezer.values.errors import SceneError
from tweezer.values.units import QuantityLike, array_in_si
from tweezer.values.version import made_by, versions

if TYPE_CHECKING:
    import xarray as xr

#: Times, s, and frequencies, Hz, if none are given
_TIMES, _FREQUENCIES = np.geomspace(1e-7, 10, 161), np.geomspace(0.1, 1e6, 141)
#: Relative errors: of a finite network, of a power law within its band, and of the fluid's inertia
#: in water and beside relaxing elements
_FINITE, _POWER_LAW, _IN_WATER, _INERTIA = 1e-9, 1e-4, 5e-4, 3e-3


def response(
    scene: SceneLike,
    times: QuantityLike | None = None,
    frequencies: QuantityLike | None = None,
) -> xr.Dataset:
    """Return how a bead moves thermally in its medium, free and in its trap.

    The drag is a network of elements: the solvent, the relaxing elements and elasticity of the
    medium, and the inertia of bead and fluid (`medium.inertia`, by default included in the model
    `full`). The trap is the stiffness along each axis at the stable equilibrium nearest the focus;
    coupling of the axes is left out. Without an equilibrium, the bead is free.

    Parameters
    ----------
    scene : Scene, str or mapping
        Scene of a sphere without walls.
    times : array_like, optional
        Times above 0, s. Default: 161 from 0.1 us to 10 s.
    frequencies : array_like, optional
        Frequencies above 0, Hz. Default: 141 from 0.1 Hz to 1 MHz.

    Returns
    -------
    xarray.Dataset
        Along `time`, `frequency` and `axis`:

        * msd_free (time): mean squared displacement along an axis without light, m^2
        * msd (time, axis): in the trap, m^2
        * relaxation (time, axis): autocovariance of the position over its variance; NaN if free
        * spectrum (frequency, axis): one-sided power spectral density of the position, m^2/Hz
        * vacf (time, axis): velocity autocovariance, m^2/s^2; without inertia it lacks the part
          that is proportional to delta(t)

        Each has the attribute `relative_error`, a bound of its relative error (of `relaxation`
        and `vacf` relative to the largest value). For a power law it applies within the band.

    Raises
    ------
    SceneError
        For a body that is not a sphere, a scene with walls, and times or frequencies that are not
        above 0.

    Examples
    --------
    >>> found = tweezer.response("silica-1um", times=[1e-4], frequencies=[10.0])
    >>> 0 < found.relaxation.sel(axis="x").item() < 1
    True
    """
    problem = bound_once(scene)
    scene = problem.scene
    if problem.body is not None or scene.wall is not None:
        key = "wall" if scene.wall is not None else "bead.shape"
        raise SceneError(f"{key}: the response is known for spheres far from walls; remove {key}")
    t = _above_zero("times", times, "s", _TIMES)
    f = _above_zero("frequencies", frequencies, "Hz", _FREQUENCIES)
    network, error = _network(problem)
    kT = Boltzmann * scene.noise_temperature
    trap = problem.equilibrium if scene.lit else None
    gel = sum(each.stiffness for each in problem.elastic)
    held = np.full(3, gel) if trap is None else np.diag(trap.stiffness)

    def along(function: Callable[[float], Array]) -> Array:
        """Return a function of the stiffness, N/m, for the three axes, (n, 3)."""
        return np.array([function(float(each)) for each in held]).T

    still = held.min() > 0
    relaxation = np.full((len(t), 3), np.nan)
    if still:
        relaxation = along(lambda k: network.relaxation(k).at(t))
    both, axes = ("time", "axis"), np.array(["x", "y", "z"])
    variables: dict[str, Variable] = {
        "msd_free": variable(
            ("time",), network.displacement(t, kT, gel), "m^2",
            "mean squared displacement along an axis, free",
        ),
        "msd": variable(
            both, along(lambda k: network.displacement(t, kT, k)), "m^2",
            "mean squared displacement in the trap",
        ),
        "relaxation": variable(both, relaxation, "1", "autocovariance over variance"),
        "spectrum": variable(
            ("frequency", "axis"), along(lambda k: network.spectrum(f, kT, k)), "m^2/Hz",
            "one-sided power spectral density of the position",
        ),
        "vacf": variable(
            both, along(lambda k: network.velocity(t, kT, k)), "m^2/s^2",
            "velocity autocovariance",
        ),
    }  # fmt: skip
    for each in variables.values():
        each[2]["relative_error"] = error
    coordinates: dict[str, Variable] = {
        "time": variable(("time",), t, "s", "time"),
        "frequency": variable(("frequency",), f, "Hz", "frequency"),
        "axis": (("axis",), axes, {"long_name": "axis, z along the light"}),
    }
    about: dict[str, Any] = {
        "title": scene.title, "scene": scene.model_dump_json(exclude_none=True),
        "trapped": int(bool(still and trap is not None)), **versions(),
        **made_by("response", dated=True),
    }  # fmt: skip
    return Run(coordinates, variables, about).dataset()


def _network(problem: Problem) -> tuple[Network, float]:
    """Return the network of a bead in its medium, and a bound of its relative error."""
    scene, medium = problem.scene, problem.scene.medium
    inertial = MODELS[scene.simulation.model or "full"].inertia
    fluid = medium.inertia or ("none" if scene.rarefied or not inertial else "memory")
    whole = dataclasses.replace(problem, scene=scene.decided(medium={"inertia": fluid}))
    found = network_of(
        scene, mass=whole.effective_mass if inertial else 0.0, drag=problem.bead.drag,
        inertia=fluid == "memory",
    )  # fmt: skip
    error = _POWER_LAW if medium.power_law else _FINITE
    if fluid == "memory":
        error = _INERTIA if medium.relaxes else _IN_WATER
    return found, error


def _above_zero(name: str, values: Any, unit: str, default: Array) -> Array:
    """Return values (n,) in an SI unit, which must be finite and above 0."""
    if values is None:
        return default
    try:
        found = np.atleast_1d(array_in_si(values, unit))
    except ValueError as error:
        raise SceneError(f"{name}: {error}") from None
    if found.ndim != 1 or not len(found) or not (np.isfinite(found) & (found > 0)).all():
        raise SceneError(f"{name}: must be a list of finite numbers above 0 {unit}")
    return found
