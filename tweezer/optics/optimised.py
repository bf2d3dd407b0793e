"""The mask that makes a trap stiffest."""

from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates

from tweezer.forces.equilibria import Equilibrium
from tweezer.optics.at_rest import at_rest
from tweezer.optics.beam import fraction_through_pupil, relative_radius
from tweezer.optics.binding import light_force, paths_of_light
from tweezer.optics.linear_range import linear_range
from tweezer.optics.mask import Mask
from tweezer.optics.waves.light import Waves
from tweezer.optics.waves.optimum import Forms, Limits, combined, stiffest
from tweezer.optics.waves.phases import Phases
from tweezer.optics.waves.pupil import Pupil
from tweezer.optics.zernike import gauss, projected, radial_sums, radial_terms
from tweezer.scene import Scene, SceneLike, checked_scene
from tweezer.scene.bead import bead_properties
from tweezer.scene.choices import GOALS
from tweezer.scene.interference import interferes
from tweezer.values.arrays import Array, Complex
from tweezer.values.errors import SceneError
from tweezer.values.files import replacing
from tweezer.values.units import QuantityLike, to_si

#: Pixels along the diameter of the pupil, of a field and of phases for small and large beads
_PIXELS, _OF_PHASES, _OF_MANY_PHASES = 256, 128, 256
#: Degree of the bead's partial waves beyond which there are many phases
_MANY = 40
#: Zernike terms of the mask beyond the degree of the bead's partial waves
_MORE_TERMS = 12
#: Corrections of the pixels for their mean, and radii and azimuths (per degree) of their field
_CORRECTIONS, _RADII, _AROUND = 6, 400, 8
#: Azimuths that are repeated at each end of a turn, for the splines between them
_BESIDE = 16
#: Largest axial force that remains, as a displacement of the bead in 1/k; rounds until then
_BALANCED, _ROUNDS = 1e-7, 8
#: Part by which a stiffness may be below its lower limit: in a field, and in phases
_BELOW, _BELOW_IN_PHASES = 1e-7, 1e-3
#: Largest size parameter: the forms grow as its fourth power
_LARGEST = 60.0
#: Loss distance of the scene with the mask, whose force costs more the farther the bead is: at
#: least this, m, this many radii, and this many distances of the start
_NEAREST, _DISTANT, _BEYOND_START = 3e-6, 2.0, 1.25
#: Search for the end of the linear range: places and wavelengths
_PLACES, _FARTHEST = 200, 1.0


@dataclass(frozen=True, eq=False)
class Optimum:
    """Light whose trap is stiffest, as returned by `tweezer.optimise`."""

    scene: Scene
    """scene with the mask"""
    mask: Array | Complex
    """pixels of the mask: the complex field, or the phase in rad. x ascends over the columns and y
    over the rows"""
    goal: str
    """stiffness that is largest: "kx", "ky", "kz" or "sum" """
    stiffness: tuple[float, ...]
    """trap stiffness along x, y and z, (3,) N/m"""
    without: tuple[float, ...] | None
    """trap stiffness in the given scene, (3,) N/m; None if it has no trap"""
    bound: float
    """largest value of the goal in any light of this power and polarisation over the pupil, N/m,
    of the same parity under half a turn"""
    linear_range: tuple[float, ...]
    """displacement along x, y and z at which the force deviates from a linear one by 5 %, (3,) m"""
    passed: float
    """part of the light within the pupil that the mask transmits"""

    @property
    def value(self) -> float:
        """Goal with the mask, N/m: a stiffness, or the sum of all three."""
        return _worth(self.goal, dict(zip("xyz", self.stiffness, strict=True)))

    @property
    def gain(self) -> float | None:
        """Goal with the mask over the goal in the given scene, at equal power; None without one."""
        if self.without is None:
            return None
        return self.value / _worth(self.goal, dict(zip("xyz", self.without, strict=True)))


def optimise(
    scene: SceneLike,
    goal: str = "kx",
    *,
    field: bool = True,
    at_least: Mapping[str, QuantityLike] | None = None,
    file: str | Path | None = None,
    overwrite: bool = False,
) -> Optimum:
    r"""Return the mask over the pupil that makes the trap of a scene stiffest, and write it.

    A field is the best light of the given power and polarisation that traps the bead in the focus:
    no other light of the same parity under half a turn has a larger stiffness. Its stiffness is
    found as an eigenvalue. A phase is found by a search, and is good rather than the best. The well
    of such a trap is narrow, see `Optimum.linear_range`.

    Parameters
    ----------
    scene : Scene, str or mapping
        Scene with a sphere of a radius up to 60/k, and one beam without a shape of its own, in
        wave optics. k is the wavenumber in the medium.
    goal : {"kx", "ky", "kz", "sum"}, optional
        Stiffness to maximise: along one axis, or the sum of all three.
    field : bool, optional
        Whether the mask sets amplitude and phase of the light, or its phase alone.
    at_least : mapping, optional
        Smallest stiffness of the keys "kx", "ky" and "kz", N/m. Every other one is positive.
    file : str or Path, optional
        File .npy to which the mask is written, for `beam.mask`. Default: best-GOAL.npy.
    overwrite : bool, optional
        Whether an existing file is replaced.

    Returns
    -------
    Optimum
        The scene with the mask, the mask, stiffness, gain and linear range.

    Raises
    ------
    SceneError
        For a scene without such light, for a large bead, and where no light meets the conditions.

    Examples
    --------
    >>> best = tweezer.optimise("silica-1um", "kz", file="stiff.npy")
    >>> bool(best.gain > 1.1)
    True
    """
    if goal not in GOALS:
        raise SceneError(f"goal = {goal!r}: must be one of {', '.join(GOALS)}")
    path = Path(file if file is not None else f"best-{goal}.npy").absolute()
    if path.suffix != ".npy":
        raise SceneError(f"file = {str(path)!r}: must be a file .npy")
    if path.exists() and not overwrite:
        raise SceneError(f"file = {str(path)!r}: already exists; set overwrite to replace it")
    if not path.parent.is_dir():
        raise SceneError(f"file = {str(path)!r}: its folder does not exist; make it first")
    given = checked_scene(scene)
    if given.heat is not None:
        raise SceneError("heat: optimise compares light at one temperature; remove [heat]")
    masked = _masked(given, path, field=field)
    design = _Design(given)
    limits = design.limits(goal, at_least or {})
    before = at_rest(given)
    best = design.best_field(goal, limits) if field else design.best_phase(goal, limits, before)
    with replacing(path) as whole:
        np.save(whole, best.mask)
    stiffness = tuple(design.unit * best.means[axis] for axis in "xyz")
    return Optimum(
        scene=masked,
        mask=best.mask,
        goal=goal,
        stiffness=stiffness,
        without=None if before is None else tuple(before.stiffness_xyz.tolist()),
        bound=design.unit * best.bound,
        linear_range=_linear_range(masked, stiffness),
        passed=_passed(given, masked),
    )


def _worth(goal: str, stiffness: Mapping[str, float]) -> float:
    """Return the value of a goal for stiffnesses by axis."""
    return sum(share * stiffness[axis] for axis, share in GOALS[goal].items())


def _masked(scene: Scene, path: Path, *, field: bool) -> Scene:
    """Return the scene with a mask in a file; refuse a scene whose light has no best mask."""
    if not scene.lit or scene.theory != "waves":
        raise SceneError("optimise: requires light in wave optics")
    if scene.bead.shape != "sphere":
        raise SceneError(f"bead.shape = {scene.bead.shape!r}: optimise requires a sphere")
    if not scene.plain or interferes(scene):
        raise SceneError("optimise: requires one beam at rest at the origin, without a mirror")
    beam = scene.beam
    shaped = [
        key for key in ("aberration", "amplitude_terms", "axicon", "annulus", "sectors", "mask")
        if getattr(beam, key)
    ]  # fmt: skip
    if shaped:
        raise SceneError(f"beam.{shaped[0]}: optimise requires a beam without it; remove it")
    power = paths_of_light(scene, (beam,))[0].light.cone.power
    near = max(_NEAREST, _DISTANT * scene.bead.radius)
    return scene.replace(
        beam={
            "mask": str(path), "mask_kind": "field" if field else "phase", "power": None,
            "power_through_pupil": power,
        },
        simulation={"loss_distance": _loss_distance(scene, near)},
    )  # fmt: skip


def _loss_distance(scene: Scene, near: float) -> float:
    """Return a loss distance, m: `near`, or more if the bead starts farther away."""
    start = float(np.linalg.norm(scene.start_position))
    return min(scene.simulation.loss_distance, max(near, _BEYOND_START * start))


def _passed(given: Scene, masked: Scene) -> float:
    """Return the part of the light within the pupil that a mask transmits."""
    before, after = (fraction_through_pupil(of.lens, of.beam) for of in (given, masked))
    return after / before


def _balanced(means: Mapping[str, float], limits: Limits) -> bool:
    """Return whether the axial force of light is the wanted one."""
    return abs(means["f"] - limits.force) < _BALANCED * abs(means["z"])


def _meets(means: Mapping[str, float], limits: Limits, below: float) -> bool:
    """Return whether the stiffnesses of light are not below their limits by more than a part."""
    return all(means[axis] >= level * (1 - below) for axis, level in limits.least.items())


class _Best(NamedTuple):
    """A mask that was found."""

    means: Mapping[str, float]
    """axial force and stiffnesses; see `Forms.means`"""
    bound: float
    """bound on the goal, in k n_m P/c"""
    mask: Array | Complex
    """pixels"""


class _Design:
    """The light of a scene, and the search for its best mask."""

    def __init__(self, scene: Scene) -> None:
        (path,) = paths_of_light(scene, (scene.beam,))
        self.light: Waves = path.light
        if self.light.size_parameter > _LARGEST:
            largest = _LARGEST / self.light.wavenumber
            raise SceneError(
                f"bead.radius = {scene.bead.radius:.3g}: optimise requires a radius of at most "
                f"{largest:.3g} m"
            )
        self.pupil = Pupil((), scene.lens.map == "tan", relative_radius(scene))
        self.force = -float(bead_properties(scene).weight[2]) / self.light.strength
        self.forms = [Forms(self.light, odd=odd) for odd in (False, True)]
        self.degree = self.forms[0].highest + _MORE_TERMS

    @property
    def unit(self) -> float:
        """Unit of the stiffness, k n_m P/c, N/m."""
        return self.light.strength * self.light.wavenumber

    def limits(self, goal: str, at_least: Mapping[str, QuantityLike]) -> Limits:
        """Return the conditions: stiffnesses outside of the goal are positive."""
        least = {axis: 0.0 for axis in "xyz" if axis not in GOALS[goal]}
        for key, value in at_least.items():
            if key not in ("kx", "ky", "kz"):
                raise SceneError(f"at_least: has {key!r}; allowed: kx, ky, kz")
            try:
                least[key[1]] = to_si(value, "N/m") / self.unit
            except ValueError as error:
                raise SceneError(f"at_least: {key} = {value!r}: {error}") from None
            if least[key[1]] < 0:
                raise SceneError(f"at_least: {key} = {value} is negative; must be at least 0")
        return Limits(self.force, least)

    def _light(self, goal: str, limits: Limits) -> list[tuple[Forms, Complex, float]]:
        """Return the best light of each parity that meets the conditions, and its bound.

        Raises `SceneError` if none does.
        """
        found = []
        for forms in self.forms:
            try:
                found.append((forms, *stiffest(forms, GOALS[goal], limits)))
            except SceneError as error:
                refused = error
        if not found:
            raise refused
        return found

    def best_field(self, goal: str, limits: Limits) -> _Best:
        """Return the best field over the pupil, of a modulus up to 1."""
        forms, z, bound = max(self._light(goal, limits), key=lambda each: each[2])
        wanted = limits
        for _ in range(_ROUNDS):  # the light of the fine details of pixels exerts no force
            values = self._pixels(forms, z)
            means = forms.means(self._coefficients(forms, values))
            if _balanced(means, limits) and _meets(means, limits, _BELOW):
                return _Best(means, bound, values)
            slope = means["f"] / wanted.force if wanted.force else 1.0
            wanted = Limits(wanted.force + (limits.force - means["f"]) / slope, {
                axis: wanted.least[axis] + max(level - means[axis], 0.0)
                for axis, level in limits.least.items()
            })  # fmt: skip
            z, _ = stiffest(forms, GOALS[goal], wanted)
        raise SceneError(f"goal = {goal!r}: no pixels were found that meet the conditions")

    def best_phase(self, goal: str, limits: Limits, before: Equilibrium | None) -> _Best:
        """Return the best phase over the pupil that a search finds, rad.

        One of its starts moves the equilibrium without a mask, if there is one, to the focus.
        """
        pixels = _OF_PHASES if self.degree <= _MANY else _OF_MANY_PHASES
        found, light = [], self._light(goal, limits)
        bound = max(each for _, _, each in light)
        for forms, z, _ in light:
            phases = Phases(forms, self._before, pixels)
            starts = [self._drawn(forms, z, pixels)]
            if before is not None and not forms.odd:
                starts.append(self._moved(forms, before, pixels))
            for start in starts:
                near = phases.stiffest(phases.of(start), GOALS[goal], limits)
                values, means = self._rebalanced(phases, near, limits)
                good = _balanced(means, limits) and _meets(means, limits, _BELOW_IN_PHASES)
                if good and min(means[axis] for axis in "xyz") > 0:
                    found.append(_Best(means, bound, np.angle(values)))
        if not found:
            raise SceneError(f"goal = {goal!r}: no phase was found that meets the conditions")
        return max(found, key=lambda each: _worth(goal, each.means))

    def _rebalanced(
        self, phases: Phases, start: Array, limits: Limits
    ) -> tuple[Complex, dict[str, float]]:
        """Return light of phases near a start whose axial force is the wanted one, and its means.

        The search used one place in each pixel; here their Zernike terms are exact. The phases move
        along the gradient of the force, by a secant method.
        """
        forms, light = phases.forms, phases.light(start)
        along = phases.slopes(light, forms.force @ phases.coefficients(light))
        along /= max(float(along @ along), 1e-300)

        def at(shift: float) -> tuple[Complex, dict[str, float]]:
            """Return the light and its means after a shift."""
            moved = phases.light(start + shift * along)
            return moved, forms.means(self._coefficients(forms, moved))

        shifts, every = [0.0], [at(0.0)]
        step = limits.force - every[0][1]["f"]
        for _ in range(_ROUNDS):
            shifts.append(shifts[-1] + step)
            every.append(at(shifts[-1]))
            if _balanced(every[-1][1], limits):
                break
            missed = every[-1][1]["f"] - limits.force
            slope = (every[-1][1]["f"] - every[-2][1]["f"]) / (shifts[-1] - shifts[-2])
            step = -missed / slope
        return every[-1]

    def _before(self, below: Array) -> Array:
        """Return rho of directions with 1 - cos(theta) = `below` behind the lens."""
        return self.pupil.radius(self.light.focus._in_front(below))

    def _coefficients(self, forms: Forms, values: Complex) -> Complex:
        """Return z of the light of pixels, by their Zernike terms that the bead feels."""
        pupil = dataclasses.replace(self.pupil, mask=Mask(values, 2.0, 0.0))
        pupil = pupil.normalised(self.light.cone).up_to(self.degree)
        harmonics = pupil.harmonics(self.light.focus._in_front(forms.nodes))
        known = np.abs(forms.orders) <= self.degree
        every = np.zeros((len(forms.orders), len(forms.nodes)), np.complex128)
        every[known] = harmonics[forms.orders[known]]
        return forms.coefficients(every)

    @functools.cached_property
    def _behind(self) -> Callable[[Array], Array]:
        """Function that returns 1 - cos(theta) behind the lens of radii in the pupil."""
        from scipy.interpolate import CubicSpline

        edge = 2 * math.sin(self.light.focus.half_angle / 2) ** 2
        sine = np.sin(np.linspace(0.0, math.pi / 2, 2001))
        below = edge * sine**2  # even spacing in theta near the edge
        rho = self._before(below)
        # 1 - cos(theta) is even in rho
        curve = CubicSpline(
            np.concatenate([-rho[:0:-1], rho]), np.concatenate([below[:0:-1], below])
        )
        return lambda at: np.clip(curve(at), edge * 1e-12, edge)

    def _drawn(self, forms: Forms, z: Complex, pixels: int) -> Complex:
        """Return T at the centres of pixels, (pixels, pixels)."""
        rho = np.linspace(0.0, 1.0, _RADII)
        return _on_pixels(combined(forms.functions(self._behind(rho)), z), forms.orders, pixels)

    def _moved(self, forms: Forms, place: Equilibrium, pixels: int) -> Complex:
        """Return T that moves light down by the height of an equilibrium, (pixels, pixels)."""
        rho = np.linspace(0.0, 1.0, _RADII)
        turn = self.light.wavenumber * place.position[2] * (1 - self._behind(rho))
        harmonics = np.zeros((len(forms.orders), _RADII), np.complex128)
        harmonics[forms.orders == 0] = np.exp(1j * turn)
        return _on_pixels(harmonics, forms.orders, pixels)

    def _pixels(self, forms: Forms, z: Complex) -> Complex:
        """Return pixels with the Zernike terms of T, of a modulus up to 1."""
        nodes, weight = gauss(_RADII)
        nodes, weight = (nodes + 1) / 2, weight / 2
        harmonics = combined(forms.functions(self._behind(nodes)), z)
        inside = np.abs(forms.orders) <= self.degree
        wanted = np.zeros((self.degree + 1, 2 * self.degree + 1), np.complex128)
        wanted[:, self.degree + forms.orders[inside]] = radial_terms(
            harmonics[inside].T, forms.orders[inside], nodes, weight, self.degree
        )
        values, rho = self._drawn(forms, z, _PIXELS), np.linspace(0.0, 1.0, _RADII)
        every = np.arange(-self.degree, self.degree + 1)
        for _ in range(_CORRECTIONS):
            missing = wanted - projected(values, 2.0, self.degree)
            values = values + _on_pixels(radial_sums(missing, rho), every, _PIXELS)
        return values / np.abs(values).max()


def _on_pixels(harmonics: Complex, orders: NDArray[np.int64], pixels: int) -> Complex:
    """Return the sum of harmonics (orders, radii from 0 to 1) at the centres of pixels."""
    count = _AROUND * int(np.abs(orders).max() + 1)
    series = np.zeros((count, harmonics.shape[1]), np.complex128)
    series[orders] = harmonics
    around = np.fft.ifft(series, axis=0, norm="forward")
    # negative radii are on the other side
    whole = np.concatenate([np.roll(around, count // 2, axis=0)[:, :0:-1], around], axis=1)
    x = (np.arange(pixels) + 0.5) * 2 / pixels - 1
    rho = np.minimum(np.hypot(x, x[:, None]), 1.0) * (harmonics.shape[1] - 1)
    turn = np.arctan2(x[:, None], x) / (2 * math.pi) * count
    at = np.stack([turn % count + _BESIDE, rho + harmonics.shape[1] - 1])
    whole = np.pad(whole, ((_BESIDE, _BESIDE), (0, 0)), mode="wrap")
    re, im = (
        map_coordinates(each, at, order=3, mode="nearest") for each in (whole.real, whole.imag)
    )
    found: Complex = re + 1j * im
    return found


def _linear_range(scene: Scene, stiffness: tuple[float, ...]) -> tuple[float, ...]:
    """Return the displacement from the focus at which the force is nonlinear by 5 %, (3,) m."""
    wavelength = scene.beam.wavelength / scene.medium.refractive_index
    near = _loss_distance(scene, _FARTHEST * wavelength)
    force = light_force(scene.replace(simulation={"loss_distance": near}))
    distances = np.linspace(0.0, _FARTHEST * wavelength, _PLACES + 1)
    in_focus = force.field(np.zeros((1, 3))).force

    def along(i: int) -> float:
        """Return the smaller distance of both directions."""
        ends = []
        for way in (distances[1:], -distances[1:]):
            pull = force.field(way[:, None] * np.eye(3)[i]).force[:, i] - in_focus[0, i]
            deviation = np.concatenate([[0.0], np.abs(pull / (-stiffness[i] * way) - 1)])
            ends.append(linear_range(deviation, distances))
        return min(ends)

    return tuple(along(i) for i in range(3))
