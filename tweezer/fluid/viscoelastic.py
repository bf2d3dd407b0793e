r"""Network of elements of a scene's viscoelastic medium, with the inertia of the fluid.

The complex viscosity is the sum of the solvent's, of Maxwell elements and of a power law,

    mu(s) = mu_m + sum_j eta_j/(1 + s tau_j) + A s^(a - 1),    G*(2 pi i f) = A (2 pi i f)^a.

With p = e^u the power law is an integral with a positive density,

    s^(a - 1) = (sin(pi a)/pi) int e^(a u)/(s + e^u) du.

The trapezoidal rule converges exponentially in its spacing, here a third of a decade. The infinite
sums below and above the band have moments in closed form; Gauss's rule of each has three elements.
All weights are positive, and the error in the band is below 1e-5 for all exponents.

By the correspondence principle the drag of a sphere in such a fluid is

    gamma(s) = 6 pi r [mu + r sqrt(rho s mu) + s r^2 rho/9].

Both s mu(s) and its root are complete Bernstein functions. The root is therefore a sum of terms
c_i s/(s + p_i) with positive c_i. Non-negative least squares finds them for poles p_i in geometric
progression.
"""

from __future__ import annotations

import math

import numpy as np

from tweezer.fluid.memory import NODES
from tweezer.fluid.network import Network
from tweezer.scene import Scene
from tweezer.scene.choices import POLES
from tweezer.scene.sections.medium import Medium, PowerLaw
from tweezer.values.arrays import Array

#: Elements of a power law in a decade
_A_DECADE = 3
#: Elements beyond each end of the band
_BEYOND = 3
#: Range of the poles of the root, in solvent's viscosity over r^2 rho, and frequencies for each
_FROM, _TO, _EACH = 1e-5, 1e5, 6
#: Shifts of the poles that are tried
_SHIFTS = 8
#: Error of the root over that of the drag, at low frequencies
_OF_ROOT = 30.0


def viscosities(medium: Medium) -> tuple[Array, Array]:
    """Return viscosities (n,), Pa s, and relaxation times (n,), s, of a medium's elements."""
    found = [(each.viscosity, each.time) for each in medium.relaxing or ()]
    eta, tau = np.array(found).reshape(-1, 2).T
    if medium.power_law is None:
        return eta, tau
    of_law = elements_of(medium.power_law)
    return np.append(eta, of_law[0]), np.append(tau, of_law[1])


def elements_of(law: PowerLaw) -> tuple[Array, Array]:
    """Return viscosities (n,), Pa s, and relaxation times (n,), s, of a power law's elements."""
    low, high = (2 * math.pi * each for each in law.band)
    many = math.ceil(_A_DECADE * math.log10(high / low) * (1 - 1e-12))
    a, h = law.exponent, math.log(high / low) / many
    size = law.modulus / (2 * math.pi * law.at) ** a * h * math.sin(math.pi * a) / math.pi
    p = low * np.exp(h * np.arange(many + 1))
    below, of_below = _gauss(a, h)
    above, of_above = _gauss(1 - a, h)
    rates = np.concatenate([low * below, p, high / above])
    weights = np.concatenate([
        low**a * of_below, p**a, high ** (a - 1) * of_above * high / above,
    ])  # fmt: skip
    order = np.argsort(-rates)
    return (size * weights / rates)[order], 1 / rates[order]


def _gauss(a: float, h: float) -> tuple[Array, Array]:
    """Return nodes and weights of Gauss's rule for sum_j e^(-a h j) f(e^(-h j)), j = 1, 2, ...

    The moments of the nodes over e^-h are e^(-a h)/(1 - e^(-(a + k) h)).
    """
    moments = math.exp(-a * h) / -np.expm1(-(a + np.arange(2 * _BEYOND)) * h)
    index = np.arange(_BEYOND)
    hankel = moments[index[:, None] + index]
    inverse = np.linalg.inv(np.linalg.cholesky(hankel))
    nodes, vectors = np.linalg.eigh(inverse @ moments[index[:, None] + index + 1] @ inverse.T)
    return nodes * math.exp(-h), (vectors.T @ inverse @ moments[:_BEYOND]) ** 2


def network(scene: Scene, *, mass: float, drag: float, inertia: bool) -> Network:
    """Return the network of a sphere in a scene's medium, without the spring of a gel.

    In a Newtonian fluid its only elements are the masses of the hydrodynamic memory.

    Parameters
    ----------
    scene : Scene
        Scene of the sphere.
    mass : float
        Mass of the bead that a sudden force accelerates, kg; 0 without inertia.
    drag : float
        Drag of the solvent, kg/s.
    inertia : bool
        Whether the fluid's vorticity has inertia; the added mass is part of `mass`.
    """
    medium = scene.medium
    eta, tau = viscosities(medium)
    per_viscosity = drag / medium.viscosity
    maxwell = per_viscosity * eta, tau
    if not inertia:
        return Network(mass, drag, maxwell)
    if not medium.relaxes:
        rate = medium.viscosity / (scene.bead.radius**2 * medium.density)
        p, c = NODES[medium.poles or POLES]
        return Network(mass, drag, maxwell, (drag * c, rate * p))
    poles = max(medium.poles or POLES, POLES)
    for shift in range(_SHIFTS):  # approximate masses and springs may ring where exact ones do not
        root, rates = _root(medium, scene.bead.radius, poles, shift / _SHIFTS)
        found = Network(mass, drag, maxwell, (per_viscosity * root, rates))
        if not found.rings:
            break
    return found


def _root(medium: Medium, radius: float, poles: int, shift: float) -> tuple[Array, Array]:
    """Return c_i, Pa s, and p_i, 1/s, of r sqrt(rho s mu(s)), from so many candidates.

    `shift` moves the candidates by a fraction of their distance.
    """
    from scipy.optimize import nnls

    eta, tau = viscosities(medium)
    rate = medium.viscosity / (radius**2 * medium.density)
    p = rate * np.geomspace(_FROM, _TO, poles) * (_TO / _FROM) ** (shift / (poles - 1))
    s = 1j * rate * np.geomspace(_FROM, _TO / 10, _EACH * poles)
    mu = medium.viscosity + (eta / (1 + np.multiply.outer(s, tau))).sum(axis=1)
    root = radius * np.sqrt(medium.density * s * mu)
    whole = np.abs(mu + root + s / (9 * rate) * medium.viscosity)
    terms = (s[:, None] / (s[:, None] + p)) / np.minimum(whole, _OF_ROOT * np.abs(root))[:, None]
    wanted = root / np.minimum(whole, _OF_ROOT * np.abs(root))
    columns = np.vstack([terms.real, terms.imag])
    size = np.linalg.norm(columns, axis=0)
    found = nnls(columns / size, np.concatenate([wanted.real, wanted.imag]))[0] / size
    return found[found > 0], p[found > 0]
