"""Poses of a body at which force and torque vanish, or balance the drag of a steady rotation.

Some motions leave the wrench W in the body's frame unchanged. A body of revolution may turn about
its axis. In light that is the same all around its axis, position and body may turn about the light.
A steady motion along such directions v_j, with the twist V = sum_j c_j v_j, balances
W = R V, where R is the resistance. A body at rest is the case V = 0. The motion has no inertia.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation
from scipy.special import ndtr

from tweezer.dynamics.escape import Escape, escapes, escapes_from_ring
from tweezer.dynamics.layout import Layout
from tweezer.fluid.resistance.of_scene import resistance
from tweezer.optics import Beams, LightForce, light_force
from tweezer.optics.bodies.by_sums import derivative_of
from tweezer.optics.bodies.shapes import t_matrix
from tweezer.optics.heat import heated
from tweezer.scene import Scene
from tweezer.values.arrays import Array
from tweezer.values.errors import SceneError
from tweezer.values.vectors import Comparable, Vector, fixed

#: Force and torque, or displacement and rotation, in a vector of six
PLACE, ANGLE = slice(0, 3), slice(3, 6)
#: Axes of the body at the starts of the search, and distance of the starts from the focus, radii
_AXES = (
    (0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.6, 0.0, 0.8), (0.0, 0.6, 0.8),
    (0.5, -0.7, 0.5), (-0.8, 0.5, 0.3),
)  # fmt: skip
#: Further start for a body whose ends differ
_UPSIDE_DOWN = (0.06, 0.0, -0.998)
#: Pose at which both ends of a body are compared, in radii and as an axis, and the largest
#: difference of the wrenches, as a part of the light's force, if both ends are alike
_ASIDE, _TILTED, _ALIKE = (0.3, 0.2, 0.4), (0.5, -0.7, 0.5), 1e-5
#: Distance of the centre of volume from an axis of revolution that counts as zero, m
_OFF_AXIS = 1e-15
#: Starts along the axis of each beam from its focus, in radii that enclose the body
_HEIGHTS = (0.3, 1.0)
#: Most steps of a search, and those of Newton's method at its end
_STEPS, _NEWTON = 400, 40
#: Largest step: part of the wavelength in the medium, and rad
_FARTHEST, _TURN = 0.1, 0.3
#: Force that vanishes, as a part of the light's momentum flux on the body
_VANISHED = 1e-9
#: Stiffness that counts as zero, as a part of the largest
FREE = 1e-7
#: Normal numbers from which a pose is drawn: six displacements, and turns about at most three axes
#: of the body and the axis of the light
DRAWN = Layout({"displacement": 6, "turn": 4})
#: Distance of two equilibria that are the same, in radii, and angle, rad
_SAME, _SAME_ANGLE = 1e-4, 1e-3


@dataclass(frozen=True, eq=False)
class BodyEquilibrium(Comparable):
    """A position and orientation at which a body rests, or rotates steadily."""

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
    """remaining force, with torques over `length` and without the drag of `rotation`, N"""
    length: float
    """length by which angles are multiplied, m: the radius that encloses the body"""
    relaxation_rates: Vector | None = None
    """(6, 2) 1/s, real and imaginary part of the eigenvalues of mobility times stiffness, in
    ascending order of the real part: the rates of overdamped motion, for a steady rotation about
    it. None where the drag of the body is not known (`tweezer.resistance`)"""
    rotation: Vector | None = None
    """(3,) rad/s, angular velocity of the steady rotation, laboratory axes; 0 at rest. It is about
    an axis of revolution of the body, or about the axis of light that is symmetric. None where the
    drag of the body is not known"""

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
        across = max(size[PLACE, ANGLE].max(), size[ANGLE, PLACE].max())
        return float(across / max(size[PLACE, PLACE].max(), size[ANGLE, ANGLE].max()))


@dataclass(frozen=True, eq=False)
class Rest:
    """Pose at which a body rests, and distances from it in position and orientation."""

    position: Array
    """(3,) m"""
    orientation: Array
    """(4,) Euler parameters"""
    length: float
    """length by which angles are multiplied, m"""
    axes: Array
    """(n, 3) axes of revolution of the body, in its frame"""
    around: bool
    """whether poses that differ by a turn about the z axis are the same"""
    alike: bool
    """whether both ends of an axis of revolution are alike"""

    def distances(self, positions: Array, orientations: Array) -> Array:
        """Return the distances (n,), m, of poses: the root of the squared distance and the squared
        angle times `length`.

        Turns that change nothing do not count, and neither does the sign of an axis of revolution
        whose ends are alike.

        Parameters
        ----------
        positions : ndarray, shape (n, 3)
            Positions, m.
        orientations : ndarray, shape (n, 4)
            Euler parameters.
        """
        apart, turned = self.apart(positions), _rotation(orientations)
        return np.hypot(np.linalg.norm(apart, axis=1), self.length * self._angles(turned))

    def apart(self, positions: Array) -> Array:
        """Return displacements from the pose, m: (n, 3), or (n, 2) in radius and height for a pose
        on an orbit about the z axis.

        Parameters
        ----------
        positions : ndarray, shape (n, 3)
            Positions, m.
        """
        radius = math.hypot(*self.position[:2])
        if not self.around or radius < _SAME * self.length:
            return np.asarray(positions - self.position)
        across = np.hypot(positions[:, 0], positions[:, 1]) - radius
        return np.column_stack([across, positions[:, 2] - self.position[2]])

    def _angles(self, turned: Rotation) -> Array:
        """Return the smallest angles (n,) by which orientations differ from the pose, rad."""
        here = _rotation(self.orientation)
        if len(self.axes) > 1:
            return np.zeros(len(turned))
        if len(self.axes) == 1:
            axes, axis = turned.apply(self.axes[0]), here.apply(self.axes[0])
            if self.around:
                tilts = np.arccos(self._cosines(np.array([*axes[:, 2], axis[2]])))
                return np.asarray(np.abs(tilts[:-1] - tilts[-1]))
            return np.arccos(self._cosines(axes @ axis))
        e = (turned * here.inv()).as_quat(scalar_first=True)
        cosines = np.hypot(e[:, 0], e[:, 3]) if self.around else np.abs(e[:, 0])
        return 2 * np.arccos(np.clip(cosines, 0.0, 1.0))

    def _cosines(self, values: Array) -> Array:
        """Return cosines of angles to an axis (n,), of the nearer end if both ends are alike."""
        return np.clip(np.abs(values) if self.alike else values, -1.0, 1.0)


class _Steady(NamedTuple):
    """Steady rotation at a pose, in the units of `_scaled`."""

    twist: Array
    """(6,) velocity of the centre and angular velocity times `length`, m/s, in laboratory axes"""
    orbit: Array
    """(6,) part of `twist` about the axis of the light; the rest turns the body about its own"""
    drag: Array
    """(6,) N, force and torque over `length` that balance the drag of `twist`"""


class PoseSearch:
    """Search for poses at which a body rests or rotates steadily.

    Parameters
    ----------
    scene : Scene
        Scene whose bead is not a sphere, with light.
    time : float, optional
        Time at which the light is evaluated, s.
    """

    def __init__(self, scene: Scene, time: float = 0.0) -> None:
        self.scene = scene = heated(scene)
        self.light: LightForce | Beams = light_force(scene)
        self.body = t_matrix(scene)
        self.length = self.body.radius
        self.time = time
        self.foci = np.unique(self.light.foci(time), axis=0)
        self.axes = self.body.axes_of_revolution
        self.around = _same_all_around(self.light, time)
        self._resistance = _resistance(scene, self.length)
        bead, forces, medium = scene.body, scene.forces, scene.medium
        g = forces.gravitational_acceleration
        self._lift = np.array([0.0, 0.0, medium.density * bead.volume * g * forces.buoyancy])
        self._weight = self._lift - [0.0, 0.0, bead.mass * g * forces.gravity]
        self._centre_of_volume = np.array(bead.centre_of_volume)
        self._wavelength = min(beam.wavelength for beam in scene.beams) / medium.refractive_index
        beside = np.cross(self.axes, self._centre_of_volume)
        self._hangs = bool(self._lift.any() and np.abs(beside).max(initial=0.0) > _OFF_AXIS)
        self.alike = self._ends_are_alike()

    def equilibria(self) -> tuple[list[BodyEquilibrium], int]:
        """Return the equilibria found from several starts at each focus, and the number of starts.

        The stable ones come first, in ascending order of z.
        """
        found: list[BodyEquilibrium] = []
        axes = _AXES if self.alike else (*_AXES, _UPSIDE_DOWN)
        starts = list(itertools.product(self.foci, _HEIGHTS, axes))
        for focus, height, axis in starts:
            start = focus + np.array([0.0, 0.0, height * self.length])
            if axis[2] not in (0.0, 1.0):  # off the axis too, to leave what is symmetric
                start[:2] += 0.1 * self.length * np.array([0.7, 0.4])
            place = self.relaxed(start, _turning(np.array(axis)))
            if place is not None and not any(self.same(place, each) for each in found):
                found.append(place)
        found.sort(key=lambda each: (not each.stable, float(each.position[2])))
        return found, len(starts)

    def nearest(self) -> BodyEquilibrium | None:
        """Return the stable equilibrium nearest the focus; None if none is found."""
        stable = (each for each in self.equilibria()[0] if each.stable)
        return min(stable, key=lambda each: float(np.linalg.norm(each.position)), default=None)

    def rest(self, place: BodyEquilibrium) -> Rest:
        """Return the pose of an equilibrium, from which distances are measured."""
        r, e = np.asarray(place.position), np.asarray(place.orientation)
        return Rest(r, e, self.length, self.axes, self.around, self.alike)

    def drawn(self, place: BodyEquilibrium, kT: float, normals: Array) -> tuple[Array, Array]:
        """Return poses in the stationary distribution of the linear overdamped motion.

        The covariance S of displacements solves A S + S A^T = 2 kT B, where A is the matrix of
        `relaxation_rates` and B the mobility. Turns that change nothing are uniformly distributed.

        Parameters
        ----------
        place : BodyEquilibrium
            Stable equilibrium.
        kT : float
            Thermal energy, J.
        normals : ndarray, shape (n, DRAWN.width)
            Standard normal numbers.

        Returns
        -------
        tuple of ndarray
            Positions (n, 3), m, and Euler parameters (n, 4).
        """
        from scipy.linalg import null_space, solve_continuous_lyapunov

        r, e = np.asarray(place.position), np.asarray(place.orientation)
        turning = place.rotation is not None and bool(np.any(place.rotation))
        motions = self._unchanging(r, e)
        ways = null_space(motions) if len(motions) else np.eye(6)
        decay = ways.T @ self._decay(r, e, np.asarray(place.stiffness), turning=turning) @ ways
        noise = 2 * kT * ways.T @ np.linalg.inv(self._drag(e)) @ ways
        covariance = solve_continuous_lyapunov(decay, noise)
        root = ways @ np.linalg.cholesky(0.5 * (covariance + covariance.T))
        moved = normals[:, DRAWN.at("displacement")][:, : root.shape[1]] @ root.T
        angles = 2 * math.pi * ndtr(normals[:, DRAWN.at("turn")])
        turned = Rotation.from_rotvec(moved[:, ANGLE] / self.length) * _rotation(e)
        for axis, angle in zip(self.axes, angles.T, strict=False):
            turned = turned * Rotation.from_rotvec(angle[:, None] * axis)
        positions = r + moved[:, PLACE]
        if self.around:
            about = Rotation.from_rotvec(angles[:, -1:] * [0.0, 0.0, 1.0])
            positions, turned = about.apply(positions), about * turned
        return positions, turned.as_quat(scalar_first=True)

    def escapes(self, place: BodyEquilibrium) -> tuple[Escape, ...]:
        """Return the escapes from an equilibrium at its orientation, along the axes, or across the
        orbit about the axis of the light on which it is. The drag of the orbit is balanced.
        """
        r, e = np.array(place.position), np.array(place.orientation)
        orbits = self.around and math.hypot(r[0], r[1]) > _SAME * self.length
        if orbits:
            turned = Rotation.from_rotvec([0.0, 0.0, -math.atan2(r[1], r[0])])
            r, e = turned.apply(r), (turned * _rotation(e)).as_quat(scalar_first=True)
        drag = self._steady(r, e).drag[PLACE]

        def net_force(points: Array) -> Array:
            """Return the force less the drag of the steady motion at points (n, 3), m: (n, 3) N."""
            return self.force_at(e, points) - drag

        if orbits:
            return escapes_from_ring(self.scene, self.light.search, net_force, r)
        return escapes(self.scene, self.light.search, net_force, r, symmetric=False)

    def force_at(self, orientation: Array, points: Array) -> Array:
        """Return light and weight at points (n, 3), m, with one orientation, (n, 3) N."""
        turned = np.ascontiguousarray(np.broadcast_to(orientation, (len(points), 4)))
        found = self.light.field(points, time=self.time, orientations=turned)
        return found.force + self._weight

    def wrench(self, position: Array, orientation: Array) -> Array:
        """Return force, N, and torque over the length, N, on the body, (6,)."""
        found = self.light.field(position[None], time=self.time, orientations=orientation[None])
        lever = _rotation(orientation).apply(self._centre_of_volume)
        moment = found.moment[0] + np.cross(lever, self._lift)
        return np.concatenate([found.force[0] + self._weight, moment / self.length])

    def stiffness(self, position: Array, orientation: Array) -> Array:
        """Return the stiffness matrix (6, 6), in N/m, N, N and N m."""
        found = -derivative_of(self.light, position[None], orientation[None], self.time)[0]
        lever = _rotation(orientation).apply(self._centre_of_volume)
        found[ANGLE, ANGLE] += (lever @ self._lift) * np.eye(3) - np.outer(lever, self._lift)
        return found

    def relaxed(self, position: Array, orientation: Array) -> BodyEquilibrium | None:
        """Return the equilibrium that a search from a start finds; None if it finds none.

        The steps solve (K + damping) step = force, with a damping that follows the force. They are
        damped motion at first and Newton's method at the end. The drag of a steady rotation at each
        pose is subtracted from the force.
        """
        r, e = position, orientation
        force = self._unbalanced(r, e)
        farthest = _FARTHEST * self._wavelength
        reach = self.light.search.reach
        damping = None
        scale = 0.0
        for _ in range(_STEPS):
            k = self._slope(r, e, self.stiffness(r, e))
            size = float(np.linalg.norm(force))
            scale = max(scale, size)
            if damping is None:
                damping = float(np.abs(k).max())
                scale = max(scale, damping * farthest)  # a search may start at an equilibrium
            step = np.linalg.solve(k + damping * np.eye(6), force)
            angle = _length(step[ANGLE]) / self.length
            step *= min(1.0, farthest / _length(step[PLACE]), _TURN / angle)
            r, e = r + step[PLACE], _turned(e, step[ANGLE] / self.length)
            if np.linalg.norm(r) > reach:
                return None
            before, force = size, self._unbalanced(r, e)
            size = float(np.linalg.norm(force))
            damping *= min(1.5, max(0.3, size / before)) if before else 1.0
            if size <= _VANISHED * scale or damping < 1e-9 * np.abs(k).max():
                break
        for _ in range(_NEWTON):
            k = self._slope(r, e, self.stiffness(r, e))
            step = np.linalg.pinv(k, rcond=FREE) @ force
            if np.linalg.norm(step) > farthest:
                return None
            r, e = r + step[PLACE], _turned(e, step[ANGLE] / self.length)
            force = self._unbalanced(r, e)
            if np.linalg.norm(step) < 1e-15 * self.length:
                break
        if np.linalg.norm(force) > _VANISHED * scale:
            return None
        return self._found(r, e, force, scale)

    def _found(self, r: Array, e: Array, force: Array, scale: float) -> BodyEquilibrium:
        """Return the equilibrium at a pose with its stability.

        `force` (6,), N, is what remains there, and `scale`, N, the largest force of the search.
        """
        stiffness, steady = self.stiffness(r, e), self._steady(r, e)
        values = _sorted(np.linalg.eigvals(_scaled(stiffness, self.length)))
        turning = bool(np.linalg.norm(steady.drag) > _VANISHED * scale)
        rates = rotation = None
        if self._resistance is not None:
            rotation = steady.twist[ANGLE] / self.length if turning else np.zeros(3)
            decay = self._decay(r, e, stiffness, turning=turning)
            rates = _sorted(np.linalg.eigvals(decay))
        judged = values if rates is None else rates
        free = np.abs(judged.real) <= FREE * np.abs(judged).max()
        stable = bool((judged.real[~free] > 0).all() and free.sum() <= len(self._unchanging(r, e)))
        r = np.where(np.abs(r) < 1e-13 * self.length, 0.0, r)
        return BodyEquilibrium(
            fixed(r), fixed(e), fixed(stiffness), _parts(values), stable,
            float(np.linalg.norm(force)), self.length, None if rates is None else _parts(rates),
            None if rotation is None else fixed(rotation),
        )  # fmt: skip

    def _decay(self, r: Array, e: Array, stiffness: Array, *, turning: bool) -> Array:
        """Return the matrix A, 1/s, of the overdamped motion about a pose: d(xi)/dt = -A xi.

        The displacement xi is in laboratory axes, in the units of `_scaled`, and follows the
        orbit of a body that is `turning`.
        """
        slope = self._slope(r, e, stiffness) if turning else _scaled(stiffness, self.length)
        return np.asarray(np.linalg.inv(self._drag(e)) @ slope)

    def _slope(self, r: Array, e: Array, stiffness: Array) -> Array:
        """Return the decrease of the unbalanced wrench with a displacement xi, (6, 6) N/m.

        The displacement follows the orbit V_o of the steady rotation. With the wrench W that drag
        balances, whose components in the body's frame change by W x angle as the body turns, it is
        K xi - W x angle + R [V_o, xi].
        """
        steady = self._steady(r, e)
        turned, follows = np.zeros((6, 6)), np.kron(np.eye(2), _crossing(steady.orbit[ANGLE]))
        turned[PLACE, ANGLE] = _crossing(steady.drag[PLACE])
        turned[ANGLE, ANGLE] = _crossing(steady.drag[ANGLE])
        follows[PLACE, ANGLE] += _crossing(steady.orbit[PLACE])
        return _scaled(stiffness, self.length) + (self._drag(e) @ follows - turned) / self.length

    def _unbalanced(self, position: Array, orientation: Array) -> Array:
        """Return the wrench less the drag of the steady rotation at a pose, (6,) N."""
        return self.wrench(position, orientation) - self._steady(position, orientation).drag

    def _steady(self, position: Array, orientation: Array) -> _Steady:
        """Return the steady rotation whose drag is closest to the wrench at a pose.

        A body whose centre of volume is off its axis does not turn about it, but hangs.
        """
        own, motions = self._own(orientation), self._unchanging(position, orientation)
        if self._hangs:
            own, motions = own[:0], motions[len(own) :]
        drags = self._drag(orientation) @ motions.T
        wrench = self.wrench(position, orientation)
        speeds = np.linalg.lstsq(drags, wrench, rcond=_SAME_ANGLE)[0]
        return _Steady(speeds @ motions, speeds[len(own) :] @ motions[len(own) :], drags @ speeds)

    def _ends_are_alike(self) -> bool:
        """Return whether a body of revolution may be turned upside down without any change."""
        if len(self.axes) != 1:
            return True
        place, tilted = self.foci[0] + self.length * np.array(_ASIDE), _turning(np.array(_TILTED))
        across = np.linalg.svd(self.axes)[2][1]
        over = (_rotation(tilted) * Rotation.from_rotvec(math.pi * across)).as_quat(
            scalar_first=True
        )
        here, there = self.wrench(place, tilted), self.wrench(place, over)
        of_light = np.linalg.norm(here[PLACE] - self._weight)
        return bool(np.linalg.norm(here - there) <= _ALIKE * of_light)

    def _drag(self, orientation: Array) -> Array:
        """Return the resistance in laboratory axes, (6, 6) in N s/m.

        It is the unit matrix where the drag of the body is not known.
        """
        if self._resistance is None:
            return np.eye(6)
        frame = np.kron(np.eye(2), _rotation(orientation).as_matrix())
        return np.asarray(frame @ self._resistance @ frame.T)

    def _own(self, orientation: Array) -> Array:
        """Return turns about the body's axes of revolution as twists (n, 6), laboratory axes."""
        turns = self.axes @ _rotation(orientation).as_matrix().T
        return np.hstack([np.zeros_like(turns), turns])

    def _unchanging(self, position: Array, orientation: Array) -> Array:
        """Return independent twists (n, 6) at a pose that leave the wrench in the body's frame
        alone.

        These are turns about the body's axes of revolution, and then about the axis of the light if
        that is the same all around.
        """
        motions = self._own(orientation)
        if self.around:
            z = np.array([0.0, 0.0, 1.0])
            more = np.vstack([motions, [*np.cross(z, position) / self.length, *z]])
            if np.linalg.matrix_rank(more, tol=_SAME_ANGLE) == len(more):
                return more
        return motions

    def same(self, one: BodyEquilibrium, other: BodyEquilibrium) -> bool:
        """Return whether motions that change nothing lead from one equilibrium to the other.

        The axis of a body of revolution whose ends are alike is compared without its sign.
        """
        (position, directions), (place, turned) = self._pose(one), self._pose(other)
        if np.linalg.norm(position - place) > _SAME:
            return False
        signs = (1.0, -1.0) if len(self.axes) == 1 and self.alike else (1.0,)
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


def _same_all_around(light: LightForce | Beams, time: float) -> bool:
    """Return whether the light is the same all around the z axis at a time, s."""
    if isinstance(light, Beams):
        return all(each.light.symmetric for each in light.lights) and not any(
            moved.place.at(time)[:2].any() for moved in light.forces
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


def _resistance(scene: Scene, length: float) -> Array | None:
    """Return the resistance of the bead, (6, 6) N s/m, in the body's frame with angles times a
    length; None if it is not known.
    """
    try:
        return _scaled(resistance(scene).matrix, length)
    except SceneError:
        return None


def _crossing(vector: Array) -> Array:
    """Return the matrix (3, 3) of the vector product `vector` x angle."""
    x, y, z = vector.tolist()
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def _scaled(stiffness: Array, length: float) -> Array:
    """Return a stiffness or a resistance with angles times a length, N/m or N s/m."""
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
