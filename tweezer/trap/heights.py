"""Trap as a function of the height of its focus above a wall."""

from __future__ import annotations

import contextlib
import math
import warnings
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from tweezer.dynamics import Problem, bound_once
from tweezer.dynamics.layout import TRANSLATION
from tweezer.forces.equilibria import nearest_stable
from tweezer.optics import evaluators_of
from tweezer.optics.heat import heated
from tweezer.results.run import variable, with_error
from tweezer.scene import Scene, SceneLike, checked_scene
from tweezer.scene.arguments import numbers_in_si
from tweezer.scene.bead import bead_properties
from tweezer.trap.quantities import HELD, LOST, ON_RING, RESTS
from tweezer.trap.trap import pressed
from tweezer.values.arrays import Array
from tweezer.values.errors import PhysicsWarning, SceneError
from tweezer.values.units import WALL, QuantitiesLike
from tweezer.values.version import made_by, versions

if TYPE_CHECKING:
    import xarray as xr


#: Largest height of the focus, m
_HIGHEST = WALL[1]


def trap_over_heights(
    scene: SceneLike,
    heights: QuantitiesLike,
    *,
    progress: Callable[[float], None] | None = None,
) -> xr.Dataset:
    """Return the trap of `scene` with its nominal focus at each of `heights` from the wall.

    The wall is at `wall.side`, or below the bead by default. A second wall keeps its distance to
    the first. With `lens.cover` the wall is the face of the cover glass, and the light is computed
    again at each height, with the quadrature if the scene uses a map. The release position and
    fluid inertia have no effect.

    Parameters
    ----------
    scene : Scene, str or mapping
        Scene with one beam.
    heights : array_like, shape (n,)
        Distances of the focus from the wall, m. Quantities with units are accepted.
    progress : callable, optional
        Called with the completed fraction.

    Returns
    -------
    xarray.Dataset
        Over `height`, with vectors over `axis`. Numbers are NaN where the bead is not held.

        * equilibrium: stable equilibrium nearest the focus, relative to it, m
        * equilibrium_error: its error due to the error of the force, m
        * gap: gap between bead and wall at the equilibrium, m
        * stiffness: k_ii, N/m
        * drag: kg/s; `free_drag` is the drag far from the wall
        * corner_frequency: k_ii/(2 pi drag), Hz; NaN along an axis in which the bead oscillates
        * state: "held", "held on a ring" around the axis, "rests on the wall" if there is no
          equilibrium and the forces press the bead to the wall, or "not held"

        The attribute `status` is "complete", or "interrupted" if later heights are missing.

    Raises
    ------
    SceneError
        For invalid heights, and if the scene is not valid at one of them.

    Examples
    --------
    >>> trap = tweezer.trap_over_heights("silica-1um", ["2 um", "5 um"])
    >>> trap.state.values.tolist()
    ['held', 'held']
    """
    given = checked_heights(heights)
    scene = checked_scene(scene)
    scenes = [at_height(scene, height) for height in given]
    states: list[str] = []
    rows: list[dict[str, Any]] = []
    status = "complete"
    try:
        for each in scenes:
            with _said_once() if rows else contextlib.nullcontext():
                state, row = _trapped(bound_once(each))
            states.append(state)
            rows.append(row)
            if progress:
                progress(len(rows) / len(scenes))
    except KeyboardInterrupt:
        status = "interrupted"
    return _dataset(scene, given[: len(rows)], states, rows, status)


def checked_heights(heights: QuantitiesLike) -> Array:
    """Return `heights` as an array (n,), m; raise `SceneError` if any is not a valid height."""
    given = numbers_in_si("heights", heights, "m", SceneError)
    if given.ndim != 1 or not given.size:
        raise SceneError(f"heights: has the shape {given.shape}; must be a list of numbers")
    for height in given[~((given > 0) & (given <= _HIGHEST))]:
        raise SceneError(f"heights: {height:g} m: must be above 0, and at most {_HIGHEST:g} m")
    return given


def at_height(scene: SceneLike, height: float) -> Scene:
    """Return `scene` with its nominal focus at `height`, m, from the wall (`trap_over_heights`)."""
    scene = checked_scene(scene)
    wall = scene.wall
    normal = wall.normal if wall else 1.0
    position = -normal * height
    changes: dict[str, Any] = {"wall": {"position": position}}
    if wall is not None and wall.opposite is not None:
        changes["wall"]["opposite"] = position + wall.opposite - wall.position
    if scene.lens.cover is not None:
        changes["lens"] = {"cover": {"depth": height}}
        if scene.optics.evaluator == "map":
            changes["optics"] = {"evaluator": "quadrature"}
    # distance of the release position from the focus, away from the wall, so that the bead is free
    room = max(0.0, 2 * scene.body.size - height)
    changes["start"] = {
        "frame": "focus", "position": (0.0, 0.0, normal * room), "drawn": "no", "ball_radius": None,
    }  # fmt: skip
    changes["medium"] = {"inertia": "none", "poles": None}
    return scene.decided(**changes)


def _said_once() -> contextlib.AbstractContextManager[object]:
    """Return a context that suppresses the warning about ray optics, the same at every height."""
    return warnings.catch_warnings(action="ignore", category=PhysicsWarning)


def _trapped(problem: Problem) -> tuple[str, dict[str, Any]]:
    """Return the state of the bead at one height, and its variables by name, in SI units.

    The state is one of the texts listed in `trap_over_heights`. There are no variables unless the
    bead is held.
    """
    place = nearest_stable(problem.equilibria(problem.net_force_apart))
    if place is None:
        if problem.rings(problem.net_force_apart):
            return ON_RING, {}
        return RESTS if pressed(problem) else LOST, {}
    points = np.array([place.position])
    drag = 1 / problem.mobilities(points)[0, TRANSLATION]
    stiffness = place.stiffness_xyz
    light = problem.light.field(points)
    error = float(problem.light.error_of(points, light)[0])
    return HELD, {
        "equilibrium": place.position,
        "equilibrium_error": error / place.eigenvalues[0],
        "gap": problem.scene.gap(place.position[2]),
        "stiffness": stiffness,
        "drag": drag,
        "corner_frequency": problem.linear.resonances(stiffness, 1 / drag).corner_frequencies,
    }


def _dataset(
    scene: Scene, heights: Array, states: list[str], rows: list[dict[str, Any]], status: str
) -> xr.Dataset:
    """Return the dataset of `trap_over_heights` from the results at each height.

    `heights` (n,), m, `states` and `rows` (the variables by name) have one entry for each height.
    """
    import xarray as xr

    def column(name: str, like: Any) -> Array:
        """Return a variable at all heights, with `like`, NaN or a vector of NaN, where missing."""
        return np.array([row.get(name, like) for row in rows]).reshape(-1, *np.shape(like))

    vector = {
        "equilibrium": ("m", "equilibrium relative to the focus"),
        "stiffness": ("N/m", "stiffness at the equilibrium"),
        "drag": ("kg/s", "drag at the equilibrium"),
        "corner_frequency": ("Hz", "corner frequency at the equilibrium"),
    }
    number = {
        "equilibrium_error": ("m", "error of the equilibrium, by that of the force"),
        "gap": ("m", "distance of the bead's surface from the wall at the equilibrium"),
    }
    far = bead_properties(heated(scene))
    variables = {
        **{
            name: variable(("height", "axis"), column(name, [math.nan] * 3), *of)
            for name, of in vector.items()
        },
        **{name: variable(("height",), column(name, math.nan), *of) for name, of in number.items()},
        "state": (("height",), np.array(states, dtype=str), {"long_name": "what becomes of it"}),
        "free_drag": variable((), np.array(far.drag), "kg/s", "drag far away"),
    }
    coordinates = {
        "height": variable(("height",), heights, "m", "height of the nominal focus over the wall"),
        "axis": (("axis",), np.array(["x", "y", "z"]), {"long_name": "axis, z along the light"}),
    }
    attributes = {
        "title": scene.title,
        "scene": scene.model_dump_json(exclude_none=True),
        "status": status,
        "force_evaluator": evaluators_of(at_height(scene, float(heights[0]))) if len(rows) else "",
        **versions(),
        **made_by("trap_over_heights", dated=True),
    }
    variables["equilibrium"] = with_error(variables["equilibrium"], "equilibrium_error")
    return xr.Dataset(variables, coordinates, attributes)
