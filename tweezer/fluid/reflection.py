"""Drag of a sphere at a fixed height above a wall, without and with fluid inertia.

Without inertia the mobilities parallel and perpendicular to the wall are exact
(`tweezer.generated.wall`).

With inertia the wall reflects the flow that the sphere generates. The reflected flow carries the
sphere along, with the velocity G(s) per unit force (`derivation.hydrodynamics`; for a point
particle B. U. Felderhof, J. Phys. Chem. B 109, 21406 (2005)), so that

    gamma(s) = gamma_0(s)/(1 + c beta^2 G(s)/gamma_0(s)),

where gamma_0 and beta apply far from the wall. This formula includes one reflection. Without the
factor c, its steady drag would follow Faxen's mobilities; c, at most 1.08, makes it exact. For
large s the formula contains the added mass of ideal flow. A physical drag is equivalent to dashpots
and fictitious masses, beta (1/mobility + sum c_k s tau_f/(s tau_f + p_k) + m s tau_f) with no
negative c_k. The closest drag of this form is used, with the poles p_k of a sphere in an unbounded
fluid.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from tweezer.fluid.memory import NODES
from tweezer.generated import wall
from tweezer.values.arrays import Array, Complex

#: The emitted mobilities as plain Python: a single height does not repay the time of compilation
_mobilities = wall.mobilities.py_func
#: Lowest height of a centre at which one reflection is enough, along and across the wall, in radii
LOWEST = {"along": 1.5, "across": 2.0}
#: Frequencies of the fit, over nu/(pi r^2): from negligible inertia to a negligible wall
_FREQUENCIES = np.geomspace(1e-5, 3e2, 300)
#: Panels of the integral over wave numbers, in 1/h, and Gauss's points in each
_PANELS, _POINTS = np.append(0.0, np.geomspace(1e-2, 60.0, 14)), 40
#: Largest number of steps of the fit
_MOST_STEPS = 10_000
#: alpha r that counts as 0
_STILL = 1e-6
#: alpha r below which a difference of the weights is a series
_SMALL = 0.05


class Memory(NamedTuple):
    """Frequency-dependent drag divided by the steady drag, as a sum over poles.

    It is 1 + sum_k weights_k s/(s + rates_k) + mass s, with s in units of 1/tau_f.
    """

    rates: Array
    """(n,) poles of the memory, positive, in 1/tau_f"""
    weights: Array
    """(n,) weights of the poles"""
    mass: float
    """coefficient of the added mass"""
    mobility: float
    """steady mobility, relative to an unbounded fluid; tau_f is defined with the drag in an
    unbounded fluid"""

    @property
    def added(self) -> float:
        """Added mass, relative to the mass of the displaced fluid: 1/2 in an unbounded fluid."""
        return 4.5 * self.mass / self.mobility

    def drag_at(self, frequencies: Array, drag: float, displaced_mass: float) -> Complex:
        """Return the drag gamma(2 pi i f), kg/s, with the added mass, at frequencies f (n,), Hz.

        `drag` is the steady drag at the bead's position, kg/s, and `displaced_mass` the mass of the
        displaced fluid, kg.
        """
        time = 4.5 * displaced_mass / (drag * self.mobility)
        s = 2j * np.pi * time * np.asarray(frequencies, np.float64)[..., None]
        remembered = (self.weights * s / (s + self.rates)).sum(axis=-1)
        return np.asarray(drag * (1 + remembered + self.mass * s[..., 0]))


@lru_cache(maxsize=8)
def memory_far(poles: int) -> Memory:
    """Return the drag of a sphere in an unbounded fluid, with a number of poles."""
    rates, weights = (np.array(each) for each in NODES[poles])
    return Memory(rates, weights, 1 / 9, 1.0)


def steady(gap: float) -> tuple[float, float, float, float]:
    """Return the relative mobilities parallel and perpendicular to a wall, and their derivatives.

    The mobilities are relative to those far from the wall. The derivatives with respect to `gap`,
    the distance between the surfaces in radii, are in the same order.
    """
    across, along, *_, d_across, d_along, _, _, _ = _mobilities(gap)
    return along, across, d_along, d_across


def reflected(x: Complex, height: float, *, across: bool) -> Complex:
    """Return beta G(s): velocity of a sphere in the flow that a wall reflects, (n,).

    It is relative to the velocity due to the same force in steady flow in an unbounded fluid. `x`
    (n,) is alpha r = sqrt(s tau_f), not 0, and `height` the sphere's centre above the wall, in
    radii. `across` selects motion across the wall instead of along it. The integral over waves e^(i
    q X) comes from `derivation.hydrodynamics`, with differences written so that nothing cancels for
    small x.
    """
    x = np.asarray(x, np.complex128)[:, None]
    points, weights = np.polynomial.legendre.leggauss(_POINTS)
    half = np.diff(_PANELS)[:, None] / 2
    q = ((_PANELS[:-1, None] + half) + half * points).ravel() / height
    weights = (half * weights).ravel() / height
    decay = np.sqrt(q**2 + x**2)
    faster = x**2 / (q + decay)
    # weights of the dipole and of the vortical part, and their difference over x^2
    A = (1 + x + x**2 / 3) * np.exp(-q * height)
    B = np.exp(x - decay * height)
    series = -(1 / 6 + x / 6 + x**2 / 24 + x**3 / 120 + x**4 / 720 + x**5 / 5040)
    with np.errstate(over="ignore", invalid="ignore"):
        unequal = np.where(np.abs(x) < _SMALL, series, (1 + x + x**2 / 3 - np.exp(x)) / x**2)
        slow = np.exp(-q * height) * (unequal - np.exp(x) * np.expm1(-faster * height) / x**2)
    D = np.where(np.abs(x) < 1, slow, (A - B) / x**2)
    square = q * decay * D**2
    if across:
        wave = 2 * q / decay * (q + decay) * ((q * D + A / (q + decay)) ** 2 + square)
    else:
        wave = (q + decay) * ((q * D - B / (q + decay)) ** 2 + square) + B**2 / decay
    # 6 pi mu r times int q dq/(4 pi) wave/(2 mu)
    back: Complex = -0.75 * (weights * q * wave).sum(axis=1)
    return back


@lru_cache(maxsize=64)
def memory_beside(height: float, *, across: bool, poles: int) -> Memory:
    """Return the drag of a sphere that moves along or across a wall in a fluid with inertia.

    `height` is the height of the sphere's centre in radii, at least `LOWEST`. `poles` is a number
    that `NODES` contains. With 24 poles the fitted sum is within 0.8 % of the reflected flow at 1.5
    radii along the wall, 1.4 % at 2 radii across it, and 0.2 % at 3 radii or more.
    """
    from scipy.optimize import nnls

    x = np.sqrt(2j * _FREQUENCIES)
    free = 1 + x + x**2 / 9
    mobility = steady(height - 1)[int(across)]
    still, *_ = reflected(np.array([_STILL]), height, across=across).real
    drag = free / (1 - (1 - mobility) * reflected(x, height, across=across) / still / free)
    rates = np.array(NODES[poles][0])
    columns = np.column_stack([x[:, None] ** 2 / (x[:, None] ** 2 + rates), x**2])
    weight = 1 / np.abs(drag)
    matrix = weight[:, None] * columns
    target = weight * (drag - 1 / mobility)
    found, _ = nnls(
        np.concatenate([matrix.real, matrix.imag]),
        np.concatenate([target.real, target.imag]),
        maxiter=_MOST_STEPS,
    )
    kept = found[:-1] > 0
    weights = mobility * found[:-1][kept]
    return Memory(rates[kept], weights, mobility * float(found[-1]), mobility)
