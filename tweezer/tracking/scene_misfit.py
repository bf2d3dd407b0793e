"""Misfit of a scene to recordings: -2 log(likelihood) as a function of the scene's free keys."""

from __future__ import annotations

import functools
import math
import re
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares
from scipy.stats.qmc import Sobol

from tweezer.calibration.inertia import Inertia
from tweezer.calibration.spectra import TrappedBead
from tweezer.calibration.wall import ACROSS
from tweezer.dynamics.problem import bound_once
from tweezer.fluid import LOWEST
from tweezer.forces.equilibria import nearest_stable
from tweezer.forces.force import Force
from tweezer.reading.recording import Recording
from tweezer.scene import Scene, described_at, value_at, with_settings
from tweezer.tracking.mean_spring import mean_spring
from tweezer.tracking.whitened import Whitened
from tweezer.values.arrays import Array
from tweezer.values.errors import PhysicsWarning, ResultError, SceneError, UnitWarning
from tweezer.values.units import RefractiveIndex, quantity_of

#: Largest ratio between a tried value and the scene's, or largest distance in radii
_REACH = 5.0
#: Change of a place for computing derivatives, in a logarithm or in radii
_DIFFERENCE = 1e-3
#: Relative gain of the misfit (which is about 1000) and step of the place at which a search ends
_GAIN, _SHORT = 1e-5, 1e-4
#: Deviance assigned where there is no trap
_HOPELESS = 1e4
#: Number of places around the initial values that are tried, their largest distance, number of best
#: places from which minima are sought, and distance below which two minima are the same
_TRIALS, _ABOUT, _DESCENTS, _SAME = 16, 0.5, 8, 0.02
#: Number of places whose bound scenes are cached
_REMEMBERED = 16
#: Pattern of the keys that affect a bead at rest in the trap
_FITTED = re.compile(
    r"(bead|medium|lens|beam(\[\d+\])?|wall|forces)\..+|camera\.(exposure|noise|noise_along)"
)
#: Largest relative difference of a camera's rate from that of a record
_UNEVEN = 1e-3
#: Smallest distance from a wall, in radii, at which it does not change the hydrodynamic memory
_FAR = 20.0
_AXES = ("x", "y", "z")


class FreeKey:
    """Free key of a scene, which is fitted in terms of a dimensionless coordinate, its place q.

    q is 0 for the value in the scene. For a quantity that is never negative, q is the
    logarithm of the ratio to that value. For others it is the difference in units of `unit`, which
    is the radius of the bead for a length, otherwise the magnitude of the scene's value.
    """

    def __init__(self, scene: Scene, key: str) -> None:
        quantity, _ = described_at(key)
        value = value_at(scene, key)
        if quantity is None and key.endswith("refractive_index") and not isinstance(value, str):
            quantity = quantity_of(RefractiveIndex)  # for a bead that does not absorb
        if quantity is None or isinstance(value, bool | str):
            raise SceneError(f"free = {key!r}: is not a quantity that can be fitted")
        if not _FITTED.fullmatch(key):
            raise SceneError(
                f"free = {key!r}: does not affect a bead at rest in the trap; choose from keys of "
                "bead, medium, lens, beam, wall and forces, and camera.exposure, camera.noise and "
                "camera.noise_along"
            )
        if not isinstance(value, int | float):
            raise SceneError(f"free = {key!r}: the scene has no initial value for it")
        self.key, self.given, self.quantity = key, float(value), quantity
        self.logarithmic = quantity.low >= 0
        if self.logarithmic and value <= 0:
            raise SceneError(f"free = {key!r}: must have an initial value above 0 in the scene")
        self._most = math.inf
        if key == "camera.exposure" and scene.camera is not None:
            self._most = 1 / scene.camera.rate
        self.unit = 1.0
        if not self.logarithmic:
            self.unit = scene.body.size if quantity.unit == "m" else abs(self.given) or 1.0

    def value(self, q: float) -> float:
        """Return the value of the key at the place q, in SI units."""
        if self.logarithmic:
            return self.given * math.exp(q)
        return float(self.given + self.unit * q)

    def place(self, value: float) -> float:
        """Return the place q of a value in SI units."""
        if self.logarithmic:
            return math.log(value / self.given)
        return (value - self.given) / self.unit

    @property
    def reach(self) -> float:
        """Largest |q|, the distance of a place from the initial value."""
        return math.log(_REACH) if self.logarithmic else _REACH

    @property
    def bounds(self) -> tuple[float, float]:
        """Lowest and highest place q that a scene allows, within `reach` of the initial value."""
        reach = self.reach
        low, high = self.quantity.low, min(self.quantity.high, self._most)
        lowest = -math.inf if self.logarithmic and low <= 0 else self.place(low)
        return max(lowest, -reach), min(self.place(high), reach)

    def change(self, step: float) -> str:
        """Return text on the change of the key that corresponds to a step of its place."""
        if self.logarithmic:
            part = math.expm1(step)
            return f"{100 * abs(part):.2g} % {'more' if part > 0 else 'less'} {self.key}"
        return f"{self.key} {'+' if step > 0 else '-'} {abs(self.unit * step):.2g}"

    def setting(self, q: float) -> str:
        """Return the value at the place q with its unit, in the form for `with_settings`."""
        return f"{self.value(q)!r} {self.quantity.unit}".rstrip()


class Least(NamedTuple):
    """Minimum of the misfit over the values of n keys."""

    at: Array
    """(n,) place q of each key (`FreeKey`)"""
    value: float
    """-2 log(likelihood) at the minimum, up to a constant for the recordings"""
    information: Array
    """(free, free) half the second derivatives of the misfit by the keys that were not fixed"""
    converged: bool
    """whether the search ended at a minimum"""


@dataclass(frozen=True)
class Bound:
    """Scene that traps its bead, and harmonically trapped beads that approximate it."""

    scene: Scene
    beads: dict[str, TrappedBead]
    """bead for each axis, with stiffness and drag averaged over the thermal motion"""
    bending: float
    """largest relative deviation of the trap from a harmonic one, in units of the stiffness. It is
    the difference between the mean stiffness and the stiffness at the equilibrium, or the gradient
    of the force that drives the bead around the axis. Spectra are correct to first order in it"""


class Misfit:
    """Misfit, -2 log(likelihood), of recordings as a function of the places of the free keys.

    The argument q (n,) has the place of each of the n free keys (`FreeKey`). It is 0 for the scene
    itself.
    """

    def __init__(
        self,
        recordings: Sequence[Recording],
        scene: Scene,
        free: Sequence[str],
        forces: Sequence[Force] = (),
    ) -> None:
        if not free:
            raise SceneError("free: nothing to fit; name one or more keys of the scene")
        for key in free:
            if list(free).count(key) > 1:
                raise SceneError(f"free = {key!r}: given more than once")
        self._scene, self.recordings = _with_camera(scene, recordings, free), recordings
        self._forces = forces
        # a run keeps the inertia with which it was simulated, regardless of the fitted scene
        Inertia.refuse_relaxing(scene)
        every = {Inertia.of(each.scene or scene) for each in recordings}
        if len(every) > 1:
            raise ResultError(
                "recordings: differ in simulation.model or medium.inertia; fit them separately"
            )
        (self.inertia,) = every
        self.keys = [FreeKey(self._scene, key) for key in free]
        self.bounds = np.array([each.bounds for each in self.keys])
        self.spectra = [
            Whitened.of(axis, positions, each.step)
            for each in recordings
            for axis, positions in zip(each.axes, each.positions.T, strict=True)
        ]
        self._bound = functools.lru_cache(_REMEMBERED)(self._bind)
        begin = self.bound(np.zeros(len(free)))
        if isinstance(begin, str):
            raise ResultError(f"{scene.name}: {begin}")

    def scene(self, q: Array) -> Scene:
        """Return the scene with the values of the free keys at the place q (n,)."""
        settings = {key.key: key.setting(at) for key, at in zip(self.keys, q, strict=True)}
        return with_settings(self._scene, settings)

    def bound(self, q: Array) -> Bound | str:
        """Return the beads that the scene at a place traps, or the reason why it traps none."""
        return self._bound(tuple(q.tolist()))

    def _bind(self, place: tuple[float, ...]) -> Bound | str:
        """Return the trapped beads of the scene at a place, or why there are none, uncached.

        The place is a tuple, because the cache of `bound` needs a hashable argument.
        """
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UnitWarning)
            warnings.simplefilter("ignore", PhysicsWarning)
            try:
                scene = self.scene(np.array(place))
                problem = bound_once(scene, self._forces)
            except SceneError as error:
                return str(error)
        if not problem.force.steady:
            raise SceneError("beam: a fit requires forces that do not change in time")
        rest = nearest_stable(problem.equilibria(problem.net_force_apart))
        if rest is None:
            return "the scene has no stable trap; change the first guesses of the free keys"
        mean = mean_spring(problem, rest)
        if mean is None:
            return (
                "thermal motion removes the bead from the trap; change the first guesses of the "
                "free keys"
            )
        camera = scene.camera
        assert camera is not None
        mass, fluid = self.inertia.masses(problem.scene)
        height = _height(scene, mean.position[2])
        noises = (camera.noise, camera.noise, camera.noise_along or 0.0)
        beads, temperature = {}, problem.scene.noise_temperature
        for i, axis in enumerate(_AXES):
            way = "across" if axis == ACROSS else "along"
            beads[axis] = TrappedBead(
                mean.stiffness[i], mean.drag[i], temperature, mass, camera.exposure,
                fluid if height is None or height >= LOWEST[way] else None, self.inertia.poles,
                noise=noises[i], wall=height, across=axis == ACROSS,
            )  # fmt: skip
        bending = np.abs(mean.stiffness / np.diag(rest.stiffness) - 1).max()
        return Bound(scene, beads, max(float(bending), abs(rest.turn) / mean.stiffness[:2].min()))

    def __call__(self, q: Array) -> Array:
        """Return the deviances (blocks,) of all spectra, whose sum of squares is the misfit.

        A deviance is the signed square root of the contribution of a block of frequencies. Without
        a trap, all are set to a large number.
        """
        q = np.clip(q, *self.bounds.T)
        if isinstance(self.bound(q), str):
            blocks = sum(each.periodogram.counts.size for each in self.spectra)
            return np.full(blocks, _HOPELESS)
        pairs = zip(self.spectra, self.beads(q), strict=True)
        return np.concatenate([each.deviances(bead) for each, bead in pairs])

    def beads(self, q: Array) -> list[TrappedBead]:
        """Return the bead of each spectrum at a place that has a trap."""
        bound = self.bound(q)
        assert not isinstance(bound, str)
        return [_exposed(bound.beads[each.axis], each) for each in self.spectra]

    def p_value(self, q: Array) -> float:
        """Return the p-value of the spectra, for the scene at the place q."""
        pairs = zip(self.spectra, self.beads(q), strict=True)
        every = [each.p_value(bead) for each, bead in pairs]
        return min(len(every) * min(every), 1.0)

    def curved(self, q: Array) -> float:
        """Return the relative error of the stiffness caused by anharmonicity of the trap."""
        bound = self.bound(q)
        assert not isinstance(bound, str)
        return bound.bending**2

    def minima(self, progress: Callable[[float], None]) -> list[Least]:
        """Return the distinct minima that searches from several places reach, the lowest first.

        The searches begin at the best of 16 places around the initial values.
        """
        n = len(self.keys)
        trials = _ABOUT * (2 * Sobol(n, scramble=False).random(_TRIALS) - 1)
        places = [np.clip(trial, *self.bounds.T) for trial in trials]  # include the initial values
        places.sort(key=lambda q: float((self(q) ** 2).sum()))
        found: list[Least] = []
        for i, place in enumerate(places[:_DESCENTS]):
            progress((i + 1) / (_DESCENTS + 1))
            reached = self.least(place)
            if all(np.abs(reached.at - each.at).max() > _SAME for each in found):
                found.append(reached)
        return sorted(found, key=lambda each: each.value)

    def least(self, begin: Array, fixed: int | None = None) -> Least:
        """Return the minimum that the Gauss-Newton method reaches from the place `begin` (n,).

        `fixed` is the index of a key whose value is fixed, or None if all keys are free.
        """
        free = np.arange(len(begin)) != fixed

        def whole(values: Array) -> Array:
            """Return the place of all keys, given the places of the free ones."""
            q = begin.copy()
            q[free] = values
            return q

        def slopes(values: Array) -> Array:
            """Return the derivatives (blocks, free) of the deviances by the free places."""
            here, q = self(whole(values)), whole(values)
            high = self.bounds[:, 1]
            columns = []
            for i in np.flatnonzero(free):
                step = _DIFFERENCE if q[i] + _DIFFERENCE < high[i] else -_DIFFERENCE
                aside = q.copy()
                aside[i] += step
                columns.append((self(aside) - here) / step)
            return np.stack(columns, axis=1)

        if not free.any():
            return Least(begin, float((self(begin) ** 2).sum()), np.zeros((0, 0)), True)
        low, high = self.bounds[free].T
        found = least_squares(
            lambda values: self(whole(values)), np.clip(begin[free], low, high), slopes,
            bounds=(low, high), x_scale="jac", ftol=_GAIN, xtol=_SHORT, gtol=None, max_nfev=50,
        )  # fmt: skip
        return Least(
            whole(found.x), 2 * float(found.cost), found.jac.T @ found.jac, found.status > 0
        )


def _height(scene: Scene, z: float) -> float | None:
    """Return the distance of the bead's centre at height z, m, from the nearest wall, in radii.

    Returns None without a wall, or if the wall is too far to change the hydrodynamic memory.
    """
    if scene.wall is None:
        return None
    height = 1 + float(scene.room(z)) / scene.body.size
    return height if height < _FAR else None


def _exposed(bead: TrappedBead, spectrum: Whitened) -> TrappedBead:
    """Return the bead with its exposure limited to the sampling interval, as times are rounded."""
    return replace(bead, exposure=min(bead.exposure, spectrum.periodogram.step))


def _with_camera(scene: Scene, recordings: Sequence[Recording], free: Sequence[str]) -> Scene:
    """Return the scene, with the camera of the recordings if it has none.

    Raises `ResultError` if the scene's camera differs from that of a recording in a key that is not
    `free`.
    """
    if scene.camera is None:
        first = recordings[0]
        noise = dict(zip(first.axes, first.noise or [0.0] * len(first.axes), strict=True))
        camera = {"rate": 1 / first.step, "exposure": first.exposure or 0.0}
        camera["noise"] = max((value for axis, value in noise.items() if axis != "z"), default=0.0)
        if any("z" in each.axes for each in recordings):
            camera["noise_along"] = noise.get("z", 0.0)
        with warnings.catch_warnings(action="ignore", category=UnitWarning):
            scene = scene.replace(camera=camera)
    assert scene.camera is not None
    for each in recordings:
        if "z" in each.axes and scene.camera.noise_along is None:
            raise ResultError(
                "camera.noise_along: missing: the recording has z, which the scene's camera does "
                "not record"
            )
        known = {"rate": 1 / each.step, "exposure": each.exposure}
        if each.noise is not None:
            names = ["noise_along" if axis == "z" else "noise" for axis in each.axes]
            known |= dict(zip(names, each.noise, strict=True))
        for name, value in known.items():
            own = getattr(scene.camera, name)
            agrees = value is None or math.isclose(value, own, rel_tol=_UNEVEN)
            if not agrees and f"camera.{name}" not in free:
                raise ResultError(
                    f"{each.name}: its camera has {name} = {value:.6g}, but the scene or another "
                    f"recording has {own:.6g}; must be the same"
                )
    return scene
