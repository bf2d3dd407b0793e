"""The table of poles of the fluid's memory; `python -m derivation.memory_poles` computes it.

The drag of a fluid with inertia has the term sqrt(s tau_f) (`derivation.hydrodynamics`). With
s in units of 1/tau_f it is an integral with a positive density, so a sum of such terms approximates
it:

    sqrt(s) = (1/pi) int_0^inf p^(-1/2) s/(s + p) dp,      sqrt(s) ~ sum_k c_k s/(s + p_k).

The relevant error is relative to the impedance Z = 1 + sqrt(s) + mu s. The smallest mu, 1/9, is the
lightest bead's, and its Z is the weight for all beads. Late times require a small error relative to
sqrt(s) too, which may be larger by a factor kappa. Each table is the best in Chebyshev's sense of

    |sum_k c_k s/(s + p_k) - sqrt(s)| <= E W,
    W = min(|1 + sqrt(s) + s/9|, kappa |sqrt(s) + sqrt(w_low)|)

on s = i w, w from w_low/50 to w_high. It is found by nonlinear least squares over ln c and ln p,
from poles in geometric progression. The weights grow where the error is large (Lawson's method).

The last digits of the result depend on the machine. The output is therefore data:
`memory_poles.json` is committed, and emitted as `generated/memory_poles.py`.
"""

from __future__ import annotations

import json
import math
import sys
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.special import wofz

Array = NDArray[np.float64]
Complex = NDArray[np.complexfloating]

#: the committed tables
DATA = Path(__file__).with_suffix(".json")
#: (kappa, w_low, w_high) of the coarser tables: made for Z
COARSE = (30.0, 1e-4, 1e4)
#: Those of the finer ones: made for Z and for the tail
FINE = (3.0, 1e-5, 1e4)
#: Those of the finest ones
FINEST = (3.0, 1e-6, 3e4)
#: What each number of poles is made for
TABLES = {
    **dict.fromkeys(range(8, 26, 2), COARSE),
    **dict.fromkeys((28, 32), FINE),
    **dict.fromkeys((36, 40), FINEST),
}
#: Points in the frequency, for each pole
POINTS = 40
#: Largest number of changes of the weights
ROUNDS = 300
#: Significant digits of a table: with 8 no error of 24 poles changes
DIGITS = 10


@dataclass(frozen=True)
class Table:
    """Poles p and weights c, in units of 1/tau_f, and how near they come."""

    kappa: float
    w_low: float
    w_high: float
    E: float
    """largest error over W"""
    velocity: float
    """error of the autocorrelation of the velocity, of kT/M; this and the next: see `errors`"""
    displacement: float
    """relative error of the mean squared displacement"""
    spectrum: float
    """relative error of the spectrum of a free and of a trapped bead below 1 MHz"""
    relaxation: float
    """error of the relaxation in a trap, of the first displacement"""
    tail: float
    """relative error of the autocorrelation of the velocity up to 1e5 tau_f"""
    p: tuple[float, ...]
    c: tuple[float, ...]


def weight(w: Array, kappa: float, w_low: float) -> Array:
    """Return W at the frequencies w."""
    root = np.sqrt(1j * w)
    impedance = np.abs(1 + root + 1j * w / 9)
    return np.minimum(impedance, kappa * np.abs(root + math.sqrt(w_low)))


def _terms(c: Array, p: Array, s: Complex) -> Complex:
    return c * s[:, None] / (s[:, None] + p)


def largest_error(p: Array, c: Array, kappa: float, w_low: float, w_high: float) -> float:
    """Return the largest error E of a table of poles p and weights c."""
    w = np.geomspace(w_low / 50, w_high, 400 * len(p))
    error = _terms(c, p, 1j * w).sum(axis=1) - np.sqrt(1j * w)
    return float((np.abs(error) / weight(w, kappa, w_low)).max())


def best(n: int, kappa: float, w_low: float, w_high: float) -> tuple[Array, Array]:
    """Return the n poles and weights with the smallest E, in the order of the poles."""
    w = np.geomspace(w_low / 50, w_high, POINTS * n)
    s, scale = 1j * w, weight(w, kappa, w_low)
    ln_p = np.linspace(math.log(w_low / 100), math.log(w_high * 10), n)
    # the trapezoidal rule of the integral over ln p
    x = np.concatenate([math.log((ln_p[1] - ln_p[0]) / math.pi) + ln_p / 2, ln_p])
    lawson = np.ones(len(w))
    least, found, before = math.inf, x, math.inf
    for i in range(ROUNDS):
        x = _least_squares(x, s, scale, np.sqrt(lawson), 6 if i else 60)
        c, p = np.exp(x[:n]), np.exp(x[n:])
        error = np.abs(_terms(c, p, s).sum(axis=1) - np.sqrt(s)) / scale
        if error.max() < least:
            least, found = error.max(), x
        lawson *= error / error.max()
        lawson = np.maximum(lawson / lawson.max(), 1e-30)
        if i and i % 50 == 0:
            if before < 1.001 * least:
                break
            before = least
    order = np.argsort(found[n:])
    return np.exp(found[n:])[order], np.exp(found[:n])[order]


def _least_squares(x: Array, s: Complex, scale: Array, root_of_weight: Array, steps: int) -> Array:
    """Some steps of Levenberg and Marquardt over x = (ln c, ln p)."""
    n = len(x) // 2
    factor, damping = root_of_weight / scale, 1e-6

    def residual(x: Array) -> tuple[Complex, Complex]:
        terms = _terms(np.exp(x[:n]), np.exp(x[n:]), s)
        return (terms.sum(axis=1) - np.sqrt(s)) * factor, terms

    for _ in range(steps):
        r, terms = residual(x)
        p = np.exp(x[n:])
        slopes = np.hstack([terms, -terms * p / (s[:, None] + p)]) * factor[:, None]
        J, R = np.vstack([slopes.real, slopes.imag]), np.concatenate([r.real, r.imag])
        size = np.sqrt((J**2).sum(axis=0))
        cost = R @ R
        for _ in range(12):
            system = np.vstack([J, np.diag(math.sqrt(damping) * size)])
            right = np.concatenate([-R, np.zeros(2 * n)])
            step = np.clip(np.linalg.lstsq(system, right, rcond=None)[0], -1, 1)
            new = (np.abs(residual(x + step)[0]) ** 2).sum()
            if new < cost:
                break
            damping *= 4
        else:
            return x
        x, damping = x + step, max(damping / 5, 1e-14)
        if cost - new < 1e-10 * cost:
            break
    return x


# --- errors of what is measured on a bead --------------------------------------------------------
#: Radii and densities of the beads: 250 nm and 1.5 um, polystyrene and silica
BEADS = tuple((radius, density) for radius in (250e-9, 1.5e-6) for density in (1050.0, 2000.0))
#: Water
DENSITY, VISCOSITY = 998.2, 1.0016e-3
#: Stiffnesses of the trap, N/m
STIFFNESSES = (1e-6, 2e-5, 2e-4)
#: Times, s
TIMES = np.geomspace(1e-9, 0.1, 401)
#: Frequencies, Hz
FREQUENCIES = np.geomspace(1, 1e6, 301)


def modes(mu: float, p: Array, c: Array) -> tuple[Array, Array]:
    """Rates and weights of 1/(1 + mu s + sum c s/(s + p)) = sum w/(s + rate), in units of tau_f."""

    def impedance(rate: float) -> float:
        return float(1 - mu * rate - (c * rate / (p - rate)).sum())

    above = 2 * (1 + c.sum()) / mu + 2 * p[-1]
    brackets = zip([0.0, *p * (1 + 1e-14)], [*p * (1 - 1e-14), above], strict=True)
    rates = np.array([brentq(impedance, *each, xtol=1e-300, rtol=1e-15) for each in brackets])
    return rates, 1 / (mu + (c * p / (p - rates[:, None]) ** 2).sum(axis=1))


def errors(p: Array, c: Array) -> dict[str, float]:
    """The largest errors of all beads, against closed forms (Hinch; Clercx and Schram)."""
    found: list[tuple[float, float, float, float, float]] = []
    for radius, density in BEADS:
        tau = radius**2 * DENSITY / VISCOSITY
        mu = (density / DENSITY + 0.5) / 4.5
        rates, w = modes(mu, p, c)
        t, s = TIMES / tau, 2j * math.pi * FREQUENCIES * tau
        decay = np.exp(-np.outer(t, rates))
        z, P = _roots([mu, 1, 1])
        W = wofz(-1j * z * np.sqrt(t)[:, None])
        exact = (W * z / P).sum(axis=1).real
        velocity = mu * (decay * w).sum(axis=1) - exact
        a1 = z.sum().real * mu**2
        a2 = (z.sum().real * a1 - mu) * mu
        moved = mu * t + 2 * a1 * np.sqrt(t / math.pi) + a2 + (W / (z**3 * P)).sum(axis=1).real
        x = np.outer(t, rates)
        lag = np.where(x < 1e-3, x**2 / 2 - x**3 / 6 + x**4 / 24, x + np.expm1(-x))
        displacement = (w / rates**2 * lag).sum(axis=1) * mu / moved - 1
        Z = 1 + np.sqrt(s) + mu * s
        Z_K = 1 + mu * s + _terms(c, p, s).sum(axis=1)
        for k in STIFFNESSES:
            pull = k * tau / (6 * math.pi * VISCOSITY * radius)
            trapped = (1 / (Z_K + pull / s)).real / (1 / (Z + pull / s)).real - 1
            free = (1 / Z_K).real / (1 / Z).real - 1
            z, P = _roots([mu, 1, 1, 0, pull])
            W = wofz(-1j * z * np.sqrt(t)[:, None])
            relaxed = -pull / mu * (W / (z * P)).sum(axis=1).real
            found.append(
                (
                    np.abs(velocity).max(),
                    np.abs(displacement).max(),
                    max(np.abs(free).max(), np.abs(trapped).max()),
                    np.abs(_relaxation(t, rates, w, pull) - relaxed).max(),
                    np.abs(velocity / exact)[t <= 1e5].max(),
                )
            )
    names = ("velocity", "displacement", "spectrum", "relaxation", "tail")
    return dict(zip(names, map(float, np.array(found).max(axis=0)), strict=True))


def _roots(polynomial: list[float]) -> tuple[Complex, Complex]:
    """Roots of a polynomial, and the product of each one's distances from the others."""
    z = np.roots(polynomial).astype(complex)
    for _ in range(3):
        z -= np.polyval(polynomial, z) / np.polyval(np.polyder(polynomial), z)
    apart = z[:, None] - z
    np.fill_diagonal(apart, 1)
    return z, apart.prod(axis=1)


def _relaxation(t: Array, rates: Array, w: Array, pull: float) -> Array:
    """x(t)/x(0) of the modes in a trap, released at rest."""
    n = len(rates)
    spring = np.sqrt(pull * w)
    A = np.zeros((n + 1, n + 1))
    A[0, 1:], A[1:, 0], A[range(1, n + 1), range(1, n + 1)] = spring, -spring, -rates
    decays, vectors = np.linalg.eig(A)
    amplitudes = vectors[0] * np.linalg.solve(vectors, np.eye(n + 1)[:, 0])
    return np.asarray((np.exp(np.outer(t, decays)) * amplitudes).sum(axis=1).real)


# --- the file ------------------------------------------------------------------------------------
def _rounded(values: Array) -> Array:
    return np.array([float(f"{value:.{DIGITS - 1}e}") for value in values])


def _upward(value: float) -> float:
    """Two digits, never less than `value`."""
    unit = 10.0 ** (math.floor(math.log10(value)) - 1)
    return float(f"{math.ceil(value / unit * 1.0001) * unit:.1e}")


def make(n: int) -> Table:
    """The table of n poles, with its errors rounded up."""
    kappa, w_low, w_high = TABLES[n]
    p, c = map(_rounded, best(n, kappa, w_low, w_high))
    E = _upward(largest_error(p, c, kappa, w_low, w_high))
    measured = {name: _upward(value) for name, value in errors(p, c).items()}
    return Table(
        kappa, w_low, w_high, E, **measured, p=tuple(map(float, p)), c=tuple(map(float, c))
    )


def load() -> dict[int, Table]:
    """The committed tables, by number of poles."""
    read: dict[str, dict[str, Any]] = json.loads(DATA.read_text())
    return {
        int(n): Table(**{**table, "p": tuple(table["p"]), "c": tuple(table["c"])})
        for n, table in read.items()
    }


def main() -> None:
    """Make the tables of the numbers of poles on the command line, or all, and write the file."""
    tables = load() if DATA.exists() else {}
    for n in map(int, sys.argv[1:] or TABLES):
        tables[n] = make(n)
        told = {name: value for name, value in asdict(tables[n]).items() if name not in "pc"}
        sys.stderr.write(f"{n} poles: {told}\n")
    content = {str(n): asdict(tables[n]) for n in sorted(tables)}
    DATA.write_text(json.dumps(content, indent=1) + "\n")


if __name__ == "__main__":
    main()
