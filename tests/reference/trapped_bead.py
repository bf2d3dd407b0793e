"""A bead in a harmonic trap, sampled exactly: the linear Langevin equation and nothing else.

    m x'' + beta x' + k x = sqrt(2 kB T beta) white noise        (without m: m = 0)

The state one sample on is a linear map of the state plus a Gaussian vector, both from matrix
exponentials (C. F. Van Loan, IEEE Trans. Autom. Control 23, 395 (1978)): no step, no error of one.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import expm

BOLTZMANN = 1.380649e-23


def trapped(time_step, samples, k, drag, mass, temperature, seed, trajectories=1, exposure=0.0):
    """Positions (trajectories, samples), m, from thermal equilibrium; mass None: overdamped.

    With an exposure each is the mean over that time, from its sample on: the integral of the
    position is one more variable of the same linear equation.
    """
    kT = BOLTZMANN * temperature
    if mass is None:
        rates, noise = np.array([[-k / drag]]), np.array([[2 * kT / drag]])
        equilibrium = np.array([kT / k])
    else:
        rates = np.array([[0.0, 1.0], [-k / mass, -drag / mass]])
        noise = np.array([[0.0, 0.0], [0.0, 2 * kT * drag / mass**2]])
        equilibrium = np.array([kT / k, kT / mass])
    # each variable in units of its thermal size, so that the matrices are well conditioned
    size = np.sqrt(equilibrium)
    rates, noise = rates * size / size[:, None], noise / np.outer(size, size)
    n = len(size)
    rng = np.random.default_rng(seed)
    state = rng.standard_normal((n, trajectories))
    positions = np.empty((samples, trajectories))
    step, kick = propagator(rates, noise, time_step - exposure)
    if exposure:
        exposing = np.zeros((n + 1, n + 1))
        exposing[:n, :n], exposing[n, 0] = rates, 1 / exposure
        noise = np.pad(noise, (0, 1))
        seen, kick_seen = propagator(exposing, noise, exposure)
    for i in range(samples):
        positions[i] = state[0]
        if exposure:
            state = seen[:, :n] @ state + kick_seen @ rng.standard_normal((n + 1, trajectories))
            state, positions[i] = state[:n], state[n]
        state = step @ state + kick @ rng.standard_normal((n, trajectories))
    return size[0] * positions.T


def propagator(rates, noise, time):
    """The linear map of a state over `time`, and a root of the covariance that noise adds."""
    n = len(rates)
    block = expm(time * np.block([[-rates, noise], [np.zeros((n, n)), rates.T]]))
    step = block[n:, n:].T
    added = step @ block[:n, n:]
    return step, np.linalg.cholesky(added) if time else np.zeros((n, n))


def double_well(barrier, minima, samples, temperature, seed):
    """Independent positions (samples,), m, in U = barrier ((x/minima)^2 - 1)^2, by rejection."""
    rng = np.random.default_rng(seed)
    x = rng.uniform(-2.5 * minima, 2.5 * minima, 40 * samples)
    energy = barrier * ((x / minima) ** 2 - 1) ** 2
    kept = x[rng.random(x.size) < np.exp(-energy / (BOLTZMANN * temperature))]
    assert kept.size >= samples
    return kept[:samples]


def viscoelastic(time_step, samples, k, solvent, elements, temperature, seed, trajectories=1):
    """Positions (trajectories, samples), m, of a bead without mass in Maxwell elements.

    An element of drag b and time t is a spring b/t from the bead to a hidden bead of drag b at u:

        beta x' = -k x - sum (b/t)(x - u) + noise,    b u' = (b/t)(x - u) + noise

    `solvent` is beta, kg/s, and `elements` are pairs (b, t).
    """
    kT = BOLTZMANN * temperature
    drags = np.array([solvent, *(b for b, _ in elements)])
    springs = np.array([b / t for b, t in elements])
    stiffness = np.diag([k + springs.sum(), *springs])
    stiffness[0, 1:] = stiffness[1:, 0] = -springs
    size = np.linalg.cholesky(np.linalg.inv(stiffness) * kT)  # of the thermal motion
    back = np.linalg.inv(size)
    rates = back @ (-stiffness / drags[:, None]) @ size
    step, kick = propagator(rates, back @ np.diag(2 * kT / drags) @ back.T, time_step)
    rng = np.random.default_rng(seed)
    state = rng.standard_normal((len(drags), trajectories))
    positions = np.empty((samples, trajectories))
    for i in range(samples):
        positions[i] = size[0] @ state
        state = step @ state + kick @ rng.standard_normal(state.shape)
    return positions.T
