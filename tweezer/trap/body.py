"""The trap of a body that is not a sphere: equilibria in position and orientation."""

from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np
from scipy.spatial.transform import Rotation

from tweezer.dynamics.escape import Escape, too_shallow
from tweezer.dynamics.poses import ANGLE, FREE, PLACE, BodyEquilibrium, PoseSearch
from tweezer.fluid.resistance.of_scene import resistance
from tweezer.optics import Beams, LightForce
from tweezer.optics.bodies.shapes import t_matrix
from tweezer.optics.bodies.t_matrix import TMatrix
from tweezer.optics.heat import heated
from tweezer.optics.light import SPEED_OF_LIGHT
from tweezer.scene import Scene
from tweezer.trap import quantities as known
from tweezer.values.arrays import Array
from tweezer.values.errors import SceneError
from tweezer.values.measured import DIMENSIONS, Measured, Quantity, Result
from tweezer.values.printed import printed
from tweezer.values.rounding import micrometres
from tweezer.values.shown import Card, Row, Table
from tweezer.values.vectors import Comparable


@dataclass(frozen=True, repr=False, eq=False)
class BodyTrap(Comparable, Result):
    """A characterised trap of a body that is not a sphere, in SI units."""

    QUANTITIES: ClassVar[tuple[Quantity, ...]] = known.OF_BODY

    scene: Scene = field(compare=False)
    """the scene that was characterised"""
    equilibria: tuple[BodyEquilibrium, ...]
    """equilibria found from several starts, the stable ones first, then by z"""
    equilibrium: BodyEquilibrium | None
    """stable equilibrium nearest the focus; None if none was found"""
    escapes: tuple[Escape, ...]
    """escapes from `equilibrium` at its orientation: along the axes, or across the orbit on which
    it is"""
    torque_efficiency: float | None
    """largest torque times the angular frequency of the light over the power, when the body is
    turned at the equilibrium about x and about y"""
    absorbed_power: float | None
    """power that the body absorbs at the equilibrium, W; None if it absorbs none"""
    force_error: float
    """largest error of the force at the equilibria, N"""
    searched: str
    """starts of the search"""

    @functools.cached_property
    def t_matrix(self) -> TMatrix:
        """The T-matrix of the body."""
        return t_matrix(self.scene)

    @property
    def on_orbit(self) -> bool:
        """Whether the equilibrium is on an orbit about the axis of the light."""
        return any(each.direction not in DIMENSIONS["direction"] for each in self.escapes)

    def quantities(self) -> Iterator[Measured]:
        """Yield the quantities of the trap at its stable equilibrium."""
        held, error = self.equilibrium, self.force_error
        if held is not None:
            of_stiffness = error * known.gradient_of_errors(self.scene)
            stiffness, values = np.diag(held.stiffness), np.asarray(held.eigenvalues)[:, 0]
            free = np.abs(values if held.relaxation_rates is None else held.relaxation_rates)
            changing = free.reshape(6, -1).max(axis=1) > FREE * free.max()
            softest = np.sort(np.abs(values))[-changing.sum()]
            yield known.EQUILIBRIUM(held.position, error / softest)
            yield known.STIFFNESS(stiffness[PLACE], np.full(3, of_stiffness))
            # a torque is a polynomial of the rotation, of at most twice the T-matrix's degree
            of_turns = 2 * self.t_matrix.degree * error * held.length
            yield known.ROTATIONAL_STIFFNESS(stiffness[ANGLE], np.full(3, of_turns))
            if held.rotation is not None:
                drag = resistance(self.scene)
                torque = error * held.length * np.linalg.norm(drag.mobility[ANGLE, ANGLE], ord=2)
                own = drag.error * np.linalg.norm(held.rotation)
                yield known.ROTATION(held.rotation, np.full(3, torque + own))
        if held is not None and not self.on_orbit:
            ways = self.escapes
            yield known.ESCAPE_FORCE([each.force for each in ways], np.full(len(ways), error))
            lengths = np.array([math.nan if each.range is None else each.range for each in ways])
            yield known.ESCAPE_ENERGY(
                [each.energy for each in ways],
                [each.energy_error for each in ways] + error * lengths,
            )
        yield known.FORCE_ERROR(error)

    def words(self) -> dict[str, str]:
        """Return the outcome of the body, and the reason if it is not held.

        The depth applies to a body that keeps its orientation at the equilibrium.
        """
        if self.equilibrium is None:
            return {"outcome": known.LOST, "reason": f"no stable equilibrium {self.searched}"}
        if reason := too_shallow(self.escapes):
            return {"outcome": known.LOST, "reason": reason}
        deep = min(each.energy_kT for each in self.escapes) >= known.STABLE
        held = known.ON_RING if self.on_orbit else known.HELD
        return {"outcome": held if deep else known.SHALLOW}

    def content(self) -> dict[str, Any]:
        """Return the fields except the scene as plain values, for a file."""
        found = {
            each.name: getattr(self, each.name) for each in dataclasses.fields(self)
            if each.name != "scene"
        }  # fmt: skip
        plain = [dataclasses.asdict(each) for each in self.equilibria]
        held = self.equilibrium and dataclasses.asdict(self.equilibrium)
        pulled = [dataclasses.asdict(each) for each in self.escapes]
        return found | {"equilibria": plain, "equilibrium": held, "escapes": pulled}

    def card(self) -> Card:
        """Return the card with equilibrium, stiffness and efficiency, and a table of equilibria."""
        return Card(
            "BodyTrap", self.scene.name, tuple(self._rows()),
            (self._places(),) if len(self.equilibria) > 1 else (),
        )  # fmt: skip

    def _rows(self) -> Iterator[Row]:
        """Yield the rows of the card."""
        held = self.equilibrium
        if held is None:
            yield Row("equilibrium", f"no stable one found {self.searched}")
        else:
            yield Row("stable equilibrium", ", ".join(map(micrometres, held.position)) + " um")
            yield Row("axis of the body", _direction(self._axis(held)))
            k = np.diag(held.stiffness)
            turning = _without_rounding(k[ANGLE])
            yield Row("stiffness (x, y, z)", printed(tuple(k[PLACE]), "pN/um"))
            yield Row("against rotation (x, y, z)", printed(tuple(turning), "pN um"))
            if held.rotation is not None and any(held.rotation):
                spin = _without_rounding(np.asarray(held.rotation))
                yield Row("steady rotation (x, y, z)", printed(tuple(spin), "rad/s"))
            yield Row("coupling of both", f"{held.coupling:.3g} of the largest stiffness")
            largest = np.abs(held.eigenvalues).max()
            values = [
                0j if np.abs(each).max() < FREE * largest else complex(*each)
                for each in held.eigenvalues
            ]
            words = ", ".join(_complex_text(1e6 * value) for value in values)
            yield Row("eigenvalues", f"{words} pN/um", detail=True)
            if held.relaxation_rates is not None:
                rates = [complex(*each) for each in held.relaxation_rates]
                most = max(map(abs, rates))
                words = ", ".join(_complex_text(each if abs(each) > FREE * most else 0j)
                                  for each in rates)  # fmt: skip
                yield Row("relaxation rates", f"{words} 1/s", detail=True)
            turned = ", ".join(f"{each:.4g}" for each in held.orientation)
            yield Row("Euler parameters", turned, detail=True)
            for each in self.escapes:
                yield Row(f"escape force {each.direction}", printed(abs(each.force), "pN"))
        if self.torque_efficiency is not None:
            yield Row("largest torque", f"{self.torque_efficiency:.3g} P/omega")
        if self.absorbed_power is not None:
            yield Row("absorbed power", printed(self.absorbed_power, "mW"))
        if self.scene.heat is not None:
            yield Row("heat", heated(self.scene).heat_in_words())
        yield Row("error of the force", printed(self.force_error, "pN", 1), detail=True)
        yield Row("T-matrix", f"degree {self.t_matrix.degree}, error {self.t_matrix.error:.1g}, "
                  f"unitarity {self.t_matrix.unitarity:.1g}, reciprocity "
                  f"{self.t_matrix.reciprocity:.1g}", detail=True)  # fmt: skip
        yield Row("searched", self.searched, detail=True)

    def _axis(self, place: BodyEquilibrium) -> Array:
        """Return the direction of the body's axis of revolution, or else of its z axis."""
        axes = self.t_matrix.axes_of_revolution
        return place.direction_of(axes[0]) if len(axes) == 1 else place.axis

    def _places(self) -> Table:
        """Return the table of all equilibria."""
        return Table(
            ("equilibrium", "position, um", "axis of the body"),
            tuple(
                ("stable" if each.stable else "unstable",
                 ", ".join(map(micrometres, each.position)), _direction(self._axis(each)))
                for each in self.equilibria
            ),
        )  # fmt: skip


def _without_rounding(components: Array) -> Array:
    """Return components (3,), with 0 for those that are rounding compared with the largest."""
    size = np.abs(components)
    return np.where(size > FREE * size.max(), components, 0.0)


def _complex_text(value: complex) -> str:
    """Return a number as text, with its imaginary part if it has one."""
    if abs(value.imag) <= 1e-6 * abs(value):
        return f"{value.real:.4g}"
    return f"{value.real:.4g}{value.imag:+.4g}i"


def _direction(axis: Array) -> str:
    """Return a direction in words, such as "along z", or its components."""
    for name, component in zip("xyz", axis, strict=True):
        if abs(component) > 1 - 1e-9:
            return f"along {name}"
    return ", ".join(f"{0.0 + round(each, 4):.4g}" for each in axis)


def body_trap(scene: Scene) -> BodyTrap:
    """Characterise the trap of a body that is not a sphere.

    Equilibria are searched from several starts at the focus of each beam, with the axis of the body
    along and across the light and tilted. Each search follows force and torque with damped steps,
    which end in Newton's method with the exact derivative. Its weight acts at the centre of
    mass, which is its position, and buoyancy at the centre of volume.

    An equilibrium is stable if overdamped motion about it decays. The rates are the eigenvalues of
    mobility times stiffness. Where the drag of the body is not known, the eigenvalues of the
    stiffness decide, with angles multiplied by the radius that encloses the body.

    Parameters
    ----------
    scene : Scene
        Scene whose bead is not a sphere.

    Returns
    -------
    BodyTrap
        The trap.

    Raises
    ------
    SceneError
        For a scene without light, or for a wall.
    """
    if not scene.lit:
        raise SceneError("beam: a body requires light to be trapped")
    if scene.wall is not None:
        raise SceneError(
            f"wall: bead.shape = {scene.bead.shape!r} is characterised without walls; remove it"
        )
    search = PoseSearch(scene)
    found, starts = search.equilibria()
    stable = [each for each in found if each.stable]
    held = min(stable, key=lambda each: float(np.linalg.norm(each.position)), default=None)
    pulled: tuple[Escape, ...] = ()
    efficiency = absorbed = None
    error = 0.0
    if held is not None:
        position, orientation = np.asarray(held.position), np.asarray(held.orientation)
        pulled = search.escapes(held)
        efficiency = _torque_efficiency(scene, search.light, position, orientation)
        absorbed = _absorbed(search, position, orientation)
        field_there = search.light.field(position[None], orientations=orientation[None])
        error = float(field_there.error[0])
    return BodyTrap(
        scene=scene, equilibria=tuple(found), equilibrium=held, escapes=pulled,
        torque_efficiency=efficiency, absorbed_power=absorbed, force_error=error,
        searched=f"from {starts} starts",
    )  # fmt: skip


def _torque_efficiency(
    scene: Scene, light: LightForce | Beams, position: Array, orientation: Array
) -> float:
    """Return the largest torque times omega over the power, turned about x and about y."""
    angles = np.linspace(0.0, math.pi, 37)[:-1]
    start = Rotation.from_quat(orientation, scalar_first=True)
    turned = np.stack([
        (Rotation.from_rotvec(angle * about) * start).as_quat(scalar_first=True)
        for about in np.eye(3)[:2] for angle in angles
    ])  # fmt: skip
    places = np.broadcast_to(position, (len(turned), 3))
    found = light.field(np.ascontiguousarray(places), orientations=turned)
    power = sum(beam.power_through_pupil or beam.power or 0.0 for beam in scene.beams)
    omega = 2 * math.pi * SPEED_OF_LIGHT / scene.beam.wavelength
    return float(np.linalg.norm(found.moment, axis=1).max() * omega / power)


def _absorbed(search: PoseSearch, position: Array, orientation: Array) -> float | None:
    """Return the power that the body absorbs, W; None if it absorbs none."""
    from tweezer.optics.bodies.by_sums import absorbed_of

    if search.body.lossless:
        return None
    return float(absorbed_of(search.light, position[None], orientation[None], 0.0)[0])
