"""The page of a trap: the force on its bead in movable slices, and the escape directions."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from scipy.ndimage import map_coordinates, maximum_filter, spline_filter1d

from tweezer.dynamics import Problem, bound_once
from tweezer.optics import Beams
from tweezer.optics.heat import heated
from tweezer.optics.light import LightForce
from tweezer.scene.heading import heading, of_changes
from tweezer.trap import Escape, Trap
from tweezer.trap.quantities import LIFETIME, POWER
from tweezer.values.arrays import Array
from tweezer.values.constants import Boltzmann
from tweezer.viewing.arrays import float32
from tweezer.viewing.content import Content, Row
from tweezer.viewing.rows import of_number, si
from tweezer.viewing.setting import of_the_picture, scene_facts
from tweezer.viewing.surroundings import of_the_medium

#: Number of nodes of a force table at each angle about the axis
_NODES = 10_000
#: Number of nodes beyond the edges of a table, so that its unknown surroundings do not affect it
_BEYOND = 8
#: Angles about the axis at which light without axial symmetry is computed
_ANGLES = (0.0, math.pi / 3, 2 * math.pi / 3)
#: Another angle, at which the table is compared with the computed force, rad
_BETWEEN = 0.4
#: Number of positions at which the tables are compared with the force that they approximate
_COMPARED = 2000
#: Largest error of such a table, as a part of the largest force, for which it is used
_ROUGH = 0.02
#: Number of nodes of a table over x, y and z, and number beyond each of its edges
_NODES_OF_BOX, _BEYOND_BOX = 120_000, 5
#: Number of cells to each side of a block for which the error of such a table is given
_BLOCK = 6
#: Largest distance from the origin that is shown, in bead radii beyond the farthest focus
_WIDEST = 20.0
#: Number of evenly spaced heights at which wall forces are tabulated, and of heights near each wall
_HEIGHTS = 400
#: Smallest gap to a wall in such a table, m
_CLOSEST = 1e-10


@dataclass(frozen=True)
class _Box:
    """The region that the page shows: |x| and |y| up to `across`, z from `low` to `high`, m.

    It uses the coordinates of the scene.
    """

    across: float
    low: float
    high: float


@dataclass(frozen=True)
class _Table:
    """Optical force of one beam, relative to its focus, as a table of cubic B-splines.

    In cylindrical coordinates about the axis (distance rho, angle phi, height z) each component of
    the force is a + b cos(2 phi) + c sin(2 phi), where a, b and c depend on rho and z. The reason
    is that the force is quadratic in the Jones vector of the light, a sum of two circular
    polarisations. Each polarisation alone gives a force independent of phi, and their product a
    term in 2 phi. For light that is symmetric about its axis, b and c vanish.
    """

    coefficients: Array
    """(1 or 3, component, z, rho) spline coefficients, N, of a, and of b and c unless they vanish;
    the components are radial, azimuthal and along z"""
    step: float
    """distance between neighbouring nodes in rho and in z, m"""
    low: float
    """z of the first node, m; the rho of the first node is `-step`"""
    errors: Array
    """(z, rho) deviation of the splines from the force at the centre of each cell between nodes, N,
    as the largest of a cell and its eight neighbours; the first cell begins at rho = 0 and
    z = `low + step`"""

    def force(self, places: Array) -> Array:
        """Return the force (n, 3), N, from the splines, at positions (n, 3) relative to the focus,
        m.
        """
        rho, angle = np.hypot(places[:, 0], places[:, 1]), np.arctan2(places[:, 1], places[:, 0])
        at = np.array([(places[:, 2] - self.low) / self.step, rho / self.step + 1])
        turns = np.array([np.ones_like(angle), np.cos(2 * angle), np.sin(2 * angle)])
        about = [
            sum(
                turn * map_coordinates(part[component], at, order=3, prefilter=False)
                for turn, part in zip(turns, self.coefficients, strict=False)
            )
            for component in range(3)
        ]
        cosine, sine = np.cos(angle), np.sin(angle)
        return np.stack(
            [cosine * about[0] - sine * about[1], sine * about[0] + cosine * about[1], about[2]],
            axis=1,
        )


@dataclass(frozen=True)
class _Grid:
    """Optical force of light without an axis, relative to its focus, as a table over x, y and z."""

    coefficients: Array
    """(component, z, y, x) coefficients of cubic B-splines, N"""
    step: float
    """distance between neighbouring nodes, m"""
    low: Array
    """(3,) position x, y, z of the first node, m"""
    errors: Array
    """(z, y, x) largest deviation found in blocks of `_BLOCK` cells to each side, N"""

    def force(self, places: Array) -> Array:
        """Return the force (n, 3), N, at positions (n, 3) relative to the focus, m."""
        at = ((places - self.low) / self.step).T[::-1]
        return np.stack([
            map_coordinates(part, at, order=3, prefilter=False) for part in self.coefficients
        ], axis=1)  # fmt: skip


@dataclass(frozen=True)
class _Placed:
    """One beam of the scene at time 0: focus, power, direction, and the force of its light."""

    focus: Array
    """(3,) position of the focus, m"""
    factor: float
    """ratio of the power, and so of the force, at time 0 to that of `light`"""
    down: bool
    """whether the beam propagates along -z, being rotated by 180 degrees about x"""
    light: LightForce
    """optical force relative to the focus, for propagation along +z"""

    @property
    def turn(self) -> Array:
        """Signs (3,) that convert vectors from the axes of the scene to those of the beam."""
        return np.array([1.0, -1.0, -1.0]) if self.down else np.ones(3)

    def within(self, places: Array) -> Array:
        """Return positions (n, 3), m, of the scene relative to the focus, along the beam's axes."""
        return self.turn * (places - self.focus)


def content(trap: Trap) -> Content:
    """Return the content of the page of a trap.

    The page interpolates forces in a box around the trap from tables, which are computed here.
    """
    trap.check_scene_alone("the page of a trap")
    problem = bound_once(trap.scene)
    scene = problem.scene
    box = _box(trap, problem)
    lights = _placed(problem)
    tables = _tables(lights, box)
    numbers = {identity: i for i, identity in enumerate(tables)}
    heights, of_walls = _of_walls(problem, box)
    compared = _compared(problem, box, lights, tables, (heights, of_walls))
    centre = trap.equilibrium.position if trap.equilibrium else (0.0, 0.0, 0.0)
    arrays = {}
    for i, each in enumerate(tables.values()):
        arrays[f"table_{i}"] = float32(each.coefficients, "N")
        arrays[f"errors_{i}"] = float32(each.errors, "N")
    if heights.size:
        arrays |= {"heights": float32(heights, "m"), "wall_force": float32(of_walls, "N")}
    return Content(
        kind="trap",
        title=heading(scene, scene.title),
        facts={
            **scene_facts(scene),
            "box": {"across": box.across, "low": box.low, "high": box.high},
            "lights": [
                {"focus": each.focus.tolist(), "factor": each.factor, "down": each.down,
                 "table": numbers[id(each.light)]}
                for each in lights
            ],
            "tables": [
                {"step": each.step, "low": np.asarray(each.low).tolist(), "block": _BLOCK}
                for each in tables.values()
            ],
            "weight": list(problem.bead.weight),
            "centre": list(centre),
            "held": trap.equilibrium is not None,
            "equilibria": [
                {"position": list(each.position), "stable": each.stable}
                for each in trap.equilibria
            ],
            "escapes": [_escape(each) for each in trap.escapes],
            "thermal": Boltzmann * scene.noise_temperature,
            "largest": compared.largest,
        },
        arrays=arrays,
        summary=_summary(trap),
        notes=[*of_changes(scene), *_notes(trap, compared), *of_the_picture(scene)],
    )  # fmt: skip


def _escape(escape: Escape) -> dict[str, Any]:
    """Return an escape direction, with its force, energy and range, as a JSON object."""
    return {
        "direction": escape.direction,
        "force": escape.force,
        "force_at": escape.force_at,
        "range": escape.range,
        "wall_at": escape.wall_at,
        "energy_kT": escape.energy_kT,
    }


def _box(trap: Trap, problem: Problem) -> _Box:
    """Return the region to show: 3.5 bead radii around every focus, and more for a wide trap.

    It contains nearby equilibria and escape paths, and ends where the bead touches a wall.
    """
    scene, r = trap.scene, trap.scene.body.size
    foci = problem.foci()
    centre = np.array(trap.equilibrium.position if trap.equilibrium else foci[0])
    shown = np.vstack([foci, centre])
    pulls = {way: [each.force_at for each in trap.escapes if each.direction[1] in way]
             for way in ("xy", "z")}  # fmt: skip
    margin = {way: max(3.5 * r, 2.0 * max(found, default=0.0)) for way, found in pulls.items()}
    across = float(np.abs(shown[:, :2]).max()) + margin["xy"]
    ends = [z for each in trap.equilibria if abs(z := each.position[2]) < _WIDEST * r]
    ends += [centre[2] + (1 if each.direction == "+z" else -1) * each.range
             for each in trap.escapes if each.range and each.direction[1] == "z"]  # fmt: skip
    ends = [1.15 * z for z in ends if abs(z) < max(_WIDEST * r, margin["z"])]
    low = min(*shown[:, 2] - margin["z"], *ends)
    high = max(*shown[:, 2] + margin["z"], *ends)
    if scene.wall is not None:
        for plane, normal in scene.wall.planes:
            touching = plane + normal * r
            low, high = (max(low, touching), high) if normal > 0 else (low, min(high, touching))
    return _Box(across, float(low), float(high))


def _placed(problem: Problem) -> list[_Placed]:
    """Return the beams of the scene at time 0, each with a smooth evaluator of the force."""
    light = problem.light
    if not problem.scene.lit:
        return []
    if not isinstance(light, Beams):
        return [_Placed(np.zeros(3), 1.0, down=False, light=light.certain())]
    smooth = {id(each): each.certain() for each in light.lights}
    return [
        _Placed(each.place.at(0.0), float(each.strength.at(0.0)[0]), each.down, smooth[id(own)])
        for each, own in zip(light.forces, light.lights, strict=True)
    ]


def _tables(lights: list[_Placed], box: _Box) -> dict[int, _Table | _Grid]:
    """Return the force tables by the `id` of their light; beams with the same light share one.

    Light whose force depends on the angle in another way than `_Table` describes gets a `_Grid`.
    """
    if not lights:
        return {}
    reach = math.sqrt(2) * box.across + max(float(np.hypot(*each.focus[:2])) for each in lights)
    corners = np.array([[0.0, 0.0, box.low], [0.0, 0.0, box.high]])
    ends = np.array([each.within(corners)[:, 2] for each in lights])
    found: dict[int, _Table | _Grid] = {}
    for light in {id(each.light): each.light for each in lights}.values():
        table = _table(light, reach, float(ends.min()), float(ends.max()))
        found[id(light)] = table
        if table.errors.max() > _ROUGH * np.abs(table.coefficients).max():
            edges = box.across * np.array([-1.0, 1.0])
            x, y, z = np.meshgrid(edges, edges, [box.low, box.high])
            corners = np.stack([x, y, z], axis=-1).reshape(-1, 3)
            within = np.concatenate([
                each.within(corners) for each in lights if each.light is light
            ])  # fmt: skip
            found[id(light)] = _grid(light, within.min(axis=0), within.max(axis=0))
    return found


def _grid(light: LightForce, low: Array, high: Array) -> _Grid:
    """Tabulate the force of light without an axis in a box, from the corner `low` to `high`, m.

    There are about `_NODES_OF_BOX` nodes, and some beyond the edges. The force at random positions
    gives the errors.
    """
    step = float((np.prod(high - low) / _NODES_OF_BOX) ** (1 / 3))
    counts = np.ceil((high - low) / step).astype(int) + 1 + 2 * _BEYOND_BOX
    first = low - _BEYOND_BOX * step
    x, y, z = (start + step * np.arange(count) for start, count in zip(first, counts, strict=True))
    places = np.stack(np.meshgrid(z, y, x, indexing="ij")[::-1], axis=-1).reshape(-1, 3)
    values = light.field(places).force.T.reshape(3, z.size, y.size, x.size)
    for axis in (1, 2, 3):
        values = spline_filter1d(values, order=3, axis=axis, mode="mirror")
    inside = slice(_BEYOND_BOX - 1, 1 - _BEYOND_BOX)
    kept = values[:, inside, inside, inside]
    table = _Grid(kept, step, first + (_BEYOND_BOX - 1) * step, np.zeros(0))
    random = np.random.default_rng(0).uniform(low, high, (_NODES_OF_BOX // 4, 3))
    off = np.linalg.norm(table.force(random) - light.field(random).force, axis=1)
    block = ((random - table.low) / (step * _BLOCK)).astype(int).T[::-1]
    errors = np.zeros([-(-size // _BLOCK) for size in kept.shape[1:]])
    np.maximum.at(errors, tuple(block), off)
    return dataclasses.replace(table, errors=maximum_filter(errors, 3))


def _table(light: LightForce, reach: float, low: float, high: float) -> _Table:
    """Tabulate the force of a light up to distance `reach` from its axis, from z = `low` to `high`,
    m.

    There are about 10,000 nodes for each angle phi about the axis, and some beyond the edges. Light
    that is symmetric needs one angle, other light three, from which a, b and c of `_Table` follow.
    The force at the centre of each cell, at another angle, then gives the errors of the table.
    """
    step = math.sqrt(reach * (high - low) / _NODES)  # about _NODES cells fill the area
    rho = step * np.arange(math.ceil(reach / step) + 1 + _BEYOND)
    z = low + step * np.arange(-_BEYOND, math.ceil((high - low) / step) + 1 + _BEYOND)
    angles = np.array(_ANGLES[:1] if light.symmetric else _ANGLES)
    along, across = np.meshgrid(z, rho, indexing="ij")
    turned = []
    for angle in angles:
        cosine, sine = math.cos(angle), math.sin(angle)
        places = np.stack([cosine * across, sine * across, along], axis=-1).reshape(-1, 3)
        force = light.field(places).force.reshape(z.size, rho.size, 3)
        x, y = force[..., 0], force[..., 1]
        turned.append([cosine * x + sine * y, cosine * y - sine * x, force[..., 2]])
    at_angles = np.array(turned)
    # a, b and c of `_Table` as Fourier coefficients: at 0, 60 and 120 degrees, cos(2 phi) and
    # sin(2 phi) are orthogonal and have the mean 0
    parts = [at_angles.mean(axis=0)]
    if angles.size > 1:
        parts += [2 * np.tensordot(turn(2 * angles), at_angles, 1) / angles.size
                  for turn in (np.cos, np.sin)]  # fmt: skip
    values = np.array(parts)
    # The nodes at rho < 0 are those at |rho| after half a turn about the axis: radial and azimuthal
    # components change sign, cos and sin of 2 phi do not. Splines are then smooth across the axis.
    sign = np.array([-1.0, -1.0, 1.0])[:, None, None]
    whole = np.concatenate([sign * values[..., :0:-1], values], axis=-1)
    for axis in (-2, -1):
        whole = spline_filter1d(whole, order=3, axis=axis, mode="mirror")
    # coefficients for the cells within the edges: a cell of cubic splines needs one more node on
    # each side
    kept = slice(_BEYOND - 1, 3 - _BEYOND), slice(rho.size - 2, 3 - _BEYOND)
    table = _Table(whole[..., *kept], step, float(z[_BEYOND - 1]), np.zeros(0))
    cells = [step * (np.arange(size - 3) + 0.5) for size in table.coefficients.shape[2:]]
    along, across = np.meshgrid(table.low + step + cells[0], cells[1], indexing="ij")
    cosine, sine = math.cos(_BETWEEN), math.sin(_BETWEEN)
    places = np.stack([cosine * across, sine * across, along], axis=-1).reshape(-1, 3)
    off = np.linalg.norm(table.force(places) - light.field(places).force, axis=1)
    return dataclasses.replace(table, errors=maximum_filter(off.reshape(along.shape), 3))


def _of_walls(problem: Problem, box: _Box) -> tuple[Array, Array]:
    """Return the force of walls on the bead (such as DLVO forces) as a function of height.

    The result has two arrays (n,): heights z of the bead's centre, m, denser near a wall, and the
    force along z, N. They are empty if there is no such force.
    """
    every = problem.beside_the_light_apart
    wall = problem.scene.wall
    if not every or wall is None:
        return np.zeros(0), np.zeros(0)
    gaps = np.geomspace(_CLOSEST, box.high - box.low, _HEIGHTS)
    near = [
        plane + normal * (problem.scene.body.support(normal) + gaps)
        for plane, normal in wall.planes
    ]
    heights = np.unique(np.concatenate([np.linspace(box.low, box.high, _HEIGHTS), *near]))
    heights = heights[(heights >= box.low) & (heights <= box.high)]
    places = np.outer(heights, [0.0, 0.0, 1.0])
    return heights, np.asarray(sum(each.field(places).force for each in every))[:, 2]


class _Compared(NamedTuple):
    """Differences between forces of the page and computed forces at random positions, N."""

    usual: float
    """median difference of the page's force from the force that its tables approximate"""
    tables: float
    """largest of the differences whose median is `usual`"""
    evaluator: float
    """largest difference of the page's force from the force by the scene's own evaluator"""
    largest: float
    """largest optical force"""


def _compared(
    problem: Problem, box: _Box, lights: list[_Placed], tables: dict[int, _Table | _Grid],
    walls: tuple[Array, Array],
) -> _Compared:  # fmt: skip
    """Compare the page's force with the force that it approximates, at 2000 random positions.

    Half of the positions are near the foci, where the force is largest. `walls` contains heights,
    m, and forces, N, as returned by `_of_walls`.
    """
    rng = np.random.default_rng(0)
    low, high = [-box.across, -box.across, box.low], [box.across, box.across, box.high]
    places = rng.uniform(low, high, (_COMPARED, 3))
    foci = problem.foci()
    about = foci[rng.integers(len(foci), size=_COMPARED // 2)]
    spread = 1.5 * problem.scene.body.size
    places[: len(about)] = np.clip(about + rng.normal(0, spread, about.shape), low, high)
    shown, exact = np.zeros_like(places), np.zeros_like(places)
    for each in lights:
        within = each.within(places)
        shown += each.factor * each.turn * tables[id(each.light)].force(within)
        exact += each.factor * each.turn * each.light.field(within).force
    of_walls = np.zeros(len(places))
    if walls[0].size:
        every = problem.beside_the_light_apart
        known = np.asarray(sum(force.field(places).force for force in every))[:, 2]
        of_walls = np.abs(np.interp(places[:, 2], *walls) - known)
    off, scene_off = (
        np.linalg.norm(shown - force, axis=1) + of_walls
        for force in (exact, problem.light.field(places).force)
    )
    largest = np.linalg.norm(exact, axis=1).max()
    return _Compared(*map(float, (np.median(off), off.max(), scene_off.max(), largest)))


def _summary(trap: Trap) -> list[Row]:
    """Return the lines of the summary: the properties of the trap, each with its error."""
    sound = trap.ray_optics is None or trap.ray_optics.trusted
    _ = trap.lifetime  # computed on first use; `quantities` lists it only once it is computed
    rows = [Row("outcome", trap.words()["outcome"])]
    in_words = {LIFETIME.name, POWER.name}  # the text of their rows on the card is more complete
    listed = [each for each in trap.quantities() if each.of.name not in in_words]
    for measured in listed:
        each = measured.in_kT(heated(trap.scene).noise_temperature)
        for at, value, error in zip(
            each.of.entries, each.value.flat, each.errors.flat, strict=True
        ):
            words = f"{each.of.about}, {at}" if at else each.of.about
            known = None if each.error is None else float(error)
            rows.append(
                of_number(words, float(value), known, each.of.unit, in_tables=True, trusted=sound)
            )
    told = {each.of.name for each in listed}
    rows += [
        Row(row.name.strip(), row.told, "", not row.caveat)
        for row in trap.card().rows
        if row.of not in told
    ]
    return [*rows, *of_the_medium(trap.scene)]


def _notes(trap: Trap, compared: _Compared) -> list[str]:
    """Return the notes on how to read the page, including the differences that were found."""
    usual, most = (si(each, "N") for each in (compared.usual, compared.tables))
    largest = si(compared.largest, "N")
    centre = "equilibrium" if trap.equilibrium else "focus"
    notes = [
        "The page shows the force of light, weight and walls on a bead centred at each position, "
        "at time 0. It excludes drag, contact with a wall and thermal motion.",
        f"The page interpolates the force from tables with cubic splines. At {_COMPARED} random "
        f"positions its median deviation from the force without tables was {usual} and the largest "
        f"{most}; the largest optical force was {largest}. The deviation in the nearest table "
        "cells is given with each force.",
        "The force of light has no potential, so the work between two positions depends on the "
        "path. The map shows the work against the force along the straight line from the "
        f"{centre} to each position, in kT. At the pointer, two other paths along the axes show "
        "how much the path matters.",
        "Escape lines are straight lines from the equilibrium. A square marks the largest "
        "restoring force, and a bar marks the position where the restoring force ends.",
    ]
    if trap.scene.theory == "rays" and trap.scene.lit:
        notes.append(
            "In ray optics the force changes abruptly where the focus is at the bead's surface. "
            "There the tables smooth it, and their deviations are largest."
        )
    if compared.evaluator > 2 * compared.tables or trap.evaluator == "grid":
        notes.append(
            f"The scene's evaluator, {trap.evaluator}, has jumps. The page draws the smooth force "
            "that it approximates, from which it deviates at the same positions by up to "
            f"{si(compared.evaluator, 'N')}."
        )
    if trap.lifetime_caveat:
        notes.append(f"Lifetime: {trap.lifetime_caveat}.")
    if trap.reason:
        notes.append(f"{trap.reason[:1].upper()}{trap.reason[1:]}.")
    return notes
