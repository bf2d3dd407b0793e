"""What a trap is worth: where it holds the bead, how stiffly, and what it takes to pull it out."""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from tweezer.analysis.escape import Escape, escapes, largest
from tweezer.analysis.holding import Lifetime, doubt, lifetime
from tweezer.dynamics import Problem, bound_once
from tweezer.equilibria import (
    FOCUS,
    Equilibrium,
    NetForce,
    Point,
    along,
    nearest_stable,
    opposite,
    point,
)
from tweezer.optics import (
    RayOpticsWorth,
    cone,
    evaluators_of,
    ray_optics_caveat,
    ray_optics_worth,
    rows_of_light,
    sampled,
    total_power,
)
from tweezer.optics.light import SPEED_OF_LIGHT
from tweezer.optics.worth import between
from tweezer.rounding import micrometres, three
from tweezer.scene import Scene
from tweezer.shown import Card, Row, Shown, Table

Array = NDArray[np.float64]


#: Part of the stiffness below which one across the axes is not shown
_NEGLIGIBLE = 1e-6
#: Smallest number of places that are a line, whose forces are kept for other powers
_LINE = 100


@dataclass(frozen=True)
class Efficiency:
    """The largest pull of the light alone along an axis."""

    Q: float
    """F c/(n_m P), P the power through the pupil"""
    at: float
    """where on that axis, m from the focus"""


@dataclass(frozen=True, repr=False)
class Trap(Shown):
    """A characterised trap, SI. Without a stable equilibrium there is nothing to escape from."""

    scene: Scene = field(compare=False)
    """the scene that it is the trap of"""
    power_through_pupil: float
    """P, W, of all beams, without their modulation"""
    fraction_through_pupil: float | None
    """P over the power of the whole beam; None in the dark"""
    backward_efficiency: Efficiency | None
    """against the light, on the axis; None if the light pulls back nowhere, or there is more than
    one beam at rest at the origin"""
    lateral_efficiency: Efficiency | None
    """towards the axis, on x or y through the focus, the larger; None if it pulls nowhere"""
    equilibria: tuple[Equilibrium, ...]
    """of one beam by z, of several by beam, at the time 0; may be empty"""
    equilibrium: Equilibrium | None
    """the stable one nearest the focus"""
    drag: Point | None
    """1/mobility along each axis at `equilibrium`, kg/s"""
    corner_frequencies: Point | None
    """k_ii/(2 pi beta_v) at `equilibrium`, with the drag there, Hz"""
    gap: float | None
    """distance of the bead's surface at `equilibrium` from the wall, the nearer of two, m; None
    without one"""
    rests: bool
    """whether the forces press a bead on the axis to the wall that touches it"""
    escapes: tuple[Escape, ...]
    """from `equilibrium`, one for each of `DIRECTIONS`; empty without one"""
    evaluator: str
    """how the force was computed: "grid", "quadrature", ..., or "dark" """
    force_error: float
    """largest error of any force these numbers come from, N: as estimated, or certified by the map,
    or for the grid the distance to the quadrature"""
    theory: str
    """theory of the light: "rays" or "waves" """
    theory_reason: str
    """why it is that one"""
    reach: float
    """how far equilibria and escapes were sought, m"""
    absorbed_power: float | None
    """power of the light that the bead absorbs at `equilibrium`, W; None if it absorbs none"""
    torque: Point | None
    """moment of the light about the bead's centre there, N m; None as `absorbed_power`"""
    caveat: str | None
    """what ray optics is worth for this bead (`ray_optics_caveat`); None by waves, in the dark"""
    ray_optics: RayOpticsWorth | None
    """the same in numbers: how far equilibrium, stiffness and escape forces may be off"""

    @functools.cached_property
    def lifetime(self) -> Lifetime | None:
        """How long thermal motion leaves the bead in the trap, computed when it is asked for.

        The mean time from the equilibrium until the bead is `Trap.reach` or
        `simulation.loss_distance` from the focus, whichever is less, at the temperature of the
        medium, whatever `forces.brownian` is. It is a mean first passage time of the overdamped
        motion in the exact force, of which no potential is asked, with the mobility at each place.
        The light is taken as the same all around the axis: of linear light it is that of the half
        planes along x and along y, whose mean is given and whose distance is in the error.

        None without an equilibrium, or one that is as far from the focus as a bead is lost; of more
        than one beam, one that is moved or changes; and with `forces.dlvo`.
        """
        return lifetime(self.scene, self.equilibrium, self.escapes, self.reach, self.force_error)

    @property
    def lifetime_caveat(self) -> str | None:
        """Why an equilibrium has no lifetime, or what is left out of it; None if nothing."""
        return doubt(self.scene, self.equilibrium, self.reach, self.absorbed_power)

    def card(self) -> Card:
        """Equilibrium, stiffness, how long it holds, efficiencies; and the escapes.

        The lifetime is among it once it was asked for: it takes a while to compute.
        """
        share = self.fraction_through_pupil
        power = f"{1e3 * self.power_through_pupil:.4g} mW"
        power += "" if share is None else f", {100 * share:.4g} % of the beam"
        return Card(
            "Trap", self.scene.name,
            (
                Row("power through the pupil", power), *self._efficiencies(), *self._held(),
                *self._others(), Row("error of the force", f"{1e12 * self.force_error:.1g} pN"),
                Row("force by", self.evaluator, detail=True), rows_of_light(self.scene)[0],
            ),
            (self._escapes(),) if self.escapes else (),
        )  # fmt: skip

    def _efficiencies(self) -> Iterator[Row]:
        if not self.scene.plain:
            return
        for name, found in (
            ("backward Q, largest", self.backward_efficiency),
            ("lateral Q, largest", self.lateral_efficiency),
        ):
            told = "none" if found is None else f"{found.Q:.4g}, at {micrometres(found.at)} um"
            yield Row(name, told, detail=True)

    def _held(self) -> Iterator[Row]:
        """Rows of the equilibrium."""
        place, worth = self.equilibrium, self.ray_optics
        if place is None or self.corner_frequencies is None:
            resting = "; it rests on the wall" if self.rests else ""
            yield Row("equilibrium", f"no stable equilibrium{resting}")
            return
        (kx, kxy, _), (kyx, ky, _), (_, _, kz) = place.stiffness
        doubt = "" if worth is None or worth.trusted else "not to be trusted"
        if self.scene.plain:
            where = f"z = {micrometres(place.position[2])} um"
            yield Row("stable equilibrium", where if doubt else f"{where}, on the axis", doubt)
        else:
            yield Row("stable equilibrium", _where(place), doubt)
        if worth and worth.equilibrium_shift:
            low, high = (f"{1e6 * shift:+.2g}" for shift in worth.equilibrium_shift)
            yield Row("  by wave optics", f"{low} to {high} um from there", detail=True)
        yield Row("stiffness (x, y, z)", f"{three(1e6 * kx, 1e6 * ky, 1e6 * kz)} pN/um", doubt)
        if abs(kxy + kyx) > _NEGLIGIBLE * kx:
            told = f"{1e6 * (kxy + kyx) / 2:.4g} pN/um"
            yield Row("stiffness, xy", told, doubt, detail=True)
        if abs(place.turn) > _NEGLIGIBLE * kx:
            turn = f"{1e6 * place.turn:.4g} pN/um, (dFy/dx - dFx/dy)/2"
            yield Row("push round the axis", turn, detail=True)
        if worth and worth.stiffness_across:
            across, along_z = between(worth.stiffness_across), between(worth.stiffness_along)
            yield Row("  by wave optics", f"{across} times that, z {along_z} times")
        if self.gap is not None and self.drag is not None:
            yield Row("gap to the wall there", f"{micrometres(self.gap)} um")
            drag = three(*(1e9 * each for each in self.drag))
            yield Row("drag there (x, y, z)", f"{drag} nN s/m", detail=True)
        yield Row("corner frequencies", f"{three(*self.corner_frequencies)} Hz", doubt)
        if "lifetime" not in vars(self):
            yield Row("held for", "not yet computed: `lifetime` does")
        elif self.lifetime or self.lifetime_caveat:
            told = self.lifetime.words if self.lifetime else ""
            speaks = ", ".join(filter(None, (doubt if told else "", self.lifetime_caveat)))
            yield Row("held for", told, speaks)
        if self.absorbed_power is not None and self.torque is not None:
            yield Row("absorbed power", f"{1e3 * self.absorbed_power:.4g} mW", detail=True)
            torque = three(*(1e18 * each for each in self.torque))
            yield Row("torque about the bead's centre", f"{torque} pN um", detail=True)

    def _others(self) -> Iterator[Row]:
        """Rows of the other equilibria."""
        others = [each for each in self.equilibria if each is not self.equilibrium]
        if not self.scene.plain:
            for each in others:
                kind = "another stable equilibrium" if each.stable else "unstable equilibrium"
                yield Row(kind, _where(each), detail=True)
            return
        for name, stable in (("other stable equilibria", True), ("unstable equilibria", False)):
            heights = [micrometres(each.position[2]) for each in others if each.stable == stable]
            if heights:
                yield Row(name, f"z = {', '.join(heights)} um", detail=True)

    def _escapes(self) -> Table:
        worth = self.ray_optics
        headings = ["escape", "force, pN", "at, um", "energy, kT", "range, um"]
        rows = []
        for each in self.escapes:
            end = f"over {1e6 * self.reach:.4g}"
            if each.wall_at is not None:
                end = f"wall at {micrometres(each.wall_at)}"
            elif each.range is not None:
                end = f"{1e6 * each.range:.4g}"
            cells = [
                each.direction, f"{1e12 * each.force:.4g}", f"{1e6 * each.force_at:.4g}",
                f"{each.energy_kT:.4g}", end,
            ]  # fmt: skip
            if worth and not worth.trusted:
                cells.append("not to be trusted")
            elif worth and worth.escape_across:
                axial = {"+z": worth.escape_forward, "-z": worth.escape_backward}
                cells.append(between(axial.get(each.direction, worth.escape_across)))
            elif worth:
                cells.append("")
            rows.append(tuple(cells))
        if worth:
            headings.append("by waves, times")
        return Table(tuple(headings), tuple(rows))


def _where(place: Equilibrium) -> str:
    return f"{', '.join(map(micrometres, place.position))} um"


def characterise(scene: Scene) -> Trap:
    """Equilibria, stiffness, escape, range and efficiencies of the trap of `scene`.

    The force is that of the scene's light (3.26), by the scene's own evaluator, of its weight
    (2.11, 2.12) and of a wall, as far as `scene.forces` has them. Drag and thermal motion play no
    part, nor does contact: a place where a bead rests on a wall is no equilibrium, and lines end
    where it would touch.

    Half a turn about the beam's axis leaves every light a scene can have as it is, so on the axis
    the force is along it. Equilibria are sought there, within `Trap.reach` of the focus: 20 radii,
    and by waves 5 radii and 10 wavelengths in the medium. Rings of equilibria around the axis are
    not sought. Of several beams, and of one that is moved, they are sought
    near the axis of each beam, at the time 0. The forces have no potential, so stability is that of
    the overdamped motion beta_v dx/dt = F (5.2). The force beside the place is asked too, since the
    jumps of the sum over a grid are not in its derivative. The stiffness is not symmetric in
    circular light, which pushes a bead off the axis round it: `Equilibrium.turn`.

    Escape is along straight lines from the stable equilibrium nearest the focus, and counts the
    component of the force along the line: a bead held on that line. It ends where the component
    changes sign or the light ends. Against the light it need not end: light that meets a bead
    before the focus drives it on to the trap from any distance, by a force that falls with the
    distance squared. The range is then None, and work counts over `Trap.reach`. It is work on that
    line and no height of a barrier, for work between two places depends on the way.

    Lines are sampled about every 0.02 radii, and by waves every twentieth of a wavelength in the
    medium. Zeros are found by Brent's method (`scipy.optimize.brentq`, to 1e-14 radii), which keeps
    to a change of sign, so that it holds also where the sum over a grid of rays jumps; maxima are
    refined with `scipy.optimize.minimize_scalar` to 5e-7 of a sample's distance; work is by the
    rules of Gauss and Kronrod on panels that are halved to 1e-7, or to `Escape.energy_error` where
    jumps hinder it.

    The force is linear in the power of one beam: what it is on lines through the focus is kept for
    the next scene of the same light (`tweezer.optics.sampled`). Scenes that differ in the power
    alone are characterised fastest one after the other.
    """
    problem = bound_once(scene)
    light_force = _LightForce(problem)
    search = problem.light.search
    weight = np.array(problem.bead.weight)

    def net_force(points: Array) -> Array:
        others = (each.field(points).force for each in problem.beside_the_light_apart)
        return sum(others, light_force(points) + weight)

    places = problem.equilibria(net_force)
    equilibrium = nearest_stable(places)
    drag, corner_frequencies, gap = None, None, None
    pulled: tuple[Escape, ...] = ()
    absorbed, torque = None, None
    if equilibrium:
        mobility = problem.mobilities(np.array([equilibrium.position]))[0, :3]
        drag = point(1 / mobility)
        if scene.wall is not None:
            gap = float(scene.room(equilibrium.position[2]))
        corner_frequencies = point(np.diag(equilibrium.stiffness) * mobility / (2 * math.pi))
        pulled = escapes(
            scene, search, net_force, equilibrium.position, symmetric=problem.symmetric
        )
        if scene.lit and scene.bead.absorbs:
            there = np.array([equilibrium.position])
            absorbed = float(problem.light.absorbed_power(there)[0])
            torque = point(problem.light.field(there).moment[0])
    power = sum(cone(scene.with_one_beam(beam)).power for beam in scene.beams)
    given = sum(total_power(scene.lens, beam) for beam in scene.beams) if scene.lit else 0.0
    unit = scene.medium.refractive_index * power / SPEED_OF_LIGHT
    backward, lateral = None, []
    if scene.plain:
        axis = search.whole_line()
        free = axis if scene.wall is None else axis[scene.room(axis) > 0]
        backward = _efficiency(light_force, "+z", free, unit) if free.size > 1 else None
        if scene.wall is None or scene.room(0.0) > 0:
            across = search.line()
            lateral = [_efficiency(light_force, to, across, unit) for to in ("+x", "+y")]
    return Trap(
        scene=scene,
        power_through_pupil=power,
        fraction_through_pupil=power / given if given else None,
        backward_efficiency=backward,
        lateral_efficiency=max(filter(None, lateral), key=lambda pull: pull.Q, default=None),
        equilibria=places,
        equilibrium=equilibrium,
        drag=drag,
        corner_frequencies=corner_frequencies,
        gap=gap,
        rests=pressed(problem),
        escapes=pulled,
        evaluator=evaluators_of(scene),
        force_error=light_force.error,
        theory=scene.theory,
        theory_reason=scene.theory_reason,
        reach=search.reach,
        absorbed_power=absorbed,
        torque=torque,
        caveat=ray_optics_caveat(scene),
        ray_optics=ray_optics_worth(scene),
    )


def pressed(problem: Problem) -> bool:
    """Whether the forces on a bead on the axis that touches a wall press it there."""
    scene = problem.scene
    for plane, normal in scene.wall.planes if scene.wall else ():
        touching = plane + normal * scene.bead.radius
        if abs(touching) > problem.light.search.reach:
            continue
        if normal * problem.net_force_apart(np.array([[0.0, 0.0, touching]]))[0, 2] < 0:
            return True
    return False


class _LightForce:
    """Force of a scene's light; keeps the largest estimated error of those it gave, N."""

    def __init__(self, problem: Problem) -> None:
        self._scene, self._light = problem.scene, problem.light
        self.error = 0.0

    def __call__(self, points: Array) -> Array:
        if self._scene.plain and len(points) >= _LINE:
            force, error = sampled(self._scene, points)
        else:
            field = self._light.field(points)
            force, error = field.force, self._light.error_of(points, field)
        # Newton's method may ask where the light has no force, and never ends there
        self.error = max(self.error, float(error[np.isfinite(error)].max(initial=0.0)))
        return force


def _efficiency(
    light_force: NetForce, direction: str, coordinates: Array, unit: float
) -> Efficiency | None:
    """The largest Q against `direction` on the axis along it; `unit` is n_m P/c, N."""
    pull = opposite(along(light_force, FOCUS, direction))
    force, at = largest(pull, coordinates, coordinates[1] - coordinates[0])
    return Efficiency(force / unit, at) if force > 0 else None
