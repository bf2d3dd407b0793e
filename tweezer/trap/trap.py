"""Trap characterisation: equilibria, stiffness, escape force and lifetime."""

from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from tweezer.dynamics import Problem, bound_once
from tweezer.dynamics.escape import Escape, escapes, escapes_from_ring, largest, too_shallow
from tweezer.dynamics.layout import TRANSLATION
from tweezer.forces import Force
from tweezer.forces.acting import check_numbers
from tweezer.forces.equilibria import FOCUS, Equilibrium, NetForce, along, nearest_stable, opposite
from tweezer.forces.rings import Ring
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
from tweezer.optics.heat import heated
from tweezer.optics.light import SPEED_OF_LIGHT, LightForce
from tweezer.optics.worth import between
from tweezer.scene import Scene, SceneLike, checked_scene
from tweezer.trap import levitation
from tweezer.trap import quantities as known
from tweezer.trap.holding import Lifetime, adds_nothing, doubt, lifetime, time_without_light
from tweezer.values.arrays import Array
from tweezer.values.errors import ResultError, SceneError, TweezerError, warn
from tweezer.values.measured import Measured, Result, figure
from tweezer.values.prefixes import per
from tweezer.values.printed import printed
from tweezer.values.rounding import below_four_digits, micrometres
from tweezer.values.shown import Card, Row, Table
from tweezer.values.vectors import Comparable, Vector, fixed

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from tweezer.trap.body import BodyTrap


#: Fraction of the stiffness below which off-diagonal elements are not shown
_NEGLIGIBLE = 1e-6
#: Part of the lowest stiffness below which another stable equilibrium is shown among the details
_WEAK = 0.1
#: Smallest number of points that count as a line, whose forces are cached for other powers
_LINE = 100


@dataclass(frozen=True)
class Efficiency:
    """Trapping efficiency: the largest restoring force of the light alone along an axis."""

    Q: float
    """F c/(n_m P), a number: F is the force, c the speed of light, n_m the refractive index of the
    medium and P the power through the pupil"""
    at: float
    """coordinate on that axis at which the force is largest, m from the focus"""


@dataclass(frozen=True, repr=False, eq=False)
class Trap(Comparable, Result):
    """A characterised trap, in SI units.

    If no position holds the bead, `equilibrium` is empty (None). The bead may be held by a `ring`
    instead, and `reason` contains the searched range. `stiffness` and `stiffness_xyz` then raise an
    error with this reason.
    """

    QUANTITIES: ClassVar = known.QUANTITIES

    scene: Scene = field(compare=False)
    """the scene that was characterised"""
    power_through_pupil: float
    """P, W, of all beams, without their modulation"""
    fraction_through_pupil: float | None
    """P over the power of the whole beam; None in the dark"""
    backward_efficiency: Efficiency | None
    """efficiency against the light, on the axis; None if the light pulls back nowhere, or unless
    there is a single beam at rest at the origin"""
    lateral_efficiency: Efficiency | None
    """efficiency towards the axis, the larger of x and y through the focus; None if the light pulls
    towards the axis nowhere"""
    equilibria: tuple[Equilibrium, ...]
    """equilibria: for one beam in the order of z, followed by equilibria off its axis; for several
    beams at time 0"""
    equilibrium: Equilibrium | None
    """stable equilibrium nearest the focus; None without one, or if a ring is nearer"""
    rings: tuple[Ring, ...]
    """rings around the axis of a single beam that hold the bead, nearest to the focus first"""
    searched: str
    """range in which equilibria were searched"""
    drag: Vector | None
    """1/mobility along each axis at `equilibrium`, (3,) kg/s"""
    corner_frequencies: Vector | None
    """k_ii/(2 pi beta_v) at `equilibrium`, with the drag there, (3,) Hz; NaN for an axis along
    which the bead oscillates"""
    resonance_frequencies: Vector | None
    """(3,) Hz, resonance frequency along each axis: sqrt(k_ii/m)/(2 pi) without fluid inertia; NaN
    for an axis along which the bead does not oscillate"""
    quality_factors: Vector | None
    """(3,) quality factor of each of these oscillations, above 1/2: sqrt(k_ii m)/beta_v without
    fluid inertia; otherwise NaN"""
    gap: float | None
    """distance of the bead's surface at `equilibrium` from the nearer wall, m; None without a
    wall"""
    rests: bool
    """whether the forces press a bead on the axis against the wall"""
    escapes: tuple[Escape, ...]
    """escapes from `equilibrium`, one for each of `DIRECTIONS`; empty without an equilibrium"""
    evaluator: str
    """method that computed the force: "grid", "quadrature", ..., or "dark" """
    force_error: float
    """largest error of the forces, N: estimated for the quadrature, certified for a force map, and
    for the grid the difference from the quadrature"""
    theory: str
    """theory of the light: "rays" or "waves" """
    theory_reason: str
    """reason for this theory"""
    reach: float
    """distance from the focus up to which equilibria and escapes were searched, m"""
    absorbed_power: float | None
    """power of the light that the bead absorbs at `equilibrium`, W; None if it absorbs none"""
    torque: Vector | None
    """optical torque about the bead's centre at `equilibrium`, N m; None if it absorbs no light"""
    caveat: str | None
    """error of ray optics for this bead in words (`ray_optics_caveat`); None with wave optics"""
    ray_optics: RayOpticsWorth | None
    """errors of ray optics in equilibrium, stiffness and escape forces; None with the user's own
    forces"""
    other_forces: int = 0
    """number of the user's own forces"""

    @functools.cached_property
    def lifetime(self) -> Lifetime | None:
        """Mean time until thermal motion removes the bead from the trap, computed on first use.

        The time begins at the equilibrium, or on the ring. It ends when the distance from the focus
        reaches `Trap.reach` or `simulation.loss_distance`, whichever is less. The temperature is
        `medium.temperature`, or in a scene with heat that of the bead's thermal motion, even if
        `forces.brownian` is false. The time is a mean first passage time of the overdamped motion
        in the exact force, which need not have a potential, with the mobility at each position. The
        light is assumed to have rotational symmetry. For linearly polarised light, the time is
        computed in the half planes along x and along y. The mean of both is returned, and their
        difference is part of the error.

        The lifetime is None, with the reason in `lifetime_caveat`, in these cases:

        * no equilibrium and no ring, or one off the axis or beyond the distance at which the bead
          is lost
        * several beams, or a beam that moves or changes in power
        * `forces.dlvo`, or the user's own forces
        * dominant inertia: sqrt(k m) above 0.3 of the drag
        """
        if self.other_forces:
            return None
        held, error = self._holds, self.force_error
        return lifetime(self.scene, held, self._ways_out, self.reach, error)

    @functools.cached_property
    def lifetime_without_light(self) -> Lifetime | None:
        """Mean time for which the bead stays within the same distance without light.

        The bead begins at the same position and has its weight. The value is None unless `lifetime`
        is finite.
        """
        if self._holds is None or self.lifetime is None or math.isinf(self.lifetime.time):
            return None
        return time_without_light(self.scene, self._holds, self.reach)

    @functools.cached_property
    def least_drag(self) -> float | None:
        """Drag above which every displacement of the bead decays, kg/s.

        It is the largest |b| sqrt(m/a) of the eigenvalues a +- i b of the stiffness matrix, and 0
        if all of them are real. It refers to the equilibrium nearest the focus that pulls the bead
        back along every axis, even if the drag of the scene is too small. Then `equilibrium` is
        another one, or None. The mass m includes the added mass if fluid inertia is included.

        The drag is None without such an equilibrium.
        """
        return levitation.least_drag(self)

    @property
    def least_pressure(self) -> float | None:
        """Pressure of the scene's gas at which its drag equals `least_drag`, Pa.

        It is 0 if the bead is stable at any pressure, and infinite if the drag at 2 bar is not
        enough. The stiffness belongs to the scene's pressure. The result is None without a named
        gas, beside a wall, or with a given mean free path.
        """
        found = levitation.least_pressure(self)
        return found and found[0]

    @functools.cached_property
    def photon_recoil(self) -> levitation.Recoil | None:
        """Momentum diffusion by the recoil of photons at `equilibrium`, computed on first use.

        It is None without an equilibrium, and for light whose scattering `tweezer.recoil` does not
        compute, such as ray optics.
        """
        return levitation.photon_recoil(self)

    @property
    def recoil_heating(self) -> Vector | None:
        """Heating S_ii/(2 m) by the recoil of photons along each axis at `equilibrium`, (3,) W.

        S is the momentum diffusion (`tweezer.recoil`). The result is None if `photon_recoil` is.
        """
        return levitation.recoil_heating(self)

    @property
    def recoil_pressures(self) -> Vector | None:
        """Pressures at which the gas heats each axis as much as photon recoil does, (3,) Pa.

        The gas heats an axis by k_B T beta_v/m. The result is None if `recoil_heating` or
        `least_pressure` is.
        """
        return levitation.recoil_pressures(self)

    @property
    def temperatures(self) -> Vector | None:
        """Temperature m <v_i^2>/k_B of the harmonic motion along each axis, (3,) K.

        Without circulation it is T + m H_i/(k_B beta_v), with the `recoil_heating` H_i. T is the
        temperature of the medium, or in a scene with heat that of the bead's thermal motion.
        Circulation increases it by the factor 1/(1 - (`least_drag`/beta_v)^2). Noise of the laser
        and fluid inertia are left out. The result is None if `recoil_heating` is, and beside a
        wall.
        """
        return levitation.temperatures(self)

    @property
    def ring(self) -> Ring | None:
        """The ring that holds the bead; None if `equilibrium` holds it, or if it is not held."""
        return self.rings[0] if self.rings and self.equilibrium is None else None

    @property
    def stiffness(self) -> Array:
        """Stiffness matrix -dF_i/dx_j at `equilibrium`, (3, 3) N/m.

        Raises `TweezerError` if there is no equilibrium.
        """
        return self._equilibrium().stiffness

    @property
    def stiffness_xyz(self) -> Array:
        """Stiffness along x, y and z at `equilibrium`, (3,) N/m.

        Raises `TweezerError` if there is no equilibrium.
        """
        return self._equilibrium().stiffness_xyz

    @property
    def reason(self) -> str:
        """Reason why no equilibrium holds the bead; empty if one does."""
        if self.equilibrium is not None:
            shallow = self.too_shallow
            return shallow and f"the equilibrium at {_where(self.equilibrium)} {shallow}"
        if self.ring is not None:
            radius = f"{micrometres(self.ring.radius)} um"
            if self.too_shallow:
                return f"no stable equilibrium; the ring of {radius} {self.too_shallow}"
            return f"held on a ring of {radius}, at no place"
        resting = "; it rests on the wall" if self.rests else ""
        spirals = [each for each in self.equilibria if each.spiral_rate > 0]
        if spirals:
            where = _where(min(spirals, key=lambda each: float(np.linalg.norm(each.position))))
            resting = (
                f"; at {where} it is pulled back, but too little drag lets the push of the light "
                f"round the axis drive it out on a spiral{resting}"
            )
        return f"{f'no stable equilibrium {self.searched}'.rstrip()}{resting}"

    def _equilibrium(self) -> Equilibrium:
        """Return the stable equilibrium; raise `TweezerError` with the reason if none exists."""
        if self.equilibrium is None:
            raise TweezerError(
                f"{self.scene.name}: {self.reason}; `Trap.equilibria` lists unstable equilibria, "
                "and `Trap.rings` the rings"
            )
        return self.equilibrium

    @property
    def _holds(self) -> Equilibrium | Ring | None:
        """Equilibrium or ring that holds the bead; None without either."""
        return self.equilibrium or self.ring

    @property
    def _ways_out(self) -> tuple[Escape, ...]:
        """Escapes from the ring or the equilibrium that holds the bead."""
        return self.ring.escapes if self.ring else self.escapes

    @property
    def too_shallow(self) -> str:
        """Reason why the equilibrium, or the ring, is too shallow in thermal motion, or "".

        This is the case if the easiest straight escape requires less than 1 k_B T.
        """
        return too_shallow(self._ways_out) if self._holds else ""

    @property
    def lifetime_caveat(self) -> str | None:
        """Reason why there is no lifetime, or an effect that it neglects; None if neither."""
        if self.other_forces and self._holds is not None:
            return "not computed with your own forces"
        return doubt(self.scene, self._holds, self.reach, self.absorbed_power)

    def plot(self) -> Figure:
        """Draw the forces of the trap: the figure of `tweezer.plots.trap_figure`."""
        return figure("trap_figure", self.scene, self)

    def check_scene_alone(self, what: str) -> None:
        """Raise `ResultError` for `what` draws the forces of the scene, if there were others."""
        if self.other_forces:
            raise ResultError(
                f"{what}: shows only the forces of the scene, but this trap has "
                f"{self.other_forces} of your own; use characterise(scene) without forces"
            )

    def quantities(self) -> Iterator[Measured]:
        """Yield the quantities of the trap, with the lifetime if it was computed."""
        place, ring, error = self.equilibrium, self.ring, self.force_error
        if place is not None:
            of_stiffness = error * known.gradient_of_errors(self.scene)
            yield known.EQUILIBRIUM(place.position, error / min(place.eigenvalues))
            yield known.STIFFNESS(place.stiffness_xyz, np.full(3, of_stiffness))
            relative = of_stiffness / np.abs(place.stiffness_xyz)
            for quantity, numbers, power in (
                (known.CORNER, self.corner_frequencies, 1.0),
                (known.RESONANCE, self.resonance_frequencies, 0.5),
                (known.QUALITY, self.quality_factors, 0.5),
            ):
                if numbers is not None:
                    yield quantity(numbers, numbers * power * relative)
        if ring is not None:
            softest = float(np.linalg.eigvals(ring.stiffness).real.min())
            yield known.RING(ring.radius, error / softest)
        if place is not None:
            ways = self.escapes
            lengths = np.array([each.range or each.wall_at or self.reach for each in ways])
            yield known.ESCAPE_FORCE([each.force for each in ways], np.full(len(ways), error))
            yield known.ESCAPE_ENERGY(
                [each.energy for each in ways],
                [each.energy_error for each in ways] + error * lengths,
            )
        if "lifetime" in vars(self) or self.other_forces:
            held = self.lifetime
            yield known.LIFETIME(held.time, held.error) if held else known.LIFETIME(None)
        yield from levitation.measured(self)
        yield known.FORCE_ERROR(error)
        yield known.POWER(self.power_through_pupil, 0.0)

    def words(self) -> dict[str, str]:
        """Return the outcome of the bead, the reason if it is not held, and the findings."""
        place, lifetime = self.equilibrium, self.lifetime_caveat
        caveats = [self.caveat, lifetime and f"lifetime: {lifetime}"]
        ways = self.ring.escapes if self.ring else self.escapes
        deep = min((each.energy_kT for each in ways), default=0.0) >= known.STABLE
        reason = self.reason
        if self.ring is not None:
            outcome, reason = known.ON_RING, self.reason if self.too_shallow else ""
        elif place is None:
            outcome = known.RESTS if self.rests else known.LOST
        else:
            outcome = known.HELD
        if (self.ring or place) and (self.too_shallow or not deep):
            outcome = known.LOST if self.too_shallow else known.SHALLOW
        return {"outcome": outcome, "reason": reason, "caveat": "; ".join(filter(None, caveats))}

    def card(self) -> Card:
        """Return the card with equilibrium, stiffness, lifetime and efficiencies, and a table of
        escapes.

        It contains the lifetime only if it has been computed already, because computing it takes
        time.
        """
        share = self.fraction_through_pupil
        power = printed(self.power_through_pupil, "mW")
        power += "" if share is None else f", {100 * share:.4g} % of the beam"
        weakest = min((abs(each.force) for each in self._ways_out), default=0.0)
        own = [Row("forces of your own", str(self.other_forces))] if self.other_forces else []
        return Card(
            "Trap", self.scene.name,
            (
                Row("power through the pupil", power), *self._mask(), *self._efficiencies(),
                *self._held(), *levitation.rows(self),
                *self._others(), *self._heat(), *own,
                Row("error of the force", printed(self.force_error, "pN", 1), of="force_error",
                    detail=below_four_digits(weakest, self.force_error)),
                Row("force by", self.evaluator, detail=True), *rows_of_light(self.scene)[:2],
            ),
            (self._escapes(),) if self._ways_out else (),
        )  # fmt: skip

    def _mask(self) -> Iterator[Row]:
        """Yield the row of the mask or the sectors of the only beam."""
        from tweezer.optics.waves.terms import mask_light  # most scenes have no mask

        if self.scene.beam.pattern is not None and (found := mask_light(self.scene)):
            yield found.row()

    def _efficiencies(self) -> Iterator[Row]:
        """Yield the rows of the efficiencies, for one beam at rest at the origin."""
        if not self.scene.plain:
            return
        for name, found in (
            ("backward Q, largest", self.backward_efficiency),
            ("lateral Q, largest", self.lateral_efficiency),
        ):
            words = "none" if found is None else f"{found.Q:.4g}, at {micrometres(found.at)} um"
            yield Row(name, words, detail=True)

    def _held(self) -> Iterator[Row]:
        """Yield the rows of the equilibrium, or of the ring, and of the lifetime there."""
        place, worth = self.equilibrium, self.ray_optics
        if self.ring is not None:
            yield from self._on_ring(self.ring)
            return
        if place is None:
            yield Row("equilibrium", self.reason)
            return
        (kx, kxy, _), (kyx, ky, _), (_, _, kz) = place.stiffness
        doubt = "" if worth is None or worth.trusted else "not to be trusted"
        doubt = ", ".join(filter(None, (doubt, self.too_shallow)))
        if self.scene.plain:
            on_axis = "" if doubt or place.position[:2].any() else ", on the axis"
            yield Row("stable equilibrium", f"{_where(place)}{on_axis}", doubt, of="equilibrium")
        else:
            yield Row("stable equilibrium", _where(place), doubt, of="equilibrium")
        if worth and worth.equilibrium_shift:
            low, high = (f"{per('um') * shift:+.2g}" for shift in worth.equilibrium_shift)
            yield Row("  by wave optics", f"{low} to {high} um from there", detail=True)
        stiffness = printed((kx, ky, kz), "pN/um")
        yield Row("stiffness (x, y, z)", stiffness, doubt, of="stiffness")
        if abs(kxy + kyx) > _NEGLIGIBLE * kx:
            yield Row("stiffness, xy", printed((kxy + kyx) / 2, "pN/um"), doubt)
        if abs(place.turn) > _NEGLIGIBLE * kx:
            turn = f"{printed(place.turn, 'pN/um')}, (dFy/dx - dFx/dy)/2"
            yield Row("push round the axis", turn, detail=True)
        if worth and worth.stiffness_across:
            across, along_z = between(worth.stiffness_across), between(worth.stiffness_along)
            yield Row("  by wave optics", f"{across} times that, z {along_z} times")
        if self.gap is not None and self.drag is not None:
            yield Row("gap to the wall there", f"{micrometres(self.gap)} um")
            yield Row("drag there (x, y, z)", printed(self.drag, "nN s/m"), detail=True)
        yield from self._frequencies(doubt)
        yield from self._lifetime(doubt)
        if self.absorbed_power is not None and self.torque is not None:
            yield Row("absorbed power", printed(self.absorbed_power, "mW"), detail=True)
            yield Row("torque about the bead's centre", printed(self.torque, "pN um"), detail=True)

    def _heat(self) -> Iterator[Row]:
        """Yield the row of the temperatures in the light."""
        if self.scene.heat is not None:
            yield Row("heat", heated(self.scene).heat_in_words())

    def _on_ring(self, ring: Ring) -> Iterator[Row]:
        """Yield the rows of the ring that holds the bead."""
        radius, height = micrometres(ring.radius), micrometres(ring.height)
        name = "ring" if self.too_shallow else "held on a ring"
        words = f"of radius {radius} um about the axis, at z = {height} um"
        yield Row(name, words, self.too_shallow)
        yield Row("stiffness (radial, z)", printed(ring.stiffness_across, "pN/um"))
        if abs(ring.azimuthal_force) > self.force_error:
            yield Row("force round the axis", printed(ring.azimuthal_force, "pN"))
            words = f"{printed(ring.speed, 'um/s')}, {ring.rate:.4g} turns/s"
            yield Row("driven round it at", words)
        others = self.rings[1:]
        if others:
            radii = ", ".join(micrometres(each.radius) for each in others)
            yield Row("other rings", f"of radius {radii} um", detail=True)
        yield from self._lifetime("")

    def _lifetime(self, doubt: str) -> Iterator[Row]:
        """Yield the rows of the lifetime, with and without light; `doubt` is a remark about it."""
        if "lifetime" not in vars(self) and not self.other_forces:
            yield Row("held for", "not yet computed: `lifetime` does")
            return
        if not (self.lifetime or self.lifetime_caveat):
            return
        words = self.lifetime.told if self.lifetime else ""
        speaks = ", ".join(filter(None, (doubt if words else "", self.lifetime_caveat)))
        yield Row("held for", words, speaks)
        if self.lifetime and (without := self.lifetime_without_light):
            yield Row("  without light", without.told, adds_nothing(self.lifetime, without))

    def _frequencies(self, doubt: str) -> Iterator[Row]:
        """Yield the rows of corner frequencies, or of resonances if the bead oscillates."""
        found = (
            ("corner frequencies", self.corner_frequencies, " Hz", known.CORNER),
            ("resonance frequencies", self.resonance_frequencies, " Hz", known.RESONANCE),
            ("quality factors", self.quality_factors, "", known.QUALITY),
        )
        for name, values, unit, quantity in found:
            if values is None or np.isnan(values).all():
                continue
            have = ~np.isnan(values)
            of = "" if have.all() else f" ({', '.join(np.array(list('xyz'))[have])})"
            numbers = ", ".join(f"{value:.4g}" for value in values[have])
            yield Row(name + of, numbers + unit, doubt, of=quantity.name)

    def _others(self) -> Iterator[Row]:
        """Yield the rows of the other equilibria."""
        others = [each for each in self.equilibria if each is not self.equilibrium]
        apart = [each for each in others if each.position[:2].any()]
        if not self.scene.plain or apart:
            least = _WEAK * self.equilibrium.eigenvalues[0] if self.equilibrium else math.inf
            for each in sorted(others, key=lambda each: not each.stable):
                kind = "another stable equilibrium" if each.stable else "unstable equilibrium"
                weak = not each.stable or each.eigenvalues[0] < least
                yield Row(kind, _where(each), detail=weak)
            return
        for name, stable in (("other stable equilibria", True), ("unstable equilibria", False)):
            heights = [micrometres(each.position[2]) for each in others if each.stable == stable]
            if heights:
                yield Row(name, f"z = {', '.join(heights)} um", detail=True)

    def _escapes(self) -> Table:
        """Return the table of the escapes, with the ratio of wave to ray optics if known."""
        worth, um = self.ray_optics, per("um")
        headings = ["escape", "force, pN", "at, um", "energy, kT", "5 % range, um"]
        rows = []
        for each in self._ways_out:
            end = f"over {um * self.reach:.4g}"
            if each.faint_at is not None:
                end = f"{um * each.faint_at:.4g}"
            elif each.wall_at is not None:
                plane = "wall" if self.scene.wall else "mirror"
                end = f"{plane} at {micrometres(each.wall_at)}"
            elif each.range is not None:
                end = f"{um * each.range:.4g}"
            cells = [
                each.direction, f"{per('pN') * each.force:.4g}", f"{um * each.force_at:.4g}",
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
    """Return the position of an equilibrium in um as text; only its z if it is on the axis."""
    if not place.position[:2].any():
        return f"z = {micrometres(place.position[2])} um"
    return f"{', '.join(map(micrometres, place.position))} um"


def characterise(scene: SceneLike, *, forces: Sequence[Force | str] = ()) -> Trap | BodyTrap:
    """Characterise the trap of a scene: equilibria, stiffness, escape forces and efficiencies.

    The force is the sum of the optical force (3.26), computed by the scene's evaluator, the weight
    (2.11, 2.12) and the forces of walls, as far as `scene.forces` includes them. Drag, thermal
    motion and contact forces are excluded: a position at which the bead rests on a wall is not an
    equilibrium, and lines end where the bead would touch the wall.

    All light in a scene is symmetric under half a turn about the beam axis, so the force on the
    axis is parallel to it. Equilibria are searched on the axis, within `Trap.reach` of the focus.
    `Trap.reach` is 20 radii with ray optics, and 5 radii plus 10 wavelengths in the medium with
    wave optics. It is at least five times the distance at which the beam is as wide as the bead,
    plus five depths of focus with wave optics. If the light carries the weight, the search extends
    to `simulation.loss_distance`. If no equilibrium near the focus is stable, the search includes
    rings in the bright region around the axis. In light without rotational symmetry it includes
    positions off the axis. `Trap.searched` describes the search. For several beams, or a beam that
    moves, equilibria are searched near the axis of each beam, at time 0. In light of an uneven
    pupil, such as a hologram, stable equilibria are also searched on a grid about all foci.

    An equilibrium is stable if linear motion about it decays, with the inertia of the scene's model
    (`Equilibrium.spiral_rate`). The force at neighbouring positions must also be restoring, because
    the sum over a grid of rays has jumps, which its derivative does not contain. Circularly
    polarised light pushes an off-axis bead around the axis, so the stiffness matrix is not
    symmetric (`Equilibrium.turn`).

    Escapes are computed along straight lines from the stable equilibrium nearest the focus, with
    the component of the force along the line. An escape ends where this component changes sign or
    the light ends. Against the light it may not end: before the focus, the light drives the bead
    towards the trap from any distance, with a force that decreases with the distance squared. The
    range is then None, and the work is integrated up to `Trap.reach`. The work is not a barrier
    height, because the work between two positions depends on the path.

    Lines are sampled about every 0.02 radii, and with wave optics every twentieth of a wavelength
    in the medium. Far from the focus the samples are further apart. Zeros are located by Brent's
    method to 1e-14 radii, also where the sum over a grid of rays jumps. Maxima are refined to 5e-7
    of the sample distance. The work is integrated by Gauss-Kronrod rules on intervals that are
    halved until the error is 1e-7. Where jumps prevent this, `Escape.energy_error` is larger.

    For a bead that is not a sphere, equilibria are searched in position and orientation
    (`body_trap`), for light and weight alone.

    The force is proportional to the power of a beam, so its values on lines through the focus are
    reused for the next scene with the same light (`tweezer.optics.sampled`). Scenes that differ
    only in power are therefore characterised faster in succession.

    Parameters
    ----------
    scene : Scene, str or mapping
        Bead, medium, lens and beams.
    forces : sequence of Force or str
        Your own forces, in addition to the scene's (`tweezer.forces`), evaluated at time 0 for a
        bead in its initial orientation. Equilibria are then searched near the axis of each beam,
        and rings are not searched. Efficiencies include only the light.

    Returns
    -------
    Trap or BodyTrap
        The trap, with `equilibrium` None if no position holds the bead.

    Raises
    ------
    ForceError
        If one of the user's own forces is invalid.
    SceneError
        For a body that is not a sphere and forces of your own, a wall or no light.

    Examples
    --------
    >>> trap = tweezer.characterise("silica-1um")
    >>> (1e6 * trap.stiffness_xyz).round(1).tolist()  # pN/um
    [104.6, 104.6, 34.5]
    """
    scene = checked_scene(scene)
    if scene.bead.shape == "sphere":
        return sphere_trap(scene, forces)
    if forces:
        raise SceneError("forces: your own forces require a sphere; remove them, or bead.shape")
    from tweezer.trap.body import body_trap

    return body_trap(scene)


def sphere_trap(scene: Scene, forces: Sequence[Force | str] = ()) -> Trap:
    """Return the trap of a sphere; see `characterise`."""
    problem = bound_once(scene, forces)
    scene = problem.scene
    if scene.medium.relaxes:
        warn(
            f"{scene.name}: corner frequencies and lifetimes apply to the solvent alone; "
            "tweezer.response includes the relaxing medium"
        )
    light_force = _LightForce(problem)
    others_error = 0.0
    search = problem.search
    weight = np.array(problem.bead.weight)

    def net_force(points: Array) -> Array:
        """Return the sum of all forces (n, 3), N, at points (n, 3), m; record the largest error."""
        nonlocal others_error
        apart = *problem.walls_apart, *problem.elastic
        of_walls = (each.field(points).force for each in apart)
        total, error = sum(of_walls, light_force(points) + weight), np.zeros(len(points))
        for each in problem.others:
            pushed = each.field(points)
            check_numbers(each, pushed)
            total, error = total + pushed.force, error + pushed.error
        others_error = max(others_error, float(error.max(initial=0.0)))
        return total

    places, rings, searched = _found(problem, net_force)
    equilibrium = nearest_stable(places)
    if rings and equilibrium is not None and _off(rings[0]) < _off(equilibrium):
        equilibrium = None
    drag, gap, absorbed, torque = None, None, None, None
    corner, resonance, quality = None, None, None
    pulled: tuple[Escape, ...] = ()
    if equilibrium:
        mobility = problem.mobilities(np.array([equilibrium.position]))[0, TRANSLATION]
        drag = fixed(1 / mobility)
        if scene.wall is not None:
            gap = float(scene.room(equilibrium.position[2]))
        found = problem.linear.resonances(equilibrium.stiffness_xyz, mobility)
        corner, resonance, quality = map(fixed, found)
        pulled = escapes(
            scene, search, net_force, equilibrium.position, symmetric=problem.symmetric
        )
        if scene.lit and scene.bead.absorbs:
            there = np.array([equilibrium.position])
            absorbed = float(problem.light.absorbed_power(there)[0])
            torque = fixed(problem.light.field(there).moment[0])
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
        rings=rings,
        searched=searched,
        drag=drag,
        corner_frequencies=corner,
        resonance_frequencies=resonance,
        quality_factors=quality,
        gap=gap,
        rests=pressed(problem),
        escapes=pulled,
        evaluator=evaluators_of(scene),
        force_error=light_force.error + others_error,
        theory=scene.theory,
        theory_reason=scene.theory_reason,
        reach=search.reach,
        absorbed_power=absorbed,
        torque=torque,
        caveat=ray_optics_caveat(scene),
        ray_optics=None if problem.others else ray_optics_worth(scene),
        other_forces=len(problem.others),
    )


def _found(
    problem: Problem, net_force: NetForce
) -> tuple[tuple[Equilibrium, ...], tuple[Ring, ...], str]:
    """Return the equilibria, the rings that hold the bead, and a description of the search range.

    `net_force` returns the force, N, at points (n, 3), m. If there is no stable equilibrium in the
    focus, rings are searched, or positions off the axis in light without rotational symmetry. Light
    that holds a bead in the focus has its maximum on the axis, so no search is needed then.
    """
    search = problem.search
    near = f"on the axis within {printed(search.reach, 'um')} of the focus"
    if search.farthest > search.reach and problem.scene.lit:
        near += f" (where light just carries the weight, {printed(search.farthest, 'um')})"
    places = problem.equilibria(net_force)
    rings: tuple[Ring, ...] = ()
    if not problem.about_axis:
        return places, rings, f"{near}, for each beam, nor beside it"
    if not (problem.scene.lit and problem.light.smooth):
        return places, rings, near
    assert isinstance(problem.light, LightForce)
    box = problem.light.box
    nearest = nearest_stable(places)
    if nearest is not None and _off(nearest) < box.width:
        return places, rings, near
    if not problem.symmetric:
        places += problem.off_axis(net_force)
        return places, rings, f"{near}, nor off it up to {box.words}"
    found = problem.rings(net_force)
    rings = tuple(
        dataclasses.replace(
            each, escapes=escapes_from_ring(problem.scene, search, net_force, each.position)
        )
        for each in found
    )
    searched = f"{near}, nor on a ring up to {box.words}"
    if not rings and problem.ring_motion.mass:
        for each in problem.rings(net_force, inertia=False)[:1]:
            searched += (
                f"; on a ring of {micrometres(each.radius)} um the light pulls it back, but too "
                "little drag lets its inertia carry it off"
            )
    return places, rings, searched


def _off(held: Equilibrium | Ring) -> float:
    """Return the distance of an equilibrium or ring from the focus, m."""
    return float(np.linalg.norm(held.position))


def pressed(problem: Problem) -> bool:
    """Return whether the forces press a bead that touches a wall on the axis against the wall."""
    scene = problem.scene
    for plane, normal in scene.wall.planes if scene.wall else ():
        touching = plane + normal * scene.body.support(normal)
        if abs(touching) > problem.light.search.reach:
            continue
        if normal * problem.net_force_apart(np.array([[0.0, 0.0, touching]]))[0, 2] < 0:
            return True
    return False


class _LightForce:
    """Optical force at points (n, 3), m, with `error`, the largest error so far, N.

    Many points form a line through the focus, whose forces `sampled` caches for other powers.
    """

    def __init__(self, problem: Problem) -> None:
        self._scene, self._light = problem.scene, problem.light
        self.error = 0.0

    def __call__(self, points: Array) -> Array:
        """Return the force, (n, 3) N, at points (n, 3), m."""
        if self._scene.plain and len(points) >= _LINE:
            force, error = sampled(self._scene, points)
        else:
            field = self._light.field(points)
            force, error = field.force, self._light.error_of(points, field)
        # ignore infinite errors, which occur far away, where a step of Newton's method may lead
        self.error = max(self.error, float(error[np.isfinite(error)].max(initial=0.0)))
        return force


def _efficiency(
    light_force: NetForce, direction: str, coordinates: Array, unit: float
) -> Efficiency | None:
    """Return the largest efficiency Q against `direction`, such as "+z"; None without such a force.

    Q is the force over `unit` = n_m P/c, N, with the refractive index n_m, the power P and the
    speed of light c. `coordinates` (n,), m, are the points on the line at which it is sampled.
    """
    pull = opposite(along(light_force, FOCUS, direction))
    force, at = largest(pull, coordinates, coordinates[1] - coordinates[0])
    return Efficiency(force / unit, at) if force > 0 else None
