"""Time sharing: a beam that jumps or moves between places periodically, and its averaged trap."""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from tweezer.dynamics import Problem, bound_once
from tweezer.dynamics.layout import TRANSLATION
from tweezer.dynamics.linear import CRITICAL
from tweezer.forces import Course
from tweezer.optics.binding import factor_of, place_of
from tweezer.scene import Scene, SceneLike, checked_scene
from tweezer.scene.interference import interferes
from tweezer.trap.trap import Trap, sphere_trap
from tweezer.values.arrays import Array
from tweezer.values.constants import Boltzmann
from tweezer.values.errors import SceneError, TweezerError
from tweezer.values.printed import printed
from tweezer.values.shown import Card, Row, Shown
from tweezer.values.vectors import Comparable, Vector, fixed

if TYPE_CHECKING:
    from tweezer.scene.sections import Beam

#: Relative excess of the variance below which the averaged trap is a good description
ENOUGH = 0.01
#: Largest number of periods of a beam in the common period, and its relative error
_MOST_PERIODS, _COMMON = 100, 1e-9
#: Number of steps in a period, and largest number of kinks in it
_STEPS, _MOST_KINKS = 24, 1000
#: Largest number of places of the averaged beams
_MOST_PLACES = 100
#: Number of terms of an exponential series for a norm of at most 1/2
_SERIES = 15
#: Newton's method ends after this number of steps, or after a step of this part of the spread
_NEWTON, _CLOSE = 50, 1e-9

Pull = Callable[[Array, Array], tuple[Array, Array]]


@dataclass(frozen=True, repr=False, eq=False)
class TimeSharing(Comparable, Shown):
    """A periodic trap beside the trap of its forces averaged over a period, in SI units."""

    scene: Scene = field(compare=False)
    """the scene of the periodic trap"""
    averaged: Scene = field(compare=False)
    """the scene with the averaged force: a beam at rest for each place that a beam visits, with its
    share of the power"""
    period: float
    """common period T of all beams, s"""
    corner_frequencies: Vector
    """corner frequencies k_ii/(2 pi gamma) of the averaged trap, (3,) Hz"""
    ripple: Vector
    """root mean square of the periodic displacement about its mean, (3,) m"""
    shift: Vector
    """mean position in the periodic trap minus the equilibrium of the averaged trap, (3,) m"""
    variance: Vector
    """variance of the position in the averaged trap, (3,) m^2"""
    excess_variance: Vector
    """variance over many periods in the periodic trap minus `variance`, (3,) m^2"""
    error: Vector
    """estimated error of `excess_variance`, (3,) m^2"""

    @functools.cached_property
    def trap(self) -> Trap:
        """The averaged trap, characterised on first use."""
        return sphere_trap(self.averaged)

    @property
    def relative_excess(self) -> Array:
        """Ratio of `excess_variance` to `variance`, (3,)."""
        return np.array(self.excess_variance) / np.array(self.variance)

    @property
    def sufficient(self) -> bool:
        """Whether the averaged trap has the variance of the periodic trap within 1 %."""
        return bool((np.abs(self.relative_excess) < ENOUGH).all())

    @property
    def sufficient_frequency(self) -> float:
        """Cycle frequency at which the variances differ by 1 %, Hz.

        It assumes that the excess decreases with the square of the frequency, as it does far above
        the corner frequency.
        """
        return math.sqrt(float(np.abs(self.relative_excess).max()) / ENOUGH) / self.period

    def card(self) -> Card:
        """Return the card with period, ripple and excess variance."""
        ratio = 1 / self.period / np.array(self.corner_frequencies)
        percent = ", ".join(f"{100 * each:.3g}" for each in self.relative_excess)
        errors = 100 * np.array(self.error) / np.array(self.variance)
        within = ", ".join(f"{each:.2g}" for each in errors)
        told = "sufficient, within 1 % of the variance"
        if not self.sufficient:
            least = printed(self.sufficient_frequency, "kHz", 3)
            told = f"not sufficient; 1 % of the variance requires about {least}"
        return Card(
            "Time sharing", self.scene.name,
            (
                Row("cycle frequency", printed(1 / self.period, "kHz")),
                Row("corner frequencies, averaged trap", printed(self.corner_frequencies, "Hz")),
                Row("cycle over corner frequency", printed(ratio, "", 3)),
                Row("ripple (x, y, z), rms", printed(self.ripple, "nm", 3)),
                Row("shift of the mean position", printed(np.round(self.shift, 13) + 0.0, "nm", 3)),
                Row("excess variance (x, y, z)", f"{percent} %", f"+- {within} %"),
                Row("average of the forces", told),
            ),
        )  # fmt: skip


def repeats(scene: Scene) -> bool:
    """Return whether the light of a scene repeats with a period."""
    return any(
        not course.steady and math.isfinite(_period(course))
        for beam in scene.beams for course in (place_of(beam), factor_of(beam))
    )  # fmt: skip


def time_sharing(scene: SceneLike) -> TimeSharing:
    r"""Compare a trap whose light repeats with a period with the trap of its averaged force.

    A beam that jumps between places far faster than the bead can follow traps it by the mean of its
    forces over a period T. At a finite frequency the bead also follows the remaining force. Its
    Fourier components F_n displace the bead by T F_n/(2 pi n gamma). The changing
    stiffness changes the thermal variance in second order of T. The position obeys

    .. math::

        \dot{\bar x} &= b F(\bar x, t), \\
        \dot C &= -b K C - (b K C)^T + 2 k_B T b,

    with the mobility b, the periodic path :math:`\bar x(t)`, the stiffness K(t) on this path and
    the thermal covariance C(t). Newton's method finds the path.

    Parameters
    ----------
    scene : Scene, str or mapping
        Scene with a sphere and one beam or more that repeat with a period: `motion` of the kinds
        sine and circle, `modulation` of the kinds sine and on-off, and steps and tables of both
        with `period`.

    Returns
    -------
    TimeSharing
        Ripple and excess variance of the position, and the scene of the averaged trap.

    Raises
    ------
    SceneError
        For light that does not repeat, beams without a common period, light that interferes, laser
        noise, a body that is no sphere, a relaxing medium, and a bead that oscillates.
    TweezerError
        If the averaged or the periodic force does not hold the bead.

    Notes
    -----
    The equations are those of overdamped motion. The ripple includes the inertia of bead and fluid
    at the cycle frequency, unless the scene's model has none. The error contains the change by
    anharmonic forces over the thermal motion and by halved steps, and the effect of inertia in
    second order. Transitions to other equilibria are not included.

    Examples
    --------
    >>> circle = {"kind": "circle", "radius": "20 nm", "frequency": "10 kHz"}
    >>> scene = tweezer.load_scene("silica-1um").replace(beam={"motion": circle})
    >>> (1e9 * tweezer.time_sharing(scene).ripple).round(1).tolist()
    [2.3, 2.3, 0.0]
    """
    scene = checked_scene(scene)
    period = _common_period(scene)
    _check(scene)
    averaged = _averaged(scene, period)
    found = sphere_trap(averaged)
    if found.equilibrium is None:
        raise TweezerError(
            f"{scene.name}: the averaged trap does not hold the bead: {found.reason}"
        )
    problem, at = bound_once(scene), found.equilibrium.position
    mobility = problem.mobilities(np.array([at]))[0, TRANSLATION]
    quality = [
        problem.linear.quality(k, b) for k, b in zip(found.stiffness_xyz, mobility, strict=True)
    ]
    if max(quality) > CRITICAL:
        raise SceneError(
            f"{scene.name}: the bead oscillates in the averaged trap, with a quality factor of "
            f"{max(quality):.3g}; must be at most {CRITICAL:g}; choose a denser medium"
        )
    corner = found.stiffness_xyz * mobility / (2 * math.pi)
    if not 1 / period > corner.max():
        raise SceneError(
            f"{scene.name}: the light repeats at {printed(1 / period, 'Hz')}, below the corner "
            f"frequency of {printed(corner.max(), 'Hz')} in the averaged trap; shorten the period"
        )
    thermal = Boltzmann * scene.noise_temperature * mobility

    def compared(steps: int, spread: Array | None = None) -> tuple[_Cycle, _Cycle]:
        """Return the motion in the periodic and in the averaged force."""
        middles, lengths = _steps(scene, period, steps)
        pull = smoothed(_pull(problem), spread)
        path = np.tile(at, (len(middles), 1))
        moving = cycle(pull, mobility, thermal, middles, lengths, path)
        mean = mean_of(pull, *_distinct(scene, middles, lengths))
        rest = cycle(mean, mobility, thermal, np.zeros(1), np.array([period]), at[None])
        return moving, rest

    try:
        moving, rest = compared(2 * _STEPS)
        rough = compared(_STEPS)
        spread = np.sqrt(np.diag(rest.covariance))
        averaged_over = compared(_STEPS, spread)
    except _NotHeldError:
        raise TweezerError(f"{scene.name}: the periodic force does not hold the bead") from None
    excess, of_rough, of_smooth = (
        np.diag(a.covariance - b.covariance) for a, b in ((moving, rest), rough, averaged_over)
    )
    of_path = np.diag(moving.of_path)
    lag = _of_inertia(problem, period, found.stiffness_xyz, mobility)
    error = np.abs(excess - of_rough) + np.abs(of_smooth - of_rough)
    error += np.abs(lag * (excess - (1 - lag) * of_path))
    excess = excess - lag * of_path
    ripple = np.sqrt((1 - lag) * of_path)
    return TimeSharing(
        scene, averaged, period, *map(fixed, (
            corner, ripple, moving.mean - rest.mean, np.diag(rest.covariance), excess, error
        )),
    )  # fmt: skip


# --- motion in a periodic force -------------------------------------------------------------------


class _NotHeldError(Exception):
    """The linear motion about the path grows, or there is no path."""


class _Cycle(NamedTuple):
    """Moments of the position of a bead over a period."""

    mean: Array
    """mean position, (3,) m"""
    of_path: Array
    """covariance of the path without thermal motion over a period, (3, 3) m^2"""
    covariance: Array
    """covariance with thermal motion, (3, 3) m^2"""


def cycle(
    pull: Pull, mobility: Array, diffusion: Array, times: Array, lengths: Array, path: Array
) -> _Cycle:
    """Return the moments of overdamped motion in a periodic force.

    Each step is exact for the linear force about its middle. Means over a step follow by Simpson's
    rule.

    Parameters
    ----------
    pull : callable
        Force, (n, 3) N, and its gradient, (n, 3, 3) N/m, at positions (n, 3), m, and times (n,), s.
    mobility, diffusion : ndarray, shape (3,)
        Mobility, s/kg, and diffusion coefficient, m^2/s, along each axis.
    times, lengths : ndarray, shape (n,)
        Middles and lengths of the steps of a period, s, within which the force is constant in time.
    path : ndarray, shape (n, 3)
        Position at these times at which Newton's method begins, m.
    """
    origin, unit = path.mean(axis=0), float(np.sqrt(diffusion.max() * lengths.sum()))
    half = 0.5 * np.repeat(lengths, 2)[:, None, None]
    for _ in range(_NEWTON):
        force, gradient = pull(path, times)
        A = mobility[:, None] * gradient
        g = (mobility * force - np.einsum("nij,nj->ni", A, path - origin)) / unit
        x = _periodic_path(_exponential(half * np.repeat(_of_path(A, g), 2, axis=0)))
        there = origin + unit * x[1::2]
        change, path = float(np.abs(there - path).max()), there
        if change < _CLOSE * unit:
            break
    else:
        raise _NotHeldError
    of_noise = _of_noise(A, np.diag(2 * diffusion / unit**2))
    C = _periodic_covariance(_exponential(half * np.repeat(of_noise, 2, axis=0)))
    ends = np.repeat(lengths, 2) / 6
    weights = np.append(ends, 0.0) + np.append(0.0, ends)  # Simpson's rule: 1, 4, 1
    weights[1::2] *= 2
    weights /= weights.sum()
    mean = weights @ x
    of_path = np.einsum("n,ni,nj->ij", weights, x - mean, x - mean)
    thermal = np.einsum("n,nij->ij", weights, C)
    return _Cycle(origin + unit * mean, unit**2 * of_path, unit**2 * (of_path + thermal))


def _exponential(matrices: Array) -> Array:
    """Return the exponentials of small matrices (n, m, m), by their series after halving.

    `scipy.linalg.expm` calls LAPACK for each matrix, which takes a hundred times as long.
    """
    norm = float(np.abs(matrices).sum(axis=2).max())
    halved = max(0, math.frexp(norm)[1] + 1)
    scaled = matrices / 2.0**halved
    found = term = np.broadcast_to(np.eye(matrices.shape[-1]), matrices.shape)
    for n in range(1, _SERIES):
        term = term @ scaled / n
        found = found + term
    for _ in range(halved):
        found = found @ found
    return found


def _of_path(A: Array, g: Array) -> Array:
    """Return the matrices of (1, x)' for x' = A x + g, (n, 4, 4)."""
    made = np.zeros((len(A), 4, 4))
    made[:, 1:, 0], made[:, 1:, 1:] = g, A
    return made


def _of_noise(A: Array, noise: Array) -> Array:
    """Return the matrices (A, N; 0, -A^T), (n, 6, 6), whose exponential contains F = exp(A t) and
    Q F^-T, with the integral Q of F N F^T (C. F. Van Loan, IEEE Trans. Autom. Control 23, 395
    (1978)).
    """
    n = A.shape[1]
    made = np.zeros((len(A), 2 * n, 2 * n))
    made[:, :n, :n], made[:, :n, n:], made[:, n:, n:] = A, noise, -A.swapaxes(1, 2)
    return made


def _periodic_path(maps: Array) -> Array:
    """Return x before and after each of the maps of (1, x), (n + 1, 3), for a periodic x."""
    whole = functools.reduce(lambda done, then: then @ done, maps)
    if not np.abs(np.linalg.eigvals(whole[1:, 1:])).max() < 1:
        raise _NotHeldError
    at = [np.append(1.0, np.linalg.solve(np.eye(3) - whole[1:, 1:], whole[1:, 0]))]
    for each in maps:
        at.append(each @ at[-1])
    return np.array(at)[:, 1:]


def _periodic_covariance(maps: Array) -> Array:
    """Return the covariance C before and after each map of `_of_noise`, (n + 1, 3, 3), for a
    periodic C.
    """
    n = maps.shape[1] // 2
    F = maps[:, :n, :n]
    Q = maps[:, :n, n:] @ F.swapaxes(1, 2)

    def after(C: Array) -> Array:
        made = [C]
        for f, q in zip(F, Q, strict=True):
            made.append(f @ made[-1] @ f.T + q)
        return np.array(made)

    whole = functools.reduce(lambda done, then: then @ done, F)
    of_noise = after(np.zeros((3, 3)))[-1].ravel()
    begin = np.linalg.solve(np.eye(9) - np.kron(whole, whole), of_noise)
    return after(begin.reshape(3, 3))


def _pull(problem: Problem) -> Pull:
    """Return the force on the bead with its weight, and the gradient of the force."""

    def pull(places: Array, times: Array) -> tuple[Array, Array]:
        found = problem.field(places, gradient=True, time=times)
        return found.force + np.array(problem.bead.weight), found.force_gradient

    return pull


def mean_of(pull: Pull, times: Array, shares: Array) -> Pull:
    """Return the mean of a force over `times`, each of which has a share of the period."""

    def mean(places: Array, _: Array) -> tuple[Array, Array]:
        n, m = len(places), len(times)
        force, gradient = pull(np.repeat(places, m, axis=0), np.tile(times, n))
        weights = np.tile(shares, n)
        return (
            (weights[:, None] * force).reshape(n, m, 3).sum(axis=1),
            (weights[:, None, None] * gradient).reshape(n, m, 3, 3).sum(axis=1),
        )

    return mean


def smoothed(pull: Pull, spread: Array | None) -> Pull:
    """Return the mean of a force over positions with the standard deviations `spread`, (3,) m.

    The six positions, sqrt(3) standard deviations along each axis, give the exact mean of a
    polynomial of third degree. Without `spread` the force is returned unchanged.
    """
    if spread is None:
        return pull
    away = math.sqrt(3) * np.concatenate([np.diag(spread), -np.diag(spread)])

    def mean(places: Array, times: Array) -> tuple[Array, Array]:
        n = len(places)
        around = (places[:, None] + away).reshape(-1, 3)
        force, gradient = pull(around, np.repeat(times, len(away)))
        return force.reshape(n, -1, 3).mean(axis=1), gradient.reshape(n, -1, 3, 3).mean(axis=1)

    return mean


def _of_inertia(problem: Problem, period: float, stiffness: Array, mobility: Array) -> Array:
    """Return the part by which inertia reduces the variance of the path, (3,).

    At the cycle frequency w the bead follows a force with 1/(k - i w gamma(w) - w^2 m), where
    gamma(w) = gamma (1 + (-i w tau_f)^(1/2)) with the vorticity time tau_f.
    """
    motion, w = problem.linear, 2 * math.pi / period
    mass = motion.mass + 0.5 * motion.displaced_mass
    memory = np.sqrt(-1j * w * problem.scene.vorticity_time) if motion.displaced_mass else 0.0
    without = stiffness - 1j * w / mobility
    found: Array = 1 - np.abs(without / (without - 1j * w * memory / mobility - w**2 * mass)) ** 2
    return found


# --- periods and averaged scenes ------------------------------------------------------------------


def _period(course: Course) -> float:
    """Return the period of a course, s: infinite if it does not repeat, and 0 if it is constant."""
    swings = course.frequency > 0 and bool(course.amplitude.any())
    if bool((course.values == course.values[0]).all()):
        return 1 / course.frequency if swings else 0.0
    return course.period


def _common_period(scene: Scene) -> float:
    """Return the common period of all beams, s; raise `SceneError` without one."""
    periods = []
    for number, beam in enumerate(scene.beams, start=1):
        name = "beam" if len(scene.beams) == 1 else f"beam[{number}]"
        for key, course in (("motion", place_of(beam)), ("modulation", factor_of(beam))):
            found = _period(course)
            if math.isinf(found):
                raise SceneError(
                    f"{name}.{key}: must repeat for time sharing; use sine, circle or on-off, or "
                    f"set {name}.{key}.period"
                )
            periods += [found] if found else []
    if not periods:
        raise SceneError(
            "beam: is at rest; time sharing requires beam.motion or beam.modulation with a period"
        )
    longest = max(periods)
    for count in range(1, _MOST_PERIODS + 1):
        ratios = count * longest / np.array(periods)
        if (np.abs(ratios - ratios.round()) < _COMMON * ratios).all():
            return count * longest
    told = printed(sorted(set(periods)), "ms", 7)
    raise SceneError(f"beam: periods of {told}: must have a common multiple; change a period")


def _check(scene: Scene) -> None:
    """Raise `SceneError` for a scene whose time sharing is not computed."""
    if interferes(scene):
        raise SceneError("beam.coherent: time sharing requires light that does not interfere")
    if scene.noisy_light:
        raise SceneError("beam.noise: cannot be combined with time sharing; remove it")
    if scene.bead.shape != "sphere":
        raise SceneError(f"bead.shape = {scene.bead.shape!r}: time sharing requires a sphere")
    if scene.medium.relaxes:
        raise SceneError("medium: time sharing requires a medium that does not relax")


def _steps(scene: Scene, period: float, count: int) -> tuple[Array, Array]:
    """Return middles and lengths of steps of a period that end at every kink, s.

    A step is at most 1/`count` of the period.
    """
    courses = [each(beam) for beam in scene.beams for each in (place_of, factor_of)]
    kinks = np.unique(np.concatenate([course.kinks(period) for course in courses]))
    if len(kinks) > _MOST_KINKS:
        raise SceneError(
            f"beam: {len(kinks)} jumps or bends in a period of {printed(period, 'ms')}; must be at "
            f"most {_MOST_KINKS}"
        )
    inside = kinks[(kinks > _COMMON * period) & (kinks < period * (1 - _COMMON))]
    apart = np.diff(inside, prepend=0.0) > _COMMON * period  # beams may jump at the same time
    edges = np.concatenate([[0.0], inside[apart], [period]])
    found = [
        np.linspace(a, b, max(1, math.ceil((b - a) / period * count)) + 1)
        for a, b in itertools.pairwise(edges)
    ]
    middles = np.concatenate([0.5 * (each[1:] + each[:-1]) for each in found])
    return middles, np.concatenate([np.diff(each) for each in found])


def _distinct(scene: Scene, times: Array, lengths: Array) -> tuple[Array, Array]:
    """Return a time of each distinct state of the light, s, and its share of the period."""
    courses = [each(beam) for beam in scene.beams for each in (place_of, factor_of)]
    states = np.array([np.concatenate([course.at(t) for course in courses]) for t in times])
    _, first, which = np.unique(states, axis=0, return_index=True, return_inverse=True)
    return times[first], np.bincount(which, lengths) / lengths.sum()


def _averaged(scene: Scene, period: float) -> Scene:
    """Return the scene with the force averaged over a period.

    Each beam becomes a beam at rest for each place, with the mean power there.
    """
    middles, lengths = _steps(scene, period, _STEPS)
    beams = [
        each for beam in scene.beams for each in _at_rest(beam, middles, lengths / period)
    ]  # fmt: skip
    if len(beams) > _MOST_PLACES:
        raise SceneError(
            f"beam.motion: {len(beams)} places in a period; time sharing allows at most "
            f"{_MOST_PLACES}; use fewer beams or times"
        )
    if not beams:
        raise SceneError("beam.modulation: is 0 over the whole period; time sharing requires light")
    return scene.replace(beam=[each.model_dump(exclude_none=True) for each in beams])


def _at_rest(beam: Beam, times: Array, shares: Array) -> Iterator[Beam]:
    """Yield a beam at rest for each place of a beam at some times, with its share of the power."""
    place, factor = place_of(beam), factor_of(beam)
    found: dict[tuple[float, ...], float] = {}
    for time, share in zip(times, shares, strict=True):
        at = tuple(place.at(time).tolist())
        found[at] = found.get(at, 0.0) + share * float(factor.at(time)[0])
    for at, part in found.items():
        if part > 0:
            power = {
                key: given * part for key in ("power", "power_through_pupil")
                if (given := getattr(beam, key)) is not None
            }  # fmt: skip
            still = {"position": at, "motion": None, "modulation": None}
            yield beam.model_copy(update={**still, **power})
