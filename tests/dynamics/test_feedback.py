"""Controllers that measure a bead and act on it, against linear theory and closed forms.

Variances of n independent beads have a standard error of sqrt(2/n). The bounds are 4.5 of them, which
a right program exceeds once in 150,000 comparisons.
"""

import math

import numpy as np
import pytest
from scipy.linalg import expm, solve_discrete_lyapunov

from tests.dynamics.test_brownian import BEAD, DARK, KT, STIFFNESS
from tests.reference.fields import GaussianWell
from tweezer.dynamics import bound_once
from tweezer.dynamics.walk import walk
from tweezer.forces.spring import Elastic

MASS = BEAD.mass
#: Angular frequency of the bead in its spring, rad/s
SWING = math.sqrt(STIFFNESS / MASS)
COPIES = 4000
#: Relative bound of a variance of that many beads
BOUND = 4.5 * math.sqrt(2 / COPIES)


def held(quality, feedback, *, model="full", time=1.0, samples=2, **simulation):
    """Return beads in a spring of a quality factor with a controller, at `time` in ticks."""
    viscosity = DARK.medium.viscosity * MASS * SWING / BEAD.drag / quality
    rate = feedback["rate"]
    scene = DARK.replace(
        medium={"viscosity": viscosity}, feedback=feedback,
        simulation={"model": model, "duration": time / rate, "samples": samples} | simulation,
    )  # fmt: skip
    return walk(bound_once(scene, [Elastic(STIFFNESS, (0.0, 0.0, 0.0))]))


def ends(bound, copies=COPIES, first=0):
    """Return the states at the end of copies of a walk."""
    who = np.arange(first, first + copies)
    states, out = bound.start(who), np.empty((copies, len(bound.times) - 1, bound.shown.width))
    bound.advance(states, who, 0, out)
    return states


def sampled(quality, rate, F, G, H, J, late, noise):
    """Return the covariance of (x, v, c, queue, force) after a tick of a linear controller.

    The motion between ticks is exact, with the noise by a matrix exponential (Van Loan 1978).
    """
    rate = rate / SWING  # in units of m, sqrt(m/k) and kT
    A, B, T = np.array([[0, 1], [-1, -1 / quality]]), np.array([[0], [1]]), 1 / rate
    step = expm(np.block([[A, B], [np.zeros((1, 3))]]) * T)
    Ad, Bd = step[:2, :2], step[:2, 2:]
    Q = np.diag([0, 2 / quality])
    loan = expm(np.block([[-A, Q], [np.zeros((2, 2)), A.T]]) * T)
    spread = loan[2:, 2:].T @ loan[:2, 2:]
    n = len(G)
    size = 2 + n + late + 1  # the last one acts
    M, R = np.zeros((size, size)), np.zeros((size, size))
    M[:2, :2], M[:2, -1:] = Ad, Bd
    R[:2, :2] = spread
    y = M[0].copy()  # of the new position
    M[2 : 2 + n] = np.outer(G, y)
    M[2 : 2 + n, 2 : 2 + n] += F
    u = J * y + H @ M[2 : 2 + n]
    # noise of the new position goes into c and u
    into = np.zeros((size, size))
    into[:2, :2] = np.eye(2)
    into[2 : 2 + n, 0] = G
    own = np.zeros(size)
    own[2 : 2 + n] = G
    if late:
        M[-1] = 0
        M[-1, 2 + n] = 1
        for j in range(late - 1):
            M[2 + n + j, 2 + n + j + 1] = 1
        M[2 + n + late - 1] = u
        out = 2 + n + late - 1
    else:
        M[-1] = u
        out = size - 1
    into[out, 0] = J + H @ G
    own[out] = J + H @ G
    noisy = into @ R @ into.T + noise * rate * np.outer(own, own)
    return solve_discrete_lyapunov(M, noisy)


@pytest.mark.parametrize(
    ("quality", "damping", "ticks", "late", "noise"),
    [
        (5.0, 0.3, 60, 0, 0.0),
        (5.0, 0.3, 12, 1, 0.0),
        (20.0, 0.2, 25, 3, 0.0),
        (5.0, 0.5, 20, 0, 1e-26),
    ],
)
def test_cold_damping_has_the_moments_of_the_sampled_loop(quality, damping, ticks, late, noise):
    """`ticks` per period 2 pi/SWING; `damping` in units of SWING."""
    rate = ticks * SWING / (2 * math.pi)
    gain = damping * SWING
    settled = math.ceil(12 * ticks / (2 * math.pi) / (damping / 2 + 0.5 / quality))
    bound = held(
        quality,
        {"kind": "cold", "rate": rate, "gain": gain, "delay": late / rate, "noise": noise},
        time=settled,
    )
    found = ends(bound)
    size = damping * rate / SWING
    F, G, H = np.array([[0, 0], [1, 0]]), np.array([1, 0]), np.array([-size, size])
    expected = sampled(quality, rate, F, G, H, 0.0, late, noise * SWING * STIFFNESS / KT)
    x, v = found[:, bound.layout.first("position")], found[:, bound.layout.first("velocity")]
    force = found[:, bound.layout.first("drive")]
    assert x.var() * STIFFNESS / KT == pytest.approx(expected[0, 0], rel=BOUND)
    assert v.var() * MASS / KT == pytest.approx(expected[1, 1], rel=BOUND)
    assert force.var() / (KT * STIFFNESS) == pytest.approx(expected[-1, -1], rel=BOUND)
    # the two other axes are free of the controller
    free = found[:, bound.layout.first("position") + 1]
    assert free.var() == pytest.approx(KT / STIFFNESS, rel=BOUND)
