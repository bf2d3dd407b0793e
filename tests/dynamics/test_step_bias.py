"""Steps of thermal motion at low damping and under forces that circulate, and what they err by.

Seeds are fixed; the bounds are those that a right program would exceed for one seed in a million.
"""

import math
from dataclasses import dataclass

import numpy as np
import pytest
from scipy.integrate import quad

import tweezer
from tests.dynamics.test_brownian import BEAD, DARK, DRAG, FAR, KT, STIFFNESS, TRAP, followed
from tests.reference.fields import GaussianWell
from tweezer.compiled import cached_njit
from tweezer.dynamics import bound_once
from tweezer.dynamics.walk import walk
from tweezer.forces.data import number, packed
from tweezer.forces.equilibria import Search
from tweezer.forces.force import Force

#: Time of a swing of the bead in its well, sqrt(m/k), s
SWING = math.sqrt(BEAD.mass / STIFFNESS)


def levitated(quality, depth, **simulation):
    """Return a bead in a Gaussian well of that depth, kT, in a fluid of that damping."""
    viscosity = DARK.medium.viscosity * math.sqrt(STIFFNESS * BEAD.mass) / DRAG / quality
    scene = DARK.replace(
        medium={"viscosity": viscosity},
        simulation={"model": "full", "duration": 1e-4, "samples": 2} | simulation,
    )
    well = GaussianWell(STIFFNESS, math.sqrt(depth * KT / STIFFNESS))
    return walk(bound_once(scene, [well]))


def test_steps_of_a_period_do_not_follow_the_damping():
    for method, least in (("heun", 40), ("kick", 15)):
        steps = [
            2 * math.pi * SWING / levitated(Q, 60, method=method).step
            for Q in (5, 10, 100, 1e4, 1e6)
        ]
        assert min(steps) > least
        assert max(steps) < 1.1 * min(steps)
    # where drag wins, a fifth of the relaxation time
    assert levitated(0.3, 60).step == pytest.approx(0.2 * SWING / 0.3, rel=0.05)


@pytest.mark.parametrize(
    ("quality", "depth", "method"),
    [(3.0, 20, "heun"), (3.0, 20, "kick"), (10.0, 20, "kick"), (100.0, 60, "kick")],
)
def test_thermal_energy_at_low_damping(quality, depth, method):
    """<v^2> is kT/m and <x^2> that of Boltzmann in the well, over six relaxation times."""
    relaxation = quality * SWING
    one = levitated(quality, depth, method=method, duration=9 * relaxation, samples=91)
    found = followed(one, 1500)[:, 30:]

    def weight(r):
        return r * r * math.exp(depth * math.expm1(-r * r / (2 * depth)))

    variance = quad(lambda r: r * r * weight(r), 0, 12)[0] / quad(weight, 0, 12)[0] / 3
    for columns, expected in (
        (slice(0, 3), variance * KT / STIFFNESS), (slice(3, 6), KT / BEAD.mass),
    ):  # fmt: skip
        of_each = (found[..., columns] ** 2).mean(axis=(1, 2)) / expected
        assert abs(of_each.mean() - 1) < FAR * of_each.std() / math.sqrt(len(of_each))


def test_energy_loss_of_the_steps_is_reported():
    """At Q = 1e4, with half as many steps per period, 250 beads agree with the reported loss."""
    usual = levitated(1e4, 20, method="heun")
    assert -0.04 < usual.variance_bias < -0.008
    longer = levitated(
        1e4, 20, method="heun", step=2 * usual.step, duration=2e4 * SWING, samples=101
    )
    assert 4 < longer.variance_bias / usual.variance_bias < 9
    with pytest.warns(tweezer.PhysicsWarning, match="variance of the position is about"):
        longer.warn_of_bias()
    beads = np.arange(250)
    states = longer.start(beads)
    rng = np.random.default_rng(4)
    states[:, :3] = rng.normal(size=(250, 3)) * math.sqrt(1.16 * KT / STIFFNESS)
    states[:, 3:6] = rng.normal(size=(250, 3)) * math.sqrt(KT / BEAD.mass)
    out = np.empty((250, 100, 6))
    longer.advance(states, beads, 0, out)
    of_each = (out[:, 50:, 3:] ** 2).mean(axis=(1, 2)) * BEAD.mass / KT
    error = of_each.std() / math.sqrt(len(of_each))
    assert abs(of_each.mean() - 1 - longer.variance_bias) < 4 * error
    assert levitated(50, 20, method="heun").variance_bias is None


@cached_njit()
def _whirl(pose, data, wrench):
    stiffness, around = number(data, 0), number(data, 1)
    for at in range(len(pose.position)):
        x, y, z = pose.position[at]
        wrench.force[at, 0] += -stiffness * x - around * y
        wrench.force[at, 1] += -stiffness * y + around * x
        wrench.force[at, 2] -= stiffness * z
        if len(wrench.force_gradient) > at:
            for i in range(3):
                wrench.force_gradient[at, i, i] -= stiffness
            wrench.force_gradient[at, 0, 1] -= around
            wrench.force_gradient[at, 1, 0] += around


@dataclass(frozen=True)
class Whirl(Force):
    """F = -k q + c e_z x q."""

    stiffness: float
    around: float
    search = Search(reach=20e-6, near=20e-6, spacing=2e-8, beside=2e-8)

    def compiled(self, *, gradient):
        return _whirl, packed(self.stiffness, self.around)


def whirled(method, share, **simulation):
    """Return a bead driven round by `share` of the stiffness."""
    scene = DARK.replace(
        simulation={"model": "overdamped", "method": method, "duration": 200 * TRAP, "samples": 201}
        | simulation
    )
    return walk(bound_once(scene, [Whirl(STIFFNESS, share * STIFFNESS)]))


def variances(one):
    """Return the variances of x and y divided by kT/k, with their standard errors."""
    of_each = (followed(one, 600)[:, 20:, :2] ** 2).mean(axis=(1, 2)) * STIFFNESS / KT
    return of_each.mean(), of_each.std() / math.sqrt(len(of_each))


def test_one_call_under_a_force_that_circulates():
    """The variance is kT/k for any circulation, and the error of a given step is reported."""
    given = whirled("one-call", 1.0, step=0.1 * TRAP)
    found, error = variances(given)
    expected = (1 - 0.05) / (1 - 0.1) - 1  # of the scheme, in closed form: 5.6 %
    assert abs(found - 1 - expected) < FAR * error
    assert given.variance_bias == pytest.approx(0.05, rel=0.01)  # to first order in the step
    with pytest.warns(tweezer.PhysicsWarning, match=r"about 5 % too large; simulation\.step"):
        given.warn_of_bias()

    own = whirled("one-call", 1.0)
    assert own.step < 0.0101 * TRAP
    assert "not a gradient" in own.why
    found, error = variances(own)
    assert abs(found - 1) < FAR * error + 0.0051
    assert whirled("one-call", 0.0).variance_bias is None


def test_heun_under_a_force_that_circulates():
    found, error = variances(whirled("heun", 1.0))
    assert abs(found - 1) < FAR * error + 0.008
