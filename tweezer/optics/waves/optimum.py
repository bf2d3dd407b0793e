"""The light over the pupil whose trap is stiffest.

Let y be amplitudes of the light over the pupil, of norm 1 for the power P, and p = A y the
amplitudes of its partial waves about the bead in the focus. With the scattering matrix S = 1 + T
and the direction s, force (in n_m P/c) and stiffness (in k n_m P/c) are Hermitian forms of p:

    F_i = s_i - S+ s_i S = -(s_i T + T+ s_i + T+ s_i T),   K_i = -dF_i/dx_i = -i k [F_i, s_i].

Light that is even, or odd, under half a turn of the pupil exerts no force across the axis. Among
all such light with the axial force f, the largest stiffness K is

    min over mu of the top eigenvalue of A+ (K - mu (F_z - f)) A,

because the values of two Hermitian forms are a convex set. Lower limits on other stiffnesses enter
with multipliers nu >= 0 in the same way. The minimum is a bound on all light of this power.

The singular vectors of A with singular values near 0 have no effect on the bead. The light is
therefore a sum over the other ones, with the coefficients z.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.linalg import eigh
from scipy.optimize import minimize
from scipy.sparse.linalg import eigsh

from tweezer.optics.waves.focus import Part
from tweezer.optics.waves.harmonics import elements
from tweezer.optics.waves.incident import harmonics_of_both
from tweezer.optics.waves.light import Waves
from tweezer.optics.waves.scattered import sphere
from tweezer.optics.zernike import gauss
from tweezer.values.arrays import Array
from tweezer.values.errors import SceneError

ComplexArray = NDArray[np.complex128]

#: Scattered light that is neglected, as a part of all of it
_SMALL = 1e-12
#: Singular values that are neglected, as a part of the largest: their squares enter the forms
_WEAK = 1e-6
#: Nodes over the polar angle in addition to the highest degree
_MORE_NODES = 20
#: Difference between bound and largest value in a subspace at which the search ends, relative
_CLOSE = 1e-9
#: Largest number of steps of that search, and eigenvectors that each step adds
_STEPS, _ADDED = 60, 3
#: Tolerance of the eigenvectors from which the search starts
_ROUGH = 1e-2
#: Widths of the smoothed top eigenvalue, as parts of the largest stiffness
_WIDTHS = (1e-2, 1e-4, 1e-6, 1e-8)
#: Eigenvectors whose sum is the stiffest light, if several eigenvalues meet
_MIXED = 4
#: Starts of the search for that sum
_STARTS = 4


@dataclass(frozen=True)
class Limits:
    """Conditions on the light."""

    force: float
    """axial force, in n_m P/c"""
    least: Mapping[str, float]
    """smallest stiffness along axes, in k n_m P/c"""


class Forms:
    """Force and stiffness of a sphere in the focus as Hermitian forms of the light over the pupil.

    Attributes
    ----------
    odd : bool
        Whether the orders are odd.
    orders : ndarray, shape (orders,)
        Orders q of the harmonics of the light over the azimuth: even, or odd.
    nodes, power : ndarray, shape (nodes,)
        1 - cos(theta) of nodes behind the lens, and the power of each for T = 1 and 1 W.
    highest : int
        Highest degree of the partial waves that the bead scatters or couples to those.
    stiffness : dict of ndarray, shape (n, n)
        K_x, K_y and K_z of the coefficients z, in k n_m P/c.
    force : ndarray, shape (n, n)
        F_z, in n_m P/c.
    """

    def __init__(self, light: Waves, *, odd: bool) -> None:
        """Compute the forms.

        Parameters
        ----------
        light : Waves
            Light of one beam whose pupil has no factor, with states without mirror images, and the
            sphere.
        odd : bool
            Whether the orders are odd.
        """
        self.light, self.odd = light, odd
        a, b = sphere(light, _SMALL)
        self.highest = len(a) + 1
        self.nodes, self.power = self.rule(self.highest + _MORE_NODES)
        momenta = [abs(part.angular_momentum) for each in light.states for part in each.parts]
        widest = self.highest + max(momenta)
        every = np.arange(-widest, widest + 1)
        self.orders: NDArray[np.int64] = every[every % 2 == int(odd)]
        decomposed = self._decomposed()
        felt = [len(s) > 0 for _, s in decomposed]  # circular light has fewer orders
        self.orders = self.orders[felt]
        self._singular = [each for each, kept in zip(decomposed, felt, strict=True) if kept]
        self._known = self.functions(self.nodes)
        B = self._basis()
        T = self._scattering(a, b)
        s = dict(zip("xyz", self._direction(), strict=True))
        force = {axis: self._force(each, T) for axis, each in s.items()}

        def form(of: Any) -> ComplexArray:
            """Return an operator between the coefficients z."""
            states = sparse.block_diag([of] * len(light.states), format="csr")
            found = (B.conj().T @ (states @ B)).toarray()
            return np.asarray((found + found.conj().T) / 2)

        self.force = form(force["z"])
        self.stiffness = {
            axis: form(-1j * (force[axis] @ s[axis] - s[axis] @ force[axis])) for axis in "xyz"
        }

    def rule(self, count: int) -> tuple[Array, Array]:
        """Return nodes, 1 - cos(theta) behind the lens, and the power of each for T = 1 and 1 W."""
        focus = self.light.focus
        x, share = gauss(count)
        outer = 2 * math.sin(focus.half_angle / 2) ** 2
        below = outer * (1 + x) / 2
        return below, outer * share / 2 * self._power(below)

    def _power(self, below: Array) -> Array:
        """Return the power in front of a face for each 1 - cos(theta) behind it, for 1 W."""
        focus = self.light.focus
        before = below if focus.face is None else focus._in_front(below)
        found = 2 * math.pi * focus.cone.shape(before)
        if focus.face is not None:  # Snell: sin(theta) n is the same on both sides
            found *= (focus.face.behind / focus.face.before) ** 2 * (1 - below) / (1 - before)
        return np.asarray(found)

    def _rows(self, q: int) -> list[tuple[int, Part, int]]:
        """Return state, part and order m of the partial waves of light of the order q."""
        parts = (
            (at, part, part.angular_momentum + q)
            for at, state in enumerate(self.light.states) for part in state.parts
        )  # fmt: skip
        return [each for each in parts if abs(each[2]) <= self.highest]

    def _waves(self, q: int, below: Array, table: Array) -> ComplexArray:
        """Return p_nm of plane waves of the order q per T and d(cos theta), (rows, n, nodes).

        `_rows` lists the rows, and n is from 0. `table` are harmonics at the nodes.
        """
        along, across = self.light.focus.amplitudes(below)
        found = np.zeros((len(rows := self._rows(q)), self.highest + 1, len(below)), np.complex128)
        for at, (state, part, m) in enumerate(rows):
            g = part.coefficient * part.amplitude(along, across)
            g *= 2 * math.pi * math.sqrt(self.light.states[state].weight)
            found[at] += g * table[(1 - part.helicity) // 2, m + self.highest].T
        return found

    def _decomposed(self) -> list[tuple[ComplexArray, Array]]:
        """Return the singular vectors U and values s of A that count, for each order."""
        measure = self.power / self._power(self.nodes)  # of the integral over cos(theta)
        table, found = harmonics_of_both(self.highest, self.nodes), []
        for q in self.orders:
            A = self._waves(int(q), self.nodes, table) * (measure / np.sqrt(self.power))
            found.append(np.linalg.svd(A.reshape(-1, len(self.nodes)), full_matrices=False)[:2])
        least = _WEAK * max(s.max(initial=0.0) for _, s in found)
        return [(U[:, s > least], s[s > least]) for U, s in found]

    def _basis(self) -> Any:
        """Return B, with p = B z."""
        stride, size = self.highest + 1, 2 * self.highest + 1
        columns = []
        for q, (U, s) in zip(self.orders, self._singular, strict=True):
            block = np.zeros((2 * len(self.light.states), size, stride, len(s)), np.complex128)
            rows = self._rows(int(q))
            waves = (U * s).reshape(len(rows), stride, len(s))
            for wave, (state, part, m) in zip(waves, rows, strict=True):
                block[2 * state + (1 - part.helicity) // 2, m + self.highest] += wave
            columns.append(sparse.csr_matrix(block.reshape(-1, len(s))))
        return sparse.hstack(columns, format="csr")

    def _scattering(self, a: ComplexArray, b: ComplexArray) -> Any:
        """Return T, which mixes both helicities of a wave; see `scattered.scatter`."""
        own, other = (
            sparse.diags(np.tile(np.pad(-each, (0, 2)), 2 * self.highest + 1))
            for each in (a + b, a - b)
        )
        return sparse.bmat([[own, other], [other, own]], format="csr")

    def _direction(self) -> tuple[Any, Any, Any]:
        """Return s_x, s_y and s_z between all waves; see `scattered.directed`."""
        e, stride = elements(self.highest), self.highest + 1
        up = sparse.diags(e.along.ravel()[1:], -1)
        shifts = {stride: e.turned, stride + 1: e.raised.copy(), stride - 1: e.lowered}
        shifts[stride + 1][:, -1] = 0.0  # the highest degree lacks its upper neighbour
        size = e.along.size
        turned, raised, lowered = (
            sparse.diags(each.ravel()[: size - by], -by, shape=(size, size))
            for by, each in shifts.items()
        )
        of_z = (up + up.T + sign * sparse.diags(e.within.ravel()) for sign in (1, -1))
        of_plus = (raised + lowered + sign * turned for sign in (1, -1))
        along, plus = (sparse.block_diag(list(each), format="csr") for each in (of_z, of_plus))
        return (plus + plus.T) / 2, (plus - plus.T) / 2j, along

    def _force(self, s: Any, T: Any) -> Any:
        """Return F_i."""
        moved = s @ T
        return -(moved + moved.conj().T + T.conj().T @ moved)

    def functions(self, below: Array) -> list[ComplexArray]:
        """Return the functions of T with coefficients z at 1 - cos(theta) = `below`.

        Those of each order are (functions, n), smooth between the nodes, and orthonormal over the
        power: A+ U/s.
        """
        table, power = harmonics_of_both(self.highest, below), self._power(below)
        return [
            (U / s).T @ self._waves(int(q), below, table).reshape(-1, len(below)).conj() / power
            for q, (U, s) in zip(self.orders, self._singular, strict=True)
        ]

    def coefficients(self, harmonics: ComplexArray) -> ComplexArray:
        """Return z of light with harmonics t_q (orders, nodes) of T at the nodes."""
        return projected_on(self._known, self.power, harmonics)

    def means(self, z: ComplexArray) -> dict[str, float]:
        """Return the axial force "f", n_m P/c, and stiffnesses "x", "y", "z", k n_m P/c."""
        forms = {"f": self.force, **self.stiffness}
        return {name: float(np.vdot(z, form @ z).real) for name, form in forms.items()}


def projected_on(
    functions: Sequence[ComplexArray], power: Array, harmonics: ComplexArray
) -> ComplexArray:
    """Return z of light with harmonics t_q (orders, nodes) of T.

    `functions` are values of `Forms.functions` at the nodes, and `power` (nodes,) is their power.
    """
    weighted = harmonics * power
    return np.concatenate([
        known.conj() @ each for known, each in zip(functions, weighted, strict=True)
    ])  # fmt: skip


def combined(functions: Sequence[ComplexArray], z: ComplexArray) -> ComplexArray:
    """Return harmonics t_q of T, (orders, nodes), with coefficients z of `Forms.functions`."""
    of_orders = np.split(z, np.cumsum([len(each) for each in functions])[:-1])
    return np.stack([each @ known for each, known in zip(of_orders, functions, strict=True)])


def stiffest(
    forms: Forms, weights: Mapping[str, float], limits: Limits
) -> tuple[ComplexArray, float]:
    """Return the coefficients z of the light with the largest sum of weighted stiffnesses.

    The second result is the bound on this sum for all light of the same power, in k n_m P/c.

    The dual problem is solved in a subspace, which grows by top eigenvectors of the whole until
    its minimum is the bound on all light.

    Parameters
    ----------
    forms : Forms
        Force and stiffness as forms.
    weights : mapping of str to float
        Weights of the stiffnesses along axes.
    limits : Limits
        Axial force, and smallest stiffnesses.

    Raises
    ------
    SceneError
        If no light meets the limits.
    """
    goal = np.asarray(sum(share * forms.stiffness[axis] for axis, share in weights.items()))
    active: dict[str, float] = {}
    while True:
        z, bound = _stiffest(forms, goal, limits.force, active)
        means = forms.means(z)
        missed = {
            axis: least for axis, least in limits.least.items()
            if axis not in active and means[axis] < least
        }  # fmt: skip
        if not missed:
            return z, bound
        active |= missed


def _stiffest(
    forms: Forms, goal: ComplexArray, force: float, least: Mapping[str, float]
) -> tuple[ComplexArray, float]:
    """Return light and bound as `stiffest` does, with all lower limits as conditions."""
    identity = np.eye(len(goal))
    ties = [forms.force - force * identity]
    ties += [forms.stiffness[axis] - level * identity for axis, level in least.items()]
    # each condition is in the unit of the goal
    size, *others = (float(np.linalg.norm(each)) for each in (goal, *ties))
    ties = [each * (size / other) for each, other in zip(ties, others, strict=True)]
    space = np.zeros((len(goal), 0), np.complex128)
    for each in (goal, *ties, *(-each for each in ties)):
        _, some = eigsh(each, _ADDED, which="LA", tol=_ROUGH, v0=np.ones(len(goal)) + 0j)
        space = _wider(space, some)
    for _ in range(_STEPS):
        small = [_within(space, each) for each in (goal, *ties)]
        multipliers = _dual(small[0], small[1:])
        bound, vectors = _top(_sum(goal, ties, multipliers))
        values, found = eigh(_sum(small[0], small[1:], multipliers))
        if bound - values[-1] < _CLOSE * abs(bound):
            break
        space = _wider(space, vectors)
    few = space @ found[:, -_MIXED:]
    return few @ _mixed([_within(few, each) for each in (goal, *ties)]), bound


def _within(space: ComplexArray, form: ComplexArray) -> ComplexArray:
    """Return a form in a subspace (n, few)."""
    return np.asarray(space.conj().T @ form @ space)


def _sum(goal: ComplexArray, ties: Sequence[ComplexArray], multipliers: Array) -> ComplexArray:
    """Return the goal plus conditions times their multipliers."""
    return goal + sum(y * tie for y, tie in zip(multipliers, ties, strict=True))


def _top(form: ComplexArray) -> tuple[float, ComplexArray]:
    """Return the top eigenvalue of a form, and some eigenvectors."""
    last = len(form) - 1
    values, vectors = eigh(form, subset_by_index=[max(0, last + 1 - _ADDED), last])
    return float(values[-1]), vectors


def _wider(space: ComplexArray, vectors: ComplexArray) -> ComplexArray:
    """Return an orthonormal basis of a subspace and more vectors."""
    U, s, _ = np.linalg.svd(np.hstack([space, vectors]), full_matrices=False)
    return U[:, s > 1e-9]


def _dual(goal: ComplexArray, ties: Sequence[ComplexArray]) -> Array:
    """Return the multipliers that minimise the top eigenvalue: the first of any sign, others >= 0.

    The eigenvalue is smoothed, tau ln sum exp(lambda/tau), with a falling width tau.
    """
    size, found = float(np.abs(np.linalg.eigvalsh(goal)).max()), np.zeros(len(ties))
    bounds = [(None, None), *[(0.0, None)] * (len(ties) - 1)]
    for width in _WIDTHS:

        def smoothed(y: Array, tau: float = width * size) -> tuple[float, Array]:
            """Return the smoothed eigenvalue and its derivatives, in units of `size`."""
            values, vectors = np.linalg.eigh(_sum(goal, ties, y))
            shares = np.exp((values - values[-1]) / tau)
            top = values[-1] + tau * math.log(shares.sum())
            shares /= shares.sum()
            slopes = [
                np.einsum("ij,ij,j->", vectors.conj(), tie @ vectors, shares).real for tie in ties
            ]
            return top / size, np.array(slopes) / size

        options = {"maxiter": 200, "ftol": 1e-15, "gtol": 1e-10}
        found = minimize(
            smoothed, found, jac=True, method="L-BFGS-B", bounds=bounds, options=options
        ).x  # fmt: skip
    return np.asarray(found)


def _mixed(forms: Sequence[ComplexArray]) -> ComplexArray:
    """Return the vector of norm 1 with the largest goal that meets the conditions.

    `forms` are the goal, the one that must vanish, and those that must not be negative. Raises
    `SceneError` if none does.
    """
    count = len(forms[0])
    real = [
        np.block([[form.real, -form.imag], [form.imag, form.real]]) for form in forms
    ]  # fmt: skip
    size = float(np.abs(real[0]).max())
    real = [each / size for each in real]

    def condition(kind: str, form: Array, level: float = 0.0) -> dict[str, Any]:
        """Return a condition on the value of a form."""
        return {"type": kind, "fun": lambda x: x @ form @ x - level, "jac": lambda x: 2 * form @ x}

    conditions = [condition("eq", np.eye(2 * count), 1.0), condition("eq", real[1])]
    conditions += [condition("ineq", each) for each in real[2:]]
    rng, best = np.random.default_rng(1), None
    for start in range(_STARTS):
        x = np.zeros(2 * count)
        x[count - 1] = 1.0
        x += 0.3 * start * rng.standard_normal(2 * count)
        found = minimize(
            lambda x: -(x @ real[0] @ x), x / np.linalg.norm(x), jac=lambda x: -2 * real[0] @ x,
            method="SLSQP", constraints=conditions, options={"ftol": 1e-13, "maxiter": 200},
        )  # fmt: skip
        broken = max(abs(found.x @ real[1] @ found.x), *(
            -(found.x @ each @ found.x) for each in real[2:]
        ), 0.0)  # fmt: skip
        if broken < 1e-9 and (best is None or found.fun < best.fun):
            best = found
    if best is None:
        raise SceneError("optimise: no light meets the limits")
    z = best.x[:count] + 1j * best.x[count:]
    return z / np.linalg.norm(z)
