r"""Force of a polymer that is stretched between two points.

The laws are emitted (`derivation/chains.py`) with the extension l over the contour length Lc, the
force f = F Lp/kT and the compliance s = kT/(Lp S). Here Lp is the persistence length and S the
stretch modulus. A chain is a curve in the plane of l and f, along which both rise with a parameter:
l - s f for worm-like chains, the root of f for stiff chains, 2 f for freely jointed segments. The
curve is explicit in its parameter. Newton's method within a bracket finds the parameter at a given
extension or force.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tweezer.compiled import cached_njit
from tweezer.generated import chains
from tweezer.scene.arguments import in_si, numbers_in_si
from tweezer.scene.choices import CHAINS, ChainLaw, at
from tweezer.values.arrays import Array
from tweezer.values.constants import Boltzmann
from tweezer.values.errors import SceneError
from tweezer.values.units import TEMPERATURE, QuantitiesLike, QuantityLike

#: Force F Lp/kT below which the laws of stiff chains are refused. There, their force is 1.0 % below
#: that of the exact worm-like chain
LOWEST = 5.0
#: Largest part of the stretch modulus that the coupling of twist and stretch may remove
SOFTEST = 0.5
#: Largest force of a table, N: a covalent bond breaks at about this force
STRONGEST = 1e-9
#: Largest relative error of the force in a table, where it is measured
TABLE_ERROR = 9e-7
#: Largest extension of a chain that does not stretch, over its contour length: beyond it, the
#: rounding of the extension changes the force by more than 1e-10
TAUT = 1 - 2.0**-20
#: Argument below which Langevin's function is summed as a series
_SMALL = 0.5
#: Relative error of a parameter, and the largest number of steps to find it
_ROUNDING, _STEPS = 4 * np.finfo(float).eps, 500
#: Positions in a piece of a table, over its length, at which its error is measured
_WITHIN = np.array([0.15, 0.3, 0.5, 0.7, 0.85])
#: Number of forces at which the extension of a twistable chain must rise
_PLACES = 1000
#: Units and ranges of the parameters of laws
PARAMETERS = {
    "contour_length": ("m", 1e-12, 1.0),
    "persistence_length": ("m", 1e-12, 1.0),
    "temperature": ("K", *TEMPERATURE),
    "stretch_modulus": ("N", 1e-15, 1.0),
    "twist_rigidity": ("N m^2", 1e-32, 1e-20),
    "twist_coupling": ("N m", -1e-12, 1e-12),
    "twist_coupling_slope": ("m", 1e-15, 1.0),
    "critical_force": ("N", 1e-15, 1e-6),
}

Ends = tuple[float, float]


class Point(NamedTuple):
    """Points on the curve of a chain, with derivatives over its parameter, each of shape (n,)."""

    extension: Array
    """l = x/Lc"""
    extension_slope: Array
    """dl/dp"""
    force: Array
    """f = F Lp/kT"""
    force_slope: Array
    """df/dp"""


class Branch(NamedTuple):
    """Part of the curve of a chain that has no kink. The upper ends do not belong to it."""

    parameters: Ends
    """parameters p at its ends"""
    extensions: Ends
    """extensions l at its ends"""
    forces: Ends
    """forces f at its ends"""
    curve: Callable[[Array], Point]
    """the points at parameters, shape (n,)"""
    at: Callable[[Array], Array] | None = None
    """the parameters at forces f, shape (n,); None if they are implicit"""

    def at_extension(self, extension: Array) -> Point:
        """Return the points at extensions l within the branch, shape (n,)."""
        return self.curve(
            self._parameters(extension, lambda at: (at.extension, at.extension_slope))
        )

    def at_force(self, force: Array) -> Point:
        """Return the points at forces f within the branch, shape (n,)."""
        if self.at is not None:
            return self.curve(self.at(force))
        return self.curve(self._parameters(force, lambda at: (at.force, at.force_slope)))

    def _parameters(
        self, wanted: Array, coordinate: Callable[[Point], tuple[Array, Array]]
    ) -> Array:
        """Return the parameters at which a coordinate of the curve, which rises, has given values.

        A step of Newton that leaves the bracket, or does not halve the step before the last one, is
        replaced by the middle of the bracket.
        """
        first, last = self.parameters
        if last == math.inf:
            last = 2 * max(first, 1.0)
            while np.any(coordinate(self.curve(np.array([last])))[0] < wanted):
                last *= 2
        low, high = np.full_like(wanted, first), np.full_like(wanted, last)
        here, step, before = low, high - low, high - low
        for _ in range(_STEPS):
            value, slope = coordinate(self.curve(here))
            low, high = np.where(value < wanted, here, low), np.where(value < wanted, high, here)
            newton = (wanted - value) / slope
            good = (np.abs(newton) < np.abs(before) / 2) & (low < here + newton) & (
                here + newton < high
            )  # fmt: skip
            found = (np.abs(newton) <= _ROUNDING * here) | (high - low <= _ROUNDING * here)
            before, step = (
                step,
                np.where(found, 0.0, np.where(good, newton, (low + high) / 2 - here)),
            )
            here = here + step
            if found.all():
                return here
        raise ArithmeticError("a parameter of a chain was not found")  # pragma: no cover


@dataclass(frozen=True)
class Chain:
    """Polymer at a temperature, which resists its extension."""

    law: ChainLaw
    """law of its force"""
    contour_length: float
    """Lc, m"""
    unit: float
    """kT/Lp, N"""
    branches: tuple[Branch, ...]
    """parts of its curve, in the order of the force"""

    def force(self, extension: Array) -> tuple[Array, Array]:
        """Return the force at extensions x > 0, N, and its derivative, N/m, each of shape (n,).

        Both are NaN outside the range of the law.
        """
        force, slope = self._on_branches(extension / self.contour_length, "extension")
        return self.unit * force, self.unit / self.contour_length * slope

    def extension(self, force: Array) -> tuple[Array, Array]:
        """Return the extension under forces F > 0, m, and its derivative, m/N, each of shape (n,).

        Both are NaN outside the range of the law.
        """
        extension, slope = self._on_branches(force / self.unit, "force")
        return self.contour_length * extension, self.contour_length / self.unit * slope

    def _on_branches(self, wanted: Array, coordinate: str) -> tuple[Array, Array]:
        """Return the other coordinate of the curve, and its derivative over the given one."""
        found, slope = np.full((2, *wanted.shape), np.nan)
        for branch in self.branches:
            given = coordinate == "extension"
            first, last = branch.extensions if given else branch.forces
            within = (first <= wanted) & (wanted < last)
            if within.any():
                there = (branch.at_extension if given else branch.at_force)(wanted[within])
                rise = there.force_slope / there.extension_slope
                found[within] = there.force if given else there.extension
                slope[within] = rise if given else 1 / rise
        return found, slope

    @property
    def extensions(self) -> Ends:
        """Extensions between which the law applies, m."""
        first, last = self.branches[0].extensions[0], self.branches[-1].extensions[1]
        return self.contour_length * first, self.contour_length * last

    @property
    def forces(self) -> Ends:
        """Forces between which the law applies, N."""
        return self.unit * self.branches[0].forces[0], self.unit * self.branches[-1].forces[1]

    def table(self, strongest: float = STRONGEST) -> tuple[Array, float]:
        """Return a table of the force over the extension for `tension`, and its relative error.

        The pieces are cubic polynomials with the force and the slope of the chain at their ends.
        They are halved until the error is below `TABLE_ERROR` and each of them is monotone. The
        table ends at the force `strongest`, N, or at the upper end of the law.
        """
        tables, errors = [], []
        for branch in self.branches:
            if branch.forces[0] < strongest / self.unit:
                pieces, error = _pieces(branch, strongest / self.unit)
                tables.append(pieces)
                errors.append(error)
        table = np.concatenate([*(each[:-1] for each in tables), tables[-1][-1:]])
        table[:, 0] *= self.contour_length
        table[:, 1:] *= self.unit / self.contour_length ** np.arange(4)
        return table, max(errors)


def _pieces(branch: Branch, strongest: float) -> tuple[Array, float]:
    """Return the rows of a table of a branch up to a force, scaled as the branch, and its error.

    The last row contains the upper end.
    """
    first, last = branch.extensions
    if strongest < branch.forces[1]:
        last = branch.at_force(np.array([strongest])).extension[0]
    edges = np.array([first, last])
    while True:
        ends = branch.at_extension(edges)
        force, slope = ends.force, ends.force_slope / ends.extension_slope
        length = np.diff(edges)
        secant = np.diff(force) / length
        bend = (3 * secant - 2 * slope[:-1] - slope[1:]) / length
        twist = (slope[:-1] + slope[1:] - 2 * secant) / length**2
        along = np.multiply.outer(_WITHIN, length)
        exact = branch.at_extension((edges[:-1] + along).ravel()).force.reshape(along.shape)
        cubic = force[:-1] + along * (slope[:-1] + along * (bend + along * twist))
        error = np.abs(cubic / exact - 1).max(axis=0)
        halved = (error > TABLE_ERROR) | (np.maximum(slope[:-1], slope[1:]) > 3 * secant)
        if not halved.any():
            pieces = np.zeros((len(edges), 5))
            pieces[:, 0] = edges
            pieces[:-1, 1:] = np.transpose([force[:-1], slope[:-1], bend, twist])
            return pieces, float(error.max())
        middles = edges[:-1] + length / 2
        edges = np.sort(np.concatenate([edges, middles[halved]]))


@cached_njit(error_model="numpy", nogil=True)
def tension(extension, pieces):  # type: ignore[no-untyped-def]
    """Return the force of a chain (N) and its derivative (N/m) by a table.

    Parameters
    ----------
    extension : float
        Extension, m.
    pieces : array, shape (n + 1, 5)
        Table of `Chain.table`: the beginning of each piece, m, and the coefficients of powers of
        the distance from it. The last row contains the end of the last piece.

    Returns
    -------
    force, slope : float
        0 for a slack chain, with an extension of 0 or less. NaN outside the table, which the
        caller must refuse.
    """
    last = len(pieces) - 1
    if extension <= 0.0:
        return 0.0, 0.0
    if not pieces[0, 0] <= extension <= pieces[last, 0]:
        return math.nan, math.nan
    low, high = 0, last
    while high - low > 1:
        middle = (low + high) // 2
        if pieces[middle, 0] <= extension:
            low = middle
        else:
            high = middle
    along = extension - pieces[low, 0]
    c0, c1, c2, c3 = pieces[low, 1], pieces[low, 2], pieces[low, 3], pieces[low, 4]
    force = c0 + along * (c1 + along * (c2 + along * c3))
    return force, c1 + along * (2.0 * c2 + along * 3.0 * c3)


def _worm_like(
    law: Callable[[Array], tuple[Array, Array]], compliance: float
) -> tuple[Branch, ...]:
    """Return the curve of a worm-like chain whose force is a function of l - s f."""

    def curve(straight: Array) -> Point:
        """Return the points at values of l - s f."""
        force, slope = law(straight)
        return Point(straight + compliance * force, 1 + compliance * slope, force, slope)

    last = math.nextafter(1.0, 0.0)
    longest, _, strongest, _ = (float(each[0]) for each in curve(np.array([last])))
    longest = longest if compliance else TAUT
    return (Branch((0.0, last), (0.0, longest), (0.0, strongest), curve),)


def marko_siggia(compliance: float) -> tuple[Branch, ...]:
    """Return the curve f = 1/(4 (1 - l)^2) - 1/4 + l of a worm-like chain."""
    return _worm_like(chains.marko_siggia, compliance)


def bouchiat(compliance: float) -> tuple[Branch, ...]:
    """Return the curve of Marko and Siggia with the powers of l by Bouchiat."""
    return _worm_like(chains.bouchiat, compliance)


def _stiff(law: Callable[[Array], tuple[Array, Array]], low: float, high: float) -> Branch:
    """Return the curve of a stiff chain between two forces f."""

    def curve(root: Array) -> Point:
        """Return the points at roots of f."""
        extension, slope = law(root)
        return Point(extension, slope, root**2, 2 * root)

    first, last = math.sqrt(low), math.sqrt(high)
    shortest = float(curve(np.array([first])).extension[0])
    longest = float(curve(np.array([last])).extension[0]) if last < math.inf else math.inf
    return Branch((first, last), (shortest, longest), (low, high), curve, np.sqrt)


def odijk(compliance: float) -> tuple[Branch, ...]:
    """Return the curve l = 1 - 1/(2 sqrt f) + s f of a stiff chain."""
    return (_stiff(lambda root: chains.odijk(root, compliance), LOWEST, math.inf),)


def twistable(
    compliance: float, *, coupling: float, rise: float, critical: float
) -> tuple[Branch, ...]:
    """Return the curve of a stiff chain whose stretch and twist are coupled.

    Parameters
    ----------
    compliance : float
        s.
    coupling : float
        c_0, the coupling g_0 over sqrt(S C).
    rise : float
        c_1, its derivative over f.
    critical : float
        Force f below which the coupling is constant.
    """
    constant, softest = coupling + rise * critical, (math.sqrt(SOFTEST) - coupling) / rise
    return (
        _stiff(lambda root: chains.twistable(root, compliance, constant, 0.0), LOWEST, critical),
        _stiff(lambda root: chains.twistable(root, compliance, coupling, rise), critical, softest),
    )


def jointed(compliance: float) -> tuple[Branch, ...]:
    """Return the curve l = (coth u - 1/u) (1 + s f) of freely jointed segments, with u = 2 f."""

    def curve(argument: Array) -> Point:
        """Return the points at arguments u of Langevin's function."""
        series = np.array(chains.langevin_series(np.minimum(argument, _SMALL)))
        large = np.maximum(argument, _SMALL)
        closed = np.array(chains.langevin(large, np.exp(-2 * large)))
        straight, slope = np.where(argument < _SMALL, series, closed)
        force = argument / 2
        longer = 1 + compliance * force
        rise = slope * longer + straight * compliance / 2
        return Point(straight * longer, rise, force, np.full_like(force, 0.5))

    longest = math.inf if compliance else TAUT
    everywhere = (0.0, math.inf)
    return (Branch(everywhere, (0.0, longest), everywhere, curve, lambda force: 2 * force),)


def chain(
    model: str,
    *,
    contour_length: QuantityLike,
    persistence_length: QuantityLike,
    temperature: QuantityLike,
    **parameters: QuantityLike | None,
) -> Chain:
    """Return a chain with a law and its parameters.

    Parameters
    ----------
    model : str
        Law of the force.
    contour_length, persistence_length, temperature : float or str
        Parameters of every law, in m, m and K.
    **parameters : float or str
        Further parameters of the law, by the names of `chain_force`. None is ignored.

    Raises
    ------
    SceneError
        For an unknown model, and for parameters that are missing, superfluous or invalid.
    """
    if model not in CHAINS:
        raise SceneError(f"model = {model!r}: is unknown; choose from {', '.join(CHAINS)}")
    law = CHAINS[model]
    given = {name: value for name, value in parameters.items() if value is not None}
    for name in law.needs:
        if name not in given:
            raise SceneError(f"{name}: is required by model = {model!r}")
    for name, value in given.items():
        if name not in (*law.needs, *law.may):
            others = [each.name for each in CHAINS.values() if name in (*each.needs, *each.may)]
            raise SceneError(
                f"{name} = {value!r}: is not a parameter of model = {model!r}; omit it or "
                f"choose a model from {', '.join(others)}"
            )
    given |= {
        "contour_length": contour_length,
        "persistence_length": persistence_length,
        "temperature": temperature,
    }
    si = {name: in_si(name, value, *PARAMETERS[name]) for name, value in given.items()}
    unit = Boltzmann * si["temperature"] / si["persistence_length"]
    compliance = unit / si.get("stretch_modulus", math.inf)
    coupling = _coupling(si, unit) if "twist_coupling" in law.needs else {}
    return Chain(law, si["contour_length"], unit, at(law.branches)(compliance, **coupling))


def _coupling(si: dict[str, float], unit: float) -> dict[str, float]:
    """Return the coupling of twist and stretch for `twistable`, or refuse it."""
    root = math.sqrt(si["stretch_modulus"] * si["twist_rigidity"])
    coupling, rise = si["twist_coupling"] / root, si["twist_coupling_slope"] * unit / root
    critical = si["critical_force"] / unit
    if critical <= LOWEST:
        raise SceneError(
            f"critical_force = {si['critical_force']:g} N: the chain is not stiff at this force; "
            f"must exceed {LOWEST * unit:.3g} N"
        )
    lowest, highest = (end * math.sqrt(SOFTEST) - rise * critical for end in (-1, 1))
    if not lowest < coupling < highest:
        raise SceneError(
            f"twist_coupling = {si['twist_coupling']:g} N m: removes more than half of the stretch "
            f"modulus at the critical force; must be between {root * lowest:.3g} and "
            f"{root * highest:.3g} N m"
        )
    softest = (math.sqrt(SOFTEST) - coupling) / rise
    roots = np.linspace(math.sqrt(critical), math.sqrt(softest), _PLACES)
    if (chains.twistable(roots, unit / si["stretch_modulus"], coupling, rise)[1] <= 0).any():
        raise SceneError(
            f"twist_coupling_slope = {si['twist_coupling_slope']:g} m: the extension would fall "
            "with the force; use a smaller slope"
        )
    return {"coupling": coupling, "rise": rise, "critical": critical}


def chain_force(
    model: str,
    extension: QuantitiesLike,
    *,
    contour_length: QuantityLike,
    persistence_length: QuantityLike,
    temperature: QuantityLike,
    stretch_modulus: QuantityLike | None = None,
    twist_rigidity: QuantityLike | None = None,
    twist_coupling: QuantityLike | None = None,
    twist_coupling_slope: QuantityLike | None = None,
    critical_force: QuantityLike | None = None,
) -> NDArray[np.float64]:
    r"""Return the force that stretches a polymer to an extension.

    With l = x/Lc, f = F Lp/kT and s = kT/(Lp S), the laws are:

    * "marko-siggia": f = 1/(4 (1 - l)^2) - 1/4 + l, up to 17 % above the exact worm-like chain.
      With a stretch modulus, l - s f replaces l.
    * "bouchiat": the same with powers of l from 2 to 7, within 0.04 % of the exact chain above
      l = 0.3, and within 0.4 % below.
    * "odijk": l = 1 - 1/(2 sqrt f) + s f, above f = 5, where it is 1 % below the exact chain.
    * "fjc": l = coth u - 1/u with u = 2 f: segments of the Kuhn length 2 Lp.
    * "efjc": l = (coth u - 1/u) (1 + s f).
    * "twlc": l = 1 - 1/(2 sqrt f) + C F/(S C - g^2), g = g_0 + g_1 max(F, F_c), above f = 5 and
      up to the force at which g^2 = S C/2.

    Parameters
    ----------
    model : str
        Law of the force.
    extension : array_like, shape (...)
        Distance x between the ends of the polymer, m.
    contour_length : float or str
        Lc, m.
    persistence_length : float or str
        Lp, m.
    temperature : float or str
        Temperature, K.
    stretch_modulus : float or str, optional
        S, N. Required by "odijk", "efjc" and "twlc", and optional for worm-like chains.
    twist_rigidity : float or str, optional
        C of "twlc", N m^2.
    twist_coupling : float or str, optional
        g_0 of "twlc", N m.
    twist_coupling_slope : float or str, optional
        g_1 of "twlc", m.
    critical_force : float or str, optional
        F_c of "twlc", N, below which the coupling is constant.

    Returns
    -------
    ndarray, shape (...)
        Force, N. It is 0 for a slack polymer, with an extension of 0 or less. The laws are solved
        to the rounding of their parameters, within a relative 1e-9.

    Raises
    ------
    SceneError
        For extensions outside the range of the law, and for parameters that are missing, invalid or
        not used by the law.

    References
    ----------
    J. F. Marko and E. D. Siggia (1995); C. Bouchiat et al. (1999); T. Odijk (1995); S. B. Smith,
    Y. Cui and C. Bustamante (1996); P. Gross et al. (2011).

    Examples
    --------
    >>> dna = {"contour_length": "1000 nm", "persistence_length": "50 nm", "temperature": 298}
    >>> force = tweezer.chain_force("marko-siggia", ["500 nm", "900 nm"], **dna)
    >>> (force * 1e12).round(3).tolist()  # pN
    [0.103, 2.111]
    """
    polymer = chain(
        model, contour_length=contour_length, persistence_length=persistence_length,
        temperature=temperature, stretch_modulus=stretch_modulus, twist_rigidity=twist_rigidity,
        twist_coupling=twist_coupling, twist_coupling_slope=twist_coupling_slope,
        critical_force=critical_force,
    )  # fmt: skip
    lengths = numbers_in_si("extension", extension, "m", SceneError)
    if not np.isfinite(lengths).all():
        raise SceneError("extension: contains values that are not finite; remove them")
    force = np.zeros(lengths.shape)
    taut = lengths > 0
    force[taut] = polymer.force(lengths[taut])[0]
    if np.isnan(force).any():
        raise SceneError(_outside(polymer, float(lengths[np.isnan(force)][0])))
    return force


def _outside(polymer: Chain, extension: float) -> str:
    """Return the message on an extension outside the range of the law of a polymer."""
    first, last = polymer.extensions
    law = f"model = {polymer.law.name!r}"
    if extension < first:
        return (
            f"extension = {extension:g} m: {law} does not apply to forces below "
            f"{polymer.forces[0]:.3g} N; must be at least {first:.6g} m; use 'bouchiat' with the "
            "stretch modulus for smaller extensions"
        )
    if polymer.law.name == "twlc":
        return (
            f"extension = {extension:g} m: {law} does not apply to forces above "
            f"{polymer.forces[1]:.3g} N, at which twist removes half of the stretch modulus; must "
            f"be below {last:.6g} m"
        )
    remedy = "give stretch_modulus" if polymer.law.may else "use 'efjc' with stretch_modulus"
    return (
        f"extension = {extension:g} m: reaches the contour length, but the polymer does not "
        f"stretch; must be below {last:.6g} m; {remedy} for larger extensions"
    )
