"""Weights of a Brownian step: the effect of drag, spring and thermal noise on each coordinate.

The formulas come from `derivation.langevin`. A spring whose stiffness is not diagonal couples the
coordinates. Their step is then the exponential of the matrix of the linear equations, and Van
Loan's block matrix gives their noise (C. F. Van Loan, IEEE Trans. Autom. Control 23, 395 (1978)).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from tweezer.dynamics.brownian import memory, viscoelastic
from tweezer.dynamics.layout import POSITION, ROTATION, TRANSLATION
from tweezer.fluid import Network
from tweezer.generated import langevin
from tweezer.values.arrays import Array
from tweezer.values.errors import SceneError

#: the longest step of the emitted series, in relaxation times and in 1/|kappa|
_SHORT = 1 / 64


class Weights(NamedTuple):
    """Coefficients of a step of each coordinate, all (dims,) unless stated otherwise.

    x gains by_v v + by_u u + by_rise du + noise_x n, and v becomes decay v + v_by_u u + v_by_rise
    du + noise_xv n + noise_v n'. Here x is the position, v the velocity, and u the slow velocity
    (force over drag) at x, including the spring's. Its change over the step beyond the spring's
    change is du. The standard normal numbers n and n' are independent.
    """

    by_v: Array
    """s"""
    by_u: Array
    """s"""
    by_rise: Array
    """s"""
    decay: Array
    """fraction of the velocity that is left after the step"""
    v_by_u: Array
    """velocity per slow velocity"""
    v_by_rise: Array
    """velocity per change of the slow velocity"""
    kappa: Array
    """1/s, stiffness over drag of the spring whose motion is exact"""
    noise_x: Array
    """standard deviation of the noise of the position, m or rad"""
    noise_xv: Array
    """m/s or rad/s: the part of the velocity's noise that is proportional to the position's"""
    noise_v: Array
    """standard deviation of the rest of the velocity's noise, m/s or rad/s"""
    coupled: Array = np.zeros((0, 0))
    """(m, m) matrix by which a step multiplies position and velocity relative to the trap's centre,
    where its spring couples the coordinates: m = 6, or 3 without inertia; empty where it does
    not
    """
    coupled_noise: Array = np.zeros((0, 0))
    """(m, m) lower triangular matrix by which normal numbers become the noise of a coupled step; m
    and m/s
    """
    memory: Array = memory.NONE
    """(3, 7 + n, n) coefficients of the n hidden variables of each axis of translation, see
    `tweezer.dynamics.brownian.memory`; by_v, decay, v_by_u, v_by_rise, noise_xv and noise_v of
    these axes are then 0
    """


def inertial_block(h: float, tau: float, kappa: float) -> Array:
    """Return d, j, l, c_xx and c_vv of a step with inertia, as `derivation.langevin` defines them.

    `h` is the length of the step (s), of any size, `tau` the relaxation time of the velocity (s),
    and `kappa` stiffness over drag (1/s). The series for a short step is doubled to the length h.
    The function is not compiled, because a run calls it once for each axis.
    """
    halvings = _halvings(h / tau, abs(kappa) * h, math.sqrt(abs(kappa) / tau) * h)
    h = math.ldexp(h, -halvings)
    block = np.array(langevin.inertial_of_a_short_step.py_func(h, tau, kappa))
    for _ in range(halvings):
        block = np.array(langevin.inertial_of_twice_the_step.py_func(h, tau, kappa, block))
        h *= 2
    return block


def overdamped_block(h: float, kappa: float) -> Array:
    """Return d and j of a step without inertia, as `derivation.langevin` defines them.

    `h` is the length of the step (s), of any size, and `kappa` stiffness over drag (1/s). The
    function is not compiled, because a run calls it once for each axis.
    """
    halvings = _halvings(abs(kappa) * h)
    h = math.ldexp(h, -halvings)
    block = np.array(langevin.overdamped_of_a_short_step.py_func(h, kappa))
    for _ in range(halvings):
        block = np.array(langevin.overdamped_of_twice_the_step.py_func(h, kappa, block))
        h *= 2
    return block


def _halvings(*sizes: float) -> int:
    """Return how often a step must be halved for the series: until all sizes are below `_SHORT`.

    sizes: the step over each time scale of the motion.
    """
    return max(0, math.ceil(math.log2(max(max(sizes) / _SHORT, 1.0))))


def exact(h: float, tau: Array, kappa: Array, diffusion: Array) -> Weights:
    """Return the coefficients of the exact step under drag, springs and noise.

    Parameters
    ----------
    h : float
        Length of the step, s.
    tau : ndarray, shape (dims,)
        Relaxation times of the velocity, s; 0 for a coordinate without inertia.
    kappa : ndarray, shape (dims,)
        Stiffness over drag, 1/s.
    diffusion : ndarray, shape (dims,)
        kT/drag, m^2/s or rad^2/s.
    """
    columns = [
        _inertial(h, *each) if each[0] > 0 else _overdamped(h, *each[1:])
        for each in zip(tau.tolist(), kappa.tolist(), diffusion.tolist(), strict=True)
    ]
    return Weights(*np.array(columns, dtype=np.float64).T.copy())


def with_memory(h: float, times: Array, parts: Array, exact: Weights, diffusion: Array) -> Weights:
    """Return the coefficients of a step in a fluid with memory, from those without memory.

    Parameters
    ----------
    h : float
        Length of the step, s.
    times, parts : ndarray, shape (n,)
        Relaxation times tau_j, s, and weights a_j of the velocity modes, see
        `tweezer.dynamics.brownian.memory`.
    exact : Weights
        Coefficients without memory, whose springs and rotation are kept.
    diffusion : ndarray, shape (dims,)
        kT/drag, m^2/s or rad^2/s.
    """
    kappa = exact.kappa[TRANSLATION].tolist()
    axes = [
        memory.axis(h, times, parts, *each) for each in zip(kappa, diffusion.tolist(), strict=False)
    ]
    return _remembering(exact, axes)


def with_network(h: float, network: Network, exact: Weights, diffusion: Array) -> Weights:
    """Return the coefficients of a step in a viscoelastic medium, from those of its solvent.

    Parameters
    ----------
    h : float
        Length of the step, s.
    network : Network
        Elements of the medium, beside the solvent of the other coefficients.
    exact : Weights
        Coefficients in the solvent, whose springs are kept.
    diffusion : ndarray, shape (dims,)
        kT/drag of the solvent, m^2/s.
    """
    kappa = exact.kappa[TRANSLATION].tolist()
    springs = zip(kappa, diffusion.tolist(), strict=False)
    return _remembering(exact, [viscoelastic.axis(h, network, *each) for each in springs])


def _remembering(exact: Weights, axes: list[memory.Axis]) -> Weights:
    """Return coefficients with those of hidden variables along each axis."""
    none = np.ones(len(exact.kappa))
    none[TRANSLATION] = 0.0

    def changed(weight: Array, values: list[float]) -> Array:
        return np.concatenate([values, weight[ROTATION]])

    return exact._replace(
        **{name: getattr(exact, name) * none for name in (
            "by_v", "decay", "v_by_u", "v_by_rise", "noise_xv", "noise_v",
        )},
        by_u=changed(exact.by_u, [each.x_by_u for each in axes]),
        by_rise=changed(exact.by_rise, [each.x_by_rise for each in axes]),
        noise_x=changed(exact.noise_x, [each.noise_x for each in axes]),
        memory=memory.together(axes),
    )  # fmt: skip


def coupled(h: float, tau: Array, rates: Array, diffusion: Array) -> tuple[Array, Array]:
    """Return the matrix of a step of (position, velocity) and a lower root of its noise's
    covariance.

    The matrices of a short step are doubled: this adds covariances, so no digits cancel.

    Parameters
    ----------
    h : float
        Length of the step, s.
    tau : ndarray, shape (3,)
        Relaxation times, s; zeros without inertia, and then the matrices describe the position
        alone.
    rates : ndarray, shape (3, 3)
        Mobility times stiffness, 1/s.
    diffusion : ndarray, shape (3,)
        Diffusion coefficients, m^2/s.
    """
    from scipy.linalg import expm

    size = float(np.linalg.norm(rates, 2))
    sizes = [size * h]
    if tau[0] > 0:
        sizes += [h / tau.min(), math.sqrt(size / tau.min()) * h]
    halvings = _halvings(*sizes)
    h = math.ldexp(h, -halvings)
    A, noise = _linear_motion(tau, rates, diffusion)
    unit = np.ones(len(A))
    if tau[0] > 0:
        unit[POSITION] = h  # displacement per velocity in a short step
    A, noise = A * unit / unit[:, None], noise / unit**2
    n = len(A)
    block = expm(h * np.block([[-A, np.diag(noise)], [np.zeros_like(A), A.T]]))
    change, covariance = block[n:, n:].T - np.eye(n), block[n:, n:].T @ block[:n, n:]
    for _ in range(halvings):
        left = np.eye(n) + change
        covariance = covariance + left @ covariance @ left.T
        change = 2 * change + change @ change
    return (np.eye(n) + change) * unit[:, None] / unit, unit[:, None] * _root(covariance)


def stationary_root(tau: Array, rates: Array, diffusion: Array) -> Array:
    """Return a lower root of the stationary covariance of (position, velocity) in the trap.

    The covariance solves the Lyapunov equation of the linear motion. `tau` (3,) are the relaxation
    times (s); if they are 0, the covariance describes the position alone. `rates` (3, 3) are
    mobility times stiffness (1/s), and `diffusion` (3,) is kT/drag (m^2/s).

    Raises `SceneError` if there is no stationary motion: light that pushes a bead round the axis
    drives it out of a trap whose drag is too weak.
    """
    from scipy.linalg import solve_continuous_lyapunov

    tau_or_none = tau if tau[0] > 0 else tau[:0]
    if np.array_equal(rates, np.diag(np.diag(rates))):
        of_x = np.sqrt(diffusion / np.diag(rates))
        return np.diag(np.concatenate([of_x, np.sqrt(diffusion[: len(tau_or_none)] / tau_or_none)]))
    A, noise = _linear_motion(tau, rates, diffusion)
    if (growing := float(np.linalg.eigvals(A).real.max())) >= 0:
        raise SceneError(
            "start.drawn = 'boltzmann': there is no stationary motion, as the light pushes the "
            f"bead round the axis, and its circles grow by {growing:.3g}/s; set start.drawn to "
            "equilibrium"
        )
    unit = np.sqrt(np.concatenate([
        diffusion / np.diag(rates), diffusion[: len(tau_or_none)] / tau_or_none,
    ]))  # fmt: skip
    A, noise = A * unit / unit[:, None], noise / unit**2
    return unit[:, None] * _root(solve_continuous_lyapunov(A, -np.diag(noise)))


def stationary_root_with_memory(weights: Weights, rates: Array) -> Array:
    """Return a root of the stationary covariance of position and hidden variables under Heun steps.

    The result is (3 + 3 n, 3 + 3 n), for n hidden variables z of each axis. `rates` (3, 3) are
    mobility times stiffness (1/s). Their entries beyond the springs of the weights act as the rest
    of the force. Raises `SceneError` if there is no stationary motion.
    """
    z, n = weights.memory, weights.memory.shape[2]
    size = 3 + 3 * n
    of_x, of_z = np.split(np.eye(size), [POSITION.stop])

    def of_axes(weight: Array) -> Array:
        """Return coefficients (3, n), a row for each axis, as a block-diagonal matrix (3, 3 n)."""
        made: Array = (np.eye(3)[:, :, None] * weight).reshape(3, 3 * n)
        return made

    beyond = np.diag(weights.kappa[TRANSLATION]) - rates
    u = -rates @ of_x
    ahead = of_x + of_axes(z[:, memory.X_BY]) @ of_z + weights.by_u[TRANSLATION, None] * u
    spread = np.hstack([np.diag(weights.noise_x[TRANSLATION]), np.zeros((3, 3))])
    left = z[:, memory.DECAY].reshape(-1, 1) * of_z + of_axes(z[:, memory.BY_U]).T @ u
    noise = np.hstack([of_axes(z[:, memory.NOISE]).T, of_axes(z[:, memory.OWN]).T])
    rise, shaken = beyond @ (ahead - of_x), beyond @ spread
    A = np.vstack([
        ahead + weights.by_rise[TRANSLATION, None] * rise,
        left + of_axes(z[:, memory.BY_RISE]).T @ rise,
    ])  # fmt: skip
    noise = np.vstack([
        spread + weights.by_rise[TRANSLATION, None] * shaken,
        noise + of_axes(z[:, memory.BY_RISE]).T @ shaken,
    ])  # fmt: skip
    largest = float(np.abs(np.linalg.eigvals(A)).max())
    if largest >= 1:
        raise SceneError(
            "start.drawn = 'boltzmann': there is no stationary motion, because the light drives "
            f"the bead in growing circles around the axis ({100 * (largest - 1):.3g} % a step); "
            "set start.drawn to equilibrium"
        )
    covariance = noise @ noise.T
    while np.abs(A).max() > 0:
        covariance, A = covariance + A @ covariance @ A.T, A @ A
        A[np.abs(A) < 1e-300] = 0.0
    spread = np.sqrt(np.diag(covariance))
    spread = np.where(spread > 0, spread, 1.0)
    variance, directions = np.linalg.eigh(covariance / np.outer(spread, spread))
    root: Array = spread[:, None] * directions * np.sqrt(np.maximum(variance, 0.0))
    return root


def _linear_motion(tau: Array, rates: Array, diffusion: Array) -> tuple[Array, Array]:
    """Return A and q of dz = A z dt + sqrt(q) dW.

    z is the position and, with inertia (`tau` > 0, s), the velocity. `rates` are mobility times
    stiffness (1/s), and `diffusion` is kT/drag (m^2/s).
    """
    if tau[0] == 0:
        return -rates, 2 * diffusion
    none, one = np.zeros((3, 3)), np.eye(3)
    A = np.block([[none, one], [-rates / tau[:, None], -one / tau]])
    return A, np.concatenate([np.zeros(3), 2 * diffusion / tau**2])


def _root(covariance: Array) -> Array:
    """Return the lower Cholesky root of a covariance, whose variances may differ by any factor.

    It is the root of the correlation matrix, scaled by the standard deviations: so units do not
    matter.
    """
    from scipy.linalg import cholesky

    spread = np.sqrt(np.diag(covariance))
    correlation = (covariance + covariance.T) / (2 * np.outer(spread, spread))
    root: Array = cholesky(correlation, lower=True) * spread[:, None]
    return np.ascontiguousarray(root)


def _inertial(h: float, tau: float, kappa: float, diffusion: float) -> tuple[float, ...]:
    """Return the fields of `Weights` from by_v to noise_v for one coordinate with inertia."""
    block = inertial_block(h, tau, kappa)
    *weights, c_xv = langevin.inertial_step.py_func(h, tau, kappa, block)
    c_xx, c_vv = block[3:].tolist()
    size = math.sqrt(diffusion / tau)
    return (
        *weights, kappa, size * math.sqrt(c_xx), size * c_xv / math.sqrt(c_xx),
        size * math.sqrt(c_vv - c_xv * c_xv / c_xx),
    )  # fmt: skip


def _overdamped(h: float, kappa: float, diffusion: float) -> tuple[float, ...]:
    """Return the fields of `Weights` from by_v to noise_v for one coordinate without inertia."""
    by_u, by_rise, spread = langevin.overdamped_step.py_func(h, kappa, overdamped_block(h, kappa))
    return 0.0, by_u, by_rise, 0.0, 0.0, 0.0, kappa, math.sqrt(diffusion * spread), 0.0, 0.0
