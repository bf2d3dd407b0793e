"""Kalman filter of a bead in the light, of which a camera sees two or three coordinates.

Between two frames the bead goes by an emitted model of its translation and thermal noise, without
inertia (5.2) or with it (A.25, 4.17):

    dx = u dt + sqrt(2 D) dW,    or    dx = (w/tau) dt,  dw = (u(x) - w/tau) dt + sqrt(2 D) dW,

u = (F + W)/beta_v, D = k_B T/beta_v, w = tau v. The filter's state is that of the model with
tau v in place of v: all of it in metres. Where the mobility mu depends on the place, as beside a
wall, u = mu (F + W) + k_B T dmu/dz and D = k_B T mu there (D. L. Ermak and J. A. McCammon, J. Chem.
Phys. 69, 1352 (1978)); without inertia alone. The mean of mu F over the spread P differs from that
at the mean by (dmu/dz)(dF/dx)P, which cancels k_B T dmu/dz in a trap, and d2mu/dz2 is left out: so
a bead at rest has the mean and the variance of Boltzmann, in a trap or under its weight. The noise
of a step is the mean of that at its ends. The distribution of its state is taken as Gaussian:
the mean goes by the force, the covariance by its Jacobian at the mean (the extended Kalman filter:
A. H. Jazwinski, Stochastic Processes and Filtering Theory, 1970, 8.3), in steps of the exponential
Rosenbrock method of order 3 (M. Hochbruck, A. Ostermann, J. Schweitzer, SIAM J. Numer. Anal. 47,
786 (2009)), whose exponentials are by doubling the step: a linear force is exact over any step. The
force bends within about a radius: a distribution as wide as that is not Gaussian, and the filter's
likelihood of what comes after means little. A narrower one stops to be Gaussian where the bead
falls far between two frames; there it is taken as wide as its longer tail (`_predict`).

A frame shows the mean of the position over its exposure T (blur): the state is extended by the
integral of the position over T, dI = x dt/T, which is 0 where a frame begins. Without exposure a
frame shows the position itself.

A coordinate seen is the bead's and Gaussian noise, or, with a small probability, a number from
anywhere; the state is corrected in proportion to the probability that it is the former (Y.
Bar-Shalom and E. Tse, Automatica 11, 451 (1975)).
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numba import typeof, types
from numpy.typing import NDArray

from tweezer.compiled import cached_njit, call, named_njit
from tweezer.dynamics.integrators.system import SYSTEM, act, scratch
from tweezer.dynamics.layout import POSITION, TRANSLATION
from tweezer.dynamics.models import EquationsOfMotion
from tweezer.values.errors import IntegrationError, SceneError
from tweezer.values.vectors import Vector

Array = NDArray[np.float64]

#: Longest step of the exponential series, times the norm of the Jacobian
_SHORT = 0.5
#: Number of terms of the exponential series
_TERMS = 8
#: Largest error of the position in a step, over the thermal displacement sqrt(2 D h)
_PLACE = 0.03
#: Largest change of the Jacobian in a step, times the step
_RATES = 0.5
#: Motion between frames, in radii, above which it is not linear in the position at its begin
_FAR = 0.3
#: Upper bound on the steps from one frame to the next
_MOST_STEPS = 10_000
#: Time between two exposures that counts as none, in exposures: times are rounded
_INSTANT = 1e-6
#: First column of the velocity, in the state of a model with inertia
_VELOCITY = POSITION.stop
#: Lower bound on the variance of z, m^2
_LEAST = 1e-40

_matrix, _vector = types.float64[:, ::1], types.float64[::1]


class Bead(NamedTuple):
    """What moves."""

    radius: float
    """m"""
    power: float
    """of the light, in that of its scene"""
    kT: float
    """J"""
    start: Array
    """(3,) m; the mean of the start, where it is not known"""
    spread: Array
    """(3,) m, standard deviations of the start"""
    velocity: Array
    """(3,) m/s, at the start, for a model with inertia"""
    release: float
    """s, from where the first frame begins: the bead is held until then"""


class Camera(NamedTuple):
    """What is seen, and how well."""

    times: Array
    """(n,) s, from the first frame"""
    positions: Array
    """(n, c) m, x, y and perhaps z; NaN for what is missing"""
    noise: Array
    """(c,) m, standard deviations of the coordinates"""
    outliers: float
    """1/m, density of numbers from anywhere, which the bead's is added to: their odds over the
    length they are in"""
    exposure: float = 0.0
    """s, over which a frame averages the position, up to the time between two frames"""


class Filtered(NamedTuple):
    """What a filter made of a track."""

    log_likelihood: float
    """of the coordinates seen, in m"""
    predicted: Vector
    """(n, 3) m, what frames would show of the bead without noise, by the frames before"""
    deviations: Vector
    """(n, 3) m, standard deviations of that"""
    residuals: Vector
    """(n, c) what was seen less what was predicted, in its standard deviation: independent of each
    other, of mean 0 and variance 1, if the model holds; NaN for what is missing"""
    weights: Vector
    """(n, c) the probability that it is the bead's; NaN for what is missing"""


def kalman_filter(equations: EquationsOfMotion) -> Callable[..., Filtered]:
    """What filters the tracks of a bead that moves by those equations, of translation alone.

    least: a log-likelihood. The filter stops at the frame after which it cannot be reached any
    more, and returns the most that could be; what follows is NaN. It raises `IntegrationError`
    where the motion cannot be followed. A drag that is not the same everywhere is taken to depend
    on z alone. Raises `SceneError` for such a drag of a model with inertia.
    """
    if equations.stiff and not equations.drag.uniform:
        raise SceneError(
            f"simulation.model = {equations.scene.simulation.model!r}: the Kalman filter follows "
            "no inertia under a drag that depends on the position; set simulation.model to "
            "overdamped"
        )
    system = equations.system(gradient=True, derivatives=True)
    scale = np.ones(len(equations.initial_state))
    if equations.stiff:
        scale[equations.layout.at("velocity")] = equations.relaxation.modes.times[TRANSLATION, 0]
    loop = _loop()

    def filtered(bead: Bead, camera: Camera, least: float = -math.inf) -> Filtered:
        seen = camera.positions.shape[1]
        out = [np.full((len(camera.times), columns), np.nan) for columns in (3, 3, seen, seen)]
        log_likelihood = loop(system, scale, bead, camera, least, *out)
        if not math.isfinite(log_likelihood):
            raise IntegrationError(f"no motion from z = {bead.start[2]:.6g} m can be followed")
        return Filtered(log_likelihood, *out)

    return filtered


@functools.cache
def _loop() -> Any:
    """The compiled loop over frames: returns the log-likelihood."""
    empty, table = np.zeros(0), np.zeros((0, 2))
    signature = types.float64(
        SYSTEM,
        _vector,
        typeof(Bead(0.0, 0.0, 0.0, empty, empty, empty, 0.0)),
        typeof(Camera(empty, table, empty, 0.0, 0.0)),
        types.float64,
        _matrix, _matrix, _matrix, _matrix,
    )  # fmt: skip

    @cached_njit(signature, error_model="numpy", nogil=True)
    def loop(  # type: ignore[no-untyped-def]
        system, scale, bead, camera, least, predicted, deviations, residuals, weights
    ):
        m = scale.shape[0]
        work = _room(system, scale, camera.exposure > 0)
        mean, P = work.mean, work.P
        for k in range(3):
            mean[k] = bead.start[k]
            P[k, k] = bead.spread[k] ** 2
            if m > _VELOCITY:
                mean[_VELOCITY + k] = scale[_VELOCITY + k] * bead.velocity[k]
        _diffuse(bead, work, work.diffusion)
        time, log_likelihood, step = 0.0, 0.0, np.inf
        frames, coordinates = camera.positions.shape
        most = 0.0  # of a frame, at most
        for k in range(coordinates):
            sharpest = 1 / (math.sqrt(2 * math.pi) * camera.noise[k])
            most += math.log(sharpest + camera.outliers)
        shown = m if camera.exposure > 0 else 0
        for frame in range(frames):
            if not log_likelihood + (frames - frame) * most >= least:
                return log_likelihood + (frames - frame) * most
            begin = camera.times[frame]
            if begin - time > _INSTANT * camera.exposure:
                step = _go_on(system, bead, work, time, begin, step)
            time = begin
            if camera.exposure > 0:
                _expose(work, m, 1 / camera.exposure)
                time = begin + camera.exposure
                step = _go_on(system, bead, work, begin, time, step)
                work.per_exposure[0] = 0.0
            if not step > 0:
                return np.nan
            for k in range(3):
                predicted[frame, k] = mean[shown + k]
                deviations[frame, k] = math.sqrt(max(P[shown + k, shown + k], 0.0))
            for k in range(coordinates):
                log_likelihood += _see(camera, frame, k, shown, work, residuals, weights)
        return log_likelihood

    return loop


class Room(NamedTuple):
    """The state (x, and w with inertia, and I of exposed frames), and scratch for a step.

    m, 3 or 6, is without I, n is m or m + 3.
    """

    scale: Array
    """(m,) what a state of the model is multiplied by: 1, and s for a velocity"""
    ratio: Array
    """(m, m) what its Jacobian is multiplied by"""
    per_exposure: Array
    """(1,) 1/s, one over the exposure while a frame is exposed, or 0"""
    diffusion: Array
    """(3,) m^2/s, where a step begins"""
    diffusion_ahead: Array
    mean: Array
    """(n,) m"""
    P: Array
    """(n, n) m^2, covariance"""
    place: Array
    rate: Array
    rate_ahead: Array
    rise: Array
    A: Array
    """(n, n) 1/s, d(rate)/d(state)"""
    A_ahead: Array
    noise: Array
    """(n, n) m^2/s"""
    Phi: Array
    """(n, n) the exponential"""
    Q: Array
    """(n, n) what noise adds to the covariance"""
    forced: Array
    """(3, n) m: what a rate does over a step that is constant, that rises as s, and as s^2"""
    scratch: Array
    other: Array
    vectors: Array
    """(3, n)"""
    begin: Array
    """of the motion to a frame: where it starts and ends, how far aside its neighbours do"""
    middle: Array
    aside: Array
    below: Array
    above: Array
    covariance: Array
    """(n, n)"""
    factors: Array
    """(3,)"""
    state: Array
    """(m,) of the model"""
    at: Any


@named_njit(inner=True, error_model="numpy")
def _room(system, scale, exposed):  # type: ignore[no-untyped-def]
    m = scale.shape[0]
    n = m + 3 if exposed else m
    return Room(
        scale, scale.reshape((m, 1)) / scale, np.zeros(1), np.zeros(3), np.zeros(3),
        np.zeros(n), np.zeros((n, n)), np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n),
        np.zeros((n, n)), np.zeros((n, n)), np.zeros((n, n)), np.zeros((n, n)), np.zeros((n, n)),
        np.zeros((3, n)), np.zeros((n, n)), np.zeros((n, n)), np.zeros((3, n)),
        np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n), np.zeros((n, n)),
        np.zeros(3), np.zeros(m), scratch(system),
    )  # fmt: skip


@named_njit(inner=True, error_model="numpy")
def _expose(work, m, rate):  # type: ignore[no-untyped-def]
    """Begin a frame: I is 0, and grows by the position times that rate."""
    mean, P = work.mean, work.P
    work.per_exposure[0] = rate
    for i in range(m, m + 3):
        mean[i] = 0.0
        for j in range(m + 3):
            P[i, j] = P[j, i] = 0.0


@named_njit(inner=True, error_model="numpy")
def _go_on(system, bead, work, time, until, step):  # type: ignore[no-untyped-def]
    """Take the state on from a time to another; returns as `_go`."""
    held = min(max(bead.release - time, 0.0), until - time)
    if held > 0:
        _hold(work, held)
    if until - time > held:
        step = _predict(system, bead, work, until - time - max(held, 0.0), step)
    return step


@named_njit(inner=True, error_model="numpy")
def _hold(work, span):  # type: ignore[no-untyped-def]
    """A bead that is held for a time: I alone grows."""
    mean, P, part = work.mean, work.P, work.per_exposure[0] * span
    n, m = mean.shape[0], work.scale.shape[0]
    if part == 0:
        return
    for k in range(3):
        mean[m + k] += part * mean[k]
        for j in range(n):
            P[m + k, j] += part * P[k, j]
    for k in range(3):
        for j in range(n):
            P[j, m + k] += part * P[j, k]


@named_njit(inner=True, error_model="numpy")
def _diffuse(bead, work, diffusion):  # type: ignore[no-untyped-def]
    """By the mobility that `work.at` holds."""
    for k in range(3):
        diffusion[k] = bead.kT * work.at.mobility[1 if k == 2 else 0]


@named_njit(inner=True, error_model="numpy")
def _resist(system, work, z):  # type: ignore[no-untyped-def]
    """Fill `work.at` with the mobility at that z."""
    at = work.at
    at.pose.position[0, 2] = z
    call(system.drag.kernel, (at.pose, system.drag.data, at.resisted))


@named_njit(inner=True, error_model="numpy")
def _rates(system, bead, work, place, rate, A, diffusion):  # type: ignore[no-untyped-def]
    """Rate of change of the filter's state, its derivative, by the emitted model; diffusion."""
    at, state, scale = work.at, work.state, work.scale
    n, m = rate.shape[0], scale.shape[0]
    for i in range(m):
        state[i] = place[i] / scale[i]
    act(system, at, 0.0, state)
    for k in range(3):
        at.force[k] *= bead.power
        for l in range(3):
            at.force_gradient[k, l] *= bead.power
    call(
        system.rates,
        (
            0.0, state, at.force, at.moment, at.force_gradient, at.moment_gradient, at.mobility,
            system.params, rate,
        ),
    )  # fmt: skip
    call(
        system.derivatives,
        (
            0.0, state, at.force, at.moment, at.force_gradient, at.moment_gradient, at.mobility,
            at.mobility_gradient, system.params, A,
        ),
    )  # fmt: skip
    for i in range(m):
        rate[i] *= scale[i]
        for j in range(m):
            A[i, j] *= work.ratio[i, j]
    for i in range(m, n):
        rate[i] = work.per_exposure[0] * place[i - m]
        A[i, i - m] = work.per_exposure[0]
    _diffuse(bead, work, diffusion)
    if not system.uniform:
        rate[2] += bead.kT * at.mobility_gradient[1, 2]
        for k in range(3):  # the mean of mobility times force, over the spread
            for j in range(3):
                spread = at.force_gradient[k, j] * work.P[j, 2]
                rate[k] += at.mobility_gradient[1 if k == 2 else 0, 2] * spread


@named_njit(inner=True, error_model="numpy")
def _go(system, bead, work, span, step):  # type: ignore[no-untyped-def]
    """Take the state on by a time. Returns the next step, 0 if the motion cannot be followed."""
    left = span
    for _ in range(_MOST_STEPS):
        taken, step = _advance(system, bead, work, min(step, left))
        if not taken > 0:
            return 0.0
        left -= taken
        if left < 1e-9 * span:
            return step
    return 0.0


@named_njit(inner=True, error_model="numpy")
def _predict(system, bead, work, span, step):  # type: ignore[no-untyped-def]
    """Take the state on to the next frame; returns as `_go`.

    Where the bead goes far, its motion bends over the spread of z, which no frame tells, and its
    distribution leans to where beads fall faster or slower. So the covariance is widened to the
    wider of two sides: as far as the motion goes that begins three standard deviations off in z,
    the rest of the state with it. The mean is that of a parabola through the three motions.
    """
    mean, P = work.mean, work.P
    n = mean.shape[0]
    if not system.uniform:
        _resist(system, work, mean[2])
        _diffuse(bead, work, work.diffusion)
    variance = max(P[2, 2] + 2 * work.diffusion[2] * span, _LEAST)
    begin, aside = work.begin, work.aside
    for i in range(n):
        begin[i] = mean[i]
        aside[i] = 3 / math.sqrt(variance) * (P[i, 2] + (variance - P[2, 2] if i == 2 else 0.0))
    next_step = _go(system, bead, work, span, step)
    gone = 0.0
    for k in range(3):
        gone += (mean[k] - begin[k]) ** 2
    if gone < (_FAR * bead.radius) ** 2:
        return next_step
    middle, covariance, below, above = work.middle, work.covariance, work.below, work.above
    for i in range(n):
        middle[i] = mean[i]
        for j in range(n):
            covariance[i, j] = P[i, j]
    for sign, side in ((-1, below), (1, above)):
        for i in range(n):
            mean[i] = begin[i] + sign * aside[i]
            for j in range(n):
                P[i, j] = 0.0
        if not _go(system, bead, work, span, step) > 0:
            return 0.0
        for i in range(n):
            side[i] = sign * (mean[i] - middle[i])
    shorter, longer = 0.0, 0.0
    for i in range(n):
        shorter += below[i] ** 2
        longer += above[i] ** 2
    wider = above if longer > shorter else below
    shorter, longer = min(shorter, longer), max(shorter, longer)
    more = (1 - shorter / longer) / 9 if longer > 0 else 0.0
    for i in range(n):
        mean[i] = middle[i] + (above[i] - below[i]) / 18
        for j in range(i + 1):
            P[i, j] = P[j, i] = covariance[i, j] + more * wider[i] * wider[j]
    return next_step


@named_njit(inner=True, error_model="numpy")
def _advance(system, bead, work, step):  # type: ignore[no-untyped-def]
    """Take the state a step on, of that length or as much shorter as its error wants it.

    Returns the length, 0 if there is none, and that of the next step.
    """
    mean, rate, ahead, rise = work.mean, work.rate, work.rate_ahead, work.rise
    A, A_ahead, P, Phi = work.A, work.A_ahead, work.P, work.Phi
    n, m = mean.shape[0], work.scale.shape[0]
    _rates(system, bead, work, mean, rate, A, work.diffusion)
    for _ in range(60):
        _exponentials(work, A, rate, step, False)
        for i in range(n):
            work.place[i] = mean[i] + work.forced[0, i]
        _rates(system, bead, work, work.place, ahead, A_ahead, work.diffusion_ahead)
        for k in range(3):
            work.noise[m - 3 + k, m - 3 + k] = work.diffusion[k] + work.diffusion_ahead[k]
        bent = 0.0
        for i in range(n):
            rise[i] = ahead[i] - rate[i]
            for j in range(n):
                rise[i] -= A[i, j] * work.forced[0, j]
                bent = max(bent, abs(A_ahead[i, j] - A[i, j]))
                A_ahead[i, j] = 0.5 * (A[i, j] + A_ahead[i, j])
        off = math.inf
        if bent * step <= _RATES:
            _exponentials(work, A_ahead, rise, step, True)
            off = 0.0
            for k in range(3):
                off += abs(work.forced[2, k])
        error = off / (_PLACE * math.sqrt(2 * work.diffusion[0] * step))
        if not math.isfinite(error):
            step *= 0.25
            continue
        follow = step * min(max(0.9 * max(error, 1e-9) ** -0.4, 0.2), 4.0)
        if error <= 1:
            for i in range(n):
                mean[i] = work.place[i] + work.forced[2, i]
            _product(Phi, P, work.scratch)
            for i in range(n):
                for j in range(i + 1):
                    total = work.Q[i, j]
                    for k in range(n):
                        total += work.scratch[i, k] * Phi[j, k]
                    P[i, j] = P[j, i] = total
            return step, follow
        step = follow
    return 0.0, step


@named_njit(inner=True, error_model="numpy")
def _product(a, b, out):  # type: ignore[no-untyped-def]
    n = a.shape[0]
    for i in range(n):
        for j in range(n):
            total = 0.0
            for k in range(n):
                total += a[i, k] * b[k, j]
            out[i, j] = total


@named_njit(inner=True, error_model="numpy")
def _copy(a, out):  # type: ignore[no-untyped-def]
    for i in range(a.shape[0]):
        for j in range(a.shape[1]):
            out[i, j] = a[i, j]


@named_njit(inner=True, error_model="numpy")
def _exponentials(work, A, forcing, step, spreading):  # type: ignore[no-untyped-def]
    """Phi = exp(A h) and what a forcing makes of the state, that is constant in `forced[0]`.

    If `spreading`, in `forced[1]` and `forced[2]` one that rises as s/h and (s/h)^2, and Q.
    """
    Phi, Q, forced, X, other = work.Phi, work.Q, work.forced, work.scratch, work.other
    n = A.shape[0]
    size = 0.0
    for i in range(n):
        row = 0.0
        for j in range(n):
            row += abs(A[i, j])
        size = max(size, row)
    halvings, h = 0, step
    while size * h > _SHORT:
        h *= 0.5
        halvings += 1
    # series in A h: of a forcing s^p, p! A^k h^(k+1) / (k+p+1)!
    factors = work.factors
    for p in range(3):
        factors[p] = h / (p + 1)
        for i in range(n):
            forced[p, i] = factors[p] * forcing[i]
    for i in range(n):
        for j in range(n):
            Phi[i, j] = 1.0 if i == j else 0.0
            X[i, j] = Phi[i, j]
            Q[i, j] = h * work.noise[i, j]
    power, next_power = work.vectors[0], work.vectors[1]
    for i in range(n):
        power[i] = forcing[i]
    for term in range(1, _TERMS + 1):
        # (A h)^term / term!, and A^term on the forcing
        _product(A, X, other)
        for i in range(n):
            next_power[i] = 0.0
            for j in range(n):
                X[i, j] = other[i, j] * h / term
                Phi[i, j] += X[i, j]
                next_power[i] += A[i, j] * power[j]
        for p in range(3):
            factors[p] *= h / (term + p + 1)
            for i in range(n):
                forced[p, i] += factors[p] * next_power[i]
        power, next_power = next_power, power
    if spreading:
        _noise_of_a_short_step(work, A, h)
    carried = work.vectors
    for _ in range(halvings):
        for p in range(3):
            for i in range(n):
                carried[p, i] = 0.0
                for j in range(n):
                    carried[p, i] += Phi[i, j] * forced[p, j]
        for i in range(n):
            constant, rising, squared = forced[0, i], forced[1, i], forced[2, i]
            forced[0, i] = carried[0, i] + constant
            forced[1, i] = 0.5 * (carried[1, i] + rising + constant)
            forced[2, i] = 0.25 * (carried[2, i] + squared + 2 * rising + constant)
        if spreading:
            _product(Phi, Q, X)
            for i in range(n):
                for j in range(n):
                    for k in range(n):
                        Q[i, j] += X[i, k] * Phi[j, k]
        _product(Phi, Phi, other)
        _copy(other, Phi)


@named_njit(inner=True, error_model="numpy")
def _noise_of_a_short_step(work, A, h):  # type: ignore[no-untyped-def]
    """Q of a short step: Q' = A Q + Q A^T + noise, as a series."""
    term, other, Q = work.scratch, work.other, work.Q
    n = A.shape[0]
    _copy(Q, term)
    for order in range(2, _TERMS + 2):
        _product(A, term, other)
        for i in range(n):
            for j in range(n):
                term[i, j] = (other[i, j] + other[j, i]) * h / order
        for i in range(n):
            for j in range(n):
                Q[i, j] += term[i, j]


@named_njit(inner=True, error_model="numpy")
def _see(camera, frame, k, shown, work, residuals, weights):  # type: ignore[no-untyped-def]
    """Correct the state by coordinate k of a frame, number shown + k of it; its log-likelihood."""
    seen = camera.positions[frame, k]
    if math.isnan(seen):
        residuals[frame, k] = weights[frame, k] = np.nan
        return 0.0
    mean, P = work.mean, work.P
    n = mean.shape[0]
    at = shown + k
    variance = P[at, at] + camera.noise[k] ** 2
    off = seen - mean[at]
    deviation = math.sqrt(variance)
    exponent = -0.5 * off * off / variance
    density = math.exp(exponent) / (math.sqrt(2 * math.pi) * deviation)
    weight = density / (density + camera.outliers)
    gain = work.vectors[0]
    for i in range(n):
        gain[i] = P[at, i] / variance
    for i in range(n):
        mean[i] += weight * gain[i] * off
        # symmetric to the last digit: what is antisymmetric no measurement lessens, and it grows
        for j in range(i + 1):
            P[i, j] += weight * gain[i] * gain[j] * ((1 - weight) * off * off - variance)
            P[j, i] = P[i, j]
    residuals[frame, k] = off / deviation
    weights[frame, k] = weight
    if camera.outliers > 0:
        return math.log(density + camera.outliers)
    return exponent - math.log(math.sqrt(2 * math.pi) * deviation)
