"""Optical binding: the force on several beads by the light that they scatter onto each other."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from tweezer.optics.binding import light_force, paths_of_light
from tweezer.optics.bodies.mutual import Shells, Spheres, scattered_force
from tweezer.results.run import variable
from tweezer.scene import Scene, SceneLike, checked_scene
from tweezer.scene.interference import groups
from tweezer.scene.several import pairs
from tweezer.values.arrays import Array
from tweezer.values.errors import SceneError
from tweezer.values.printed import printed
from tweezer.values.units import QuantitiesLike, array_in_si
from tweezer.values.version import made_by, versions

if TYPE_CHECKING:
    import xarray as xr

    from tweezer.optics.waves.amplitudes import Path

#: Largest error that is reported, over the largest force by mutual scattering
_TRUSTED = 0.02
#: Highest degree of partial waves for the attribute of runs
_MOST = 45
#: Error that is always reported, as a part of n_m P/c
_NOTHING = 1e-9


def optical_binding(scene: SceneLike, positions: QuantitiesLike | None = None) -> xr.Dataset:
    r"""Return the force on several beads by the light that they scatter onto each other.

    With the amplitudes p_j of the light about bead j, the bead scatters the partial waves

    .. math:: t_j = T_j \left(p_j + \tfrac12 \sum_{i \ne j} H(r_j - r_i)\, t_i\right),

    where H translates outgoing waves from one bead to the next. The force is n_m P/c times
    <p|s|p> - <q|s|q>, with the incoming light p, the outgoing light q = p + t and the direction s.
    Runs leave mutual scattering out. Those of two beads contain its largest force at the beginning
    in the attribute `optical_binding`.

    Parameters
    ----------
    scene : Scene, str or mapping
        Scene with several spheres, in wave optics. Beams of one `beam.coherent` group interfere;
        the forces of other beams are added. Beams that move or change are as at the beginning.
    positions : array_like, shape (beads, 3), optional
        Positions of the beads, m. Quantities with units are accepted. Default: their starts.

    Returns
    -------
    xarray.Dataset
        Over `bead`, the names of the beads:

        * force: force of all beams without mutual scattering, N, over `axis`
        * scattered: additional force by mutual scattering, N, over `axis`
        * error: error of `force` plus that of `scattered`, N
        * displacement: `scattered` over the stiffness of the light at the position, m, over
          `axis`. It is NaN where this light does not trap the bead.

        The attribute `degree` is the highest degree of the partial waves about a bead.

    Raises
    ------
    ValueError
        For positions of another shape, or that are not finite.
    SceneError
        For a single bead, for ray optics, for beads that overlap, and where the force does not
        converge, as for beads of high index near contact.

    Notes
    -----
    Scattering of all orders is included. The degree is raised until the force converges, and the
    error follows from its last changes.

    References
    ----------
    K. Dholakia and P. Zemanek, Rev. Mod. Phys. 82, 1767 (2010).
    """
    import xarray as xr

    scene = checked_scene(scene, several=True)
    places = _places(scene, positions)
    scattered, error, degree = _scattered(scene, places)
    force, stiffness, uncertain = _without(scene, places)
    displacement = np.full_like(force, np.nan)
    for of_bead, f, K in zip(displacement, scattered, stiffness, strict=True):
        if np.linalg.eigvals(K).real.min() > 0:
            of_bead[:] = np.linalg.solve(K, f)
    over = ("bead", "axis")
    variables = {
        "force": variable(over, force, "N", "force of the light without mutual scattering"),
        "scattered": variable(over, scattered, "N", "additional force by mutual scattering"),
        "error": variable(("bead",), error + uncertain, "N", "error of both forces"),
        "displacement": variable(
            over, displacement, "m", "displacement by mutual scattering in the trap"
        ),
    }
    coordinates = {
        "bead": (("bead",), np.array(scene.bead_names), {"long_name": "name of the bead"}),
        "axis": (("axis",), np.array(["x", "y", "z"]), {"long_name": "axis of the laboratory"}),
        "position": variable(over, places, "m", "position of the bead"),
    }
    attributes = {
        "title": scene.title,
        "scene": scene.model_dump_json(exclude_none=True),
        "degree": degree,
        **versions(),
        **made_by("optical_binding", dated=True),
    }
    return xr.Dataset(variables, coordinates, attributes)


def _places(scene: Scene, positions: QuantitiesLike | None) -> Array:
    """Return the positions of the beads, (beads, 3) m; refuse scenes and positions."""
    beads = scene.beads
    if len(beads) < 2:
        raise SceneError("bead: optical binding requires several beads; add a [[bead]]")
    if not scene.lit:
        raise SceneError("forces.optical: optical binding requires light; add a beam")
    if any(scene.alone(number).theory == "rays" for number in range(1, len(beads) + 1)):
        raise SceneError(
            "optics.theory = 'rays': has no optical binding; set optics.theory = 'waves'"
        )
    if positions is None:
        return np.array([each.start for each in beads], dtype=float)
    places = array_in_si(positions, "m")
    if places.shape != (len(beads), 3) or not np.isfinite(places).all():
        raise ValueError(
            f"positions must be finite and have the shape ({len(beads)}, 3), a row for each bead"
        )
    for i, j in pairs(len(beads)):
        gap = math.dist(places[i], places[j]) - beads[i].radius - beads[j].radius
        if not gap > 0:
            raise SceneError(
                f"positions[{j}] = {places[j].tolist()}: bead {j + 1} overlaps bead {i + 1} by "
                f"{printed(-gap, 'nm')}; must be farther away"
            )
    return places


def _without(scene: Scene, places: Array) -> tuple[Array, Array, Array]:
    """Return the light's force (beads, 3) N, stiffness (beads, 3, 3) N/m and error (beads,) N."""
    exact = scene.decided(optics={"evaluator": "quadrature"})
    force, stiffness, error = [], [], []
    for number, place in enumerate(places[:, None], start=1):
        light = light_force(exact.alone(number))
        field = light.field(place, gradient=True)
        force.append(field.force[0])
        stiffness.append(-field.force_gradient[0])
        error.append(light.error_of(place, field)[0])
    return np.array(force), np.array(stiffness), np.array(error)


def _scattered(scene: Scene, places: Array, **limits: float) -> tuple[Array, Array, int]:
    """Return the force by mutual scattering (beads, 3) N, its error (beads,) N, and the degree.

    limits: error and degree at which the series ends, see `scattered_force`. Raises `SceneError` if
    the force does not converge.
    """
    alone = [scene.alone(number) for number in range(1, len(places) + 1)]
    found: dict[tuple[float, tuple[Shells, ...]], list[tuple[Path, ...]]] = {}
    for group in groups(scene):
        each_bead = [paths_of_light(each, group) for each in alone]
        if each_bead[0]:
            shells = tuple(paths[0].light.shells for paths in each_bead)
            found.setdefault((each_bead[0][0].light.wavenumber, shells), []).append(each_bead[0])
    lights = [Spheres(tuple(paths), shells, places) for (_, shells), paths in found.items()]
    force, error, degree = scattered_force(lights, **limits)
    largest = float(np.linalg.norm(force, axis=1).max())
    strength = sum(each.strength for each in lights)
    if not error.max() <= max(_TRUSTED * largest, _NOTHING * strength):
        raise SceneError(
            f"positions: the force by mutual scattering is {printed(largest, 'pN')} with an error "
            f"of {printed(float(error.max()), 'pN')}; allowed: {_TRUSTED:.0%}; increase the gap"
        )
    return force, error, degree


def largest_scattered(scene: Scene, places: Array) -> float:
    """Return the largest force by mutual scattering on one of two beads, within 2 %, N.

    places: (beads, 3) m. It is NaN for more beads, for ray optics, and where waves up to the degree
    45 do not suffice, which bounds the time.
    """
    if not scene.lit:
        return 0.0
    if len(places) > 2 or any(scene.alone(number).theory == "rays" for number in (1, 2)):
        return math.nan
    try:
        force, _, _ = _scattered(scene, places, wanted=_TRUSTED, most=_MOST)
    except SceneError:
        return math.nan
    return float(np.linalg.norm(force, axis=1).max())
