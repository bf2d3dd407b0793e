"""The trap of a body that is not a sphere: equilibria in position and orientation."""

from __future__ import annotations

import dataclasses
import functools
import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation

from tweezer.dynamics.escape import Escape, escapes
from tweezer.fluid.resistance.of_scene import resistance
from tweezer.optics import Beams, LightForce, light_force
from tweezer.optics.bodies.by_sums import derivative_of
from tweezer.optics.bodies.shapes import t_matrix
from tweezer.optics.bodies.t_matrix import TMatrix
from tweezer.optics.light import SPEED_OF_LIGHT
from tweezer.scene import Scene
from tweezer.trap import quantities as known
from tweezer.values.arrays import Array
from tweezer.values.errors import SceneError
from tweezer.values.measured import Measured, Quantity, Result
from tweezer.values.printed import printed
from tweezer.values.rounding import micrometres
from tweezer.values.shown import Card, Row, Table
from tweezer.values.vectors import Comparable, Vector, fixed

#: Force and torque, or displacement and rotation, in a vector of six
_PLACE, _ANGLE = slice(0, 3), slice(3, 6)
#: Axes of the body at the starts of the search, and distance of the starts from the focus, radii
_AXES = (
    (0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.6, 0.0, 0.8), (0.0, 0.6, 0.8),
    (0.5, -0.7, 0.5), (-0.8, 0.5, 0.3),
)  # fmt: skip
#: Starts along the axis of each beam from its focus, in radii that enclose the body
_HEIGHTS = (0.3, 1.0)
#: Most steps of a search, and those of Newton's method at its end
_STEPS, _NEWTON = 400, 12
#: Largest step: part of the wavelength in the medium, and rad
_FARTHEST, _TURN = 0.1, 0.3
#: Force that vanishes, as a part of the light's momentum flux on the body
_VANISHED = 1e-9
#: Stiffness that counts as zero, as a part of the largest
_FREE = 1e-7
#: Distance of two equilibria that are the same, in radii, and angle, rad
_SAME, _SAME_ANGLE = 1e-4, 1e-3


@dataclass(frozen=True, eq=False)
class BodyEquilibrium(Comparable):
    """A position and orientation at which force and torque on a body vanish."""

    position: Vector
    """(3,) m, of the body's centre from the focus"""
    orientation: Vector
    """(4,) Euler parameters, scalar first, from the body to the laboratory"""
    stiffness: Vector
    """-d(F, M)/d(position, angle), (6, 6) in N/m, N, N and N m, with angles about the laboratory's
    axes. It is not symmetric, because the force of light has no potential"""
    eigenvalues: Vector
    """(6, 2) N/m, real and imaginary part of the eigenvalues of `stiffness` with angles times
    `length`, in ascending order of the real part. Those of motions that change nothing are 0: turns
    about an axis of revolution of the body, and about the axis of light that is symmetric"""
    stable: bool
    """whether all relaxation rates, or all eigenvalues where the drag is not known, have positive
    real parts, except those of motions that change nothing"""
    residual: float
    """remaining force, with torques over `length`, N"""
    length: float
    """length by which angles are multiplied, m: the radius that encloses the body"""
    relaxation_rates: Vector | None = None
    """(6, 2) 1/s, real and imaginary part of the eigenvalues of mobility times stiffness, in
    ascending order of the real part: the rates of overdamped motion. None where the drag of the
    body is not known (`tweezer.resistance`)"""

    @property
    def axis(self) -> Array:
        """Direction of the body's z axis, (3,), with the sign chosen so that z >= 0."""
        return self.direction_of((0.0, 0.0, 1.0))

    def direction_of(self, axis: ArrayLike) -> Array:
        """Return the direction of an axis of the body, (3,), with the sign so that z >= 0.

        Parameters
        ----------
        axis : array_like, shape (3,)
            Axis in the body's frame, of length 1.
        """
        turned = _rotation(np.asarray(self.orientation)).apply(axis)
        first = next((each for each in turned[::-1] if abs(each) > 1e-9), 1.0)
        return np.asarray(0.0 + (turned if first > 0 else -turned))

    @property
    def coupling(self) -> float:
        """Largest element that couples translation and rotation, over the largest other, no unit.

        Angles are multiplied by `length`.
        """
        size = np.abs(_scaled(np.asarray(self.stiffness), self.length))
        across = max(size[_PLACE, _ANGLE].max(), size[_ANGLE, _PLACE].max())
        return float(across / max(size[_PLACE, _PLACE].max(), size[_ANGLE, _ANGLE].max()))


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
    """escapes from `equilibrium` along the axes, at its orientation"""
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

    def quantities(self) -> Iterator[Measured]:
        """Yield the quantities of the trap at its stable equilibrium."""
        held, error = self.equilibrium, self.force_error
        if held is not None:
            of_stiffness = error * known.gradient_of_errors(self.scene)
            stiffness, values = np.diag(held.stiffness), np.asarray(held.eigenvalues)[:, 0]
            softest = min(values[np.abs(values) > _FREE * np.abs(values).max()])
            yield known.EQUILIBRIUM(held.position, error / softest)
            yield known.STIFFNESS(stiffness[_PLACE], np.full(3, of_stiffness))
            # a torque is a polynomial of the rotation, of at most twice the T-matrix's degree
            of_turns = 2 * self.t_matrix.degree * error * held.length
            yield known.ROTATIONAL_STIFFNESS(stiffness[_ANGLE], np.full(3, of_turns))
            ways = self.escapes
            yield known.ESCAPE_FORCE([each.force for each in ways], np.full(len(ways), error))
        yield known.FORCE_ERROR(error)

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
            turning = np.where(np.abs(k[_ANGLE]) > _FREE * np.abs(k[_ANGLE]).max(), k[_ANGLE], 0.0)
            yield Row("stiffness (x, y, z)", printed(tuple(k[_PLACE]), "pN/um"))
            yield Row("against rotation (x, y, z)", printed(tuple(turning), "pN um"))
            yield Row("coupling of both", f"{held.coupling:.3g} of the largest stiffness")
            largest = np.abs(held.eigenvalues).max()
            values = [
                0j if np.abs(each).max() < _FREE * largest else complex(*each)
                for each in held.eigenvalues
            ]
            words = ", ".join(_complex_text(1e6 * value) for value in values)
            yield Row("eigenvalues", f"{words} pN/um", detail=True)
            if held.relaxation_rates is not None:
                rates = [complex(*each) for each in held.relaxation_rates]
                most = max(map(abs, rates))
                words = ", ".join(_complex_text(each if abs(each) > _FREE * most else 0j)
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
    search = _Search(scene)
    found: list[BodyEquilibrium] = []
    starts = list(itertools.product(search.foci, _HEIGHTS, _AXES))
    for focus, height, axis in starts:
        start = focus + np.array([0.0, 0.0, height * search.length])
        if axis[2] not in (0.0, 1.0):  # off the axis too, to leave what is symmetric
            start[:2] += 0.1 * search.length * np.array([0.7, 0.4])
        place = search.relaxed(start, _turning(np.array(axis)))
        if place is not None and not any(search.same(place, each) for each in found):
            found.append(place)
    found.sort(key=lambda each: (not each.stable, float(each.position[2])))
    stable = [each for each in found if each.stable]
    held = min(stable, key=lambda each: float(np.linalg.norm(each.position)), default=None)
    pulled: tuple[Escape, ...] = ()
    efficiency = absorbed = None
    error = 0.0
    if held is not None:
        position, orientation = np.asarray(held.position), np.asarray(held.orientation)
        pulled = escapes(
            scene, search.light.search, functools.partial(search.force_at, orientation), position,
            symmetric=False,
        )  # fmt: skip
        efficiency = search.torque_efficiency(position, orientation)
        absorbed = search.absorbed(position, orientation)
        field_there = search.light.field(position[None], orientations=orientation[None])
        error = float(field_there.error[0])
    return BodyTrap(
        scene=scene, equilibria=tuple(found), equilibrium=held, escapes=pulled,
        torque_efficiency=efficiency, absorbed_power=absorbed, force_error=error,
        searched=f"from {len(starts)} starts",
    )  # fmt: skip


class _Search:
    """Search for positions and orientations at which force and torque vanish."""

    def __init__(self, scene: Scene) -> None:
        self.light: LightForce | Beams = light_force(scene)
        self.body = t_matrix(scene)
        self.length = self.body.radius
        self.foci = _foci_of(self.light)
        self.axes = self.body.axes_of_revolution
        self.around = _same_all_around(self.light)
        self._scene, self._mobility = scene, _mobility(scene)
        bead, forces, medium = scene.body, scene.forces, scene.medium
        g = forces.gravitational_acceleration
        self._lift = np.array([0.0, 0.0, medium.density * bead.volume * g * forces.buoyancy])
        self._weight = self._lift - [0.0, 0.0, bead.mass * g * forces.gravity]
        self._centre_of_volume = np.array(bead.centre_of_volume)
        self._wavelength = min(beam.wavelength for beam in scene.beams) / medium.refractive_index

    def force_at(self, orientation: Array, points: Array) -> Array:
        """Return light and weight at points (n, 3), m, with one orientation, (n, 3) N."""
        turned = np.broadcast_to(orientation, (len(points), 4))
        return self.light.field(points, orientations=np.ascontiguousarray(turned)).force + (
            self._weight
        )

    def wrench(self, position: Array, orientation: Array) -> Array:
        """Return force, N, and torque over the length, N, on the body, (6,)."""
        found = self.light.field(position[None], orientations=orientation[None])
        lever = _rotation(orientation).apply(self._centre_of_volume)
        moment = found.moment[0] + np.cross(lever, self._lift)
        return np.concatenate([found.force[0] + self._weight, moment / self.length])

    def stiffness(self, position: Array, orientation: Array) -> Array:
        """Return the stiffness matrix (6, 6), in N/m, N, N and N m."""
        found = -derivative_of(self.light, position[None], orientation[None], 0.0)[0]
        lever = _rotation(orientation).apply(self._centre_of_volume)
        found[_ANGLE, _ANGLE] += (lever @ self._lift) * np.eye(3) - np.outer(lever, self._lift)
        return found

    def relaxed(self, position: Array, orientation: Array) -> BodyEquilibrium | None:
        """Return the equilibrium that a search from a start finds; None if it finds none.

        The steps solve (K + damping) step = force, with a damping that follows the force. They are
        damped motion at first and Newton's method at the end.
        """
        r, e = position, orientation
        force = self.wrench(r, e)
        farthest = _FARTHEST * self._wavelength
        reach = self.light.search.reach
        damping = None
        scale = 0.0
        for _ in range(_STEPS):
            k = _scaled(self.stiffness(r, e), self.length)
            size = float(np.linalg.norm(force))
            scale = max(scale, size)
            if damping is None:
                damping = float(np.abs(k).max())
            step = np.linalg.solve(k + damping * np.eye(6), force)
            angle = _length(step[_ANGLE]) / self.length
            step *= min(1.0, farthest / _length(step[_PLACE]), _TURN / angle)
            r, e = r + step[_PLACE], _turned(e, step[_ANGLE] / self.length)
            if np.linalg.norm(r) > reach:
                return None
            before, force = size, self.wrench(r, e)
            size = float(np.linalg.norm(force))
            damping *= min(1.5, max(0.3, size / before)) if before else 1.0
            if size <= _VANISHED * scale or damping < 1e-9 * np.abs(k).max():
                break
        for _ in range(_NEWTON):
            k = _scaled(self.stiffness(r, e), self.length)
            step = np.linalg.pinv(k, rcond=_FREE) @ force
            if np.linalg.norm(step) > farthest:
                return None
            r, e = r + step[_PLACE], _turned(e, step[_ANGLE] / self.length)
            force = self.wrench(r, e)
            if np.linalg.norm(step) < 1e-15 * self.length:
                break
        if np.linalg.norm(force) > _VANISHED * scale:
            return None
        stiffness = self.stiffness(r, e)
        values = _sorted(np.linalg.eigvals(_scaled(stiffness, self.length)))
        rates = None
        if self._mobility is not None:
            turned = np.kron(np.eye(2), _rotation(e).as_matrix())
            rates = _sorted(np.linalg.eigvals(turned @ self._mobility @ turned.T @ stiffness))
        judged = values if rates is None else rates
        free = np.abs(judged) <= _FREE * np.abs(judged).max()
        stable = bool((judged.real[~free] > 0).all() and free.sum() <= self._unchanging(r, e))
        r = np.where(np.abs(r) < 1e-13 * self.length, 0.0, r)
        return BodyEquilibrium(
            fixed(r), fixed(e), fixed(stiffness), _parts(values), stable,
            float(np.linalg.norm(force)), self.length, None if rates is None else _parts(rates),
        )  # fmt: skip

    def _unchanging(self, position: Array, orientation: Array) -> int:
        """Return the number of independent motions from a pose that change nothing.

        These are turns about the body's axes of revolution, and about the axis of the light if that
        is the same all around.
        """
        turns = self.axes @ _rotation(orientation).as_matrix().T
        motions = np.hstack([np.zeros_like(turns), turns])
        if self.around:
            z = np.array([0.0, 0.0, 1.0])
            motions = np.vstack([motions, [*np.cross(z, position) / self.length, *z]])
        return int(np.linalg.matrix_rank(motions, tol=_SAME_ANGLE)) if len(motions) else 0

    def same(self, one: BodyEquilibrium, other: BodyEquilibrium) -> bool:
        """Return whether motions that change nothing lead from one equilibrium to the other.

        The axis of a body of revolution is compared without its sign.
        """
        (position, directions), (place, turned) = self._pose(one), self._pose(other)
        if np.linalg.norm(position - place) > _SAME:
            return False
        signs = (1.0, -1.0) if len(self.axes) == 1 else (1.0,)
        return any(np.linalg.norm(sign * turned - directions) < _SAME_ANGLE for sign in signs)

    def _pose(self, place: BodyEquilibrium) -> tuple[Array, Array]:
        """Return position (in `length`) and directions, as far as such motions leave them alone."""
        r, frame = (
            np.asarray(place.position) / self.length,
            _rotation(np.asarray(place.orientation)),
        )
        z, turned = np.array([0.0, 0.0, 1.0]), frame.as_matrix()
        if len(self.axes) == 0:
            return (turned.T @ r, turned.T @ z) if self.around else (r, turned.ravel())
        axis = turned @ self.axes[0] if len(self.axes) == 1 else np.zeros(3)
        if not self.around:
            return r, axis
        directions = np.array([axis @ z, axis @ r, axis @ np.cross(z, r)])
        return np.array([math.hypot(r[0], r[1]), r[2]]), directions

    def torque_efficiency(self, position: Array, orientation: Array) -> float:
        """Return the largest torque times omega over the power, turned about x and about y."""
        angles = np.linspace(0.0, math.pi, 37)[:-1]
        turned = np.stack([
            _turned(orientation, angle * about) for about in np.eye(3)[:2] for angle in angles
        ])  # fmt: skip
        places = np.broadcast_to(position, (len(turned), 3))
        found = self.light.field(np.ascontiguousarray(places), orientations=turned)
        power = sum(beam.power_through_pupil or beam.power or 0.0 for beam in self._scene.beams)
        omega = 2 * math.pi * SPEED_OF_LIGHT / self._scene.beam.wavelength
        return float(np.linalg.norm(found.moment, axis=1).max() * omega / power)

    def absorbed(self, position: Array, orientation: Array) -> float | None:
        """Return the power that the body absorbs, W; None if it absorbs none."""
        from tweezer.optics.bodies.by_sums import absorbed_of

        if self.body.lossless:
            return None
        return float(absorbed_of(self.light, position[None], orientation[None], 0.0)[0])


def _foci_of(light: LightForce | Beams) -> Array:
    """Return the different foci of the beams at time 0, (n, 3) m."""
    if isinstance(light, Beams):
        return np.unique([moved.place.at(0.0) for moved in light.forces], axis=0)
    return np.zeros((1, 3))


def _same_all_around(light: LightForce | Beams) -> bool:
    """Return whether the light is the same all around the z axis at time 0."""
    if isinstance(light, Beams):
        return all(each.light.symmetric for each in light.lights) and not any(
            moved.place.at(0.0)[:2].any() for moved in light.forces
        )
    return light.light.symmetric


def _length(vector: ArrayLike) -> float:
    """Return the length of a vector, at least the smallest number."""
    return max(float(np.linalg.norm(vector)), 1e-300)


def _sorted(values: NDArray[Any]) -> NDArray[Any]:
    """Return eigenvalues in ascending order of their real parts."""
    return values[np.argsort(values.real)]


def _parts(values: NDArray[Any]) -> Vector:
    """Return complex numbers as their real and imaginary parts, (n, 2)."""
    return fixed(np.stack([values.real, values.imag], 1))


def _mobility(scene: Scene) -> Array | None:
    """Return the mobility of the bead, (6, 6), in the body's frame; None if it is not known."""
    try:
        return resistance(scene).mobility
    except SceneError:
        return None


def _scaled(stiffness: Array, length: float) -> Array:
    """Return a stiffness matrix with angles times a length, N/m."""
    over = np.array([1.0, 1.0, 1.0, length, length, length])
    return stiffness / (over[:, None] * over)


def _turning(axis: Array) -> Array:
    """Return Euler parameters that turn z to an axis (3,) of length about 1."""
    x, y, z = axis / np.linalg.norm(axis)
    half = math.hypot(x, y, 1 + z)
    return np.array([half / 2, -y / half, x / half, 0.0])


def _turned(orientation: Array, angle: ArrayLike) -> Array:
    """Return Euler parameters turned further by an angle (3,) about the laboratory's axes, rad."""
    found: Array = (Rotation.from_rotvec(angle) * _rotation(orientation)).as_quat(scalar_first=True)
    return found


def _rotation(orientation: Array) -> Rotation:
    """Return the rotation of Euler parameters, from the body to the laboratory."""
    return Rotation.from_quat(orientation, scalar_first=True)
