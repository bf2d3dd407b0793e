"""Kalman filter for a bead in the light, two or three coordinates of which a camera records.

Between two frames the bead moves according to an emitted model of translation with thermal noise,
without inertia (5.2) or with it (A.25, 4.17):

    dx = u dt + sqrt(2 D) dW,    or    dx = (w/tau) dt,  dw = (u(x) - w/tau) dt + sqrt(2 D) dW,

with u = (F + W)/beta_v, D = k_B T/beta_v, w = tau v. Here x is the position, v the velocity, F the
optical force, W the weight, beta_v the drag coefficient, tau the relaxation time of the velocity
and dW an increment of Brownian motion. The filter's state contains w = tau v instead of v, so all
of its components are in metres.

Beside a wall the mobility mu depends on the position. Then u = mu (F + W) + k_B T dmu/dz and
D = k_B T mu (D. L. Ermak and J. A. McCammon, J. Chem. Phys. 69, 1352 (1978)), which is available
only without inertia. The mean of mu F over a distribution with the covariance P differs from the
value at its mean by (dmu/dz)(dF/dx)P, which cancels k_B T dmu/dz in a trap. The second derivative
of mu is neglected. A bead at rest therefore has Boltzmann's mean and variance, in a trap or under
its weight. The noise of a step is the mean of the noise at its ends.

The distribution of the state is assumed to be Gaussian. The force propagates the mean, and its
Jacobian at the mean propagates the covariance (the extended Kalman filter: A. H. Jazwinski,
Stochastic Processes and Filtering Theory, 1970, 8.3). Steps are made by the exponential Rosenbrock
method of order 3 (M. Hochbruck, A. Ostermann, J. Schweitzer, SIAM J. Numer. Anal. 47, 786 (2009)).
Its exponentials are computed by doubling the step, so a linear force is exact over any step. The
force is not linear over more than about a radius. A distribution as wide as that is not Gaussian,
and the likelihood of later frames is unreliable. A narrower distribution becomes skew if the bead
moves far between two frames; it is then widened to its longer tail (`_predict`).

A frame shows the mean of the position over its exposure T (motion blur). The state is therefore
extended by the integral of the position over T, dI = x dt/T, which is 0 when a frame begins.
Without exposure a frame shows the position itself.

A recorded coordinate is the coordinate of the bead plus Gaussian noise or, with a small
probability, an outlier. The state is corrected in proportion to the probability that it is not an
outlier (Y. Bar-Shalom and E. Tse, Automatica 11, 451 (1975)).
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numba import typeof, types

from tweezer.compiled import cached_njit, call, named_njit
from tweezer.dynamics.integrators.system import SYSTEM, act, scratch
from tweezer.dynamics.layout import POSITION, TRANSLATION
from tweezer.dynamics.models import EquationsOfMotion
from tweezer.values.arrays import Array
from tweezer.values.errors import IntegrationError, SceneError
from tweezer.values.vectors import Vector

#: Longest step of the exponential series, times the norm of the Jacobian
_SHORT = 0.5
#: Number of terms of the exponential series
_TERMS = 8
#: Largest error of the position in a step, over the thermal displacement sqrt(2 D h)
_PLACE = 0.03
#: Largest change of the Jacobian in a step, times the step
_RATES = 0.5
#: Motion between frames, in radii, above which it is not linear in the initial position
_FAR = 0.3
#: Upper bound on the steps from one frame to the next
_MOST_STEPS = 10_000
#: Time between two exposures below which they count as adjacent (times are rounded), in exposures
_INSTANT = 1e-6
#: First column of the velocity, in the state of a model with inertia
_VELOCITY = POSITION.stop
#: Lower bound on the variance of z, m^2
_LEAST = 1e-40

_matrix, _vector = types.float64[:, ::1], types.float64[::1]


class Bead(NamedTuple):
    """Bead that the filter follows: its constants, and the distribution of its initial position."""

    radius: float
    """Radius, m."""
    power: float
    """Power of the light over the power in its scene."""
    kT: float
    """Thermal energy k_B T, J."""
    start: Array
    """(3,) mean of the initial position, m."""
    spread: Array
    """(3,) standard deviations of the initial position, m; 0 for a known coordinate."""
    velocity: Array
    """(3,) initial velocity, m/s; used only by models with inertia."""
    release: float
    """Time after the beginning of the first frame until which the bead is held at rest, s."""


class Camera(NamedTuple):
    """Track of n frames and c coordinates recorded by a camera, and the errors of the camera."""

    times: Array
    """(n,) beginnings of the frames, relative to the first one, s."""
    positions: Array
    """(n, c) recorded x, y and, if c = 3, z, m; NaN for a missing coordinate."""
    noise: Array
    """(c,) standard deviation of the camera's Gaussian noise in each coordinate, m."""
    outliers: float
    """Probability density of outliers, 1/m: the odds of an outlier over the length in which they
    occur. It is added to the density of the bead's coordinate; 0 without outliers."""
    exposure: float = 0.0
    """Time over which a frame averages the position, at most the time between two frames, s."""


class Filtered(NamedTuple):
    """Result of a Kalman filter for a track of n frames and c coordinates."""

    log_likelihood: float
    """Logarithm of the probability density of the recorded coordinates in m."""
    predicted: Vector
    """(n, 3) predicted mean position in each frame, given the previous frames, m."""
    deviations: Vector
    """(n, 3) standard deviations of the predicted positions, without camera noise, m."""
    residuals: Vector
    """(n, c) recorded minus predicted coordinates, over their standard deviation with camera noise;
    NaN for a missing coordinate. For a correct model they are independent, with mean 0 and variance
    1."""
    weights: Vector
    """(n, c) probability that the coordinate is not an outlier; NaN if it is missing."""


def kalman_filter(equations: EquationsOfMotion) -> Callable[..., Filtered]:
    """Return a Kalman filter for tracks of a bead, from its translational equations of motion.

    The filter is a function of a `Bead`, a `Camera` and, optionally, `least`, a log-likelihood. It
    stops at the frame after which `least` can no longer be reached, returns an upper bound of the
    log-likelihood, and leaves later rows NaN. It raises `IntegrationError` if the motion cannot be
    computed. A drag that depends on the position is assumed to depend only on z.

    Parameters
    ----------
    equations : EquationsOfMotion
        Equations of motion of a bead that does not rotate.

    Raises
    ------
    SceneError
        If the model has inertia and the drag depends on the position.
    """
    if equations.inertial and not equations.drag.uniform:
        raise SceneError(
            f"simulation.model = {equations.scene.simulation.model!r}: the Kalman filter does not "
            "support inertia under a drag that depends on the position; set simulation.model to "
            "overdamped"
        )
    system = equations.system(gradient=True, derivatives=True)
    # velocities are multiplied by their relaxation time, so that the whole state is in metres
    scale = np.ones(len(equations.initial_state))
    if equations.inertial:
        scale[equations.layout.at("velocity")] = equations.relaxation.modes.times[TRANSLATION, 0]
    loop = _loop()

    def filtered(bead: Bead, camera: Camera, least: float = -math.inf) -> Filtered:
        """Filter the track of a camera, stopping if its log-likelihood cannot reach `least`."""
        seen = camera.positions.shape[1]
        out = [np.full((len(camera.times), columns), np.nan) for columns in (3, 3, seen, seen)]
        log_likelihood = loop(system, scale, bead, camera, least, *out)
        if not math.isfinite(log_likelihood):
            raise IntegrationError(f"the motion from z = {bead.start[2]:.6g} m cannot be computed")
        return Filtered(log_likelihood, *out)

    return filtered


@functools.cache
def _loop() -> Any:
    """Compile the loop over frames, which fills the arrays of a `Filtered`.

    Its arguments are the bound force and drag (`system`), the factors (m,) that convert the state's
    components to metres (`scale`, see `Room`), the bead, the camera, the smallest log-likelihood of
    interest and the four arrays of `Filtered`. It returns the log-likelihood, or NaN if the motion
    cannot be computed.
    """
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
        """Filter all frames; `_loop` describes the arguments and the result."""
        m = scale.shape[0]  # number of components of the state without I (`Room`)
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
        most = 0.0  # largest possible log-likelihood of one frame
        for k in range(coordinates):
            sharpest = 1 / (math.sqrt(2 * math.pi) * camera.noise[k])
            most += math.log(sharpest + camera.outliers)
        shown = m if camera.exposure > 0 else 0  # first row of the state that a frame shows
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
    """State of the filter and the arrays in which a step is computed.

    The state consists of the position x and, with inertia, of the velocity multiplied by its
    relaxation time, w. With an exposure it also contains I, the integral of the position since the
    beginning of the exposure, divided by the exposure. Each has three components in metres. Below,
    m (3 or 6) is the number of components of x and w, and n (m or m + 3) is that of the state.
    """

    scale: Array
    """(m,) factors from the model's state to the filter's: 1 for x, relaxation time (s) for v"""
    ratio: Array
    """(m, m) factors from the model's Jacobian to the filter's, scale_i / scale_j"""
    per_exposure: Array
    """(1,) inverse exposure during an exposure, otherwise 0, 1/s"""
    diffusion: Array
    """(3,) diffusion coefficients along the axes at the beginning of a step, m^2/s"""
    diffusion_ahead: Array
    """(3,) diffusion coefficients at the end of a step, m^2/s"""
    mean: Array
    """(n,) mean of the state, m"""
    P: Array
    """(n, n) covariance of the state, m^2"""
    place: Array
    """(n,) first estimate of the mean at the end of a step, m"""
    rate: Array
    """(n,) rate of change of the mean at the beginning of a step, m/s"""
    rate_ahead: Array
    """(n,) rate of change at `place`, m/s"""
    rise: Array
    """(n,) part of the change of the rate in a step that is not linear in the state, m/s"""
    A: Array
    """(n, n) Jacobian d(rate)/d(state) at the beginning of a step, 1/s"""
    A_ahead: Array
    """(n, n) Jacobian at `place`, later the mean of both Jacobians, 1/s"""
    noise: Array
    """(n, n) rate at which thermal motion increases the covariance, 2 D on the diagonal, m^2/s"""
    Phi: Array
    """(n, n) exp(A h), which propagates a deviation of the state over a step of length h"""
    Q: Array
    """(n, n) covariance that thermal motion adds in a step, m^2"""
    forced: Array
    """(3, n) displacements by a rate that is constant, or increases as s/h or (s/h)^2 with the time
    s since the beginning of a step of length h, m"""
    scratch: Array
    """(n, n) intermediate product"""
    other: Array
    """(n, n) intermediate product"""
    vectors: Array
    """(3, n) intermediate vectors"""
    begin: Array
    """(n,) mean of the state at the beginning of the motion to the next frame, m"""
    middle: Array
    """(n,) mean of the state at the next frame, m"""
    aside: Array
    """(n,) distance of two neighbours from `begin`, three standard deviations in z, m"""
    below: Array
    """(n,) distance of the lower neighbour below `middle` at the next frame, m"""
    above: Array
    """(n,) distance of the upper neighbour above `middle` at the next frame, m"""
    covariance: Array
    """(n, n) covariance at the next frame before it is widened (`_predict`), m^2"""
    factors: Array
    """(3,) coefficients of a term of the series for each row of `forced`, s"""
    state: Array
    """(m,) state of the model, with velocities in m/s"""
    at: Any
    """arrays in which force, mobility and their gradients at one position are computed"""


@named_njit(inner=True, error_model="numpy")
def _room(system, scale, exposed):  # type: ignore[no-untyped-def]
    """Allocate a `Room` of zeros; `scale` (m,) is its field, `exposed` whether frames average."""
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
    """Begin the exposure of a frame by setting the integral I of the position to 0.

    I is in rows m, m + 1 and m + 2 of the state in `work`. It then grows by the position times
    `rate`, the inverse exposure, 1/s.
    """
    mean, P = work.mean, work.P
    work.per_exposure[0] = rate
    for i in range(m, m + 3):
        mean[i] = 0.0
        for j in range(m + 3):
            P[i, j] = P[j, i] = 0.0


@named_njit(inner=True, error_model="numpy")
def _go_on(system, bead, work, time, until, step):  # type: ignore[no-untyped-def]
    """Propagate the state of `work` from `time` to `until`, s, with the bead held until released.

    `step`, s, is the suggested integration step. Returns the next one, or 0 if the motion cannot be
    computed.
    """
    held = min(max(bead.release - time, 0.0), until - time)
    if held > 0:
        _hold(work, held)
    if until - time > held:
        step = _predict(system, bead, work, until - time - max(held, 0.0), step)
    return step


@named_njit(inner=True, error_model="numpy")
def _hold(work, span):  # type: ignore[no-untyped-def]
    """Propagate the state over `span`, s, in which the bead is held.

    Only I, the integral of the position over an exposure (rows m to m + 2), changes. It grows by
    the position times `part`, the fraction of the exposure in the span. Rows of the covariance are
    updated first, then its columns.
    """
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
    """Fill `diffusion` (3,), m^2/s, with k_B T times the mobility along each axis in `work.at`.

    The first of the two mobilities applies to x and y, the second to z, perpendicular to a wall.
    """
    for k in range(3):
        diffusion[k] = bead.kT * work.at.mobility[1 if k == 2 else 0]


@named_njit(inner=True, error_model="numpy")
def _resist(system, work, z):  # type: ignore[no-untyped-def]
    """Compute the mobilities of the bead at height `z`, m, into `work.at`."""
    at = work.at
    at.pose.position[0, 2] = z
    call(system.drag.kernel, (at.pose, system.drag.data, at.resisted))


@named_njit(inner=True, error_model="numpy")
def _rates(system, bead, work, place, rate, A, diffusion):  # type: ignore[no-untyped-def]
    """Compute the rate of change of the filter's state at `place` by the emitted model.

    The function writes `rate` (n,), m/s, its Jacobian `A` (n, n), 1/s, and the diffusion
    coefficients `diffusion` (3,), m^2/s. `place` (n,), m, is a state as described by `Room`,
    `system` contains the bound force and drag, and `work` provides scratch arrays and the
    covariance.
    """
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
        rate[2] += bead.kT * at.mobility_gradient[1, 2]  # thermal drift towards higher mobility
        # covariance of mobility and force: the mean of their product minus the product at the mean
        for k in range(3):
            for j in range(3):
                spread = at.force_gradient[k, j] * work.P[j, 2]
                rate[k] += at.mobility_gradient[1 if k == 2 else 0, 2] * spread


@named_njit(inner=True, error_model="numpy")
def _go(system, bead, work, span, step):  # type: ignore[no-untyped-def]
    """Propagate the state of `work` over `span`, s, in steps chosen by the error estimate.

    `step`, s, is the first step to try. Returns the next step, s, or 0 if the motion cannot be
    computed.
    """
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
    """Propagate the state of `work` to the next frame, over `span`, s.

    If the bead moves far, the motion is not linear over the spread of z, which no frame shows, and
    the distribution becomes skew. The motions that begin three standard deviations below and above
    the mean in z (with the other coordinates as correlated with z) are then propagated as well. The
    covariance is widened to the longer of the two sides, and the mean follows from a parabola
    through the three motions. `step` and the returned next step, s, are as in `_go`.
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
    # the neighbours are propagated in the same `work`, so mean and covariance are copied first
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
    # squared lengths of the two sides; a side is three standard deviations, so 9 is 3^2
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
    """Propagate the state of `work` by one step of `step`, s, or by a shorter one.

    The exponential Rosenbrock method of order 3 propagates the mean. Its correction to the
    exponential Euler method is the error estimate. A step is shortened until this estimate is below
    `_PLACE` thermal displacements and the Jacobian changes by less than `_RATES` over the step.
    Returns the length of the step that was made, 0 if none was short enough, and the next length to
    try.
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
        bent = 0.0  # largest change of an element of the Jacobian, 1/s
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
    """Write the product of two square matrices to `out`, which must be a third array."""
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
    """Compute Phi = exp(A h) and the displacements by a rate `forcing`, for a step h = `step`, s.

    `A` (n, n), 1/s, is the Jacobian and `forcing` (n,) a rate, m/s. Row p of `work.forced`, p = 0,
    1, 2, is set to the integral of exp(A (h - s)) (s/h)^p forcing over the step. If `spreading`,
    `work.Q` is set to the covariance that `work.noise` adds. A power series gives all of them for a
    step of h / 2^halvings, short enough to converge; this step is then doubled repeatedly.
    """
    Phi, Q, forced, X, other = work.Phi, work.Q, work.forced, work.scratch, work.other
    n = A.shape[0]
    size = 0.0  # norm of A, the largest sum of a row
    for i in range(n):
        row = 0.0
        for j in range(n):
            row += abs(A[i, j])
        size = max(size, row)
    halvings, h = 0, step
    while size * h > _SHORT:
        h *= 0.5
        halvings += 1
    # series in A h; its terms for a forcing s^p are p! A^k h^(k+1) / (k+p+1)!
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
        # (A h)^term / term!, and A^term applied to the forcing
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
    # double the step: Phi propagates displacements and Q of the first half over the second half
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
    """Compute `work.Q`, m^2, the covariance that noise adds in a short step `h`, s.

    It solves Q' = A Q + Q A^T + N, with the Jacobian A, 1/s, and the noise N, m^2/s, by a power
    series in h. The caller has stored its first term, N h, in `work.Q`.
    """
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
    """Correct the state of `work` by coordinate `k` of a frame, and return its log-likelihood.

    Row `shown` + k of the state contains the coordinate as a frame shows it. The correction of the
    Kalman filter is multiplied by a weight, the probability that the number is not an outlier. The
    coordinate's residual and weight are stored. A missing coordinate changes nothing and has the
    log-likelihood 0.
    """
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
        # keep P exactly symmetric: an antisymmetric part would never be corrected, and would grow
        for j in range(i + 1):
            P[i, j] += weight * gain[i] * gain[j] * ((1 - weight) * off * off - variance)
            P[j, i] = P[i, j]
    residuals[frame, k] = off / deviation
    weights[frame, k] = weight
    if camera.outliers > 0:
        return math.log(density + camera.outliers)
    return exponent - math.log(math.sqrt(2 * math.pi) * deviation)
