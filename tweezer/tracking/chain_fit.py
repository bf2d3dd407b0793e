r"""Fit of contour and persistence length to force-extension curves with errors in both coordinates.

In an optical trap of stiffness k, the deflection d of a bead gives the force k d, and the extension
is the distance of the traps without d. An error of d therefore changes both. With the errors

    F_i = F + s_F a,   x_i = x(F) + s_x (c a + sqrt(1 - c^2) b),

where a and b have the variance 1 and c is the correlation, each sample is the shortest distance
away from the curve: the least a^2 + b^2. The sum of squares of these distances is minimised. The
force F on the curve is found by repeated linearisation of x(F).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from tweezer.calibration.findings import REFUTED, Finding, in_words
from tweezer.forces.chains import PARAMETERS, SOFTEST, Chain, chain
from tweezer.scene.arguments import in_si, numbers_in_si
from tweezer.scene.choices import CHAINS
from tweezer.values.arrays import Array
from tweezer.values.errors import ResultError, SceneError
from tweezer.values.rounding import with_uncertainty
from tweezer.values.shown import Card, Row, Shown
from tweezer.values.units import QuantitiesLike, QuantityLike
from tweezer.values.vectors import Comparable, fixed

#: Half the width of a 95 % interval, in standard errors
_INTERVAL = 1.959964
#: Largest logarithmic standard error of a parameter that the samples determine
_DETERMINED = 1.0
#: Persistence lengths (m) and stretch moduli (N) at which the search starts
_LENGTHS, _MODULI = np.geomspace(2e-10, 2e-5, 11), np.geomspace(1e-10, 1e-8, 3)
#: Ranges of contour length, persistence length and stretch modulus, in which the minimum is sought
_RANGES = {
    "contour_length": (1e-12, 1.0),
    "persistence_length": (1e-12, 1e-3),
    "stretch_modulus": (1e-15, 1.0),
}
#: Largest number of linearisations, and the change at which they end, in standard errors
_ROUNDS, _SETTLED = 50, 1e-3
#: Number of linearisations after which half of the change is made, so that they settle
_DIRECT = 5
#: Tolerance of the minimum, and relative distance of its range from refused parameters
_TOLERANCE, _MARGIN = 1e-10, 1e-6

Interval = tuple[float, float]


@dataclass(frozen=True, repr=False, eq=False)
class ChainFit(Comparable, Shown):
    """Polymer that agrees best with a force-extension curve, as returned by `fit_chain`."""

    model: str
    """law of the force"""
    contour_length: float
    """Lc, m"""
    contour_length_interval: Interval
    """95 % confidence interval of `contour_length`, m"""
    persistence_length: float
    """Lp, m"""
    persistence_length_interval: Interval
    """95 % confidence interval of `persistence_length`, m"""
    stretch_modulus: float | None
    """S, N; None for a polymer that does not stretch"""
    stretch_modulus_interval: Interval | None
    """95 % confidence interval of `stretch_modulus`, N; None if it was given"""
    covariance: Array
    """covariance of contour length, persistence length and fitted stretch modulus, shape (2, 2) or
    (3, 3), in SI units"""
    residuals: Array
    """distance of each sample from the curve, in standard errors, shape (n,)"""
    chi_squared: float
    """sum of squares of the residuals"""
    degrees_of_freedom: int
    """number of samples minus the number of fitted parameters"""
    p_value: float
    """probability of a larger sum for a correct law and correct errors"""
    findings: tuple[Finding, ...]
    """findings about the residuals"""

    def card(self) -> Card:
        """Return the card with the parameters, the sum of squares and the findings."""
        errors = np.sqrt(np.diag(self.covariance))
        rows = [
            Row("contour length", f"{_in(self.contour_length, errors[0], 1e9)} nm"),
            Row("persistence length", f"{_in(self.persistence_length, errors[1], 1e9)} nm"),
        ]
        if self.stretch_modulus is not None and self.stretch_modulus_interval is None:
            rows.append(Row("stretch modulus", f"{1e12 * self.stretch_modulus:.4g} pN, given"))
        elif self.stretch_modulus is not None:
            rows.append(Row("stretch modulus", f"{_in(self.stretch_modulus, errors[2], 1e12)} pN"))
        squares = f"{self.chi_squared:.4g} for {self.degrees_of_freedom} degrees of freedom"
        rows.append(Row("chi-squared", f"{squares}, p = {self.p_value:.2g}"))
        told = in_words(self.findings)
        return Card("ChainFit", self.model, tuple(rows), notes=(told,) if told else ())


def _in(value: float, error: float, scale: float) -> str:
    """Return a value and its standard error as text, both multiplied by `scale`."""
    return with_uncertainty(scale * value, scale * float(error))


class _Curve(NamedTuple):
    """Samples of a force-extension curve with their errors, each of shape (n,)."""

    extension: Array
    force: Array
    extension_error: Array
    force_error: Array
    correlation: Array

    def width(self, compliance: Array) -> Array:
        """Return the standard error of x - x(F), m, at given slopes dx/dF."""
        by_force = compliance * self.force_error
        cross = 2 * self.correlation * self.extension_error * by_force
        return np.sqrt(self.extension_error**2 - cross + by_force**2)

    def nearest(self, distance: Array, compliance: Array) -> Array:
        """Return the forces of the nearest points of the curve, from x - x(F) and dx/dF."""
        pull = self.correlation * self.extension_error - compliance * self.force_error
        share = pull * distance / self.width(compliance) ** 2
        moved: Array = self.force - self.force_error * share
        return np.clip(moved, self.force.min(), self.force.max())


class _Search(NamedTuple):
    """Law whose free parameters are sought."""

    model: str
    given: dict[str, float]
    """parameters that are known"""
    free: tuple[str, ...]
    """parameters that are sought: the contour length first"""
    low: Array
    high: Array
    """logarithms of their range"""

    def polymer(self, logs: Array) -> Chain:
        """Return the polymer with free parameters whose logarithms are given."""
        return chain(self.model, **self.given, **dict(zip(self.free, np.exp(logs), strict=True)))

    def extension(self, logs: Array, force: Array) -> tuple[Array, Array]:
        """Return x(F) and dx/dF; x is odd in the force, which noise may make negative."""
        extension, compliance = self.polymer(logs).extension(np.abs(force))
        return np.sign(force) * extension, compliance

    def start(self, curve: _Curve) -> Array:
        """Return the best of many starts. The extension is proportional to the contour length."""
        moduli = _MODULI if "stretch_modulus" in self.free else (1.0,)
        best, least = self.low, math.inf
        for length in _LENGTHS:
            for modulus in moduli:
                logs = np.log([1.0, length, modulus])[: len(self.free)]
                logs[1:] = np.clip(logs[1:], self.low[1:], self.high[1:])
                unit, compliance = self.extension(logs, curve.force)
                scale = curve.extension.max() / unit.max()
                width = curve.width(scale * compliance)
                ratio = (curve.extension * unit / width**2).sum() / (unit / width).dot(unit / width)
                misfit = (((curve.extension - ratio * unit) / width) ** 2).sum()
                if ratio > 0 and misfit < least:
                    best, least = np.array([math.log(ratio), *logs[1:]]), misfit
        return np.clip(best, self.low, self.high)

    def minimum(self, curve: _Curve) -> tuple[Array, Array, Array]:
        """Return the logarithms at the least sum of squares, their covariance, and the residuals.

        Raises
        ------
        ResultError
            If the samples do not determine a parameter.
        """
        from scipy.optimize import least_squares

        logs, force = self.start(curve), curve.force
        for tried in range(_ROUNDS):
            _, compliance = self.extension(logs, force)
            found = least_squares(
                self._residuals(curve, force, compliance), logs, bounds=(self.low, self.high),
                xtol=_TOLERANCE, ftol=_TOLERANCE, gtol=_TOLERANCE,
            )  # fmt: skip
            covariance = self._covariance(found.jac)
            moved, logs = np.abs(found.x - logs) / np.sqrt(np.diag(covariance)), found.x
            nearest = curve.nearest(found.fun * curve.width(compliance), compliance)
            force = nearest if tried < _DIRECT else (force + nearest) / 2
            if moved.max() < _SETTLED:
                self._check(logs, covariance)
                return logs, covariance, found.fun
        raise ResultError("force: the fit does not converge; use samples with smaller errors")

    def _residuals(
        self, curve: _Curve, force: Array, compliance: Array
    ) -> Callable[[Array], Array]:
        """Return the function of distances from the curve, linearised at forces on it."""
        shifted = curve.extension - compliance * (curve.force - force)
        width = curve.width(compliance)
        return lambda logs: (shifted - self.extension(logs, force)[0]) / width

    def _covariance(self, jacobian: Array) -> Array:
        """Return the covariance of the logarithms by Fisher's information."""
        information = jacobian.T @ jacobian
        scale = np.sqrt(np.diag(information))
        if (scale > 0).all() and np.linalg.cond(information / np.outer(scale, scale)) < 1e12:
            covariance: Array = np.linalg.inv(information).astype(np.float64)
            return covariance
        raise ResultError(
            f"force: the samples do not determine {', '.join(self.free)}; use a larger range of "
            "forces or fewer parameters"
        )

    def _check(self, logs: Array, covariance: Array) -> None:
        """Raise `ResultError` for a parameter that is at its limit or not determined."""
        errors = np.sqrt(np.diag(covariance))
        for name, value, low, high, error in zip(
            self.free, logs, self.low, self.high, errors, strict=True
        ):
            if min(value - low, high - value) < _MARGIN:
                raise ResultError(
                    f"{name} = {math.exp(value):.3g}: is at the limit of model = {self.model!r} "
                    "for these forces; omit the smallest or largest forces, or use 'bouchiat'"
                )
            if error > _DETERMINED:
                raise ResultError(
                    f"{name}: is not determined by the samples; use a larger range of forces, or "
                    "a model without it"
                )


def fit_chain(
    extension: QuantitiesLike,
    force: QuantitiesLike,
    *,
    model: str,
    temperature: QuantityLike,
    extension_error: QuantitiesLike = 0.0,
    force_error: QuantitiesLike = 0.0,
    correlation: QuantitiesLike = -1.0,
    stretch_modulus: QuantityLike | None = None,
    twist_rigidity: QuantityLike | None = None,
    twist_coupling: QuantityLike | None = None,
    twist_coupling_slope: QuantityLike | None = None,
    critical_force: QuantityLike | None = None,
) -> ChainFit:
    r"""Fit contour length and persistence length to a force-extension curve.

    The sum of squared distances of the samples from the curve is minimised, with errors in the
    extension and in the force. Intervals follow from Fisher's information for the logarithms of the
    parameters.

    Parameters
    ----------
    extension : array_like, shape (n,)
        Distance between the ends of the polymer, m.
    force : array_like, shape (n,)
        Force, N. Noise may make it negative.
    model : str
        Law of the force, see `chain_force`.
    temperature : float or str
        Temperature, K.
    extension_error, force_error : array_like, shape (n,) or ()
        Standard errors of extension (m) and force (N), of independent samples.
    correlation : array_like, shape (n,) or (), optional
        Correlation of both errors, from -1 to less than 1. The default, -1, applies to a force that
        is the stiffness times a deflection, which also shortens the extension.
    stretch_modulus : float or str, optional
        S, N, if it is known, or "fit". Default: "fit" for "odijk", "efjc" and "twlc". By default,
        worm-like chains do not stretch.
    twist_rigidity, twist_coupling, twist_coupling_slope, critical_force : float or str, optional
        Known constants of "twlc", see `chain_force`.

    Returns
    -------
    ChainFit
        The parameters with 95 % confidence intervals and their covariance, the residuals with
        their p-value, and the findings: "residuals" if they are larger than the errors, and "trend"
        if those at neighbouring forces agree. Each has a false-alarm rate of at most 1 %.

    Raises
    ------
    ResultError
        For arrays that are not samples with errors, for forces outside the range of the law, and if
        the samples do not determine the parameters.
    SceneError
        For an unknown model, and for parameters that are missing or not used by it.

    Notes
    -----
    The curvature of the curve within the errors biases the result. The coverage of the intervals
    was measured for force errors up to 2.4 kT/Lp, 0.2 pN for DNA (`tests/chain_coverage.py`).

    Examples
    --------
    >>> x = np.linspace(0.5e-6, 0.95e-6, 20)
    >>> force = tweezer.chain_force(
    ...     "bouchiat", x, contour_length="1 um", persistence_length="50 nm", temperature=298
    ... )
    >>> fit = tweezer.fit_chain(x, force, model="bouchiat", temperature=298, extension_error=1e-9)
    >>> round(1e9 * fit.contour_length, 3), round(1e9 * fit.persistence_length, 3)  # nm
    (1000.0, 50.0)
    """
    curve = _samples(extension, force, extension_error, force_error, correlation)
    search = _search(
        model, curve, temperature, stretch_modulus,
        {
            "twist_rigidity": twist_rigidity, "twist_coupling": twist_coupling,
            "twist_coupling_slope": twist_coupling_slope, "critical_force": critical_force,
        },
    )  # fmt: skip
    if len(curve.force) <= len(search.free):
        raise ResultError(
            f"force: contains {len(curve.force)} samples; must contain more than the "
            f"{len(search.free)} fitted parameters"
        )
    return _result(search, curve, *search.minimum(curve))


def _samples(
    extension: QuantitiesLike,
    force: QuantitiesLike,
    extension_error: QuantitiesLike,
    force_error: QuantitiesLike,
    correlation: QuantitiesLike,
) -> _Curve:
    """Return the samples with their errors, or raise `ResultError`."""
    given = {
        "extension": (extension, "m"), "force": (force, "N"),
        "extension_error": (extension_error, "m"), "force_error": (force_error, "N"),
        "correlation": (correlation, ""),
    }  # fmt: skip
    arrays = {name: numbers_in_si(name, *value) for name, value in given.items()}
    shape = arrays["extension"].shape
    for name, values in arrays.items():
        allowed = (shape,) if name in ("extension", "force") else (shape, ())
        if len(shape) != 1 or values.shape not in allowed:
            raise ResultError(
                f"{name}: has the shape {values.shape}; must be one number for each extension, in "
                "an array of one dimension"
            )
        if not np.isfinite(values).all():
            raise ResultError(f"{name}: contains values that are not finite; remove them")
    curve = _Curve(*(np.broadcast_to(values, shape) for values in arrays.values()))
    for name in ("extension_error", "force_error"):
        if (arrays[name] < 0).any():
            raise ResultError(f"{name} = {arrays[name].min():g}: must not be negative")
    if (curve.extension_error + curve.force_error <= 0).any():
        raise ResultError(
            "extension_error, force_error: are 0; give the standard error of at least one of them"
        )
    if ((curve.correlation < -1) | (curve.correlation >= 1)).any():
        raise ResultError("correlation: must be from -1 to less than 1")
    if not (curve.extension > 0).any():
        raise ResultError("extension: must contain positive numbers")
    return curve


def _search(
    model: str,
    curve: _Curve,
    temperature: QuantityLike,
    stretch_modulus: QuantityLike | None,
    twist: dict[str, QuantityLike | None],
) -> _Search:
    """Return the law with its free parameters and their range for the forces of a curve.

    The range contains only parameters with which the law applies to all forces.
    """
    if model not in CHAINS:
        raise SceneError(f"model = {model!r}: is unknown; choose from {', '.join(CHAINS)}")
    law = CHAINS[model]
    if stretch_modulus is None and "stretch_modulus" in law.needs:
        stretch_modulus = "fit"
    fits = isinstance(stretch_modulus, str) and stretch_modulus == "fit"
    free = ("contour_length", "persistence_length", *(["stretch_modulus"] if fits else []))
    given = {"temperature": temperature} | twist
    if stretch_modulus is not None:
        given["stretch_modulus"] = _RANGES["stretch_modulus"][1] if fits else stretch_modulus
    si = {
        name: in_si(name, value, *PARAMETERS[name])
        for name, value in given.items()
        if value is not None
    }
    stiffest = chain(model, contour_length=1.0, persistence_length=1.0, **si)
    weakest, strongest = float(curve.force.min()), float(curve.force.max())
    if (stiffest.forces[0] > 0 and weakest <= 0) or strongest >= stiffest.forces[1]:
        worst = weakest if weakest <= 0 else strongest
        raise ResultError(
            f"force = {worst:.3g} N: is outside the range of model = {model!r}; omit such samples "
            "or use 'bouchiat'"
        )
    low, high = np.array([_RANGES[name] for name in free]).T
    if stiffest.forces[0] > 0:
        low[1] = stiffest.forces[0] / min(weakest, si.get("critical_force", weakest))
    if "twist_coupling" in law.needs and fits:
        forces = np.array([si["critical_force"], max(strongest, si["critical_force"])])
        coupling = si["twist_coupling"] + si["twist_coupling_slope"] * forces
        low[2] = (coupling**2).max() / (SOFTEST * si["twist_rigidity"])
    low[1:] *= 1 + _MARGIN
    if fits:
        del si["stretch_modulus"]
    return _Search(model, si, free, np.log(low), np.log(high))


def _result(
    search: _Search, curve: _Curve, logs: Array, logarithmic: Array, residuals: Array
) -> ChainFit:
    """Return the fit with its intervals and the findings about its residuals."""
    from scipy.special import chdtrc, ndtr

    values, errors = np.exp(logs), np.sqrt(np.diag(logarithmic))
    intervals = [
        (float(value * math.exp(-_INTERVAL * error)), float(value * math.exp(_INTERVAL * error)))
        for value, error in zip(values, errors, strict=True)
    ]
    squares, degrees = float(residuals @ residuals), len(residuals) - len(values)
    p_value = float(chdtrc(degrees, squares))
    findings = []
    if p_value < REFUTED:
        findings.append(
            Finding("residuals", f"the residuals exceed the errors (p = {p_value:.2g})")
        )
    along = residuals[np.argsort(curve.force)]
    scale = math.sqrt(max((along[:-1] ** 2 * along[1:] ** 2).sum(), len(along) - 1))
    trend = float(ndtr(-(along[:-1] @ along[1:]) / scale))
    if trend < REFUTED:
        findings.append(
            Finding(
                "trend",
                f"residuals at neighbouring forces are alike (p = {trend:.2g}); another law may "
                "apply",
            )
        )
    fitted = dict(zip(search.free, zip(map(float, values), intervals, strict=True), strict=True))
    modulus, modulus_interval = fitted.get(
        "stretch_modulus", (search.given.get("stretch_modulus"), None)
    )
    return ChainFit(
        search.model, *fitted["contour_length"], *fitted["persistence_length"], modulus,
        modulus_interval, fixed(np.outer(values, values) * logarithmic), fixed(residuals), squares,
        degrees, p_value, tuple(findings),
    )  # fmt: skip
